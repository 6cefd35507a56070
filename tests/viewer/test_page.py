"""What an inspector does is kept, belongs to its scan, and never overwrites another's work: without a browser."""

import dataclasses
import errno
import io
import shutil
import threading
import time
from types import SimpleNamespace

import pytest
from PIL import Image

from stair_inspector.codes import Limit, RuleEdit
from stair_inspector.content.fields import ReportBasis, ReportFields
from stair_inspector.content.images import read_logo
from stair_inspector.content.readings import TapeReading
from stair_inspector.errors import ConfigError
from stair_inspector.files import atomic
from stair_inspector.files.chosen_rules import ChosenRules, LeftEdits
from stair_inspector.files.project_files import read_project
from stair_inspector.files.projects import Measurement
from stair_inspector.files.settings import preset_bytes
from stair_inspector.params import Params
from stair_inspector.viewer.app import App
from stair_inspector.viewer.compute.runs import Request
from stair_inspector.viewer.parts.tune.presets import OWN_PRESET, STARTED_WITH
from stair_inspector.viewer.state import keeper, opening
from stair_inspector.viewer.state.library import state_of
from tests.viewer.parts_of import part_of
from tests.viewer.wire_page import WirePage, await_that

_STREAM = io.BytesIO()
Image.new("RGB", (60, 20), (10, 90, 160)).save(_STREAM, "PNG")
LOGO = read_logo(_STREAM.getvalue())
POINT = Measurement("Point 1", ((0.0, 0.0, 1.0),))


@pytest.fixture
def folder(tmp_path, two_stairs):
    for name in ("stair.ply", "other.ply"):
        shutil.copy(two_stairs / name, tmp_path / name)
    return tmp_path


@pytest.fixture
def serve(folder):
    """Start a server on the folder; pages are opened by calling the second value."""
    apps = []

    def serve(params=None, **options):
        app = App([folder / "stair.ply", folder / "other.ply"], params or Params(), port=0, **options)
        apps.append(app)
        return app

    yield serve
    for app in apps:
        app.stop()


def leave(app, page):
    """Close a page, and wait until the server has put its work away."""
    page.close()
    await_that(lambda: page.session not in app._sessions.values(), "the page is still open")
    await_that(lambda: page.session.opening._page.has_left.is_set(), "the work of the page is not put away")


def title_in(path):
    return read_project(path).title if path.exists() else None


class WatchedLock:
    """A lock that notes when it is taken while another is held that must not be."""

    def __init__(self, name, held, wrong):
        self._lock, self._name, self._held, self._wrong = threading.RLock(), name, held, wrong

    def __enter__(self):
        own = self._held.__dict__.setdefault("names", [])
        if self._name == "desk" and "keeper" in own and "desk" not in own:
            self._wrong.append(threading.current_thread().name)
        self._lock.acquire()
        own.append(self._name)

    def __exit__(self, *_):
        self._held.names.remove(self._name)
        self._lock.release()


@pytest.mark.slow
def test_the_desk_is_never_waited_for_while_the_work_is_held(serve):
    page = WirePage(serve())
    page.await_result("stair.ply")
    session = page.session
    held, wrong = threading.local(), []
    session.desk.lock = WatchedLock("desk", held, wrong)
    session.keeper.lock = WatchedLock("keeper", held, wrong)
    session.editor.adjust(lambda params: params.replaced("levels.eps_m", 0.03))
    session.editor.change("measured", measurements=(POINT,))
    session.editor.undo()
    session.editor.redo()
    session.editor.reset()
    session.editor.submit()
    part_of(session, "tune").take_reach("reach 25:1")
    part_of(session, "export").set_title("Hall")
    part_of(session, "export").report.set_paper("US Letter")
    part_of(session, "export").report.set_text("fields", "firm", "Alder")
    part_of(session, "export").report.value.value = "170"
    part_of(session, "export").report.add_reading()
    session.desk.set_unit("in")
    part_of(session, "tune").presets.take_preset(next(iter(part_of(session, "tune").presets._presets)))
    part_of(session, "tune").comparison.keep("A")
    part_of(session, "look").views.keep()
    part_of(session, "scan").region.use_tool("Around the stair")
    part_of(session, "scan").upright.start("Take the treads")
    session.desk.select(1)
    part_of(session, "steps").verdicts.mark("rejected")
    part_of(session, "steps").verdicts.clear()
    part_of(session, "scan").choose("other.ply")
    page.await_result("other.ply")
    assert wrong == []


