"""What choosing rules and changing limits does to the work and says on the Checks tab: without a browser."""

import dataclasses
from types import SimpleNamespace

import pytest

from stair_inspector.codes import Limit, RuleEdit, Verdict, check
from stair_inspector.errors import ConfigError
from stair_inspector.files.chosen_rules import ChosenRules, RuleFile, rule_set_of
from stair_inspector.files.paths import static_configs
from stair_inspector.files.rule_sets import find_rule_set
from stair_inspector.viewer.parts.checks import part as checks_module
from stair_inspector.viewer.parts.checks.limits import CHANGE, SIDES
from stair_inspector.viewer.parts.checks.rule_menus import NO_OVERLAY, NO_RULES
from stair_inspector.viewer.scene.step_marks import marks_of
from stair_inspector.viewer.state.change import PageChange
from tests.viewer.parts.test_html import Page
from tests.viewer.parts_of import part_of
from tests.viewer.wire_page import await_that

IBC, IRC, NFPA = "us-ibc-2024", "us-irc-2024", "us-nfpa-101-uniformity"
MINIMUM, MAXIMUM = SIDES
OWN = (static_configs() / "codes" / f"{IRC}.toml").read_text("utf-8").replace(IRC, "my-rules", 1)
OWN_OVERLAY = (static_configs() / "codes" / f"{NFPA}.toml").read_text("utf-8").replace(NFPA, "my-overlay", 1)


@pytest.fixture
def tab(session):
    return part_of(session, "checks")


@pytest.fixture
def checking(session):
    return part_of(session, "checks")


def words_of(html):
    return Page(html.content).words


def label_of(session, set_id):
    """The label of the menu that stands for a set or an overlay."""
    tab = part_of(session, "checks")
    short = set_id if set_id.startswith("my-") else set_id.partition("-")[2]
    (label,) = [each for each in (*tab.rules.options, *tab.overlay.options) if f" · {short} · " in each]
    return label


def choose(session, set_id):
    part_of(session, "checks").choose(label_of(session, set_id) if set_id else NO_RULES)


def pick_rule(session, rule_id):
    """Choose a rule of the menu of limits, as a person does."""
    tab = part_of(session, "checks")
    tab.limits.rule.value = next(label for label in tab.limits.rule.options if label.startswith(f"{rule_id}:"))
    part_of(session, "checks").limits.choose_rule(tab.limits.rule.value)


def change_limit(session, written, reason="agreed"):
    tab = part_of(session, "checks")
    tab.limits.limit.value, tab.limits.reason.value = written, reason
    part_of(session, "checks").limits.edit()


def verdicts_of(checking, rule_id):
    return {found.verdict for found in checking._judge.check.findings if found.rule.rule_id == rule_id}


def edits_of(session):
    return [(edit.rule_id, edit.side, edit.after.as_written) for edit in session.editor.work.rules.edits]


def upload(name, text):
    return SimpleNamespace(name=name, content=text.encode())


def await_told(page, words):
    await_that(lambda: any(words in told for told in page.told()), f"nobody said {words!r}")


# --- the field of the new limit --------------------------------------------------------------------------------------


def test_a_rule_that_is_chosen_comes_with_the_side_that_has_a_limit(session, tab):
    choose(session, IBC)
    pick_rule(session, "riser")
    assert (tab.limits.side.value, tab.limits.limit.value) == (MAXIMUM, "7 in")
    pick_rule(session, "tread-depth")
    assert (tab.limits.side.value, tab.limits.limit.value) == (MINIMUM, "11 in")
    change_limit(session, "12 in")
    assert edits_of(session) == [("tread-depth", "minimum", "12 in")]
    # A click on a result does the same.
    rules = [rule.rule_id for rule in session.judge.check.rule_set.rules]
    part_of(session, "checks").open_rule(str(rules.index("riser-uniformity") + 1))
    assert (tab.limits.rule.value.partition(":")[0], tab.limits.side.value, tab.limits.limit.value) == (
        "riser-uniformity",
        MAXIMUM,
        "3/8 in",
    )


