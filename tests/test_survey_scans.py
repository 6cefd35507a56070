"""The survey on scans of known stairs: truth, invariance, uncertainty, overrules, scenes without stairs, captures.

The scans are coarse, 9 mm between points where the benchmark has 3 to 5, so that they take a fraction of a second.
"""

import dataclasses
import json
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from stair_inspector.content.records import inspection_to_dict
from stair_inspector.errors import ConfigError
from stair_inspector.files.scans import read_scan
from stair_inspector.files.settings import find_preset
from stair_inspector.memo import Memo
from stair_inspector.params import Params
from stair_inspector.pipeline import inspect
from stair_inspector.quantities import SURVEY_VALUES
from stair_inspector.simulation.scanner import scan as scan_building
from stair_inspector.simulation.scanner_specs import PROFILES
from stair_inspector.simulation.scenes import SCENES
from stair_inspector.simulation.staircase import build
from tests.benchmarks import accuracy
from tests.benchmarks.accuracy import CASES, EVEN, QUANTITIES, found_values, match, true_values
from tests.synthetic import Stair, exact_params, make_scan, motion, rotation

REAL = Path(__file__).parents[1].parent / "shared" / "scans"
COARSE = replace(
    PROFILES["tls_good"], azimuth_step_deg=0.25, elevation_step_deg=0.25, spacing_m=0.009, registration_m=0, tilt_deg=0
)
PARAMS = replace(find_preset("tls").params, unit="m", up="z")
WITHIN_U = 2.5
"""An error of 2.5 u is one of 5 standard uncertainties."""
MOST = {"rise": 0.6, "going": 1.2, "depth": 1.2, "overhang": 1.2, "pitch": 0.15, "fall": 0.5, "cross_fall": 0.1}
"""Largest error where the edges were seen, millimetres and degrees: so that no u excuses everything."""
NOSED = Stair(n_steps=5, spacing=0.01, risers=True, noise=0.001, seed=3, floor_depth=1.6)
"""A stair whose points are drawn from its surfaces, so that a turned or scaled copy has the same points exactly."""

simulate = cache(accuracy.simulate)
"""Each scan is made once."""


@cache
def nosed():
    """The scan of the nosed stair and the memo of its runs: what does not hang on a changed setting is made once."""
    return NOSED.scan(), Memo()


def inspect_nosed(params):
    scan, memo = nosed()
    return inspect(scan, params, memo)


@cache
def scanned(name, stations=None):
    """The scan of one case of the benchmark, its building and the memo of its runs."""
    simulated, building = simulate(CASES[name], COARSE if stations is None else replace(COARSE, stations=stations), 1)
    origin = np.round(simulated.points.min(axis=0))
    return make_scan(simulated.points - origin, origin_m=origin), building, Memo()


@cache
def survey(name, stations=None, **settings):
    """The inspection of one case of the benchmark, its building and the scan's origin."""
    scan, building, memo = scanned(name, stations)
    params = PARAMS
    for setting, value in settings.items():
        params = params.replaced(setting.replace("__", "."), value)
    return inspect(scan, params, memo), building, scan.origin_m


def codes(inspection, step=None):
    return [note.code for note in inspection.notes if step is None or note.step == step]


def off(inspection, building, origin, quantities=QUANTITIES, unlimited=()):
    """Every value that is farther from the truth than its uncertainty and, where it was seen, the limits allow."""
    pairs, n_false, n_missed = match(inspection, building, origin)
    assert (n_false, n_missed) == (0, 0)
    wrong = []
    for step in inspection.steps:
        true, found = true_values(pairs[step.step_id]), found_values(step)
        seen = {"back_hidden", "nosing_unobserved"}.isdisjoint(codes(inspection, step.step_id))
        for name in quantities:
            is_landing = pairs[step.step_id].kind == "landing" and name not in ("rise", "fall", "cross_fall")
            if true[name] is None or found[name] is None or is_landing:
                continue
            value, u = found[name]
            error = abs(value - true[name])
            is_limited = seen and name not in unlimited
            if error > WITHIN_U * u or (is_limited and error > MOST.get(name, np.inf)):
                wrong.append((step.step_id, name, round(value, 2), round(u, 2), round(true[name], 2)))
    return wrong


# --- truth ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "name",
    [
        "one riser +8 mm",
        "fall and +1/4 in",
        *(pytest.param(each, marks=pytest.mark.slow) for each in ("even", "twist 10 mm", "three risers")),
        *(pytest.param(each, marks=pytest.mark.slow) for each in ("going shrinks", "twins")),
    ],
)
def test_every_value_is_within_its_uncertainty(name):
    assert off(*survey(name)) == []


