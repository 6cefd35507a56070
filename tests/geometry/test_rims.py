"""The edge of a surface of bars, from the outermost of points that lie anywhere on them with equal chance."""

import numpy as np
import pytest

from stair_inspector.geometry.rims import find_rim_edge

SPAN = (0.2, 1.2)
SIGMA_M = 0.0005


def bars(seed=0, slope=0.0, per_m2=30_000.0, along=SPAN, shift=0.0):
    """Bars of 30 mm along an edge that is at ``shift`` in the middle of its span, with gaps of 10 mm behind them."""
    rng = np.random.default_rng(seed)
    n = round(3 * 0.03 * (along[1] - along[0]) * per_m2)
    inside = rng.uniform(0.0, 0.03, n) + 0.04 * rng.integers(0, 3, n)
    places = rng.uniform(*along, n)
    return shift + slope * (places - sum(SPAN) / 2.0) - inside, places


def rim_of(out, along, guess_m=0.01, is_square=False):
    return find_rim_edge(out, along, SPAN, guess_m, SIGMA_M, is_square)


@pytest.mark.parametrize(("slope", "shift"), [(0.0, 0.0), (0.03, 0.5), (-0.05, -2.0)])
def test_the_outermost_points_tell_where_bars_end_and_how_they_run(slope, shift):
    found = [rim_of(*bars(seed, slope, shift=shift), guess_m=shift + 0.01) for seed in range(40)]
    off = np.array([edge.at(sum(SPAN) / 2.0) - shift for edge in found])
    # The points are 0.7 mm apart; the middle of pieces whose errors are lopsided is off by a part of it.
    assert abs(off.mean()) < 0.0002
    assert off.std() < 0.0004
    assert np.mean([edge.slope for edge in found]) == pytest.approx(slope, abs=5e-4)
    slope_noise = np.sqrt(np.mean([edge.slope_noise**2 for edge in found]))
    assert 0.6 < slope_noise / np.std([edge.slope for edge in found]) < 1.6
    assert all(abs(value) <= 2.0 * edge.noise_m for value, edge in zip(off, found, strict=True))
    assert all(edge.support == 1.0 and edge.is_counted and edge.source == "tread" for edge in found)


def test_the_fewer_points_tell_it_the_less_the_edge_is_known():
    dense, sparse = (rim_of(*bars(1, per_m2=per_m2)) for per_m2 in (40_000.0, 10_000.0))
    # Four times as far apart.
    assert 3.0 < (sparse.noise_m**2 - SIGMA_M**2) ** 0.5 / (dense.noise_m**2 - SIGMA_M**2) ** 0.5 < 5.5
    assert dense.noise_m > SIGMA_M


def test_a_square_edge_has_no_slope():
    edge = rim_of(*bars(2, slope=0.01), is_square=True)
    assert edge.slope == 0.0
    assert edge.at(0.7) == pytest.approx(0.0, abs=0.003)


def test_what_lies_far_off_or_beyond_the_span_is_nothing_of_the_edge():
    out, along = bars(3)
    rng = np.random.default_rng(7)
    strange_out = np.concatenate([rng.uniform(0.15, 0.2, 500), rng.uniform(0.02, 0.05, 1000)])
    ends = np.where(rng.random(1000) < 0.5, rng.uniform(0.0, 0.19, 1000), rng.uniform(1.21, 1.4, 1000))
    strange_along = np.concatenate([rng.uniform(*SPAN, 500), ends])
    alone, among = rim_of(out, along), rim_of(np.append(out, strange_out), np.append(along, strange_along))
    assert (among.middle_m, among.slope, among.noise_m) == (alone.middle_m, alone.slope, alone.noise_m)


@pytest.mark.parametrize("half", [(0.2, 0.7), (0.7, 1.2)])
def test_of_an_edge_of_which_half_was_seen_half_supports_it(half):
    edge = rim_of(*bars(4, slope=0.02, along=half))
    assert edge.support == pytest.approx(0.5, abs=0.06)
    # It is known best where it was seen.
    assert edge.along_m == pytest.approx(sum(half) / 2.0, abs=0.04)
    assert edge.at(edge.along_m) == pytest.approx(0.02 * (edge.along_m - 0.7), abs=0.002)


def test_a_few_strays_outside_do_not_move_the_edge():
    out, along = bars(5)
    edge = rim_of(np.append(out, [0.08, 0.09]), np.append(along, [0.5, 0.9]))
    assert edge.at(0.7) == pytest.approx(rim_of(out, along).at(0.7), abs=4e-4)
