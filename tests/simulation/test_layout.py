"""Where steps lie: nosings of stairs that turn, and the measures between them."""

import dataclasses
import itertools
import math

import numpy as np
import pytest

from stair_inspector.simulation.layout import SHARES_FROM_LEFT, lay_out, way_up
from stair_inspector.simulation.specs import Stair

RISE = 0.17


def points(*corners):
    return [pytest.approx(corner, abs=1e-12) for corner in corners]


def area_of(outline):
    x, y = np.array(outline).T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2.0


def test_quarter_turn_to_the_left():
    stair = Stair(n_risers=7, landing_after=3, turn="left", width_m=1.2, going_m=0.28, overhang_m=0.025)
    steps = lay_out(stair)
    landing, first = steps[2], steps[3]
    # Two goings to the landing's riser; the landing is a square, 1.2 m each way.
    assert list(landing.nosing) == points((0.535, 0.6, 0.51), (0.535, -0.6, 0.51))
    assert (landing.climb, landing.kind, landing.going_m, landing.going_lcr_m) == ((1.0, 0.0), "landing", None, None)
    assert landing.pitch_deg is None
    assert landing.tread_depth_m == pytest.approx(1.225, abs=1e-12)
    # The second flight climbs along +y: its left is -x.
    assert first.climb == pytest.approx((0.0, 1.0), abs=1e-12)
    assert list(first.nosing) == points((0.56, 0.575, 0.68), (1.76, 0.575, 0.68))
    assert list(steps[4].nosing) == points((0.56, 0.855, 0.85), (1.76, 0.855, 0.85))
    assert [step.flight for step in steps] == [1, 1, 1, 2, 2, 2, 2]
    assert first.rise_lcr_m == pytest.approx((RISE, RISE, RISE), abs=1e-12)


def test_half_turn_comes_back_beside_the_first_flight():
    stair = Stair(n_risers=7, landing_after=3, turn="u_left", width_m=1.0, well_m=0.2, landing_depth_m=1.1)
    steps = lay_out(stair)
    landing, first = steps[2], steps[3]
    xs, ys = zip(*landing.plan.outline, strict=True)
    assert (min(xs), max(xs)) == pytest.approx((0.535, 0.56 + 1.1), abs=1e-12)
    assert (min(ys), max(ys)) == pytest.approx((-0.5, 0.5 + 0.2 + 1.0), abs=1e-12)
    assert landing.going_m is None
    assert first.climb == pytest.approx((-1.0, 0.0), abs=1e-12)
    # Climbing along -x, left is -y.
    assert list(first.nosing) == points((0.585, 0.7, 0.68), (0.585, 1.7, 0.68))
    assert list(steps[4].nosing) == points((0.305, 0.7, 0.85), (0.305, 1.7, 0.85))


@pytest.mark.parametrize(
    "stair",
    [
        Stair(landing_after=4, turn="left", skew_errors_m="2:0.02,4:0.03,5:0.01,7:-0.02", cross_fall_errors_deg="3:1"),
        Stair(landing_after=4, turn="u_left"),
        Stair(shape="winder"),
        Stair(shape="spiral", fall_errors_deg="3:2"),
        Stair(shape="curved", curve_radius_m=3.0),
    ],
)
def test_a_right_turn_is_the_mirror_image(stair):
    turn = {"u_left": "u_right"}.get(stair.turn, "right")
    plain = dataclasses.replace(stair, skew_errors_m="", cross_fall_errors_deg="")
    mirrored = dataclasses.replace(plain, turn=turn)
    for left, right in zip(lay_out(plain), lay_out(mirrored), strict=True):
        (x0, y0, z0), (x1, y1, z1) = left.nosing
        assert list(right.nosing) == points((x1, -y1, z1), (x0, -y0, z0))
        assert right.climb == pytest.approx((left.climb[0], -left.climb[1]), abs=1e-12)
        assert right.rise_m == pytest.approx(left.rise_m, abs=1e-12)
        assert right.going_m == (None if left.going_m is None else pytest.approx(left.going_m, abs=1e-12))
    # Errors that have a side keep it: seen when climbing, they are the same whichever way the stair turns.
    if stair.skew_errors_m:
        for left, right in zip(lay_out(stair), lay_out(dataclasses.replace(stair, turn=turn)), strict=True):
            for step in (left, right):
                lead = [np.dot(np.array(end[:2]), step.climb) for end in step.nosing]
                wanted = {2: 0.02, 4: 0.03, 5: 0.01, 7: -0.02}.get(step.step_id, 0.0)
                assert lead[1] - lead[0] == pytest.approx(wanted, abs=1e-12)
            assert left.nosing[0][2] - left.nosing[1][2] == pytest.approx(right.nosing[0][2] - right.nosing[1][2])


