"""A part of a file: a box of it, and of a COPC the levels that a distance of points needs; laspy is the oracle."""

import io

import laspy
import numpy as np
import pytest
import trimesh

from stair_inspector.errors import ConfigError, ReadError
from stair_inspector.files.file_part import FilePart
from stair_inspector.files.las_scan import read_las
from stair_inspector.files.ply import ply_bytes
from stair_inspector.files.scans import read_scan
from stair_inspector.params import Params
from stair_inspector.pipeline import inspect
from tests.files.copc_files import copc_file
from tests.files.damage import N_DAMAGED, damaged, n_read_of_damaged
from tests.files.models import box, exported, stair_of_solids
from tests.files.test_las import las_file
from tests.synthetic import Stair

POINTS = np.round(np.random.default_rng(3).random((5000, 3)) * [6.0, 4.0, 3.0], 4)
BOX = ((1.0, 1.0, 1.0), (2.0, 2.0, 2.0))


def text_of(box):
    return ",".join(str(number) for corner in box for number in corner)


def found_by_laspy(content, bounds=None, resolution=None):
    """The points (n, 3) of a part as laspy's own reader of COPC finds them."""
    found = laspy.CopcReader(io.BytesIO(content)).query(bounds, resolution=resolution)
    return np.column_stack([found.x, found.y, found.z])


def by_rows(points):
    """Points in an order of their own."""
    return points[np.lexsort(points.T)]


@pytest.mark.parametrize("paged", [True, False])
def test_a_whole_copc_is_read_as_laspy_reads_it(paged):
    content, _ = copc_file(POINTS, paged=paged)
    assert np.array_equal(by_rows(read_las(content).points), by_rows(found_by_laspy(content)))


@pytest.mark.parametrize("box", [None, BOX, ((-1.0, 0.0, 0.0), (0.5, 9.0, 9.0)), ((3.3, 1.2, 0.1), (3.4, 1.9, 2.9))])
@pytest.mark.parametrize("detail_m", [0.0, 0.21, 0.2, 0.11, 0.1, 0.05, 0.01])
@pytest.mark.parametrize("paged", [True, False])
def test_a_part_of_a_copc_is_that_of_laspy(box, detail_m, paged):
    content, _ = copc_file(POINTS, paged=paged)
    bounds = None if box is None else laspy.copc.Bounds(np.array(box[0]), np.array(box[1]))
    wanted = found_by_laspy(content, bounds, detail_m or None)
    assert len(wanted), "the boxes hold points of every level"
    part = FilePart(box, detail_m)
    found = read_las(content, part).points
    assert np.array_equal(by_rows(found[part.holds(found)]), by_rows(wanted))


def test_no_more_cells_are_unpacked_than_the_box_touches(tmp_path):
    content, cells = copc_file(POINTS)
    (tmp_path / "a.laz").write_bytes(content)
    scan = read_scan(tmp_path / "a.laz", "m", crop=text_of(((0.0, 0.0, 0.0), (1.9, 1.9, 1.9))))
    # The octree begins at the lowest coordinates: its first cells of the three levels.
    n_read = sum(len(cells[level, 0, 0, 0]) for level in range(3))
    inside = int(np.all(POINTS <= 1.9, axis=1).sum())
    assert len(scan.points) == inside
    notes = {note.code: note.message for note in scan.notes}
    assert notes["part_read"] == f"{n_read:,} of 5,000 points read: those of 3 cells of the COPC"
    assert notes["cropped"].startswith(f"{inside:,} of {n_read:,} points read lie in the box")


@pytest.mark.parametrize("name", ["a.ply", "a.las", "a.csv"])
def test_every_format_is_cropped_in_its_own_coordinates(tmp_path, name):
    in_mm = POINTS * 1000.0
    contents = {
        "a.ply": ply_bytes(in_mm),
        "a.las": las_file(in_mm, scale=0.1),
        "a.csv": "\n".join(["x,y,z", *(f"{x:.1f},{y:.1f},{z:.1f}" for x, y, z in in_mm)]).encode(),
    }
    (tmp_path / name).write_bytes(contents[name])
    scan = read_scan(tmp_path / name, "mm", crop="1000,1000,1000,2000,2000,2000")
    wanted = POINTS[np.all((POINTS >= 1.0) & (POINTS <= 2.0), axis=1)]
    assert np.allclose(scan.points + scan.origin_m, wanted, rtol=0.0, atol=1e-9)
    assert scan.n_points == len(POINTS)


