"""Sheets of what changed: every tread from above, coloured by how far its later surface lies off the earlier one."""

import numpy as np

from stair_inspector.files.palettes import Rgb
from stair_inspector.geometry.arrays import Bools, Colors, Ints
from stair_inspector.model import ComparedScan, TreadDeviations
from stair_inspector.pictures.changes import change_legend, change_limit
from stair_inspector.pictures.picture import Caption, Scale, picture_png
from stair_inspector.pictures.ramps import color_signed
from stair_inspector.pictures.tread_sheets import INK, SheetLayout, TreadTile, layout_of, tread_sheets
from stair_inspector.units import Unit

_COLUMNS_OF_MANY = 4
_NO_TREAD: Rgb = (255, 255, 255)
_OUTLINE_SHARE = 0.12
"""Width of the line around what differs from the rest of its tread, in cells."""


def change_sheets(
    compared: ComparedScan, date: str, *, title: str = "", unit: Unit = "mm", width: int = 1500
) -> tuple[bytes, ...]:
    """Return the maps of all treads as PNG pictures with one scale of colours and lengths, treads before landings.

    Parameters
    ----------
    compared : ComparedScan
        Its scan's own numbers of the steps stand over the maps.
    date, title : str
        Burned in, beside the names of the two scans.
    unit : {"mm", "in"}
        Of the scale bar; the colours are in millimetres.
    width : int
        Of a picture, pixels.
    """
    found = compared.found
    known = [(step, step.deviations) for step in found.steps if step.deviations is not None]
    if not known:
        return ()
    limit_m = change_limit(found)
    layout = layout_of(len(known), max(map_width_m(each) for _, each in known), width, _COLUMNS_OF_MANY)
    tiles = [
        TreadTile(compared.number_of(step), step.kind == "landing", map_pixels(each, limit_m, layout))
        for step, each in known
    ]
    names = f"{found.before.name} → {found.after.name}"
    words = "change of every tread, from above, its nosing below"
    return tuple(
        picture_png(
            sheet,
            Caption(title, names, words, date, ""),
            change_legend(limit_m, "not seen in both scans"),
            Scale(layout.pixels_per_m, unit, is_everywhere=True),
            "White",
        )
        for sheet in tread_sheets(tiles, layout)
    )


def map_pixels(found: TreadDeviations, limit_m: float, layout: SheetLayout) -> Colors:
    """Return the map of a tread (h, w, 3), its back above and its left on the left, with a line around what is worn."""
    colors = color_signed(found.deviation_m.ravel(), limit_m).reshape(*found.deviation_m.shape, 3)
    colors[~(found.is_tread | np.isfinite(found.deviation_m))] = _NO_TREAD
    # A row of the map lies ahead of the one before, a column to its left.
    rows, columns = _part_with_tread(found)
    cells = rows[::-1], columns[::-1]
    pixels = layout.scaled(colors[np.ix_(*cells)], found.cell_m).copy()
    local = np.repeat(found.is_local[np.ix_(*cells)][..., None], 3, axis=2).astype(np.uint8)
    is_local = layout.scaled(local, found.cell_m)[..., 0] > 0
    pixels[is_local & ~_shrunk(is_local, max(1, round(_OUTLINE_SHARE * found.cell_m * layout.pixels_per_m)))] = INK
    return pixels


def map_width_m(found: TreadDeviations) -> float:
    """Return how wide the map of a tread is drawn, metres."""
    return len(_part_with_tread(found)[1]) * found.cell_m


def _part_with_tread(found: TreadDeviations) -> tuple[Ints, Ints]:
    """Return the rows and the columns of a map that hold some of the tread; all of them where none does."""
    is_drawn = found.is_tread | np.isfinite(found.deviation_m)
    held = [np.flatnonzero(is_drawn.any(axis=axis)) for axis in (1, 0)]
    rows, columns = (
        np.arange(each[0], each[-1] + 1) if len(each) else np.arange(n)
        for each, n in zip(held, is_drawn.shape, strict=True)
    )
    return rows, columns


def _shrunk(is_in: Bools, by: int) -> Bools:
    """Return what lies deeper in a shape (h, w) than so many pixels."""
    wide = np.pad(is_in, by)
    kept = is_in.copy()
    height, width = is_in.shape
    for down in range(2 * by + 1):
        for right in range(2 * by + 1):
            kept &= wide[down : down + height, right : right + width]
    return kept
