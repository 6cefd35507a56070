"""Buildings without a staircase, to be scanned like one: what looks like steps here is none.

All lie on a level floor at z = 0 and are looked at from a walking line over that floor, along +x; their mesh, like a
stair's, is in metres. Each function takes nothing and gives the same building every time.
"""

import math
from collections.abc import Callable

import numpy as np

from stair_inspector.geometry.arrays import Point
from stair_inspector.model import FLOOR_LABEL, NON_STAIR_LABEL
from stair_inspector.simulation.footprints import Flat
from stair_inspector.simulation.shapes import COLOURS, Building, BuildingPart, BuiltSurface, Shapes
from stair_inspector.simulation.tops import around, upright_face

_WALL_M = 2.5
_BOARD_M = 0.02
_LEG_M = 0.05
_BLOCKS_SEED = 20
_N_BLOCKS = 15


def room() -> Building:
    """Return a room: floor, walls, a table, two chairs, a shelf of four boards and a window sill."""
    shapes = Shapes()
    _add_floor(shapes, (0.0, 4.5), (-1.75, 1.75))
    _add_walls(shapes, (0.0, 4.5), (-1.75, 1.75))
    _add_table(shapes, (2.2, -0.4), (1.4, 0.8), 0.74)
    for x in (2.35, 3.05):
        _add_chair(shapes, (x, 0.6))
    for height in (0.3, 0.6, 0.9, 1.2):
        _add_block(shapes, (1.0, 1.45, height - _BOARD_M), (1.0, 0.298, _BOARD_M), "table")
    _add_block(shapes, (4.25, -0.7, 0.85), (0.248, 1.4, 0.04), "side")
    return shapes.building(None, (), _straight_way(0.6, 2.0), "room")


def ramp() -> Building:
    """Return a ramp that climbs at 6 degrees for 4 m, with a level end before and behind it."""
    shapes = Shapes()
    half, length, slope = 0.75, 4.0, math.tan(math.radians(6.0))
    high = length * slope
    _add_floor(shapes, (-2.0, 0.0), (-1.0, 1.0))
    surface, side = _surface("side"), _surface("riser")
    shapes.quad([(0.0, -half, 0.0), (length, -half, high), (length, half, high), (0.0, half, 0.0)], surface)
    end = length + 1.5
    shapes.quad([(length, -half, high), (end, -half, high), (end, half, high), (length, half, high)], surface)
    for y in (-half, half):
        shapes.fan([(0.0, y, 0.0), (length, y, 0.0), (length, y, high)], side)
        shapes.quad(upright_face((length, y), (end, y), (0.0, 0.0), (high, high)), side)
    shapes.quad(upright_face((end, -half), (end, half), (0.0, 0.0), (high, high)), side)
    n_pieces = 16
    climb = [(length * i / n_pieces, 0.0, high * i / n_pieces) for i in range(n_pieces + 1)]
    return shapes.building(None, (), ((-1.2, 0.0, 0.0), *climb, (end - 0.7, 0.0, high)), "ramp")


def kerb() -> Building:
    """Return a floor and a kerb on it, 0.12 m high and 0.3 m deep."""
    shapes = Shapes()
    _add_floor(shapes, (-2.0, 2.3), (-1.5, 1.5))
    _add_block(shapes, (0.0, -1.5, 0.0), (0.3, 3.0, 0.12), "side")
    return shapes.building(None, (), _straight_way(-1.4, 1.7), "kerb")


def deep_kerb() -> Building:
    """Return a floor and behind it a pavement, 0.12 m higher and 3 m deep."""
    shapes = Shapes()
    _add_floor(shapes, (-2.0, 0.0), (-1.5, 1.5))
    _add_block(shapes, (0.0, -1.5, 0.0), (3.0, 3.0, 0.12), "side")
    walk = ((-1.4, 0.0, 0.0), (0.0, 0.0, 0.12), (2.4, 0.0, 0.12))
    return shapes.building(None, (), walk, "deep_kerb")


def blocks() -> Building:
    """Return 15 boxes of 0.1 to 0.5 m that lie about on a floor, each turned its own way."""
    shapes = Shapes()
    _add_floor(shapes, (-0.5, 4.5), (-2.0, 2.0))
    rng = np.random.Generator(np.random.PCG64(_BLOCKS_SEED))
    for _ in range(_N_BLOCKS):
        x, side, yaw = rng.uniform(0.5, 4.0), rng.choice((-1.0, 1.0)), rng.uniform(0.0, math.pi / 2.0)
        # The middle stays free for the way.
        y = side * rng.uniform(0.6, 1.6)
        length, width, height = rng.uniform(0.1, 0.5, 3)
        _add_turned_block(shapes, (float(x), float(y)), (float(length), float(width), float(height)), float(yaw))
    return shapes.building(None, (), _straight_way(0.0, 4.2), "blocks")


def shelves() -> Building:
    """Return a bookcase: ten boards one above the other, 0.17 m apart, all with the same front."""
    shapes = Shapes()
    _add_floor(shapes, (-2.5, 0.35), (-1.5, 1.5))
    depth, width, n_boards, apart = 0.3, 1.2, 10, 0.17
    high = apart * n_boards
    for index in range(n_boards):
        _add_block(shapes, (0.0, -width / 2.0, apart * (index + 1) - _BOARD_M), (depth, width, _BOARD_M), "table")
    for y in (-width / 2.0 - _BOARD_M, width / 2.0):
        _add_block(shapes, (0.0, y, 0.0), (depth, _BOARD_M, high), "table")
    _add_wall(shapes, (0.32, -1.5), (0.32, 1.5))
    return shapes.building(None, (), _straight_way(-1.8, -0.8), "shelves")


