"""Which motions lay the stations of a file onto each other, where the file says which station saw each point?"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stair_inspector.geometry.arrays import Floats, Ints, Labels
from stair_inspector.model import Scan, ScanStations
from stair_inspector.stages.layers import Cells, sight_of
from stair_inspector.stages.station_motion import Motion, fit_motion

Ways = list[tuple[Floats, Ints]]
_MOST_POINTS = 300_000
_MOST_STATIONS = 16
"""The stations that saw most of the points; others stay where they are."""
_CELL_M = 0.15
_LEAST_M = 0.001
"""Stations nearer to each other stay: u of each level holds it."""
MOST_APART_M = 0.024
"""Farther apart it is asked: edges of treads, 25 to 40 mm thick, show two layers as well, told to a millimetre."""


@dataclass(frozen=True, slots=True, eq=False)
class LaidStations:
    """Which of the ``motions`` each point (n,) makes, from 1 on, 0 for none; whose each is, where the file tells it."""

    of_point: Labels
    motions: tuple[Motion, ...]
    stations: tuple[int, ...] = ()

    def places(self, points: Floats) -> Floats:
        """Return where points (n, 3) come to lie."""
        places = points.copy()
        for number, motion in enumerate(self.motions, start=1):
            own = self.of_point == number
            places[own] = motion.moved(points[own])
        return places


def lay_stations(
    scan: Scan, stations: ScanStations, ways_of: Callable[[Cells], Ways], step_m: float
) -> LaidStations | None:
    """Find the motions that lay each station onto those with more points.

    Parameters
    ----------
    scan : Scan
        With points of two stations at least.
    stations : ScanStations
        Its stations.
    ways_of : callable
        Returns the ways that cells face, each with its cells.
    step_m : float
        Step of the coordinates.

    Returns
    -------
    LaidStations or None
        None where all of them stay, or one lies farther off than MOST_APART_M.

    Notes
    -----
    The station with most points stays. One after the other, that which shares most cells with those that are laid is
    laid onto all of them. Where nothing that both saw tells a distance, it stays where the file has it. Where most
    points would move so, the largest station that does may stay instead.
    """
    counts = np.bincount(stations.of_point)
    in_order = sorted(stations.seen.tolist(), key=lambda k: -int(counts[k]))[:_MOST_STATIONS]
    laid = _laid_onto(scan, stations, in_order, ways_of, step_m)
    if laid is None or 2 * np.count_nonzero(laid.of_point) <= len(laid.of_point):
        return laid
    first = next(k for k in in_order if k in laid.stations)
    other = _laid_onto(scan, stations, [first, *(k for k in in_order if k != first)], ways_of, step_m)
    is_less = other is not None and np.count_nonzero(other.of_point) < np.count_nonzero(laid.of_point)
    return other if is_less else laid


def _laid_onto(
    scan: Scan, stations: ScanStations, in_order: list[int], ways_of: Callable[[Cells], Ways], step_m: float
) -> LaidStations | None:
    """Lay the others of these stations onto the first."""
    left = list(in_order)
    stride = -(-len(scan.points) // _MOST_POINTS)
    points = scan.points[::stride].copy()
    of_point = stations.of_point[::stride]
    sight = sight_of(scan.points, stations, stride)
    cells = _cells_of(points)
    is_laid = of_point == left.pop(0)
    motions: dict[int, Motion] = {}
    while left:
        laid = np.unique(cells[is_laid])
        own = max(left, key=lambda k: int(np.isin(np.unique(cells[of_point == k]), laid).sum()))
        left.remove(own)
        is_own = of_point == own
        rows = np.flatnonzero(is_laid | is_own)
        both = Cells(points[rows], sight=None if sight is None else sight[rows])
        motion = fit_motion(both, ways_of(both), is_own[rows][both.rows], step_m)
        if motion is not None:
            apart_m = float(np.linalg.norm(motion.shift))
            if apart_m > MOST_APART_M:
                return None
            if apart_m >= _LEAST_M:
                motions[own] = motion
                points[is_own] = motion.moved(points[is_own])
        is_laid |= is_own
    if not motions:
        return None
    moved = sorted(motions)
    numbers = np.zeros(len(stations.names), dtype=np.int16)
    numbers[moved] = np.arange(1, len(moved) + 1)
    return LaidStations(numbers[stations.of_point], tuple(motions[k] for k in moved), tuple(moved))


def _cells_of(points: Floats) -> Ints:
    """Return a number for the cell of each point (n,), the same for points of one cell."""
    places = np.floor((points - points.min(axis=0)) / _CELL_M).astype(np.int64)
    n_y, n_z = places[:, 1].max() + 1, places[:, 2].max() + 1
    keys: Ints = (places[:, 0] * n_y + places[:, 1]) * n_z + places[:, 2]
    return keys
