"""Where means change in the order of the points: told by many points where no layer shows."""

import numpy as np
import pytest

from stair_inspector.stages.layers import Cells
from stair_inspector.stages.order_shifts import find_order_shift, flat_ways

N_EACH = 12_000


def level_points(offsets_m, sigma_m=0.005, seed=2):
    """Floor and a step seen by stations one after the other, each so much higher than it should be."""
    rng = np.random.default_rng(seed)
    stations = []
    for offset_m in offsets_m:
        x, y = rng.uniform(0.0, 1.5, (2, N_EACH))
        # A station passes from one side to the other.
        x.sort()
        stations.append(np.column_stack([x, y, np.where(y > 0.75, 0.3, 0.0) + offset_m]))
    points = np.vstack(stations)
    points[:, 2] += rng.normal(0.0, sigma_m, len(points))
    return points


def shift_of(points, stride=1, rounded_m=0.0):
    cells = Cells(points[::stride])
    return find_order_shift(points, cells, flat_ways(cells), stride, rounded_m)


@pytest.mark.parametrize(("apart_m", "stride"), [(0.006, 1), (0.012, 1), (-0.012, 2)])
def test_a_shift_under_noise_is_found_where_the_next_station_begins(apart_m, stride):
    found = shift_of(level_points((0.0, apart_m)), stride)
    assert found.is_two
    is_low = found.is_low if found.normal[2] * apart_m > 0.0 else ~found.is_low
    assert np.count_nonzero(is_low != (np.arange(2 * N_EACH) < N_EACH)) <= 2 * stride


def test_the_stations_between_are_found_too():
    found = shift_of(level_points((0.0, 0.01, 0.0, 0.01)))
    is_low = found.is_low if found.normal[2] > 0.0 else ~found.is_low
    assert found.is_two
    assert np.count_nonzero(is_low != np.repeat([True, False, True, False], N_EACH)) <= 8


def test_three_places_are_not_two():
    assert not shift_of(level_points((0.0, 0.01, 0.02))).is_two


@pytest.mark.parametrize(("rounded_m", "is_two"), [(0.0, False), (0.0065, True)])
def test_parts_of_one_station_may_lie_half_a_step_of_the_coordinates_apart(rounded_m, is_two):
    found = shift_of(level_points((0.0, 0.005, 0.012)), rounded_m=rounded_m)
    assert found.is_two == is_two


@pytest.mark.parametrize("how", ["together", "two millimetres", "shuffled"])
def test_nothing_is_found_where_nothing_changes(how):
    points = level_points((0.0, {"together": 0.0, "two millimetres": 0.002, "shuffled": 0.012}[how]))
    assert shift_of(np.random.default_rng(1).permutation(points) if how == "shuffled" else points) is None
