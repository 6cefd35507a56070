"""The nodes of the scene: what a choice adds, it takes away again, and nothing is left of an earlier result."""

import dataclasses

import numpy as np
import pytest
import viser

from stair_inspector.content.document import SIGNS
from stair_inspector.files.projects import Measurement
from stair_inspector.pictures.frames import section_frame
from stair_inspector.pictures.segmentation import draw, view_from_local
from stair_inspector.viewer.scene.dimensions import dimensions_of
from stair_inspector.viewer.scene.measurements import drawing_of
from stair_inspector.viewer.scene.sections import cut, section_display
from stair_inspector.viewer.scene.stage import HIGHLIGHT, MODES, Stage
from stair_inspector.viewer.scene.step_marks import StepMark
from tests.viewer.surveyed import PALETTE, surveyed

SECTION = "/stair/section/"
MEASURED = "/stair/measured/"
LABELS = "/stair/segments/dimension_labels/"
REJECTED = "/stair/segments/rejected/"


@pytest.fixture(scope="module")
def server():
    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    yield server
    server.stop()


@pytest.fixture(scope="module")
def measured():
    return surveyed()


@pytest.fixture
def stage(server, measured):
    scan, inspection, display = measured
    # A server has the same scene to draw in as a page.
    stage = Stage(server)
    stage.show_scan(display, view_from_local(inspection), 0.01)
    stage.show_drawing(draw(inspection, display, scan.points, PALETTE), PALETTE, lambda step_id: None)
    yield stage
    stage.clear()


def names(server, prefix="/stair"):
    """Names of the nodes; viser makes the folders that they are in, and lets them stay."""
    found = {name for name in server.scene._handle_from_node_name if name.startswith(prefix)}
    folders = (LABELS, REJECTED, SECTION, MEASURED, f"{MEASURED}labels/")
    return found - {folder.rstrip("/") for folder in folders}


def numbers_shown(stage):
    return [name for (_, label), name in zip(stage._per_step, stage._step_names, strict=True) if label.visible]


def test_the_dimensions_of_a_step_come_and_go(server, stage, measured):
    _, inspection, _ = measured
    plain = names(server)
    stage.show_dimensions(2, dimensions_of(inspection, inspection.steps[1], 0.01), PALETTE)
    added = names(server) - plain
    assert added == {
        "/stair/segments/measuring",
        "/stair/segments/dimensions",
        *(f"{LABELS}{name}" for name in ("going", "tread", "rise", "width")),
    }
    # The last step has no going.
    stage.show_dimensions(5, dimensions_of(inspection, inspection.steps[4], 0.01), PALETTE)
    assert names(server, LABELS) == {f"{LABELS}{name}" for name in ("tread", "rise", "width")}
    stage.show_dimensions(None, None, PALETTE)
    assert names(server) == plain


def test_steps_outside_a_limit_are_outlined_and_their_numbers_have_a_sign(server, stage, measured):
    _, inspection, _ = measured
    plain = names(server)
    stage.show_marks({2: StepMark("bad", "rise"), 4: StepMark("close", "going")}, PALETTE)
    assert names(server) - plain == {"/stair/segments/outside"}
    assert [label.text for _, label in stage._per_step] == ["1", f"2 {SIGNS['bad']}", "3", f"4 {SIGNS['close']}", "5"]
    lines = server.scene._handle_from_node_name["/stair/segments/outside"]
    assert lines.points.shape == (8, 2, 3)
    # Above the tread, so that its points do not cover them.
    above = (lines.points[:4, 0] - inspection.steps[1].corners) @ inspection.up.vector
    assert above == pytest.approx(np.full(4, 2.0 * stage.point_size_m), abs=1e-5)
    stage.show_marks({}, PALETTE)
    assert names(server) == plain
    assert [label.text for _, label in stage._per_step] == ["1", "2", "3", "4", "5"]


def test_the_numbers_that_would_lie_under_the_dimensions_are_hidden_as_long(server, stage, measured):
    _, inspection, _ = measured
    assert numbers_shown(stage) == ["1", "2", "3", "4", "5"]
    stage.show_dimensions(3, dimensions_of(inspection, inspection.steps[2], 0.01), PALETTE)
    assert numbers_shown(stage) == ["1", "5"]
    stage.show_dimensions(1, dimensions_of(inspection, inspection.steps[0], 0.01), PALETTE)
    assert numbers_shown(stage) == ["3", "4", "5"]
    stage.show_dimensions(None, None, PALETTE)
    assert numbers_shown(stage) == ["1", "2", "3", "4", "5"]


