"""The Checks tab as an inspector uses it: choosing rules, reading verdicts, finding the step, changing a limit."""

import pytest

from stair_inspector.codes import Limit, check, edited, gravest, overlaid
from stair_inspector.codes.phrases import value_text
from stair_inspector.files.paths import static_configs
from stair_inspector.files.project_files import parse_project
from stair_inspector.files.rule_sets import find_rule_set
from stair_inspector.viewer.parts.checks.rule_menus import NO_OVERLAY, NO_RULES
from stair_inspector.viewer.scene.step_marks import marks_of
from tests.browser.inspector_page import THROTTLE_MS, click_at_once, share_changed
from tests.browser.test_layout import TABS
from tests.browser.test_layout import check as check_layout
from tests.browser.test_workspace import LARGE, button, open_folder, row_input, upload

SHARED, UK = "kr-15-elementary", "uk-adk-2013-general-access"
CORNER = {"x": 6, "y": 6}
"""Of a row: in its middle a step may be named, whose click chooses the step."""
IBC, IRC = "us-ibc-2024", "us-irc-2024"
OWN_RULES = (static_configs() / "codes" / "us-irc-2024.toml").read_text("utf-8").replace("us-irc-2024", "my-rules", 1)


@pytest.fixture
def page(page):
    """The shared page without rules, and left so."""
    yield page
    page.page.keyboard.press("Escape")
    page.tab("Checks")
    if page.by_id("check").count() == 0 or page.by_id("check").get_attribute("data-set"):
        choose_rules(page, NO_RULES, "")


def label_of(set_id):
    country, _, short = set_id.partition("-")
    return f"{ {'kr': 'Korea', 'uk': 'UK', 'us': 'US'}[country] } · {short} · {find_rule_set(set_id).title}"


def choose_rules(page, label, set_id):
    page.tab("Checks")
    page.choose("Rule set", label)
    page.page.locator(f"[data-testid=check][data-set='{set_id}']").wait_for()


def verdicts(page):
    """The verdict of every rule as the page shows it."""
    rows = page.by_id("rule-row").all()
    return {row.get_attribute("data-rule"): row.get_attribute("data-verdict") for row in rows}


def wanted(found):
    return {rule.rule_id: gravest(found.of_rule(rule.rule_id)).verdict.value for rule in found.rule_set.rules}


def await_verdict(page, rule_id, verdict):
    page.page.locator(f"[data-testid=rule-row][data-rule='{rule_id}'][data-verdict={verdict}]").wait_for()


def marks(page, tab):
    """The signs beside the numbers of the steps in the table of a tab."""
    page.tab(tab)
    rows = page.page.locator("[data-testid=step-row]:has([data-testid=mark])")
    signs = [row.locator("[data-testid=mark]").inner_text() for row in rows.all()]
    return dict(zip((int(row.get_attribute("data-step")) for row in rows.all()), signs, strict=True))


@pytest.mark.slow
def test_results_by_rule_and_by_step_are_those_of_the_check_and_failing_steps_are_marked(page, measured):
    before = page.still_picture()
    choose_rules(page, label_of(SHARED), SHARED)
    found = check(measured(), find_rule_set(SHARED))
    assert verdicts(page) == wanted(found)
    said = page.text("check-rules")
    for rule in found.rule_set.rules:
        worst = gravest(found.of_rule(rule.rule_id))
        assert worst.verdict.words in said
        assert rule.limit_text in said
        assert worst.value is None or value_text(worst) in said
    assert all(fit.words[1:] in said for fit in found.fits)
    assert all(sentence in page.text("not-assessed") for sentence in found.not_assessed)
    failing = {number: mark.sign for number, mark in marks_of(measured(), found).items()}
    assert failing
    assert marks(page, "Steps") == failing
    assert marks(page, "Tune") == failing
    page.tab("Checks")
    rows = page.page.locator("[data-testid=check-step-row]:has([data-testid=mark])").all()
    assert {
        int(row.get_attribute("data-of")): row.locator("[data-testid=mark]").inner_text() for row in rows
    } == failing
    page.await_node("/stair/segments/outside")
    assert share_changed(before, page.still_picture(unlike=before)) > 0.001
    assert "outside a limit" in page.text("legend")
    choose_rules(page, NO_RULES, "")
    page.await_node("/stair/segments/outside", there=False)
    assert marks(page, "Steps") == {}


