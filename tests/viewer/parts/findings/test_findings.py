"""Pins and remarks on the page of a running server, without a browser: set, changed, undone, drawn, refused."""

import io
from datetime import datetime
from types import SimpleNamespace

import numpy as np
import pytest
from PIL import Image

from stair_inspector.content.finding_list import list_findings
from stair_inspector.content.pins import FindingDecision, PinnedFindings
from stair_inspector.errors import ConfigError
from stair_inspector.files.chosen_rules import ChosenRules
from stair_inspector.model import Note
from stair_inspector.viewer.bridge.markup import list_key
from stair_inspector.viewer.parts.findings.list_html import findings_html, keys_of
from stair_inspector.viewer.parts.findings.marks import marks_in_scene
from stair_inspector.viewer.state.change import PageChange
from tests.content.staircases import staircase
from tests.content.test_pins import GUID, PIN, guid
from tests.viewer.parts.test_html import Page
from tests.viewer.parts_of import part_of
from tests.viewer.wire_page import OTHER

HOSTILE = "<img src=x onerror=alert(1)>\"'"


@pytest.fixture
def tab(session):
    return part_of(session, "findings")


def set_pin(session, words="a crack", severity="major", step=2):
    tab = part_of(session, "findings")
    session.desk.select(step)
    tab.form.words.value, tab.form.severity.value, tab.form.who.value = words, severity, "J. Alder"
    tab.form.submit()
    return session.editor.work.findings.pins[-1]


def order(tab, word, number):
    return f"{word} {list_key(keys_of(tab.listed))} {number}:"


def click(session, row):
    """Shift-click a displayed point from straight above."""
    stage, display = session.desk.stage, session.desk.shown.display
    x, y, z = stage.rotation @ display.points[row]
    event = SimpleNamespace(ray_origin=(x, y, z + 0.05), ray_direction=(0.0, 0.0, -1.0))
    part_of(session, "look").measure._on_click(event)


def picture(size=(40, 30), kind="PNG"):
    stream = io.BytesIO()
    Image.new("RGB", size, (90, 20, 20)).save(stream, kind)
    return SimpleNamespace(name="crack.png", content=stream.getvalue())


def test_a_pin_on_the_chosen_step_is_set_marked_done_and_undone(session, tab):
    pin = set_pin(session)
    assert (pin.text, pin.severity, pin.step, pin.who, pin.is_done) == ("a crack", "major", 2, "J. Alder", False)
    assert abs((datetime.now().astimezone() - datetime.fromisoformat(pin.made_at)).total_seconds()) < 60.0
    step = session.desk.inspection.steps[1]
    assert pin.place_m == pytest.approx(step.plane.centroid + session.desk.shown.scan.origin_m)
    assert tab.form.words.value == ""
    assert "a crack" in tab.list.content
    tab.obey(order(tab, "done", 1))
    assert session.editor.work.findings.pins[0].is_done
    assert "a crack" not in tab.list.content
    tab.set_filter("All")
    assert "a crack" in tab.list.content
    session.editor.undo()
    assert not session.editor.work.findings.pins[0].is_done
    tab.obey(order(tab, "delete", 1))
    assert session.editor.work.findings.pins == ()
    session.editor.undo()
    assert session.editor.work.findings.pins == (pin,)


def test_a_pin_on_a_picked_point_is_looked_at(session, tab):
    session.desk.select(None)
    tab.form.words.value = "loose"
    with pytest.raises(ConfigError, match="pin: choose a step or pick a point first"):
        tab.form.submit()
    tab.start_pin()
    click(session, 10)
    assert session.desk.point_taker is None
    tab.form.submit()
    (pin,) = session.editor.work.findings.pins
    origin = session.desk.shown.scan.origin_m
    assert pin.place_m == pytest.approx(session.desk.shown.display.points[10] + origin, abs=1e-6)
    assert pin.step is None
    tab.obey(order(tab, "show", 1))
    looked_at = part_of(session, "look")._look.gone_to[0].look_at
    assert looked_at == pytest.approx(session.desk.stage.rotation @ (np.array(pin.place_m) - origin), abs=1e-6)
    tab.form.words.value, tab.form.severity.value = "very loose", "critical"
    tab.form.submit()
    (changed,) = session.editor.work.findings.pins
    assert (changed.guid, changed.text, changed.severity) == (pin.guid, "very loose", "critical")
    assert tab.put_away()
    assert tab.chosen() is None


def test_escape_gives_the_point_up_and_so_does_another_scan(page, session, tab):
    tab.start_pin()
    assert tab.put_away()
    assert session.desk.point_taker is None
    tab.start_pin()
    click(session, 10)
    assert "(" in tab.form._place_words()
    part_of(session, "scan").choose(OTHER)
    page.await_result(OTHER)
    assert tab.form._place_words() == "no place yet"


def test_correcting_up_takes_no_point_from_a_pin_that_waits_for_one(session, tab):
    upright = part_of(session, "scan").upright
    tab.start_pin()
    upright.stop()
    click(session, 10)
    assert "(" in tab.form._place_words()
    upright.start("Pick 3 floor points")
    tab.form.stop_picking()
    assert session.desk.point_taker == upright._take