def test_a_section_hides_the_lines_of_all_steps_and_the_numbers_of_those_it_does_not_cut(server, stage, measured):
    scan, inspection, display = measured
    slab = cut(section_frame(inspection, display.points, 3), "across", 0.0, 0.05, display.points)
    shown = section_display(scan, slab)
    lines = [stage._nodes[f"/stair/segments/{name}"] for name in ("edges", "nosings")]
    stage.show_section(shown.points, shown.colors, slab.corners, [3])
    assert numbers_shown(stage) == ["3"]
    assert not any(line.visible for line in lines)
    # A new result is drawn first, and then the section through it.
    stage.show_drawing(draw(inspection, display, scan.points, PALETTE), PALETTE, lambda step_id: None)
    lines = [stage._nodes[f"/stair/segments/{name}"] for name in ("edges", "nosings")]
    assert not any(line.visible for line in lines)
    stage.show_section(shown.points, shown.colors, None)
    assert numbers_shown(stage) == ["1", "2", "3", "4", "5"]
    assert all(line.visible for line in lines)


def test_a_step_without_dimensions_keeps_its_number(stage, measured):
    _, inspection, _ = measured
    bare = dataclasses.replace(inspection.steps[2], nosing=None)
    stage.show_dimensions(3, dimensions_of(inspection, bare, 0.01), PALETTE)
    assert numbers_shown(stage) == ["1", "2", "3", "4", "5"]


def test_the_names_of_rejected_surfaces_come_and_go(server, stage, measured):
    scan, inspection, display = measured
    plain = names(server)
    for with_rejected, wanted in ((True, {"surface 6", "surface 7"}), (False, set())):
        drawing = draw(inspection, display, scan.points, PALETTE, with_rejected=with_rejected)
        stage.show_drawing(drawing, PALETTE, lambda step_id: None)
        assert names(server, REJECTED) == {REJECTED + name for name in wanted}
    assert names(server) == plain


def test_a_surface_is_highlighted_by_its_points_and_a_step_by_its_outline_too(server, stage, measured):
    _, inspection, display = measured
    points = display.points[:10]
    stage.highlight(points, inspection.steps[0].corners, (1, 2, 3))
    assert {"/stair/segments/selected", "/stair/segments/outline"} <= names(server)
    np.testing.assert_array_equal(np.unique(stage._nodes["/stair/segments/selected"].colors.reshape(-1, 3)), [1, 2, 3])
    stage.highlight(points, None)
    assert "/stair/segments/outline" not in names(server)
    assert tuple(stage._nodes["/stair/segments/selected"].colors.reshape(-1, 3)[0]) == HIGHLIGHT
    stage.highlight(points[:0], None)
    assert "/stair/segments/selected" not in names(server)


def test_a_click_on_a_plate_chooses_its_own_step_also_when_numbers_are_missing(server, stage, measured):
    scan, inspection, display = measured
    fewer = dataclasses.replace(inspection, steps=inspection.steps[1:3])
    chosen = []
    stage.show_drawing(draw(fewer, display, scan.points, PALETTE), PALETTE, chosen.append)
    assert names(server, "/stair/segments/steps/") == {"/stair/segments/steps/2", "/stair/segments/steps/3"}
    assert numbers_shown(stage) == ["2", "3"]


def is_seen(stage, name):
    return stage._nodes[name].visible


def section_of(measured):
    scan, inspection, display = measured
    slab = cut(section_frame(inspection, display.points), "along", 0.0, 0.1, display.points)
    return section_display(scan, slab), slab


@pytest.mark.parametrize("mode", MODES)
def test_a_section_stands_in_for_the_clouds_in_every_mode_and_gives_them_back(server, stage, measured, mode):
    stage.set_mode(mode)
    clouds = ("/stair/raw", "/stair/segments/cloud", "/stair/segments/centres")
    before = [is_seen(stage, name) for name in clouds]
    extent = stage.extent
    shown, slab = section_of(measured)
    stage.show_section(shown.points, shown.colors, slab.corners)
    assert names(server, SECTION) == {f"{SECTION}cloud", f"{SECTION}outline"}
    assert len(stage._nodes[f"{SECTION}cloud"].points) == len(shown.points)
    assert [is_seen(stage, name) for name in clouds] == [False, False, False]
    # Edges and numbers stand where the section is, not beside it.
    np.testing.assert_array_equal(stage._nodes["/stair/segments"].position, 0.0)
    stage.show_section(shown.points, shown.colors, None)
    assert names(server, SECTION) == set()
    assert [is_seen(stage, name) for name in clouds] == before
    np.testing.assert_array_equal(stage.extent, extent)


