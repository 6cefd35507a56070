"""The rhythm of a staircase: treads and riser faces that come again after one going and one rise.

Strict in its rhythm, permissive in its surfaces: a lattice says where treads and risers are to be looked for, how many
its rhythm expects and how many were seen; it measures nothing.
"""

import itertools
import math
from dataclasses import dataclass

import numpy as np

from stair_inspector.geometry.arrays import Bools, Floats, Ints, own, project, scatter_of

_BIN_M = 0.02
_MOST_BINS = 1024
_FACES_DEG = 25.0
_FINE_DEG = 8.0
_SQUARE_DEG = 15.0
"""Treads and risers are square to each other; normals of small faces beside edges say so only as well as this."""
_MODES = 5
_SEEDS = 400
_FEWEST_POINTS = 40
_FULL_CELL = 6.0
"""So many points of a thinned scan in one cell of the profile fill it: a wall is no more than a narrow riser."""
_PEAKS = 5
_MOST_TIMES = 32
_PLACES = 200
_LEVEL_REACH = 1
"""A face may lie so many bins off the rhythm to each side."""
_SEEN_SHARE = 0.4
"""Share of a tread's or riser's length in the profile that must be filled."""
_RUNS_ON_SHARE = 0.7
"""A face whose neighbouring cell is filled as much as this runs on: a floor, a landing, a wall."""
_BETWEEN_SHARE = 0.5
"""Halfway between two faces there is air: less than this share of what fills them."""
_LEAST_LONGER_M = 0.15
"""The longer of the two periods: on treads that are shorter nobody climbs, in either reading."""
_MODE_SHARE = 0.02
_FEWEST_FACES = 2
_FEWEST_JOINTS = 3
_MANY_FACES, _FEWEST_JOINTS_OF_MANY = 6, 2
"""A camera that looks along the treads sees many risers and one tread."""
_SIDE_STEPS = 1.3
"""Points so many rises off the line of the nosings lie clearly above or below the stair."""


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
    def n_expected(self) -> int:
        """How many risers the rhythm has from the first face to the last."""
        numbers = (*self.treads, *self.risers)
        return max(numbers) - min(numbers) + 1

    @property
    def score(self) -> float:
        """How much speaks for the rhythm: faces and the edges between them."""
        return len(self.treads) + len(self.risers) + self.joints

    def turned(self) -> "Lattice":
        """Return the same faces read with treads and risers changed."""
        # Riser k rises behind tread k-1; turned, tread -k lies before riser -k+1.
        return Lattice(
            up=own(-self.ahead, (3,), "up"),
            ahead=own(-self.up, (3,), "ahead"),
            rise_m=self.going_m,
            going_m=self.rise_m,
            origin=self.origin,
            width_m=self.width_m,
            treads=tuple(sorted(-k for k in self.risers)),
            risers=tuple(sorted(-k for k in self.treads)),
            levels=tuple(sorted(-k for k in self.walls)),
            walls=tuple(sorted(-k for k in self.levels)),
            joints=self.joints,
            n_points=self.n_points,
        )

    def flipped(self) -> "Lattice":
        """Return the same faces read upside down."""
        # Tread k becomes the tread before which riser -k was.
        middle = self.origin + self.going_m * self.ahead
        return Lattice(
            up=own(-self.up, (3,), "up"),
            ahead=own(-self.ahead, (3,), "ahead"),
            rise_m=self.rise_m,
            going_m=self.going_m,
            origin=own(middle, (3,), "origin"),
            width_m=self.width_m,
            treads=tuple(sorted(-k for k in self.treads)),
            risers=tuple(sorted(1 - k for k in self.risers)),
            levels=tuple(sorted(-k for k in self.levels)),
            walls=tuple(sorted(1 - k for k in self.walls)),
            joints=self.joints,
            n_points=self.n_points,
        )


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
    low = np.percentile(places[:, is_face], 0.5, axis=1) - 2.0 * _BIN_M
    cells = np.floor((places - low[:, None]) / _BIN_M).astype(np.int64)
    size = np.minimum(np.percentile(cells[:, is_face], 99.5, axis=1).astype(np.int64) + 3, _MOST_BINS)
    is_inside = ((cells >= 0) & (cells < size[:, None])).all(axis=0)
    level, upright = (_profile(cells[:, is_inside & face], size) for face in (faces[1], faces[0]))
    best: Lattice | None = None
    for period in _periods(level, upright, rise_m):
        for lattice in _place(level, upright, period):
            going, rise, corner, treads, risers, levels, walls, joints = lattice
            faces_seen = len(treads) + len(risers)
            least = _FEWEST_JOINTS if faces_seen < _MANY_FACES else _FEWEST_JOINTS_OF_MANY
            if (
                min(len(treads), len(risers)) < 1
                or faces_seen < max(2 * _FEWEST_FACES, len(levels) + len(walls))
                or (
                    min(len(treads) + len(levels), len(risers) + len(walls)) < _FEWEST_FACES
                    and faces_seen < _MANY_FACES
                )
                or joints < least
            ):
                continue
            sign = math.copysign(1.0, rise)
            score = len(treads) + len(risers) + joints
            if best is not None and best.score >= score:
                continue
            nosing = low + (corner + 0.5) * _BIN_M
            # With the second axis turned, the profile always rises ahead.
            best = _in_space(
                points,
                places,
                faces,
                (up, ahead * sign),
                (nosing, going * _BIN_M, abs(rise) * _BIN_M, sign),
                (treads, risers, levels, walls, joints),
            )
    return best


