"""Does a strip lie on a surface, from its front to its back? A step up and a step down, seen along the surface."""

import functools
from dataclasses import dataclass

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.arrays import Floats, Ints, freeze
from stair_inspector.geometry.percentiles import median, percentiles

_COLUMN_M, _MOST_COLUMNS, _FEWEST_COLUMNS = 0.015, 80, 12
_FEWEST_IN_COLUMN = 5
_MISFIT, _SHARP, _BESIDE_STEP = 0.15, 0.75, 3
"""Scatter of the columns about the strip's outline, as a share of its thickness, and the share of it by which some
columns on either side of a step differ: what is rounded or worn has more of the one and less of the other."""


@dataclass(frozen=True, slots=True)
class Strip:
    """Between which places across a surface a strip lies, and how much higher, metres.

    ``bare_m`` is how much of the surface lies bare on either side of it, on the low and on the high one.
    """

    low: float
    high: float
    thick_m: float
    bare_m: tuple[float, float]


def find_strip(along: Floats, across: Floats, height: Floats) -> Strip | None:
    """Find the strip that lies on a surface.

    Parameters
    ----------
    along, across, height : (n,)
        Points of the surface: places along the strip and across it, and heights, metres.

    Returns
    -------
    Strip or None
        None where the surface is one plane, or uneven otherwise. Its sides are known to half a column of 15 mm.

    Notes
    -----
    The surface may lean both ways. How it does along the strip is told within each column across, where there is no
    step; the columns' heights are then those of a line with a step up and a step down, by least squares over all pairs
    of columns at which the two may be.
    """
    low, high = percentiles(across, 0.5, 99.5) if len(across) else (0.0, 0.0)
    n = min(_MOST_COLUMNS, int((high - low) / _COLUMN_M))
    if n < _FEWEST_COLUMNS:
        return None
    column = np.floor((across - low) / (high - low) * n).astype(np.int64)
    inside = (column >= 0) & (column < n)
    column, along, height = column[inside], along[inside], height[inside]
    counts = np.bincount(column, minlength=n)
    is_full = counts >= _FEWEST_IN_COLUMN
    if 2 * np.count_nonzero(is_full) < n:
        return None
    flat = _levelled(column, along, height, counts)
    places = low + (np.flatnonzero(is_full) + 0.5) * (high - low) / n
    ends = np.cumsum(counts)
    heights = np.array(
        [median(flat[end - n_own : end]) for end, n_own in zip(ends, counts, strict=True) if n_own >= _FEWEST_IN_COLUMN]
    )
    start, stop, thick_m, misfit_m = _best_step(places, heights)
    if not priors.RUNNER_THICKNESS_M[0] <= thick_m <= priors.RUNNER_THICKNESS_M[1] or misfit_m > _MISFIT * thick_m:
        return None
    if not all(_is_sharp(heights, at, thick_m) for at in (start, stop) if 0 < at < len(heights)):
        return None
    half_m = (high - low) / n / 2.0
    first, last = float(places[start]) - half_m, float(places[stop - 1]) + half_m
    return Strip(first, last, thick_m, (first - low, high - last))


def _levelled(column: Ints, along: Floats, height: Floats, counts: Ints) -> Floats:
    """Return heights without the slope along the strip, column after column."""
    order = np.argsort(column, kind="stable")
    column, along, height = column[order], along[order], height[order]
    n = np.maximum(counts, 1)
    off_along = along - (np.bincount(column, along, len(counts)) / n)[column]
    off_height = height - (np.bincount(column, height, len(counts)) / n)[column]
    spread = float(off_along @ off_along)
    slope = float(off_along @ off_height) / spread if spread > 0.0 else 0.0
    levelled: Floats = height - slope * (along - float(along.mean()))
    return levelled


def _best_step(places: Floats, heights: Floats) -> tuple[int, int, float, float]:
    """Return from and up to which column the strip lies, how thick it is, and the scatter about its outline."""
    n = len(places)
    starts, stops = _ranges(n)
    shift = places - places.mean()
    spread = float(shift @ shift)
    free = heights - heights.mean()
    free -= shift * (float(shift @ free) / spread)
    # Of each range the sums of heights, of places and of columns, as differences of sums from the first column on: what
    # is left of a step once a line is taken off it needs no more.
    on, at = (np.concatenate([[0.0], np.cumsum(each)]) for each in (free, shift))
    n_on = stops - starts
    sizes = n_on - n_on**2 / n - (at[stops] - at[starts]) ** 2 / spread
    thick = np.where(sizes > 1e-9, (on[stops] - on[starts]) / np.maximum(sizes, 1e-9), 0.0)
    gain = np.where(thick > 0.0, thick**2 * sizes, 0.0)
    best = int(np.argmax(gain))
    misfit_m = float(np.sqrt(max(0.0, float(free @ free) - float(gain[best])) / max(1, n - 5)))
    return int(starts[best]), int(stops[best]), float(thick[best]), misfit_m


@functools.lru_cache(maxsize=_MOST_COLUMNS)
def _ranges(n: int) -> tuple[Ints, Ints]:
    """Return from and up to which column all ranges of some of n columns go."""
    starts, stops = np.triu_indices(n + 1, 1)
    return freeze(starts), freeze(stops)


def _is_sharp(heights: Floats, at: int, thick_m: float) -> bool:
    """Return whether the surface steps by the strip's thickness before a column; the two next to the step are mixed."""
    before, after = heights[max(0, at - 1 - _BESIDE_STEP) : at - 1], heights[at + 1 : at + 1 + _BESIDE_STEP]
    if not len(before) or not len(after):
        return True
    return abs(median(after) - median(before)) >= _SHARP * thick_m
