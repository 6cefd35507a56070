"""Which surfaces are treads of bars? Gratings and planks: their points lie at one height, their normals do not say so.

Where the neighbours from which a normal is estimated reach over a bar's edges, few points of its top seem level, and
what is left of a tread falls into crumbs. But seen from the side the tops are one line: many points at one height, and
few just above and below it.
"""

import dataclasses
from dataclasses import dataclass

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.arrays import Bools, Floats, Ints, freeze
from stair_inspector.geometry.clusters import cluster_cells
from stair_inspector.geometry.percentiles import MAD_TO_SIGMA
from stair_inspector.geometry.plan import cell_keys, left_of
from stair_inspector.geometry.trimmed import densest, fit_trimmed, height_above
from stair_inspector.model import HeightOrder, Horizontal, Patches, Surface
from stair_inspector.stages.bar_peaks import FEWEST_IN_PEAK, NOT_LEVEL, find_peaks, points_at_peaks
from stair_inspector.stages.patches import surface_of_part
from stair_inspector.stages.plan_cells import part_of_cells

_RHYTHM = 1.6
"""How much wider than the usual gap of their tread a gap between bars may be: beyond, another tread begins."""
_NARROW = 2.2
"""Cells from middle to middle over a gap of one empty cell."""
_BESIDE = 0.5
"""Share of the shorter of two bars along which they must lie beside each other: end to end they are two treads'."""
_WHOLE_SHARE = 0.6
"""A surface that covers most of the points at its height is not in pieces, whatever noise frays it."""
_SIDE_NEAR_M, _SIDE_NEAR_SIGMAS, _SIDE_FAR_M, _SIDE_PARTS = 0.005, 4.0, 0.02, 3
"""Between these depths below a surface, the first in its noise too, the sides of bars show, in each of some parts."""
_SIDE_SHARE = 0.06
"""So many points on them, as a share of those on the tops above, are no noise."""
_SWALLOWED = 0.5
_TRIM_SIGMA, _LEAST_SIGMA_M, _ROUNDS = 2.5, 0.0005, 3
_SAME_HEIGHT_M = 0.012
_MOST_PIECES, _MOST_TO_FIT, _ENOUGH_TO_FIT = 400, 4000, 1000


@dataclass(frozen=True, slots=True, eq=False)
class _Tops:
    """The plane of the tops of bars: slope (2,), a point of it (3,) and the scatter about it, metres, level frame."""

    slope: Floats
    centre: Floats
    sigma_m: float


def join_bars(
    heights: HeightOrder, horizontal: Horizontal, patches: Patches, least_area_m2: float
) -> tuple[Horizontal, Patches]:
    """Put the bars of every tread together, with those of their points whose normals are spoilt.

    Parameters
    ----------
    heights : HeightOrder
        All points.
    horizontal, patches
        The upright ones among them, and their surfaces.
    least_area_m2 : float
        Smallest area of a tread.

    Returns
    -------
    horizontal, patches
        The same objects where no tread is in bars; else with the bars' points among the horizontal ones.
    """
    if not len(horizontal.point_ids) or not patches.surfaces:
        return horizontal, patches
    is_level = np.zeros(heights.n_scan, dtype=np.bool_)
    is_level[horizontal.point_ids] = True
    is_level = is_level[heights.point_ids]
    peaks = find_peaks(heights.coordinates_m, is_level)
    if peaks is None:
        return horizontal, patches
    found = []
    for rows, not_level in zip(points_at_peaks(heights.coordinates_m, peaks), peaks.not_level, strict=True):
        if len(rows) >= FEWEST_IN_PEAK:
            found += _treads_of(heights, rows, patches, least_area_m2, bool(not_level < NOT_LEVEL))
    return _with_treads(heights, horizontal, is_level, patches, found) if found else (horizontal, patches)


