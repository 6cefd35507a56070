"""Suggested settings: what is seen in the scan is what was built, and the settings find the steps."""

import json
from functools import cache

import numpy as np
import pytest

from stair_inspector.errors import CannotMeasure
from stair_inspector.files.paths import sample_scans
from stair_inspector.files.scans import read_scan
from stair_inspector.memo import Memo
from stair_inspector.params import SETTINGS, FloorParams, Params
from stair_inspector.pipeline import inspect
from stair_inspector.stages import orient
from stair_inspector.stages.suggest import suggest_settings
from tests.synthetic import Stair, exact_params, make_scan, motion, rotation

NAMES = ("horizontal.theta_deg", "levels.eps_m", "levels.min_points")


def heights_of(scan, params):
    normals = orient.find_normals(scan, params.normals)
    up = orient.find_up(scan, normals, params.up, FloorParams(), params.method)
    return orient.order_by_height(scan, normals, up, params.overrules.region)


def suggested(stair, params=None):
    """The suggestion for a synthetic stair, with the exact normals unless ``params`` estimates them."""
    params = params or exact_params(up=stair.up)
    return suggest_settings(heights_of(stair.scan(), params), params)


def leaning(sigma_deg, n=40_000, seed=3):
    """A stair whose normals scatter by sigma in both directions."""
    rng = np.random.default_rng(seed)
    points, normals = Stair(spacing=0.01, noise=0.001).sample()
    shift = rng.normal(0.0, np.tan(np.radians(sigma_deg)), (len(points), 3))
    tilted = normals + shift
    return make_scan(points, tilted / np.linalg.norm(tilted, axis=1)[:, None])


@pytest.mark.parametrize(
    "stair",
    [
        Stair(noise=0.0005, spacing=0.01, risers=True),
        Stair(noise=0.002, spacing=0.02, risers=True, n_steps=12),
        Stair(noise=0.008, spacing=0.01, rise=0.15, risers=True),
        Stair(noise=0.002, spacing=0.02, rise=0.1, going=0.4, risers=True),
        Stair(noise=0.002, spacing=0.02, motion=motion(rotation("x", 40.0), (300.0, -40.0, 5.0)), risers=True),
    ],
    ids=["clean", "coarse", "noisy", "low", "tilted_far"],
)
def test_it_sees_what_was_built_and_finds_the_steps(stair):
    seen = suggested(stair)
    assert seen.n_levels == stair.n_steps + 1
    assert seen.spacing_m == pytest.approx(stair.spacing, rel=0.15)
    # A level's scatter is that of the points' height; MAD of thousands of points is known to some percent.
    assert seen.thickness_m == pytest.approx(stair.noise, rel=0.15)
    # Levels are found on a grid of 2 mm.
    assert seen.gap_m == pytest.approx(stair.rise, abs=0.004 + stair.noise)
    inspection = inspect(stair.scan(), seen.params)
    assert len(inspection.steps) == stair.n_steps
    rises = [step.rise_m.value for step in inspection.steps]
    assert rises == pytest.approx([stair.rise] * stair.n_steps, abs=0.003)


@pytest.mark.parametrize("sigma_deg", [0.5, 2.0, 4.0, 7.0])
def test_the_scatter_of_normals_is_found_beside_risers_and_theta_covers_it(sigma_deg):
    scan = leaning(sigma_deg)
    seen = suggest_settings(heights_of(scan, exact_params()), exact_params())
    assert seen.normal_deg == pytest.approx(sigma_deg, rel=0.05)
    theta = seen.params.horizontal.theta_deg
    assert theta == max(10.0, np.ceil(2.0 * 3.5 * seen.normal_deg) / 2.0)
    # Rayleigh: beyond 3.5 sigma lie 0.2 % of the angles.
    angles = np.degrees(np.arccos(np.abs(scan.normals[:, 2])))
    assert np.mean(angles <= theta) >= 0.997


def test_a_wild_scatter_gets_the_largest_theta_and_the_sentence_says_so():
    seen = suggest_settings(heights_of(leaning(15.0), exact_params()), exact_params())
    assert seen.params.horizontal.theta_deg == 30.0
    assert "more neighbours k would calm them" in seen.reasons[0].why


