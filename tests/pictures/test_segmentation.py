"""What is drawn, as plain data: the colours of the labels, the edges at the corners, the staircase upright."""

import dataclasses

import numpy as np
import pytest

from stair_inspector.files.palettes import read_palette
from stair_inspector.pictures.display import choose_display
from stair_inspector.pictures.segmentation import (
    MOST_REJECTED,
    draw,
    extent_of,
    is_left_hidden,
    points_of,
    view_from_local,
)
from stair_inspector.pipeline import inspect
from tests.synthetic import Stair, exact_params, make_scan, motion, rotation
from tests.viewer.surveyed import surveyed

PALETTE = read_palette("page")


@pytest.fixture(scope="module")
def scan():
    return Stair(noise=0.001, risers=True).scan()


@pytest.fixture(scope="module")
def inspection(scan):
    return inspect(scan, exact_params(method="paper"))


@pytest.mark.parametrize("most", [10**6, 700])
def test_every_displayed_point_has_the_colour_of_its_own_label(scan, inspection, most):
    display = choose_display(scan, most)
    drawing = draw(inspection, display, scan.points, PALETTE)
    table = {-1: PALETTE.non_stair, 0: PALETTE.floor} | {k: PALETTE.of_step(k) for k in range(1, 6)}
    expected = np.array([table[int(label)] for label in inspection.labels[display.point_ids]], dtype=np.uint8)
    np.testing.assert_array_equal(drawing.colors, expected)
    assert {tuple(color) for color in drawing.colors} == set(table.values())


def test_a_level_that_is_no_step_is_drawn_as_left_over(scan, inspection):
    fewer = dataclasses.replace(inspection, steps=inspection.steps[:2])
    drawing = draw(fewer, choose_display(scan), scan.points, PALETTE)
    assert (drawing.colors[inspection.labels > 2] == np.array(PALETTE.non_stair)).all()
    assert (drawing.colors[inspection.labels == 2] == np.array(PALETTE.of_step(2))).all()
    assert drawing.labels == ("1", "2")
    assert len(drawing.corners) == 2


def test_edges_join_the_corners_in_their_colours_just_above_the_surface(scan, inspection):
    display = choose_display(scan)
    drawing = draw(inspection, display, scan.points, PALETTE)
    assert drawing.edges.shape == (20, 2, 3)
    assert drawing.edge_colors.shape == (20, 3)
    up = inspection.up.vector
    for step, edges, colors in zip(
        inspection.steps, drawing.edges.reshape(5, 4, 2, 3), drawing.edge_colors.reshape(5, 4, 3), strict=True
    ):
        front_left, front_right, back_right, back_left = step.corners
        flat = edges - (edges - step.corners[0]) @ up[:, None] * up
        wanted = {
            PALETTE.side_edge: [(front_left, back_left), (front_right, back_right)],
            PALETTE.back_edge: [(back_left, back_right)],
            PALETTE.front_edge: [(front_left, front_right)],
        }
        for color, segments in wanted.items():
            segments = [ends - (np.array(ends) - step.corners[0]) @ up[:, None] * up for ends in segments]
            found = flat[(colors == np.array(color)).all(axis=1)]
            np.testing.assert_allclose(found, segments, atol=1e-9)
        lift = (edges[3, 0] - front_left) @ up
        assert 0.0 < lift <= display.spacing_m + 2.0 * step.plane.rms_m + 1e-12


def test_the_centres_are_the_nearest_points(scan, inspection):
    drawing = draw(inspection, choose_display(scan), scan.points, PALETTE)
    wanted = np.concatenate([scan.points[step.nearest_ids] for step in inspection.steps])
    np.testing.assert_array_equal(drawing.centres, wanted)


def test_without_steps_there_is_nothing_but_the_cloud(scan, inspection):
    drawing = draw(dataclasses.replace(inspection, steps=()), choose_display(scan), scan.points, PALETTE)
    assert drawing.edges.shape == (0, 2, 3)
    assert drawing.centres.shape == (0, 3)
    assert (drawing.corners, drawing.labels) == ((), ())


