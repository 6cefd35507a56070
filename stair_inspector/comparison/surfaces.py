"""What a surface tells of the motion between two scans: planes of treads and floor, lines of risers."""

import math
from dataclasses import dataclass

import numpy as np

from stair_inspector.comparison.cells import SurfaceChange
from stair_inspector.comparison.epochs import Epoch, Tread, height_doubt, slope_doubt_of
from stair_inspector.geometry.arrays import Bools, Floats
from stair_inspector.geometry.percentiles import MAD_TO_SIGMA
from stair_inspector.geometry.plan import left_of
from stair_inspector.model import COVERAGE_FACTOR, Measured, Step

_FEWEST_CELLS = 6
_DRAWS, _SEED = 100, 0
_TUKEY = 4.685
_LEAST_SCALE_M, _MOST_SCATTER = 1e-4, 1.3
_ABOVE_M, _BELOW_M = 0.025, 0.06
"""Between which heights a riser is looked for: above the tread below, below the slab and the overhang above."""
_AHEAD_M = (-0.02, 0.09)
"""Where behind the nosing a riser may stand."""
_WINDOW_M = 0.008
_BLOCKS = 8
_FEWEST_IN_BLOCK = 10


@dataclass(frozen=True, slots=True, eq=False)
class PlaneChange:
    """How the plane of a surface changed: ``change`` (3,) its height at ``middle_m`` (2,) and its slopes along x and y.

    ``covariance`` (3, 3) holds the noise of the cells and what each scan says of its own heights and slopes;
    ``left_m`` (cells,) are the deviations less the plane.
    """

    middle_m: Floats
    change: Floats
    covariance: Floats
    left_m: Floats


def plane_change(surface: SurfaceChange, own: Floats) -> PlaneChange | None:
    """Fit a plane to the deviations of a surface, robustly: where it is worn, that is not how it lies.

    ``own`` (3, 3) is the covariance of what the scans say of their own heights and slopes. None with too few cells.
    """
    seen = np.flatnonzero(np.isfinite(surface.deviation_m))
    if len(seen) < _FEWEST_CELLS:
        return None
    middles = surface.grid.middles()[:, seen]
    middle = middles.mean(axis=1)
    rows = np.stack([np.ones(len(seen)), *(middles - middle[:, None])], axis=1)
    deviation, noise = surface.deviation_m[seen], surface.noise_m[seen]
    if np.linalg.matrix_rank(rows) < 3:
        return None
    weights = _steady_weights(rows, deviation, noise)
    scaled = rows * (weights / noise**2)[:, None]
    covariance = np.linalg.inv(scaled.T @ rows)
    change = covariance @ (scaled.T @ deviation)
    left = deviation - rows @ change
    # Neighbouring cells share what the noise does not hold, as the ridges where two stations meet.
    excess = float(np.sum(weights * (left / noise) ** 2) / max(1.0, float(weights.sum()) - 3.0))
    all_left = np.full(len(surface.deviation_m), math.nan)
    all_left[seen] = left
    return PlaneChange(middle, change, covariance * max(1.0, excess) + own, all_left)


def _steady_weights(rows: Floats, deviation: Floats, noise: Floats) -> Floats:
    """Return the weights (n,) of cells about the plane of most of them: least median of squares, then biweight."""
    rng = np.random.default_rng(_SEED)
    best: Floats = np.zeros(3)
    least = math.inf
    for _ in range(_DRAWS):
        chosen = rows[(drawn := rng.choice(len(rows), 3, replace=False))]
        if abs(np.linalg.det(chosen)) < 1e-6:
            continue
        plane = np.asarray(np.linalg.solve(chosen, deviation[drawn]), dtype=np.float64)
        middle = float(np.median(np.abs(deviation - rows @ plane)))
        if middle < least:
            best, least = plane, middle
    weights = np.ones(len(rows))
    for _ in range(10):
        left = deviation - rows @ best
        # What is worn counts in the scatter: not much more than the noise of the cells is believed of it.
        scatter = MAD_TO_SIGMA * float(np.median(np.abs(left)))
        scale = np.clip(scatter, noise, _MOST_SCATTER * np.hypot(noise, _LEAST_SCALE_M))
        weights = np.clip(1.0 - (left / (_TUKEY * scale)) ** 2, 0.0, None) ** 2
        scaled = rows * (weights / noise**2)[:, None]
        best = np.asarray(np.linalg.lstsq(scaled.T @ rows, scaled.T @ deviation, rcond=None)[0], dtype=np.float64)
    return weights


