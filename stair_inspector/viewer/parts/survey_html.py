"""The survey's part of the side table, the card of the chosen step and the list of rejected surfaces, as HTML."""

import math
from collections.abc import Mapping, Sequence

from stair_inspector.content.remarks import on_page
from stair_inspector.files.palettes import Palette, Rgb
from stair_inspector.model import NO_NOSING, Flight, Inspection, Measured, Note, Statistics, Step
from stair_inspector.pictures.coloring import rejected_of
from stair_inspector.pictures.frames import step_of
from stair_inspector.pictures.segmentation import MOST_REJECTED, SURFACE
from stair_inspector.quantities import COMPARED, IN_TABLE, ON_CARD, ON_LINES, with_above
from stair_inspector.quantity_types import LINES, Quantity, RestsOn
from stair_inspector.stability import words_about
from stair_inspector.units import (
    NOT_KNOWN,
    ShownUnit,
    Unit,
    difference_text,
    is_finer_than_a_fraction,
    length_text,
    measured_text,
    number_text,
    parts_text,
    shown_in,
    value_and_u,
)
from stair_inspector.viewer.bridge.markup import (
    DIM,
    FLIGHT,
    LINE,
    chip,
    hint_of,
    mm,
    pick_script,
    press_attribute,
    row_start,
    table_head,
    text,
)
from stair_inspector.viewer.scene.step_marks import StepMark, mark_html

NOT_OBSERVED = "not defined for this step, or not observed"
WITHHELD = "withheld until the question about the scan is answered"
LAST_OF_FLIGHT = "the last step of its flight has none"
_TREAD_MISSING = "tread_missing"

COLUMNS = (
    ("#", "", "Step, from bottom to top"),
    *((each.head, each.notation.unit, hint_of(each)) for each in IN_TABLE),
    ("RMS", "mm", "Root mean square distance of the points from their plane, in mm; it is not the accuracy"),
    ("cov.", "", "Coverage: share of the tread that has points"),
)
_WORST = "#e8590c"
"""Underlines the two neighbours in a flight that differ most."""
_CELL = "text-align:right;padding:2px 3px;white-space:nowrap"
_REJECTED_COLUMNS = (
    ("surface", "", "Number of the surface, and its colour in the scene"),
    ("height", "m", "Mean height in the scan's frame"),
    ("area", "m²", "Area in plan"),
    ("reason", "", "Why it is no step"),
)


def columns_in(unit: Unit) -> tuple[tuple[str, str, str], ...]:
    """Return the columns with the unit of their lengths; residuals are told in millimetres at all times."""
    return tuple((name, unit if of == "mm" and name != "RMS" else of, hint) for name, of, hint in COLUMNS)


def survey_rows(
    inspection: Inspection,
    palette: Palette,
    selected: int | None,
    pick_uuid: str | None,
    unit: Unit = "mm",
    folded: frozenset[int] = frozenset(),
    marks: Mapping[int, StepMark] | None = None,
) -> str:
    """Return the rows of the survey's table: for each flight its headline, then, unless folded, a row for each step."""
    marks = marks or {}
    rows = []
    above = {step.step_id: other for step, other in with_above(inspection.steps)}
    for flight, steps in _by_flight(inspection):
        is_folded = flight is not None and flight.flight_id in folded
        if flight is not None:
            rows.append(_flight_row(flight, unit, pick_uuid, is_folded=is_folded))
        elif inspection.flights:
            rows.append(_headline_row("In no flight", "", ""))
        if not is_folded:
            worst = _worst_of(flight)
            rows += [
                _step_row(
                    inspection,
                    step,
                    above.get(step.step_id),
                    palette,
                    step.step_id == selected,
                    pick_uuid,
                    unit,
                    worst,
                    marks.get(step.step_id),
                )
                for step in steps
            ]
    return "".join(rows)


