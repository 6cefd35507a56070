"""Up is decided by the stair that comes out, or asked for: never do rise and going change places."""

import dataclasses
import itertools

import numpy as np
import pytest

from stair_inspector.geometry.lattice import find_lattices
from stair_inspector.model import Normals
from stair_inspector.overrules import parse_up
from stair_inspector.params import FloorParams, NormalsParams, Params
from stair_inspector.pipeline import inspect
from stair_inspector.stages import readings
from stair_inspector.stages.camera_frames import is_view
from stair_inspector.stages.orient import find_normals, find_up
from stair_inspector.stages.readings import read_rhythm
from stair_inspector.stages.thinned import one_of_each_voxel, thin
from stair_inspector.stages.up_questions import name_of, question_of
from tests.camera_views import AXES, View
from tests.synthetic import Stair, make_scan, motion, rotation

NOWHERE = np.zeros(3)
RIGHT_DEG = 5.0


def up_of(scan, max_rise_m=0.3):
    normals = Normals(scan.normals) if scan.normals is not None else find_normals(scan, NormalsParams(k=20))
    return find_up(scan, normals, "auto", FloorParams(), "survey", max_rise_m)


def verdict_of(view):
    """right, asked, wrong, or nothing: up is wrong, and no flight is measured with it."""
    points, true_up = view.points_and_up()
    scan = make_scan(points)
    found = up_of(scan)
    if any(seen.level == "question" for seen in found.observations):
        return "asked"
    if found.vector @ true_up > np.cos(np.radians(RIGHT_DEG)):
        return "right"
    return "wrong" if inspect(scan, Params(normals=NormalsParams(k=20))).flights else "nothing"


def views(pitches, seeds, **changes):
    """Views of a stair from before it, and from its upper landing where the camera looks down at it."""
    rooms = ((1.2, 1.3), (0.6, 1.0), (1.5, 1.8), (0.9, 2.2))
    for pitch, (number, axis), seed in itertools.product(pitches, enumerate(AXES), seeds):
        height, distance = rooms[(number + seed) % len(rooms)]
        rise, going = ((0.175, 0.28), (0.15, 0.32), (0.19, 0.25), (0.17, 0.3))[(number + 2 * seed) % 4]
        yield View(
            rise=rise,
            going=going,
            pitch_deg=pitch,
            camera_height=height,
            distance=distance,
            yaw_deg=(0.0, 12.0, -8.0)[seed % 3],
            has_walls=(seed + number) % 3 > 0,
            turned_to=axis,
            seed=seed,
            **changes,
        )


FEW = [View(pitch_deg=pitch, turned_to=axis) for pitch, axis in ((0.0, "-y"), (10.0, "y"), (20.0, "-z"), (40.0, "x"))]


@pytest.mark.parametrize(
    "view",
    [pytest.param(view, marks=pytest.mark.slow if view.pitch_deg in (0.0, 20.0) else ()) for view in FEW],
    ids=[f"{view.pitch_deg:g} {view.turned_to}" for view in FEW],
)
def test_a_level_cameras_view_is_read_the_right_way_up(view):
    assert verdict_of(view) == "right"


def test_a_level_scan_that_looks_like_a_view_from_below_is_not_turned_over_without_a_question():
    """A staircase seen from above is one layer, also as seen from an origin that lies below its floor by chance."""
    stair = Stair(n_steps=8, noise=0.001, risers=True, spacing=0.012)
    points, _ = stair.sample()
    # It climbs towards the origin: seen from there, behind and below it, no surface lies before another.
    scan = make_scan(points * np.array([-1.0, -1.0, 1.0]) + np.array([5.0, 0.6, 0.5]))
    assert is_view(scan, scan.points)
    found = up_of(scan)
    assert found.vector[2] > 0.99 or any(seen.level == "question" for seen in found.observations)


