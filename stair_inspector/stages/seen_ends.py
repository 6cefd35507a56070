"""Which edges that seem to be the rim of a shadow are real ends? Those beyond which a station looked through."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from stair_inspector.geometry.arrays import Floats
from stair_inspector.geometry.edges import EdgeLine
from stair_inspector.geometry.plan import left_of
from stair_inspector.geometry.sight import ABOUT_M, Looks, Sight
from stair_inspector.model import StepShape

_BEYOND_M = (0.008, 0.014, 0.02, 0.03, 0.045, 0.065, 0.09)
"""How far beyond an edge the lines lie on which it is looked for; then one every so often as the last two lie apart."""
_MOST_OPEN_M = 0.03
"""Where it is not seen through nearer than this, more of the tread may lie in shadow."""
_N_ALONG = 12
_LEAST_REACH_M, _MOST_REACH_M = 0.1, 1.5
_OF_DEPTH = (0.1, 0.6)
"""Part of a tread's depth along which its sides are looked at: behind, the next nosing casts its shadow."""
_OF_WIDTH = (0.1, 0.9)
_FREE_ABOVE = (0.6, 1.0, 1.4), (0.35, 0.7, 1.2)
_FREE_BELOW = (-0.3, -0.6, -0.9), (-1.35, -1.6)
"""Where nothing is if a flight ends: so many goings ahead of its last nosing, so many rises above it. A riser would
stand before the places above, a tread lie over those below."""
_IN_SHADOW = 0.25
"""Share of these places in the shadow of one thing that leaves open what is there."""
_FREE_ACROSS = (-0.7, -0.35, 0.0, 0.35, 0.7)


def strip_beside(
    edge: EdgeLine, along: tuple[float, float], reach_m: float, to_level: Callable[[float, float], Floats], sign: float
) -> tuple[Floats, Floats]:
    """Return places (lines, places, 3) on the plane of a step beyond an edge, and how far beyond (lines,) they lie.

    ``to_level`` turns ``out`` and ``along`` of the edge into a place of the level frame; ``sign`` is where out lies.
    """
    step_m = _BEYOND_M[-1] - _BEYOND_M[-2]
    more = np.arange(_BEYOND_M[-1] + step_m, min(max(reach_m, _LEAST_REACH_M), _MOST_REACH_M), step_m)
    beyond_m = np.array([*_BEYOND_M, *more])
    places = np.linspace(*along, _N_ALONG)
    strip = [[to_level(edge.at(place) + sign * off, place) for place in places] for off in beyond_m]
    return np.array(strip), beyond_m


def open_beyond(strip: Floats, beyond_m: Floats, sight: Sight) -> float | None:
    """Return from how far beyond an edge on everything was looked through, None where too much was not."""
    is_through = sight.look(strip.reshape(-1, 3)).is_through.reshape(strip.shape[:2])
    is_free = is_through.mean(axis=1) >= 0.8
    # The last line that was not: behind it all are free.
    first = len(is_free) - int(np.argmin(is_free[::-1])) if not is_free.all() else 0
    if first == len(is_free) or beyond_m[first] > _MOST_OPEN_M:
        return None
    return float(beyond_m[first])


def with_seen_fronts(before: Sequence[StepShape], doubted: Sequence[StepShape], sight: Sight) -> list[StepShape]:
    """Believe the nosings that were doubted (:func:`~stair_inspector.stages.hidden.with_doubtful_fronts`) but end free.

    Parameters
    ----------
    before, doubted
        The steps of a flight, before and after their nosings were held against where they should lie.
    sight : Sight
        Of the same scan.
    """
    return [
        replace(after, front=_believed(shape, after.front, shape.front, -1.0, _LEAST_REACH_M, sight))
        for shape, after in zip(before, doubted, strict=True)
    ]


