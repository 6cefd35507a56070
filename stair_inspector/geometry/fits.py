"""Planes and directions by least squares and by RANSAC."""

import math
from dataclasses import dataclass

import numpy as np

from stair_inspector.errors import DegenerateGeometry
from stair_inspector.geometry.arrays import Floats, project, scatter_of
from stair_inspector.geometry.neighbours import plane_of_most
from stair_inspector.geometry.open3d import find_open3d

_LINE_RATIO = 1e-6
"""Second singular value over first below which points count as lying on one line."""
_RANSAC_SEED = 0
_RANSAC_ITERATIONS = 1000
_RANSAC_POINTS = 15_000
"""RANSAC draws from at most this many points; the least-squares refit then uses all."""


@dataclass(frozen=True, slots=True, eq=False)
class PlaneFit:
    """A least-squares plane: ``centroid`` (3,), unit ``normal`` (3,), RMS of the signed distances in metres.

    ``normal`` and ``rms_m`` are None when the points lie on one line or are fewer than three.
    """

    centroid: Floats
    normal: Floats | None
    rms_m: float | None
    n_points: int


def fit_plane(points: Floats, upwards: Floats) -> PlaneFit:
    """Fit a plane by total least squares, the normal on the side of ``upwards``.

    Parameters
    ----------
    points : (n, 3), metres, any frame
        At least one point.
    upwards : (3,)
        Direction with which the normal makes an acute angle.

    Returns
    -------
    PlaneFit
        With ``normal`` and ``rms_m`` None for fewer than three points or points on one line.
    """
    return fit_plane_rows(np.ascontiguousarray(points.T), upwards)[0]


def fit_plane_rows(rows: Floats, upwards: Floats) -> tuple[PlaneFit, Floats]:
    """Fit a plane as :func:`fit_plane` does, to coordinates given as rows (3, n); return its scatter matrix too.

    Notes
    -----
    The singular vectors of the centred n x 3 matrix are those of its 3 x 3 scatter matrix, which is decomposed here:
    the same plane at a thirtieth of the cost. The RMS is taken from the residuals themselves, not from the smallest
    singular value, whose square root loses half the digits.
    """
    n = rows.shape[1]
    centroid = rows.mean(axis=1)
    centred = rows - centroid[:, None]
    scatter = scatter_of(centred)
    _, singular, vectors = np.linalg.svd(scatter)
    # The scatter matrix has the squares of the singular values.
    if n < 3 or not singular[1] > singular[0] * _LINE_RATIO**2:
        return PlaneFit(centroid=centroid, normal=None, rms_m=None, n_points=n), scatter
    normal = vectors[2] if vectors[2] @ upwards >= 0.0 else -vectors[2]
    rms_m = math.sqrt(float(np.mean(project(centred, normal) ** 2)))
    return PlaneFit(centroid, normal, rms_m, n), scatter


def spread_rank(points: Floats) -> int:
    """Return 0, 1, 2 or 3: whether points coincide, lie on one line, in one plane, or fill space."""
    # Measured from the first point, so that points that coincide are zero and not a rounded mean away from it.
    rows = np.ascontiguousarray((points - points[0]).T)
    scatter = scatter_of(rows - rows.mean(axis=1)[:, None])
    singular = np.sqrt(np.linalg.svd(scatter, compute_uv=False))
    if singular[0] == 0.0:
        return 0
    return int(np.count_nonzero(singular > singular[0] * _LINE_RATIO))


def find_plane_ransac(points: Floats, distance_m: float) -> PlaneFit:
    """Find the plane that holds most points, then fit it to all of them.

    Parameters
    ----------
    points : (n, 3), metres, any frame
        At least three points that do not lie on one line.
    distance_m : float
        Largest distance of a point that belongs to the plane.

    Returns
    -------
    PlaneFit
        Least-squares plane of the inliers among all points, normal with a positive largest component.

    Raises
    ------
    DegenerateGeometry
        No plane: fewer than three points, or all on one line.

    Notes
    -----
    Open3D's RANSAC with a fixed seed and no early exit, so that the same points give the same plane; where it cannot
    be loaded, one of numpy.
    """
    if len(points) < 3 or spread_rank(points) < 2:
        raise DegenerateGeometry(f"a plane needs three points that are not on one line, got {len(points)} points")
    o3d = find_open3d()
    stride = -(-len(points) // _RANSAC_POINTS)
    if o3d is None:
        normal, offset = plane_of_most(points[::stride], distance_m, _RANSAC_ITERATIONS, _RANSAC_SEED)
    else:
        cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points[::stride].copy()))
        o3d.utility.random.seed(_RANSAC_SEED)
        model, _ = cloud.segment_plane(distance_m, ransac_n=3, num_iterations=_RANSAC_ITERATIONS, probability=1.0)
        normal = np.array(model[:3]) / np.linalg.norm(model[:3])
        offset = model[3] / np.linalg.norm(model[:3])
    inliers = points[np.abs(points @ normal + offset) <= distance_m]
    upwards = normal * np.sign(normal[np.argmax(np.abs(normal))])
    plane = fit_plane(inliers, upwards) if len(inliers) >= 3 else None
    if plane is None or plane.normal is None:
        raise DegenerateGeometry(f"no plane holds three of the {len(points)} points within {distance_m * 1000:g} mm")
    return plane


def principal_axis(scatter: Floats) -> tuple[Floats, float]:
    """Return the direction of largest variance of a 2 x 2 scatter matrix and the ratio of the two variances.

    Returns
    -------
    axis : (2,) unit vector, sign free
    ratio : float
        Smaller over larger variance, 0 to 1; near 1 the direction means nothing.
    """
    values, vectors = np.linalg.eigh(scatter)
    ratio = float(max(values[0], 0.0) / values[1]) if values[1] > 0.0 else 1.0
    return vectors[:, 1], ratio
