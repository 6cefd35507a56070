"""Views of a staircase without a display or a browser: raw and segmented as in the paper's figures, all standard views.

``report_views(scan, inspection, date)`` are the report's pictures; ``render_view(...)`` is one of them of any size.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from PIL import Image, ImageDraw

from stair_inspector.files.palettes import Palette, Rgb, read_palette
from stair_inspector.geometry.arrays import Bools, Colors, Floats
from stair_inspector.model import Inspection, Scan
from stair_inspector.pictures.cameras import FOV_RAD, ORTHO_FOV_RAD, Pose, View, frame_view
from stair_inspector.pictures.coloring import Coloring, ColorMode, color_points, labels_at
from stair_inspector.pictures.display import REJECTED_COLOR, Display, choose_display
from stair_inspector.pictures.lettering import Lettering
from stair_inspector.pictures.picture import Caption, Scale, check_size, picture_png, scale_of
from stair_inspector.pictures.residual_sheets import residual_sheets
from stair_inspector.pictures.segmentation import SegmentedScene, draw, extent_of, is_left_hidden, view_from_local
from stair_inspector.pictures.splat import Dots, draw_dots
from stair_inspector.units import Unit

Subject = Literal["Raw", "Segmented", "Residuals"]

MOST_POINTS = 1_000_000
"""Points that are drawn; more would not be seen at these sizes."""
REPORT_WIDTH = 1500
"""Pixels of a picture across a page: 220 for each inch of paper."""
_AROUND_M = 0.45
"""How much of the stair's surroundings is framed, to every side."""
_OVER_SPACING = 0.95
"""Radius of a point as a share of the distance between points: discs overlap, so that a surface is closed."""
_LEAST_RADIUS_PX = 0.6
_LINE_PX = 1.5
_NOSING_PX = 2.0
_SHADE_SHARE = 0.012
"""Depth difference that is fully dark, as a share of the height of what is seen."""
_HEADROOM_M = 1.0
"""Seen from above, what lies higher than this over the steps is left out: ceilings and what hangs from them."""
_BESIDE_M = 0.05
_NUMBER_SHARE = 1.0 / 62.0
"""Height of a step's number, as a share of the picture's width."""
_WHITE = 255
_TRIM_SHARE = 0.015
_LOWEST_ASPECT, _HIGHEST_ASPECT = 0.8, 3.2
_INK: Rgb = (20, 22, 26)
_RESIDUALS = "residuals"
_RESIDUAL_WORDS = "Residuals: distance of every step's surface from its own plane"


@dataclass(frozen=True, slots=True)
class RenderedView:
    """A picture for a report: PNG, what it shows in words, and the part of the page's width that it deserves."""

    key: str
    caption: str
    png: bytes
    share: float


@dataclass(frozen=True, slots=True, eq=False)
class _Camera:
    """A camera whose picture has whole pixels; ``is_parallel`` for a view without perspective, true to scale.

    Without ``has_edges`` the treads are seen end on, and lines would hide them.
    """

    pose: Pose
    width: int
    height: int
    pixels_per_m: float
    is_parallel: bool
    has_edges: bool = True

    def look(self, points: Floats) -> tuple[Floats, Floats, Floats]:
        """Return where points (n, 3) of the view lie: pixels (n, 2), depths (n,) and pixels per metre (n,)."""
        backwards = self.pose.position - self.pose.look_at
        distance = float(np.linalg.norm(backwards))
        backwards = backwards / distance
        right = np.cross(self.pose.up, backwards)
        right /= np.linalg.norm(right)
        above = np.cross(backwards, right)
        offset = points - self.pose.look_at
        depth = distance - offset @ backwards
        # What lies behind the eye has no place in the picture.
        scale = np.full(len(points), self.pixels_per_m)
        if not self.is_parallel:
            ahead = np.where(depth > 1e-3, depth, np.nan)
            scale = self.pixels_per_m * distance / ahead
        x = self.width / 2.0 + (offset @ right) * scale
        y = self.height / 2.0 - (offset @ above) * scale
        return np.column_stack([x, y]), np.where(np.isfinite(scale), depth, np.nan), scale