def test_every_step_of_an_even_stair_has_every_value_but_the_landing():
    inspection, _, _ = survey("even")
    (flight,) = inspection.flights
    assert (flight.step_ids, flight.n_risers, flight.shape) == (tuple(range(1, 11)), 10, "straight")
    for step in inspection.steps[:-1]:
        assert (step.kind, step.flight) == ("tread", 1)
        assert all(getattr(step, name) is not None for name in SURVEY_VALUES)
        # From two stations only: the middle steps are seen at a grazing angle by both.
        assert 0.5 < step.coverage <= 1.0
    last = inspection.steps[-1]
    assert last.kind == "landing"
    # There is no step above it and its back was not seen: not measured, and not zero.
    unknown = [last.going_m, last.tread_depth_m, last.nosing_overhang_m, last.pitch_deg, last.going_lcr_m]
    assert unknown == [None] * 5
    assert codes(inspection, 10) == ["back_unobserved"]
    assert flight.pitch_deg.value == pytest.approx(np.degrees(np.arctan2(0.17, 0.28)), abs=0.05)
    assert flight.rise.mean == pytest.approx(0.17, abs=0.0002)
    assert (flight.rise.n, flight.going.n) == (10, 9)


def test_a_riser_that_differs_by_8_mm_stands_out_by_8_mm():
    inspection, _, _ = survey("one riser +8 mm")
    rises = np.array([step.rise_m.value for step in inspection.steps])
    stands_out = np.abs(rises - np.median(rises))
    assert 0.007 <= stands_out[4] <= 0.009
    assert np.delete(stands_out, 4).max() < 0.001
    (flight,) = inspection.flights
    assert flight.rise.max_adjacent == pytest.approx(0.008, abs=0.001)
    assert flight.rise.at in {(4, 5), (5, 6)}


@pytest.mark.slow
def test_a_twisted_nosing_shows_on_the_left_and_the_right_line():
    inspection, building, origin = survey("twist 10 mm")
    pairs, _, _ = match(inspection, building, origin)
    for step in inspection.steps:
        true = pairs[step.step_id]
        np.testing.assert_allclose(step.rise_lcr_m, true.rise_lcr_m, atol=0.001)
        if true.going_lcr_m is not None:
            np.testing.assert_allclose(step.going_lcr_m, true.going_lcr_m, atol=0.0015)
    by_id = {step.step_id: step for step in inspection.steps}
    # 0.48 degrees over the 70 % of 1.2 m between the outer lines.
    assert by_id[4].rise_lcr_m[0] - by_id[4].rise_lcr_m[2] == pytest.approx(0.0070, abs=0.0008)
    # The left end is 10 mm farther forward, so the going to it is shorter on the left.
    assert by_id[5].going_lcr_m[2] - by_id[5].going_lcr_m[0] == pytest.approx(0.0070, abs=0.0015)


def seen_from_the_top(stair):
    """One station, on the upper landing: no riser is seen, and the back of a tread is under the nosing above."""
    building = build(stair)
    top = building.steps[-1].nosing[0][2]
    x = building.steps[-1].plan.middle[0] + 1.2
    walk = ((x, 0.0, top), (x + 0.1, 0.0, top))
    simulated = scan_building(replace(building, stair=None, walk=walk), replace(COARSE, stations=1))
    return make_scan(simulated.points), building


def test_backs_hidden_from_the_top_have_a_large_uncertainty_and_a_note():
    # Steep enough that the sight line over a nosing passes the tread below.
    scan, building = seen_from_the_top(replace(EVEN, n_risers=7, going_m=0.26, rise_m=0.18, overhang_m=0.03))
    inspection = inspect(scan, PARAMS)
    assert off(inspection, building, np.zeros(3), ("rise", "depth", "overhang")) == []
    hidden = [step for step in inspection.steps if "back_hidden" in codes(inspection, step.step_id)]
    assert len(hidden) >= 4
    for step in hidden:
        assert step.tread_depth_m.u > 0.02
        assert step.nosing_overhang_m.u > 0.02
        assert dict(step.tread_depth_m.parts)["edge"] > 0.9 * step.tread_depth_m.u
        # The rise and the going do not need the back.
        assert step.rise_m.u < 0.001


@pytest.mark.slow
def test_open_risers_are_measured_from_their_treads():
    inspection, building, origin = survey("open risers")
    # The backs of planks lie behind each other: no limit to how far off, but for the uncertainty.
    assert off(inspection, building, origin, unlimited=("depth", "overhang")) == []
    for step in inspection.steps:
        if "back_hidden" in codes(inspection, step.step_id):
            assert step.tread_depth_m.u > 0.01


