"""Which surfaces follow each other as the steps of a flight? Links between surfaces, runs of links, landings."""

import itertools
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.arrays import freeze
from stair_inspector.model import Chain, Chains, Note, Patches, Surface
from stair_inspector.params import FlightsParams
from stair_inspector.stages.gaps import (
    STRAIGHT_DEG,
    close_gaps,
    going_between,
    is_base,
    missing_foot,
    run_below,
    tall_foot,
)
from stair_inspector.stages.links import Link, angle_deg, depth_along, find_links
from stair_inspector.stages.rejects import Forced, find_undersides, may_be_step

_LEAST_OVERLAP = 0.5
"""Share of the shorter edge along which two edges of one step must face each other."""
_LEAST_SEEN = 0.25
"""The same where a long run goes on behind: a shadow may hide most of an edge."""
_ALTERNATIVE_RISE = 0.25
_LAST_RISE = 0.1
"""How far the rise onto a landing that is touched along a short edge only may be from the flight's, as a share."""
_JOINED_WIDTH = 0.6


def find_chains(patches: Patches, params: FlightsParams, least_area_m2: float, forced: Forced) -> Chains:
    """Chain surfaces into runs of steps.

    Parameters
    ----------
    patches : Patches
        All surfaces, level frame.
    params : FlightsParams
        Limits of rise, gap and turn.
    least_area_m2 : float
        Smallest area of a tread.
    forced : Forced
        What the user has decided: a tread is taken whatever its size and slope, a landing ends a flight, and only
        flights that climb about in the direction given are looked for.

    Returns
    -------
    Chains
        From bottom to top. A chain may begin at the floor or at a landing that ends another one. Notes name what else
        would have been possible.
    """
    wanted = forced.those("tread") | forced.those("landing")
    unwanted = forced.those("rejected")
    is_allowed = [
        surface.part_of is None and (k in wanted or (k not in unwanted and may_be_step(surface, least_area_m2)))
        for k, surface in enumerate(patches.surfaces)
    ]
    for k in find_undersides(patches) - wanted:
        is_allowed[k] = False
    every = find_links(patches, params, is_allowed, forced.climb)
    links = [link for link in every if link.length_m >= priors.SHORTEST_EDGE_M]
    surfaces = patches.surfaces
    runs = _with_feet(surfaces, _longest_runs(links, params), links)
    runs = _with_weak_links(
        _with_uneven_ends(surfaces, runs), [link for link in every if link.length_m < priors.SHORTEST_EDGE_M], params
    )
    runs = _with_short_last_edges(surfaces, runs, every, params)
    runs = close_gaps(surfaces, runs, is_allowed)
    runs = _with_missing_feet(surfaces, _with_feet(surfaces, runs, links), is_allowed, forced)
    pieces = [piece for run in runs for piece in _cut_at_landings(run, forced)]
    kept = [piece for piece in pieces if _is_flight(surfaces, piece, params, pieces)]
    kept.sort(key=lambda run: (surfaces[run[0].lower].height_m, run[0].lower))
    notes = [note for run in kept for note in _note_alternatives(surfaces, run, links)]
    longest = max((len(run) for run in runs), default=0)
    # What a flight climbs onto is where another one begins, however small it is.
    steps = {link.upper for piece in kept for link in piece}
    has_base = [run[0].lower in steps or _is_base(surfaces, run, forced) for run in kept]
    for run, is_based in zip(kept, has_base, strict=True):
        notes += [] if is_based else _note_foot(surfaces, run, kept, is_allowed)
    chains = tuple(_chain(run, is_based) for run, is_based in zip(kept, has_base, strict=True))
    return Chains(chains, tuple(notes), longest)


def _longest_runs(links: Sequence[Link], params: FlightsParams) -> list[list[Link]]:
    """Return the best sequences of links; a surface is used once, but one sequence may begin where another ends."""
    free = [link for link in links if link.climb is not None]
    runs = []
    while free:
        run = _best_run(free, params)
        runs.append(run)
        inner = {link.upper for link in run[:-1]}
        last = run[-1].upper
        # What a run climbs onto can be where another begins, and from one floor several can begin.
        free = [
            link for link in free if not {link.lower, link.upper} & inner and link.upper != last and link not in run
        ]
    return runs


def _best_run(links: Sequence[Link], params: FlightsParams) -> list[Link]:
    """Return the sequence of links with the highest sum of merits: the longest path through a graph without cycles."""
    onto: dict[int, list[int]] = {}
    for k, link in enumerate(links):
        onto.setdefault(link.upper, []).append(k)
    best = [0.0] * len(links)
    before = [-1] * len(links)
    # A link's predecessors end where it begins, which is lower.
    for k in sorted(range(len(links)), key=lambda k: links[k].height_m):
        best[k] = _merit(links[k])
        for other in onto.get(links[k].lower, ()):
            merit = _consistency(links[other], links[k], params)
            if merit > 0.0 and best[other] + merit + _merit(links[k]) > best[k]:
                best[k] = best[other] + merit + _merit(links[k])
                before[k] = other
    k = max(range(len(links)), key=lambda k: (best[k], -k))
    run = []
    while k >= 0:
        run.append(links[k])
        k = before[k]
    return run[::-1]


