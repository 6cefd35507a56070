"""The doors of a running server: what requests and messages over the wire get."""

import logging
import socket
from pathlib import Path

import msgspec
import pytest
from websockets.exceptions import InvalidStatus

from stair_inspector.params import Params
from stair_inspector.viewer.app import App
from stair_inspector.viewer.bridge.doors.doors import Doors, new_token
from tests.viewer.wire_page import WirePage, connect_page, cookie_of, get

JUNK = (
    "text",
    b"",
    b"\xc1",
    msgspec.msgpack.encode({"type": "RunJavascriptMessage", "source": "window.struck = 1"}),
    msgspec.msgpack.encode({"type": "ViewerCameraMessage", "wxyz": "north"}),
    msgspec.msgpack.encode({"type": "GuiFormDirtyMessage", "uuid": "x" * 10_000}),
    msgspec.msgpack.encode({"type": "FileTransferPart", "source_component_uuid": None, "transfer_uuid": "none"}),
    msgspec.msgpack.encode(
        {
            "type": "FileTransferPart",
            "source_component_uuid": None,
            "transfer_uuid": "none",
            "part_index": 0,
            "content": b"a",
        }
    ),
)


def test_a_page_without_its_cookie_gets_neither_the_page_nor_a_connection(app):
    server = f"http://127.0.0.1:{app.port}/"
    for address in (server, f"{server}?token=wrong", f"{server}index.html", f"{server}../../secret"):
        status, headers, body = get(address)
        assert (status, headers["Content-Type"]) == (403, "text/html; charset=utf-8")
        assert b"printed in the terminal" in body
        assert headers["Set-Cookie"] is None
    kept = cookie_of(app.address)
    status, headers, body = get(server, {"Cookie": kept})
    assert status == 200
    assert b'<div id="root">' in body
    assert headers["X-Content-Type-Options"] == "nosniff"
    assert get(f"{server}secret", {"Cookie": kept})[0] == 404
    wrong = (
        {"Cookie": "stair_inspector=1"},
        {"Origin": "http://evil.example"},
        {"Origin": f"http://127.0.0.1:{app.port + 1}"},
    )
    for headers in wrong:
        with pytest.raises(InvalidStatus) as refused:
            connect_page(app.address, **headers)
        assert refused.value.response.status_code == 403
    connect_page(app.address).close()


@pytest.mark.parametrize(
    "names", [["evil.example"], ["127.0.0.1", "127.0.0.1"], ["127.0.0.1", "evil.example"], [], ["\xff.example"]]
)
def test_another_name_no_name_and_two_are_refused(app, names):
    lines = ["GET / HTTP/1.1", *(f"Host: {name}" for name in names), f"Cookie: {cookie_of(app.address)}", "", ""]
    with socket.create_connection(("127.0.0.1", app.port), timeout=10) as connection:
        connection.sendall("\r\n".join(lines).encode("latin-1"))
        assert connection.recv(20).startswith(b"HTTP/1.1 403 ")


def test_what_no_page_sends_is_passed_over_in_silence(app, capfd, caplog):
    caplog.set_level(logging.WARNING)
    page, other = WirePage(app), WirePage(app)
    for_everyone = app._server._websock_server.get_message_buffer().message_from_id
    before = len(for_everyone)
    try:
        for junk in JUNK:
            page._socket.send(junk)
        # Messages are read in order: when the page answers, what it sent before has been read.
        assert page.session.opening._is_answering()
        assert other.session.opening._is_answering()
        assert other.told() == []
        # What one page sends is kept for no other: viser hands the mark of a changed form on, and keeps it.
        assert len(for_everyone) == before
    finally:
        other.close()
        page.close()
    assert "Traceback" not in "".join(capfd.readouterr())
    assert caplog.records == []


def test_without_a_token_everyone_of_this_machine_is_let_in_and_other_sites_are_not():
    app = App([Path("a.ply")], Params(), port=0, saves_projects=False, doors=Doors(None))
    try:
        assert app.address == f"http://127.0.0.1:{app.port}/"
        assert get(app.address)[0] == 200
        assert get(app.address, {"Host": "evil.example"})[0] == 403
        assert get(app.address, {"Origin": "http://evil.example"})[0] == 403
        assert get(f"{app.address}view")[0] == 403
    finally:
        app.stop()


def test_two_servers_have_doors_of_their_own():
    apps = [App([Path("a.ply")], Params(), port=0, saves_projects=False, doors=Doors(new_token())) for _ in range(2)]
    try:
        addresses = [app.address for app in apps]
        kept = [cookie_of(address) for address in addresses]
        values = [cookie.partition("=")[2] for cookie in kept]
        for app, other in ((apps[0], values[1]), (apps[1], values[0])):
            cookie = f"stair_inspector_{app.port}={other}"
            assert get(f"http://127.0.0.1:{app.port}/", {"Cookie": cookie})[0] == 403
    finally:
        for app in apps:
            app.stop()
