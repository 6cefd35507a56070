"""Which rules are chosen: sets, overlays, own files and changed limits, and what is wrong with a choice."""

import dataclasses
import json

import jsonschema
import pytest

from stair_inspector.codes import Limit, RuleEdit
from stair_inspector.errors import ConfigError
from stair_inspector.files.chosen_rules import (
    ChosenRules,
    LeftEdits,
    RuleFile,
    is_usable,
    known_sets,
    limit_of,
    n_edits,
    rule_set_of,
    with_edit,
    with_fitting,
    with_set,
    without_edits,
)
from stair_inspector.files.chosen_rules_values import chosen_from_dict, chosen_to_dict
from stair_inspector.files.paths import static_configs
from stair_inspector.files.rule_sets import find_rule_set, list_rule_sets

IBC = ChosenRules("us-ibc-2021")
OWN = (static_configs() / "codes" / "us-irc-2024.toml").read_text("utf-8").replace("us-irc-2024", "my-rules", 1)
MM_180 = Limit.of("180", "mm")
EDITED = with_edit(IBC, "riser", "maximum", MM_180, "agreed with the client")


def test_no_choice_is_no_check():
    assert rule_set_of(ChosenRules()) is None


@pytest.mark.parametrize("rule_set", [each for each in list_rule_sets() if not each.is_overlay], ids=lambda s: s.set_id)
def test_every_set_of_the_program_can_be_chosen(rule_set):
    assert rule_set_of(ChosenRules(rule_set.set_id)) == rule_set


def test_an_overlay_lies_over_the_set():
    made = rule_set_of(dataclasses.replace(IBC, overlay_ids=("us-nfpa-101-uniformity",)))
    overlay = find_rule_set("us-nfpa-101-uniformity")
    assert made.rules == find_rule_set("us-ibc-2021").rules + overlay.rules
    assert overlay.sha256 in made.overlays[0]


def test_a_changed_limit_is_kept_with_its_reason_and_can_be_taken_back():
    changed = with_edit(IBC, "riser", "maximum", MM_180, "agreed with the client")
    changed = with_edit(changed, "riser", "minimum", None, "no lower limit here")
    changed = with_edit(changed, "tread-depth", "minimum", Limit.of("280", "mm"), "metric print")
    made = rule_set_of(changed)
    assert limit_of(made.rule("riser"), "maximum") == MM_180
    assert limit_of(made.rule("riser"), "minimum") is None
    assert [(edit.rule_id, edit.side, edit.reason) for edit in made.edits] == [
        ("riser", "maximum", "agreed with the client"),
        ("riser", "minimum", "no lower limit here"),
        ("tread-depth", "minimum", "metric print"),
    ]
    assert rule_set_of(without_edits(changed)) == rule_set_of(IBC)
    kept = without_edits(changed, "riser")
    assert [edit.rule_id for edit in kept.edits] == ["tread-depth"]
    assert limit_of(rule_set_of(kept).rule("riser"), "maximum") == Limit.of("7", "in")


def test_a_limit_given_to_a_reported_rule_can_be_taken_away_again():
    osha = ChosenRules("us-osha-1910-25")
    given = with_edit(osha, "riser-uniformity", "maximum", Limit.of("5", "mm"), "the city's")
    # As a project has it: the file of the set says what the rule is, not the project.
    again = chosen_from_dict(chosen_to_dict(given))
    assert again == given
    assert rule_set_of(again).rule("riser-uniformity").severity == "limit"
    taken = with_edit(again, "riser-uniformity", "maximum", None, "not agreed")
    assert rule_set_of(taken).rules == find_rule_set("us-osha-1910-25").rules


def test_a_limit_changed_twice_tells_both_changes_and_comes_back_in_one():
    twice = with_edit(with_edit(IBC, "riser", "maximum", MM_180, "a"), "riser", "maximum", Limit.of("8", "in"), "b")
    assert [edit.before for edit in twice.edits] == [Limit.of("7", "in"), MM_180]
    assert without_edits(twice, "riser") == IBC


def test_changed_limits_stay_with_their_set_and_come_back_with_it():
    other = with_set(EDITED, "us-irc-2024")
    assert (other.edits, other.left) == ((), (LeftEdits("us-ibc-2021", EDITED.edits),))
    both = with_edit(other, "riser", "maximum", Limit.of("8", "in"), "another town")
    assert with_set(both, "us-ibc-2021").edits == EDITED.edits
    assert with_set(with_set(both, "us-ibc-2021"), "us-irc-2024") == both
    assert with_set(with_set(both, ""), "us-irc-2024") == both
    assert with_set(both, "us-irc-2024") == both
    assert chosen_from_dict(chosen_to_dict(both)) == both


NFPA = find_rule_set("us-nfpa-101-uniformity")
LAID = with_edit(
    dataclasses.replace(EDITED, overlay_ids=(NFPA.set_id,)), NFPA.rules[0].rule_id, "maximum", Limit.of("4", "mm"), "x"
)


