"""Meshes in every format: one cloud whatever the format, that of the true stair; units, up, colours, no mesh."""

import base64
import json

import numpy as np
import pytest
import trimesh

from stair_inspector.errors import ReadError
from stair_inspector.files import raw_mesh
from stair_inspector.files.scans import FOLDER_SUFFIXES, SUFFIXES, find_scans, read_scan
from stair_inspector.geometry import solids
from stair_inspector.params import Params
from stair_inspector.pipeline import inspect
from stair_inspector.stages.examine import examine
from tests.files.models import box, exported, gltf_text, stair_of_solids

STAIR = stair_of_solids()
NAMES = ("a.ply", "ascii.ply", "a.obj", "a.off", "a.stl", "ascii.stl", "a.glb")
TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"


@pytest.fixture(autouse=True)
def few_points(monkeypatch):
    monkeypatch.setattr(raw_mesh, "MOST_POINTS", 4000)


def read(tmp_path, name, content, unit="m"):
    path = tmp_path / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return read_scan(path, unit)


def codes(scan):
    return [note.code for note in scan.notes]


# --- truth ---


@pytest.mark.parametrize("name", NAMES)
def test_every_format_gives_the_cloud_of_the_same_mesh(tmp_path, name):
    solid = box((0, 0, 0), (2.0, 1.0, 0.1875))
    expected = read(tmp_path, "plain.ply", exported(solid, "plain.ply"))
    scan = read(tmp_path, name, exported(solid, name), "auto" if name == "a.glb" else "m")
    assert len(scan.points) == 4000
    assert np.abs(scan.points - expected.points).max() < 1e-7
    assert codes(scan)[-1] == "faces_sampled"


@pytest.mark.parametrize(
    "name", ["a.ply", *(pytest.param(name, marks=pytest.mark.slow) for name in ("ascii.stl", "a.glb"))]
)
def test_the_stair_of_a_model_is_measured_as_it_is(tmp_path, name, monkeypatch):
    """Overlapping solids, a slab with an underside: a model of vertices that no method for clouds could measure."""
    monkeypatch.setattr(raw_mesh, "MOST_POINTS", 60_000)
    scan = read(tmp_path, name, exported(STAIR, name), "auto")
    assert "hidden_left_out" in codes(scan)
    result = inspect(scan, Params())
    rises = np.array([step.rise_m.value for step in result.steps])
    goings = np.array([step.going_m.value for step in result.steps if step.going_m])
    widths = np.array([step.width_m.value for step in result.steps])
    assert len(rises) == 5
    assert np.abs(rises - 0.175).max() < 0.0003
    assert np.abs(goings - 0.28).max() < 0.001
    assert np.abs(widths - 1.0).max() < 0.001
    assert result.up.vector @ [0.0, 0.0, 1.0] > 0.99999
    assert not result.examination


@pytest.mark.parametrize(("factor", "unit"), [(1.0, "m"), (1000.0, "mm"), (1 / 0.0254, "in")])
def test_the_unit_of_a_mesh_that_states_none_is_found_on_its_faces(tmp_path, factor, unit):
    scaled = STAIR.copy()
    scaled.apply_scale(factor)
    scan = read(tmp_path, "a.stl", exported(scaled, "a.stl"), "auto")
    assert scan.unit == unit
    assert "unit_guessed" in codes(scan)
    assert np.abs(scan.points.max(axis=0) - [1.4, 1.3, 0.875]).max() < 0.03


def test_gltf_states_metres_and_a_person_overrules_it(tmp_path):
    content = exported(STAIR, "a.glb")
    stated, overruled = read(tmp_path, "a.glb", content, "auto"), read(tmp_path, "a.glb", content, "mm")
    assert (stated.unit, overruled.unit) == ("m", "mm")
    assert codes(stated)[0] == "turned_z_up"
    assert "unit_guessed" not in codes(stated)
    # 3 mm across are sampled with few points.
    assert len(overruled.points) < 20
    assert np.abs(overruled.points).max() < 0.003


