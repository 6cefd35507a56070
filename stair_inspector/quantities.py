"""What is measured of a staircase: every quantity once, with its names, its definition, its unit and where it is shown.

Whoever shows, writes, judges or compares quantities reads them here. To add one of a step, add a :class:`Quantity` to
:data:`QUANTITIES`: it appears in the page's table, card and comparison, in JSON, CSV and its schema, in the report, in
the terminal and in what ``stair-inspector quantities`` prints.
"""

import dataclasses
import itertools
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple, TypeGuard

from stair_inspector.measured import OWN_PARTS, combined, part_of, total, usable
from stair_inspector.model import Flight, Measured, PaperValues, Statistics, Step

LINES = ("left", "centre", "right")
"""The measuring lines as seen when climbing, in the order of the values on them."""
SiUnit = Literal["m", "deg", "tangent", "count"]
RestsOn = Literal["tread", "nosing", "from_below", "to_next", "both"]
"""What a quantity of a step hangs on: its tread alone, its nosing, its nosing and that below, its nosing and the next
one, or all three."""
OfStep = Callable[[Step, Step | None], Measured | None]
"""Takes a step and the one above it, None where there is none."""
OfFlight = Callable[[Flight, Sequence[Step]], Measured | None]
"""Takes a flight and its steps from bottom to top."""


class Notation(NamedTuple):
    """How a quantity is shown: the factor from SI, the unit's sign, the decimals where its uncertainty sets none."""

    scale: float
    unit: str
    digits: int


NOTATIONS: dict[SiUnit, Notation] = {
    "m": Notation(1000.0, "mm", 2),
    "deg": Notation(1.0, "°", 2),
    "tangent": Notation(100.0, "%", 2),
    "count": Notation(1.0, "", 0),
}


class ReportPlace(NamedTuple):
    """Which of the report's tables of steps has a column for a quantity, and where among the others, from the left."""

    table: Literal["steps", "evidence"]
    order: int