def card_html(inspection: Inspection | None, selected: int | None, palette: Palette, unit: Unit = "mm") -> str:
    """Return everything the survey knows of the chosen step; empty for none, and where no survey has been made."""
    step = step_of(inspection, selected)
    if inspection is None or step is None or not inspection.flights:
        return '<div data-testid="card"></div>'
    notes = notes_of(inspection, step.step_id)
    flight = f" · flight {step.flight}" if step.flight is not None else ""
    told = "".join(f"<li>{text(on_page(note.message))}</li>" for note in notes)
    told = f'<ul style="margin:4px 0 0;padding-left:16px">{told}</ul>' if told else ""
    return (
        '<div data-testid="card" class="si-results" style="font-size:12px;line-height:1.35;margin:2px 9px 6px;'
        f'padding:6px 9px;border:1px solid {LINE};border-radius:5px;font-variant-numeric:tabular-nums">'
        f"<b>{chip(palette.of_step(step.step_id))} Step {step.step_id}</b>"
        f'<span style="color:{DIM}"> · {text(step.kind)}{flight}</span>'
        f"{_lines_table(inspection, step, unit)}{_facts(inspection, step, unit)}{told}</div>"
    )


def rejected_html(
    inspection: Inspection | None, color: Rgb, selected: int | None, pick_uuid: str | None, *, is_shown: bool
) -> str:
    """Return the list of rejected surfaces with the reason of each, the largest first.

    Parameters
    ----------
    inspection : Inspection, optional
        None is an empty list.
    color : Rgb
        Of rejected surfaces in the scene.
    selected : int, optional
        Surface whose row is emphasised.
    pick_uuid : str, optional
        Identity of the control that a click on a row writes to.
    is_shown : bool
        False for an empty list.
    """
    if inspection is None or not is_shown:
        return '<div data-testid="rejected"></div>'
    patches = rejected_of(inspection)
    rows = "".join(
        f"{row_start(pick_uuid, patch.patch_id, SURFACE, is_selected=patch.patch_id == selected)}"
        f'<td style="{_CELL}">{chip(color)} {patch.patch_id}</td><td style="{_CELL}">{patch.height_m:.3f}</td>'
        f'<td style="{_CELL}">{patch.area_m2:.2f}</td>'
        f'<td style="padding:2px 4px 2px 8px;font-weight:400">{text(patch.reason or "no reason given")}</td></tr>'
        for patch in patches[:MOST_REJECTED]
    )
    n_more = len(patches) - MOST_REJECTED
    more = f'<div style="color:{DIM};padding:2px 5px">and {n_more} smaller ones</div>' if n_more > 0 else ""
    words = "No surface was rejected." if inspection.patches else "This result has no surfaces to reject."
    none = "" if patches else f'<div style="color:{DIM};padding:2px 9px">{words}</div>'
    head = table_head(_REJECTED_COLUMNS, ("reason",)) if patches else ""
    return (
        '<div data-testid="rejected" class="si-results" style="font-size:11.5px;line-height:1.3;padding:0 12px 6px 0">'
        '<table data-testid="rejected-table" style="border-collapse:collapse;width:100%;'
        f'font-variant-numeric:tabular-nums">{head}<tbody>{rows}</tbody></table>{none}{more}</div>'
    )


def notes_of(inspection: Inspection, step_id: int) -> list[Note]:
    """Return what there is to say about a step."""
    return [note for note in inspection.notes if note.step == step_id]


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
    if statistics.max_adjacent is None or statistics.at is None:
        return f"{words} {unit}"
    return f"{words}, {_worst_words(statistics, unit)}"


def _worst_words(statistics: Statistics, unit: Unit) -> str:
    low, high = statistics.at or (0, 0)
    return f"largest step to step {difference_text(statistics.max_adjacent or 0.0, unit)} ({low}→{high})"


def _worst_of(flight: Flight | None) -> dict[str, Statistics]:
    """Return for rise and going the statistics that name the two neighbours which differ most."""
    found = {each.name: each.statistics_of(flight) for each in COMPARED} if flight is not None else {}
    return {name: each for name, each in found.items() if each is not None and each.at is not None}


def _by_flight(inspection: Inspection) -> list[tuple[Flight | None, list[Step]]]:
    """Return the steps flight by flight, then those that belong to none."""
    groups: list[tuple[Flight | None, list[Step]]] = []
    for flight in inspection.flights:
        own = set(flight.step_ids)
        groups.append((flight, [step for step in inspection.steps if step.step_id in own]))
    taken = {step_id for flight in inspection.flights for step_id in flight.step_ids}
    rest = [step for step in inspection.steps if step.step_id not in taken]
    return [*groups, (None, rest)] if rest else groups


