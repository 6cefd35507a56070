"""Every setting, once: its range, unit, symbol and help. Flags, sliders, presets and checks all come from here.

Imports nothing heavy, so that ``stair-inspector --help`` answers at once.
"""

import dataclasses
import itertools
import math
import re
import typing
import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal, get_args, get_origin, get_type_hints

from typing_extensions import Doc

from stair_inspector import priors
from stair_inspector.errors import ConfigError

Method = Literal["survey", "paper"]
AxesRule = Literal["auto", "global", "per_step"]
KnownUnit = Literal["m", "cm", "mm", "in", "ft"]
KNOWN_UNITS: tuple[KnownUnit, ...] = get_args(KnownUnit)
Unit = Literal["auto", "m", "cm", "mm", "in", "ft"]
NormalsSource = Literal["estimate", "given"]
EdgeSource = Literal["auto", "tread", "face"]
Verdict = Literal["tread", "landing", "rejected"]

METRES_PER_UNIT: dict[str, float] = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048}
"""Exact length of each unit, metres (international inch and foot)."""
UNIT_NAMES: dict[str, str] = {"m": "metres", "cm": "centimetres", "mm": "millimetres", "in": "inches", "ft": "feet"}

_LONGEST_REASON = 300
_LONGEST_SHOWN = 60
"""Characters of a wrong value that a message repeats: a file may hold megabytes of it."""

NAMED_UP: dict[str, tuple[float, float, float]] = {
    "x": (1.0, 0.0, 0.0),
    "y": (0.0, 1.0, 0.0),
    "z": (0.0, 0.0, 1.0),
    "-x": (-1.0, 0.0, 0.0),
    "-y": (0.0, -1.0, 0.0),
    "-z": (0.0, 0.0, -1.0),
}
"""Up vectors that have a name, in the scan's frame."""


@dataclass(frozen=True, slots=True)
class Knob:
    """Range and presentation of one numeric setting.

    ``low`` and ``high`` are inclusive and in the setting's own unit; ``per_display`` converts that unit into
    ``display_unit`` for people (an ``eps_m`` of 0.02 is shown as 20 mm).
    """

    low: float
    high: float
    step: float
    label: str
    symbol: str = ""
    display_unit: str = ""
    per_display: float = 1.0

    def shown(self, value: float) -> float:
        """Return ``value`` in the display unit."""
        return round(value * self.per_display, 9)

    def stored(self, shown: float) -> float:
        """Return a displayed value in the setting's own unit."""
        return round(shown / self.per_display, 12)


@dataclass(frozen=True)
class Group:
    """A group of settings that checks its own types and ranges when it is made."""

    def __post_init__(self) -> None:
        for name, (kind, knob) in fields_of(type(self)).items():
            check_value(f"{title_of(type(self))}.{name}", getattr(self, name), kind, knob)


@dataclass(frozen=True)
class NormalsParams(Group):
    """Surface normals."""

    k: Annotated[
        int,
        Knob(5, 300, 1, "neighbours", symbol="k"),
        Doc("Neighbours for a normal (5 to 300). More smooths noise and rounds edges."),
    ] = 30
    source: Annotated[
        NormalsSource,
        Doc("'estimate' computes normals as the paper does; 'given' takes those stored in the scan."),
    ] = "estimate"


@dataclass(frozen=True)
class FloorParams(Group):
    """RANSAC floor plane; used only when the up vector is 'auto'."""

    distance_m: Annotated[
        float,
        Knob(0.001, 0.1, 0.001, "floor tolerance", display_unit="mm", per_display=1000.0),
        Doc("Distance within which a point belongs to the floor plane, metres (0.001 to 0.1)."),
    ] = 0.01


@dataclass(frozen=True)
class HorizontalParams(Group):
    """Which points lie on a horizontal surface."""

    theta_deg: Annotated[
        float,
        Knob(1.0, 60.0, 0.5, "normal tolerance", symbol="θ_th", display_unit="°"),
        Doc("theta_th: largest angle between a normal and the up vector, degrees (1 to 60)."),
    ] = 15.0


