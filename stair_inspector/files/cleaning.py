"""From a cloud as the file has it to a scan in metres near zero: unit, origin, and which points to keep."""

import numpy as np
from numpy.typing import NDArray

from stair_inspector.errors import ReadError
from stair_inspector.geometry.arrays import Floats, Ints
from stair_inspector.params import KnownUnit
from stair_inspector.units import METRES_PER_UNIT

_NEAR_M = 1000.0
_FARTHEST_M = 1e9
_FARTHEST_IN_FILE = 1e12
"""Beyond this, coordinates are garbage in every unit."""


def check_range(points: Floats) -> None:
    """Check that coordinates in the file's unit are not garbage in any unit.

    Raises
    ------
    ReadError
        Beyond 1e12.
    """
    _check_farthest(points, _FARTHEST_IN_FILE, "")


def to_local_metres(points: Floats, unit: KnownUnit) -> tuple[Floats, Floats]:
    """Convert coordinates to metres and subtract an origin.

    Parameters
    ----------
    points : (n, 3), file unit
        Finite, at least one.
    unit : str
        A unit of METRES_PER_UNIT.

    Returns
    -------
    local : (n, 3), metres
        ``local + origin_m`` is the file's coordinate times the unit, to the rounding of float64. No -0.0.
    origin_m : (3,)
        Zero where every coordinate is within 1000 m of zero, so that small scans keep their numbers; otherwise the
        median of each axis in whole metres, which stray points do not move and which float64 subtracts exactly.

    Raises
    ------
    ReadError
        A coordinate beyond 1e9 m.
    """
    metres = points * METRES_PER_UNIT[unit]
    _check_farthest(metres, _FARTHEST_M, " m")
    is_near = np.abs(metres).max() < _NEAR_M
    origin_m = np.zeros(3) if is_near else np.rint(np.median(metres, axis=0))
    # Adding 0.0 turns -0.0 into 0.0: the same place, but other bits.
    return metres - origin_m + 0.0, origin_m + 0.0


def _check_farthest(points: Floats, limit: float, unit: str) -> None:
    farthest = float(np.abs(points).max())
    if farthest > limit:
        raise ReadError(
            f"has a coordinate of {farthest:.3g}{unit}, beyond {limit:.0e}{unit}; "
            "the file is damaged or not a scan, export it again"
        )


def first_occurrences(points: Floats) -> NDArray[np.bool_]:
    """Mark the first of each group of points at exactly the same position.

    Parameters
    ----------
    points : (n, 3), contiguous
        Finite, without -0.0.

    Returns
    -------
    (n,) bool

    Notes
    -----
    Sorts one 64-bit hash of each point instead of three coordinates, which takes a third of the time, and compares
    the coordinates of equal neighbours; should two different points ever share a hash, it sorts the coordinates.
    """
    code = _hash(points)
    order: Ints = np.argsort(code, kind="stable")
    follows = code[order[1:]] == code[order[:-1]]
    repeats, before = order[1:][follows], order[:-1][follows]
    if not (points[repeats] == points[before]).all():
        order = np.lexsort(points.T)
        repeats = order[1:][(points[order[1:]] == points[order[:-1]]).all(axis=1)]
    keep = np.ones(len(points), dtype=np.bool_)
    keep[repeats] = False
    return keep


def count_repeats(points: Floats, is_first: NDArray[np.bool_]) -> Ints:
    """Return how often each of the points that :func:`first_occurrences` marks occurs, in their order."""
    order = np.lexsort(points.T)
    begins = np.concatenate([[True], (points[order[1:]] != points[order[:-1]]).any(axis=1)])
    group_of = np.zeros(len(points), dtype=np.int64)
    group_of[order] = np.cumsum(begins) - 1
    counts: Ints = np.bincount(group_of).take(group_of[is_first])
    return counts


def _hash(points: Floats) -> NDArray[np.uint64]:
    """Mix the bits of three coordinates; coordinates from float32 have 29 low zeros, hence the shifts."""
    code = np.zeros(len(points), dtype=np.uint64)
    for column in np.ascontiguousarray(points).view(np.uint64).T:
        code ^= column ^ (column >> np.uint64(32))
        code *= np.uint64(0x9E3779B97F4A7C15)
        code ^= code >> np.uint64(29)
    return code


def unit_normals(normals: Floats) -> Floats | None:
    """Scale normals (n, 3) to unit length; None where one of them is zero or not finite."""
    largest = np.abs(normals).max(axis=1, keepdims=True)
    if not np.isfinite(largest).all() or not largest.all():
        return None
    # Scaling first keeps the squares of very large and very small components in range.
    scaled: Floats = normals / largest
    unit: Floats = scaled / np.linalg.norm(scaled, axis=1, keepdims=True)
    return unit
