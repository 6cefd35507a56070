"""The second scan that a project remembers: found again, measured and compared without a browser."""

from pathlib import Path
from typing import TYPE_CHECKING

from stair_inspector.cli.output import report_error
from stair_inspector.errors import ReadError, StairError

if TYPE_CHECKING:
    from stair_inspector.files.projects import Project, SecondScan
    from stair_inspector.model import ComparedScan, Inspection, Scan
    from stair_inspector.params import Params


def compared_or_told(
    project: "Project | None", project_file: str, scan: "Scan", inspection: "Inspection"
) -> "tuple[ComparedScan | None, int]":
    """Return what changed against the second scan of a project, and the exit code: all else is done without it too.

    None without a second scan, with the paper's method, whose values have no uncertainty, and where what is in the way
    has been told.
    """
    if project is None or project.second is None or inspection.params.method != "survey":
        return None, 0
    try:
        return _compared(project.second, project_file, scan, inspection), 0
    except StairError as error:
        return None, report_error(error)


def _compared(second: "SecondScan", project_file: str, scan: "Scan", inspection: "Inspection") -> "ComparedScan":
    from stair_inspector.comparison.compare import compare_scans
    from stair_inspector.files.scans import read_scan
    from stair_inspector.files.settings import settings_beside
    from stair_inspector.model import ComparedScan
    from stair_inspector.pipeline import inspect

    path = _found(second, Path(project_file), scan.name)
    settings = settings_beside(inspection.params, _own_params(second, path))
    other = read_scan(path, *settings.reading)
    if other.sha256 != second.sha256:
        raise ReadError(
            f"{path}: has changed since the project {project_file} was compared with it; compare anew on the page, or "
            "end the comparison there"
        )
    ours, theirs = (scan, inspection), (other, inspect(other, settings))
    earlier, later = (theirs, ours) if second.is_earlier else (ours, theirs)
    return ComparedScan(compare_scans(*earlier, *later), is_earlier=not second.is_earlier)


def _own_params(second: "SecondScan", path: Path) -> "Params":
    """Return what was set for the second scan by itself, as its unit and up: in its own project beside it, if any."""
    from stair_inspector.files.project_files import read_project
    from stair_inspector.files.projects import autosave_path
    from stair_inspector.params import Params

    kept = autosave_path(path)
    if not kept.is_file():
        return Params()
    own = read_project(kept)
    return own.params if own.scan_sha256 == second.sha256 else Params()


def _found(second: "SecondScan", project_file: Path, scan_name: str) -> Path:
    from stair_inspector.files.raw_cloud import excerpt

    # The scan of the project lies beside it, and the second one may have its name in a folder of its own.
    places = [Path(second.file)]
    if second.name != scan_name:
        places.append(project_file.parent / second.name)
    for path in places:
        try:
            if path.is_file():
                return path
        except (OSError, ValueError):
            # A name longer than the system allows, or with a zero byte.
            continue
    raise ReadError(
        f"{excerpt(second.file, len(second.file))}: this second scan of the project {project_file} is neither there "
        "nor beside the project; put it there, or end the comparison on the page"
    )
