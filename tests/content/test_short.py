"""The short report: chosen from the full one, in few pages, without what nobody has filled in."""

import dataclasses

import pytest

from stair_inspector.codes import check
from stair_inspector.content.document import Facts, Figure, Signatures
from stair_inspector.content.fields import ReportBasis, ReportFields
from stair_inspector.content.order import build_document
from stair_inspector.content.pins import FindingDecision, PinnedFindings
from stair_inspector.content.short import shortened
from stair_inspector.files.rule_sets import find_rule_set
from stair_inspector.model import Note, Observation
from stair_inspector.stages.withhold import withhold
from stair_inspector.writers.pdf import pdf_bytes
from tests.content.test_pins import PIN
from tests.writers.samples import BASIS, MADE_AT, checked, document, pdf_pages, plain_document, scanned


def columns_of(table):
    return {column.title: [row[number] for row in table.rows] for number, column in enumerate(table.columns)}


@pytest.mark.parametrize("name", ["straight", "defective_step"])
def test_all_that_it_says_stands_in_the_full_report(name):
    full = document(name)
    short = shortened(full)
    tables = {table.key: table for table in full.tables()}
    assert short.tables()
    for table in short.tables():
        known = columns_of(tables[table.key])
        for title, cells in columns_of(table).items():
            assert set(map(str, cells)) <= set(map(str, known[title])), (table.key, title)
        assert table.rows or table.key == "findings"
    figures = {figure.key: figure.data for figure in full.figures()}
    assert {figure.key: figures[figure.key] for figure in short.figures()} == {
        figure.key: figure.data for figure in short.figures()
    }


def test_the_first_page_has_every_judged_rule_and_the_next_two_the_evidence():
    full = dataclasses.replace(document("defective_step"))
    pages = pdf_pages(pdf_bytes(shortened(full)))
    assert len(pages) == 4
    found = checked()
    (rules,) = [table for table in full.tables() if table.key == "rules"]
    judged = [row for row in rules.rows if "outside" in str(row[-1]) or "within" in str(row[-1])]
    assert len(judged) == 7
    for row in judged:
        assert str(row[0]) in pages[0]
    assert found.is_outside
    assert "values outside limits" in pages[0]
    assert "Dimensions of the steps" in pages[1]
    for step in scanned()[1].steps:
        assert f"{1000.0 * step.rise_m.value:.1f}" in pages[1]
    assert "not plainly within" in pages[2]
    assert "Signature" in pages[3]


def test_a_report_without_readings_is_three_pages():
    inspection = scanned("straight")[1]
    assert len(pdf_pages(pdf_bytes(shortened(plain_document(inspection, checked("straight")))))) == 3


def test_forms_that_nobody_has_filled_take_no_room():
    inspection, found = scanned("straight")[1], checked("straight")
    bare = shortened(plain_document(inspection, found))
    assert {block.key for block in bare.blocks() if isinstance(block, Facts)} == {"scan", "rule_set"}
    assert [table.key for table in bare.tables() if table.key in ("readings", "checklist")] == []
    (signed,) = [block for block in bare.blocks() if isinstance(block, Signatures)]
    assert [role for role, _ in signed.items] == ["Inspector"]
    filled = ReportBasis(fields=ReportFields(reviewed_by="P. Moss", instrument_model="RTC"), readings=BASIS.readings)
    short = shortened(plain_document(inspection, found, filled))
    (signed,) = [block for block in short.blocks() if isinstance(block, Signatures)]
    assert [role for role, _ in signed.items] == ["Inspector", "Reviewer"]
    assert "readings" in {table.key for table in short.tables()}
    assert ("Model", "RTC") in [
        (label.split()[-1].capitalize(), value)
        for block in short.blocks()
        if isinstance(block, Facts) and block.key == "instrument"
        for label, value in block.items
    ]


def test_what_the_inspector_said_of_a_finding_stands_in_it_with_and_without_a_name():
    inspection = dataclasses.replace(scanned("straight")[1], notes=(Note("step_blurred", "survey", "is blurred", 2),))
    pin = dataclasses.replace(PIN, who="program", photo=None)
    for who, by in (("", "inspector"), ("J. Alder", "J. Alder")):
        said = FindingDecision("note/step_blurred/step 2", remark="seen on site", who=who)
        for decisions, expected in (((said,), ["program", by]), ((), ["program"])):
            pinned = PinnedFindings((pin,), decisions)
            full = build_document(inspection, None, ReportBasis(), MADE_AT, pinned=pinned)
            (listed,) = [table for table in shortened(full).tables() if table.key == "list_of_findings"]
            assert columns_of(listed)["By"] == expected


def test_a_scan_without_a_check_or_a_staircase_has_a_short_report_too():
    inspection = scanned("straight")[1]
    unchecked = shortened(plain_document(inspection))
    assert {"flights", "steps", "scan"} <= {getattr(block, "key", "") for block in unchecked.blocks()}
    empty = dataclasses.replace(inspection, steps=(), flights=(), patches=())
    short = shortened(plain_document(empty))
    assert not [table for table in short.tables() if not table.rows]
    assert not [block for block in short.blocks() if isinstance(block, Figure)]
    assert short.sections[-1].title == "Sign-off"
    assert short.made_at == MADE_AT


def rules_of(report):
    """The results by rule: the heads of the columns, and of each row its flight, where it has one, and its verdict."""
    (table,) = [table for table in report.tables() if table.key == "rules"]
    return [column.name for column in table.columns], [str(row[-1].words) for row in table.rows]


def test_what_could_not_be_judged_is_told_and_why():
    inspection = scanned("straight")[1]
    bare = dataclasses.replace(
        inspection, steps=tuple(dataclasses.replace(step, rise_m=None) for step in inspection.steps)
    )
    full = plain_document(bare, check(bare, find_rule_set("us-ibc-2021")))
    verdicts = rules_of(shortened(full))[1]
    assert verdicts == [words for words in rules_of(full)[1] if words not in ("reported", "not assessed")]
    assert "not measured" in verdicts
    asked = Observation("unit_unsure", "question", "two units fit", None, "give --unit")
    held = withhold(dataclasses.replace(inspection, examination=(asked,)))
    short = shortened(plain_document(held, check(held, find_rule_set("us-ibc-2021"))))
    (findings,) = [table for table in short.tables() if table.key == "findings"]
    assert "two units fit" in findings.empty
    assert not [table for table in short.tables() if table.key in ("rules", "steps")]


def test_rows_of_several_flights_have_their_numbers_and_those_of_one_have_none():
    inspection = scanned("straight")[1]
    assert "Flight" not in rules_of(shortened(plain_document(inspection, checked("straight"))))[0]
    first, *others = inspection.steps
    lower = dataclasses.replace(inspection.flights[0], step_ids=tuple(step.step_id for step in inspection.steps[:5]))
    upper = dataclasses.replace(lower, flight_id=2, step_ids=tuple(step.step_id for step in inspection.steps[5:]))
    two = dataclasses.replace(
        inspection,
        flights=(lower, upper),
        steps=(first, *(dataclasses.replace(step, flight=1 if step.step_id <= 5 else 2) for step in others)),
    )
    assert "Flight" in rules_of(shortened(plain_document(two, check(two, find_rule_set("us-ibc-2021")))))[0]