@pytest.mark.slow
def test_nothing_is_done_to_a_scan_while_another_is_still_shown(serve, folder, two_stairs):
    (folder / "other.ply").write_bytes((two_stairs / "stair.ply").read_bytes()[:-1000])
    page = WirePage(serve())
    page.await_result("stair.ply")
    session = page.session
    session.desk.select(1)
    project = part_of(session, "export").downloads._project
    of_stair = project()
    part_of(session, "scan").choose("other.ply")
    for act in (
        lambda: part_of(session, "steps").verdicts.mark("rejected"),
        part_of(session, "look").views.keep,
        lambda: part_of(session, "tune").comparison.keep("A"),
        lambda: part_of(session, "scan").region.use_tool("Around the stair"),
        lambda: part_of(session, "scan").upright.start("Take the treads"),
        lambda: part_of(session, "export").downloads.download("CSV"),
        lambda: part_of(session, "export").open_project(SimpleNamespace(name="p.stair.json", content=of_stair)),
    ):
        with pytest.raises(ConfigError):
            act()
    assert session.editor.work.params == Params()
    await_that(lambda: "other.ply" in (session.desk.status.error or ""), "the broken file is not said")
    assert "other.ply" in part_of(session, "frame").header.content
    assert "stair.ply" not in part_of(session, "frame").header.content
    assert 'data-testid="step-row"' not in part_of(session, "docked").html.content
    assert "for these settings" not in part_of(session, "frame").state.content
    assert "dashed frame" not in part_of(session, "frame").state.content
    part_of(session, "scan").choose("stair.ply")
    assert page.await_result("stair.ply").inspection.steps


def test_another_scan_begins_with_its_own_unit_and_up(serve):
    app = serve(Params().replaced("up", "z"))
    session = WirePage(app).session
    session.editor.adjust(lambda params: params.replaced("up", "0.01,0,1").replaced("levels.eps_m", 0.03))
    session.editor.adjust(lambda params: params.replaced("unit", "mm"))
    part_of(session, "scan").choose("other.ply")
    params = session.editor.work.params
    assert (params.up, params.unit, params.levels.eps_m) == ("z", Params().unit, 0.03)


def test_a_report_begins_with_what_the_server_was_given_and_goes_on_with_the_surveyor_but_not_with_the_stair(serve):
    basis = ReportBasis(fields=ReportFields(firm="Alder & Finch", client="Northgate"), paper="us-letter")
    session = WirePage(serve(basis=basis)).session
    assert session.editor.work.basis == basis
    fields = dataclasses.replace(basis.fields, inspector="J. Alder", instrument_model="X 7", stair="C-2", client="Else")
    reading = TapeReading("rise", 0.17, step=1)
    session.editor.change("changed", basis=ReportBasis(fields=fields, readings=(reading,), logo=LOGO))
    edit = RuleEdit("riser", "maximum", Limit.of("7 3/4", "in"), Limit.of("6", "in"), "why")
    left = LeftEdits("us-irc-2021", (edit,))
    session.editor.change("changed", rules=ChosenRules("us-irc-2024", decision="simple", edits=(edit,), left=(left,)))
    part_of(session, "scan").choose("other.ply")
    other = session.editor.work
    wanted = dataclasses.replace(basis.fields, inspector="J. Alder", instrument_model="X 7")
    assert other.basis == ReportBasis(fields=wanted, logo=LOGO)
    assert other.rules == ChosenRules("us-irc-2024", decision="simple")
    part_of(session, "scan").choose("stair.ply")
    assert (session.editor.work.basis.fields, len(session.editor.work.rules.edits)) == (fields, 1)


