"""The values of a flight, worked out from steps whose values are stated."""

import dataclasses
import math

import numpy as np
import pytest

from stair_inspector.model import Arc, Measured
from stair_inspector.stages.flight_values import flight_of, kinds_of, statistics_of
from stair_inspector.stages.rejects import Forced
from tests.codes.flights import step
from tests.stages.stated_shapes import DEPTH, chain_of, common, shape, turned

SLOPE = 0.17 / 0.28


def stated(rise=None, going=None, n=3):
    """Steps of a flight of 170 mm and 280 mm, with these parts of their uncertainties (k = 2)."""
    rise_m = Measured(0.17, 0.0, tuple((rise or {}).items()))
    going_m = Measured(0.28, 0.0, tuple((going or {}).items()))
    return [step(k, rise=rise_m, going=going_m if k < n else None) for k in range(1, n + 1)]


def flight(steps, shapes=None, n_missing=None, base=0, **known):
    shapes = tuple(shape(k) for k in range(len(steps))) if shapes is None else tuple(shapes)
    return flight_of(1, chain_of(shapes, base, n_missing), shapes, steps, common(**known))


def part(value, name):
    return dict(value.parts).get(name, 0.0)


def in_degrees(of_slope):
    """The uncertainty of the angle of a slope that is so uncertain."""
    return math.degrees(of_slope) / (1.0 + SLOPE**2)


# --- pitch ---------------------------------------------------------------------------------------------------------


def test_the_pitch_is_that_of_the_line_through_all_nosings():
    assert flight(stated()).pitch_deg.value == pytest.approx(math.degrees(math.atan(SLOPE)))
    uneven = stated(n=4)
    uneven[1] = dataclasses.replace(uneven[1], rise_m=Measured(0.20, 0.0))
    uneven[2] = dataclasses.replace(uneven[2], going_m=Measured(0.31, 0.0))
    run, height = [0.0, 0.28, 0.56, 0.87], [0.0, 0.20, 0.37, 0.54]
    expected = math.degrees(math.atan(np.polyfit(run, height, 1)[0]))
    assert flight(uneven).pitch_deg.value == pytest.approx(expected)


def test_the_pitch_of_a_line_through_nosings_is_as_sure_as_least_squares_make_it():
    pitch = flight(stated({"noise": 0.003, "layers": 0.004}, {"noise": 0.002})).pitch_deg
    # A rise known to 5 mm ends at two nosings of 5 / sqrt 2 mm each; what a going is wrong by counts by the slope.
    of_nosing = math.hypot(0.005, SLOPE * 0.002) / math.sqrt(2.0)
    # Three nosings at -0.28, 0 and 0.28 m of the middle.
    assert part(pitch, "noise") == pytest.approx(in_degrees(of_nosing / math.sqrt(2.0 * 0.28**2)))


def test_what_all_nosings_have_in_common_turns_the_line_by_the_whole_run():
    pitch = flight(stated({}, {"edge": 0.004}), registration_m=0.001, up_rad=0.002).pitch_deg
    assert part(pitch, "edge") == pytest.approx(in_degrees(SLOPE * 0.004 / 0.56))
    # The least sure of the goings counts.
    steps = stated({}, {"edge": 0.004})
    steps[1] = dataclasses.replace(steps[1], going_m=Measured(0.28, 0.0, (("edge", 0.006),)))
    assert part(flight(steps).pitch_deg, "edge") == pytest.approx(in_degrees(SLOPE * 0.006 / 0.56))
    assert part(pitch, "registration") == pytest.approx(in_degrees(2.0 * 0.001 / 0.56))
    assert part(pitch, "up") == pytest.approx(2.0 * math.degrees(0.002))


def test_a_flight_with_a_gap_or_of_one_step_has_no_line():
    assert flight(stated(), n_missing=(0, 1, 0)).pitch_deg is None
    assert flight(stated(n=1)).pitch_deg is None
    for lost in ({"rise_m": None}, {"going_m": None}):
        steps = stated()
        steps[1] = dataclasses.replace(steps[1], **lost)
        assert flight(steps).pitch_deg is None
    # The first rise stands below the first nosing, and the last going behind the last one.
    first = stated()
    first[0] = dataclasses.replace(first[0], rise_m=None)
    assert flight(first).pitch_deg is not None
    two = flight(stated(n=2)).pitch_deg
    assert two.value == pytest.approx(math.degrees(math.atan(SLOPE)))


# --- width, number, shape ------------------------------------------------------------------------------------------


def test_the_width_is_the_mean_of_the_treads_and_only_its_noise_shrinks():
    widths = [Measured(each, 0.0, (("noise", 0.003), ("edge", 0.004))) for each in (1.0, 1.1, 1.2, 1.3)]
    steps = [step(k, width=width) for k, width in enumerate(widths, 1)]
    steps.append(step(5, "landing", width=2.0))
    width = flight(steps).width_m
    assert width.value == pytest.approx(1.15)
    assert part(width, "noise") == pytest.approx(0.003 / 2.0)
    assert part(width, "edge") == pytest.approx(0.004)
    # Where there is but a landing its own width is that of the flight.
    assert flight(steps[4:]).width_m.value == pytest.approx(2.0)
    assert flight([dataclasses.replace(each, width_m=None) for each in steps]).width_m is None


