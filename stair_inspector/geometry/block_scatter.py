"""How do heights scatter within small blocks of a surface? More in some than in others, where two layers overlap."""

from dataclasses import dataclass

import numpy as np

from stair_inspector.geometry.arrays import Floats, Ints
from stair_inspector.geometry.percentiles import percentiles

_SIDE_M = 0.04
_FEWEST_IN_BLOCK, _FEWEST_BLOCKS, _ENOUGH = 8, 25, 8_000
_LOW, _HIGH, _TOP = 10.0, 90.0, 67.0
"""Percentiles of the blocks' variances: the least and the most that is usual, and beyond which a block is one of those
with most."""


@dataclass(frozen=True, slots=True)
class BlockScatter:
    """Standard deviation of heights within blocks, metres: ``low_m`` where it is small, ``high_m`` where it is large.

    ``excess`` is the excess kurtosis within the blocks where it is large: 0 of normal noise, more where noises of
    different size mix, -2 of two layers with as many points each.
    """

    low_m: float
    high_m: float
    excess: float

    @property
    def ratio(self) -> float:
        """Return how many times as much heights scatter where they do most."""
        return self.high_m / self.low_m

    @property
    def apart_m(self) -> float:
        """Return how far two layers lie apart that make the difference, if both have as many points."""
        return 2.0 * float(np.sqrt(self.high_m**2 - self.low_m**2))

    @property
    def share_of_two(self) -> float:
        """Return the excess kurtosis as a share of what two layers so far apart have."""
        return -self.excess / (2.0 * (1.0 - 1.0 / self.ratio**2) ** 2) if self.high_m > self.low_m else 0.0


def find_scatter(s: Floats, w: Floats, z: Floats) -> BlockScatter | None:
    """Return how heights scatter in blocks of 40 mm, each about a plane of its own; None where points are too few.

    Parameters
    ----------
    s, w, z : (n,)
        Places and heights over about a plane, metres.

    Notes
    -----
    Fourth cumulants are those of Fisher's k-statistics, added up over the blocks.
    """
    stride = -(-len(s) // _ENOUGH) or 1
    s, w, z = s[::stride], w[::stride], z[::stride]
    if len(s) < _FEWEST_BLOCKS * _FEWEST_IN_BLOCK:
        return None
    keys = _keys(s, w)
    counts = np.bincount(keys)
    full = np.flatnonzero(counts >= _FEWEST_IN_BLOCK)
    if len(full) < _FEWEST_BLOCKS:
        return None
    numbers = np.full(len(counts), -1)
    numbers[full] = np.arange(len(full))
    block = numbers[keys]
    kept = block >= 0
    block = block[kept]
    n = counts[full].astype(np.float64)
    s, w, z = (_centred(values[kept], block, n) for values in (s, w, z))
    # What steps or leans within a block is an edge or a wear, not two layers.
    for places in (s, w):
        z = z - (np.bincount(block, places * z) / np.maximum(np.bincount(block, places**2), 1e-12))[block] * places
    second, fourth = np.bincount(block, z**2), np.bincount(block, z**4)
    variances = second / (n - 3.0)
    low, high, top = percentiles(variances, _LOW, _HIGH, _TOP)
    if low <= 0.0:
        return None
    k4 = n * ((n + 1.0) * fourth - 3.0 * (n - 1.0) * second**2 / n) / ((n - 1.0) * (n - 2.0) * (n - 3.0))
    # The square of an estimated variance is larger than that of the variance itself.
    squares = (second / (n - 1.0)) ** 2 * (n - 1.0) / (n + 1.0)
    is_top = variances >= top
    excess = float(k4[is_top].sum() / squares[is_top].sum())
    return BlockScatter(float(np.sqrt(low)), float(np.sqrt(high)), excess)


def _keys(s: Floats, w: Floats) -> Ints:
    column, row = (np.floor((values - values.min()) / _SIDE_M).astype(np.int64) for values in (s, w))
    keys: Ints = column * (int(row.max()) + 1) + row
    return keys


def _centred(values: Floats, block: Ints, n: Floats) -> Floats:
    """Return values less the mean of their block."""
    centred: Floats = values - (np.bincount(block, values) / n)[block]
    return centred