def test_a_missing_tread_leaves_nulls_around_the_gap_and_a_note():
    inspection, building, origin = survey("tread missing")
    assert off(inspection, building, origin, unlimited=("depth", "overhang")) == []
    below, above = inspection.steps[3], inspection.steps[4]
    assert (above.rise_m, above.rise_lcr_m) == (None, None)
    assert (below.going_m, below.going_lcr_m, below.pitch_deg, below.nosing_overhang_m) == (None,) * 4
    assert below.rise_m is not None
    assert above.going_m is not None
    (note,) = [note for note in inspection.notes if note.code == "tread_missing"]
    assert note.step == 5
    assert note.message.startswith("a tread is missing or not seen between step 4 and step 5")
    (flight,) = inspection.flights
    assert (flight.n_risers, len(flight.step_ids), flight.pitch_deg) == (10, 9, None)


def test_a_missing_highest_tread_is_noted_at_the_landing():
    stair = replace(EVEN, open_risers=True, missing_treads="9")
    simulated, building = simulate(stair, COARSE, 1)
    inspection = inspect(make_scan(simulated.points), PARAMS)
    assert match(inspection, building, np.zeros(3))[1:] == (0, 0)
    (note,) = [note for note in inspection.notes if note.code == "tread_missing"]
    assert note.step == 9
    assert (inspection.steps[-1].kind, inspection.steps[-1].rise_m) == ("landing", None)
    assert [flight.n_risers for flight in inspection.flights] == [10]


@pytest.mark.slow
def test_a_missing_lowest_tread_above_a_landing_is_noted():
    stair = replace(EVEN, n_risers=14, landing_after=7, open_risers=True, missing_treads="8")
    simulated, building = simulate(stair, replace(COARSE, stations=4), 1)
    inspection = inspect(make_scan(simulated.points), PARAMS)
    assert match(inspection, building, np.zeros(3))[1:] == (0, 0)
    (note,) = [note for note in inspection.notes if note.code == "tread_missing"]
    assert note.step == 8
    assert inspection.steps[7].rise_m is None
    assert [flight.n_risers for flight in inspection.flights] == [7, 7]


def test_a_first_riser_far_too_tall_is_measured_with_its_flight():
    simulated, building = simulate(replace(EVEN, rise_errors_m="1:0.12"), COARSE, 1)
    inspection = inspect(make_scan(simulated.points), PARAMS)
    assert off(inspection, building, np.zeros(3), ("rise",)) == []
    (flight,) = inspection.flights
    assert flight.rise.max_adjacent == pytest.approx(0.12, abs=0.001)
    assert {"tread_missing", "foot_unclear"}.isdisjoint(codes(inspection))


LONG = {
    "sixty risers": ({"n_risers": 60}, 6, [60]),
    "sixty risers, a landing": ({"n_risers": 60, "landing_after": 30}, 8, [30, 30]),
    "sixty open risers": ({"n_risers": 60, "open_risers": True}, 8, [60]),
    "thirty risers between walls": ({"n_risers": 30, "wall": "both"}, 6, [30]),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", LONG)
def test_long_flights_are_found_whole_from_a_station_every_five_to_ten_steps(name):
    changes, stations, risers = LONG[name]
    scanner = replace(PROFILES["tls_fair"], stations=stations, spacing_m=0.01, registration_m=0.0015, tilt_deg=0.02)
    simulated, building = simulate(replace(EVEN, **changes), scanner, 3)
    inspection = inspect(make_scan(simulated.points), replace(PARAMS, up="auto"))
    assert match(inspection, building, np.zeros(3))[1:] == (0, 0)
    assert [flight.n_risers for flight in inspection.flights] == risers
    assert "tread_missing" not in codes(inspection)


def test_a_landing_parts_two_flights():
    inspection, building, origin = survey("two flights, landing", stations=4)
    assert off(inspection, building, origin) == []
    lower, upper = inspection.flights
    assert (lower.step_ids, upper.step_ids) == (tuple(range(1, 7)), tuple(range(7, 14)))
    assert (lower.n_risers, upper.n_risers) == (6, 7)
    assert [step.kind for step in inspection.steps] == ["tread"] * 5 + ["landing"] + ["tread"] * 6 + ["landing"]
    assert [step.flight for step in inspection.steps] == [1] * 6 + [2] * 7
    for flight in inspection.flights:
        assert flight.pitch_deg.value == pytest.approx(np.degrees(np.arctan2(0.16, 0.3)), abs=0.1)


@pytest.mark.slow
def test_an_l_turn_has_two_flights_at_a_right_angle():
    inspection, building, origin = survey("L turn")
    assert off(inspection, building, origin) == []
    lower, upper = inspection.flights
    assert (len(lower.step_ids), len(upper.step_ids)) == (6, 6)
    np.testing.assert_allclose(lower.climb, [1.0, 0.0, 0.0], atol=0.01)
    np.testing.assert_allclose(upper.climb, [0.0, 1.0, 0.0], atol=0.01)


@pytest.mark.slow
def test_a_u_turn_comes_back():
    simulated, building = simulate(CASES["U turn"], replace(COARSE, spacing_m=0.006, stations=6), 1)
    inspection = inspect(make_scan(simulated.points), PARAMS)
    # The first backs above the landing are seen by no station well, and say so by their u.
    assert off(inspection, building, np.zeros(3), unlimited=("depth", "overhang")) == []
    lower, upper = inspection.flights
    assert (lower.n_risers, upper.n_risers) == (7, 7)
    np.testing.assert_allclose(lower.climb, -upper.climb, atol=0.02)


@pytest.mark.slow
def test_twins_are_two_flights_beside_each_other():
    inspection, _, _ = survey("twins")
    first, second = inspection.flights
    assert (len(first.step_ids), len(second.step_ids)) == (7, 7)
    assert abs(first.climb @ second.climb) > 0.999
    for k in range(7):
        a, b = (inspection.steps[flight.step_ids[k] - 1] for flight in (first, second))
        # 0.9 m wide with 0.25 m between.
        assert np.linalg.norm((a.nosing - b.nosing).mean(axis=0)) == pytest.approx(1.15, abs=0.05)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["winder", "spiral"])