def _flight_row(flight: Flight, unit: Unit, pick_uuid: str | None, *, is_folded: bool) -> str:
    rise, going = range_text("rise", flight.rise, unit), range_text("going", flight.going, unit)
    width = f"width {measured_text(flight.width_m, unit)}" if flight.width_m is not None else ""
    means = (_mean("rise", flight.rise, unit), going, _mean("going", flight.going, unit))
    hint = "; ".join(part for part in (*means, width) if part)
    fold = ""
    if pick_uuid is not None:
        press = press_attribute(pick_script(pick_uuid, flight.flight_id, FLIGHT))
        words = f"{'unfold' if is_folded else 'fold'} flight {flight.flight_id}"
        fold = (
            f'<button type="button" data-testid="fold" aria-expanded="{"false" if is_folded else "true"}" '
            f'aria-label="{words}" title="{words}" {press} style="border:0;background:none;'
            f'padding:0 4px 0 0;cursor:pointer;color:inherit;font-size:11px">{"▸" if is_folded else "▾"}</button>'
        )
    return _headline_row(flight_text(flight), rise, hint, flight.flight_id, fold)


def _headline_row(title: str, more: str, hint: str, flight_id: int | None = None, fold: str = "") -> str:
    more = f' <span style="font-weight:400;color:{DIM}">· {text(more)}</span>' if more else ""
    return (
        f'<tr data-testid="flight-row" data-flight="{"" if flight_id is None else flight_id}">'
        f'<td colspan="{len(COLUMNS)}" title="{text(hint)}" style="padding:5px 5px 2px;font-size:11px;line-height:1.3;'
        f'font-weight:600;border-bottom:1px solid {LINE}">{fold}{text(title)}{more}</td></tr>'
    )


def _mean(name: str, statistics: Statistics | None, unit: Unit) -> str:
    return "" if statistics is None else f"mean {name} of {statistics.n}: {length_text(statistics.mean, unit)}"


