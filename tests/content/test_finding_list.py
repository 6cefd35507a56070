"""One list of all findings: each is there once, under a key that outlasts a run, and what was said of it stays."""

import dataclasses

import pytest

from stair_inspector.codes import check
from stair_inspector.content.document import Figure
from stair_inspector.content.fields import ReportBasis
from stair_inspector.content.finding_list import list_findings, steps_marked
from stair_inspector.content.finding_tables import finding_blocks, listed_record, listed_table, moment_words
from stair_inspector.content.order import build_document
from stair_inspector.content.pins import FindingDecision, Pin, PinnedFindings
from stair_inspector.content.step_places import middle_of
from stair_inspector.files.rule_sets import find_rule_set
from stair_inspector.model import Note, Observation
from tests.content.staircases import staircase
from tests.content.test_pins import GUID, PIN, WHEN, guid
from tests.writers.samples import MADE_AT, checked, scanned, workbook
from tests.writers.samples import html_page as page_of

NOTHING = PinnedFindings()


def by_key(found):
    return {entry.key: entry for entry in found}


@pytest.mark.slow
def test_every_value_outside_a_limit_is_a_row():
    _, inspection = scanned()
    outside = [found for found in checked().findings if found.verdict.is_outside]
    listed = list_findings(inspection, checked(), NOTHING)
    assert len([entry for entry in listed if entry.kind == "limit"]) == len(outside) == 12
    assert [entry.number for entry in listed] == list(range(1, len(listed) + 1))
    riser = by_key(listed)["rule/us-ibc-2021/riser/flight 1/step 5"]
    assert (riser.where, riser.steps, riser.severity, riser.state) == ("step 5", (5,), "major", "open")
    assert riser.text.startswith("riser height 192.9 ± 0.2 mm: outside (")
    close = by_key(listed)["rule/us-ibc-2021/riser/flight 1/step 2"]
    assert close.severity == "minor"
    # Whichever steps make the range of a flight: it is one finding of the flight.
    assert by_key(listed)["rule/us-ibc-2021/riser-uniformity/flight 1"].steps == (5,)


def test_missing_values_are_one_row_for_each_rule_and_flight():
    inspection = staircase(missing_rise=(2, 3))
    listed = list_findings(inspection, check(inspection, find_rule_set("us-irc-2018")), NOTHING)
    missing = by_key(listed)["rule/us-irc-2018/riser/flight 1/not judged"]
    assert (missing.where, missing.severity, missing.steps) == ("steps 2, 3", "minor", (2, 3))
    assert missing.text.startswith("riser height: not measured (R311.7.5.1)")


def test_what_is_said_of_a_rule_of_the_longest_name_is_kept_for_its_step_alone():
    _, inspection = scanned()
    known = find_rule_set("us-ibc-2021")
    rules = tuple(dataclasses.replace(rule, rule_id=rule.rule_id.ljust(80, "x")) for rule in known.rules)
    found = check(inspection, dataclasses.replace(known, set_id="s" * 80, rules=rules))
    keys = [entry.key for entry in list_findings(inspection, found, NOTHING)]
    assert len(set(keys)) == len(keys)
    assert max(map(len, keys)) > 180
    said = NOTHING.with_decision(FindingDecision(max(keys, key=len), is_done=True))
    assert sum(entry.is_done for entry in list_findings(inspection, found, said)) == 1


def test_doubts_and_notes_that_matter_are_rows_and_each_has_a_key_of_its_own():
    inspection = dataclasses.replace(
        staircase(),
        examination=(Observation("surfaces_doubled", "doubt", "surfaces are double"), Observation("x", "info", "x")),
        notes=(
            Note("step_blurred", "survey", "step 2 is blurred", 2),
            Note("step_blurred", "survey", "step 2 is blurred again", 2),
            Note("unit_guessed", "read", "routine"),
            Note("surfaces_doubled", "examine", "said once is enough"),
        ),
    )
    listed = list_findings(inspection, None, NOTHING)
    assert [entry.key for entry in listed] == [
        "examination/surfaces_doubled",
        "note/step_blurred/step 2",
        "note/step_blurred/step 2 #2",
    ]
    assert steps_marked(listed) == {2: (2, 3)}


