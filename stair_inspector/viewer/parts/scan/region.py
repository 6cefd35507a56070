"""The region of interest: an upright box that follows the stair, with handles in the scene and numbers on the page."""

import numpy as np
import viser

from stair_inspector.errors import ConfigError, one_of
from stair_inspector.geometry.arrays import Floats
from stair_inspector.geometry.boxes import bearing_of, box_around
from stair_inspector.model import Inspection
from stair_inspector.overrules import Region, parse_region, region_text
from stair_inspector.stages.orient import region_box
from stair_inspector.viewer.bridge.markup import aside
from stair_inspector.viewer.parts.part import Context
from stair_inspector.viewer.scene.nodes import quaternion

REGION_TOOLS = ("Around the stair", "Whole scan")
_EDGE_COLOR = (230, 60, 140)
_AROUND_M, _ABOVE_M = 1.0, 0.5
"""Room around the stair: without floor in front of it the first riser has no foot."""
_EDGES = ((0, 1), (1, 3), (3, 2), (2, 0), (4, 5), (5, 7), (7, 6), (6, 4), (0, 4), (1, 5), (2, 6), (3, 7))
"""Pairs of the corners of a box that are joined; bit 2 of a corner's number is x, bit 1 y, bit 0 z."""
_QUARTER_DEG = 90.0
_ROOM_M = 0.01
_FARTHEST_M = 1e6
_LEAST_M = 0.002
"""A handle that was dragged onto another leaves so much of a box."""


class RegionTool:
    """The folder "Region of interest" of the Scan tab, and the box in the scene."""

    def __init__(self, context: Context) -> None:
        self._desk = context.desk
        self._editor = context.editor
        self._edges: viser.LineSegmentsHandle | None = None
        self._handles: list[viser.TransformControlsHandle] = []
        # The box that is drawn, metres in the scan's frame, and what the settings said when it was set by them.
        self._box: Region | None = None
        self._told: tuple[object, str] | None = None
        self._desk.stage.before_clear.append(self.clear)
        widgets = context.widgets
        with widgets.folder("Region of interest", is_open=False):
            self.is_shown = widgets.checkbox(
                "Show the box",
                hint="With handles at two corners; what lies outside is not measured.",
                on_change=self.set_shown,
            )
            self.low, self.high = (
                widgets.vector(f"{which} corner [m]", (at, at, at), step=0.01, hint=hint, on_change=self.read_numbers)
                for which, at, hint in (
                    ("Low", 0.0, "Least x, y and z of the box, in the scan's frame."),
                    ("High", 1.0, "Largest x, y and z of the box."),
                )
            )
            self.bearing = widgets.slider(
                "Bearing [°]",
                (-_QUARTER_DEG, _QUARTER_DEG),
                0.1,
                0.0,
                hint="How far the box is turned about its middle and the vertical, from x towards y where z is up.",
                on_change=self.read_numbers,
            )
            widgets.buttons(
                "Set it", REGION_TOOLS, self.use_tool, hint="Along the stair with a metre around it; or no box at all."
            )
            widgets.button(
                "Measure in the box", self.apply, icon=viser.Icon.BOX, hint="What lies outside counts no more."
            )
            self.told = widgets.html()

    def set_shown(self, is_shown: bool) -> None:
        """Show the box with its handles, or hide it."""
        with self._desk.lock:
            self._desk.result("region")
            self.draw()

    def use_tool(self, option: str) -> None:
        """Set the box around the stair, or around everything; the latter measures everything again."""
        one_of(option, REGION_TOOLS, "region")
        with self._desk.lock:
            shown = self._desk.result("region")
            if option == REGION_TOOLS[1]:
                self._set_box(_whole(shown.scan.points + shown.scan.origin_m))
                self._apply("")
                return
            if not shown.inspection.steps:
                raise ConfigError("region: no steps were found to set the box around; move its handles instead")
            self._set_box(region_around(shown.inspection))
            self.is_shown.value = True
            self.apply()

    def read_numbers(self, _: object = None) -> None:
        """Draw the box that the numbers say."""
        with self._desk.lock:
            self._box = _rounded(self._corners())
            self.draw()

    def apply(self) -> None:
        """Measure inside the box alone."""
        with self._desk.lock:
            self._box = _rounded(self._corners())
            self._apply(region_text(self._box))
            self.draw()

    def show(self) -> None:
        """Show the box that counts where the settings have changed it, as after undo, or with another scan.

        Numbers that are being written, and are not yet the settings', stay.
        """
        desk = self._desk
        with desk.lock:
            shown = desk.shown
            if shown is None:
                return
            region = self._editor.work.params.overrules.region
            if self._told != (desk.frame, region):
                self._told = (desk.frame, region)
                self._set_box(parse_region(region) or _whole(shown.scan.points + shown.scan.origin_m))
            self.draw()

    def clear(self) -> None:
        """Remove the box; called before the scene that it stands in is made anew."""
        if self._edges is not None:
            self._edges.remove()
        for handle in self._handles:
            handle.remove()
        self._edges, self._handles = None, []

    def draw(self) -> None:
        """Draw the box and its handles, or nothing, and say whether it counts."""
        self.clear()
        shown = self._desk.shown
        self.told.content = self._words()
        if shown is None or self._box is None or not self.is_shown.value:
            return
        box = region_box(region_text(self._box), shown.inspection.up, shown.scan)
        if box is None:
            return
        corners = box.corners()
        self._draw_edges(corners)
        size = max(0.2, 0.1 * float(np.linalg.norm(corners[-1] - corners[0])))
        for name, corner in (("low", corners[0]), ("high", corners[-1])):
            handle = self._desk.client.scene.add_transform_controls(
                f"/stair/region/{name}",
                scale=size,
                disable_rotations=True,
                disable_sliders=True,
                position=corner,
                wxyz=quaternion(box.axes.T),
            )
            handle.on_update(self._desk.notices.guard(self._on_drag))
            self._handles.append(handle)

    def _on_drag(self, event: viser.TransformControlsEvent) -> None:
        with self._desk.lock:
            shown, region = self._desk.shown, self._box
            if shown is None or region is None or len(self._handles) != 2:
                return
            up, bearing = shown.inspection.up.vector, region.bearing_deg
            places = np.array([handle.position for handle in self._handles])
            if not (np.abs(places) <= _FARTHEST_M).all():
                # The handles go back to the box as it is.
                self.draw()
                raise ConfigError(f"region: a corner cannot be moved beyond {_FARTHEST_M:g} m; move it to the stair")
            low, high = box_around(places, np.zeros(3), up, bearing)
            high = np.maximum(high, low + _LEAST_M)
            origin = shown.scan.origin_m
            box = self._set_box(_region(low + origin, high + origin, bearing))
            drawn = region_box(region_text(box), shown.inspection.up, shown.scan)
            if drawn is not None:
                self._draw_edges(drawn.corners())
            if event.phase == "end":
                self.apply()

    def _draw_edges(self, corners: Floats) -> None:
        lines = np.array([[corners[a], corners[b]] for a, b in _EDGES], dtype=np.float32)
        self._edges = self._desk.client.scene.add_line_segments(
            "/stair/region/edges",
            lines,
            np.tile(np.array(_EDGE_COLOR, dtype=np.uint8), (len(lines), 2, 1)),
            thickness=2.0,
            thickness_units="screen",
        )

    def _set_box(self, region: Region) -> Region:
        """Take a box, to the millimetre, and write its numbers."""
        self._box = box = _rounded(region)
        self.low.value, self.high.value, self.bearing.value = box.low, box.high, box.bearing_deg or 0.0
        return box

    def _words(self) -> str:
        in_force = parse_region(self._editor.work.params.overrules.region)
        words = "Measured: the whole scan." if in_force is None else "Measured: what lies in the box."
        if in_force is not None and self._box != _rounded(in_force):
            words = "Measured: another box. Press Measure in the box for this one to count."
        return aside("region-told", words, "0 9px 6px")

    def _corners(self) -> Region:
        values = [*self.low.value, *self.high.value, self.bearing.value]
        try:
            box = parse_region(",".join(repr(float(value)) for value in values))
        except (TypeError, ValueError) as error:
            raise ConfigError(
                "region: each number of the low corner must be below that of the high corner; mend the numbers"
            ) from error
        if box is None:
            raise ConfigError("region: give six numbers")
        return box

    def _apply(self, region: str) -> None:
        if self._editor.work.params.overrules.region != region:
            self._editor.adjust(lambda params: params.replaced("overrules.region", region), "region of interest")


