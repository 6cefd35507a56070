"""Does a flight curve? One arc through all of its nosings, or none: an even turn that chance cannot make."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.arrays import Floats, freeze
from stair_inspector.geometry.edges import TUKEY, EdgeLine, fit_line_robust
from stair_inspector.geometry.percentiles import MAD_TO_SIGMA, mad_sigma
from stair_inspector.geometry.plan import left_of, place_in_frame, turn_deg, unit_way
from stair_inspector.model import Arc, Chain, StepShape

_FEWEST_NOSINGS = 4
_FEWEST_IF_SLIGHT, _SLIGHT_DEG = 5, 3.0
"""Nosings that must be seen, and those of a flight that turns by less from step to step: of few, one that is turned by
a defect cannot be told from the others."""
_SURE_SIGMAS = 6.0
_LEAST_TURN_DEG = 3.0
"""From the first to the last nosing; a flight that turns by less is straight to within a millimetre of going."""
_ON_ARC_DEG, _ON_ARC_SIGMAS = 1.0, 4.0
"""A nosing turned away from the arc by more is not on it: it is turned by a defect, or the flight has no one arc."""
_LEAST_ON_ARC = 0.7
_ROUGH_DEG, _LEAST_ROUGH_DEG, _MOST_ARC_TURN_DEG = 4.0, 4.0, 14.0
"""The edges of patches lie this near to an even turn; it is worth a look from so much in all, up to so much a step.
What turns by more, up to ``priors.MOST_TURN_DEG``, winds: its centre is too near for a curve."""
_OFF_ARC_M, _OFF_ARC_SHARE = 0.04, 0.1
"""How far the middles of the nosings may lie from the arc, and as a share of how far it departs from its chord."""
SIDE_DIFFERS_M = 0.05
"""A side that lies farther inside those of most steps may be the rim of a shadow."""
_LINE_FLOOR_M, _SIDE_FLOOR_M = 0.0005, 0.003
"""What the place of a nosing and of a side is uncertain by at least, beside the scatter along it."""
_CENTRE_ROUNDS, _SETTLED_M = 15, 1e-6
_MIDDLE_SHARE = 0.63
"""Standard uncertainty of the mean of two medians, over the root of the sum of the squares of theirs from a scatter."""


def turning_climbs(chain: Chain) -> list[Floats] | None:
    """Return the directions of climb of a chain whose edges seem to turn evenly, None where they do not.

    As patches show them: good enough to look for the nosings along, not to say that the flight curves.
    """
    # The edge on the floor may run all around the lowest tread.
    first = 1 if chain.base is not None else 0
    inner = chain.climbs[first:]
    if len(inner) < _FEWEST_NOSINGS - 1:
        return None
    turns = [turn_deg(a, b) for a, b in itertools.pairwise(inner)]
    angles = np.concatenate([[0.0], np.cumsum(turns)])
    places = np.cumsum([1 + n for n in chain.n_missing]).astype(np.float64)
    i, j = np.triu_indices(len(inner), 1)
    own = places[first:]
    per_step = float(np.median((angles[j] - angles[i]) / (own[j] - own[i])))
    start = float(np.median(angles - per_step * own))
    off = np.abs(angles - start - per_step * own)
    is_even = np.count_nonzero(off <= _ROUGH_DEG) >= _LEAST_ON_ARC * len(inner)
    if not is_even or abs(per_step) > _MOST_ARC_TURN_DEG or abs(per_step) * (own[-1] - own[0]) < _LEAST_ROUGH_DEG:
        return None
    begin = math.atan2(inner[0][1], inner[0][0])
    fitted = begin + np.radians(start + per_step * places)
    return [np.array([math.cos(angle), math.sin(angle)]) for angle in fitted]


def find_arc(shapes: Sequence[StepShape]) -> Arc | None:
    """Find the arc on which the middles of a flight's nosings lie, if the flight turns evenly from step to step.

    Parameters
    ----------
    shapes : sequence of StepShape
        From bottom to top, level frame; the frames of the steps may be turned against their nosings.

    Returns
    -------
    Arc or None
        None for a straight flight, and for one that winds: its nosings do not turn evenly, or about a centre as near as
        the column of a spiral.

    Notes
    -----
    The directions of the nosings over the way along the flight are a line, whose slope is the curvature: fitted
    robustly, so that a nosing that is turned by a defect does not bend the flight, and held against what chance and the
    usual unevenness of building would make of a straight one. The centre is the median of those that the nosings give.
    """
    seen = [k for k, shape in enumerate(shapes) if shape.front.support > 0.0]
    if len(seen) < _FEWEST_NOSINGS:
        return None
    own = [shapes[k] for k in seen]
    middles = np.array([_middle_of(shape) for shape in own])
    climbs = np.array([climb_at_nosing(shape) for shape in own])
    turns = [turn_deg(a, b) for a, b in itertools.pairwise(climbs)]
    angles = math.atan2(climbs[0][1], climbs[0][0]) + np.radians(np.concatenate([[0.0], np.cumsum(turns)]))
    chords = np.hypot(*np.diff(middles, axis=0).T)
    # Along the arc, and not from step to step: goings may differ and treads may be missing.
    half_rad = np.abs(np.radians(turns)) / 2.0
    arcs = np.where(half_rad < 1e-6, chords, chords * half_rad / np.maximum(np.sin(half_rad), 1e-9))
    way = np.concatenate([[0.0], np.cumsum(arcs)])
    noise = np.array([math.atan(shape.front.slope_noise) for shape in own])
    line = fit_line_robust(way, angles, np.hypot(noise, math.radians(priors.BUILT_PARALLEL_DEG)))
    if line is None or line.slope == 0.0:
        return None
    off = np.abs(angles - line.middle - line.slope * (way - line.x_middle))
    limit = math.radians(_ON_ARC_DEG) + _ON_ARC_SIGMAS * noise
    turn_rad = abs(line.slope) * float(way[-1])
    per_step_deg = math.degrees(turn_rad) / (len(own) - 1)
    if (
        abs(line.slope) < _SURE_SIGMAS * line.slope_noise
        or turn_rad < math.radians(_LEAST_TURN_DEG)
        or (per_step_deg < _SLIGHT_DEG and len(own) < _FEWEST_IF_SLIGHT)
        or np.count_nonzero(off <= limit) < max(_FEWEST_NOSINGS, _LEAST_ON_ARC * len(own))
        or 1.0 / abs(line.slope) < priors.TIGHTEST_CURVE_M
    ):
        return None
    # How even the stair was built is no part of how well the curve of this one is known.
    exact = fit_line_robust(way, angles, np.maximum(noise, 1e-5)) or line
    radius_m, sense = 1.0 / abs(exact.slope), math.copysign(1.0, exact.slope)
    fitted = exact.middle + exact.slope * (way - exact.x_middle)
    to_left = np.stack([-np.sin(fitted), np.cos(fitted)], axis=1)
    centre = np.median(middles + sense * radius_m * to_left, axis=0)
    off_m = np.abs(np.hypot(*(middles - centre).T) - radius_m)
    sagitta_m = radius_m * (1.0 - math.cos(min(turn_rad / 2.0, math.pi / 2.0)))
    # Nosings that turn along a straight middle line are those of a fan, which is no curve.
    if float(np.median(off_m)) > max(_OFF_ARC_M, _OFF_ARC_SHARE * sagitta_m):
        return None
    return _fit_centre(shapes, Arc(freeze(centre), radius_m, sense, 0.0))[0]


def climb_at_nosing(shape: StepShape) -> Floats:
    """Return the direction of climb square to a step's nosing, (2,)."""
    return unit_way(shape.climb - shape.front.slope * left_of(shape.climb))