def test_risers_are_counted_with_those_of_missing_treads():
    assert flight(stated()).n_risers == 3
    assert flight(stated(), n_missing=(0, 2, 0)).n_risers == 5
    # Without a floor below it the first step has no riser.
    assert flight(stated(), base=None).n_risers == 2


@pytest.mark.parametrize(
    ("turns_deg", "name"),
    [
        ([0.0, 2.0, 0.0, 0.0], "straight"),
        ([0.0, 30.0, 60.0, 90.0], "winder"),
        ([0.0, 45.0, 90.0, 130.0], "spiral"),
        ([0.0, -45.0, -90.0, -130.0], "spiral"),
        # It turns back on the way: no spiral, however far it turns.
        ([0.0, 60.0, 140.0, 125.0], "winder"),
    ],
)
def test_a_flight_that_turns_on_and_on_is_a_spiral(turns_deg, name):
    shapes = [turned(k, math.radians(turn), (0.28 * k, 0.0)) for k, turn in enumerate(turns_deg)]
    assert flight(stated(n=4), shapes, base=None).shape == name


def test_a_curved_flight_has_the_radius_of_its_middle_line():
    arc = Arc(np.array([0.0, 2.0]), 2.0, 1.0, 0.01, 0.004)
    shapes = [shape(k, arc=arc) for k in range(3)]
    curved = flight(stated(), shapes, scale=0.001)
    assert curved.shape == "curved"
    assert curved.radius_m.value == 2.0
    # Twice 10 mm of the radius, 4 mm of the middle between the sides, a thousandth of 2 m.
    assert dict(curved.radius_m.parts) == pytest.approx({"noise": 0.02, "edge": 0.008, "scale": 0.004})
    assert flight(stated()).radius_m is None


# --- statistics ----------------------------------------------------------------------------------------------------


def test_neighbours_are_compared_only_where_both_are_known():
    values = [(1, 0.170), (2, 0.175), (3, None), (4, 0.160), (5, 0.168)]
    found = statistics_of([(k, None if value is None else Measured(value, 0.0)) for k, value in values])
    assert (found.n, found.min, found.max) == (4, 0.160, 0.175)
    assert found.mean == pytest.approx((0.170 + 0.175 + 0.160 + 0.168) / 4.0)
    assert found.range == pytest.approx(0.015)
    # 15 mm lie between steps 2 and 4, which are no neighbours.
    assert found.max_adjacent == pytest.approx(0.008)
    assert found.at == (4, 5)
    # The largest step may be one downwards.
    fallen = statistics_of([(k, Measured(value, 0.0)) for k, value in enumerate((0.170, 0.180, 0.160, 0.165), 1)])
    assert (fallen.max_adjacent, fallen.at) == (pytest.approx(0.020), (2, 3))
    alone = statistics_of([(1, Measured(0.17, 0.0)), (2, None)])
    assert (alone.n, alone.range, alone.max_adjacent, alone.at) == (1, 0.0, None, None)
    assert statistics_of([(1, None)]) is None


def test_a_landing_has_no_going_in_the_statistics_and_has_a_rise():
    steps = stated(n=3)
    # The going of a landing ends at the next flight's first nosing.
    steps[2] = dataclasses.replace(steps[2], kind="landing", going_m=Measured(1.2, 0.0), rise_m=Measured(0.16, 0.0))
    found = flight(steps)
    assert (found.going.n, found.going.max) == (2, 0.28)
    assert (found.rise.n, found.rise.min) == (3, 0.16)


# --- landings ------------------------------------------------------------------------------------------------------


def kinds(depths_m, bases=(), forced=None):
    shapes = tuple(shape(k, extent=(0.0, depth, -0.6, 0.6)) for k, depth in enumerate(depths_m))
    steps = stated(n=len(depths_m))
    return kinds_of(chain_of(shapes), shapes, steps, frozenset(bases), Forced(forced or {}))


def test_only_the_last_step_is_a_landing_by_its_depth():
    assert kinds([DEPTH, DEPTH, 1.2]) == ["tread", "tread", "landing"]
    assert kinds([DEPTH, 1.2, DEPTH]) == ["tread", "tread", "tread"]
    # 280 mm are usual: 1.8 times as deep, 504 mm, is a landing.
    assert kinds([DEPTH, DEPTH, 0.50])[2] == "tread"
    assert kinds([DEPTH, DEPTH, 0.51])[2] == "landing"


def test_a_single_step_is_a_landing_where_it_is_deeper_than_any_tread():
    shapes = tuple(shape(0, extent=(0.0, depth, -0.6, 0.6)) for depth in (0.61, 0.63))
    alone = [dataclasses.replace(stated(n=1)[0], going_m=None)]
    # 620 mm from its nosing.
    found = [kinds_of(chain_of([each]), (each,), alone, frozenset(), Forced({})) for each in shapes]
    assert found == [["tread"], ["landing"]]


def test_where_another_flight_begins_is_a_landing_and_the_user_has_the_last_word():
    # The steps stand on the surfaces 1, 2, 3.
    assert kinds([DEPTH, DEPTH, DEPTH], bases=(2,)) == ["tread", "landing", "tread"]
    assert kinds([DEPTH, DEPTH, DEPTH], bases=(2,), forced={2: "tread"}) == ["tread"] * 3
    assert kinds([DEPTH, DEPTH, 1.2], forced={3: "tread"})[2] == "tread"
    assert kinds([DEPTH, DEPTH, DEPTH], forced={1: "landing"})[0] == "landing"
