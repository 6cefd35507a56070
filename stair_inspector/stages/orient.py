"""Which way is up, how is every point's surface turned, and how high is it?"""

import math
from dataclasses import replace

import numpy as np

from stair_inspector import priors
from stair_inspector.errors import CannotMeasure, ConfigError, DegenerateGeometry
from stair_inspector.geometry.arrays import Floats, Ints, freeze, own, project
from stair_inspector.geometry.boxes import TurnedBox, turned_box
from stair_inspector.geometry.fits import PlaneFit, spread_rank
from stair_inspector.geometry.normals import estimate_normals
from stair_inspector.geometry.open3d import why_without
from stair_inspector.model import HeightOrder, Normals, Note, Observation, Scan, Up
from stair_inspector.overrules import parse_region, parse_up
from stair_inspector.params import FloorParams, Method, NormalsParams
from stair_inspector.stages.camera_frames import is_view, side_of_sensor
from stair_inspector.stages.floor_planes import (
    LEAST_POINTS,
    LEVEL_TOLERANCE_DEG,
    Support,
    choose_floor,
    find_planes,
    find_support,
    fitted_to_all,
    is_levelled,
    levelled_instead,
    normal_of,
    planes_of_normals,
)
from stair_inspector.stages.readings import Reading, is_same_way, read_rhythm
from stair_inspector.stages.thinned import thin
from stair_inspector.stages.up_questions import question_of, question_of_camera, question_of_side

_MAX_FLOOR_CANDIDATES = 6
POINTS_TO_COMPARE = 150_000
_LEANING_DEG = 45.0
_CEILING_SHARE = 0.8
"""Share of the points off the plane that lie below it, above which it is no floor."""


def find_normals(scan: Scan, params: NormalsParams) -> Normals:
    """Give every point a normal: estimated from its neighbours (step 1 of the paper), or the file's own.

    Parameters
    ----------
    scan : Scan
        At least 50 distinct points that are not on one line.
    params : NormalsParams
        Neighbours and source.

    Returns
    -------
    Normals
        Estimated ones point to the station that saw the point, where the scan tells it.

    Raises
    ------
    CannotMeasure
        Too few points, or all on one line.
    ConfigError
        Given normals are asked for and the file has none.
    """
    if len(scan.points) < LEAST_POINTS:
        count = len(scan.points)
        raise CannotMeasure(
            f"{scan.name}: {count} distinct point{'' if count == 1 else 's'}, at least {LEAST_POINTS} are needed; "
            "scan again or check the file"
        )
    if spread_rank(scan.points) < 2:
        raise CannotMeasure(f"{scan.name}: all {len(scan.points)} points lie on one line; check the file's columns")
    if params.source == "given":
        if scan.normals is None:
            raise ConfigError(f"normals.source: {scan.name} holds no normals; use 'estimate'")
        return Normals(scan.normals)
    vectors = estimate_normals(scan.points, params.k)
    _turn_to_stations(vectors, scan)
    notes = without_open3d("normals and floor are", "normals")
    return Normals(freeze(vectors), "numpy" if notes else "open3d", notes)


def without_open3d(what: str, stage: str) -> tuple[Note, ...]:
    """Return the note that says that something was made without Open3D; nothing where it can be loaded."""
    reason = why_without()
    message = f"{what} made by numpy and SciPy, not by Open3D: {reason}; a value differs by less than a third of its U"
    return (Note("without_open3d", stage, message),) if reason else ()


def _turn_to_stations(vectors: Floats, scan: Scan) -> None:
    """Turn those normals (n, 3) that point away from the station that saw the point; where none is known, none."""
    stations = scan.stations
    if stations is None:
        return
    for k in np.flatnonzero(np.isfinite(stations.places_m).all(axis=1)):
        own = np.flatnonzero(stations.of_point == k)
        way = stations.places_m[k] - scan.points[own]
        away = own[(vectors[own] * way).sum(axis=1) < 0.0]
        vectors[away] = -vectors[away]


