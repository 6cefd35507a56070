"""``stair-inspector view``: the web inspector."""

import signal
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro
from typing_extensions import Doc

from stair_inspector.cli.arguments import CommonOptions, check_folder, parse_arguments, preset_params
from stair_inspector.errors import ConfigError

if TYPE_CHECKING:
    from stair_inspector.content.fields import ReportBasis
    from stair_inspector.viewer.bridge.doors.doors import Doors


@dataclass(frozen=True)
class ViewScans(CommonOptions):
    """Open the web inspector on scans, on folders of scans, or on a bundled sample."""

    scans: Annotated[
        tyro.conf.Positional[tuple[Path, ...]], tyro.conf.arg(metavar="SCAN"), Doc("Files or folders.")
    ] = ()
    host: Annotated[str, Doc("Address to listen on; beyond 127.0.0.1 the token and the scans travel in the clear.")] = (
        "127.0.0.1"
    )
    port: Annotated[int, Doc("Port to listen on; 0 takes a free one.")] = 8080
    share_view: Annotated[bool, Doc("Print a second address, for those who may see everything and change nothing.")] = (
        False
    )
    public_address: Annotated[
        str,
        tyro.conf.arg(metavar="URL"),
        Doc("Where a reverse proxy with TLS shows the page, as https://stairs.example.org; '' without one."),
    ] = ""
    token: Annotated[bool, Doc("Let in only who has the token of the printed address; --no-token is for tests.")] = True
    browser: Annotated[bool, Doc("Open the page in the system's browser.")] = True
    project_dir: Annotated[
        str,
        tyro.conf.arg(metavar="DIR"),
        Doc("Folder for the projects, in which everything an inspector changes is saved; '' is beside each scan."),
    ] = ""
    autosave: Annotated[bool, Doc("Save projects; without it they are kept until the server ends.")] = True
    upload_limit_mb: Annotated[float, Doc("Largest scan that a page may upload, megabytes.")] = 500.0
    fields: Annotated[
        str,
        tyro.conf.arg(metavar="FILE.toml"),
        Doc("What the report on every scan begins with: firm, surveyor, instrument, client, site, building, logo."),
    ] = ""


def run(args: list[str]) -> int:
    """Serve the page until it is interrupted; return the exit code."""
    view = parse_arguments(ViewScans, "view", args, ViewScans(settings=preset_params(args)))
    from stair_inspector.files.paths import sample_scans
    from stair_inspector.files.scans import find_scans
    from stair_inspector.geometry.open3d import why_not_loadable
    from stair_inspector.simulation.samples import DEFAULT_SAMPLE

    if view.project_dir:
        check_folder(Path(view.project_dir), "--project-dir")
    basis = _basis_of_all(Path(view.fields)) if view.fields else None
    found = find_scans(view.scans or [sample_scans()])
    # Folders are handed over as such: the page looks into them again.
    paths = list(view.scans) or sorted(found, key=lambda path: path.stem != DEFAULT_SAMPLE)
    from stair_inspector.viewer.app import App
    from stair_inspector.viewer.bridge.doors.doors import is_loopback

    doors = _doors(view)
    # A service manager ends a program so; the heavy process must not be left behind.
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    app = None
    try:
        app = App(
            paths,
            view.settings,
            view.host,
            view.port,
            project_dir=Path(view.project_dir) if view.project_dir else None,
            saves_projects=view.autosave,
            upload_limit_mb=view.upload_limit_mb,
            basis=basis,
            doors=doors,
        )
        print(f"stair-inspector is at {doors.address(app.port)} (Ctrl+C ends it)", flush=True)
        shared = doors.view_address(app.port)
        if shared is not None:
            print(f"view only, to be shared: {shared}", flush=True)
        reason = why_not_loadable()
        if reason:
            # Said in the terminal now, not only on the page after the first scan.
            print(f"stair-inspector: note: works without Open3D: {reason}", file=sys.stderr, flush=True)
        if not is_loopback(view.host):
            _warn(
                f"what is sent to and from {view.host} can be read on the way, the token too: put a proxy with TLS in "
                "front of 127.0.0.1 instead, or go through SSH"
            )
        if not view.token:
            _warn("--no-token is for tests: everyone who can reach this address sees, changes and uploads")
        if view.browser:
            import webbrowser

            webbrowser.open(doors.address_for_once(app.port))
        app.wait()
    except KeyboardInterrupt:
        print()
    finally:
        signal.signal(signal.SIGTERM, before)
        if app is not None:
            app.stop()
    return 0


def _doors(view: ViewScans) -> "Doors":
    """Return who is let in."""
    import os

    from stair_inspector.viewer.bridge.doors.doors import TOKEN_VARIABLE, Doors, checked_token, new_token

    given = os.environ.get(TOKEN_VARIABLE)
    token = checked_token(given) if given else new_token()
    return Doors(token if view.token else None, shares_view=view.share_view, public_address=view.public_address)


def _warn(words: str) -> None:
    print(f"stair-inspector: warning: {words}", file=sys.stderr, flush=True)


def _basis_of_all(path: Path) -> "ReportBasis":
    """Return what the reports on all stairs begin with."""
    from stair_inspector.content.basis_files import entries_of_one_stair, read_basis

    basis = read_basis(path)
    names = entries_of_one_stair(basis)
    if names:
        shown = ", ".join(names[:5]) + (" and others" if len(names) > 5 else "")
        raise ConfigError(f"view: {path}: belongs to one stair: {shown}; give it on the page, or to measure --report")
    return basis
