"""Which way is up, if this is a staircase? The readings of its rhythm, and what speaks for each.

The faces of a stair are a stair again when it is turned upside down or laid on its back; so each rhythm is read in four
ways, and what staircases, files and cameras are like decides between them, or the user is asked.
"""

import math
from dataclasses import dataclass

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.arrays import Bools, Floats, project
from stair_inspector.geometry.lattice import Lattice, find_lattices
from stair_inspector.geometry.plan import cell_keys
from stair_inspector.stages.camera_frames import looks_down_deg
from stair_inspector.stages.reach import reach_of
from stair_inspector.stages.thinned import Thinned

LONGEST_PERIOD_M = 0.5
_SAME_DEG = 15.0
"""Directions that differ by less are one direction, found with more or less care."""

# Weights are natural logarithms of odds; a reading that leads by SURE is ten times as likely as the next.
SURE = 2.3
_WORST = -7.0
_Z_WEIGHTS = ((1.0, 5.0), (3.0, 4.0), (20.0, 2.0))
"""What it weighs that up is the file's z axis, to so many degrees: a levelled scanner writes z up, and exactly so."""
_AIR_FACTOR, _AIR_MOST = 2.0, 8.0
_AIR_START = 20.0
"""So many points on either side say nothing yet about which side of the stair is air."""
_WALL_REACH_M, _BEYOND_M = 0.15, 0.3
_RISER_REACH_M = 0.06
_FEWEST_RISER_POINTS = 10
_BESIDE_M, _THIN_M = 0.3, 0.008
_CLOSED = 0.1
"""Points in the middle of a riser's height, of those on a tread beside it: a third where all is seen."""
_NOSING_M, _NOSINGS_MOST = (0.01, 0.05), 6.0
"""Treads that reach past their risers by this are nosings."""
_SURROUNDINGS_MOST = 2.6
"""Floors below and rooms above speak for a side, but not against a scanner that was levelled."""
_HINT = 0.5
LEVELLED_DEG = 3.0
"""Scans whose z axis is as near as this to up were levelled by their scanner."""
_LEVELLED_COS = math.cos(math.radians(LEVELLED_DEG))
_FLOOR_LEAST, _FLOOR_MOST = -0.5, 1.5
_FLOOR_START = 200.0
_SENSOR_WEIGHT = 5.0
_LOOKS_DOWN_DEG = 35.0
_LOOKS_STRAIGHT_DOWN = -4.0
"""Cameras look ahead, or some way down: what a camera that looks straight down weighs."""
PLAN_CELL_M = 0.1
_FEWEST_OF_EITHER = 2
"""The sides of bars and the treads they form make a rhythm by chance, in which one face is the whole second family."""
_ON_RHYTHM, _MOSTLY_ON, _FEWEST_TREADS = 0.15, 0.7, 2
"""Level points that lie so near, in rises, to the rhythm's heights are of treads; by chance three in ten do."""


_Span = tuple[int, int, float, float]


@dataclass(frozen=True, slots=True, eq=False)
class Reading:
    """A rhythm read as a staircase: ``lattice`` with its ``up``, and the weight of what speaks for it."""

    lattice: Lattice
    weight: float

    @property
    def up(self) -> Floats:
        """The direction that is up in this reading, (3,)."""
        return self.lattice.up


