"""Which step a finding is said of."""

import dataclasses

import pytest

from stair_inspector.codes import Verdict
from stair_inspector.codes.at_steps import findings_at_steps, outside_at_steps
from tests.codes.flights import changed, even, flight_of, inspection_of, measured, step
from tests.codes.test_judge import ADJACENT, GOING, RANGE, RISER, judged


def rising(*rises, first=1, flight=1):
    """The steps of a flight with these rises, the last one a landing."""
    kinds = ["tread"] * (len(rises) - 1) + ["landing"]
    return [
        step(k, kind, flight=flight, rise=rise) for k, (kind, rise) in enumerate(zip(kinds, rises, strict=True), first)
    ]


def marked(steps, *rules, flights=None):
    """Numbers of the steps that are outside a limit, with the rules that say so."""
    inspection = inspection_of(steps, flights)
    outside = outside_at_steps(inspection, judged(inspection, *rules))
    return {number: [found.rule.rule_id for found in findings] for number, findings in outside.items()}


@pytest.mark.parametrize("odd", [0.180, 0.150])
def test_of_a_range_that_is_too_large_the_odd_step_is_marked(odd):
    steps = rising(0.165, 0.166, 0.164, odd, 0.165)
    inspection = inspection_of(steps)
    (found,) = judged(inspection, RANGE).findings
    # The finding itself is about the smallest and the largest.
    assert (len(found.steps), found.verdict) == (2, Verdict.OUTSIDE)
    assert marked(steps, RANGE) == {4: ["range"]}


def test_of_two_neighbours_the_one_farther_from_the_usual_rise_is_marked():
    assert marked(rising(0.165, 0.165, 0.172, 0.165, 0.165), ADJACENT) == {3: ["adjacent", "adjacent"]}


def test_two_steps_that_are_as_odd_are_both_marked():
    # 6 mm below and above what is usual; half a micrometre is no difference, two are one.
    for more, expected in ((0.0, [2, 4]), (0.0000005, [2, 4]), (0.000002, [4]), (-0.000002, [2])):
        assert list(marked(rising(0.165, 0.159, 0.165, 0.171 + more, 0.165), RANGE)) == expected


def test_what_is_odd_is_told_by_the_steps_own_flight():
    lower = rising(0.150, 0.150, 0.162, 0.150)
    upper = rising(0.162, 0.162, 0.162, 0.150, first=5, flight=2)
    flights = [flight_of(lower), flight_of(upper, flight_id=2)]
    assert list(marked([*lower, *upper], RANGE, flights=flights)) == [3, 8]


def test_a_step_that_was_not_measured_is_not_odd():
    steps = changed(rising(0.165, 0.165, 0.180, 0.165, 0.165), 2, rise_m=None)
    assert marked(steps, RANGE) == {3: ["range"]}


def test_each_step_beyond_a_limit_is_marked_and_advice_marks_none():
    steps = changed(changed(even(rise=0.15), 2, rise_m=measured(0.18, 0.001)), 5, rise_m=measured(0.19, 0.001))
    assert marked(steps, RISER) == {2: ["riser"], 5: ["riser"]}
    assert marked(steps, dataclasses.replace(RISER, severity="advisory")) == {}
    assert marked(even(rise=0.15), RISER, GOING, RANGE) == {}


def test_every_step_is_told_all_that_is_said_of_it():
    steps = rising(0.165, 0.165, 0.165)
    inspection = inspection_of(steps)
    told = findings_at_steps(inspection, judged(inspection, GOING, RISER, RANGE, ADJACENT))
    names = {number: [found.rule.rule_id for found in findings] for number, findings in told.items()}
    # What is within is said of both ends of it; a landing has no going.
    assert names == {
        1: ["going", "riser", "range", "adjacent"],
        2: ["going", "riser", "adjacent", "adjacent"],
        3: ["riser", "range", "adjacent"],
    }
