"""What the Checks tab says: every verdict in words with a sign, every place to click, and no markup from outside."""

import dataclasses
import re

import pytest

from stair_inspector.codes import DECISIONS, Limit, check, edited, gravest, overlaid
from stair_inspector.codes.phrases import value_text
from stair_inspector.content.document import SIGNS
from stair_inspector.files.palettes import read_palette
from stair_inspector.files.rule_sets import find_rule_set
from stair_inspector.model import Measured
from stair_inspector.viewer.bridge.markup import pick_script
from stair_inspector.viewer.parts.checks.checks_html import rules_html, steps_html
from stair_inspector.viewer.parts.checks.summary_html import edits_html, not_assessed_html, summary_html
from stair_inspector.viewer.scene.legends import legend_html
from stair_inspector.viewer.scene.step_marks import TONE_CSS, mark_html, marks_of, tone_of
from tests.codes.flights import changed, even, flight_of, inspection_of, measured, step
from tests.viewer.parts.test_html import Page

IBC = find_rule_set("us-ibc-2021")
HOSTILE = "<img src=x onerror=1>"
LIMIT_M = 7 * 0.0254


def rises(*values_m, u=0.0002):
    """A flight with these rises, its last step a landing."""
    steps = even(len(values_m), u)
    for number, value in enumerate(values_m, 1):
        steps = changed(steps, number, rise_m=None if value is None else measured(value, u))
    return inspection_of(steps)


DEFECTIVE = rises(0.170, 0.170, 0.190, 0.170, 0.170)
CLOSE = rises(0.170, LIMIT_M + 0.0001, 0.170, LIMIT_M - 0.0001, 0.170)


def of(page, name):
    return [attributes for _, attributes in page.tags if attributes.get("data-testid") == name]


def row_of(html, rule_id):
    """The text of the row of one rule."""
    page = Page(html)
    at = [row["data-rule"] for row in of(page, "rule-row")].index(rule_id)
    return " ".join(page.rows[at]), of(page, "rule-row")[at]


def test_without_rules_it_says_so_and_without_a_result_there_is_an_error_or_nothing():
    assert "No rule set is chosen" in Page(summary_html(None, "")).words
    assert Page(summary_html(None, "", f"My {HOSTILE}")).words.startswith(
        f"Chosen: My {HOSTILE}. Nothing is measured yet"
    )
    assert Page(summary_html(None, f"rules: {HOSTILE}")).words == f"rules: {HOSTILE}"
    assert rules_html(None, None, "pick") == '<div data-testid="check-rules"></div>'
    assert steps_html(DEFECTIVE, None, None, "pick") == '<div data-testid="check-steps"></div>'
    assert not_assessed_html(None) == '<div data-testid="not-assessed"></div>'


def test_the_summary_names_the_rules_their_file_and_the_decision_rule():
    words = Page(summary_html(check(DEFECTIVE, IBC), "")).words
    for part in (
        f"{SIGNS['bad']}values outside limits",
        "1011.5.2",
        IBC.title,
        "us-ibc-2021.toml",
        IBC.sha256[:12],
        "edited by the user: no",
        "source graded S",
        DECISIONS["guarded"],
    ):
        assert part in words


@pytest.mark.parametrize("word", ["compliant", "legal", "compliance"])
@pytest.mark.parametrize("inspection", [DEFECTIVE, CLOSE, rises(0.17, 0.17, 0.17)])
def test_nothing_is_called_legal(inspection, word):
    found = check(inspection, IBC)
    said = summary_html(found, "") + rules_html(found, 1, "pick") + steps_html(inspection, found, None, "pick")
    assert word not in Page(said).words.lower()


def test_every_rule_has_a_row_with_verdict_limit_value_margin_and_fitness():
    found = check(DEFECTIVE, IBC)
    page = Page(rules_html(found, None, "abc"))
    rows = of(page, "rule-row")
    assert [row["data-rule"] for row in rows] == [rule.rule_id for rule in IBC.rules]
    for row, cells, rule, fit in zip(rows, page.rows, IBC.rules, found.fits, strict=True):
        worst = gravest(found.of_rule(rule.rule_id))
        assert row["data-verdict"] == worst.verdict.value
        assert cells[0].startswith(SIGNS[tone_of(worst.verdict)] + worst.verdict.words)
        assert rule.limit_text in cells[1]
        assert rule.clause in cells[1]
        assert fit.words[1:] in cells[1]
        if worst.value is not None:
            assert value_text(worst) in cells[1]
    words, _ = row_of(rules_html(found, None, "pick"), "riser")
    assert "190.0 ± 0.2 mm at step 3, outside by 12.20 mm" in words
    assert "1 of 5" in words