@pytest.mark.parametrize("other", ["", "us-irc-2024"])
def test_changed_limits_of_an_overlay_come_back_with_the_set_and_the_overlay(other):
    away = with_set(LAID, other)
    assert away.left == (LeftEdits(IBC.set_id, LAID.edits, (NFPA.set_id,)),)
    assert chosen_from_dict(chosen_to_dict(away)) == away
    assert with_set(away, IBC.set_id) == LAID
    assert with_set(away, IBC.set_id, (NFPA.set_id,)) == LAID


def test_an_overlay_none_of_whose_limits_was_changed_does_not_come_back_by_itself():
    away = with_set(dataclasses.replace(EDITED, overlay_ids=(NFPA.set_id,)), "")
    assert away.left == (LeftEdits(IBC.set_id, EDITED.edits),)
    assert with_set(away, IBC.set_id) == EDITED


def test_left_changes_with_their_overlay_follow_the_schema_of_a_project():
    schema = json.loads((static_configs() / "schemas" / "project-1.schema.json").read_text(encoding="utf-8"))
    validator = jsonschema.Draft202012Validator({"$defs": schema["$defs"], **schema["properties"]["rules"]})
    values = chosen_to_dict(with_set(LAID, ""))
    assert values["left"][0]["overlays"] == [NFPA.set_id]
    validator.validate(values)
    values["left"][0]["overlays"] = NFPA.set_id
    assert not validator.is_valid(values)


def own_overlay(set_id):
    text = (static_configs() / "codes" / f"{NFPA.set_id}.toml").read_text("utf-8")
    return RuleFile.of(f"{set_id}.toml", text.replace(NFPA.set_id, set_id, 1).encode())


def test_an_overlay_that_comes_back_takes_the_place_of_one_with_the_same_rules():
    files = (own_overlay("my-overlay"),)
    away = dataclasses.replace(with_set(LAID, "us-irc-2024"), overlay_ids=("my-overlay",), files=files)
    assert with_set(away, IBC.set_id, away.overlay_ids) == dataclasses.replace(LAID, files=files)


def test_of_an_overlay_that_is_gone_the_changes_are_dropped_and_the_others_kept():
    files = (own_overlay("my-overlay"),)
    mine = dataclasses.replace(LAID, overlay_ids=("my-overlay",), files=files)
    away = with_set(mine, "")
    assert with_set(away, IBC.set_id) == mine
    assert with_set(dataclasses.replace(away, files=()), IBC.set_id) == EDITED


def test_left_changes_of_before_overlays_were_kept_can_be_read():
    values = chosen_to_dict(with_set(LAID, ""))
    del values["left"][0]["overlays"]
    assert chosen_from_dict(values).left == (LeftEdits(IBC.set_id, LAID.edits),)
    assert "overlays" not in chosen_to_dict(with_set(EDITED, ""))["left"][0]


def test_a_project_without_left_changes_is_written_as_ever():
    assert set(chosen_to_dict(EDITED)) == {"set", "overlays", "decision", "edits", "files"}


def test_of_left_changes_those_come_back_that_still_fit():
    own = dataclasses.replace(ChosenRules("my-rules"), files=(RuleFile.of("mine.toml", OWN.encode()),))
    changed = with_edit(own, "riser", "maximum", Limit.of("8", "in"), "a")
    changed = with_edit(changed, "riser", "maximum", Limit.of("9", "in"), "b")
    changed = with_edit(changed, "tread-depth", "minimum", Limit.of("9", "in"), "c")
    newer = RuleFile.of("mine.toml", OWN.replace('maximum = "7 3/4 in"', 'maximum = "7 in"').encode())
    left = dataclasses.replace(with_set(changed, ""), files=(newer,))
    back = with_set(left, "my-rules")
    assert [edit.reason for edit in back.edits] == ["c"]
    assert limit_of(rule_set_of(back).rule("riser"), "maximum") == Limit.of("7", "in")


def test_changes_of_rules_that_are_gone_do_not_fit():
    nfpa = dataclasses.replace(EDITED, overlay_ids=("us-nfpa-101-uniformity",))
    laid = with_edit(
        nfpa, find_rule_set("us-nfpa-101-uniformity").rules[0].rule_id, "maximum", Limit.of("4", "mm"), "x"
    )
    assert with_fitting(dataclasses.replace(laid, overlay_ids=()), laid.edits) == EDITED
    assert (n_edits(laid), n_edits(with_set(laid, ""))) == (2, 2)


def test_whether_a_choice_can_be_used():
    assert is_usable(EDITED)
    assert is_usable(ChosenRules())
    assert not is_usable(ChosenRules("us-ibc-2027"))
    assert not is_usable(dataclasses.replace(EDITED, set_id="us-irc-2024"))


def test_an_own_file_is_a_set_like_any_other_and_travels_whole():
    own = RuleFile.of("C:\\rules\\mine.toml", OWN.encode())
    chosen = ChosenRules("my-rules", files=(own,))
    assert own.name == "mine.toml"
    assert rule_set_of(chosen).rules == find_rule_set("us-irc-2024").rules
    assert list(known_sets(chosen))[-1] == "my-rules"
    assert chosen_from_dict(chosen_to_dict(chosen)) == chosen


