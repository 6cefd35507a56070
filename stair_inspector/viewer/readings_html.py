"""The readings by hand beside the scan's values, and the logo, as HTML."""

import base64

from stair_inspector.model import Inspection
from stair_inspector.report.cross_checks import readings_table
from stair_inspector.report.document import Status
from stair_inspector.report.fields import ReportBasis
from stair_inspector.viewer.markup import DIM, LINE, pick_script, text
from stair_inspector.viewer.step_marks import tone_css

DELETE = "delete"
"""Word before the number, from 1, of a reading that is to go."""
_SHOWN = ("Place", "Quantity", "Unit", "By hand", "Scan", "Difference", "Result")
_CELL = "padding:2px 3px;text-align:right"
_STYLE = "font-size:12px;line-height:1.3;padding:2px 12px 6px 5px;overflow-wrap:anywhere"


def readings_html(inspection: Inspection | None, basis: ReportBasis, order_uuid: str | None) -> str:
    """Return a row for each reading, with its difference from the scan and a button to delete it.

    Parameters
    ----------
    inspection : Inspection, optional
        Without a result there is nothing to compare with, and nothing is listed.
    basis : ReportBasis
        Holds the readings.
    order_uuid : str, optional
        Identity of the control that a button writes to; None for no buttons.
    """
    if inspection is None or not basis.readings:
        words = "No reading yet. Three to five, by tape or digital level, check the scan by other means."
        return f'<div data-testid="readings" style="{_STYLE};color:{DIM}">{words}</div>'
    table = readings_table(inspection, basis)
    at = [next(k for k, column in enumerate(table.columns) if column.name == name) for name in _SHOWN]
    head = "".join(f'<th style="{_CELL};font-weight:400;color:{DIM}">{name}</th>' for name in _SHOWN)
    rows = []
    for number, row in enumerate(table.rows, 1):
        cells = "".join(f'<td style="{_CELL}{_color(row[k])}">{text(table.columns[k].text(row[k]))}</td>' for k in at)
        rows.append(
            f'<tr data-testid="reading-row" title="{text(row[-1])}" style="border-bottom:1px solid {LINE}">{cells}'
            f"<td>{_button(order_uuid, number)}</td></tr>"
        )
    return (
        f'<div data-testid="readings" style="{_STYLE}"><table style="border-collapse:collapse;width:100%;'
        f'font-variant-numeric:tabular-nums"><thead><tr>{head}<th></th></tr></thead><tbody>{"".join(rows)}</tbody>'
        f'</table><div style="color:{DIM};font-size:10.5px">{text(table.note)}</div></div>'
    )


def logo_html(logo: bytes | None) -> str:
    """Return the logo as the report has it, or that there is none."""
    if logo is None:
        return f'<div data-testid="logo" style="{_STYLE};color:{DIM}">No logo.</div>'
    data = base64.b64encode(logo).decode("ascii")
    return (
        f'<div data-testid="logo" style="{_STYLE}"><img alt="logo" src="data:image/png;base64,{data}" '
        f'style="max-width:100%;max-height:64px;background:#fff;outline:1px solid {LINE}"></div>'
    )


def _color(cell: object) -> str:
    return f";color:{tone_css(cell.tone)};font-weight:600" if isinstance(cell, Status) else ""


def _button(order_uuid: str | None, number: int) -> str:
    if order_uuid is None:
        return ""
    return (
        f'<button type="button" data-order="{DELETE}" title="delete reading {number}" '
        f'aria-label="delete reading {number}" style="border:0;background:none;cursor:pointer;color:inherit;'
        f'padding:0 4px" onclick="{text(pick_script(order_uuid, number, DELETE))}">✕</button>'
    )
