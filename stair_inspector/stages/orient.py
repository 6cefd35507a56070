"""Which way is up, how is every point's surface turned, and how high is it?"""

import math
from dataclasses import dataclass

import numpy as np

from stair_inspector import priors
from stair_inspector.errors import CannotMeasure, ConfigError, DegenerateGeometry
from stair_inspector.geometry.arrays import Bools, Floats, freeze, own, project, scatter_of
from stair_inspector.geometry.clusters import cluster_sorted, find_reach
from stair_inspector.geometry.fits import PlaneFit, find_plane_ransac, fit_plane, spread_rank
from stair_inspector.geometry.normals import estimate_normals
from stair_inspector.model import HeightOrder, Normals, Note, Observation, Scan, Up
from stair_inspector.overrules import parse_region, parse_up
from stair_inspector.params import FlightsParams, FloorParams, Method, NormalsParams
from stair_inspector.stages.readings import (
    Reading,
    is_same_way,
    is_view,
    question_of,
    question_of_camera,
    question_of_side,
    read_rhythm,
    side_of_sensor,
    thin,
)

LEAST_POINTS = 50
"""Below this a scan has no surface to speak of."""
_MAX_FLOOR_CANDIDATES = 6
POINTS_TO_COMPARE = 150_000
_NORMAL_SEEDS, _NORMAL_MODES = 400, 4
_CANDIDATE_SHARE = 0.05
"""A plane with less than this share of the largest plane's points is not tried as the floor."""
_LEVEL_TOLERANCE_DEG = 15.0
_LEVEL_EPS_M = 0.02
_LEVEL_SHARE = 0.01
"""A level parallel to a plane is found when it holds this share of the points that face the same way, found ones left
out: beside a floor and landings each tread of a long stair holds far less than this share of all of them."""
_LEANING_DEG = 45.0
_CEILING_SHARE = 0.8
"""Share of the points off the plane that lie below it, above which it is no floor."""
_LEVELLED_DEG = 20.0
_LEVELLED_BONUS = 2.0
"""Most scans are made with z up: a plane that leans less than this from level counts double."""
_LEVELLED_SURPLUS, _SURE_STEPS = 2.0, 6
"""So many times as many points face a levelled scan's z axis as another way: then only a flight of so many levels, or
a rhythm, is believed against it."""
_STEP_BONUS = 3.0
"""A level that is a step counts so many times: a flight says more than the scan's z axis, as many have y up."""


