"""Builds a staircase of known geometry: takes a Stair, gives a mesh whose every surface is named, and the truth.

The stair frame: z up, the stair climbs along +x, the foot of the first riser is x = 0, the floor z = 0, the middle of
the width y = 0; so left, as seen when climbing, is +y. The output frame has the site's yaw and offset on top.
"""

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from stair_inspector.geometry.arrays import Floats, Ints, own
from stair_inspector.model import FLOOR_LABEL, NON_STAIR_LABEL
from stair_inspector.simulate.specs import SLAB_M, Stair, parse_errors, parse_offset

Part = Literal["floor", "tread", "landing", "riser", "nosing", "side", "beam", "wall", "ceiling", "clutter"]
Point = tuple[float, float, float]

_STRIP_M = 0.05  # The contrasting strip at a nosing: colour only, it lies in the plane of the tread.
_DISH_CELLS = (12, 16)  # Along the depth and across; a 5 mm dish is then within 0.05 mm of the curve.
_LEAST_AREA_M2 = 1e-9
_BEAM_M = (0.06, 0.2)  # Width and height of the two beams that carry treads without risers.

_RGB: dict[str, tuple[int, int, int]] = {
    "floor": (176, 172, 165),
    "tread": (201, 171, 132),
    "strip": (112, 88, 64),
    "riser": (226, 221, 210),
    "side": (198, 194, 186),
    "landing": (193, 163, 125),
    "beam": (92, 94, 98),
    "wall": (224, 219, 207),
    "ceiling": (238, 237, 232),
    "table": (142, 98, 62),
    "box": (170, 136, 92),
    "crate": (74, 106, 138),
    "rail": (70, 72, 76),
}


@dataclass(frozen=True, slots=True)
class Surface:
    """One flat or smooth surface: what it is part of, the level it belongs to (-1 none), its colour.

    ``label`` is what a perfect segmentation says of its points: 0 floor, k top of step k, -1 anything else. ``crease``
    is an axis (0 x, 2 z) and a coordinate, metres in the stair frame, where light gets lost in an inner corner.
    """

    part: Part
    level: int
    rgb: tuple[int, int, int]
    label: int = NON_STAIR_LABEL
    crease: tuple[int, float] | None = None


@dataclass(frozen=True, slots=True)
class StepTruth:
    """The true measures of one step, metres and degrees; ``nosing`` holds its left and right end, stair frame.

    ``rise_m`` is to this step, from the nosing (or floor) below, at the middle of the width; ``going_m`` is from this
    step to the next, None for the upper landing; ``tread_depth_m`` runs to the riser above, or to the back edge.
    """

    step_id: int
    flight: int
    kind: Literal["tread", "landing"]
    rise_m: float
    going_m: float | None
    tread_depth_m: float
    width_m: float
    nosing_overhang_m: float
    height_m: float
    fall_deg: float
    cross_fall_deg: float
    dish_m: float
    nosing: tuple[Point, Point]


@dataclass(frozen=True, slots=True, eq=False)
class Building:
    """The staircase and its surroundings as a mesh in the stair frame.

    ``mesh`` is a ``trimesh.Trimesh``; ``surface_of`` (n_triangles,) gives the surface of each of its faces.
    """

    stair: Stair
    mesh: Any
    surface_of: Ints
    surfaces: tuple[Surface, ...]
    steps: tuple[StepTruth, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "surface_of", own(self.surface_of, (len(self.mesh.faces),), "surface_of", np.int64))


def build(stair: Stair) -> Building:
    """Build the mesh of a staircase, and its truth.

    Parameters
    ----------
    stair : Stair
        What to build.

    Returns
    -------
    Building
        In the stair frame, metres.
    """
    steps = lay_out(stair)
    shapes = _Shapes()
    end_x = _end_x(stair, steps)
    _add_floor(shapes, stair, end_x)
    for step in steps:
        _add_step(shapes, stair, step, _back_x(step, stair), steps[step.step_id - 2] if step.step_id > 1 else None)
    if stair.open_risers:
        _add_beams(shapes, stair, steps)
    _add_walls(shapes, stair, steps, end_x)
    if stair.clutter:
        _add_clutter(shapes, stair, steps)
    return shapes.building(stair, steps)


