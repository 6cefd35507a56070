"""An inspection, a check, a rule set and the quantities as plain text, as a terminal shows them."""

import itertools
import unicodedata
from collections.abc import Iterable, Sequence

from stair_inspector.codes.findings import DECISIONS, Check, Finding, Verdict, gravest
from stair_inspector.codes.phrases import gap_text, in_place_of, limit_words, limits_text, place_text, value_text
from stair_inspector.codes.rule_sets import OWN_FILE, RuleSet
from stair_inspector.codes.rules import GRADES, Rule
from stair_inspector.content.document import Column, Table, table_of
from stair_inspector.content.examination import examination_lines
from stair_inspector.content.tables import MADE_BY
from stair_inspector.content.verdicts import verdict_sentence
from stair_inspector.model import Inspection
from stair_inspector.quantities import IN_TABLE, PAPER_QUANTITIES, QUANTITIES, SHOWN_OF_PAPER, with_above
from stair_inspector.quantity_types import PaperQuantity, Quantity
from stair_inspector.units import measured_text, shown, shown_in, value_and_u

_STATISTICS = {
    "each": "each step",
    "flight_range": "largest less smallest of a flight",
    "adjacent_difference": "between neighbours",
    "flight": "of a flight",
}


def inspection_text(inspection: Inspection) -> str:
    """Return what was found about a scan, the survey's or the paper's table of its steps, and its notes.

    Lengths are millimetres, angles degrees.
    """
    scan = inspection.scan
    steps = f"{len(inspection.steps)} step{'' if len(inspection.steps) == 1 else 's'}"
    normals = f", normals by {MADE_BY[inspection.normals_by]}" if inspection.params.method == "paper" else ""
    lines = [f"{scan.name}: {scan.n_used:,} of {scan.n_points:,} points, {steps}{normals}"]
    if inspection.steps:
        lines += _survey_rows(inspection) if inspection.flights else _paper_rows(inspection)
    lines += [f"  {note.message}" for note in inspection.notes]
    return examined_text(inspection) + "\n".join(lines)


def examined_text(inspection: Inspection) -> str:
    """Return what was found about a scan before it was measured, a line for each; nothing where nothing was."""
    if not inspection.examination:
        return ""
    lines = [f"{inspection.scan.name} examined:", *(f"  {line}" for line in examination_lines(inspection))]
    return "\n".join(lines) + "\n"


def _survey_rows(inspection: Inspection) -> list[str]:
    """Return the survey's values, each with its expanded uncertainty (k = 2), flight by flight."""
    names = [f"{each.head}_{_ascii_unit(each)}" for each in IN_TABLE]
    lines = ["  " + f"{'step':>13}" + "".join(f"{name:>18}" for name in names) + f"{'coverage':>10}"]
    for flight in inspection.flights:
        risers = f"{flight.n_risers} riser{'' if flight.n_risers == 1 else 's'}"
        radius = flight.radius_m
        shape = flight.shape if radius is None else f"{flight.shape}, radius {measured_text(radius, 'm', 2)}"
        goes_on = "" if flight.goes_on is None else f"; goes on: {flight.goes_on}"
        lines.append(f"  flight {flight.flight_id}: {shape}, {risers}{goes_on}")
        for step, above in with_above(inspection.steps):
            if step.flight != flight.flight_id:
                continue
            cells = [
                "-"
                if (measured := each.of(step, above)) is None
                else " ± ".join(value_and_u(measured, shown_in(each.unit, "mm")))
                for each in IN_TABLE
            ]
            coverage = "-" if step.coverage is None else f"{100.0 * step.coverage:.0f} %"
            kind = "" if step.kind == "tread" else f"{step.kind} "
            lines.append(
                "  " + f"{kind}{step.step_id}".rjust(13) + "".join(f"{cell:>18}" for cell in cells) + f"{coverage:>10}"
            )
    return lines


def _paper_rows(inspection: Inspection) -> list[str]:
    names = [f"{each.symbol if each.symbol.isascii() else each.name}_{_ascii_unit(each)}" for each in SHOWN_OF_PAPER]
    columns = ("step", "points", *names, "RMS_mm")
    lines = ["  " + "".join(f"{name:>11}" for name in columns)]
    for step in inspection.steps:
        rms_mm = None if step.plane.rms_m is None else step.plane.rms_m * 1000.0
        cells = [f"{step.step_id:>11}", f"{step.plane.n_points:>11}"]
        for each in SHOWN_OF_PAPER:
            value = each.of_paper(step.paper)
            cells.append(f"{'-':>11}" if value is None else f"{value * each.notation.scale:>11.1f}")
        cells.append(f"{'-':>11}" if rms_mm is None else f"{rms_mm:>11.2f}")
        lines.append("  " + "".join(cells))
    return lines


