"""What no staircase has is taken out, with everything that hangs on the same edge, and is never judged."""

from dataclasses import replace

import numpy as np
import pytest

from stair_inspector import priors
from stair_inspector.codes import Verdict, check
from stair_inspector.files.rule_sets import find_rule_set
from stair_inspector.model import IMPOSSIBLE, Measured
from stair_inspector.params import FlightsParams
from stair_inspector.stages.impossible import steepest_pitch_deg, take_out_impossible
from stair_inspector.stages.survey import Survey
from tests.codes.flights import changed, even, flight_of, inspection_of, measured

LIMITS = FlightsParams()
GOING_M, WIDTH_M, N = 0.28, 1.0, 6
BAD = measured(-0.0855, 0.0851)


def steps_of(n=N):
    """An even flight, its nosings square to x."""
    return [
        replace(
            step,
            climb=np.array([1.0, 0.0, 0.0]),
            nosing=nosing_at(step.step_id * GOING_M),
            pitch_deg=None if step.going_m is None else measured(30.0, 0.1),
            going_lcr_m=None if step.going_m is None else (0.29, 0.29, 0.29),
            rise_lcr_m=(0.165, 0.165, 0.165),
        )
        for step in even(n, u=0.001)
    ]


def nosing_at(x_left_m, x_right_m=None):
    x_right_m = x_left_m if x_right_m is None else x_right_m
    return np.array([[x_left_m, WIDTH_M / 2, 1.0], [x_right_m, -WIDTH_M / 2, 1.0]])


def reviewed(steps, shape="straight", limits=LIMITS):
    survey = Survey(tuple(steps), (flight_of(steps, shape),), tuple(range(len(steps))), ())
    found = take_out_impossible(survey, limits)
    return found, [(note.code, note.step) for note in found.notes], survey


def missing(survey):
    names = ("rise_m", "going_m", "tread_depth_m", "nosing_overhang_m", "pitch_deg", "width_m")
    # A landing at the end has no going, depth, overhang and pitch in any case.
    return {
        (step.step_id, name.rpartition("_")[0])
        for step in survey.steps
        for name in names
        if getattr(step, name) is None and (step.kind == "tread" or name in ("rise_m", "width_m"))
    }


def hanging_on(step_id):
    """What is lost with the nosing of a step amid a flight."""
    over = ("going", "pitch", "nosing_overhang")
    own = {(step_id, name) for name in ("rise", "tread_depth", *over)}
    return own | {(step_id - 1, name) for name in over} | {(step_id + 1, "rise")}


def test_a_flight_that_can_be_stays_as_it_is():
    found, notes, before = reviewed(steps_of())
    assert found is before
    assert not notes


def test_of_a_going_that_is_not_positive_the_edge_that_fits_its_other_neighbour_worse_is_none():
    # The nosing of step 4 lies far in front: the going to it is negative, the one from it far too long.
    steps = changed(changed(steps_of(), 3, going_m=BAD), 4, going_m=measured(0.65, 0.001))
    found, notes, _ = reviewed(steps)
    assert notes == [(IMPOSSIBLE, 4)]
    assert missing(found) == hanging_on(4)
    assert found.notes[0].message == (
        "step 4: the nosing of step 4 would lie 86 mm in front of that of step 3, as on no staircase: what was found "
        "is not its nosing, and nothing is measured from it"
    )
    # Or that of step 3 lies far behind: then the going to it is far too long.
    steps = changed(changed(steps_of(), 3, going_m=BAD), 2, going_m=measured(0.65, 0.001))
    found, notes, _ = reviewed(steps)
    assert notes == [(IMPOSSIBLE, 3)]
    assert missing(found) == hanging_on(3)


def test_the_last_step_of_a_flight_has_no_other_neighbour_to_fit():
    found, notes, _ = reviewed(changed(steps_of(), 5, going_m=BAD))
    assert notes == [(IMPOSSIBLE, 6)]
    assert missing(found) == {(5, "going"), (5, "pitch"), (5, "nosing_overhang"), (6, "rise")}


def test_where_neither_edge_has_another_neighbour_both_are_doubted():
    _, notes, _ = reviewed(changed(steps_of(2), 1, going_m=BAD))
    assert notes == [(IMPOSSIBLE, 1), (IMPOSSIBLE, 2)]


def test_statistics_and_pitch_of_the_flight_are_without_what_was_taken_out():
    found, _, _ = reviewed(changed(steps_of(), 5, going_m=BAD))
    (flight,) = found.flights
    assert flight.pitch_deg is None
    assert (flight.going.n, flight.going.min) == (4, pytest.approx(0.29))
    assert flight.rise.n == 5