@pytest.mark.parametrize("mark", ["", "\ufeff"])
def test_an_own_files_hash_is_that_of_its_bytes(tmp_path, mark):
    data = (mark + "# Größe\r\n" + OWN).encode()
    path = tmp_path / "mine.toml"
    path.write_bytes(data)
    assert RuleFile.of("mine.toml", data).rule_set.sha256 == find_rule_set(str(path)).sha256


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: rule_set_of(ChosenRules("us-ibc-2022")), "rules: unknown rule set 'us-ibc-2022'; did you mean 'us-ib"),
        (
            lambda: rule_set_of(ChosenRules("us-nfpa-101-uniformity")),
            "rules: us-nfpa-101-uniformity is an overlay; choose a full set, and lay it over that",
        ),
        (
            lambda: rule_set_of(dataclasses.replace(IBC, overlay_ids=("us-irc-2024",))),
            "rule set us-irc-2024 is a full set, no overlay; check against it by itself",
        ),
        (lambda: with_edit(ChosenRules(), "riser", "maximum", MM_180, "x"), "edit a limit: choose a rule set first"),
        (
            lambda: with_edit(IBC, "riser", "maximum", Limit.of("7", "in"), "x"),
            "edit a limit: the maximum of riser is 7 in (177.8 mm) already",
        ),
        (
            lambda: with_edit(IBC, "riser", "maximum", Limit.of("3", "in"), "x"),
            "edit a limit: a maximum of 3 in (76.2 mm) is below the minimum of riser, 4 in (101.6 mm); give another",
        ),
        (lambda: with_edit(IBC, "riser", "maximum", Limit.of("3", "deg"), "x"), "rule riser: maximum: 3° is no limit "),
        (
            lambda: with_edit(IBC, "riser", "minimum", Limit.of("8", "in"), "x"),
            "edit a limit: a minimum of 8 in (203.2 mm) is above the maximum of riser, 7 in (177.8 mm); give another",
        ),
        (
            lambda: with_edit(IBC, "tread-depth", "minimum", None, "x"),
            "edit a limit: tread-depth would be left without any; give a minimum, or give the maximum first",
        ),
        (
            lambda: with_edit(IBC, "riser", "maximum", Limit.of("7", "count"), "x"),
            "rule riser: maximum: 7 has no unit; ",
        ),
        (
            lambda: ChosenRules("us-ibc-2021", left=(LeftEdits("us-ibc-2021", EDITED.edits),)),
            "rules: left: the changes of us-ibc-2021 are none, too many, or there already; remove them",
        ),
        (
            lambda: ChosenRules(left=(LeftEdits("us-irc-2024", EDITED.edits), LeftEdits("us-irc-2024", EDITED.edits))),
            "rules: left: the changes of us-irc-2024 are none, too many, or there already; remove them",
        ),
        (
            lambda: ChosenRules(left=(LeftEdits("us-irc-2024", EDITED.edits, ("../x",)),)),
            "rules: left: overlay '../x': give up to 80 small",
        ),
        (
            lambda: ChosenRules(left=(LeftEdits("us-irc-2024", EDITED.edits, ("x",) * 21),)),
            "rules: left: 21 overlays; keep at most 20",
        ),
        (lambda: ChosenRules(left=(LeftEdits("us-ibc-2021", ()),)), "rules: left: the changes of us-ibc-2021 are none"),
        (lambda: ChosenRules(left=(LeftEdits("../x", EDITED.edits),)), "rules: left: set '../x': give up to 80 small"),
        (lambda: with_edit(IBC, "rise", "maximum", MM_180, "x"), "rule set us-ibc-2021: has no rule 'rise'"),
        (lambda: without_edits(IBC), "take back: nothing to revert"),
        (lambda: without_edits(IBC, "riser"), "take back: no limit of this rule was changed"),
        (
            lambda: rule_set_of(
                dataclasses.replace(IBC, edits=(RuleEdit("riser", "maximum", MM_180, Limit.of("8", "in"), "x"),))
            ),
            "rules: the maximum of riser was 180 mm when it was changed and is 7 in (177.8 mm) in us-ibc-2021.toml",
        ),
        (
            lambda: RuleFile("a.toml", OWN.replace("my-rules", "us-ibc-2021", 1)),
            "a.toml: the id 'us-ibc-2021' is that ",
        ),
        (lambda: RuleFile.of("a.toml", b"\xff\xfe"), "a.toml: is not a text file; give a TOML file"),
        (lambda: RuleFile("a.toml", "id = '\ud800'"), "a.toml: holds half a letter; give a text file"),
    ],
)
def test_what_is_wrong_with_a_choice_is_a_sentence(make, words):
    with pytest.raises(ConfigError) as error:
        make()
    assert str(error.value).startswith(words)
    assert "\n" not in str(error.value)
