"""What of a scan is drawn: a subset of its points, and how large they must be to look like a surface."""

from dataclasses import dataclass

import numpy as np

from stair_inspector.geometry.arrays import Colors, Floats, Ints, freeze, own
from stair_inspector.model import Scan

MAX_POINTS = 600_000
"""Points sent to a page; 15 bytes each. The measurement always uses all of them."""
_CELL_M = 0.02
_CELLS_ACROSS = 100
_PLAIN_COLOR = (172, 176, 182)
_STRETCHED = (2.0, 98.0)
"""Percentiles of the intensity that become the darkest and the lightest grey: few points reflect far more than most."""
_GREYS = (24, 240)


@dataclass(frozen=True, slots=True, eq=False)
class Display:
    """The drawn subset: ``point_ids`` (m,) into the scan, ``points`` (m, 3) local, ``colors``, spacing in metres.

    ``greys`` (m, 3) are by how strongly each reflected, None where the scan does not say.
    """

    point_ids: Ints
    points: Floats
    colors: Colors
    spacing_m: float
    greys: Colors | None = None

    def raw_colors(self, *, by_intensity: bool) -> Colors:
        """Return the colours of the raw cloud: those of the scan, or its intensity where that is wanted and known."""
        return self.greys if by_intensity and self.greys is not None else self.colors


def choose_display(scan: Scan, most: int = MAX_POINTS) -> Display:
    """Choose at most ``most`` points, evenly at random with a fixed seed, in the scan's own order."""
    n = len(scan.points)
    ids = np.arange(n)
    if n > most:
        ids = np.sort(np.random.default_rng(0).choice(n, most, replace=False))
    return display_of(scan, ids)


def display_of(scan: Scan, ids: Ints) -> Display:
    """Return the points of a scan with these indices (m,) as a subset to be drawn."""
    points = scan.points[ids]
    greys = None if scan.intensities is None else freeze(_greys(scan.intensities[ids]))
    return Display(
        point_ids=own(ids, (None,), "point_ids", np.int64),
        points=own(points, (None, 3), "points"),
        colors=own(_colors(scan, ids, greys), (None, 3), "colors", np.uint8),
        spacing_m=estimate_spacing(points) if len(points) else 0.0,
        greys=greys,
    )


def estimate_spacing(points: Floats) -> float:
    """Estimate the distance of neighbouring points on a surface, metres, from the number of occupied 2 cm cells."""
    low = points.min(axis=0)
    # Smaller for a scan that is: the wrong unit can make a staircase of five millimetres.
    cell = min(_CELL_M, max(float(np.linalg.norm(points.max(axis=0) - low)) / _CELLS_ACROSS, 1e-9))
    cells = np.floor((points - low) / cell).astype(np.int64)
    size = cells.max(axis=0) + 1
    n_occupied = len(np.unique((cells[:, 0] * size[1] + cells[:, 1]) * size[2] + cells[:, 2]))
    # An occupied cell holds about one cell face of surface.
    return float(cell * np.sqrt(n_occupied / len(points)))


def _greys(intensities: Floats) -> Colors:
    """Return greys (m, 3) for intensities (m,), the plain one where there is none."""
    colors = np.tile(np.array(_PLAIN_COLOR, dtype=np.uint8), (len(intensities), 1))
    is_known = np.isfinite(intensities)
    known = intensities[is_known]
    if len(known):
        low, high = np.percentile(known, _STRETCHED)
        if high <= low:
            low, high = known.min(), known.max()
        share = np.clip((known - low) / max(high - low, 1e-300), 0.0, 1.0)
        colors[is_known] = np.rint(_GREYS[0] + share * (_GREYS[1] - _GREYS[0])).astype(np.uint8)[:, None]
    return colors


def _colors(scan: Scan, ids: Ints, greys: Colors | None) -> Colors:
    """Return the scan's own colours; where it has none, or one for all as some exporters write, greys, or one grey."""
    if scan.colors is not None and (scan.colors != scan.colors[0]).any():
        return scan.colors[ids]
    if greys is not None:
        return greys
    return np.tile(np.array(_PLAIN_COLOR, dtype=np.uint8), (len(ids), 1))
