"""The Export tab: the title, the result's files, pictures, and the project."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import viser

from stair_inspector.pictures.cameras import VIEWS
from stair_inspector.pictures.picture import BACKGROUNDS
from stair_inspector.viewer.bridge.notices import from_page
from stair_inspector.viewer.parts.export.report_tab import ReportActions, ReportFolder

CURRENT_VIEW = "Current"
SIZES = {"screen": 1, "2 ×": 2, "4 ×": 4}
"""Size of a picture, times the scene's size on the screen."""


@dataclass(frozen=True)
class ExportActions:
    """What the Export tab calls."""

    on_title: Callable[[str], None]
    on_download: Callable[[str], None]
    on_open_project: Callable[[Any], None]
    report: ReportActions


class ExportTab:
    """The controls of the tab."""

    def __init__(self, gui: viser.GuiApi, actions: ExportActions) -> None:
        gui.add_html(
            '<div style="font-size:12px;padding:2px 9px 6px">Files hold the numbers and settings of the result shown, '
            "not of a slider that is still moving.</div>"
        )
        self.title: Any = gui.add_text("Title", "", hint="Of the inspection; it stands on pictures and in the project.")
        self.title.on_update(from_page(actions.on_title, lambda: self.title.value))
        self.report = ReportFolder(gui, actions.report)
        for kind, icon, hint in (
            ("CSV", viser.Icon.TABLE, "One row for each step, millimetres and degrees."),
            ("JSON", viser.Icon.BRACES, "Everything: settings, levels, steps, notes; metres and degrees."),
            ("Debug PLY", viser.Icon.CUBE, "The scan in the paper's colours with its edges."),
        ):
            self._add_download(gui, actions, kind, icon, hint)
        with gui.add_folder("Pictures"):
            self.view: Any = gui.add_dropdown(
                "View", (CURRENT_VIEW, *VIEWS), initial_value=CURRENT_VIEW, hint="What the picture shows."
            )
            self.ground: Any = gui.add_dropdown("Background", BACKGROUNDS, initial_value=BACKGROUNDS[0])
            self.size: Any = gui.add_dropdown(
                "Size",
                tuple(SIZES),
                initial_value="2 ×",
                hint="Times the scene's size on the screen; the longer side has 7680 pixels at most.",
            )
            self._add_download(
                gui, actions, "Screenshot PNG", viser.Icon.CAMERA, "With title, scale bar, legend, date and settings."
            )
            self._add_download(gui, actions, "All views ZIP", viser.Icon.PHOTO, "Every standard view, in one file.")
        with gui.add_folder("Project"):
            self.saved = gui.add_html("")
            self._add_download(
                gui,
                actions,
                "Project file",
                viser.Icon.BRIEFCASE,
                "Settings, overrules, measurements, views and names; measure --project reproduces its numbers.",
            )
            self.open: Any = gui.add_upload_button(
                "Open project", icon=viser.Icon.FOLDER_OPEN, mime_type=".json", hint="Of this same scan."
            )
            self.open.on_upload(lambda _: actions.on_open_project(self.open.value))

    def _add_download(self, gui: viser.GuiApi, actions: ExportActions, kind: str, icon: Any, hint: str) -> None:
        button = gui.add_button(kind, icon=icon, hint=hint)
        button.on_click(partial(_download, actions, kind))


def _download(actions: ExportActions, kind: str, _: Any) -> None:
    actions.on_download(kind)