@dataclass(frozen=True)
class LevelsParams(Group):
    """One-dimensional DBSCAN on height."""

    eps_m: Annotated[
        float,
        Knob(0.001, 0.1, 0.001, "vertical reach", symbol="ε_z", display_unit="mm", per_display=1000.0),
        Doc(
            "eps_z: vertical reach of DBSCAN, metres (0.001 to 0.1). Smaller than half a riser, larger than the noise."
        ),
    ] = 0.02
    min_points: Annotated[
        int,
        Knob(1, 5000, 1, "points in reach", symbol="m"),
        Doc("m: smallest neighbourhood of a core point, the point itself included (1 to 5000)."),
    ] = 50


@dataclass(frozen=True)
class AxesParams(Group):
    """Width and depth directions."""

    rule: Annotated[
        AxesRule,
        Doc(
            "PCA of all step points together ('global'), of each step centred ('per_step'), or 'auto': per_step, "
            "checked against the direction in which the steps rise; with --method paper 'auto' means 'global'."
        ),
    ] = "auto"


@dataclass(frozen=True)
class EdgesParams(Group):
    """Percentiles that place the edges of the paper's columns; the survey finds its own."""

    front_percentile: Annotated[
        float,
        Knob(51.0, 100.0, 0.5, "front edge", symbol="paper's α_f", display_unit="%"),
        Doc("alpha_f: percentile of depth that is the front edge (51 to 100). Paper's columns only."),
    ] = 95.0
    back_percentile: Annotated[
        float,
        Knob(0.0, 49.0, 0.5, "back edge", symbol="paper's α_b", display_unit="%"),
        Doc("alpha_b: percentile of depth that is the back edge (0 to 49). Paper's columns only."),
    ] = 5.0
    side_percentile: Annotated[
        float,
        Knob(51.0, 100.0, 0.5, "paper's side", display_unit="%"),
        Doc(
            "Percentile of width that is one side edge; the other is its complement (51 to 100). Paper's columns only."
        ),
    ] = 99.0


@dataclass(frozen=True)
class PatchesParams(Group):
    """Surfaces of equal height that lie apart in plan (survey)."""

    cell_m: Annotated[
        float,
        Knob(0.005, 0.1, 0.001, "plan cell", display_unit="mm", per_display=1000.0),
        Doc("Plan cell for telling surfaces of equal height apart, metres (0.005 to 0.1); larger for a coarse scan."),
    ] = 0.02
    min_area_m2: Annotated[
        float,
        Knob(0.0, 1.0, 0.005, "smallest surface", display_unit="m²"),
        Doc("Smallest surface that can be a tread, square metres (0 to 1)."),
    ] = priors.SMALLEST_TREAD_M2


@dataclass(frozen=True)
class FlightsParams(Group):
    """How surfaces chain into flights (survey)."""

    min_rise_m: Annotated[
        float,
        Knob(0.03, 0.2, 0.005, "smallest rise", display_unit="mm", per_display=1000.0),
        Doc("Smallest rise between two steps, metres (0.03 to 0.2)."),
    ] = priors.LEAST_RISE_M
    max_rise_m: Annotated[
        float,
        Knob(0.2, 0.6, 0.005, "largest rise", display_unit="mm", per_display=1000.0),
        Doc("Largest rise between two steps, metres (0.2 to 0.6)."),
    ] = priors.MOST_RISE_M
    max_gap_m: Annotated[
        float,
        Knob(0.02, 0.5, 0.01, "largest gap", display_unit="mm", per_display=1000.0),
        Doc(
            "Largest gap in plan between two steps that follow each other, metres (0.02 to 0.5), as a shadow leaves it."
        ),
    ] = 0.15
    turn_deg: Annotated[
        float,
        Knob(5.0, 60.0, 1.0, "largest turn", display_unit="°"),
        Doc("Largest turn of the direction of climb from one step to the next, degrees (5 to 60)."),
    ] = priors.MOST_TURN_DEG
    min_risers: Annotated[
        int,
        Knob(1, 10, 1, "fewest risers"),
        Doc("Fewest risers that make a flight (1 to 10); one alone is a kerb."),
    ] = 2

    @property
    def at_least_usual(self) -> "FlightsParams":
        """These limits or the defaults, whichever are wider: for what narrower limits must not move, as up."""
        usual = FlightsParams()
        return dataclasses.replace(
            usual,
            min_rise_m=min(self.min_rise_m, usual.min_rise_m),
            max_rise_m=max(self.max_rise_m, usual.max_rise_m),
            max_gap_m=max(self.max_gap_m, usual.max_gap_m),
            turn_deg=max(self.turn_deg, usual.turn_deg),
        )


