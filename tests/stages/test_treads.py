"""Planes, axes, edges and nearest points: every equation of steps 5 to 8 and 10 against numbers worked out by hand."""

import itertools

import numpy as np
import pytest

from stair_inspector.model import Extents, Horizontal, Levels, Surfaces, Up
from stair_inspector.params import DisplayParams, EdgesParams
from stair_inspector.stages.treads import find_axes, find_extents, find_nearest, fit_surfaces, place_edges
from tests.synthetic import rotation

UP_Z = Up(np.array([0.0, 0.0, 1.0]), "given")


def horizontal_of(*levels):
    """The model values of point sets (n, 3), the floor first, in scan axes that are level."""
    points = np.concatenate([np.asarray(level, dtype=np.float64) for level in levels])
    stops = np.cumsum([len(level) for level in levels])
    starts = stops - [len(level) for level in levels]
    labels = np.repeat(np.arange(len(levels)), stops - starts).astype(np.int16)
    horizontal = Horizontal(np.arange(len(points)), np.ascontiguousarray(points.T), np.eye(3), UP_Z, len(points))
    return horizontal, Levels(starts, stops, labels)


def corners(centre, depth, width, turn_deg=0.0):
    """The four corners of a rectangle ``depth`` long in x and ``width`` in y, turned about its centre."""
    signs = np.array([[-1, -1, 0], [-1, 1, 0], [1, -1, 0], [1, 1, 0]])
    return signs * [depth / 2, width / 2, 0.0] @ rotation("z", turn_deg).T + centre


def flight(centres, depth, width, turn_deg=0.0):
    return horizontal_of(corners((-1.0, 0.0, 0.0), 1.0, width), *(corners(c, depth, width, turn_deg) for c in centres))


def axes_of(horizontal, levels, rule="auto", method="survey"):
    return find_axes(horizontal, fit_surfaces(horizontal, levels), rule, method)


THREE = [(0.0, 0.0, 0.2), (1.0, 0.0, 0.4), (2.0, 0.0, 0.6)]
"""Centres of three steps that rise along +x."""


# --- step 8: planes ------------------------------------------------------------------------------------------------


def test_eq8_centroid_normal_and_rms_of_each_level():
    saddle = corners((5.0, 1.0, 0.5), 2.0, 2.0)
    saddle[:, 2] += [0.002, -0.002, -0.002, 0.002]
    slope = corners((0.0, 0.0, 1.0), 8.0, 2.0)
    slope[:, 2] += [-3.0, -3.0, 3.0, 3.0]
    surfaces = fit_surfaces(*horizontal_of(corners((0, 0, 0), 1, 1), saddle, slope))
    _, first, second = surfaces.planes
    np.testing.assert_allclose(first.centroid, [5.0, 1.0, 0.5], atol=1e-15)
    np.testing.assert_allclose(first.normal, [0.0, 0.0, 1.0], atol=1e-12)
    assert first.rms_m == pytest.approx(0.002, rel=1e-12)
    # z = 3/4 x.
    np.testing.assert_allclose(second.normal, [-0.6, 0.0, 0.8], atol=1e-14)
    assert second.rms_m == pytest.approx(0.0, abs=1e-14)


def test_planes_come_back_in_scan_axes():
    # The scan's y axis points up: level = (z, x, y).
    level_from_scan = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    flat, levels = horizontal_of(corners((3.0, 7.0, 0.5), 1.0, 2.0))
    turned = Horizontal(
        flat.point_ids, flat.coordinates_m, level_from_scan, Up(np.array([0.0, 1.0, 0.0]), "given"), flat.n_scan
    )
    plane = fit_surfaces(turned, levels).planes[0]
    np.testing.assert_allclose(plane.centroid, [7.0, 0.5, 3.0])
    np.testing.assert_allclose(plane.normal, [0.0, 1.0, 0.0], atol=1e-12)


def test_a_collinear_level_has_no_normal():
    line = np.column_stack([np.linspace(0, 1, 60), np.zeros(60), np.full(60, 0.2)])
    plane = fit_surfaces(*horizontal_of(corners((0, 0, 0), 1, 1), line)).planes[1]
    assert plane.normal is None
    assert plane.rms_m is None


