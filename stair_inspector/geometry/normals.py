"""Surface normals from nearest neighbours, at a third of the usual time."""

import numpy as np

from stair_inspector.geometry.arrays import Floats, Ints
from stair_inspector.geometry.neighbours import normals_of_neighbours
from stair_inspector.geometry.open3d import find_open3d

_CELL_M = 0.02
_MORTON_BITS = 21


def morton_order(points: Floats) -> Ints:
    """Return the order of points along a Z-order curve through cubic cells of 20 mm, larger where the extent needs it.

    Parameters
    ----------
    points : (n, 3), metres
        Any frame.

    Returns
    -------
    (n,) int64
        Indices; points of one cell keep their order.
    """
    low = points.min(axis=0)
    cell = max(_CELL_M, float((points.max(axis=0) - low).max()) / (2**_MORTON_BITS - 1))
    cells = ((points - low) / cell).astype(np.uint64)
    code = _spread(cells[:, 0]) | _spread(cells[:, 1]) << np.uint64(1) | _spread(cells[:, 2]) << np.uint64(2)
    return np.argsort(code, kind="stable")


def _spread(values: "np.ndarray[tuple[int], np.dtype[np.uint64]]") -> "np.ndarray[tuple[int], np.dtype[np.uint64]]":
    """Insert two zero bits between the 21 low bits of each value."""
    for shift, mask in (
        (32, 0x1F00000000FFFF),
        (16, 0x1F0000FF0000FF),
        (8, 0x100F00F00F00F00F),
        (4, 0x10C30C30C30C30C3),
        (2, 0x1249249249249249),
    ):
        values = (values | values << np.uint64(shift)) & np.uint64(mask)
    return values


def estimate_normals(points: Floats, k: int) -> Floats:
    """Estimate the normal at each point from its k nearest neighbours, itself included.

    Parameters
    ----------
    points : (n, 3), metres
        Any frame; distinct.
    k : int
        Neighbours.

    Returns
    -------
    (n, 3)
        Unit vectors, sign free; zero vectors never occur.

    Notes
    -----
    Open3D's k-nearest-neighbour normals. Its search is several times faster when neighbours in space are neighbours
    in memory, so the points are sorted along a Z-order curve first and the normals put back; the result is the same.
    Where it cannot be loaded, a k-d tree and eigenvectors give the same normals but for ties of neighbours.
    """
    order = morton_order(points)
    normals = np.zeros_like(points)
    o3d = find_open3d()
    if o3d is None:
        normals[order] = normals_of_neighbours(points[order], k)
        return normals
    cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points[order]))
    cloud.estimate_normals(o3d.geometry.KDTreeSearchParamKNN(k))
    normals[order] = np.asarray(cloud.normals)
    return normals


def estimate_normals_at(points: Floats, places: Ints, k: int) -> Floats:
    """Estimate the normals at some points from the k nearest of all of them, quickly where they are few.

    Parameters
    ----------
    points : (n, 3), metres
        Any frame.
    places : (m,)
        Indices of the points whose normals are wanted.
    k : int
        Neighbours, the point itself included; fewer where there are fewer.

    Returns
    -------
    (m, 3)
        Unit vectors, sign free.
    """
    from sklearn.neighbors import KDTree

    near = KDTree(points).query(points[places], k=min(k, len(points)), return_distance=False)
    around = points[near]
    around -= around.mean(axis=1, keepdims=True)
    smallest: Floats = np.linalg.eigh(around.transpose(0, 2, 1) @ around)[1][:, :, 0]
    return np.ascontiguousarray(smallest)
