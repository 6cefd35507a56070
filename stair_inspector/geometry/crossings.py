"""Which points lie inside a closed surface? Counts what a ray crosses, where Open3D cannot be loaded."""

from collections.abc import Iterator

import numpy as np

from stair_inspector.geometry.arrays import Bools, Floats, Ints

_PAIRS_AT_ONCE = 1_000_000
_MOST_CELLS = 256
"""Along one side of the grid."""
_TURN = np.linalg.qr(np.array([[0.31, 0.53, 0.79], [0.87, -0.41, 0.11], [0.23, 0.71, -0.59]]))[0]
"""Turns the surface so that the rays lie along no edge of a building."""


class ClosedSurface:
    """A closed surface of triangles ``corners`` (n, 3, 3); answers for points as near as ``tolerance`` to it.

    The triangles are sorted into the cells of a grid that the rays, all parallel, look at square on: a point is
    compared with the triangles of its cell alone.
    """

    def __init__(self, corners: Floats, tolerance: float) -> None:
        self._tolerance = tolerance
        self._corners = corners @ _TURN
        a, b, c = self._corners.transpose(1, 0, 2)
        normal = np.cross(b - a, c - a)
        self._normal = normal / np.linalg.norm(normal, axis=1)[:, None]
        self._offset = -(self._normal * a).sum(axis=1)
        # In the plane of each triangle, square to its sides and to its inside.
        sides = np.stack([b - a, c - b, a - c], axis=1)
        inward = np.cross(self._normal[:, None, :], sides)
        self._inward = inward / np.linalg.norm(inward, axis=2)[:, :, None]
        self._sort_into_cells()

    def _sort_into_cells(self) -> None:
        seen = self._corners[:, :, :2]
        low, high = seen.min(axis=1) - self._tolerance, seen.max(axis=1) + self._tolerance
        self._n = int(np.clip(2.0 * np.sqrt(len(seen)), 1, _MOST_CELLS))
        self._low = low.min(axis=0)
        self._cell = (high.max(axis=0) - self._low) / self._n
        first, last = self._cells_of(low), self._cells_of(high)
        wide, deep = (last - first + 1).T
        n_cells = wide * deep
        triangle = np.repeat(np.arange(len(seen)), n_cells)
        place = np.arange(len(triangle)) - np.repeat(np.cumsum(n_cells) - n_cells, n_cells)
        column = first[triangle, 0] + place % wide[triangle]
        cell = (first[triangle, 1] + place // wide[triangle]) * self._n + column
        self._triangles = triangle[np.argsort(cell, kind="stable")]
        self._count = np.bincount(cell, minlength=self._n**2)
        self._start = np.cumsum(self._count) - self._count

    def _cells_of(self, seen: Floats) -> Ints:
        cells: Ints = np.clip(((seen - self._low) / self._cell).astype(np.int64), 0, self._n - 1)
        return cells

    def look(self, points: Floats) -> tuple[Bools, Bools]:
        """Return which points (m, 3) lie inside (m,), and which lie on the surface as near as the tolerance (m,)."""
        is_inside, is_near = np.zeros(len(points), dtype=np.bool_), np.zeros(len(points), dtype=np.bool_)
        turned = points @ _TURN
        for rows, owner, triangle in self._pairs(turned):
            asked = turned[rows][owner]
            across = (asked * self._normal[triangle]).sum(axis=1) + self._offset[triangle]
            corners = self._corners[triangle]
            is_on = np.abs(across) <= self._tolerance
            beside = asked[is_on, None, :] - corners[is_on]
            is_on[is_on] = ((beside * self._inward[triangle[is_on]]).sum(axis=2) >= -self._tolerance).all(axis=1)
            is_near[rows] |= np.bincount(owner[is_on], minlength=len(rows)) > 0
            # A ray upwards meets the triangle in whose outline it stands, if the plane lies above it.
            to = corners[:, :, :2] - asked[:, None, :2]
            turn = to[:, :, 0] * to[:, [1, 2, 0], 1] - to[:, :, 1] * to[:, [1, 2, 0], 0]
            is_in_outline = (turn > 0.0).all(axis=1) | (turn < 0.0).all(axis=1)
            is_below = across * self._normal[triangle, 2] < 0.0
            crossed = np.bincount(owner[is_in_outline & is_below], minlength=len(rows))
            is_inside[rows] = crossed % 2 == 1
        return is_inside, is_near

    def _pairs(self, turned: Floats) -> Iterator[tuple[Ints, Ints, Ints]]:
        """Yield rows of points, and for each triangle to be compared with one of them its place in the rows."""
        is_seen = ((turned[:, :2] >= self._low) & (turned[:, :2] <= self._low + self._n * self._cell)).all(axis=1)
        asked = np.flatnonzero(is_seen)
        column, row = self._cells_of(turned[asked, :2]).T
        cell = row * self._n + column
        n_pairs = np.cumsum(self._count[cell])
        cuts = np.searchsorted(n_pairs, np.arange(_PAIRS_AT_ONCE, n_pairs[-1] if len(n_pairs) else 0, _PAIRS_AT_ONCE))
        for part in np.split(np.arange(len(asked)), cuts):
            count = self._count[cell[part]]
            owner = np.repeat(np.arange(len(part)), count)
            place = np.arange(len(owner)) - np.repeat(np.cumsum(count) - count, count)
            yield asked[part], owner, self._triangles[np.repeat(self._start[cell[part]], count) + place]
