"""Can stations that do not lie over each other be laid onto each other?

Two stations in one file have their points one after the other. Where surfaces are double, the layers then part the
file's order too, and so tell whose each point is; what lies between the two layers, on all that is double, is the
motion that lays one station onto the other.
"""

import itertools
import math
from dataclasses import dataclass, replace

import numpy as np

from stair_inspector.geometry.arrays import Bools, Floats, Ints, freeze
from stair_inspector.geometry.percentiles import MAD_TO_SIGMA
from stair_inspector.geometry.trimmed import fit_trimmed, height_above
from stair_inspector.model import Examination, Moved, Observation, Scan
from stair_inspector.params import Method, Stations
from stair_inspector.stages.examine import size_text
from stair_inspector.stages.layers import FEWEST_ON_PLANE, FEWEST_PLANES, SAME_PLANE_M, SAME_WAY, Cells, find_doubled

_MOST_POINTS = 300_000
_FEWEST_LABELLED = 400
_PURE = 0.97
"""Share of the points of one part of the file that lie in one layer. The cut between layers takes noise for a layer's
point now and then."""
_MOST_PARTS, _FEWEST_IN_PART = 16, 100
_LEAST_OF_STATION = 0.02
_MOST_UNTOLD = 0.03
"""Share of the points about which the order says nothing, between the last of one station and the first of the next."""
_FEWEST_OF_EACH, _FEWEST_CELLS = 8, 10
"""Points of each station in a cell, and cells that face one way, that tell a shift."""
_LEAST_OF_LAYER, _MOST_BETWEEN = 0.05, 0.5
"""Share of a cell's points that the thinner of two layers has, and what of so many may lie between the two."""
_MOST_PLACES = 2000
_BEYOND = 3.0
"""Cells that stray farther, in robust standard deviations, show two surfaces and not one twice."""
_MOST_SPREAD_M = 0.0005
"""Half of the cells that face one way agree on their distance so well, beyond what noise does."""
_AGREEING = 0.75
"""Share of these cells whose distance is that."""
_STAYED = 0.25
"""A plane on which both lie nearer than this share of it has stayed: where one station saw the upper faces of slabs and
the other their undersides, the floor is not double. Two planes show it: a pane seen from both sides is one."""
_TURNED = 0.9
"""A turn is made where it leaves so much less between the stations."""
_UNTOLD = 0.05
"""Motions that the surfaces hold less firmly, as a share of the firmest, are not made."""
_REMEDY = (
    "register the stations once more, cloud to cloud against floor and walls; to measure the file as it is: "
    "--stations as_read"
)


@dataclass(frozen=True, slots=True, eq=False)
class _Distance:
    """How far two planes lie apart in a cell, its standard uncertainty, and the cell's ``place`` (3,); metres."""

    apart_m: float
    u_m: float
    place: Floats


@dataclass(frozen=True, slots=True, eq=False)
class _Motion:
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