def read_rhythm(scan: Thinned, max_rise_m: float, hint: Floats, *, is_camera: bool) -> list[Reading]:
    """Find the rhythm of a staircase and weigh its four readings, the best first; empty where there is none.

    Parameters
    ----------
    scan : Thinned
        Of a scan in metres.
    max_rise_m : float
        Rises up to it are as likely as usual ones where the user has widened it.
    hint : (3,)
        What else would be taken as up, which counts where nothing else speaks.
    is_camera : bool
        Whether the scan was taken from its origin, as :func:`is_view` says.
    """
    longest = max(LONGEST_PERIOD_M, max_rise_m)
    lattices = [
        lattice
        for lattice in find_lattices(scan.points, scan.normals, (priors.LEAST_RISE_M, longest))
        if min(lattice.rise_m, lattice.going_m) <= max(max_rise_m, priors.MOST_RISE_M)
        # A camera may see one tread only.
        and (is_camera or min(len(lattice.treads), len(lattice.risers)) >= _FEWEST_OF_EITHER)
    ]
    if not lattices:
        return []
    upright = lattices[0], lattices[0].turned()
    # The side of the air is one side of the faces, in every reading.
    spans = [_span(scan, lattice) for lattice in upright]
    airs = [_air_above(scan, lattice, span) for lattice, span in zip(upright, spans, strict=True)]
    air = float(np.clip(sum(airs), -_AIR_MOST, _AIR_MOST))
    readings = []
    for each, span, own_air in zip(upright, spans, airs, strict=True):
        # What is told by nosings and floors is told of these treads and risers, not of those that have changed places.
        nosings = _nosings(scan, each)
        side = _limited(air, own_air, nosings, each) + nosings + _surroundings(scan, each, span)
        floors = _floor_for(scan, each)
        for lattice, way in ((each, 1.0), (each.flipped(), -1.0)):
            weight = _as_built(lattice, max_rise_m) + (way * side + floors) / 2.0
            weight += _as_camera(scan, lattice) if is_camera else _as_file(lattice.up)
            if is_camera and _is_exactly_level(lattice.up):
                # Few cameras are level by chance, while a cloud may look like a view by chance: then it is asked.
                weight += 2.0 * _as_file(lattice.up)
            weight += _HINT if is_same_way(lattice.up, hint) and float(lattice.up @ hint) > 0.0 else 0.0
            readings.append(Reading(lattice, weight))
    return sorted(readings, key=lambda reading: -reading.weight)


def is_same_way(first: Floats, second: Floats) -> bool:
    """Return whether two directions are the same or opposite, but for the care with which they were found."""
    return abs(float(first @ second)) >= math.cos(math.radians(_SAME_DEG))


def _as_built(lattice: Lattice, max_rise_m: float) -> float:
    """Weigh rise and going: what staircases are like."""
    rise, going = lattice.rise_m, lattice.going_m
    pitch_deg = math.degrees(math.atan2(rise, going))
    if rise > max(max_rise_m, priors.COMMON_RISES_M[1]) + priors.RISE_SPREAD_M * 2.0 or going < priors.SHORTEST_GOING_M:
        return 2.0 * _WORST
    low, high = priors.COMMON_RISES_M
    high = max(high, max_rise_m) if max_rise_m > priors.MOST_RISE_M else high
    beyond = max(low - rise, rise - high, 0.0) / priors.RISE_SPREAD_M
    steep = (pitch_deg - priors.USUAL_PITCH_DEG) / priors.PITCH_SPREAD_DEG
    return max(_WORST, -(beyond**2 + steep**2) / 2.0)


def _as_file(up: Floats) -> float:
    """Weigh the file's z axis."""
    apart_deg = math.degrees(math.acos(min(1.0, max(-1.0, float(up[2])))))
    return next((weight for limit_deg, weight in _Z_WEIGHTS if apart_deg <= limit_deg), 0.0)


def _is_exactly_level(up: Floats) -> bool:
    return abs(float(up[2])) >= math.cos(math.radians(_Z_WEIGHTS[0][0]))


def _as_camera(scan: Thinned, lattice: Lattice) -> float:
    """Weigh where a camera at the origin would have been: before the risers, above the treads, looking ahead."""
    treads, risers = _faces_on(scan, lattice)
    sides = np.concatenate(
        [
            np.sign(-project(scan.points[treads].T, lattice.up)),
            np.sign(project(scan.points[risers].T, lattice.ahead)),
        ]
    )
    seen = float(sides.mean()) if len(sides) else 0.0
    down_deg = looks_down_deg(scan.points, lattice.up)
    straight = max(0.0, down_deg - _LOOKS_DOWN_DEG) / (90.0 - _LOOKS_DOWN_DEG)
    return _SENSOR_WEIGHT * seen + _LOOKS_STRAIGHT_DOWN * straight


def _faces_on(scan: Thinned, lattice: Lattice) -> tuple[Bools, Bools]:
    """Return which points face as treads do and which as risers do, near the stair."""
    ahead, above = _in_profile(scan, lattice)
    numbers = (*lattice.treads, *lattice.risers)
    is_near = (np.abs(above + 0.5) <= 0.8) & (ahead >= min(numbers) - 0.2) & (ahead <= max(numbers) + 1.2)
    turned = [scan.face(axis) for axis in (lattice.up, lattice.ahead)]
    return is_near & turned[0], is_near & turned[1]


