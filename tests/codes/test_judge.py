"""The verdicts, on flights whose values are stated."""

import dataclasses
import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stair_inspector.codes import Check, Limit, Verdict, check, edited, gravest
from stair_inspector.codes.phrases import value_text
from stair_inspector.codes.rules import Condition
from stair_inspector.content.check_records import check_record
from stair_inspector.content.verdicts import verdict_sentence
from stair_inspector.errors import ConfigError
from stair_inspector.files.rule_sets import find_rule_set
from stair_inspector.model import Measured, Observation
from stair_inspector.writers.text import check_text
from tests.codes.flights import USUAL, changed, even, flight_of, inspection_of, measured, step
from tests.codes.test_rules import rule, rule_set

RISER = rule(minimum=None, maximum=Limit.of("170", "mm"))
RANGE = rule("range", statistic="flight_range", minimum=None, maximum=Limit.of("10", "mm"))
ADJACENT = rule("adjacent", statistic="adjacent_difference", minimum=None, maximum=Limit.of("5", "mm"))
GOING = rule("going", quantity="going", minimum=Limit.of("250", "mm"), maximum=None)
GOING_RANGE = rule(
    "going-range", quantity="going", statistic="flight_range", minimum=None, maximum=Limit.of("10", "mm")
)


def judged(inspection, *rules, decision="guarded") -> Check:
    return check(inspection, rule_set(*rules), decision)


def verdicts(result, rule_id=None):
    return [(found.steps, found.verdict) for found in result.findings if rule_id in (None, found.rule.rule_id)]


SILENT = (Verdict.NOT_MEASURED, Verdict.NOT_JUDGED, Verdict.NOT_ASSESSED)
"""What is said where no value is held against a limit; each says why."""

# --- the decision rule ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("rise", "u", "guarded", "simple"),
    [
        (0.160, 0.002, Verdict.WITHIN, Verdict.WITHIN),
        (0.168, 0.002, Verdict.WITHIN, Verdict.WITHIN),
        (0.169, 0.002, Verdict.WITHIN_CLOSE, Verdict.WITHIN),
        (0.170, 0.002, Verdict.WITHIN_CLOSE, Verdict.WITHIN),
        (0.170, 0.000, Verdict.WITHIN, Verdict.WITHIN),
        (0.171, 0.002, Verdict.OUTSIDE_CLOSE, Verdict.OUTSIDE),
        (0.172, 0.002, Verdict.OUTSIDE, Verdict.OUTSIDE),
        (0.180, 0.002, Verdict.OUTSIDE, Verdict.OUTSIDE),
    ],
)
def test_four_verdicts_or_simple_acceptance(rise, u, guarded, simple):
    inspection = inspection_of(changed(even(rise=0.15), 3, rise_m=measured(rise, u)))
    for decision, verdict in (("guarded", guarded), ("simple", simple)):
        found = judged(inspection, RISER, decision=decision).of_step(3)[0]
        assert found.verdict is verdict
        assert (found.value, found.u) == (rise, u)
        assert found.margin == pytest.approx(0.170 - rise, abs=1e-12)
        assert found.limit == RISER.maximum


@given(rise=st.floats(0.05, 0.3), u=st.floats(0.0, 0.02))
def test_the_decision_rules_never_disagree_about_the_side(rise, u):
    both = rule(minimum=Limit.of("100", "mm"), maximum=Limit.of("170", "mm"))
    inspection = inspection_of(changed(even(rise=0.15), 3, rise_m=measured(rise, u)))
    guarded, simple = (judged(inspection, both, decision=name).of_step(3)[0] for name in ("guarded", "simple"))
    assert guarded.verdict.is_outside == simple.verdict.is_outside
    assert guarded.verdict.is_within == simple.verdict.is_within
    assert guarded.verdict.is_outside == (not 0.1 <= rise <= 0.17)
    if guarded.verdict is Verdict.WITHIN:
        assert rise - u >= 0.1 - 1e-8
        assert rise + u <= 0.17 + 1e-8


def test_a_value_as_far_from_its_limit_as_its_u_is_not_close():
    """0.103 - 0.1 is a hair less than 0.003 in binary."""
    least = rule(minimum=Limit.of("100", "mm"), maximum=None)
    for rise, verdict in ((0.103, Verdict.WITHIN), (0.10299, Verdict.WITHIN_CLOSE)):
        inspection = inspection_of(changed(even(rise=0.15), 3, rise_m=measured(rise, 0.003)))
        assert judged(inspection, least).of_step(3)[0].verdict is verdict


def test_the_nearest_limit_decides():
    both = rule(minimum=Limit.of("100", "mm"), maximum=Limit.of("170", "mm"))
    steps = changed(changed(even(rise=0.15), 2, rise_m=measured(0.09, 0.001)), 4, rise_m=measured(0.19, 0.001))
    result = judged(inspection_of(steps), both)
    assert result.of_step(2)[0].limit == both.minimum
    assert result.of_step(4)[0].limit == both.maximum
    assert result.of_step(4)[0].margin == pytest.approx(-0.02)


def test_an_unknown_decision_rule():
    with pytest.raises(ConfigError, match="decision: got 'kind'; give one of guarded, simple"):
        judged(inspection_of(even()), RISER, decision="kind")


def test_only_limits_make_a_check_be_outside():
    high = inspection_of(even(rise=0.2))
    assert judged(high, RISER).is_outside
    for severity in ("advisory", "report_only"):
        assert not judged(high, dataclasses.replace(RISER, severity=severity)).is_outside


def test_an_advisory_is_judged_and_a_report_is_not():
    high = inspection_of(even(rise=0.2, u=0.001))
    assert judged(high, dataclasses.replace(RISER, severity="advisory")).findings[0].verdict is Verdict.OUTSIDE
    found = judged(high, dataclasses.replace(RISER, severity="report_only")).findings[0]
    assert (found.verdict, found.value, found.u) == (Verdict.REPORTED, 0.2, 0.001)


def test_uniform_without_a_number_is_reported():
    result = judged(inspection_of(even(u=0.001)), dataclasses.replace(RANGE, maximum=None, severity="report_only"))
    assert result.findings[0].verdict is Verdict.REPORTED
    assert result.findings[0].reason == "the clause gives no number"


# --- statistics ----------------------------------------------------------------------------------------------------


def test_the_spread_is_the_largest_less_the_smallest_and_names_them():
    steps = changed(changed(even(), 2, rise_m=measured(0.160, 0.0)), 5, rise_m=measured(0.172, 0.0))
    found = judged(inspection_of(steps), RANGE).findings
    assert [(each.steps, each.verdict) for each in found] == [((2, 5), Verdict.OUTSIDE)]
    # 12 mm, though no rise is further than 7 mm from the mean.
    assert found[0].value == pytest.approx(0.012)


