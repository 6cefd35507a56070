"""A check and a rule set as plain text, as a terminal shows them."""

import itertools
import unicodedata
from collections.abc import Iterable, Sequence

from stair_inspector.codes.findings import DECISIONS, Check, Finding, Verdict, gravest
from stair_inspector.codes.rules import GRADES, OWN_FILE, Limit, Rule, RuleEdit, RuleSet
from stair_inspector.codes.words import display_of, shown, u_text

_STATISTICS = {
    "each": "each step",
    "flight_range": "largest less smallest of a flight",
    "adjacent_difference": "between neighbours",
    "flight": "of a flight",
}


def check_text(check: Check) -> str:
    """Return a check as text: the set and the decision rule, a row per rule, what is outside, what was not judged."""
    lines = [*_head_of(check), "", *_indented(_table(_rows_of(check))), ""]
    lines += _section("outside", _outside(check))
    lines += _section("not measured or not judged", _unjudged(check))
    lines += _section("the scan is not fit for", _fits_of(check, "not fit"))
    lines += _section("whether the scan is fit cannot be said for", _fits_of(check, "cannot be said"))
    lines += _section("not assessed from a scan", check.not_assessed)
    lines += _section("notes", check.notes)
    return "\n".join([*lines, f"  {verdict_sentence(check)}"])


def verdict_sentence(check: Check) -> str:
    """Return what the check comes to, in one sentence that claims no more than was measured."""
    limits = [found for found in check.findings if found.rule.severity == "limit"]
    outside = [found for found in limits if found.verdict is Verdict.OUTSIDE]
    close = [found for found in limits if found.verdict is Verdict.OUTSIDE_CLOSE]
    warned = [found for found in check.findings if found.verdict.is_outside and found.rule.severity == "advisory"]
    unsure = [found for found in check.findings if found.is_open]
    title = check.rule_set.title + (" and its overlays" if check.rule_set.overlays else "")
    parts = []
    if outside or close:
        parts += [*_beyond(check, outside, "outside"), *_beyond(check, close, "outside, but by less than U,")]
        parts[0] += f" ({title})"
    elif any(found.verdict.is_within for found in limits):
        parts.append(f"nothing that was measured is outside a limit of {title}")
    else:
        parts.append(f"nothing could be judged against a limit of {title}")
    near = sum(found.verdict is Verdict.WITHIN_CLOSE for found in limits)
    if near:
        parts.append(f"{near} value{' is' if near == 1 else 's are'} within, but nearer to a limit than U")
    if warned:
        parts.append(f"outside the advice of {_clauses(warned)}")
    parts += [*_reported_beyond(check), *_without_number(check)]
    if unsure and all(found.flight is None for found in unsure):
        # One reason, such as no staircase, stands for all rules: no count of values says more.
        reasons = dict.fromkeys(found.reason.partition(": ")[0] for found in unsure)
        is_withheld = any(found.verdict is Verdict.NOT_JUDGED for found in unsure)
        what = "no value is given" if is_withheld else "nothing was measured"
        parts.append(f"{what}, which is no pass: {', '.join(reasons)}")
    elif any(found.verdict is Verdict.NOT_MEASURED for found in unsure):
        count = sum(found.verdict is Verdict.NOT_MEASURED for found in unsure)
        parts.append(f"{count} value{' was' if count == 1 else 's were'} not measured, which is no pass")
    if any(found.verdict is Verdict.NOT_JUDGED and found.flight is not None for found in unsure):
        parts.append("what was not judged is no pass either")
    if check.rule_set.n_changed:
        count = check.rule_set.n_changed
        parts.append(f"{count} limit{' was' if count == 1 else 's were'} changed by the user")
    sentence = "; ".join(parts)
    return sentence[0].upper() + sentence[1:] + "."


