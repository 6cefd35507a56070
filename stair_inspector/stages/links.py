"""Which surfaces may be neighbours on a staircase? Pairs a riser apart in height that face each other along an edge."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.arrays import Floats, Ints
from stair_inspector.geometry.percentiles import percentiles
from stair_inspector.geometry.plan import angle_deg, left_of
from stair_inspector.model import Patches, Surface
from stair_inspector.params import FlightsParams

_LEAN_M = 0.1
"""How far the mean heights of two surfaces may be from their heights at the edge between them."""
_WEAKEST_CONTACT_M = 0.1
_FACING_SHARE = 0.5
"""Share of the narrower surface's width along which an edge must run; a ragged shadow leaves less of it at first."""
_BAND_CELLS = 2.5
_LOCAL_M = 0.3
_COVERED_SHARE = 0.6
"""Where so much of a surface lies over another one, their common edge has no direction."""
CLIMB_TOLERANCE_DEG = 45.0
"""How far a flight's direction may be from the one that the inspector gives."""
_TOWARDS = 0.5
"""Cosine of the angle from the direction given within which cells of two surfaces face each other along it."""


@dataclass(frozen=True, slots=True, eq=False)
class Link:
    """Two surfaces that may be neighbours: their numbers, the lower one's height, the rise, and the edge between them.

    ``climb`` (2,) points from the lower to the upper, square to the edge; None where the edge has no direction.
    ``middle`` (2,) is the middle of the edge, ``length_m`` its length. ``n_missing`` treads lie between them unseen.
    """

    lower: int
    upper: int
    height_m: float
    rise_m: float
    climb: Floats | None
    middle: Floats
    length_m: float
    n_missing: int = 0


def find_links(
    patches: Patches, params: FlightsParams, is_allowed: Sequence[bool], given: Floats | None = None
) -> list[Link]:
    """Find all pairs of surfaces a riser apart in height that touch in plan, or nearly.

    Edges shorter than ``priors.SHORTEST_EDGE_M`` are among them: weak links, which may join runs but not begin any.

    Parameters
    ----------
    patches : Patches
        All surfaces, level frame.
    params : FlightsParams
        Limits of rise and gap.
    is_allowed : sequence of bool
        Which surfaces may be part of a staircase.
    given : (2,), optional
        Direction of climb that the inspector gives. Only links that climb within 45 degrees of it are found; where two
        surfaces face each other on several sides, or one lies over the other, it says which side is meant. The link's
        own direction stays the one square to the edge.
    """
    from scipy.spatial import KDTree  # slow to load

    surfaces = patches.surfaces
    ids = sorted((k for k in range(len(surfaces)) if is_allowed[k]), key=lambda k: surfaces[k].height_m)
    boxes = {k: (surfaces[k].cells_m.min(axis=1), surfaces[k].cells_m.max(axis=1)) for k in ids}
    trees: dict[int, Any] = {}
    links = []
    for position, lower in enumerate(ids):
        for upper in ids[position + 1 :]:
            if surfaces[upper].height_m - surfaces[lower].height_m > params.max_rise_m + _LEAN_M:
                break
            reach = params.max_gap_m + 2.0 * patches.cell_m
            (low_a, high_a), (low_b, high_b) = boxes[lower], boxes[upper]
            if (low_a > high_b + reach).any() or (low_b > high_a + reach).any():
                continue
            for k in (lower, upper):
                if k not in trees:
                    trees[k] = KDTree(surfaces[k].cells_m.T, leafsize=32, balanced_tree=False, compact_nodes=False)
            link = _link(patches, params, (lower, upper), trees, given)
            if link is not None:
                links.append(link)
    return links


def depth_along(surface: Surface, direction: Floats) -> float:
    """Return how far a surface extends in a direction of the plan, metres, but for its outermost cells."""
    low, high = percentiles(direction @ surface.cells_m, 2.0, 98.0)
    return high - low


