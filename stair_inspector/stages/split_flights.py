"""Are two flights side by side one, of which a strip along the whole was not seen?

Where the scan holds nothing at all of a strip that runs from the floor to the landing, it says nothing of what is
there. A gap between two flights shows the floor before them, and their own sides.
"""

import dataclasses
import itertools
from collections.abc import Sequence
from typing import Literal

import numpy as np

from stair_inspector.geometry.arrays import Floats
from stair_inspector.geometry.plan import angle_deg, left_of
from stair_inspector.model import Chain, Chains, HeightOrder, Horizontal, Note, Patches, Surface
from stair_inspector.stages.bars import surface_of_rows
from stair_inspector.stages.climbs import straight_climb
from stair_inspector.stages.rejects import Forced

_SAME_CLIMB_DEG, _IN_LINE_M, _LEVEL_M, _SIGMAS = 3.0, 0.03, 0.006, 3.0
"""Steps of one flight lie at one height, to the scatter of both, and their nosings in one line."""
_FEWEST_STEPS = 3
_WIDEST_M, _SAME_SIDE_M = 0.5, 0.03
_RIM_M, _RIM, _BESIDE_M = 0.012, 0.25, 0.2
"""So near to its edges, and no more than this share of it, a strip may hold noise, and the sides of two flights show;
and how far beside it is looked."""
_BEFORE_M, _BEHIND_M, _BELOW_M, _ABOVE_M = 0.5, 0.3, 0.1, 0.3
"""How much of floor and landing is looked at, and how far below the lower step and above a step."""
_EMPTY, _FEWEST = 0.02, 60
"""Share of the points that the strips beside it hold, up to which one is empty, and how many those must hold."""
_COMMON = 0.3
"""The same of a floor that goes on beyond both flights."""
_SIDE_FROM_M, _SIDE_TO_M, _SIDES = 0.012, 0.08, 0.04
"""Beyond the first from a tread, and no farther below it than the second, sides and walls show; and their points, as a
share of those on the treads beside."""

_Near = tuple[Floats, Floats, Floats]


@dataclasses.dataclass(frozen=True, slots=True, eq=False)
class _Pair:
    """Two flights in line, the left one second: their climb (2,), and between which places across the gap lies."""

    right: Chain
    left: Chain
    climb: Floats
    low: float
    high: float

    @property
    def size_m(self) -> float:
        return self.high - self.low


def with_unseen_strips(
    heights: HeightOrder, horizontal: Horizontal, patches: Patches, chains: Chains, forced: Forced
) -> tuple[Patches, tuple[Note, ...]]:
    """Put two flights together of which a strip between them was not seen, from the floor to the landing.

    Parameters
    ----------
    heights, horizontal, patches, chains
        Of one scan.
    forced : Forced
        Surfaces about which the user has decided stay as they are.

    Returns
    -------
    patches : Patches
        The same object where nothing was put together or is in doubt. The steps of one hold the points of both. Where
        the floor goes on before the gap and yet no side of a flight shows in it, each stays a flight, and its treads
        may be wider by the other one.
    notes : tuple of Note
        What was taken for what.
    """
    surfaces, notes = list(patches.surfaces), []
    free = [chain for chain in chains.chains if not forced.kinds.keys() & set(chain.steps)]
    used: list[Chain] = []
    for a, b in itertools.combinations(free, 2):
        pair = None if any(chain in used for chain in (a, b)) else _pair_of(surfaces, a, b)
        if pair is None:
            continue
        what = _what_shows(_near(heights, surfaces, pair), surfaces, pair)
        if what == "two":
            continue
        if what == "one":
            _put_together(horizontal, surfaces, pair, patches.cell_m)
        else:
            _widen(surfaces, pair)
        used += [a, b]
        notes.append(_note(patches.surfaces, surfaces, pair))
    return (Patches(tuple(surfaces), patches.cell_m), tuple(notes)) if notes else (patches, ())


