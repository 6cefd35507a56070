"""Why a value of a step is missing, from the notes of the measurement."""

from collections.abc import Sequence

from stair_inspector.model import NO_NOSING, Inspection, Step
from stair_inspector.quantity_types import Quantity, RestsOn

NOT_OBSERVED = "not defined for this step, or not observed"
WITHHELD = "withheld until the question about the scan is answered"
LAST_OF_FLIGHT = "the last step of its flight has none"
_TREAD_MISSING = "tread_missing"


def why_missing(inspection: Inspection, step: Step, quantity: Quantity) -> str:
    """Return why a quantity of a step is missing."""
    return notes_on_missing(inspection, step, quantity.rests_on, quantity.note_words)


def notes_on_missing(inspection: Inspection, step: Step, rests_on: RestsOn, words: Sequence[str]) -> str:
    """Return the notes that speak of a value with one of these words, and never one about another quantity."""
    if inspection.is_withheld:
        return WITHHELD
    from_here_up = rests_on in ("to_next", "both")
    from_below = rests_on in ("from_below", "both")
    about = []
    for note in inspection.notes:
        if note.code == _TREAD_MISSING:
            # It is told of the step above the gap, whose rise it takes, with the going of the step below.
            concerns = (from_here_up and note.step == step.step_id + 1) or (from_below and note.step == step.step_id)
        elif note.code in NO_NOSING:
            # An edge that is none takes its step's values, the going up to it and the rise over it.
            low, high = step.step_id - from_below, step.step_id + from_here_up
            concerns = note.step is not None and low <= note.step <= high
        else:
            concerns = note.step == step.step_id and any(word in note.code or word in note.message for word in words)
        about += [note.message] if concerns else []
    if not about and from_here_up and any(flight.step_ids[-1:] == (step.step_id,) for flight in inspection.flights):
        return LAST_OF_FLIGHT
    return "; ".join(about) or NOT_OBSERVED
