"""Sheets of residual maps: the surface of every step from above, coloured by its distance from its own plane."""

import numpy as np

from stair_inspector.files.palettes import Rgb
from stair_inspector.model import Inspection, Scan, Step
from stair_inspector.pictures.coloring import residual_legend
from stair_inspector.pictures.picture import Caption, Scale, picture_png
from stair_inspector.pictures.ramps import color_signed, signed_limit
from stair_inspector.pictures.residuals import ResidualMap, residual_map
from stair_inspector.pictures.tread_sheets import SheetLayout, TreadTile, layout_of, tread_sheets
from stair_inspector.units import Unit

_NO_POINTS: Rgb = (255, 255, 255)


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
    limit_m = signed_limit(np.concatenate([found.residuals_m.ravel() for _, found in known]))
    layout = layout_of(len(known), max(found.residuals_m.shape[1] * found.cell_m for _, found in known), width)
    tiles = [_tile(step, found, limit_m, layout) for step, found in known]
    return tuple(
        picture_png(
            sheet,
            Caption(title, inspection.scan.name, "residuals of every step, from above, its nosing below", date, ""),
            residual_legend(limit_m, with_others=False),
            Scale(layout.pixels_per_m, unit, is_everywhere=True),
            "White",
        )
        for sheet in tread_sheets(tiles, layout)
    )


def _tile(step: Step, found: ResidualMap, limit_m: float, layout: SheetLayout) -> TreadTile:
    rows, columns = found.residuals_m.shape
    colors = color_signed(found.residuals_m.ravel(), limit_m).reshape(rows, columns, 3)
    colors[~np.isfinite(found.residuals_m)] = _NO_POINTS
    return TreadTile(step.step_id, step.kind == "landing", layout.scaled(colors, found.cell_m))