@pytest.mark.parametrize("turn", [np.eye(3), rotation("z", 130.0), rotation("x", 75.0) @ rotation("y", -40.0)])
def test_the_view_has_up_along_z_and_the_climb_along_y(turn):
    stair = Stair(noise=0.0005, risers=True, motion=motion(turn))
    inspection = inspect(stair.scan(), exact_params(up=stair.up))
    view = view_from_local(inspection)
    np.testing.assert_allclose(view @ view.T, np.eye(3), atol=1e-9)
    assert np.linalg.det(view) == pytest.approx(1.0)
    np.testing.assert_allclose(view @ turn[:, 2], [0.0, 0.0, 1.0], atol=1e-6)
    # The axes are measured: a degree is far more than their error here.
    assert (view @ turn[:, 0])[1] > np.cos(np.radians(1.0))


@pytest.mark.parametrize("up", ["z", "x", "-y"])
def test_without_axes_the_view_is_upright_all_the_same(inspection, up):
    vector = {"z": [0, 0, 1], "x": [1, 0, 0], "-y": [0, -1, 0]}[up]
    bare = dataclasses.replace(
        inspection, axes=None, up=dataclasses.replace(inspection.up, vector=np.array(vector, dtype=float))
    )
    view = view_from_local(bare)
    assert np.linalg.det(view) == pytest.approx(1.0)
    np.testing.assert_allclose(view @ np.array(vector), [0.0, 0.0, 1.0], atol=1e-12)


def test_a_few_far_points_do_not_make_the_extent(scan):
    stray = np.vstack([scan.points, [[500.0, 0.0, 0.0]]])
    assert np.ptp(extent_of(stray), axis=0).max() < 3.0


def test_the_nosing_lines_of_the_survey_take_the_place_of_the_front_edges():
    scan, inspection, display = surveyed()
    drawing = draw(inspection, display, scan.points, PALETTE)
    assert drawing.nosings.shape == (5, 2, 3)
    for step, nosing in zip(inspection.steps, drawing.nosings, strict=True):
        lift = nosing - step.nosing
        np.testing.assert_allclose(lift[0], lift[1])
        np.testing.assert_allclose(lift[0], (lift[0] @ inspection.up.vector) * inspection.up.vector, atol=1e-12)
        assert 0.0 < lift[0] @ inspection.up.vector <= display.spacing_m + 2.0 * step.plane.rms_m + 1e-12
    assert len(drawing.edges) == 15
    assert not (drawing.edge_colors == np.array(PALETTE.front_edge)).all(axis=1).any()


def test_a_step_whose_nosing_is_not_known_keeps_its_front_edge():
    scan, inspection, display = surveyed()
    steps = (dataclasses.replace(inspection.steps[0], nosing=None), *inspection.steps[1:])
    drawing = draw(dataclasses.replace(inspection, steps=steps), display, scan.points, PALETTE)
    assert len(drawing.nosings) == 4
    front = drawing.edges[(drawing.edge_colors == np.array(PALETTE.front_edge)).all(axis=1)]
    assert front.shape == (1, 2, 3)
    flat = np.abs((front[0] - steps[0].corners[:2]) @ np.array([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]]))
    assert flat.max() < 1e-9


def test_rejected_surfaces_have_a_colour_and_a_name_only_when_they_are_shown():
    scan, inspection, display = surveyed()
    plain = draw(inspection, display, scan.points, PALETTE)
    shown = draw(inspection, display, scan.points, PALETTE, with_rejected=True)
    is_rejected = np.isin(inspection.patch_ids[display.point_ids], [6, 7])
    assert is_rejected.sum() > 100
    assert (shown.colors[is_rejected] == np.array(PALETTE.rejected)).all()
    np.testing.assert_array_equal(shown.colors[~is_rejected], plain.colors[~is_rejected])
    assert not (plain.colors == np.array(PALETTE.rejected)).all(axis=1).any()
    assert plain.rejected == ()
    # The largest first.
    assert [name for name, _ in shown.rejected] == ["surface 7", "surface 6"]
    for name, place in shown.rejected:
        np.testing.assert_array_equal(place, inspection.patches[int(name.split(" ")[1])].plane.centroid)


