"""Two checks of the scan that do not need a code: do the rises close, and do readings by hand agree?"""

import math
from dataclasses import dataclass

from stair_inspector.content.cells import lengths, millimetres, unit_in_report, with_u
from stair_inspector.content.document import Cell, Column, Number, Status, Table, plain, table_of
from stair_inspector.content.fields import ReportBasis
from stair_inspector.content.readings import TapeReading
from stair_inspector.content.step_places import step_at
from stair_inspector.content.values import flight_value, plane_to_plane, steps_of
from stair_inspector.measured import OWN_PARTS, combined, part_of
from stair_inspector.model import Flight, Inspection, Measured, Step
from stair_inspector.quantities import quantity_of
from stair_inspector.quantity_types import LINES

_CLOSURE_DIGITS, _FINEST_DIGITS = 2, 6
"""Decimals of a millimetre in the closure check: as many as are shown, and no more than are kept."""
_SLIP_SHARE = 0.1
"""Of a length: a reading that is farther from the scan is most likely one of another place or unit."""


@dataclass(frozen=True, slots=True)
class Compared:
    """A reading by hand beside the scan: metres or degrees, ``difference`` is by hand less scan."""

    reading: TapeReading
    place: str
    scanned: Measured | None
    difference: float | None
    result: Status


@dataclass(frozen=True, slots=True)
class _Closure:
    """A flight's sum of rises beside the height between the planes at its ends, metres, and what they come to."""

    flight: Flight
    rises: Measured | None
    planes: float | None
    difference: Measured | None
    result: Status


def closure_table(inspection: Inspection) -> Table:
    """Return the sum of each flight's rises against the height between the planes at its two ends."""
    return table_of(
        "closure",
        "Closure check",
        [_closure_of(inspection, flight) for flight in inspection.flights],
        (Column("Flight", digits=0), lambda each: each.flight.flight_id),
        (with_u("Sum of rises", "mm", 1), lambda each: lengths(each.rises)),
        (Column("Plane to plane", "mm", 1), lambda each: millimetres(each.planes)),
        (
            (
                Column("Difference", "mm", _CLOSURE_DIGITS, is_difference=True),
                Column("U of the difference", "mm", _CLOSURE_DIGITS),
            ),
            lambda each: _told_apart(*lengths(each.difference)),
        ),
        (Column("Result", width=2.0), lambda each: each.result),
        note=(
            "The sum of the rises, taken at the nosings on the centre line, against the height between the plane "
            "fitted to all points of the surface at the foot and that fitted to all points of the topmost step, at the "
            "same places. The nosings in between cancel: the check tells of the two end surfaces only. So do vertical "
            "and scale: U of the difference is made of noise, edge and registration. A nosing strip that stands proud, "
            "a worn or bowed surface, or parts of a surface that stations saw at different heights, show as a "
            "difference."
        ),
        empty="Nothing to close: no flight was measured.",
        tone=lambda each: each.result.tone,
    )


def _closure_of(inspection: Inspection, flight: Flight) -> _Closure:
    rises, planes = flight_value(inspection, flight, "flight_rise"), plane_to_plane(inspection, flight)
    if rises is None or planes is None:
        why = "a rise was not measured" if rises is None else "the surface at its foot was not seen as a plane"
        return _Closure(flight, rises, planes, None, Status(f"not possible: {why}", "plain"))
    steps = steps_of(inspection, flight)
    difference = _of_the_ends(rises.value - planes, rises, steps[0].rise_m, steps[-1].rise_m)
    is_closed = abs(difference.value) <= difference.u
    result = Status("closes within U", "good") if is_closed else Status("differs by more than U", "close")
    return _Closure(flight, rises, planes, difference, result)


def _told_apart(difference_mm: float | None, u_mm: float | None) -> tuple[Cell, Cell]:
    """Return a difference and its uncertainty with the decimals that show which of them is the larger."""
    if difference_mm is None or u_mm is None:
        return difference_mm, u_mm
    is_larger = abs(difference_mm) > u_mm
    for digits in range(_CLOSURE_DIGITS, _FINEST_DIGITS):
        if (round(abs(difference_mm), digits) > round(u_mm, digits)) is is_larger:
            break
    else:
        digits = _FINEST_DIGITS
    if digits == _CLOSURE_DIGITS:
        return difference_mm, u_mm
    return Number(difference_mm, digits), Number(u_mm, digits)


def _of_the_ends(value_m: float, rises: Measured, first: Measured | None, last: Measured | None) -> Measured:
    """Return a difference of two heights between the same places, with what of the rises' uncertainty is left in it.

    Both heights have the same vertical and scale. The points at the nosings are not all of the surface's, and may have
    been seen from other stations: all but those two stays. Of registration there is what it adds at the two ends: from
    step to step between them both heights have the same.
    """
    parts = {name: part_of(rises, name) for name in OWN_PARTS}
    ends = [part_of(rise, "registration") for rise in (first, last) if rise is not None]
    parts["registration"] = math.hypot(*ends)
    return combined(value_m, parts)


