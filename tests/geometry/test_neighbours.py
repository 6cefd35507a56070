"""Normals and floors without Open3D are those of Open3D."""

import numpy as np
import pytest

from stair_inspector.geometry.neighbours import normals_of_neighbours, plane_of_most
from tests.oracles import open3d_or_skip
from tests.synthetic import Stair


def stair_points(noise):
    return Stair(risers=True, noise=noise, spacing=0.015).sample()[0]


@pytest.mark.parametrize("k", [5, 30])
def test_normals_of_neighbours_are_those_of_open3d(k):
    o3d = open3d_or_skip()
    points = stair_points(0.002)
    cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points))
    cloud.estimate_normals(o3d.geometry.KDTreeSearchParamKNN(k))
    agreement = np.abs((normals_of_neighbours(points, k) * np.asarray(cloud.normals)).sum(axis=1))
    assert agreement.min() > 1.0 - 1e-9


def test_normals_of_a_sphere_point_to_its_centre():
    points = np.random.default_rng(3).normal(size=(20_000, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    cosines = np.abs((normals_of_neighbours(points, 20) * points).sum(axis=1))
    assert np.degrees(np.arccos(cosines.min())) < 8.0
    assert np.degrees(np.arccos(np.median(cosines))) < 1.0


def test_fewer_points_than_neighbours_and_points_on_a_line():
    flat = np.column_stack([np.random.default_rng(9).uniform(0, 1, (20, 2)), np.full(20, 7.0)])
    np.testing.assert_allclose(np.abs(normals_of_neighbours(flat, 30)), np.tile([0, 0, 1], (20, 1)), atol=1e-9)
    line = np.outer(np.linspace(0.0, 1.0, 60), [1.0, 2.0, 0.0])
    normals = normals_of_neighbours(line, 10)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, rtol=1e-12)
    np.testing.assert_allclose(normals @ [1.0, 2.0, 0.0], 0.0, atol=1e-6)


@pytest.mark.parametrize(("noise", "n"), [(0.002, 15_000), (0.01, 3001), (0.02, 257)])
def test_the_plane_of_most_points_is_that_of_open3d(noise, n):
    o3d = open3d_or_skip()
    points = stair_points(noise)[:n]
    cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points))
    o3d.utility.random.seed(0)
    model = np.array(cloud.segment_plane(0.01, ransac_n=3, num_iterations=1000, probability=1.0)[0])
    normal, offset = plane_of_most(points, 0.01, 1000, 0)
    side = np.sign(normal @ model[:3])
    np.testing.assert_allclose(side * np.array([*normal, offset]), model / np.linalg.norm(model[:3]), atol=1e-9)


def test_the_plane_of_most_points_is_the_floor_and_repeats():
    rng = np.random.default_rng(4)
    floor = np.column_stack([rng.uniform(0, 3, (2000, 2)), rng.normal(5.0, 0.001, 2000)])
    points = rng.permutation(np.concatenate([floor, rng.uniform(0, 3, (1500, 3))]))
    normal, offset = plane_of_most(points, 0.01, 200, 0)
    assert abs(normal[2]) > np.cos(np.radians(0.05))
    assert abs(abs(offset) - 5.0) < 0.002
    again = plane_of_most(points, 0.01, 200, 0)
    assert again[1] == offset
    np.testing.assert_array_equal(again[0], normal)