@pytest.mark.parametrize("turn", ["none", "right"])
def test_spiral_keeps_going_rise_and_width_all_the_way_round(turn):
    stair = Stair(
        n_risers=17, shape="spiral", turn=turn, going_m=0.23, width_m=0.8, spiral_radius_m=0.08, overhang_m=0.02
    )
    steps = lay_out(stair)
    side = -1.0 if turn == "right" else 1.0
    centre = np.array([0.0, side * (0.4 + 0.08)])
    inner = 1 if turn == "right" else 0
    turns = []
    for step in steps:
        ends = np.array(step.nosing)[:, :2]
        assert step.width_m == pytest.approx(0.8, abs=1e-12)
        assert np.linalg.norm(ends[1] - ends[0]) == pytest.approx(0.8, abs=1e-12)
        # A nosing lies the overhang before the radial line of its riser.
        assert np.linalg.norm(ends[inner] - centre) == pytest.approx(math.hypot(0.08, 0.02), abs=1e-12)
        assert np.linalg.norm(ends[1 - inner] - centre) == pytest.approx(math.hypot(0.88, 0.02), abs=1e-12)
        assert np.dot(ends[0] - ends[1], step.climb) == pytest.approx(0.0, abs=1e-12)
        # Left of the climb.
        left = np.array([-step.climb[1], step.climb[0]])
        assert (ends[0] - ends[1]) @ left == pytest.approx(0.8, abs=1e-12)
        turns.append(math.atan2(step.climb[1], step.climb[0]))
        assert step.rise_m == pytest.approx(RISE, abs=1e-12)
        assert step.shape == "spiral"
    steps_of_turn = np.diff(np.unwrap(turns))
    assert steps_of_turn == pytest.approx(np.full(16, steps_of_turn[0]), abs=1e-12)
    assert steps_of_turn[0] * side > 0.0
    for step in steps[:-1]:
        assert step.going_m == pytest.approx(0.23, abs=1e-12)
        assert step.going_lcr_m[1] == pytest.approx(0.23, abs=1e-12)
        outer_going, inner_going = step.going_lcr_m[2 * (1 - inner)], step.going_lcr_m[2 * inner]
        assert inner_going < 0.23 < outer_going
        assert step.tread_depth_m > step.going_m
    assert steps[-1].going_m is None


@pytest.mark.parametrize("turn", ["none", "right"])
@pytest.mark.parametrize("overhang_m", [0.0, 0.03])
def test_a_curved_stair_has_its_going_along_the_arc_through_the_middles_of_its_nosings(turn, overhang_m):
    stair = Stair(
        n_risers=9, shape="curved", curve_radius_m=4.0, turn=turn, going_m=0.28, width_m=1.0, overhang_m=overhang_m
    )
    steps = lay_out(stair)
    side = -1.0 if turn == "right" else 1.0
    centre = np.array([0.0, 4.0 * side])
    for step, after in itertools.pairwise(steps):
        (left, right), (left_after, right_after) = (np.array(each.nosing)[:, :2] - centre for each in (step, after))
        for share, going in zip(SHARES_FROM_LEFT, step.going_lcr_m, strict=True):
            a, b = left + share * (right - left), left_after + share * (right_after - left_after)
            turned = math.atan2(a[0] * b[1] - a[1] * b[0], a @ b) * side
            assert going == pytest.approx(turned * np.linalg.norm(a), abs=1e-12)
        assert step.going_m == pytest.approx(0.28, abs=1e-12)
        assert (step.shape, step.width_m) == ("curved", 1.0)
        assert step.rise_lcr_m == pytest.approx((RISE,) * 3, abs=1e-12)
        # The sides of the treads lie on two circles, the corners of their facets exactly.
        for corners, radius in ((step.plan.left, 4.0 - 0.5 * side), (step.plan.right, 4.0 + 0.5 * side)):
            assert np.linalg.norm(np.array(corners) - centre, axis=1) == pytest.approx(radius, abs=1e-12)
    # The inner side is the left one of a stair that turns to the left.
    assert (steps[0].going_lcr_m[0] < steps[0].going_lcr_m[2]) == (turn == "none")
    assert steps[-1].going_m is None