def lay_out(stair: Stair) -> tuple[StepTruth, ...]:
    """Return the true measures of every step, from the bottom up; the last one is the upper landing.

    Notes
    -----
    Flights are counted from 1; a landing is the last step of the flight that leads to it.
    """
    last = stair.n_risers
    rise_errors = parse_errors("stair.rise_errors_m", stair.rise_errors_m, last, math.inf)
    going_errors = parse_errors("stair.going_errors_m", stair.going_errors_m, last, math.inf)
    falls = parse_errors("stair.fall_errors_deg", stair.fall_errors_deg, last, math.inf)
    cross_falls = parse_errors("stair.cross_fall_errors_deg", stair.cross_fall_errors_deg, last, math.inf)
    dishes = parse_errors("stair.dish_errors_m", stair.dish_errors_m, last, math.inf)
    steps: list[StepTruth] = []
    height, nosing_x = 0.0, -stair.overhang_m
    half = stair.width_m / 2.0
    for k in range(1, last + 1):
        rise = stair.rise_m + rise_errors.get(k, 0.0)
        height += rise
        is_landing = k in (stair.landing_after, last)
        going: float | None = (stair.landing_depth_m if is_landing else stair.going_m) + going_errors.get(k, 0.0)
        depth = stair.upper_landing_m if k == last else (going or 0.0) + stair.overhang_m
        if k == last:
            going = None
        lift = half * math.tan(math.radians(cross_falls.get(k, 0.0)))
        steps.append(
            StepTruth(
                step_id=k,
                flight=2 if 0 < stair.landing_after < k else 1,
                kind="landing" if is_landing else "tread",
                rise_m=rise,
                going_m=going,
                tread_depth_m=depth,
                width_m=stair.width_m,
                nosing_overhang_m=stair.overhang_m,
                height_m=height,
                fall_deg=falls.get(k, 0.0),
                cross_fall_deg=cross_falls.get(k, 0.0),
                dish_m=dishes.get(k, 0.0),
                nosing=((nosing_x, half, height + lift), (nosing_x, -half, height - lift)),
            )
        )
        nosing_x += going or 0.0
    return tuple(steps)


def output_from_stair(stair: Stair, points: Floats) -> Floats:
    """Return points of the stair frame in the output frame.

    Parameters
    ----------
    stair : Stair
        Its yaw and offset are applied.
    points : (n, 3), metres
        Stair frame.
    """
    cos, sin = math.cos(math.radians(stair.yaw_deg)), math.sin(math.radians(stair.yaw_deg))
    x, y, z = points.T
    dx, dy, dz = parse_offset(stair.offset_m)
    return np.stack([cos * x - sin * y + dx, sin * x + cos * y + dy, z + dz], axis=1)