def test_neighbours_are_compared_pair_by_pair():
    steps = changed(even(4), 3, rise_m=measured(0.172, 0.0))
    result = judged(inspection_of(steps), ADJACENT)
    assert verdicts(result) == [((1, 2), Verdict.WITHIN), ((2, 3), Verdict.OUTSIDE), ((3, 4), Verdict.OUTSIDE)]
    assert [found.value for found in result.findings] == pytest.approx([0.0, 0.007, 0.007])


def test_the_landing_has_a_rise_but_no_going():
    result = judged(inspection_of(even(4)), RISER, GOING)
    assert [steps for steps, _ in verdicts(result, "riser")] == [(1,), (2,), (3,), (4,)]
    assert [steps for steps, _ in verdicts(result, "going")] == [(1,), (2,), (3,)]


def test_flights_are_judged_apart():
    steps = [*even(3), *(dataclasses.replace(each, step_id=each.step_id + 3, flight=2) for each in even(3, rise=0.18))]
    flights = [flight_of(steps[:3]), flight_of(steps[3:], flight_id=2)]
    result = judged(inspection_of(steps, flights), RANGE)
    assert [(found.flight, found.verdict) for found in result.findings] == [(1, Verdict.WITHIN), (2, Verdict.WITHIN)]


def test_an_exactly_even_flight_names_two_steps():
    assert judged(inspection_of(even()), RANGE).findings[0].steps == (1, 6)


def test_a_spread_is_not_within_by_the_certainty_of_its_extremes_alone():
    """A rise known to 14 mm lies between rises known to 0.4 mm: it may be the odd one."""
    steps = changed(even(u=0.0004), 2, rise_m=measured(0.1645, 0.0004))
    steps = changed(changed(steps, 5, rise_m=measured(0.1655, 0.0004)), 3, rise_m=measured(0.165, 0.014))
    result = judged(inspection_of(steps, registration_m=0.0001), RANGE)
    (found,) = result.findings
    assert (found.steps, found.verdict) == ((2, 5), Verdict.WITHIN_CLOSE)
    assert found.value == pytest.approx(0.001)
    # 165 - 164.5 mm beside it, with 14 and 0.4 mm and a shared nosing.
    assert found.value + found.u == pytest.approx(0.0005 + (0.014**2 + 3 * 0.0004**2) ** 0.5)
    assert result.fits[0].is_fit is False


def test_a_spread_outside_is_fit_only_where_no_value_makes_it_unsure():
    steps = changed(changed(even(u=0.0004), 2, rise_m=measured(0.18, 0.0004)), 4, rise_m=measured(0.165, 0.02))
    result = judged(inspection_of(steps, registration_m=0.0001), RANGE)
    assert result.findings[0].verdict is Verdict.OUTSIDE
    assert result.fits[0].is_fit is False
    assert result.fits[0].u > 0.015


def test_a_tilt_that_moves_all_rises_but_the_first_leaves_a_spread_open():
    """The first rise stands on the floor at its foot: it has no part of the direction of up."""
    parts = (("noise", 0.0004), ("up", 0.0048))
    tilted = {height: Measured(height, math.hypot(0.0004, 0.0048), parts) for height in (0.165, 0.169, 0.171)}
    steps = [step(k, "landing" if k == 6 else "tread", rise=tilted[0.169]) for k in range(1, 7)]
    steps = changed(changed(steps, 3, rise_m=tilted[0.171]), 5, rise_m=tilted[0.165])
    steps = changed(steps, 1, rise_m=measured(0.1655, 0.0004))
    (found,) = judged(inspection_of(steps), RANGE).findings
    # 6 mm between two that the tilt moves alike; from the first to the largest 5.5 mm, and the tilt beside it.
    assert (found.steps, found.verdict) == ((3, 5), Verdict.WITHIN_CLOSE)
    assert found.value == pytest.approx(0.006)
    assert found.value + found.u == pytest.approx(0.0055 + math.sqrt(0.0048**2 + 2 * 0.0004**2))


@pytest.mark.parametrize(
    ("value", "u"), [(math.nan, 0.001), (math.inf, 0.001), (0.15, math.nan), (0.15, math.inf), (0.15, -0.001)]
)
def test_what_is_no_number_is_not_measured(value, u):
    broken = Measured(value, u)
    steps = changed(changed(even(rise=0.15), 3, rise_m=broken), 4, going_m=broken)
    flights = [flight_of(steps, pitch=broken)]
    sums = rule("sums", quantity="two_r_plus_g", minimum=None, maximum=Limit.of("700", "mm"))
    pitch = rule("pitch", quantity="pitch", statistic="flight", minimum=None, maximum=Limit.of("42", "deg"))
    result = judged(inspection_of(steps, flights), RISER, RANGE, ADJACENT, GOING, sums, pitch)
    assert result.of_rule("riser")[2].verdict is Verdict.NOT_MEASURED
    expected = "not measured at step 3: its value or its uncertainty is no finite number"
    assert result.of_rule("riser")[2].reason == expected
    assert [found.verdict for found in result.of_rule("range")] == [Verdict.NOT_MEASURED]
    lost = {found.steps for found in result.of_rule("adjacent") if found.verdict is Verdict.NOT_MEASURED}
    assert lost == {(2, 3), (3, 4)}
    lost = {found.steps for found in result.of_rule("sums") if found.verdict is Verdict.NOT_MEASURED}
    assert lost == {(3,), (4,)}
    assert result.of_rule("going")[3].verdict is Verdict.NOT_MEASURED
    assert [found.verdict for found in result.of_rule("pitch")] == [Verdict.NOT_MEASURED]
    assert not result.is_outside
    json.dumps(check_record(result), allow_nan=False)


def test_a_part_that_is_no_number_makes_the_value_none():
    steps = changed(even(rise=0.15), 3, rise_m=Measured(0.15, 0.001, (("noise", math.nan),)))
    assert judged(inspection_of(steps), RISER).findings[2].verdict is Verdict.NOT_MEASURED


