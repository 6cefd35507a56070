"""Is each value inside its limit? An inspection held against a rule set, finding by finding."""

from typing import get_args

from stair_inspector.codes.findings import Check, Decision, Finding, Fit, Verdict
from stair_inspector.codes.fits import DIFFERENCES, fit_of
from stair_inspector.codes.limits import Limit
from stair_inspector.codes.phrases import limits_text
from stair_inspector.codes.places import ROUNDING, Places, RulePlace
from stair_inspector.codes.rule_sets import RuleSet
from stair_inspector.codes.rules import Rule
from stair_inspector.errors import ConfigError
from stair_inspector.model import Flight, Inspection
from stair_inspector.quantities import quantity_of
from stair_inspector.units import shown

_WINDING = "winders and spirals are not judged: codes measure them on a walking line of their own"
_CURVED = (
    "of a flight that curves this is known on its middle line, and codes limit it on a walking line of their own: not "
    "judged"
)
_ON_MIDDLE_LINE = "measured on the middle line of a flight that curves"
_TOO_UNSURE = "U is larger than the limit itself: this scan says nothing about it"
_ASKED = "a question about the scan has to be answered first"
_TELLING_NOTES = (
    "uncertainty_unstated",
    "up_disagree",
    "treads_lean",
    "chain_ambiguous",
    "overrule_unmet",
    "no_staircase",
    "goes_on",
    "runner",
    "two_levels",
    "thing_on_tread",
    "flights_may_be_two",
    "flights_may_be_one",
    "strip_unseen",
)
"""Codes of the notes on the whole scan that a reader of a check must know."""
_LAST_RISER = "the riser up to a landing has no going above it: it is in no sum of twice the rise and the going"


def check(inspection: Inspection, rule_set: RuleSet, decision: Decision = "guarded") -> Check:
    """Hold an inspection against a rule set.

    Parameters
    ----------
    inspection : Inspection
        With the survey's values; those of the paper's method are not what codes limit, and are not judged.
    rule_set : RuleSet
    decision : "guarded" or "simple"
        Whether the verdict heeds the uncertainty; see :data:`findings.DECISIONS`.

    Returns
    -------
    Check
        One finding per rule and step, pair of neighbours or flight. What was not measured is a finding of its own:
        not measured is no pass.

    Raises
    ------
    ConfigError
        Unknown decision rule.

    References
    ----------
    .. [1] ILAC-G8:09/2019, Guidelines on Decision Rules and Statements of Conformity.
    .. [2] JCGM 106:2012, The role of measurement uncertainty in conformity assessment.
    """
    if decision not in get_args(Decision):
        raise ConfigError(f"decision: got {decision!r}; give one of {', '.join(get_args(Decision))}")
    judge = _Judge(inspection, decision)
    findings: list[Finding] = []
    fits: list[Fit] = []
    unseen: list[str] = []
    for rule in rule_set.rules:
        found = judge.findings_of(rule)
        findings += found
        fits.append(fit_of(rule, found, inspection.params.uncertainty.registration_m))
        if rule.from_scan == "no":
            unseen.append(f"{rule.term}, {limits_text(rule_set, rule)} ({rule.clause})")
    notes = tuple(dict.fromkeys(note.message for note in inspection.notes if note.code in _TELLING_NOTES))
    partly = [f"{rule.term}: {rule.note}" for rule in rule_set.rules if rule.from_scan == "partly" and rule.note]
    if any(rule.quantity == "two_r_plus_g" for rule in rule_set.rules) and judge.places.has_landings:
        partly.append(_LAST_RISER)
    notes = (*dict.fromkeys(partly), *notes)
    return Check(rule_set, decision, tuple(findings), tuple(fits), (*unseen, *rule_set.not_assessed), notes)