def test_a_side_without_a_limit_is_said_to_be_without_before_one_is_added(session, tab):
    choose(session, IBC)
    pick_rule(session, "tread-depth")
    assert tab.limits._change.label == CHANGE
    tab.limits.side.value = MAXIMUM
    part_of(session, "checks").limits.choose_rule(tab.limits.rule.value)
    assert (tab.limits.side.value, tab.limits.limit.value) == (MAXIMUM, "")
    assert tab.limits._change.label == "Add a maximum: there is none"
    change_limit(session, "13 in")
    assert tab.limits._change.label == CHANGE
    assert edits_of(session) == [("tread-depth", "maximum", "13 in")]


def test_the_field_has_the_present_limit_whatever_changed_it(session, checking, tab):
    choose(session, IBC)
    pick_rule(session, "riser")
    change_limit(session, "180 mm")
    assert tab.limits.limit.value == "180 mm"
    checking.limits.revert()
    assert tab.limits.limit.value == "7 in"
    session.editor.undo()
    assert tab.limits.limit.value == "180 mm"
    session.editor.undo()
    assert tab.limits.limit.value == "7 in"
    session.editor.redo()
    choose(session, IRC)
    assert (tab.limits.rule.value.partition(":")[0], tab.limits.limit.value) == ("riser", "7 3/4 in")
    # Two sets with a rule of one label.
    choose(session, "uk-adk-2013-private")
    assert tab.limits.limit.value == "220 mm"
    before = tab.limits.rule.value
    choose(session, "uk-adk-2013-general-access")
    assert (tab.limits.rule.value, tab.limits.limit.value) == (before, "170 mm")


def test_what_is_typed_stays_while_the_limit_is_what_it_was(session, tab):
    choose(session, IBC)
    pick_rule(session, "riser")
    tab.limits.limit.value, tab.limits.reason.value = "1000000 ft", ""
    for words in ("has too many digits", "write why"):
        with pytest.raises(ConfigError, match=words):
            part_of(session, "checks").limits.edit()
        typed = tab.limits.limit.value
        part_of(session, "checks").choose_decision("simple: the value alone")
        part_of(session, "checks").choose_decision("guarded: U counts")
        assert tab.limits.limit.value == typed
        tab.limits.limit.value = "180 mm"


@pytest.mark.parametrize(
    ("rule_id", "written", "words"),
    [
        ("riser", "7 3/4", "new limit: got '7 3/4'; add a unit, as '7 3/4 in'"),
        ("riser", "7", "maximum: 7 has no unit; write one of m, cm, mm, in, ft after it"),
        ("riser", "180,5 mm", "new limit: got '180,5 mm'; write decimals with a point"),
        ("riser", "99999999999999999999999 mm", "new limit: '99999999999999999999999' has too many digits"),
        ("riser", "0 mm", "edit a limit: a maximum of 0 mm is below the minimum of riser, 4 in (101.6 mm); give ano"),
        ("tread-depth", "", "edit a limit: tread-depth would be left without any; give a minimum"),
    ],
)
def test_a_limit_that_cannot_be_is_refused_in_words_for_the_page(session, rule_id, written, words):
    choose(session, IBC)
    pick_rule(session, rule_id)
    with pytest.raises(ConfigError) as error:
        change_limit(session, written)
    assert words in str(error.value)
    assert session.editor.work.rules.edits == ()


@pytest.mark.parametrize("typed", ["7¾″", "7 3/4''", "7 3/4 IN", "7 3/4 inches"])
def test_fractions_and_signs_of_inches_are_read_as_typed(session, tab, typed):
    choose(session, IBC)
    pick_rule(session, "riser")
    change_limit(session, typed)
    assert tab.limits.limit.value == "7 3/4 in"


