"""Directions, frames and cells of a plan."""

import math

import numpy as np
import pytest

from stair_inspector.geometry.plan import angle_deg, cell_keys, in_frame, left_of, place_in_frame, turn_deg, unit_way


def direction(deg):
    return np.array([math.cos(math.radians(deg)), math.sin(math.radians(deg))])


@pytest.mark.parametrize("deg", [0.0, 30.0, 135.0, -80.0])
def test_left_is_a_quarter_turn_and_turns_to_the_left_are_positive(deg):
    ahead = direction(deg)
    np.testing.assert_allclose(left_of(ahead), direction(deg + 90.0), atol=1e-15)
    assert turn_deg(ahead, direction(deg + 20.0)) == pytest.approx(20.0)
    assert turn_deg(ahead, direction(deg - 170.0)) == pytest.approx(-170.0)
    assert angle_deg(ahead, direction(deg - 170.0)) == pytest.approx(170.0)


def test_a_way_of_any_length_is_made_one_of_length_one():
    np.testing.assert_allclose(unit_way(-7.3 * direction(50.0)), direction(230.0), atol=1e-15)
    np.testing.assert_allclose(unit_way(1e-3 * direction(50.0)), direction(50.0), atol=1e-15)


def test_one_place_and_many_have_the_same_coordinates_in_a_frame():
    rng = np.random.default_rng(1)
    origin, climb, plan = rng.normal(size=2), direction(40.0), rng.normal(size=(2, 20))
    s, w = in_frame(plan, origin, climb)
    for k, place in enumerate(plan.T):
        np.testing.assert_allclose(place_in_frame(place, origin, climb), (s[k], w[k]), atol=1e-14)
    np.testing.assert_allclose(origin[:, None] + np.outer(climb, s) + np.outer(left_of(climb), w), plan, atol=1e-14)


def test_places_have_one_key_exactly_where_they_lie_in_one_cell():
    rng = np.random.default_rng(2)
    places = rng.uniform(-3.0, 3.0, (2, 500))
    cells = np.floor(places / 0.25)
    is_same = (cells[:, :, None] == cells[:, None, :]).all(axis=0)
    keys = cell_keys(places, 0.25)
    assert np.array_equal(keys[:, None] == keys, is_same)
    assert is_same.sum() > 500
    # Nor do cells of a wide plan share one.
    far = np.stack(np.meshgrid(np.arange(-3.0, 3.0), np.arange(-5000.0, 5000.0)), axis=0).reshape(2, -1) + 0.5
    assert len(np.unique(cell_keys(far, 1.0))) == len(np.unique(cell_keys(far[::-1], 1.0))) == far.shape[1]
