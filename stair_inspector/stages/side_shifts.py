"""Do two stations show the sides of the treads at different places? Then one does not lie where the file has it.

On a stair without walls no surface shows a shift along the treads; only their ends do. Where each station's points on a
tread end differs by it on the left and on the right alike. What hides a part of a tread from one station moves one end
of what it saw, or the other one of what the other station saw: then its rays ended on something before that part.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from stair_inspector.geometry.arrays import Bools, Floats, Ints
from stair_inspector.geometry.percentiles import MEDIAN_NOISE
from stair_inspector.geometry.plan import in_frame
from stair_inspector.geometry.sight import Sight
from stair_inspector.model import Note, StepShape
from stair_inspector.stages.examine import size_text

_FEWEST, _FEWEST_TREADS = 25, 2
"""Points of a station on a tread that tell where they end, and treads that both saw so."""
_BAND_SIGMAS, _LEAST_BAND_M = 3.0, 0.004
_INSET_M, _ASIDE_M = 0.02, 0.15
"""How far within front and back of a tread, and beside what was found of it, its points are looked for."""
_STRAYS = 2
"""Points at either end that may be strays."""
_LEAST_U_M = 0.005
"""What mixed pixels and worn edges leave of an end, however near the points lie."""
_LEAST_M = 0.008
"""What is less is left to the uncertainty of registration that the scanner's preset states."""
_SURE = 4.0
"""Standard uncertainties by which a shift is told from chance."""
_UNLIKE, _UNLIKE_SIGMAS = 0.35, 3.0
"""By so much of the shift, or so many standard uncertainties, the two sides may differ."""
_OBSTACLE_M, _OF_DEPTH = 0.015, (0.3, 0.4, 0.5, 0.6)
_MOST_SHADOWED = 0.3
"""What stands so far above a tread hides it; the places asked along its depth; the share of them in a shadow of which
alone its ends may differ."""
_REACH_M = 0.08
"""The ray that tells passes so near to the place."""
_NAME_CHARACTERS = 60


def with_side_shifts(
    shapes: Sequence[StepShape], sight: Sight, flight_id: int
) -> tuple[tuple[StepShape, ...], tuple[Note, ...]]:
    """Give the treads that two stations saw what a shift between these leaves uncertain of their widths.

    Parameters
    ----------
    shapes : sequence of StepShape
        Of one flight.
    sight : Sight
        What the stations saw, level frame.
    flight_id : int
        Its number, for what is said.

    Returns
    -------
    tuple of StepShape, tuple of Note
        Unchanged, and no note, where no two stations show a shift across the climb.
    """
    points, of_point = sight.points()
    order = np.argsort(points[:, 2])
    points, of_point = points[order], of_point[order]
    own = [_ends_on(shape, points, of_point, len(sight.names)) for shape in shapes]
    shifts_m = {pair: _shift_of(own, *pair) for pair in combinations(range(len(sight.names)), 2)}
    (one, other), (shift_m, u_m) = max(shifts_m.items(), key=lambda each: abs(each[1][0]), default=((0, 0), (0.0, 0.0)))
    if not shift_m or _is_of_shadows(shapes, own, (one, other), sight):
        return tuple(shapes), ()
    shift_m = abs(shift_m)
    aside_m = shift_m + 2.0 * u_m
    told = tuple(
        replace(shape, plane=replace(shape.plane, aside_m=max(aside_m, shape.plane.aside_m)))
        if min(tread.counts[one], tread.counts[other]) > _STRAYS
        else shape
        for shape, tread in zip(shapes, own, strict=True)
    )
    a, b = (sight.names[k][:_NAME_CHARACTERS] for k in (one, other))
    message = (
        f"flight {flight_id}: stations '{a}' and '{b}' show both sides of its treads {size_text(shift_m)} apart: one "
        "of them does not lie where the file has it, and U of the widths of the treads that both saw holds it; measure "
        "each by itself, with --station, or register them once more"
    )
    return told, (Note("stations_aside", "survey", message),)


@dataclass(frozen=True, slots=True, eq=False)
class _Ends:
    """Where the points of each station (k,) on a tread end, in its frame, and how many they are.

    ``low_m`` and ``high_m`` are NaN where they are too few; ``gap_m`` is how far apart they lie across the climb.
    """

    low_m: Floats
    high_m: Floats
    gap_m: Floats
    counts: Ints


