"""One row for each step as CSV."""

import csv
import io
from collections.abc import Iterable
from typing import Any

from stair_inspector.content.cells import millimetres
from stair_inspector.model import Inspection, Step
from stair_inspector.quantities import IN_FILES, ON_LINES, PAPER_QUANTITIES, with_above
from stair_inspector.quantity_types import LINES


def csv_bytes(inspection: Inspection) -> bytes:
    """Return one row per step, lengths in millimetres and angles in degrees, the unit in each column's name."""
    stream = io.StringIO(newline="")
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(CSV_COLUMNS)
    writer.writerows(csv_rows(inspection))
    return stream.getvalue().encode("utf-8")


def csv_rows(inspection: Inspection) -> Iterable[list[Any]]:
    """Yield the cells of every step, from the bottom to the top, in the order of :data:`CSV_COLUMNS`."""
    return (_row_of(step, above) for step, above in with_above(inspection.steps))


def _row_of(step: Step, above: Step | None) -> list[Any]:
    """Return a step's cells in the order of the columns, lengths turned from metres to millimetres."""
    values: list[Any] = [step.step_id, step.flight, step.kind, step.plane.n_points, step.plane.rms_m]
    values += [quantity.of_paper(step.paper) for quantity in PAPER_QUANTITIES]
    for quantity in IN_FILES:
        measured = quantity.of(step, above)
        values += [None, None] if measured is None else [measured.value, measured.u]
    values.append(step.coverage)
    for quantity in ON_LINES:
        values += quantity.lines_of(step)
    return [
        millimetres(value) if name.endswith("_m") else value for name, value in zip(_SI_COLUMNS, values, strict=True)
    ]


def csv_column(name: str) -> str:
    """Return a column's name in the table's unit: ``rise_mm`` for ``rise_m``."""
    return name.removesuffix("_m") + "_mm" if name.endswith("_m") else name


_SI_COLUMNS = (
    *("step", "flight", "kind", "n_points", "rms_m"),
    *(f"paper_{quantity.column}" for quantity in PAPER_QUANTITIES),
    *(column for each in IN_FILES for column in (each.column, f"{each.name}_u_{each.unit}")),
    "coverage",
    *(f"{each.name}_{line}_{each.unit}" for each in ON_LINES for line in LINES),
)


CSV_COLUMNS = [csv_column(name) for name in _SI_COLUMNS]
"""Names of the CSV's columns, in order."""
