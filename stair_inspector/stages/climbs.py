"""Which way does one climb at every step of a flight?"""

import itertools

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.arrays import Floats
from stair_inspector.geometry.plan import angle_deg, turn_deg, unit_way
from stair_inspector.model import Chain, Chains, StepShape
from stair_inspector.stages.arcs import climb_at_nosing, climb_on_arc


def flight_after(chains: Chains, number: int) -> int | None:
    """Return the number of the flight that goes straight on from the landing at the end of a flight, or None."""
    chain = chains.chains[number]
    for later in range(number + 1, len(chains.chains)):
        other = chains.chains[later]
        if other.base == chain.steps[-1] and angle_deg(other.climbs[-1], chain.climbs[-1]) <= priors.STRAIGHT_ON_DEG:
            return later
    return None


def straight_climb(chain: Chain) -> Floats | None:
    """Return the common direction of climb of a chain, (2,), or None where it winds."""
    # The edge on the floor may run all around the lowest tread.
    inner = chain.climbs[1:] if len(chain.climbs) > 2 and chain.base is not None else chain.climbs
    middle = unit_way(np.median(inner, axis=0))
    turns = [turn_deg(a, b) for a, b in itertools.pairwise(inner)]
    # One edge that is seen badly turns there and back again; a winding flight goes on turning the same way.
    sharp = [turn for turn in turns if abs(turn) > priors.WINDING_TURN_DEG]
    left, right = [turn for turn in sharp if turn > 0.0], [turn for turn in sharp if turn < 0.0]
    is_winding = max(len(left), len(right)) >= 2 and abs(sum(sharp)) > 2.0 * priors.WINDING_TURN_DEG
    return None if is_winding else middle


def find_climbs(chain: Chain, shapes: tuple[StepShape, ...]) -> list[Floats]:
    """Return the direction of climb at every step.

    One for a straight flight, that of the arc where it curves, each nosing's own where it winds.
    """
    if shapes[0].arc is not None:
        return [climb_on_arc(shapes[0].arc, shape) for shape in shapes]
    normals = [climb_at_nosing(shape) for shape in shapes]
    if straight_climb(chain) is None:
        return normals
    weights = np.array([1.0 / max(shape.front.slope_noise, 1e-4) ** 2 for shape in shapes])
    middle = np.median(normals, axis=0)
    is_alike = np.array([angle_deg(normal, middle) <= 2.0 for normal in normals])
    common = (weights * is_alike) @ np.array(normals) if is_alike.any() else middle
    return [unit_way(common)] * len(shapes)
