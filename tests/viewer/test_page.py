"""What an inspector does is kept, belongs to its scan, and never overwrites another's work: without a browser."""

import dataclasses
import io
import shutil
import threading
from types import SimpleNamespace

import pytest
from PIL import Image

from stair_inspector.codes import Limit, RuleEdit
from stair_inspector.content.fields import ReportBasis, ReportFields
from stair_inspector.content.images import read_logo
from stair_inspector.content.readings import TapeReading
from stair_inspector.errors import ConfigError
from stair_inspector.files.chosen_rules import ChosenRules, LeftEdits
from stair_inspector.files.projects import Measurement, read_project
from stair_inspector.files.settings import preset_bytes
from stair_inspector.params import Params
from stair_inspector.viewer.app import App
from stair_inspector.viewer.parts.scan import opening
from stair_inspector.viewer.parts.tune.presets import STARTED_WITH
from stair_inspector.viewer.parts.tune.tab import OWN_PRESET
from stair_inspector.viewer.state.library import state_of
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


def test_the_desk_is_never_waited_for_while_the_work_is_held(serve):
    page = WirePage(serve())
    page.await_result("stair.ply")
    session = page.session
    held, wrong = threading.local(), []
    session.desk.lock = WatchedLock("desk", held, wrong)
    session.keeper.lock = WatchedLock("keeper", held, wrong)
    session.adjust(lambda params: params.replaced("levels.eps_m", 0.03))
    session.change("measured", measurements=(POINT,))
    session.undo()
    session.redo()
    session.reset()
    session.submit()
    session.pick("reach 25:1")
    session.exporting.set_title("Hall")
    session.reporting.set_paper("US Letter")
    session.reporting.set_text("fields", "firm", "Alder")
    session.panel.export.report.value.value = "170"
    session.reporting.add_reading()
    session.set_unit("in")
    session.tuning.take_preset(next(iter(session.tuning._presets)))
    session.comparing.keep("A")
    session.toolbar.views.keep()
    session.region.use_tool("Around the stair")
    session.upright.start("Take the treads")
    session.results.select(1)
    session.deciding.mark("rejected")
    session.deciding.clear()
    session.choose_scan("other.ply")
    page.await_result("other.ply")
    assert wrong == []


def test_nothing_is_done_to_a_scan_while_another_is_still_shown(serve, folder, two_stairs):
    (folder / "other.ply").write_bytes((two_stairs / "stair.ply").read_bytes()[:-1000])
    page = WirePage(serve())
    page.await_result("stair.ply")
    session = page.session
    session.results.select(1)
    project = session.exporting._project
    of_stair = project()
    session.choose_scan("other.ply")
    for act in (
        lambda: session.deciding.mark("rejected"),
        session.toolbar.views.keep,
        lambda: session.comparing.keep("A"),
        lambda: session.region.use_tool("Around the stair"),
        lambda: session.upright.start("Take the treads"),
        lambda: session.exporting.download("CSV"),
        lambda: session.exporting.open_project(SimpleNamespace(name="p.stair.json", content=of_stair)),
    ):
        with pytest.raises(ConfigError):
            act()
    assert session.work.params == Params()
    await_that(lambda: "other.ply" in (session._error or ""), "the broken file is not said")
    assert "other.ply" in session.panel.header.content
    assert "stair.ply" not in session.panel.header.content
    assert 'data-testid="step-row"' not in session.panel.steps.table.html.content
    assert "for these settings" not in session.panel.state.content
    assert "Shown dimmed" not in session.panel.state.content
    session.choose_scan("stair.ply")
    assert page.await_result("stair.ply").inspection.steps


def test_another_scan_begins_with_its_own_unit_and_up(serve):
    app = serve(Params().replaced("up", "z"))
    session = WirePage(app).session
    session.adjust(lambda params: params.replaced("up", "0.01,0,1").replaced("levels.eps_m", 0.03))
    session.adjust(lambda params: params.replaced("unit", "mm"))
    session.choose_scan("other.ply")
    params = session.work.params
    assert (params.up, params.unit, params.levels.eps_m) == ("z", Params().unit, 0.03)


