"""Which points of one height form one surface? Height clusters split into patches that hang together in plan."""

from dataclasses import dataclass

import numpy as np

from stair_inspector.errors import CannotMeasure
from stair_inspector.geometry.arrays import Bools, Floats, Ints, freeze, own
from stair_inspector.geometry.clusters import cluster_sorted, find_reach
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
    n = horizontal.coordinates_m.shape[1]
    level_of = np.full(n, -1, dtype=np.int64)
    for level_id, (start, stop) in enumerate(zip(levels.start, levels.stop, strict=True)):
        level_of[start:stop] = level_id
    cells, cell_m = _plan_cells(horizontal.coordinates_m[:2], level_of >= 0, params.cell_m)
    groups = level_of
    planes: list[_CellPlane] = []
    for _ in range(_ROUNDS):
        groups = _split_in_plan(cells, horizontal.coordinates_m[2], groups, heights.eps_m)
        groups, is_settled = _split_in_height(horizontal.coordinates_m[2], groups, heights)
        groups, planes, is_plane = _split_off_bumps(horizontal.coordinates_m, cells, groups, heights.min_points)
        if is_settled and is_plane:
            break
    surfaces = [_describe(horizontal, plane, int(level_of[plane.rows[0]]), cell_m) for plane in planes]
    if len(surfaces) > MAX_PATCHES:
        raise CannotMeasure(
            f"patches: {len(surfaces):,} separate surfaces, more than {MAX_PATCHES} are no building; raise "
            "levels.min_points (m) or patches.cell_m"
        )
    joined = [
        surfaces[number]
        if len(parts) == 1
        else _describe(
            horizontal,
            _fit_cells(horizontal.coordinates_m, cells, np.sort(np.concatenate(parts))),
            surfaces[number].level_id,
            cell_m,
        )
        for number, parts in _with_crumbs(surfaces)
    ]
    ordered = sorted(joined, key=lambda surface: (surface.level_id, surface.height_m))
    return Patches(tuple(ordered), cell_m)


@dataclass(frozen=True, slots=True, eq=False)
class _CellPlane:
    """The points ``rows`` of a group, the means (3, c) of its cells, and the plane through them.

    ``cell_of`` (r,) is the cell of each row.
    """

    rows: Ints
    means: Floats
    cell_of: Ints
    slope: Floats
    centre: Floats
    sigma_m: float


def _plan_cells(plan: Floats, is_used: Bools, cell_m: float) -> tuple[Ints, float]:
    """Return the plan cell (2, n) of every point, and its size: larger than wanted where the scan is too coarse."""
    if not is_used.any():
        return np.zeros(plan.shape, dtype=np.int64), cell_m
    n_used = int(np.count_nonzero(is_used))
    low = plan.min(axis=1)[:, None]
    while True:
        # All are positive: cutting off the decimals rounds down.
        cells = ((plan - low) / cell_m).astype(np.int64)
        keys = cells[0] * (int(cells[1].max()) + 1) + cells[1]
        n_occupied = len(_occupied(keys if n_used == len(keys) else keys[is_used])[0])
        if n_used >= _POINTS_PER_CELL * n_occupied or cell_m >= _LARGEST_CELL_M:
            return cells, cell_m
        cell_m = min(1.25 * cell_m, _LARGEST_CELL_M)


def _occupied(keys: Ints) -> tuple[Ints, Ints, Ints]:
    """Return the different keys, the place of every key among them, and how often each occurs: as numpy's unique."""
    low, high = int(keys.min()), int(keys.max())
    if high - low > _LARGEST_TABLE:
        found, place, counts = np.unique(keys, return_inverse=True, return_counts=True)
        return found, place, counts
    # Few keys beside the number of points: counting is faster than sorting or hashing.
    table = np.bincount(keys - low)
    found = np.flatnonzero(table)
    place = np.cumsum(table > 0) - 1
    return found + low, place[keys - low], table[found]