def test_a_reload_brings_the_work_on_every_scan_back_with_its_undo(serve):
    app = serve(saves_projects=False)
    page = WirePage(app)
    page.await_result("stair.ply")
    page.session.editor.change("title", title="Hall")
    page.session.editor.adjust(lambda params: params.replaced("levels.eps_m", 0.03))
    part_of(page.session, "scan").choose("other.ply")
    page.session.editor.change("title", title="Yard")
    leave(app, page)
    page = WirePage(app, page.storage)
    session = page.session
    assert (session.keeper.label, session.editor.work.title) == ("other.ply", "Yard")
    assert session.keeper.history.undo_label == "title"
    part_of(session, "scan").choose("stair.ply")
    assert (session.editor.work.title, session.editor.work.params.levels.eps_m) == ("Hall", 0.03)
    session.editor.undo()
    session.editor.undo()
    assert session.editor.work.title == ""
    assert session.editor.work.params.levels.eps_m == Params().levels.eps_m


@pytest.mark.slow
def test_a_page_that_comes_back_leaves_alone_what_others_have_saved_meanwhile(serve, folder):
    app = serve()
    mine = WirePage(app)
    mine.await_result()
    mine.session.editor.change("title", title="mine")
    leave(app, mine)
    assert title_in(folder / "stair.stair.json") == "mine"
    theirs = WirePage(app)
    theirs.await_result()
    assert theirs.session.editor.work.title == "mine"
    theirs.session.editor.change("title", title="theirs")
    third = WirePage(app)
    third.await_result()
    third.session.editor.change("title", title="third")
    leave(app, third)
    leave(app, theirs)
    mine = WirePage(app, mine.storage)
    mine.await_result()
    assert mine.session.editor.work.title == "mine"
    mine.session.editor.change("title", title="mine again")
    mine.session.keeper.save()
    assert title_in(folder / "stair.stair.json") == "theirs"
    assert title_in(folder / "stair.2.stair.json") == "third"
    assert title_in(folder / "stair.3.stair.json") == "mine again"


@pytest.mark.slow
def test_work_that_could_not_be_saved_before_a_reload_is_saved_after_it_whatever_scan_is_open(serve, folder):
    app = serve()
    page = WirePage(app)
    page.await_result("stair.ply")
    in_the_way = folder / "stair.stair.json"
    in_the_way.mkdir()
    page.session.editor.change("title", title="Hall")
    part_of(page.session, "scan").choose("other.ply")
    page.await_result("other.ply")
    leave(app, page)
    in_the_way.rmdir()
    page = WirePage(app, page.storage)
    page.session.editor.change("title", title="Yard")
    page.session.keeper.save()
    assert (title_in(in_the_way), title_in(folder / "other.stair.json")) == ("Hall", "Yard")


@pytest.mark.slow
def test_what_is_shown_to_a_page_before_the_server_knows_that_it_has_gone_is_no_mistake(serve, folder):
    """viser warns of messages to a closed connection, and a warning fails a test."""
    app = serve()
    page = WirePage(app)
    page.await_result("stair.ply")
    desk = page.session.desk
    leave(app, page)
    desk.is_closed = desk.notices.is_closed = False
    desk.notices.tell("Not saved", "the disk is full")
    desk.set_unit("in")
    assert desk.unit == "in"


@pytest.mark.slow
def test_a_page_that_comes_back_while_its_file_is_in_use_takes_none_that_exists(serve, folder):
    app = serve()
    mine = WirePage(app)
    mine.await_result()
    mine.session.editor.change("title", title="mine")
    theirs = WirePage(app)
    theirs.await_result()
    theirs.session.editor.change("title", title="theirs")
    leave(app, mine)
    third = WirePage(app)
    third.await_result()
    assert third.session.keeper.path == folder / "stair.stair.json"
    leave(app, theirs)
    mine = WirePage(app, mine.storage)
    mine.await_result()
    mine.session.keeper.save()
    assert title_in(folder / "stair.2.stair.json") == "theirs"
    assert title_in(folder / "stair.3.stair.json") == "mine"


