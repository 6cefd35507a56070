"""Which motion lays one station of a file onto the other?"""

import math
from dataclasses import dataclass, replace

import numpy as np

from stair_inspector.geometry.arrays import Bools, Floats, Ints
from stair_inspector.geometry.percentiles import mad_sigma
from stair_inspector.geometry.trimmed import fit_trimmed, height_above
from stair_inspector.stages.layers import FEWEST_ON_PLANE, FEWEST_PLANES, SAME_PLANE_M, Cells

_FEWEST_OF_EACH, _FEWEST_CELLS = 8, 10
"""Points of each station in a cell, and cells that face one way, that tell a shift."""
_BEYOND = 3.0
"""Cells that stray farther, in robust standard deviations, show two surfaces and not one twice."""
_MOST_SPREAD_M = 0.0005
"""Half of the cells that face one way agree on their distance so well, beyond what noise does."""
_AGREEING = 0.92
"""Share of these cells whose distance is that."""
_STAYED = 0.25
"""A plane on which both lie nearer than this share of it has stayed: where one station saw the upper faces of slabs and
the other their undersides, the floor is not double. Two planes show it: a pane seen from both sides is one."""
_ALIKE, _MOST_ALIKE = 0.25, 0.75
"""Where means alone tell them, the distances of most planes are the same to this share."""
_TURNED = 0.9
"""A turn is made where it leaves so much less between the stations."""
_ON_STEPS, OF_STEP = 1.05, 0.5
"""Coordinates on a step lie on it or on the next, and a distance is off by half of one."""
_UNTOLD = 0.05
"""Motions that the surfaces hold less firmly, as a share of the firmest, are not made."""


@dataclass(frozen=True, slots=True, eq=False)
class _Distance:
    """How far two planes lie apart in a cell, its standard uncertainty, and the cell's ``place`` (3,); metres."""

    apart_m: float
    u_m: float
    place: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """``turn`` (3,) small angles about ``centre`` (3,) and ``shift`` (3,), metres.

    ``u_m`` is what the motion leaves between the stations in one cell, a standard deviation; ``unheld`` (k, 3) are the
    directions along which nothing holds it.
    """

    centre: Floats
    turn: Floats
    shift: Floats
    u_m: float
    unheld: Floats

    def moved(self, points: Floats) -> Floats:
        """Return where points (n, 3) come to lie."""
        return points + self.shift + np.cross(self.turn, points - self.centre)


def fit_motion(cells: Cells, ways: list[tuple[Floats, Ints]], of_point: Bools, rounded_m: float = 0.0) -> Motion | None:
    """Return the motion that lays the second station onto the first, from the cells that hold points of both.

    Parameters
    ----------
    cells, ways
        Of one scan: its points in cells, and the cells that face each of the main ways.
    of_point : (n,)
        Whether each point of the cells is of the second station.
    rounded_m : float
        Step of the coordinates, by which distances differ from plane to plane.

    Returns
    -------
    Motion or None
        None where no two planes show one distance, or a plane that both saw has stayed.
    """
    normals, places, apart = [], [], []
    usual_m = np.inf
    for normal, members in ways:
        found = [each for each in _distances(cells, members, normal, of_point, rounded_m) if each.u_m <= usual_m]
        if len(found) < _FEWEST_CELLS:
            continue
        # Most cells face the first way; others that scatter much more hold an edge.
        usual_m = min(usual_m, _BEYOND * float(np.median([each.u_m for each in found])))
        off = np.array([each.apart_m for each in found])
        where = np.array([each.place for each in found])
        u_m = float(np.median([each.u_m for each in found]))
        near = _agreeing(_without_slope(off, where, normal), where @ normal, u_m, rounded_m)
        if near is None or not _is_on_largest(cells.middles()[members] @ normal, where[near] @ normal):
            continue
        normals.append(np.tile(normal, (int(near.sum()), 1)))
        places.append(where[near])
        apart.append(off[near])
    if not apart:
        return None
    n, p, d = np.vstack(normals), np.vstack(places), np.concatenate(apart)
    centre = p.mean(axis=0)
    reach = max(float(np.sqrt(np.mean(np.sum((p - centre) ** 2, axis=1)))), 0.1)
    # n . (shift + turn x (p - centre)) = -d, the turn counted in metres at the reach.
    turning = np.cross((p - centre) / reach, n)
    shift, u_m = _solve(n, d)
    _, held, axes = np.linalg.svd(n, full_matrices=False)
    motion = Motion(centre, np.zeros(3), shift, u_m, axes[held < _UNTOLD * held[0]])
    both, u_both_m = _solve(np.hstack([n, turning]), d)
    if u_both_m < _TURNED * u_m:
        motion = replace(motion, turn=both[3:] / reach, shift=both[:3], u_m=u_both_m)
    return motion


