"""Small pieces of HTML that the parts of the page share; every text that could come from a file is escaped."""

import html
import json
from collections.abc import Collection
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from stair_inspector.errors import ConfigError
from stair_inspector.files.palettes import Rgb
from stair_inspector.quantity_types import PaperQuantity, Quantity

DIM = "light-dark(var(--mantine-color-gray-7), var(--mantine-color-dark-1))"
"""Of side notes in small letters; what the page calls dimmed is too pale for them."""
LINE = "var(--mantine-color-default-border)"
CHOSEN = "rgba(0, 214, 230, 0.22)"
_LEFT = "text-align:left;padding:3px 4px 3px 8px"
_RIGHT = "text-align:right;padding:3px 4px"
_NOTHING = "data:image/gif;base64,R0lGODlhAQABAIAAAAAAAP///yH5BAEAAAAALAAAAAABAAEAAAIBRAA7"
"""A clear pixel."""
FLIGHT = "flight"
"""Word before a flight's number."""


def text(value: object) -> str:
    """Return a value as text that is safe inside HTML and inside a quoted attribute."""
    return html.escape(str(value), quote=True)


def aside(testid: str, words: object, padding: str = "2px 9px 6px") -> str:
    """Return a side note in small letters, known to tests by its ``testid``."""
    return f'<div data-testid="{testid}" style="font-size:12px;color:{DIM};padding:{padding}">{text(words)}</div>'


def mm(value_m: float | None, digits: int = 1) -> str:
    """Return a length in millimetres, or a dash for what is not known."""
    return "–" if value_m is None else f"{value_m * 1000.0:.{digits}f}"


def hint_of(quantity: Quantity | PaperQuantity) -> str:
    """Return what a quantity is, as the hint over a column."""
    return quantity.definition[:1].upper() + quantity.definition[1:]


def chip(color: Rgb, width: int = 11, height: int = 11) -> str:
    """Return a small patch of colour, pixels."""
    # The thin outline keeps black and white chips visible on either theme.
    return (
        f'<span style="display:inline-block;width:{width}px;height:{height}px;border-radius:2px;'
        f'background:rgb{color};outline:1px solid {LINE};vertical-align:-1px;margin-right:2px"></span>'
    )


def table_head(columns: tuple[tuple[str, str, str], ...], left: tuple[str, ...] = ()) -> str:
    """Return the head of a table: name, unit and explanation of each column; those in ``left`` are no numbers."""
    cells = "".join(
        f'<th title="{text(hint)}" style="{_LEFT if name in left else _RIGHT};font-weight:600;white-space:nowrap;'
        f'position:sticky;top:0">{text(name)}<div style="font-weight:400;font-size:11px;color:{DIM}">'
        f"{text(unit) or '&nbsp;'}</div></th>"
        for name, unit, hint in columns
    )
    return f'<thead><tr style="border-bottom:1px solid {LINE}">{cells}</tr></thead>'


def row_start(pick_uuid: str, number: int, word: str, *, is_selected: bool) -> str:
    """Return the opening tag of a table's row that chooses a step or a surface when it is clicked.

    Parameters
    ----------
    pick_uuid : str
        Identity of the control that a click writes to.
    number : int
        Of the step or surface.
    word : str
        Empty for a step, :data:`SURFACE` for a surface.
    is_selected : bool
        Whether the row is emphasised.
    """
    emphasis = f"background:{CHOSEN};font-weight:600;" if is_selected else ""
    kind = word or "step"
    return (
        f'<tr data-testid="{kind}-row" data-{kind}="{number}" aria-selected="{"true" if is_selected else "false"}" '
        f'style="border-bottom:1px solid {LINE};{emphasis}cursor:pointer;"'
        f"{row_attributes(pick_script(pick_uuid, number, word))}>"
    )


def script_html(script: str) -> str:
    """Return what runs a script once as soon as it is on the page; ``this`` is a picture that nobody sees.

    A page runs no script that is put into it later, but tells a picture that it has been loaded.
    """
    return f'<img alt="" src="{_NOTHING}" style="display:none" onload="{text(script)}">'


@cache
def _source_of(name: str) -> str:
    return (Path(__file__).parent / f"{name}.js").read_text(encoding="utf-8").strip()


def page_script(name: str, *arguments: object) -> str:
    """Return what runs ``NAME.js`` of this room once: a function of the picture that runs it, and of the arguments."""
    return script_html(f"{_source_of(name)}({','.join(['this', *map(json.dumps, arguments)])})")


def title_html(title: str) -> str:
    """Return what gives the browser's tab a title, which viser has no setting for."""
    return script_html(f"document.title={json.dumps(title)}")


