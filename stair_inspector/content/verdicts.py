"""What a check comes to, in one sentence that claims no more than was measured."""

from collections.abc import Iterable, Sequence

from stair_inspector.codes.findings import Check, Finding, Verdict, gravest
from stair_inspector.codes.phrases import limit_words, place_text, value_text


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
        parts.append(f"outside the advice of {_clauses_of(warned)}")
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
        yield f"{how} the limits listed in {_clauses_of(listed)}"
    if replaced:
        yield f"{how} limits set by the user in place of those of {_clauses_of(replaced)}"
    for side in dict.fromkeys(each.side for each in added):
        alike = [each for each in added if each.side == side]
        yield f"{how} a {side} set by the user, where there is none in {_clauses_of(alike)}"


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


def _clauses_of(findings: Iterable[Finding]) -> str:
    return "; ".join(dict.fromkeys(found.rule.clause for found in findings))
