"""Small pieces of SVG that charts and drawings share: print colours, one font, and words that cannot break out.

All sizes are points as printed where a picture takes the page's width of :data:`PAGE` points.
"""

import html

from stair_inspector.content.document import plain

PAGE = 480.0
"""Width of a picture that takes the whole width of a page, points."""
FONT = "'Noto Sans KR', 'Source Sans 3', 'Noto Sans', 'Liberation Sans', 'DejaVu Sans', Arial, Helvetica, sans-serif"
"""The first is a font of the PDF; what typesets it knows only the thinnest weight of the report's own in pictures."""
INK = "#1b1e23"
DIM = "#5d636d"
FAINT = "#c3c7ce"
GRID = "#e4e6ea"
ACCENT = "#1f5f8b"
ALERT = "#b3261e"
CLOSE = "#b26a00"
SIZE = 7.0
"""Usual size of letters, points."""
_WIDE = 0.56
"""Mean width of a letter or digit, as a share of its size; on the safe side for the fonts of :data:`FONT`."""


def words(value: object) -> str:
    """Return a text as it can stand inside an element or a quoted attribute: escaped, on one line, all of it seen."""
    return html.escape(plain(value).replace("\n", " "), quote=True)


def width_of(text_element: str, size: float = SIZE) -> float:
    """Return about how wide a text is, points."""
    return _WIDE * size * len(text_element)


def picture(width: float, height: float, title: str, body: str) -> str:
    """Return a whole SVG picture; ``title`` says what it shows to who cannot see it."""
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:g}pt" height="{height:.4g}pt" '
        f'viewBox="0 0 {width:g} {height:.4g}" role="img" aria-label="{words(title)}" '
        f'font-family="{words(FONT)}" font-size="{SIZE:g}"><title>{words(title)}</title>'
        f'<rect width="{width:g}" height="{height:.4g}" fill="#ffffff"/>{body}</svg>'
    )


def line(x1: float, y1: float, x2: float, y2: float, color: str = INK, width: float = 0.6, more: str = "") -> str:
    """Return a straight line."""
    return (
        f'<line x1="{x1:.2f}" y1="{y1:.2f}" x2="{x2:.2f}" y2="{y2:.2f}" stroke="{color}" stroke-width="{width:g}"'
        f"{more}/>"
    )


def text_element(
    x: float,
    y: float,
    value: object,
    anchor: str = "start",
    size: float = SIZE,
    color: str = INK,
    *,
    is_bold: bool = False,
    turn_deg: float = 0.0,
    has_halo: bool = False,
) -> str:
    """Return a text whose base line begins, ends or is centred at a place; ``turn_deg`` counts clockwise."""
    more = ' font-weight="700"' if is_bold else ""
    more += f' transform="rotate({turn_deg:.2f} {x:.2f} {y:.2f})"' if turn_deg else ""
    shown = words(value)
    place = f'<text x="{x:.2f}" y="{y:.2f}" text-anchor="{anchor}" font-size="{size:g}"'
    # Drawn twice, because not every reader of SVG knows an outline that lies behind its letters.
    halo = f'{place} fill="#ffffff" stroke="#ffffff" stroke-width="2.2"{more} aria-hidden="true">{shown}</text>'
    return f'{halo if has_halo else ""}{place} fill="{color}"{more}>{shown}</text>'


def polyline(points: list[tuple[float, float]], color: str = INK, width: float = 0.6, more: str = "") -> str:
    """Return a line through several points."""
    places = " ".join(f"{x:.2f},{y:.2f}" for x, y in points)
    return f'<polyline points="{places}" fill="none" stroke="{color}" stroke-width="{width:g}"{more}/>'


def polygon(points: list[tuple[float, float]], fill: str, more: str = "") -> str:
    """Return a filled shape."""
    places = " ".join(f"{x:.2f},{y:.2f}" for x, y in points)
    return f'<polygon points="{places}" fill="{fill}"{more}/>'
