"""Where does the scanner stand? Beside the way up, in turn on the left and on the right."""

import itertools
import math
from dataclasses import dataclass

import numpy as np

from stair_inspector.geometry.arrays import Point
from stair_inspector.simulation.scanner_specs import Scanner
from stair_inspector.simulation.shapes import Building

_ASIDE = 0.1  # Stations stand this share of the width beside the way, left and right in turn.


@dataclass(frozen=True, slots=True)
class Station:
    """Where the scanner stood and what is wrong with the pose it reports.

    ``position`` (stair frame, metres) is true; the reported points are turned by ``tilt_rad`` about the level axis
    with azimuth ``tilt_azimuth_rad`` through the position, and then shifted by ``shift_m``. ``heading_rad`` is the
    azimuth at the middle of the field of view: that of the way at this station.
    """

    position: Point
    shift_m: Point
    tilt_rad: float
    tilt_azimuth_rad: float
    heading_rad: float = 0.0


def place_stations(building: Building, scanner: Scanner, rng: np.random.Generator) -> tuple[Station, ...]:
    """Place the stations along the way up, and draw the errors of their poses.

    Parameters
    ----------
    building : Building
        The first station stands on its floor, the last on its upper landing, the others evenly between in plan, along
        the middles of the steps; they stand a tenth of the width left and right of the middle in turn. A scene is
        scanned from its own walking line.
    scanner : Scanner
        Number of stations, height, standoff and errors.
    rng : Generator
        Source of the errors.
    """
    stair = building.stair
    walk = building.walk
    if stair is not None:
        walk = ((-min(scanner.standoff_m, stair.floor_front_m), 0.0, 0.0), *walk)
    aside_m = _ASIDE * (stair.width_m if stair is not None else 1.0)
    drift = rng.standard_normal(3)
    drift /= math.sqrt(float((drift * drift).sum()))
    stations: list[Station] = []
    travelled, previous = 0.0, None
    for index in range(scanner.stations):
        share = 0.0 if scanner.stations == 1 else index / (scanner.stations - 1)
        (x, y, ground), heading_rad = _on_the_way(walk, share)
        aside = aside_m if index % 2 == 0 else -aside_m
        position = (
            x - aside * math.sin(heading_rad),
            y + aside * math.cos(heading_rad),
            ground + scanner.sensor_height_m,
        )
        if previous is not None:
            travelled += math.dist(position, previous)
        previous = position
        draws = rng.standard_normal(4)
        # The first station is the frame of the others.
        shifts = (draws[:3] * scanner.registration_m if index else np.zeros(3)) + drift * (
            scanner.drift_m_per_m * travelled
        )
        stations.append(
            Station(
                position=position,
                shift_m=(float(shifts[0]), float(shifts[1]), float(shifts[2])),
                tilt_rad=math.radians(scanner.tilt_deg) * float(draws[3]),
                tilt_azimuth_rad=2.0 * math.pi * float(rng.random()),
                heading_rad=heading_rad,
            )
        )
    return tuple(stations)


def _on_the_way(walk: tuple[Point, ...], share: float) -> tuple[Point, float]:
    """Return the point at a share of a line's length as seen from above, and the line's azimuth there, radians.

    Its height is that of the last corner passed, as on steps.
    """
    lengths = [math.dist(start[:2], stop[:2]) for start, stop in itertools.pairwise(walk)]
    wanted, passed = share * sum(lengths), 0.0
    piece = 0
    # A hair before a corner counts as on it: sums of lengths are not exact.
    while piece + 1 < len(lengths) and passed + lengths[piece] <= wanted + 1e-9:
        passed += lengths[piece]
        piece += 1
    (x0, y0, ground), (x1, y1, _) = walk[piece], walk[piece + 1]
    part = (wanted - passed) / lengths[piece]
    return (x0 + (x1 - x0) * part, y0 + (y1 - y0) * part, ground), math.atan2(y1 - y0, x1 - x0)
