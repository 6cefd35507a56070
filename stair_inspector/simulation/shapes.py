"""A building as a mesh whose every surface is named, and the pieces it is put together from."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from stair_inspector.geometry.arrays import Floats, Ints, Point, own
from stair_inspector.model import NON_STAIR_LABEL
from stair_inspector.simulation.footprints import Flat
from stair_inspector.simulation.layout import StepTruth
from stair_inspector.simulation.specs import Stair

BuildingPart = Literal[
    "floor", "tread", "landing", "riser", "nosing", "side", "beam", "post", "wall", "ceiling", "clutter"
]

_LEAST_AREA_M2 = 1e-9
_ON_EDGE_M2 = 1e-12

COLOURS: dict[str, tuple[int, int, int]] = {
    "floor": (176, 172, 165),
    "tread": (201, 171, 132),
    "strip": (112, 88, 64),
    "riser": (226, 221, 210),
    "side": (198, 194, 186),
    "landing": (193, 163, 125),
    "beam": (92, 94, 98),
    "post": (92, 94, 98),
    "wall": (224, 219, 207),
    "ceiling": (238, 237, 232),
    "table": (142, 98, 62),
    "box": (170, 136, 92),
    "crate": (74, 106, 138),
    "rail": (70, 72, 76),
}
"""Colour in daylight of everything that is built."""


@dataclass(frozen=True, slots=True)
class BuiltSurface:
    """One flat or smooth surface: what it is part of, the level it belongs to (-1 none), its colour.

    ``label`` is what a perfect segmentation says of its points: 0 floor, k top of step k, -1 anything else. ``crease``
    is an axis (0 x, 1 y, 2 z) and a coordinate, metres in the stair frame, where light gets lost in an inner corner.
    """

    part: BuildingPart
    level: int
    rgb: tuple[int, int, int]
    label: int = NON_STAIR_LABEL
    crease: tuple[int, float] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Building:
    """What is scanned, as a mesh in the stair frame: a staircase and its surroundings, or a scene without any.

    ``mesh`` is a ``trimesh.Trimesh``; ``surface_of`` (n_triangles,) gives the surface of each of its faces. ``walk`` is
    the line along which it is scanned: from each of its points on, the ground has that point's height. ``stair`` is
    None and ``steps`` empty in a scene; ``scene`` is then its name.
    """

    stair: Stair | None
    mesh: Any
    surface_of: Ints
    surfaces: tuple[BuiltSurface, ...]
    steps: tuple[StepTruth, ...]
    walk: tuple[Point, ...]
    scene: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "surface_of", own(self.surface_of, (len(self.mesh.faces),), "surface_of", np.int64))


class Shapes:
    """Collects triangles and their surfaces."""

    def __init__(self) -> None:
        self._meshes: list[Any] = []
        self._surface_of: list[Ints] = []
        self._surfaces: list[BuiltSurface] = []

    def add(self, vertices: Floats, faces: Ints, surface: BuiltSurface) -> None:
        """Add triangles that form one surface; those without area, as at a nosing without overhang, are left out."""
        import trimesh

        a, b, c = (vertices[faces[:, corner]] for corner in range(3))
        faces = faces[np.abs(np.cross(b - a, c - a)).max(axis=1) > _LEAST_AREA_M2]
        if not len(faces):
            return
        self._meshes.append(trimesh.Trimesh(vertices=vertices, faces=faces, process=False))
        self._surface_of.append(np.full(len(faces), len(self._surfaces), dtype=np.int64))
        self._surfaces.append(surface)

    def quad(self, corners: Sequence[Point], surface: BuiltSurface) -> None:
        """Add a flat four-cornered surface, corners in order around it."""
        self.fan(corners, surface)

    def fan(self, corners: Sequence[Point], surface: BuiltSurface) -> None:
        """Add a flat convex surface, corners in order around it."""
        n = len(corners)
        faces = np.array([[0, corner, corner + 1] for corner in range(1, n - 1)], dtype=np.int64)
        self.add(np.array(corners, dtype=np.float64), faces, surface)

    def level(self, outline: Sequence[Flat], heights: Sequence[float], surface: BuiltSurface) -> None:
        """Add a flat surface with any outline that does not cross itself, counter-clockwise as seen from above."""
        if len(outline) < 3:
            return
        corners = [(x, y, z) for (x, y), z in zip(outline, heights, strict=True)]
        self.add(np.array(corners, dtype=np.float64), np.array(_ears(outline), dtype=np.int64), surface)

    def box(self, low: Point, high: Point, surface: BuiltSurface) -> None:
        """Add the six sides of an upright box."""
        import trimesh

        box = trimesh.creation.box(bounds=[low, high])
        normals = box.face_normals
        for axis in range(3):
            for sign in (-1.0, 1.0):
                faces = np.asarray(box.faces)[normals[:, axis] * sign > 0.5]
                self.add(np.asarray(box.vertices), faces, surface)

    def rod(self, start: Point, end: Point, radius_m: float, surface: BuiltSurface, *, sections: int = 12) -> None:
        """Add a round rod."""
        import trimesh

        rod = trimesh.creation.cylinder(radius=radius_m, segment=[start, end], sections=sections)
        self.add(np.asarray(rod.vertices), np.asarray(rod.faces), surface)

    def building(
        self, stair: Stair | None, steps: tuple[StepTruth, ...], walk: tuple[Point, ...], scene: str = ""
    ) -> Building:
        """Return everything that was added."""
        import trimesh

        mesh = trimesh.util.concatenate(self._meshes)
        return Building(stair, mesh, np.concatenate(self._surface_of), tuple(self._surfaces), steps, walk, scene)


def _ears(outline: Sequence[Flat]) -> list[tuple[int, int, int]]:
    """Return the triangles of a polygon, cut off ear by ear (Meisters, 1975); its few corners need nothing faster."""
    left = list(range(len(outline)))
    triangles: list[tuple[int, int, int]] = []
    while len(left) > 3:
        for index, corner in enumerate(left):
            before, after = left[index - 1], left[(index + 1) % len(left)]
            a, b, c = outline[before], outline[corner], outline[after]
            others = (outline[other] for other in left if other not in (before, corner, after))
            if _area2(a, b, c) > _ON_EDGE_M2 and not any(_is_inside(other, a, b, c) for other in others):
                triangles.append((before, corner, after))
                left.remove(corner)
                break
        else:
            # Nothing but corners on one line is left over.
            break
    return [*triangles, (left[0], left[1], left[2])]


def _area2(a: Flat, b: Flat, c: Flat) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _is_inside(point: Flat, a: Flat, b: Flat, c: Flat) -> bool:
    return all(_area2(start, stop, point) > -_ON_EDGE_M2 for start, stop in ((a, b), (b, c), (c, a)))
