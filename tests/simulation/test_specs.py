"""Settings of the simulator: what is refused, and with which sentence."""

import dataclasses
import math
import subprocess
import sys

import pytest

from stair_inspector.declarations import fields_of
from stair_inspector.errors import ConfigError
from stair_inspector.simulation.samples import DEFAULT_SAMPLE, SAMPLES
from stair_inspector.simulation.scanner_specs import PROFILES, Scanner
from stair_inspector.simulation.spec_texts import parse_errors, parse_offset, parse_steps
from stair_inspector.simulation.specs import Stair


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"n_risers": 0}, "stair.n_risers: got 0; give a value from 1 to 60"),
        ({"rise_m": float("nan")}, "stair.rise_m: got nan; give a number"),
        ({"wall": "front"}, "stair.wall: got 'front'; give one of none, left, right, both"),
        (
            {"landing_after": 10},
            "stair.landing_after: got 10 with 10 risers; give a step below the upper landing, or 0 for no landing",
        ),
        (
            {"rise_errors_m": "5"},
            "stair.rise_errors_m: got '5'; give pairs step:value such as 5:+0.015,6:-0.015",
        ),
        (
            {"rise_errors_m": "11:0.01"},
            "stair.rise_errors_m: got step 11; this stair has steps 1 to 10 to which it applies",
        ),
        (
            {"going_errors_m": "10:0.01"},
            "stair.going_errors_m: got step 10; this stair has steps 1 to 9 to which it applies",
        ),
        (
            {"n_risers": 1, "going_errors_m": "1:0.01"},
            "stair.going_errors_m: got step 1; this stair has no step to which it applies",
        ),
        ({"fall_errors_deg": "2:1,2:2"}, "stair.fall_errors_deg: step 2 is given twice; give it once"),
        (
            {"wear_errors_m": "2:-0.003"},
            "stair.wear_errors_m: got '2:-0.003'; give depths, which are not negative",
        ),
        (
            {"wear_errors_m": "2:0.003", "round_nosing_m": 0.01},
            "stair.wear_errors_m: not possible with round_nosing_m; leave one of them out",
        ),
        (
            {"dish_errors_m": "2:nan"},
            "stair.dish_errors_m: got nan for step 2; give a value from -0.02 to 0.02",
        ),
        (
            {"rise_errors_m": "3:-0.15"},
            "stair.rise_errors_m: step 3 would have a rise of 0.02 m; give an error that leaves at least 0.06 m",
        ),
        (
            {"missing_treads": "3"},
            "stair.missing_treads: a tread can be missing only where open_risers is on",
        ),
        (
            {"missing_treads": "3;4", "open_risers": True},
            "stair.missing_treads: got '3;4'; give steps such as 5,6",
        ),
        (
            {"missing_treads": "10", "open_risers": True},
            "stair.missing_treads: got step 10; this stair has steps 1 to 9 to which it applies",
        ),
        (
            {"missing_treads": "4", "open_risers": True, "landing_after": 4},
            "stair.missing_treads: step 4 is a landing; give treads",
        ),
        (
            {"skew_errors_m": "4:0.1"},
            "stair.skew_errors_m: got 0.1 for step 4; give a value from -0.05 to 0.05",
        ),
        ({"strip_proud_m": 0.02}, "stair.strip_proud_m: got 0.02; give a value from 0 to 0.01"),
        (
            {"turn": "left"},
            "stair.turn: got 'left' without a landing; give landing_after, or shape winder",
        ),
        (
            {"turn": "u_left", "shape": "spiral"},
            "stair.turn: got 'u_left' with shape spiral; give left or right",
        ),
        (
            {"shape": "winder", "n_risers": 6},
            "stair.winder_after: got 3 with 6 risers; give at most 2, and at least 4 risers",
        ),
        (
            {"shape": "spiral", "width_m": 0.3, "going_m": 0.28},
            "stair.going_m: got 0.28; a spiral of this width has room for 0.25 m at most",
        ),
        (
            {"shape": "curved", "curve_radius_m": 1.2, "width_m": 1.2},
            "stair.curve_radius_m: got 1.2 with a width of 1.2 m; give more than the width, or shape spiral",
        ),
        (
            {"shape": "spiral", "landing_after": 4},
            "stair.landing_after: got 4; not possible with shape spiral",
        ),
        (
            {"shape": "winder", "dish_errors_m": "1:0.005"},
            "stair.dish_errors_m: got '1:0.005'; not possible with shape winder",
        ),
        (
            {"turn": "left", "landing_after": 4, "wall": "left"},
            "stair.wall: got 'left'; not possible with turn left",
        ),
        (
            {"turn": "u_left", "landing_after": 4, "twin_gap_m": 0.2},
            "stair.twin_gap_m: got 0.2; not possible with turn u_left",
        ),
        (
            {"turn": "right", "landing_after": 4, "going_errors_m": "4:0.1"},
            "stair.going_errors_m: step 4 is a landing that turns; give a tread",
        ),
        ({"offset_m": "1,2"}, "stair.offset_m: got '1,2'; give three numbers such as 691000,5335000,520"),
        ({"offset_m": "1,2,inf"}, "stair.offset_m: got '1,2,inf'; give three numbers such as 691000,5335000,520"),
    ],
)
def test_bad_stair_is_refused_with_one_sentence(settings, message):
    with pytest.raises(ConfigError) as caught:
        Stair(**settings)
    assert str(caught.value) == message


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"stations": 0}, "scanner.stations: got 0; give a value from 1 to 60"),
        ({"seed": 1.5}, "scanner.seed: got 1.5; give a whole number"),
        ({"noise_m": -0.001}, "scanner.noise_m: got -0.001; give a value from 0 to 0.1"),
        (
            {"elevation_low_deg": 10.0, "elevation_high_deg": 0.0},
            "scanner.elevation_high_deg: got 0 with a lowest ray at 10; give at least one step more",
        ),
    ],
)
def test_bad_scanner_is_refused_with_one_sentence(settings, message):
    with pytest.raises(ConfigError) as caught:
        Scanner(**settings)
    assert str(caught.value) == message


