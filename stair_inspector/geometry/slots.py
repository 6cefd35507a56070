"""Is a surface parted by slots from its front to its back? Ranges without points, seen along the surface."""

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stair_inspector.geometry.arrays import Floats
from stair_inspector.geometry.percentiles import mad_sigma, median, percentiles

_SLOT_M, _SLOT_SPACINGS = 0.03, 3.0
"""A slot is wider than both, the second in distances of neighbouring points."""
_BARS_SLOT, _BARS_SLOT_M = 1.3, 0.005
"""Of a surface of bars a slot is so many times as wide as their usual gap, and by so much more."""
_LEAST_GAP_M, _FEWEST_GAPS = 0.006, 3
_STRIP_M, _EMPTY = 0.0025, 0.05
"""Strips in which points are counted, and the share of the usual number that is none."""
_FEWEST_POINTS = 20
_SAME_PLACE_M, _ON_MOST = 0.01, 0.75
"""Gaps of several surfaces whose middles lie so near are at one place, and such a share of the surfaces shows it."""
_ODD_SIGMAS, _LEAST_ODD_M, _LEAST_SIGMA_M = 4.0, 0.005, 0.001
"""So much wider than the usual one a gap that all treads have at one place is no gap between bars."""


@dataclass(frozen=True, slots=True)
class Sides:
    """Between which places across a surface lies, the slots that part it, and the gaps that are no slots by themselves.

    ``spacing_m`` is the distance of neighbouring points.
    """

    low: float
    high: float
    slots: tuple[tuple[float, float], ...] = ()
    gaps: tuple[tuple[float, float], ...] = ()
    spacing_m: float = 0.0

    def reaches_over(self, low: float, high: float) -> bool:
        """Return whether the surface lies on both sides of a range, and in it without a slot."""
        is_over = self.low <= low and high <= self.high
        return is_over and not any(start < high and low < stop for start, stop in self.slots)


def find_slots(across: Floats, spacing_m: float, is_barred: bool = False) -> Sides:
    """Find the sides of a surface and the slots between them.

    Parameters
    ----------
    across : (n,)
        Places of the surface's points across the slots, metres; at least one.
    spacing_m : float
        Distance of neighbouring points.
    is_barred : bool
        Whether the surface is made of bars, whose gaps are no slots.
    """
    if len(across) < _FEWEST_POINTS:
        return Sides(float(across.min()), float(across.max()))
    low, high = percentiles(across, 0.5, 99.5)
    counts = np.bincount(((across[(across >= low) & (across <= high)] - low) / _STRIP_M).astype(np.int64))
    filled = np.flatnonzero(counts > _EMPTY * median(counts[counts > 0]))
    ends = low + _STRIP_M * np.stack([filled[:-1] + 1.0, filled[1:]])
    gaps_m = ends[1] - ends[0]
    least_m = _least_slot_m(spacing_m)
    is_gap = gaps_m > _LEAST_GAP_M
    if is_barred:
        between_m = gaps_m[is_gap]
        usual_m = median(between_m) if len(between_m) >= _FEWEST_GAPS else 0.0
        least_m = max(least_m, _BARS_SLOT * usual_m + _BARS_SLOT_M)
    slots, gaps = (
        tuple((float(start), float(stop)) for start, stop in ends[:, chosen].T)
        for chosen in (gaps_m >= least_m, is_gap & (gaps_m < least_m))
    )
    return Sides(low, high, slots, gaps, spacing_m)


def with_common_slots(sides: Sequence[Sides], known: Sequence[tuple[float, float]] = ()) -> list[Sides]:
    """Take as slots the gaps that most of some surfaces of bars have at one place and that are wider than the others.

    A single gap is known to a few millimetres, and one bar may lie aside; the middle of many is known better, and what
    is between two flights is so on all treads.

    Parameters
    ----------
    sides : sequence of Sides
        Of the surfaces of bars of one flight, all along the same direction.
    known : sequence of (low, high)
        Slots of whole surfaces of the same flight: a gap that all have at such a place is a slot however narrow.
    """
    every = sorted(
        ((start + stop) / 2.0, stop - start, k)
        for k, each in enumerate(sides)
        for start, stop in each.gaps + each.slots
    )
    if not every:
        return list(sides)
    middles, widths, owners = (np.array(column) for column in zip(*every, strict=True))
    place = np.concatenate([[0], np.cumsum(np.diff(middles) > _SAME_PLACE_M)])
    common = [
        (median(middles[place == k]), median(widths[place == k]))
        for k in range(int(place[-1]) + 1)
        if len(set(owners[place == k])) >= _ON_MOST * len(sides)
    ]
    if len(common) < _FEWEST_GAPS:
        return list(sides)
    usual_m = float(np.median([width for _, width in common]))
    sigma_m = mad_sigma(np.array([width for _, width in common]))
    least_m = usual_m + max(_LEAST_ODD_M, _ODD_SIGMAS * math.hypot(sigma_m, _LEAST_SIGMA_M))
    odd = [
        middle
        for middle, width in common
        if width >= least_m or any(abs(sum(slot) / 2.0 - middle) <= _SAME_PLACE_M for slot in known)
    ]
    return [
        dataclasses.replace(
            each,
            slots=tuple(
                gap
                for gap in sorted(each.slots + each.gaps)
                if gap in each.slots
                or (
                    gap[1] - gap[0] >= _least_slot_m(each.spacing_m)
                    and any(abs(sum(gap) / 2.0 - middle) <= _SAME_PLACE_M for middle in odd)
                )
            ),
        )
        for each in sides
    ]


def _least_slot_m(spacing_m: float) -> float:
    return max(_SLOT_M, _SLOT_SPACINGS * spacing_m)
