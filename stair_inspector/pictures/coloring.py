"""What the points' colours tell: step, height, direction, distance from the step's plane, change, or the scan.

Edge shading is :func:`shade` over any of them.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from stair_inspector.content.segmented_points import labels_at, residuals_at
from stair_inspector.errors import ConfigError
from stair_inspector.files.palettes import Palette, Rgb
from stair_inspector.geometry.arrays import Bools, Colors, Floats
from stair_inspector.model import ComparedScan, Inspection, Patch
from stair_inspector.pictures.changes import change_legend, change_limit, deviations_at
from stair_inspector.pictures.display import Display
from stair_inspector.pictures.legends import Legend, Ramp, colors_on
from stair_inspector.pictures.ramps import NOT_COLORED, VIRIDIS, color_signed, signed_limit, signed_ramp
from stair_inspector.units import tidy

ColorMode = Literal["Step", "Height", "Normal", "Residual", "Change", "Intensity", "Original"]

COLOR_MODES: tuple[ColorMode, ...] = (
    "Step",
    "Height",
    "Normal",
    "Residual",
    "Change",
    "Intensity",
    "Original",
)
_OUTERMOST_PERCENT = 0.5
_AMBIENT, _DIFFUSE = 0.55, 0.45
_CREASE_DARKENING = 0.55
_LEFT_OF_COLOR = 0.25
_LIGHT = np.array([-0.45, -0.62, 0.64])
"""Towards the light, in the axes right of the climber, climb and up: from the lower left, as the first view."""
_CREASE_CELLS = 3.0
"""Side of the cells that tell a crease, in spacings of the points."""


@dataclass(frozen=True, slots=True, eq=False)
class Coloring:
    """A colour (m, 3) for each displayed point, and what they mean."""

    colors: Colors
    legend: Legend


def color_points(
    mode: ColorMode,
    inspection: Inspection,
    display: Display,
    palette: Palette,
    *,
    normals: Floats | None = None,
    axes: Floats | None = None,
    with_rejected: bool = False,
    compared: ComparedScan | None = None,
) -> Coloring:
    """Colour the displayed points.

    Parameters
    ----------
    mode : ColorMode
        What the colours tell.
    inspection, display
        Of the same scan.
    palette : Palette
        Colours of the page.
    normals : (n, 3), optional
        Unit normals of all points of the scan, sign free; needed for the mode "Normal" alone.
    axes : (3, 3), optional
        Right of the climber, climb and up as rows, local; needed for the mode "Normal" alone.
    with_rejected : bool
        Whether rejected surfaces have a colour of their own in the mode "Step".
    compared : ComparedScan, optional
        What changed against a second scan; without it nothing is coloured in the mode "Change".

    Raises
    ------
    ConfigError
        The normals are missing.
    """
    if mode == "Step":
        return Coloring(step_colors(inspection, display, palette, with_rejected=with_rejected), _step_legend(palette))
    if mode == "Height":
        return _by_height(inspection, display)
    if mode == "Normal":
        if normals is None or axes is None:
            raise ConfigError("colour by normal: the normals are not there yet; wait for the result, then try again")
        return _by_normal(normals[display.point_ids], axes)
    if mode == "Residual":
        residuals = residuals_at(inspection, display.points, display.point_ids)
        limit_m = signed_limit(residuals)
        return Coloring(color_signed(residuals, limit_m), residual_legend(limit_m))
    if mode == "Change":
        return _by_change(inspection, display, compared)
    if mode == "Intensity":
        return _by_intensity(display)
    greys = "by how strongly it reflects where it has none" if display.greys is not None else "where it has none"
    return Coloring(display.colors, Legend(f"colours of the scan; grey {greys}"))


def _by_change(inspection: Inspection, display: Display, compared: ComparedScan | None) -> Coloring:
    if compared is None:
        return Coloring(np.full_like(display.colors, NOT_COLORED), Legend("no second scan is compared yet"))
    deviations = deviations_at(compared, inspection, display.points, display.point_ids)
    limit_m = change_limit(compared.found)
    return Coloring(color_signed(deviations, limit_m), change_legend(limit_m, "no tread that both scans saw"))


def _by_intensity(display: Display) -> Coloring:
    if display.greys is None:
        return Coloring(
            np.full_like(display.colors, NOT_COLORED), Legend("the scan does not say how strongly it reflects")
        )
    return Coloring(display.greys, Legend("how strongly it reflects: dark little, light much"))


def step_colors(inspection: Inspection, display: Display, palette: Palette, *, with_rejected: bool = False) -> Colors:
    """Return the colour of each displayed point's step, the floor, or what is left over."""
    labels = labels_at(inspection, display.point_ids)
    colors = palette.of_labels(labels)
    rejected = rejected_of(inspection) if with_rejected else []
    if rejected and inspection.patch_ids is not None:
        patch_ids = inspection.patch_ids[display.point_ids]
        colors[np.isin(patch_ids, [patch.patch_id for patch in rejected])] = palette.rejected
    return colors


