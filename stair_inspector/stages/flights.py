"""Which surfaces follow each other as the steps of a flight? Links between surfaces, runs of links, landings."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from stair_inspector.geometry.arrays import Floats, freeze
from stair_inspector.model import Chain, Chains, Note, Patches, Surface
from stair_inspector.params import FlightsParams
from stair_inspector.stages.rejects import Forced, find_undersides, may_be_step

_MOST_UNEVEN = 1.6
"""Ratio of two rises that follow each other above which they do not belong to one flight."""
_SHORT_UNEVEN = 1.35
"""The same for two risers alone, which furniture imitates more easily than a longer flight."""
_SHORTEST_GOING_M = 0.1
LONGEST_TREAD_M = 0.62
"""A step that is deeper is a landing: no code's going is longer."""
_LANDING_RATIO = 1.8
"""A step that is this much deeper than the others of its flight is a landing too."""
_LEAST_CONTACT_M = 0.2
_LEAST_OVERLAP = 0.5
"""Share of the shorter edge along which two edges of one step must face each other."""
_BAND_CELLS = 2.5
_LOCAL_M = 0.3
_LEAN_M = 0.1
"""How far the mean heights of two surfaces may be from their heights at the edge between them."""
_COVERED_SHARE = 0.6
"""Where so much of a surface lies over another one, their common edge has no direction."""
_BASE_RATIO = 2.2
"""A surface this much larger than the one above it is a floor or landing from which a flight may begin anywhere."""
_STRAIGHT_DEG = 15.0
_CLIMB_TOLERANCE_DEG = 45.0
_MAX_MISSING = 3
_MISSING_TOLERANCE = 0.22
"""How far the gap over missing treads may be from a whole number of rises and goings, as a share of one."""
_PRESENT_SHARE = 0.4
_ALTERNATIVE_RISE = 0.25
_JOINED_WIDTH = 0.6
_SHORT_WIDTH_M = 0.45


@dataclass(frozen=True, slots=True, eq=False)
class Link:
    """Two surfaces that may be neighbours: their numbers, the lower one's height, the rise, and the edge between them.

    ``climb`` (2,) points from the lower to the upper, square to the edge; None where the edge has no direction.
    ``middle`` (2,) is the middle of the edge, ``length_m`` its length. ``n_missing`` treads lie between them unseen.
    """

    lower: int
    upper: int
    height_m: float
    rise_m: float
    climb: Floats | None
    middle: Floats
    length_m: float
    n_missing: int = 0


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
    climb = forced.climb
    wanted = forced.those("tread") | forced.those("landing")
    unwanted = forced.those("rejected")
    is_allowed = [
        k in wanted or (k not in unwanted and may_be_step(surface, least_area_m2))
        for k, surface in enumerate(patches.surfaces)
    ]
    for k in find_undersides(patches) - wanted:
        is_allowed[k] = False
    links = _find_links(patches, params, is_allowed)
    if climb is not None:
        links = [link for link in links if link.climb is None or angle_deg(link.climb, climb) <= _CLIMB_TOLERANCE_DEG]
    surfaces = patches.surfaces
    runs = _with_feet(surfaces, _longest_runs(links, params), links)
    runs = _bridge_missing(surfaces, runs, is_allowed)
    pieces = [piece for run in runs for piece in _cut_at_landings(run, forced)]
    kept = [piece for piece in pieces if _is_flight(surfaces, piece, params, pieces)]
    kept.sort(key=lambda run: (surfaces[run[0].lower].height_m, run[0].lower))
    notes = [note for run in kept for note in _note_alternatives(surfaces, run, links)]
    longest = max((len(run) for run in runs), default=0)
    # What a flight climbs onto is where another one begins, however small it is.
    steps = {link.upper for piece in kept for link in piece}
    chains = tuple(_chain(run, run[0].lower in steps or _is_base(surfaces, run)) for run in kept)
    return Chains(chains, tuple(notes), longest)


def depth_along(surface: Surface, direction: Floats) -> float:
    """Return how far a surface extends in a direction of the plan, metres, but for its outermost cells."""
    low, high = np.percentile(direction @ surface.cells_m, [2.0, 98.0])
    return float(high - low)


