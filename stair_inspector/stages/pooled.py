"""What do the treads and risers of a sparse flight say together that none of them says alone?

Of a tread with two hundred points the outermost lies a centimetre inside its side; two thousand points of a flight,
laid one over the other along the climb, leave a millimetre. So it is with the fall of the treads, and with how far
their nosings stand over the risers. A step that differs from its flight by more than chance keeps what is its own.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.arrays import Floats, freeze
from stair_inspector.geometry.edges import EdgeLine, RobustLine, fit_line_robust
from stair_inspector.geometry.plan import left_of, unit_way
from stair_inspector.model import HeightOrder, StepShape
from stair_inspector.stages.sparse import SPARSE_M

_FEWEST_STEPS = 2
_ON_SIGMAS = 3.0
_LEAST_ON_M = 0.004
_SURELY_BEFORE_M, _SURELY_BEHIND_M = 0.012, 0.08
"""Before and behind the nosing above it, what lies between these is the riser's for certain: nearer than the priors let
its face be, since a point that is none of its own would widen the tread."""
_OUTSIDE_M = 0.15
"""How far outside the sides of the treads' patches points are looked at."""
_INNER_M = (0.05, 0.3)
"""Strip inside the first guess of a side in which the density is taken."""
_STRAY_SHARE = 0.03
"""Stray points beyond a side are so dense, as a share of the points inside it."""
_DIFFERS_M, _DIFFERS_GAPS = 0.02, 6.0
"""A step whose own points end farther off than both, the second in their mean gaps, ends there."""
_FEWEST_POINTS = 40
_SURE_SLOPE = 0.01
_LEAST_SLOPE = 0.0005
_SLOPE_SIGMAS = 3.0
_ABOVE_FOOT_M, _NOSING_BAND_M = 0.015, 0.028
"""A riser is looked for from above what it stands on to below the nosing's slab; a slab is thicker than the last."""
_SEARCHED_BEFORE_M, _SEARCHED_BEHIND_M = 0.08, 0.14
"""Where a riser's face is looked for: farther than the priors let it be, since of sparse points the nosing itself is
known to one or two of their distances only."""
_MOVED_M = 0.006
"""A nosing that was moved by less has the same strip behind it."""
_INSET_SHARE = 0.05
_WINDOW_M, _LEAST_PURITY, _FEWEST_ON_FACE, _FEWEST_OWN = 0.009, 0.35, 10, 6
_APART_M, _APART_SPACINGS, _APART_SIGMAS = 0.04, 1.5, 2.0
_COARSE_STEP_M = 0.004
_PER_GROUP, _MOST_GROUPS, _LEAST_SCATTER_M = 5, 12, 0.0005


@dataclass(frozen=True, slots=True, eq=False)
class _Side:
    """A side edge by its lateral place, and the mean gap between the lateral places of the points inside it."""

    place_m: float
    gap_m: float


@dataclass(frozen=True, slots=True, eq=False)
class _Riser:
    """The face below a nosing, in the step's frame; ``upper_s`` are the points just below the nosing, from the face."""

    face: EdgeLine
    upper_s: Floats


def pool_steps(heights: HeightOrder, shapes: Sequence[StepShape], step_m: float) -> list[StepShape]:
    """Take for every step of a sparse straight flight what its points leave open from all steps of the flight.

    Parameters
    ----------
    heights : HeightOrder
        All points.
    shapes : sequence of StepShape
        Of one flight from bottom to top, all with the same direction of climb.
    step_m : float
        Step on which the coordinates lie, metres: on a coarse one falls and faces are those of the lattice, and only
        the sides are pooled.

    Returns
    -------
    list of StepShape
        With the common fall, where a step's own differs from it by chance only; with nosings by their risers, where no
        face of their own was seen; with the common sides.
    """
    shapes = list(shapes)
    if step_m <= _COARSE_STEP_M:
        shapes = _with_fronts_by_risers(heights, _with_common_falls(shapes))
    return _with_pooled_sides(heights, shapes)


