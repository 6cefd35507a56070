"""``stair-inspector measure``: JSON, CSV and a debug PLY for every scan, and the report where it is wanted."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import tyro
from typing_extensions import Doc

from stair_inspector.cli import headless
from stair_inspector.cli.arguments import check_folder, parse_arguments, preset_params
from stair_inspector.cli.output import say

if TYPE_CHECKING:
    from stair_inspector.model import Inspection, Scan


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


def run(args: list[str]) -> int:
    """Measure every scan and write its files; return the exit code."""
    project = headless.given_project("measure", args)
    start = MeasureScans(settings=preset_params(args) if project is None else project.params)
    measure = parse_arguments(MeasureScans, "measure", args, start)
    rules = headless.rules_of(args, measure, "measure", project)
    basis = headless.basis_asked_for(measure, "measure", project)
    pinned = headless.pinned_in(measure, project)
    made_at = headless.time_of_report()
    check_folder(measure.out)
    paths, worst = headless.paths_of(measure, "measure", project)
    headless.check_stems(paths)
    headless.check_overwriting(paths, measure.out, measure.segmented)

    def show(scan: "Scan", inspection: "Inspection", path: Path) -> int:
        from stair_inspector.writers.text import inspection_text

        found = headless.checked(inspection, rules)
        length = headless.length_asked_for(measure)
        wrote = headless.write_results(
            scan, inspection, measure.out, path, found, basis, made_at, measure.segmented, pinned, length
        )
        say(f"{inspection_text(inspection)}\n  {wrote}\n")
        return 0

    return max(worst, headless.for_each(paths, measure, project, show))
