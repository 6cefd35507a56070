"""The readings by hand beside the scan's values, as HTML."""

from stair_inspector.content.cells import QUANTITY_WORDS
from stair_inspector.content.cross_checks import Compared, compared, readings_table, said_of
from stair_inspector.content.document import SIGNS
from stair_inspector.content.fields import ReportBasis
from stair_inspector.model import Inspection
from stair_inspector.units import NOT_KNOWN, ShownUnit, Unit, length_text, signed_text, uncertainty_text
from stair_inspector.viewer.bridge.markup import DIM, LINE, list_key, order_button, text
from stair_inspector.viewer.scene.step_marks import tone_css

DELETE = "delete"
"""Word before the list's key and the number, from 1, of a reading that is to go."""
_HEAD = ("By hand", "Scan", "Difference")
_LEFT = "padding:4px 6px 0 0;text-align:left;vertical-align:top"
_NUMBER = "padding:4px 0 0 6px;text-align:right;vertical-align:top;white-space:nowrap"
_SMALL = f"color:{DIM};font-size:11px"
_STYLE = "font-size:12px;line-height:1.3;padding:2px 12px 6px 5px;overflow-wrap:break-word"


def readings_html(inspection: Inspection | None, basis: ReportBasis, order_uuid: str, unit: Unit = "mm") -> str:
    """Return two rows for each reading: with its difference from the scan and a button to delete it, and in words.

    Parameters
    ----------
    inspection : Inspection, optional
        Without a result there is nothing to compare with, and the readings are only counted.
    basis : ReportBasis
        Holds the readings.
    order_uuid : str
        Identity of the control that a button writes to.
    unit : str
        Of lengths on the page.
    """
    if not basis.readings:
        return _words("No reading yet. Three to five, by tape or digital level, check the scan by other means.")
    if inspection is None:
        n_readings = len(basis.readings)
        of_them = "1 reading is kept; it is" if n_readings == 1 else f"{n_readings} readings are kept; they are"
        return _words(f"{of_them} listed beside the first result.")
    key = list_key(basis.readings)
    head = "".join(f'<th style="{_NUMBER};font-weight:400;color:{DIM}">{name}</th>' for name in _HEAD)
    rows = "".join(
        _row(
            compared(inspection, reading),
            unit,
            order_button(order_uuid, DELETE, key, number, f"delete reading {number}"),
        )
        for number, reading in enumerate(basis.readings, 1)
    )
    return (
        f'<div data-testid="readings" style="{_STYLE}"><table style="border-collapse:collapse;width:100%;'
        f'font-variant-numeric:tabular-nums"><thead><tr><th></th>{head}<th></th></tr></thead><tbody>{rows}</tbody>'
        f'</table><div style="{_SMALL};padding-top:4px">{text(readings_table(inspection, basis).note)}</div></div>'
    )


def _words(words: str) -> str:
    return f'<div data-testid="readings" style="{_STYLE};color:{DIM}">{words}</div>'


def _row(found: Compared, unit: Unit, button: str) -> str:
    reading, scanned, result = found.reading, found.scanned, found.result
    shown: ShownUnit = unit if reading.unit == "m" else "°"
    difference = NOT_KNOWN if found.difference is None else _with_unit(signed_text(found.difference, shown), shown)
    cells = "".join(
        f'<td style="{_NUMBER}">{text(value)} <div style="{_SMALL}">{text(u)}</div></td>'
        for value, u in (
            (_size(reading.value, shown), "U not stated" if reading.u is None else _u(reading.u, shown)),
            (NOT_KNOWN, "") if scanned is None else (_size(scanned.value, shown), _u(scanned.u, shown)),
            (difference, ""),
        )
    )
    words = f'<b style="color:{tone_css(result.tone)};font-weight:600">{SIGNS[result.tone]} {text(result.words)}</b>'
    said = said_of(reading)
    if said:
        words += f' <div style="{_SMALL}">{text(said)}</div>'
    return (
        f'<tr data-testid="reading-row"><td style="{_LEFT}">{text(found.place)} <div>'
        f"{text(QUANTITY_WORDS[reading.quantity])}</div></td>{cells}"
        f'<td style="vertical-align:top;padding-top:2px">{button}</td></tr>'
        f'<tr data-testid="reading-result" style="border-bottom:1px solid {LINE}"><td colspan="5" '
        f'style="padding:0 0 4px;overflow-wrap:anywhere">{words}</td></tr>'
    )


def _size(value: float, shown: ShownUnit) -> str:
    return length_text(value, shown, 2 if shown == "°" else 1)


def _u(u: float, shown: ShownUnit) -> str:
    return f"± {uncertainty_text(u, shown)}"


def _with_unit(number: str, shown: ShownUnit) -> str:
    if not number:
        return ""
    return f"{number}°" if shown == "°" else f"{number} {shown}"
