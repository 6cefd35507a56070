"""A mesh becomes a cloud: its faces are sampled evenly, since its corners alone are no picture of its surfaces.

Takes corners and faces as they stand in a file, gives points in the file's own unit.
"""

import math
from dataclasses import replace

import numpy as np

from stair_inspector.errors import ReadError
from stair_inspector.files.cleaning import check_range
from stair_inspector.files.cropping import find_near
from stair_inspector.files.file_part import WHOLE_FILE, FilePart
from stair_inspector.files.raw_cloud import READ_STAGE, RawCloud, RawMesh
from stair_inspector.geometry.arrays import Floats, Ints
from stair_inspector.geometry.polygons import triangulate
from stair_inspector.geometry.solids import find_hidden, find_parts, outward_normals
from stair_inspector.geometry.triangles import (
    areas_of,
    facet_of,
    find_distinct,
    in_fixed_order,
    points_per_triangle,
    sample_triangles,
)
from stair_inspector.model import Note
from stair_inspector.stages.units import DecidedUnit, decide_unit
from stair_inspector.units import METRES_PER_UNIT

SPACING_M = 0.005
"""As dense as a scanner of buildings sees stairs: 10,000 points on a usual tread."""
MOST_POINTS = 500_000
POINTS_FOR_UNIT = 100_000
_LEAST_AREA = 1e-15
"""A smaller share of the largest face is a line."""
_LEAST_USED = 0.5
"""A file in which fewer of the vertices belong to a face is a cloud that has some faces."""


def mesh_of_polygons(cloud: RawCloud, corners: Ints, lengths: Ints) -> RawCloud | RawMesh:
    """Return the mesh of vertices and polygons; the cloud of the vertices where hardly one belongs to a polygon.

    Parameters
    ----------
    cloud : RawCloud
        The vertices (v, 3).
    corners : (m,)
        Numbers of vertices from 0, polygon after polygon.
    lengths : (n,)
        Corners of each polygon.

    Raises
    ------
    ReadError
        A polygon names a vertex that is not there.
    """
    n_vertices = len(cloud.points)
    is_wrong = (corners < 0) | (corners >= n_vertices)
    if is_wrong.any():
        first = int(np.argmax(is_wrong))
        face = int(np.searchsorted(np.cumsum(lengths), first, side="right")) + 1
        raise ReadError(
            f"its face {face} names vertex {corners[first]} (counted from 0) but there are {n_vertices}; "
            "export the mesh again"
        )
    used = np.zeros(n_vertices, dtype=np.bool_)
    used[corners] = True
    n_used = int(used.sum())
    if n_used < _LEAST_USED * n_vertices:
        if not n_used:
            return cloud
        message = f"its {len(lengths):,} faces were ignored: they join only {n_used:,} of {n_vertices:,} points"
        return replace(cloud, notes=(*cloud.notes, Note("faces_ignored", READ_STAGE, message)))
    found = triangulate(cloud.points, corners, lengths)
    notes = cloud.notes
    if found.n_left_out:
        message = (
            f"{found.n_left_out:,} of {len(lengths):,} faces left out: they cross themselves or have too many corners "
            "that point inwards; a triangulated mesh settles it"
        )
        notes = (*notes, Note("faces_left_out", READ_STAGE, message))
    if not len(found.triangles):
        raise ReadError(f"none of its {len(lengths)} faces can be cut into triangles; export the mesh triangulated")
    colors = None if cloud.colors is None else cloud.colors.astype(np.float64)[found.triangles]
    return RawMesh(cloud.points[found.triangles], colors, None, notes)


