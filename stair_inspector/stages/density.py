"""How close together do the points of a scan lie?"""

import numpy as np

from stair_inspector.geometry.arrays import Floats

_MOST_POINTS = 20_000
_PLACES = 40
_NEIGHBOURS = 12


def find_spacing(points: Floats) -> float:
    """Return the distance of neighbouring points on the surfaces of a scan, metres: the median over its points.

    Parameters
    ----------
    points : (n, 3), metres
        At least 50.

    Notes
    -----
    A thinned cloud has the same density but for the share that was kept, so neighbours are counted in few points.
    """
    every = -(-len(points) // _MOST_POINTS)
    some = points[::every]
    places = some[:: -(-len(some) // _PLACES)]
    apart = sum((some[None, :, k] - places[:, None, k]) ** 2 for k in range(3))
    # The first of the neighbours is the place itself.
    reach = np.sqrt(np.partition(apart, _NEIGHBOURS, axis=1)[:, _NEIGHBOURS])
    per_m2 = every * _NEIGHBOURS / (np.pi * np.maximum(reach, 1e-9) ** 2)
    return float(1.0 / np.sqrt(np.median(per_m2)))