def test_a_report_begins_with_what_the_server_was_given_and_goes_on_with_the_surveyor_but_not_with_the_stair(serve):
    basis = ReportBasis(fields=ReportFields(firm="Alder & Finch", client="Northgate"), paper="us-letter")
    session = WirePage(serve(basis=basis)).session
    assert session.work.basis == basis
    fields = dataclasses.replace(basis.fields, inspector="J. Alder", instrument_model="X 7", stair="C-2", client="Else")
    reading = TapeReading("rise", 0.17, step=1)
    session.change("changed", basis=ReportBasis(fields=fields, readings=(reading,), logo=LOGO))
    edit = RuleEdit("riser", "maximum", Limit.of("7 3/4", "in"), Limit.of("6", "in"), "why")
    left = LeftEdits("us-irc-2021", (edit,))
    session.change("changed", rules=ChosenRules("us-irc-2024", decision="simple", edits=(edit,), left=(left,)))
    session.choose_scan("other.ply")
    other = session.work
    wanted = dataclasses.replace(basis.fields, inspector="J. Alder", instrument_model="X 7")
    assert other.basis == ReportBasis(fields=wanted, logo=LOGO)
    assert other.rules == ChosenRules("us-irc-2024", decision="simple")
    session.choose_scan("stair.ply")
    assert (session.work.basis.fields, len(session.work.rules.edits)) == (fields, 1)


def test_a_reload_brings_the_work_on_every_scan_back_with_its_undo(serve):
    app = serve(saves_projects=False)
    page = WirePage(app)
    page.await_result("stair.ply")
    page.session.change("title", title="Hall")
    page.session.adjust(lambda params: params.replaced("levels.eps_m", 0.03))
    page.session.choose_scan("other.ply")
    page.session.change("title", title="Yard")
    leave(app, page)
    page = WirePage(app, page.storage)
    session = page.session
    assert (session.keeper.label, session.work.title) == ("other.ply", "Yard")
    assert session.keeper.history.undo_label == "title"
    session.choose_scan("stair.ply")
    assert (session.work.title, session.work.params.levels.eps_m) == ("Hall", 0.03)
    session.undo()
    session.undo()
    assert session.work.title == ""
    assert session.work.params.levels.eps_m == Params().levels.eps_m


@pytest.mark.slow
def test_a_page_that_comes_back_leaves_alone_what_others_have_saved_meanwhile(serve, folder):
    app = serve()
    mine = WirePage(app)
    mine.await_result()
    mine.session.change("title", title="mine")
    leave(app, mine)
    assert title_in(folder / "stair.stair.json") == "mine"
    theirs = WirePage(app)
    theirs.await_result()
    assert theirs.session.work.title == "mine"
    theirs.session.change("title", title="theirs")
    third = WirePage(app)
    third.await_result()
    third.session.change("title", title="third")
    leave(app, third)
    leave(app, theirs)
    mine = WirePage(app, mine.storage)
    mine.await_result()
    assert mine.session.work.title == "mine"
    mine.session.change("title", title="mine again")
    mine.session.keeper.save()
    assert title_in(folder / "stair.stair.json") == "theirs"
    assert title_in(folder / "stair.2.stair.json") == "third"
    assert title_in(folder / "stair.3.stair.json") == "mine again"


def test_work_that_could_not_be_saved_before_a_reload_is_saved_after_it_whatever_scan_is_open(serve, folder):
    app = serve()
    page = WirePage(app)
    page.await_result("stair.ply")
    in_the_way = folder / "stair.stair.json"
    in_the_way.mkdir()
    page.session.change("title", title="Hall")
    page.session.choose_scan("other.ply")
    page.await_result("other.ply")
    leave(app, page)
    in_the_way.rmdir()
    page = WirePage(app, page.storage)
    page.session.change("title", title="Yard")
    page.session.keeper.save()
    assert (title_in(in_the_way), title_in(folder / "other.stair.json")) == ("Hall", "Yard")


@pytest.mark.slow
def test_a_page_that_comes_back_while_its_file_is_in_use_takes_none_that_exists(serve, folder):
    app = serve()
    mine = WirePage(app)
    mine.await_result()
    mine.session.change("title", title="mine")
    theirs = WirePage(app)
    theirs.await_result()
    theirs.session.change("title", title="theirs")
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
    page.session.change("measured", measurements=(POINT,))
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
    session.choose_scan("other.ply")
    assert not session.opening.is_of("stair.ply", state_of(folder / "stair.ply"))
    is_chosen.set()
    page.await_result("other.ply")
    session.choose_scan("stair.ply")
    page.await_result("stair.ply")
    assert session.work.measurements == ()
    session.change("title", title="new state")
    session.keeper.save()
    assert read_project(folder / "stair.stair.json").measurements == (POINT,)
    assert title_in(folder / "stair.2.stair.json") == "new state"
    # The next server finds the work that belongs to the file as it is now.
    app.stop()
    page = WirePage(serve())
    page.await_result("stair.ply")
    await_that(lambda: page.session.work.title == "new state", "the work on this state is not back")
    assert any("stair.2.stair.json is back" in told for told in page.told())


