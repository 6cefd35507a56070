"""Planes and axes: against numpy's decomposition of the full matrix, by hand, and where nothing is determined."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stair_inspector.errors import DegenerateGeometry
from stair_inspector.geometry.fits import find_plane_ransac, fit_plane, principal_axis, spread_rank
from tests.synthetic import rotation

UP = np.array([0.0, 0.0, 1.0])


def tilted_patch(seed, n=500, noise=0.002):
    rng = np.random.default_rng(seed)
    points = np.column_stack([rng.uniform(0, 0.3, n), rng.uniform(0, 1.2, n), rng.normal(0, noise, n)])
    turn = rotation("x", rng.uniform(-80, 80)) @ rotation("y", rng.uniform(-80, 80))
    return points @ turn.T + rng.uniform(-50, 50, 3)


@given(st.integers(0, 10_000), st.integers(3, 400), st.sampled_from([0.0, 1e-4, 0.002, 0.05]))
def test_a_plane_is_that_of_the_svd_of_the_full_centred_matrix(seed, n, noise):
    points = tilted_patch(seed, n, noise)
    fit = fit_plane(points, UP)
    centred = points - points.mean(axis=0)
    _, singular, axes = np.linalg.svd(centred, full_matrices=False)
    if fit.normal is None:
        assert singular[1] <= singular[0] * 2e-6
        return
    # The scatter matrix holds squares: rounding turns its axes by about eps * s0**2 / (s1**2 - s2**2).
    gap = singular[1] ** 2 - singular[2] ** 2
    tolerance = 100.0 * np.finfo(float).eps * singular[0] ** 2 / max(gap, 1e-12 * singular[0] ** 2)
    angle = np.linalg.norm(np.cross(fit.normal, axes[2]))
    assert angle <= tolerance
    np.testing.assert_allclose(fit.centroid, points.mean(axis=0), rtol=0, atol=1e-12)
    # A normal turned by the tolerance moves residuals by that much times the extent.
    assert fit.rms_m == pytest.approx(singular[2] / np.sqrt(n), rel=1e-9, abs=1e-13 + tolerance * singular[0])


def test_eq8_saddle_by_hand():
    # Four corners, alternately 3 mm above and below: the plane is z = 5, every residual 3 mm.
    points = np.array([[1, 1, 5.003], [-1, 1, 4.997], [-1, -1, 5.003], [1, -1, 4.997]])
    fit = fit_plane(points, UP)
    np.testing.assert_allclose(fit.centroid, [0, 0, 5], atol=1e-15)
    np.testing.assert_allclose(fit.normal, [0, 0, 1], atol=1e-12)
    assert fit.rms_m == pytest.approx(0.003, rel=1e-12)
    assert fit.n_points == 4


def test_eq8_slope_by_hand():
    # z = 3/4 x: the normal is (-3, 0, 4) / 5.
    points = np.array([[0, 0, 0], [4, 0, 3], [0, 1, 0], [4, 1, 3]], dtype=float)
    fit = fit_plane(points, UP)
    np.testing.assert_allclose(fit.normal, [-0.6, 0.0, 0.8], atol=1e-15)
    assert fit.rms_m == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_normal_is_on_the_side_of_up(sign):
    assert fit_plane(tilted_patch(1), sign * UP).normal @ (sign * UP) > 0


@pytest.mark.parametrize(
    "points",
    [
        np.array([[1.0, 2.0, 3.0]]),
        np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]),
        np.full((60, 3), 0.1),
        np.outer(np.linspace(0, 1, 60), [0.3, 0.4, 0.1]) + 7.0,
    ],
    ids=["one", "two", "all_equal", "collinear"],
)
def test_no_plane_where_none_is_determined(points):
    fit = fit_plane(points, UP)
    assert fit.normal is None
    assert fit.rms_m is None
    assert fit.n_points == len(points)
    np.testing.assert_allclose(fit.centroid, points.mean(axis=0), atol=1e-12)


def test_three_points_have_a_plane_without_residuals():
    fit = fit_plane(np.array([[0, 0, 1], [1, 0, 1], [0, 1, 1]], dtype=float), UP)
    np.testing.assert_allclose(fit.normal, UP, atol=1e-12)
    assert fit.rms_m == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize(
    ("points", "rank"),
    [
        (np.full((5, 3), 0.5), 0),
        (np.full((57, 3), 0.1), 0),
        (np.outer(np.arange(5.0), [1, 2, 3]), 1),
        (np.outer(np.arange(50.0), [0.1, 0.2, 0.3]) + 1000.0, 1),
        (np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], dtype=float), 2),
        (np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float), 3),
    ],
)
def test_spread_rank(points, rank):
    assert spread_rank(points) == rank


def test_principal_axis_by_hand():
    # Variances 4 and 1 along (3, 4) / 5 and its normal.
    wide, narrow = np.array([0.6, 0.8]), np.array([-0.8, 0.6])
    axis, ratio = principal_axis(4.0 * np.outer(wide, wide) + np.outer(narrow, narrow))
    assert abs(axis @ wide) == pytest.approx(1.0, abs=1e-15)
    assert ratio == pytest.approx(0.25, rel=1e-12)


def test_principal_axis_of_nothing_says_that_it_means_nothing():
    assert principal_axis(np.zeros((2, 2)))[1] == 1.0


def test_ransac_finds_the_largest_plane_among_outliers_and_fits_all_its_points():
    rng = np.random.default_rng(3)
    floor = np.column_stack([rng.uniform(0, 3, 6000), rng.uniform(0, 2, 6000), rng.normal(0.0, 0.001, 6000)])
    clutter = rng.uniform([0, 0, 0.1], [3, 2, 2], (4000, 3))
    fit = find_plane_ransac(np.concatenate([clutter, floor]), 0.01)
    assert fit.n_points == 6000
    # Slope of a least-squares plane: noise over spread over the root of n; five of it.
    slope = 0.001 / (2 / np.sqrt(12)) / np.sqrt(6000)
    assert np.hypot(*fit.normal[:2]) < 5 * slope
    assert fit.rms_m == pytest.approx(0.001, rel=5 / np.sqrt(2 * 6000))


@pytest.mark.parametrize("height", [-3.0, 7.0])
def test_ransac_takes_what_lies_near_the_plane_on_both_sides_however_far_it_is_from_the_origin(height):
    rng = np.random.default_rng(2)
    level = np.column_stack([rng.uniform(-1.0, 1.0, (400, 2)), np.full(400, height)])
    # Two sheets 2 mm apart about the plane, and a hundred points 0.5 m to 1 m over it.
    level[:200, 2] += 0.001
    level[200:, 2] -= 0.001
    above = np.column_stack([rng.uniform(-1.0, 1.0, (100, 2)), height + rng.uniform(0.5, 1.0, 100)])
    plane = find_plane_ransac(np.vstack([level, above]), 0.01)
    assert plane.n_points == 400
    assert plane.normal[2] == pytest.approx(1.0, abs=1e-4)
    assert plane.centroid[2] == pytest.approx(height, abs=1e-12)


def test_ransac_repeats_itself():
    rng = np.random.default_rng(4)
    points = rng.uniform(0, 1, (3000, 3)) * [1, 1, 0.05]
    first, second = find_plane_ransac(points, 0.005), find_plane_ransac(points, 0.005)
    np.testing.assert_array_equal(first.normal, second.normal)
    np.testing.assert_array_equal(first.centroid, second.centroid)


@pytest.mark.parametrize(
    "points", [np.zeros((2, 3)), np.outer(np.arange(100.0), [1, 0, 0]), np.full((80, 3), 0.1)], ids=str
)
def test_ransac_says_that_there_is_no_plane(points):
    with pytest.raises(DegenerateGeometry, match="three points that are not on one line"):
        find_plane_ransac(points, 0.01)
