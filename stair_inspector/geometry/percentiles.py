"""numpy's linear percentile as a look-up in values that are already sorted, and what medians are worth."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stair_inspector.geometry.arrays import Floats, Ints

MAD_TO_SIGMA = 1.4826
"""Standard deviation of normal values over the median of their absolute deviations."""
MEDIAN_NOISE = 1.25
"""Standard uncertainty of the median of normal values over that of their mean."""


def mad_sigma(values: Floats) -> float:
    """Return the standard deviation of values by the median of their absolute deviations from their median."""
    return MAD_TO_SIGMA * median(np.abs(values - median(values)))


def median(values: Floats | Ints) -> float:
    """Return ``numpy.median(values)``, to the last bit, in less time; nan of none.

    Examples
    --------
    >>> import numpy as np
    >>> median(np.array([4.0, 1.0, 2.0]))
    2.0
    """
    n = len(values)
    if not n:
        return math.nan
    return median_of_sorted(np.partition(values, ((n - 1) // 2, n // 2)))


def median_of_sorted(ordered: NDArray[Any]) -> float:
    """Return the median of at least one value, in order."""
    n = len(ordered)
    return 0.5 * float(ordered[(n - 1) // 2] + ordered[n // 2])


def percentiles(values: Floats, *percents: float) -> list[float]:
    """Return ``numpy.percentile(values, percents)`` of at least one value, to the last bit, in less time.

    Examples
    --------
    >>> import numpy as np
    >>> percentiles(np.array([4.0, 1.0, 2.0]), 50, 75)
    [2.0, 3.0]
    """
    last = len(values) - 1
    below = [min(max(math.floor(last * (percent / 100.0)), 0), last) for percent in percents]
    # Of the order only these places matter.
    ordered = np.partition(values, sorted({*below, *(min(place + 1, last) for place in below)}))
    return [percentile_of_sorted(ordered, percent) for percent in percents]


def percentile_of_sorted(ordered: Floats, percent: float) -> float:
    """Return ``numpy.percentile(ordered, percent)``, to the last bit, in constant time.

    Parameters
    ----------
    ordered : (n,)
        Ascending values, at least one.
    percent : float
        0 to 100.

    Examples
    --------
    >>> import numpy as np
    >>> percentile_of_sorted(np.array([1.0, 2.0, 4.0]), 75)
    3.0
    """
    position = (len(ordered) - 1) * (percent / 100.0)
    below = min(max(math.floor(position), 0), len(ordered) - 1)
    above = min(below + 1, len(ordered) - 1)
    low, high = float(ordered[below]), float(ordered[above])
    share = position - below
    # Interpolate from the nearer end, as numpy does, so that the result never leaves the interval.
    return low + (high - low) * share if share < 0.5 else high - (high - low) * (1.0 - share)
