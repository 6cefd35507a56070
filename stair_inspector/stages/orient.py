"""Which way is up, how is every point's surface turned, and how high is it?"""

import math

import numpy as np

from stair_inspector.errors import CannotMeasure, ConfigError, DegenerateGeometry
from stair_inspector.geometry.arrays import Floats, freeze, own, project
from stair_inspector.geometry.clusters import cluster_sorted, find_reach
from stair_inspector.geometry.fits import PlaneFit, find_plane_ransac, spread_rank
from stair_inspector.geometry.normals import estimate_normals
from stair_inspector.model import HeightOrder, Normals, Note, Scan, Up
from stair_inspector.params import FloorParams, Method, NormalsParams, parse_up

_MIN_POINTS = 50
"""Below this a scan has no surface to speak of."""
_MAX_FLOOR_CANDIDATES = 6
_CANDIDATE_SHARE = 0.05
"""A plane with less than this share of the largest plane's points is not tried as the floor."""
_LEVEL_TOLERANCE_DEG = 15.0
_LEVEL_EPS_M = 0.02
_LEVEL_SHARE = 0.01
"""A level parallel to a plane counts when it holds at least this share of the points that face the same way."""
_LEANING_DEG = 45.0
_CEILING_SHARE = 0.8
"""Share of the points off the plane that lie below it, above which it is no floor."""
_LEVELLED_DEG = 20.0
_LEVELLED_BONUS = 2.0
"""Most scans are made with z up: a plane that leans less than this from level counts double."""


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


def find_up(scan: Scan, normals: Normals, up: str, params: FloorParams, method: Method) -> Up:
    """Return the up vector: given by the user, or the normal of the RANSAC floor plane (step 1 of the paper).

    Notes
    -----
    With the paper's method the floor is the largest plane, whatever it is. In a narrow stairwell that is a wall. With
    the survey's, up to six planes are taken out one after the other, and the floor is the one that faces the way of
    most points and most separate levels; a plane that is level in the scan's own frame counts double.

    A plane has no upper side: where its normal is within 45 degrees of the scan's z axis, up is on the side of +z;
    elsewhere it is the side on which most of the scan lies.

    Raises
    ------
    CannotMeasure
        No plane is found.
    """
    given = parse_up(up)
    if given is not None:
        return Up(own(given, (3,), "up"), "given")
    try:
        wanted = 1 if method == "paper" else _MAX_FLOOR_CANDIDATES
        candidates = _find_planes(scan.points, params.distance_m, wanted)
    except DegenerateGeometry as error:
        raise CannotMeasure(
            f"{scan.name}: no floor found ({error}); give the up direction, for example --up z"
        ) from error
    support = [_count_levels(scan.points, normals.vectors, plane) for plane in candidates]
    chosen = _choose_floor(candidates, support)
    vector, notes = _turn_upwards(scan.points, candidates[chosen], params.distance_m)
    if chosen > 0:
        message = (
            f"the floor is not the largest plane: a plane with {candidates[0].n_points:,} points has {support[0][0]} "
            f"levels parallel to it, the one taken has {candidates[chosen].n_points:,} points and {support[chosen][0]}"
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
        coordinates_m=freeze(coordinates.take(order, axis=1)),
        level_from_scan=own(level_from_scan, (3, 3), "level_from_scan"),
        up=up,
    )


def _find_planes(points: Floats, distance_m: float, wanted: int) -> list[PlaneFit]:
    """Return the largest plane and those after it, each found in what the earlier ones left."""
    planes = [find_plane_ransac(points, distance_m)]
    rest = points
    while len(planes) < wanted:
        rest = rest[np.abs((rest - planes[-1].centroid) @ _normal(planes[-1])) > distance_m]
        if len(rest) < _CANDIDATE_SHARE * planes[0].n_points or len(rest) < _MIN_POINTS or spread_rank(rest) < 2:
            break
        plane = find_plane_ransac(rest, distance_m)
        if plane.n_points < _CANDIDATE_SHARE * planes[0].n_points:
            break
        planes.append(plane)
    return planes


def _count_levels(points: Floats, normals: Floats, plane: PlaneFit) -> tuple[int, int]:
    """Count the separate levels of surface parallel to a plane, and the points that face its way."""
    normal = _normal(plane)
    is_parallel = np.abs(normals @ normal) >= math.cos(math.radians(_LEVEL_TOLERANCE_DEG))
    heights = np.sort(points[is_parallel] @ normal)
    if heights.size == 0:
        return 0, 0
    wanted = max(_MIN_POINTS, int(_LEVEL_SHARE * heights.size))
    clusters = cluster_sorted(find_reach(heights, _LEVEL_EPS_M), wanted)
    return len(clusters.start), heights.size


def _choose_floor(candidates: list[PlaneFit], support: list[tuple[int, int]]) -> int:
    """Return the index of the floor among planes, given the levels parallel to each and the points that face its way.

    A stair has many levels, a floor many points, a wall only points and a shelf only levels: the product decides, the
    points by their root, because the wall of a stairwell may have ten times the points of its treads. That settles the
    direction; of the planes that face that way the largest gives it most exactly.
    """
    cosine = math.cos(math.radians(_LEVELLED_DEG))
    scores = [
        n_levels * math.sqrt(n_parallel) * (_LEVELLED_BONUS if abs(_normal(plane)[2]) >= cosine else 1.0)
        for plane, (n_levels, n_parallel) in zip(candidates, support, strict=True)
    ]
    best = _normal(candidates[int(np.argmax(scores))])
    same_way = math.cos(math.radians(_LEVEL_TOLERANCE_DEG))
    return next(k for k, plane in enumerate(candidates) if abs(float(_normal(plane) @ best)) >= same_way)


def _turn_upwards(points: Floats, plane: PlaneFit, distance_m: float) -> tuple[Floats, tuple[Note, ...]]:
    """Choose the side of a plane that is up."""
    normal = _normal(plane)
    offset = (points - plane.centroid) @ normal
    n_above, n_below = np.count_nonzero(offset > distance_m), np.count_nonzero(offset < -distance_m)
    if abs(normal[2]) < math.cos(math.radians(_LEANING_DEG)):
        up = normal if n_above >= n_below else -normal
        message = (
            "the floor found is not square to the scan's z axis; up is taken as "
            f"({up[0]:.3f}, {up[1]:.3f}, {up[2]:.3f}), the side on which most points lie; give --up if that is wrong"
        )
        return up, (Note("up_not_z", "orient", message),)
    up = normal
    if normal[2] < 0.0:
        up, n_above, n_below = -normal, n_below, n_above
    if n_below > _CEILING_SHARE * (n_above + n_below):
        message = (
            f"{n_below:,} points lie below the plane from which up was taken and {n_above:,} above: it is a ceiling or "
            "a landing, which serves as well; give --up -z if the scan's z axis points down"
        )
        return up, (Note("floor_above_scan", "orient", message),)
    return up, ()


def _normal(plane: PlaneFit) -> Floats:
    if plane.normal is None:
        raise DegenerateGeometry("the plane's points lie on one line")
    return plane.normal
