"""A tread or the floor in both scans, cell by cell: medians of heights and what they are worth."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stair_inspector.comparison.epochs import Epoch, Tread
from stair_inspector.comparison.motions import RigidMotion
from stair_inspector.geometry.arrays import Bools, Floats, Ints
from stair_inspector.geometry.percentiles import MAD_TO_SIGMA, median
from stair_inspector.geometry.plan import left_of

_CELL_M, _LARGEST_CELL_M = 0.04, 0.12
_USUAL_POINTS, _FEWEST = 12, 6
"""Points that a cell should hold where a scan is sparse, and that it needs of either scan for its median."""
_SLAB_M, _SLAB_SIGMAS = 0.02, 4.0
"""How far off its plane a point of a tread may lie: wear does, what stands on it does not."""
_FRONT_M, _BACK_M, _SIDE_M = 0.005, 0.02, 0.015
"""What is left out along the edges, where a beam sees two surfaces."""
_MEDIAN = math.sqrt(math.pi / 2.0)
"""Standard uncertainty of a median against that of a mean."""


@dataclass(frozen=True, slots=True, eq=False)
class Grid:
    """Square cells in plan: row i begins at ``origin + i * cell_m * ahead``, columns go to the left of ``ahead``."""

    cell_m: float
    origin: Floats
    ahead: Floats
    n_rows: int
    n_columns: int

    def cell_of(self, plan: Floats) -> Ints:
        """Return the number of the cell in which each place (2, n) lies, -1 outside."""
        x, y = plan[0] - self.origin[0], plan[1] - self.origin[1]
        i = np.floor((self.ahead[0] * x + self.ahead[1] * y) / self.cell_m).astype(np.int64)
        j = np.floor((self.ahead[0] * y - self.ahead[1] * x) / self.cell_m).astype(np.int64)
        is_in = (i >= 0) & (i < self.n_rows) & (j >= 0) & (j < self.n_columns)
        numbers: Ints = np.where(is_in, i * self.n_columns + j, -1)
        return numbers

    def middles(self) -> Floats:
        """Return the middles (2, cells) in plan."""
        i, j = np.divmod(np.arange(self.n_rows * self.n_columns), self.n_columns)
        left = left_of(self.ahead)
        middles: Floats = self.origin[:, None] + self.cell_m * (
            (i + 0.5) * self.ahead[:, None] + (j + 0.5) * left[:, None]
        )
        return middles


@dataclass(frozen=True, slots=True, eq=False)
class CellHeights:
    """Of each cell of a grid: ``median_m`` (cells,) above the reference plane, NaN with too few points, and its noise.

    ``noise_m`` (cells,) is the standard uncertainty of the median by the scatter of the points about it.
    """

    median_m: Floats
    noise_m: Floats


@dataclass(frozen=True, slots=True, eq=False)
class SurfaceChange:
    """A surface in both scans: ``deviation_m`` (cells,) upwards and its standard ``noise_m``, NaN where not in both.

    ``is_surface`` (cells,) marks the cells that belong to it; ``reference`` is the earlier plane.
    """

    grid: Grid
    reference: Floats
    deviation_m: Floats
    noise_m: Floats
    is_surface: Bools


def tread_change(before: Epoch, tread: Tread, after: Epoch, other: Tread, motion: RigidMotion) -> SurfaceChange:
    """Return how a tread lies in the later scan against the earlier one, under a motion between them."""
    moved = motion.moved_tread(other)
    grid = _grid_over(tread, _cell_of((tread, other)))
    ours = _points_on(before, tread, tread, None)
    theirs = _points_on(after, other, tread, motion)
    # Each on its own plane, so that a thing on the tread stays off and a tread that tilted stays on.
    ours = ours[:, np.abs(ours[2] - tread.height_at(ours[0], ours[1])) <= _slab_of(tread)]
    theirs = theirs[:, np.abs(theirs[2] - moved.height_at(theirs[0], theirs[1])) <= _slab_of(other)]
    is_tread = _is_inside(grid.middles(), tread.corners, (_FRONT_M, _SIDE_M, _BACK_M, _SIDE_M))
    return _change(grid, tread.plane, ours, theirs, is_tread)


def floor_change(before: Epoch, after: Epoch, motion: RigidMotion, reach_m: float = 2.5) -> SurfaceChange:
    """Return how the floor in front of the first step lies in the later scan against the earlier one."""
    foot = before.treads[0]
    middle = foot.corners[:2].mean(axis=0)
    cell_m = _cell_of((foot, after.treads[0]))
    n = round(2.0 * reach_m / cell_m)
    corner = middle - reach_m * (foot.climb + left_of(foot.climb))
    grid = Grid(cell_m, corner, foot.climb, n, n)
    theirs = motion.moved(after.floor)
    level = np.array([median(before.floor[2]), 0.0, 0.0])
    return _change(grid, level, before.floor, theirs, np.ones(n * n, dtype=bool))


def _change(grid: Grid, plane: Floats, ours: Floats, theirs: Floats, is_surface: Bools) -> SurfaceChange:
    one, two = (_heights(grid, plane, points) for points in (ours, theirs))
    # Along the normal of the earlier plane.
    cos = 1.0 / math.sqrt(1.0 + float(plane[1]) ** 2 + float(plane[2]) ** 2)
    deviation = cos * (two.median_m - one.median_m)
    deviation[~is_surface] = math.nan
    return SurfaceChange(grid, plane, deviation, cos * np.hypot(one.noise_m, two.noise_m), is_surface)


def _heights(grid: Grid, plane: Floats, points: Floats) -> CellHeights:
    """Return the medians of the cells: of the heights above a plane."""
    cells = grid.cell_of(points[:2])
    is_in = cells >= 0
    cells = cells[is_in]
    above = points[2, is_in] - (plane[0] + plane[1] * points[0, is_in] + plane[2] * points[1, is_in])
    n_cells = grid.n_rows * grid.n_columns
    order = np.lexsort((above, cells))
    cells, above = cells[order], above[order]
    counts = np.bincount(cells, minlength=n_cells)
    starts = np.concatenate([[0], np.cumsum(counts)[:-1]])
    is_enough = counts >= _FEWEST
    medians = np.full(n_cells, math.nan)
    low, high = starts + (counts - 1) // 2, starts + counts // 2
    medians[is_enough] = (above[low[is_enough]] + above[high[is_enough]]) / 2.0
    # The scatter of one cell is known badly: that of all of them is taken, and never less than it.
    left = np.abs(above - medians[cells])
    left = left[np.isfinite(left)]
    sigma = MAD_TO_SIGMA * median(left)
    noise = np.full(n_cells, math.nan)
    noise[is_enough] = _MEDIAN * sigma / np.sqrt(counts[is_enough])
    return CellHeights(medians, noise)


def _points_on(epoch: Epoch, own: Tread, outline: Tread, motion: RigidMotion | None) -> Floats:
    """Return the points near a scan's own tread that lie, once moved, within the outline of another."""
    heights = own.height_at(own.corners[:, 0], own.corners[:, 1])
    slab = _slab_of(own)
    points = epoch.between(float(heights.min()) - slab, float(heights.max()) + slab)
    if motion is not None:
        points = motion.moved(points)
    low, high = outline.corners.min(axis=0), outline.corners.max(axis=0)
    is_near = (points[0] >= low[0]) & (points[0] <= high[0]) & (points[1] >= low[1]) & (points[1] <= high[1])
    points = points[:, is_near]
    return points[:, _is_inside(points[:2], outline.corners, (_FRONT_M, _SIDE_M, _BACK_M, _SIDE_M))]