def test_a_float_on_the_limit_is_inside():
    """0.1778 - 0.168275 is a hair more than 0.009525 in binary."""
    inch = rule("range", statistic="flight_range", minimum=None, maximum=Limit.of("3/8", "in"))
    steps = changed(even(rise=0.17), 2, rise_m=measured(0.168275, 0.0))
    steps = changed(steps, 4, rise_m=measured(0.1778, 0.0))
    found = judged(inspection_of(steps), inch).findings[0]
    assert (found.verdict, found.margin) == (Verdict.WITHIN, 0.0)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"severity": "report_only", "applies": "schools"}, "applies to schools"),
        ({"severity": "report_only"}, "reported without a judgement"),
        ({"from_scan": "partly"}, "inside the limit; the scan shows only a part of what the clause limits"),
    ],
)
def test_what_is_only_reported_says_why(values, words):
    found = judged(inspection_of(even(rise=0.15)), dataclasses.replace(RISER, **values)).findings[0]
    assert (found.verdict, found.reason) == (Verdict.REPORTED, words)


def test_a_doubt_about_a_value_that_is_only_reported_is_said_with_it():
    silent = dataclasses.replace(RISER, severity="report_only")
    note = ("nosing_unobserved", "the nosing of step 2 was not seen", 2)
    assert judged(inspection_of(even(), notes=[note]), silent).of_step(2)[0].reason == note[1]


# --- not measured, not judged --------------------------------------------------------------------------------------


def test_no_staircase_is_no_pass():
    result = judged(inspection_of([], []), RISER, RANGE)
    assert {found.verdict for found in result.findings} == {Verdict.NOT_MEASURED}
    assert {found.reason for found in result.findings} == {"no staircase was found"}
    assert not result.is_judged
    assert not result.is_outside
    sentence = verdict_sentence(result)
    assert sentence == (
        "Nothing could be judged against a limit of Code, 2024; nothing was measured, which is no pass: no staircase "
        "was found."
    )


def test_the_papers_values_are_not_judged():
    result = judged(inspection_of(even(), []), RISER)
    assert result.findings[0].verdict is Verdict.NOT_MEASURED
    assert "the paper's method measures nothing from nosing to nosing" in result.findings[0].reason


def test_nothing_is_judged_before_a_question_about_the_scan_is_answered():
    asked = Observation("unit_unsure", "question", "inches or centimetres: both fit", None, "--unit in")
    held = dataclasses.replace(inspection_of(even(rise=0.2)), examination=(asked,))
    result = judged(held, RISER, RANGE)
    reason = "a question about the scan has to be answered first: inches or centimetres: both fit"
    assert {(found.verdict, found.value, found.reason) for found in result.findings} == {
        (Verdict.NOT_JUDGED, None, reason)
    }
    assert not result.is_judged
    assert not result.is_outside


@pytest.mark.parametrize("shape", ["winder", "spiral"])
def test_winding_flights_are_not_judged(shape):
    steps = even()
    result = judged(inspection_of(steps, [flight_of(steps, shape)]), RISER, RANGE, GOING)
    assert {found.verdict for found in result.findings} == {Verdict.NOT_JUDGED}
    assert not result.is_judged
    assert "what was not judged is no pass either" in verdict_sentence(result)


def test_of_a_curved_flight_the_rises_and_how_even_the_goings_are_is_judged_but_no_size_of_a_going():
    even_goings = rule(
        "even-goings", quantity="going", statistic="flight_range", minimum=None, maximum=Limit.of("9", "mm")
    )
    steps = changed(even(u=0.0002), 2, going_m=measured(0.3, 0.0002))
    result = judged(inspection_of(steps, [flight_of(steps, "curved")]), RISER, GOING, even_goings)
    assert {found.verdict for found in result.of_rule("riser")} == {Verdict.WITHIN}
    (size,) = result.of_rule("going")
    assert size.verdict is Verdict.NOT_JUDGED
    assert "walking line" in size.reason
    (spread,) = result.of_rule("even-goings")
    assert spread.verdict is Verdict.OUTSIDE
    assert spread.reason == "measured on the middle line of a flight that curves"
    # Rises are the same on every line, and so are the goings of a straight flight beside it.
    assert {found.reason for found in result.of_rule("riser")} == {""}
    beside = [dataclasses.replace(each, step_id=each.step_id + 6, flight=2) for each in even(u=0.0002)]
    flights = [flight_of(steps, "curved"), flight_of(beside, flight_id=2)]
    both = judged(inspection_of([*steps, *beside], flights), even_goings)
    assert [found.reason for found in both.findings] == [spread.reason, ""]


def test_a_flight_that_goes_on_is_not_within_by_what_was_measured_of_it():
    goes_on = "6 risers measured; about 4 more are seen below: their treads are hidden from the scanner"
    flights = [dataclasses.replace(flight_of(even()), goes_on=goes_on)]
    for quantity in ("rise", "going"):
        limit = rule("spread", quantity=quantity, statistic="flight_range", minimum=None, maximum=Limit.of("9", "mm"))
        steps = changed(even(), 6, going_m=None)
        assert judged(inspection_of(steps), limit).findings[0].verdict is Verdict.WITHIN
        (found,) = judged(inspection_of(steps, flights), limit).findings
        assert found.verdict is Verdict.NOT_MEASURED
        assert goes_on in found.reason


def test_a_first_riser_that_was_not_seen_is_named_and_leaves_the_spread_open():
    steps = changed(even(), 1, rise_m=None)
    note = ("rise_unobserved", "step 1 has no rise: no floor or landing was seen a riser below it", 1)
    result = judged(inspection_of(steps, notes=[note]), RISER, RANGE, ADJACENT)
    assert result.of_rule("riser")[0].verdict is Verdict.NOT_MEASURED
    assert result.of_rule("riser")[0].reason == note[1]
    (spread,) = result.of_rule("range")
    assert spread.verdict is Verdict.NOT_MEASURED
    assert spread.reason.startswith("0.00 mm is what was measured of it: 1 of 6 values are missing (step 1 has no")
    assert verdicts(result, "adjacent")[0] == ((1, 2), Verdict.NOT_MEASURED)
    assert not result.is_outside


def test_what_is_missing_cannot_make_a_spread_smaller():
    steps = changed(changed(even(), 1, rise_m=None), 4, rise_m=measured(0.2, 0.001))
    found = judged(inspection_of(steps), RANGE).findings[0]
    assert found.verdict is Verdict.OUTSIDE


def test_an_upper_end_that_was_not_seen_may_hide_risers():
    steps = [step(k) for k in range(1, 6)]
    steps = changed(steps, 5, going_m=None)
    count = rule("count", quantity="n_risers", statistic="flight", minimum=None, maximum=Limit.of("18", "count"))
    result = judged(inspection_of(steps), RISER, RANGE, GOING, count)
    assert verdicts(result, "riser")[-1] == ((), Verdict.NOT_MEASURED)
    assert "there may be risers above step 5" in result.of_rule("riser")[-1].reason
    assert verdicts(result, "range")[0][1] is Verdict.NOT_MEASURED
    assert verdicts(result, "count") == [((), Verdict.NOT_MEASURED)]
    assert verdicts(result, "going")[-1] == ((5,), Verdict.NOT_MEASURED)
    assert result.of_rule("going")[-1].reason == "no nosing was seen above step 5, up to which its going is measured"


