"""How does a run of links go on beyond its ends? Direction, rise, going and the range across."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.arrays import Floats
from stair_inspector.geometry.plan import angle_deg, left_of, unit_way
from stair_inspector.model import Surface
from stair_inspector.stages.links import Link, depth_along

SAME_CLIMB_DEG = 15.0
"""Edges that climb the same way: single edges of patches are that rough."""
MAX_MISSING = 3
RISE_TOLERANCE, GOING_TOLERANCE = 0.22, 0.44
"""How far a gap may be from a whole number of rises and of goings, as a share of one."""
NEAREST_LINKS = 6
"""Rise, going and direction at the end of a run are those of so many links there."""
_MIDDLE = 0.4
PRESENT_SHARE = 0.4
_FRONT_M = 0.3


@dataclass(frozen=True, slots=True, eq=False)
class Pace:
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
        place: Floats = ahead_m * self.climb + aside_m * left_of(self.climb)
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


def pace_of(surfaces: Sequence[Surface], links: Sequence[Link], begins_at_base: bool) -> Pace | None:
    """Return how some links go on, None where they wind or are too few."""
    # The edge on a floor may run all around the lowest tread.
    inner = links[1:] if begins_at_base else links
    climbs = [link.climb for link in inner if link.climb is not None]
    rises = [link.rise_m for link in links if not link.n_missing]
    if not climbs or not rises:
        return None
    climb = unit_way(np.median(climbs, axis=0))
    if any(angle_deg(other, climb) > SAME_CLIMB_DEG for other in climbs):
        return None
    asides = np.array([climb[0] * link.middle[1] - climb[1] * link.middle[0] for link in inner])
    halves = np.array([link.length_m / 2.0 for link in inner])
    low_m, high_m = float(np.median(asides - halves)), float(np.median(asides + halves))
    pace = Pace(climb, float(np.median(rises)), 1.0, low_m, high_m)
    fronts = [
        (pace.front_of(surfaces[link.lower]), pace.front_of(surfaces[link.upper]))
        for link in inner
        if not link.n_missing
    ]
    goings = [upper - lower for lower, upper in fronts if lower is not None and upper is not None]
    going_m = float(np.median(goings)) if goings else 0.0
    return replace(pace, going_m=going_m) if going_m > 0.0 else None


def whole_rises(rise_m: float, pace: Pace) -> int:
    """Return how many rises of a run a height is, 0 if it is not a whole number or too many treads would be missing."""
    n_steps = round(rise_m / pace.rise_m)
    is_whole = abs(rise_m - n_steps * pace.rise_m) <= RISE_TOLERANCE * pace.rise_m
    return n_steps if is_whole and 1 <= n_steps <= MAX_MISSING + 1 else 0


def link_over(surfaces: Sequence[Surface], pace: Pace, pair: tuple[int, int], front_m: float, n_steps: int) -> Link:
    """Return the link over a gap to the surface whose front lies there."""
    low, high = surfaces[pair[0]], surfaces[pair[1]]
    rise_m = high.height_at(pace.place(front_m)) - low.height_m
    width_m = pace.high_m - pace.low_m
    return Link(*pair, low.height_m, rise_m, pace.climb, pace.place(front_m), width_m, n_steps - 1)


def has_tread_below(
    surfaces: Sequence[Surface], is_allowed: Sequence[bool], pace: Pace, bridge: Link, front_m: float
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
            and abs(surface.height_m - wanted_m) <= PRESENT_SHARE * pace.rise_m
            and float(np.hypot(*(surface.cells_m - place[:, None])).min()) <= PRESENT_SHARE * pace.going_m
            for number, surface in enumerate(surfaces)
        ):
            return True
    return False