def test_a_limit_added_to_a_reported_rule_is_judged_and_goes_again(session, checking, tab):
    choose(session, "us-osha-1910-25")
    pick_rule(session, "riser-uniformity")
    tab.limits.side.value = MAXIMUM
    checking.limits.choose_rule(tab.limits.rule.value)
    assert tab.limits._change.label == "Add a maximum: there is none"
    change_limit(session, "50 mm")
    assert verdicts_of(checking, "riser-uniformity") == {Verdict.WITHIN}
    assert "1 limit changed by the user" in words_of(tab.summary)
    change_limit(session, "")
    assert verdicts_of(checking, "riser-uniformity") == {Verdict.REPORTED}
    assert checking._judge.check.rule_set.rules == find_rule_set("us-osha-1910-25").rules


# --- changed limits stay with their set ------------------------------------------------------------------------------


def test_changed_limits_stay_with_their_set_and_it_is_said(page, session, checking):
    choose(session, IBC)
    pick_rule(session, "riser")
    change_limit(session, "180 mm")
    kept = session.editor.work.rules.edits
    title = find_rule_set(IBC).title
    choose(session, IRC)
    await_told(page, f"{title} keeps 1 changed limit for when it is chosen again")
    assert session.editor.work.rules.edits == ()
    assert checking._judge.check.rule_set == find_rule_set(IRC)
    choose(session, "")
    choose(session, IBC)
    await_told(page, f"in force again: 1 changed limit of {title}")
    assert session.editor.work.rules.edits == kept
    assert session.keeper.project().rules.left == ()


def test_an_own_overlay_leaves_the_changed_limits_of_the_set(page, session, checking, tab):
    choose(session, IRC)
    pick_rule(session, "riser")
    change_limit(session, "180 mm")
    checking.choose_overlay(label_of(session, NFPA))
    checking.own_rules.take_file(upload("overlay.toml", OWN_OVERLAY))
    assert session.editor.work.rules.overlay_ids == ("my-overlay",)
    assert edits_of(session) == [("riser", "maximum", "180 mm")]
    await_told(page, f"the overlay {find_rule_set(NFPA).title} is not laid any more")
    checking.own_rules.forget_file()
    assert session.editor.work.rules.overlay_ids == ()
    assert edits_of(session) == [("riser", "maximum", "180 mm")]


def test_of_a_newer_own_file_the_changes_that_fit_are_kept_and_the_others_counted(page, session, checking):
    checking.own_rules.take_file(upload("mine.toml", OWN))
    checking.choose_overlay(label_of(session, NFPA))
    pick_rule(session, "riser")
    change_limit(session, "180 mm")
    pick_rule(session, "tread-depth")
    change_limit(session, "11 in")
    checking.own_rules.take_file(upload("mine.toml", OWN.replace('maximum = "7 3/4 in"', 'maximum = "7 in"')))
    assert edits_of(session) == [("tread-depth", "minimum", "11 in")]
    assert session.editor.work.rules.overlay_ids == (NFPA,)
    await_told(page, "dropped: 1 changed limit, of rules that are gone or have another limit now; Ctrl+Z undoes it")
    session.editor.undo()
    assert len(edits_of(session)) == 2
    checking.own_rules.forget_file()
    assert session.editor.work.rules == ChosenRules()
    await_told(page, "dropped: 2 changed limits")


def test_an_overlays_changed_limits_go_with_it_and_it_is_said(page, session, checking):
    choose(session, IBC)
    checking.choose_overlay(label_of(session, NFPA))
    pick_rule(session, find_rule_set(NFPA).rules[0].rule_id)
    change_limit(session, "4 mm")
    checking.choose_overlay(NO_OVERLAY)
    assert edits_of(session) == []
    await_told(page, "dropped: 1 changed limit")


