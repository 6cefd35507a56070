"""The plan of a staircase: treads and nosings from above, with the width and the going of every step dimensioned."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stair_inspector.drawings.model import (
    NOT_MEASURED,
    Arrow,
    Circle,
    Dimension,
    Drawing,
    Part,
    Path,
    SheetPoint,
    Words,
    title_for,
)
from stair_inspector.geometry.arrays import Floats
from stair_inspector.model import Inspection, Step
from stair_inspector.pictures.nosing_line import is_joined

_MM = 1000.0
_CHAIN = 3.0
"""Distance of the chain of goings from the side of a flight, in heights of the letters."""
_CLEAR = 6.0
"""Room that a chain needs beside a flight, in heights of the letters."""
_NUMBER, _WIDTH_SHARE, _WEDGE_SHARE = 1.6, 0.75, 0.33
"""Where a step's number stands, in heights of the letters from the end of its width's line, and where the width itself:
on the other side of the walking line, but on a wedge at its wide end."""
_TURN_COSINE = 0.7
"""Two climbs whose cosine is larger go on the same way."""


@dataclass(frozen=True, slots=True, eq=False)
class _Flight:
    """The steps of one flight in the plan: ``axis`` the direction of its climb, degrees, and where its chain runs.

    ``side`` is -90 where the chain of goings lies on the right of who climbs, 90 on the left; ``edge_mm`` how far the
    outermost side of its treads lies that way from the plan's origin; None for a flight that winds.
    """

    steps: tuple[Step, ...]
    axis: float
    side: float
    edge_mm: float | None


def plan(inspection: Inspection, text_mm: float, steps: Sequence[Step] | None = None) -> Drawing | None:
    """Return the plan of some or all steps, None where none of them has a nosing.

    Parameters
    ----------
    inspection : Inspection
        Measured by the survey.
    text_mm : float
        Height of the letters, millimetres of the stair: what is set beside each other follows from it.
    steps : sequence of Step, optional
        Successive; by default all.

    Returns
    -------
    Drawing or None
        The climb of the first step runs to the right; the left of who climbs is up. Every dimension is as long as the
        value of the inspection, on the centre line.
    """
    chosen = [step for step in steps or inspection.steps if step.line_points is not None and step.climb is not None]
    if not chosen:
        return None
    up = inspection.up.vector
    frame = _Frame(chosen[0], up)
    last = {flight.step_ids[-1] for flight in inspection.flights}
    parts: list[Part] = []
    for flight in _flights(inspection, chosen, frame, text_mm):
        for step, after in itertools.zip_longest(flight.steps, flight.steps[1:]):
            parts += _outline(step, frame)
            parts += _width_and_number(step, frame, text_mm, is_wedge=flight.edge_mm is None)
            parts += _going(step, after, flight, frame, text_mm, is_expected=step.step_id not in last)
    parts += _walking_line(chosen, frame, up, text_mm)
    curved = {flight.flight_id for flight in inspection.flights if flight.shape == "curved"}
    along = ", of a flight that curves along its arc" if any(step.flight in curved for step in chosen) else ""
    notes = (
        f"Seen from above. Going: nosing to nosing on the centre line, square to the nosing{along}. Width: between the "
        "sides of the tread, not between handrails.",
        "The arrow points up the stair. North is not known from the scan. Millimetres.",
    )
    return Drawing("plan", title_for("Plan", chosen), notes, tuple(parts), text_mm)


class _Frame:
    """The plan's own directions: x along the climb of a step, y to the left of who climbs it, from its nosing."""

    def __init__(self, step: Step, up: Floats) -> None:
        self._origin = _centre(step)
        self._x = _climb(step)
        self._y = np.cross(up, self._x)

    def place(self, point: Floats) -> SheetPoint:
        """Return a place of the scan, local metres, in the plan, millimetres."""
        offset = point - self._origin
        return float(offset @ self._x) * _MM, float(offset @ self._y) * _MM

    def turn_deg(self, step: Step) -> float:
        """Return a step's climb, degrees anticlockwise from that of the first."""
        climb = _climb(step)
        return math.degrees(math.atan2(float(climb @ self._y), float(climb @ self._x)))

    def corners(self, step: Step) -> list[SheetPoint]:
        """Return the corners of a step's surface: front left, front right, back right, back left."""
        return [self.place(corner) for corner in step.corners]


