"""What is drawn of an inspection: first as plain arrays, which can be tested, then with viser."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Any, Literal

import numpy as np
import viser

from stair_inspector.files.palettes import Palette, Rgb
from stair_inspector.geometry.arrays import Colors, Floats
from stair_inspector.model import Inspection, Step
from stair_inspector.viewer.display import Display

Mode = Literal["Raw", "Segmented", "Side by side"]

MODES: tuple[Mode, ...] = ("Raw", "Segmented", "Side by side")
_EDGE_PIXELS = 3.0
_GAP_SHARE = 0.25
"""Gap between the two clouds side by side, as a share of their width."""
_HIGHLIGHT = (0, 214, 230)


@dataclass(frozen=True, slots=True, eq=False)
class Drawing:
    """The segmentation as plain data, local coordinates.

    ``colors`` (m, 3) of the displayed points; ``edges`` (e, 2, 3) with ``edge_colors`` (e, 3), lifted off the surface
    by about a point's size so that its points do not cover them; ``centres`` (c, 3) the points kept around the
    centroids; ``corners`` one (4, 3) plate for each step; ``labels`` their names.
    """

    colors: Colors
    edges: Floats
    edge_colors: Colors
    centres: Floats
    corners: tuple[Floats, ...]
    labels: tuple[str, ...]


def draw(inspection: Inspection, display: Display, scan_points: Floats, palette: Palette) -> Drawing:
    """Return what is drawn of an inspection.

    Parameters
    ----------
    inspection, display
        Of the same scan.
    scan_points : (n, 3)
        All points of that scan, local.
    palette : Palette
        Colours of the page.
    """
    labels = inspection.labels[display.point_ids]
    # A rejected level is no step and is drawn as what is left over.
    labels = np.where(labels > len(inspection.steps), -1, labels).astype(np.int16)
    edges, colors = [], []
    for step in inspection.steps:
        # Lines that lie exactly in the surface would be covered by half of its points.
        lift_m = display.spacing_m + 2.0 * (step.plane.rms_m or 0.0)
        front_left, front_right, back_right, back_left = step.corners + lift_m * inspection.up.vector
        edges += [
            (front_left, back_left),
            (front_right, back_right),
            (back_left, back_right),
            (front_left, front_right),
        ]
        colors += [palette.side_edge, palette.side_edge, palette.back_edge, palette.front_edge]
    centres = [scan_points[step.nearest_ids] for step in inspection.steps]
    return Drawing(
        colors=palette.of_labels(labels),
        edges=np.array(edges).reshape(-1, 2, 3),
        edge_colors=np.array(colors, dtype=np.uint8).reshape(-1, 3),
        centres=np.concatenate(centres) if centres else np.zeros((0, 3)),
        corners=tuple(step.corners for step in inspection.steps),
        labels=tuple(str(step.step_id) for step in inspection.steps),
    )


def view_from_local(inspection: Inspection) -> Floats:
    """Return the rotation (3, 3) from local axes to the view: right of the climber, along the climb, up."""
    up = inspection.up.vector
    if inspection.axes is not None:
        return np.stack([-inspection.axes.width, -inspection.axes.depth, up])
    some = np.eye(3)[np.argmin(np.abs(up))]
    right = np.cross(some, up)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(up, right), up])


def extent_of(points: Floats) -> Floats:
    """Return the eight corners (8, 3) of the box around all but the outermost points."""
    low, high = np.percentile(points, [0.5, 99.5], axis=0)
    return np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])])


def quaternion(rotation: Floats) -> tuple[float, float, float, float]:
    """Return the quaternion (w, x, y, z) of a rotation matrix."""
    wxyz = viser.transforms.SO3.from_matrix(rotation).wxyz
    return (float(wxyz[0]), float(wxyz[1]), float(wxyz[2]), float(wxyz[3]))


@dataclass
class Stage:
    """The nodes of one inspector's scene.

    Everything hangs below ``/stair``, whose rotation stands the staircase upright, so that a camera always has z up.
    The raw cloud and the segmentation share that frame; side by side, the segmentation moves to the right.
    """

    client: viser.ClientHandle
    rotation: Floats = field(default_factory=lambda: np.eye(3))
    extent: Floats = field(default_factory=lambda: np.zeros((8, 3)))
    mode: Mode = "Segmented"
    _nodes: dict[str, Any] = field(default_factory=dict)
    _per_step: list[tuple[Any, Any]] = field(default_factory=list)

    def show_scan(self, display: Display, rotation: Floats, point_size_m: float) -> None:
        """Replace everything by a scan, standing upright."""
        self.clear()
        scene = self.client.scene
        self.rotation = rotation
        self.extent = extent_of(display.points @ rotation.T)
        self._nodes["stair"] = scene.add_frame("/stair", show_axes=False, wxyz=quaternion(rotation))
        self._nodes["segments"] = scene.add_frame("/stair/segments", show_axes=False)
        for name, is_visible in (("/stair/raw", self.mode != "Segmented"), ("/stair/segments/cloud", True)):
            self._nodes[name] = scene.add_point_cloud(
                name,
                display.points.astype(np.float32),
                display.colors,
                point_size=point_size_m,
                point_shape="circle",
                point_shading="flat",
                precision="float32",
                visible=is_visible,
            )
        self.set_mode(self.mode)

    def show_drawing(self, drawing: Drawing, centre: Rgb, on_pick: Callable[[int], None]) -> None:
        """Replace the segmentation; ``on_pick(step_id)`` is called when a step's plate is clicked."""
        scene = self.client.scene
        self._nodes["/stair/segments/cloud"].colors = drawing.colors
        self._replace_lines("/stair/segments/edges", drawing.edges, drawing.edge_colors)
        if not len(drawing.centres):
            self._remove("/stair/segments/centres")
        else:
            # Added again under the same name, it takes the old one's place without a gap.
            self._nodes["/stair/segments/centres"] = scene.add_point_cloud(
                "/stair/segments/centres",
                drawing.centres.astype(np.float32),
                centre,
                point_size=1.6 * self._nodes["/stair/raw"].point_size,
                point_shape="circle",
                point_shading="flat",
                precision="float32",
            )
        if len(self._per_step) != len(drawing.corners):
            self._add_steps(drawing, on_pick)
        for (plate, label), corners in zip(self._per_step, drawing.corners, strict=True):
            plate.vertices = corners.astype(np.float32)
            label.position = _beside(corners)

    def highlight(self, step: Step | None, points: Floats) -> None:
        """Draw one step's points and outline on top of the segmentation, or nothing."""
        self._remove("/stair/segments/selected")
        self._remove("/stair/segments/outline")
        if step is None:
            return
        self._nodes["/stair/segments/selected"] = self.client.scene.add_point_cloud(
            "/stair/segments/selected",
            points.astype(np.float32),
            _HIGHLIGHT,
            point_size=1.7 * self._nodes["/stair/raw"].point_size,
            point_shape="circle",
            point_shading="flat",
            precision="float32",
        )
        outline = np.stack([step.corners, np.roll(step.corners, -1, axis=0)], axis=1)
        self._replace_lines(
            "/stair/segments/outline",
            outline,
            np.tile(np.array(_HIGHLIGHT, dtype=np.uint8), (4, 1)),
            2.0 * _EDGE_PIXELS,
        )

    def set_mode(self, mode: Mode) -> None:
        """Show the raw cloud, the segmentation, or both side by side."""
        self.mode = mode
        if "stair" not in self._nodes:
            return
        self._nodes["/stair/raw"].visible = mode != "Segmented"
        self._nodes["segments"].visible = mode != "Raw"
        # Along the view's x axis, given in the frame's own axes.
        self._nodes["segments"].position = (
            self._shift() * self.rotation[0] if mode == "Side by side" else (0.0, 0.0, 0.0)
        )

    def set_point_size(self, size_m: float) -> None:
        """Set the diameter of the points, metres."""
        for name, factor in (
            ("/stair/raw", 1.0),
            ("/stair/segments/cloud", 1.0),
            ("/stair/segments/centres", 1.6),
            ("/stair/segments/selected", 1.7),
        ):
            if name in self._nodes:
                self._nodes[name].point_size = factor * size_m

    def visible_extent(self) -> Floats:
        """Return the corners (n, 3) of what the present mode shows, in the coordinates of the view."""
        if self.mode != "Side by side":
            return self.extent
        return np.vstack([self.extent, self.extent + np.array([self._shift(), 0.0, 0.0])])

    def clear(self) -> None:
        """Remove everything."""
        self._remove_steps()
        for name in list(self._nodes)[::-1]:
            self._remove(name)

    def _add_steps(self, drawing: Drawing, on_pick: Callable[[int], None]) -> None:
        self._remove_steps()
        for index, (corners, text) in enumerate(zip(drawing.corners, drawing.labels, strict=True)):
            # All but invisible: it is there to be clicked.
            plate = self.client.scene.add_mesh_simple(
                f"/stair/segments/steps/{text}",
                corners.astype(np.float32),
                np.array([[0, 1, 2], [0, 2, 3]]),
                color=_HIGHLIGHT,
                opacity=0.02,
                side="double",
                cast_shadow=False,
                receive_shadow=False,
            )
            plate.on_click(partial(_pick, on_pick, index + 1))
            label = self.client.scene.add_label(
                f"/stair/segments/labels/{text}",
                text,
                position=_beside(corners),
                anchor="center-center",
                font_screen_scale=0.9,
            )
            self._per_step.append((plate, label))

    def _remove_steps(self) -> None:
        for plate, label in self._per_step:
            plate.remove()
            label.remove()
        self._per_step = []

    def _shift(self) -> float:
        width = float(np.ptp(self.extent[:, 0]))
        return width * (1.0 + _GAP_SHARE)

    def _replace_lines(self, name: str, segments: Floats, colors: Colors, pixels: float = _EDGE_PIXELS) -> None:
        if not len(segments):
            self._remove(name)
            return
        self._nodes[name] = self.client.scene.add_line_segments(
            name,
            segments.astype(np.float32),
            np.repeat(_linear(colors)[:, None, :], 2, axis=1),
            thickness=pixels,
            thickness_units="screen",
        )

    def _remove(self, name: str) -> None:
        if name in self._nodes:
            self._nodes.pop(name).remove()


def _linear(colors: Colors) -> Colors:
    """Return the intensities that the browser turns back into these colours: for lines alone it takes them as light."""
    shares = colors / 255.0
    light = np.where(shares <= 0.04045, shares / 12.92, ((shares + 0.055) / 1.055) ** 2.4)
    return np.rint(255.0 * light).astype(np.uint8)


def _pick(on_pick: Callable[[int], None], step_id: int, _: Any) -> None:
    on_pick(step_id)


def _beside(corners: Floats) -> Floats:
    """Return the place of a step's label: to the right of its front edge, where it covers no tread."""
    across = corners[1] - corners[0]
    length = float(np.linalg.norm(across))
    place: Floats = corners[1] + (0.12 / length) * across if length > 0.0 else corners[1]
    return place