def test_a_value_its_place_and_the_reason_are_told_apart():
    found = check(rises(0.17, None, 0.17), IBC)
    html = rules_html(found, None, "pick")
    words, _ = row_of(html, "width")
    assert " at step 1; the tread's width is inside the limit" in words
    words, _ = row_of(html, "riser")
    assert "step 2: not measured at step 2" in words
    unseen = next(rule.rule_id for rule in IBC.rules if rule.from_scan == "no")
    assert "the scan" not in row_of(html, unseen)[0].split("not assessed from a scan")[0]
    assert "the scan no staircase" not in Page(rules_html(check(inspection_of((), ()), IBC), None, None)).words


def test_values_outside_by_less_than_u_are_counted_beside_those_plainly_outside():
    near = LIMIT_M + 0.0001
    words, _ = row_of(rules_html(check(rises(0.17, near, 0.19, near, 0.17), IBC), None, "pick"), "riser")
    assert "1 of 5, and 2 outside by less than U" in words


def test_only_the_rule_whose_limit_is_changed_is_called_edited():
    changed_set = edited(IBC, "riser", "maximum", Limit.of("180", "mm"), "agreed")
    found = check(DEFECTIVE, changed_set)
    html = rules_html(found, None, "pick")
    assert [rule.rule_id for rule in IBC.rules if "✎ edited" in row_of(html, rule.rule_id)[0]] == ["riser"]
    back = edited(changed_set, "riser", "maximum", Limit.of("7", "in"), "not agreed")
    assert "✎" not in Page(rules_html(check(DEFECTIVE, back), None, "pick")).words
    # By step and in the marks too: the code lists no such limit.
    assert "at most 180 mm, outside by 10.00 mm ✎ edited" in Page(steps_html(DEFECTIVE, found, None, "pick")).words
    assert "(limit 180 mm, changed by the user, 1011.5.2)" in marks_of(DEFECTIVE, found)[3].words
    spread = next(
        row for row in Page(steps_html(DEFECTIVE, found, None, "pick")).rows if "at most 3/8 in" in " ".join(row)
    )
    assert " ".join(spread).count("✎ edited") == " ".join(spread).count("at most 180 mm")


def test_a_reported_rule_with_a_limit_of_the_users_says_so():
    osha = find_rule_set("us-osha-1910-25")
    words, _ = row_of(rules_html(check(DEFECTIVE, osha), None, "pick"), "riser-uniformity")
    assert "(reported only)" in words
    own = edited(osha, "riser-uniformity", "maximum", Limit.of("5", "mm"), "agreed")
    words, row = row_of(rules_html(check(DEFECTIVE, own), None, "pick"), "riser-uniformity")
    assert row["data-verdict"] == "outside"
    assert "(reported only in the file, judged against the user's limit) ✎ edited" in words


def test_values_nearer_to_a_limit_than_u_are_close_in_words():
    found = check(CLOSE, IBC)
    words, row = row_of(rules_html(found, 1, "pick"), "riser")
    assert row["data-verdict"] == "outside_close"
    assert row["aria-expanded"] == "true"
    assert f"{SIGNS['close']}outside, close: 177.9 ± 0.2 mm at step 2, outside by 0.10 mm" in words
    assert f"{SIGNS['close']}within, close: 177.7 ± 0.2 mm at step 4, inside by 0.10 mm" in words
    simple, row = row_of(rules_html(check(CLOSE, IBC, "simple"), 1, "pick"), "riser")
    assert row["data-verdict"] == "outside"
    assert "close" not in simple.split("Fit")[0]


def test_a_hairs_breadth_beyond_a_limit_is_not_shown_as_nothing():
    words, _ = row_of(rules_html(check(rises(0.17, LIMIT_M + 1e-6, 0.17), IBC), None, "pick"), "riser")
    assert "outside by less than 0.01 mm" in words


def test_what_was_not_measured_says_why_and_is_no_pass():
    found = check(rises(0.17, None, 0.17), IBC)
    words, row = row_of(rules_html(found, None, "pick"), "riser")
    assert row["data-verdict"] == "not_measured"
    assert "step 2" in words
    assert "not measured at step 2" in words


