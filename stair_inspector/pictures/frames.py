"""Where a stair, or one step of it, lies: its middle, the climb, the right of who climbs, and up."""

from dataclasses import dataclass

import numpy as np

from stair_inspector.geometry.arrays import Floats
from stair_inspector.model import Inspection, Step


@dataclass(frozen=True, slots=True, eq=False)
class SectionFrame:
    """Where sections are cut, local: ``origin`` (3,) in the middle of the stair, unit ``right``, ``climb``, ``up``."""

    origin: Floats
    right: Floats
    climb: Floats
    up: Floats


def section_frame(inspection: Inspection, points: Floats, step_id: int | None = None) -> SectionFrame:
    """Return the frame in which sections are cut.

    Parameters
    ----------
    inspection : Inspection
        Its first flight gives the climb; without one the paper's axes do.
    points : (m, 3)
        Displayed points, local; their middle is the origin where there are no steps.
    step_id : int, optional
        A step whose own climb and place are taken instead: stairs turn.
    """
    up = inspection.up.vector
    step = step_of(inspection, step_id)
    corners = [other.corners for other in ((step,) if step is not None else inspection.steps)]
    origin = np.concatenate(corners).mean(axis=0) if corners else points.mean(axis=0)
    climb = _climb_of(inspection, step)
    # Square to up to the last bit, so that a slab is upright.
    climb = climb - (climb @ up) * up
    climb /= np.linalg.norm(climb)
    return SectionFrame(origin, np.cross(climb, up), climb, up)


def _climb_of(inspection: Inspection, step: Step | None) -> Floats:
    if step is not None and step.climb is not None:
        return step.climb
    flight = next((flight for flight in inspection.flights if step is None or flight.flight_id == step.flight), None)
    if flight is not None:
        return flight.climb
    if inspection.axes is not None:
        climb: Floats = -inspection.axes.depth
        return climb
    # Any horizontal direction: there is no stair.
    some = np.eye(3)[np.argmin(np.abs(inspection.up.vector))]
    climb = np.cross(inspection.up.vector, some)
    return climb


def step_of(inspection: Inspection | None, step_id: int | None) -> Step | None:
    """Return the step with a number, or None."""
    steps = inspection.steps if inspection is not None else ()
    return next((step for step in steps if step.step_id == step_id), None)