def join_stations(
    scan: Scan, examined: Examination, stations: Stations, method: Method = "survey"
) -> tuple[Scan, Examination]:
    """Lay one station onto the other, where surfaces are double and the order of the points tells the stations.

    Parameters
    ----------
    scan, examined
        Of one file, its points in the file's order.
    stations, method
        'auto', or 'as_read' to leave every point where it is, as the paper's method always does.

    Returns
    -------
    Scan, Examination
        Unchanged where nothing is double, where the order tells nothing, or where
        something would still be double afterwards.

    Notes
    -----
    Each cell of 150 mm that holds points of both gives one equation: the distance of the two planes along their normal
    is that of the motion there. Small turns and shifts are their least squares solution; what no surface holds, as a
    shift along a stair without sides, is not made. The larger part of the points stays.
    """
    doubled = [found for found in examined.observations if found.code == "surfaces_doubled"]
    if stations == "as_read" or method == "paper" or not doubled or not len(examined.layers_m):
        return scan, examined
    stride = -(-len(scan.points) // _MOST_POINTS)
    cells = Cells(scan.points[::stride])
    ways = cells.ways()
    is_second = _tell_stations(scan.points, cells, ways, stride, examined.layers_m)
    if is_second is None:
        return scan, examined
    if 2 * np.count_nonzero(is_second) > len(is_second):
        is_second = ~is_second
    motion = _fit_motion(cells, ways, is_second[::stride][cells.rows])
    if motion is None:
        return scan, examined
    points = scan.points.copy()
    points[is_second] = motion.moved(points[is_second])
    if find_doubled(points, examined.steps_m):
        return scan, examined
    place = motion.moved(np.zeros((1, 3)))[0]
    turn = motion.moved(np.eye(3)) - place
    # Stations that are so far apart along one direction may be so along those in which no surface shows it.
    unheld_m = float(np.linalg.norm(motion.shift)) * motion.unheld
    moved = Moved(freeze(is_second), freeze(turn.T.copy()), freeze(place.copy()), freeze(unheld_m))
    kept = tuple(found for found in examined.observations if found is not doubled[0])
    layers_m = examined.layers_m / np.linalg.norm(examined.layers_m, axis=1)[:, None] * motion.u_m
    observations = (*kept, _observe(doubled[0], motion, is_second))
    laid = replace(examined, observations=observations, layers_m=layers_m, moved=moved)
    normals = scan.normals
    if normals is not None:
        normals = np.where(is_second[:, None], normals @ turn, normals)
        normals = normals / np.linalg.norm(normals, axis=1)[:, None]
    return replace(scan, points=freeze(points), normals=normals), laid


def _tell_stations(
    points: Floats, cells: Cells, ways: list[tuple[Floats, Ints]], stride: int, layers_m: Floats
) -> Bools | None:
    """Return which points are of the second station, None where the order of the points does not tell.

    The cells hold every ``stride``-th point.
    """
    largest = layers_m[int(np.linalg.norm(layers_m, axis=1).argmax())]
    apart_m = float(np.linalg.norm(largest))
    for normal, members in ways:
        if abs(float(normal @ largest)) < SAME_WAY * apart_m:
            continue
        rows, is_high = [], []
        for cell in members:
            own = slice(cells.starts[cell], cells.starts[cell] + cells.counts[cell])
            off = cells.points[own] @ normal
            low_m = _lower_of_two(off, apart_m)
            if low_m is not None:
                off -= low_m + apart_m / 2.0
                is_near = np.abs(np.abs(off) - apart_m / 2.0) <= apart_m / 3.0
                rows.append(stride * cells.rows[own][is_near])
                is_high.append(off[is_near] > 0.0)
        if rows:
            return _by_order(points, np.concatenate(rows), np.concatenate(is_high))
    return None


def _lower_of_two(off: Floats, apart_m: float) -> float | None:
    """Return where the lower of two layers lies that are so far apart, None where there are no two.

    With their distance known, a layer that few points are of is found as well, where the cut in halves does not see it.
    """
    width_m = apart_m / 3.0
    ordered = np.sort(off)
    places = np.arange(ordered[0] - apart_m, ordered[-1], width_m / 4.0)
    if len(places) > _MOST_PLACES:
        return None

    def count(low: Floats, high: Floats) -> Ints:
        return np.searchsorted(ordered, high, side="right") - np.searchsorted(ordered, low, side="left")

    below, above = (
        count(places - width_m, places + width_m),
        count(places + apart_m - width_m, places + apart_m + width_m),
    )
    k = int((below + above).argmax())
    less = min(int(below[k]), int(above[k]))
    if less < max(_FEWEST_OF_EACH, _LEAST_OF_LAYER * len(off)):
        return None
    between = int(count(places[k] + width_m, places[k] + 2.0 * width_m))
    return float(places[k]) if between <= _MOST_BETWEEN * less else None


def _by_order(points: Floats, rows: Ints, is_high: Bools) -> Bools | None:
    """Return of which station every point is, from the layer in which some of them lie."""
    if len(rows) < _FEWEST_LABELLED:
        return None
    order = np.argsort(rows)
    rows, layer = rows[order], np.where(is_high[order], 1.0, -1.0)
    cuts = [0, *sorted(_cuts(layer, 0, _MOST_PARTS)), len(rows)]
    signs = []
    for begin, end in itertools.pairwise(cuts):
        part = layer[begin:end]
        if end - begin < _FEWEST_IN_PART or abs(float(part.mean())) < 2.0 * _PURE - 1.0:
            return None
        signs.append(part.mean() > 0.0)
    is_second = np.zeros(len(points), dtype=np.bool_)
    untold = 0
    begin = 0
    for k, cut in enumerate(cuts[1:-1]):
        last, first = int(rows[cut - 1]), int(rows[cut])
        untold += first - last
        # The scanner's head is somewhere else when the next station begins.
        end = last + 1 + int(np.linalg.norm(np.diff(points[last : first + 1], axis=0), axis=1).argmax())
        is_second[begin:end] = signs[k]
        begin = end
    is_second[begin:] = signs[-1]
    share = float(is_second.mean())
    if untold > _MOST_UNTOLD * len(points) or min(share, 1.0 - share) < _LEAST_OF_STATION:
        return None
    return is_second


def _cuts(layer: Floats, begin: int, most: int) -> list[int]:
    """Return where a row of -1 and 1 goes over from one to the other, each place where sums before and after differ."""
    n = len(layer)
    if n < 2 * _FEWEST_IN_PART or most <= 1 or abs(float(layer.mean())) >= 2.0 * _PURE - 1.0:
        return []
    sums = np.cumsum(layer)
    cut = 1 + int(np.abs(sums - sums[-1] * np.arange(1, n + 1) / n)[:-1].argmax())
    return [
        *_cuts(layer[:cut], begin, most // 2),
        begin + cut,
        *_cuts(layer[cut:], begin + cut, most // 2),
    ]


def _fit_motion(cells: Cells, ways: list[tuple[Floats, Ints]], of_point: Bools) -> _Motion | None:
    """Return the motion that lays the second station onto the first, from the cells that hold points of both."""
    normals, places, apart = [], [], []
    usual_m = np.inf
    for normal, members in ways:
        met = [_distance(cells, int(cell), normal, of_point) for cell in members]
        found = [each for each in met if each is not None and each.u_m <= usual_m]
        if len(found) < _FEWEST_CELLS:
            continue
        # Most cells face the first way; others that scatter much more hold an edge.
        usual_m = min(usual_m, _BEYOND * float(np.median([each.u_m for each in found])))
        off = np.array([each.apart_m for each in found])
        where = np.array([each.place for each in found])
        near = _agreeing(_without_slope(off, where, normal), where @ normal, np.median([each.u_m for each in found]))
        if near is None:
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
    motion = _Motion(centre, np.zeros(3), shift, u_m, axes[held < _UNTOLD * held[0]])
    both, u_both_m = _solve(np.hstack([n, turning]), d)
    if u_both_m < _TURNED * u_m:
        motion = replace(motion, turn=both[3:] / reach, shift=both[:3], u_m=u_both_m)
    return motion


def _agreeing(apart_m: Floats, offset_m: Floats, u_m: float) -> Bools | None:
    """Return which cells (n,) that face one way show the distance on which they agree, None where they do not agree.

    ``offset_m`` (n,) are their places along their normal: those of one plane lie together.
    """
    low, high = _shortest_half(apart_m)
    # The face of a nosing seen by one and that of the riser by the other are not one surface twice.
    if high - low > _MOST_SPREAD_M + _BEYOND * u_m:
        return None
    middle, reach_m = 0.5 * (low + high), _BEYOND * max(high - low, 1e-4)
    near: Bools = np.abs(apart_m - middle) <= reach_m
    order = np.argsort(offset_m)
    planes = np.split(order, 1 + np.flatnonzero(np.diff(offset_m[order]) > SAME_PLANE_M))
    of_planes = np.array([np.median(apart_m[each]) for each in planes if len(each) >= FEWEST_ON_PLANE])
    is_shown = np.count_nonzero(np.abs(of_planes - middle) <= reach_m) >= FEWEST_PLANES
    has_stayed = bool((np.abs(of_planes) < _STAYED * abs(middle)).any())
    return near if is_shown and not has_stayed and near.mean() >= _AGREEING else None


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


def _distance(cells: Cells, cell: int, normal: Floats, of_point: Bools) -> _Distance | None:
    """Return how far the second station's plane lies beyond the first's in a cell, None where either has few points."""
    own = slice(cells.starts[cell], cells.starts[cell] + cells.counts[cell])
    is_second = of_point[own]
    n_second = int(np.count_nonzero(is_second))
    if min(n_second, len(is_second) - n_second) < _FEWEST_OF_EACH:
        return None
    points = cells.points[own]
    r = points @ normal
    off = r - np.where(is_second, np.median(r[is_second]), np.median(r[~is_second]))
    is_near = np.abs(off) <= _BEYOND * max(_sigma(off), 1e-4)
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
    u_m = _sigma(left_m) * math.sqrt(1.0 / n_second + 1.0 / (len(second) - n_second))
    return _Distance(float(found[3]), u_m, place)


def _sigma(values: Floats) -> float:
    """Return the robust standard deviation of values."""
    return MAD_TO_SIGMA * float(np.median(np.abs(values - np.median(values))))


def _observe(doubled: Observation, motion: _Motion, is_second: Bools) -> Observation:
    size_m = float(np.linalg.norm(motion.shift))
    message = (
        f"surfaces were double: the file holds stations {size_text(size_m)} apart, one after the other; "
        f"{np.count_nonzero(is_second):,} of {len(is_second):,} points were laid onto the others before measuring, "
        f"to within {size_text(motion.u_m)} on each patch of surface"
    )
    return Observation("stations_joined", "doubt", message, size_m, _REMEDY)
