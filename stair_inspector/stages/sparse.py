"""Where do points lie so far apart that settings made for denser scans do not fit? What is taken there instead?

A normal from k neighbours, a count m and a plan cell mean something else where a tread has a hundred points than where
it has ten thousand. In a scan that is sparse, and in no other, a point amid an edge is level if most of its neighbours
lie level with it, and m and the cell follow the spacing of level surfaces.
"""

import dataclasses
import math
from dataclasses import dataclass

import numpy as np

from stair_inspector.geometry.arrays import Bools, Floats, Ints, freeze
from stair_inspector.model import HeightOrder, Horizontal, Observation
from stair_inspector.params import LevelsParams, PatchesParams
from stair_inspector.stages.density import reach_of_neighbours

SPARSE_M = 0.022
"""Spacing beyond which the usual 30 neighbours reach farther than 70 mm: a quarter of a tread on either side."""
_CALLED_SPARSE_M, _SPARSE_SHARE = 0.026, 0.1
"""A scan is called sparse when this share of its points lies so far apart: more than a lattice of 20 mm scatters."""
_CUBE_M = 0.1
_FEW_IN_CUBE, _FEW_SHARE = 20, 0.12
"""Where fewer points than this share lie in cubes that hold so few, no surface is sparse and no neighbour is asked."""
_SPARSE_IN_CUBE = 60
"""A cube in which tread and riser meet holds no more points than this where both are sparse."""
_SAMPLE = 3000
_NEIGHBOURS = 8
_AROUND = 30
_AROUND_M = SPARSE_M * math.sqrt(_AROUND / math.pi)
_REACH_M = 0.2
"""Neighbours that lie farther away say nothing about a tread."""
_FLAT_SIGMAS, _FLAT_PERCENT = 1.5, 25.0
"""A point's neighbours lie on one plane if they scatter by little more than they do about the flattest quarter."""
_NOISE_M = (0.0015, 0.005)
_ON_SIGMAS = 3.0
_AZIMUTHS = 18
"""Upright planes that are tried at a point: every ten degrees."""
_FEWEST_ON_LEVEL = 5
_LEAST_SPREAD_M = 0.012
"""Points of a level surface spread so far (1 sigma) either way in plan; a row of points on a wall does not."""
_MOST_USUAL_POINTS = 200
"""The largest m of the presets: a larger one is somebody's choice, which is obeyed."""
_FEWEST_POINTS = 10
_AREA_SHARE = 0.75
"""Share of the area of level surfaces on which points lie no farther apart than what m and the cell are fitted to."""
_AREA_FILLED = 0.75
"""A tread of the smallest area holds m points though so much of it is seen."""
_CELL_SPACINGS, _LARGEST_CELL_M = 2.0, 0.1
_PIECE = 20_000


@dataclass(frozen=True, slots=True, eq=False)
class Sparse:
    """A scan's points by height, with alignments that fit its spacing, and whether it is sparse."""

    heights: HeightOrder
    is_sparse: bool


@dataclass(frozen=True, slots=True, eq=False)
class Fitted:
    """m and the plan cell as they are used, and what is said about it, if they are not those that were set."""

    levels: LevelsParams
    patches: PatchesParams
    observations: tuple[Observation, ...] = ()


