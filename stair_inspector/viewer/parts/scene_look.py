"""How one inspector looks at the scan: modes, views and the orthographic look, colours, shading and density."""

import contextlib
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from stair_inspector.errors import ConfigError, one_of
from stair_inspector.geometry.arrays import Colors, Floats
from stair_inspector.model import Inspection, Scan
from stair_inspector.pictures.cameras import (
    FOV_RAD,
    ORTHO_FOV_RAD,
    USUAL_PITCH_DEG,
    VIEWS,
    Pose,
    View,
    clip_range,
    frame_view,
    step_frame,
    with_fov,
)
from stair_inspector.pictures.coloring import COLOR_MODES, ColorMode, color_points, crease_of, dimmed, shade
from stair_inspector.pictures.display import MAX_POINTS, Display, choose_display
from stair_inspector.pictures.frames import step_of
from stair_inspector.pictures.legends import Legend
from stair_inspector.pictures.segmentation import SegmentedScene, draw, is_left_hidden, view_from_local
from stair_inspector.stages.orient import region_box
from stair_inspector.viewer.parts.desk import Desk, Shown
from stair_inspector.viewer.scene.framing import free_part, page_camera, place_camera, raised
from stair_inspector.viewer.scene.stage import MODES
from stair_inspector.viewer.state.change import PageChange

SMALLEST_POINT_MM, LARGEST_POINT_MM = 0.1, 100.0
_LARGEST_DISC = 1.0 / 150.0
"""Largest diameter of a drawn point, as a share of the scan's diagonal: a wrong unit must not fill the screen."""
_FEWEST_POINTS = 1000
_GROUNDS = ((255, 255, 255), (26, 27, 30))
"""Behind the scene, of the light and of the dark theme."""
_USUAL_ASPECT = 1.5
_MOST_AROUND = 2.0
"""A scan up to so many times as large as its stair is shown whole."""
_AROUND_STAIR_M = 1.0
"""Room around the stair in a standard view: floor in front of it and what stands beside it."""


@dataclass(frozen=True, slots=True, eq=False)
class _Framed:
    """A view that was chosen: of the whole scan or of the stair, in a picture of that shape, from that place (3,)."""

    view: View | int
    is_whole: bool
    aspect: float
    position: Floats


