"""What a check says: findings of the rules of a set, and whether the scan is good enough to judge them."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from typing import Literal

from stair_inspector.codes.limits import Limit
from stair_inspector.codes.rule_sets import RuleSet
from stair_inspector.codes.rules import Rule, RuleEdit, Side
from stair_inspector.units import shown

Decision = Literal["guarded", "simple"]

DECISIONS: dict[str, str] = {
    "guarded": (
        "A value is within a limit when it stays inside even if it is wrong by its expanded uncertainty U (k = 2), and "
        "outside when it stays outside; a value nearer to the limit than U is called close (ILAC-G8, JCGM 106)."
    ),
    "simple": (
        "Simple acceptance: a value is within a limit when the measured value is, whatever its uncertainty U; a value "
        "near the limit may be wrongly accepted or rejected (ILAC-G8, JCGM 106)."
    ),
}
"""The decision rules, in words to be printed with every check."""


FIT_SHARE = 0.5
"""A check is fit when U is at most half the tolerance: what is as intended can then be found within, not close."""


class Verdict(Enum):
    """What is said of one value, or why nothing is; the value of a member is its name in files."""

    WITHIN = "within"
    WITHIN_CLOSE = "within_close"
    OUTSIDE_CLOSE = "outside_close"
    OUTSIDE = "outside"
    NOT_MEASURED = "not_measured"
    NOT_JUDGED = "not_judged"
    REPORTED = "reported"
    NOT_ASSESSED = "not_assessed"

    @property
    def words(self) -> str:
        """The verdict for people: ``within, close``."""
        return self.value.replace("_close", ", close").replace("_", " ")

    @property
    def is_outside(self) -> bool:
        """Whether the value lies beyond its limit, close or not."""
        return self in (Verdict.OUTSIDE, Verdict.OUTSIDE_CLOSE)

    @property
    def is_listed(self) -> bool:
        """Whether every single value with this verdict is told of; what is plainly within is counted."""
        return self.is_outside or self in (Verdict.WITHIN_CLOSE, Verdict.NOT_MEASURED, Verdict.NOT_JUDGED)

    @property
    def is_within(self) -> bool:
        """Whether the value lies inside its limits, close or not."""
        return self in (Verdict.WITHIN, Verdict.WITHIN_CLOSE)


GRAVITY = (
    Verdict.OUTSIDE,
    Verdict.OUTSIDE_CLOSE,
    Verdict.NOT_MEASURED,
    Verdict.NOT_JUDGED,
    Verdict.WITHIN_CLOSE,
    Verdict.WITHIN,
    Verdict.REPORTED,
    Verdict.NOT_ASSESSED,
)
"""Verdicts, the gravest first: of several findings the first in this order is the one to show."""


@dataclass(frozen=True, slots=True)
class Finding:
    """What one rule says of one step, one pair of neighbours or one flight.

    ``value``, its expanded uncertainty ``u`` (k = 2) and ``margin`` are metres, degrees, tangents or counts, as the
    rule's quantity; ``margin`` is the distance to ``limit``, the nearest one, negative beyond it. ``flight`` is None
    where the finding is about the whole scan, ``steps`` empty where it is about a flight as such. ``reason`` says why
    there is no verdict, or what it leaves open. A value without a verdict is what was measured of it. ``u_fit`` is what
    tells whether the scan is good enough: the larger of the uncertainties to both sides. ``applies`` is False where the
    rule is about nothing here.
    """

    rule: Rule
    flight: int | None
    steps: tuple[int, ...]
    verdict: Verdict
    value: float | None = None
    u: float | None = None
    margin: float | None = None
    limit: Limit | None = None
    reason: str = ""
    u_fit: float | None = None
    applies: bool = True

    @property
    def side(self) -> Side | None:
        """Which of the rule's limits ``limit`` is."""
        if self.limit is None:
            return None
        return "minimum" if self.limit is self.rule.minimum else "maximum"

    @property
    def is_reported_beyond(self) -> bool:
        """Whether a value that is only reported lies beyond the number of its clause: for people to look at."""
        return self.verdict is Verdict.REPORTED and self.margin is not None and self.margin < 0.0

    @property
    def is_open(self) -> bool:
        """Whether the rule applies, or may, and nothing is said of it: no pass."""
        return self.applies and self.verdict in (Verdict.NOT_MEASURED, Verdict.NOT_JUDGED)


@dataclass(frozen=True, slots=True)
class Fit:
    """Is the scan good enough for this rule? ``u``, the largest of its values', is held against ``tolerance``.

    ``sentence`` says it, with ``{u}`` and ``{most}``, the largest that ``u`` may be, where :meth:`said` writes sizes.
    ``is_fit`` is None where there is nothing to say: nothing was measured, or the rule has no number. With a
    ``tolerance`` it is None where it cannot be said: of a difference whose registration is not stated.
    """

    rule_id: str
    quantity: str
    sentence: str
    is_fit: bool | None
    u: float | None = None
    tolerance: float | None = None

    @property
    def words(self) -> str:
        """The answer as a sentence, sizes in the unit in which the rule's quantity is shown."""
        return self.said(lambda size: shown(self.quantity, size))

    def said(self, write: Callable[[float], str]) -> str:
        """Return the answer as a sentence; ``write`` gives the words for a size of the rule's quantity, SI."""
        sizes = {"u": self.u, "most": None if self.tolerance is None else FIT_SHARE * self.tolerance}
        return self.sentence.format(**{name: "" if size is None else write(size) for name, size in sizes.items()})

    @property
    def short(self) -> str:
        """The answer in a word or two; a hyphen where there is nothing to say."""
        if self.is_fit is None:
            return "-" if self.tolerance is None else "cannot be said"
        return "fit" if self.is_fit else "not fit"


@dataclass(frozen=True, slots=True)
class Check:
    """An inspection held against a rule set. ``fits`` has one entry per rule; ``notes`` are sentences on the whole."""

    rule_set: RuleSet
    decision: Decision
    findings: tuple[Finding, ...]
    fits: tuple[Fit, ...]
    not_assessed: tuple[str, ...]
    notes: tuple[str, ...] = ()

    @property
    def is_outside(self) -> bool:
        """Whether a value lies outside a limit, close or not; advisory rules do not count."""
        return any(found.rule.severity == "limit" and found.verdict.is_outside for found in self.findings)

    @property
    def is_judged(self) -> bool:
        """Whether at least one value was held against a limit."""
        return any(found.verdict.is_within or found.verdict.is_outside for found in self.findings)

    def of_rule(self, rule_id: str) -> tuple[Finding, ...]:
        """Return the findings of one rule, in the order of flights and steps."""
        return tuple(found for found in self.findings if found.rule.rule_id == rule_id)

    def edit_behind(self, found: Finding) -> RuleEdit | None:
        """Return the user's change of the limit that a finding is held against; None where that is the file's own."""
        side = found.side
        return None if side is None else self.rule_set.edit_of(found.rule.rule_id, side)

    def of_step(self, step_id: int) -> tuple[Finding, ...]:
        """Return the findings in which a step takes part."""
        return tuple(found for found in self.findings if step_id in found.steps)


def gravest(findings: tuple[Finding, ...]) -> Finding:
    """Return the finding to show for several: the gravest verdict, of those the one nearest to or furthest beyond.

    Raises
    ------
    ValueError
        There is no finding.
    """
    return min(
        findings, key=lambda found: (GRAVITY.index(found.verdict), 0.0 if found.margin is None else found.margin)
    )