def find_sparse(heights: HeightOrder) -> Sparse:
    """Find out whether a scan is sparse; if so, find for each point amid an edge whether its surface is level.

    Parameters
    ----------
    heights : HeightOrder
        With the alignments of normals from many neighbours.

    Returns
    -------
    Sparse
        With the very same heights where the scan is dense.

    Notes
    -----
    Where the neighbours do not lie on one plane, planes through the point itself compete: the level one, and upright
    ones of all azimuths. If most neighbours lie on the level one, and spread in plan as no row of points on a wall
    does, the slope of the plane through those is the point's.
    """
    from sklearn.neighbors import KDTree

    points = np.ascontiguousarray(heights.coordinates_m.T)
    if len(points) <= _AROUND:
        return Sparse(heights, False)
    in_cube = _count_in_cubes(points)
    if np.mean(in_cube <= _FEW_IN_CUBE) < _FEW_SHARE:
        return Sparse(heights, False)
    tree = KDTree(points)
    some = np.arange(0, len(points), -(-len(points) // _SAMPLE))
    distance, near = tree.query(points[some], k=_AROUND)
    if np.mean(_spacing_of(distance[:, _NEIGHBOURS]) > _CALLED_SPARSE_M) < _SPARSE_SHARE:
        return Sparse(heights, False)
    is_far = distance[:, -1] > _AROUND_M
    if not is_far.any():
        return Sparse(heights, False)
    rms_m = _plane_rms(_shifts(points, some[is_far], near[is_far], distance[is_far]))
    noise_m = float(np.clip(np.percentile(rms_m, _FLAT_PERCENT), *_NOISE_M))
    alignment = heights.alignment.copy()
    asked = np.flatnonzero(in_cube <= _SPARSE_IN_CUBE)
    for start in range(0, len(asked), _PIECE):
        rows = asked[start : start + _PIECE]
        distance, near = tree.query(points[rows], k=_AROUND)
        is_far = distance[:, -1] > _AROUND_M
        rows = rows[is_far]
        shifts = _shifts(points, rows, near[is_far], distance[is_far])
        is_amid = _plane_rms(shifts) > _FLAT_SIGMAS * noise_m
        aligned, is_level = _find_level(shifts[is_amid], _ON_SIGMAS * noise_m)
        alignment[rows[is_amid][is_level]] = aligned[is_level]
    return Sparse(dataclasses.replace(heights, alignment=freeze(alignment)), True)


def follow_spacing(horizontal: Horizontal, levels: LevelsParams, patches: PatchesParams) -> Fitted:
    """Return m and the plan cell that fit the spacing of a sparse scan's level surfaces.

    Parameters
    ----------
    horizontal : Horizontal
        Upright points of a scan that is sparse.
    levels, patches
        As they are set: m is never taken larger, the cell never smaller; an m beyond those of the presets is obeyed.

    Notes
    -----
    Every point stands for the square of its spacing, so that the median and other quantiles are by area: most points
    lie where they are dense, most treads where they are not.
    """
    if len(horizontal.point_ids) <= _NEIGHBOURS:
        return Fitted(levels, patches)
    spacing = np.sort(_spacing_of(reach_of_neighbours(horizontal.coordinates_m, _NEIGHBOURS, _SAMPLE)))
    area = np.cumsum(spacing**2)
    spacing_m = float(spacing[np.searchsorted(area, _AREA_SHARE * area[-1])])
    fitting = max(_FEWEST_POINTS, int(_AREA_FILLED * patches.min_area_m2 / spacing_m**2))
    is_usual = levels.min_points <= _MOST_USUAL_POINTS
    min_points = min(levels.min_points, fitting) if is_usual else levels.min_points
    cell_m = max(patches.cell_m, min(_CELL_SPACINGS * spacing_m, _LARGEST_CELL_M))
    taken = []
    if min_points < levels.min_points:
        taken.append(f"levels.min_points (m) {levels.min_points} as {min_points}")
    if cell_m > patches.cell_m:
        taken.append(f"patches.cell_m {patches.cell_m * 1000.0:g} mm as {cell_m * 1000.0:.0f} mm")
    observations: tuple[Observation, ...] = ()
    if taken:
        message = (
            f"the scan is sparse: on level surfaces points lie up to {spacing_m * 1000.0:.0f} mm apart; there "
            f"{' and '.join(taken)} is taken"
        )
        cure = "scan from nearer or in finer steps for smaller u"
        observations = (Observation("sparse", "info", message, spacing_m, cure),)
    return Fitted(
        dataclasses.replace(levels, min_points=min_points),
        dataclasses.replace(patches, cell_m=cell_m),
        observations,
    )


def _count_in_cubes(points: Floats) -> Ints:
    """Return how many points lie in the cube of each, (n,)."""
    cells = ((points - points.min(axis=0)) / _CUBE_M).astype(np.int64)
    n_rows, n_layers = int(cells[:, 1].max()) + 1, int(cells[:, 2].max()) + 1
    keys = (cells[:, 0] * n_rows + cells[:, 1]) * n_layers + cells[:, 2]
    ordered = np.sort(keys)
    begins = np.flatnonzero(np.concatenate([[True], ordered[1:] != ordered[:-1]]))
    counts = np.diff(np.append(begins, len(points)))
    found: Ints = counts[np.searchsorted(ordered[begins], keys)]
    return found


def _spacing_of(reach_m: Floats) -> Floats:
    """Return the side of the square that a point stands for, given the radius of the disc to its 8th neighbour."""
    spacing: Floats = reach_m * math.sqrt(math.pi / _NEIGHBOURS)
    return spacing


def _shifts(points: Floats, rows: Ints, near: Ints, distance: Floats) -> Floats:
    """Return the way (n, k, 3) from each of n points to its neighbours; to itself in place of those too far away."""
    near = np.where(distance <= _REACH_M, near, rows[:, None])
    shifts: Floats = points[near] - points[rows][:, None]
    return shifts


def _plane_rms(shifts: Floats) -> Floats:
    """Return how far (rms) the points about each of n places lie off the plane through them, (n,)."""
    centred = shifts - shifts.mean(axis=1, keepdims=True)
    scatter = np.einsum("nki,nkj->nij", centred, centred) / shifts.shape[1]
    rms: Floats = np.sqrt(np.maximum(np.linalg.eigvalsh(scatter)[:, 0], 0.0))
    return rms


def _find_level(shifts: Floats, within_m: float) -> tuple[Floats, Bools]:
    """Return how well the level surface through each place is aligned with up, (n,), and whether there is one."""
    is_on = np.abs(shifts[:, :, 2]) <= within_m
    n_on = is_on.sum(axis=1)
    n_upright = np.zeros(len(shifts), dtype=np.int64)
    for azimuth in np.arange(_AZIMUTHS) * math.pi / _AZIMUTHS:
        off = shifts[:, :, 0] * math.cos(azimuth) + shifts[:, :, 1] * math.sin(azimuth)
        np.maximum(n_upright, (np.abs(off) <= within_m).sum(axis=1), out=n_upright)
    weight = is_on / np.maximum(n_on, 1)[:, None]
    centred = shifts - np.einsum("nk,nki->ni", weight, shifts)[:, None]
    scatter = np.einsum("nk,nki,nkj->nij", weight, centred, centred)
    a, b, c = scatter[:, 0, 0], scatter[:, 0, 1], scatter[:, 1, 1]
    narrow = np.sqrt(np.maximum((a + c) / 2.0 - np.hypot((a - c) / 2.0, b), 0.0))
    is_level = (n_on >= np.maximum(n_upright, _FEWEST_ON_LEVEL)) & (narrow >= _LEAST_SPREAD_M)
    # Where there is none, the slope is not asked for.
    determinant = np.where(is_level, a * c - b * b, 1.0)
    slope_x = (c * scatter[:, 0, 2] - b * scatter[:, 1, 2]) / determinant
    slope_y = (a * scatter[:, 1, 2] - b * scatter[:, 0, 2]) / determinant
    return 1.0 / np.sqrt(1.0 + slope_x**2 + slope_y**2), is_level
