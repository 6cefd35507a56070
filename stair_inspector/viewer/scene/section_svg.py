"""A section as an SVG drawing in the page's own colours: points, the steps' planes, a scale on both sides, no script.

``profile_svg(profile_of(scan, inspection, slab), palette, unit, selected)`` goes into an HTML element as it is.
"""

from dataclasses import dataclass

import numpy as np

from stair_inspector.files.palettes import Palette
from stair_inspector.geometry.arrays import Floats
from stair_inspector.model import FLOOR_LABEL, NON_STAIR_LABEL
from stair_inspector.units import M_PER_INCH, Unit, length_text, measured_text, round_ticks
from stair_inspector.viewer.bridge.markup import text
from stair_inspector.viewer.scene.sections import Profile, ProfileLine

MOST_DOTS = 6_000
"""Dots of a drawing; points that would share one are drawn once."""
_TALLEST = 460
_SHORTEST = 110
_LEFT, _RIGHT, _TOP, _BOTTOM = 48, 12, 12, 36
_DOT = 1.6
_LEAST_TICKS = 2
_OUTERMOST_PERCENT = 0.2
_PER_M = {"mm": 1.0, "in": 1.0 / M_PER_INCH}
_NAMES = {"mm": "m", "in": "in"}
_ACROSS = {"along": "along the climb", "across": "to the right"}
_TEXT = 'fill="currentColor" opacity="0.75"'
_CHOSEN = "rgb(0, 170, 185)"
_NARROWEST = 60.0
"""Pixels of a going below which the words of its dimensions would lie over its neighbours: they are left out."""
_HALO = 'paint-order="stroke" stroke="var(--mantine-color-body, white)" stroke-width="3"'


@dataclass(frozen=True, slots=True)
class _Window:
    """What of the section is drawn, metres, and pixels per metre, the same both ways."""

    x_low: float
    z_low: float
    x_high: float
    z_high: float
    scale: float

    def x(self, x_m: float) -> float:
        return _LEFT + (x_m - self.x_low) * self.scale

    def y(self, z_m: float) -> float:
        return _TOP + (self.z_high - z_m) * self.scale

    @property
    def right(self) -> float:
        return self.x(self.x_high)

    @property
    def bottom(self) -> float:
        return self.y(self.z_low)


def profile_svg(
    profile: Profile,
    palette: Palette,
    unit: Unit = "mm",
    selected: int | None = None,
    *,
    width: int = 420,
    tallest: int = _TALLEST,
    most_dots: int = MOST_DOTS,
    around: Floats | None = None,
) -> str:
    """Return a section as SVG.

    Parameters
    ----------
    profile : Profile
        From :func:`~stair_inspector.viewer.scene.sections.profile_of`.
    palette : Palette
        Colours of the page.
    unit : {"mm", "in"}
        Lengths are given in it; the scales are in metres or inches.
    selected : int, optional
        Step that is emphasised and whose rise and going are drawn.
    width : int
        Of the drawing, pixels; it is scaled to its element. The scale is the same across and upwards.
    tallest, most_dots : int
        Its largest height, pixels, and the most dots that it has.
    around : (2, 2), optional
        Lowest and highest place (across, height) that are drawn, metres; None draws everything.
    """
    places = profile.places_m
    if not len(places):
        return (
            '<div data-testid="profile" style="padding:8px 9px;opacity:.75;font-size:12px">'
            "No points lie in this section; move it or make it thicker.</div>"
        )
    window = _window(profile, width, tallest, around)
    is_seen = (places >= [window.x_low, window.z_low]).all(axis=1) & (places <= [window.x_high, window.z_high]).all(
        axis=1
    )
    height = window.bottom + _BOTTOM
    title = title_of(profile, unit, selected)
    lines = "".join(
        _line(line, window, unit, is_selected=line.step.step_id == selected)
        for line in profile.lines
        if _is_inside(line, window)
    )
    # The points and lines of an enlarged part end at its frame.
    frame = f'x="{_LEFT}" y="{_TOP}" width="{window.right - _LEFT:.1f}" height="{window.bottom - _TOP:.1f}"'
    return (
        f'<div data-testid="profile" class="si-results" style="padding:2px 8px 2px 0">'
        f'<div style="font-size:11px;opacity:.8;padding:0 0 2px 9px">{text(title)}</div><svg '
        f'xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height:.0f}" width="100%" role="img" '
        f'font-family="sans-serif" font-size="11" aria-label="{text(title)}">'
        f'<rect {frame} fill="none" stroke="currentColor" opacity="0.25"/>'
        f"{_scales(profile, window, unit)}"
        f"{_dots(profile, np.nonzero(is_seen)[0], window, palette, most_dots)}{lines}</svg></div>"
    )


