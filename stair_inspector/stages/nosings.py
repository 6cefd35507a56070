"""Where are the nosing, the back and the sides of every step? Edges from treads and from the faces that meet them."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.arrays import Bools, Floats
from stair_inspector.geometry.edges import EdgeLine, Half, Sampling, find_face_edge
from stair_inspector.geometry.extents import find_extent_edge
from stair_inspector.geometry.percentiles import MAD_TO_SIGMA, MEDIAN_NOISE
from stair_inspector.geometry.rims import find_rim_edge
from stair_inspector.geometry.slots import find_slots
from stair_inspector.model import Arc, Chain, Chains, HeightOrder, Horizontal, LocalPlane, Patches, StepShape, Surface
from stair_inspector.params import SurveyParams
from stair_inspector.stages.arcs import (
    across_arc,
    climb_on_arc,
    find_arc,
    side_of,
    span_beside,
    turning_climbs,
    with_arc_sides,
)
from stair_inspector.stages.hidden import (
    UNSEEN_M,
    WINDING_DEG,
    with_common_sides,
    with_doubtful_fronts,
    with_wedge_sides,
)
from stair_inspector.stages.links import angle_deg, turn_deg
from stair_inspector.stages.patches import fit_trimmed
from stair_inspector.stages.planes import FINE_M, STRIP_M, block_means, fit_local, plane_of
from stair_inspector.stages.pooled import pool_steps
from stair_inspector.stages.sparse import SPARSE_M

_FACE_NEAR_SIGMA = 1.6
_FACE_NEAR_M = 0.003
_FACE_FAR_M = 0.032
_FACE_BAND_M = 0.012
"""A nosing's face is looked for from below its tread's noise down to 32 mm, or 12 mm farther than the noise."""
_FACE_REACH_M = 0.012
_FACE_TRIES, _FACE_CENTRED = 4, 0.25
_RISER_REACH_M = (priors.RISER_BEHIND_M + priors.RISER_AHEAD_M) / 2.0
_RISER_BEHIND_M = (priors.RISER_BEHIND_M - priors.RISER_AHEAD_M) / 2.0
"""Half width and middle of the search for a riser's face, behind the nosing above it."""
_BESIDE_M = 0.15
_MOST_NEAR = 60_000
"""Points beyond which a step's plane and edges become no better, only slower."""
_OBSTRUCTED_M = 0.015
_OBSTACLE_INSIDE_M, _OBSTACLE_OUTSIDE_M = 0.03, 0.14
_OBSTACLE_LOW_M, _OBSTACLE_SIGMA = 0.02, 5.0
_OBSTACLE_HIGH_M = 0.06
_FEWEST_OF_OBSTACLE = 8
_LEAST_SUPPORT = 0.55
_LEAST_PURITY = 0.6
"""A riser hides what lies behind it: where most points in its place lie elsewhere, there is none."""
_STRIP_NEAR_M, _STRIP_FAR_M = 0.006, 0.045
"""Strip of a tread behind its nosing that shows whether a proud strip lies there: behind a rounded edge."""
_STRIP_DEEP_M, _STRIP_DEEP_SIGMA = 0.03, 6.0
"""Depth of the strip in which the nosing's height is taken: 30 mm, and six times the noise of the points."""
_STRIP_STEP_M = 0.006
_STRIP_MISFIT = 0.25
_STRIP_SIGMAS, _LEAST_ODD_M = 3.0, 0.005
_STRIP_POSE_SIGMA, _MOST_WORN_M = 0.2, 0.01
"""What passes of a scanner leave between parts of a strip, as a share of the noise; deeper is not wear but damage."""
_FEWEST_IN_STRIP = 10
_UNSEEN_SLOPE = 0.02
_INSET_M = 0.03
_NOISY_M = 0.004
_REFIT_GROWTH = 1.5
_REFIT_ROUNDS, _REFIT_SIGMA, _FEWEST_TO_REFIT = 8, 4.0, 50
_BAND_SIGMA = 3.0
_LEAST_BAND_M = 0.002
_FACE_AGREES_M, _AGREE_SIGMAS = 0.006, 4.0
_FACE_INSIDE_M, _FACE_ROWS = 0.004, 2.0
_BAR_M, _BEYOND_SHARE = 0.06, 0.1
"""A bar's usual width at most, and the share of points beyond a face from which the face is an inner bar's."""
_BEHIND_SHARE = 0.3
"""Density of points behind a face, as a share of that in it, from which it is none."""


@dataclass(frozen=True, slots=True, eq=False)
class _Near:
    """Points near one step, in its frame: ``s`` along the climb, ``w`` to the left, ``r`` above its plane; metres."""

    s: Floats
    w: Floats
    r: Floats

    def chosen(self, which: Bools) -> "_Near":
        """Return some of the points."""
        return _Near(self.s[which], self.w[which], self.r[which])


