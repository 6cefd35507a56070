"""Nothing is lost: work is saved beside the scan and is there again after a reload and after a restart."""

import gc
import shutil
import threading
import time
import weakref

import pytest

from stair_inspector.files.project_files import read_project
from stair_inspector.params import Params
from stair_inspector.viewer.app import App
from tests.browser.inspector_page import SETTLE_MS, InspectorPage


@pytest.fixture
def folder(tmp_path, scans):
    shutil.copy(scans[0], tmp_path / "stair.ply")
    return tmp_path


def await_project(path, holds):
    ends = time.monotonic() + SETTLE_MS / 1000.0
    while True:
        if path.exists() and holds(read_project(path)):
            return read_project(path)
        assert time.monotonic() < ends, "the project is not saved"
        time.sleep(0.05)


@pytest.mark.slow
def test_work_is_saved_beside_the_scan_and_restored_by_the_next_server(browser, folder):
    before = (folder / "stair.ply").read_bytes()
    saved = folder / "stair.stair.json"
    app = App([folder], Params(), port=0)
    try:
        page = InspectorPage(browser, app.address).open()
        assert not saved.exists()
        page.press("paper's α_f [%]", "ArrowLeft")
        page.await_result("α 94.5/5 %")
        page.tab("Export")
        field = page.page.get_by_text("Title", exact=True).and_(page.page.locator("label")).first
        field.locator("xpath=ancestor::*[.//input][1]").locator("input").first.fill("Hall B")
        project = await_project(saved, lambda project: project.title == "Hall B")
        assert project.params == Params().replaced("edges.front_percentile", 94.5)
        page.page.locator("[data-testid=saved]", has_text="Saved at").wait_for()
        # A second inspector of the same scan begins anew and writes elsewhere.
        other = InspectorPage(browser, app.address).open()
        other.await_result("α 95/5 %")
        other.press("paper's α_f [%]", "ArrowLeft", times=2)
        other.await_result("α 94/5 %")
        await_project(folder / "stair.2.stair.json", lambda project: project.params.edges.front_percentile == 94.0)
        assert page.problems == other.problems == []
        other.close()
        page.close()
    finally:
        app.stop()
    assert read_project(saved).params.edges.front_percentile == 94.5
    app = App([folder], Params(), port=0)
    try:
        page = InspectorPage(browser, app.address)
        page.await_result("α 94.5/5 %")
        assert "Your work is back" in page.await_notification("Your work is back")
        page.open()
        assert page.slider_value("paper's α_f [%]") == 94.5
        page.close()
    finally:
        app.stop()
    assert (folder / "stair.ply").read_bytes() == before


@pytest.mark.slow
def test_saved_work_of_another_state_of_the_file_is_left_alone(browser, folder, scans):
    saved = folder / "stair.stair.json"
    app = App([folder], Params(), port=0)
    try:
        page = InspectorPage(browser, app.address).open()
        page.press("paper's α_f [%]", "ArrowLeft")
        await_project(saved, lambda project: project.params.edges.front_percentile == 94.5)
        page.close()
    finally:
        app.stop()
    content = saved.read_bytes()
    shutil.copy(scans[1], folder / "stair.ply")
    app = App([folder], Params(), port=0)
    try:
        page = InspectorPage(browser, app.address)
        page.await_result("α 95/5 %")
        assert "another state of this file" in page.await_notification("Saved work not taken up")
        page.open()
        page.press("paper's α_f [%]", "ArrowLeft", times=2)
        await_project(folder / "stair.2.stair.json", lambda project: project.params.edges.front_percentile == 94.0)
        page.close()
    finally:
        app.stop()
    assert saved.read_bytes() == content


@pytest.mark.slow
def test_a_page_that_closes_frees_what_it_held(browser, folder):
    app = App([folder], Params(), port=0, saves_projects=False)
    try:
        before = set(threading.enumerate())
        page = InspectorPage(browser, app.address).open()
        held = weakref.ref(next(iter(app._sessions.values())))
        page.close()
        ends = time.monotonic() + SETTLE_MS / 1000.0
        while held() is not None:
            assert time.monotonic() < ends, "the session of a closed page is still there"
            gc.collect()
            time.sleep(0.05)
        left = set(threading.enumerate()) - before
        assert not [thread.name for thread in left if thread.name.startswith("stair-s")]
    finally:
        app.stop()
