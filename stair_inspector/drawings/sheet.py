"""A drawing as SVG for print, from the same geometry as the DXF file: thin dimensions, strong nosings, a scale bar."""

import math

from stair_inspector.drawings.model import (
    Arrow,
    Circle,
    Dimension,
    Drawing,
    Layer,
    Part,
    Path,
    SheetPoint,
    TextAnchor,
    Words,
    head_of,
    readable_deg,
)
from stair_inspector.pictures import svg
from stair_inspector.pictures.picture import Scale, bar_of

LETTERS = 6.2
"""Height that a drawing's letters have in print, points."""
_CAPITALS = 0.72
"""Height of a capital as a share of the size of its font."""
_MARGIN = 6.0
_NOTE = 6.3
_NOTE_LINE = 9.0
_LONGEST_BAR = 110.0
_TICK = 2.1
_HEAVY: dict[Layer, tuple[str, float, str]] = {
    "STAIR-NOSING": (svg.INK, 1.1, ""),
    "STAIR-OUTLINE": (svg.DIM, 0.6, ""),
    "STAIR-HIDDEN": (svg.FAINT, 0.5, "2.5 1.6"),
    "STAIR-WALKING-LINE": (svg.ACCENT, 0.7, ""),
    "STAIR-PITCH": (svg.ACCENT, 0.5, "6 1.6 1 1.6"),
    "STAIR-DIM-RISE": (svg.ACCENT, 0.45, ""),
    "STAIR-DIM-GOING": (svg.ACCENT, 0.45, ""),
    "STAIR-DIM-WIDTH": (svg.ACCENT, 0.45, ""),
    "STAIR-DIM-DEPTH": (svg.ACCENT, 0.45, ""),
    "STAIR-HEIGHT": (svg.DIM, 0.45, ""),
    "STAIR-NUMBER": (svg.INK, 0.5, ""),
    "STAIR-NOT-MEASURED": (svg.ALERT, 0.5, ""),
    "STAIR-TITLE": (svg.INK, 0.6, ""),
}
"""Of each layer: colour, line width in points, dashes."""


def sheet_svg(drawing: Drawing, points_per_mm: float) -> str:
    """Return a drawing as an SVG picture as wide as a page, in its middle, with notes and a scale bar below it.

    Parameters
    ----------
    drawing : Drawing
        What it does not fill of the page's width stays white.
    points_per_mm : float
        Scale: points of the picture for a millimetre of the stair.
    """
    x_low, y_low, x_high, y_high = drawing.bounds
    scale = min(points_per_mm, (svg.PAGE - 2.0 * _MARGIN) / (x_high - x_low))
    left = (svg.PAGE - scale * (x_high - x_low)) / 2.0
    paper = _Paper(scale, left - scale * x_low, _MARGIN + scale * y_high)
    body = "".join(_part(part, paper) for part in _in_order(drawing.parts))
    y = _MARGIN + scale * (y_high - y_low) + 16.0
    body += _bar(svg.PAGE - _MARGIN, y - 6.0, scale)
    room = svg.PAGE - 3.0 * _MARGIN - _LONGEST_BAR
    for note in drawing.notes:
        for words in _wrapped(note, room):
            body += svg.text_element(_MARGIN, y, words, "start", _NOTE, svg.DIM)
            y += _NOTE_LINE
    return svg.picture(svg.PAGE, y + 2.0, drawing.title, body)


class _Paper:
    """Where the millimetres of a drawing lie in the picture, points; y downwards."""

    def __init__(self, scale: float, x: float, y: float) -> None:
        self.scale, self._x, self._y = scale, x, y

    def at(self, place: SheetPoint) -> SheetPoint:
        return self._x + self.scale * place[0], self._y - self.scale * place[1]


def _in_order(parts: tuple[Part, ...]) -> list[Part]:
    """Return the parts with texts last, so that no line crosses them."""
    return sorted(parts, key=lambda part: (isinstance(part, Words), isinstance(part, Dimension)))


def _part(part: Part, paper: _Paper) -> str:
    color, width, dashes = _HEAVY[part.layer]
    more = f' stroke-dasharray="{dashes}"' if dashes else ""
    more += ' stroke-linecap="round" stroke-linejoin="round"'
    if isinstance(part, Path):
        places = [paper.at(place) for place in part.places]
        return svg.polyline(places + places[:1] if part.is_closed else places, color, width, more)
    if isinstance(part, Circle):
        x, y = paper.at(part.centre)
        return (
            f'<circle cx="{x:.2f}" cy="{y:.2f}" r="{part.radius * paper.scale:.2f}" fill="#ffffff" stroke="{color}" '
            f'stroke-width="{width:g}"/>'
        )
    if isinstance(part, Arrow):
        (x1, y1), (x2, y2) = paper.at(part.start), paper.at(part.end)
        head = [paper.at(place) for place in head_of(part)]
        return svg.line(x1, y1, x2, y2, color, width, more) + svg.polygon(head, color)
    if isinstance(part, Words):
        return _words(part, paper, color)
    return _dimension(part, paper, color, width)


