"""Cells of flat surfaces, the directions they face, and their halves where they are double."""

from dataclasses import replace

import numpy as np
import pytest

from stair_inspector.model import ScanStations
from stair_inspector.stages.layers import Cells, find_doubled, find_ways, sight_of
from tests.stages.test_layers import EXACT
from tests.synthetic import rotation


def sheet(height_m, n, seed=0, low=(0.0, 0.0), high=(1.5, 1.5)):
    """Points anywhere on a level sheet, with 1 mm of noise."""
    rng = np.random.default_rng(seed)
    return np.column_stack([rng.uniform(low, high, (n, 2)), rng.normal(height_m, 0.001, n)])


def halves_of(points, normal=(0.0, 0.0, 1.0)):
    cells = Cells(points)
    return cells.split(np.array(normal), np.arange(len(cells.counts)))


@pytest.mark.parametrize("turn", [np.eye(3), rotation("x", 35.0) @ rotation("z", 20.0)])
@pytest.mark.parametrize("share", [0.25, 0.5, 0.8])
def test_the_halves_of_two_layers_are_the_layers_and_their_middle_lies_between_them(turn, share):
    n_low = round(40_000 * share)
    points = np.concatenate([sheet(5.0, n_low, 1), sheet(5.02, 40_000 - n_low, 2)])
    split = halves_of(points @ turn.T, turn[:, 2])
    # Cells that the turned sheets cut at a corner show one of them, or too few points.
    assert np.mean(split.is_double) > 0.7
    assert np.median(split.apart_m[split.is_double]) == pytest.approx(0.02, abs=3e-4)
    assert np.median(split.offset_m[split.is_double]) == pytest.approx(5.01, abs=3e-4)


def test_the_halves_of_one_layer_are_none_and_its_middle_is_its_own():
    for points in (sheet(-3.0, 40_000, 1), np.concatenate([sheet(-3.0, 38_000, 1), sheet(-2.98, 2_000, 2)])):
        split = halves_of(points)
        # Chance makes one or two cells of a hundred look so.
        assert split.is_double.mean() < 0.03
        np.testing.assert_allclose(split.offset_m[~split.is_double], -3.0, atol=5e-4)


def test_layers_beside_each_other_are_not_over_each_other():
    stripes = [sheet(0.0, 4_000, k, (0.15 * k, 0.0), (0.15 * k + 0.075, 1.5)) for k in range(10)]
    others = [sheet(0.02, 4_000, 20 + k, (0.15 * k + 0.075, 0.0), (0.15 * k + 0.15, 1.5)) for k in range(10)]
    assert not halves_of(np.concatenate([*stripes, *others])).is_double.any()


def test_a_cell_has_what_was_seen_from_the_side_from_which_most_of_it_was():
    above, below = sheet(0.0, 30_000, 1), sheet(-0.02, 15_000, 2)
    points = np.concatenate([above, below])
    stations = ScanStations(
        ("A", "B"),
        np.repeat(np.array([0, 1], dtype=np.int16), (30_000, 15_000)),
        np.array([[0.7, 0.7, 2], [0.7, 0.7, -2]]),
    )
    assert np.median(halves_of(points).apart_m) == pytest.approx(0.02, abs=1e-3)
    cells = Cells(points, 0.0, sight_of(points, stations, 1))
    assert (cells.rows < 30_000).all()
    assert len(cells.rows) == cells.counts.sum() == 30_000
    np.testing.assert_array_equal(cells.points, points[cells.rows])
    np.testing.assert_allclose(cells.middles()[:, 2], 0.0, atol=1e-3)
    # Of whom no one knows where he stood, everything is kept.
    unknown = replace(stations, places_m=np.array([[np.nan] * 3, [0.7, 0.7, -2]]))
    assert len(Cells(points, 0.0, sight_of(points, unknown, 1)).rows) == 45_000
    assert sight_of(points, None, 1) is None
    np.testing.assert_allclose(sight_of(points, stations, 7)[1], [0.7, 0.7, 2.0] - points[7])


def test_the_directions_that_most_cells_face_come_first_each_with_its_cells():
    floor = sheet(0.0, 40_000, 1)
    wall = sheet(0.0, 20_000, 2, high=(1.5, 0.6))[:, [2, 0, 1]] + [2.0, 0.0, 0.3]
    cells = Cells(np.concatenate([floor, wall]))
    (first, on_floor), (second, on_wall) = cells.ways()
    assert abs(first[2]) > 0.9999
    assert abs(second[0]) > 0.9999
    middles = cells.middles()
    np.testing.assert_allclose(middles[on_floor, 2], 0.0, atol=0.01)
    np.testing.assert_allclose(middles[on_wall, 0], 2.0, atol=0.01)
    assert len(on_floor) + len(on_wall) == len(cells.counts)


def test_what_is_double_on_few_cells_is_a_hint_and_no_more():
    # A sheet of 6 by 1.5 m, a tenth of it twice.
    whole = sheet(0.0, 80_000, 1, high=(6.0, 1.5))
    points = np.concatenate([whole, sheet(0.008, 8_000, 2, high=(0.6, 1.5))])
    assert find_ways(whole, EXACT) == ()
    assert find_doubled(points, EXACT) == ()
    (hint,) = find_ways(points, EXACT)
    assert not hint.is_sure
    assert hint.apart_m == pytest.approx(0.008, abs=5e-4)
    assert hint.share == pytest.approx(0.1, abs=0.03)
    (sure,) = find_ways(np.concatenate([whole, sheet(0.008, 60_000, 3, high=(6.0, 1.5))]), EXACT)
    assert sure.is_sure
    assert sure.share > 0.9
