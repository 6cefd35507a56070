"""Small stairs of exactly known geometry, sampled point by point: no rays, no occlusion, no mesh.

Stair frame, before ``Stair.motion``: the climb goes along +x, the left of the climber is +y, up is +z. Tread k = 1..n
is the rectangle x from (k - 1) going to k going, y from 0 to width, at height k rise; the floor lies before it at 0.
"""

import hashlib
from dataclasses import dataclass, field

import numpy as np

from stair_inspector.model import Scan
from stair_inspector.params import EdgesParams, HorizontalParams, LevelsParams, NormalsParams, Params


@dataclass(frozen=True)
class Stair:
    """A straight flight; lengths in metres.

    ``spacing`` is the edge of the square cells of which each surface has one point: at their centres, or, with
    ``jitter``, anywhere inside, which keeps the surfaces uniformly covered and the points distinct. ``noise`` is the
    standard deviation of the error of each coordinate.
    """

    n_steps: int = 5
    rise: float = 0.17
    going: float = 0.28
    width: float = 1.0
    floor_depth: float = 0.8
    spacing: float = 0.02
    jitter: bool = True
    risers: bool = False
    noise: float = 0.0
    seed: int = 1
    motion: np.ndarray = field(default_factory=lambda: np.eye(4))

    def parts(self):
        """Exact points and unit normals of the floor, the treads and the risers, in the stair frame."""
        rng = np.random.default_rng(self.seed)
        parts = [self._flat(rng, -self.floor_depth, 0.0, 0.0)]
        parts += [self._flat(rng, (k - 1) * self.going, k * self.going, k * self.rise) for k in self.step_ids]
        if self.risers:
            parts += [self._upright(rng, k) for k in self.step_ids]
        return parts

    @property
    def step_ids(self):
        return range(1, self.n_steps + 1)

    def sample(self):
        """Points and exact normals of the moved scan, noise included; the floor first, then tread after tread."""
        points, normals = (np.concatenate(arrays) for arrays in zip(*self.parts(), strict=True))
        rng = np.random.default_rng(self.seed + 1000)
        points = points + rng.normal(0.0, self.noise, points.shape) if self.noise else points
        turn, shift = self.motion[:3, :3], self.motion[:3, 3]
        return points @ turn.T + shift, normals @ turn.T

    def scan(self, origin_m=(0.0, 0.0, 0.0)):
        """The scan, with the exact normals of the surfaces as those of the file."""
        return make_scan(*self.sample(), origin_m=origin_m)

    @property
    def up(self):
        """The up vector of the moved stair, as the setting takes it."""
        return ",".join(repr(float(component)) for component in self.motion[:3, 2])

    @property
    def points_per_tread(self):
        return round(self.going / self.spacing) * round(self.width / self.spacing)

    def _cells(self, rng, low, high):
        count = round((high - low) / self.spacing)
        centres = low + (np.arange(count) + 0.5) * (high - low) / count
        return centres, (high - low) / count

    def _grid(self, rng, u_range, v_range):
        (u, du), (v, dv) = self._cells(rng, *u_range), self._cells(rng, *v_range)
        plane = np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1).reshape(-1, 2)
        return plane + (rng.uniform(-0.5, 0.5, plane.shape) * (du, dv) if self.jitter else 0.0)

    def _flat(self, rng, x_low, x_high, z):
        plane = self._grid(rng, (x_low, x_high), (0.0, self.width))
        points = np.column_stack([plane, np.full(len(plane), z)])
        return points, np.tile([0.0, 0.0, 1.0], (len(points), 1))

    def _upright(self, rng, k):
        plane = self._grid(rng, ((k - 1) * self.rise, k * self.rise), (0.0, self.width))
        points = np.column_stack([np.full(len(plane), (k - 1) * self.going), plane[:, 1], plane[:, 0]])
        return points, np.tile([-1.0, 0.0, 0.0], (len(points), 1))


def make_scan(points, normals=None, origin_m=(0.0, 0.0, 0.0), name="synthetic.ply"):
    points = np.asarray(points, dtype=np.float64)
    return Scan(
        points=points,
        origin_m=np.array(origin_m),
        name=name,
        sha256=hashlib.sha256(points.tobytes()).hexdigest(),
        unit="m",
        n_points=len(points),
        normals=normals,
    )


def exact_params(**changes):
    """Settings that take the scan's own exact normals and a given up: nothing is estimated."""
    values = {"up": "z", "unit": "m", "normals": NormalsParams(source="given")}
    return Params(**(values | changes))


def rotation(axis, degrees):
    """Rotation about a coordinate axis, (3, 3)."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    turn = np.eye(3)
    turn[i, i], turn[i, j], turn[j, i], turn[j, j] = c, -s, s, c
    return turn


def motion(turn=None, shift=(0.0, 0.0, 0.0)):
    """Rigid motion as a (4, 4) matrix."""
    matrix = np.eye(4)
    matrix[:3, :3] = np.eye(3) if turn is None else turn
    matrix[:3, 3] = shift
    return matrix


def numbers_of(inspection):
    """Every number of the steps that does not depend on the place in the scan frame, (n_steps, 7); null is NaN."""
    rows = [
        (s.paper.h_m, s.paper.d_fb_m, s.paper.d_ff_m, s.paper.w_m, s.paper.theta_deg, s.plane.rms_m, s.plane.n_points)
        for s in inspection.steps
    ]
    return np.array(rows, dtype=np.float64).reshape(-1, 7)


CHANGES = {
    "normals.k": NormalsParams.k + 7,
    "normals.source": "given",
    "floor.distance_m": 0.02,
    "horizontal.theta_deg": HorizontalParams.theta_deg - 5.0,
    "levels.eps_m": LevelsParams.eps_m / 2.0,
    "levels.min_points": LevelsParams.min_points + 20,
    "axes.rule": "global",
    "columns": "x,y,z",
    "station": "Hall",
    "crop": "-9,-9,-9,9,9,9",
    "detail_m": 0.01,
    "stations": "as_read",
    "edges.front_percentile": EdgesParams.front_percentile - 5.0,
    "edges.back_percentile": EdgesParams.back_percentile + 5.0,
    "edges.side_percentile": EdgesParams.side_percentile - 9.0,
    "patches.cell_m": 0.03,
    "patches.min_area_m2": 0.05,
    "flights.min_rise_m": 0.08,
    "flights.max_rise_m": 0.25,
    "flights.max_gap_m": 0.1,
    "flights.turn_deg": 30.0,
    "flights.min_risers": 3,
    "survey.edge_source": "tread",
    "survey.line_percent": 20.0,
    "survey.band_m": 0.006,
    "uncertainty.registration_m": 0.002,
    "uncertainty.edge_m": 0.001,
    "uncertainty.side_m": 0.002,
    "uncertainty.slope_deg": 0.05,
    "uncertainty.up_deg": 0.1,
    "uncertainty.scale_percent": 0.2,
    "overrules.force": "level:2=rejected",
    "overrules.climb": "x",
    "overrules.region": "-10,-10,-10,10,10,10",
    "display.nearest_k": 7,
    "method": "paper",
    "up": "z",
    "unit": "mm",
}
"""Another allowed value for every setting."""
