"""Where a rule is held against a flight, and what is said where it cannot be."""

import dataclasses

import pytest

from stair_inspector.codes import Limit, Verdict
from stair_inspector.codes.rules import Condition
from tests.codes.flights import changed, even, flight_of, inspection_of, measured, step
from tests.codes.test_judge import ADJACENT, GOING, GOING_RANGE, RANGE, RISER, judged
from tests.codes.test_rules import rule

NOSING = rule(
    "nosing",
    quantity="nosing_overhang",
    minimum=Limit.of("20", "mm"),
    maximum=None,
    only_where=Condition("going", Limit.of("280", "mm")),
)
SUMS = rule("sums", quantity="two_r_plus_g", minimum=None, maximum=Limit.of("700", "mm"))
WIDTH = rule("width", quantity="width", minimum=Limit.of("900", "mm"), maximum=None)


def two_flights(lower, n_upper=3, **upper):
    """Inspect a flight of these steps and a second one above it."""
    first = len(lower) + 1
    above = [dataclasses.replace(each, step_id=each.step_id + first - 1, flight=2) for each in even(n_upper, **upper)]
    return [*lower, *above], [flight_of(lower), flight_of(above, flight_id=2)]


def test_two_steps_have_a_spread():
    # 12 mm between two goings, of which 10 are allowed.
    steps = changed(even(3, u=0.0005), 2, going_m=measured(0.302, 0.0005))
    (found,) = judged(inspection_of(steps), GOING_RANGE).findings
    assert (found.steps, found.verdict) == ((1, 2), Verdict.OUTSIDE)
    assert found.value == pytest.approx(0.012)


def test_what_a_single_step_has_no_difference_of_does_not_apply_and_is_not_open():
    adjacent = dataclasses.replace(ADJACENT, quantity="going")
    for each in (GOING_RANGE, adjacent):
        (found,) = judged(inspection_of(even(2)), each).findings
        assert (found.verdict, found.applies, found.is_open) == (Verdict.NOT_JUDGED, False, False)
        assert found.reason == "does not apply: a single step differs from nothing"
    # Of two goings one was not measured: the clause applies, and nothing is said of it.
    (open_one,) = judged(inspection_of(changed(even(3), 1, going_m=None)), GOING_RANGE).findings
    assert (open_one.verdict, open_one.is_open) == (Verdict.NOT_MEASURED, True)


def test_a_flight_without_treads_is_open_also_for_a_clause_with_a_condition():
    """That no step meets the condition excuses; that no step was seen does not."""
    (found,) = judged(inspection_of([step(1, "landing")]), NOSING).findings
    assert (found.verdict, found.applies) == (Verdict.NOT_MEASURED, True)
    assert found.reason == "no tread of this flight was seen"


def test_a_value_on_the_limit_of_a_condition_is_not_below_it():
    steps = changed(even(going=0.30, nosing_overhang=0.0), 2, going_m=measured(0.28, 0.0))
    (found,) = judged(inspection_of(steps), NOSING).findings
    assert found.applies is False


def test_the_value_that_is_missing_of_a_pair_is_the_one_that_is_named():
    steps = changed(even(4), 2, rise_m=None)
    reasons = {found.steps: found.reason for found in judged(inspection_of(steps), ADJACENT).findings}
    assert reasons[1, 2] == reasons[2, 3] == "not measured at step 2"


def test_why_a_value_is_missing_is_not_taken_from_another_steps_note():
    steps = changed(changed(even(6), 3, going_m=None, width_m=None), 5, width_m=None)
    notes = [
        ("step_impossible", "step 4: what was found is not its nosing", 4),
        ("back_hidden", "step 3: its back is hidden", 3),
        ("side_unobserved", "step 1: a side was not seen", 1),
        ("nosing_unobserved", "step 2: its nosing was not seen", 2),
    ]
    result = judged(inspection_of(steps, notes=notes), WIDTH, GOING, RISER)
    # A width lies on one tread: the nosing above takes none of it.
    assert [found.reason for found in result.of_rule("width")] == [
        notes[2][1],
        "",
        "not measured at step 3",
        "",
        "not measured at step 5",
    ]
    assert result.of_rule("going")[2].reason == notes[0][1]
    # Doubts of a nosing are those of the rise, not those of a side or a back.
    assert [found.reason for found in result.of_rule("riser")] == ["", notes[3][1], "", "", "", ""]
    # A note about something else does not explain a going.
    other = judged(inspection_of(changed(even(6), 3, going_m=None), notes=notes[1:2]), GOING)
    assert other.of_rule("going")[2].reason == "not measured at step 3"


def test_the_next_flights_first_step_does_not_explain_the_last_going_of_this_one():
    lower = [step(1), step(2), step(3, going=None)]
    steps, flights = two_flights(lower)
    above = "no nosing was seen above step 3, up to which its going is measured"
    for code in ("tread_missing", "step_impossible"):
        result = judged(inspection_of(steps, flights, notes=[(code, "said of step 4", 4)]), GOING, SUMS)
        for name in ("going", "sums"):
            reasons = {found.steps: found.reason for found in result.of_rule(name)}
            assert reasons[3,] == above
    # A width of the same step does not end at a nosing above.
    narrow = changed(steps, 3, width_m=None)
    assert judged(inspection_of(narrow, flights), WIDTH).of_step(3)[0].reason == "not measured at step 3"


