"""Where does a surface of bars end? Edges from its outermost points, whatever gaps lie behind them.

The density of a surface with gaps is that of its bars here and zero there: it says nothing about its edge. Coordinates
as in :mod:`stair_inspector.geometry.edges`: ``out`` square to the edge, away from the surface; ``along`` parallel.
"""

import math
from dataclasses import replace

import numpy as np

from stair_inspector.geometry.arrays import Floats
from stair_inspector.geometry.edges import EdgeLine, Sampling, count_bins, fit_line_robust

_STRAYS, _DEEP = 2, 9
"""Of the points of a piece, from outside: so many may have strayed, and up to this one they tell how dense they lie."""
_REACH_M = 0.12


def find_rim_edge(
    out: Floats, along: Floats, span: tuple[float, float], guess_m: float, sigma_m: float, is_square: bool = False
) -> EdgeLine | None:
    """Find the edge of a surface of bars.

    Parameters
    ----------
    out, along : (n,)
        Points of the surface near the edge.
    span : (low, high)
        Range along the edge.
    guess_m : float
        First guess of the edge, not farther off than 120 mm.
    sigma_m : float
        Noise of the points.
    is_square : bool
        Whether the edge is known to run along ``along``, without a slope.

    Returns
    -------
    EdgeLine or None
        None where too little of the edge was seen.

    Notes
    -----
    Points that lie anywhere on a bar with equal chance leave on the mean k times their mean distance between the edge
    and the k-th of them from outside, whose scatter is the root of k times it.
    """
    low, high = span
    n_bins = count_bins(span, Sampling(sigma_m, 0.0))
    inside = (along > low) & (along < high) & (np.abs(out - guess_m) <= _REACH_M)
    out, piece = out[inside], ((along[inside] - low) / (high - low) * n_bins).astype(np.int64)
    order = np.lexsort((-out, piece))
    out, starts = out[order], np.concatenate([[0], np.cumsum(np.bincount(piece, minlength=n_bins))])
    edges, places, sigmas, steps_m = [], [], [], []
    for k in range(n_bins):
        if starts[k + 1] - starts[k] <= _DEEP:
            continue
        first, last = float(out[starts[k] + _STRAYS]), float(out[starts[k] + _DEEP])
        apart_m = (first - last) / (_DEEP - _STRAYS)
        edges.append(first + (_STRAYS + 1) * apart_m)
        places.append(low + (k + 0.5) / n_bins * (high - low))
        # How dense they lie is itself known from so few points only.
        relative = (_STRAYS + 1) * (1.0 + (_STRAYS + 1) / (_DEEP - _STRAYS))
        steps_m.append(apart_m)
        sigmas.append(math.hypot(apart_m * math.sqrt(relative), sigma_m))
    line = fit_line_robust(np.array(places), np.array(edges), np.array(sigmas), is_square) if len(edges) >= 2 else None
    if line is None:
        return None
    # All pieces share what noise does to the outermost points, and that a narrow bar outside may hold too few of them.
    noise_m = math.hypot(line.middle_noise, sigma_m, float(np.median(steps_m)))
    return replace(line.as_edge(len(edges) / n_bins, "tread"), noise_m=noise_m, is_counted=True)