def _treads_of(
    heights: HeightOrder, rows: Ints, patches: Patches, least_area_m2: float, is_mostly_level: bool
) -> list[Ints]:
    """Return the points of each tread that the points of one height form and that no surface covers as a whole."""
    cell_m = patches.cell_m
    points = heights.coordinates_m[:, rows]
    is_covered = is_mostly_level or _is_covered(points[:2], float(np.median(points[2])), patches)
    # Most of these are whole treads, which need to be known less well than what may be bars.
    rows, plane = _on_plane(heights.coordinates_m, rows, _ENOUGH_TO_FIT if is_covered else _MOST_TO_FIT)
    if len(rows) < FEWEST_IN_PEAK:
        return []
    # On the rim of a whole tread hang its own faces; what hangs far inside is seen through gaps.
    if is_covered and not _has_sides_within(heights.coordinates_m, rows, plane, cell_m):
        return []
    plan = heights.coordinates_m[:2, rows]
    low = plan.min(axis=1)
    column, row = ((plan - low[:, None]) / cell_m).astype(np.int64)
    n_rows = int(row.max()) + 1
    keys, of = np.unique(column * n_rows + row, return_inverse=True)
    cells = np.stack(np.divmod(keys, n_rows))
    counts = np.bincount(of)
    places = np.stack([np.zeros(cells.shape[1], dtype=np.int64), *cells])
    wanted = int(max(3.0, 0.3 * float(np.median(counts))))
    labels = cluster_cells(places, np.zeros(cells.shape[1]), counts, wanted)
    if labels.max(initial=-1) < 0 or labels.max() >= _MOST_PIECES:
        return []
    group_of = _join_pieces((cells + 0.5) * cell_m, labels, cell_m)
    result = []
    for group in np.unique(group_of[group_of >= 0]):
        is_own = group_of == group
        places_m = (cells[:, is_own] + 0.5) * cell_m + low[:, None]
        mine = rows[is_own[of]]
        height_m = float(np.median(heights.coordinates_m[2, mine]))
        is_large = np.count_nonzero(is_own) * cell_m**2 >= least_area_m2 and _sides(places_m)[1] >= 0.1
        if is_large and not (
            _is_covered(heights.coordinates_m[:2, mine], height_m, patches)
            and not _has_sides_within(heights.coordinates_m, mine, plane, cell_m)
        ):
            result.append(mine)
    return result


def _has_sides_within(coordinates: Floats, rows: Ints, plane: _Tops, cell_m: float) -> bool:
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


def _on_plane(coordinates: Floats, rows: Ints, most: int) -> tuple[Ints, _Tops]:
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
        reach_m = _TRIM_SIGMA * max(MAD_TO_SIGMA * float(np.median(above)) if len(above) else 0.0, _LEAST_SIGMA_M)
        kept = np.abs(off - top) <= reach_m
        if np.count_nonzero(kept) < FEWEST_IN_PEAK:
            break
        slope, centre, sigma_m = fit_trimmed(points[:, kept])
    is_top: Bools = np.abs(height_above(coordinates[:, rows], slope, centre)) <= reach_m
    return rows[is_top], _Tops(slope, centre, sigma_m)


def _join_pieces(places_m: Floats, labels: Ints, cell_m: float) -> Ints:
    """Return the group of each cell: bars that lie beside each other, and pieces that are wide enough by themselves."""
    n = int(labels.max()) + 1
    pieces = [places_m[:, labels == k] for k in range(n)]
    is_bar = [_sides(piece)[1] + cell_m < priors.WIDEST_BAR_M for piece in pieces]
    reach = priors.WIDEST_BAR_GAP_M + cell_m
    pairs = []
    for i in range(n):
        for j in range(i):
            gap_m = _gap_between(pieces[i], pieces[j], reach)
            # Gaps hardly wider than a cell are seen here and there only: what they part may be several bars.
            if gap_m <= (reach if is_bar[i] or is_bar[j] else _NARROW * cell_m):
                pairs.append((i, j, gap_m))
    nearest = np.full(n, np.inf)
    for i, j, gap_m in pairs:
        nearest[[i, j]] = np.minimum(nearest[[i, j]], gap_m)
    usual_m = float(np.median(nearest[np.isfinite(nearest)])) if pairs else 0.0
    group = np.arange(n)
    for i, j, gap_m in pairs:
        # Either end of a gap is known to a cell.
        if gap_m <= _RHYTHM * usual_m + 2.0 * cell_m:
            group[group == group[i]] = group[j]
    return np.where(labels >= 0, group[np.maximum(labels, 0)], -1)


def _gap_between(a: Floats, b: Floats, reach: float) -> float:
    """Return how far apart two pieces are that lie side by side; infinite for others, as for those end to end."""
    if (a.min(axis=1) > b.max(axis=1) + reach).any() or (b.min(axis=1) > a.max(axis=1) + reach).any():
        return float("inf")
    longer, shorter = (a, b) if _sides(a)[0] >= _sides(b)[0] else (b, a)
    axis = _axis(longer)
    # Of several bars that hang together the longer side may be across them.
    is_bar = _sides(longer)[1] < priors.WIDEST_BAR_M
    if not any(_face_each_other(longer, shorter, way) for way in (axis, left_of(axis))[: 2 - is_bar]):
        return float("inf")
    return float(np.hypot(*(a[:, :, None] - b[:, None, :])).min())


