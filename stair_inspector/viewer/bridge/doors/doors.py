"""Who is let in: by the token of the address, then by a cookie; and no page of another site, by whatever name.

A token is exchanged for a cookie that no script reads (HttpOnly) and no other site sends (SameSite=Strict). Cookies are
shared by all ports of a host, so theirs is named by the port that the browser sees. Other ports of the host are the
same site to a browser, hence the checks of Origin and of Sec-Fetch-Site; and a name that another site has made to mean
this machine is stopped by the check of Host.
"""

import contextlib
import hashlib
import hmac
import ipaddress
import re
import secrets
import socket
import time
from collections.abc import Mapping
from dataclasses import dataclass
from urllib.parse import parse_qsl, urlencode, urlsplit

from stair_inspector.errors import ConfigError
from stair_inspector.viewer.bridge.doors.words import enter_html, not_let_in_html, refused_html

VIEW_PATH = "/view"
"""Of the view-only page."""
TOKEN_VARIABLE = "STAIR_INSPECTOR_TOKEN"
"""Of the environment: a token that stays when the server is started again."""
_GIVEN_TOKEN = re.compile(r"[A-Za-z0-9_-]{22,200}")
_ONCE_S = 120.0
_USUAL_PORTS = {"http": 80, "https": 443}
_POLICY = "Content-Security-Policy"
_HEADERS = {
    _POLICY: "default-src 'none'; style-src 'unsafe-inline'; img-src data: blob:; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cache-Control": "no-store",
}
"""Of every answer."""


@dataclass(frozen=True, slots=True)
class DoorCall:
    """What a browser asks for: header fields by their names in small letters, each of those that may stand once."""

    path: str
    headers: Mapping[str, str]
    is_websocket: bool = False


@dataclass(frozen=True, slots=True)
class DoorAnswer:
    """Whether a call is let in, and if not, what it is told.

    ``path`` is what the page's server is to be asked for, ``html`` the whole answer where it is not asked, and
    ``headers`` are what every answer carries.
    """

    headers: Mapping[str, str]
    path: str = "/"
    is_view_only: bool = True
    status: int = 200
    html: str | None = None


