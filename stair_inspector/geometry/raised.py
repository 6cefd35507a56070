"""Does a part of a flat surface lie higher than the rest? Two parallel planes, each in places of its own."""

from dataclasses import dataclass

import numpy as np

from stair_inspector.geometry.arrays import Bools, Floats, Ints, freeze
from stair_inspector.geometry.percentiles import mad_sigma

_CELL_M, _LAG, _FEWEST_CELLS = 0.02, 3, 60
"""Cells in which heights are averaged; slopes are those between cells so many apart, most of which are at one level."""
_FEWEST_IN_CELL = 0.3
_LEAST_SHARE = 0.08
_LEAST_M, _SIGMAS, _SIGMAS_OF_SMALL, _FEWEST_OF_SMALL = 0.0022, 4.5, 8.0, 10
"""The levels lie farther apart than all, in the scatter of the cells about both, and about the smaller one alone, which
a hollow bends; and how many cells of that tell."""
_SHARP, _LEVEL, _BESIDE, _FEWEST_AT_STEP, _TOGETHER = 0.75, 0.2, 5, 4, 0.75
"""Share of their distance by which the surface steps where one meets the other, and the share by which it goes on
rising beside; what is worn has less of the one and more of the other. How many cells are looked at beside a step, and
how many such places tell; and the share of the smaller part's cells that hang together."""
_LONGEST = 0.85
"""A strip along so much of the second axis is how the surface was made or worn there."""
_ROUNDS = 8
_HOPELESS = 0.25
"""Parts that lie no farther apart than this share of the least step, at any slope on the way, are one level."""


@dataclass(frozen=True, slots=True, eq=False)
class Raised:
    """Which cells lie high, how much higher, metres, and the share of all cells that they are.

    ``is_high`` and ``is_mixed`` (n_x, n_y) tell of the cells of a grid from ``corner`` (2,) on; those next to a step
    are mixed, whichever level they seem to be at.
    """

    corner: Floats
    is_high: Bools
    is_mixed: Bools
    high_m: float
    share: float

    def of(self, plan: Floats) -> tuple[Bools, Bools]:
        """Return which places (2, n) lie in high cells, and which in mixed ones."""
        x, y = _columns(plan, self.corner)
        inside = (x >= 0) & (y >= 0) & (x < self.is_high.shape[0]) & (y < self.is_high.shape[1])
        x, y = np.where(inside, x, 0), np.where(inside, y, 0)
        return inside & self.is_high[x, y], inside & self.is_mixed[x, y]


def find_raised(plan: Floats, z: Floats) -> Raised | None:
    """Find the part of a surface that lies higher than the rest of it.

    Parameters
    ----------
    plan : (2, n)
        Places of the surface's points, metres, along the sides of what is about a rectangle, its longer one second.
    z : (n,)
        Heights.

    Returns
    -------
    Raised or None
        None where it is one plane, or uneven otherwise.

    Notes
    -----
    The slope of the surface is the median of what cells some apart differ by, since most pairs lie on one level; a step
    up or down moves it little. Heights without that slope are parted in two by Otsu's threshold, and the slope is
    fitted again with a level of its own for either part, until nothing changes, or until they are one level.
    """
    corner = plan.min(axis=1)
    x, y = _columns(plan, corner)
    shape = int(x.max()) + 1, int(y.max()) + 1
    keys = x * shape[1] + y
    counts = np.bincount(keys, minlength=shape[0] * shape[1])
    is_full = (counts >= max(2.0, _FEWEST_IN_CELL * float(np.median(counts[counts > 0])))).reshape(shape)
    if np.count_nonzero(is_full) < _FEWEST_CELLS or min(shape) <= 2 * _LAG:
        return None
    grid = np.where(
        is_full, np.bincount(keys, z, len(counts)).reshape(shape) / np.maximum(counts, 1).reshape(shape), np.nan
    )
    levelled = _means_around(grid - _plane(np.array([0.0, *_slopes(grid)]), shape))
    full = np.flatnonzero(is_full.ravel())
    rows, columns = np.divmod(full, shape[1])
    is_high: Bools = np.zeros(len(full), dtype=np.bool_)
    high_m, found, high, rim = 0.0, np.zeros(4), is_full, is_full
    for _ in range(_ROUNDS):
        before = is_high
        is_high = levelled.ravel()[full] > _otsu(levelled.ravel()[full])
        if not _LEAST_SHARE <= is_high.mean() <= 1.0 - _LEAST_SHARE:
            return None
        high = np.zeros(shape, dtype=np.bool_)
        high.ravel()[full] = is_high
        rim = _rim(high, is_full)
        clear = ~rim.ravel()[full]
        if np.count_nonzero(clear) < _FEWEST_CELLS // 2:
            return None
        design = np.stack([np.ones(len(full)), rows, columns, is_high.astype(np.float64)], axis=1)
        found = np.linalg.lstsq(design[clear], grid.ravel()[full][clear], rcond=None)[0]
        high_m = float(found[3])
        if high_m < _HOPELESS * _LEAST_M:
            # Halves of one level: no other slope makes them so much of a step.
            return None
        levelled = _means_around(grid - _plane(found[:3], shape))
        if np.array_equal(before, is_high):
            break
    result = Raised(freeze(corner), freeze(high), freeze(rim), high_m, float(is_high.mean()))
    # Cells beside the step are of both levels.
    left_over = levelled - np.where(high, high_m, 0.0)
    small = high if result.share <= 0.5 else is_full & ~high
    clear_of_both, clear_of_small = left_over[is_full & ~rim], left_over[small & ~rim]
    if len(clear_of_small) < _FEWEST_OF_SMALL or float(small.any(axis=0).mean()) > _LONGEST:
        return None
    if high_m < max(_LEAST_M, _SIGMAS * mad_sigma(clear_of_both), _SIGMAS_OF_SMALL * mad_sigma(clear_of_small)):
        return None
    levelled = grid - _plane(found[:3], shape)
    return result if _is_sharp(levelled, high, high_m) and _hangs_together(high, is_full) else None