def _slab_of(tread: Tread) -> float:
    return max(_SLAB_M, _SLAB_SIGMAS * tread.rms_m)


def _cell_of(treads: Sequence[Tread]) -> float:
    """Return the side of the cells: a few centimetres, more where the sparser scan has too few points in them."""
    spacing_m = max(tread.spacing_m for tread in treads)
    return min(_LARGEST_CELL_M, max(_CELL_M, math.sqrt(_USUAL_POINTS) * spacing_m))


def _grid_over(tread: Tread, cell_m: float) -> Grid:
    """Return a grid that covers a tread, its first row at the nosing."""
    left = left_of(tread.climb)
    s, w = tread.corners @ tread.climb, tread.corners @ left
    origin = (float(s.min()) + _FRONT_M) * tread.climb + float(w.min()) * left
    n_rows = max(1, math.ceil((float(np.ptp(s)) - _FRONT_M) / cell_m))
    return Grid(cell_m, origin, tread.climb, n_rows, max(1, math.ceil(float(np.ptp(w)) / cell_m)))


def _is_inside(plan: Floats, corners: Floats, margins_m: tuple[float, float, float, float]) -> Bools:
    """Tell which places (2, n) lie inside a convex outline, that far from its front, right, back and left edge."""
    middle = corners.mean(axis=0)
    is_in = np.ones(plan.shape[1], dtype=bool)
    for k, margin in enumerate(margins_m):
        start, along = corners[k], corners[(k + 1) % 4] - corners[k]
        inwards = left_of(along) / max(float(np.hypot(*along)), 1e-9)
        if (middle - start) @ inwards < 0.0:
            inwards = -inwards
        is_in &= inwards[0] * (plan[0] - start[0]) + inwards[1] * (plan[1] - start[1]) >= margin
    return is_in
