"""Pictures for a report: a rendered view with title, scan, date, settings, legend and scale bar burned in, as PNG.

Nothing here knows the page, so the same picture can be made from any pixels.
"""

import io
import itertools
import math
import re
import zipfile
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from PIL import Image, ImageDraw

from stair_inspector import __version__
from stair_inspector.errors import ConfigError
from stair_inspector.files.palettes import Rgb
from stair_inspector.geometry.arrays import Colors
from stair_inspector.pictures.cameras import Pose
from stair_inspector.pictures.legends import Legend, Ramp, colors_on
from stair_inspector.pictures.lettering import Lettering
from stair_inspector.units import M_PER_INCH, Unit

Background = Literal["White", "Transparent"]

BACKGROUNDS: tuple[Background, ...] = ("White", "Transparent")
LARGEST_PIXELS = 7680
"""Longest side of a picture: 8K."""
SMALLEST_PIXELS = 200
_INK: Rgb = (24, 26, 30)
_DIM: Rgb = (96, 100, 108)
_ROUND_IN = (0.5, 1.0, 2.0, 3.0, 6.0, 12.0, 24.0, 36.0, 60.0, 120.0, 240.0, 600.0, 1200.0)
_BAR_SHARE = 0.22
"""Longest scale bar, as a share of the picture's width."""
_TEXT_SHARE = 1.0 / 80.0
_SMALLEST_TEXT = 11
_FOOT_LINES = 16.0
"""Room for legend and scale bar, in sizes of the text, of which only what is used is kept."""


@dataclass(frozen=True, slots=True)
class Caption:
    """What is written on a picture; ``settings`` is one line of text, as long as it may be."""

    title: str
    scan: str
    view: str
    date: str
    settings: str


@dataclass(frozen=True, slots=True)
class Scale:
    """How large things are in a picture, pixels for a metre: as far from the camera as the point it looks at.

    The page's orthographic look is a perspective from far away: what is nearer than that point is still some percent
    larger. ``is_everywhere`` says that there is no perspective at all.
    """

    pixels_per_m: float
    unit: Unit
    is_everywhere: bool = False


def check_size(width: float, height: float) -> tuple[int, int]:
    """Return the size of a picture in whole pixels.

    Raises
    ------
    ConfigError
        A side is not between 200 and 7680 pixels.
    """
    for name, pixels in (("width", width), ("height", height)):
        # A comparison with something that is no number is False.
        if not SMALLEST_PIXELS <= pixels <= LARGEST_PIXELS:
            raise ConfigError(f"picture: {name}: got {pixels:g}; give {SMALLEST_PIXELS} to {LARGEST_PIXELS} pixels")
    return round(width), round(height)


def size_of(width: float, height: float, factor: float) -> tuple[int, int]:
    """Return the size of a picture so many times as large as a window, or as large as a picture can be.

    Raises
    ------
    ConfigError
        As :func:`check_size`.
    """
    factor = min(factor, LARGEST_PIXELS / max(width, height, 1.0))
    return check_size(min(width * factor, LARGEST_PIXELS), min(height * factor, LARGEST_PIXELS))


def scale_of(pose: Pose, fov_rad: float, height: int, unit: Unit) -> Scale:
    """Return the scale of a picture ``height`` pixels tall at the point that its camera looks at."""
    distance = float(np.linalg.norm(pose.look_at - pose.position))
    return Scale(height / (2.0 * distance * math.tan(fov_rad / 2.0)), unit)


def bar_of(scale: Scale, longest: float) -> tuple[float, str]:
    """Return the length of a scale bar, pixels, and its words: the largest round length that is not longer."""
    most_m = longest / scale.pixels_per_m
    if scale.unit == "in":
        most = most_m / M_PER_INCH
        inches = max((length for length in _ROUND_IN if length <= most), default=_round_below(most))
        words = f"{inches:g} in" if inches < 24.0 else f"{inches / 12.0:g} ft"
        return inches * M_PER_INCH * scale.pixels_per_m, words
    length_m = _round_below(most_m)
    words = f"{length_m:g} m" if length_m >= 1.0 else f"{length_m * 1000.0:g} mm"
    return length_m * scale.pixels_per_m, words


