"""A box whose faces stand along the axes of a scan, or upright and turned about the vertical."""

import math
from dataclasses import dataclass

import numpy as np

from stair_inspector.geometry.arrays import Bools, Floats


@dataclass(frozen=True, slots=True, eq=False)
class TurnedBox:
    """A box: ``axes`` (3, 3), its directions as rows, unit, right-handed; ``bounds`` (2, 3), metres along them.

    ``is_turned`` is false where the axes are those of the points: their coordinates are then taken as they are.
    """

    axes: Floats
    bounds: Floats
    is_turned: bool

    def coordinates(self, points: Floats) -> Floats:
        """Return points or directions (..., 3) along the axes of the box."""
        return points @ self.axes.T if self.is_turned else points

    def holds(self, points: Floats) -> Bools:
        """Tell which of points (n, 3) lie in the box, its faces included."""
        along = self.coordinates(points)
        inside: Bools = ((along >= self.bounds[0]) & (along <= self.bounds[1])).all(axis=1)
        return inside

    def corners(self) -> Floats:
        """Return the corners (8, 3); bit 2 of a corner's number is the first axis, bit 1 the second, bit 0 the last."""
        ends = np.array([[self.bounds[number >> shift & 1, 2 - shift] for shift in (2, 1, 0)] for number in range(8)])
        return ends @ self.axes if self.is_turned else ends


def box_axes(up: Floats, bearing_deg: float | None) -> Floats:
    """Return the axes (3, 3) of an upright box: those of the scan, one of them stood upright, turned about it.

    Parameters
    ----------
    up : (3,)
        Unit, scan axes. The axis nearest to it is the upright one.
    bearing_deg : float, optional
        Of the next axis in the order x, y, z, x: from itself towards the one after; with z upright from x towards y.
        Without it the axes are those of the scan.
    """
    if bearing_deg is None:
        return np.eye(3)
    upright = int(np.argmax(np.abs(up)))
    first, second = (upright + 1) % 3, (upright + 2) % 3
    vertical = up * math.copysign(1.0, up[upright])
    level = np.eye(3)[first] - vertical[first] * vertical
    level /= np.linalg.norm(level)
    across = np.cross(vertical, level)
    cosine, sine = math.cos(math.radians(bearing_deg)), math.sin(math.radians(bearing_deg))
    axes = np.zeros((3, 3))
    axes[upright] = vertical
    axes[first] = cosine * level + sine * across
    axes[second] = cosine * across - sine * level
    return axes


def turned_box(low: Floats, high: Floats, up: Floats, bearing_deg: float | None) -> TurnedBox:
    """Return the box between two corners (3,), which stands upright and is turned about its middle by a bearing.

    Without a bearing its faces lie along the axes of the points.
    """
    axes = box_axes(up, bearing_deg)
    if bearing_deg is None:
        return TurnedBox(axes, np.array([low, high]), is_turned=False)
    middle, half = axes @ (np.asarray(low) + high) / 2.0, (np.asarray(high) - low) / 2.0
    return TurnedBox(axes, np.array([middle - half, middle + half]), is_turned=True)


def bearing_of(direction: Floats, up: Floats) -> float:
    """Return the bearing of the box that lies along a direction (3,) of the plan, degrees, at most 45 either way."""
    upright = int(np.argmax(np.abs(up)))
    axes = box_axes(up, 0.0)
    along, across = (float(direction @ axes[(upright + turn) % 3]) for turn in (1, 2))
    return (math.degrees(math.atan2(across, along)) + 45.0) % 90.0 - 45.0


def box_around(points: Floats, room: Floats, up: Floats, bearing_deg: float | None) -> tuple[Floats, Floats]:
    """Return the low and the high corner, as :func:`turned_box` takes them, of the box of a bearing around points.

    Parameters
    ----------
    points : (n, 3)
        At least one.
    room : (3,)
        Between them and the faces, metres, along the axes of the box.
    up : (3,)
        Unit, scan axes.
    bearing_deg : float, optional
        As of :func:`box_axes`.
    """
    axes = box_axes(up, bearing_deg)
    along = points @ axes.T
    low, high = along.min(axis=0) - room, along.max(axis=0) + room
    middle, half = (low + high) / 2.0 @ axes, (high - low) / 2.0
    return middle - half, middle + half
