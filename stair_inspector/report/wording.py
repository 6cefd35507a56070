"""The sentences of a report. It says within or outside the limit of a clause; it never passes a legal judgement."""

import math

from stair_inspector.codes.findings import Check, Finding, Verdict, gravest
from stair_inspector.codes.text import verdict_sentence
from stair_inspector.codes.words import display_of
from stair_inspector.model import Inspection, Measured
from stair_inspector.report.cells import numbers_of
from stair_inspector.report.document import Status, plain
from stair_inspector.report.units import tidy, u_text

_LOA = ((0.001, "LOA50 (0 to 1 mm)"), (0.005, "LOA40 (1 to 5 mm)"), (0.015, "LOA30 (5 to 15 mm)"))
_LOA_COARSEST = (0.050, "LOA20 (15 to 50 mm)")
"""Levels of accuracy by the uncertainty at 95 %, as secondary sources quote the USIBD's specification."""

DEFINITIONS = (
    "Rise: vertical, from the nosing below (or the floor or landing before the lowest riser) to this step's nosing.",
    "Going: horizontal, square to the nosing, from this nosing to the next; US codes call it tread depth.",
    "Tread depth: from the nosing to the face of the riser above, or to the tread's back edge.",
    "Overhang: tread depth less going, square to the nosing above.",
    "Width: between the side edges of the tread; not the clear width between handrails or walls.",
    "Pitch: angle of the line from this nosing to the next; of a flight, of the line fitted to all its nosings.",
    "2R + G: twice the rise to a step and its going.",
)


def measured_words(measured: Measured, unit: str, digits: int = 1) -> str:
    """Return a value with its uncertainty: ``170.1 ± 0.4 mm``; metres and degrees in."""
    scale = 1000.0 if unit == "mm" else 1.0
    gap = "" if unit == "°" else " "
    value = f"{tidy(measured.value * scale, digits):.{digits}f}"
    return f"{value} ± {u_text(measured.u * scale)}{gap}{unit}"


def verdict_of(check: Check) -> Status:
    """Return the result of a whole check in a few words."""
    judged = [found for found in check.findings if found.rule.severity == "limit"]
    verdicts = {found.verdict for found in judged}
    if Verdict.OUTSIDE in verdicts:
        return Status("values outside limits", "bad")
    if Verdict.OUTSIDE_CLOSE in verdicts:
        return Status("values outside limits, by less than U", "close")
    if not check.is_judged:
        return Status("nothing could be judged", "plain")
    # A rule that does not apply to a step leaves nothing open.
    is_open = any(found.verdict is Verdict.NOT_JUDGED and found.rule.only_where is None for found in judged)
    if Verdict.NOT_MEASURED in verdicts or is_open:
        return Status("what was measured is within; not all was", "close")
    return Status("measured values within limits", "good")


def result_sentence(inspection: Inspection, check: Check | None) -> str:
    """Return what the report says first."""
    stair = _stair_words(inspection)
    if not inspection.steps:
        reason = next((note.message for note in inspection.notes if note.code == "no_staircase"), "no staircase found")
        return f"{plain(reason[:1].upper() + reason[1:])}."
    if check is None:
        return f"{stair} This report states measurements; no rule set was applied."
    return f"{stair} {plain(verdict_sentence(check))}"


def outside_sentences(check: Check) -> tuple[str, ...]:
    """Return one sentence for every rule and flight with a value outside its limit, the furthest beyond."""
    sentences = []
    for rule in check.rule_set.rules:
        outside = [found for found in check.of_rule(rule.rule_id) if found.verdict.is_outside]
        for flight in dict.fromkeys(found.flight for found in outside):
            here = tuple(found for found in outside if found.flight == flight)
            sentences.append(_outside_sentence(check, gravest(here), len(here)))
    return tuple(sentences)


