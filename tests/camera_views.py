"""Views of a staircase as a camera that measures ranges sees them: exact rays on a few rectangles.

Stair frame: the climb goes along +x from the first riser at x = 0, +y is the left of who climbs, +z is up.
"""

from dataclasses import dataclass

import numpy as np

from stair_inspector.model import Scan
from tests.synthetic import make_scan

AXES = {
    "x": (1.0, 0.0, 0.0),
    "y": (0.0, 1.0, 0.0),
    "z": (0.0, 0.0, 1.0),
    "-x": (-1.0, 0.0, 0.0),
    "-y": (0.0, -1.0, 0.0),
    "-z": (0.0, 0.0, -1.0),
}


@dataclass(frozen=True)
class View:
    """A straight stair in a room, one frame of a camera; metres, degrees.

    ``pitch_deg`` is how far the camera looks down (negative: up). The frame is the camera's own: x to the right, y
    down, z ahead; ``turned_to`` turns it so that the true up of a level camera is that axis. The camera stands
    ``distance`` before the first riser, or, ``from_above``, on the upper landing and looks down the stair.
    """

    n_risers: int = 6
    rise: float = 0.175
    going: float = 0.28
    width: float = 1.0
    pitch_deg: float = 10.0
    camera_height: float = 1.2
    distance: float = 1.3
    aside: float = 0.1
    yaw_deg: float = 0.0
    has_walls: bool = True
    from_above: bool = False
    turned_to: str = "-y"
    noise: float = 0.002
    rays: tuple[int, int] = (220, 160)
    field_deg: tuple[float, float] = (75.0, 58.0)
    seed: int = 1

    def rectangles(self):
        """(axis, place, low, high): the axis a rectangle is square to, and its box on the two others."""
        n, r, g, w = self.n_risers, self.rise, self.going, self.width / 2.0
        landing = 1.2
        top, back = n * r, (n - 1) * g + landing
        side = 1.6 if not self.has_walls else w + 0.02
        found = [(2, 0.0, (-3.0, -side), (0.0, side))]
        found += [(0, k * g, (-w, k * r), (w, (k + 1) * r)) for k in range(n)]
        found += [(2, (k + 1) * r, (k * g, -w), ((k + 1) * g if k < n - 1 else back, w)) for k in range(n)]
        if self.has_walls:
            found += [(1, sign * (w + 0.01), (-3.0, 0.0), (back, top + 2.4)) for sign in (-1.0, 1.0)]
            found += [(0, back, (-side, top), (side, top + 2.4)), (0, -3.0, (-side, 0.0), (side, top + 2.4))]
        return found

    @property
    def up(self):
        """True up in the frame of the points."""
        return self.points_and_up()[1]

    def points_and_up(self):
        rng = np.random.default_rng(self.seed)
        columns, rows = self.rays
        across = np.tan(np.radians(self.field_deg[0] / 2.0)) * np.linspace(-1.0, 1.0, columns)
        down = np.tan(np.radians(self.field_deg[1] / 2.0)) * np.linspace(-1.0, 1.0, rows)
        rays = np.stack(np.meshgrid(across, down, [1.0], indexing="ij"), axis=-1).reshape(-1, 3)
        rays /= np.linalg.norm(rays, axis=1)[:, None]
        pitch, yaw = np.radians(self.pitch_deg), np.radians(self.yaw_deg)
        way = -1.0 if self.from_above else 1.0
        ahead = np.array([way * np.cos(yaw), way * np.sin(yaw), 0.0])
        forward = np.cos(pitch) * ahead - np.array([0.0, 0.0, np.sin(pitch)])
        right = np.cross(ahead, [0.0, 0.0, 1.0])
        stair_from_camera = np.stack([right, np.cross(forward, right), forward], axis=1)
        place = np.array([-self.distance, self.aside, self.camera_height])
        if self.from_above:
            place += [self.distance + (self.n_risers - 1) * self.going + 0.6, 0.0, self.n_risers * self.rise]
        directions = rays @ stair_from_camera.T
        ranges = np.full(len(rays), np.inf)
        for axis, at, low, high in self.rectangles():
            with np.errstate(divide="ignore", invalid="ignore"):
                length = (at - place[axis]) / directions[:, axis]
                hits = place + length[:, None] * directions
                others = [k for k in range(3) if k != axis]
                inside = ((hits[:, others] >= low) & (hits[:, others] <= high)).all(axis=1) & (length > 0.2)
            ranges = np.where(inside & (length < ranges), length, ranges)
        seen = ranges < 6.0
        ranges = ranges + rng.normal(0.0, self.noise, len(ranges))
        points = rays[seen] * ranges[seen, None]
        turn = turn_between(np.array([0.0, -1.0, 0.0]), np.array(AXES[self.turned_to]))
        return points @ turn.T, turn @ stair_from_camera.T @ [0.0, 0.0, 1.0]

    def scan(self) -> Scan:
        return make_scan(self.points_and_up()[0])


def turn_between(start, stop):
    """A rotation that takes one axis to another, (3, 3)."""
    if start @ stop > 0.5:
        return np.eye(3)
    if start @ stop < -0.5:
        other = np.roll(np.abs(start), 1)
        return 2.0 * np.outer(other, other) - np.eye(3)
    third = np.cross(start, stop)
    return np.outer(stop, start) - np.outer(start, stop) + np.outer(third, third)
