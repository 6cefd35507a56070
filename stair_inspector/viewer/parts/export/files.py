"""What an inspector takes away: the result's files, pictures and the project."""

import contextlib
import dataclasses
import datetime
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Literal

import viser

from stair_inspector.errors import ConfigError, one_of
from stair_inspector.files.project_files import project_bytes
from stair_inspector.files.projects import Project
from stair_inspector.geometry.arrays import Colors
from stair_inspector.pictures.cameras import VIEWS, Pose, View
from stair_inspector.pictures.legends import Legend, line_entries
from stair_inspector.pictures.picture import (
    BACKGROUNDS,
    SMALLEST_PIXELS,
    Caption,
    picture_png,
    pictures_zip,
    scale_of,
    size_of,
)
from stair_inspector.units import Unit
from stair_inspector.viewer.compute.jobs import Tell
from stair_inspector.viewer.parts.desk import Shown
from stair_inspector.viewer.parts.details_html import used_text
from stair_inspector.viewer.parts.part import Context
from stair_inspector.viewer.parts.studio import studio
from stair_inspector.viewer.scene.stage import Mode
from stair_inspector.writers.bcf import bcf_bytes
from stair_inspector.writers.csv import csv_bytes
from stair_inspector.writers.debug_ply import debug_ply_bytes
from stair_inspector.writers.json import json_bytes
from stair_inspector.writers.segmented import segmented_bytes

CURRENT_VIEW: Literal["Current"] = "Current"
SIZES = {"screen": 1, "2 ×": 2, "4 ×": 4}
"""Size of a picture, times the scene's size on the screen."""


