"""One row for each step as CSV."""

import csv
import dataclasses
import io
from typing import Any

from stair_inspector.content.records import LINES, values_on_lines
from stair_inspector.model import (
    SURVEY_VALUES,
    Inspection,
    Measured,
    PaperValues,
    Step,
)


def csv_bytes(inspection: Inspection) -> bytes:
    """Return one row per step, lengths in millimetres and angles in degrees, the unit in each column's name."""
    rows = [_step_to_row(step) for step in inspection.steps]
    stream = io.StringIO(newline="")
    writer = csv.DictWriter(stream, CSV_COLUMNS, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return stream.getvalue().encode("utf-8")


def _step_to_row(step: Step) -> dict[str, Any]:
    """Return a step's cells by column, lengths turned from metres to millimetres."""
    values: list[Any] = [step.step_id, step.flight, step.kind, step.plane.n_points, step.plane.rms_m]
    values += dataclasses.astuple(step.paper)
    for name in SURVEY_VALUES:
        measured: Measured | None = getattr(step, name)
        values += [None, None] if measured is None else [measured.value, measured.u]
    values += [step.coverage, *values_on_lines(step.rise_lcr_m), *values_on_lines(step.going_lcr_m)]
    return {
        _column(name): _millimetres(value) if name.endswith("_m") else value
        for name, value in zip(_QUANTITIES, values, strict=True)
    }


def _column(name: str) -> str:
    """Return a quantity's name in the table's unit: millimetres for metres."""
    return name.removesuffix("_m") + "_mm" if name.endswith("_m") else name


def _millimetres(value_m: float | None) -> float | None:
    # Nanometres are enough, and keep 0.1 m from becoming 100.00000000000001 mm.
    return None if value_m is None else round(value_m * 1000.0, 6)


def _with_uncertainty(name: str) -> tuple[str, str]:
    stem, unit = name.rsplit("_", 1)
    return name, f"{stem}_u_{unit}"


_QUANTITIES = (
    *("step", "flight", "kind", "n_points", "rms_m"),
    *(f"paper_{item.name}" for item in dataclasses.fields(PaperValues)),
    *(column for name in SURVEY_VALUES for column in _with_uncertainty(name)),
    "coverage",
    *(f"{quantity}_{line}_m" for quantity in ("rise", "going") for line in LINES),
)


CSV_COLUMNS = [_column(name) for name in _QUANTITIES]
"""Names of the CSV's columns, in order."""
