"""What colours mean, as data: drawn on the page as HTML and burned into pictures."""

from collections.abc import Iterable

from stair_inspector.content.document import Tone
from stair_inspector.files.palettes import Palette
from stair_inspector.pictures.legends import CENTRE, Legend, Ramp, line_entries
from stair_inspector.viewer.bridge.markup import LINE, chip, text
from stair_inspector.viewer.scene.step_marks import MARKED, mark_color


def colour_legend_html(legend: Legend) -> str:
    """Return a legend as HTML."""
    chips = "".join(
        f'<span style="white-space:nowrap">{chip(color)} {text(words)}</span>' for color, words in legend.entries
    )
    chips = f'<div style="display:flex;flex-wrap:wrap;gap:3px 12px;margin-top:3px">{chips}</div>' if chips else ""
    bar = _bar_html(legend.ramp) if legend.ramp is not None else ""
    return (
        f'<div data-testid="color-legend" style="font-size:11px;padding:4px 12px 2px 9px">'
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


def legend_html(
    palette: Palette, *, with_steps: bool = True, tones: Iterable[Tone] = (), with_paper: bool = False
) -> str:
    """Return the legend of the scene's lines and, with ``with_steps``, of its points coloured by step.

    ``tones`` are those of the marks of steps that are outside a limit; ``with_paper`` tells that the paper's edges are
    drawn beside the survey's.
    """
    steps = "".join(chip(color, 10) for color in palette.steps)
    points = [
        f"{chip(palette.floor)} floor",
        f"{steps} steps, in turn",
        f"{chip(palette.non_stair)} other, such as risers",
        f"{chip(palette.rejected)} rejected surfaces",
    ]
    entries = [
        *(points if with_steps else ()),
        *(f"{chip(color, *((8,) if words == CENTRE else (16, 4)))} {words}" for color, words in line_entries(palette)),
        *(f"{chip(mark_color(tone, palette), 16, 4)} {text(words)}" for tone, words in MARKED.items() if tone in tones),
        *([f"{chip(palette.paper_edge, 16, 4)} edges of the paper's columns"] if with_paper else []),
    ]
    items = "".join(f'<span style="white-space:nowrap">{entry}</span>' for entry in entries)
    return (
        f'<div data-testid="legend" style="display:flex;flex-wrap:wrap;gap:2px 12px;font-size:11px;padding:4px 9px">'
        f"{items}</div>"
    )
