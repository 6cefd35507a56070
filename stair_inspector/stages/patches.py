"""Which points of one height form one surface? Height clusters split into patches that hang together in plan."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stair_inspector.errors import CannotMeasure
from stair_inspector.geometry.arrays import Floats, Ints, freeze, own
from stair_inspector.geometry.clusters import cluster_cells, cluster_sorted, find_reach
from stair_inspector.geometry.fits import PlaneFit, fit_plane_rows
from stair_inspector.model import Horizontal, Levels, Patches, Surface
from stair_inspector.params import LevelsParams, PatchesParams

MAX_PATCHES = 3000
"""More surfaces than a building has: the settings cut it into crumbs."""
_LARGEST_CELL_M = 0.15
_LARGEST_TABLE = 20_000_000
_POINTS_PER_CELL = 4.0
"""A cell that holds fewer points leaves holes in a surface by chance."""
_THICK_M = 0.05
"""A patch that spans more than this in height may be two surfaces that an object between them has joined."""
_ROUNDS = 4
_SPARSE_SHARE = 0.1
"""Cells whose surroundings hold less than this share of the usual number are stray points between surfaces."""
_NEIGHBOURHOOD = 9
_LEAST_STEP_M, _STEP_EPS = 0.02, 1.25
_TRIM_SIGMA = 3.0
_TRIM_ROUNDS = 3
_LEAST_SIGMA_M = 1e-6
_CORE_SHARE = 0.6
_CORE_QUANTILE = 0.8416
"""Share of the points that must lie on a surface, and the normal quantile below which so many residuals are."""
_CORE_ROUNDS = 10
_BUMP_M, _BUMP_SIGMA = 0.015, 5.0
"""What lies farther off the plane of a surface than both is something else."""
_CRUMB_SHARE = 0.35
_CRUMB_GAP_M = 0.3
_CRUMB_STEP_M = 0.004


def split_levels(horizontal: Horizontal, levels: Levels, params: PatchesParams, heights: LevelsParams) -> Patches:
    """Split the height clusters into patches that hang together both in plan and in height.

    Parameters
    ----------
    horizontal, levels
        Of one scan.
    params : PatchesParams
        Plan cell.
    heights : LevelsParams
        eps_z and m, with which a patch that is too thick is clustered by height again: where a chair joins two treads
        in height, they fall apart once the chair is a patch of its own.

    Returns
    -------
    Patches
        By height cluster, then by height. DBSCAN on plan cells weighted by their points, its reach the eight
        neighbours of a cell.

    Raises
    ------
    CannotMeasure
        More than 3000 patches.
    """
    coordinates = horizontal.coordinates_m
    groups = [np.arange(start, stop) for start, stop in zip(levels.start, levels.stop, strict=True)]
    grid = _lay_grid(coordinates[:2], levels, params.cell_m, horizontal.plan_corner_m)
    planes: list[_CellPlane] = []
    for _ in range(_ROUNDS):
        parts = _split_in_plan(grid, coordinates, groups, heights.eps_m)
        parts, is_settled = _split_in_height(grid, coordinates, parts, heights)
        groups, planes, is_plane = _split_off_bumps(parts, heights.min_points)
        if is_settled and is_plane:
            break
    surfaces = [_describe(horizontal, plane, _level_of(levels, plane.part.rows), grid.cell_m) for plane in planes]
    if len(surfaces) > MAX_PATCHES:
        raise CannotMeasure(
            f"patches: {len(surfaces):,} separate surfaces, more than {MAX_PATCHES} are no building; raise "
            "levels.min_points (m) or patches.cell_m"
        )
    joined = [
        surfaces[number]
        if len(pieces) == 1
        else _describe(
            horizontal,
            _fit_part(_part_of(grid, coordinates, np.sort(np.concatenate(pieces)))),
            surfaces[number].level_id,
            grid.cell_m,
        )
        for number, pieces in _with_crumbs(surfaces)
    ]
    ordered = sorted(joined, key=lambda surface: (surface.level_id, surface.height_m))
    return Patches(tuple(ordered), grid.cell_m)


@dataclass(frozen=True, slots=True, eq=False)
class _Grid:
    """The plan cells that points occupy: the cell of each point (n,), and column and row of each cell (2, c), in order.

    Of points outside the height clusters the cell means nothing.
    """

    cell_of: Ints
    places: Ints
    cell_m: float


@dataclass(frozen=True, slots=True, eq=False)
class _Part:
    """Points that belong together: ascending ``rows`` (r,), and how they fill their plan cells.

    ``cells`` (c,) are the cells of the grid that hold points of the part, ``counts`` (c,) how many each, ``means``
    (3, c) the means of those; ``place_of`` (r,) tells for each row which of ``cells`` it lies in.
    """

    rows: Ints
    place_of: Ints
    cells: Ints
    counts: Ints
    means: Floats


@dataclass(frozen=True, slots=True, eq=False)
class _CellPlane:
    """A part and the plane through its cells."""

    part: _Part
    slope: Floats
    centre: Floats
    sigma_m: float


def _level_of(levels: Levels, rows: Ints) -> int:
    return int(np.searchsorted(levels.start, rows[0], side="right")) - 1


def _lay_grid(plan: Floats, levels: Levels, cell_m: float, corner: Floats | None = None) -> _Grid:
    """Lay plan cells over the points of all height clusters: larger ones than wanted where the scan is too coarse."""
    cell_of = np.zeros(plan.shape[1], dtype=np.int64)
    spans = [slice(start, stop) for start, stop in zip(levels.start, levels.stop, strict=True)]
    if not spans:
        return _Grid(cell_of, np.zeros((2, 0), dtype=np.int64), cell_m)
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
        if n_points >= _POINTS_PER_CELL * len(keys) or cell_m >= _LARGEST_CELL_M:
            return _Grid(cell_of, np.stack(np.divmod(keys, n_rows)), cell_m)
        cell_m = min(1.25 * cell_m, _LARGEST_CELL_M)


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


def _part_of(grid: _Grid, coordinates: Floats, rows: Ints) -> _Part:
    """Return how some points fill their cells."""
    cell_of = grid.cell_of.take(rows)
    first = int(cell_of.min())
    table = np.bincount(cell_of - first)
    cells = np.flatnonzero(table)
    counts = table[cells]
    place_of = (np.cumsum(table > 0) - 1).take(cell_of - first)
    means = np.stack([np.bincount(place_of, axis.take(rows)) / counts for axis in coordinates])
    return _Part(rows, place_of, cells + first, counts, means)


def _split_in_plan(grid: _Grid, coordinates: Floats, groups: Sequence[Ints], eps_m: float) -> list[_Part]:
    """Return the parts of each group that hang together in plan; stray points are in none.

    Neighbouring cells whose mean heights differ by much more than eps_z do not hang together: what joins a floor and a
    tread are a few smeared points between them.
    """
    wholes = [_part_of(grid, coordinates, rows) for rows in groups]
    if not wholes:
        return []
    sizes = [len(whole.cells) for whole in wholes]
    # Each group is a layer of cells of its own.
    layer = np.repeat(np.arange(len(wholes)), sizes)
    places = grid.places[:, np.concatenate([whole.cells for whole in wholes])]
    counts = np.concatenate([whole.counts for whole in wholes])
    mean_m = np.concatenate([whole.means[2] for whole in wholes])
    step_m = max(_LEAST_STEP_M, _STEP_EPS * eps_m)
    wanted = int(max(3.0, _SPARSE_SHARE * _NEIGHBOURHOOD * float(np.median(counts))))
    labels = cluster_cells(np.stack([layer, *places]), mean_m / step_m, counts, wanted)
    by_group = np.split(labels, np.cumsum(sizes[:-1]))
    return [part for whole, own_labels in zip(wholes, by_group, strict=True) for part in _by_label(whole, own_labels)]


def _by_label(whole: _Part, labels: Ints) -> list[_Part]:
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
        _Part(
            rows[start:stop], place_of[start:stop] - first, cells[first:last], counts[first:last], means[:, first:last]
        )
        for (start, stop), (first, last) in zip(itertools.pairwise(ends), itertools.pairwise(cell_ends), strict=True)
    ]


def _split_in_height(
    grid: _Grid, coordinates: Floats, parts: Sequence[_Part], params: LevelsParams
) -> tuple[list[_Part], bool]:
    """Return new parts: thick ones clustered by height again, small ones dropped; and whether nothing was split."""
    result = []
    is_settled = True
    for part in parts:
        rows = part.rows
        if len(rows) < params.min_points:
            continue
        # Rows are in order of height.
        if coordinates[2, rows[-1]] - coordinates[2, rows[0]] <= _THICK_M:
            result.append(part)
            continue
        clusters = cluster_sorted(find_reach(coordinates[2].take(rows), params.eps_m), params.min_points)
        is_settled &= len(clusters.start) == 1
        result += [
            _part_of(grid, coordinates, rows[start:stop])
            for start, stop in zip(clusters.start, clusters.stop, strict=True)
        ]
    return result, is_settled


def _split_off_bumps(parts: Sequence[_Part], least: int) -> tuple[list[Ints], list[_CellPlane], bool]:
    """Return the rows of new groups: cells that lie well off their part's plane become a group of their own.

    A box on a tread may be so near to the next tread in height that both are one height cluster. Returns the planes of
    the parts as they were, and whether none was split.
    """
    planes = [_fit_part(part) for part in parts]
    remaining, bumps = [], []
    for plane in planes:
        part = plane.part
        limit = max(_BUMP_M, _BUMP_SIGMA * plane.sigma_m)
        is_off = np.abs(_residual(part.means, plane.slope, plane.centre)) > limit
        if least <= int(part.counts[is_off].sum()) < len(part.rows) / 2:
            is_bump = is_off.take(part.place_of)
            bumps.append(part.rows[is_bump])
            remaining.append(part.rows[~is_bump])
        else:
            remaining.append(part.rows)
    return remaining + bumps, planes, not bumps


def _fit_part(part: _Part) -> _CellPlane:
    """Fit a plane to the means of a part's cells, so that every piece of the surface counts the same."""
    # Cells that are barely touched lie on an edge, where stray points weigh most.
    is_full = part.counts >= 0.3 * np.median(part.counts)
    return _CellPlane(part, *fit_trimmed(part.means[:, is_full]))


