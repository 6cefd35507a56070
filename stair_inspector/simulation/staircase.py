"""Builds a staircase of known geometry: takes a Stair, gives a mesh whose every surface is named, and the truth.

The output frame has the site's yaw and offset on top of the stair frame, which ``layout`` describes.
"""

import itertools
import math
from dataclasses import dataclass

import numpy as np

from stair_inspector.geometry.arrays import Floats, Point
from stair_inspector.model import FLOOR_LABEL, NON_STAIR_LABEL
from stair_inspector.simulation.footprints import POST_RADIUS_M, Flat, along, shifted
from stair_inspector.simulation.layout import StepTruth, lay_out, way_up
from stair_inspector.simulation.shapes import COLOURS, Building, BuiltSurface, Shapes
from stair_inspector.simulation.spec_texts import parse_offset
from stair_inspector.simulation.specs import SLAB_M, Stair
from stair_inspector.simulation.tops import SAME_M, add_top, upright_face

__all__ = ["Building", "BuiltSurface", "Point", "StepTruth", "build", "lay_out", "output_from_stair"]
_BEAM_M = (0.06, 0.2)  # Width and height of the two beams that carry treads without risers.
_RAIL_M = 0.9
_STRAIGHT_ON = 0.3  # Least cosine between the directions of two steps that one handrail joins.


@dataclass(frozen=True, slots=True)
class _Ground:
    """The floor's rectangle."""

    x: tuple[float, float]
    y: tuple[float, float]

    def corners(self, height: float) -> list[Point]:
        (x0, x1), (y0, y1) = self.x, self.y
        return [(x0, y0, height), (x1, y0, height), (x1, y1, height), (x0, y1, height)]


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
    shapes = Shapes()
    ground = _add_floor(shapes, stair, steps)
    for index, step in enumerate(steps):
        if not step.is_missing:
            _add_step(shapes, stair, step, steps[index - 1] if index % stair.n_risers else None)
    if stair.open_risers:
        _add_beams(shapes, stair, steps)
    _add_post(shapes, stair, steps)
    _add_walls(shapes, stair, steps, ground)
    if stair.clutter:
        _add_clutter(shapes, stair, tuple(step for step in steps[: stair.n_risers] if not step.is_missing))
    return shapes.building(stair, steps, way_up(stair, steps))


def output_from_stair(stair: Stair | None, points: Floats) -> Floats:
    """Return points of the stair frame in the output frame.

    Parameters
    ----------
    stair : Stair or None
        Its yaw and offset are applied; a scene without a stair has neither.
    points : (n, 3), metres
        Stair frame.
    """
    if stair is None:
        return points
    cos, sin = math.cos(math.radians(stair.yaw_deg)), math.sin(math.radians(stair.yaw_deg))
    x, y, z = points.T
    dx, dy, dz = parse_offset(stair.offset_m)
    return np.stack([cos * x - sin * y + dx, sin * x + cos * y + dy, z + dz], axis=1)


def _add_floor(shapes: Shapes, stair: Stair, steps: tuple[StepTruth, ...]) -> _Ground:
    # Between twins, too, one sees the floor.
    is_all_round = stair.floor_all_round or stair.is_turning or stair.twin_gap_m > 0.0
    corners = np.array([corner for step in steps for corner in step.plan.outline])
    (low_x, low_y), (high_x, high_y) = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()
    half = stair.floor_width_m / 2.0
    beside = max(0.0, half - stair.width_m / 2.0)
    # A solid stair stands on the floor; one sees the floor through a stair without risers.
    back = high_x if stair.open_risers else max(0.0, *(x for x, _ in steps[0].plan.riser))
    ground = _Ground((-stair.floor_front_m, back), (-half, half + (high_y - stair.width_m / 2.0)))
    if is_all_round:
        ground = _Ground(
            (min(-stair.floor_front_m, low_x - beside), high_x + beside),
            (min(-half, low_y - beside), max(half, high_y + beside)),
        )
    crease = None if stair.open_risers or is_all_round else (0, 0.0)
    shapes.quad(ground.corners(0.0), BuiltSurface("floor", 0, COLOURS["floor"], FLOOR_LABEL, crease))
    return ground


