"""Which point a click means: the foremost drawn point near the ray through the pixel."""

import math
from dataclasses import dataclass

import numpy as np

from stair_inspector.content.segmented_points import labels_at, residuals_at
from stair_inspector.geometry.arrays import Floats
from stair_inspector.model import FLOOR_LABEL, Inspection
from stair_inspector.pictures.display import Display

_REACH_PIXELS = 8.0
_FRONT_LAYER = 4.0
"""Depth of what counts as foremost, in radii of the cone: a surface seen at a low angle still lies within it."""
_EXACT_SHARE = 3.0 / 8.0
"""Share of the cone that is searched first: what lies right under the pointer goes before what is only near it."""


@dataclass(frozen=True, slots=True, eq=False)
class Ray:
    """A half line: ``origin`` (3,) and unit ``direction`` (3,), local metres."""

    origin: Floats
    direction: Floats


@dataclass(frozen=True, slots=True)
class Pick:
    """A picked point: ``place_m`` in the scan's own frame, metres, and what the result says of it.

    ``step_id`` is 0 for the floor and None for what belongs to no step; ``residual_m`` its signed distance from the
    plane of the step or the floor.
    """

    place_m: tuple[float, float, float]
    step_id: int | None
    residual_m: float | None


def ray_of(origin: tuple[float, float, float], direction: tuple[float, float, float], rotation: Floats) -> Ray:
    """Return a ray of the view in local coordinates.

    Parameters
    ----------
    origin, direction : (3,)
        As viser tells them, in the coordinates of the view.
    rotation : (3, 3)
        From local to the view, ``Stage.rotation``.
    """
    towards = np.array(direction, dtype=np.float64)
    return Ray(rotation.T @ np.array(origin, dtype=np.float64), rotation.T @ (towards / np.linalg.norm(towards)))


def cone_of(fov_rad: float, image_height: int, pixels: float = _REACH_PIXELS) -> float:
    """Return the tangent of the angle that so many pixels span, for an upright angle of view and a picture's height."""
    return 2.0 * math.tan(fov_rad / 2.0) * pixels / max(image_height, 1)


def point_at_click(points: Floats, ray: Ray, cone: float) -> int | None:
    """Return the row of the point that a click means, or None where nothing lies near the ray.

    Parameters
    ----------
    points : (m, 3)
        What is drawn, local.
    ray : Ray
        Through the clicked pixel.
    cone : float
        Tangent of the largest angle between the ray and a point, from :func:`cone_of`.

    Notes
    -----
    Of the points inside the cone, or in its middle if there are any, those in the foremost layer count, so that nothing
    is picked through a surface; of these the one nearest to the ray.
    """
    offset = points - ray.origin
    depth = offset @ ray.direction
    away = np.sqrt(np.maximum(np.einsum("ij,ij->i", offset, offset) - depth**2, 0.0))
    for reach in (_EXACT_SHARE * cone, cone):
        rows = np.nonzero((depth > 0.0) & (away <= reach * depth))[0]
        if len(rows):
            rows = rows[depth[rows] <= float(depth[rows].min()) * (1.0 + _FRONT_LAYER * reach)]
            return int(rows[np.argmin(away[rows] / depth[rows])])
    return None


def pick_of(inspection: Inspection, display: Display, row: int) -> Pick:
    """Return what lies at a displayed point."""
    rows, points = display.point_ids[row : row + 1], display.points[row : row + 1]
    label = int(labels_at(inspection, rows)[0])
    residual = float(residuals_at(inspection, points, rows)[0])
    # Where it lay when it was measured: only so is a length right between points of stations laid onto each other.
    place = inspection.places(points, rows)[0]
    x, y, z = (float(value) for value in place + np.array(inspection.scan.origin_m))
    return Pick((x, y, z), label if label >= FLOOR_LABEL else None, None if math.isnan(residual) else residual)


def owner_text(pick: Pick) -> str:
    """Return what a picked point belongs to: ``step 3``, ``floor`` or ``no step``."""
    if pick.step_id is None:
        return "no step"
    return "floor" if pick.step_id == FLOOR_LABEL else f"step {pick.step_id}"
