"""Can stations that do not lie over each other be laid onto each other?

Some files say which station saw each point. In others, two stations have their points one after the other: where
surfaces are double, the layers then part the file's order too, and so tell whose each point is. What lies between the
two layers, on all that is double, is the motion that lays one station onto the other.
"""

import itertools
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from stair_inspector.geometry.arrays import Bools, Floats, Ints, freeze
from stair_inspector.model import Examination, Moved, Observation, Scan
from stair_inspector.params import Method, Stations
from stair_inspector.stages.examine import size_text
from stair_inspector.stages.layers import SAME_WAY, Cells, find_ways, sight_of
from stair_inspector.stages.station_motion import Motion, fit_motion

_MOST_POINTS = 300_000
_MOST_M = 0.022
"""Farther apart it is asked: edges of treads, 25 to 40 mm thick, show two layers as well, and cut the order wrongly."""
_FEWEST_LABELLED = 400
_PURE = 0.97
"""Share of the points of one part of the file that lie in one layer. The cut between layers takes noise for a layer's
point now and then."""
_MOST_PARTS, _FEWEST_IN_PART = 16, 100
_LEAST_OF_STATION = 0.02
_BLOCK, _SPARSE, _CLEAR = 500, 0.2, 0.8
"""Points in a row; the share of the usual number of told ones among them, and by how much one layer must outweigh the
other in them, below which they tell nothing."""
_MOST_UNTOLD, _MOST_LEFT = 0.3, 0.05
"""Share of the points about which the order says nothing, between the last of one station and the first of the next: as
doubled cells alone show it, and when those are told too that lie where the station of others is known."""
_FEWEST_OF_EACH = 8
_LEAST_OF_LAYER, _MOST_BETWEEN = 0.05, 0.5
"""Share of a cell's points that the thinner of two layers has, and what of so many may lie between the two."""
_MOST_PLACES = 2000
_REMEDY = (
    "register the stations once more, cloud to cloud against floor and walls; to measure the file as it is: "
    "--stations as_read"
)


@dataclass(frozen=True, slots=True, eq=False)
class _Part:
    """Which points (n,) are of one station; its number and name where the file tells it."""

    is_own: Bools
    station: int | None = None
    name: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class _Told:
    """Whether each point (n,) is of the station of the higher layer, and whether the order leaves that untold."""

    is_high: Bools
    is_untold: Bools


