"""The rhythm of a staircase: treads and riser faces that come again after one going and one rise.

Strict in its rhythm, permissive in its surfaces: a lattice says where treads and risers are to be looked for, how many
its rhythm expects and how many were seen; it measures nothing.
"""

import itertools
import math
from dataclasses import dataclass, replace

import numpy as np

from stair_inspector.geometry.arrays import Bools, Floats, own, project, scatter_of
from stair_inspector.geometry.rhythms import BIN_M, Rhythm, fill_profile, find_periods, place_rhythm

_MOST_BINS = 1024
_FACES_DEG = 25.0
_FINE_DEG = 8.0
_SQUARE_DEG = 15.0
"""Treads and risers are square to each other; normals of small faces beside edges say so only as well as this."""
_MODES = 5
_SEEDS = 400
_FEWEST_POINTS = 40
_MODE_SHARE = 0.02
_FEWEST_FACES = 2
_FEWEST_JOINTS = 3
_MANY_FACES, _FEWEST_JOINTS_OF_MANY = 6, 2
"""A camera that looks along the treads sees many risers and one tread."""


@dataclass(frozen=True, slots=True, eq=False)
class Lattice:
    """A rhythm of two families of faces that are square to each other.

    Read as a staircase that climbs along ``ahead`` with up along ``up``: face k of the first family, a tread, lies at
    ``origin + k (going ahead + rise up)`` and reaches from there ``going_m`` ahead; face k of the second, a riser,
    ends there and reaches ``rise_m`` down. The same faces are a stair in three more readings: upside down
    (``-up``, ``-ahead``), and on their back, with treads and risers changed (up ``-ahead``, ahead ``-up``; up
    ``ahead``, ahead ``up``), rise and going changed likewise.

    ``up`` and ``ahead`` (3,) unit vectors; ``origin`` (3,) where the nosing of tread 0 is, in the middle of the width;
    ``width_m`` of what was seen. ``treads`` and ``risers`` are the numbers k of the faces that were seen and end where
    the rhythm says; ``levels`` and ``walls`` those that were seen and run on, as floors, landings and walls do.
    ``joints`` counts the edges at which a face of each family was seen, ``n_points`` the points of all these faces.
    """

    up: Floats
    ahead: Floats
    rise_m: float
    going_m: float
    origin: Floats
    width_m: float
    treads: tuple[int, ...]
    risers: tuple[int, ...]
    levels: tuple[int, ...]
    walls: tuple[int, ...]
    joints: int
    n_points: int

    @property
    def score(self) -> float:
        """How much speaks for the rhythm: faces and the edges between them."""
        return len(self.treads) + len(self.risers) + self.joints

    def turned(self) -> "Lattice":
        """Return the same faces read with treads and risers changed."""
        # Riser k rises behind tread k-1; turned, tread -k lies before riser -k+1.
        return replace(
            self,
            up=own(-self.ahead, (3,), "up"),
            ahead=own(-self.up, (3,), "ahead"),
            rise_m=self.going_m,
            going_m=self.rise_m,
            treads=_counted_back(self.risers),
            risers=_counted_back(self.treads),
            levels=_counted_back(self.walls),
            walls=_counted_back(self.levels),
        )

    def flipped(self) -> "Lattice":
        """Return the same faces read upside down."""
        # Tread k becomes the tread before which riser -k was.
        return replace(
            self,
            up=own(-self.up, (3,), "up"),
            ahead=own(-self.ahead, (3,), "ahead"),
            origin=own(self.origin + self.going_m * self.ahead, (3,), "origin"),
            treads=_counted_back(self.treads),
            risers=_counted_back(self.risers, first=1),
            levels=_counted_back(self.levels),
            walls=_counted_back(self.walls, first=1),
        )


def _counted_back(numbers: tuple[int, ...], first: int = 0) -> tuple[int, ...]:
    return tuple(sorted(first - k for k in numbers))


