"""The sentences of a report on accuracy and uncertainty: what U holds, what was stated, what was not."""

import math

from stair_inspector.content.cells import numbers_of
from stair_inspector.content.document import plain
from stair_inspector.content.note_words import note_sentence, note_words
from stair_inspector.model import Inspection
from stair_inspector.stated_uncertainty import UncertaintyParams
from stair_inspector.units import u_text

_LOA = ((0.001, "LOA50 (0 to 1 mm)"), (0.005, "LOA40 (1 to 5 mm)"), (0.015, "LOA30 (5 to 15 mm)"))
_LOA_COARSEST = (0.050, "LOA20 (15 to 50 mm)")
"""Levels of accuracy by the uncertainty at 95 %, as secondary sources quote the USIBD's specification."""
_ABOUT_UP = ("up_disagree", "treads_lean", "up_not_z", "floor_above_scan", "floor_not_largest")
"""Codes of the notes that put the vertical in doubt."""


def uncertainty_sentences(inspection: Inspection) -> tuple[str, ...]:
    """Return the statement on accuracy and uncertainty, in words."""
    if not inspection.flights or inspection.is_withheld:
        return _sentences_without_u(inspection)
    sentences = [
        "Values marked ± are stated with their expanded uncertainty U: the standard uncertainty, combined from its "
        "parts in quadrature and multiplied by the coverage factor k = 2, which corresponds to a level of confidence "
        "of about 95 %. It is evaluated as the Guide to the Expression of Uncertainty in Measurement (JCGM 100) says. "
        "Means, ranges, values on the single lines, residuals and heights of surfaces are given without one.",
        "The parts are: noise, from the scatter of the points about each plane and edge, counted in blocks so that "
        "points that err together count once (type A), with an allowance built into the program for the height and "
        "the slope of a surface, a share of the noise of single points (type B); edge, what the definition of a nosing "
        "or back edge leaves open: an allowance built into the program, from the spacing and the noise of the points, "
        "or half the interval in which a hidden back edge lies, and what the user states (type B); up, the direction "
        "of the vertical: the scatter of the surface from which it was taken (type A) and what the user states (type "
        "B); registration, from one step to the next, and scale: what the user states (type B).",
        *_stated_sentences(inspection.params.uncertainty),
        *_levelling_sentences(inspection),
        *doubtful_sentences(inspection),
        "The RMS of a plane is not its accuracy: it mixes noise and the texture of the surface. With thousands of "
        "points the random error of a plane's height is small; what remains is registration, range bias, levelling and "
        "the definition of edges.",
        "A difference between neighbouring rises rests on three heights, so its uncertainty is larger than that of one "
        "rise; the range of a flight is the spread of many values, which noise alone makes larger than zero. Both are "
        "judged with an uncertainty of their own.",
    ]
    sentences += _loa_sentence(inspection)
    return tuple(sentences)


def _sentences_without_u(inspection: Inspection) -> tuple[str, ...]:
    """Return what there is to say of the accuracy of a scan without values that have an uncertainty."""
    words = "Nothing was measured, and no uncertainty is stated."
    if inspection.is_withheld:
        words = "No value is given, and no uncertainty is stated."
    if inspection.params.method == "paper" and inspection.steps:
        words = (
            "The quantities of the paper's method are given without an uncertainty: the method states none. The RMS of "
            "a plane is not the accuracy of its height."
        )
    return (words, *doubtful_sentences(inspection))


def _is_unstated(stated: UncertaintyParams) -> bool:
    """Tell whether nothing is stated of what no scan shows of itself and every rise and going rests on."""
    return not (stated.registration_m or stated.edge_m or stated.up_deg)


def _stated_sentences(stated: UncertaintyParams) -> list[str]:
    """Return what the user states about the scanner, and which of the parts that weigh most were not stated."""
    sentences = []
    values = (
        (stated.registration_m * 1000.0, "mm of registration from one step to the next"),
        (stated.edge_m * 1000.0, "mm of a nosing or back edge"),
        (stated.side_m * 1000.0, "mm of a side edge"),
        (stated.slope_deg, "° of a tread's fall"),
        (stated.up_deg, "° of the vertical"),
        (stated.scale_percent, "% of scale"),
    )
    parts = [f"{value:g}{'' if words.startswith('°') else ' '}{words}" for value, words in values if value]
    if parts:
        sentences.append("Stated about the scanner, as standard uncertainties (k = 1): " + ", ".join(parts) + ".")
    weights = (
        (stated.registration_m, "registration from one step to the next"),
        (stated.edge_m, "the rounding of edges"),
        (stated.up_deg, "levelling"),
        (stated.scale_percent, "scale"),
    )
    missing = [words for value, words in weights if not value]
    if missing:
        nothing = "" if parts else "Nothing was stated about the scanner. "
        sentences.append(
            f"{nothing}Not stated: {', '.join(missing)}. U does not hold what these add beyond what the scan itself "
            "shows. The true uncertainty is larger."
        )
    return sentences


def _levelling_sentences(inspection: Inspection) -> list[str]:
    up = inspection.up
    stated = inspection.params.uncertainty.up_deg
    u_deg = math.hypot(up.u_deg or 0.0, 2.0 * stated)
    if up.source == "given":
        words = "The vertical was given by the user"
        found = "" if up.u_deg is None else f" to ± {u_text(up.u_deg)}° (k = 2)"
        unknown = "; how well it is known was not stated, so that it is taken as exact" if up.u_deg is None else ""
    else:
        surface = "floor" if up.source == "floor" else "treads"
        words = f"The vertical was taken from the {surface}"
        # How well a normal is fitted says nothing of whether the surface is level.
        found = "" if up.u_deg is None else f", the normal of which was found to ± {u_text(up.u_deg)}° (k = 2)"
        is_or_are = "floor is" if up.source == "floor" else "treads are"
        unknown = f"; whether the {is_or_are} level was not stated, and U takes it for granted"
    known = f"; with what was stated about it U takes it as known to ± {u_text(u_deg)}° (k = 2)" if stated else unknown
    sentences = [f"{words}{found}{known}."]
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
    # A level of accuracy is claimed only where something is stated of what no scan shows of itself.
    if not doubts or _is_unstated(inspection.params.uncertainty):
        return []
    worst = max(doubts)
    level = next((name for most, name in (*_LOA, _LOA_COARSEST) if worst <= most), "coarser than LOA20")
    return [
        f"The largest U of a rise or going is {u_text(worst * 1000.0)} mm, which lies in {level} of the USIBD Level of "
        "Accuracy specification at 95 %. Judging differences between neighbouring risers needs LOA40 or better."
    ]


def doubtful_sentences(inspection: Inspection) -> list[str]:
    """Return the notes that put the vertical, the unit or the sides of the treads in doubt, as sentences."""
    sentences = [note_sentence(note.message) for note in inspection.notes if note.code in _ABOUT_UP]
    for note in inspection.notes:
        if note.code == "unit_guessed":
            guess = note_words(note.message).partition(": ")[2] or plain(inspection.scan.unit)
            sentences.append(f"The unit of the scan was guessed: {guess}. A wrong unit scales every length.")
    unsure = {note.step for note in inspection.notes if note.code == "side_unobserved" and note.step is not None}
    if unsure:
        sentences.append(
            f"Step {numbers_of(unsure)}: a side was not seen, or ends inside those of the others; the width there is "
            "uncertain."
        )
    return sentences
