"""What lies between runs of links? Treads that a shadow hides in part, and treads that are missing."""

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.arrays import Floats
from stair_inspector.model import Surface
from stair_inspector.stages.links import Link, angle_deg, depth_along, height_at

STRAIGHT_DEG = 15.0
_MAX_MISSING = 3
_RISE_TOLERANCE, _GOING_TOLERANCE = 0.22, 0.44
"""How far a gap may be from a whole number of rises and of goings, as a share of one."""
_FEWEST_LINKS = 2
"""Links that two runs need between them, so that there is a going to compare the gap with."""
_NEAREST_LINKS = 6
"""Rise, going and direction at the end of a run are those of so many links there."""
_MIDDLE = 0.4
_LEAST_BESIDE = 0.5
"""Share of the narrower of two edges along which they must lie before each other."""
_PRESENT_SHARE = 0.4
_SHORT_OF, _BEYOND = 0.35, 0.5
"""How much less and more than the goings of the missing treads a floor may end in front of the first one seen."""
_FLOOR_M, _FRONT_M = 0.6, 0.3
_TALL = 1.5


@dataclass(frozen=True, slots=True, eq=False)
class _Pace:
    """How a run goes on at one of its ends: direction (2,), rise, going, and its range to the left of it."""

    climb: Floats
    rise_m: float
    going_m: float
    low_m: float
    high_m: float

    def ahead(self, plan: Floats) -> Floats:
        """Return how far places (2, n) of the plan lie along the climb, metres."""
        along: Floats = self.climb @ plan
        return along

    def aside(self, plan: Floats) -> Floats:
        """Return how far places (2, n) of the plan lie to the left of the climb, metres."""
        left: Floats = self.climb[0] * plan[1] - self.climb[1] * plan[0]
        return left

    def front_of(self, surface: Surface) -> float | None:
        """Return where a surface begins along the climb, in the middle of the run's width; None if it lies beside."""
        aside = self.aside(surface.cells_m)
        middle, half = (self.low_m + self.high_m) / 2.0, _MIDDLE * (self.high_m - self.low_m)
        before = np.abs(aside - middle) <= half
        if not before.any():
            return None
        ahead = self.ahead(surface.cells_m)[before]
        return float(np.percentile(ahead[ahead <= ahead.min() + _FRONT_M], 2.0))

    def place(self, ahead_m: float) -> Floats:
        """Return the place of the plan that lies so far along the climb, in the middle of the run's width."""
        aside_m = (self.low_m + self.high_m) / 2.0
        place: Floats = ahead_m * self.climb + aside_m * np.array([-self.climb[1], self.climb[0]])
        return place

    def facing_m(self, surface: Surface, front_m: float) -> tuple[float, float]:
        """Return over how much of the run's width a surface's front lies before it, and the width of the narrower."""
        ahead, aside = self.ahead(surface.cells_m), self.aside(surface.cells_m)
        low, high = np.percentile(aside[ahead <= front_m + priors.LONGEST_TREAD_M], [2.0, 98.0])
        common = min(float(high), self.high_m) - max(float(low), self.low_m)
        return common, min(float(high - low), self.high_m - self.low_m)


def is_base(surfaces: Sequence[Surface], run: Sequence[Link]) -> bool:
    """Return whether a run begins at a floor or landing and not at a tread."""
    first = run[0]
    if first.climb is None:
        return True
    if depth_along(surfaces[first.lower], first.climb) > priors.LONGEST_TREAD_M:
        return True
    # Of the treads a shadow may have left little: as large as its going and its width says, each is at least.
    seen_m2 = float(np.median([surfaces[link.upper].area_m2 for link in run]))
    goings = [going_between(first, second) for first, second in itertools.pairwise(run)]
    whole_m2 = float(np.median(goings)) * float(np.median([link.length_m for link in run])) if goings else 0.0
    return surfaces[first.lower].area_m2 > priors.FLOOR_RATIO * max(seen_m2, whole_m2)


def going_between(first: Link, second: Link) -> float:
    """Return the depth of the step between two links, metres; 0 where the first has no direction."""
    return 0.0 if first.climb is None else float((second.middle - first.middle) @ first.climb)


