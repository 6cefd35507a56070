"""What a report states beyond the inspection's own values: sums over a flight, diagonals, heights between planes."""

import math

from stair_inspector.codes.quantities import OWN_PARTS, combined, part_of, total
from stair_inspector.geometry.arrays import Floats
from stair_inspector.model import Flight, Inspection, Measured, Step


def steps_of(inspection: Inspection, flight: Flight) -> list[Step]:
    """Return the steps of a flight, from bottom to top."""
    wanted = set(flight.step_ids)
    return [step for step in inspection.steps if step.step_id in wanted]


def flight_rise(inspection: Inspection, flight: Flight) -> Measured | None:
    """Return the sum of a flight's rises, None where one of them was not measured."""
    rises = [step.rise_m for step in steps_of(inspection, flight)]
    known = [rise for rise in rises if rise is not None]
    return total(known) if known and len(known) == len(rises) and len(rises) == flight.n_risers else None


def flight_run(inspection: Inspection, flight: Flight) -> Measured | None:
    """Return the sum of a flight's goings, from its first nosing to its last."""
    goings = [step.going_m for step in steps_of(inspection, flight)[:-1]]
    known = [going for going in goings if going is not None]
    return total(known) if known and len(known) == len(goings) else None


def diagonal_m(step: Step, above: Step | None) -> Measured | None:
    """Return the distance from a step's nosing to the next one's; a tilt turns it and leaves its length."""
    going, rise = step.going_m, None if above is None or above.flight != step.flight else above.rise_m
    if going is None or rise is None:
        return None
    length = math.hypot(going.value, rise.value)
    along, up = going.value / length, rise.value / length
    parts = {name: math.hypot(along * part_of(going, name), up * part_of(rise, name)) for name in OWN_PARTS}
    parts["up"] = abs(along * part_of(going, "up") - up * part_of(rise, "up"))
    parts["scale"] = along * part_of(going, "scale") + up * part_of(rise, "scale")
    return combined(length, parts)


def plane_to_plane(inspection: Inspection, flight: Flight) -> float | None:
    """Return the height from the plane at a flight's foot to that of its topmost step, metres, at its end nosings."""
    steps = steps_of(inspection, flight)
    first, last = steps[0], steps[-1]
    if first.line_points is None or last.line_points is None or first.rise_m is None or last.plane.normal is None:
        return None
    up = inspection.up.vector
    low, high = first.line_points[1], last.line_points[1]
    foot = float(low @ up) - first.rise_m.value
    grounds = [
        (low_height, patch)
        for patch in inspection.patches
        if patch.kind in ("floor", "landing") and patch.plane.normal is not None
        for low_height in [_height_at(low, patch.plane.centroid, patch.plane.normal, up)]
    ]
    if not grounds:
        return None
    # The surface from which the first rise was measured is that whose plane passes nearest to its foot.
    base, _ = min(grounds, key=lambda ground: abs(ground[0] - foot))
    if abs(base - foot) > first.rise_m.value / 2.0:
        return None
    return _height_at(high, last.plane.centroid, last.plane.normal, up) - base


def _height_at(place: Floats, centroid: Floats, normal: Floats, up: Floats) -> float:
    """Return the height of a plane above or below a place, along up."""
    return float(place @ up + ((centroid - place) @ normal) / (normal @ up))