@dataclass(frozen=True)
class SurveyParams(Group):
    """Where the survey takes its edges and lines."""

    edge_source: Annotated[
        EdgeSource,
        Doc(
            "Evidence for an edge: the upright face below or above it ('face'), the extent of the tread ('tread'), or "
            "'auto': the face where it is seen, else the tread."
        ),
    ] = "auto"
    line_percent: Annotated[
        float,
        Knob(2.0, 45.0, 1.0, "outer lines", display_unit="%"),
        Doc("Distance of the left and right measuring line from the side edges, percent of the width (2 to 45)."),
    ] = 15.0
    band_m: Annotated[
        float,
        Knob(0.0, 0.1, 0.001, "tread tolerance", display_unit="mm", per_display=1000.0),
        Doc("Distance from a tread's plane within which points belong to it, metres (0 to 0.1); 0 takes 3 sigma."),
    ] = 0.0

    @property
    def of_edges(self) -> "SurveyParams":
        """What of these settings places the edges: a change of the rest leaves them where they are."""
        return dataclasses.replace(self, line_percent=SurveyParams.line_percent)


@dataclass(frozen=True)
class UncertaintyParams(Group):
    """What the user states about the scan, as standard uncertainties (k = 1); it enters every u (survey)."""

    registration_m: Annotated[
        float,
        Knob(0.0, 0.05, 0.0001, "registration", display_unit="mm", per_display=1000.0),
        Doc("Standard uncertainty that registration and drift add from one step to the next, metres (0 to 0.05)."),
    ] = 0.0
    edge_m: Annotated[
        float,
        Knob(0.0, 0.05, 0.0005, "edges", display_unit="mm", per_display=1000.0),
        Doc("Standard uncertainty of a nosing or back edge that the scanner rounds or displaces, metres (0 to 0.05)."),
    ] = 0.0
    side_m: Annotated[
        float,
        Knob(0.0, 0.05, 0.0005, "sides", display_unit="mm", per_display=1000.0),
        Doc("Standard uncertainty of a tread's side edge that the scanner rounds or displaces, metres (0 to 0.05)."),
    ] = 0.0
    slope_deg: Annotated[
        float,
        Knob(0.0, 5.0, 0.01, "slopes", display_unit="°"),
        Doc("Standard uncertainty of a tread's fall that stations or passes of the scanner leave, degrees (0 to 5)."),
    ] = 0.0
    up_deg: Annotated[
        float,
        Knob(0.0, 5.0, 0.01, "up", display_unit="°"),
        Doc("Standard uncertainty of the up direction beyond what the scan shows, degrees (0 to 5)."),
    ] = 0.0
    scale_percent: Annotated[
        float,
        Knob(0.0, 5.0, 0.05, "scale", display_unit="%"),
        Doc("Standard uncertainty of the scan's scale, percent (0 to 5)."),
    ] = 0.0


