"""The table of steps below the scene: the survey's columns or the paper's, as HTML."""

from collections.abc import Mapping

from stair_inspector.content.note_words import note_sentence
from stair_inspector.content.remarks import on_page
from stair_inspector.files.palettes import Palette
from stair_inspector.geometry.fits import PlaneFit
from stair_inspector.model import Inspection, Step
from stair_inspector.quantity_types import PaperQuantity
from stair_inspector.units import Unit, number_text, shown_in
from stair_inspector.viewer.bridge.dock import menu_html
from stair_inspector.viewer.bridge.markup import DIM, LINE, chip, mm, order_script, press_attribute, row_start, text
from stair_inspector.viewer.bridge.styles import RESULTS
from stair_inspector.viewer.parts import survey_html
from stair_inspector.viewer.parts.step_columns import (
    OFFERED,
    POINTS,
    RMS,
    USUAL_LOOK,
    VIEWS,
    StepColumn,
    TableLook,
    TableView,
)
from stair_inspector.viewer.scene.step_marks import StepMark, mark_html


def table_html(
    inspection: Inspection | None,
    palette: Palette,
    selected: int | None,
    pick_uuid: str,
    view: TableView = "paper",
    unit: Unit = "mm",
    look: TableLook = USUAL_LOOK,
    marks: Mapping[int, StepMark] | None = None,
) -> str:
    """Return the table: a row for each step; the paper's columns in millimetres and degrees.

    Parameters
    ----------
    inspection : Inspection, optional
        None shows the empty table.
    palette : Palette
        Colours of the chips.
    selected : int, optional
        Step whose row is emphasised.
    pick_uuid : str
        Identity of the control that a click on a row or on the head of a column writes to.
    view : {"survey", "paper"}
        The survey's values with their uncertainties, flight by flight; or the paper's, after a row for the floor.
    unit : {"mm", "in"}
        Of the survey's lengths.
    look : TableLook
        Which columns, in which order the steps, and which flights list none.
    marks : mapping, optional
        Of the steps that are outside a limit.
    """
    marks = marks or {}
    columns = look.columns(view)
    rows = ""
    if inspection is not None and view == "survey":
        rows = survey_html.survey_rows(inspection, palette, selected, pick_uuid, unit, look, marks)
    elif inspection is not None:
        rows = _paper_rows(inspection, palette, selected, pick_uuid, look, marks)
    if inspection is not None and not inspection.steps:
        why = text(_why_no_steps(inspection))
        rows += f'<tr><td colspan="{1 + len(columns)}" style="padding:10px 6px;white-space:normal">{why}</td></tr>'
    return (
        f'<div data-testid="steps" data-columns="{view}" class="{RESULTS}" style="font-size:12px">'
        '<table data-testid="steps-table" style="border-collapse:collapse;width:100%;'
        'font-variant-numeric:tabular-nums;line-height:1.25">'
        f"{_head(columns, view, unit, look, pick_uuid)}<tbody>{rows}</tbody></table></div>"
    )


def bar_html(inspection: Inspection | None, view: TableView, look: TableLook, pick_uuid: str) -> str:
    """Return the line over the table: whose values, which columns, and what the signs in it mean.

    Parameters
    ----------
    inspection : Inspection, optional
        What the table is of.
    view : {"survey", "paper"}
        What it shows.
    look : TableLook
        How.
    pick_uuid : str
        Identity of the control that its buttons write to.
    """
    has_both = inspection is None or inspection.params.method == "survey"
    views = "".join(
        _button(pick_uuid, f"view {each}", each.capitalize(), f'aria-pressed="{"true" if each == view else "false"}"')
        for each in VIEWS
        if has_both or each == view
    )
    entries = "".join(
        _button(
            pick_uuid,
            f"column {view} {column.name}",
            f"{'☑' if column in look.columns(view) else '☐'} {column.head}",
            f'role="menuitemcheckbox" aria-checked="{"true" if column in look.columns(view) else "false"}" '
            f'title="{text(column.hint)}"',
        )
        for column in OFFERED[view]
    )
    words = text(_words(inspection, view))
    return (
        '<span data-testid="table-view" style="display:inline-flex;flex:none;border-radius:5px;overflow:hidden;'
        f'border:1px solid {LINE}">{views}</span>'
        f"{menu_html('columns', 'Columns', 'Show and hide columns', entries)}"
        f'<span data-testid="table-words" title="{words}" style="color:{DIM};font-size:11px;overflow:hidden;'
        f'text-overflow:ellipsis;white-space:nowrap">{words}</span>'
    )


def _words(inspection: Inspection | None, view: TableView) -> str:
    if inspection is None or not inspection.steps:
        return ""
    if view == "paper":
        return "The paper's values. They have no uncertainty; RMS is not one."
    if inspection.is_withheld:
        return "No value is given before the question about the scan is answered."
    return (
        "± is the expanded uncertainty, k = 2; rest on a value to see what it is made of. Underlined: neighbours that "
        "differ most, beyond U; with dots: what hangs on the settings."
    )


