import itertools

import numpy as np
import pytest
from sklearn.neighbors import NearestNeighbors

from stair_inspector.geometry import polygons
from stair_inspector.geometry.polygons import triangulate
from stair_inspector.geometry.triangles import (
    areas_of,
    facet_of,
    find_distinct,
    in_fixed_order,
    points_per_triangle,
    sample_triangles,
)
from tests.files.models import stair_of_solids
from tests.synthetic import rotation

PLATE = np.array([[[0, 0, 0], [2, 0, 0], [2, 1, 0]], [[0, 0, 0], [2, 1, 0], [0, 1, 0]]], dtype=np.float64)


def sampled(corners, spacing=0.02, most=10**6):
    ordered = np.take_along_axis(corners, in_fixed_order(corners)[:, :, None], axis=1)
    return sample_triangles(ordered, points_per_triangle(areas_of(ordered), spacing, most))


def test_every_place_of_a_face_has_as_many_points():
    points, _ = sampled(PLATE)
    assert len(points) == 5000
    counts = np.histogram2d(points[:, 0], points[:, 1], [20, 10], [[0, 2], [0, 1]])[0]
    # 25 a cell: points that lie anywhere scatter by 5; here only the 20 shares that its edge cuts fall on either side.
    assert counts.mean() == 25.0
    assert counts.std() < 1.3 * np.sqrt(20.0) / 2.0
    # No hole is wider than a few points.
    everywhere = np.stack(np.meshgrid(np.linspace(0, 2, 101), np.linspace(0, 1, 51), [0.0]), axis=-1).reshape(-1, 3)
    distance, _ = NearestNeighbors(n_neighbors=1, algorithm="kd_tree").fit(points).kneighbors(everywhere)
    assert distance.max() < 3.0 * 0.02


def test_a_finer_mesh_of_the_same_surface_is_sampled_as_evenly():
    corners = PLATE
    for _ in range(7):
        middle = 0.5 * (corners + np.roll(corners, -1, axis=1))
        parts = [np.stack([corners[:, k], middle[:, k], middle[:, k - 1]], axis=1) for k in range(3)]
        corners = np.stack([*parts, middle], axis=1).reshape(-1, 3, 3)
    assert len(corners) > 5 * 5000
    points, _ = sampled(corners)
    assert len(points) == 5000
    counts = np.histogram2d(points[:, 0], points[:, 1], [20, 10], [[0, 2], [0, 1]])[0]
    assert counts.std() < 0.75 * 5.0


def test_the_winding_and_the_first_corner_change_no_point():
    expected, on = sampled(PLATE)
    for order in itertools.permutations(range(3)):
        points, on_again = sampled(PLATE[:, order])
        assert np.array_equal(points, expected)
        assert np.array_equal(on_again, on)
    assert on.tolist() == sorted(on.tolist())


def test_the_largest_faces_are_thinned_first():
    ground = np.array([[[-1e3, -1e3, 0], [1e3, -1e3, 0], [0, 1e3, 0]]], dtype=np.float64)
    areas = areas_of(np.concatenate([PLATE, ground]))
    counts = points_per_triangle(areas, 0.02, 20_000)
    # Cut to 100,000, then all alike.
    assert counts.tolist() == pytest.approx([2500.0 * 20 / 105, 2500.0 * 20 / 105, 100_000.0 * 20 / 105])
    assert points_per_triangle(areas, 0.02, 300_000).tolist() == pytest.approx([2500.0, 2500.0, 295_000.0])
    assert points_per_triangle(areas[:2], 0.02, 5000).tolist() == pytest.approx([2500.0, 2500.0])


def test_what_is_too_much_is_taken_from_the_largest_alone_where_that_is_enough():
    wanted = np.array([900_000.0, 1.0, 300_000.0, 200_000.0])
    assert points_per_triangle(wanted, 1.0, 900_000).tolist() == pytest.approx([399_999.0, 1.0, 300_000.0, 200_000.0])
    assert points_per_triangle(wanted, 1.0, 700_001).tolist() == pytest.approx([250_000.0, 1.0, 250_000.0, 200_000.0])


def test_what_comes_twice_is_found_whichever_way_it_is_wound():
    both = np.concatenate([PLATE, PLATE[:, ::-1], PLATE[:1, [1, 2, 0]]])
    ordered = np.take_along_axis(both, in_fixed_order(both)[:, :, None], axis=1)
    assert find_distinct(ordered).tolist() == [True, True, False, False, False]


# --- polygons ---

ELL = np.array([[0, 0, 0], [2, 0, 0], [2, 1, 0], [1, 1, 0], [1, 2, 0], [0, 2, 0]], dtype=np.float64)


