"""Which points are horizontal, and the labels of the height clusters."""

import math
from dataclasses import replace

import numpy as np
import pytest

from stair_inspector.errors import CannotMeasure
from stair_inspector.model import HeightOrder, Up
from stair_inspector.params import HorizontalParams, LevelsParams
from stair_inspector.stages.levels import (
    MAX_LEVELS,
    find_height_reach,
    find_levels,
    profile_heights,
    select_horizontal,
)


def order_of(heights, alignment=None, point_ids=None):
    heights = np.asarray(heights, dtype=np.float64)
    n = len(heights)
    return HeightOrder(
        point_ids=np.arange(n) if point_ids is None else np.asarray(point_ids),
        alignment=np.ones(n) if alignment is None else np.asarray(alignment, dtype=np.float64),
        coordinates_m=np.stack([np.zeros(n), np.zeros(n), heights]),
        level_from_scan=np.eye(3),
        up=Up(np.array([0.0, 0.0, 1.0]), "given"),
        n_scan=n,
    )


def levels_of(order, eps_m=0.02, min_points=3, theta_deg=15.0):
    horizontal = select_horizontal(order, HorizontalParams(theta_deg=theta_deg))
    return find_levels(horizontal, find_height_reach(horizontal, eps_m), LevelsParams(eps_m, min_points))


@pytest.mark.parametrize("theta_deg", [1.0, 15.0, 37.5, 60.0])
def test_eq2_theta_is_inclusive(theta_deg):
    limit = math.cos(math.radians(theta_deg))
    alignment = [np.nextafter(limit, 0.0), limit, np.nextafter(limit, 1.0), 1.0, 0.0]
    kept = select_horizontal(order_of(range(5), alignment), HorizontalParams(theta_deg=theta_deg))
    np.testing.assert_array_equal(kept.point_ids, [1, 2, 3])
    np.testing.assert_array_equal(kept.coordinates_m[2], [1.0, 2.0, 3.0])
    assert kept.n_scan == 5


def test_eq4_the_lowest_cluster_is_the_floor_and_the_others_count_upwards():
    heights = [0.0, 0.01, 0.02, 0.1, 0.17, 0.17, 0.18, 0.34, 0.34, 0.34]
    ids = [9, 8, 7, 6, 5, 4, 3, 2, 1, 0]
    levels = levels_of(order_of(heights, point_ids=ids))
    assert list(zip(levels.start, levels.stop, strict=True)) == [(0, 3), (4, 7), (7, 10)]
    np.testing.assert_array_equal(levels.labels, [2, 2, 2, 1, 1, 1, -1, 0, 0, 0])


@pytest.mark.parametrize(("eps_m", "n_levels"), [(0.015625, 1), (0.0156, 0)])
def test_eq3_heights_exactly_eps_apart_are_neighbours(eps_m, n_levels):
    assert len(levels_of(order_of([0.0, 0.015625, 0.03125]), eps_m, min_points=3).start) == n_levels


def test_what_lies_outside_a_region_is_as_horizontal_as_what_lies_in_it():
    whole = order_of([0.0, 1.0, 2.0], alignment=[1.0, 0.1, 1.0])
    kept = select_horizontal(replace(order_of([0.0]), whole=whole), HorizontalParams())
    np.testing.assert_array_equal(kept.whole.point_ids, [0, 2])


def test_labels_of_points_that_are_not_horizontal_are_non_stair():
    levels = levels_of(order_of([0.0] * 6, alignment=[1, 1, 1, 0.5, 0.5, 1]))
    np.testing.assert_array_equal(levels.labels, [0, 0, 0, -1, -1, 0])


@pytest.mark.parametrize(
    ("heights", "alignment"), [([0.0, 1.0, 2.0], None), ([0.0, 0.0, 0.0, 0.0], [0.1] * 4)], ids=["sparse", "upright"]
)
def test_no_levels_is_an_answer(heights, alignment):
    levels = levels_of(order_of(heights, alignment))
    assert len(levels.start) == 0
    assert set(levels.labels) == {-1}


@pytest.mark.parametrize("n_levels", [MAX_LEVELS, MAX_LEVELS + 1])
def test_more_than_500_levels_cannot_be_steps(n_levels):
    order = order_of(np.arange(n_levels) * 0.1)
    if n_levels == 500:
        assert len(levels_of(order, min_points=1).start) == 500
        return
    with pytest.raises(CannotMeasure) as error:
        levels_of(order, min_points=1)
    assert str(error.value) == (
        "levels: 501 height clusters, more than 500 can be steps; raise levels.min_points (m) or levels.eps_m (eps_z)"
    )


def test_profile_counts_by_hand():
    horizontal = select_horizontal(order_of([1.0, 1.0, 1.25, 1.4, 2.0]), HorizontalParams())
    profile = profile_heights(horizontal, bin_m=0.25)
    # A height on the border of two bins belongs to the upper one.
    np.testing.assert_array_equal(profile.counts, [2, 2, 0, 0, 1])
    assert (profile.low_m, profile.bin_m) == (1.0, 0.25)


@pytest.mark.parametrize("tallest", [0.0, 0.001, 3.0, 500.0])
def test_profile_counts_every_point_once_in_at_most_5001_bins(tallest):
    heights = np.sort(np.random.default_rng(1).uniform(0.0, tallest, 1000))
    profile = profile_heights(select_horizontal(order_of(heights), HorizontalParams()))
    assert profile.counts.sum() == 1000
    assert len(profile.counts) <= 5001
    assert profile.low_m + len(profile.counts) * profile.bin_m >= heights[-1]


def test_profile_of_nothing_is_empty():
    assert len(profile_heights(select_horizontal(order_of([0.0], [0.0]), HorizontalParams())).counts) == 0
