"""How much noise lies across the faces that place a step's edges? It acts along the ray, and shows least in a tread.

A tripod's noise lies along its rays: of a tread that is seen at a grazing angle little of it shows in the height, and
all of it in the face below the nosing, which another station may have seen than the tread, from farther away.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stair_inspector.geometry.arrays import Floats, Ints
from stair_inspector.geometry.edges import EdgeLine
from stair_inspector.geometry.percentiles import mad_sigma
from stair_inspector.geometry.plan import in_frame
from stair_inspector.geometry.sight import Sight
from stair_inspector.model import StepShape
from stair_inspector.stages.near_points import FACE_BAND_M, FACE_FAR_M, FACE_NEAR_SIGMA

_NEAR_M, _ACROSS_M = 0.004, 0.03
"""How far from the tread's plane the points of a face begin, and how far before and behind an edge they may lie."""
_FEWEST, _OF_WIDTH = 40, 0.05


def with_face_noise(shapes: Sequence[StepShape], sight: Sight) -> tuple[StepShape, ...]:
    """Give the edges that a face places the noise that the face itself shows, where stations are known.

    Parameters
    ----------
    shapes : sequence of StepShape
        Of one flight.
    sight : Sight
        What the stations saw, level frame.
    """
    points, of_point = sight.points()
    return tuple(_of(shape, points, of_point) for shape in shapes)


def _of(shape: StepShape, points: Floats, of_point: Ints) -> StepShape:
    s, w = in_frame(points[:, :2].T, shape.origin_m, shape.climb)
    low, high = shape.extent[2:]
    inset = _OF_WIDTH * (high - low)
    near = (w >= low + inset) & (w <= high - inset) & (s >= shape.extent[0] - 0.1) & (s <= shape.extent[1] + 0.1)
    s, w, z = s[near], w[near], points[near, 2]
    above = z - shape.plane.z0_m - shape.plane.slope[0] * s - shape.plane.slope[1] * w
    near_m = max(_NEAR_M, FACE_NEAR_SIGMA * shape.plane.sigma_m)
    far_m = max(FACE_FAR_M, near_m + FACE_BAND_M)

    def told(edge: EdgeLine, off: Floats) -> EdgeLine:
        """Return an edge with what the points of its face show, which lie so far ``off`` (n,) the tread's plane."""
        across = edge.beyond(s, w)
        is_face = (off >= near_m) & (off <= far_m) & (np.abs(across) <= _ACROSS_M)
        if edge.source != "face" or np.count_nonzero(is_face) < _FEWEST:
            return edge
        by = int(np.argmax(np.bincount(of_point[near][is_face])))
        return replace(edge, sigma_m=mad_sigma(across[is_face]), seen_by=by)

    back = None if shape.back is None else told(shape.back, above)
    return replace(shape, front=told(shape.front, -above), back=back)
