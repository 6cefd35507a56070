"""The table of steps, docked below the scene: the values of every step and its RMS residual, whatever tab is open."""

from collections.abc import Callable
from dataclasses import replace

from stair_inspector.errors import one_of
from stair_inspector.viewer.bridge.dock import docked_html
from stair_inspector.viewer.parts.part import Context, PagePart
from stair_inspector.viewer.parts.step_columns import VIEWS, TableLook, shown_values
from stair_inspector.viewer.parts.step_table_html import bar_html, table_html
from stair_inspector.viewer.parts.table import TABLE_CHANGES, pick_row
from stair_inspector.viewer.state.change import PageChange

_VIEW, _COLUMN, _SORT = "view", "column", "sort"


class DockedPart(PagePart):
    """Shows every step, and takes what is clicked in the table: a row, a flight's fold, a column, whose values."""

    depends_on = TABLE_CHANGES

    def __init__(self, context: Context) -> None:
        self._desk = context.desk
        self.html = context.widgets.html()
        self.uuid = context.widgets.orders("Table", self.obey)

    def show(self, what: frozenset[PageChange]) -> None:
        """Show the rows, and over them whose values they are."""
        desk = self._desk
        inspection = desk.marked
        view = shown_values(inspection, desk.table.view)
        body = table_html(inspection, desk.palette, desk.selected, self.uuid, view, desk.unit, desk.table, desk.marks)
        label = desk.shown.label if desk.shown is not None else ""
        content = docked_html(
            bar_html(inspection, view, desk.table, self.uuid), body, f"{label} {view} {desk.unit}", "Table of steps"
        )
        # Sent only where it differs: it takes its place below the scene anew.
        if self.html.content != content:
            self.html.content = content

    def obey(self, message: str) -> None:
        """Do what a click in the table or on the line over it asks for.

        Raises
        ------
        ConfigError
            Nothing in the table asks for this.
        """
        word, _, rest = str(message).rpartition(":")[0].partition(" ")
        if word == _VIEW:
            self.set_view(rest)
        elif word in (_COLUMN, _SORT):
            view, _, name = rest.partition(" ")
            found = one_of(view, VIEWS, "table")
            self._look(lambda look: look.switched(found, name) if word == _COLUMN else look.resorted(found, name))
        else:
            pick_row(self._desk, message)

    def set_view(self, option: str) -> None:
        """Show the survey's or the paper's values."""
        view = one_of(str(option).lower(), VIEWS, "table")
        self._look(lambda look: replace(look, view=view))

    def _look(self, change: Callable[[TableLook], TableLook]) -> None:
        # Clicks are heard on many threads: two in a row both count.
        with self._desk.lock:
            self._desk.table = change(self._desk.table)
            self._desk.changed(PageChange.TABLE)