@pytest.mark.slow
def test_a_click_on_a_finding_chooses_its_step_and_the_check_follows_the_settings(page, measured):
    choose_rules(page, label_of(SHARED), SHARED)
    failing = marks_of(measured(), check(measured(), find_rule_set(SHARED)))
    page.by_id("rule-row").first.click(position=CORNER)
    page.by_id("finding").first.wait_for()
    click_at_once(page.by_id("findings").locator("[data-of='2']").first)
    page.await_selection(2)
    page.page.locator("[data-testid=check-step-row][data-of='3']").click()
    page.await_selection(3)
    assert page.page.locator("[data-testid=check-step-row][data-of='3'][aria-selected=true]").count() == 1
    page.hotkey("n")
    page.await_selection(next(step for step in failing if step > 3))
    # Judged again at every result.
    page.press("θ_th [°]", "ArrowRight", times=2)
    page.await_result("θ_th 16°")
    found = check(measured({"horizontal.theta_deg": 16.0}), find_rule_set(SHARED))
    page.tab("Checks")
    assert verdicts(page) == wanted(found)
    assert value_text(gravest(found.of_rule("width"))) in page.text("check-rules")


@pytest.mark.slow
def test_a_limit_is_changed_with_a_reason_marked_kept_in_the_project_and_taken_back(page, measured):
    choose_rules(page, label_of(UK), UK)
    base = find_rule_set(UK)
    rule = next(rule for rule in base.rules if rule.quantity == "rise" and rule.statistic == "each")
    page.page.locator(f"[data-testid=rule-row][data-rule='{rule.rule_id}']").click(position=CORNER)
    open_folder(page, "Checks", "Change a limit", button(page, "Change the limit"))
    assert row_input(page, "New limit").input_value() == rule.maximum.as_written
    row_input(page, "New limit").fill("165 mm")
    page.page.wait_for_timeout(THROTTLE_MS)
    button(page, "Change the limit").click()
    assert "write why" in page.await_notification("Not done")
    page.close_notifications()
    row_input(page, "Why").fill("agreed <b>with</b> the client")
    page.page.wait_for_timeout(THROTTLE_MS)
    button(page, "Change the limit").click()
    page.by_id("edited").first.wait_for()
    changed = edited(base, rule.rule_id, "maximum", Limit.of("165", "mm"), "agreed <b>with</b> the client")
    assert verdicts(page) == wanted(check(measured(), changed))
    assert "170 mm → 165 mm – agreed <b>with</b> the client" in page.text("check-edits")
    assert "edited by the user: yes" in page.text("check")
    name, content = page.download("Project file")
    assert parse_project(content, name).rules.edits == changed.edits
    page.tab("Checks")
    button(page, "As in the file: this rule").click()
    page.by_id("edited").first.wait_for(state="detached")
    assert verdicts(page) == wanted(check(measured(), base))
    page.hotkey("Control+z")
    page.by_id("edited").first.wait_for()
    # The set keeps its changes: what comes after finds it as in the file.
    page.hotkey("Control+Shift+z")
    page.by_id("edited").first.wait_for(state="detached")


@pytest.mark.slow
def test_the_editor_shows_the_limit_that_would_be_changed(page):
    choose_rules(page, label_of(IBC), IBC)
    open_folder(page, "Checks", "Change a limit", button(page, "Change the limit"))
    limit = row_input(page, "New limit")
    page.page.locator("[data-testid=rule-row][data-rule='tread-depth']").click(position=CORNER)
    page.page.wait_for_function("() => document.querySelector('[data-rule=tread-depth][aria-expanded=true]')")
    assert (limit.input_value(), page.page.get_by_label("Side", exact=True).input_value()) == ("11 in", "minimum")
    page.choose("Side", "maximum")
    button(page, "Add a maximum: there is none").wait_for()
    assert limit.input_value() == ""
    page.page.locator("[data-testid=rule-row][data-rule='riser']").click(position=CORNER)
    button(page, "Change the limit").wait_for()
    assert limit.input_value() == "7 in"
    limit.fill("180 mm")
    row_input(page, "Why").fill("city amendment")
    page.page.wait_for_timeout(THROTTLE_MS)
    button(page, "Change the limit").click()
    page.by_id("edited").first.wait_for()
    assert "1 limit was changed by the user" in page.text("check")
    choose_rules(page, label_of(IRC), IRC)
    assert "keeps 1 changed limit" in page.await_notification("Changed limits and overlays")
    page.close_notifications()
    assert limit.input_value() == "7 3/4 in"
    choose_rules(page, label_of(IBC), IBC)
    page.by_id("edited").first.wait_for()
    assert limit.input_value() == "180 mm"
    page.close_notifications()
    button(page, "As in the file: all rules").click()
    page.by_id("edited").first.wait_for(state="detached")