@dataclass(frozen=True, slots=True)
class _Support:
    """What speaks for a plane as the floor: levels parallel to it, how many are steps, and points that face its way."""

    n_levels: int
    n_steps: int
    n_points: int


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
    return Normals(freeze(estimate_normals(scan.points, params.k)))


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
    try:
        wanted = 1 if method == "paper" else _MAX_FLOOR_CANDIDATES
        # Candidates can be found and compared among fewer points; the one that is chosen is fitted to all.
        few = slice(None) if method == "paper" else slice(None, None, -(-len(scan.points) // POINTS_TO_COMPARE))
        candidates = _find_planes(scan.points[few], params.distance_m, wanted)
        if method != "paper":
            candidates += _planes_of_normals(scan.points[few], normals.vectors[few], candidates, params.distance_m)
    except DegenerateGeometry as error:
        raise CannotMeasure(
            f"{scan.name}: no floor found ({error}); give the up direction, for example --up z"
        ) from error
    support = [_find_support(scan.points[few], normals.vectors[few], plane, max_rise_m) for plane in candidates]
    chosen = _choose_floor(candidates, support)
    vector, notes = _turn_upwards(scan.points, candidates[chosen], params.distance_m)
    if method == "paper":
        return Up(own(vector, (3,), "up"), "floor", notes=notes)
    thinned = thin(scan.points[few], normals.vectors[few])
    is_camera = is_view(scan, thinned.points)
    readings = read_rhythm(thinned, max_rise_m, vector, is_camera=is_camera)
    if readings and _is_believed(readings[0], candidates[chosen], support[chosen]):
        decided = readings[0].up
        square = [k for k, plane in enumerate(candidates) if is_same_way(_normal(plane), decided)]
        if not square:
            return Up(decided, "treads", observations=_asked(readings))
        chosen = chosen if chosen in square else square[0]
        side: Floats | None = decided
    else:
        readings = []
        chosen = _levelled_instead(candidates, support, chosen)
        side = _normal(candidates[chosen]) if is_camera else None
        if side is not None:
            faces = np.abs(thinned.normals @ side) >= math.cos(math.radians(_LEVEL_TOLERANCE_DEG))
            side = side if side_of_sensor(thinned.points[faces], side) >= 0.0 else -side
    candidates = [_fitted_to_all(scan.points, plane, params.distance_m) for plane in candidates[: chosen + 1]]
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


def _is_believed(reading: Reading, floor: PlaneFit, support: _Support) -> bool:
    """Return whether a rhythm decides: not one that lies flat in a levelled scan with a flight of its own."""
    is_levelled = _is_levelled(floor)
    axes = (reading.lattice.up, reading.lattice.ahead)
    is_flat = not any(is_same_way(_normal(floor), axis) for axis in axes)
    return not (is_levelled and is_flat and support.n_steps > 0)


def order_by_height(scan: Scan, normals: Normals, up: Up, region: str = "") -> HeightOrder:
    """Sort the points by height along ``up``, with plan coordinates and |n . u| in the same order.

    Parameters
    ----------
    scan, normals, up
        Of one scan.
    region : str
        Region of interest as ``overrules.region`` gives it, metres in the scan frame; points outside are left out.

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
    box = parse_region(region)
    if box is not None:
        low, high = np.array(box) - scan.origin_m
        is_inside = ((scan.points >= low) & (scan.points <= high)).all(axis=1)
        order = order[is_inside[order]]
        if not len(order):
            raise ConfigError(f"overrules.region: no point of {scan.name} lies in the box {region}; check its corners")
    alignment = np.abs(project(normals.vectors.T, u))
    is_level = alignment >= math.cos(math.radians(_LEVEL_TOLERANCE_DEG))
    return HeightOrder(
        point_ids=freeze(order),
        alignment=freeze(alignment[order]),
        coordinates_m=freeze(coordinates.take(order, axis=1)),
        level_from_scan=own(level_from_scan, (3, 3), "level_from_scan"),
        up=up,
        n_scan=len(scan.points),
        plan_corner_m=freeze(coordinates[:2, is_level].min(axis=1)) if is_level.any() else None,
    )


def _find_planes(points: Floats, distance_m: float, wanted: int) -> list[PlaneFit]:
    """Return the largest plane and those after it, each found in what the earlier ones left."""
    planes = [find_plane_ransac(points, distance_m)]
    rest = points
    while len(planes) < wanted:
        rest = rest[np.abs((rest - planes[-1].centroid) @ _normal(planes[-1])) > distance_m]
        if len(rest) < _CANDIDATE_SHARE * planes[0].n_points or len(rest) < LEAST_POINTS or spread_rank(rest) < 2:
            break
        plane = find_plane_ransac(rest, distance_m)
        if plane.n_points < _CANDIDATE_SHARE * planes[0].n_points:
            break
        planes.append(plane)
    return planes


def _planes_of_normals(points: Floats, normals: Floats, known: list[PlaneFit], distance_m: float) -> list[PlaneFit]:
    """Return the largest plane square to each frequent direction of the normals that no known plane has.

    The plane through all nosings of a long flight holds more points than any of its treads, and so do planes parallel
    to it; but the treads' own normals say which way they face.
    """
    folded = normals * np.where(normals[:, 2] < 0.0, -1.0, 1.0)[:, None]
    seeds = folded[:: -(-len(folded) // _NORMAL_SEEDS)]
    cosine = math.cos(math.radians(_LEVEL_TOLERANCE_DEG))
    found: list[PlaneFit] = []
    is_free = np.ones(len(folded), dtype=np.bool_)
    for _ in range(_NORMAL_MODES):
        some = folded[is_free][:: max(1, int(np.count_nonzero(is_free)) // _NORMAL_SEEDS)]
        if len(some) < LEAST_POINTS:
            break
        votes = np.count_nonzero(np.abs(np.einsum("ik,jk->ij", seeds, some)) >= cosine, axis=1)
        middle = seeds[int(np.argmax(votes))]
        faces = np.abs(project(folded.T, middle)) >= cosine
        is_free &= ~faces
        # One normal is some degrees off, which over a long flight is more than a riser: their mean is not.
        middle = np.linalg.eigh(scatter_of(np.ascontiguousarray(folded[faces].T)))[1][:, 2]
        if any(abs(float(_normal(plane) @ middle)) >= cosine for plane in (*known, *found)):
            continue
        heights = np.sort(project(points[faces].T, middle))
        clusters = cluster_sorted(find_reach(heights, _LEVEL_EPS_M), LEAST_POINTS)
        if not len(clusters.start):
            continue
        largest = int(np.argmax(clusters.stop - clusters.start))
        low, high = heights[clusters.start[largest]], heights[clusters.stop[largest] - 1]
        along = project(points.T, middle)
        level = points[faces & (along >= low) & (along <= high)]
        if len(level) >= LEAST_POINTS and spread_rank(level) >= 2:
            plane = fit_plane(level, middle)
            if plane.normal is not None:
                found.append(_fitted_to_all(points, plane, distance_m))
    return found


def _fitted_to_all(points: Floats, plane: PlaneFit, distance_m: float) -> PlaneFit:
    """Return the least-squares plane of all points near a plane that was found among fewer."""
    rows = points.T
    near = np.abs(project(rows, _normal(plane)) - float(plane.centroid @ _normal(plane))) <= distance_m
    fitted = fit_plane(points[near], _normal(plane))
    return plane if fitted.normal is None else fitted


def _find_support(points: Floats, normals: Floats, plane: PlaneFit, max_rise_m: float) -> _Support:
    """Count the separate levels of surface parallel to a plane, large or a step, and the points that face its way."""
    normal = _normal(plane)
    rows = points[np.abs(normals @ normal) >= math.cos(math.radians(_LEVEL_TOLERANCE_DEG))]
    heights = rows @ normal
    order = np.argsort(heights, kind="stable")
    heights, rows = heights[order], rows[order]
    middles: list[Floats] = []
    n_large = 0
    # What the largest levels leave is searched again: the share that makes a level is one of the rest.
    while len(heights) >= LEAST_POINTS:
        wanted = max(LEAST_POINTS, int(_LEVEL_SHARE * len(heights)))
        clusters = cluster_sorted(find_reach(heights, _LEVEL_EPS_M), wanted)
        if not len(clusters.start):
            break
        n_large = n_large or len(clusters.start)
        is_rest = np.ones(len(heights), dtype=np.bool_)
        for start, stop in zip(clusters.start, clusters.stop, strict=True):
            middles.append(rows[start:stop].mean(axis=0))
            is_rest[start:stop] = False
        heights, rows = heights[is_rest], rows[is_rest]
    is_step = _find_steps(np.array(middles).reshape(-1, 3), normal, max_rise_m)
    n_levels = n_large + int(np.count_nonzero(is_step[n_large:]))
    return _Support(n_levels, int(np.count_nonzero(is_step)), len(order))


def _find_steps(middles: Floats, normal: Floats, max_rise_m: float) -> Bools:
    """Return which levels, given by their middles (n, 3), follow each other as steps do.

    From one to the next a flight goes on in about the same direction, and farther along than up: of a stair lying on
    its back, whose risers would be the treads, the second is not true.
    """
    limits = FlightsParams()
    heights = middles @ normal
    order = np.argsort(heights, kind="stable")
    rises = np.diff(heights[order])
    goings = np.diff(middles[order], axis=0) - rises[:, None] * normal
    lengths = np.linalg.norm(goings, axis=1)
    is_rise = (rises >= limits.min_rise_m) & (rises <= max_rise_m)
    is_straight = np.einsum("ij,ij->i", goings[:-1], goings[1:]) >= (
        math.cos(math.radians(limits.turn_deg)) * lengths[:-1] * lengths[1:]
    )
    steepest = math.tan(math.radians(priors.USUAL_STEEPEST_PITCH_DEG))
    is_flat = rises[:-1] + rises[1:] <= steepest * np.linalg.norm(goings[:-1] + goings[1:], axis=1)
    goes_on = is_rise[:-1] & is_rise[1:] & is_straight & is_flat
    # Three levels in a row are found in any heap of boxes: two such threes, one level apart, are a flight.
    first = np.flatnonzero(goes_on[:-1] & goes_on[1:])
    is_step = np.zeros(len(middles), dtype=np.bool_)
    is_step[order[first[:, None] + np.arange(4)]] = True
    return is_step


def _levelled_instead(candidates: list[PlaneFit], support: list[_Support], chosen: int) -> int:
    """Return the floor of a levelled scan where what was chosen instead of it is no certain flight."""
    most = _LEVELLED_SURPLUS * support[chosen].n_points
    if _is_levelled(candidates[chosen]) or support[chosen].n_steps >= _SURE_STEPS:
        return chosen
    level = (k for k, plane in enumerate(candidates) if _is_levelled(plane) and support[k].n_points >= most)
    return next(level, chosen)


def _is_levelled(plane: PlaneFit) -> bool:
    return abs(float(_normal(plane)[2])) >= math.cos(math.radians(_LEVELLED_DEG))


def _choose_floor(candidates: list[PlaneFit], support: list[_Support]) -> int:
    """Return the index of the floor among planes, given what speaks for each.

    A stair has many levels, which are steps, a floor many points, a wall only points and a shelf only levels: the
    product decides, the points by their root, because the wall of a stairwell may have ten times the points of its
    treads. That settles the direction; of the planes that face that way the largest gives it most exactly.
    """
    scores = [
        (found.n_levels + (_STEP_BONUS - 1.0) * found.n_steps)
        * math.sqrt(found.n_points)
        * (_LEVELLED_BONUS if _is_levelled(plane) else 1.0)
        for plane, found in zip(candidates, support, strict=True)
    ]
    best = _normal(candidates[int(np.argmax(scores))])
    same_way = math.cos(math.radians(_LEVEL_TOLERANCE_DEG))
    return next(k for k, plane in enumerate(candidates) if abs(float(_normal(plane) @ best)) >= same_way)


def _turn_upwards(
    points: Floats, plane: PlaneFit, distance_m: float, side: Floats | None = None
) -> tuple[Floats, tuple[Note, ...]]:
    """Choose the side of a plane that is up; ``side`` is a direction on that side where it is known."""
    normal = _normal(plane)
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


def _normal(plane: PlaneFit) -> Floats:
    if plane.normal is None:
        raise DegenerateGeometry("the plane's points lie on one line")
    return plane.normal
