"""Is each value inside its limit? An inspection held against a rule set, finding by finding."""

import functools
import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import get_args

from stair_inspector.codes.findings import FIT_SHARE, Check, Decision, Finding, Fit, Verdict
from stair_inspector.codes.phrases import limits_text
from stair_inspector.codes.rules import LENGTH_UNITS, LIMIT_UNITS, Limit, Rule, RuleSet
from stair_inspector.errors import ConfigError
from stair_inspector.measured import difference, spread, total, usable
from stair_inspector.model import NO_NOSING, Flight, Inspection, Measured, Step
from stair_inspector.quantities import is_usable_at, quantity_of, step_value
from stair_inspector.units import shown

_ROUNDING = 1e-9
"""Differences of binary numbers are off by less: a value this near to a limit lies on it, which is inside."""
_DIFFERENCES = ("flight_range", "adjacent_difference")
_SIZE_SHARE = 0.1
"""A size is held against this share of its limit, the smaller of two, and against the room between two where that is
less. A convention of this program: the room alone, 3 in for a riser of 4 to 7 in, would call any scan good enough."""
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
    "flights_may_be_two",
)
"""Codes of the notes on the whole scan that a reader of a check must know."""
_SINGLE = "does not apply: a single step differs from nothing"
_NO_NEIGHBOURS = "does not apply: no two neighbouring steps to which the clause applies"
_NO_NUMBER = "its value or its uncertainty is no finite number"
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
        fits.append(_fit_of(rule, found, inspection.params.uncertainty.registration_m))
        if rule.from_scan == "no":
            unseen.append(f"{rule.term}, {limits_text(rule_set, rule)} ({rule.clause})")
    notes = tuple(dict.fromkeys(note.message for note in inspection.notes if note.code in _TELLING_NOTES))
    partly = [f"{rule.term}: {rule.note}" for rule in rule_set.rules if rule.from_scan == "partly" and rule.note]
    if any(rule.quantity == "two_r_plus_g" for rule in rule_set.rules) and judge.has_landings:
        partly.append(_LAST_RISER)
    notes = (*dict.fromkeys(partly), *notes)
    return Check(rule_set, decision, tuple(findings), tuple(fits), (*unseen, *rule_set.not_assessed), notes)


@dataclass(frozen=True, slots=True)
class _Place:
    """What a rule is held against in one place: a value, or the reason why there is none.

    ``u_down`` is how much smaller the value may be, where that differs from ``measured.u``; ``is_partial`` tells that
    the value is that of what was measured, and that the flight may hold more; ``is_doubtful`` that the rule may not
    apply, ``applies`` that it does not.
    """

    flight: int | None
    steps: tuple[int, ...]
    measured: Measured | None
    reason: str = ""
    u_down: float | None = None
    is_partial: bool = False
    is_doubtful: bool = False
    applies: bool = True


