"""Which plane is a surface's, where some of its points may be something else?"""

import numpy as np

from stair_inspector.geometry.arrays import Floats

_TRIM_SIGMA = 3.0
_TRIM_ROUNDS = 3
_LEAST_SIGMA_M = 1e-6
_CORE_SHARE = 0.6
_CORE_QUANTILE = 0.8416
"""Share of the points that must lie on a surface, and the normal quantile below which so many residuals are."""
_CORE_ROUNDS = 10


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
    slope, centre = np.zeros(2), np.array([*points[:2].mean(axis=1), densest(points[2], n_core)])
    chosen = np.arange(n)
    for _ in range(_CORE_ROUNDS):
        residual = np.abs(height_above(points, slope, centre))
        before, chosen = chosen, np.argpartition(residual, n_core - 1)[:n_core] if n_core < n else chosen
        slope, centre = _fit_height(points[:, chosen])
        if len(before) == len(chosen) and np.array_equal(np.sort(before), np.sort(chosen)):
            break
    sigma_m = 0.0
    for _ in range(_TRIM_ROUNDS):
        residual = np.abs(height_above(points, slope, centre))
        # The core holds the smallest residuals: its largest is the quantile of the core's share.
        sigma_m = float(np.partition(residual, n_core - 1)[n_core - 1]) / _CORE_QUANTILE
        kept = residual <= _TRIM_SIGMA * max(sigma_m, _LEAST_SIGMA_M)
        if np.count_nonzero(kept) < 3:
            break
        slope, centre = _fit_height(points[:, kept])
    return slope, centre, sigma_m


def height_above(points: Floats, slope: Floats, centre: Floats) -> Floats:
    """Return how far points (3, n) lie above the plane through ``centre`` (3,) with a slope (2,), metres, (n,)."""
    residual: Floats = points[2] - centre[2] - slope[0] * (points[0] - centre[0]) - slope[1] * (points[1] - centre[1])
    return residual


def densest(values: Floats, wanted: int) -> float:
    """Return the middle of the shortest interval that holds the wanted number of values."""
    ordered = np.sort(values)
    if wanted >= len(ordered):
        return float(np.median(ordered))
    spans = ordered[wanted - 1 :] - ordered[: len(ordered) - wanted + 1]
    start = int(np.argmin(spans))
    return float(np.median(ordered[start : start + wanted]))


def _fit_height(points: Floats) -> tuple[Floats, Floats]:
    """Fit height by least squares; the slope is zero where the points do not span a plane."""
    centre = points.mean(axis=1)
    shift = points - centre[:, None]
    scatter = np.einsum("in,jn->ij", shift[:2], shift)
    if np.linalg.det(scatter[:, :2]) <= 1e-9 * np.trace(scatter[:, :2]) ** 2:
        return np.zeros(2), centre
    slope: Floats = np.linalg.solve(scatter[:, :2], scatter[:, 2])
    return slope, centre
