"""Rule sets: what a clause limits, by which statistic, and from which text. Data only; :mod:`judge` applies them."""

import re
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Literal, get_args

from stair_inspector.errors import ConfigError, is_one_line
from stair_inspector.quantities import LIMITED, SiUnit

Statistic = Literal["each", "flight_range", "adjacent_difference", "flight"]
Severity = Literal["limit", "advisory", "report_only"]
FromScan = Literal["yes", "partly", "no"]
Grade = Literal["P", "S", "G"]
Side = Literal["minimum", "maximum"]

OWN_FILE = "user's own file, not a set that comes with the program"
"""What is said of a rule set whose file the program does not bring."""

GRADES = {
    "P": "official text, or a word-for-word copy of it, was read",
    "S": "stored secondary sources agree",
    "G": "general knowledge, not checked",
}
"""What the grade of a record says about its source."""

UNITS: dict[str, Fraction] = {
    "m": Fraction(1),
    "cm": Fraction(1, 100),
    "mm": Fraction(1, 1000),
    "in": Fraction(254, 10_000),
    "ft": Fraction(3048, 10_000),
    "deg": Fraction(1),
    "slope": Fraction(1),
    "%": Fraction(1, 100),
    "count": Fraction(1),
}
"""Units of a limit and their exact size: lengths in metres, angles in degrees, slopes as tangents, counts."""
LENGTH_UNITS = ("m", "cm", "mm", "in", "ft")
SLOPE_UNITS = ("slope", "%")

_UNITS_OF: dict[SiUnit, tuple[str, ...]] = {
    "m": LENGTH_UNITS,
    "deg": ("deg",),
    "tangent": SLOPE_UNITS,
    "count": ("count",),
}
LIMIT_UNITS: dict[str, tuple[str, ...]] = {
    **{quantity.name: _UNITS_OF[quantity.unit] for quantity in LIMITED},
    "other": tuple(UNITS),
}
"""What can be limited, and the units of its limits. ``other`` is what no scan shows."""
_ONLY_OF_FLIGHTS = tuple(quantity.name for quantity in LIMITED if quantity.of_step is None)
_ONLY_OF_STEPS = tuple(
    quantity.name for quantity in LIMITED if quantity.name not in _ONLY_OF_FLIGHTS and quantity.name != "pitch"
)
"""``pitch`` is judged as a step's and as a flight's."""

_PLAIN = r"[0-9]{1,6}(?:\.[0-9]{1,9})?"
_NUMBER = re.compile(
    rf"(?:(?P<whole>[0-9]{{1,6}}) )?(?P<over>[0-9]{{1,6}})/(?P<under>[0-9]{{1,6}})|(?P<plain>{_PLAIN})"
)
_LONG = re.compile(r"[0-9]{7}|\.[0-9]{10}")
_SLOPE = re.compile(rf"1:(?P<run>{_PLAIN})")
_ID = re.compile(r"[a-z0-9](?:[a-z0-9.-]{0,79})")
_TEXT_LIMIT = 2000
_TURNERS = frozenset("\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069")
"""Letters that turn the direction of those after them, so that a text reads as another than it is."""
_CHAINED_ALONE = ("pitch", "two_r_plus_g")
"""Quantities of which neighbours share nosings in a way that no difference of two of them heeds."""


def parse_written(written: str, unit: str) -> Fraction:
    """Return the exact size of a limit as it is written: metres, degrees, a tangent or a count.

    Parameters
    ----------
    written : str
        ``"7 3/4"``, ``"3/8"``, ``"44"``, ``"16.5"``, or for the unit ``"slope"`` ``"1:48"``.
    unit : str
        One of :data:`UNITS`.

    Raises
    ------
    ConfigError
        Unknown unit, or no number as a code writes it.
    """
    if unit not in UNITS:
        raise ConfigError(f"unit {unit[:20]!r} is not known; give one of {', '.join(UNITS)}")
    if unit == "slope":
        slope = _SLOPE.fullmatch(written)
        if slope is None or not Fraction(slope["run"]):
            raise ConfigError(f"{written[:40]!r} is no slope; write it as 1:48")
        return 1 / Fraction(slope["run"])
    number = _NUMBER.fullmatch(written)
    if number is None and _LONG.search(written) is not None:
        raise ConfigError(f"{written[:40]!r} has too many digits; give at most six, and nine after the point")
    if number is None or (number["under"] is not None and not int(number["under"])):
        raise ConfigError(f"{written[:40]!r} is no number; write it as 11, 16.5, 3/8 or 7 3/4")
    if number["plain"] is not None:
        size = Fraction(number["plain"])
    else:
        size = int(number["whole"] or 0) + Fraction(int(number["over"]), int(number["under"]))
    if unit == "count" and size.denominator != 1:
        raise ConfigError(f"{written!r} is no count; give a whole number")
    return size * UNITS[unit]