def _merit(link: Link) -> float:
    """Return what a link is worth by itself: a little for a long edge, so that of two candidates the wider wins."""
    return 0.2 * min(1.0, link.length_m)


def _consistency(first: Link, second: Link, params: FlightsParams) -> float:
    """Return how well two links follow each other, 0 for not at all, at most 1."""
    if first.climb is None or second.climb is None:
        return 0.0
    low, high = sorted((first.rise_m, second.rise_m))
    turn = angle_deg(first.climb, second.climb)
    if high > priors.MOST_UNEVEN * low or turn > params.turn_deg:
        return 0.0
    way = first.climb + second.climb
    way /= np.hypot(*way)
    move = second.middle - first.middle
    if way @ move < priors.SHORTEST_GOING_M:
        return 0.0
    if turn <= STRAIGHT_DEG and not _overlap(first, second, _LEAST_OVERLAP):
        return 0.0
    return 1.0 - 0.5 * (high - low) / low - 0.2 * turn / params.turn_deg


def _overlap(first: Link, second: Link, share: float) -> bool:
    """Return whether two edges of a step, about parallel, face each other along a share of the shorter one."""
    if first.climb is None or second.climb is None:
        return False
    way = first.climb + second.climb
    way /= np.hypot(*way)
    move = second.middle - first.middle
    sideways = abs(float(move[0] * way[1] - move[1] * way[0]))
    return (first.length_m + second.length_m) / 2.0 - sideways >= share * min(first.length_m, second.length_m)


def _with_feet(surfaces: Sequence[Surface], runs: list[list[Link]], links: Sequence[Link]) -> list[list[Link]]:
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


def _with_uneven_ends(surfaces: Sequence[Surface], runs: list[list[Link]]) -> list[list[Link]]:
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


def _with_weak_links(runs: list[list[Link]], weak: Sequence[Link], params: FlightsParams) -> list[list[Link]]:
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
        way = before + after
        way /= np.hypot(*way)
        goings = (link.middle - low[-1].middle) @ before, (high[0].middle - link.middle) @ way
        if abs(link.rise_m - rise_m) <= _ALTERNATIVE_RISE * rise_m and min(goings) >= priors.SHORTEST_GOING_M:
            # A short edge says little about the direction: it lies between those before and after.
            runs = [[*low, replace(link, climb=way), *high] if run is low else run for run in runs if run is not high]
    return runs


