"""Where the server listens, whom it lets in, and what the command line says of it."""

import contextlib
import re
import socket
import threading
import time
import urllib.request
from pathlib import Path

import msgspec
import pytest
import viser
import viser._messages as messages
from websockets.sync.client import connect

from stair_inspector import cli
from stair_inspector.content.fields import ReportBasis, ReportFields
from stair_inspector.errors import ConfigError
from stair_inspector.params import Params
from stair_inspector.viewer import app as app_module
from stair_inspector.viewer.app import App
from stair_inspector.viewer.bridge.doors import gate
from stair_inspector.viewer.bridge.doors.doors import TOKEN_VARIABLE, VIEW_PATH, DoorCall, is_loopback
from stair_inspector.viewer.state.labels import label_scans
from stair_inspector.viewer.state.library import DEFAULT_UPLOAD_LIMIT_MB
from tests.viewer.wire_page import connect_page

SCAN = [Path("a.ply")]


@pytest.fixture(scope="module")
def app():
    app = App(SCAN, Params(), port=0)
    yield app
    app.stop()


@pytest.mark.parametrize("host", ["localhost", "127.0.0.1", "127.8.9.10", "::1"])
def test_these_hosts_are_this_machine_only(host):
    assert is_loopback(host)


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "192.168.1.20", "203.0.113.1", "example.org", "", "127.0.0.1.x"])
def test_these_hosts_may_be_reached_from_elsewhere(host):
    assert not is_loopback(host)


@pytest.mark.parametrize(
    ("paths", "labels"),
    [
        (["a.ply"], ["a.ply"]),
        (["x/a.ply", "y/b.ply"], ["a.ply", "b.ply"]),
        (["x/a.ply", "y/a.ply", "y/b.ply"], ["x/a.ply", "y/a.ply", "b.ply"]),
        (["p/x/a.ply", "q/x/a.ply"], ["p/x/a.ply", "q/x/a.ply"]),
        (["a.ply", "x/a.ply"], ["a.ply", "x/a.ply"]),
        (["x/a.ply", "y/x/a.ply"], ["x/a.ply", "y/x/a.ply"]),
        (["/x/a.ply", "/x/a.ply"], ["a.ply"]),
    ],
)
def test_scans_of_the_same_name_are_told_apart_by_their_folders(paths, labels):
    found = label_scans([Path(path) for path in paths])
    assert list(found) == labels
    assert set(found.values()) == {Path(path) for path in paths}


def test_a_busy_port_is_named_and_not_passed_over():
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen(1)
        port = other.getsockname()[1]
        with pytest.raises(ConfigError, match=f"--port: {port} on 127.0.0.1 is in use.*0 for a free one"):
            App(SCAN, Params(), port=port)


# 203.0.113.1 is reserved for documentation; a name with a label of 70 letters cannot exist and is not looked up.
@pytest.mark.parametrize("host", ["203.0.113.1", "a" * 70 + ".example", "no host"])
def test_a_host_that_cannot_be_listened_on_is_an_error_and_not_a_wait(host, monkeypatch):
    known = socket.getaddrinfo

    def look_up(name, *rest, **options):
        if name == "no host":
            raise socket.gaierror(socket.EAI_NONAME, "Name or service not known")
        return known(name, *rest, **options)

    monkeypatch.setattr(socket, "getaddrinfo", look_up)
    began = time.monotonic()
    with pytest.raises(ConfigError, match="--host: "):
        App(SCAN, Params(), host=host, port=0)
    assert time.monotonic() - began < 5.0


@pytest.mark.parametrize("port", [-1, 65536, 10**9])
def test_a_port_out_of_range_is_an_error(port):
    with pytest.raises(ConfigError, match=f"--port: got {port}; give 0 to 65535"):
        App(SCAN, Params(), port=port)


def test_port_zero_takes_a_free_one_and_says_which(app):
    assert 1024 <= app.port <= 65535
    with urllib.request.urlopen(app.address, timeout=10) as answer:
        assert answer.status == 200
        assert b"<html" in answer.read()[:2000].lower()


def test_a_port_override_in_the_environment_does_not_move_it(monkeypatch):
    monkeypatch.setenv("_VISER_PORT_OVERRIDE", "1")
    app = App(SCAN, Params(), port=0)
    try:
        assert app.port > 1
        urllib.request.urlopen(app.address, timeout=10).close()
    finally:
        app.stop()


