"""Which edges of a flight's steps are hidden? What the other steps show of an edge that one does not."""

import itertools
import math
from dataclasses import dataclass, replace

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.arrays import Floats
from stair_inspector.geometry.edges import EdgeLine
from stair_inspector.geometry.percentiles import mad_sigma
from stair_inspector.geometry.plan import left_of, turn_deg
from stair_inspector.model import Chain, StepShape
from stair_inspector.stages.arcs import SIDE_DIFFERS_M

UNSEEN_M = 0.03
"""Standard uncertainty of an edge of which only the rim of what was seen is known."""
_SAME_PLACE_M, _SAME_SIGMAS = 0.004, 3.0
"""Edges in one line: as exact as stairs are built, and as the noise of an edge allows."""
_DEEPEST_SHADOW_M = 0.15
"""More of a tread is not hidden by what leaves its riser to be seen."""
_FEWEST_OF_RHYTHM, _MOST_SCATTER_M = 3, 0.01
"""Nosings that are needed to tell where another one lies, and how much they may differ."""
_FEWEST_FOR_SIDES = 3
_SIDE_INSIDE_M, _INSIDE_SIGMAS = 0.01, 5.0
"""So much inside sides that agree with each other a side may be the rim of a shadow."""
_WEDGE_M = 0.05
"""Standard uncertainty of either end of a winder's nosing."""


@dataclass(frozen=True, slots=True)
class _Expected:
    """Where a nosing should lie in its step's frame, its standard uncertainty, and whether its own riser says so."""

    s_m: float
    noise_m: float
    is_own: bool


def with_doubtful_fronts(shapes: list[StepShape], chain: Chain, climb: Floats | None) -> list[StepShape]:
    """Doubt every nosing that is known by the end of its tread alone where those of most steps show their faces.

    The same scanner would have seen this one's too: something hides it, and the tread may go on behind that. How far is
    told by the riser below the nosing, which overhangs it as much as the flight's other nosings do theirs; else by
    where the rhythm of the flight's other nosings expects it.

    Parameters
    ----------
    shapes : list of StepShape
        From bottom to top.
    chain : Chain
        Of the same steps.
    climb : (2,) or None
        The common direction of climb of a flight that does not wind.
    """
    if 2 * sum(shape.front.source == "face" for shape in shapes) <= len(shapes):
        return shapes
    return [
        shape if shape.front.source == "face" else _with_checked_front(shape, _expect(shapes, k, chain, climb))
        for k, shape in enumerate(shapes)
    ]


def _with_checked_front(shape: StepShape, expected: _Expected | None) -> StepShape:
    """Hold a nosing that only its tread shows against where it should lie."""
    front = shape.front
    doubted = replace(front, noise_m=math.hypot(front.noise_m, UNSEEN_M), support=0.0)
    if expected is None:
        return replace(shape, front=doubted)
    is_guess = not front.support and not front.obstructed_m
    noise_m = UNSEEN_M if is_guess else front.free_noise_m
    # Positive where the tread seems to begin too far in.
    hidden_m = front.at(front.along_m) - expected.s_m
    if not is_guess and abs(hidden_m) <= max(_SAME_PLACE_M, _SAME_SIGMAS * math.hypot(noise_m, expected.noise_m)):
        # No shadow ends by chance just where the nosing has to lie.
        seen = replace(front, noise_m=math.hypot(noise_m, hidden_m / 2.0), support=1.0, obstructed_m=0.0)
        return replace(shape, front=seen)
    if expected.is_own and 0.0 < hidden_m <= _DEEPEST_SHADOW_M:
        # The riser was seen where the tread was not.
        moved = replace(front, middle_m=front.middle_m - hidden_m, noise_m=expected.noise_m, support=0.0)
        return replace(shape, front=replace(moved, obstructed_m=0.0))
    # A shadow may be deeper than what is usual: it reaches to where the nosing should lie.
    return replace(shape, front=replace(doubted, noise_m=math.hypot(doubted.noise_m, hidden_m / 2.0)))


def _expect(shapes: list[StepShape], k: int, chain: Chain, climb: Floats | None) -> _Expected | None:
    by_riser = _expect_by_riser(shapes, k)
    if by_riser is not None or climb is None:
        return by_riser
    numbers = np.cumsum(np.array(chain.n_missing) + 1)
    seen = [j for j, shape in enumerate(shapes) if shape.front.source == "face"]
    if len(seen) < _FEWEST_OF_RHYTHM:
        return None
    places = np.array([float(_middle_of(shapes[j]) @ climb) for j in seen])
    line = np.polyfit(numbers[seen], places, 1)
    scatter_m = float(np.std(places - np.polyval(line, numbers[seen]), ddof=2))
    if scatter_m > _MOST_SCATTER_M:
        return None
    place_m = float(np.polyval(line, numbers[k]))
    here = _middle_of(shapes[k])
    s_m, _ = shapes[k].from_plan(here + (place_m - float(here @ climb)) * climb)
    return _Expected(s_m, math.hypot(scatter_m, priors.BUILT_GOING_M), is_own=False)


