"""Charts of rise and going as SVG for print: a bar for every step, with the limits of a rule set.

``step_charts(inspection, "rise", check)`` are one picture for most stairs, more where one would be taller than a page.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

from stair_inspector.codes.findings import Check, Verdict, gravest
from stair_inspector.model import Inspection, Measured, Statistics, Step
from stair_inspector.pictures import svg
from stair_inspector.pictures.chart_axes import (
    ABOVE,
    BELOW,
    KEY_LINE,
    LEAST_SPAN_MM,
    LEFT,
    PLOT,
    RIGHT,
    STEPS_PER_ROW,
    ChartScale,
    axis_svg,
)
from stair_inspector.pictures.chart_limits import (
    ChartedQuantity,
    LimitLine,
    limit_line_svg,
    limit_line_words,
    limits_of,
)
from stair_inspector.units import tidy, u_text

ROWS_PER_PICTURE = 4
_NEAR_MM = 45.0
"""A limit so near to the values is drawn; one farther away is named below the chart."""
_HEADROOM = 0.16
"""Share of the plot that stays free above the highest value, for its words."""
_WORDS_ABOVE, _WORDS_BELOW = 5.6, 1.8
"""A line nearer to the base line of a value's words than this, above or below it, runs through or along them."""
_BAR_SHARE = 0.6
_LOUD = (Verdict.OUTSIDE, Verdict.OUTSIDE_CLOSE, Verdict.WITHIN_CLOSE)


@dataclass(frozen=True, slots=True)
class _Bar:
    """One step of a chart; ``measured`` in metres, None where it was not measured."""

    step: Step
    measured: Measured | None
    verdict: Verdict | None


@dataclass(frozen=True, slots=True)
class _Row:
    """Bars side by side: each a slot of ``slot`` points from ``LEFT``."""

    bars: tuple[_Bar, ...]
    slot: float

    def x(self, index: int) -> float:
        return LEFT + (index + 0.5) * self.slot