def test_winding_flights_are_flagged(name):
    inspection, building, origin = survey(name, stations=5)
    # A spiral whose treads hide each other may be found in two pieces.
    assert {flight.shape for flight in inspection.flights} <= {"winder", "spiral"}
    assert len(inspection.flights) == 1 or name == "spiral"
    assert [note for note in inspection.notes if note.code == "winding"]
    _, n_false, _ = match(inspection, building, origin)
    assert n_false == 0


@pytest.mark.slow
def test_a_winder_is_flagged_and_its_rises_are_right():
    inspection, building, origin = survey("winder")
    assert [flight.shape for flight in inspection.flights] == ["winder"]
    assert off(inspection, building, origin, ("rise", "fall")) == []


@pytest.mark.slow
def test_strips_that_stand_proud_and_worn_treads_are_measured_at_the_nosing():
    for name in ("strips proud", "worn, strips"):
        inspection, building, origin = survey(name)
        assert off(inspection, building, origin, ("going", "depth", "overhang")) == []


# --- invariance ----------------------------------------------------------------------------------------------------


def values_of(inspection, unit):
    """Every value and u of the survey in one unit, null as NaN."""
    rows = []
    for step in inspection.steps:
        for name in SURVEY_VALUES:
            measured = getattr(step, name)
            if name.endswith(unit):
                rows += [np.nan, np.nan] if measured is None else [measured.value, measured.u]
        if unit == "_m":
            rows += [*(step.rise_lcr_m or [None] * 3), *(step.going_lcr_m or [None] * 3)]
    return np.array(rows, dtype=np.float64)


def assert_same_values(first, second, atol):
    assert len(first.steps) == len(second.steps) > 0
    np.testing.assert_allclose(values_of(second, "_m"), values_of(first, "_m"), rtol=0, atol=atol)
    # A height over the going of 0.28 m, in degrees.
    np.testing.assert_allclose(values_of(second, "_deg"), values_of(first, "_deg"), rtol=0, atol=atol * 60.0 / 0.28)


@pytest.mark.parametrize("turn", [np.eye(3), rotation("x", 25.0)], ids=["shift", "tilt"])
def test_a_shift_and_a_tilt_that_up_follows_change_no_value(turn):
    moved = replace(NOSED, motion=motion(turn, (0.0137, -0.0071, 0.003)))
    after = inspect(moved.scan(origin_m=(691_000.0, 5_335_000.0, 520.0)), exact_params(up=moved.up))
    assert_same_values(inspect_nosed(exact_params()), after, 1e-6)


def turned(degrees):
    moved = replace(NOSED, motion=motion(rotation("z", degrees), (0.5, -0.3, 0.2)))
    return inspect(moved.scan(origin_m=(691_000.0, 5_335_000.0, 520.0)), exact_params(up=moved.up))


