"""The region of interest: a box in the scan's own axes, with handles in the scene and numbers on the page."""

import numpy as np
import viser

from stair_inspector.declarations import Box
from stair_inspector.errors import ConfigError, one_of
from stair_inspector.geometry.arrays import Floats
from stair_inspector.overrules import parse_region
from stair_inspector.viewer.bridge.markup import aside
from stair_inspector.viewer.parts.part import Context

REGION_TOOLS = ("Around the stair", "Whole scan")
_EDGE_COLOR = (230, 60, 140)
_AROUND_M, _ABOVE_M = 1.0, 0.5
"""Room around the stair: without floor in front of it the first riser has no foot."""
_EDGES = ((0, 1), (1, 3), (3, 2), (2, 0), (4, 5), (5, 7), (7, 6), (6, 4), (0, 4), (1, 5), (2, 6), (3, 7))
"""Pairs of the corners of a box that are joined; bit 2 of a corner's number is x, bit 1 y, bit 0 z."""
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
        self._box: Box | None = None
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
                widgets.vector(f"{which} corner [m]", (at, at, at), step=0.01, on_change=self.read_numbers)
                for which, at in (("Low", 0.0), ("High", 1.0))
            )
            widgets.buttons("Set it", REGION_TOOLS, self.use_tool)
            widgets.button("Measure in the box", self.apply, icon=viser.Icon.BOX)
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
            origin = shown.scan.origin_m
            if option == REGION_TOOLS[1]:
                self._set_box(_box_of(shown.scan.points + origin))
                self._apply("")
                return
            if not shown.inspection.steps:
                raise ConfigError("region: no steps were found to set the box around; move its handles instead")
            corners = np.concatenate([step.corners for step in shown.inspection.steps]) + origin
            upright = np.abs(shown.inspection.up.vector)
            self._set_box(_box_of(corners, _AROUND_M + (_ABOVE_M - _AROUND_M) * upright))
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
            low, high = self._box = _rounded(self._corners())
            self._apply(",".join(repr(value) for value in (*low, *high)))
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
                self._set_box(parse_region(region) or _box_of(shown.scan.points + shown.scan.origin_m))
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
        low, high = (np.array(corner) - shown.scan.origin_m for corner in self._box)
        self._draw_edges(low, high)
        size = max(0.2, 0.1 * float(np.linalg.norm(high - low)))
        for name, corner in (("low", low), ("high", high)):
            handle = self._desk.client.scene.add_transform_controls(
                f"/stair/region/{name}", scale=size, disable_rotations=True, disable_sliders=True, position=corner
            )
            handle.on_update(self._desk.notices.guard(self._on_drag))
            self._handles.append(handle)

    def _on_drag(self, event: viser.TransformControlsEvent) -> None:
        with self._desk.lock:
            shown = self._desk.shown
            if shown is None or len(self._handles) != 2:
                return
            places = np.array([handle.position for handle in self._handles]) + shown.scan.origin_m
            low, high = places.min(axis=0), places.max(axis=0)
            box = self._set_box(_box_of(np.array([low, np.maximum(high, low + _LEAST_M)]), 0.0))
            self._draw_edges(*(np.array(corner) - shown.scan.origin_m for corner in box))
            if event.phase == "end":
                self.apply()

    def _draw_edges(self, low: Floats, high: Floats) -> None:
        box = np.array(
            [[(low, high)[k >> 2 & 1][0], (low, high)[k >> 1 & 1][1], (low, high)[k & 1][2]] for k in range(8)]
        )
        lines = np.array([[box[a], box[b]] for a, b in _EDGES], dtype=np.float32)
        self._edges = self._desk.client.scene.add_line_segments(
            "/stair/region/edges",
            lines,
            np.tile(np.array(_EDGE_COLOR, dtype=np.uint8), (len(lines), 2, 1)),
            thickness=2.0,
            thickness_units="screen",
        )

    def _set_box(self, box: Box) -> Box:
        """Take a box, to the millimetre, and write its numbers."""
        self._box = _rounded(box)
        self.low.value, self.high.value = self._box
        return self._box

    def _words(self) -> str:
        in_force = parse_region(self._editor.work.params.overrules.region)
        words = "Measured: the whole scan." if in_force is None else "Measured: what lies in the box."
        if in_force is not None and self._box != _rounded(in_force):
            words = "Measured: another box. Press Measure in the box for this one to count."
        return aside("region-told", words, "0 9px 6px")

    def _corners(self) -> Box:
        values = [*self.low.value, *self.high.value]
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


def _rounded(box: Box) -> Box:
    low, high = ((round(x, 3) + 0.0, round(y, 3) + 0.0, round(z, 3) + 0.0) for x, y, z in box)
    return low, high


def _box_of(points: Floats, around_m: Floats | float = 0.01) -> Box:
    low, high = points.min(axis=0) - around_m, points.max(axis=0) + around_m
    (x, y, z), (a, b, c) = (tuple(float(value) for value in corner) for corner in (low, high))
    return (x, y, z), (a, b, c)