def angle_deg(a: Floats, b: Floats) -> float:
    """Return the angle between two directions of the plan, degrees, 0 to 180."""
    return abs(turn_deg(a, b))


def turn_deg(a: Floats, b: Floats) -> float:
    """Return the turn from one direction of the plan to another, degrees, positive to the left."""
    return math.degrees(math.atan2(float(a[0] * b[1] - a[1] * b[0]), float(a @ b)))


def _find_links(patches: Patches, params: FlightsParams, is_allowed: Sequence[bool]) -> list[Link]:
    """Return all pairs of surfaces a riser apart in height that touch in plan, or nearly."""
    from sklearn.neighbors import KDTree

    surfaces = patches.surfaces
    ids = sorted((k for k in range(len(surfaces)) if is_allowed[k]), key=lambda k: surfaces[k].height_m)
    boxes = {k: (surfaces[k].cells_m.min(axis=1), surfaces[k].cells_m.max(axis=1)) for k in ids}
    trees: dict[int, Any] = {}
    links = []
    for position, lower in enumerate(ids):
        for upper in ids[position + 1 :]:
            if surfaces[upper].height_m - surfaces[lower].height_m > params.max_rise_m + _LEAN_M:
                break
            reach = params.max_gap_m + 2.0 * patches.cell_m
            (low_a, high_a), (low_b, high_b) = boxes[lower], boxes[upper]
            if (low_a > high_b + reach).any() or (low_b > high_a + reach).any():
                continue
            for k in (lower, upper):
                if k not in trees:
                    trees[k] = KDTree(surfaces[k].cells_m.T)
            link = _link(patches, params, (lower, upper), trees)
            if link is not None:
                links.append(link)
    return links


def _link(patches: Patches, params: FlightsParams, pair: tuple[int, int], trees: dict[int, Any]) -> Link | None:
    lower, upper = pair
    below, above = patches.surfaces[lower], patches.surfaces[upper]
    cell_m = patches.cell_m
    reach = params.max_gap_m + 2.0 * cell_m
    to_below = trees[lower].query(above.cells_m.T)[0][:, 0]
    gap = float(to_below.min())
    # Cells that touch have their means about a cell apart.
    if gap > reach:
        return None
    to_above = trees[upper].query(below.cells_m.T)[0][:, 0]
    band = gap + _BAND_CELLS * cell_m
    front, back = above.cells_m[:, to_below <= band], below.cells_m[:, to_above <= band]
    along, middle, length_m = _common_edge(front, back)
    # Large surfaces may lean: their mean heights are no measure of the riser between them.
    rise_m = _height_at(above, middle) - _height_at(below, middle)
    if length_m < _LEAST_CONTACT_M or not params.min_rise_m <= rise_m <= params.max_rise_m:
        return None
    is_covered = np.count_nonzero(to_below <= 1.5 * cell_m) > _COVERED_SHARE * above.cells_m.shape[1]
    is_base = below.area_m2 > _BASE_RATIO * above.area_m2
    if is_covered and not is_base:
        return None
    climb: Floats | None = None
    if not is_covered:
        climb = np.array([-along[1], along[0]])
        ahead = _local_mean(above.cells_m, middle) - _local_mean(below.cells_m, middle)
        if climb @ ahead < 0.0:
            climb = -climb
    return Link(lower, upper, below.height_m, rise_m, climb, middle, length_m)


def _height_at(surface: Surface, plan: Floats) -> float:
    return float(surface.centre_m[2] + surface.slope @ (plan - surface.centre_m[:2]))


def _common_edge(front: Floats, back: Floats) -> tuple[Floats, Floats, float]:
    """Return the direction, the middle and the length of the edge along which cells of two surfaces face each other."""
    edge = np.concatenate([front, back], axis=1)
    middle = edge.mean(axis=1)
    shift = edge - middle[:, None]
    axis: Floats = np.linalg.eigh(np.einsum("in,jn->ij", shift, shift))[1][:, 1]
    # Over a gap, cells beyond the end of the other surface are near enough too, but face nothing.
    spans = [np.percentile(axis @ (cells - middle[:, None]), [2.0, 98.0]) for cells in (front, back)]
    low, high = max(spans[0][0], spans[1][0]), min(spans[0][1], spans[1][1])
    return axis, middle + axis * float(low + high) / 2.0, float(high - low)


