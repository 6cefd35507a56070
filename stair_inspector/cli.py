"""The command line: the only place that prints and exits. Heavy imports wait until a command needs them."""

import contextlib
import io
import os
import re
import signal
import sys
import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypeVar

import tyro
from typing_extensions import Doc

from stair_inspector import __version__
from stair_inspector.codes.findings import Decision
from stair_inspector.errors import CannotMeasure, ConfigError, ReadError, StairError, WriteError
from stair_inspector.files.settings import find_preset, list_presets
from stair_inspector.overrules import NAMED_UP
from stair_inspector.params import Params
from stair_inspector.simulate.specs import Scanner, Stair

if TYPE_CHECKING:
    from stair_inspector.codes import Check, RuleSet
    from stair_inspector.content.fields import ReportBasis
    from stair_inspector.files.projects import Project
    from stair_inspector.model import Inspection, Scan
    from stair_inspector.quantities import PaperQuantity, Quantity

T = TypeVar("T")

_SIGNED_FLAGS = ("--up", "--overrules.climb", "--overrules.region")
"""Flags whose value may begin with a minus sign."""

_USAGE = """\
usage: stair-inspector [COMMAND] [OPTIONS]

Measures staircases in 3-D scans (PLY, PCD, XYZ, PTS, CSV).

commands:
  view SCAN ...             the web inspector; without a SCAN, or without any command, a bundled sample scan
  measure SCAN ... -o DIR   headless: DIR/STEM.json, STEM.csv and STEM_debug.ply for every scan;
                            with --project FILE the numbers of a project saved by the web inspector;
                            with --report the survey report as PDF, HTML and XLSX, and drawings as DXF
  check SCAN ... --rules ID measure, then hold every value against a rule set; -o DIR writes the files of measure too
  rules                     list the rule sets; --show ID prints one, --toml ID its file, to copy and change
  simulate OUT.ply          a scan of a known staircase by a simulated scanner, and OUT.truth.json
  presets                   list the presets
  quantities                list what is measured: names, units, definitions, terms of building codes

  stair-inspector COMMAND --help lists a command's options; --version prints the version.

exit codes: 0 done; 1 check found a value outside a limit;
            2 wrong usage or settings, or an output that cannot be written;
            3 a scan could not be read or measured, or nothing in it be judged (the others are still done)
            0 from check is no pass by itself: values that were not measured are listed as such
"""


@dataclass(frozen=True)
class Common:
    """Options of every command that reads a scan."""

    preset: Annotated[
        str, Doc("Name of a preset (see: stair-inspector presets) or a TOML file; other flags change its values.")
    ] = "default"
    debug: Annotated[tyro.conf.FlagCreatePairsOff[bool], Doc("Show the traceback of an error, for a bug report.")] = (
        False
    )
    settings: Annotated[Params, tyro.conf.arg(name="")] = field(default_factory=Params)


@dataclass(frozen=True)
class View(Common):
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


