"""A page without a browser: it speaks the server's protocol, draws nothing, and keeps what it is told to keep."""

import http.client
import threading
import time
from urllib.parse import urlsplit

import msgspec
import viser
import zstandard
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from stair_inspector.files.simulations import simulate_to_file
from stair_inspector.params import Params
from stair_inspector.simulation.scanner_specs import Scanner
from stair_inspector.simulation.specs import Stair
from stair_inspector.viewer.app import App

SCANNER = Scanner(max_points=6_000, azimuth_step_deg=0.3, elevation_step_deg=0.3, spacing_m=0.01, noise_m=0.002)
STAIR, OTHER = "stair.ply", "other.ply"
SETTLE_S = 60.0
_CAMERA = {
    "type": "ViewerCameraMessage",
    "wxyz": (1.0, 0.0, 0.0, 0.0),
    "position": (0.0, -6.0, 1.0),
    "fov": 0.8,
    "near": 0.01,
    "far": 1000.0,
    "image_height": 600,
    "image_width": 800,
    "look_at": (0.0, 0.0, 0.0),
    "up_direction": (0.0, 0.0, 1.0),
}


def simulate_two_stairs(folder):
    """Write two small scans, STAIR with four risers and OTHER with three; return the folder."""
    for name, n_risers in ((STAIR, 4), (OTHER, 3)):
        simulate_to_file(folder / name, Stair(n_risers=n_risers, floor_front_m=0.8, upper_landing_m=0.6), SCANNER)
    return folder


def serve(folder):
    """A server of the two scans of a folder, which saves nothing beside them."""
    return App([folder / STAIR, folder / OTHER], Params(), port=0, saves_projects=False)


class WirePage:
    """One page of a browser; ``storage`` is what the tabs of that browser share, ``address`` what it opens.

    ``session`` is what the server made for it, and ``tabs`` are the titles of the panel's tabs. A page that is not
    ``is_answering`` is a connection whose far end is
    gone without the server knowing.
    """

    def __init__(self, app, storage=None, address=None):
        self.storage = {} if storage is None else storage
        self.is_answering = True
        self._told = []
        self.tabs = []
        known = set(app._sessions)
        self._socket = connect_page(address or app.address)
        self._send(_CAMERA)
        threading.Thread(target=self._listen, daemon=True).start()
        await_that(lambda: set(app._sessions) - known, "there is no session")
        (client_id,) = set(app._sessions) - known
        self.session = app._sessions[client_id]

    def close(self):
        self._socket.close()

    def await_result(self, label=None):
        """Wait until the result of the present work is shown; return it."""
        session = self.session

        def is_there():
            # All of a result is shown while the desk is held.
            with session.desk.lock:
                shown, wanted = session.desk.shown, session.editor.work.params
                return shown is not None and shown.label == (label or shown.label) and shown.inspection.params == wanted

        await_that(is_there, "there is no result of the present settings")
        return session.desk.shown

    def told(self):
        """Titles and words of the notifications that came."""
        return list(self._told)

    def _listen(self):
        try:
            for frame in self._socket:
                size = int.from_bytes(frame[8:16], "little")
                for message in msgspec.msgpack.decode(zstandard.decompress(frame[16 : 16 + size]))["messages"]:
                    self._take(message)
        except ConnectionClosed:
            return

    def _take(self, message):
        kind = message["type"]
        if kind == "LocalStorageSetItemMessage":
            self.storage[message["key"]] = message["value"]
        elif kind == "LocalStorageGetItemRequestMessage" and self.is_answering:
            self._send(
                {
                    "type": "LocalStorageGetItemResponseMessage",
                    "value": self.storage.get(message["key"]),
                    "error": None,
                    "request_uuid": message["request_uuid"],
                }
            )
        elif kind == "GuiTabGroupMessage":
            self.tabs = list(message["props"]["_tab_labels"])
        elif kind == "GuiUpdateMessage" and "_tab_labels" in message["updates"]:
            self.tabs = list(message["updates"]["_tab_labels"])
        elif kind == "NotificationShowMessage":
            props = message["props"]
            self._told.append(": ".join((props["title"], props["body"])))

    def _send(self, message):
        self._socket.send(msgspec.msgpack.encode(message))


def get(address, headers=()):
    """Ask a server for an address; return the answer's status, its header fields and its body."""
    parts = urlsplit(address)
    connection = http.client.HTTPConnection(parts.hostname, parts.port, timeout=SETTLE_S)
    connection.request("GET", f"{parts.path}?{parts.query}", headers=dict(headers))
    answer = connection.getresponse()
    body = answer.read()
    connection.close()
    return answer.status, answer.headers, body


def cookie_of(address):
    """The cookie that a browser gets for an address with a token."""
    return get(address)[1]["Set-Cookie"].partition(";")[0]


def connect_page(address, **headers):
    """The connection of a page that was opened with its address, as a browser makes it."""
    parts = urlsplit(address)
    given = {"Cookie": cookie_of(address), "Origin": f"http://{parts.netloc}"} | headers
    origin = given.pop("Origin")
    return connect(
        f"ws://{parts.netloc}{parts.path.rstrip('/')}",
        origin=origin,
        additional_headers=given,
        subprotocols=[f"viser-v{viser.__version__}"],
        max_size=None,
    )


def await_that(is_so, otherwise):
    """Wait until a condition holds."""
    ends = time.monotonic() + SETTLE_S
    while not is_so():
        assert time.monotonic() < ends, otherwise
        time.sleep(0.02)
