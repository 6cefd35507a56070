"""A second scan is compared with the one that is open, told of in sentences, kept with the work, and ended."""

import dataclasses
import hashlib
import json
import shutil

import pytest

from stair_inspector import pipeline
from stair_inspector.errors import ConfigError
from stair_inspector.files.ply import ply_bytes
from stair_inspector.files.projects import SecondScan
from stair_inspector.model import Observation
from stair_inspector.params import Params
from stair_inspector.viewer.app import App
from stair_inspector.viewer.parts.second import comparing
from stair_inspector.viewer.parts.second.part import NO_SCAN
from tests.comparison.epochs import LAST, SETTLED, points_of
from tests.viewer.parts_of import part_of
from tests.viewer.wire_page import STAIR, WirePage, await_that

EARLIER, LATER, COPY = "earlier.ply", "later.ply", "copy.ply"
SPACING_M = 0.02


@pytest.fixture(scope="module")
def folder(tmp_path_factory, two_stairs):
    folder = tmp_path_factory.mktemp("epochs")
    for name, seed, is_changed in ((EARLIER, 1, False), (LATER, 51, True)):
        points, _ = points_of(seed, is_changed, is_moved=False, spacing=SPACING_M)
        (folder / name).write_bytes(ply_bytes(points))
    shutil.copy(folder / EARLIER, folder / COPY)
    shutil.copy(two_stairs / STAIR, folder / STAIR)
    return folder


@pytest.fixture(scope="module")
def app(folder):
    scans = [folder / name for name in (EARLIER, LATER, COPY, STAIR)]
    app = App(scans, Params(up="z", unit="m"), port=0, saves_projects=False)
    yield app
    app.stop()


@pytest.fixture
def page(app):
    page = WirePage(app)
    page.await_result(EARLIER)
    yield page
    page.close()


@pytest.fixture
def part(page):
    return part_of(page.session, "second")


def compared(page, unlike=None):
    """Wait until what changed is known of the result that is shown, and return it."""
    desk = page.session.desk

    def is_there():
        # All of it is shown while the desk is held.
        with desk.lock:
            return desk.compared not in (None, unlike)

    await_that(is_there, f"nothing is compared: {desk.uncompared} {page.told()}")
    return desk.compared


def compare_later(page, part):
    part.set_side("Later")
    part.choose(LATER)
    return compared(page)


def error(page, part):
    """Wait for the sentence that says why there is no comparison, and return it."""
    await_that(lambda: 'data-state="error"' in part.state.content, f"no error is told: {part.state.content}")
    return part.state.content


def second_of(folder, name=LATER, **changes):
    path = folder / name
    second = SecondScan(str(path.absolute()), hashlib.sha256(path.read_bytes()).hexdigest(), is_earlier=False)
    return dataclasses.replace(second, **changes)


def test_a_scan_of_the_list_is_compared_coloured_and_remembered(page, part, folder):
    found = compare_later(page, part)
    assert found.is_earlier
    assert (found.found.before.name, found.found.after.name) == (EARLIER, LATER)
    assert page.session.editor.work.second == second_of(folder)
    assert page.session.keeper.project().second == second_of(folder)
    assert page.session.look.color_mode == "Change"
    assert page.session.look.legend.title.startswith("later surface against the earlier one [mm]")
    words = part.words.content
    assert f"steps {SETTLED} to {LAST} lie " in words
    assert "Laid onto each other on the floor and step" in words
    assert part.table.content.count('data-testid="change-row"') == len(found.found.steps)
    assert "Choose a step" in part.map.content
    page.session.desk.select(SETTLED)
    assert f'data-testid="change-map" data-step="{SETTLED}"' in part.map.content
    part.set_maps("All steps")
    assert part.map.content.count("<img") == len(found.found.steps)
    # The chosen tread keeps its colours.
    assert "/stair/segments/selected" not in page.session.desk.stage._nodes


def test_ending_takes_everything_away_and_undo_brings_it_back(page, part):
    found = compare_later(page, part)
    part.end_comparison()
    desk = page.session.desk
    assert (desk.compared, desk.uncompared, page.session.editor.work.second) == (None, "", None)
    assert page.session.look.color_mode == "Step"
    assert part.words.content == part.table.content == part.map.content == ""
    assert part.scan.value == NO_SCAN
    page.session.editor.undo()
    assert compared(page).found.steps[0].height.change == found.found.steps[0].height.change


