"""Which theta_th, eps_z and m suit a scan, and why? From its normals, its spacing and the gaps between its heights."""

import itertools
import math
from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from stair_inspector.errors import CannotMeasure
from stair_inspector.geometry.arrays import Floats, Ints
from stair_inspector.geometry.percentiles import mad_sigma
from stair_inspector.model import HeightOrder
from stair_inspector.params import SETTINGS, FlightsParams, Params
from stair_inspector.stages.density import reach_of_neighbours

_THETA_DEG = (10.0, 30.0)
"""A worn or falling tread leans by some degrees, however clean the scan; beyond, ramps and edges are taken as level."""
_THETA_SIGMAS = 3.5
"""Of normals that scatter by sigma in two directions, all but 0.2 % are nearer to their mean than this."""
_FACING_DEG = 30.0
_ROUNDS = 30
_MEDIAN_OF_2_SIGMA = math.sqrt(-2.0 * math.log(0.5 + 0.5 * math.exp(-2.0)))
"""Median of the angles below 2 sigma, in sigma, where both components are normally distributed (Rayleigh)."""
_NEIGHBOURS, _SPACING_SAMPLE = 8, 2000
_PROBE_M, _GRID_M = 0.006, 0.002
_BESIDE_M: Floats = np.linspace(-0.01, 0.01, 11)
_MOST_HEIGHTS = 100_000
_LEAST_EPS_M = 0.005
_EPS_SIGMAS = 3.0
_EPS_PER_GAP = 0.2
"""A fifth of the smallest rise: the points within eps_z of a level stay far from the next one."""
_WEAK_SHARE, _LEAST_SHARE = 0.2, 0.1
"""A level holds at least these shares of what the median level and the smallest tread hold: less is clutter."""
_SEPARATE_SHARE = 0.5
"""Between two levels there is a height with less than this share of the weaker one; else they are one level."""
_M_SHARE, _CLEAR_SHARE, _MOST_SHARE = 0.5, 0.02, 0.25
"""Bounds of m, in shares of the weakest level: its thin ends must be core points, stray points between must not."""
_FEWEST_POINTS = 10


@dataclass(frozen=True, slots=True)
class Reason:
    """A setting by its dotted name, its suggested value, and the sentence why."""

    name: str
    value: float
    why: str


@dataclass(frozen=True, slots=True)
class Suggestion:
    """Settings proposed for a scan, and what was seen in it.

    ``params`` are the settings given, with the suggested ones in their place. ``spacing_m`` is the distance of
    neighbouring points on level surfaces, ``normal_deg`` the scatter of their normals and ``thickness_m`` that of the
    heights within a level (one sigma each), ``gap_m`` the smallest rise between two of the ``n_levels`` levels, None
    where no two are a rise apart.
    """

    params: Params
    reasons: tuple[Reason, ...]
    spacing_m: float
    normal_deg: float
    thickness_m: float
    gap_m: float | None
    n_levels: int


