"""Charts of the nosings of each flight as SVG for print: how far each lies off their best-fit line."""

import numpy as np

from stair_inspector.model import Flight, Inspection
from stair_inspector.pictures import svg
from stair_inspector.pictures.chart_axes import (
    ABOVE,
    KEY_LINE,
    LEAST_SPAN_MM,
    LEFT,
    RIGHT,
    STEPS_PER_ROW,
    ChartScale,
    axis_svg,
    with_minus,
)
from stair_inspector.pictures.nosing_line import NosingLine, nosing_line
from stair_inspector.units import tidy

_ROOM_FOR_WORDS = 1.45
"""The scale of a nosing chart reaches so many times as far as its points, whose words stand beyond them."""


def nosing_charts(inspection: Inspection) -> tuple[tuple[Flight, str], ...]:
    """Return for each flight how far its nosings lie off their best-fit line, as SVG pictures.

    A flight of fewer than three known nosings has none: two always lie on one line.
    """
    found = [(flight, nosing_line(inspection, flight)) for flight in inspection.flights]
    return tuple((flight, _nosing_chart(flight, line)) for flight, line in found if line is not None)


def _nosing_chart(flight: Flight, line: NosingLine) -> str:
    ids = line.walk.step_ids
    n_rows = -(-len(ids) // (2 * STEPS_PER_ROW))
    per_row = -(-len(ids) // n_rows)
    deviations, u = line.deviations_m * 1000.0, line.u_m * 1000.0
    reach = (
        max(float(np.abs(deviations).max() + np.nan_to_num(u).max(initial=0.0)), LEAST_SPAN_MM / 4.0) * _ROOM_FOR_WORDS
    )
    slot = (svg.PAGE - LEFT - RIGHT) / max(per_row, 10)
    parts, y = [], 0.0
    for start in range(0, len(ids), per_row):
        scale = ChartScale(-reach, reach, y + ABOVE, 84.0)
        parts.append(axis_svg(scale, "off the line [mm]"))
        parts.append(svg.line(LEFT, scale.y(0.0), svg.PAGE - RIGHT, scale.y(0.0), svg.ACCENT, 1.0))
        shown = range(start, min(start + per_row, len(ids)))
        places = [LEFT + (k - start + 0.5) * slot for k in shown]
        parts.append(svg.polyline([(x, scale.y(deviations[k])) for x, k in zip(places, shown, strict=True)], svg.DIM))
        for x, k in zip(places, shown, strict=True):
            parts.append(_nosing(ids[k], x, float(deviations[k]), float(u[k]), scale, slot))
        y = scale.top + scale.plot + 14.0
    bridged = [ids[k] for k in range(1, len(ids)) if not (line.walk.has_going[k] and line.walk.has_rise[k])]
    words = [
        f"flight {flight.flight_id}: best-fit line at {line.pitch_deg:.1f}° to the horizontal; + above it, − below it, "
        "square to it. Whiskers: expanded uncertainty of the nosing (k = 2).",
        "Steps: one nosing each, from bottom to top.",
    ]
    if bridged:
        named = ", ".join(str(number) for number in bridged)
        words.append(f"Not measured from the nosing before, placed by the nosings themselves: step {named}.")
    for sentence in words:
        parts.append(svg.text_element(LEFT, y + 7.0, sentence, "start", 6.5, svg.DIM))
        y += KEY_LINE
    title = f"deviation of the nosings of flight {flight.flight_id} from their best-fit line, millimetres"
    return svg.picture(svg.PAGE, y + 2.0, title, "".join(parts))


def _nosing(step_id: int, x: float, value: float, u: float, scale: ChartScale, slot: float) -> str:
    y, bottom = scale.y(value), scale.top + scale.plot
    parts = [svg.line(x, scale.y(0.0), x, y, svg.FAINT, 0.8)]
    if np.isfinite(u):
        low, high = scale.y(value - u), scale.y(value + u)
        parts += [svg.line(x, low, x, high, svg.INK, 0.7)]
        parts += [svg.line(x - 2.0, end, x + 2.0, end, svg.INK, 0.7) for end in (low, high)]
    parts.append(f'<circle cx="{x:.2f}" cy="{y:.2f}" r="2.1" fill="{svg.ACCENT}"/>')
    signed = with_minus(f"{tidy(value, 1):+.1f}") if tidy(value, 1) else ""
    if signed and svg.width_of(signed, 6.0) <= slot - 1.0:
        away = scale.y(value + (u if np.isfinite(u) else 0.0)) - 3.4
        under = scale.y(value - (u if np.isfinite(u) else 0.0)) + 7.6
        parts.append(svg.text_element(x, away if value >= 0.0 else under, signed, "middle", 6.0, has_halo=True))
    if slot >= 9.0 or step_id % 5 == 0 or step_id == 1:
        parts.append(svg.text_element(x, bottom + 8.5, step_id, "middle", 6.5))
    return f'<g data-step="{step_id}">{"".join(parts)}</g>'