def write_script(control_uuid: str, expression: str) -> str:
    """Return the script that writes a value, an expression of the script's language, into a control of the page.

    viser has no clickable table and no drawing that can be dragged over. This uses the hook that its own tests use,
    hence the exact version in ``pyproject.toml`` and browser tests of it.
    """
    return (
        "window.__viserMutable.sendMessage({type:'GuiUpdateMessage',uuid:"
        f"{json.dumps(control_uuid)},updates:{{value:{expression}}}}})"
    )


def press_attribute(script: str) -> str:
    """Return the attribute by which a button runs a script when it is pressed."""
    return f'onclick="{text(script)}"'


def row_attributes(script: str, *, has_buttons: bool = False) -> str:
    """Return the attributes by which a row runs a script when it is clicked, or chosen and Enter is pressed.

    ``has_buttons`` tells that there are buttons in the row, whose own Enter is not the row's.
    """
    own = "event.target===this&&" if has_buttons else ""
    on_key = f"if({own}event.key==='Enter'){{{script}}}"
    return f' tabindex="0" {press_attribute(script)} onkeydown="{text(on_key)}"'


def button_in_row(script: str) -> str:
    """Return the attribute of a button that stands in a row which is pressed for something else."""
    return press_attribute(f"event.stopPropagation();{script}")


_UNFOLD_MS = 400
"""A folder takes so long to open."""


def unfold_attribute(testid: str) -> str:
    """Return the attribute of a button that opens the folder of what has this ``data-testid``, and shows it."""
    return press_attribute(
        f"const e=()=>document.querySelector('[data-testid={testid}]');"
        "const h=e().closest('.mantine-Paper-root')?.querySelector(':scope>.mantine-Paper-root[aria-expanded=false]');"
        f"h?.click();setTimeout(()=>e().scrollIntoView({{block:'center'}}),h?{_UNFOLD_MS}:0)"
    )


def set_script(control_uuid: str, value: str | bool) -> str:
    """Return the script of a button that sets a control of the page to a value, as if done there."""
    # A JSON value is a script's value too.
    return write_script(control_uuid, json.dumps(value))


def order_script(control_uuid: str, order: str) -> str:
    """Return the script of a button that writes an order into a hidden control, as ``order:time``.

    The time makes a second press of the same button a new value.
    """
    return write_script(control_uuid, f"{json.dumps(order + ':')}+Date.now()")


def pick_script(pick_uuid: str, number: int, word: str = "") -> str:
    """Return the script of a row: it writes the step or surface into a hidden control, as if typed there.

    Choosing by the menu or in the scene works without. The time makes a second click on the same row a new value.
    """
    name = f"{word} {int(number)}".strip()
    return write_script(pick_uuid, f"'{name}:'+Date.now()")


def list_key(entries: tuple[object, ...]) -> int:
    """Return a number that another list does not have: a row is named by it and its place in that list."""
    return hash(entries) & 0xFFFF_FFFF


def order_button(order_uuid: str, word: str, key: int, number: int, title: str, sign: str = "✕") -> str:
    """Return the button of a row, which writes ``word key number:time`` into a hidden control."""
    return (
        f'<button type="button" data-order="{word}" title="{text(title)}" aria-label="{text(title)}" '
        'style="border:0;background:none;cursor:pointer;color:inherit;padding:0 4px" '
        f"{press_attribute(pick_script(order_uuid, number, f'{word} {key}'))}>{sign}</button>"
    )


@dataclass(frozen=True, slots=True)
class RowOrder:
    """What the button of a row asks for: a word, and which row, by the key of its list and its number from 1."""

    word: str
    key: int
    number: int

    def index_in(self, entries: tuple[object, ...], what: str) -> int:
        """Return the index of the row in its list, called ``what``.

        Raises
        ------
        ConfigError
            It was meant for another state of the list, as a second click is when the first has deleted its row.
        """
        if self.key != list_key(entries) or not 1 <= self.number <= len(entries):
            raise ConfigError(f"{what}: the list has changed since; choose the row once more")
        return self.number - 1


def read_order(message: object, words: Collection[str]) -> RowOrder:
    """Return the order that a row's button has written; see :func:`order_button`.

    Raises
    ------
    ConfigError
        It is nothing that a row sends, or its word is none of ``words``.
    """
    parts = str(message).partition(":")[0].split(" ")
    if len(parts) != 3 or parts[0] not in words or not all(part.isdecimal() and len(part) <= 10 for part in parts[1:]):
        raise ConfigError(f"list: got {str(message)[:40]!r}; choose one of its rows")
    return RowOrder(parts[0], int(parts[1]), int(parts[2]))