class _Shapes:
    """Collects triangles and their surfaces."""

    def __init__(self) -> None:
        self._meshes: list[Any] = []
        self._surface_of: list[Ints] = []
        self._surfaces: list[Surface] = []

    def add(self, vertices: Floats, faces: Ints, surface: Surface) -> None:
        """Add triangles that form one surface; those without area, as at a nosing without overhang, are left out."""
        import trimesh

        a, b, c = (vertices[faces[:, corner]] for corner in range(3))
        faces = faces[np.abs(np.cross(b - a, c - a)).max(axis=1) > _LEAST_AREA_M2]
        if not len(faces):
            return
        self._meshes.append(trimesh.Trimesh(vertices=vertices, faces=faces, process=False))
        self._surface_of.append(np.full(len(faces), len(self._surfaces), dtype=np.int64))
        self._surfaces.append(surface)

    def quad(self, corners: Sequence[Point], surface: Surface) -> None:
        """Add a flat four-cornered surface, corners in order around it."""
        self.add(np.array(corners, dtype=np.float64), np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int64), surface)

    def box(self, low: Point, high: Point, surface: Surface) -> None:
        """Add the six sides of an upright box."""
        import trimesh

        box = trimesh.creation.box(bounds=[low, high])
        normals = box.face_normals
        for axis in range(3):
            for sign in (-1.0, 1.0):
                faces = np.asarray(box.faces)[normals[:, axis] * sign > 0.5]
                self.add(np.asarray(box.vertices), faces, surface)

    def rod(self, start: Point, end: Point, radius_m: float, surface: Surface) -> None:
        """Add a round rod."""
        import trimesh

        rod = trimesh.creation.cylinder(radius=radius_m, segment=[start, end], sections=12)
        self.add(np.asarray(rod.vertices), np.asarray(rod.faces), surface)

    def building(self, stair: Stair, steps: tuple[StepTruth, ...]) -> Building:
        """Return everything that was added."""
        import trimesh

        mesh = trimesh.util.concatenate(self._meshes)
        return Building(stair, mesh, np.concatenate(self._surface_of), tuple(self._surfaces), steps)


def _back_x(step: StepTruth, stair: Stair) -> float:
    """Return where the top of a step ends: at the face of the riser above, or at the landing's back edge."""
    return step.nosing[0][0] + step.tread_depth_m


def _end_x(stair: Stair, steps: tuple[StepTruth, ...]) -> float:
    return _back_x(steps[-1], stair)


def _top(step: StepTruth) -> Callable[[float, float], float]:
    """Return the height of a step's top, without its dish, as a function of x and y."""
    fall, cross = math.tan(math.radians(step.fall_deg)), math.tan(math.radians(step.cross_fall_deg))
    nosing_x = step.nosing[0][0]
    return lambda x, y: step.height_m + (x - nosing_x) * fall + y * cross


def _add_floor(shapes: _Shapes, stair: Stair, end_x: float) -> None:
    half = stair.floor_width_m / 2.0
    # A solid stair stands on the floor; one sees the floor through a stair without risers.
    back = end_x if stair.open_risers else 0.0
    shapes.quad(
        [(-stair.floor_front_m, -half, 0.0), (back, -half, 0.0), (back, half, 0.0), (-stair.floor_front_m, half, 0.0)],
        Surface("floor", 0, _RGB["floor"], FLOOR_LABEL, None if stair.open_risers else (0, 0.0)),
    )


def _add_step(shapes: _Shapes, stair: Stair, step: StepTruth, back: float, below: StepTruth | None) -> None:
    """Add the top, the slab's visible faces and, unless risers are open, the body under it."""
    k, half, top = step.step_id, stair.width_m / 2.0, _top(step)
    front = step.nosing[0][0]
    riser = front + stair.overhang_m
    base = step.height_m - SLAB_M - half * abs(math.tan(math.radians(step.cross_fall_deg)))
    # Under a tread that falls backwards the slab must still have a thickness.
    base += min(0.0, top(back, 0.0) - step.height_m)
    crease = (0, back) if k < stair.n_risers and not stair.open_risers else None
    colour = _RGB[step.kind]
    strip = Surface(step.kind, k, _RGB["strip"], k, crease)
    if step.dish_m:
        shapes.add(*_dished(step, front, back), Surface(step.kind, k, colour, k, crease))
    else:
        for start, stop, surface in (
            (front, front + _STRIP_M, strip),
            (front + _STRIP_M, back, Surface(step.kind, k, colour, k, crease)),
        ):
            shapes.quad([(x, y, top(x, y)) for x, y in _around(start, stop, half)], surface)
    upright = Surface("nosing", k, _RGB["strip"])
    shapes.quad(
        [(front, -half, base), (front, half, base), (front, half, top(front, half)), (front, -half, top(front, -half))],
        upright,
    )
    side = Surface("side", k, _RGB["side"])
    for y in (-half, half):
        shapes.quad([(front, y, base), (back, y, base), (back, y, top(back, y)), (front, y, top(front, y))], side)
    if stair.open_risers:
        # A slab in the air overlaps the nosing above it by the overhang, as planks do, and shows its underside.
        shapes.quad([(x, y, base) for x, y in _around(front, back, half)], side)
        shapes.quad(
            [(back, -half, base), (back, half, base), (back, half, top(back, half)), (back, -half, top(back, -half))],
            side,
        )
        return
    shapes.quad([(x, y, base) for x, y in _around(front, riser, half)], upright)
    foot = _top(below) if below is not None else lambda x, y: 0.0
    low = [foot(riser, y) for y in (-half, half)]
    shapes.quad(
        [(riser, -half, low[0]), (riser, half, low[1]), (riser, half, base), (riser, -half, base)],
        Surface("riser", k, _RGB["riser"], crease=(2, (low[0] + low[1]) / 2.0)),
    )
    for y in (-half, half):
        shapes.quad([(riser, y, 0.0), (back, y, 0.0), (back, y, base), (riser, y, base)], side)
    if k == stair.n_risers:
        shapes.quad(
            [(back, -half, 0.0), (back, half, 0.0), (back, half, top(back, half)), (back, -half, top(back, -half))],
            side,
        )


