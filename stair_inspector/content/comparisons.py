"""Two scans of one stair, as plain values for JSON and as the table of changes that every medium shows."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from stair_inspector import __version__
from stair_inspector.comparison.words import rests_on, steps_text
from stair_inspector.content.check_records import by_name
from stair_inspector.content.document import Cell, Column, Facts, Number, Table, TablePart, plain, table_of
from stair_inspector.geometry.arrays import Floats
from stair_inspector.model import (
    ComparedScan,
    Measured,
    ScanComparison,
    ScanSummary,
    StepChange,
    TreadDeviations,
    ValueChange,
)
from stair_inspector.quantities import quantity_of
from stair_inspector.quantity_types import NOTATIONS
from stair_inspector.units import measured_text, places_of, shown_in, signed_number, u_text, value_and_u

COMPARISON_SCHEMA = "stair-inspector/comparison-1"
CHANGED = "*"
"""The mark of a value that changed."""
_MICROMETRES = 6
_PART_WORDS = {
    "height": "height",
    "tilt_along": "tilt along the climb",
    "tilt_across": "tilt across it",
    "shift_along": "shift along the climb",
    "shift_across": "shift across it",
    "turn": "turn in plan",
}
"""What the parts of the alignment's uncertainty are called."""


def comparison_to_dict(found: ScanComparison) -> dict[str, Any]:
    """Return a comparison as the plain values of its JSON: SI, positions in the frame of the earlier scan."""
    alignment = found.alignment
    ours, theirs = np.array(found.before.origin_m), np.array(found.after.origin_m)
    return {
        "schema": COMPARISON_SCHEMA,
        "software": {"name": "stair_inspector", "version": __version__},
        "before": _scan_record(found.before),
        "after": _scan_record(found.after),
        "alignment": {
            "turn": alignment.turn.tolist(),
            "shift_m": (ours + alignment.shift_m - alignment.turn @ theirs).tolist(),
            "u_m": alignment.u_m,
            "parts": dict(alignment.parts),
            "steady_steps": list(alignment.steady_ids),
            "is_floor_steady": alignment.is_floor_steady,
        },
        "floor": _value_record(found.floor),
        "steps": [_step_record(step, ours) for step in found.steps],
        **by_name(found, "only_before", "only_after"),
        "notes": [by_name(note, "code", "step", "message") for note in found.notes],
    }


_NOTE = (
    "Later less earlier, ± U (k = 2), the root of the sum of the squares of both. "
    f"{CHANGED} changed: beyond U, and beyond what the largest of so many differences is by chance. Height: of "
    "the tread's middle, laid onto what did not move. Worst place: of three cells or more, against the rest "
    "of the tread; in both: the share of the tread that both scans saw."
)
_NO_STEP = "No step was found in both scans."


def changes_table(found: ScanComparison) -> Table:
    """Return a row for each step: the change of each value with its U, a star where it changed, and of its surface."""
    names = [value.quantity for value in found.steps[0].values]

    def of(place: int) -> TablePart[StepChange]:
        quantity = quantity_of(names[place])
        column = Column(f"Δ {quantity.words}", quantity.notation.unit)
        return column, lambda step: change_text(step.values[place])

    return table_of(
        "changes",
        "Changes",
        found.steps,
        (Column("Step"), lambda step: _numbers(step)),
        *(of(place) for place in range(len(names))),
        (Column("Δ height", "mm"), lambda step: change_text(step.height)),
        (Column("worst place", "mm"), _worst_text),
        (Column("in both", "%", 0), lambda step: None if step.deviations is None else 100.0 * step.deviations.coverage),
        note=_NOTE,
        empty=_NO_STEP,
        tone=lambda step: "close" if step.is_changed else "plain",
    )


def changes_in_numbers(compared: ComparedScan) -> Table:
    """Return the same as :func:`changes_table` in numbers, each with its U beside it, by the numbers of one scan."""
    steps = compared.found.steps

    def of(words: str, change: Callable[[StepChange], ValueChange | None]) -> TablePart[StepChange]:
        known = next((value for value in map(change, steps) if value is not None), None)
        _, unit, digits = _notation("height" if known is None else known.quantity)
        heads = (
            Column(f"Δ {words}", unit, digits, is_difference=True, is_signed=True),
            Column("U", unit, digits, is_u=True),
        )
        return heads, lambda step: _numbers_of(change(step))

    def value(place: int) -> TablePart[StepChange]:
        return of(quantity_of(steps[0].values[place].quantity).label, lambda step: step.values[place])

    return table_of(
        "changes",
        "Changes",
        steps,
        (Column("Step", digits=0), compared.number_of),
        *(value(place) for place in range(len(steps[0].values) if steps else 0)),
        of("height", lambda step: step.height),
        of("worst place", _worst_change),
        (
            Column("in both", "%", 0),
            lambda step: None if step.deviations is None else 100.0 * step.deviations.coverage,
        ),
        note=_NOTE,
        empty=_NO_STEP,
        tone=lambda step: "close" if step.is_changed else "plain",
    )