def _pair_of(surfaces: Sequence[Surface], a: Chain, b: Chain) -> _Pair | None:
    """Return two flights whose steps lie at the same heights and in line, side by side; None for others."""
    climbs = [straight_climb(chain) for chain in (a, b)]
    if climbs[0] is None or climbs[1] is None or set(a.steps) & set(b.steps):
        return None
    # A landing at the upper end may be of one of them, or of both.
    if abs(len(a.steps) - len(b.steps)) > 1 or min(len(a.steps), len(b.steps)) < _FEWEST_STEPS:
        return None
    if any(surfaces[number].is_barred for number in (*a.steps, *b.steps)):
        return None
    if angle_deg(climbs[0], climbs[1]) > _SAME_CLIMB_DEG:
        return None
    climb = climbs[0]
    left = left_of(climb)
    right, other = sorted((a, b), key=lambda chain: float(np.median(chain.middles @ left)))
    lows, highs = [], []
    for k, (first, second) in enumerate(zip(right.steps, other.steps, strict=False)):
        on_right, on_left = surfaces[first], surfaces[second]
        lows.append(float((left @ on_right.cells_m).max()))
        highs.append(float((left @ on_left.cells_m).min()))
        middle = 0.5 * (on_right.centre_m[:2] + on_left.centre_m[:2])
        off_m = abs(on_right.height_at(middle) - on_left.height_at(middle))
        # The edge on the floor may run around the lowest tread.
        off_line_m = abs(float((right.middles[k] - other.middles[k]) @ climb)) if k else 0.0
        if off_m > _LEVEL_M + _SIGMAS * (on_right.sigma_m + on_left.sigma_m) or off_line_m > _IN_LINE_M:
            return None
    # A landing may be wider.
    low, high = float(np.median(lows[:-1] or lows)), float(np.median(highs[:-1] or highs))
    is_straight = all(
        abs(place - middle) <= _SAME_SIDE_M
        for places, middle in ((lows[:-1], low), (highs[:-1], high))
        for place in places
    )
    return _Pair(right, other, climb, low, high) if is_straight and 0.0 < high - low <= _WIDEST_M else None


def _near(heights: HeightOrder, surfaces: Sequence[Surface], pair: _Pair) -> _Near:
    """Return the places along and across the climb and the heights of all points about a pair of flights."""
    steps = [surfaces[number] for number in pair.right.steps]
    low_m = steps[0].height_m - 1.5 * (steps[1].height_m - steps[0].height_m)
    rows = heights.between(low_m, steps[-1].height_m + _ABOVE_M)
    points = heights.coordinates_m[:, rows]
    ahead, across = pair.climb @ points[:2], left_of(pair.climb) @ points[:2]
    fronts = pair.right.middles @ pair.climb
    is_near = (ahead >= fronts[0] - _BEFORE_M) & (ahead <= fronts[-1] + _BEHIND_M)
    return ahead[is_near], across[is_near], points[2][is_near]


def _what_shows(near: _Near, surfaces: Sequence[Surface], pair: _Pair) -> Literal["one", "two", "either"]:
    """Return what a gap between two flights shows: that they are one, two, or nothing about it.

    They are one where nothing was seen in it, nor of the floor before it, which is seen beyond the outer sides. Of two
    flights with a floor each, the gap goes through that as well.
    """
    if _share_of_sides(near, surfaces, pair) > _SIDES:
        return "two"
    ahead, across, _ = near
    is_floor = ahead < float(pair.right.middles[0] @ pair.climb) - _RIM_M
    half_m = pair.size_m / 2.0
    inner_m = half_m - min(_RIM_M, _RIM * pair.size_m)
    off_m = np.abs(across - (pair.low + half_m))
    is_in, is_beside = off_m <= inner_m, np.abs(off_m - pair.size_m) <= inner_m
    n_in, n_beside = (
        [int(np.count_nonzero(band & part)) for part in (is_floor, ~is_floor)] for band in (is_in, is_beside)
    )
    if min(n_beside) < _FEWEST:
        return "two"
    is_empty = [inside <= _EMPTY * beside for inside, beside in zip(n_in, n_beside, strict=True)]
    if not is_empty[0]:
        return "either"
    left = left_of(pair.climb)
    ends = (
        float(np.median([(left @ surfaces[number].cells_m).min() for number in pair.right.steps])) - half_m,
        float(np.median([(left @ surfaces[number].cells_m).max() for number in pair.left.steps])) + half_m,
    )
    n_beyond = [np.count_nonzero(is_floor & (np.abs(across - end) <= inner_m)) for end in ends]
    is_common = min(n_beyond) >= _COMMON * n_beside[0]
    return "one" if is_empty[1] and is_common else "two"


