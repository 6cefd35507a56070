"""Every view shows the whole staircase, fills the picture, and looks from where its name says."""

import dataclasses
import math

import numpy as np
import pytest

from stair_inspector.viewer import cameras
from stair_inspector.viewer.cameras import FOV_RAD, VIEWS, frame_view
from tests.synthetic import rotation

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
