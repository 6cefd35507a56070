"""Points spread evenly over triangles: as many on each square metre, whichever way a triangle is turned or wound.

Takes corners, gives points. It halves triangles at their longest edge, so that every point has a piece of its own of
nearly the same area, neither thin nor far from its neighbours'.
"""

import math

import numpy as np

from stair_inspector.geometry.arrays import Bools, Floats, Ints

_SEED = 7
_SAME_NORMAL = 0.002
"""Faces of one flat surface agree in each part of their unit normals to so much: a model's to their rounding."""
_FLAT_SURFACES = 30
_FLAT_SHARE = 0.5
"""Where so few directions hold so much of the area, the mesh is a model."""
_OWN_POINTS = 100_000
"""So many points a triangle may ask for before it is thinned out for the others' sake: no surface of a stair does."""


def areas_of(corners: Floats) -> Floats:
    """Return the areas (n,) of triangles (n, 3, 3)."""
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area: Floats = 0.5 * np.sqrt((across * across).sum(axis=1))
    return area


def facet_of(corners: Floats, areas: Floats) -> float | None:
    """Return the median length of a scanned mesh's edges; None of a model, whose corners stand where its edges are.

    A model's surfaces are flat: a few directions hold most of its area, to the rounding of its corners. The faces of a
    scanned mesh each have their own.

    Parameters
    ----------
    corners : (n, 3, 3), any unit
        Of the triangles.
    areas : (n,)
        Of them, positive.
    """
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / (2.0 * areas[:, None])
    # However they are wound: the two sides of a face are one direction.
    across *= np.where(across[np.arange(len(across)), np.abs(across).argmax(axis=1)] < 0.0, -1.0, 1.0)[:, None]
    _, of_direction = np.unique(np.rint(across / _SAME_NORMAL).astype(np.int64), axis=0, return_inverse=True)
    shares = np.sort(np.bincount(of_direction.ravel(), weights=areas))
    if shares[-_FLAT_SURFACES:].sum() >= _FLAT_SHARE * shares.sum():
        return None
    return float(np.median(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)))


def in_fixed_order(corners: Floats) -> Ints:
    """Return the order (n, 3) of the corners (n, 3, 3) of a triangle by x, then y, then z: the same however wound."""
    order = np.lexsort((corners[:, :, 2], corners[:, :, 1], corners[:, :, 0]), axis=1)
    return order.astype(np.int64)


def find_distinct(corners: Floats) -> Bools:
    """Mark the first (n,) of the triangles (n, 3, 3), corners in a fixed order, that have the same corners."""
    rows = corners.reshape(len(corners), 9)
    order = np.lexsort(rows.T)
    is_repeat = (rows[order[1:]] == rows[order[:-1]]).all(axis=1)
    is_distinct = np.ones(len(rows), dtype=np.bool_)
    is_distinct[order[1:][is_repeat]] = False
    return is_distinct


def points_per_triangle(areas: Floats, spacing: float, most: int) -> Floats:
    """Return how many points (n,), not whole numbers, each triangle gets.

    Parameters
    ----------
    areas : (n,), square of any unit
        Positive.
    spacing : float, that unit
        Edge of the square that each point stands for.
    most : int
        Points of all triangles together. Where they would be more, the largest triangles are thinned out first, such as
        the ground around a building; where that is not enough, all are.
    """
    wanted = areas / (spacing * spacing)
    if wanted.sum() <= most:
        return wanted
    ordered = np.sort(wanted)
    # If the largest n - k are cut to the k-th, this many points remain.
    remaining = np.cumsum(ordered) - ordered + ordered * np.arange(len(ordered), 0, -1)
    k = int(np.searchsorted(remaining, most, side="right"))
    whole = float(ordered[:k].sum())
    own = max((most - whole) / (len(ordered) - k) if k < len(ordered) else math.inf, float(_OWN_POINTS))
    cut = np.minimum(wanted, own)
    return cut * min(1.0, most / float(cut.sum()))


def sample_triangles(values: Floats, per_triangle: Floats) -> tuple[Floats, Ints]:
    """Return points spread evenly over triangles.

    Parameters
    ----------
    values : (n, 3, d)
        x, y, z of each corner, and whatever else it has, such as colours, which is interpolated. Corners in a fixed
        order, see :func:`in_fixed_order`.
    per_triangle : (n,)
        Points each shall have; a triangle of 0.25 has one in a row of four such.

    Returns
    -------
    points : (m, d), m the sum of ``per_triangle``, at least 1
        In the order of the triangles; the same for the same input.
    on : (m,)
        The triangle of each.

    Notes
    -----
    Laid end to end, the triangles are a line on which each point has a stretch of its own, and lies anywhere in it. Its
    place on the line picks the triangle, and which half of it, and of that half, until the piece is as small as a
    point's share; there it lies anywhere. A regular lattice would be easier, and would be found as a step of the
    coordinates.
    """
    ends = np.cumsum(per_triangle)
    count = max(1, round(float(ends[-1])))
    chance = np.random.default_rng(_SEED).random((count, 3))
    along = (np.arange(count) + chance[:, 0]) * (ends[-1] / count)
    which = np.minimum(np.searchsorted(ends, along, side="right"), len(ends) - 1)
    share = per_triangle[which]
    part = np.clip((along - (ends[which] - share)) / share, 0.0, 1.0 - 1e-12)
    # The root makes it even in the triangle.
    root, other = np.sqrt(chance[:, 1]), chance[:, 2]
    weights = np.stack([1.0 - root, root * (1.0 - other), root * other], axis=1)
    found = np.zeros((count, values.shape[2]))
    n_halvings = np.ceil(np.log2(np.maximum(per_triangle, 1.0))).astype(np.int64)
    for halvings in np.unique(n_halvings).tolist():
        of_these = n_halvings == halvings
        pieces = values[of_these]
        for _ in range(halvings):
            pieces = _halve(pieces)
        rows = np.flatnonzero(of_these[which])
        row_of = np.cumsum(of_these) - 1
        own = (row_of[which[rows]] << halvings) + (part[rows] * (1 << halvings)).astype(np.int64)
        found[rows] = np.einsum("kc,kcd->kd", weights[rows], pieces[own])
    return found, which


def _halve(pieces: Floats) -> Floats:
    """Cut triangles (k, 3, d) at the middle of their longest edge: (2 k, 3, d), the halves of each together."""
    rows = np.arange(len(pieces))
    edges = pieces[:, [1, 2, 0], :3] - pieces[:, [2, 0, 1], :3]
    apex = (edges * edges).sum(axis=2).argmax(axis=1)
    first, second = (apex + 1) % 3, (apex + 2) % 3
    middle = 0.5 * (pieces[rows, first] + pieces[rows, second])
    halves = np.repeat(pieces, 2, axis=0)
    halves[2 * rows, second] = middle
    halves[2 * rows + 1, first] = middle
    return halves
