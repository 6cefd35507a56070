"""A view-only page shows the saved work and changes nothing, whatever its browser sends."""

import shutil
from types import SimpleNamespace

import pytest

from stair_inspector.errors import ConfigError
from stair_inspector.files.project_files import read_project
from stair_inspector.params import Params
from stair_inspector.viewer.app import App
from stair_inspector.viewer.bridge.doors.doors import Doors, new_token
from stair_inspector.viewer.bridge.doors.words import VIEW_ONLY
from stair_inspector.viewer.bridge.handles import uuid_of
from tests.viewer.parts_of import part_of
from tests.viewer.wire_page import STAIR, WirePage, await_that

PERCENTILE = "edges.front_percentile"


@pytest.fixture(scope="module")
def folder(two_stairs, tmp_path_factory):
    folder = tmp_path_factory.mktemp("shared")
    shutil.copy(two_stairs / STAIR, folder / STAIR)
    return folder


@pytest.fixture(scope="module")
def app(folder):
    """A server of one scan, with work on it that an inspector has saved and goes on with."""
    app = App([folder / STAIR], Params(), port=0, doors=Doors(new_token(), shares_view=True))
    yield app
    app.stop()


@pytest.fixture(scope="module")
def inspector(app, folder):
    page = WirePage(app)
    page.await_result(STAIR)
    page.session.editor.adjust(lambda params: params.replaced(PERCENTILE, 94.5))
    saved = folder / "stair.stair.json"
    await_that(lambda: saved.exists() and read_project(saved).params.value(PERCENTILE) == 94.5, "it is not saved")
    yield page
    page.close()


@pytest.fixture
def viewer(app, inspector):
    # In the same browser: what the inspector's pages were at stays theirs.
    page = WirePage(app, inspector.storage, app.view_address)
    page.await_result(STAIR)
    yield page
    page.close()


def front_percentile(page):
    return page.session.editor.work.params.value(PERCENTILE)


def slider_of(page):
    return page.session.editor.controls._controls[PERCENTILE]


def test_it_shows_what_is_saved_while_the_inspector_works_on(viewer, inspector, folder):
    assert front_percentile(viewer) == 94.5
    assert viewer.session.desk.shown.inspection.params.value(PERCENTILE) == 94.5
    assert any("stair.stair.json, as it was last saved" in words for words in viewer.told())
    assert inspector.session.keeper.path == folder / "stair.stair.json"
    assert viewer.session.keeper.path is None


def test_what_its_browser_sends_changes_nothing_and_is_answered_by_one_sentence(viewer, inspector, folder):
    saved = folder / "stair.stair.json"
    before, files = saved.read_bytes(), sorted(folder.iterdir())
    slider = slider_of(viewer)
    viewer._send({"type": "GuiUpdateMessage", "uuid": uuid_of(slider), "updates": {"value": 60.0}})
    await_that(lambda: f"Not done: {VIEW_ONLY}" in viewer.told(), "nothing is said")
    await_that(lambda: slider.value == 94.5, "the slider does not go back")
    export = part_of(viewer.session, "export")
    viewer._send({"type": "GuiUpdateMessage", "uuid": uuid_of(export.title_field), "updates": {"value": "Taken over"}})
    await_that(lambda: export.title_field.value == "", "the title does not go back")
    # The identities of the inspector's controls are no secret worth keeping: they mean nothing on another page.
    mine = slider_of(inspector)
    viewer._send({"type": "GuiUpdateMessage", "uuid": uuid_of(mine), "updates": {"value": 60.0}})
    for button, name in ((part_of(viewer.session, "scan").upload, "new.ply"), (export.open, "new.json")):
        viewer._send(
            {
                "type": "FileTransferStartUpload",
                "source_component_uuid": uuid_of(button),
                "transfer_uuid": name,
                "filename": name,
                "mime_type": "",
                "size_bytes": 3,
                "part_count": 1,
            }
        )
        part = {"source_component_uuid": uuid_of(button), "transfer_uuid": name, "part_index": 0, "content": b"ply"}
        viewer._send({"type": "FileTransferPart"} | part)
    await_that(lambda: f"Not done: upload: {VIEW_ONLY}" in viewer.told(), "nothing is said of the upload")
    assert viewer.session.opening._is_answering()
    assert viewer.session.opening.labels() == (STAIR,)
    assert not viewer.session.desk.client.gui._current_file_upload_states
    assert front_percentile(viewer) == front_percentile(inspector) == mine.value == 94.5
    assert saved.read_bytes() == before
    assert sorted(folder.iterdir()) == files


def test_nothing_that_its_parts_do_changes_the_work(viewer, folder):
    editor, keeper = viewer.session.editor, viewer.session.keeper
    work, files = editor.work, sorted(folder.iterdir())
    changes = (
        lambda: editor.adjust(lambda params: params.replaced(PERCENTILE, 60.0)),
        lambda: editor.change("title", title="Hall"),
        lambda: editor.edit("title", lambda _: {"title": "Hall"}),
        editor.reset,
        lambda: keeper.change("title", title="Hall"),
        lambda: viewer.session.opening.keep_upload(SimpleNamespace(name="new.ply", content=b"ply")),
    )
    for change in changes:
        with pytest.raises(ConfigError, match="this page is for viewing"):
            change()
        assert editor.work == work
    with pytest.raises(ConfigError, match="there is nothing to undo"):
        editor.undo()
    keeper.save()
    # What is only looked at is as on any page.
    viewer.session.desk.set_unit("in")
    editor.submit()
    viewer.await_result(STAIR)
    assert sorted(folder.iterdir()) == files


def test_loaded_again_it_shows_what_is_saved_since_and_leaves_the_inspectors_page_its_own(
    app, viewer, inspector, folder
):
    saved = folder / "stair.stair.json"
    inspector.session.editor.change("title", title="Hall B")
    await_that(lambda: read_project(saved).title == "Hall B", "it is not saved")
    assert viewer.session.editor.work.title == ""
    viewer.close()
    again = WirePage(app, inspector.storage, app.view_address)
    again.await_result(STAIR)
    assert again.session.editor.work.title == "Hall B"
    inspector_id = inspector.storage["stair_inspector.browser"]
    again.close()
    await_that(lambda: len(app._sessions) == 1, "the page is still open")
    assert inspector.storage["stair_inspector.browser"] == inspector_id
    assert not app._kept._by_browser
