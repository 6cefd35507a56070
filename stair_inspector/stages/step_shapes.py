"""What are the plane and the edges of one step? From its patch and what lies near it."""

import math
from dataclasses import dataclass, replace

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.arrays import Floats
from stair_inspector.geometry.edges import EdgeLine, Sampling, find_face_edge
from stair_inspector.geometry.percentiles import percentiles
from stair_inspector.geometry.plan import left_of, place_in_frame
from stair_inspector.geometry.sight import Sight
from stair_inspector.geometry.slots import find_slots
from stair_inspector.model import Arc, Chain, HeightOrder, Horizontal, LocalPlane, Patches, StepShape, Surface
from stair_inspector.params import SurveyParams
from stair_inspector.stages.arcs import across_arc, side_of, span_beside
from stair_inspector.stages.block_layers import scatter_on
from stair_inspector.stages.edge_finder import BAND_SIGMA, FACE_NEAR_M, LEAST_PURITY, LEAST_SUPPORT, NOISY_M, EdgeFinder
from stair_inspector.stages.hidden import UNSEEN_M
from stair_inspector.stages.near_points import FACE_BAND_M, FACE_NEAR_SIGMA, NearPoints, gather_near, refit_plane
from stair_inspector.stages.nosing_heights import with_nosing_heights
from stair_inspector.stages.planes import FINE_M, fit_local

_FACE_REACH_M = (priors.RISER_BEHIND_M + priors.RISER_AHEAD_M) / 2.0
_FACE_MIDDLE_M = (priors.RISER_BEHIND_M - priors.RISER_AHEAD_M) / 2.0
"""Half width and middle of the search for a riser's face, behind the nosing above it."""
_UNSEEN_SLOPE = 0.02
_INSET_M = 0.03
_LEAST_BAND_M = 0.002


@dataclass(frozen=True, slots=True, eq=False)
class Scanned:
    """What the edges of a scan's steps are looked for in, and how; ``is_stepped`` where coordinates were rounded.

    ``sight`` is what stations looked through, None where they are not known.
    """

    heights: HeightOrder
    horizontal: Horizontal
    patches: Patches
    params: SurveyParams
    is_stepped: bool
    sight: Sight | None = None


