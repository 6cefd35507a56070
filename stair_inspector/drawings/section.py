"""The section along the walking line: every riser and every going dimensioned, heights cumulated, pitch drawn."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from stair_inspector.drawings.model import NOT_MEASURED, Arrow, Circle, Dimension, Drawing, Part, Path, Words, title_for
from stair_inspector.geometry.arrays import Floats
from stair_inspector.model import Flight, Inspection, Step
from stair_inspector.pictures.nosing_line import is_joined, line_over_nosings, nosing_line
from stair_inspector.units import tidy, u_text

_MM = 1000.0
_FLOOR_MM = 450.0
"""How much floor is drawn before the first riser."""
_APART_MM = 600.0
"""Between flights that no landing joins."""
_LONGEST_DEPTH_MM = 2500.0
"""Of a wider landing only so much is drawn."""


@dataclass(frozen=True, slots=True)
class _Nosing:
    """A step in the section: its nosing, millimetres; ``has_rise`` and ``has_going`` as of its walking line."""

    step: Step
    x: float
    z: float


def section(inspection: Inspection, text_mm: float, steps: Sequence[Step] | None = None) -> Drawing | None:
    """Return the section of some or all steps along their centre line, None where none of them has a nosing.

    Parameters
    ----------
    inspection : Inspection
        Measured by the survey.
    text_mm : float
        Height of the letters, millimetres of the stair.
    steps : sequence of Step, optional
        Successive; by default all.

    Returns
    -------
    Drawing or None
        Climbing to the right, developed where the stair turns: within a flight the nosings are as far apart as the
        goings and rises say, so that each dimension is the inspection's own value. Heights are above the foot of the
        first riser drawn.
    """
    chosen = [step for step in steps or inspection.steps if step.line_points is not None and step.climb is not None]
    placed = _placed(inspection, chosen)
    if not placed:
        return None
    first = placed[0]
    foot = first.z - (first.step.rise_m.value * _MM if first.step.rise_m is not None else 0.0)
    last = {flight.step_ids[-1] for flight in inspection.flights}
    base = min(foot, first.z) - 4.5 * text_mm
    parts: list[Part] = []
    for before, nosing, after in zip([None, *placed], placed, [*placed[1:], None], strict=False):
        parts += _profile(before, nosing, after, inspection.up.vector, text_mm)
        parts += _rise(nosing, text_mm)
        parts += _going(nosing, after, base, text_mm, is_expected=nosing.step.step_id not in last)
        parts += _labels(nosing, after, base, foot, text_mm)
    parts += [*_pitches(inspection, placed, text_mm), *_up(first, foot, text_mm)]
    where = "the foot of its first riser" if first.step.rise_m is not None else "its first nosing"
    notes = (
        "Along the centre line, climbing to the right; developed where the stair turns. Rise: vertical, nosing to "
        "nosing. Going: horizontal, nosing to nosing.",
        f"Heights above {where}. Hidden and unseen surfaces are not drawn. Millimetres.",
    )
    return Drawing("section", title_for("Section along the walking line", chosen), notes, tuple(parts), text_mm)


def _placed(inspection: Inspection, steps: Sequence[Step]) -> list[_Nosing]:
    """Return the nosings where they are drawn, flight after flight."""
    up = inspection.up.vector
    placed: list[_Nosing] = []
    for flight in inspection.flights:
        own = [step for step in steps if step.flight == flight.flight_id]
        walk = line_over_nosings(own, up) if own else None
        if walk is None:
            continue
        x0 = _start(placed[-1] if placed else None, own[0], up)
        z0 = _height(own[0], up)
        placed += [
            _Nosing(step, x0 + run * _MM, z0 + height * _MM)
            for step, run, height in zip(own, walk.runs_m.tolist(), walk.heights_m.tolist(), strict=True)
        ]
    return placed


def _height(step: Step, up: Floats) -> float:
    return 0.0 if step.line_points is None else float(step.line_points[1] @ up) * _MM


def _start(before: _Nosing | None, step: Step, up: Floats) -> float:
    """Return where the first nosing of a flight is drawn, behind the flight before it."""
    if before is None:
        return 0.0
    if not is_joined(before.step, step, up):
        return before.x + _depth_of(before.step) + _APART_MM
    if before.step.going_m is not None:
        return before.x + before.step.going_m.value * _MM
    # Across a landing that turns: as far as its nosing and the next are apart in plan.
    if before.step.line_points is None or step.line_points is None:
        return before.x + _depth_of(before.step)
    way = step.line_points[1] - before.step.line_points[1]
    return before.x + math.sqrt(max(float(way @ way) - float(way @ up) ** 2, 0.0)) * _MM


def _depth_of(step: Step) -> float:
    """Return the depth of a tread as it is drawn, millimetres: its own, else to where its surface was seen."""
    if step.tread_depth_m is not None:
        return min(step.tread_depth_m.value * _MM, _LONGEST_DEPTH_MM)
    front, back = step.corners[:2].mean(axis=0), step.corners[2:].mean(axis=0)
    depth = 0.0 if step.climb is None else float((back - front) @ step.climb) * _MM
    return min(max(depth, 0.0), _LONGEST_DEPTH_MM)


def _profile(before: _Nosing | None, nosing: _Nosing, after: _Nosing | None, up: Floats, text_mm: float) -> list[Part]:
    """Return a tread with its fall, and the riser in front of it where it is known."""
    step = nosing.step
    depth = _depth_of(step)
    parts: list[Part] = []
    if after is not None and after.step.flight != step.flight and is_joined(step, after.step, up):
        # Over a landing the surface goes on to the next riser.
        depth = max(depth, after.x - nosing.x) if step.going_m is not None else after.x - nosing.x
        if step.going_m is None:
            at = (nosing.x + depth / 2.0, nosing.z + 1.2 * text_mm)
            parts.append(Words("landing, turning", at, 0.9 * text_mm, "STAIR-NUMBER"))
    slope = math.tan(math.radians(step.fall_deg.value)) if step.fall_deg is not None else 0.0
    parts.append(Path(((nosing.x, nosing.z), (nosing.x + depth, nosing.z + slope * depth)), "STAIR-NOSING"))
    if step.rise_m is None:
        return parts
    low = nosing.z - step.rise_m.value * _MM
    face = nosing.x
    if before is not None and is_joined(before.step, step, up):
        face = max(nosing.x, min(before.x + _depth_of(before.step), nosing.x + 0.3 * abs(nosing.z - low)))
    else:
        parts.append(Path(((nosing.x - _FLOOR_MM, low), (nosing.x, low)), "STAIR-NOSING"))
    parts.append(Path(((face, low), (face, nosing.z)), "STAIR-OUTLINE"))
    return parts


def _rise(nosing: _Nosing, text_mm: float) -> list[Part]:
    x = nosing.x - 1.0 * text_mm
    if nosing.step.rise_m is None:
        return [Words(f"rise {NOT_MEASURED}", (x, nosing.z - text_mm), 0.8 * text_mm, "STAIR-NOT-MEASURED", "end")]
    low = nosing.z - nosing.step.rise_m.value * _MM
    return [Dimension((nosing.x, low), (nosing.x, nosing.z), 90.0, (x, nosing.z), "STAIR-DIM-RISE")]


def _going(nosing: _Nosing, after: _Nosing | None, base: float, text_mm: float, *, is_expected: bool) -> list[Part]:
    step, start = nosing.step, (nosing.x, nosing.z)
    if step.going_m is not None:
        end = (nosing.x + step.going_m.value * _MM, nosing.z if after is None else after.z)
        return [Dimension(start, end, 0.0, (nosing.x, base), "STAIR-DIM-GOING")]
    if not is_expected:
        return []
    end_x = nosing.x + _depth_of(step) if after is None else after.x
    words = NOT_MEASURED if end_x - nosing.x > 8.0 * text_mm else "n. m."
    return [Words(words, ((nosing.x + end_x) / 2.0, base + 0.8 * text_mm), 0.8 * text_mm, "STAIR-NOT-MEASURED")]


def _labels(nosing: _Nosing, after: _Nosing | None, base: float, foot: float, text_mm: float) -> list[Part]:
    """Return the step's number below the chain of goings, and the height of its nosing below that."""
    end_x = nosing.x + _depth_of(nosing.step) if after is None else after.x
    middle = (nosing.x + end_x) / 2.0
    number = (min(middle, nosing.x + 6.0 * text_mm), base - 2.2 * text_mm)
    height = f"+{tidy(nosing.z - foot, 1):.1f}"
    return [
        Circle(number, 1.15 * text_mm, "STAIR-NUMBER"),
        Words(str(nosing.step.step_id), number, text_mm, "STAIR-NUMBER"),
        Words(height, (number[0], base - 4.2 * text_mm), 0.9 * text_mm, "STAIR-HEIGHT", "end", 90.0),
    ]