@pytest.mark.parametrize("name", ["a.ply", "a.obj", "a.off", "a.stl", "a.glb"])
def test_neither_the_winding_nor_doubled_faces_change_a_point(tmp_path, name):
    expected = read(tmp_path, name, exported(STAIR, name))
    rng = np.random.default_rng(1)
    faces = STAIR.faces.copy()
    flipped = rng.random(len(faces)) < 0.5
    faces[flipped] = faces[flipped][:, ::-1]
    twice = trimesh.Trimesh(STAIR.vertices, np.concatenate([faces, faces[:, [1, 2, 0]]]), process=False)
    again = read(tmp_path, name, exported(twice, name))
    assert np.array_equal(again.points, expected.points)
    assert np.array_equal(again.normals, expected.normals)
    assert np.array_equal(read(tmp_path, name, exported(STAIR, name)).points, expected.points)


# --- colours, polygons, points ---


def coff(mesh):
    """OFF with a colour at each vertex, which trimesh does not write."""
    rows = np.column_stack([mesh.vertices, mesh.visual.vertex_colors])
    lines = [" ".join(f"{value:g}" for value in row) for row in rows.tolist()]
    lines += [f"3 {a} {b} {c}" for a, b, c in mesh.faces.tolist()]
    return "\n".join(["COFF", f"{len(rows)} {len(mesh.faces)} 0", *lines, ""])


@pytest.mark.parametrize("name", ["a.ply", "ascii.ply", "a.obj", "a.coff", "a.glb"])
def test_colours_of_vertices_run_over_the_faces(tmp_path, name):
    solid = box((0, 0, 0), (1.0, 1.0, 1.0))
    colors = np.where(solid.vertices[:, [0, 0, 0]] > 0.5, [200, 100, 50], [0, 0, 0]).astype(np.uint8)
    solid.visual.vertex_colors = np.column_stack([colors, np.full(len(colors), 255)])
    content = coff(solid) if name == "a.coff" else exported(solid, name)
    scan = read(tmp_path, name, content)
    expected = np.rint(scan.points[:, :1] * [200, 100, 50])
    assert scan.colors is not None
    assert np.abs(scan.colors - expected).max() <= 1


POLYGON = np.array([[0, 0, 0], [2, 0, 0], [2, 0, 1], [1, 0, 1], [1, 0, 2], [0, 0, 2]], dtype=np.float64)
LINES = "".join(f"{x} {y} {z}\n" for x, y, z in POLYGON)
POLYGONS = {
    "a.obj": "# side\nmtllib none.mtl\no wall\n"
    + "".join(f"v {line}\n" for line in LINES.splitlines())
    + "f 1/1 2/2 3/3 4/4 5//5 -1\n",
    "a.off": f"OFF # a wall\n6 1 0\n{LINES}6 0 1 2 3 4 5 255 0 0\n",
    "a.ply": "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n"
    f"element face 1\nproperty uchar flag\nproperty list uchar int vertex_index\nend_header\n{LINES}7 6 0 1 2 3 4 5\n",
}


@pytest.mark.parametrize("name", POLYGONS)
def test_a_polygon_with_a_corner_inwards_is_sampled_within_its_bounds(tmp_path, name):
    scan = read(tmp_path, name, POLYGONS[name])
    x, y, z = scan.points.T
    assert not y.any()
    assert not ((x > 1.0) & (z > 1.0)).any()
    assert np.mean((x < 1.0) & (z < 1.0)) == pytest.approx(1 / 3, abs=0.01)


@pytest.mark.parametrize(
    ("name", "content"),
    [("a.obj", TRIANGLE + "v 5 6 7\n"), ("a.off", "OFF\n4 0 0\n0 0 0\n1 0 0\n0 1 0\n5 6 7\n")],
)
def test_a_mesh_without_faces_is_its_points(tmp_path, name, content):
    assert np.array_equal(read(tmp_path, name, content).points, [[0, 0, 0], [1, 0, 0], [0, 1, 0], [5, 6, 7]])


def test_a_cloud_with_a_few_faces_stays_a_cloud_and_says_so(tmp_path):
    rng = np.random.default_rng(1)
    points = rng.random((100, 3))
    lines = "".join(f"v {x} {y} {z}\n" for x, y, z in points.tolist())
    scan = read(tmp_path, "a.obj", lines + "f 1 2 3\n")
    assert np.array_equal(scan.points, points)
    assert [note.message for note in scan.notes] == ["its 1 faces were ignored: they join only 3 of 100 points"]


def test_points_of_a_gltf_are_read_and_turned(tmp_path):
    points = np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]])
    content = trimesh.Scene(trimesh.PointCloud(points)).export(file_type="glb")
    scan = read(tmp_path, "a.glb", content, "auto")
    assert np.array_equal(scan.points, [[1.0, -3.0, 2.0], [4.0, -6.0, 5.0]])
    assert scan.unit == "m"