class Doors:
    """The doors of one server.

    Parameters
    ----------
    token : str, optional
        What the address holds; None lets everyone in who can reach the server.
    shares_view : bool
        Whether there is a view-only page, at :data:`VIEW_PATH`, with a token of its own.
    public_address : str
        Where a reverse proxy shows the server, as ``https://stairs.example.org``; empty without one.

    Raises
    ------
    ConfigError
        The public address is none.
    """

    def __init__(self, token: str | None, *, shares_view: bool = False, public_address: str = "") -> None:
        self._token = token
        self._view_token = _derived(token, "view token") if token and shares_view else None
        self._shares_view = shares_view
        self._public = _checked_address(public_address) if public_address else ""
        self._once: dict[str, float] = {}
        self._host = ""

    def stand_at(self, host: str) -> None:
        """Tell on which address of this machine the server listens."""
        self._host = host

    def address(self, port: int) -> str:
        """Return what to open in a browser to be let in."""
        return self._shown(port, "/", self._token)

    def view_address(self, port: int) -> str | None:
        """Return what to give to those who may see all and change nothing; None where nothing is shared."""
        return self._shown(port, VIEW_PATH, self._view_token) if self._shares_view else None

    def address_for_once(self, port: int) -> str:
        """Return what is good for one visit: the command that opens a browser can be read by all users of a machine."""
        if self._token is None:
            return self.address(port)
        once = secrets.token_urlsafe(32)
        self._once[once] = time.monotonic() + _ONCE_S
        return self._shown(port, "/", once)

    def ask(self, call: DoorCall) -> DoorAnswer:
        """Return what to do with a call."""
        place = _place(call.headers.get("host", ""), "http")
        if place is None or not self._is_own_name(place[0]):
            return _refused("host", call.headers.get("host", ""))
        origin = call.headers.get("origin")
        is_foreign = origin is not None and not self._is_own_origin(origin, call.headers["host"])
        if is_foreign or _is_fetched_by_another_site(call.headers):
            return _refused("origin", origin or "")
        path, _, query = call.path.partition("?")
        path = path.rstrip("/") or "/"
        is_view = path == VIEW_PATH
        # Whatever was asked for, what an answer leads on to is one of the two pages.
        page = VIEW_PATH if is_view else "/"
        if is_view and not self._shares_view:
            return _refused("view", "")
        own = {call.headers["host"], urlsplit(self._public).netloc or call.headers["host"]}
        let_in = DoorAnswer(_page_headers(own), "/" if is_view else call.path, is_view)
        if self._token is None:
            return let_in
        entries = parse_qsl(query, keep_blank_values=True)
        token = next((value for name, value in entries if name == "token"), None)
        cookies = _cookies_of(call.headers.get("cookie", ""))
        is_known = any(
            _is_same(given, value)
            for name, value in self._cookies(place[1], is_view=is_view)
            for given in cookies.get(name, ())
        )
        if is_known and (call.is_websocket or token is None):
            return let_in
        is_right = token is not None and not call.is_websocket and self._is_token(token, is_view=is_view)
        if not (is_right or is_known):
            return DoorAnswer(_HEADERS, status=403, html=not_let_in_html(page, has_token=token is not None))
        rest = urlencode([(name, value) for name, value in entries if name != "token"], errors="replace")
        headers = dict(_HEADERS)
        if is_right:
            name, value = self._cookies(place[1], is_view=is_view)[0]
            secure = "; Secure" if self._public.startswith("https:") else ""
            headers["Set-Cookie"] = f"{name}={value}; Path=/; HttpOnly; SameSite=Strict{secure}"
        return DoorAnswer(headers, html=enter_html(f"{page}?{rest}" if rest else page))

    def _shown(self, port: int, path: str, token: str | None) -> str:
        # A wildcard is no address that a browser could open.
        host = "127.0.0.1" if self._host in ("", "0.0.0.0", "::") else self._host
        address = self._public or (f"http://[{host}]:{port}" if ":" in host else f"http://{host}:{port}")
        return f"{address}{path}" + (f"?token={token}" if token else "")

    def _cookies(self, port: int, *, is_view: bool) -> list[tuple[str, str]]:
        """Return the cookies that open a page, with their values, that of its own token first."""
        own = (f"stair_inspector_{port}", _derived(self._token or "", "cookie"))
        view = (f"stair_inspector_view_{port}", _derived(self._token or "", "view cookie"))
        return [view, own] if is_view else [own]

    def _is_token(self, token: str, *, is_view: bool) -> bool:
        if is_view:
            return _is_same(token, self._view_token or "")
        ends = next((once for once in self._once if _is_same(token, once)), None)
        if ends is not None:
            return self._once.pop(ends, -1.0) > time.monotonic()
        return _is_same(token, self._token or "")

    def _is_own_name(self, name: str) -> bool:
        """Return whether a server that listens where this one does is called so."""
        if name in ("localhost", self._host.lower(), urlsplit(self._public).hostname):
            return True
        is_open = not is_loopback(self._host)
        if _is_ip(name):
            # Nobody can make another address mean this machine, as can be done with a name.
            return is_open or is_loopback(name)
        return is_open and _is_machine(name)

    def _is_own_origin(self, origin: str, host: str) -> bool:
        scheme, _, asking = origin.lower().partition("://")
        if scheme not in _USUAL_PORTS or _place(asking, scheme) is None:
            return False
        # The port is compared too: what another program shows at another port of this machine is another site. Where
        # none is named it is the usual one of the scheme, also when a proxy has spoken TLS.
        return origin.lower() == self._public or _place(asking, scheme) == _place(host, scheme)


def new_token() -> str:
    """Return a token that nobody can guess: 256 bits."""
    return secrets.token_urlsafe(32)


