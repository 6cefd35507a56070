"""Which links follow each other best? The longest runs of even rises and goings."""

from collections.abc import Sequence

from stair_inspector import priors
from stair_inspector.geometry.plan import angle_deg, unit_way
from stair_inspector.params import FlightsParams
from stair_inspector.stages.links import Link
from stair_inspector.stages.pace import SAME_CLIMB_DEG

LEAST_OVERLAP = 0.5
"""Share of the shorter edge along which two edges of one step must face each other."""


def longest_runs(links: Sequence[Link], params: FlightsParams) -> list[list[Link]]:
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
            merit = consistency(links[other], links[k], params)
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


def consistency(first: Link, second: Link, params: FlightsParams) -> float:
    """Return how well two links follow each other, 0 for not at all, at most 1."""
    if first.climb is None or second.climb is None:
        return 0.0
    low, high = sorted((first.rise_m, second.rise_m))
    turn = angle_deg(first.climb, second.climb)
    if high > priors.MOST_UNEVEN * low or turn > params.turn_deg:
        return 0.0
    way = unit_way(first.climb + second.climb)
    move = second.middle - first.middle
    if way @ move < priors.SHORTEST_GOING_M:
        return 0.0
    if turn <= SAME_CLIMB_DEG and not edges_overlap(first, second, LEAST_OVERLAP):
        return 0.0
    return 1.0 - 0.5 * (high - low) / low - 0.2 * turn / params.turn_deg


def edges_overlap(first: Link, second: Link, share: float) -> bool:
    """Return whether two edges of a step, about parallel, face each other along a share of the shorter one."""
    if first.climb is None or second.climb is None:
        return False
    way = unit_way(first.climb + second.climb)
    move = second.middle - first.middle
    sideways = abs(float(move[0] * way[1] - move[1] * way[0]))
    return (first.length_m + second.length_m) / 2.0 - sideways >= share * min(first.length_m, second.length_m)