@pytest.mark.parametrize("name", ["a.ply", "a.copc.laz"])
def test_what_the_file_goes_on_with_beside_the_box_is_known(tmp_path, name):
    # The face x = 1.98 lies 20 mm before a border of the octree's cells.
    box = ((0.5, 0.5, 0.5), (1.98, 1.5, 1.5))
    (tmp_path / name).write_bytes(ply_bytes(POINTS) if name == "a.ply" else copc_file(POINTS)[0])
    scan = read_scan(tmp_path / name, "m", crop=text_of(box))
    assert scan.part.box_m.tolist() == [list(corner) for corner in box]
    beyond = scan.part.beyond_m + scan.origin_m
    assert not FilePart(box).holds(beyond).any()
    near = POINTS[np.all((np.array(box[0]) - 0.04 <= POINTS) & (np.array(box[1]) + 0.04 >= POINTS), axis=1)]
    wanted = near[~FilePart(box).holds(near)]
    assert np.count_nonzero(wanted[:, 0] > 2.0)
    assert {tuple(row) for row in wanted.round(4)} <= {tuple(row) for row in beyond.round(4)}
    assert np.abs(np.clip(beyond, *box) - beyond).max() <= 0.15
    assert read_scan(tmp_path / name, "m").part is None


def test_the_points_of_a_mesh_are_cropped(tmp_path):
    (tmp_path / "a.ply").write_bytes(exported(stair_of_solids(2), "a.ply"))
    scan = read_scan(tmp_path / "a.ply", "m", crop="0,0,0.1,1,1,1")
    assert len(scan.points) > 1000
    assert np.all((scan.points >= [0.0, 0.0, 0.1]) & (scan.points <= 1.0))


def test_a_part_of_a_large_mesh_is_sampled_as_densely_as_a_small_one(tmp_path):
    stair = stair_of_solids(2)
    far = [box([40.0 + k, 0.0, 0.0], [60.0 + k, 30.0, 0.3]) for k in range(4)]
    (tmp_path / "a.stl").write_bytes(exported(stair, "a.stl"))
    (tmp_path / "b.stl").write_bytes(exported(trimesh.util.concatenate([stair, *far]), "b.stl"))
    crop = "-1,-1,-1,2,2,2"
    alone, part = (read_scan(tmp_path / name, "m", crop=crop) for name in ("a.stl", "b.stl"))
    assert np.array_equal(part.points, alone.points)
    (told,) = [note.message for note in part.notes if note.code == "faces_sampled"]
    # Those of the four, and two of the stair that lie lower than the box.
    assert "faces, but for 50 away from the box, were sampled with" in told
    with pytest.raises(ReadError, match="has no faces in the box of --crop"):
        read_scan(tmp_path / "b.stl", "m", crop="-9,-9,-9,-8,-8,-8")


def test_the_box_of_a_gltf_is_that_of_the_scan_z_up(tmp_path):
    (tmp_path / "a.glb").write_bytes(exported(stair_of_solids(2), "a.glb"))
    whole = read_scan(tmp_path / "a.glb")
    low, high = whole.points.min(axis=0) - 0.1, whole.points.max(axis=0) + 0.1
    middle = float(np.median(whole.points[:, 2]))
    part = read_scan(tmp_path / "a.glb", crop=text_of((low, (*high[:2], middle))))
    assert 0 < len(part.points) < len(whole.points)
    assert part.points[:, 2].max() <= middle


def test_a_stair_is_measured_in_its_part_as_if_there_were_no_more(tmp_path):
    points = np.round(Stair(noise=0.002, risers=True).sample()[0], 4)
    beside = points + np.array([20.0, 0.0, 0.0])
    (tmp_path / "a.copc.laz").write_bytes(copc_file(np.concatenate([points, beside]), side=32.0)[0])
    (tmp_path / "b.las").write_bytes(las_file(points))
    box = text_of((points.min(axis=0) - 0.5, points.max(axis=0) + 0.5))
    part, alone = read_scan(tmp_path / "a.copc.laz", "m", crop=box), read_scan(tmp_path / "b.las", "m")
    assert np.array_equal(by_rows(part.points + part.origin_m), by_rows(alone.points + alone.origin_m))
    sizes = [[step.rise_m.value for step in inspect(scan, Params(up="z")).steps] for scan in (part, alone)]
    assert sizes[0] == pytest.approx(sizes[1], abs=1e-4)
    assert len(sizes[0]) == 5