# The plan cells follow the scan's axes, so other points share a cell after a turn.
@pytest.mark.parametrize("degrees", [37.0, 90.0, 180.0])
def test_a_turn_in_plan_moves_no_value_by_more_than_half_its_uncertainty(degrees):
    still, after = inspect_nosed(exact_params()), turned(degrees)
    assert len(after.steps) == len(still.steps) == NOSED.n_steps
    for step, other in zip(still.steps, after.steps, strict=True):
        for name in SURVEY_VALUES:
            first, second = getattr(step, name), getattr(other, name)
            assert (first is None) == (second is None)
            if first is not None:
                assert abs(second.value - first.value) <= 0.5 * max(first.u, second.u), (step.step_id, name)
        np.testing.assert_allclose(rotation("z", degrees) @ step.climb, other.climb, atol=0.002)


def test_the_order_of_the_points_changes_no_bit():
    points, normals = NOSED.sample()
    order = np.random.default_rng(2).permutation(len(points))
    first = inspect_nosed(exact_params())
    second = inspect(make_scan(points[order], normals[order]), exact_params())
    assert_same_values(first, second, 0.0)
    np.testing.assert_array_equal(second.patch_ids, first.patch_ids[order])


def test_a_file_in_inches_gives_the_same_metres(tmp_path):
    points, _ = NOSED.sample()
    inspections = []
    for unit, per_metre in (("m", 1.0), ("in", 1.0 / 0.0254)):
        path = tmp_path / f"{unit}.xyz"
        np.savetxt(path, points * per_metre, fmt="%.17g")
        params = exact_params(unit=unit).replaced("normals.source", "estimate")
        inspections.append(inspect(read_scan(path, unit), params))
    assert len(inspections[0].steps) == NOSED.n_steps
    assert_same_values(*inspections, 1e-6)


# --- uncertainty ---------------------------------------------------------------------------------------------------


def test_u_is_the_root_of_the_squares_of_its_named_parts():
    inspection, _, _ = survey("even", uncertainty__scale_percent=0.1, uncertainty__edge_m=0.0005)
    seen = set()
    flights = [value for flight in inspection.flights for value in (flight.pitch_deg, flight.width_m)]
    for measured in [getattr(step, name) for step in inspection.steps for name in SURVEY_VALUES] + flights:
        if measured is not None:
            parts = dict(measured.parts)
            seen |= parts.keys()
            assert len(parts) == len(measured.parts)
            assert measured.u == pytest.approx(np.sqrt(sum(part**2 for part in parts.values())), rel=1e-12)
            assert min(parts.values()) > 0.0
    assert seen == {"noise", "edge", "up", "registration", "scale"}


@pytest.mark.parametrize(
    ("setting", "value", "part", "alike"),
    [
        ("uncertainty.registration_m", 0.002, "registration", {"fall_deg", "cross_fall_deg"}),
        ("uncertainty.edge_m", 0.003, "edge", {"fall_deg", "cross_fall_deg", "width_m"}),
        (
            "uncertainty.side_m",
            0.003,
            "edge",
            {
                "rise_m",
                "going_m",
                "tread_depth_m",
                "nosing_overhang_m",
                "pitch_deg",
                "fall_deg",
                "cross_fall_deg",
            },
        ),
        (
            "uncertainty.slope_deg",
            0.1,
            "registration",
            {
                "rise_m",
                "going_m",
                "tread_depth_m",
                "width_m",
                "nosing_overhang_m",
                "pitch_deg",
            },
        ),
        ("uncertainty.up_deg", 0.2, "up", {"tread_depth_m", "width_m"}),
        (
            "uncertainty.scale_percent",
            0.5,
            "scale",
            {"pitch_deg", "fall_deg", "cross_fall_deg", "nosing_overhang_m"},
        ),
    ],
)
def test_what_the_user_states_enlarges_its_own_part_and_no_other(setting, value, part, alike):
    plain = inspect_nosed(exact_params())
    stated = inspect_nosed(exact_params().replaced(setting, value))
    for step, other in zip(plain.steps, stated.steps, strict=True):
        for name in SURVEY_VALUES:
            first, second = getattr(step, name), getattr(other, name)
            if first is None:
                assert second is None
                continue
            assert second.value == first.value
            before, after = dict(first.parts), dict(second.parts)
            assert {k: v for k, v in after.items() if k != part} == {k: v for k, v in before.items() if k != part}
            # The height of a level tread does not hang on the place of its edge, nor on up at the first step; and its
            # cross-fall is measured square to the flight's climb, which may differ from its own by a hundredth.
            if name in alike or (name == "rise_m" and part in ("edge", "up")):
                assert after.get(part, 0.0) >= before.get(part, 0.0)
            else:
                assert after[part] > before.get(part, 0.0)
            assert (name in alike) <= (second.u == first.u)


