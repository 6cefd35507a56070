"""The files of a comparison of two scans, JSON and CSV, and its table on a terminal."""

import csv
import io
import json
from typing import Any

from stair_inspector.content.cells import millimetres
from stair_inspector.content.comparisons import changes_table, comparison_to_dict
from stair_inspector.model import Measured, ScanComparison, ValueChange
from stair_inspector.quantities import quantity_of
from stair_inspector.writers.text import aligned


def comparison_json_bytes(found: ScanComparison) -> bytes:
    """Return a comparison as JSON, schema ``stair-inspector/comparison-1``."""
    text = json.dumps(comparison_to_dict(found), indent=1, ensure_ascii=False, allow_nan=False)
    return (text + "\n").encode("utf-8", errors="backslashreplace")


def comparison_csv_bytes(found: ScanComparison) -> bytes:
    """Return one row per step, lengths in millimetres and angles in degrees, the unit in each column's name."""
    stream = io.StringIO(newline="")
    writer = csv.writer(stream, lineterminator="\n")
    columns = ["step_before", "step_after", "kind"]
    for value in (*found.steps[0].values, found.steps[0].height):
        name, unit = _name_and_unit(value)
        columns += [f"{name}_{what}_{unit}" for what in ("before", "after", "change", "change_u")]
        columns.append(f"{name}_is_changed")
    writer.writerow([*columns, "worst_place_mm", "worst_place_u_mm", "coverage"])
    for step in found.steps:
        row: list[Any] = [step.before_id, step.after_id, step.kind]
        for value in (*step.values, step.height):
            row += _cells(value)
        worst = None if step.deviations is None else step.deviations.worst_m
        row += [None, None] if worst is None else [millimetres(worst.value), millimetres(worst.u)]
        writer.writerow([*row, None if step.deviations is None else step.deviations.coverage])
    return stream.getvalue().encode("utf-8")


def comparison_text(found: ScanComparison) -> str:
    """Return a comparison as text: what was laid onto what, a row per step, and what changed in words."""
    table = changes_table(found)
    alignment = found.alignment
    lines = [
        f"{found.before.name} -> {found.after.name}: {len(found.steps)} steps in both; laid onto each other with U of "
        f"a height of {1000.0 * alignment.u_m:.2f} mm",
        *(f"  {line}" for line in aligned(table)),
        *(f"  {note.message}" for note in found.notes),
        f"  {table.note}",
    ]
    return "\n".join(lines)


def comparison_files(found: ScanComparison) -> dict[str, bytes]:
    """Return ``_comparison.json`` and ``.csv`` by what is added to the stems of both scans."""
    return {"_comparison.json": comparison_json_bytes(found), "_comparison.csv": comparison_csv_bytes(found)}


def _name_and_unit(value: ValueChange) -> tuple[str, str]:
    unit = "m" if value.quantity == "height" else quantity_of(value.quantity).unit
    return value.quantity, "mm" if unit == "m" else unit


def _cells(value: ValueChange) -> list[Any]:
    _, unit = _name_and_unit(value)

    def number(measured: Measured | None, figure: str) -> float | None:
        found = None if measured is None else float(getattr(measured, figure))
        return millimetres(found) if unit == "mm" else found

    return [
        number(value.before, "value"),
        number(value.after, "value"),
        number(value.change, "value"),
        number(value.change, "u"),
        value.is_changed,
    ]
