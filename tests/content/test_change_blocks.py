"""The page of a report on what changed: its words, its numbers, and where it stands."""

import dataclasses
from datetime import datetime

import pytest

from stair_inspector.content.change_blocks import CHANGES, change_blocks, what_changed
from stair_inspector.content.comparisons import alignment_facts, changes_in_numbers
from stair_inspector.content.document import Bullets, Number, Paragraph, Table
from stair_inspector.content.fields import ReportBasis
from stair_inspector.content.order import build_document
from stair_inspector.content.short import shortened
from stair_inspector.model import ComparedScan
from stair_inspector.units import u_text
from tests.comparison.epochs import LAST, SETTLED, TURNED, WORN, compared, epoch

CHANGED = {
    "Δ rise": {WORN, WORN + 1, SETTLED},
    "Δ cross-fall": {TURNED},
    "Δ height": set(range(SETTLED, LAST + 1)),
    "Δ worst place": {WORN},
    # To the next nosing, which lies lower.
    "Δ pitch": {SETTLED - 1},
}


def seen(is_earlier=True, is_changed=True):
    return ComparedScan(compared(is_changed), is_earlier)


def marked(table):
    """The steps that have a mark, by the column that it stands in."""
    found = {}
    for row in table.rows:
        for k, cell in enumerate(row):
            if isinstance(cell, Number) and cell.mark:
                assert table.columns[k].is_u
                found.setdefault(table.columns[k - 1].name, set()).add(row[0])
    return found


def test_what_changed_is_marked_and_nothing_else():
    assert marked(changes_in_numbers(seen())) == CHANGED
    assert marked(changes_in_numbers(seen(is_changed=False))) == {}


def test_a_change_is_shown_with_its_sign_and_u_in_millimetres():
    table = changes_in_numbers(seen())
    k = [column.name for column in table.columns].index("Δ height")
    row = table.rows[SETTLED - 1]
    change = compared(True).steps[SETTLED - 1].height.change
    assert row[k].value == pytest.approx(1000.0 * change.value)
    assert table.columns[k].text(row[k]).startswith("−4.0")
    assert table.columns[k + 1].text(row[k + 1]).endswith(" *")
    rise = [column.name for column in table.columns].index("Δ rise")
    assert table.columns[rise].text(table.rows[WORN][rise]).startswith("+3.")
    assert table.columns[rise].text(Number(-0.01, 1)) == ""


def test_the_alignment_says_what_it_rests_on_and_how_sure_it_is():
    items = dict(alignment_facts(seen()).items)
    assert items["Laid onto each other on"] == "the floor and steps 1 to 2 and 4"
    assert items["U of a height by that"].startswith(f"{u_text(1000.0 * compared(True).alignment.u_m)} mm at most")
    height_m = dict(compared(True).alignment.parts)["height_m"]
    assert items["Its parts, U"].startswith(f"height {u_text(1000.0 * height_m)} mm, tilt along the climb ")
    assert items["Earlier scan"].startswith("earlier.ply, SHA-256 ")


def test_steps_have_the_numbers_of_the_scan_that_the_report_is_of():
    found = compared(True)
    steps = tuple(dataclasses.replace(step, after_id=step.before_id + 1) for step in found.steps)
    shifted = ComparedScan(dataclasses.replace(found, steps=steps), is_earlier=False)
    assert [row[0] for row in changes_in_numbers(shifted).rows] == list(range(2, LAST + 2))
    assert what_changed(shifted)[0].message.startswith(f"steps {SETTLED + 1} to {LAST + 1} lie 4.0 ± ")
    assert dict(alignment_facts(shifted).items)["Laid onto each other on"] == "the floor and steps 2 to 3 and 5"


def test_the_page_says_which_scan_is_which_and_what_changed_once():
    words, bullets, table, *_ = change_blocks(seen(is_earlier=False))
    assert isinstance(words, Paragraph)
    assert words.text == (
        "earlier.ply and later.ply have 6 steps in common; the rest of this report is of later.ply, the later one."
    )
    assert isinstance(bullets, Bullets)
    assert not any("laid onto" in item for item in bullets.items)
    assert isinstance(table, Table)


@pytest.mark.parametrize("is_short", [True, False])
def test_both_reports_have_the_page_and_none_without_a_second_scan(is_short):
    _, inspection = epoch(51, True)
    for compared_scan in (seen(is_earlier=False), None):
        document = build_document(inspection, None, ReportBasis(), datetime(2026, 1, 1), compared=compared_scan)
        told = shortened(document) if is_short else document
        pages = [section for section in told.sections if section.title == CHANGES]
        assert [page.starts_page for page in pages] == ([] if compared_scan is None else [True])
