"""The tools for looking and measuring: the Look tab, and the toolbar over the scene."""

from dataclasses import dataclass

import viser

from stair_inspector.pictures.cameras import VIEWS
from stair_inspector.units import UNITS
from stair_inspector.viewer.bridge.handles import uuid_of
from stair_inspector.viewer.bridge.overlay import Tool, toolbar_html
from stair_inspector.viewer.parts.desk import Desk, Editor
from stair_inspector.viewer.parts.look.look import Looking
from stair_inspector.viewer.parts.look.measure import MeasureTool
from stair_inspector.viewer.parts.look.section import SectionTool
from stair_inspector.viewer.parts.look.views import TARGETS, ViewTool
from stair_inspector.viewer.parts.panel import Panel
from stair_inspector.viewer.parts.steps.results import Results
from stair_inspector.viewer.scene.stage import MODES


@dataclass(frozen=True, slots=True)
class Toolbar:
    """The tools of one page."""

    views: ViewTool
    section: SectionTool
    measure: MeasureTool
    panel: Panel
    desk: Desk

    def show(self) -> None:
        """Show what belongs to the present work and result."""
        self.views.show()
        self.section.show()
        self.measure.show()
        self.show_buttons()

    def show_buttons(self) -> None:
        """Show the buttons over the scene, and which of them are on."""
        desk, panel = self.desk, self.panel
        modes, cameras, targets = self.views.control_uuids
        dark, help_button = (uuid_of(control) for control in (panel.dark, panel.help))
        theme = Tool("Light" if desk.is_dark else "Dark", "Light or dark theme (key T)", dark, not desk.is_dark)
        content = toolbar_html(
            (
                tuple(
                    Tool(mode, f"Show: {mode} (key {key})", modes, mode, mode == desk.stage.mode)
                    for key, mode in enumerate(MODES, start=7)
                ),
                tuple(
                    Tool(view, f"View: {view} (key {key})", cameras, view) for key, view in enumerate(VIEWS, start=1)
                ),
                (Tool("Step", "Look at the chosen step (key F)", targets, TARGETS[0]),),
                tuple(
                    Tool(unit, f"Lengths in {unit} (key U)", panel.unit.uuid, unit, unit == desk.unit) for unit in UNITS
                ),
                (theme, Tool("Help", "Keys and mouse (key H)", help_button, True)),
            )
        )
        # Sent only where it differs: it takes its place over the scene anew.
        if panel.toolbar.content != content:
            panel.toolbar.content = content


def add_toolbar(
    gui: viser.GuiApi, panel: Panel, desk: Desk, looking: Looking, results: Results, editor: Editor
) -> Toolbar:
    """Fill the Look tab, and put the buttons that are needed most over the scene."""
    with panel.look:
        views = ViewTool(gui, desk, looking, editor)
        with gui.add_folder("Section"):
            section = SectionTool(gui, desk, looking, results)
        with gui.add_folder("Measure"):
            measure = MeasureTool(gui, desk, looking, editor, lambda: section.display)
    toolbar = Toolbar(views, section, measure, panel, desk)
    toolbar.show_buttons()
    views.on_mode = toolbar.show_buttons
    return toolbar
