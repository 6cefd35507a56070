"""When the cells that two stations saw agree on one distance, and when the order of the points tells the stations."""

import numpy as np
import pytest

from stair_inspector.stages.station_layers import _by_order, _lower_of_two
from stair_inspector.stages.station_motion import _agreeing, _is_on_largest

PLANES_M = np.repeat([0.0, 0.17, 0.34], 10)
NOISE_M = np.random.default_rng(1).normal(0.0, 1e-4, 30)


def test_cells_on_several_planes_agree_on_their_distance():
    assert _agreeing(0.012 + NOISE_M, PLANES_M, 1e-4).all()
    stray = 0.012 + NOISE_M
    stray[0] = 0.03
    assert np.flatnonzero(~_agreeing(stray, PLANES_M, 1e-4)).tolist() == [0]


def test_a_plane_that_both_saw_and_that_has_stayed_is_enough():
    apart_m = 0.012 + np.random.default_rng(4).normal(0.0, 1e-4, 80)
    offset_m = np.repeat([-1.0, 0.0, 0.17], (4, 38, 38))
    assert _agreeing(apart_m, offset_m, 1e-4) is not None
    apart_m[:4] -= 0.012
    assert _agreeing(apart_m, offset_m, 1e-4) is None


@pytest.mark.parametrize(
    ("change", "offset_m"),
    [
        pytest.param(lambda apart: apart, np.zeros(30), id="one plane"),
        pytest.param(lambda apart: np.where(np.arange(30) % 6 == 0, 0.03, apart), PLANES_M, id="a sixth strays"),
        pytest.param(lambda apart: apart + np.linspace(0.0, 0.006, 30), PLANES_M, id="spread"),
    ],
)
def test_where_cells_do_not_agree_there_is_no_distance(change, offset_m):
    assert _agreeing(change(0.012 + NOISE_M), offset_m, 1e-4) is None


def test_the_largest_plane_of_all_shows_the_distance():
    every = np.repeat([0.0, 0.17, 0.34], (40, 8, 8))
    assert _is_on_largest(every, np.repeat([0.0, 0.17], (4, 8)))
    assert not _is_on_largest(every, np.repeat([0.0, 0.17, 0.34], (3, 8, 8)))


def points_in_a_row(n=4000):
    return np.column_stack([np.arange(n) * 0.01 + np.where(np.arange(n) < n // 2, 0.0, 50.0), np.zeros(n), np.zeros(n)])


def test_the_order_tells_stations_whose_layers_are_parted_in_it():
    rows = np.arange(0, 4000, 2)
    told = _by_order(points_in_a_row(), rows, rows >= 2000, 0.01)
    assert told.is_high.tolist() == [False] * 2000 + [True] * 2000


@pytest.mark.parametrize("how", ["mixed", "gap", "few"])
def test_the_order_tells_nothing_where_layers_are_mixed_or_little_is_told(how):
    rows = np.arange(0, 4000, 2)
    is_high = rows >= 2000
    if how == "mixed":
        is_high ^= np.random.default_rng(2).uniform(size=len(rows)) < 0.1
    keep = {"mixed": rows >= 0, "gap": np.abs(rows - 2000) > 300, "few": rows % 20 == 0}[how]
    assert _by_order(points_in_a_row(), rows[keep], is_high[keep], 0.05) is None


def test_two_layers_have_a_valley_between_them():
    rng = np.random.default_rng(3)
    layers = np.concatenate([rng.normal(0.0, 0.001, 300), rng.normal(0.012, 0.001, 60)])
    assert _lower_of_two(layers, 0.012) == pytest.approx(0.0, abs=0.002)
    assert _lower_of_two(rng.uniform(0.0, 0.012, 400), 0.012) is None
    assert _lower_of_two(rng.normal(0.0, 0.001, 400), 0.012) is None
