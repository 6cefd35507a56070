"""Two checks of the scan that do not need a code: do the rises close, and do readings by hand agree?"""

import math
from collections.abc import Callable, Mapping

from stair_inspector.codes.quantities import combined, part_of
from stair_inspector.model import Inspection, Measured
from stair_inspector.report.cells import QUANTITY_WORDS, lengths, mm, with_u
from stair_inspector.report.document import Cell, Column, Number, Status, Table, Tone, plain
from stair_inspector.report.fields import ReportBasis, TapeReading
from stair_inspector.report.values import flight_rise, flight_run, plane_to_plane

_LINES = ("left", "centre", "right")


def closure_table(inspection: Inspection) -> Table:
    """Return the sum of each flight's rises against the height between the planes at its two ends."""
    columns = (
        Column("Flight", digits=0),
        *with_u("Sum of rises", "mm", 1),
        Column("Plane to plane", "mm", 1),
        Column("Difference", "mm", 2),
        Column("U of the difference", "mm", 2),
        Column("Result", width=2.0),
    )
    rows: list[tuple[Cell, ...]] = []
    tones: list[tuple[int, Tone]] = []
    for flight in inspection.flights:
        rises, planes = flight_rise(inspection, flight), plane_to_plane(inspection, flight)
        if rises is None or planes is None:
            why = "a rise was not measured" if rises is None else "the surface at its foot was not seen as a plane"
            rows.append(
                (flight.flight_id, *lengths(rises), mm(planes), None, None, Status(f"not possible: {why}", "plain"))
            )
            continue
        difference = _of_the_ends(rises.value - planes, rises)
        is_closed = abs(difference.value) <= difference.u
        words = "closes within U" if is_closed else "differs by more than U"
        rows.append(
            (
                flight.flight_id,
                *lengths(rises),
                mm(planes),
                *lengths(difference),
                Status(words, "good" if is_closed else "close"),
            )
        )
        if not is_closed:
            tones.append((len(rows) - 1, "close"))
    note = (
        "The sum of the rises, taken at the nosings on the centre line, against the height between the plane fitted to "
        "all points of the surface at the foot and that fitted to all points of the topmost step, at the same places. "
        "The nosings in between cancel: the check tells of the two end surfaces only. So do vertical and scale: U of "
        "the difference is made of noise, edge and registration. A nosing strip that stands proud, a worn or "
        "bowed surface, or parts of a surface that stations saw at different heights, show as a difference."
    )
    return Table(
        "closure",
        "Closure check",
        columns,
        tuple(rows),
        note,
        "Nothing to close: no flight was measured.",
        tuple(tones),
    )


def _of_the_ends(value_m: float, rises: Measured) -> Measured:
    """Return a difference of two heights between the same places, with what of the rises' uncertainty is left in it.

    Both heights have the same vertical and scale. The points at the nosings are not all of the surface's, and may have
    been seen from other stations: noise, edge and registration stay.
    """
    parts = {name: part_of(rises, name) for name in ("noise", "edge", "registration")}
    return combined(value_m, parts)


def readings_table(inspection: Inspection, basis: ReportBasis) -> Table:
    """Return the readings by hand beside the scan's values, in millimetres or degrees."""
    columns = (
        Column("Place"),
        Column("Quantity"),
        Column("Unit"),
        Column("By hand", digits=1),
        Column("U by hand", digits=1, is_u=True),
        Column("Scan", digits=1),
        Column("U of the scan", digits=1, is_u=True),
        Column("Difference", digits=1),
        Column("Result"),
        Column("Instrument and note", width=1.6),
    )
    rows: list[tuple[Cell, ...]] = []
    tones: list[tuple[int, Tone]] = []
    for reading in basis.readings:
        scale, unit, digits = (1000.0, "mm", 1) if reading.unit == "m" else (1.0, "°", 2)
        scanned = scanned_value(inspection, reading)
        difference = None if scanned is None else reading.value - scanned.value
        result = _agreement(reading, scanned)
        if result.tone == "bad":
            tones.append((len(rows), result.tone))
        rows.append(
            (
                _place_of(reading),
                QUANTITY_WORDS[reading.quantity],
                unit,
                Number(round(reading.value * scale, 6), digits),
                None if reading.u is None else round(reading.u * scale, 6),
                None if scanned is None else Number(round(scanned.value * scale, 6), digits),
                None if scanned is None else round(scanned.u * scale, 6),
                None if difference is None else Number(round(difference * scale, 6), digits),
                result,
                "; ".join(plain(part) for part in (reading.instrument, reading.note) if part),
            )
        )
    note = (
        "Difference: by hand less scan. The two agree when they differ by no more than the root of the sum of the "
        "squares of both U; where none is stated for the reading, whether they agree is not judged."
    )
    if any(reading.line != "centre" for reading in basis.readings):
        note += " For the left and right lines no U is worked out: that of the centre line stands there."
    return Table(
        "readings",
        "Readings by hand",
        columns,
        tuple(rows),
        note,
        "No reading by hand was entered. Three to five readings of a tape or a digital level are a check of the scan "
        "that does not depend on it.",
        tuple(tones),
    )


def scanned_value(inspection: Inspection, reading: TapeReading) -> Measured | None:
    """Return the scan's value of what was read by hand, None where there is none."""
    if reading.flight is not None:
        flight = next((flight for flight in inspection.flights if flight.flight_id == reading.flight), None)
        if flight is None:
            return None
        of_flight: Mapping[str, Callable[[], Measured | None]] = {
            "flight_rise": lambda: flight_rise(inspection, flight),
            "flight_run": lambda: flight_run(inspection, flight),
            "pitch": lambda: flight.pitch_deg,
            "width": lambda: flight.width_m,
        }
        return of_flight[reading.quantity]()
    step = next((step for step in inspection.steps if step.step_id == reading.step), None)
    if step is None:
        return None
    value: Measured | None = getattr(step, f"{reading.quantity}_{reading.unit}")
    if value is None or reading.line == "centre":
        return value
    on_lines: tuple[float | None, ...] | None = getattr(step, f"{reading.quantity}_lcr_{reading.unit}")
    there = None if on_lines is None else on_lines[_LINES.index(reading.line)]
    # No uncertainty is worked out on the outer lines; the note under the table says whose it is.
    return None if there is None else Measured(there, value.u)


def _place_of(reading: TapeReading) -> str:
    if reading.flight is not None:
        return f"flight {reading.flight}"
    return f"step {reading.step}" + ("" if reading.line == "centre" else f", {reading.line}")


def _agreement(reading: TapeReading, scanned: Measured | None) -> Status:
    if scanned is None:
        return Status("not in the scan", "plain")
    if reading.u is None:
        return Status("U of the reading not stated", "plain")
    if abs(reading.value - scanned.value) <= math.hypot(scanned.u, reading.u):
        return Status("agrees", "good")
    return Status("differs by more than U", "bad")
