"""Two stations of one file that do not lie over each other: laid onto each other where the order tells them apart."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from stair_inspector.content.segmented_points import residuals_at
from stair_inspector.memo import Memo
from stair_inspector.model import Up
from stair_inspector.params import Params
from stair_inspector.pictures.display import choose_display
from stair_inspector.pipeline import inspect
from stair_inspector.simulation.scanner import scan as scan_building
from stair_inspector.simulation.scanner_specs import PROFILES
from stair_inspector.simulation.specs import Stair
from stair_inspector.simulation.staircase import build
from stair_inspector.stages.examine import examine, with_questions
from stair_inspector.stages.parts import Common
from stair_inspector.stages.stations import join_stations
from stair_inspector.stated_uncertainty import UncertaintyParams
from stair_inspector.viewer.scene.picking import pick_of
from tests.stages.test_order_shifts import level_points
from tests.synthetic import make_scan, rotation

STAIR = Stair(n_risers=6, rise_m=0.17, going_m=0.29, width_m=1.1, floor_front_m=2.0, upper_landing_m=1.4)
SCANNER = replace(
    PROFILES["tls_good"],
    azimuth_step_deg=0.12,
    elevation_step_deg=0.12,
    spacing_m=0.012,
    standoff_m=1.8,
    registration_m=0.0,
    tilt_deg=0.0,
    seed=4,
)
SHIFT_M = (0.0, 0.0, 0.012)


@cache
def simulated():
    """The scan as it should be, and which of its points the second station saw; made once, and only read."""
    scanned = scan_building(build(STAIR), SCANNER)
    return scanned, scanned.station_ids == 1


def apart(shift_m=SHIFT_M, turn=None):
    """The points with those of the second station moved."""
    scanned, is_second = simulated()
    points = scanned.points.copy()
    moved = points[is_second] if turn is None else points[is_second] @ turn.T
    points[is_second] = moved + shift_m
    return points


@cache
def measured():
    """The scan with its second station moved, and the memo of its inspections: its normals are made once."""
    return make_scan(apart()), Memo()


def joined(points, stations="auto"):
    scan = make_scan(points)
    examined = examine(scan)
    return scan, examined, *join_stations(scan, examined, stations)


@pytest.mark.parametrize("shift_m", [(0.0, 0.0, 0.008), (0.0, 0.0, -0.012), (0.0, 0.0, 0.018)])
def test_the_second_station_is_laid_onto_the_first(shift_m):
    scanned, is_second = simulated()
    points = apart(shift_m)
    scan, examined, laid, now = joined(points)
    assert [each.code for each in examined.observations] == ["surfaces_doubled"]
    (said,) = now.observations
    assert (said.code, said.level) == ("stations_joined", "doubt")
    assert said.size_m == pytest.approx(abs(shift_m[2]), abs=2e-4)
    assert "--stations as_read" in said.cure
    moved = now.moved
    assert np.count_nonzero(moved.is_moved != is_second) == 0
    np.testing.assert_array_equal(laid.points[~is_second], scan.points[~is_second])
    # Only the height is held by treads and floor, and its u says how well.
    off_m = laid.points[is_second, 2] - scanned.points[is_second, 2]
    assert np.abs(off_m).max() < 4e-4
    assert 0.0 < np.linalg.norm(now.layers_m, axis=1).max() < 4e-4
    assert np.linalg.norm(moved.unheld_m, axis=1) == pytest.approx([max(said.size_m, 0.012)] * 2)
    assert "no surface shows how they lie, and they were not moved: U of the widths holds " in said.message
    np.testing.assert_allclose(moved.places(scan.points, np.arange(len(points))), laid.points, rtol=0.0, atol=1e-12)


def test_a_station_that_leans_is_turned_back():
    scanned, is_second = simulated()
    laid = joined(apart(turn=rotation("y", 0.03)))[2]
    # What the turn moves along the climb, nothing shows; heights come back everywhere.
    is_level = is_second & (scanned.labels >= 0)
    off_m = laid.points[is_level, 2] - scanned.points[is_level, 2]
    assert np.abs(off_m).max() < 6e-4


def test_a_file_with_one_station_in_two_parts():
    points, is_second = apart(), simulated()[1]
    n_first = np.count_nonzero(~is_second)
    half = n_first // 2
    order = np.concatenate([np.arange(half), np.arange(n_first, len(points)), np.arange(half, n_first)])
    now = joined(points[order])[3]
    assert np.count_nonzero(now.moved.is_moved != is_second[order]) < 0.001 * len(points)


def test_the_smaller_station_moves():
    points, is_second = apart(), simulated()[1]
    n_first = np.count_nonzero(~is_second)
    order = np.concatenate([np.arange(n_first, len(points)), np.arange(n_first)])
    now = joined(points[order])[3]
    assert np.count_nonzero(now.moved.is_moved != is_second[order]) == 0


@pytest.mark.parametrize("how", ["shuffled", "as read", "sound"])
def test_where_nothing_tells_the_stations_nothing_moves(how):
    points = simulated()[0].points if how == "sound" else apart()
    if how == "shuffled":
        points = np.random.default_rng(3).permutation(points)
    scan, examined, laid, now = joined(points, "as_read" if how == "as read" else "auto")
    assert laid is scan
    assert now is examined
    assert [each.code for each in examined.observations] == ["surfaces_doubled"] * (how != "sound")


def test_stations_not_as_far_apart_as_the_edge_of_a_tread_is_thick_are_laid():
    (said,) = joined(level_points((0.0, 0.0232), 0.002))[3].observations
    assert said.code == "stations_joined"
    assert said.size_m == pytest.approx(0.0232, abs=1e-4)


def test_stations_as_far_apart_as_the_edge_of_a_tread_is_thick_stay():
    scan, examined, laid, now = joined(apart((0.0, 0.0, 0.03)))
    assert [each.code for each in examined.observations] == ["surfaces_doubled"]
    assert laid is scan
    assert now is examined


def test_the_undersides_that_one_station_saw_stay_where_they_are():
    # Treads of 20 mm, their upper faces seen by the first, their undersides by the second; both saw the floor.
    scanned, is_second = simulated()
    is_tread = (scanned.labels > 0) & (scanned.labels < 6)
    points = scanned.points.copy()
    points[is_second & is_tread, 2] -= 0.02
    scan, examined, laid, now = joined(points)
    assert laid is scan
    assert now is examined


@pytest.mark.slow
def test_rises_are_right_where_stations_were_apart_and_the_width_says_what_is_not_known():
    scan, memo = measured()
    found = inspect(scan, Params(), memo)
    assert "stations_joined" in [each.code for each in found.examination]
    assert [step.rise_m.value for step in found.steps] == pytest.approx([0.17] * 6, abs=5e-4)
    assert max(step.rise_m.u for step in found.steps) < 0.0015
    assert [step.going_m.value for step in found.steps[:-1]] == pytest.approx([0.29] * 5, abs=1e-3)
    widths = [step.width_m for step in found.steps[:-1]]
    assert [dict(width.parts)["layers"] for width in widths] == pytest.approx([0.012] * 5, rel=0.1)
    assert [width.value for width in widths] == pytest.approx([1.1] * 5, abs=max(width.u for width in widths))
    # Colours show the points where they were measured.
    display = choose_display(scan, 50_000)
    residuals = residuals_at(found, display.points, display.point_ids)
    assert np.nanpercentile(np.abs(residuals), 99.0) < 0.006
    as_read = inspect(scan, Params(stations="as_read"), memo)
    assert max(step.rise_m.u for step in as_read.steps if step.rise_m) > 0.01


def test_the_papers_method_measures_the_file_as_it_is():
    scan, memo = measured()
    paper, as_read = (inspect(scan, Params(method="paper", stations=how), memo) for how in ("auto", "as_read"))
    assert [each.code for each in paper.examination] == ["surfaces_doubled"]
    assert [step.paper for step in paper.steps] == [step.paper for step in as_read.steps]


def test_sheets_whose_undersides_the_second_station_saw_are_no_stations_apart():
    # Most cells show the sheets; the floor, which is small, shows that nothing has moved.
    scanned, is_second = simulated()
    is_near = scanned.points[:, 0] > -0.45
    points = scanned.points[is_near]
    points[(is_second & (scanned.labels > 0))[is_near], 2] -= 0.007
    scan, examined, laid, now = joined(points)
    assert laid is scan
    assert now is examined


def test_a_pane_that_both_sides_were_seen_of_moves_nothing_sideways():
    scanned, is_second = simulated()
    rng = np.random.default_rng(1)
    parts = []
    for k, is_own in enumerate((~is_second, is_second)):
        x, up, noise = rng.uniform(0.0, 1.6, 6000), rng.uniform(0.0, 1.0, 6000), rng.normal(0.0, 5e-4, 6000)
        face = np.column_stack([x, 0.75 + 0.008 * k + noise, up + 0.17 / 0.29 * x])
        parts.append(rng.permutation(np.vstack([scanned.points[is_own], face])))
    scan, examined, laid = joined(np.vstack(parts))[:3]
    assert [each.code for each in examined.observations] == ["surfaces_doubled"]
    assert laid is scan


def test_what_would_still_be_double_afterwards_stays():
    # The path of the second station bends: no one motion lays all of it onto the first.
    scanned, is_second = simulated()
    points = scanned.points.copy()
    points[is_second, 2] += np.where(scanned.labels[is_second] > 3, 0.026, 0.012)
    scan, examined, laid, now = joined(points)
    assert examined.observations
    assert laid is scan
    assert now is examined


def test_stations_apart_are_laid_where_rounding_fills_the_gap():
    is_second = simulated()[1]
    scan, examined, laid, now = joined(np.round(apart() / 0.005) * 0.005)
    assert [each.code for each in examined.observations] == ["coordinates_rounded"]
    assert [each.code for each in now.observations] == ["coordinates_rounded", "stations_joined"]
    assert np.count_nonzero(now.moved.is_moved != is_second) < 0.01 * len(is_second)
    off_m = (laid.points - scan.points)[is_second, 2]
    assert np.median(off_m) == pytest.approx(-0.012, abs=0.001)
    left, as_read = join_stations(scan, examined, "as_read")
    assert left is scan
    assert [each.code for each in as_read.observations] == ["coordinates_rounded", "doubled_by_order"]


def test_a_shift_of_three_steps_and_a_little_is_still_one_that_rounding_hides():
    # A wall that both saw shows how little noise there is.
    rng = np.random.default_rng(1)
    parts = []
    for seen in np.split(level_points((0.0, 0.0125), 0.001), 2):
        along, up = rng.uniform(0.0, 1.5, (2, len(seen)))
        parts += [seen, np.column_stack([along, 1.6 + rng.normal(0.0, 0.001, len(seen)), up])]
    examined, _, now = joined(np.round(np.vstack(parts) / 0.004) * 0.004)[1:]
    assert [each.code for each in examined.observations] == ["coordinates_rounded"]
    assert [each.code for each in now.observations] == ["coordinates_rounded", "doubled_by_order"]


def test_where_noise_fills_the_gap_and_too_few_points_tell_where_a_station_begins_u_holds_it():
    noise_m = np.random.default_rng(5).normal(0.0, 0.005, apart().shape)
    scan, examined, laid, now = joined(apart() + noise_m)
    assert examined.observations == ()
    assert laid is scan
    (said,) = now.observations
    assert (said.code, said.level) == ("doubled_by_order", "doubt")
    assert said.size_m == pytest.approx(0.012, abs=0.001)
    assert np.abs(now.layers_m) == pytest.approx(np.array([[0.0, 0.0, 0.012]]), abs=0.001)


@pytest.mark.slow
def test_stations_that_have_little_in_common_are_told_by_the_order_of_the_points():
    # Too few cells are double to tell it by themselves; a shuffled file says nothing.
    scanner = replace(PROFILES["tls_good"], spacing_m=0.006, standoff_m=1.8, registration_m=0.0, tilt_deg=0.0, seed=4)
    scanned = scan_building(build(replace(STAIR, n_risers=10)), scanner)
    points = scanned.points + np.where(scanned.station_ids == 1, 0.02, 0.0)[:, None] * [0.0, 0.0, 1.0]
    scan, examined, laid, now = joined(points)
    assert examined.observations == ()
    assert np.linalg.norm(examined.hints_m, axis=1) == pytest.approx([0.02], abs=1e-3)
    assert [each.code for each in now.observations] == ["stations_joined"]
    off_m = (laid.points - scanned.points)[scanned.station_ids == 1, 2]
    assert np.abs(off_m).max() < 5e-4
    assert joined(np.random.default_rng(2).permutation(points))[3].observations == ()
    assert laid is not scan


def test_given_normals_turn_with_their_station():
    is_second = simulated()[1]
    turn = rotation("y", 0.03)
    points = apart(SHIFT_M, turn)
    up = np.where(is_second[:, None], turn[:, 2], [0.0, 0.0, 1.0])
    scan = make_scan(points, normals=up)
    laid, now = join_stations(scan, examine(scan), "auto")
    assert now.moved is not None
    assert laid.normals == pytest.approx(np.tile([0.0, 0.0, 1.0], (len(points), 1)), abs=1e-4)
    assert np.linalg.norm(scan.normals - laid.normals, axis=1).max() > 4e-4


@pytest.mark.slow
def test_a_place_that_is_picked_lies_where_it_was_measured():
    scan, memo = measured()
    found = inspect(scan, Params(), memo)
    display = choose_display(scan, 10**6)
    _, is_second = simulated()
    for step in found.steps:
        own = found.labels[display.point_ids] == step.step_id
        heights = [
            np.median([pick_of(found, display, int(row)).place_m[2] for row in np.flatnonzero(own & of)[:40]])
            for of in (is_second[display.point_ids], ~is_second[display.point_ids])
        ]
        assert heights[0] == pytest.approx(heights[1], abs=0.002)


def test_a_station_that_leans_as_levelling_leaves_it_is_left_to_the_uncertainty_of_levelling():
    # Noise hides the layers, and every plane is off by another distance.
    turn = rotation("y", 0.12)
    noise_m = np.random.default_rng(5).normal(0.0, 0.003, apart().shape)
    scan, examined, laid, now = joined(apart((0.0, 0.0, 0.0), turn) + noise_m)
    assert laid is scan
    assert now is examined


def test_what_the_presets_registration_states_is_not_said_again():
    noise_m = np.random.default_rng(5).normal(0.0, 0.005, apart().shape)
    now = joined(apart() + noise_m)[3]
    assert now.is_by_order
    said = {
        stated_m: with_questions(now.observations, UncertaintyParams(registration_m=stated_m))
        for stated_m in (0.0, 0.001, 0.004)
    }
    assert [[each.code for each in found] for found in said.values()] == [
        ["doubled_by_order"],
        ["doubled_by_order"],
        [],
    ]
    layers = [
        len(
            Common.of(
                Up(np.array([0.0, 0.0, 1.0]), "given", None), UncertaintyParams(registration_m=stated_m), np.eye(3), now
            ).layers_m
        )
        for stated_m in said
    ]
    assert layers == [1, 1, 0]


def test_the_path_of_a_scanner_that_is_carried_is_no_two_stations():
    # Three places are drift; what the means say of it is left to the preset.
    scan = make_scan(level_points((0.0, 0.01, 0.02)))
    examined = examine(scan)
    assert join_stations(scan, examined, "auto") == (scan, examined)
