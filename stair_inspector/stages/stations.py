"""Can stations that do not lie over each other be laid onto each other?

Some files say which station saw each point. In others, two stations have their points one after the other: where
surfaces are double, the layers then part the file's order too, and so tell whose each point is. What lies between the
two layers, on all that is double, is the motion that lays one station onto the other.
"""

from dataclasses import dataclass, replace

import numpy as np

from stair_inspector.geometry.arrays import Bools, Floats, Ints, freeze
from stair_inspector.model import Examination, Moved, Observation, Scan, ScanStations
from stair_inspector.params import Method, Stations
from stair_inspector.stages.examine import CURES, size_text
from stair_inspector.stages.known_stations import MOST_APART_M, LaidStations, lay_stations
from stair_inspector.stages.layers import LEAST_STEPS, Cells, find_ways, sight_of
from stair_inspector.stages.looked_through import say_looked_through
from stair_inspector.stages.order_shifts import LEAST_APART_M, find_order_shift, flat_ways
from stair_inspector.stages.seen_through import with_sight
from stair_inspector.stages.station_layers import FEWEST_LABELLED, is_along, tell_stations
from stair_inspector.stages.station_motion import OF_STEP, Motion, distance_apart, fit_motion

_MOST_POINTS, _MOST_FOR_MEANS = 300_000, 100_000
_NAME_CHARACTERS = 60
_FILLED_SIGMAS = 6.0
"""Layers so many standard deviations of their points apart are told from each other by eye."""
_MOST_NAMES = 5
_REMEDY = (
    "register the stations once more, cloud to cloud against floor and walls; to measure the file as it is: "
    "--stations as_read"
)


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
        something would still be double afterwards; but it is said where known stations do not agree then.

    Notes
    -----
    Each cell of 150 mm that holds points of both gives one equation: the distance of the two planes along their normal
    is that of the motion there. Small turns and shifts are their least squares solution; what no surface holds, as a
    shift along a stair without sides, is not made. The larger part of the points stays.
    """
    if scan.is_outward is not None or len(scan.points) < FEWEST_LABELLED:
        return scan, examined
    joined, examined = _join(scan, examined, is_left=stations == "as_read" or method == "paper")
    return joined, with_sight(joined, say_looked_through(joined, examined))


def _join(scan: Scan, examined: Examination, *, is_left: bool) -> tuple[Scan, Examination]:
    """Do what is asked of :func:`join_stations`; ``is_left`` leaves every point where it is."""
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
    if _is_told(scan) and not is_left:
        # Whose each point is needs no guess, and no layer need be seen.
        laid = _laid(scan, examined, None, cut, None)
        if laid is not None:
            return laid
    step_m = float(examined.steps_m.max())
    shift = find_order_shift(scan.points, cut.cells, cut.ways, cut.stride, step_m)
    if shift is None:
        return scan, examined
    way = next(each for each in cut.ways if each[0] is shift.normal)
    is_low = shift.is_low[:: cut.stride][cut.cells.rows]
    apart_m = distance_apart(cut.cells, way, is_low, step_m)
    if apart_m is None or abs(apart_m) < LEAST_APART_M:
        return scan, examined
    # Layers farther apart than noise or rounding can fill would show: then it is two surfaces, no two stations.
    # Rounding moves the distance by half a step, too.
    if abs(apart_m) > max(_FILLED_SIGMAS * shift.noise_m, (LEAST_STEPS + OF_STEP) * step_m):
        return scan, examined
    shifts_m = (apart_m * shift.normal)[None]
    is_shown = not is_left and shift.is_two and shift.is_told and not _is_told(scan)
    laid = _laid(scan, examined, shifts_m, cut, shift.is_low) if is_shown else None
    # Many places are the path of a scanner that is carried: what its drift leaves, its preset states.
    if laid is not None or len(examined.layers_m) or not shift.is_two:
        return laid or (scan, examined)
    observations = (*examined.observations, _observe_means(abs(apart_m)))
    return scan, replace(examined, observations=observations, layers_m=freeze(shifts_m), is_by_order=True)


@dataclass(frozen=True, slots=True, eq=False)
class _Cut:
    """Every ``stride``-th point of a scan in cells, and the ways that they face; ``is_flat`` without cells at edges."""

    cells: Cells
    ways: list[tuple[Floats, Ints]]
    stride: int
    is_flat: bool

    @classmethod
    def of(cls, scan: Scan, most: int, *, is_flat: bool = False) -> "_Cut":
        """Put at most so many points in cells."""
        stride = -(-len(scan.points) // most)
        cells = Cells(scan.points[::stride], sight=sight_of(scan.points, scan.stations, stride))
        return cls(cells, flat_ways(cells) if is_flat else cells.ways(), stride, is_flat)


def _laid(
    scan: Scan, examined: Examination, shifts_m: Floats | None, cut: _Cut, is_second: Bools | None
) -> tuple[Scan, Examination] | None:
    """Return the scan with a station laid onto the others, and what is said of it; None where no station fits.

    ``shifts_m`` (k, 3) are those that layers show, None where none do; ``is_second`` (n,) are the points of one
    station, where the file does not tell them.
    """
    known = scan.stations if _is_told(scan) else None
    step_m = float(examined.steps_m.max())
    if known is not None:
        laid = lay_stations(scan, known, flat_ways if cut.is_flat else Cells.ways, step_m)
    else:
        laid = None if is_second is None else _second_laid(cut, is_second, step_m)
    if laid is None:
        return None
    if shifts_m is None:
        shifts_m = np.array([motion.shift for motion in laid.motions])
        shifts_m = shifts_m[np.linalg.norm(shifts_m, axis=1) >= LEAST_APART_M]
        if not len(shifts_m):
            return None
    points = laid.places(scan.points)
    for way in find_ways(points, examined.steps_m, scan.stations):
        if way.is_sure or any(is_along(way.normal, motion.shift) for motion in laid.motions):
            return None
    doubled = _doubled(examined)
    kept = tuple(found for found in examined.observations if found not in doubled)
    layers_m = shifts_m / np.linalg.norm(shifts_m, axis=1)[:, None] * max(motion.u_m for motion in laid.motions)
    moved = _moved(laid)
    normals = scan.normals
    if normals is not None:
        normals = np.einsum("nij,nj->ni", moved.turns[moved.of_point], normals)
        normals = normals / np.linalg.norm(normals, axis=1)[:, None]
    if known is not None:
        places_m = known.places_m.copy()
        for station, motion in zip(laid.stations, laid.motions, strict=True):
            places_m[station] = motion.moved(places_m[[station]])[0]
        known = replace(known, places_m=places_m)
    observations = (*kept, _observe(laid, known))
    return (
        replace(scan, points=freeze(points), normals=normals, stations=known or scan.stations),
        replace(examined, observations=observations, layers_m=layers_m, moved=moved),
    )


def _second_laid(cut: _Cut, is_second: Bools, step_m: float) -> LaidStations | None:
    """Return the motion that lays the smaller of two parts of the file onto the other."""
    if 2 * np.count_nonzero(is_second) > len(is_second):
        is_second = ~is_second
    motion = fit_motion(cut.cells, cut.ways, is_second[:: cut.stride][cut.cells.rows], step_m)
    if motion is None or np.linalg.norm(motion.shift) > MOST_APART_M:
        return None
    return LaidStations(is_second.astype(np.int16), (motion,))


def _moved(laid: LaidStations) -> Moved:
    """Return how the points were moved, and the shifts that may be left where no surface shows them."""
    turns, shifts_m = [np.eye(3)], [np.zeros(3)]
    unheld_m: list[Floats] = []
    for motion in laid.motions:
        place = motion.moved(np.zeros((1, 3)))[0]
        turns.append((motion.moved(np.eye(3)) - place).T)
        shifts_m.append(place)
    # Stations that are so far apart along one direction may be so along those in which no surface shows it.
    for motion in sorted(laid.motions, key=lambda each: -float(np.linalg.norm(each.shift))):
        new = [each for each in motion.unheld if not any(is_along(each, known) for known in unheld_m)]
        unheld_m += [_untold_m(motion) * each for each in new]
    return Moved(
        freeze(laid.of_point.copy()),
        freeze(np.array(turns)),
        freeze(np.array(shifts_m)),
        freeze(np.array(unheld_m).reshape(-1, 3)),
    )


def _untold_m(motion: Motion) -> float:
    """Return how far apart stations may be where no surface shows it, a standard deviation.

    One that was raised little was not for that moved little aside: within k = 2 lies at least what can be laid.
    """
    return max(float(np.linalg.norm(motion.shift)), MOST_APART_M / 2.0)


def _is_told(scan: Scan) -> bool:
    """Return whether the file says which station saw each point."""
    return scan.stations is not None and len(scan.stations.seen) > 1


def _observe(laid: LaidStations, stations: ScanStations | None) -> Observation:
    size_m = max(float(np.linalg.norm(motion.shift)) for motion in laid.motions)
    which = f"the file holds stations {size_text(size_m)} apart, one after the other"
    if stations is not None:
        names = ", ".join(f"'{stations.names[k][:_NAME_CHARACTERS]}'" for k in laid.stations[:_MOST_NAMES])
        more = f" and {len(laid.stations) - _MOST_NAMES} more" * (len(laid.stations) > _MOST_NAMES)
        one = len(laid.stations) == 1
        which = (
            f"{'station' if one else 'stations'} {names}{more} {'lies' if one else 'lie up to'} {size_text(size_m)} "
            "apart from the others"
        )
    message = (
        f"surfaces were double: {which}; "
        f"{np.count_nonzero(laid.of_point):,} of {len(laid.of_point):,} points were laid onto the others before "
        f"measuring, to within {size_text(max(motion.u_m for motion in laid.motions))} on each patch of surface"
    )
    untold_m = max((_untold_m(motion) for motion in laid.motions if len(motion.unheld)), default=None)
    if untold_m is not None:
        message += (
            "; along some direction no surface shows how they lie, and they were not moved: U of the widths holds "
            f"{size_text(2.0 * untold_m)} of that if it is aside, and, if it is along the climb, U of goings and "
            "depths between ends of treads or faces that different stations saw"
        )
    return Observation("stations_joined", "doubt", message, size_m, _REMEDY)


def _observe_means(apart_m: float) -> Observation:
    message = (
        f"surfaces are double, {size_text(apart_m)} apart: noise or rounding fills the gap, but in the order of the "
        "points their mean changes by so much; stations that do not lie over each other"
    )
    return Observation("doubled_by_order", "doubt", message, apart_m, CURES["surfaces_doubled"])
