"""What belongs to the ends of a run? Its foot, a run that goes on less evenly, a last edge that is seen badly."""

import itertools
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.plan import angle_deg, unit_way
from stair_inspector.model import Surface
from stair_inspector.params import FlightsParams
from stair_inspector.stages.links import Link, depth_along
from stair_inspector.stages.missing_feet import missing_foot
from stair_inspector.stages.pace import SAME_CLIMB_DEG, going_between, is_base
from stair_inspector.stages.rejects import Forced
from stair_inspector.stages.runs import consistency, edges_overlap

_LEAST_SEEN = 0.25
"""The same where a long run goes on behind: a shadow may hide most of an edge."""
ALTERNATIVE_RISE = 0.25
_LAST_RISE = 0.1
"""How far the rise onto a landing that is touched along a short edge only may be from the flight's, as a share."""


def with_feet(surfaces: Sequence[Surface], runs: list[list[Link]], links: Sequence[Link]) -> list[list[Link]]:
    """Put the floor or landing in front of every run that begins with a tread that is no other run's step."""
    steps = {link.upper for run in runs for link in run}
    result = []
    for run in runs:
        result.append(run if run[0].lower in steps else _with_foot(surfaces, run, links))
        steps |= {link.upper for link in result[-1]}
    return result


def _with_foot(surfaces: Sequence[Surface], run: list[Link], links: Sequence[Link]) -> list[Link]:
    """Put the floor or landing in front of a run that begins with a tread, if there is one."""
    first = run[0]
    # A wide step with a floor below it is a step all the same.
    if first.climb is None or depth_along(surfaces[first.lower], first.climb) > priors.LONGEST_TREAD_M:
        return run
    rise_m = float(np.median([link.rise_m for link in run]))
    candidates = [
        link
        for link in links
        if link.upper == first.lower
        and surfaces[link.lower].area_m2 > priors.FLOOR_RATIO * surfaces[link.upper].area_m2
        and rise_m <= priors.MOST_UNEVEN * link.rise_m
        and link.rise_m <= (priors.TALLEST_FOOT if len(run) >= priors.SURE_RISERS else priors.MOST_UNEVEN) * rise_m
    ]
    if not candidates:
        return run
    foot = min(candidates, key=lambda link: abs(link.rise_m - rise_m))
    # Its own edge may run all around the tread: the flight's first step says which way is up.
    foot = replace(foot, climb=first.climb)
    return [foot, *run] if going_between(foot, first) >= priors.SHORTEST_GOING_M else run


def with_uneven_ends(surfaces: Sequence[Surface], runs: list[list[Link]]) -> list[list[Link]]:
    """Join a run that is long enough for a flight with one that goes on straight from its end, though less evenly.

    One riser that is far too tall is a fault of the flight, which it must not hide by parting it; and of one edge a
    shadow may leave the left end, of the next the right one.
    """
    runs = sorted(runs, key=lambda run: (surfaces[run[0].lower].height_m, run[0].lower))
    while True:
        # What was joined may go on in its turn: a riser amid a flight that is far too tall is a run by itself at first.
        pairs = itertools.permutations(runs, 2)
        found = next((pair for pair in pairs if _goes_on(surfaces, *pair)), None)
        if found is None:
            return runs
        low, high = found
        runs = [[*low, *high] if run is low else run for run in runs if run is not high]