def climb_on_arc(arc: Arc, shape: StepShape) -> Floats:
    """Return the direction of climb along the arc at a step's nosing, (2,): one that a defect has turned keeps it."""
    outwards = unit_way(_middle_of(shape) - arc.centre_m)
    # To the left of the outward direction one climbs where the flight turns to the left.
    along: Floats = arc.sense * left_of(outwards)
    return along


def across_arc(arc: Arc, origin: Floats, climb: Floats, s: Floats, w: Floats) -> Floats:
    """Return how far to the left points of a step's frame lie of the arc through its origin, metres.

    So counted the sides of a curved tread are straight and run along the climb.
    """
    ahead, aside = place_in_frame(arc.centre_m, origin, climb)
    across: Floats = aside - arc.sense * np.hypot(s - ahead, w - aside)
    return across


def span_beside(arc: Arc, origin: Floats, climb: Floats, span: tuple[float, float], w_m: float) -> tuple[float, float]:
    """Return the range along a side of a tread's range along its middle: all its edges run to the centre."""
    _, aside = place_in_frame(arc.centre_m, origin, climb)
    low, high = span
    return low, low + min(1.0, abs(aside - w_m) / max(abs(aside), 1e-6)) * min(high - low, priors.FLOOR_STRIP_M)


def side_of(arc: Arc, origin: Floats, climb: Floats, edge: EdgeLine) -> EdgeLine:
    """Return a side that was found by :func:`across_arc` as an edge of the step's frame, where it was found."""
    ahead, aside = place_in_frame(arc.centre_m, origin, climb)
    radius_m, s = arc.sense * (aside - edge.middle_m), edge.along_m - ahead
    reach_m = math.sqrt(max(radius_m**2 - s**2, _SETTLED_M))
    return replace(edge, middle_m=aside - arc.sense * reach_m, slope=arc.sense * s / reach_m)