def suggest_settings(heights: HeightOrder, params: Params) -> Suggestion:
    """Propose theta_th, eps_z and m.

    Parameters
    ----------
    heights : HeightOrder
        The scan's points by height, with the angles of their normals; level frame.
    params : Params
        The present settings: all but the three are kept, and a stair's rises and areas are taken from them.

    Returns
    -------
    Suggestion
        The three lie within the ranges of their knobs.

    Raises
    ------
    CannotMeasure
        No level surface is seen.

    Notes
    -----
    theta_th: the angles of normals that scatter in two directions have a Rayleigh distribution. Its sigma is found from
    the median of the angles below 2 sigma, again and again, so that the long tail from edges and walls does not count.

    eps_z: three times the scatter of the heights within a level, at most a fifth of the smallest rise between levels.

    m: between what the weakest level holds within eps_z of its height and what the clearest height between two levels
    holds, but never more than the smallest tread has points at this spacing.
    """
    sigma_deg = _scatter_of_normals(heights)
    theta_deg = _on_knob("horizontal.theta_deg", float(np.clip(_THETA_SIGMAS * sigma_deg, *_THETA_DEG)))
    is_level = heights.alignment >= math.cos(math.radians(theta_deg))
    points = heights.coordinates_m[:, is_level]
    z_m = points[2]
    if len(z_m) < _FEWEST_POINTS:
        raise CannotMeasure(
            f"only {len(z_m)} points face up, too few to suggest settings from; check the up direction and the region"
        )
    spacing_m = _find_spacing(points)
    n_smallest = max(float(_FEWEST_POINTS), params.patches.min_area_m2 / spacing_m**2)
    levels_m = _find_levels(z_m, params.flights.min_rise_m / 2.0, _LEAST_SHARE * n_smallest)
    gap_m = _smallest_rise(levels_m, params.flights)
    thickness_m = _find_thickness(z_m, levels_m, (gap_m or params.flights.min_rise_m) / 3.0)
    eps_m = max(_LEAST_EPS_M, _EPS_SIGMAS * thickness_m)
    eps_m = _on_knob("levels.eps_m", eps_m if gap_m is None else min(eps_m, _EPS_PER_GAP * gap_m))
    weakest = min(_highest_count(z_m, level, eps_m) for level in levels_m)
    apart = [pair for pair in itertools.pairwise(levels_m) if pair[1] - pair[0] >= params.flights.min_rise_m]
    clearest = max((_clearest_count(z_m, *pair, eps_m) for pair in apart), default=None)
    between = math.sqrt(max(clearest or 0, _CLEAR_SHARE * weakest) * _M_SHARE * weakest)
    wanted = min(between, _MOST_SHARE * weakest, n_smallest)
    min_points = int(_on_knob("levels.min_points", max(float(_FEWEST_POINTS), wanted)))
    reasons = (
        Reason("horizontal.theta_deg", theta_deg, _why_theta(theta_deg, sigma_deg)),
        Reason("levels.eps_m", eps_m, _why_eps(eps_m, thickness_m, gap_m)),
        Reason("levels.min_points", min_points, _why_m(min_points, weakest, clearest, eps_m, spacing_m)),
    )
    for reason in reasons:
        params = params.replaced(reason.name, reason.value)
    return Suggestion(params, reasons, spacing_m, sigma_deg, thickness_m, gap_m, len(levels_m))


