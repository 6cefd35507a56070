"""The values of steps and their uncertainties, on shapes whose edges, planes and doubts are stated.

What is expected is worked out by hand: standard uncertainties of independent parts add as squares, and ``u`` and its
parts are twice that. The faces stated here leave 0.017 mm of their own open, which is less than the tolerances.
"""

import math

import numpy as np
import pytest

from stair_inspector.model import Arc
from stair_inspector.params import SurveyParams
from stair_inspector.stages.doubt import slope_doubt, surface_doubt
from stair_inspector.stages.step_values import StepMeasurer
from tests.stages.stated_shapes import DEPTH, GOING, RISE, WIDTH, chain_of, common, edge, plane, shape, turned


def measured(*shapes, after=None, n_missing=None, base=0, **known):
    chain = chain_of(shapes, base, n_missing)
    return StepMeasurer(chain, tuple(shapes), after, common(**known), SurveyParams()).measure()


def part(value, name):
    return dict(value.parts).get(name, 0.0)


def test_an_even_flight_has_the_values_it_was_stated_with():
    steps = measured(*(shape(k) for k in range(3)))
    assert [step.rise_m.value for step in steps] == pytest.approx([RISE] * 3)
    assert [step.going_m.value for step in steps[:2]] == pytest.approx([GOING] * 2)
    assert steps[2].going_m is None
    assert steps[2].nosing_overhang_m is None
    for step in steps:
        assert step.tread_depth_m.value == pytest.approx(DEPTH)
        assert step.width_m.value == pytest.approx(WIDTH)
    assert steps[0].nosing_overhang_m.value == pytest.approx(DEPTH - GOING)
    assert steps[0].pitch_deg.value == pytest.approx(math.degrees(math.atan(RISE / GOING)))
    assert steps[0].rise_lcr_m == pytest.approx((RISE,) * 3)
    assert steps[0].going_lcr_m == pytest.approx((GOING,) * 3)
    # On the lines, 15 % of the width from the sides, from left to right.
    assert steps[1].line_points[:, 1] == pytest.approx([0.42, 0.0, -0.42])
    assert steps[1].nosing == pytest.approx(np.array([[GOING, 0.6, 2 * RISE], [GOING, -0.6, 2 * RISE]]))
    assert steps[1].corners[2:] == pytest.approx(
        np.array([[GOING + DEPTH, -0.6, 2 * RISE], [GOING + DEPTH, 0.6, 2 * RISE]])
    )


def test_every_step_of_an_uneven_flight_has_its_own_values():
    heights, places = (0.17, 0.35, 0.51, 0.70), (0.0, 0.28, 0.58, 0.85)
    noises = (0.001, 0.002, 0.003, 0.004)
    shapes = [
        shape(
            k,
            plane=plane(height),
            origin_m=np.array([place, 0.0]),
            front=edge(0.0, noise),
            nosing_noise=(0.0, noise, 0.0),
        )
        for k, (height, place, noise) in enumerate(zip(heights, places, noises, strict=True))
    ]
    # The floor at the foot lies 10 mm below zero where the first nosing is.
    shapes[0] = shape(0, front=shapes[0].front, nosing_noise=shapes[0].nosing_noise, foot=plane(-0.01))
    steps = measured(*shapes, up_rad=0.001)
    rises, goings = [0.18, 0.18, 0.16, 0.19], [0.28, 0.30, 0.27]
    assert [step.rise_m.value for step in steps] == pytest.approx(rises)
    assert [step.going_m.value for step in steps[:3]] == pytest.approx(goings)
    assert [step.nosing_overhang_m.value for step in steps[:3]] == pytest.approx([DEPTH - going for going in goings])
    for k in range(3):
        both = 2.0 * math.hypot(noises[k], noises[k + 1])
        assert part(steps[k].going_m, "noise") == pytest.approx(both)
        assert part(steps[k + 1].rise_m, "noise") == pytest.approx(both)
        assert part(steps[k].nosing_overhang_m, "noise") == pytest.approx(2.0 * noises[k + 1])
        # A tilt turns a going by the rise at its end, and a rise by the going below it.
        for value in (steps[k].going_m, steps[k].nosing_overhang_m):
            assert part(value, "up") == pytest.approx(0.002 * rises[k + 1])
        assert part(steps[k + 1].rise_m, "up") == pytest.approx(0.002 * goings[k])
        pitch_deg = math.degrees(math.atan(rises[k + 1] / goings[k]))
        assert steps[k].pitch_deg.value == pytest.approx(pitch_deg)