def _ends_on(shape: StepShape, points: Floats, of_point: Ints, n_stations: int) -> _Ends:
    """Return the ends on a tread, of points (n, 3) in the order of their heights and whose each is (n,)."""
    s_low, s_high, w_low, w_high = shape.front.middle_m, *shape.extent[1:]
    band_m = max(_BAND_SIGMAS * shape.plane.sigma_m, _LEAST_BAND_M)
    at = [shape.plane.at(s, w) for s in (s_low, s_high) for w in (w_low - _ASIDE_M, w_high + _ASIDE_M)]
    first, stop = np.searchsorted(points[:, 2], [min(at) - band_m, max(at) + band_m])
    s, w = in_frame(points[first:stop, :2].T, shape.origin_m, shape.climb)
    above = points[first:stop, 2] - shape.plane.z0_m - shape.plane.slope[0] * s - shape.plane.slope[1] * w
    is_on = (np.abs(above) <= band_m) & (s >= s_low + _INSET_M) & (s <= s_high - _INSET_M)
    is_on &= (w >= w_low - _ASIDE_M) & (w <= w_high + _ASIDE_M)
    low, high, gap = np.full((3, n_stations), np.nan)
    counts = np.bincount(of_point[first:stop][is_on], minlength=n_stations)
    for k in np.flatnonzero(counts >= _FEWEST):
        ordered = np.sort(w[is_on & (of_point[first:stop] == k)])
        inner = ordered[_STRAYS], ordered[-1 - _STRAYS]
        gap[k] = (inner[1] - inner[0]) / (counts[k] - 1 - 2 * _STRAYS)
        # An even row goes on by half a gap beyond its last point.
        low[k], high[k] = inner[0] - (_STRAYS + 0.5) * gap[k], inner[1] + (_STRAYS + 0.5) * gap[k]
    return _Ends(low, high, gap, counts)


def _shift_of(own: Sequence[_Ends], one: int, other: int) -> tuple[float, float]:
    """Return how far to the left the second of two stations shows both sides of the treads, 0 where it does not; u."""
    both = [ends for ends in own if np.isfinite(ends.gap_m[[one, other]]).all()]
    if len(both) < _FEWEST_TREADS:
        return 0.0, 0.0
    weights = np.array([1.0 / (np.sum(ends.gap_m[[one, other]] ** 2) + _LEAST_U_M**2) for ends in both])
    on_right, on_left = (
        _median(np.array([side[other] - side[one] for side in sides]), weights)
        for sides in ([ends.low_m for ends in both], [ends.high_m for ends in both])
    )
    u_m = MEDIAN_NOISE / math.sqrt(2.0 * float(weights.sum()))
    shift_m = (on_right + on_left) / 2.0
    is_alike = abs(on_right - on_left) <= max(_UNLIKE * abs(shift_m), _UNLIKE_SIGMAS * 2.0 * u_m)
    is_shown = is_alike and min(abs(on_right), abs(on_left)) > 0.5 * abs(shift_m)
    return (shift_m, u_m) if is_shown and abs(shift_m) > max(_LEAST_M, _SURE * u_m) else (0.0, 0.0)


def _median(values: Floats, weights: Floats) -> float:
    """Return the weighted median."""
    order = np.argsort(values)
    sums = np.cumsum(weights[order])
    return float(values[order][np.searchsorted(sums, 0.5 * sums[-1])])


def _is_of_shadows(shapes: Sequence[StepShape], own: Sequence[_Ends], pair: tuple[int, int], sight: Sight) -> bool:
    """Return whether things hide from each of two stations what the other saw beyond the ends of what it saw."""
    hidden = []
    for k in pair:
        beyond: list[list[float]] = []
        within: list[list[float]] = []
        for shape, ends in zip(shapes, own, strict=True):
            for sides, sign in ((ends.low_m, -1.0), (ends.high_m, 1.0)):
                out_m = float(sign * (sides[pair[0]] + sides[pair[1]] - 2.0 * sides[k])) / 2.0
                if out_m > 0.0:
                    s_low, s_high = shape.front.middle_m, shape.extent[1]
                    along = [s_low + share * (s_high - s_low) for share in _OF_DEPTH]
                    for places, off_m in ((beyond, out_m), (within, -out_m)):
                        w = sides[k] + sign * off_m
                        places += [[*shape.to_plan(s, w), shape.plane.at(s, w)] for s in along]
        # Of a tread that the next one hides there is a shadow within as well.
        is_asked = ~_shadowed(k, np.array(within), sight) if within else np.zeros(0, dtype=np.bool_)
        is_hidden = _shadowed(k, np.array(beyond)[is_asked], sight) if is_asked.any() else np.zeros(1)
        hidden.append(float(np.mean(is_hidden)))
    return min(hidden) > _MOST_SHADOWED


def _shadowed(k: int, places: Floats, sight: Sight) -> Bools:
    """Return before which places (m, 3), level frame, a ray of a station ended on something that stands higher."""
    from scipy.spatial import KDTree  # slow to load

    to = places @ sight.turn - sight.places_m[k]
    distances_m = np.linalg.norm(to, axis=1)
    off, near = KDTree(sight.rays[k], balanced_tree=False, compact_nodes=False).query(to / distances_m[:, None])
    ranges_m = sight.ranges_m[k][near]
    ended = (sight.places_m[k] + ranges_m[:, None] * sight.rays[k][near]) @ sight.turn.T
    is_higher = ended[:, 2] > places[:, 2] + _OBSTACLE_M
    found: Bools = (off * distances_m < _REACH_M) & (ranges_m < distances_m) & is_higher
    return found