def test_very_many_rejected_surfaces_are_all_coloured_and_the_largest_named():
    scan, inspection, display = surveyed()
    one = inspection.patches[-1]
    patches = tuple(dataclasses.replace(one, patch_id=k, area_m2=0.01 * k) for k in range(50))
    many = dataclasses.replace(inspection, patches=patches)
    drawing = draw(many, display, scan.points, PALETTE, with_rejected=True)
    assert [name for name, _ in drawing.rejected][:2] == ["surface 49", "surface 48"]
    assert len(drawing.rejected) == MOST_REJECTED
    assert (drawing.colors[inspection.patch_ids == 3] == np.array(PALETTE.rejected)).all()


def test_no_palette_has_the_colour_of_rejected_surfaces():
    for palette in (PALETTE, read_palette("page_dark")):
        others = np.array([*palette.steps, palette.floor, palette.non_stair, palette.front_edge, palette.measure])
        assert np.abs(others - np.array(PALETTE.rejected)).max(axis=1).min() > 40


def test_the_points_of_a_choice_are_those_of_the_step_or_of_the_surface():
    _, inspection, display = surveyed()
    np.testing.assert_array_equal(points_of(inspection, display, 2, None), display.points[inspection.labels == 2])
    np.testing.assert_array_equal(points_of(inspection, display, None, 7), display.points[inspection.patch_ids == 7])
    assert points_of(inspection, display, None, None).shape == (0, 3)
    paper = dataclasses.replace(inspection, patch_ids=None)
    assert points_of(paper, display, None, 7).shape == (0, 3)


@pytest.mark.parametrize("turn", [np.eye(3), rotation("z", 130.0), rotation("x", 75.0) @ rotation("y", -40.0)])
def test_the_view_follows_the_climb_of_the_first_flight(turn):
    _, inspection, _ = surveyed(turn)
    # Axes that would turn the view aside, as the paper's do on a long flight.
    axes = dataclasses.replace(inspection.axes, width=inspection.axes.depth, depth=-inspection.axes.width)
    for bare in (dataclasses.replace(inspection, axes=axes), dataclasses.replace(inspection, axes=None)):
        view = view_from_local(bare)
        np.testing.assert_allclose(view @ view.T, np.eye(3), atol=1e-9)
        assert np.linalg.det(view) == pytest.approx(1.0)
        np.testing.assert_allclose(view @ turn[:, 0], [0.0, 1.0, 0.0], atol=1e-6)
        np.testing.assert_allclose(view @ inspection.up.vector, [0.0, 0.0, 1.0], atol=1e-12)


@pytest.mark.parametrize(("sides", "is_hidden"), [("left", True), ("right", False), ("both", False), ("", False)])
def test_a_wall_on_the_left_alone_hides_the_stair(sides, is_hidden):
    points, normals = Stair(noise=0.001, risers=True).sample()
    width, height = points[:, 1].min(), points[:, 1].max()
    grid = np.stack(np.meshgrid(np.arange(0.0, 1.5, 0.02), np.arange(0.0, 2.5, 0.02)), axis=-1).reshape(-1, 2)
    # Who climbs along +x has +y on the left.
    walls = [
        np.column_stack([grid[:, 0], np.full(len(grid), y), grid[:, 1]])
        for side, y in (("left", height + 0.01), ("right", width - 0.01))
        if sides in (side, "both")
    ]
    upright = np.tile([0.0, 1.0, 0.0], (sum(len(wall) for wall in walls), 1))
    scan = make_scan(np.concatenate([points, *walls]), normals=np.concatenate([normals, upright]))
    assert is_left_hidden(inspect(scan, exact_params()), choose_display(scan)) == is_hidden
