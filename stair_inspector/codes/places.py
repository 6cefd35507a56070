"""Where is a rule held against an inspection? At steps, between neighbours, or over flights; and why somewhere not."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace

from stair_inspector.codes.findings import Decision
from stair_inspector.codes.rules import Rule
from stair_inspector.measured import difference, spread, total, usable
from stair_inspector.model import NO_NOSING, Flight, Inspection, Measured, Step
from stair_inspector.quantities import is_usable_at, quantity_of, step_value

ROUNDING = 1e-9
"""Differences of binary numbers are off by less: a value this near to a limit lies on it, which is inside."""
_SINGLE = "does not apply: a single step differs from nothing"
_NO_NEIGHBOURS = "does not apply: no two neighbouring steps to which the clause applies"
_NO_NUMBER = "its value or its uncertainty is no finite number"


@dataclass(frozen=True, slots=True)
class RulePlace:
    """What a rule is held against in one place: a value, or the reason why there is none.

    ``u_down`` is how much smaller the value may be, where that differs from ``measured.u``; ``is_partial`` tells that
    the value is that of what was measured, and that the flight may hold more; ``is_doubtful`` that the rule may not
    apply, ``applies`` that it does not; ``certain`` is the place without the steps of which that is not certain.
    """

    flight: int | None
    steps: tuple[int, ...]
    measured: Measured | None
    reason: str = ""
    u_down: float | None = None
    is_partial: bool = False
    is_doubtful: bool = False
    applies: bool = True
    certain: "RulePlace | None" = None


class Places:
    """Finds the places of each rule in one inspection."""

    def __init__(self, inspection: Inspection, decision: Decision) -> None:
        self._inspection = inspection
        self._decision = decision
        self._steps = {step.step_id: step for step in inspection.steps}

    @property
    def has_landings(self) -> bool:
        """Whether a flight ends at a landing that was seen."""
        return any(_has_upper_end(self._steps_of(flight)) for flight in self._inspection.flights)

    def of(self, rule: Rule, flight: Flight) -> list[RulePlace]:
        """Return where a rule is held against a flight: one place a step, pair of neighbours, or flight."""
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
        return None if is_close else gap > ROUNDING

    def _nowhere(self, rule: Rule, flight: Flight) -> RulePlace:
        if self._of_kind(rule, flight) and rule.only_where is not None:
            condition = f"no step has a {rule.only_where.quantity} below {rule.only_where.below.text}"
            return RulePlace(flight.flight_id, (), None, f"does not apply: {condition}", applies=False)
        kind = quantity_of(rule.quantity).kinds[0]
        return RulePlace(flight.flight_id, (), None, f"no {kind} of this flight was seen")

    def _of_step(self, rule: Rule, flight: Flight, step: Step) -> RulePlace:
        measured = step_value(step, rule.quantity)
        if measured is None:
            reason = self._why_not(step, flight, rule.quantity)
        else:
            reason = "; ".join(self._notes_on(step, quantity_of(rule.quantity).doubted_by))
        return RulePlace(
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

    def _differences(self, rule: Rule, flight: Flight, steps: Sequence[Step]) -> list[RulePlace]:
        places = []
        for lower, upper in itertools.pairwise(steps):
            if upper.step_id != lower.step_id + 1:
                # The clause does not apply to those between them.
                continue
            a, b = step_value(lower, rule.quantity), step_value(upper, rule.quantity)
            pair = (lower.step_id, upper.step_id)
            if a is None or b is None:
                lost = lower if a is None else upper
                places.append(RulePlace(flight.flight_id, pair, None, self._why_not(lost, flight, rule.quantity)))
            else:
                measured = difference(b, a, quantity_of(rule.quantity).is_chained)
                is_doubtful = None in (self._applies(rule, lower), self._applies(rule, upper))
                places.append(RulePlace(flight.flight_id, pair, measured, is_doubtful=is_doubtful))
        places += self._unseen_riser(rule, flight, steps[-1])
        if not places:
            reason = _SINGLE if len(steps) == 1 else _NO_NEIGHBOURS
            return [RulePlace(flight.flight_id, (), None, reason, applies=False)]
        return places

    def _unseen_riser(self, rule: Rule, flight: Flight, last: Step) -> list[RulePlace]:
        """Return the place of the riser above the last step where the flight's upper end was not seen."""
        if rule.quantity != "rise" or _has_upper_end(self._steps_of(flight)):
            return []
        return [RulePlace(flight.flight_id, (), None, _above(last))]

    def _spread(self, rule: Rule, flight: Flight, steps: Sequence[Step]) -> RulePlace:
        known = [(step, value) for step in steps if (value := step_value(step, rule.quantity)) is not None]
        missing = [step for step in steps if step_value(step, rule.quantity) is None]
        reason = self._why_partial(rule, flight, missing, len(known))
        if len(known) < 2:
            return RulePlace(flight.flight_id, (), None, reason or _SINGLE, applies=bool(reason))
        whole = self._spread_of(rule, flight, known, reason)
        certain = [(step, value) for step, value in known if self._applies(rule, step)]
        if whole.is_doubtful and len(certain) > 1:
            return replace(whole, certain=self._spread_of(rule, flight, certain, reason))
        return whole

    def _spread_of(self, rule: Rule, flight: Flight, known: Sequence[tuple[Step, Measured]], reason: str) -> RulePlace:
        """Return the largest less the smallest of the values of two steps or more."""
        measured, u_down, at = spread([value for _, value in known], quantity_of(rule.quantity).is_chained)
        extremes = [known[position][0] for position in sorted(at)]
        return RulePlace(
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

    def _of_flight(self, rule: Rule, flight: Flight) -> RulePlace:
        steps = self._steps_of(flight)
        if rule.quantity == "pitch":
            pitch = usable(flight.pitch_deg)
            lost = (
                _NO_NUMBER
                if flight.pitch_deg
                else "a nosing is missing or the flight has a single step: it has no line"
            )
            return RulePlace(flight.flight_id, (), pitch, "" if pitch else lost)
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
            return RulePlace(flight.flight_id, (), count, "; ".join(open_ends), is_partial=bool(open_ends))
        if any(rise is None for rise in rises[1:]):
            open_ends.append("a rise within the flight was not measured")
        known = [rise for rise in rises if rise is not None]
        measured = total(known) if known else None
        return RulePlace(flight.flight_id, (), measured, "; ".join(open_ends), is_partial=bool(open_ends))


def _has_upper_end(steps: Sequence[Step]) -> bool:
    return steps[-1].kind == "landing"


def _above(step: Step) -> str:
    return f"the upper end of the flight was not seen: there may be risers above step {step.step_id}"