@pytest.mark.slow
def test_the_other_way_round_the_signs_change(page, part):
    forth = compare_later(page, part)
    part.set_side("Earlier")
    back = compared(page, unlike=forth)
    assert not back.is_earlier
    one, two = ({step.before_id: step for step in each.found.steps} for each in (forth, back))
    assert one[SETTLED].height.change.value == pytest.approx(-two[SETTLED].height.change.value, abs=0.0002)
    assert page.session.editor.work.second.is_earlier


def test_another_result_is_compared_once_more(page, part):
    before = compare_later(page, part)
    page.session.editor.adjust(lambda params: params.replaced("uncertainty.registration_m", 0.001))
    shown = page.await_result(EARLIER)
    after = compared(page, unlike=before)
    assert after.found.before is shown.inspection.scan or after.found.before.sha256 == shown.scan.sha256
    assert after.found.steps[0].height.change.u > before.found.steps[0].height.change.u


def test_another_stair_is_a_sentence_and_the_report_waits_for_an_answer(page, part):
    part.choose(STAIR)
    assert "fit each other in two ways, a step apart" in error(page, part)
    assert part.again.visible
    with pytest.raises(ConfigError, match=r"report: there is no comparison with stair.ply; see why under Compare"):
        part_of(page.session, "export").report.maker.make("PDF")
    part.end_comparison()
    assert page.session.desk.comparison("report") is None
    assert 'data-state="ready"' in part.state.content


def test_the_scan_that_is_open_is_refused(page, part):
    part.choose(COPY)
    assert f"{COPY}: is the scan that is open; choose another scan of the same stair" in error(page, part)
    assert page.session.editor.work.second is None


def test_a_question_that_a_scan_asks_is_to_be_answered_first(page, part, monkeypatch):
    question = Observation("unit_unsure", "question", "inches or centimetres", None, "--unit in")
    inspect = comparing.inspect
    monkeypatch.setattr(
        comparing, "inspect", lambda *args: dataclasses.replace(inspect(*args), examination=(question,))
    )
    part.choose(LATER)
    assert (
        f"{LATER}: cannot be compared before this is answered: inches or centimetres; open it by itself, answer it"
        in error(page, part)
    )


@pytest.mark.parametrize("option", ["", "nothing.ply", EARLIER, "../later.ply"])
def test_what_is_no_other_scan_of_the_list_is_refused(part, option):
    with pytest.raises(ConfigError, match="second scan"):
        part.choose(option)


def test_a_missing_second_scan_is_a_sentence(page, part, folder):
    second = SecondScan("/nowhere/gone.ply", "0" * 64, is_earlier=True)
    page.session.editor.change("a project", second=second)
    assert "gone.ply: this second scan is not among the scans of this server; " in error(page, part)
    await_that(lambda: any("gone.ply" in words for words in page.told()), "it is not told")
    assert part.scan.value == "gone.ply"
    # That of the same name is taken wherever it lies now.
    page.session.editor.change("moved", second=second_of(folder, file=f"/elsewhere/{LATER}"))
    assert compared(page).found.after.name == LATER


def test_a_changed_second_scan_is_a_sentence_and_is_compared_anew_when_asked(page, part, folder):
    page.session.editor.change("a project", second=second_of(folder, sha256="1" * 64))
    assert f"{LATER}: has changed since it was chosen as the second scan; compare anew " in error(page, part)
    assert page.session.desk.compared is None
    part.set_side("Later")
    part.compare_anew()
    compared(page)
    assert page.session.editor.work.second == second_of(folder)
    assert 'data-state="ready"' in part.state.content


def test_a_second_scan_belongs_to_the_scan_that_it_was_chosen_for(page, part):
    compare_later(page, part)
    scans = part_of(page.session, "scan")
    scans.choose(LATER)
    page.await_result(LATER)
    assert page.session.editor.work.second is None
    assert page.session.desk.compared is None
    assert page.session.look.color_mode == "Step"
    scans.choose(EARLIER)
    page.await_result(EARLIER)
    assert compared(page).found.after.name == LATER


