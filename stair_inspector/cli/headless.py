"""What the commands share that measure without a browser: their options, which scans, which rules, what is written."""

import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro
from typing_extensions import Doc

from stair_inspector.cli.arguments import CommonOptions, value_of
from stair_inspector.cli.output import internal_words, report_error
from stair_inspector.cli.report_options import ReportOptions, is_time_stated
from stair_inspector.codes.findings import Decision
from stair_inspector.errors import CannotMeasure, ConfigError, ReadError, StairError

if TYPE_CHECKING:
    from stair_inspector.codes import Check, RuleSet
    from stair_inspector.content.fields import ReportBasis
    from stair_inspector.content.pins import PinnedFindings
    from stair_inspector.content.short import ReportLength
    from stair_inspector.files.projects import Project
    from stair_inspector.model import ComparedScan, Inspection, Scan
    from stair_inspector.writers.segmented import SegmentedFormat


@dataclass(frozen=True)
class Headless(ReportOptions, CommonOptions):
    """Options of the commands that measure without a browser."""

    scans: Annotated[
        tyro.conf.Positional[tuple[Path, ...]], tyro.conf.arg(metavar="SCAN"), Doc("Files or folders of scans.")
    ] = tyro.MISSING
    project: Annotated[
        str,
        Doc(
            "Project file of the web inspector: its settings and overrules instead of a preset's, its rules, its "
            "findings and what it holds for the report; other flags change its values. Only the scan that it was made "
            "on is measured; without a SCAN the one beside it."
        ),
    ] = ""
    rules: Annotated[
        str, tyro.conf.arg(metavar="ID|FILE"), Doc("Rule set (see: stair-inspector rules) or a TOML file of one.")
    ] = ""
    overlay: Annotated[
        tyro.conf.UseAppendAction[tuple[str, ...]],
        tyro.conf.arg(metavar="ID|FILE"),
        Doc("Rules to be held against beside those of the set, as us-nfpa-101-uniformity; may be given again."),
    ] = ()
    decision: Annotated[
        Decision,
        Doc("guarded: a value nearer to its limit than its uncertainty is called close; simple: the value decides."),
    ] = "guarded"
    stability: Annotated[
        tyro.conf.FlagCreatePairsOff[bool],
        Doc("Measure again one notch of theta_th, eps_z and m to each side, and note every value that moves beyond u."),
    ] = False


def given_project(command: str, args: list[str]) -> "Project | None":
    """Return the project that the arguments name, None for none."""
    name = value_of(args, "--project")
    if not name:
        return None
    if value_of(args, "--preset") is not None:
        raise ConfigError(f"{command}: got --project and --preset, which both state every setting; give one of them")
    from stair_inspector.files.project_files import read_project

    return read_project(Path(name))


def rules_of(
    args: list[str], options: Headless, command: str, project: "Project | None"
) -> "tuple[RuleSet, Decision] | None":
    """Return the rule set that the options name, or else the project's, with its overlays, and the decision rule."""
    from stair_inspector.codes import overlaid
    from stair_inspector.files.chosen_rules import rule_set_of
    from stair_inspector.files.rule_sets import find_rule_set

    decision = options.decision
    if options.rules:
        rule_set = find_rule_set(options.rules)
    else:
        chosen = None if project is None else rule_set_of(project.rules)
        if project is not None and value_of(args, "--decision") is None:
            decision = project.rules.decision
        if chosen is None:
            if options.overlay:
                raise ConfigError(f"{command}: got --overlay without a rule set; name one with --rules")
            if value_of(args, "--decision") is not None:
                raise ConfigError(f"{command}: got --decision without a rule set; name one with --rules")
            return None
        rule_set = chosen
    for name in options.overlay:
        rule_set = overlaid(rule_set, find_rule_set(name))
    return rule_set, decision


def pinned_in(options: Headless, project: "Project | None") -> "PinnedFindings | None":
    """Return the pins of the project and what was said of findings in it; None without a project."""
    if project is None:
        return None
    from stair_inspector.content.project_basis import pinned_of

    return pinned_of(project, options.project)


