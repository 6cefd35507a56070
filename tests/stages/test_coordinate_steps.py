"""On which step coordinates lie: decimals, units, float32, voxels; and on none where there is none."""

import dataclasses

import numpy as np
import pytest

from stair_inspector.files.cleaning import to_local_metres
from stair_inspector.model import Scan
from stair_inspector.stages.coordinate_steps import find_steps
from stair_inspector.units import METRES_PER_UNIT
from tests.synthetic import Stair, rotation

STAIR = Stair(n_steps=5, spacing=0.012, noise=0.002, risers=True, floor_depth=1.2)
POINTS = STAIR.sample()[0]
UTM = np.array([389412.3, 5819322.1, 42.0])


def scan_of(points, unit="m"):
    """A scan of a file that holds ``points`` in its unit, as the reader makes one."""
    local, origin_m = to_local_metres(np.ascontiguousarray(points), unit)
    return Scan(np.unique(local, axis=0), origin_m, "a.ply", "", unit, len(points))


def steps_mm(points, unit="m"):
    return find_steps(scan_of(points, unit)).steps_m * 1000.0


def as_float32(points):
    return points.astype(np.float32).astype(np.float64)


def voxels(points, edge, place=0.5):
    return np.unique((np.floor(points / edge) + place) * edge, axis=0)


@pytest.mark.parametrize("step_mm", [0.1, 0.25, 1, 2, 5, 10, 50])
@pytest.mark.parametrize("shift", [np.zeros(3), UTM], ids=["near", "utm"])
def test_decimals_of_a_metre(step_mm, shift):
    rounded = np.round((POINTS + shift) * 1000.0 / step_mm) * step_mm / 1000.0
    found = find_steps(scan_of(rounded))
    np.testing.assert_allclose(found.steps_m * 1000.0, step_mm, rtol=1e-6)
    assert found.kinds == ("rounded",) * 3
    np.testing.assert_allclose(found.shares, 1.0, atol=0.01)


@pytest.mark.parametrize(
    ("unit", "step"), [("in", 1 / 16), ("in", 1 / 32), ("in", 0.01), ("ft", 0.001), ("mm", 1.0), ("cm", 0.1)]
)
def test_steps_of_other_units(unit, step):
    in_unit = np.round(POINTS / METRES_PER_UNIT[unit] / step) * step
    found = find_steps(scan_of(in_unit, unit))
    np.testing.assert_allclose(found.steps_m, step * METRES_PER_UNIT[unit], rtol=1e-6)
    assert found.kinds == ("rounded",) * 3


@pytest.mark.parametrize(
    ("points", "stated_m", "expected_m", "kind"),
    [
        (POINTS, 0.001, 0.001, "rounded"),
        (POINTS, 1e-5, 0.0, ""),
        (POINTS.round(2), 0.001, 0.01, "rounded"),
        (POINTS.round(4), 0.002, 0.002, "rounded"),
    ],
    ids=["full precision", "finer than counts", "coarser numbers", "finer numbers"],
)
def test_what_a_file_states_of_its_numbers_counts_at_least(points, stated_m, expected_m, kind):
    found = find_steps(dataclasses.replace(scan_of(points), stated_steps_m=np.full(3, stated_m)))
    np.testing.assert_allclose(found.steps_m, expected_m, rtol=1e-6)
    assert found.kinds == (kind,) * 3


def test_an_integer_format_of_any_scale():
    scale = 0.000731
    np.testing.assert_allclose(steps_mm(np.round(POINTS / scale) * scale + 0.0123), 0.731, rtol=1e-6)


def test_millimetres_kept_as_float32_are_millimetres():
    np.testing.assert_allclose(steps_mm(as_float32(POINTS.round(3))), 1.0, rtol=1e-6)


@pytest.mark.parametrize("shift", [np.zeros(3), UTM, [12.0, 640.0, -30.0]], ids=["near", "utm", "site"])
def test_full_precision_has_no_step(shift):
    assert not steps_mm(POINTS + shift).any()


def test_float32_near_zero_is_full_precision():
    assert not steps_mm(as_float32(POINTS)).any()
    assert not steps_mm(as_float32(POINTS * 1000.0), "mm").any()