def test_goings_are_measured_along_the_climb_and_rises_from_nosing_to_nosing():
    """The second nosing slants; both treads fall; strips on the nosings stand proud."""
    lower = shape(0, plane=plane(RISE, (0.02, 0.03)), nosing_offsets=(0.001, 0.002, 0.003))
    upper = shape(1, plane=plane(2 * RISE, (0.0, 0.01)), front=edge(0.0, slope=0.1), nosing_offsets=(0.0, 0.004, 0.0))
    steps = measured(lower, upper)
    # Both nosings are known alike: one climbs along their mean direction, 0.05 rad from x.
    climb = np.array([1.0, 0.0]) + np.array([1.0, -0.1]) / math.hypot(1.0, 0.1)
    climb /= math.hypot(*climb)
    lines = (0.42, 0.0, -0.42)
    # From (0, w) by t along the climb to the line x = GOING + 0.1 y.
    expected = [(GOING + 0.1 * w) / (climb[0] - 0.1 * climb[1]) for w in lines]
    assert steps[0].going_lcr_m == pytest.approx(expected)
    # Goings of a straight flight that differ from line to line leave no doubt about the middle.
    assert part(steps[0].going_m, "edge") < 0.0001
    # From (GOING + 0.1 w, w) back along the climb to the nosing at x = 0.
    below = [w - (GOING + 0.1 * w) / climb[0] * climb[1] for w in lines]
    expected = [
        RISE + 0.01 * w + proud - (0.03 * w_below + strip)
        for w, proud, w_below, strip in zip(lines, (0.0, 0.004, 0.0), below, (0.001, 0.002, 0.003), strict=True)
    ]
    assert steps[1].rise_lcr_m == pytest.approx(expected)
    assert steps[1].rise_m.value == pytest.approx(expected[1])


def test_the_noise_of_a_value_is_that_of_both_its_ends():
    lower = shape(
        0,
        front=edge(0.0, 0.0003),
        back=edge(DEPTH, 0.0004),
        left=edge(0.6, 0.0005),
        right=edge(-0.6, 0.0012),
        nosing_noise=(0.0, 0.0005, 0.0),
        foot=plane(0.0, deviations=(0.0012, 0.0, 0.0)),
    )
    upper = shape(1, front=edge(0.0, 0.0004), nosing_noise=(0.0, 0.0012, 0.0))
    first, second = measured(lower, upper)
    # 0.5 and 1.2 give 1.3 mm, 0.3 and 0.4 give 0.5 mm; twice that is shown.
    assert part(first.rise_m, "noise") == pytest.approx(0.0026)
    assert part(second.rise_m, "noise") == pytest.approx(0.0026)
    assert part(first.going_m, "noise") == pytest.approx(0.001)
    assert part(first.tread_depth_m, "noise") == pytest.approx(0.001)
    assert part(first.width_m, "noise") == pytest.approx(0.0026)
    # From the next nosing to this back: its own nosing drops out.
    assert part(first.nosing_overhang_m, "noise") == pytest.approx(2.0 * math.hypot(0.0004, 0.0004))


