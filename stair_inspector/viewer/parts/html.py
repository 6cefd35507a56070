"""The parts of the page that viser has no widget for, as HTML and SVG made from an inspection.

Every text that could come from a file is escaped. Colours of the theme are taken from its variables, so that light
and dark both read well.
"""

from collections.abc import Iterable, Mapping

from stair_inspector.content.document import Tone
from stair_inspector.content.remarks import n_to_look_at, needs_look, on_page
from stair_inspector.files.palettes import Palette
from stair_inspector.geometry.fits import PlaneFit
from stair_inspector.model import Inspection, Step, Up
from stair_inspector.params import Params
from stair_inspector.pictures.display import REJECTED_COLOR
from stair_inspector.pictures.legends import CENTRE, line_entries
from stair_inspector.quantities import SHOWN_OF_PAPER
from stair_inspector.units import Unit, number_text, shown_in, tidy
from stair_inspector.viewer.bridge.markup import (
    DIM,
    LINE,
    chip,
    hint_of,
    mm,
    press_attribute,
    row_start,
    scroll_attribute,
    set_script,
    table_head,
    text,
)
from stair_inspector.viewer.bridge.styles import DIMMED_RESULTS, NARROW_TABS
from stair_inspector.viewer.parts import survey_html
from stair_inspector.viewer.parts.desk import Columns
from stair_inspector.viewer.scene.stage import PAPER_EDGES
from stair_inspector.viewer.scene.step_marks import MARKED, TONE_RGB, StepMark, mark_html

_DETAILS = 'class="si-results" style="font-size:11.5px;line-height:1.4;padding:2px 9px;overflow-wrap:anywhere'
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
    pick_uuid: str | None,
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
    pick_uuid : str, optional
        Identity of the control that a click on a row writes to; None for rows that cannot be clicked.
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


def legend_html(
    palette: Palette, *, with_steps: bool = True, tones: Iterable[Tone] = (), with_paper: bool = False
) -> str:
    """Return the legend of the scene's lines and, with ``with_steps``, of its points coloured by step.

    ``tones`` are those of the marks of steps that are outside a limit; ``with_paper`` tells that the paper's edges are
    drawn beside the survey's.
    """
    steps = "".join(chip(color, 10) for color in palette.steps)
    points = [
        f"{chip(palette.floor)} floor",
        f"{steps} steps, in turn",
        f"{chip(palette.non_stair)} other, such as risers",
        f"{chip(REJECTED_COLOR)} rejected surfaces",
    ]
    entries = [
        *(points if with_steps else ()),
        *(f"{chip(color, *((8,) if words == CENTRE else (16, 4)))} {words}" for color, words in line_entries(palette)),
        *(f"{chip(TONE_RGB[tone], 16, 4)} {text(words)}" for tone, words in MARKED.items() if tone in tones),
        *([f"{chip(PAPER_EDGES, 16, 4)} edges of the paper's columns"] if with_paper else []),
    ]
    items = "".join(f'<span style="white-space:nowrap">{entry}</span>' for entry in entries)
    return (
        f'<div data-testid="legend" style="display:flex;flex-wrap:wrap;gap:2px 12px;font-size:11px;padding:4px 9px">'
        f"{items}</div>"
    )


def state_html(
    inspection: Inspection | None,
    *,
    busy: str | None,
    error: str | None,
    is_stale: bool,
    percent: float | None = None,
    cancel_uuid: str | None = None,
) -> str:
    """Return the line that says what is going on, and the sentence of an error.

    The line and the bar below it are as high when nothing is computed: a slider must not move away under the pointer.

    Parameters
    ----------
    inspection : Inspection, optional
        The last good result.
    busy : str, optional
        What is being computed now.
    error : str, optional
        Why the last request gave no result.
    is_stale : bool
        The result shown is not that of the present settings.
    percent : float, optional
        How far the computing is.
    cancel_uuid : str, optional
        Identity of the control that stops it.
    """
    if error is not None:
        badge = _badge("✕", "#e03131", "no result" if inspection is None else "no result for these settings")
    elif busy is not None:
        badge = _badge("◌", "#e8890c", busy)
    else:
        badge = _badge("●", "#2f9e44", "up to date")
    words = _headline(inspection, with_more=busy is None)
    cancel = _cancel_html(cancel_uuid) if percent is not None and cancel_uuid is not None else ""
    lines = [
        f'<div data-testid="state" data-state="{_state(busy, error)}" style="display:flex;gap:5px;align-items:center;'
        f'height:20px;white-space:nowrap">{badge}<span style="flex:1;overflow:hidden;text-overflow:ellipsis">{words}'
        f"</span>{cancel}</div>{_progress_html(percent)}"
    ]
    if error is not None:
        lines.append(
            f'<div data-testid="error" role="alert" style="color:#e03131;padding:3px 0">{text(on_page(error))}</div>'
        )
    if is_stale and inspection is not None:
        if error is not None:
            words = "Shown dimmed: the last good result, with the settings named below it."
            lines.append(f'<div style="color:{DIM}">{words}</div>')
        lines.append(DIMMED_RESULTS)
    style = "font-size:12px;line-height:1.4;padding:2px 9px 7px"
    return f'<div data-testid="status" style="{style}">{"".join(lines)}</div>'


