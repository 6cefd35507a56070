"""The tables of what was measured: flights, steps, uniformity, and the quantities of the paper."""

import statistics
from collections.abc import Callable, Iterable
from typing import Literal

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
from stair_inspector.content.document import Cell, Column, Table, TablePart, Tone, table_of
from stair_inspector.content.values import flight_value, steps_of
from stair_inspector.model import Flight, Inspection, NormalsBy, Statistics, Step
from stair_inspector.quantities import COMPARED, ON_LINES, SHOWN_OF_PAPER, in_report, step_value, with_above
from stair_inspector.quantity_types import LINES, PaperQuantity, Quantity

MADE_BY: dict[NormalsBy, str] = {"open3d": "Open3D", "numpy": "numpy and SciPy", "file": "the file"}
"""Who made the normals, in words."""
_BEYOND = (Verdict.OUTSIDE, Verdict.OUTSIDE_CLOSE, Verdict.WITHIN_CLOSE)
"""What a step is flagged for, the gravest first."""


def flights_table(inspection: Inspection) -> Table:
    """Return one row per flight: risers, total rise and run, mean rise and going, pitch, width.

    A radius, and what is seen and was not measured, have columns where a flight has them.
    """
    flights = inspection.flights
    radius: TablePart[Flight] = (with_u("Radius", "mm", 0), lambda each: rounded(lengths(each.radius_m), 0))
    more: TablePart[Flight] = (Column("Goes on", width=3.0), lambda each: each.goes_on)

    def total(name: str, what: str) -> TablePart[Flight]:
        return with_u(name, "mm", 1), lambda each: rounded(lengths(flight_value(inspection, each, what)), 1)

    def of(name: str, quantity: str, figure: str) -> TablePart[Flight]:
        def cell(flight: Flight) -> Cell:
            found: Statistics | None = getattr(flight, quantity)
            return None if found is None else millimetres(getattr(found, figure))

        return Column(name, "mm", 1), cell

    return table_of(
        "flights",
        "Flights",
        flights,
        (Column("Flight", digits=0), lambda each: each.flight_id),
        (Column("Shape"), lambda each: each.shape),
        (Column("Risers", digits=0), lambda each: each.n_risers),
        total("Total rise", "flight_rise"),
        total("Total run", "flight_run"),
        of("Mean rise", "rise", "mean"),
        of("Mean going", "going", "mean"),
        (with_u("Pitch", "°", 2), lambda each: rounded(angles(each.pitch_deg), 2)),
        (with_u("Tread width", "mm", 1), lambda each: rounded(lengths(each.width_m), 1)),
        *((radius,) if any(each.radius_m is not None for each in flights) else ()),
        of("Range of rise", "rise", "range"),
        of("Largest change of rise", "rise", "max_adjacent"),
        (Column("Between steps"), lambda each: pair(each.rise)),
        of("Range of going", "going", "range"),
        of("Largest change of going", "going", "max_adjacent"),
        (Column("Between these steps"), lambda each: pair(each.going)),
        *((more,) if any(each.goes_on is not None for each in flights) else ()),
        empty="No flight was found.",
    )


def steps_table(inspection: Inspection, check: Check | None) -> Table:
    """Return the lengths of every step with their uncertainties."""
    return table_of(
        "steps",
        "Steps: dimensions",
        with_above(inspection.steps),
        (Column("Step", digits=0), lambda pair: pair[0].step_id),
        (Column("Flight", digits=0), lambda pair: pair[0].flight),
        *_in_report("steps"),
        note=(
            "± is the expanded uncertainty U (k = 2). Rise: to this step's nosing. Going: from this nosing to the "
            "next. Width: of the tread, not the clear width between handrails. Diagonal: from this nosing to the next. "
            "– was not measured or is not defined; the notes say why."
        ),
        empty="No step was found.",
        tone=_tone_of(inspection, check),
    )


def _in_report(table: Literal["steps", "evidence"]) -> Iterable[TablePart[tuple[Step, Step | None]]]:
    """Yield the columns of the quantities that stand in a table, and their cells."""

    def part_of(quantity: Quantity) -> TablePart[tuple[Step, Step | None]]:
        return columns_for(quantity), lambda pair: cells_of(quantity, quantity.of(*pair))

    return map(part_of, in_report(table))