def test_what_was_said_of_a_finding_survives_another_run_and_one_that_is_gone_is_said_to_be():
    inspection = staircase()
    noted = dataclasses.replace(inspection, notes=(Note("step_blurred", "survey", "step 2 is blurred", 2),))
    key = "note/step_blurred/step 2"
    said = NOTHING.with_decision(
        FindingDecision(key, "step 2", "step 2 is blurred", "critical", True, "seen on site", "J. Alder", WHEN)
    )
    (entry,) = list_findings(noted, None, said)
    assert (entry.severity, entry.state, entry.remark, entry.who) == ("critical", "done", "seen on site", "J. Alder")
    (gone,) = list_findings(inspection, None, said)
    assert (gone.key, gone.kind, gone.where, gone.remark) == (key, "gone", "step 2", "seen on site")
    assert "no longer found" in gone.text
    assert "step 2 is blurred" in gone.text
    silent = NOTHING.with_decision(FindingDecision(key, is_done=True))
    assert list_findings(inspection, None, silent) == ()
    assert list_findings(noted, None, silent)[0].is_done


def test_a_pin_keeps_its_step_when_numbers_change():
    inspection = staircase()
    pin = Pin(GUID, "crack", "minor", middle_of(inspection, inspection.steps[2]), step=3)
    (entry,) = list_findings(inspection, None, PinnedFindings((pin,)))
    assert (entry.where, entry.steps, entry.is_pin) == ("step 3", (3,), True)
    renumbered = dataclasses.replace(
        inspection, steps=tuple(dataclasses.replace(step, step_id=step.step_id + 1) for step in inspection.steps)
    )
    (entry,) = list_findings(renumbered, None, PinnedFindings((pin,)))
    assert (entry.where, entry.steps) == ("step 4", (4,))
    lost = dataclasses.replace(inspection, steps=inspection.steps[:2])
    (entry,) = list_findings(lost, None, PinnedFindings((pin,)))
    assert (entry.where, entry.steps) == ("former step 3", ())
    (entry,) = list_findings(None, None, PinnedFindings((pin,)))
    assert entry.where == "step 3"


def test_points_and_what_is_done_mark_no_step():
    inspection = staircase()
    at = middle_of(inspection, inspection.steps[0])
    on_step = Pin(guid(1), "a", "minor", at, step=1)
    pinned = PinnedFindings((on_step, Pin(guid(2), "b", "minor", at), Pin(guid(3), "c", "minor", at, 1, is_done=True)))
    assert steps_marked(list_findings(inspection, None, pinned)) == {1: (1,)}


def test_the_report_has_the_list_with_photographs_and_the_workbook_a_sheet():
    hostile = dataclasses.replace(PIN, text="=SUM(A1) <script>alert(1)</script>")
    _, inspection = scanned()
    made = build_document(inspection, checked(), ReportBasis(), MADE_AT, pinned=PinnedFindings((hostile,)))
    titles = [section.title for section in made.sections]
    assert titles[:2] == ["Summary", "Findings"]
    blocks = made.sections[1].blocks
    assert [block.share for block in blocks if isinstance(block, Figure)] == [0.25]
    page = page_of(made)
    assert "<script>alert(1)</script>" in page.text
    assert "script" not in page.tags
    sheet = workbook(made)["List of findings"]
    rows = list(sheet.values)
    assert rows[1][1] == "pin"
    assert rows[1][3] == hostile.text
    assert rows[1][6:] == ("J. Alder", "2026-11-30 09:30")
    assert rows[2][6] == "program"
    assert len(rows) == 1 + 1 + len(list_findings(inspection, checked(), NOTHING))


def test_without_a_finding_there_is_no_section():
    assert finding_blocks(()) == []
    assert listed_table(()).rows == ()


def test_a_record_says_everything_but_the_picture():
    inspection = staircase()
    (entry,) = list_findings(inspection, None, PinnedFindings((PIN,)))
    record = listed_record(entry)
    assert (record["key"], record["kind"], record["state"]) == (GUID, "pin", "done")
    assert (record["place_m"], record["when"], record["has_photo"]) == ([1.0, -2.5, 0.34], WHEN, True)


@pytest.mark.parametrize(("moment", "words"), [("", ""), (WHEN, "2026-11-30 09:30")])
def test_a_time_is_shown_to_the_minute(moment, words):
    assert moment_words(moment) == words