def paths_of(options: Headless, command: str, project: "Project | None") -> tuple[list[Path], int]:
    """Return the scans that the options name, and the exit code of what could not be found."""
    from stair_inspector.files.scans import find_scans

    scans = options.scans or (
        () if project is None else (_scan_beside(Path(options.project), project.scan_file, command),)
    )
    if not scans:
        raise ConfigError(f"{command}: no scan given; name at least one file or folder")
    paths: list[Path] = []
    worst = 0
    for given in scans:
        try:
            paths += find_scans([given])
        except StairError as error:
            worst = max(worst, report_error(error))
    return list({path.resolve(): path for path in paths}.values()), worst


def check_stems(paths: list[Path]) -> None:
    """Raise when two scans would write to the same files."""
    first: dict[str, Path] = {}
    for path in paths:
        other = first.setdefault(path.stem, path)
        if other is not path:
            raise ConfigError(f"{path} and {other} would both be written as {path.stem}.json; measure them apart")


def check_overwriting(paths: list[Path], folder: Path, segmented: "Sequence[SegmentedFormat]" = ()) -> None:
    """Raise when a result would take the place of a scan."""
    from stair_inspector.writers.inspection import result_paths

    scans = {path.resolve(): path for path in paths}
    for path in paths:
        for result in result_paths(folder, path.stem, segmented):
            if result.resolve() in scans:
                raise ConfigError(f"{result}: this result would overwrite a scan; give another folder with -o")


def for_each(
    paths: list[Path],
    options: Headless,
    project: "Project | None",
    show: Callable[["Scan", "Inspection", Path], int],
) -> int:
    """Inspect every scan and show it; return the worst exit code. An error of one scan leaves the others."""
    from stair_inspector.files.projects import check_scan
    from stair_inspector.files.scans import read_scan
    from stair_inspector.memo import Memo
    from stair_inspector.pipeline import inspect
    from stair_inspector.stability import mark_unsettled

    worst = 0
    for path in paths:
        try:
            scan = read_scan(path, *options.settings.reading)
            if project is not None:
                check_scan(project, scan.sha256, str(path), options.project)
            memo = Memo()
            found = inspect(scan, options.settings, memo)
            if options.stability:
                found = mark_unsettled(scan, options.settings, found, memo)
            worst = max(worst, show(scan, found, path))
        except StairError as error:
            if options.debug:
                traceback.print_exc()
            worst = max(worst, report_error(error))
        except (MemoryError, OSError) as error:
            if options.debug:
                traceback.print_exc()
            words = f"{path}: {internal_words(error)}; thin the scan out and try again"
            worst = max(worst, report_error(CannotMeasure(words)))
    return worst


def checked(inspection: "Inspection", rules: "tuple[RuleSet, Decision] | None") -> "Check | None":
    """Return the check of an inspection; None where no rules are given."""
    from stair_inspector.codes import check

    return None if rules is None else check(inspection, *rules)


def write_results(
    scan: "Scan",
    inspection: "Inspection",
    folder: Path,
    path: Path,
    found: "Check | None",
    basis: "ReportBasis | None",
    made_at: datetime,
    segmented: "Sequence[SegmentedFormat]" = (),
    pinned: "PinnedFindings | None" = None,
    length: "ReportLength" = "short",
    compared: "ComparedScan | None" = None,
) -> str:
    """Write the files of measure, and the report if there is a basis for one, and say which."""
    from stair_inspector.writers.record import write_record

    if is_time_stated():
        # What is made with a stated time is the same each time.
        inspection = replace(inspection, timings_s={})
    written = write_record(
        scan, inspection, folder, path.stem, made_at, found, segmented, pinned, basis, length, compared
    )
    return f"wrote {', '.join(str(file) for file in written)}"


def _scan_beside(project: Path, name: str, command: str) -> Path:
    path = project.parent / name
    try:
        is_there = path.is_file()
    except OSError:
        # A name longer than the system allows.
        is_there = False
    if not is_there:
        raise ReadError(
            f"{path}: this scan of the project is not beside it; name it: {command} SCAN --project {project}"
        )
    return path
