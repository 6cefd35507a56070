"""The height histogram: how many upright points lie at which height, the clusters' bands, and the reach eps_z.

Bands are levels, and look so: grey. The steps at each have their own colours, below it.
"""

import numpy as np

from stair_inspector.files.palettes import Palette, Rgb
from stair_inspector.model import HeightProfile, Inspection, Level
from stair_inspector.units import round_ticks
from stair_inspector.viewer.bridge.markup import text
from stair_inspector.viewer.bridge.reach_drag import drag_attributes, reach_mark

_WIDTH = 400
_HEIGHT = 104
_BASE = 80


def histogram_html(inspection: Inspection | None, palette: Palette, pick_uuid: str) -> str:
    """Return the height histogram with a band for each cluster and the reach eps_z to scale.

    A drag over it chooses another reach, which it writes to the control ``pick_uuid``.
    """
    if inspection is None or not len(inspection.profile.counts):
        return f'<div data-testid="histogram" style="height:{_HEIGHT}px"></div>'
    profile = inspection.profile
    low, span = profile.low_m, profile.bin_m * len(profile.counts)
    eps_m = inspection.params.levels.eps_m

    def at(height_m: float) -> float:
        return 8.0 + (height_m - low) / span * (_WIDTH - 16.0)

    def band(level: Level) -> str:
        # A sharp level is thinner than a pixel: it is widened about its middle to be seen.
        width = max(5.0, at(level.high_m) - at(level.low_m))
        left = (at(level.high_m) + at(level.low_m) - width) / 2.0
        colors = _colors(level, palette, inspection)
        share = width / max(1, len(colors))
        chips = "".join(
            f'<rect x="{left + k * share:.1f}" y="{_BASE}" width="{share:.1f}" height="5" fill="rgb{color}"/>'
            for k, color in enumerate(colors)
        )
        # A band is a height, and grey; what steps lie at it is told below it in the colours that they have everywhere.
        return (
            f'<g data-level="{level.level_id}"><title>{text(_band_title(level, inspection))}</title>'
            f'<rect x="{left:.1f}" y="14" width="{width:.1f}" height="{_BASE - 14}" fill="currentColor" '
            f'opacity="0.16"/>{chips}</g>'
        )

    bands = "".join(band(level) for level in inspection.levels)
    ticks = "".join(
        f'<text x="{at(height):.1f}" y="{_HEIGHT - 6}" text-anchor="middle" font-size="11" '
        f'fill="currentColor" opacity="0.75">{height:.{digits}f}</text>'
        for digits, height in round_ticks(low, span)
    )
    reach = max(1.0, at(low + eps_m) - at(low))
    drag = drag_attributes(pick_uuid, _WIDTH, 1000.0 * span / (_WIDTH - 16.0))
    return (
        '<div data-testid="histogram" class="si-results" style="padding:2px 8px 2px 0">'
        f'<svg viewBox="0 0 {_WIDTH} {_HEIGHT}" width="100%" role="img"{drag} '
        f'aria-label="Heights of points on horizontal surfaces; {len(inspection.levels)} clusters">'
        '<text x="8" y="9" font-size="11" fill="currentColor" opacity="0.75">'
        "level points by height [m], √ scale; bands are levels</text>"
        f'<line x1="{_WIDTH - 8 - reach:.1f}" x2="{_WIDTH - 8}" y1="6" y2="6" stroke="currentColor" stroke-width="3"/>'
        f'<text data-reach-text="1" x="{_WIDTH - 12 - reach:.1f}" y="9" text-anchor="end" font-size="11" '
        f'fill="currentColor" opacity="0.9">ε_z {eps_m * 1000.0:g} mm</text>'
        f"{bands}<path d='{_outline(profile)}' fill='currentColor' opacity='0.72'/>{ticks}"
        f"{reach_mark(14, _BASE - 14)}</svg></div>"
    )


def _steps_at(level: Level, inspection: Inspection) -> list[int]:
    """Return the steps that lie in a height cluster; without the survey's surfaces a cluster is one step."""
    if inspection.patches:
        found = {patch.step_id for patch in inspection.patches if patch.level_id == level.level_id}
        return sorted(step_id for step_id in found if step_id is not None)
    return [level.level_id] if 1 <= level.level_id <= len(inspection.steps) else []


def _colors(level: Level, palette: Palette, inspection: Inspection) -> list[Rgb]:
    """Return the colours of the steps, or of the floor, that lie in a height cluster; none of what is neither."""
    if level.kind == "floor":
        return [palette.floor]
    return [palette.of_step(step_id) for step_id in _steps_at(level, inspection)]


def _band_title(level: Level, inspection: Inspection) -> str:
    """Return what a cluster is: its height and thickness, the steps in it, or why it is none."""
    name = "floor" if level.kind == "floor" else f"level {level.level_id}"
    thick = (level.high_m - level.low_m) * 1000.0
    place = f"{name}: {level.height_m:.3f} m, band of {thick:.0f} mm, {level.n_points:,} points"
    steps = _steps_at(level, inspection)
    what = f"; {level.kind}" if level.kind != "floor" else ""
    what += f", step {', '.join(map(str, steps))}" if what and steps else ""
    return place + what + (f": {level.reason}" if level.reason else "")


def _outline(profile: HeightProfile) -> str:
    """Return the path of the histogram, one column for each pixel, square-root scale."""
    counts = profile.counts
    n_columns = int(_WIDTH - 16)
    # The sum over the bins of a column, so that no narrow peak falls between two pixels.
    ends = np.linspace(0, len(counts), min(n_columns, len(counts)) + 1).astype(int)
    columns = np.add.reduceat(counts, ends[:-1])
    tall = np.sqrt(columns / max(1, columns.max())) * (_BASE - 16)
    step = n_columns / len(columns)
    points = [f"M8 {_BASE}"]
    for index, height in enumerate(tall):
        points.append(f"V{_BASE - height:.1f}H{8 + (index + 1) * step:.1f}")
    return "".join(points) + f"V{_BASE}Z"
