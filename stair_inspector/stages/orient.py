"""Which way is up, how is every point's surface turned, and how high is it?"""

import math

import numpy as np

from stair_inspector.errors import CannotMeasure, ConfigError, DegenerateGeometry
from stair_inspector.geometry.arrays import Floats, freeze, own, project
from stair_inspector.geometry.clusters import cluster_sorted, find_reach
from stair_inspector.geometry.fits import PlaneFit, find_plane_ransac, spread_rank
from stair_inspector.geometry.normals import estimate_normals
from stair_inspector.model import HeightOrder, Normals, Note, Scan, Up
from stair_inspector.params import FloorParams, NormalsParams, parse_up

_MIN_POINTS = 50
"""Below this a scan has no surface to speak of."""
_MAX_FLOOR_CANDIDATES = 4
_CANDIDATE_SHARE = 0.3
"""A plane with less than this share of the largest plane's points is not tried as the floor."""
_LEVEL_TOLERANCE_DEG = 15.0
_LEVEL_EPS_M = 0.02
_LEVEL_SHARE = 0.005
"""A level parallel to the floor counts when it holds at least this share of the scan."""
_LEANING_DEG = 45.0


def find_normals(scan: Scan, params: NormalsParams) -> Normals:
    """Give every point a normal: estimated from its neighbours (step 1 of the paper), or the file's own.

    Parameters
    ----------
    scan : Scan
        At least 50 distinct points that are not on one line.
    params : NormalsParams
        Neighbours and source.

    Raises
    ------
    CannotMeasure
        Too few points, or all on one line.
    ConfigError
        Given normals are asked for and the file has none.
    """
    if len(scan.points) < _MIN_POINTS:
        count = len(scan.points)
        raise CannotMeasure(
            f"{scan.name}: {count} distinct point{'' if count == 1 else 's'}, at least {_MIN_POINTS} are needed; "
            "scan again or check the file"
        )
    if spread_rank(scan.points) < 2:
        raise CannotMeasure(f"{scan.name}: all {len(scan.points)} points lie on one line; check the file's columns")
    if params.source == "given":
        if scan.normals is None:
            raise ConfigError(f"normals.source: {scan.name} holds no normals; use 'estimate'")
        return Normals(scan.normals)
    return Normals(freeze(estimate_normals(scan.points, params.k)))


def find_up(scan: Scan, normals: Normals, up: str, params: FloorParams) -> Up:
    """Return the up vector: given by the user, or the normal of the RANSAC floor plane (step 1 of the paper).

    Notes
    -----
    RANSAC finds planes, not floors: in a narrow stairwell the largest plane is a wall. Up to four planes are taken
    out one after the other, and the floor is the one to which most separate levels lie parallel; where that is the
    largest plane, the result is the paper's. A plane has no upper side either: where its normal is within 45 degrees
    of the scan's z axis, up is on the side of +z; elsewhere it is the side on which most of the scan lies.

    Raises
    ------
    CannotMeasure
        No plane is found.
    """
    given = parse_up(up)
    if given is not None:
        return Up(own(given, (3,), "up"), "given")
    try:
        candidates = _find_planes(scan.points, params.distance_m)
    except DegenerateGeometry as error:
        raise CannotMeasure(
            f"{scan.name}: no floor found ({error}); give the up direction, for example --up z"
        ) from error
    levels = [_count_levels(scan.points, normals.vectors, plane) for plane in candidates]
    chosen = int(np.argmax(levels))
    vector, notes = _turn_upwards(scan.points, candidates[chosen].centroid, _normal(candidates[chosen]))
    if chosen > 0:
        message = (
            f"the floor is not the largest plane: a plane with {candidates[0].n_points:,} points has {levels[0]} "
            f"levels parallel to it, the one taken has {candidates[chosen].n_points:,} points and {levels[chosen]}"
        )
        notes = (Note("floor_not_largest", "orient", message), *notes)
    return Up(own(vector, (3,), "up"), "floor", notes=notes)


def order_by_height(scan: Scan, normals: Normals, up: Up) -> HeightOrder:
    """Sort the points by height along ``up``, with plan coordinates and |n . u| in the same order.

    Returns
    -------
    HeightOrder
        z_i = <p_i, u> (step 3 of the paper), metres, local.
    """
    u = up.vector
    least = np.zeros(3)
    least[np.argmin(np.abs(u))] = 1.0
    first = least - (least @ u) * u
    first /= np.linalg.norm(first)
    level_from_scan = np.stack([first, np.cross(u, first), u])
    rows = np.ascontiguousarray(scan.points.T)
    coordinates = np.stack([project(rows, axis) for axis in level_from_scan])
    order = np.argsort(coordinates[2], kind="stable")
    return HeightOrder(
        point_ids=freeze(order),
        alignment=freeze(np.abs(project(normals.vectors.T, u))[order]),
        coordinates_m=freeze(coordinates[:, order]),
        level_from_scan=own(level_from_scan, (3, 3), "level_from_scan"),
        up=up,
    )


def _find_planes(points: Floats, distance_m: float) -> list[PlaneFit]:
    """Return the largest plane and those after it, each found in what the earlier ones left."""
    planes = [find_plane_ransac(points, distance_m)]
    rest = points
    while len(planes) < _MAX_FLOOR_CANDIDATES:
        rest = rest[np.abs((rest - planes[-1].centroid) @ _normal(planes[-1])) > distance_m]
        if len(rest) < _CANDIDATE_SHARE * planes[0].n_points or len(rest) < _MIN_POINTS or spread_rank(rest) < 2:
            break
        plane = find_plane_ransac(rest, distance_m)
        if plane.n_points < _CANDIDATE_SHARE * planes[0].n_points:
            break
        planes.append(plane)
    return planes


def _count_levels(points: Floats, normals: Floats, plane: PlaneFit) -> int:
    """Count the separate levels of surface parallel to a plane."""
    normal = _normal(plane)
    is_parallel = np.abs(normals @ normal) >= math.cos(math.radians(_LEVEL_TOLERANCE_DEG))
    heights = np.sort(points[is_parallel] @ normal)
    if heights.size == 0:
        return 0
    wanted = max(_MIN_POINTS, int(_LEVEL_SHARE * len(points)))
    clusters = cluster_sorted(find_reach(heights, _LEVEL_EPS_M), wanted)
    return len(clusters.start)


def _turn_upwards(points: Floats, on_plane: Floats, normal: Floats) -> tuple[Floats, tuple[Note, ...]]:
    """Choose the side of a plane that is up."""
    share_above = float(np.mean((points - on_plane) @ normal > 0.0))
    if abs(normal[2]) < math.cos(math.radians(_LEANING_DEG)):
        up = normal if share_above >= 0.5 else -normal
        message = (
            f"the floor found is not square to the scan's z axis; up is taken as "
            f"({up[0]:.3f}, {up[1]:.3f}, {up[2]:.3f}), the side on which most points lie; give --up if that is wrong"
        )
        return up, (Note("up_not_z", "orient", message),)
    up = normal if normal[2] > 0.0 else -normal
    share_above = share_above if up is normal else 1.0 - share_above
    if share_above < 0.2:
        message = (
            f"{1.0 - share_above:.0%} of the points lie below the plane from which up was taken: it may be a ceiling; "
            "the direction is the same, but check it, and give --up -z if the scan's z axis points down"
        )
        return up, (Note("floor_above_scan", "orient", message),)
    return up, ()


def _normal(plane: PlaneFit) -> Floats:
    if plane.normal is None:
        raise DegenerateGeometry("the plane's points lie on one line")
    return plane.normal
