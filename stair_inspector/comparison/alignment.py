"""The motion that lays the later scan onto the earlier one: on floor, treads and risers that did not move.

Heights and tilts follow from treads and floor, places and the turn in plan from risers, nosings and sides. The two are
solved in turn, each by the largest group of parts that agrees.
"""

import math
from dataclasses import dataclass

import numpy as np

from stair_inspector.comparison.cells import floor_change, tread_change
from stair_inspector.comparison.consensus import Consensus, PartMotion, find_consensus
from stair_inspector.comparison.epochs import Epoch, Tread, surface_doubts, systematic
from stair_inspector.comparison.matching import Matching
from stair_inspector.comparison.motions import RigidMotion, about
from stair_inspector.comparison.surfaces import PlaneChange, own_covariance, own_doubt, plane_change, riser_line
from stair_inspector.errors import CannotMeasure
from stair_inspector.geometry.arrays import Floats
from stair_inspector.geometry.plan import left_of
from stair_inspector.model import COVERAGE_FACTOR, EpochAlignment

_PASSES = 3
_FLOOR_SHARE = 0.5
"""What the floor weighs in the choice of what did not move, in shares of all treads: floors move less than flights."""
_FEWEST_STEADY = 2
_EDGE_PARTS = ("noise", "edge", "resolution", "layers", "registration")


@dataclass(frozen=True, slots=True, eq=False)
class Aligned:
    """A motion between level frames, what it rests on, and the surfaces under it.

    ``upright`` is the consensus on heights and tilts about ``centre_m`` (3,), ``in_plan`` that on shifts and the turn;
    ``planes`` the changes of the treads, pair by pair, None where too little was seen; ``floor`` that of the floor.
    ``is_steady`` tells which pairs agree, ``is_floor_steady`` whether the floor does.
    """

    motion: RigidMotion
    centre_m: Floats
    upright: Consensus
    in_plan: Consensus
    planes: tuple[PlaneChange | None, ...]
    floor: PlaneChange | None
    is_steady: tuple[bool, ...]
    is_floor_steady: bool


def align(before: Epoch, after: Epoch, matching: Matching) -> Aligned:
    """Lay the later scan onto the earlier one.

    Raises
    ------
    CannotMeasure
        Too few surfaces agree on one motion, so that nothing can be said to have stayed.
    """
    pairs = [(before.treads[i], after.treads[j]) for i, j in matching.pairs]
    centre = np.array([*np.mean([ours.corners.mean(axis=0) for ours, _ in pairs], axis=0), 0.0])
    centre[2] = float(np.mean([ours.nosing[:, 2].mean() for ours, _ in pairs]))
    motion, in_plan = matching.motion, None
    names = f"{before.inspection.scan.name} and {after.inspection.scan.name}"
    for _ in range(_PASSES):
        planes, floor = _planes(before, after, pairs, motion)
        upright = _upright(planes, floor, centre)
        if upright is None:
            raise CannotMeasure(
                f"{names}: too little of treads and floor is seen in both scans to lay them onto each other"
            )
        a, b, c = upright.motion
        # The later surface lies higher by a + b x + c y: it is laid back.
        motion = motion.then(about(centre, np.array([-c, b, 0.0]), np.array([0.0, 0.0, -a])))
        in_plan = _in_plan(before, after, pairs, motion, centre)
        if in_plan is None:
            raise CannotMeasure(f"{names}: neither risers nor nosings tell how they lie onto each other in plan")
        x, y, turn = in_plan.motion
        motion = motion.then(about(centre, np.array([0.0, 0.0, -turn]), np.array([-x, -y, 0.0])))
    planes, floor = _planes(before, after, pairs, motion)
    upright = _upright(planes, floor, centre)
    if upright is None or in_plan is None or np.count_nonzero(upright.is_steady) < _FEWEST_STEADY:
        raise CannotMeasure(f"{names}: no two surfaces lie alike in both scans, so nothing can be said to have stayed")
    a, b, c = upright.motion
    motion = motion.then(about(centre, np.array([-c, b, 0.0]), np.array([0.0, 0.0, -a])))
    # Which surfaces the consensus is of: another cell more or less may be seen under the last motion.
    seen = [k for k, plane in enumerate(planes) if plane is not None]
    steady = [False] * len(pairs)
    for k, is_in in zip(seen, upright.is_steady, strict=False):
        steady[k] = bool(is_in)
    is_floor = floor is not None and bool(upright.is_steady[-1])
    planes, floor = _planes(before, after, pairs, motion)
    return Aligned(motion, centre, upright, in_plan, planes, floor, tuple(steady), is_floor)