@pytest.mark.slow
def test_of_views_over_pitches_axes_and_rooms_none_is_wrong_without_a_question():
    found = [(verdict_of(view), view) for view in views((0.0, 10.0, 20.0, 30.0, 40.0), range(7))]
    counts = {name: sum(verdict == name for verdict, _ in found) for name in ("right", "asked", "nothing", "wrong")}
    print(counts)
    assert len(found) >= 200
    assert [view for verdict, view in found if verdict == "wrong"] == []
    assert counts["right"] >= 0.8 * len(found)


@pytest.mark.slow
def test_a_camera_that_would_look_straight_down_is_asked_about_where_nothing_shows_a_rhythm():
    # From 2.2 m and 0.9 m high hardly a tread is seen.
    view = View(rise=0.19, going=0.25, pitch_deg=10.0, camera_height=0.9, distance=2.2, turned_to="-z", seed=6)
    assert verdict_of(view) in ("right", "asked")


# --- files with a z axis --------------------------------------------------------------------------------------------

STAIR = Stair(n_steps=6, rise=0.175, going=0.28, risers=True, spacing=0.04, noise=0.001, floor_depth=1.2)
DOWN = rotation("x", 180.0)


def in_a_stairwell(stair, height_m=2.4):
    """A stair between two walls that rise from it to above its landing."""
    points, normals = stair.sample()
    rng = np.random.default_rng(8)
    n = 2400
    x, z = rng.uniform(-1.2, 1.7, n), rng.uniform(0.0, 1.0, n)
    line = np.maximum(0.0, np.ceil(x / stair.going)) * stair.rise
    walls = [
        np.column_stack([x, np.full(n, side), line + z * (6 * stair.rise + height_m - line)])
        for side in (-0.01, stair.width + 0.01)
    ]
    across = np.tile([0.0, 1.0, 0.0], (2 * n, 1))
    return np.concatenate([points, *walls]), np.concatenate([normals, across])


def test_a_levelled_scan_stays_z_up_and_nothing_is_asked():
    for points, normals in (STAIR.sample(), in_a_stairwell(STAIR)):
        up = up_of(make_scan(points, normals))
        assert up.vector[2] > 0.999
        assert up.observations == ()


def test_a_stairwell_whose_z_points_down_is_turned_round():
    points, normals = in_a_stairwell(STAIR)
    up = up_of(make_scan(points @ DOWN.T, normals @ DOWN.T))
    assert up.vector[2] < -0.999 or [seen.code for seen in up.observations] == ["up_unsure"]
    assert "up_not_z" in [note.code for note in up.notes]


def on_an_arc(n_risers=9, rise=0.172, going=0.288, radius=2.0, width=1.1, spacing=0.035):
    """Points and normals of a stair of concrete that turns about one centre, the origin; its sides go down to floor."""
    rng = np.random.default_rng(4)
    inner, outer, turn = radius - width / 2.0, radius + width / 2.0, going / radius
    parts = []

    def add(size, at_radius, at_angle, height, normal):
        """``size`` in metres; ranges of radius, angle and height, and the normal's parts outwards, along and up."""
        n = round(size[0] * size[1] / spacing**2)
        r, angle, z = (rng.uniform(low, high, n) for low, high in (at_radius, at_angle, height))
        out = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(n)])
        along = np.column_stack([-out[:, 1], out[:, 0], np.zeros(n)])
        parts.append((r[:, None] * out + [0.0, 0.0, 1.0] * z[:, None], normal[0] * out + normal[1] * along))
        parts[-1][1][:, 2] = normal[2]

    for k in range(n_risers):
        start, height = k * turn, (k + 1) * rise
        span = (start, start + (1.5 / radius if k == n_risers - 1 else turn))
        length = radius * (span[1] - span[0])
        add((width, length), (inner, outer), span, (height, height), (0.0, 0.0, 1.0))
        add((width, rise), (inner, outer), (start, start), (k * rise, height), (0.0, 1.0, 0.0))
        for side in (inner, outer):
            add((length * side / radius, height), (side, side), span, (0.0, height), (1.0, 0.0, 0.0))
    add((2.0 * width, 2.0), (radius - width, radius + width), (-2.0 / radius, 0.0), (0.0, 0.0), (0.0, 0.0, 1.0))
    points, normals = (np.concatenate(each) for each in zip(*parts, strict=True))
    return points + rng.normal(0.0, 0.001, points.shape), normals