_LAST = ReportPlace("steps", 100)
_KINDS: tuple[Literal["tread", "landing"], ...] = ("tread", "landing")
_ALL_ROUND = math.sqrt(-2.0 * math.log(0.05)) / 2.0
"""A circle that holds 95 % of a normal error in two directions, in expanded uncertainties (k = 2) of one."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Quantity:
    """One quantity of a step or a flight, each value of it with an uncertainty.

    Names: ``name`` in rule sets, readings and, with its unit, files; ``label`` on a card and over a column; ``words``
    in a sentence; ``head`` over a narrow column, empty for one that the narrow tables leave out; ``definition`` what it
    is; ``code_term`` what building codes call it. An empty ``label`` is the name with blanks, empty ``words`` are the
    label.

    How to get it: ``of_step`` from a step and the one above, ``of_flight`` from a flight and its steps, ``on_lines``
    the values (3,) on the left, centre and right measuring line, ``statistics`` over a flight; all in ``unit``.
    ``made_of`` names the quantities that one is worked out from.

    What it is like: ``rests_on``; ``may_be_negative``, with a direction; ``is_size`` is meant to be far from zero;
    ``kinds`` of steps that have it; ``is_chained`` ends at nosings that neighbours share; ``is_of_line`` depends, where
    a flight curves, on the line along which it is taken. ``doubted_by`` and ``lost_by`` are codes of the notes that say
    why a value is uncertain or missing, the latter with the step that has the note: 0 its own, 1 the one above;
    ``note_words`` are words by which a note is known to be about it.

    Where it goes: ``is_in_files`` JSON and CSV; ``is_on_card`` the card of a step; ``is_limited`` rule sets may limit
    it; ``is_read`` it may be read by hand; ``place`` the report. ``is_other_in_codes`` tells that a code may use its
    name for another quantity.
    """

    name: str
    definition: str
    unit: SiUnit = "m"
    label: str = ""
    words: str = ""
    head: str = ""
    code_term: str = ""
    of_step: OfStep | None = None
    of_flight: OfFlight | None = None
    on_lines: Callable[[Step], tuple[float | None, ...] | None] | None = None
    statistics: Callable[[Flight], Statistics | None] | None = None
    made_of: tuple[str, ...] = ()
    rests_on: RestsOn = "tread"
    may_be_negative: bool = False
    is_size: bool = True
    kinds: tuple[Literal["tread", "landing"], ...] = ("tread",)
    is_chained: bool = False
    is_of_line: bool = False
    doubted_by: tuple[str, ...] = ()
    lost_by: tuple[tuple[Literal[0, 1], str], ...] = ()
    note_words: tuple[str, ...] = ()
    is_in_files: bool = True
    is_on_card: bool = True
    is_limited: bool = True
    is_read: bool = True
    is_other_in_codes: bool = False
    place: ReportPlace | None = _LAST

    def __post_init__(self) -> None:
        label = self.label or self.name.replace("_", " ")
        object.__setattr__(self, "label", label)
        object.__setattr__(self, "words", self.words or label)

    @property
    def column(self) -> str:
        """Its name with the SI unit, as in JSON: ``rise_m``."""
        return f"{self.name}_{self.unit}"

    @property
    def title(self) -> str:
        """The label as it stands over a column of the report: ``Tread depth``."""
        return self.label[:1].upper() + self.label[1:]

    @property
    def notation(self) -> Notation:
        """How its values are shown, lengths in millimetres."""
        return NOTATIONS[self.unit]

    @property
    def field(self) -> str | None:
        """The field of a :class:`Step` that holds it; None for one that is worked out."""
        return self.column if self.column in _STEP_FIELDS else None

    @property
    def lines_field(self) -> str:
        """The name of its values on the three lines: ``rise_lcr_m``."""
        return f"{self.name}_lcr_{self.unit}"

    def of(self, step: Step, above: Step | None = None) -> Measured | None:
        """Return the value of one step; None where it has none or is no quantity of a step."""
        return None if self.of_step is None else self.of_step(step, above)

    def lines_of(self, step: Step) -> tuple[float | None, ...]:
        """Return its value on each of :data:`LINES`, None where there is none."""
        values = None if self.on_lines is None else self.on_lines(step)
        return (None,) * len(LINES) if values is None else values

    def statistics_of(self, flight: Flight) -> Statistics | None:
        """Return its statistics over a flight; None where it has none."""
        return None if self.statistics is None else self.statistics(flight)


@dataclass(frozen=True, slots=True)
class PaperQuantity:
    """One quantity of the paper's method: ``name`` with ``unit`` is its name in files, ``symbol`` that of the paper.

    ``label`` stands over a column of the report; ``is_shown`` is False for what only the files hold; ``survey`` names
    the quantity of the survey that is most like it.
    """

    name: str
    unit: Literal["m", "deg"]
    symbol: str
    label: str
    definition: str
    of_paper: Callable[[PaperValues], float | None]
    is_shown: bool = True
    survey: str = ""

    @property
    def column(self) -> str:
        """Its name with the SI unit, as in JSON: ``d_fb_m``."""
        return f"{self.name}_{self.unit}"

    @property
    def notation(self) -> Notation:
        """How its values are shown."""
        return NOTATIONS[self.unit]


_STEP_FIELDS = frozenset(item.name for item in dataclasses.fields(Step))


def _two_r_plus_g(step: Step, _: Step | None) -> Measured | None:
    rise, going = usable(step.rise_m), usable(step.going_m)
    if rise is None or going is None:
        return None
    parts = {name: math.hypot(2.0 * part_of(rise, name), part_of(going, name)) for name in OWN_PARTS}
    # A tilt that makes the rises larger makes the goings smaller.
    parts["up"] = abs(2.0 * part_of(rise, "up") - part_of(going, "up"))
    parts["scale"] = 2.0 * part_of(rise, "scale") + part_of(going, "scale")
    return combined(2.0 * rise.value + going.value, parts)


def _diagonal(step: Step, above: Step | None) -> Measured | None:
    """Return the distance from a step's nosing to the next one's; a tilt turns it and leaves its length."""
    going, rise = step.going_m, None if above is None or above.flight != step.flight else above.rise_m
    if going is None or rise is None:
        return None
    length = math.hypot(going.value, rise.value)
    along, up = going.value / length, rise.value / length
    parts = {name: math.hypot(along * part_of(going, name), up * part_of(rise, name)) for name in OWN_PARTS}
    parts["up"] = abs(along * part_of(going, "up") - up * part_of(rise, "up"))
    parts["scale"] = along * part_of(going, "scale") + up * part_of(rise, "scale")
    return combined(length, parts)


def _steepest(step: Step, _: Step | None) -> Measured | None:
    """Return the slope in the steepest direction, a tangent, from the slopes along and across the climb."""
    fall, cross_fall = usable(step.fall_deg), usable(step.cross_fall_deg)
    if fall is None or cross_fall is None:
        return None
    along, across = (math.tan(math.radians(angle.value)) for angle in (fall, cross_fall))
    slope = math.hypot(along, across)
    u_along, u_across = (
        math.radians(angle.u) * (1.0 + tangent * tangent) for angle, tangent in ((fall, along), (cross_fall, across))
    )
    if slope <= max(u_along, u_across):
        # Level within its uncertainty: the steepest direction may be any.
        return Measured(slope, _ALL_ROUND * max(u_along, u_across))
    return Measured(slope, math.hypot(along * u_along, across * u_across) / slope)


def _flight_rise(flight: Flight, steps: Sequence[Step]) -> Measured | None:
    rises = [step.rise_m for step in steps]
    known = [rise for rise in rises if rise is not None]
    return total(known) if known and len(known) == len(rises) and len(rises) == flight.n_risers else None


def _flight_run(_: Flight, steps: Sequence[Step]) -> Measured | None:
    goings = [step.going_m for step in steps[:-1]]
    known = [going for going in goings if going is not None]
    return total(known) if known and len(known) == len(goings) else None


RISE = Quantity(
    name="rise",
    definition="vertical, from the nosing below, or the floor or landing in front of the lowest riser, to this nosing, "
    "on the centre line",
    head="rise",
    code_term="riser height (US), rise (UK)",
    of_step=lambda step, _: step.rise_m,
    on_lines=lambda step: step.rise_lcr_m,
    statistics=lambda flight: flight.rise,
    rests_on="from_below",
    kinds=("tread", "landing"),
    is_chained=True,
    doubted_by=("nosing_unobserved",),
    lost_by=((0, "tread_missing"), (0, "rise_unobserved")),
    note_words=("rise",),
    place=ReportPlace("steps", 1),
)
GOING = Quantity(
    name="going",
    definition="horizontal, square to the edge, from this nosing to the next, on the centre line",
    head="going",
    code_term="tread depth (US), going (UK)",
    of_step=lambda step, _: step.going_m,
    on_lines=lambda step: step.going_lcr_m,
    statistics=lambda flight: flight.going,
    rests_on="to_next",
    is_chained=True,
    is_of_line=True,
    doubted_by=("nosing_unobserved",),
    lost_by=((1, "tread_missing"),),
    note_words=("going",),
    is_other_in_codes=True,
    place=ReportPlace("steps", 2),
)
WIDTH = Quantity(
    name="width",
    definition="between the side edges of the tread; not the clear width between handrails",
    words="tread width",
    head="width",
    code_term="width (US: clear width between handrails)",
    of_step=lambda step, _: step.width_m,
    of_flight=lambda flight, _: flight.width_m,
    doubted_by=("side_unobserved",),
    note_words=("width", "side"),
    is_other_in_codes=True,
    place=ReportPlace("steps", 5),
)
PITCH = Quantity(
    name="pitch",
    unit="deg",
    definition="angle of the line from this nosing to the next; of a flight, of the line fitted to all its nosings",
    head="pitch",
    code_term="pitch (UK)",
    of_step=lambda step, _: step.pitch_deg,
    of_flight=lambda flight, _: flight.pitch_deg,
    rests_on="to_next",
    is_of_line=True,
    note_words=("pitch", "going"),
    place=ReportPlace("steps", 7),
)

QUANTITIES: tuple[Quantity, ...] = (
    RISE,
    GOING,
    Quantity(
        name="tread_depth",
        definition="from the nosing to the face of the riser above, or to the tread's back edge",
        head="depth",
        of_step=lambda step, _: step.tread_depth_m,
        rests_on="nosing",
        is_of_line=True,
        doubted_by=("nosing_unobserved", "back_hidden"),
        lost_by=((0, "back_unobserved"),),
        note_words=("depth", "back"),
        is_other_in_codes=True,
        place=ReportPlace("steps", 3),
    ),
    WIDTH,
    Quantity(
        name="nosing_overhang",
        definition="tread depth less going, square to the nosing above",
        label="overhang",
        words="nosing overhang",
        code_term="nosing projection (US), tread overlap (UK)",
        of_step=lambda step, _: step.nosing_overhang_m,
        made_of=("tread_depth", "going"),
        rests_on="to_next",
        may_be_negative=True,
        is_size=False,
        doubted_by=("back_hidden",),
        lost_by=((1, "tread_missing"), (0, "back_unobserved")),
        note_words=("overhang", "back", "depth"),
        place=ReportPlace("steps", 4),
    ),
    PITCH,
    Quantity(
        name="fall",
        unit="deg",
        definition="slope of the tread along the climb: positive where it falls towards its nosing",
        words="fall to the nosing",
        of_step=lambda step, _: step.fall_deg,
        may_be_negative=True,
        is_size=False,
        note_words=("fall",),
        is_limited=False,
        place=ReportPlace("evidence", 1),
    ),
    Quantity(
        name="cross_fall",
        unit="deg",
        definition="slope of the tread across the climb: positive where it is higher on the left, as one climbs",
        label="cross-fall",
        of_step=lambda step, _: step.cross_fall_deg,
        may_be_negative=True,
        is_size=False,
        note_words=("fall",),
        is_limited=False,
        place=ReportPlace("evidence", 2),
    ),
    Quantity(
        name="two_r_plus_g",
        definition="twice the rise to the step and its going",
        code_term="twice the rise plus the going (UK), 2R + G (AU)",
        label="2R + G",
        of_step=_two_r_plus_g,
        made_of=("rise", "going"),
        rests_on="both",
        is_of_line=True,
        doubted_by=("nosing_unobserved",),
        lost_by=(*RISE.lost_by, *GOING.lost_by),
        is_in_files=False,
        is_on_card=False,
        is_read=False,
        place=ReportPlace("steps", 6),
    ),
    Quantity(
        name="diagonal",
        definition="from this nosing to the next, along the line between them",
        of_step=_diagonal,
        rests_on="to_next",
        is_in_files=False,
        is_on_card=False,
        is_read=False,
        is_limited=False,
        place=ReportPlace("steps", 8),
    ),
    *(
        Quantity(
            name=f"{kind}_slope",
            unit="tangent",
            definition=f"slope of a {kind} in its steepest direction",
            label=f"slope of {kind}s",
            code_term=f"slope of the walking surface of {kind}s (US)",
            of_step=_steepest,
            made_of=("fall", "cross_fall"),
            is_size=False,
            kinds=(kind,),
            is_in_files=False,
            is_on_card=False,
            is_read=False,
            place=None,
        )
        for kind in _KINDS
    ),
    Quantity(
        name="flight_rise",
        definition="sum of a flight's rises",
        code_term="vertical rise of a flight (US)",
        label="total rise",
        of_flight=_flight_rise,
    ),
    Quantity(
        name="flight_run",
        definition="sum of a flight's goings, from its first nosing to its last",
        label="total run",
        of_flight=_flight_run,
        is_limited=False,
    ),
    Quantity(
        name="n_risers",
        unit="count",
        definition="number of risers of a flight, those of missing treads included",
        code_term="risers in a flight (AU)",
        label="number of risers",
        of_flight=lambda flight, _: Measured(float(flight.n_risers), 0.0),
        is_size=False,
        is_read=False,
    ),
)
"""Every quantity of a step or a flight, in the order of the files' columns."""

