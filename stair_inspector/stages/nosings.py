"""Where are the nosing, the back and the sides of every step? Edges from treads and from the faces that meet them."""

from collections.abc import Sequence

import numpy as np

from stair_inspector.geometry.arrays import Floats
from stair_inspector.geometry.plan import left_of
from stair_inspector.geometry.sight import Sight
from stair_inspector.model import Arc, Chain, Chains, HeightOrder, Horizontal, Patches, StepShape
from stair_inspector.params import SurveyParams
from stair_inspector.stages.arcs import climb_on_arc, find_arc, turning_climbs, with_arc_sides
from stair_inspector.stages.climbs import flight_after, straight_climb
from stair_inspector.stages.face_noise import with_face_noise
from stair_inspector.stages.hidden import with_common_sides, with_doubtful_fronts, with_wedge_sides
from stair_inspector.stages.pooled import pool_steps
from stair_inspector.stages.seen_ends import with_seen_fronts, with_seen_sides
from stair_inspector.stages.sparse import SPARSE_M
from stair_inspector.stages.step_shapes import Scanned, find_shape


def find_shapes(
    heights: HeightOrder,
    horizontal: Horizontal,
    patches: Patches,
    chains: Chains,
    params: SurveyParams,
    is_stepped: bool = False,
    sparse_step_m: float | None = None,
    sight: Sight | None = None,
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
    sight : Sight, optional
        What stations looked through, scan axes; None where they are not known.

    Returns
    -------
    tuple of tuple of StepShape
        For each chain its steps from bottom to top; level frame.
    """
    sight = None if sight is None else sight.in_frame(heights.level_from_scan)
    scanned = Scanned(heights, horizontal, patches, params, is_stepped, sight)
    shapes: dict[int, tuple[StepShape, ...]] = {}
    # From the top, because the back of a landing is looked for near the flight that begins there.
    for number in range(len(chains.chains) - 1, -1, -1):
        after = flight_after(chains, number)
        above = None if after is None else shapes[after][0]
        shapes[number] = _shapes_of(scanned, chains.chains[number], above, sparse_step_m)
    found = tuple(shapes[number] for number in range(len(chains.chains)))
    return found if sight is None else tuple(with_face_noise(own, sight) for own in found)


def _shapes_of(
    scanned: Scanned, chain: Chain, above: StepShape | None, sparse_step_m: float | None
) -> tuple[StepShape, ...]:
    common = straight_climb(chain)
    span = _common_span(scanned.patches, chain, common) if sparse_step_m is not None and common is not None else None
    usual = [climb if common is None else common for climb in chain.climbs]
    turning = turning_climbs(chain)
    found: list[StepShape] = []
    for climbs in (usual,) if turning is None else (turning, usual):
        is_square = common is not None and climbs is usual
        found = _shapes_along(scanned, chain, above, climbs, is_square, span if is_square else None)
        arc = find_arc(found)
        if arc is None:
            continue
        # Once more along the arc: the sides of a tread are looked for beside its own direction of climb.
        climbs = [climb_on_arc(arc, shape) for shape in found]
        curved = _shapes_along(scanned, chain, above, climbs, True, None, arc)
        arc = find_arc(curved)
        if arc is not None:
            return tuple(with_arc_sides(curved, arc))
    if span is not None and sparse_step_m is not None:
        found = pool_steps(scanned.heights, found, sparse_step_m)
    if common is None:
        return tuple(with_wedge_sides(found, chain))
    checked = with_common_sides(found, common)
    return tuple(checked if scanned.sight is None else with_seen_sides(found, checked, common, scanned.sight))


def _shapes_along(
    scanned: Scanned,
    chain: Chain,
    above: StepShape | None,
    climbs: Sequence[Floats],
    is_straight: bool,
    span: tuple[float, float] | None,
    arc: Arc | None = None,
) -> list[StepShape]:
    """Find plane and edges of all steps, each along its direction of climb."""
    shapes: list[StepShape] = []
    # From the top, because the back of a step is looked for near the nosing above it.
    for k in range(len(chain.steps) - 1, -1, -1):
        is_last_below_gap = k + 1 < len(chain.steps) and chain.n_missing[k + 1] > 0
        above = find_shape(scanned, chain, k, climbs[k], None if is_last_below_gap else above, is_straight, span, arc)
        shapes.append(above)
    is_one_way = is_straight and arc is None
    found = shapes[::-1]
    doubted = with_doubtful_fronts(found, chain, climbs[0] if is_one_way else None)
    return doubted if scanned.sight is None else with_seen_fronts(found, doubted, scanned.sight)


def _common_span(patches: Patches, chain: Chain, climb: Floats) -> tuple[float, float] | None:
    """Return between which sides most treads of a straight flight lie across its climb; None if they are not sparse."""
    surfaces = [patches.surfaces[number] for number in chain.steps]
    spacings = [surface.spacing_m for surface in surfaces]
    if float(np.median(spacings)) <= SPARSE_M:
        return None
    across = left_of(climb)
    ends = np.array([np.percentile(across @ surface.cells_m, [1.0, 99.0]) for surface in surfaces])
    return float(np.percentile(ends[:, 0], 25.0)), float(np.percentile(ends[:, 1], 75.0))