class _Judge:
    """Finds the places of each rule in one inspection, and judges them."""

    def __init__(self, inspection: Inspection, decision: Decision) -> None:
        self._inspection = inspection
        self._decision = decision
        self._steps = {step.step_id: step for step in inspection.steps}

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
            findings += [self._judged(rule, place) for place in self._places(rule, flight)]
        return findings

    @property
    def has_landings(self) -> bool:
        """Whether a flight ends at a landing that was seen."""
        return any(_has_upper_end(self._steps_of(flight)) for flight in self._inspection.flights)

    def _what_is_asked(self) -> str:
        return f"{_ASKED}: {'; '.join(asked.message for asked in self._inspection.questions)}"

    def _why_nothing(self) -> str:
        if self._inspection.steps:
            return "the paper's method measures nothing from nosing to nosing: measure with the method survey"
        return "no staircase was found"

    def _places(self, rule: Rule, flight: Flight) -> list[_Place]:
        if rule.statistic == "flight":
            return [self._of_flight(rule, flight)]
        chosen = self._chosen(rule, flight)
        if not chosen:
            return [self._nowhere(rule, flight)]
        if rule.statistic == "each":
            places = [self._of_step(rule, flight, step) for step in chosen]
            return places + self._unseen_riser(rule, flight, chosen[-1])
        if rule.statistic == "adjacent_difference":
            return self._differences(rule, flight, chosen)
        return [self._spread(rule, flight, chosen)]

    def _steps_of(self, flight: Flight) -> list[Step]:
        return [self._steps[step_id] for step_id in flight.step_ids]

    def _of_kind(self, rule: Rule, flight: Flight) -> list[Step]:
        """Return the steps that have the rule's quantity by their kind."""
        return [step for step in self._steps_of(flight) if step.kind in quantity_of(rule.quantity).kinds]

    def _chosen(self, rule: Rule, flight: Flight) -> list[Step]:
        """Return the steps to which a rule applies, or may apply."""
        return [step for step in self._of_kind(rule, flight) if self._applies(rule, step) is not False]

    def _applies(self, rule: Rule, step: Step) -> bool | None:
        """Tell whether a rule's condition holds at a step; None where the value is missing or too near to tell."""
        if rule.only_where is None:
            return True
        measured = step_value(step, rule.only_where.quantity)
        if measured is None:
            return None
        gap = rule.only_where.below.value - measured.value
        is_close = self._decision == "guarded" and abs(gap) < measured.u
        return None if is_close else gap > _ROUNDING

    def _nowhere(self, rule: Rule, flight: Flight) -> _Place:
        if self._of_kind(rule, flight) and rule.only_where is not None:
            condition = f"no step has a {rule.only_where.quantity} below {rule.only_where.below.text}"
            return _Place(flight.flight_id, (), None, f"does not apply: {condition}", applies=False)
        kind = quantity_of(rule.quantity).kinds[0]
        return _Place(flight.flight_id, (), None, f"no {kind} of this flight was seen")

    def _of_step(self, rule: Rule, flight: Flight, step: Step) -> _Place:
        measured = step_value(step, rule.quantity)
        if measured is None:
            reason = self._why_not(step, flight, rule.quantity)
        else:
            reason = "; ".join(self._notes_on(step, quantity_of(rule.quantity).doubted_by))
        return _Place(
            flight.flight_id, (step.step_id,), measured, reason, is_doubtful=self._applies(rule, step) is None
        )

    def _notes_on(self, step: Step, codes: Sequence[str]) -> list[str]:
        return [note.message for note in self._inspection.notes if note.step == step.step_id and note.code in codes]

    def _why_not(self, step: Step, flight: Flight, quantity: str) -> str:
        """Say why a value is missing: the survey's own note where it left one."""
        if not is_usable_at(step, quantity):
            return f"not measured at step {step.step_id}: {_NO_NUMBER}"
        here, above = step.step_id, step.step_id + 1
        is_last = here == flight.step_ids[-1]
        rests_on = quantity_of(quantity).rests_on
        for further, code in quantity_of(quantity).lost_by:
            if is_last and further:
                continue
            for note in self._inspection.notes:
                if (note.step, note.code) == (here + further, code):
                    return note.message
        # Of a nosing that was none, its neighbours have nothing either.
        near = () if rests_on == "tread" else (here, above, here - 1)
        for number in near:
            for note in self._inspection.notes:
                if note.step == number and note.code in NO_NOSING and number in flight.step_ids:
                    return note.message
        if is_last and rests_on in ("to_next", "both"):
            return f"no nosing was seen above step {here}, up to which its going is measured"
        return f"not measured at step {here}"

    def _differences(self, rule: Rule, flight: Flight, steps: Sequence[Step]) -> list[_Place]:
        places = []
        for lower, upper in itertools.pairwise(steps):
            if upper.step_id != lower.step_id + 1:
                # The clause does not apply to those between them.
                continue
            a, b = step_value(lower, rule.quantity), step_value(upper, rule.quantity)
            pair = (lower.step_id, upper.step_id)
            if a is None or b is None:
                lost = lower if a is None else upper
                places.append(_Place(flight.flight_id, pair, None, self._why_not(lost, flight, rule.quantity)))
            else:
                measured = difference(b, a, quantity_of(rule.quantity).is_chained)
                is_doubtful = None in (self._applies(rule, lower), self._applies(rule, upper))
                places.append(_Place(flight.flight_id, pair, measured, is_doubtful=is_doubtful))
        places += self._unseen_riser(rule, flight, steps[-1])
        if not places:
            reason = _SINGLE if len(steps) == 1 else _NO_NEIGHBOURS
            return [_Place(flight.flight_id, (), None, reason, applies=False)]
        return places

    def _unseen_riser(self, rule: Rule, flight: Flight, last: Step) -> list[_Place]:
        """Return the place of the riser above the last step where the flight's upper end was not seen."""
        if rule.quantity != "rise" or _has_upper_end(self._steps_of(flight)):
            return []
        return [_Place(flight.flight_id, (), None, _above(last))]

    def _spread(self, rule: Rule, flight: Flight, steps: Sequence[Step]) -> _Place:
        known = [(step, value) for step in steps if (value := step_value(step, rule.quantity)) is not None]
        missing = [step for step in steps if step_value(step, rule.quantity) is None]
        reason = self._why_partial(rule, flight, missing, len(known))
        if len(known) < 2:
            return _Place(flight.flight_id, (), None, reason or _SINGLE, applies=bool(reason))
        whole = self._spread_of(rule, flight, known, reason)
        certain = [(step, value) for step, value in known if self._applies(rule, step)]
        if whole.is_doubtful and len(certain) > 1:
            # Steps of which it is not certain that the clause applies do not excuse the others.
            sure = self._spread_of(rule, flight, certain, reason)
            if self._judged(rule, sure).verdict.is_outside:
                return sure
        return whole

    def _spread_of(self, rule: Rule, flight: Flight, known: Sequence[tuple[Step, Measured]], reason: str) -> _Place:
        """Return the largest less the smallest of the values of two steps or more."""
        measured, u_down, at = spread([value for _, value in known], quantity_of(rule.quantity).is_chained)
        extremes = [known[position][0] for position in sorted(at)]
        return _Place(
            flight.flight_id,
            tuple(step.step_id for step in extremes),
            measured,
            reason,
            u_down,
            is_partial=bool(reason),
            is_doubtful=any(self._applies(rule, step) is None for step in extremes),
        )

    def _why_partial(self, rule: Rule, flight: Flight, missing: Sequence[Step], n_known: int) -> str:
        """Say why the values are not those of the whole flight; empty where they are."""
        reasons = []
        if missing:
            first = self._why_not(missing[0], flight, rule.quantity)
            reasons.append(f"{len(missing)} of {n_known + len(missing)} values are missing ({first})")
        steps = self._steps_of(flight)
        if rule.quantity == "rise" and not _has_upper_end(steps):
            reasons.append(_above(steps[-1]))
        if flight.goes_on:
            reasons.append(f"the flight goes on: {flight.goes_on}")
        return "; ".join(reasons)

    def _of_flight(self, rule: Rule, flight: Flight) -> _Place:
        steps = self._steps_of(flight)
        if rule.quantity == "pitch":
            pitch = usable(flight.pitch_deg)
            lost = (
                _NO_NUMBER
                if flight.pitch_deg
                else "a nosing is missing or the flight has a single step: it has no line"
            )
            return _Place(flight.flight_id, (), pitch, "" if pitch else lost)
        rises = [usable(step.rise_m) for step in steps]
        open_ends = []
        if rises[0] is None:
            open_ends.append(self._why_not(steps[0], flight, "rise"))
        if not _has_upper_end(steps):
            open_ends.append(_above(steps[-1]))
        if flight.goes_on:
            open_ends.append(f"the flight goes on: {flight.goes_on}")
        if rule.quantity == "n_risers":
            count = Measured(float(flight.n_risers), 0.0)
            return _Place(flight.flight_id, (), count, "; ".join(open_ends), is_partial=bool(open_ends))
        if any(rise is None for rise in rises[1:]):
            open_ends.append("a rise within the flight was not measured")
        known = [rise for rise in rises if rise is not None]
        measured = total(known) if known else None
        return _Place(flight.flight_id, (), measured, "; ".join(open_ends), is_partial=bool(open_ends))

    def _judged(self, rule: Rule, place: _Place) -> Finding:
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
            return Verdict.WITHIN if margin >= u - _ROUNDING else Verdict.WITHIN_CLOSE
        return Verdict.OUTSIDE if -margin >= u - _ROUNDING else Verdict.OUTSIDE_CLOSE


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
    return rule.statistic in _DIFFERENCES and rule.maximum is not None and u > rule.maximum.value


