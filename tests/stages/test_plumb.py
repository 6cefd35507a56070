"""Floor against treads: which of them gives the vertical, and how sure it is."""

import math
from dataclasses import replace

import numpy as np
import pytest

from stair_inspector.model import Normals, Up
from stair_inspector.params import FlightsParams, FloorParams
from stair_inspector.stages.orient import find_up
from stair_inspector.stages.plumb import refine_up
from tests.synthetic import Stair, make_scan, rotation

STAIR = Stair(n_steps=8, spacing=0.03, floor_depth=2.0, noise=0.001, seed=8)
LEVEL = np.array([0.0, 0.0, 1.0])


def leaning(stair, part_ids, degrees, axis="y"):
    """Points and normals of a stair of which some parts (0 the floor) lean about the middle of their back edge."""
    parts, rng = [], np.random.default_rng(stair.seed)
    for k, (points, normals) in enumerate(stair.parts()):
        turn = rotation(axis, degrees) if k in part_ids else np.eye(3)
        pivot = np.array([points[:, 0].max(), points[:, 1].mean(), points[:, 2].mean()])
        noisy = (points - pivot) @ turn.T + pivot + rng.normal(0.0, stair.noise, points.shape)
        parts.append((noisy, normals @ turn.T))
    return tuple(np.concatenate(arrays) for arrays in zip(*parts, strict=True))


def refined(points, normals, turn=None):
    """Up as the floor gives it, and as it is after the comparison with the treads, for a scan turned as a whole."""
    turn = np.eye(3) if turn is None else turn
    scan = make_scan(points @ turn.T, normals @ turn.T)
    found = Normals(scan.normals)
    by_floor = find_up(scan, found, "auto", FloorParams(), "survey")
    return by_floor, refine_up(scan, found, by_floor)


def degrees_between(a, b):
    return math.degrees(math.atan2(float(np.linalg.norm(np.cross(a, b))), float(a @ b)))


def codes(up):
    return [note.code for note in up.notes]


def test_where_floor_and_treads_agree_the_floor_is_taken_and_its_uncertainty_known():
    by_floor, up = refined(*STAIR.sample())
    np.testing.assert_array_equal(up.vector, by_floor.vector)
    assert up.source == "floor"
    assert "up_disagree" not in codes(up)
    assert 0.0 < up.u_deg < 0.1
    assert degrees_between(up.vector, LEVEL) <= 2.0 * up.u_deg


def test_a_sloping_floor_before_level_treads_gives_way_to_them():
    by_floor, up = refined(*leaning(STAIR, {0}, 2.0))
    assert degrees_between(by_floor.vector, LEVEL) == pytest.approx(2.0, abs=0.2)
    # The z axis of the scan is that of the treads.
    assert up.source == "treads"
    assert degrees_between(up.vector, LEVEL) < 0.1
    (note,) = [note for note in up.notes if note.code == "up_disagree"]
    assert note.message.startswith("floor and treads disagree about the vertical by 2.0°")
    assert "moves each rise by about 10 mm" in note.message
    assert "up is taken from the treads, because the scan's z axis is nearer to it" in note.message
    assert 0.0 < up.u_deg < 0.2


def test_treads_that_all_slope_before_a_level_floor_leave_up_to_it():
    treads = set(range(1, STAIR.n_steps + 1))
    by_floor, up = refined(*leaning(STAIR, treads, 1.5))
    np.testing.assert_array_equal(up.vector, by_floor.vector)
    assert up.source == "floor"
    assert degrees_between(up.vector, LEVEL) < 0.1
    (note,) = [note for note in up.notes if note.code == "up_disagree"]
    assert "up is taken from the floor, because the scan's z axis is nearer to it" in note.message


