"""How do points fill the cells of a plan? Parts of one height that hang together there."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stair_inspector.geometry.arrays import Floats, Ints
from stair_inspector.geometry.clusters import cluster_cells
from stair_inspector.geometry.percentiles import median
from stair_inspector.model import Levels

LARGEST_CELL_M = 0.15
_LARGEST_TABLE = 20_000_000
_POINTS_PER_CELL = 4.0
"""A cell that holds fewer points leaves holes in a surface by chance."""
_SPARSE_SHARE = 0.1
"""Cells whose surroundings hold less than this share of the usual number are stray points between surfaces."""
_NEIGHBOURHOOD = 9
_LEAST_STEP_M, _STEP_EPS = 0.02, 1.25


@dataclass(frozen=True, slots=True, eq=False)
class PlanGrid:
    """The plan cells that points occupy: the cell of each point (n,), and column and row of each cell (2, c), in order.

    Of points outside the height clusters the cell means nothing.
    """

    cell_of: Ints
    places: Ints
    cell_m: float


@dataclass(frozen=True, slots=True, eq=False)
class PlanPart:
    """Points that belong together: ascending ``rows`` (r,), and how they fill their plan cells.

    ``cells`` (c,) are the cells of the grid that hold points of the part, ``counts`` (c,) how many each, ``means``
    (3, c) the means of those; ``place_of`` (r,) tells for each row which of ``cells`` it lies in.
    """

    rows: Ints
    place_of: Ints
    cells: Ints
    counts: Ints
    means: Floats


def lay_plan_grid(
    plan: Floats, levels: Levels, cell_m: float, corner: Floats | None = None, most_m: float = LARGEST_CELL_M
) -> PlanGrid:
    """Lay plan cells over the points of all height clusters: where the scan is coarse larger ones, up to ``most_m``."""
    cell_of = np.zeros(plan.shape[1], dtype=np.int64)
    spans = [slice(start, stop) for start, stop in zip(levels.start, levels.stop, strict=True)]
    if not spans:
        return PlanGrid(cell_of, np.zeros((2, 0), dtype=np.int64), cell_m)
    n_points = int((levels.stop - levels.start).sum())
    first, high = plan.min(axis=1), plan.max(axis=1)
    corner = first if corner is None else corner
    while True:
        # Whole cells from the corner of all that was scanned: what is left out must not move the cells of a surface.
        low = corner + np.floor((first - corner) / cell_m) * cell_m
        n_columns, n_rows = (int(last) + 1 for last in (high - low) / cell_m)
        # Cluster by cluster: what fits into the processor's cache is worked on several times as fast.
        for span in spans:
            # All are positive: cutting off the decimals rounds down.
            column, row = ((plan[:, span] - low[:, None]) / cell_m).astype(np.int64)
            cell_of[span] = column * n_rows + row
        keys = _renumber(cell_of, spans, n_columns * n_rows)
        if n_points >= _POINTS_PER_CELL * len(keys) or cell_m >= most_m:
            return PlanGrid(cell_of, np.stack(np.divmod(keys, n_rows)), cell_m)
        cell_m = min(1.25 * cell_m, most_m)


def _renumber(keys: Ints, spans: Sequence[slice], n_keys: int) -> Ints:
    """Return the different keys in some spans, ascending, and replace each by its place among them."""
    if n_keys > _LARGEST_TABLE:
        found: Ints = np.unique(np.concatenate([keys[span] for span in spans]))
        for span in spans:
            keys[span] = np.searchsorted(found, keys[span])
        return found
    # Few keys beside the number of points: a table is faster than sorting or hashing.
    is_there = np.zeros(n_keys, dtype=np.bool_)
    for span in spans:
        is_there[keys[span]] = True
    found = np.flatnonzero(is_there)
    place_of = np.zeros(n_keys, dtype=np.int64)
    place_of[found] = np.arange(len(found))
    for span in spans:
        keys[span] = place_of.take(keys[span])
    return found


def part_of_rows(grid: PlanGrid, coordinates: Floats, rows: Ints) -> PlanPart:
    """Return how some points fill their cells."""
    return part_of_cells(rows, grid.cell_of.take(rows), [axis.take(rows) for axis in coordinates])


def part_of_cells(rows: Ints, cell_of: Ints, coordinates: Sequence[Floats]) -> PlanPart:
    """Return how points of some ``rows`` (r,), three ``coordinates`` (r,), fill the cells that they lie in, (r,)."""
    first = int(cell_of.min())
    table = np.bincount(cell_of - first)
    cells = np.flatnonzero(table)
    counts = table[cells]
    place_of = (np.cumsum(table > 0) - 1).take(cell_of - first)
    means = np.stack([np.bincount(place_of, axis) / counts for axis in coordinates])
    return PlanPart(rows, place_of, cells + first, counts, means)


def split_in_plan(grid: PlanGrid, coordinates: Floats, groups: Sequence[Ints], eps_m: float) -> list[PlanPart]:
    """Return the parts of each group that hang together in plan; stray points are in none.

    Neighbouring cells whose mean heights differ by much more than eps_z do not hang together: what joins a floor and a
    tread are a few smeared points between them.
    """
    wholes = [part_of_rows(grid, coordinates, rows) for rows in groups]
    if not wholes:
        return []
    sizes = [len(whole.cells) for whole in wholes]
    # Each group is a layer of cells of its own.
    layer = np.repeat(np.arange(len(wholes)), sizes)
    places = grid.places[:, np.concatenate([whole.cells for whole in wholes])]
    counts = np.concatenate([whole.counts for whole in wholes])
    mean_m = np.concatenate([whole.means[2] for whole in wholes])
    step_m = max(_LEAST_STEP_M, _STEP_EPS * eps_m)
    wanted = int(max(3.0, _SPARSE_SHARE * _NEIGHBOURHOOD * median(counts)))
    labels = cluster_cells(np.stack([layer, *places]), mean_m / step_m, counts, wanted)
    by_group = np.split(labels, np.cumsum(sizes[:-1]))
    return [part for whole, own_labels in zip(wholes, by_group, strict=True) for part in _by_label(whole, own_labels)]


def _by_label(whole: PlanPart, labels: Ints) -> list[PlanPart]:
    """Cut a part by labels of its cells, whole numbers without a gap; cells labelled -1 are left out."""
    is_labelled = labels >= 0
    if not is_labelled.any():
        return []
    labels = np.where(is_labelled, labels - labels[is_labelled].min(), -1)
    n_labels = int(labels.max()) + 1
    if n_labels == 1 and is_labelled.all():
        return [whole]
    # A stable sort of short whole numbers is linear.
    short = labels.astype(np.int16) if n_labels < np.iinfo(np.int16).max else labels
    order, cell_order = (np.argsort(each, kind="stable") for each in (short.take(whole.place_of), short))
    moved_to = np.argsort(cell_order)
    place_of = moved_to.take(whole.place_of).take(order)
    rows, cells = whole.rows.take(order), whole.cells[cell_order]
    counts, means = whole.counts[cell_order], whole.means[:, cell_order]
    ends = np.cumsum(np.bincount(labels + 1, whole.counts)).astype(np.int64)
    cell_ends = np.cumsum(np.bincount(labels + 1))
    return [
        PlanPart(
            rows[start:stop], place_of[start:stop] - first, cells[first:last], counts[first:last], means[:, first:last]
        )
        for (start, stop), (first, last) in zip(itertools.pairwise(ends), itertools.pairwise(cell_ends), strict=True)
    ]