def test_too_many_risers_are_too_many_though_the_upper_end_was_not_seen():
    steps = [step(k) for k in range(1, 20)]
    count = rule("count", quantity="n_risers", statistic="flight", minimum=None, maximum=Limit.of("18", "count"))
    assert judged(inspection_of(steps), count).findings[0].verdict is Verdict.OUTSIDE


def test_enough_risers_are_enough_though_the_upper_end_was_not_seen():
    steps = [step(k) for k in range(1, 10)]
    least = rule("least", quantity="n_risers", statistic="flight", minimum=Limit.of("2", "count"), maximum=None)
    high = rule("high", quantity="flight_rise", statistic="flight", minimum=Limit.of("1", "m"), maximum=None)
    assert verdicts(judged(inspection_of(steps), least, high)) == [((), Verdict.WITHIN), ((), Verdict.WITHIN)]
    both = dataclasses.replace(least, maximum=Limit.of("18", "count"))
    assert verdicts(judged(inspection_of(steps), both)) == [((), Verdict.NOT_MEASURED)]
    assert verdicts(judged(inspection_of(steps[:1]), least)) == [((), Verdict.NOT_MEASURED)]


def test_the_last_riser_is_said_to_be_in_no_sum_with_a_going():
    sums = rule("sums", quantity="two_r_plus_g", minimum=None, maximum=Limit.of("700", "mm"))
    result = judged(inspection_of(even(4)), sums)
    assert [found.steps for found in result.findings] == [(1,), (2,), (3,)]
    said = "the riser up to a landing has no going above it: it is in no sum of twice the rise and the going"
    assert result.notes == (said,)
    assert said not in judged(inspection_of(even(4)), RISER).notes
    assert said not in judged(inspection_of([step(k) for k in range(1, 4)]), sums).notes


def test_a_missing_tread_is_said_in_the_surveys_words():
    steps = changed(changed(even(), 4, rise_m=None), 3, going_m=None)
    note = ("tread_missing", "a tread is missing or not seen between step 3 and step 4", 4)
    result = judged(inspection_of(steps, notes=[note]), RISER, GOING, GOING_RANGE)
    assert [found.reason for found in result.of_rule("riser") if found.verdict is Verdict.NOT_MEASURED] == [note[1]]
    assert [found.reason for found in result.of_rule("going") if found.verdict is Verdict.NOT_MEASURED] == [note[1]]
    assert result.of_rule("going-range")[0].verdict is Verdict.NOT_MEASURED


def test_a_doubtful_value_says_why():
    width = rule("width", quantity="width", minimum=Limit.of("900", "mm"), maximum=None)
    note = ("side_unobserved", "a side of step 2 was not seen", 2)
    result = judged(inspection_of(even(), notes=[note]), width)
    assert [found.reason for found in result.findings] == ["", note[1], "", "", ""]


def test_the_rise_of_a_flight_is_the_sum_of_its_rises():
    rise = rule("flight-rise", quantity="flight_rise", statistic="flight", minimum=None, maximum=Limit.of("1", "m"))
    assert judged(inspection_of(even(6, rise=0.165)), rise).findings[0].value == pytest.approx(0.99)
    partial = judged(inspection_of(changed(even(6), 3, rise_m=None)), rise).findings[0]
    assert partial.verdict is Verdict.NOT_MEASURED
    high = judged(inspection_of(changed(even(8), 3, rise_m=None)), rise).findings[0]
    assert high.verdict is Verdict.OUTSIDE


def test_a_flight_without_a_pitch():
    pitch = rule("pitch", quantity="pitch", statistic="flight", minimum=None, maximum=Limit.of("42", "deg"))
    steps = even()
    flight = dataclasses.replace(flight_of(steps), pitch_deg=None)
    assert judged(inspection_of(steps, [flight]), pitch).findings[0].verdict is Verdict.NOT_MEASURED


def test_a_rule_that_no_scan_shows_is_listed_and_not_judged():
    headroom = rule(
        "headroom", term="headroom", quantity="other", from_scan="no", maximum=None, minimum=Limit.of("80", "in")
    )
    result = check(inspection_of(even()), rule_set(RISER, headroom, not_assessed=("lighting",)))
    assert result.of_rule("headroom")[0].verdict is Verdict.NOT_ASSESSED
    assert result.not_assessed == ("headroom, at least 80 in (2032 mm) (1.1)", "lighting")


# --- conditions ----------------------------------------------------------------------------------------------------

NOSING = rule(
    "nosing",
    quantity="nosing_overhang",
    minimum=Limit.of("3/4", "in"),
    maximum=Limit.of("1 1/4", "in"),
    only_where=Condition("going", Limit.of("11", "in")),
)


def test_a_rule_holds_only_where_its_condition_does():
    steps = changed(even(nosing_overhang=0.005), 2, going_m=measured(0.27, 0.001))
    assert verdicts(judged(inspection_of(steps), NOSING)) == [((2,), Verdict.OUTSIDE)]


def test_a_rule_that_holds_nowhere_says_so():
    found = judged(inspection_of(even(nosing_overhang=0.005)), NOSING).findings
    assert [(each.steps, each.verdict) for each in found] == [((), Verdict.NOT_JUDGED)]
    assert found[0].reason == "does not apply: no step has a going below 11 in (279.4 mm)"


@pytest.mark.parametrize("going", [measured(0.2790, 0.001), measured(0.2798, 0.001), None])
def test_where_the_condition_is_close_nothing_is_outside(going):
    result = judged(inspection_of(changed(even(nosing_overhang=0.005), 2, going_m=going)), NOSING)
    found = result.of_step(2)[0]
    assert found.verdict is Verdict.NOT_JUDGED
    assert found.reason == (
        "beyond the limit, but the clause applies only where the going is below 11 in (279.4 mm), and here the going "
        "was not measured or is too near to tell"
    )
    assert not result.is_outside
    # 14.05 mm beyond: no sentence may call that less than U.
    assert "less than U" not in check_text(result)
    assert "what was not judged is no pass either" in verdict_sentence(result)


def test_where_the_condition_is_close_and_the_value_inside_it_is_within():
    steps = changed(even(nosing_overhang=0.025), 2, going_m=measured(0.279, 0.001))
    found = judged(inspection_of(steps), NOSING).of_step(2)[0]
    assert found.verdict is Verdict.WITHIN
    assert found.reason == "whether the clause applies here is not certain"