def test_errors_of_steps_are_read():
    assert parse_errors("x", "5:+0.015, 6:-0.015", 10, 0.3) == {5: 0.015, 6: -0.015}
    assert parse_errors("x", "  ", 10, 0.3) == {}
    assert parse_steps("x", "6, 5,6", 9) == (5, 6)
    assert parse_steps("x", "", 9) == ()
    assert parse_offset("1, -2.5,3e2") == (1.0, -2.5, 300.0)


@pytest.mark.parametrize("group", [Stair, Scanner])
def test_every_number_has_a_knob_that_holds_its_default(group):
    for name, declared in fields_of(group).items():
        knob = declared.knob
        if declared.kind in (int, float):
            assert knob is not None, name
            assert knob.low <= getattr(group(), name) <= knob.high, name


def test_profiles_are_what_the_figures_say():
    assert PROFILES["tls_good"].noise_m == 0.001
    assert PROFILES["tls_fair"].noise_m == 0.003
    assert PROFILES["handheld"].noise_m == 0.01
    assert PROFILES["robot_lidar"].sensor_height_m == 0.4
    assert PROFILES["depth_camera"].azimuth_width_deg < 120.0
    assert PROFILES["phone"].scale_percent == 0.5
    assert PROFILES["phone"].smooth_m == 0.015
    camera = PROFILES["depth_camera"]
    assert math.hypot(camera.noise_m, camera.range_noise_m * 1.5**2) == pytest.approx(0.006, abs=0.0002)
    assert camera.hole_share > 0.0
    assert len({dataclasses.astuple(profile) for profile in PROFILES.values()}) == 6


def test_samples_cover_what_was_asked():
    long = SAMPLES["long_landing"][0]
    treads = long.n_risers - 2
    assert treads * long.going_m + long.landing_depth_m > long.width_m
    assert long.landing_after > 0
    assert SAMPLES["ceiling_clutter"][0].ceiling
    assert SAMPLES["ceiling_clutter"][0].clutter
    assert SAMPLES["handheld_noisy"][1].noise_m == 0.01
    assert SAMPLES["defective_step"][0].rise_errors_m
    plain = SAMPLES[DEFAULT_SAMPLE][0]
    assert (plain.rise_errors_m, plain.going_errors_m, plain.fall_errors_deg, plain.clutter) == ("", "", "", False)


def test_specs_import_nothing_heavy():
    code = (
        "import sys, stair_inspector.simulation.samples\n"
        "print([name for name in ('numpy', 'trimesh', 'open3d') if name in sys.modules])"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "[]"
