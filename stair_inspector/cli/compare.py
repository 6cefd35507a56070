"""``stair-inspector compare``: what changed between two scans of one stair."""

import traceback
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro
from typing_extensions import Doc

from stair_inspector.cli.arguments import CommonOptions, parse_arguments, preset_params
from stair_inspector.cli.output import internal_words, report_error, say
from stair_inspector.cli.report_options import (
    ReportOptions,
    basis_asked_for,
    length_asked_for,
    report_folder,
    time_of_report,
)
from stair_inspector.errors import CannotMeasure, ConfigError, StairError

if TYPE_CHECKING:
    from stair_inspector.model import Inspection, Scan, ScanComparison
    from stair_inspector.params import Params


@dataclass(frozen=True)
class CompareScans(ReportOptions, CommonOptions):
    """Lay a later scan of a stair onto an earlier one, on what did not move, and tell what changed beyond U.

    Both are measured with the same settings, by survey. With --report the survey report of the later scan, whose STEM
    is BEFORE_AFTER, has a page on what changed.
    """

    before: Annotated[tyro.conf.Positional[Path], tyro.conf.arg(metavar="BEFORE"), Doc("The earlier scan.")] = (
        tyro.MISSING
    )
    after: Annotated[tyro.conf.Positional[Path], tyro.conf.arg(metavar="AFTER"), Doc("The later scan.")] = tyro.MISSING
    out: Annotated[
        str,
        tyro.conf.arg(aliases=["-o"], metavar="DIR"),
        Doc("Folder for BEFORE_AFTER_comparison.json and .csv; '' writes none."),
    ] = ""


def run(args: list[str]) -> int:
    """Compare two scans; return the exit code."""
    options = parse_arguments(CompareScans, "compare", args, CompareScans(settings=preset_params(args)))
    if options.settings.method != "survey":
        raise ConfigError("compare: got --method paper, whose values have no uncertainty; use survey")
    basis = basis_asked_for(options, "compare")
    folder = report_folder(options, options.out, "compare", basis)
    made_at = time_of_report()
    try:
        found, scan, inspection = _compare(options.before, options.after, options.settings)
        from stair_inspector.writers.comparison import comparison_files, comparison_text
        from stair_inspector.writers.record import hashes_of, results_words, write_files

        paths: list[Path] = []
        if folder is not None:
            stem = f"{options.before.stem}_{options.after.stem}"
            files = comparison_files(found)
            if basis is not None:
                from stair_inspector.model import ComparedScan
                from stair_inspector.writers.report import report_files

                name = "_comparison.json"
                files |= report_files(
                    scan,
                    inspection,
                    basis,
                    made_at,
                    length=length_asked_for(options),
                    compared=ComparedScan(found, is_earlier=False),
                    results=results_words(f"{stem}{name}", files[name]),
                )
            scans = hashes_of((found.before, found.after))
            paths = write_files(folder, stem, files, scans, options.settings, made_at)
        written = f"\n  wrote {', '.join(str(path) for path in paths)}" if paths else ""
    except StairError as error:
        if options.debug:
            traceback.print_exc()
        return report_error(error)
    except (MemoryError, OSError) as error:
        if options.debug:
            traceback.print_exc()
        return report_error(CannotMeasure(f"compare: {internal_words(error)}; thin the scans out and try again"))
    say(f"{comparison_text(found)}{written}")
    return 0


def _compare(before: Path, after: Path, settings: "Params") -> "tuple[ScanComparison, Scan, Inspection]":
    """Return what changed, and the later scan with its inspection."""
    from stair_inspector.comparison.compare import compare_scans
    from stair_inspector.files.scans import read_scan
    from stair_inspector.pipeline import inspect

    scans = [read_scan(path, *settings.reading) for path in (before, after)]
    if scans[0].sha256 == scans[1].sha256:
        raise ConfigError(f"compare: {before} and {after} are one scan, byte for byte; give two scans of the stair")
    one, two = ((scan, inspect(scan, settings)) for scan in scans)
    return compare_scans(*one, *two), *two