def own_covariance(ours: Tread, theirs: Tread, steps: tuple[Step, ...], others: tuple[Step, ...]) -> Floats:
    """Return the covariance (3, 3) of the change of a plane by what both scans say of heights and slopes.

    The noise is in the cells; what is left is registration, layers and the like. Where the front and the back of a
    surface are seen from two stations, their heights against each other are a slope.
    """
    step, other, climb = ours.step, theirs.step, ours.climb
    height = height_doubt(step, steps) ** 2 + height_doubt(other, others) ** 2
    depth_m = float(np.ptp(ours.corners @ climb))
    along = sum(slope_doubt_of(each.fall_deg) ** 2 for each in (step, other)) + height / depth_m**2
    across = sum(slope_doubt_of(each.cross_fall_deg) ** 2 for each in (step, other))
    axes = np.stack([climb, left_of(climb)], axis=1)
    covariance = np.zeros((3, 3))
    covariance[0, 0] = height
    covariance[1:, 1:] = axes @ np.diag([along, across]) @ axes.T
    return covariance


@dataclass(frozen=True, slots=True, eq=False)
class RiserLine:
    """A riser in plan: its ``middle`` (2,), the direction (2,) in which it faces away, and its standard uncertainty.

    ``noise_m`` is that of the place along the direction, ``turn_noise_rad`` that of the direction.
    """

    middle: Floats
    facing: Floats
    noise_m: float
    turn_noise_rad: float


def riser_line(epoch: Epoch, tread: Tread) -> RiserLine | None:
    """Return the line of the riser below a nosing; None where none is seen, as where one sees through."""
    rise = tread.step.rise_m
    if rise is None:
        return None
    middle = tread.nosing.mean(axis=0)
    left = left_of(tread.climb)
    half = 0.4 * float(np.linalg.norm(tread.nosing[0] - tread.nosing[1]))
    low, high = float(middle[2]) - rise.value + _ABOVE_M, float(middle[2]) - _BELOW_M
    if high - low < _ABOVE_M:
        return None
    points = epoch.between(low, high)
    x, y = points[0] - middle[0], points[1] - middle[1]
    s, w = tread.climb[0] * x + tread.climb[1] * y, left[0] * x + left[1] * y
    is_near = (s > _AHEAD_M[0]) & (s < _AHEAD_M[1]) & (np.abs(w) < half)
    s, w = s[is_near], w[is_near]
    if len(s) < _BLOCKS * _FEWEST_IN_BLOCK:
        return None
    # Where most points lie within a window.
    ordered = np.sort(s)
    until = np.searchsorted(ordered, ordered + 2.0 * _WINDOW_M, side="right")
    start = int(np.argmax(until - np.arange(len(ordered))))
    place = float(np.median(ordered[start : until[start]]))
    is_on: Bools = np.abs(s - place) <= _WINDOW_M
    s, w = s[is_on], w[is_on]
    block = np.clip(np.floor((w + half) / (2.0 * half) * _BLOCKS), 0, _BLOCKS - 1).astype(np.int64)
    seen = [k for k in range(_BLOCKS) if np.count_nonzero(block == k) >= _FEWEST_IN_BLOCK]
    if len(seen) < 4:
        return None
    places = np.array([[float(np.median(s[block == k])), float(np.median(w[block == k]))] for k in seen])
    rows = np.stack([np.ones(len(seen)), places[:, 1]], axis=1)
    line, *_ = np.linalg.lstsq(rows, places[:, 0], rcond=None)
    scatter = max(float(np.sum((places[:, 0] - rows @ line) ** 2)) / (len(seen) - 2), (_LEAST_SCALE_M / 2.0) ** 2)
    covariance = scatter * np.linalg.inv(rows.T @ rows)
    facing = tread.climb - float(line[1]) * left
    return RiserLine(
        middle[:2] + float(line[0]) * tread.climb,
        facing / np.hypot(*facing),
        math.sqrt(float(covariance[0, 0])),
        math.sqrt(float(covariance[1, 1])),
    )


def own_doubt(measured: Measured | None, names: tuple[str, ...]) -> float:
    """Return the standard uncertainty of one of the two edges that a value hangs on, by these of its parts, metres."""
    if measured is None:
        return 0.0
    return math.sqrt(sum(part * part for name, part in measured.parts if name in names) / 2.0) / COVERAGE_FACTOR