@pytest.mark.parametrize("yaw_deg", [75.0, 105.0])
def test_a_levelled_flight_that_curves_stays_z_up_and_nothing_is_asked(yaw_deg):
    points, normals = on_an_arc()
    turn = rotation("z", yaw_deg)
    up = up_of(make_scan(points @ turn.T, normals @ turn.T))
    assert up.vector[2] > 0.999
    assert up.observations == ()


def test_treads_that_reach_past_their_risers_say_which_side_is_up():
    # A stair that stands free, up along the file's -y: floor and landing of one size, no walls.
    stair = Stair(n_steps=6, rise=0.175, going=0.28, risers=True, spacing=0.035, noise=0.001, floor_depth=0.28)
    points, normals = stair.sample()
    riser = np.abs(normals[:, 0]) > 0.9
    points[riser, 0] += 0.025
    for turn in (rotation("x", 90.0), rotation("x", -90.0), rotation("y", 90.0) @ rotation("z", 30.0)):
        up = up_of(make_scan(points @ turn.T, normals @ turn.T))
        assert up.vector @ turn[:, 2] > 0.999
        assert up.observations == ()


def test_a_steep_stair_stays_z_up():
    stair = Stair(n_steps=6, rise=0.33, going=0.28, risers=True, spacing=0.04, noise=0.001, floor_depth=1.2)
    for limit in (0.3, 0.5):
        assert up_of(stair.scan(), limit).vector[2] > 0.999


def with_nosings(stair, reach_m=0.025):
    """A stair whose treads reach past their risers."""
    points, normals = stair.sample()
    points[np.abs(normals[:, 0]) > 0.9, 0] += reach_m
    return points, normals


def test_nosings_tell_treads_from_risers_whichever_way_the_rhythm_was_found():
    # Steeper than 45 degrees, so that the rhythm is found on its side.
    stair = Stair(n_steps=7, rise=0.33, going=0.28, risers=True, spacing=0.035, noise=0.001, floor_depth=0.28)
    for limit in (0.3, 0.5):
        up = up_of(make_scan(*with_nosings(stair)), limit)
        assert up.vector[2] > 0.999
        assert up.observations == ()


def lead_of_upright(points, normals):
    """By how much the reading with z up leads that upside down."""
    readings = read_rhythm(thin(points, normals), 0.3, NOWHERE, is_camera=False)
    weights = {name_of(reading.up): reading.weight for reading in readings}
    return weights["z"] - weights["-z"]


def test_the_lower_flight_does_not_speak_for_the_side_below_the_upper_one():
    upper = Stair(n_steps=7, rise=0.175, going=0.28, risers=True, spacing=0.035, noise=0.001, floor_depth=1.2)
    lower = Stair(n_steps=3, rise=0.175, going=0.28, risers=True, spacing=0.035, noise=0.001, floor_depth=3.0, seed=2)
    points, normals = with_nosings(upper)
    below, normals_below = lower.sample()
    below = below - [1.2 + 2 * 0.28, 0.0, 3 * 0.175]
    both = lead_of_upright(np.concatenate([points, below]), np.concatenate([normals, normals_below]))
    assert both > lead_of_upright(points, normals) - 0.5


@pytest.mark.slow
def test_treads_without_risers_over_which_the_floor_would_lie_are_asked_about():
    stair = Stair(n_steps=7, rise=0.175, going=0.28, spacing=0.035, noise=0.001, floor_depth=2.0)
    points, _ = stair.sample()
    # The floor is seen through the open risers too.
    under = Stair(n_steps=0, spacing=0.035, noise=0.001, floor_depth=7 * 0.28, seed=4).sample()[0] + [
        7 * 0.28,
        0.0,
        0.0,
    ]
    seen = np.concatenate([points, under])

    def asked(points):
        level = np.tile([0.0, 0.0, 1.0], (len(points), 1))
        return up_of(make_scan(points, level)).observations

    (question,) = asked(seen @ DOWN.T)
    assert (question.code, question.level, question.cure) == ("up_unsure", "question", "--up=-z or --up=z")
    assert asked(seen) == ()
    # A landing at the top leaves headroom over the treads, and so does a ceiling.
    assert asked(points @ DOWN.T) == ()
    high = np.array([0.0, 0.0, 3.4])
    assert asked(np.concatenate([points, under + high, under + high - [2.0, 0.0, 0.0]])) == ()