def test_a_rule_that_does_not_apply_is_not_called_unjudged():
    result = judged(inspection_of(even(nosing_overhang=0.005)), NOSING, RISER)
    assert verdict_sentence(result) == "Nothing that was measured is outside a limit of Code, 2024."
    single = judged(inspection_of([step(1)], [flight_of([step(1)], n_risers=1)]), GOING_RANGE, RISER)
    assert "what was not judged" not in verdict_sentence(single)


def test_neighbours_between_which_the_clause_does_not_apply_are_no_pair():
    adjacent = dataclasses.replace(NOSING, statistic="adjacent_difference", minimum=None)
    goings = {1: 0.27, 2: 0.30, 3: 0.27, 4: 0.27, 5: 0.30}
    steps = even()
    for number, going in goings.items():
        steps = changed(steps, number, going_m=measured(going, 0.0))
    assert [found.steps for found in judged(inspection_of(steps), adjacent).findings] == [(3, 4)]
    found = judged(inspection_of(changed(steps, 4, going_m=measured(0.30, 0.0))), adjacent).findings
    assert [each.reason for each in found] == ["does not apply: no two neighbouring steps to which the clause applies"]


def test_simple_acceptance_lets_the_value_decide_whether_a_rule_applies():
    for going, verdict in ((0.2790, Verdict.OUTSIDE), (0.2798, Verdict.NOT_JUDGED)):
        steps = changed(even(nosing_overhang=0.005), 2, going_m=measured(going, 0.001))
        assert judged(inspection_of(steps), NOSING, decision="simple").findings[0].verdict is verdict


# --- what was not seen or may not apply hides nothing --------------------------------------------------------------


def test_the_unseen_top_riser_is_open_between_neighbours_too():
    treads = [step(k, u=0.0002) for k in range(1, 4)]
    reason = "the upper end of the flight was not seen: there may be risers above step 3"
    for each in (RISER, ADJACENT):
        last = judged(inspection_of(treads), each).findings[-1]
        assert (last.steps, last.verdict, last.reason) == ((), Verdict.NOT_MEASURED, reason)
    landed = [*treads[:2], step(3, "landing", u=0.0002)]
    assert {found.verdict for found in judged(inspection_of(landed), ADJACENT).findings} == {Verdict.WITHIN}
    single = judged(inspection_of(treads[:1]), ADJACENT).findings
    assert [(found.verdict, found.applies) for found in single] == [(Verdict.NOT_MEASURED, True)]
    # Nothing is missing above the goings.
    adjacent_goings = dataclasses.replace(ADJACENT, quantity="going")
    assert all(found.steps for found in judged(inspection_of(treads), adjacent_goings).findings)


def test_a_step_at_which_the_clause_may_not_apply_does_not_excuse_the_others():
    spread = dataclasses.replace(NOSING, statistic="flight_range", minimum=None, maximum=Limit.of("10", "mm"))

    def flight(*overhangs, last_going):
        steps = [step(k, going=0.25, nosing_overhang=each, u=0.0002) for k, each in enumerate(overhangs, 1)]
        steps.append(step(len(steps) + 1, "landing"))
        return inspection_of(changed(steps, len(overhangs), going_m=measured(last_going, 0.001)))

    (found,) = judged(flight(0.020, 0.050, 0.051, last_going=0.2795), spread).findings
    assert (found.steps, found.verdict) == ((1, 2), Verdict.OUTSIDE)
    assert found.value == pytest.approx(0.030)
    # Without the uncertain one nothing is beyond the limit.
    (found,) = judged(flight(0.020, 0.021, 0.051, last_going=0.2795), spread).findings
    assert (found.steps, found.verdict) == ((1, 3), Verdict.NOT_JUDGED)


def test_a_pair_at_which_the_clause_may_not_apply_is_not_judged():
    adjacent = dataclasses.replace(NOSING, statistic="adjacent_difference", minimum=None, maximum=Limit.of("10", "mm"))
    steps = changed(even(going=0.25), 3, going_m=measured(0.2795, 0.001), nosing_overhang_m=measured(0.05, 0.0))
    found = judged(inspection_of(steps), adjacent).findings
    assert {each.steps: each.verdict for each in found if each.verdict is not Verdict.WITHIN} == {
        (2, 3): Verdict.NOT_JUDGED,
        (3, 4): Verdict.NOT_JUDGED,
    }


# --- fit for this check --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("rule_of", "u", "is_fit"),
    [
        # Half the tolerance, of the difference of two values.
        (RANGE, 0.005 / 2**0.5 - 1e-6, True),
        (RANGE, 0.005 / 2**0.5 + 1e-6, False),
        (ADJACENT, 0.0025 / 2.0 - 1e-6, True),
        (ADJACENT, 0.0025 / 2.0 + 1e-6, False),
        # A twentieth of a size's only limit.
        (RISER, 0.0084, True),
        (RISER, 0.0086, False),
    ],
)
def test_a_scan_is_fit_when_u_is_at_most_half_the_tolerance(rule_of, u, is_fit):
    steps = even(u=u, rise=0.15)
    # The extremes are no neighbours.
    steps = changed(changed(steps, 2, rise_m=measured(0.1475, u)), 4, rise_m=measured(0.1525, u))
    fit = judged(inspection_of(steps, registration_m=0.0001), rule_of).fits[0]
    assert fit.is_fit is is_fit
    assert fit.words.startswith("fit: U up to " if is_fit else "not fit: U up to ")
    assert fit.tolerance == pytest.approx(0.017 if rule_of is RISER else rule_of.maximum.value)


def test_half_a_millimetre_judges_neighbours_and_one_judges_a_flight():
    """Tread heights good to about 0.4 mm (1 sigma) for 3/16 in between neighbours, 0.8 mm for 3/8 in over a flight."""
    inch = [Limit.of(text, "in") for text in ("3/16", "3/8")]
    rules = [dataclasses.replace(ADJACENT, maximum=inch[0]), dataclasses.replace(RANGE, maximum=inch[1])]
    for sigma, expected in ((0.0004, [True, True]), (0.0007, [False, True]), (0.001, [False, False])):
        steps = even(u=2.0 * 2**0.5 * sigma)
        steps = changed(steps, 4, rise_m=measured(0.1651, 2.0 * 2**0.5 * sigma))
        result = judged(inspection_of(steps, registration_m=0.0001), *rules)
        assert [fit.is_fit for fit in result.fits] == expected
        unstated = judged(inspection_of(steps), *rules)
        # What is too coarse without registration stays so with it; what looks fine cannot be said.
        assert [fit.is_fit for fit in unstated.fits] == [None if each else False for each in expected]
        for fit, is_fit in zip(unstated.fits, expected, strict=True):
            assert fit.words.startswith("cannot be said: U up to " if is_fit else "not fit: U up to ")
            assert fit.words.endswith("registration from step to step is not stated")


