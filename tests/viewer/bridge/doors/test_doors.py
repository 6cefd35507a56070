"""Who is let in, asked of the doors themselves."""

import pytest

from stair_inspector.errors import ConfigError
from stair_inspector.viewer.bridge.doors.doors import DoorCall, Doors, checked_token, new_token

TOKEN = "5f1c0a7e9b3d4826a1c7e0f4d2b69835"
HOST = "127.0.0.1:8080"


def doors(token=TOKEN, at="127.0.0.1", **options):
    made = Doors(token, **options)
    made.stand_at(at)
    return made


def ask(of, path="/", **headers):
    given = {"host": HOST} | {name.replace("_", "-"): value for name, value in headers.items()}
    return of.ask(DoorCall(path, given, given.get("upgrade") == "websocket"))


def cookie(of, address, host=HOST):
    answer = ask(of, address[address.index("/", 8) :], host=host)
    assert answer.status == 200
    return answer.headers["Set-Cookie"].partition(";")[0]


def test_the_token_is_exchanged_for_a_cookie_that_opens_the_page():
    of = doors()
    answer = ask(of, f"/?token={TOKEN}&fixedDpr=1&x=%22%3E")
    kept, *how = answer.headers["Set-Cookie"].split("; ")
    assert how == ["Path=/", "HttpOnly", "SameSite=Strict"]
    assert TOKEN not in kept
    # It goes on without the token, with whatever else was asked for.
    assert 'content="0;url=/?fixedDpr=1&amp;x=%22%3E"' in answer.html
    assert 'content="0;url=/"' in ask(of, f"//evil.example/?token={TOKEN}").html
    for headers in ({}, {"upgrade": "websocket", "origin": f"http://{HOST}"}):
        opened = ask(of, cookie=f"other={{a=1}}; {kept}", **headers)
        assert (opened.html, opened.is_view_only) == (None, False)
        assert ask(of, **headers).status == 403


@pytest.mark.parametrize(
    "wrong", ["", "x", TOKEN[:-1], TOKEN + "0", TOKEN.upper(), "ß", "%00", "\ud800", "5f1c" * 10_000]
)
def test_no_other_token_and_no_other_cookie_is_taken(wrong):
    of = doors(shares_view=True)
    for path in ("/", "/view"):
        answer = ask(of, f"{path}?token={wrong}")
        assert answer.status == 403
        assert "Set-Cookie" not in answer.headers
        assert "is not, or no longer, one of this server" in answer.html
        for name in ("stair_inspector_8080", "stair_inspector_view_8080"):
            assert ask(of, path, cookie=f"{name}={wrong}").status == 403


def test_the_cookie_is_that_of_the_port_that_the_browser_sees():
    of = doors()
    address = of.address(8080)
    kept = {port: cookie(of, address, f"localhost:{port}") for port in (8080, 9000)}
    assert {one.partition("=")[0] for one in kept.values()} == {"stair_inspector_8080", "stair_inspector_9000"}
    assert ask(of, host="localhost:9000", cookie=kept[9000]).html is None
    assert ask(of, host="localhost:9000", cookie=kept[8080]).status == 403
    assert cookie(of, address, "localhost").startswith("stair_inspector_80=")


def test_the_view_only_address_opens_the_view_only_page_alone():
    of = doors(shares_view=True)
    address = of.view_address(8080)
    assert TOKEN not in address
    kept = cookie(of, address)
    answer = ask(of, "/view", cookie=kept)
    assert (answer.html, answer.is_view_only, answer.path) == (None, True, "/")
    assert ask(of, "/view/", cookie=kept, upgrade="websocket").is_view_only
    assert ask(of, "/", cookie=kept).status == 403
    assert ask(of, "/", cookie=kept.replace("_view", "")).status == 403
    assert ask(of, address[address.index("/view") :].replace("/view", "/")).status == 403
    # Whoever may change the work may look at it there too.
    assert ask(of, "/view", cookie=cookie(of, of.address(8080))).is_view_only


