"""Sparse scans: a tread of a hundred points is found and measured; dense scans and other settings stay as they are."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from stair_inspector.files.settings import find_preset
from stair_inspector.model import Scan
from stair_inspector.params import LevelsParams, PatchesParams
from stair_inspector.pipeline import inspect
from stair_inspector.simulation.scanner import scan as scan_building
from stair_inspector.simulation.scanner_specs import PROFILES, Scanner
from stair_inspector.simulation.scenes import SCENES
from stair_inspector.simulation.specs import Stair
from stair_inspector.simulation.staircase import build
from stair_inspector.stages import orient
from stair_inspector.stages.levels import select_horizontal
from stair_inspector.stages.sparse import find_sparse, follow_spacing
from tests.synthetic import Stair as Synthetic
from tests.synthetic import exact_params, make_scan

TLS = replace(find_preset("tls").params, unit="m", up="z")
FAR = replace(
    PROFILES["tls_good"],
    stations=2,
    standoff_m=7.0,
    azimuth_step_deg=0.25,
    elevation_step_deg=0.25,
    spacing_m=0.022,
    noise_m=0.002,
)
NINE = Stair(
    n_risers=9, rise_m=0.178, going_m=0.285, width_m=1.15, overhang_m=0.02, floor_front_m=7.5, upper_landing_m=3.0
)
DEFECTS = replace(NINE, rise_errors_m="5:0.015", going_errors_m="3:-0.02", fall_errors_deg="7:4", wall="left")
VARIANTS = {
    "wall": (replace(NINE, wall="left"), replace(FAR, seed=11)),
    "steep": (
        replace(NINE, n_risers=8, rise_m=0.185, going_m=0.25, width_m=0.9, yaw_deg=-70.0),
        replace(FAR, seed=12, spacing_m=0.025),
    ),
    "no_overhang": (
        replace(NINE, n_risers=6, rise_m=0.15, going_m=0.33, width_m=1.6, overhang_m=0.0),
        replace(FAR, seed=13, spacing_m=0.03),
    ),
    "landing": (
        replace(NINE, n_risers=12, rise_m=0.172, landing_after=6, width_m=1.2),
        replace(FAR, seed=14, stations=3),
    ),
}


@cache
def cut(stair: Stair, scanner: Scanner):
    """A scan of the stair and two metres of floor and landing at its ends, and what was built."""
    building = build(replace(stair, yaw_deg=0.0))
    points = scan_building(building, scanner).points
    top = max(step.nosing[0][0] for step in building.steps)
    points = points[(points[:, 0] > -2.0) & (points[:, 0] < top + 1.2)]
    turn = np.radians(stair.yaw_deg)
    rotation = np.array([[np.cos(turn), -np.sin(turn), 0.0], [np.sin(turn), np.cos(turn), 0.0], [0.0, 0.0, 1.0]])
    return make_scan(points @ rotation.T), building.steps


def heights_of(scan: Scan, params):
    normals = orient.find_normals(scan, params.normals)
    return orient.order_by_height(scan, normals, orient.find_up(scan, normals, "z", params.floor, "survey"))


@pytest.mark.parametrize("name", VARIANTS)
def test_every_step_of_a_sparse_scan_is_found_and_measured(name):
    stair, scanner = VARIANTS[name]
    scan, truth = cut(stair, scanner)
    inspection = inspect(scan, TLS)
    assert len(inspection.steps) == len(truth) == stair.n_risers
    rises = [1000.0 * (step.rise_m.value - true.rise_m) for step, true in zip(inspection.steps, truth, strict=True)]
    assert np.abs(rises).max() <= 1.5
    treads = [pair for pair in zip(inspection.steps, truth, strict=True) if pair[1].kind == "tread"]
    goings = [1000.0 * (step.going_m.value - true.going_m) for step, true in treads if true.going_m and step.going_m]
    assert len(goings) >= len(treads) - 1
    assert np.abs(goings).mean() <= 3.0
    widths = [1000.0 * (step.width_m.value - true.width_m) for step, true in treads]
    assert abs(np.mean(widths)) <= 6.0
    assert all(abs(step.width_m.value - true.width_m) <= step.width_m.u for step, true in treads)
    assert [found.code for found in inspection.examination].count("sparse") == 1


@pytest.mark.slow
def test_a_defect_of_one_step_stays_as_large_as_it_is():
    scan, truth = cut(DEFECTS, replace(FAR, seed=21))
    steps = inspect(scan, TLS).steps
    assert len(steps) == 9
    assert 1000.0 * steps[4].rise_m.value == pytest.approx(193.0, abs=1.5)
    assert 1000.0 * steps[2].going_m.value == pytest.approx(265.0, abs=3.0)
    assert steps[6].fall_deg.value == pytest.approx(4.0, abs=max(0.5, steps[6].fall_deg.u))
    assert abs(steps[5].fall_deg.value) <= steps[5].fall_deg.u
    for step, true in zip(steps, truth, strict=True):
        assert abs(step.rise_m.value - true.rise_m) <= max(step.rise_m.u, 0.0015)


def test_a_step_that_is_narrower_keeps_its_own_width():
    scan, _ = cut(NINE, replace(FAR, seed=31))
    # Of the fourth tread and its riser the left 200 mm are missing.
    low, high = 3 * 0.178 + 0.02, 4 * 0.178 + 0.02
    is_gone = (scan.points[:, 2] > low) & (scan.points[:, 2] < high) & (scan.points[:, 1] > 0.375)
    steps = inspect(make_scan(scan.points[~is_gone]), TLS).steps
    assert len(steps) == 9
    assert 1000.0 * steps[3].width_m.value < 1000.0
    others = [1000.0 * step.width_m.value for k, step in enumerate(steps[:-1]) if k not in (2, 3)]
    assert np.abs(np.array(others) - 1150.0).max() <= 8.0


@pytest.mark.parametrize(
    "name",
    [
        "ramp",
        "blocks",
        *(pytest.param(name, marks=pytest.mark.slow) for name in SCENES if name not in ("ramp", "blocks")),
    ],
)
def test_scenes_without_stairs_stay_without_however_sparse(name):
    scanner = replace(FAR, spacing_m=0.03, seed=3)
    inspection = inspect(make_scan(scan_building(SCENES[name](), scanner).points), TLS)
    assert not inspection.steps
    assert "sparse" in [found.code for found in inspection.examination]


def test_a_dense_scan_keeps_its_very_heights():
    params = exact_params()
    heights = heights_of(Synthetic(spacing=0.01, risers=True, noise=0.001).scan(), params)
    found = find_sparse(heights)
    assert not found.is_sparse
    assert found.heights is heights


def test_only_what_lies_amid_an_edge_gets_another_alignment():
    stair = Synthetic(spacing=0.035, risers=True, noise=0.001, n_steps=6)
    heights = heights_of(stair.scan(), TLS)
    found = find_sparse(heights)
    assert found.is_sparse
    z = heights.coordinates_m[2]
    level = np.min(np.abs(z[:, None] - stair.rise * np.arange(7)), axis=1) < 0.004
    cosine = np.cos(np.radians(15.0))
    before, after = heights.alignment >= cosine, found.heights.alignment >= cosine
    assert np.mean(after[level]) > max(0.9, np.mean(before[level]))
    assert np.mean(after[~level]) < 0.05
    same = found.heights.alignment == heights.alignment
    assert same[(z < 0.004) & (np.abs(z) < 0.004)].mean() > 0.6


def test_m_and_the_cell_follow_the_spacing_but_only_one_way():
    heights = heights_of(Synthetic(spacing=0.035, risers=True, noise=0.001).scan(), TLS)
    horizontal = select_horizontal(find_sparse(heights).heights, TLS.horizontal)
    fitted = follow_spacing(horizontal, LevelsParams(min_points=100), PatchesParams(cell_m=0.02))
    assert 10 <= fitted.levels.min_points < 40
    assert 0.05 <= fitted.patches.cell_m <= 0.1
    (found,) = fitted.observations
    assert found.level == "info"
    assert f"levels.min_points (m) 100 as {fitted.levels.min_points}" in found.message
    # What is set smaller, or larger, than the spacing asks for is taken as it is, and nothing is said.
    obeyed = follow_spacing(horizontal, LevelsParams(min_points=8), PatchesParams(cell_m=0.1))
    assert (obeyed.levels.min_points, obeyed.patches.cell_m, obeyed.observations) == (8, 0.1, ())


def test_the_papers_method_takes_the_settings_as_they_are():
    scan, _ = cut(*VARIANTS["wall"])
    inspection = inspect(scan, replace(TLS, method="paper"))
    assert "sparse" not in [found.code for found in inspection.examination]
    assert not {"sparse", "spacing"} & inspection.timings_s.keys()