def _centre(step: Step) -> Floats:
    """Return the nosing's place on the centre line."""
    if step.line_points is None:
        raise ValueError("a step without a nosing has no place in a plan")
    centre: Floats = step.line_points[1]
    return centre


def _climb(step: Step) -> Floats:
    if step.climb is None:
        raise ValueError("a step without a climb has no place in a plan")
    return step.climb


def _ahead(place: SheetPoint, turn_deg: float, distance: float) -> SheetPoint:
    turn = math.radians(turn_deg)
    return place[0] + distance * math.cos(turn), place[1] + distance * math.sin(turn)


def _along(place: SheetPoint, turn_deg: float) -> float:
    """Return how far a place lies from the origin along a direction."""
    turn = math.radians(turn_deg)
    return place[0] * math.cos(turn) + place[1] * math.sin(turn)


def _between(a: SheetPoint, b: SheetPoint, share: float = 0.5) -> SheetPoint:
    return a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])


def _flights(inspection: Inspection, steps: Sequence[Step], frame: _Frame, text_mm: float) -> list[_Flight]:
    winding = {flight.flight_id for flight in inspection.flights if flight.shape != "straight"}
    found = []
    for number in dict.fromkeys(step.flight for step in steps):
        own = tuple(step for step in steps if step.flight == number)
        others = [corner for step in steps if step.flight != number for corner in frame.corners(step)]
        axis = frame.turn_deg(own[0])
        if number in winding:
            found.append(_Flight(own, axis, -90.0, None))
        else:
            side = _free_side(own, others, axis, frame, text_mm)
            # A landing may be wider than its flight; unless it is all there is.
            treads = [step for step in own if step.kind == "tread"] or own
            edge = max(_along(corner, axis + side) for step in treads for corner in frame.corners(step))
            found.append(_Flight(own, axis, side, edge))
    return found


def _free_side(
    steps: Sequence[Step], others: Sequence[SheetPoint], axis: float, frame: _Frame, text_mm: float
) -> float:
    """Return the side of a flight on which its chain of goings crosses no other flight: the right if it can be."""
    own = [corner for step in steps for corner in frame.corners(step)]
    low, high = min(_along(corner, axis) for corner in own), max(_along(corner, axis) for corner in own)
    beside = [corner for corner in others if low < _along(corner, axis) < high]
    for side in (-90.0, 90.0):
        edge = max(_along(corner, axis + side) for corner in own)
        middle = edge - 1.0
        if not any(middle < _along(corner, axis + side) < edge + _CLEAR * text_mm for corner in beside):
            return side
    return -90.0


def _outline(step: Step, frame: _Frame) -> list[Part]:
    front_left, front_right, back_right, back_left = frame.corners(step)
    parts: list[Part] = [
        Path((front_left, back_left), "STAIR-OUTLINE"),
        Path((front_right, back_right), "STAIR-OUTLINE"),
        # Of most treads the back lies under the next nosing.
        Path((back_left, back_right), "STAIR-OUTLINE" if step.kind == "landing" else "STAIR-HIDDEN"),
    ]
    nosing = (
        (front_left, front_right) if step.nosing is None else (frame.place(step.nosing[0]), frame.place(step.nosing[1]))
    )
    return [*parts, Path(nosing, "STAIR-NOSING")]


def _width_and_number(step: Step, frame: _Frame, text_mm: float, *, is_wedge: bool) -> list[Part]:
    """Return the width's dimension across the middle of the tread, where it was measured, and the number on it."""
    turn = frame.turn_deg(step)
    front_left, front_right, back_right, back_left = frame.corners(step)
    middle = _between(_between(front_left, front_right), _between(back_right, back_left))
    # A wedge has room at its wide end.
    is_wide_left = math.dist(front_left, back_left) >= math.dist(front_right, back_right) - 0.05 * _MM
    side = turn + (90.0 if is_wide_left else -90.0)
    half = math.dist(_between(front_left, back_left), _between(front_right, back_right)) / 2.0
    if step.width_m is not None:
        half = step.width_m.value * _MM / 2.0
    start, end = _ahead(middle, side, half), _ahead(middle, side, -half)
    number = _ahead(start, side, -min(_NUMBER * text_mm, half))
    share = _WEDGE_SHARE if is_wedge else _WIDTH_SHARE
    parts: list[Part] = [
        Circle(number, 1.15 * text_mm, "STAIR-NUMBER"),
        Words(str(step.step_id), number, text_mm, "STAIR-NUMBER"),
    ]
    if step.width_m is None:
        place = _between(start, end, share)
        return [*parts, Words(f"width {NOT_MEASURED}", place, 0.8 * text_mm, "STAIR-NOT-MEASURED", turn_deg=side)]
    return [Dimension(start, end, side, middle, "STAIR-DIM-WIDTH", share), *parts]


