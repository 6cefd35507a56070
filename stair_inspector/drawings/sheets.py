"""The drawings of a staircase as pictures for the report: as many as can be read."""

from collections.abc import Callable, Sequence

from stair_inspector.drawings.model import Drawing
from stair_inspector.drawings.plan import plan
from stair_inspector.drawings.section import section
from stair_inspector.drawings.sheet import LETTERS, sheet_svg
from stair_inspector.model import Inspection, Step
from stair_inspector.pictures import svg

MOST_STEPS = 20
"""Steps of one picture: the numbers of more could not be read on a page."""
_TALLEST = 610.0
"""Points that a picture may be high: a page without its caption."""
_LARGEST_SCALE = 0.16
"""Points for a millimetre: a stair of three steps is not drawn larger than 1:18."""
_ROUNDS = 4

Draw = Callable[[Inspection, float, Sequence[Step] | None], Drawing | None]


def plan_svgs(inspection: Inspection) -> tuple[tuple[str, str], ...]:
    """Return the title and the SVG of each picture of the plan, from bottom to top."""
    return _sheets(inspection, plan)


def section_svgs(inspection: Inspection) -> tuple[tuple[str, str], ...]:
    """Return the title and the SVG of each picture of the section along the walking line, from bottom to top."""
    return _sheets(inspection, section)


def _sheets(inspection: Inspection, draw: Draw) -> tuple[tuple[str, str], ...]:
    found = []
    for steps in _portions(inspection):
        fitted = _fitted(inspection, draw, steps)
        if fitted is not None:
            drawing, scale = fitted
            found.append((drawing.title, sheet_svg(drawing, scale)))
    return tuple(found)


def _portions(inspection: Inspection) -> list[tuple[Step, ...]]:
    """Return the steps of each picture: all, or else each flight, a long one in even parts."""
    steps = inspection.steps
    if len(steps) <= MOST_STEPS:
        return [steps] if steps else []
    portions = []
    for flight in inspection.flights:
        own = tuple(step for step in steps if step.flight == flight.flight_id)
        n_parts = -(-len(own) // MOST_STEPS)
        size = -(-len(own) // n_parts)
        portions += [own[start : start + size] for start in range(0, len(own), size)]
    return portions


def _fitted(inspection: Inspection, draw: Draw, steps: Sequence[Step]) -> tuple[Drawing, float] | None:
    """Return the drawing and its scale for which the letters have their size in print and all of it fits a page."""
    scale = _LARGEST_SCALE
    for _ in range(_ROUNDS):
        drawing = draw(inspection, LETTERS / scale, steps)
        if drawing is None:
            return None
        x_low, y_low, x_high, y_high = drawing.bounds
        fits = min((svg.PAGE - 12.0) / (x_high - x_low), _TALLEST / (y_high - y_low))
        if fits >= scale:
            break
        # Smaller letters take less room: half way at a time would end too small.
        scale = fits
    return (drawing, min(scale, fits)) if drawing is not None else None
