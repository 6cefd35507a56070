"""The parts of the page that viser has no widget for, as HTML and SVG made from an inspection.

Every text that could come from a file is escaped. Colours of the theme are taken from its variables, so that light
and dark both read well.
"""

from collections.abc import Mapping
from typing import Literal

import numpy as np

from stair_inspector.files.palettes import Palette, Rgb
from stair_inspector.geometry.fits import PlaneFit
from stair_inspector.model import HeightProfile, Inspection, Level, Step
from stair_inspector.params import Params
from stair_inspector.viewer import survey_html
from stair_inspector.viewer.display import REJECTED_COLOR
from stair_inspector.viewer.markup import DIM, LINE, chip, mm, row_start, table_head, text, tidy

Columns = Literal["survey", "paper"]

COLUMNS: tuple[Columns, ...] = ("survey", "paper")
_PAPER_COLUMNS = (
    ("#", "", "Step, from bottom to top"),
    ("h", "mm", "Height from this centroid to the next: (c_k+1 - c_k) · u"),
    ("d_FB", "mm", "Depth front to back: f_k - b_k"),
    ("d_FF", "mm", "Depth front to front: |f_k+1 - f_k|"),
    ("W", "mm", "Width between the side edges"),
    ("θ", "°", "Slope from this centroid to the next against the plane"),
    ("points", "", "Points of the level"),
    ("RMS", "mm", "Root mean square distance of the points from their plane; it is not the accuracy"),
)

_WIDTH = 400
_HEIGHT = 104
_BASE = 80


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
) -> str:
    """Return the side table: a row for each step, millimetres and degrees.

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
    """
    names = survey_html.COLUMNS if columns == "survey" else _PAPER_COLUMNS
    rows = ""
    if inspection is not None and columns == "survey":
        rows = survey_html.survey_rows(inspection, palette, selected, pick_uuid)
    elif inspection is not None:
        rows = _paper_rows(inspection, palette, selected, pick_uuid)
    if inspection is not None and not inspection.steps:
        rows += f'<tr><td colspan="{len(names)}" style="padding:10px 6px;color:{DIM}">No steps.</td></tr>'
    caption = ""
    if columns == "survey" and rows:
        caption = "± is the expanded uncertainty, k = 2; rest on a value to see what it is made of."
        caption = f'<div style="font-size:10.5px;color:{DIM};padding:3px 5px">{caption}</div>'
    return (
        f'<div data-testid="steps" data-columns="{columns}" class="si-results" '
        'style="font-size:12px;overflow-x:auto;padding-right:12px">'
        '<table data-testid="steps-table" style="border-collapse:collapse;width:100%;'
        'font-variant-numeric:tabular-nums;line-height:1.25">'
        f"{table_head(names, ('#',))}<tbody>{rows}</tbody></table>{caption}</div>"
    )


def histogram_html(inspection: Inspection | None, palette: Palette) -> str:
    """Return the height histogram with a band for each cluster and the reach eps_z to scale."""
    if inspection is None or not len(inspection.profile.counts):
        return f'<div data-testid="histogram" style="height:{_HEIGHT}px"></div>'
    profile = inspection.profile
    low, span = profile.low_m, profile.bin_m * len(profile.counts)
    eps_m = inspection.params.levels.eps_m

    def at(height_m: float) -> float:
        return 8.0 + (height_m - low) / span * (_WIDTH - 16.0)

    def band(level: Level) -> str:
        # A sharp level is thinner than a pixel: it is widened about its middle to be seen.
        width = max(5.0, at(level.high_m) - at(level.low_m))
        left = (at(level.high_m) + at(level.low_m) - width) / 2.0
        color = f"rgb{_color(level, palette, inspection)}"
        return (
            f'<g data-level="{level.level_id}"><title>{text(_band_title(level, inspection))}</title>'
            f'<rect x="{left:.1f}" y="14" width="{width:.1f}" height="{_BASE - 14}" fill="{color}" opacity="0.4"/>'
            f'<rect x="{left:.1f}" y="{_BASE}" width="{width:.1f}" height="5" fill="{color}"/></g>'
        )

    bands = "".join(band(level) for level in inspection.levels)
    ticks = "".join(
        f'<text x="{at(height):.1f}" y="{_HEIGHT - 6}" text-anchor="middle" font-size="10" '
        f'fill="currentColor" opacity="0.75">{height:.{digits}f}</text>'
        for digits, height in _ticks(low, span)
    )
    reach = max(1.0, at(low + eps_m) - at(low))
    return (
        '<div data-testid="histogram" class="si-results" style="padding:2px 8px 2px 0">'
        f'<svg viewBox="0 0 {_WIDTH} {_HEIGHT}" width="100%" role="img" '
        f'aria-label="Heights of points on horizontal surfaces; {len(inspection.levels)} clusters">'
        '<text x="8" y="9" font-size="10" fill="currentColor" opacity="0.75">'
        "points on horizontal surfaces by height [m], √ scale</text>"
        f'<line x1="{_WIDTH - 8 - reach:.1f}" x2="{_WIDTH - 8}" y1="6" y2="6" stroke="currentColor" stroke-width="3"/>'
        f'<text x="{_WIDTH - 12 - reach:.1f}" y="9" text-anchor="end" font-size="10" fill="currentColor" opacity="0.9">'
        f"ε_z {eps_m * 1000.0:g} mm</text>"
        f"{bands}<path d='{_outline(profile)}' fill='currentColor' opacity='0.72'/>{ticks}</svg></div>"
    )


