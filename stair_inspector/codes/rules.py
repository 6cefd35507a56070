"""Rules: what a clause limits, and by which statistic. Data only; :mod:`judge` applies them."""

from dataclasses import dataclass, field
from typing import Literal, get_args

from stair_inspector.codes.limits import LIMIT_UNITS, Limit, check_unit
from stair_inspector.codes.texts import check_id, check_member, check_plain_text
from stair_inspector.errors import ConfigError
from stair_inspector.quantities import LIMITED

Statistic = Literal["each", "flight_range", "adjacent_difference", "flight"]
Severity = Literal["limit", "advisory", "report_only"]
FromScan = Literal["yes", "partly", "no"]
Grade = Literal["P", "S", "G"]
Side = Literal["minimum", "maximum"]

GRADES = {
    "P": "official text, or a word-for-word copy of it, was read",
    "S": "stored secondary sources agree",
    "G": "general knowledge, not checked",
}
"""What the grade of a record says about its source."""

_ONLY_OF_FLIGHTS = tuple(quantity.name for quantity in LIMITED if quantity.of_step is None)
_ONLY_OF_STEPS = tuple(
    quantity.name for quantity in LIMITED if quantity.name not in _ONLY_OF_FLIGHTS and quantity.name != "pitch"
)
"""``pitch`` is judged as a step's and as a flight's."""
_CHAINED_ALONE = ("pitch", "two_r_plus_g")
"""Quantities of which neighbours share nosings in a way that no difference of two of them heeds."""


@dataclass(frozen=True, slots=True)
class Condition:
    """A rule holds only for steps whose ``quantity`` is below a limit, as nosings where the tread is under 11 in."""

    quantity: str
    below: Limit

    def __post_init__(self) -> None:
        check_member("only_where: quantity", self.quantity, _ONLY_OF_STEPS)
        check_unit("only_where", self.quantity, self.below)


@dataclass(frozen=True, slots=True)
class Rule:
    """One record of a rule set.

    ``term`` is the code's own word, ``quantity`` ours (a key of :data:`LIMIT_UNITS`): the mapping lives here.
    ``statistic``: of ``each`` step, the largest less the smallest of a flight, the ``adjacent_difference`` between
    neighbours, or a value of the ``flight``. ``severity``: a ``limit`` can be found outside; an ``advisory`` warns;
    ``report_only`` is shown without a judgement. ``from_scan``: ``partly`` when the scan shows less than the clause
    limits, ``no`` when it shows nothing of it. ``applies`` says in words to what the clause applies, where a scan does
    not tell; ``only_where`` is the same where it does.
    """

    rule_id: str
    clause: str
    term: str
    quantity: str
    statistic: Statistic
    minimum: Limit | None
    maximum: Limit | None
    severity: Severity
    from_scan: FromScan
    grade: Grade
    applies: str = ""
    note: str = ""
    only_where: Condition | None = None

    def __post_init__(self) -> None:
        check_id("rule id", self.rule_id)
        place = f"rule {self.rule_id}"
        for name in ("clause", "term"):
            check_plain_text(f"{place}: {name}", getattr(self, name))
        for name in ("applies", "note"):
            check_plain_text(f"{place}: {name}", getattr(self, name), may_be_empty=True)
        check_member(f"{place}: quantity", self.quantity, tuple(LIMIT_UNITS))
        for name, kind in (("statistic", Statistic), ("severity", Severity), ("from_scan", FromScan), ("grade", Grade)):
            check_member(f"{place}: {name}", getattr(self, name), get_args(kind))
        self._check_statistic(place)
        self._check_limits(place)

    def _check_statistic(self, place: str) -> None:
        is_of_flight = self.statistic == "flight"
        if (self.quantity in _ONLY_OF_FLIGHTS and not is_of_flight) or (
            self.quantity in _ONLY_OF_STEPS and is_of_flight
        ):
            fitting = "flight" if self.quantity in _ONLY_OF_FLIGHTS else "each, flight_range or adjacent_difference"
            raise ConfigError(f"{place}: statistic: {self.quantity} has no {self.statistic!r}; give {fitting}")
        if self.quantity in _CHAINED_ALONE and self.statistic in ("flight_range", "adjacent_difference"):
            raise ConfigError(
                f"{place}: statistic: the {self.statistic!r} of {self.quantity} is not judged; limit rise and going"
            )
        if (self.quantity == "other") != (self.from_scan == "no"):
            raise ConfigError(
                f"{place}: from_scan: quantity 'other' is what no scan shows, from_scan = 'no'; give both"
            )

    def _check_limits(self, place: str) -> None:
        for name, limit in (("minimum", self.minimum), ("maximum", self.maximum)):
            if limit is not None:
                check_unit(f"{place}: {name}", self.quantity, limit)
        if not self.has_number:
            if self.severity != "report_only" and self.from_scan != "no":
                raise ConfigError(f"{place}: has no limit; give a minimum or a maximum, or severity 'report_only'")
        elif self.minimum is not None and self.maximum is not None and self.minimum.exact > self.maximum.exact:
            raise ConfigError(
                f"{place}: minimum {self.minimum.text} is above maximum {self.maximum.text}; exchange them"
            )

    @property
    def has_number(self) -> bool:
        """Whether its clause limits by a number, and does not just ask for something."""
        return self.minimum is not None or self.maximum is not None

    @property
    def limit_text(self) -> str:
        """The limits for people: ``4 in (101.6 mm) to 7 in (177.8 mm)``, ``at most 42°``, ``no number``."""
        if self.minimum is not None and self.maximum is not None:
            return f"{self.minimum.text} to {self.maximum.text}"
        if self.minimum is not None:
            return f"at least {self.minimum.text}"
        return "no number" if self.maximum is None else f"at most {self.maximum.text}"


@dataclass(frozen=True, slots=True)
class RuleEdit:
    """A limit that a user has changed, with the reason.

    ``is_of_reported`` tells that the file has its rule as reported only; it follows from the file, and :func:`edited`
    writes it.
    """

    rule_id: str
    side: Side
    before: Limit | None
    after: Limit | None
    reason: str
    is_of_reported: bool = field(default=False, compare=False)