def with_arc_sides(shapes: Sequence[StepShape], arc: Arc) -> list[StepShape]:
    """Compare the sides of a curved flight's steps, which are arcs about one centre, and lay its measuring lines.

    A side that lies inside the others', and of which no face is seen, may be the rim of a shadow: its uncertainty grows
    until it reaches the others. The measuring lines of all steps follow the same arcs.
    """
    arc, usual = _fit_centre(shapes, arc)
    radii = {name: [_side_radius(shape, name, arc) for shape in shapes] for name in ("left", "right")}
    result = []
    for k, shape in enumerate(shapes):
        changes: dict[str, EdgeLine] = {}
        for name, outside in (("left", -arc.sense), ("right", arc.sense)):
            edge: EdgeLine = getattr(shape, name)
            hidden = outside * (usual[name] - radii[name][k])
            if hidden > SIDE_DIFFERS_M + 4.0 * edge.noise_m and edge.source == "tread":
                changes[name] = replace(edge, noise_m=math.hypot(edge.noise_m, hidden / 2.0), support=0.0)
        left_w, right_w = (_crossing(shape, arc, usual[name]) for name in ("left", "right"))
        if left_w is not None and right_w is not None:
            shape = replace(shape, line_range=(right_w, left_w))
        left, right = changes.get("left", shape.left), changes.get("right", shape.right)
        result.append(replace(shape, left=left, right=right, arc=arc))
    return result