def profile(n_steps):
    """The side of a flight as one polygon, with 2 n + 2 corners, as a string of a stair is drawn."""
    zigzag = [(k // 2 * 0.28, 0.0, (k + 1) // 2 * 0.17) for k in range(2 * n_steps + 1)]
    return np.array([*zigzag, (n_steps * 0.28, 0.0, 0.0)])


@pytest.mark.parametrize("shift", range(6))
@pytest.mark.parametrize("step", [1, -1])
def test_a_polygon_with_a_corner_inwards_keeps_its_area(shift, step):
    corners = np.roll(ELL, shift, axis=0)[::step]
    found = triangulate(corners, np.arange(6), np.array([6]))
    assert found.n_left_out == 0
    assert areas_of(corners[found.triangles]).sum() == pytest.approx(3.0)
    assert len(found.triangles) == 4


def test_the_side_of_a_long_flight_is_cut_into_triangles():
    corners = profile(18)
    found = triangulate(corners, np.arange(len(corners)), np.array([len(corners)]))
    assert found.n_left_out == 0
    assert areas_of(corners[found.triangles]).sum() == pytest.approx(0.28 * 0.17 * 18 * 19 / 2)


def test_polygons_of_many_lengths_and_those_without_area():
    vertices = np.concatenate([ELL, [[5.0, 0, 0], [6, 0, 0], [6, 1, 0], [5, 1, 0]]])
    found = triangulate(vertices, np.array([6, 7, 8, 9, 6, 7, *range(6), 6, 7, 8]), np.array([4, 2, 6, 3]))
    assert areas_of(vertices[found.triangles]).sum() == pytest.approx(1.0 + 3.0 + 0.5)


def test_no_polygon_gives_no_triangle():
    found = triangulate(ELL, np.arange(2), np.array([2]))
    assert (found.triangles.shape, found.n_left_out) == ((0, 3), 0)


@pytest.mark.parametrize("shift", range(4))
@pytest.mark.parametrize("place", [(0.0, 0.0, 0.0), (389412.3, 5819322.1, 42.0)], ids=["near", "utm"])
def test_a_quadrangle_with_a_corner_inwards_is_no_fan(shift, place):
    dart = np.array([[0, 0, 0], [4, 1, 1], [0, 2, 0], [1, 1, 0.25]], dtype=np.float64)
    corners = np.roll(dart, shift, axis=0) + place
    found = triangulate(corners, np.arange(4), np.array([4]))
    # Half of 2 by 4 less half of 2 by 1, in a plane that rises by a quarter.
    assert areas_of(corners[found.triangles]).sum() == pytest.approx(3.0 * np.hypot(1.0, 0.25), rel=1e-6)


@pytest.mark.parametrize("k", [5, 7, 12])
def test_polygons_with_any_corners_inwards_keep_their_areas_wherever_they_lie(k):
    rng = np.random.default_rng(k)
    turn = rotation("x", 40.0) @ rotation("z", 25.0)
    n_turned_in = 0
    for _ in range(90):
        # Corners around a middle, in any distance from it.
        angles = 2.0 * np.pi * (np.arange(k) + rng.uniform(0.0, 0.8, k)) / k
        x, y = rng.uniform(0.1, 1.0, k) * [np.cos(angles), np.sin(angles)] + [[3.0], [-5.0]]
        to_next = np.roll([x, y], -1, axis=1) - [x, y]
        turns = np.roll(to_next[0], 1) * to_next[1] - np.roll(to_next[1], 1) * to_next[0]
        n_turned_in += np.count_nonzero(turns < 0.0)
        area = 0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))
        corners = np.column_stack([x, y, np.full(k, 2.0)]) @ turn.T
        found = triangulate(corners, np.arange(k), np.array([k]))
        assert (len(found.triangles), found.n_left_out) == (k - 2, 0)
        assert areas_of(corners[found.triangles]).sum() == pytest.approx(area)
    assert n_turned_in > 30


def test_a_hole_that_a_bridge_joins_to_the_rim_stays_a_hole():
    rim = [[0, 0, 0], [4, 0, 0], [4, 3, 0], [0, 3, 0]]
    hole = [[1, 1, 0], [1, 2, 0], [3, 2, 0], [3, 1, 0]]
    vertices = np.array(rim + hole, dtype=np.float64)
    # From the first corner of the rim to that of the hole, around it, and back.
    for corners in ([0, 1, 2, 3, 0, 4, 5, 6, 7, 4], [0, 4, 7, 6, 5, 4, 0, 3, 2, 1]):
        # Some files write the places of the bridge twice.
        for kept in (vertices, vertices[corners]):
            numbers = np.array(corners if kept is vertices else range(10))
            found = triangulate(kept, numbers, np.array([10]))
            assert found.n_left_out == 0
            assert areas_of(kept[found.triangles]).sum() == pytest.approx(12.0 - 2.0)
            x, y, _ = kept[found.triangles].mean(axis=1).T
            assert not ((x > 1.0) & (x < 3.0) & (y > 1.0) & (y < 2.0)).any()


