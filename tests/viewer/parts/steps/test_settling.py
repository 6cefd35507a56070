"""Values that hang on the settings are marked on the page once a result has stood, and not those of another result."""

import dataclasses
import threading

import pytest

from stair_inspector.model import Note
from stair_inspector.params import Params
from stair_inspector.stability import CODE
from stair_inspector.viewer.compute.heavy_process import Cancelled
from stair_inspector.viewer.parts.step_table_html import table_html
from stair_inspector.viewer.parts.steps import settling
from tests.viewer.parts.tune.test_paper_edges import slide
from tests.viewer.parts_of import part_of
from tests.viewer.wire_page import await_that

WORDS = "the going of step 2 hangs on the settings: it moves by 9.0 mm, more than its u, where θ_th is 15.5 °"
NOTE = Note(CODE, "stability", WORDS, 2)


@pytest.fixture
def looked(monkeypatch):
    """What is looked into; each finds that a going hangs on the settings, as long as theta_th is the usual one."""
    seen = []

    def mark(scan, params, inspection, memo):
        seen.append(params)
        is_usual = params.horizontal.theta_deg == Params().horizontal.theta_deg
        return dataclasses.replace(inspection, notes=(*inspection.notes, NOTE)) if is_usual else inspection

    monkeypatch.setattr(settling, "mark_unsettled", mark)
    return seen


def test_a_mark_is_in_the_table_on_the_card_and_among_the_notes_and_goes_with_the_next_result(looked, page):
    session = page.session
    before = session.desk.shown
    await_that(lambda: "hangs on the settings" in part_of(session, "foot").notes.content, "nothing is marked")
    assert session.desk.shown is before
    plain = table_html(session.desk.inspection, session.desk.palette, None, "pick", "survey")
    assert "unsettled" not in plain
    table = table_html(session.desk.marked, session.desk.palette, None, "pick", "survey")
    assert table.count('data-testid="unsettled"') == 1
    assert f'title="{WORDS}"' in table
    session.desk.select(2)
    assert "hangs on the settings" in part_of(session, "steps").card.content
    assert "▲" in part_of(session, "frame").state.content
    # The list of findings and the files say it too.
    assert WORDS in [finding.text for finding in part_of(session, "findings").listed]
    report = part_of(session, "export").report.maker._order().inspection
    assert NOTE in report.notes
    # Pictures are taken of what is shown, and of nothing else.
    assert part_of(session, "export").report.maker._order().shown is session.desk.shown
    assert NOTE in session.desk.inspection_to_send("export").notes
    slide(page, "horizontal.theta_deg", 20.0)
    assert "hangs on the settings" not in part_of(session, "foot").notes.content
    await_that(lambda: len(looked) == 2, "the next result is not looked into")
    assert session.desk.unsettled == ()


def test_what_is_looked_into_is_given_up_for_the_next_result(monkeypatch, page):
    is_begun, may_go_on, ended = threading.Event(), threading.Event(), []

    def mark(scan, params, inspection, memo):
        if is_begun.is_set():
            return inspection
        is_begun.set()
        assert may_go_on.wait(60.0)
        try:
            memo.run("flights", lambda: None)
        except Cancelled:
            ended.append("cancelled")
            raise
        ended.append("went on")
        return inspection

    monkeypatch.setattr(settling, "mark_unsettled", mark)
    await_that(is_begun.is_set, "nothing is looked into")
    slide(page, "levels.eps_m", 21.0)
    may_go_on.set()
    await_that(lambda: ended, "it does not end")
    assert ended == ["cancelled"]


@pytest.mark.slow
def test_what_was_given_up_for_a_run_that_came_to_nothing_is_looked_into_again(looked, page):
    session = page.session
    # As while a run goes on that is cancelled in the end.
    busy = iter([True, True])
    part_of(session, "steps").settling._is_busy = lambda: next(busy, False)
    part_of(session, "steps").settling.renew()
    await_that(lambda: "hangs on the settings" in part_of(session, "foot").notes.content, "nothing is marked")
    assert next(busy, None) is None