class Downloads:
    """The buttons of the Export tab that send a file of the result that is shown."""

    def __init__(self, context: Context) -> None:
        self._desk = context.desk
        self._look = context.look
        self._judge = context.judge
        self._keeper = context.keeper
        self._editor = context.editor
        self._making = context.making
        self._widgets = context.widgets

    def add_files(self) -> None:
        """Add the buttons for the result's numbers and points."""
        self._add("CSV", viser.Icon.TABLE, "One row for each step, millimetres and degrees.")
        self._add("JSON", viser.Icon.BRACES, "All: settings, levels, steps, findings, notes; metres and degrees.")
        self._add("Debug PLY", viser.Icon.CUBE, "The scan in the paper's colours with its edges.")
        self._add("BCF", viser.Icon.FLAG, "The findings as issues of BCF 2.1, which programs for building models read.")
        fields = "Every point with step, kind and residual_m as fields"
        self._add("Segmented LAZ", viser.Icon.STAIRS, f"{fields}; coordinates to 0.1 mm.")
        self._add("Segmented PLY", viser.Icon.STAIRS, f"{fields}; exact coordinates.")

    def add_pictures(self) -> None:
        """Add the folder for pictures of the scene."""
        widgets = self._widgets
        with widgets.folder("Pictures"):
            self.view = widgets.dropdown("View", (CURRENT_VIEW, *VIEWS), hint="What the picture shows.")
            self.ground = widgets.dropdown("Background", BACKGROUNDS, hint="Behind the scene in the picture.")
            self.size = widgets.dropdown(
                "Size",
                tuple(SIZES),
                chosen="2 ×",
                hint="Times the scene's size on the screen; the longer side has 7680 pixels at most.",
            )
            self._add("Screenshot PNG", viser.Icon.CAMERA, "With title, scale bar, legend, date and settings.")
            self._add("All views ZIP", viser.Icon.PHOTO, "Every standard view, in one file.")

    def add_project(self) -> None:
        """Add the button for the project."""
        self._add(
            "Project file",
            viser.Icon.BRIEFCASE,
            "Settings, overrules, measurements, views and names; measure --project reproduces its numbers.",
        )

    def _add(self, kind: str, icon: viser.IconName, hint: str) -> None:
        self._widgets.button(kind, lambda: self.download(kind), icon=icon, hint=hint)

    def download(self, kind: str) -> None:
        """Send a file of the result that is shown."""
        desk = self._desk
        with desk.lock:
            shown, told = desk.result("export"), desk.inspection_to_send("export")
            check = self._judge.checked() if kind in ("JSON", "BCF") else None
            pinned = self._editor.work.findings
            compared = desk.comparison(kind) if kind == "JSON" else None
        make: dict[str, tuple[str, Callable[[Tell], bytes]]] = {
            "CSV": (".csv", lambda _: csv_bytes(told)),
            "JSON": (".json", lambda _: json_bytes(told, check, pinned, compared)),
            "BCF": (
                ".bcf",
                lambda _: bcf_bytes(shown.scan, told, check, pinned, datetime.datetime.now().astimezone()),
            ),
            "Debug PLY": ("_debug.ply", lambda _: debug_ply_bytes(shown.scan, shown.inspection)),
            "Segmented LAZ": ("_segmented.laz", lambda _: segmented_bytes(shown.scan, shown.inspection, "laz")),
            "Segmented PLY": ("_segmented.ply", lambda _: segmented_bytes(shown.scan, shown.inspection, "ply")),
            "Screenshot PNG": (".png", lambda tell: self._picture(shown, tell)),
            "All views ZIP": ("_views.zip", lambda tell: self._all_views(shown, tell)),
            "Project file": (".stair.json", lambda _: self._project()),
        }
        ending, content = make[kind]
        name = f"{shown.stem}{ending}"
        data = self._making.make(name, content)
        desk.client.send_file_download(name, data, save_immediately=True)

    def _project(self) -> bytes:
        project: Project | None = self._keeper.project()
        if project is None:
            raise ConfigError("project: the scan has not been read yet; wait for the first result")
        return project_bytes(project)

    # Pictures.

    def _picture(self, shown: Shown, tell: Tell) -> bytes:
        known: View | Literal["Current"] = one_of(self.view.value, (CURRENT_VIEW, *VIEWS), "view")
        sitting = self._sit(shown)
        with self._desk.lock:
            current = ("current view", *self._look.camera())
            name, pose, fov_rad = current if known == "Current" else self._view(shown, known)
        tell("making the picture …", 10.0)
        with self._studio() as render:
            return self._finish(sitting, name, render(pose, fov_rad), pose, fov_rad)

    def _all_views(self, shown: Shown, tell: Tell) -> bytes:
        sitting = self._sit(shown)
        views = [self._view(shown, view) for view in VIEWS]
        names = [name for name, _, _ in views]

        def told(name: str) -> None:
            made = names.index(name)
            tell(f"picture {made + 1} of {len(names)} …", 100.0 * made / len(names))

        with self._studio() as render:
            return pictures_zip(shown.stem, views, render, partial(self._finish, sitting), told)

    def _sit(self, shown: Shown) -> "_Sitting":
        """Note what is said of pictures: while they are made the page goes on."""
        with self._desk.lock:
            sitting = _Sitting(
                shown, self._editor.work.title, self._look.legend, self._desk.stage.mode, self._desk.unit
            )
            self._check(sitting)
            return sitting

    def _check(self, sitting: "_Sitting") -> None:
        """Raise unless what the page shows is what the caption says: each drawing has a legend of its own."""
        with self._desk.lock:
            is_same = self._desk.shown is sitting.shown and self._look.legend is sitting.legend
            if not (is_same and self._desk.stage.mode == sitting.mode):
                raise ConfigError(
                    "picture: what is shown changed while the picture was made; wait until it is at rest and try again"
                )

    def _view(self, shown: Shown, view: View) -> tuple[str, Pose, float]:
        with self._desk.lock:
            pose = self._look.pose_of(shown, view, self._look.aspect)
            return view, pose, self._look.fov_rad

    @contextlib.contextmanager
    def _studio(self) -> Iterator[Callable[[Pose, float], Colors]]:
        """Lend the page's camera for pictures of the chosen size."""
        camera = self._desk.client.camera
        factor = SIZES.get(self.size.value, 1)
        size = size_of(max(camera.image_width, SMALLEST_PIXELS), max(camera.image_height, SMALLEST_PIXELS), factor)
        with self._look.lent(), studio(self._desk, *size) as render:
            yield render

    def _finish(self, sitting: "_Sitting", view: str, pixels: Colors, pose: Pose, fov_rad: float) -> bytes:
        self._check(sitting)
        caption = Caption(
            title=sitting.title,
            scan=sitting.shown.label,
            view=view,
            date=datetime.datetime.now().strftime("%Y-%m-%d %H:%M"),
            settings=used_text(sitting.shown.inspection),
        )
        background = one_of(self.ground.value, BACKGROUNDS, "background")
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