def _in_space(
    points: Floats,
    places: Floats,
    faces: list[Bools],
    axes: tuple[Floats, Floats],
    shape: tuple[Floats, float, float, float],
    counted: tuple[tuple[int, ...], tuple[int, ...], tuple[int, ...], tuple[int, ...], int],
) -> Lattice:
    up, ahead = axes
    nosing, going, rise, sign = shape
    treads, risers, levels, walls, joints = counted
    side = np.cross(up, ahead)
    # Height above the line of the nosings, in rises.
    along = (places[0] - nosing[0]) * sign
    above = (places[1] - nosing[1]) / rise - along / going
    numbers = (*treads, *risers)
    off_tread = np.abs((height := (places[1] - nosing[1]) / rise) - np.rint(height)) * rise
    off_riser = np.abs(along / going - np.rint(along / going)) * going
    is_near = (np.abs(above + 0.5) <= 0.7) & (
        (faces[1] & (off_tread <= 1.5 * _BIN_M)) | (faces[0] & (off_riser <= 1.5 * _BIN_M))
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
        treads=treads,
        risers=risers,
        levels=levels,
        walls=walls,
        joints=joints,
        n_points=int(np.count_nonzero(is_near)),
    )


def _profile(cells: Ints, size: Ints) -> Floats:
    """Return how full each cell of the profile is, 0 to 1; axis 0 ahead, axis 1 up."""
    counts = np.bincount(cells[0] * size[1] + cells[1], minlength=int(size[0] * size[1]))
    filled: Floats = np.minimum(counts.reshape(size) / _FULL_CELL, 1.0)
    return filled


def _spread(profile: Floats, axis: int) -> Floats:
    """Return a profile smeared by a bin to both sides along an axis, so that noise does not hide its rhythm."""
    smeared = profile.copy()
    for shift in (1, -1):
        smeared += 0.6 * np.roll(profile, shift, axis)
    return smeared