def _step_row(
    inspection: Inspection,
    step: Step,
    above: Step | None,
    palette: Palette,
    is_selected: bool,
    pick_uuid: str | None,
    unit: Unit,
    worst: dict[str, Statistics],
    mark: StepMark | None,
) -> str:
    def worst_words(name: str) -> str:
        statistics = worst.get(name)
        is_worst = statistics is not None and step.step_id in (statistics.at or ())
        return f"the {name}'s {_worst_words(statistics, unit)}" if statistics is not None and is_worst else ""

    cells = [
        _cell(
            quantity.of(step, above),
            shown_in(quantity.unit, unit),
            _why(inspection, step, quantity),
            words_about(inspection, step.step_id, quantity),
            (quantity.name, worst_words(quantity.name)),
        )
        for quantity in IN_TABLE
    ]
    cells += [
        f'<td style="{_CELL}">{mm(step.plane.rms_m, 2)}</td>',
        f'<td style="{_CELL}">{_coverage(step.coverage, _why_missing(inspection, step, "tread", ("coverage",)))}</td>',
    ]
    name = f' <div style="font-size:10px;color:{DIM}">landing</div>' if step.kind == "landing" else ""
    return (
        f"{row_start(pick_uuid, step.step_id, '', is_selected=is_selected)}"
        '<td style="padding:2px 4px;white-space:nowrap">'
        f"{chip(palette.of_step(step.step_id))} {step.step_id}{mark_html(mark)}{name}</td>"
        f"{''.join(cells)}</tr>"
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
    small = f' <span style="{place};font-size:10px;color:{DIM};font-weight:400">'
    if measured is None:
        return f'<td title="{text(why)}" style="{_CELL}">–{small}</span></td>'
    hint = f"{measured_text(measured, unit)} (k = 2): {parts_text(measured, unit)}"
    value, u = value_and_u(measured, unit)
    u = f"±{u}"
    if unit == "in":
        u = f"{value} {u}" if is_finer_than_a_fraction(measured.u) else u
        value = number_text(measured.value, unit)
    name, words = worst
    if words:
        value = (
            f'<span data-testid="worst-{name}" title="{text(words)}" '
            f'style="border-bottom:2px solid {_WORST}">{value}</span>'
        )
    if moves:
        # Something is in doubt that u does not hold.
        style = f"border-bottom:2px dotted {_WORST}"
        value = f'<span data-testid="unsettled" title="{text(moves)}" style="{style}">{value}</span>'
    return f'<td title="{text(hint)}" style="{_CELL}">{value}{small}{u}</span></td>'


def _why(inspection: Inspection, step: Step, quantity: Quantity) -> str:
    """Return why a quantity of a step is missing."""
    return _why_missing(inspection, step, quantity.rests_on, quantity.note_words)


def _why_missing(inspection: Inspection, step: Step, rests_on: RestsOn, words: Sequence[str]) -> str:
    """Return the notes that speak of a value with one of these words, and never one about another quantity."""
    if inspection.is_withheld:
        return WITHHELD
    from_here_up = rests_on in ("to_next", "both")
    from_below = rests_on in ("from_below", "both")
    about = []
    for note in inspection.notes:
        if note.code == _TREAD_MISSING:
            # It is told of the step above the gap, whose rise it takes, with the going of the step below.
            concerns = (from_here_up and note.step == step.step_id + 1) or (from_below and note.step == step.step_id)
        elif note.code in NO_NOSING:
            # An edge that is none takes its step's values, the going up to it and the rise over it.
            low, high = step.step_id - from_below, step.step_id + from_here_up
            concerns = note.step is not None and low <= note.step <= high
        else:
            concerns = note.step == step.step_id and any(word in note.code or word in note.message for word in words)
        about += [note.message] if concerns else []
    if not about and from_here_up and any(flight.step_ids[-1:] == (step.step_id,) for flight in inspection.flights):
        return LAST_OF_FLIGHT
    return "; ".join(about) or NOT_OBSERVED


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


def _lines_table(inspection: Inspection, step: Step, unit: Unit) -> str:
    """Return rise and going on the three measuring lines, the centre with its uncertainty."""
    head = "".join(
        f'<th style="text-align:right;font-weight:400;color:{DIM};padding:2px 0 0 10px">{name}</th>' for name in LINES
    )
    rows = []
    for quantity in ON_LINES:
        name, shown = quantity.label, shown_in(quantity.unit, unit)
        why = _why(inspection, step, quantity)
        left, _, right = quantity.lines_of(step)
        centre, hint = _fact(quantity.of(step), shown, why)
        cells = "".join(
            f'<td style="text-align:right;padding-left:10px" title="{text(title)}">{value}</td>'
            for value, title in (
                (number_text(left, shown), why if left is None else shown),
                (centre, hint),
                (number_text(right, shown), why if right is None else shown),
            )
        )
        rows.append(f'<tr data-testid="card-{name}"><td style="color:{DIM}">{name}</td>{cells}</tr>')
    return (
        f'<table style="border-collapse:collapse;width:100%"><thead><tr><th></th>{head}</tr></thead>'
        f"<tbody>{''.join(rows)}</tbody></table>"
    )


def _facts(inspection: Inspection, step: Step, unit: Unit) -> str:
    """Return the other values as pairs of name and value, two to a line."""
    coverage = "–" if step.coverage is None else f"{100.0 * step.coverage:.0f} %"
    rms = "–" if step.plane.rms_m is None else f"{mm(step.plane.rms_m, 2)} mm"
    above = next((other for below, other in with_above(inspection.steps) if below is step), None)
    facts = [
        *(
            (
                each.label,
                *_fact(each.of(step, above), shown_in(each.unit, unit), _why(inspection, step, each)),
            )
            for each in ON_CARD
            if each.on_lines is None
        ),
        ("coverage", coverage, "Share of the tread that has points"),
        ("points", f"{step.plane.n_points:,}", "Points of the tread"),
        ("RMS", rms, "Of the points' distances from their plane; it is not the accuracy"),
    ]
    pairs = "".join(
        f'<span style="color:{DIM}">{name}</span>'
        f'<span title="{text(hint)}" style="text-align:right;white-space:nowrap">{value}</span>'
        for name, value, hint in facts
    )
    return (
        '<div data-testid="card-facts" style="display:grid;grid-template-columns:auto 1fr auto 1fr;gap:1px 8px;'
        f'border-top:1px solid {LINE};margin-top:4px;padding-top:4px">{pairs}</div>'
    )


def _fact(measured: Measured | None, unit: ShownUnit, why: str) -> tuple[str, str]:
    """Return a value with its uncertainty, and what that is made of or why there is none."""
    if measured is None:
        return NOT_KNOWN, why
    return measured_text(measured, unit), parts_text(measured, unit)
