"""What colours mean, as data: drawn on the page as HTML and burned into pictures."""

from dataclasses import dataclass

import numpy as np

from stair_inspector.files.palettes import Palette, Rgb
from stair_inspector.geometry.arrays import Colors, Floats

CENTRE = "centre"
"""Words of the points around a step's centroid, which are no line."""


@dataclass(frozen=True, slots=True)
class Ramp:
    """A continuous scale: ``colors`` evenly from low to high, ``ticks`` the place (0 to 1) and the words of each."""

    colors: tuple[Rgb, ...]
    ticks: tuple[tuple[float, str], ...]


@dataclass(frozen=True, slots=True)
class Legend:
    """A title with its unit, single colours with their words, and perhaps a continuous scale."""

    title: str
    entries: tuple[tuple[Rgb, str], ...] = ()
    ramp: Ramp | None = None


def line_entries(palette: Palette) -> tuple[tuple[Rgb, str], ...]:
    """Return the colours of what is drawn over the points of a result, with their words."""
    return (
        (palette.front_edge, "front edge, nosing"),
        (palette.back_edge, "back edge"),
        (palette.side_edge, "side edges"),
        (palette.measure, "measuring lines"),
        (palette.centre, CENTRE),
    )


def colors_on(ramp: tuple[Rgb, ...], shares: Floats) -> Colors:
    """Return the colours (n, 3) at places from 0 to 1 of a scale; what lies beyond an end takes the end's colour."""
    table = np.array(ramp, dtype=np.float64)
    places = np.linspace(0.0, 1.0, len(table))
    mixed = np.column_stack([np.interp(shares, places, table[:, channel]) for channel in range(3)])
    return np.rint(mixed).astype(np.uint8)