@pytest.mark.parametrize("turn", [rotation("x", 40.0), rotation("y", -25.0) @ rotation("z", 70.0)], ids=["x", "y_z"])
def test_where_z_tells_nothing_treads_that_agree_with_each_other_win(turn):
    _, up = refined(*leaning(STAIR, {0}, 2.0), turn)
    assert up.source == "treads"
    assert degrees_between(up.vector, turn @ LEVEL) < 0.1
    (note,) = [note for note in up.notes if note.code == "up_disagree"]
    assert "because 8 treads agree with each other" in note.message


def test_where_z_tells_nothing_treads_at_sixes_and_sevens_lose():
    turn = rotation("x", 40.0)
    points, normals = leaning(STAIR, {0}, 2.0)
    lean = np.tan(np.radians(np.linspace(-4.0, 4.0, STAIR.n_steps)))
    order = np.random.default_rng(1).permutation(STAIR.n_steps)
    # Every tread leans its own way, by some degrees.
    for k in range(STAIR.n_steps):
        own = np.abs(points[:, 2] - (k + 1) * STAIR.rise) < 0.01
        middle = points[own, :2].mean(axis=0)
        points[own, 2] += (points[own, :2] - middle) @ [lean[k], lean[order[k]]]
    by_floor, up = refined(points, normals, turn)
    assert up.source == "floor"
    np.testing.assert_array_equal(up.vector, by_floor.vector)


def test_one_tilted_tread_does_not_matter():
    plain = refined(*STAIR.sample())[1]
    by_floor, up = refined(*leaning(STAIR, {4}, 3.0))
    assert up.source == "floor"
    np.testing.assert_array_equal(up.vector, by_floor.vector)
    assert "up_disagree" not in codes(up)
    assert up.u_deg == pytest.approx(plain.u_deg, rel=0.5)


def test_fewer_than_three_treads_do_not_overrule_a_floor():
    few = replace(STAIR, n_steps=2)
    by_floor, up = refined(*leaning(few, {0}, 2.0))
    assert up.source == "floor"
    np.testing.assert_array_equal(up.vector, by_floor.vector)


def test_without_stairs_up_stays_as_it_was():
    points, normals = replace(STAIR, n_steps=0).sample()
    by_floor, up = refined(points, normals)
    assert up is by_floor
    assert up.u_deg is None


@pytest.mark.slow
def test_the_uncertainty_is_of_the_size_of_the_error_of_a_bumpy_floor():
    for seed in range(10):
        # Bumps of 2 mm in half a metre: what a screed has.
        points, normals = replace(STAIR, seed=seed).sample()
        phase = np.random.default_rng(seed).uniform(0.0, 2.0 * np.pi, 2)
        is_floor = points[:, 0] < 0.0
        points[is_floor, 2] += 0.002 * (np.sin(12.0 * points[is_floor, :2] + phase)).sum(axis=1)
        _, up = refined(points, normals)
        assert up.u_deg < 0.2
        assert degrees_between(up.vector, LEVEL) <= 2.0 * up.u_deg


def test_a_smaller_floor_is_less_sure():
    u = [refined(*replace(STAIR, floor_depth=depth).sample())[1].u_deg for depth in (0.8, 2.4)]
    assert u[0] > u[1]


def test_without_a_floor_to_begin_at_up_is_not_perfectly_known():
    _, up = refined(*replace(STAIR, floor_depth=0.6).sample())
    assert up.u_deg is None or up.u_deg > 0.0


@pytest.mark.parametrize("slope_deg", [5.0, pytest.param(8.0, marks=pytest.mark.slow)])
def test_a_ramp_larger_than_the_floor_is_not_up(slope_deg):
    points, normals = STAIR.sample()
    rng = np.random.default_rng(6)
    n, tangent = 10_000, math.tan(math.radians(slope_deg))
    x = rng.uniform(-1.0, 4.0, n)
    ramp = np.column_stack([x, rng.uniform(1.2, 2.4, n), tangent * (x + 1.0)])
    normal = np.array([-tangent, 0.0, 1.0]) / math.hypot(1.0, tangent)
    by_floor, up = refined(np.concatenate([points, ramp]), np.concatenate([normals, np.tile(normal, (n, 1))]))
    assert degrees_between(by_floor.vector, LEVEL) > 1.0
    assert degrees_between(up.vector, LEVEL) < 0.2
    assert up.source == "treads"


