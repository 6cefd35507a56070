"""Two scans of one small stair: the later one changed, and moved as a whole."""

import functools

import numpy as np

from stair_inspector.comparison.compare import compare_scans
from stair_inspector.params import NormalsParams, Params
from stair_inspector.pipeline import inspect
from tests.synthetic import Stair, make_scan, motion, rotation

WORN, TURNED, SETTLED = 2, 3, 5
"""The step whose nosing is worn by 3 mm, the one turned by 1 degree, the first of those that lie 4 mm lower."""
MOVED = motion(rotation("z", 130.0) @ rotation("x", 0.05), (3.0, -7.0, 0.4))
LAST = 6


def params(is_moved):
    """Settings that take the scan's own normals, and up as it is after the motion."""
    up = ",".join(repr(float(part)) for part in MOVED[:3, 2]) if is_moved else "z"
    return Params(unit="m", up=up, normals=NormalsParams(source="given"))


def points_of(seed, is_changed=False, is_moved=True, rise=0.17, spacing=0.01):
    """Points (n, 3) of the stair with noise of 1 mm, and their normals; it is built in its own frame, then moved."""
    stair = Stair(n_steps=LAST, rise=rise, spacing=spacing, risers=True, seed=seed)
    parts = [points.copy() for points, _ in stair.parts()]
    if is_changed:
        for k in stair.step_ids:
            tread, riser = parts[k], parts[stair.n_steps + k]
            if k == WORN:
                tread[tread[:, 0] < (k - 1) * stair.going + 0.05, 2] -= 0.003
            if k == TURNED:
                tread[:, 2] += np.tan(np.radians(1.0)) * (tread[:, 1] - stair.width / 2.0)
            if k >= SETTLED:
                tread[:, 2] -= 0.004
                riser[:, 2] -= 0.004
    normals = np.concatenate([normals for _, normals in stair.parts()])
    points = np.concatenate(parts)
    points = points + np.random.default_rng(seed + 1000).normal(0.0, 0.001, points.shape)
    return (points @ MOVED[:3, :3].T + MOVED[:3, 3], normals @ MOVED[:3, :3].T) if is_moved else (points, normals)


@functools.cache
def epoch(seed, is_changed=False, is_moved=True, rise=0.17, spacing=0.01):
    """A scan and its inspection."""
    points, normals = points_of(seed, is_changed, is_moved, rise, spacing)
    name = "later.ply" if is_moved else "earlier.ply"
    scan = make_scan(points, normals, name=name)
    return scan, inspect(scan, params(is_moved))


@functools.cache
def compared(is_changed, seed=1):
    """The comparison of two epochs, the later one changed or not."""
    return compare_scans(*epoch(seed, is_moved=False), *epoch(seed + 50, is_changed))
