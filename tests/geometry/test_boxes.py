"""Boxes that stand upright and are turned about the vertical."""

import numpy as np
import pytest

from stair_inspector.geometry.boxes import bearing_of, box_around, box_axes, turned_box
from tests.synthetic import rotation

Z = np.array([0.0, 0.0, 1.0])
LOW, HIGH = np.array([-1.0, -2.0, 0.0]), np.array([3.0, 2.0, 1.0])
LEANING = rotation("x", 4.0) @ rotation("y", -3.0) @ Z


def test_without_a_bearing_a_box_lies_along_the_axes_whatever_is_up():
    points = np.random.default_rng(1).uniform(-4.0, 4.0, (500, 3))
    box = turned_box(LOW, HIGH, LEANING, None)
    np.testing.assert_array_equal(box.holds(points), ((points >= LOW) & (points <= HIGH)).all(axis=1))
    assert box.holds(np.array([LOW, HIGH])).all()


@pytest.mark.parametrize("up", [Z, -Z, np.array([0.0, 1.0, 0.0]), np.array([-1.0, 0.0, 0.0]), LEANING], ids=str)
@pytest.mark.parametrize("bearing_deg", [0.0, 30.0, -77.0])
def test_the_axes_are_right_handed_one_of_them_upright(up, bearing_deg):
    axes = box_axes(up, bearing_deg)
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(axes) == pytest.approx(1.0)
    np.testing.assert_allclose(
        axes[np.argmax(np.abs(up))], np.abs(up).max() / up[np.argmax(np.abs(up))] * up, atol=0.01
    )


def test_a_bearing_turns_a_box_about_its_middle_from_x_towards_y():
    box = turned_box(LOW, HIGH, Z, 90.0)
    # Four along x and as wide along y: of a turn by a right angle nothing is seen but which face is which.
    np.testing.assert_allclose(box.corners().mean(axis=0), (LOW + HIGH) / 2.0)
    turned = turned_box(LOW, np.array([3.0, -1.0, 1.0]), Z, 30.0)
    middle = np.array([1.0, -1.5, 0.5])
    ahead = rotation("z", 30.0) @ np.array([1.0, 0.0, 0.0])
    assert turned.holds(np.array([middle + 1.99 * ahead, middle - 1.99 * ahead])).all()
    assert not turned.holds(np.array([middle + 2.01 * ahead, middle + np.array([1.99, 0.0, 0.0])])).any()


@pytest.mark.parametrize("up", [Z, np.array([0.0, 1.0, 0.0]), LEANING], ids=str)
def test_the_box_around_points_holds_them_with_room_and_no_more(up):
    points = np.random.default_rng(2).uniform(-3.0, 3.0, (200, 3))
    low, high = box_around(points, np.array([0.5, 0.0, 0.2]), up, 25.0)
    box = turned_box(low, high, up, 25.0)
    along = box.coordinates(points)
    np.testing.assert_allclose(along.min(axis=0) - box.bounds[0], [0.5, 0.0, 0.2], atol=1e-9)
    np.testing.assert_allclose(box.bounds[1] - along.max(axis=0), [0.5, 0.0, 0.2], atol=1e-9)
    np.testing.assert_allclose(np.ptp(box.coordinates(box.corners()), axis=0), np.ptp(box.bounds, axis=0))


@pytest.mark.parametrize(("degrees", "bearing"), [(0.0, 0.0), (30.0, 30.0), (90.0, 0.0), (100.0, 10.0), (-44.0, -44.0)])
def test_a_direction_has_a_bearing_of_at_most_half_a_right_angle(degrees, bearing):
    direction = rotation("z", degrees) @ np.array([1.0, 0.0, 0.0])
    assert bearing_of(direction, Z) == pytest.approx(bearing, abs=1e-9)
    assert bearing_of(-direction, Z) == pytest.approx(bearing, abs=1e-9)
