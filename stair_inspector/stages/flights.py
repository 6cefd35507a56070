"""Which surfaces follow each other as the steps of a flight? Links between surfaces, runs of links, landings."""

import itertools
from collections.abc import Sequence

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.arrays import freeze
from stair_inspector.geometry.plan import angle_deg
from stair_inspector.model import Chain, Chains, Note, Patches, Surface
from stair_inspector.params import FlightsParams
from stair_inspector.stages.gaps import close_gaps
from stair_inspector.stages.links import Link, find_links
from stair_inspector.stages.missing_feet import run_below, tall_foot
from stair_inspector.stages.pace import SAME_CLIMB_DEG, going_between, is_base
from stair_inspector.stages.rejects import Forced, find_undersides, may_be_step
from stair_inspector.stages.run_ends import (
    ALTERNATIVE_RISE,
    begins_at_base,
    with_feet,
    with_missing_feet,
    with_short_last_edges,
    with_uneven_ends,
    with_weak_links,
)
from stair_inspector.stages.runs import LEAST_OVERLAP, longest_runs

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
    runs = with_feet(surfaces, longest_runs(links, params), links)
    runs = with_weak_links(
        with_uneven_ends(surfaces, runs), [link for link in every if link.length_m < priors.SHORTEST_EDGE_M], params
    )
    runs = with_short_last_edges(surfaces, runs, every, params)
    runs = close_gaps(surfaces, runs, is_allowed)
    runs = with_missing_feet(surfaces, with_feet(surfaces, runs, links), is_allowed, forced)
    pieces = [piece for run in runs for piece in _cut_at_landings(run, forced)]
    kept = [piece for piece in pieces if _is_flight(surfaces, piece, params, pieces)]
    kept.sort(key=lambda run: (surfaces[run[0].lower].height_m, run[0].lower))
    notes = [note for run in kept for note in _note_alternatives(surfaces, run, links)]
    longest = max((len(run) for run in runs), default=0)
    # What a flight climbs onto is where another one begins, however small it is.
    steps = {link.upper for piece in kept for link in piece}
    has_base = [run[0].lower in steps or begins_at_base(surfaces, run, forced) for run in kept]
    for run, is_based in zip(kept, has_base, strict=True):
        notes += [] if is_based else _note_foot(surfaces, run, kept, is_allowed)
    chains = tuple(_chain(run, is_based) for run, is_based in zip(kept, has_base, strict=True))
    return Chains(chains, tuple(notes), longest)


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
    if first.climb is not None and angle_deg(first.climb, second.climb) > SAME_CLIMB_DEG:
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
                and angle_deg(other.climb, link.climb) <= SAME_CLIMB_DEG
                and abs(other.rise_m - rise_m) <= ALTERNATIVE_RISE * rise_m
                and other.length_m >= LEAST_OVERLAP * link.length_m
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