def find_up(
    scan: Scan,
    normals: Normals,
    up: str,
    params: FloorParams,
    method: Method,
    max_rise_m: float = priors.MOST_RISE_M,
) -> Up:
    """Return the up vector: given by the user, or the normal of the RANSAC floor plane (step 1 of the paper).

    Parameters
    ----------
    scan, normals
        Of one scan.
    up : str
        As the setting has it.
    params, method
        As the settings have them.
    max_rise_m : float
        Rises that are looked for, where the user has widened them.

    Notes
    -----
    With the paper's method the floor is the largest plane, whatever it is. In a narrow stairwell that is a wall. With
    the survey's, up to six planes are taken out one after the other, and the floor is the one that faces the way of
    most points and most separate levels; levels that follow each other as the steps of a flight count three times, and
    a plane that is level in the scan's own frame counts double.

    Where treads and riser faces come again in one rhythm, the stair that comes out decides, or the user is asked: see
    :mod:`stair_inspector.stages.readings`. The floor is then the plane square to the direction that was decided.

    A plane has no upper side: without a rhythm, where its normal is within 45 degrees of the scan's z axis, up is on
    the side of +z; elsewhere it is the side on which most of the scan lies.

    Raises
    ------
    CannotMeasure
        No plane is found.
    """
    given = parse_up(up)
    if given is not None:
        return Up(own(given, (3,), "up"), "given")
    found = _up_of_floor(scan, normals, params, method, max_rise_m)
    # Where the normals were made without it too, that is already said.
    notes = without_open3d("the floor is", "orient") if normals.by == "file" else ()
    return replace(found, notes=(*notes, *found.notes)) if notes else found