def _local_mean(cells: Floats, middle: Floats) -> Floats:
    near = np.hypot(*(cells - middle[:, None])) <= _LOCAL_M
    mean: Floats = cells[:, near].mean(axis=1) if near.any() else cells.mean(axis=1)
    return mean


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
    turn_deg = angle_deg(first.climb, second.climb)
    if high > _MOST_UNEVEN * low or turn_deg > params.turn_deg:
        return 0.0
    way = first.climb + second.climb
    way /= np.hypot(*way)
    move = second.middle - first.middle
    if way @ move < _SHORTEST_GOING_M:
        return 0.0
    if turn_deg <= _STRAIGHT_DEG:
        sideways = abs(float(move[0] * way[1] - move[1] * way[0]))
        shorter = min(first.length_m, second.length_m)
        if (first.length_m + second.length_m) / 2.0 - sideways < _LEAST_OVERLAP * shorter:
            return 0.0
    return 1.0 - 0.5 * (high - low) / low - 0.2 * turn_deg / params.turn_deg


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
    if first.climb is None or depth_along(surfaces[first.lower], first.climb) > LONGEST_TREAD_M:
        return run
    rise_m = float(np.median([link.rise_m for link in run]))
    candidates = [
        link
        for link in links
        if link.upper == first.lower
        and surfaces[link.lower].area_m2 > _BASE_RATIO * surfaces[link.upper].area_m2
        and max(link.rise_m, rise_m) <= _MOST_UNEVEN * min(link.rise_m, rise_m)
    ]
    if not candidates:
        return run
    foot = min(candidates, key=lambda link: abs(link.rise_m - rise_m))
    # Its own edge may run all around the tread: the flight's first step says which way is up.
    foot = replace(foot, climb=first.climb)
    return [foot, *run] if _going_of(foot, first) >= _SHORTEST_GOING_M else run


def _is_base(surfaces: Sequence[Surface], run: Sequence[Link]) -> bool:
    """Return whether a run begins at a floor or landing and not at a tread."""
    first = run[0]
    if first.climb is None:
        return True
    depth_m = depth_along(surfaces[first.lower], first.climb)
    treads = [surfaces[link.upper].area_m2 for link in run]
    return depth_m > LONGEST_TREAD_M or surfaces[first.lower].area_m2 > _BASE_RATIO * float(np.median(treads))


def _bridge_missing(
    surfaces: Sequence[Surface], runs: list[list[Link]], is_allowed: Sequence[bool]
) -> list[list[Link]]:
    """Join runs between which a tread or two are missing: the gap is a whole number of rises and of goings."""
    runs = sorted(runs, key=lambda run: surfaces[run[0].lower].height_m)
    k = 0
    while k < len(runs):
        for other in runs[k + 1 :]:
            bridge = _bridge(surfaces, runs[k], other, is_allowed)
            if bridge is not None:
                runs[k] = [*runs[k], bridge, *other]
                runs = [run for run in runs if run is not other]
                break
        else:
            k += 1
    return runs