def test_the_last_riser_is_in_no_sum_though_another_flight_has_no_upper_end():
    said = "the riser up to a landing has no going above it"
    steps, flights = two_flights([step(1), step(2), step(3, going=None)])
    result = judged(inspection_of(steps, flights), RISER, SUMS)
    assert any(note.startswith(said) for note in result.notes)
    assert judged(inspection_of(steps[:3], flights[:1]), SUMS).notes == ()


def test_a_spread_with_too_few_certain_steps_is_not_judged():
    """Of two steps the clause holds at one for certain: there is no pair at which it does."""
    spread = dataclasses.replace(NOSING, statistic="flight_range", minimum=None, maximum=Limit.of("10", "mm"))
    steps = even(3, going=0.25, nosing_overhang=0.02)
    steps = changed(steps, 2, going_m=measured(0.2795, 0.001), nosing_overhang_m=measured(0.05, 0.0))
    (found,) = judged(inspection_of(steps), spread).findings
    assert (found.steps, found.verdict) == ((1, 2), Verdict.NOT_JUDGED)


def test_flights_with_a_missing_rise_leave_the_spread_of_the_others_alone():
    lower = changed(even(4), 2, rise_m=None)
    steps, flights = two_flights(lower, 4)
    found = judged(inspection_of(steps, flights), RANGE).findings
    assert [(each.flight, each.verdict) for each in found] == [(1, Verdict.NOT_MEASURED), (2, Verdict.WITHIN)]


COUNT = rule("count", quantity="n_risers", statistic="flight", minimum=None, maximum=Limit.of("18", "count"))
HEIGHT = rule("height", quantity="flight_rise", statistic="flight", minimum=None, maximum=Limit.of("2", "m"))
PITCH = rule("pitch", quantity="pitch", statistic="flight", minimum=None, maximum=Limit.of("42", "deg"))


def of_flight(steps, flights=None, notes=()):
    """What is said of the number of risers of a flight, and of its height."""
    result = judged(inspection_of(steps, flights, notes), COUNT, HEIGHT)
    return [(found.value, found.verdict, found.reason) for found in result.findings]


def test_a_flight_of_which_more_was_seen_than_measured_is_neither_few_risers_nor_low():
    goes_on = "about 4 more are seen below"
    flights = [dataclasses.replace(flight_of(even(6)), goes_on=goes_on)]
    for _, verdict, reason in of_flight(even(6), flights):
        assert verdict is Verdict.NOT_MEASURED
        assert f"the flight goes on: {goes_on}" in reason
    unseen = ("rise_unobserved", "step 1 has no rise: no floor was seen", 1)
    for _, verdict, reason in of_flight(changed(even(6), 1, rise_m=None), notes=[unseen]):
        assert (verdict, unseen[1] in reason) == (Verdict.NOT_MEASURED, True)
    for _, verdict, reason in of_flight([step(k) for k in range(1, 5)]):
        assert (verdict, "there may be risers above step 4" in reason) == (Verdict.NOT_MEASURED, True)


def test_a_riser_within_a_flight_that_was_not_measured_is_counted_but_adds_no_height():
    count, height = of_flight(changed(even(6), 3, rise_m=None))
    assert count == (6.0, Verdict.WITHIN, "")
    assert height[1] is Verdict.NOT_MEASURED
    assert "a rise within the flight was not measured" in height[2]
    # The second rise is within the flight, the first one below its first nosing.
    assert of_flight(changed(even(6), 2, rise_m=None))[1][1] is Verdict.NOT_MEASURED
    whole = of_flight(even(6))
    assert [(verdict, reason) for _, verdict, reason in whole] == [(Verdict.WITHIN, "")] * 2
    assert [value for value, _, _ in whole] == pytest.approx([6.0, 0.99])
    nothing = [dataclasses.replace(each, rise_m=None) for each in even(3)]
    assert of_flight(nothing)[1][:2] == (None, Verdict.NOT_MEASURED)


def test_a_count_is_exact():
    (found,) = judged(inspection_of(even(6)), COUNT).findings
    assert (found.value, found.u) == (6.0, 0.0)


def test_why_a_flight_has_no_pitch():
    steps = even(4)
    without = [dataclasses.replace(flight_of(steps), pitch_deg=None)]
    (found,) = judged(inspection_of(steps, without), PITCH).findings
    assert found.reason == "a nosing is missing or the flight has a single step: it has no line"
    broken = [flight_of(steps, pitch=measured(float("nan"), 0.1))]
    (found,) = judged(inspection_of(steps, broken), PITCH).findings
    assert found.reason == "its value or its uncertainty is no finite number"
    (found,) = judged(inspection_of(steps), PITCH).findings
    assert (found.verdict, found.reason) == (Verdict.WITHIN, "")


def test_an_upper_end_that_was_not_seen_leaves_the_range_of_rises_open_and_that_of_goings_not():
    treads = [step(k) for k in range(1, 5)]
    rises, goings = (judged(inspection_of(treads), each).findings[0] for each in (RANGE, GOING_RANGE))
    assert rises.verdict is Verdict.NOT_MEASURED
    assert "there may be risers above step 4" in rises.reason
    assert (goings.verdict, goings.reason) == (Verdict.WITHIN, "")