def test_the_registration_is_said_in_millimetres_and_of_lengths_alone():
    slope = rule("slope", quantity="tread_slope", statistic="flight_range", minimum=None, maximum=Limit.of("2", "%"))
    result = judged(inspection_of(even(u=0.0001), registration_m=0.0005), RANGE, slope)
    assert result.fits[0].words.endswith("; registration from step to step is stated as 0.5 mm")
    assert "registration" not in result.fits[1].words
    assert judged(inspection_of(even(u=0.0001)), slope).fits[0].is_fit is True


def test_every_rule_says_in_the_table_whether_the_scan_is_fit():
    silent = dataclasses.replace(GOING_RANGE, severity="report_only")
    lines = check_text(judged(inspection_of(even(u=0.0015)), RISER, RANGE, ADJACENT, silent)).splitlines()
    head = next(number for number, line in enumerate(lines) if line.startswith("  rule  "))
    start = lines[head].index("scan")
    said = {line.split()[0]: line[start:].split("  ")[0] for line in lines[head + 1 : head + 5]}
    assert said == {"riser": "fit", "range": "cannot be said", "adjacent": "not fit", "going-range": "-"}
    why = lines[lines.index("  whether the scan is fit cannot be said for:") + 1]
    assert why.startswith("    range: U up to ")
    assert why.endswith("registration from step to step is not stated")


def test_a_size_between_two_limits_is_held_against_a_tenth_of_the_smaller_unless_there_is_less_room():
    for low, high, tolerance in (("100", "180", 0.010), ("100", "105", 0.005)):
        between = rule(minimum=Limit.of(low, "mm"), maximum=Limit.of(high, "mm"))
        fit = judged(inspection_of(even(u=0.0001, rise=0.102)), between).fits[0]
        assert fit.tolerance == pytest.approx(tolerance)
        assert f"this check needs at most {1000.0 * tolerance / 2.0:.2f} mm" in fit.words


def test_what_a_fit_says_can_be_written_in_another_unit():
    fit = judged(inspection_of(even(u=0.0001, rise=0.15)), RISER).fits[0]
    assert fit.words == "fit: U up to 0.10 mm; this check needs at most 8.50 mm"
    said = fit.said(lambda size: f"{size / 0.0254:.3f} in")
    assert said == "fit: U up to 0.004 in; this check needs at most 0.335 in"


def test_whether_a_scan_is_fit_heeds_the_u_that_decided():
    """Downwards the U of the spread of twelve rises is wider than upwards, where it is 8 mm."""
    steps = changed(even(n=12, u=0.004), 3, rise_m=measured(0.20, 0.004))
    result = judged(inspection_of(steps, registration_m=0.0001), RANGE)
    (found,) = result.findings
    assert found.verdict is Verdict.OUTSIDE
    assert found.u > 0.009
    assert result.fits[0].u == found.u


def test_a_size_outside_its_limit_is_as_fit_as_its_u_says():
    (fit,) = judged(inspection_of(even(rise=0.18, u=0.001)), RISER).fits
    assert (fit.is_fit, fit.u) == (True, 0.001)


def test_a_limit_at_what_is_intended_cannot_be_decided():
    least = rule("least", quantity="nosing_overhang", minimum=Limit.of("0", "mm"), maximum=None, severity="advisory")
    fit = judged(inspection_of(even(u=0.0005)), least).fits[0]
    assert fit.is_fit is False
    assert "lies on the limit, where no measurement decides" in fit.words


def test_nothing_measured_is_neither_fit_nor_unfit():
    assert [fit.is_fit for fit in judged(inspection_of([], []), RISER, RANGE).fits] == [None, None]


VALUES = st.none() | st.builds(
    measured, st.floats(-1.0, 5.0), st.floats(0.0, 0.5), st.sampled_from(["noise", "up", "scale", "other"])
)


@given(data=st.data())
def test_whatever_was_measured_gets_a_verdict_and_a_text(data):
    steps = []
    for number in range(1, data.draw(st.integers(1, 5)) + 1):
        made = step(number, data.draw(st.sampled_from(["tread", "landing"])))
        names = ("rise_m", "going_m", "width_m", "nosing_overhang_m", "fall_deg", "cross_fall_deg")
        steps.append(dataclasses.replace(made, **{name: data.draw(VALUES) for name in names}))
    flight = flight_of(steps, data.draw(st.sampled_from(["straight", "winder"])))
    flight = dataclasses.replace(flight, pitch_deg=data.draw(VALUES))
    inspection = inspection_of(steps, data.draw(st.sampled_from([[flight], []])))
    for set_id in ("us-ibc-2024-dwelling", "au-ncc-2022-public", "ca-9.8-private", "uk-adk-2013-private"):
        rules = find_rule_set(set_id)
        result = check(inspection, rules)
        assert {found.rule.rule_id for found in result.findings} == {each.rule_id for each in rules.rules}
        for found in result.findings:
            assert (found.value is None) <= (found.verdict in SILENT)
            assert bool(found.reason) >= (found.verdict in SILENT)
            if found.verdict is Verdict.OUTSIDE_CLOSE:
                # What is called less than U is less than U.
                assert -found.margin < found.u
        assert check_text(result)
        json.dumps(check_record(result), allow_nan=False)


# --- the whole -----------------------------------------------------------------------------------------------------


def test_the_gravest_finding_stands_for_a_rule():
    steps = changed(changed(even(rise=0.15), 2, rise_m=measured(0.18, 0.001)), 4, rise_m=measured(0.19, 0.001))
    assert gravest(judged(inspection_of(changed(steps, 1, rise_m=None)), RISER).findings).steps == (4,)
    steps = changed(even(rise=0.15), 1, rise_m=None)
    assert gravest(judged(inspection_of(steps), RISER).findings).verdict is Verdict.NOT_MEASURED


def test_the_notes_that_bear_on_a_check_go_with_it():
    notes = [("uncertainty_unstated", "u holds what the scan shows", None), ("back_unobserved", "no back", 6)]
    assert judged(inspection_of(even(), notes=notes), RISER).notes == ("u holds what the scan shows",)