def picture_png(
    pixels: Colors,
    caption: Caption,
    legend: Legend | None,
    scale: Scale | None,
    background: Background,
    text_scale: float = 1.0,
) -> bytes:
    """Return a rendered view with what belongs to it, as PNG.

    Parameters
    ----------
    pixels : (h, w, 4) uint8
        Red, green, blue and opacity, as the page renders them; (h, w, 3) is opaque.
    caption : Caption
        Title, scan, view and date stand above the view, the settings below it: nothing covers the stair.
    legend : Legend, optional
        Of the colours.
    scale : Scale, optional
        From :func:`scale_of` with the height of ``pixels``.
    background : {"White", "Transparent"}
        Behind the scan. On a transparent one the letters have a white outline.
    text_scale : float
        How much larger the letters are than in a picture as wide as a page: 2 where it takes half of one.
    """
    view = Image.fromarray(pixels).convert("RGBA")
    paper = _Paper(view.width, background, text_scale)
    head = [(caption.title or caption.scan, 1.6, _INK), (_second_line(caption), 1.0, _DIM)]
    for words, size, color in head:
        paper.text(words, size, color)
    paper.skip(0.5)
    paper.view(view)
    paper.skip(0.6)
    paper.foot(legend, scale)
    paper.text(caption.settings, 0.85, _DIM)
    paper.text(f"stair_inspector {__version__}", 0.85, _DIM)
    stream = io.BytesIO()
    paper.image().save(stream, "PNG")
    return stream.getvalue()


def pictures_zip(
    stem: str,
    views: Iterable[tuple[str, Pose, float]],
    render: Callable[[Pose, float], Colors],
    finish: Callable[[str, Colors, Pose, float], bytes],
    on_view: Callable[[str], None] = lambda name: None,
) -> bytes:
    """Return a zip of pictures, one for each view.

    Parameters
    ----------
    stem : str
        Begins each file's name; what is no letter, digit, dot, dash or underscore becomes an underscore. Where two
        views have the same name, or would have, the later ones have a number.
    views : iterable of (name, pose, fov_rad)
        Name of the view, its camera and its upright angle of view.
    render : callable
        Returns the pixels of a camera, (h, w, 4).
    finish : callable
        Returns the PNG of a view's name, pixels, camera and angle: :func:`picture_png`.
    on_view : callable
        Told each name before it is made; may raise to stop.
    """
    stream = io.BytesIO()
    taken: set[str] = set()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_STORED) as archive:
        for name, pose, fov_rad in views:
            on_view(name)
            png = finish(name, render(pose, fov_rad), pose, fov_rad)
            archive.writestr(f"{_free_name(f'{safe_name(stem)}_{safe_name(name).lower()}', taken)}.png", png)
    return stream.getvalue()


def _free_name(stem: str, taken: set[str]) -> str:
    """Return the stem, with a number where it is taken, and take it."""
    numbered = (f"{stem}_{number}" for number in itertools.count(2))
    name = next(each for each in itertools.chain((stem,), numbered) if each not in taken)
    taken.add(name)
    return name


def safe_name(words: str) -> str:
    """Return words as a part of a file's name, without anything that means more to a file system."""
    return re.sub(r"[^\w.-]+", "_", words).strip("._")[:100] or "stair"


def _round_below(most: float) -> float:
    """Return the largest of 1, 2 or 5 and zeros that is not larger."""
    power = 10.0 ** math.floor(math.log10(most))
    return max(factor * power for factor in (1.0, 2.0, 5.0) if factor * power <= most * (1.0 + 1e-9))


def _second_line(caption: Caption) -> str:
    parts = (caption.scan if caption.title else "", caption.view, caption.date)
    return "  ·  ".join(part for part in parts if part)


