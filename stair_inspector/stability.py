"""Does a value hang on a setting? What moves by more than its own u within one notch of a slider is marked."""

import dataclasses
from collections.abc import Iterator

import numpy as np

from stair_inspector.errors import StairError
from stair_inspector.memo import Memo
from stair_inspector.model import Inspection, Measured, Note, Scan, Step
from stair_inspector.params import SETTINGS, Params
from stair_inspector.pipeline import inspect
from stair_inspector.quantities import IN_FILES, quantity_of
from stair_inspector.quantity_types import Quantity

CODE = "unsettled"
"""Of the note on a step that names a value which moves."""
_SAME_STEP_M = 0.1
"""Centroids of one step are nearer than this whatever moves; those of two steps are a going apart."""


def mark_unsettled(scan: Scan, params: Params, inspection: Inspection, memo: Memo | None = None) -> Inspection:
    """Note every value that moves by more than its own u within one notch of a slider.

    Parameters
    ----------
    scan : Scan
        What was measured.
    params : Params
        With which it was.
    inspection : Inspection
        The result; by the survey's method.
    memo : Memo, optional
        That of the result, so that normals and up are not found again.

    Returns
    -------
    Inspection
        The same one where all is settled; else with a note for each such value, with the number of its step.

    Notes
    -----
    Two runs for each setting that is declared to be tried: of the segmentation, whose notches cost no new normals.
    """
    if params.method != "survey" or inspection.is_withheld:
        return inspection
    memo = memo or Memo()
    largest: dict[tuple[int, str], tuple[float, str]] = {}
    for changed, words in _notches(params):
        try:
            found = inspect(scan, changed, memo)
        except StairError:
            found = None
        for step in inspection.steps:
            other = None if found is None else _same_step(step, found)
            for quantity in IN_FILES:
                moved = _moved(quantity.of(step), None if other is None else quantity.of(other))
                if moved > largest.get((step.step_id, quantity.name), (0.0, ""))[0]:
                    largest[step.step_id, quantity.name] = moved, words
    notes = [
        Note(CODE, "stability", _sentence(step_id, quantity_of(name), moved, words), step_id)
        for (step_id, name), (moved, words) in sorted(largest.items())
    ]
    return dataclasses.replace(inspection, notes=(*inspection.notes, *notes)) if notes else inspection


def words_about(inspection: Inspection, step_id: int, quantity: Quantity) -> str:
    """Return what is said of a value that hangs on the settings; empty of one that does not."""
    start = _subject(step_id, quantity)
    told = (note.message for note in inspection.notes if note.code == CODE and note.step == step_id)
    return next((message for message in told if message.startswith(start)), "")


def _notches(params: Params) -> Iterator[tuple[Params, str]]:
    """Yield the settings one notch of a slider to each side, and what was changed, in words."""
    for name in SETTINGS.tried():
        knob = SETTINGS.knob(name)
        kind = SETTINGS[name].kind
        for sign in (-1, 1):
            value = kind(round(params.value(name) + sign * knob.step, 9))
            if knob.low <= value <= knob.high:
                yield (
                    params.replaced(name, value),
                    f"{knob.symbol} is {knob.words(value)}",
                )


def _same_step(step: Step, found: Inspection) -> Step | None:
    gaps = [float(np.linalg.norm(each.plane.centroid - step.plane.centroid)) for each in found.steps]
    return found.steps[int(np.argmin(gaps))] if gaps and min(gaps) <= _SAME_STEP_M else None


def _moved(value: Measured | None, other: Measured | None) -> float:
    """Return how far a value moves if that is more than its u, infinity where it is lost, else 0."""
    if value is None:
        return 0.0
    if other is None:
        return float("inf")
    moved = abs(other.value - value.value)
    return moved if moved > value.u else 0.0


def _sentence(step_id: int, quantity: Quantity, moved: float, words: str) -> str:
    what = f"{_subject(step_id, quantity)} the settings"
    if moved == float("inf"):
        return f"{what}: it is not measured where {words}"
    size = f"{moved * 1000.0:.1f} mm" if quantity.unit == "m" else f"{moved:.2f}°"
    return f"{what}: it moves by {size}, more than its u, where {words}"


def _subject(step_id: int, quantity: Quantity) -> str:
    return f"the {quantity.label} of step {step_id} hangs on"
