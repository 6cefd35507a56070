"""Every view shows the whole staircase, fills the picture, and looks from where its name says."""

import dataclasses
import math

import numpy as np
import pytest

from stair_inspector.pictures import cameras
from stair_inspector.pictures.cameras import (
    FOV_RAD,
    ORTHO_FOV_RAD,
    VIEWS,
    clip_range,
    frame_view,
    from_saved,
    step_frame,
    to_saved,
    with_fov,
)
from stair_inspector.pictures.segmentation import view_from_local
from tests.synthetic import rotation
from tests.viewer.surveyed import surveyed

BOX = np.array([[x, y, z] for x in (-0.6, 0.6) for y in (-1.5, 3.0) for z in (0.0, 1.8)])


def project(pose, points, aspect):
    """Places of points in the picture, both from -1 to 1 at its borders, and their distances in front of the camera."""
    forward = (pose.look_at - pose.position) / np.linalg.norm(pose.look_at - pose.position)
    right = np.cross(forward, pose.up)
    right /= np.linalg.norm(right)
    offset = points - pose.position
    depth = offset @ forward
    tan = math.tan(FOV_RAD / 2.0)
    return np.column_stack(
        [offset @ right / depth / (tan * aspect), offset @ np.cross(right, forward) / depth / tan]
    ), depth


@pytest.mark.parametrize("view", VIEWS)
@pytest.mark.parametrize("aspect", [0.4, 1.0, 1.16, 16 / 9, 3.5])
@pytest.mark.parametrize("turn_deg", [0.0, 12.0, 180.0])
def test_the_box_is_inside_the_picture_and_fills_it(view, aspect, turn_deg):
    box = BOX + np.array([5.0, -3.0, 2.0])
    pose = frame_view(view, box, aspect, rotation("z", turn_deg))
    places, depth = project(pose, box, aspect)
    assert depth.min() > 0.0
    assert np.abs(places).max() < 1.0
    # Without the margin a corner lies on the border: no nearer camera would see the whole box.
    nearer = dataclasses.replace(pose, position=pose.look_at + (pose.position - pose.look_at) / cameras._MARGIN)
    assert np.abs(project(nearer, box, aspect)[0]).max() == pytest.approx(1.0)


def test_home_looks_down_from_the_lower_left_so_that_treads_and_risers_show():
    pose = frame_view("Home", BOX, 1.2, np.eye(3))
    x, y, z = pose.position - pose.look_at
    assert x < 0.0
    assert y < 0.0
    assert z > 0.0
    # Seen at 15 degrees or more, a surface shows at least a quarter of its extent.
    elevation = math.degrees(math.atan2(z, math.hypot(x, y)))
    assert 15.0 < elevation < 60.0


@pytest.mark.parametrize(
    ("view", "axis", "sign"), [("Front", 1, -1.0), ("Side", 0, 1.0), ("Top", 2, 1.0)], ids=["Front", "Side", "Top"]
)
def test_the_other_views_look_along_an_axis(view, axis, sign):
    pose = frame_view(view, BOX, 1.2, np.eye(3))
    expected = np.zeros(3)
    expected[axis] = sign
    np.testing.assert_allclose(
        (pose.position - pose.look_at) / np.linalg.norm(pose.position - pose.look_at), expected, atol=1e-12
    )


def test_the_climb_points_up_in_the_view_from_above():
    places, _ = project(frame_view("Top", BOX, 1.2, np.eye(3)), np.array([[0.0, 0.0, 1.0], [0.0, 2.0, 1.0]]), 1.2)
    assert places[1, 1] > places[0, 1]


@pytest.mark.parametrize("view", VIEWS)
def test_a_turned_staircase_is_seen_from_the_same_side_of_its_own(view):
    turn = rotation("z", 37.0)
    straight = frame_view(view, BOX, 1.2, np.eye(3))
    turned = frame_view(view, BOX, 1.2, turn)
    towards = (straight.position - straight.look_at) / np.linalg.norm(straight.position - straight.look_at)
    seen = (turned.position - turned.look_at) / np.linalg.norm(turned.position - turned.look_at)
    np.testing.assert_allclose(seen, turn @ towards, atol=1e-12)


def test_a_box_without_extent_or_a_picture_without_width_has_a_camera_all_the_same():
    for corners, aspect in ((np.zeros((8, 3)), 1.0), (BOX, 0.0)):
        pose = frame_view("Home", corners, aspect, np.eye(3))
        assert np.isfinite(np.concatenate([pose.position, pose.look_at, pose.up])).all()
        assert np.linalg.norm(pose.position - pose.look_at) >= 0.1


def test_from_the_right_is_the_mirror_image():
    left = frame_view("Home", BOX, 1.2, np.eye(3))
    right = frame_view("Home", BOX, 1.2, np.eye(3), is_from_right=True)
    middle = (BOX.min(axis=0) + BOX.max(axis=0)) / 2.0
    np.testing.assert_allclose(right.position - middle, (left.position - middle) * [-1.0, 1.0, 1.0], atol=1e-12)


def test_along_the_stair_every_nosing_is_seen_below_the_one_before_it():
    # From the head: the nosing of step k at y = 0.28 k, z = 0.17 k, and the edge of the tread that hides what is below.
    nosings = np.array([[0.0, 0.28 * k, 0.17 * k] for k in range(12)])
    pitch_deg = math.degrees(math.atan2(0.17, 0.28))
    pose = frame_view("Along", BOX, 1.3, np.eye(3), pitch_deg=pitch_deg)
    places, depth = project(pose, nosings, 1.3)
    assert (np.diff(depth) < 0.0).all()
    assert (np.diff(places[:, 1]) < 0.0).all()
    # It looks down a little more steeply than the stair goes.
    x, y, z = pose.position - pose.look_at
    assert x == pytest.approx(0.0, abs=1e-12)
    assert pitch_deg < math.degrees(math.atan2(z, y)) < pitch_deg + 20.0