def with_seen_sides(
    before: Sequence[StepShape], doubted: Sequence[StepShape], climb: Floats, sight: Sight
) -> list[StepShape]:
    """Do the same with the sides of a straight flight (:func:`~stair_inspector.stages.hidden.with_common_sides`)."""
    across = left_of(climb)
    outmost_m = {
        sign: max(sign * float(shape.origin_m @ across) + sign * _side(shape, sign).middle_m for shape in before)
        for sign in (1.0, -1.0)
    }
    result = []
    for shape, after in zip(before, doubted, strict=True):
        origin_m = float(shape.origin_m @ across)
        low, high = after.line_range
        sides = []
        for sign in (1.0, -1.0):
            found = _side(shape, sign)
            reach_m = outmost_m[sign] - sign * (origin_m + found.middle_m)
            believed = _believed(shape, _side(after, sign), found, sign, reach_m, sight)
            sides.append(believed)
            if believed is not _side(after, sign):
                low, high = (low, shape.line_range[1]) if sign > 0.0 else (shape.line_range[0], high)
        result.append(replace(after, left=sides[0], right=sides[1], line_range=(low, high)))
    return result


def _side(shape: StepShape, sign: float) -> EdgeLine:
    return shape.left if sign > 0.0 else shape.right


def _believed(
    shape: StepShape, doubted: EdgeLine, found: EdgeLine, sign: float, reach_m: float, sight: Sight
) -> EdgeLine:
    """Return an edge as it was found where it ends free, else as it was doubted."""
    is_guess = not found.support and not found.obstructed_m
    if doubted.support or doubted.source != "tread" or is_guess:
        return doubted
    strip, beyond_m = strip_of(shape, found, sign, reach_m)
    open_m = open_beyond(strip, beyond_m, sight)
    if open_m is None:
        return doubted
    # Up to there it may reach in shadow.
    noise_m = math.hypot(found.free_noise_m, open_m / math.sqrt(12.0))
    return replace(found, noise_m=noise_m, support=1.0, obstructed_m=0.0)


def strip_of(shape: StepShape, edge: EdgeLine, sign: float, reach_m: float) -> tuple[Floats, Floats]:
    """Return the places beyond an edge of a step, as :func:`strip_beside`: a side of it, or its front."""
    if edge in (shape.left, shape.right):
        s_low, s_high = shape.front.middle_m, shape.extent[1]
        along = tuple(s_low + share * (s_high - s_low) for share in _OF_DEPTH)
    else:
        low, high = shape.extent[2:]
        along = tuple(low + share * (high - low) for share in _OF_WIDTH)

    def to_level(out: float, place: float) -> Floats:
        s, w = (place, out) if edge in (shape.left, shape.right) else (out, place)
        return np.array([*shape.to_plan(s, w), shape.plane.at(s, w)])

    return strip_beside(edge, (along[0], along[1]), reach_m, to_level, sign)


def look_past(
    frame_at: Callable[[float], tuple[Floats, Floats]],
    size: tuple[float, float, float, float],
    is_above: bool,
    sight: Sight,
) -> Looks:
    """Return what stations make of the places that the next step of a flight would hide.

    Parameters
    ----------
    frame_at : callable
        Returns the place (2,) so far ahead of the flight's last nosing, and the climb there, plan of the level frame.
    size : (height, rise, going, half_width)
        Height of that nosing, and the usual rise, going and half the width of the flight, metres.
    is_above : bool
        Whether it is the flight's upper end.
    sight : Sight
        Of the level frame.
    """
    height_m, rise_m, going_m, half_m = size
    aheads, rises = _FREE_ABOVE if is_above else _FREE_BELOW
    places = []
    for ahead in aheads:
        middle, climb = frame_at(ahead * going_m)
        for share in _FREE_ACROSS:
            plan = middle + share * half_m * left_of(climb)
            places += [[*plan, height_m + rise * rise_m] for rise in rises]
    return sight.look(np.array(places), ABOUT_M)


def shadow_past(looks: Looks | None, sight: Sight | None) -> str:
    """Return in whose shadow places lie that were not looked through, behind a comma; '' where nothing is known."""
    words = "" if looks is None or sight is None else sight.words(looks, _IN_SHADOW)
    return f", {words}" if words else ""