def notes_html(inspection: Inspection | None) -> str:
    """Return the notes on a result, or nothing."""
    notes = "".join(
        f'<li style="padding:1px 0{";list-style-type:&quot;▲ &quot;" if needs_look(note) else ""}" '
        f'title="{text(note.code)}">{text(on_page(note.message))}</li>'
        for note in (inspection.notes if inspection is not None else ())
    )
    return f'<ul data-testid="notes" {_DETAILS};padding-left:25px;margin:0 0 4px">{notes}</ul>' if notes else ""


def details_html(inspection: Inspection | None) -> str:
    """Return the settings that were used and the time per stage of a result."""
    if inspection is None:
        return '<div data-testid="details"></div>'
    return (
        f'<div data-testid="details" {_DETAILS}">'
        f'<div data-testid="used" style="color:{DIM}">{text(used_text(inspection))}</div>'
        f'<div data-testid="timings" style="color:{DIM}">{_timings(inspection.timings_s)}</div></div>'
    )


def up_html(up: Up) -> str:
    """Return the up direction that a result was measured with, and where it came from."""
    vector = ", ".join(f"{tidy(component, 4):.4f}" for component in up.vector)
    source = {"given": "as set", "floor": "from the floor", "treads": "from the treads"}[up.source]
    return (
        f'<div data-testid="up-used" style="font-size:12px;color:{DIM};padding:0 9px 6px">'
        f"Up in use: ({vector}), {source}.</div>"
    )


def header_html(name: str, n_used: int | None, n_shown: int | None) -> str:
    """Return the scan's name and size."""
    size = ""
    if n_used is not None and n_shown is not None:
        size = f"{n_used:,} points" + (f", {n_shown:,} drawn" if n_shown < n_used else "")
    return (
        '<div data-testid="scan" style="padding:2px 9px;overflow-wrap:anywhere">'
        f'<b style="font-size:14px">{text(name)}</b>'
        f'<span style="font-size:12px;color:{DIM}">{" · " if size else ""}{size}</span>{NARROW_TABS}</div>'
    )


def _state(busy: str | None, error: str | None) -> str:
    if error is not None:
        return "error"
    return "busy" if busy is not None else "ready"


def _badge(sign: str, color: str, words: str) -> str:
    return f'<b style="color:{color};white-space:nowrap"><span aria-hidden="true">{sign}</span> {text(words)}</b> '


def _progress_html(percent: float | None) -> str:
    """Return a thin bar, or the room for one."""
    if percent is None:
        return '<div style="height:4px"></div>'
    return (
        f'<div role="progressbar" aria-valuenow="{percent:.0f}" aria-valuemin="0" aria-valuemax="100" '
        f'style="height:4px;border-radius:2px;background:{LINE}"><div style="height:4px;border-radius:2px;'
        f'width:{percent:.0f}%;background:#e8890c"></div></div>'
    )


def _cancel_html(control_uuid: str) -> str:
    return (
        f'<button type="button" title="Stop; the last good result stays" '
        f"{press_attribute(set_script(control_uuid, True))} "
        f'style="border:1px solid {LINE};border-radius:4px;background:none;color:inherit;font:inherit;padding:0 8px;'
        'cursor:pointer">Cancel</button>'
    )