def test_no_page_can_open_a_public_tunnel(app, monkeypatch):
    opened, fence = [], threading.Event()
    monkeypatch.setattr(viser.ViserServer, "request_share_url", lambda *_: opened.append("open"))
    monkeypatch.setattr(viser.ViserServer, "disconnect_share_url", lambda *_: opened.append("close"))
    server = app._server._websock_server
    # Messages are handled in order: when this one has been, the others have.
    server.register_handler(messages.CommandTriggerMessage, lambda *_: fence.set())
    monkeypatch.setattr(gate, "is_accepted", lambda _: True)
    with connect_page(app.address) as page:
        for message in (
            {"type": "ShareUrlRequest"},
            {"type": "ShareUrlDisconnect"},
            {"type": "CommandTriggerMessage", "uuid": ""},
        ):
            page.send(msgspec.msgpack.encode(message))
        assert fence.wait(10.0)
    app._server._thread_executor.submit(int).result(10.0)
    assert opened == []


def test_the_message_of_the_tunnel_would_have_been_heard(monkeypatch, capsys):
    """The test above proves something: without the removal the same message opens the tunnel."""
    opened = threading.Event()
    monkeypatch.setattr(viser.ViserServer, "request_share_url", lambda *_: opened.set())
    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    try:
        address = f"ws://127.0.0.1:{server.get_port()}"
        with connect(address, subprotocols=[f"viser-v{viser.__version__}"], max_size=None) as page:
            page.send(msgspec.msgpack.encode({"type": "ShareUrlRequest"}))
            assert opened.wait(10.0)
    finally:
        server.stop()


def test_stopping_ends_the_wait_and_frees_the_port():
    app = App(SCAN, Params(), port=0)
    waiting = threading.Thread(target=app.wait)
    waiting.start()
    app.stop()
    waiting.join(10.0)
    assert not waiting.is_alive()
    assert app.n_sessions == 0
    ending = time.monotonic() + 10.0
    while time.monotonic() < ending:
        with socket.socket() as probe, contextlib.suppress(OSError):
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind(("127.0.0.1", app.port))
            return
        time.sleep(0.05)
    pytest.fail("the port is still taken")


class FakeApp:
    made = ()

    def __init__(self, scans, params, host, port, **options):
        self.scans, self.params, self.host, self.port = scans, params, host, port or 4321
        self.options = options
        self.is_stopped = False
        FakeApp.made = (*FakeApp.made, self)

    def wait(self):
        raise KeyboardInterrupt

    def stop(self):
        self.is_stopped = True


@pytest.fixture
def view(monkeypatch, tmp_path, capsys):
    """Run ``view`` without a server; return the fake app, stdout and stderr."""
    scan = tmp_path / "a.ply"
    scan.write_bytes(b"ply")
    FakeApp.made = ()
    monkeypatch.setattr(app_module, "App", FakeApp)

    def run(*options):
        assert cli.main(["view", str(scan), "--no-browser", *options]) == 0
        (app,) = FakeApp.made
        printed = capsys.readouterr()
        return app, printed.out, printed.err

    return run


def test_view_stays_on_this_machine_and_prints_its_address(view):
    app, out, err = view()
    assert (app.host, app.port) == ("127.0.0.1", 8080)
    assert re.search(r"http://127\.0\.0\.1:8080/\?token=[\w-]{43} ", out)
    assert VIEW_PATH not in out
    assert err == ""
    assert app.is_stopped


def test_view_for_everyone_warns(view):
    app, out, err = view("--host", "0.0.0.0", "--port", "0")
    assert app.host == "0.0.0.0"
    assert "http://127.0.0.1:4321" in out
    assert err.count("warning") == err.count("\n") == 1
    assert "sent to and from 0.0.0.0 can be read on the way" in err
    assert "SSH" in err


def test_view_hands_over_settings_and_scans(view):
    app, _, _ = view("--levels.eps-m", "0.03", "--up", "-z")
    assert app.params.levels.eps_m == 0.03
    assert app.params.up == "-z"
    assert [path.name for path in app.scans] == ["a.ply"]


def test_view_saves_projects_beside_the_scans_unless_told_otherwise(view, tmp_path):
    app, _, _ = view()
    wanted = {"project_dir": None, "saves_projects": True, "upload_limit_mb": DEFAULT_UPLOAD_LIMIT_MB, "basis": None}
    assert without_doors(app) == wanted
    FakeApp.made = ()
    app, _, _ = view("--project-dir", str(tmp_path / "projects"), "--no-autosave", "--upload-limit-mb", "20")
    wanted |= {"project_dir": tmp_path / "projects", "saves_projects": False, "upload_limit_mb": 20.0}
    assert without_doors(app) == wanted


def without_doors(app):
    return {name: value for name, value in app.options.items() if name != "doors"}