def test_an_edge_is_less_sure_away_from_where_it_was_seen():
    """Edges seen at w = 0.4 m to 3 mm, whose direction is known to 0.01: 5 mm are 3 and 4 mm on a line 0.4 m away."""
    seen = {"noise_m": 0.003, "along_m": 0.4, "slope_noise": 0.01}
    first, second = measured(
        shape(0, front=edge(0.0, **seen), back=edge(DEPTH, **seen)), shape(1, front=edge(0.0, **seen))
    )
    for value in (first.going_m, first.tread_depth_m, first.nosing_overhang_m):
        assert part(value, "noise") == pytest.approx(2.0 * math.sqrt(2.0) * 0.005)
    leaning = [shape(k, plane=plane((k + 1) * RISE, (0.02, 0.0)), front=edge(0.0, **seen)) for k in range(2)]
    second = measured(*leaning)[1]
    assert part(second.rise_m, "edge") == pytest.approx(2.0 * math.sqrt(2.0) * 0.02 * 0.005, rel=1e-3)


def test_what_the_user_states_about_edges_counts_at_both_ends():
    first, second = measured(shape(0), shape(1), edge_m=0.003, side_m=0.002)
    both = 2.0 * math.sqrt(2.0)
    for value in (first.going_m, first.tread_depth_m, first.nosing_overhang_m):
        assert part(value, "edge") == pytest.approx(both * 0.003, rel=1e-3)
    # The line from nosing to nosing turns by what the going is wrong across it; a rise has no edge to be wrong by.
    across_m = both * 0.003 * RISE / math.hypot(RISE, GOING)
    assert part(first.pitch_deg, "edge") == pytest.approx(math.degrees(across_m / math.hypot(RISE, GOING)), rel=1e-3)
    assert [name for name, _ in first.pitch_deg.parts] == ["edge"]
    assert part(first.width_m, "edge") == pytest.approx(both * 0.002, rel=1e-3)
    # Level treads are as high wherever their nosings are.
    assert part(second.rise_m, "edge") == 0.0


def test_where_a_nosing_is_matters_for_its_height_as_much_as_the_tread_falls():
    lower = shape(0, plane=plane(RISE, (-0.02, 0.0)))
    upper = shape(1, plane=plane(2 * RISE, (0.01, 0.0)), front=edge(0.0, 0.004))
    first, second = measured(lower, upper, edge_m=0.003)
    # 3 mm below; above 4 mm of scatter and 3 mm, together 5.
    expected = 2.0 * math.hypot(0.02 * 0.003, 0.01 * 0.005)
    assert part(second.rise_m, "edge") == pytest.approx(expected, rel=1e-3)
    # The floor has no nosing.
    assert part(first.rise_m, "edge") == pytest.approx(2.0 * 0.02 * 0.003, rel=1e-3)


def test_a_tilt_turns_rises_by_the_going_and_goings_by_the_rise():
    first, second = measured(shape(0), shape(1), up_rad=0.002)
    # At the foot of the first riser the floor is right below.
    assert part(first.rise_m, "up") == 0.0
    assert part(second.rise_m, "up") == pytest.approx(2.0 * 0.002 * GOING)
    assert part(first.going_m, "up") == pytest.approx(2.0 * 0.002 * RISE)
    assert part(first.nosing_overhang_m, "up") == pytest.approx(2.0 * 0.002 * RISE)
    tilt_deg = 2.0 * math.degrees(0.002)
    for angle in (first.pitch_deg, first.fall_deg, first.cross_fall_deg):
        assert part(angle, "up") == pytest.approx(tilt_deg)


def test_a_scale_counts_by_the_size_and_registration_from_step_to_step():
    first, second = measured(shape(0), shape(1), scale=0.002, registration_m=0.001, slope=0.003)
    sizes = {
        RISE: (first.rise_m, second.rise_m),
        GOING: (first.going_m,),
        DEPTH: (first.tread_depth_m,),
        WIDTH: (first.width_m,),
    }
    for size, values in sizes.items():
        for value in values:
            assert part(value, "scale") == pytest.approx(2.0 * 0.002 * size)
            assert part(value, "registration") == pytest.approx(0.002)
    # Both ends of an overhang lie at one place: half of it is left.
    assert part(first.nosing_overhang_m, "registration") == pytest.approx(0.001)
    # Two stations make a slope from front to back, where one sees the one and another the other.
    assert part(first.fall_deg, "registration") == pytest.approx(2.0 * math.degrees(0.003))
    assert part(first.cross_fall_deg, "registration") == 0.0