def _scatter_of_normals(heights: HeightOrder) -> float:
    """Return the standard deviation of one component of the normals of level surfaces, degrees."""
    angles = np.degrees(np.arccos(np.clip(heights.alignment, 0.0, 1.0)))
    angles = np.sort(angles[angles < _FACING_DEG])
    if not len(angles):
        raise CannotMeasure(
            f"no point's normal is within {_FACING_DEG:g} degrees of up; check the up direction and the region"
        )
    sigma = float(angles[len(angles) // 2])
    for _ in range(_ROUNDS):
        n_below = max(1, int(np.searchsorted(angles, 2.0 * sigma)))
        sigma = float(angles[n_below // 2]) / _MEDIAN_OF_2_SIGMA
    return sigma


def _find_spacing(points: Floats) -> float:
    """Return the typical distance of neighbours on a surface, metres: the side of the square that one point stands for.

    ``points`` (3, n). The disc to the k-th neighbour of a point holds k points, however irregularly they lie.
    """
    k = min(_NEIGHBOURS, points.shape[1] - 1)
    return max(1e-4, float(np.median(reach_of_neighbours(points, k, _SPACING_SAMPLE))) * math.sqrt(math.pi / k))


def _find_levels(z_m: Floats, reach_m: float, least: float) -> list[float]:
    """Return the heights at which most points lie within a reach, those that stand apart and are not clutter.

    ``z_m`` ascending; ``least`` the fewest points of a level. Never empty.
    """
    grid_m = max(_GRID_M, float(z_m[-1] - z_m[0]) / _MOST_HEIGHTS)
    grid = np.arange(z_m[0] - grid_m, z_m[-1] + 2.0 * grid_m, grid_m)
    counts = _count(z_m, grid, _PROBE_M)
    half = max(1, round(reach_m / grid_m))
    highest = sliding_window_view(np.pad(counts, half), 2 * half + 1).max(axis=1)
    peaks = np.flatnonzero((counts == highest) & (counts > 0))
    # Of equal neighbours the first.
    peaks = peaks[np.concatenate([[True], np.diff(peaks) > half])]
    enough = min(least, float(counts.max()))
    levels = [float(grid[peak]) for peak in peaks[counts[peaks] >= enough]]
    while len(levels) > 1:
        weaker = [min(pair, key=lambda z: _highest_count(z_m, z, _PROBE_M)) for pair in itertools.pairwise(levels)]
        shares = [
            _clearest_count(z_m, *pair, _PROBE_M) / _highest_count(z_m, weak, _PROBE_M)
            for pair, weak in zip(itertools.pairwise(levels), weaker, strict=True)
        ]
        worst = int(np.argmax(shares))
        if shares[worst] < _SEPARATE_SHARE:
            break
        levels.remove(weaker[worst])
    found = [_highest_count(z_m, level, _PROBE_M) for level in levels]
    return [level for level, n in zip(levels, found, strict=True) if n >= _WEAK_SHARE * float(np.median(found))]


def _count(z_m: Floats, at: Floats, reach_m: float) -> Ints:
    """Count the heights within a reach of each place."""
    counts: Ints = np.searchsorted(z_m, at + reach_m, side="right") - np.searchsorted(z_m, at - reach_m, side="left")
    return counts


def _highest_count(z_m: Floats, level_m: float, reach_m: float) -> int:
    """Count the heights within reach of a level, where most are: it may lie a little beside the grid's place."""
    return int(_count(z_m, level_m + _BESIDE_M, reach_m).max())


def _clearest_count(z_m: Floats, low_m: float, high_m: float, reach_m: float) -> int:
    """Return the smallest m that separates two levels: the least that no height of some gap of one reach exceeds."""
    places: Floats = np.linspace(low_m, high_m, max(5, math.ceil((high_m - low_m) / (0.25 * reach_m))))
    counts = _count(z_m, places, reach_m)
    return int(sliding_window_view(counts, 5).max(axis=1).min())


def _smallest_rise(levels_m: list[float], flights: FlightsParams) -> float | None:
    rises = [high - low for low, high in itertools.pairwise(levels_m)]
    return min((rise for rise in rises if flights.min_rise_m <= rise <= flights.max_rise_m), default=None)


def _find_thickness(z_m: Floats, levels_m: list[float], reach_m: float) -> float:
    """Return the median over the levels of the scatter of their heights, one sigma, metres."""
    spreads = []
    for level_m in levels_m:
        near = z_m[np.searchsorted(z_m, level_m - reach_m) : np.searchsorted(z_m, level_m + reach_m)]
        spreads.append(mad_sigma(near))
    return float(np.median(spreads))


def _on_knob(name: str, value: float) -> float:
    """Return a value on the steps of its knob, rounded up, and within its range."""
    knob = SETTINGS.knob(name)
    steps = math.ceil(round(value / knob.step, 6))
    return min(knob.high, max(knob.low, round(steps * knob.step, 9)))


def _why_theta(theta_deg: float, sigma_deg: float) -> str:
    seen = f"normals of level surfaces scatter by {sigma_deg:.1f}° (one sigma)"
    if theta_deg <= _THETA_DEG[0]:
        return f"{seen}, which {theta_deg:g}° covers; less would lose treads that are worn or fall."
    if theta_deg >= _THETA_DEG[1]:
        return f"{seen}; {theta_deg:g}° is the most that tells treads from ramps, more neighbours k would calm them."
    return f"{seen}; {theta_deg:g}° is {_THETA_SIGMAS:g} times that and keeps nearly all of their points."


def _why_eps(eps_m: float, thickness_m: float, gap_m: float | None) -> str:
    seen = f"heights within a level scatter by {thickness_m * 1000.0:.1f} mm (one sigma)"
    eps = f"{eps_m * 1000.0:g} mm"
    if gap_m is None:
        return f"{seen}: {eps} spans {_EPS_SIGMAS:g} times that; no two levels are a rise apart."
    gap = f"the smallest rise is {gap_m * 1000.0:.0f} mm"
    if eps_m < _EPS_SIGMAS * thickness_m:
        return f"{seen} and {gap}: {eps} is about a fifth of the rise, less than the noise asks for."
    return f"{seen} and {gap}: {eps} spans the one and stays far below the other."


def _why_m(min_points: int, weakest: int, clearest: int | None, eps_m: float, spacing_m: float) -> str:
    between = "" if clearest is None else f", between any two levels some height has at most {clearest:,}"
    return (
        f"the weakest level has {weakest:,} points within {eps_m * 1000.0:g} mm of its height{between}; points lie "
        f"{spacing_m * 1000.0:.1f} mm apart, so {min_points:,} of them cover {min_points * spacing_m**2:.3f} m²."
    )
