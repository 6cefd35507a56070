"""What a quantity is: its names, its unit, how its values are got and shown. :mod:`quantities` declares them all."""

import dataclasses
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

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
_STEP_FIELDS = frozenset(item.name for item in dataclasses.fields(Step))


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
