"""What is made of a file that says which station saw each point, and where it stood."""

import functools
from dataclasses import replace

import numpy as np
import pytest

from stair_inspector.memo import Memo
from stair_inspector.model import ScanStations
from stair_inspector.params import NormalsParams, Params
from stair_inspector.pipeline import inspect
from stair_inspector.stages.examine import examine
from stair_inspector.stages.layers import find_doubled
from stair_inspector.stages.orient import find_normals
from stair_inspector.stages.stations import join_stations
from tests.stages.test_layers import EXACT, station
from tests.stages.test_stations import apart, simulated
from tests.synthetic import Stair, make_scan

ORDER = np.random.default_rng(3).permutation(len(simulated()[0].points))
NOWHERE = np.full((2, 3), np.nan)


def known(points, of_point, places_m=None):
    """A scan of stations A, B, ... whose points are in no order."""
    k = int(of_point.max()) + 1
    places_m = np.full((k, 3), np.nan) if places_m is None else places_m
    return replace(
        make_scan(points), stations=ScanStations(tuple("ABC"[:k]), np.asarray(of_point, dtype=np.int16), places_m)
    )


def places():
    """Where the two stations of the simulated scan stood."""
    return np.array([each.position for each in simulated()[0].stations])


@pytest.mark.parametrize("with_places", [True, False])
def test_stations_in_no_order_are_laid_onto_each_other(with_places):
    scanned, is_second = simulated()
    scan = known(apart()[ORDER], is_second[ORDER], places() if with_places else NOWHERE)
    examined = examine(scan)
    assert [each.code for each in examined.observations] == ["surfaces_doubled"]
    laid, now = join_stations(scan, examined, "auto")
    assert np.array_equal(now.moved.is_moved, is_second[ORDER])
    off_m = (laid.points - scanned.points[ORDER])[now.moved.is_moved, 2]
    assert np.abs(off_m).max() < 4e-4
    (said,) = now.observations
    assert said.message.startswith("surfaces were double: station 'B' lies 12 mm apart from the others; ")
    assert np.array_equal(laid.stations.of_point, scan.stations.of_point)
    if with_places:
        # The scanner moves with what it saw.
        assert laid.stations.places_m[0] == pytest.approx(places()[0])
        assert laid.stations.places_m[1] - places()[1] == pytest.approx([0.0, 0.0, -0.012], abs=1e-3)
    assert join_stations(scan, examined, "as_read")[0] is scan
    assert join_stations(scan, examined, "auto", "paper")[0] is scan


def test_of_three_stations_the_one_that_lies_apart_moves():
    scanned, is_second = simulated()
    # The first station's points as two stations that lie over each other.
    of_point = np.where(is_second, 1, 2 * (np.arange(len(is_second)) % 2))
    scan = known(apart()[ORDER], of_point[ORDER])
    laid, now = join_stations(scan, examine(scan), "auto")
    assert np.array_equal(now.moved.is_moved, is_second[ORDER])
    assert np.abs((laid.points - scanned.points[ORDER])[now.moved.is_moved, 2]).max() < 4e-4


@pytest.mark.slow
def test_of_three_stations_two_that_lie_apart_in_their_own_ways_move():
    scanned, is_second = simulated()
    of_point = np.where(is_second, 1, 2 * (np.arange(len(is_second)) % 5 == 0))
    points = scanned.points + np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.012], [0.0, 0.0, -0.009]])[of_point]
    scan = known(points[ORDER], of_point[ORDER])
    laid, now = join_stations(scan, examine(scan), "auto")
    assert np.array_equal(now.moved.is_moved, of_point[ORDER] > 0)
    assert np.abs((laid.points - scanned.points[ORDER])[:, 2]).max() < 5e-4
    (said,) = now.observations
    assert said.message.startswith("surfaces were double: stations 'B', 'C' lie up to 12 mm apart from the others; ")
    rows = np.arange(len(points))
    np.testing.assert_allclose(now.moved.places(scan.points, rows), laid.points, rtol=0.0, atol=1e-12)
    # A station that is too far off is not laid, and then none is.
    points[of_point == 1, 2] += 0.03
    scan = known(points[ORDER], of_point[ORDER])
    assert join_stations(scan, examine(scan), "auto")[0] is scan


