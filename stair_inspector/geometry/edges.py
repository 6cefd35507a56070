"""Where does a surface end? Straight edges of sampled surfaces: robust lines, and edges by adjoining faces.

Coordinates of an edge: ``out`` square to it, away from the surface; ``along`` parallel to it; ``offset`` the signed
distance from the surface's plane. Metres throughout.
"""

import dataclasses
import functools
import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from stair_inspector.geometry.arrays import Floats, Ints, freeze
from stair_inspector.geometry.percentiles import MAD_TO_SIGMA, median_of_sorted

Half = Literal["all", "above", "below"]

_BIN_M = 0.08
_BIN_SPACINGS = 8.0
_FEWEST_BINS, _MOST_BINS = 2, 16
TUKEY = 4.685
"""Of the biweight, in standard deviations: 95 % as efficient as least squares where all errors are normal."""
_ROUNDS = 20
_FEWEST_FOR_SCATTER = 3.5
_FACE_ROUNDS = 12
_SETTLED_M = 2e-6
"""Rounds end when an edge moves by less: a hundredth of what the best scanner can tell."""
_LEAST_FACE_POINTS = 12
_DROOP_SIGMA, _LEAST_DEEP = 1.5, 0.5
"""A face goes on beyond what noise does to a rim: of the points that an even face has there, this share at least."""
_LEAST_PER_BIN = 4


@dataclass(frozen=True, slots=True, eq=False)
class Sampling:
    """How a surface was sampled: noise across it (1 sigma), distance of neighbouring points, metres.

    ``left_out`` is the range along an edge whose points were left out: nothing is seen of the edge there, nor missed.
    """

    sigma_m: float
    spacing_m: float
    left_out: tuple[float, float] | None = None

    def seen_share(self, n_seen: int, n_bins: int, span: tuple[float, float]) -> float:
        """Return the share of an edge that was seen, from how many of the pieces of its span were."""
        if self.left_out is None:
            return n_seen / n_bins
        starts = span[0] + np.arange(n_bins + 1) / n_bins * (span[1] - span[0])
        is_out = (starts[:-1] >= self.left_out[0]) & (starts[1:] <= self.left_out[1])
        return min(1.0, n_seen / max(1, n_bins - int(np.count_nonzero(is_out))))


@dataclass(frozen=True, slots=True)
class EdgeLine:
    """An edge as ``out = middle_m + slope * (along - along_m)``, with the evidence for it.

    ``noise_m`` is the standard uncertainty of ``middle_m`` as the scatter along the edge shows it, ``slope_noise`` that
    of the slope; ``support`` the share of the edge that was seen; ``purity`` the share of the points in which a face
    was looked for that lie on it. ``obstructed_m`` is the part of ``noise_m`` that is there because something stands at
    the edge, whose shadow it may be. ``is_wall`` says that the face goes up from the surface, as that of a wall does,
    or of a thing that stands on it; ``is_counted`` that ``noise_m`` holds what the distance of the points leaves open.
    ``sigma_m`` is the noise of single points across a face where that is known by itself, 0 where it is the surface's,
    and ``seen_by`` the number of the station that saw most of it, -1 where it is not known.
    """

    middle_m: float
    slope: float
    along_m: float
    noise_m: float
    slope_noise: float
    support: float
    source: Literal["tread", "face"]
    purity: float = 1.0
    obstructed_m: float = 0.0
    is_wall: bool = False
    is_counted: bool = False
    sigma_m: float = 0.0
    seen_by: int = -1

    @property
    def free_noise_m(self) -> float:
        """Return the noise without what is there because of an obstacle."""
        return math.sqrt(max(0.0, self.noise_m**2 - self.obstructed_m**2))

    def flipped(self) -> "EdgeLine":
        """Return the same edge with ``out`` counted the other way."""
        return dataclasses.replace(self, middle_m=-self.middle_m, slope=-self.slope)

    def beyond(self, out: Floats, along: Floats) -> Floats:
        """Return how far outside the edge places (n,) lie, metres."""
        beyond: Floats = out - self.middle_m - self.slope * (along - self.along_m)
        return beyond

    def at(self, along_m: float) -> float:
        """Return ``out`` at a place along the edge."""
        return self.middle_m + self.slope * (along_m - self.along_m)

    def noise_at(self, along_m: float) -> float:
        """Return the standard uncertainty of :meth:`at`."""
        return math.hypot(self.noise_m, self.slope_noise * (along_m - self.along_m))