def test_the_second_scan_keeps_what_was_said_of_it_by_itself(page, part, monkeypatch):
    used = []
    monkeypatch.setattr(comparing, "inspect", lambda *args: (used.append(args[1]), pipeline.inspect(*args))[1])
    scans, editor = part_of(page.session, "scan"), page.session.editor
    scans.choose(LATER)
    page.await_result(LATER)
    editor.adjust(lambda params: params.replaced("up", "0,0,1"))
    scans.choose(EARLIER)
    editor.adjust(lambda params: params.replaced("levels.eps_m", 0.021))
    page.await_result(EARLIER)
    compare_later(page, part)
    (params,) = used
    assert (params.up, params.levels.eps_m) == ("0,0,1", 0.021)
    assert editor.work.params.up == "z"


@pytest.mark.slow
def test_a_page_that_comes_back_compares_again(app, page, part):
    compare_later(page, part)
    storage = page.storage
    page.close()
    await_that(lambda: page.session not in app._sessions.values(), "the page is still open")
    again = WirePage(app, storage)
    try:
        again.await_result(EARLIER)
        assert compared(again).found.after.name == LATER
    finally:
        again.close()


def test_ending_while_it_is_compared_leaves_nothing_behind(page, part, monkeypatch):
    ended = []

    def end_first(*args):
        ended.append(part.end_comparison())
        return pipeline.inspect(*args)

    monkeypatch.setattr(comparing, "inspect", end_first)
    part.choose(LATER)
    await_that(lambda: ended and not part._doing, "it is still being compared")
    assert 'data-state="ready"' in part.state.content
    assert (page.session.desk.compared, page.session.desk.uncompared) == (None, "")
    assert page.session.look.color_mode == "Step"
    assert not part.end.visible


@pytest.mark.slow
def test_cancelling_is_told_and_nothing_is_compared(page, part, monkeypatch):
    def cancelled(*_):
        part.cancel()
        return inspect(*_)

    inspect = comparing.inspect
    monkeypatch.setattr(comparing, "inspect", cancelled)
    part.set_side("Later")
    part.choose(LATER)
    assert "cancelled; compare anew, or end the comparison" in error(page, part)
    assert page.session.desk.compared is None
    monkeypatch.undo()
    part.compare_anew()
    compared(page)


def test_the_files_of_the_page_hold_the_comparison(page, part, monkeypatch):
    sent = {}
    compare_later(page, part)
    monkeypatch.setattr(
        type(page.session.desk.client),
        "send_file_download",
        lambda _, name, data, **__: sent.update({name: data}),
    )
    part_of(page.session, "export").downloads.download("JSON")
    document = json.loads(sent["earlier.json"])
    assert document["comparison"]["after"]["file"] == LATER
    maker = part_of(page.session, "export").report.maker
    maker._from_scene.value = False
    maker.make("HTML")
    assert "Changes between two scans" in sent["earlier_report.html"].decode()


def test_a_second_scan_of_the_name_of_the_one_that_is_open_is_another_file(page, part):
    second = SecondScan(f"/elsewhere/{EARLIER}", "0" * 64, is_earlier=True)
    page.session.editor.change("a project", second=second)
    assert f"{EARLIER}: this second scan is not among the scans of this server; " in error(page, part)


def test_a_project_that_compares_a_scan_with_itself_is_refused(page, part, folder):
    page.session.editor.change("a project", second=second_of(folder, EARLIER))
    assert f"{EARLIER}: is the scan that is open; choose another scan of the same stair" in error(page, part)


@pytest.mark.parametrize(
    ("name", "shown"),
    [(NO_SCAN, NO_SCAN), ("a\udcff.ply", "a\\udcff.ply"), ("x" * 3000, "x" * 200 + "..."), ("<b>.ply", "<b>.ply")],
)
def test_whatever_a_project_calls_its_second_scan_the_page_can_show(page, part, name, shown):
    page.session.editor.change("a project", second=SecondScan(f"/nowhere/{name}", "0" * 64, is_earlier=True))
    assert "this second scan is not among the scans" in error(page, part)
    assert part.scan.value == shown
    assert len(set(part.scan.options)) == len(part.scan.options)
    assert "<b>" not in part.state.content
    part.end_comparison()
    assert part.scan.value == NO_SCAN
