"""Which points of one height form one surface? Height clusters split into patches that hang together in plan."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stair_inspector.errors import CannotMeasure
from stair_inspector.geometry.arrays import Floats, Ints, freeze
from stair_inspector.geometry.clusters import cluster_sorted, find_reach
from stair_inspector.geometry.percentiles import median
from stair_inspector.geometry.trimmed import fit_trimmed, height_above
from stair_inspector.model import Horizontal, Levels, Patches, Surface
from stair_inspector.params import LevelsParams, PatchesParams
from stair_inspector.stages.levels import find_height_reach, find_levels
from stair_inspector.stages.plan_cells import (
    LARGEST_CELL_M,
    PlanGrid,
    PlanPart,
    lay_plan_grid,
    part_of_rows,
    split_in_plan,
)
from stair_inspector.stages.treads import plane_of_rows

MAX_PATCHES = 3000
"""More surfaces than a building has: the settings cut it into crumbs."""
_THICK_M = 0.05
"""A patch that spans more than this in height may be two surfaces that an object between them has joined."""
_ROUNDS = 4
_BUMP_M, _BUMP_SIGMA = 0.015, 5.0
"""What lies farther off the plane of a surface than both is something else."""
_CRUMB_SHARE = 0.35
_CRUMB_GAP_M = 0.3
_BESIDE_GAP_M, _LEAST_DEPTH = 0.12, 0.5
"""A crumb beyond the ends of a surface would make it longer. Behind the shadow of a post a tread goes on over its whole
depth; clutter that lies at its height is smaller, and nearer only by chance."""
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
    most_m = _largest_cell_of(horizontal.whole, params, heights)
    grid = lay_plan_grid(coordinates[:2], levels, params.cell_m, horizontal.plan_corner_m, most_m)
    planes: list[_CellPlane] = []
    for _ in range(_ROUNDS):
        parts = split_in_plan(grid, coordinates, groups, heights.eps_m)
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
        else surface_of_part(
            horizontal,
            part_of_rows(grid, coordinates, np.sort(np.concatenate(pieces))),
            surfaces[number].level_id,
            grid.cell_m,
        )
        for number, pieces in _with_crumbs(surfaces)
    ]
    ordered = sorted(joined, key=lambda surface: (surface.level_id, surface.height_m))
    return Patches(tuple(ordered), grid.cell_m)


@dataclass(frozen=True, slots=True, eq=False)
class _CellPlane:
    """A part and the plane through its cells."""

    part: PlanPart
    slope: Floats
    centre: Floats
    sigma_m: float


def _level_of(levels: Levels, rows: Ints) -> int:
    return int(np.searchsorted(levels.start, rows[0], side="right")) - 1


def _largest_cell_of(whole: Horizontal | None, params: PatchesParams, heights: LevelsParams) -> float:
    """Return the largest plan cell that is taken, metres: in a region of a scan none is larger than in all of it.

    That less of a scan is measured makes nothing coarser. Without a region, and where the whole falls into too many
    levels, cells may be as large as any.
    """
    if whole is None:
        return LARGEST_CELL_M
    try:
        levels = find_levels(whole, find_height_reach(whole, heights.eps_m), heights)
    except CannotMeasure:
        return LARGEST_CELL_M
    return lay_plan_grid(whole.coordinates_m[:2], levels, params.cell_m, whole.plan_corner_m).cell_m


def _split_in_height(
    grid: PlanGrid, coordinates: Floats, parts: Sequence[PlanPart], params: LevelsParams
) -> tuple[list[PlanPart], bool]:
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
            part_of_rows(grid, coordinates, rows[start:stop])
            for start, stop in zip(clusters.start, clusters.stop, strict=True)
        ]
    return result, is_settled


def _split_off_bumps(parts: Sequence[PlanPart], least: int) -> tuple[list[Ints], list[_CellPlane], bool]:
    """Return the rows of new groups: cells that lie well off their part's plane become a group of their own.

    A box on a tread may be so near to the next tread in height that both are one height cluster. Returns the planes of
    the parts as they were, and whether none was split.
    """
    planes = [_fit_part(part) for part in parts]
    remaining, bumps = [], []
    for plane in planes:
        part = plane.part
        limit = max(_BUMP_M, _BUMP_SIGMA * plane.sigma_m)
        is_off = np.abs(height_above(part.means, plane.slope, plane.centre)) > limit
        if least <= int(part.counts[is_off].sum()) < len(part.rows) / 2:
            is_bump = is_off.take(part.place_of)
            bumps.append(part.rows[is_bump])
            remaining.append(part.rows[~is_bump])
        else:
            remaining.append(part.rows)
    return remaining + bumps, planes, not bumps


def _fit_part(part: PlanPart) -> _CellPlane:
    """Fit a plane to the means of a part's cells, so that every piece of the surface counts the same."""
    # Cells that are barely touched lie on an edge, where stray points weigh most.
    is_full = part.counts >= 0.3 * median(part.counts)
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
    if abs(crumb.height_m - large.height_at(crumb.centre_m[:2])) > _CRUMB_STEP_M + 2.0 * large.sigma_m:
        return False
    low, high = large.cells_m.min(axis=1) - _CRUMB_GAP_M, large.cells_m.max(axis=1) + _CRUMB_GAP_M
    near = (crumb.cells_m > low[:, None]) & (crumb.cells_m < high[:, None])
    if not near.all(axis=0).any():
        return False
    gaps = large.cells_m[:, :, None] - crumb.cells_m[:, None, :: max(1, crumb.cells_m.shape[1] // 20)]
    most_m = _CRUMB_GAP_M if _continues(crumb, large) else _BESIDE_GAP_M
    return bool(np.hypot(gaps[0], gaps[1]).min() <= most_m)


def _continues(crumb: Surface, large: Surface) -> bool:
    """Return whether a crumb lies within a large surface's rectangle, or carries it on over half of its depth."""
    middle = large.cells_m.mean(axis=1)
    axes = np.linalg.svd(large.cells_m - middle[:, None], full_matrices=False)[0].T
    whole, part = axes @ large.cells_m, axes @ crumb.cells_m
    low, high, place = whole.min(axis=1), whole.max(axis=1), part.mean(axis=1)
    is_among = bool(((place >= low) & (place <= high)).all())
    return is_among or bool(np.ptp(part[1]) >= _LEAST_DEPTH * np.ptp(whole[1]))


def surface_of_part(
    horizontal: Horizontal, part: PlanPart, level_id: int, cell_m: float, is_barred: bool = False
) -> Surface:
    """Return the surface that a part of the horizontal points forms."""
    return _describe(horizontal, _fit_part(part), level_id, cell_m, is_barred)


def _describe(
    horizontal: Horizontal, plane: _CellPlane, level_id: int, cell_m: float, is_barred: bool = False
) -> Surface:
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
        plane=plane_of_rows(horizontal, part.rows)[0],
        is_barred=is_barred,
    )