def test_lengths_in_inches_are_those_of_a_tape_and_limits_stay_as_written():
    words, _ = row_of(rules_html(check(DEFECTIVE, IBC), None, "pick", "in"), "riser")
    assert "7 1/2 in (7.480 ± 0.008) at step 3, outside by 0.48 in" in words
    assert "4 in (101.6 mm) to 7 in (177.8 mm)" in words
    assert "U up to 0.008 in; this check needs at most 0.20 in" in words


def test_metric_limits_are_given_in_inches_too_where_inches_are_read():
    metric = edited(IBC, "riser", "minimum", Limit.of("100", "mm"), "metric")
    metric = edited(metric, "riser", "maximum", Limit.of("18", "cm"), "metric")
    words, _ = row_of(rules_html(check(DEFECTIVE, metric), None, "pick", "in"), "riser")
    assert "100 mm to 18 cm (180 mm) (3.937 to 7.087 in)" in words
    mixed = edited(IBC, "riser", "maximum", Limit.of("180", "mm"), "metric")
    words, _ = row_of(rules_html(check(DEFECTIVE, mixed), None, "pick", "in"), "riser")
    assert "4 in (101.6 mm) to 180 mm (4 to 7.087 in)" in words
    assert "(3.937" not in row_of(rules_html(check(DEFECTIVE, metric), None, "pick"), "riser")[0]
    slope, _ = row_of(rules_html(check(DEFECTIVE, IBC), None, "pick", "in"), "tread-slope")
    assert "%" in slope
    assert " in" not in slope.split("Fit")[-1].split("needs")[-1]


def test_what_speaks_of_the_command_line_speaks_of_the_page_here():
    note = (
        "uncertainty_unstated",
        "registration is not stated: choose the scanner's preset, or set uncertainty.*",
        None,
    )
    inspection = inspection_of(even(), notes=(note,))
    words = Page(summary_html(check(inspection, IBC), "")).words
    assert "or state them on the Tune tab, under Survey" in words
    assert "uncertainty.*" not in words


def test_a_click_on_a_rule_opens_it_and_one_on_a_step_chooses_the_step():
    page = Page(rules_html(check(DEFECTIVE, IBC), 1, "the-control"))
    assert of(page, "rule-row")[0]["onclick"] == pick_script("the-control", 1, "rule")
    assert len(of(page, "finding")) == 5
    buttons = of(page, "finding-step")
    assert {button["data-of"] for button in buttons} >= {"1", "2", "3", "4", "5"}
    third = next(button for button in buttons if button["data-of"] == "3")
    assert third["onclick"] == "event.stopPropagation();" + pick_script("the-control", 3)


def test_by_step_what_there_is_to_tell_is_listed_and_the_rest_is_counted():
    found = check(DEFECTIVE, IBC)
    page = Page(steps_html(DEFECTIVE, found, 3, "the-control"))
    rows = {row["data-of"]: row for row in of(page, "check-step-row")}
    assert rows["3"]["data-verdict"] == "outside"
    assert rows["3"]["aria-selected"] == "true"
    assert rows["3"]["onclick"] == pick_script("the-control", 3)
    text = next(cells[1] for cells in page.rows if cells[0] == f"step 3 {SIGNS['bad']}")
    assert f"{SIGNS['bad']}outside: riser height 190.0 ± 0.2 mm" in text
    # The limit and the distance from it stand beside the value.
    assert "at most 7 in, outside by 12.20 mm" in text
    assert set(rows) == {"3"}
    assert "within" in page.words


def test_the_steps_that_are_marked_here_are_those_marked_elsewhere():
    """An innocent neighbour of an odd step is not called outside; advice is called advice."""
    nfpa = find_rule_set("us-nfpa-101-uniformity")
    both = overlaid(IBC, nfpa)
    inspection = rises(0.170, 0.170, 0.170, 0.1774, 0.170, 0.170)
    for rules in (IBC, nfpa, both):
        found = check(inspection, rules)
        page = Page(steps_html(inspection, found, None, "pick"))
        marked = {int(cells[0].split()[1]) for cells in page.rows if len(cells[0].split()) > 2}
        assert marked == set(marks_of(inspection, found))
    assert marked == {4}
    assert [row["data-of"] for row in of(page, "check-step-row")] == ["4"]
    advice = dataclasses.replace(IBC, rules=(dataclasses.replace(IBC.rule("riser"), severity="advisory"),))
    page = Page(steps_html(DEFECTIVE, check(DEFECTIVE, advice), None, "pick"))
    assert page.rows[0][0] == "step 3"
    assert "(advice, no limit)" in page.rows[0][1]


