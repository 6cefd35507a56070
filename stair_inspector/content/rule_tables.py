"""The tables of a check: what each clause limits, what was found, and whether the scan is good enough to say so."""

from collections.abc import Sequence

from stair_inspector.codes.at_steps import findings_at_steps, outside_at_steps
from stair_inspector.codes.findings import Check, Finding, Fit, Verdict, gravest
from stair_inspector.codes.phrases import limit_words, limits_text
from stair_inspector.codes.rules import GRADES, Rule
from stair_inspector.content.cells import numbers_of, outside_counts
from stair_inspector.content.document import Cell, Column, Number, Status, Table, TablePart, Tone, plain, table_of
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
    groups = [
        tuple(found for found in findings if found.flight == flight)
        for findings in (check.of_rule(rule.rule_id) for rule in check.rule_set.rules)
        for flight in dict.fromkeys(found.flight for found in findings)
    ]

    def at_steps(alike: tuple[Finding, ...], worst: Finding) -> str:
        return numbers_of(worst.steps) if len(alike) > 1 or len(worst.steps) > 1 else ""

    return table_of(
        "rules",
        "Results by rule",
        [(alike, gravest(alike)) for alike in groups],
        (Column("Clause", width=1.5), lambda each: plain(each[1].rule.clause)),
        (Column("What is limited", width=2.6), lambda each: limited_words(each[1].rule)),
        (Column("Limit as written", width=1.8), lambda each: plain(limits_text(check.rule_set, each[1].rule))),
        (Column("Flight", digits=0), lambda each: each[1].flight),
        (_MEASURED, lambda each: _measured_cells(each[1])),
        (Column("At steps"), lambda each: at_steps(*each)),
        (Column("Findings", width=1.4), lambda each: _counted(each[0])),
        (Column("Result"), lambda each: status_of(each[1].verdict)),
        note=(
            "One row per rule and flight, with the finding nearest to its limit or furthest beyond it. Margin: "
            "distance to that limit, negative beyond it. Limits are compared with their exact size as written, not "
            "with a rounded one."
        )
        + _edited_note(check),
        empty="The rule set has no rule.",
        tone=lambda each: TONES.get(each[1].verdict, "plain"),
    )


_MEASURED = (Column("Measured", digits=2), Column("U", digits=2, is_u=True), Column("Margin", digits=2), Column("Unit"))


def _measured_cells(found: Finding) -> tuple[Cell, ...]:
    """Return the cells under ``_MEASURED``."""
    rule = found.rule
    return (
        measured_cell(rule, found.value, found.u),
        scaled(rule, found.u, is_u=True),
        margin_cell(rule, found.margin),
        unit_of(rule),
    )