@pytest.mark.parametrize("other", ["", IRC])
def test_an_overlay_with_a_changed_limit_comes_back_with_its_set_and_it_is_said(page, session, checking, other):
    choose(session, IBC)
    checking.choose_overlay(label_of(session, NFPA))
    pick_rule(session, find_rule_set(NFPA).rules[0].rule_id)
    change_limit(session, "4 mm")
    before = session.editor.work.rules
    base, overlay = find_rule_set(IBC).title, find_rule_set(NFPA).title
    choose(session, other)
    kept = f"{base} keeps 1 changed limit, with its overlay {overlay}, for when it is chosen again"
    await_told(page, kept)
    if other:
        checking.choose_overlay(NO_OVERLAY)
    choose(session, IBC)
    assert session.editor.work.rules == before
    await_told(page, f"in force again: 1 changed limit of {base}; laid again: the overlay {overlay}")
    assert not any("dropped" in told or "not laid" in told for told in page.told())


def test_an_overlay_that_goes_with_no_rules_or_a_forgotten_set_is_told(page, session, checking):
    choose(session, IBC)
    checking.choose_overlay(label_of(session, NFPA))
    choose(session, "")
    await_told(page, f"the overlay {find_rule_set(NFPA).title} is not laid any more")
    checking.own_rules.take_file(upload("mine.toml", OWN))
    checking.own_rules.take_file(upload("overlay.toml", OWN_OVERLAY.replace("NFPA 101", "A rule of ours")))
    title = checking._judge.check.rule_set.overlays[0].partition(" (my-overlay")[0]
    assert "A rule of ours" in title
    checking.own_rules.forget_file()
    assert session.editor.work.rules.overlay_ids == ()
    await_told(page, f"the overlay {title} is not laid any more")


# --- rules that cannot be used ---------------------------------------------------------------------------------------


def take_up(session, rules):
    session.editor.take_up(dataclasses.replace(session.editor.work, rules=rules), "a project")


def unfit(rule_id, reason):
    return RuleEdit(rule_id, "maximum", Limit.of("999", "mm"), Limit.of("150", "mm"), reason)


def test_changes_that_cannot_be_used_are_shown_and_taken_back_one_by_one(session, checking, tab):
    good = RuleEdit("riser", "maximum", Limit.of("7", "in"), Limit.of("180", "mm"), "agreed")
    edits = (good, unfit("riser-uniformity", "first"), unfit("tread-uniformity", "second"))
    take_up(session, ChosenRules(IBC, edits=edits))
    assert "was 999 mm when it was changed" in words_of(tab.summary)
    assert "No limit was changed" not in words_of(tab.limits.edits)
    for edit in edits:
        assert edit.reason in words_of(tab.limits.edits)
    with pytest.raises(ConfigError, match="or choose no rule set"):
        checking._judge.checked()
    for rule_id in ("riser-uniformity", "tread-uniformity"):
        pick_by_id = next(label for label in tab.limits.rule.options if label.startswith(f"{rule_id}:"))
        tab.limits.rule.value = pick_by_id
        # To choose the row is no mistake.
        checking.limits.choose_rule(pick_by_id)
        assert (tab.limits.rule.value, tab.limits.limit.value) == (pick_by_id, "")
        checking.limits.revert()
    assert session.editor.work.rules.edits == (good,)
    assert checking._judge.checked().rule_set == rule_set_of(ChosenRules(IBC, edits=(good,)))


def test_all_changes_that_cannot_be_used_are_taken_back_at_once(session, checking):
    take_up(session, ChosenRules(IBC, edits=(unfit("riser", "x"),)))
    checking.limits.revert_all()
    assert checking._judge.checked().rule_set == find_rule_set(IBC)


def test_a_set_that_this_version_does_not_have_is_named_in_the_menu_and_can_be_left(session, checking, tab):
    take_up(session, ChosenRules("us-irc-2027"))
    assert tab.rules.value == "us-irc-2027 (cannot be used)"
    assert tab.rules.value in tab.rules.options
    assert "unknown rule set 'us-irc-2027'" in words_of(tab.summary)
    checking.choose(tab.rules.value)
    assert session.editor.work.rules.set_id == "us-irc-2027"
    checking.choose(NO_RULES)
    assert session.editor.work.rules == ChosenRules()
    assert "us-irc-2027 (cannot be used)" not in tab.rules.options
    assert checking._judge.checked() is None


