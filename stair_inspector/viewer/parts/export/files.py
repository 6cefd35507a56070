"""What an inspector takes away: the result's files, pictures and the project."""

import contextlib
import dataclasses
import datetime
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from stair_inspector.codes import Check
from stair_inspector.content.texts import require_text
from stair_inspector.errors import ConfigError
from stair_inspector.files.projects import Project, check_scan, parse_project, project_bytes
from stair_inspector.geometry.arrays import Colors
from stair_inspector.pictures.cameras import VIEWS, Pose, View
from stair_inspector.pictures.legends import Legend, line_entries
from stair_inspector.pictures.picture import (
    SMALLEST_PIXELS,
    Caption,
    picture_png,
    pictures_zip,
    read_background,
    scale_of,
    size_of,
)
from stair_inspector.units import Unit
from stair_inspector.viewer.bridge.markup import DIM, text
from stair_inspector.viewer.compute.jobs import Making, Tell
from stair_inspector.viewer.parts.desk import Desk, Editor, Shown
from stair_inspector.viewer.parts.export.tab import CURRENT_VIEW, SIZES
from stair_inspector.viewer.parts.look.look import Looking
from stair_inspector.viewer.parts.look.studio import studio
from stair_inspector.viewer.parts.panel import Panel
from stair_inspector.viewer.parts.steps import html
from stair_inspector.viewer.scene.stage import Mode
from stair_inspector.viewer.state.work import Keeper, work_of
from stair_inspector.writers.csv import csv_bytes
from stair_inspector.writers.debug_ply import debug_ply_bytes
from stair_inspector.writers.json import json_bytes

_LONGEST_TITLE = 200