def _headline(inspection: Inspection | None, *, with_more: bool) -> str:
    if inspection is None:
        return ""
    n = len(inspection.steps)
    n_flights = len(inspection.flights)
    flights = f" in {n_flights} flight{'' if n_flights == 1 else 's'}" if n_flights else ""
    steps = f"{n} step{'' if n == 1 else 's'}{flights}"
    return f'<span data-testid="n-steps">· {steps}</span>{_notes_link(inspection) if with_more else ""}'


def _notes_link(inspection: Inspection) -> str:
    """Return how many notes there are, to be pressed to read them; those that may mean a wrong result stand out."""
    n_notes, n_look = len(inspection.notes), n_to_look_at(inspection.notes)
    if not n_notes:
        return ""
    count = n_look or n_notes
    words = f"{count} note{'' if count == 1 else 's'}" + (" to look at" if n_look else "")
    style = (
        "color:var(--mantine-color-text);background:rgba(232,137,12,.28);font-weight:600" if n_look else "color:inherit"
    )
    return (
        ' · <button type="button" data-testid="notes-link" title="Go to the notes, below" '
        f"{scroll_attribute('notes')} "
        f'style="border:0;background:none;cursor:pointer;font:inherit;padding:0 4px;border-radius:3px;{style}">'
        f"{'▲ ' if n_look else ''}{words}</button>"
    )


def used_text(inspection: Inspection) -> str:
    """Return the settings that made a result, as one line of plain text."""
    params = inspection.params
    axes = inspection.axes.rule if inspection.axes is not None else "none"
    up = inspection.up
    vector = ", ".join(f"{tidy(component, 3):.3f}" for component in up.vector)
    parts = [
        params.method,
        f"θ_th {params.horizontal.theta_deg:g}°",
        f"ε_z {params.levels.eps_m * 1000.0:g} mm",
        f"m {params.levels.min_points}",
        f"α {params.edges.front_percentile:g}/{params.edges.back_percentile:g} %",
        f"sides {params.edges.side_percentile:g} %",
        f"k {params.normals.k}" if params.normals.source == "estimate" else "normals given",
        f"axes {params.axes.rule} → {axes}" if params.axes.rule != axes else f"axes {axes}",
        f"up ({vector}) {up.source}",
        f"unit {inspection.scan.unit}",
        *(_used_survey(params) if params.method == "survey" else ()),
    ]
    return "used: " + " · ".join(parts)


def _used_survey(params: Params) -> list[str]:
    """Return the survey's settings; what the user states and overrules only where there is something."""
    stated, overrules = params.uncertainty, params.overrules
    band = f"{params.survey.band_m * 1000.0:g} mm" if params.survey.band_m else "auto"
    parts = [
        f"cell {params.patches.cell_m * 1000.0:g} mm",
        f"gap {params.flights.max_gap_m * 1000.0:g} mm",
        f"turn {params.flights.turn_deg:g}°",
        f"edges {params.survey.edge_source}",
        f"lines {params.survey.line_percent:g} %",
        f"band {band}",
    ]
    if stated.registration_m or stated.up_deg or stated.scale_percent:
        parts.append(
            f"stated ±{stated.registration_m * 1000.0:g} mm, ±{stated.up_deg:g}°, ±{stated.scale_percent:g} % (k = 1)"
        )
    parts += [f"overruled {overrules.force}"] if overrules.force.strip() else []
    parts += [f"climb {overrules.climb}"] if overrules.climb != "auto" else []
    parts += [f"region {overrules.region}"] if overrules.region.strip() else []
    return parts


def _timings(timings_s: Mapping[str, float]) -> str:
    if not timings_s:
        return "time: nothing had to be run again"
    parts = [f"{text(stage)} {seconds * 1000.0:.1f}" for stage, seconds in timings_s.items()]
    return "ms: " + " · ".join(parts)


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
    pick_uuid: str | None,
    marks: Mapping[int, StepMark],
) -> str:
    rows = []
    if inspection.floor is not None:
        rows.append(_floor_row(inspection.floor, inspection.floor_h_m, palette))
    for step in inspection.steps:
        mark = marks.get(step.step_id)
        rows.append(_step_row(step, palette, step.step_id == selected, pick_uuid, mark))
    return "".join(rows)


def _step_row(step: Step, palette: Palette, is_selected: bool, pick_uuid: str | None, mark: StepMark | None) -> str:
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
