"""Whether a face of the region of interest cuts through a step, on points as sparse as far from the scanner."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from stair_inspector.codes import Verdict, check
from stair_inspector.files.ply import ply_bytes
from stair_inspector.files.rule_sets import find_rule_set
from stair_inspector.files.scans import read_scan
from stair_inspector.model import Up
from stair_inspector.params import Params
from stair_inspector.pipeline import inspect
from stair_inspector.stages.region import note_region_cuts
from tests.synthetic import Stair, make_scan, motion, rotation

UP = Up(np.array([0.0, 0.0, 1.0]), "given")
REGION = "-9,-9,-9,9,0.7,9"
"""Of a tread from y = 0 to 1 a part is left; what climbs along x has its left there."""


def tread(spacing_x, spacing_y, depth=0.28, width=1.0):
    """The points of a tread, which begins at x = 0, in rows."""
    x, y = np.arange(0.001, depth, spacing_x), np.arange(0.003, width, spacing_y)
    plan = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    return np.column_stack([plan, np.full(len(plan), 0.17)])


def sides_cut(points, spacing_m, keep=None):
    """The sides on which the region cuts the step that is all of the points within it."""
    inside = points[points[:, 1] <= 0.7] if keep is None else points[keep]
    step = SimpleNamespace(step_id=4, climb=np.array([1.0, 0.0, 0.0]))
    notes = note_region_cuts(make_scan(points), UP, REGION, [step], [inside], [spacing_m])
    assert all((note.code, note.step) == ("region_cuts", 4) for note in notes)
    return [note.message.split(" on its ")[1].split(":")[0] for note in notes]


@pytest.mark.parametrize(
    ("spacing_x", "spacing_y"), [(0.005, 0.005), (0.03, 0.02), (0.05, 0.03), (0.01, 0.06)], ids=str
)
def test_a_cut_is_seen_however_sparse_the_points(spacing_x, spacing_y):
    assert sides_cut(tread(spacing_x, spacing_y), np.sqrt(spacing_x * spacing_y)) == ["left"]


def test_a_cut_is_seen_where_only_a_strip_of_the_step_was():
    assert sides_cut(tread(0.015, 0.02, depth=0.05), 0.017) == ["left"]


@pytest.mark.parametrize("spacing_m", [0.005, 0.03])
def test_a_step_that_ends_at_the_face_by_itself_is_not_cut(spacing_m):
    assert sides_cut(tread(spacing_m, spacing_m, width=0.69), spacing_m) == []


def test_a_step_that_ends_well_inside_is_not_cut_by_what_lies_beyond():
    points = tread(0.01, 0.01)
    has_gap = points[(points[:, 1] < 0.6) | (points[:, 1] > 0.7)]
    assert sides_cut(has_gap, 0.01) == []


def test_a_corner_that_touches_the_face_is_no_edge():
    points = tread(0.005, 0.005)
    # Its side runs at 45 degrees and meets the face in a point.
    keep = points[:, 0] + points[:, 1] <= 0.71
    assert sides_cut(points, 0.005, keep) == []


STAIR = Stair(n_steps=4, noise=0.001, risers=True)


def limited(tmp_path, how, box):
    """The stair, 1 m wide and climbing along x, within a box: of its file, or as a region of interest."""
    (tmp_path / "a.ply").write_bytes(ply_bytes(STAIR.sample()[0]))
    text = ",".join(map(str, box))
    params = Params(up="z", unit="m")
    if how == "crop":
        return inspect(read_scan(tmp_path / "a.ply", "m", crop=text), params.replaced("crop", text))
    return inspect(read_scan(tmp_path / "a.ply", "m"), params.replaced("overrules.region", text))


@pytest.mark.parametrize("how", ["crop", "region"])
def test_a_width_that_ends_at_a_box_is_none_and_is_not_judged(tmp_path, how):
    inspection = limited(tmp_path, how, (-9, 0.2, -9, 9, 0.8, 9))
    name = "the region of interest" if how == "region" else "the box of the file that was read"
    assert [step.width_m for step in inspection.steps] == [None] * 4
    assert inspection.flights[0].width_m is None
    assert all(step.rise_m is not None for step in inspection.steps)
    (told,) = [note.message for note in inspection.notes if note.step == 2 and note.code == "region_cuts"]
    assert told.startswith(f"{name} cuts through step 2 on its left and right: its width is not that of the stair")
    found = [each for each in check(inspection, find_rule_set("us-ibc-2021")).findings if each.rule.quantity == "width"]
    assert len(found) >= 4
    assert {each.verdict for each in found} == {Verdict.NOT_MEASURED}
    assert told in [each.reason for each in found if each.steps == (2,)]


def test_a_step_whose_nosing_is_cut_off_gives_nothing_measured_from_it():
    # It climbs aslant to the region, which takes its lower left corner.
    stair = replace(STAIR, motion=motion(rotation("z", 45.0)))
    params = Params(up="z", unit="m").replaced("overrules.region", "-0.5,-9,-9,9,9,9")
    inspection = inspect(make_scan(stair.sample()[0]), params)
    first, second, third, _ = inspection.steps
    cuts = [note for note in inspection.notes if note.code.startswith("region_cuts")]
    assert [(note.code, note.step) for note in cuts] == [("region_cuts_front", 1), ("region_cuts", 1)]
    assert first.rise_m is first.going_m is first.tread_depth_m is first.width_m is second.rise_m is None
    assert inspection.flights[0].pitch_deg is None
    assert second.going_m.value == pytest.approx(STAIR.going, abs=0.003)
    assert third.rise_m.value == pytest.approx(STAIR.rise, abs=0.002)
    judged = check(inspection, find_rule_set("us-ibc-2021")).findings
    reasons = {each.steps: each.reason for each in judged if each.rule.quantity == "rise" and len(each.steps) == 1}
    assert reasons[1,] == reasons[2,] == cuts[0].message


@pytest.mark.parametrize("how", ["crop", "region"])
def test_a_box_around_the_stair_takes_no_value(tmp_path, how):
    inspection = limited(tmp_path, how, (-9, -0.02, -9, 9, 1.02, 9))
    assert not [note for note in inspection.notes if note.code.startswith("region_cuts")]
    assert all(step.width_m.value == pytest.approx(STAIR.width, abs=0.02) for step in inspection.steps)


def test_a_face_aslant_cuts_a_side_and_the_back():
    points = tread(0.005, 0.005) @ rotation("z", 45.0).T
    inside = points[points[:, 0] <= 0.0]
    step = SimpleNamespace(step_id=4, climb=rotation("z", 45.0) @ [1.0, 0.0, 0.0])
    notes = note_region_cuts(make_scan(points), UP, "-9,-9,-9,0.0,9,9", [step], [inside], [0.005])
    assert {note.code for note in notes} == {"region_cuts", "region_cuts_back"}