def _outside_sentence(check: Check, found: Finding, n: int) -> str:
    rule = found.rule
    scale, unit, digits = display_of(rule.quantity)
    gap = "" if unit in ("", "°") else " "
    value = f"{tidy((found.value or 0.0) * scale, digits):.{digits}f}"
    u = "" if not found.u else f" ± {u_text(found.u * scale)}"
    beyond = f"{tidy(abs(found.margin or 0.0) * scale, digits):.{digits}f}{gap}{unit}"
    place = f"flight {found.flight}" if found.flight is not None else "the stair"
    steps = ""
    if found.steps:
        steps = f", {'step' if len(found.steps) == 1 else 'steps'} {numbers_of(found.steps)}"
    limit = plain(found.limit.text) if found.limit is not None else "no number"
    close = ", by less than U" if found.verdict is Verdict.OUTSIDE_CLOSE else ""
    more = f"; {n} findings of this rule are outside, this is the furthest" if n > 1 else ""
    kind = "advisory limit" if rule.severity == "advisory" else "limit"
    return (
        f"{place[:1].upper()}{place[1:]}{steps}: {plain(rule.term)} is {value}{u}{gap}{unit}, outside the {kind} "
        f"{limit} listed in {plain(rule.clause)}, {_edition_words(check)}, by {beyond}{close}{more}."
    )


def _edition_words(check: Check) -> str:
    rules = check.rule_set
    overlays = " or its overlay" if rules.overlays else ""
    return f"{plain(rules.name)}, {plain(rules.edition)}{overlays}"


def uncertainty_sentences(inspection: Inspection) -> tuple[str, ...]:
    """Return the statement on accuracy and uncertainty, in words."""
    sentences = [
        "Every value is stated with its expanded uncertainty U: the standard uncertainty, combined from its parts in "
        "quadrature and multiplied by the coverage factor k = 2, which corresponds to a level of confidence of about "
        "95 %. It is evaluated as the Guide to the Expression of Uncertainty in Measurement (JCGM 100) says.",
        "The parts are: noise, from the scatter of the points about each plane and edge, counted in blocks so that "
        "points that err together count once (type A); edge, what the definition of a nosing or back edge leaves open; "
        "up, the direction of the vertical; registration, from one step to the next; scale (type B where the user "
        "states them).",
        _stated_sentence(inspection),
        *_levelling_sentences(inspection),
        "The RMS of a plane is not its accuracy: it mixes noise and the texture of the surface. With thousands of "
        "points the random error of a plane's height is small; what remains is registration, range bias, levelling and "
        "the definition of edges.",
        "A difference between neighbouring rises rests on three heights, so its uncertainty is larger than that of one "
        "rise; the range of a flight is the spread of many values, which noise alone makes larger than zero. Both are "
        "judged with an uncertainty of their own.",
    ]
    sentences += _loa_sentence(inspection)
    return tuple(sentences)


def _stated_sentence(inspection: Inspection) -> str:
    stated = inspection.params.uncertainty
    values = (
        (stated.registration_m * 1000.0, "mm of registration from one step to the next"),
        (stated.edge_m * 1000.0, "mm of a nosing or back edge"),
        (stated.side_m * 1000.0, "mm of a side edge"),
        (stated.slope_deg, "° of a tread's fall"),
        (stated.up_deg, "° of the vertical"),
        (stated.scale_percent, "% of scale"),
    )
    parts = [f"{value:g}{'' if words.startswith('°') else ' '}{words}" for value, words in values if value]
    if not parts:
        return (
            "Nothing was stated about the scanner: U holds what the scan itself shows, and not what registration, "
            "levelling, range bias and the rounding of edges add. The true uncertainty is larger."
        )
    return "Stated about the scanner, as standard uncertainties (k = 1): " + ", ".join(parts) + "."


