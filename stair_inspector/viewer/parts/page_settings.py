"""What stands below the tabs: the notes on the result, its details, and how the page itself is shown."""

import viser

from stair_inspector.units import UNITS
from stair_inspector.viewer.bridge.shortcuts import Command
from stair_inspector.viewer.parts.details_html import details_html, notes_html
from stair_inspector.viewer.parts.part import Context, PagePart
from stair_inspector.viewer.state.change import PageChange


class PageSettings(PagePart):
    """The foot of the panel."""

    depends_on = frozenset({PageChange.RESULT, PageChange.SETTLED, PageChange.UNIT, PageChange.THEME})

    def __init__(self, context: Context) -> None:
        self._context = context
        self._desk = desk = context.desk
        widgets = context.widgets
        self.notes = widgets.html()
        with widgets.folder("Details", is_open=False):
            self.details = widgets.html()
        self._unit = widgets.choice(
            "Lengths in",
            UNITS,
            UNITS[0],
            desk.set_unit,
            hint="On this page only; files are in metres and millimetres. Key U.",
        )
        self._dark = widgets.checkbox("Dark theme", hint="Key T.", on_change=desk.set_theme)
        widgets.button(
            "Keys and help",
            self._switch_help,
            icon=viser.Icon.KEYBOARD,
            is_quiet=True,
            hint="Key H; Ctrl+K searches all commands.",
        )

    def show(self, what: frozenset[PageChange]) -> None:
        """Show the notes and details of the result, and how the page is shown."""
        desk = self._desk
        if what & {PageChange.RESULT, PageChange.SETTLED}:
            self.notes.content = notes_html(desk.marked)
            self.details.content = details_html(desk.marked)
        self._unit.show(desk.unit)
        self._dark.value = desk.is_dark

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
        self._context.help.switch(self._context.commands())
