"""The top of one step as a mesh: nosing strip, rounded edge, worn hollow, sides of the slab."""

import math
from collections.abc import Sequence

import numpy as np

from stair_inspector.geometry.arrays import Floats, Ints, Point
from stair_inspector.simulation.footprints import Flat, Footprint, along, square_to, without_repeats
from stair_inspector.simulation.layout import StepTruth
from stair_inspector.simulation.shapes import COLOURS, BuiltSurface, Shapes
from stair_inspector.simulation.specs import Stair

Ring = tuple[Flat, ...]
_STRIP_M = 0.05  # Depth of the contrasting strip at a nosing.
_ROUND_FACETS = 6
_DISH_CELLS = (12, 16)  # Along the depth and across; a 5 mm dish is then within 0.05 mm of the curve.
SAME_M = 1e-9


def add_top(
    shapes: Shapes, stair: Stair, step: StepTruth, base: float, side: BuiltSurface, upright: BuiltSurface
) -> None:
    """Add the top with its nosing strip, the upright at the nosing, and the slab's sides."""
    plan, k, proud = step.plan, step.step_id, stair.strip_proud_m
    crease = _crease(plan) if step.step_id % stair.n_risers and not stair.open_risers else None
    surface = BuiltSurface(step.kind, k, COLOURS[step.kind], k, crease)
    radius = stair.round_nosing_m
    edge, ring = plan.front, plan.outline
    if radius:
        _, ring, edge = _cut(ring, plan.front, radius)
        _add_round_edge(shapes, step, edge, (base, radius), side, upright)
    rest, rest_edge = ring, edge
    if proud or not step.dish_m:
        strip, rest, rest_edge = _cut(ring, plan.front, _STRIP_M)
        heights = [step.nosing_top(*corner) for corner in strip]
        shapes.level(strip, heights, BuiltSurface(step.kind, k, COLOURS["strip"], k, crease))
        if proud:
            for start, stop in around(strip):
                if not _is_on(edge, start, stop):
                    high = (step.top(*start), step.top(*stop))
                    shapes.quad(upright_face(start, stop, (high[0] - proud, high[1] - proud), high), upright)
    if step.dish_m:
        shapes.add(*_dished(step, rest_edge, proud), surface)
    else:
        shapes.level(rest, [step.top(*corner) - proud for corner in rest], surface)
        if step.worn_m:
            (start, stop), worn = rest_edge, step.worn_m
            high = (step.top(*stop), step.top(*start))
            shapes.quad(upright_face(stop, start, (high[0] - worn, high[1] - worn), high), upright)
    left, right = plan.front
    high = (step.nosing_top(*right) - radius, step.nosing_top(*left) - radius)
    shapes.quad(upright_face(right, left, (base, base), high), upright)
    for start, stop in around(ring):
        if not (_is_on(edge, start, stop) or _is_on(plan.back, start, stop)):
            high = (step.top(*start) - proud, step.top(*stop) - proud)
            shapes.quad(upright_face(start, stop, (base, base), high), side)


def _add_round_edge(
    shapes: Shapes,
    step: StepTruth,
    edge: tuple[Flat, Flat],
    base_and_radius: tuple[float, float],
    side: BuiltSurface,
    upright: BuiltSurface,
) -> None:
    """Add a quarter of a cylinder between the upright at a nosing and the edge of the flat top behind it."""
    base, radius = base_and_radius
    arcs: list[list[Point]] = []
    for end, behind in zip(step.plan.front, edge, strict=True):
        arc: list[Point] = []
        for facet in range(_ROUND_FACETS + 1):
            angle = math.pi / 2.0 * facet / _ROUND_FACETS
            x, y = along((end, behind), 1.0 - math.cos(angle))
            arc.append((x, y, step.top(x, y) - radius * (1.0 - math.sin(angle))))
        arcs.append(arc)
        shapes.fan([(*behind, base), (*behind, arc[-1][2]), *reversed(arc[:-1]), (*end, base)], side)
    left, right = arcs
    for facet in range(_ROUND_FACETS):
        shapes.quad([right[facet], left[facet], left[facet + 1], right[facet + 1]], upright)


def upright_face(start: Flat, stop: Flat, low: tuple[float, float], high: tuple[float, float]) -> list[Point]:
    """Return the corners of an upright face over a line of the plan, between two heights at each end."""
    return [(*start, low[0]), (*stop, low[1]), (*stop, high[1]), (*start, high[0])]


def around(ring: Sequence[Flat]) -> list[tuple[Flat, Flat]]:
    """Return the edges of a ring of corners."""
    return list(zip(ring, (*ring[1:], *ring[:1]), strict=True))


def _cut(ring: Ring, front: tuple[Flat, Flat], depth_m: float) -> tuple[Ring, Ring, tuple[Flat, Flat]]:
    """Cut a top along the line at a depth behind its nosing.

    Returns
    -------
    two rings
        What lies before the line, and behind it.
    two points
        Left and right end of the cut.

    References
    ----------
    .. [1] Sutherland, Hodgman: Reentrant polygon clipping, 1974.
    """
    normal = square_to(front)
    before: list[Flat] = []
    behind: list[Flat] = []
    cuts: list[Flat] = []
    for start, stop in around(ring):
        a, b = ((x - front[0][0]) * normal[0] + (y - front[0][1]) * normal[1] - depth_m for x, y in (start, stop))
        (behind if a > 0.0 else before).append(start)
        if (a > 0.0) != (b > 0.0):
            cut = along((start, stop), a / (a - b))
            cuts.append(cut)
            before.append(cut)
            behind.append(cut)
    # Round the ring from the nosing's left end the right side comes first.
    return without_repeats(before), without_repeats(behind), (cuts[1], cuts[0])


def _is_on(edge: tuple[Flat, Flat], start: Flat, stop: Flat) -> bool:
    """Say whether a piece of an outline lies on the line through an edge."""
    normal = square_to(edge)
    return all(abs((x - edge[0][0]) * normal[0] + (y - edge[0][1]) * normal[1]) < SAME_M for x, y in (start, stop))


def _crease(plan: Footprint) -> tuple[int, float] | None:
    """Return the axis and the coordinate of the riser above, where it runs along an axis, or nearly."""
    left, right = plan.back
    for axis in (0, 1):
        if abs(left[axis] - right[axis]) < 0.1 * math.dist(left, right):
            return axis, (left[axis] + right[axis]) / 2.0
    return None


def _dished(step: StepTruth, front: tuple[Flat, Flat], proud_m: float) -> tuple[Floats, Ints]:
    """Return the top of a worn step as a grid: deepest in the middle, unworn along its four edges."""
    rows, columns = _DISH_CELLS
    back = step.plan.back
    corner = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)[None, :]).ravel()
    right, ahead = corner + 1, corner + columns + 1
    faces = np.concatenate([np.stack([corner, ahead, ahead + 1], 1), np.stack([corner, ahead + 1, right], 1)])
    vertices: list[Point] = []
    for s in np.linspace(0.0, 1.0, rows + 1).tolist():
        line = (along((front[1], back[1]), s), along((front[0], back[0]), s))
        for t in np.linspace(-1.0, 1.0, columns + 1).tolist():
            x, y = along(line, (t + 1.0) / 2.0)
            worn = step.dish_m * 4.0 * s * (1.0 - s) * (1.0 - t * t)
            vertices.append((x, y, step.top(x, y) - proud_m - worn))
    return np.array(vertices), faces
