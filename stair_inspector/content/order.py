"""What goes into a report, and in which order: from an inspection, a check and the user's fields to a document."""

import dataclasses
from collections.abc import Iterable
from datetime import datetime

from stair_inspector.codes.findings import DECISIONS, Check
from stair_inspector.content import cross_checks, grounds, rule_tables, tables, wording
from stair_inspector.content.change_blocks import CHANGES, change_blocks
from stair_inspector.content.document import (
    EMPTY,
    Block,
    Bullets,
    Document,
    Facts,
    Figure,
    KeyFigure,
    KeyFigures,
    Paragraph,
    Section,
    Signatures,
    plain,
)
from stair_inspector.content.examination import examination_table
from stair_inspector.content.fields import ReportBasis, ReportFields
from stair_inspector.content.finding_list import list_findings
from stair_inspector.content.finding_tables import finding_blocks
from stair_inspector.content.identity import identification_blocks, instrument_blocks
from stair_inspector.content.note_words import note_words
from stair_inspector.content.pins import PinnedFindings
from stair_inspector.content.settings_tables import overrules_table, settings_table
from stair_inspector.content.uncertainty_words import uncertainty_sentences
from stair_inspector.model import ComparedScan, Inspection, Statistics
from stair_inspector.units import tidy

_TITLE = "Stair survey report"
_SIGN_OFF = "Sign-off"
_FRONT_FIELDS = ("client", "site", "building", "stair", "survey_date", "inspector")
"""What stands under the title."""


@dataclasses.dataclass(frozen=True, slots=True)
class Pictures:
    """The report's pictures by the place at which they stand; any of them may be missing."""

    front: tuple[Figure, ...] = ()
    views: tuple[Figure, ...] = ()
    bars: tuple[Figure, ...] = ()
    nosing_lines: tuple[Figure, ...] = ()
    residuals: tuple[Figure, ...] = ()
    changes: tuple[Figure, ...] = ()
    drawings: tuple[Figure, ...] = ()


def build_document(
    inspection: Inspection,
    check: Check | None,
    basis: ReportBasis,
    made_at: datetime,
    pictures: Pictures | None = None,
    pinned: PinnedFindings | None = None,
    compared: ComparedScan | None = None,
    results: str = "",
) -> Document:
    """Return a report's content: the same input gives the same document.

    Parameters
    ----------
    inspection : Inspection
        The result, with or without a staircase.
    check : Check, optional
        The same inspection held against a rule set.
    basis : ReportBasis
        What the user adds.
    made_at : datetime
        Date and time that the report bears: the only thing that differs between two reports of the same input.
    pictures : Pictures, optional
        See :func:`stair_inspector.writers.figures.draw_pictures`.
    pinned : PinnedFindings, optional
        Pins of the inspector, and what was said of findings.
    compared : ComparedScan, optional
        What changed against a second scan.
    results : str, optional
        Name and SHA-256 of the file of results that belongs to the report.
    """
    listed = list_findings(inspection, check, pinned or PinnedFindings())
    pictures = pictures or Pictures()
    sections: list[tuple[str, list[Block]]] = [
        ("Summary", _summary(inspection, check)),
        ("Findings", finding_blocks(listed)),
        ("Identification", identification_blocks(basis, check)),
        ("Instrument and scan", instrument_blocks(inspection, basis, results)),
        ("Views", _views(pictures, basis)),
        ("Dimensions of the steps", _steps(inspection, check, pictures)),
        ("Uniformity", _uniformity(inspection, pictures)),
        ("Check against the rule set", _check(inspection, check)),
        (CHANGES, [] if compared is None else change_blocks(compared, pictures.changes)),
        ("Closure and readings by hand", _closure(inspection, basis)),
        ("Plan and section", list(pictures.drawings)),
        ("Accuracy and uncertainty", _accuracy(inspection)),
        ("Limitations and what was not assessed", _limitations(inspection, check, basis)),
        (_SIGN_OFF, _sign_off(basis)),
    ]
    appendices: list[tuple[str, list[Block]]] = [
        ("Settings and decisions", [overrules_table(inspection), settings_table(inspection.params)]),
        ("Notes of the measurement", [grounds.notes_table(inspection)]),
        # Heights of treads are rises by a subtraction.
        ("Surfaces found in the scan", [] if inspection.is_withheld else [grounds.surfaces_table(inspection)]),
        ("Quantities of the paper's method", [] if inspection.is_withheld else [tables.paper_table(inspection)]),
    ]
    numbered = [(str(number), *section) for number, section in enumerate(_filled(sections), 1)]
    lettered = [(chr(ord("A") + k), *section) for k, section in enumerate(_filled(appendices))]
    fields = basis.fields
    return Document(
        title=plain(fields.title) or _TITLE,
        identity=tuple((ReportFields.label_of(name), plain(getattr(fields, name))) for name in _FRONT_FIELDS),
        firm=plain(fields.firm),
        logo=basis.logo,
        reference=_reference(fields),
        made_at=made_at,
        paper=basis.paper,
        front=tuple(_front(inspection, check, pictures)),
        sections=tuple(
            Section(number, title, tuple(blocks), starts_page=number in ("1", "A") or title == CHANGES)
            for number, title, blocks in (*numbered, *lettered)
        ),
    )


