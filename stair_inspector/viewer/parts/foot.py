"""What stands below the tabs: a folder with the notes on the result and its details; the keys of the whole page."""

from stair_inspector.viewer.bridge.shortcuts import Command
from stair_inspector.viewer.parts.details_html import details_html, notes_html
from stair_inspector.viewer.parts.glossary_html import glossary_html
from stair_inspector.viewer.parts.part import Context, PagePart
from stair_inspector.viewer.state.change import PageChange

NOTES = "Notes and details"
"""Name of the folder."""


class Foot(PagePart):
    """The foot of the panel."""

    depends_on = frozenset({PageChange.RESULT, PageChange.SETTLED})

    def __init__(self, context: Context) -> None:
        self._context = context
        self._desk = context.desk
        widgets = context.widgets
        with widgets.folder(NOTES, is_open=False):
            self.notes = widgets.html()
            self.details = widgets.html()

    def show(self, what: frozenset[PageChange]) -> None:
        """Show the notes and details of the result."""
        self.notes.content = notes_html(self._desk.marked)
        self.details.content = details_html(self._desk.marked)

    def put_away(self) -> bool:
        """Close the help card."""
        return self._context.help.close()

    def commands(self) -> tuple[Command, ...]:
        """Return the commands of the page as a whole."""
        desk = self._desk
        return (
            Command("Millimetres or inches", lambda: desk.set_unit("in" if desk.unit == "mm" else "mm"), "U"),
            Command("Light or dark theme", lambda: desk.set_theme(not desk.is_dark), "T"),
            Command("Put the selection or tool away", self._context.put_away, "escape"),
            Command("This help", self._switch_help, "H"),
            Command("Run again", self._context.editor.submit, "R"),
            Command("Cancel what is being computed", self._context.cancel),
        )

    def _switch_help(self) -> None:
        self._context.help.switch(self._context.commands(), glossary_html())
