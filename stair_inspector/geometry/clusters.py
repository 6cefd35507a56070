"""DBSCAN on one coordinate: exact, in linear memory."""

from dataclasses import dataclass

import numpy as np

from stair_inspector.geometry.arrays import Floats, Ints, freeze


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
    is_core: "np.ndarray[tuple[int], np.dtype[np.bool_]]"


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
    # ``searchsorted(ordered, ordered + eps, "right")``, by merging the two ascending runs: a stable sort of their
    # concatenation is linear, and a value sorts before the sums that equal it.
    merged = np.argsort(np.concatenate([ordered, ordered + eps]), kind="stable")
    stop = np.flatnonzero(merged >= n) - np.arange(n)
    # ``a + eps`` rounds, so the search may be off by a group of equal values: step outwards, then inwards.
    limit = eps * eps
    beyond = np.append(ordered, np.inf)
    ids = np.flatnonzero((beyond[stop] - ordered) ** 2 <= limit)
    while ids.size:
        stop[ids] = np.searchsorted(ordered, beyond[stop[ids]], side="right")
        ids = ids[(beyond[stop[ids]] - ordered[ids]) ** 2 <= limit]
    ids = np.flatnonzero((ordered[stop - 1] - ordered) ** 2 > limit)
    while ids.size:
        stop[ids] = np.searchsorted(ordered, ordered[stop[ids] - 1], side="left")
        ids = ids[(ordered[stop[ids] - 1] - ordered[ids]) ** 2 > limit]
    # Being neighbours is symmetric, so j's first neighbour is the number of i whose range ends at or before j.
    first = np.cumsum(np.bincount(stop, minlength=n + 1))[:n]
    return Reach(freeze(first), freeze(stop))


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
