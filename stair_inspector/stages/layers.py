"""Are surfaces double? Stations that were not registered well show everything twice, a little apart."""

from dataclasses import dataclass

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.arrays import Bools, Floats, Ints, freeze
from stair_inspector.model import ScanStations

_MOST_POINTS = 100_000
_CELL_M = 0.15
_FEWEST_IN_CELL = 40
_CLEARLY_FLAT, _FLAT = 0.5, 0.8
"""Scatter across a surface, as a share of the lesser one along it. Two layers 60 mm apart still count as flat; so do
many cells at edges, which therefore do not count as single where they are not double."""
_OF_STATED = 6.0
"""Passes lie apart by so many times what registration leaves from one step to the next: every step is seen by all."""
SAME_WAY = 0.985
"""Cosine of 10 degrees: the cells of surfaces that face one way."""
_MOST_WAYS = 3
_REACH_M = 0.075
"""Points farther from the middle of their cell's surface are of another one."""
_LEAST_PART = 0.15
"""Each layer has at least this share of the points of its cell."""
_LEAST_RATIO = 3.5
"""Distance of two layers in units of their scatter: points spread evenly between two bounds have 2.9, noise 2.3."""
_MOST_BETWEEN = 0.065
"""Share of the points in the middle fifth between two layers; evenly spread points have 0.1."""
_SAME_PLACE_M = 0.025
"""Two layers lie over each other; a skirting board lies beside the wall that it stands before."""
_OVER_EACH_OTHER = 1.0
"""The same as a share of the lesser extent (1 sigma): the front of a nosing stands above the riser, not over it."""
_INNER, _LEAST_INNER = (0.16, 0.84), 0.15
"""Of points that lie over the other layer, almost half lie within these shares of its extent, both ways along; the
fronts of the nosings above and below a riser lie at its ends."""
_FEWEST_CELLS = 10
_LEAST_SHARE, _LEAST_HINT, _HINT_AGREEING = 0.2, 0.05, 0.8
_AGREEING = 0.6
SAME_PLANE_M = 0.03
_FROM_ONE_SIDE = 0.05
"""Sine of the angle to a surface, about 3 degrees, from which on it is certain from which side a station saw it."""
LEAST_STEPS = 3.0
"""Coordinates on a step lie in layers one and two steps apart."""
_SURELY_NO_SLAB = 0.8
FEWEST_PLANES, FEWEST_ON_PLANE, _STACK = 2, 4, 4
"""Planes, and cells on each, on which surfaces as far apart as the faces of a slab must be double; and so many planes
that face one way are levels or risers."""


@dataclass(frozen=True, slots=True, eq=False)
class DoubledWay:
    """Surfaces that face one way and are double: unit ``normal`` (3,), distance, share of the cells that show both.

    ``is_sure`` says that they alone tell it; else it is so only if the order of the points tells stations, too.
    """

    normal: Floats
    apart_m: float
    share: float
    is_sure: bool = True


@dataclass(frozen=True, slots=True, eq=False)
class Split:
    """The points of cells cut in two across the surface.

    Distance of the halves (c,), whether they are two layers, and where the middle between them lies along the normal.
    """

    apart_m: Floats
    is_double: Bools
    offset_m: Floats


def is_stated(apart_m: float, registration_m: float) -> bool:
    """Return whether passes may lie so far apart by the registration (k = 1) that the user states of the scanner."""
    return apart_m <= _OF_STATED * registration_m


def find_doubled(points: Floats, steps_m: Floats, stations: ScanStations | None = None) -> tuple[DoubledWay, ...]:
    """Find the directions in which surfaces are double.

    Parameters
    ----------
    points : (n, 3), metres
        Any frame.
    steps_m : (3,)
        The step of the coordinates on each axis, which makes layers of its own.
    stations : ScanStations, optional
        What stations saw from opposite sides is no surface twice, but the two faces of a slab.

    Notes
    -----
    The points of each flat cell of 150 mm are cut in two across its surface where the halves differ most. Two layers
    leave the middle empty; noise and unevenness do not. Surfaces are double if that happens at the same distance on
    much of what faces one way, and on its largest plane as well: open treads show their undersides at one distance,
    but the floor has none. What lies less than a slab's thickness apart needs no floor to be told from slabs.
    """
    return tuple(way for way in find_ways(points, steps_m, stations) if way.is_sure)