def _share_of_sides(near: _Near, surfaces: Sequence[Surface], pair: _Pair) -> float:
    """Return how many points lie just below and above the treads in the gap, per point on the treads beside it."""
    ahead, across, z = near
    fronts = pair.right.middles @ pair.climb
    is_between = (across >= pair.low - _RIM_M) & (across <= pair.high + _RIM_M)
    is_beside = (across >= pair.low - _BESIDE_M) & (across <= pair.high + _BESIDE_M) & ~is_between
    n_sides = n_treads = 0
    for k, number in enumerate(pair.right.steps[:-1]):
        is_over = (ahead >= fronts[k] + _RIM_M) & (ahead <= fronts[k + 1] - _RIM_M)
        off_m = z - surfaces[number].height_m
        is_tread = np.abs(off_m) < _SIDE_FROM_M
        n_sides += int(np.count_nonzero(is_over & is_between & ~is_tread & (off_m >= -_SIDE_TO_M)))
        n_treads += int(np.count_nonzero(is_over & is_beside & is_tread))
    return n_sides / max(n_treads, 1)


def _put_together(horizontal: Horizontal, surfaces: list[Surface], pair: _Pair, cell_m: float) -> None:
    pairs = list(zip(pair.right.steps, pair.left.steps, strict=False))
    if pair.right.base is not None and pair.left.base is not None and pair.right.base != pair.left.base:
        pairs.append((pair.right.base, pair.left.base))
    for first, second in pairs:
        rows = np.union1d(surfaces[first].rows, surfaces[second].rows)
        surfaces[first] = surface_of_rows(horizontal, rows, surfaces[first].level_id, cell_m)
        surfaces[second] = dataclasses.replace(surfaces[second], part_of=first)


def _widen(surfaces: list[Surface], pair: _Pair) -> None:
    left = left_of(pair.climb)
    for own, other in ((pair.right, pair.left), (pair.left, pair.right)):
        for number, beside in zip(own.steps, other.steps, strict=False):
            more_m = pair.size_m + _SAME_SIDE_M + float(np.ptp(left @ surfaces[beside].cells_m))
            surfaces[number] = dataclasses.replace(surfaces[number], aside_m=max(more_m, surfaces[number].aside_m))


def _note(before: Sequence[Surface], after: Sequence[Surface], pair: _Pair) -> Note:
    is_one = after[pair.left.steps[0]].part_of is not None
    left = left_of(pair.climb)
    widths = [float(np.ptp(left @ before[chain.steps[0]].cells_m)) for chain in (pair.right, pair.left)]
    lowest_m = before[pair.right.steps[0]].height_m
    where = f"a strip {pair.size_m:.2f} m wide along the whole flight whose lowest step is at {lowest_m:.2f} m"
    parts = f"{widths[0]:.2f} and {widths[1]:.2f} m wide"
    if is_one:
        message = (
            f"nothing was seen of {where}, nor of the floor before it; the steps on both sides lie at the same heights "
            f"and in line, and are taken for one flight: if they are two, they are {parts}"
        )
        return Note("strip_unseen", "flights", message)
    message = (
        f"two flights side by side, {parts}, lie at the same heights and in line, and no side of either shows in "
        f"{where}: it may be one flight of which that was not seen, which the uncertainties of the widths hold"
    )
    return Note("flights_may_be_one", "flights", message)
