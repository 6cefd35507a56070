"""Is a value given at all? Not before what it hangs on has been answered."""

import dataclasses
from typing import Any, TypeVar

from stair_inspector.model import Flight, Inspection, Measured, Note, PaperValues, Statistics, Step

_Part = TypeVar("_Part", Step, Flight)
CODE = "withheld"
"""Of the note that says why there are no values."""
ANSWERED_BY = "; it is answered by: "
"""How the note goes on for those who have a command line."""


def withhold(inspection: Inspection) -> Inspection:
    """Take the values out of a survey on whose scan a question is open.

    Parameters
    ----------
    inspection : Inspection
        Measured by the survey.

    Returns
    -------
    Inspection
        The same one where nothing is asked. Otherwise steps and flights keep what is drawn of them, their outlines and
        nosings, and have no value: of the survey, on its lines, of the paper, nor the RMS of a plane. A note for each
        question says so, and what answers it.
    """
    if not inspection.is_withheld:
        return inspection
    notes = [Note(CODE, "withhold", _sentence(asked.message, asked.cure)) for asked in inspection.questions]
    return dataclasses.replace(
        inspection,
        steps=tuple(_emptied_step(step) for step in inspection.steps),
        flights=tuple(_without_values(flight) for flight in inspection.flights),
        floor=None if inspection.floor is None else dataclasses.replace(inspection.floor, rms_m=None),
        floor_h_m=None,
        notes=(*notes, *inspection.notes),
    )


def _emptied_step(step: Step) -> Step:
    # Without the points of the measuring lines nothing can be dimensioned in a drawing either.
    return dataclasses.replace(
        _without_values(step),
        plane=dataclasses.replace(step.plane, rms_m=None),
        paper=PaperValues(),
        coverage=None,
        rise_lcr_m=None,
        going_lcr_m=None,
        line_points=None,
        climb=None,
    )


def _without_values(part: _Part) -> _Part:
    """Return a step or a flight without anything that was measured of it, whatever its name."""
    names = [item.name for item in dataclasses.fields(part)]
    measured = [name for name in names if isinstance(getattr(part, name), (Measured, Statistics))]
    nothing: dict[str, Any] = dict.fromkeys(measured)
    return dataclasses.replace(part, **nothing)


def _sentence(message: str, cure: str) -> str:
    answer = f"{ANSWERED_BY}{cure}" if cure else ""
    return f"no value is given and nothing is judged before this question about the scan is answered: {message}{answer}"