def test_what_a_scan_shows_only_partly_is_said_with_the_check():
    width = rule(
        "width",
        term="clear width",
        quantity="width",
        minimum=Limit.of("900", "mm"),
        maximum=None,
        from_scan="partly",
        note="The treads' width.",
    )
    assert judged(inspection_of(even()), width).notes == ("clear width: The treads' width.",)
    # A remark on a rule of which the scan shows all is none on what it does not show.
    whole = dataclasses.replace(RISER, note="Measured at the nosings.")
    assert judged(inspection_of(even()), whole, dataclasses.replace(width, note="")).notes == ()


def test_a_tread_wide_enough_is_no_clear_width_and_one_too_narrow_is_outside():
    width = rule("width", quantity="width", minimum=Limit.of("900", "mm"), maximum=None, from_scan="partly")
    wide = judged(inspection_of(even(u=0.001)), width)
    assert {found.verdict for found in wide.findings} == {Verdict.REPORTED}
    assert wide.findings[0].reason == "the tread's width is inside the limit; the clear width was not seen"
    assert not wide.is_judged
    assert "1600.0 ± 1.0 mm (tread width)" in check_text(wide)
    assert wide.fits[0].words.endswith("; the scan shows only a part of what the clause limits")
    for width_m, verdict in ((0.8, Verdict.OUTSIDE), (0.8995, Verdict.OUTSIDE_CLOSE), (0.9005, Verdict.REPORTED)):
        steps = changed(even(), 2, width_m=measured(width_m, 0.001))
        assert judged(inspection_of(steps), width).of_step(2)[0].verdict is verdict
    assert judged(inspection_of(even()), width, decision="simple").findings[0].verdict is Verdict.REPORTED


def test_a_nosing_of_open_risers_is_not_found_within():
    nosing = dataclasses.replace(NOSING, from_scan="partly", severity="advisory", applies="stairs with solid risers")
    found = judged(inspection_of(even(going=0.26, nosing_overhang=0.025)), nosing).findings[0]
    assert found.verdict is Verdict.REPORTED
    assert found.reason == "inside the limit, where the clause applies: stairs with solid risers"
    short = judged(inspection_of(even(going=0.26, nosing_overhang=0.0)), nosing)
    assert short.findings[0].verdict is Verdict.OUTSIDE
    assert not short.is_outside


def test_a_users_own_file_is_never_called_unedited():
    assert "  edited by the user: user's own file, not a set that comes with the program" in check_text(
        judged(inspection_of(even()), RISER)
    )
    shipped = check(inspection_of(even()), find_rule_set("us-irc-2024"))
    assert "  edited by the user: no\n" in check_text(shipped)
    changed_since = edited(rule_set(RISER), "riser", "maximum", Limit.of("190", "mm"), "an amendment")
    assert "  user's own file, not a set" in check_text(check(inspection_of(even()), changed_since))


def test_the_same_inspection_gives_the_same_text_and_no_forbidden_word():
    inspection = inspection_of(changed(even(u=0.001), 3, rise_m=measured(0.18, 0.001)))
    texts = [check_text(judged(inspection, RISER, RANGE, ADJACENT, GOING)) for _ in range(2)]
    assert texts[0] == texts[1]
    assert "riser, step 3: 180.0 ± 1.0 mm, outside by 10.00 mm; 1.1: at most 170 mm" in texts[0]
    for word in ("complian", "comply", "complies", "legal"):
        assert word not in texts[0].lower()


def test_the_last_sentence_tells_close_from_clear():
    close = even(rise=0.15)
    close = changed(close, 2, rise_m=measured(0.1705, 0.001))
    listed = "the limits listed in 1.1 (Code, 2024)"
    assert verdict_sentence(judged(inspection_of(close), RISER)) == f"Outside, but by less than U, {listed}."
    both = changed(close, 3, rise_m=measured(0.18, 0.001))
    expected = f"Outside {listed}; outside, but by less than U, the limits listed in 1.1."
    assert verdict_sentence(judged(inspection_of(both), RISER)) == expected


def test_a_limit_that_the_user_has_set_is_not_said_to_be_listed_in_the_code():
    rules = rule_set(RISER, dataclasses.replace(GOING, clause="2.2"))
    own = edited(rules, "riser", "maximum", Limit.of("160", "mm"), "agreed")
    short = even(going=0.24)
    result = check(inspection_of(short), own)
    assert verdict_sentence(result) == (
        "Outside the limits listed in 2.2 (Code, 2024); outside limits set by the user in place of those of 1.1; "
        "1 limit was changed by the user."
    )
    written = check_text(result)
    assert "1.1: at most 160 mm, set by the user in place of 170 mm" in written
    assert "at most 160 mm (edited)" in written
    assert "at least 250 mm (edited)" not in written
    # What passes by the user's leave does not pass by the code's.
    wide = edited(rules, "riser", "maximum", Limit.of("200", "mm"), "agreed")
    sentence = verdict_sentence(check(inspection_of(even(rise=0.18)), wide))
    assert sentence == "Nothing that was measured is outside a limit of Code, 2024; 1 limit was changed by the user."
    back = edited(own, "riser", "maximum", Limit.of("170", "mm"), "not agreed after all")
    assert "changed by the user" not in verdict_sentence(check(inspection_of(even()), back))


def test_what_is_asked_for_without_a_number_is_named_with_its_value():
    """The headline may not pass over an odd riser because the clause says uniform and no more."""
    osha = find_rule_set("us-osha-1910-25")
    steps = changed(even(u=0.0002, going=0.27, width=0.9), 4, rise_m=measured(0.18, 0.0002))
    sentence = verdict_sentence(check(inspection_of(steps), osha))
    (found,) = check(inspection_of(steps), osha).of_rule("riser-uniformity")
    said = (
        f"29 CFR 1910.25(b)(3) gives no number for uniform riser heights between landings: {value_text(found)}, steps "
    )
    assert said in sentence
    assert "15.0 ± " in sentence
    assert "is for the inspector to judge" in sentence
    assert "gives no number" not in verdict_sentence(judged(inspection_of(even()), RISER))


def test_of_several_flights_the_largest_value_without_a_number_is_named():
    osha = find_rule_set("us-osha-1910-25")
    steps = even(8, u=0.0002, going=0.27, width=0.9)
    steps = changed(changed(steps, 2, rise_m=measured(0.168, 0.0002)), 6, rise_m=measured(0.18, 0.0002))
    flights = [flight_of(steps[:4]), flight_of(steps[4:], flight_id=2)]
    result = check(inspection_of(steps, flights), osha)
    small, large = result.of_rule("riser-uniformity")
    assert (small.flight, large.flight) == (1, 2)
    sentence = verdict_sentence(result)
    assert f"uniform riser heights between landings: {value_text(large)}, steps " in sentence
    assert value_text(small) not in sentence