# --- step 5: axes --------------------------------------------------------------------------------------------------


def test_eq5_global_swaps_the_axes_of_a_run_that_is_longer_than_wide():
    # Scatter about the common mean: x 12 * 0.1**2 + 4 * (1 + 0 + 1) = 8.12, y 12 * 0.3**2 = 1.08: width along x.
    axes = axes_of(*flight(THREE, 0.2, 0.6), rule="global")
    np.testing.assert_allclose(np.abs(axes.width), [1.0, 0.0, 0.0], atol=1e-12)
    assert axes.rule == "global"


def test_eq5_per_step_does_not():
    # Each step centred: x 0.12, y 1.08: width along y.
    axes = axes_of(*flight(THREE, 0.2, 0.6), rule="per_step")
    np.testing.assert_allclose(axes.width, [0.0, 1.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(axes.depth, [-1.0, 0.0, 0.0], atol=1e-12)
    assert axes.rule == "per_step"


@pytest.mark.parametrize(("half_width", "wide"), [(0.82, [1.0, 0.0, 0.0]), (0.83, [0.0, 1.0, 0.0])])
def test_eq5_global_changes_over_where_the_hand_computed_variances_are_equal(half_width, wide):
    # x: 8.12 as above; y: 12 half_width**2 = 8.07 or 8.27.
    axes = axes_of(*flight(THREE, 0.2, 2 * half_width), rule="global")
    np.testing.assert_allclose(np.abs(axes.width), wide, atol=1e-12)


def test_eq5_global_weights_every_point():
    # The second step has nine times the points of the first. Scatter in x of the means 0 and 1 with weights 4 and 36:
    # 4 * 36 / 40 = 3.6; both steps have no extent in x. In y: 40 h**2, equal at h = 0.3.
    for half_width, wide in ((0.29, [1.0, 0.0, 0.0]), (0.31, [0.0, 1.0, 0.0])):
        first = corners((0.0, 0.0, 0.2), 0.0, 2 * half_width)
        second = np.tile(corners((1.0, 0.0, 0.4), 0.0, 2 * half_width), (9, 1))
        axes = axes_of(*horizontal_of(corners((-1, 0, 0), 1, 1), first, second), rule="global")
        np.testing.assert_allclose(np.abs(axes.width), wide, atol=1e-12)


def test_eq5_the_floor_takes_no_part():
    huge = corners((50.0, 0.0, 0.0), 100.0, 0.1)
    steps = [corners(centre, 0.2, 0.6) for centre in THREE]
    for rule in ("global", "per_step"):
        with_huge = axes_of(*horizontal_of(huge, *steps), rule=rule)
        with_small = axes_of(*flight(THREE, 0.2, 0.6), rule=rule)
        np.testing.assert_array_equal(with_huge.width, with_small.width)


@pytest.mark.parametrize("rule", ["global", "per_step", "auto"])
def test_eq5_pca_equals_numpys_decomposition_of_the_points(rule):
    rng = np.random.default_rng(11)
    clouds = [rng.normal(0, [0.1, 0.4, 0.001], (200 + 50 * k, 3)) @ rotation("z", 25).T for k in range(4)]
    clouds = [cloud + np.array([0.3, 0.14, 0.2]) * k for k, cloud in enumerate(clouds)]
    horizontal, levels = horizontal_of(*clouds)
    axes = axes_of(horizontal, levels, rule, method="paper")
    plan = [cloud[:, :2] for cloud in clouds[1:]]
    points = np.concatenate([p - p.mean(axis=0) for p in plan] if rule == "per_step" else plan)
    _, _, vectors = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)
    assert abs(axes.width[:2] @ vectors[0]) == pytest.approx(1.0, abs=1e-12)


def test_eq5a_auto_is_global_in_paper_mode():
    horizontal, levels = flight(THREE, 0.2, 0.6, turn_deg=7.0)
    auto, by_name = (axes_of(horizontal, levels, rule, method="paper") for rule in ("auto", "global"))
    assert auto.rule == by_name.rule == "global"
    np.testing.assert_array_equal(auto.width, by_name.width)
    np.testing.assert_array_equal(auto.depth, by_name.depth)


def test_eq5a_auto_is_per_step_where_it_agrees_with_the_rise():
    axes = axes_of(*flight(THREE, 0.2, 0.6))
    assert axes.rule == "per_step"
    assert [note.code for note in axes.notes] == ["axes_rule"]
    assert "per_step" in axes.notes[0].message


def test_eq5a_auto_takes_the_rise_where_treads_are_deeper_than_wide():
    axes = axes_of(*flight(THREE, 0.6, 0.2))
    assert axes.rule == "rise"
    np.testing.assert_allclose(axes.depth, [-1.0, 0.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(axes.width, [0.0, 1.0, 0.0], atol=1e-12)
    assert "'rise'" in axes.notes[0].message


@pytest.mark.parametrize(("turn_deg", "rule"), [(19.9, "per_step"), (20.1, "rise"), (-19.9, "per_step")])
def test_eq5a_twenty_degrees_decide(turn_deg, rule):
    assert axes_of(*flight(THREE, 0.2, 0.6, turn_deg)).rule == rule


@pytest.mark.parametrize(("turn_deg", "codes"), [(19.9, []), (20.1, ["axes_disagree"])])
def test_a_chosen_rule_that_disagrees_with_the_rise_by_more_than_twenty_degrees_is_noted_and_kept(turn_deg, codes):
    axes = axes_of(*flight(THREE, 0.2, 0.6, turn_deg), rule="per_step")
    assert [note.code for note in axes.notes] == codes
    np.testing.assert_allclose(axes.depth, rotation("z", turn_deg) @ [-1.0, 0.0, 0.0], atol=1e-12)


def test_the_swap_of_the_global_rule_is_noted_in_paper_mode():
    axes = axes_of(*flight(THREE, 0.2, 0.6), method="paper")
    assert [note.code for note in axes.notes] == ["axes_disagree"]
    assert "'global' is 90°" in axes.notes[0].message


def test_no_step_has_no_axes():
    assert axes_of(*horizontal_of(corners((0, 0, 0), 1, 1))) is None


def test_square_treads_are_noted_as_uncertain():
    codes = [note.code for note in axes_of(*flight(THREE, 0.5, 0.5), rule="per_step").notes]
    assert codes == ["axes_uncertain"]


def test_levels_straight_above_each_other_have_no_known_front():
    codes = [note.code for note in axes_of(*flight([(0, 0, 0.2), (0, 0, 0.4), (0, 0, 0.6)], 0.2, 0.6)).notes]
    assert codes == ["climb_unknown"]


# --- step 6: sign --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("yaw", range(0, 360, 45))
@pytest.mark.parametrize("rule", ["auto", "per_step", "global"])
def test_eq6_depth_points_to_the_front_and_width_to_the_climbers_left(rule, yaw):
    turn = rotation("z", yaw)
    # A run of three goings of 0.2 m is shorter than 3 m of width: every rule finds the same axes.
    steps = [corners((0.2 * k, 0.0, 0.2 * k), 0.2, 3.0) @ turn.T for k in range(4)]
    axes = axes_of(*horizontal_of(*steps), rule=rule)
    climb = turn @ [1.0, 0.0, 0.0]
    np.testing.assert_allclose(axes.depth, -climb, atol=1e-9)
    np.testing.assert_allclose(axes.width, np.cross([0.0, 0.0, 1.0], climb), atol=1e-9)


def test_eq6_a_single_step_takes_the_floor_as_the_way_it_is_climbed_from():
    axes = axes_of(*horizontal_of(corners((2.0, 0.0, 0.0), 1.0, 1.0), corners((0.0, 0.0, 0.2), 0.2, 0.6)))
    np.testing.assert_allclose(axes.depth, [1.0, 0.0, 0.0], atol=1e-12)


# --- step 7: edges -------------------------------------------------------------------------------------------------


def test_eq7_extents_are_projections():
    horizontal, levels = horizontal_of(corners((-1, 0, 0), 1, 1), *(corners(c, 0.2, 0.6) for c in THREE[:2]))
    axes = axes_of(horizontal, levels, rule="per_step")
    extents = find_extents(horizontal, levels, axes)
    # d = -x, w = y.
    np.testing.assert_allclose(np.sort(extents.depth_m[0]), [-0.1, -0.1, 0.1, 0.1], atol=1e-15)
    np.testing.assert_allclose(np.sort(extents.depth_m[1]), [-1.1, -1.1, -0.9, -0.9], atol=1e-15)
    np.testing.assert_allclose(np.sort(extents.width_m[1]), [-0.3, -0.3, 0.3, 0.3], atol=1e-15)


def test_eq7_percentiles_by_hand():
    # 0, 10, ..., 1000 mm and 0, 20, ..., 2000 mm: 101 values, so percentile p is p times the spacing.
    shuffled = np.random.default_rng(0).permutation(101)
    extents = Extents((shuffled * 0.01,), (shuffled * 0.02,))
    edges = place_edges(extents, EdgesParams())
    assert edges.front == pytest.approx((0.95,))
    assert edges.back == pytest.approx((0.05,))
    assert edges.high_w == pytest.approx((1.98,))
    assert edges.low_w == pytest.approx((0.02,))


def test_eq7_percentiles_between_two_points_are_interpolated():
    # Five values: percentile p lies at position p / 25.
    extents = Extents((np.array([0.0, 1.0, 2.0, 3.0, 7.0]),), (np.array([0.0, 1.0, 2.0, 3.0, 4.0]),))
    edges = place_edges(extents, EdgesParams(front_percentile=90.0, back_percentile=10.0, side_percentile=55.0))
    assert edges.front == pytest.approx((3.0 + 0.6 * 4.0,))
    assert edges.back == pytest.approx((0.4,))
    assert edges.high_w == pytest.approx((2.2,))
    assert edges.low_w == pytest.approx((1.8,))


# --- step 10: nearest ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("k", "expected"), [(0, []), (1, [0]), (3, [0, 3, 1]), (4, [0, 3, 1, 2]), (50, [0, 3, 1, 2, 4])]
)
def test_eq10_nearest_points_in_order_of_distance(k, expected):
    # Centroid (0, 0, 0); distances 0.1, 3, 4, 1, 5 and their balance.
    step = np.array([[0.1, 0, 0], [0, 3, 0], [-4, 0, 0], [0, 0, 1], [3.9, -3, -1.0]])
    floor = np.zeros((4, 3)) - [0, 0, 9]
    horizontal, levels = horizontal_of(floor, step)
    surfaces = fit_surfaces(horizontal, levels)
    np.testing.assert_allclose(surfaces.planes[1].centroid, 0.0, atol=1e-15)
    nearest = find_nearest(horizontal, levels, surfaces, DisplayParams(nearest_k=k))
    np.testing.assert_array_equal(nearest.ids[0], np.array(expected, dtype=int) + len(floor))


def test_eq10_equals_a_full_sort():
    rng = np.random.default_rng(12)
    horizontal, levels = horizontal_of(*(rng.normal(0, 1, (300, 3)) + np.array([1, 0, 10]) * k for k in range(3)))
    surfaces = fit_surfaces(horizontal, levels)
    nearest = find_nearest(horizontal, levels, surfaces, DisplayParams(nearest_k=20))
    for ids, plane, start in zip(nearest.ids, surfaces.planes[1:], levels.start[1:], strict=True):
        distance = np.linalg.norm(horizontal.coordinates_m.T - plane.centroid, axis=1)
        np.testing.assert_array_equal(ids, start + np.argsort(distance[start : start + 300])[:20])


def test_results_are_read_only():
    horizontal, levels = flight(THREE, 0.2, 0.6)
    surfaces = fit_surfaces(horizontal, levels)
    axes = find_axes(horizontal, surfaces, "auto", "survey")
    extents = find_extents(horizontal, levels, axes)
    nearest = find_nearest(horizontal, levels, surfaces, DisplayParams())
    arrays = [axes.width, axes.depth, *extents.depth_m, *extents.width_m, *nearest.ids, *surfaces.plan_scatter]
    arrays += itertools.chain.from_iterable((plane.centroid, plane.normal) for plane in surfaces.planes)
    assert all(not array.flags.writeable for array in arrays)
    assert isinstance(surfaces, Surfaces)
