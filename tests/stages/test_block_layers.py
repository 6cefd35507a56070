"""Stations that lie apart unseen, and a tread that changed between two scans, are told by blocks that scatter more."""

from dataclasses import replace

import numpy as np
import pytest

from stair_inspector.geometry.block_scatter import BlockScatter
from stair_inspector.model import NO_CHAINS, Examination
from stair_inspector.params import Params
from stair_inspector.pipeline import inspect
from stair_inspector.stages.block_layers import tell_layers
from tests.stages.stated_shapes import shape
from tests.synthetic import Stair, make_scan

STAIR = Stair(n_steps=5, width=1.1, risers=True, spacing=0.011, noise=0.001, floor_depth=0.8, seed=4)
EXAMINED = Examination((), np.zeros(3))
ONE, TWO = BlockScatter(0.003, 0.0035, 0.0), BlockScatter(0.002, 0.0065, -1.2)
UNLIKE, CLUTTERED = replace(TWO, excess=0.2), replace(TWO, excess=3.0)


def told(scatters, examined=EXAMINED, registration_m=0.0001):
    shapes = tuple(shape(k, scatter=scatter) for k, scatter in enumerate(scatters))
    return tell_layers((shapes,), NO_CHAINS, examined, np.eye(3), registration_m)


def test_a_flight_of_which_treads_show_two_layers_is_double():
    found = told([ONE, TWO, TWO, UNLIKE, ONE])
    (observation,) = found.observations
    assert (observation.code, observation.level) == ("surfaces_doubled", "doubt")
    assert observation.size_m == pytest.approx(TWO.apart_m) == pytest.approx(0.0124, abs=1e-4)
    assert [each.plane.layers_m > 0.0 for each in found.shapes[0]] == [False, True, True, False, False]
    assert found.examined.layers_m == pytest.approx(np.array([[0.0, 0.0, TWO.apart_m]]))
    assert not found.chains.notes


@pytest.mark.parametrize(("one", "k"), [(TWO, 2), (UNLIKE, 0), (TWO, 3)])
def test_a_tread_that_alone_scatters_more_is_named_and_holds_both_levels(one, k):
    scatters = [ONE] * 5
    scatters[k] = one
    found = told(scatters)
    (note,) = found.chains.notes
    assert (note.code, note.step) == ("two_levels", k + 1)
    assert [each.plane.cover_m > TWO.apart_m for each in found.shapes[0]] == [number == k for number in range(5)]
    assert not found.observations
    assert not len(found.examined.layers_m)


@pytest.mark.parametrize(
    "scatters",
    [
        [ONE] * 5,
        [UNLIKE] * 5,
        [ONE, CLUTTERED, ONE, ONE, ONE],
        # As of noise that neighbouring points have in common.
        [replace(TWO, excess=-0.75)] * 5,
        # A landing is no tread, and nothing is known beside it.
        [ONE, ONE, ONE, ONE, TWO],
        [None, TWO, None, None, None],
        [replace(ONE, low_m=0.0001, high_m=0.0009)] * 2 + [ONE],
    ],
)
def test_what_is_alike_on_all_treads_or_stands_on_one_is_no_layer(scatters):
    found = told(scatters)
    assert not found.observations
    assert not found.chains.notes
    assert all(not each.plane.layers_m + each.plane.cover_m for each in found.shapes[0])


def test_nothing_is_told_twice_nor_of_a_cameras_frame():
    for examined in (replace(EXAMINED, layers_m=np.array([[0.0, 0.0, 0.006]])), replace(EXAMINED, is_view=True)):
        assert told([ONE, TWO, TWO, TWO, ONE], examined).examined is examined


@pytest.mark.parametrize("scatters", [[ONE, TWO, TWO, TWO, ONE], [ONE, ONE, TWO, ONE, ONE]])
def test_passes_as_far_apart_as_is_stated_of_the_scanner_are_no_news(scatters):
    found = told(scatters, registration_m=0.004)
    assert not found.observations
    assert not found.chains.notes


def test_a_tread_that_changed_between_two_scans_has_both_heights_within_u():
    points, _ = STAIR.sample()
    rng = np.random.default_rng(8)
    is_second = (points[:, 1] > 0.7) & (rng.uniform(size=len(points)) < 0.6)
    points[is_second & (np.abs(points[:, 2] - 3 * STAIR.rise) < 0.01), 2] += 0.008
    found = inspect(make_scan(points), Params(up="z", unit="m"))
    assert [note.step for note in found.notes if note.code == "two_levels"] == [3]
    tread, above = found.steps[2:4]
    for rise, shift in ((tread.rise_m, 0.008), (above.rise_m, -0.008)):
        assert abs(rise.value - STAIR.rise) <= rise.u
        assert abs(rise.value - STAIR.rise - shift) <= rise.u
    assert found.steps[1].rise_m.u < 0.002


def test_an_even_scan_says_nothing():
    found = inspect(make_scan(STAIR.sample()[0]), Params(up="z", unit="m"))
    assert not found.examination
    assert "two_levels" not in [note.code for note in found.notes]
