"""Words for what a check found: a value, a limit, a place, a distance to a limit."""

from stair_inspector.codes.findings import Finding
from stair_inspector.codes.limits import Limit
from stair_inspector.codes.rule_sets import RuleSet
from stair_inspector.codes.rules import Rule, RuleEdit
from stair_inspector.units import notation_of, shown


def value_text(found: Finding) -> str:
    """Return a finding's value with its uncertainty and unit: ``192.9 ± 0.1 mm``; a dash where there is none.

    The value is rounded where its uncertainty is, as a report does.
    """
    if found.value is None:
        return "-"
    return shown(found.rule.quantity, found.value, found.u)


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


def gap_text(rule: Rule, gap: float) -> str:
    """Return a distance to a limit; one that rounds to nothing is not shown as nothing."""
    scale, _, digits = notation_of(rule.quantity)
    least = 10.0**-digits / scale
    return f"less than {shown(rule.quantity, least)}" if 0.0 < gap < least / 2.0 else shown(rule.quantity, gap)
