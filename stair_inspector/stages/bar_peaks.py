"""Where lie many points at one height? Peaks in columns of the plan, and what lies on and below them.

All this hangs on the points and on no setting but the size of a cell: whose normals are level is asked afterwards.
"""

import functools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stair_inspector.geometry.arrays import Bools, Floats, Ints, freeze
from stair_inspector.geometry.clusters import cluster_cells
from stair_inspector.geometry.percentiles import MAD_TO_SIGMA, median
from stair_inspector.geometry.trimmed import densest, fit_trimmed, height_above
from stair_inspector.model import HeightOrder

_COLUMN_M = 0.12
"""Side of the columns of plan in which points are counted by height: a bar of 60 mm and a gap of 60 mm fit into it."""
_BIN_M = 0.005
_LARGEST_TABLE = 30_000_000
FEWEST_IN_PEAK = 8
_PEAK = 1.5
"""So many times as many points as just above and just below are the top of something."""
_CHANCE = 2.0
"""The same in standard deviations of a count: of few points, some lie at one height by chance."""
NOT_LEVEL, LITTLE_NOT_LEVEL = 0.25, 0.05
"""Share of the points at one height that do not seem level from which they may be bars: on whole treads only the rim's
are none. Where gaps are narrow fewer slant too, and only what is seen of the bars' sides tells."""
_BAND_M = 0.008
_SIDE_NEAR_M, _SIDE_NEAR_SIGMAS, _SIDE_FAR_M, _SIDE_PARTS = 0.005, 4.0, 0.02, 3
"""Between these depths below a surface, the first in its noise too, the sides of bars show, in each of some parts."""
_SIDE_SHARE = 0.06
"""So many points on them, as a share of those on the tops above, are no noise."""
_TRIM_SIGMA, _LEAST_SIGMA_M, _ROUNDS = 2.5, 0.0005, 3
_MOST_TO_FIT, _ENOUGH_TO_FIT = 4000, 1000


@dataclass(frozen=True, slots=True, eq=False)
class TopPlane:
    """The plane of the tops of bars: slope (2,), a point of it (3,) and the scatter about it, metres, level frame."""

    slope: Floats
    centre: Floats
    sigma_m: float


@dataclass(frozen=True, eq=False)
class Top:
    """A group of peaks of about one height that touch in plan, and its points, looked for when first asked for.

    ``columns`` (2, p) of the plan, counted from the corner ``low_m`` (2,), hold peaks at the heights ``height_m`` (p,)
    of all points ``coordinates_m`` (3, n), by height; ``cell_m`` is the side of a plan cell.
    """

    coordinates_m: Floats
    low_m: Floats
    columns: Ints
    height_m: Floats
    cell_m: float

    @functools.cached_property
    def rows(self) -> Ints:
        """Return the points at the group's height, in its columns and those around it."""
        return freeze(_points_at(self))

    @functools.cached_property
    def roughly(self) -> tuple[Ints, TopPlane]:
        """Return those of the points that lie on the plane of the tops, and the plane, as some of them give it."""
        return _on_plane(self.coordinates_m, self.rows, _ENOUGH_TO_FIT)

    @functools.cached_property
    def well(self) -> tuple[Ints, TopPlane]:
        """Return the same, as more of them give it."""
        return _on_plane(self.coordinates_m, self.rows, _MOST_TO_FIT)

    @functools.cached_property
    def has_sides(self) -> bool:
        """Return :func:`has_sides_within` of the points that are roughly on the plane."""
        return has_sides_within(self.coordinates_m, *self.roughly, self.cell_m)


@dataclass(frozen=True, slots=True, eq=False)
class Peaks:
    """Groups of peaks: ``tops`` (g,), the number of points in the peaks of each, and each point's group (n,) or -1."""

    tops: tuple[Top, ...] = ()
    counts: Floats | None = None
    group_of: NDArray[np.int32] | None = None

    def not_level(self, is_level: Bools) -> Floats:
        """Return the share (g,) of each group's points that do not seem level, given which points do (n,)."""
        if self.counts is None or self.group_of is None:
            return np.zeros(0)
        slanting = np.bincount(self.group_of[~is_level] + 1, minlength=len(self.counts) + 1)[1:]
        shares: Floats = slanting / np.maximum(self.counts, 1.0)
        return shares


