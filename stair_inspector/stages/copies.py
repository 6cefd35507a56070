"""Does a cloud hold itself twice, shifted or mirrored?

Only exact copies are told, number by number: two scans of one object never agree so. Whether a whole scan is
left-handed cannot be seen in it.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from stair_inspector.geometry.arrays import Bools, Floats, Ints
from stair_inspector.model import Scan
from stair_inspector.stages.coordinate_steps import FLOAT32

if TYPE_CHECKING:
    from scipy.spatial import KDTree

_AROUND_M = 0.1
"""A copy that is shifted farther is another object to the eye, and is seen."""
_ANCHORS = 8
_MOST_AROUND = 3000
_LEAST_ANCHORS = 5
_SHARED = 2
"""Of the anchors that a shift comes from, which agree by themselves."""
_BESIDE = (3.0, 6.0)
"""How far beside a shift, in tolerances, others of the same cloud show how many anchors agree by chance."""
_LEAST_MIRRORED = 0.2
_SAMPLE_BITS = 5
_FEWEST = 50


def find_shifted_copy(points: Floats) -> Floats | None:
    """Return the shift (3,) between a cloud and its copy in it, metres, up to its sign; None without one.

    Parameters
    ----------
    points : (n, 3), metres
        Not on a lattice and not rounded: there the same differences return everywhere.

    Notes
    -----
    Every point of such a cloud has a partner at the same shift, to the rounding of float32. Of all differences between
    a point and those around it, two points share none by chance, and where they do, as on a line of dense points, more
    of them must share the shift than share any that is a little longer.
    """
    from scipy.spatial import KDTree

    if len(points) < _FEWEST:
        return None
    exactness_m = 4.0 * FLOAT32 * float(np.abs(points).max())
    anchors = np.random.default_rng(11).choice(len(points), _ANCHORS, replace=False)
    known = [KDTree(_differences(points, points[anchor], exactness_m)) for anchor in anchors[:3]]
    # Of three points of a copied part each pair shares the shift; one may lie outside of it.
    pairs = ((0, 1), (0, 2), (1, 2))
    shifts = np.concatenate([known[i].data[_are_among(known[i].data, known[j], exactness_m)] for i, j in pairs])
    if not len(shifts):
        return None
    known += [KDTree(_differences(points, points[anchor], exactness_m)) for anchor in anchors[3:]]
    votes = _votes(shifts, known, exactness_m)
    best = int(votes.argmax())
    if votes[best] < _LEAST_ANCHORS:
        return None
    sizes = np.abs(shifts).max(axis=1, keepdims=True)
    by_chance = max(_votes(shifts * (1.0 + k * exactness_m / sizes), known, exactness_m).max() for k in _BESIDE)
    return np.asarray(shifts[best]) if votes[best] > by_chance + _SHARED else None


def _differences(points: Floats, anchor: Floats, exactness_m: float) -> Floats:
    """Return the differences from a point to those around it, in both senses, by their first coordinate.

    The order settles which of several shifts with as many votes is taken.
    """
    near = points[np.abs(points[:, 0] - anchor[0]) <= _AROUND_M] - anchor
    size = np.abs(near).max(axis=1)
    near = near[(size <= _AROUND_M) & (size > 2.0 * exactness_m)]
    if len(near) > _MOST_AROUND:
        near = near[np.argpartition(np.abs(near).max(axis=1), _MOST_AROUND)[:_MOST_AROUND]]
    both = np.concatenate([near, -near])
    return np.asarray(both[np.argsort(both[:, 0])], dtype=np.float64)


def _votes(shifts: Floats, known: "Sequence[KDTree]", exactness_m: float) -> Ints:
    """Return for each shift how many of the anchors share it."""
    return np.asarray(np.sum([_are_among(shifts, tree, exactness_m) for tree in known], axis=0))


def _are_among(wanted: Floats, known: "KDTree", exactness_m: float) -> Bools:
    """Return for each of the differences whether it is one of the known ones."""
    apart, _ = known.query(wanted, p=np.inf, distance_upper_bound=2.0 * exactness_m)
    return np.asarray(apart <= exactness_m)


def find_mirrored_copy(scan: Scan) -> int | None:
    """Return the axis (0, 1, 2) of the file across whose zero a part of the cloud stands mirrored; None without one.

    Notes
    -----
    A point and its mirror image have the same three sizes of coordinates, so a sample that is drawn by these sizes
    holds both or neither.
    """
    if scan.origin_m.any():
        # In map coordinates nothing lies across zero.
        return None
    bits = np.ascontiguousarray(np.abs(scan.points[:, 0])).view(np.uint64)
    # The low bits of what was a float32 are zero.
    mixed = (bits ^ (bits >> np.uint64(29))) * np.uint64(0x9E3779B97F4A7C15)
    n_bits = max(0, min(_SAMPLE_BITS, len(bits).bit_length() - 13))
    some = scan.points[mixed >> np.uint64(64 - n_bits) == 0] if n_bits else scan.points
    sizes = np.abs(some)
    order = np.lexsort(sizes.T)
    is_same = (sizes[order[1:]] == sizes[order[:-1]]).all(axis=1)
    pairs = some[order[1:][is_same]], some[order[:-1][is_same]]
    if 2 * len(pairs[0]) < max(_FEWEST, _LEAST_MIRRORED * len(some)):
        return None
    is_mirrored = (pairs[0] == -pairs[1]) & (pairs[0] != 0.0)
    alone = is_mirrored.sum(axis=1) == 1
    counts = is_mirrored[alone].sum(axis=0)
    axis = int(counts.argmax())
    return axis if 2 * counts[axis] >= _LEAST_MIRRORED * len(some) else None
