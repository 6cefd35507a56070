"""What stands beside a result: its notes, the settings and the up that made it, its times, as HTML and in words."""

from collections.abc import Mapping

from stair_inspector.content.remarks import needs_look, on_page
from stair_inspector.content.tables import MADE_BY
from stair_inspector.model import Inspection, Up
from stair_inspector.params import Params
from stair_inspector.units import tidy
from stair_inspector.viewer.bridge.markup import DIM, aside, text

_DETAILS = 'class="si-results" style="font-size:11.5px;line-height:1.4;padding:2px 9px;overflow-wrap:anywhere'


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
    return aside("up-used", f"Up in use: ({vector}), {source}.", "0 9px 6px")


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
        f"k {params.normals.k} ({MADE_BY[inspection.normals_by]})"
        if params.normals.source == "estimate"
        else "normals given",
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
