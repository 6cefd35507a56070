"""How far the surface of a step departs from its own plane, as a map seen from above."""

import math
from dataclasses import dataclass

import numpy as np

from stair_inspector.content.segmented_points import signed_distance
from stair_inspector.geometry.arrays import Floats
from stair_inspector.model import Inspection, Scan, Step
from stair_inspector.pictures.frames import section_frame

_SMALLEST_CELL_M, _LARGEST_CELL_M = 0.004, 0.05
_POINTS_PER_CELL = 6.0
_MOST_CELLS = 240
"""Cells across a map: a landing of ten metres is still a small picture."""


@dataclass(frozen=True, slots=True, eq=False)
class ResidualMap:
    """Mean signed distance from a step's plane in each plan cell.

    ``residuals_m`` (rows, columns): positive above, NaN where there are no points; the first row is the back of the
    step and the first column its left, as seen by who climbs. ``back_m`` and ``left_m`` are the distances of that
    corner from the middle of the frame, back along the climb and to the left.
    """

    residuals_m: Floats
    cell_m: float
    back_m: float
    left_m: float


def residual_map(scan: Scan, inspection: Inspection, step: Step) -> ResidualMap | None:
    """Return the map of a step's residuals, or None where the step has no plane."""
    rows = np.nonzero(inspection.labels == step.step_id)[0]
    points = inspection.places(scan.points[rows], rows)
    if step.plane.normal is None or not len(points):
        return None
    frame = section_frame(inspection, points, step.step_id)
    offset = points - frame.origin
    back, left = offset @ frame.climb, -(offset @ frame.right)
    spans = max(float(np.ptp(back)), 1e-6), max(float(np.ptp(left)), 1e-6)
    cell = math.sqrt(spans[0] * spans[1] * _POINTS_PER_CELL / len(points))
    cell = max(float(np.clip(cell, _SMALLEST_CELL_M, _LARGEST_CELL_M)), max(spans) / _MOST_CELLS)
    row = ((back.max() - back) / cell).astype(np.int64)
    column = ((left.max() - left) / cell).astype(np.int64)
    shape = (int(row.max()) + 1, int(column.max()) + 1)
    place = row * shape[1] + column
    counts = np.bincount(place, minlength=shape[0] * shape[1])
    sums = np.bincount(place, weights=signed_distance(points, step.plane), minlength=len(counts))
    means = np.full(len(counts), np.nan)
    np.divide(sums, counts, out=means, where=counts > 0)
    return ResidualMap(means.reshape(shape), cell, float(back.max()), float(left.max()))
