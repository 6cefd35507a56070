"""Words in pictures: a font of the report's, or of this machine, that has all letters; else what Pillow's own has."""

from functools import lru_cache

from PIL import ImageDraw, ImageFont

from stair_inspector.files.palettes import Rgb
from stair_inspector.pictures.fonts import font_files

_FONTS = (
    "DejaVuSans.ttf",
    "NotoSans-Regular.ttf",
    "LiberationSans-Regular.ttf",
    "Arial.ttf",
    "arial.ttf",
    "NotoSansCJK-Regular.ttc",
    "NanumGothic.ttf",
    "malgun.ttf",
    "AppleSDGothicNeo.ttc",
)
"""Where the report's own lack a letter: looked for by Pillow where the system keeps its fonts. The first that has every
letter of a text draws it."""
_REGULAR = 400.0
"""Weight of the letters, of the fonts that have more than one."""
_INSTEAD = {
    "–": "-",
    "−": "-",
    "→": "->",
    "×": "x",
    "²": "2",
    "θ": "theta",
    "ε": "eps",
    "α": "alpha",
    "·": "|",
    "…": "...",
    "✓": "ok",
}
_NO_LETTER = "\uffff"
_LETTERS_PER_SIZE = 4.0
"""Narrow letters that stand beside each other in the width of a line as wide as they are high."""

Font = ImageFont.FreeTypeFont | ImageFont.ImageFont


class Lettering:
    """Text of one size, pixels, drawn in one colour, with an outline that keeps it readable on any ground.

    Parameters
    ----------
    draw : ImageDraw.ImageDraw
        Picture that is written on.
    size : int
        Height of the letters, pixels.
    color : Rgb
        Of the letters.
    outline : int
        Width of the white outline, pixels; 0 for none.
    """

    def __init__(self, draw: ImageDraw.ImageDraw, size: int, color: Rgb, outline: int = 0) -> None:
        self._draw, self.size, self._color, self._outline = draw, size, color, outline

    def width(self, words: str) -> float:
        """Return how wide a text is, pixels."""
        font, words = _fit(words, self.size)
        return float(self._draw.textlength(words, font=font))

    def write(self, x: float, y: float, words: str) -> None:
        """Write a text whose upper left corner lies at a place, pixels."""
        font, words = _fit(words, self.size)
        self._draw.text(
            (x, y), words, fill=self._color, font=font, stroke_width=self._outline, stroke_fill=(255, 255, 255)
        )

    def wrap(self, words: str, width: float) -> list[str]:
        """Return a text in lines that are no wider than this; a single word that is wider is cut into pieces."""
        lines, line = [], ""
        # No line has more letters, however narrow: a name of thousands of letters is cut without trying them all.
        most = max(1, int(_LETTERS_PER_SIZE * width / self.size))
        for word in words.split():
            while len(word) > 1 and (len(word) > most or self.width(word) > width):
                fitting = (k for k in range(min(len(word), most), 0, -1) if self.width(word[:k]) <= width)
                n = next(fitting, 1)
                lines += [line] if line else []
                lines.append(word[:n])
                line, word = "", word[n:]
            longer = f"{line} {word}" if line else word
            if line and self.width(longer) > width:
                lines.append(line)
                longer = word
            line = longer
        return [*lines, line] if line else lines


def _fit(words: str, size: int) -> tuple[Font, str]:
    """Return a font and the text in letters that it has."""
    words = "".join(letter if letter.isprintable() else " " for letter in words)
    for name in (*font_files(), *_FONTS):
        font = _font(name, size)
        if font is not None and all(_has(name, letter) for letter in words):
            return font, words
    own = ImageFont.load_default(size)
    return own, "".join(_own_letters(letter) for letter in words)


@lru_cache(maxsize=256)
def _font(name: str, size: int) -> ImageFont.FreeTypeFont | None:
    try:
        font = ImageFont.truetype(name, size)
    except OSError:
        return None
    try:
        font.set_variation_by_axes([_REGULAR])
    except OSError:
        # Most fonts have one weight only.
        return font
    return font


@lru_cache(maxsize=4096)
def _has(name: str, letter: str) -> bool:
    font = _font(name, 16) if name else ImageFont.load_default(16)
    return font is not None and (letter == " " or bytes(font.getmask(letter)) != bytes(font.getmask(_NO_LETTER)))


def _own_letters(letter: str) -> str:
    if _has("", letter):
        return letter
    return _INSTEAD.get(letter, f"<U+{ord(letter):04X}>")