def evidence_table(inspection: Inspection, check: Check | None) -> Table:
    """Return slopes, the values on the three lines, and what each step rests on."""
    told = {} if check is None else findings_at_steps(inspection, check)
    line = inspection.params.survey.line_percent
    return table_of(
        "evidence",
        "Steps: slopes, lines and evidence",
        with_above(inspection.steps),
        (Column("Step", digits=0), lambda pair: pair[0].step_id),
        (Column("Kind"), lambda pair: pair[0].kind),
        *_in_report("evidence"),
        (
            [Column(f"{each.title} {place}", *unit_in_report(each.unit)) for each in ON_LINES for place in LINES],
            lambda pair: [millimetres(value) for each in ON_LINES for value in each.lines_of(pair[0])],
        ),
        (Column("Points", digits=0), lambda pair: pair[0].plane.n_points),
        (Column("Coverage", "%", 0), lambda pair: None if (c := pair[0].coverage) is None else round(100.0 * c, 6)),
        (Column("Plane RMS", "mm", 2), lambda pair: millimetres(pair[0].plane.rms_m)),
        (Column("Flags", width=1.6), lambda pair: _flags(inspection, pair[0], told.get(pair[0].step_id, ()))),
        note=(
            "Fall: positive where the tread falls towards its nosing. Cross-fall: positive where it is higher on the "
            f"left, as seen when climbing. Left, centre, right: on lines at {line:g}, 50 and {100.0 - line:g} % of the "
            "width from the left. Coverage: share of the tread that holds points. Plane RMS mixes noise and texture; "
            "it is not the accuracy. Flags: ✗ outside and ≈ close to a limit; N with a number is a note of the list of "
            "notes."
        ),
        empty="No step was found.",
        tone=_tone_of(inspection, check),
    )


def paper_table(inspection: Inspection) -> Table:
    """Return the quantities of the paper's method."""

    def part_of(quantity: PaperQuantity) -> TablePart[Step]:
        def cell(step: Step) -> Cell:
            value = quantity.of_paper(step.paper)
            return millimetres(value) if quantity.unit == "m" else value

        return Column(quantity.label, *unit_in_report(quantity.unit)), cell

    return table_of(
        "paper",
        "Quantities of the paper's method",
        inspection.steps,
        (Column("Step", digits=0), lambda step: step.step_id),
        *map(part_of, SHOWN_OF_PAPER),
        (Column("Points", digits=0), lambda step: step.plane.n_points),
        (Column("Plane RMS", "mm", 2), lambda step: millimetres(step.plane.rms_m)),
        note=(
            "Defined in Joo et al., Robust and Accurate Stair Geometry Extraction Using Point Cloud Data: h from this "
            "step's centroid to the next one's, edges by percentiles. They differ from rise and going, which run from "
            "nosing to nosing; no code is judged on them. "
            f"The normals were made by {MADE_BY[inspection.normals_by]}."
        ),
        empty="No step was found.",
    )


def uniformity_table(inspection: Inspection) -> Table:
    """Return the statistics of rise and going of each flight, with the neighbours that differ most."""

    def deviation(flight: Flight, quantity: Quantity) -> Cell:
        values = [
            value.value
            for step in steps_of(inspection, flight)
            if step.kind in quantity.kinds and (value := step_value(step, quantity.name)) is not None
        ]
        return millimetres(statistics.stdev(values)) if len(values) > 1 else None

    return table_of(
        "uniformity",
        "Uniformity",
        [
            (flight, quantity, found)
            for flight in inspection.flights
            for quantity in COMPARED
            if (found := quantity.statistics_of(flight)) is not None
        ],
        (Column("Flight", digits=0), lambda each: each[0].flight_id),
        (Column("Quantity"), lambda each: each[1].words),
        (Column("n", digits=0), lambda each: each[2].n),
        (Column("Mean", "mm", 1), lambda each: millimetres(each[2].mean)),
        (Column("SD", "mm", 2), lambda each: deviation(each[0], each[1])),
        (Column("Smallest", "mm", 1), lambda each: millimetres(each[2].min)),
        (Column("Largest", "mm", 1), lambda each: millimetres(each[2].max)),
        (Column("Range", "mm", 1), lambda each: millimetres(each[2].range)),
        (
            Column("Largest difference of neighbours", "mm", 1, is_difference=True),
            lambda each: millimetres(each[2].max_adjacent),
        ),
        (Column("Between steps"), lambda each: pair(each[2])),
        note="Going: of treads; a landing has none. SD: standard deviation of the single values.",
        empty="Nothing to compare: no flight was measured.",
    )


def _tone_of(inspection: Inspection, check: Check | None) -> Callable[[tuple[Step, Step | None]], Tone]:
    """Return what gives the tone of a step's row: whether it is outside a limit."""
    outside = {} if check is None else outside_at_steps(inspection, check)

    def tone(pair: tuple[Step, Step | None]) -> Tone:
        own = outside.get(pair[0].step_id)
        return "plain" if own is None else "bad" if gravest(own).verdict is Verdict.OUTSIDE else "close"

    return tone


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