def find_ways(points: Floats, steps_m: Floats, stations: ScanStations | None = None) -> tuple[DoubledWay, ...]:
    """Do the same, and find those directions too in which surfaces are double on too few cells to be sure."""
    stride = -(-len(points) // _MOST_POINTS)
    some = points[::stride]
    sight = sight_of(points, stations, stride)
    found: list[DoubledWay] = []
    for shift_m in (0.0, _CELL_M / 2.0):
        cells = Cells(some, shift_m, sight)
        for normal, members in cells.ways():
            way = _judge(cells, normal, members, float(np.abs(normal) @ steps_m))
            if way is not None:
                known = [k for k, other in enumerate(found) if abs(float(normal @ other.normal)) > SAME_WAY]
                if not known:
                    found.append(way)
                elif way.is_sure and not any(found[k].is_sure for k in known):
                    found[known[0]] = way
    return tuple(found)


def sight_of(points: Floats, stations: ScanStations | None, stride: int) -> Floats | None:
    """Return the way (m, 3) from every ``stride``-th point to the station that saw it, NaN where no one knows."""
    if stations is None or np.isnan(stations.places_m).all():
        return None
    way: Floats = stations.places_m[stations.of_point[::stride]] - points[::stride]
    return way


class Cells:
    """The points of a scan in cubic cells, those with enough points on something flat.

    ``points`` (n, 3) metres, cell by cell, and ``rows`` (n,) where each stands in the scan; ``starts`` and ``counts``
    (c,) say which are a cell's. With the ``sight`` (n, 3) from points to their stations, a cell has only what was seen
    from one side of it, that from which most of it was seen.
    """

    def __init__(self, points: Floats, shift_m: float = 0.0, sight: Floats | None = None) -> None:
        places = np.floor((points - points.min(axis=0) + shift_m) / _CELL_M).astype(np.int64)
        n_y, n_z = places[:, 1].max() + 1, places[:, 2].max() + 1
        keys = (places[:, 0] * n_y + places[:, 1]) * n_z + places[:, 2]
        order = np.argsort(keys, kind="stable")
        ordered = keys[order]
        starts = np.flatnonzero(np.concatenate([[True], ordered[1:] != ordered[:-1]]))
        counts = np.diff(np.append(starts, len(ordered)))
        is_full = counts >= _FEWEST_IN_CELL
        of_point = np.repeat(is_full, counts)
        self.rows = order[of_point]
        self.points = points[self.rows]
        self.counts = counts[is_full]
        self.starts = np.cumsum(self.counts) - self.counts
        self.normals, self.flatness = self._normals()
        if sight is not None and len(self.counts):
            self._keep_one_side(sight[self.rows])

    def _keep_one_side(self, sight: Floats) -> None:
        """Leave out of each cell what was seen from its other side; ``sight`` is that of the cells' points."""
        across = (sight * np.repeat(self.normals, self.counts, axis=0)).sum(axis=1)
        sine = across / np.maximum(np.linalg.norm(sight, axis=1), 1e-9)
        side = np.where(np.abs(sine) >= _FROM_ONE_SIDE, np.sign(sine), 0.0)
        side[np.isnan(side)] = 0.0
        most = np.where(np.add.reduceat(side, self.starts) >= 0.0, 1.0, -1.0)
        is_kept = side * np.repeat(most, self.counts) >= 0.0
        if is_kept.all():
            return
        counts = np.add.reduceat(is_kept.astype(np.int64), self.starts)
        is_kept &= np.repeat(counts >= _FEWEST_IN_CELL, self.counts)
        self.rows, self.points = self.rows[is_kept], self.points[is_kept]
        self.counts = counts[counts >= _FEWEST_IN_CELL]
        self.starts = np.cumsum(self.counts) - self.counts
        self.normals, self.flatness = self._normals()

    def _normals(self) -> tuple[Floats, Floats]:
        """Return the normal of each cell and its scatter across, as a share of that along; infinite for a line."""
        if not len(self.counts):
            return np.zeros((0, 3)), np.zeros(0)
        means = self.middles()
        off = self.points - np.repeat(means, self.counts, axis=0)
        pairs = [np.add.reduceat(off[:, i] * off[:, j], self.starts) / self.counts for i in range(3) for j in range(3)]
        values, vectors = np.linalg.eigh(np.stack(pairs, axis=1).reshape(-1, 3, 3))
        spread = np.sqrt(np.maximum(values, 0.0))
        is_wide = spread[:, 1] >= _CELL_M / 8.0
        return vectors[:, :, 0], np.where(is_wide, spread[:, 0] / np.maximum(spread[:, 1], _CELL_M / 8.0), np.inf)

    def middles(self) -> Floats:
        """Return the mean (c, 3) of the points of each cell."""
        means: Floats = np.add.reduceat(self.points, self.starts) / self.counts[:, None]
        return means

    def ways(self) -> list[tuple[Floats, Ints]]:
        """Return the directions that most flat cells face, each with its cells."""
        left = np.flatnonzero(self.flatness <= _CLEARLY_FLAT)
        flat = np.flatnonzero(self.flatness <= _FLAT)
        ways: list[tuple[Floats, Ints]] = []
        while len(left) >= _FEWEST_CELLS and len(ways) < _MOST_WAYS:
            tried = self.normals[left[:: -(-len(left) // 300)]]
            agree = np.abs(tried @ self.normals[left].T) >= SAME_WAY
            is_own = agree[int(agree.sum(axis=1).argmax())]
            if np.count_nonzero(is_own) < _FEWEST_CELLS:
                break
            own = self.normals[left[is_own]]
            # The middle of those nearest to it: cells at edges lean.
            closeness = np.abs(own @ _middle(own))
            normal = _middle(own[closeness >= np.median(closeness)])
            ways.append((normal, flat[np.abs(self.normals[flat] @ normal) >= SAME_WAY]))
            left = left[~is_own]
        return ways

    def split(self, normal: Floats, members: Ints) -> Split:
        """Cut the points of the cells ``members`` in two along ``normal``."""
        across = np.eye(3)[int(np.abs(normal).argmin())]
        first = np.cross(normal, across)
        first /= np.linalg.norm(first)
        axes = np.stack([normal, first, np.cross(normal, first)])
        counts = self.counts[members]
        rows = np.repeat(self.starts[members] - (np.cumsum(counts) - counts), counts) + np.arange(counts.sum())
        number = np.repeat(np.arange(len(members)), counts)
        r, a, b = axes @ self.points[rows].T
        order = np.lexsort((r, number))
        r, a, b = r[order], a[order], b[order]
        starts = np.cumsum(counts) - counts
        middle = r[starts + counts // 2]
        is_near = np.abs(r - middle[number]) <= _REACH_M
        r, a, b, number = (values[is_near] for values in (r, a, b, number))
        counts = np.bincount(number, minlength=len(members))
        starts = np.cumsum(counts) - counts
        place = np.arange(len(r)) - starts[number]
        low = self._cut(r, number, place, starts, counts)
        return self._compare(r, np.stack([a, b]), number, place, starts, counts, low, middle)

    @staticmethod
    def _cut(r: Floats, number: Ints, place: Ints, starts: Ints, counts: Ints) -> Ints:
        """Return how many points of each cell lie in the lower half, by the largest scatter between the halves."""
        base = r[starts]
        total = np.cumsum(r - base[number])
        before = np.concatenate([[0.0], total])[starts]
        sums = total - before[number]
        n_low = place + 1.0
        n_all = counts[number]
        n_high = np.maximum(n_all - n_low, 1.0)
        whole = (total[starts + counts - 1] - before)[number]
        between = n_low * n_high / n_all**2 * ((whole - sums) / n_high - sums / n_low) ** 2
        part = n_low / n_all
        between[(part < _LEAST_PART) | (part > 1.0 - _LEAST_PART)] = 0.0
        best = np.maximum.reduceat(between, starts)
        is_best = np.flatnonzero(between == best[number])
        low = np.zeros(len(starts), dtype=np.int64)
        low[number[is_best][::-1]] = place[is_best][::-1] + 1
        return np.clip(low, 1, np.maximum(counts - 1, 1))

    @staticmethod
    def _compare(
        r: Floats, plan: Floats, number: Ints, place: Ints, starts: Ints, counts: Ints, low: Ints, middle: Floats
    ) -> Split:
        def quantile(begin: Ints, length: Ints, share: float) -> Floats:
            return r[begin + np.minimum((share * length).astype(np.int64), length - 1)]

        high = np.maximum(counts - low, 1)
        upper = np.minimum(starts + low, starts + counts - 1)
        centre_low, centre_high = quantile(starts, low, 0.5), quantile(upper, high, 0.5)
        scatter = 0.25 * (
            quantile(starts, low, 0.84)
            - quantile(starts, low, 0.16)
            + quantile(upper, high, 0.84)
            - quantile(upper, high, 0.16)
        )
        apart = centre_high - centre_low
        is_low = place < low[number]
        sums_low = np.stack([np.bincount(number[is_low], row[is_low], len(counts)) for row in plan])
        sums_all = np.stack([np.bincount(number, row, len(counts)) for row in plan])
        squares_low = np.stack([np.bincount(number[is_low], row[is_low] ** 2, len(counts)) for row in plan])
        squares_all = np.stack([np.bincount(number, row**2, len(counts)) for row in plan])
        mean_low, mean_high = sums_low / low, (sums_all - sums_low) / high
        spread = np.minimum(squares_low / low - mean_low**2, (squares_all - squares_low) / high - mean_high**2)
        aside = np.abs(mean_low - mean_high)
        is_over = (aside <= _SAME_PLACE_M) & (aside <= _OVER_EACH_OTHER * np.sqrt(np.maximum(spread, 0.0)))
        off_centre = np.abs(r - 0.5 * (centre_low + centre_high)[number])
        between = np.bincount(number[off_centre <= 0.1 * apart[number]], minlength=len(counts)) / counts
        is_double = (apart >= _LEAST_RATIO * scatter) & (between <= _MOST_BETWEEN) & is_over.all(axis=0)
        for k in np.flatnonzero(is_double):
            cell = slice(starts[k], starts[k] + counts[k])
            is_double[k] = _lie_over_each_other(plan[:, cell][:, is_low[cell]], plan[:, cell][:, ~is_low[cell]])
        # Two layers are one plane, in whichever of them most points lie.
        return Split(apart, is_double, np.where(is_double, 0.5 * (centre_low + centre_high), middle))


def _lie_over_each_other(low: Floats, high: Floats) -> bool:
    """Return whether two layers (2, n) cover the same place, and none only the ends of the other."""
    for layer, other in ((low, high), (high, low)):
        ends = np.quantile(other, _INNER, axis=1)
        is_inner = (layer >= ends[0][:, None]) & (layer <= ends[1][:, None])
        if is_inner.all(axis=0).mean() < _LEAST_INNER:
            return False
    return True


def _middle(normals: Floats) -> Floats:
    """Return the middle of directions without a sign."""
    return np.asarray(np.linalg.eigh(normals.T @ normals)[1][:, 2], dtype=np.float64)


def _judge(cells: Cells, normal: Floats, members: Ints, step_m: float) -> DoubledWay | None:
    """Return how surfaces that face one way are double, None where they are not."""
    split = cells.split(normal, members)
    apart = np.sort(split.apart_m[split.is_double])
    if len(apart) < _FEWEST_CELLS:
        return None
    # The distance on which most agree, to a tenth and a millimetre.
    width = np.searchsorted(apart, 1.1 * apart + 0.001, side="right") - np.arange(len(apart))
    first = int(width.argmax())
    agreeing = apart[first : first + width[first]]
    apart_m = float(np.median(agreeing))
    is_one = split.is_double & (split.apart_m >= agreeing[0]) & (split.apart_m <= agreeing[-1])
    counts = is_one | (cells.flatness[members] <= _CLEARLY_FLAT)
    share = float(is_one.sum() / counts.sum())
    if len(agreeing) < max(_FEWEST_CELLS, _AGREEING * len(apart)) or apart_m < LEAST_STEPS * step_m:
        return None
    offset_m, is_double = split.offset_m[counts], is_one[counts]
    if share >= _LEAST_SHARE and (
        apart_m < _SURELY_NO_SLAB * priors.SLAB_THICKNESS_M[0] or _is_no_slab(offset_m, is_double)
    ):
        return DoubledWay(freeze(normal.copy()), apart_m, share)
    is_hint = share >= _LEAST_HINT and len(agreeing) >= _HINT_AGREEING * len(apart)
    return DoubledWay(freeze(normal.copy()), apart_m, share, is_sure=False) if is_hint else None


def _is_no_slab(offset_m: Floats, is_one: Bools) -> bool:
    """Return whether cells, by their places along the normal, are double where a slab's two faces are not."""
    shares, sizes = _shares_by_plane(offset_m, is_one)
    is_plane = sizes >= FEWEST_ON_PLANE
    is_double = is_plane & (shares >= _LEAST_SHARE)
    # A partition shows both faces where little else faces its way. Of levels or risers several do, and of those each
    # station may have seen others.
    is_stack = np.count_nonzero(is_plane) >= _STACK or np.count_nonzero(is_double) >= FEWEST_PLANES
    return bool(is_double[int(sizes.argmax())] and is_stack)


def _shares_by_plane(offset_m: Floats, is_one: Bools) -> tuple[Floats, Ints]:
    """Return the share of doubled cells on each plane, and how many cells it has."""
    order = np.argsort(offset_m)
    plane = np.concatenate([[0], np.cumsum(np.diff(offset_m[order]) > SAME_PLANE_M)])
    sizes = np.bincount(plane)
    return np.bincount(plane, is_one[order].astype(np.float64)) / sizes, sizes