@dataclass(frozen=True, slots=True)
class Limit:
    """A limit as its code writes it, and its exact size.

    ``value`` is the float next to the exact size: metres, degrees, a tangent (of a slope) or a count.
    """

    written: str
    unit: str
    value: float

    def __post_init__(self) -> None:
        size = parse_written(self.written, self.unit)
        if self.value != float(size):
            raise ConfigError(
                f"limit {self.written} {self.unit} is {float(size)!r}, not {self.value!r}; use Limit.of to convert it"
            )

    @classmethod
    def of(cls, written: str, unit: str) -> "Limit":
        """Return the limit with these words, converted exactly.

        Raises
        ------
        ConfigError
            As :func:`parse_written`.
        """
        return cls(written, unit, float(parse_written(written, unit)))

    @property
    def exact(self) -> Fraction:
        """The exact size: metres, degrees, a tangent or a count."""
        return parse_written(self.written, self.unit)

    @property
    def as_written(self) -> str:
        """The limit as its code writes it: ``3/8 in``, ``1:48``, ``42°``, ``18``."""
        if self.unit in ("slope", "count"):
            return self.written
        return f"{self.written}°" if self.unit == "deg" else f"{self.written} {self.unit}"

    @property
    def text(self) -> str:
        """The limit for people, with its size in millimetres or per cent: ``3/8 in (9.525 mm)``."""
        if self.unit in LENGTH_UNITS and self.unit != "mm":
            return f"{self.as_written} ({_decimal(self.exact * 1000)} mm)"
        if self.unit == "slope":
            return f"{self.as_written} ({_decimal(self.exact * 100)} %)"
        return self.as_written


def _decimal(size: Fraction) -> str:
    """Return at most four decimals, rounded half to even, without trailing zeros."""
    text = f"{float(round(size, 4)):.4f}"
    return text.rstrip("0").rstrip(".")


@dataclass(frozen=True, slots=True)
class Condition:
    """A rule holds only for steps whose ``quantity`` is below a limit, as nosings where the tread is under 11 in."""

    quantity: str
    below: Limit

    def __post_init__(self) -> None:
        _check_member("only_where: quantity", self.quantity, _ONLY_OF_STEPS)
        _check_unit("only_where", self.quantity, self.below)


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
            _check_text(f"{place}: {name}", getattr(self, name))
        for name in ("applies", "note"):
            _check_text(f"{place}: {name}", getattr(self, name), may_be_empty=True)
        _check_member(f"{place}: quantity", self.quantity, tuple(LIMIT_UNITS))
        for name, kind in (("statistic", Statistic), ("severity", Severity), ("from_scan", FromScan), ("grade", Grade)):
            _check_member(f"{place}: {name}", getattr(self, name), get_args(kind))
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
                _check_unit(f"{place}: {name}", self.quantity, limit)
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


