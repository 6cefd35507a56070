"""The tables of what the numbers rest on: parts of the uncertainty, surfaces, notes."""

from stair_inspector.content.cells import millimetres
from stair_inspector.content.document import Column, Table, table_of
from stair_inspector.content.note_words import note_words
from stair_inspector.measured import COMMON_PARTS, OWN_PARTS, part_of
from stair_inspector.model import Inspection, Measured
from stair_inspector.quantities import IN_FILES

_PARTS = (*OWN_PARTS, *COMMON_PARTS)


def budget_table(inspection: Inspection) -> Table:
    """Return the largest uncertainty of each quantity and, for that step, what it is made of."""
    columns = (
        Column("Quantity"),
        Column("Unit"),
        Column("Smallest U", digits=2, is_u=True),
        Column("Largest U", digits=2, is_u=True),
        *(Column(name.capitalize(), digits=2, is_u=True) for name in _PARTS),
        Column("Largest at step", digits=0),
    )
    rows = []
    for quantity in IN_FILES:
        found: list[tuple[int, Measured]] = [
            (step.step_id, value) for step in inspection.steps if (value := quantity.of(step)) is not None
        ]
        if not found:
            continue
        scale, unit, _ = quantity.notation
        step_id, worst = max(found, key=lambda pair: pair[1].u)
        parts = [round(part_of(worst, part) * scale, 6) or None for part in _PARTS]
        least = min(value.u for _, value in found)
        rows.append((quantity.words, unit, round(least * scale, 6), round(worst.u * scale, 6), *parts, step_id))
    note = (
        "The parts are those of the largest U, each expanded (k = 2); U is the root of the sum of their squares. "
        "– has no weight."
    )
    return Table("budget", "What the uncertainty is made of", columns, tuple(rows), note, "Nothing was measured.")


def surfaces_table(inspection: Inspection) -> Table:
    """Return every surface that was found, what it was taken for, and why."""
    return table_of(
        "surfaces",
        "Surfaces found in the scan",
        inspection.patches,
        (Column("Surface", digits=0), lambda patch: patch.patch_id),
        (Column("Height", "mm", 1), lambda patch: millimetres(patch.height_m)),
        (Column("Area", "m²", 3), lambda patch: patch.area_m2),
        (Column("Points", digits=0), lambda patch: patch.plane.n_points),
        (Column("Taken for"), lambda patch: patch.kind),
        (Column("Step", digits=0), lambda patch: patch.step_id),
        (Column("Reason", width=4.0), lambda patch: note_words(patch.reason or "")),
        note="Height: mean height in the scan's own frame.",
        empty="No surface was kept.",
    )


def notes_table(inspection: Inspection) -> Table:
    """Return the notes of the measurement, numbered."""
    return table_of(
        "notes",
        "Notes of the measurement",
        enumerate(inspection.notes, 1),
        (Column("Note"), lambda each: f"N{each[0]}"),
        (Column("Step", digits=0), lambda each: each[1].step),
        (Column("What the measurement says", width=8.0), lambda each: note_words(each[1].message)),
        empty="The measurement left no note.",
    )
