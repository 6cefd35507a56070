"""Treads of bars: gratings and planks are one tread each, of the width and the place that they have."""

import functools
from dataclasses import replace

import numpy as np
import pytest

from stair_inspector.geometry.rims import find_rim_edge
from stair_inspector.params import HorizontalParams, NormalsParams, Params
from stair_inspector.pipeline import inspect
from stair_inspector.simulation.scanner import scan as scan_building
from stair_inspector.stages import levels as find
from stair_inspector.stages import orient
from stair_inspector.stages.bar_peaks import find_peaks
from stair_inspector.stages.bars import join_bars
from stair_inspector.stages.patches import split_levels
from tests.benchmarks import hostile_buildings as buildings
from tests.benchmarks.hostile_kinds import TLS
from tests.synthetic import Stair, make_scan

STAIR = buildings.Plain(n_risers=4)
PARAMS = Params(up="z", unit="m")


@functools.lru_cache(maxsize=4)
def barred(bar_m, gap_m, is_along, seed=3):
    """What is found of a stair of bars, scanned by two stations with little noise."""
    built = buildings.of_bars(STAIR, bar_m, gap_m, is_along)
    points = scan_building(built.building, replace(TLS, seed=seed, spacing_m=0.008)).points
    return inspect(make_scan(points), PARAMS)


SIZES = [
    pytest.param(0.03, 0.04, True, id="bars of 30 mm along the climb"),
    pytest.param(0.03, 0.04, False, marks=pytest.mark.slow, id="bars of 30 mm across"),
    pytest.param(0.02, 0.01, True, marks=pytest.mark.slow, id="20 and 10 mm along"),
    pytest.param(0.02, 0.06, True, marks=pytest.mark.slow, id="20 and 60 mm along"),
    pytest.param(0.06, 0.06, True, marks=pytest.mark.slow, id="60 and 60 mm along"),
    pytest.param(0.02, 0.03, False, marks=pytest.mark.slow, id="20 and 30 mm across"),
    pytest.param(
        0.06,
        0.012,
        False,
        marks=[
            pytest.mark.slow,
            pytest.mark.xfail(
                reason="the sides of narrow gaps look like a second layer: U of the rises is 5 mm, not 3"
            ),
        ],
        id="60 and 12 mm across",
    ),
    # As many as fit into the going: three, with gaps of 54 mm.
    pytest.param(0.06, 0.05, False, marks=pytest.mark.slow, id="60 and 54 mm across"),
]


@pytest.mark.parametrize(("bar_m", "gap_m", "is_along"), SIZES)
def test_a_tread_of_bars_is_one_tread_of_its_own_width(bar_m, gap_m, is_along):
    inspection = barred(bar_m, gap_m, is_along)
    assert len(inspection.steps) == STAIR.n_risers
    for step in inspection.steps[:-1]:
        assert abs(step.width_m.value - STAIR.width_m) <= step.width_m.u
        assert step.width_m.u < 0.02
        assert abs(step.going_m.value - STAIR.going_m) < 0.0015
        assert abs(step.rise_m.value - STAIR.rise_m) < 0.0006
        assert step.rise_m.u < 0.003


@pytest.mark.parametrize(("bar_m", "gap_m", "is_along"), SIZES[:2])
def test_no_bar_of_a_tread_is_furniture(bar_m, gap_m, is_along):
    inspection = barred(bar_m, gap_m, is_along)
    heights = [step.nosing[:, 2].mean() for step in inspection.steps[:-1]]
    apart = [patch for patch in inspection.patches if patch.kind == "rejected"]
    assert not [patch for patch in apart if min(abs(patch.height_m - height) for height in heights) < 0.01]


def joined(points):
    """The horizontal points and surfaces before and after bars are put together."""
    scan = make_scan(points)
    normals = orient.find_normals(scan, NormalsParams())
    heights = orient.order_by_height(scan, normals, orient.find_up(scan, normals, "z", PARAMS.floor, "survey"))
    horizontal = find.select_horizontal(heights, HorizontalParams())
    reach = find.find_height_reach(horizontal, PARAMS.levels.eps_m)
    levels = find.find_levels(horizontal, reach, PARAMS.levels)
    patches = split_levels(horizontal, levels, PARAMS.patches, PARAMS.levels)
    peaks = find_peaks(heights, patches.cell_m)
    return (horizontal, patches), join_bars(heights, peaks, horizontal, patches, PARAMS.patches.min_area_m2)


@pytest.mark.parametrize("noise", [0.0005, 0.002])
def test_where_there_are_no_bars_nothing_is_touched(noise):
    points, _ = Stair(n_steps=4, spacing=0.01, risers=True, noise=noise).sample()
    (horizontal, patches), (wider, same) = joined(points)
    assert wider is horizontal
    assert same is patches


