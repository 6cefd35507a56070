"""numpy's linear percentile as a look-up in values that are already sorted, and what medians are worth."""

import math

import numpy as np

from stair_inspector.geometry.arrays import Floats

MAD_TO_SIGMA = 1.4826
"""Standard deviation of normal values over the median of their absolute deviations."""
MEDIAN_NOISE = 1.25
"""Standard uncertainty of the median of normal values over that of their mean."""


def mad_sigma(values: Floats) -> float:
    """Return the standard deviation of values by the median of their absolute deviations from their median."""
    return MAD_TO_SIGMA * float(np.median(np.abs(values - np.median(values))))


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
