"""How sure is a value? Named parts of standard uncertainties, put together as the GUM says.

Every function takes and returns standard uncertainties (k = 1); :func:`expanded` makes the ``u`` (k = 2) that is shown.
"""

import math

from stair_inspector.geometry.edges import EdgeLine
from stair_inspector.model import LocalPlane, Measured

K = 2.0
"""Coverage factor: about 95 % for a value whose error is nearly normal."""
_FACE_EDGE_M = 0.000017
_FACE_EDGE_SPACING = 0.0085
_FACE_EDGE_SIGMA = 0.0425
"""Doubt about where an edge is, given its face: of a face's flatness, of the spacing and of the noise of the points."""
_TREAD_EDGE_M = 0.0001
_TREAD_EDGE_SPACING = 0.25
_TREAD_EDGE_SIGMA = 0.10
"""The same for an edge known from the extent of a tread only: the last row of points may or may not be there."""
_SLOPE_SIGMA, _SLOPE_SHARE, _SLOPE_MOST_M = 0.65, 0.1, 0.0012
"""Doubt about the fall of a tread over its depth, as a share of the noise of single points, the smaller one beyond some
millimetres: where two stations, or two passes, see the front and the back of a tread, their difference is a slope."""
NEAR_REGISTRATION = 0.5
"""Share of what registration adds from one step to the next that is left between two edges at one place."""
_SURFACE_SIGMA = 0.02
"""Doubt about a surface's height beyond its scatter, as a share of the noise of single points."""


def expanded(value: float, **parts: float) -> Measured:
    """Return a value with its expanded uncertainty and the parts that have any weight.

    References
    ----------
    .. [1] JCGM 100:2008 (GUM), 5.1.2 for the sum of squares and 6.2 for the factor k.
    """
    named = tuple((name, K * part) for name, part in parts.items() if part > 0.0)
    return Measured(value, math.sqrt(sum(part * part for _, part in named)), named)


def edge_doubt(edge: EdgeLine, plane: LocalPlane) -> float:
    """Return what the definition of an edge leaves open, metres: beyond the scatter along it."""
    if edge.source == "face":
        parts = (_FACE_EDGE_M, _FACE_EDGE_SPACING * plane.spacing_m, _FACE_EDGE_SIGMA * plane.sigma_m)
    else:
        parts = (_TREAD_EDGE_M, _TREAD_EDGE_SPACING * plane.spacing_m, _TREAD_EDGE_SIGMA * plane.sigma_m)
    return math.hypot(*parts)


def surface_doubt(plane: LocalPlane) -> float:
    """Return the standard uncertainty of a surface's height beyond its scatter, metres: smooth errors leave none."""
    return _SURFACE_SIGMA * plane.sigma_m


def slope_doubt(plane: LocalPlane, length_m: float) -> float:
    """Return the standard uncertainty of a surface's slope over its length beyond its scatter, as a tangent."""
    doubt_m = min(_SLOPE_SIGMA * plane.sigma_m, _SLOPE_MOST_M + _SLOPE_SHARE * plane.sigma_m)
    return doubt_m / max(length_m, plane.spacing_m)
