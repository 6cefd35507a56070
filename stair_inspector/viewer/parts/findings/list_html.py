"""The list of findings as HTML: a row for each, which looks at it, with buttons to change it."""

import base64

from stair_inspector.content.finding_list import ListedFinding
from stair_inspector.content.finding_tables import SEVERITY_TONES, moment_words
from stair_inspector.content.images import Photo
from stair_inspector.viewer.bridge.markup import (
    CHOSEN,
    DIM,
    LINE,
    aside,
    button_in_row,
    list_key,
    pick_script,
    row_attributes,
    text,
)
from stair_inspector.viewer.scene.step_marks import tone_css

FINDING_ORDERS = ("show", "done", "delete")
"""What a row and its buttons ask for."""
_MOST_ROWS = 300
_STYLE = "font-size:12px;line-height:1.35;padding:0 8px 6px 5px"
_BUTTON = "border:0;background:none;cursor:pointer;color:inherit;padding:2px 4px;font-size:14px"


def keys_of(findings: tuple[ListedFinding, ...]) -> tuple[str, ...]:
    """Return what names this list in the orders of its rows: values that change with a slider do not change it."""
    return tuple(entry.key for entry in findings)


def findings_html(
    findings: tuple[ListedFinding, ...], chosen: str, order_uuid: str, *, with_done: bool, said_of: frozenset[str]
) -> str:
    """Return the list.

    Parameters
    ----------
    findings : tuple of ListedFinding
        All of them; their texts come from files and fields and are escaped.
    chosen : str
        Key of the one that is emphasised, empty for none.
    order_uuid : str
        Identity of the control that a row writes to.
    with_done : bool
        Whether those that are done are listed too.
    said_of : frozenset of str
        Keys of findings of the program of which the inspector said something, which can be taken back.
    """
    n_open = sum(not entry.is_done for entry in findings)
    told = f"{n_open} open, {len(findings) - n_open} done"
    if not findings:
        words = "Nothing was found. To pin what you find: choose a step or pick a point, write it down, set the pin."
        return aside("findings", words)
    listed = [entry for entry in findings if with_done or not entry.is_done]
    key = list_key(keys_of(findings))
    rows = "".join(
        _row(entry, key, order_uuid, is_chosen=entry.key == chosen, has_words=entry.is_pin or entry.key in said_of)
        for entry in listed[:_MOST_ROWS]
    )
    more = f" The first {_MOST_ROWS} are listed." if len(listed) > _MOST_ROWS else ""
    return (
        f'<div data-testid="findings" style="{_STYLE}"><div data-testid="findings-told" style="color:{DIM};'
        f'padding:0 4px 4px">{told}.{more}</div>{rows}</div>'
    )


def chosen_html(entry: ListedFinding | None, place: str, photo: Photo | None) -> str:
    """Return what the fields below are about: a new pin at a place, or a finding that was chosen, with its photograph.

    ``photo`` is that of the new pin.
    """
    picture = photo if entry is None else entry.photo
    if entry is None:
        words = f"<b>New pin</b> at {text(place)}"
    else:
        who = f", {text(entry.who)}" if entry.who else ""
        when = f", {moment_words(entry.when)}" if entry.when else ""
        words = f"<b>Finding {entry.number}</b>, {text(entry.where)}{who}{when}"
        words += "" if entry.is_pin else f"<br>{text(entry.text)}"
    image = ""
    if picture is not None:
        data = base64.b64encode(picture.data).decode("ascii")
        image = (
            f'<img data-testid="finding-photo" alt="photograph" src="data:image/jpeg;base64,{data}" '
            'style="display:block;max-width:100%;max-height:180px;margin-top:4px">'
        )
    return f'<div data-testid="finding-chosen" style="{_STYLE};overflow-wrap:anywhere">{words}{image}</div>'


def _row(entry: ListedFinding, key: int, order_uuid: str, *, is_chosen: bool, has_words: bool) -> str:
    def button(order: str, words: str, sign: str) -> str:
        script = pick_script(order_uuid, entry.number, f"{order} {key}")
        title = text(f"{words} {entry.number}")
        names = f'title="{title}" aria-label="{title}"'
        return f'<button type="button" {names} style="{_BUTTON}" {button_in_row(script)}>{sign}</button>'

    tone = tone_css(SEVERITY_TONES[entry.severity])
    faded = "opacity:0.65;" if entry.is_done else ""
    shown = f"background:{CHOSEN};" if is_chosen else ""
    remark = f'<div style="font-style:italic">{text(entry.remark)}</div>' if entry.remark else ""
    photo = ' <span title="with a photograph" role="img" aria-label="with a photograph">▣</span>' if entry.photo else ""
    done = button("done", "open again finding", "↺") if entry.is_done else button("done", "mark as done finding", "✓")
    taken = "delete finding" if entry.is_pin else "take back what was said of finding"
    delete = button("delete", taken, "✕") if has_words else ""
    script = pick_script(order_uuid, entry.number, f"show {key}")
    return (
        f'<div data-testid="finding-row" data-finding="{entry.number}" data-kind="{text(entry.kind)}" '
        f'data-state="{entry.state}" style="display:flex;gap:6px;align-items:flex-start;padding:3px 4px;{shown}{faded}'
        f'border-bottom:1px solid {LINE};cursor:pointer"{row_attributes(script, has_buttons=True)}>'
        f'<span style="min-width:1.4em;text-align:right">{entry.number}</span>'
        f'<span style="flex:1;min-width:0;overflow-wrap:anywhere"><b>{text(entry.where)}</b> · '
        f'<b style="color:{tone}">{entry.severity}</b> · {entry.state}{photo}<br>{text(entry.text)}{remark}</span>'
        f'<span style="white-space:nowrap">{done}{delete}</span></div>'
    )