@dataclass(frozen=True, slots=True)
class RobustLine:
    """A line ``y = middle + slope * (x - x_middle)`` and the standard uncertainties of its two parameters."""

    middle: float
    slope: float
    x_middle: float
    middle_noise: float
    slope_noise: float

    def as_edge(self, support: float, source: Literal["tread", "face"]) -> EdgeLine:
        """Return the line as an edge, x along it."""
        return EdgeLine(self.middle, self.slope, self.x_middle, self.middle_noise, self.slope_noise, support, source)


def fit_line_robust(x: Floats, y: Floats, sigma: Floats, is_level: bool = False) -> RobustLine | None:
    """Fit a line to few points of which some are wrong: median of slopes, then Tukey's biweight.

    Parameters
    ----------
    x, y : (n,)
        At least two different x.
    sigma : (n,)
        Expected standard uncertainty of each y, positive: the smaller, the more a point counts. The scatter about the
        line replaces it where that is larger, and where the points are too few to have a scatter it stands.
    is_level : bool
        Whether the slope is known to be zero.

    Returns
    -------
    RobustLine or None
        None for fewer than two points, or all at one x.

    References
    ----------
    .. [1] Beaton, Tukey: The fitting of power series, Technometrics 16, 1974, for the weights.
    """
    n = len(x)
    if n < 2 or np.ptp(x) == 0.0:
        return None
    i, j = _pairs(n)
    apart = np.abs(x[j] - x[i]) > 0.1 * np.ptp(x)
    slope = 0.0 if is_level else _median((y[j] - y[i])[apart] / (x[j] - x[i])[apart])
    # A piece that seems ten times as exact as the usual one is not trusted ten times as much.
    weight = 1.0 / np.maximum(sigma, 0.5 * _median(sigma)) ** 2
    residual = y - slope * x
    residual -= _median(residual)
    robust = np.ones(n)
    middle = x_middle = 0.0
    previous, span = math.inf, float(np.ptp(x))
    for _ in range(_ROUNDS):
        spread_of = MAD_TO_SIGMA * _median(np.abs(residual))
        scaled = residual / (TUKEY * np.maximum(spread_of, sigma))
        robust = np.where(np.abs(scaled) < 1.0, (1.0 - scaled**2) ** 2, 0.0) * weight
        if np.count_nonzero(robust) < 2:
            robust = weight
        total = robust.sum()
        x_middle = float(robust @ x / total)
        middle = float(robust @ y / total)
        spread = float(robust @ (x - x_middle) ** 2)
        if spread <= 0.0:
            return None
        slope_new = 0.0 if is_level else float(robust @ ((x - x_middle) * (y - middle)) / spread)
        residual = y - middle - slope_new * (x - x_middle)
        moved = abs(slope_new - slope) * span + abs(middle - previous)
        slope, previous = slope_new, middle
        if moved <= _SETTLED_M:
            break
    share = robust / total
    effective = 1.0 / float(share @ share)
    expected = float(share**2 @ sigma**2)
    scatter = 0.0
    if effective > _FEWEST_FOR_SCATTER:
        scatter = float(share @ residual**2) / (effective - 2.0)
    noise = math.sqrt(max(expected, scatter))
    slope_noise = 0.0 if is_level else noise / math.sqrt(spread / total)
    return RobustLine(middle, slope_new, x_middle, noise, slope_noise)


@functools.cache
def _pairs(n: int) -> tuple[Ints, Ints]:
    """Return the numbers of all pairs of n things; numpy's is slow to begin, and an edge has few pieces."""
    i, j = np.triu_indices(n, 1)
    return freeze(i), freeze(j)


