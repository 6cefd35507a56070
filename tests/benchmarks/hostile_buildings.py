"""Staircases that the simulator has no words for: curved ones, treads of bars, things that stand on them.

Stair frame, as the simulator's: floor at z = 0, climb along +x at the foot, +y to the left of who climbs; metres.
"""

import itertools
import math
from dataclasses import dataclass

import numpy as np

from stair_inspector.simulate.shapes import COLOURS, Building, Part, Shapes, Surface

FLOOR_M = 2.2
LANDING_M = 1.5
_BAR_HIGH_M = 0.03


@dataclass(frozen=True)
class Plain:
    """A staircase of ``n_risers`` even risers; goings are those of the middle line."""

    n_risers: int = 7
    rise_m: float = 0.172
    going_m: float = 0.288
    width_m: float = 1.1

    def heights_m(self) -> list[float]:
        """Height of each step, from the first to the upper landing."""
        return [k * self.rise_m for k in range(1, self.n_risers + 1)]


@dataclass(frozen=True, eq=False)
class Built:
    """A building and the two ends (2, 3) of every nosing, from the first to the upper landing's."""

    building: Building
    nosings: tuple[np.ndarray, ...]


def curved(stair: Plain, radius_m: float, is_left: bool) -> Built:
    """A solid stair whose nosings all point to one centre, ``radius_m`` from the middle line."""
    shapes = Shapes()
    turn = stair.going_m / radius_m
    inner, outer = radius_m - stair.width_m / 2.0, radius_m + stair.width_m / 2.0
    side = 1.0 if is_left else -1.0

    def at(radius: float, angle: float, height: float) -> tuple[float, float, float]:
        return radius * math.sin(angle), side * (radius_m - radius * math.cos(angle)), height

    span = stair.width_m
    _quad(shapes, [(-FLOOR_M, -span, 0.0), (0.3, -span, 0.0), (0.3, span, 0.0), (-FLOOR_M, span, 0.0)], "floor")
    nosings = []
    way = [(-FLOOR_M / 2.0, 0.0, 0.0)]
    for k, height in enumerate(stair.heights_m(), 1):
        start = (k - 1) * turn
        stop = start + (LANDING_M / radius_m if k == stair.n_risers else turn)
        below = height - stair.rise_m
        ends = np.array([at(inner, start, height), at(outer, start, height)])
        nosings.append(ends if is_left else ends[::-1])
        _quad(shapes, [at(inner, start, below), at(outer, start, below), *map(tuple, ends[::-1])], "riser")
        # Short pieces, so that the arcs are round to a hundredth of a millimetre.
        angles = np.linspace(start, stop, 9)
        for low, high in itertools.pairwise(angles):
            tread = [at(inner, low, height), at(outer, low, height), at(outer, high, height), at(inner, high, height)]
            _quad(shapes, tread, "tread", k)
            for radius in (inner, outer):
                wall = [at(radius, low, 0.0), at(radius, high, 0.0), at(radius, high, height), at(radius, low, height)]
                _quad(shapes, wall, "side")
        way.append(at(radius_m, (start + stop) / 2.0, height))
    return Built(shapes.building(None, (), tuple(way), "curved"), tuple(nosings))


def of_bars(stair: Plain, bar_m: float, gap_m: float, is_along: bool) -> Built:
    """An open stair whose treads are bars with gaps, along the climb or across it; the upper landing is whole."""
    shapes = Shapes()
    half = stair.width_m / 2.0
    end = (stair.n_risers - 1) * stair.going_m + LANDING_M
    _quad(shapes, [(-FLOOR_M, -1.3, 0.0), (end, -1.3, 0.0), (end, 1.3, 0.0), (-FLOOR_M, 1.3, 0.0)], "floor")
    for k, height in enumerate(stair.heights_m()[:-1], 1):
        front = (k - 1) * stair.going_m
        across, length = (stair.width_m, stair.going_m) if is_along else (stair.going_m, stair.width_m)
        # As many whole bars as fit, the outermost flush with the edges.
        n_bars = int((across + gap_m) // (bar_m + gap_m))
        pitch = (across - bar_m) / (n_bars - 1)
        for low in (i * pitch for i in range(n_bars)):
            x, y = (
                ((0.0, length), (low - half, low - half + bar_m)) if is_along else ((low, low + bar_m), (-half, half))
            )
            low_corner = (front + x[0], y[0], height - _BAR_HIGH_M)
            shapes.box(low_corner, (front + x[1], y[1], height), _surface("tread", k))
    top = stair.heights_m()[-1]
    shapes.box(((stair.n_risers - 1) * stair.going_m, -half, top - 0.05), (end, half, top), _surface("tread"))
    return Built(shapes.building(None, (), _way(stair), "bars"), _straight_nosings(stair))


def stood_on(stair: Plain, things: tuple[tuple[int, float, float, float, float], ...]) -> Built:
    """A solid stair on which things stand: step, place left of the middle, width, depth and height of each."""
    shapes = Shapes()
    half = stair.width_m / 2.0
    _quad(shapes, [(-FLOOR_M, -1.3, 0.0), (0.3, -1.3, 0.0), (0.3, 1.3, 0.0), (-FLOOR_M, 1.3, 0.0)], "floor")
    for k, height in enumerate(stair.heights_m(), 1):
        front = (k - 1) * stair.going_m
        back = front + (LANDING_M if k == stair.n_risers else stair.going_m)
        shapes.box((front, -half, 0.0), (back, half, height), _surface("tread", k))
    for step, aside, width, depth, high in things:
        front = (step - 1) * stair.going_m + (stair.going_m - depth) / 2.0
        low = stair.heights_m()[step - 1]
        corner = (front + depth, aside + width / 2.0, low + high)
        shapes.box((front, aside - width / 2.0, low), corner, _surface("box"))
    return Built(shapes.building(None, (), _way(stair), "things"), _straight_nosings(stair))


def _straight_nosings(stair: Plain) -> tuple[np.ndarray, ...]:
    half = stair.width_m / 2.0
    return tuple(
        np.array([[k * stair.going_m, half, height], [k * stair.going_m, -half, height]])
        for k, height in enumerate(stair.heights_m())
    )


def _way(stair: Plain) -> tuple[tuple[float, float, float], ...]:
    last = (stair.n_risers - 1) * stair.going_m + LANDING_M / 2.0
    steps = [((k + 0.5) * stair.going_m, 0.0, height) for k, height in enumerate(stair.heights_m()[:-1])]
    return ((-0.75 * FLOOR_M, 0.0, 0.0), *steps, (last, 0.0, stair.heights_m()[-1]))


def _surface(colour: str, level: int = -1) -> Surface:
    part: Part = "clutter"
    return Surface(part, level, COLOURS.get(colour, COLOURS["box"]))


def _quad(shapes: Shapes, corners: list[tuple[float, float, float]], colour: str, level: int = -1) -> None:
    shapes.quad(corners, _surface(colour, level))