def test_stated_values_enter_with_k_2():
    step = inspect_nosed(exact_params().replaced("uncertainty.registration_m", 0.002)).steps[1]
    assert dict(step.rise_m.parts)["registration"] == 0.004
    assert dict(step.width_m.parts)["registration"] == 0.004
    step = inspect_nosed(exact_params().replaced("uncertainty.scale_percent", 0.5)).steps[1]
    assert dict(step.going_m.parts)["scale"] == pytest.approx(2.0 * 0.005 * step.going_m.value)
    step = inspect_nosed(exact_params().replaced("uncertainty.up_deg", 0.2)).steps[1]
    # A tilt moves a rise by the going times its angle, and a going by the rise times it.
    assert dict(step.rise_m.parts)["up"] == pytest.approx(2.0 * np.radians(0.2) * 0.28, rel=0.01)
    assert dict(step.going_m.parts)["up"] == pytest.approx(2.0 * np.radians(0.2) * 0.17, rel=0.01)
    assert dict(step.cross_fall_deg.parts)["up"] == pytest.approx(0.4)


def test_what_is_null_has_a_note_for_its_step_or_the_step_above():
    for name in ("even", "tread missing", "open risers", "twins"):
        inspection, _, _ = survey(name)
        tops = {flight.step_ids[-1] for flight in inspection.flights}
        for step in inspection.steps:
            noted = set(codes(inspection, step.step_id)) | set(codes(inspection, step.step_id + 1))
            if step.rise_m is None:
                assert noted & {"tread_missing", "rise_unobserved"}
            if step.going_m is None and step.step_id not in tops:
                assert "tread_missing" in noted
            if step.tread_depth_m is None:
                assert "back_unobserved" in noted


@pytest.mark.slow
def test_over_twelve_seeds_the_rises_lie_within_u():
    stair = replace(EVEN, n_risers=6)
    inside = []
    for seed in range(12):
        simulated = scan_building(build(stair), replace(COARSE, seed=100 + seed))
        inspection = inspect(make_scan(simulated.points), PARAMS)
        assert len(inspection.steps) == 6
        inside += [abs(step.rise_m.value - 0.17) <= step.rise_m.u for step in inspection.steps]
    # k = 2 promises 95 %; the errors of neighbours are not independent.
    assert np.mean(inside) >= 0.8


# --- scenes without a staircase ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "name",
    [each if each in ("room", "blocks", "ramp") else pytest.param(each, marks=pytest.mark.slow) for each in SCENES],
)
def test_a_scene_without_a_staircase_gives_no_step_and_says_why(name):
    scanner = replace(COARSE, azimuth_step_deg=0.8, elevation_step_deg=0.8, spacing_m=0.01)
    scan = make_scan(scan_building(SCENES[name](), scanner).points)
    inspection = inspect(scan, PARAMS)
    assert inspection.steps == ()
    assert inspection.flights == ()
    (note,) = [note for note in inspection.notes if note.code == "no_staircase"]
    assert note.message.startswith("no staircase found: ")
    assert "horizontal surface" in note.message
    assert {patch.kind for patch in inspection.patches} <= {"floor", "rejected"}
    assert all(patch.reason for patch in inspection.patches if patch.kind == "rejected")
    assert all(level.reason for level in inspection.levels if level.kind == "rejected")


@pytest.mark.slow
@pytest.mark.parametrize("profile", ["tls_good", "handheld", "depth_camera"])
@pytest.mark.parametrize("name", SCENES)
def test_a_scene_without_a_staircase_gives_no_step_to_any_scanner(name, profile):
    scanner = replace(PROFILES[profile], spacing_m=max(0.006, PROFILES[profile].spacing_m), seed=11)
    preset = {"tls_good": "tls"}.get(profile, profile)
    scan = make_scan(scan_building(SCENES[name](), scanner).points)
    inspection = inspect(scan, replace(find_preset(preset).params, unit="m"))
    assert inspection.steps == ()
    assert "no_staircase" in codes(inspection)


# --- overrules -----------------------------------------------------------------------------------------------------


def overruled(**overrules):
    params = exact_params()
    for name, value in overrules.items():
        params = params.replaced(f"overrules.{name}", value)
    return inspect_nosed(params)


def test_a_level_that_is_rejected_is_no_step():
    inspection = overruled(force="level:5=rejected")
    assert [step.step_id for step in inspection.steps] == [1, 2, 3, 4]
    assert (inspection.levels[5].kind, inspection.levels[5].reason) == ("rejected", "rejected by the inspector")
    (patch,) = [patch for patch in inspection.patches if patch.level_id == 5]
    assert (patch.kind, patch.step_id, patch.reason) == ("rejected", None, "rejected by the inspector")
    assert not (inspection.labels == 5).any()