def test_a_single_riser_is_z_up():
    stair = Stair(n_steps=1, rise=0.16, going=1.5, risers=True, spacing=0.035, noise=0.002, floor_depth=1.5)
    assert abs(up_of(stair.scan()).vector[2]) > 0.999


def test_two_readings_that_fit_are_asked_for_with_their_numbers_and_a_flag_for_each():
    # At 45 degrees treads and risers are alike, and the file's axes say nothing.
    turn = rotation("x", 90.0) @ rotation("z", 30.0)
    stair = Stair(n_steps=6, rise=0.22, going=0.22, risers=True, spacing=0.025, noise=0.001, motion=motion(turn))
    up = up_of(make_scan(*stair.sample()))
    (question,) = up.observations
    assert (question.code, question.level) == ("up_unsure", "question")
    assert question.message.count("rise 2") == question.message.count("going 2") == 2
    flag, _, value = question.cure.split(" or ")[0].partition("=")
    assert flag == "--up"
    assert np.dot(parse_up(value), up.vector) > np.cos(np.radians(RIGHT_DEG))


def test_a_given_up_is_not_asked_about():
    scan = STAIR.scan()
    assert find_up(scan, Normals(scan.normals), "-z", FloorParams(), "survey").observations == ()


def test_no_rhythm_no_reading_no_question():
    rng = np.random.default_rng(3)
    points = rng.uniform(0.0, 2.0, (4000, 3)) * [1.0, 1.0, 0.001]
    flat = thin(points, np.tile([0.0, 0.0, 1.0], (len(points), 1)))
    assert read_rhythm(flat, 0.3, NOWHERE, is_camera=False) == []
    assert question_of([]) is None


# --- small parts ----------------------------------------------------------------------------------------------------


def test_a_cameras_frame_is_told_from_a_scan_of_several_stations():
    view = View().scan()
    assert is_view(view, view.points)
    assert not is_view(STAIR.scan(), STAIR.scan().points)
    moved = make_scan(view.points, origin_m=(1000.0, 0.0, 0.0))
    assert not is_view(moved, moved.points)


def test_directions_are_named_as_the_flag_takes_them():
    assert [name_of(np.array(axis)) for axis in AXES.values()] == list(AXES)
    assert name_of(np.array([0.0, -0.6, 0.8])) == "0.000,-0.600,0.800"


def test_thinning_keeps_one_point_of_each_cube():
    points = np.array([[0.0, 0.0, 0.0], [0.001, 0.0, 0.0], [0.05, 0.0, 0.0], [0.0, 0.05, 0.0], [0.051, 0.0, 0.0]])
    np.testing.assert_array_equal(one_of_each_voxel(points, 0.02), [0, 2, 3])


def test_a_rhythm_of_which_one_face_is_the_whole_second_family_is_none_but_in_a_cameras_view(monkeypatch):
    # So are the sides of bars to the treads that they form.
    scan = Stair(n_steps=6, spacing=0.035, risers=True, floor_depth=1.0).scan()
    thinned = thin(scan.points, scan.normals)
    (whole,) = find_lattices(thinned.points, thinned.normals, (0.06, 0.5))
    assert read_rhythm(thinned, 0.3, NOWHERE, is_camera=False)
    for changes in ({"risers": whole.risers[:1]}, {"treads": whole.treads[:1]}):
        one = dataclasses.replace(whole, **changes)
        monkeypatch.setattr(readings, "find_lattices", lambda *_, one=one: [one])
        assert not read_rhythm(thinned, 0.3, NOWHERE, is_camera=False)
        assert read_rhythm(thinned, 0.3, NOWHERE, is_camera=True)