def title_of(profile: Profile, unit: Unit = "mm", step_id: int | None = None) -> str:
    """Return what a section is: ``section along the stair, 50 mm thick, 100 mm right of its middle``.

    With a step, whose frame the section is cut in, its place is told from the middle of that step.
    """
    sides = ("right of", "left of") if profile.direction == "along" else ("up from", "down from")
    away = length_text(abs(profile.place_m), unit, 0)
    place = f"{away} {sides[profile.place_m < 0.0]}" if away != length_text(0.0, unit, 0) else "in"
    middle = "its middle" if step_id is None else f"the middle of step {step_id}"
    return f"section {profile.direction} the stair, {length_text(profile.thickness_m, unit, 0)} thick, {place} {middle}"


def _window(profile: Profile, width: int, tallest: int, around: Floats | None) -> _Window:
    if around is None:
        low, high = np.percentile(profile.places_m, [_OUTERMOST_PERCENT, 100.0 - _OUTERMOST_PERCENT], axis=0)
        ends = [line.ends for line in profile.lines]
        low, high = np.vstack([low, *ends]).min(axis=0), np.vstack([high, *ends]).max(axis=0)
        margin = 0.02 * max(float((high - low).max()), 0.1)
        low, high = low - margin, high + margin
    else:
        low, high = around
    x_span, z_span = np.maximum(high - low, 1e-3)
    scale = min((width - _LEFT - _RIGHT) / x_span, tallest / z_span)
    # A flat section still has room for its numbers.
    z_span = max(z_span, _SHORTEST / scale)
    middle = (low[1] + high[1]) / 2.0
    return _Window(
        float(low[0]), float(middle - z_span / 2.0), float(high[0]), float(middle + z_span / 2.0), float(scale)
    )


def _dots(
    profile: Profile, rows: "np.ndarray[tuple[int], np.dtype[np.intp]]", window: _Window, palette: Palette, most: int
) -> str:
    """Return one path of dots for each colour, each dot once."""
    labels = profile.labels[rows].astype(np.int64)
    x = _LEFT + (profile.places_m[rows, 0] - window.x_low) * window.scale
    y = _TOP + (window.z_high - profile.places_m[rows, 1]) * window.scale
    cell = 0.5
    while True:
        grid = np.column_stack([labels, np.rint(x / cell), np.rint(y / cell)]).astype(np.int64)
        dots = np.unique(grid, axis=0)
        if len(dots) <= most:
            break
        cell *= 1.5
    paths = []
    for label in np.unique(dots[:, 0]):
        color = palette.non_stair if label == NON_STAIR_LABEL else palette.floor
        color = palette.of_step(int(label)) if label > FLOOR_LABEL else color
        places = dots[dots[:, 0] == label, 1:] * cell
        moves = "".join(f"M{u:.4g} {v:.4g}h0" for u, v in places.tolist())
        paths.append(
            f'<path data-label="{label}" d="{moves}" stroke="rgb{color}" stroke-width="{max(_DOT, cell):.1f}" '
            'stroke-linecap="round" fill="none"/>'
        )
    return "".join(paths)


def _line(line: ProfileLine, window: _Window, unit: Unit, *, is_selected: bool) -> str:
    step = line.step
    (x1, z1), (x2, z2) = line.ends.tolist()
    told = [f"step {step.step_id}"]
    told += [f"rise {measured_text(step.rise_m, unit)}"] if step.rise_m is not None else []
    told += [f"going {measured_text(step.going_m, unit)}"] if step.going_m is not None else []
    color, thick = (_CHOSEN, 2.4) if is_selected else ("currentColor", 0.8)
    middle = window.x((max(x1, window.x_low) + min(x2, window.x_high)) / 2.0)
    weight = ' font-weight="700"' if is_selected else ""
    x_from, x_to = (min(max(x, window.x_low), window.x_high) for x in (x1, x2))
    slope = (z2 - z1) / (x2 - x1) if x2 > x1 else 0.0
    top = window.y(max(z1, z2)) - 5.0
    parts = [
        f'<line x1="{window.x(x_from):.1f}" y1="{window.y(z1 + slope * (x_from - x1)):.1f}" '
        f'x2="{window.x(x_to):.1f}" y2="{window.y(z1 + slope * (x_to - x1)):.1f}" '
        f'stroke="{color}" stroke-width="{thick}"/>',
        _words(middle, top, str(step.step_id), "middle", "currentColor", weight),
    ]
    if line.nosing is not None:
        x, z = line.nosing.tolist()
        if window.x_low <= x <= window.x_high:
            parts.append(f'<circle cx="{window.x(x):.1f}" cy="{window.y(z):.1f}" r="2.6" fill="{color}"/>')
            parts += _dimensions(line, window, unit) if is_selected else []
    return f'<g data-step="{step.step_id}"><title>{text(", ".join(told))}</title>{"".join(parts)}</g>'


