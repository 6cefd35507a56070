"""The segmented scan: its fields are read back by other libraries and held against what the points were made as."""

import dataclasses
import io
import json
import sys

import laspy
import numpy as np
import pytest
import trimesh

from stair_inspector.cli import main
from stair_inspector.content.segmented_points import KINDS, residuals_at, segmented_points
from stair_inspector.errors import WriteError
from stair_inspector.files.palettes import read_palette
from stair_inspector.files.ply import ply_bytes
from stair_inspector.files.scans import find_scans, read_scan
from stair_inspector.writers.segmented import FIELDS, segmented_bytes
from tests.viewer.surveyed import STAIR, surveyed


@pytest.fixture(scope="module")
def measured():
    """Scan and survey of a stair with two rejected surfaces, 100 to 300 m from zero."""
    scan, inspection, _ = surveyed()
    return scan, inspection


def fields_of_ply(content):
    """Places, colours and the three fields as trimesh reads them."""
    cloud = trimesh.load(io.BytesIO(content), file_type="ply")
    data = cloud.metadata["_ply_raw"]["vertex"]["data"]
    return np.asarray(cloud.vertices), np.asarray(cloud.colors)[:, :3], [data[name] for name in FIELDS]


def fields_of_laz(content):
    """The same as laspy reads them."""
    las = laspy.read(io.BytesIO(content))
    colors = np.column_stack([las.red, las.green, las.blue])
    assert (colors % 257 == 0).all(), "255 stands for 65535"
    return las.xyz, (colors // 257).astype(np.uint8), [np.asarray(las[name]) for name in FIELDS]


READ = {"ply": fields_of_ply, "laz": fields_of_laz}
WITHIN_M = {"ply": 0.0, "laz": 0.00005 + 1e-9}
"""How far a coordinate may lie from the scan's: LAS rounds to 0.1 mm."""


@pytest.mark.parametrize("form", ["ply", "laz"])
def test_every_point_stands_in_its_place_with_step_kind_and_residual(measured, form):
    scan, inspection = measured
    places, colors, (steps, kinds, residuals) = READ[form](segmented_bytes(scan, inspection, form))
    assert np.abs(places - (scan.points + scan.origin_m)).max() <= WITHIN_M[form]
    assert np.array_equal(steps, inspection.labels)
    assert [field.dtype.str for field in (steps, kinds, residuals)] == ["<i2", "|u1", "<f4"]
    for step in inspection.steps:
        assert set(kinds[steps == step.step_id]) == {KINDS.index(step.kind)}
        # The noise of the stair is 1 mm, and the plane was fitted to these very points.
        assert np.std(residuals[steps == step.step_id]) == pytest.approx(0.001, rel=0.1)
    assert {step.kind for step in inspection.steps} == {"tread", "landing"}
    assert set(kinds[steps == 0]) == {KINDS.index("floor")}
    rejected = [patch.patch_id for patch in inspection.patches if patch.kind == "rejected"]
    assert np.array_equal(kinds == KINDS.index("rejected"), np.isin(inspection.patch_ids, rejected))
    assert np.isnan(residuals[steps < 0]).all()
    assert np.array_equal(colors, read_palette("paper").of_labels(inspection.labels)), "the scan has no colours"


@pytest.mark.parametrize("form", ["ply", "laz"])
def test_the_colours_of_the_scan_stay(measured, form):
    scan, inspection = measured
    own = np.random.default_rng(5).integers(0, 256, scan.points.shape).astype(np.uint8)
    _, colors, _ = READ[form](segmented_bytes(dataclasses.replace(scan, colors=own), inspection, form))
    assert np.array_equal(colors, own)


@pytest.mark.parametrize("form", ["ply", "laz"])
def test_the_same_input_gives_the_same_bytes_and_no_day(measured, form):
    content = segmented_bytes(*measured, form)
    assert content == segmented_bytes(*measured, form)
    if form == "laz":
        assert laspy.read(io.BytesIO(content)).header.creation_date is None


def test_a_rejected_level_of_the_papers_method_is_no_step(measured):
    scan, inspection = measured
    paper = dataclasses.replace(inspection, patch_ids=None, steps=inspection.steps[:-1])
    made = segmented_points(scan, paper)
    is_last = inspection.labels == len(inspection.steps)
    assert set(made.kinds[is_last]) == {KINDS.index("rejected")}
    assert set(made.steps[is_last]) == {-1}
    assert np.isnan(made.residuals_m[is_last]).all()


def test_a_point_a_hand_above_its_tread_has_that_residual(measured):
    _, inspection = measured
    step = inspection.steps[1]
    row = np.nonzero(inspection.labels == step.step_id)[0][:1]
    on_plane = step.plane.centroid + 0.004 * step.plane.normal
    assert residuals_at(inspection, on_plane[None], row) == pytest.approx([0.004])


def test_a_scan_wider_than_whole_tenths_of_a_millimetre_reach_is_coarser(measured):
    scan, inspection = measured
    points = scan.points.copy()
    # 2^31 tenths of a millimetre are 214 km.
    points[-1] += 300_000.0
    content = segmented_bytes(dataclasses.replace(scan, points=points), inspection, "laz")
    places, _, _ = fields_of_laz(content)
    assert np.abs(places - (points + scan.origin_m)).max() <= 0.0005 + 1e-6


@pytest.mark.parametrize("package", ["laspy", "lazrs"])
def test_without_its_packages_laz_is_refused_with_a_sentence_and_ply_is_written(measured, monkeypatch, package):
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(WriteError, match=r"needs the packages laspy and lazrs; write it as PLY"):
        segmented_bytes(*measured, "laz")
    assert len(fields_of_ply(segmented_bytes(*measured, "ply"))[0]) == len(measured[0].points)


def test_measure_writes_them_when_asked_and_takes_none_for_a_scan(tmp_path, capsys):
    (tmp_path / "stair.ply").write_bytes(ply_bytes(STAIR.sample()[0]))
    assert main(["measure", str(tmp_path / "stair.ply"), "-o", str(tmp_path), "--segmented", "laz", "ply"]) == 0
    said = capsys.readouterr().out
    assert "stair_segmented.laz" in said
    assert "stair_segmented.ply" in said
    assert find_scans([tmp_path]) == [tmp_path / "stair.ply"]
    again = read_scan(tmp_path / "stair_segmented.ply")
    assert len(again.points) == json.loads((tmp_path / "stair.json").read_text())["scan"]["n_used"]


def test_measure_never_writes_one_over_a_scan(tmp_path, capsys):
    for name in ("stair.ply", "stair_segmented.ply"):
        (tmp_path / name).write_bytes(ply_bytes(STAIR.sample()[0]))
    before = (tmp_path / "stair_segmented.ply").read_bytes()
    scans = [str(tmp_path / name) for name in ("stair.ply", "stair_segmented.ply")]
    assert main(["measure", *scans, "-o", str(tmp_path), "--segmented", "ply"]) == 2
    assert "would overwrite a scan" in capsys.readouterr().err
    assert (tmp_path / "stair_segmented.ply").read_bytes() == before
