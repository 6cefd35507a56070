"""Sheets of maps of treads from above: as many beside and below each other as there is room for, in one scale."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from PIL import Image, ImageDraw

from stair_inspector.files.palettes import Rgb
from stair_inspector.geometry.arrays import Colors
from stair_inspector.pictures.lettering import Lettering

_COLUMNS_OF_FEW, _COLUMNS, _FEW = 2, 3, 8
_GAP_SHARE = 0.025
_TEXT_SHARE = 1.0 / 68.0
_TALLEST = 1.15
"""Height of a sheet at most, as a share of its width: legend and title have room on a page too."""
INK: Rgb = (24, 26, 30)
"""Of the words, of the nosing below each map, and of lines around places of it."""


@dataclass(frozen=True, slots=True, eq=False)
class TreadTile:
    """One step's map as it is drawn: ``pixels`` (h, w, 3), its back above and its left on the left."""

    step_id: int
    is_landing: bool
    pixels: Colors


@dataclass(frozen=True, slots=True)
class SheetLayout:
    """How maps stand on a sheet of ``width`` pixels: so many beside each other, each ``room`` pixels wide at most."""

    width: int
    n_columns: int
    gap: int
    room: int
    pixels_per_m: float

    def scaled(self, cells: Colors, cell_m: float) -> Colors:
        """Return a map (rows, columns, 3) of square cells as large as it stands on the sheet."""
        rows, columns = cells.shape[:2]
        size = tuple(max(1, round(count * cell_m * self.pixels_per_m)) for count in (columns, rows))
        return np.asarray(Image.fromarray(cells).resize(size, Image.Resampling.NEAREST), dtype=np.uint8)


def layout_of(n_maps: int, widest_m: float, width: int, n_columns_of_many: int = _COLUMNS) -> SheetLayout:
    """Return the layout of so many maps, of which the widest has that width."""
    n_columns = _COLUMNS_OF_FEW if n_maps <= _FEW else n_columns_of_many
    gap = round(_GAP_SHARE * width)
    room = (width - (n_columns + 1) * gap) // n_columns
    return SheetLayout(width, n_columns, gap, room, room / widest_m)


def tread_sheets(tiles: Sequence[TreadTile], layout: SheetLayout) -> Iterator[Colors]:
    """Yield the sheets (h, w, 3): treads before landings."""
    # Landings are deep: in rows of their own they leave no holes between the treads.
    rows = [
        group[start : start + layout.n_columns]
        for group in ([each for each in tiles if not each.is_landing], [each for each in tiles if each.is_landing])
        for start in range(0, len(group), layout.n_columns)
    ]
    return (_sheet(page, layout) for page in _pages(rows, layout))


def _letters(layout: SheetLayout) -> int:
    return max(11, round(_TEXT_SHARE * layout.width))


def _height(row: list[TreadTile], layout: SheetLayout) -> int:
    return max(len(tile.pixels) for tile in row) + 2 * _letters(layout) + layout.gap // 2


def _pages(rows: list[list[TreadTile]], layout: SheetLayout) -> Iterator[list[list[TreadTile]]]:
    """Yield as many rows as a sheet has room for, at least one."""
    page: list[list[TreadTile]] = []
    used = 0
    for row in rows:
        height = _height(row, layout)
        if page and used + height > _TALLEST * layout.width:
            yield page
            page, used = [], 0
        page.append(row)
        used += height
    yield page


def _sheet(rows: list[list[TreadTile]], layout: SheetLayout) -> Colors:
    image = Image.new("RGB", (layout.width, sum(_height(row, layout) for row in rows)), (255, 255, 255))
    draw = ImageDraw.Draw(image)
    size = _letters(layout)
    pen = Lettering(draw, size, INK)
    y = 0
    for row in rows:
        for column, tile in enumerate(row):
            x = layout.gap + column * (layout.room + layout.gap)
            pen.write(x, y, f"step {tile.step_id}{', landing' if tile.is_landing else ''}")
            top = y + round(1.5 * size)
            image.paste(Image.fromarray(tile.pixels), (x, top))
            bottom, right = top + len(tile.pixels), x + tile.pixels.shape[1] - 1
            draw.rectangle((x - 1, top - 1, right + 1, bottom), outline=(196, 199, 204))
            # The front of the step, where one meets it.
            draw.rectangle((x, bottom, right, bottom + max(1, size // 6)), fill=INK)
        y += _height(row, layout)
    pixels: Colors = np.asarray(image, dtype=np.uint8)
    return pixels
