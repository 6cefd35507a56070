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


@dataclass(frozen=True)
class ViewScans(CommonOptions):
    """Open the web inspector on scans, on folders of scans, or on a bundled sample."""

    scans: Annotated[
        tyro.conf.Positional[tuple[Path, ...]], tyro.conf.arg(metavar="SCAN"), Doc("Files or folders.")
    ] = ()
    host: Annotated[str, Doc("Address to listen on. Anyone who can reach it sees the scans: there is no password.")] = (
        "127.0.0.1"
    )
    port: Annotated[int, Doc("Port to listen on; 0 takes a free one.")] = 8080
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
    from stair_inspector.viewer.app import App, is_loopback

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
        )
        # A wildcard is no address that a browser could open.
        host = "127.0.0.1" if view.host in ("0.0.0.0", "::") else view.host
        address = f"http://[{host}]:{app.port}" if ":" in host else f"http://{host}:{app.port}"
        print(f"stair-inspector is at {address} (Ctrl+C ends it)", flush=True)
        reason = why_not_loadable()
        if reason:
            # Said in the terminal now, not only on the page after the first scan.
            print(f"stair-inspector: note: works without Open3D: {reason}", file=sys.stderr, flush=True)
        if not is_loopback(view.host):
            print(
                f"stair-inspector: warning: everyone who can reach {view.host} sees these scans, can change "
                "projects and upload files; there is no password. Use --host 127.0.0.1 to keep it to this machine",
                file=sys.stderr,
                flush=True,
            )
        if view.browser:
            import webbrowser

            webbrowser.open(address)
        app.wait()
    except KeyboardInterrupt:
        print()
    finally:
        signal.signal(signal.SIGTERM, before)
        if app is not None:
            app.stop()
    return 0


def _basis_of_all(path: Path) -> "ReportBasis":
    """Return what the reports on all stairs begin with."""
    from stair_inspector.content.basis_files import entries_of_one_stair, read_basis

    basis = read_basis(path)
    names = entries_of_one_stair(basis)
    if names:
        shown = ", ".join(names[:5]) + (" and others" if len(names) > 5 else "")
        raise ConfigError(f"view: {path}: belongs to one stair: {shown}; give it on the page, or to measure --report")
    return basis
