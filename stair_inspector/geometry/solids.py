"""The solids of a model: what of it lies inside one of them, where nobody could see it, and which way is out.

Models are often built of solids that overlap: a step that goes on under the next one. Takes triangles and points on
them; the way a triangle is wound is of no matter.
"""

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from stair_inspector.geometry.arrays import Bools, Floats, Ints
from stair_inspector.geometry.crossings import ClosedSurface
from stair_inspector.geometry.open3d import find_open3d

_MOST_SOLIDS = 300
_EXACTNESS = 1e-5
"""Of a solid's size: rays are cast in single precision."""
_WHOLLY = 0.999
_MOST_ASKED = 1_500_000
"""Points that are asked for in one call: two seconds. A flight of a dozen overlapping steps needs a third of it."""
_SIDE = np.array([0.31, 0.53, 0.79])
"""No surface of a building lies along this."""


class Interior(Protocol):
    """Tells what lies inside a solid, whose size is 1 here."""

    def holds(self, points: Floats) -> Bools:
        """Mark the points (m, 3) that lie deeper inside than rays can be wrong."""

    def surrounds(self, points: Floats) -> Bools:
        """Mark the points (m, 3) that lie inside."""


class CastRays:
    """The inside of a solid by Open3D's rays."""

    def __init__(self, open3d: Any, corners: Floats) -> None:
        self._as_tensor = open3d.core.Tensor
        self._rays = open3d.t.geometry.RaycastingScene(nthreads=1)
        local = corners.astype(np.float32).reshape(-1, 3)
        order = np.arange(len(local), dtype=np.uint32).reshape(-1, 3)
        self._rays.add_triangles(self._as_tensor(local), self._as_tensor(order))

    def holds(self, points: Floats) -> Bools:
        """Mark the points (m, 3) that lie deeper inside than rays can be wrong."""
        asked = self._as_tensor(points.astype(np.float32))
        is_inside = self._rays.compute_occupancy(asked, nthreads=1).numpy() > 0.5
        rows = np.flatnonzero(is_inside)
        is_inside[rows] = self._depths(points[rows]) > _EXACTNESS
        held: Bools = is_inside
        return held

    def surrounds(self, points: Floats) -> Bools:
        """Mark the points (m, 3) that lie inside."""
        inside: Bools = self._depths(points) > 0.0
        return inside

    def _depths(self, points: Floats) -> Floats:
        """Return how deep inside points (m, 3) lie; below zero outside."""
        asked = self._as_tensor(points.astype(np.float32))
        depth: Floats = -self._rays.compute_signed_distance(asked, nthreads=1, nsamples=3).numpy().astype(np.float64)
        return depth


class CountedCrossings:
    """The inside of a solid without Open3D."""

    def __init__(self, corners: Floats) -> None:
        self._surface = ClosedSurface(corners, _EXACTNESS)

    def holds(self, points: Floats) -> Bools:
        """Mark the points (m, 3) that lie deeper inside than rays can be wrong."""
        is_inside, is_near = self._surface.look(points)
        return is_inside & ~is_near

    def surrounds(self, points: Floats) -> Bools:
        """Mark the points (m, 3) that lie inside."""
        return self._surface.look(points)[0]


@dataclass(frozen=True, slots=True, eq=False)
class Solid:
    """A part of a model that is closed all around: its box (3,), and what tells its inside."""

    number: int
    low: Floats
    high: Floats
    interior: Interior

    @property
    def size(self) -> float:
        """Its largest extent."""
        return float((self.high - self.low).max())

    def holds(self, points: Floats) -> Bools:
        """Mark the points (m,) that lie inside, deeper than rays can be wrong."""
        return self.interior.holds((points - self.low) / self.size)

    def surrounds(self, points: Floats) -> Bools:
        """Mark the points (m,) that lie inside."""
        return self.interior.surrounds((points - self.low) / self.size)


@dataclass(frozen=True, slots=True, eq=False)
class ModelParts:
    """The parts of a model: ``part_of`` (n,) each triangle; ``solids``, None where there are more than 300."""

    part_of: Ints
    solids: tuple[Solid, ...] | None