def _split_in_plan(cells: Ints, heights: Floats, groups: Ints, eps_m: float) -> Ints:
    """Return new groups: the parts of each group that hang together in plan; -1 for stray points.

    Neighbouring cells whose mean heights differ by much more than eps_z do not hang together: what joins a floor and a
    tread are a few smeared points between them.
    """
    from sklearn.cluster import DBSCAN

    rows = np.flatnonzero(groups >= 0)
    result = np.full(len(groups), -1, dtype=np.int64)
    if not rows.size:
        return result
    # Groups lie side by side, too far apart to touch, so that one run serves all of them.
    width = int(cells[0].max()) + 4
    height = int(cells[1].max()) + 4
    keys = (groups[rows] * width + cells[0, rows]) * height + cells[1, rows]
    occupied, cell_of, counts = _occupied(keys)
    mean_m = np.bincount(cell_of, heights[rows]) / counts
    step_m = max(_LEAST_STEP_M, _STEP_EPS * eps_m)
    places = np.stack([occupied // height, occupied % height, mean_m / step_m], axis=1).astype(np.float64)
    wanted = int(max(3.0, _SPARSE_SHARE * _NEIGHBOURHOOD * float(np.median(counts))))
    # Within one in every coordinate: the eight neighbours of a cell.
    found = DBSCAN(eps=1.0, min_samples=wanted, metric="chebyshev").fit(places, sample_weight=counts)
    result[rows] = found.labels_[cell_of]
    return result


def _split_in_height(heights: Floats, groups: Ints, params: LevelsParams) -> tuple[Ints, bool]:
    """Return new groups: thick ones clustered by height again, small ones dropped; and whether nothing was split."""
    result = np.full(len(groups), -1, dtype=np.int64)
    n_groups = 0
    is_settled = True
    for rows in _members(groups):
        if len(rows) < params.min_points:
            continue
        # Rows are in order of height.
        if heights[rows[-1]] - heights[rows[0]] <= _THICK_M:
            result[rows] = n_groups
            n_groups += 1
            continue
        clusters = cluster_sorted(find_reach(heights[rows], params.eps_m), params.min_points)
        is_settled &= len(clusters.start) == 1
        for start, stop in zip(clusters.start, clusters.stop, strict=True):
            result[rows[start:stop]] = n_groups
            n_groups += 1
    return result, is_settled


def _split_off_bumps(coordinates: Floats, cells: Ints, groups: Ints, least: int) -> tuple[Ints, list[_CellPlane], bool]:
    """Return new groups: cells that lie well off their group's plane become a group of their own.

    A box on a tread may be so near to the next tread in height that both are one height cluster. Returns the planes of
    the groups as they were, and whether none was split.
    """
    result = groups.copy()
    n_groups = int(groups.max(initial=-1)) + 1
    planes = []
    is_plane = True
    for rows in _members(groups):
        plane = _fit_cells(coordinates, cells, rows)
        planes.append(plane)
        off = np.abs(_residual(plane.means, plane.slope, plane.centre)) > max(_BUMP_M, _BUMP_SIGMA * plane.sigma_m)
        bumps = rows[off[plane.cell_of]] if off.any() else rows[:0]
        if len(bumps) >= least and len(bumps) < len(rows) / 2:
            result[bumps] = n_groups
            n_groups += 1
            is_plane = False
    return result, planes, is_plane


def _fit_cells(coordinates: Floats, cells: Ints, rows: Ints) -> _CellPlane:
    """Fit a plane to the means of the cells that points occupy, so that every part of a surface counts the same."""
    own_cells = cells[:, rows]
    width = int(own_cells[1].max()) + 1
    _, cell_of, counts = _occupied(own_cells[0] * width + own_cells[1])
    means = np.stack([np.bincount(cell_of, axis) / counts for axis in coordinates[:, rows]])
    # Cells that are barely touched lie on an edge, where stray points weigh most.
    is_full = counts >= 0.3 * np.median(counts)
    slope, centre, sigma_m = fit_trimmed(means[:, is_full])
    return _CellPlane(rows, means, cell_of, slope, centre, sigma_m)


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


def _members(groups: Ints) -> list[Ints]:
    """Return the rows of each group, ascending."""
    # A stable sort of short whole numbers is linear.
    is_short = int(groups.max(initial=0)) < np.iinfo(np.int16).max
    order = np.argsort(groups.astype(np.int16) if is_short else groups, kind="stable")
    ordered = groups[order]
    first = int(np.searchsorted(ordered, 0))
    order, ordered = order[first:], ordered[first:]
    return np.split(order, np.flatnonzero(np.diff(ordered)) + 1) if order.size else []


def _describe(horizontal: Horizontal, plane: _CellPlane, level_id: int, cell_m: float) -> Surface:
    return Surface(
        level_id=level_id,
        rows=freeze(plane.rows),
        cells_m=freeze(plane.means[:2]),
        area_m2=plane.means.shape[1] * cell_m * cell_m,
        height_m=float(plane.centre[2]),
        centre_m=freeze(plane.centre),
        slope=freeze(plane.slope),
        sigma_m=plane.sigma_m,
        plane=_plane_of(horizontal, plane.rows),
    )


def _plane_of(horizontal: Horizontal, rows: Ints) -> PlaneFit:
    """Return the SVD plane of some rows in local scan axes (step 8 of the paper, for a patch)."""
    fit, _ = fit_plane_rows(horizontal.coordinates_m[:, rows], np.array([0.0, 0.0, 1.0]))
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
        core = np.partition(np.abs(_residual(points, slope, centre)), n_core - 1)[:n_core]
        # The core holds the smallest residuals: its largest is the quantile of the core's share.
        sigma_m = float(core.max()) / _CORE_QUANTILE
        kept = np.abs(_residual(points, slope, centre)) <= _TRIM_SIGMA * max(sigma_m, _LEAST_SIGMA_M)
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