def test_without_a_share_there_is_no_view_only_page():
    of = doors()
    assert of.view_address(8080) is None
    for path in ("/view", "/view/?token=" + Doors(TOKEN, shares_view=True).view_address(8080)[-64:]):
        answer = ask(of, path, cookie=cookie(of, of.address(8080)))
        assert (answer.status, "--share-view" in answer.html) == (403, True)


def test_each_server_has_another_token_and_a_given_one_stays():
    assert len({new_token() for _ in range(50)}) == 50
    assert len(new_token()) == 43
    kept = cookie(doors(), doors().address(8080))
    assert ask(doors(), cookie=kept).html is None
    assert ask(doors(new_token()), cookie=kept).status == 403
    for poor in ("", "short", "a" * 21, "a" * 201, "a" * 30 + " ", "ä" * 30):
        with pytest.raises(ConfigError, match="STAIR_INSPECTOR_TOKEN: is no token"):
            checked_token(poor)
    assert checked_token(TOKEN) == TOKEN


def test_what_is_opened_by_the_server_is_good_for_one_visit(monkeypatch):
    of = doors()
    once = of.address_for_once(8080)
    assert TOKEN not in once
    kept = cookie(of, once)
    path = once[once.index("/", 8) :]
    assert ask(of, path).status == 403
    # A browser that is in already comes back to it when it restores its tabs.
    assert ask(of, path, cookie=kept).status == 200
    late = of.address_for_once(8080)
    monkeypatch.setattr("time.monotonic", lambda: 1e12)
    assert ask(of, late[late.index("/", 8) :]).status == 403


@pytest.mark.parametrize(
    ("at", "own", "foreign"),
    [
        (
            "127.0.0.1",
            ["127.0.0.1:8080", "localhost:9000", "LOCALHOST", "[::1]:8080", "127.8.9.10:1"],
            ["evil.example", "evil.example:8080", "192.168.1.20:8080", "127.0.0.1.evil.example", "a@127.0.0.1", ""],
        ),
        ("0.0.0.0", ["192.168.1.20:8080", "[2001:db8::1]:8080", "surveyor", "surveyor.local:8080"], ["evil.example"]),
        ("10.0.0.7", ["10.0.0.7:8080", "localhost:8080"], ["evil.example", "127.0.0.1:99999", "local host"]),
    ],
)
def test_only_the_servers_own_names_are_answered_to(monkeypatch, at, own, foreign):
    monkeypatch.setattr("socket.gethostname", lambda: "Surveyor.example.org")
    for token in (TOKEN, None):
        of = doors(token, at)
        for host in own:
            kept = cookie(of, of.address(8080), host) if token else ""
            assert ask(of, host=host, cookie=kept).html is None, host
        for host in foreign:
            assert "does not go by that name" in ask(of, f"/?token={TOKEN}", host=host).html, host


@pytest.mark.parametrize(
    "origin",
    [
        *(
            "http://evil.example",
            "http://127.0.0.1",
            "http://127.0.0.1:8081",
            "http://localhost:8080",
            "null",
            "",
            "x:8080",
        ),
        *("https://127.0.0.1", "file://", "chrome-extension://127.0.0.1:8080", "http://127.0.0.1:8080.evil.example"),
    ],
)
def test_other_sites_are_refused_also_with_the_cookie_and_without_a_token(origin):
    of = doors()
    kept = cookie(of, of.address(8080))
    for path, headers in (("/", {}), (f"/?token={TOKEN}", {}), ("/", {"upgrade": "websocket"})):
        answer = ask(of, path, cookie=kept, origin=origin, **headers)
        assert (answer.status, "Another site asked" in answer.html) == (403, True)
        assert ask(doors(None), path, origin=origin, **headers).status == 403