def readings_table(inspection: Inspection, basis: ReportBasis) -> Table:
    """Return the readings by hand beside the scan's values, in millimetres or degrees."""

    def size(found: Compared, value: float | None) -> float | None:
        return None if value is None else round(value * quantity_of(found.reading.quantity).notation.scale, 6)

    def number(found: Compared, value: float | None) -> Number | None:
        shown, digits = size(found, value), unit_in_report(quantity_of(found.reading.quantity).unit)[1]
        return None if shown is None else Number(shown, digits)

    note = (
        "Difference: by hand less scan. The two agree when they differ by no more than the root of the sum of the "
        "squares of both U; where none is stated for the reading, whether they agree is not judged."
    )
    if any(reading.line != "centre" for reading in basis.readings):
        note += " For the left and right lines no U is worked out: that of the centre line stands there."
    return table_of(
        "readings",
        "Readings by hand",
        [compared(inspection, reading) for reading in basis.readings],
        (Column("Place"), lambda found: found.place),
        (Column("Quantity"), lambda found: quantity_of(found.reading.quantity).words),
        (Column("Unit"), lambda found: unit_in_report(quantity_of(found.reading.quantity).unit)[0]),
        (Column("By hand", digits=1), lambda found: number(found, found.reading.value)),
        (Column("U by hand", digits=1, is_u=True), lambda found: size(found, found.reading.u)),
        (Column("Scan", digits=1), lambda found: number(found, None if found.scanned is None else found.scanned.value)),
        (
            Column("U of the scan", digits=1, is_u=True),
            lambda found: size(found, None if found.scanned is None else found.scanned.u),
        ),
        (Column("Difference", digits=1, is_difference=True), lambda found: number(found, found.difference)),
        (Column("Result"), lambda found: found.result),
        (Column("Instrument and note", width=1.6), lambda found: said_of(found.reading)),
        note=note,
        empty=(
            "No reading by hand was entered. Three to five readings of a tape or a digital level are a check of the "
            "scan that does not depend on it."
        ),
        tone=lambda found: found.result.tone,
    )


def compared(inspection: Inspection, reading: TapeReading) -> Compared:
    """Compare a reading with the scan's value at its place."""
    step = _step_of(inspection, reading)
    scanned = _of_flight(inspection, reading) if reading.flight is not None else _of_step(step, reading)
    return Compared(
        reading,
        _place_of(reading, step),
        scanned,
        None if scanned is None else reading.value - scanned.value,
        _agreement(reading, step, scanned),
    )


def said_of(reading: TapeReading) -> str:
    """Return the instrument and the note of a reading."""
    return "; ".join(plain(part) for part in (reading.instrument, reading.note) if part)


def _of_flight(inspection: Inspection, reading: TapeReading) -> Measured | None:
    flight = next((flight for flight in inspection.flights if flight.flight_id == reading.flight), None)
    if flight is None:
        return None
    return flight_value(inspection, flight, reading.quantity)


def _of_step(step: Step | None, reading: TapeReading) -> Measured | None:
    if step is None:
        return None
    quantity = quantity_of(reading.quantity)
    value = quantity.of(step)
    if value is None or reading.line == "centre":
        return value
    there = quantity.lines_of(step)[LINES.index(reading.line)]
    # No uncertainty is worked out on the outer lines; the note under the table says whose it is.
    return None if there is None else Measured(there, value.u)


def _step_of(inspection: Inspection, reading: TapeReading) -> Step | None:
    """Return the step that was read."""
    return None if reading.step is None else step_at(inspection, reading.step, reading.at)


def _place_of(reading: TapeReading, step: Step | None) -> str:
    if reading.flight is not None:
        return f"flight {reading.flight}"
    on_line = "" if reading.line == "centre" else f", {reading.line}"
    if step is None and reading.at is not None:
        return f"former step {reading.step}{on_line}"
    if step is None or step.step_id == reading.step:
        return f"step {reading.step}{on_line}"
    return f"step {step.step_id}{on_line} (was {reading.step})"


def _agreement(reading: TapeReading, step: Step | None, scanned: Measured | None) -> Status:
    if step is None and reading.at is not None:
        return Status("its step is no longer in the result", "close")
    if scanned is None:
        return Status("not in the scan", "plain")
    difference = abs(reading.value - scanned.value)
    if reading.u is None:
        if reading.unit == "m" and quantity_of(reading.quantity).is_size and difference > _SLIP_SHARE * scanned.value:
            return Status("far from the scan: check place and unit; U of the reading not stated", "close")
        return Status("U of the reading not stated", "plain")
    if difference <= math.hypot(scanned.u, reading.u):
        return Status("agrees", "good")
    return Status("differs by more than U", "bad")
