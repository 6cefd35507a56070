"""A server of two small scans and a page of it without a browser, for the tests that do not make their own."""

import pytest

from stair_inspector.memo import Memo
from stair_inspector.viewer.compute import runs
from tests.heavy_process import heavy_process, servers_share_a_process  # noqa: F401 - fixtures
from tests.viewer.wire_page import STAIR, WirePage, serve, simulate_two_stairs


@pytest.fixture(scope="session")
def two_stairs(tmp_path_factory):
    """Folder of two small scans that all tests share; it is only read."""
    return simulate_two_stairs(tmp_path_factory.mktemp("scans"))


@pytest.fixture(scope="module")
def app(two_stairs):
    """A server; its first page measures a scan, and every page of a later test begins with what that one kept."""
    kept = {}

    class Begun(Memo):
        def __init__(self, *args):
            super().__init__(*args)
            self._slots.update(kept)

        def _kept(self, stage, make, inputs):
            result = super()._kept(stage, make, inputs)
            kept.setdefault(stage, self._slots[stage])
            return result

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(runs, "Memo", Begun)
        app = serve(two_stairs)
        yield app
        app.stop()


@pytest.fixture
def page(app):
    page = WirePage(app)
    page.await_result(STAIR)
    yield page
    page.close()


@pytest.fixture
def session(page):
    return page.session
