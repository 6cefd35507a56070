"""The Section tool: a slab of the scan along or across the stair, in the scene and as a drawing."""

import numpy as np

from stair_inspector.errors import ConfigError, one_of
from stair_inspector.pictures.cameras import ORTHO_FOV_RAD, frame_from
from stair_inspector.pictures.display import Display
from stair_inspector.pictures.frames import section_frame
from stair_inspector.viewer.compute.threads import Newest
from stair_inspector.viewer.parts.look.section_card import MOST_DOTS, SectionCard
from stair_inspector.viewer.parts.part import Context
from stair_inspector.viewer.scene.section_svg import profile_svg
from stair_inspector.viewer.scene.sections import (
    DIRECTIONS,
    Profile,
    cut,
    places,
    profile_csv,
    profile_of,
    section_display,
)

_FARTHEST_MM = 3000.0
_USUAL_THICKNESS_MM = 40.0
_LOOK, _ENLARGE, _SAVE = "Look at it", "Enlarge", "Save CSV"


class SectionTool:
    """Controls of the slab, the thin cloud in the scene, and the 2-D profile."""

    def __init__(self, context: Context) -> None:
        self._desk = desk = context.desk
        self._look = context.look
        self.display: Display | None = None
        self._profile: Profile | None = None
        self._is_on = False
        self._direction = DIRECTIONS[0]
        # What the sliders say, as far as it is possible.
        self._place_m, self._thickness_m = 0.0, _USUAL_THICKNESS_MM / 1000.0
        # Whose frame the section is cut in.
        self._step_id: int | None = None
        guard = desk.notices.guard
        self._card = SectionCard(context.widgets)
        # While a slider moves only the newest section is made: each one goes through all points of the scan.
        show = guard(self.show)
        self._newest: Newest[None] = Newest(lambda _: show(), name=f"stair-section-{desk.client.client_id}")
        widgets = context.widgets
        self._on = widgets.checkbox("Section", hint="Shows a slab of the scan alone. Key X.", on_change=self.set_on)
        self._cut = widgets.choice(
            "Cut",
            tuple(each.capitalize() for each in DIRECTIONS),
            self._direction.capitalize(),
            self.set_direction,
            hint="Along the climb, or across it.",
        )
        self._place = widgets.slider(
            "Place [mm]",
            (-_FARTHEST_MM, _FARTHEST_MM),
            5.0,
            0.0,
            hint="From the middle of the stair, or of the chosen step.",
            on_change=self._move,
        )
        self._thickness = widgets.slider(
            "Thickness [mm]",
            (2.0, 500.0),
            1.0,
            _USUAL_THICKNESS_MM,
            hint="Of the slice of points that is shown.",
            on_change=self._move,
        )
        widgets.buttons(
            "Section view",
            (_LOOK, _ENLARGE, _SAVE),
            self._do,
            hint="Stand square to it, see it large, or take its points along.",
        )
        self._plot = widgets.html()

    def close(self) -> None:
        """End the thread."""
        self._newest.close()

    def set_on(self, is_on: bool) -> None:
        """Show the section alone, or everything again."""
        with self._desk.lock:
            self._on.value = self._is_on
            self._desk.result("section")
            self._is_on = self._on.value = bool(is_on)
            self._fit_place()
            self.show()
            if self._is_on:
                self._look_at_it()

    def switch(self) -> None:
        """Switch the section on or off, and its box with it."""
        self.set_on(not self._is_on)

    def set_direction(self, option: str) -> None:
        """Cut along or across the stair, through its middle."""
        direction = one_of(option.lower(), DIRECTIONS, "section")
        with self._desk.lock:
            self._direction = direction
            self._cut.show(direction.capitalize())
            self._place_m = 0.0
            self._fit_place()
            if self._is_on:
                self.show()
                self._look_at_it()

    def show(self) -> None:
        """Draw the section as the controls say, or nothing."""
        desk = self._desk
        with desk.lock:
            shown = desk.shown
            if shown is None:
                self.display = self._profile = None
                self._plot.content = ""
                return
            if not self._is_on:
                self.display = self._profile = None
                desk.stage.show_section(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.uint8), None)
                self._plot.content = ""
                return
            self._step_id = desk.selected
            frame = section_frame(shown.inspection, shown.display.points, desk.selected)
            slab = cut(frame, self._direction, self._place_m, self._thickness_m, shown.display.points)
            self.display = section_display(shown.scan, slab)
            self._profile = profile_of(shown.scan, shown.inspection, slab)
            colors = self._look.colors(shown, self.display)
            with desk.client.atomic():
                cut_ids = [line.step.step_id for line in self._profile.lines]
                desk.stage.show_section(self.display.points, colors, slab.corners, cut_ids)
                self._plot.content = profile_svg(self._profile, desk.palette, desk.unit, desk.selected, width=340)

    def put_card_away(self) -> bool:
        """Close the large drawing, and return whether it was open."""
        return self._card.close()

    def _move(self, _: float) -> None:
        """Take what the sliders say; one that says nothing possible goes back to what it said."""
        with self._desk.lock:
            for name in ("place", "thickness"):
                slider = {"place": self._place, "thickness": self._thickness}[name]
                kept_m = {"place": self._place_m, "thickness": self._thickness_m}[name]
                try:
                    value_m = _metres(name, slider.value, slider.min, slider.max)
                except ConfigError:
                    slider.value = 1000.0 * kept_m
                    raise
                if name == "place":
                    self._place_m = value_m
                else:
                    self._thickness_m = value_m
        self._newest.submit(None)

    def follow(self) -> None:
        """Cut through the step that has been chosen; the desk is held."""
        if not self._is_on or self._desk.selected == self._step_id:
            return
        self._fit_place()
        self._newest.submit(None)

    def _do(self, option: str) -> None:
        desk = self._desk
        with desk.lock:
            profile, step_id = self._profile, self._step_id
            if not self._is_on or profile is None:
                raise ConfigError("section: switch the section on first")
            name = f"{desk.result('section').stem}_section_{profile.direction}.csv"
            if option == _LOOK:
                self._look_at_it()
                return
        if option == _SAVE:
            desk.client.send_file_download(name, profile_csv(profile), save_immediately=True)
            return
        self._card.open(
            lambda width, tallest: profile_svg(
                profile, desk.palette, desk.unit, step_id, width=width, tallest=tallest, most_dots=MOST_DOTS
            )
        )

    def _look_at_it(self) -> None:
        """Look square at the section."""
        desk = self._desk
        shown = desk.result("section")
        frame = section_frame(shown.inspection, shown.display.points, desk.selected)
        slab = cut(frame, self._direction, self._place_m, 0.01, shown.display.points)
        rotation = desk.stage.rotation
        pose = frame_from(
            rotation @ slab.facing,
            rotation @ slab.up,
            slab.corners @ rotation.T,
            self._look.aspect,
            ORTHO_FOV_RAD,
        )
        # In perspective the steps behind the section would not lie behind their own lines.
        self._look.go_to(pose, ORTHO_FOV_RAD)

    def _fit_place(self) -> None:
        """Let the slider reach as far as the scan does."""
        shown = self._desk.shown
        if shown is None:
            return
        frame = section_frame(shown.inspection, shown.display.points, self._desk.selected)
        low, high = (round(1000.0 * place, -1) for place in places(frame, shown.display.points, self._direction))
        # The range must hold the value at every moment.
        self._place.min, self._place.max = min(low, 0.0), max(high, 0.0)
        place_mm = min(max(1000.0 * self._place_m, self._place.min), self._place.max)
        self._place.value, self._place_m = place_mm, place_mm / 1000.0


def _metres(name: str, value_mm: object, low_mm: float, high_mm: float) -> float:
    is_number = isinstance(value_mm, (int, float)) and not isinstance(value_mm, bool)
    # A comparison with something that is no number is False.
    if not isinstance(value_mm, (int, float)) or not (is_number and low_mm <= value_mm <= high_mm):
        raise ConfigError(f"section: {name}: got {str(value_mm)[:40]}; give {low_mm:g} to {high_mm:g} mm")
    return float(value_mm) / 1000.0
