"""On which steps do the coordinates of a scan lie? Decimals, integer formats, voxels and float32 leave some."""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from stair_inspector.geometry.arrays import Floats, freeze
from stair_inspector.model import Scan
from stair_inspector.units import METRES_PER_UNIT

Turns = NDArray[np.complex128]
Rounding = Literal["", "float32", "rounded", "lattice"]

_MOST_VALUES = 20_000
_SCREENED = 3_000
_MANTISSAS = (5.0, 2.5, 2.0, 1.0)
_DECADES = range(0, -7, -1)
"""Decimal steps that are tried, as powers of ten of the file's unit and of the metre: 5 units down to a micrometre, so
that a finer step than those that count is not taken for twice itself."""
_BINARY = range(0, 9)
"""Binary steps of the file's unit: down to 1/256 of an inch."""
_FINEST_M = 2e-5
_LEAST_SHARE = 0.4
"""Two stations may come from two programs: so much of the points at least lies on the step."""
_SHARE_LOST = 0.002
"""A coarser step may hold so much less of the points than the best one, and what lies on that by chance. On a level
floor nearly all points may lie on every fourth place of a step."""
_WIDEST_ALONE_M = 0.03
"""Levels of a noise-free model are a lattice of risers: a wider step needs a second axis that agrees."""
_FEWEST_SITES, _MANY_SITES = 5, 100
_FEWEST_REPEATS = 3
_DOUBLE = 4e-16
FLOAT32 = 2.0**-23

_NEIGHBOURHOODS, _NEIGHBOURS = 5, 400
_WINDOW_M = 0.25
_SAME_DISTANCE = 0.01
_TURNED_SHARE = 0.5
_FINEST_LATTICE_M = 0.003


@dataclass(frozen=True, slots=True, eq=False)
class CoordinateSteps:
    """The steps of a scan's coordinates.

    ``steps_m`` (3,) on each axis of the scan, 0 where none shows; ``kinds`` what made them; ``shares`` (3,) of the
    points that lie on them; ``is_turned`` where it is a cubic lattice that was turned after the points were put on it,
    so that it counts alike on all axes.
    """

    steps_m: Floats
    kinds: tuple[Rounding, Rounding, Rounding]
    shares: Floats
    is_turned: bool = False


@dataclass(frozen=True, slots=True)
class _Step:
    step_m: float = 0.0
    kind: Rounding = ""
    share: float = 0.0


_NONE = _Step()