@pytest.mark.parametrize("pitch_deg", [-30.0, 0.0, 90.0, 180.0])
def test_an_unusual_pitch_still_has_a_view_along_it(pitch_deg):
    pose = frame_view("Along", BOX, 1.3, np.eye(3), pitch_deg=pitch_deg)
    assert np.abs(project(pose, BOX, 1.3)[0]).max() < 1.0


def spread(pose, points, fov_rad):
    """Places of points in the picture, as shares of its half height."""
    forward = (pose.look_at - pose.position) / np.linalg.norm(pose.look_at - pose.position)
    right = np.cross(forward, pose.up)
    right /= np.linalg.norm(right)
    offset = points - pose.position
    depth = offset @ forward
    tan = math.tan(fov_rad / 2.0)
    return np.column_stack([offset @ right, offset @ np.cross(right, forward)]) / depth[:, None] / tan


def test_the_orthographic_look_keeps_what_is_seen_and_makes_depth_vanish():
    pose = frame_view("Side", BOX, 1.2, np.eye(3))
    ortho = with_fov(pose, FOV_RAD, ORTHO_FOV_RAD)
    # In the plane through the point looked at nothing moves.
    middle = pose.look_at + np.array([[0.0, 1.0, 0.3], [0.0, -0.4, 0.8]])
    np.testing.assert_allclose(spread(ortho, middle, ORTHO_FOV_RAD), spread(pose, middle, FOV_RAD), atol=1e-12)
    # The near and the far side of the stair fall together to a few hundredths of the picture's half height.
    near, far = BOX[BOX[:, 0] > 0.0], BOX[BOX[:, 0] < 0.0]
    apart = [np.abs(spread(p, near, f) - spread(p, far, f)).max() for p, f in ((pose, FOV_RAD), (ortho, ORTHO_FOV_RAD))]
    assert apart[0] > 0.1
    assert apart[1] < 0.035
    back = with_fov(ortho, ORTHO_FOV_RAD, FOV_RAD)
    np.testing.assert_allclose(back.position, pose.position, atol=1e-9)


@pytest.mark.parametrize("fov_rad", [FOV_RAD, ORTHO_FOV_RAD])
@pytest.mark.parametrize("view", VIEWS)
def test_everything_lies_between_the_near_and_the_far_plane_also_from_nearer(view, fov_rad):
    pose = frame_view(view, BOX, 1.2, np.eye(3), fov_rad)
    near, far = clip_range(pose, BOX)
    depth = project(pose, BOX, 1.2)[1]
    assert near < depth.min() / 4.0
    assert far > 4.0 * depth.max()
    # A depth buffer of 24 bits tells points a quarter of a millimetre apart at the point looked at, from 58 m away too.
    distance = np.linalg.norm(pose.position - pose.look_at)
    assert distance**2 / (near * 2**24) < 0.00025


@pytest.mark.parametrize("turn", [np.eye(3), rotation("x", 75.0) @ rotation("y", -40.0)])
@pytest.mark.parametrize("view", VIEWS)
def test_a_step_fills_the_picture_and_is_seen_from_its_own_front(view, turn):
    _, inspection, _ = surveyed(turn)
    rotation_ = view_from_local(inspection)
    up = inspection.up.vector
    # A winder: its climb is not that of the flight.
    climb = turn @ rotation("z", 30.0) @ np.array([1.0, 0.0, 0.0])
    step = dataclasses.replace(inspection.steps[2], climb=climb)
    corners, axes = step_frame(step, up, inspection.flights[0].climb, rotation_)
    pose = frame_view(view, corners, 1.2, axes)
    seen, depth = project(pose, step.corners @ rotation_.T, 1.2)
    assert depth.min() > 0.0
    assert np.abs(seen).max() < 1.0
    assert np.abs(seen).max() > 0.4
    if view == "Front":
        backwards = (pose.position - pose.look_at) / np.linalg.norm(pose.position - pose.look_at)
        np.testing.assert_allclose(backwards, -rotation_ @ climb, atol=1e-9)


def test_a_step_without_a_climb_of_its_own_takes_that_of_the_stair():
    _, inspection, _ = surveyed()
    step = dataclasses.replace(inspection.steps[2], climb=None, rise_m=None)
    _, axes = step_frame(step, inspection.up.vector, np.array([0.0, 1.0, 0.0]), np.eye(3))
    np.testing.assert_allclose(axes, np.eye(3), atol=1e-12)


@pytest.mark.parametrize("turn", [np.eye(3), rotation("x", 75.0) @ rotation("y", -40.0)])
def test_a_saved_view_lies_in_the_scans_frame_and_comes_back_the_same(turn):
    _, inspection, _ = surveyed(turn)
    rotation_, origin = view_from_local(inspection), np.array([455123.25, 5412345.5, 310.125])
    pose = frame_view("Home", BOX, 1.2, np.eye(3))
    saved = to_saved("from below", pose, ORTHO_FOV_RAD, rotation_, origin)
    # The point looked at, in the scan's own frame.
    np.testing.assert_allclose(np.array(saved.look_at_m), rotation_.T @ pose.look_at + origin, atol=1e-8)
    assert saved.fov_deg == pytest.approx(5.0)
    back, fov_rad = from_saved(saved, rotation_, origin)
    for name in ("position", "look_at", "up"):
        np.testing.assert_allclose(getattr(back, name), getattr(pose, name), atol=1e-8)
    assert fov_rad == pytest.approx(ORTHO_FOV_RAD)