def _up_of_floor(scan: Scan, normals: Normals, params: FloorParams, method: Method, max_rise_m: float) -> Up:
    try:
        wanted = 1 if method == "paper" else _MAX_FLOOR_CANDIDATES
        # Candidates can be found and compared among fewer points; the one that is chosen is fitted to all.
        few = slice(None) if method == "paper" else slice(None, None, -(-len(scan.points) // POINTS_TO_COMPARE))
        candidates = find_planes(scan.points[few], params.distance_m, wanted)
        if method != "paper":
            candidates += planes_of_normals(scan.points[few], normals.vectors[few], candidates, params.distance_m)
    except DegenerateGeometry as error:
        raise CannotMeasure(
            f"{scan.name}: no floor found ({error}); give the up direction, for example --up z"
        ) from error
    support = [find_support(scan.points[few], normals.vectors[few], plane, max_rise_m) for plane in candidates]
    chosen = choose_floor(candidates, support)
    vector, notes = _turn_upwards(scan.points, candidates[chosen], params.distance_m)
    if method == "paper":
        return Up(own(vector, (3,), "up"), "floor", notes=notes)
    thinned = thin(scan.points[few], normals.vectors[few])
    is_camera = is_view(scan, thinned.points)
    readings = read_rhythm(thinned, max_rise_m, vector, is_camera=is_camera)
    if readings and _is_believed(readings[0], candidates[chosen], support[chosen]):
        decided = readings[0].up
        square = [k for k, plane in enumerate(candidates) if is_same_way(normal_of(plane), decided)]
        if not square:
            return Up(decided, "treads", observations=_asked(readings))
        chosen = chosen if chosen in square else square[0]
        side: Floats | None = decided
    else:
        readings = []
        chosen = levelled_instead(candidates, support, chosen)
        side = normal_of(candidates[chosen]) if is_camera else None
        if side is not None:
            faces = np.abs(thinned.normals @ side) >= math.cos(math.radians(LEVEL_TOLERANCE_DEG))
            side = side if side_of_sensor(thinned.points[faces], side) >= 0.0 else -side
    candidates = [fitted_to_all(scan.points, plane, params.distance_m) for plane in candidates[: chosen + 1]]
    vector, notes = _turn_upwards(scan.points, candidates[chosen], params.distance_m, side)
    if chosen > 0:
        message = (
            f"the floor is not the largest plane: a plane with {candidates[0].n_points:,} points has "
            f"{support[0].n_levels} levels parallel to it, {support[0].n_steps} of them as steps follow each other, "
            f"the one taken has {candidates[chosen].n_points:,} points, {support[chosen].n_levels} levels and "
            f"{support[chosen].n_steps} steps"
        )
        notes = (Note("floor_not_largest", "orient", message), *notes)
    asked = _asked(readings)
    if is_camera and not readings:
        question = question_of_camera(thinned.points, vector)
        asked = () if question is None else (question,)
    elif not readings and support[chosen].n_steps > 0:
        question = question_of_side(thinned, vector, float(candidates[chosen].centroid @ vector))
        asked = () if question is None else (question,)
    return Up(own(vector, (3,), "up"), "floor", notes=notes, observations=asked)


def _asked(readings: list[Reading]) -> tuple[Observation, ...]:
    question = question_of(readings)
    return () if question is None else (question,)


def _is_believed(reading: Reading, floor: PlaneFit, support: Support) -> bool:
    """Return whether a rhythm decides: not one that lies flat in a levelled scan with a flight of its own."""
    axes = (reading.lattice.up, reading.lattice.ahead)
    is_flat = not any(is_same_way(normal_of(floor), axis) for axis in axes)
    return not (is_levelled(floor) and is_flat and support.n_steps > 0)


def region_box(region: str, up: Up, scan: Scan) -> TurnedBox | None:
    """Return the box that ``overrules.region`` names, local coordinates; None for everything."""
    found = parse_region(region)
    if found is None:
        return None
    low, high = (np.array(corner) - scan.origin_m for corner in (found.low, found.high))
    return turned_box(low, high, up.vector, found.bearing_deg)


def order_by_height(scan: Scan, normals: Normals, up: Up, region: str = "") -> HeightOrder:
    """Sort the points by height along ``up``, with plan coordinates and |n . u| in the same order.

    Parameters
    ----------
    scan, normals, up
        Of one scan.
    region : str
        Region of interest as ``overrules.region`` gives it, metres in the scan frame; points outside are left out, as
        are those on the undersides of solids.

    Returns
    -------
    HeightOrder
        z_i = <p_i, u> (step 3 of the paper), metres, local.

    Raises
    ------
    ConfigError
        No point lies in the region.
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
    alignment = np.abs(project(normals.vectors.T, u))
    is_level = alignment >= math.cos(math.radians(LEVEL_TOLERANCE_DEG))
    box, is_inside = region_box(region, up, scan), None
    if box is not None:
        is_inside = box.holds(scan.points)
        if not is_inside.any():
            raise ConfigError(f"overrules.region: no point of {scan.name} lies in the box {region}; check its corners")
    if scan.is_outward is not None and scan.normals is not None:
        # Nobody walks on the underside of a slab, and it is no second floor below the first.
        is_underside = is_level & scan.is_outward & (project(scan.normals.T, u) < 0.0)
        order = order[~is_underside[order]]

    def of(order: Ints, whole: HeightOrder | None = None) -> HeightOrder:
        return HeightOrder(
            point_ids=freeze(order),
            alignment=freeze(alignment[order]),
            coordinates_m=freeze(coordinates.take(order, axis=1)),
            level_from_scan=own(level_from_scan, (3, 3), "level_from_scan"),
            up=up,
            n_scan=len(scan.points),
            plan_corner_m=freeze(coordinates[:2, is_level].min(axis=1)) if is_level.any() else None,
            whole=whole,
        )

    return of(order) if is_inside is None else of(order[is_inside[order]], of(order))


def _turn_upwards(
    points: Floats, plane: PlaneFit, distance_m: float, side: Floats | None = None
) -> tuple[Floats, tuple[Note, ...]]:
    """Choose the side of a plane that is up; ``side`` is a direction on that side where it is known."""
    normal = normal_of(plane)
    offset = (points - plane.centroid) @ normal
    n_above, n_below = np.count_nonzero(offset > distance_m), np.count_nonzero(offset < -distance_m)
    if abs(normal[2]) < math.cos(math.radians(_LEANING_DEG)):
        is_normal = n_above >= n_below if side is None else float(normal @ side) >= 0.0
        up = normal if is_normal else -normal
        why = "the side on which most points lie" if side is None else "as the stair and its surroundings say"
        message = (
            "the floor found is not square to the scan's z axis; up is taken as "
            f"({up[0]:.3f}, {up[1]:.3f}, {up[2]:.3f}), {why}; give --up if that is wrong"
        )
        return up, (Note("up_not_z", "orient", message),)
    up = normal
    if (normal[2] if side is None else float(normal @ side)) < 0.0:
        up, n_above, n_below = -normal, n_below, n_above
    if up[2] < 0.0:
        message = "up is taken as the scan's -z, because the stair and what is around it say so; give --up if it is not"
        return up, (Note("up_not_z", "orient", message),)
    if n_below > _CEILING_SHARE * (n_above + n_below):
        message = (
            f"{n_below:,} points lie below the plane from which up was taken and {n_above:,} above: it is a ceiling or "
            "a landing, which serves as well; give --up -z if the scan's z axis points down"
        )
        return up, (Note("floor_above_scan", "orient", message),)
    return up, ()
