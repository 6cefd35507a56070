"""The Measure tool: coordinates of picked points, and distances with their level and upright parts."""

from collections.abc import Callable

import numpy as np
import viser

from stair_inspector.errors import ConfigError
from stair_inspector.pictures.display import Display
from stair_inspector.units import length_text
from stair_inspector.viewer.bridge.markup import aside, read_order
from stair_inspector.viewer.parts.part import Context
from stair_inspector.viewer.scene.framing import near_pose
from stair_inspector.viewer.scene.measurements import (
    ORDERS,
    RULER_MODES,
    Ruler,
    drawing_of,
    measurements_html,
    renamed,
    without,
)
from stair_inspector.viewer.scene.picking import Pick, cone_of, owner_text, pick_of, point_at_click, ray_of

_NOBODY = "none"
_NO_POINT = "no point lies there; zoom in, or click on the cloud itself"


class MeasureTool:
    """Shift-click picks the foremost point; what is measured is drawn, listed, and part of the work."""

    def __init__(self, context: Context, seen: Callable[[], Display | None]) -> None:
        self._desk = desk = context.desk
        self._look = context.look
        self._editor = context.editor
        # What of the scan can be picked while a section is shown alone.
        self._seen = seen
        self._ruler = Ruler()
        # Of which scan, read in which unit, the point is that waits for its second one.
        self._waiting_of: tuple[str, str] | None = None
        # Index of the measurement that has all its values in the scene; the last one without.
        self._detailed: int | None = None
        widgets = context.widgets
        self._mode = widgets.choice(
            "Measure",
            RULER_MODES,
            self._ruler.mode,
            self.set_mode,
            hint="Then shift-click in the scene: once for a point, twice for a distance. Key M.",
        )
        self._told = widgets.html()
        self._list = widgets.html()
        self._orders = widgets.orders("Measurement order", self.obey)
        with widgets.folder("Rename", is_open=False):
            self._which = widgets.dropdown("Which one", (_NOBODY,), hint="The measurement that gets the name.")
            self._name = widgets.text("New name", hint="One line; no two have the same.")
            widgets.button("Rename it", self.rename, icon=viser.Icon.PENCIL, hint="In scene, list and project.")
        desk.client.scene.on_click(modifier="shift")(desk.notices.guard(self._on_click))

    def set_mode(self, option: str) -> None:
        """Choose what a click measures."""
        with self._desk.lock:
            self._ruler.set_mode(option)
            self._mode.show(self._ruler.mode)
            self.show()

    def next_mode(self) -> None:
        """Go on to the next mode."""
        at = RULER_MODES.index(self._ruler.mode)
        self.set_mode(RULER_MODES[(at + 1) % len(RULER_MODES)])

    def step_back(self) -> bool:
        """Forget a point that waits for its second; return whether there was one."""
        with self._desk.lock:
            had = self._ruler.step_back()
            if had:
                self.show()
            return had

    def obey(self, message: str) -> None:
        """Look at a measurement or delete it, as a button of the list asks."""
        order = read_order(message, ORDERS)
        with self._desk.lock:
            known = self._editor.work.measurements
            index = order.index_in(known, "measurements")
            if order.word == "delete":
                self._detailed = None
                self._editor.change(f"deleted {known[index].name}", measurements=without(known, index))
            else:
                self._detailed = index
                self.show()
                self._look_at(np.array(known[index].points_m))

    def rename(self) -> None:
        """Give the chosen measurement another name."""
        with self._desk.lock:
            known = self._editor.work.measurements
            names = [entry.name for entry in known]
            if self._which.value not in names:
                raise ConfigError("rename: choose a measurement first")
            name = " ".join(str(self._name.value).split())
            entries = renamed(known, names.index(self._which.value), name)
            self._editor.change(f"renamed {self._which.value}", measurements=entries)

    def show(self) -> None:
        """Draw and list the measurements."""
        desk = self._desk
        with desk.lock, desk.client.atomic():
            self._drop_other_scans_point()
            known = self._editor.work.measurements
            inspection = desk.inspection
            up = inspection.up.vector if inspection is not None else None
            self._list.content = measurements_html(known, up, desk.unit, self._orders)
            options = (_NOBODY, *(entry.name for entry in known))
            if tuple(self._which.options) != options:
                self._which.options = options
                self._which.value = options[-1]
            if inspection is None or up is None:
                return
            drawing = None
            if known or self._ruler.waiting is not None:
                drawing = drawing_of(
                    known, self._ruler.waiting, inspection.scan.origin_m, up, desk.unit, self._detailed
                )
            desk.stage.show_measurements(drawing)
            self._tell_mode()

    def _on_click(self, event: viser.SceneClickEvent) -> None:
        desk = self._desk
        with desk.lock:
            taker = desk.point_taker
            if self._ruler.mode == "Off" and taker is None:
                self._say("Choose Point or Distance, then shift-click again.")
                return
            pick = self._pick(event)
            if pick is None:
                self._say(_NO_POINT)
                return
            if taker is not None:
                taker(pick.place_m)
                return
            self._drop_other_scans_point()
            made = self._ruler.click(pick.place_m, self._editor.work.measurements)
            if made is not None:
                self._detailed = None
                self._editor.edit(made.name, lambda work: {"measurements": (*work.measurements, made)})
            else:
                self.show()
            self._say_pick(pick)

    def _drop_other_scans_point(self) -> None:
        """Forget the first point of a distance that was begun on another scan: together they would measure nothing."""
        frame = self._desk.frame
        if frame != self._waiting_of:
            self._ruler.step_back()
            self._waiting_of = frame

    def _pick(self, event: viser.SceneClickEvent) -> Pick | None:
        """Return the foremost drawn point that a click meets."""
        shown = self._desk.result("measure")
        display = self._seen() or shown.display
        camera, stage = self._desk.client.camera, self._desk.stage
        cone = cone_of(camera.fov, camera.image_height)
        row = point_at_click(display.points, ray_of(event.ray_origin, event.ray_direction, stage.rotation), cone)
        return None if row is None else pick_of(shown.inspection, display, row)

    def _look_at(self, points: np.ndarray) -> None:
        fov_rad = self._look.fov_rad
        self._look.go_to(near_pose(self._look.pose(), self._desk.to_view(points), fov_rad), fov_rad)

    def _say_pick(self, pick: Pick) -> None:
        place = ", ".join(f"{value:.3f}" for value in pick.place_m)
        away = ""
        if pick.residual_m is not None:
            away = f", {length_text(pick.residual_m, self._desk.unit, 1)} off its plane"
        self._say(f"({place}) m · {owner_text(pick)}{away}")

    def _tell_mode(self) -> None:
        words = {
            "Off": "",
            "Point": "Shift-click a point.",
            "Distance": "Shift-click the first point.",
        }[self._ruler.mode]
        self._say("Shift-click the second point; Escape forgets the first." if self._ruler.waiting else words)

    def _say(self, words: str) -> None:
        self._told.content = aside("picked", words, "2px 9px 4px") if words else ""