def test_only_the_three_change_and_each_has_its_sentence():
    params = exact_params(method="survey").replaced("flights.min_risers", 3).replaced("edges.front_percentile", 90.0)
    seen = suggested(Stair(noise=0.002, risers=True), params)
    kept = seen.params
    for name in NAMES:
        kept = kept.replaced(name, params.value(name))
    assert kept == params
    assert tuple(reason.name for reason in seen.reasons) == NAMES
    for reason in seen.reasons:
        knob = SETTINGS.knob(reason.name)
        assert seen.params.value(reason.name) == reason.value
        assert knob.low <= reason.value <= knob.high
        assert round(reason.value / knob.step, 6) == round(reason.value / knob.step), "on a step of its slider"
        assert f"{knob.shown(reason.value):,g}" in reason.why
        assert reason.why.endswith(".")


def test_the_present_values_of_the_three_do_not_matter():
    stair = Stair(noise=0.002, risers=True)
    params = exact_params()
    other = params.replaced("levels.eps_m", 0.1).replaced("levels.min_points", 5000)
    other = other.replaced("horizontal.theta_deg", 60.0)
    assert suggested(stair, other).reasons == suggested(stair, params).reasons


def test_more_noise_asks_for_a_longer_reach_and_a_coarser_scan_for_a_smaller_m():
    fine, noisy = suggested(Stair(noise=0.001, spacing=0.01)), suggested(Stair(noise=0.006, spacing=0.01))
    assert fine.params.levels.eps_m < noisy.params.levels.eps_m < Stair().rise / 4.0
    coarse = suggested(Stair(noise=0.001, spacing=0.03))
    assert coarse.params.levels.min_points < fine.params.levels.min_points


def test_a_floor_alone_is_one_level_without_a_rise():
    seen = suggested(Stair(n_steps=0, noise=0.002, spacing=0.01))
    assert (seen.n_levels, seen.gap_m) == (1, None)
    assert "no two levels are a rise apart" in seen.reasons[1].why
    assert "the other" not in seen.reasons[1].why
    assert "between" not in seen.reasons[2].why


def test_where_the_noise_is_too_large_for_the_rises_the_sentence_says_so():
    seen = suggested(Stair(noise=0.02, spacing=0.01, rise=0.15))
    assert seen.params.levels.eps_m < 3.0 * seen.thickness_m
    assert seen.params.levels.eps_m == pytest.approx(seen.gap_m / 5.0, abs=0.001)
    assert "less than the noise asks for" in seen.reasons[1].why
    assert "spans" not in seen.reasons[1].why


def test_a_wall_has_no_level_surface():
    rng = np.random.default_rng(1)
    points = np.column_stack([rng.uniform(0, 2, 5000), np.zeros(5000), rng.uniform(0, 2, 5000)])
    wall = make_scan(points, np.tile([0.0, 1.0, 0.0], (5000, 1)))
    with pytest.raises(CannotMeasure, match="check the up direction and the region"):
        suggest_settings(heights_of(wall, exact_params()), exact_params())


def test_a_few_points_are_too_few():
    rng = np.random.default_rng(1)
    points = np.column_stack([rng.uniform(0, 2, 60), np.zeros(60), rng.uniform(0, 2, 60)])
    normals = np.tile([0.0, 1.0, 0.0], (60, 1))
    normals[:5] = [0.0, 0.0, 1.0]
    with pytest.raises(CannotMeasure, match="only 5 points face up, too few"):
        suggest_settings(heights_of(make_scan(points, normals), exact_params()), exact_params())


def test_the_scan_is_not_changed_and_the_same_scan_gives_the_same():
    stair = Stair(noise=0.002, risers=True)
    scan, params = stair.scan(), exact_params()
    heights = heights_of(scan, params)
    before = heights.coordinates_m.copy()
    assert suggest_settings(heights, params) == suggest_settings(heights, params)
    assert np.array_equal(heights.coordinates_m, before)


@cache
def sample(name):
    scan, memo = read_scan(sample_scans() / f"{name}.ply"), Memo()
    seen = suggest_settings(heights_of(scan, Params(up="z")), Params())
    return seen, inspect(scan, seen.params, memo)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["handheld_noisy", "straight", "long_landing", "ceiling_clutter", "defective_step"])
def test_the_suggestion_finds_every_step_of_a_sample(name):
    truth = json.loads((sample_scans() / f"{name}.truth.json").read_text())
    seen, inspection = sample(name)
    assert len(inspection.steps) == len(truth["steps"])
    assert [flight.n_risers for flight in inspection.flights] == [flight["n_risers"] for flight in truth["flights"]]
    assert seen.gap_m == pytest.approx(min(step["rise_m"] for step in truth["steps"]), abs=0.06)
    assert seen.params.levels.eps_m < seen.gap_m / 4.0
