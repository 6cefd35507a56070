"""The Scan tab: which file, its unit, up and region, and how its points are drawn."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import viser

from stair_inspector.pictures.coloring import COLOR_MODES
from stair_inspector.viewer.bridge.controls import SettingControls
from stair_inspector.viewer.bridge.notices import from_page
from stair_inspector.viewer.state.library import upload_types

UP_TOOLS = ("Pick 3 floor points", "Take the treads")
REGION_TOOLS = ("Around the stair", "Whole scan")


@dataclass(frozen=True)
class ScanActions:
    """What the Scan tab calls."""

    on_scan: Callable[[str], None]
    on_refresh: Callable[[], None]
    on_upload: Callable[[Any], None]
    on_up_tool: Callable[[str], None]
    on_region_tool: Callable[[str], None]
    on_region_shown: Callable[[bool], None]
    on_region_corner: Callable[[], None]
    on_region_apply: Callable[[], None]
    on_color: Callable[[str], None]
    on_shading: Callable[[bool], None]
    on_density: Callable[[int], None]
    on_point_size: Callable[[float], None]


class ScanTab:
    """The controls of the tab; the settings among them belong to ``controls``."""

    def __init__(
        self, gui: viser.GuiApi, labels: tuple[str, ...], controls: SettingControls, actions: ScanActions
    ) -> None:
        self.examination = gui.add_html("")
        self.chooser: Any = gui.add_dropdown(
            "Scan", labels, initial_value=labels[0], hint="The scans of the folder, and those uploaded on this page."
        )
        self.chooser.on_update(from_page(actions.on_scan, lambda: self.chooser.value))
        self.upload: Any = gui.add_upload_button(
            "Upload a scan",
            icon=viser.Icon.UPLOAD,
            mime_type=upload_types(),
            hint="Kept until the server ends; only this browser sees it.",
        )
        self.upload.on_upload(lambda _: actions.on_upload(self.upload.value))
        refresh = gui.add_button("Look for new scans", icon=viser.Icon.REFRESH, color="gray")
        refresh.on_click(lambda _: actions.on_refresh())
        controls.add_choice("method")
        controls.add_choice("unit")
        self._add_up(gui, controls, actions)
        self._add_region(gui, actions)
        self._add_points(gui, actions)
        controls.add_choice("normals.source")

    def offer(self, labels: tuple[str, ...], chosen: str) -> None:
        """List the scans in the menu and set the chosen one."""
        if tuple(self.chooser.options) != labels:
            self.chooser.options = labels
        self.chooser.value = chosen

    def show_point_size(self, size_m: float) -> None:
        """Set the point size slider, as near as its range allows."""
        slider = self.point_size
        slider.value = min(slider.max, max(slider.min, round(size_m * 1000.0, 1)))

    def show_region(self, corners: tuple[tuple[float, float, float], tuple[float, float, float]]) -> None:
        """Set the numbers of the box, metres in the scan's frame."""
        self.region_low.value, self.region_high.value = (tuple(round(x, 3) for x in corner) for corner in corners)

    def _add_up(self, gui: viser.GuiApi, controls: SettingControls, actions: ScanActions) -> None:
        controls.add_up()
        tools = gui.add_button_group(
            "Correct up",
            UP_TOOLS,
            hint="Shift-click three points of a level floor in the scene; or let the treads that were found say it.",
        )
        tools.on_click(from_page(actions.on_up_tool, lambda: tools.value))
        self.up_hint = gui.add_html("")
        self.up_used = gui.add_html("")

    def _add_region(self, gui: viser.GuiApi, actions: ScanActions) -> None:
        with gui.add_folder("Region of interest", expand_by_default=False):
            self.region_shown: Any = gui.add_checkbox(
                "Show the box", False, hint="With handles at two corners; what lies outside is not measured."
            )
            self.region_shown.on_update(from_page(actions.on_region_shown, lambda: self.region_shown.value))
            self.region_low: Any = gui.add_vector3("Low corner [m]", (0.0, 0.0, 0.0), step=0.01)
            self.region_high: Any = gui.add_vector3("High corner [m]", (1.0, 1.0, 1.0), step=0.01)
            for corner in (self.region_low, self.region_high):
                corner.on_update(from_page(actions.on_region_corner))
            tools = gui.add_button_group("Set it", REGION_TOOLS)
            tools.on_click(from_page(actions.on_region_tool, lambda: tools.value))
            apply = gui.add_button("Measure in the box", icon=viser.Icon.BOX)
            apply.on_click(lambda _: actions.on_region_apply())
            self.region_told = gui.add_html("")

    def _add_points(self, gui: viser.GuiApi, actions: ScanActions) -> None:
        with gui.add_folder("Points"):
            self.color: Any = gui.add_dropdown(
                "Colour by", COLOR_MODES, initial_value=COLOR_MODES[0], hint="Of the segmented cloud; see the legend."
            )
            self.color.on_update(from_page(actions.on_color, lambda: self.color.value))
            self.shading: Any = gui.add_checkbox(
                "Shade edges", False, hint="Light from the lower left, and darker creases, as the normals say."
            )
            self.shading.on_update(from_page(actions.on_shading, lambda: self.shading.value))
            self.point_size: Any = gui.add_slider(
                "Point size [mm]", 0.5, 50.0, 0.5, 5.0, hint="Diameter of the drawn points."
            )
            self.point_size.on_update(from_page(actions.on_point_size, lambda: self.point_size.value))
            self.density: Any = gui.add_slider(
                "Points drawn [%]", 1, 100, 1, 100, hint="The measurement always uses all of them."
            )
            self.density.on_update(from_page(actions.on_density, lambda: self.density.value))
