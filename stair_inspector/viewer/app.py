"""The web server: where it listens, whom it lets in, and a session for every page."""

import contextlib
import io
import os
import socket
import threading
from collections.abc import Sequence
from pathlib import Path

import viser

from stair_inspector.content.fields import ReportBasis
from stair_inspector.errors import ConfigError
from stair_inspector.files.palettes import read_palette
from stair_inspector.params import Params
from stair_inspector.pictures.cameras import FOV_RAD
from stair_inspector.viewer.bridge.doors.doors import Doors, new_token
from stair_inspector.viewer.bridge.doors.gate import guarded
from stair_inspector.viewer.bridge.doors.words import VIEW_ONLY
from stair_inspector.viewer.bridge.server import close_connection, is_view_only, prepare_client, prepare_server
from stair_inspector.viewer.bridge.uploads import UnfinishedUploads, limit_uploads
from stair_inspector.viewer.bridge.values import check_values
from stair_inspector.viewer.compute.workshop import Workshop
from stair_inspector.viewer.page import Page
from stair_inspector.viewer.parts.desk import USUAL_PALETTE
from stair_inspector.viewer.state.library import DEFAULT_UPLOAD_LIMIT_MB, Library
from stair_inspector.viewer.state.wishes import KeptWishes
from stair_inspector.viewer.state.work import Work

PALETTES = {
    USUAL_PALETTE: ("page", "page_dark"),
    "distinct": ("distinct", "distinct_dark"),
    "the paper's": ("paper", "paper_dark"),
}
"""Files of colours by their name on the page, for the light and the dark theme."""


_UPLOADS_AT_A_TIME = 2
"""So many of the largest uploads may be under way together."""


