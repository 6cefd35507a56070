"""The sorted search gives the very normals of the plain one."""

import numpy as np
import pytest

from stair_inspector.geometry.normals import estimate_normals, estimate_normals_at, morton_order
from tests.oracles import open3d_or_skip
from tests.synthetic import Stair


def interleave_slowly(x, y, z):
    """Z-order code of a cell, bit by bit: x in the lowest bit of each group of three."""
    code = 0
    for bit in range(21):
        code |= (x >> bit & 1) << 3 * bit | (y >> bit & 1) << 3 * bit + 1 | (z >> bit & 1) << 3 * bit + 2
    return code


@pytest.mark.parametrize("extent", [0.05, 3.0, 41_000.0], ids=["few_cells", "stair", "close_to_2**21_cells"])
def test_morton_order_against_a_bit_by_bit_implementation(extent):
    points = np.random.default_rng(5).uniform(0.0, extent, (2000, 3)) - extent / 3.0
    points[0], points[1] = points.min(axis=0), points.max(axis=0)
    low = points.min(axis=0)
    cells = [[int(value) for value in row] for row in (points - low) / 0.02]
    assert max(map(max, cells)) < 2**21
    codes = [interleave_slowly(*cell) for cell in cells]
    expected = sorted(range(len(points)), key=lambda i: (codes[i], i))
    np.testing.assert_array_equal(morton_order(points), expected)


def test_morton_order_enlarges_its_cells_where_they_would_not_fit():
    points = np.random.default_rng(6).uniform(0.0, 1e6, (500, 3))
    cell = (points.max(axis=0) - points.min(axis=0)).max() / (2**21 - 1)
    cells = ((points - points.min(axis=0)) / cell).astype(int)
    codes = [interleave_slowly(*map(int, row)) for row in cells]
    assert [codes[i] for i in morton_order(points)] == sorted(codes)


def test_morton_order_of_equal_points_keeps_their_order():
    np.testing.assert_array_equal(morton_order(np.full((50, 3), 2.5)), np.arange(50))


@pytest.mark.parametrize("k", [5, 30])
def test_normals_are_identical_to_the_plain_open3d_call(k):
    points, _ = Stair(risers=True, noise=0.002, spacing=0.015).sample()
    points = points[np.random.default_rng(7).permutation(len(points))]
    o3d = open3d_or_skip()
    cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points))
    cloud.estimate_normals(o3d.geometry.KDTreeSearchParamKNN(k))
    np.testing.assert_array_equal(estimate_normals(points, k), np.asarray(cloud.normals))


def test_normals_have_unit_length_even_on_a_line_and_the_input_may_be_read_only():
    rng = np.random.default_rng(8)
    points = np.concatenate([np.outer(np.linspace(0, 1, 60), [1.0, 0.0, 0.0]), rng.uniform(5, 6, (60, 3))])
    points.flags.writeable = False
    np.testing.assert_allclose(np.linalg.norm(estimate_normals(points, 10), axis=1), 1.0, rtol=1e-12)


def test_fewer_points_than_neighbours_share_one_normal():
    points = np.column_stack([np.random.default_rng(9).uniform(0, 1, (20, 2)), np.zeros(20)])
    np.testing.assert_allclose(np.abs(estimate_normals(points, 30)), np.tile([0, 0, 1], (20, 1)), atol=1e-12)


def test_normals_at_some_places_are_those_of_the_surfaces_there():
    # A floor and a wall a metre apart, far from the origin.
    rng = np.random.default_rng(10)
    plane = rng.uniform(0.0, 1.0, (500, 3))
    floor, wall = plane * [1.0, 1.0, 0.0], plane * [0.0, 1.0, 1.0] + [2.0, 0.0, 1.0]
    points = np.concatenate([floor, wall]) + np.array([500.0, -800.0, 30.0])
    places = np.array([700, 3, 999, 0])
    expected = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    np.testing.assert_allclose(np.abs(estimate_normals_at(points, places, 12)), expected, atol=1e-9)
    # Fewer points than neighbours: all of them.
    few = points[:8]
    np.testing.assert_allclose(np.abs(estimate_normals_at(few, np.array([2, 7]), 12)), expected[1::2], atol=1e-9)


def test_normals_at_some_places_are_those_of_the_nearest_points():
    points, _ = Stair(risers=True, noise=0.002, spacing=0.03).sample()
    places = np.arange(0, len(points), 40)
    cosines = (estimate_normals(points, 12)[places] * estimate_normals_at(points, places, 12)).sum(axis=1)
    np.testing.assert_allclose(np.abs(cosines), 1.0, atol=1e-9)