def _ascii_unit(quantity: Quantity | PaperQuantity) -> str:
    """Return the unit in which a quantity is shown as a terminal's column has it."""
    return {"°": "deg", "%": "percent"}.get(quantity.notation.unit, quantity.notation.unit)


def check_text(check: Check) -> str:
    """Return a check as text: the set and the decision rule, a row per rule, what is outside, what was not judged."""
    lines = [*_head_of(check), "", *_indented(aligned(_table_of_rules(check))), ""]
    lines += _section("outside", _outside(check))
    lines += _section("not measured or not judged", _unjudged(check))
    lines += _section("the scan is not fit for", _fits_of(check, "not fit"))
    lines += _section("whether the scan is fit cannot be said for", _fits_of(check, "cannot be said"))
    lines += _section("not assessed from a scan", check.not_assessed)
    lines += _section("notes", check.notes)
    return "\n".join([*lines, f"  {verdict_sentence(check)}"])


def rule_sets_text(rule_sets: Sequence[RuleSet]) -> str:
    """Return a row per rule set: id, edition, grades, name and variant, SHA-256 of its file."""

    def name(rule_set: RuleSet) -> str:
        words = ", ".join(part for part in (rule_set.name, rule_set.variant) if part)
        return f"{words} [overlay]" if rule_set.is_overlay else words

    table = table_of(
        "sets",
        "",
        rule_sets,
        (Column("id"), lambda rule_set: rule_set.set_id),
        (Column("grades"), lambda rule_set: rule_set.grades),
        (Column("edition"), lambda rule_set: rule_set.edition),
        (Column("name and variant"), name),
    )
    head, *rows = aligned(table)
    lines = [head]
    for row, rule_set in zip(rows, rule_sets, strict=True):
        lines += [row, f"    SHA-256 {rule_set.sha256}"]
    return "\n".join([*lines, "", *(f"grade {grade}: {words}" for grade, words in GRADES.items())])


def quantities_text() -> str:
    """Return what is measured, a row for each quantity: name, unit in JSON, what building codes call it, what it is."""
    groups: dict[str, list[Quantity | PaperQuantity]] = {
        "of a step": [each for each in QUANTITIES if each.of_step is not None],
        "of a flight": [each for each in QUANTITIES if each.of_step is None],
        "of a step, by the paper's method": list(PAPER_QUANTITIES),
    }
    lines = []
    for title, group in groups.items():
        table = table_of(
            "quantities",
            title,
            group,
            (Column("name"), lambda each: each.name),
            (Column("unit"), lambda each: each.unit),
            (Column("building codes"), lambda each: (isinstance(each, Quantity) and each.code_term) or "-"),
            (Column("what it is"), lambda each: each.definition),
        )
        lines += [f"{title}:", *_indented(aligned(table)), ""]
    return "\n".join(lines).rstrip()


def rule_set_text(rule_set: RuleSet) -> str:
    """Return a rule set with all its records."""
    lines = [f"{rule_set.set_id}: {rule_set.title}", f"  source: {rule_set.source}"]
    lines += [f"  file: {rule_set.file}, SHA-256 {rule_set.sha256}", ""]
    for rule in rule_set.rules:
        lines += _record_of(rule)
    lines += _section("not assessed from a scan", rule_set.not_assessed)
    return "\n".join(lines).rstrip()


def _head_of(check: Check) -> Iterable[str]:
    rule_set = check.rule_set
    yield f"checked against {rule_set.set_id}: {rule_set.title}"
    yield f"  rule file {rule_set.file or 'none'}, SHA-256 {rule_set.sha256 or 'none'}"
    for overlay in rule_set.overlays:
        yield f"  with the overlay {overlay}"
    for edit in rule_set.edits:
        change = f"{edit.side} {limit_words(edit.before)} became {limit_words(edit.after)}"
        yield f"  edited by the user: {edit.rule_id}, {change}: {edit.reason}"
    if not rule_set.is_edited:
        yield f"  edited by the user: {rule_set.edited_words}"
    elif not rule_set.is_shipped:
        yield f"  {OWN_FILE}"
    yield f"  {DECISIONS[check.decision]}"


