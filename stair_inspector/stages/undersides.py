"""Which steps of a flight are the undersides of treads whose upper faces were not seen?

An open tread above the scanner shows its underside. It lies a board's thickness too low, and its edge stands above it.
"""

from collections.abc import Sequence

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.arrays import Floats
from stair_inspector.geometry.plan import left_of
from stair_inspector.model import Chain, HeightOrder, Patches
from stair_inspector.stages.climbs import straight_climb

_TOO_LOW_M = 0.005
"""Only a step whose riser is lower than the others by so much is looked at."""
_EDGE_M, _RIM_M = 0.02, 0.006
"""How near to its front, along the climb, the edge of a tread stands; and what of its height may be noise."""
_FEWEST, _BELOW, _BEYOND = 20, 0.1, 0.1
"""Points of an edge above a surface, and the share of them that may lie below it, and higher than a board is thick."""
_ACROSS = 0.4
"""Share of the surface's width along which they lie."""


def find_steps_from_below(heights: HeightOrder, patches: Patches, chains: Sequence[Chain]) -> frozenset[int]:
    """Find the steps of straight flights that are undersides.

    Parameters
    ----------
    heights, patches, chains
        Of one scan, level frame.

    Returns
    -------
    frozenset of int
        Numbers of surfaces: lower by what a board is thick than their flight's rhythm, with the edge of the board above
        their front and nothing below it. A riser goes on higher than that, and the edge of an upper face lies below.
    """
    found = set()
    for chain in chains:
        climb = straight_climb(chain)
        if climb is None:
            continue
        numbers = [*([] if chain.base is None else [chain.base]), *chain.steps]
        rises = np.diff([patches.surfaces[number].height_m for number in numbers])
        usual_m = float(np.median(rises)) if len(rises) else 0.0
        for number, rise_m in zip(numbers[1:], rises, strict=True):
            off_m = usual_m - rise_m
            if _TOO_LOW_M <= off_m <= priors.SLAB_THICKNESS_M[1] and _is_underside(heights, patches, number, climb):
                found.add(number)
    return frozenset(found)


def _is_underside(heights: HeightOrder, patches: Patches, number: int, climb: Floats) -> bool:
    surface = patches.surfaces[number]
    left = left_of(climb)
    front = float(np.percentile(climb @ surface.cells_m, 2.0))
    low, high = np.percentile(left @ surface.cells_m, [2.0, 98.0])
    thick_m = priors.SLAB_THICKNESS_M[1]
    reach_m = _EDGE_M + patches.cell_m
    rows = heights.between(surface.height_m - thick_m, surface.height_m + 2.0 * thick_m)
    points = heights.coordinates_m[:, rows]
    ahead, across = climb @ points[:2], left @ points[:2]
    is_near = (np.abs(ahead - front) <= reach_m) & (across >= low) & (across <= high)
    off_m = points[2, is_near] - surface.height_m
    is_edge = (off_m > _RIM_M) & (off_m <= thick_m)
    n_edge = int(np.count_nonzero(is_edge))
    if n_edge < _FEWEST or np.ptp(across[is_near][is_edge]) < _ACROSS * (high - low):
        return False
    n_below, n_beyond = np.count_nonzero(off_m < -_RIM_M), np.count_nonzero(off_m > thick_m)
    return bool(n_below <= _BELOW * n_edge and n_beyond <= _BEYOND * n_edge)
