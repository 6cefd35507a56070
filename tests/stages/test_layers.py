"""Surfaces that are double because stations do not lie over each other; and everything that only looks like it."""

import numpy as np
import pytest

from stair_inspector.stages.layers import find_doubled
from tests.synthetic import Stair, rotation

EXACT = np.zeros(3)


def station(noise, seed=1, spacing=0.012, **changes):
    settings = {"n_steps": 7, "risers": True, "floor_depth": 1.5, **changes}
    return Stair(noise=noise, seed=seed, spacing=spacing, **settings).sample()[0]


def two_stations(shift, noise, first=np.inf, second=-np.inf, **changes):
    """Two stations, the second displaced by ``shift``; the first sees x up to ``first``, the second from ``second``."""
    one, other = station(noise, 1, **changes), station(noise, 5, **changes)
    return np.concatenate([one[one[:, 0] < first], other[other[:, 0] > second] + shift])


def only(points, steps_m=EXACT):
    (way,) = find_doubled(points, steps_m)
    return way


@pytest.mark.parametrize(
    ("apart_mm", "noise_mm"),
    [(4, 1), (6, 1), (8, 2), (12, 2), (12, 3), (20, 1), (20, 5), (40, 5), (60, 2), (60, 5)],
)
def test_stations_at_different_heights(apart_mm, noise_mm):
    way = only(two_stations([0.0, 0.0, apart_mm / 1000.0], noise_mm / 1000.0))
    assert way.apart_m * 1000.0 == pytest.approx(apart_mm, abs=0.03 * apart_mm + 0.2)
    assert abs(way.normal[2]) > 0.99
    assert way.share > 0.5


@pytest.mark.parametrize("spacing", [0.007, 0.02])
def test_dense_and_sparse_stations(spacing):
    assert only(two_stations([0.0, 0.0, 0.015], 0.002, spacing=spacing)).apart_m == pytest.approx(0.015, abs=5e-4)


def test_any_direction_is_up():
    turn = rotation("x", 90.0) @ rotation("z", 30.0)
    way = only(two_stations([0.0, 0.0, 0.02], 0.002) @ turn.T)
    assert way.apart_m == pytest.approx(0.02, abs=5e-4)
    assert abs(float(way.normal @ turn[:, 2])) > 0.99


def test_stations_shifted_along_the_climb_show_on_the_risers():
    way = only(two_stations([0.02, 0.0, 0.0], 0.002, spacing=0.008, width=1.4))
    assert way.apart_m == pytest.approx(0.02, abs=1e-3)
    assert abs(way.normal[0]) > 0.99


def test_stations_that_have_only_some_treads_and_a_part_of_the_floor_in_common():
    way = only(two_stations([0.0, 0.0, 0.02], 0.002, first=1.4, second=-0.9))
    assert way.apart_m == pytest.approx(0.02, abs=5e-4)


@pytest.mark.parametrize("noise", [0.0, 0.001, 0.005, 0.012])
def test_one_layer_is_one_layer_however_noisy(noise):
    assert find_doubled(station(noise), EXACT) == ()


def test_two_stations_that_lie_over_each_other_are_one_layer():
    assert find_doubled(two_stations([0.0, 0.0, 0.0], 0.002), EXACT) == ()
    # What the noise hides does no harm.
    assert find_doubled(two_stations([0.0, 0.0, 0.002], 0.002), EXACT) == ()


@pytest.mark.parametrize("thick_mm", [12, 20, 40, 60, 100])
def test_undersides_of_open_treads_are_no_second_layer(thick_mm):
    stair = Stair(n_steps=7, spacing=0.012, floor_depth=1.5)
    parts = [points for points, _ in stair.parts()]
    points = np.concatenate([*parts, *(tread - [0.0, 0.0, thick_mm / 1000.0] for tread in parts[1:])])
    assert find_doubled(points + np.random.default_rng(3).normal(0.0, 0.002, points.shape), EXACT) == ()


def test_a_runner_of_carpet_is_no_second_layer():
    points = station(0.001)
    points[np.abs(points[:, 1] - 0.5) < 0.35, 2] += 0.012
    assert find_doubled(points, EXACT) == ()


def test_a_skirting_before_a_wall_is_no_second_layer():
    rng = np.random.default_rng(4)
    wall = np.column_stack([rng.uniform(0, 4, 40_000), rng.normal(0.0, 0.001, 40_000), rng.uniform(0, 1, 40_000)])
    wall[wall[:, 2] < 0.1, 1] -= 0.015
    assert find_doubled(wall, EXACT) == ()


@pytest.mark.parametrize("pitch_deg", [0.0, 20.0, 34.0])
def test_the_fronts_of_nosings_are_no_second_layer_over_their_risers(pitch_deg):
    # From above a nosing's shadow parts its front from the riser; the next front is seen below the same riser.
    stair = Stair(n_steps=7, risers=True, spacing=0.01, floor_depth=1.5)
    parts = [points for points, _ in stair.parts()]
    treads, risers = parts[: stair.n_steps + 1], parts[stair.n_steps + 1 :]
    tops = [k * stair.rise for k in stair.step_ids]
    fronts = [riser[riser[:, 2] > top - 0.03] - [0.02, 0.0, 0.0] for riser, top in zip(risers, tops, strict=True)]
    seen = [riser[riser[:, 2] < top - 0.045] for riser, top in zip(risers, tops, strict=True)]
    points = np.concatenate([*treads, *fronts, *seen])
    points = points + np.random.default_rng(3).normal(0.0, 0.001, points.shape)
    assert find_doubled(points @ rotation("y", pitch_deg).T, EXACT) == ()


@pytest.mark.parametrize("step_mm", [1, 5, 10, 20])
def test_the_layers_of_rounded_coordinates_are_none(step_mm):
    step_m = step_mm / 1000.0
    rounded = np.unique(np.round((station(0.002) + 0.4 * step_m) / step_m), axis=0) * step_m
    assert find_doubled(rounded, np.full(3, step_m)) == ()


def test_doubles_show_through_a_fine_rounding():
    rounded = two_stations([0.0, 0.0, 0.015], 0.002).round(3)
    assert only(rounded, np.full(3, 0.001)).apart_m == pytest.approx(0.015, abs=1e-3)


def test_few_points_show_nothing():
    assert find_doubled(station(0.002)[:100], EXACT) == ()
    assert find_doubled(np.zeros((1, 3)), EXACT) == ()


@pytest.mark.parametrize("thick_m", [0.01, 0.015, 0.04])
def test_a_balustrade_seen_from_both_sides_is_one_thing_and_not_two_stations(thick_m):
    rng = np.random.default_rng(9)
    faces = [
        np.column_stack([rng.uniform(0.0, 2.8, 20_000), rng.normal(y, 0.001, 20_000), rng.uniform(0.0, 1.1, 20_000)])
        for y in (-0.3, -0.3 - thick_m)
    ]
    assert find_doubled(np.concatenate([station(0.001), *faces]), EXACT) == ()
    # Nor where the largest thing that faces the same way is another one.
    wall = np.column_stack(
        [rng.uniform(-1.0, 3.0, 40_000), rng.normal(1.6, 0.001, 40_000), rng.uniform(0.0, 2.5, 40_000)]
    )
    assert find_doubled(np.concatenate([station(0.001), *faces, wall]), EXACT) == ()