def test_float32_far_from_zero_resolves_what_its_numbers_say():
    found = find_steps(scan_of(as_float32(POINTS + UTM)))
    # 2^18 <= x < 2^19 and 2^22 <= y < 2^23 with 24 bits each.
    np.testing.assert_allclose(found.steps_m, [2.0**-5, 2.0**-1, 0.0])
    assert found.kinds == ("float32", "float32", "")
    # In millimetres, the same.
    np.testing.assert_allclose(steps_mm(as_float32((POINTS + UTM) * 1000.0), "mm")[:2], [32.0, 512.0])


@pytest.mark.parametrize("edge", [0.008, 0.02, 0.037])
@pytest.mark.parametrize("place", [0.0, 0.5])
def test_a_voxel_lattice(edge, place):
    found = find_steps(scan_of(voxels(POINTS, edge, place)))
    np.testing.assert_allclose(found.steps_m, edge, rtol=1e-6)
    assert not found.is_turned
    if place:
        assert found.kinds == ("lattice",) * 3


@pytest.mark.parametrize("edge", [0.02, 0.037])
@pytest.mark.parametrize("turn", [rotation("z", 31), rotation("z", 31) @ rotation("x", 12)], ids=["yaw", "tilt"])
def test_a_lattice_that_was_turned_afterwards(edge, turn):
    centres = voxels(POINTS, edge)
    few = centres[np.random.default_rng(1).random(len(centres)) < 0.7]
    for points in (centres, as_float32(few)):
        found = find_steps(scan_of(points @ turn.T))
        np.testing.assert_allclose(found.steps_m, edge, rtol=1e-3)
        assert found.is_turned


def test_a_lattice_of_which_only_half_of_the_points_are():
    centres = voxels(POINTS, 0.03)
    rest = POINTS[:: len(POINTS) // len(centres)]
    found = find_steps(scan_of(np.concatenate([centres, rest])))
    np.testing.assert_allclose(found.steps_m, 0.03, rtol=1e-6)
    np.testing.assert_allclose(found.shares, 0.5, atol=0.03)


def test_one_station_in_millimetres_and_one_in_full_precision():
    mixed = POINTS.copy()
    mixed[::2] = mixed[::2].round(3)
    np.testing.assert_allclose(steps_mm(mixed), 1.0, rtol=1e-6)


def test_a_grid_map_has_steps_in_plan_and_none_in_height():
    in_cells = POINTS.copy()
    in_cells[:, :2] = (np.floor(in_cells[:, :2] / 0.02) + 0.5) * 0.02
    np.testing.assert_allclose(steps_mm(in_cells), [20.0, 20.0, 0.0], rtol=1e-6)


@pytest.mark.parametrize("rise", [0.17, 0.2])
@pytest.mark.parametrize("risers", [True, False])
def test_the_few_heights_of_a_perfect_stair_are_no_step(rise, risers):
    points = Stair(n_steps=8, spacing=0.012, rise=rise, risers=risers).sample()[0]
    assert not steps_mm(points).any()
    assert not steps_mm(as_float32(points)).any()


def test_points_are_not_changed_and_few_points_are_no_trouble():
    scan = scan_of(POINTS[:60])
    before = scan.points.copy()
    assert not find_steps(scan).steps_m.any()
    np.testing.assert_array_equal(scan.points, before)
    assert not find_steps(scan_of(np.zeros((1, 3)))).steps_m.any()


@pytest.mark.parametrize("noise", [0.0008, 0.001, 0.0015])
def test_a_level_floor_does_not_make_a_step_coarser(noise):
    # Floor and kerb lie at multiples of 20 mm, and so do most of their rounded points.
    rng = np.random.default_rng(2)
    points = rng.uniform(0.0, 3.0, (30_000, 3))
    points[:, 2] = np.where(points[:, 0] < 1.5, 0.0, 0.12) + rng.normal(0.0, noise, len(points))
    found = steps_mm(np.round(points / 0.005) * 0.005)
    np.testing.assert_allclose(found[:2], 5.0, rtol=1e-6)
    # Where no point has left the height of its surface, nothing can be known.
    assert found[2] == pytest.approx(5.0) or noise < 0.001
