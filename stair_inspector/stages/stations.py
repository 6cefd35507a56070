"""Can stations that do not lie over each other be laid onto each other?

Two stations in one file have their points one after the other. Where surfaces are double, the layers then part the
file's order too, and so tell whose each point is; what lies between the two layers, on all that is double, is the
motion that lays one station onto the other.
"""

import itertools
from dataclasses import replace

import numpy as np

from stair_inspector.geometry.arrays import Bools, Floats, Ints, freeze
from stair_inspector.model import Examination, Moved, Observation, Scan
from stair_inspector.params import Method, Stations
from stair_inspector.stages.examine import size_text
from stair_inspector.stages.layers import SAME_WAY, Cells, find_ways
from stair_inspector.stages.station_motion import Motion, fit_motion

_MOST_POINTS = 300_000
_FEWEST_LABELLED = 400
_PURE = 0.97
"""Share of the points of one part of the file that lie in one layer. The cut between layers takes noise for a layer's
point now and then."""
_MOST_PARTS, _FEWEST_IN_PART = 16, 100
_LEAST_OF_STATION = 0.02
_MOST_UNTOLD = 0.03
"""Share of the points about which the order says nothing, between the last of one station and the first of the next."""
_FEWEST_OF_EACH = 8
_LEAST_OF_LAYER, _MOST_BETWEEN = 0.05, 0.5
"""Share of a cell's points that the thinner of two layers has, and what of so many may lie between the two."""
_MOST_PLACES = 2000
_REMEDY = (
    "register the stations once more, cloud to cloud against floor and walls; to measure the file as it is: "
    "--stations as_read"
)


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
    shifts_m = examined.layers_m if doubled else examined.hints_m
    if stations == "as_read" or method == "paper" or not len(shifts_m):
        return scan, examined
    stride = -(-len(scan.points) // _MOST_POINTS)
    cells = Cells(scan.points[::stride])
    ways = cells.ways()
    is_second = _tell_stations(scan.points, cells, ways, stride, shifts_m)
    if is_second is None:
        return scan, examined
    if 2 * np.count_nonzero(is_second) > len(is_second):
        is_second = ~is_second
    motion = fit_motion(cells, ways, is_second[::stride][cells.rows])
    if motion is None:
        return scan, examined
    points = scan.points.copy()
    points[is_second] = motion.moved(points[is_second])
    if any(way.is_sure or _is_along(way.normal, motion.shift) for way in find_ways(points, examined.steps_m)):
        return scan, examined
    place = motion.moved(np.zeros((1, 3)))[0]
    turn = motion.moved(np.eye(3)) - place
    # Stations that are so far apart along one direction may be so along those in which no surface shows it.
    unheld_m = float(np.linalg.norm(motion.shift)) * motion.unheld
    moved = Moved(freeze(is_second), freeze(turn.T.copy()), freeze(place.copy()), freeze(unheld_m))
    kept = tuple(found for found in examined.observations if found not in doubled)
    layers_m = shifts_m / np.linalg.norm(shifts_m, axis=1)[:, None] * motion.u_m
    observations = (*kept, _observe(motion, is_second))
    laid = replace(examined, observations=observations, layers_m=layers_m, moved=moved)
    normals = scan.normals
    if normals is not None:
        normals = np.where(is_second[:, None], normals @ turn, normals)
        normals = normals / np.linalg.norm(normals, axis=1)[:, None]
    return replace(scan, points=freeze(points), normals=normals), laid


def _is_along(normal: Floats, shift: Floats) -> bool:
    return abs(float(normal @ shift)) >= SAME_WAY * float(np.linalg.norm(shift))


def _tell_stations(
    points: Floats, cells: Cells, ways: list[tuple[Floats, Ints]], stride: int, layers_m: Floats
) -> Bools | None:
    """Return which points are of the second station, None where the order of the points does not tell.

    The cells hold every ``stride``-th point.
    """
    largest = layers_m[int(np.linalg.norm(layers_m, axis=1).argmax())]
    apart_m = float(np.linalg.norm(largest))
    for normal, members in ways:
        if not _is_along(normal, largest):
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


def _observe(motion: Motion, is_second: Bools) -> Observation:
    size_m = float(np.linalg.norm(motion.shift))
    message = (
        f"surfaces were double: the file holds stations {size_text(size_m)} apart, one after the other; "
        f"{np.count_nonzero(is_second):,} of {len(is_second):,} points were laid onto the others before measuring, "
        f"to within {size_text(motion.u_m)} on each patch of surface"
    )
    return Observation("stations_joined", "doubt", message, size_m, _REMEDY)
