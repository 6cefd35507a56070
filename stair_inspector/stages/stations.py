"""Can stations that do not lie over each other be laid onto each other?

Some files say which station saw each point. In others, two stations have their points one after the other: where
surfaces are double, the layers then part the file's order too, and so tell whose each point is. What lies between the
two layers, on all that is double, is the motion that lays one station onto the other.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from stair_inspector.geometry.arrays import Bools, Floats, Ints, freeze
from stair_inspector.model import Examination, Moved, Observation, Scan
from stair_inspector.params import Method, Stations
from stair_inspector.stages.examine import CURES, size_text
from stair_inspector.stages.layers import Cells, find_ways, sight_of
from stair_inspector.stages.order_shifts import LEAST_APART_M, find_order_shift, flat_ways
from stair_inspector.stages.station_layers import FEWEST_LABELLED, is_along, tell_stations
from stair_inspector.stages.station_motion import Motion, distance_apart, fit_motion

_MOST_POINTS, _MOST_FOR_MEANS = 300_000, 100_000
_MOST_M = 0.022
"""Farther apart it is asked: edges of treads, 25 to 40 mm thick, show two layers as well, and cut the order wrongly."""
_MOST_PARTS = 16
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
    if scan.is_outward is not None or len(scan.points) < FEWEST_LABELLED:
        return scan, examined
    is_left = stations == "as_read" or method == "paper"
    if is_left and len(examined.layers_m):
        return scan, examined
    laid = None if is_left else _laid_by_layers(scan, examined)
    return _laid_by_means(scan, examined, is_left=is_left) if laid is None else laid


def _doubled(examined: Examination) -> list[Observation]:
    return [found for found in examined.observations if found.code == "surfaces_doubled"]


def _laid_by_layers(scan: Scan, examined: Examination) -> tuple[Scan, Examination] | None:
    """Lay a station onto the others where two layers show; None where they show nothing, or nothing fits."""
    shifts_m = examined.layers_m if _doubled(examined) else examined.hints_m
    if not len(shifts_m):
        return None
    cut = _Cut.of(scan, _MOST_POINTS)
    is_second = None
    if not _is_told(scan):
        is_second = tell_stations(scan.points, cut.cells, cut.ways, cut.stride, shifts_m)
        if is_second is None:
            return None
    return _laid(scan, examined, shifts_m, cut, is_second)


def _laid_by_means(scan: Scan, examined: Examination, *, is_left: bool) -> tuple[Scan, Examination]:
    """Do the same where means of many points tell what layers do not; where nothing can be laid, say what they show."""
    cut = _Cut.of(scan, _MOST_FOR_MEANS, is_flat=True)
    shift = find_order_shift(scan.points, cut.cells, cut.ways, cut.stride)
    if shift is None:
        return scan, examined
    way = next(each for each in cut.ways if each[0] is shift.normal)
    is_low = shift.is_low[:: cut.stride][cut.cells.rows]
    apart_m = distance_apart(cut.cells, way, is_low, float(examined.steps_m.max()))
    if apart_m is None or abs(apart_m) < LEAST_APART_M:
        return scan, examined
    shifts_m = (apart_m * shift.normal)[None]
    is_shown = not is_left and (shift.is_two or _is_told(scan))
    laid = _laid(scan, examined, shifts_m, cut, shift.is_low) if is_shown else None
    if laid is not None or len(examined.layers_m):
        return laid or (scan, examined)
    observations = (*examined.observations, _observe_means(abs(apart_m)))
    return scan, replace(examined, observations=observations, layers_m=freeze(shifts_m))


@dataclass(frozen=True, slots=True, eq=False)
class _Cut:
    """Every ``stride``-th point of a scan in cells, and the ways that they face."""

    cells: Cells
    ways: list[tuple[Floats, Ints]]
    stride: int

    @classmethod
    def of(cls, scan: Scan, most: int, *, is_flat: bool = False) -> "_Cut":
        """Put at most so many points in cells; ``is_flat`` leaves out those with an edge."""
        stride = -(-len(scan.points) // most)
        cells = Cells(scan.points[::stride], sight=sight_of(scan.points, scan.stations, stride))
        return cls(cells, flat_ways(cells) if is_flat else cells.ways(), stride)


def _laid(
    scan: Scan, examined: Examination, shifts_m: Floats, cut: _Cut, is_second: Bools | None
) -> tuple[Scan, Examination] | None:
    """Return the scan with a station laid onto the others, and what is said of it; None where no station fits.

    ``is_second`` (n,) are the points of one, where the file does not tell its stations.
    """
    for part in _parts(scan, is_second):
        is_own = part.is_own
        motion = fit_motion(cut.cells, cut.ways, is_own[:: cut.stride][cut.cells.rows], float(examined.steps_m.max()))
        if motion is None or np.linalg.norm(motion.shift) > _MOST_M:
            continue
        points = scan.points.copy()
        points[is_own] = motion.moved(points[is_own])
        left = find_ways(points, examined.steps_m, scan.stations)
        if not any(way.is_sure or is_along(way.normal, motion.shift) for way in left):
            return _with_motion(scan, examined, part, motion, points, shifts_m)
    return None


def _with_motion(
    scan: Scan, examined: Examination, part: _Part, motion: Motion, points: Floats, shifts_m: Floats
) -> tuple[Scan, Examination]:
    """Return the scan with the points where they were laid, and what is said of it."""
    is_second = part.is_own
    place = motion.moved(np.zeros((1, 3)))[0]
    turn = motion.moved(np.eye(3)) - place
    # Stations that are so far apart along one direction may be so along those in which no surface shows it.
    unheld_m = float(np.linalg.norm(motion.shift)) * motion.unheld
    moved = Moved(freeze(is_second), freeze(turn.T.copy()), freeze(place.copy()), freeze(unheld_m))
    doubled = _doubled(examined)
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


def _is_told(scan: Scan) -> bool:
    """Return whether the file says which station saw each point."""
    return scan.stations is not None and len(scan.stations.seen) > 1


def _parts(scan: Scan, is_second: Bools | None) -> Iterator[_Part]:
    """Yield the parts of the scan of which one may be a station that lies apart from the others."""
    stations = scan.stations
    if stations is None or not _is_told(scan):
        if is_second is not None:
            yield _Part(~is_second if 2 * np.count_nonzero(is_second) > len(is_second) else is_second)
        return
    counts = np.bincount(stations.of_point)
    in_order = sorted(stations.seen.tolist(), key=lambda k: int(counts[k]))
    # Of two, either parts the scan alike; the larger stays.
    for k in in_order[:1] if len(in_order) == 2 else in_order[:_MOST_PARTS]:
        yield _Part(stations.of_point == k, k, stations.names[k])


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


def _observe_means(apart_m: float) -> Observation:
    message = (
        f"surfaces are double, {size_text(apart_m)} apart: noise or rounding fills the gap, but in the order of the "
        "points their mean changes by so much; stations that do not lie over each other"
    )
    return Observation("surfaces_doubled", "doubt", message, apart_m, CURES["surfaces_doubled"])