def height_noise(aligned: Aligned, plan: Floats) -> float:
    """Return the standard uncertainty of a height at a place of the plan (2,) that the alignment brings, metres."""
    row = np.array([1.0, *(plan - aligned.centre_m[:2])])
    return math.sqrt(max(0.0, float(row @ aligned.upright.covariance @ row)))


def alignment_of(before: Epoch, after: Epoch, aligned: Aligned, matching: Matching) -> EpochAlignment:
    """Return the alignment in local scan axes, with its uncertainty."""
    ours, theirs, motion = before.level_from_scan, after.level_from_scan, aligned.motion
    treads = [before.treads[i] for i, _ in matching.pairs]
    climb = _mean_climb(treads)
    along, across = np.array([0.0, *climb]), np.array([0.0, *left_of(climb)])
    upright, plan = aligned.upright.covariance, aligned.in_plan.covariance
    u_m = COVERAGE_FACTOR * max(height_noise(aligned, tread.corners.mean(axis=0)) for tread in treads)
    parts = (
        ("height_m", COVERAGE_FACTOR * math.sqrt(float(upright[0, 0]))),
        ("tilt_along_deg", COVERAGE_FACTOR * math.degrees(math.sqrt(float(along @ upright @ along)))),
        ("tilt_across_deg", COVERAGE_FACTOR * math.degrees(math.sqrt(float(across @ upright @ across)))),
        ("shift_along_m", COVERAGE_FACTOR * math.sqrt(float(climb @ plan[:2, :2] @ climb))),
        ("shift_across_m", COVERAGE_FACTOR * math.sqrt(float(left_of(climb) @ plan[:2, :2] @ left_of(climb)))),
        ("turn_deg", COVERAGE_FACTOR * math.degrees(math.sqrt(float(plan[2, 2])))),
    )
    steady = tuple(tread.step.step_id for tread, is_in in zip(treads, aligned.is_steady, strict=True) if is_in)
    return EpochAlignment(
        ours.T @ motion.turn @ theirs,
        ours.T @ motion.shift_m,
        steady,
        aligned.is_floor_steady,
        u_m,
        parts,
        upright,
        aligned.centre_m[:2],
    )


def _planes(
    before: Epoch, after: Epoch, pairs: list[tuple[Tread, Tread]], motion: RigidMotion
) -> tuple[tuple[PlaneChange | None, ...], PlaneChange | None]:
    """Return the changes of the planes of the treads and of the floor under a motion."""
    steps, others = (tuple(pair[k].step for pair in pairs) for k in (0, 1))
    planes = []
    own = np.zeros((3, 3))
    for ours, theirs in pairs:
        own = own_covariance(ours, theirs, steps, others)
        planes.append(plane_change(tread_change(before, ours, after, theirs, motion), own))
    first, second = pairs[0]
    own = own_covariance(first, second, steps, others)
    floor = floor_change(before, after, motion)
    seen = floor.grid.middles()[:, np.isfinite(floor.deviation_m)]
    if not seen.size:
        return tuple(planes), None
    # One surface is seen from the same stations all over: its height at one end against the other is as sure as a rise.
    nearby = math.hypot(*(systematic(surface_doubts(*each)) for each in ((first.step, steps), (second.step, others))))
    length_m = max(float(np.ptp(seen, axis=1).max()), 1e-3)
    own[1:, 1:] = np.eye(2) * (nearby / length_m) ** 2
    return tuple(planes), plane_change(floor, own)


