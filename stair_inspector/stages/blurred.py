"""Did a camera see a step well enough? From far and along a tread, its points lie anywhere about its nosing."""

import math
from collections.abc import Sequence

import numpy as np

from stair_inspector import priors
from stair_inspector.model import COVERAGE_FACTOR, StepShape
from stair_inspector.stages.doubt import LEAST_GRAZING
from stair_inspector.stages.parts import ray_to

_MOST_BLUR = 0.2
"""Of a usual going: where points are uncertain by more along the climb, a nosing's are mistaken for its riser's, and
the tread's for those of the riser above."""
_EVEN = 1.0 / math.sqrt(12.0)


def find_blurred(shapes: Sequence[Sequence[StepShape]]) -> dict[int, str]:
    """Return what is too blurred in a camera's frame to be measured from its nosing: by step number, and why.

    Parameters
    ----------
    shapes : sequence of sequence of StepShape
        Of all flights, the camera at the origin; steps are counted from 1 in this order.

    Notes
    -----
    Along the climb a point of a tread lies as uncertainly as its height over the sine of the angle at which it is seen,
    and a tread ends anywhere between two rows of points, which lie as far apart as their spacing over the root of it.
    """
    found = {}
    for number, shape in enumerate((shape for flight in shapes for shape in flight), 1):
        ray, range_m = ray_to(shape)
        grazing = max(abs(float(ray[2])), LEAST_GRAZING)
        along = abs(float(ray[:2] @ shape.climb))
        # A nosing's own face tells where it is, whatever the tread's noise.
        sigma_m = 0.0 if shape.front.source == "face" else shape.plane.sigma_m / grazing
        rows_m = shape.plane.spacing_m / math.sqrt(grazing)
        blur_m = COVERAGE_FACTOR * along * math.hypot(sigma_m, _EVEN * rows_m)
        if blur_m > _MOST_BLUR * priors.USUAL_GOING_M:
            angle_deg = math.degrees(math.asin(float(np.clip(grazing, 0.0, 1.0))))
            found[number] = (
                f"step {number} was seen from {range_m:.1f} m away, under {angle_deg:.0f}° to its tread: along the "
                f"climb its points are uncertain by {1000.0 * blur_m:.0f} mm, and nothing is measured from its nosing; "
                "scan it from nearer or from higher up"
            )
    return found