def test_what_cannot_be_used_is_refused_where_all_is_well(session, checking, tab):
    choose(session, IBC)
    before = session.editor.work.rules
    clash = OWN_OVERLAY.replace(f'id = "{find_rule_set(NFPA).rules[0].rule_id}"', 'id = "riser"', 1)
    with pytest.raises(ConfigError, match="riser is there twice"):
        checking.own_rules.take_file(upload("clash.toml", clash))
    for choose_it, words in ((checking.choose, "rule set"), (checking.choose_overlay, "overlay")):
        with pytest.raises(ConfigError, match=f"{words}: got 'x'; choose one of the menu"):
            choose_it("x")
    choose(session, "")
    with pytest.raises(ConfigError, match="overlay: choose a rule set first"):
        checking.choose_overlay(label_of(session, NFPA))
    with pytest.raises(ConfigError, match="choose a rule set and a rule first"):
        checking.limits.edit()
    with pytest.raises(ConfigError, match="no limit of this rule was changed"):
        checking.limits.revert()
    assert tab.overlay.value == NO_OVERLAY
    session.editor.undo()
    assert session.editor.work.rules == before


# --- menus, marks and redrawing --------------------------------------------------------------------------------------


def test_labels_of_the_menu_differ_where_the_field_still_shows_them(session, checking, tab):
    checking.own_rules.take_file(upload("mine.toml", OWN))
    for menu in (tab.rules, tab.overlay):
        # About as many letters as the field is wide.
        assert len({label[:30] for label in menu.options}) == len(menu.options)
    assert tab.rules.value == f"Own · my-rules · {find_rule_set(IRC).title}"


def test_the_next_step_outside_is_one_that_is_marked(session, checking):
    choose(session, "kr-15-elementary")
    inspection = session.desk.inspection
    marked = sorted(marks_of(inspection, check(inspection, find_rule_set("kr-15-elementary"))))
    assert marked
    chosen = []
    for _ in range(len(marked) + 1):
        checking.next_outside()
        chosen.append(session.desk.selected)
    assert chosen == [*marked, marked[0]]
    choose(session, "")
    with pytest.raises(ConfigError, match="there is none, or no rule set is chosen"):
        checking.next_outside()


def test_choosing_a_step_does_not_draw_every_rule_again(session, checking, tab, monkeypatch):
    drawn = []
    draw = checks_module.rules_html
    monkeypatch.setattr(checks_module, "rules_html", lambda *values: drawn.append(values) or draw(*values))
    choose(session, IBC)
    for number in (1, 2, 3):
        session.desk.select(number)
    assert len(drawn) == 1
    # What does change is drawn.
    session.desk.set_unit("in")
    assert "this check needs at most 0.20 in" in words_of(tab.by_rule)
    session.desk.set_unit("mm")
    assert "this check needs at most 5.08 mm" in words_of(tab.by_rule)
    checking.open_rule("1")
    assert 'aria-expanded="true"' in tab.by_rule.content
    assert len(drawn) == 4


def test_an_own_file_is_known_by_its_bytes(session, checking):
    checking.own_rules.take_file(upload("mine.toml", OWN))
    assert session.editor.work.rules.files == (RuleFile("mine.toml", OWN),)


# --- the summary -----------------------------------------------------------------------------------------------------


def test_while_a_scan_is_opened_the_summary_names_the_rules_that_wait_for_it(session, tab):
    await_that(lambda: session.desk.shown is not None, "there is no result")
    choose(session, IBC)
    assert "Nothing is measured yet" not in words_of(tab.summary)
    with session.desk.lock:
        # As when another scan is chosen.
        session.desk.clear()
        session.changed(PageChange.RESULT, PageChange.SCAN)
        words = words_of(tab.summary)
    assert "No rule set is chosen" not in words
    assert f"Chosen: {find_rule_set(IBC).title}. Nothing is measured yet" in words