def find_parts(corners: Floats) -> ModelParts:
    """Find the parts of a model, and which are solids.

    Parameters
    ----------
    corners : (n, 3, 3)
        Of distinct triangles with an area; corners at exactly the same place are one.

    Notes
    -----
    Triangles belong together where exactly two meet in an edge: solids that touch in an edge stay two.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    n = len(corners)
    _, vertex = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    vertex = vertex.reshape(n, 3)
    low = np.minimum(vertex, vertex[:, [1, 2, 0]])
    high = np.maximum(vertex, vertex[:, [1, 2, 0]])
    edges = (low * (int(vertex.max()) + 1) + high).ravel()
    face = np.repeat(np.arange(n), 3)
    order = np.argsort(edges, kind="stable")
    starts = np.flatnonzero(np.diff(edges[order], prepend=-1))
    pairs = starts[np.diff(starts, append=len(edges)) == 2]
    first, second = face[order[pairs]], face[order[pairs + 1]]
    links = coo_array((np.ones(len(first), dtype=np.int8), (first, second)), shape=(n, n))
    n_parts, found = connected_components(links, directed=False)
    part_of: Ints = found.astype(np.int64)
    # Closed: every edge of a part has an even number of its triangles.
    of_part = part_of[face]
    order = np.lexsort((edges, of_part))
    is_new = (np.diff(edges[order], prepend=-1) != 0) | (np.diff(of_part[order], prepend=-1) != 0)
    starts = np.flatnonzero(is_new)
    is_odd = np.diff(starts, append=len(edges)) % 2 == 1
    is_open = np.zeros(n_parts, dtype=np.bool_)
    is_open[of_part[order[starts[is_odd]]]] = True
    closed = np.flatnonzero(~is_open).tolist()
    if len(closed) > _MOST_SOLIDS:
        return ModelParts(part_of, None)
    return ModelParts(part_of, tuple(_solid(number, corners[part_of == number]) for number in closed))


def _solid(number: int, faces: Floats) -> Solid:
    low, high = faces.min(axis=(0, 1)), faces.max(axis=(0, 1))
    local = (faces - low) / float((high - low).max())
    open3d = find_open3d()
    return Solid(number, low, high, CountedCrossings(local) if open3d is None else CastRays(open3d, local))


def find_hidden(parts: ModelParts, points: Floats, on: Ints) -> Bools | None:
    """Mark the points (m,) that lie inside a solid of which they are no part; None where that is too much work.

    Parameters
    ----------
    parts : ModelParts
        Of the model.
    points : (m, 3)
        Points on its triangles.
    on : (m,)
        The triangle of each.

    Notes
    -----
    A part that lies wholly inside another one is not hidden by it: that is a room.
    """
    if parts.solids is None:
        return None
    is_hidden = np.zeros(len(points), dtype=np.bool_)
    own = parts.part_of[on]
    n_parts = int(parts.part_of.max()) + 1
    # Along one axis, the points near a solid are a stretch of the row.
    order = np.argsort(points[:, 0], kind="stable")
    along = points[order, 0]
    n_asked = 0
    for solid in parts.solids:
        first, last = np.searchsorted(along, [solid.low[0], solid.high[0]])
        rows = order[first:last]
        rows = rows[(own[rows] != solid.number) & ~is_hidden[rows]]
        rows = rows[((points[rows] > solid.low) & (points[rows] < solid.high)).all(axis=1)]
        n_asked += len(rows)
        if n_asked > _MOST_ASKED:
            return None
        if len(rows):
            rows = rows[solid.holds(points[rows])]
            n_inside = np.bincount(own[rows], minlength=n_parts)
            n_left = np.bincount(own[~is_hidden], minlength=n_parts)
            is_partly = n_inside < _WHOLLY * n_left
            is_hidden[rows[is_partly[own[rows]]]] = True
    return is_hidden


def outward_normals(corners: Floats, parts: ModelParts) -> tuple[Floats, Bools]:
    """Return the unit normals (n, 3) of triangles (n, 3, 3), and which (n,) are known to point out of a solid.

    Of the others always the same one of two opposite ways is taken. Opposite faces of a board thus have opposite
    normals, and two pictures of one surface the same.
    """
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals: Floats = across / np.sqrt((across * across).sum(axis=1))[:, None]
    normals[~is_front(normals)] *= -1.0
    is_outward = np.zeros(len(corners), dtype=np.bool_)
    for solid in parts.solids or ():
        rows = np.flatnonzero(parts.part_of == solid.number)
        is_outward[rows] = True
        beside = corners[rows].mean(axis=1) + 10.0 * _EXACTNESS * solid.size * normals[rows]
        normals[rows[solid.surrounds(beside)]] *= -1.0
    return normals, is_outward


def is_front(normals: Floats) -> Bools:
    """Mark the one half of all directions (n,): of a board's two faces, one is in it."""
    front: Bools = normals @ _SIDE >= 0.0
    return front
