"""How sure is a value? Named parts of standard uncertainties, put together as the GUM says.

Every function takes and returns standard uncertainties (k = 1); :func:`expanded` makes the ``u`` (k = 2) that is shown.
"""

import itertools
import math
from collections.abc import Sequence
from typing import Literal

import numpy as np

from stair_inspector.geometry.arrays import Floats
from stair_inspector.geometry.edges import EdgeLine
from stair_inspector.model import COVERAGE_FACTOR, LocalPlane, Measured

_FACE_EDGE_M = 0.000017
_FACE_EDGE_SPACING = 0.0085
_FACE_EDGE_SIGMA = 0.0425
"""Doubt about where an edge is, given its face: of a face's flatness, of the spacing and of the noise of the points."""
_ACROSS_FACE = 1.5
"""Of the noise that a face shows by itself, where stations are known: from simulated tripods 6 m away."""
_EXTENT_EDGE_M = 0.0001
_EXTENT_EDGE_SPACING = 0.25
_EXTENT_EDGE_SIGMA = 0.10
"""The same for an edge known from the extent of a tread only: the last row of points may or may not be there."""
_COUNTED_EDGE_SPACING, _COUNTED_EDGE_SIGMA = 0.05, 0.2
"""The same where the points of that row were counted."""
_WALL_JOINT_M = 0.0005
"""A joint between a surface and the wall beside it is not seen."""
_SLOPE_SIGMA, _SLOPE_SHARE, _SLOPE_MOST_M = 0.65, 0.1, 0.0012
"""Doubt about the fall of a tread over its depth, as a share of the noise of single points, the smaller one beyond some
millimetres: where two stations, or two passes, see the front and the back of a tread, their difference is a slope."""
NEAR_REGISTRATION = 0.5
"""Share of what registration adds from one step to the next that is left between two edges at one place."""
_SURFACE_SIGMA = 0.02
"""Doubt about a surface's height beyond its scatter, as a share of the noise of single points."""
LEAST_GRAZING = 0.05
"""Sine of the least angle at which anything is seen of a surface."""
_OF_FACET = {"level": 0.025, "edge": 0.06, "side": 1.8}
"""Shares of the length of a scanned mesh's edges, from depth images that were fused on grids of 8, 15 and 25 mm."""
_PATCH_M = 0.08
"""Side of the patches over which a camera's noise is
one: five pixels at three metres."""
_LEAST_LEFT = 0.1
_HARMONICS = 40
"""Of the saw-tooth that rounding adds: those beyond have a thousandth of its variance."""


def expanded(value: float, **parts: float) -> Measured:
    """Return a value with its expanded uncertainty and the parts that have any weight.

    References
    ----------
    .. [1] JCGM 100:2008 (GUM), 5.1.2 for the sum of squares and 6.2 for the factor k.
    """
    # Numbers of numpy would be written by their type's name.
    named = tuple((name, COVERAGE_FACTOR * float(part)) for name, part in parts.items() if part > 0.0)
    return Measured(float(value), math.sqrt(sum(part * part for _, part in named)), named)


def edge_doubt(edge: EdgeLine, plane: LocalPlane) -> float:
    """Return what the definition of an edge leaves open, metres: beyond the scatter along it."""
    least_m, of_spacing, of_sigma = _EXTENT_EDGE_M, _EXTENT_EDGE_SPACING, _EXTENT_EDGE_SIGMA
    sigma_m = plane.sigma_m
    if edge.source == "face":
        least_m, of_spacing, of_sigma = _FACE_EDGE_M, _FACE_EDGE_SPACING, _FACE_EDGE_SIGMA
        sigma_m = max(sigma_m, _ACROSS_FACE * edge.sigma_m)
    elif edge.is_counted:
        of_spacing, of_sigma = _COUNTED_EDGE_SPACING, _COUNTED_EDGE_SIGMA
    joint_m = _WALL_JOINT_M if edge.is_wall else 0.0
    return math.hypot(least_m, of_spacing * plane.spacing_m, of_sigma * sigma_m, joint_m)


def view_doubt(edge: EdgeLine, plane: LocalPlane, ray: Floats, across: Floats, length_m: float) -> float:
    """Return what is left uncertain of an edge by how a camera sees it, metres: beyond what any scan leaves open.

    Parameters
    ----------
    edge : EdgeLine
        A surface's edge.
    plane : LocalPlane
        Of the surface. What it departs from a plane by is the noise that neighbouring points have in common.
    ray : (3,)
        Unit vector from the camera to the surface, level frame: along it lies the noise.
    across : (2,)
        Direction of the plan, square to the edge.
    length_m : float
        Of the edge.

    Notes
    -----
    Seen at a grazing angle, a surface shows little of the noise in its height, and its edge all of it; and its points
    lie in rows, one of which may be missing before the edge.
    """
    grazing = max(abs(float(ray[2])), LEAST_GRAZING)
    along = abs(float(ray[:2] @ across))
    common_m = plane.misfit_m / grazing * along / math.sqrt(max(1.0, length_m / _PATCH_M))
    if edge.source == "face":
        return common_m
    # Rays lie as far apart in the row as between rows, but for the slant: the spacing is the root of the product.
    rows_m = plane.spacing_m / math.sqrt(grazing) * along
    return math.hypot(common_m, _EXTENT_EDGE_SPACING * rows_m)


