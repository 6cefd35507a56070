"""One browser, one server and one page for all browser tests; a page of its own for those that need it."""

import os
import shutil

import pytest

from stair_inspector.files.scans import read_scan
from stair_inspector.files.simulations import simulate_to_file
from stair_inspector.params import Params
from stair_inspector.pipeline import inspect
from stair_inspector.simulation.scanner_specs import Scanner
from stair_inspector.simulation.specs import Stair
from tests.browser.inspector_page import ARGUMENTS, OPENED, InspectorPage, find_browser
from tests.conftest import REPLACED
from tests.heavy_process import heavy_process, servers_share_a_process  # noqa: F401 - fixtures
from tests.oracles import missing

HOSTILE_NAME = "<img src=x onerror='window.struck=1'>&amp;.ply"
SCANNER = Scanner(max_points=12_000, azimuth_step_deg=0.2, elevation_step_deg=0.2, spacing_m=0.006, noise_m=0.003)


def pytest_collection_modifyitems(items):
    for item in items:
        if item.path.is_relative_to(os.path.dirname(__file__)):
            item.add_marker(pytest.mark.browser)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_teardown(nextitem):
    """Close all pages after the last test with a browser: an open one is drawn on and on beside all other tests."""
    yield
    if nextitem is None or not nextitem.path.is_relative_to(os.path.dirname(__file__)):
        for page in list(OPENED):
            page.close()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item, call):
    """Add to a failure what the open pages say, and how many messages the server has for each but has not sent."""
    report = yield
    if not report.failed:
        return report
    for number, page in enumerate(OPENED, start=1):
        try:
            said = page.page.locator("body").inner_text(timeout=5_000)
        except Exception as error:  # noqa: BLE001 - whatever is wrong with the page, the failure itself is to be read
            said = f"does not answer: {error}"
        report.sections.append((f"what open page {number} says", said))
    app = item.funcargs.get("app")
    if app is not None:
        buffers = [client._websock_connection.get_message_buffer() for client in app._server.get_clients().values()]
        waiting = ", ".join(str(len(buffer.message_from_id)) for buffer in buffers)
        report.sections.append(("messages not yet sent, page by page", waiting))
    return report


@pytest.fixture(scope="session")
def browser():
    path = find_browser()
    if path is None:
        missing("no Chromium found; install one, or name it in STAIR_INSPECTOR_BROWSER")
    from playwright import sync_api

    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=list(ARGUMENTS))
        yield browser
        browser.close()


@pytest.fixture(scope="session")
def scans(tmp_path_factory):
    """Two good scans, a broken one, and one whose name is HTML."""
    folder = tmp_path_factory.mktemp("scans")
    stair = Stair(n_risers=5, floor_front_m=1.0, floor_width_m=1.4, upper_landing_m=0.6)
    simulate_to_file(folder / "stair.ply", stair, SCANNER)
    simulate_to_file(folder / "other.ply", Stair(n_risers=3, floor_front_m=0.8, upper_landing_m=0.6), SCANNER)
    (folder / "broken.ply").write_bytes((folder / "stair.ply").read_bytes()[:-1000])
    shutil.copy(folder / "other.ply", folder / HOSTILE_NAME)
    return [folder / name for name in ("stair.ply", "other.ply", "broken.ply", HOSTILE_NAME)]


@pytest.fixture(scope="session")
def measured(scans):
    """The inspection of a scan with settings changed by dotted name, made here and not by the page."""

    def measure(changes=None, index=0):
        params = Params()
        for name, value in (changes or {}).items():
            params = params.replaced(name, value)
        return inspect(read_scan(scans[index], params.unit), params)

    return measure


@pytest.fixture(scope="session")
def app(scans):
    from stair_inspector.viewer.app import App

    app = App(scans, Params(), port=0, saves_projects=False)
    # The first page is opened once the computing process has loaded its libraries: no page waits for that.
    app._workshop.read(scans[0], Params().reading)
    yield app
    app.stop()


@pytest.fixture
def open_page(browser, app):
    """Open further pages; each has a profile of its own, and no errors when the test ends."""
    opened = []

    def open_page(**options):
        opened.append(InspectorPage(browser, options.pop("address", app.address), **options))
        return opened[-1].open()

    yield open_page
    problems = [problem for page in opened for problem in page.problems]
    for page in opened:
        page.close()
    assert problems == []


@pytest.fixture(scope="session")
def _shared(browser, app):
    """The page that most tests share; replaced after a test that has left it in disorder."""
    kept = []
    yield kept
    for page in kept:
        if page in OPENED:
            page.close()


@pytest.fixture
def page(request, browser, app, _shared):
    """A page with the preset's settings, the first scan, nothing selected, the steps coloured, seen from home."""
    if not _shared or _shared[0] not in OPENED:
        _shared[:] = []
        _shared.append(InspectorPage(browser, app.address).open())
    page = _shared[0]
    page.problems.clear()
    _shared.clear()
    yield page
    problems = list(page.problems)
    if problems:
        page.close()
    else:
        try:
            page.tidy()
        except Exception as error:  # noqa: BLE001 - whatever is wrong with it, the next test gets a new one
            request.node.user_properties.append((REPLACED, str(error).partition("\n")[0]))
            page.close()
        else:
            _shared.append(page)
    assert problems == []