def close_gaps(surfaces: Sequence[Surface], runs: list[list[Link]], is_allowed: Sequence[bool]) -> list[list[Link]]:
    """Continue runs over shadows and missing treads, where what follows lies a whole number of rises and goings on.

    Parameters
    ----------
    surfaces : sequence of Surface
        All of them, level frame.
    runs : list of list of Link
        Each from bottom to top.
    is_allowed : sequence of bool
        Which surfaces may be part of a staircase.

    Returns
    -------
    list of list of Link
        A run that is long enough to be a flight by itself takes in single surfaces and whole runs; two short ones join
        over missing treads alone. The link over a gap says how many treads are missing; none where a tread of the right
        height and place is seen in part. Nothing is moved: a gap is only recognised, and what spans it has no value.
    """
    runs = sorted(runs, key=lambda run: (-len(run), surfaces[run[0].lower].height_m, run[0].lower))
    k = 0
    while k < len(runs):
        longer = _joined(surfaces, runs, k, is_allowed)
        if longer is None:
            k += 1
        else:
            runs, k = longer, 0
    return runs


def missing_foot(surfaces: Sequence[Surface], run: Sequence[Link], is_allowed: Sequence[bool]) -> Link | None:
    """Return the link from a floor or landing to the lowest tread of a run over treads that are missing, or None.

    The floor must lie a whole number of rises lower, two at least, and end the goings of the missing treads in front of
    the first one seen. Where it goes on to that tread, a first riser may be as tall: nothing tells the two apart.
    """
    found = []
    for number, pace, front_m, end_m, rise_m in _floors_before(surfaces, run, is_allowed):
        n_steps = _whole(rise_m, pace)
        off = (front_m - end_m) / pace.going_m - (n_steps - 1)
        if n_steps < 2 or not -_SHORT_OF <= off <= _BEYOND:
            continue
        link = _bridge(surfaces, pace, (number, run[0].lower), front_m, n_steps)
        if not _is_present(surfaces, is_allowed, pace, link, front_m):
            found.append((n_steps, abs(off), number, link))
    return min(found, key=lambda each: each[:3])[3] if found else None


def tall_foot(
    surfaces: Sequence[Surface], run: Sequence[Link], is_allowed: Sequence[bool]
) -> tuple[float, float, bool] | None:
    """Return how far below the lowest tread of a run a floor lies that reaches it, the usual rise, and what that means.

    The last is whether treads may be missing: the floor goes on below the tread, whole rises lower, or lies more than
    two rises lower, as no first riser does. None where no floor reaches the tread, or the first riser is about as tall
    as the others.
    """
    found = []
    for _, pace, front_m, end_m, rise_m in _floors_before(surfaces, run, is_allowed):
        if front_m - end_m < (1.0 - _SHORT_OF) * pace.going_m and rise_m > _TALL * pace.rise_m:
            goes_under = end_m > front_m + priors.DEEPEST_OVERHANG_M
            is_far = rise_m > (2.0 + _RISE_TOLERANCE) * pace.rise_m
            found.append((rise_m, pace.rise_m, is_far or (goes_under and _whole(rise_m, pace) >= 2)))
    return min(found, default=None)


def run_below(
    surfaces: Sequence[Surface], run: Sequence[Link], others: Sequence[Sequence[Link]]
) -> tuple[int, int] | None:
    """Return which other run ends below the lowest tread of a run as if it went on there, and how many treads between.

    It climbs the same way and ends whole rises lower and as many goings before. None where no run does.
    """
    pace = _pace(surfaces, run[:_NEAREST_LINKS], False)
    lowest = surfaces[run[0].lower]
    front_m = None if pace is None else pace.front_of(lowest)
    if pace is None or front_m is None:
        return None
    found = []
    for k, other in enumerate(others):
        top, climb = surfaces[other[-1].upper], other[-1].climb
        start_m = pace.front_of(top)
        if start_m is None or climb is None or angle_deg(climb, pace.climb) > STRAIGHT_DEG:
            continue
        n_rises = (height_at(lowest, pace.place(front_m)) - height_at(top, pace.place(start_m))) / pace.rise_m
        off = (front_m - start_m) / pace.going_m - round(n_rises)
        if round(n_rises) >= 2 and abs(n_rises - round(n_rises)) <= _RISE_TOLERANCE and abs(off) <= _GOING_TOLERANCE:
            found.append((round(n_rises) - 1, k))
    if not found:
        return None
    n_missing, nearest = min(found)
    return nearest, n_missing


