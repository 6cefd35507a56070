"""The options of the commands that write a survey report."""

import os
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro
from typing_extensions import Doc

from stair_inspector.cli.arguments import check_folder
from stair_inspector.errors import ConfigError

_STATED_TIME = "SOURCE_DATE_EPOCH"

if TYPE_CHECKING:
    from stair_inspector.content.fields import ReportBasis
    from stair_inspector.content.short import ReportLength
    from stair_inspector.files.projects import Project


@dataclass(frozen=True)
class ReportOptions:
    """Whether a report is written, how long it is, and what only the surveyor knows."""

    report: Annotated[
        tyro.conf.FlagCreatePairsOff[bool],
        Doc(
            "Write the survey report too: DIR/STEM_report.pdf, .html and .xlsx, STEM_plan.dxf and STEM_section.dxf; "
            "it is dated now, or at the seconds since 1970 in the environment variable SOURCE_DATE_EPOCH."
        ),
    ] = False
    full_report: Annotated[
        tyro.conf.FlagCreatePairsOff[bool],
        Doc(
            "Write the report in full, some 14 pages, and not the short one of one page of result and two of evidence."
        ),
    ] = False
    fields: Annotated[
        str,
        tyro.conf.arg(metavar="FILE.toml"),
        Doc("What only the surveyor knows, for the report: names, dates, instrument, tape readings, logo."),
    ] = ""


def length_asked_for(options: ReportOptions) -> "ReportLength":
    """Return how long the report is."""
    return "full" if options.full_report else "short"


def basis_asked_for(
    options: ReportOptions, command: str, project: "Project | None" = None, project_name: str = ""
) -> "ReportBasis | None":
    """Return what the report takes from the user; None where no report is wanted; ``project_name`` is its file."""
    if not (options.report or options.full_report):
        if options.fields:
            raise ConfigError(f"{command}: got --fields without --report; give both")
        return None
    from stair_inspector.content.basis_files import read_basis
    from stair_inspector.content.fields import ReportBasis
    from stair_inspector.content.project_basis import basis_of, titled

    if project is None:
        return read_basis(Path(options.fields)) if options.fields else ReportBasis()
    basis = read_basis(Path(options.fields)) if options.fields else basis_of(project, project_name)
    return titled(basis, project.title)


def report_folder(options: ReportOptions, out: str, command: str, basis: "ReportBasis | None") -> Path | None:
    """Return the folder for the files, checked before the work; None where none are written.

    Raises
    ------
    ConfigError
        A report is wanted and no folder was given.
    WriteError
        It cannot be written.
    """
    if out:
        check_folder(Path(out))
        return Path(out)
    if basis is not None:
        flag = "--full-report" if options.full_report else "--report"
        raise ConfigError(f"{command}: got {flag} without a folder; name one with -o")
    return None


def is_time_stated() -> bool:
    """Return whether ``SOURCE_DATE_EPOCH`` states a time, as reproducible builds do."""
    return bool(os.environ.get(_STATED_TIME))


def time_of_report() -> datetime:
    """Return when a report is made: now, or the time that reproducible builds state in ``SOURCE_DATE_EPOCH``."""
    stated = os.environ.get(_STATED_TIME, "")
    if not stated:
        return datetime.now().astimezone()
    try:
        return datetime.fromtimestamp(int(stated), UTC)
    except (ValueError, OverflowError, OSError) as error:
        raise ConfigError(f"{_STATED_TIME}: got {stated[:60]!r}; give whole seconds since 1970") from error