PAPER_QUANTITIES: tuple[PaperQuantity, ...] = (
    PaperQuantity(
        "h",
        "m",
        "h",
        "Height h",
        "height from this centroid to the next: (c_k+1 - c_k) · u",
        lambda paper: paper.h_m,
        survey="rise",
    ),
    PaperQuantity(
        "d_fb",
        "m",
        "d_FB",
        "Front to back d_FB",
        "depth front to back: f_k - b_k",
        lambda paper: paper.d_fb_m,
        survey="tread_depth",
    ),
    PaperQuantity(
        "d_ff",
        "m",
        "d_FF",
        "Front to front d_FF",
        "depth front to front: |f_k+1 - f_k|",
        lambda paper: paper.d_ff_m,
        survey="going",
    ),
    PaperQuantity("w", "m", "W", "Width W", "width between the side edges", lambda paper: paper.w_m, survey="width"),
    PaperQuantity(
        "theta",
        "deg",
        "θ",
        "Angle θ",
        "slope from this centroid to the next against the plane",
        lambda paper: paper.theta_deg,
        survey="pitch",
    ),
    PaperQuantity(
        "f", "m", "f", "Front edge f", "depth coordinate of the front edge", lambda paper: paper.f_m, is_shown=False
    ),
    PaperQuantity(
        "b", "m", "b", "Back edge b", "depth coordinate of the back edge", lambda paper: paper.b_m, is_shown=False
    ),
)
"""Every quantity of the paper's method, in the order of the files' columns."""

