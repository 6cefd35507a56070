"""Two stations of one file that do not lie over each other: laid onto each other where the order tells them apart."""

from dataclasses import replace

import numpy as np
import pytest

from stair_inspector.params import Params
from stair_inspector.pictures.coloring import residuals_of
from stair_inspector.pictures.display import choose_display
from stair_inspector.pipeline import inspect
from stair_inspector.simulate.scanner import scan as scan_building
from stair_inspector.simulate.scanner_specs import PROFILES
from stair_inspector.simulate.specs import Stair
from stair_inspector.simulate.staircase import build
from stair_inspector.stages.examine import examine
from stair_inspector.stages.stations import join_stations
from tests.synthetic import make_scan, rotation

STAIR = Stair(n_risers=6, rise_m=0.17, going_m=0.29, width_m=1.1, floor_front_m=2.0, upper_landing_m=1.4)
SIMULATED = scan_building(
    build(STAIR),
    replace(PROFILES["tls_good"], spacing_m=0.012, standoff_m=1.8, registration_m=0.0, tilt_deg=0.0, seed=4),
)
IS_SECOND = SIMULATED.station_ids == 1
N_FIRST = int(np.count_nonzero(~IS_SECOND))


def apart(shift_m, turn=None):
    """The scan with its second station moved."""
    points = SIMULATED.points.copy()
    moved = points[IS_SECOND] if turn is None else points[IS_SECOND] @ turn.T
    points[IS_SECOND] = moved + shift_m
    return points


def joined(points, stations="auto"):
    scan = make_scan(points)
    examined = examine(scan)
    return scan, examined, *join_stations(scan, examined, stations)


@pytest.mark.parametrize("shift_m", [(0.0, 0.0, 0.008), (0.0, 0.0, -0.012), (0.0, 0.0, 0.025)])
def test_the_second_station_is_laid_onto_the_first(shift_m):
    points = apart(shift_m)
    scan, examined, laid, now = joined(points)
    assert [each.code for each in examined.observations] == ["surfaces_doubled"]
    (said,) = now.observations
    assert (said.code, said.level) == ("stations_joined", "doubt")
    assert said.size_m == pytest.approx(abs(shift_m[2]), abs=2e-4)
    assert "--stations as_read" in said.cure
    moved = now.moved
    assert np.count_nonzero(moved.is_moved != IS_SECOND) == 0
    assert laid.points[~IS_SECOND] == pytest.approx(scan.points[~IS_SECOND], abs=0.0)
    # Only the height is held by treads and floor, and its u says how well.
    off_m = laid.points[IS_SECOND, 2] - SIMULATED.points[IS_SECOND, 2]
    assert np.abs(off_m).max() < 4e-4
    assert 0.0 < np.linalg.norm(now.layers_m, axis=1).max() < 4e-4
    assert np.linalg.norm(moved.unheld_m, axis=1) == pytest.approx([said.size_m] * 2)
    assert moved.places(scan.points, np.arange(len(points))) == pytest.approx(laid.points, abs=1e-12)


def test_a_station_that_leans_is_turned_back():
    laid = joined(apart((0.0, 0.0, 0.012), rotation("y", 0.03)))[2]
    # What the turn moves along the climb, nothing shows; heights come back everywhere.
    is_level = IS_SECOND & (SIMULATED.labels >= 0)
    off_m = laid.points[is_level, 2] - SIMULATED.points[is_level, 2]
    assert np.abs(off_m).max() < 6e-4


def test_a_file_with_one_station_in_two_parts():
    points = apart((0.0, 0.0, 0.012))
    half = N_FIRST // 2
    order = np.concatenate([np.arange(half), np.arange(N_FIRST, len(points)), np.arange(half, N_FIRST)])
    now = joined(points[order])[3]
    assert np.count_nonzero(now.moved.is_moved != IS_SECOND[order]) < 0.001 * len(points)


def test_the_smaller_station_moves():
    points = apart((0.0, 0.0, 0.012))
    order = np.concatenate([np.arange(N_FIRST, len(points)), np.arange(N_FIRST)])
    now = joined(points[order])[3]
    assert np.count_nonzero(now.moved.is_moved != IS_SECOND[order]) == 0


@pytest.mark.parametrize("how", ["shuffled", "as read", "sound"])
def test_where_nothing_tells_the_stations_nothing_moves(how):
    points = SIMULATED.points if how == "sound" else apart((0.0, 0.0, 0.012))
    if how == "shuffled":
        points = np.random.default_rng(3).permutation(points)
    scan, examined, laid, now = joined(points, "as_read" if how == "as read" else "auto")
    assert laid is scan
    assert now is examined
    assert [each.code for each in examined.observations] == ["surfaces_doubled"] * (how != "sound")


def test_the_undersides_that_one_station_saw_stay_where_they_are():
    # Treads of 20 mm, their upper faces seen by the first, their undersides by the second; both saw the floor.
    is_tread = (SIMULATED.labels > 0) & (SIMULATED.labels < 6)
    points = SIMULATED.points.copy()
    points[IS_SECOND & is_tread, 2] -= 0.02
    scan, examined, laid, now = joined(points)
    assert laid is scan
    assert now is examined


def test_rises_are_right_where_stations_were_apart_and_the_width_says_what_is_not_known():
    scan = make_scan(apart((0.0, 0.0, 0.012)))
    found = inspect(scan, Params())
    assert "stations_joined" in [each.code for each in found.examination]
    assert [step.rise_m.value for step in found.steps] == pytest.approx([0.17] * 6, abs=5e-4)
    assert max(step.rise_m.u for step in found.steps) < 0.0015
    assert [step.going_m.value for step in found.steps[:-1]] == pytest.approx([0.29] * 5, abs=1e-3)
    widths = [step.width_m for step in found.steps[:-1]]
    assert [dict(width.parts)["layers"] for width in widths] == pytest.approx(
        [2.0 * 0.012 / np.sqrt(12.0)] * 5, rel=0.1
    )
    assert [width.value for width in widths] == pytest.approx([1.1] * 5, abs=max(width.u for width in widths))
    # Colours show the points where they were measured.
    display = choose_display(scan, 50_000)
    residuals = residuals_of(found, display)
    assert np.nanpercentile(np.abs(residuals), 99.0) < 0.006
    as_read = inspect(scan, Params(stations="as_read"))
    assert max(step.rise_m.u for step in as_read.steps if step.rise_m) > 0.01


def test_the_papers_method_measures_the_file_as_it_is():
    scan = make_scan(apart((0.0, 0.0, 0.012)))
    paper, as_read = (inspect(scan, Params(method="paper", stations=how)) for how in ("auto", "as_read"))
    assert [each.code for each in paper.examination] == ["surfaces_doubled"]
    assert [step.paper for step in paper.steps] == [step.paper for step in as_read.steps]