def _dimensions(line: ProfileLine, window: _Window, unit: Unit) -> list[str]:
    """Return the rise below and the going beyond a nosing, to scale, where the step climbs to the right."""
    step, parts = line.step, list[str]()
    is_narrow = step.going_m is not None and step.going_m.value * window.scale < _NARROWEST
    if line.nosing is None or is_narrow or not line.climbs_right:
        return []
    x, z = line.nosing.tolist()
    if step.rise_m is not None:
        left, low = window.x(x) - 10.0, min(window.y(z - step.rise_m.value), window.bottom)
        parts.append(_arrow(left, window.y(z), left, low))
        parts.append(_words(left - 5.0, (window.y(z) + low) / 2.0 + 4.0, measured_text(step.rise_m, unit), "end"))
    if step.going_m is not None:
        top, end = window.y(z) - 22.0, window.x(x + step.going_m.value)
        is_cut = end > window.right
        end = min(end, window.right)
        parts.append(_arrow(window.x(x), top, end, top, has_end=not is_cut))
        told = measured_text(step.going_m, unit) + (" →" if is_cut else "")
        parts.append(_words((window.x(x) + end) / 2.0, top - 5.0, told, "middle"))
    return parts


def _words(x: float, y: float, words: str, anchor: str, color: str = _CHOSEN, more: str = "") -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="{color}"{more} {_HALO}>{text(words)}</text>'


def _arrow(x1: float, y1: float, x2: float, y2: float, *, has_end: bool = True) -> str:
    """Return a dimension line along an axis, with a bar across at both ends, or where it goes on at its start only."""
    dx, dy = (4, 0) if x1 == x2 else (0, 4)
    ends = ((x1, y1), (x2, y2)) if has_end else ((x1, y1),)
    bars = "".join(f"M{x - dx:.1f} {y - dy:.1f}L{x + dx:.1f} {y + dy:.1f}" for x, y in ends)
    return f'<path d="M{x1:.1f} {y1:.1f}L{x2:.1f} {y2:.1f}{bars}" stroke="{_CHOSEN}" fill="none" stroke-width="1.2"/>'


def _scales(profile: Profile, window: _Window, unit: Unit) -> str:
    per_m, name = _PER_M[unit], _NAMES[unit]
    parts = []
    bottom, right = window.bottom, window.right
    n_across = max(2.0, (right - _LEFT) / 70.0)
    for digits, value in _ticks(window.x_low * per_m, (window.x_high - window.x_low) * per_m, n_across):
        x = window.x(value / per_m)
        parts.append(
            f'<path d="M{x:.1f} {bottom:.1f}v4" stroke="currentColor" opacity="0.6"/>'
            f'<text x="{x:.1f}" y="{bottom + 15:.1f}" text-anchor="middle" {_TEXT}>'
            f"{value:.{digits}f}</text>"
        )
    n_up = max(2.0, (bottom - _TOP) / 45.0)
    for digits, value in _ticks(window.z_low * per_m, (window.z_high - window.z_low) * per_m, n_up):
        y = window.y(value / per_m)
        parts.append(
            f'<path d="M{_LEFT} {y:.1f}h-4M{_LEFT} {y:.1f}H{right:.1f}" stroke="currentColor" opacity="0.13"/>'
            f'<text x="{_LEFT - 6}" y="{y + 4:.1f}" text-anchor="end" {_TEXT}>'
            f"{value:.{digits}f}</text>"
        )
    caption = f"{_ACROSS[profile.direction]} → [{name}], height in the scan's frame ↑ [{name}]"
    parts.append(f'<text x="{right:.1f}" y="{bottom + 30:.1f}" text-anchor="end" {_TEXT}>{text(caption)}</text>')
    return "".join(parts)


def _ticks(low: float, span: float, n: float) -> list[tuple[int, float]]:
    """Return about ``n`` round numbers, at least two: one alone gives no scale."""
    ticks = round_ticks(low, span, n)
    while len(ticks) < _LEAST_TICKS:
        n *= 1.5
        ticks = round_ticks(low, span, n)
    return ticks


def _is_inside(line: ProfileLine, window: _Window) -> bool:
    (x1, z1), (x2, z2) = line.ends.tolist()
    return bool(x2 > window.x_low and x1 < window.x_high and max(z1, z2) > window.z_low and min(z1, z2) < window.z_high)