def test_of_two_steps_that_are_as_odd_both_are_told_and_marked():
    inspection = rises(0.170, 0.166, 0.174, 0.170)
    found = check(inspection, find_rule_set("us-nfpa-101-uniformity"))
    assert {2, 3} <= set(marks_of(inspection, found))
    rows = [row["data-of"] for row in of(Page(steps_html(inspection, found, None, "pick")), "check-step-row")]
    assert {"2", "3"} <= set(rows)


def test_the_odd_one_is_odd_in_its_own_flight():
    steps = [*even(5, 0.0002, rise=0.150), *even(5, 0.0002, rise=0.180)]
    steps = [dataclasses.replace(each, step_id=k, flight=1 + (k > 5)) for k, each in enumerate(steps, 1)]
    steps = changed(steps, 3, rise_m=measured(0.160, 0.0002))
    inspection = inspection_of(steps, [flight_of(steps[:5]), flight_of(steps[5:], flight_id=2)])
    assert set(marks_of(inspection, check(inspection, find_rule_set("us-nfpa-101-uniformity")))) == {3}


def test_a_step_of_which_nothing_was_judged_is_not_called_within():
    uniform = dataclasses.replace(IBC.rule("riser"), severity="report_only", minimum=None, maximum=None)
    inspection = rises(0.17, 0.17, 0.17)
    page = Page(steps_html(inspection, check(inspection, dataclasses.replace(IBC, rules=(uniform,))), None, "pick"))
    assert of(page, "check-within") == []
    assert "No value of a single step was judged." in page.words


@pytest.mark.parametrize("tone", sorted(TONE_CSS))
def test_small_letters_in_a_tone_can_be_read_on_either_theme(tone):
    """Contrast of text as WCAG 2.1 defines it; the darkest ground on the light theme is a hovered row's."""
    light, dark = re.findall(r"#([0-9a-f]{6})", TONE_CSS[tone])

    def luminance(color):
        parts = [int(color[k : k + 2], 16) / 255.0 for k in (0, 2, 4)]
        linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
        return sum(weight * part for weight, part in zip((0.2126, 0.7152, 0.0722), linear, strict=True))

    assert (luminance("f1f3f5") + 0.05) / (luminance(light) + 0.05) >= 4.5
    assert (luminance(dark) + 0.05) / (luminance("2e2e2e") + 0.05) >= 4.5


def test_an_overlays_own_brackets_stay_and_its_hash_goes():
    overlay = dataclasses.replace(find_rule_set("us-nfpa-101-uniformity"), name="My (house) overlay")
    words = Page(summary_html(check(DEFECTIVE, overlaid(IBC, overlay)), "")).words
    assert "overlay My (house) overlay, edition not stated" in words
    assert overlay.sha256 not in words


class CountedFindings(tuple):
    """Findings that know how often somebody went through them all."""

    n_passes = 0

    def __iter__(self):
        type(self).n_passes += 1
        return super().__iter__()


def test_the_findings_are_not_gone_through_for_each_rule():
    rules = tuple(dataclasses.replace(IBC.rule("riser"), rule_id=f"r{k}") for k in range(200))
    found = check(inspection_of(even(10, 0.0002)), dataclasses.replace(IBC, rules=rules))
    shown = rules_html(dataclasses.replace(found, findings=CountedFindings(found.findings)), None, "abc")
    assert shown.count("<details") + shown.count("<tr") >= 200
    # With a pass for each of a thousand rules the page took a second.
    assert 0 < CountedFindings.n_passes <= 5


def test_what_no_scan_shows_is_listed():
    words = Page(not_assessed_html(check(DEFECTIVE, IBC))).words
    for sentence in IBC.not_assessed:
        assert sentence in words


def test_a_users_own_file_and_an_overlay_of_another_country_are_told():
    own = dataclasses.replace(IBC, is_shipped=False)
    words = Page(summary_html(check(DEFECTIVE, own), "")).words
    assert " · user's own file, not a set that comes with the program; limits edited afterwards: no · " in words
    assert "edited by the user" not in words
    korea = overlaid(find_rule_set("kr-15-other"), find_rule_set("us-nfpa-101-uniformity"))
    assert (
        "not for kr-15-other; take it as advice of another country"
        in Page(summary_html(check(DEFECTIVE, korea), "")).words
    )


