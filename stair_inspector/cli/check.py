"""``stair-inspector check``: measure, then hold every value against a rule set."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro
from typing_extensions import Doc

from stair_inspector.cli import headless
from stair_inspector.cli.arguments import parse_arguments, preset_params
from stair_inspector.cli.output import report_error, say
from stair_inspector.cli.report_options import basis_asked_for, length_asked_for, report_folder, time_of_report
from stair_inspector.cli.second_scan import compared_or_told
from stair_inspector.errors import CannotMeasure, ConfigError

if TYPE_CHECKING:
    from stair_inspector.model import Inspection, Scan


@dataclass(frozen=True)
class CheckScans(headless.Headless):
    """Measure scans and hold their values against a rule set; exit code 1 if one is outside a limit."""

    out: Annotated[
        str, tyro.conf.arg(aliases=["-o"], metavar="DIR"), Doc("Folder for the files of measure; '' writes none.")
    ] = ""


def run(args: list[str]) -> int:
    """Check every scan; return the exit code: 1 where a value is outside a limit."""
    project = headless.given_project("check", args)
    start = CheckScans(settings=preset_params(args) if project is None else project.params)
    options = parse_arguments(CheckScans, "check", args, start)
    rules = headless.rules_of(args, options, "check", project)
    if rules is None:
        raise ConfigError("check: no rule set given; name one with --rules (see: stair-inspector rules)")
    basis = basis_asked_for(options, "check", project, options.project)
    pinned = headless.pinned_in(options, project)
    made_at = time_of_report()
    folder = report_folder(options, options.out, "check", basis)
    paths, worst = headless.paths_of(options, "check", project)
    if folder is not None:
        headless.check_stems(paths)
        headless.check_overwriting(paths, folder)

    def show(scan: "Scan", inspection: "Inspection", path: Path) -> int:
        from stair_inspector.codes import check
        from stair_inspector.writers.text import check_text, examined_text

        found = check(inspection, *rules)
        written, code = "", 0
        if folder is not None:
            compared, code = compared_or_told(project, options.project, scan, inspection)
            length = length_asked_for(options)
            wrote = headless.write_results(
                scan, inspection, folder, path, found, basis, made_at, (), pinned, length, compared
            )
            written = f"\n  {wrote}"
        say(f"{examined_text(inspection)}{scan.name} {check_text(found)}{written}\n")
        if found.is_outside:
            return max(1, code)
        if not found.is_judged and any(rule.severity != "report_only" for rule in rules[0].rules):
            reason = next((each.reason for each in found.findings if each.reason), "no rule applies")
            return report_error(CannotMeasure(f"{path}: nothing could be judged: {reason}"))
        return code

    return max(worst, headless.for_each(paths, options, project, show))
