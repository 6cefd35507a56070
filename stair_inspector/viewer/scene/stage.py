"""An inspector's scene: what of an inspection is drawn, as nodes of viser."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial, wraps
from typing import Literal, TypeVar, cast

import numpy as np
import viser

from stair_inspector.files.palettes import Palette, Rgb
from stair_inspector.geometry.arrays import Colors, Floats
from stair_inspector.pictures.display import Display
from stair_inspector.pictures.segmentation import SegmentedScene, extent_of
from stair_inspector.viewer.scene.dimensions import Dimensions
from stair_inspector.viewer.scene.measurements import MeasureDrawing
from stair_inspector.viewer.scene.nodes import NO_LINES, NodeLabel, Nodes, outline_of
from stair_inspector.viewer.scene.step_marks import StepMark, mark_color

Mode = Literal["Raw", "Segmented", "Side by side", "Swipe"]

MODES: tuple[Mode, ...] = ("Raw", "Segmented", "Side by side", "Swipe")
_EDGE_PIXELS = 3.0
_NOSING_PIXELS = 6.0
_ARROW_PIXELS = 2.0
_MARK_PIXELS = 5.0
HIGHLIGHT: Rgb = (0, 214, 230)
MEASURED: Rgb = (230, 60, 140)
PINNED: Rgb = (176, 96, 16)
"""Of what an inspector measured by hand, of the paper's edges beside the survey's, and of pins: none of the hues of
steps, edges and measuring lines."""
RAW, SEGMENTS = "/stair/raw", "/stair/segments"
"""What is seen of a scan in one mode and not in the other, with all below."""
_REGION = "/stair/region"
_FINDINGS = "/stair/findings"
_CLOUDS = ("/stair/segments/cloud", "/stair/segments/centres", "/stair/segments/selected")
_PAPER_EDGES = "/stair/segments/paper_edges"
_LINES = ("/stair/segments/edges", "/stair/segments/nosings", "/stair/segments/outside", _PAPER_EDGES)
"""What a section stands in for: the segmentation's points, and the lines of all steps."""
_PICKED_POINTS = 2.6
"""Diameter of a picked point, in those of the scan."""
_POINT_FACTORS = {
    RAW: 1.0,
    "/stair/segments/cloud": 1.0,
    "/stair/segments/centres": 1.6,
    "/stair/segments/selected": 1.7,
    "/stair/section/cloud": 1.0,
    "/stair/measured/points": _PICKED_POINTS,
    "/stair/findings/points": _PICKED_POINTS,
}
"""Diameter of the points of each cloud, in those of the scan."""

_Draw = TypeVar("_Draw", bound=Callable[..., None])


def _counted(draw: _Draw) -> _Draw:
    """Count what draws, after it has drawn."""

    @wraps(draw)
    def counted(stage: "Stage", *values: object, **named: object) -> None:
        try:
            draw(stage, *values, **named)
        finally:
            stage.n_drawn += 1

    return cast(_Draw, counted)


