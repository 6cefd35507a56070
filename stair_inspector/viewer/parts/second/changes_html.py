"""What changed between two scans as HTML: in words, a row for each step, and the maps of treads in colour."""

import base64
import io
from dataclasses import replace

from PIL import Image

from stair_inspector.comparison.words import rests_on
from stair_inspector.content.change_blocks import what_changed
from stair_inspector.content.comparisons import CHANGED, alignment_facts
from stair_inspector.model import ComparedScan, StepChange, ValueChange
from stair_inspector.pictures.change_sheets import map_pixels, map_width_m
from stair_inspector.pictures.changes import change_legend, change_limit
from stair_inspector.pictures.tread_sheets import layout_of
from stair_inspector.quantities import quantity_of
from stair_inspector.units import NOT_KNOWN, Unit, measured_text, shown_in, signed_number, u_text, value_and_u
from stair_inspector.viewer.bridge.markup import (
    CHOSEN,
    DIM,
    LINE,
    hint_of,
    pick_script,
    row_attributes,
    table_head,
    text,
)
from stair_inspector.viewer.bridge.styles import RESULTS
from stair_inspector.viewer.scene.legends import colour_legend_html

_STYLE = "font-size:12px;line-height:1.35;padding:2px 9px 6px"
_CELL = "text-align:right;padding:2px 3px;white-space:nowrap;vertical-align:top"
_ONE_PX, _TWO_PX = 900, 450
"""Width of the picture of a map, pixels: twice what the panel has room for, of one or of two side by side."""
_HEIGHT = "height"
_HEIGHT_HINT = "Height of the tread's middle, laid onto what did not move"


def words_html(compared: ComparedScan) -> str:
    """Return what changed in words, and what the scans were laid onto each other on, with how sure that is."""
    found = compared.found
    notes = "".join(f"<li>{text(note.message)}</li>" for note in what_changed(compared))
    facts = "".join(
        f'<div><span style="color:{DIM}">{text(label)}:</span> {text(value)}</div>'
        for label, value in alignment_facts(compared).items
    )
    return (
        f'<div data-testid="changes-found" class="{RESULTS}" style="{_STYLE}">'
        f'<div style="overflow-wrap:anywhere"><b>{text(found.before.name)}</b> (earlier) → '
        f"<b>{text(found.after.name)}</b> (later)</div>"
        f'<ul data-testid="change-notes" style="margin:4px 0;padding-left:16px">{notes}</ul>'
        f'<details data-testid="alignment"><summary style="cursor:pointer">Laid onto each other on '
        f"{text(rests_on(compared))}; U of a height by that ≤ {u_text(1000.0 * found.alignment.u_m)} mm</summary>"
        f'<div style="padding:2px 0 2px 14px;overflow-wrap:anywhere">{facts}</div></details></div>'
    )


def changes_html(compared: ComparedScan, selected: int | None, pick_uuid: str, unit: Unit = "mm") -> str:
    """Return a row for each step, with the change of each value and its U.

    Parameters
    ----------
    compared : ComparedScan
        By the numbers of the scan at hand.
    selected : int, optional
        Step whose row is emphasised.
    pick_uuid : str
        Identity of the control that a click on a row writes to.
    unit : {"mm", "in"}
        Of lengths.
    """
    steps = compared.found.steps
    quantities = [quantity_of(value.quantity) for value in (steps[0].values if steps else ())]
    heads = (
        ("#", "", f"Step in {compared.name}, from bottom to top"),
        *((each.head or each.label, shown_in(each.unit, unit), f"Change of: {hint_of(each)}") for each in quantities),
        (_HEIGHT, shown_in("m", unit), _HEIGHT_HINT),
    )
    rows = "".join(_row(compared, step, selected, pick_uuid, unit) for step in steps)
    return (
        f'<div class="{RESULTS}" style="{_STYLE}">'
        '<table data-testid="changes-table" style="border-collapse:collapse;width:100%;font-size:11px;'
        f'line-height:1.25;font-variant-numeric:tabular-nums">{table_head(heads, left=("#",))}<tbody>{rows}</tbody>'
        f'</table><div style="color:{DIM};font-size:11px;padding-top:3px">Later less earlier, ± U (k = 2) of both. '
        f"{CHANGED} changed: beyond U, and beyond what the largest of so many differences is by chance.</div></div>"
    )


