"""Flights that curve, of exactly known geometry, sampled point by point: no rays, no occlusion, no mesh.

The nosings are radial lines about a centre on the left, or on the right, of who climbs; the climb begins along +x at
the origin, with the middle of the first nosing there. Without an overhang the risers' faces are those lines.
"""

from dataclasses import dataclass

import numpy as np

from tests.synthetic import make_scan


@dataclass(frozen=True)
class Curve:
    """A flight of treads that turn about a centre, a floor before it and a landing behind it; lengths in metres.

    ``radius`` is that of the middle line, along which the going is measured. ``skews_deg`` turns single nosings about
    their middles, in degrees by step: a defect.
    """

    radius: float = 4.0
    n_risers: int = 8
    rise: float = 0.17
    going: float = 0.28
    width: float = 1.0
    is_left: bool = True
    noise: float = 0.0
    spacing: float = 0.012
    landing: float = 1.0
    overhang: float = 0.0
    skews_deg: tuple[tuple[int, float], ...] = ()
    seed: int = 1

    @property
    def step_rad(self):
        return self.going / self.radius

    def scan(self):
        """The scan, with the exact normals of its surfaces."""
        rng = np.random.default_rng(self.seed)
        parts = [self._tread(rng, -0.9, 0.0, 0.0, 0.0, 0.0)]
        for k in range(1, self.n_risers + 1):
            turn, after = (self._turn_of(step) for step in (k, k + 1))
            low = (k - 1) * self.going
            high = low + (self.going if k < self.n_risers else self.landing)
            parts += [
                self._tread(rng, low, high, k * self.rise, turn, after if k < self.n_risers else 0.0, self.overhang)
            ]
            parts += [self._riser(rng, low, k * self.rise, turn)]
        points, normals = (np.concatenate(arrays) for arrays in zip(*parts, strict=True))
        points = points + rng.normal(0.0, self.noise, points.shape) if self.noise else points
        if not self.is_left:
            points, normals = points * (1.0, -1.0, 1.0), normals * (1.0, -1.0, 1.0)
        return make_scan(points, normals)

    def _turn_of(self, step):
        return np.radians(dict(self.skews_deg).get(step, 0.0))

    def _cells(self, rng, n_along, n_across):
        """Coordinates from 0 to 1 along and across, one anywhere in each cell."""
        cells = np.stack(np.meshgrid(np.arange(n_along), np.arange(n_across), indexing="ij"), -1).reshape(-1, 2)
        return ((cells + rng.uniform(size=cells.shape)) / (n_along, n_across)).T

    def _placed(self, way, aside, height):
        """Points at a way along the middle line and so far to its left."""
        angle, radius = way / self.radius, self.radius - aside
        return np.stack([radius * np.sin(angle), self.radius - radius * np.cos(angle), height], axis=1)

    def _tread(self, rng, low, high, height, turn, turn_after, overhang=0.0):
        u, v = self._cells(rng, round((high - low) / self.spacing), round(self.width / self.spacing))
        aside = (v - 0.5) * self.width
        # A nosing turned to the left lies farther back on its left side.
        start, stop = (place - aside * np.tan(angle) for place, angle in ((low, turn), (high, turn_after)))
        # Parallel to its riser: so far before it on every line, whatever the line's radius.
        start = start - overhang * self.radius / (self.radius - aside)
        points = self._placed(start + u * (stop - start), aside, np.full(len(u), height))
        return points, np.tile([0.0, 0.0, 1.0], (len(points), 1))

    def _riser(self, rng, low, height, turn):
        u, v = self._cells(rng, round(self.rise / self.spacing), round(self.width / self.spacing))
        aside = (v - 0.5) * self.width
        # The front of a nosing is 40 mm high.
        overhang = np.where(u * self.rise < 0.04, self.overhang, 0.0) * self.radius / (self.radius - aside)
        points = self._placed(low - aside * np.tan(turn) - overhang, aside, height - u * self.rise)
        angle = low / self.radius + turn
        return points, np.tile([-np.cos(angle), -np.sin(angle), 0.0], (len(points), 1))