def find_shape(
    scanned: Scanned,
    chain: Chain,
    k: int,
    climb: Floats,
    above: StepShape | None,
    is_straight: bool,
    span: tuple[float, float] | None,
    arc: Arc | None,
) -> StepShape:
    """Find the plane and the edges of step ``k`` of a chain along a direction of climb, in the step's own frame.

    Parameters
    ----------
    scanned, chain
        Of one scan.
    k, climb
        The step, and its direction of climb (2,).
    above : StepShape, optional
        Of the step above, if there is one.
    is_straight : bool
        Whether the sides run exactly along the climb.
    span : (low, high), optional
        Between which sides most steps of a sparse flight lie, across the climb.
    arc : Arc, optional
        Of a flight that curves.
    """
    patches = scanned.patches
    number = chain.steps[k]
    surface = patches.surfaces[number]
    left = left_of(climb)
    # Nothing lies below the first step of a flight without a floor: the patch's own front is all there is.
    has_edge = k > 0 or chain.base is not None
    origin = chain.middles[k] if has_edge else surface.cells_m.mean(axis=1)
    s, w = climb @ (surface.cells_m - origin[:, None]), left @ (surface.cells_m - origin[:, None])
    covered = None
    if surface.covered_m is not None:
        covered = (surface.covered_m[0] - float(left @ origin), surface.covered_m[1] - float(left @ origin))
    front = _front_of(s, w, chain.lengths_m[k], covered)
    is_strip = s <= front + priors.FLOOR_STRIP_M
    w_low, w_high = percentiles(w[is_strip], 1.0, 99.0)
    if covered is not None:
        w_low, w_high = _with_cover(patches, number, left, origin, (w_low, w_high))
    if span is not None:
        # Of a few cells in a row some may be missing at either end.
        aside = float(left @ origin)
        w_low, w_high = min(w_low, span[0] - aside), max(w_high, span[1] - aside)
    # Between the quarters of the width: a floor next door at the same height must not make a tread deeper.
    inner = (w >= w_low + 0.25 * (w_high - w_low)) & (w <= w_high - 0.25 * (w_high - w_low))
    (s_high,) = percentiles(s[inner] if inner.any() else s, 98.0)
    s_high = max(s_high, front + 2.0 * patches.cell_m)
    extent = (front, s_high, w_low, w_high)
    plane = fit_local(scanned.horizontal, surface, origin, climb, extent)
    band_m = scanned.params.band_m or max(BAND_SIGMA * plane.sigma_m, _LEAST_BAND_M)
    rise_above_m, reach = 0.0, extent
    if above is not None:
        s_above, w_above = place_in_frame(above.to_plan(above.front.middle_m, 0.0), origin, climb)
        rise_above_m = above.plane.z0_m - plane.at(s_above, w_above)
        # The riser may lie beyond what was seen of the tread.
        reach = (front, max(s_high, s_above), w_low, w_high)
    near, stride = gather_near(scanned.heights, origin, climb, reach, plane, max(rise_above_m, 0.1))
    plane = replace(plane, spacing_m=plane.spacing_m * math.sqrt(stride))
    if plane.sigma_m > NOISY_M or span is not None:
        plane, near = refit_plane(near, plane, extent)
    plane = replace(plane, cover_m=surface.cover_m, aside_m=surface.aside_m)
    sampling = Sampling(plane.sigma_m, plane.spacing_m)
    if covered is not None:
        near = near.chosen((near.w < covered[0]) | (near.w > covered[1]))
    finder = EdgeFinder(near, sampling, band_m, scanned.params, surface.is_barred)
    finder_across = replace(finder, sampling=replace(sampling, left_out=covered))
    half_m = chain.lengths_m[k] / 2.0
    is_wide = w_high - w_low > 1.5 * chain.lengths_m[k]
    front_span = (-half_m, half_m) if is_wide and has_edge else (w_low, w_high)
    found = finder_across.edge(-near.s, near.w, _inset(front_span), -front, is_foot=False)
    nosing = _guessed(front, front_span) if found is None else found.flipped()
    start = nosing.middle_m
    side_span = _inset((start, min(s_high, start + priors.FLOOR_STRIP_M)))
    across, left_span, right_span = near.w, side_span, side_span
    if arc is not None:
        across = across_arc(arc, origin, climb, near.s, near.w)
        # The riser above turns against this nosing: on the inner side of the curve it stands nearer.
        left_span, right_span = (_inset(span_beside(arc, origin, climb, (start, s_high), w)) for w in (w_high, w_low))
    on_left, on_right = (math.inf, -math.inf) if arc is not None else _slots_beside(near, side_span, extent, finder)
    if is_straight and arc is None:
        aside = float(left @ origin)
        on_left, on_right = min(on_left, surface.bounds_m[1] - aside), max(on_right, surface.bounds_m[0] - aside)
    to_left = finder.edge(across, near.s, left_span, w_high, is_square=is_straight, stop_m=on_left)
    to_right = finder.edge(-across, near.s, right_span, -w_low, is_square=is_straight, stop_m=-on_right)
    left_side = to_left or _guessed(w_high, left_span)
    right_side = _guessed(w_low, right_span) if to_right is None else to_right.flipped()
    if arc is not None:
        left_side, right_side = (side_of(arc, origin, climb, side) for side in (left_side, right_side))
    foot = None
    if k == 0 and chain.base is not None:
        foot = _find_foot(scanned.horizontal, patches.surfaces[chain.base], origin, climb, extent)
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
        foot=foot,
        back_limits=None,
        coverage=0.0,
        line_range=(0.0, 0.0),
        nosing_offsets=(0.0, 0.0, 0.0),
        nosing_noise=(0.0, 0.0, 0.0),
    )
    shape = replace(shape, line_range=(shape.right.at(start), shape.left.at(start)))
    shape = with_nosing_heights(shape, near, band_m, scanned.is_stepped, surface.is_barred)
    shape = _with_back(shape, finder_across, above, rise_above_m)
    scatter = None if surface.is_barred or surface.cover_m else scatter_on(near, extent)
    return replace(shape, coverage=_coverage(shape, near, band_m, covered), scatter=scatter)


def _guessed(place_m: float, span: tuple[float, float]) -> EdgeLine:
    """Return an edge of which only the patch's rim is known: its uncertainty is large, not absent."""
    return EdgeLine(place_m, 0.0, sum(span) / 2.0, UNSEEN_M, _UNSEEN_SLOPE, 0.0, "tread")


def _front_of(s: Floats, w: Floats, length_m: float, covered: tuple[float, float] | None) -> float:
    """Return where a patch begins over the middle of its front edge, beside what covers it there."""
    is_middle = np.abs(w) <= (0.4 if covered is None else 0.5) * length_m
    if covered is not None:
        is_middle &= (w <= covered[0]) | (w >= covered[1])
    return percentiles(s[is_middle] if is_middle.any() else s, 2.0)[0]