def test_a_photograph_goes_with_the_new_pin_or_with_the_chosen_one(session, tab):
    tab.form.take_photo(picture())
    pin = set_pin(session)
    assert pin.photo is not None
    assert set_pin(session, "another").photo is None
    tab.obey(order(tab, "show", 2))
    tab.form.take_photo(picture(kind="JPEG"))
    assert session.editor.work.findings.pins[1].photo is not None
    with pytest.raises(ConfigError, match=r"photograph 'crack\.png': is not a PNG or JPEG"):
        tab.form.take_photo(SimpleNamespace(name="crack.png", content=b"<svg/>"))


def test_what_is_said_of_a_finding_of_the_program_outlasts_the_next_run(page, session, tab):
    session.editor.change("rules", rules=ChosenRules(set_id="kr-15-elementary"))
    entry = next(each for each in tab.listed if each.kind == "limit")
    tab.obey(order(tab, "show", entry.number))
    assert session.desk.selected == entry.steps[0]
    tab.form.words.value = "agreed with the owner"
    tab.form.submit()
    (decision,) = session.editor.work.findings.decisions
    assert (decision.key, decision.remark, decision.severity) == (entry.key, "agreed with the owner", None)
    with pytest.raises(ConfigError, match="photograph: goes with a pin"):
        tab.form.take_photo(picture())
    session.editor.adjust(lambda params: params.replaced("levels.eps_m", 0.021))
    page.await_result()
    again = next(each for each in tab.listed if each.key == entry.key)
    assert again.remark == "agreed with the owner"
    session.editor.change("no rules", rules=ChosenRules())
    (gone,) = [each for each in tab.listed if each.kind == "gone"]
    assert gone.remark == "agreed with the owner"
    tab.obey(order(tab, "delete", gone.number))
    assert session.editor.work.findings.decisions == ()


def test_the_keys_go_from_one_open_finding_to_the_next(session, tab):
    if not tab.listed:
        with pytest.raises(ConfigError, match="next open finding: there is none"):
            tab.next_open()
    set_pin(session, "first", step=1)
    set_pin(session, "second", step=3)
    tab.next_open()
    assert (tab.chosen().text, session.desk.selected) == ("first", 1)
    tab.next_open()
    assert (tab.chosen().text, session.desk.selected) == ("second", 3)


@pytest.mark.parametrize(
    ("words", "said"),
    [("", "is empty; write what was found"), ("x" * 1001, "1,001 characters"), ("a\x07b", "holds a control character")],
)
def test_a_text_that_cannot_be_kept_is_a_sentence(session, tab, words, said):
    session.desk.select(1)
    tab.form.words.value = words
    with pytest.raises(ConfigError, match=said):
        tab.form.submit()
    assert session.editor.work.findings.pins == ()


@pytest.mark.parametrize("message", ["show 1 1", "done 5", "<b>", "delete 0 0:", "drop 1 1:"])
def test_an_order_of_another_list_is_a_sentence(session, tab, message):
    set_pin(session)
    with pytest.raises(ConfigError):
        tab.obey(message)
    assert len(session.editor.work.findings.pins) == 1


def test_a_row_pressed_while_the_list_grows_is_the_same_finding(session, tab):
    set_pin(session)
    pressed = order(tab, "delete", 1)
    with session.desk.lock:
        session.desk.unsettled = (Note("unsettled", "stability", "the going of step 2 hangs on the settings", 2),)
        session.desk.changed(PageChange.SETTLED)
    assert pressed != order(tab, "delete", 1)
    tab.obey(pressed)
    assert session.editor.work.findings.pins == ()
    # The row has gone with its first press, and the next one is not taken for it.
    before = keys_of(tab.listed)
    with pytest.raises(ConfigError, match="the list has changed since"):
        tab.obey(pressed)
    assert keys_of(tab.listed) == before


def test_marks_stand_at_pins_and_at_steps_and_can_be_hidden(session, tab):
    set_pin(session)
    stage = session.desk.stage
    assert stage._nodes.labels_in("/stair/findings/labels")[0].text.startswith("⚑ 1")
    assert "/stair/findings/points" in stage._nodes
    stage.lend("Segmented")
    assert not stage._nodes["/stair/findings"].visible
    stage.lend(None)
    assert stage._nodes["/stair/findings"].visible
    tab._marks.value = False
    tab.set_marks(False)
    assert "/stair/findings/points" not in stage._nodes
    assert stage._nodes.labels_in("/stair/findings/labels") == []


def test_the_marks_of_a_list():
    inspection = staircase()
    done = PinnedFindings((PIN,))
    points, labels = marks_in_scene(list_findings(inspection, None, done), inspection)
    assert points == pytest.approx(np.array([PIN.place_m]))
    assert [words for _, words, _, _ in labels] == ["✓ 1"]


def test_every_text_of_the_list_is_escaped():
    inspection = staircase()
    pins = PinnedFindings(
        (type(PIN)(guid(1), HOSTILE, "minor", (0.0, 0.0, 0.0), who=HOSTILE),),
        (FindingDecision("note/a/scan", HOSTILE, HOSTILE, remark=HOSTILE),),
    )
    listed = list_findings(inspection, None, pins)
    html = findings_html(listed, GUID, "uuid", with_done=True, said_of=frozenset({"note/a/scan"}))
    page = Page(html)
    assert page.of("img") == []
    assert page.words.count(HOSTILE) == 4