def alignment_facts(compared: ComparedScan) -> Facts:
    """Return what the two scans were laid onto each other on, and how sure that is."""
    found = compared.found
    alignment = found.alignment
    earlier, later = (f"{plain(scan.name)}, SHA-256 {scan.sha256[:12]}…" for scan in (found.before, found.after))
    parts = [
        f"{_PART_WORDS[name.rpartition('_')[0]]} {u_text(1000.0 * u)} mm"
        if name.endswith("_m")
        else f"{_PART_WORDS[name.rpartition('_')[0]]} {u_text(u)}°"
        for name, u in alignment.parts
    ]
    items = [
        ("Earlier scan", earlier),
        ("Later scan", later),
        ("Laid onto each other on", rests_on(compared)),
        ("U of a height by that", f"{u_text(1000.0 * alignment.u_m)} mm at most, on any step (k = 2)"),
        ("Its parts, U", ", ".join(parts)),
    ]
    floor = found.floor.change
    if floor is not None:
        words = measured_text(floor, "mm").replace("-", "−")
        items.append(("Change of the floor", f"{words}{f' {CHANGED}' if found.floor.is_changed else ''}"))
    for ids, which in ((found.only_before, "earlier"), (found.only_after, "later")):
        if ids:
            items.append((f"In the {which} scan only", steps_text(ids)))
    return Facts("alignment", "Alignment", tuple(items), columns=1)


def change_text(value: ValueChange) -> str | None:
    """Return a change with its sign and U, without a unit, starred where it is one: ``−4.1 ± 0.4 *``.

    What is zero as shown is blank before its U.
    """
    if value.change is None:
        return None
    return _signed(value.change, value.quantity) + (f" {CHANGED}" if value.is_changed else "")


def _signed(change: Measured, quantity: str) -> str:
    unit = shown_in("m" if quantity == "height" else quantity_of(quantity).unit, "mm")
    number, u = value_and_u(change, unit)
    return f"{signed_number(number)} ± {u}".lstrip()


def _notation(quantity: str) -> tuple[float, str, int]:
    """Return the factor from SI, the unit and the decimals of a change."""
    scale, unit, _ = NOTATIONS["m"] if quantity == "height" else quantity_of(quantity).notation
    return scale, unit, 1


def _numbers_of(value: ValueChange | None) -> tuple[Cell, Cell]:
    if value is None or value.change is None:
        return None, None
    scale, _, digits = _notation(value.quantity)
    digits = places_of(scale * value.change.u, digits)
    mark = CHANGED if value.is_changed else ""
    return Number(scale * value.change.value, digits), Number(scale * value.change.u, digits, mark)


def _worst_change(step: StepChange) -> ValueChange | None:
    worst = None if step.deviations is None else step.deviations.worst_m
    return None if worst is None else ValueChange("height", None, None, worst, is_changed=True)


def _worst_text(step: StepChange) -> Cell:
    worst = None if step.deviations is None else step.deviations.worst_m
    return None if worst is None else f"{_signed(worst, 'height')} {CHANGED}"


def _numbers(step: StepChange) -> str:
    return f"{step.before_id}" if step.before_id == step.after_id else f"{step.before_id} / {step.after_id}"


def _scan_record(scan: ScanSummary) -> dict[str, Any]:
    return {"file": scan.name, **by_name(scan, "sha256", "n_points", "n_used", "unit", "origin_m")}


def _step_record(step: StepChange, origin: Floats) -> dict[str, Any]:
    return {
        "before": step.before_id,
        "after": step.after_id,
        **by_name(step, "kind", "is_steady", "is_changed"),
        **{quantity_of(value.quantity).column: _value_record(value) for value in step.values},
        "height_m": _value_record(step.height),
        "deviations": None if step.deviations is None else _map_record(step.deviations, origin),
    }


def _value_record(value: ValueChange) -> dict[str, Any]:
    return {
        "before": _measured_record(value.before),
        "after": _measured_record(value.after),
        "change": _measured_record(value.change),
        "is_changed": value.is_changed,
    }


def _measured_record(measured: Measured | None) -> dict[str, float] | None:
    return None if measured is None else {"value": measured.value, "u": measured.u}


def _map_record(found: TreadDeviations, origin: Floats) -> dict[str, Any]:
    return {
        "cell_m": found.cell_m,
        "corner_m": (found.corner + origin).tolist(),
        "ahead_m": found.ahead.tolist(),
        "aside_m": found.aside.tolist(),
        "normal": found.normal.tolist(),
        "deviation_m": _rows_record(found.deviation_m),
        "u_m": _rows_record(found.u_m),
        "is_local": found.is_local.tolist(),
        "coverage": found.coverage,
        "worst_m": _measured_record(found.worst_m),
    }


def _rows_record(values: Floats) -> list[list[float | None]]:
    """Return the rows of a grid; a micrometre is far below any scan."""
    return [[None if math.isnan(value) else round(value, _MICROMETRES) for value in row] for row in values.tolist()]
