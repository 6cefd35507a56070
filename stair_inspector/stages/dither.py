"""What lies on a step is spread over it: estimators that need continuous coordinates get them."""

from dataclasses import dataclass, replace

import numpy as np

from stair_inspector.geometry.arrays import Ints, freeze
from stair_inspector.model import Examination, HeightOrder, Horizontal, Levels, Scan

_SEED = 0
"""One and the same for every scan, so that the same file and settings give the same numbers."""
_FEW_SHARE = 0.05
"""Nearly every point repeats where a file repeats itself as a whole: all but this share."""


@dataclass(frozen=True, slots=True, eq=False)
class Spread:
    """The points that the survey measures, for those of the paper that they replace."""

    heights: HeightOrder
    horizontal: Horizontal
    levels: Levels
    is_stepped: bool


def spread_steps(
    scan: Scan, examined: Examination, heights: HeightOrder, horizontal: Horizontal, levels: Levels
) -> Spread:
    """Undo, as far as that can be done, that the coordinates of a scan were rounded.

    Parameters
    ----------
    scan, examined, heights, horizontal, levels
        Of one scan, as its file has it.

    Returns
    -------
    Spread
        What was given, where the coordinates lie on no step. Else every point lies somewhere within half a step of its
        place, evenly and at random but always the same, and counts as often as the file holds it. A point stays in its
        height cluster, even where it now lies above the lowest of the next.

    Notes
    -----
    A median, a percentile, or a share of points above a plane jumps from step to step; the scatter by median absolute
    deviation is zero or half a step. Even noise over one step makes the cumulative distribution of rounded values
    exactly right halfway between two values, and straight between. What rounding has taken away does not come back: the
    ``resolution`` part of an uncertainty holds it.

    A rounded file repeats positions where points are dense. To drop them would make dense places look as thin as
    others: in a riser's face the rows of points on either side of a rounding limit would weigh the same. In a file that
    repeats itself as a whole, every point counts as often less.

    References
    ----------
    .. [1] Schuchman: Dither signals and their effect on quantization noise, IEEE Trans. Comm. 12, 1964.
    """
    if not examined.steps_m.any():
        return Spread(heights, horizontal, levels, is_stepped=False)
    repeats = _repeats_of(scan, examined)
    # By place in the file, not among the chosen points: a region must not change what lies inside it.
    first = np.concatenate([[0], np.cumsum(repeats)])
    shifts = np.random.default_rng(_SEED).uniform(-0.5, 0.5, (int(first[-1]), 3)) * examined.steps_m
    turned = heights.level_from_scan @ shifts.T
    rows, numbers = _repeated(heights.point_ids, repeats, first)
    moved = heights.coordinates_m.take(rows, axis=1) + turned.take(numbers, axis=1)
    order = np.argsort(moved[2], kind="stable")
    rows = rows[order]
    spread_heights = replace(
        heights,
        point_ids=freeze(heights.point_ids.take(rows)),
        alignment=freeze(heights.alignment.take(rows)),
        coordinates_m=freeze(moved.take(order, axis=1)),
    )
    rows, numbers = _repeated(horizontal.point_ids, repeats, first)
    moved = horizontal.coordinates_m.take(rows, axis=1) + turned.take(numbers, axis=1)
    # Within its cluster, and between two clusters, by height.
    piece = np.searchsorted(np.sort(np.concatenate([levels.start, levels.stop])), rows, side="right")
    order = np.lexsort((moved[2], piece))
    ends = np.concatenate([[0], np.cumsum(repeats.take(horizontal.point_ids))])
    return Spread(
        spread_heights,
        replace(
            horizontal,
            point_ids=freeze(horizontal.point_ids.take(rows[order])),
            coordinates_m=freeze(moved.take(order, axis=1)),
        ),
        replace(levels, start=freeze(ends[levels.start]), stop=freeze(ends[levels.stop])),
        is_stepped=True,
    )


def _repeats_of(scan: Scan, examined: Examination) -> Ints:
    """Return how often every point of a scan counts."""
    # With full precision on one axis, two points at one place are one point twice.
    if scan.repeats is None or not examined.steps_m.all():
        return np.ones(len(scan.points), dtype=np.int64)
    usual = int(np.quantile(scan.repeats, _FEW_SHARE, method="lower"))
    counts: Ints = np.maximum(1, scan.repeats // usual)
    return counts


def _repeated(point_ids: Ints, repeats: Ints, first: Ints) -> tuple[Ints, Ints]:
    """Return the row of every point as often as it counts, ascending, and the number of each copy in the file."""
    counts = repeats.take(point_ids)
    rows = np.repeat(np.arange(len(point_ids)), counts)
    copy = np.arange(len(rows)) - np.repeat(np.cumsum(counts) - counts, counts)
    return rows, first.take(point_ids.take(rows)) + copy
