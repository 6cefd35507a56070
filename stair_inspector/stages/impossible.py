"""Is what was measured a step, and all of it? Values that are none are taken out, with the reason in their place."""

import dataclasses
import math
from collections.abc import Container, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.arrays import Floats
from stair_inspector.model import (
    BLURRED,
    CUT_FRONT,
    CUT_SIDES,
    IMPOSSIBLE,
    Examination,
    Flight,
    Horizontal,
    Note,
    Patches,
    Scan,
    Step,
    StepShape,
)
from stair_inspector.params import FlightsParams
from stair_inspector.quantities import IN_TABLE, OF_STEP
from stair_inspector.quantity_types import Quantity, RestsOn
from stair_inspector.stages.blurred import find_blurred
from stair_inspector.stages.flight_values import mean_width_of, statistics_of
from stair_inspector.stages.region import note_region_cuts
from stair_inspector.stages.survey import Survey


def _fields_of(*kinds: RestsOn) -> tuple[str, ...]:
    """Return the fields of a step that hold quantities of these kinds, those on its lines too."""
    chosen = [quantity for quantity in OF_STEP if quantity.rests_on in kinds]
    on_lines = [quantity.lines_field for quantity in chosen if quantity.on_lines is not None]
    return (*(quantity.field for quantity in chosen if quantity.field is not None), *on_lines)


def _made_of(quantity: Quantity) -> tuple[str, ...]:
    """Return the fields of a step that hold what is worked out from a quantity."""
    return tuple(other.field for other in OF_STEP if quantity.name in other.made_of and other.field is not None)


_OVER_NOSING = _fields_of("to_next")
"""What a step has from its own nosing to the next one."""
_UP_TO_NOSING = _fields_of("from_below")
"""What a step has from the nosing below to its own."""
_OF_NOSING = (*_UP_TO_NOSING, *_fields_of("nosing"), *_OVER_NOSING)
"""What of a step hangs on its own nosing."""
_OF_SIDES, _OF_BACK = ("width_m",), ("tread_depth_m", "nosing_overhang_m")
"""What of a step hangs on its sides, and on its back edge."""
_POSITIVE = tuple(
    quantity for quantity in IN_TABLE if quantity.unit == "m" and quantity.rests_on != "to_next" and quantity.field
)
"""Lengths that are none where they are not above zero; what runs to the next nosing is reviewed with that."""


@dataclass(slots=True)
class _Lost:
    """What is taken out, by step number, and why."""

    fields: dict[int, set[str]] = field(default_factory=dict)
    notes: list[Note] = field(default_factory=list)

    def take(self, step: Step | None, *names: str) -> None:
        if step is not None:
            self.fields.setdefault(step.step_id, set()).update(names)

    def take_nosing(self, steps: Sequence[Step], k: int) -> None:
        """Take out what hangs on the nosing of one step of a flight."""
        self.take(steps[k], *_OF_NOSING)
        self.take(steps[k - 1] if k else None, *_OVER_NOSING)
        self.take(steps[k + 1] if k + 1 < len(steps) else None, *_UP_TO_NOSING)


def take_out_impossible(
    survey: Survey,
    limits: FlightsParams,
    shapes: Sequence[Sequence[StepShape]] = (),
    examined: Examination | None = None,
) -> Survey:
    """Take out of a survey what no staircase has, and what a camera saw too badly.

    A going that is not positive, a pitch that is steeper than any stair, nosings that cross: then one of the two edges
    was found in the wrong place, and so is everything that is measured from it. It is the one that fits its other
    neighbour worse; where neither has another, both are doubted. A rise, a depth or a width that is not positive is
    taken out by itself.

    Parameters
    ----------
    survey : Survey
        As it was measured.
    limits : FlightsParams
        A stair with the largest rise that the user looks for is possible however steep it is.
    shapes, examined
        Of the same scan. Of a camera's frame, steps that are too blurred are taken out as well.

    Returns
    -------
    Survey
        The same one where all is possible. Otherwise those values are None, a note with the step's number says why, and
        the statistics and the pitch of the flight are without them.
    """
    lost = _Lost()
    blurred = find_blurred(shapes) if examined is not None and examined.is_view else {}
    by_id = {step.step_id: step for step in survey.steps}
    steepest_deg = steepest_pitch_deg(limits)
    for flight in survey.flights:
        own = [by_id[number] for number in flight.step_ids]
        for k, step in enumerate(own):
            if step.step_id in blurred:
                lost.take_nosing(own, k)
                lost.notes.append(Note(BLURRED, "impossible", blurred[step.step_id], step.step_id))
        # What is out needs no other reason.
        left = [_without_fields(step, lost.fields.get(step.step_id, ())) for step in own]
        _review_flight(left, flight.shape == "straight", steepest_deg, lost)
    return _taken_out(survey, lost) if lost.fields else survey