@pytest.mark.slow
def test_overlay_decision_and_errors(page, measured):
    choose_rules(page, label_of(UK), UK)
    page.choose("Overlay", label_of("us-nfpa-101-uniformity"))
    both = overlaid(find_rule_set(UK), find_rule_set("us-nfpa-101-uniformity"))
    page.page.wait_for_function(
        "(n) => document.querySelectorAll('[data-testid=rule-row]').length === n", arg=len(both.rules)
    )
    assert verdicts(page) == wanted(check(measured(), both))
    page.choose("Decision rule", "simple: the value alone")
    page.page.wait_for_function(
        "() => document.querySelector('[data-testid=check]').innerText.includes('Simple acceptance')"
    )
    assert verdicts(page) == wanted(check(measured(), both, "simple"))
    page.choose("Decision rule", "guarded: U counts")
    page.choose("Overlay", NO_OVERLAY)
    # What no control of the page sends.
    for label, value in (("Rule set", "<b>"), ("Overlay", "x"), ("Decision rule", "y")):
        page.send(page.uuid(label), value)
        assert "choose one of the menu" in page.await_notification("Not done")
        page.close_notifications()


@pytest.mark.slow
def test_an_own_rule_file_is_a_set_of_the_menu_and_a_bad_one_is_a_sentence(page, measured):
    open_folder(page, "Checks", "Own rule file", button(page, "Load a rule file"))
    upload(page, "Load a rule file", "bad.toml", OWN_RULES.replace("quantity", "quantitie", 1).encode())
    assert "did you mean 'quantity'" in page.await_notification("Not done").replace('"', "'")
    page.close_notifications()
    upload(page, "Load a rule file", "mine.toml", OWN_RULES.encode())
    page.page.locator("[data-testid=check][data-set='my-rules']").wait_for()
    assert page.page.get_by_label("Rule set", exact=True).first.input_value().startswith("Own · my-rules · Internation")
    assert verdicts(page) == wanted(check(measured(), find_rule_set("us-irc-2024")))
    with page.page.expect_download() as waiting:
        button(page, "Save the file of this set").click()
    with open(waiting.value.path(), "rb") as stream:
        assert stream.read() == OWN_RULES.encode()
    button(page, "Forget this own set").click()
    page.page.locator("[data-testid=check][data-set='']").wait_for()


@pytest.mark.slow
def test_the_papers_method_is_not_judged(page):
    choose_rules(page, label_of(SHARED), SHARED)
    page.tab("Scan")
    page.choose("Method", "paper")
    page.await_result("paper")
    page.tab("Checks")
    assert "paper's method measures nothing from nosing to nosing" in page.text("check-rules")
    assert "nothing could be judged" in page.text("check").lower()
    page.tab("Scan")
    page.choose("Method", "survey")
    page.await_result("survey")


@pytest.mark.slow
def test_rows_are_opened_by_the_keyboard(page):
    choose_rules(page, label_of(SHARED), SHARED)
    page.by_id("rule-row").first.focus()
    page.page.keyboard.press("Enter")
    page.by_id("finding").first.wait_for()
    page.by_id("rule-row").first.focus()
    page.page.keyboard.press("Enter")
    page.by_id("finding").first.wait_for(state="detached")


@pytest.mark.slow
@pytest.mark.parametrize("size", [None, LARGE], ids=["small", "large"])
def test_the_tab_fits_light_and_dark_with_everything_open(open_page, size):
    page = open_page() if size is None else open_page(width=size[0], height=size[1])
    choose_rules(page, label_of(SHARED), SHARED)
    page.by_id("rule-row").first.click(position=CORNER)
    open_folder(page, "Checks", "Change a limit", button(page, "Change the limit"))
    open_folder(page, "Checks", "Own rule file", button(page, "Load a rule file"))
    check_layout(page)
    page.tab("Checks")
    for name in ("check", "check-rules", "check-steps", "not-assessed"):
        wide, room = page.by_id(name).evaluate("(element) => [element.scrollWidth, element.clientWidth]")
        assert wide <= room, name
    tabs = page.page.locator("[role=tab][data-dock-tab]")
    heights = {round(tab.bounding_box()["y"]) for tab in tabs.all() if tab.inner_text() in TABS}
    assert len(heights) == 1
    page.set_dark(True)
    check_layout(page)
