"""Which surfaces are treads of bars? Gratings and planks: their points lie at one height, their normals do not say so.

Where the neighbours from which a normal is estimated reach over a bar's edges, few points of its top seem level, and
what is left of a tread falls into crumbs. But seen from the side the tops are one line: many points at one height, and
few just above and below it.
"""

import dataclasses

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.arrays import Bools, Floats, Ints, freeze
from stair_inspector.geometry.clusters import cluster_cells
from stair_inspector.geometry.percentiles import median
from stair_inspector.geometry.plan import cell_keys, left_of
from stair_inspector.model import HeightOrder, Horizontal, Patches, Surface
from stair_inspector.stages.bar_peaks import FEWEST_IN_PEAK, LITTLE_NOT_LEVEL, NOT_LEVEL, Peaks, Top, has_sides_within
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
_SWALLOWED = 0.5
_SAME_HEIGHT_M = 0.012
_MOST_PIECES = 400


def join_bars(
    heights: HeightOrder, peaks: Peaks, horizontal: Horizontal, patches: Patches, least_area_m2: float
) -> tuple[Horizontal, Patches]:
    """Put the bars of every tread together, with those of their points whose normals are spoilt.

    Parameters
    ----------
    heights : HeightOrder
        All points.
    peaks : Peaks
        Where many of them lie at one height.
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
    found = []
    for top, not_level in zip(peaks.tops, peaks.not_level(is_level), strict=True):
        if not_level >= LITTLE_NOT_LEVEL and len(top.rows) >= FEWEST_IN_PEAK:
            found += _treads_of(heights, top, patches, least_area_m2, bool(not_level < NOT_LEVEL))
    return _with_treads(heights, horizontal, is_level, patches, found) if found else (horizontal, patches)


def _treads_of(
    heights: HeightOrder, top: Top, patches: Patches, least_area_m2: float, is_mostly_level: bool
) -> list[Ints]:
    """Return the points of each tread that the points of one height form and that no surface covers as a whole."""
    cell_m = patches.cell_m
    is_covered = is_mostly_level
    if not is_covered:
        points = heights.coordinates_m[:, top.rows]
        is_covered = _is_covered(points[:2], median(points[2]), patches)
    # Most of these are whole treads, which need to be known less well than what may be bars.
    rows, plane = top.roughly if is_covered else top.well
    if len(rows) < FEWEST_IN_PEAK:
        return []
    # On the rim of a whole tread hang its own faces; what hangs far inside is seen through gaps.
    if is_covered and not top.has_sides:
        return []
    plan = heights.coordinates_m[:2, rows]
    low = plan.min(axis=1)
    column, row = ((plan - low[:, None]) / cell_m).astype(np.int64)
    n_rows = int(row.max()) + 1
    keys, of = np.unique(column * n_rows + row, return_inverse=True)
    cells = np.stack(np.divmod(keys, n_rows))
    counts = np.bincount(of)
    places = np.stack([np.zeros(cells.shape[1], dtype=np.int64), *cells])
    wanted = int(max(3.0, 0.3 * median(counts)))
    labels = cluster_cells(places, np.zeros(cells.shape[1]), counts, wanted)
    if labels.max(initial=-1) < 0 or labels.max() >= _MOST_PIECES:
        return []
    group_of = _join_pieces((cells + 0.5) * cell_m, labels, cell_m)
    result = []
    for group in np.unique(group_of[group_of >= 0]):
        is_own = group_of == group
        places_m = (cells[:, is_own] + 0.5) * cell_m + low[:, None]
        mine = rows[is_own[of]]
        height_m = median(heights.coordinates_m[2, mine])
        is_large = np.count_nonzero(is_own) * cell_m**2 >= least_area_m2 and _sides(places_m)[1] >= 0.1
        if is_large and not (
            _is_covered(heights.coordinates_m[:2, mine], height_m, patches)
            and not has_sides_within(heights.coordinates_m, mine, plane, cell_m)
        ):
            result.append(mine)
    return result


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
    usual_m = median(nearest[np.isfinite(nearest)]) if pairs else 0.0
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
        z = median(wider.coordinates_m[2, rows])
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