def test_a_limit_given_to_a_clause_without_a_number_is_judged_and_is_the_users():
    """An odd riser may not vanish because the user has written a number for it."""
    osha = find_rule_set("us-osha-1910-25")
    steps = changed(even(u=0.0002, going=0.27, width=0.9), 4, rise_m=measured(0.18, 0.0002))
    own = edited(osha, "riser-uniformity", "maximum", Limit.of("5", "mm"), "the city's")
    result = check(inspection_of(steps), own)
    (found,) = result.of_rule("riser-uniformity")
    assert (found.verdict, result.is_outside) == (Verdict.OUTSIDE, True)
    sentence = verdict_sentence(result)
    assert "outside a maximum set by the user, where there is none in 29 CFR 1910.25(b)(3);" in sentence
    assert "gives no number for uniform riser" not in sentence
    assert "listed in 29 CFR 1910.25(b)(3)" not in sentence
    assert "at most 5 mm, set by the user where the code has none" in check_text(result)
    wide = edited(osha, "riser-uniformity", "maximum", Limit.of("25", "mm"), "the city's")
    (found,) = check(inspection_of(steps), wide).of_rule("riser-uniformity")
    assert found.verdict is Verdict.WITHIN


def test_a_limit_that_is_added_does_not_stand_in_place_of_the_clauses_other_one():
    rules = rule_set(GOING)
    own = edited(rules, "going", "maximum", Limit.of("280", "mm"), "agreed")
    sentence = verdict_sentence(check(inspection_of(even(going=0.29)), own))
    assert sentence == (
        "Outside a maximum set by the user, where there is none in 1.1 (Code, 2024); 1 limit was changed by the user."
    )


def test_a_number_that_the_user_takes_away_is_not_said_to_be_missing_in_the_code():
    reported = dataclasses.replace(RISER, severity="report_only")
    own = edited(rule_set(reported), "riser", "maximum", None, "not here")
    sentence = verdict_sentence(check(inspection_of(even()), own))
    assert "1.1 after a change by the user gives no number for riser: 165" in sentence
    assert "1.1 gives no number" not in sentence


def test_a_reported_value_beyond_the_number_of_its_clause_is_named():
    high = inspection_of(even(30, 0.0002, rise=0.17, going=0.29))
    result = check(high, find_rule_set("us-ibc-2024"))
    (found,) = result.of_rule("flight-rise")
    assert (found.verdict, found.is_reported_beyond) == (Verdict.REPORTED, True)
    sentence = verdict_sentence(result)
    assert f"{value_text(found)}, flight 1, is more than the maximum of " in sentence
    assert ", 12 ft (3657.6 mm), which is reported only and for the inspector to judge" in sentence
    low = check(inspection_of(even(6, 0.0002)), find_rule_set("us-ibc-2024"))
    assert "reported only" not in verdict_sentence(low)
    least = dataclasses.replace(GOING, severity="report_only", applies="schools")
    sentence = verdict_sentence(judged(inspection_of(even(going=0.24, u=0.001)), RISER, least))
    assert (
        "riser: 240.0 ± 1.0 mm, step 1, is less than the minimum of 1.1, 250 mm (for schools), which is reported only"
        in sentence
    )


def test_a_u_that_rounds_to_nothing_is_not_shown_as_nothing():
    inspection = inspection_of(changed(even(rise=0.15), 3, rise_m=measured(0.18, 0.000004)))
    assert "180.00 ± 0.01 mm" in check_text(judged(inspection, RISER))


def test_a_margin_that_rounds_to_nothing_is_not_shown_as_nothing():
    inspection = inspection_of(changed(even(rise=0.15), 3, rise_m=measured(0.170004, 0.001)))
    assert "outside by less than 0.01 mm, which is less than U" in check_text(judged(inspection, RISER))


def test_a_scan_is_as_fit_as_its_most_uncertain_value():
    steps = changed(even(5, 0.0004), 3, rise_m=measured(0.165, 0.0123))
    (fit,) = judged(inspection_of(steps, registration_m=0.001), RISER).fits
    assert fit.u == pytest.approx(0.0123)


@pytest.mark.parametrize("code", ["step_impossible", "step_blurred"])
@pytest.mark.parametrize("number", [2, 3, 4])
def test_what_a_nosing_that_is_none_takes_from_its_neighbours_is_said_at_them(number, code):
    words = f"step {number}: what was found is not its nosing"
    steps = changed(even(6), 3, going_m=None)
    found = judged(inspection_of(steps, notes=[(code, words, number)]), GOING).of_step(3)[0]
    assert (found.verdict, found.reason) == (Verdict.NOT_MEASURED, words)


@pytest.mark.parametrize("number", [1, 5])
def test_a_nosing_farther_away_takes_nothing(number):
    steps = changed(even(6), 3, going_m=None)
    notes = [("step_impossible", "words", number)]
    assert "words" not in judged(inspection_of(steps, notes=notes), GOING).of_step(3)[0].reason


def test_of_a_single_value_the_range_does_not_apply_unless_others_are_missing():
    (alone,) = judged(inspection_of(even(2)), GOING_RANGE).findings
    assert alone.reason == "does not apply: a single step differs from nothing"
    (missing,) = judged(inspection_of(changed(even(3), 2, going_m=None)), GOING_RANGE).findings
    assert missing.reason.startswith("1 of 2 values are missing")


@pytest.mark.parametrize(("u", "verdict"), [(0.004, Verdict.OUTSIDE_CLOSE), (0.006, Verdict.NOT_JUDGED)])
def test_a_difference_that_is_less_certain_than_its_limit_is_large_is_not_judged(u, verdict):
    # 6 mm from one step to the next, where 5 are allowed.
    steps = changed(even(6, 0.0), 3, rise_m=measured(USUAL["rise"] + 0.006, u))
    for decision in ("guarded", "simple"):
        found = max(judged(inspection_of(steps), ADJACENT, decision=decision).findings, key=lambda each: each.value)
        if decision == "simple" and verdict is Verdict.OUTSIDE_CLOSE:
            assert found.verdict is Verdict.OUTSIDE
        else:
            assert found.verdict is verdict
        assert ("U is larger than the limit itself" in found.reason) == (verdict is Verdict.NOT_JUDGED)


def test_a_difference_far_beyond_its_limit_is_outside_however_uncertain_it_is():
    steps = changed(even(6, 0.0), 3, rise_m=measured(USUAL["rise"] + 0.03, 0.006))
    assert Verdict.OUTSIDE in {found.verdict for found in judged(inspection_of(steps), ADJACENT).findings}