def _with_short_last_edges(
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
            and _consistency(last, link, params) > 0.0
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
    return is_tread and angle_deg(first.climb, second.climb) <= STRAIGHT_DEG and _overlap(first, second, _LEAST_SEEN)


def _with_missing_feet(
    surfaces: Sequence[Surface], runs: list[list[Link]], is_allowed: Sequence[bool], forced: Forced
) -> list[list[Link]]:
    """Put the floor or landing in front of every run whose lowest treads are missing."""
    steps = {link.upper for run in runs for link in run}
    result = []
    for run in runs:
        has_foot = run[0].lower in steps or _is_base(surfaces, run, forced)
        foot = None if has_foot else missing_foot(surfaces, run, is_allowed)
        result.append(run if foot is None else [foot, *run])
    return result


def _is_base(surfaces: Sequence[Surface], run: Sequence[Link], forced: Forced) -> bool:
    """Return whether a run begins at a floor or landing, or at what the region of interest leaves of one.

    Where the region cuts off the front of its lowest surface, no nosing is seen of it: it is no step.
    """
    first = run[0]
    is_cut = first.climb is not None and forced.is_cut(first.lower, -first.climb)
    return is_cut or is_base(surfaces, run)


def _cut_at_landings(run: list[Link], forced: Forced) -> list[list[Link]]:
    """Cut a run at every landing inside it, which ends one piece and begins the next."""
    depths = [going_between(first, second) for first, second in itertools.pairwise(run)]
    if not depths:
        return [run]
    usual_m = float(np.median(depths))
    pieces = [[run[0]]]
    for link, previous, depth_m in zip(run[1:], run[:-1], depths, strict=True):
        is_deep = depth_m > priors.LONGEST_TREAD_M or depth_m > priors.LANDING_RATIO * usual_m
        # Where a tread is missing, the step below it only looks deep.
        is_deep = is_deep and not link.n_missing and not previous.n_missing
        # The way to a short edge, which may lie far on one side, is no depth either.
        is_deep = is_deep and link.length_m >= priors.SHORTEST_EDGE_M
        kind = forced.kinds.get(link.lower)
        if kind == "landing" or (is_deep and kind != "tread"):
            pieces.append([])
        pieces[-1].append(link)
    return pieces


def _is_flight(
    surfaces: Sequence[Surface], run: list[Link], params: FlightsParams, pieces: Sequence[list[Link]]
) -> bool:
    """Return whether a run is a flight by itself, or one that a landing joins to another."""
    n_risers = len(run)
    if n_risers >= max(priors.SURE_RISERS, params.min_risers):
        return True
    if any(
        _is_joined(run, other)
        for other in pieces
        if other is not run and len(other) >= max(priors.SURE_RISERS, params.min_risers)
    ):
        return True
    if n_risers < params.min_risers:
        return False
    if n_risers == 1:
        return True
    # Two risers are what furniture imitates most easily: a heap of boxes has no common width and direction.
    first, second = run
    if not is_base(surfaces, run) or second.climb is None or second.length_m < priors.NARROWEST_OF_TWO_M:
        return False
    if first.climb is not None and angle_deg(first.climb, second.climb) > STRAIGHT_DEG:
        return False
    low, high = sorted((first.rise_m, second.rise_m))
    tread = surfaces[first.upper]
    depth_m = going_between(first, second)
    evenly_wide = min(first.length_m, second.length_m) >= 0.7 * max(first.length_m, second.length_m)
    is_filled = tread.area_m2 >= 0.5 * depth_m * min(first.length_m, second.length_m)
    return (
        high <= priors.MOST_UNEVEN_OF_TWO * low
        and priors.SHALLOWEST_OF_TWO_M <= depth_m <= priors.LONGEST_TREAD_M
        and evenly_wide
        and is_filled
    )


def _is_joined(run: list[Link], other: list[Link]) -> bool:
    """Return whether a landing joins a short run to another flight of about its width."""
    if other[-1].upper != run[0].lower and other[0].lower != run[-1].upper:
        return False
    return float(np.median([link.length_m for link in run])) >= _JOINED_WIDTH * float(
        np.median([link.length_m for link in other])
    )


def _note_alternatives(surfaces: Sequence[Surface], run: list[Link], links: Sequence[Link]) -> list[Note]:
    """Note where another surface would have continued a run about as well."""
    used = {link.upper for link in run} | {run[0].lower}
    rise_m = float(np.median([link.rise_m for link in run]))
    notes = []
    for link in run:
        for other in links:
            if (
                other.lower == link.lower
                and other.upper not in used
                and other.climb is not None
                and link.climb is not None
                and angle_deg(other.climb, link.climb) <= STRAIGHT_DEG
                and abs(other.rise_m - rise_m) <= _ALTERNATIVE_RISE * rise_m
                and other.length_m >= _LEAST_OVERLAP * link.length_m
            ):
                message = (
                    f"from the surface at {surfaces[link.lower].height_m:.3f} m the flight goes on to that at "
                    f"{surfaces[link.upper].height_m:.3f} m (patch {link.upper}, rise {link.rise_m * 1000.0:.0f} mm, "
                    f"edge {link.length_m:.2f} m); patch {other.upper} would also have been possible (rise "
                    f"{other.rise_m * 1000.0:.0f} mm, edge {other.length_m:.2f} m): overrule it if that is the step"
                )
                notes.append(Note("chain_ambiguous", "flights", message))
    return notes


def _note_foot(
    surfaces: Sequence[Surface], run: list[Link], kept: list[list[Link]], is_allowed: Sequence[bool]
) -> list[Note]:
    """Note what lies below a flight that begins in the air: another flight, or a floor far below its lowest step."""
    below = run_below(surfaces, run, kept)
    if below is not None:
        # Flights are counted from 1 in the order of the chains.
        other, n_missing = below[0] + 1, below[1]
        own = kept.index(run) + 1
        text = "a tread is" if n_missing == 1 else f"{n_missing} treads are"
        message = (
            f"{text} missing or not seen between flight {other} and flight {own}, which may be one flight: no rise is "
            f"given for the lowest step of flight {own}, and no going for the highest of flight {other}"
        )
        return [Note("treads_missing", "flights", message)]
    tall = tall_foot(surfaces, run, is_allowed)
    if tall is None:
        return []
    rise_m, usual_m, may_be_missing = tall
    what = "the first riser is that tall"
    if may_be_missing:
        are_missing = "a tread is missing" if round(rise_m / usual_m) == 2 else "treads are missing or not seen"
        what = f"{are_missing} there or {what}, the scan does not show which"
    message = (
        f"the floor at the foot of the flight whose lowest step is at {surfaces[run[0].lower].height_m:.3f} m lies "
        f"{rise_m * 1000.0:.0f} mm below that step, {rise_m / usual_m:.1f} usual rises: {what}; no rise is given for it"
    )
    return [Note("foot_unclear" if may_be_missing else "foot_tall", "flights", message)]


def _chain(run: list[Link], has_base: bool) -> Chain:
    members = (run[0].lower, *(link.upper for link in run))
    climbs = np.array([link.climb for link in run])
    return Chain(
        base=members[0] if has_base else None,
        steps=members[1:] if has_base else members,
        climbs=freeze(climbs if has_base else np.concatenate([climbs[:1], climbs])),
        middles=freeze(np.array([link.middle for link in (run if has_base else [run[0], *run])])),
        lengths_m=tuple(link.length_m for link in (run if has_base else [run[0], *run])),
        n_missing=tuple(link.n_missing for link in run) if has_base else (0, *(link.n_missing for link in run)),
    )
