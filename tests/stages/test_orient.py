"""Normals, up and the order by height."""

from dataclasses import replace

import numpy as np
import pytest

from stair_inspector.errors import CannotMeasure, ConfigError
from stair_inspector.model import Normals, Up
from stair_inspector.params import FloorParams, NormalsParams
from stair_inspector.simulation.scanner import scan as scan_building
from stair_inspector.simulation.staircase import build
from stair_inspector.stages.orient import find_normals, find_up, order_by_height
from tests.benchmarks.accuracy import CLASSES, EVEN
from tests.synthetic import Stair, make_scan, motion, rotation

ESTIMATED = NormalsParams(k=12)


def random_points(n, seed=0):
    return np.random.default_rng(seed).uniform(0.0, 1.0, (n, 3))


def up_of(points, normals=None, method="survey"):
    scan = make_scan(points, normals)
    found = Normals(scan.normals) if normals is not None else find_normals(scan, ESTIMATED)
    return find_up(scan, found, "auto", FloorParams(), method)


def degrees_between(a, b):
    return np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b))


# --- normals -------------------------------------------------------------------------------------------------------


def test_fifty_points_are_enough():
    assert find_normals(make_scan(random_points(50)), ESTIMATED).vectors.shape == (50, 3)


@pytest.mark.parametrize(
    ("n", "text"), [(49, "49 distinct points,"), (3, "3 distinct points,"), (1, "1 distinct point,")]
)
def test_fewer_than_fifty_points_are_refused(n, text):
    with pytest.raises(CannotMeasure) as error:
        find_normals(make_scan(random_points(n)), ESTIMATED)
    assert str(error.value) == f"synthetic.ply: {text} at least 50 are needed; scan again or check the file"


@pytest.mark.parametrize(
    "points", [np.full((60, 3), 0.1), np.outer(np.linspace(0, 2, 60), [1.0, 2.0, 0.5])], ids=["all_equal", "collinear"]
)
def test_points_on_one_line_are_refused(points):
    with pytest.raises(CannotMeasure) as error:
        find_normals(make_scan(points), ESTIMATED)
    assert str(error.value) == "synthetic.ply: all 60 points lie on one line; check the file's columns"


def test_given_normals_are_taken_as_they_are():
    scan = Stair().scan()
    assert find_normals(scan, NormalsParams(source="given")).vectors is scan.normals


def test_given_normals_that_are_missing_are_a_wrong_setting():
    with pytest.raises(ConfigError) as error:
        find_normals(make_scan(random_points(60)), NormalsParams(source="given"))
    assert str(error.value) == "normals.source: synthetic.ply holds no normals; use 'estimate'"


# --- up ------------------------------------------------------------------------------------------------------------


def test_a_given_up_is_scaled_to_unit_length_and_looks_at_nothing():
    scan = make_scan(random_points(60))
    up = find_up(scan, Normals(scan.points), "0,-3,4", FloorParams(), "survey")
    np.testing.assert_array_equal(up.vector, [0.0, -0.6, 0.8])
    assert up.source == "given"


@pytest.mark.parametrize("tilt", [0.0, 3.0, 30.0])
def test_the_floor_gives_up_within_the_noise(tilt):
    stair = Stair(noise=0.002, floor_depth=1.6, spacing=0.03, motion=motion(rotation("x", tilt), (5.0, -3.0, 2.0)))
    points, normals = stair.sample()
    up = up_of(points, normals)
    assert up.source == "floor"
    n = round(1.6 / 0.02) * round(1.0 / 0.02)
    # Slope of a least-squares plane across its shorter side of 1 m; five standard deviations.
    slope_deg = np.degrees(0.002 / (1.0 / np.sqrt(12)) / np.sqrt(n))
    assert degrees_between(up.vector, stair.motion[:3, 2]) < 5 * slope_deg


def test_up_is_on_the_side_of_plus_z_although_a_plane_has_two():
    turned = Stair(motion=motion(rotation("x", 180.0)))
    up = up_of(*turned.sample())
    assert up.vector[2] > 0.99


def test_a_leaning_scan_takes_the_side_on_which_most_points_lie_and_says_so():
    stair = Stair(motion=motion(rotation("x", 90.0)))
    up = up_of(*stair.sample())
    assert degrees_between(up.vector, stair.motion[:3, 2]) < 0.1
    assert [note.code for note in up.notes if note.code != "without_open3d"] == ["up_not_z"]


def test_the_floor_is_the_plane_with_the_most_levels_not_the_largest_which_is_a_wall():
    stair = Stair(n_steps=8, floor_depth=0.8, noise=0.001, seed=3)
    points, normals = stair.sample()
    rng = np.random.default_rng(4)
    # A wall of 2.5 m height along the flight has twice the points of the largest level.
    wall = np.column_stack([rng.uniform(-0.8, 2.2, 4500), np.full(4500, -0.001), rng.uniform(0, 2.5, 4500)])
    wall_normals = np.tile([0.0, 1.0, 0.0], (len(wall), 1))
    up = up_of(np.concatenate([points, wall]), np.concatenate([normals, wall_normals]))
    assert degrees_between(up.vector, np.array([0.0, 0.0, 1.0])) < 0.5
    assert [note.code for note in up.notes if note.code != "without_open3d"] == ["floor_not_largest"]
    # The paper's floor is the largest plane and nothing else.
    by_paper = up_of(np.concatenate([points, wall]), np.concatenate([normals, wall_normals]), "paper")
    assert degrees_between(np.abs(by_paper.vector), np.array([0.0, 1.0, 0.0])) < 0.5