def _with_common_falls(shapes: Sequence[StepShape]) -> list[StepShape]:
    """Let each plane have the slopes of most, turned about the middle of its own points."""
    if len(shapes) < _FEWEST_STEPS:
        return list(shapes)
    planes = [shape.plane for shape in shapes]
    slopes = np.array([plane.slope for plane in planes])
    sigmas = np.array([np.sqrt(np.diag(plane.covariance)[1:]) for plane in planes])
    sigmas = np.maximum(sigmas, _LEAST_SLOPE)
    middle = np.median(slopes, axis=0)
    alike = np.abs(slopes - middle) <= _SLOPE_SIGMAS * np.hypot(sigmas, _LEAST_SLOPE)
    weights = alike / sigmas**2
    total = np.maximum(weights.sum(axis=0), 1e-12)
    common, common_sigma = (weights * slopes).sum(axis=0) / total, 1.0 / np.sqrt(total)
    result = []
    for shape, is_alike in zip(shapes, alike, strict=True):
        plane = shape.plane
        if is_alike.all() and plane.spacing_m > SPARSE_M:
            covariance = np.array(plane.covariance)
            # Where the height is known best: in the middle of the points.
            centre = -np.linalg.solve(covariance[1:, 1:] + 1e-18 * np.eye(2), covariance[1:, 0])
            at_centre = max(float(covariance[0, 0] + covariance[0, 1:] @ centre), (plane.sigma_m**2) / plane.n_points)
            turned = np.array(plane.slope) - common
            variance = np.diag(common_sigma**2 + _LEAST_SLOPE**2)
            new = np.zeros((3, 3))
            new[1:, 1:] = variance
            new[0, 1:] = new[1:, 0] = -variance @ centre
            new[0, 0] = at_centre + centre @ variance @ centre
            z0_m = plane.z0_m + float(turned @ centre)
            plane = replace(plane, z0_m=z0_m, slope=(float(common[0]), float(common[1])), covariance=freeze(new))
            shape = replace(shape, plane=plane)
        result.append(_at_its_plane(shape))
    return result


def _at_its_plane(shape: StepShape, moved_m: float = 0.0) -> StepShape:
    """Take the heights at the nosing from the plane where a strip behind it holds too few points, or lay elsewhere.

    ``moved_m`` is how far the nosing has been moved since the strip behind it was looked at: that of one which was
    placed too far out held the next row of points, on the riser.
    """
    plane = shape.plane
    if plane.spacing_m <= SPARSE_M and moved_m <= _MOVED_M:
        return shape
    noise_m = math.hypot(plane.noise_at(shape.front.middle_m, sum(shape.line_range) / 2.0), plane.misfit_m / 2.0)
    return replace(shape, nosing_offsets=(0.0, 0.0, 0.0), nosing_noise=(noise_m, noise_m, noise_m))


def _with_fronts_by_risers(heights: HeightOrder, shapes: Sequence[StepShape]) -> list[StepShape]:
    """Place nosings of which no face was seen in front of their risers, by the overhang of all steps."""
    risers = [_find_riser(heights, shapes, k) for k in range(len(shapes))]
    over = np.concatenate([np.zeros(0), *(-riser.upper_s for riser in risers if riser is not None)])
    found = _densest_window(over, _WINDOW_M)
    if found is None:
        return list(shapes)
    overhang_m, scatter_m, _ = found
    result = []
    for k, (shape, riser) in enumerate(zip(shapes, risers, strict=True)):
        if riser is not None and shape.front.source != "face":
            face = riser.face
            own = _densest_window(-riser.upper_s, _WINDOW_M, _FEWEST_OWN)
            over_m, over_noise_m = overhang_m, scatter_m
            if own is not None and abs(own[0] - overhang_m) > _WINDOW_M / 2.0:
                # As a landing whose edge does not stand over its riser.
                over_m, over_noise_m = own[:2]
            noise_m = math.hypot(face.noise_m, over_noise_m)
            front = replace(face, middle_m=face.middle_m - over_m, noise_m=noise_m)
            apart_m = shape.front.at(front.along_m) - front.middle_m
            # A face that lies farther from the tread's end is not the one below it.
            far_m = max(_APART_M, _APART_SPACINGS * shape.plane.spacing_m, _APART_SIGMAS * shape.front.noise_m)
            if abs(apart_m) <= far_m:
                moved_m = max(abs(shape.front.at(w) - front.at(w)) for w in shape.line_range)
                shape = _at_its_plane(replace(shape, front=front), moved_m)
        after = risers[k + 1] if k + 1 < len(risers) else None
        if after is not None and (shape.back is None or shape.back.source != "face"):
            upper = shapes[k + 1]
            s, w = shape.from_plan(upper.to_plan(after.face.middle_m, after.face.along_m))
            back = replace(after.face, middle_m=s, along_m=w)
            shape = replace(shape, back=back, back_limits=None)
        result.append(shape)
    return result