def _beyond(check: Check, found: Sequence[Finding], how: str) -> Iterable[str]:
    """Say beyond which clauses' limits values are; a limit that the user has set is none that a clause lists."""
    listed = [each for each in found if check.edit_behind(each) is None]
    changed = [(each, edit) for each in found if (edit := check.edit_behind(each)) is not None]
    replaced = [each for each, edit in changed if edit.before is not None]
    added = [each for each, edit in changed if edit.before is None]
    if listed:
        yield f"{how} the limits listed in {_clauses(listed)}"
    if replaced:
        yield f"{how} limits set by the user in place of those of {_clauses(replaced)}"
    for side in dict.fromkeys(each.side for each in added):
        alike = [each for each in added if each.side == side]
        yield f"{how} a {side} set by the user, where there is none in {_clauses(alike)}"


def _reported_beyond(check: Check) -> Iterable[str]:
    """Say the value furthest beyond the number of every clause that is reported only: no tick stands for it either."""
    for rule in check.rule_set.rules:
        beyond = [found for found in check.of_rule(rule.rule_id) if found.is_reported_beyond]
        if beyond:
            found = gravest(tuple(beyond))
            side = "less than the minimum" if found.side == "minimum" else "more than the maximum"
            yield (
                f"{rule.term}: {value_text(found)}, {place_text(found)}, is {side} of {rule.clause}, "
                f"{limit_words(found.limit)}{f' (for {rule.applies})' if rule.applies else ''}, which is reported only "
                "and for the inspector to judge"
            )


def _without_number(check: Check) -> Iterable[str]:
    """Say the largest value of every clause that asks for something and gives no number: no tick stands for it."""
    told: dict[str, list[str]] = {}
    for rule in check.rule_set.rules:
        values = [found for found in check.of_rule(rule.rule_id) if found.value is not None]
        if not rule.has_number and values:
            found = max(values, key=lambda each: abs(each.value or 0.0))
            words = f"{rule.term}: {value_text(found)}, {place_text(found)}"
            is_taken = check.rule_set.is_changed(rule.rule_id)
            lead = "after a change by the user gives" if is_taken else "gives"
            told.setdefault(f"{rule.clause} {lead}", []).append(words)
    for lead, parts in told.items():
        yield f"{lead} no number for {', nor for '.join(parts)}, which is for the inspector to judge"


def rule_sets_text(rule_sets: Sequence[RuleSet]) -> str:
    """Return a row per rule set: id, edition, grades, name and variant, SHA-256 of its file."""
    rows: list[Sequence[str]] = [("id", "grades", "edition", "name and variant")]
    for each in rule_sets:
        name = ", ".join(part for part in (each.name, each.variant) if part)
        rows.append((each.set_id, each.grades, each.edition, f"{name} [overlay]" if each.is_overlay else name))
    lines = []
    for row, rule_set in zip(_table(rows), (None, *rule_sets), strict=True):
        lines.append(row)
        if rule_set is not None:
            lines.append(f"    SHA-256 {rule_set.sha256}")
    return "\n".join([*lines, "", *(f"grade {grade}: {words}" for grade, words in GRADES.items())])


def rule_set_text(rule_set: RuleSet) -> str:
    """Return a rule set with all its records."""
    lines = [f"{rule_set.set_id}: {rule_set.title}", f"  source: {rule_set.source}"]
    lines += [f"  file: {rule_set.file}, SHA-256 {rule_set.sha256}", ""]
    for rule in rule_set.rules:
        lines += _record_of(rule)
    lines += _section("not assessed from a scan", rule_set.not_assessed)
    return "\n".join(lines).rstrip()


def value_text(found: Finding) -> str:
    """Return a finding's value with its uncertainty and unit: ``192.9 ± 0.1 mm``; a dash where there is none.

    The value is rounded where its uncertainty is, as a report does.
    """
    if found.value is None:
        return "-"
    if not found.u:
        return shown(found.rule.quantity, found.value)
    scale, unit, _ = display_of(found.rule.quantity)
    u = u_text(scale * found.u)
    digits = len(u.partition(".")[2])
    gap = "" if unit == "°" else " "
    return f"{round(scale * found.value, digits) + 0.0:.{digits}f} ± {u}{gap}{unit}"


