"""The card of the chosen step: everything that the survey knows of it, as HTML."""

from stair_inspector.content.remarks import on_page
from stair_inspector.files.palettes import Palette
from stair_inspector.model import Inspection, Measured, Note, Step
from stair_inspector.pictures.frames import step_of
from stair_inspector.quantities import ON_CARD, ON_LINES, with_above
from stair_inspector.quantity_types import LINES
from stair_inspector.units import NOT_KNOWN, ShownUnit, Unit, measured_text, number_text, parts_text, shown_in
from stair_inspector.viewer.bridge.markup import DIM, LINE, chip, mm, text
from stair_inspector.viewer.parts.missing import why_missing


def card_html(inspection: Inspection | None, selected: int | None, palette: Palette, unit: Unit = "mm") -> str:
    """Return everything the survey knows of the chosen step; empty for none, and where no survey has been made."""
    step = step_of(inspection, selected)
    if inspection is None or step is None or not inspection.flights:
        return '<div data-testid="card"></div>'
    notes = notes_of(inspection, step.step_id)
    flight = f" · flight {step.flight}" if step.flight is not None else ""
    told = "".join(f"<li>{text(on_page(note.message))}</li>" for note in notes)
    told = f'<ul style="margin:4px 0 0;padding-left:16px">{told}</ul>' if told else ""
    return (
        '<div data-testid="card" class="si-results" style="font-size:12px;line-height:1.35;margin:2px 9px 6px;'
        f'padding:6px 9px;border:1px solid {LINE};border-radius:5px;font-variant-numeric:tabular-nums">'
        f"<b>{chip(palette.of_step(step.step_id))} Step {step.step_id}</b>"
        f'<span style="color:{DIM}"> · {text(step.kind)}{flight}</span>'
        f"{_lines_table(inspection, step, unit)}{_facts(inspection, step, unit)}{told}</div>"
    )


def notes_of(inspection: Inspection, step_id: int) -> list[Note]:
    """Return what there is to say about a step."""
    return [note for note in inspection.notes if note.step == step_id]


def _lines_table(inspection: Inspection, step: Step, unit: Unit) -> str:
    """Return rise and going on the three measuring lines, the centre with its uncertainty."""
    head = "".join(
        f'<th style="text-align:right;font-weight:400;color:{DIM};padding:2px 0 0 10px">{name}</th>' for name in LINES
    )
    rows = []
    for quantity in ON_LINES:
        name, shown = quantity.label, shown_in(quantity.unit, unit)
        why = why_missing(inspection, step, quantity)
        left, _, right = quantity.lines_of(step)
        centre, hint = _fact(quantity.of(step), shown, why)
        cells = "".join(
            f'<td style="text-align:right;padding-left:10px" title="{text(title)}">{value}</td>'
            for value, title in (
                (number_text(left, shown), why if left is None else shown),
                (centre, hint),
                (number_text(right, shown), why if right is None else shown),
            )
        )
        rows.append(f'<tr data-testid="card-{name}"><td style="color:{DIM}">{name}</td>{cells}</tr>')
    return (
        f'<table style="border-collapse:collapse;width:100%"><thead><tr><th></th>{head}</tr></thead>'
        f"<tbody>{''.join(rows)}</tbody></table>"
    )


def _facts(inspection: Inspection, step: Step, unit: Unit) -> str:
    """Return the other values as pairs of name and value, two to a line."""
    coverage = "–" if step.coverage is None else f"{100.0 * step.coverage:.0f} %"
    rms = "–" if step.plane.rms_m is None else f"{mm(step.plane.rms_m, 2)} mm"
    above = next((other for below, other in with_above(inspection.steps) if below is step), None)
    facts = [
        *(
            (
                each.label,
                *_fact(each.of(step, above), shown_in(each.unit, unit), why_missing(inspection, step, each)),
            )
            for each in ON_CARD
            if each.on_lines is None
        ),
        ("coverage", coverage, "Share of the tread that has points"),
        ("points", f"{step.plane.n_points:,}", "Points of the tread"),
        ("RMS", rms, "Of the points' distances from their plane; it is not the accuracy"),
    ]
    pairs = "".join(
        f'<span style="color:{DIM}">{name}</span>'
        f'<span title="{text(hint)}" style="text-align:right;white-space:nowrap">{value}</span>'
        for name, value, hint in facts
    )
    return (
        '<div data-testid="card-facts" style="display:grid;grid-template-columns:auto 1fr auto 1fr;gap:1px 8px;'
        f'border-top:1px solid {LINE};margin-top:4px;padding-top:4px">{pairs}</div>'
    )


def _fact(measured: Measured | None, unit: ShownUnit, why: str) -> tuple[str, str]:
    """Return a value with its uncertainty, and what that is made of or why there is none."""
    if measured is None:
        return NOT_KNOWN, why
    return measured_text(measured, unit), parts_text(measured, unit)