def _expect_by_riser(shapes: list[StepShape], k: int) -> _Expected | None:
    """Return where a nosing lies if it overhangs its riser as the others of the flight overhang theirs."""
    own = _riser_of(shapes, k)
    if own is None:
        return None
    overhangs_m = [
        riser[0] - shape.front.at(shape.front.along_m)
        for j, shape in enumerate(shapes)
        if shape.front.source == "face" and (riser := _riser_of(shapes, j)) is not None
    ]
    if len(overhangs_m) < _FEWEST_OF_RHYTHM:
        return None
    usual_m = float(np.median(overhangs_m))
    scatter_m = mad_sigma(np.array(overhangs_m))
    if scatter_m > _MOST_SCATTER_M:
        return None
    s_m, noise_m = own
    return _Expected(s_m - usual_m, math.hypot(noise_m, scatter_m, priors.BUILT_OVERHANG_M), is_own=True)


def _riser_of(shapes: list[StepShape], k: int) -> tuple[float, float] | None:
    """Return where the face of the riser below a step's nosing was seen, in the step's frame, and its noise."""
    back = shapes[k - 1].back if k else None
    if back is None or back.source != "face":
        return None
    s_m, _ = shapes[k].from_plan(shapes[k - 1].to_plan(back.middle_m, back.along_m))
    return s_m, back.noise_m


def _middle_of(shape: StepShape) -> Floats:
    return shape.to_plan(shape.front.middle_m, shape.front.along_m)


def with_wedge_sides(shapes: list[StepShape], chain: Chain) -> list[StepShape]:
    """Doubt the sides of the steps of a winding flight, where it turns.

    The sides of a wedge are neither square to its nosing nor parallel, and its narrow end is hidden by those above. A
    step that is narrower than most may end in a shadow, at either side.
    """
    widths = [shape.left.middle_m - shape.right.middle_m for shape in shapes]
    usual_m = float(np.median(widths))
    result = []
    turns = [abs(turn_deg(a, b)) > priors.WINDING_TURN_DEG for a, b in itertools.pairwise(chain.climbs)]
    for k, (shape, width_m) in enumerate(zip(shapes, widths, strict=True)):
        is_wedge = any(turns[max(k - 1, 0) : k + 1])
        hidden_m = usual_m - width_m
        doubt_m, is_hidden = _WEDGE_M if is_wedge else 0.0, hidden_m > SIDE_DIFFERS_M
        if is_hidden:
            doubt_m = math.hypot(doubt_m, hidden_m / 2.0)
        changed = [
            replace(edge, noise_m=math.hypot(edge.noise_m, doubt_m), support=0.0 if is_hidden else edge.support)
            for edge in (shape.left, shape.right)
        ]
        result.append(replace(shape, left=changed[0], right=changed[1]))
    return result


def with_common_sides(shapes: list[StepShape], climb: Floats) -> list[StepShape]:
    """Compare every step's sides with those of its flight.

    A side that lies inside the others', and of which no face is seen, may be the rim of a shadow: its uncertainty grows
    until it reaches the others. Its value stays: a step may be narrower. A side at which something stands, but which
    lies in line with the others, is no rim of a shadow: posts hide as much of one tread as of no other. A side that was
    not seen is taken to be in line with those that were, as unsure as what was seen of the tread ends before. What goes
    up inside the sides of the steps below and above may be a box or a person: no wall narrows one step alone.
    """
    across = left_of(climb)
    origins = [float(shape.origin_m @ across) for shape in shapes]
    found = []
    for name, sign in (("left", 1.0), ("right", -1.0)):
        edges: list[EdgeLine] = [getattr(shape, name) for shape in shapes]
        places_m = [sign * (origin + edge.middle_m) for origin, edge in zip(origins, edges, strict=True)]
        side = _common_side(edges, np.array(places_m))
        checked = [
            _checked_side(edge, side, places_m[k], sign, _inmost_beside(places_m, k)) for k, edge in enumerate(edges)
        ]
        found.append((side, checked))
    (left, on_left), (right, on_right) = found
    if len(shapes) < _FEWEST_FOR_SIDES and not (left.is_blurred or right.is_blurred):
        return shapes
    result = []
    for k, (shape, origin) in enumerate(zip(shapes, origins, strict=True)):
        (to_left, hidden_left), (to_right, hidden_right) = on_left[k], on_right[k]
        low, high = shape.line_range
        if abs(hidden_left) > SIDE_DIFFERS_M and not left.is_blurred:
            high = left.place_m - origin
        if abs(hidden_right) > SIDE_DIFFERS_M and not right.is_blurred:
            low = -right.place_m - origin
        result.append(replace(shape, left=to_left, right=to_right, line_range=(low, high)))
    return result


