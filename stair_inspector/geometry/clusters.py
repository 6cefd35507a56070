"""DBSCAN on one coordinate, and on the cells of a grid: exact, in linear memory."""

from dataclasses import dataclass

import numpy as np

from stair_inspector.geometry.arrays import Bools, Floats, Ints, freeze

_PIECE = 4096


@dataclass(frozen=True, slots=True, eq=False)
class Reach:
    """How far each value's eps-neighbourhood extends in the sorted order: ``first[i] <= j < stop[i]``, (n,) each."""

    first: Ints
    stop: Ints


@dataclass(frozen=True, slots=True, eq=False)
class Clusters1D:
    """Clusters as ranges of the sorted values, ascending; ``is_core`` (n,) marks the core points."""

    start: Ints
    stop: Ints
    is_core: Bools


def find_reach(ordered: Floats, eps: float) -> Reach:
    """Find the eps-neighbourhood of every value, ends included.

    Parameters
    ----------
    ordered : (n,)
        Ascending values, any unit.
    eps : float
        Largest distance of a neighbour, in the same unit; positive.

    Notes
    -----
    Two values are neighbours when ``(b - a)**2 <= eps**2`` in floating point: the comparison that scikit-learn's
    tree makes, so that distances equal to eps fall the same way. ``b - a`` is monotone in ``b``, hence every
    neighbourhood is a range, and its ends need one search plus a correction where rounding moved the search by a
    value. O(n log n) time, O(n) memory.
    """
    n = len(ordered)
    beyond = np.append(ordered, np.inf)
    stop = np.zeros(n, dtype=np.int64)
    # Piece by piece: the search then stays within the processor's cache.
    for start in range(0, n, _PIECE):
        stop[start : start + _PIECE] = _find_stop(beyond, slice(start, min(start + _PIECE, n)), eps)
    # Being neighbours is symmetric, so j's first neighbour is the number of i whose range ends at or before j.
    first = np.cumsum(np.bincount(stop, minlength=n + 1))[:n]
    return Reach(freeze(first), freeze(stop))


def _find_stop(beyond: Floats, piece: slice, eps: float) -> Ints:
    """Return where the neighbourhoods of a piece of the ascending values end; ``beyond`` are all, then infinity."""
    ordered, values = beyond[:-1], beyond[piece]
    sums = values + eps
    low, high = np.searchsorted(ordered, sums[[0, -1]], side="right")
    stop: Ints = low + np.searchsorted(ordered[low:high], sums, side="right")
    # ``a + eps`` rounds, so the search may be off by a group of equal values: step outwards, then inwards.
    limit = eps * eps
    ids = np.flatnonzero((beyond[stop] - values) ** 2 <= limit)
    while ids.size:
        stop[ids] = np.searchsorted(ordered, beyond[stop[ids]], side="right")
        ids = ids[(beyond[stop[ids]] - values[ids]) ** 2 <= limit]
    ids = np.flatnonzero((beyond[stop - 1] - values) ** 2 > limit)
    while ids.size:
        stop[ids] = np.searchsorted(ordered, beyond[stop[ids] - 1], side="left")
        ids = ids[(beyond[stop[ids] - 1] - values[ids]) ** 2 > limit]
    return stop


