"""Limits as written and their exact size; rule sets, edits and overlays."""

from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stair_inspector.codes.limits import UNITS, Limit, parse_written
from stair_inspector.codes.rule_sets import RuleSet, edited, overlaid
from stair_inspector.codes.rules import Condition, Rule
from stair_inspector.errors import ConfigError

# --- limits --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("written", "unit", "value", "text"),
    [
        ("3/8", "in", 0.009525, "3/8 in (9.525 mm)"),
        ("3/16", "in", 0.0047625, "3/16 in (4.7625 mm)"),
        ("3/4", "in", 0.01905, "3/4 in (19.05 mm)"),
        ("1 1/4", "in", 0.03175, "1 1/4 in (31.75 mm)"),
        ("1 1/2", "in", 0.0381, "1 1/2 in (38.1 mm)"),
        ("4", "in", 0.1016, "4 in (101.6 mm)"),
        ("7", "in", 0.1778, "7 in (177.8 mm)"),
        ("7 3/4", "in", 0.19685, "7 3/4 in (196.85 mm)"),
        ("9.5", "in", 0.2413, "9.5 in (241.3 mm)"),
        ("10", "in", 0.254, "10 in (254 mm)"),
        ("11", "in", 0.2794, "11 in (279.4 mm)"),
        ("22", "in", 0.5588, "22 in (558.8 mm)"),
        ("36", "in", 0.9144, "36 in (914.4 mm)"),
        ("44", "in", 1.1176, "44 in (1117.6 mm)"),
        ("80", "in", 2.032, "80 in (2032 mm)"),
        ("12", "ft", 3.6576, "12 ft (3657.6 mm)"),
        ("16", "cm", 0.16, "16 cm (160 mm)"),
        ("1.20", "m", 1.2, "1.20 m (1200 mm)"),
        ("220", "mm", 0.22, "220 mm"),
        ("42", "deg", 42.0, "42°"),
        ("1:48", "slope", 1 / 48, "1:48 (2.0833 %)"),
        ("1:50", "slope", 0.02, "1:50 (2 %)"),
        ("2", "%", 0.02, "2 %"),
        ("18", "count", 18.0, "18"),
    ],
)
def test_a_limit_is_converted_exactly_and_says_both(written, unit, value, text):
    limit = Limit.of(written, unit)
    assert limit.value == value
    assert limit.text == text


@given(whole=st.integers(0, 999), over=st.integers(0, 999), under=st.integers(1, 64))
def test_inches_and_their_fractions_are_exact(whole, over, under):
    limit = Limit.of(f"{whole} {over}/{under}", "in")
    assert limit.exact == (whole + Fraction(over, under)) * Fraction(254, 10_000)
    assert limit.value == float(limit.exact)


@given(number=st.decimals(0, 99_999, places=4), unit=st.sampled_from(["m", "cm", "mm", "in", "ft", "deg", "%"]))
def test_decimals_are_exact(number, unit):
    assert Limit.of(f"{number:f}", unit).exact == Fraction(number) * UNITS[unit]


@given(written=st.text(max_size=12), unit=st.text(max_size=6) | st.sampled_from(sorted(UNITS)))
def test_any_other_text_is_refused_with_a_sentence(written, unit):
    try:
        size = parse_written(written, unit)
    except ConfigError:
        return
    assert size >= 0


@pytest.mark.parametrize(
    ("written", "unit", "message"),
    [
        ("7 3/0", "in", "'7 3/0' is no number; write it as 11, 16.5, 3/8 or 7 3/4"),
        ("nan", "in", "'nan' is no number"),
        ("inf", "mm", "'inf' is no number"),
        ("-3", "mm", "'-3' is no number"),
        ("1e400", "mm", "'1e400' is no number"),
        ("٣", "mm", "is no number"),
        ("1:0", "slope", "'1:0' is no slope; write it as 1:48"),
        ("48", "slope", "'48' is no slope"),
        ("2.5", "count", "'2.5' is no count; give a whole number"),
        ("7", "inch", "unit 'inch' is not known; give one of m, cm, mm, in, ft, deg, slope, %, count"),
    ],
)
def test_what_is_no_limit_is_refused(written, unit, message):
    with pytest.raises(ConfigError) as caught:
        Limit.of(written, unit)
    assert message in str(caught.value)


def test_a_limit_of_another_size_than_its_words_is_refused():
    with pytest.raises(ConfigError, match=r"limit 7 in is 0.1778, not 0.178; use Limit.of"):
        Limit("7", "in", 0.178)


