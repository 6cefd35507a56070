"""The side table of steps: the survey's columns or the paper's, as HTML."""

from collections.abc import Mapping

from stair_inspector.files.palettes import Palette
from stair_inspector.geometry.fits import PlaneFit
from stair_inspector.model import Inspection, Step
from stair_inspector.quantities import SHOWN_OF_PAPER
from stair_inspector.units import Unit, number_text, shown_in
from stair_inspector.viewer.bridge.markup import DIM, LINE, chip, hint_of, mm, row_start, table_head
from stair_inspector.viewer.parts import survey_html
from stair_inspector.viewer.parts.desk import Columns
from stair_inspector.viewer.scene.step_marks import StepMark, mark_html

COLUMNS: tuple[Columns, ...] = ("survey", "paper")
_PAPER_COLUMNS = (
    ("#", "", "Step, from bottom to top"),
    *((each.symbol, each.notation.unit, hint_of(each)) for each in SHOWN_OF_PAPER),
    ("points", "", "Points of the level"),
    ("RMS", "mm", "Root mean square distance of the points from their plane; it is not the accuracy"),
)


def columns_of(inspection: Inspection | None, wanted: Columns | None) -> Columns:
    """Return which columns the table has: those wanted if the result has them, else the survey's where it was made."""
    if inspection is None or inspection.params.method == "paper":
        return "paper"
    return wanted or ("survey" if inspection.flights else "paper")


def table_html(
    inspection: Inspection | None,
    palette: Palette,
    selected: int | None,
    pick_uuid: str,
    columns: Columns = "paper",
    unit: Unit = "mm",
    folded: frozenset[int] = frozenset(),
    marks: Mapping[int, StepMark] | None = None,
) -> str:
    """Return the side table: a row for each step; the paper's columns in millimetres and degrees.

    Parameters
    ----------
    inspection : Inspection, optional
        None shows the empty table.
    palette : Palette
        Colours of the chips.
    selected : int, optional
        Step whose row is emphasised.
    pick_uuid : str
        Identity of the control that a click on a row writes to.
    columns : {"survey", "paper"}
        The survey's values with their uncertainties, flight by flight; or the paper's, after a row for the floor.
    unit : {"mm", "in"}
        Of the survey's lengths.
    folded : frozenset of int
        Flights whose steps are not listed.
    marks : mapping, optional
        Of the steps that are outside a limit.
    """
    marks = marks or {}
    names = survey_html.columns_in(unit) if columns == "survey" else _PAPER_COLUMNS
    rows = ""
    if inspection is not None and columns == "survey":
        rows = survey_html.survey_rows(inspection, palette, selected, pick_uuid, unit, folded, marks)
    elif inspection is not None:
        rows = _paper_rows(inspection, palette, selected, pick_uuid, marks)
    if inspection is not None and not inspection.steps:
        rows += f'<tr><td colspan="{len(names)}" style="padding:10px 6px;color:{DIM}">No steps.</td></tr>'
    caption = ""
    if inspection is not None and columns == "survey" and rows:
        caption = (
            "± is the expanded uncertainty, k = 2; rest on a value to see what it is made of. Underlined: the "
            "neighbours that differ most; with dots: what hangs on the settings."
        )
        if inspection.is_withheld:
            caption = "No value is given before the question above is answered."
        caption = f'<div style="font-size:10.5px;color:{DIM};padding:3px 5px">{caption}</div>'
    return (
        f'<div data-testid="steps" data-columns="{columns}" class="si-results" '
        'style="font-size:12px;overflow-x:auto;padding-right:12px">'
        '<table data-testid="steps-table" style="border-collapse:collapse;width:100%;'
        'font-variant-numeric:tabular-nums;line-height:1.25">'
        f"{table_head(names, ('#',))}<tbody>{rows}</tbody></table>{caption}</div>"
    )


def _floor_row(floor: PlaneFit, h_m: float | None, palette: Palette) -> str:
    blanks = [""] * (len(SHOWN_OF_PAPER) - 1)
    cells = [mm(h_m), *blanks, f"{floor.n_points:,}", mm(floor.rms_m, 2)]
    body = "".join(f'<td style="text-align:right;padding:2px 6px">{cell}</td>' for cell in cells)
    return (
        f'<tr data-testid="floor-row" style="border-bottom:1px solid {LINE};color:{DIM}">'
        f'<td style="padding:2px 6px;white-space:nowrap">{chip(palette.floor)} floor</td>{body}</tr>'
    )


def _paper_rows(
    inspection: Inspection,
    palette: Palette,
    selected: int | None,
    pick_uuid: str,
    marks: Mapping[int, StepMark],
) -> str:
    rows = []
    if inspection.floor is not None:
        rows.append(_floor_row(inspection.floor, inspection.floor_h_m, palette))
    for step in inspection.steps:
        mark = marks.get(step.step_id)
        rows.append(_step_row(step, palette, step.step_id == selected, pick_uuid, mark))
    return "".join(rows)


def _step_row(step: Step, palette: Palette, is_selected: bool, pick_uuid: str, mark: StepMark | None) -> str:
    cells = [
        *(
            number_text(each.of_paper(step.paper), shown_in(each.unit, "mm"), 1 if each.unit == "m" else 2)
            for each in SHOWN_OF_PAPER
        ),
        f"{step.plane.n_points:,}",
        mm(step.plane.rms_m, 2),
    ]
    body = "".join(f'<td style="text-align:right;padding:2px 6px">{cell}</td>' for cell in cells)
    return (
        f"{row_start(pick_uuid, step.step_id, '', is_selected=is_selected)}"
        '<td style="padding:2px 6px;white-space:nowrap">'
        f"{chip(palette.of_step(step.step_id))} {step.step_id}{mark_html(mark)}</td>{body}</tr>"
    )