def test_a_gltf_places_its_meshes(tmp_path):
    place = trimesh.transformations.compose_matrix(angles=[0.1, 0.2, 0.3], translate=[1, 2, 3], scale=[2, 2, 2])
    solid = box((0, 0, 0), (1.0, 0.5, 0.25))
    scene = trimesh.Scene()
    scene.add_geometry(solid, transform=place)
    placed = solid.copy()
    placed.apply_transform(place)
    scan = read(tmp_path, "a.glb", scene.export(file_type="glb"))
    x, y, z = scan.points.T
    inside = np.linalg.inv(place) @ np.stack([x, z, -y, np.ones(len(x))])
    off = np.abs(inside[:3].T - [0.5, 0.25, 0.125]) / [0.5, 0.25, 0.125]
    # On the surface of the placed box, all over it.
    assert np.abs(off.max(axis=1) - 1.0).max() < 1e-5
    assert np.ptp(scan.points, axis=0) == pytest.approx(np.ptp(placed.vertices[:, [0, 2, 1]], axis=0), rel=0.05)


def test_gltf_text_holds_its_numbers_or_is_refused(tmp_path):
    files = gltf_text(STAIR)
    root = json.loads(files["model.gltf"])
    with pytest.raises(ReadError, match=r"keeps its numbers in another file .*; export the mesh as GLB, one file"):
        read(tmp_path, "a.gltf", files["model.gltf"])
    for entry in root["buffers"]:
        entry["uri"] = "data:application/octet-stream;base64," + base64.b64encode(files[entry["uri"]]).decode()
    scan = read(tmp_path, "a.gltf", json.dumps(root))
    assert np.ptp(scan.points[:, 1]) == pytest.approx(0.925, rel=0.03)


# --- boundaries ---


def test_faces_without_area_or_not_finite_give_no_points_and_no_warning(tmp_path):
    odd = "v 2 2 2\nv nan 0 0\nv 1e9 0 0\nf 1 1 2\nf 1 2 4\nf 1 2 5\n"
    scan = read(tmp_path, "a.obj", TRIANGLE + odd.replace("1e9", "3") + "f 1 2 3\n")
    assert np.isfinite(scan.points).all()
    assert scan.points.max() <= 2.0


def test_the_ground_of_a_site_leaves_the_stair_its_points(tmp_path, monkeypatch):
    monkeypatch.setattr(raw_mesh, "MOST_POINTS", 60_000)
    site = trimesh.util.concatenate([STAIR, box((-500, -500, -0.2), (500, 500, -0.1))])
    scan = read(tmp_path, "a.stl", exported(site, "a.stl"))
    on_stair = (np.abs(scan.points) < 2.0).all(axis=1) & (scan.points[:, 2] > -0.06)
    assert on_stair.sum() > 10_000
    assert "the largest faces thinner" in scan.notes[0].message


def test_a_mesh_far_from_zero_in_float32_says_what_it_resolves(tmp_path):
    far = STAIR.copy()
    far.apply_translation([500_000.0, 5_400_000.0, 100.0])
    assert [(each.code, each.size_m) for each in examine(read(tmp_path, "a.stl", exported(far, "a.stl"))).observations][
        :1
    ] == [("coordinates_rounded", 0.5)]
    near = read(tmp_path, "b.stl", exported(STAIR, "b.stl"))
    assert near.stated_steps_m is not None
    assert near.stated_steps_m.max() < 2e-7
    assert read(tmp_path, "a.obj", exported(STAIR, "a.obj")).stated_steps_m is None


def test_more_overlapping_solids_than_can_be_looked_into_are_said(tmp_path, monkeypatch):
    content = exported(STAIR, "a.stl")
    hidden = read(tmp_path, "a.stl", content)
    monkeypatch.setattr(solids, "_MOST_ASKED", 10)
    kept = read(tmp_path, "a.stl", content)
    assert codes(kept) == ["faces_sampled", "hidden_kept"]
    assert len(kept.points) == 4000 > len(hidden.points)


def test_folders_and_uploads_offer_the_formats(tmp_path):
    for suffix in (".obj", ".stl", ".off", ".glb", ".gltf"):
        assert suffix in FOLDER_SUFFIXES
        assert suffix in SUFFIXES
        (tmp_path / f"a{suffix}").write_bytes(b"x")
    assert len(find_scans([tmp_path])) == 5