def _upright(planes: tuple[PlaneChange | None, ...], floor: PlaneChange | None, centre: Floats) -> Consensus | None:
    """Return the height and the tilts (3,) on which most surfaces agree; the floor is the last part."""
    known = [plane for plane in planes if plane is not None]
    parts = [_plane_part(plane, centre, 1.0) for plane in known]
    n = len(parts)
    seeds: list[tuple[int, ...]] = [(k, k + 1, k + 2) for k in range(n - 2)] + [(k,) for k in range(n)]
    if floor is not None:
        parts.append(_plane_part(floor, centre, 1.0 + _FLOOR_SHARE * n))
        seeds += [(k, n) for k in range(n)] + [(n,)]
    return find_consensus(parts, seeds)


def _plane_part(plane: PlaneChange, centre: Floats, weight: float) -> PartMotion:
    x, y = plane.middle_m - centre[:2]
    rows = np.array([[1.0, x, y], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    return PartMotion(rows, plane.change, plane.covariance, weight)


def _in_plan(
    before: Epoch, after: Epoch, pairs: list[tuple[Tread, Tread]], motion: RigidMotion, centre: Floats
) -> Consensus | None:
    """Return the shift and the turn (3,) on which most risers, or nosings without them, and sides agree."""
    parts: list[PartMotion] = []
    for ours, theirs in pairs:
        moved = motion.moved_tread(theirs)
        edge = math.hypot(*(own_doubt(tread.step.going_m, _EDGE_PARTS) for tread in (ours, theirs)))
        registered = math.hypot(*(own_doubt(tread.step.rise_m, ("registration", "layers")) for tread in (ours, theirs)))
        one, two = riser_line(before, ours), riser_line(after, theirs)
        if one is not None and two is not None:
            place = motion.moved(np.array([[*two.middle, theirs.nosing[0, 2]]]).T)[:2, 0]
            facing = (motion.turn @ np.array([*two.facing, 0.0]))[:2]
            apart = float((place - one.middle) @ one.facing)
            turned = float(one.facing[0] * facing[1] - one.facing[1] * facing[0])
            noise = math.hypot(one.noise_m, two.noise_m, registered)
            turn_noise = math.hypot(one.turn_noise_rad, two.turn_noise_rad)
            parts.append(_line_part(one.middle, one.facing, centre, apart, noise, (turned, turn_noise)))
        elif edge:
            middle = ours.nosing[:, :2].mean(axis=0)
            apart = float((moved.nosing[:, :2].mean(axis=0) - middle) @ ours.climb)
            parts.append(_line_part(middle, ours.climb, centre, apart, edge, None))
        side = math.hypot(*(own_doubt(tread.step.width_m, _EDGE_PARTS) for tread in (ours, theirs)))
        if side:
            middle = ours.nosing[:, :2].mean(axis=0)
            left = left_of(ours.climb)
            apart = float((moved.nosing[:, :2].mean(axis=0) - middle) @ left)
            # The middle between two sides is half as uncertain as their distance.
            parts.append(_line_part(middle, left, centre, apart, side / math.sqrt(2.0), None))
    return find_consensus(
        parts, [tuple(range(start, min(start + 4, len(parts)))) for start in range(max(1, len(parts) - 3))]
    )


def _line_part(
    place: Floats, facing: Floats, centre: Floats, apart: float, noise: float, turn: tuple[float, float] | None
) -> PartMotion:
    """Return what a line of the plan tells: how far it moved in the direction it faces, and how it turned."""
    arm = left_of(place - centre[:2])
    rows = [[facing[0], facing[1], float(arm @ facing)]]
    values, variances = [apart], [noise * noise]
    if turn is not None:
        rows.append([0.0, 0.0, 1.0])
        values.append(turn[0])
        variances.append(turn[1] * turn[1])
    return PartMotion(np.array(rows), np.array(values), np.diag(variances))


def _mean_climb(treads: list[Tread]) -> Floats:
    """Return the direction of climb of the whole, or that of the first step where the stair turns back."""
    mean = np.sum([tread.climb for tread in treads], axis=0)
    length = float(np.hypot(*mean))
    climb: Floats = mean / length if length > 0.5 else treads[0].climb
    return climb
