"""Which step something was said of: its number may change with the settings, its place does not."""

import numpy as np

from stair_inspector.geometry.arrays import Floats, Point
from stair_inspector.model import Inspection, Step

_LEAST_RISE_M = 0.1
"""Taken for a rise that was not measured."""


def step_at(inspection: Inspection, step_id: int, place_m: Point | None) -> Step | None:
    """Return the step at a place of the scan's own frame, metres; that of the number where no place is known."""
    if place_m is None:
        return next((step for step in inspection.steps if step.step_id == step_id), None)
    place = np.array(place_m) - inspection.scan.origin_m
    nearest = min(inspection.steps, key=lambda step: float(np.linalg.norm(step.plane.centroid - place)), default=None)
    return nearest if nearest is not None and _is_at(nearest, place, inspection.up.vector) else None


def middle_of(inspection: Inspection, step: Step) -> Point:
    """Return the middle of a step's tread in the scan's own frame, metres."""
    x, y, z = (float(value) for value in step.plane.centroid + np.array(inspection.scan.origin_m))
    return x, y, z


def _is_at(step: Step, place: Floats, up: Floats) -> bool:
    """Return whether a place is on a step: within half a rise of its height and half its diagonal in plan."""
    away = place - step.plane.centroid
    height = float(away @ up)
    rise_m = _LEAST_RISE_M if step.rise_m is None else step.rise_m.value
    diagonal_m = float(np.linalg.norm(step.corners[2] - step.corners[0]))
    return abs(height) < rise_m / 2.0 and float(np.linalg.norm(away - height * up)) < diagonal_m / 2.0
