"""What a report states beyond the inspection's own values: values of flights, heights between planes."""

from stair_inspector.geometry.arrays import Floats
from stair_inspector.model import Flight, Inspection, Measured, Step
from stair_inspector.quantities import quantity_of


def steps_of(inspection: Inspection, flight: Flight) -> list[Step]:
    """Return the steps of a flight, from bottom to top."""
    wanted = set(flight.step_ids)
    return [step for step in inspection.steps if step.step_id in wanted]


def flight_value(inspection: Inspection, flight: Flight, name: str) -> Measured | None:
    """Return a quantity of a flight by its name, None where it is not known or no quantity of flights."""
    of_flight = quantity_of(name).of_flight
    return None if of_flight is None else of_flight(flight, steps_of(inspection, flight))


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