# --- rules ---------------------------------------------------------------------------------------------------------


def rule(rule_id="riser", **values):
    values = {
        "clause": "1.1",
        "term": "riser",
        "quantity": "rise",
        "statistic": "each",
        "minimum": Limit.of("4", "in"),
        "maximum": Limit.of("7", "in"),
        "severity": "limit",
        "from_scan": "yes",
        "grade": "P",
        **values,
    }
    return Rule(rule_id, **values)


def rule_set(*rules, **values):
    values = {"name": "Code", "edition": "2024", "variant": "", "source": "its text", **values}
    return RuleSet("my-set", rules=rules or (rule(),), **values)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"quantity": "height"}, "rule riser: quantity: got 'height'; give one of rise, going"),
        ({"quantity": []}, "rule riser: quantity: got []; give one of rise"),
        ({"statistic": "mean"}, "rule riser: statistic: got 'mean'; give one of each, flight_range"),
        ({"statistic": "flight"}, "rule riser: statistic: rise has no 'flight'; give each, flight_range"),
        ({"severity": "fatal"}, "rule riser: severity: got 'fatal'; give one of limit, advisory, report_only"),
        ({"from_scan": True}, "rule riser: from_scan: got True; give one of yes, partly, no"),
        ({"from_scan": "no"}, "from_scan: quantity 'other' is what no scan shows"),
        ({"grade": "A"}, "rule riser: grade: got 'A'; give one of P, S, G"),
        ({"clause": " "}, "rule riser: clause: is empty; fill it in"),
        ({"term": "a\nb"}, "rule riser: term: holds a line break or a control character"),
        ({"note": "\x1b[31m"}, "rule riser: note: holds a line break or a control character"),
        ({"note": "at most \u202e002\u202c mm"}, "rule riser: note: holds a line break or a control character"),
        ({"quantity": "pitch", "statistic": "flight_range"}, "statistic: the 'flight_range' of pitch is not judged"),
        (
            {"quantity": "two_r_plus_g", "statistic": "adjacent_difference"},
            "statistic: the 'adjacent_difference' of two_r_plus_g is not judged; limit rise and going",
        ),
        ({"note": "x" * 3000}, "rule riser: note: give a text of at most 2000 characters"),
        ({"maximum": Limit.of("42", "deg")}, "rule riser: maximum: 42° is no limit of rise; its units are m, cm"),
        ({"minimum": Limit.of("8", "in")}, "minimum 8 in (203.2 mm) is above maximum 7 in (177.8 mm); exchange them"),
        ({"minimum": None, "maximum": None}, "rule riser: has no limit; give a minimum or a maximum"),
    ],
)
def test_a_record_that_cannot_be_is_refused(values, message):
    with pytest.raises(ConfigError) as caught:
        rule(**values)
    assert message in str(caught.value)


def test_a_condition_is_about_a_step():
    with pytest.raises(ConfigError, match="only_where: quantity: got 'pitch'"):
        Condition("pitch", Limit.of("42", "deg"))


def test_a_set_has_each_rule_once():
    with pytest.raises(ConfigError, match="rule set my-set: rule riser is there twice; rename or remove one"):
        rule_set(rule(), rule())
    with pytest.raises(ConfigError, match="rule set my-set: has no rule 'risers'; its rules are riser"):
        rule_set().rule("risers")


# --- edits and overlays --------------------------------------------------------------------------------------------


def test_an_edit_is_recorded_and_leaves_the_original():
    before = rule_set()
    after = edited(before, "riser", "maximum", Limit.of("190", "mm"), "the city's amendment")
    again = edited(after, "riser", "minimum", None, "no least riser there")
    assert before.rule("riser").maximum == Limit.of("7", "in")
    assert not before.is_edited
    assert again.rule("riser").maximum == Limit.of("190", "mm")
    assert again.rule("riser").minimum is None
    assert [(edit.side, edit.before, edit.after, edit.reason) for edit in again.edits] == [
        ("maximum", Limit.of("7", "in"), Limit.of("190", "mm"), "the city's amendment"),
        ("minimum", Limit.of("4", "in"), None, "no least riser there"),
    ]
    assert again.is_edited


def test_what_the_changes_of_a_limit_come_to():
    first = edited(rule_set(), "riser", "maximum", Limit.of("190", "mm"), "first")
    second = edited(first, "riser", "maximum", Limit.of("8", "in"), "second")
    assert second.edit_of("riser", "maximum") == replace(second.edits[1], before=Limit.of("7", "in"))
    assert second.edit_of("riser", "minimum") is None
    assert (second.n_changed, second.is_changed("riser")) == (1, True)
    back = edited(second, "riser", "maximum", Limit.of("7", "in"), "as it was")
    assert back.is_edited
    assert (back.n_changed, back.is_changed("riser"), back.edit_of("riser", "maximum")) == (0, False, None)


