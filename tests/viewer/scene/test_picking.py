"""A click means the point that is seen there: checked by projecting known points and clicking on their pixels."""

import math

import numpy as np
import pytest

from stair_inspector.pictures.cameras import FOV_RAD, ORTHO_FOV_RAD, frame_view
from stair_inspector.pictures.frames import section_frame
from stair_inspector.pictures.segmentation import extent_of, view_from_local
from stair_inspector.viewer.scene.picking import cone_of, owner_text, pick_of, point_at_click, ray_of
from stair_inspector.viewer.scene.sections import cut, is_in
from tests.synthetic import rotation
from tests.viewer.surveyed import GOING, RISE, surveyed

TURN = rotation("x", 75.0) @ rotation("y", -40.0)
HEIGHT, ASPECT = 700, 1.4


@pytest.fixture(scope="module")
def measured():
    return surveyed(TURN)


def camera(measured, view="Home", fov_rad=FOV_RAD):
    _, inspection, display = measured
    rotation_ = view_from_local(inspection)
    return frame_view(view, extent_of(display.points @ rotation_.T), ASPECT, np.eye(3), fov_rad), rotation_


def click(measured, target, pose, turn, fov_rad=FOV_RAD, points=None):
    """The row that a click on the pixel of a local point means."""
    place = turn @ target
    ray = ray_of(tuple(pose.position), tuple(3.0 * (place - pose.position)), turn)
    return point_at_click(measured[2].points if points is None else points, ray, cone_of(fov_rad, HEIGHT))


def angle_of(target, point, pose, turn):
    a, b = turn @ target - pose.position, turn @ point - pose.position
    return math.acos(min(1.0, float(a @ b / np.linalg.norm(a) / np.linalg.norm(b))))


@pytest.mark.parametrize("fov_rad", [FOV_RAD, ORTHO_FOV_RAD])
def test_a_click_on_a_point_that_is_in_front_means_that_very_point(measured, fov_rad):
    _, inspection, display = measured
    pose, turn = camera(measured, "Top", fov_rad)
    # From above nothing hides the middle of a tread; at its back the riser stands in front.
    along = display.points @ TURN[:, 0] / GOING
    is_middle = np.abs(along - np.floor(along) - 0.5) < 0.3
    rows = np.nonzero((inspection.labels[display.point_ids] > 0) & is_middle)[0][::37]
    assert len(rows) > 25
    assert [click(measured, display.points[row], pose, turn, fov_rad) for row in rows] == list(rows)


def test_nothing_is_picked_through_a_surface(measured):
    _, _, display = measured
    pose, turn = camera(measured, "Front")
    # Looking along the climb at a riser, what lies behind it on the tread above is farther away.
    height = display.points @ TURN[:, 2]
    target = display.points[np.argmin(np.abs(height - 2.5 * RISE))]
    row = click(measured, target, pose, turn)
    assert row is not None
    cone = cone_of(FOV_RAD, HEIGHT, 3.0)
    depth = (display.points - turn.T @ pose.position) @ (turn.T @ (pose.look_at - pose.position))
    seen = np.array([angle_of(target, point, pose, turn) for point in display.points]) < math.atan(cone)
    assert depth[row] <= depth[seen].min() * (1.0 + 4.0 * cone)


def test_a_click_a_few_pixels_beside_a_lonely_point_means_it_and_farther_away_nothing():
    pose = frame_view("Front", np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 1.0]]), ASPECT, np.eye(3))
    points = np.array([[0.5, 0.0, 0.5], [0.2, 0.0, 0.5]])
    distance = np.linalg.norm(pose.position - points[0])
    pixel = distance * 2.0 * math.tan(FOV_RAD / 2.0) / HEIGHT
    for away, expected in ((0.0, 0), (6.0, 0), (9.0, None)):
        towards = points[0] + [0.0, 0.0, away * pixel] - pose.position
        ray = ray_of(tuple(pose.position), tuple(towards), np.eye(3))
        assert point_at_click(points, ray, cone_of(FOV_RAD, HEIGHT)) == expected


def test_a_click_beside_the_scan_picks_nothing(measured):
    pose, turn = camera(measured)
    assert click(measured, turn.T @ np.array([60.0, 0.0, 0.0]), pose, turn) is None
    # Nor what lies behind the camera.
    behind = ray_of(tuple(pose.position), tuple(pose.position - pose.look_at), turn)
    assert point_at_click(measured[2].points, behind, cone_of(FOV_RAD, HEIGHT)) is None


def test_what_a_section_hides_cannot_be_picked(measured):
    _, inspection, display = measured
    pose, turn = camera(measured, "Side")
    slab = cut(section_frame(inspection, display.points), "along", -0.3, 0.05, display.points)
    inside = is_in(display.points, slab)
    target = display.points[np.nonzero(inside & (inspection.labels[display.point_ids] == 3))[0][0]]
    # Seen from the right, the side of the stair is in front of the section.
    assert not inside[click(measured, target, pose, turn)]
    # In a section only its own points are drawn.
    drawn = display.points[inside]
    np.testing.assert_allclose(drawn[click(measured, target, pose, turn, points=drawn)], target, atol=0.02)
    assert click(measured, target, pose, turn, points=drawn[:0]) is None


def test_the_cone_is_as_wide_as_its_pixels():
    # The picture's height spans the angle of view.
    assert cone_of(FOV_RAD, 100, 50.0) == pytest.approx(math.tan(FOV_RAD / 2.0))
    assert cone_of(FOV_RAD, 0) > 0.0


def test_a_pick_gives_the_scans_own_coordinates_its_step_and_its_residual(measured):
    scan, inspection, display = measured
    labels = inspection.labels[display.point_ids]
    for label, words in ((3, "step 3"), (0, "floor"), (-1, "no step")):
        row = int(np.nonzero(labels == label)[0][5])
        pick = pick_of(inspection, display, row)
        assert pick.place_m == pytest.approx(tuple(scan.points[display.point_ids[row]] + scan.origin_m), abs=1e-12)
        assert owner_text(pick) == words
        if label < 0:
            assert (pick.step_id, pick.residual_m) == (None, None)
        if label == 3:
            plane = inspection.steps[2].plane
            assert pick.residual_m == pytest.approx(float((display.points[row] - plane.centroid) @ plane.normal))