def checked_token(token: str) -> str:
    """Return a token that was given, if it can be one.

    Raises
    ------
    ConfigError
        It is too short, or holds what an address cannot.
    """
    if not _GIVEN_TOKEN.fullmatch(token):
        raise ConfigError(
            f"{TOKEN_VARIABLE}: is no token; give 22 to 200 letters, digits, - and _ that nobody can guess, as of "
            "openssl rand -hex 16"
        )
    return token


def is_loopback(host: str) -> bool:
    """Return whether only programs of this machine can reach the host address."""
    if host == "localhost":
        return True
    return _is_ip(host) and ipaddress.ip_address(host).is_loopback


def _checked_address(address: str) -> str:
    """Return a public address without its last slash, and without the dot that may end a name."""
    with contextlib.suppress(ValueError):
        parts = urlsplit(address)
        scheme = parts.scheme.lower()
        place = _place(parts.netloc, scheme) if scheme in _USUAL_PORTS else None
        if place is not None and not (parts.path.strip("/") or parts.query or parts.fragment):
            name, _, port = parts.netloc.lower().rpartition(":") if parts.port else (parts.netloc.lower(), "", "")
            return f"{scheme}://{name.rstrip('.')}{f':{port}' if port else ''}"
    raise ConfigError(
        f"--public-address: got {address[:80]!r}; give scheme and name alone, as https://stairs.example.org"
    )


def _derived(token: str, use: str) -> str:
    """Return a secret that tells nothing of the token, and is the same when the token is."""
    return hmac.new(token.encode(), use.encode(), hashlib.sha256).hexdigest()


def _is_same(given: str, kept: str) -> bool:
    """Compare in a time that does not tell how much of it is right; nothing is never right."""
    return bool(kept) and hmac.compare_digest(given.encode("utf-8", "replace"), kept.encode())


def _place(text: str, scheme: str) -> tuple[str, int] | None:
    """Return the name and the port of a Host or an origin; None for what is neither."""
    if not re.fullmatch(r"[A-Za-z0-9.\-]+(:[0-9]{1,5})?|\[[0-9A-Fa-f:.]+\](:[0-9]{1,5})?", text):
        return None
    try:
        parts = urlsplit(f"//{text}")
        port = parts.port
    except ValueError:
        return None
    return (parts.hostname or "").rstrip("."), port or _USUAL_PORTS[scheme]


def _is_ip(name: str) -> bool:
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True


def _is_machine(name: str) -> bool:
    """Return whether a name is that of this machine, without asking anybody outside it."""
    own = socket.gethostname().lower()
    return name in (own, own.partition(".")[0], f"{own.partition('.')[0]}.local")


def _is_fetched_by_another_site(headers: Mapping[str, str]) -> bool:
    """Return whether a page of another site asks for what is no page of its own: a frame, an image, a script."""
    is_page = (headers.get("sec-fetch-mode"), headers.get("sec-fetch-dest")) == ("navigate", "document")
    return headers.get("sec-fetch-site") in ("cross-site", "same-site") and not is_page


def _cookies_of(line: str) -> dict[str, list[str]]:
    """Return the values of each cookie of a header; another program of the host may have set one of the same name."""
    found: dict[str, list[str]] = {}
    for part in line.split(";"):
        name, _, value = part.strip().partition("=")
        found.setdefault(name, []).append(value)
    return found


def _page_headers(hosts: set[str]) -> dict[str, str]:
    """Return what the answer with the page carries: it may connect to the hosts that are its server, and nowhere else.

    viser's page is one file of scripts, which also makes some of its own from text.
    """
    policy = (
        f"{_HEADERS[_POLICY]}; script-src 'unsafe-inline' 'unsafe-eval'; font-src data:; worker-src data: blob:; "
        f"connect-src data: blob: {' '.join(f'ws://{host} wss://{host}' for host in sorted(hosts))}"
    )
    return _HEADERS | {_POLICY: policy}


def _refused(kind: str, name: str) -> DoorAnswer:
    return DoorAnswer(_HEADERS, status=403, html=refused_html(kind, name))
