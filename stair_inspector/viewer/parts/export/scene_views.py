"""The views of a report, taken of the inspector's own scene; where the page does not deliver, drawn without it."""

import dataclasses
from collections.abc import Callable
from functools import partial
from typing import Literal

import numpy as np

from stair_inspector.errors import ConfigError
from stair_inspector.geometry.arrays import Colors
from stair_inspector.pictures.cameras import FOV_RAD, ORTHO_FOV_RAD, Pose, View, with_fov
from stair_inspector.pictures.coloring import ColorMode, color_points
from stair_inspector.pictures.legends import Legend, line_entries
from stair_inspector.pictures.picture import Caption, Scale, picture_png, scale_of
from stair_inspector.pictures.report_views import RenderedView, is_residual_map, report_views, residual_views
from stair_inspector.pictures.segmentation import draw
from stair_inspector.viewer.parts.desk import Shown
from stair_inspector.viewer.parts.part import Context
from stair_inspector.viewer.parts.studio import studio
from stair_inspector.viewer.scene.stage import Mode
from stair_inspector.viewer.scene.step_marks import MARKED, mark_color
from stair_inspector.viewer.state.change import PageChange

SceneSubject = Literal["Raw", "Segmented"]

_VIEWS: tuple[tuple[SceneSubject, View, float, str], ...] = (
    ("Raw", "Home", 0.5, "the scan as it came, grey where it has no colours"),
    ("Segmented", "Home", 0.5, "floor, treads in turn from bottom to top, and the edges that were found"),
    ("Segmented", "Front", 0.5, "seen by who climbs"),
    ("Segmented", "Top", 0.5, "from above"),
    ("Segmented", "Side", 1.0, "from the side"),
)
"""What a report shows, from where, on what part of the page's width, and in words; Raw alone where there is no step."""
_COLORS: dict[SceneSubject, ColorMode] = {"Raw": "Original", "Segmented": "Step"}
_WIDTH, _HEIGHT = 1200, 960
"""Of a picture, the height at most, pixels: 180 for each inch of a page's width, twice as many for half of it."""
_LEAST_HEIGHT = 240
_MARGIN = 24
"""Of a picture above and below what is seen, pixels."""
_TIMEOUT_S = 20.0
_TRIES = 4
"""Of a picture while which something was drawn."""
_DRAWN = "drawn by the program"
_NOT_TAKEN = f"{_DRAWN}, not taken of the scene: the page did not deliver its pictures in time"
_CHANGED = f"{_DRAWN}, not taken of the scene: it changed while its pictures were taken"


class _ChangedError(ConfigError):
    """The scene is no longer that of the result of which pictures are taken."""