def _pitches(inspection: Inspection, placed: Sequence[_Nosing], text_mm: float) -> list[Part]:
    parts: list[Part] = []
    for flight in inspection.flights:
        own = [nosing for nosing in placed if nosing.step.flight == flight.flight_id]
        if len(own) == len(flight.step_ids):
            parts += _pitch(inspection, flight, own, text_mm)
    return parts


def _pitch(inspection: Inspection, flight: Flight, own: Sequence[_Nosing], text_mm: float) -> list[Part]:
    """Return the flight's best-fit line through its nosings, drawn above them, and its angle in words."""
    line = nosing_line(inspection, flight)
    if line is None or flight.pitch_deg is None:
        return []
    slope = math.tan(math.radians(line.pitch_deg))
    mean_x = sum(nosing.x for nosing in own) / len(own)
    mean_z = sum(nosing.z for nosing in own) / len(own)
    ends = [(x, mean_z + slope * (x - mean_x)) for x in (own[0].x, own[-1].x)]
    words = f"flight {flight.flight_id}: pitch {flight.pitch_deg.value:.1f}° ± {u_text(flight.pitch_deg.u)}°"
    rise = own[0].step.rise_m.value * _MM if own[0].step.rise_m is not None else 0.0
    lift = rise + 2.2 * text_mm
    at = (
        mean_x - math.sin(math.radians(line.pitch_deg)) * lift,
        mean_z + math.cos(math.radians(line.pitch_deg)) * lift,
    )
    return [
        Path(tuple(ends), "STAIR-PITCH"),
        Words(words, at, text_mm, "STAIR-PITCH", turn_deg=line.pitch_deg),
    ]


def _up(first: _Nosing, foot: float, text_mm: float) -> list[Part]:
    x = first.x - _FLOOR_MM
    rise = first.step.rise_m.value * _MM if first.step.rise_m is not None else 0.0
    z = foot + rise + 4.0 * text_mm
    return [
        Arrow((x, z), (x + 6.0 * text_mm, z), 1.4 * text_mm, "STAIR-WALKING-LINE"),
        Words("UP", (x + 2.6 * text_mm, z + 1.1 * text_mm), text_mm, "STAIR-WALKING-LINE"),
    ]