def _add_step(shapes: Shapes, stair: Stair, step: StepTruth, below: StepTruth | None) -> None:
    """Add the top, the slab's visible faces and, where there are any, the riser and the body under it."""
    plan, k = step.plan, step.step_id
    # Under a tread that falls backwards or sideways the slab must still have a thickness.
    base = min(step.top(*corner) for corner in plan.outline) - SLAB_M
    is_slab = stair.open_risers or step.shape == "spiral"
    side, upright = BuiltSurface("side", k, COLOURS["side"]), BuiltSurface("nosing", k, COLOURS["strip"])
    add_top(shapes, stair, step, base, side, upright)
    if is_slab:
        # A slab in the air overlaps the nosing above it by the overhang, as planks do, and shows its underside.
        shapes.level(plan.outline, [base] * len(plan.outline), side)
        (left, right), proud = plan.back, stair.strip_proud_m
        shapes.quad(upright_face(right, left, (base, base), (step.top(*right) - proud, step.top(*left) - proud)), side)
    else:
        under = (plan.front[1], plan.riser[1], plan.riser[0], plan.front[0])
        shapes.level(under, [base] * 4, upright)
    if not stair.open_risers:
        left, right = plan.riser
        proud = stair.strip_proud_m
        low = (below.top(*right) - proud, below.top(*left) - proud) if below else (0.0, 0.0)
        shapes.quad(
            upright_face(right, left, low, (base, base)),
            BuiltSurface("riser", k, COLOURS["riser"], crease=(2, (low[0] + low[1]) / 2.0)),
        )
    if not is_slab:
        _add_body(shapes, stair, step, base, side)


def _add_body(shapes: Shapes, stair: Stair, step: StepTruth, base: float, side: BuiltSurface) -> None:
    """Add the sides of a solid step down to the floor and, at the top of the stair, its back."""
    plan, proud = step.plan, stair.strip_proud_m
    for edge in ((plan.riser[1], *plan.right), (plan.riser[0], *plan.left)):
        for start, stop in itertools.pairwise(edge):
            if math.dist(start, stop) > SAME_M:
                shapes.quad(upright_face(start, stop, (0.0, 0.0), (base, base)), side)
    if step.step_id % stair.n_risers == 0:
        left, right = plan.back
        shapes.quad(upright_face(right, left, (0.0, 0.0), (step.top(*right) - proud, step.top(*left) - proud)), side)


def _add_beams(shapes: Shapes, stair: Stair, steps: tuple[StepTruth, ...]) -> None:
    """Carry the treads of each straight run, and the landings, by two beams underneath."""
    surface = BuiltSurface("beam", NON_STAIR_LABEL, COLOURS["beam"])
    under = SLAB_M + 0.01
    straight = (step for step in steps if step.shape == "straight")
    for _, run in itertools.groupby(straight, key=lambda step: (step.flight, step.climb)):
        chain = list(run)
        first, head = chain[0], chain[-1]
        before = steps[first.step_id - 2] if (first.step_id - 1) % stair.n_risers else None
        foot = along(first.plan.riser, 0.5) if before else first.plan.middle
        foot_z = max(before.height_m - under, 0.0) if before else 0.0
        top, high = shifted(head.plan.middle, head.climb, 0.02), head.height_m - under
        back = shifted(head.plan.middle, head.climb, head.tread_depth_m)
        _add_beam_pair(shapes, stair, (*foot, foot_z), (*top, high - 0.02), surface)
        _add_beam_pair(shapes, stair, (*top, high), (*back, high), surface)


def _add_beam_pair(shapes: Shapes, stair: Stair, start: Point, stop: Point, surface: BuiltSurface) -> None:
    """Add two beams whose tops run from start to stop, left and right of the line between them."""
    width, height = _BEAM_M
    (x0, y0, z0), (x1, y1, z1) = start, stop
    if math.hypot(x1 - x0, y1 - y0) < 0.05:
        return
    climb = ((x1 - x0) / math.hypot(x1 - x0, y1 - y0), (y1 - y0) / math.hypot(x1 - x0, y1 - y0))
    low0, low1 = max(z0 - height, 0.0), max(z1 - height, 0.0)

    def aside(distance: float) -> tuple[Flat, Flat]:
        to_left = (-climb[1], climb[0])
        return shifted((x0, y0), to_left, distance), shifted((x1, y1), to_left, distance)

    for middle in (-0.3 * stair.width_m, 0.3 * stair.width_m):
        left, right = aside(middle + width / 2.0), aside(middle - width / 2.0)
        for foot, head in (left, right):
            shapes.quad(upright_face(foot, head, (low0, low1), (z0, z1)), surface)
        for a, b in ((z0, z1), (low0, low1)):
            shapes.quad([(*left[0], a), (*left[1], b), (*right[1], b), (*right[0], a)], surface)