def _levelling_sentences(inspection: Inspection) -> list[str]:
    up = inspection.up
    source = {
        "given": "was given by the user",
        "floor": "was taken from the floor",
        "treads": "was taken from the treads",
    }[up.source]
    stated = inspection.params.uncertainty.up_deg
    if up.u_deg is None and not stated:
        known = "; how well it is known was not stated, so that it is taken as exact"
        u_deg = 0.0
    else:
        u_deg = math.hypot(up.u_deg or 0.0, 2.0 * stated)
        known = f" and is known to ± {u_text(u_deg)}° (k = 2)"
    sentences = [f"The vertical {source}{known}."]
    goings = [step.going_m.value for step in inspection.steps if step.going_m is not None]
    if goings and u_deg:
        mean_m = sum(goings) / len(goings)
        shift_mm = mean_m * math.sin(math.radians(u_deg)) * 1000.0
        percent = math.tan(math.radians(u_deg)) * 100.0
        sentences.append(
            f"A tilt of that size along the flight shifts every rise by {u_text(shift_mm)} mm (the mean going of "
            f"{mean_m * 1000.0:.1f} mm times its sine) and every slope by {u_text(percent)} %. It shifts all rises "
            "alike: their differences survive bad levelling, the size of a rise and the slope of a tread do not."
        )
    return sentences


def _loa_sentence(inspection: Inspection) -> list[str]:
    doubts = [value.u for step in inspection.steps for value in (step.rise_m, step.going_m) if value is not None]
    if not doubts:
        return []
    worst = max(doubts)
    level = next((name for most, name in (*_LOA, _LOA_COARSEST) if worst <= most), "coarser than LOA20")
    return [
        f"The largest U of a rise or going is {u_text(worst * 1000.0)} mm, which lies in {level} of the USIBD Level of "
        "Accuracy specification at 95 %. Judging differences between neighbouring risers needs LOA40 or better."
    ]


def limitation_sentences(inspection: Inspection, check: Check | None) -> tuple[str, ...]:
    """Return what the report does not say, as far as the program knows."""
    sentences = [
        "The report describes the surfaces that the scan shows, as they were on the day of the scan.",
        "Width is that of the treads between their side edges; the clear width between handrails or walls was not "
        "measured.",
        "Rise and going are those of the nosings on three lines across the tread; between the lines they were not "
        "evaluated.",
    ]
    if inspection.params.method == "paper":
        sentences.append(
            "The scan was measured by the paper's method: rise, going and width from nosing to nosing were not "
            "measured, and no limit of a code applies to its values."
        )
    codes = {note.code for note in inspection.notes}
    if "unit_guessed" in codes:
        sentences.append(f"The unit of the scan was guessed: {inspection.scan.unit}. A wrong unit scales every length.")
    winding = [flight for flight in inspection.flights if flight.shape != "straight"]
    if winding:
        numbers = numbers_of(flight.flight_id for flight in winding)
        sentences.append(
            f"Flight {numbers} winds. Its steps are measured about their own nosings; codes measure on a walking line, "
            "and no limit was judged there."
        )
    unseen = [step.step_id for step in inspection.steps if step.rise_m is None]
    if unseen and inspection.params.method == "survey":
        sentences.append(f"Rise not measured: step {numbers_of(unseen)}. It may differ from the others.")
    if inspection.params.overrules.region.strip():
        sentences.append("Only the points in the region of interest were measured; appendix A gives its corners.")
    if check is not None:
        sentences.append(
            "Limits are those of the rule file named above; cities and states amend codes. Whether a limit applies to "
            "this stair is for the inspector to decide."
        )
        if check.rule_set.is_edited:
            sentences.append("Limits of the rule set were edited by the user; the edits are listed.")
    return tuple(sentences)


def _stair_words(inspection: Inspection) -> str:
    n_steps, n_flights = len(inspection.steps), len(inspection.flights)
    steps = f"{n_steps} step{'' if n_steps == 1 else 's'}"
    if not n_flights:
        return f"{steps} found."
    risers = sum(flight.n_risers for flight in inspection.flights)
    return (
        f"{n_flights} flight{'' if n_flights == 1 else 's'} with {risers} riser{'' if risers == 1 else 's'} found "
        "and measured."
    )