def _find_riser(heights: HeightOrder, shapes: Sequence[StepShape], k: int) -> _Riser | None:
    """Find the face of the riser below a step's nosing, from below its slab to above what it stands on."""
    shape = shapes[k]
    below = shapes[k - 1].plane if k else shape.foot
    if below is None:
        return None
    front, (w_low, w_high) = shape.front.middle_m, shape.extent[2:]
    top_m = shape.plane.at(front, 0.0)
    bottom_m = below.at(*shapes[k - 1].from_plan(shape.to_plan(front, 0.0))) if k else below.at(front, 0.0)
    rows = heights.coordinates_m[:, heights.between(bottom_m + _ABOVE_FOOT_M, top_m)]
    across = left_of(shape.climb)
    shift = rows[:2] - shape.origin_m[:, None]
    s, w, under = shape.climb @ shift, across @ shift, top_m - rows[2]
    inset = _INSET_SHARE * (w_high - w_low)
    near = (
        (s >= front - _SEARCHED_BEFORE_M)
        & (s <= front + _SEARCHED_BEHIND_M)
        & (w >= w_low + inset)
        & (w <= w_high - inset)
    )
    is_riser = near & (under >= priors.NOSING_THICKNESS_M)
    found = _densest_window(s[is_riser], _WINDOW_M)
    if found is None or found[2] < _LEAST_PURITY:
        return None
    within = is_riser & (np.abs(s - found[0]) <= _WINDOW_M)
    line = _line_through(w[within], s[within])
    if line is None:
        return None
    line_at = line.middle + line.slope * (w - line.x_middle)
    is_upper = near & (under >= max(_LEAST_ON_M, 2.5 * shape.plane.sigma_m)) & (under <= _NOSING_BAND_M)
    is_upper &= np.abs(s - line_at) <= priors.DEEPEST_OVERHANG_M
    return _Riser(line.as_edge(1.0, "face"), (s - line_at)[is_upper])