def test_a_step_at_which_a_clause_may_or_may_not_apply_is_told():
    steps = changed(even(nosing_overhang=0.005), 2, going_m=measured(0.279, 0.001))
    inspection = inspection_of(steps)
    nosing = dataclasses.replace(find_rule_set("us-irc-2024").rule("nosing"), severity="limit", from_scan="yes")
    page = Page(steps_html(inspection, check(inspection, dataclasses.replace(IBC, rules=(nosing,))), None, "pick"))
    assert [row["data-of"] for row in of(page, "check-step-row")] == ["2"]
    assert "not judged" in page.words


def test_a_changed_limit_is_marked_with_before_after_and_reason():
    changed_set = edited(IBC, "riser", "maximum", Limit.of("180", "mm"), f"because {HOSTILE}")
    page = Page(edits_html(changed_set.edits))
    assert page.words == f"riser, maximum: 7 in (177.8 mm) → 180 mm – because {HOSTILE}"
    words, _ = row_of(rules_html(check(DEFECTIVE, changed_set), None, "pick"), "riser")
    assert "✎ edited" in words
    assert "to 180 mm" in words
    assert "edited by the user: yes, 1" in Page(summary_html(check(DEFECTIVE, changed_set), "")).words
    assert "as in the rule file" in Page(edits_html(())).words


def test_texts_of_a_rule_file_are_never_markup():
    rule = dataclasses.replace(IBC.rule("riser"), clause=HOSTILE, term=HOSTILE, note=HOSTILE, applies=HOSTILE)
    hostile = dataclasses.replace(
        IBC, name=HOSTILE, edition=HOSTILE, file=HOSTILE, rules=(rule,), not_assessed=(HOSTILE,), overlays=(HOSTILE,)
    )
    found = check(DEFECTIVE, hostile)
    for html in (
        summary_html(found, ""),
        rules_html(found, 1, "abc"),
        steps_html(DEFECTIVE, found, None, "abc"),
        not_assessed_html(found),
        mark_html(marks_of(DEFECTIVE, found)[3]),
    ):
        assert Page(html).of("img") == []


def test_steps_that_are_outside_a_limit_are_marked_and_their_innocent_neighbours_are_not():
    marks = marks_of(DEFECTIVE, check(DEFECTIVE, IBC))
    # The range of the flight is too large as well: of its two ends the third step is the odd one.
    assert {number: mark.sign for number, mark in marks.items()} == {3: SIGNS["bad"]}
    assert "riser height 190.0 ± 0.2 mm, outside (limit 7 in (177.8 mm), 1011.5.2)" in marks[3].words
    assert marks_of(CLOSE, check(CLOSE, IBC))[2].sign == SIGNS["close"]
    assert marks_of(None, None) == {}
    assert marks_of(DEFECTIVE, check(DEFECTIVE, IBC))[3].words in mark_html(marks[3])


def test_of_two_neighbours_the_odd_one_is_marked():
    nfpa = find_rule_set("us-nfpa-101-uniformity")
    inspection = rises(0.170, 0.170, 0.177, 0.170, 0.170, 0.170)
    assert set(marks_of(inspection, check(inspection, nfpa))) == {3}


def test_the_legend_says_what_the_marks_mean_where_there_are_some():
    palette = read_palette("page")
    assert "outside" not in Page(legend_html(palette)).words
    assert f"{SIGNS['bad']} outside a limit" in Page(legend_html(palette, tones={"bad"})).words
    assert f"{SIGNS['close']} outside by less than U" in Page(legend_html(palette, tones={"close"})).words


def test_advice_marks_no_step():
    advice = dataclasses.replace(IBC, rules=(dataclasses.replace(IBC.rule("riser"), severity="advisory"),))
    found = check(DEFECTIVE, advice)
    assert any(each.verdict.is_outside for each in found.findings)
    assert marks_of(DEFECTIVE, found) == {}


def test_a_stair_without_steps_and_one_with_a_single_step_are_told():
    nothing = inspection_of((), ())
    found = check(nothing, IBC)
    # Once, and not in every row.
    words = Page(rules_html(found, None, "pick")).words
    assert words.count("no staircase was found") == 1
    assert "Nothing was measured" not in words
    assert all(rule.limit_text in words for rule in IBC.rules)
    assert steps_html(nothing, found, None, "pick") == '<div data-testid="check-steps"></div>'
    single = inspection_of([step(1, rise=Measured(0.2, 0.0002))])
    assert marks_of(single, check(single, IBC))[1].sign == SIGNS["bad"]
