"""What an inspection says of every point of its scan: step, kind of surface, distance from the step's plane."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stair_inspector.geometry.arrays import Floats, Ints, Labels
from stair_inspector.geometry.fits import PlaneFit
from stair_inspector.model import FLOOR_LABEL, NON_STAIR_LABEL, Inspection, Scan

KINDS = ("other", "floor", "tread", "landing", "rejected")
"""Kinds of points, by the number that stands for each: ``other`` lies on no level surface."""


@dataclass(frozen=True, slots=True, eq=False)
class SegmentedPoints:
    """The points of a scan and what each was taken for.

    ``places_m`` (n, 3) in the scan frame, where they lay when they were measured; ``steps`` (n,) the step's number,
    0 the floor, -1 neither; ``kinds`` (n,) uint8, the place in :data:`KINDS`; ``residuals_m`` (n,) the signed distance
    from the plane of the step or floor, positive above, NaN where there is none.
    """

    places_m: Floats
    steps: Labels
    kinds: NDArray[np.uint8]
    residuals_m: Floats


def segmented_points(scan: Scan, inspection: Inspection) -> SegmentedPoints:
    """Return what an inspection says of each point of the scan that was inspected."""
    rows = np.arange(len(scan.points))
    steps = labels_at(inspection, rows)
    kinds = np.full(len(rows), KINDS.index("other"), dtype=np.uint8)
    # A level of the paper's method that became no step has no patch: its label says that it was rejected.
    kinds[inspection.labels > len(inspection.steps)] = KINDS.index("rejected")
    if inspection.patch_ids is not None:
        kinds[(inspection.patch_ids >= 0) & (steps == NON_STAIR_LABEL)] = KINDS.index("rejected")
    kinds[steps == FLOOR_LABEL] = KINDS.index("floor")
    for step in inspection.steps:
        kinds[steps == step.step_id] = KINDS.index(step.kind)
    return SegmentedPoints(
        places_m=inspection.places(scan.points, rows) + scan.origin_m,
        steps=steps,
        kinds=kinds,
        residuals_m=residuals_at(inspection, scan.points, rows),
    )


def labels_at(inspection: Inspection, rows: Ints) -> Labels:
    """Return the label of each of these points: step, floor, or left over, to which a rejected level belongs too."""
    labels = inspection.labels[rows]
    return np.where(labels > len(inspection.steps), NON_STAIR_LABEL, labels).astype(np.int16)


def residuals_at(inspection: Inspection, points: Floats, rows: Ints) -> Floats:
    """Return the signed distance (m,) of points (m, 3), which stand in these rows, from their plane, metres.

    The plane is that of the point's step or of the floor; positive above it; NaN for a point of no step, and for a
    surface without a plane.
    """
    labels = labels_at(inspection, rows)
    residuals = np.full(len(labels), np.nan)
    planes = [(step.step_id, step.plane) for step in inspection.steps]
    if inspection.floor is not None:
        planes.append((FLOOR_LABEL, inspection.floor))
    for label, plane in planes:
        of_it = np.nonzero(labels == label)[0]
        if plane.normal is not None:
            residuals[of_it] = signed_distance(inspection.places(points[of_it], rows[of_it]), plane)
    return residuals


def signed_distance(points: Floats, plane: PlaneFit) -> Floats:
    """Return the distance (n,) of points from a plane that has a normal, metres, positive on the side it points to."""
    if plane.normal is None:
        raise ValueError("the plane has no normal")
    distance: Floats = (points - plane.centroid) @ plane.normal
    return distance