def find_modes(normals: Floats) -> list[Floats]:
    """Return the most frequent directions of unit normals (n, 3), sign free, the most frequent first.

    The points should be thinned to an even density, so that frequent means much surface.
    """
    cosine = math.cos(math.radians(_FACES_DEG))
    fine = math.cos(math.radians(_FINE_DEG))
    is_free = np.ones(len(normals), dtype=np.bool_)
    found: list[Floats] = []
    for _ in range(_MODES):
        rest = normals[is_free]
        if len(rest) < max(_FEWEST_POINTS, _MODE_SHARE * len(normals)):
            break
        some = rest[:: max(1, len(rest) // _SEEDS)]
        votes = np.count_nonzero(np.abs(some @ some.T) >= fine, axis=1)
        middle = some[int(np.argmax(votes))]
        for reach in (cosine, fine):
            near = normals[np.abs(project(normals.T, middle)) >= reach]
            middle = np.linalg.eigh(scatter_of(np.ascontiguousarray(near.T)))[1][:, 2]
        is_free &= np.abs(project(normals.T, middle)) < cosine
        found.append(middle)
    return found


def find_lattices(points: Floats, normals: Floats, rise_m: tuple[float, float]) -> list[Lattice]:
    """Find the rhythms of staircases among the faces of a thinned scan.

    Parameters
    ----------
    points : (n, 3), metres
        Thinned to an even density of some centimetres.
    normals : (n, 3)
        Unit vectors, sign free.
    rise_m : (low, high)
        Shortest and longest period that is looked for along either family of faces.

    Returns
    -------
    list of Lattice
        The best of each pair of directions that has one, best first.
    """
    modes = find_modes(normals)
    found = []
    for first, second in itertools.combinations(modes, 2):
        if abs(float(first @ second)) <= math.sin(math.radians(_SQUARE_DEG)):
            lattice = _lattice_of(points, normals, first, second, rise_m)
            found += [] if lattice is None else [lattice]
    return sorted(found, key=lambda lattice: -lattice.score * math.sqrt(lattice.n_points))


def _lattice_of(
    points: Floats, normals: Floats, up: Floats, across: Floats, rise_m: tuple[float, float]
) -> Lattice | None:
    ahead = across - (across @ up) * up
    ahead /= np.linalg.norm(ahead)
    cosine = math.cos(math.radians(_FACES_DEG))
    faces = [np.abs(project(normals.T, axis)) >= cosine for axis in (ahead, up)]
    if min(np.count_nonzero(each) for each in faces) < _FEWEST_POINTS:
        return None
    places = np.stack([project(points.T, axis) for axis in (ahead, up)])
    is_face = faces[0] | faces[1]
    low = np.percentile(places[:, is_face], 0.5, axis=1) - 2.0 * BIN_M
    cells = np.floor((places - low[:, None]) / BIN_M).astype(np.int64)
    size = np.minimum(np.percentile(cells[:, is_face], 99.5, axis=1).astype(np.int64) + 3, _MOST_BINS)
    is_inside = ((cells >= 0) & (cells < size[:, None])).all(axis=0)
    level, upright = (fill_profile(cells[:, is_inside & face], size) for face in (faces[1], faces[0]))
    best: Rhythm | None = None
    for period in find_periods(level, upright, rise_m):
        rhythm = place_rhythm(level, upright, period)
        if rhythm is not None and _is_stair(rhythm) and (best is None or rhythm.score > best.score):
            best = rhythm
    return None if best is None else _in_space(points, places, faces, (up, ahead), low, best)


def _is_stair(rhythm: Rhythm) -> bool:
    """Return whether enough faces of both families end where the rhythm says, and meet at edges."""
    treads, risers, run_on = len(rhythm.treads), len(rhythm.risers), len(rhythm.levels) + len(rhythm.walls)
    seen = treads + risers
    is_many = seen >= _MANY_FACES
    return (
        min(treads, risers) >= 1
        and seen >= max(2 * _FEWEST_FACES, run_on)
        and (is_many or min(treads + len(rhythm.levels), risers + len(rhythm.walls)) >= _FEWEST_FACES)
        and rhythm.joints >= (_FEWEST_JOINTS_OF_MANY if is_many else _FEWEST_JOINTS)
    )


def _in_space(
    points: Floats, places: Floats, faces: list[Bools], axes: tuple[Floats, Floats], low: Floats, rhythm: Rhythm
) -> Lattice:
    """Return a rhythm of the profile, whose cells begin at ``low`` (2,), as a lattice; it always rises ahead."""
    sign = math.copysign(1.0, rhythm.rise)
    up, ahead = axes[0], axes[1] * sign
    nosing = low + (rhythm.corner + 0.5) * BIN_M
    going, rise = rhythm.going * BIN_M, abs(rhythm.rise) * BIN_M
    side = np.cross(up, ahead)
    # Height above the line of the nosings, in rises.
    along, height = (places[0] - nosing[0]) * sign, (places[1] - nosing[1]) / rise
    above = height - along / going
    numbers = (*rhythm.treads, *rhythm.risers)
    off_tread = np.abs(height - np.rint(height)) * rise
    off_riser = np.abs(along / going - np.rint(along / going)) * going
    is_near = (np.abs(above + 0.5) <= 0.7) & (
        (faces[1] & (off_tread <= 1.5 * BIN_M)) | (faces[0] & (off_riser <= 1.5 * BIN_M))
    )
    is_near &= (along >= (min(numbers) - 0.2) * going) & (along <= (max(numbers) + 0.8) * going)
    across = project(points[is_near].T, side)
    left, right = np.percentile(across, (97.0, 3.0)) if len(across) else (0.0, 0.0)
    origin = nosing[0] * sign * ahead + nosing[1] * up + (left + right) / 2.0 * side
    return Lattice(
        up=own(up, (3,), "up"),
        ahead=own(ahead, (3,), "ahead"),
        rise_m=rise,
        going_m=going,
        origin=own(origin, (3,), "origin"),
        width_m=float(left - right),
        treads=rhythm.treads,
        risers=rhythm.risers,
        levels=rhythm.levels,
        walls=rhythm.walls,
        joints=rhythm.joints,
        n_points=int(np.count_nonzero(is_near)),
    )
