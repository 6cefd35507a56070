"""The scan in the paper's colours as a PLY file, with the edges that were found."""

import numpy as np

from stair_inspector.files.palettes import Palette, Rgb, read_palette
from stair_inspector.files.ply import ply_bytes
from stair_inspector.geometry.arrays import Floats
from stair_inspector.model import Inspection, Scan, Step
from stair_inspector.quantities import GOING, RISE

_EDGE_SPACING_M = 0.002


_EDGE_POINTS = 2000
"""Distance of the points that draw an edge in the debug PLY, and the most of them: a wrong unit makes long edges."""


def debug_ply_bytes(scan: Scan, inspection: Inspection) -> bytes:
    """Return the scan in the paper's colours, with its edges drawn as rows of extra points (step 11 of the paper).

    Floor gray, non-stair black, steps in turn red, orange, yellow, green, blue, indigo, violet; front edge and nosing
    line pink, back edge black, side edges gray, the K points nearest to each centre black, measuring lines turquoise.
    Where the survey has measured, each step's nosing line and its three measuring lines are drawn too: the going from
    the nosing along the climb, the rise from the nosing down.

    Parameters
    ----------
    scan, inspection
        The same scan that was inspected.

    Returns
    -------
    bytes
        Binary PLY, float64 coordinates in metres in the scan frame; the scan's used points first, where they
        lay when they were measured, then the edges.
    """
    palette = read_palette("paper")
    # Rejected levels have no step: they are drawn as what they are, not part of a stair.
    highest = max((step.step_id for step in inspection.steps), default=0)
    labels = np.where(inspection.labels > highest, -1, inspection.labels).astype(np.int16)
    colors = palette.of_labels(labels)
    extra_points: list[Floats] = []
    extra_colors = []
    for step in inspection.steps:
        colors[step.nearest_ids] = palette.centre
        for start, stop, color in _drawn_lines(step, inspection.up.vector, palette):
            row = _points_along(start, stop)
            extra_points.append(row)
            extra_colors.append(np.tile(np.array(color, dtype=np.uint8), (len(row), 1)))
    placed = inspection.places(scan.points, np.arange(len(scan.points)))
    points = np.vstack([placed, *extra_points]) + scan.origin_m
    return ply_bytes(points, np.vstack([colors, *extra_colors]))


def _drawn_lines(step: Step, up: Floats, palette: Palette) -> list[tuple[Floats, Floats, Rgb]]:
    """Return start, stop and colour of every line that is drawn of a step, local coordinates."""
    front_left, front_right, back_right, back_left = step.corners
    lines = [
        (front_left, front_right, palette.front_edge),
        (back_left, back_right, palette.back_edge),
        (front_left, back_left, palette.side_edge),
        (front_right, back_right, palette.side_edge),
    ]
    if step.nosing is not None:
        lines.append((step.nosing[0], step.nosing[1], palette.front_edge))
    return lines + [(start, stop, palette.measure) for start, stop in _measuring_lines(step, up)]


def _measuring_lines(step: Step, up: Floats) -> list[tuple[Floats, Floats]]:
    """Return start and stop of each going and rise that was measured on the left, centre and right line."""
    if step.line_points is None:
        return []
    lines = []
    goings_m, rises_m = GOING.lines_of(step), RISE.lines_of(step)
    for point, going_m, rise_m in zip(step.line_points, goings_m, rises_m, strict=True):
        if going_m is not None and step.climb is not None:
            lines.append((point, point + going_m * step.climb))
        if rise_m is not None:
            lines.append((point, point - rise_m * up))
    return lines


def _points_along(start: Floats, stop: Floats) -> Floats:
    count = int(min(_EDGE_POINTS, max(2.0, np.ceil(np.linalg.norm(stop - start) / _EDGE_SPACING_M) + 1.0)))
    points: Floats = start + np.linspace(0.0, 1.0, count)[:, None] * (stop - start)
    return points