def _going(
    step: Step, after: Step | None, flight: _Flight, frame: _Frame, text_mm: float, *, is_expected: bool
) -> list[Part]:
    """Return the going's dimension in the chain beside the flight, or beside the walking line where it winds."""
    turn, centre = frame.turn_deg(step), frame.place(_centre(step))
    if flight.edge_mm is None:
        start, line = centre, _ahead(centre, turn - 90.0, 1.6 * text_mm)
    else:
        # From the side of the flight, so that no line crosses the treads; the way along the climb is the same.
        shift = flight.edge_mm - _along(centre, flight.axis + flight.side)
        start = _ahead(centre, flight.axis + flight.side, shift)
        line = _ahead(start, flight.axis + flight.side, _CHAIN * text_mm)
    if step.going_m is not None:
        end = _ahead(start, turn, step.going_m.value * _MM)
        return [Dimension(start, end, turn, line, "STAIR-DIM-GOING")]
    if step.kind == "landing" and step.tread_depth_m is not None:
        end = _ahead(start, turn, step.tread_depth_m.value * _MM)
        return [Dimension(start, end, turn, line, "STAIR-DIM-DEPTH")]
    if not is_expected:
        return []
    gap = 0.0 if after is None else _along(frame.place(_centre(after)), turn) - _along(centre, turn)
    words = Words(NOT_MEASURED, _ahead(line, turn, gap / 2.0), 0.8 * text_mm, "STAIR-NOT-MEASURED", turn_deg=turn)
    return [words]


def _walking_line(steps: Sequence[Step], frame: _Frame, up: Floats, text_mm: float) -> list[Part]:
    """Return the line through the nosings' centres, a circle at each foot of it and an arrow at each head."""
    parts: list[Part] = []
    places: list[SheetPoint] = []
    for step, after in itertools.zip_longest(steps, steps[1:]):
        here = frame.place(_centre(step))
        if not places:
            parts.append(Circle(here, 0.4 * text_mm, "STAIR-WALKING-LINE"))
        places.append(here)
        if after is not None and is_joined(step, after, up):
            places += _round_the_turn(step, after, frame)
            continue
        turn = frame.turn_deg(step)
        tip = _ahead(here, turn, 4.0 * text_mm)
        parts += [Path(tuple(places), "STAIR-WALKING-LINE")] if len(places) > 1 else []
        parts.append(Arrow(here, tip, 1.4 * text_mm, "STAIR-WALKING-LINE"))
        parts.append(Words("UP", _ahead(tip, turn, 1.5 * text_mm), 1.1 * text_mm, "STAIR-WALKING-LINE"))
        places = []
    return parts


def _round_the_turn(landing: Step, after: Step, frame: _Frame) -> list[SheetPoint]:
    """Return where one turns on a landing: where the two lines of climb meet, or in its middle to turn back."""
    first, second = frame.turn_deg(landing), frame.turn_deg(after)
    cosine = math.cos(math.radians(second - first))
    if landing.flight == after.flight or cosine > _TURN_COSINE:
        return []
    here, there = frame.place(_centre(landing)), frame.place(_centre(after))
    if cosine < -_TURN_COSINE:
        front_left, _, _, back_left = frame.corners(landing)
        far = math.dist(front_left, back_left) / 2.0
        middle = _ahead(here, first, far)
        return [middle, _ahead(there, second, -_along(_to(middle, there), second))]
    # here + t first = there - s second
    sine = math.sin(math.radians(second - first))
    way = _to(here, there)
    t = (way[0] * math.sin(math.radians(second)) - way[1] * math.cos(math.radians(second))) / sine
    return [_ahead(here, first, t)]


def _to(start: SheetPoint, end: SheetPoint) -> SheetPoint:
    return end[0] - start[0], end[1] - start[1]