def cluster_sorted(reach: Reach, min_points: int) -> Clusters1D:
    """Cluster sorted values by DBSCAN, given their neighbourhoods.

    Parameters
    ----------
    reach : Reach
        From :func:`find_reach`.
    min_points : int
        Smallest neighbourhood, the value itself included, of a core point.

    Returns
    -------
    Clusters1D
        A border value between two clusters goes to the lower one. Values outside every range are noise.

    References
    ----------
    .. [1] Ester, Kriegel, Sander, Xu: A density-based algorithm for discovering clusters in large spatial databases
       with noise, KDD 1996, definitions 1 to 6.
    """
    is_core = reach.stop - reach.first >= min_points
    core = np.flatnonzero(is_core)
    if core.size == 0:
        none = freeze(np.zeros(0, dtype=np.int64))
        return Clusters1D(none, none, freeze(is_core))
    # A new cluster begins at each core value that the core value before it does not reach.
    begins = np.flatnonzero(np.concatenate([[True], core[1:] >= reach.stop[core[:-1]]]))
    lowest = core[begins]
    highest = core[np.concatenate([begins[1:] - 1, [core.size - 1]])]
    stop = reach.stop[highest]
    start = np.maximum(reach.first[lowest], np.concatenate([[0], stop[:-1]]))
    return Clusters1D(
        freeze(start),
        freeze(stop),
        freeze(is_core),
    )


def cluster_cells(places: Ints, heights: Floats, counts: Ints, min_points: int) -> Ints:
    """Cluster cells of plan by DBSCAN, each counting as many times as it holds points.

    Parameters
    ----------
    places : (3, c)
        Layer, column and row of each cell, none negative: different cells in lexicographic order.
    heights : (c,)
        Height of each cell, in units of the largest step between neighbours.
    counts : (c,)
        Points in each cell.
    min_points : int
        Smallest number of points in the neighbourhood of a core cell, its own included.

    Returns
    -------
    (c,)
        Cluster of each cell, in the order of the clusters' first core cells; -1 for noise. A border cell goes to the
        first of the clusters that reach it.

    Notes
    -----
    Neighbours are the eight cells around a cell in its own layer whose heights differ by at most 1: DBSCAN with
    eps = 1 in the Chebyshev metric, without a search tree. O(c log c) time, O(c) memory.
    """
    n = places.shape[1]
    one, other = _pairs_of_neighbours(places, heights)
    weight = counts + np.bincount(one, counts[other], n) + np.bincount(other, counts[one], n)
    is_core = weight >= min_points
    joins = is_core[one] & is_core[other]
    first = _connect(n, one[joins], other[joins])
    # A border cell takes the first cluster among its core neighbours'.
    first[~is_core] = n
    for core, border in ((one, other), (other, one)):
        reaches = is_core[core] & ~is_core[border]
        np.minimum.at(first, border[reaches], first[core[reaches]])
    is_first = np.zeros(n + 1, dtype=np.bool_)
    is_first[first] = True
    labels: Ints = np.where(first < n, np.cumsum(is_first)[first] - 1, -1)
    return labels


def _pairs_of_neighbours(places: Ints, heights: Floats) -> tuple[Ints, Ints]:
    """Return the numbers of the cells that touch, each pair once."""
    n_columns, n_rows = int(places[1].max(initial=0)) + 2, int(places[2].max(initial=0)) + 2
    # One column and one row between what lies at the edges: there nothing touches that should not.
    keys = (places[0] * n_columns + places[1]) * n_rows + places[2]
    one, other = [], []
    for step in (1, n_rows - 1, n_rows, n_rows + 1):
        found = np.minimum(np.searchsorted(keys, keys + step), len(keys) - 1)
        touching = np.flatnonzero((keys[found] == keys + step) & (np.abs(heights[found] - heights) <= 1.0))
        one.append(touching)
        other.append(found[touching])
    return np.concatenate(one), np.concatenate(other)


def _connect(n: int, one: Ints, other: Ints) -> Ints:
    """Return for each of n nodes the lowest node that edges between ``one`` and ``other`` connect it with."""
    lowest = np.arange(n)
    while one.size:
        # Hang the higher of the two lowest nodes of each edge below the other, then make all chains short.
        a, b = lowest[one], lowest[other]
        np.minimum.at(lowest, np.maximum(a, b), np.minimum(a, b))
        while not np.array_equal(lowest, lowest[lowest]):
            lowest = lowest[lowest]
        is_open = lowest[one] != lowest[other]
        one, other = one[is_open], other[is_open]
    return lowest