def _with_crumbs(surfaces: list[Surface]) -> list[tuple[int, list[Ints]]]:
    """Return every large surface with the rows of the crumbs that go with it: small, near and in the same plane.

    Where a scanner sees a landing only between the legs of its tripod, or a tread behind an obstacle, one surface falls
    into pieces. Two large pieces may be two staircases side by side and stay apart.
    """
    by_level: dict[int, list[int]] = {}
    for number in sorted(range(len(surfaces)), key=lambda k: -surfaces[k].area_m2):
        by_level.setdefault(surfaces[number].level_id, []).append(number)
    result = []
    for numbers in by_level.values():
        kept: list[tuple[int, list[Ints]]] = []
        for number in numbers:
            home = next((parts for large, parts in kept if _goes_with(surfaces[number], surfaces[large])), None)
            if home is None:
                kept.append((number, [surfaces[number].rows]))
            else:
                home.append(surfaces[number].rows)
        result += kept
    return result


def _goes_with(crumb: Surface, large: Surface) -> bool:
    """Return whether a crumb lies in the plane of a large surface and near it."""
    if crumb.area_m2 > _CRUMB_SHARE * large.area_m2:
        return False
    expected_m = float(large.centre_m[2] + large.slope @ (crumb.centre_m[:2] - large.centre_m[:2]))
    if abs(crumb.height_m - expected_m) > _CRUMB_STEP_M + 2.0 * large.sigma_m:
        return False
    low, high = large.cells_m.min(axis=1) - _CRUMB_GAP_M, large.cells_m.max(axis=1) + _CRUMB_GAP_M
    near = (crumb.cells_m > low[:, None]) & (crumb.cells_m < high[:, None])
    if not near.all(axis=0).any():
        return False
    gaps = large.cells_m[:, :, None] - crumb.cells_m[:, None, :: max(1, crumb.cells_m.shape[1] // 20)]
    return bool(np.hypot(gaps[0], gaps[1]).min() <= _CRUMB_GAP_M)


def _describe(horizontal: Horizontal, plane: _CellPlane, level_id: int, cell_m: float) -> Surface:
    part = plane.part
    return Surface(
        level_id=level_id,
        rows=freeze(part.rows),
        cells_m=freeze(part.means[:2].copy()),
        area_m2=len(part.cells) * cell_m * cell_m,
        height_m=float(plane.centre[2]),
        centre_m=freeze(plane.centre),
        slope=freeze(plane.slope),
        sigma_m=plane.sigma_m,
        plane=plane_of_rows(horizontal, part.rows),
    )


def plane_of_rows(horizontal: Horizontal, rows: Ints) -> PlaneFit:
    """Return the SVD plane of some rows in local scan axes (step 8 of the paper, for a patch)."""
    fit, _ = fit_plane_rows(horizontal.coordinates_m.take(rows, axis=1), np.array([0.0, 0.0, 1.0]))
    turn = horizontal.level_from_scan.T
    return PlaneFit(
        own(turn @ fit.centroid, (3,), "centroid"),
        None if fit.normal is None else own(turn @ fit.normal, (3,), "normal"),
        fit.rms_m,
        fit.n_points,
    )


def fit_trimmed(points: Floats) -> tuple[Floats, Floats, float]:
    """Fit height as a linear function of plan to points (3, n) of which up to two in five may be something else.

    Returns
    -------
    slope : (2,)
        dz/dx and dz/dy; zero where the points do not span a plane.
    centre : (3,)
        Mean of the points kept, metres.
    sigma_m : float
        Robust scatter about the plane.

    References
    ----------
    .. [1] Rousseeuw, Van Driessen: Computing LTS regression for large data sets, 2006: the C-step. One start suffices
       here, the level plane at the height where the points are densest.
    """
    n = points.shape[1]
    n_core = min(n, max(3, int(_CORE_SHARE * n)))
    slope, centre = np.zeros(2), np.array([*points[:2].mean(axis=1), _densest(points[2], n_core)])
    chosen = np.arange(n)
    for _ in range(_CORE_ROUNDS):
        residual = np.abs(_residual(points, slope, centre))
        before, chosen = chosen, np.argpartition(residual, n_core - 1)[:n_core] if n_core < n else chosen
        slope, centre = _fit_height(points[:, chosen])
        if len(before) == len(chosen) and np.array_equal(np.sort(before), np.sort(chosen)):
            break
    sigma_m = 0.0
    for _ in range(_TRIM_ROUNDS):
        residual = np.abs(_residual(points, slope, centre))
        # The core holds the smallest residuals: its largest is the quantile of the core's share.
        sigma_m = float(np.partition(residual, n_core - 1)[n_core - 1]) / _CORE_QUANTILE
        kept = residual <= _TRIM_SIGMA * max(sigma_m, _LEAST_SIGMA_M)
        if np.count_nonzero(kept) < 3:
            break
        slope, centre = _fit_height(points[:, kept])
    return slope, centre, sigma_m


def _residual(points: Floats, slope: Floats, centre: Floats) -> Floats:
    residual: Floats = points[2] - centre[2] - slope[0] * (points[0] - centre[0]) - slope[1] * (points[1] - centre[1])
    return residual


def _densest(values: Floats, wanted: int) -> float:
    """Return the middle of the shortest interval that holds the wanted number of values."""
    ordered = np.sort(values)
    if wanted >= len(ordered):
        return float(np.median(ordered))
    spans = ordered[wanted - 1 :] - ordered[: len(ordered) - wanted + 1]
    start = int(np.argmin(spans))
    return float(np.median(ordered[start : start + wanted]))


def _fit_height(points: Floats) -> tuple[Floats, Floats]:
    """Fit height by least squares; the slope is zero where the points do not span a plane."""
    centre = points.mean(axis=1)
    shift = points - centre[:, None]
    scatter = np.einsum("in,jn->ij", shift[:2], shift)
    if np.linalg.det(scatter[:, :2]) <= 1e-9 * np.trace(scatter[:, :2]) ** 2:
        return np.zeros(2), centre
    slope: Floats = np.linalg.solve(scatter[:, :2], scatter[:, 2])
    return slope, centre