def find_shapes(
    heights: HeightOrder,
    horizontal: Horizontal,
    patches: Patches,
    chains: Chains,
    params: SurveyParams,
    is_stepped: bool = False,
    sparse_step_m: float | None = None,
) -> tuple[tuple[StepShape, ...], ...]:
    """Find the plane and the edges of every step.

    Parameters
    ----------
    heights : HeightOrder
        All points, sorted by height: near an edge, where normals are spoilt, a tread's points count as well.
    horizontal, patches, chains
        Of the same scan.
    params : SurveyParams
        Evidence and tolerance.
    is_stepped : bool
        Whether the coordinates were rounded to steps, over which they have been spread.
    sparse_step_m : float, optional
        In a sparse scan, where the treads of a flight must help each other: the step on which its coordinates lie, 0
        for none. None where the scan is dense.

    Returns
    -------
    tuple of tuple of StepShape
        For each chain its steps from bottom to top; level frame.
    """
    shapes: dict[int, tuple[StepShape, ...]] = {}
    # From the top, because the back of a landing is looked for near the flight that begins there.
    for number in range(len(chains.chains) - 1, -1, -1):
        chain = chains.chains[number]
        after = flight_after(chains, number)
        above = None if after is None else shapes[after][0]
        shapes[number] = _shapes_of(heights, horizontal, patches, chain, above, params, is_stepped, sparse_step_m)
    return tuple(shapes[number] for number in range(len(chains.chains)))


def flight_after(chains: Chains, number: int) -> int | None:
    """Return the number of the flight that goes straight on from the landing at the end of a flight, or None."""
    chain = chains.chains[number]
    for later in range(number + 1, len(chains.chains)):
        other = chains.chains[later]
        if other.base == chain.steps[-1] and angle_deg(other.climbs[-1], chain.climbs[-1]) <= priors.STRAIGHT_ON_DEG:
            return later
    return None


def straight_climb(chain: Chain) -> Floats | None:
    """Return the common direction of climb of a chain, (2,), or None where it winds."""
    # The edge on the floor may run all around the lowest tread.
    inner = chain.climbs[1:] if len(chain.climbs) > 2 and chain.base is not None else chain.climbs
    middle: Floats = np.median(inner, axis=0)
    middle /= np.hypot(*middle)
    turns = [turn_deg(a, b) for a, b in itertools.pairwise(inner)]
    # One edge that is seen badly turns there and back again; a winding flight goes on turning the same way.
    sharp = [turn for turn in turns if abs(turn) > WINDING_DEG]
    left, right = [turn for turn in sharp if turn > 0.0], [turn for turn in sharp if turn < 0.0]
    is_winding = max(len(left), len(right)) >= 2 and abs(sum(sharp)) > 2.0 * WINDING_DEG
    return None if is_winding else middle


def _shapes_of(
    heights: HeightOrder,
    horizontal: Horizontal,
    patches: Patches,
    chain: Chain,
    above: StepShape | None,
    params: SurveyParams,
    is_stepped: bool,
    sparse_step_m: float | None,
) -> tuple[StepShape, ...]:
    common = straight_climb(chain)
    span = _common_span(patches, chain, common) if sparse_step_m is not None and common is not None else None
    usual = [climb if common is None else common for climb in chain.climbs]
    turning = turning_climbs(chain)
    found: list[StepShape] = []
    for climbs in (usual,) if turning is None else (turning, usual):
        is_square = common is not None and climbs is usual
        found = _shapes_along(
            heights,
            horizontal,
            patches,
            chain,
            above,
            climbs,
            is_square,
            params,
            is_stepped,
            span if is_square else None,
        )
        arc = find_arc(found)
        if arc is None:
            continue
        # Once more along the arc: the sides of a tread are looked for beside its own direction of climb.
        climbs = [climb_on_arc(arc, shape) for shape in found]
        curved = _shapes_along(heights, horizontal, patches, chain, above, climbs, True, params, is_stepped, None, arc)
        arc = find_arc(curved)
        if arc is not None:
            return tuple(with_arc_sides(curved, arc))
    if span is not None and sparse_step_m is not None:
        found = pool_steps(heights, found, sparse_step_m)
    return tuple(with_wedge_sides(found, chain) if common is None else with_common_sides(found, common))


def _shapes_along(
    heights: HeightOrder,
    horizontal: Horizontal,
    patches: Patches,
    chain: Chain,
    above: StepShape | None,
    climbs: Sequence[Floats],
    is_straight: bool,
    params: SurveyParams,
    is_stepped: bool,
    span: tuple[float, float] | None,
    arc: Arc | None = None,
) -> list[StepShape]:
    """Find plane and edges of all steps, each along its direction of climb."""
    shapes: list[StepShape] = []
    # From the top, because the back of a step is looked for near the nosing above it.
    for k in range(len(chain.steps) - 1, -1, -1):
        is_last_below_gap = k + 1 < len(chain.steps) and chain.n_missing[k + 1] > 0
        above = None if is_last_below_gap else above
        shape = _shape(
            heights, horizontal, patches, chain, k, climbs[k], above, is_straight, params, is_stepped, span, arc
        )
        shapes.append(shape)
        above = shape
    is_one_way = is_straight and arc is None
    return with_doubtful_fronts(shapes[::-1], chain, climbs[0] if is_one_way else None)


def _common_span(patches: Patches, chain: Chain, climb: Floats) -> tuple[float, float] | None:
    """Return between which sides most treads of a straight flight lie across its climb; None if they are not sparse."""
    surfaces = [patches.surfaces[number] for number in chain.steps]
    spacings = [math.sqrt(surface.area_m2 / len(surface.rows)) for surface in surfaces]
    if float(np.median(spacings)) <= SPARSE_M:
        return None
    across = np.array([-climb[1], climb[0]])
    ends = np.array([np.percentile(across @ surface.cells_m, [1.0, 99.0]) for surface in surfaces])
    return float(np.percentile(ends[:, 0], 25.0)), float(np.percentile(ends[:, 1], 75.0))


