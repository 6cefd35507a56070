"""How high is a tread at its nosing? A strip stands proud there, feet wear it down."""

import math
from dataclasses import replace

import numpy as np

from stair_inspector.geometry.arrays import Floats
from stair_inspector.geometry.percentiles import MEDIAN_NOISE, median
from stair_inspector.model import LocalPlane, StepShape
from stair_inspector.stages.edge_finder import BAND_SIGMA, FEWEST_IN_STRIP, STRIP_NEAR_M, STRIP_STEP_M
from stair_inspector.stages.near_points import NearPoints

_STRIP_DEEP_M, _STRIP_DEEP_SIGMA = 0.03, 6.0
"""Depth of the strip in which the nosing's height is taken: 30 mm, and six times the noise of the points."""
_STRIP_MISFIT = 0.25
_STRIP_SIGMAS, _LEAST_ODD_M = 3.0, 0.005
_STRIP_POSE_SIGMA, _MOST_WORN_M = 0.2, 0.01
"""What passes of a scanner leave between parts of a strip, as a share of the noise; deeper is not wear but damage."""


def with_nosing_heights(
    shape: StepShape, near: NearPoints, band_m: float, is_stepped: bool, is_barred: bool
) -> StepShape:
    """Measure how high the surface lies at its nosing above its plane, on the left, in the centre and on the right.

    A plane carried on to the edge magnifies what is wrong with its slope: the strip behind the nosing, over its whole
    length, says how high the plane has to be there. Noisy points take a deeper strip, so that errors of pose, which a
    few centimetres have in common, even out. A third of the strip that lies otherwise than the whole by more than
    chance, as where feet have worn it, has its own height. In the strip of a tread of bars their sides show too: there
    the plane is all there is.
    """
    low, high = shape.line_range
    plane = shape.plane
    back = near.s - shape.front.at(0.0) - shape.front.slope * near.w
    # The noisier and the sparser the points, the farther from the edge before they are the tread's for certain.
    start_m = max(STRIP_NEAR_M, 1.5 * plane.spacing_m, 2.0 * plane.sigma_m)
    stop_m = start_m + _STRIP_DEEP_M + _STRIP_DEEP_SIGMA * plane.sigma_m
    is_strip = (back >= start_m) & (back <= stop_m) & (np.abs(near.r) <= band_m + STRIP_STEP_M)
    is_strip &= (near.w >= low) & (near.w <= high)
    w, r = near.w[is_strip], near.r[is_strip]
    by_plane = math.hypot(plane.noise_at(shape.front.middle_m, (low + high) / 2.0), plane.misfit_m)
    whole_m, whole_noise_m = _strip_height(r, plane, is_stepped)
    # A strip far off what is usual is spoilt by the edge, not part of the tread: the plane is all there is.
    if is_barred or abs(whole_m) > _LEAST_ODD_M + _STRIP_SIGMAS * whole_noise_m:
        whole_m, whole_noise_m = 0.0, math.inf
    offsets, noises = [], []
    for start, stop in ((2.0 / 3.0, 1.0), (1.0 / 3.0, 2.0 / 3.0), (0.0, 1.0 / 3.0)):
        mine = r[(w >= low + start * (high - low)) & (w <= low + stop * (high - low))]
        own_m, own_noise_m = _strip_height(mine, plane, is_stepped)
        chance_m = _STRIP_SIGMAS * math.hypot(own_noise_m, _STRIP_POSE_SIGMA * plane.sigma_m)
        is_other = chance_m < abs(own_m - whole_m) <= max(_MOST_WORN_M, _STRIP_SIGMAS * plane.misfit_m)
        is_other = is_other and not is_barred
        offset_m, noise_m = (own_m, own_noise_m) if is_other else (whole_m, whole_noise_m)
        offsets.append(offset_m)
        # Between the strip and the nosing itself the surface may depart from its plane some more.
        noises.append(math.hypot(noise_m, _STRIP_MISFIT * plane.misfit_m) if math.isfinite(noise_m) else by_plane)
    return replace(
        shape,
        nosing_offsets=(offsets[0], offsets[1], offsets[2]),
        nosing_noise=(noises[0], noises[1], noises[2]),
    )


def _strip_height(r: Floats, plane: LocalPlane, is_stepped: bool) -> tuple[float, float]:
    """Return the middle height of a strip's points and its standard uncertainty, infinite for too few points.

    Of rounded heights the mean is right as soon as the noise reaches half a step, their median is still drawn to a step
    by a twentieth of it.
    """
    if len(r) < FEWEST_IN_STRIP:
        return 0.0, math.inf
    if is_stepped:
        r = r[np.abs(r - median(r)) <= BAND_SIGMA * plane.sigma_m]
        # Taken to be no surer than a median: which points it is taken from depends on the spreading too.
        return float(r.mean()), MEDIAN_NOISE * plane.sigma_m / math.sqrt(len(r))
    return median(r), MEDIAN_NOISE * plane.sigma_m / math.sqrt(len(r))
