"""The line of the nosings of a flight, developed along its walking line, and how far each nosing lies off it."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stair_inspector.geometry.arrays import Floats
from stair_inspector.model import Flight, Inspection, Measured, Step

FEWEST_NOSINGS = 3
"""Two nosings always lie on one line."""
_OWN = ("noise", "resolution", "layers")
_JOINED_M = 0.06
"""A flight begins at the landing whose nosing lies within this height of the foot of its first riser."""


@dataclass(frozen=True, slots=True, eq=False)
class WalkingLine:
    """The nosings of successive steps on the centre line, in the plane of going and rise.

    ``runs_m`` and ``heights_m`` (n,) are measured from the first nosing; ``has_going`` and ``has_rise`` (n,) tell
    whether the way from the nosing before was measured, or is only that between the two nosings' own places, as across
    a missing tread. Those of the first nosing are False.
    """

    step_ids: tuple[int, ...]
    runs_m: Floats
    heights_m: Floats
    has_going: tuple[bool, ...]
    has_rise: tuple[bool, ...]


@dataclass(frozen=True, slots=True, eq=False)
class NosingLine:
    """A flight's nosings and their best-fit line.

    ``deviations_m`` (n,) are square to the line, positive above it; ``u_m`` (n,) their expanded uncertainties (k = 2)
    from noise and edge definition, what all nosings have in common left out; NaN where they are not known.
    """

    walk: WalkingLine
    deviations_m: Floats
    u_m: Floats
    pitch_deg: float


def line_over_nosings(steps: Sequence[Step], up: Floats) -> WalkingLine | None:
    """Return the walking line over these steps, None where one of them has no nosing.

    Parameters
    ----------
    steps : sequence of Step
        Successive, from bottom to top.
    up : (3,)
        Unit vector, local.
    """
    runs, heights, has_going, has_rise = [0.0], [0.0], [False], [False]
    if any(step.line_points is None or step.climb is None for step in steps):
        return None
    for lower, upper in itertools.pairwise(steps):
        run_m, height_m = _between(lower, upper, up)
        has_going.append(lower.going_m is not None)
        has_rise.append(upper.rise_m is not None)
        runs.append(runs[-1] + (run_m if lower.going_m is None else lower.going_m.value))
        heights.append(heights[-1] + (height_m if upper.rise_m is None else upper.rise_m.value))
    ids = tuple(step.step_id for step in steps)
    return WalkingLine(ids, np.array(runs), np.array(heights), tuple(has_going), tuple(has_rise))


def is_joined(lower: Step, upper: Step, up: Floats) -> bool:
    """Return whether one climbs from a step to the next: within a flight, or from a landing to the flight above it."""
    if lower.flight == upper.flight:
        return True
    if lower.kind != "landing" or upper.rise_m is None or lower.line_points is None or upper.line_points is None:
        return False
    rise_m = float((upper.line_points[1] - lower.line_points[1]) @ up)
    return abs(rise_m - upper.rise_m.value) <= _JOINED_M


def nosing_line(inspection: Inspection, flight: Flight) -> NosingLine | None:
    """Return a flight's nosings and their best-fit line, None where fewer than three nosings are known.

    Notes
    -----
    The line is the one of the flight's pitch: heights fitted over the way along the flight by least squares. This is
    the drawn form of the sight along the nosings with which a stair is judged by eye.
    """
    by_id = {step.step_id: step for step in inspection.steps}
    steps = [by_id[number] for number in flight.step_ids]
    walk = line_over_nosings(steps, inspection.up.vector) if len(steps) >= FEWEST_NOSINGS else None
    if walk is None:
        return None
    run = walk.runs_m - walk.runs_m.mean()
    height = walk.heights_m - walk.heights_m.mean()
    slope = float(run @ height / (run @ run))
    pitch = math.atan(slope)
    deviations = (height - slope * run) * math.cos(pitch)
    u = np.array([_own_u(step, pitch) for step in steps])
    return NosingLine(walk, deviations, u, math.degrees(pitch))


def _between(lower: Step, upper: Step, up: Floats) -> tuple[float, float]:
    """Return the way along the lower step's climb and upwards between two nosings' own places."""
    if lower.line_points is None or upper.line_points is None or lower.climb is None:
        raise ValueError("a step without a nosing has no place on the walking line")
    way = upper.line_points[1] - lower.line_points[1]
    return float(way @ lower.climb), float(way @ up)


def _own_u(step: Step, pitch: float) -> float:
    """Return the expanded uncertainty of one nosing's place square to the line: a step's values have two ends each."""
    if step.rise_m is None:
        return math.nan
    across = math.hypot(*(_part(step.rise_m, name) for name in _OWN)) * math.cos(pitch)
    along = 0.0
    if step.going_m is not None:
        along = math.hypot(*(_part(step.going_m, name) for name in (*_OWN, "edge"))) * math.sin(pitch)
    return math.hypot(across, along) / math.sqrt(2.0)


def _part(measured: Measured, name: str) -> float:
    return dict(measured.parts).get(name, 0.0)
