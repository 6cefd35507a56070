"""Normals and the plane of most points by numpy and SciPy, where Open3D cannot be loaded."""

import numpy as np

from stair_inspector.geometry.arrays import Floats, Ints

_PAIRS_AT_ONCE = 1_500_000
"""Points and neighbours that are taken together: 36 MB."""
_PLANES_AT_ONCE = 50


def normals_of_neighbours(points: Floats, k: int) -> Floats:
    """Return the normal of each point from its k nearest neighbours, itself included; all where there are fewer.

    Parameters
    ----------
    points : (n, 3), metres
        Any frame; distinct; quickest where neighbours in space follow each other.
    k : int
        Neighbours.

    Returns
    -------
    (n, 3)
        Unit vectors, sign free: the directions in which the neighbours vary least.
    """
    from scipy.spatial import KDTree

    tree = KDTree(points, balanced_tree=False, compact_nodes=False)
    k = min(k, len(points))
    normals = np.zeros_like(points)
    step = max(1, _PAIRS_AT_ONCE // k)
    for start in range(0, len(points), step):
        here = slice(start, start + step)
        _, near = tree.query(points[here], k=k, workers=-1)
        around = points[near.reshape(-1, k)]
        around -= around.mean(axis=1, keepdims=True)
        normals[here] = np.linalg.eigh(around.transpose(0, 2, 1) @ around)[1][:, :, 0]
    return normals


def plane_of_most(points: Floats, distance_m: float, n_trials: int, seed: int) -> tuple[Floats, float]:
    """Return the plane through three of the points that has most of them near it, fitted to those.

    Parameters
    ----------
    points : (n, 3), metres
        At least three, not on one line.
    distance_m : float
        A point counts that is nearer.
    n_trials, seed : int
        Planes that are tried; the same seed gives the same plane.

    Returns
    -------
    normal : (3,) unit vector
    offset : float
        ``normal @ p + offset`` is the distance of a point p, metres.

    Notes
    -----
    The triples are those that Open3D draws: another choice may take another plane where several have as many points.
    """
    centre = points.mean(axis=0)
    centred = points - centre
    first, second, third = centred[_draw_triples(len(points), n_trials, seed)].transpose(1, 0, 2)
    normals = np.cross(second - first, third - first)
    lengths = np.linalg.norm(normals, axis=1)
    is_plane = lengths > 0.0
    normals = normals[is_plane] / lengths[is_plane, None]
    offsets = -(normals * first[is_plane]).sum(axis=1)
    ranks: list[tuple[int, float, int]] = []
    for start in range(0, len(normals), _PLANES_AT_ONCE):
        here = slice(start, start + _PLANES_AT_ONCE)
        distances = np.abs(centred @ normals[here].T + offsets[here])
        is_near = distances < distance_m
        squares = (np.where(is_near, distances, 0.0) ** 2).sum(axis=0)
        ranks += zip(-is_near.sum(axis=0), squares, range(start, len(normals)), strict=False)
    best = min(ranks)[2]
    near = centred[np.abs(centred @ normals[best] + offsets[best]) < distance_m]
    middle = near.mean(axis=0)
    normal = _regression_normal(near - middle)
    return normal, float(-normal @ (middle + centre))


def _draw_triples(n: int, n_trials: int, seed: int) -> Ints:
    """Return triples (n_trials, 3) of distinct numbers below n, as C++ draws them from a Mersenne twister."""
    # The old generator of numpy is the one whose stream is that of C++; the new one seeds it otherwise.
    words = np.random.RandomState(seed)
    refused = 2**32 % n
    drawn: list[list[int]] = []
    triple: list[int] = []
    while len(drawn) < n_trials:
        for word in words.randint(0, 2**32, 3 * n_trials, dtype=np.uint32).tolist():
            number, low = divmod(word * n, 2**32)
            if low >= refused and number not in triple:
                triple.append(number)
            if len(triple) == 3:
                drawn.append(triple)
                triple = []
    return np.array(drawn[:n_trials])


def _regression_normal(centred: Floats) -> Floats:
    """Return the unit normal of the plane from which points (n, 3) around zero differ least along one of the axes.

    The axis is the one along which the plane is seen most square on.
    """
    scatter = centred.T @ centred
    cofactors = np.array(
        [
            np.cross(scatter[(k + 1) % 3], scatter[(k + 2) % 3])  # Square to two rows: the third is left over.
            for k in range(3)
        ]
    )
    found: Floats = cofactors[np.argmax(np.diag(cofactors))]
    return found / np.linalg.norm(found)