def _link(
    patches: Patches, params: FlightsParams, pair: tuple[int, int], trees: dict[int, Any], given: Floats | None
) -> Link | None:
    lower, upper = pair
    below, above = patches.surfaces[lower], patches.surfaces[upper]
    cell_m = patches.cell_m
    reach = params.max_gap_m + 2.0 * cell_m
    to_below, near_below = _nearest_of(trees[lower], below, above, reach + _BAND_CELLS * cell_m)
    # Cells that touch have their means about a cell apart.
    if float(to_below.min()) > reach:
        return None
    to_above, near_above = _nearest_of(trees[upper], above, below, reach + _BAND_CELLS * cell_m)
    is_covered = np.count_nonzero(to_below <= 1.5 * cell_m) > _COVERED_SHARE * above.cells_m.shape[1]
    if is_covered and below.area_m2 <= priors.FLOOR_RATIO * above.area_m2:
        return None
    if given is None:
        along, middle, length_m = _edge_between(below, above, to_below, to_above, reach, cell_m)
    elif is_covered:
        along, middle, length_m = _front_edge(above, given, cell_m)
    else:
        to_below = _where_ahead(to_below, above.cells_m - below.cells_m[:, near_below], given)
        to_above = _where_ahead(to_above, above.cells_m[:, near_above] - below.cells_m, given)
        # One side alone may face the other: then there is no edge between the two.
        if max(float(to_below.min()), float(to_above.min())) > reach:
            return None
        along, middle, length_m = _edge_between(below, above, to_below, to_above, reach, cell_m)
    # Large surfaces may lean: their mean heights are no measure of the riser between them.
    rise_m = above.height_at(middle) - below.height_at(middle)
    if length_m < _WEAKEST_CONTACT_M or not params.min_rise_m <= rise_m <= params.max_rise_m:
        return None
    climb: Floats | None = None
    if given is not None or not is_covered:
        climb = left_of(along)
        ahead = _local_mean(above.cells_m, middle) - _local_mean(below.cells_m, middle) if given is None else given
        if climb @ ahead < 0.0:
            climb = -climb
        if given is not None and angle_deg(climb, given) > CLIMB_TOLERANCE_DEG:
            return None
    return Link(lower, upper, below.height_m, rise_m, climb, middle, length_m)


def _nearest_of(tree: Any, of: Surface, cells: Surface, within_m: float) -> tuple[Floats, Ints]:
    """Return distance (n,) and number (n,) of a surface's cell that is nearest to each of another's.

    Cells beyond the rectangle around the surface and so much more are infinitely far: most of a large floor are.
    """
    low, high = of.cells_m.min(axis=1) - within_m, of.cells_m.max(axis=1) + within_m
    places = cells.cells_m.T
    near = np.flatnonzero(np.all((places >= low) & (places <= high), axis=1))
    distances, numbers = np.full(len(places), np.inf), np.zeros(len(places), dtype=np.int64)
    if len(near):
        distances[near], numbers[near] = tree.query(places[near])
    return distances, numbers


def _where_ahead(distances: Floats, ways: Floats, given: Floats) -> Floats:
    """Return the distances of cells (n,) whose way (2, n) up to the other surface is about the one given, else inf."""
    return np.where(given @ ways >= _TOWARDS * distances, distances, np.inf)


def _edge_between(
    below: Surface, above: Surface, to_below: Floats, to_above: Floats, reach: float, cell_m: float
) -> tuple[Floats, Floats, float]:
    """Return direction, middle and length of the edge along which two surfaces face each other.

    Where they touch is the edge. A shadow with a ragged rim touches the other side at one place only: then the band of
    cells that count as facing is widened until the edge runs along most of the narrower surface, if it ever does.
    """
    nearest = band = float(max(to_below.min(), to_above.min())) + _BAND_CELLS * cell_m
    first = None
    while first is None or band <= max(reach, nearest):
        along, middle, length_m = _common_edge(above.cells_m[:, to_below <= band], below.cells_m[:, to_above <= band])
        first = first or (along, middle, length_m)
        if length_m >= _FACING_SHARE * min(depth_along(below, along), depth_along(above, along)):
            return along, middle, length_m
        band += _BAND_CELLS * cell_m
    return first


def _front_edge(surface: Surface, climb: Floats, cell_m: float) -> tuple[Floats, Floats, float]:
    """Return direction, middle and length of the edge at which a surface begins in a direction."""
    ahead = climb @ surface.cells_m
    columns = np.floor((surface.cells_m[1] * climb[0] - surface.cells_m[0] * climb[1]) / cell_m).astype(np.int64)
    columns -= columns.min()
    starts = np.full(int(columns.max()) + 1, np.inf)
    np.minimum.at(starts, columns, ahead)
    front = surface.cells_m[:, ahead <= starts[columns] + cell_m]
    return _common_edge(front, front)


def _common_edge(front: Floats, back: Floats) -> tuple[Floats, Floats, float]:
    """Return the direction, the middle and the length of the edge along which cells of two surfaces face each other."""
    edge = np.concatenate([front, back], axis=1)
    middle = edge.mean(axis=1)
    shift = edge - middle[:, None]
    axis: Floats = np.linalg.eigh(np.einsum("in,jn->ij", shift, shift))[1][:, 1]
    # Over a gap, cells beyond the end of the other surface are near enough too, but face nothing.
    spans = [percentiles(axis @ (cells - middle[:, None]), 2.0, 98.0) for cells in (front, back)]
    low, high = max(spans[0][0], spans[1][0]), min(spans[0][1], spans[1][1])
    return axis, middle + axis * (low + high) / 2.0, high - low


def _local_mean(cells: Floats, middle: Floats) -> Floats:
    near = np.hypot(*(cells - middle[:, None])) <= _LOCAL_M
    mean: Floats = cells[:, near].mean(axis=1) if near.any() else cells.mean(axis=1)
    return mean