def test_a_patch_by_number_and_one_at_a_place_are_decided_alike():
    whole = overruled()
    patch = next(patch for patch in whole.patches if patch.step_id == 5)
    x, y, z = np.round(whole.steps[4].plane.centroid, 3)
    by_number = overruled(force=f"patch:{patch.patch_id}=rejected")
    by_place = overruled(force=f"at:{x},{y},{z}=rejected")
    assert len(by_number.steps) == len(by_place.steps) == 4
    np.testing.assert_array_equal(by_number.labels, by_place.labels)
    assert by_number.patches[patch.patch_id].reason == "rejected by the inspector"


def test_a_forced_landing_parts_the_flight():
    inspection = overruled(force="level:3=landing")
    assert inspection.steps[2].kind == "landing"
    assert [flight.step_ids for flight in inspection.flights] == [(1, 2, 3), (4, 5)]
    assert [step.flight for step in inspection.steps] == [1, 1, 1, 2, 2]
    # The second flight begins at the landing: nothing is measured twice, nothing is lost.
    assert inspection.flights[1].n_risers == 2
    assert all(step.rise_m is not None for step in inspection.steps)
    assert inspection.patches[3].kind == "landing"


def test_a_forced_tread_is_taken_whatever_its_size():
    params = exact_params().replaced("patches.min_area_m2", 0.5)
    assert inspect_nosed(params).steps == ()
    forced = params.replaced("overrules.force", "; ".join(f"level:{k}=tread" for k in range(1, 6)))
    assert len(inspect_nosed(forced).steps) == 5


def test_a_later_decision_replaces_an_earlier_one():
    inspection = overruled(force="level:5=rejected; level:5=tread")
    assert len(inspection.steps) == 5


def test_a_given_climb_leaves_out_what_climbs_otherwise():
    inspection = overruled(climb="1,0.3,0")
    assert len(inspection.steps) == 5
    for step in inspection.steps:
        np.testing.assert_allclose(step.climb, [1.0, 0.0, 0.0], atol=0.01)
    # No step can be reached against the climb.
    assert overruled(climb="-x").steps == ()


def test_a_region_cuts_off_the_upper_flight():
    simulated, _ = simulate(CASES["two flights, landing"], replace(COARSE, stations=4), 1)
    scan = make_scan(simulated.points)
    # The landing is step 6, from x = 1.5 to 2.7 m at 0.96 m.
    params = PARAMS.replaced("overrules.region", "-3,-2,-0.5,2.4,2,1.0")
    inspection = inspect(scan, params)
    assert [flight.step_ids for flight in inspection.flights] == [(1, 2, 3, 4, 5, 6)]
    assert inspection.steps[-1].plane.centroid[2] == pytest.approx(6 * 0.16, abs=0.002)
    outside = (scan.points < [-3.0, -2.0, -0.5]).any(axis=1) | (scan.points > [2.4, 2.0, 1.0]).any(axis=1)
    assert set(inspection.labels[outside]) == {-1}
    assert set(inspection.patch_ids[outside]) == {-1}
    assert len(inspection.labels) == len(scan.points)


def cut_by_region(region, stair=EVEN):
    """What is said of the region in a scan of a stair that climbs along x, its middle at y = 0: step and sides."""
    simulated, _ = simulate(stair, COARSE, 1)
    inspection = inspect(make_scan(simulated.points), PARAMS.replaced("overrules.region", region))
    assert inspection.steps
    notes = [note for note in inspection.notes if note.code.startswith("region_cuts")]
    for note in notes:
        assert note.message.startswith(f"the region of interest cuts through step {note.step} on its ")
    return inspection, [(note.step, note.message.split(" on its ")[1].split(":")[0]) for note in notes]


def test_steps_whose_side_is_cut_by_the_region_say_so():
    # 1.2 m wide: 0.2 m are cut off on the left; at the back the fifth step is cut through its middle.
    inspection, cuts = cut_by_region("-1.5,-2,-0.5,1.25,0.4,3")
    assert {step.step_id for step in inspection.steps} == {1, 2, 3, 4, 5}
    assert sorted(cuts) == [(1, "left"), (2, "left"), (3, "left"), (4, "left"), (5, "back"), (5, "left")]
    # The widths would be those of the region.
    assert [step.width_m for step in inspection.steps] == [None] * 5
    assert inspection.flights[0].width_m is None
    assert [step.tread_depth_m is None for step in inspection.steps] == [False] * 4 + [True]


