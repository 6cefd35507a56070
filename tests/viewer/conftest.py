"""A server of two small scans and a page of it without a browser, for the tests that do not make their own."""

import pytest

from tests.viewer.wire_page import STAIR, WirePage, serve_two_stairs


@pytest.fixture(scope="module")
def app(tmp_path_factory):
    app = serve_two_stairs(tmp_path_factory.mktemp("scans"))
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