def maps_html(compared: ComparedScan, selected: int | None, *, is_all: bool) -> str:
    """Return the map of the chosen step's tread, or those of all treads, in one scale of colours, with its legend.

    Parameters
    ----------
    compared : ComparedScan
        By the numbers of the scan at hand.
    selected : int, optional
        The chosen step.
    is_all : bool
        Whether all are shown.
    """
    steps = [step for step in compared.found.steps if is_all or compared.number_of(step) == selected]
    limit_m = change_limit(compared.found)
    # The legend over the scene says more of it.
    legend = colour_legend_html(replace(change_legend(limit_m, "not seen in both scans"), title="change [mm]"))
    maps = "".join(_map(compared, step, limit_m, _TWO_PX if is_all else _ONE_PX) for step in steps)
    if not steps:
        words = "Choose a step, in the table or in the scene, to see the map of its tread."
        return f'<div data-testid="change-maps" style="{_STYLE};color:{DIM}">{words}</div>'
    columns = "1fr 1fr" if is_all else "1fr"
    return (
        f'<div data-testid="change-maps" style="{_STYLE}"><div style="display:grid;grid-template-columns:{columns};'
        f'gap:8px 10px;align-items:start">{maps}</div>{legend}</div>'
    )


def _row(compared: ComparedScan, step: StepChange, selected: int | None, pick_uuid: str, unit: Unit) -> str:
    number = compared.number_of(step)
    chosen = f"background:{CHOSEN};" if number == selected else ""
    other = step.after_id if compared.is_earlier else step.before_id
    twin = "" if other == number else f'<span style="color:{DIM}"> ({other})</span>'
    cells = "".join(_value(value, unit) for value in (*step.values, step.height))
    return (
        f'<tr data-testid="change-row" data-step="{number}" data-changed="{"true" if step.is_changed else "false"}" '
        f'style="border-bottom:1px solid {LINE};{chosen}cursor:pointer"'
        f"{row_attributes(pick_script(pick_uuid, number))}>"
        f'<td style="{_CELL};text-align:left;padding-left:8px">{number}{twin}</td>{cells}</tr>'
    )


def _value(value: ValueChange, unit: Unit) -> str:
    if value.change is None:
        return f'<td data-quantity="{value.quantity}" style="{_CELL};color:{DIM}">{NOT_KNOWN}</td>'
    shown = shown_in("m" if value.quantity == _HEIGHT else quantity_of(value.quantity).unit, unit)
    number, u = value_and_u(value.change, shown)
    hint = ""
    if value.before is not None and value.after is not None:
        hint = f"{measured_text(value.before, shown)} → {measured_text(value.after, shown)}"
    bold = ";font-weight:700" if value.is_changed else f";color:{DIM}"
    mark = f" {CHANGED}" if value.is_changed else ""
    return (
        f'<td data-quantity="{value.quantity}" data-changed="{"true" if value.is_changed else "false"}" '
        f'title="{text(hint)}" style="{_CELL}{bold}">{signed_number(number)}{mark}'
        f'<div style="color:{DIM};font-weight:400">± {u}</div></td>'
    )


def _map(compared: ComparedScan, step: StepChange, limit_m: float, width_px: int) -> str:
    number = compared.number_of(step)
    kind = ", landing" if step.kind == "landing" else ""
    found = step.deviations
    if found is None:
        return f'<div data-testid="change-map" data-step="{number}">step {number}{kind}: not seen in both scans</div>'
    layout = layout_of(1, map_width_m(found), width_px)
    stream = io.BytesIO()
    Image.fromarray(map_pixels(found, limit_m, layout)).save(stream, "PNG", optimize=True)
    data = base64.b64encode(stream.getvalue()).decode("ascii")
    words = f"step {number}{kind}: {100.0 * found.coverage:.0f} % seen in both"
    if found.worst_m is not None:
        worst = measured_text(found.worst_m, "mm").replace("-", "−")
        words += f"; the outlined place lies {worst} off the rest"
    return (
        f'<figure data-testid="change-map" data-step="{number}" style="margin:0"><figcaption style="font-size:11px">'
        f'{text(words)}</figcaption><img alt="{text(f"map of the change of step {number}, its nosing below")}" '
        f'src="data:image/png;base64,{data}" style="display:block;width:100%;max-height:300px;'
        f'object-fit:contain;object-position:left bottom;border-bottom:3px solid currentColor"></figure>'
    )