def take_out_cut(survey: Survey, scan: Scan, horizontal: Horizontal, patches: Patches, region: str) -> Survey:
    """Take out of a survey what ends at a face of the region of interest, or of the box of the file that was read.

    Parameters
    ----------
    survey : Survey
        As it was measured.
    scan, horizontal, patches
        Of the same scan.
    region : str
        As ``overrules.region`` gives it; empty for none.

    Returns
    -------
    Survey
        The same one where nothing is cut. Otherwise a step whose sides are cut has no width, one whose back is cut no
        depth, one whose front is cut nothing that is measured from its nosing; a note says so of each.
    """
    if not region and scan.part is None:
        return survey
    own = [patches.surfaces[number] for number in survey.surfaces]
    points = [scan.points[horizontal.point_ids[surface.rows]] for surface in own]
    spacings_m = [surface.spacing_m for surface in own]
    notes = note_region_cuts(scan, horizontal.up, region, survey.steps, points, spacings_m)
    if not notes:
        return survey
    lost = _Lost(notes=notes)
    by_id = {step.step_id: step for step in survey.steps}
    for note in notes:
        flight = next(flight for flight in survey.flights if note.step in flight.step_ids)
        steps = [by_id[number] for number in flight.step_ids]
        k = next(k for k, step in enumerate(steps) if step.step_id == note.step)
        if note.code == CUT_FRONT:
            lost.take_nosing(steps, k)
        else:
            lost.take(steps[k], *(_OF_SIDES if note.code == CUT_SIDES else _OF_BACK))
    return _taken_out(survey, lost, with_widths=True)


def _taken_out(survey: Survey, lost: _Lost, *, with_widths: bool = False) -> Survey:
    steps = tuple(_without_fields(step, lost.fields.get(step.step_id, ())) for step in survey.steps)
    flights = tuple(_without(flight, steps, lost.fields.keys()) for flight in survey.flights)
    if with_widths:
        flights = tuple(_with_width(flight, steps, lost) for flight in flights)
    return dataclasses.replace(survey, steps=steps, flights=flights, notes=(*survey.notes, *lost.notes))


def _with_width(flight: Flight, steps: Sequence[Step], lost: _Lost) -> Flight:
    """Return a flight with the width of those of its steps that still have one."""
    own = [step for step in steps if step.step_id in flight.step_ids]
    if not any("width_m" in lost.fields.get(step.step_id, ()) for step in own):
        return flight
    return dataclasses.replace(flight, width_m=mean_width_of(own))


def _without_fields(step: Step, names: Iterable[str]) -> Step:
    nothing: dict[str, Any] = dict.fromkeys(names)
    return dataclasses.replace(step, **nothing)


def steepest_pitch_deg(limits: FlightsParams) -> float:
    """Return the pitch above which there is no stair, degrees; the user's largest rise over a usual going has less."""
    return max(priors.STEEPEST_PITCH_DEG, math.degrees(math.atan(limits.max_rise_m / priors.USUAL_GOING_M)))