def test_a_ceiling_as_floor_is_noted():
    # The largest plane lies above nearly everything.
    stair = Stair(n_steps=3, floor_depth=0.4)
    points, normals = stair.sample()
    rng = np.random.default_rng(4)
    ceiling = np.column_stack([rng.uniform(-1, 2, 9000), rng.uniform(0, 1, 9000), np.full(9000, 2.4)])
    # Half of the ceiling's own points lie above the plane through them: put the scan's weight below it.
    below = np.column_stack([rng.uniform(-1, 2, 9000), rng.uniform(0, 1, 9000), rng.uniform(0.5, 2.3, 9000)])
    sideways = np.tile([1.0, 0.0, 0.0], (9000, 1))
    up = up_of(
        np.concatenate([points, ceiling, below]),
        np.concatenate([normals, np.tile([0.0, 0.0, 1.0], (9000, 1)), sideways]),
    )
    assert "floor_above_scan" in [note.code for note in up.notes]
    assert up.vector[2] > 0.99


def test_up_repeats_itself():
    points, normals = Stair(noise=0.004).sample()
    np.testing.assert_array_equal(up_of(points, normals).vector, up_of(points, normals).vector)


# --- heights -------------------------------------------------------------------------------------------------------


def test_eq3_heights_are_the_projection_on_up_in_ascending_order():
    points = np.array([[1.0, 0.0, 5.0], [0.0, 2.0, 5.0], [3.0, 3.0, 0.0]])
    normals = np.array([[0.0, 0.6, 0.8], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]])
    scan = make_scan(points, normals)
    order = order_by_height(scan, Normals(scan.normals), Up(np.array([0.0, 0.6, 0.8]), "given"))
    # 0.6 y + 0.8 z is 4.0, 5.2 and 1.8.
    np.testing.assert_array_equal(order.point_ids, [2, 0, 1])
    np.testing.assert_allclose(order.coordinates_m[2], [1.8, 4.0, 5.2], rtol=1e-15)
    np.testing.assert_allclose(order.alignment, [0.0, 1.0, 0.8], atol=1e-15)


@pytest.mark.parametrize("up", [(0, 0, 1), (1, 0, 0), (0, -1, 0), (0.6, 0.0, 0.8), (0.36, 0.48, -0.8)])
def test_level_coordinates_are_a_rotation_of_the_scans(up):
    scan = make_scan(random_points(200), random_points(200, 1))
    order = order_by_height(scan, Normals(scan.normals), Up(np.array(up, dtype=float), "given"))
    turn = order.level_from_scan
    np.testing.assert_allclose(turn @ turn.T, np.eye(3), atol=1e-15)
    assert np.linalg.det(turn) == pytest.approx(1.0)
    np.testing.assert_allclose(turn.T @ order.coordinates_m, scan.points[order.point_ids].T, atol=1e-15)
    assert (np.diff(order.coordinates_m[2]) >= 0.0).all()


# --- region --------------------------------------------------------------------------------------------------------


def ordered(region, origin_m=(0.0, 0.0, 0.0)):
    scan = make_scan(random_points(400), random_points(400, 1), origin_m=origin_m)
    up = Up(np.array([0.36, 0.48, 0.8]), "given")
    return scan, order_by_height(scan, Normals(scan.normals), up, region)


def test_a_region_keeps_the_points_of_its_box_in_the_same_order():
    scan, whole = ordered("")
    _, part = ordered("0.2,0.1,-1,0.9,0.6,0.5")
    inside = ((scan.points >= [0.2, 0.1, -1.0]) & (scan.points <= [0.9, 0.6, 0.5])).all(axis=1)
    assert 0 < len(part.point_ids) == np.count_nonzero(inside) < 400
    kept = inside[whole.point_ids]
    np.testing.assert_array_equal(part.point_ids, whole.point_ids[kept])
    np.testing.assert_array_equal(part.coordinates_m, whole.coordinates_m[:, kept])
    np.testing.assert_array_equal(part.alignment, whole.alignment[kept])
    assert part.n_scan == whole.n_scan == 400


def test_a_region_is_in_the_scans_frame_and_its_faces_belong_to_it():
    origin = (691_000.0, 5_335_000.0, 520.0)
    _, near = ordered("0.2,0.1,0,0.9,0.6,0.5")
    _, far = ordered("691000.2,5335000.1,520,691000.9,5335000.6,520.5", origin)
    np.testing.assert_array_equal(far.point_ids, near.point_ids)
    scan, _ = ordered("")
    x, y, z = (float(value) for value in scan.points[7])
    _, one = ordered(f"{x!r},{y!r},{z!r},{x + 1e-9!r},{y + 1e-9!r},{z + 1e-9!r}")
    np.testing.assert_array_equal(one.point_ids, [7])


