"""The survey's part of the table of steps, the card of the chosen step and the list of rejected surfaces, as HTML."""

import math
from collections.abc import Mapping, Sequence

from stair_inspector.files.palettes import Palette
from stair_inspector.measured import difference
from stair_inspector.model import Flight, Inspection, Measured, Statistics, Step
from stair_inspector.quantities import COMPARED, with_above
from stair_inspector.quantity_types import Quantity
from stair_inspector.stability import words_about
from stair_inspector.units import (
    ShownUnit,
    Unit,
    difference_text,
    is_finer_than_a_fraction,
    length_text,
    measured_text,
    number_text,
    parts_text,
    shown_in,
    signed_text,
    value_and_u,
)
from stair_inspector.viewer.bridge.markup import (
    DIM,
    FLIGHT,
    LINE,
    chip,
    mm,
    pick_script,
    press_attribute,
    row_start,
    text,
)
from stair_inspector.viewer.parts.missing import notes_on_missing, why_missing
from stair_inspector.viewer.parts.step_columns import COVERAGE, RMS, USUAL_LOOK, StepColumn, TableLook
from stair_inspector.viewer.scene.step_marks import StepMark, mark_html

_WORST = "#e8590c"
"""Underlines the two neighbours in a flight that differ most."""
CELL = "text-align:right;padding:2px 3px;white-space:nowrap"


def survey_rows(
    inspection: Inspection,
    palette: Palette,
    selected: int | None,
    pick_uuid: str,
    unit: Unit = "mm",
    look: TableLook = USUAL_LOOK,
    marks: Mapping[int, StepMark] | None = None,
) -> str:
    """Return the rows of the survey's table: for each flight its headline, then, unless folded, a row for each step.

    Sorted steps stand in one list, without headlines.
    """
    marks = marks or {}
    columns = look.columns("survey")
    above = {step.step_id: other for step, other in with_above(inspection.steps)}
    step_of = {step.step_id: step for step in inspection.steps}
    worst_of = {flight.flight_id: _worst_of(flight, step_of) for flight in inspection.flights}
    flight_of = {step_id: flight.flight_id for flight in inspection.flights for step_id in flight.step_ids}

    def row(step: Step) -> str:
        return _step_row(
            inspection,
            step,
            above.get(step.step_id),
            palette,
            columns,
            step.step_id == selected,
            pick_uuid,
            unit,
            worst_of.get(flight_of.get(step.step_id, 0), {}),
            marks.get(step.step_id),
        )

    sorted_by = look.sorted_by("survey")
    if sorted_by is not None:
        return "".join(map(row, in_order(inspection.steps, *sorted_by)))
    rows = []
    for flight, steps in _by_flight(inspection):
        is_folded = flight is not None and flight.flight_id in look.folded
        if flight is not None:
            rows.append(_flight_row(flight, unit, pick_uuid, 1 + len(columns), is_folded=is_folded))
        elif inspection.flights:
            rows.append(_headline_row("In no flight", "", "", 1 + len(columns)))
        if not is_folded:
            rows += [row(step) for step in steps]
    return "".join(rows)


def in_order(steps: Sequence[Step], column: StepColumn, is_falling: bool) -> list[Step]:
    """Return the steps sorted by a column; those without a value come last."""
    values = {step.step_id: column.value(step, above) for step, above in with_above(steps)}
    known = [(value, step) for step in steps if (value := values[step.step_id]) is not None]
    known.sort(key=lambda pair: pair[0], reverse=is_falling)
    return [*(step for _, step in known), *(step for step in steps if values[step.step_id] is None)]


def flight_text(flight: Flight) -> str:
    """Return a flight's headline: ``Flight 1 · 9 risers · pitch 31.2 ± 0.3°``."""
    parts = [f"Flight {flight.flight_id}"]
    if flight.shape != "straight":
        parts.append(flight.shape)
    if flight.radius_m is not None:
        parts.append(f"radius {measured_text(flight.radius_m, 'm', 2)}")
    parts.append(f"{flight.n_risers} riser{'' if flight.n_risers == 1 else 's'}")
    if flight.pitch_deg is not None:
        parts.append(f"pitch {measured_text(flight.pitch_deg, '°')}")
    if flight.goes_on is not None:
        parts.append(f"goes on: {flight.goes_on}")
    return " · ".join(parts)


