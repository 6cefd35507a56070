"""The Steps tab: the chosen step's card, the inspector's verdicts, and the surfaces that were rejected."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import viser

from stair_inspector.pictures.segmentation import SURFACE
from stair_inspector.viewer.bridge.choices import Choice
from stair_inspector.viewer.bridge.controls import VERDICTS, SettingControls
from stair_inspector.viewer.bridge.notices import from_page
from stair_inspector.viewer.parts.steps.html import COLUMNS, Columns

NO_STEP = "none"
TAKE_BACK = "as found"
"""The verdict that takes an overrule back."""


@dataclass(frozen=True)
class StepsActions:
    """What the Steps tab and the tables call."""

    on_select: Callable[[str], None]
    on_columns: Callable[[str], None]
    on_rejected: Callable[[bool], None]
    on_mark: Callable[[str], None]
    on_texts: Callable[[], None]
    on_clear_overrules: Callable[[], None]


class StepsTable:
    """A table of steps with its choice of columns; there is one on the Tune tab and one on the Steps tab."""

    def __init__(self, gui: viser.GuiApi, actions: StepsActions) -> None:
        names = tuple(columns.capitalize() for columns in COLUMNS)
        self.columns = Choice(
            gui,
            "Table",
            names,
            names[0],
            "The survey's values with their uncertainties, or the paper's.",
            is_visible=False,
        )
        self.columns.group.on_click(from_page(actions.on_columns, lambda: self.columns.group.value))
        self.html = gui.add_html("")

    def show(self, content: str, columns: Columns, *, is_survey: bool) -> None:
        """Show the rows, and the choice of columns where there is one."""
        self.columns.group.visible = is_survey
        self.columns.show(columns.capitalize())
        self.html.content = content


class StepsTab:
    """The controls of the tab; the overrules among them belong to ``controls``."""

    def __init__(self, gui: viser.GuiApi, controls: SettingControls, actions: StepsActions) -> None:
        self.table = StepsTable(gui, actions)
        self.selected: Any = gui.add_dropdown(
            "Selected step",
            (NO_STEP,),
            initial_value=NO_STEP,
            hint="Highlights the step; so does a click on its row or tread, and the arrow keys.",
        )
        self.selected.on_update(from_page(actions.on_select, lambda: self.selected.value))
        self.card = gui.add_html("")
        self.pictures = gui.add_html("")
        self._add_overrules(gui, controls, actions)
        self.show_rejected: Any = gui.add_checkbox(
            "Show rejected surfaces",
            False,
            hint="Colours the surfaces that are no part of the staircase and lists them with the reason.",
            visible=False,
        )
        self.show_rejected.on_update(from_page(actions.on_rejected, lambda: self.show_rejected.value))
        self.rejected = gui.add_html("")

    def offer_steps(self, step_ids: Iterable[int], surface_ids: Iterable[int], chosen: str) -> None:
        """List the steps and surfaces in the menu and set the chosen one."""
        surfaces = (f"{SURFACE} {patch_id}" for patch_id in surface_ids)
        options = (NO_STEP, *map(str, step_ids), *surfaces)
        if tuple(self.selected.options) != options:
            self.selected.options = options
        self.selected.value = chosen

    def _add_overrules(self, gui: viser.GuiApi, controls: SettingControls, actions: StepsActions) -> None:
        """Add the decisions of the inspector: for the chosen step or surface by a button, for all others as text."""
        form: Any = gui.add_form("Overrules", expand_by_default=False)
        with form:
            self.reason: Any = gui.add_text("Reason", "", hint="Why, in one line; it is kept with the verdict.")
            mark = gui.add_button_group(
                "Mark as",
                (*VERDICTS, TAKE_BACK),
                hint="What the chosen step or rejected surface is, whatever the program says. Undo takes it back.",
            )
            for name in ("overrules.force", "overrules.climb"):
                # Enter submits; until then the text may be half a word.
                controls.add_text(name)
            apply = gui.add_button("Apply overrules", icon=viser.Icon.CHECK, hint="So does Enter in a field.")
            clear = gui.add_button("Clear overrules", icon=viser.Icon.ERASER, color="gray")
        mark.on_click(from_page(actions.on_mark, lambda: mark.value))
        apply.on_click(lambda _: form.submit())
        form.on_submit(lambda _: actions.on_texts())
        clear.on_click(lambda _: actions.on_clear_overrules())