def legend_html(palette: Palette) -> str:
    """Return the legend of the scene."""
    steps = "".join(chip(color, 10) for color in palette.steps)
    entries = [
        f"{chip(palette.floor)} floor",
        f"{steps} steps, in turn",
        f"{chip(palette.non_stair)} other, such as risers",
        f"{chip(REJECTED_COLOR)} rejected surfaces",
        f"{chip(palette.front_edge, 16, 4)} front edge, nosing",
        f"{chip(palette.back_edge, 16, 4)} back edge",
        f"{chip(palette.side_edge, 16, 4)} side edges",
        f"{chip(palette.measure, 16, 4)} measuring lines",
        f"{chip(palette.centre, 8)} centre",
    ]
    items = "".join(f'<span style="white-space:nowrap">{entry}</span>' for entry in entries)
    return (
        f'<div data-testid="legend" style="display:flex;flex-wrap:wrap;gap:3px 12px;font-size:11px;color:{DIM};'
        f'padding:4px 9px 10px">{items}</div>'
    )


def state_html(inspection: Inspection | None, *, busy: str | None, error: str | None, is_stale: bool) -> str:
    """Return the line that says what is going on, and the sentence of an error.

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
    """
    if error is not None:
        badge = _badge("✕", "#e03131", "no result for these settings")
    elif busy is not None:
        badge = _badge("◌", "#e8890c", busy)
    else:
        badge = _badge("●", "#2f9e44", "up to date")
    lines = [f'<div data-testid="state" data-state="{_state(busy, error)}">{badge}{_headline(inspection)}</div>']
    if error is not None:
        lines.append(f'<div data-testid="error" role="alert" style="color:#e03131;padding:3px 0">{text(error)}</div>')
    if is_stale and inspection is not None:
        lines.append(
            f'<div style="color:{DIM}">Shown dimmed: the last good result, with the settings named below it.</div>'
        )
        # Not part of any element's style: the table itself need not be sent again to be dimmed.
        lines.append("<style>.si-results{opacity:.45}</style>")
    style = "font-size:12px;line-height:1.4;padding:2px 9px 7px"
    return f'<div data-testid="status" style="{style}">{"".join(lines)}</div>'


def details_html(inspection: Inspection | None) -> str:
    """Return the notes, the settings that were used and the time per stage of a result."""
    if inspection is None:
        return '<div data-testid="details"></div>'
    lines = []
    notes = "".join(
        f'<li style="padding:1px 0" title="{text(note.code)}">{text(note.message)}</li>' for note in inspection.notes
    )
    if notes:
        lines.append(f'<ul data-testid="notes" style="margin:0 0 4px;padding-left:16px">{notes}</ul>')
    lines.append(f'<div data-testid="used" style="color:{DIM}">{_used(inspection)}</div>')
    lines.append(f'<div data-testid="timings" style="color:{DIM}">{_timings(inspection.timings_s)}</div>')
    return (
        '<div data-testid="details" class="si-results" style="font-size:11.5px;line-height:1.4;padding:2px 9px;'
        'overflow-wrap:anywhere">'
        f"{''.join(lines)}</div>"
    )


def header_html(name: str, n_used: int | None, n_shown: int | None) -> str:
    """Return the scan's name and size."""
    size = ""
    if n_used is not None and n_shown is not None:
        size = f"{n_used:,} points" + (f", {n_shown:,} drawn" if n_shown < n_used else "")
    return (
        '<div data-testid="scan" style="padding:2px 9px;overflow-wrap:anywhere">'
        f'<b style="font-size:14px">{text(name)}</b>'
        f'<span style="font-size:12px;color:{DIM}">{" · " if size else ""}{size}</span></div>'
    )


def _state(busy: str | None, error: str | None) -> str:
    if error is not None:
        return "error"
    return "busy" if busy is not None else "ready"


def _badge(sign: str, color: str, words: str) -> str:
    return f'<b style="color:{color};white-space:nowrap"><span aria-hidden="true">{sign}</span> {text(words)}</b> '