def test_what_is_left_of_the_work_goes_to_the_next_polygon_and_who_gets_none_is_counted(monkeypatch):
    corners = profile(18)
    lengths = np.full(5, len(corners))
    numbers = np.tile(np.arange(len(corners)), 5)
    whole = triangulate(corners, numbers, lengths)
    assert (len(whole.triangles), whole.n_left_out) == (5 * (len(corners) - 2), 0)
    # Between 36 and so many times as many corners are tried in each, against up to 38 others.
    monkeypatch.setattr(polygons, "_MOST_WORK", 2 * 36 * 100)
    some = triangulate(corners, numbers, lengths)
    assert 3 <= some.n_left_out <= 4
    assert len(some.triangles) == (5 - some.n_left_out) * (len(corners) - 2)


def test_a_polygon_that_crosses_itself_is_left_out_and_hostile_ones_end_soon():
    rng = np.random.default_rng(1)
    star = rng.random((3000, 3)) * [1.0, 1.0, 0.0]
    found = triangulate(star, np.arange(3000), np.full(30, 100))
    assert found.n_left_out > 25


# --- faces of scans and of models ---


def grid_of(side, shape, noise, seed=0):
    """The triangles of an even grid of squares, its corners off the plane by noise."""
    x, y = np.meshgrid(np.arange(shape[0]) * side, np.arange(shape[1]) * side, indexing="ij")
    points = np.stack([x, y, np.random.default_rng(seed).normal(0.0, noise, x.shape)], axis=-1)
    low, right, up, across = points[:-1, :-1], points[1:, :-1], points[:-1, 1:], points[1:, 1:]
    halves = [np.stack(each, axis=2).reshape(-1, 3, 3) for each in ((low, right, across), (low, across, up))]
    return np.concatenate(halves)


def test_the_faces_of_a_scanned_mesh_are_as_long_as_most_of_their_edges():
    # Two sides of each half of a square are 15 mm, one is longer.
    scanned = grid_of(0.015, (60, 70), 0.001)
    assert facet_of(scanned, areas_of(scanned)) == pytest.approx(0.015, rel=0.01)
    assert facet_of(scanned[:, ::-1], areas_of(scanned)) == facet_of(scanned, areas_of(scanned))


@pytest.mark.parametrize("turn", [np.eye(3), rotation("x", 20.0) @ rotation("z", 33.0)])
@pytest.mark.parametrize("decimals", [3, 9])
def test_a_model_has_no_such_faces_however_finely_it_is_cut_turned_or_rounded(turn, decimals):
    model = np.asarray(stair_of_solids().subdivide_to_size(0.4).triangles)
    kept = np.round(model @ turn.T, decimals).astype(np.float32).astype(np.float64)
    areas = areas_of(kept)
    assert facet_of(kept[areas > 0.0], areas[areas > 0.0]) is None
    flat = grid_of(0.02, (40, 40), 0.0) @ turn.T
    assert facet_of(flat, areas_of(flat)) is None


def test_whatever_corners_have_is_interpolated_over_the_face():
    corners = np.array(
        [[[0, 0, 0], [0.3, 0.1, 0], [0.1, 0.5, 0.2]], [[2, 0, 1], [2, 1, 1], [2, 0, 3]]], dtype=np.float64
    )
    ordered = np.take_along_axis(corners, in_fixed_order(corners)[:, :, None], axis=1)
    slopes = np.array([[3.0, -40.0], [0.5, 100.0], [2.0, 7.0]])
    values = np.concatenate([ordered, 20.0 + ordered @ slopes], axis=2)
    found, on = sample_triangles(values, np.array([100.0, 700.0]))
    assert np.bincount(on).tolist() == [100, 700]
    np.testing.assert_allclose(found[:, 3:], 20.0 + found[:, :3] @ slopes, atol=1e-9)
    a, b, c = ordered[on].transpose(1, 0, 2)
    parts = np.stack(
        [
            areas_of(np.stack(each, axis=1))
            for each in ((found[:, :3], b, c), (a, found[:, :3], c), (a, b, found[:, :3]))
        ]
    )
    np.testing.assert_allclose(parts.sum(axis=0), areas_of(ordered)[on], rtol=1e-9)


def test_of_small_triangles_in_a_row_each_has_its_share_and_all_together_one_at_least():
    row = np.repeat(PLATE[:1], 400, axis=0) + np.arange(400)[:, None, None]
    points, on = sample_triangles(row, np.full(400, 0.25))
    assert len(points) == 100
    assert np.bincount(on // 4, minlength=100).tolist() == [1] * 100
    assert len(sample_triangles(row[:1], np.array([0.01]))[0]) == 1


def test_the_point_of_a_triangle_lies_anywhere_in_it():
    corners = np.repeat(np.array([[[0, 0, 0], [1, 0, 0], [0, 1, 0]]], dtype=np.float64), 6000, axis=0)
    x, y = sample_triangles(corners, np.ones(6000))[0][:, :2].T
    # Means of a coordinate, of its square and of a product over the triangle, to three sigma of 6000 points.
    assert [x.mean(), y.mean()] == pytest.approx([1 / 3, 1 / 3], abs=0.01)
    assert [(x * x).mean(), (y * y).mean(), (x * y).mean()] == pytest.approx([1 / 6, 1 / 6, 1 / 12], abs=0.008)
