"""Whose is each point, where surfaces are double? The layers part the order of the points in the file.

Two stations in one file have their points one after the other, and where surfaces are double, each layer is of one.
"""

import itertools
from dataclasses import dataclass

import numpy as np

from stair_inspector.geometry.arrays import Bools, Floats, Ints
from stair_inspector.stages.layers import SAME_WAY, Cells

FEWEST_LABELLED = 400
_PURE = 0.97
"""Share of the points of one part of the file that lie in one layer. The cut between layers takes noise for a layer's
point now and then."""
_MOST_PARTS, _FEWEST_IN_PART = 16, 100
_LEAST_OF_STATION = 0.02
_BLOCK, _SPARSE, _CLEAR = 500, 0.2, 0.8
"""Points in a row; the share of the usual number of told ones among them, and by how much one layer must outweigh the
other in them, below which they tell nothing."""
_MOST_UNTOLD, _MOST_LEFT = 0.3, 0.05
"""Share of the points about which the order says nothing, between the last of one station and the first of the next: as
doubled cells alone show it, and when those are told too that lie where the station of others is known."""
_FEWEST_OF_EACH = 8
_LEAST_OF_LAYER, _MOST_BETWEEN = 0.05, 0.5
"""Share of a cell's points that the thinner of two layers has, and what of so many may lie between the two."""
_MOST_PLACES = 2000


@dataclass(frozen=True, slots=True, eq=False)
class _Told:
    """Whether each point (n,) is of the station of the higher layer, and whether the order leaves that untold."""

    is_high: Bools
    is_untold: Bools


def tell_stations(
    points: Floats, cells: Cells, ways: list[tuple[Floats, Ints]], stride: int, layers_m: Floats
) -> Bools | None:
    """Return which points are of the second station, None where the order of the points does not tell.

    The cells hold every ``stride``-th point.
    """
    largest = layers_m[int(np.linalg.norm(layers_m, axis=1).argmax())]
    apart_m = float(np.linalg.norm(largest))
    for normal, members in ways:
        if not is_along(normal, largest):
            continue
        told = [_two_layers(cells, int(cell), normal, apart_m) for cell in members]
        rows, is_high = _together([each for each in told if each is not None])
        first = _by_order(points, stride * rows, is_high, _MOST_UNTOLD)
        if first is None:
            continue
        # What lies between the last of one and the first of the next goes with what is known where it lies.
        gap = first.is_untold[stride * cells.rows], first.is_high[stride * cells.rows]
        more = [_known_layers(cells, int(cell), normal, apart_m, *gap) for cell in members]
        rows, is_high = _together([(rows, is_high), *(each for each in more if each is not None)])
        second = _by_order(points, stride * rows, is_high, _MOST_LEFT)
        return None if second is None else second.is_high
    return None


def _together(told: list[tuple[Ints, Bools]]) -> tuple[Ints, Bools]:
    if not told:
        return np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.bool_)
    return np.concatenate([rows for rows, _ in told]), np.concatenate([is_high for _, is_high in told])


def _two_layers(cells: Cells, cell: int, normal: Floats, apart_m: float) -> tuple[Ints, Bools] | None:
    """Return which rows of a cell lie in two layers, and whether in the higher one; None where there is one layer."""
    own = slice(cells.starts[cell], cells.starts[cell] + cells.counts[cell])
    off = cells.points[own] @ normal
    low_m = _lower_of_two(off, apart_m)
    if low_m is None:
        return None
    off -= low_m + apart_m / 2.0
    is_near = np.abs(np.abs(off) - apart_m / 2.0) <= apart_m / 3.0
    return cells.rows[own][is_near], off[is_near] > 0.0


def _known_layers(
    cells: Cells, cell: int, normal: Floats, apart_m: float, is_untold: Bools, is_high: Bools
) -> tuple[Ints, Bools] | None:
    """Return the same of the points of a cell whose station is untold, from those whose station is known."""
    own = slice(cells.starts[cell], cells.starts[cell] + cells.counts[cell])
    off, untold, high = cells.points[own] @ normal, is_untold[own], is_high[own]
    of_low, of_high = off[~untold & ~high], off[~untold & high]
    if not untold.any() or max(len(of_low), len(of_high)) < _FEWEST_OF_EACH:
        return None
    is_low = len(of_low) >= len(of_high)
    middle = float(np.median(of_low)) + apart_m / 2.0 if is_low else float(np.median(of_high)) - apart_m / 2.0
    is_near = untold & (np.abs(np.abs(off - middle) - apart_m / 2.0) <= apart_m / 3.0)
    return cells.rows[own][is_near], off[is_near] > middle