def _shape(
    heights: HeightOrder,
    horizontal: Horizontal,
    patches: Patches,
    chain: Chain,
    k: int,
    climb: Floats,
    above: StepShape | None,
    is_straight: bool,
    params: SurveyParams,
    is_stepped: bool,
    span: tuple[float, float] | None = None,
    arc: Arc | None = None,
) -> StepShape:
    number = chain.steps[k]
    surface = patches.surfaces[number]
    left = np.array([-climb[1], climb[0]])
    origin = chain.middles[k]
    if k == 0 and chain.base is None:
        # Nothing lies below: the patch's own front is all there is.
        origin = surface.cells_m.mean(axis=1)
    s, w = climb @ (surface.cells_m - origin[:, None]), left @ (surface.cells_m - origin[:, None])
    covered = None
    if surface.covered_m is not None:
        covered = (surface.covered_m[0] - float(left @ origin), surface.covered_m[1] - float(left @ origin))
    front = _front_of(s, w, chain.lengths_m[k], covered)
    is_strip = s <= front + STRIP_M
    w_low, w_high = (float(value) for value in np.percentile(w[is_strip], [1.0, 99.0]))
    if covered is not None:
        w_low, w_high = _with_cover(patches, number, left, origin, (w_low, w_high))
    if span is not None:
        # Of a few cells in a row some may be missing at either end.
        aside = float(left @ origin)
        w_low, w_high = min(w_low, span[0] - aside), max(w_high, span[1] - aside)
    # Between the quarters of the width: a floor next door at the same height must not make a tread deeper.
    inner = (w >= w_low + 0.25 * (w_high - w_low)) & (w <= w_high - 0.25 * (w_high - w_low))
    s_high = float(np.percentile(s[inner] if inner.any() else s, 98.0))
    s_high = max(s_high, front + 2.0 * patches.cell_m)
    extent = (front, s_high, w_low, w_high)
    z0 = float(surface.centre_m[2] + surface.slope @ (origin - surface.centre_m[:2]))
    rough = (z0, float(surface.slope @ climb), float(surface.slope @ left))
    plane = fit_local(horizontal, surface, origin, climb, extent, rough)
    band_m = params.band_m or max(_BAND_SIGMA * plane.sigma_m, _LEAST_BAND_M)
    rise_above_m, reach = 0.0, extent
    if above is not None:
        s_above, w_above = _shape_frame(origin, climb, above.to_plan(above.front.middle_m, 0.0))
        rise_above_m = above.plane.z0_m - plane.at(s_above, w_above)
        # The riser may lie beyond what was seen of the tread.
        reach = (front, max(s_high, s_above), w_low, w_high)
    near, stride = _gather(heights, origin, climb, reach, plane, max(rise_above_m, 0.1))
    plane = replace(plane, spacing_m=plane.spacing_m * math.sqrt(stride))
    if plane.sigma_m > _NOISY_M or span is not None:
        plane, near = _refit(near, plane, extent)
    sampling = Sampling(plane.sigma_m, plane.spacing_m)
    on_cover = near
    if covered is not None:
        # At a side that the runner reaches, its own edge is the tread's.
        on_cover = replace(near, r=near.r - surface.cover_m)
        near = near.chosen((near.w < covered[0]) | (near.w > covered[1]))
    finder = _Finder(near, sampling, band_m, params, surface.is_barred)
    finder_across = replace(finder, sampling=replace(sampling, left_out=covered))
    half_m = chain.lengths_m[k] / 2.0
    is_wide = w_high - w_low > 1.5 * chain.lengths_m[k]
    front_span = (-half_m, half_m) if is_wide and not (k == 0 and chain.base is None) else (w_low, w_high)
    front_span = _bare_span(front_span, covered)
    found = finder_across.edge(-near.s, near.w, _inset(front_span), -front, is_foot=False)
    nosing = _guessed(front, front_span) if found is None else found.flipped()
    start = nosing.middle_m
    side_span = _inset((start, min(s_high, start + STRIP_M)))
    across, left_span, right_span = near.w, side_span, side_span
    if arc is not None:
        across = across_arc(arc, origin, climb, near.s, near.w)
        # The riser above turns against this nosing: on the inner side of the curve it stands nearer.
        left_span, right_span = (_inset(span_beside(arc, origin, climb, (start, s_high), w)) for w in (w_high, w_low))
    on_left, on_right = (math.inf, -math.inf) if arc is not None else _slots_beside(near, side_span, extent, finder)
    if is_straight and arc is None:
        aside = float(left @ origin)
        on_left, on_right = min(on_left, surface.bounds_m[1] - aside), max(on_right, surface.bounds_m[0] - aside)
    aside_of = [(finder, across, near.s)] * 2
    if covered is not None:
        covering = (replace(finder, near=on_cover), on_cover.w, on_cover.s)
        aside_of = [covering if math.isinf(end) else bare for end, bare in zip(covered, aside_of, strict=True)]
    (on_low, low_across, low_s), (on_high, high_across, high_s) = aside_of
    to_left = on_high.edge(high_across, high_s, left_span, w_high, is_square=is_straight, stop_m=on_left)
    to_right = on_low.edge(-low_across, low_s, right_span, -w_low, is_square=is_straight, stop_m=-on_right)
    left_side = to_left or _guessed(w_high, left_span)
    right_side = _guessed(w_low, right_span) if to_right is None else to_right.flipped()
    if arc is not None:
        left_side, right_side = (side_of(arc, origin, climb, side) for side in (left_side, right_side))
    shape = StepShape(
        surface=number,
        origin_m=origin,
        climb=climb,
        plane=plane,
        extent=extent,
        front=nosing,
        back=None,
        left=left_side,
        right=right_side,
        foot=None
        if k or chain.base is None
        else _find_foot(horizontal, patches.surfaces[chain.base], origin, climb, extent),
        back_limits=None,
        coverage=0.0,
        line_range=(0.0, 0.0),
        nosing_offsets=(0.0, 0.0, 0.0),
        nosing_noise=(0.0, 0.0, 0.0),
    )
    shape = replace(shape, line_range=(shape.right.at(start), shape.left.at(start)))
    shape = _with_nosing_heights(shape, near, band_m, is_stepped, surface.is_barred)
    shape = _with_back(shape, finder_across, above, rise_above_m)
    return replace(shape, coverage=_coverage(shape, near, band_m, covered))