class _Paper:
    """A picture that grows downwards, as wide as the view; all sizes follow from that width."""

    def __init__(self, width: int, background: Background, text_scale: float) -> None:
        self._width = width
        self._ground = (255, 255, 255, 255) if background == "White" else (255, 255, 255, 0)
        self._size = max(_SMALLEST_TEXT, round(width * _TEXT_SHARE * text_scale))
        self._outline = max(1, self._size // 8) if background == "Transparent" else 0
        self._margin = self._size
        self._strips: list[Image.Image] = []
        self.skip(0.5)

    def skip(self, lines: float) -> None:
        self._strips.append(self._strip(round(lines * self._size)))

    def view(self, view: Image.Image) -> None:
        ground = Image.new("RGBA", view.size, self._ground)
        self._strips.append(Image.alpha_composite(ground, view))

    def text(self, words: str, size: float, color: Rgb) -> None:
        """Write words below all else, in as many lines as they need."""
        letters = round(size * self._size)
        lines = self._letters(self._strip(1), size, color).wrap(words, self._width - 2 * self._margin)
        strip = self._strip(round(1.35 * letters * len(lines)))
        pen = self._letters(strip, size, color)
        for index, line in enumerate(lines):
            pen.write(self._margin, 1.35 * letters * index, line)
        self._strips.append(strip)

    def foot(self, legend: Legend | None, scale: Scale | None) -> None:
        """Draw the legend on the left and the scale bar on the right."""
        strip = self._strip(round(_FOOT_LINES * self._size))
        right = self._width - self._margin
        bottoms = [0.0]
        if scale is not None:
            length, words = bar_of(scale, _BAR_SHARE * self._width)
            words += "" if scale.is_everywhere else " at the point looked at"
            left = right - max(length, self._letters(strip, 1.0, _INK).width(words))
            bottoms.append(self._scale_bar(strip, left, length, words))
            right = int(left) - 2 * self._margin
        if legend is not None:
            bottoms.append(self._legend(strip, legend, right))
        self._strips.append(strip.crop((0, 0, self._width, math.ceil(max(bottoms)) + self._size // 2)))

    def image(self) -> Image.Image:
        whole = self._strip(sum(strip.height for strip in self._strips) + self._size // 2)
        y = 0
        for strip in self._strips:
            whole.paste(strip, (0, y))
            y += strip.height
        return whole if self._ground[3] == 0 else whole.convert("RGB")

    def _scale_bar(self, strip: Image.Image, left: float, length: float, words: str) -> float:
        draw = ImageDraw.Draw(strip)
        size = self._size
        top, thick = 0.2 * size, max(2, size // 3)
        # Black and white halves, as on a ruler, with a dark and a light outline: seen on any ground.
        draw.rectangle((left - 1, top - 1, left + length + 1, top + thick + 1), fill=(255, 255, 255))
        draw.rectangle((left, top, left + length, top + thick), fill=(255, 255, 255), outline=_INK)
        draw.rectangle((left, top, left + length / 2.0, top + thick), fill=_INK)
        self._letters(strip, 1.0, _INK).write(left, top + thick + 0.25 * size, words)
        return top + thick + 1.6 * size

    def _legend(self, strip: Image.Image, legend: Legend, right: float) -> float:
        """Draw the legend between the left margin and ``right``; return where it ends."""
        size, left = self._size, float(self._margin)
        pen = self._letters(strip, 0.9, _INK)
        y = 0.0
        for line in pen.wrap(legend.title, right - left)[:2]:
            pen.write(left, y, line)
            y += 1.2 * size
        if legend.ramp is not None:
            y = self._ramp(strip, legend.ramp, y + 0.1 * size, min(right - left, 28.0 * size))
        draw = ImageDraw.Draw(strip)
        x = left
        for color, words in legend.entries:
            needed = 1.3 * size + (pen.width(words) + 0.8 * size if words else 0.0)
            if x > left and x + needed > right:
                x, y = left, y + 1.25 * size
            draw.rectangle((x, y + 0.1 * size, x + size, y + 1.1 * size), fill=color, outline=_DIM)
            if words:
                pen.write(x + 1.3 * size, y, words)
            x += needed
        return y + 1.4 * size if legend.entries else y

    def _ramp(self, strip: Image.Image, ramp: Ramp, y: float, length: float) -> float:
        size, left = self._size, float(self._margin)
        shares = np.linspace(0.0, 1.0, max(2, int(length)))
        row = colors_on(ramp.colors, shares)
        bar = Image.fromarray(np.repeat(row[None], max(6, round(0.8 * size)), axis=0))
        strip.paste(bar, (round(left), round(y)))
        pen = self._letters(strip, 0.9, _INK)
        for share, words in ramp.ticks:
            # Each within the bar's ends.
            pen.write(left + share * (length - pen.width(words)), y + bar.height + 0.1 * size, words)
        return y + bar.height + 1.3 * size

    def _letters(self, strip: Image.Image, size: float, color: Rgb) -> Lettering:
        return Lettering(ImageDraw.Draw(strip), round(size * self._size), color, self._outline)

    def _strip(self, height: int) -> Image.Image:
        return Image.new("RGBA", (self._width, max(height, 1)), self._ground)
