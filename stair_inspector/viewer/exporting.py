"""What an inspector takes away: the result's files, pictures and the project."""

import contextlib
import datetime
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from stair_inspector.errors import ConfigError
from stair_inspector.files.exports import csv_bytes, debug_ply_bytes, json_bytes
from stair_inspector.files.projects import Project, check_scan, parse_project, project_bytes
from stair_inspector.geometry.arrays import Colors
from stair_inspector.viewer import html
from stair_inspector.viewer.cameras import VIEWS, Pose, View
from stair_inspector.viewer.desk import Desk, Editor, Shown
from stair_inspector.viewer.looking import Looking
from stair_inspector.viewer.markup import DIM, text
from stair_inspector.viewer.panel import Panel
from stair_inspector.viewer.pictures import (
    Caption,
    check_size,
    picture_png,
    pictures_zip,
    read_background,
    scale_of,
)
from stair_inspector.viewer.studio import studio
from stair_inspector.viewer.tabs.export import CURRENT_VIEW, SIZES
from stair_inspector.viewer.work import Keeper, work_of


class Exporting:
    """The Export tab's buttons."""

    def __init__(
        self,
        desk: Desk,
        panel: Panel,
        looking: Looking,
        keeper: Keeper,
        editor: Editor,
        show_making: Callable[[str | None, float], None],
    ) -> None:
        self._desk = desk
        self._panel = panel
        self._looking = looking
        self._keeper = keeper
        self._editor = editor
        self._show_making = show_making
        self._is_cancelled = False
        self._one_at_a_time = threading.Lock()

    def set_title(self, title: object) -> None:
        """Name the inspection."""
        words = " ".join(str(title).split())[:200]
        if words != self._editor.work.title:
            self._editor.change("title", title=words)

    def download(self, kind: str) -> None:
        """Send a file of the result that is shown."""
        desk = self._desk
        with desk.lock:
            shown = desk.result("export")
        # Two scans of the same name have the folder in their label.
        stem = Path(shown.label).with_suffix("").as_posix().replace("/", "_")
        make: dict[str, tuple[str, Callable[[], bytes]]] = {
            "CSV": (f"{stem}.csv", lambda: csv_bytes(shown.inspection)),
            "JSON": (f"{stem}.json", lambda: json_bytes(shown.inspection)),
            "Debug PLY": (f"{stem}_debug.ply", lambda: debug_ply_bytes(shown.scan, shown.inspection)),
            "Screenshot PNG": (f"{stem}.png", lambda: self._picture(shown)),
            "All views ZIP": (f"{stem}_views.zip", lambda: self._all_views(shown, stem)),
            "Project file": (f"{stem}.stair.json", self._project),
        }
        name, content = make[kind]
        with desk.notices.working(f"Making {name} …"):
            data = content()
        desk.client.send_file_download(name, data, save_immediately=True)

    def cancel(self) -> None:
        """Stop making pictures after the one that is being made."""
        self._is_cancelled = True

    def open_project(self, file: Any) -> None:
        """Take up a project from a file: its settings, overrules, measurements, views and names; can be undone."""
        shown = self._desk.result("open project")
        project = parse_project(file.content, str(file.name)[:80])
        check_scan(project, shown.scan.sha256, shown.label, str(file.name)[:80])
        self._editor.take_up(work_of(project), f"opened {str(file.name)[:40]}")

    def show_saved(self, path: Path | None, error: str) -> None:
        """Say where the project is saved, or why it is not."""
        if error:
            words = f'<span style="color:#e03131">Not saved: {text(error)}</span>'
        elif path is not None:
            now = datetime.datetime.now().strftime("%H:%M:%S")
            words = f"Saved at {now} in {text(path.name)}"
        elif self._keeper.path is not None:
            words = f"Every change is saved in {text(self._keeper.path.name)}"
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

    def _picture(self, shown: Shown) -> bytes:
        view = self._panel.export.view.value
        known = next((known for known in VIEWS if known == view), None)
        if known is None and view != CURRENT_VIEW:
            raise ConfigError(f"view: got {str(view)[:40]!r}; give one of {', '.join((CURRENT_VIEW, *VIEWS))}")
        name, pose, fov_rad = ("current view", *self._camera()) if known is None else self._view(shown, known)
        with self._studio() as render:
            return self._finish(shown, name, render(pose, fov_rad), pose, fov_rad)

    def _all_views(self, shown: Shown, stem: str) -> bytes:
        views = [self._view(shown, view) for view in VIEWS]
        self._is_cancelled = False
        names = [name for name, _, _ in views]

        def tell(name: str) -> bool:
            made = names.index(name)
            self._show_making(f"picture {made + 1} of {len(names)} …", 100.0 * made / len(names))
            return not (self._desk.is_closed or self._is_cancelled)

        try:
            with self._studio() as render:
                return pictures_zip(
                    stem,
                    views,
                    render,
                    lambda name, pixels, pose, fov: self._finish(shown, name, pixels, pose, fov),
                    tell,
                )
        finally:
            self._show_making(None, 0.0)

    def _camera(self) -> tuple[Pose, float]:
        with self._desk.lock:
            return self._looking.pose(), float(self._desk.client.camera.fov)

    def _view(self, shown: Shown, view: View) -> tuple[str, Pose, float]:
        with self._desk.lock:
            pose = self._looking.pose_of(shown, view, self._desk.client.camera.aspect)
            return view, pose, self._looking.fov_rad

    @contextlib.contextmanager
    def _studio(self) -> Iterator[Callable[[Pose, float], Colors]]:
        """Lend the page's camera for pictures of the chosen size, to one at a time."""
        camera = self._desk.client.camera
        factor = SIZES.get(self._panel.export.size.value, 1)
        size = check_size(max(camera.image_width, 200) * factor, max(camera.image_height, 200) * factor)
        with self._one_at_a_time, studio(self._desk.client, self._desk.stage, *size) as render:
            yield render

    def _finish(self, shown: Shown, view: str, pixels: Colors, pose: Pose, fov_rad: float) -> bytes:
        caption = Caption(
            title=self._editor.work.title,
            scan=shown.label,
            view=view,
            date=datetime.datetime.now().strftime("%Y-%m-%d %H:%M"),
            settings=html.used_text(shown.inspection),
        )
        background = read_background(self._panel.export.ground.value)
        scale = scale_of(pose, fov_rad, pixels.shape[0], self._desk.unit)
        return picture_png(pixels, caption, self._looking.legend, scale, background)
