"""Does the order of the points show that stations lie apart, where noise or rounding fills the gap between two layers?

Stations come one after the other in a file. What they saw of one surface differs in its mean by the shift between them,
and the mean of many points, on many cells of surface, is known far better than any of them.
"""

from dataclasses import dataclass

import numpy as np

from stair_inspector.geometry.arrays import Bools, Floats, Ints, freeze
from stair_inspector.geometry.percentiles import mad_sigma
from stair_inspector.stages.layers import Cells
from stair_inspector.stages.station_motion import OF_STEP

LEAST_APART_M = 0.0045
"""What is less is left to the uncertainty of registration that the scanner's preset states."""
_LEAST_SEEN_M = 0.003
"""The same of a first estimate: a plane through two layers that each cover a part of its cell takes some of it away."""
_FLAT = 0.5
_FEWEST_CELLS = 20
_MOST_OFF = 6.0
"""Points farther off their plane, in robust standard deviations, count no more than this."""
_SURE, _NEAR_BEST, _NEAR_LEAST = 10.0, 0.02, 40.0
"""Standard deviations by which the means before and after a place in the order must differ; and by what share of their
square, or by how much, it may be less where the same change may lie."""
_OF_LARGEST = 0.5
"""A change beside the largest is no smaller than this share of it: what edges do to a mean is."""
_FEWEST_PAIRED = 200.0
"""Weight of what lies on one cell both before and after: n1 n2 / (n1 + n2), added up over the cells."""
_MOST_PARTS = 16
_ONE_STATION = 0.3
"""Parts of the order whose offsets differ by less than this share of the whole are of one station; coordinates
on a step add half of one."""
_LEAST_PART = 0.02
"""Share of the points below which a part tells nothing of how stations lie."""
_MOST_UNTOLD = 0.06
"""Share of the points about which the order says nothing."""
_ROUNDS = 50


@dataclass(frozen=True, slots=True, eq=False)
class OrderShift:
    """Which points (n,) are of stations that lie lower along a unit ``normal`` (3,), as the order of the points shows.

    ``is_two`` says that there are two groups of stations, each in one place, ``is_told`` that it is known where each
    begins. ``noise_m`` is the standard deviation of single points.
    """

    normal: Floats
    is_low: Bools
    is_two: bool
    is_told: bool
    noise_m: float


@dataclass(frozen=True, slots=True, eq=False)
class _Row:
    """Points of flat cells in the order of the file: their rows, cells, and how far they lie off their cell's plane."""

    rows: Ints
    cell: Ints
    off_m: Floats
    sigma_m: float


@dataclass(frozen=True, slots=True)
class _Change:
    """A change of the mean: between which two points of a row it lies, how large, and the square of how sure it is."""

    last: int
    first: int
    apart_m: float
    sure: float


def find_order_shift(
    points: Floats, cells: Cells, ways: list[tuple[Floats, Ints]], stride: int, rounded_m: float = 0.0
) -> OrderShift | None:
    """Find where in the order of the points surfaces begin to lie elsewhere.

    Parameters
    ----------
    points : (n, 3), metres
        In the order of the file.
    cells, ways, stride
        Of every ``stride``-th point; the ways as :func:`flat_ways` gives them.
    rounded_m : float
        Step of the coordinates, by half of which parts of one station may lie apart.

    Returns
    -------
    OrderShift or None
        Of the direction in which it shows best; None where it shows in none, as where the order was lost.

    Notes
    -----
    The sum of what all points up to a place in the order are off their cell's plane is the difference of the means
    before and after it, each cell weighted as well as can be (n1 n2 / (n1 + n2)): a change point of the mean, by binary
    segmentation. Where one station passes over a cell it does so at once, so that what surfaces are like adds nothing.
    """
    best: tuple[float, OrderShift] | None = None
    rows = [_row_of(cells, normal, members) for normal, members in ways]
    # Where cells hold a corner, what they are off a plane is no noise: the flattest surfaces tell that.
    noise_m = min((row.sigma_m for row in rows), default=0.0)
    for row, (normal, _) in zip(rows, ways, strict=True):
        found = _change(row, 0, len(row.rows))
        if found is not None and (best is None or found.sure > best[0]):
            cuts = _cuts(row, 0, len(row.rows), _MOST_PARTS, _OF_LARGEST * found.apart_m)
            shift = _grouped(points, stride, row, cuts, normal, noise_m, rounded_m)
            best = best if shift is None else (found.sure, shift)
    return None if best is None else best[1]


def flat_ways(cells: Cells) -> list[tuple[Floats, Ints]]:
    """Return the directions that enough cells face without an edge in them, each with these; what leans is edges."""
    ways = [(normal, members[cells.flatness[members] <= _FLAT]) for normal, members in cells.ways()]
    return [(normal, members) for normal, members in ways if len(members) >= _FEWEST_CELLS]


