"""What was not observed of a step, and why is a value missing?"""

from collections.abc import Sequence

import numpy as np

from stair_inspector.geometry.edges import EdgeLine
from stair_inspector.geometry.sight import ABOUT_M, Sight
from stair_inspector.model import Chain, Note, Step, StepShape
from stair_inspector.stages.seen_ends import strip_of

_RIM_M, _SHADOW_M = 0.04, 0.15
"""From where to where beyond a rim it is told of what it is the rim."""
_OF_GAP = (0.25, 0.5, 0.75)


def notes_of_unobserved(
    chain: Chain, shapes: tuple[StepShape, ...], steps: Sequence[Step], sight: Sight | None = None
) -> list[Note]:
    """Say of every step what was not observed, and why a value is null; with ``sight`` what was in the way."""
    notes = []
    for k, (shape, step) in enumerate(zip(shapes, steps, strict=True)):
        here = step.step_id
        if chain.n_missing[k]:
            count = chain.n_missing[k]
            text = "a tread is" if count == 1 else f"{count} treads are"
            below, lost = f"step {here - 1}", f"neither the rise to step {here} nor the going of step {here - 1} is"
            if k == 0:
                below, lost = "the floor or landing", f"the rise to step {here} is not"
            told = "" if k == 0 or sight is None else _of_gap(shapes[k - 1], shape, count, sight)
            message = f"{text} missing or not seen between {below} and step {here}{told}: {lost} defined"
            notes.append(Note("tread_missing", "survey", message, here))
        elif step.rise_m is None:
            message = f"step {here} has no rise: no floor or landing was seen a riser below it"
            notes.append(Note("rise_unobserved", "survey", message, here))
        if not shape.front.support:
            message = f"the nosing of step {here} was not seen, only the rim of its surface: its place is uncertain"
            message += _of_rim(shape, shape.front, -1.0, sight)
            notes.append(Note("nosing_unobserved", "survey", message, here))
        if shape.back is None and shape.back_limits is not None:
            message = (
                f"the back of step {here} is hidden, as under the nosing above it: its depth is the middle of what is "
                "possible"
            )
            notes.append(Note("back_hidden", "survey", message, here))
        elif shape.back is None:
            notes.append(Note("back_unobserved", "survey", f"the back edge of step {here} was not seen", here))
        if not min(shape.left.support, shape.right.support):
            message = f"a side of step {here} was not seen, or ends inside those of the others: its width is uncertain"
            for side, sign in ((shape.left, 1.0), (shape.right, -1.0)):
                message += "" if side.support else _of_rim(shape, side, sign, sight)
            notes.append(Note("side_unobserved", "survey", message, here))
    return notes


def _of_rim(shape: StepShape, edge: EdgeLine, sign: float, sight: Sight | None) -> str:
    """Return what the stations say of the place beyond a rim, where most of it is in shadow."""
    if sight is None:
        return ""
    strip, beyond_m = strip_of(shape, edge, sign, _SHADOW_M)
    beyond = (beyond_m >= _RIM_M) & (beyond_m <= _SHADOW_M)
    words = sight.words(sight.look(strip[beyond].reshape(-1, 3), ABOUT_M))
    return f"; beyond the rim it lies {words}" if words else ""


def _of_gap(below: StepShape, above: StepShape, count: int, sight: Sight) -> str:
    """Return what the stations say of the places where treads should be between two steps."""
    share = np.arange(1, count + 1) / (count + 1.0)
    low, high = below.extent[2:]
    w = (low + high) / 2.0 + np.linspace(-0.35, 0.35, 5) * (high - low)
    places = []
    start_s = below.front.middle_m
    end_s, _ = below.from_plan(above.to_plan(above.front.middle_m, 0.0))
    rise_m = above.plane.z0_m - below.plane.z0_m
    going_m = (end_s - start_s) / (count + 1.0)
    for part in share:
        for of_going in _OF_GAP:
            s = start_s + part * (end_s - start_s) + of_going * going_m
            places += [[*below.to_plan(s, at), below.plane.z0_m + part * rise_m] for at in w]
    looks = sight.look(np.array(places), ABOUT_M)
    if looks.is_free:
        return " (a station looked through where it should be)"
    words = sight.words(looks)
    return f" (its place lies {words})" if words else ""
