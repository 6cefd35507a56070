"""The limits of a rule set in a chart of steps: which are drawn, and what is said of them."""

from dataclasses import dataclass
from typing import Literal

from stair_inspector.codes.findings import Check
from stair_inspector.codes.limits import Limit
from stair_inspector.codes.phrases import limit_words
from stair_inspector.codes.rules import Rule
from stair_inspector.pictures import svg
from stair_inspector.pictures.chart_axes import LEFT, RIGHT, ChartScale

ChartedQuantity = Literal["rise", "going"]


@dataclass(frozen=True, slots=True)
class LimitLine:
    """A limit to be drawn, or named where it lies far away; ``tag`` is its letter in the key."""

    tag: str
    side: Literal["minimum", "maximum"]
    limit: Limit
    rule: Rule


def limits_of(quantity: ChartedQuantity, check: Check | None) -> list[LimitLine]:
    """Return the limits on every single step, the highest first, one line for each place."""
    if check is None:
        return []
    rules = [
        rule
        for rule in check.rule_set.rules
        if rule.quantity == quantity and rule.statistic == "each" and rule.severity != "report_only"
    ]
    found: list[tuple[Literal["minimum", "maximum"], Limit, Rule]] = []
    for rule in rules:
        found += [("minimum", rule.minimum, rule)] if rule.minimum is not None else []
        found += [("maximum", rule.maximum, rule)] if rule.maximum is not None else []
    found.sort(key=lambda item: (-item[1].value, item[0]))
    return [LimitLine(_letter(index), *item) for index, item in enumerate(found)]


def _letter(index: int) -> str:
    return chr(ord("A") + index) if index < 26 else str(index + 1)


def limit_line_svg(limit: LimitLine, scale: ChartScale) -> str:
    """Return the line of a limit with its letter, and the zone beyond it."""
    y, right = scale.y(limit.limit.value * 1000.0), svg.PAGE - RIGHT
    beyond = scale.top if limit.side == "maximum" else scale.top + scale.plot
    zone = (
        f'<rect x="{LEFT:.2f}" y="{min(y, beyond):.2f}" width="{right - LEFT:.2f}" height="{abs(beyond - y):.2f}" '
        f'fill="{svg.ALERT}" fill-opacity="0.05"/>'
    )
    dashes = ' stroke-dasharray="5 2"' if limit.side == "maximum" else ' stroke-dasharray="1.5 2"'
    tag = svg.text_element(right + 3.0, y + 2.4, limit.tag, "start", 7.0, svg.ALERT, is_bold=True)
    return zone + svg.line(LEFT, y, right, y, svg.ALERT, 0.9, dashes) + tag


def limit_line_words(limit: LimitLine, check: Check) -> str:
    """Return what the key below the chart says of a limit."""
    advice = ", advisory" if limit.rule.severity == "advisory" else ""
    edit = check.rule_set.edit_of(limit.rule.rule_id, limit.side)
    own = "" if edit is None else f" (set by the user; the code: {limit_words(edit.before)})"
    return f"{limit.side} {limit.limit.text}{own}: {limit.rule.clause}, {limit.rule.term}{advice}"
