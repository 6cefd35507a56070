"""On which treads lies a runner so thick that it and what is bare beside it are surfaces of their own?

The runner is the wider surface, and the flight is found on it. Its treads are narrower than the stair, and the lowest
riser is higher by its thickness than what is under it. Strips that lie lower by one thickness beside every tread are
the bare treads.
"""

import dataclasses
from collections.abc import Sequence

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.arrays import Floats
from stair_inspector.geometry.plan import left_of
from stair_inspector.model import Chain, Chains, Horizontal, Patches, Surface
from stair_inspector.stages.bars import surface_of_rows
from stair_inspector.stages.climbs import straight_climb
from stair_inspector.stages.links import depth_along
from stair_inspector.stages.rejects import Forced

_LEAST_M = 0.01
"""Thinner runners are one surface with what is bare."""
_FEWEST_TREADS, _ON_MOST = 2, 0.6
_SAME_THICK_M = 0.003
_BESIDE_CELLS, _GAP_M = 2.0, 0.04
"""Cells on the rim of a surface are partly filled; and a runner's shadow hides as much beside it."""
_SAME_END_M, _NEAR_END_M = 0.006, 0.1
"""The same of a landing, of which the runner's short end says little; and how near to that end it is seen."""
_OVER = 0.5
"""Share of a tread's depth along which what lies beside it must reach."""


@dataclasses.dataclass(frozen=True, slots=True)
class _Beside:
    """A surface that lies lower beside the tread ``step`` of a chain, on its left or right, and by how much."""

    step: int
    number: int
    is_left: bool
    thick_m: float


def with_bare_sides(horizontal: Horizontal, patches: Patches, chains: Chains, forced: Forced) -> Patches:
    """Put what is bare beside a thick runner into the treads that it lies on.

    Parameters
    ----------
    horizontal, patches, chains
        Of one scan.
    forced : Forced
        Surfaces about which the user has decided stay as they are.

    Returns
    -------
    Patches
        The same object where there is no such runner. Else each tread holds the points on the runner and beside it,
        whose surfaces keep their numbers and say of which they are part.
    """
    surfaces = list(patches.surfaces)
    taken: set[int] = set(forced.kinds)
    for chain in chains.chains:
        climb = straight_climb(chain)
        if climb is None or len(chain.steps) <= _FEWEST_TREADS:
            continue
        free = [
            k for k, each in enumerate(surfaces) if k not in taken | {chain.base, *chain.steps} and each.part_of is None
        ]
        beside = _agreeing(_find_beside(surfaces, chain, climb, free, patches.cell_m), len(chain.steps) - 1)
        if not beside or taken & set(chain.steps):
            continue
        thick_m = float(np.median([each.thick_m for each in beside]))
        beside += _around_landing(surfaces, chain, free, thick_m)
        for k, number in enumerate(chain.steps):
            own = [each.number for each in beside if each.step == k]
            if own:
                whole = surfaces[number]
                rows = np.unique(np.concatenate([whole.rows, *(surfaces[other].rows for other in own)]))
                surfaces[number] = surface_of_rows(horizontal, rows, whole.level_id, patches.cell_m)
                for other in own:
                    surfaces[other] = dataclasses.replace(surfaces[other], part_of=number)
        taken |= {*chain.steps, *(each.number for each in beside)}
    is_same = all(a is b for a, b in zip(surfaces, patches.surfaces, strict=True))
    return patches if is_same else Patches(tuple(surfaces), patches.cell_m)


def _find_beside(
    surfaces: Sequence[Surface], chain: Chain, climb: Floats, free: Sequence[int], cell_m: float
) -> list[_Beside]:
    """Return what lies beside the treads of a chain and lower by what a runner is thick."""
    left, found = left_of(climb), []
    for k, number in enumerate(chain.steps[:-1]):
        tread = surfaces[number]
        if tread.is_barred:
            return []
        low, high = np.percentile(left @ tread.cells_m, [2.0, 98.0])
        front, depth_m = float(chain.middles[k] @ climb), depth_along(tread, climb)
        reach_m = _GAP_M + _BESIDE_CELLS * cell_m
        for other in free:
            piece = surfaces[other]
            thick_m = tread.height_at(piece.centre_m[:2]) - float(piece.centre_m[2])
            if not _LEAST_M <= thick_m <= priors.RUNNER_THICKNESS_M[1]:
                continue
            ahead, across = climb @ piece.cells_m, left @ piece.cells_m
            over_m = min(float(ahead.max()), front + depth_m) - max(float(ahead.min()), front)
            if over_m < _OVER * depth_m or ahead.max() > front + depth_m + priors.DEEPEST_OVERHANG_M + reach_m:
                continue
            is_left = bool(across.mean() > high)
            gap_m = float(across.min()) - high if is_left else low - float(across.max())
            if -_BESIDE_CELLS * cell_m <= gap_m <= reach_m:
                found.append(_Beside(k, other, is_left, thick_m))
    return found


def _agreeing(found: Sequence[_Beside], n_treads: int) -> list[_Beside]:
    """Return those that lie lower by one thickness, on most treads on one side; empty where they are not on most."""
    if not found:
        return []
    thick_m = float(np.median([each.thick_m for each in found]))
    near = [each for each in found if abs(each.thick_m - thick_m) <= _SAME_THICK_M]
    kept = []
    for is_left in (False, True):
        own = [each for each in near if each.is_left is is_left]
        if len({each.step for each in own}) >= max(_FEWEST_TREADS, _ON_MOST * n_treads):
            kept += own
    return kept


def _around_landing(surfaces: Sequence[Surface], chain: Chain, free: Sequence[int], thick_m: float) -> list[_Beside]:
    """Return the landing on which the runner ends: it lies around the runner's end, lower by its thickness."""
    last = len(chain.steps) - 1
    end = surfaces[chain.steps[last]]
    found = []
    for other in free:
        landing = surfaces[other]
        lower_m = end.height_at(landing.centre_m[:2]) - float(landing.centre_m[2])
        if abs(lower_m - thick_m) > _SAME_END_M:
            continue
        apart_m = np.hypot(*(landing.cells_m[:, :, None] - end.cells_m[:, None])).min()
        if apart_m <= _NEAR_END_M:
            found.append(_Beside(last, other, False, thick_m))
    return found
