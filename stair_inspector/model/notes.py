"""What is said about a scan or a result beside its numbers."""

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True, slots=True)
class Note:
    """Something the user should know about a result: a stable code, the stage, the step it concerns, a sentence."""

    code: str
    stage: str
    message: str
    step: int | None = None


IMPOSSIBLE, BLURRED = "step_impossible", "step_blurred"
CUT_SIDES, CUT_BACK, CUT_FRONT = "region_cuts", "region_cuts_back", "region_cuts_front"
"""Codes of the notes on a step that the region of interest, or the box of the file that was read, cuts through."""


NO_NOSING = (IMPOSSIBLE, BLURRED, CUT_FRONT)
"""Codes of the notes on a step whose nosing gives no values: neither its own, nor the going up to it, nor the rise over
it. The first says that no staircase has what was found, the second that a camera saw it too badly, the third that it
was cut off."""


@dataclass(frozen=True, slots=True)
class Observation:
    """Something that was found about a scan before it was believed.

    ``level``: ``info`` changes nothing; ``doubt`` is in every ``u`` or concerns what may be wrong; a ``question`` has
    two answers that both fit, and the numbers hang on it, so no value and no verdict is given until it is answered.
    ``size_m`` is how large it is, metres, where that has a meaning. ``cure`` says what to do about it: a flag, as
    ``--unit in``, or a sentence.
    """

    code: str
    level: Literal["info", "doubt", "question"]
    message: str
    size_m: float | None = None
    cure: str = ""
