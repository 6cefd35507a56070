"""Does a cloud hold itself twice, shifted or mirrored?

Only exact copies are told, number by number: two scans of one object never agree so. Whether a whole scan is
left-handed cannot be seen in it.
"""

import numpy as np

from stair_inspector.geometry.arrays import Bools, Floats
from stair_inspector.model import Scan
from stair_inspector.stages.coordinate_steps import FLOAT32

_AROUND_M = 0.1
"""A copy that is shifted farther is another object to the eye, and is seen."""
_ANCHORS = 8
_MOST_AROUND = 3000
_LEAST_ANCHORS = 5
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
    a point and those around it, two points share none by chance.
    """
    if len(points) < _FEWEST:
        return None
    exactness_m = 4.0 * FLOAT32 * float(np.abs(points).max())
    anchors = np.random.default_rng(11).choice(len(points), _ANCHORS, replace=False)
    known: list[Floats] = []
    for count, anchor in enumerate(anchors):
        around = _differences(points, points[anchor], exactness_m)
        if count < 3:
            known.append(around)
            continue
        if count == 3:
            # Of three points of a copied part each pair shares the shift; one may lie outside of it.
            pairs = ((0, 1), (0, 2), (1, 2))
            shifts = np.concatenate([_common(known[i], known[j], exactness_m) for i, j in pairs])
            if not len(shifts):
                return None
            votes = np.sum([_is_among(shifts, other, exactness_m) for other in known], axis=0)
        votes += _is_among(shifts, around, exactness_m)
    best = int(votes.argmax())
    return shifts[best] if votes[best] >= _LEAST_ANCHORS else None


def _differences(points: Floats, anchor: Floats, exactness_m: float) -> Floats:
    """Return the differences from a point to those around it, in both senses, by their first coordinate."""
    near = points[np.abs(points[:, 0] - anchor[0]) <= _AROUND_M] - anchor
    size = np.abs(near).max(axis=1)
    near = near[(size <= _AROUND_M) & (size > 2.0 * exactness_m)]
    if len(near) > _MOST_AROUND:
        near = near[np.argpartition(np.abs(near).max(axis=1), _MOST_AROUND)[:_MOST_AROUND]]
    both = np.concatenate([near, -near])
    return np.asarray(both[np.argsort(both[:, 0])], dtype=np.float64)


def _common(one: Floats, other: Floats, exactness_m: float) -> Floats:
    return one[_is_among(one, other, exactness_m)]


def _is_among(wanted: Floats, known: Floats, exactness_m: float) -> Bools:
    """Return for each of the differences whether it is one of the known ones, which are sorted."""
    first = np.searchsorted(known[:, 0], wanted[:, 0] - exactness_m)
    stop = np.searchsorted(known[:, 0], wanted[:, 0] + exactness_m, side="right")
    row = np.repeat(np.arange(len(wanted)), stop - first)
    column = np.arange(len(row)) - np.repeat(np.cumsum(stop - first) - (stop - first), stop - first) + first[row]
    same = (np.abs(known[column] - wanted[row]) <= exactness_m).all(axis=1)
    found = np.zeros(len(wanted), dtype=np.bool_)
    found[row[same]] = True
    return found


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