def test_the_pitch_of_a_flight_stays_where_its_line_does():
    # A width is no part of the line; nor is the rise to the first nosing.
    for step_id, name in ((2, "width_m"), (1, "rise_m")):
        found, notes, before = reviewed(changed(steps_of(), step_id, **{name: Measured(-0.01, 0.001)}))
        assert notes == [(IMPOSSIBLE, step_id)]
        assert found.flights[0].pitch_deg == before.flights[0].pitch_deg
    found, _, _ = reviewed(changed(steps_of(), 2, rise_m=Measured(-0.01, 0.001)))
    assert found.flights[0].pitch_deg is None


def test_the_ends_of_a_flight_have_no_neighbours_beyond():
    going_on = {"going_m": measured(0.29, 0.001), "tread_depth_m": measured(0.31, 0.001)}
    # The first nosing lies before the second, of which the going after it fits.
    found, notes, _ = reviewed(changed(changed(steps_of(), N, **going_on), 1, going_m=BAD))
    assert notes == [(IMPOSSIBLE, 1)]
    assert (found.steps[0].rise_m, found.steps[0].going_m, found.steps[1].rise_m) == (None, None, None)
    assert found.steps[-1].going_m == going_on["going_m"]
    # Behind the last step the next flight begins: its own nosing is all there is to doubt.
    found, notes, _ = reviewed(changed(steps_of(), N, **{**going_on, "going_m": BAD}))
    assert notes == [(IMPOSSIBLE, N)]
    assert found.steps[-1].going_m is None
    assert found.steps[-2].going_m is None
    assert found.steps[0].rise_m is not None


def test_a_pitch_steeper_than_a_ladder_is_none_and_a_steep_stair_is_one():
    assert steepest_pitch_deg(LIMITS) == priors.STEEPEST_PITCH_DEG
    steps = steps_of()
    assert not reviewed(changed(steps, 5, pitch_deg=measured(59.0, 0.1)))[1]
    assert reviewed(changed(steps, 5, pitch_deg=measured(61.0, 0.1)))[1] == [(IMPOSSIBLE, 6)]
    # A user who looks for rises of 600 mm finds pitches of 65 degrees.
    assert not reviewed(changed(steps, 5, pitch_deg=measured(61.0, 0.1)), limits=FlightsParams(max_rise_m=0.6))[1]


def test_nosings_that_cross_are_none():
    steps = steps_of()
    crossing = changed(steps, 6, nosing=nosing_at(7 * GOING_M, 4.9 * GOING_M))
    assert reviewed(crossing)[1] == [(IMPOSSIBLE, 6)]
    assert not reviewed(changed(steps, 6, nosing=nosing_at(7 * GOING_M, 5.1 * GOING_M)))[1]
    # A short one that would cross it if it went on does not.
    short = np.array([[7 * GOING_M, WIDTH_M / 2, 1.0], [5.5 * GOING_M, 0.0, 1.0]])
    assert not reviewed(changed(steps, 6, nosing=short))[1]
    # The narrow ends of wedges meet; but a going that is not positive on a measuring line is none there either.
    assert not reviewed(crossing, shape="spiral")[1]
    on_a_line = changed(steps, 5, going_lcr_m=(0.5, 0.29, -0.01))
    assert reviewed(on_a_line, shape="spiral")[1] == [(IMPOSSIBLE, 6)]


@pytest.mark.parametrize("name", ["rise_m", "tread_depth_m", "width_m"])
def test_a_length_that_is_not_positive_is_none(name):
    found, notes, _ = reviewed(changed(steps_of(), 3, **{name: Measured(-0.01, 0.001)}))
    assert notes == [(IMPOSSIBLE, 3)]
    wanted = {(3, name.rpartition("_")[0])}
    assert missing(found) == wanted | ({(3, "nosing_overhang")} if name == "tread_depth_m" else set())


def test_nothing_of_it_is_judged_and_the_reason_is_given():
    found, _, _ = reviewed(changed(steps_of(), 5, going_m=BAD))
    inspection = inspection_of(found.steps, found.flights)
    inspection = replace(inspection, notes=found.notes)
    findings = check(inspection, find_rule_set("us-irc-2024")).findings
    own = [each for each in findings if each.rule.quantity == "going" and each.steps == (5,)]
    assert own
    assert {each.verdict for each in own} == {Verdict.NOT_MEASURED}
    assert {each.reason for each in own} == {found.notes[0].message}
    assert all(each.value is None or abs(each.value) < 1.0 for each in own)
    rises = [each for each in findings if each.rule.quantity == "rise" and each.steps == (6,)]
    assert {each.reason for each in rises} == {found.notes[0].message}
