"""The tables of a check: what each clause limits, what was found, and whether the scan is good enough to say so."""

from collections.abc import Sequence

from stair_inspector.codes.at_steps import findings_at_steps, outside_at_steps
from stair_inspector.codes.findings import Check, Finding, Verdict, gravest
from stair_inspector.codes.phrases import limit_words, limits_text
from stair_inspector.codes.rules import GRADES, Rule
from stair_inspector.content.cells import numbers_of, outside_counts
from stair_inspector.content.document import Cell, Column, Number, Status, Table, Tone, plain
from stair_inspector.content.fields import Checklist
from stair_inspector.content.note_words import note_words
from stair_inspector.model import Inspection
from stair_inspector.quantities import QUANTITIES
from stair_inspector.units import notation_of, places_of

_MAPPED = {quantity.name: quantity.words for quantity in QUANTITIES if quantity.is_other_in_codes}
"""Quantities whose name in a code is not ours, or is that of another of ours: a US tread depth is our going."""
TONES: dict[Verdict, Tone] = {
    Verdict.WITHIN: "good",
    Verdict.WITHIN_CLOSE: "close",
    Verdict.OUTSIDE_CLOSE: "close",
    Verdict.OUTSIDE: "bad",
}
"""The tone of a verdict; the others say nothing of a limit."""


def status_of(verdict: Verdict) -> Status:
    """Return a verdict with its tone."""
    return Status(verdict.words, TONES.get(verdict, "plain"))


def scaled(rule: Rule, value: float | None, *, is_u: bool = False) -> Cell:
    """Return a value of a rule's quantity in the unit in which it is shown."""
    if value is None:
        return None
    scale, _, digits = notation_of(rule.quantity)
    number = round(value * scale, 6)
    return number if is_u else Number(number, digits)


def measured_cell(rule: Rule, value: float | None, u: float | None) -> Cell:
    """Return a measured value in the unit in which it is shown, rounded where its uncertainty is."""
    if value is None:
        return None
    scale, _, digits = notation_of(rule.quantity)
    return Number(round(value * scale, 6), places_of(None if u is None else u * scale, digits))


def margin_cell(rule: Rule, margin: float | None) -> Cell:
    """Return a distance to a limit; one that would be rounded to nothing has as many decimals as show it."""
    if margin is None:
        return None
    scale, _, digits = notation_of(rule.quantity)
    number = round(margin * scale, 6)
    while number and not round(number, digits):
        digits += 1
    return Number(number, digits)


def unit_of(rule: Rule) -> str:
    """Return the unit in which values of a rule's quantity are shown."""
    return notation_of(rule.quantity).unit


def results_table(check: Check) -> Table:
    """Return one row per rule and flight: the finding that matters most, of how many."""
    columns = (
        Column("Clause", width=1.5),
        Column("What is limited", width=2.6),
        Column("Limit as written", width=1.8),
        Column("Flight", digits=0),
        Column("Measured", digits=2),
        Column("U", digits=2, is_u=True),
        Column("Margin", digits=2),
        Column("Unit"),
        Column("At steps"),
        Column("Findings", width=1.4),
        Column("Result"),
    )
    rows: list[tuple[Cell, ...]] = []
    tones: list[tuple[int, Tone]] = []
    for rule in check.rule_set.rules:
        findings = check.of_rule(rule.rule_id)
        for flight in dict.fromkeys(found.flight for found in findings):
            here = tuple(found for found in findings if found.flight == flight)
            worst = gravest(here)
            tone = TONES.get(worst.verdict, "plain")
            if tone in ("bad", "close"):
                tones.append((len(rows), tone))
            rows.append(
                (
                    plain(rule.clause),
                    limited_words(rule),
                    plain(limits_text(check.rule_set, rule)),
                    flight,
                    measured_cell(rule, worst.value, worst.u),
                    scaled(rule, worst.u, is_u=True),
                    margin_cell(rule, worst.margin),
                    unit_of(rule),
                    numbers_of(worst.steps) if len(here) > 1 or len(worst.steps) > 1 else "",
                    _counted(here),
                    status_of(worst.verdict),
                )
            )
    note = (
        "One row per rule and flight, with the finding nearest to its limit or furthest beyond it. Margin: distance to "
        "that limit, negative beyond it. Limits are compared with their exact size as written, not with a rounded one."
    ) + _edited_note(check)
    return Table("rules", "Results by rule", columns, tuple(rows), note, "The rule set has no rule.", tuple(tones))


