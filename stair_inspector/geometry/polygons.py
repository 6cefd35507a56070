"""Polygons in space cut into triangles: convex ones from one corner, others ear by ear."""

from dataclasses import dataclass

import numpy as np

from stair_inspector.geometry.arrays import Bools, Floats, Ints

_MOST_WORK, _WORK_OF_TEST = 3_000_000, 100
"""What is spent in one call on trying corners as ears, each against all others: a second. A wall with all its windows
needs some thousands."""
_STRAIGHT = 1e-9
"""A turn of a smaller sine is none."""


@dataclass(frozen=True, slots=True, eq=False)
class Triangulation:
    """``triangles`` (k, 3): numbers of vertices; ``n_left_out`` polygons that cross themselves or are too intricate."""

    triangles: Ints
    n_left_out: int


def triangulate(vertices: Floats, corners: Ints, lengths: Ints) -> Triangulation:
    """Cut polygons into triangles.

    Parameters
    ----------
    vertices : (v, 3)
        Places.
    corners : (m,)
        Numbers of vertices, polygon after polygon, each within 0 to v - 1.
    lengths : (n,)
        Corners of each polygon; those with fewer than three have no area and give nothing. They sum up to m.

    Returns
    -------
    Triangulation
        The triangles have the polygons' order only among polygons of as many corners.
    """
    starts = np.cumsum(lengths) - lengths
    found: list[Ints] = []
    work_left = _MOST_WORK
    n_left_out = 0
    for length in np.unique(lengths[lengths >= 3]).tolist():
        rows = corners[starts[lengths == length][:, None] + np.arange(length)]
        if length > 3:
            places = vertices[rows]
            normals, is_convex = _convex(places)
            for row, place, normal in zip(rows[~is_convex], places[~is_convex], normals[~is_convex], strict=True):
                ears, work = _cut_ears(_flattened(place, normal), work_left)
                work_left -= work
                n_left_out += ears is None
                if ears is not None:
                    found.append(row[ears])
            rows = rows[is_convex]
        fan = np.stack([np.zeros(length - 2, dtype=np.int64), np.arange(1, length - 1), np.arange(2, length)], axis=1)
        found.append(rows[:, fan].reshape(-1, 3))
    return Triangulation(np.concatenate(found) if found else np.zeros((0, 3), dtype=np.int64), n_left_out)


def _convex(places: Floats) -> tuple[Floats, Bools]:
    """Return the normals (n, 3), of any length, of polygons (n, k, 3), and whether they turn one way throughout."""
    local = places - places[:, :1]
    after = np.roll(local, -1, axis=1)
    normals = np.cross(local, after).sum(axis=1)
    to_next = after - local
    turns = np.cross(np.roll(to_next, 1, axis=1), to_next)
    along = np.einsum("nkc,nc->nk", turns, normals)
    size = np.sqrt((normals * normals).sum(axis=1))[:, None]
    longest = (to_next * to_next).sum(axis=2).max(axis=1)[:, None]
    return normals, (along >= -_STRAIGHT * size * longest).all(axis=1)


def _flattened(places: Floats, normal: Floats) -> Floats:
    """Return a polygon (k, 3) in the plane (k, 2), counter-clockwise."""
    dropped = int(np.argmax(np.abs(normal)))
    first, second = (dropped + 1) % 3, (dropped + 2) % 3
    if normal[dropped] < 0.0:
        first, second = second, first
    flat: Floats = (places - places[0])[:, [first, second]]
    return flat


def _cut_ears(plane: Floats, most_work: int) -> tuple[Ints | None, int]:
    """Return triangles (k - 2, 3) of a counter-clockwise polygon (k, 2), None where none are found, and the work."""
    left = list(range(len(plane)))
    ears = []
    work, at, n_refused = 0, 0, 0
    while len(left) > 3:
        if n_refused >= len(left) or work >= most_work:
            return None, work
        k = len(left)
        work += k + _WORK_OF_TEST
        before, tip, after = left[at % k - 1], left[at % k], left[(at + 1) % k]
        if _is_ear(plane, before, tip, after, left):
            ears.append((before, tip, after))
            del left[at % k]
            n_refused = 0
        else:
            n_refused += 1
        at = (at + 1) % len(left)
    return np.array([*ears, left], dtype=np.int64), work


def _is_ear(plane: Floats, before: int, tip: int, after: int, left: list[int]) -> bool:
    """Return whether the triangle at a corner lies inside what is left of the polygon."""
    a, b, c = plane[before], plane[tip], plane[after]
    if _turn(a, b, c) < 0.0:
        return False
    others = plane[[each for each in left if each not in (before, tip, after)]]
    # Bridges to holes run to a corner twice: who lies on a corner of the ear is not in it.
    others = others[~((others == a).all(axis=1) | (others == b).all(axis=1) | (others == c).all(axis=1))]
    sides = np.stack([_turn(a, b, others), _turn(b, c, others), _turn(c, a, others)])
    return not bool((sides >= 0.0).all(axis=0).any())


def _turn(a: Floats, b: Floats, points: Floats) -> Floats:
    """Return on which side of the line from a to b points (..., 2) lie: positive on the left."""
    side: Floats = (b[0] - a[0]) * (points[..., 1] - a[1]) - (b[1] - a[1]) * (points[..., 0] - a[0])
    return side
