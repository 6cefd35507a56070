"""How far does a stair go on beyond the part that its rhythm shows? Steps that touch each other, to floor and landing.

Of a stair that turns, a straight rhythm is that of a part; its other steps lie beside the rhythm's line, and may be
a little off its heights.
"""

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.arrays import Bools, Floats, project
from stair_inspector.geometry.clusters import cluster_sorted, find_reach
from stair_inspector.geometry.lattice import Lattice

_LEVEL_EPS_M, _FEWEST_POINTS = 0.01, 10
_ROW = 1 << 31
_NEAR_TREAD = 0.3
"""A tread of the rhythm lies so near to where it says, in rises and in goings."""
_AROUND = 3
"""A floor or landing is told from a step by what lies at its height so many goings around."""
_EVEN = 1.25
"""Ratio of a rise beyond the rhythm to that of the rhythm, and its inverse: a flight goes on evenly."""


def reach_of(points: Floats, is_level: Bools, lattice: Lattice) -> tuple[float, float]:
    """Find from which height to which a stair goes on beyond the outermost treads of its rhythm.

    Parameters
    ----------
    points : (n, 3), metres
        Thinned to an even density, in the frame of ``lattice``.
    is_level : (n,)
        Which of them face along the lattice's up.
    lattice : Lattice
        With its up, in any reading.

    Returns
    -------
    (low, high)
        Heights over the lattice's origin, metres: of the lowest and the highest level surface that is reached from the
        outermost treads by steps of about one rise, each beside the one before; the last one may be floor or landing.
        Where nothing is reached they are those of the outermost treads.
    """
    side = np.cross(lattice.up, lattice.ahead)
    shifted = (points[is_level] - lattice.origin).T
    height, ahead, aside = (project(shifted, axis) for axis in (lattice.up, lattice.ahead, side))
    order = np.argsort(height, kind="stable")
    height, plan = height[order], np.stack([ahead[order], aside[order]], axis=1)
    clusters = cluster_sorted(find_reach(height, _LEVEL_EPS_M), _FEWEST_POINTS)
    spans = list(zip(clusters.start.tolist(), clusters.stop.tolist(), strict=True))
    levels = np.array([height[(start + stop) // 2] for start, stop in spans])
    ends = []
    for tread, way in ((min(lattice.treads), -1.0), (max(lattice.treads), 1.0)):
        reached = tread * lattice.rise_m
        is_on = np.abs(plan[:, 0] / lattice.going_m - tread - 0.5) <= 0.5 + _NEAR_TREAD
        is_on &= (np.abs(plan[:, 1]) <= lattice.width_m / 2.0) & (
            np.abs(height - reached) <= _NEAR_TREAD * lattice.rise_m
        )
        beside = plan[is_on]
        size = largest = len(beside)
        # The rhythm of a part may be a little off, which several steps on is more than a riser may.
        reached = float(np.median(height[is_on])) if size else reached
        while _FEWEST_POINTS <= size <= priors.FLOOR_RATIO * largest:
            largest = max(largest, size)
            ratios = way * (levels - reached) / lattice.rise_m
            nexts = np.flatnonzero((ratios >= 1.0 / _EVEN) & (ratios <= _EVEN))
            size = 0
            for number in nexts[np.argsort(np.abs(ratios[nexts] - 1.0), kind="stable")]:
                found = plan[slice(*spans[number])]
                is_next, is_around = (_is_near(found, beside, lattice.going_m, n) for n in (1, _AROUND))
                if np.count_nonzero(is_next) >= _FEWEST_POINTS:
                    size, reached = int(np.count_nonzero(is_around)), float(levels[number])
                    beside = found[is_next]
                    break
        ends.append(reached)
    return ends[0], ends[1]


def _is_near(places: Floats, others: Floats, cell_m: float, n_cells: int) -> Bools:
    """Return which places of a plan (n, 2) lie up to so many cells from one that holds any of the others."""
    offsets = np.arange(-n_cells, n_cells + 1)
    around = (offsets[:, None] * _ROW + offsets).ravel()
    codes, taken = (np.floor(each / cell_m).astype(np.int64) @ np.array([_ROW, 1]) for each in (places, others))
    return np.isin(codes, (np.unique(taken)[:, None] + around).ravel())
