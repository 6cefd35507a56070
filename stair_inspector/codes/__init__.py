"""Rule sets as data, and the judging of an inspection against them."""

from stair_inspector.codes.findings import DECISIONS, Check, Decision, Finding, Fit, Verdict, gravest
from stair_inspector.codes.judge import check
from stair_inspector.codes.limits import Limit
from stair_inspector.codes.rule_sets import RuleSet, edited, overlaid
from stair_inspector.codes.rules import Condition, Rule, RuleEdit
from stair_inspector.units import notation_of, shown

__all__ = [
    "DECISIONS",
    "Check",
    "Condition",
    "Decision",
    "Finding",
    "Fit",
    "Limit",
    "Rule",
    "RuleEdit",
    "RuleSet",
    "Verdict",
    "check",
    "edited",
    "gravest",
    "notation_of",
    "overlaid",
    "shown",
]
