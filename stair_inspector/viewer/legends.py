"""What colours mean, as data: drawn on the page as HTML and burned into pictures."""

from dataclasses import dataclass

import numpy as np

from stair_inspector.files.palettes import Rgb
from stair_inspector.geometry.arrays import Colors, Floats
from stair_inspector.viewer.markup import DIM, LINE, chip, text


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


def colors_on(ramp: tuple[Rgb, ...], shares: Floats) -> Colors:
    """Return the colours (n, 3) at places from 0 to 1 of a scale; what lies beyond an end takes the end's colour."""
    table = np.array(ramp, dtype=np.float64)
    places = np.linspace(0.0, 1.0, len(table))
    mixed = np.column_stack([np.interp(shares, places, table[:, channel]) for channel in range(3)])
    return np.rint(mixed).astype(np.uint8)


def legend_html(legend: Legend) -> str:
    """Return a legend as HTML."""
    chips = "".join(
        f'<span style="white-space:nowrap">{chip(color)} {text(words)}</span>' for color, words in legend.entries
    )
    chips = f'<div style="display:flex;flex-wrap:wrap;gap:3px 12px;margin-top:3px">{chips}</div>' if chips else ""
    bar = _bar_html(legend.ramp) if legend.ramp is not None else ""
    return (
        f'<div data-testid="color-legend" style="font-size:11px;color:{DIM};padding:4px 12px 8px 9px">'
        f"<div>{text(legend.title)}</div>{bar}{chips}</div>"
    )


def _bar_html(ramp: Ramp) -> str:
    stops = ", ".join(f"rgb{color}" for color in ramp.colors)
    ticks = "".join(
        f'<span style="position:absolute;left:{100.0 * share:.1f}%;transform:translateX(-{100.0 * share:.0f}%);'
        f'white-space:nowrap">{text(words)}</span>'
        for share, words in ramp.ticks
    )
    return (
        f'<div data-testid="ramp" style="height:10px;margin-top:3px;border-radius:2px;outline:1px solid {LINE};'
        f'background:linear-gradient(to right, {stops})"></div>'
        f'<div style="position:relative;height:15px;font-variant-numeric:tabular-nums">{ticks}</div>'
    )
