"""The scan in the scene with what was found in it, in the colours that were chosen."""

from stair_inspector.viewer.parts.part import Context, PagePart
from stair_inspector.viewer.state.change import PageChange


class SceneDrawing(PagePart):
    """Draws the cloud and the segmentation; what other parts draw lies over it."""

    depends_on = frozenset({PageChange.RESULT, PageChange.SCAN, PageChange.CLOUD, PageChange.COLORS, PageChange.THEME})

    def __init__(self, context: Context) -> None:
        self._desk = context.desk
        self._look = context.look
        context.desk.client.camera.on_update(lambda _: context.desk.notices.guard(self._reframe)())

    def show(self, what: frozenset[PageChange]) -> None:
        """Draw the result, the scan first where it is another one or stands otherwise."""
        desk, shown = self._desk, self._desk.shown
        if shown is None:
            desk.stage.clear()
            return
        if what & {PageChange.SCAN, PageChange.CLOUD}:
            self._look.show_scan(shown)
        desk.stage.show_drawing(self._look.drawing(shown), desk.palette, desk.notices.guard(desk.select))
        desk.stage.color_raw(self._look.raw_colors(shown))
        if PageChange.SCAN in what:
            self._look.look("Home")

    def _reframe(self) -> None:
        with self._desk.lock:
            if not self._desk.is_closed:
                self._look.reframe()
