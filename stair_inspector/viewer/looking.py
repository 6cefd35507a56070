"""How one inspector looks at the scan: modes, views and the orthographic look, colours, shading and density."""

import numpy as np

from stair_inspector.errors import ConfigError
from stair_inspector.geometry.arrays import Colors, Floats
from stair_inspector.model import Inspection, Scan
from stair_inspector.viewer.cameras import (
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
from stair_inspector.viewer.coloring import ColorMode, color_points, crease_of, read_color_mode, shade
from stair_inspector.viewer.desk import Desk, Shown
from stair_inspector.viewer.display import MAX_POINTS, Display, choose_display
from stair_inspector.viewer.legends import Legend
from stair_inspector.viewer.scene import MODES, Drawing, draw, is_left_hidden, view_from_local
from stair_inspector.viewer.survey_html import step_of

SMALLEST_POINT_MM, LARGEST_POINT_MM = 0.1, 100.0
_LARGEST_DISC = 1.0 / 150.0
"""Largest diameter of a drawn point, as a share of the scan's diagonal: a wrong unit must not fill the screen."""
_FEWEST_POINTS = 1000


class Looking:
    """Everything about the picture that is no result. Callers hold the desk's lock.

    ``mode`` of the colours, ``is_shaded`` and ``percent`` of the points belong to the page and not to the project.
    """

    def __init__(self, desk: Desk) -> None:
        self._desk = desk
        self._framed: tuple[View | int, float, Floats] | None = None
        self._is_ortho = False
        self.color_mode: ColorMode = "Step"
        self.is_shaded = False
        self.percent = 100
        self.legend: Legend | None = None
        self._normals: tuple[Scan, Floats] | None = None
        self._crease: tuple[Display, Floats] | None = None

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
        self.color_mode = read_color_mode(option)

    def set_shading(self, is_shaded: object) -> None:
        """Switch the light and the darker creases on or off."""
        self.is_shaded = bool(is_shaded)

    def drawing(self, shown: Shown, *, with_rejected: bool) -> Drawing:
        """Return what is drawn of a result in the present colours; their legend is remembered."""
        return draw(
            shown.inspection,
            shown.display,
            shown.scan.points,
            self._desk.palette,
            with_rejected=with_rejected,
            colors=self.colors(shown, shown.display, with_rejected=with_rejected),
        )

    def colors(self, shown: Shown, display: Display, *, with_rejected: bool) -> Colors:
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
            with_rejected=with_rejected,
        )
        self.legend = coloring.legend
        if not self.is_shaded or normals is None:
            return coloring.colors
        own = normals[display.point_ids]
        return shade(coloring.colors, own, axes, self._creases(display, own))

    def point_size_of(self, display: Display) -> float:
        """Return the diameter at which points look like a surface, metres."""
        size_m = max(0.002, 1.25 * display.spacing_m)
        return min(size_m, _LARGEST_DISC * float(np.linalg.norm(np.ptp(display.points, axis=0))))

    def set_point_size(self, size_mm: float) -> None:
        """Set the diameter of the drawn points."""
        if not SMALLEST_POINT_MM <= float(size_mm) <= LARGEST_POINT_MM:
            raise ConfigError(f"point size: got {size_mm!r}; give {SMALLEST_POINT_MM:g} to {LARGEST_POINT_MM:g} mm")
        self._desk.stage.set_point_size(float(size_mm) / 1000.0)

    def _creases(self, display: Display, normals: Floats) -> Floats:
        if self._crease is None or self._crease[0] is not display:
            self._crease = (display, crease_of(display.points, normals, display.spacing_m))
        return self._crease[1]

    # Modes and views.

    def set_mode(self, option: str) -> None:
        """Show the raw cloud, the steps, or both side by side."""
        known = next((known for known in MODES if known == option), None)
        if known is None:
            raise ConfigError(f"view: got {str(option)[:40]!r}; give one of {', '.join(MODES)}")
        self._desk.stage.set_mode(known)
        self.look("Home")

    def set_view(self, option: str) -> None:
        """Stand back from a side of the staircase."""
        known = next((known for known in VIEWS if known == option), None)
        if known is None:
            raise ConfigError(f"camera: got {str(option)[:40]!r}; give one of {', '.join(VIEWS)}")
        self.look(known)

    def look_at_step(self) -> None:
        """Look at the chosen step.

        Raises
        ------
        ConfigError
            None is chosen.
        """
        if step_of(self._desk.inspection, self._desk.selected) is None:
            raise ConfigError("look at step: choose a step first")
        self.look(self._desk.selected or 0)

    def set_ortho(self, is_ortho: bool) -> None:
        """Look as if from far away, so that parallels stay parallel, or as the eye sees."""
        if bool(is_ortho) == self._is_ortho:
            return
        before = self.fov_rad
        self._is_ortho = bool(is_ortho)
        self.go_to(with_fov(self.pose(), before, self.fov_rad), self.fov_rad)

    @property
    def is_ortho(self) -> bool:
        """Whether the look is orthographic."""
        return self._is_ortho

    @property
    def fov_rad(self) -> float:
        """The upright angle of view."""
        return ORTHO_FOV_RAD if self._is_ortho else FOV_RAD

    def look(self, view: View | int) -> None:
        """Frame a standard view, or the step of a number."""
        shown = self._desk.shown
        if shown is None:
            return
        aspect = self._desk.client.camera.aspect
        pose = self.pose_of(shown, view, aspect)
        self.go_to(pose, self.fov_rad)
        self._framed = (view, aspect, pose.position)

    def pose_of(self, shown: Shown, view: View | int, aspect: float) -> Pose:
        """Return the camera of a view, in a picture of that shape."""
        stage, inspection = self._desk.stage, shown.inspection
        # The view stays where it was turned for this scan; its axes may since have been found elsewhere.
        turn = stage.rotation @ view_from_local(inspection).T
        step = step_of(inspection, view) if isinstance(view, int) else None
        extent = stage.visible_extent()
        standard: View = "Home"
        if step is not None:
            climb = view_from_local(inspection)[1]
            extent, turn = step_frame(step, inspection.up.vector, climb, stage.rotation)
            extent = extent + np.array([stage.shift_m(), 0.0, 0.0])
        elif not isinstance(view, int):
            standard = view
        return frame_view(
            standard,
            extent,
            aspect,
            turn,
            self.fov_rad,
            is_from_right=is_left_hidden(inspection, shown.display),
            pitch_deg=_pitch_of(inspection),
        )

    def pose(self) -> Pose:
        """Return where the camera stands now."""
        camera = self._desk.client.camera
        return Pose(np.array(camera.position), np.array(camera.look_at), np.array(camera.up_direction))

    def go_to(self, pose: Pose, fov_rad: float) -> None:
        """Put the camera somewhere."""
        camera = self._desk.client.camera
        near, far = clip_range(pose, self._desk.stage.visible_extent())
        with self._desk.client.atomic():
            camera.fov = fov_rad
            camera.near, camera.far = near, far
            camera.up_direction = pose.up
            camera.position = pose.position
            # Setting the position drags the point looked at along.
            camera.look_at = pose.look_at
        self._framed = None

    def reframe(self) -> None:
        """Frame the view again when the picture has another shape, unless somebody has turned it since.

        A page tells the shape of its whole window before the panel has taken its place at the side.
        """
        camera = self._desk.client.camera
        if self._framed is None:
            return
        view, aspect, position = self._framed
        if abs(camera.aspect - aspect) > 0.01 and np.allclose(camera.position, position, atol=1e-3):
            self.look(view)


def _pitch_of(inspection: Inspection) -> float:
    pitches = [flight.pitch_deg.value for flight in inspection.flights if flight.pitch_deg is not None]
    return pitches[0] if pitches else USUAL_PITCH_DEG