def test_view_begins_reports_with_what_a_file_says(view, tmp_path):
    path = tmp_path / "firm.toml"
    path.write_text("paper = 'us-letter'\n[fields]\nfirm = 'Alder & Finch'", encoding="utf-8")
    app, _, _ = view("--fields", str(path))
    assert app.options["basis"] == ReportBasis(fields=ReportFields(firm="Alder & Finch"), paper="us-letter")


def test_view_hands_over_folders_so_that_they_can_be_looked_into_again(view, tmp_path):
    folder = tmp_path / "more"
    folder.mkdir()
    (folder / "b.ply").write_bytes(b"ply")
    assert cli.main(["view", str(tmp_path / "a.ply"), str(folder), "--no-browser"]) == 0
    (app,) = FakeApp.made
    assert app.scans == [tmp_path / "a.ply", folder]


@pytest.mark.parametrize(
    ("args", "text"),
    [
        (["--project-dir", "{scan}"], "{scan}: is a file, not a folder; give another folder with --project-dir"),
        (["--upload-limit-mb", "0"], "--upload-limit-mb: got 0; give a number above 0, at most 1e+06"),
        (["--upload-limit-mb", "nan"], "--upload-limit-mb: got nan; give a number above 0, at most 1e+06"),
        (["--upload-limit-mb", "inf"], "--upload-limit-mb: got inf; give a number above 0, at most 1e+06"),
        (["--upload-limit-mb", "much"], "view: --upload-limit-mb: got 'much'; give a number; see --help"),
        (["{folder}/missing.ply"], "{folder}/missing.ply: there is no such file; check the path"),
    ],
)
def test_view_refuses_in_one_line(tmp_path, capsys, args, text):
    scan = tmp_path / "a.ply"
    scan.write_bytes(b"ply")
    names = {"scan": scan, "folder": tmp_path}
    code = cli.main(["view", str(scan), *(arg.format(**names) for arg in args), "--no-browser", "--port", "0"])
    assert code == (3 if "no such file" in text else 2)
    assert capsys.readouterr().err == f"stair-inspector: {text.format(**names)}\n"


def test_view_opens_the_browser_unless_told_not_to(view, monkeypatch):
    opened = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    view()
    assert opened == []
    FakeApp.made = ()
    app, out, _ = view("--browser")
    (address,) = opened
    # The command that opens a browser can be read by everyone on the machine: what it holds is good for once.
    assert address not in out
    assert address.startswith("http://127.0.0.1:8080/?token=")
    call = DoorCall(address.removeprefix("http://127.0.0.1:8080"), {"host": "127.0.0.1:8080"})
    assert [app.options["doors"].ask(call).status for _ in range(2)] == [200, 403]


def test_view_shares_a_second_address_and_says_when_it_lets_everyone_in(view):
    _, out, err = view("--share-view")
    first, second = re.findall(r"http://127\.0\.0\.1:8080(/\S*)", out)
    assert first.startswith("/?token=")
    assert second.startswith(f"{VIEW_PATH}?token=")
    assert first[-43:] not in second
    FakeApp.made = ()
    _, out, err = view("--no-token")
    assert "http://127.0.0.1:8080/ " in out
    assert "--no-token is for tests" in err


def test_a_token_that_is_given_stays_and_a_poor_one_is_refused(view, monkeypatch, capsys):
    token = "5f1c0a7e9b3d4826a1c7e0f4d2b69835"
    monkeypatch.setenv(TOKEN_VARIABLE, token)
    _, out, _ = view()
    assert f"http://127.0.0.1:8080/?token={token} " in out
    monkeypatch.setenv(TOKEN_VARIABLE, "secret")
    assert cli.main(["view", "--no-browser"]) == 2
    assert f"{TOKEN_VARIABLE}: is no token; give 22 to 200 letters" in capsys.readouterr().err


def test_behind_a_proxy_its_address_is_printed_and_nonsense_is_refused(view, capsys):
    _, out, _ = view("--public-address", "https://stairs.example.org/")
    assert "stair-inspector is at https://stairs.example.org/?token=" in out
    for nonsense in ("stairs.example.org", "https://a/b", "ftp://a", "https://"):
        assert cli.main(["view", "--no-browser", "--public-address", nonsense]) == 2
        assert f"--public-address: got {nonsense!r}; give scheme and name alone" in capsys.readouterr().err


def test_the_help_of_view_names_its_options(capsys):
    with pytest.raises(SystemExit) as leaving:
        cli.main(["view", "--help"])
    assert leaving.value.code == 0
    out = capsys.readouterr().out
    assert [
        word
        for word in ("--host", "--port", "--no-browser", "--project-dir", "--upload-limit-mb", "--share-view", "8080")
        if word not in out
    ] == []
