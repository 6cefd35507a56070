"""What changed between two scans, in sentences: flights that settled, treads that tilted, places that are worn."""

import math
from collections.abc import Sequence

from stair_inspector.model import ComparedScan, Measured, Note, ScanComparison, StepChange, ValueChange
from stair_inspector.quantities import quantity_of
from stair_inspector.units import measured_text, shown

_STAGE = "comparison"
LAID_ON = "laid_on"
"""Code of the note on what two scans were laid onto each other on."""


def notes_on(found: ScanComparison, *, is_earlier: bool = True) -> tuple[Note, ...]:
    """Return what is to be told of a comparison, the gravest first, with the numbers of one of the scans."""
    seen = ComparedScan(found, is_earlier)
    notes = [*_moved(seen), *_values(seen, are_tilts=True), *_worn(seen), *_values(seen, are_tilts=False)]
    if not notes:
        notes.append(Note("no_change", _STAGE, "no value changed by more than its uncertainty and chance explain"))
    if found.floor.change is not None and found.floor.is_changed:
        moved = _way(found.floor.change)
        notes.append(Note("floor_moved", _STAGE, f"the floor lies {moved} against the steps that did not move"))
    for ids, which in ((found.only_before, "earlier"), (found.only_after, "later")):
        if ids:
            notes.append(Note("unmatched", _STAGE, f"found in the {which} scan only: {steps_text(ids)}"))
    u = found.alignment.u_m
    notes.append(
        Note(LAID_ON, _STAGE, f"laid onto each other on {rests_on(seen)}; U of a height by that ≤ {1000.0 * u:.2f} mm")
    )
    return tuple(notes)


def rests_on(seen: ComparedScan) -> str:
    """Return what two scans were laid onto each other on: ``the floor and steps 1 to 5``."""
    steady = [seen.number_of(step) for step in seen.found.steps if step.is_steady]
    floor = ["the floor"] if seen.found.alignment.is_floor_steady else []
    return " and ".join([*floor, *([steps_text(steady)] if steady else [])])


def _moved(seen: ComparedScan) -> list[Note]:
    """Return a note for each run of steps that rose or settled alike; a tread that tilted is told as such."""
    runs: list[list[StepChange]] = []
    steps = seen.found.steps
    for before, step in zip((None, *steps), steps, strict=False):
        if not step.height.is_changed:
            continue
        if runs and runs[-1][-1] is before and _is_alike(runs[-1], step):
            runs[-1].append(step)
        else:
            runs.append([step])
    runs = [run for run in runs if len(run) > 1 or not _is_tilted(run[0])]
    notes = []
    for run in runs:
        changes = [step.height.change for step in run if step.height.change is not None]
        mean = math.fsum(change.value for change in changes) / len(changes)
        # The alignment is one error of all of them.
        whole = Measured(mean, max(change.u for change in changes))
        ids = [seen.number_of(step) for step in run]
        verb, as_one = ("lies", "") if len(run) == 1 else ("lie", ", as a whole")
        notes.append(Note("height_changed", _STAGE, f"{steps_text(ids)} {verb} {_way(whole)} than before{as_one}"))
    return notes


def _is_alike(run: Sequence[StepChange], step: StepChange) -> bool:
    one, two = run[0].height.change, step.height.change
    return one is not None and two is not None and abs(one.value - two.value) <= math.hypot(one.u, two.u)


def _is_tilted(step: StepChange) -> bool:
    return any(value.is_changed for value in step.values if _is_tilt(value))


def _is_tilt(value: ValueChange) -> bool:
    """Tell whether a value is a slope of the tread itself, as that of the line to the next nosing is not."""
    quantity = quantity_of(value.quantity)
    return quantity.unit == "deg" and quantity.rests_on == "tread"


def _values(seen: ComparedScan, *, are_tilts: bool) -> list[Note]:
    """Return a note for each value that has changed: of the slopes of the treads, or of the others."""
    notes = []
    for step in seen.found.steps:
        number = seen.number_of(step)
        for value in step.values:
            if not value.is_changed or value.change is None or _is_tilt(value) is not are_tilts:
                continue
            change = (
                measured_text(value.change, "°")
                if are_tilts
                else shown(value.quantity, value.change.value, value.change.u)
            )
            words = f"step {number}: {_name(value.quantity)} changed by {change.replace('-', '−')}"
            notes.append(Note("tilt_changed" if are_tilts else "value_changed", _STAGE, words, number))
    return notes


def _worn(seen: ComparedScan) -> list[Note]:
    notes = []
    for step in seen.found.steps:
        number, found = seen.number_of(step), step.deviations
        if found is None or found.worst_m is None:
            continue
        rows = found.is_local.nonzero()[0]
        area_cm2 = 1e4 * found.cell_m**2 * len(rows)
        where = "along its nosing" if rows.mean() < 1.0 else "on its tread"
        words = f"step {number}: {where} {area_cm2:.0f} cm² lie {_way(found.worst_m)} against the rest of it"
        notes.append(Note("surface_changed", _STAGE, words, number))
    return notes


def _name(quantity: str) -> str:
    return quantity.replace("_", " ")


def _way(change: Measured) -> str:
    """Return a change of height: ``4.0 ± 0.3 mm lower``."""
    size = Measured(abs(change.value), change.u)
    return f"{measured_text(size, 'mm')} {'lower' if change.value < 0.0 else 'higher'}"


def steps_text(ids: Sequence[int]) -> str:
    """Return steps by their numbers: ``step 3``, ``steps 1 to 5 and 8``."""
    runs: list[list[int]] = []
    for number in ids:
        if runs and number == runs[-1][-1] + 1:
            runs[-1].append(number)
        else:
            runs.append([number])
    words = [f"{run[0]}" if len(run) == 1 else f"{run[0]} to {run[-1]}" for run in runs]
    listed = ", ".join(words[:-1]) + (" and " if len(words) > 1 else "") + words[-1] if words else ""
    return f"step{'' if len(ids) == 1 else 's'} {listed}"