def _headline(inspection: Inspection | None) -> str:
    if inspection is None:
        return ""
    n = len(inspection.steps)
    total_ms = sum(inspection.timings_s.values()) * 1000.0
    notes = f" · {len(inspection.notes)} notes below" if len(inspection.notes) > 1 else ""
    n_flights = len(inspection.flights)
    flights = f" in {n_flights} flight{'' if n_flights == 1 else 's'}" if n_flights else ""
    steps = f"{n} step{'' if n == 1 else 's'}{flights}"
    return f'<span data-testid="n-steps">· {steps}</span> · {total_ms:,.0f} ms{notes}'


def _used(inspection: Inspection) -> str:
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
    return "used: " + " · ".join(text(part) for part in parts)


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
    cells = [mm(h_m), "", "", "", "", f"{floor.n_points:,}", mm(floor.rms_m, 2)]
    body = "".join(f'<td style="text-align:right;padding:2px 6px">{cell}</td>' for cell in cells)
    return (
        f'<tr data-testid="floor-row" style="border-bottom:1px solid {LINE};color:{DIM}">'
        f'<td style="padding:2px 6px;white-space:nowrap">{chip(palette.floor)} floor</td>{body}</tr>'
    )


def _paper_rows(inspection: Inspection, palette: Palette, selected: int | None, pick_uuid: str | None) -> str:
    rows = []
    if inspection.floor is not None:
        rows.append(_floor_row(inspection.floor, inspection.floor_h_m, palette))
    for step in inspection.steps:
        rows.append(_step_row(step, palette, step.step_id == selected, pick_uuid))
    return "".join(rows)


def _step_row(step: Step, palette: Palette, is_selected: bool, pick_uuid: str | None) -> str:
    paper = step.paper
    cells = [
        mm(paper.h_m),
        mm(paper.d_fb_m),
        mm(paper.d_ff_m),
        mm(paper.w_m),
        "–" if paper.theta_deg is None else f"{paper.theta_deg:.2f}",
        f"{step.plane.n_points:,}",
        mm(step.plane.rms_m, 2),
    ]
    body = "".join(f'<td style="text-align:right;padding:2px 6px">{cell}</td>' for cell in cells)
    return (
        f"{row_start(pick_uuid, step.step_id, '', is_selected=is_selected)}"
        '<td style="padding:2px 6px;white-space:nowrap">'
        f"{chip(palette.of_step(step.step_id))} {step.step_id}</td>{body}</tr>"
    )


def _steps_at(level: Level, inspection: Inspection) -> list[int]:
    """Return the steps that lie in a height cluster; without the survey's surfaces a cluster is one step."""
    if inspection.patches:
        found = {patch.step_id for patch in inspection.patches if patch.level_id == level.level_id}
        return sorted(step_id for step_id in found if step_id is not None)
    return [level.level_id] if 1 <= level.level_id <= len(inspection.steps) else []


def _color(level: Level, palette: Palette, inspection: Inspection) -> Rgb:
    if level.kind == "floor":
        return palette.floor
    steps = _steps_at(level, inspection)
    return palette.of_step(steps[0]) if steps else palette.non_stair


def _band_title(level: Level, inspection: Inspection) -> str:
    """Return what a cluster is: its height and thickness, the steps in it, or why it is none."""
    name = "floor" if level.kind == "floor" else f"level {level.level_id}"
    thick = (level.high_m - level.low_m) * 1000.0
    place = f"{name}: {level.height_m:.3f} m, band of {thick:.0f} mm, {level.n_points:,} points"
    steps = _steps_at(level, inspection)
    what = f"; {level.kind}" if level.kind != "floor" else ""
    what += f", step {', '.join(map(str, steps))}" if what and steps else ""
    return place + what + (f": {level.reason}" if level.reason else "")


def _outline(profile: HeightProfile) -> str:
    """Return the path of the histogram, one column for each pixel, square-root scale."""
    counts = profile.counts
    n_columns = int(_WIDTH - 16)
    # The sum over the bins of a column, so that no narrow peak falls between two pixels.
    ends = np.linspace(0, len(counts), min(n_columns, len(counts)) + 1).astype(int)
    columns = np.add.reduceat(counts, ends[:-1])
    tall = np.sqrt(columns / max(1, columns.max())) * (_BASE - 16)
    step = n_columns / len(columns)
    points = [f"M8 {_BASE}"]
    for index, height in enumerate(tall):
        points.append(f"V{_BASE - height:.1f}H{8 + (index + 1) * step:.1f}")
    return "".join(points) + f"V{_BASE}Z"


def _ticks(low: float, span: float) -> list[tuple[int, float]]:
    """Return about six round heights within the histogram with their number of decimals."""
    wanted = span / 6.0
    power = 10.0 ** np.floor(np.log10(wanted))
    step = float(next(factor * power for factor in (1.0, 2.0, 5.0, 10.0) if factor * power >= wanted))
    digits = max(0, int(-np.floor(np.log10(step))))
    first = np.ceil(low / step) * step
    return [(digits, tidy(height, digits)) for height in np.arange(first, low + span, step)]
