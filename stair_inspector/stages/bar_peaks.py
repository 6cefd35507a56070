"""Where lie many points at one height whose normals do not say so? Peaks in columns of the plan."""

from dataclasses import dataclass

import numpy as np

from stair_inspector.geometry.arrays import Bools, Floats, Ints
from stair_inspector.geometry.clusters import cluster_cells

_COLUMN_M = 0.12
"""Side of the columns of plan in which points are counted by height: a bar of 60 mm and a gap of 60 mm fit into it."""
_BIN_M = 0.005
_LARGEST_TABLE = 30_000_000
FEWEST_IN_PEAK = 8
_PEAK = 1.5
"""So many times as many points as just above and just below are the top of something."""
_CHANCE = 2.0
"""The same in standard deviations of a count: of few points, some lie at one height by chance."""
NOT_LEVEL, _LITTLE_NOT_LEVEL = 0.25, 0.05
"""Share of the points at one height that do not seem level from which they may be bars: on whole treads only the rim's
are none. Where gaps are narrow fewer slant too, and only what is seen of the bars' sides tells."""
_BAND_M = 0.008


@dataclass(frozen=True, slots=True, eq=False)
class _Peaks:
    """Columns of plan that hold a peak: group, column and row (3, p) and height (p,); corner of the columns (2,).

    ``not_level`` (g,) is the share of each group's points that do not seem level.
    """

    places: Ints
    height_m: Floats
    low: Floats
    not_level: Floats


def find_peaks(coordinates: Floats, is_level: Bools) -> _Peaks | None:
    """Return the peaks in which many points do not seem level, grouped where they touch at one height."""
    low = coordinates.min(axis=1)
    low[:2] -= _COLUMN_M
    n_columns, n_rows = (int(size / _COLUMN_M) + 2 for size in (coordinates[:2].max(axis=1) - low[:2]))
    # Room above and below, so that windows of one column do not reach into the next.
    n_bins = int((coordinates[2, -1] - low[2]) / _BIN_M) + 9
    if n_columns * n_rows * n_bins > _LARGEST_TABLE:
        return None
    keys = ((coordinates[0] - low[0]) / _COLUMN_M).astype(np.int64) * n_rows
    keys += ((coordinates[1] - low[1]) / _COLUMN_M).astype(np.int64)
    keys *= n_bins
    keys += ((coordinates[2] - low[2]) / _BIN_M).astype(np.int64) + 4
    size = n_columns * n_rows * n_bins
    slanting = np.bincount(keys[~is_level], minlength=size)
    every = slanting + np.bincount(keys[is_level], minlength=size)
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
        return None
    column, bin_ = np.divmod(first, n_bins)
    places = np.stack([np.zeros(len(first), dtype=np.int64), *np.divmod(column, n_rows)])
    weights = np.stack([every[first], every[first + 1]]).astype(np.float64)
    height = low[2] + _BIN_M * (bin_ - 4 + 0.5 + weights[1] / weights.sum(axis=0))
    not_level = (slanting[first] + slanting[first + 1]).astype(np.float64)
    places, height, shares = _grouped(places, height, not_level, weights.sum(axis=0))
    return _Peaks(places, height, low[:2], shares) if len(height) else None


def _grouped(places: Ints, height_m: Floats, not_level: Floats, counts: Floats) -> tuple[Ints, Floats, Floats]:
    """Return the peaks of groups, columns that touch and hold peaks of about one height, some of whose points slant."""
    order = np.argsort(height_m, kind="stable")
    places, height_m, not_level, counts = places[:, order], height_m[order], not_level[order], counts[order]
    # Heights far enough apart are never one surface's; within a layer a column has one peak.
    layer = np.concatenate([[0], np.cumsum(np.diff(height_m) > 2.0 * _BIN_M)])
    size = places.max(axis=1, initial=0) + 1
    _, kept = np.unique((layer * size[1] + places[1]) * size[2] + places[2], return_index=True)
    keys = np.stack([layer, places[1], places[2]])[:, kept]
    height_m, not_level, counts = height_m[kept], not_level[kept], counts[kept]
    labels = cluster_cells(keys, height_m / (2.0 * _BIN_M), np.ones(len(height_m), dtype=np.int64), 2)
    shares = np.bincount(labels + 1, not_level) / np.maximum(np.bincount(labels + 1, counts), 1.0)
    may_be_barred = shares >= _LITTLE_NOT_LEVEL
    may_be_barred[0] = False
    number = np.cumsum(may_be_barred) - 1
    is_kept = may_be_barred[labels + 1]
    return np.stack([number[labels + 1], keys[1], keys[2]])[:, is_kept], height_m[is_kept], shares[may_be_barred]


def points_at_peaks(coordinates: Floats, peaks: _Peaks) -> list[Ints]:
    """Return for each group the points at its height, in its columns and those around it."""
    found = []
    for group in range(int(peaks.places[0].max(initial=-1)) + 1):
        own = peaks.places[0] == group
        columns, height = peaks.places[1:, own], peaks.height_m[own]
        spread = np.array([(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1)])
        # The nearest column's own peak last, so that its height stands.
        spread = spread[np.argsort(-np.abs(spread).sum(axis=1), kind="stable")]
        first = columns.min(axis=1) - 1
        shape = columns.max(axis=1) - first + 2
        table = np.full((int(shape[0]), int(shape[1])), np.nan)
        for step in spread:
            at = columns - first[:, None] + step[:, None]
            table[at[0], at[1]] = height
        z = coordinates[2]
        start, stop = np.searchsorted(z, (float(height.min()) - _BAND_M, float(height.max()) + _BAND_M))
        near = coordinates[:, start:stop]
        column = ((near[0] - peaks.low[0]) / _COLUMN_M).astype(np.int64) - first[0]
        row = ((near[1] - peaks.low[1]) / _COLUMN_M).astype(np.int64) - first[1]
        is_in = (column >= 0) & (column < table.shape[0]) & (row >= 0) & (row < table.shape[1])
        inside = np.flatnonzero(is_in)
        off = np.abs(near[2, inside] - table[column[inside], row[inside]])
        found.append(start + inside[off <= _BAND_M])
    return found