def _with_nosing_heights(shape: StepShape, near: _Near, band_m: float, is_stepped: bool, is_barred: bool) -> StepShape:
    """Measure how high the surface lies at its nosing above its plane, on the left, in the centre and on the right.

    A plane carried on to the edge magnifies what is wrong with its slope: the strip behind the nosing, over its whole
    length, says how high the plane has to be there. Noisy points take a deeper strip, so that errors of pose, which a
    few centimetres have in common, even out. A third of the strip that lies otherwise than the whole by more than
    chance, as where feet have worn it, has its own height. In the strip of a tread of bars their sides show too: there
    the plane is all there is.
    """
    low, high = shape.line_range
    plane = shape.plane
    back = near.s - shape.front.at(0.0) - shape.front.slope * near.w
    # The noisier and the sparser the points, the farther from the edge before they are the tread's for certain.
    start_m = max(_STRIP_NEAR_M, 1.5 * plane.spacing_m, 2.0 * plane.sigma_m)
    stop_m = start_m + _STRIP_DEEP_M + _STRIP_DEEP_SIGMA * plane.sigma_m
    is_strip = (back >= start_m) & (back <= stop_m) & (np.abs(near.r) <= band_m + _STRIP_STEP_M)
    is_strip &= (near.w >= low) & (near.w <= high)
    w, r = near.w[is_strip], near.r[is_strip]
    by_plane = math.hypot(plane.noise_at(shape.front.middle_m, (low + high) / 2.0), plane.misfit_m)
    whole_m, whole_noise_m = _strip_height(r, plane, is_stepped)
    # A strip far off what is usual is spoilt by the edge, not part of the tread: the plane is all there is.
    if is_barred or abs(whole_m) > _LEAST_ODD_M + _STRIP_SIGMAS * whole_noise_m:
        whole_m, whole_noise_m = 0.0, math.inf
    offsets, noises = [], []
    for start, stop in ((2.0 / 3.0, 1.0), (1.0 / 3.0, 2.0 / 3.0), (0.0, 1.0 / 3.0)):
        mine = r[(w >= low + start * (high - low)) & (w <= low + stop * (high - low))]
        own_m, own_noise_m = _strip_height(mine, plane, is_stepped)
        chance_m = _STRIP_SIGMAS * math.hypot(own_noise_m, _STRIP_POSE_SIGMA * plane.sigma_m)
        is_other = chance_m < abs(own_m - whole_m) <= max(_MOST_WORN_M, _STRIP_SIGMAS * plane.misfit_m)
        is_other = is_other and not is_barred
        offset_m, noise_m = (own_m, own_noise_m) if is_other else (whole_m, whole_noise_m)
        offsets.append(offset_m)
        # Between the strip and the nosing itself the surface may depart from its plane some more.
        noises.append(math.hypot(noise_m, _STRIP_MISFIT * plane.misfit_m) if math.isfinite(noise_m) else by_plane)
    return replace(
        shape,
        nosing_offsets=(offsets[0], offsets[1], offsets[2]),
        nosing_noise=(noises[0], noises[1], noises[2]),
    )


def _strip_height(r: Floats, plane: LocalPlane, is_stepped: bool) -> tuple[float, float]:
    """Return the middle height of a strip's points and its standard uncertainty, infinite for too few points.

    Of rounded heights the mean is right as soon as the noise reaches half a step, their median is still drawn to a step
    by a twentieth of it.
    """
    if len(r) < _FEWEST_IN_STRIP:
        return 0.0, math.inf
    if is_stepped:
        r = r[np.abs(r - np.median(r)) <= _BAND_SIGMA * plane.sigma_m]
        # Taken to be no surer than a median: which points it is taken from depends on the spreading too.
        return float(r.mean()), MEDIAN_NOISE * plane.sigma_m / math.sqrt(len(r))
    return float(np.median(r)), MEDIAN_NOISE * plane.sigma_m / math.sqrt(len(r))


def _guessed(place_m: float, span: tuple[float, float]) -> EdgeLine:
    """Return an edge of which only the patch's rim is known: its uncertainty is large, not absent."""
    return EdgeLine(place_m, 0.0, sum(span) / 2.0, UNSEEN_M, _UNSEEN_SLOPE, 0.0, "tread")


