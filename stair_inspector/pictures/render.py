"""Views of a staircase without a display or a browser: raw and segmented as in the paper's figures, all standard views.

``render_view(...)`` is one of them, of any size; those of a report are in :mod:`stair_inspector.pictures.report_views`.
"""

import io
import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np
from PIL import Image, ImageDraw

from stair_inspector.content.segmented_points import labels_at
from stair_inspector.files.palettes import Palette, Rgb, read_palette
from stair_inspector.geometry.arrays import Bools, Colors, Floats
from stair_inspector.model import Inspection, Scan
from stair_inspector.pictures.cameras import Pose, View
from stair_inspector.pictures.coloring import Coloring, ColorMode, color_points
from stair_inspector.pictures.display import Display, choose_display
from stair_inspector.pictures.lettering import Lettering
from stair_inspector.pictures.picture import Caption, Scale, picture_png, scale_of
from stair_inspector.pictures.picture_camera import PictureCamera, camera_of
from stair_inspector.pictures.segmentation import SegmentedScene, draw, view_from_local
from stair_inspector.pictures.splat import Dots, draw_dots
from stair_inspector.units import Unit

Subject = Literal["Raw", "Segmented", "Residuals"]

MOST_POINTS = 1_000_000
"""Points that are drawn; more would not be seen at these sizes."""
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
_MOST_POINTS_SMALL = 200_000
_SMALL_TEXT = 2.0
"""Letters of a small picture, times those of one as wide as a page."""
_THUMBNAIL_POINTS = 30_000
_THUMBNAIL_FINER = 6
"""Pixels that are drawn for one of a small picture, both ways."""
_INK: Rgb = (20, 22, 26)


def render_view(
    scan: Scan,
    inspection: Inspection,
    view: View,
    subject: Subject,
    size_px: tuple[int, int | None],
    date: str,
    *,
    title: str = "",
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
    palette = read_palette("page")
    display = display or choose_display(scan, MOST_POINTS)
    turn = view_from_local(inspection)
    shown = _without_cover(inspection, display, view, turn)
    camera = camera_of(inspection, display, view, turn, size_px)
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


def render_poses(
    scan: Scan, inspection: Inspection, poses: Sequence[Pose], fov_rad: float, size_px: tuple[int, int]
) -> Iterator[bytes]:
    """Yield a small picture of the coloured steps from each camera, as PNG without words.

    Parameters
    ----------
    scan, inspection
        The same scan that was inspected.
    poses : sequence of Pose
        Cameras in the coordinates of the view.
    fov_rad : float
        Their upright angle of view.
    size_px : (int, int)
        Width and height.
    """
    palette = read_palette("page")
    display = choose_display(scan, _MOST_POINTS_SMALL)
    turn = view_from_local(inspection)
    coloring = _coloring_of(inspection, display, "Segmented", palette, has_edges=True)
    drawing = draw(inspection, display, scan.points, palette, colors=coloring.colors)
    for pose in poses:
        pixels_per_m = scale_of(pose, fov_rad, size_px[1], "mm").pixels_per_m
        camera = PictureCamera(pose, *size_px, pixels_per_m, is_parallel=False)
        pixels = _pixels(display, drawing, camera, turn, palette, has_lines=True)
        stream = io.BytesIO()
        Image.fromarray(_numbered(pixels, inspection, camera, turn, _SMALL_TEXT)).save(stream, "PNG")
        yield stream.getvalue()


def render_thumbnail(scan: Scan, inspection: Inspection, size_px: tuple[int, int]) -> bytes:
    """Return a small picture of a scan as PNG, with the steps that were found, for lists; of twice as many pixels."""
    palette = read_palette("page")
    display = choose_display(scan, _THUMBNAIL_POINTS)
    turn = view_from_local(inspection)
    width, height = size_px
    camera = camera_of(inspection, display, "Home", turn, (_THUMBNAIL_FINER * width, _THUMBNAIL_FINER * height))
    subject: Subject = "Segmented" if inspection.steps else "Raw"
    coloring = _coloring_of(inspection, display, subject, palette, has_edges=False)
    drawing = draw(inspection, display, scan.points, palette, colors=coloring.colors)
    pixels = Image.fromarray(_pixels(display, drawing, camera, turn, palette, has_lines=False))
    stream = io.BytesIO()
    # Few colours are enough for so small a picture, and are a few kilobytes.
    pixels.resize((2 * width, 2 * height), Image.Resampling.BOX).quantize(64).save(stream, "PNG", optimize=True)
    return stream.getvalue()


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
    shown = tuple(entry for entry in coloring.legend.entries if entry[0] != palette.rejected)
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


def _pixels(
    display: Display, drawing: SegmentedScene, camera: PictureCamera, turn: Floats, palette: Palette, *, has_lines: bool
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


def _lines(segments: Floats, colors: Colors, camera: PictureCamera, radius_px: float) -> Dots:
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


def _numbered(pixels: Colors, inspection: Inspection, camera: PictureCamera, turn: Floats, text_scale: float) -> Colors:
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