@pytest.mark.slow
def test_saved_work_is_held_against_the_file_even_if_another_scan_was_chosen_first(serve, folder, two_stairs):
    app = serve()
    page = WirePage(app)
    page.await_result()
    page.session.editor.change("measured", measurements=(POINT,))
    leave(app, page)
    app.stop()
    shutil.copy(two_stairs / "other.ply", folder / "stair.ply")
    app = serve()
    is_chosen, read = threading.Event(), app._workshop.read

    def read_late(path, *rest):
        assert is_chosen.wait(20.0)
        return read(path, *rest)

    app._workshop.read = read_late
    page = WirePage(app)
    session = page.session
    await_that(session.runs.is_busy, "the first scan is not being read")
    part_of(session, "scan").choose("other.ply")
    assert not session.opening.is_of("stair.ply", state_of(folder / "stair.ply"))
    is_chosen.set()
    page.await_result("other.ply")
    part_of(session, "scan").choose("stair.ply")
    page.await_result("stair.ply")
    assert session.editor.work.measurements == ()
    session.editor.change("title", title="new state")
    session.keeper.save()
    assert read_project(folder / "stair.stair.json").measurements == (POINT,)
    assert title_in(folder / "stair.2.stair.json") == "new state"
    # The next server finds the work that belongs to the file as it is now.
    app.stop()
    page = WirePage(serve())
    page.await_result("stair.ply")
    await_that(lambda: page.session.editor.work.title == "new state", "the work on this state is not back")
    assert any("stair.2.stair.json is back" in told for told in page.told())


@pytest.mark.parametrize("reloads", [pytest.param(False, marks=pytest.mark.slow), True])
def test_work_on_a_file_that_changes_is_put_aside_and_undo_brings_it_back(serve, folder, two_stairs, reloads):
    app = serve()
    page = WirePage(app)
    page.await_result()
    page.session.editor.change("all", measurements=(POINT,), title="Hall")
    if reloads:
        leave(app, page)
    else:
        page.session.keeper.save()
    shutil.copy(two_stairs / "other.ply", folder / "stair.ply")
    if reloads:
        page = WirePage(app, page.storage)
    session = page.session
    session.editor.submit()
    await_that(lambda: session.editor.work.measurements == (), "measurements of the other cloud are still there")
    await_that(lambda: any("File changed" in told for told in page.told()), "nobody is told")
    page.await_result()
    session.keeper.save()
    assert read_project(folder / "stair.stair.json").measurements == (POINT,)
    assert title_in(folder / "stair.2.stair.json") == session.editor.work.title == "Hall"
    session.editor.undo()
    assert session.editor.work.measurements == (POINT,)


def test_an_upload_is_nobody_elses_and_what_is_done_on_it_is_not_called_saved(serve, two_stairs):
    app = serve()
    mine, theirs = WirePage(app), WirePage(app)
    upload = SimpleNamespace(name="up.ply", content=(two_stairs / "other.ply").read_bytes())
    part_of(mine.session, "scan").take_upload(upload)
    mine.await_result("up.ply")
    assert mine.session.keeper.path is None
    assert "Kept until the server ends" in part_of(mine.session, "export").saved.content
    assert any("up.ply is deleted when the server ends" in told for told in mine.told())
    with pytest.raises(ConfigError, match="is none of the files"):
        part_of(theirs.session, "scan").choose("up.ply")


@pytest.mark.slow
def test_uploads_of_pages_that_have_gone_make_room(serve, two_stairs):
    app = serve()
    content = (two_stairs / "other.ply").read_bytes()
    page = WirePage(app)
    part_of(page.session, "scan").take_upload(SimpleNamespace(name="first.ply", content=content))
    path = page.session.keeper.scan
    leave(app, page)
    other = WirePage(app)
    for number in range(49):
        other.session.opening.keep_upload(SimpleNamespace(name=f"{number}.ply", content=content))
    assert path.exists()
    other.session.opening.keep_upload(SimpleNamespace(name="last.ply", content=content))
    assert not path.exists()
    with pytest.raises(ConfigError, match="50 uploaded files are open"):
        other.session.opening.keep_upload(SimpleNamespace(name="more.ply", content=content))
    # There is nothing left to come back to but the scans of the server.
    assert WirePage(app, page.storage).session.keeper.label == "stair.ply"


