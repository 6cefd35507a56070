"""The tables of what was measured: flights, steps, uniformity, and the quantities of the paper."""

import statistics
from collections.abc import Iterable

from stair_inspector.codes.at_steps import findings_at_steps, outside_at_steps
from stair_inspector.codes.findings import Check, Finding, Verdict, gravest
from stair_inspector.content.cells import (
    QUANTITY_WORDS,
    angles,
    cells_of,
    columns_for,
    lengths,
    millimetres,
    pair,
    rounded,
    unit_in_report,
    with_u,
)
from stair_inspector.content.document import Cell, Column, Table, Tone
from stair_inspector.content.values import flight_value, steps_of
from stair_inspector.model import Inspection, Step
from stair_inspector.quantities import COMPARED, ON_LINES, SHOWN_OF_PAPER, in_report, step_value, with_above
from stair_inspector.quantity_types import LINES, PaperQuantity

_BEYOND = (Verdict.OUTSIDE, Verdict.OUTSIDE_CLOSE, Verdict.WITHIN_CLOSE)
"""What a step is flagged for, the gravest first."""


def flights_table(inspection: Inspection) -> Table:
    """Return one row per flight: risers, total rise and run, mean rise and going, pitch, width.

    A radius, and what is seen and was not measured, have columns where a flight has them.
    """
    flights = inspection.flights
    has_radius = any(flight.radius_m is not None for flight in flights)
    has_more = any(flight.goes_on is not None for flight in flights)
    columns = (
        Column("Flight", digits=0),
        Column("Shape"),
        Column("Risers", digits=0),
        *with_u("Total rise", "mm", 1),
        *with_u("Total run", "mm", 1),
        Column("Mean rise", "mm", 1),
        Column("Mean going", "mm", 1),
        *with_u("Pitch", "°", 2),
        *with_u("Tread width", "mm", 1),
        *(with_u("Radius", "mm", 0) if has_radius else ()),
        Column("Range of rise", "mm", 1),
        Column("Largest change of rise", "mm", 1),
        Column("Between steps"),
        Column("Range of going", "mm", 1),
        Column("Largest change of going", "mm", 1),
        Column("Between these steps"),
        *((Column("Goes on", width=3.0),) if has_more else ()),
    )
    rows: list[tuple[Cell, ...]] = []
    for flight in flights:
        rows.append(
            (
                flight.flight_id,
                flight.shape,
                flight.n_risers,
                *rounded(lengths(flight_value(inspection, flight, "flight_rise")), 1),
                *rounded(lengths(flight_value(inspection, flight, "flight_run")), 1),
                None if flight.rise is None else millimetres(flight.rise.mean),
                None if flight.going is None else millimetres(flight.going.mean),
                *rounded(angles(flight.pitch_deg), 2),
                *rounded(lengths(flight.width_m), 1),
                *(rounded(lengths(flight.radius_m), 0) if has_radius else ()),
                None if flight.rise is None else millimetres(flight.rise.range),
                None if flight.rise is None else millimetres(flight.rise.max_adjacent),
                pair(flight.rise),
                None if flight.going is None else millimetres(flight.going.range),
                None if flight.going is None else millimetres(flight.going.max_adjacent),
                pair(flight.going),
                *((flight.goes_on,) if has_more else ()),
            )
        )
    return Table("flights", "Flights", columns, tuple(rows), empty="No flight was found.")


def steps_table(inspection: Inspection, check: Check | None) -> Table:
    """Return the lengths of every step with their uncertainties."""
    columns = (
        Column("Step", digits=0),
        Column("Flight", digits=0),
        *(column for quantity in in_report("steps") for column in columns_for(quantity)),
    )
    rows = []
    for step, above in with_above(inspection.steps):
        cells = [cell for each in in_report("steps") for cell in cells_of(each, each.of(step, above))]
        rows.append((step.step_id, step.flight, *cells))
    note = (
        "± is the expanded uncertainty U (k = 2). Rise: to this step's nosing. Going: from this nosing to the next. "
        "Width: of the tread, not the clear width between handrails. Diagonal: from this nosing to the next. "
        "– was not measured or is not defined; the notes say why."
    )
    return Table(
        "steps", "Steps: dimensions", columns, tuple(rows), note, "No step was found.", _tones(inspection, check)
    )