def region_around(inspection: Inspection) -> Region:
    """Return the box that lies along a staircase, with room around it; metres and axes of the scan's frame.

    Its bearing is that of the flight along which the box is smallest in plan.

    Parameters
    ----------
    inspection : Inspection
        With steps.
    """
    up, origin = inspection.up.vector, inspection.scan.origin_m
    corners = np.concatenate([step.corners for step in inspection.steps])
    room = np.where(np.arange(3) == np.argmax(np.abs(up)), _ABOVE_M, _AROUND_M)
    bearings = {bearing_of(flight.climb, up) for flight in inspection.flights} or {0.0}

    def sized(bearing_deg: float) -> tuple[float, Region]:
        low, high = box_around(corners, room, up, bearing_deg)
        return float(np.prod(high - low)), _region(low + origin, high + origin, bearing_deg)

    return _rounded(min((sized(bearing_deg) for bearing_deg in sorted(bearings)), key=lambda each: each[0])[1])


def _rounded(region: Region) -> Region:
    """Return a region to the millimetre, its bearing to the tenth of a degree, none where it is not turned.

    A box that was turned by more than the control of the page can show is the same one after a half turn.
    """
    low, high = (tuple(round(value, 3) + 0.0 for value in corner) for corner in (region.low, region.high))
    bearing = round(region.bearing_deg or 0.0, 1)
    if abs(bearing) > _QUARTER_DEG:
        bearing = round((bearing + _QUARTER_DEG) % (2.0 * _QUARTER_DEG) - _QUARTER_DEG, 1)
    return _region(np.array(low), np.array(high), bearing or None)


def _region(low: Floats, high: Floats, bearing_deg: float | None) -> Region:
    (x, y, z), (a, b, c) = (tuple(float(value) for value in corner) for corner in (low, high))
    return Region((x, y, z), (a, b, c), bearing_deg)


def _whole(points: Floats) -> Region:
    return _region(points.min(axis=0) - _ROOM_M, points.max(axis=0) + _ROOM_M, None)