@dataclass(frozen=True, slots=True)
class RuleSet:
    """A rule set of one edition and variant.

    ``file`` and ``sha256`` (hex) are the name and the hash of the file it was read from; ``edits`` what was changed
    since, oldest first; ``overlays`` what was laid over it, in words. ``not_assessed`` are sentences on what the code
    limits and no scan shows. An overlay holds rules to be used beside those of a full set. ``is_shipped``
    tells that the file is one that comes with the program, byte for byte.
    """

    set_id: str
    name: str
    edition: str
    variant: str
    source: str
    rules: tuple[Rule, ...]
    not_assessed: tuple[str, ...] = ()
    file: str = ""
    sha256: str = ""
    edits: tuple[RuleEdit, ...] = ()
    overlays: tuple[str, ...] = ()
    is_overlay: bool = False
    is_shipped: bool = False

    def __post_init__(self) -> None:
        check_id("set id", self.set_id)
        for name in ("name", "edition", "source"):
            _check_text(f"rule set {self.set_id}: {name}", getattr(self, name))
        _check_text(f"rule set {self.set_id}: variant", self.variant, may_be_empty=True)
        _check_text(f"rule set {self.set_id}: the name of its file", self.file, may_be_empty=True)
        for text in self.not_assessed:
            _check_text(f"rule set {self.set_id}: not_assessed", text)
        if not self.rules:
            raise ConfigError(f"rule set {self.set_id}: has no rule; give at least one")
        seen: set[str] = set()
        for rule in self.rules:
            if rule.rule_id in seen:
                raise ConfigError(f"rule set {self.set_id}: rule {rule.rule_id} is there twice; rename or remove one")
            seen.add(rule.rule_id)

    @property
    def is_edited(self) -> bool:
        """Whether a user has changed a limit."""
        return bool(self.edits)

    @property
    def edited_words(self) -> str:
        """Whether a user has changed a limit, in words; of a file of the user's own that it is one."""
        answer = "yes" if self.is_edited else "no"
        return answer if self.is_shipped else f"{OWN_FILE}; limits edited afterwards: {answer}"

    @property
    def n_changed(self) -> int:
        """How many limits are other ones than those of the files."""
        sides = dict.fromkeys((edit.rule_id, edit.side) for edit in self.edits)
        return sum(self.edit_of(*side) is not None for side in sides)

    @property
    def grades(self) -> str:
        """The grades of its records, best first: ``P``, ``PS``, ``SG`` ..."""
        return "".join(grade for grade in GRADES if any(rule.grade == grade for rule in self.rules))

    @property
    def title(self) -> str:
        """Name, edition and variant in one line."""
        return ", ".join(part for part in (self.name, self.edition, self.variant) if part)

    def rule(self, rule_id: str) -> Rule:
        """Return the rule with this id.

        Raises
        ------
        ConfigError
            There is none.
        """
        for rule in self.rules:
            if rule.rule_id == rule_id:
                return rule
        known = ", ".join(rule.rule_id for rule in self.rules)
        raise ConfigError(f"rule set {self.set_id}: has no rule {rule_id[:80]!r}; its rules are {known}")

    def edit_of(self, rule_id: str, side: Side) -> RuleEdit | None:
        """Return what the changes of a limit come to: from the file's to the present one, with the last reason.

        None where the limit is that of the file, also after it was changed and changed back.
        """
        own = [edit for edit in self.edits if (edit.rule_id, edit.side) == (rule_id, side)]
        if not own or own[0].before == own[-1].after:
            return None
        return replace(own[-1], before=own[0].before)

    def is_changed(self, rule_id: str) -> bool:
        """Whether a limit of a rule is another one than that of the file."""
        return any(self.edit_of(rule_id, side) is not None for side in get_args(Side))

    def is_reported_in_file(self, rule_id: str) -> bool:
        """Whether the file has a rule as reported only, also where a user's limit has made it a judged one.

        Raises
        ------
        ConfigError
            There is no such rule.
        """
        rule = self.rule(rule_id)
        own = [edit for edit in self.edits if edit.rule_id == rule_id]
        return own[0].is_of_reported if own else rule.severity == "report_only"