_BY_NAME = {quantity.name: quantity for quantity in QUANTITIES}

OF_STEP = tuple(quantity for quantity in QUANTITIES if quantity.of_step is not None)
OF_FLIGHT = tuple(quantity for quantity in QUANTITIES if quantity.of_flight is not None)
IN_FILES = tuple(quantity for quantity in OF_STEP if quantity.is_in_files)
"""Quantities of a step that JSON and CSV hold."""
ON_CARD = tuple(quantity for quantity in OF_STEP if quantity.is_on_card)
"""Quantities of a step that its card shows."""
IN_TABLE = tuple(quantity for quantity in OF_STEP if quantity.head)
"""Quantities of a step that the narrow tables of page and terminal have room for."""
ON_LINES = tuple(quantity for quantity in OF_STEP if quantity.on_lines is not None)
"""Quantities of a step that are measured on three lines."""
COMPARED = tuple(quantity for quantity in QUANTITIES if quantity.statistics is not None)
"""Quantities of which a flight has statistics."""
LIMITED = tuple(quantity for quantity in QUANTITIES if quantity.is_limited)
"""Quantities that a rule set may limit."""
SHOWN_OF_PAPER = tuple(quantity for quantity in PAPER_QUANTITIES if quantity.is_shown)
SURVEY_VALUES = tuple(quantity.field for quantity in IN_FILES if quantity.field is not None)
"""The fields of :class:`Step` that hold a value with its uncertainty."""