def planks(y_low, y_high, seed, bar=0.04, gap=0.03, height=0.17):
    """Bars along x, of 0.28 m, with their sides, from one place across to another."""
    rng = np.random.default_rng(seed)
    parts = []
    for low in np.arange(y_low, y_high - bar + 1e-6, bar + gap):
        n_top, n_side = round(0.28 * bar * 15_000), round(0.28 * 0.03 * 15_000)
        parts.append(np.stack([rng.uniform(0, 0.28, n_top), rng.uniform(low, low + bar, n_top), np.zeros(n_top)], 1))
        parts += [
            np.stack([rng.uniform(0, 0.28, n_side), np.full(n_side, side), rng.uniform(-0.03, 0, n_side)], 1)
            for side in (low, low + bar)
        ]
    points = np.concatenate(parts) + np.array([0.0, 0.0, height])
    return points + rng.normal(0.0, 0.0005, points.shape)


@pytest.mark.parametrize(("apart", "n_treads"), [(0.03, 1), (0.15, 2), (0.3, 2)])
def test_two_treads_of_bars_side_by_side_stay_two(apart, n_treads):
    # Twelve bars each; with a gap as between the bars they are one tread.
    first, second = planks(0.0, 0.82, 5), planks(0.81 + apart, 1.63 + apart, 6)
    floor = np.random.default_rng(7).uniform([-0.8, -0.5, 0.0], [0.0, 2.0, 0.0001], (20_000, 3))
    _, (_, patches) = joined(np.concatenate([floor, first, second]))
    treads = [surface for surface in patches.surfaces if surface.is_barred]
    assert len(treads) == n_treads
    widths = [float(np.ptp(surface.cells_m[1])) for surface in treads]
    expected = 0.81 if n_treads == 2 else 1.62 + apart
    assert all(abs(width - expected) < 0.03 for width in widths)
    assert all(abs(surface.height_m - 0.17) < 0.001 for surface in treads)


@pytest.mark.parametrize("seed", range(3))
def test_the_rim_of_bars_along_it_lies_within_its_noise(seed):
    rng = np.random.default_rng(seed)
    # The outermost bar ends at 0.5.
    out = np.concatenate([rng.uniform(low, low + 0.02, 400) for low in (0.38, 0.43, 0.48)])
    along = rng.uniform(0.0, 0.3, len(out))
    edge = find_rim_edge(out, along, (0.0, 0.3), 0.49, 0.0005, is_square=True)
    assert edge.support == 1.0
    assert edge.noise_m < 0.003
    assert abs(edge.middle_m - 0.5) <= 2.0 * edge.noise_m


def test_a_rim_without_points_is_none():
    assert find_rim_edge(np.zeros(5), np.linspace(0.1, 0.2, 5), (0.0, 0.3), 0.0, 0.001) is None


def bars_across(bar, gap, n_bars, seed, width=1.0, rise=0.17, going=0.28, density=12_000):
    """Four treads of bars that run across the climb, 30 mm high, with the fronts of all bars, and a floor."""
    rng = np.random.default_rng(seed)
    parts = [rng.uniform([-0.9, -0.3, 0.0], [1.2, width + 0.3, 1e-6], (12_000, 3))]
    for k in range(1, 5):
        for low in (k - 1) * going + np.arange(n_bars) * (bar + gap):
            n_top, n_side = round(bar * width * density), round(0.03 * width * density)
            parts.append(rng.uniform([low, 0.0, k * rise], [low + bar, width, k * rise + 1e-6], (n_top, 3)))
            parts.append(rng.uniform([low, 0.0, k * rise - 0.03], [low + 1e-6, width, k * rise], (n_side, 3)))
    points = np.concatenate(parts)
    return points + rng.normal(0.0, 0.0007, points.shape)


@pytest.mark.parametrize(("bar", "gap", "n_bars"), [(0.06, 0.0133, 4), (0.025, 0.026, 6)])
def test_fronts_of_bars_across_the_climb_move_neither_rises_nor_sides(bar, gap, n_bars):
    inspection = inspect(make_scan(bars_across(bar, gap, n_bars, 2)), PARAMS)
    assert len(inspection.steps) == 4
    for step in inspection.steps:
        assert abs(step.width_m.value - 1.0) <= step.width_m.u < 0.015
        assert abs(step.rise_m.value - 0.17) < 0.0005
        assert step.rise_m.u < 0.002


def test_the_underside_of_a_thin_tread_is_no_side_of_bars():
    points, _ = Stair(n_steps=4, spacing=0.01, noise=0.0005).sample()
    treads = points[points[:, 2] > 0.1]
    (horizontal, patches), (wider, same) = joined(np.concatenate([points, treads - [0.0, 0.0, 0.012]]))
    assert wider is horizontal
    assert same is patches
