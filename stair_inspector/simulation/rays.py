"""What does each ray hit, exactly? Rays near the edge of a triangle are decided in double precision."""

from typing import Any, Protocol

import numpy as np

from stair_inspector.geometry.arrays import Floats, Ints, Point
from stair_inspector.geometry.open3d import find_open3d
from stair_inspector.model import NON_STAIR_LABEL
from stair_inspector.simulation.ray_tiles import TiledRays
from stair_inspector.simulation.shapes import Building

MISS = -1
_AROUND = tuple((row, column) for row in (-1, 0, 1) for column in (-1, 0, 1) if (row, column) != (0, 0))


class FirstHits(Protocol):
    """Finds the triangle that each ray of a grid hits first; near an edge it may be the neighbour."""

    def first_hits(self, origin: Point, directions: Floats) -> Ints:
        """Return it (rows, columns) for unit vectors (rows, columns, 3), :data:`MISS` for none."""


class SceneRays:
    """Open3D's rays, in single precision."""

    def __init__(self, open3d: Any, vertices: Floats, faces: Ints) -> None:
        self._as_tensor = open3d.core.Tensor
        self._n_faces = len(faces)
        self._scene = open3d.t.geometry.RaycastingScene()
        self._scene.add_triangles(
            self._as_tensor(vertices.astype(np.float32)), self._as_tensor(faces.astype(np.uint32))
        )

    def first_hits(self, origin: Point, directions: Floats) -> Ints:
        """Return the triangle (rows, columns) that each ray hits first, :data:`MISS` for none."""
        rays = np.zeros((*directions.shape[:2], 6), dtype=np.float32)
        rays[..., :3] = origin
        rays[..., 3:] = directions
        hits: Ints = self._scene.cast_rays(self._as_tensor(rays))["primitive_ids"].numpy().astype(np.int64)
        hits[hits >= self._n_faces] = MISS
        return hits


class RayCaster:
    """Finds what rays hit, exactly."""

    def __init__(self, building: Building) -> None:
        vertices = np.asarray(building.mesh.vertices, dtype=np.float64)
        faces = np.asarray(building.mesh.faces, dtype=np.int64)
        open3d = find_open3d()
        self._rays: FirstHits = TiledRays(vertices[faces]) if open3d is None else SceneRays(open3d, vertices, faces)
        self.corner = vertices[faces[:, 0]]
        self.side_a = vertices[faces[:, 1]] - self.corner
        self.side_b = vertices[faces[:, 2]] - self.corner
        normal = cross_rows(self.side_a, self.side_b)
        self.normal = normal / np.sqrt(dot_rows(normal, normal))[:, None]
        self.offset = dot_rows(self.normal, self.corner)
        # The two axes that a triangle's plane is seen best along.
        self.flat_axes = np.argsort(np.abs(self.normal), axis=1, kind="stable")[:, :2]
        self.flat_axes.sort(axis=1)
        self.surface_of = building.surface_of
        surfaces = building.surfaces
        self.rgb = np.array([surface.rgb for surface in surfaces], dtype=np.float64)
        # A tread and its nosing strip lie in one plane: a row of cut squares between them would show in the density.
        labels = [surface.label for surface in surfaces]
        self.joint_of = np.array(
            [index if label == NON_STAIR_LABEL else labels.index(label) for index, label in enumerate(labels)]
        )
        self.crease_axis = np.array([surface.crease[0] if surface.crease else 0 for surface in surfaces])
        self.crease_at = np.array([surface.crease[1] if surface.crease else np.inf for surface in surfaces])

    def cast(self, origin: Point, directions: Floats) -> Ints:
        """Return the triangle that each ray of a grid hits, -1 for none.

        Parameters
        ----------
        origin : three floats
            Stair frame, metres.
        directions : (rows, columns, 3)
            Unit vectors of the grid.
        """
        return self._decided(origin, directions, self._rays.first_hits(origin, directions))

    def _decided(self, origin: Point, directions: Floats, hits: Ints) -> Ints:
        """Decide again, in double precision, the rays whose neighbours hit something else."""
        padded = np.pad(hits, 1, mode="edge")
        rows, columns = hits.shape
        around = [padded[1 + r : 1 + r + rows, 1 + c : 1 + c + columns] for r, c in _AROUND]
        is_seam = np.zeros(hits.shape, dtype=np.bool_)
        for neighbour in around:
            is_seam |= neighbour != hits
        rays = directions[is_seam]
        nearest = np.full(len(rays), np.inf)
        decided = np.full(len(rays), MISS, dtype=np.int64)
        for candidate in (hits, *around):
            ids = candidate[is_seam]
            range_m = self._range_if_inside(origin, rays, ids)
            is_nearer = range_m < nearest
            nearest[is_nearer] = range_m[is_nearer]
            decided[is_nearer] = ids[is_nearer]
        result = hits.copy()
        result[is_seam] = decided
        return result

    def _range_if_inside(self, origin: Point, rays: Floats, ids: Ints) -> Floats:
        """Return each ray's range to a triangle, infinite where it passes beside it.

        References
        ----------
        .. [1] Möller, Trumbore: Fast, minimum storage ray/triangle intersection, 1997.
        """
        side_a, side_b, corner = self.side_a[ids], self.side_b[ids], self.corner[ids]
        p = cross_rows(rays, side_b)
        determinant = dot_rows(side_a, p)
        is_crossing = np.abs(determinant) > 1e-15
        inverse = 1.0 / np.where(is_crossing, determinant, 1.0)
        t = np.array(origin)[None, :] - corner
        u = dot_rows(t, p) * inverse
        q = cross_rows(t, side_a)
        v = dot_rows(rays, q) * inverse
        range_m = dot_rows(side_b, q) * inverse
        slack = 1e-9  # Two triangles that share an edge must leave no gap.
        is_hit = is_crossing & (ids != MISS) & (u >= -slack) & (v >= -slack) & (u + v <= 1.0 + slack) & (range_m > 0.0)
        return np.where(is_hit, range_m, np.inf)

    def plane_range(self, origin: Point, rays: Floats, ids: Ints) -> Floats:
        """Return each ray's range to the plane of a triangle, metres; infinite or negative where it never meets it."""
        normal = self.normal[ids]
        along = dot_rows(normal, rays)
        height = self.offset[ids] - (normal[:, 0] * origin[0] + normal[:, 1] * origin[1] + normal[:, 2] * origin[2])
        is_crossing = np.abs(along) > 1e-12
        return np.where(is_crossing, height / np.where(is_crossing, along, 1.0), np.inf)


def dot_rows(a: Floats, b: Floats) -> Floats:
    """Return row-wise dot products; not by a library whose sums depend on the processor."""
    return a[:, 0] * b[:, 0] + a[:, 1] * b[:, 1] + a[:, 2] * b[:, 2]


def cross_rows(a: Floats, b: Floats) -> Floats:
    """Return row-wise cross products; not by a library whose sums depend on the processor."""
    return np.stack(
        [
            a[:, 1] * b[:, 2] - a[:, 2] * b[:, 1],
            a[:, 2] * b[:, 0] - a[:, 0] * b[:, 2],
            a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0],
        ],
        axis=1,
    )
