"""Scenes of level and upright rectangles as tripods see them: every ray ends at the first one that it meets."""

from dataclasses import dataclass, field, replace

import numpy as np

from stair_inspector.model import ScanStations
from tests.synthetic import make_scan


@dataclass(frozen=True)
class Rect:
    """The rectangle at ``at`` on an axis; ``low`` and ``high`` (2,) on the other two in their order."""

    axis: int
    at: float
    low: tuple[float, float]
    high: tuple[float, float]


@dataclass(frozen=True)
class RayStair:
    """A flight that climbs along x from 0, between y 0 and ``width``; ``left`` ends steps so much before that.

    The last tread is as deep as the others; ``around`` is what else stands there.
    """

    n_steps: int = 6
    rise: float = 0.17
    going: float = 0.28
    width: float = 1.1
    left: dict[int, float] = field(default_factory=dict)
    around: tuple[Rect, ...] = ()

    def rects(self):
        """Floor, treads and risers, and what stands around."""
        far = self.n_steps * self.going
        found = [Rect(2, 0.0, (-0.8, -0.4), (far + 0.2, self.width + 1.0)), *self.around]
        for k in range(1, self.n_steps + 1):
            high_y = self.width - self.left.get(k, 0.0)
            found.append(Rect(2, k * self.rise, ((k - 1) * self.going, 0.0), (k * self.going, high_y)))
            found.append(Rect(0, (k - 1) * self.going, (0.0, (k - 1) * self.rise), (high_y, k * self.rise)))
        return found


def box(low, high):
    """The six faces of a box."""
    faces = []
    for axis in range(3):
        rest = [k for k in range(3) if k != axis]
        ends = tuple(low[k] for k in rest), tuple(high[k] for k in rest)
        faces += [Rect(axis, low[axis], *ends), Rect(axis, high[axis], *ends)]
    return tuple(faces)


def seen(rects, places, step_deg=0.2, noise=0.001, seed=1):
    """Points (n, 3) of the rectangles as stations at places see them, and which saw each (n,)."""
    rng = np.random.default_rng(seed)
    points, of_point = [], []
    for number, place in enumerate(np.asarray(places, dtype=float)):
        azimuth, elevation = np.meshgrid(
            np.radians(np.arange(0.0, 360.0, step_deg) + step_deg * rng.random()),
            np.radians(np.arange(-75.0, 40.0, step_deg) + step_deg * rng.random()),
        )
        level = np.cos(elevation)
        rays = np.stack([level * np.cos(azimuth), level * np.sin(azimuth), np.sin(elevation)], axis=-1).reshape(-1, 3)
        nearest = np.full(len(rays), np.inf)
        for rect in rects:
            with np.errstate(divide="ignore", invalid="ignore"):
                ranges = (rect.at - place[rect.axis]) / rays[:, rect.axis]
            ahead = np.flatnonzero((ranges > 0.05) & (ranges < nearest))
            rest = [k for k in range(3) if k != rect.axis]
            hits = place[rest] + ranges[ahead, None] * rays[np.ix_(ahead, rest)]
            inside = ahead[((hits >= rect.low) & (hits <= rect.high)).all(axis=1)]
            nearest[inside] = ranges[inside]
        hit = np.flatnonzero(nearest < 12.0)
        measured = nearest[hit] + rng.normal(0.0, noise, len(hit))
        points.append(place + measured[:, None] * rays[hit])
        of_point.append(np.full(len(hit), number))
    return np.concatenate(points), np.concatenate(of_point)


def scan_of(rects, places, names=("Foot", "Top", "Side"), **how):
    """The scan of such a scene, whose stations are known."""
    points, of_point = seen(rects, places, **how)
    stations = ScanStations(names[: len(places)], of_point.astype(np.int16), np.asarray(places, dtype=float))
    return replace(make_scan(points), stations=stations)
