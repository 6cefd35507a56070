"""What lies below a run that begins with a tread? A floor over missing treads, a tall riser, another run."""

from collections.abc import Iterator, Sequence

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.plan import angle_deg
from stair_inspector.model import Surface
from stair_inspector.stages.links import Link
from stair_inspector.stages.pace import (
    GOING_TOLERANCE,
    MAX_MISSING,
    NEAREST_LINKS,
    PRESENT_SHARE,
    RISE_TOLERANCE,
    SAME_CLIMB_DEG,
    Pace,
    has_tread_below,
    link_over,
    pace_of,
    whole_rises,
)

_SHORT_OF, _BEYOND = 0.35, 0.5
"""How much less and more than the goings of the missing treads a floor may end in front of the first one seen."""
_TALL = 1.5


def missing_foot(surfaces: Sequence[Surface], run: Sequence[Link], is_allowed: Sequence[bool]) -> Link | None:
    """Return the link from a floor or landing to the lowest tread of a run over treads that are missing, or None.

    The floor must lie a whole number of rises lower, two at least, and end the goings of the missing treads in front of
    the first one seen. Where it goes on to that tread, a first riser may be as tall: nothing tells the two apart.
    """
    found = []
    for number, pace, front_m, end_m, rise_m in _floors_before(surfaces, run, is_allowed):
        n_steps = whole_rises(rise_m, pace)
        off = (front_m - end_m) / pace.going_m - (n_steps - 1)
        if n_steps < 2 or not -_SHORT_OF <= off <= _BEYOND:
            continue
        link = link_over(surfaces, pace, (number, run[0].lower), front_m, n_steps)
        if not has_tread_below(surfaces, is_allowed, pace, link, front_m):
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
            is_far = rise_m > (2.0 + RISE_TOLERANCE) * pace.rise_m
            found.append((rise_m, pace.rise_m, is_far or (goes_under and whole_rises(rise_m, pace) >= 2)))
    return min(found, default=None)


def run_below(
    surfaces: Sequence[Surface], run: Sequence[Link], others: Sequence[Sequence[Link]]
) -> tuple[int, int] | None:
    """Return which other run ends below the lowest tread of a run as if it went on there, and how many treads between.

    It climbs the same way and ends whole rises lower and as many goings before. None where no run does.
    """
    pace = pace_of(surfaces, run[:NEAREST_LINKS], False)
    lowest = surfaces[run[0].lower]
    front_m = None if pace is None else pace.front_of(lowest)
    if pace is None or front_m is None:
        return None
    found = []
    for k, other in enumerate(others):
        top, climb = surfaces[other[-1].upper], other[-1].climb
        start_m = pace.front_of(top)
        if start_m is None or climb is None or angle_deg(climb, pace.climb) > SAME_CLIMB_DEG:
            continue
        n_rises = (lowest.height_at(pace.place(front_m)) - top.height_at(pace.place(start_m))) / pace.rise_m
        off = (front_m - start_m) / pace.going_m - round(n_rises)
        if round(n_rises) >= 2 and abs(n_rises - round(n_rises)) <= RISE_TOLERANCE and abs(off) <= GOING_TOLERANCE:
            found.append((round(n_rises) - 1, k))
    if not found:
        return None
    n_missing, nearest = min(found)
    return nearest, n_missing


def _floors_before(
    surfaces: Sequence[Surface], run: Sequence[Link], is_allowed: Sequence[bool]
) -> Iterator[tuple[int, Pace, float, float, float]]:
    """Yield the floors before a run that begins with a tread: number, pace, front of the tread, end, height below."""
    pace = pace_of(surfaces, run[:NEAREST_LINKS], False)
    lowest = surfaces[run[0].lower]
    front_m = None if pace is None or len(run) < priors.SURE_RISERS else pace.front_of(lowest)
    if pace is None or front_m is None:
        return
    usual_m2 = pace.going_m * (pace.high_m - pace.low_m)
    for number, floor in enumerate(surfaces):
        is_floor = floor.area_m2 > priors.FLOOR_RATIO * usual_m2 and floor.height_m < lowest.height_m
        end_m = _end_of(floor, pace, front_m) if is_floor and is_allowed[number] else None
        if end_m is not None:
            rise_m = lowest.height_at(pace.place(front_m)) - floor.height_at(pace.place(end_m))
            yield number, pace, front_m, end_m, rise_m


def _end_of(floor: Surface, pace: Pace, front_m: float) -> float | None:
    """Return where a floor ends along the climb in front of a tread, None where it does not lie there."""
    ahead, aside = pace.ahead(floor.cells_m), pace.aside(floor.cells_m)
    before = ahead[(aside >= pace.low_m) & (aside <= pace.high_m) & (ahead <= front_m + PRESENT_SHARE * pace.going_m)]
    if not before.size or float(before.max()) < front_m - (MAX_MISSING + 1) * pace.going_m:
        return None
    return float(np.percentile(before[before >= before.max() - priors.FLOOR_STRIP_M], 98.0))
