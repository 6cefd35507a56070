"""Staircases that the simulator has no words for: curved ones, treads of bars, things that stand on them.

Stair frame, as the simulator's: floor at z = 0, climb along +x at the foot, +y to the left of who climbs; metres.
"""

import itertools
import math
from dataclasses import dataclass, replace

import numpy as np

from stair_inspector.simulation.shapes import COLOURS, Building, BuildingPart, BuiltSurface, Shapes

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
    """An open stair whose treads are bars with gaps, along the climb or across it; the upper landing is whole.

    Across the climb the gaps are exactly as wide as given, and the last bar ends about where the next tread begins, as
    treads with an overhang or with open risers do. Along it the outermost bars are flush with the sides, and the gaps
    are as near to the width given as whole bars allow.
    """
    shapes = Shapes()
    half = stair.width_m / 2.0
    end = (stair.n_risers - 1) * stair.going_m + LANDING_M
    _quad(shapes, [(-FLOOR_M, -1.3, 0.0), (end, -1.3, 0.0), (end, 1.3, 0.0), (-FLOOR_M, 1.3, 0.0)], "floor")
    for k, height in enumerate(stair.heights_m()[:-1], 1):
        front = (k - 1) * stair.going_m
        across, length = (stair.width_m, stair.going_m) if is_along else (stair.going_m, stair.width_m)
        n_bars = max(2, round((across + gap_m) / (bar_m + gap_m)))
        pitch = (across - bar_m) / (n_bars - 1) if is_along else bar_m + gap_m
        for low in (i * pitch for i in range(n_bars)):
            x, y = (
                ((0.0, length), (low - half, low - half + bar_m)) if is_along else ((low, low + bar_m), (-half, half))
            )
            low_corner = (front + x[0], y[0], height - _BAR_HIGH_M)
            shapes.box(low_corner, (front + x[1], y[1], height), _surface("tread", k))
    top = stair.heights_m()[-1]
    shapes.box(((stair.n_risers - 1) * stair.going_m, -half, top - 0.05), (end, half, top), _surface("tread"))
    return Built(shapes.building(None, (), _way(stair), "bars"), _straight_nosings(stair))


@dataclass(frozen=True)
class Thing:
    """A box on a step: its place left of the middle, its sizes, and how high it floats, as a plant's leaves do.

    It stands in the middle of a tread's depth, or so far behind the nosing as is said.
    """

    step: int
    aside_m: float
    width_m: float
    depth_m: float
    high_m: float
    behind_m: float | None = None
    above_m: float = 0.0


def stood_on(stair: Plain, things: tuple[Thing, ...]) -> Built:
    """A solid stair on which things stand."""
    shapes = _solid(stair)
    for thing in things:
        behind_m = (stair.going_m - thing.depth_m) / 2.0 if thing.behind_m is None else thing.behind_m
        front = (thing.step - 1) * stair.going_m + behind_m
        low = stair.heights_m()[thing.step - 1] + thing.above_m
        corner = (front + thing.depth_m, thing.aside_m + thing.width_m / 2.0, low + thing.high_m)
        shapes.box((front, thing.aside_m - thing.width_m / 2.0, low), corner, _surface("box"))
    return Built(shapes.building(None, (), _way(stair), "things"), _straight_nosings(stair))


def with_runner(stair: Plain, thick_m: float, width_m: float, aside_m: float = 0.0) -> Built:
    """A solid stair with a runner of carpet on treads and risers, from the floor to the upper landing.

    The nosings are those of the stair under it.
    """
    shapes = _solid(stair)
    low, high = aside_m - width_m / 2.0, aside_m + width_m / 2.0
    for k, height in enumerate(stair.heights_m(), 1):
        front = (k - 1) * stair.going_m - thick_m
        shapes.box((front, low, height - stair.rise_m), (front + thick_m, high, height + thick_m), _surface("box"))
        back = front + stair.going_m if k < stair.n_risers else front + 0.3
        shapes.box((front, low, height), (back, high, height + thick_m), _surface("box"))
    return Built(shapes.building(None, (), _way(stair), "runner"), _straight_nosings(stair))


def beside(built: Built, apart_m: float, width_m: float) -> Built:
    """Two of the same staircases side by side, of this width and so far apart; the second is on the left."""
    import trimesh

    building, shift = built.building, np.array([0.0, width_m + apart_m, 0.0])
    moved = building.mesh.copy()
    moved.apply_translation(shift)
    both = replace(
        building,
        mesh=trimesh.util.concatenate([building.mesh, moved]),
        surface_of=np.concatenate([building.surface_of, building.surface_of + len(building.surfaces)]),
        surfaces=building.surfaces * 2,
        walk=tuple((x, y + float(shift[1]) / 2.0, z) for x, y, z in building.walk),
    )
    return Built(both, (*built.nosings, *(nosing + shift for nosing in built.nosings)))


def _solid(stair: Plain) -> Shapes:
    shapes = Shapes()
    half = stair.width_m / 2.0
    _quad(shapes, [(-FLOOR_M, -1.3, 0.0), (0.3, -1.3, 0.0), (0.3, 1.3, 0.0), (-FLOOR_M, 1.3, 0.0)], "floor")
    for k, height in enumerate(stair.heights_m(), 1):
        front = (k - 1) * stair.going_m
        back = front + (LANDING_M if k == stair.n_risers else stair.going_m)
        shapes.box((front, -half, 0.0), (back, half, height), _surface("tread", k))
    return shapes


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


def _surface(colour: str, level: int = -1) -> BuiltSurface:
    part: BuildingPart = "clutter"
    return BuiltSurface(part, level, COLOURS.get(colour, COLOURS["box"]))


def _quad(shapes: Shapes, corners: list[tuple[float, float, float]], colour: str, level: int = -1) -> None:
    shapes.quad(corners, _surface(colour, level))