@dataclass(frozen=True)
class OverrulesParams(Group):
    """What the inspector decides instead of the program (survey)."""

    force: Annotated[
        str,
        Doc(
            "Surfaces whose kind is decided, as 'level:3=rejected; patch:12=tread; at:0.5,1.2,0.34=landing'; 'at' "
            "takes the surface nearest to a point of the scan's frame, metres. A reason may follow in parentheses: "
            "'level:3=rejected (a table)'."
        ),
    ] = ""
    climb: Annotated[
        str,
        Doc(
            "Direction of climb in the scan's frame: auto, x, y, z, -x, -y, -z, or three numbers; flights that climb "
            "otherwise, by more than 45 degrees, are not taken."
        ),
    ] = "auto"
    region: Annotated[
        str,
        Doc("Box to measure in, 'xmin,ymin,zmin,xmax,ymax,zmax' in the scan's frame, metres; empty for everything."),
    ] = ""

    def __post_init__(self) -> None:
        super().__post_init__()
        parse_force(self.force)
        parse_up(self.climb, "overrules.climb")
        parse_region(self.region)


@dataclass(frozen=True)
class DisplayParams(Group):
    """What is kept to be looked at."""

    nearest_k: Annotated[
        int,
        Knob(0, 1000, 1, "points at a centre", symbol="K"),
        Doc("K: points kept around each step's centre for display (0 to 1000)."),
    ] = 50


@dataclass(frozen=True)
class Params:
    """All settings of one inspection, grouped by the stage that reads them."""

    method: Annotated[
        Method,
        Doc("'paper' is the published method and nothing else; 'survey' is the measurement for real stairs."),
    ] = "survey"
    up: Annotated[
        str,
        Doc('Up direction in the scan\'s frame: auto (RANSAC floor), x, y, z, -x, -y, -z, or three numbers "0.1,0,1".'),
    ] = "auto"
    unit: Annotated[Unit, Doc("Unit of the scan's coordinates; 'auto' guesses from the size and says so.")] = "auto"
    normals: NormalsParams = field(default_factory=NormalsParams)
    floor: FloorParams = field(default_factory=FloorParams)
    horizontal: HorizontalParams = field(default_factory=HorizontalParams)
    levels: LevelsParams = field(default_factory=LevelsParams)
    axes: AxesParams = field(default_factory=AxesParams)
    edges: EdgesParams = field(default_factory=EdgesParams)
    patches: PatchesParams = field(default_factory=PatchesParams)
    flights: FlightsParams = field(default_factory=FlightsParams)
    survey: SurveyParams = field(default_factory=SurveyParams)
    uncertainty: UncertaintyParams = field(default_factory=UncertaintyParams)
    overrules: OverrulesParams = field(default_factory=OverrulesParams)
    display: DisplayParams = field(default_factory=DisplayParams)

    def __post_init__(self) -> None:
        for name, (kind, knob) in fields_of(Params).items():
            check_value(name, getattr(self, name), kind, knob)
        parse_up(self.up)

    def value(self, name: str) -> Any:
        """Return the value of the setting with the dotted ``name`` (``levels.eps_m``)."""
        group_name, _, field_name = name.rpartition(".")
        return getattr(getattr(self, group_name) if group_name else self, field_name)

    def replaced(self, name: str, value: object) -> "Params":
        """Return a copy in which the setting with the dotted ``name`` (``levels.eps_m``) has another value.

        Raises
        ------
        ConfigError
            No such setting, wrong type, or out of range.
        """
        group_name, _, field_name = name.rpartition(".")
        owner = GROUPS.get(group_name, Group) if group_name else Params
        if field_name not in fields_of(owner) or name in GROUPS:
            raise ConfigError(f"{name}: unknown setting")
        changes: dict[str, Any] = {field_name: value}
        if group_name:
            changes = {group_name: dataclasses.replace(getattr(self, group_name), **changes)}
        return dataclasses.replace(self, **changes)