def _bridge(surfaces: Sequence[Surface], low: list[Link], high: list[Link], is_allowed: Sequence[bool]) -> Link | None:
    """Return the link over missing treads from the top of one run to the bottom of another, or None."""
    top, bottom = low[-1], high[0]
    both = [*low, *high]
    if top.climb is None or bottom.climb is None or len(both) < 2:
        return None
    if angle_deg(top.climb, bottom.climb) > _STRAIGHT_DEG or _is_base(surfaces, high):
        return None
    rise_m = float(np.median([link.rise_m for link in both]))
    goings = [
        float((second.middle - first.middle) @ first.climb)
        for run in (low, high)
        for first, second in itertools.pairwise(run)
        if first.climb is not None
    ]
    if not goings:
        return None
    going_m = float(np.median(goings))
    below, above = surfaces[top.upper], surfaces[bottom.lower]
    gap_m = above.height_m - below.height_m
    n_steps = round(gap_m / rise_m)
    if not 2 <= n_steps <= _MAX_MISSING + 1 or abs(gap_m - n_steps * rise_m) > _MISSING_TOLERANCE * rise_m:
        return None
    # From the riser under the lower tread to the one over the upper: that many goings and one more.
    move = bottom.middle - top.middle
    along = float(move @ top.climb)
    sideways = abs(float(move[0] * top.climb[1] - move[1] * top.climb[0]))
    expected = (n_steps + 1) * going_m
    if abs(along - expected) > 2.0 * _MISSING_TOLERANCE * going_m or sideways > 0.5 * min(
        top.length_m, bottom.length_m
    ):
        return None
    for k in range(1, n_steps):
        place = top.middle + (k + 0.5) * going_m * top.climb
        wanted_m = below.height_m + k * rise_m
        if any(
            is_allowed[number]
            and abs(surface.height_m - wanted_m) <= _PRESENT_SHARE * rise_m
            and float(np.hypot(*(surface.cells_m - place[:, None])).min()) <= _PRESENT_SHARE * going_m
            for number, surface in enumerate(surfaces)
        ):
            # The tread is there: what is missing is a reason to take these two runs for one flight.
            return None
    middle = top.middle + move * (0.5 if along <= 0.0 else 1.0 - going_m / along)
    return Link(top.upper, bottom.lower, below.height_m, gap_m, top.climb, middle, top.length_m, n_steps - 1)


def _cut_at_landings(run: list[Link], forced: Forced) -> list[list[Link]]:
    """Cut a run at every landing inside it, which ends one piece and begins the next."""
    depths = [_going_of(first, second) for first, second in itertools.pairwise(run)]
    if not depths:
        return [run]
    usual_m = float(np.median(depths))
    pieces = [[run[0]]]
    for link, previous, depth_m in zip(run[1:], run[:-1], depths, strict=True):
        is_deep = depth_m > LONGEST_TREAD_M or depth_m > _LANDING_RATIO * usual_m
        # Where a tread is missing, the step below it only looks deep.
        is_deep = is_deep and not link.n_missing and not previous.n_missing
        kind = forced.kinds.get(link.lower)
        if kind == "landing" or (is_deep and kind != "tread"):
            pieces.append([])
        pieces[-1].append(link)
    return pieces


def _going_of(first: Link, second: Link) -> float:
    """Return the depth of the step between two links."""
    if first.climb is None:
        return 0.0
    return float((second.middle - first.middle) @ first.climb)


def _is_flight(
    surfaces: Sequence[Surface], run: list[Link], params: FlightsParams, pieces: Sequence[list[Link]]
) -> bool:
    """Return whether a run is a flight by itself, or one that a landing joins to another."""
    n_risers = len(run)
    if n_risers >= max(3, params.min_risers):
        return True
    if any(_is_joined(run, other) for other in pieces if other is not run and len(other) >= max(3, params.min_risers)):
        return True
    if n_risers < params.min_risers:
        return False
    if n_risers == 1:
        return True
    # Two risers are what furniture imitates most easily: a heap of boxes has no common width and direction.
    first, second = run
    if not _is_base(surfaces, run) or second.climb is None or second.length_m < _SHORT_WIDTH_M:
        return False
    if first.climb is not None and angle_deg(first.climb, second.climb) > _STRAIGHT_DEG:
        return False
    low, high = sorted((first.rise_m, second.rise_m))
    tread = surfaces[first.upper]
    depth_m = _going_of(first, second)
    evenly_wide = min(first.length_m, second.length_m) >= 0.7 * max(first.length_m, second.length_m)
    is_filled = tread.area_m2 >= 0.5 * depth_m * min(first.length_m, second.length_m)
    return high <= _SHORT_UNEVEN * low and 0.15 <= depth_m <= LONGEST_TREAD_M and evenly_wide and is_filled


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
                and angle_deg(other.climb, link.climb) <= _STRAIGHT_DEG
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