class Exporting:
    """The Export tab's buttons."""

    def __init__(
        self,
        desk: Desk,
        panel: Panel,
        looking: Looking,
        keeper: Keeper,
        editor: Editor,
        making: Making,
        checked: Callable[[], Check | None],
    ) -> None:
        self._desk = desk
        self._panel = panel
        self._looking = looking
        self._keeper = keeper
        self._editor = editor
        self._making = making
        self._checked = checked

    def set_title(self, title: object) -> None:
        """Name the inspection."""
        try:
            words = require_text(" ".join(str(title).split())[:_LONGEST_TITLE], "Title")
        except ConfigError:
            self._panel.export.title.value = self._editor.work.title
            raise
        if words != self._editor.work.title:
            # What is typed in one go is one change.
            self._editor.edit("title", lambda _: {"title": words}, "title")

    def download(self, kind: str) -> None:
        """Send a file of the result that is shown."""
        desk = self._desk
        with desk.lock:
            shown, marked = desk.result("export"), desk.marked
            check = self._checked() if kind == "JSON" else None
        make: dict[str, tuple[str, Callable[[Tell], bytes]]] = {
            "CSV": (".csv", lambda _: csv_bytes(marked or shown.inspection)),
            "JSON": (".json", lambda _: json_bytes(marked or shown.inspection, check)),
            "Debug PLY": ("_debug.ply", lambda _: debug_ply_bytes(shown.scan, shown.inspection)),
            "Screenshot PNG": (".png", lambda tell: self._picture(shown, tell)),
            "All views ZIP": ("_views.zip", lambda tell: self._all_views(shown, tell)),
            "Project file": (".stair.json", lambda _: self._project()),
        }
        ending, content = make[kind]
        name = f"{shown.stem}{ending}"
        data = self._making.make(name, content)
        desk.client.send_file_download(name, data, save_immediately=True)

    def open_project(self, file: Any) -> None:
        """Take up a project from a file: its settings, overrules, measurements, views and names; can be undone."""
        project = parse_project(file.content, str(file.name)[:80])
        with self._desk.lock:
            shown = self._desk.result("open project")
            check_scan(project, shown.scan.sha256, shown.label, str(file.name)[:80])
            self._editor.take_up(work_of(project), f"opened {str(file.name)[:40]}")

    def show_saved(self) -> None:
        """Say where the project is saved, or why it is not."""
        keeper = self._keeper
        path, saved_at = keeper.path, keeper.saved_at
        if keeper.error:
            words = f'<span style="color:#e03131">Not saved: {text(keeper.error)}</span>'
        elif path is not None and saved_at is not None:
            words = f"Saved at {saved_at.strftime('%H:%M:%S')} in {text(path.name)}"
        elif path is not None:
            words = f"Every change is saved in {text(path.name)}"
        else:
            words = "Kept until the server ends; download the project to keep it longer"
        self._panel.export.saved.content = (
            f'<div data-testid="saved" style="font-size:12px;color:{DIM};padding:2px 9px 6px;overflow-wrap:anywhere">'
            f"{words}.</div>"
        )

    def _project(self) -> bytes:
        project: Project | None = self._keeper.project()
        if project is None:
            raise ConfigError("project: the scan has not been read yet; wait for the first result")
        return project_bytes(project)

    # Pictures.

    def _picture(self, shown: Shown, tell: Tell) -> bytes:
        view = self._panel.export.view.value
        known = next((known for known in VIEWS if known == view), None)
        if known is None and view != CURRENT_VIEW:
            raise ConfigError(f"view: got {str(view)[:40]!r}; give one of {', '.join((CURRENT_VIEW, *VIEWS))}")
        sitting = self._sit(shown)
        name, pose, fov_rad = ("current view", *self._camera()) if known is None else self._view(shown, known)
        tell("making the picture …", 10.0)
        with self._studio() as render:
            return self._finish(sitting, name, render(pose, fov_rad), pose, fov_rad)

    def _all_views(self, shown: Shown, tell: Tell) -> bytes:
        sitting = self._sit(shown)
        views = [self._view(shown, view) for view in VIEWS]
        names = [name for name, _, _ in views]

        def told(name: str) -> bool:
            made = names.index(name)
            tell(f"picture {made + 1} of {len(names)} …", 100.0 * made / len(names))
            return True

        with self._studio() as render:
            return pictures_zip(
                shown.stem,
                views,
                render,
                lambda name, pixels, pose, fov: self._finish(sitting, name, pixels, pose, fov),
                told,
            )

    def _sit(self, shown: Shown) -> "_Sitting":
        """Note what is said of pictures: while they are made the page goes on."""
        with self._desk.lock:
            sitting = _Sitting(
                shown, self._editor.work.title, self._looking.legend, self._desk.stage.mode, self._desk.unit
            )
            self._check(sitting)
            return sitting

    def _check(self, sitting: "_Sitting") -> None:
        """Raise unless what the page shows is what the caption says: each drawing has a legend of its own."""
        with self._desk.lock:
            is_same = self._desk.shown is sitting.shown and self._looking.legend is sitting.legend
            if not (is_same and self._desk.stage.mode == sitting.mode):
                raise ConfigError(
                    "picture: what is shown changed while the picture was made; wait until it is at rest and try again"
                )

    def _camera(self) -> tuple[Pose, float]:
        with self._desk.lock:
            return self._looking.camera()

    def _view(self, shown: Shown, view: View) -> tuple[str, Pose, float]:
        with self._desk.lock:
            pose = self._looking.pose_of(shown, view, self._looking.aspect)
            return view, pose, self._looking.fov_rad

    @contextlib.contextmanager
    def _studio(self) -> Iterator[Callable[[Pose, float], Colors]]:
        """Lend the page's camera for pictures of the chosen size."""
        camera = self._desk.client.camera
        factor = SIZES.get(self._panel.export.size.value, 1)
        size = size_of(max(camera.image_width, SMALLEST_PIXELS), max(camera.image_height, SMALLEST_PIXELS), factor)
        with self._looking.lent(), studio(self._desk, *size) as render:
            yield render

    def _finish(self, sitting: "_Sitting", view: str, pixels: Colors, pose: Pose, fov_rad: float) -> bytes:
        self._check(sitting)
        caption = Caption(
            title=sitting.title,
            scan=sitting.shown.label,
            view=view,
            date=datetime.datetime.now().strftime("%Y-%m-%d %H:%M"),
            settings=html.used_text(sitting.shown.inspection),
        )
        background = read_background(self._panel.export.ground.value)
        scale = scale_of(pose, fov_rad, pixels.shape[0], sitting.unit)
        return picture_png(pixels, caption, self._legend(sitting), scale, background)

    def _legend(self, sitting: "_Sitting") -> Legend | None:
        """Return what the colours of the points mean, and those of the lines over them."""
        if sitting.mode == "Raw" or sitting.legend is None:
            return Legend("colours of the scan; grey where it has none")
        return dataclasses.replace(sitting.legend, entries=(*sitting.legend.entries, *line_entries(self._desk.palette)))


@dataclass(frozen=True, slots=True, eq=False)
class _Sitting:
    """What pictures show and say, as it was when they were asked for."""

    shown: Shown
    title: str
    legend: Legend | None
    mode: Mode
    unit: Unit