def test_what_another_site_puts_into_its_own_page_is_refused_and_a_link_is_followed():
    of = doors()
    kept = cookie(of, of.address(8080))
    for site in ("cross-site", "same-site"):
        seen = {"cookie": kept, "sec_fetch_site": site}
        for mode, dest in (("navigate", "iframe"), ("no-cors", "image"), ("no-cors", "script"), ("cors", "empty")):
            assert ask(of, sec_fetch_mode=mode, sec_fetch_dest=dest, **seen).status == 403
        assert ask(of, sec_fetch_mode="navigate", sec_fetch_dest="document", **seen).html is None


def test_behind_a_proxy_its_name_and_its_origin_are_the_servers_own():
    of = doors(public_address="https://stairs.example.org")
    address = of.address(8080)
    assert address == f"https://stairs.example.org/?token={TOKEN}"
    # Whether the proxy hands on the name it was asked for or not.
    for host in ("stairs.example.org", HOST):
        entered = ask(of, f"/?token={TOKEN}", host=host)
        assert entered.headers["Set-Cookie"].endswith("; Secure")
        kept = entered.headers["Set-Cookie"].partition(";")[0]
        seen = {"host": host, "cookie": kept, "upgrade": "websocket"}
        opened = ask(of, origin="https://stairs.example.org", **seen)
        assert opened.html is None
        assert "wss://stairs.example.org" in opened.headers["Content-Security-Policy"].split()
        assert ask(of, origin="https://other.example.org", **seen).status == 403


def test_every_answer_forbids_frames_guessing_referrers_and_connections_elsewhere():
    of = doors(shares_view=True)
    kept = cookie(of, of.address(8080))
    calls = [ask(of), ask(of, cookie=kept), ask(of, f"/?token={TOKEN}"), ask(of, host="x"), ask(of, origin="http://x")]
    for answer in calls:
        rules = dict(rule.strip().partition(" ")[::2] for rule in answer.headers["Content-Security-Policy"].split(";"))
        assert rules["frame-ancestors"] == rules["default-src"] == rules["form-action"] == "'none'"
        # The page alone runs scripts, and connects to its own server alone.
        assert ("script-src" in rules) == (answer.html is None)
        assert set(rules.get("connect-src", "").split()) <= {"data:", "blob:", f"ws://{HOST}", f"wss://{HOST}"}
        assert answer.headers["X-Content-Type-Options"] == "nosniff"
        assert answer.headers["Referrer-Policy"] == "no-referrer"


def test_what_is_asked_for_is_shown_as_text():
    answer = ask(doors(), host="<img src=x>")
    assert "&lt;img src=x&gt;" in answer.html
    assert "<img" not in answer.html


def test_bytes_that_are_no_text_are_refused_or_replaced_as_any_others():
    of = doors()
    for headers in ({"host": "\udcff"}, {"origin": "\udcff"}, {"cookie": "\udcff=\udcff"}):
        assert ask(of, **headers).status == 403
    assert "Set-Cookie" in ask(of, f"/?token={TOKEN}&a=\udcff").headers


def test_a_cookie_of_our_name_that_another_program_has_set_shuts_nobody_out():
    of = doors()
    kept = cookie(of, of.address(8080))
    name = kept.partition("=")[0]
    for line in (f"{kept}; {name}=x", f"{name}=x; {kept}"):
        assert ask(of, cookie=line).html is None
    assert ask(of, cookie=f"{name}=x; {name}=y").status == 403


@pytest.mark.parametrize(
    "address",
    ["https://[::1", "https://a.b#frag", "https://a.b/path", "https://a.b?x=1", "ftp://a.b", "a.b", "https://"],
)
def test_a_public_address_that_is_none_is_a_sentence(address):
    with pytest.raises(ConfigError, match=r"--public-address: got .*; give scheme and name alone"):
        doors(public_address=address)


def test_the_dot_at_the_end_of_a_public_name_is_none_of_it():
    of = doors(public_address="https://stairs.example.org.:8443/")
    assert of.address(8080) == f"https://stairs.example.org:8443/?token={TOKEN}"
    assert ask(of, f"/?token={TOKEN}", host="stairs.example.org.:8443").status == 200