@dataclass
class Stage:
    """The nodes of one inspector's scene.

    Everything hangs below ``/stair``, whose rotation stands the staircase upright, so that a camera always has z up.
    The raw cloud and the segmentation share that frame; side by side the page draws them in two halves, with a swipe on
    the two sides of a bar.

    ``mode`` and ``point_size_m`` are what the inspector has chosen, also while a picture is taken in another mode
    (:meth:`lend`) or with larger points (:meth:`magnify`). ``n_drawn`` grows with everything that is drawn: as long as
    it stays, the scene is the same. ``before_clear`` are called before the scene is emptied: who has drawn into it
    takes that away.
    """

    client: viser.ClientHandle
    rotation: Floats = field(default_factory=lambda: np.eye(3))
    extent: Floats = field(default_factory=lambda: np.zeros((8, 3)))
    mode: Mode = "Segmented"
    point_size_m: float = 0.0
    n_drawn: int = 0
    before_clear: list[Callable[[], None]] = field(default_factory=list)
    _raw_colors: Colors | None = None
    _lent: Mode | None = None
    _magnified: float = 1.0
    _per_step: list[tuple[viser.MeshHandle, viser.LabelHandle]] = field(default_factory=list)
    _step_names: tuple[str, ...] = ()
    _is_cut: bool = False
    _cut_steps: frozenset[str] = frozenset()
    _covered_steps: frozenset[str] = frozenset()

    def __post_init__(self) -> None:
        self._nodes = Nodes(self.client.scene)

    @_counted
    def show_scan(self, display: Display, rotation: Floats, point_size_m: float) -> None:
        """Replace everything by a scan, standing upright."""
        self.clear()
        self.rotation, self.point_size_m = rotation, point_size_m
        self.extent = extent_of(display.points @ rotation.T)
        self._nodes.frame("/stair", rotation)
        self._nodes.frame(SEGMENTS)
        # The box of the part that counts stands in the one, marks of findings in the other.
        self._nodes.frame(_REGION)
        self._nodes.frame(_FINDINGS)
        self._points(RAW, display.points, display.colors, is_visible=self._mode_shown != "Segmented")
        self._points("/stair/segments/cloud", display.points, display.colors)
        self._raw_colors = display.colors
        self._show_mode()

    @_counted
    def color_raw(self, colors: Colors) -> None:
        """Give the points of the raw cloud (m, 3) other colours; those that it has are not sent again."""
        if colors is not self._raw_colors:
            self._nodes[RAW].colors = self._raw_colors = colors

    @_counted
    def show_drawing(self, drawing: SegmentedScene, palette: Palette, on_pick: Callable[[int], None]) -> None:
        """Replace the segmentation; ``on_pick(step_id)`` is called when a step's plate is clicked."""
        self._nodes["/stair/segments/cloud"].colors = drawing.colors
        self._lines("/stair/segments/edges", drawing.edges, drawing.edge_colors)
        self._lines("/stair/segments/nosings", drawing.nosings, palette.front_edge, _NOSING_PIXELS)
        self._points("/stair/segments/centres", drawing.centres, palette.centre)
        if self._step_names != drawing.labels:
            self._add_steps(drawing, on_pick)
        for (plate, label), corners in zip(self._per_step, drawing.corners, strict=True):
            plate.vertices = corners.astype(np.float32)
            label.position = _beside(corners)
        rejected: list[NodeLabel] = [(name, name, place, "center-center") for name, place in drawing.rejected]
        self._nodes.labels("/stair/segments/rejected", rejected)

    @_counted
    def highlight(self, points: Floats, corners: Floats | None, color: Rgb = HIGHLIGHT) -> None:
        """Draw points (k, 3) and the outline of a plate (4, 3) on top of the segmentation, or nothing."""
        self._points("/stair/segments/selected", points, color)
        self._lines("/stair/segments/outline", outline_of(corners), HIGHLIGHT, 2.0 * _EDGE_PIXELS)

    @_counted
    def show_dimensions(self, step_id: int | None, dimensions: Dimensions | None, palette: Palette) -> None:
        """Draw the measuring lines, dimension arrows and labels of a step, or nothing."""
        dimensions = dimensions or Dimensions(NO_LINES, NO_LINES, ())
        self._lines("/stair/segments/measuring", dimensions.measuring, palette.measure)
        self._lines("/stair/segments/dimensions", dimensions.arrows, palette.centre, _ARROW_PIXELS)
        labels = [(each.text.split(" ")[0], each.text, each.position, each.anchor) for each in dimensions.labels]
        self._nodes.labels("/stair/segments/dimension_labels", labels)
        # The numbers of the step and of its neighbours stand where the labels run.
        self._covered_steps = frozenset()
        if step_id is not None and labels:
            self._covered_steps = frozenset(str(number) for number in (step_id - 1, step_id, step_id + 1))
        self._show_numbers()

    @_counted
    def show_marks(self, marks: Mapping[int, StepMark], palette: Palette) -> None:
        """Outline the treads of steps that are outside a limit, and put their sign beside their number."""
        outlines, colors = [], []
        lift_m = 2.0 * self._point_size_of(RAW) * self.rotation[2]
        for (plate, label), name in zip(self._per_step, self._step_names, strict=True):
            mark = marks.get(int(name))
            label.text = name if mark is None else f"{name} {mark.sign}"
            if mark is not None:
                corners = np.asarray(plate.vertices, dtype=np.float64) + lift_m
                outlines.append(outline_of(corners))
                colors += [mark_color(mark.tone, palette)] * len(corners)
        self._lines(
            "/stair/segments/outside",
            np.concatenate([NO_LINES, *outlines]),
            np.array(colors, dtype=np.uint8).reshape(-1, 3),
            _MARK_PIXELS,
        )

    @_counted
    def show_paper_edges(self, lines: Floats, palette: Palette) -> None:
        """Draw the edges (k, 2, 3) that the paper places beside those of the survey, or none."""
        self._lines(_PAPER_EDGES, lines, palette.paper_edge, _MARK_PIXELS)

    @_counted
    def show_section(
        self, points: Floats, colors: Colors, outline: Floats | None, step_ids: Iterable[int] = ()
    ) -> None:
        """Show a section instead of the clouds, or, with no outline, the clouds again.

        The edges of all steps would lie over it, so they go with the clouds.

        Parameters
        ----------
        points, colors : (k, 3)
            Of the section, local; perhaps none at all.
        outline : (4, 3), optional
            Corners of the section, local.
        step_ids : iterable of int
            Steps that it cuts, whose numbers stay.
        """
        self._is_cut = outline is not None
        self._cut_steps = frozenset(map(str, step_ids))
        self._points("/stair/section/cloud", points if self._is_cut else points[:0], colors)
        self._lines("/stair/section/outline", outline_of(outline), HIGHLIGHT, _ARROW_PIXELS)
        self._show_mode()

    @_counted
    def show_measurements(self, drawing: MeasureDrawing | None) -> None:
        """Draw what was measured by hand, or nothing; it stays when the result changes."""
        drawing = drawing or MeasureDrawing(NO_LINES, NO_LINES, np.zeros((0, 3)), ())
        self._lines("/stair/measured/lines", drawing.lines, MEASURED)
        self._lines("/stair/measured/legs", drawing.legs, MEASURED, _ARROW_PIXELS / 2.0)
        self._points("/stair/measured/points", drawing.points, MEASURED)
        self._nodes.labels("/stair/measured/labels", drawing.labels)

    @_counted
    def show_findings(self, points: Floats, labels: Sequence[NodeLabel]) -> None:
        """Draw pins (k, 3), local, and the marks of findings with their words; none of it is seen in pictures."""
        self._points("/stair/findings/points", points, PINNED)
        self._nodes.labels("/stair/findings/labels", labels)

    @_counted
    def set_mode(self, mode: Mode) -> None:
        """Show the raw cloud, the segmentation, or both; a section stands in for both clouds."""
        self.mode = mode
        self._show_mode()

    @_counted
    def lend(self, mode: Mode | None) -> None:
        """Show a mode for a picture, without what has no part in pictures; None shows again what is chosen."""
        self._lent = mode
        self._show_mode()

    @_counted
    def set_point_size(self, size_m: float) -> None:
        """Set the diameter of the points, metres."""
        self.point_size_m = size_m
        self._size_points()

    @_counted
    def magnify(self, factor: float) -> None:
        """Draw points so many times as large as chosen, for a picture; 1 draws them again as chosen."""
        self._magnified = factor
        self._size_points()

    @_counted
    def clear(self) -> None:
        """Remove everything."""
        for take_away in self.before_clear:
            take_away()
        self._remove_steps()
        self._is_cut = False
        self._nodes.clear()

    @property
    def _mode_shown(self) -> Mode:
        return self._lent or self.mode

    def _show_mode(self) -> None:
        if "/stair" not in self._nodes:
            return
        mode = self._mode_shown
        self._nodes[RAW].visible = mode != "Segmented" and not self._is_cut
        for name in (*_CLOUDS, *_LINES):
            if name in self._nodes:
                self._nodes[name].visible = not self._is_cut
        self._show_numbers()
        for name in (_REGION, _FINDINGS):
            self._nodes[name].visible = self._lent is None
        self._nodes[SEGMENTS].visible = mode != "Raw"

    def _point_size_of(self, name: str) -> float:
        return _POINT_FACTORS[name] * self.point_size_m * self._magnified

    def _size_points(self) -> None:
        for name in _POINT_FACTORS:
            if name in self._nodes:
                self._nodes[name].point_size = self._point_size_of(name)

    def _show_numbers(self) -> None:
        for (_, label), name in zip(self._per_step, self._step_names, strict=True):
            label.visible = name not in self._covered_steps and (not self._is_cut or name in self._cut_steps)

    def _add_steps(self, drawing: SegmentedScene, on_pick: Callable[[int], None]) -> None:
        self._remove_steps()
        self._step_names = drawing.labels
        for corners, text in zip(drawing.corners, drawing.labels, strict=True):
            # All but invisible: it is there to be clicked.
            plate = self.client.scene.add_mesh_simple(
                f"/stair/segments/steps/{text}",
                corners.astype(np.float32),
                np.array([[0, 1, 2], [0, 2, 3]]),
                color=HIGHLIGHT,
                opacity=0.02,
                side="double",
                cast_shadow=False,
                receive_shadow=False,
            )
            plate.on_click(partial(_pick, on_pick, int(text)))
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
        self._per_step, self._step_names = [], ()

    def _lines(self, name: str, segments: Floats, colors: Colors | Rgb, pixels: float = _EDGE_PIXELS) -> None:
        self._nodes.lines(name, segments, colors, pixels, is_visible=not (self._is_cut and name in _LINES))

    def _points(self, name: str, points: Floats, colors: Colors | Rgb, *, is_visible: bool = True) -> None:
        is_visible = is_visible and not (self._is_cut and name in _CLOUDS)
        self._nodes.points(name, points, colors, self._point_size_of(name), is_visible=is_visible)


def _pick(on_pick: Callable[[int], None], step_id: int, _: object) -> None:
    on_pick(step_id)


def _beside(corners: Floats) -> Floats:
    """Return the place of a step's label: to the right of its front edge, where it covers no tread."""
    across = corners[1] - corners[0]
    length = float(np.linalg.norm(across))
    place: Floats = corners[1] + (0.12 / length) * across if length > 0.0 else corners[1]
    return place