def _review_flight(steps: Sequence[Step], is_straight: bool, steepest_deg: float, lost: _Lost) -> None:
    why = {}
    for k, step in enumerate(steps):
        upper = steps[k + 1] if k + 1 < len(steps) else None
        reason = _why_not(step, upper, is_straight, steepest_deg)
        if reason:
            why[k] = reason
        for quantity in _POSITIVE:
            measured = quantity.of(step)
            if measured is not None and measured.value <= 0.0:
                lost.take(step, str(quantity.field), *_made_of(quantity))
                message = (
                    f"step {step.step_id}: a {quantity.head} of {_mm(measured.value)} is none: its edges were mistaken"
                )
                lost.notes.append(Note(IMPOSSIBLE, "impossible", message, step.step_id))
    goings = [step.going_m.value for k, step in enumerate(steps) if step.going_m is not None and k not in why]
    usual_m = float(np.median(goings)) if goings else priors.USUAL_GOING_M
    for k, reason in why.items():
        for wrong in _mistaken(steps, k, why, usual_m):
            lost.take_nosing(steps, wrong)
            number = steps[wrong].step_id
            message = (
                f"step {number}: {reason}, as on no staircase: what was found is not its nosing, and nothing is "
                "measured from it"
            )
            lost.notes.append(Note(IMPOSSIBLE, "impossible", message, number))


def _why_not(step: Step, upper: Step | None, is_straight: bool, steepest_deg: float) -> str:
    """Return what is impossible from the nosing of a step to the next one, empty if nothing."""
    pair = "the next nosing" if upper is None else f"the nosing of step {upper.step_id}"
    going = step.going_m
    if going is not None and going.value <= 0.0:
        return f"{pair} would lie {_mm(-going.value)} in front of that of step {step.step_id}"
    lines = [going_m for going_m in step.going_lcr_m or () if going_m is not None]
    if any(going_m <= 0.0 for going_m in lines) or (is_straight and upper is not None and _cross(step, upper)):
        return f"{pair} would cross that of step {step.step_id}"
    if step.pitch_deg is not None and step.pitch_deg.value > steepest_deg:
        return f"{pair} would lie {step.pitch_deg.value:.0f}° above that of step {step.step_id}"
    return ""


def _cross(lower: Step, upper: Step) -> bool:
    """Return whether the nosings of two steps cross in plan."""
    if lower.nosing is None or upper.nosing is None or lower.climb is None or lower.going_m is None:
        return False
    (a, b), (c, d) = lower.nosing, upper.nosing
    return _sides(a, b, c, d, lower.climb) and _sides(c, d, a, b, lower.climb)


def _sides(a: Floats, b: Floats, c: Floats, d: Floats, climb: Floats) -> bool:
    """Return whether two points c and d lie on different sides of the line from a to b; all as seen in plan."""
    up = np.cross(climb, b - a)
    first, second = (float(np.cross(b - a, end - a) @ up) for end in (c, d))
    return first * second < 0.0


def _mistaken(steps: Sequence[Step], k: int, why: dict[int, str], usual_m: float) -> list[int]:
    """Return which of two steps between which something is impossible has the wrong edge: one of them, or both."""
    if k + 1 == len(steps):
        return [k]
    # The other going that each edge has a part in; an impossible one speaks against it as none does.
    others = (k - 1, k + 1)
    off = []
    for other in others:
        going = steps[other].going_m if 0 <= other < len(steps) and other not in why else None
        off.append(math.inf if going is None else abs(going.value - usual_m))
    if off[0] == off[1]:
        return [k, k + 1]
    return [k] if off[0] > off[1] else [k + 1]


def _without(flight: Flight, steps: Sequence[Step], concerned: Container[int]) -> Flight:
    """Return a flight without what was taken out of its steps."""
    own = [step for step in steps if step.step_id in flight.step_ids]
    if not any(step.step_id in concerned for step in own):
        return flight
    has_line = all(step.rise_m is not None for step in own[1:]) and all(step.going_m is not None for step in own[:-1])
    return dataclasses.replace(
        flight,
        pitch_deg=flight.pitch_deg if has_line else None,
        rise=statistics_of([(step.step_id, step.rise_m) for step in own]),
        going=statistics_of([(step.step_id, step.going_m) for step in own if step.kind == "tread"]),
    )


def _mm(length_m: float) -> str:
    return f"{length_m * 1000.0:.0f} mm"
