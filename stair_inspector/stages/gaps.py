"""What lies between runs of links? Treads that a shadow hides in part, and treads that are missing."""

import itertools
from collections.abc import Sequence

from stair_inspector import priors
from stair_inspector.geometry.plan import angle_deg
from stair_inspector.model import Surface
from stair_inspector.stages.links import Link, depth_along
from stair_inspector.stages.pace import (
    GOING_TOLERANCE,
    MAX_MISSING,
    NEAREST_LINKS,
    SAME_CLIMB_DEG,
    Pace,
    has_tread_below,
    is_base,
    link_over,
    pace_of,
    whole_rises,
)

_FEWEST_LINKS = 2
"""Links that two runs need between them, so that there is a going to compare the gap with."""
_LEAST_BESIDE = 0.5
"""Share of the narrower of two edges along which they must lie before each other."""


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
    pace = pace_of(surfaces, run[-NEAREST_LINKS:], len(run) <= NEAREST_LINKS and is_base(surfaces, run))
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
    pace = None if is_base(surfaces, run) else pace_of(surfaces, run[:NEAREST_LINKS], False)
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
    return end.climb is not None and angle_deg(end.climb, bridge.climb) <= SAME_CLIMB_DEG


def _bridges(
    surfaces: Sequence[Surface], is_allowed: Sequence[bool], pace: Pace, pairs: Sequence[tuple[int, int]]
) -> list[Link]:
    """Return the links over gaps of whole rises and goings between pairs of surfaces, the smallest gap first."""
    found = []
    for lower, upper in pairs:
        low, high = surfaces[lower], surfaces[upper]
        if not 0.0 < high.height_m - low.height_m <= (MAX_MISSING + 2) * pace.rise_m:
            continue
        start_m, front_m = pace.front_of(low), pace.front_of(high)
        if start_m is None or front_m is None:
            continue
        n_steps = whole_rises(high.height_at(pace.place(front_m)) - low.height_at(pace.place(start_m)), pace)
        off_m = abs(front_m - start_m - n_steps * pace.going_m)
        common_m, narrower_m = pace.facing_m(high, front_m)
        if not n_steps or off_m > GOING_TOLERANCE * pace.going_m or common_m < _LEAST_BESIDE * narrower_m:
            continue
        link = link_over(surfaces, pace, (lower, upper), front_m, n_steps)
        if not has_tread_below(surfaces, is_allowed, pace, link, front_m):
            found.append((n_steps, off_m, lower, upper, link))
    return [each[4] for each in sorted(found, key=lambda each: each[:4])]