def _in_profile(scan: Thinned, lattice: Lattice) -> tuple[Floats, Floats]:
    """Return how many goings ahead of the lattice's origin points lie, and how many rises above its line of nosings."""
    ahead, height = _in_lattice(scan, lattice)
    return ahead / lattice.going_m, height / lattice.rise_m - ahead / lattice.going_m


def _in_lattice(scan: Thinned, lattice: Lattice) -> tuple[Floats, Floats]:
    """Return how far ahead of the lattice's origin points lie, and how far above it, metres."""
    shifted = (scan.points - lattice.origin).T
    return project(shifted, lattice.ahead), project(shifted, lattice.up)


def _span(scan: Thinned, lattice: Lattice) -> _Span:
    """Return from where to where the faces seen reach ahead, in goings, and up, metres; both the same upside down.

    Upwards with the steps beyond the rhythm, which for a stair that turns is that of a part of it: beside the others
    its sides go on.
    """
    ahead = [k for tread in lattice.treads for k in (tread, tread + 1)] + list(lattice.risers)
    upwards = [k for riser in lattice.risers for k in (riser - 1, riser)] + list(lattice.treads)
    is_level = scan.face(lattice.up)
    low_m, high_m = reach_of(scan.points, is_level, lattice)
    return min(ahead), max(ahead), min(low_m, min(upwards) * lattice.rise_m), max(high_m, max(upwards) * lattice.rise_m)


def _limited(air: float, own_air: float, nosings: float, lattice: Lattice) -> float:
    """Return the weight of the air, which turns a levelled file over only as far as nosings say so too.

    Then what would be walls if treads and risers had changed places says nothing. Of a long stair, or of one that
    turns, the rhythm may be that of its upper part, below which its sides go on.
    """
    if abs(lattice.up[2]) < _LEVELLED_COS:
        return air
    most = _SURROUNDINGS_MOST + 2.0 * max(0.0, nosings * math.copysign(1.0, air))
    return float(np.clip(own_air, -most, most))


def _air_above(scan: Thinned, lattice: Lattice, span: _Span) -> float:
    """Weigh the walls beside the stair that go on above its highest tread against those below its lowest.

    One sees walls only through air. The sides of a stair of concrete end at its floor, as the walls above a stair do
    not end at its upper landing: there would be no headroom.
    """
    shifted = (scan.points - lattice.origin).T
    side = np.cross(lattice.up, lattice.ahead)
    ahead, height = project(shifted, lattice.ahead) / lattice.going_m, project(shifted, lattice.up)
    first, last, low_m, high_m = span
    is_wall = scan.face(side)
    is_wall &= np.abs(project(shifted, side)) <= lattice.width_m / 2.0 + _WALL_REACH_M
    is_wall &= (ahead >= first) & (ahead <= last)
    # Where a stair turns, risers face as walls do; none is as tall.
    is_wall[is_wall] = _is_tall(ahead[is_wall] * lattice.going_m, project(shifted[:, is_wall], side), height[is_wall])
    n_over = np.count_nonzero(is_wall & (height > high_m + _BEYOND_M))
    n_under = np.count_nonzero(is_wall & (height < low_m - _BEYOND_M))
    weight = math.log((n_over + _AIR_START) / (n_under + _AIR_START))
    return float(np.clip(_AIR_FACTOR * weight, -_AIR_MOST, _AIR_MOST))


def _is_tall(ahead_m: Floats, aside_m: Floats, height_m: Floats) -> Bools:
    """Return which points of upright faces lie in a place of the plan where those reach higher than a riser."""
    _, cell_of = np.unique(cell_keys(np.stack([ahead_m, aside_m]), PLAN_CELL_M), return_inverse=True)
    lowest, highest = np.full(len(cell_of), np.inf), np.full(len(cell_of), -np.inf)
    np.minimum.at(lowest, cell_of, height_m)
    np.maximum.at(highest, cell_of, height_m)
    is_tall: Bools = (highest - lowest)[cell_of] > priors.MOST_RISE_M + PLAN_CELL_M
    return is_tall