def _periods(level: Floats, upright: Floats, rise_m: tuple[float, float]) -> list[tuple[float, float]]:
    """Return the shifts (ahead, up), bins, after which both families of faces come again; up may be negative."""
    longest = round(rise_m[1] / _BIN_M)
    # Room for the longest shift to both sides, however small the scan is.
    shape = tuple(2 ** math.ceil(math.log2(length + max(length, 2 * longest + 2))) for length in level.shape)
    product = np.ones(shape)
    for profile, axis in ((level, 1), (upright, 0)):
        spectrum = np.fft.rfft2(_spread(profile, axis), shape)
        again = np.fft.irfft2(spectrum * spectrum.conj(), shape)
        product *= np.maximum(again, 0.0)
    same = np.sqrt(product)
    shortest = math.ceil(rise_m[0] / _BIN_M)
    ahead = np.arange(shortest, longest + 1)
    upwards = np.concatenate([np.arange(-longest, -shortest + 1), ahead])
    window = same[np.ix_(ahead, upwards % shape[1])]
    is_short = np.maximum(ahead[:, None], np.abs(upwards)) < _LEAST_LONGER_M / _BIN_M
    window = np.where(is_short, 0.0, window)
    found: list[tuple[float, float]] = []
    for _ in range(_PEAKS):
        i, j = np.unravel_index(int(np.argmax(window)), window.shape)
        if window[i, j] <= 0.0:
            break
        found.append(_refined(same, int(ahead[i]), int(upwards[j]), level.shape))
        window[max(0, i - 2) : i + 3, max(0, j - 2) : j + 3] = 0.0
    return found


def _refined(same: Floats, ahead: int, upwards: int, size: tuple[int, ...]) -> tuple[float, float]:
    """Return a period to a part of a bin, from where its multiples are."""
    times, best = 1, np.array([ahead, upwards], dtype=np.float64)
    first = same[ahead, upwards]
    while times <= _MOST_TIMES:
        middle = np.rint(best * times).astype(int)
        if middle[0] + 3 >= size[0] or abs(middle[1]) + 3 >= size[1]:
            break
        around = same[
            np.ix_(np.arange(middle[0] - 2, middle[0] + 3), np.arange(middle[1] - 2, middle[1] + 3) % same.shape[1])
        ]
        if around.max() < 0.1 * first:
            break
        weights = np.maximum(around - 0.5 * around.max(), 0.0)
        shift = np.array([weights.sum(axis=1) @ np.arange(-2, 3), weights.sum(axis=0) @ np.arange(-2, 3)]) / max(
            weights.sum(), 1e-12
        )
        finer = (middle + shift) / times
        if np.abs(finer - best).max() > 1.0 / times:
            break
        best = finer
        times *= 2
    return float(best[0]), float(best[1])


def _place(
    level: Floats, upright: Floats, period: tuple[float, float]
) -> list[tuple[float, float, Floats, tuple[int, ...], tuple[int, ...], tuple[int, ...], tuple[int, ...], int]]:
    """Place a rhythm on a profile where most of its faces are seen."""
    going, rise = period
    size = level.shape
    sign = math.copysign(1.0, rise)
    high = abs(rise)
    if sign < 0.0:
        level, upright = level[::-1], upright[::-1]
    sums = [_summed(level > 0.3), _summed(upright > 0.3)]
    k = np.arange(math.ceil(size[1] / high) + 1)
    reach, thick = _LEVEL_REACH, 2 * _LEVEL_REACH + 1
    # What is filled is quickly counted; only where that is most is it asked which faces end there.
    a0, b0 = _fullest_places(sums, period, size)

    def treads(shift: float, lift: float) -> Floats:
        place = b0[:, None] + (k + shift) * going, a0[:, None] + (k + lift) * high - reach
        return _filled(sums[0], *place, going, thick) / going

    def risers(shift: float, lift: float) -> Floats:
        place = b0[:, None] + (k + shift) * going - reach, a0[:, None] + (k - 1.0 + lift) * high
        return _filled(sums[1], *place, thick, high) / high

    b, a = b0[:, None] + k * going, a0[:, None] + k * high
    tread, riser = treads(0, 0), risers(0, 0)
    is_level, is_upright = tread >= _SEEN_SHARE, riser >= _SEEN_SHARE
    ends_level = is_level & (treads(-1, 0) < _RUNS_ON_SHARE) & (treads(1, 0) < _RUNS_ON_SHARE)
    ends_upright = is_upright & (risers(0, -1) < _RUNS_ON_SHARE) & (risers(0, 1) < _RUNS_ON_SHARE)
    for half in (-0.5, 0.5):
        ends_level &= treads(0, half) < _BETWEEN_SHARE * tread
        ends_upright &= risers(half, 0) < _BETWEEN_SHARE * riser
    joints = np.count_nonzero(is_level & is_upright & (ends_level | ends_upright), axis=1) + np.count_nonzero(
        is_level[:, :-1] & is_upright[:, 1:] & (ends_level[:, :-1] | ends_upright[:, 1:]), axis=1
    )
    faces = np.count_nonzero(ends_level, axis=1) + np.count_nonzero(ends_upright, axis=1)
    fullness = np.minimum(tread, 1.0).sum(axis=1) + np.minimum(riser, 1.0).sum(axis=1)
    best = int(np.argmax(faces + joints + 0.2 * fullness))
    # The lowest face that was seen has the number 0.
    numbered = np.flatnonzero(ends_level[best] | ends_upright[best])
    if not len(numbered):
        return []
    lowest = int(numbered[0])

    def numbers(mask: Bools) -> tuple[int, ...]:
        return tuple(int(row) - lowest for row in np.flatnonzero(mask[best]))

    faces_seen = numbers(ends_level), numbers(ends_upright)
    run_on = numbers(is_level & ~ends_level), numbers(is_upright & ~ends_upright)
    corner = np.array([b[best, lowest], a[best, lowest]], dtype=np.float64)
    if sign < 0.0:
        corner[0] = size[0] - 1 - corner[0]
    return [(going, rise, corner, *faces_seen, *run_on, int(joints[best]))]