def _around(start_x: float, stop_x: float, half: float) -> list[tuple[float, float]]:
    return [(start_x, -half), (stop_x, -half), (stop_x, half), (start_x, half)]


def _dished(step: StepTruth, front: float, back: float) -> tuple[Floats, Ints]:
    """Return the top of a worn step as a grid: deepest in the middle, unworn along its four edges."""
    rows, columns = _DISH_CELLS
    s, t = np.meshgrid(np.linspace(0.0, 1.0, rows + 1), np.linspace(-1.0, 1.0, columns + 1), indexing="ij")
    fall, cross = math.tan(math.radians(step.fall_deg)), math.tan(math.radians(step.cross_fall_deg))
    x = front + (back - front) * s
    y = t * step.width_m / 2.0
    z = step.height_m + (x - front) * fall + y * cross - step.dish_m * 4.0 * s * (1.0 - s) * (1.0 - t * t)
    corner = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)[None, :]).ravel()
    right, ahead = corner + 1, corner + columns + 1
    faces = np.concatenate([np.stack([corner, ahead, ahead + 1], 1), np.stack([corner, ahead + 1, right], 1)])
    return np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1), faces


def _add_beams(shapes: _Shapes, stair: Stair, steps: tuple[StepTruth, ...]) -> None:
    """Carry the treads of each flight, and the landings, by two beams underneath."""
    width, height = _BEAM_M
    surface = Surface("beam", NON_STAIR_LABEL, _RGB["beam"])
    ends: list[tuple[float, float, float, float]] = []
    for flight in sorted({step.flight for step in steps}):
        chain = [step for step in steps if step.flight == flight]
        before = steps[chain[0].step_id - 2] if chain[0].step_id > 1 else None
        foot = (_back_x(before, stair), before.height_m) if before else (chain[0].nosing[0][0], 0.0)
        head = chain[-1]
        under = SLAB_M + 0.01
        ends.append((foot[0], max(foot[1] - under, 0.0), head.nosing[0][0] + 0.02, head.height_m - under - 0.02))
        ends.append((head.nosing[0][0] + 0.02, head.height_m - under, _back_x(head, stair), head.height_m - under))
    for x0, z0, x1, z1 in ends:
        if x1 - x0 < 0.05:
            continue
        for middle in (-0.3 * stair.width_m, 0.3 * stair.width_m):
            left, right = middle + width / 2.0, middle - width / 2.0
            low0, low1 = max(z0 - height, 0.0), max(z1 - height, 0.0)
            for y in (left, right):
                shapes.quad([(x0, y, low0), (x1, y, low1), (x1, y, z1), (x0, y, z0)], surface)
            for a, b in ((z0, z1), (low0, low1)):
                shapes.quad([(x0, left, a), (x1, left, b), (x1, right, b), (x0, right, a)], surface)