def stacked_boxes() -> Building:
    """Return a heap of boxes of various sizes against a wall."""
    shapes = Shapes()
    _add_floor(shapes, (-2.5, 1.2), (-1.5, 1.5))
    _add_wall(shapes, (1.2, -1.5), (1.2, 1.5))
    for low, size, colour in (
        ((0.55, -1.1, 0.0), (0.6, 0.7, 0.42), "box"),
        ((0.6, -1.0, 0.42), (0.5, 0.45, 0.33), "crate"),
        ((0.7, -0.95, 0.75), (0.4, 0.4, 0.21), "box"),
        ((0.3, -0.25, 0.0), (0.45, 0.55, 0.28), "box"),
        ((0.8, -0.3, 0.0), (0.38, 0.5, 0.61), "crate"),
        ((0.35, -0.15, 0.28), (0.35, 0.3, 0.17), "crate"),
        ((0.5, 0.45, 0.0), (0.65, 0.8, 0.36), "crate"),
        ((0.62, 0.5, 0.36), (0.5, 0.5, 0.36), "box"),
        ((0.1, 0.65, 0.0), (0.3, 0.35, 0.19), "box"),
    ):
        _add_block(shapes, low, size, colour)
    return shapes.building(None, (), _straight_way(-1.8, -0.4), "stacked_boxes")


def slope_terrace() -> Building:
    """Return two wide garden terraces, each 0.45 m high and 2 m deep."""
    shapes = Shapes()
    _add_floor(shapes, (-2.0, 0.0), (-2.0, 2.0))
    _add_block(shapes, (0.0, -2.0, 0.0), (2.0, 4.0, 0.45), "side")
    _add_block(shapes, (2.0, -2.0, 0.0), (2.0, 4.0, 0.9), "side")
    walk = ((-1.2, 0.0, 0.0), (0.0, 0.0, 0.45), (2.0, 0.0, 0.9), (3.2, 0.0, 0.9))
    return shapes.building(None, (), walk, "slope_terrace")


SCENES: dict[str, Callable[[], Building]] = {
    make.__name__: make for make in (room, ramp, kerb, deep_kerb, blocks, shelves, stacked_boxes, slope_terrace)
}
"""By name: what makes the building."""


def _surface(colour: str, part: BuildingPart = "clutter") -> BuiltSurface:
    return BuiltSurface(part, NON_STAIR_LABEL, COLOURS[colour])


def _straight_way(start_x: float, stop_x: float) -> tuple[Point, ...]:
    return ((start_x, 0.0, 0.0), (stop_x, 0.0, 0.0))


def _add_floor(shapes: Shapes, x: Flat, y: Flat) -> None:
    corners = [(x[0], y[0], 0.0), (x[1], y[0], 0.0), (x[1], y[1], 0.0), (x[0], y[1], 0.0)]
    shapes.quad(corners, BuiltSurface("floor", 0, COLOURS["floor"], FLOOR_LABEL))


def _add_walls(shapes: Shapes, x: Flat, y: Flat) -> None:
    """Add walls on the four sides of a rectangle."""
    corners = [(x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1])]
    for start, stop in around(corners):
        _add_wall(shapes, start, stop)


def _add_wall(shapes: Shapes, start: Flat, stop: Flat) -> None:
    shapes.quad(upright_face(start, stop, (0.0, 0.0), (_WALL_M, _WALL_M)), _surface("wall", "wall"))


def _add_block(shapes: Shapes, low: Point, size: Point, colour: str) -> None:
    high = (low[0] + size[0], low[1] + size[1], low[2] + size[2])
    shapes.box(low, high, _surface(colour))


def _add_turned_block(shapes: Shapes, middle: Flat, size: Point, yaw_rad: float) -> None:
    """Add a box on the floor that is turned about the vertical."""
    cos, sin = math.cos(yaw_rad), math.sin(yaw_rad)
    corners: list[Flat] = []
    for a, b in ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)):
        x, y = a * size[0], b * size[1]
        corners.append((middle[0] + cos * x - sin * y, middle[1] + sin * x + cos * y))
    shapes.quad([(*corner, size[2]) for corner in corners], _surface("box"))
    for start, stop in around(corners):
        shapes.quad(upright_face(start, stop, (0.0, 0.0), (size[2], size[2])), _surface("box"))


def _add_table(shapes: Shapes, middle: Flat, size: Flat, height: float) -> None:
    x0, y0 = middle[0] - size[0] / 2.0, middle[1] - size[1] / 2.0
    _add_block(shapes, (x0, y0, height - 0.03), (size[0], size[1], 0.03), "table")
    _add_legs(shapes, (x0, y0), size, height - 0.03)


def _add_chair(shapes: Shapes, low: Flat) -> None:
    """Add a chair with its seat at 0.45 m and a back behind it."""
    size = (0.42, 0.42)
    _add_block(shapes, (*low, 0.42), (*size, 0.03), "rail")
    _add_legs(shapes, low, size, 0.42)
    _add_block(shapes, (low[0], low[1] + size[1] - 0.03, 0.45), (size[0], 0.03, 0.45), "rail")


def _add_legs(shapes: Shapes, low: Flat, size: Flat, height: float) -> None:
    for x in (low[0], low[0] + size[0] - _LEG_M):
        for y in (low[1], low[1] + size[1] - _LEG_M):
            _add_block(shapes, (x, y, 0.0), (_LEG_M, _LEG_M, height), "rail")