def surface_doubt(plane: LocalPlane) -> float:
    """Return the standard uncertainty of a surface's height beyond its scatter, metres: smooth errors leave none."""
    return _SURFACE_SIGMA * plane.sigma_m


def slope_doubt(plane: LocalPlane, length_m: float) -> float:
    """Return the standard uncertainty of a surface's slope over its length beyond its scatter, as a tangent."""
    doubt_m = min(_SLOPE_SIGMA * plane.sigma_m, _SLOPE_MOST_M + _SLOPE_SHARE * plane.sigma_m)
    return doubt_m / max(length_m, plane.spacing_m)


def noise_before_rounding(sigma_m: float, normal: Floats, steps_m: Floats) -> float:
    """Return the noise that a surface had before its coordinates were rounded and spread over their steps, metres.

    Both have added the variance of an even distribution over one step on each axis.
    """
    added = float(normal**2 @ steps_m**2) / 6.0
    return math.sqrt(max(0.0, sigma_m**2 - added))


def rounding_doubt(normal: Floats, reaches: Sequence[Floats], sigma_m: float, steps_m: Floats) -> float:
    """Return what rounding leaves uncertain of where a surface lies along its normal, metres.

    Parameters
    ----------
    normal : (3,)
        Unit vector, in the axes along which the coordinates were rounded.
    reaches : sequence of (3,)
        From one end of the surface to the other, along it, same axes.
    sigma_m : float
        Noise along the normal, before rounding.
    steps_m : (3,)
        Steps of the coordinates, 0 for none.

    Notes
    -----
    The mean of rounded values is off by a saw-tooth of the true place, of period and height one step D: its harmonic k
    has the variance D**2 / (2 pi**2 k**2), all of them together D**2 / 12. No number of points lessens that; but noise
    smooths the saw-tooth, its harmonic k by exp(-2 pi**2 k**2 sigma**2 / D**2), and so does a surface that
    slants through c steps, by 1 / (pi k c) where that is less than one; a tenth is left, since points lie unevenly.

    References
    ----------
    .. [1] Widrow, Kollar: Quantization Noise, Cambridge 2008, chapter 4, for the moments of rounded normal values.
    """
    variance = 0.0
    for axis, step_m in enumerate(steps_m):
        if not step_m or not normal[axis]:
            continue
        # Where the normal slants, so does the noise: each axis has its own share.
        noise = abs(normal[axis]) * sigma_m / step_m
        cycles = max((abs(float(reach[axis])) / step_m for reach in reaches), default=0.0)
        for k in range(1, _HARMONICS + 1):
            smoothed = 1.0 if math.pi * k * cycles <= 1.0 else max(_LEAST_LEFT, 1.0 / (math.pi * k * cycles))
            left = math.exp(-2.0 * (math.pi * k * noise) ** 2) * smoothed
            variance += (normal[axis] * step_m * left / (math.pi * k)) ** 2 / 2.0
    return math.sqrt(variance)


def facet_doubt(facet_m: float, of: Literal["level", "edge", "side"]) -> float:
    """Return what the faces of a scanned mesh leave uncertain of where a level or an edge lies, metres.

    Between its corners a mesh knows nothing. Depth images are fused to a surface on a grid as fine as these faces: it
    is flat where the thing is flat, rounds a nosing off, and at a free side, beyond which another surface is seen, it
    ends early or flares.
    """
    return _OF_FACET[of] * facet_m


def thinning_doubt(normal: Floats, reach: Floats, steps_m: Floats) -> float:
    """Return what a lattice that is filled with one point a cell leaves uncertain of where a surface lies, metres.

    Parameters
    ----------
    normal : (3,)
        Unit vector, in the axes of the lattice.
    reach : (3,)
        From one end of the surface to the other, along it, same axes.
    steps_m : (3,)
        Sides of a cell.

    Notes
    -----
    Whatever of the surface lies in a cell, the cell counts once: a surface along a family of lattice planes seems to
    lie on one of them or between two, and noise does not average that out as it does for rounded points. The planes
    with the indices h are D = 1 / |h / steps| apart; an even error over one distance has the variance D**2 / 12. A
    surface that slants through c of them keeps 1 / (pi c) of it. The family that leaves most counts.
    """
    worst = 0.0
    for index in itertools.product((-1, 0, 1), repeat=3):
        if any(index):
            wave = np.array(index) / steps_m
            apart_m = 1.0 / float(np.linalg.norm(wave))
            cycles = abs(float(wave @ reach))
            faces = abs(float(wave @ normal)) * apart_m
            worst = max(worst, faces * apart_m / math.sqrt(12.0) / max(1.0, math.pi * cycles))
    return worst


def layers_doubt(apart_m: float) -> float:
    """Return what doubled surfaces leave uncertain of where one lies, metres: anywhere from one to the other."""
    return apart_m / math.sqrt(12.0)