def test_stations_whose_layers_noise_hides_are_laid_onto_each_other():
    scanned, is_second = simulated()
    noise = np.random.default_rng(8).normal(0.0, 0.004, scanned.points.shape)
    scan = known((apart((0.0, 0.0, 0.008)) + noise)[ORDER], is_second[ORDER], places())
    examined = examine(scan)
    assert not len(examined.layers_m) + len(examined.hints_m)
    laid, now = join_stations(scan, examined, "auto")
    assert np.array_equal(now.moved.is_moved, is_second[ORDER])
    assert np.median((laid.points - scan.points)[now.moved.is_moved, 2]) == pytest.approx(-0.008, abs=5e-4)
    sound = known((scanned.points + noise)[ORDER], is_second[ORDER], places())
    assert join_stations(sound, examine(sound), "auto")[0] is sound


def test_stations_that_lie_over_each_other_stay():
    scanned, is_second = simulated()
    scan = known(scanned.points, is_second, places())
    examined = examine(scan)
    assert not examined.observations
    same, now = join_stations(scan, examined, "auto")
    assert same is scan
    assert (now.observations, now.moved) == ((), None)


@pytest.mark.slow
def test_two_faces_of_slabs_that_were_seen_from_opposite_sides_are_no_surface_twice():
    rng = np.random.default_rng(5)
    floor = station(0.001)
    slab = np.column_stack([rng.uniform(-1.5, 1.5, (40_000, 2)), np.zeros(40_000)])
    slabs = [slab + np.array([0.0, 0.0, height]) for height in (1.0, 1.5, 2.0, 2.5)]
    upper = np.concatenate([floor, *slabs])
    lower = np.concatenate(slabs) - (0.0, 0.0, 0.02) + rng.normal(0.0, 0.001, (160_000, 3)) * (0.0, 0.0, 1.0)
    points = np.concatenate([upper, lower])
    of_point = np.repeat([0, 1], [len(upper), len(lower)])
    assert len(find_doubled(points, EXACT)) == 1
    above_and_below = np.array([[0.1, 0.2, 9.0], [0.2, 0.1, -9.0]])
    assert find_doubled(points, EXACT, known(points, of_point, above_and_below).stations) == ()
    # Seen from one side, or from nobody knows where, they are.
    for seen_from in (np.abs(above_and_below), NOWHERE):
        assert len(find_doubled(points, EXACT, known(points, of_point, seen_from).stations)) == 1


def test_estimated_normals_point_to_the_station_that_saw_the_point():
    points, exact = Stair(risers=True, noise=0.001).sample()
    of_point = (np.arange(len(points)) % 3 == 0).astype(np.int16)
    places_m = np.array([[-2.0, 0.5, 2.5], [1.0, 0.3, -4.0]])
    free = find_normals(make_scan(points), NormalsParams()).vectors
    found = find_normals(known(points, of_point, places_m), NormalsParams()).vectors
    assert np.array_equal(np.abs(found), np.abs(free))
    assert ((found * (places_m[of_point] - points)).sum(axis=1) >= 0.0).all()
    is_level = exact[:, 2] > 0.9
    assert np.array_equal(np.sign(found[is_level, 2]), np.where(of_point[is_level] == 0, 1.0, -1.0))
    assert np.array_equal(find_normals(known(points, of_point, NOWHERE), NormalsParams()).vectors, free)


@functools.cache
def over_each_other():
    """The simulated scan as a plain cloud and with its stations, each with the memo of its inspections."""
    scanned, is_second = simulated()
    return tuple((scan, Memo()) for scan in (make_scan(scanned.points), known(scanned.points, is_second, places())))


def of_nosings(step):
    """The values that hang on where nosings and risers are."""
    return step.rise_m, step.going_m, step.tread_depth_m


@pytest.mark.parametrize("method", ["paper", "survey"])
def test_the_values_are_those_of_the_plain_cloud_where_stations_lie_over_each_other(method):
    plain, told = (inspect(scan, Params(method=method), memo) for scan, memo in over_each_other())
    assert len(plain.steps) > 4
    for mine, other in zip(told.steps, plain.steps, strict=True):
        assert mine.paper == other.paper
        for one, without in zip(of_nosings(mine), of_nosings(other), strict=True):
            # Of a scan whose stations are known, u holds the noise that the faces show.
            assert (one is None) == (without is None)
            assert one is None or (one.value == without.value and without.u <= one.u < 1.2 * without.u)
        assert mine.width_m == other.width_m


@pytest.mark.slow
def test_a_large_scan_with_stations_is_thinned_too():
    points, _ = Stair(n_steps=3, spacing=0.0032, noise=0.001).sample()
    assert len(points) > 150_000
    scan = known(points, (np.arange(len(points)) % 2).astype(np.int16))
    assert len(inspect(scan, Params()).steps) == 3