def test_what_is_drawn_while_a_section_is_shown_does_not_cover_it(server, stage, measured):
    scan, inspection, display = measured
    shown, slab = section_of(measured)
    stage.show_section(shown.points, shown.colors, slab.corners)
    stage.show_drawing(draw(inspection, display, scan.points, PALETTE), PALETTE, lambda step_id: None)
    stage.highlight(display.points[:10], inspection.steps[1].corners)
    assert not is_seen(stage, "/stair/segments/centres")
    assert not is_seen(stage, "/stair/segments/selected")
    stage.show_section(shown.points, shown.colors, None)
    assert is_seen(stage, "/stair/segments/centres")
    assert is_seen(stage, "/stair/segments/selected")


def test_an_empty_section_is_an_outline_alone(server, stage, measured):
    shown, slab = section_of(measured)
    stage.show_section(shown.points[:0], shown.colors[:0], slab.corners)
    assert names(server, SECTION) == {f"{SECTION}outline"}
    assert not is_seen(stage, "/stair/segments/cloud")


def test_colours_are_replaced_in_place(stage, measured):
    scan, inspection, display = measured
    cloud = stage._nodes["/stair/segments/cloud"]
    colors = np.full((len(display.points), 3), 7, dtype=np.uint8)
    drawing = draw(inspection, display, scan.points, PALETTE, colors=colors)
    stage.show_drawing(drawing, PALETTE, lambda step_id: None)
    np.testing.assert_array_equal(stage._nodes["/stair/segments/cloud"].colors, colors)
    assert stage._nodes["/stair/segments/cloud"] is cloud


def test_measurements_come_and_go_and_stay_when_the_result_changes(server, stage, measured):
    scan, inspection, display = measured
    up, origin = inspection.up.vector, inspection.scan.origin_m
    first, second = (tuple(place + np.array(origin)) for place in (display.points[5], display.points[5000]))
    both = (Measurement("Distance 1", (first, second)), Measurement("Point 1", (first,)))
    plain = names(server)
    stage.show_measurements(drawing_of(both, first, origin, up, "mm", detailed=0))
    added = names(server) - plain
    assert {f"{MEASURED}lines", f"{MEASURED}legs", f"{MEASURED}points"} <= added
    assert {f"{MEASURED}labels/{name}" for name in ("1", "1v", "1h", "2", "waiting")} <= added
    assert stage._nodes[f"{MEASURED}points"].points.shape == (4, 3)
    stage.show_drawing(draw(inspection, display, scan.points, PALETTE), PALETTE, lambda step_id: None)
    assert names(server) - plain == added
    stage.show_measurements(drawing_of(both[1:], None, origin, up, "mm"))
    assert names(server) - plain == {f"{MEASURED}points", f"{MEASURED}labels/1"}
    stage.show_measurements(None)
    assert names(server) == plain


def test_the_points_of_every_cloud_grow_together(stage, measured):
    _, inspection, display = measured
    shown, slab = section_of(measured)
    stage.show_section(shown.points, shown.colors, slab.corners)
    point = Measurement("Point 1", (tuple(display.points[0]),))
    stage.show_measurements(drawing_of((point,), None, (0.0, 0.0, 0.0), inspection.up.vector, "mm"))
    clouds = ("/stair/raw", "/stair/segments/cloud", f"{SECTION}cloud", f"{MEASURED}points")
    before = np.array([stage._nodes[name].point_size for name in clouds])
    stage.set_point_size(0.02)
    np.testing.assert_allclose([stage._nodes[name].point_size for name in clouds], 2.0 * before)


def test_nothing_is_left_when_everything_is_cleared(server, stage, measured):
    scan, inspection, display = measured
    stage.show_drawing(
        draw(inspection, display, scan.points, PALETTE, with_rejected=True), PALETTE, lambda step_id: None
    )
    stage.show_dimensions(2, dimensions_of(inspection, inspection.steps[1], 0.01), PALETTE)
    stage.highlight(display.points[:10], inspection.steps[1].corners)
    shown, slab = section_of(measured)
    stage.show_section(shown.points, shown.colors, slab.corners)
    point = Measurement("Point 1", (tuple(display.points[0]),))
    stage.show_measurements(drawing_of((point,), None, (0.0, 0.0, 0.0), inspection.up.vector, "mm"))
    stage.clear()
    assert names(server) == set()
    # The next scan is not cut.
    stage.show_scan(display, view_from_local(inspection), 0.01)
    assert is_seen(stage, "/stair/segments/cloud")
