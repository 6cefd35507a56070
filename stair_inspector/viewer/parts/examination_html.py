"""What was found about a scan before it was measured, on the page: what is asked with its answers, what is doubtful."""

from collections.abc import Sequence

from stair_inspector.content.cures import Cure, cures_of
from stair_inspector.content.examination import examined
from stair_inspector.content.remarks import on_page
from stair_inspector.model import Inspection, Observation
from stair_inspector.viewer.bridge.markup import DIM, LINE, list_key, pick_script, press_attribute, text
from stair_inspector.viewer.scene.step_marks import tone_css

CURE = "cure"
"""Word before the key of the list of cures and the number of one of them."""
_MOST = 3
"""Lines above the tabs, where they take room from all of them; the Scan tab has the others."""
_LINE = "white-space:nowrap;overflow:hidden;text-overflow:ellipsis"
_SIGNS = {"question": "?", "doubt": "▲", "info": "i"}
_COLORS = {"question": tone_css("bad"), "doubt": tone_css("close"), "info": DIM}
_GROUNDS = {"question": "rgba(224,49,49,.12)", "doubt": "rgba(232,137,12,.14)", "info": "none"}


def offered_cures(inspection: Inspection | None) -> tuple[Cure, ...]:
    """Return the cures that buttons offer, in the order of their numbers."""
    if inspection is None:
        return ()
    return tuple(cure for found in examined(inspection) for cure in cures_of(found))


def headline_html(inspection: Inspection | None, pick_uuid: str) -> str:
    """Return what stands above the tabs: questions in full with their answers, the rest on a line each that opens.

    Parameters
    ----------
    inspection : Inspection, optional
        None shows nothing, as one of a sound scan does.
    pick_uuid : str
        Identity of the control that a button writes to.
    """
    if inspection is None or not inspection.examination:
        return ""
    found, shown = examined(inspection), _n_above(inspection)
    rows = [_row(each, inspection, pick_uuid, is_full=each.level == "question") for each in found[:shown]]
    if len(found) > shown:
        rows.append(f'<div style="color:{DIM}">and {len(found) - shown} more on the Scan tab</div>')
    return _block("examination", rows, "0 9px 7px")


def examination_html(inspection: Inspection | None, pick_uuid: str) -> str:
    """Return what the Scan tab begins with: what was found about the scan and is not above the tabs, with its cure."""
    below = () if inspection is None else examined(inspection)[_n_above(inspection) :]
    if inspection is None or not below:
        return ""
    rows = [_row(each, inspection, pick_uuid, is_full=True) for each in below]
    return _block("scan-examination", rows, "2px 9px 8px")


def _n_above(inspection: Inspection) -> int:
    """Return how many of what was found stand above the tabs."""
    return max(_MOST, len(inspection.questions))


def _block(name: str, rows: Sequence[str], padding: str) -> str:
    return (
        f'<div data-testid="{name}" role="status" aria-label="Examination of the scan" '
        f'style="font-size:12px;line-height:1.4;padding:{padding};overflow-wrap:anywhere">{"".join(rows)}</div>'
    )


def _row(found: Observation, inspection: Inspection, pick_uuid: str, *, is_full: bool) -> str:
    words = on_page(found.message)
    cures = cures_of(found)
    said = "" if found.cure.startswith("--") and cures else on_page(found.cure)
    said = said[:1].upper() + said[1:]
    more = f'<div style="color:{DIM}">{text(said)}</div>' if said else ""
    buttons = _buttons(cures, inspection, pick_uuid, is_answer=found.level == "question")
    withheld = ""
    if found.level == "question" and inspection.is_withheld:
        withheld = "<div>No value is given and nothing is judged before this is answered:</div>"
    named = (
        f'<b style="color:{_COLORS[found.level]}"><span aria-hidden="true">{_SIGNS[found.level]}</span> '
        f"{found.level}</b> {text(words)}"
    )
    told = f"{named}{more}" if is_full else f'<details><summary style="{_LINE}">{named}</summary>{more}</details>'
    return (
        f'<div data-testid="observation" data-level="{found.level}" data-code="{text(found.code)}" '
        f'style="background:{_GROUNDS[found.level]};border-left:3px solid {_COLORS[found.level]};border-radius:3px;'
        f'padding:2px 6px;margin:2px 0">{told}{withheld}{buttons}</div>'
    )


def _buttons(cures: Sequence[Cure], inspection: Inspection, pick_uuid: str, *, is_answer: bool) -> str:
    if not cures:
        return ""
    offered = offered_cures(inspection)
    key = list_key(offered)
    made = "".join(
        f'<button type="button" data-testid="cure" '
        f"{press_attribute(pick_script(pick_uuid, offered.index(cure) + 1, f'{CURE} {key}'))} "
        f'style="border:1px solid {LINE};border-radius:4px;background:var(--mantine-color-body);color:inherit;'
        f'font:inherit;font-weight:600;padding:1px 8px;margin:2px 4px 2px 0;cursor:pointer">'
        f"{text(_label(cure, is_answer=is_answer))}</button>"
        for cure in cures
    )
    return f"<div>{made}</div>"


def _label(cure: Cure, *, is_answer: bool) -> str:
    words = cure.words[:1].upper() + cure.words[1:]
    return words if is_answer or words.startswith("Set ") else f"{words}: measure so"