def join_stations(
    scan: Scan, examined: Examination, stations: Stations, method: Method = "survey"
) -> tuple[Scan, Examination]:
    """Lay one station onto the others, where surfaces are double and the file, or its order, tells the stations.

    Parameters
    ----------
    scan, examined
        Of one file, its points in the file's order.
    stations, method
        'auto', or 'as_read' to leave every point where it is, as the paper's method always does.

    Returns
    -------
    Scan, Examination
        Unchanged where nothing is double, where nothing tells the stations, or where
        something would still be double afterwards.

    Notes
    -----
    Each cell of 150 mm that holds points of both gives one equation: the distance of the two planes along their normal
    is that of the motion there. Small turns and shifts are their least squares solution; what no surface holds, as a
    shift along a stair without sides, is not made. The larger part of the points stays.
    """
    doubled = [found for found in examined.observations if found.code == "surfaces_doubled"]
    shifts_m = examined.layers_m if doubled else examined.hints_m
    if stations == "as_read" or method == "paper" or not len(shifts_m) or scan.is_outward is not None:
        return scan, examined
    stride = -(-len(scan.points) // _MOST_POINTS)
    cells = Cells(scan.points[::stride], sight=sight_of(scan.points, scan.stations, stride))
    ways = cells.ways()
    for part in _parts(scan, cells, ways, stride, shifts_m):
        is_second = part.is_own
        motion = fit_motion(cells, ways, is_second[::stride][cells.rows])
        if motion is None or np.linalg.norm(motion.shift) > _MOST_M:
            continue
        points = scan.points.copy()
        points[is_second] = motion.moved(points[is_second])
        left = find_ways(points, examined.steps_m, scan.stations)
        if not any(way.is_sure or _is_along(way.normal, motion.shift) for way in left):
            return _laid(scan, examined, part, motion, points, doubled, shifts_m)
    return scan, examined


def _laid(
    scan: Scan,
    examined: Examination,
    part: _Part,
    motion: Motion,
    points: Floats,
    doubled: list[Observation],
    shifts_m: Floats,
) -> tuple[Scan, Examination]:
    """Return the scan with the points where they were laid, and what is said of it."""
    is_second = part.is_own
    place = motion.moved(np.zeros((1, 3)))[0]
    turn = motion.moved(np.eye(3)) - place
    # Stations that are so far apart along one direction may be so along those in which no surface shows it.
    unheld_m = float(np.linalg.norm(motion.shift)) * motion.unheld
    moved = Moved(freeze(is_second), freeze(turn.T.copy()), freeze(place.copy()), freeze(unheld_m))
    kept = tuple(found for found in examined.observations if found not in doubled)
    layers_m = shifts_m / np.linalg.norm(shifts_m, axis=1)[:, None] * motion.u_m
    observations = (*kept, _observe(motion, part))
    laid = replace(examined, observations=observations, layers_m=layers_m, moved=moved)
    normals = scan.normals
    if normals is not None:
        normals = np.where(is_second[:, None], normals @ turn, normals)
        normals = normals / np.linalg.norm(normals, axis=1)[:, None]
    stations = scan.stations
    if stations is not None and part.station is not None:
        places_m = stations.places_m.copy()
        places_m[part.station] = motion.moved(places_m[[part.station]])[0]
        stations = replace(stations, places_m=places_m)
    return replace(scan, points=freeze(points), normals=normals, stations=stations), laid


def _parts(scan: Scan, cells: Cells, ways: list[tuple[Floats, Ints]], stride: int, shifts_m: Floats) -> Iterator[_Part]:
    """Yield the parts of the scan of which one may be a station that lies apart from the others."""
    stations = scan.stations
    if stations is None or len(stations.seen) < 2:
        is_second = _tell_stations(scan.points, cells, ways, stride, shifts_m)
        if is_second is not None:
            yield _Part(~is_second if 2 * np.count_nonzero(is_second) > len(is_second) else is_second)
        return
    counts = np.bincount(stations.of_point)
    in_order = sorted(stations.seen.tolist(), key=lambda k: int(counts[k]))
    # Of two, either parts the scan alike; the larger stays.
    for k in in_order[:1] if len(in_order) == 2 else in_order[:_MOST_PARTS]:
        yield _Part(stations.of_point == k, k, stations.names[k])


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
        told = [_two_layers(cells, int(cell), normal, apart_m) for cell in members]
        rows, is_high = _together([each for each in told if each is not None])
        first = _by_order(points, stride * rows, is_high, _MOST_UNTOLD)
        if first is None:
            continue
        # What lies between the last of one and the first of the next goes with what is known where it lies.
        gap = first.is_untold[stride * cells.rows], first.is_high[stride * cells.rows]
        more = [_known_layers(cells, int(cell), normal, apart_m, *gap) for cell in members]
        rows, is_high = _together([(rows, is_high), *(each for each in more if each is not None)])
        second = _by_order(points, stride * rows, is_high, _MOST_LEFT)
        return None if second is None else second.is_high
    return None


def _together(told: list[tuple[Ints, Bools]]) -> tuple[Ints, Bools]:
    if not told:
        return np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.bool_)
    return np.concatenate([rows for rows, _ in told]), np.concatenate([is_high for _, is_high in told])