def test_a_reported_rule_is_judged_while_it_has_a_limit_of_the_users():
    reported = rule(severity="report_only", minimum=None)
    first = edited(rule_set(reported), "riser", "maximum", Limit.of("6", "in"), "the client's wish")
    assert first.rule("riser").severity == "limit"
    assert first.is_reported_in_file("riser")
    second = edited(first, "riser", "maximum", None, "no wish at all")
    assert second.rule("riser") == replace(reported, maximum=None)
    third = edited(second, "riser", "minimum", Limit.of("3", "in"), "another wish")
    assert third.rule("riser").severity == "limit"
    bare = edited(third, "riser", "minimum", None, "none after all")
    back = edited(bare, "riser", "maximum", reported.maximum, "as it was")
    assert [each.rule("riser").severity for each in (bare, back)] == ["report_only", "report_only"]
    assert back.rules == (reported,)
    # To take one of two limits away gives none.
    both = rule_set(rule(severity="report_only"))
    assert edited(both, "riser", "minimum", None, "not here").rule("riser").severity == "report_only"


@pytest.mark.parametrize("severity", ["limit", "advisory"])
def test_another_rule_keeps_its_severity_when_its_limit_is_changed(severity):
    after = edited(rule_set(rule(severity=severity)), "riser", "maximum", Limit.of("6", "in"), "a wish")
    assert after.rule("riser").severity == severity
    assert not after.is_reported_in_file("riser")


def test_the_same_limit_again_is_no_edit():
    before = rule_set()
    assert edited(before, "riser", "maximum", Limit.of("7", "in"), "as it was") == before


@pytest.mark.parametrize(
    ("rule_id", "side", "limit", "reason", "message"),
    [
        ("tread", "maximum", Limit.of("1", "m"), "why", "has no rule 'tread'"),
        ("riser", "above", Limit.of("1", "m"), "why", "side: got 'above'; give one of minimum, maximum"),
        ("riser", "maximum", Limit.of("1", "m"), "  ", "rule riser: reason: is empty; fill it in"),
        ("riser", "maximum", Limit.of("1", "in"), "why", "minimum 4 in (101.6 mm) is above maximum 1 in (25.4 mm)"),
        ("riser", "maximum", Limit.of("1", "deg"), "why", "1° is no limit of rise"),
    ],
)
def test_an_edit_that_cannot_be_is_refused(rule_id, side, limit, reason, message):
    with pytest.raises(ConfigError) as caught:
        edited(rule_set(), rule_id, side, limit, reason)
    assert message in str(caught.value)


def test_an_overlay_adds_its_rules_and_is_named():
    overlay = rule_set(rule("adjacent"), is_overlay=True, sha256="ab" * 32, not_assessed=("lighting",))
    both = overlaid(rule_set(not_assessed=("lighting", "grip")), overlay)
    assert [each.rule_id for each in both.rules] == ["riser", "adjacent"]
    assert both.not_assessed == ("lighting", "grip")
    own = "user's own file, not a set that comes with the program"
    assert both.overlays == (f"Code, 2024 (my-set, SHA-256 {'ab' * 32}), {own}",)


def test_an_overlay_of_another_country_says_so():
    overlay = replace(rule_set(rule("adjacent"), is_overlay=True, is_shipped=True), set_id="us-nfpa")
    korea, us = (replace(rule_set(is_shipped=True), set_id=set_id) for set_id in ("kr-15-other", "us-irc-2024"))
    assert (
        overlaid(korea, overlay)
        .overlays[0]
        .endswith(": made for sets us-..., not for kr-15-other; take it as advice of another country")
    )
    assert overlaid(us, overlay).overlays == ("Code, 2024 (us-nfpa)",)
    assert "another country" not in overlaid(rule_set(), overlay).overlays[0]


def test_a_full_set_is_no_overlay():
    with pytest.raises(ConfigError, match="rule set my-set is a full set, no overlay; check against it by itself"):
        overlaid(rule_set(), rule_set(rule("other")))


def test_two_rules_of_one_id_do_not_lie_over_each_other():
    with pytest.raises(ConfigError, match="rule riser is there twice"):
        overlaid(rule_set(), rule_set(is_overlay=True))
