"""A sweep as an SVG drawing with a sentence about its plateau, in the page's own colours, no script."""

import math
from dataclasses import dataclass

from stair_inspector.declarations import Knob
from stair_inspector.params import SETTINGS
from stair_inspector.units import M_PER_INCH, NOT_KNOWN, Unit, length_text, round_ticks
from stair_inspector.viewer.bridge.controls import value_words
from stair_inspector.viewer.bridge.markup import DIM, text
from stair_inspector.viewer.compute.sensitivity import PLATEAU_M, SWEPT_QUANTITIES, Sweep, is_log, plateau

_WIDTH, _HEIGHT = 420, 200
_LEFT, _RIGHT, _TOP, _BOTTOM = 56, 12, 10, 34
_TEXT = 'fill="currentColor" opacity="0.75" font-size="11"'
_ACCENT = "rgb(0, 170, 185)"


def sweep_html(found: Sweep, quantity: str, unit: Unit = "mm") -> str:
    """Return the drawing of a quantity against the setting, with a sentence about its plateau.

    Parameters
    ----------
    found : Sweep
        Complete or not.
    quantity : str
        A key of :data:`SWEPT_QUANTITIES`.
    unit : str
        For lengths.
    """
    title = f"{SWEPT_QUANTITIES[quantity]} against {SETTINGS.setting(found.name).called}"
    return (
        f'<div data-testid="sweep" data-complete="{str(found.is_complete).lower()}" style="font-size:12px;'
        f'line-height:1.4;padding:2px 9px 6px"><div style="font-weight:600">{text(title)}</div>'
        f"{_svg(found, quantity, unit, title)}"
        f'<div data-testid="plateau" style="color:{DIM}">{text(_sentence(found, quantity, unit))}</div></div>'
    )


def _sentence(found: Sweep, quantity: str, unit: Unit) -> str:
    if not found.points:
        return f"0 of {found.n_wanted} values measured."
    n_failed = sum(bool(point.error) for point in found.points)
    done = "" if found.is_complete else f"{len(found.points)} of {found.n_wanted} values measured. "
    failed = f" {n_failed} value{'s' if n_failed > 1 else ''} could not be measured (×)." if n_failed else ""
    flat = plateau(found, quantity)
    if flat is None:
        return f"{done}With the present value {value_words(found.name, found.present)} there is no such number.{failed}"
    here = next(point for point in found.points if point.value == found.present)
    same = f"within {length_text(PLATEAU_M, 'mm', 0)} of" if quantity.endswith("_m") else "at"
    now = _number_words(here.quantities[quantity], quantity, unit)
    if flat[0] == flat[1]:
        return (
            f"{done}{now} at the present {value_words(found.name, found.present)}, and different at the values beside "
            f"it: no plateau.{failed}"
        )
    low, high = (value_words(found.name, value) for value in flat)
    return f"{done}Stays {same} {now} from {low} to {high}; the present value is {_present(found)}.{failed}"


def _present(found: Sweep) -> str:
    return value_words(found.name, found.present)


def _number_words(value: float | None, quantity: str, unit: Unit) -> str:
    if value is None:
        return NOT_KNOWN
    return length_text(value, unit) if quantity.endswith("_m") else f"{value:g}"


@dataclass(frozen=True, slots=True)
class _Frame:
    """Where values stand in the drawing, pixels."""

    x_low: float
    x_high: float
    y_low: float
    y_high: float
    is_log: bool

    def x(self, value: float) -> float:
        low, high, at = (math.log(v) if self.is_log else v for v in (self.x_low, self.x_high, value))
        return _LEFT + (at - low) / (high - low) * (_WIDTH - _LEFT - _RIGHT)

    def y(self, value: float) -> float:
        return _TOP + (self.y_high - value) / (self.y_high - self.y_low) * (_HEIGHT - _TOP - _BOTTOM)


def _svg(found: Sweep, quantity: str, unit: Unit, title: str) -> str:
    knob = SETTINGS.knob(found.name)
    per_unit = (1000.0 if unit == "mm" else 1.0 / M_PER_INCH) if quantity.endswith("_m") else 1.0
    known = [(p.value, v * per_unit) for p in found.points if (v := p.quantities.get(quantity)) is not None]
    numbers = [number for _, number in known] or [0.0, 1.0]
    least = (1.0 if unit == "mm" else 0.05) if quantity.endswith("_m") else 2.0
    middle, half = (max(numbers) + min(numbers)) / 2.0, max(least, max(numbers) - min(numbers)) * 0.55
    frame = _Frame(knob.low, knob.high, middle - half, middle + half, is_log(knob))
    return (
        f'<svg viewBox="0 0 {_WIDTH} {_HEIGHT}" width="100%" role="img" aria-label="{text(title)}" '
        'style="display:block;max-width:520px">'
        f"{_plateau_band(found, quantity, frame)}{_axes(frame, knob, quantity, unit)}"
        f"{_curve(found, quantity, frame, per_unit, unit)}{_failures(found, frame)}</svg>"
    )