def report_views(
    scan: Scan,
    inspection: Inspection,
    date: str,
    *,
    title: str = "",
    palette: Palette | None = None,
    unit: Unit = "mm",
    width: int = REPORT_WIDTH,
) -> tuple[RenderedView, ...]:
    """Return the views of a report: raw and segmented beside each other, front, top, side, and the residuals.

    Without a staircase there is the raw scan alone.

    Parameters
    ----------
    scan, inspection
        The same scan that was inspected.
    date, title : str
        Burned into every picture, beside the scan's name.
    palette : Palette, optional
        By default that of the page.
    unit : {"mm", "in"}
        Of the scale bar.
    width : int
        Of a picture as wide as the page, pixels.
    """
    wanted: list[tuple[Subject, View, float, str]] = [("Raw", "Home", 0.5, "the scan as it came, in its own colours")]
    if inspection.steps:
        wanted += [
            ("Segmented", "Home", 0.5, "floor, treads in turn from bottom to top, and the edges that were found"),
            ("Segmented", "Front", 0.5, "seen by who climbs, without perspective"),
            ("Segmented", "Top", 0.5, "from above, without perspective; what lies higher than the stair is left out"),
            ("Segmented", "Side", 1.0, "from the side, without perspective"),
        ]
    display = choose_display(scan, MOST_POINTS)
    views = tuple(
        RenderedView(
            key=f"{subject}_{view}".lower(),
            caption=f"{subject}, {view.lower()} view: {words}",
            png=render_view(
                scan,
                inspection,
                view,
                subject,
                (round(width * share), None),
                date,
                title=title,
                palette=palette,
                unit=unit,
                display=display,
                text_scale=1.0 / share,
            ),
            share=share,
        )
        for subject, view, share, words in wanted
    )
    return views + residual_views(scan, inspection, date, title=title, unit=unit, width=width)


def residual_views(
    scan: Scan, inspection: Inspection, date: str, *, title: str = "", unit: Unit = "mm", width: int = REPORT_WIDTH
) -> tuple[RenderedView, ...]:
    """Return the maps of the residuals of every tread, in as many pictures as they need; see :func:`report_views`."""
    sheets = residual_sheets(scan, inspection, date, title=title, unit=unit, width=width)
    return tuple(
        RenderedView(f"{_RESIDUALS}_{number}", f"{_RESIDUAL_WORDS} ({number} of {len(sheets)})", sheet, 1.0)
        if len(sheets) > 1
        else RenderedView(_RESIDUALS, _RESIDUAL_WORDS, sheet, 1.0)
        for number, sheet in enumerate(sheets, 1)
    )


def is_residual_map(view: RenderedView) -> bool:
    """Return whether a picture is one of :func:`residual_views`, of treads and not of a scene."""
    return view.key.startswith(_RESIDUALS)


def render_view(
    scan: Scan,
    inspection: Inspection,
    view: View,
    subject: Subject,
    size_px: tuple[int, int | None],
    date: str,
    *,
    title: str = "",
    palette: Palette | None = None,
    unit: Unit = "mm",
    display: Display | None = None,
    text_scale: float = 1.0,
) -> bytes:
    """Return a view as PNG, with title, scan, view, date, legend and scale bar burned in.

    Parameters
    ----------
    scan, inspection
        The same scan that was inspected; it may have no step.
    view : View
        One of the page's standard views; all but "Home" are without perspective, so that the scale holds everywhere.
    subject : {"Raw", "Segmented", "Residuals"}
        The scan's own colours, or heights where it has none; steps with their edges, nosings and numbers; or distances
        from the steps' planes.
    size_px : (int, int or None)
        Width and height of the view itself; None for the height that suits what is seen.
    date, title : str
        Burned in.
    display : Display, optional
        The points that are drawn, where they have been chosen before.
    text_scale : float
        How much larger letters are than in a picture as wide as a page.

    Raises
    ------
    ConfigError
        The size is not one of a picture.
    """
    palette = palette or read_palette("page")
    display = display or choose_display(scan, MOST_POINTS)
    turn = view_from_local(inspection)
    shown = _without_cover(inspection, display, view, turn)
    camera = _camera_of(inspection, display, view, turn, size_px)
    coloring = _coloring_of(inspection, shown, subject, palette, has_edges=camera.has_edges)
    drawing = draw(inspection, shown, scan.points, palette, colors=coloring.colors)
    pixels = _pixels(shown, drawing, camera, turn, palette, has_lines=subject != "Raw")
    if subject != "Raw":
        pixels = _numbered(pixels, inspection, camera, turn, text_scale)
    pixels = pixels if size_px[1] is not None else _trimmed(pixels)
    words = f"{subject.lower()}, {view.lower()} view" + (", no perspective" if camera.is_parallel else "")
    caption = Caption(title, inspection.scan.name, words, date, "")
    scale = Scale(camera.pixels_per_m, unit, is_everywhere=camera.is_parallel)
    return picture_png(pixels, caption, coloring.legend, scale, "White", text_scale)