def findings_table(check: Check) -> Table:
    """Return every finding that is not plainly within a limit, or says why nothing can be said."""
    columns = (
        Column("Clause", width=1.5),
        Column("What is limited", width=2.2),
        Column("Flight", digits=0),
        Column("Steps"),
        Column("Measured", digits=2),
        Column("U", digits=2, is_u=True),
        Column("Margin", digits=2),
        Column("Unit"),
        Column("Result"),
        Column("Reason", width=2.8),
    )
    told = [found for found in check.findings if found.verdict.is_listed]
    shared = _shared_reason(check, told)
    if shared:
        told = []
    rows: list[tuple[Cell, ...]] = []
    tones: list[tuple[int, Tone]] = []
    for found in told:
        tone = TONES.get(found.verdict, "plain")
        if tone in ("bad", "close"):
            tones.append((len(rows), tone))
        rows.append(
            (
                plain(found.rule.clause),
                limited_words(found.rule),
                found.flight,
                numbers_of(found.steps),
                measured_cell(found.rule, found.value, found.u),
                scaled(found.rule, found.u, is_u=True),
                margin_cell(found.rule, found.margin),
                unit_of(found.rule),
                status_of(found.verdict),
                "; ".join(part for part in (_edited_words(check, found), note_words(found.reason)) if part),
            )
        )
    return Table(
        "findings",
        "Findings that are not plainly within",
        columns,
        tuple(rows),
        empty=shared or "Every value that was held against a limit is within it by more than its uncertainty.",
        tones=tuple(tones),
    )


def _shared_reason(check: Check, told: Sequence[Finding]) -> str:
    """Return the one sentence that says why nothing could be judged; empty where there is more than one reason."""
    reasons = {found.reason for found in told}
    if check.is_judged or len(told) < 2 or len(reasons) > 1:
        return ""
    (reason,) = reasons
    return f"None of the {len(told)} rules and flights could be judged: {note_words(reason)}." if reason else ""


def by_step_table(inspection: Inspection, check: Check) -> Table:
    """Return what is said of every step by every rule that says something of single steps, as the page marks them."""
    told = findings_at_steps(inspection, check)
    outside = outside_at_steps(inspection, check)
    named = {found.rule.rule_id for findings in told.values() for found in findings}
    rules = [rule for rule in check.rule_set.rules if rule.rule_id in named]
    columns = (
        Column("Step", digits=0),
        *(
            Column(f"{plain(rule.clause)}: {limited_words(rule)}", plain(limits_text(check.rule_set, rule)), width=1.2)
            for rule in rules
        ),
    )
    rows: list[tuple[Cell, ...]] = []
    tones: list[tuple[int, Tone]] = []
    for step_id, findings in told.items():
        cells: list[Cell] = [step_id]
        for rule in rules:
            here = tuple(found for found in findings if found.rule.rule_id == rule.rule_id)
            cells.append(_status_at(gravest(here)) if here else None)
        row_tones = {cell.tone for cell in cells if isinstance(cell, Status)}
        if step_id in outside:
            tones.append((len(rows), TONES[gravest(outside[step_id]).verdict]))
        elif row_tones & {"bad", "close"}:
            tones.append((len(rows), "close"))
        rows.append(tuple(cells))
    note = (
        "A difference of neighbours, or the range of a flight, that is outside its limit stands at the step that is "
        "farther from the median of its flight; one that is inside at both steps. – says nothing of this step."
    )
    note += _edited_note(check)
    return Table("by_step", "Results by step", columns, tuple(rows), note, "No step was judged.", tuple(tones))


def _status_at(found: Finding) -> Status:
    """Return the verdict of a finding; advice is called so, because it makes no step one that is outside."""
    status = status_of(found.verdict)
    is_advice = found.rule.severity == "advisory" and found.verdict.is_outside
    return Status(f"{status.words} (advice)", "close") if is_advice else status