def evidence_table(inspection: Inspection, check: Check | None) -> Table:
    """Return slopes, the values on the three lines, and what each step rests on."""
    columns = (
        Column("Step", digits=0),
        Column("Kind"),
        *(column for quantity in in_report("evidence") for column in columns_for(quantity)),
        *(Column(f"{each.title} {line}", *unit_in_report(each.unit)) for each in ON_LINES for line in LINES),
        Column("Points", digits=0),
        Column("Coverage", "%", 0),
        Column("Plane RMS", "mm", 2),
        Column("Flags", width=1.6),
    )
    told = {} if check is None else findings_at_steps(inspection, check)
    rows: list[tuple[Cell, ...]] = []
    for step, above in with_above(inspection.steps):
        rows.append(
            (
                step.step_id,
                step.kind,
                *(cell for each in in_report("evidence") for cell in cells_of(each, each.of(step, above))),
                *(millimetres(value) for each in ON_LINES for value in each.lines_of(step)),
                step.plane.n_points,
                None if step.coverage is None else round(100.0 * step.coverage, 6),
                millimetres(step.plane.rms_m),
                _flags(inspection, step, told.get(step.step_id, ())),
            )
        )
    note = (
        "Fall: positive where the tread falls towards its nosing. Cross-fall: positive where it is higher on the left, "
        "as seen when climbing. Left, centre, right: on lines at "
        f"{inspection.params.survey.line_percent:g}, 50 and {100.0 - inspection.params.survey.line_percent:g} % of the "
        "width from the left. Coverage: share of the tread that holds points. Plane RMS mixes noise and texture; it is "
        "not the accuracy. Flags: ✗ outside and ≈ close to a limit; N with a number is a note of the list of notes."
    )
    return Table(
        "evidence",
        "Steps: slopes, lines and evidence",
        columns,
        tuple(rows),
        note,
        "No step was found.",
        _tones(inspection, check),
    )


def paper_table(inspection: Inspection) -> Table:
    """Return the quantities of the paper's method."""
    columns = (
        Column("Step", digits=0),
        *(Column(each.label, *unit_in_report(each.unit)) for each in SHOWN_OF_PAPER),
        Column("Points", digits=0),
        Column("Plane RMS", "mm", 2),
    )
    rows = tuple(
        (
            step.step_id,
            *(millimetres(value) if each.unit == "m" else value for each, value in _of_paper(step)),
            step.plane.n_points,
            millimetres(step.plane.rms_m),
        )
        for step in inspection.steps
    )
    note = (
        "Defined in Joo et al., Robust and Accurate Stair Geometry Extraction Using Point Cloud Data: h from this "
        "step's centroid to the next one's, edges by percentiles. They differ from rise and going, which run from "
        "nosing to nosing; no code is judged on them."
    )
    return Table("paper", "Quantities of the paper's method", columns, rows, note, "No step was found.")


def _of_paper(step: Step) -> list[tuple[PaperQuantity, float | None]]:
    return [(quantity, quantity.of_paper(step.paper)) for quantity in SHOWN_OF_PAPER]


def uniformity_table(inspection: Inspection) -> Table:
    """Return the statistics of rise and going of each flight, with the neighbours that differ most."""
    columns = (
        Column("Flight", digits=0),
        Column("Quantity"),
        Column("n", digits=0),
        Column("Mean", "mm", 1),
        Column("SD", "mm", 2),
        Column("Smallest", "mm", 1),
        Column("Largest", "mm", 1),
        Column("Range", "mm", 1),
        Column("Largest difference of neighbours", "mm", 1),
        Column("Between steps"),
    )
    rows: list[tuple[Cell, ...]] = []
    for flight in inspection.flights:
        for quantity in COMPARED:
            found = quantity.statistics_of(flight)
            if found is None:
                continue
            values = [
                value.value
                for step in steps_of(inspection, flight)
                if step.kind in quantity.kinds and (value := step_value(step, quantity.name)) is not None
            ]
            rows.append(
                (
                    flight.flight_id,
                    quantity.words,
                    found.n,
                    millimetres(found.mean),
                    millimetres(statistics.stdev(values)) if len(values) > 1 else None,
                    millimetres(found.min),
                    millimetres(found.max),
                    millimetres(found.range),
                    millimetres(found.max_adjacent),
                    pair(found),
                )
            )
    note = "Going: of treads; a landing has none. SD: standard deviation of the single values."
    return Table("uniformity", "Uniformity", columns, tuple(rows), note, "Nothing to compare: no flight was measured.")


def _tones(inspection: Inspection, check: Check | None) -> tuple[tuple[int, Tone], ...]:
    """Return the tone of the rows of steps that are outside a limit."""
    outside = {} if check is None else outside_at_steps(inspection, check)
    return tuple(
        (row, "bad" if gravest(outside[step.step_id]).verdict is Verdict.OUTSIDE else "close")
        for row, step in enumerate(inspection.steps)
        if step.step_id in outside
    )


def _beyond(findings: Iterable[Finding]) -> dict[str, Verdict]:
    """Return by words what of a step lies outside a limit or advice, or close to one."""
    told: dict[str, Verdict] = {}
    for found in findings:
        if found.verdict not in _BEYOND:
            continue
        words = QUANTITY_WORDS[found.rule.quantity]
        words = {"adjacent_difference": f"{words} to neighbour", "flight_range": f"range of {words}"}.get(
            found.rule.statistic, words
        )
        known = told.get(words)
        if known is None or _BEYOND.index(found.verdict) < _BEYOND.index(known):
            told[words] = found.verdict
    return told


def _flags(inspection: Inspection, step: Step, findings: Iterable[Finding]) -> str:
    judged = [f"{'✗' if verdict is Verdict.OUTSIDE else '≈'} {words}" for words, verdict in _beyond(findings).items()]
    notes = [f"N{number}" for number, note in enumerate(inspection.notes, 1) if note.step == step.step_id]
    return ", ".join([*judged, *notes])