def range_text(name: str, statistics: Statistics | None, unit: Unit = "mm") -> str:
    """Return how even a flight is: ``rise 168.0–171.2, largest step to step 3.1 mm (4→5)``."""
    if statistics is None:
        return ""
    words = f"{name} {number_text(statistics.min, unit)}–{number_text(statistics.max, unit)}"
    if statistics.at is None or not signed_text(statistics.max_adjacent or 0.0, unit):
        return f"{words} {unit}"
    return f"{words}, {_worst_words(statistics, unit)}"


def _worst_words(statistics: Statistics, unit: Unit) -> str:
    low, high = statistics.at or (0, 0)
    return f"largest step to step {difference_text(statistics.max_adjacent or 0.0, unit)} ({low}→{high})"


def _worst_of(flight: Flight, step_of: Mapping[int, Step]) -> dict[str, Statistics]:
    """Return for rise and going the statistics whose two neighbours differ most, where that is beyond uncertainty."""
    worst = {}
    for each in COMPARED:
        statistics = each.statistics_of(flight)
        if statistics is None or statistics.at is None:
            continue
        lower, upper = (each.of(step_of[step_id]) if step_id in step_of else None for step_id in statistics.at)
        if lower is not None and upper is not None:
            told = difference(upper, lower, each.is_chained)
            if told.value > told.u:
                worst[each.name] = statistics
    return worst


def _by_flight(inspection: Inspection) -> list[tuple[Flight | None, list[Step]]]:
    """Return the steps flight by flight, then those that belong to none."""
    groups: list[tuple[Flight | None, list[Step]]] = []
    for flight in inspection.flights:
        own = set(flight.step_ids)
        groups.append((flight, [step for step in inspection.steps if step.step_id in own]))
    taken = {step_id for flight in inspection.flights for step_id in flight.step_ids}
    rest = [step for step in inspection.steps if step.step_id not in taken]
    return [*groups, (None, rest)] if rest else groups


def _flight_row(flight: Flight, unit: Unit, pick_uuid: str, n_columns: int, *, is_folded: bool) -> str:
    rise, going = range_text("rise", flight.rise, unit), range_text("going", flight.going, unit)
    width = f"width {measured_text(flight.width_m, unit)}" if flight.width_m is not None else ""
    means = (_mean("rise", flight.rise, unit), going, _mean("going", flight.going, unit))
    hint = "; ".join(part for part in (*means, width) if part)
    press = press_attribute(pick_script(pick_uuid, flight.flight_id, FLIGHT))
    words = f"{'unfold' if is_folded else 'fold'} flight {flight.flight_id}"
    fold = (
        f'<button type="button" data-testid="fold" data-key="fold {flight.flight_id}" title="{words}" '
        f'aria-expanded="{"false" if is_folded else "true"}" aria-label="{words}" {press} style="border:0;'
        f'background:none;padding:0 4px 0 0;cursor:pointer;color:inherit;font-size:11px">'
        f"{'▸' if is_folded else '▾'}</button>"
    )
    return _headline_row(flight_text(flight), rise, hint, n_columns, flight.flight_id, fold)


def _headline_row(
    title: str, more: str, hint: str, n_columns: int, flight_id: int | None = None, fold: str = ""
) -> str:
    more = f' <span style="font-weight:400;color:{DIM}">· {text(more)}</span>' if more else ""
    return (
        f'<tr data-testid="flight-row" data-flight="{"" if flight_id is None else flight_id}">'
        f'<td colspan="{n_columns}" title="{text(hint)}" style="padding:5px 5px 2px;font-size:11px;line-height:1.3;'
        f'font-weight:600;border-bottom:1px solid {LINE}">{fold}{text(title)}{more}</td></tr>'
    )


def _mean(name: str, statistics: Statistics | None, unit: Unit) -> str:
    return "" if statistics is None else f"mean {name} of {statistics.n}: {length_text(statistics.mean, unit)}"