def _shape_frame(origin: Floats, climb: Floats, plan: Floats) -> tuple[float, float]:
    shift = plan - origin
    return float(shift @ climb), float(shift[1] * climb[0] - shift[0] * climb[1])


def _front_of(s: Floats, w: Floats, length_m: float, covered: tuple[float, float] | None) -> float:
    """Return where a patch begins over the middle of its front edge, beside what covers it there."""
    is_middle = np.abs(w) <= (0.4 if covered is None else 0.5) * length_m
    if covered is not None:
        is_middle &= (w <= covered[0]) | (w >= covered[1])
    return float(np.percentile(s[is_middle] if is_middle.any() else s, 2.0))


def _with_cover(
    patches: Patches, number: int, left: Floats, origin: Floats, sides: tuple[float, float]
) -> tuple[float, float]:
    """Return between which sides a step lies with the runner that was taken off it."""
    ends = [
        np.percentile(left @ (piece.cells_m - origin[:, None]), [1.0, 99.0])
        for piece in patches.surfaces
        if piece.part_of == number
    ]
    return min(sides[0], *(float(low) for low, _ in ends)), max(sides[1], *(float(high) for _, high in ends))


def _bare_span(span: tuple[float, float], covered: tuple[float, float] | None) -> tuple[float, float]:
    """Return the part of an edge that a runner at one of its ends leaves bare."""
    if covered is None:
        return span
    low = covered[1] if math.isinf(covered[0]) else span[0]
    high = covered[0] if math.isinf(covered[1]) else span[1]
    return low, high


def _inset(span: tuple[float, float]) -> tuple[float, float]:
    """Leave out the ends of an edge, where other edges meet it."""
    inset = min(_INSET_M, 0.15 * (span[1] - span[0]))
    return span[0] + inset, span[1] - inset


def _refit(near: _Near, plane: LocalPlane, extent: tuple[float, float, float, float]) -> tuple[LocalPlane, _Near]:
    """Fit the plane again to all points well inside the surface, whatever their normals, and measure from it.

    The points that noise has carried farthest off a surface have the most slanting normals: without them the noise
    seems too small, and where they are missing on one side only, the plane leans.
    """
    s_low, s_high, w_low, w_high = extent
    s_high = min(s_high, s_low + STRIP_M)
    inset_s, inset_w = 0.15 * (s_high - s_low), 0.08 * (w_high - w_low)
    inside = (near.s >= s_low + inset_s) & (near.s <= s_high - inset_s)
    inside &= (near.w >= w_low + inset_w) & (near.w <= w_high - inset_w)
    sigma_m = plane.sigma_m
    for _ in range(_REFIT_ROUNDS):
        chosen = inside & (np.abs(near.r) <= _REFIT_SIGMA * sigma_m)
        if np.count_nonzero(chosen) < _FEWEST_TO_REFIT:
            return plane, near
        wider = MAD_TO_SIGMA * float(np.median(np.abs(near.r[chosen])))
        if wider <= 1.02 * sigma_m:
            break
        sigma_m = wider
        if sigma_m > _REFIT_GROWTH * plane.sigma_m:
            # That is not the surface's noise but something that stands on it.
            return plane, near
    s, w, r = near.s[chosen], near.w[chosen], near.r[chosen]
    blocks, counts = block_means(s, w, r, FINE_M)
    slope, centre, _ = fit_trimmed(blocks[:, counts >= 0.3 * np.median(counts)])
    z0 = float(centre[2] - slope @ centre[:2])
    offsets = r + plane.z0_m + plane.slope[0] * s + plane.slope[1] * w
    numbers = (plane.z0_m + z0, plane.slope[0] + float(slope[0]), plane.slope[1] + float(slope[1]))
    better = plane_of(s, w, offsets, numbers)
    r = near.r - z0 - slope[0] * near.s - slope[1] * near.w
    return better, _Near(near.s, near.w, r)