class _Judge:
    """Judges what each rule is held against in one inspection."""

    def __init__(self, inspection: Inspection, decision: Decision) -> None:
        self._inspection = inspection
        self._decision = decision
        self.places = Places(inspection, decision)

    def findings_of(self, rule: Rule) -> list[Finding]:
        """Return what one rule says, flight by flight."""
        if rule.from_scan == "no":
            return [Finding(rule, None, (), Verdict.NOT_ASSESSED, reason="not assessed from a scan: check it on site")]
        if self._inspection.is_withheld:
            return [Finding(rule, None, (), Verdict.NOT_JUDGED, reason=self._what_is_asked())]
        if not self._inspection.flights:
            return [Finding(rule, None, (), Verdict.NOT_MEASURED, reason=self._why_nothing())]
        findings = []
        for flight in self._inspection.flights:
            reason = _why_not_by_shape(rule, flight)
            if reason:
                findings.append(Finding(rule, flight.flight_id, (), Verdict.NOT_JUDGED, reason=reason))
                continue
            findings += [self._judged(rule, place) for place in self.places.of(rule, flight)]
        return findings

    def _what_is_asked(self) -> str:
        return f"{_ASKED}: {'; '.join(asked.message for asked in self._inspection.questions)}"

    def _why_nothing(self) -> str:
        if self._inspection.steps:
            return "the paper's method measures nothing from nosing to nosing: measure with the method survey"
        return "no staircase was found"

    def _judged(self, rule: Rule, place: RulePlace) -> Finding:
        # Steps of which it is not certain that the clause applies do not excuse the others.
        sure = None if place.certain is None else self._judged(rule, place.certain)
        if sure is not None and sure.verdict.is_outside:
            return sure
        measured = place.measured
        if measured is None:
            verdict = Verdict.NOT_MEASURED if place.applies else Verdict.NOT_JUDGED
            return Finding(rule, place.flight, place.steps, verdict, reason=place.reason, applies=place.applies)
        margin, limit = _nearest(rule, measured.value)
        if rule.severity == "report_only" or margin is None:
            reason = place.reason or _why_only_reported(rule)
            return Finding(
                rule, place.flight, place.steps, Verdict.REPORTED, measured.value, measured.u, margin, limit, reason
            )
        is_too_large = limit is rule.maximum and margin < 0.0
        u = place.u_down if is_too_large and place.u_down is not None else measured.u
        verdict = self._verdict(margin, u)
        reason = place.reason
        if quantity_of(rule.quantity).is_of_line and self._is_curved(place.flight):
            reason = _joined(_ON_MIDDLE_LINE, reason)
        is_certain = limit is rule.maximum if verdict.is_outside else rule.maximum is None
        if place.is_partial and not is_certain:
            # More of the flight can only make a spread, a count or a sum larger.
            verdict = Verdict.NOT_MEASURED
            reason = f"{shown(rule.quantity, measured.value)} is what was measured of it: {reason}"
        if place.is_doubtful and verdict.is_outside:
            verdict = Verdict.NOT_JUDGED
            reason = _joined(reason, f"beyond the limit, but {_why_doubtful(rule)}")
        elif place.is_doubtful:
            reason = _joined(reason, "whether the clause applies here is not certain")
        if verdict.is_outside and -margin < u and _says_nothing(rule, u):
            verdict = Verdict.NOT_JUDGED
            reason = _joined(reason, _TOO_UNSURE)
        if rule.from_scan == "partly" and verdict.is_within:
            verdict = Verdict.REPORTED
            reason = _joined(reason, _why_partly(rule))
        u_fit = max(measured.u, place.u_down or 0.0) if is_too_large else measured.u
        return Finding(rule, place.flight, place.steps, verdict, measured.value, u, margin, limit, reason, u_fit)

    def _is_curved(self, flight_id: int | None) -> bool:
        return any(flight.flight_id == flight_id and flight.shape == "curved" for flight in self._inspection.flights)

    def _verdict(self, margin: float, u: float) -> Verdict:
        if self._decision == "simple":
            return Verdict.WITHIN if margin >= 0.0 else Verdict.OUTSIDE
        if margin >= 0.0:
            return Verdict.WITHIN if margin >= u - ROUNDING else Verdict.WITHIN_CLOSE
        return Verdict.OUTSIDE if -margin >= u - ROUNDING else Verdict.OUTSIDE_CLOSE


def _why_not_by_shape(rule: Rule, flight: Flight) -> str:
    """Say why a rule cannot be held against a flight of this shape; empty where it can.

    How even a curved flight's goings are shows on any line along it: all grow alike from its inner side outwards.
    """
    if flight.shape in ("winder", "spiral"):
        return _WINDING
    is_size = rule.statistic in ("each", "flight")
    return _CURVED if flight.shape == "curved" and is_size and quantity_of(rule.quantity).is_of_line else ""


def _says_nothing(rule: Rule, u: float) -> bool:
    """Return whether a difference is less certain than its limit is large: then any scan would seem to exceed it."""
    return rule.statistic in DIFFERENCES and rule.maximum is not None and u > rule.maximum.value


def _nearest(rule: Rule, value: float) -> tuple[float | None, Limit | None]:
    """Return the distance to the limit that decides, negative beyond it, and that limit."""
    margins = _margins(rule, value)
    if not margins:
        return None, None
    margin, limit = min(margins, key=lambda pair: pair[0])
    return (0.0 if abs(margin) < ROUNDING else margin), limit


def _margins(rule: Rule, value: float) -> list[tuple[float, Limit]]:
    margins = []
    if rule.minimum is not None:
        margins.append((value - rule.minimum.value, rule.minimum))
    if rule.maximum is not None:
        margins.append((rule.maximum.value - value, rule.maximum))
    return margins


def _joined(*parts: str) -> str:
    return "; ".join(part for part in parts if part)


def _why_doubtful(rule: Rule) -> str:
    condition = rule.only_where
    if condition is None:
        return "whether the clause applies here is not certain"
    words = condition.quantity.replace("_", " ")
    return (
        f"the clause applies only where the {words} is below {condition.below.text}, and here the {words} was not "
        "measured or is too near to tell"
    )


def _why_partly(rule: Rule) -> str:
    """Say why a value inside the limits of a rule of which a scan shows only a part is no value within."""
    if rule.quantity == "width":
        return "the tread's width is inside the limit; the clear width was not seen"
    if rule.applies:
        return f"inside the limit, where the clause applies: {rule.applies}"
    return "inside the limit; the scan shows only a part of what the clause limits"


def _why_only_reported(rule: Rule) -> str:
    if not rule.has_number:
        return "the clause gives no number"
    return f"applies to {rule.applies}" if rule.applies else "reported without a judgement"
