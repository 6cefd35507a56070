"""What a page of another site gets in the same browser, and what a page asks for outside its server: nothing."""

import http.server
import threading
from urllib.parse import urlsplit

import pytest

from tests.browser.inspector_page import InspectorPage

ATTACK = """<!doctype html><title>another site</title><script>
const at = new URLSearchParams(location.search).get('at'), got = {};
const socket = new Promise((done) => {
    const one = new WebSocket('ws://' + at, 'viser-v' + VERSION);
    one.onopen = () => done('opened');
    one.onerror = () => done('refused');
});
const asked = (mode) => fetch('http://' + at + '/', {mode, credentials: 'include'}).then((answer) => answer.text())
    .then((text) => text.length ? 'read' : 'nothing', () => 'refused');
const framed = new Promise((done) => {
    const frame = document.createElement('iframe');
    frame.onload = () => setTimeout(() => done(String(frame.contentWindow.length)), 300);
    frame.src = 'http://' + at + '/';
    document.documentElement.append(frame);
});
(async () => {
    got.websocket = await socket;
    got.cors = await asked('cors');
    got.opaque = await asked('no-cors');
    got.frame = await framed;
    window.got = got;
})();
</script>"""


class Seen(http.server.BaseHTTPRequestHandler):
    """Notes what it is asked for, as a site and as a proxy, and answers with the attack."""

    def do_GET(self):
        self.server.asked.append(self.path)
        body = ATTACK.replace("VERSION", f"'{self.server.version}'").encode()
        self.send_response(200)
        self.send_header("Content-Type", "text/html")
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def do_CONNECT(self):
        self.server.asked.append(self.path)
        self.send_error(502)

    def log_message(self, *_):
        """Say nothing in the terminal."""


@pytest.fixture
def other_site():
    import viser

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Seen)
    server.asked, server.version = [], viser.__version__
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield server
    server.shutdown()
    server.server_close()


def refused(page, app):
    """The statuses of what a page has got from the server since, by how it asked."""
    answers = []
    page.on("response", lambda answer: answers.append((answer.request.resource_type, answer.status)))
    return answers


def test_a_page_of_another_site_gets_nothing_with_the_inspectors_own_browser(browser, app, other_site):
    context = browser.new_context()
    try:
        inspector = context.new_page()
        inspector.goto(app.address)
        inspector.wait_for_url(f"http://127.0.0.1:{app.port}/")
        (kept,) = context.cookies()
        assert (kept["name"], kept["httpOnly"], kept["sameSite"]) == (f"stair_inspector_{app.port}", True, "Strict")
        assert inspector.evaluate("document.cookie") == ""
        inspector.close()
        before = app.n_sessions
        # The same host at another port, to which the browser sends the cookie, and another host.
        for host in ("127.0.0.1", "localhost"):
            page = context.new_page()
            answers = refused(page, app)
            page.goto(f"http://{host}:{other_site.server_port}/?at=127.0.0.1:{app.port}")
            page.wait_for_function("() => window.got")
            got = page.evaluate("() => window.got")
            assert {name: got[name] for name in ("websocket", "cors")} == {"websocket": "refused", "cors": "refused"}
            assert got["opaque"] in ("nothing", "refused")
            statuses = {status for _, status in answers[1:]}
            assert statuses == {403}, answers
            # A link is followed by whoever clicks on it, and by the page that it leads to at once.
            page.close()
        assert app.n_sessions == before
    finally:
        context.close()


def test_the_address_lets_a_browser_in_from_another_site_and_stays_out_of_its_history(browser, app, other_site):
    context = browser.new_context()
    try:
        page = context.new_page()
        page.goto(f"http://localhost:{other_site.server_port}/?at=127.0.0.1:1")
        page.evaluate("(address) => { location.href = address; }", app.address)
        page.wait_for_url(f"http://127.0.0.1:{app.port}/")
        page.locator("canvas[data-engine]").wait_for()
        assert page.evaluate("() => document.referrer") == ""
        page.go_back()
        assert urlsplit(page.url).hostname == "localhost"
        # Without the address there is a page that says how to get in.
        stranger = browser.new_context()
        asked = stranger.new_page()
        assert asked.goto(f"http://127.0.0.1:{app.port}/").status == 403
        assert "printed in the terminal where it was started" in asked.locator("body").inner_text()
        stranger.close()
    finally:
        context.close()


@pytest.mark.slow
def test_a_page_asks_nobody_but_its_server(browser, app, other_site):
    # All that is not for this machine goes through a proxy, which notes it.
    proxy = {"server": f"http://127.0.0.1:{other_site.server_port}", "bypass": "127.0.0.1"}
    context = browser.new_context(viewport={"width": 1280, "height": 720}, proxy=proxy)
    page = InspectorPage(browser, app.address, context=context)
    try:
        page.open()
        for tab in ("Scan", "Tune", "Steps", "Checks", "Findings", "Look", "Export"):
            page.tab(tab)
        page.page.reload()
        page.await_result()
        assert page.problems == []
        # What the browser does on its own account is not the page's.
        assert [asked for asked in other_site.asked if "google" not in asked] == []
        # It would have been seen, and the page may not.
        said = page.page.evaluate("() => fetch('http://outside.example/a').then(() => 'sent', () => 'refused')")
        assert said == "refused"
        assert not any("outside.example" in asked for asked in other_site.asked)
        bare = context.new_page()
        bare.goto("http://outside.example/b")
        assert any("outside.example/b" in asked for asked in other_site.asked)
    finally:
        page.close()
