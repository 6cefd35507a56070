"""Sheets of residual maps: the surface of every step from above, coloured by its distance from its own plane."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from PIL import Image, ImageDraw

from stair_inspector.files.palettes import Rgb
from stair_inspector.geometry.arrays import Colors
from stair_inspector.model import Inspection, Scan, Step
from stair_inspector.pictures.coloring import color_residuals, residual_legend, residual_limit
from stair_inspector.pictures.lettering import Lettering
from stair_inspector.pictures.picture import Caption, Scale, picture_png
from stair_inspector.pictures.residuals import ResidualMap, residual_map
from stair_inspector.units import Unit

_COLUMNS_OF_FEW, _COLUMNS, _FEW = 2, 3, 8
_GAP_SHARE = 0.025
_TEXT_SHARE = 1.0 / 68.0
_TALLEST = 1.15
"""Height of a sheet at most, as a share of its width: legend and title have room on a page too."""
_INK: Rgb = (24, 26, 30)
_NO_POINTS: Rgb = (255, 255, 255)
_NOSING: Rgb = (24, 26, 30)


@dataclass(frozen=True, slots=True, eq=False)
class _Tile:
    """One step's map as it is drawn: ``pixels`` (h, w, 3)."""

    words: str
    pixels: Colors


def residual_sheets(
    scan: Scan, inspection: Inspection, date: str, *, title: str = "", unit: Unit = "mm", width: int = 1500
) -> tuple[bytes, ...]:
    """Return the maps of all steps as PNG pictures with one scale of colours and lengths, treads before landings.

    Parameters
    ----------
    scan, inspection
        The same scan that was inspected; a step without a plane has no map.
    date, title : str
        Burned in, beside the scan's name.
    unit : {"mm", "in"}
        Of the scale bar; the colours are in millimetres.
    width : int
        Of a picture, pixels.
    """
    maps = [(step, residual_map(scan, inspection, step)) for step in inspection.steps]
    known = [(step, found) for step, found in maps if found is not None]
    if not known:
        return ()
    limit_m = residual_limit(np.concatenate([found.residuals_m.ravel() for _, found in known]))
    n_columns = _COLUMNS_OF_FEW if len(known) <= _FEW else _COLUMNS
    gap = round(_GAP_SHARE * width)
    room = (width - (n_columns + 1) * gap) // n_columns
    pixels_per_m = room / max(found.residuals_m.shape[1] * found.cell_m for _, found in known)
    tiles = [_tile(step, found, limit_m, pixels_per_m) for step, found in known]
    # Landings are deep: in rows of their own they leave no holes between the treads.
    rows = [
        group[start : start + n_columns]
        for group in (
            [tile for tile, (step, _) in zip(tiles, known, strict=True) if step.kind == "tread"],
            [tile for tile, (step, _) in zip(tiles, known, strict=True) if step.kind != "tread"],
        )
        for start in range(0, len(group), n_columns)
    ]
    return tuple(
        picture_png(
            _sheet(sheet, width, gap, room),
            Caption(title, inspection.scan.name, "residuals of every step, from above, its nosing below", date, ""),
            residual_legend(limit_m, with_others=False),
            Scale(pixels_per_m, unit, is_everywhere=True),
            "White",
        )
        for sheet in _pages(rows, width, gap)
    )


def _tile(step: Step, found: ResidualMap, limit_m: float, pixels_per_m: float) -> _Tile:
    rows, columns = found.residuals_m.shape
    colors = color_residuals(found.residuals_m.ravel(), limit_m).reshape(rows, columns, 3)
    colors[~np.isfinite(found.residuals_m)] = _NO_POINTS
    size = (max(1, round(columns * found.cell_m * pixels_per_m)), max(1, round(rows * found.cell_m * pixels_per_m)))
    pixels = np.asarray(Image.fromarray(colors).resize(size, Image.Resampling.NEAREST), dtype=np.uint8)
    kind = ", landing" if step.kind == "landing" else ""
    return _Tile(f"step {step.step_id}{kind}", pixels)


def _letters(width: int) -> int:
    return max(11, round(_TEXT_SHARE * width))


def _height(row: list[_Tile], width: int, gap: int) -> int:
    return max(len(tile.pixels) for tile in row) + 2 * _letters(width) + gap // 2


def _pages(rows: list[list[_Tile]], width: int, gap: int) -> Iterable[list[list[_Tile]]]:
    """Yield as many rows as a sheet has room for, at least one."""
    page: list[list[_Tile]] = []
    used = 0
    for row in rows:
        height = _height(row, width, gap)
        if page and used + height > _TALLEST * width:
            yield page
            page, used = [], 0
        page.append(row)
        used += height
    yield page


def _sheet(rows: list[list[_Tile]], width: int, gap: int, room: int) -> Colors:
    image = Image.new("RGB", (width, sum(_height(row, width, gap) for row in rows)), (255, 255, 255))
    draw = ImageDraw.Draw(image)
    size = _letters(width)
    pen = Lettering(draw, size, _INK)
    y = 0
    for row in rows:
        for column, tile in enumerate(row):
            x = gap + column * (room + gap)
            pen.write(x, y, tile.words)
            top = y + round(1.5 * size)
            image.paste(Image.fromarray(tile.pixels), (x, top))
            bottom, right = top + len(tile.pixels), x + tile.pixels.shape[1] - 1
            draw.rectangle((x - 1, top - 1, right + 1, bottom), outline=(196, 199, 204))
            # The front of the step, where one meets it.
            draw.rectangle((x, bottom, right, bottom + max(1, size // 6)), fill=_NOSING)
        y += _height(row, width, gap)
    pixels: Colors = np.asarray(image, dtype=np.uint8)
    return pixels