@dataclass(frozen=True)
class Headless(Common):
    """Options of the commands that measure without a browser."""

    scans: Annotated[
        tyro.conf.Positional[tuple[Path, ...]], tyro.conf.arg(metavar="SCAN"), Doc("Files or folders of scans.")
    ] = tyro.MISSING
    project: Annotated[
        str,
        Doc(
            "Project file of the web inspector: its settings and overrules instead of a preset's, its rules and what "
            "it holds for the report; other flags change its values. Only the scan that it was made on is measured; "
            "without a SCAN the one beside it."
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
    report: Annotated[
        tyro.conf.FlagCreatePairsOff[bool],
        Doc(
            "Write the survey report too: DIR/STEM_report.pdf, .html and .xlsx, STEM_plan.dxf and STEM_section.dxf; "
            "it is dated now, or at the seconds since 1970 in the environment variable SOURCE_DATE_EPOCH."
        ),
    ] = False
    stability: Annotated[
        tyro.conf.FlagCreatePairsOff[bool],
        Doc("Measure again one notch of theta_th, eps_z and m to each side, and note every value that moves beyond u."),
    ] = False
    fields: Annotated[
        str,
        tyro.conf.arg(metavar="FILE.toml"),
        Doc("What only the surveyor knows, for the report: names, dates, instrument, tape readings, logo."),
    ] = ""


@dataclass(frozen=True)
class Measure(Headless):
    """Measure scans without a browser and write JSON, CSV and a coloured debug PLY for each.

    With --rules the JSON holds the check against that rule set as well.
    """

    out: Annotated[Path, tyro.conf.arg(aliases=["-o"], metavar="DIR"), Doc("Folder for the results.")] = tyro.MISSING


@dataclass(frozen=True)
class CheckScans(Headless):
    """Measure scans and hold their values against a rule set; exit code 1 if one is outside a limit."""

    out: Annotated[
        str, tyro.conf.arg(aliases=["-o"], metavar="DIR"), Doc("Folder for the files of measure; '' writes none.")
    ] = ""


@dataclass(frozen=True)
class ListRules:
    """List the rule sets that come with the program: id, grades of the records, edition, name, hash of the file."""

    show: Annotated[str, tyro.conf.arg(metavar="ID|FILE"), Doc("Print all records of one rule set instead.")] = ""
    toml: Annotated[
        str, tyro.conf.arg(metavar="ID"), Doc("Print the file of one rule set instead, to copy and change it.")
    ] = ""
    debug: Annotated[tyro.conf.FlagCreatePairsOff[bool], Doc("Show the traceback of an error, for a bug report.")] = (
        False
    )


@dataclass(frozen=True)
class Simulate:
    """Scan a staircase of known geometry with a simulated scanner; write the scan and its truth."""

    out: Annotated[
        tyro.conf.Positional[Path],
        tyro.conf.arg(metavar="OUT"),
        Doc("PLY file to write, with OUT.truth.json beside it; with --samples a folder."),
    ] = tyro.MISSING
    samples: Annotated[
        tyro.conf.FlagCreatePairsOff[bool], Doc("Write the bundled sample scans, bit for bit, into the folder OUT.")
    ] = False
    profile: Annotated[str, Doc("Start from a scanner profile: its name, or 'none' for the scanner's defaults.")] = (
        "none"
    )
    debug: Annotated[tyro.conf.FlagCreatePairsOff[bool], Doc("Show the traceback of an error, for a bug report.")] = (
        False
    )
    stair: Stair = field(default_factory=Stair)
    scanner: Scanner = field(default_factory=Scanner)


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command.

    Parameters
    ----------
    argv : sequence of str, optional
        Arguments without the program's name; by default those of the process.

    Returns
    -------
    int
        Exit code: 0 done; 1 a value outside a limit; 2 wrong usage, settings or output folder; 3 a scan could not be
        read, measured or judged.
    """
    args = list(sys.argv[1:] if argv is None else argv)
    if isinstance(sys.stdout, io.TextIOWrapper):
        # A file name or a degree sign that the terminal cannot show must not end the program.
        sys.stdout.reconfigure(errors="backslashreplace")
    commands: dict[str, Callable[[list[str]], int]] = {
        "view": _view,
        "measure": _measure,
        "check": _check,
        "rules": _rules,
        "simulate": _simulate,
        "presets": _presets,
        "quantities": _quantities,
    }
    if args and args[0] in ("-h", "--help"):
        print(_USAGE, end="")
        return 0
    if args and args[0] == "--version":
        print(f"stair-inspector {__version__}")
        return 0
    # Without a command, options are those of view.
    name = "view" if not args or args[0].startswith("-") else args.pop(0)
    try:
        if name not in commands:
            raise ConfigError(f"{name[:60]!r} is no command; give one of {', '.join(commands)} (see --help)")
        return commands[name](args)
    except StairError as error:
        if "--debug" in args:
            traceback.print_exc()
        return _report(error)
    except KeyboardInterrupt:
        return 130
    except Exception as error:  # noqa: BLE001 - whatever it is, the user gets one line
        if "--debug" in args:
            traceback.print_exc()
        return _report(CannotMeasure(f"{_internal(error)}; run again with --debug and report what it prints"))


def _view(args: list[str]) -> int:
    view = _parse(View, "view", args, View(settings=_preset_params(args)))
    from stair_inspector.files.paths import sample_scans
    from stair_inspector.files.scans import find_scans
    from stair_inspector.geometry.open3d import check_system_libraries
    from stair_inspector.simulate.samples import DEFAULT_SAMPLE

    # Said in the terminal now, not on the page after the first scan.
    check_system_libraries()
    if view.project_dir:
        _check_folder(Path(view.project_dir), "--project-dir")
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
    from stair_inspector.content.fields import entries_of_one_stair, read_basis

    basis = read_basis(path)
    names = entries_of_one_stair(basis)
    if names:
        shown = ", ".join(names[:5]) + (" and others" if len(names) > 5 else "")
        raise ConfigError(f"view: {path}: belongs to one stair: {shown}; give it on the page, or to measure --report")
    return basis


def _measure(args: list[str]) -> int:
    project = _given_project("measure", args)
    start = Measure(settings=_preset_params(args) if project is None else project.params)
    measure = _parse(Measure, "measure", args, start)
    rules = _rules_of(args, measure, "measure", project)
    basis = _basis_of(measure, "measure", project)
    made_at = _now()
    _check_folder(measure.out)
    paths, worst = _paths_of(measure, "measure", project)
    _check_stems(paths)
    _check_overwriting(paths, measure.out)

    def show(scan: "Scan", inspection: "Inspection", path: Path) -> int:
        found = _checked(inspection, rules)
        wrote = _wrote(scan, inspection, measure.out, path, found, basis, made_at)
        _say(f"{_examined(inspection)}{_summary(inspection)}\n  {wrote}\n")
        return 0

    return max(worst, _for_each(paths, measure, project, show))


def _check(args: list[str]) -> int:
    project = _given_project("check", args)
    start = CheckScans(settings=_preset_params(args) if project is None else project.params)
    options = _parse(CheckScans, "check", args, start)
    rules = _rules_of(args, options, "check", project)
    if rules is None:
        raise ConfigError("check: no rule set given; name one with --rules (see: stair-inspector rules)")
    basis = _basis_of(options, "check", project)
    made_at = _now()
    folder = Path(options.out) if options.out else None
    if folder is not None:
        _check_folder(folder)
    elif options.report:
        raise ConfigError("check: got --report without a folder; name one with -o")
    paths, worst = _paths_of(options, "check", project)
    if folder is not None:
        _check_stems(paths)
        _check_overwriting(paths, folder)

    def show(scan: "Scan", inspection: "Inspection", path: Path) -> int:
        from stair_inspector.codes import check
        from stair_inspector.writers.text import check_text

        found = check(inspection, *rules)
        written = "" if folder is None else f"\n  {_wrote(scan, inspection, folder, path, found, basis, made_at)}"
        _say(f"{_examined(inspection)}{scan.name} {check_text(found)}{written}\n")
        if found.is_outside:
            return 1
        if not found.is_judged and any(rule.severity != "report_only" for rule in rules[0].rules):
            reason = next((each.reason for each in found.findings if each.reason), "no rule applies")
            return _report(CannotMeasure(f"{path}: nothing could be judged: {reason}"))
        return 0

    return max(worst, _for_each(paths, options, project, show))


def _rules(args: list[str]) -> int:
    options = _parse(ListRules, "rules", args, ListRules())
    if options.show and options.toml:
        raise ConfigError("rules: got --show and --toml; give one of them")
    from stair_inspector.files.rule_sets import find_rule_set, list_rule_sets, rule_set_path
    from stair_inspector.files.toml import read_toml_bytes
    from stair_inspector.writers.text import rule_set_text, rule_sets_text

    if options.toml:
        # Read as a rule set first: what is printed can be used.
        find_rule_set(options.toml)
        _say(read_toml_bytes(rule_set_path(options.toml)).decode("utf-8").rstrip("\n"))
    elif options.show:
        _say(rule_set_text(find_rule_set(options.show)))
    else:
        _say(rule_sets_text(list_rule_sets()))
    return 0


def _rules_of(
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
        if project is not None and _value_of(args, "--decision") is None:
            decision = project.rules.decision
        if chosen is None:
            if options.overlay:
                raise ConfigError(f"{command}: got --overlay without a rule set; name one with --rules")
            if _value_of(args, "--decision") is not None:
                raise ConfigError(f"{command}: got --decision without a rule set; name one with --rules")
            return None
        rule_set = chosen
    for name in options.overlay:
        rule_set = overlaid(rule_set, find_rule_set(name))
    return rule_set, decision


def _basis_of(options: Headless, command: str, project: "Project | None") -> "ReportBasis | None":
    """Return what the report takes from the user; None where no report is wanted."""
    if not options.report:
        if options.fields:
            raise ConfigError(f"{command}: got --fields without --report; give both")
        return None
    from stair_inspector.content.fields import ReportBasis, read_basis
    from stair_inspector.content.project_basis import basis_of, titled

    if project is None:
        return read_basis(Path(options.fields)) if options.fields else ReportBasis()
    basis = read_basis(Path(options.fields)) if options.fields else basis_of(project, options.project)
    return titled(basis, project.title)


def _checked(inspection: "Inspection", rules: "tuple[RuleSet, Decision] | None") -> "Check | None":
    from stair_inspector.codes import check

    return None if rules is None else check(inspection, *rules)


def _wrote(
    scan: "Scan",
    inspection: "Inspection",
    folder: Path,
    path: Path,
    found: "Check | None",
    basis: "ReportBasis | None",
    made_at: datetime,
) -> str:
    """Write the files of measure, and the report if there is a basis for one, and say which."""
    from stair_inspector.writers.inspection import write_inspection

    written = list(write_inspection(scan, inspection, folder, path.stem, found))
    if basis is not None:
        from stair_inspector.writers.report import write_report

        written += write_report(scan, inspection, folder, path.stem, basis, made_at, found)
    return f"wrote {', '.join(str(file) for file in written)}"


def _now() -> datetime:
    """Return when a report is made: now, or the time that reproducible builds state in ``SOURCE_DATE_EPOCH``."""
    stated = os.environ.get("SOURCE_DATE_EPOCH", "")
    if not stated:
        return datetime.now().astimezone()
    try:
        return datetime.fromtimestamp(int(stated), UTC)
    except (ValueError, OverflowError, OSError) as error:
        raise ConfigError(f"SOURCE_DATE_EPOCH: got {stated[:60]!r}; give whole seconds since 1970") from error


def _paths_of(options: Headless, command: str, project: "Project | None") -> tuple[list[Path], int]:
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
            worst = max(worst, _report(error))
    return list({path.resolve(): path for path in paths}.values()), worst


def _for_each(
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
            scan = read_scan(path, options.settings.unit)
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
            worst = max(worst, _report(error))
        except (MemoryError, OSError) as error:
            if options.debug:
                traceback.print_exc()
            worst = max(worst, _report(CannotMeasure(f"{path}: {_internal(error)}; thin the scan out and try again")))
    return worst


def _simulate(args: list[str]) -> int:
    from stair_inspector.simulate.specs import PROFILES

    profile = _value_of(args, "--profile") or "none"
    if profile != "none" and profile not in PROFILES:
        raise ConfigError(f"--profile: got {profile[:60]!r}; give one of none, {', '.join(PROFILES)}")
    start = Simulate(scanner=PROFILES.get(profile, Scanner()))
    simulate = _parse(Simulate, "simulate", args, start)
    from stair_inspector.files.simulations import simulate_to_file, write_samples

    _check_folder(simulate.out if simulate.samples else simulate.out.parent)
    written = write_samples(simulate.out) if simulate.samples else []
    if not simulate.samples:
        written = simulate_to_file(simulate.out, simulate.stair, simulate.scanner)
    _say("wrote " + "\n      ".join(str(path) for path in written))
    return 0


def _presets(args: list[str]) -> int:
    if _is_answered("presets", args, "Lists the presets that come with the program."):
        return 0
    presets = list_presets()
    width = max(len(preset.name) for preset in presets)
    for preset in presets:
        print(f"{preset.name:<{width}}  {preset.description}")
    return 0


def _quantities(args: list[str]) -> int:
    if not _is_answered("quantities", args, "Lists what is measured of a step, of a flight and by the paper's method."):
        from stair_inspector.writers.text import quantities_text

        _say(quantities_text())
    return 0


def _is_answered(command: str, args: list[str], words: str) -> bool:
    """Print the help of a command without options where that is asked for; refuse anything else."""
    if args and args[0] not in ("-h", "--help"):
        raise ConfigError(f"{command}: got {args[0][:60]!r}; this command has no options")
    if args:
        print(f"usage: stair-inspector {command}\n\n{words}")
    return bool(args)


def _parse(kind: type[T], command: str, args: list[str], default: T) -> T:
    """Let tyro read the arguments; turn its boxed message into the one line that every error gets."""
    boxed = io.StringIO()
    try:
        with contextlib.redirect_stderr(boxed):
            return tyro.cli(
                kind,
                prog=f"stair-inspector {command}",
                args=_join_negative_directions(args),
                default=default,
                # Every option says what it is by `Doc`: to look for comments would parse the source again for each.
                config=(tyro.conf.OmitSubcommandPrefixes, tyro.conf.HelptextFromCommentsOff),
            )
    except SystemExit as leaving:
        if leaving.code in (0, None):
            raise
        refused = _refused_setting(leaving)
        text = _flatten(boxed.getvalue()) if refused is None else f"{refused}; see --help"
        raise ConfigError(f"{command}: {text}") from leaving


def _refused_setting(leaving: SystemExit) -> ConfigError | None:
    """Return the error with which a setting refused its value: tyro's frame would break its long words."""
    cause: BaseException | None = leaving
    while cause is not None and not isinstance(cause, ConfigError):
        cause = cause.__cause__ or cause.__context__
    return cause


def _flatten(boxed: str) -> str:
    """Return tyro's message as one plain sentence: no frame, no colours, no copy of the help text."""
    plain = re.sub(r"\x1b\[[0-9;]*m", "", boxed)
    # Where stdout is not UTF-8, tyro draws its frame with dashes.
    plain = re.sub(r"[╭╮╰╯─│┌┐└┘├┤┬┴┼━┃]+|-{8,}", " ", plain)
    text = " ".join(plain.split())
    for pattern, replacement in (
        (r"\s*For full helptext,.*$", ""),
        (r"\s*Argument helptext:.*$", ""),
        (r"^(Value error|Parsing error|Unrecognized options|Invalid choice|Required options|Missing argument)\s+", ""),
        (r"^Error parsing settings\S*: ", ""),
        (r"^Error parsing (stair|scanner): ", ""),
        (r"^Error parsing (--\S+): ", r"\1: "),
        (r"^Missing from [\w -]+: (-\S+ [^\s,]+|\S+).*$", r"\1 is missing"),
        (r"^Missing value for argument '(\S+)'.*$", r"\1 needs a value"),
        (r"\s*Perhaps you meant: (--[\w.-]+).*$", r"; did you mean \1?"),
        (r"^Unrecognized options: ([^\s,;]+)[^;]*", r"unknown option \1"),
        (r"invalid literal for int\(\) with base 10: ('.*')", r"got \1; give a whole number"),
        (r"could not convert string to float: ('.*')", r"got \1; give a number"),
    ):
        text = re.sub(pattern, replacement, text)
    choice = re.fullmatch(r"invalid choice ('.*') for argument '(\S+)'\. Expected one of \((.*)\)\.?", text)
    if choice is not None:
        text = f"{choice[2]}: got {choice[1]}; give one of {choice[3].replace(chr(39), '')}"
    return text if text.endswith("?") else text.rstrip(".") + "; see --help"


def _join_negative_directions(args: list[str]) -> list[str]:
    """Write ``--up -x`` as ``--up=-x``: a word that begins with a dash would be taken for a flag."""
    joined: list[str] = []
    for word in args:
        is_negative = word in NAMED_UP or re.fullmatch(r"-[\d.][\d.,eE+-]*", word) is not None
        if joined and joined[-1] in _SIGNED_FLAGS and word.startswith("-") and is_negative:
            joined[-1] = f"{joined[-1]}={word}"
        else:
            joined.append(word)
    return joined


def _preset_params(args: list[str]) -> Params:
    name = _value_of(args, "--preset")
    return find_preset(name).params if name is not None else find_preset("default").params


def _given_project(command: str, args: list[str]) -> "Project | None":
    """Return the project that the arguments name, None for none."""
    name = _value_of(args, "--project")
    if not name:
        return None
    if _value_of(args, "--preset") is not None:
        raise ConfigError(f"{command}: got --project and --preset, which both state every setting; give one of them")
    from stair_inspector.files.projects import read_project

    return read_project(Path(name))


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


def _value_of(args: list[str], flag: str) -> str | None:
    """Return the value of a flag that must be known before the others are read; the last one counts."""
    value = None
    for position, word in enumerate(args):
        if word == flag:
            value = args[position + 1] if position + 1 < len(args) else None
        elif word.startswith(f"{flag}="):
            value = word.partition("=")[2]
    return value


def _check_folder(folder: Path, flag: str = "-o") -> None:
    """Raise before the work, not after it, when the folder that ``flag`` gave could not be written."""
    try:
        existing = next((parent for parent in (folder, *folder.parents) if parent.exists()), folder)
    except OSError as error:
        raise WriteError(f"{folder}: cannot be written ({error.strerror}); give another folder with {flag}") from error
    if not existing.is_dir():
        raise WriteError(f"{existing}: is a file, not a folder; give another folder with {flag}")
    if not os.access(existing, os.W_OK | os.X_OK):
        raise WriteError(f"{existing}: cannot be written (permission denied); give another folder with {flag}")


def _check_stems(paths: list[Path]) -> None:
    """Raise when two scans would write to the same files."""
    first: dict[str, Path] = {}
    for path in paths:
        other = first.setdefault(path.stem, path)
        if other is not path:
            raise ConfigError(f"{path} and {other} would both be written as {path.stem}.json; measure them apart")


def _check_overwriting(paths: list[Path], folder: Path) -> None:
    """Raise when a result would take the place of a scan."""
    from stair_inspector.writers.inspection import result_paths

    scans = {path.resolve(): path for path in paths}
    for path in paths:
        for result in result_paths(folder, path.stem):
            if result.resolve() in scans:
                raise ConfigError(f"{result}: this result would overwrite a scan; give another folder with -o")


def _internal(error: BaseException) -> str:
    if isinstance(error, MemoryError):
        return "there is not enough memory"
    if isinstance(error, OSError) and error.strerror:
        return f"the system reports: {error.strerror}"
    return f"internal error ({type(error).__name__}: {error})"


def _say(text: str) -> None:
    """Print a result. A reader that has seen enough, such as head, must not stop the work."""
    try:
        print(text, flush=True)
    except BrokenPipeError:
        sys.stdout = open(os.devnull, "w")  # noqa: SIM115 - must outlive this function


def _report(error: StairError) -> int:
    """Print an error as one line and return its exit code."""
    line = " ".join(str(error).split())
    print(f"stair-inspector: {line}", file=sys.stderr)
    return 2 if isinstance(error, (ConfigError, WriteError)) else 3


def _examined(inspection: "Inspection") -> str:
    """Return what was found about a scan before it was measured, a line for each; nothing where nothing was."""
    if not inspection.examination:
        return ""
    from stair_inspector.content.examination import examination_lines

    lines = [f"{inspection.scan.name} examined:", *(f"  {line}" for line in examination_lines(inspection))]
    return "\n".join(lines) + "\n"


def _summary(inspection: "Inspection") -> str:
    """Return the table that ``measure`` prints for one scan, millimetres and degrees: the survey's or the paper's."""
    scan = inspection.scan
    steps = f"{len(inspection.steps)} step{'' if len(inspection.steps) == 1 else 's'}"
    lines = [f"{scan.name}: {scan.n_used:,} of {scan.n_points:,} points, {steps}"]
    if inspection.steps:
        lines += _survey_rows(inspection) if inspection.flights else _paper_rows(inspection)
    lines += [f"  {note.message}" for note in inspection.notes]
    return "\n".join(lines)


def _survey_rows(inspection: "Inspection") -> list[str]:
    """Return the survey's values, each with its expanded uncertainty (k = 2), flight by flight."""
    from stair_inspector.quantities import IN_TABLE, with_above
    from stair_inspector.units import measured_text, shown_in, value_and_u

    names = [f"{each.head}_{_ascii_unit(each)}" for each in IN_TABLE]
    lines = ["  " + f"{'step':>13}" + "".join(f"{name:>18}" for name in names) + f"{'coverage':>10}"]
    for flight in inspection.flights:
        risers = f"{flight.n_risers} riser{'' if flight.n_risers == 1 else 's'}"
        radius = flight.radius_m
        shape = flight.shape if radius is None else f"{flight.shape}, radius {measured_text(radius, 'm', 2)}"
        goes_on = "" if flight.goes_on is None else f"; goes on: {flight.goes_on}"
        lines.append(f"  flight {flight.flight_id}: {shape}, {risers}{goes_on}")
        for step, above in with_above(inspection.steps):
            if step.flight != flight.flight_id:
                continue
            cells = [
                "-"
                if (measured := each.of(step, above)) is None
                else " ± ".join(value_and_u(measured, shown_in(each.unit, "mm")))
                for each in IN_TABLE
            ]
            coverage = "-" if step.coverage is None else f"{100.0 * step.coverage:.0f} %"
            kind = "" if step.kind == "tread" else f"{step.kind} "
            lines.append(
                "  " + f"{kind}{step.step_id}".rjust(13) + "".join(f"{cell:>18}" for cell in cells) + f"{coverage:>10}"
            )
    return lines


def _paper_rows(inspection: "Inspection") -> list[str]:
    from stair_inspector.quantities import SHOWN_OF_PAPER

    names = [f"{each.symbol if each.symbol.isascii() else each.name}_{_ascii_unit(each)}" for each in SHOWN_OF_PAPER]
    columns = ("step", "points", *names, "RMS_mm")
    lines = ["  " + "".join(f"{name:>11}" for name in columns)]
    for step in inspection.steps:
        rms_mm = None if step.plane.rms_m is None else step.plane.rms_m * 1000.0
        cells = [f"{step.step_id:>11}", f"{step.plane.n_points:>11}"]
        for each in SHOWN_OF_PAPER:
            value = each.of_paper(step.paper)
            cells.append(f"{'-':>11}" if value is None else f"{value * each.display.scale:>11.1f}")
        cells.append(f"{'-':>11}" if rms_mm is None else f"{rms_mm:>11.2f}")
        lines.append("  " + "".join(cells))
    return lines


def _ascii_unit(quantity: "Quantity | PaperQuantity") -> str:
    """Return the unit in which a quantity is shown as a terminal's column has it."""
    return {"°": "deg", "%": "percent"}.get(quantity.display.unit, quantity.display.unit)
