"""The pictures on a step's card: how far its surface departs from its plane, and its cross-section.

``card_pictures(scan, inspection, step, palette, unit)`` is HTML that goes below the card; empty for no step.
"""

import base64
import io

import numpy as np
from PIL import Image

from stair_inspector import priors
from stair_inspector.files.palettes import Palette
from stair_inspector.model import Inspection, Scan, Step
from stair_inspector.pictures.coloring import residual_legend
from stair_inspector.pictures.frames import SectionFrame, section_frame
from stair_inspector.pictures.ramps import color_signed, signed_limit
from stair_inspector.pictures.residuals import ResidualMap, residual_map
from stair_inspector.units import Unit, length_text
from stair_inspector.viewer.bridge.markup import text
from stair_inspector.viewer.scene.legends import colour_legend_html
from stair_inspector.viewer.scene.section_svg import profile_svg
from stair_inspector.viewer.scene.sections import cut, profile_of

_SECTION_THICKNESS_M = 0.04
_WIDTH = 420
_MARGIN = 6
_CAPTION = 16
_BEFORE, _BEHIND, _BELOW, _ABOVE = 0.35, 1.5, 1.35, 0.75
"""How much of a step's surroundings its section shows, in goings and rises."""
_LONGEST_GOING_M = 0.45
"""Of a landing's going only so much is shown."""


def card_pictures(
    scan: Scan, inspection: Inspection | None, step: Step | None, palette: Palette, unit: Unit = "mm"
) -> str:
    """Return the map of a step's residuals with its legend, and its cross-section, as HTML."""
    if inspection is None or step is None:
        return '<div data-testid="card-pictures"></div>'
    return (
        '<div data-testid="card-pictures" class="si-results" style="margin:0 9px 6px">'
        f"{residual_html(scan, inspection, step, unit)}{step_section_svg(scan, inspection, step, palette, unit)}</div>"
    )


def residual_html(scan: Scan, inspection: Inspection, step: Step, unit: Unit = "mm") -> str:
    """Return the map of a step's residuals as HTML: seen from above, its nosing below, its left on the left."""
    found = residual_map(scan, inspection, step)
    if found is None:
        return '<div data-testid="residual-map">No plane could be fitted to this step.</div>'
    limit_m = signed_limit(found.residuals_m)
    colors = color_signed(found.residuals_m.ravel(), limit_m).reshape(*found.residuals_m.shape, 3)
    alpha = np.where(np.isfinite(found.residuals_m), 255, 0).astype(np.uint8)
    stream = io.BytesIO()
    Image.fromarray(np.dstack([colors, alpha])).save(stream, "PNG", optimize=True)
    data = base64.b64encode(stream.getvalue()).decode("ascii")
    rows, columns = found.residuals_m.shape
    scale = (_WIDTH - 2 * _MARGIN) / (columns * found.cell_m)
    # A deep landing must not push everything else off the card.
    scale = min(scale, 0.6 * _WIDTH / (rows * found.cell_m))
    width, height = columns * found.cell_m * scale, rows * found.cell_m * scale
    left = (_WIDTH - width) / 2.0
    words = f"plane residuals of step {step.step_id}, cells of {length_text(found.cell_m, unit, 0)}, seen from above"
    return (
        f'<div data-testid="residual-map"><svg viewBox="0 0 {_WIDTH} {height + 2 * _CAPTION:.0f}" width="100%" '
        f'role="img" font-family="sans-serif" font-size="11" aria-label="{text(words)}">'
        f'<text x="{_MARGIN}" y="11" fill="currentColor" opacity="0.8">{text(words)}</text>'
        f'<image x="{left:.1f}" y="{_CAPTION}" width="{width:.1f}" height="{height:.1f}" preserveAspectRatio="none" '
        f'style="image-rendering:pixelated" href="data:image/png;base64,{data}"/>'
        f"{_nosing(step, found, section_frame(inspection, step.corners, step.step_id), scale, left)}"
        f'<text x="{left:.1f}" y="{height + 1.8 * _CAPTION:.1f}" fill="currentColor" opacity="0.75">left</text>'
        f'<text x="{_WIDTH / 2}" y="{height + 1.8 * _CAPTION:.1f}" text-anchor="middle" fill="currentColor" '
        'opacity="0.75">↑ climb · nosing</text>'
        f'<text x="{left + width:.1f}" y="{height + 1.8 * _CAPTION:.1f}" text-anchor="end" fill="currentColor" '
        f'opacity="0.75">right</text></svg>{colour_legend_html(residual_legend(limit_m, with_others=False))}</div>'
    )


def step_section_svg(scan: Scan, inspection: Inspection, step: Step, palette: Palette, unit: Unit = "mm") -> str:
    """Return the section along a step's own climb through its middle, with the steps beside it, as SVG."""
    frame = section_frame(inspection, step.corners, step.step_id)
    middle = step.line_points[1] if step.line_points is not None else frame.origin
    place_m = float((middle - frame.origin) @ frame.right)
    slab = cut(frame, "along", place_m, _SECTION_THICKNESS_M, step.corners)
    x = (step.corners - frame.origin) @ frame.climb
    height = float((step.plane.centroid + np.array(inspection.scan.origin_m)) @ frame.up)
    going = min(step.going_m.value, _LONGEST_GOING_M) if step.going_m is not None else priors.USUAL_GOING_M
    rise = step.rise_m.value if step.rise_m is not None else priors.USUAL_RISE_M
    # Of a landing only the front.
    back = min(float(x.max()), float(x.min()) + going)
    around = np.array(
        [
            [float(x.min()) - _BEFORE * going - rise, height - _BELOW * rise],
            [back + (_BEHIND - 1.0) * going, height + (1.0 + _ABOVE) * rise],
        ]
    )
    return profile_svg(profile_of(scan, inspection, slab), palette, unit, step.step_id, width=_WIDTH, around=around)


def _nosing(step: Step, found: ResidualMap, frame: SectionFrame, scale: float, left: float) -> str:
    if step.nosing is None:
        return ""
    offset = step.nosing - frame.origin
    x = left + (found.left_m + offset @ frame.right) * scale
    y = _CAPTION + (found.back_m - offset @ frame.climb) * scale
    return (
        f'<line data-nosing="1" x1="{x[0]:.1f}" y1="{y[0]:.1f}" x2="{x[1]:.1f}" y2="{y[1]:.1f}" '
        'stroke="currentColor" stroke-width="1.6"/>'
    )