def _coloring_of(
    inspection: Inspection, display: Display, subject: Subject, palette: Palette, *, has_edges: bool
) -> Coloring:
    has_own = bool(len(display.colors)) and bool((display.colors != display.colors[0]).any())
    raw: ColorMode = "Original" if has_own else "Height"
    modes: dict[Subject, ColorMode] = {"Raw": raw, "Segmented": "Step", "Residuals": "Residual"}
    coloring = color_points(modes[subject], inspection, display, palette)
    if subject != "Segmented":
        return coloring
    # Of what is drawn here and nothing else.
    shown = tuple(entry for entry in coloring.legend.entries if entry[0] != REJECTED_COLOR)
    edges = ((palette.front_edge, "nosings"), (palette.back_edge, "back edges"), (palette.side_edge, "side edges"))
    return replace(coloring, legend=replace(coloring.legend, entries=(*shown, *(edges if has_edges else ()))))


def _without_cover(inspection: Inspection, display: Display, view: View, turn: Floats) -> Display:
    """Return the points without those of no step that would stand between the eye and the stair."""
    if not inspection.steps or view not in ("Top", "Side"):
        return display
    corners = np.stack([step.corners for step in inspection.steps]) @ turn.T
    places = display.points @ turn.T
    if view == "Side":
        is_cover = places[:, 0] > corners[:, :, 0].max() + _BESIDE_M
    else:
        is_cover = places[:, 2] > _height_below(places, corners) + _HEADROOM_M
    is_loose = labels_at(inspection, display.point_ids) < 0
    return _chosen(display, ~(is_cover & is_loose))


def _height_below(places: Floats, corners: Floats) -> Floats:
    """Return the height (n,) of the step whose middle is nearest in plan to each of the places (n, 3)."""
    best = np.full(len(places), np.inf)
    height = np.zeros(len(places))
    for middle in corners.mean(axis=1):
        away = np.hypot(places[:, 0] - middle[0], places[:, 1] - middle[1])
        is_nearer = away < best
        best[is_nearer] = away[is_nearer]
        height[is_nearer] = middle[2]
    return height


def _chosen(display: Display, is_kept: Bools) -> Display:
    return replace(
        display,
        point_ids=display.point_ids[is_kept],
        points=display.points[is_kept],
        colors=display.colors[is_kept],
    )


def _camera_of(
    inspection: Inspection, display: Display, view: View, turn: Floats, size_px: tuple[int, int | None]
) -> _Camera:
    corners = _framed(inspection, display, turn)
    is_parallel = view != "Home"
    fov_rad = ORTHO_FOV_RAD if is_parallel else FOV_RAD
    pitches = [flight.pitch_deg.value for flight in inspection.flights if flight.pitch_deg is not None]

    def pose_for(aspect: float) -> Pose:
        hidden = view == "Home" and is_left_hidden(inspection, display)
        pitch_deg = pitches[0] if pitches else 0.0
        return frame_view(view, corners, aspect, np.eye(3), fov_rad, is_from_right=hidden, pitch_deg=pitch_deg)

    width, height = size_px
    if height is None:
        # As tall as what is seen: no paper is wasted.
        trial = _Camera(pose_for(1.0), 1000, 1000, _pixels_per_m(pose_for(1.0), fov_rad, 1000), is_parallel)
        seen = np.ptp(trial.look(corners)[0], axis=0)
        aspect = float(np.clip(seen[0] / max(seen[1], 1e-9), _LOWEST_ASPECT, _HIGHEST_ASPECT))
        height = round(width / aspect)
    width, height = check_size(width, height)
    pose = pose_for(width / height)
    return _Camera(pose, width, height, _pixels_per_m(pose, fov_rad, height), is_parallel, view != "Side")


def _pixels_per_m(pose: Pose, fov_rad: float, height: int) -> float:
    return scale_of(pose, fov_rad, height, "mm").pixels_per_m


