"""The Section tool: a slab of the scan along or across the stair, in the scene and as a drawing."""

from typing import Any

import numpy as np
import viser

from stair_inspector.errors import ConfigError
from stair_inspector.viewer.cameras import ORTHO_FOV_RAD, frame_from
from stair_inspector.viewer.desk import Desk
from stair_inspector.viewer.display import Display
from stair_inspector.viewer.looking import Looking
from stair_inspector.viewer.notices import from_page
from stair_inspector.viewer.pictures import safe_name
from stair_inspector.viewer.results import Results
from stair_inspector.viewer.section_svg import profile_svg
from stair_inspector.viewer.sections import (
    DIRECTIONS,
    Profile,
    cut,
    places,
    profile_csv,
    profile_of,
    read_direction,
    section_display,
    section_frame,
)
from stair_inspector.viewer.worker import Newest

_FARTHEST_MM = 3000.0


class SectionTool:
    """Controls of the slab, the thin cloud in the scene, and the 2-D profile."""

    def __init__(self, gui: viser.GuiApi, desk: Desk, looking: Looking, results: Results) -> None:
        self._desk = desk
        self._looking = looking
        self._results = results
        self.display: Display | None = None
        self._profile: Profile | None = None
        self._is_on = False
        self._direction = DIRECTIONS[0]
        guard = desk.notices.guard
        # While a slider moves only the newest section is made: each one goes through all points of the scan.
        show = guard(self.show)
        self._newest: Newest[None] = Newest(lambda _: show(), name=f"stair-section-{desk.client.client_id}")
        self._on: Any = gui.add_checkbox("Section", False, hint="Shows a slab of the scan alone. Key X.")
        self._on.on_update(from_page(guard(self.set_on), lambda: self._on.value))
        direction = gui.add_button_group("Cut", tuple(each.capitalize() for each in DIRECTIONS))
        direction.on_click(from_page(guard(self.set_direction), lambda: direction.value))
        self._place: Any = gui.add_slider(
            "Place [mm]",
            -_FARTHEST_MM,
            _FARTHEST_MM,
            5.0,
            0.0,
            hint="From the middle of the stair, or of the chosen step.",
        )
        self._thickness: Any = gui.add_slider("Thickness [mm]", 2.0, 500.0, 1.0, 40.0)
        for slider in (self._place, self._thickness):
            slider.on_update(from_page(lambda: self._newest.submit(None)))
        look = gui.add_button_group("Section view", ("Look at it", "Save CSV"))
        look.on_click(from_page(guard(self._do), lambda: look.value))
        self._plot = gui.add_html("")

    def close(self) -> None:
        """End the thread."""
        self._newest.close()

    def set_on(self, is_on: bool) -> None:
        """Show the section alone, or everything again."""
        with self._desk.lock:
            self._desk.result("section")
            self._is_on = bool(is_on)
            self._fit_place()
            self.show()
            if self._is_on:
                self._look()

    def switch(self) -> None:
        """Switch the section on or off, and its box with it."""
        self._on.value = not self._is_on
        self.set_on(not self._is_on)

    def set_direction(self, option: str) -> None:
        """Cut along or across the stair, through its middle."""
        direction = read_direction(option)
        with self._desk.lock:
            self._direction = direction
            self._place.value = 0.0
            self._fit_place()
            if self._is_on:
                self.show()
                self._look()

    def show(self) -> None:
        """Draw the section as the controls say, or nothing."""
        desk = self._desk
        with desk.lock:
            shown = desk.shown
            if shown is None:
                return
            if not self._is_on:
                self.display = self._profile = None
                desk.stage.show_section(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.uint8), None)
                self._plot.content = ""
                return
            frame = section_frame(shown.inspection, shown.display.points, desk.selected)
            slab = cut(
                frame,
                self._direction,
                _metres("place", self._place.value),
                _metres("thickness", self._thickness.value),
                shown.display.points,
            )
            self.display = section_display(shown.scan, slab)
            self._profile = profile_of(shown.scan, shown.inspection, slab)
            colors = self._looking.colors(shown, self.display, with_rejected=self._results.with_rejected)
            with desk.client.atomic():
                desk.stage.show_section(self.display.points, colors, slab.corners)
                self._plot.content = profile_svg(self._profile, desk.palette, desk.unit, desk.selected, width=340)

    def _do(self, option: str) -> None:
        with self._desk.lock:
            if not self._is_on or self._profile is None:
                raise ConfigError("section: switch the section on first")
            if option != "Save CSV":
                self._look()
                return
            profile = self._profile
            stem = safe_name(self._desk.result("section").label)
        self._desk.client.send_file_download(f"{stem}_section.csv", profile_csv(profile), save_immediately=True)

    def _look(self) -> None:
        """Look square at the section."""
        desk = self._desk
        shown = desk.result("section")
        frame = section_frame(shown.inspection, shown.display.points, desk.selected)
        slab = cut(frame, self._direction, _metres("place", self._place.value), 0.01, shown.display.points)
        rotation = desk.stage.rotation
        pose = frame_from(
            rotation @ slab.facing,
            rotation @ slab.up,
            slab.corners @ rotation.T,
            desk.client.camera.aspect,
            ORTHO_FOV_RAD,
        )
        # In perspective the steps behind the section would not lie behind their own lines.
        self._looking.go_to(pose, ORTHO_FOV_RAD)

    def _fit_place(self) -> None:
        """Let the slider reach as far as the scan does."""
        shown = self._desk.shown
        if shown is None:
            return
        frame = section_frame(shown.inspection, shown.display.points, self._desk.selected)
        low, high = (round(1000.0 * place, -1) for place in places(frame, shown.display.points, self._direction))
        # The range must hold the value at every moment.
        self._place.min, self._place.max = min(low, 0.0), max(high, 0.0)
        self._place.value = min(max(float(self._place.value), self._place.min), self._place.max)


def _metres(name: str, value_mm: object) -> float:
    if isinstance(value_mm, bool) or not isinstance(value_mm, (int, float)) or not np.isfinite(value_mm):
        raise ConfigError(f"section: {name}: got {str(value_mm)[:40]!r}; give a number of millimetres")
    return float(value_mm) / 1000.0