def _add_walls(shapes: _Shapes, stair: Stair, steps: tuple[StepTruth, ...], end_x: float) -> None:
    half = stair.width_m / 2.0
    roof = steps[-1].height_m + stair.headroom_m
    start = -stair.floor_front_m
    # A hair outside the treads, so that no two faces share a plane.
    for side, y in (("left", half + 0.001), ("right", -half - 0.001)):
        if stair.wall in (side, "both"):
            shapes.quad(
                [(start, y, 0.0), (end_x, y, 0.0), (end_x, y, roof), (start, y, roof)],
                Surface("wall", NON_STAIR_LABEL, _RGB["wall"], crease=(2, roof) if stair.ceiling else None),
            )
    if stair.ceiling:
        left = half if stair.wall in ("left", "both") else max(half, stair.floor_width_m / 2.0)
        right = half if stair.wall in ("right", "both") else max(half, stair.floor_width_m / 2.0)
        shapes.quad(
            [(start, -right, roof), (end_x, -right, roof), (end_x, left, roof), (start, left, roof)],
            Surface("ceiling", NON_STAIR_LABEL, _RGB["ceiling"]),
        )


def _add_clutter(shapes: _Shapes, stair: Stair, steps: tuple[StepTruth, ...]) -> None:
    """Add a table and two boxes on the floor, a box on a tread, and a handrail on a side that has no wall."""

    def clutter(colour: str) -> Surface:
        return Surface("clutter", NON_STAIR_LABEL, _RGB[colour])

    # The side away from a wall; without walls the right.
    side = 1.0 if stair.wall == "right" else -1.0
    half, floor_half, front = stair.width_m / 2.0, stair.floor_width_m / 2.0, stair.floor_front_m

    def box(x: tuple[float, float], y: tuple[float, float], z: tuple[float, float], colour: str) -> None:
        ys = sorted((side * y[0], side * y[1]))
        shapes.box((x[0], ys[0], z[0]), (x[1], ys[1], z[1]), clutter(colour))

    # A table at the edge of the floor, 0.72 to 0.75 m high, with four legs.
    x0, x1, y0, y1 = -0.75 * front, -0.75 * front + 0.8, floor_half - 0.55, floor_half - 0.05
    box((x0, x1), (y0, y1), (0.72, 0.75), "table")
    for x in (x0 + 0.03, x1 - 0.08):
        for y in (y0 + 0.03, y1 - 0.08):
            box((x, x + 0.05), (y, y + 0.05), (0.0, 0.72), "table")
    box((-0.5, -0.1), (floor_half - 0.4, floor_half - 0.05), (0.0, 0.32), "box")
    box((-0.42, -0.15), (floor_half - 0.36, floor_half - 0.1), (0.32, 0.5), "crate")
    carrier = steps[min(2, len(steps) - 1)]
    x = carrier.nosing[0][0]
    foot = max(_top(carrier)(a, b) for a in (x + 0.06, x + 0.24) for b in (side * (half - 0.3), side * (half - 0.06)))
    box((x + 0.06, x + 0.24), (half - 0.3, half - 0.06), (foot, foot + 0.13), "box")
    if stair.wall != "both":
        y = side * (half - 0.04)
        for step in steps:
            middle = step.nosing[0][0] + min(0.1, step.tread_depth_m / 2.0)
            shapes.rod((middle, y, _top(step)(middle, y)), (middle, y, step.height_m + 0.9), 0.012, clutter("rail"))
        tops = [(step.nosing[0][0] + min(0.1, step.tread_depth_m / 2.0), y, step.height_m + 0.9) for step in steps]
        for start, end in itertools.pairwise(tops):
            shapes.rod(start, end, 0.021, clutter("rail"))
