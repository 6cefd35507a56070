"""The list of scans: of each a small picture, its points, its state and what it comes to; a click opens it."""

import base64
import datetime
from collections.abc import Callable
from dataclasses import dataclass, replace

from stair_inspector.content.document import Tone
from stair_inspector.content.remarks import on_page
from stair_inspector.content.wording import verdict_of
from stair_inspector.pictures.render import render_thumbnail
from stair_inspector.viewer.bridge.markup import (
    CHOSEN,
    DIM,
    LINE,
    list_key,
    page_script,
    pick_script,
    press_attribute,
    read_order,
    text,
)
from stair_inspector.viewer.parts.part import Context
from stair_inspector.viewer.scene.step_marks import tone_css

OPEN = "open"
"""Word before the key of the list and the number of the scan that is opened."""
_WIDTH, _HEIGHT = 64, 48
_MOST_WITHOUT_FILTER = 5


@dataclass(frozen=True, slots=True)
class ListedScan:
    """A row: no ``n_points`` and ``png`` for a scan that was not opened, ``why`` for one that cannot be read."""

    label: str
    state: str = "not opened"
    n_points: int | None = None
    verdict: str = ""
    tone: Tone = "plain"
    date: str = ""
    png: bytes = b""
    why: str = ""


class ScanList:
    """The list on the Scan tab; ``uuid`` is the control that its rows write to."""

    def __init__(self, context: Context, open_scan: Callable[[str], None]) -> None:
        self._context = context
        self._open_scan = open_scan
        self._desk = context.desk
        self.html = context.widgets.html()
        self.uuid = context.widgets.orders("Chosen scan", self.take)
        self._known: dict[str, ListedScan] = {}

    def show(self) -> None:
        """List the scans with what is known of them; the desk is held."""
        self._learn()
        labels, label = self._context.opening.labels(), self._context.keeper.label
        content = scan_list_html(tuple(map(self._row, labels)), label, self.uuid)
        if self.html.content != content:
            self.html.content = content

    def draw(self) -> None:
        """Make the small picture of the scan that is shown, where there is none yet; the desk is held."""
        shown = self._desk.shown
        if shown is None or self._known.get(shown.label, ListedScan("")).png:
            return
        self._learn()
        png = render_thumbnail(shown.scan, shown.inspection, (_WIDTH, _HEIGHT))
        self._known[shown.label] = replace(self._known[shown.label], png=png)
        self.show()

    def take(self, message: str) -> None:
        """Open the scan of the row that has written a message."""
        labels = self._context.opening.labels()
        label = labels[read_order(message, (OPEN,)).index_in(labels, "scans")]
        self._open_scan(label)

    def _learn(self) -> None:
        """Note what the result that is shown says of its scan."""
        shown = self._desk.shown
        if shown is None:
            return
        check = self._context.judge.check
        status = verdict_of(check) if check is not None else None
        old = self._known.get(shown.label, ListedScan(shown.label))
        self._known[shown.label] = replace(
            old,
            state="question open" if shown.inspection.questions else "measured",
            n_points=len(shown.scan.points),
            verdict=status.words if status is not None else "",
            tone=status.tone if status is not None else "plain",
        )

    def _row(self, label: str) -> ListedScan:
        opening, keeper = self._context.opening, self._context.keeper
        row = replace(self._known.get(label, ListedScan(label)), date=_date_of(opening.changed_at(label)))
        error = opening.unreadable.get(label)
        if error is not None:
            return replace(row, state="cannot be read", why=on_page(str(error)))
        if row.state == "measured" and keeper.is_saved(label):
            return replace(row, state="saved")
        return row


def scan_list_html(rows: tuple[ListedScan, ...], opened: str, pick_uuid: str) -> str:
    """Return the list.

    Parameters
    ----------
    rows : tuple of ListedScan
        In their order.
    opened : str
        Label of the scan that is open.
    pick_uuid : str
        Identity of the control that a row writes to.
    """
    key = list_key(tuple(row.label for row in rows))
    items = "".join(
        _row_html(row, pick_script(pick_uuid, number, f"{OPEN} {key}"), is_open=row.label == opened)
        for number, row in enumerate(rows, start=1)
    )
    field = ""
    if len(rows) > _MOST_WITHOUT_FILTER:
        field = (
            '<input type="search" data-testid="scan-filter" aria-label="Find a scan" placeholder="Find a scan" '
            f'style="width:100%;box-sizing:border-box;font:inherit;padding:3px 8px;margin-bottom:4px;color:inherit;'
            f'background:var(--mantine-color-body);border:1px solid {LINE};border-radius:4px">'
        )
    return (
        f'<div data-testid="scan-list" style="padding:2px 9px 8px;font-size:12px">{field}'
        '<ul aria-label="Scans" style="list-style:none;margin:0;padding:0;max-height:236px;overflow:auto;'
        f'border:1px solid {LINE};border-radius:4px">{items}</ul>{page_script("scan_list")}</div>'
    )


def _row_html(row: ListedScan, script: str, *, is_open: bool) -> str:
    facts = [f"{row.n_points:,} points" if row.n_points is not None else "", row.state]
    words = " · ".join(text(fact) for fact in facts if fact)
    if row.verdict:
        words += f' · <b style="color:{tone_css(row.tone)}">{text(row.verdict)}</b>'
    why = f'<span style="display:block;color:{tone_css("bad")}">{text(row.why)}</span>' if row.why else ""
    return (
        f'<li style="border-bottom:1px solid {LINE}"><button type="button" data-testid="scan-row" '
        f'data-scan="{text(row.label)}" data-state="{text(row.state)}" aria-current="{"true" if is_open else "false"}" '
        f"{press_attribute(script)} "
        'style="display:flex;gap:8px;align-items:center;width:100%;border:0;text-align:left;font:inherit;color:inherit;'
        f'cursor:pointer;padding:3px 6px;background:{CHOSEN if is_open else "none"}">{_picture_html(row.png)}'
        '<span style="flex:1;min-width:0;overflow-wrap:anywhere">'
        f'<span style="display:flex;justify-content:space-between;gap:8px"><b>{text(row.label)}</b>'
        f'<span style="color:{DIM};font-size:11px;white-space:nowrap">{text(row.date)}</span></span>'
        f'<span style="color:{DIM}">{words}</span>{why}</span></button></li>'
    )


def _picture_html(png: bytes) -> str:
    size = f"width:{_WIDTH}px;height:{_HEIGHT}px;flex:none;border-radius:3px"
    if not png:
        return f'<span aria-hidden="true" style="{size};box-sizing:border-box;border:1px dashed {LINE}"></span>'
    data = base64.b64encode(png).decode()
    return f'<img alt="" width="{_WIDTH}" height="{_HEIGHT}" src="data:image/png;base64,{data}" style="{size}">'


def _date_of(changed_at: float | None) -> str:
    return "" if changed_at is None else datetime.datetime.fromtimestamp(changed_at).strftime("%Y-%m-%d")