def _agreeing(apart_m: Floats, offset_m: Floats, u_m: float, rounded_m: float = 0.0) -> Bools | None:
    """Return which cells (n,) that face one way show the distance on which they agree, None where they do not agree.

    ``offset_m`` (n,) are their places along their normal: those of one plane lie together.
    """
    low, high = _shortest_half(apart_m)
    # The face of a nosing seen by one and that of the riser by the other are not one surface twice.
    if high - low > _MOST_SPREAD_M + _BEYOND * u_m + rounded_m:
        return None
    middle, reach_m = 0.5 * (low + high), max(_BEYOND * max(high - low, 1e-4), OF_STEP * rounded_m)
    near: Bools = np.abs(apart_m - middle) <= reach_m
    of_planes = _of_planes(apart_m, offset_m)
    is_shown = np.count_nonzero(np.abs(of_planes - middle) <= reach_m) >= FEWEST_PLANES
    return near if is_shown and not _has_stayed(of_planes, middle) and near.mean() >= _AGREEING else None


def _of_planes(apart_m: Floats, offset_m: Floats) -> Floats:
    """Return the median distance (k,) on each plane of enough cells."""
    order = np.argsort(offset_m)
    planes = np.split(order, 1 + np.flatnonzero(np.diff(offset_m[order]) > SAME_PLANE_M))
    return np.array([np.median(apart_m[each]) for each in planes if len(each) >= FEWEST_ON_PLANE])


def _has_stayed(of_planes: Floats, apart_m: float) -> bool:
    return bool((np.abs(of_planes) < _STAYED * abs(apart_m)).any())


def _is_on_largest(offset_m: Floats, shown_m: Floats) -> bool:
    """Return whether the largest plane of all cells, by their places along the normal, is one that shows the distance.

    Slabs without the floor below them may all show two faces; the floor, where it was seen, is the largest.
    """
    ordered = np.sort(offset_m)
    largest = max(np.split(ordered, 1 + np.flatnonzero(np.diff(ordered) > SAME_PLANE_M)), key=len)
    is_on = (shown_m >= largest[0] - SAME_PLANE_M) & (shown_m <= largest[-1] + SAME_PLANE_M)
    return bool(np.count_nonzero(is_on) >= FEWEST_ON_PLANE)


def _without_slope(apart_m: Floats, places: Floats, normal: Floats) -> Floats:
    """Return distances (n,) without what grows with the place (n, 3), as where a station leans, but at their middle."""
    across = places - places.mean(axis=0)
    across = across - np.outer(across @ normal, normal)
    axes = np.linalg.svd(across, full_matrices=False)[2][:2]
    along = np.vstack([axes @ across.T, apart_m])
    slope, centre, _ = fit_trimmed(along)
    return height_above(along, slope, centre) + float(centre[2])


