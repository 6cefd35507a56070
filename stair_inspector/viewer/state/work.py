"""What an inspector has done on a scan, what of it goes on with the next one, and where it is saved."""

import dataclasses
import datetime
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypedDict

from stair_inspector.content.fields import OF_THE_SURVEYOR, ReportBasis
from stair_inspector.content.pins import PinnedFindings
from stair_inspector.content.project_basis import basis_of, pinned_of
from stair_inspector.files.chosen_rules import ChosenRules
from stair_inspector.files.projects import (
    KeptRun,
    Measurement,
    Project,
    SavedView,
    SecondScan,
    check_entries,
    check_title,
)
from stair_inspector.files.settings import settings_beside
from stair_inspector.overrules import OverrulesParams
from stair_inspector.params import Params
from stair_inspector.viewer.state.history import History


@dataclass(frozen=True, slots=True)
class Work:
    """What can be undone: everything of a :class:`Project` but the scan it belongs to."""

    params: Params
    title: str = ""
    measurements: tuple[Measurement, ...] = ()
    views: tuple[SavedView, ...] = ()
    runs: tuple[KeptRun, ...] = ()
    rules: ChosenRules = field(default_factory=ChosenRules)
    basis: ReportBasis = field(default_factory=ReportBasis)
    findings: PinnedFindings = field(default_factory=PinnedFindings)
    second: SecondScan | None = None

    def __post_init__(self) -> None:
        check_title(self.title)
        for name in ("measurements", "views", "runs"):
            check_entries(name, getattr(self, name))


def work_beside(work: Work, started: Work) -> Work:
    """Return the work that another scan begins with, after that on the scan that is left.

    Settings go on, the rule set with its overlays, decision rule and the user's own rule files, and of the report the
    surveyor, the firm, the instrument, the logo and the paper. All else belongs to the scan, as unit, columns, up and
    overrules and the second scan, or to the stair, as a limit that was changed for a reason.
    """
    params = settings_beside(work.params, dataclasses.replace(started.params, overrules=OverrulesParams()))
    fields = {name: getattr(work.basis.fields, name) for name in OF_THE_SURVEYOR}
    basis = dataclasses.replace(
        started.basis,
        fields=dataclasses.replace(started.basis.fields, **fields),
        logo=work.basis.logo,
        paper=work.basis.paper,
    )
    return Work(params, rules=dataclasses.replace(work.rules, edits=(), left=()), basis=basis)


@dataclass(frozen=True, slots=True)
class Arrival:
    """A scan that was opened without saved work: which was open before, and with which settings and rules it began."""

    source: str
    params: Params
    rules: ChosenRules


class Changes(TypedDict, total=False):
    """Fields of :class:`Work` that are to be other ones."""

    params: Params
    title: str
    measurements: tuple[Measurement, ...]
    views: tuple[SavedView, ...]
    runs: tuple[KeptRun, ...]
    rules: ChosenRules
    basis: ReportBasis
    findings: PinnedFindings
    second: SecondScan | None


@dataclass(slots=True)
class Bench:
    """One scan's place in the workshop of a page.

    ``scan`` is its file and ``sha256`` that of the bytes which the work was done on, empty while unknown, and only what
    a saved project says while ``is_from_file``. ``path`` is where the project is saved, None for nowhere; ``state`` is
    what :func:`~stair_inspector.viewer.state.library.state_of` said of it when this page last read or wrote it.
    ``error`` is the sentence of a save that failed, until one succeeds. ``last`` are the settings that the saved work
    had when it was taken up, None where there was none.
    """

    scan: Path
    history: History[Work]
    path: Path | None = None
    state: str = ""
    sha256: str = ""
    is_from_file: bool = False
    is_changed: bool = False
    saved_at: datetime.datetime | None = None
    error: str = ""
    last: Params | None = None

    def copy(self) -> "Bench":
        """Return the same state, which goes on by itself from here."""
        return dataclasses.replace(self, history=self.history.copy())


def work_of(project: Project) -> Work:
    """Return the work that a project holds.

    Raises
    ------
    ConfigError
        What it keeps for the report, or its findings, are not possible.
    """
    return Work(
        project.params,
        project.title,
        project.measurements,
        project.views,
        project.runs,
        project.rules,
        basis_of(project),
        pinned_of(project),
        project.second,
    )
