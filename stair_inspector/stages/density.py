"""How close together do the points of a scan lie?"""

import numpy as np

from stair_inspector.geometry.arrays import Floats

_MOST_POINTS = 20_000
_PLACES = 40
_NEIGHBOURS = 12
_FLATTENING = 0.25


def reach_of_neighbours(points: Floats, k: int, sample: int) -> Floats:
    """Return the distance to the k-th neighbour of some of the points of level surfaces, of at most so many, metres.

    ``points`` (3, n) upright, with more than k points. Noise lifts neighbours apart, which is no spacing: heights count
    a quarter, and other levels stay far even so.
    """
    from sklearn.neighbors import KDTree

    rows = points.T * (1.0, 1.0, _FLATTENING)
    reach: Floats = KDTree(rows).query(rows[:: -(-len(rows) // sample)], k=k + 1)[0][:, -1]
    return reach


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