def _plateau_band(found: Sweep, quantity: str, frame: _Frame) -> str:
    flat = plateau(found, quantity)
    if flat is None or flat[0] == flat[1]:
        return ""
    left, right = frame.x(flat[0]), frame.x(flat[1])
    return (
        f'<rect data-part="plateau" x="{left:.1f}" y="{_TOP}" width="{right - left:.1f}" '
        f'height="{_HEIGHT - _TOP - _BOTTOM}" fill="{_ACCENT}" opacity="0.15"/>'
    )


def _axes(frame: _Frame, knob: Knob, quantity: str, unit: Unit) -> str:
    bottom, right = _HEIGHT - _BOTTOM, _WIDTH - _RIGHT
    parts = [
        f'<path d="M{_LEFT} {_TOP}V{bottom}H{right}" fill="none" stroke="currentColor" stroke-width="1" opacity="0.5"/>'
    ]
    for shown in _value_ticks(knob):
        x = frame.x(knob.stored(shown))
        parts.append(f'<path d="M{x:.1f} {bottom}v4" stroke="currentColor" opacity="0.5"/>')
        parts.append(f'<text x="{x:.1f}" y="{bottom + 14}" text-anchor="middle" {_TEXT}>{shown:g}</text>')
    for digits, number in round_ticks(frame.y_low, frame.y_high - frame.y_low, 4.0):
        if frame.y_low <= number <= frame.y_high and (quantity.endswith("_m") or number == round(number)):
            y = frame.y(number)
            parts.append(f'<path d="M{_LEFT} {y:.1f}H{right}" stroke="currentColor" opacity="0.12"/>')
            parts.append(
                f'<text x="{_LEFT - 5}" y="{y + 3.5:.1f}" text-anchor="end" {_TEXT}>{number:.{digits}f}</text>'
            )
    parts.append(f'<text x="{right}" y="{_HEIGHT - 4}" text-anchor="end" {_TEXT}>{text(knob.label)}</text>')
    if quantity.endswith("_m"):
        parts.append(f'<text x="4" y="{_TOP + 8}" {_TEXT}>{unit}</text>')
    return "".join(parts)


def _value_ticks(knob: Knob) -> list[float]:
    """Return the values written along the setting's axis, in its display unit."""
    low, high = knob.shown(knob.low), knob.shown(knob.high)
    if not is_log(knob):
        return [number for _, number in round_ticks(low, high - low) if low <= number <= high]
    decades = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    return [number for power in decades for digit in (1.0, 2.0, 5.0) if low <= (number := digit * 10.0**power) <= high]


def _curve(found: Sweep, quantity: str, frame: _Frame, per_unit: float, unit: Unit) -> str:
    """Return the line through neighbours that are known, a dot for each value, and the present value."""
    line, dots = "", []
    is_broken = True
    for point in found.points:
        value = point.quantities.get(quantity)
        if value is None:
            is_broken = True
            continue
        x, y = frame.x(point.value), frame.y(value * per_unit)
        line += f"{'M' if is_broken else 'L'}{x:.1f} {y:.1f}"
        is_broken = False
        words = f"{value_words(found.name, point.value)}: {_number_words(value, quantity, unit)}"
        dots.append(
            f'<circle data-value="{point.value:g}" data-quantity="{value:.6g}" cx="{x:.1f}" cy="{y:.1f}" '
            f'r="{4 if point.value == found.present else 2.6}" fill="{_ACCENT}"><title>{text(words)}</title></circle>'
        )
    x = frame.x(found.present)
    now = f"the present value, {_present(found)}"
    return (
        f'<path data-part="present" d="M{x:.1f} {_TOP}V{_HEIGHT - _BOTTOM}" stroke="currentColor" '
        f'stroke-dasharray="3 3" opacity="0.6"><title>{text(now)}</title></path>'
        f'<path data-part="curve" d="{line}" fill="none" stroke="{_ACCENT}" stroke-width="1.5"/>{"".join(dots)}'
    )


def _failures(found: Sweep, frame: _Frame) -> str:
    y = _HEIGHT - _BOTTOM - 5
    return "".join(
        f'<text data-part="failure" x="{frame.x(point.value):.1f}" y="{y}" text-anchor="middle" font-size="11" '
        f'fill="#e8590c">×<title>{text(f"{value_words(found.name, point.value)}: {point.error}")}</title></text>'
        for point in found.points
        if point.error
    )
