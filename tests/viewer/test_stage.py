"""The nodes of the scene: what a choice adds, it takes away again, and nothing is left of an earlier result."""

import dataclasses

import numpy as np
import pytest
import viser

from stair_inspector.viewer.dimensions import dimensions_of
from stair_inspector.viewer.scene import HIGHLIGHT, Stage, draw, view_from_local
from tests.viewer.surveyed import PALETTE, surveyed

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
    return found - {folder.rstrip("/") for folder in (LABELS, REJECTED)}


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


def test_the_numbers_that_would_lie_under_the_dimensions_are_hidden_as_long(server, stage, measured):
    _, inspection, _ = measured
    assert numbers_shown(stage) == ["1", "2", "3", "4", "5"]
    stage.show_dimensions(3, dimensions_of(inspection, inspection.steps[2], 0.01), PALETTE)
    assert numbers_shown(stage) == ["1", "5"]
    stage.show_dimensions(1, dimensions_of(inspection, inspection.steps[0], 0.01), PALETTE)
    assert numbers_shown(stage) == ["3", "4", "5"]
    stage.show_dimensions(None, None, PALETTE)
    assert numbers_shown(stage) == ["1", "2", "3", "4", "5"]


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


def test_nothing_is_left_when_everything_is_cleared(server, stage, measured):
    scan, inspection, display = measured
    stage.show_drawing(
        draw(inspection, display, scan.points, PALETTE, with_rejected=True), PALETTE, lambda step_id: None
    )
    stage.show_dimensions(2, dimensions_of(inspection, inspection.steps[1], 0.01), PALETTE)
    stage.highlight(display.points[:10], inspection.steps[1].corners)
    stage.clear()
    assert names(server) == set()
