"""Is a surface parted by slots from its front to its back? Ranges without points, seen along the surface."""

from dataclasses import dataclass

import numpy as np

from stair_inspector.geometry.arrays import Floats

_SLOT_M, _SLOT_SPACINGS = 0.03, 3.0
"""A slot is wider than both, the second in distances of neighbouring points."""
_BARS_SLOT, _BARS_SLOT_M = 1.3, 0.005
"""Of a surface of bars a slot is so many times as wide as their usual gap, and by so much more."""
_LEAST_GAP_M, _FEWEST_GAPS = 0.006, 3
_STRIP_M, _EMPTY = 0.0025, 0.05
"""Strips in which points are counted, and the share of the usual number that is none."""
_FEWEST_POINTS = 20


@dataclass(frozen=True, slots=True)
class Sides:
    """Between which places across a surface lies, and the slots that part it."""

    low: float
    high: float
    slots: tuple[tuple[float, float], ...] = ()

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
    low, high = (float(value) for value in np.percentile(across, [0.5, 99.5]))
    counts = np.bincount(((across[(across >= low) & (across <= high)] - low) / _STRIP_M).astype(np.int64))
    filled = np.flatnonzero(counts > _EMPTY * np.median(counts[counts > 0]))
    ends = low + _STRIP_M * np.stack([filled[:-1] + 1.0, filled[1:]])
    gaps_m = ends[1] - ends[0]
    least_m = max(_SLOT_M, _SLOT_SPACINGS * spacing_m)
    if is_barred:
        between_m = gaps_m[gaps_m > _LEAST_GAP_M]
        usual_m = float(np.median(between_m)) if len(between_m) >= _FEWEST_GAPS else 0.0
        least_m = max(least_m, _BARS_SLOT * usual_m + _BARS_SLOT_M)
    return Sides(low, high, tuple((float(start), float(stop)) for start, stop in ends[:, gaps_m >= least_m].T))