@pytest.mark.parametrize(
    ("name", "options", "sentence"),
    [
        ("a.ply", {"crop": "9,9,9,10,10,10"}, "has no points in the box of --crop"),
        ("a.laz", {"crop": "9,9,9,10,10,10"}, "has no points in the box of --crop"),
    ],
)
def test_a_part_that_there_is_not_is_a_sentence(tmp_path, name, options, sentence):
    contents = {"a.ply": ply_bytes(POINTS), "a.las": las_file(POINTS), "a.laz": copc_file(POINTS)[0]}
    (tmp_path / name).write_bytes(contents[name])
    with pytest.raises(ReadError, match=sentence):
        read_scan(tmp_path / name, "m", **options)


@pytest.mark.parametrize(("name", "is_said"), [("a.ply", True), ("a.las", True), ("a.laz", False)])
def test_a_scan_without_levels_is_read_whole_and_that_is_said(tmp_path, name, is_said):
    contents = {"a.ply": ply_bytes(POINTS), "a.las": las_file(POINTS), "a.laz": copc_file(POINTS)[0]}
    (tmp_path / name).write_bytes(contents[name])
    scan = read_scan(tmp_path / name, "m", detail_m=0.1)
    assert ("detail_ignored" in {note.code for note in scan.notes}) == is_said
    assert (len(scan.points) == len(POINTS)) == is_said


@pytest.mark.parametrize("name", ["a.las", "a.laz"])
def test_a_station_of_las_and_copc_is_refused(tmp_path, name):
    (tmp_path / name).write_bytes(las_file(POINTS) if name == "a.las" else copc_file(POINTS)[0])
    with pytest.raises(ReadError, match="is of a format that has no stations; measure it without --station"):
        read_scan(tmp_path / name, "m", station="1")


def test_the_detail_is_in_metres_where_the_unit_is_stated(tmp_path):
    content, cells = copc_file(np.round(POINTS * 1000.0, 4), side=8000.0, spacing=200.0)
    (tmp_path / "a.laz").write_bytes(content)
    n_first = sum(len(rows) for key, rows in cells.items() if key[0] == 0)
    assert len(read_scan(tmp_path / "a.laz", "mm", detail_m=0.2).points) == n_first


@pytest.mark.parametrize("text", ["1,2,3", "a", "1,1,1,0,2,2", "nan,0,0,1,1,1", "0,0,0,inf,1,1"])
def test_an_impossible_box_is_refused_before_the_file_is_read(tmp_path, text):
    sentence = r"crop: got .*; give xmin,ymin,zmin,xmax,ymax,zmax in the file's own coordinates"
    with pytest.raises(ConfigError, match=sentence):
        Params(crop=text)
    with pytest.raises(ConfigError, match=sentence):
        read_scan(tmp_path / "there_is_none.ply", crop=text)


def test_two_hundred_damaged_octrees_give_a_sentence_or_points():
    content, _ = copc_file(POINTS)
    pages_at = int.from_bytes(content[469:477], "little")

    def struck(content, rng):
        changed = bytearray(damaged(content, rng))
        # The record of the octree and its pages are a small part of the file: strike them too.
        begin, end = ((0, 0), (429, 485), (pages_at, len(content)))[rng.integers(3)]
        if end and len(changed) == len(content):
            changed[int(rng.integers(begin, end))] ^= int(rng.integers(1, 256))
        return bytes(changed)

    assert (
        n_read_of_damaged("a.laz", content, seed=5, spoil=struck, unit="m", crop=text_of(BOX), detail_m=0.1)
        < N_DAMAGED - 50
    )


def test_a_page_that_names_itself_ends():
    content, _ = copc_file(POINTS)
    at = int.from_bytes(content[469:477], "little")
    n_bytes = int.from_bytes(content[477:485], "little")
    changed = bytearray(content)
    # The last entry of the first page names the other one: let it name its own.
    changed[at + n_bytes - 16 : at + n_bytes - 8] = at.to_bytes(8, "little")
    with pytest.raises(ReadError, match="is named twice"):
        read_las(bytes(changed), FilePart(BOX))