def test_doubled_treads_lie_anywhere_between_their_layers():
    first, second = measured(
        shape(0, plane=plane(RISE, layers_m=0.006)), shape(1, plane=plane(2 * RISE, layers_m=0.006))
    )
    # An even distribution over 6 mm has the deviation 6 / sqrt(12).
    of_level = 0.006 / math.sqrt(12.0)
    assert part(second.rise_m, "layers") == pytest.approx(2.0 * math.sqrt(2.0) * of_level)
    # At the front one layer, at the back the other.
    slope_deg = math.degrees(math.sqrt(2.0) * of_level / (DEPTH - 0.01))
    assert part(first.fall_deg, "layers") == pytest.approx(2.0 * slope_deg)
    assert part(first.cross_fall_deg, "layers") == 0.0


def test_rounded_heights_leave_every_level_anywhere_within_a_step():
    first, second = measured(shape(0), shape(1), steps_m=np.array([0.0, 0.0, 0.004]))
    both = 2.0 * math.sqrt(2.0) * 0.004 / math.sqrt(12.0)
    assert part(first.rise_m, "resolution") == pytest.approx(both, rel=0.02)
    assert part(second.rise_m, "resolution") == pytest.approx(both, rel=0.02)
    # Rounded heights move no edge in the plan.
    assert part(first.going_m, "resolution") == 0.0


def test_rounding_along_a_flight_is_that_of_both_edges():
    steps_m = np.array([0.004, 0.002, 0.0])
    first, second = measured(shape(0), shape(1), steps_m=steps_m)
    both = 2.0 * math.sqrt(2.0) / math.sqrt(12.0)
    for value in (first.going_m, first.tread_depth_m, first.nosing_overhang_m):
        assert part(value, "resolution") == pytest.approx(both * 0.004, rel=0.02)
    assert part(first.width_m, "resolution") == pytest.approx(both * 0.002, rel=0.02)
    assert part(second.rise_m, "resolution") == 0.0


def test_rounding_and_doubled_treads_tilt_a_surface_by_its_own_length():
    tread = shape(0, plane=plane(RISE, layers_m=0.006), extent=(0.02, 0.32, -0.5, 0.3))
    (step,) = measured(tread, steps_m=np.array([0.0, 0.0, 0.004]))
    of_level, of_layers = 0.004 / math.sqrt(12.0), 0.006 / math.sqrt(12.0)
    # One end against the other: over 0.30 m along the climb, 0.80 m across it.
    for value, length_m in ((step.fall_deg, 0.30), (step.cross_fall_deg, 0.80)):
        expected = 2.0 * math.degrees(math.sqrt(2.0) * of_level / length_m)
        assert part(value, "resolution") == pytest.approx(expected, rel=0.02)
    assert part(step.fall_deg, "layers") == pytest.approx(2.0 * math.degrees(math.sqrt(2.0) * of_layers / 0.30))


def test_noise_that_neighbouring_points_have_in_common_is_in_rises_and_in_falls_but_in_no_cross_fall():
    noisy = [plane(height, sigma_m=0.01) for height in (0.0, RISE, 2 * RISE)]
    first, second = measured(shape(0, foot=noisy[0], plane=noisy[1]), shape(1, plane=noisy[2]))
    for value in (first.rise_m, second.rise_m):
        assert part(value, "noise") == pytest.approx(2.0 * math.sqrt(2.0) * surface_doubt(noisy[0]))
    depth_m = DEPTH - 0.01
    expected = 2.0 * math.degrees(slope_doubt(noisy[1], depth_m))
    assert part(first.fall_deg, "noise") == pytest.approx(expected)
    assert part(first.cross_fall_deg, "noise") == 0.0