def _solve(rows: Floats, apart_m: Floats) -> tuple[Floats, float]:
    """Return the motion (k,) that takes the distances (n,) away by these equations (n, k), and how sure one cell is."""
    u, s, v = np.linalg.svd(rows, full_matrices=False)
    is_held = s >= _UNTOLD * s[0]
    solution: Floats = v[is_held].T @ ((u[:, is_held].T @ -apart_m) / s[is_held])
    left = apart_m + rows @ solution
    n_free = max(len(left) - int(np.count_nonzero(is_held)), 1)
    return solution, math.sqrt(float(left @ left) / n_free)


def _shortest_half(values: Floats) -> tuple[float, float]:
    """Return the ends of the shortest interval that holds half of the values."""
    ordered = np.sort(values)
    half = len(ordered) // 2
    k = int((ordered[half:] - ordered[: len(ordered) - half]).argmin())
    return float(ordered[k]), float(ordered[k + half])


def distance_apart(cells: Cells, way: tuple[Floats, Ints], of_point: Bools, rounded_m: float = 0.0) -> float | None:
    """Return how far the second station lies beyond the first along one way, metres; parameters as above.

    None where few cells hold points of both, a plane has stayed, or the largest that faces this way shows another
    distance: slabs that were seen from above and from below are double, and the floor is not.
    """
    normal, members = way
    found = _distances(cells, members, normal, of_point, rounded_m)
    if len(found) < _FEWEST_CELLS:
        return None
    off, where = np.array([each.apart_m for each in found]), np.array([each.place for each in found])
    apart_m = float(np.median(off))
    is_shown = np.abs(off - apart_m) <= 0.5 * abs(apart_m)
    # A station that leans, as levelling leaves it, moves every plane by as much as it is far away.
    of_planes = _of_planes(off, where @ normal)
    is_alike = np.abs(of_planes - apart_m) <= _ALIKE * abs(apart_m)
    if not len(of_planes) or _has_stayed(of_planes, apart_m) or is_alike.mean() < _MOST_ALIKE:
        return None
    is_floor = _is_on_largest(cells.middles()[members] @ normal, where[is_shown] @ normal)
    return float(off[is_shown].mean()) if is_floor and is_shown.mean() > 0.5 else None


def _distances(cells: Cells, members: Ints, normal: Floats, of_point: Bools, rounded_m: float) -> list[_Distance]:
    met = [_distance(cells, int(cell), normal, of_point, rounded_m) for cell in members]
    return [each for each in met if each is not None]


def _distance(cells: Cells, cell: int, normal: Floats, of_point: Bools, rounded_m: float) -> _Distance | None:
    """Return how far the second station's plane lies beyond the first's in a cell, None where either has few points."""
    own = slice(cells.starts[cell], cells.starts[cell] + cells.counts[cell])
    is_second = of_point[own]
    n_second = int(np.count_nonzero(is_second))
    if min(n_second, len(is_second) - n_second) < _FEWEST_OF_EACH:
        return None
    points = cells.points[own]
    r = points @ normal
    off = r - np.where(is_second, np.median(r[is_second]), np.median(r[~is_second]))
    # Where most lie on one step, the others belong to the surface too.
    is_near = np.abs(off) <= max(_BEYOND * max(mad_sigma(off), 1e-4), _ON_STEPS * rounded_m)
    second = is_second[is_near].astype(np.float64)
    n_second = int(np.count_nonzero(second))
    if min(n_second, len(second) - n_second) < _FEWEST_OF_EACH:
        return None
    place = points[is_near].mean(axis=0)
    across = points[is_near] - place
    across -= np.outer(across @ normal, normal)
    axes = np.linalg.svd(across, full_matrices=False)[2][:2]
    design = np.column_stack([np.ones(len(across)), across @ axes.T, second])
    found = np.linalg.lstsq(design, r[is_near], rcond=None)[0]
    left_m = r[is_near] - design @ found
    u_m = mad_sigma(left_m) * math.sqrt(1.0 / n_second + 1.0 / (len(second) - n_second))
    return _Distance(float(found[3]), u_m, place)