def _face_each_other(longer: Floats, shorter: Floats, axis: Floats) -> bool:
    """Return whether two pieces lie beside each other along most of the shorter one's extent in a direction."""
    (low, high), (start, stop) = (
        (float((axis @ each).min()), float((axis @ each).max())) for each in (longer, shorter)
    )
    return min(high, stop) - max(low, start) >= _BESIDE * (stop - start)


def _axis(places_m: Floats) -> Floats:
    """Return the direction in which cells extend farthest."""
    shift = places_m - places_m.mean(axis=1)[:, None]
    axis: Floats = np.linalg.eigh(np.einsum("in,jn->ij", shift, shift))[1][:, 1]
    return axis


def _sides(places_m: Floats) -> tuple[float, float]:
    """Return how long and how wide cells extend, from middle to middle."""
    axis = _axis(places_m)
    across = left_of(axis)
    return float(np.ptp(axis @ places_m)), float(np.ptp(across @ places_m))


def _is_covered(places_m: Floats, height_m: float, patches: Patches) -> bool:
    """Return whether one surface covers the places of most of some points at its height."""
    side_m = 2.0 * patches.cell_m
    # By points and not by places: what strays around a tread fills many places with a point each.
    own = cell_keys(places_m, side_m)
    low, high = places_m.min(axis=1), places_m.max(axis=1)
    for surface in patches.surfaces:
        inside = ((surface.cells_m >= low[:, None] - side_m) & (surface.cells_m <= high[:, None] + side_m)).all(axis=0)
        if not inside.any():
            continue
        cells = surface.cells_m[:, inside]
        is_same = abs(surface.height_at(cells.mean(axis=1)) - height_m) <= _SAME_HEIGHT_M
        if is_same and np.isin(own, np.unique(cell_keys(cells, side_m))).mean() >= _WHOLE_SHARE:
            return True
    return False


def _with_treads(
    heights: HeightOrder, horizontal: Horizontal, is_level: Bools, patches: Patches, found: list[Ints]
) -> tuple[Horizontal, Patches]:
    """Put treads, given by their places in the order by height, in the place of the crumbs that were seen of them."""
    is_kept = is_level.copy()
    for rows in found:
        is_kept[rows] = True
    ids = np.flatnonzero(is_kept)
    wider = dataclasses.replace(
        horizontal,
        point_ids=freeze(heights.point_ids.take(ids)),
        coordinates_m=freeze(heights.coordinates_m.take(ids, axis=1)),
    )
    # Where each point is now, of all and of those that were horizontal before.
    place = np.cumsum(is_kept) - 1
    before = place[np.flatnonzero(is_level)]
    tread_of = np.full(len(ids), -1, dtype=np.int64)
    for number, rows in enumerate(found):
        tread_of[place[rows]] = number
    kept: list[Surface] = []
    levels: dict[int, int] = {}
    for surface in patches.surfaces:
        rows = before[surface.rows]
        inside = tread_of[rows]
        if np.count_nonzero(inside >= 0) >= _SWALLOWED * len(rows):
            for number in np.unique(inside[inside >= 0]):
                levels.setdefault(int(number), surface.level_id)
        else:
            tread_of[rows] = -1
            kept.append(dataclasses.replace(surface, rows=freeze(rows)))
    by_height = sorted(patches.surfaces, key=lambda surface: surface.height_m)
    for number in range(len(found)):
        rows = np.flatnonzero(tread_of == number)
        if len(rows) < FEWEST_IN_PEAK:
            continue
        z = float(np.median(wider.coordinates_m[2, rows]))
        nearest = min(by_height, key=lambda surface: abs(surface.height_m - z)).level_id
        kept.append(surface_of_rows(wider, rows, levels.get(number, nearest), patches.cell_m, True))
    ordered = sorted(kept, key=lambda surface: (surface.level_id, surface.height_m))
    return wider, Patches(tuple(ordered), patches.cell_m)


def surface_of_rows(
    horizontal: Horizontal, rows: Ints, level_id: int, cell_m: float, is_barred: bool = False
) -> Surface:
    """Return the surface that some horizontal points form, ascending ``rows``, on plan cells of its own."""
    points = horizontal.coordinates_m[:, rows]
    low = points[:2].min(axis=1)
    column, row = ((points[:2] - low[:, None]) / cell_m).astype(np.int64)
    n_rows = int(row.max()) + 1
    part = part_of_cells(rows, column * n_rows + row, tuple(points))
    return surface_of_part(horizontal, part, level_id, cell_m, is_barred)