@pytest.mark.slow
def test_a_browser_that_is_back_before_its_old_connection_is_known_to_be_dead_goes_on(serve, folder, monkeypatch):
    monkeypatch.setattr(opening, "_ANSWER_S", 0.5)
    app = serve()
    dead = WirePage(app)
    dead.await_result()
    dead.session.editor.change("title", title="Hall")
    dead.is_answering = False
    page = WirePage(app, dead.storage)
    assert page.session.editor.work.title == "Hall"
    assert page.session.keeper.path == folder / "stair.stair.json"
    assert dead.session not in app._sessions.values()
    # A second tab of a browser whose first one answers has work of its own.
    tab = WirePage(app, page.storage)
    assert tab.session.editor.work.title == ""
    assert page.session in app._sessions.values()


@pytest.mark.slow
def test_the_next_server_opens_the_scan_that_was_open(serve):
    app = serve()
    page = WirePage(app)
    part_of(page.session, "scan").choose("other.ply")
    page.await_result("other.ply")
    leave(app, page)
    app.stop()
    again = WirePage(serve(), page.storage)
    assert again.session.keeper.label == "other.ply"
    # What is kept in a browser is not believed.
    page.storage["stair_inspector.scan"] = "../../etc/passwd"
    assert WirePage(serve(), {**page.storage, "stair_inspector.browser": "x"}).session.keeper.label == "stair.ply"


def test_settings_as_last_time_are_those_that_the_last_session_left_the_scan_with(serve):
    app = serve()
    page = WirePage(app)
    page.await_result("stair.ply")
    presets = part_of(page.session, "tune").presets
    with pytest.raises(ConfigError, match="no saved work of an earlier session on stair"):
        presets.take_settings("As last time")
    page.session.editor.adjust(lambda params: params.replaced("levels.eps_m", 0.03))
    leave(app, page)
    page = WirePage(serve())
    page.await_result("stair.ply")
    session, presets = page.session, part_of(page.session, "tune").presets
    presets.take_settings("As suggested")
    suggested = session.editor.work.params
    assert suggested.levels.eps_m != 0.03
    assert "<li" in presets.suggestion.content
    session.editor.adjust(lambda params: params.replaced("overrules.climb", "x"))
    presets.take_settings("As last time")
    assert session.editor.work.params.levels.eps_m == 0.03
    assert session.editor.work.params.overrules.climb == "x"
    with pytest.raises(ConfigError, match="settings: got 'else'"):
        presets.take_settings("else")


def test_a_preset_that_the_menu_could_not_tell_from_its_own_words_is_refused(serve):
    session = WirePage(serve()).session
    before = session.editor.work
    for title in (OWN_PRESET, STARTED_WITH):
        with pytest.raises(ConfigError, match="is a word of the menu"):
            part_of(session, "tune").presets.load_preset(
                SimpleNamespace(name="p.toml", content=preset_bytes(Params(), title, "Own."))
            )
    assert session.editor.work == before


def test_what_is_typed_as_the_title_is_one_change_and_only_a_title(serve):
    session = WirePage(serve()).session
    for typed in ("H", "Ha", "Hal", "Hall"):
        part_of(session, "export").set_title(typed)
    assert session.editor.work.title == "Hall"
    with pytest.raises(ConfigError, match="holds a control character"):
        part_of(session, "export").set_title("Hall\x00")
    assert session.editor.work.title == "Hall"
    session.editor.undo()
    assert session.editor.work.title == ""


@pytest.mark.slow
def test_not_saved_stays_said_until_a_save_succeeds(serve, folder):
    page = WirePage(serve())
    page.await_result()
    session = page.session
    in_the_way = folder / "stair.stair.json"
    in_the_way.mkdir()
    session.editor.change("title", title="Hall")
    session.keeper.save()
    assert "Not saved" in part_of(session, "export").saved.content
    session.editor.change("title", title="Hall B")
    assert "Not saved" in part_of(session, "export").saved.content
    in_the_way.rmdir()
    session.keeper.save()
    assert "Saved at" in part_of(session, "export").saved.content