def _inmost_beside(places_m: list[float], k: int) -> float:
    """Return the inner one of the sides of the steps below and above; at an end the line of the next two counts too."""
    near = [places_m[j] for j in (k - 1, k + 1) if 0 <= j < len(places_m)]
    if len(near) == 1 and len(places_m) > len(near) + 1:
        inner, farther = (places_m[1], places_m[2]) if k == 0 else (places_m[-2], places_m[-3])
        near.append(2.0 * inner - farther)
    return min(near, default=-math.inf)


@dataclass(frozen=True, slots=True)
class _Side:
    """Where the sides of a flight's steps lie, outwards from its middle, and how much they differ.

    ``scatter_m`` is None where too few of them agree; ``is_blurred`` tells that this may be for noise, and that the
    place is the outermost.
    """

    place_m: float
    scatter_m: float | None
    is_blurred: bool = False


def _common_side(edges: list[EdgeLine], places: Floats) -> _Side:
    """Return the usual place of sides, given where each lies outwards."""
    is_found = np.array([not _is_guess(edge) for edge in edges])
    place_m = float(np.median(places))
    found = places[is_found]
    middle_m = float(np.median(found)) if len(found) else place_m
    noises = np.array([edge.free_noise_m for edge in edges])[is_found]
    agrees = np.abs(found - middle_m) <= np.maximum(_SAME_PLACE_M, _SAME_SIGMAS * noises)
    n_agree = int(np.count_nonzero(agrees))
    if n_agree < _FEWEST_FOR_SIDES or 2 * n_agree <= len(found):
        # What noise cuts off a tread, it cuts off at another place than the next one's: none reaches too far.
        is_blurred = float(np.median([edge.free_noise_m for edge in edges])) > _SAME_PLACE_M
        return _Side(float(places.max()), None, True) if is_blurred else _Side(place_m, None)
    weights = 1.0 / np.maximum(noises[agrees], 0.5 * float(np.median(noises[agrees])) + 1e-6) ** 2
    mean_m = float(np.average(found[agrees], weights=weights))
    scatter_m = math.sqrt(float(np.average((found[agrees] - mean_m) ** 2, weights=weights)))
    return _Side(mean_m, scatter_m)


def _is_guess(edge: EdgeLine) -> bool:
    return not edge.support and not edge.obstructed_m


def _checked_side(edge: EdgeLine, side: _Side, place_m: float, sign: float, inmost_m: float) -> tuple[EdgeLine, float]:
    """Hold a side against those of its flight: return it, and how far inside them it lies.

    ``place_m`` is where it lies outwards, ``inmost_m`` the inner place of the sides of the steps below and above.
    """
    hidden_m = side.place_m - place_m
    if side.scatter_m is not None and edge.source == "tread":
        same_m = max(_SAME_PLACE_M, _SAME_SIGMAS * math.hypot(edge.free_noise_m, side.scatter_m))
        if edge.obstructed_m and abs(hidden_m) <= same_m:
            # Where the others agree, how far it is from them is all that an obstacle may have done.
            noise_m = math.hypot(edge.free_noise_m, hidden_m / 2.0)
            return replace(edge, noise_m=noise_m, support=1.0, obstructed_m=0.0), hidden_m
        if edge.obstructed_m and 0.0 < hidden_m <= SIDE_DIFFERS_M:
            return replace(edge, noise_m=math.hypot(edge.noise_m, hidden_m / 2.0)), hidden_m
        if _is_guess(edge) and abs(hidden_m) <= SIDE_DIFFERS_M:
            noise_m = math.hypot(side.scatter_m, hidden_m / 2.0, _SAME_PLACE_M / 2.0)
            return replace(edge, middle_m=edge.middle_m + sign * hidden_m, slope=0.0, noise_m=noise_m), 0.0
    limit_m = _SIDE_INSIDE_M + edge.noise_m if side.is_blurred else SIDE_DIFFERS_M + 4.0 * edge.noise_m
    if side.scatter_m is not None:
        limit_m = min(limit_m, _SIDE_INSIDE_M + _INSIDE_SIGMAS * math.hypot(edge.noise_m, side.scatter_m))
    is_of_a_thing = edge.is_wall and inmost_m - place_m > SIDE_DIFFERS_M
    if hidden_m > limit_m and (edge.source == "tread" or is_of_a_thing):
        edge = replace(edge, noise_m=math.hypot(edge.noise_m, hidden_m / 2.0), support=0.0)
    return edge, hidden_m