@pytest.mark.parametrize("reloads", [pytest.param(False, marks=pytest.mark.slow), True])
def test_work_on_a_file_that_changes_is_put_aside_and_undo_brings_it_back(serve, folder, two_stairs, reloads):
    app = serve()
    page = WirePage(app)
    page.await_result()
    page.session.change("all", measurements=(POINT,), title="Hall")
    if reloads:
        leave(app, page)
    else:
        page.session.keeper.save()
    shutil.copy(two_stairs / "other.ply", folder / "stair.ply")
    if reloads:
        page = WirePage(app, page.storage)
    session = page.session
    session.submit()
    await_that(lambda: session.work.measurements == (), "measurements of the other cloud are still there")
    await_that(lambda: any("File changed" in told for told in page.told()), "nobody is told")
    page.await_result()
    session.keeper.save()
    assert read_project(folder / "stair.stair.json").measurements == (POINT,)
    assert title_in(folder / "stair.2.stair.json") == session.work.title == "Hall"
    session.undo()
    assert session.work.measurements == (POINT,)


def test_an_upload_is_nobody_elses_and_what_is_done_on_it_is_not_called_saved(serve, two_stairs):
    app = serve()
    mine, theirs = WirePage(app), WirePage(app)
    upload = SimpleNamespace(name="up.ply", content=(two_stairs / "other.ply").read_bytes())
    mine.session.take_upload(upload)
    mine.await_result("up.ply")
    assert mine.session.keeper.path is None
    assert "Kept until the server ends" in mine.session.panel.export.saved.content
    assert any("up.ply is deleted when the server ends" in told for told in mine.told())
    with pytest.raises(ConfigError, match="is none of the files"):
        theirs.session.choose_scan("up.ply")


def test_uploads_of_pages_that_have_gone_make_room(serve, two_stairs):
    app = serve()
    content = (two_stairs / "other.ply").read_bytes()
    page = WirePage(app)
    page.session.take_upload(SimpleNamespace(name="first.ply", content=content))
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
    dead.session.change("title", title="Hall")
    dead.is_answering = False
    page = WirePage(app, dead.storage)
    assert page.session.work.title == "Hall"
    assert page.session.keeper.path == folder / "stair.stair.json"
    assert dead.session not in app._sessions.values()
    # A second tab of a browser whose first one answers has work of its own.
    tab = WirePage(app, page.storage)
    assert tab.session.work.title == ""
    assert page.session in app._sessions.values()


@pytest.mark.slow
def test_the_next_server_opens_the_scan_that_was_open(serve):
    app = serve()
    page = WirePage(app)
    page.session.choose_scan("other.ply")
    page.await_result("other.ply")
    leave(app, page)
    app.stop()
    again = WirePage(serve(), page.storage)
    assert again.session.keeper.label == "other.ply"
    # What is kept in a browser is not believed.
    page.storage["stair_inspector.scan"] = "../../etc/passwd"
    assert WirePage(serve(), {**page.storage, "stair_inspector.browser": "x"}).session.keeper.label == "stair.ply"


def test_a_preset_that_the_menu_could_not_tell_from_its_own_words_is_refused(serve):
    session = WirePage(serve()).session
    before = session.work
    for title in (OWN_PRESET, STARTED_WITH):
        with pytest.raises(ConfigError, match="is a word of the menu"):
            session.tuning.load_preset(SimpleNamespace(name="p.toml", content=preset_bytes(Params(), title, "Own.")))
    assert session.work == before


def test_what_is_typed_as_the_title_is_one_change_and_only_a_title(serve):
    session = WirePage(serve()).session
    for typed in ("H", "Ha", "Hal", "Hall"):
        session.exporting.set_title(typed)
    assert session.work.title == "Hall"
    with pytest.raises(ConfigError, match="holds a control character"):
        session.exporting.set_title("Hall\x00")
    assert session.work.title == "Hall"
    session.undo()
    assert session.work.title == ""


def test_not_saved_stays_said_until_a_save_succeeds(serve, folder):
    page = WirePage(serve())
    page.await_result()
    session = page.session
    in_the_way = folder / "stair.stair.json"
    in_the_way.mkdir()
    session.change("title", title="Hall")
    session.keeper.save()
    assert "Not saved" in session.panel.export.saved.content
    session.change("title", title="Hall B")
    assert "Not saved" in session.panel.export.saved.content
    in_the_way.rmdir()
    session.keeper.save()
    assert "Saved at" in session.panel.export.saved.content


def test_a_slider_that_moves_while_something_else_is_set_does_not_jump_back(serve):
    session = WirePage(serve()).session
    # The page has sent the slider's new value, and its callback waits for a thread.
    session.panel.controls._controls["horizontal.theta_deg"].value = 20.0
    session.pick("reach 25:1")
    params = session.work.params
    assert (params.horizontal.theta_deg, params.levels.eps_m) == (20.0, 0.025)
    session.undo()
    assert session.work.params == Params().replaced("horizontal.theta_deg", 20.0)