def _button(pick_uuid: str, order: str, words: str, more: str) -> str:
    script = order_script(pick_uuid, order)
    is_on = 'aria-pressed="true"' in more
    colors = "background:var(--mantine-primary-color-filled);color:#fff" if is_on else "background:none;color:inherit"
    block = "display:block;width:100%;text-align:left;" if "menuitem" in more else ""
    return (
        f'<button type="button" data-key="{text(order)}" {more} {press_attribute(script)} style="border:0;{block}'
        f'cursor:pointer;{colors};font:inherit;font-size:12px;padding:2px 8px">{text(words)}</button>'
    )


def _head(columns: tuple[StepColumn, ...], view: TableView, unit: Unit, look: TableLook, pick_uuid: str) -> str:
    """Return the head; a click on a column sorts the steps by it."""
    sorted_by = look.sorted_by(view)

    def cell(column: StepColumn) -> str:
        is_sorted = sorted_by is not None and sorted_by[0] is column
        falls = is_sorted and sorted_by is not None and sorted_by[1]
        sign = (" ▼" if falls else " ▲") if is_sorted else ""
        order = ("descending" if falls else "ascending") if is_sorted else "none"
        press = press_attribute(order_script(pick_uuid, f"sort {view} {column.name}"))
        below = f'<div style="font-weight:400;font-size:11px;color:{DIM}">'
        return (
            f'<th data-head="{column.name}" aria-sort="{order}" scope="col" title="{text(column.hint)}; click to sort" '
            'style="text-align:right;padding:1px 3px;font-weight:600;white-space:nowrap;position:sticky;top:0">'
            f'<button type="button" data-key="sort {column.name}" {press} style="border:0;background:none;padding:0;'
            f'cursor:pointer;font:inherit;color:inherit">{text(column.head)}{sign}</button>'
            f"{below}{text(column.unit_in(unit)) or '&nbsp;'}</div></th>"
        )

    first = (
        '<th scope="col" title="Step, from bottom to top" style="text-align:left;padding:1px 4px;font-weight:600;'
        'position:sticky;top:0;vertical-align:top">#</th>'
    )
    return f'<thead><tr style="border-bottom:1px solid {LINE}">{first}{"".join(map(cell, columns))}</tr></thead>'


_CELL = "text-align:right;padding:2px 6px"


def _floor_row(floor: PlaneFit, h_m: float | None, palette: Palette, columns: tuple[StepColumn, ...]) -> str:
    known = {"h": mm(h_m), POINTS.name: f"{floor.n_points:,}", RMS.name: mm(floor.rms_m, 2)}
    body = "".join(f'<td style="{_CELL}">{known.get(column.name, "")}</td>' for column in columns)
    return (
        f'<tr data-testid="floor-row" style="border-bottom:1px solid {LINE};color:{DIM}">'
        f'<td style="padding:2px 6px;white-space:nowrap">{chip(palette.floor)} floor</td>{body}</tr>'
    )


def _why_no_steps(inspection: Inspection) -> str:
    """Return what stands where there are no rows: the reason, in sight on every tab."""
    told = [note_sentence(on_page(note.message)) for note in inspection.notes if note.code == "no_staircase"]
    return told[0] if told else "No steps."


def _paper_rows(
    inspection: Inspection,
    palette: Palette,
    selected: int | None,
    pick_uuid: str,
    look: TableLook,
    marks: Mapping[int, StepMark],
) -> str:
    columns, sorted_by = look.columns("paper"), look.sorted_by("paper")
    rows = []
    if inspection.floor is not None:
        rows.append(_floor_row(inspection.floor, inspection.floor_h_m, palette, columns))
    steps = inspection.steps if sorted_by is None else survey_html.in_order(inspection.steps, *sorted_by)
    rows += [
        _step_row(step, palette, columns, step.step_id == selected, pick_uuid, marks.get(step.step_id))
        for step in steps
    ]
    return "".join(rows)


def _step_row(
    step: Step,
    palette: Palette,
    columns: tuple[StepColumn, ...],
    is_selected: bool,
    pick_uuid: str,
    mark: StepMark | None,
) -> str:
    def shown(column: StepColumn) -> str:
        if isinstance(column.of, PaperQuantity):
            value, unit = column.of.of_paper(step.paper), column.of.unit
            return number_text(value, shown_in(unit, "mm"), 1 if unit == "m" else 2)
        return f"{step.plane.n_points:,}" if column is POINTS else mm(step.plane.rms_m, 2)

    body = "".join(f'<td data-column="{each.name}" style="{_CELL}">{shown(each)}</td>' for each in columns)
    return (
        f"{row_start(pick_uuid, step.step_id, '', is_selected=is_selected)}"
        '<td style="padding:2px 6px;white-space:nowrap">'
        f"{chip(palette.of_step(step.step_id))} {step.step_id}{mark_html(mark)}</td>{body}</tr>"
    )
