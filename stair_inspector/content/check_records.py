"""A check as plain values, as its JSON holds them: SI, the unit of each rule's values beside the rule."""

from typing import Any

from stair_inspector.codes import DECISIONS, Check, Condition, Finding, Fit, Limit, Rule, RuleEdit, RuleSet
from stair_inspector.quantities import quantity_of


def check_record(check: Check) -> dict[str, Any]:
    """Return a check as the plain values of its JSON; numbers are those of the check, not rounded.

    ``value``, ``u`` (k = 2), ``margin`` and ``tolerance`` have the ``unit`` of their rule: ``m``, ``deg``, ``tangent``
    (of a slope) or ``count``.
    """
    return {
        "rule_set": _set_record(check.rule_set),
        "decision": {"rule": check.decision, "words": DECISIONS[check.decision]},
        "is_outside": check.is_outside,
        "rules": [_rule_record(rule) for rule in check.rule_set.rules],
        "findings": [_finding_record(found) for found in check.findings],
        "fits": [_fit_record(fit) for fit in check.fits],
        **by_name(check, "not_assessed", "notes"),
    }


def si_unit(rule: Rule) -> str | None:
    """Return the unit of a rule's values: ``m``, ``deg``, ``tangent`` or ``count``; None for what no scan shows."""
    return None if rule.quantity == "other" else quantity_of(rule.quantity).unit


def _set_record(rule_set: RuleSet) -> dict[str, Any]:
    names = ("name", "edition", "variant", "source", "file", "sha256", "overlays", "is_shipped", "is_edited")
    edits = [_edit_record(edit) for edit in rule_set.edits]
    return {"id": rule_set.set_id, **by_name(rule_set, *names), "edits": edits}


def by_name(value: object, *names: str) -> dict[str, Any]:
    """Return fields of a value that are called in the JSON as in the program, tuples as lists."""
    fields = {name: getattr(value, name) for name in names}
    return {name: list(field) if isinstance(field, tuple) else field for name, field in fields.items()}


def _edit_record(edit: RuleEdit) -> dict[str, Any]:
    return {
        "rule": edit.rule_id,
        "side": edit.side,
        "before": _limit_record(edit.before),
        "after": _limit_record(edit.after),
        "reason": edit.reason,
    }


def _rule_record(rule: Rule) -> dict[str, Any]:
    return {
        "id": rule.rule_id,
        **by_name(rule, "clause", "term", "quantity", "statistic"),
        "unit": si_unit(rule),
        "minimum": _limit_record(rule.minimum),
        "maximum": _limit_record(rule.maximum),
        **by_name(rule, "severity", "from_scan", "grade", "applies"),
        "only_where": _condition_record(rule.only_where),
        "note": rule.note,
    }


def _limit_record(limit: Limit | None) -> dict[str, Any] | None:
    return None if limit is None else by_name(limit, "written", "unit", "value")


def _condition_record(condition: Condition | None) -> dict[str, Any] | None:
    return None if condition is None else {"quantity": condition.quantity, "below": _limit_record(condition.below)}


def _finding_record(found: Finding) -> dict[str, Any]:
    return {
        "rule": found.rule.rule_id,
        **by_name(found, "flight", "steps"),
        "verdict": found.verdict.value,
        **by_name(found, "value", "u", "margin"),
        "limit": found.side,
        "reason": found.reason,
    }


def _fit_record(fit: Fit) -> dict[str, Any]:
    return {"rule": fit.rule_id, **by_name(fit, "is_fit", "words", "u", "tolerance")}
