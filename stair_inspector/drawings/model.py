"""A drawing as plain geometry, millimetres: what the DXF file and the picture in the report are both made from."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

from stair_inspector.model import Step
from stair_inspector.units import tidy

SheetPoint = tuple[float, float]
Layer = Literal[
    "STAIR-NOSING",
    "STAIR-OUTLINE",
    "STAIR-HIDDEN",
    "STAIR-WALKING-LINE",
    "STAIR-PITCH",
    "STAIR-DIM-RISE",
    "STAIR-DIM-GOING",
    "STAIR-DIM-WIDTH",
    "STAIR-DIM-DEPTH",
    "STAIR-HEIGHT",
    "STAIR-NUMBER",
    "STAIR-NOT-MEASURED",
    "STAIR-TITLE",
]
TextAnchor = Literal["start", "middle", "end"]
NOT_MEASURED = "not measured"
_TEXT_ROOM = 1.7
"""Beside a dimension line, in heights of the letters."""


@dataclass(frozen=True, slots=True)
class Path:
    """A line through several places, perhaps closed."""

    places: tuple[SheetPoint, ...]
    layer: Layer
    is_closed: bool = False


@dataclass(frozen=True, slots=True)
class Circle:
    """A circle, for example around a step's number."""

    centre: SheetPoint
    radius: float
    layer: Layer


@dataclass(frozen=True, slots=True)
class Arrow:
    """A line with a filled head at its end."""

    start: SheetPoint
    end: SheetPoint
    head: float
    layer: Layer


@dataclass(frozen=True, slots=True)
class Words:
    """A text in its middle height at a place; ``size`` is the height of its capitals, ``turn_deg`` anticlockwise."""

    text: str
    at: SheetPoint
    size: float
    layer: Layer
    anchor: TextAnchor = "middle"
    turn_deg: float = 0.0


@dataclass(frozen=True, slots=True)
class Dimension:
    """The distance between two places along a direction; its line runs through ``line`` and its text is the distance.

    ``text_share`` is the place of the text along the line, from its start (0) to its end (1).
    """

    start: SheetPoint
    end: SheetPoint
    turn_deg: float
    line: SheetPoint
    layer: Layer
    text_share: float = 0.5

    @property
    def value_mm(self) -> float:
        """What is measured."""
        turn = math.radians(self.turn_deg)
        return abs((self.end[0] - self.start[0]) * math.cos(turn) + (self.end[1] - self.start[1]) * math.sin(turn))

    @property
    def text(self) -> str:
        """What is written on it: millimetres with one decimal."""
        return f"{tidy(self.value_mm, 1):.1f}"

    @property
    def feet(self) -> tuple[SheetPoint, SheetPoint]:
        """The two ends of the dimension line."""
        turn = math.radians(self.turn_deg)
        across = (-math.sin(turn), math.cos(turn))
        ends = []
        for place in (self.start, self.end):
            away = (self.line[0] - place[0]) * across[0] + (self.line[1] - place[1]) * across[1]
            ends.append((place[0] + away * across[0], place[1] + away * across[1]))
        return ends[0], ends[1]

    @property
    def text_at(self) -> SheetPoint:
        """The place on the dimension line at which its text stands."""
        (x1, y1), (x2, y2) = self.feet
        return x1 + self.text_share * (x2 - x1), y1 + self.text_share * (y2 - y1)


Part = Path | Circle | Arrow | Words | Dimension


@dataclass(frozen=True, slots=True)
class Drawing:
    """A drawing: ``title`` names it, ``notes`` are the sentences below it; ``text_mm`` is the height of its letters.

    All places are millimetres, x to the right and y upwards.
    """

    key: str
    title: str
    notes: tuple[str, ...]
    parts: tuple[Part, ...]
    text_mm: float

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """The lowest and highest x and y with room for the dimensions' texts: (x_low, y_low, x_high, y_high)."""
        places = [place for part in self.parts for place in _places(part)]
        xs, ys = zip(*places, strict=True)
        room = _TEXT_ROOM * self.text_mm
        return min(xs) - room, min(ys) - room, max(xs) + room, max(ys) + room

    def dimensions(self) -> list[Dimension]:
        """Return the dimensions alone."""
        return [part for part in self.parts if isinstance(part, Dimension)]


def _places(part: Part) -> Iterator[SheetPoint]:
    if isinstance(part, Path):
        yield from part.places
    elif isinstance(part, Circle):
        (x, y), r = part.centre, part.radius
        yield from ((x - r, y - r), (x + r, y + r))
    elif isinstance(part, Arrow):
        yield from (part.start, part.end)
    elif isinstance(part, Dimension):
        yield from (part.start, part.end, *part.feet)
    else:
        yield from _corners(part)


def _corners(words: Words) -> Iterator[SheetPoint]:
    """Return about where a text begins and ends."""
    length = 0.62 * words.size * len(words.text)
    before = {"start": 0.0, "middle": 0.5, "end": 1.0}[words.anchor]
    turn = math.radians(words.turn_deg)
    along, across = (math.cos(turn), math.sin(turn)), (-math.sin(turn), math.cos(turn))
    for share, side in ((-before, -0.5), (1.0 - before, 0.5)):
        x = words.at[0] + share * length * along[0] + side * words.size * across[0]
        y = words.at[1] + share * length * along[1] + side * words.size * across[1]
        yield x, y


def title_for(what: str, steps: Sequence[Step]) -> str:
    """Return the title of a drawing of some steps."""
    first, last = steps[0].step_id, steps[-1].step_id
    return f"{what}, step {first}" if len(steps) == 1 else f"{what}, steps {first} to {last}"


def readable_deg(turn_deg: float) -> float:
    """Return the direction in which a text along a line is read from below or from the right."""
    turn = (turn_deg + 180.0) % 360.0 - 180.0
    return turn if -89.0 < turn <= 91.0 else turn - math.copysign(180.0, turn)


def head_of(arrow: Arrow) -> tuple[SheetPoint, SheetPoint, SheetPoint]:
    """Return the three corners of an arrow's head, its tip first."""
    (x0, y0), (x1, y1) = arrow.start, arrow.end
    length = max(((x1 - x0) ** 2 + (y1 - y0) ** 2) ** 0.5, 1e-9)
    ux, uy = (x1 - x0) / length, (y1 - y0) / length
    back = (x1 - arrow.head * ux, y1 - arrow.head * uy)
    half = 0.32 * arrow.head
    return (x1, y1), (back[0] - half * uy, back[1] + half * ux), (back[0] + half * uy, back[1] - half * ux)