def is_si_unit(word: str) -> TypeGuard[SiUnit]:
    """Tell whether a word is the unit that a quantity's name may end in."""
    return word in NOTATIONS


def quantity_of(name: str) -> Quantity:
    """Return the quantity of a name.

    Raises
    ------
    KeyError
        There is none.
    """
    return _BY_NAME[name]


def with_above(steps: Sequence[Step]) -> Iterable[tuple[Step, Step | None]]:
    """Return each step with the one above it, None for the last."""
    return itertools.zip_longest(steps, steps[1:])


def paper_value(step: Step, quantity: Quantity) -> float | None:
    """Return what the paper's method has for a quantity of the survey; None where it has nothing like it."""
    paper = next((each for each in PAPER_QUANTITIES if each.survey == quantity.name), None)
    return None if paper is None else paper.of_paper(step.paper)


def step_value(step: Step, name: str) -> Measured | None:
    """Return a quantity of one step, None where it was not measured or is not usable."""
    return usable(quantity_of(name).of(step))


def is_usable_at(step: Step, name: str) -> bool:
    """Tell whether all that a quantity of a step is made of is a number where it was measured."""
    values = [quantity_of(part).of(step) for part in (name, *quantity_of(name).made_of)]
    return all(value is None or usable(value) is not None for value in values)


def in_report(table: Literal["steps", "evidence"]) -> Iterable[Quantity]:
    """Return the quantities that a table of the report has columns for, from the left."""
    placed = [
        (quantity.place.order, quantity) for quantity in OF_STEP if quantity.place and quantity.place.table == table
    ]
    return (quantity for _, quantity in sorted(placed, key=lambda pair: pair[0]))