class SceneLook:
    """Everything about the picture that is no result. Callers hold the desk's lock, but for what a person chooses.

    ``color_mode``, ``is_shaded``, ``is_ortho`` and ``percent`` of the points belong to the page and not to the project.
    ``gone_to`` is where the camera was last sent, and its angle of view: another object with every move.
    """

    def __init__(self, desk: Desk) -> None:
        self._desk = desk
        self._framed: _Framed | None = None
        self.gone_to: tuple[Pose, float] | None = None
        # While pictures are taken: where the inspector's camera stands, and its angle of view.
        self._lent_from: tuple[Pose, float] | None = None
        self.is_ortho = False
        self.color_mode: ColorMode = "Step"
        self.is_shaded = False
        self.percent = 100
        self.legend: Legend | None = None
        self._normals: tuple[Scan, Floats] | None = None
        self._crease: tuple[Display, Floats] | None = None
        self._prepared: tuple[Shown, SegmentedScene] | None = None

    # Points and their colours.

    def know_normals(self, scan: Scan, normals: Floats) -> None:
        """Take the normals (n, 3) of a scan's points, which shading and one way of colouring need."""
        self._normals = (scan, normals)

    def set_percent(self, percent: float) -> None:
        """Choose how many of the points are drawn."""
        if not 1 <= float(percent) <= 100:
            raise ConfigError(f"points drawn: got {percent!r}; give 1 to 100 %")
        self.percent = int(percent)

    def display(self, scan: Scan) -> Display:
        """Return what of a scan is drawn at the present density."""
        most = min(len(scan.points), MAX_POINTS)
        return choose_display(scan, max(min(_FEWEST_POINTS, most), most * self.percent // 100))

    def set_color(self, option: object) -> None:
        """Choose what the colours tell."""
        with self._desk.lock:
            self.color_mode = one_of(option, COLOR_MODES, "colour by")
            self._desk.changed(PageChange.COLORS)

    def set_shading(self, is_shaded: object) -> None:
        """Switch the light and the darker creases on or off."""
        with self._desk.lock:
            self.is_shaded = bool(is_shaded)
            self._desk.changed(PageChange.COLORS)

    def prepare(self, shown: Shown) -> None:
        """Make what is drawn of a result that is about to be shown: if that fails, the last one stays."""
        self._prepared = (shown, self._draw(shown))

    def drawing(self, shown: Shown) -> SegmentedScene:
        """Return what is drawn of a result in the present colours; their legend is remembered."""
        prepared, self._prepared = self._prepared, None
        return prepared[1] if prepared is not None and prepared[0] is shown else self._draw(shown)

    def show_scan(self, shown: Shown) -> None:
        """Put the points of a result's scan into an empty scene, standing upright."""
        size_m = self.point_size_of(shown.display)
        self._desk.stage.show_scan(shown.display, view_from_local(shown.inspection), size_m)

    def _draw(self, shown: Shown) -> SegmentedScene:
        return draw(
            shown.inspection,
            shown.display,
            shown.scan.points,
            self._desk.palette,
            with_rejected=self._desk.with_rejected,
            colors=self.colors(shown, shown.display),
        )

    def colors(self, shown: Shown, display: Display) -> Colors:
        """Return the colours of displayed points."""
        axes = view_from_local(shown.inspection)
        normals = self._normals[1] if self._normals is not None and self._normals[0] is shown.scan else None
        coloring = color_points(
            self.color_mode,
            shown.inspection,
            display,
            self._desk.palette,
            normals=normals,
            axes=axes,
            with_rejected=self._desk.with_rejected,
            compared=self._desk.compared_of(shown),
        )
        self.legend = coloring.legend
        colors = coloring.colors
        if self.is_shaded and normals is not None:
            own = normals[display.point_ids]
            colors = shade(colors, own, axes, self._creases(display, own))
        return self._dimmed_outside(shown, display, colors)

    def raw_colors(self, shown: Shown) -> Colors:
        """Return the colours of the raw cloud."""
        colors = shown.display.raw_colors(by_intensity=self.color_mode == "Intensity")
        return self._dimmed_outside(shown, shown.display, colors)

    def _dimmed_outside(self, shown: Shown, display: Display, colors: Colors) -> Colors:
        """Dim what lies outside of the region that the result was measured in."""
        box = region_box(shown.inspection.params.overrules.region, shown.inspection.up, shown.scan)
        ground = _GROUNDS[self._desk.is_dark]
        return colors if box is None else dimmed(colors, ~box.holds(display.points), ground)

    def point_size_of(self, display: Display) -> float:
        """Return the diameter at which points look like a surface, metres."""
        size_m = max(0.002, 1.25 * display.spacing_m)
        return min(size_m, _LARGEST_DISC * float(np.linalg.norm(np.ptp(display.points, axis=0))))

    def set_point_size(self, size_mm: float) -> None:
        """Set the diameter of the drawn points."""
        if not SMALLEST_POINT_MM <= float(size_mm) <= LARGEST_POINT_MM:
            raise ConfigError(f"point size: got {size_mm!r}; give {SMALLEST_POINT_MM:g} to {LARGEST_POINT_MM:g} mm")
        with self._desk.lock:
            self._desk.stage.set_point_size(float(size_mm) / 1000.0)

    def _creases(self, display: Display, normals: Floats) -> Floats:
        if self._crease is None or self._crease[0] is not display:
            self._crease = (display, crease_of(display.points, normals, display.spacing_m))
        return self._crease[1]

    # Modes and views.

    def choose_mode(self, option: str) -> None:
        """Show the raw cloud, the steps, or both, and say so on the page."""
        with self._desk.lock:
            self.set_mode(option)
            self._desk.changed(PageChange.MODE)

    def set_mode(self, option: str) -> None:
        """Show the raw cloud, the steps, or both; a framed view is framed anew, as each half must hold all of it."""
        known = one_of(option, MODES, "view")
        framed = self._framed
        self._desk.stage.set_mode(known)
        if framed is not None and self._stands_at(framed.position):
            self.look(framed.view, is_whole=framed.is_whole)

    def set_view(self, option: str) -> None:
        """Stand back from a side of the staircase."""
        with self._desk.lock:
            self.look(one_of(option, VIEWS, "camera"))

    def look_at_step(self) -> None:
        """Look at the chosen step.

        Raises
        ------
        ConfigError
            None is chosen.
        """
        with self._desk.lock:
            if step_of(self._desk.inspection, self._desk.selected) is None:
                raise ConfigError("look at step: choose a step first")
            self.look(self._desk.selected or 0)

    def set_ortho(self, is_ortho: bool) -> None:
        """Look as if from far away, so that parallels stay parallel, or as the eye sees."""
        with self._desk.lock:
            if bool(is_ortho) == self.is_ortho:
                return
            # Not that of the look: a section or a kept view may have set another one.
            pose, before = self.camera()
            self.is_ortho = bool(is_ortho)
            self.go_to(with_fov(pose, before, self.fov_rad), self.fov_rad)

    @property
    def fov_rad(self) -> float:
        """The upright angle of view."""
        return ORTHO_FOV_RAD if self.is_ortho else FOV_RAD

    @property
    def aspect(self) -> float:
        """Width over height of the scene on the page; of a usual one where it has no height, as in a folded window."""
        camera = self._desk.client.camera
        width, height = camera.image_width, camera.image_height
        return width / height if width > 0 and height > 0 else _USUAL_ASPECT

    def look(self, view: View | int, *, is_whole: bool = False) -> None:
        """Frame a standard view of the stair or of the whole scan, or the step of a number, beside what covers it."""
        shown = self._desk.shown
        if shown is None:
            return
        camera = self._desk.client.camera
        # Side by side, each cloud has half of the width.
        width = camera.image_width // (2 if self._desk.stage.mode == "Side by side" else 1)
        free = free_part(width, camera.image_height, self.fov_rad, with_labels=isinstance(view, int))
        pose = self.pose_of(shown, view, free.aspect, fov_rad=free.fov_rad, is_whole=is_whole)
        pose = raised(pose, free.raised * math.tan(self.fov_rad / 2.0))
        self.go_to(pose, self.fov_rad)
        self._framed = _Framed(view, is_whole, self.aspect, pose.position)

    def pose_of(
        self, shown: Shown, view: View | int, aspect: float, *, fov_rad: float | None = None, is_whole: bool = False
    ) -> Pose:
        """Return the camera of a view, in a picture of that shape, perhaps with an angle of view of its own."""
        stage, inspection = self._desk.stage, shown.inspection
        # The view stays where it was turned for this scan; its axes may since have been found elsewhere.
        turn = stage.rotation @ view_from_local(inspection).T
        step = step_of(inspection, view) if isinstance(view, int) else None
        extent = stage.extent if is_whole else self._stair_extent(inspection)
        standard: View = "Home"
        if step is not None:
            climb = view_from_local(inspection)[1]
            extent, turn = step_frame(step, inspection.up.vector, climb, stage.rotation)
        elif not isinstance(view, int):
            standard = view
        return frame_view(
            standard,
            extent,
            aspect,
            turn,
            fov_rad or self.fov_rad,
            is_from_right=is_left_hidden(inspection, shown.display),
            pitch_deg=_pitch_of(inspection),
        )

    def pose(self) -> Pose:
        """Return where the inspector's camera stands now."""
        return self.camera()[0]

    def camera(self) -> tuple[Pose, float]:
        """Return where the inspector's camera stands now, and its upright angle of view.

        While it is lent, this is not where a picture is taken but where it goes afterwards.
        """
        if self._lent_from is not None:
            return self._lent_from
        return page_camera(self._desk.client)

    def go_to(self, pose: Pose, fov_rad: float) -> None:
        """Put the camera somewhere."""
        camera = self._desk.client.camera
        near, far = clip_range(pose, self._desk.stage.extent)
        with self._desk.client.atomic():
            camera.near, camera.far = near, far
            place_camera(self._desk.client, pose, fov_rad)
        self.gone_to = (pose, fov_rad)
        if self._lent_from is not None:
            self._lent_from = self.gone_to
        self._framed = None

    @contextlib.contextmanager
    def lent(self) -> Iterator[None]:
        """Lend the camera to who puts it back; where the inspector has sent it meanwhile, it goes afterwards."""
        with self._desk.lock:
            before, self._lent_from = self.gone_to, self.camera()
        try:
            yield
        finally:
            with self._desk.lock:
                self._lent_from = None
                gone_to, framed = self.gone_to, self._framed
                if gone_to is not None and gone_to is not before and self._desk.shown is not None:
                    self.go_to(*gone_to)
                    self._framed = framed

    def reframe(self) -> None:
        """Frame the view again when the picture has another shape, unless somebody has turned it since.

        A page tells the shape of its whole window before the panel has taken its place at the side.
        """
        framed = self._framed
        if framed is not None and abs(self.aspect - framed.aspect) > 0.01 and self._stands_at(framed.position):
            self.look(framed.view, is_whole=framed.is_whole)

    def _stands_at(self, position: Floats) -> bool:
        return np.allclose(self.pose().position, position, atol=1e-3)

    def _stair_extent(self, inspection: Inspection) -> Floats:
        """Return the corners (n, 3) of a box around the stair with some of what is around it, as the mode shows it.

        A scan may reach much farther than its stair, which would be a speck in a view of everything; where it does
        not, all of it is shown.
        """
        stage = self._desk.stage
        whole = stage.extent
        if not inspection.steps:
            return whole
        corners = np.concatenate([step.corners for step in inspection.steps]) @ stage.rotation.T
        box = np.array([corners.min(axis=0) - _AROUND_STAIR_M, corners.max(axis=0) + _AROUND_STAIR_M])
        box = np.clip(box, stage.extent.min(axis=0), stage.extent.max(axis=0))
        if np.linalg.norm(np.ptp(whole, axis=0)) <= _MOST_AROUND * np.linalg.norm(np.ptp(box, axis=0)):
            return whole
        return np.array([[x, y, z] for x in box[:, 0] for y in box[:, 1] for z in box[:, 2]])


def _pitch_of(inspection: Inspection) -> float:
    pitches = [flight.pitch_deg.value for flight in inspection.flights if flight.pitch_deg is not None]
    return pitches[0] if pitches else USUAL_PITCH_DEG