def with_weak_links(runs: list[list[Link]], weak: Sequence[Link], params: FlightsParams) -> list[list[Link]]:
    """Join two runs, each long enough for a flight, that touch along a short edge, as wedges half in shadow do."""
    for link in weak:
        low = next((run for run in runs if run[-1].upper == link.lower and len(run) >= priors.SURE_RISERS), None)
        high = next((run for run in runs if run[0].lower == link.upper and len(run) >= priors.SURE_RISERS), None)
        if low is None or high is None or link.climb is None:
            continue
        before, after = low[-1].climb, high[0].climb
        rise_m = float(np.median([each.rise_m for each in (*low, *high)]))
        if before is None or after is None or angle_deg(before, after) > 2.0 * params.turn_deg:
            continue
        way = unit_way(before + after)
        goings = (link.middle - low[-1].middle) @ before, (high[0].middle - link.middle) @ way
        if abs(link.rise_m - rise_m) <= ALTERNATIVE_RISE * rise_m and min(goings) >= priors.SHORTEST_GOING_M:
            # A short edge says little about the direction: it lies between those before and after.
            runs = [[*low, replace(link, climb=way), *high] if run is low else run for run in runs if run is not high]
    return runs


def with_short_last_edges(
    surfaces: Sequence[Surface], runs: list[list[Link]], every: Sequence[Link], params: FlightsParams
) -> list[list[Link]]:
    """Let a run that is long enough for a flight end on the landing that touches its last step along a short edge.

    Of the last wedge of a spiral a handrail or the landing itself may hide most of its back.
    """
    steps = {link.upper for run in runs for link in run} | {run[0].lower for run in runs}
    result = []
    for run in runs:
        rise_m = float(np.median([link.rise_m for link in run]))
        usual_m2 = float(np.median([surfaces[link.upper].area_m2 for link in run]))
        last = run[-1]
        found = [
            link
            for link in every
            if link.lower == last.upper
            and link.upper not in steps
            and link.length_m < priors.SHORTEST_EDGE_M
            and abs(link.rise_m - rise_m) <= _LAST_RISE * rise_m
            and surfaces[link.lower].area_m2 <= priors.FLOOR_RATIO * usual_m2 < surfaces[link.upper].area_m2
            and consistency(last, link, params) > 0.0
        ]
        result.append([*run, found[0]] if len(run) >= priors.SURE_RISERS and len(found) == 1 else run)
        steps |= {link.upper for link in result[-1]}
    return result


def _goes_on(surfaces: Sequence[Surface], low: list[Link], high: list[Link]) -> bool:
    """Return whether two runs meet at a tread, and neither turn nor step aside there."""
    first, second = low[-1], high[0]
    if first.upper != second.lower or first.climb is None or second.climb is None:
        return False
    if max(len(low), len(high)) < priors.SURE_RISERS:
        return False
    longer = high if len(high) > len(low) else low
    going_m = float(np.median([going_between(a, b) for a, b in itertools.pairwise(longer)]))
    depth_m = going_between(first, second)
    is_tread = priors.SHORTEST_GOING_M <= depth_m <= min(priors.LONGEST_TREAD_M, priors.LANDING_RATIO * going_m)
    is_tread = is_tread and depth_along(surfaces[second.lower], second.climb) <= priors.LONGEST_TREAD_M
    return (
        is_tread
        and angle_deg(first.climb, second.climb) <= SAME_CLIMB_DEG
        and edges_overlap(first, second, _LEAST_SEEN)
    )


def with_missing_feet(
    surfaces: Sequence[Surface], runs: list[list[Link]], is_allowed: Sequence[bool], forced: Forced
) -> list[list[Link]]:
    """Put the floor or landing in front of every run whose lowest treads are missing."""
    steps = {link.upper for run in runs for link in run}
    result = []
    for run in runs:
        has_foot = run[0].lower in steps or begins_at_base(surfaces, run, forced)
        foot = None if has_foot else missing_foot(surfaces, run, is_allowed)
        result.append(run if foot is None else [foot, *run])
    return result


def begins_at_base(surfaces: Sequence[Surface], run: Sequence[Link], forced: Forced) -> bool:
    """Return whether a run begins at a floor or landing, or at what the region of interest leaves of one.

    Where the region cuts off the front of its lowest surface, no nosing is seen of it: it is no step.
    """
    first = run[0]
    is_cut = first.climb is not None and forced.is_cut(first.lower, -first.climb)
    return is_cut or is_base(surfaces, run)
