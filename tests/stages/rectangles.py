"""Surfaces made of plan cells, as the splitting of height clusters hands them on; level frame, metres.

Unless a test says otherwise a flight climbs along +x from x = 0, its treads 1.0 m wide from y = 0.
"""

import dataclasses

import numpy as np

from stair_inspector.geometry.fits import PlaneFit
from stair_inspector.model import Patches, Surface
from tests.synthetic import rotation

CELL = 0.02
RISE, GOING, WIDTH = 0.17, 0.28, 1.0


def rectangle(x, y, z, level_id=0, slope=(0.0, 0.0)):
    """A surface over the ranges x and y, one cell every 20 mm, at height z in its middle."""
    axes = [low + (np.arange(round((high - low) / CELL)) + 0.5) * CELL for low, high in (x, y)]
    return surface_of(np.stack(np.meshgrid(*axes, indexing="ij")).reshape(2, -1), z, level_id, slope)


def surface_of(cells, z, level_id=0, slope=(0.0, 0.0)):
    centre = np.append(cells.mean(axis=1), z)
    return Surface(
        level_id=level_id,
        rows=np.zeros(0, dtype=np.int64),
        cells_m=cells,
        area_m2=cells.shape[1] * CELL**2,
        height_m=float(z),
        centre_m=centre,
        slope=np.array(slope),
        sigma_m=0.001,
        plane=PlaneFit(centre, np.array([0.0, 0.0, 1.0]), 0.001, 4 * cells.shape[1]),
    )


def floor(x=(-0.8, 0.0), y=(0.0, WIDTH), z=0.0):
    return rectangle(x, y, z)


def flight(n, x=0.0, y=(0.0, WIDTH), z=0.0, rise=RISE, going=GOING):
    """The treads of a flight whose first riser stands at x on a floor at height z."""
    return [rectangle((x + (k - 1) * going, x + k * going), y, z + k * rise, k) for k in range(1, n + 1)]


def moved(surfaces, degrees=0.0, shift=(0.0, 0.0, 0.0), mirror=False):
    """The surfaces turned about the vertical, after mirroring left and right, and then shifted."""
    turn = rotation("z", degrees)[:2, :2] @ np.diag([1.0, -1.0 if mirror else 1.0])
    return [
        dataclasses.replace(
            surface,
            cells_m=turn @ surface.cells_m + np.array(shift[:2])[:, None],
            centre_m=np.append(turn @ surface.centre_m[:2], surface.centre_m[2]) + shift,
            height_m=surface.height_m + shift[2],
            slope=turn @ surface.slope,
        )
        for surface in surfaces
    ]


def patches_of(surfaces):
    return Patches(tuple(surfaces), CELL)