def limit_words(limit: Limit | None) -> str:
    """Return a limit for people; ``no limit`` where there is none."""
    return "no limit" if limit is None else limit.text


def in_place_of(edit: RuleEdit) -> str:
    """Return what a limit of the user's stands for: ``in place of 7 in (177.8 mm)``, ``where the code has none``."""
    return "where the code has none" if edit.before is None else f"in place of {edit.before.text}"


def limits_text(rule_set: RuleSet, rule: Rule) -> str:
    """Return a rule's limits for people, with a mark where the user has changed one: it is none of the clause."""
    return f"{rule.limit_text} (edited)" if rule_set.is_changed(rule.rule_id) else rule.limit_text


def place_text(found: Finding) -> str:
    """Return where a finding is: ``step 5``, ``steps 4 and 5``, ``flight 1``, ``scan``."""
    if len(found.steps) == 1:
        return f"step {found.steps[0]}"
    if found.steps:
        return "steps " + " and ".join(str(step) for step in found.steps)
    return "scan" if found.flight is None else f"flight {found.flight}"


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


def _rows_of(check: Check) -> list[Sequence[str]]:
    rows: list[Sequence[str]] = [("rule", "clause", "limit", "value that decides", "margin", "at", "scan", "result")]
    rule_set = check.rule_set
    for rule, fit in zip(rule_set.rules, check.fits, strict=True):
        findings = check.of_rule(rule.rule_id)
        worst = gravest(findings)
        has_margin = worst.margin is not None and worst.verdict is not Verdict.REPORTED
        margin = shown(rule.quantity, worst.margin) if has_margin and worst.margin is not None else "-"
        rows.append(
            (
                rule.rule_id,
                rule.clause,
                limits_text(rule_set, rule),
                _value_of(worst),
                margin,
                place_text(worst),
                fit.short,
                _result_of(rule, worst, findings),
            )
        )
    return rows


def _value_of(found: Finding) -> str:
    """Return the value; with what it is of, where that is less than the clause limits."""
    is_less = found.rule.from_scan == "partly" and found.rule.quantity == "width" and found.value is not None
    return f"{value_text(found)} (tread width)" if is_less else value_text(found)


def _result_of(rule: Rule, worst: Finding, findings: Sequence[Finding]) -> str:
    words = worst.verdict.words
    if rule.severity == "advisory" and worst.verdict.is_outside:
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


def gap_text(rule: Rule, gap: float) -> str:
    """Return a distance to a limit; one that rounds to nothing is not shown as nothing."""
    scale, _, digits = display_of(rule.quantity)
    least = 10.0**-digits / scale
    return f"less than {shown(rule.quantity, least)}" if 0.0 < gap < least / 2.0 else shown(rule.quantity, gap)


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


def _clauses(findings: Iterable[Finding]) -> str:
    return "; ".join(dict.fromkeys(found.rule.clause for found in findings))


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


def _table(rows: Sequence[Sequence[str]]) -> list[str]:
    """Return the rows with their columns aligned, two spaces between them."""
    widths = [max(map(_width, column)) for column in zip(*rows, strict=True)]
    lines = []
    for row in rows:
        cells = (cell + " " * (width - _width(cell)) for cell, width in zip(row, widths, strict=True))
        lines.append("  ".join(cells).rstrip())
    return lines


def _width(text: str) -> int:
    """Return how many places of a terminal a text takes: those of East Asian letters are two wide."""
    return sum(
        0 if unicodedata.combining(letter) else 2 if unicodedata.east_asian_width(letter) in "WF" else 1
        for letter in text
    )


def _indented(lines: Iterable[str]) -> list[str]:
    return [f"  {line}" for line in lines]
