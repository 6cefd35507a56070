"""Which triangle does each ray of a grid hit first? By numpy, tile by tile, where Open3D cannot be loaded."""

import numpy as np

from stair_inspector.geometry.arrays import Floats, Ints, Point

_TILE = 16
"""Rays along one side of a tile: few triangles are in sight through it."""
_SLACK = 1e-9
"""Two triangles that share an edge must leave no gap."""


class TiledRays:
    """Casts grids of rays at triangles ``corners`` (n, 3, 3), metres."""

    def __init__(self, corners: Floats) -> None:
        self._corners = corners

    def first_hits(self, origin: Point, directions: Floats) -> Ints:
        """Return the triangle that each ray hits first, -1 for none.

        Parameters
        ----------
        origin : three floats
            Frame of the corners, metres.
        directions : (rows, columns, 3)
            Unit vectors; neighbours in the grid are neighbours in space.

        Returns
        -------
        (rows, columns) int64
        """
        seen = self._corners - np.array(origin)
        following = seen[:, [1, 2, 0]]
        # A ray passes through a triangle on the inner side of the three planes through its origin and the sides.
        sides = np.cross(seen, following)
        lengths = np.linalg.norm(sides, axis=2, keepdims=True)
        sides = sides / np.where(lengths > 0.0, lengths, 1.0)
        inner = (sides * seen[:, [2, 0, 1]]).sum(axis=2, keepdims=True)
        sides = sides * np.sign(inner)
        facing = np.cross(seen[:, 1] - seen[:, 0], seen[:, 2] - seen[:, 0])
        facing /= np.linalg.norm(facing, axis=1, keepdims=True)
        distance = (facing * seen[:, 0]).sum(axis=1)
        hits = np.full(directions.shape[:2], -1, dtype=np.int64)
        for row in range(0, directions.shape[0], _TILE):
            for column in range(0, directions.shape[1], _TILE):
                tile = slice(row, row + _TILE), slice(column, column + _TILE)
                rays = directions[tile].reshape(-1, 3)
                known = _in_sight(rays, sides)
                first = _first(rays, sides[known], facing[known], distance[known])
                found = np.where(first < 0, -1, known[first]) if len(known) else first
                hits[tile] = found.reshape(directions[tile].shape[:2])
        return hits


def _in_sight(rays: Floats, sides: Floats) -> Ints:
    """Return which triangles rays (m, 3) may hit: of which no side has the whole cone around the rays outside."""
    axis = rays.sum(axis=0)
    axis /= np.linalg.norm(axis)
    least = float((rays @ axis).min())
    sine = np.sqrt(max(0.0, 1.0 - least * least)) if least > 0.0 else 1.0
    return np.flatnonzero((sides @ axis >= -sine - _SLACK).all(axis=1))


def _first(rays: Floats, sides: Floats, facing: Floats, distance: Floats) -> Ints:
    """Return the place of the nearest of some triangles (k, 3, 3) that each ray (m,) hits, -1 for none."""
    if not len(sides):
        return np.full(len(rays), -1, dtype=np.int64)
    within = (rays @ sides.reshape(-1, 3).T).reshape(len(rays), -1, 3).min(axis=2) >= -_SLACK
    slope = rays @ facing.T
    is_met = within & (slope * distance > 0.0)
    ranges = np.where(is_met, distance / np.where(is_met, slope, 1.0), np.inf)
    nearest: Ints = np.argmin(ranges, axis=1)
    return np.where(np.isfinite(ranges.min(axis=1)), nearest, -1)