def _columns(plan: Floats, corner: Floats) -> tuple[Ints, Ints]:
    x, y = np.floor((plan - corner[:, None]) / _CELL_M).astype(np.int64)
    return x, y


def _plane(numbers: Floats, shape: tuple[int, int]) -> Floats:
    plane: Floats = numbers[0] + numbers[1] * np.arange(shape[0])[:, None] + numbers[2] * np.arange(shape[1])[None, :]
    return plane


def _slopes(grid: Floats) -> tuple[float, float]:
    """Return by how much cells rise from one to the next along both axes."""
    along = [(grid[_LAG:] - grid[:-_LAG]).ravel(), (grid[:, _LAG:] - grid[:, :-_LAG]).ravel()]
    known = [each[np.isfinite(each)] for each in along]
    slopes = [float(np.median(each)) / _LAG if len(each) else 0.0 for each in known]
    return slopes[0], slopes[1]


def _means_around(grid: Floats) -> Floats:
    """Return the means over three by three cells, of those that are known."""
    is_known = np.isfinite(grid)
    sums, counts = _sums_around(np.where(is_known, grid, 0.0)), _sums_around(is_known.astype(np.float64))
    means: Floats = np.where(is_known, sums / np.maximum(counts, 1.0), np.nan)
    return means


def _sums_around(grid: Floats) -> Floats:
    """Return the sums over three by three cells."""
    n_rows, n_columns = grid.shape
    padded = np.zeros((n_rows + 2, n_columns + 2))
    padded[1:-1, 1:-1] = grid
    sums = np.zeros(grid.shape)
    for i in range(3):
        for j in range(3):
            sums += padded[i : i + n_rows, j : j + n_columns]
    return sums


def _otsu(values: Floats) -> float:
    """Return the threshold that parts values in two with least scatter within either."""
    ordered = np.sort(values)
    n = len(ordered)
    count = np.arange(1, n)
    sums = np.cumsum(ordered)
    low, high = sums[:-1] / count, (sums[-1] - sums[:-1]) / (n - count)
    k = int(np.argmax(count * (n - count) * (high - low) ** 2))
    return 0.5 * float(low[k] + high[k])


def _rim(high: Bools, is_full: Bools) -> Bools:
    """Return the cells next to which, or in which, one level ends and the other begins."""
    near_high, near_low = (_grown(part) for part in (high, is_full & ~high))
    rim: Bools = near_high & near_low
    return rim


def _grown(part: Bools) -> Bools:
    wide = part.copy()
    wide[1:] |= part[:-1]
    wide[:-1] |= part[1:]
    grown = wide.copy()
    grown[:, 1:] |= wide[:, :-1]
    grown[:, :-1] |= wide[:, 1:]
    return grown


def _is_sharp(levelled: Floats, high: Bools, high_m: float) -> bool:
    """Return whether the surface steps where one level meets the other, and goes on level on both sides.

    Along either axis: a hollow may be deep along one, but not along both.
    """
    n_seen = 0
    for values, part in ((levelled, high), (levelled.T, high.T)):
        padded = np.pad(values, ((_BESIDE, _BESIDE), (0, 0)), constant_values=np.nan)
        flips = part[1:] != part[:-1]
        # A step goes on beside; where a level ends along the other axis, single cells may seem to be either.
        near = np.pad(flips, 1)
        near = near[:-2] | near[1:-1] | near[2:]
        i, j = np.nonzero(flips & near[:, :-2] & near[:, 2:])
        sign = np.where(part[i + 1, j], 1.0, -1.0)
        # Cell i is the last before a step; it and the next may be mixed.
        before, after = padded[i + _BESIDE - 1, j], padded[i + _BESIDE + 2, j]
        step_m = sign * (after - before)
        beside_m = sign * np.concatenate(
            [padded[i + _BESIDE + 5, j] - after, before - padded[i + _BESIDE - 4, j]]
        ).reshape(2, -1)
        if np.count_nonzero(np.isfinite(step_m)) < _FEWEST_AT_STEP:
            continue
        n_seen += 1
        if _median_of_known(step_m) < _SHARP * high_m or _median_of_known(beside_m) > _LEVEL * high_m:
            return False
    return n_seen > 0


def _median_of_known(values: Floats) -> float:
    known = values[np.isfinite(values)]
    return float(np.median(known)) if len(known) else 0.0


def _hangs_together(high: Bools, is_full: Bools) -> bool:
    """Return whether most cells of the smaller level are one piece; of a low one beside a high one, two."""
    is_high_smaller = 2 * np.count_nonzero(high) <= np.count_nonzero(is_full)
    part = high if is_high_smaller else is_full & ~high
    left, sizes = part.copy(), []
    while left.any():
        piece = np.zeros_like(part)
        piece[tuple(np.argwhere(left)[0])] = True
        n_before = 0
        while (n := int(np.count_nonzero(piece))) > n_before:
            n_before, piece = n, _grown(piece) & left
        sizes.append(n)
        left &= ~piece
    largest = sorted(sizes)[-1:] if is_high_smaller else sorted(sizes)[-2:]
    return sum(largest) >= _TOGETHER * int(np.count_nonzero(part))
