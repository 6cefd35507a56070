"""The tools for looking and measuring: the Look tab, and the toolbar over the scene."""

from dataclasses import dataclass

import viser

from stair_inspector.viewer.cameras import VIEWS
from stair_inspector.viewer.desk import Desk, Editor
from stair_inspector.viewer.looking import Looking
from stair_inspector.viewer.overlay import Tool, toolbar_html
from stair_inspector.viewer.panel import Panel
from stair_inspector.viewer.results import Results
from stair_inspector.viewer.scene import MODES
from stair_inspector.viewer.tools.measure import MeasureTool
from stair_inspector.viewer.tools.section import SectionTool
from stair_inspector.viewer.tools.views import ViewTool


@dataclass(frozen=True, slots=True)
class Toolbar:
    """The tools of one page."""

    views: ViewTool
    section: SectionTool
    measure: MeasureTool

    def show(self) -> None:
        """Show what belongs to the present work and result."""
        self.views.show()
        self.section.show()
        self.measure.show()


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
    modes, cameras, targets = views.control_uuids
    panel.toolbar.content = toolbar_html(
        (
            tuple(Tool(mode, f"Show: {mode}", modes, mode) for mode in MODES),
            tuple(Tool(view, f"View: {view} (key {key})", cameras, view) for key, view in enumerate(VIEWS, start=1)),
            (Tool("Step", "Look at the chosen step (key S)", targets, "Chosen step"),),
        )
    )
    return Toolbar(views, section, measure)
