"""Was a scan taken from its origin, as a camera's frame is, and where did the camera look?"""

import math

import numpy as np

from stair_inspector.geometry.arrays import Floats, project
from stair_inspector.model import Scan

_CONE_DEG = 62.0
_IN_CONE, _LEAST_RANGE_M = 0.98, 0.1
_RAY_DEG = 1.0
_RAY_SPREAD = 0.1
_MOST_SPREAD_RAYS = 0.1
"""From where a camera stood one sees one surface in each direction, but for the edges."""


def is_view(scan: Scan, points: Floats) -> bool:
    """Return whether some points of a scan were taken from its origin, in one direction, as a camera's frame is."""
    if scan.origin_m.any():
        return False
    # What a camera sees between two surfaces may lie anywhere, also beside it.
    ranges = np.linalg.norm(points, axis=1)
    is_far = ranges > _LEAST_RANGE_M
    if np.count_nonzero(is_far) < _IN_CONE * len(points):
        return False
    ranges = ranges[is_far]
    rays = points[is_far] / ranges[:, None]
    ahead = rays.mean(axis=0)
    length = float(np.linalg.norm(ahead))
    is_in_cone = rays @ ahead >= length * math.cos(math.radians(_CONE_DEG))
    if length <= 0.0 or np.count_nonzero(is_in_cone) < _IN_CONE * len(points):
        return False
    side = 1.0 / math.radians(_RAY_DEG)
    cells = np.floor((rays + 1.0) * side).astype(np.int64)
    _, ray_of = np.unique(cells @ np.array([1, 1000, 1_000_000]), return_inverse=True)
    nearest = np.full(ray_of.max() + 1, np.inf)
    farthest = np.zeros(len(nearest))
    np.minimum.at(nearest, ray_of, ranges)
    np.maximum.at(farthest, ray_of, ranges)
    several = np.bincount(ray_of) > 1
    if not several.any():
        return False
    spread = (farthest - nearest)[several] > _RAY_SPREAD * nearest[several]
    return float(spread.mean()) <= _MOST_SPREAD_RAYS


def side_of_sensor(points: Floats, up: Floats) -> float:
    """Return how many more of the faces of a camera's view lie below the camera than above, as a share, -1 to 1."""
    return 0.0 if not len(points) else float(np.sign(-project(points.T, up)).mean())


def looks_down_deg(points: Floats, up: Floats) -> float:
    """Return by how much a camera at the origin looks down or up, degrees."""
    return abs(math.degrees(math.asin(float(np.clip(view_of(points) @ up, -1.0, 1.0)))))


def view_of(points: Floats) -> Floats:
    """Return where a camera at the origin looks, unit vector (3,)."""
    look = points.mean(axis=0)
    view: Floats = look / np.linalg.norm(look)
    return view