def _floors_before(
    surfaces: Sequence[Surface], run: Sequence[Link], is_allowed: Sequence[bool]
) -> Iterator[tuple[int, _Pace, float, float, float]]:
    """Yield the floors before a run that begins with a tread: number, pace, front of the tread, end, height below."""
    pace = _pace(surfaces, run[:_NEAREST_LINKS], False)
    lowest = surfaces[run[0].lower]
    front_m = None if pace is None or len(run) < priors.SURE_RISERS else pace.front_of(lowest)
    if pace is None or front_m is None:
        return
    usual_m2 = pace.going_m * (pace.high_m - pace.low_m)
    for number, floor in enumerate(surfaces):
        is_floor = floor.area_m2 > priors.FLOOR_RATIO * usual_m2 and floor.height_m < lowest.height_m
        end_m = _end_of(floor, pace, front_m) if is_floor and is_allowed[number] else None
        if end_m is not None:
            rise_m = height_at(lowest, pace.place(front_m)) - height_at(floor, pace.place(end_m))
            yield number, pace, front_m, end_m, rise_m


def _joined(
    surfaces: Sequence[Surface], runs: Sequence[list[Link]], k: int, is_allowed: Sequence[bool]
) -> list[list[Link]] | None:
    """Return the runs with one of them continued by a surface or another run, at its upper or lower end; else None."""
    run = runs[k]
    if len(run) < _FEWEST_LINKS:
        return None
    others = [other for other in runs if other is not run]
    found = _above(surfaces, run, others, is_allowed) or _below(surfaces, run, others, is_allowed)
    if found is None:
        return None
    longer, taken = found
    return [longer if other is run else other for other in runs if other is not taken]


_Longer = tuple[list[Link], list[Link] | None]
"""A run that was continued, and the other run that went into it."""


def _above(
    surfaces: Sequence[Surface], run: list[Link], others: Sequence[list[Link]], is_allowed: Sequence[bool]
) -> _Longer | None:
    """Continue a run at its upper end."""
    pace = _pace(surfaces, run[-_NEAREST_LINKS:], len(run) <= _NEAREST_LINKS and is_base(surfaces, run))
    top = run[-1].upper
    if pace is None or depth_along(surfaces[top], pace.climb) > priors.LONGEST_TREAD_M:
        return None
    starts = {other[0].lower: other for other in others}
    used = {link.upper for link in itertools.chain(run, *others)} | {run[0].lower}
    free = [number for number in range(len(surfaces)) if is_allowed[number] and number not in used]
    for bridge in _bridges(surfaces, is_allowed, pace, [(top, number) for number in free]):
        high = starts.get(bridge.upper)
        # A landing is where a flight ends; the one that begins there stays by itself.
        if high is not None and is_base(surfaces, high):
            high = None
        if _may_join(run, bridge, None if high is None else high[0], high):
            return [*run, bridge, *(high or ())], high
    return None


def _below(
    surfaces: Sequence[Surface], run: list[Link], others: Sequence[list[Link]], is_allowed: Sequence[bool]
) -> _Longer | None:
    """Continue a run at its lower end, unless it begins at a floor."""
    pace = None if is_base(surfaces, run) else _pace(surfaces, run[:_NEAREST_LINKS], False)
    if pace is None:
        return None
    ends = {other[-1].upper: other for other in others}
    used = {number for link in itertools.chain(run, *others) for number in (link.lower, link.upper)} - ends.keys()
    free = [number for number in range(len(surfaces)) if is_allowed[number] and number not in used]
    for bridge in _bridges(surfaces, is_allowed, pace, [(number, run[0].lower) for number in free]):
        low = ends.get(bridge.lower)
        is_tread = depth_along(surfaces[bridge.lower], pace.climb) <= priors.LONGEST_TREAD_M
        if is_tread and _may_join(run, bridge, None if low is None else low[-1], low):
            return [*(low or ()), bridge, *run], low
    return None


def _may_join(run: Sequence[Link], bridge: Link, end: Link | None, other: Sequence[Link] | None) -> bool:
    """Return whether a run is long enough for what continues it, whose nearest link climbs the same way."""
    if len(run) < priors.SURE_RISERS and (other is None or not bridge.n_missing):
        return False
    if end is None or bridge.climb is None:
        return True
    return end.climb is not None and angle_deg(end.climb, bridge.climb) <= STRAIGHT_DEG


