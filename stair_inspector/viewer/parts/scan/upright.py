"""Correcting the up direction: from three points of a level floor, or from the treads that were found."""

import numpy as np

from stair_inspector.errors import ConfigError, one_of
from stair_inspector.geometry.arrays import Floats
from stair_inspector.model import Inspection
from stair_inspector.viewer.bridge.markup import aside
from stair_inspector.viewer.parts.details_html import up_html
from stair_inspector.viewer.parts.part import Context

UP_TOOLS = ("Pick 3 floor points", "Take the treads")
_SMALLEST_SINE = 0.05
"""Three points that lie more nearly on a line than this say nothing about the direction across it."""
_SHORTEST_M = 0.05


class UprightTool:
    """The buttons under "Correct up", which take points that are picked in the scene; and the up that is in use."""

    def __init__(self, context: Context) -> None:
        self._desk = context.desk
        self._editor = context.editor
        self._points: list[Floats] = []
        self._frame: tuple[str, str] | None = None
        widgets = context.widgets
        widgets.buttons(
            "Correct up",
            UP_TOOLS,
            self.start,
            hint="Shift-click three points of a level floor in the scene; or let the treads that were found say it.",
        )
        self.hint = widgets.html()
        self.used = widgets.html()

    def start(self, option: str) -> None:
        """Begin to pick three points, or take the treads."""
        one_of(option, UP_TOOLS, "correct up")
        with self._desk.lock:
            shown = self._desk.result("correct up")
            # Either way, points that were picked before count no longer.
            self.stop()
            if option == UP_TOOLS[1]:
                self._apply(up_of_treads(shown.inspection), "up from the treads")
                return
            self._frame = self._desk.frame
            self._desk.point_taker = self._take
            self._say("Shift-click three points of a level floor, far apart: 0 of 3.")

    def stop(self) -> None:
        """Give up picking."""
        self._points, self._frame = [], self._desk.frame
        self._desk.stop_taking(self._take)
        self._say("")

    def show(self) -> None:
        """Show the up in use; picking that was begun on another scan is given up."""
        inspection = self._desk.inspection
        self.used.content = up_html(inspection.up) if inspection is not None else ""
        if self._frame != self._desk.frame:
            self.stop()

    def _take(self, place_m: tuple[float, float, float]) -> None:
        self._points.append(np.array(place_m))
        if len(self._points) < 3:
            self._say(f"Shift-click three points of a level floor, far apart: {len(self._points)} of 3.")
            return
        points, self._points = np.array(self._points), []
        self._desk.point_taker = None
        self._say("")
        self._apply(up_of_points(points, self._desk.result("correct up").inspection.up.vector), "up from three points")

    def _apply(self, up: Floats, words: str) -> None:
        vector = ",".join(f"{component:.6f}" for component in up)
        self._editor.adjust(lambda params: params.replaced("up", vector), words)
        self._desk.notices.tell(
            "Up corrected",
            f"up is ({vector}) now and taken as exact; state under Tune, Survey, 'up [°]' how well it is known",
        )

    def _say(self, words: str) -> None:
        self.hint.content = aside("up-hint", words, "2px 9px 4px") if words else ""


def up_of_points(points: Floats, roughly: Floats) -> Floats:
    """Return the unit normal (3,) of the plane through three points (3, 3), on the side of a rough up.

    Raises
    ------
    ConfigError
        The points are too near to each other or to one line.
    """
    first, second = points[1] - points[0], points[2] - points[0]
    lengths = [float(np.linalg.norm(points[k] - points[k - 1])) for k in range(3)]
    normal = np.cross(first, second)
    area = float(np.linalg.norm(normal))
    if min(lengths) < _SHORTEST_M or area < _SMALLEST_SINE * max(lengths) ** 2:
        raise ConfigError("correct up: the three points lie too near to each other or to one line; pick them far apart")
    up: Floats = normal / area
    return up if float(up @ roughly) >= 0.0 else -up


def up_of_treads(inspection: Inspection) -> Floats:
    """Return the mean normal (3,) of the treads, each weighted by its points.

    Raises
    ------
    ConfigError
        There are no treads.
    """
    if not inspection.steps:
        raise ConfigError("correct up: no treads were found; pick three floor points instead")
    up = inspection.up.vector
    total = np.zeros(3)
    for step in inspection.steps:
        normal = step.plane.normal
        if normal is not None:
            total += step.plane.n_points * (normal if float(normal @ up) >= 0.0 else -normal)
    length = float(np.linalg.norm(total))
    if length == 0.0:
        raise ConfigError("correct up: no tread has a plane; pick three floor points instead")
    mean: Floats = total / length
    return mean