def find_peaks(heights: HeightOrder, cell_m: float) -> Peaks:
    """Find the groups of peaks, which touch at one height, of all points, on plan cells of a size for what is asked."""
    coordinates = heights.coordinates_m
    if not coordinates.size:
        return Peaks()
    low = coordinates.min(axis=1)
    low[:2] -= _COLUMN_M
    n_columns, n_rows = (int(size / _COLUMN_M) + 2 for size in (coordinates[:2].max(axis=1) - low[:2]))
    # Room above and below, so that windows of one column do not reach into the next.
    n_bins = int((coordinates[2, -1] - low[2]) / _BIN_M) + 9
    size = n_columns * n_rows * n_bins
    if size > _LARGEST_TABLE:
        return Peaks()
    keys = ((coordinates[0] - low[0]) / _COLUMN_M).astype(np.int64) * n_rows
    keys += ((coordinates[1] - low[1]) / _COLUMN_M).astype(np.int64)
    keys *= n_bins
    keys += ((coordinates[2] - low[2]) / _BIN_M).astype(np.int64) + 4
    every = np.bincount(keys, minlength=size)
    first = np.flatnonzero(every >= FEWEST_IN_PEAK // 2)
    # The lower of the two bins of a window may be the empty one.
    first = np.union1d(first, first - 1)
    here = every[first] + every[first + 1]
    others = np.maximum(every[first - 2] + every[first - 1], every[first + 2] + every[first + 3])
    is_peak = (here >= FEWEST_IN_PEAK) & (here >= _PEAK * others + _CHANCE * np.sqrt(others))
    # Of two windows that overlap the fuller one.
    is_peak &= (every[first] >= every[first + 2]) & (every[first + 1] >= every[first - 1])
    first = first[is_peak]
    if not len(first):
        return Peaks()
    column, bin_ = np.divmod(first, n_bins)
    places = np.stack(np.divmod(column, n_rows))
    weights = np.stack([every[first], every[first + 1]]).astype(np.float64)
    height_m = low[2] + _BIN_M * (bin_ - 4 + 0.5 + weights[1] / weights.sum(axis=0))
    kept, group = _grouped(places, height_m)
    first, places, height_m = first[kept], places[:, kept], height_m[kept]
    n_groups = int(group.max(initial=-1)) + 1
    group_of_bin = np.full(size, -1, dtype=np.int32)
    # No two windows that are kept overlap: within one layer a column has one, and layers lie farther apart.
    group_of_bin[first] = group_of_bin[first + 1] = group
    tops = []
    for number in range(n_groups):
        own = group == number
        tops.append(Top(coordinates, low[:2], freeze(places[:, own]), freeze(height_m[own]), cell_m))
    counts = np.bincount(group, weights.sum(axis=0)[kept], n_groups)
    return Peaks(tuple(tops), freeze(counts), freeze(group_of_bin.take(keys)))


def _grouped(places: Ints, height_m: Floats) -> tuple[Ints, Ints]:
    """Return which peaks are of groups, columns that touch with peaks of about one height, and the group of each."""
    order = np.argsort(height_m, kind="stable")
    # Heights far enough apart are never one surface's; within a layer a column has one peak.
    layer = np.concatenate([[0], np.cumsum(np.diff(height_m[order]) > 2.0 * _BIN_M)])
    column, row = places[:, order]
    _, first = np.unique((layer * (column.max() + 1) + column) * (row.max() + 1) + row, return_index=True)
    kept = order[first]
    keys = np.stack([layer[first], *places[:, kept]])
    labels = cluster_cells(keys, height_m[kept] / (2.0 * _BIN_M), np.ones(len(kept), dtype=np.int64), 2)
    is_grouped = labels >= 0
    return kept[is_grouped], labels[is_grouped]


def _points_at(top: Top) -> Ints:
    """Return the points at a group's height, in its columns and those around it."""
    spread = np.array([(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1)])
    # The nearest column's own peak last, so that its height stands.
    spread = spread[np.argsort(-np.abs(spread).sum(axis=1), kind="stable")]
    first = top.columns.min(axis=1) - 1
    shape = top.columns.max(axis=1) - first + 2
    table = np.full((int(shape[0]), int(shape[1])), np.nan)
    for step in spread:
        at = top.columns - first[:, None] + step[:, None]
        table[at[0], at[1]] = top.height_m
    low_m, high_m = float(top.height_m.min()) - _BAND_M, float(top.height_m.max()) + _BAND_M
    start, stop = np.searchsorted(top.coordinates_m[2], (low_m, high_m))
    near = top.coordinates_m[:, start:stop]
    column = ((near[0] - top.low_m[0]) / _COLUMN_M).astype(np.int64) - first[0]
    row = ((near[1] - top.low_m[1]) / _COLUMN_M).astype(np.int64) - first[1]
    is_in = (column >= 0) & (column < table.shape[0]) & (row >= 0) & (row < table.shape[1])
    inside = np.flatnonzero(is_in)
    off = np.abs(near[2, inside] - table[column[inside], row[inside]])
    found: Ints = start + inside[off <= _BAND_M]
    return found


def has_sides_within(coordinates: Floats, rows: Ints, plane: TopPlane, cell_m: float) -> bool:
    """Return whether the sides of bars hang below a surface, given by its points and plane, away from its rim.

    Sides go down evenly from the tops; the underside of a thin slab, which may be seen from below, lies at one depth.
    """
    points = coordinates[:, rows[:: -(-len(rows) // _MOST_TO_FIT)]]
    near_m, far_m = max(_SIDE_NEAR_M, _SIDE_NEAR_SIGMAS * plane.sigma_m), _SIDE_FAR_M
    if near_m >= far_m / 2.0:
        return False
    side_m = 2.0 * cell_m
    low = points[:2].min(axis=1) - 2.0 * side_m
    shape = tuple(int(size) + 3 for size in (points[:2].max(axis=1) - low) / side_m)
    column, row = ((points[:2] - low[:, None]) / side_m).astype(np.int64)
    is_on = np.zeros(shape, dtype=np.bool_)
    is_on[column, row] = True
    is_inside = is_on.copy()
    for i, j in ((i, j) for i in (-1, 0, 1) for j in (-1, 0, 1)):
        is_inside[1:-1, 1:-1] &= is_on[1 + i : shape[0] - 1 + i, 1 + j : shape[1] - 1 + j]
    start, stop = np.searchsorted(coordinates[2], (float(points[2].min()) - far_m, float(points[2].max()) + near_m))
    near = coordinates[:, start:stop]
    column, row = ((near[:2] - low[:, None]) / side_m).astype(np.int64)
    is_in = (column > 0) & (column < shape[0] - 1) & (row > 0) & (row < shape[1] - 1)
    near = near[:, is_in][:, is_inside[column[is_in], row[is_in]]]
    off = height_above(near, plane.slope, plane.centre)
    hanging, _ = np.histogram(-off, np.linspace(near_m, far_m, _SIDE_PARTS + 1))
    n_on = int(np.count_nonzero(np.abs(off) <= near_m))
    return bool(_SIDE_PARTS * int(hanging.min()) >= _SIDE_SHARE * max(n_on, 1))


def _on_plane(coordinates: Floats, rows: Ints, most: int) -> tuple[Ints, TopPlane]:
    """Return those of some points that lie on the plane of the bars' tops, and that plane; their sides hang below it.

    What is noise shows above the plane alone: the points below it within the same distance belong to it too.
    """
    # Thousands of points give the plane as well as tens of thousands.
    points = coordinates[:, rows[:: -(-len(rows) // most)]]
    slope, centre, sigma_m = fit_trimmed(points)
    reach_m = 0.0
    for _ in range(_ROUNDS):
        off = height_above(points, slope, centre)
        # Where a quarter of them lie within the least height.
        top = densest(off, max(2, len(off) // 4))
        above = off[off > top] - top
        reach_m = _TRIM_SIGMA * max(MAD_TO_SIGMA * median(above) if len(above) else 0.0, _LEAST_SIGMA_M)
        kept = np.abs(off - top) <= reach_m
        if np.count_nonzero(kept) < FEWEST_IN_PEAK:
            break
        slope, centre, sigma_m = fit_trimmed(points[:, kept])
    is_top: Bools = np.abs(height_above(coordinates[:, rows], slope, centre)) <= reach_m
    return rows[is_top], TopPlane(slope, centre, sigma_m)
