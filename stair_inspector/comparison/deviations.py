"""The map of a tread: how far its later surface lies off the earlier one, and where it differs from the rest of it."""

import math

import numpy as np

from stair_inspector.comparison.cells import SurfaceChange
from stair_inspector.comparison.surfaces import PlaneChange
from stair_inspector.geometry.arrays import Bools, Floats, own
from stair_inspector.geometry.plan import left_of
from stair_inspector.model import COVERAGE_FACTOR, Measured, TreadDeviations

_FEWEST_TOGETHER = 3
"""Cells side by side that make a place which differs: one alone may hold a thing on the tread."""


def map_deviations(
    surface: SurfaceChange, plane: PlaneChange | None, over_all_m: float, nearby_m: float, widening: float, turn: Floats
) -> TreadDeviations:
    """Return the map of a tread.

    Parameters
    ----------
    surface, plane
        The deviations after the alignment, and the plane through them, None where too few were seen.
    over_all_m, nearby_m
        Standard uncertainties of a height beside noise, against the whole stair and against the rest of the tread.
    widening : float
        By how much the uncertainty of one cell is widened where the largest of many is looked at.
    turn : (3, 3)
        From local scan axes to level ones.
    """
    grid = surface.grid
    shape = grid.n_rows, grid.n_columns
    u_m = COVERAGE_FACTOR * np.sqrt(surface.noise_m**2 + over_all_m**2)
    u_m[~np.isfinite(surface.deviation_m)] = math.nan
    n_cells = int(np.count_nonzero(surface.is_surface))
    n_seen = int(np.count_nonzero(np.isfinite(surface.deviation_m)))
    is_local, worst = np.zeros(shape, dtype=bool), None
    if plane is not None:
        limit = widening * COVERAGE_FACTOR * np.sqrt(surface.noise_m**2 + nearby_m**2)
        is_local, worst = _local(plane.left_m.reshape(shape), limit.reshape(shape))
    normal = np.array([-surface.reference[1], -surface.reference[2], 1.0])
    normal /= np.linalg.norm(normal)
    ahead = grid.cell_m * np.array([*grid.ahead, surface.reference[1:] @ grid.ahead])
    left = left_of(grid.ahead)
    aside = grid.cell_m * np.array([*left, surface.reference[1:] @ left])
    corner = np.array([*grid.origin, surface.reference[0] + surface.reference[1:] @ grid.origin])
    return TreadDeviations(
        cell_m=grid.cell_m,
        corner=own(turn.T @ corner, (3,), "corner"),
        ahead=own(turn.T @ ahead, (3,), "ahead"),
        aside=own(turn.T @ aside, (3,), "aside"),
        normal=own(turn.T @ normal, (3,), "normal"),
        deviation_m=surface.deviation_m.reshape(shape),
        u_m=u_m.reshape(shape),
        is_tread=surface.is_surface.reshape(shape),
        is_local=is_local,
        coverage=n_seen / n_cells if n_cells else 0.0,
        worst_m=worst,
    )


def _local(left_m: Floats, limit_m: Floats) -> tuple[Bools, Measured | None]:
    """Return the cells that lie off the rest of the tread, and how far those do that lie off most."""
    from scipy import ndimage

    is_local = np.zeros(left_m.shape, dtype=bool)
    worst: Measured | None = None
    for sign in (-1.0, 1.0):
        with np.errstate(invalid="ignore"):
            labels, n = ndimage.label(sign * left_m > limit_m)
        for label in range(1, n + 1):
            cells = labels == label
            if np.count_nonzero(cells) < _FEWEST_TOGETHER:
                continue
            is_local |= cells
            found = Measured(float(np.median(left_m[cells])), float(np.median(limit_m[cells])))
            if worst is None or abs(found.value) > abs(worst.value):
                worst = found
    return is_local, worst