def findings_table(check: Check) -> Table:
    """Return every finding that is not plainly within a limit, or says why nothing can be said."""
    told = [found for found in check.findings if found.verdict.is_listed]
    shared = _shared_reason(check, told)

    def reason(found: Finding) -> str:
        return "; ".join(part for part in (_edited_words(check, found), note_words(found.reason)) if part)

    return table_of(
        "findings",
        "Findings that are not plainly within",
        [] if shared else told,
        (Column("Clause", width=1.5), lambda found: plain(found.rule.clause)),
        (Column("What is limited", width=2.2), lambda found: limited_words(found.rule)),
        (Column("Flight", digits=0), lambda found: found.flight),
        (Column("Steps"), lambda found: numbers_of(found.steps)),
        (_MEASURED, _measured_cells),
        (Column("Result"), lambda found: status_of(found.verdict)),
        (Column("Reason", width=2.8), reason),
        empty=shared or "Every value that was held against a limit is within it by more than its uncertainty.",
        tone=lambda found: TONES.get(found.verdict, "plain"),
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

    def cell(step_id: int, rule: Rule) -> Status | None:
        here = tuple(found for found in told[step_id] if found.rule.rule_id == rule.rule_id)
        return _status_at(gravest(here)) if here else None

    def part_of(rule: Rule) -> TablePart[int]:
        title = f"{plain(rule.clause)}: {limited_words(rule)}"
        return Column(title, plain(limits_text(check.rule_set, rule)), width=1.2), lambda step_id: cell(step_id, rule)

    rules = [rule for rule in check.rule_set.rules if rule.rule_id in named]

    def tone(step_id: int) -> Tone:
        if step_id in outside:
            return TONES[gravest(outside[step_id]).verdict]
        tones = {found.tone for rule in rules if (found := cell(step_id, rule)) is not None}
        return "close" if tones & {"bad", "close"} else "plain"

    return table_of(
        "by_step",
        "Results by step",
        told,
        (Column("Step", digits=0), lambda step_id: step_id),
        *map(part_of, rules),
        note=(
            "A difference of neighbours, or the range of a flight, that is outside its limit stands at the step that "
            "is farther from the median of its flight; one that is inside at both steps. – says nothing of this step."
        )
        + _edited_note(check),
        empty="No step was judged.",
        tone=tone,
    )


def _status_at(found: Finding) -> Status:
    """Return the verdict of a finding; advice is called so, because it makes no step one that is outside."""
    status = status_of(found.verdict)
    is_advice = found.rule.severity == "advisory" and found.verdict.is_outside
    return Status(f"{status.words} (advice)", "close") if is_advice else status


def fits_table(check: Check) -> Table:
    """Return for every rule whether the scan is good enough to judge it."""
    rules = {rule.rule_id: rule for rule in check.rule_set.rules}

    def words(rule: Rule, fit: Fit) -> str:
        return plain(fit.words) + ("; a limit was edited" if check.rule_set.is_changed(rule.rule_id) else "")

    return table_of(
        "fits",
        "Is the scan good enough for each check?",
        [(rules[fit.rule_id], fit) for fit in check.fits],
        (Column("Clause", width=1.5), lambda each: plain(each[0].clause)),
        (Column("What is limited", width=2.6), lambda each: limited_words(each[0])),
        (Column("Largest U", digits=2, is_u=True), lambda each: scaled(each[0], each[1].u, is_u=True)),
        (Column("Tolerance", digits=2), lambda each: scaled(each[0], each[1].tolerance)),
        (Column("Unit"), lambda each: unit_of(each[0]) if each[1].u is not None else ""),
        (Column("Fit for this check?"), lambda each: _FIT.get(each[1].short, Status("nothing to say", "plain"))),
        (Column("In words", width=3.0), lambda each: words(*each)),
        (Column("Source"), lambda each: each[0].grade),
        note=(
            "The largest uncertainty of the values is held against the room that the rule leaves. A check for which "
            "the scan is not fit can still be outside for certain. Source, of the limit in the rule file: "
            f"{'; '.join(f'{grade}: {meant}' for grade, meant in GRADES.items())}."
        ),
        tone=lambda each: "close" if each[1].is_fit is False else "plain",
    )


def edits_table(check: Check) -> Table:
    """Return the limits that a user has changed, oldest first."""
    return table_of(
        "edits",
        "Limits edited by the user",
        check.rule_set.edits,
        (Column("Rule", width=2.0), lambda edit: plain(edit.rule_id)),
        (Column("Side", width=1.1), lambda edit: edit.side),
        (Column("Before", width=1.5), lambda edit: plain(limit_words(edit.before))),
        (Column("After", width=1.5), lambda edit: plain(limit_words(edit.after))),
        (Column("Reason", width=3.0), lambda edit: plain(edit.reason)),
        empty="No limit was edited by the user.",
    )


def checklist_table(checklist: Checklist) -> Table:
    """Return what no scan shows, with what the inspector saw of it or that it was not assessed."""
    return table_of(
        "checklist",
        "Checked on site, not by the scan",
        Checklist.__dataclass_fields__,
        (Column("Item", width=2.0), Checklist.label_of),
        (Column("Seen on site", width=3.0), lambda name: plain(getattr(checklist, name)) or _NOT_ASSESSED),
    )


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


_NOT_ASSESSED = Status("not assessed", "plain")
_FIT = {
    "fit": Status("fit", "good"),
    "not fit": Status("not fit", "close"),
    "cannot be said": Status("cannot be said", "plain"),
}