def find_face_edge(
    out: Floats,
    along: Floats,
    offset: Floats,
    span: tuple[float, float],
    guess: tuple[float, float],
    reach_m: float,
    heights: tuple[float, float],
    sampling: Sampling,
    is_square: bool = False,
) -> EdgeLine | None:
    """Find an edge from the upright face that meets the surface there.

    Parameters
    ----------
    out, along, offset : (n,)
        Points near the edge.
    span : (low, high)
        Range along the edge.
    guess : (middle, slope)
        First guess of the edge: ``out`` at the middle of the span, and its slope along the edge.
    reach_m : float
        The face is looked for within this distance of the guess.
    heights : (near, far)
        Signed distances from the plane between which the face is looked for: negative for a face that goes down.
    sampling : Sampling
        Noise and spacing of the surface.
    is_square : bool
        Whether the edge is known to run along ``along``, without a slope.

    Returns
    -------
    EdgeLine or None
        None where no face is seen.

    Notes
    -----
    Noise carries points of the surface itself into the band of the face, and just as many into the band's mirror image
    on the other side of the plane, where there is no face: those are subtracted.
    """
    low, high = span
    near, far = sorted(heights, key=abs)
    middle_along = (low + high) / 2.0
    # Relative to the guess, so that a slanting edge is upright here.
    out = out - guess[0] - guess[1] * (along - middle_along)
    within = np.flatnonzero((np.abs(out) <= reach_m) & (along > low) & (along < high))
    out, along, size = out[within], along[within], math.copysign(1.0, far) * offset[within]
    is_face = (size >= abs(near)) & (size <= abs(far))
    is_mirror = (-size >= abs(near)) & (-size <= abs(far))
    places = np.concatenate([along[is_face], along[is_mirror]])
    values = np.concatenate([out[is_face], out[is_mirror]])
    deep_from = abs(near) + _DROOP_SIGMA * sampling.sigma_m
    is_deep = np.concatenate([size[is_face], -size[is_mirror]]) >= deep_from
    sign = np.concatenate([np.ones(np.count_nonzero(is_face)), -np.ones(np.count_nonzero(is_mirror))])
    if sign.sum() < _LEAST_FACE_POINTS:
        return None
    n_bins = count_bins(span, sampling)
    width = max(2.5 * sampling.sigma_m, 0.004)
    start = _mode(values, sign, width, reach_m)
    slope = 0.0
    line: RobustLine | None = None
    used = 0
    for _ in range(_FACE_ROUNDS):
        residual = values - start - slope * (places - middle_along)
        is_near = np.abs(residual) <= width
        piece = ((places[is_near] - low) / (high - low) * n_bins).astype(np.int64).clip(0, n_bins - 1)
        mass = np.bincount(piece, sign[is_near], n_bins)
        gross = np.bincount(piece, minlength=n_bins)
        keep = (mass >= _LEAST_PER_BIN) & (mass >= 0.3 * gross)
        used = int(np.count_nonzero(keep))
        if used < 2:
            return None
        mean = np.bincount(piece, sign[is_near] * residual[is_near], n_bins)[keep] / mass[keep]
        centre = np.bincount(piece, sign[is_near] * places[is_near], n_bins)[keep] / mass[keep]
        mean += start + slope * (centre - middle_along)
        spread = np.bincount(piece, sign[is_near] * residual[is_near] ** 2, n_bins)[keep] / mass[keep]
        # The spread of an even distribution over the window is the most that noise can do.
        spread = np.clip(spread - (mean - start - slope * (centre - middle_along)) ** 2, 1e-10, width**2 / 3.0)
        sigma = np.sqrt(spread * gross[keep]) / mass[keep]
        line = fit_line_robust(centre, mean, sigma, is_square)
        if line is None:
            return None
        moved = line.middle + line.slope * (middle_along - line.x_middle) - start
        start += moved
        slope = line.slope
        if abs(moved) < _SETTLED_M:
            break
    # The smoothed rim of a surface droops as if a face began there, but leads no farther down.
    deep_share = max(0.0, abs(far) - deep_from) / (abs(far) - abs(near))
    if line is None or sign[is_near & is_deep].sum() < _LEAST_DEEP * deep_share * sign[is_near].sum():
        return None
    return dataclasses.replace(
        line.as_edge(sampling.seen_share(used, n_bins, span), "face"),
        middle_m=line.middle + guess[0] + guess[1] * (line.x_middle - middle_along),
        slope=line.slope + guess[1],
        purity=float(mass.sum() / sign.sum()),
    )


def count_bins(span: tuple[float, float], sampling: Sampling) -> int:
    """Return into how many pieces an edge is cut."""
    length_m = span[1] - span[0]
    return int(np.clip(length_m / max(_BIN_M, _BIN_SPACINGS * sampling.spacing_m), _FEWEST_BINS, _MOST_BINS))


def _median(values: Floats) -> float:
    """Return the median of few values; numpy's takes thirty times as long to begin."""
    return median_of_sorted(np.sort(values))


def _mode(values: Floats, sign: Floats, width: float, reach_m: float) -> float:
    """Return the place with most points within half a width, those of the mirror image subtracted."""
    n = max(3, int(2.0 * reach_m / (0.25 * width)))
    bins = ((values + reach_m) / (2.0 * reach_m) * n).astype(np.int64).clip(0, n - 1)
    counts = np.bincount(bins, sign, n)
    smooth = np.convolve(counts, np.ones(4), mode="same")
    return -reach_m + (int(np.argmax(smooth)) + 0.5) / n * 2.0 * reach_m