def _lower_of_two(off: Floats, apart_m: float) -> float | None:
    """Return where the lower of two layers lies that are so far apart, None where there are no two.

    With their distance known, a layer that few points are of is found as well, where the cut in halves does not see it.
    """
    width_m = apart_m / 3.0
    ordered = np.sort(off)
    places = np.arange(ordered[0] - apart_m, ordered[-1], width_m / 4.0)
    if len(places) > _MOST_PLACES:
        return None

    def count(low: Floats, high: Floats) -> Ints:
        return np.searchsorted(ordered, high, side="right") - np.searchsorted(ordered, low, side="left")

    below, above = (
        count(places - width_m, places + width_m),
        count(places + apart_m - width_m, places + apart_m + width_m),
    )
    k = int((below + above).argmax())
    less = min(int(below[k]), int(above[k]))
    if less < max(_FEWEST_OF_EACH, _LEAST_OF_LAYER * len(off)):
        return None
    between = int(count(places[k] + width_m, places[k] + 2.0 * width_m))
    return float(places[k]) if between <= _MOST_BETWEEN * less else None


def _by_order(points: Floats, rows: Ints, is_high: Bools, most_untold: float) -> _Told | None:
    """Return of which station every point is, from the layer in which some of them lie."""
    if len(rows) < FEWEST_LABELLED:
        return None
    order = np.argsort(rows)
    rows, layer = rows[order], np.where(is_high[order], 1.0, -1.0)
    cuts = [0, *sorted(_cuts(layer, 0, _MOST_PARTS)), len(rows)]
    signs = []
    for begin, end in itertools.pairwise(cuts):
        part = layer[begin:end]
        if end - begin < _FEWEST_IN_PART or abs(float(part.mean())) < 2.0 * _PURE - 1.0:
            return None
        signs.append(part.mean() > 0.0)
    told = _Told(np.zeros(len(points), dtype=np.bool_), np.zeros(len(points), dtype=np.bool_))
    begin = 0
    for k, cut in enumerate(cuts[1:-1]):
        last, first = _widened(rows, layer, cut, 1.0 if signs[k] else -1.0)
        told.is_untold[last + 1 : first] = True
        # The scanner's head is somewhere else when the next station begins.
        end = last + 1 + int(np.linalg.norm(np.diff(points[last : first + 1], axis=0), axis=1).argmax())
        told.is_high[begin:end] = signs[k]
        begin = end
    told.is_high[begin:] = signs[-1]
    share = float(told.is_high.mean())
    is_told = told.is_untold.mean() <= most_untold and min(share, 1.0 - share) >= _LEAST_OF_STATION
    return told if is_told else None


def _widened(rows: Ints, layer: Floats, cut: int, sign: float) -> tuple[int, int]:
    """Return the ends of the stretch at a cut about which the order says nothing; ``sign`` is the layer before it.

    Where few of the points of a station lie in two layers, those are at edges, in either layer, and tell nothing.
    """
    counts, sums = np.bincount(rows // _BLOCK), np.bincount(rows // _BLOCK, layer)
    is_dense = counts >= _SPARSE * np.median(counts[counts > 0])
    last, first = int(rows[cut - 1]), int(rows[cut])
    before, after = last // _BLOCK, first // _BLOCK
    while before > 0 and not (is_dense[before] and sign * sums[before] >= _CLEAR * counts[before]):
        before -= 1
    while after < len(counts) - 1 and not (is_dense[after] and -sign * sums[after] >= _CLEAR * counts[after]):
        after += 1
    return min(last, (before + 1) * _BLOCK - 1), max(first, after * _BLOCK)


def _cuts(layer: Floats, begin: int, most: int) -> list[int]:
    """Return where a row of -1 and 1 goes over from one to the other, each place where sums before and after differ."""
    n = len(layer)
    if n < 2 * _FEWEST_IN_PART or most <= 1 or abs(float(layer.mean())) >= 2.0 * _PURE - 1.0:
        return []
    sums = np.cumsum(layer)
    cut = 1 + int(np.abs(sums - sums[-1] * np.arange(1, n + 1) / n)[:-1].argmax())
    return [
        *_cuts(layer[:cut], begin, most // 2),
        begin + cut,
        *_cuts(layer[cut:], begin + cut, most // 2),
    ]


def is_along(normal: Floats, shift: Floats) -> bool:
    """Return whether a unit normal and a shift lie along one direction, either way."""
    return abs(float(normal @ shift)) >= SAME_WAY * float(np.linalg.norm(shift))
