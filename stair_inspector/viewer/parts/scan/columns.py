"""Which columns of a text are x, y and z: asked, with its first lines, where the file does not say it."""

from stair_inspector.errors import ColumnsUnclear
from stair_inspector.viewer.bridge.markup import LINE, list_key, pick_script, press_attribute, read_order, text
from stair_inspector.viewer.parts.part import Context

_TAKE = "columns"
"""Word before the key of the list of answers and the number of one of them."""
_NAME = "columns"


class ColumnsTool:
    """The question on the Scan tab with a button for each likely answer, and the field for any other."""

    def __init__(self, context: Context) -> None:
        self._keeper = context.keeper
        self._opening = context.opening
        self._editor = context.editor
        widgets = context.widgets
        self.asked = widgets.html()
        self._uuid = widgets.orders("Chosen columns", self.take)
        with widgets.folder("Columns of a text", is_open=False):
            self._editor.controls.add_text(_NAME)
            widgets.button("Read with these columns", self.apply, is_quiet=True, hint="Counts for scans in text alone.")

    def show(self) -> None:
        """Ask where it is not certain what the columns of the open scan are."""
        error = self._error()
        content = "" if error is None else columns_html(error, self._uuid)
        if self.asked.content != content:
            self.asked.content = content

    def take(self, message: str) -> None:
        """Read the scan with the columns of the button that has written a message."""
        error = self._error()
        proposals = () if error is None else error.proposals
        chosen = proposals[read_order(message, (_TAKE,)).index_in(proposals, "columns")]
        self._editor.adjust(lambda params: params.replaced(_NAME, chosen), f"columns {chosen}")

    def apply(self) -> None:
        """Read the scan with the columns that are written."""
        self._editor.controls.submit_texts(_NAME)
        self._editor.submit()

    def _error(self) -> ColumnsUnclear | None:
        error = self._opening.unreadable.get(self._keeper.label)
        return error if isinstance(error, ColumnsUnclear) else None


def columns_html(error: ColumnsUnclear, pick_uuid: str) -> str:
    """Return the question: the first lines of the file, and a button for each likely answer."""
    key = list_key(error.proposals)
    buttons = "".join(
        f'<button type="button" data-testid="columns-answer" '
        f"{press_attribute(pick_script(pick_uuid, number, f'{_TAKE} {key}'))} "
        f'style="border:1px solid {LINE};border-radius:4px;background:var(--mantine-color-body);color:inherit;'
        f'font:inherit;font-weight:600;padding:1px 8px;margin:2px 4px 2px 0;cursor:pointer">{text(proposal)}</button>'
        for number, proposal in enumerate(error.proposals, start=1)
    )
    lines = text("\n".join(error.lines))
    return (
        '<div data-testid="columns-question" role="status" style="font-size:12px;line-height:1.4;padding:2px 9px 8px">'
        "<b>Which columns are x, y and z?</b> The file does not say it; it begins"
        f'<pre style="overflow-x:auto;border:1px solid {LINE};border-radius:4px;padding:4px 6px;margin:4px 0">'
        f"{lines}</pre>{buttons}<div>Or write under Columns of a text what each of them is, '-' for one to skip."
        "</div></div>"
    )