def test_a_region_without_points_is_refused_by_name():
    with pytest.raises(ConfigError) as error:
        ordered("5,5,5,6,6,6")
    assert str(error.value) == (
        "overrules.region: no point of synthetic.ply lies in the box 5,5,5,6,6,6; check its corners"
    )


# --- the floor of the survey ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("share", [1.5, 4.0])
def test_a_wall_larger_than_the_floor_is_not_the_floor(share):
    points, normals = Stair(n_steps=6, floor_depth=1.2, noise=0.001).sample()
    rng = np.random.default_rng(5)
    n = int(share * 1.2 / 0.02 * 1.0 / 0.02)
    wall = np.column_stack([rng.uniform(-1.2, 2.0, n), np.full(n, 1.001), rng.uniform(0.0, 2.6, n)])
    up = up_of(np.concatenate([points, wall]), np.concatenate([normals, np.tile([0.0, 1.0, 0.0], (n, 1))]))
    assert degrees_between(up.vector, np.array([0.0, 0.0, 1.0])) < 0.5


def with_a_wall(points, normals, length_m, height_m):
    """A scan and beside it a wall as long and as high as a stairwell's."""
    rng = np.random.default_rng(5)
    n = int(length_m * height_m / 0.02**2)
    wall = np.column_stack([rng.uniform(0.0, length_m, n), np.full(n, 1.001), rng.uniform(0.0, height_m, n)])
    return np.concatenate([points, wall]), np.concatenate([normals, np.tile([0.0, 1.0, 0.0], (n, 1))])


TURNS = {
    "z up": np.eye(3),
    # As photogrammetry and phones write it: the risers are square to the axis that most scans have as up.
    "y up, climb along z": rotation("x", -90.0) @ rotation("z", 90.0),
    "leaning": rotation("x", 50.0) @ rotation("z", 33.0),
}


@pytest.mark.parametrize("turn", TURNS.values(), ids=TURNS)
@pytest.mark.parametrize("has_wall", [False, True], ids=["free", "wall"])
@pytest.mark.parametrize("n_steps", [2, *(pytest.param(each, marks=pytest.mark.slow) for each in (3, 5, 12, 30, 60))])
def test_up_is_square_to_the_treads_of_two_to_sixty_risers(n_steps, has_wall, turn):
    # Beside 15 m of floor a tread of sixty holds 0.9 % of what faces up, a riser 1.7 % of what faces forward.
    stair = Stair(n_steps=n_steps, floor_depth=15.0, risers=True, spacing=0.025, noise=0.001, seed=6)
    points, normals = stair.sample()
    if has_wall:
        points, normals = with_a_wall(points, normals, n_steps * stair.going, n_steps * stair.rise + 2.0)
    up = up_of(points @ turn.T, normals @ turn.T)
    assert degrees_between(up.vector, turn[:, 2]) < 0.1


@pytest.mark.slow
@pytest.mark.parametrize(
    "turn",
    [pytest.param(turn, marks=pytest.mark.slow if name != "z up" else (), id=name) for name, turn in TURNS.items()],
)
def test_a_long_stair_without_a_floor_is_told_by_the_way_its_levels_follow_each_other(turn):
    # Twice as many points on the risers, so that nothing but the pitch speaks for the treads.
    stair = Stair(n_steps=40, floor_depth=0.3, risers=True, spacing=0.025, noise=0.001, seed=6)
    points, normals = stair.sample()
    more, their_normals = replace(stair, seed=7).sample()
    faces = np.abs(their_normals[:, 0]) > 0.9
    points, normals = np.concatenate([points, more[faces]]), np.concatenate([normals, their_normals[faces]])
    assert np.count_nonzero(np.abs(normals[:, 0]) > 0.9) > np.count_nonzero(normals[:, 2] > 0.9)
    up = up_of(points @ turn.T, normals @ turn.T)
    # One tread of 0.28 m, and the feet of two risers, is all that the plane is fitted to.
    assert degrees_between(up.vector, turn[:, 2]) < 1.0


LONG = {
    "45 risers, L turn": ({"n_risers": 45, "landing_after": 22, "turn": "left"}, 7),
    "50 risers, wall and ceiling": ({"n_risers": 50, "wall": "left", "ceiling": True, "floor_width_m": 2.6}, 8),
    "60 risers": ({"n_risers": 60}, 8),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", LONG)
def test_up_of_a_long_stair_as_a_scanner_sees_it(name):
    changes, stations = LONG[name]
    scanner = replace(CLASSES["tls_fair"].scanner, stations=stations, spacing_m=0.01, seed=3)
    points = scan_building(build(replace(EVEN, **changes)), scanner).points
    normals = find_normals(make_scan(points), NormalsParams()).vectors
    for turn in TURNS.values():
        up = up_of(points @ turn.T, normals @ turn.T)
        # Either side of a leaning scan may be taken as up where a ceiling is the largest level.
        assert abs(up.vector @ turn[:, 2]) > np.cos(np.radians(0.1))
