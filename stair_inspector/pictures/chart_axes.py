"""The frame of a chart: its scale, its axis, and the room for what is written around it."""

from dataclasses import dataclass

from stair_inspector.pictures import svg
from stair_inspector.units import round_ticks

STEPS_PER_ROW = 22
"""So many values stand beside each other and can be read where the picture is as wide as a page."""
LEFT, RIGHT = 34.0, 20.0
ABOVE, PLOT, BELOW = 14.0, 100.0, 32.0
"""Of each row: room for the flight's name, the plot itself, and room for the steps' numbers and marks."""
LEAST_SPAN_MM = 12.0
"""The scale is never finer than this: noise must not look like a defect."""
KEY_LINE = 10.5


@dataclass(frozen=True, slots=True)
class ChartScale:
    """Millimetres to points of a row whose plot begins at ``top``."""

    low_mm: float
    high_mm: float
    top: float
    plot: float

    def y(self, value_mm: float) -> float:
        """Return where a value stands; one beyond the scale stands at its end."""
        share = (value_mm - self.low_mm) / (self.high_mm - self.low_mm)
        return self.top + self.plot * (1.0 - min(max(share, 0.0), 1.0))


def axis_svg(scale: ChartScale, title: str) -> str:
    """Return the grid, the base line and the numbers of a chart, with the title along its left side."""
    right, bottom = svg.PAGE - RIGHT, scale.top + scale.plot
    parts = []
    for digits, value in round_ticks(scale.low_mm, scale.high_mm - scale.low_mm, 5.0):
        y = scale.y(value)
        parts.append(svg.line(LEFT, y, right, y, svg.GRID, 0.5))
        parts.append(svg.text_element(LEFT - 4.0, y + 2.2, with_minus(f"{value:.{digits}f}"), "end", 6.5, svg.DIM))
    parts.append(svg.line(LEFT, bottom, right, bottom, svg.INK, 0.7))
    middle = scale.top + scale.plot / 2.0
    parts.append(svg.text_element(8.0, middle, title, "middle", 6.5, svg.DIM, turn_deg=-90.0))
    return "".join(parts)


def with_minus(number: str) -> str:
    """Return a written number with a minus sign for its hyphen."""
    return number.replace("-", "−")