def test_a_wall_larger_than_the_floor_is_not_up():
    points, normals = STAIR.sample()
    rng = np.random.default_rng(5)
    n = 20_000
    wall = np.column_stack([rng.uniform(-2.0, 2.5, n), np.full(n, 1.001), rng.uniform(0.0, 3.0, n)])
    _, up = refined(np.concatenate([points, wall]), np.concatenate([normals, np.tile([0.0, 1.0, 0.0], (n, 1))]))
    assert degrees_between(up.vector, LEVEL) < 0.1


@pytest.mark.slow
def test_up_is_the_same_after_a_million_points_are_thinned():
    # 36 cells to a point of the other: more than the points used, so that a random share decides.
    dense = replace(STAIR, n_steps=5, spacing=0.004)
    points, normals = leaning(dense, {0}, 2.0)
    assert len(points) > 150_000
    _, up = refined(points, normals)
    assert up.source == "treads"
    assert degrees_between(up.vector, LEVEL) < 0.05


def test_neither_scan_nor_up_is_changed():
    points, normals = leaning(STAIR, {0}, 2.0)
    scan = make_scan(points, normals)
    up = Up(np.array([0.0, 0.0, 1.0]), "floor")
    before = scan.points.copy()
    first = refine_up(scan, Normals(scan.normals), up)
    second = refine_up(scan, Normals(scan.normals), up)
    np.testing.assert_array_equal(scan.points, before)
    np.testing.assert_array_equal(first.vector, second.vector)
    assert up.u_deg is None


def test_a_wider_limit_of_the_rise_reaches_the_treads_that_give_the_vertical():
    # Of rises that only wider limits let in: with the usual ones there is no flight, and the sloping floor is all.
    steep = Stair(n_steps=8, rise=0.33, spacing=0.03, floor_depth=2.0, noise=0.001, seed=8)
    points, normals = leaning(steep, {0}, 2.0)
    scan, floor = make_scan(points, normals), Up(rotation("y", 2.0)[:, 2], "floor")
    found = Normals(scan.normals)
    assert refine_up(scan, found, floor).source == "floor"
    up = refine_up(scan, found, floor, FlightsParams(max_rise_m=0.5).at_least_usual)
    assert up.source == "treads"
    assert degrees_between(up.vector, LEVEL) == pytest.approx(0.0, abs=0.1)


def test_a_large_scan_that_repeats_points_is_thinned_too():
    points = np.random.default_rng(1).uniform(-1.0, 1.0, (150_001, 3))
    scan = replace(make_scan(points), repeats=np.full(len(points), 2))
    normals = Normals(np.tile([0.0, 0.0, 1.0], (len(points), 1)))
    up = Up(np.array([0.0, 0.0, 1.0]), "floor")
    found = refine_up(scan, normals, up)
    assert found.vector.tolist() == up.vector.tolist()


@pytest.mark.parametrize("degrees", [0.0, 3.0])
def test_a_camera_that_sees_a_strip_of_floor_alone_takes_up_from_the_treads(degrees):
    # Of a floor of 0.2 m its lean is hardly known, and a little unevenness is much of it.
    strip = replace(STAIR, floor_depth=0.2, risers=True)
    _, up = refined(*leaning(strip, {0}, degrees), rotation("x", 70.0))
    assert up.source == "treads"
    # Which side is up, nothing else in this scan tells.
    off_deg = degrees_between(up.vector, rotation("x", 70.0) @ LEVEL)
    assert min(off_deg, 180.0 - off_deg) < 0.1
    # So level are treads built.
    assert 0.2 <= up.u_deg < 0.3