def _gather(
    heights: HeightOrder,
    origin: Floats,
    climb: Floats,
    extent: tuple[float, float, float, float],
    plane: LocalPlane,
    above_m: float,
) -> tuple[_Near, int]:
    """Return the points around a step, whatever their normals; of very many only every n-th, and n."""
    s_low, s_high, w_low, w_high = extent
    corners = [plane.at(s, w) for s in (s_low, min(s_high, s_low + 2.0)) for w in (w_low, w_high)]
    margin = max(_FACE_FAR_M, (_FACE_NEAR_SIGMA * plane.sigma_m + _FACE_BAND_M), 4.0 * plane.sigma_m)
    start = int(np.searchsorted(heights.coordinates_m[2], min(corners) - margin))
    stop = int(np.searchsorted(heights.coordinates_m[2], max(corners) + above_m))
    rows = heights.coordinates_m[:, start:stop]
    x, y = rows[0] - origin[0], rows[1] - origin[1]
    s, w = climb[0] * x, climb[0] * y
    s += climb[1] * y
    w -= climb[1] * x
    chosen = np.flatnonzero(
        (s >= s_low - _BESIDE_M) & (s <= s_high + _BESIDE_M) & (w >= w_low - _BESIDE_M) & (w <= w_high + _BESIDE_M)
    )
    # In order of height, so that every second point is as good as a random half.
    stride = -(-len(chosen) // _MOST_NEAR)
    chosen = chosen[::stride]
    s, w = s[chosen], w[chosen]
    return _Near(s, w, rows[2][chosen] - plane.z0_m - plane.slope[0] * s - plane.slope[1] * w), stride


@dataclass(frozen=True, slots=True, eq=False)
class _Finder:
    """Finds the edges of one step among the points near it."""

    near: _Near
    sampling: Sampling
    band_m: float
    params: SurveyParams
    is_barred: bool = False

    def edge(
        self,
        out: Floats,
        along: Floats,
        span: tuple[float, float],
        guess_m: float,
        is_foot: bool = True,
        is_square: bool = False,
        stop_m: float = math.inf,
    ) -> EdgeLine | None:
        """Find an edge by the surface's extent, then by the face that goes down or up from it if one is seen.

        Parameters
        ----------
        out, along : (n,)
            Coordinates of the near points square to the edge and along it.
        span : (low, high)
            Range along the edge.
        guess_m : float
            First guess.
        is_foot : bool
            Whether a face may go up from the edge, as a wall does.
        is_square : bool
            Whether the edge is known to run exactly along ``along``.
        stop_m : float
            From where on what lies outside belongs to another surface.
        """
        if span[1] - span[0] <= 4.0 * self.sampling.spacing_m:
            return None
        offset = self.near.r
        # Only what lies near this edge: the rest was gathered for the others.
        is_close = (out >= guess_m - _BESIDE_M) & (out <= min(guess_m + _BESIDE_M, stop_m))
        close = np.flatnonzero(is_close & (along > span[0]) & (along < span[1]))
        out, along, offset = out[close], along[close], offset[close]
        offset = offset - self._step_at(out, offset, guess_m)
        flat = np.abs(offset) <= self.band_m
        surface = out[flat], along[flat], offset[flat]
        whole = find_extent_edge(*surface, span, guess_m, self.sampling, "all", is_square)
        middle = (span[0] + span[1]) / 2.0
        guess = (guess_m, 0.0) if whole is None else (whole.at(middle), whole.slope)
        reach = max(_FACE_REACH_M, _BAND_SIGMA * self.sampling.sigma_m)
        if self.sampling.spacing_m > SPARSE_M:
            # The surface's last row of points may lie so far from its edge.
            reach = max(reach, self.sampling.spacing_m)
        near_m = max(_FACE_NEAR_M, _FACE_NEAR_SIGMA * self.sampling.sigma_m)
        far_m = max(_FACE_FAR_M, near_m + _FACE_BAND_M)
        guesses: tuple[tuple[tuple[float, float], float], ...] = ((guess, reach),)
        if abs(guess[0] - guess_m) > 0.5 * reach:
            # The surface may seem to end elsewhere than it does.
            guesses += (((guess_m, 0.0), abs(guess[0] - guess_m) + reach),)
        points = out, along, offset
        down = self._face(points, span, guesses, (-near_m, -far_m), is_square)
        if down is not None and is_foot and _hangs_behind(down, *points, (near_m, far_m)):
            down = None
        up = self._face(points, span, guesses, (near_m, far_m), is_square) if is_foot else None
        half: Half = "all"
        if down is not None and (up is None or down.support >= up.support):
            half = "above"
        elif up is not None:
            half, up = "below", replace(up, is_wall=True)
        extent = whole if half == "all" else find_extent_edge(*surface, span, guess[0], self.sampling, half, is_square)
        if half == "all" and extent is not None and not is_foot and self.sampling.sigma_m > _NOISY_M:
            extent = self._without_hidden_face(extent, surface, span, is_square)
        face = down if half == "above" else up
        if self.is_barred:
            extent = find_rim_edge(out[flat], along[flat], span, guess_m, self.sampling.sigma_m, is_square)
            # Every bar has faces, along the edge and square to it: one is the edge's where the outermost bar ends.
            # At a side the rim is as exact as need be, where the ends of many bars seem to be a face.
            is_edge = face is not None and face.purity >= _LEAST_PURITY and not is_foot
            face = face if face is not None and is_edge and not _goes_on_beyond(face, out[flat], along[flat]) else None
        chosen = self._choose(extent, face, middle)
        if chosen is not None and chosen.source == "tread" and self._is_obstructed(out, offset, chosen.at(middle)):
            noise_m = math.hypot(chosen.noise_m, _OBSTRUCTED_M)
            chosen = replace(chosen, noise_m=noise_m, support=0.0, obstructed_m=_OBSTRUCTED_M)
        return chosen

    def _without_hidden_face(
        self, whole: EdgeLine, surface: tuple[Floats, Floats, Floats], span: tuple[float, float], is_square: bool
    ) -> EdgeLine:
        """Return where a surface ends at whose front no face was found, without the points of one that noise hides.

        Of a noisy surface points are taken so far below that a riser's are among them. Where those above the plane end
        much farther in, there is a face, and the edge is as uncertain as what it added.
        """
        middle = sum(span) / 2.0
        edge = find_extent_edge(*surface, span, whole.at(middle), self.sampling, "above", is_square)
        if edge is None:
            return whole
        added_m = whole.at(middle) - edge.at(middle)
        if added_m <= max(_FACE_INSIDE_M, _BAND_SIGMA * math.hypot(whole.noise_m, edge.noise_m)):
            return whole
        return replace(edge, noise_m=math.hypot(edge.noise_m, added_m / 2.0))

    def _face(
        self,
        points: tuple[Floats, Floats, Floats],
        span: tuple[float, float],
        guesses: tuple[tuple[tuple[float, float], float], ...],
        heights: tuple[float, float],
        is_square: bool,
    ) -> EdgeLine | None:
        """Return the face found from the first guess that leads to one.

        Where it lies near the end of the reach, half of its points may lie beyond: it is looked for again from there.
        """
        middle = (span[0] + span[1]) / 2.0
        for first, reach in guesses:
            guess = first
            for _ in range(_FACE_TRIES):
                found = find_face_edge(*points, span, guess, reach, heights, self.sampling, is_square)
                if found is None or abs(found.at(middle) - guess[0]) <= _FACE_CENTRED * reach:
                    break
                guess = (found.at(middle), found.slope)
            if found is not None and found.support >= _LEAST_SUPPORT:
                return found
        return None

    def _step_at(self, out: Floats, offset: Floats, guess_m: float) -> float:
        """Return how far the surface near the edge lies above its plane, as a nosing strip does."""
        is_strip = (out <= guess_m - _STRIP_NEAR_M) & (out >= guess_m - _STRIP_FAR_M)
        strip = offset[is_strip & (np.abs(offset) <= self.band_m + _STRIP_STEP_M)]
        return float(np.median(strip)) if len(strip) >= _FEWEST_IN_STRIP else 0.0

    def _is_obstructed(self, out: Floats, offset: Floats, edge_m: float) -> bool:
        """Return whether something stands at an edge, as a post does, whose shadow may be taken for the edge."""
        beside = (out >= edge_m - _OBSTACLE_INSIDE_M) & (out <= edge_m + _OBSTACLE_OUTSIDE_M)
        low_m = max(_OBSTACLE_LOW_M, _OBSTACLE_SIGMA * self.sampling.sigma_m)
        # Higher up the tread above begins.
        beside &= (offset >= low_m) & (offset <= low_m + _OBSTACLE_HIGH_M)
        return bool(np.count_nonzero(beside) >= _FEWEST_OF_OBSTACLE)

    def _choose(self, extent: EdgeLine | None, face: EdgeLine | None, middle: float) -> EdgeLine | None:
        if self.params.edge_source == "tread" or face is None:
            return extent
        if self.params.edge_source == "face" or extent is None:
            return face
        apart = face.at(middle) - extent.at(middle)
        if extent.support < _LEAST_SUPPORT and apart > 0.0:
            # Seen to end along half of the edge only: what is missing in front of the face lies in a shadow.
            return face
        noise = math.hypot(extent.noise_m, face.noise_m)
        doubt = _FACE_AGREES_M + self.sampling.spacing_m + _AGREE_SIGMAS * noise
        # A tread that goes on beyond the face overhangs it, and its end is the edge. But the face's own topmost row of
        # points, a little above the plane where another station stood higher, may seem to be the tread's last.
        inside = _FACE_INSIDE_M + _FACE_ROWS * self.sampling.spacing_m + _BAND_SIGMA * noise
        return face if -inside <= apart <= doubt else extent


def _hangs_behind(face: EdgeLine, out: Floats, along: Floats, offset: Floats, heights: tuple[float, float]) -> bool:
    """Return whether as much hangs below a surface behind a face as in it: bars end there, and it is no face.

    Below a whole tread there is nothing, or its underside.
    """
    ahead = (out - face.middle_m - face.slope * (along - face.along_m))[
        (-offset >= heights[0]) & (-offset <= heights[1])
    ]
    n_behind = np.count_nonzero((ahead < -_FACE_REACH_M) & (ahead >= -_BAR_M))
    density = n_behind / (_BAR_M - _FACE_REACH_M)
    n_on = np.count_nonzero(np.abs(ahead) <= _FACE_REACH_M / 2.0)
    return bool(density > _BEHIND_SHARE * n_on / _FACE_REACH_M)


def _slots_beside(
    near: _Near, span: tuple[float, float], extent: tuple[float, float, float, float], finder: _Finder
) -> tuple[float, float]:
    """Return where on the left and on the right of a step a slot has its middle, behind which lies another flight.

    Infinite where there is none.
    """
    is_on = (np.abs(near.r) <= finder.band_m) & (near.s >= span[0]) & (near.s <= span[1])
    on_left, on_right = math.inf, -math.inf
    if is_on.any():
        for start, stop in find_slots(near.w[is_on], finder.sampling.spacing_m, finder.is_barred).slots:
            # The rim of what was seen of a step may lie a cell inside its side.
            middle = (start + stop) / 2.0
            on_left = min(on_left, middle) if start >= extent[3] - FINE_M else on_left
            on_right = max(on_right, middle) if stop <= extent[2] + FINE_M else on_right
    return on_left, on_right


def _goes_on_beyond(face: EdgeLine, out: Floats, along: Floats) -> bool:
    """Return whether a surface has points beyond a face of its own, as a tread of bars has: then it is no edge's."""
    beyond = out - face.middle_m - face.slope * (along - face.along_m)
    past = _FACE_REACH_M / 2.0 + _BAND_SIGMA * face.noise_m
    n_beyond = np.count_nonzero((beyond > past) & (beyond <= _BAR_M))
    return bool(n_beyond > _BEYOND_SHARE * np.count_nonzero((beyond > -_BAR_M) & (beyond <= 0.0)))


def _with_back(shape: StepShape, finder: _Finder, above: StepShape | None, rise_m: float) -> StepShape:
    """Find the back edge: the riser face above the step, else the end of what is seen of it."""
    near = finder.near
    _, s_high, w_low, w_high = shape.extent
    span = _inset(_bare_span((w_low, w_high), finder.sampling.left_out))
    if above is None:
        # With nothing above, the end of what was seen may be a shadow's: only a face makes it an edge.
        back = finder.edge(near.s, near.w, span, s_high)
        return replace(shape, back=back if back is not None and back.source == "face" else None)
    # The nosing above, as a line in this frame.
    ends = [shape.from_plan(above.to_plan(above.front.at(w), w)) for w in _front_ends(above)]
    (s0, w0), (s1, w1) = ends
    slope = (s1 - s0) / (w1 - w0) if abs(w1 - w0) > 1e-6 else 0.0
    # The front of a landing is longer than the flight; a riser is as wide as both.
    low, high = max(span[0], min(w0, w1)), min(span[1], max(w0, w1))
    if high - low > 0.3 * (span[1] - span[0]):
        span = (low, high)
    middle = (span[0] + span[1]) / 2.0
    nosing = s0 + slope * (middle - w0)
    sigma = finder.sampling.sigma_m
    near_m = max(_FACE_NEAR_M, _FACE_NEAR_SIGMA * sigma)
    far_m = max(min(0.65 * rise_m, rise_m - priors.NOSING_THICKNESS_M), near_m + _FACE_BAND_M)
    riser: EdgeLine | None = None
    if finder.params.edge_source != "tread":
        guess = (nosing + _RISER_BEHIND_M, slope)
        riser = find_face_edge(near.s, near.w, near.r, span, guess, _RISER_REACH_M, (near_m, far_m), finder.sampling)
    if riser is not None and riser.support >= _LEAST_SUPPORT and riser.purity >= _LEAST_PURITY:
        return replace(shape, back=riser)
    extent = finder.edge(near.s, near.w, span, s_high)
    if extent is not None and extent.at(middle) > nosing + 0.005:
        return replace(shape, back=extent)
    # What is seen ends before the nosing above: that is where its shadow begins, not the tread's end.
    seen = nosing if extent is None else max(extent.at(middle), shape.extent[1])
    return replace(
        shape, back_limits=(min(seen, nosing + priors.DEEPEST_OVERHANG_M), nosing + priors.DEEPEST_OVERHANG_M)
    )


def _front_ends(shape: StepShape) -> tuple[float, float]:
    return shape.extent[2], shape.extent[3]


def _find_foot(
    horizontal: Horizontal, base: Surface, origin: Floats, climb: Floats, extent: tuple[float, float, float, float]
) -> LocalPlane | None:
    """Fit the floor or landing just in front of the lowest step."""
    left = np.array([-climb[1], climb[0]])
    s, w = climb @ (base.cells_m - origin[:, None]), left @ (base.cells_m - origin[:, None])
    front, _, w_low, w_high = extent
    beside = (w >= w_low) & (w <= w_high) & (s <= front)
    if np.count_nonzero(beside) < 4:
        return None
    # From where the floor is first seen in front of the step.
    s_high = float(np.percentile(s[beside], 99.0))
    z0 = float(base.centre_m[2] + base.slope @ (origin - base.centre_m[:2]))
    rough = (z0, float(base.slope @ climb), float(base.slope @ left))
    strip = (s_high - STRIP_M, s_high, w_low, w_high)
    return fit_local(horizontal, base, origin, climb, strip, rough)


def _coverage(shape: StepShape, near: _Near, band_m: float, covered: tuple[float, float] | None) -> float:
    """Return the share of the cells of a tread's rectangle that hold points, of those that no runner covers."""
    s_high = shape.extent[1]
    s_low, w_low, w_high = shape.front.middle_m, shape.right.middle_m, shape.left.middle_m
    if shape.back is not None:
        s_high = shape.back.middle_m
    elif shape.back_limits is not None:
        s_high = shape.back_limits[1]
    cell = max(FINE_M, 2.5 * shape.plane.spacing_m)
    n_s, n_w = max(1, round((s_high - s_low) / cell)), max(1, round((w_high - w_low) / cell))
    if s_high <= s_low or w_high <= w_low:
        return 0.0
    flat = np.abs(near.r) <= band_m
    column = np.floor((near.s[flat] - s_low) / (s_high - s_low) * n_s).astype(np.int64)
    row = np.floor((near.w[flat] - w_low) / (w_high - w_low) * n_w).astype(np.int64)
    inside = (column >= 0) & (column < n_s) & (row >= 0) & (row < n_w)
    is_filled = np.zeros(n_s * n_w, dtype=np.bool_)
    is_filled[column[inside] * n_w + row[inside]] = True
    if covered is not None:
        middles = w_low + (np.arange(n_w) + 0.5) / n_w * (w_high - w_low)
        is_bare = (middles <= covered[0]) | (middles >= covered[1])
        return float(is_filled.reshape(n_s, n_w)[:, is_bare].mean()) if is_bare.any() else 0.0
    return float(is_filled.mean())