def _add_post(shapes: Shapes, stair: Stair, steps: tuple[StepTruth, ...]) -> None:
    """Add what wedge treads turn about: the column of a spiral, or the post of a winder."""
    wedges = [step for step in steps if step.shape in ("winder", "spiral")]
    if not wedges:
        return
    radius = stair.spiral_radius_m if stair.shape == "spiral" else POST_RADIUS_M
    left, right = wedges[0].plan.riser
    outwards = ((right[0] - left[0]) / math.dist(left, right), (right[1] - left[1]) / math.dist(left, right))
    centre = shifted(right, outwards, radius) if stair.turn == "right" else shifted(left, outwards, -radius)
    surface = BuiltSurface("post", NON_STAIR_LABEL, COLOURS["post"])
    shapes.rod((*centre, 0.0), (*centre, wedges[-1].height_m + _RAIL_M), radius, surface, sections=32)


def _add_walls(shapes: Shapes, stair: Stair, steps: tuple[StepTruth, ...], ground: _Ground) -> None:
    half = stair.width_m / 2.0
    roof = max(step.height_m for step in steps) + stair.headroom_m
    start, end = -stair.floor_front_m, steps[stair.n_risers - 1].plan.back[0][0]
    far_left = max(y for step in steps for _, y in step.plan.outline)
    # A hair outside the treads, so that no two faces share a plane.
    for side, y in (("left", far_left + 0.001), ("right", -half - 0.001)):
        if stair.wall in (side, "both"):
            shapes.quad(
                upright_face((start, y), (end, y), (0.0, 0.0), (roof, roof)),
                BuiltSurface("wall", NON_STAIR_LABEL, COLOURS["wall"], crease=(2, roof) if stair.ceiling else None),
            )
    if stair.ceiling:
        left = far_left if stair.wall in ("left", "both") else max(far_left, ground.y[1])
        right = -half if stair.wall in ("right", "both") else min(-half, ground.y[0])
        over = _Ground((min(start, ground.x[0]), max(end, ground.x[1])), (right, left))
        shapes.quad(over.corners(roof), BuiltSurface("ceiling", NON_STAIR_LABEL, COLOURS["ceiling"]))


def _add_clutter(shapes: Shapes, stair: Stair, steps: tuple[StepTruth, ...]) -> None:
    """Add a table and two boxes on the floor, a box on a tread, and a handrail on a side that has no wall."""

    def clutter(colour: str) -> BuiltSurface:
        return BuiltSurface("clutter", NON_STAIR_LABEL, COLOURS[colour])

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
    if carrier.climb == (1.0, 0.0):
        # Upright boxes fit no tread that is turned.
        x = carrier.plan.middle[0]
        corners = [(a, b) for a in (x + 0.06, x + 0.24) for b in (side * (half - 0.3), side * (half - 0.06))]
        foot = max(carrier.top(*corner) for corner in corners)
        box((x + 0.06, x + 0.24), (half - 0.3, half - 0.06), (foot, foot + 0.13), "box")
    if stair.wall != "both":
        _add_handrail(shapes, steps, side, clutter("rail"))


def _add_handrail(shapes: Shapes, steps: tuple[StepTruth, ...], side: float, surface: BuiltSurface) -> None:
    """Add a rail with a post on every step; it stops at a landing that turns."""
    tops: list[Point] = []
    for step in steps:
        to_left = (-step.climb[1], step.climb[0])
        middle = shifted(step.plan.middle, step.climb, min(0.1, step.tread_depth_m / 2.0))
        foot = shifted(middle, to_left, side * (step.width_m / 2.0 - 0.04))
        tops.append((*foot, step.height_m + _RAIL_M))
        shapes.rod((*foot, step.top(*foot)), tops[-1], 0.012, surface)
    for (start, end), (a, b) in zip(itertools.pairwise(tops), itertools.pairwise(steps), strict=True):
        if a.climb[0] * b.climb[0] + a.climb[1] * b.climb[1] > _STRAIGHT_ON:
            shapes.rod(start, end, 0.021, surface)