def _has_values(inspection: Inspection) -> bool:
    """Return whether there is a value of the survey: where one is withheld, tables of dashes would say nothing."""
    return bool(inspection.flights) and not inspection.is_withheld


def _filled(sections: Iterable[tuple[str, list[Block]]]) -> list[tuple[str, list[Block]]]:
    return [(title, blocks) for title, blocks in sections if blocks]


def _reference(fields: ReportFields) -> str:
    parts = (("Report", fields.report_number), ("revision", fields.revision))
    return ", ".join(f"{word} {plain(text)}" for word, text in parts if text)


def _front(inspection: Inspection, check: Check | None, pictures: Pictures) -> list[Block]:
    status = None if check is None else wording.verdict_of(check)
    blocks: list[Block] = [Paragraph(wording.result_sentence(inspection, check), "lead")]
    changed = "" if check is None else wording.changed_limits_sentence(check)
    if changed:
        blocks.append(Paragraph(changed))
    if inspection.examination:
        blocks.append(examination_table(inspection))
    figures = _key_figures(inspection)
    if figures or status is not None:
        blocks.append(KeyFigures(figures, status))
    return [*blocks, *pictures.front]


def _key_figures(inspection: Inspection) -> tuple[KeyFigure, ...]:
    """Return the numbers that one looks for first, over all flights."""
    flights = inspection.flights
    if not _has_values(inspection):
        return ()
    found = [
        KeyFigure(
            str(sum(flight.n_risers for flight in flights)), "", "risers" if len(flights) == 1 else "risers in all"
        )
    ]
    for name, label in (("rise", "mean rise"), ("going", "mean going")):
        known: list[Statistics] = [each for flight in flights if (each := getattr(flight, name)) is not None]
        if known:
            mean_m = sum(each.mean * each.n for each in known) / sum(each.n for each in known)
            found.append(KeyFigure(_fixed(mean_m * 1000.0, 1), "mm", label))
    pitches = [flight.pitch_deg for flight in flights if flight.pitch_deg is not None]
    if pitches:
        shown = dict.fromkeys(_fixed(pitch.value, 1) for pitch in pitches)
        found.append(KeyFigure(" / ".join(shown) if len(shown) < 3 else _range(list(shown)), "°", "pitch"))
    rises = [flight.rise for flight in flights if flight.rise is not None and flight.rise.max_adjacent is not None]
    if rises:
        worst = max(rises, key=lambda each: each.max_adjacent or 0.0)
        steps = "" if worst.at is None else f", steps {worst.at[0]} and {worst.at[1]}"
        found.append(
            KeyFigure(
                _fixed((worst.max_adjacent or 0.0) * 1000.0, 1), "mm", f"largest step-to-step change of rise{steps}"
            )
        )
    return tuple(found)


def _range(shown: list[str]) -> str:
    ordered = sorted(shown, key=float)
    return f"{ordered[0]}–{ordered[-1]}"


def _fixed(value: float, digits: int) -> str:
    return f"{tidy(value, digits):.{digits}f}"


def _summary(inspection: Inspection, check: Check | None) -> list[Block]:
    blocks: list[Block] = []
    if check is not None:
        outside = wording.outside_sentences(check)
        if outside:
            blocks.append(Bullets(outside))
        changed = wording.changed_limits_sentence(check)
        if changed:
            blocks.append(Paragraph(changed, "remark"))
    if _has_values(inspection):
        blocks.append(tables.flights_table(inspection))
    if check is not None and _has_values(inspection):
        blocks.append(rule_tables.results_table(check))
        blocks.append(Paragraph(_decision_words(check), "remark"))
    # Where nothing was measured a row for each rule would say the same as all others.
    return blocks or [Paragraph(wording.result_sentence(inspection, check))]


