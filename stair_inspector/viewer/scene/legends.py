"""What colours mean, as data: drawn on the page as HTML and burned into pictures."""

from stair_inspector.pictures.legends import Legend, Ramp
from stair_inspector.viewer.bridge.markup import LINE, chip, text


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
