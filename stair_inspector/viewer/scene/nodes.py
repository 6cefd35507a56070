"""The nodes of a scene by name: what is drawn again under its name takes the old one's place without a gap."""

from collections.abc import Iterator, Sequence
from typing import Any, Literal

import numpy as np
import viser

from stair_inspector.files.palettes import Rgb
from stair_inspector.geometry.arrays import Colors, Floats
from stair_inspector.viewer.scene.dimensions import Anchor

NodeLabel = tuple[str, str, Floats, Anchor | Literal["center-center"]]
"""Name, words, place (3,) and anchor."""
NO_LINES = np.zeros((0, 2, 3))


class Nodes:
    """Points, lines, labels and frames of one page's scene; arrays are local, metres."""

    def __init__(self, scene: viser.SceneApi) -> None:
        self._scene = scene
        self._by_name: dict[str, Any] = {}
        self._labels: dict[str, list[viser.LabelHandle]] = {}

    def __contains__(self, name: str) -> bool:
        return name in self._by_name

    def __getitem__(self, name: str) -> Any:
        return self._by_name[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._by_name)

    def labels_in(self, folder: str) -> Sequence[viser.LabelHandle]:
        """Return the labels that stand below a node."""
        return self._labels.get(folder, [])

    def frame(self, name: str, rotation: Floats | None = None) -> None:
        """Add a frame, below which others stand, with its rotation (3, 3)."""
        wxyz = (1.0, 0.0, 0.0, 0.0) if rotation is None else quaternion(rotation)
        self._by_name[name] = self._scene.add_frame(name, show_axes=False, wxyz=wxyz)

    def points(
        self, name: str, points: Floats, colors: Colors | Rgb, size_m: float, *, is_visible: bool = True
    ) -> None:
        """Draw points (k, 3), with a colour for each (k, 3) or one for all; none takes the node away."""
        if not len(points):
            self.remove(name)
            return
        self._by_name[name] = self._scene.add_point_cloud(
            name,
            points.astype(np.float32),
            colors,
            point_size=size_m,
            point_shape="circle",
            point_shading="flat",
            precision="float32",
            visible=is_visible,
        )

    def lines(self, name: str, segments: Floats, colors: Colors | Rgb, pixels: float, *, is_visible: bool) -> None:
        """Draw lines (k, 2, 3), with a colour for each (k, 3) or one for all; none takes the node away."""
        if not len(segments):
            self.remove(name)
            return
        colors = np.broadcast_to(np.array(colors, dtype=np.uint8), (len(segments), 3))
        self._by_name[name] = self._scene.add_line_segments(
            name,
            segments.astype(np.float32),
            np.repeat(_linear(colors)[:, None, :], 2, axis=1),
            thickness=pixels,
            thickness_units="screen",
            visible=is_visible,
        )

    def labels(self, folder: str, labels: Sequence[NodeLabel] = ()) -> None:
        """Replace the labels below a node by others."""
        kept = {f"{folder}/{name}" for name, *_ in labels}
        for node in self.labels_in(folder):
            if node.name not in kept:
                node.remove()
        self._labels[folder] = [
            self._scene.add_label(f"{folder}/{name}", words, position=place, anchor=anchor, font_screen_scale=0.85)
            for name, words, place, anchor in labels
        ]

    def remove(self, name: str) -> None:
        """Take a node away, if there is one of that name."""
        if name in self._by_name:
            self._by_name.pop(name).remove()

    def clear(self) -> None:
        """Take everything away, the last first."""
        for folder in self._labels:
            self.labels(folder)
        for name in list(self._by_name)[::-1]:
            self.remove(name)


def outline_of(corners: Floats | None) -> Floats:
    """Return the lines (k, 2, 3) around a shape of k corners (k, 3), or none."""
    return NO_LINES if corners is None else np.stack([corners, np.roll(corners, -1, axis=0)], axis=1)


def quaternion(rotation: Floats) -> tuple[float, float, float, float]:
    """Return the quaternion (w, x, y, z) of a rotation matrix."""
    wxyz = viser.transforms.SO3.from_matrix(rotation).wxyz
    return (float(wxyz[0]), float(wxyz[1]), float(wxyz[2]), float(wxyz[3]))


def _linear(colors: Colors) -> Colors:
    """Return the intensities that the browser turns back into these colours: for lines alone it takes them as light."""
    shares = colors / 255.0
    light = np.where(shares <= 0.04045, shares / 12.92, ((shares + 0.055) / 1.055) ** 2.4)
    return np.rint(255.0 * light).astype(np.uint8)