def test_a_width_is_taken_where_its_sides_are_known_best():
    tapered = {"left": edge(0.6, slope=0.1, along_m=0.08), "right": edge(-0.6, slope=-0.3, along_m=0.16)}
    (step,) = measured(shape(0, plane=plane(RISE, aside_m=0.004), **tapered))
    # In the middle, at s = 0.12, 4 mm wider on the left, 12 mm narrower on the right.
    assert step.width_m.value == pytest.approx(1.2 + 0.1 * 0.04 - 0.3 * 0.04)
    # A strip of carpet that leaves 4 mm of the width open leaves 2 mm of deviation.
    assert part(step.width_m, "layers") == pytest.approx(0.004)


def test_slopes_are_positive_upwards_and_their_noise_is_that_of_the_plane():
    tread = plane(RISE, (0.03, -0.04), (0.0, 0.001, 0.002))
    (step,) = measured(shape(0, plane=tread))
    for value, slope, doubt in ((step.fall_deg, 0.03, 0.001), (step.cross_fall_deg, -0.04, 0.002)):
        assert value.value == pytest.approx(math.degrees(math.atan(slope)))
        assert part(value, "noise") == pytest.approx(2.0 * math.degrees(doubt) / (1.0 + slope**2))


def test_the_pitch_from_nosing_to_nosing_is_uncertain_across_its_line():
    first, second = measured(
        shape(0, front=edge(0.0, 0.003)),
        shape(1, front=edge(0.0, 0.004), nosing_noise=(0.0, 0.002, 0.0)),
        registration_m=0.001,
    )
    length = math.hypot(RISE, GOING)
    # What is across the line turns it by its size over the length: 5 mm of the going, 2 mm of the rise.
    across = math.hypot(0.002 * GOING / length, 0.005 * RISE / length)
    assert part(first.pitch_deg, "noise") == pytest.approx(2.0 * math.degrees(across / length))
    # Registration is the same in both, so in every direction.
    assert part(first.pitch_deg, "registration") == pytest.approx(2.0 * math.degrees(0.001 / length))
    assert second.pitch_deg is None


def test_a_back_that_is_hidden_lies_anywhere_within_its_limits():
    hidden = shape(0, back=None, back_limits=(0.29, 0.33), front=edge(0.005, 0.0003))
    first, _ = measured(hidden, shape(1, front=edge(0.005, 0.0004)), edge_m=0.003)
    assert first.tread_depth_m.value == pytest.approx(0.305)
    assert first.nosing_overhang_m.value == pytest.approx(0.025)
    # Half the interval is the expanded uncertainty; its noise is that of the one edge that was seen.
    for value, noise in ((first.tread_depth_m, 0.0003), (first.nosing_overhang_m, 0.0004)):
        assert part(value, "edge") == pytest.approx(2.0 * math.hypot(0.01, 0.003), rel=1e-3)
        assert part(value, "noise") == pytest.approx(2.0 * noise)
    # Drawn in the middle between the limits.
    assert first.corners[2, 0] == pytest.approx(0.31)
    unseen, slanting = measured(shape(0, back=None), shape(1, back=edge(DEPTH, slope=0.1)))
    # Where neither is known the tread is drawn as far as it was seen, and else along its back.
    assert unseen.corners[2:, 0] == pytest.approx([DEPTH, DEPTH])
    assert slanting.corners[2:, 0] == pytest.approx([GOING + DEPTH - 0.06, GOING + DEPTH + 0.06])
    assert unseen.tread_depth_m is None
    assert unseen.nosing_overhang_m is None


def test_nothing_is_measured_across_a_missing_tread():
    steps = measured(shape(0), shape(2), shape(3), n_missing=(0, 1, 0))
    assert [step.going_m is None for step in steps] == [True, False, True]
    assert [step.rise_m is None for step in steps] == [False, True, False]
    assert steps[0].pitch_deg is None
    (footless,) = measured(shape(0, foot=None), base=None)
    assert footless.rise_m is None


def test_the_flight_that_goes_straight_on_ends_the_going_of_the_landing():
    steps = measured(shape(0), after=shape(1))
    assert len(steps) == 1
    assert steps[0].going_m.value == pytest.approx(GOING)


