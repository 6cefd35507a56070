"""After which shift do two families of faces come again in a profile, and where do most of them lie?

A profile is a picture of a scan from the side, axis 0 ahead and axis 1 up, in bins of 20 mm: how full each of its cells
is with points of level faces, or of upright ones.
"""

import math
from dataclasses import dataclass

import numpy as np

from stair_inspector.geometry.arrays import Bools, Floats, Ints

BIN_M = 0.02
_FULL_CELL = 6.0
"""So many points of a thinned scan in one cell of the profile fill it: a wall is no more than a narrow riser."""
_PEAKS = 5
_MOST_TIMES = 32
_PLACES = 200
_LEVEL_REACH = 1
"""A face may lie so many bins off the rhythm to each side."""
_SEEN_SHARE = 0.4
"""Share of a tread's or riser's length in the profile that must be filled."""
_RUNS_ON_SHARE = 0.7
"""A face whose neighbouring cell is filled as much as this runs on: a floor, a landing, a wall."""
_BETWEEN_SHARE = 0.5
"""Halfway between two faces there is air: less than this share of what fills them."""
_LEAST_LONGER_M = 0.15
"""The longer of the two periods: on treads that are shorter nobody climbs, in either reading."""


@dataclass(frozen=True, slots=True, eq=False)
class Rhythm:
    """A rhythm on a profile, bins: ``rise`` is negative where it falls ahead, ``corner`` (2,) is a nosing.

    Numbers and ``joints`` are those of a :class:`Lattice`.
    """

    going: float
    rise: float
    corner: Floats
    treads: tuple[int, ...]
    risers: tuple[int, ...]
    levels: tuple[int, ...]
    walls: tuple[int, ...]
    joints: int

    @property
    def score(self) -> int:
        """How much speaks for the rhythm: faces and the edges between them."""
        return len(self.treads) + len(self.risers) + self.joints


def fill_profile(cells: Ints, size: Ints) -> Floats:
    """Return how full each cell of the profile is, 0 to 1; axis 0 ahead, axis 1 up."""
    counts = np.bincount(cells[0] * size[1] + cells[1], minlength=int(size[0] * size[1]))
    filled: Floats = np.minimum(counts.reshape(size) / _FULL_CELL, 1.0)
    return filled


def _spread(profile: Floats, axis: int) -> Floats:
    """Return a profile smeared by a bin to both sides along an axis, so that noise does not hide its rhythm."""
    smeared = profile.copy()
    for shift in (1, -1):
        smeared += 0.6 * np.roll(profile, shift, axis)
    return smeared


def find_periods(level: Floats, upright: Floats, rise_m: tuple[float, float]) -> list[tuple[float, float]]:
    """Return the shifts (ahead, up), bins, after which both families of faces come again; up may be negative."""
    longest = round(rise_m[1] / BIN_M)
    # Room for the longest shift to both sides, however small the scan is.
    shape = tuple(2 ** math.ceil(math.log2(length + max(length, 2 * longest + 2))) for length in level.shape)
    product = np.ones(shape)
    for profile, axis in ((level, 1), (upright, 0)):
        spectrum = np.fft.rfft2(_spread(profile, axis), shape)
        again = np.fft.irfft2(spectrum * spectrum.conj(), shape)
        product *= np.maximum(again, 0.0)
    same = np.sqrt(product)
    shortest = math.ceil(rise_m[0] / BIN_M)
    ahead = np.arange(shortest, longest + 1)
    upwards = np.concatenate([np.arange(-longest, -shortest + 1), ahead])
    window = same[np.ix_(ahead, upwards % shape[1])]
    is_short = np.maximum(ahead[:, None], np.abs(upwards)) < _LEAST_LONGER_M / BIN_M
    window = np.where(is_short, 0.0, window)
    found: list[tuple[float, float]] = []
    for _ in range(_PEAKS):
        i, j = np.unravel_index(int(np.argmax(window)), window.shape)
        if window[i, j] <= 0.0:
            break
        found.append(_refined(same, int(ahead[i]), int(upwards[j]), level.shape))
        window[max(0, i - 2) : i + 3, max(0, j - 2) : j + 3] = 0.0
    return found


def _refined(same: Floats, ahead: int, upwards: int, size: tuple[int, ...]) -> tuple[float, float]:
    """Return a period to a part of a bin, from where its multiples are."""
    times, best = 1, np.array([ahead, upwards], dtype=np.float64)
    first = same[ahead, upwards]
    while times <= _MOST_TIMES:
        middle = np.rint(best * times).astype(int)
        if middle[0] + 3 >= size[0] or abs(middle[1]) + 3 >= size[1]:
            break
        around = same[
            np.ix_(np.arange(middle[0] - 2, middle[0] + 3), np.arange(middle[1] - 2, middle[1] + 3) % same.shape[1])
        ]
        if around.max() < 0.1 * first:
            break
        weights = np.maximum(around - 0.5 * around.max(), 0.0)
        shift = np.array([weights.sum(axis=1) @ np.arange(-2, 3), weights.sum(axis=0) @ np.arange(-2, 3)]) / max(
            weights.sum(), 1e-12
        )
        finer = (middle + shift) / times
        if np.abs(finer - best).max() > 1.0 / times:
            break
        best = finer
        times *= 2
    return float(best[0]), float(best[1])