_TURNED: dict[TextAnchor, TextAnchor] = {"start": "end", "middle": "middle", "end": "start"}
"""What an anchor becomes where words are turned half around, to be read from below."""


def _words(part: Words, paper: _Paper, color: str) -> str:
    size = part.size * paper.scale / _CAPITALS
    x, y = paper.at(part.at)
    turn = -readable_deg(part.turn_deg)
    anchor = part.anchor
    if turn != -part.turn_deg:
        anchor = _TURNED[anchor]
    # Below its middle by half a capital, along the turned upright.
    x -= math.sin(math.radians(turn)) * _CAPITALS * size / 2.0
    y += math.cos(math.radians(turn)) * _CAPITALS * size / 2.0
    return svg.text_element(x, y, part.text, anchor, round(size, 2), color, turn_deg=turn, has_halo=True)


def _dimension(part: Dimension, paper: _Paper, color: str, width: float) -> str:
    feet = [paper.at(foot) for foot in part.feet]
    ends = [paper.at(part.start), paper.at(part.end)]
    parts = [svg.line(*feet[0], *feet[1], color, width)]
    turn = math.radians(part.turn_deg)
    slant = (_TICK * math.cos(turn + math.pi / 4.0), -_TICK * math.sin(turn + math.pi / 4.0))
    for foot, end in zip(feet, ends, strict=True):
        parts.append(
            svg.line(foot[0] - slant[0], foot[1] - slant[1], foot[0] + slant[0], foot[1] + slant[1], color, 0.9)
        )
        parts.append(_extension(end, foot))
    size = LETTERS / _CAPITALS
    length = math.dist(*feet)
    x, y = paper.at(part.text_at)
    is_rise = part.layer == "STAIR-DIM-RISE"
    if is_rise:
        # Beside its line: a riser is lower than its number is long.
        parts.append(svg.text_element(x - 2.0, y + 0.36 * size, part.text, "end", round(size, 2), color, has_halo=True))
    else:
        readable = -readable_deg(part.turn_deg)
        small = min(1.0, 0.94 * length / max(svg.width_of(part.text, size), 1e-9))
        away = 1.6
        x += math.sin(math.radians(readable)) * away
        y -= math.cos(math.radians(readable)) * away
        shown = svg.text_element(
            x, y, part.text, "middle", round(max(small, 0.6) * size, 2), color, turn_deg=readable, has_halo=True
        )
        parts.append(shown)
    return "".join(parts)


def _extension(end: SheetPoint, foot: SheetPoint) -> str:
    """Return the thin line from a measured place to its dimension line, if they are apart."""
    length = math.dist(end, foot)
    if length < 4.0:
        return ""
    share = 2.0 / length
    start = (end[0] + share * (foot[0] - end[0]), end[1] + share * (foot[1] - end[1]))
    return svg.line(*start, *foot, svg.FAINT, 0.35)


def _bar(right: float, y: float, points_per_mm: float) -> str:
    length, words = bar_of(Scale(points_per_mm * 1000.0, "mm"), _LONGEST_BAR)
    left, quarter = right - length, length / 4.0
    parts = [
        f'<rect x="{left + k * quarter:.2f}" y="{y:.2f}" width="{quarter:.2f}" height="2.6" stroke="{svg.INK}" '
        f'stroke-width="0.4" fill="{svg.INK if k % 2 == 0 else "#ffffff"}"/>'
        for k in range(4)
    ]
    parts.append(svg.text_element(left, y + 10.0, "0", "middle", _NOTE, svg.DIM))
    parts.append(svg.text_element(right, y + 10.0, words, "end", _NOTE, svg.DIM))
    return "".join(parts)


def _wrapped(sentence: str, room: float) -> list[str]:
    lines = [""]
    for word in sentence.split():
        longer = f"{lines[-1]} {word}".strip()
        if lines[-1] and svg.width_of(longer, 0.92 * _NOTE) > room:
            lines.append(word)
        else:
            lines[-1] = longer
    return lines