def find_steps(scan: Scan) -> CoordinateSteps:
    """Find the step of the coordinates on each axis.

    Parameters
    ----------
    scan : Scan
        In metres near zero; what was subtracted and the file's unit tell how its numbers were written.

    Notes
    -----
    float32 is recognised by the numbers themselves: every one is a float32. A step is tried by the share of points that
    lie on multiples of it, with any offset, as exactly as the file can hold them; the coarsest of the best is taken.
    What the file states counts at least. Heights of a noise-free model repeat without being rounded: the places of a
    real step are many, or follow each other. A step below 0.02 mm, as every float32 has near zero, is none.
    """
    some = scan.points[:: max(1, len(scan.points) // _MOST_VALUES)]
    per_unit = METRES_PER_UNIT[scan.unit]
    found = [_find_on_axis(values, float(low), per_unit) for values, low in zip(some.T, scan.origin_m, strict=True)]
    found = [step if _is_believed(step, found, k) else _NONE for k, step in enumerate(found)]
    if scan.stated_steps_m is not None:
        # A file may hold coarser numbers than its scale, never finer ones.
        stated = [_Step(step_m, "rounded", 1.0) for step_m in scan.stated_steps_m.tolist()]
        found = [own if own.step_m >= 0.99 * said.step_m else said for own, said in zip(found, stated, strict=True)]
        found = [step if step.step_m >= _FINEST_M else _NONE for step in found]
    is_turned = False
    if sum(step.step_m >= _FINEST_LATTICE_M for step in found) < 2:
        lattice_m, share = _find_turned_lattice(scan.points)
        if lattice_m > 0.0:
            found, is_turned = [_Step(lattice_m, "lattice", share)] * 3, True
    x, y, z = found
    return CoordinateSteps(
        freeze(np.array([step.step_m for step in found])),
        (x.kind, y.kind, z.kind),
        freeze(np.array([step.share for step in found])),
        is_turned,
    )


def _is_believed(step: _Step, all_steps: list[_Step], own: int) -> bool:
    if step.step_m <= _WIDEST_ALONE_M or step.kind == "float32":
        return True
    return any(math.isclose(other.step_m, step.step_m, rel_tol=1e-3) for k, other in enumerate(all_steps) if k != own)


def _find_on_axis(local: Floats, origin_m: float, per_unit: float) -> _Step:
    """Return the step of one coordinate."""
    in_file = (local + origin_m) / per_unit
    largest = float(np.abs(in_file).max())
    # What converting to metres and subtracting an origin costs.
    rounding = 8.0 * _DOUBLE * largest
    # A hostile file may hold what no float32 can.
    with np.errstate(over="ignore"):
        off_float32 = np.abs(in_file - in_file.astype(np.float32).astype(np.float64))
    own = _NONE
    exactness_m = rounding * per_unit
    if largest > 0.0 and float(off_float32.max()) <= rounding:
        typical = float(np.median(np.abs(in_file)))
        own = _Step(FLOAT32 * 2.0 ** math.floor(math.log2(max(typical, 1e-30))) * per_unit, "float32", 1.0)
        exactness_m = max(exactness_m, FLOAT32 * largest * per_unit)
    rounded = _find_rounding(local, origin_m, per_unit, max(exactness_m, 1e-10))
    best = rounded if rounded.step_m > 1.5 * own.step_m else own
    return best if best.step_m >= _FINEST_M else _NONE


def _find_rounding(local: Floats, origin_m: float, per_unit: float, exactness_m: float) -> _Step:
    """Return the coarsest of the steps on which most coordinates lie, each to ``exactness_m``."""
    extent_m = float(local.max() - local.min())
    if extent_m <= 0.0:
        return _NONE
    screened = local[:: max(1, len(local) // _SCREENED)]
    finest_m = max(_FINEST_M / 10.0, 20.0 * exactness_m)
    found: list[_Step] = []
    turns: dict[float, Turns] = {}
    own = _steps_seen(local, exactness_m)
    for step_m in sorted({*_round_steps(per_unit), *own}, reverse=True):
        if not finest_m <= step_m <= extent_m / 2.0:
            continue
        # Points on a step turn by whole circles: their mean stays on the circle, that of others falls to its centre.
        if step_m not in own and abs(_turn(screened, step_m, turns).mean()) < 0.9 * _LEAST_SHARE:
            continue
        step = _tested(local, step_m, exactness_m)
        if step is not None:
            found.append(step)
            if step.share >= 1.0 - _lost(step.step_m, exactness_m):
                # No finer step can hold so much more.
                break
    if not found:
        return _NONE
    most = max(step.share for step in found)
    good = [step for step in found if step.share >= most - _lost(step.step_m, exactness_m)]
    best = max(good, key=lambda step: step.step_m)
    return _named(best, local, origin_m, per_unit, exactness_m)


def _turn(local: Floats, step_m: float, turns: dict[float, Turns]) -> Turns:
    """Return each coordinate (n,) as a turn of the circle, a whole one for each step, and keep it in ``turns``.

    The turns of twice or five times the step, where they are known, give it by products, which take a tenth of the time
    of an exponential.
    """
    of_double = turns.get(_twelve_digits(2.0 * step_m))
    of_fivefold = turns.get(_twelve_digits(5.0 * step_m))
    if of_double is not None:
        turn = of_double**2
    elif of_fivefold is not None:
        turn = of_fivefold**2
        turn = turn**2 * of_fivefold
    else:
        turn = np.exp((2j * math.pi / step_m) * local)
    turns[step_m] = turn
    return turn


def _twelve_digits(step: float) -> float:
    return float(f"{step:.12g}")


def _lost(step_m: float, exactness_m: float) -> float:
    return _SHARE_LOST + exactness_m / step_m


def _round_steps(per_unit: float) -> list[float]:
    """Return round steps of the metre and of the file's unit."""
    units = {1.0, per_unit}
    steps = [unit * mantissa * 10.0**decade for unit in units for decade in _DECADES for mantissa in _MANTISSAS]
    # Inches are written in sixteenths.
    steps += [per_unit * 2.0**-power for power in _BINARY]
    return [_twelve_digits(step) for step in steps]


def _steps_seen(local: Floats, exactness_m: float) -> list[float]:
    """Return the steps that values which repeat show: a voxel or an integer format may have any."""
    ordered = np.sort(local)
    starts = np.flatnonzero(np.concatenate([[True], np.diff(ordered) > 2.0 * exactness_m]))
    counts = np.diff(np.append(starts, len(ordered)))
    repeated = ordered[starts[counts >= _FEWEST_REPEATS]]
    gaps = np.sort(np.diff(repeated))
    steps = []
    for typical in {float(gaps[0]), float(gaps[len(gaps) // 2])} if len(gaps) > 2 else ():
        near = gaps[np.abs(gaps - typical) <= max(4.0 * exactness_m, 1e-3 * typical)]
        own = _sharpened(repeated, float(near.mean()))
        # A round number is the better guess at what was meant.
        decimal = float(f"{own:.4g}")
        steps.append(decimal if math.isclose(decimal, own, rel_tol=1e-5) else own)
    return steps


def _sharpened(ordered: Floats, step_m: float) -> float:
    """Return a step that is known to a part of itself so exactly that it holds over the whole extent."""
    reach = 100.0
    while reach * step_m < 2.0 * float(ordered[-1] - ordered[0]):
        near = ordered[ordered - ordered[0] <= reach * step_m] - ordered[0]
        number = np.rint(near / step_m)
        if number.any():
            step_m = float((number @ near) / (number @ number))
        reach *= 4.0
    number = np.rint((ordered - ordered[0]) / step_m)
    return float((number @ (ordered - ordered[0])) / (number @ number)) if number.any() else step_m


def _tested(local: Floats, step_m: float, exactness_m: float) -> _Step | None:
    """Return a step with the share of points on it, None where it is none."""
    window = 2.0 * exactness_m / step_m + 1e-7
    phase = local / step_m
    phase -= np.floor(phase)
    ordered = np.sort(phase)
    around = np.concatenate([ordered, ordered + 1.0])
    inside = np.searchsorted(around, ordered + 2.0 * window, side="right") - np.arange(len(ordered))
    first = int(inside.argmax())
    # Some lie there by chance.
    share = float(inside[first] / len(local)) - 2.0 * window
    if share < _LEAST_SHARE:
        return None
    offset = float(ordered[first]) - 1e-9
    place = local / step_m - offset
    number = np.floor(place + 0.25)
    is_on = np.abs(place - number - window) <= 1.1 * window + 1e-9
    sites, counts = np.unique(number[is_on], return_counts=True)
    if len(sites) < _FEWEST_SITES:
        return None
    beside = np.isin(sites + 1.0, sites) | np.isin(sites - 1.0, sites)
    follow = float(counts[beside].sum() / counts.sum())
    in_fullest = float(np.sort(counts)[::-1][: _MANY_SITES // 2].sum() / counts.sum())
    if follow < 0.5 and (len(sites) < _MANY_SITES or in_fullest > 0.8):
        return None
    return _Step(step_m, "lattice", min(1.0, share + 2.0 * window))


def _named(step: _Step, local: Floats, origin_m: float, per_unit: float, exactness_m: float) -> _Step:
    """Return a step with its kind: rounded numbers are whole multiples of a decimal or binary step of the unit."""
    in_steps = (local + origin_m) / step.step_m
    from_whole = np.abs(in_steps - np.rint(in_steps)) * step.step_m
    in_unit = step.step_m / per_unit
    is_round = any(
        math.isclose(in_unit / scale, 2.0 ** round(math.log2(in_unit / scale)), rel_tol=1e-9)
        for scale in (1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5)
    )
    is_whole = float(np.mean(from_whole <= 2.0 * exactness_m)) >= 0.9 * step.share
    return _Step(step.step_m, "rounded" if is_round and is_whole else "lattice", step.share)


def _find_turned_lattice(points: Floats) -> tuple[float, float]:
    """Return the edge of a cubic lattice on which points lie, however it is turned, and the share; 0 without one.

    On a lattice the distance to the nearest neighbour is the same everywhere; on measured surfaces it scatters by half.
    """
    if len(points) < 4 * _NEIGHBOURS:
        return 0.0, 0.0
    rng = np.random.default_rng(7)
    nearest_m = []
    for centre in rng.choice(len(points), _NEIGHBOURHOODS, replace=False):
        near = _nearest(points, points[centre])
        apart = ((near[:, None, :] - near[None, :, :]) ** 2).sum(axis=2)
        np.fill_diagonal(apart, np.inf)
        inner = np.argsort(np.abs(near - points[centre]).max(axis=1))[: _NEIGHBOURS // 2]
        nearest_m.append(np.sqrt(apart[inner].min(axis=1)))
        edge_m = float(np.median(nearest_m[0]))
        # Most scans are told from a lattice at the first place.
        if (
            edge_m < _FINEST_LATTICE_M
            or np.mean(np.abs(nearest_m[-1] / edge_m - 1.0) <= _SAME_DISTANCE) < _TURNED_SHARE
        ):
            return 0.0, 0.0
    every = np.concatenate(nearest_m)
    edge_m = float(np.median(every))
    return edge_m, float(np.mean(np.abs(every / edge_m - 1.0) <= _SAME_DISTANCE))


def _nearest(points: Floats, centre: Floats) -> Floats:
    """Return the points nearest to a place, by the largest difference of a coordinate."""
    some = points[np.abs(points[:, 0] - centre[0]) <= _WINDOW_M]
    some = some[np.abs(some[:, 1] - centre[1]) <= _WINDOW_M]
    some = some[np.abs(some[:, 2] - centre[2]) <= _WINDOW_M]
    if len(some) <= _NEIGHBOURS:
        some = points
    around = np.abs(some - centre).max(axis=1)
    return np.asarray(some[np.argpartition(around, _NEIGHBOURS)[:_NEIGHBOURS]], dtype=np.float64)