def _line_through(along: Floats, out: Floats) -> RobustLine | None:
    """Fit a line to the points of a face, in a few groups along it."""
    order = np.argsort(along, kind="stable")
    n_groups = int(np.clip(len(order) // _PER_GROUP, 2, _MOST_GROUPS))
    groups = np.array_split(order, n_groups)
    sigma_m = max(float(np.std(out)), _LEAST_SCATTER_M)
    return fit_line_robust(
        np.array([along[group].mean() for group in groups]),
        np.array([out[group].mean() for group in groups]),
        np.array([sigma_m / math.sqrt(len(group)) for group in groups]),
    )


def _densest_window(values: Floats, width_m: float, fewest: int = _FEWEST_ON_FACE) -> tuple[float, float, float] | None:
    """Return the mean of the values in the fullest window, its uncertainty, and their share of all; None for few."""
    if len(values) < fewest:
        return None
    ordered = np.sort(values)
    inside = np.searchsorted(ordered, ordered + width_m, side="right") - np.arange(len(ordered))
    first = int(np.argmax(inside))
    chosen = ordered[first : first + int(inside[first])]
    if len(chosen) < fewest:
        return None
    return float(chosen.mean()), float(chosen.std()) / math.sqrt(len(chosen)), len(chosen) / len(ordered)


def _with_pooled_sides(heights: HeightOrder, shapes: list[StepShape]) -> list[StepShape]:
    """Place the sides of a straight flight's treads from the points of all of them.

    A step whose own points end elsewhere by more than chance ends there; a landing stays as it is.
    """
    treads = [k for k, shape in enumerate(shapes) if shape.extent[1] - shape.extent[0] <= priors.LONGEST_TREAD_M]
    if len(treads) < _FEWEST_STEPS:
        return shapes
    climb = _square_to_nosings([shapes[k] for k in treads])
    across = left_of(climb)
    lateral = {k: _lateral_of(heights, shapes, k, across) for k in treads}
    pooled = np.sort(np.concatenate([places for pair in lateral.values() for places in pair]))
    if len(pooled) < _FEWEST_POINTS:
        return shapes
    left, right = _left_of(pooled), _left_of(-pooled[::-1])
    if left is None or right is None:
        return shapes
    result = []
    for k, shape in enumerate(shapes):
        # The riser above is the next step's too: whether a step is narrower, its tread alone can tell.
        own = np.sort(lateral[k][0]) if k in lateral else np.zeros(0)
        own_left, own_right = (_left_of(own), _left_of(-own[::-1])) if len(own) >= _FEWEST_POINTS / 2 else (None, None)
        changes: dict[str, EdgeLine] = {}
        middle_s = (shape.left.along_m + shape.right.along_m) / 2.0
        for name, side, mine, sign in (("left", left, own_left, 1.0), ("right", right, own_right, -1.0)):
            if mine is None:
                continue
            chosen = side if abs(mine.place_m - side.place_m) <= max(_DIFFERS_M, _DIFFERS_GAPS * mine.gap_m) else mine
            place = sign * chosen.place_m
            # Along the side, which is square to the nosings and not quite to the step's own frame.
            turn = float(across @ shape.climb)
            w = (place - float(across @ shape.origin_m) - middle_s * turn) / math.sqrt(1.0 - turn * turn)
            slope = -turn / math.sqrt(1.0 - turn * turn)
            changes[name] = EdgeLine(w, slope, middle_s, chosen.gap_m, 0.0, 1.0, "tread")
        if changes:
            shape = replace(shape, left=changes.get("left", shape.left), right=changes.get("right", shape.right))
            start = shape.front.middle_m
            shape = replace(shape, line_range=(shape.right.at(start), shape.left.at(start)))
        result.append(shape)
    return result


def _square_to_nosings(shapes: Sequence[StepShape]) -> Floats:
    """Return the direction of climb that is square to the nosings, weighted by how well they are known."""
    climb = shapes[0].climb
    known = [shape.front for shape in shapes if shape.front.source == "face" and shape.front.slope_noise < _SURE_SLOPE]
    slope = 0.0
    if known:
        weights = np.array([1.0 / max(front.slope_noise, 1e-4) ** 2 for front in known])
        slopes = np.array([front.slope for front in known])
        alike = np.abs(slopes - np.median(slopes)) <= _SURE_SLOPE
        slope = float((weights * alike) @ slopes / (weights * alike).sum()) if alike.any() else float(np.median(slopes))
    return unit_way(climb - slope * left_of(climb))


def _lateral_of(heights: HeightOrder, shapes: Sequence[StepShape], k: int, across: Floats) -> tuple[Floats, Floats]:
    """Return the places across the flight of the points on a tread, and of those on the riser above it."""
    shape = shapes[k]
    plane = shape.plane
    on_m = max(_LEAST_ON_M, _ON_SIGMAS * plane.sigma_m)
    above = shapes[k + 1] if k + 1 < len(shapes) else None
    z_m = plane.at(shape.front.middle_m, 0.0)
    top_m = z_m + on_m
    if above is not None:
        top_m = max(top_m, above.plane.at(above.front.middle_m, 0.0) - on_m)
    rows = heights.coordinates_m[:, heights.between(z_m - on_m - 0.02, top_m)]
    s, w = shape.climb @ (rows[:2] - shape.origin_m[:, None]), across @ rows[:2]
    off = rows[2] - plane.z0_m - plane.slope[0] * s
    front, back = shape.front.middle_m, shape.extent[1]
    is_riser = np.zeros(len(s), dtype=np.bool_)
    if above is not None:
        shift = above.to_plan(above.front.middle_m, 0.0) - shape.origin_m
        back = float(shift @ shape.climb)
        is_riser = (s >= back - _SURELY_BEFORE_M) & (s <= back + _SURELY_BEHIND_M) & (off >= on_m)
    is_tread = (s >= front - 0.01) & (s <= back) & (np.abs(off) <= on_m)
    places = [float(across @ shape.to_plan(front, edge)) for edge in shape.extent[2:]]
    beside = (w >= min(places) - _OUTSIDE_M) & (w <= max(places) + _OUTSIDE_M)
    return w[is_tread & beside], w[is_riser & beside & ~is_tread]


def _left_of(ordered: Floats) -> _Side | None:
    """Return where evenly spread points end: the most likely place, with a few stray points beyond.

    Notes
    -----
    With densities a inside and b outside, the likelihood of an end at e is a**n exp(-(a - b) e), n points lying inside:
    it is greatest at a point, and the end lies half a gap beyond.
    """
    n = len(ordered)
    guess = float(ordered[int(0.98 * n)])
    inner = np.searchsorted(ordered, [guess - _INNER_M[1], guess - _INNER_M[0]])
    count = int(inner[1] - inner[0])
    if count < 5:
        return None
    density = count / (_INNER_M[1] - _INNER_M[0])
    outer = ordered[inner[1] :]
    merit = np.arange(len(outer)) * math.log(1.0 / _STRAY_SHARE) - (1.0 - _STRAY_SHARE) * density * outer
    return _Side(float(outer[int(np.argmax(merit))]) + 0.5 / density, 1.0 / density)