def _decision_words(check: Check) -> str:
    return f"Decision rule: {plain(DECISIONS[check.decision])}"


def _views(pictures: Pictures, basis: ReportBasis) -> list[Block]:
    photos = [
        Figure(
            f"photo_{number}",
            f"Photograph {number}" + (f": {plain(photo.caption)}" if photo.caption else ""),
            plain(photo.caption) or f"photograph {number} of the site",
            "jpeg",
            photo.data,
            0.5,
        )
        for number, photo in enumerate(basis.photos, 1)
    ]
    return [*pictures.views, *photos]


def _steps(inspection: Inspection, check: Check | None, pictures: Pictures) -> list[Block]:
    if not _has_values(inspection):
        return []
    return [
        tables.steps_table(inspection, check),
        *pictures.bars,
        Bullets(wording.DEFINITIONS),
        tables.evidence_table(inspection, check),
        *pictures.residuals,
    ]


def _uniformity(inspection: Inspection, pictures: Pictures) -> list[Block]:
    return [tables.uniformity_table(inspection), *pictures.nosing_lines] if _has_values(inspection) else []


def _check(inspection: Inspection, check: Check | None) -> list[Block]:
    if check is None:
        return []
    rules = check.rule_set
    items = (
        ("Rule set", plain(rules.name)),
        ("Edition", plain(rules.edition)),
        ("Variant", plain(rules.variant) or "general"),
        ("Id", plain(rules.set_id)),
        ("Source", plain(rules.source)),
        ("Rule file", plain(rules.file) or EMPTY),
        ("SHA-256 of the file", plain(rules.sha256) or EMPTY),
        ("Edited by the user", rules.edited_words),
        ("Overlays", "; ".join(plain(words) for words in rules.overlays) or "none"),
    )
    blocks: list[Block] = [Facts("rule_set", "Rule set", items, columns=1), Paragraph(_decision_words(check))]
    if rules.is_edited:
        blocks.append(rule_tables.edits_table(check))
    if _has_values(inspection):
        blocks.append(rule_tables.by_step_table(inspection, check))
    blocks.append(rule_tables.findings_table(check))
    if _has_values(inspection):
        blocks.append(rule_tables.fits_table(check))
    if check.notes:
        blocks.append(Bullets(tuple(note_words(note) for note in check.notes)))
    return blocks


def _closure(inspection: Inspection, basis: ReportBasis) -> list[Block]:
    closure: list[Block] = [cross_checks.closure_table(inspection)] if _has_values(inspection) else []
    return [*closure, cross_checks.readings_table(inspection, basis)]


def _accuracy(inspection: Inspection) -> list[Block]:
    sentences: list[Block] = [Paragraph(sentence) for sentence in uncertainty_sentences(inspection)]
    return [*sentences, *([grounds.budget_table(inspection)] if _has_values(inspection) else [])]


def _limitations(inspection: Inspection, check: Check | None, basis: ReportBasis) -> list[Block]:
    blocks: list[Block] = [Bullets(wording.limitation_sentences(inspection, check))]
    further = plain(basis.fields.limitations)
    blocks.append(
        Facts("limitations", "Stated by the inspector", ((ReportFields.label_of("limitations"), further),), 1)
    )
    if check is not None and check.not_assessed:
        blocks.append(Paragraph(f"Not assessed, though {plain(check.rule_set.title)} limits it:"))
        blocks.append(Bullets(tuple(plain(sentence) for sentence in check.not_assessed)))
    blocks.append(rule_tables.checklist_table(basis.checklist))
    return blocks


def _sign_off(basis: ReportBasis) -> list[Block]:
    fields = basis.fields
    inspector = (
        ("Name", plain(fields.signed_by or fields.inspector)),
        ("Function", plain(fields.signed_as)),
        ("Licence", plain(fields.licence)),
        ("Date", plain(fields.signed_on)),
    )
    reviewer = (("Name", plain(fields.reviewed_by)), ("Date", plain(fields.reviewed_on)))
    words = (
        "The measurements were made with the instrument and the settings stated in this report. The numbers come from "
        "the scan named by its SHA-256; the texts, readings and photographs are the inspector's."
    )
    return [Paragraph(words), Signatures((("Inspector", inspector), ("Reviewer", reviewer)))]