class SceneViews:
    """Takes pictures of a page's scene: of its points, edges, marks and measurements, in the colours of the report."""

    def __init__(self, context: Context) -> None:
        self._desk = context.desk
        self._look = context.look

    def take(
        self, shown: Shown, date: str, title: str, tell: Callable[[int, int], None], *, from_scene: bool = True
    ) -> tuple[RenderedView, ...]:
        """Return the views of a result.

        Parameters
        ----------
        shown : Shown
            The result; what the page shows of it is drawn in the report's colours meanwhile.
        date, title : str
            Burned into the pictures.
        tell : callable
            Called before each picture with its number, from 0, and how many there are; may raise to stop.
        from_scene : bool
            False draws them without the page.
        """
        if not from_scene:
            tell(0, 1)
            return report_views(shown.scan, shown.inspection, date, title=title, unit=self._desk.unit)
        try:
            views = self._of_scene(shown, date, title, tell)
        except _ChangedError:
            return self._drawn(shown, date, title, tell, _CHANGED)
        except ConfigError:
            # The page is hidden, asleep or too slow.
            return self._drawn(shown, date, title, tell, _NOT_TAKEN)
        # Maps of single treads are no views of a scene.
        return views + residual_views(shown.scan, shown.inspection, date, title=title, unit=self._desk.unit)

    def _drawn(
        self, shown: Shown, date: str, title: str, tell: Callable[[int, int], None], why: str
    ) -> tuple[RenderedView, ...]:
        tell(0, 1)
        self._desk.notices.tell("Views of the report", f"They are {why}.")
        views = report_views(shown.scan, shown.inspection, date, title=title, unit=self._desk.unit)
        # Said once in full; maps of single treads are never taken of a scene.
        told = {view.key: _DRAWN for view in views if not is_residual_map(view)}
        told[views[0].key] = why
        return tuple(
            dataclasses.replace(view, caption=f"{view.caption} ({told[view.key]})") if view.key in told else view
            for view in views
        )

    def _of_scene(
        self, shown: Shown, date: str, title: str, tell: Callable[[int, int], None]
    ) -> tuple[RenderedView, ...]:
        wanted = _VIEWS if shown.inspection.steps else _VIEWS[:1]
        before, marks = self._desk.stage.mode, self._desk.marks
        made = []
        try:
            with (
                self._look.lent(),
                studio(self._desk, _WIDTH, _HEIGHT, _TIMEOUT_S) as render,
            ):
                for number, (subject, view, share, words) in enumerate(wanted):
                    pixels, legend, scale = self._at_rest(
                        render, shown, subject, view, partial(tell, number, len(wanted))
                    )
                    if self._desk.marks != marks:
                        raise _ChangedError("report: the marks have changed")
                    burned = Caption(title, shown.label, f"{subject.lower()}, {view.lower()} view", date, "")
                    png = picture_png(_without_emptiness(pixels), burned, legend, scale, "White", 1.0 / share)
                    caption = f"{subject}, {view.lower()} view: {words}"
                    made.append(RenderedView(f"{subject}_{view}".lower(), caption, png, share))
        finally:
            self._give_back(before)
        return tuple(made)

    def _at_rest(
        self,
        render: Callable[[Pose, float], Colors],
        shown: Shown,
        subject: SceneSubject,
        view: View,
        tell: Callable[[], None],
    ) -> tuple[Colors, Legend | None, Scale]:
        """Return a picture while which nothing was drawn, with its legend and scale.

        The inspector goes on working: what was drawn meanwhile may be in the picture, which is then taken once more.
        """
        desk, stage = self._desk, self._desk.stage
        for _ in range(_TRIES):
            tell()
            with desk.lock:
                legend, pose, fov_rad = self._dress(shown, subject, view)
                scale = scale_of(pose, fov_rad, _HEIGHT, desk.unit)
                n_drawn, gone_to = stage.n_drawn, self._look.gone_to
            pixels = render(pose, fov_rad)
            with desk.lock:
                if stage.n_drawn == n_drawn and self._look.gone_to is gone_to:
                    return pixels, legend, scale
        raise _ChangedError("report: the scene keeps changing")

    def _give_back(self, mode_before: Mode) -> None:
        """Show the scene as the inspector has it, with what was chosen while pictures were taken."""
        desk, stage = self._desk, self._desk.stage
        with desk.lock:
            chosen = stage.mode
            # The camera stands again as it did in that mode; in the one chosen since it is framed anew.
            stage.set_mode(mode_before)
            stage.lend(None)
            desk.changed(PageChange.COLORS)
            if chosen != mode_before:
                self._look.set_mode(chosen)
                desk.changed(PageChange.COLORS, PageChange.MODE)

    def _dress(self, shown: Shown, subject: SceneSubject, view: View) -> tuple[Legend | None, Pose, float]:
        """Draw the scene for a picture: on white, in the subject's colours, with nothing chosen and not cut."""
        desk = self._desk
        if desk.shown is not shown:
            raise _ChangedError("report: the scene has changed")
        stage, palette = desk.stage, desk.paper_palette
        coloring = color_points(_COLORS[subject], shown.inspection, shown.display, palette)
        with desk.client.atomic():
            stage.show_section(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.uint8), None)
            stage.highlight(np.zeros((0, 3)), None)
            stage.show_dimensions(None, None, palette)
            drawing = draw(shown.inspection, shown.display, shown.scan.points, palette, colors=coloring.colors)
            stage.show_drawing(drawing, palette, desk.notices.guard(desk.select))
            stage.color_raw(shown.display.colors)
            stage.show_marks(self._desk.marks, palette)
            stage.lend("Raw" if subject == "Raw" else "Segmented")
            pose = self._look.pose_of(shown, view, _WIDTH / _HEIGHT)
        # Flat views are drawings: parallels stay parallel, whatever look the inspector has chosen.
        fov_rad = FOV_RAD if view == "Home" else ORTHO_FOV_RAD
        return self._legend(subject, coloring.legend), with_fov(pose, self._look.fov_rad, fov_rad), fov_rad

    def _legend(self, subject: SceneSubject, points: Legend | None) -> Legend | None:
        """Return what the colours of points, lines and marks mean."""
        if subject == "Raw" or points is None:
            return None
        tones = {mark.tone for mark in self._desk.marks.values()}
        palette = self._desk.paper_palette
        marked = tuple((mark_color(tone, palette), words) for tone, words in MARKED.items() if tone in tones)
        return dataclasses.replace(points, entries=(*points.entries, *line_entries(palette), *marked))


def _without_emptiness(pixels: Colors) -> Colors:
    """Return a picture without the rows above and below what is seen, but for a margin."""
    rows = np.flatnonzero(pixels[..., 3].any(axis=1))
    if not len(rows):
        return pixels
    first, last = int(rows[0]) - _MARGIN, int(rows[-1]) + _MARGIN
    lacking = max(0, _LEAST_HEIGHT - (last - first))
    return pixels[max(0, first - lacking // 2) : last + lacking - lacking // 2 + 1]
