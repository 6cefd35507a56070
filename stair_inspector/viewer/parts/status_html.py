"""The parts of the page that viser has no widget for, as HTML and SVG made from an inspection.

Every text that could come from a file is escaped. Colours of the theme are taken from its variables, so that light
and dark both read well.
"""

from stair_inspector.content.remarks import n_to_look_at, on_page
from stair_inspector.model import Inspection
from stair_inspector.viewer.bridge.markup import DIM, LINE, press_attribute, set_script, text, unfold_attribute
from stair_inspector.viewer.bridge.styles import NARROW_TABS, STALE_RESULTS
from stair_inspector.viewer.scene.step_marks import TONE_CSS


def state_html(
    inspection: Inspection | None,
    *,
    busy: str | None,
    error: str | None,
    is_stale: bool,
    percent: float | None = None,
    cancel_uuid: str,
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
    cancel_uuid : str
        Identity of the control that stops it.
    """
    if error is not None:
        badge = _badge("✕", TONE_CSS["bad"], "no result" if inspection is None else "no result for these settings")
    elif busy is not None:
        badge = _badge("◌", TONE_CSS["close"], busy)
    else:
        badge = _badge("●", TONE_CSS["good"], "up to date")
    words = _headline(inspection, with_more=busy is None)
    cancel = _cancel_html(cancel_uuid) if percent is not None else ""
    lines = [
        f'<div data-testid="state" data-state="{_state(busy, error)}" style="display:flex;gap:5px;align-items:center;'
        f'height:20px;white-space:nowrap">{badge}<span style="flex:1;overflow:hidden;text-overflow:ellipsis">{words}'
        f"</span>{cancel}</div>{_progress_html(percent)}"
    ]
    if error is not None:
        style = f"color:{TONE_CSS['bad']};padding:3px 0"
        lines.append(f'<div data-testid="error" role="alert" style="{style}">{text(on_page(error))}</div>')
    if is_stale and inspection is not None:
        if error is not None:
            words = "In a dashed frame: the last good result; Notes and details has its settings."
            lines.append(f'<div style="color:{DIM}">{words}</div>')
        lines.append(STALE_RESULTS)
    style = "font-size:12px;line-height:1.4;padding:2px 9px 7px"
    return f'<div data-testid="status" style="{style}">{"".join(lines)}</div>'


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


def view_only_html() -> str:
    """Return the line on a page that changes nothing."""
    return (
        '<div data-testid="view-only" role="note" style="padding:3px 9px;font-size:12px;'
        f'border-bottom:1px solid {LINE}">'
        "<b>View only.</b> The work as it was last saved; what you choose to look at is yours alone.</div>"
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
        ' · <button type="button" data-testid="notes-link" title="Open the notes, below" '
        f"{unfold_attribute('notes')} "
        f'style="border:0;background:none;cursor:pointer;font:inherit;padding:0 4px;border-radius:3px;{style}">'
        f"{'▲ ' if n_look else ''}{words}</button>"
    )