def step_charts(inspection: Inspection, quantity: ChartedQuantity, check: Check | None = None) -> tuple[str, ...]:
    """Return bars of the rise or the going of every step, as SVG pictures.

    Parameters
    ----------
    inspection : Inspection
        Measured by the survey; there is no picture where no step has the quantity.
    quantity : {"rise", "going"}
        Landings, and the last step of a flight, have no going of a tread and are left out of it.
    check : Check, optional
        Of the same inspection: its limits for each step are drawn, and what lies outside or close is marked.

    Returns
    -------
    tuple of str
        From bottom to top, each with at most :data:`ROWS_PER_PICTURE` rows of :data:`STEPS_PER_ROW` steps.

    Notes
    -----
    The scale does not begin at zero, and each bar shows so at its foot: differences of millimetres are what matters.
    It is the same for all pictures of a quantity. Whiskers are the expanded uncertainty (k = 2).
    """
    bars = _bars_of(inspection, quantity, check)
    if all(bar.measured is None for bar in bars):
        return ()
    limits = limits_of(quantity, check)
    low, high = _span(bars, limits)
    near = [limit for limit in limits if low <= limit.limit.value * 1000.0 <= high]
    far = [limit for limit in limits if limit not in near]
    n_rows = -(-len(bars) // STEPS_PER_ROW)
    per_row = -(-len(bars) // n_rows)
    # A chart of few steps has no bars as wide as houses.
    slot = (svg.PAGE - LEFT - RIGHT) / max(per_row, 10)
    rows = [_Row(tuple(bars[start : start + per_row]), slot) for start in range(0, len(bars), per_row)]
    return tuple(
        _step_chart(inspection, quantity, check, rows[start : start + ROWS_PER_PICTURE], (low, high), near, far)
        for start in range(0, len(rows), ROWS_PER_PICTURE)
    )


def _bars_of(inspection: Inspection, quantity: ChartedQuantity, check: Check | None) -> list[_Bar]:
    last = {flight.step_ids[-1] for flight in inspection.flights}
    steps = inspection.steps
    if quantity == "going":
        steps = tuple(step for step in steps if step.kind == "tread" and step.step_id not in last)
    return [
        _Bar(step, step.rise_m if quantity == "rise" else step.going_m, _verdict_of(step, quantity, check))
        for step in steps
    ]


def _verdict_of(step: Step, quantity: ChartedQuantity, check: Check | None) -> Verdict | None:
    findings = () if check is None else check.of_step(step.step_id)
    own = tuple(found for found in findings if found.rule.quantity == quantity and found.rule.statistic == "each")
    return gravest(own).verdict if own else None


def _span(bars: Sequence[_Bar], limits: Sequence[LimitLine]) -> tuple[float, float]:
    """Return the ends of the scale, millimetres: all values with their doubt, and the limits near them."""
    known = [bar.measured for bar in bars if bar.measured is not None]
    low = min(measured.value - measured.u for measured in known) * 1000.0
    high = max(measured.value + measured.u for measured in known) * 1000.0
    places = [limit.limit.value * 1000.0 for limit in limits]
    near = [place for place in places if low - _NEAR_MM <= place <= high + _NEAR_MM]
    low, high = min([low, *near]), max([high, *near])
    span = max(high - low, LEAST_SPAN_MM)
    middle = (low + high) / 2.0
    return middle - 0.72 * span, middle + (0.5 + _HEADROOM) * span


def _step_chart(
    inspection: Inspection,
    quantity: ChartedQuantity,
    check: Check | None,
    rows: Sequence[_Row],
    span: tuple[float, float],
    near: Sequence[LimitLine],
    far: Sequence[LimitLine],
) -> str:
    pitch = ABOVE + PLOT + BELOW
    parts = [_hatch()]
    for index, row in enumerate(rows):
        scale = ChartScale(*span, index * pitch + ABOVE, PLOT)
        parts.append(axis_svg(scale, f"{quantity} [mm]"))
        parts += [limit_line_svg(limit, scale) for limit in near]
        parts += _flight_lines(inspection, quantity, row, scale)
        lines = _lines_behind(inspection, quantity, near, scale)
        parts += [
            _bar(bar, row.x(k), row.slot, scale, lines.get(bar.step.flight, lines[None]))
            for k, bar in enumerate(row.bars)
        ]
        parts += _brackets(inspection, quantity, check, row, scale)
    y = len(rows) * pitch + 2.0
    for words in _key_of(rows, near, far, check):
        parts.append(words.at(LEFT, y + 7.0))
        y += KEY_LINE
    first, last = rows[0].bars[0].step.step_id, rows[-1].bars[-1].step.step_id
    return svg.picture(svg.PAGE, y + 2.0, f"{quantity} of steps {first} to {last}, millimetres", "".join(parts))


def _lines_behind(
    inspection: Inspection, quantity: ChartedQuantity, near: Sequence[LimitLine], scale: ChartScale
) -> dict[int | None, list[float]]:
    """Return where lines cross the bars of each flight: its limits and its mean, points from the top."""
    limits = [scale.y(limit.limit.value * 1000.0) for limit in near]
    found: dict[int | None, list[float]] = {None: limits}
    for flight in inspection.flights:
        statistics: Statistics | None = getattr(flight, quantity)
        found[flight.flight_id] = limits + ([] if statistics is None else [scale.y(statistics.mean * 1000.0)])
    return found


def _free_of(lines: Sequence[float], base: float) -> float:
    """Return the base line of a value's words, at or above a place, at which no line runs through them."""
    for y in sorted(lines, reverse=True):
        if base - _WORDS_ABOVE < y < base + _WORDS_BELOW:
            base = y - _WORDS_BELOW
    return base


def _bar(bar: _Bar, x: float, slot: float, scale: ChartScale, lines: Sequence[float]) -> str:
    bottom = scale.top + scale.plot
    number = svg.text_element(x, bottom + 9.0, bar.step.step_id, "middle", 7.0)
    if bar.measured is None:
        words = svg.text_element(x + 2.2, bottom - 5.0, "not measured", "start", 6.5, svg.DIM, turn_deg=-90.0)
        dashes = svg.line(x, bottom, x, bottom - 3.0, svg.DIM, 0.6)
        return f'<g data-step="{bar.step.step_id}">{dashes}{words}{number}</g>'
    value, u = bar.measured.value * 1000.0, bar.measured.u * 1000.0
    half, top = _BAR_SHARE * slot / 2.0, scale.y(value)
    is_outside = bar.verdict is not None and bar.verdict.is_outside
    color = svg.ALERT if is_outside else svg.CLOSE if bar.verdict is Verdict.WITHIN_CLOSE else svg.ACCENT
    shape = f'x="{x - half:.2f}" y="{top:.2f}" width="{2.0 * half:.2f}" height="{bottom - top:.2f}"'
    parts = [f'<rect {shape} fill="{color}" fill-opacity="0.22"/>']
    if is_outside:
        parts.append(f'<rect {shape} fill="url(#hatch)"/>')
    parts.append(svg.line(x - half, top, x + half, top, color, 1.4))
    # The foot is cut: the scale does not begin at zero.
    parts.append(
        svg.polygon(
            [
                (x - half - 0.6, bottom - 7.0),
                (x + half + 0.6, bottom - 9.0),
                (x + half + 0.6, bottom - 6.6),
                (x - half - 0.6, bottom - 4.6),
            ],
            "#ffffff",
        )
    )
    high, low, cap = scale.y(value + u), scale.y(value - u), min(2.4, half)
    parts += [svg.line(x, low, x, high, svg.INK, 0.7)]
    parts += [svg.line(x - cap, y, x + cap, y, svg.INK, 0.7) for y in (low, high)]
    base = _free_of(lines, high - 2.6)
    parts.append(
        svg.text_element(x, base, _value_text(value), "middle", 6.3, svg.INK, is_bold=is_outside, has_halo=True)
    )
    mark = _mark(bar.verdict, x, bottom + 15.5) if bar.verdict is not None else ""
    told = f"<title>step {bar.step.step_id}: {_value_text(value)} ± {u_text(u)} mm</title>"
    return f'<g data-step="{bar.step.step_id}">{told}{"".join(parts)}{number}{mark}</g>'


def _value_text(value_mm: float) -> str:
    return f"{tidy(value_mm, 1):.1f}"


def _mark(verdict: Verdict, x: float, y: float) -> str:
    """Return the sign of a verdict that is not plainly within, centred at a place: seen without colours too."""
    r = 2.5
    cross = svg.line(x - r, y - r, x + r, y + r, svg.ALERT, 1.3) + svg.line(x - r, y + r, x + r, y - r, svg.ALERT, 1.3)
    ring = f'<circle cx="{x:.2f}" cy="{y:.2f}" r="{{r}}" fill="none" stroke="{{color}}" stroke-width="0.9"/>'
    if verdict is Verdict.OUTSIDE:
        return cross
    if verdict is Verdict.OUTSIDE_CLOSE:
        return cross + ring.format(r=3.9, color=svg.ALERT)
    return ring.format(r=2.6, color=svg.CLOSE) if verdict is Verdict.WITHIN_CLOSE else ""


def _flight_lines(inspection: Inspection, quantity: ChartedQuantity, row: _Row, scale: ChartScale) -> list[str]:
    """Return each flight's name, mean and range over its bars, and a line at the mean."""
    parts = []
    for flight in inspection.flights:
        places = [k for k, bar in enumerate(row.bars) if bar.step.flight == flight.flight_id]
        if not places:
            continue
        left, right = row.x(places[0]) - row.slot / 2.0, row.x(places[-1]) + row.slot / 2.0
        parts.append(svg.line(left, scale.top, left, scale.top + scale.plot + 11.0, svg.FAINT, 0.6))
        found: Statistics | None = getattr(flight, quantity)
        told = [f"flight {flight.flight_id}"]
        if found is not None:
            mean, spread = found.mean * 1000.0, found.range * 1000.0
            told += [f"mean {_value_text(mean)}", f"range {_value_text(spread)} mm"]
            y = scale.y(mean)
            parts.append(svg.line(left + 1.0, y, right - 1.0, y, svg.ACCENT, 0.6, ' stroke-dasharray="0.8 1.6"'))
        while len(told) > 1 and svg.width_of(" · ".join(told), 6.5) > right - left - 4.0:
            told.pop()
        parts.append(svg.text_element(left + 2.5, scale.top - 4.0, " · ".join(told), "start", 6.5, svg.DIM))
    return parts


def _brackets(
    inspection: Inspection, quantity: ChartedQuantity, check: Check | None, row: _Row, scale: ChartScale
) -> list[str]:
    """Return a bracket over neighbours whose difference lies outside its limit, and over each flight's worst pair."""
    pairs: dict[tuple[int, int], bool] = {}
    for flight in inspection.flights:
        found: Statistics | None = getattr(flight, quantity)
        if found is not None and found.at is not None:
            pairs[found.at] = False
    for finding in () if check is None else check.findings:
        rule = finding.rule
        is_pair = rule.quantity == quantity and rule.statistic == "adjacent_difference" and len(finding.steps) == 2
        if is_pair and finding.verdict.is_outside:
            pairs[finding.steps[0], finding.steps[1]] = True
    places = {bar.step.step_id: k for k, bar in enumerate(row.bars)}
    known = {bar.step.step_id: bar.measured for bar in row.bars}
    parts = []
    bottom = scale.top + scale.plot
    for (lower, upper), is_outside in pairs.items():
        below, above = known.get(lower), known.get(upper)
        if below is None or above is None:
            continue
        x1, x2 = row.x(places[lower]), row.x(places[upper])
        color = svg.ALERT if is_outside else svg.DIM
        difference = abs(above.value - below.value) * 1000.0
        if not tidy(difference, 1):
            continue
        y = bottom + 23.0
        parts.append(svg.polyline([(x1, y - 2.0), (x1, y), (x2, y), (x2, y - 2.0)], color, 0.8))
        words = f"Δ {_value_text(difference)}" + (" !" if is_outside else "")
        parts.append(svg.text_element((x1 + x2) / 2.0, y + 6.6, words, "middle", 6.0, color, is_bold=is_outside))
    return parts


@dataclass(frozen=True, slots=True)
class _Key:
    """One line of the key below a chart: signs with their words."""

    items: list[tuple[str, str]] = field(default_factory=list)

    def at(self, x: float, y: float) -> str:
        parts = []
        for sign, words in self.items:
            if sign in ("outside", "outside_close", "within_close"):
                parts.append(_mark(Verdict(sign), x + 4.0, y - 2.3))
                x += 11.0
            elif sign:
                parts.append(svg.text_element(x, y, sign, "start", 6.5, svg.ALERT, is_bold=True))
                x += 9.0
            parts.append(svg.text_element(x, y, words, "start", 6.5, svg.DIM))
            x += svg.width_of(words, 6.5) + 10.0
        return "".join(parts)


def _key_of(
    rows: Sequence[_Row], near: Sequence[LimitLine], far: Sequence[LimitLine], check: Check | None
) -> list[_Key]:
    verdicts = {bar.verdict for row in rows for bar in row.bars}
    signs = [(verdict.value, verdict.words) for verdict in _LOUD if verdict in verdicts]
    general = "Whiskers: expanded uncertainty (k = 2). Dotted: mean of the flight. Δ: largest difference of neighbours"
    keys = [_Key([("", general + (", and those outside their limit (!)." if check is not None else "."))])]
    keys += [_Key(signs)] if signs else []
    if check is None or not (near or far):
        return keys
    changed = ", but for those set by the user" if check.rule_set.n_changed else ""
    keys.append(_Key([("", f"Limits: {check.rule_set.title}{changed}.")]))
    keys += [_Key([(limit.tag, limit_line_words(limit, check))]) for limit in near]
    keys += [_Key([("", f"{limit_line_words(limit, check)}, lies beyond the scale")]) for limit in far]
    return keys


def _hatch() -> str:
    return (
        '<defs><pattern id="hatch" width="4" height="4" patternUnits="userSpaceOnUse" patternTransform="rotate(45)">'
        f'<line x1="0" y1="0" x2="0" y2="4" stroke="{svg.ALERT}" stroke-width="1.2" stroke-opacity="0.55"/>'
        "</pattern></defs>"
    )