def _with_cover(
    patches: Patches, number: int, left: Floats, origin: Floats, sides: tuple[float, float]
) -> tuple[float, float]:
    """Return between which sides a step lies with the runner that was taken off it."""
    ends = [
        np.percentile(left @ (piece.cells_m - origin[:, None]), [1.0, 99.0])
        for piece in patches.surfaces
        if piece.part_of == number
    ]
    return min([sides[0], *(float(low) for low, _ in ends)]), max([sides[1], *(float(high) for _, high in ends)])


def _inset(span: tuple[float, float]) -> tuple[float, float]:
    """Leave out the ends of an edge, where other edges meet it."""
    inset = min(_INSET_M, 0.15 * (span[1] - span[0]))
    return span[0] + inset, span[1] - inset


def _slots_beside(
    near: NearPoints, span: tuple[float, float], extent: tuple[float, float, float, float], finder: EdgeFinder
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


def _with_back(shape: StepShape, finder: EdgeFinder, above: StepShape | None, rise_m: float) -> StepShape:
    """Find the back edge: the riser face above the step, else the end of what is seen of it."""
    near = finder.near
    _, s_high, w_low, w_high = shape.extent
    span = _inset((w_low, w_high))
    if above is None:
        # With nothing above, the end of what was seen may be a shadow's: only a face makes it an edge.
        back = finder.edge(near.s, near.w, span, s_high)
        return replace(shape, back=back if back is not None and back.source == "face" else None)
    # The nosing above, as a line in this frame.
    (s0, w0), (s1, w1) = (shape.from_plan(above.to_plan(above.front.at(w), w)) for w in above.extent[2:])
    slope = (s1 - s0) / (w1 - w0) if abs(w1 - w0) > 1e-6 else 0.0
    # The front of a landing is longer than the flight; a riser is as wide as both.
    low, high = max(span[0], min(w0, w1)), min(span[1], max(w0, w1))
    if high - low > 0.3 * (span[1] - span[0]):
        span = (low, high)
    middle = (span[0] + span[1]) / 2.0
    nosing = s0 + slope * (middle - w0)
    sigma = finder.sampling.sigma_m
    near_m = max(FACE_NEAR_M, FACE_NEAR_SIGMA * sigma)
    far_m = max(min(0.65 * rise_m, rise_m - priors.NOSING_THICKNESS_M), near_m + FACE_BAND_M)
    riser: EdgeLine | None = None
    if finder.params.edge_source != "tread":
        guess = (nosing + _FACE_MIDDLE_M, slope)
        riser = find_face_edge(near.s, near.w, near.r, span, guess, _FACE_REACH_M, (near_m, far_m), finder.sampling)
    if riser is not None and riser.support >= LEAST_SUPPORT and riser.purity >= LEAST_PURITY:
        return replace(shape, back=riser)
    extent = finder.edge(near.s, near.w, span, s_high)
    if extent is not None and extent.at(middle) > nosing + 0.005:
        return replace(shape, back=extent)
    # What is seen ends before the nosing above: that is where its shadow begins, not the tread's end.
    seen = nosing if extent is None else max(extent.at(middle), shape.extent[1])
    return replace(
        shape, back_limits=(min(seen, nosing + priors.DEEPEST_OVERHANG_M), nosing + priors.DEEPEST_OVERHANG_M)
    )


def _find_foot(
    horizontal: Horizontal, base: Surface, origin: Floats, climb: Floats, extent: tuple[float, float, float, float]
) -> LocalPlane | None:
    """Fit the floor or landing just in front of the lowest step."""
    left = left_of(climb)
    s, w = climb @ (base.cells_m - origin[:, None]), left @ (base.cells_m - origin[:, None])
    front, _, w_low, w_high = extent
    beside = (w >= w_low) & (w <= w_high) & (s <= front)
    if np.count_nonzero(beside) < 4:
        return None
    # From where the floor is first seen in front of the step.
    (s_high,) = percentiles(s[beside], 99.0)
    strip = (s_high - priors.FLOOR_STRIP_M, s_high, w_low, w_high)
    return fit_local(horizontal, base, origin, climb, strip)


def _coverage(shape: StepShape, near: NearPoints, band_m: float, covered: tuple[float, float] | None) -> float:
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