def fits_table(check: Check) -> Table:
    """Return for every rule whether the scan is good enough to judge it."""
    columns = (
        Column("Clause", width=1.5),
        Column("What is limited", width=2.6),
        Column("Largest U", digits=2, is_u=True),
        Column("Tolerance", digits=2),
        Column("Unit"),
        Column("Fit for this check?"),
        Column("In words", width=3.0),
        Column("Source"),
    )
    rules = {rule.rule_id: rule for rule in check.rule_set.rules}
    rows: list[tuple[Cell, ...]] = []
    tones: list[tuple[int, Tone]] = []
    for fit in check.fits:
        rule = rules[fit.rule_id]
        if fit.is_fit is False:
            tones.append((len(rows), "close"))
        state = _FIT.get(fit.short, Status("nothing to say", "plain"))
        rows.append(
            (
                plain(rule.clause),
                limited_words(rule),
                scaled(rule, fit.u, is_u=True),
                scaled(rule, fit.tolerance),
                unit_of(rule) if fit.u is not None else "",
                state,
                plain(fit.words) + ("; a limit was edited" if check.rule_set.is_changed(rule.rule_id) else ""),
                rule.grade,
            )
        )
    grades = "; ".join(f"{grade}: {words}" for grade, words in GRADES.items())
    note = (
        "The largest uncertainty of the values is held against the room that the rule leaves. A check for which the "
        f"scan is not fit can still be outside for certain. Source, of the limit in the rule file: {grades}."
    )
    return Table("fits", "Is the scan good enough for each check?", columns, tuple(rows), note, "", tuple(tones))


def edits_table(check: Check) -> Table:
    """Return the limits that a user has changed, oldest first."""
    columns = (
        Column("Rule", width=2.0),
        Column("Side", width=1.1),
        Column("Before", width=1.5),
        Column("After", width=1.5),
        Column("Reason", width=3.0),
    )
    rows = tuple(
        (
            plain(edit.rule_id),
            edit.side,
            plain(limit_words(edit.before)),
            plain(limit_words(edit.after)),
            plain(edit.reason),
        )
        for edit in check.rule_set.edits
    )
    return Table("edits", "Limits edited by the user", columns, rows, empty="No limit was edited by the user.")


def checklist_table(checklist: Checklist) -> Table:
    """Return what no scan shows, with what the inspector saw of it or that it was not assessed."""
    columns = (Column("Item", width=2.0), Column("Seen on site", width=3.0))
    rows: list[tuple[Cell, ...]] = []
    for name in Checklist.__dataclass_fields__:
        seen = getattr(checklist, name)
        rows.append((Checklist.label_of(name), plain(seen) if seen else Status("not assessed", "plain")))
    return Table("checklist", "Checked on site, not by the scan", columns, tuple(rows))


def limited_words(rule: Rule) -> str:
    """Return what a rule limits: the code's own term, and our word where the same word means another thing."""
    words = plain(rule.term)
    ours = _MAPPED.get(rule.quantity, "")
    return f"{words} (our {ours})" if ours and ours not in words.casefold() else words


def _edited_note(check: Check) -> str:
    """Return what the mark of an edited limit means; empty where there is none."""
    if not check.rule_set.n_changed:
        return ""
    return " (edited): changed by the user, and not a limit of the clause; 'Limits edited by the user' has both."


def _edited_words(check: Check, found: Finding) -> str:
    """Return the limit that a finding was held against where the user has set it."""
    if check.edit_behind(found) is None or found.limit is None:
        return ""
    return f"{found.side} {plain(found.limit.text)}, set by the user"


def _counted(findings: tuple[Finding, ...]) -> str:
    """Return how many findings a row stands for, and how many of them are of its verdict."""
    if len(findings) == 1:
        return "1"
    worst = gravest(findings).verdict
    if worst.is_outside:
        return f"{len(findings)}: {outside_counts(findings)}"
    same = sum(found.verdict is worst for found in findings)
    return f"{len(findings)}, of which {same} {worst.words}" if same < len(findings) else f"{len(findings)}, all so"


_FIT = {
    "fit": Status("fit", "good"),
    "not fit": Status("not fit", "close"),
    "cannot be said": Status("cannot be said", "plain"),
}
