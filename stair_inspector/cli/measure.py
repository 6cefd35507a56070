"""``stair-inspector measure``: JSON, CSV and a debug PLY for every scan, and the report where it is wanted."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import tyro
from typing_extensions import Doc

from stair_inspector.cli import headless
from stair_inspector.cli.arguments import check_folder, parse_arguments, preset_params
from stair_inspector.cli.output import say
from stair_inspector.cli.report_options import basis_asked_for, length_asked_for, time_of_report
from stair_inspector.cli.second_scan import compared_or_told
from stair_inspector.errors import ConfigError

if TYPE_CHECKING:
    from stair_inspector.model import Inspection, Scan

_BCF_SUFFIXES = (".bcf", ".bcfzip")


@dataclass(frozen=True)
class MeasureScans(headless.Headless):
    """Measure scans without a browser and write JSON, CSV and a coloured debug PLY for each.

    With --rules the JSON holds the check against that rule set as well.
    """

    out: Annotated[Path, tyro.conf.arg(aliases=["-o"], metavar="DIR"), Doc("Folder for the results.")] = tyro.MISSING
    segmented: Annotated[
        tuple[Literal["laz", "ply"], ...],
        Doc(
            "Write the segmented scan too, DIR/STEM_segmented.laz or .ply or both: every used point with the fields "
            "step, kind and residual_m."
        ),
    ] = ()
    bcf: Annotated[
        str,
        tyro.conf.arg(metavar="FILE.bcf"),
        Doc("Write the findings, with the pins of the project, as issues of BCF 2.1, which programs for models read."),
    ] = ""


def run(args: list[str]) -> int:
    """Measure every scan and write its files; return the exit code."""
    project = headless.given_project("measure", args)
    start = MeasureScans(settings=preset_params(args) if project is None else project.params)
    measure = parse_arguments(MeasureScans, "measure", args, start)
    rules = headless.rules_of(args, measure, "measure", project)
    basis = basis_asked_for(measure, "measure", project, measure.project)
    pinned = headless.pinned_in(measure, project)
    made_at = time_of_report()
    check_folder(measure.out)
    paths, worst = headless.paths_of(measure, "measure", project)
    headless.check_stems(paths)
    headless.check_overwriting(paths, measure.out, measure.segmented)
    _check_bcf(measure, paths)

    def show(scan: "Scan", inspection: "Inspection", path: Path) -> int:
        from stair_inspector.writers.text import inspection_text

        found = headless.checked(inspection, rules)
        compared, code = compared_or_told(project, measure.project, scan, inspection)
        length = length_asked_for(measure)
        wrote = headless.write_results(
            scan, inspection, measure.out, path, found, basis, made_at, measure.segmented, pinned, length, compared
        )
        if measure.bcf:
            from stair_inspector.writers.bcf import write_bcf

            write_bcf(Path(measure.bcf), scan, inspection, found, pinned, made_at)
            wrote += f", {measure.bcf}"
        say(f"{inspection_text(inspection)}\n  {wrote}\n")
        return code

    return max(worst, headless.for_each(paths, measure, project, show))


def _check_bcf(measure: MeasureScans, paths: list[Path]) -> None:
    """Raise before the work when the BCF file could not be written, or would take the place of something else."""
    if not measure.bcf:
        return
    target = Path(measure.bcf)
    if len(paths) > 1:
        raise ConfigError(f"measure: got --bcf for {len(paths)} scans; give one scan")
    # No scan, project or result ends so.
    if target.suffix.lower() not in _BCF_SUFFIXES:
        raise ConfigError(f"{target}: does not end in {' or '.join(_BCF_SUFFIXES)}; give another file with --bcf")
    check_folder(target.parent, "--bcf")
    if target.is_dir():
        raise ConfigError(f"{target}: is a folder; give another file with --bcf")
