"""Which edges of a flight's steps are hidden? What the other steps show of an edge that one does not."""

import itertools
import math
from dataclasses import replace

import numpy as np

from stair_inspector.geometry.arrays import Floats
from stair_inspector.geometry.edges import EdgeLine
from stair_inspector.model import Chain, StepShape
from stair_inspector.stages.links import turn_deg

UNSEEN_M = 0.03
"""Standard uncertainty of an edge of which only the rim of what was seen is known."""
WINDING_DEG = 8.0
"""A flight winds where its direction turns by more from step to step; the edges of patches are that uncertain."""
_FEWEST_FOR_SIDES = 3
_SIDE_DIFFERS_M = 0.05
_WEDGE_M = 0.05
"""Standard uncertainty of either end of a winder's nosing."""


def with_doubtful_fronts(shapes: list[StepShape]) -> list[StepShape]:
    """Doubt every nosing that is known by the end of its tread alone where those of most steps show their faces.

    The same scanner would have seen this one's too: something hides it, and the tread may go on behind that.
    """
    if 2 * sum(shape.front.source == "face" for shape in shapes) <= len(shapes):
        return shapes
    return [
        shape
        if shape.front.source == "face"
        else replace(
            shape,
            front=replace(shape.front, noise_m=math.hypot(shape.front.noise_m, UNSEEN_M), support=0.0),
        )
        for shape in shapes
    ]


def with_wedge_sides(shapes: list[StepShape], chain: Chain) -> list[StepShape]:
    """Doubt the sides of the steps of a winding flight, where it turns.

    The sides of a wedge are neither square to its nosing nor parallel, and its narrow end is hidden by those above. A
    step that is narrower than most may end in a shadow, at either side.
    """
    widths = [shape.left.middle_m - shape.right.middle_m for shape in shapes]
    usual_m = float(np.median(widths))
    result = []
    turns = [abs(turn_deg(a, b)) > WINDING_DEG for a, b in itertools.pairwise(chain.climbs)]
    for k, (shape, width_m) in enumerate(zip(shapes, widths, strict=True)):
        is_wedge = any(turns[max(k - 1, 0) : k + 1])
        hidden_m = usual_m - width_m
        doubt_m, is_hidden = _WEDGE_M if is_wedge else 0.0, hidden_m > _SIDE_DIFFERS_M
        if is_hidden:
            doubt_m = math.hypot(doubt_m, hidden_m / 2.0)
        changed = [
            replace(edge, noise_m=math.hypot(edge.noise_m, doubt_m), support=0.0 if is_hidden else edge.support)
            for edge in (shape.left, shape.right)
        ]
        result.append(replace(shape, left=changed[0], right=changed[1]))
    return result


def with_common_sides(shapes: list[StepShape], climb: Floats) -> list[StepShape]:
    """Compare every step's sides with those of its flight.

    A side that lies inside the others', and of which no face is seen, may be the rim of a shadow: its uncertainty grows
    until it reaches the others. Its value stays: a step may be narrower.
    """
    if len(shapes) < _FEWEST_FOR_SIDES:
        return shapes
    across = np.array([-climb[1], climb[0]])
    origins = [float(shape.origin_m @ across) for shape in shapes]
    lefts = [origin + shape.left.middle_m for origin, shape in zip(origins, shapes, strict=True)]
    rights = [origin + shape.right.middle_m for origin, shape in zip(origins, shapes, strict=True)]
    left, right = float(np.median(lefts)), float(np.median(rights))
    result = []
    for shape, origin in zip(shapes, origins, strict=True):
        hidden_left, hidden_right = left - origin - shape.left.middle_m, shape.right.middle_m - (right - origin)
        changes: dict[str, EdgeLine] = {}
        for name, hidden in (("left", hidden_left), ("right", hidden_right)):
            edge: EdgeLine = getattr(shape, name)
            if hidden > _SIDE_DIFFERS_M + 4.0 * edge.noise_m and edge.source == "tread":
                changes[name] = replace(edge, noise_m=math.hypot(edge.noise_m, hidden / 2.0), support=0.0)
        low, high = shape.line_range
        if abs(hidden_left) > _SIDE_DIFFERS_M:
            high = left - origin
        if abs(hidden_right) > _SIDE_DIFFERS_M:
            low = right - origin
        result.append(replace(shape, left=changes.get("left", shape.left), right=changes.get("right", shape.right)))
        result[-1] = replace(result[-1], line_range=(low, high))
    return result