def _pace(surfaces: Sequence[Surface], links: Sequence[Link], begins_at_base: bool) -> _Pace | None:
    """Return how some links go on, None where they wind or are too few."""
    # The edge on a floor may run all around the lowest tread.
    inner = links[1:] if begins_at_base else links
    climbs = [link.climb for link in inner if link.climb is not None]
    rises = [link.rise_m for link in links if not link.n_missing]
    if not climbs or not rises:
        return None
    climb = np.median(climbs, axis=0)
    climb /= np.hypot(*climb)
    if any(angle_deg(other, climb) > STRAIGHT_DEG for other in climbs):
        return None
    asides = np.array([climb[0] * link.middle[1] - climb[1] * link.middle[0] for link in inner])
    halves = np.array([link.length_m / 2.0 for link in inner])
    low_m, high_m = float(np.median(asides - halves)), float(np.median(asides + halves))
    pace = _Pace(climb, float(np.median(rises)), 1.0, low_m, high_m)
    fronts = [
        (pace.front_of(surfaces[link.lower]), pace.front_of(surfaces[link.upper]))
        for link in inner
        if not link.n_missing
    ]
    goings = [upper - lower for lower, upper in fronts if lower is not None and upper is not None]
    going_m = float(np.median(goings)) if goings else 0.0
    return replace(pace, going_m=going_m) if going_m > 0.0 else None


def _bridges(
    surfaces: Sequence[Surface], is_allowed: Sequence[bool], pace: _Pace, pairs: Sequence[tuple[int, int]]
) -> list[Link]:
    """Return the links over gaps of whole rises and goings between pairs of surfaces, the smallest gap first."""
    found = []
    for lower, upper in pairs:
        low, high = surfaces[lower], surfaces[upper]
        if not 0.0 < high.height_m - low.height_m <= (_MAX_MISSING + 2) * pace.rise_m:
            continue
        start_m, front_m = pace.front_of(low), pace.front_of(high)
        if start_m is None or front_m is None:
            continue
        n_steps = _whole(height_at(high, pace.place(front_m)) - height_at(low, pace.place(start_m)), pace)
        off_m = abs(front_m - start_m - n_steps * pace.going_m)
        common_m, narrower_m = pace.facing_m(high, front_m)
        if not n_steps or off_m > _GOING_TOLERANCE * pace.going_m or common_m < _LEAST_BESIDE * narrower_m:
            continue
        link = _bridge(surfaces, pace, (lower, upper), front_m, n_steps)
        if not _is_present(surfaces, is_allowed, pace, link, front_m):
            found.append((n_steps, off_m, lower, upper, link))
    return [each[4] for each in sorted(found, key=lambda each: each[:4])]


def _whole(rise_m: float, pace: _Pace) -> int:
    """Return how many rises of a run a height is, 0 if it is not a whole number or too many treads would be missing."""
    n_steps = round(rise_m / pace.rise_m)
    is_whole = abs(rise_m - n_steps * pace.rise_m) <= _RISE_TOLERANCE * pace.rise_m
    return n_steps if is_whole and 1 <= n_steps <= _MAX_MISSING + 1 else 0


def _bridge(surfaces: Sequence[Surface], pace: _Pace, pair: tuple[int, int], front_m: float, n_steps: int) -> Link:
    """Return the link over a gap to the surface whose front lies there."""
    low, high = surfaces[pair[0]], surfaces[pair[1]]
    rise_m = height_at(high, pace.place(front_m)) - low.height_m
    width_m = pace.high_m - pace.low_m
    return Link(*pair, low.height_m, rise_m, pace.climb, pace.place(front_m), width_m, n_steps - 1)


def _is_present(
    surfaces: Sequence[Surface], is_allowed: Sequence[bool], pace: _Pace, bridge: Link, front_m: float
) -> bool:
    """Return whether a tread that a link goes over is there.

    Then what is missing is a reason to take it into the flight.
    """
    for k in range(1, bridge.n_missing + 1):
        place = pace.place(front_m - (k - 0.5) * pace.going_m)
        wanted_m = surfaces[bridge.upper].height_m - k * pace.rise_m
        if any(
            is_allowed[number]
            and number not in (bridge.lower, bridge.upper)
            and abs(surface.height_m - wanted_m) <= _PRESENT_SHARE * pace.rise_m
            and float(np.hypot(*(surface.cells_m - place[:, None])).min()) <= _PRESENT_SHARE * pace.going_m
            for number, surface in enumerate(surfaces)
        ):
            return True
    return False


def _end_of(floor: Surface, pace: _Pace, front_m: float) -> float | None:
    """Return where a floor ends along the climb in front of a tread, None where it does not lie there."""
    ahead, aside = pace.ahead(floor.cells_m), pace.aside(floor.cells_m)
    before = ahead[(aside >= pace.low_m) & (aside <= pace.high_m) & (ahead <= front_m + _PRESENT_SHARE * pace.going_m)]
    if not before.size or float(before.max()) < front_m - (_MAX_MISSING + 1) * pace.going_m:
        return None
    return float(np.percentile(before[before >= before.max() - _FLOOR_M], 98.0))