def knob_of(name: str) -> Knob:
    """Return the knob of the numeric setting with the dotted ``name``.

    Raises
    ------
    ConfigError
        There is no such setting, or it is not a number.
    """
    group_name, _, field_name = name.rpartition(".")
    if group_name in GROUPS:
        _, knob = fields_of(GROUPS[group_name]).get(field_name, (None, None))
        if knob is not None:
            return knob
    raise ConfigError(f"{name}: not a numeric setting")


def help_of(name: str) -> str:
    """Return the sentence that explains the setting with the dotted ``name``."""
    group_name, _, field_name = name.rpartition(".")
    owner = GROUPS[group_name] if group_name else Params
    annotation = get_type_hints(owner, include_extras=True)[field_name]
    return next(extra.documentation for extra in get_args(annotation)[1:] if isinstance(extra, Doc))


def parse_up(text: str, name: str = "up") -> tuple[float, float, float] | None:
    """Return the unit vector that ``text`` names, or None for ``auto``; ``name`` is the setting, for the message.

    Raises
    ------
    ConfigError
        Neither a name nor three finite numbers that are not all zero, or as good as zero.

    Examples
    --------
    >>> parse_up("0,3,4")
    (0.0, 0.6, 0.8)
    """
    if text == "auto":
        return None
    if text in NAMED_UP:
        return NAMED_UP[text]
    try:
        parts = tuple(float(part) for part in text.split(","))
    except ValueError:
        parts = ()
    length = math.hypot(*parts) if parts else 0.0
    # The length of the tiniest numbers is rounded too coarsely to divide by.
    if len(parts) != 3 or not 1e-100 < length < math.inf:
        raise ConfigError(
            f'{name}: got {brief(text)}; give auto, x, y, z, -x, -y, -z, or three numbers such as "0.1,0,1"'
        )
    return (parts[0] / length, parts[1] / length, parts[2] / length)


@dataclass(frozen=True, slots=True)
class Force:
    """What the inspector decided about a level or patch by number, or about the patch at a point (scan frame, m).

    ``reason`` is the inspector's own sentence why, empty where none was given.
    """

    target: Literal["level", "patch", "at"]
    number: int
    point_m: tuple[float, float, float]
    kind: Verdict
    reason: str = ""


def parse_force(text: str) -> tuple[Force, ...]:
    r"""Return the decisions that ``overrules.force`` holds, in order.

    A reason stands in parentheses after the kind. Inside it a backslash takes the meaning off the next character, which
    a parenthesis without its partner needs.

    Raises
    ------
    ConfigError
        Not of the form ``level:3=rejected; patch:12=tread; at:0.5,1.2,0.34=landing (floor of the next room)``.

    Examples
    --------
    >>> [(force.target, force.number, force.kind) for force in parse_force("level:3=rejected; patch:12=tread")]
    [('level', 3, 'rejected'), ('patch', 12, 'tread')]
    >>> parse_force("level:3=rejected (a table; see photo (7))")[0].reason
    'a table; see photo (7)'
    """
    forces = []
    for entry, decision, reason in _split_force(text) if text.strip() else ():
        where, _, kind = (part.strip() for part in decision.partition("="))
        target, _, value = (part.strip() for part in where.partition(":"))
        try:
            numbers = [float(number) for number in value.split(",")] if target == "at" else [float(int(value))]
        except ValueError:
            numbers = []
        is_place = len(numbers) == (3 if target == "at" else 1) and all(abs(number) < 1e9 for number in numbers)
        if target not in ("level", "patch", "at") or kind not in get_args(Verdict) or not is_place:
            raise ConfigError(
                f"overrules.force: got {entry[:60]!r}; give entries such as level:3=rejected, patch:12=tread "
                "or at:0.5,1.2,0.34=landing, separated by semicolons"
            )
        _check_reason(reason)
        point = (numbers[0], numbers[1], numbers[2]) if target == "at" else (0.0, 0.0, 0.0)
        number = -1 if target == "at" else int(numbers[0])
        forces.append(Force(typing.cast(Any, target), number, point, typing.cast(Verdict, kind), reason))
    return tuple(forces)