def edited(rule_set: RuleSet, rule_id: str, side: Side, limit: Limit | None, reason: str) -> RuleSet:
    """Return the rule set with one limit changed and the change recorded.

    Changing a limit twice keeps both records, so that the list tells what happened. The same limit again is no edit.
    A rule that is reported only is judged, as a limit, while it has a limit of the user's: nobody gives one for less.

    Parameters
    ----------
    rule_set : RuleSet
    rule_id : str
    side : "minimum" or "maximum"
    limit : Limit or None
        The new one; None takes the limit away.
    reason : str
        Why, in the user's words.

    Raises
    ------
    ConfigError
        Unknown rule, no reason, a unit that does not fit, or minimum above maximum.
    """
    _check_member("side", side, get_args(Side))
    rule = rule_set.rule(rule_id)
    _check_text(f"rule {rule_id}: reason", reason)
    before = rule.minimum if side == "minimum" else rule.maximum
    if before == limit:
        return rule_set
    is_of_reported = rule_set.is_reported_in_file(rule_id)
    after = replace(
        rule_set, edits=(*rule_set.edits, RuleEdit(rule_id, side, before, limit, reason, is_of_reported=is_of_reported))
    )
    severity = rule.severity
    if is_of_reported:
        changes = (after.edit_of(rule_id, each) for each in get_args(Side))
        is_judged = any(change is not None and change.after is not None for change in changes)
        severity = "limit" if is_judged else "report_only"
    minimum, maximum = (limit, rule.maximum) if side == "minimum" else (rule.minimum, limit)
    changed = replace(rule, minimum=minimum, maximum=maximum, severity=severity)
    return replace(after, rules=tuple(changed if each.rule_id == rule_id else each for each in rule_set.rules))


def overlaid(base: RuleSet, overlay: RuleSet) -> RuleSet:
    """Return the base with the overlay's rules beside its own.

    Raises
    ------
    ConfigError
        ``overlay`` is a full set, or both have a rule of one id.
    """
    if not overlay.is_overlay:
        raise ConfigError(f"rule set {overlay.set_id} is a full set, no overlay; check against it by itself")
    words = overlay.title + f" ({overlay.set_id}" + (f", SHA-256 {overlay.sha256})" if overlay.sha256 else ")")
    if not overlay.is_shipped:
        words += f", {OWN_FILE}"
    countries = [each.set_id.partition("-")[0] for each in (base, overlay)]
    if base.is_shipped and overlay.is_shipped and countries[0] != countries[1]:
        words += f": made for sets {countries[1]}-..., not for {base.set_id}; take it as advice of another country"
    return replace(
        base,
        rules=base.rules + overlay.rules,
        not_assessed=tuple(dict.fromkeys(base.not_assessed + overlay.not_assessed)),
        edits=base.edits + overlay.edits,
        overlays=(*base.overlays, words),
    )


def is_plain_line(text: str) -> bool:
    """Return whether a text is one line that reads in its own order: no control and no turn of the direction."""
    return is_one_line(text) and _TURNERS.isdisjoint(text)


def check_id(what: str, text: str) -> None:
    """Raise ConfigError unless the text is an id: small letters, digits, dots and hyphens."""
    if not isinstance(text, str) or _ID.fullmatch(text) is None:
        shown = repr(text)[:60]
        raise ConfigError(f"{what} {shown}: give up to 80 small letters, digits, dots and hyphens, as us-irc-2024")


def _check_text(place: str, text: str, may_be_empty: bool = False) -> None:
    if not isinstance(text, str) or len(text) > _TEXT_LIMIT:
        raise ConfigError(f"{place}: give a text of at most {_TEXT_LIMIT} characters in quotes")
    if not text.strip() and not may_be_empty:
        raise ConfigError(f"{place}: is empty; fill it in")
    if not is_plain_line(text):
        raise ConfigError(f"{place}: holds a line break or a control character; write it on one line")


def _check_member(place: str, value: str, known: tuple[str, ...]) -> None:
    if value not in known:
        raise ConfigError(f"{place}: got {repr(value)[:60]}; give one of {', '.join(known)}")


def _check_unit(place: str, quantity: str, limit: Limit) -> None:
    if limit.unit not in LIMIT_UNITS[quantity]:
        fitting = ", ".join(LIMIT_UNITS[quantity])
        if limit.unit == "count":
            raise ConfigError(f"{place}: {limit.written} has no unit; write one of {fitting} after it")
        raise ConfigError(f"{place}: {limit.as_written} is no limit of {quantity}; its units are {fitting}")