def cloud_of_mesh(
    mesh: RawMesh, decided: DecidedUnit | None, part: FilePart = WHOLE_FILE
) -> tuple[RawCloud, DecidedUnit]:
    """Return points spread evenly over the faces of a mesh, and the unit of the file.

    Parameters
    ----------
    mesh : RawMesh
        As it was read.
    decided : DecidedUnit, optional
        As a person or the format stated it; without it points on all faces decide.
    part : FilePart
        Faces wholly outside of its box, and of what is looked at beside it, get no points.

    Returns
    -------
    RawCloud
        The same points whichever way faces are wound; faces that come twice are sampled once, and what lies
        inside another solid not at all. With the normals of the faces. Notes (stage ``read``):
        ``faces_sampled``, ``hidden_left_out`` or
        ``hidden_kept``, and those of the mesh.
    DecidedUnit
        As given, or with the note that says how it was decided.

    Raises
    ------
    ReadError
        No face with an area, or none near the box, or coordinates that are garbage.
    """
    values = _distinct_faces(mesh)
    faces = values[:, :, :3]
    areas = areas_of(faces)
    parts = find_parts(faces)
    if decided is None:
        few = points_per_triangle(areas, math.sqrt(float(areas.sum()) / POINTS_FOR_UNIT), POINTS_FOR_UNIT)
        points, on = sample_triangles(faces, few)
        hidden = find_hidden(parts, points, on)
        decided = decide_unit(points if hidden is None else points[~hidden])
    per_unit = METRES_PER_UNIT[decided.unit]
    near = np.flatnonzero(find_near(faces, part.box, per_unit))
    if not len(near):
        raise ReadError("has no faces in the box of --crop, which is in the file's own coordinates; give another")
    counts = points_per_triangle(areas[near], SPACING_M / per_unit, MOST_POINTS)
    sampled, on = sample_triangles(values[near], counts)
    # Which solid a face is of, and what that hides, all of the mesh tells.
    on = near[on]
    is_hidden = find_hidden(parts, sampled[:, :3], on)
    each = np.sqrt(areas[near] / counts) * per_unit
    thinner = ", the largest faces thinner" if each.max() > 1.001 * each.min() else ""
    beside = f", but for {len(areas) - len(near):,} away from the box," if len(near) < len(areas) else ""
    message = (
        f"a mesh: its {len(mesh.corners):,} faces{beside} were sampled with {len(sampled):,} points, about "
        f"{1000.0 * float(each.min()):.3g} mm apart{thinner}; what its maker smoothed, no U here holds"
    )
    notes = [*mesh.notes, Note("faces_sampled", READ_STAGE, message)]
    if is_hidden is None:
        message = "more of its solids overlap than can be looked into: what lies inside them was sampled too"
        notes.append(Note("hidden_kept", READ_STAGE, message))
    elif is_hidden.any():
        message = f"{int(is_hidden.sum()):,} of these points left out: they lie inside solids that overlap"
        notes.append(Note("hidden_left_out", READ_STAGE, message))
        sampled, on = sampled[~is_hidden], on[~is_hidden]
    colors = None if mesh.colors is None else np.rint(sampled[:, 3:]).astype(np.uint8)
    normals, is_outward = outward_normals(faces, parts)
    points = np.ascontiguousarray(sampled[:, :3])
    step, facet = _float32_step(faces), facet_of(faces, areas)
    return RawCloud(points, colors, normals[on], tuple(notes), is_outward[on], step=step, facet=facet), decided


def _float32_step(faces: Floats) -> Floats | None:
    """Return what float32 resolves on each axis (3,) where all corners are such numbers: points between hide it."""
    if not (faces == faces.astype(np.float32)).all():
        return None
    step: Floats = np.spacing(np.abs(faces).max(axis=(0, 1)).astype(np.float32)).astype(np.float64)
    return step


def _distinct_faces(mesh: RawMesh) -> Floats:
    """Return x, y, z and colour of the corners (k, 3, 3 or 6), in a fixed order, of faces that have an area."""
    is_finite = np.isfinite(mesh.corners).all(axis=(1, 2))
    if not is_finite.any():
        raise ReadError(f"none of its {len(mesh.corners)} faces has finite corners; export the mesh again")
    corners = mesh.corners[is_finite]
    check_range(corners)
    # Adding 0.0 turns -0.0 into 0.0, which would be another corner by its bits.
    order = in_fixed_order(corners)[:, :, None]
    corners = np.take_along_axis(corners, order, axis=1) + 0.0
    kept = np.flatnonzero(find_distinct(corners))
    areas = areas_of(corners[kept])
    kept = kept[areas > _LEAST_AREA * areas.max()]
    if not len(kept):
        raise ReadError(f"none of its {len(mesh.corners)} faces has an area; export the mesh again")
    values: Floats = corners[kept]
    if mesh.colors is None:
        return values
    colors = np.take_along_axis(mesh.colors[is_finite], order, axis=1)
    return np.concatenate([values, colors[kept]], axis=2)