def with_decision(force: str, place_m: Sequence[float], kind: Verdict | None, reason: str = "") -> str:
    """Return ``overrules.force`` with a decision about the surface at a place in the scan frame, metres.

    An earlier decision about the very same place, to the millimetre, is dropped, however it was written; with the kind
    None that is all that happens. The other entries stay as they were written.

    Raises
    ------
    ConfigError
        A reason of more than one line or 300 characters, or a ``force`` with a parenthesis that is not closed.

    Examples
    --------
    >>> with_decision("level:3=rejected; at:1.000,0.000,0.170=tread", (1.0, 0.0, 0.17), "landing", "wide")
    'level:3=rejected; at:1.000,0.000,0.170=landing (wide)'
    """
    place = _place_text(place_m)
    kept = [entry for entry, decision, _ in _split_force(force) if entry and _place_in(decision) != place]
    if kind is None:
        return "; ".join(kept)
    why = reason.strip()
    _check_reason(why)
    return "; ".join([*kept, f"{place}={kind}" + (f" ({_escaped(why)})" if why else "")])


def _place_text(place_m: Sequence[float]) -> str:
    # Adding zero makes a rounded -0.0 a plain zero.
    return "at:" + ",".join(f"{round(float(coordinate), 3) + 0.0:.3f}" for coordinate in place_m)


def _place_in(decision: str) -> str | None:
    """Return the place that a decision is about, as :func:`with_decision` writes it; None for a level or patch."""
    target, _, value = decision.partition("=")[0].partition(":")
    try:
        return _place_text([float(part) for part in value.split(",")]) if target.strip() == "at" else None
    except ValueError:
        return None


def _split_force(text: str) -> list[tuple[str, str, str]]:
    """Return each entry of ``overrules.force``: its whole text, the decision in it, and the reason in parentheses."""
    tokens_of: list[list[str]] = [[]]
    depth = 0
    for token in re.findall(r"\\.|.", text, re.DOTALL):
        depth += (token == "(") - (token == ")" and depth > 0)
        # A semicolon in a reason separates nothing.
        if token == ";" and depth == 0:
            tokens_of.append([])
        else:
            tokens_of[-1].append(token)
    wholes = ["".join(tokens).strip() for tokens in tokens_of]
    if depth > 0:
        raise ConfigError(
            f"overrules.force: the parenthesis in {wholes[-1][:60]!r} is not closed; close it, or write \\( "
            "for one without partner"
        )
    entries = []
    for whole in wholes:
        decision, _, reason = whole.partition("(")
        if not reason.endswith(")"):
            entries.append((whole, whole, ""))
            continue
        entries.append((whole, decision.strip(), re.sub(r"\\(.)", r"\1", reason[:-1]).strip()))
    return entries


def _check_reason(reason: str) -> None:
    if len(reason) > _LONGEST_REASON or not is_one_line(reason):
        raise ConfigError(
            f"overrules.force: the reason {reason[:60]!r} is too long or has a line break or another control "
            f"character; give one line of at most {_LONGEST_REASON} characters"
        )


def _escaped(reason: str) -> str:
    """Return a reason as it stands in parentheses: these keep their meaning only where each has its partner."""
    depths = list(itertools.accumulate((character == "(") - (character == ")") for character in reason))
    is_balanced = depths[-1] == 0 and min(depths) >= 0
    return re.sub(r"\\" if is_balanced else r"[\\()]", r"\\\g<0>", reason)


