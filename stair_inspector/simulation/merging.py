"""What do merging programs leave of the returns? Thinned, smoothed over, with holes."""

from dataclasses import dataclass, fields

import numpy as np

from stair_inspector.geometry.arrays import Bools, Colors, Floats, Ints, Labels
from stair_inspector.simulation.rays import dot_rows

_PAIRS_AT_ONCE = 4_000_000


@dataclass(frozen=True, slots=True, eq=False)
class ScanReturns:
    """What came back to the scanner; stair frame. ``squares`` (n, 2) count spacings along the surface hit."""

    points: Floats
    colors: Colors
    station_ids: Labels
    surface_ids: Ints
    is_mixed: Bools
    squares: Ints
    priority: Floats

    def taken(self, ids: Ints) -> "ScanReturns":
        """Return some of the returns."""
        return ScanReturns(*(getattr(self, item.name)[ids] for item in fields(self)))

    @staticmethod
    def joined(parts: "list[ScanReturns]") -> "ScanReturns":
        """Return the returns of several parts as one, in order."""
        names = [item.name for item in fields(ScanReturns)]
        return ScanReturns(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))


def thin_out(returns: ScanReturns, joint_of: Ints, spacing_m: float) -> ScanReturns:
    """Keep the return with the lowest priority number in each square; surfaces with one ``joint_of`` share squares."""
    if not spacing_m:
        return returns
    column, row = returns.squares.T
    joints = joint_of[returns.surface_ids]
    order = np.lexsort((returns.priority, row, column, joints))
    is_first = np.ones(len(order), dtype=np.bool_)
    for key in (joints[order], column[order], row[order]):
        is_first[1:] &= key[1:] == key[:-1]
    is_first[1:] = ~is_first[1:]
    return returns.taken(np.sort(order[is_first]))


def smooth_over(points: Floats, radius_m: float) -> Floats:
    """Move every point to the mean of the points within the radius, itself included.

    Notes
    -----
    A grid in plain numpy, not a search tree: sums are taken in an order that no processor and no library changes.
    """
    if not radius_m or not len(points):
        return points
    cells = np.floor(points / radius_m).astype(np.int64)
    cells -= cells.min(axis=0) - 1
    n_columns, n_layers = (int(n) for n in cells[:, 1:].max(axis=0) + 2)
    keys = (cells[:, 0] * n_columns + cells[:, 1]) * n_layers + cells[:, 2]
    order = np.argsort(keys, kind="stable")
    keys, placed = keys[order], points[order]
    total, count = np.zeros_like(placed), np.zeros(len(placed))
    # Cells above each other follow each other in the order: nine runs of three cells are the neighbourhood.
    for column in [(row * n_columns + side) * n_layers for row in (-1, 0, 1) for side in (-1, 0, 1)]:
        start = np.searchsorted(keys, keys + column - 1, side="left")
        length = np.searchsorted(keys, keys + column + 1, side="right") - start
        ends = np.cumsum(length)
        first = 0
        while first < len(keys):
            paired = int(ends[first - 1]) if first else 0
            last = max(first + 1, int(np.searchsorted(ends, paired + _PAIRS_AT_ONCE, side="right")))
            n_each = length[first:last]
            mine = np.repeat(np.arange(first, last), n_each)
            offset = np.arange(len(mine)) - np.repeat(ends[first:last] - n_each - paired, n_each)
            theirs = start[mine] + offset
            apart = placed[theirs] - placed[mine]
            is_near = dot_rows(apart, apart) <= radius_m * radius_m
            mine, theirs = mine[is_near] - first, theirs[is_near]
            count[first:last] += np.bincount(mine, minlength=last - first)
            for axis in range(3):
                total[first:last, axis] += np.bincount(mine, placed[theirs, axis], minlength=last - first)
            first = last
    smoothed = np.zeros_like(points)
    smoothed[order] = total / count[:, None]
    return smoothed
