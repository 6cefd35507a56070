"""Which points lie near a step, and how far above its plane?"""

from dataclasses import dataclass

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.arrays import Bools, Floats
from stair_inspector.geometry.percentiles import MAD_TO_SIGMA, median
from stair_inspector.geometry.plan import in_frame
from stair_inspector.geometry.trimmed import fit_trimmed
from stair_inspector.model import HeightOrder, LocalPlane
from stair_inspector.stages.planes import FINE_M, block_means, plane_of

FACE_NEAR_SIGMA = 1.6
FACE_FAR_M = 0.032
FACE_BAND_M = 0.012
"""A nosing's face is looked for from below its tread's noise down to 32 mm, or 12 mm farther than the noise."""
BESIDE_M = 0.15
_MOST_NEAR = 60_000
"""Points beyond which a step's plane and edges become no better, only slower."""
_REFIT_GROWTH = 1.5
_REFIT_ROUNDS, _REFIT_SIGMA, _FEWEST_TO_REFIT = 8, 4.0, 50


@dataclass(frozen=True, slots=True, eq=False)
class NearPoints:
    """Points near one step, in its frame: ``s`` along the climb, ``w`` to the left, ``r`` above its plane; metres."""

    s: Floats
    w: Floats
    r: Floats

    def chosen(self, which: Bools) -> "NearPoints":
        """Return some of the points."""
        return NearPoints(self.s[which], self.w[which], self.r[which])


def refit_plane(
    near: NearPoints, plane: LocalPlane, extent: tuple[float, float, float, float]
) -> tuple[LocalPlane, NearPoints]:
    """Fit the plane again to all points well inside the surface, whatever their normals, and measure from it.

    The points that noise has carried farthest off a surface have the most slanting normals: without them the noise
    seems too small, and where they are missing on one side only, the plane leans.
    """
    s_low, s_high, w_low, w_high = extent
    s_high = min(s_high, s_low + priors.FLOOR_STRIP_M)
    inset_s, inset_w = 0.15 * (s_high - s_low), 0.08 * (w_high - w_low)
    inside = (near.s >= s_low + inset_s) & (near.s <= s_high - inset_s)
    inside &= (near.w >= w_low + inset_w) & (near.w <= w_high - inset_w)
    sigma_m = plane.sigma_m
    for _ in range(_REFIT_ROUNDS):
        chosen = inside & (np.abs(near.r) <= _REFIT_SIGMA * sigma_m)
        if np.count_nonzero(chosen) < _FEWEST_TO_REFIT:
            return plane, near
        wider = MAD_TO_SIGMA * median(np.abs(near.r[chosen]))
        if wider <= 1.02 * sigma_m:
            break
        sigma_m = wider
        if sigma_m > _REFIT_GROWTH * plane.sigma_m:
            # That is not the surface's noise but something that stands on it.
            return plane, near
    s, w, r = near.s[chosen], near.w[chosen], near.r[chosen]
    blocks, counts = block_means(s, w, r, FINE_M)
    slope, centre, _ = fit_trimmed(blocks[:, counts >= 0.3 * median(counts)])
    z0 = float(centre[2] - slope @ centre[:2])
    offsets = r + plane.z0_m + plane.slope[0] * s + plane.slope[1] * w
    numbers = (plane.z0_m + z0, plane.slope[0] + float(slope[0]), plane.slope[1] + float(slope[1]))
    better = plane_of(s, w, offsets, numbers)
    r = near.r - z0 - slope[0] * near.s - slope[1] * near.w
    return better, NearPoints(near.s, near.w, r)


def gather_near(
    heights: HeightOrder,
    origin: Floats,
    climb: Floats,
    extent: tuple[float, float, float, float],
    plane: LocalPlane,
    above_m: float,
) -> tuple[NearPoints, int]:
    """Return the points around a step, whatever their normals; of very many only every n-th, and n."""
    s_low, s_high, w_low, w_high = extent
    corners = [plane.at(s, w) for s in (s_low, min(s_high, s_low + 2.0)) for w in (w_low, w_high)]
    margin = max(FACE_FAR_M, (FACE_NEAR_SIGMA * plane.sigma_m + FACE_BAND_M), 4.0 * plane.sigma_m)
    rows = heights.coordinates_m[:, heights.between(min(corners) - margin, max(corners) + above_m)]
    s, w = in_frame(rows, origin, climb)
    chosen = np.flatnonzero(
        (s >= s_low - BESIDE_M) & (s <= s_high + BESIDE_M) & (w >= w_low - BESIDE_M) & (w <= w_high + BESIDE_M)
    )
    # In order of height, so that every second point is as good as a random half.
    stride = -(-len(chosen) // _MOST_NEAR)
    chosen = chosen[::stride]
    s, w = s[chosen], w[chosen]
    return NearPoints(s, w, rows[2][chosen] - plane.z0_m - plane.slope[0] * s - plane.slope[1] * w), stride