def _framed(inspection: Inspection, display: Display, turn: Floats) -> Floats:
    """Return the corners (8, 3) of the box that must be seen: the stair and a little around it, or all of the scan."""
    whole = extent_of(display.points @ turn.T)
    if not inspection.steps:
        return whole
    stair = np.concatenate([step.corners for step in inspection.steps]) @ turn.T
    low = np.maximum(stair.min(axis=0) - _AROUND_M, whole.min(axis=0))
    high = np.minimum(stair.max(axis=0) + _AROUND_M, whole.max(axis=0))
    # A scan that ends at the stair does not cut it.
    low, high = np.minimum(low, stair.min(axis=0)), np.maximum(high, stair.max(axis=0))
    return np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])])


def _pixels(
    display: Display, drawing: SegmentedScene, camera: _Camera, turn: Floats, palette: Palette, *, has_lines: bool
) -> Colors:
    places, depths, scales = camera.look(display.points @ turn.T)
    radii = np.maximum(_OVER_SPACING * display.spacing_m * np.nan_to_num(scales), _LEAST_RADIUS_PX)
    dots = Dots(places, depths, drawing.colors, radii)
    if has_lines and camera.has_edges:
        nosings = np.tile(np.array(palette.front_edge, dtype=np.uint8), (len(drawing.nosings), 1))
        dots = dots.joined(_lines(drawing.edges @ turn.T, drawing.edge_colors, camera, _LINE_PX))
        dots = dots.joined(_lines(drawing.nosings @ turn.T, nosings, camera, _NOSING_PX))
    shade_m = _SHADE_SHARE * camera.height / camera.pixels_per_m
    return draw_dots(dots, camera.width, camera.height, shade_m=shade_m)


def _trimmed(pixels: Colors) -> Colors:
    """Return the picture without empty rows above and below: no paper is wasted."""
    rows = np.flatnonzero((pixels < _WHITE).any(axis=(1, 2)))
    if not len(rows):
        return pixels
    margin = round(_TRIM_SHARE * pixels.shape[1])
    return pixels[max(int(rows[0]) - margin, 0) : int(rows[-1]) + margin + 1]


def _lines(segments: Floats, colors: Colors, camera: _Camera, radius_px: float) -> Dots:
    """Return lines (k, 2, 3) as rows of dots so near to each other that they are lines in this picture."""
    places, depths, tints = [np.zeros((0, 2))], [np.zeros(0)], [np.zeros((0, 3), dtype=np.uint8)]
    for ends, color in zip(segments, colors, strict=True):
        pixels, _, _ = camera.look(ends)
        length = float(np.nan_to_num(np.linalg.norm(pixels[1] - pixels[0])))
        count = int(min(max(2.0, 2.0 * length), 20_000.0))
        shares = np.linspace(0.0, 1.0, count)[:, None]
        at, depth, _ = camera.look(ends[0] + shares * (ends[1] - ends[0]))
        places.append(at)
        depths.append(depth)
        tints.append(np.tile(color, (count, 1)))
    depth = np.concatenate(depths)
    return Dots(np.concatenate(places), depth, np.concatenate(tints), np.full(len(depth), radius_px))


def _numbered(pixels: Colors, inspection: Inspection, camera: _Camera, turn: Floats, text_scale: float) -> Colors:
    """Return the picture with the steps' numbers beside their front edges, as many as have room."""
    image = Image.fromarray(pixels)
    size = max(11, round(camera.width * _NUMBER_SHARE * text_scale))
    pen = Lettering(ImageDraw.Draw(image), size, _INK, outline=max(1, size // 6))
    taken: list[tuple[float, float]] = []
    for step in inspection.steps:
        x, y = _beside(camera.look(step.corners @ turn.T)[0], size)
        words = str(step.step_id)
        if not math.isfinite(x + y) or not _is_free(x, y, taken, 1.15 * size):
            continue
        taken.append((x, y))
        pen.write(x - pen.width(words) / 2.0, y - 0.62 * size, words)
    return np.asarray(image, dtype=np.uint8)


def _beside(corners: Floats, size: float) -> tuple[float, float]:
    """Return where the number of a step goes: beyond the right end of its front edge, or over a tread seen end on."""
    across = corners[1] - corners[0]
    length = float(np.linalg.norm(across))
    if length <= size / 2.0:
        x, y = corners.mean(axis=0)
        return float(x), float(y) - 0.9 * size
    x, y = corners[1] + 0.9 * size * across / length
    return float(x), float(y)


def _is_free(x: float, y: float, taken: Sequence[tuple[float, float]], apart: float) -> bool:
    return all(abs(x - other[0]) > apart or abs(y - other[1]) > apart for other in taken)