def _fullest_places(sums: list[Floats], period: tuple[float, float], size: tuple[int, ...]) -> tuple[Floats, Floats]:
    """Return where a rhythm meets most filled faces: offsets up and ahead (places,), bins, the fullest first."""
    going, high = period[0], abs(period[1])
    n_rows = math.ceil(size[1] / high) + 1
    upwards = np.arange(round(high), dtype=np.float64)
    ahead = np.arange(-round((n_rows - 1) * going), size[0], dtype=np.float64)
    seen = np.zeros((len(upwards), len(ahead)), dtype=np.int64)
    for k in range(n_rows):
        # Other starts lie beyond the profile in this row.
        first, last = np.searchsorted(ahead, (-(k + 1.0) * going - 2.0, size[0] - k * going + 2.0))
        b, a = ahead[first:last] + k * going, upwards + k * high
        tread = _filled(sums[0], b, (a - _LEVEL_REACH)[:, None], going, 2 * _LEVEL_REACH + 1) / going
        riser = _filled(sums[1], b - _LEVEL_REACH, (a - high)[:, None], 2 * _LEVEL_REACH + 1, high) / high
        seen[:, first:last] += (tread >= _SEEN_SHARE).astype(np.int64) + (riser >= _SEEN_SHARE)
    kept = np.argsort(-seen.ravel(), kind="stable")[:_PLACES]
    return upwards[kept // len(ahead)], ahead[kept % len(ahead)]


def _summed(mask: Bools) -> Floats:
    """Return the sums over all cells below and to the left of each corner, (rows + 1, columns + 1)."""
    sums = np.zeros((mask.shape[0] + 1, mask.shape[1] + 1))
    sums[1:, 1:] = mask.cumsum(axis=0).cumsum(axis=1)
    return sums


def _filled(sums: Floats, ahead: Floats, upwards: Floats, length: float, height: float) -> Floats:
    """Return how many cells are filled in boxes that begin at (ahead, upwards), bins."""
    edges = []
    for start, extent, limit in ((ahead, length, sums.shape[0] - 1), (upwards, height, sums.shape[1] - 1)):
        first = np.rint(start).astype(np.int64)
        last = np.rint(start + extent).astype(np.int64)
        edges.append((np.clip(first, 0, limit), np.clip(last, 0, limit)))
    (i0, i1), (j0, j1) = edges
    filled: Floats = sums[i1, j1] - sums[i0, j1] - sums[i1, j0] + sums[i0, j0]
    return filled