def _row_of(cells: Cells, normal: Floats, members: Ints) -> _Row:
    is_own = np.zeros(len(cells.counts), dtype=np.bool_)
    is_own[members] = True
    at = np.flatnonzero(np.repeat(is_own, cells.counts))
    cell = np.repeat(np.arange(len(cells.counts)), cells.counts)[at]
    normals = cells.normals * np.sign(cells.normals @ normal)[:, None]
    off_m = np.einsum("ij,ij->i", cells.points[at] - cells.middles()[cell], normals[cell])
    sigma_m = max(mad_sigma(off_m), 1e-4)
    order = np.argsort(cells.rows[at])
    return _Row(
        cells.rows[at][order],
        cell[order],
        np.clip(off_m, -_MOST_OFF * sigma_m, _MOST_OFF * sigma_m)[order],
        sigma_m,
    )


def _change(row: _Row, begin: int, end: int, least_m: float = _LEAST_SEEN_M) -> _Change | None:
    """Return where the means of a stretch change, None where they do not by so much."""
    cell, off_m = row.cell[begin:end], row.off_m[begin:end]
    counts = np.bincount(cell)
    by_cell = np.argsort(cell, kind="stable")
    rank = np.zeros(len(cell), dtype=np.int64)
    rank[by_cell] = np.arange(len(cell)) - np.repeat(np.cumsum(counts) - counts, counts)
    middle = np.bincount(cell, off_m) / np.maximum(counts, 1)
    sums = np.cumsum(off_m - middle[cell])
    weights = np.cumsum(1.0 - (2.0 * rank + 1.0) / counts[cell])
    is_paired = weights >= _FEWEST_PAIRED
    if not is_paired.any():
        return None
    sure = np.where(is_paired, sums**2 / np.maximum(weights, 1.0), 0.0) / row.sigma_m**2
    k = int(sure.argmax())
    if sure[k] < _SURE**2 or abs(sums[k]) < least_m * weights[k]:
        return None
    # Only what hangs together with the best place.
    far = np.flatnonzero(sure < sure[k] - max(_NEAR_LEAST, _NEAR_BEST * sure[k]))
    low, high = far[far < k].max(initial=-1) + 1, far[far > k].min(initial=len(cell)) - 1
    return _Change(
        begin + int(low), begin + min(int(high) + 1, len(cell) - 1), abs(float(sums[k] / weights[k])), float(sure[k])
    )


def _cuts(row: _Row, begin: int, end: int, most: int, least_m: float) -> list[_Change]:
    """Return all places at which the means change, in order."""
    found = _change(row, begin, end, least_m) if most > 1 else None
    if found is None:
        return []
    before = _cuts(row, begin, found.last + 1, most // 2, least_m)
    return [*before, found, *_cuts(row, found.first, end, most // 2, least_m)]


def _grouped(
    points: Floats,
    stride: int,
    row: _Row,
    cuts: list[_Change],
    normal: Floats,
    noise_m: float,
    rounded_m: float,
) -> OrderShift | None:
    """Put the parts between cuts in two groups, by their offsets along the normal."""
    of = np.searchsorted(np.array([cut.first for cut in cuts]), np.arange(len(row.rows)), side="right")
    offsets = np.zeros(len(cuts) + 1)
    n_own, n_part = np.maximum(np.bincount(row.cell), 1), np.maximum(np.bincount(of, minlength=len(offsets)), 1)
    for _ in range(_ROUNDS):
        left = row.off_m - offsets[of]
        left -= (np.bincount(row.cell, left) / n_own)[row.cell]
        offsets += np.bincount(of, left, len(offsets)) / n_part
    is_large = n_part >= _LEAST_PART * len(row.rows)
    ordered = np.sort(offsets[is_large])
    if len(ordered) < 2:
        return None
    widest = int(np.diff(ordered).argmax())
    is_low = offsets <= ordered[widest : widest + 2].mean()
    spread = max(float(np.ptp(offsets[is_large & group])) for group in (is_low, ~is_low))
    of_point = np.zeros(len(points), dtype=np.bool_)
    begin, n_untold = 0, 0
    for part, cut in enumerate(cuts):
        last, first = stride * int(row.rows[cut.last]), stride * int(row.rows[cut.first])
        # The scanner's head is somewhere else when the next station begins.
        end = last + 1 + int(np.linalg.norm(np.diff(points[last : first + 1], axis=0), axis=1).argmax())
        n_untold += first - last - 1
        of_point[begin:end] = is_low[part]
        begin = end
    of_point[begin:] = is_low[-1]
    is_two = spread <= _ONE_STATION * float(ordered[widest + 1] - ordered[widest]) + OF_STEP * rounded_m
    is_told = n_untold <= _MOST_UNTOLD * len(points)
    return OrderShift(normal, freeze(of_point), is_two, is_told, noise_m)
