"""Is a narrow gap through all treads of a flight one between two flights? It then goes on through the risers.

On one tread points leave gaps by chance, and a joint between stones or planks parts treads alone. The points of all
treads together fill what chance left; what they leave open at one place, and the risers too, is open through all of it.
"""

import dataclasses
import itertools
from collections.abc import Sequence

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.arrays import Floats
from stair_inspector.geometry.percentiles import percentiles
from stair_inspector.geometry.plan import left_of
from stair_inspector.geometry.slots import Sides, find_slots
from stair_inspector.model import Chain, HeightOrder, Horizontal, Note, Surface

_LEAST_M, _SPACINGS = 0.007, 2.0
"""A gap is wider than both, the second in distances of neighbouring points of all treads seen as one."""
_CLEAR = 2.5
"""So many times as wide as any other gap: columns of a scan leave several, and planks too."""
_FEWEST_TREADS = 3
_SAME_PLACE_M = 0.01
_BESIDE_M, _FACE_M, _MARGIN, _CORE = 0.15, 0.04, 0.2, 0.6
"""How far beside a gap and about a nosing the points of risers count, without these shares of the rise at both ends;
and the share of a gap, about its middle, in which there are none."""
_FEWEST_ON_RISERS, _EMPTY = 20, 0.1
"""So many points on the risers as wide as the gap would be without it tell; up to this share of them it is open."""


@dataclasses.dataclass(frozen=True, slots=True)
class NarrowSlot:
    """Between which places across a narrow gap through all treads lies, and whether the risers leave it open too."""

    low: float
    high: float
    is_through: bool

    def of_step(self, sides: Sides, is_tread: bool) -> Sides:
        """Return the sides of a step with this slot; a landing has it where it shows a gap of its own there."""
        middle = (self.low + self.high) / 2.0
        own = [gap for gap in sides.gaps if is_tread or abs(sum(gap) / 2.0 - middle) <= _SAME_PLACE_M]
        known = any(start < self.high and self.low < stop for start, stop in sides.slots)
        if known or not own or not sides.low < self.low < self.high < sides.high:
            return sides
        return dataclasses.replace(sides, slots=tuple(sorted((*sides.slots, (self.low, self.high)))))


def find_narrow_slot(
    heights: HeightOrder, horizontal: Horizontal, surfaces: Sequence[Surface], chain: Chain, climb: Floats
) -> NarrowSlot | None:
    """Find the one narrow gap that runs through all treads of a straight flight wide enough for two.

    Parameters
    ----------
    heights, horizontal, surfaces, chain
        Of one scan.
    climb : (2,)
        Direction of the flight.

    Returns
    -------
    NarrowSlot or None
        None where there is none, or several: those are planks.
    """
    treads = [surfaces[number] for number in chain.steps[:-1]]
    if len(treads) < _FEWEST_TREADS or any(surface.is_barred for surface in treads):
        return None
    left = left_of(climb)
    across = [left @ horizontal.coordinates_m[:2].take(surface.rows, axis=1) for surface in treads]
    # No tread may go on where another ends.
    ends = [percentiles(places, 0.5, 99.5) for places in across]
    low, high = max(each[0] for each in ends), min(each[1] for each in ends)
    if high - low < 2.0 * priors.NARROWEST_FLIGHT_M:
        return None
    together = np.concatenate(across)
    spacing_m = float(np.median([surface.spacing_m for surface in treads])) / np.sqrt(len(treads))
    sides = find_slots(together[(together > low) & (together < high)], spacing_m)
    gaps = sorted((*sides.gaps, *sides.slots), key=lambda gap: gap[0] - gap[1])
    if not gaps:
        return None
    start, stop = gaps[0]
    others_m = max((gap[1] - gap[0] for gap in gaps[1:]), default=0.0)
    is_clear = stop - start >= max(_LEAST_M, _SPACINGS * spacing_m, _CLEAR * others_m)
    if not is_clear or min(start - low, high - stop) < priors.NARROWEST_FLIGHT_M:
        return None
    return NarrowSlot(start, stop, _is_open_on_risers(heights, surfaces, chain, climb, (start, stop)))


def _is_open_on_risers(
    heights: HeightOrder, surfaces: Sequence[Surface], chain: Chain, climb: Floats, gap: tuple[float, float]
) -> bool:
    """Return whether the faces between the treads show a gap at a place across; not where they were not seen."""
    wide_m = gap[1] - gap[0]
    if wide_m >= _BESIDE_M:
        # Nothing is looked at beside it.
        return False
    middle, core_m = sum(gap) / 2.0, _CORE * wide_m
    n_in = n_beside = 0
    for (lower, upper), place in zip(itertools.pairwise(chain.steps), chain.middles[1:], strict=True):
        low_m, high_m = surfaces[lower].height_m, surfaces[upper].height_m
        margin_m = _MARGIN * (high_m - low_m)
        points = heights.coordinates_m[:, heights.between(low_m + margin_m, high_m - margin_m)]
        ahead, off_m = climb @ points[:2] - float(place @ climb), np.abs(left_of(climb) @ points[:2] - middle)
        is_face = np.abs(ahead) <= _FACE_M
        n_in += int(np.count_nonzero(is_face & (off_m <= core_m / 2.0)))
        n_beside += int(np.count_nonzero(is_face & (off_m > wide_m) & (off_m <= _BESIDE_M)))
    expected = n_beside * core_m / (2.0 * (_BESIDE_M - wide_m))
    return expected >= _FEWEST_ON_RISERS and n_in <= _EMPTY * expected


def note_of_narrow_slot(slot: NarrowSlot, chain: Chain, surfaces: Sequence[Surface]) -> Note:
    """Say of a flight whose treads a narrow gap parts that it may be two."""
    message = (
        f"a gap of {1000.0 * (slot.high - slot.low):.0f} mm runs through all treads of the flight whose lowest step is "
        f"at {surfaces[chain.steps[0]].height_m:.3f} m, and was not seen in its risers: it may be a joint, or part two "
        "flights side by side, which the uncertainties of the widths hold"
    )
    return Note("flights_may_be_two", "flights", message)