def _two_layers(cells: Cells, cell: int, normal: Floats, apart_m: float) -> tuple[Ints, Bools] | None:
    """Return which rows of a cell lie in two layers, and whether in the higher one; None where there is one layer."""
    own = slice(cells.starts[cell], cells.starts[cell] + cells.counts[cell])
    off = cells.points[own] @ normal
    low_m = _lower_of_two(off, apart_m)
    if low_m is None:
        return None
    off -= low_m + apart_m / 2.0
    is_near = np.abs(np.abs(off) - apart_m / 2.0) <= apart_m / 3.0
    return cells.rows[own][is_near], off[is_near] > 0.0


def _known_layers(
    cells: Cells, cell: int, normal: Floats, apart_m: float, is_untold: Bools, is_high: Bools
) -> tuple[Ints, Bools] | None:
    """Return the same of the points of a cell whose station is untold, from those whose station is known."""
    own = slice(cells.starts[cell], cells.starts[cell] + cells.counts[cell])
    off, untold, high = cells.points[own] @ normal, is_untold[own], is_high[own]
    of_low, of_high = off[~untold & ~high], off[~untold & high]
    if not untold.any() or max(len(of_low), len(of_high)) < _FEWEST_OF_EACH:
        return None
    is_low = len(of_low) >= len(of_high)
    middle = float(np.median(of_low)) + apart_m / 2.0 if is_low else float(np.median(of_high)) - apart_m / 2.0
    is_near = untold & (np.abs(np.abs(off - middle) - apart_m / 2.0) <= apart_m / 3.0)
    return cells.rows[own][is_near], off[is_near] > middle


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


def _by_order(points: Floats, rows: Ints, is_high: Bools, most_untold: float) -> _Told | None:
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
    told = _Told(np.zeros(len(points), dtype=np.bool_), np.zeros(len(points), dtype=np.bool_))
    begin = 0
    for k, cut in enumerate(cuts[1:-1]):
        last, first = _widened(rows, layer, cut, 1.0 if signs[k] else -1.0)
        told.is_untold[last + 1 : first] = True
        # The scanner's head is somewhere else when the next station begins.
        end = last + 1 + int(np.linalg.norm(np.diff(points[last : first + 1], axis=0), axis=1).argmax())
        told.is_high[begin:end] = signs[k]
        begin = end
    told.is_high[begin:] = signs[-1]
    share = float(told.is_high.mean())
    is_told = told.is_untold.mean() <= most_untold and min(share, 1.0 - share) >= _LEAST_OF_STATION
    return told if is_told else None


def _widened(rows: Ints, layer: Floats, cut: int, sign: float) -> tuple[int, int]:
    """Return the ends of the stretch at a cut about which the order says nothing; ``sign`` is the layer before it.

    Where few of the points of a station lie in two layers, those are at edges, in either layer, and tell nothing.
    """
    counts, sums = np.bincount(rows // _BLOCK), np.bincount(rows // _BLOCK, layer)
    is_dense = counts >= _SPARSE * np.median(counts[counts > 0])
    last, first = int(rows[cut - 1]), int(rows[cut])
    before, after = last // _BLOCK, first // _BLOCK
    while before > 0 and not (is_dense[before] and sign * sums[before] >= _CLEAR * counts[before]):
        before -= 1
    while after < len(counts) - 1 and not (is_dense[after] and -sign * sums[after] >= _CLEAR * counts[after]):
        after += 1
    return min(last, (before + 1) * _BLOCK - 1), max(first, after * _BLOCK)


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


def _observe(motion: Motion, part: _Part) -> Observation:
    size_m = float(np.linalg.norm(motion.shift))
    which = f"the file holds stations {size_text(size_m)} apart, one after the other"
    if part.station is not None:
        which = f"station '{part.name}' lies {size_text(size_m)} apart from the others"
    message = (
        f"surfaces were double: {which}; "
        f"{np.count_nonzero(part.is_own):,} of {len(part.is_own):,} points were laid onto the others before measuring, "
        f"to within {size_text(motion.u_m)} on each patch of surface"
    )
    return Observation("stations_joined", "doubt", message, size_m, _REMEDY)