def test_winders_turn_ninety_degrees_about_the_corner():
    stair = Stair(n_risers=9, shape="winder", winder_after=3, width_m=1.0, going_m=0.28, overhang_m=0.02)
    steps = lay_out(stair)
    assert [step.shape for step in steps] == ["straight"] * 3 + ["winder"] * 3 + ["straight"] * 3
    corner = np.array([3 * 0.28, 0.5])
    for step, angle in zip(steps[3:6], (0.0, 30.0, 60.0), strict=True):
        climb = (math.cos(math.radians(angle)), math.sin(math.radians(angle)))
        assert step.climb == pytest.approx(climb, abs=1e-12)
        for end in step.nosing:
            # The nosing's line passes the corner at the overhang.
            assert np.dot(np.array(end[:2]) - corner, climb) == pytest.approx(-0.02, abs=1e-12)
        right = step.nosing[1]
        assert min(abs(right[1] + 0.5), abs(right[0] - 1.84)) < 1e-12
        left = step.nosing[0]
        assert math.dist(left[:2], corner) == pytest.approx(math.hypot(0.05, 0.02), abs=1e-12)
    assert steps[2].going_m == 0.28
    assert list(steps[6].nosing) == points((0.84, 0.48, 7 * RISE), (1.84, 0.48, 7 * RISE))
    for step, after in itertools.pairwise(steps[3:7]):
        start = (np.array(step.nosing[0]) + step.nosing[1])[:2] / 2.0
        met = start + step.going_m * np.array(step.climb)
        a, b = (np.array(end[:2]) for end in after.nosing)
        assert (b - a)[0] * (met - a)[1] - (b - a)[1] * (met - a)[0] == pytest.approx(0.0, abs=1e-12)
        assert after.rise_m == pytest.approx(RISE, abs=1e-12)
    # The three wedges fill the square but for the middle, which is the post's, and stick out over the step below.
    square = sum(area_of([step.plan.riser[0], *_behind(step)]) for step in steps[3:6])
    assert square == pytest.approx(1.0 - 3 * 0.5 * 0.05**2 * math.sin(math.radians(30.0)), abs=1e-12)


def _behind(step):
    return [step.plan.riser[1], *step.plan.right, *reversed(step.plan.left)]


@pytest.mark.parametrize(
    "stair",
    [
        Stair(landing_after=4, turn="u_right", well_m=0.0),
        Stair(landing_after=1, turn="left", overhang_m=0.0),
        Stair(landing_after=9, turn="right"),
        Stair(shape="winder", winder_after=0, turn="right"),
        Stair(shape="spiral", overhang_m=0.08),
        Stair(shape="curved", curve_radius_m=2.0, turn="right"),
        Stair(skew_errors_m="1:0.05,10:-0.05"),
    ],
)
def test_outlines_run_counter_clockwise_and_join(stair):
    steps = lay_out(stair)
    for step in steps:
        assert area_of(step.plan.outline) > 0.02
        assert step.plan.outline[:2] == step.plan.front
    for step, after in itertools.pairwise(steps):
        # A step ends at the riser above it; a winder's begins at the post.
        left, right = step.plan.back
        assert math.dist(right, after.plan.riser[1]) < 0.051
        assert math.dist(left, after.plan.riser[0]) < 0.051


def test_skew_turns_a_nosing_about_its_middle():
    steps = lay_out(Stair(n_risers=6, skew_errors_m="3:0.02", width_m=1.0, overhang_m=0.0))
    assert list(steps[2].nosing) == points((0.55, 0.5, 0.51), (0.57, -0.5, 0.51))
    assert steps[2].climb == (1.0, 0.0)
    assert steps[1].going_m == steps[2].going_m == 0.28
    # 15 % from the left is y = 0.35: there the nosing is 7 mm nearer.
    assert steps[1].going_lcr_m == pytest.approx((0.273, 0.28, 0.287), abs=1e-12)
    # Square to the edge, which leans by atan(0.02).
    cos = math.cos(math.atan(0.02))
    assert steps[2].going_lcr_m == pytest.approx((0.287 / cos, 0.28 / cos, 0.273 / cos), abs=1e-12)
    assert steps[3].rise_lcr_m == pytest.approx((RISE,) * 3, abs=1e-12)


