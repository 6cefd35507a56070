"""Which points are enough to see a rhythm? One in each voxel, so that frequent means much surface."""

import math
from dataclasses import dataclass

import numpy as np

from stair_inspector.geometry.arrays import Bools, Floats, Ints, project

_VOXEL_M = 0.02
_MOST_POINTS = 30_000
_FACES_COS = math.cos(math.radians(12.0))


@dataclass(frozen=True, slots=True, eq=False)
class Thinned:
    """Points (n, 3) of a scan thinned to an even density, and their unit normals, sign free."""

    points: Floats
    normals: Floats

    def face(self, axis: Floats) -> Bools:
        """Return which points lie on faces that are square to an axis, (3,)."""
        faces: Bools = np.abs(project(self.normals.T, axis)) >= _FACES_COS
        return faces


def thin(points: Floats, normals: Floats) -> Thinned:
    """Thin a scan to one point in each voxel, and to no more than are needed to see a rhythm."""
    ids = pick_thinned(points)
    return Thinned(points[ids], normals[ids])


def pick_thinned(points: Floats) -> Ints:
    """Return the indices of one point in each voxel, and of no more than are needed to see a rhythm."""
    ids = one_of_each_voxel(points, _VOXEL_M)
    if len(ids) > _MOST_POINTS:
        ids = np.sort(np.random.default_rng(0).choice(ids, _MOST_POINTS, replace=False))
    return ids


def one_of_each_voxel(points: Floats, voxel_m: float) -> Ints:
    """Return the index of one point of each cube of this side, in the order of the scan."""
    cells = np.floor((points - points.min(axis=0)) / voxel_m).astype(np.uint64)
    # Distinct cells of one hash are rare, and then only one point more is lost.
    code = cells @ np.array([0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9], dtype=np.uint64)
    return np.sort(np.unique(code, return_index=True)[1])
