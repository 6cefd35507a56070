"""Rigid motions from the later level frame to the earlier one."""

import math
from dataclasses import dataclass, replace

import numpy as np

from stair_inspector.comparison.epochs import Tread
from stair_inspector.geometry.arrays import Floats


@dataclass(frozen=True, slots=True, eq=False)
class RigidMotion:
    """``turn @ point + shift_m``, level axes, metres."""

    turn: Floats
    shift_m: Floats

    def moved(self, points: Floats) -> Floats:
        """Return points (3, n) where they come to lie."""
        places: Floats = self.turn @ points + self.shift_m[:, None]
        return places

    def moved_plane(self, plane: Floats) -> Floats:
        """Return a plane, as a height at zero and two slopes, where it comes to lie."""
        normal = self.turn @ np.array([-plane[1], -plane[2], 1.0])
        place = self.turn @ np.array([0.0, 0.0, plane[0]]) + self.shift_m
        slopes = -normal[:2] / normal[2]
        return np.array([place[2] - slopes @ place[:2], *slopes])

    def moved_tread(self, tread: Tread) -> Tread:
        """Return a tread where it comes to lie."""
        heights = tread.height_at(tread.corners[:, 0], tread.corners[:, 1])
        corners = self.moved(np.vstack([tread.corners.T, heights]))[:2].T
        climb = (self.turn @ np.array([*tread.climb, 0.0]))[:2]
        nosing = self.moved(tread.nosing.T).T
        plane = self.moved_plane(tread.plane)
        return replace(tread, plane=plane, corners=corners, climb=climb / np.hypot(*climb), nosing=nosing)

    def then(self, other: "RigidMotion") -> "RigidMotion":
        """Return this motion followed by another."""
        return RigidMotion(other.turn @ self.turn, other.turn @ self.shift_m + other.shift_m)


def level_motion(turn_rad: float, shift_m: Floats) -> RigidMotion:
    """Return a turn about the vertical through zero, to the left, followed by a shift."""
    cos, sin = math.cos(turn_rad), math.sin(turn_rad)
    return RigidMotion(
        np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]]), np.asarray(shift_m, dtype=np.float64)
    )


def about(centre_m: Floats, angles_rad: Floats, shift_m: Floats) -> RigidMotion:
    """Return the turn by the vector ``angles_rad`` (3,) about a centre (3,), followed by a shift."""
    angle = float(np.linalg.norm(angles_rad))
    turn = np.eye(3)
    if angle:
        x, y, z = angles_rad / angle
        cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        turn = turn + math.sin(angle) * cross + (1.0 - math.cos(angle)) * (cross @ cross)
    return RigidMotion(turn, centre_m - turn @ centre_m + shift_m)
