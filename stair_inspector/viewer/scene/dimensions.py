"""The dimensions of one step as plain lines and labels: what was measured, where, and how large it is."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from stair_inspector.geometry.arrays import Floats
from stair_inspector.model import Inspection, Measured, Step
from stair_inspector.units import Unit, measured_text

Anchor = Literal["bottom-left", "bottom-right", "top-left", "top-right"]
"""The corner of a label that lies at its place: four labels with four anchors stay apart at every distance."""

_ABOVE_M = 0.03
"""Distance of a dimension from what it measures, beyond the lift over the points."""
_WIDTH_AHEAD_M = 0.09
"""The width is drawn before the nosing, farther out than the rise."""
_ASIDE_M = 0.06
"""Distance of the tread depth from the going, beside each other on the tread."""
_TO_LABEL_M = 0.02
_HEAD_M = 0.03
_HEAD_SHARE = 0.25
_HEAD_SLOPE = 0.35
"""Length of an arrow's head, at most so much of a short arrow; half its width as a share of its length."""
_OVERSHOOT = 1.15
"""An extension line ends beyond its arrow."""


@dataclass(frozen=True, slots=True, eq=False)
class Label:
    """A text at a place (3,), local metres."""

    text: str
    position: Floats
    anchor: Anchor


@dataclass(frozen=True, slots=True, eq=False)
class Dimensions:
    """The dimensions of one step, local metres.

    ``measuring`` (m, 2, 3) are the lines on which rise and going were measured; ``arrows`` (a, 2, 3) the dimension
    lines with their heads and extension lines; ``labels`` what they say.
    """

    measuring: Floats
    arrows: Floats
    labels: tuple[Label, ...]


@dataclass(frozen=True, slots=True, eq=False)
class _Frame:
    """The step's own directions, unit vectors (3,): up, the climb, and the left of someone who climbs."""

    up: Floats
    climb: Floats
    left: Floats


def dimensions_of(inspection: Inspection, step: Step, lift_m: float, unit: Unit = "mm") -> Dimensions:
    """Return the measuring lines, dimension arrows and labels of a step.

    Parameters
    ----------
    inspection : Inspection
        Its up direction is used.
    step : Step
        What has not been measured is not drawn; a step without a nosing line or a climb has no dimensions at all.
    lift_m : float
        Distance of every line from the surface that it lies on, so that the points do not cover it.
    unit : {"mm", "in"}
        In which the labels give the lengths.

    Returns
    -------
    Dimensions
        Going and depth lie above the tread, the rise and the width before the nosing. Each arrow is as long as the
        value that it shows; going, depth and rise are those of the centre line.
    """
    if step.nosing is None or step.climb is None:
        return Dimensions(np.zeros((0, 2, 3)), np.zeros((0, 2, 3)), ())
    up = inspection.up.vector
    frame = _Frame(up, step.climb, np.cross(up, step.climb))
    centre = step.line_points[1] if step.line_points is not None else step.nosing.mean(axis=0)
    over, ahead = (lift_m + _ABOVE_M) * frame.up, -(lift_m + _ABOVE_M) * frame.climb
    arrows: list[tuple[Floats, Floats]] = []
    labels: list[Label] = []

    def add(name: str, value: Measured | None, start: Floats, along: Floats, offset: Floats, anchor: Anchor) -> None:
        """Add a dimension; its label is held at the corner ``anchor`` and runs the other way."""
        if value is None:
            return
        end = start + value.value * along
        arrows.extend(_arrow(start, end, offset, frame))
        # The label of the width would hide the rise's arrow: it stands at the left end.
        place = (end if along is frame.left else (start + end) / 2.0) + offset
        place += (_TO_LABEL_M if anchor.endswith("right") else -_TO_LABEL_M) * frame.left
        labels.append(Label(f"{name} {measured_text(value, unit)}", place, anchor))

    aside = -_ASIDE_M * frame.left
    add("going", step.going_m, centre, frame.climb, over, "bottom-right")
    add("tread depth", step.tread_depth_m, centre + aside, frame.climb, over, "bottom-left")
    add("rise", step.rise_m, centre, -frame.up, ahead, "top-left")
    half = (step.width_m.value if step.width_m is not None else 0.0) / 2.0
    before = -(lift_m + _WIDTH_AHEAD_M) * frame.climb
    add("width", step.width_m, step.nosing.mean(axis=0) - half * frame.left, frame.left, before, "top-right")
    return Dimensions(_measuring_lines(step, frame, lift_m), _segments(arrows), tuple(labels))


def _measuring_lines(step: Step, frame: _Frame, lift_m: float) -> Floats:
    """Return the lines (m, 2, 3) on which the going and the rise were measured, left, centre and right."""
    lines: list[tuple[Floats, Floats]] = []
    nothing = (None, None, None)
    if step.line_points is not None:
        for point, going_m, rise_m in zip(
            step.line_points, step.going_lcr_m or nothing, step.rise_lcr_m or nothing, strict=True
        ):
            over, ahead = point + lift_m * frame.up, point - lift_m * frame.climb
            if going_m is not None:
                lines.append((over, over + going_m * frame.climb))
            if rise_m is not None:
                lines.append((ahead, ahead - rise_m * frame.up))
    return _segments(lines)


def _arrow(start: Floats, end: Floats, offset: Floats, frame: _Frame) -> list[tuple[Floats, Floats]]:
    """Return a dimension line beside what it measures, with a head at both ends and two extension lines."""
    first, last = start + offset, end + offset
    length = float(np.linalg.norm(last - first))
    lines = [(first, last), (start, start + _OVERSHOOT * offset), (end, end + _OVERSHOOT * offset)]
    if length == 0.0:
        return lines
    along = (last - first) / length
    head_m = min(_HEAD_M, _HEAD_SHARE * length)
    for tip, inwards in ((first, along), (last, -along)):
        for across in (frame.up, frame.climb, frame.left):
            # Barbs in both planes through the arrow: it is seen from every side.
            if abs(float(across @ along)) < 0.5:
                lines += [(tip, tip + head_m * (inwards + sign * _HEAD_SLOPE * across)) for sign in (1.0, -1.0)]
    return lines


def _segments(lines: list[tuple[Floats, Floats]]) -> Floats:
    return np.array(lines, dtype=np.float64).reshape(-1, 2, 3)
