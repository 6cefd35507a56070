"""Which step of one scan is which of the other? The placing in which most nosings, landings and the floor agree."""

from dataclasses import dataclass

import numpy as np

from stair_inspector.comparison.epochs import Epoch
from stair_inspector.comparison.motions import RigidMotion, level_motion
from stair_inspector.errors import CannotMeasure
from stair_inspector.geometry.arrays import Floats
from stair_inspector.geometry.percentiles import median
from stair_inspector.geometry.plan import turn_deg

_NEAR_M = 0.03
"""How far apart the middles of one nosing may lie in a first placing: less than steps differ, more than they move."""
_UNLIKE, _FAR = 0.5, 0.5
"""What is taken off the count of steps for a tread on a landing, and for all nosings being as far off as they may."""
_LEAST_SHARE = 0.6
_FEWEST = 2


@dataclass(frozen=True, slots=True, eq=False)
class Matching:
    """Pairs of treads (earlier, later), by their places in the epochs, bottom to top; a first motion between them."""

    pairs: tuple[tuple[int, int], ...]
    motion: RigidMotion


def match_steps(before: Epoch, after: Epoch) -> Matching:
    """Match the steps of two scans.

    Each step of one laid onto each of the other gives a placing; that which most steps agree with is taken. A flight
    of even steps fits itself one step higher: its landings and the floor tell, and where they do not, nothing is said.

    Raises
    ------
    CannotMeasure
        Another stair, too little in common, or two placings that fit alike.
    """
    ours, theirs = _middles(before), _middles(after)
    # Without a floor no height is near to its: nan.
    our_floor, their_floor = median(before.floor[2]), median(after.floor[2])
    kinds = [tread.step.kind == "landing" for tread in before.treads]
    other_kinds = np.array([tread.step.kind == "landing" for tread in after.treads])
    placings: list[tuple[float, tuple[tuple[int, int], ...], RigidMotion]] = []
    for i, tread in enumerate(before.treads):
        for j, other in enumerate(after.treads):
            turn_rad = np.radians(turn_deg(other.climb, tread.climb))
            turned = level_motion(turn_rad, np.zeros(3))
            motion = RigidMotion(turned.turn, ours[i] - turned.turn @ theirs[j])
            moved = motion.moved(theirs.T).T
            gaps = np.linalg.norm(ours[:, None, :] - moved[None, :, :], axis=2)
            nearest = gaps.argmin(axis=1)
            pairs = tuple((k, int(nearest[k])) for k in range(len(ours)) if gaps[k, nearest[k]] <= _NEAR_M)
            is_floor = abs(their_floor + motion.shift_m[2] - our_floor) <= _NEAR_M
            # Of the placings by which the same steps agree, that one in which they lie nearest.
            gap = sum(float(gaps[pair]) for pair in pairs) / _NEAR_M / (len(pairs) + 1)
            # A landing of which one scan shows little may be called a tread.
            n_unlike = sum(kinds[k] != other_kinds[m] for k, m in pairs)
            score = len(pairs) - _UNLIKE * n_unlike + is_floor - _FAR * gap
            placings.append((score, pairs, motion))
    placings.sort(key=lambda placing: -placing[0])
    best, pairs, motion = placings[0]
    names = f"{before.inspection.scan.name} and {after.inspection.scan.name}"
    fewer = min(len(before.treads), len(after.treads))
    if len(pairs) < max(_FEWEST, _LEAST_SHARE * fewer):
        raise CannotMeasure(
            f"{names}: not the same stair, or too little in common: {len(pairs)} of {fewer} steps lie alike; give two "
            "scans that show the same steps"
        )
    for score, others, _ in placings[1:]:
        if score > best - 1.0 and 2 * len(set(others) & set(pairs)) < len(pairs):
            raise CannotMeasure(
                f"{names}: fit each other in two ways, a step apart; give scans that show the floor or a landing"
            )
    return Matching(pairs, motion)


def _middles(epoch: Epoch) -> Floats:
    """Return the middles (n, 3) of the nosings."""
    return np.array([tread.nosing.mean(axis=0) for tread in epoch.treads])