def _table_of_rules(check: Check) -> Table:
    rules = check.rule_set.rules
    found = [check.of_rule(rule.rule_id) for rule in rules]

    def margin(worst: Finding) -> str:
        has_margin = worst.margin is not None and worst.verdict is not Verdict.REPORTED
        return shown(worst.rule.quantity, worst.margin) if has_margin and worst.margin is not None else "-"

    return table_of(
        "rules",
        "",
        [(gravest(findings), findings, fit) for findings, fit in zip(found, check.fits, strict=True)],
        (Column("rule"), lambda each: each[0].rule.rule_id),
        (Column("clause"), lambda each: each[0].rule.clause),
        (Column("limit"), lambda each: limits_text(check.rule_set, each[0].rule)),
        (Column("value that decides"), lambda each: _value_of(each[0])),
        (Column("margin"), lambda each: margin(each[0])),
        (Column("at"), lambda each: place_text(each[0])),
        (Column("scan"), lambda each: each[2].short),
        (Column("result"), lambda each: _result_of(each[0], each[1])),
    )


def _value_of(found: Finding) -> str:
    """Return the value; with what it is of, where that is less than the clause limits."""
    is_less = found.rule.from_scan == "partly" and found.rule.quantity == "width" and found.value is not None
    return f"{value_text(found)} (tread width)" if is_less else value_text(found)


def _result_of(worst: Finding, findings: Sequence[Finding]) -> str:
    words = worst.verdict.words
    if worst.rule.severity == "advisory" and worst.verdict.is_outside:
        words += " (advisory)"
    if len(findings) == 1:
        return words
    alike = sum(found.verdict.is_outside for found in findings) if worst.verdict.is_outside else 0
    alike = alike or sum(found.verdict is worst.verdict for found in findings)
    return words if alike == len(findings) else f"{words}: {alike} of {len(findings)}"


def _outside(check: Check) -> Iterable[str]:
    for found in check.findings:
        if found.verdict.is_outside and found.limit is not None and found.margin is not None:
            less = ", which is less than U" if found.verdict is Verdict.OUTSIDE_CLOSE else ""
            side = "at least" if found.side == "minimum" else "at most"
            edit = check.edit_behind(found)
            yield (
                f"{found.rule.term}, {place_text(found)}: {value_text(found)}, outside by "
                f"{gap_text(found.rule, -found.margin)}{less}; {found.rule.clause}: {side} {found.limit.text}"
                + ("" if edit is None else f", set by the user {in_place_of(edit)}")
                + (f" (for {found.rule.applies})" if found.rule.applies else "")
                + (f"; {found.reason}" if found.reason else "")
            )


def _unjudged(check: Check) -> Iterable[str]:
    unsure = [found for found in check.findings if found.verdict in (Verdict.NOT_MEASURED, Verdict.NOT_JUDGED)]
    # One reason, such as no staircase, may stand for all rules.
    for (place, reason), group in itertools.groupby(
        sorted(unsure, key=lambda found: (place_text(found), found.reason)),
        key=lambda found: (place_text(found), found.reason),
    ):
        rules = list(dict.fromkeys(found.rule.rule_id for found in group))
        yield f"{place}: {reason} ({', '.join(rules)})"


def _fits_of(check: Check, answer: str) -> Iterable[str]:
    return (f"{fit.rule_id}: {fit.words.removeprefix(f'{answer}: ')}" for fit in check.fits if fit.short == answer)


def _record_of(rule: Rule) -> Iterable[str]:
    yield f"  {rule.rule_id}: {rule.term}, {rule.limit_text} ({rule.clause})"
    measure = (
        "not assessed from a scan" if rule.from_scan == "no" else f"{rule.quantity}, {_STATISTICS[rule.statistic]}"
    )
    severity = rule.severity.replace("_", " ")
    yield f"      measured as: {measure}; severity: {severity}; from a scan: {rule.from_scan}; grade: {rule.grade}"
    if rule.applies:
        yield f"      applies to: {rule.applies}"
    if rule.only_where is not None:
        yield f"      only where: {rule.only_where.quantity} below {rule.only_where.below.text}"
    if rule.note:
        yield f"      {rule.note}"
    yield ""


def _section(title: str, sentences: Iterable[str]) -> list[str]:
    rows = [f"    {sentence}" for sentence in sentences]
    return [f"  {title}:", *rows, ""] if rows else []


def aligned(table: Table) -> list[str]:
    """Return the head and the rows of a table, its columns aligned, two spaces between them."""
    heads = [column.title for column in table.columns]
    cells = [[column.text(cell) for column, cell in zip(table.columns, row, strict=True)] for row in table.rows]
    widths = [max(map(_width, column)) for column in zip(heads, *cells, strict=True)]
    return [
        "  ".join(cell + " " * (width - _width(cell)) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in (heads, *cells)
    ]


def _width(text: str) -> int:
    """Return how many places of a terminal a text takes: those of East Asian letters are two wide."""
    return sum(
        0 if unicodedata.combining(letter) else 2 if unicodedata.east_asian_width(letter) in "WF" else 1
        for letter in text
    )


def _indented(lines: Iterable[str]) -> list[str]:
    return [f"  {line}" for line in lines]
