"""What a check says of each step: the one source for the marks on the page and in the scene and the report's tables."""

from statistics import median

from stair_inspector.codes.findings import Check, Finding
from stair_inspector.model import Inspection
from stair_inspector.quantities import step_value

_TIE_M = 1e-6
"""Two steps that are as far from the median but for this are as odd."""


def findings_at_steps(inspection: Inspection, check: Check) -> dict[int, tuple[Finding, ...]]:
    """Return what is said of every step, by its number.

    Of two steps whose difference is too large, or which make the range of their flight too large, it is said of that
    which is farther from the flight's median: it is the odd one. Where both are as far, it is said of both.
    """
    told: dict[int, list[Finding]] = {step.step_id: [] for step in inspection.steps}
    for found in check.findings:
        for step_id in _odd_ones(inspection, found) if found.verdict.is_outside else found.steps:
            told[step_id].append(found)
    return {step_id: tuple(findings) for step_id, findings in sorted(told.items())}


def outside_at_steps(inspection: Inspection, check: Check) -> dict[int, tuple[Finding, ...]]:
    """Return for every step that is outside a limit the findings that say so; advice does not count."""
    outside = {
        step_id: tuple(found for found in findings if found.verdict.is_outside and found.rule.severity == "limit")
        for step_id, findings in findings_at_steps(inspection, check).items()
    }
    return {step_id: findings for step_id, findings in outside.items() if findings}


def _odd_ones(inspection: Inspection, found: Finding) -> tuple[int, ...]:
    if found.rule.statistic == "each" or len(found.steps) < 2:
        return found.steps
    values = {
        step.step_id: value.value
        for step in inspection.steps
        if step.flight == found.flight and (value := step_value(step, found.rule.quantity)) is not None
    }
    away = {step_id: abs(values[step_id] - median(values.values())) for step_id in found.steps if step_id in values}
    return tuple(step_id for step_id, far in away.items() if far >= max(away.values()) - _TIE_M)
