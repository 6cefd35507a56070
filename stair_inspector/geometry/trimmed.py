"""Which plane is a surface's, where some of its points may be something else?"""

import numpy as np

from stair_inspector.geometry.arrays import Floats
from stair_inspector.geometry.percentiles import median_of_sorted

_TRIM_SIGMA = 3.0
_TRIM_ROUNDS = 3
_LEAST_SIGMA_M = 1e-6
_CORE_SHARE = 0.6
_CORE_QUANTILE = 0.8416
"""Share of the points that must lie on a surface, and the normal quantile below which so many residuals are."""
_CORE_ROUNDS = 10
_SETTLED = 0.05
"""A plane that moves by less of the scatter anywhere among its points has settled: what follows trims and fits anew."""


def fit_trimmed(points: Floats) -> tuple[Floats, Floats, float]:
    """Fit height as a linear function of plan to points (3, n) of which up to two in five may be something else.

    Returns
    -------
    slope : (2,)
        dz/dx and dz/dy; zero where the points do not span a plane.
    centre : (3,)
        Mean of the points kept, metres.
    sigma_m : float
        Robust scatter about the plane.

    References
    ----------
    .. [1] Rousseeuw, Van Driessen: Computing LTS regression for large data sets, 2006: the C-step. One start suffices
       here, the level plane at the height where the points are densest.
    """
    n = points.shape[1]
    n_core = min(n, max(3, int(_CORE_SHARE * n)))
    origin = points.mean(axis=1)
    # Sums of products of 1, x, y, z give every fit; about their own middle they lose no digits.
    rows = np.vstack([np.ones(n), points - origin[:, None]])
    reach_m = np.abs(rows[1:3]).max(axis=1)
    slope, centre = np.zeros(2), np.array([0.0, 0.0, densest(rows[3], n_core)])
    for _ in range(_CORE_ROUNDS):
        residual = np.abs(height_above(rows[1:], slope, centre))
        chosen = np.argpartition(residual, n_core - 1)[:n_core]
        sigma_m = float(residual[chosen[-1]]) / _CORE_QUANTILE
        before = slope, centre
        slope, centre = _fit_height(rows.take(chosen, axis=1))
        at_middle_m = abs(float(height_above(centre, *before)))
        moved_m = at_middle_m + float(np.abs(slope - before[0]) @ reach_m)
        if moved_m <= _SETTLED * max(sigma_m, _LEAST_SIGMA_M):
            break
    sigma_m = 0.0
    for _ in range(_TRIM_ROUNDS):
        residual = np.abs(height_above(rows[1:], slope, centre))
        # The core holds the smallest residuals: its largest is the quantile of the core's share.
        sigma_m = float(np.partition(residual, n_core - 1)[n_core - 1]) / _CORE_QUANTILE
        kept = np.flatnonzero(residual <= _TRIM_SIGMA * max(sigma_m, _LEAST_SIGMA_M))
        if len(kept) < 3:
            break
        slope, centre = _fit_height(rows.take(kept, axis=1))
    return slope, centre + origin, sigma_m


def height_above(points: Floats, slope: Floats, centre: Floats) -> Floats:
    """Return how far points (3, n) lie above the plane through ``centre`` (3,) with a slope (2,), metres, (n,)."""
    residual: Floats = points[2] - centre[2] - slope[0] * (points[0] - centre[0]) - slope[1] * (points[1] - centre[1])
    return residual


def densest(values: Floats, wanted: int) -> float:
    """Return the middle of the shortest interval that holds the wanted number of values."""
    ordered = np.sort(values)
    if wanted >= len(ordered):
        return median_of_sorted(ordered)
    spans = ordered[wanted - 1 :] - ordered[: len(ordered) - wanted + 1]
    start = int(np.argmin(spans))
    return median_of_sorted(ordered[start : start + wanted])


def _fit_height(rows: Floats) -> tuple[Floats, Floats]:
    """Fit height by least squares to rows (4, n) of 1, x, y and z; the slope is zero where they do not span a plane."""
    sums = rows @ rows.T
    centre = sums[0, 1:] / sums[0, 0]
    (xx, xy, xz), (_, yy, yz) = (sums[1:3, 1:] - sums[0, 0] * centre[:2, None] * centre).tolist()
    det = xx * yy - xy * xy
    if det <= 1e-9 * (xx + yy) ** 2:
        return np.zeros(2), centre
    return np.array([yy * xz - xy * yz, xx * yz - xy * xz]) / det, centre
