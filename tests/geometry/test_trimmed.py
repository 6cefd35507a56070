"""The plane of a surface on which other things stand."""

import numpy as np
import pytest

from stair_inspector.geometry.trimmed import densest, fit_trimmed, height_above

SLOPE = np.array([0.03, -0.02])


def tread(n, rng, noise_m=0.0):
    """Points (3, n) of a surface 1.2 m high in the middle, far from the origin of the plan."""
    places = rng.uniform([[-0.15], [-0.5]], [[0.15], [0.5]], (2, n))
    height = 1.2 + SLOPE @ places + noise_m * rng.standard_normal(n)
    return np.vstack([places + np.array([[40.0], [70.0]]), height])


def at(fitted, x, y):
    """Height of a fitted plane at a place of the plan."""
    slope, centre, _ = fitted
    return centre[2] + slope @ (np.array([x, y]) - centre[:2])


@pytest.mark.parametrize("above_m", [-0.17, -0.03, 0.05, 0.9])
def test_a_third_of_the_points_on_a_thing_that_stands_on_a_tread_do_not_tilt_it(above_m):
    """It stands out by more than the 20 mm that the tread itself rises over its width."""
    rng = np.random.default_rng(4)
    points = tread(900, rng)
    is_thing = points[1] > 70.5 - 0.35
    assert 0.3 < is_thing.mean() < 0.4
    points[2, is_thing] += above_m
    fitted = fit_trimmed(points)
    assert fitted[0] == pytest.approx(SLOPE, abs=1e-9)
    assert at(fitted, 40.0, 70.0) == pytest.approx(1.2, abs=1e-9)


def test_of_noise_alone_hardly_a_point_is_left_out_and_its_size_is_told():
    points = tread(20_000, np.random.default_rng(5), noise_m=0.003)
    fitted = fit_trimmed(points)
    assert fitted[2] == pytest.approx(0.003, rel=0.03)
    plain = np.linalg.lstsq(np.vstack([points[:2] - fitted[1][:2, None], np.ones(20_000)]).T, points[2], rcond=None)[0]
    # 3 sigma leave out 3 in 1000, which moves a plane by a fraction of its own uncertainty: 0.003 / sqrt(20 000).
    assert at(fitted, 40.0, 70.0) == pytest.approx(1.2, abs=3.0 * 0.003 / np.sqrt(20_000))
    assert fitted[0] == pytest.approx(plain[:2], abs=0.5 * 0.003 / 0.0866 / np.sqrt(20_000))


def test_points_on_one_line_of_the_plan_have_a_height_and_no_slope():
    w = np.linspace(-0.5, 0.5, 30)
    slope, centre, sigma_m = fit_trimmed(np.vstack([0.0 * w, w, np.full(30, 0.34)]))
    assert slope == pytest.approx([0.0, 0.0])
    assert centre == pytest.approx([0.0, 0.0, 0.34])
    assert sigma_m == pytest.approx(0.0, abs=1e-12)


def test_three_points_have_their_plane():
    corners = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.1, 0.8]])
    fitted = fit_trimmed(corners)
    assert fitted[0] == pytest.approx([0.1, -0.2])
    assert at(fitted, 0.0, 0.0) == pytest.approx(1.0)


def test_heights_are_counted_from_the_plane():
    points = np.array([[1.0, 3.0], [2.0, 2.0], [5.0, 5.0]])
    # The plane is 4 at (1, 1), and 4 + 0.2 and 4 + 2 * 0.1 + 0.2 at the places of the points.
    found = height_above(points, np.array([0.1, 0.2]), np.array([1.0, 1.0, 4.0]))
    assert found == pytest.approx([0.8, 0.6])


def test_the_densest_stretch_is_the_shortest_with_so_many_values():
    values = np.array([9.0, 0.0, 5.2, 5.0, 1.0, 5.3, 7.0])
    # In order 0, 1, 5, 5.2, 5.3, 7, 9.
    assert densest(values, 3) == 5.2
    assert densest(values, 2) == pytest.approx(5.25)
    assert densest(values, 4) == pytest.approx((5.2 + 5.3) / 2.0)
    assert densest(values, 7) == densest(values, 9) == 5.2
