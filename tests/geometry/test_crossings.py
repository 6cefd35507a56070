"""What lies inside a closed surface, against spheres and boxes, and against Open3D's rays."""

import numpy as np
import pytest
import trimesh

from stair_inspector.geometry.crossings import ClosedSurface
from stair_inspector.geometry.solids import CastRays, CountedCrossings
from tests.oracles import open3d_or_skip


def corners_of(mesh):
    return np.asarray(mesh.vertices, dtype=np.float64)[np.asarray(mesh.faces)]


def test_a_box_holds_what_lies_between_its_faces():
    corners = corners_of(trimesh.creation.box(bounds=[[0, 0, 0], [1.0, 0.5, 0.25]]))
    points = np.random.default_rng(1).uniform(-0.3, 1.3, (20_000, 3))
    is_inside, is_near = ClosedSurface(corners, 1e-5).look(points)
    expected = ((points > 0.0) & (points < [1.0, 0.5, 0.25])).all(axis=1)
    assert 300 < expected.sum() < 2000
    np.testing.assert_array_equal(is_inside, expected)
    assert not is_near.any()


def test_a_round_body_of_many_faces_and_a_ring_with_a_hole():
    points = np.random.default_rng(2).uniform(-1.1, 1.1, (20_000, 3))
    distance = np.linalg.norm(points, axis=1)
    is_inside, _ = ClosedSurface(corners_of(trimesh.creation.icosphere(subdivisions=4)), 1e-5).look(points)
    # The faces of the body lie a little inside the sphere.
    is_told = np.abs(distance - 1.0) > 0.01
    np.testing.assert_array_equal(is_inside[is_told], distance[is_told] < 1.0)
    ring = corners_of(trimesh.creation.annulus(r_min=0.5, r_max=1.0, height=1.0, sections=256))
    is_inside, _ = ClosedSurface(ring, 1e-5).look(points)
    radius = np.linalg.norm(points[:, :2], axis=1)
    is_told = (np.abs(radius - 0.5) > 0.01) & (np.abs(radius - 1.0) > 0.01)
    expected = (radius > 0.5) & (radius < 1.0) & (np.abs(points[:, 2]) < 0.5)
    np.testing.assert_array_equal(is_inside[is_told], expected[is_told])


@pytest.mark.parametrize(("off", "near"), [(0.0, True), (0.9e-5, True), (-0.9e-5, True), (3e-5, False), (-3e-5, False)])
def test_what_lies_on_a_face_is_near(off, near):
    corners = corners_of(trimesh.creation.box(bounds=[[0, 0, 0], [1.0, 0.5, 0.25]]))
    rng = np.random.default_rng(3)
    on_top = np.column_stack([rng.uniform(0.01, 0.99, 500), rng.uniform(0.01, 0.49, 500), np.full(500, 0.25 + off)])
    on_side = np.column_stack([np.full(500, 1.0 + off), rng.uniform(0.01, 0.49, 500), rng.uniform(0.01, 0.24, 500)])
    _, is_near = ClosedSurface(corners, 1e-5).look(np.concatenate([on_top, on_side]))
    assert is_near.all() == near
    assert is_near.any() == near


def test_both_ways_to_tell_an_inside_agree():
    open3d = open3d_or_skip()
    steps = [trimesh.creation.box(bounds=[[0.1 * k, 0, 0], [0.1 * k + 0.2, 1, 0.1 * k + 0.1]]) for k in range(5)]
    for mesh in (*steps, trimesh.creation.icosphere(subdivisions=2)):
        corners = corners_of(mesh)
        low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
        corners = (corners - low) / (high - low).max()
        points = np.random.default_rng(4).uniform(-0.1, 1.1, (3000, 3))
        on_faces = np.asarray(trimesh.sample.sample_surface(mesh, 500, seed=5)[0])
        points = np.concatenate([points, (on_faces - low) / (high - low).max()])
        cast, counted = CastRays(open3d, corners), CountedCrossings(corners)
        np.testing.assert_array_equal(counted.holds(points), cast.holds(points))
        np.testing.assert_array_equal(counted.surrounds(points[:3000]), cast.surrounds(points[:3000]))


def test_no_points_and_points_far_away():
    surface = ClosedSurface(corners_of(trimesh.creation.box()), 1e-5)
    assert [len(found) for found in surface.look(np.zeros((0, 3)))] == [0, 0]
    assert not np.any(surface.look(np.full((3, 3), 50.0)))