def _nosings(scan: Thinned, lattice: Lattice) -> float:
    """Weigh where treads reach past the risers: forward at a nosing, never back into the stair.

    Upside down, a stair with nosings has treads that go on behind the risers above them.
    """
    ahead, height = _in_lattice(scan, lattice)
    is_level, is_upright = (scan.face(axis) for axis in (lattice.up, lattice.ahead))
    n_front = n_back = 0
    for k in lattice.risers:
        from_riser, share = ahead - k * lattice.going_m, height / lattice.rise_m - k
        riser = from_riser[is_upright & (np.abs(from_riser) <= _RISER_REACH_M) & (np.abs(share + 0.5) <= 0.25)]
        if len(riser) < _FEWEST_RISER_POINTS:
            continue
        past = from_riser - float(np.median(riser))
        for level, way in ((0.0, -1.0), (-1.0, 1.0)):
            # Normals beside an edge lean, so heights say which points belong to the tread.
            tread = height[is_level & (np.abs(share - level) <= 0.2) & (np.abs(past) <= _BESIDE_M)]
            # Between open risers little is seen, and that is of something else.
            if len(tread) < _FEWEST_RISER_POINTS or len(riser) < _CLOSED * len(tread):
                continue
            is_on = np.abs(height - float(np.median(tread))) <= _THIN_M
            n_past = int(np.count_nonzero(is_on & (way * past >= _NOSING_M[0]) & (way * past <= _NOSING_M[1])))
            n_front, n_back = (n_front + n_past, n_back) if way < 0.0 else (n_front, n_back + n_past)
    weight = math.log((n_front + _AIR_START) / (n_back + _AIR_START))
    return float(np.clip(_AIR_FACTOR * weight, -_NOSINGS_MOST, _NOSINGS_MOST))


def _surroundings(scan: Thinned, lattice: Lattice, span: _Span) -> float:
    """Weigh what lies around: the floor is larger than the landing, and there is more above a stair than below it."""
    ahead, height = _in_lattice(scan, lattice)
    ahead, height = ahead / lattice.going_m, height / lattice.rise_m
    is_level = scan.face(lattice.up)
    first, last, low_m, high_m = span
    low, high = low_m / lattice.rise_m, high_m / lattice.rise_m
    n_floor = np.count_nonzero(is_level & (np.abs(height - low) <= 0.3) & (ahead < first))
    n_landing = np.count_nonzero(is_level & (np.abs(height - high) <= 0.3) & (ahead > last))
    beyond = _BEYOND_M / lattice.rise_m
    over, under = height > high + beyond, height < low - beyond
    n_over = 0 if _is_on_rhythm(height[over & (ahead > last) & is_level]) else np.count_nonzero(over)
    n_under = 0 if _is_on_rhythm(height[under & (ahead < first) & is_level]) else np.count_nonzero(under)
    # A landing may be the larger one, and a scan may begin at the foot of its stair.
    weight = math.log((n_floor + _FLOOR_START) / (n_landing + _FLOOR_START)) / 2.0
    weight += math.log((n_over + _FLOOR_START) / (n_under + _FLOOR_START))
    most = _SURROUNDINGS_MOST if abs(lattice.up[2]) >= _LEVELLED_COS else 2.0 * _SURROUNDINGS_MOST
    return float(np.clip(weight, -most, most))


def _is_on_rhythm(heights: Floats) -> bool:
    """Return whether level points, heights in rises, are treads of a flight that goes on: that tells no side.

    On a landing between two flights the climb goes on by the same rises.
    """
    steps = np.rint(heights)
    is_on = np.abs(heights - steps) <= _ON_RHYTHM
    counts = np.unique(steps[is_on], return_counts=True)[1]
    n_treads = int(np.count_nonzero(counts >= _FEWEST_RISER_POINTS))
    return n_treads >= _FEWEST_TREADS and float(is_on.mean()) >= _MOSTLY_ON


def _floor_for(scan: Thinned, lattice: Lattice) -> float:
    """Weigh the level surfaces beyond the stair against the upright: floors come without walls, not walls alone."""
    _, above = _in_profile(scan, lattice)
    level, upright = (
        np.count_nonzero(scan.face(axis) & (np.abs(above + 0.5) > 0.8)) for axis in (lattice.up, lattice.ahead)
    )
    weight = math.log((level + _FLOOR_START) / (upright + _FLOOR_START))
    return float(np.clip(weight, _FLOOR_LEAST, _FLOOR_MOST))