def dimmed(colors: Colors, is_aside: Bools, ground: Rgb) -> Colors:
    """Return colours (m, 3), those of points that do not count (m,) drawn towards the ground that they stand on."""
    pale = colors.copy()
    share = _LEFT_OF_COLOR * colors[is_aside] + (1.0 - _LEFT_OF_COLOR) * np.array(ground)
    pale[is_aside] = np.rint(share).astype(np.uint8)
    return pale


def residual_legend(limit_m: float, *, with_others: bool = True) -> Legend:
    """Return the legend of signed distances, millimetres, the same to both sides; with points of no step if drawn."""
    return Legend(
        "distance from the step's own plane [mm]: − below, + above; larger ones take the end's colour",
        ((NOT_COLORED, "of no step"),) if with_others else (),
        signed_ramp(limit_m),
    )


def crease_of(points: Floats, normals: Floats, spacing_m: float) -> Floats:
    """Return how sharply the surface turns at each point (m,), 0 on a plane to 1 where two or three planes meet.

    Parameters
    ----------
    points : (m, 3), metres
        Any frame.
    normals : (m, 3)
        Their unit normals, sign free, same frame.
    spacing_m : float
        Distance of neighbouring points.

    Notes
    -----
    In a cube of a few spacings the squares of the eigenvalues of the mean of n nᵀ sum to 1 where all normals are
    alike, and to 1/2 at a right angle. Two grids, half a cube apart, so that no crease falls between the cubes.
    """
    cell = max(_CREASE_CELLS * spacing_m, 1e-9)
    low = points.min(axis=0)
    products = [normals[:, i] * normals[:, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
    crease = np.zeros(len(points))
    for shift in (0.0, 0.5):
        cells = np.floor((points - low) / cell + shift).astype(np.int64)
        size = cells.max(axis=0) + 1
        _, owner, counts = np.unique(
            (cells[:, 0] * size[1] + cells[:, 1]) * size[2] + cells[:, 2], return_inverse=True, return_counts=True
        )
        means = [np.bincount(owner, weights=product) / counts for product in products]
        squares = sum(mean**2 for mean in means[:3]) + 2.0 * sum(mean**2 for mean in means[3:])
        crease += np.clip(2.0 * (1.0 - squares), 0.0, 1.0)[owner] / 2.0
    # What half of the points have is their noise: most of a scan is no edge.
    usual = float(np.median(crease))
    return np.clip((crease - usual) / max(1.0 - usual, 1e-9), 0.0, 1.0)


def shade(colors: Colors, normals: Floats, axes: Floats, crease: Floats | None = None) -> Colors:
    """Darken colours (m, 3) where the surface turns away from the light, and along creases, so that edges stand out.

    Parameters
    ----------
    colors : (m, 3) uint8
        Of the displayed points.
    normals : (m, 3)
        Unit normals of the same points, sign free.
    axes : (3, 3)
        Right of the climber, climb and up as rows, in the frame of the normals.
    crease : (m,), optional
        From :func:`crease_of`.
    """
    light = axes.T @ (_LIGHT / np.linalg.norm(_LIGHT))
    factor = _AMBIENT + _DIFFUSE * np.abs(normals @ light)
    if crease is not None:
        factor *= 1.0 - _CREASE_DARKENING * crease
    shaded: Colors = np.rint(colors * np.clip(factor, 0.0, 1.0)[:, None]).astype(np.uint8)
    return shaded


def _step_legend(palette: Palette) -> Legend:
    steps = tuple((color, "") for color in palette.steps[:-1])
    return Legend(
        "steps, in turn from bottom to top",
        (
            *steps,
            (palette.steps[-1], "steps"),
            (palette.floor, "floor"),
            (palette.non_stair, "other, such as risers"),
            (palette.rejected, "rejected surfaces, where shown"),
        ),
    )


def _by_height(inspection: Inspection, display: Display) -> Coloring:
    up = inspection.up.vector
    heights = display.points @ up + float(np.array(inspection.scan.origin_m) @ up)
    low, high = np.percentile(heights, [_OUTERMOST_PERCENT, 100.0 - _OUTERMOST_PERCENT]) if len(heights) else (0.0, 0.0)
    span = max(float(high - low), 1e-9)
    ticks = tuple((share, f"{tidy(low + share * span, 2):.2f}") for share in (0.0, 0.25, 0.5, 0.75, 1.0))
    return Coloring(
        colors_on(VIRIDIS, (heights - low) / span),
        Legend("height in the scan's frame [m]", ramp=Ramp(VIRIDIS, ticks)),
    )


def _by_normal(normals: Floats, axes: Floats) -> Coloring:
    # The sign of a normal is not known; red, green and blue are the three directions of the stair.
    shares = np.abs(normals @ axes.T)
    return Coloring(
        np.rint(255.0 * np.clip(shares, 0.0, 1.0)).astype(np.uint8),
        Legend(
            "direction that a surface faces",
            (
                ((0, 0, 255), "up or down: treads"),
                ((0, 255, 0), "along the climb: risers"),
                ((255, 0, 0), "sideways: walls, stringers"),
            ),
        ),
    )


def rejected_of(inspection: Inspection) -> list[Patch]:
    """Return the rejected surfaces, the largest first."""
    rejected = [patch for patch in inspection.patches if patch.kind == "rejected"]
    return sorted(rejected, key=lambda patch: (-patch.area_m2, patch.patch_id))