def place_rhythm(level: Floats, upright: Floats, period: tuple[float, float]) -> Rhythm | None:
    """Place a rhythm on a profile where most of its faces are seen; None where none of them ends there."""
    going, rise = period
    size = level.shape
    sign = math.copysign(1.0, rise)
    high = abs(rise)
    if sign < 0.0:
        level, upright = level[::-1], upright[::-1]
    sums = [_summed(level > 0.3), _summed(upright > 0.3)]
    k = np.arange(math.ceil(size[1] / high) + 1)
    reach, thick = _LEVEL_REACH, 2 * _LEVEL_REACH + 1
    # What is filled is quickly counted; only where that is most is it asked which faces end there.
    a0, b0 = _fullest_places(sums, period, size)

    def treads(shift: float, lift: float) -> Floats:
        place = b0[:, None] + (k + shift) * going, a0[:, None] + (k + lift) * high - reach
        return _filled(sums[0], *place, going, thick) / going

    def risers(shift: float, lift: float) -> Floats:
        place = b0[:, None] + (k + shift) * going - reach, a0[:, None] + (k - 1.0 + lift) * high
        return _filled(sums[1], *place, thick, high) / high

    b, a = b0[:, None] + k * going, a0[:, None] + k * high
    tread, riser = treads(0, 0), risers(0, 0)
    is_level, is_upright = tread >= _SEEN_SHARE, riser >= _SEEN_SHARE
    ends_level = is_level & (treads(-1, 0) < _RUNS_ON_SHARE) & (treads(1, 0) < _RUNS_ON_SHARE)
    ends_upright = is_upright & (risers(0, -1) < _RUNS_ON_SHARE) & (risers(0, 1) < _RUNS_ON_SHARE)
    for half in (-0.5, 0.5):
        ends_level &= treads(0, half) < _BETWEEN_SHARE * tread
        ends_upright &= risers(half, 0) < _BETWEEN_SHARE * riser
    joints = np.count_nonzero(is_level & is_upright & (ends_level | ends_upright), axis=1) + np.count_nonzero(
        is_level[:, :-1] & is_upright[:, 1:] & (ends_level[:, :-1] | ends_upright[:, 1:]), axis=1
    )
    faces = np.count_nonzero(ends_level, axis=1) + np.count_nonzero(ends_upright, axis=1)
    fullness = np.minimum(tread, 1.0).sum(axis=1) + np.minimum(riser, 1.0).sum(axis=1)
    best = int(np.argmax(faces + joints + 0.2 * fullness))
    # The lowest face that was seen has the number 0.
    numbered = np.flatnonzero(ends_level[best] | ends_upright[best])
    if not len(numbered):
        return None
    lowest = int(numbered[0])

    def numbers(mask: Bools) -> tuple[int, ...]:
        return tuple(int(row) - lowest for row in np.flatnonzero(mask[best]))

    corner = np.array([b[best, lowest], a[best, lowest]], dtype=np.float64)
    if sign < 0.0:
        corner[0] = size[0] - 1 - corner[0]
    return Rhythm(
        going=going,
        rise=rise,
        corner=corner,
        treads=numbers(ends_level),
        risers=numbers(ends_upright),
        levels=numbers(is_level & ~ends_level),
        walls=numbers(is_upright & ~ends_upright),
        joints=int(joints[best]),
    )


def _fullest_places(sums: list[Floats], period: tuple[float, float], size: tuple[int, ...]) -> tuple[Floats, Floats]:
    """Return where a rhythm meets most filled faces: offsets up and ahead (places,), bins, the fullest first."""
    going, high = period[0], abs(period[1])
    n_rows = math.ceil(size[1] / high) + 1
    upwards = np.arange(round(high), dtype=np.float64)
    ahead = np.arange(-round((n_rows - 1) * going), size[0], dtype=np.float64)
    seen = np.zeros((len(upwards), len(ahead)), dtype=np.int64)
    for k in range(n_rows):
        # Other starts lie beyond the profile in this row.
        first, last = np.searchsorted(ahead, (-(k + 1.0) * going - 2.0, size[0] - k * going + 2.0))
        b, a = ahead[first:last] + k * going, upwards + k * high
        tread = _filled(sums[0], b, (a - _LEVEL_REACH)[:, None], going, 2 * _LEVEL_REACH + 1) / going
        riser = _filled(sums[1], b - _LEVEL_REACH, (a - high)[:, None], 2 * _LEVEL_REACH + 1, high) / high
        seen[:, first:last] += (tread >= _SEEN_SHARE).astype(np.int64) + (riser >= _SEEN_SHARE)
    kept = np.argsort(-seen.ravel(), kind="stable")[:_PLACES]
    return upwards[kept // len(ahead)], ahead[kept % len(ahead)]


def _summed(mask: Bools) -> Floats:
    """Return the sums over all cells below and to the left of each corner, (rows + 1, columns + 1)."""
    sums = np.zeros((mask.shape[0] + 1, mask.shape[1] + 1))
    sums[1:, 1:] = mask.cumsum(axis=0).cumsum(axis=1)
    return sums


def _filled(sums: Floats, ahead: Floats, upwards: Floats, length: float, height: float) -> Floats:
    """Return how many cells are filled in boxes that begin at (ahead, upwards), bins."""
    edges = []
    for start, extent, limit in ((ahead, length, sums.shape[0] - 1), (upwards, height, sums.shape[1] - 1)):
        first = np.rint(start).astype(np.int64)
        last = np.rint(start + extent).astype(np.int64)
        edges.append((np.clip(first, 0, limit), np.clip(last, 0, limit)))
    (i0, i1), (j0, j1) = edges
    filled: Floats = sums[i1, j1] - sums[i0, j1] - sums[i1, j0] + sums[i0, j0]
    return filled
