"""Which planes may be the floor, and what speaks for each? Levels parallel to it, of which some follow as steps do."""

import math
from dataclasses import dataclass

import numpy as np

from stair_inspector import priors
from stair_inspector.errors import DegenerateGeometry
from stair_inspector.geometry.arrays import Bools, Floats, project, scatter_of
from stair_inspector.geometry.clusters import cluster_sorted, find_reach
from stair_inspector.geometry.fits import PlaneFit, find_plane_ransac, fit_plane, spread_rank
from stair_inspector.params import FlightsParams

LEAST_POINTS = 50
"""Below this a scan has no surface to speak of."""
_NORMAL_SEEDS, _NORMAL_MODES = 400, 4
_CANDIDATE_SHARE = 0.05
"""A plane with less than this share of the largest plane's points is not tried as the floor."""
LEVEL_TOLERANCE_DEG = 15.0
_LEVEL_EPS_M = 0.02
_LEVEL_SHARE = 0.01
"""A level parallel to a plane is found when it holds this share of the points that face the same way, found ones left
out: beside a floor and landings each tread of a long stair holds far less than this share of all of them."""
_UPRIGHT_DEG = 20.0
_LEVELLED_BONUS = 2.0
"""Most scans are made with z up, levelled (to ``readings.LEVELLED_DEG``) or not: a plane that leans less than this from
level counts double."""
_LEVELLED_SURPLUS, _SURE_STEPS = 2.0, 6
"""So many times as many points face a levelled scan's z axis as another way: then only a flight of so many levels, or
a rhythm, is believed against it."""
_STEP_BONUS = 3.0
"""A level that is a step counts so many times: a flight says more than the scan's z axis, as many have y up."""


@dataclass(frozen=True, slots=True)
class Support:
    """What speaks for a plane as the floor: levels parallel to it, how many are steps, and points that face its way."""

    n_levels: int
    n_steps: int
    n_points: int


def find_planes(points: Floats, distance_m: float, wanted: int) -> list[PlaneFit]:
    """Return the largest plane and those after it, each found in what the earlier ones left."""
    planes = [find_plane_ransac(points, distance_m)]
    rest = points
    while len(planes) < wanted:
        rest = rest[np.abs((rest - planes[-1].centroid) @ normal_of(planes[-1])) > distance_m]
        if len(rest) < _CANDIDATE_SHARE * planes[0].n_points or len(rest) < LEAST_POINTS or spread_rank(rest) < 2:
            break
        plane = find_plane_ransac(rest, distance_m)
        if plane.n_points < _CANDIDATE_SHARE * planes[0].n_points:
            break
        planes.append(plane)
    return planes


def planes_of_normals(points: Floats, normals: Floats, known: list[PlaneFit], distance_m: float) -> list[PlaneFit]:
    """Return the largest plane square to each frequent direction of the normals that no known plane has.

    The plane through all nosings of a long flight holds more points than any of its treads, and so do planes parallel
    to it; but the treads' own normals say which way they face.
    """
    folded = normals * np.where(normals[:, 2] < 0.0, -1.0, 1.0)[:, None]
    seeds = folded[:: -(-len(folded) // _NORMAL_SEEDS)]
    cosine = math.cos(math.radians(LEVEL_TOLERANCE_DEG))
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
        if any(abs(float(normal_of(plane) @ middle)) >= cosine for plane in (*known, *found)):
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
                found.append(fitted_to_all(points, plane, distance_m))
    return found


def fitted_to_all(points: Floats, plane: PlaneFit, distance_m: float) -> PlaneFit:
    """Return the least-squares plane of all points near a plane that was found among fewer."""
    rows = points.T
    near = np.abs(project(rows, normal_of(plane)) - float(plane.centroid @ normal_of(plane))) <= distance_m
    fitted = fit_plane(points[near], normal_of(plane))
    return plane if fitted.normal is None else fitted


def find_support(points: Floats, normals: Floats, plane: PlaneFit, max_rise_m: float) -> Support:
    """Count the separate levels of surface parallel to a plane, large or a step, and the points that face its way."""
    normal = normal_of(plane)
    rows = points[np.abs(normals @ normal) >= math.cos(math.radians(LEVEL_TOLERANCE_DEG))]
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
    return Support(n_levels, int(np.count_nonzero(is_step)), len(order))


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


def levelled_instead(candidates: list[PlaneFit], support: list[Support], chosen: int) -> int:
    """Return the floor of a levelled scan where what was chosen instead of it is no certain flight."""
    most = _LEVELLED_SURPLUS * support[chosen].n_points
    if is_levelled(candidates[chosen]) or support[chosen].n_steps >= _SURE_STEPS:
        return chosen
    level = (k for k, plane in enumerate(candidates) if is_levelled(plane) and support[k].n_points >= most)
    return next(level, chosen)


def is_levelled(plane: PlaneFit) -> bool:
    """Return whether a plane is about level in the scan's own frame."""
    return abs(float(normal_of(plane)[2])) >= math.cos(math.radians(_UPRIGHT_DEG))


def choose_floor(candidates: list[PlaneFit], support: list[Support]) -> int:
    """Return the index of the floor among planes, given what speaks for each.

    A stair has many levels, which are steps, a floor many points, a wall only points and a shelf only levels: the
    product decides, the points by their root, because the wall of a stairwell may have ten times the points of its
    treads. That settles the direction; of the planes that face that way the largest gives it most exactly.
    """
    scores = [
        (found.n_levels + (_STEP_BONUS - 1.0) * found.n_steps)
        * math.sqrt(found.n_points)
        * (_LEVELLED_BONUS if is_levelled(plane) else 1.0)
        for plane, found in zip(candidates, support, strict=True)
    ]
    best = normal_of(candidates[int(np.argmax(scores))])
    same_way = math.cos(math.radians(LEVEL_TOLERANCE_DEG))
    return next(k for k, plane in enumerate(candidates) if abs(float(normal_of(plane) @ best)) >= same_way)


def normal_of(plane: PlaneFit) -> Floats:
    """Return the normal of a plane that has one, (3,).

    Raises
    ------
    DegenerateGeometry
        Its points lie on one line.
    """
    if plane.normal is None:
        raise DegenerateGeometry("the plane's points lie on one line")
    return plane.normal