def test_what_could_not_be_saved_is_saved_within_five_seconds_of_there_being_room_and_told_once(
    serve, folder, monkeypatch
):
    page = WirePage(serve())
    page.await_result()
    monkeypatch.setattr(keeper, "_AGAIN_S", 0.1)
    tried = []

    def full(*_):
        tried.append(time.monotonic())
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(atomic.os, "fsync", full)
        page.session.editor.change("title", title="Hall")
        await_that(lambda: len(tried) > 3, "it is not tried again")
    saved = folder / "stair.stair.json"
    await_that(lambda: title_in(saved) == "Hall", "it is not saved once there is room")
    await_that(lambda: "Saved at" in part_of(page.session, "export").saved.content, "it is not said")
    (words,) = [words for words in page.told() if words.startswith("Not saved")]
    assert "No space left on device); make room on this disk" in words
    assert [path.name for path in folder.iterdir() if path.name.startswith(".si-")] == []


def test_what_waits_for_room_is_tried_again_well_within_five_seconds():
    assert keeper._AGAIN_S + keeper._QUIET_S < 4.0


def test_a_slider_that_moves_while_something_else_is_set_does_not_jump_back(serve):
    session = WirePage(serve()).session
    # The page has sent the slider's new value, and its callback waits for a thread.
    session.editor.controls._controls["horizontal.theta_deg"].value = 20.0
    part_of(session, "tune").take_reach("reach 25:1")
    params = session.editor.work.params
    assert (params.horizontal.theta_deg, params.levels.eps_m) == (20.0, 0.025)
    session.editor.undo()
    assert session.editor.work.params == Params().replaced("horizontal.theta_deg", 20.0)


def test_a_folder_opens_on_the_first_scan_that_can_be_read_and_marks_the_others(folder, serve):
    (folder / "other.ply").write_bytes(b"ply\nformat ascii 1.0\n")
    app = App([folder], Params(), port=0)
    try:
        page = WirePage(app)
        session = page.session
        await_that(lambda: session.desk.shown is not None, "no scan was measured")
        assert session.desk.shown.label == "stair.ply"
        scans = part_of(session, "scan").scans
        await_that(lambda: 'data-state="measured"' in scans.html.content, "no scan is said to be measured")
        rows = scans.html.content.split("<li ")[1:]
        assert [row.split('data-state="')[1].split('"')[0] for row in rows] == ["cannot be read", "measured"]
        assert ['aria-current="true"' in row for row in rows] == [False, True]
        # Chosen by a person it is opened, and its own sentence stays.
        part_of(session, "scan").choose("other.ply")
        await_that(lambda: "other.ply" in (session.desk.status.error or ""), "the broken file is not said")
        assert session.keeper.label == "other.ply"
        page.close()
    finally:
        app.stop()


@pytest.mark.slow
def test_a_page_that_is_gone_hands_its_work_on_while_somebody_still_draws_on_it(serve):
    app = serve()
    page = WirePage(app)
    page.await_result("stair.ply")
    page.session.keeper.change("title", title="Kept")
    has_lock, may_go = threading.Event(), threading.Event()

    def draw():
        with page.session.desk.lock:
            has_lock.set()
            may_go.wait(60.0)

    drawing = threading.Thread(target=draw)
    drawing.start()
    assert has_lock.wait(10.0)
    try:
        leave(app, page)
    finally:
        may_go.set()
        drawing.join()


@pytest.mark.slow
def test_a_late_result_of_the_scan_before_leaves_the_one_being_opened_said(serve):
    page = WirePage(serve())
    shown = page.await_result("stair.ply")
    session = page.session
    with session.desk.lock:
        part_of(session, "scan").choose("other.ply")
        assert session.desk.status.waiting == "opening …"
        session._done(Request("stair.ply", session.editor.work.params), shown.scan, shown.inspection, None)
        assert session.desk.status.waiting == "opening …"
