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
        "not_assessed": list(check.not_assessed),
        "notes": list(check.notes),
    }


def si_unit(rule: Rule) -> str | None:
    """Return the unit of a rule's values: ``m``, ``deg``, ``tangent`` or ``count``; None for what no scan shows."""
    return None if rule.quantity == "other" else quantity_of(rule.quantity).unit


def _set_record(rule_set: RuleSet) -> dict[str, Any]:
    return {
        "id": rule_set.set_id,
        "name": rule_set.name,
        "edition": rule_set.edition,
        "variant": rule_set.variant,
        "source": rule_set.source,
        "file": rule_set.file,
        "sha256": rule_set.sha256,
        "overlays": list(rule_set.overlays),
        "is_shipped": rule_set.is_shipped,
        "is_edited": rule_set.is_edited,
        "edits": [_edit_record(edit) for edit in rule_set.edits],
    }


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
        "clause": rule.clause,
        "term": rule.term,
        "quantity": rule.quantity,
        "statistic": rule.statistic,
        "unit": si_unit(rule),
        "minimum": _limit_record(rule.minimum),
        "maximum": _limit_record(rule.maximum),
        "severity": rule.severity,
        "from_scan": rule.from_scan,
        "grade": rule.grade,
        "applies": rule.applies,
        "only_where": _condition_record(rule.only_where),
        "note": rule.note,
    }


def _limit_record(limit: Limit | None) -> dict[str, Any] | None:
    return None if limit is None else {"written": limit.written, "unit": limit.unit, "value": limit.value}


def _condition_record(condition: Condition | None) -> dict[str, Any] | None:
    return None if condition is None else {"quantity": condition.quantity, "below": _limit_record(condition.below)}


def _finding_record(found: Finding) -> dict[str, Any]:
    return {
        "rule": found.rule.rule_id,
        "flight": found.flight,
        "steps": list(found.steps),
        "verdict": found.verdict.value,
        "value": found.value,
        "u": found.u,
        "margin": found.margin,
        "limit": found.side,
        "reason": found.reason,
    }


def _fit_record(fit: Fit) -> dict[str, Any]:
    return {"rule": fit.rule_id, "is_fit": fit.is_fit, "words": fit.words, "u": fit.u, "tolerance": fit.tolerance}
