"""What is this scan like, before anything is measured in it?"""

import numpy as np

from stair_inspector.geometry.arrays import Floats, freeze
from stair_inspector.model import Examination, Observation, Scan

_MOST_VALUES = 100_000
_FEWEST_REPEATS = 4.0
"""Coordinates on a step repeat: so many points at least share each value, on the average."""
_SAME_SHARE = 0.02
"""Share of a step within which a coordinate lies on it."""


def examine(scan: Scan) -> Examination:
    """Examine a scan before it is measured.

    Parameters
    ----------
    scan : Scan
        In metres near zero.

    Returns
    -------
    Examination
        Observations, those of the reader first; the step of the coordinates on each axis.
    """
    steps_m = np.array([_find_step(axis) for axis in scan.points.T])
    found = list(scan.observations)
    if steps_m.any():
        largest_m = float(steps_m.max())
        message = f"the coordinates lie on a step of {largest_m * 1000.0:g} mm"
        found.append(Observation("coordinate_step", "info", message, largest_m, "export with more decimals"))
    return Examination(tuple(found), freeze(steps_m))


def _find_step(values: Floats) -> float:
    """Return the step on which coordinates lie, metres, 0 where there is none."""
    some = np.sort(values[:: -(-len(values) // _MOST_VALUES)])
    # Rounding of double precision, kilometres from the origin.
    distinct = some[np.concatenate([[True], np.diff(some) > 1e-8])]
    if len(distinct) < 2 or len(some) < _FEWEST_REPEATS * len(distinct):
        return 0.0
    step = float(np.median(np.diff(distinct)))
    number = np.rint((distinct - distinct[0]) / step)
    if len(distinct) > 2:
        step = float(np.polyfit(number, distinct - distinct[0], 1)[0])
    off = (distinct - distinct[0]) / step
    is_on = np.abs(off - np.rint(off)) <= _SAME_SHARE
    return step if is_on.mean() >= 1.0 - _SAME_SHARE else 0.0