class App:
    """A running inspector.

    Parameters
    ----------
    scans : sequence of Path
        Files and folders that can be chosen; at least one. The first scan is opened.
    params : Params
        Settings every page begins with.
    basis : ReportBasis, optional
        What every report begins with, as firm, surveyor, instrument and logo.
    host, port
        Where to listen; port 0 takes a free one.
    project_dir : Path, optional
        Where projects are saved; None is beside each scan.
    saves_projects : bool
        False keeps what inspectors change in memory only.
    upload_limit_mb : float
        Largest upload, megabytes.
    doors : Doors, optional
        Who is let in; without any, whoever has the token of :attr:`address`.

    Raises
    ------
    ConfigError
        The port is taken, or the host is no address of this machine.
    """

    def __init__(
        self,
        scans: Sequence[Path],
        params: Params,
        host: str = "127.0.0.1",
        port: int = 8080,
        *,
        project_dir: Path | None = None,
        saves_projects: bool = True,
        upload_limit_mb: float = DEFAULT_UPLOAD_LIMIT_MB,
        basis: ReportBasis | None = None,
        doors: Doors | None = None,
    ) -> None:
        self._port = _check_address(host, port)
        self._doors = doors or Doors(new_token())
        self._doors.stand_at(host)
        self._library = Library(scans, project_dir, saves_projects=saves_projects, upload_limit_mb=upload_limit_mb)
        self._unfinished = UnfinishedUploads(_UPLOADS_AT_A_TIME * self._library.upload_limit_bytes)
        self._started = Work(params, basis=basis or ReportBasis())
        self._palettes = {name: (read_palette(light), read_palette(dark)) for name, (light, dark) in PALETTES.items()}
        self._kept = KeptWishes(self._library.forget_upload)
        self._sessions: dict[int, Page] = {}
        self._lock = threading.Lock()
        self._ended = threading.Event()
        self._workshop = Workshop()
        # It would take precedence over the port that was asked for and checked.
        os.environ.pop("_VISER_PORT_OVERRIDE", None)
        # viser prints a banner of its own, whatever ``verbose`` says.
        with contextlib.redirect_stdout(io.StringIO()), guarded(self._doors):
            self._server = viser.ViserServer(host=host, port=self._port, verbose=False)
        # The address must be known to whoever prints it: viser moves to another port when its own is taken.
        self._port = self._server.get_port()
        prepare_server(self._server)
        self._server.gui.configure_theme(show_logo=False, show_share_button=False)
        self._server.initial_camera.fov = FOV_RAD
        # Nothing in the scene mirrors or casts a shadow; both cost seconds where there is no graphics card.
        self._server.scene.configure_environment_map(None)
        self._server.scene.configure_default_lights(enabled=True, cast_shadow=False)
        self._server.on_client_connect(self._connect)
        self._server.on_client_disconnect(self._disconnect)

    @property
    def port(self) -> int:
        """The port that is really listened on."""
        return self._port

    @property
    def address(self) -> str:
        """What a browser opens to be let in."""
        return self._doors.address(self._port)

    @property
    def view_address(self) -> str | None:
        """What a browser opens to see everything and change nothing; None where nothing is shared."""
        return self._doors.view_address(self._port)

    @property
    def n_sessions(self) -> int:
        """How many pages are open."""
        with self._lock:
            return len(self._sessions)

    def wait(self) -> None:
        """Block until :meth:`stop`."""
        # In slices, so that Ctrl+C is noticed on every system.
        while not self._ended.wait(0.5):
            pass

    def stop(self) -> None:
        """End the server, all sessions and the heavy process."""
        with self._lock:
            sessions, self._sessions = list(self._sessions.values()), {}
        for session in sessions:
            session.close()
        self._workshop.close()
        self._library.close()
        with contextlib.redirect_stdout(io.StringIO()):
            self._server.stop()
        self._ended.set()

    def _connect(self, client: viser.ClientHandle) -> None:
        prepare_client(client)
        check_values(client)
        is_viewer = is_view_only(self._server, client)
        limit_uploads(client, self._library.check_upload, self._unfinished, VIEW_ONLY if is_viewer else "")
        session = Page(
            client,
            self._workshop,
            self._library,
            self._started,
            self._palettes,
            self._kept,
            lambda: self._drop(client),
            is_viewer,
        )
        with self._lock:
            self._sessions[client.client_id] = session
        # The page may have gone while its session was being made.
        if client.client_id not in self._server.get_clients():
            self._disconnect(client)

    def _drop(self, client: viser.ClientHandle) -> None:
        """Close the page of a browser that does not answer; one that is only slow connects again by itself."""
        self._disconnect(client)
        close_connection(self._server, client)

    def _disconnect(self, client: viser.ClientHandle) -> None:
        with self._lock:
            session = self._sessions.pop(client.client_id, None)
        self._unfinished.forget(client.client_id)
        if session is not None:
            session.close()


def _check_address(host: str, port: int) -> int:
    """Try to bind before viser does, which hangs on a bad host and moves on from a busy port; return the port."""
    if not host:
        raise ConfigError("--host: is empty; give an address of this machine such as 127.0.0.1")
    if not 0 <= port <= 65535:
        raise ConfigError(f"--port: got {port}; give 0 to 65535")
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(
            host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
        )[0]
    except (socket.gaierror, UnicodeError) as error:
        raise ConfigError(
            f"--host: {host[:80]!r} is not known; give an address of this machine such as 127.0.0.1"
        ) from error
    with socket.socket(family, kind, protocol) as probe:
        # A port that the last server has just left counts as free, as it will for the real socket.
        if os.name == "posix":
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind(address)
            probe.listen(1)
        except PermissionError as error:
            raise ConfigError(
                f"--port: {port} needs special rights; choose one above 1023, or 0 for a free one"
            ) from error
        except OSError as error:
            if error.errno in (98, 48, 10048):
                raise ConfigError(
                    f"--port: {port} on {host} is in use by another program; choose another, or 0 for a free one"
                ) from error
            raise ConfigError(f"--host: cannot listen on {host[:80]!r} ({error.strerror}); try 127.0.0.1") from error
        return int(probe.getsockname()[1])