def _step_row(
    inspection: Inspection,
    step: Step,
    above: Step | None,
    palette: Palette,
    columns: Sequence[StepColumn],
    is_selected: bool,
    pick_uuid: str,
    unit: Unit,
    worst: dict[str, Statistics],
    mark: StepMark | None,
) -> str:
    def worst_words(name: str) -> str:
        statistics = worst.get(name)
        is_worst = statistics is not None and step.step_id in (statistics.at or ())
        return f"the {name}'s {_worst_words(statistics, unit)}" if statistics is not None and is_worst else ""

    def cell(column: StepColumn) -> str:
        if isinstance(column.of, Quantity):
            return _cell(
                column.of.of(step, above),
                shown_in(column.of.unit, unit),
                why_missing(inspection, step, column.of),
                words_about(inspection, step.step_id, column.of),
                (column.name, worst_words(column.name)),
            )
        if column is COVERAGE:
            shown = _coverage(step.coverage, notes_on_missing(inspection, step, "tread", ("coverage",)))
        else:
            shown = mm(step.plane.rms_m, 2) if column is RMS else f"{step.plane.n_points:,}"
        return f'<td data-column="{column.name}" style="{CELL}">{shown}</td>'

    name = f' <div style="font-size:11px;color:{DIM}">landing</div>' if step.kind == "landing" else ""
    return (
        f"{row_start(pick_uuid, step.step_id, '', is_selected=is_selected)}"
        '<td style="padding:2px 4px;white-space:nowrap">'
        f"{chip(palette.of_step(step.step_id))} {step.step_id}{mark_html(mark)}{name}</td>"
        f"{''.join(map(cell, columns))}</tr>"
    )


def _cell(
    measured: Measured | None, unit: ShownUnit, why: str, moves: str = "", worst: tuple[str, str] = ("", "")
) -> str:
    """Return a cell: the value, smaller its uncertainty, in the tooltip the uncertainty's parts.

    ``moves`` says of a value how it hangs on the settings, empty for one that does not. ``worst`` is the quantity's
    name and the words why this value stands out, empty for one that does not.
    """
    # The same room with and without an uncertainty, so that the values stand under each other. Fractions of inches
    # leave no room beside them: there it stands below.
    place = "display:block" if unit == "in" else "display:inline-block;min-width:2.2em;text-align:left"
    small = f' <span style="{place};font-size:11px;color:{DIM};font-weight:400">'
    name, words = worst
    start = f'<td data-column="{name}" style="{CELL}" title='
    if measured is None:
        return f'{start}"{text(why)}">–{small}</span></td>'
    hint = f"{measured_text(measured, unit)} (k = 2): {parts_text(measured, unit)}"
    value, u = value_and_u(measured, unit)
    u = f"±{u}"
    if unit == "in":
        u = f"{value} {u}" if is_finer_than_a_fraction(measured.u) else u
        value = number_text(measured.value, unit)
    if words:
        value = (
            f'<span data-testid="worst-{name}" title="{text(words)}" '
            f'style="border-bottom:2px solid {_WORST}">{value}</span>'
        )
    if moves:
        # Something is in doubt that u does not hold.
        style = f"border-bottom:2px dotted {_WORST}"
        value = f'<span data-testid="unsettled" title="{text(moves)}" style="{style}">{value}</span>'
    return f'{start}"{text(hint)}">{value}{small}{u}</span></td>'


def _coverage(share: float | None, why: str) -> str:
    """Return a disc that is filled as far as the tread is covered; the percentage is its title."""
    if share is None:
        return f'<span title="{text(why)}">–</span>'
    words = f"{100.0 * share:.0f} % of the tread has points"
    angle = 2.0 * math.pi * min(max(share, 0.0), 1.0)
    x, y = 7.0 + 6.0 * math.sin(angle), 7.0 - 6.0 * math.cos(angle)
    wedge = f"M7 7V1A6 6 0 {int(angle > math.pi)} 1 {x:.2f} {y:.2f}Z"
    # An arc that ends where it began is none.
    filled = (
        '<circle cx="7" cy="7" r="6" fill="currentColor" opacity="0.75"/>'
        if share >= 0.995
        else f'<path d="{wedge}" fill="currentColor" opacity="0.75"/>'
    )
    return (
        f'<svg data-coverage="{share:.3f}" width="14" height="14" viewBox="0 0 14 14" role="img" '
        f'aria-label="{words}" style="vertical-align:-2px"><title>{words}</title>'
        f'<circle cx="7" cy="7" r="6" fill="none" stroke="currentColor" opacity="0.6"/>{filled}</svg>'
    )