def test_the_going_of_a_wedge_is_as_uncertain_as_the_middle_of_its_nosing():
    turn = math.radians(15.0)
    slanting = edge(0.32, slope=-math.tan(turn))
    wedges = [
        turned(0, 0.0, (0.0, 0.0), left=edge(0.6, 0.003), right=edge(-0.6, 0.004), back=slanting),
        turned(1, turn, (0.3, 0.0)),
        turned(2, 2.0 * turn, (0.55, 0.2)),
    ]
    first, second, _ = measured(*wedges, base=None)
    # The next nosing is the line x = 0.3 - y tan(15 deg).
    assert first.going_lcr_m == pytest.approx([0.3 - w * math.tan(turn) for w in (0.42, 0.0, -0.42)])
    # The middle between sides known to 3 and 4 mm is known to 2.5 mm.
    assert part(first.going_m, "edge") == pytest.approx(2.0 * math.tan(turn) * 0.0025, rel=1e-3)
    assert part(first.tread_depth_m, "edge") == pytest.approx(2.0 * math.tan(turn) * 0.0025, rel=1e-3)
    # Square to the riser, from the nosing above to the back; the next nosing but one is 0.25 cos + 0.2 sin ahead.
    leaning = turned(0, 0.0, (0.0, 0.0), plane=plane(RISE, (0.0, 0.03)))
    # Back from a nosing one goes along the climb of the step below, x, and comes to its nosing at w cos(15 deg).
    expected = [RISE - 0.03 * w * math.cos(turn) for w in (0.42, 0.0, -0.42)]
    assert measured(leaning, *wedges[1:], base=None)[1].rise_lcr_m == pytest.approx(expected)
    # Along its own climb to a nosing that is turned by as much again.
    on_m = (0.25 * math.cos(2.0 * turn) + 0.2 * math.sin(2.0 * turn)) / math.cos(turn)
    assert second.going_m.value == pytest.approx(on_m)
    ahead_m = 0.25 * math.cos(turn) + 0.2 * math.sin(turn)
    assert second.nosing_overhang_m.value == pytest.approx(DEPTH - ahead_m)
    assert first.nosing_overhang_m.value == pytest.approx(0.02 * math.cos(turn))
    # Of a back that is hidden all that is known is the depth on the line of the going.
    hidden = turned(0, 0.0, (0.0, 0.0), back=None, back_limits=(0.31, 0.35))
    assert measured(hidden, *wedges[1:], base=None)[0].nosing_overhang_m.value == pytest.approx(0.03)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_curved_flight_is_measured_along_its_arc(sense):
    arc = Arc(np.array([0.0, 2.0 * sense]), 2.0, sense, 0.01, 0.004)
    slants = {"left": edge(0.6, slope=0.1), "right": edge(-0.6, slope=0.3)}
    shapes = [
        turned(
            k,
            sense * 0.15 * k,
            (2.0 * math.sin(0.15 * k), sense * (2.0 - 2.0 * math.cos(0.15 * k))),
            arc=arc,
            nosing_offsets=(0.0, 0.001 * k, 0.0),
            **slants,
        )
        for k in range(3)
    ]
    steps = measured(*shapes)
    for step in steps[:2]:
        # 0.15 rad of a radius of 2 m, 0.42 m less or more on the outer lines.
        expected = [0.15 * (2.0 - sense * w) for w in (0.42, 0.0, -0.42)]
        assert step.going_lcr_m == pytest.approx(expected)
        # Its radius is as uncertain as the middle between the sides.
        assert part(step.going_m, "edge") == pytest.approx(2.0 * 0.15 * 0.004, rel=1e-3)
        # Square to sides that slant by 0.2.
        assert step.width_m.value == pytest.approx(WIDTH * math.cos(math.atan(0.2)))
    assert [step.rise_m.value for step in steps] == pytest.approx([RISE, RISE + 0.001, RISE + 0.001])
    # The flight behind its landing goes straight on.
    (landing,) = measured(shapes[0], after=shape(1, origin_m=np.array([0.9, 0.0])))
    assert landing.going_m.value == pytest.approx(0.9)