@pytest.mark.slow
def test_a_region_that_leaves_the_steps_whole_says_nothing():
    _, cuts = cut_by_region("-1.5,-0.75,-0.5,9,0.75,5")
    assert cuts == []


@pytest.mark.slow
def test_a_region_that_ends_where_the_stair_ends_says_nothing():
    _, cuts = cut_by_region("-1.5,-0.615,-0.5,9,0.615,5")
    assert cuts == []


def test_a_region_without_points_is_a_wrong_setting():
    with pytest.raises(ConfigError, match=r"^overrules\.region: no point of synthetic\.ply lies in the box"):
        overruled(region="100,100,100,101,101,101")


def test_overrules_round_trip_through_the_json():
    force, region = "level:5=rejected; at:0.1,0.5,0.17=tread", "-2,-2,-2,3,3,3"
    inspection = overruled(force=force, climb="x", region=region)
    settings = json.loads(json.dumps(inspection_to_dict(inspection)))["settings"]
    assert settings["overrules"] == {"force": force, "climb": "x", "region": region}
    params = exact_params()
    for name, value in settings["overrules"].items():
        params = params.replaced(f"overrules.{name}", value)
    assert params == inspection.params
    again = inspect(NOSED.scan(), params)
    assert dataclasses.asdict(again.flights[0].rise) == dataclasses.asdict(inspection.flights[0].rise)


# --- real captures -------------------------------------------------------------------------------------------------


def capture(name, params=None):
    return inspect(read_scan(REAL / name), params or Params())


has_captures = pytest.mark.skipif(not REAL.is_dir(), reason="the shared real captures are not beside this checkout")
KINECT = "kinect_v2_five_steps.pcd"
KINECT_RISES = (0.111, 0.112, 0.104)
"""Between the treads, as the capture's authors and an independent plane fit read them; there is no tape measure."""
KINECT_GOINGS = (0.280, 0.277, 0.270, 0.283)


@pytest.mark.real
@has_captures
def test_a_depth_cameras_five_steps():
    inspection = capture(KINECT)
    assert [step.kind for step in inspection.steps] == ["tread"] * 5
    rises = [step.rise_m.value for step in inspection.steps[1:4]]
    assert rises == pytest.approx(KINECT_RISES, abs=0.006)
    goings = [step.going_m.value for step in inspection.steps[:4]]
    assert goings == pytest.approx(KINECT_GOINGS, abs=0.015)


@pytest.mark.slow
@pytest.mark.real
@has_captures
def test_a_depth_cameras_five_steps_with_its_preset():
    inspection = capture(KINECT, find_preset("depth_camera").params)
    assert [step.kind for step in inspection.steps] == ["tread"] * 5


@pytest.mark.slow
@pytest.mark.real
@has_captures
def test_a_robots_map_of_entrance_stairs():
    inspection = capture("anymal_entrance_stairs.pcd")
    rises = [step.rise_m.value for step in inspection.steps if step.flight == 1]
    assert len(rises) >= 4
    # The folder's reading of the first, 172 mm, is from the floor half a metre before the stair; the floor rises
    # towards it, and at its foot lies 162 mm below the first tread (medians of the map's columns in the middle third).
    assert rises[:3] == pytest.approx((0.162, 0.169, 0.164), abs=0.01)


@pytest.mark.slow
@pytest.mark.real
@has_captures
@pytest.mark.parametrize("name", ["apartment_no_stairs.xyz", "tilted_platform_no_stairs.pcd"])
def test_captures_without_stairs(name):
    inspection = capture(name)
    assert inspection.steps == ()
    assert "no_staircase" in codes(inspection)


# --- thinning ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["even", pytest.param("going shrinks", marks=pytest.mark.slow)])
def test_of_twenty_values_nineteen_move_within_the_larger_u_when_half_of_the_points_are_left(name):
    scan, whole = scanned(name)[0], survey(name)[0]
    half = scan.points[np.random.default_rng(0).random(len(scan.points)) < 0.5]
    thinned = inspect(make_scan(half, origin_m=scan.origin_m), PARAMS)
    assert len(thinned.steps) == len(whole.steps)
    moved = [
        abs(now.value - was.value) / max(was.u, now.u)
        for step, again in zip(whole.steps, thinned.steps, strict=True)
        for quantity in ("rise_m", "going_m", "tread_depth_m")
        if (was := getattr(step, quantity)) is not None and (now := getattr(again, quantity)) is not None
    ]
    # u is expanded by k = 2: about 95 %.
    assert np.mean(np.array(moved) <= 1.0) >= 0.95
    assert max(moved) <= 2.0