def test_rises_on_three_lines_follow_cross_falls():
    steps = lay_out(Stair(n_risers=5, width_m=1.0, cross_fall_errors_deg="3:1", rise_errors_m="3:0.01"))
    lift = 0.35 * math.tan(math.radians(1.0))
    assert steps[2].rise_lcr_m == pytest.approx((0.18 + lift, 0.18, 0.18 - lift), abs=1e-12)
    assert steps[3].rise_lcr_m == pytest.approx((RISE - lift, RISE, RISE + lift), abs=1e-12)
    assert [step.rise_m for step in steps] == [0.17, 0.17, 0.17 + 0.01, 0.17, 0.17]
    assert steps[0].rise_lcr_m == pytest.approx((RISE,) * 3, abs=1e-12)
    assert SHARES_FROM_LEFT == (0.15, 0.5, 0.85)


def test_rise_after_a_turn_is_from_the_landing_at_the_foot_of_the_riser():
    stair = Stair(n_risers=6, landing_after=3, turn="left", width_m=1.0, fall_errors_deg="3:2")
    steps = lay_out(stair)
    # The landing climbs along +x; the first riser of the second flight starts at its own riser and runs along +x.
    climbed = [(0.025 + share * 1.0) * math.tan(math.radians(2.0)) for share in SHARES_FROM_LEFT]
    assert steps[3].rise_lcr_m == pytest.approx([RISE - up for up in climbed], abs=1e-12)
    assert steps[3].rise_m == steps[3].rise_lcr_m[1]


def test_pitch_is_that_of_the_next_rise_and_this_going():
    steps = lay_out(Stair(n_risers=4, rise_errors_m="3:0.02", going_errors_m="1:0.01"))
    wanted = [math.atan2(0.17, 0.29), math.atan2(0.19, 0.28), math.atan2(0.17, 0.28)]
    assert [step.pitch_deg for step in steps[:-1]] == pytest.approx(np.degrees(wanted), abs=1e-9)
    assert steps[-1].pitch_deg is None


def test_missing_treads_keep_their_numbers():
    plain = lay_out(Stair(open_risers=True))
    steps = lay_out(Stair(open_risers=True, missing_treads="6,5"))
    assert [step.step_id for step in steps if step.is_missing] == [5, 6]
    for step, whole in zip(steps, plain, strict=True):
        assert (step.step_id, step.height_m, step.rise_m, step.nosing) == (
            whole.step_id,
            whole.height_m,
            whole.rise_m,
            whole.nosing,
        )


def test_a_twin_repeats_the_stair_on_its_left():
    stair = Stair(n_risers=5, landing_after=2, twin_gap_m=0.25, width_m=1.0, rise_errors_m="3:0.01")
    steps = lay_out(stair)
    assert [step.step_id for step in steps] == list(range(1, 11))
    assert [step.flight for step in steps] == [1, 1, 2, 2, 2, 3, 3, 4, 4, 4]
    for first, second in zip(steps[:5], steps[5:], strict=True):
        assert list(second.nosing) == points(*[(x, y + 1.25, z) for x, y, z in first.nosing])
        assert (second.rise_m, second.going_m, second.kind) == (first.rise_m, first.going_m, first.kind)


def test_walking_line_crosses_landings_and_skips_what_is_missing():
    stair = Stair(n_risers=5, landing_after=2, turn="u_left", width_m=1.0, well_m=0.2, landing_depth_m=1.0)
    line = way_up(stair, lay_out(stair))
    # Two nosings, the two middles of the turn, three nosings, and the end on the upper landing.
    assert len(line) == 8
    assert list(line[1:4]) == points((0.255, 0.0, 0.34), (0.78, 0.0, 0.34), (0.78, 1.2, 0.34))
    assert line[-1] == pytest.approx((0.28 + 0.025 - 0.56 - 0.96, 1.2, 0.85), abs=1e-12)
    gap = Stair(n_risers=5, open_risers=True, missing_treads="3")
    assert [round(z, 9) for _, _, z in way_up(gap, lay_out(gap))] == [0.17, 0.34, 0.34, 0.68, 0.85, 0.85]
