"""What the inspector decides instead of the program, as it is written in a setting.

A direction (``overrules.climb``, and ``up``), decisions about surfaces (``overrules.force``), a box
(``overrules.region``). Coordinates are metres in the scan's frame. The settings themselves are declared at the end.
"""

import itertools
import math
import re
import typing
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Literal, get_args

from stair_inspector.declarations import Group, Setting, parse_box
from stair_inspector.errors import ConfigError, brief, is_one_line

ForcedKind = Literal["tread", "landing", "rejected"]

_LONGEST_REASON = 300
_FARTHEST_M = 1e9

NAMED_UP: dict[str, tuple[float, float, float]] = {
    "x": (1.0, 0.0, 0.0),
    "y": (0.0, 1.0, 0.0),
    "z": (0.0, 0.0, 1.0),
    "-x": (-1.0, 0.0, 0.0),
    "-y": (0.0, -1.0, 0.0),
    "-z": (0.0, 0.0, -1.0),
}
"""Up vectors that have a name, in the scan's frame."""


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
    kind: ForcedKind
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
        is_place = len(numbers) == (3 if target == "at" else 1) and all(abs(number) < _FARTHEST_M for number in numbers)
        if target not in ("level", "patch", "at") or kind not in get_args(ForcedKind) or not is_place:
            raise ConfigError(
                f"overrules.force: got {entry[:60]!r}; give entries such as level:3=rejected, patch:12=tread "
                "or at:0.5,1.2,0.34=landing, separated by semicolons"
            )
        _check_reason(reason)
        point = (numbers[0], numbers[1], numbers[2]) if target == "at" else (0.0, 0.0, 0.0)
        number = -1 if target == "at" else int(numbers[0])
        forces.append(Force(typing.cast(Any, target), number, point, typing.cast(ForcedKind, kind), reason))
    return tuple(forces)


def with_decision(force: str, place_m: Sequence[float], kind: ForcedKind | None, reason: str = "") -> str:
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


@dataclass(frozen=True, slots=True)
class Region:
    """A region of interest: the lowest and highest corner of its box, metres in the scan's frame.

    With ``bearing_deg`` the box stands upright and is turned about its middle; else it lies along the scan's axes. See
    :func:`~stair_inspector.geometry.boxes.turned_box`.
    """

    low: tuple[float, float, float]
    high: tuple[float, float, float]
    bearing_deg: float | None = None


def parse_region(text: str) -> Region | None:
    """Return the region of interest that a setting names; None for everything.

    Raises
    ------
    ConfigError
        Not six finite numbers, or seven with a bearing of at most a full turn and no corner beyond 1e9 m; or a side
        without length.

    Examples
    --------
    >>> parse_region("0,0,0,1,2,3,30").bearing_deg
    30.0
    """
    corners, bearing_deg = text, None
    if text.count(",") == 6:
        corners, _, last = text.rpartition(",")
        try:
            bearing_deg = float(last)
        except ValueError:
            bearing_deg = math.nan
        if not -360.0 <= bearing_deg <= 360.0:
            raise ConfigError(
                f"overrules.region: got the bearing {brief(last)}; give degrees about the vertical, from -360 to 360"
            )
    box = parse_box(corners, "overrules.region", "metres")
    if box is not None and bearing_deg is not None and not all(abs(number) <= _FARTHEST_M for number in sum(box, ())):
        raise ConfigError(f"overrules.region: got {text[:80]!r}; give the corners of a turned box within 1e9 m")
    return None if box is None else Region(*box, bearing_deg)


def region_text(region: Region) -> str:
    """Return a region of interest as it stands in the setting."""
    bearing = () if region.bearing_deg is None else (region.bearing_deg,)
    return ",".join(repr(value) for value in (*region.low, *region.high, *bearing))


@dataclass(frozen=True)
class OverrulesParams(Group):
    """What the inspector decides instead of the program (survey)."""

    force: Annotated[
        str,
        Setting("Surfaces", place="overrules").says(
            "Surfaces whose kind is decided, as 'level:3=rejected; patch:12=tread; at:0.5,1.2,0.34=landing'; "
            "'at' takes the surface nearest to a point of the scan's frame, metres. A reason may follow in "
            "parentheses: 'level:3=rejected (a table)'."
        ),
    ] = ""
    climb: Annotated[
        str,
        Setting("Climb", place="overrules").says(
            "Direction of climb in the scan's frame: auto, x, y, z, -x, -y, -z, or three numbers; flights that "
            "climb otherwise, by more than 45 degrees, are not taken."
        ),
    ] = "auto"
    region: Annotated[
        str,
        Setting("Region", place="scene").says(
            "Box to measure in, 'xmin,ymin,zmin,xmax,ymax,zmax' in the scan's frame, metres; empty for everything. A "
            "seventh number turns it about its middle and the vertical: degrees, from x towards y where z is up."
        ),
    ] = ""

    def __post_init__(self) -> None:
        super().__post_init__()
        parse_force(self.force)
        parse_up(self.climb, "overrules.climb")
        parse_region(self.region)