def _fit_centre(shapes: Sequence[StepShape], arc: Arc) -> tuple[Arc, dict[str, float]]:
    """Fit the centre to all nosings and sides together; return the arc and the radii of the left and the right side.

    The lines of all nosings pass the centre at one distance, that of the overhang, and all sides lie on two circles
    about it. What lies otherwise, as a nosing turned by a defect or the rim of a shadow, counts little or nothing.
    """
    seen = [shape for shape in shapes if shape.front.support > 0.0]
    climbs = np.array([climb_at_nosing(shape) for shape in seen])
    places = np.array([shape.to_plan(shape.front.middle_m, shape.front.along_m) for shape in seen])
    line_sigma = [math.hypot(s.front.noise_m, s.front.slope_noise * arc.radius_m, _LINE_FLOOR_M) for s in seen]
    sides = [(shape, name) for name in ("left", "right") for shape in shapes]
    edges: list[EdgeLine] = [getattr(shape, name) for shape, name in sides]
    corners = np.array([shape.to_plan(e.along_m, e.middle_m) for (shape, _), e in zip(sides, edges, strict=True)])
    sigma = np.array([*line_sigma, *(math.hypot(edge.noise_m, _SIDE_FLOOR_M) for edge in edges)])
    n, m = len(seen), len(shapes)
    centre, radius_m = arc.centre_m, arc.radius_m
    distances = np.hypot(*(corners - centre).T)
    # Two coordinates of the centre, the distance of the nosings' lines from it, the radii of the left and right side.
    overhang_m = np.median(np.einsum("ij,ij->i", climbs, centre - places))
    numbers = np.array([*centre, overhang_m, np.median(distances[:m]), np.median(distances[m:])])
    covariance = np.zeros((5, 5))
    for _ in range(_CENTRE_ROUNDS):
        out = corners - numbers[:2]
        distances = np.hypot(*out.T)
        residual = np.concatenate([np.einsum("ij,ij->i", climbs, numbers[:2] - places) - numbers[2], distances])
        residual[n:] -= np.repeat(numbers[3:], m)
        rows = np.zeros((n + 2 * m, 5))
        rows[:n, :2], rows[:n, 2] = climbs, -1.0
        rows[n:, :2] = -out / distances[:, None]
        rows[n : n + m, 3], rows[n + m :, 4] = -1.0, -1.0
        spread = max(1.0, MAD_TO_SIGMA * float(np.median(np.abs(residual / sigma))))
        scaled = residual / (TUKEY * spread * sigma)
        weight = np.where(np.abs(scaled) < 1.0, (1.0 - scaled**2) ** 2, 0.0) / sigma**2
        normal = np.einsum("ni,n,nj->ij", rows, weight, rows)
        # A side that nobody saw leaves its radius to the others.
        normal += np.diag([1e-6, 1e-6, 1e-6, 1e-6, 1e-6]) * np.trace(normal)
        step = np.linalg.solve(normal, -np.einsum("ni,n,n->i", rows, weight, residual))
        numbers = numbers + step
        covariance = spread**2 * np.linalg.inv(normal)
        if float(np.abs(step).max()) < _SETTLED_M:
            break
    half = np.array([0.0, 0.0, 0.0, 0.5, 0.5])
    radius_m = float(half @ numbers)
    return (
        Arc(
            freeze(numbers[:2].copy()),
            radius_m,
            arc.sense,
            math.sqrt(float(half @ covariance @ half)),
            _MIDDLE_SHARE
            * math.hypot(*(mad_sigma(distances[part]) / math.sqrt(m) for part in (slice(m), slice(m, 2 * m)))),
        ),
        {"left": float(numbers[3]), "right": float(numbers[4])},
    )


def arc_length(arc: Arc, start: Floats, end: Floats) -> float:
    """Return the way from one place of the plan to another, (2,), along the arc about the flight's centre, metres."""
    radius_m = (math.dist(start, arc.centre_m) + math.dist(end, arc.centre_m)) / 2.0
    a, b = start - arc.centre_m, end - arc.centre_m
    return radius_m * arc.sense * math.atan2(float(a[0] * b[1] - a[1] * b[0]), float(a @ b))


def _middle_of(shape: StepShape) -> Floats:
    front_m = shape.front.middle_m
    w = (shape.left.at(front_m) + shape.right.at(front_m)) / 2.0
    return shape.to_plan(shape.front.at(w), w)


def _side_radius(shape: StepShape, name: str, arc: Arc) -> float:
    """Return how far from the centre a side lies, where it is known best."""
    edge: EdgeLine = getattr(shape, name)
    return math.dist(shape.to_plan(edge.along_m, edge.middle_m), arc.centre_m)


def _crossing(shape: StepShape, arc: Arc, radius_m: float) -> float | None:
    """Return where, along a step's nosing, a circle about the centre crosses it; None where it does not."""
    s, w = shape.from_plan(arc.centre_m)
    slope = shape.front.slope
    # The foot of the centre on the nosing's line, and the distance from the line.
    root = math.hypot(1.0, slope)
    apart = (s - shape.front.at(w)) / root
    if abs(apart) >= radius_m:
        return None
    foot_w = w + slope * apart / root
    # The centre is on the left of a flight that turns to the left.
    return foot_w - arc.sense * math.sqrt(radius_m**2 - apart**2) / root