def parse_region(text: str) -> tuple[tuple[float, float, float], tuple[float, float, float]] | None:
    """Return the lowest and highest corner of a region of interest, metres in the scan's frame; None for everything.

    Raises
    ------
    ConfigError
        Not six finite numbers, or a side without length.
    """
    if not text.strip():
        return None
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        numbers = []
    if (
        len(numbers) != 6
        or not all(math.isfinite(number) for number in numbers)
        or not all(low < high for low, high in zip(numbers[:3], numbers[3:], strict=True))
    ):
        raise ConfigError(
            f"overrules.region: got {text[:80]!r}; give xmin,ymin,zmin,xmax,ymax,zmax in metres, each minimum below "
            "its maximum, or nothing"
        )
    return (numbers[0], numbers[1], numbers[2]), (numbers[3], numbers[4], numbers[5])


def is_one_line(text: str) -> bool:
    """Return whether a text can stand on one line of a page or a file: without control characters or half letters."""
    return not any(unicodedata.category(letter) in ("Cc", "Cs", "Zl", "Zp") for letter in text)


def brief(value: object) -> str:
    """Return a wrong value as a message repeats it, its end cut off where it is long."""
    try:
        shown = repr(value)
    except RecursionError:
        shown = f"a {type(value).__name__} nested too deeply to be shown"
    return shown if len(shown) <= _LONGEST_SHOWN else f"{shown[:_LONGEST_SHOWN]}..."


def check_value(name: str, value: object, kind: Any, knob: Knob | None) -> None:
    """Check one setting against its declared type and range.

    Raises
    ------
    ConfigError
        With the name, what is allowed and what was given.
    """
    if get_origin(kind) is Literal:
        if not isinstance(value, str) or value not in get_args(kind):
            raise ConfigError(f"{name}: got {brief(value)}; give one of {', '.join(get_args(kind))}")
    elif kind in (int, float):
        is_number = isinstance(value, int if kind is int else (int, float)) and not isinstance(value, bool)
        # Only a float can be infinite; asking it of a whole number of 400 digits would overflow.
        if not is_number or (isinstance(value, float) and not math.isfinite(value)):
            raise ConfigError(f"{name}: got {brief(value)}; give a {'whole ' if kind is int else ''}number")
        if knob is not None and not knob.low <= typing.cast(float, value) <= knob.high:
            raise ConfigError(f"{name}: got {brief(value)}; give a value from {knob.low:g} to {knob.high:g}")
    elif not isinstance(value, kind):
        raise ConfigError(f"{name}: got {brief(value)}; give a text")


_FIELDS: dict[type, dict[str, tuple[Any, Knob | None]]] = {}


def fields_of(group: type) -> dict[str, tuple[Any, Knob | None]]:
    """Return the type and knob of each field of a settings class, in order of declaration."""
    if group in _FIELDS:
        return _FIELDS[group]
    hints = get_type_hints(group, include_extras=True)
    result: dict[str, tuple[Any, Knob | None]] = {}
    for item in dataclasses.fields(group):
        annotation = hints[item.name]
        extras = get_args(annotation)[1:] if get_origin(annotation) is Annotated else ()
        kind = get_args(annotation)[0] if get_origin(annotation) is Annotated else annotation
        result[item.name] = (kind, next((extra for extra in extras if isinstance(extra, Knob)), None))
    # Read once per class: a slider makes new settings at every event.
    _FIELDS[group] = result
    return result


def title_of(group: type) -> str:
    """Return the name of a settings group in flags, TOML and JSON: ``LevelsParams`` is ``levels``."""
    return group.__name__.removesuffix("Params").lower()


GROUPS: dict[str, type[Group]] = {
    title_of(group): group
    for group in (
        NormalsParams,
        FloorParams,
        HorizontalParams,
        LevelsParams,
        AxesParams,
        EdgesParams,
        PatchesParams,
        FlightsParams,
        SurveyParams,
        UncertaintyParams,
        OverrulesParams,
        DisplayParams,
    )
}
"""The settings groups by their name in flags, TOML and JSON."""