def _nearest(rule: Rule, value: float) -> tuple[float | None, Limit | None]:
    """Return the distance to the limit that decides, negative beyond it, and that limit."""
    margins = _margins(rule, value)
    if not margins:
        return None, None
    margin, limit = min(margins, key=lambda pair: pair[0])
    return (0.0 if abs(margin) < _ROUNDING else margin), limit


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
        return f"inside the limit; applies to {rule.applies}, which the scan does not tell"
    return "inside the limit; the scan shows only a part of what the clause limits"


def _has_upper_end(steps: Sequence[Step]) -> bool:
    return steps[-1].kind == "landing"


def _above(step: Step) -> str:
    return f"the upper end of the flight was not seen: there may be risers above step {step.step_id}"


def _why_only_reported(rule: Rule) -> str:
    if not rule.has_number:
        return "the clause gives no number"
    return f"applies to {rule.applies}" if rule.applies else "reported without a judgement"


def _fit_of(rule: Rule, findings: Sequence[Finding], registration_m: float) -> Fit:
    """Say whether the scan is good enough to judge a rule: its largest U against the tolerance.

    In a difference all that is left is what moves single steps, of which no scan shows its own registration: where
    the user has stated none, a U that looks small enough says nothing.
    """
    doubts = [u for found in findings if (u := found.u if found.u_fit is None else found.u_fit) is not None]
    made = functools.partial(Fit, rule.rule_id, rule.quantity)
    if rule.from_scan == "no":
        return made("not assessed from a scan", None)
    if not doubts:
        return made("nothing was measured or judged", None)
    u = max(doubts)
    if rule.severity == "report_only":
        return made("reported only, U up to {u}", None, u)
    if rule.quantity == "n_risers":
        return made("fit: a count", True, u)
    tolerance = _tolerance(rule)
    if tolerance == 0.0:
        return made("not fit: what is intended lies on the limit, where no measurement decides", False, u, 0.0)
    is_fit: bool | None = u <= FIT_SHARE * tolerance
    words = "U up to {u}; this check needs at most {most}"
    if rule.statistic in _DIFFERENCES and LIMIT_UNITS[rule.quantity] == LENGTH_UNITS:
        stated = f"is stated as {1000.0 * registration_m:g} mm" if registration_m else "is not stated"
        words += f"; registration from step to step {stated}"
        if is_fit and not registration_m:
            is_fit = None
    if rule.from_scan == "partly":
        words += "; the scan shows only a part of what the clause limits"
    answer = {True: "fit", False: "not fit", None: "cannot be said"}[is_fit]
    return made(f"{answer}: {words}", is_fit, u, tolerance)


def _tolerance(rule: Rule) -> float:
    """Return what U is held against: the room between the limits, for a size at most a tenth of the smaller limit."""
    low, high = (None if limit is None else limit.value for limit in (rule.minimum, rule.maximum))
    if rule.statistic in _DIFFERENCES or not quantity_of(rule.quantity).is_size:
        return (low or 0.0) if high is None else high - (low or 0.0)
    limits = [limit for limit in (low, high) if limit is not None]
    share = _SIZE_SHARE * min(limits)
    return share if low is None or high is None else min(share, high - low)
