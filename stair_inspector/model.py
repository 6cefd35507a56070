"""Every immutable value that passes between the rooms; no algorithm.

Arrays are float64, contiguous and read-only unless a line says otherwise. "Local" coordinates are metres in the
scan's own axes with ``Scan.origin_m`` subtracted; the scan frame has it added again.
"""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from stair_inspector.geometry.arrays import Colors, Floats, Ints, Labels, own
from stair_inspector.geometry.fits import PlaneFit
from stair_inspector.params import Params

FLOOR_LABEL = 0
"""Label of a point of the floor; steps are 1, 2, ... from bottom to top."""
NON_STAIR_LABEL = -1
"""Label of a point that belongs to no level."""


@dataclass(frozen=True, slots=True)
class Note:
    """Something the user should know about a result: a stable code, the stage, the step it concerns, a sentence."""

    code: str
    stage: str
    message: str
    step: int | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Scan:
    """A point cloud in metres near zero.

    ``points`` (n, 3) local; ``origin_m`` (3,) what was subtracted, metres in the scan frame; ``colors`` (n, 3) uint8
    or None; ``normals`` (n, 3) unit vectors given by the file, or None; ``n_points`` how many the file held, before
    non-finite points and exact duplicates were dropped.
    """

    points: Floats
    origin_m: Floats
    name: str
    sha256: str
    unit: Literal["m", "cm", "mm", "in", "ft"]
    n_points: int
    colors: Colors | None = None
    normals: Floats | None = None
    notes: tuple[Note, ...] = ()

    def __post_init__(self) -> None:
        n = len(self.points)
        object.__setattr__(self, "points", own(self.points, (None, 3), "points"))
        object.__setattr__(self, "origin_m", own(self.origin_m, (3,), "origin_m"))
        if self.colors is not None:
            object.__setattr__(self, "colors", own(self.colors, (n, 3), "colors", np.uint8))
        if self.normals is not None:
            object.__setattr__(self, "normals", own(self.normals, (n, 3), "normals"))


@dataclass(frozen=True, slots=True, eq=False)
class Normals:
    """Unit normals ``vectors`` (n, 3) of a scan's points, scan axes, sign free."""

    vectors: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Up:
    """The up direction: unit ``vector`` (3,) in scan axes, where it came from, its uncertainty in degrees if known."""

    vector: Floats
    source: Literal["given", "floor", "treads"]
    u_deg: float | None = None
    notes: tuple[Note, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class HeightOrder:
    """All points of a scan, sorted by height.

    ``point_ids`` (n,) into the scan; ``alignment`` (n,) |normal . up|; ``coordinates_m`` (3, n) local coordinates
    along the rows of ``level_from_scan`` (3, 3), a rotation whose third row is up: two plan coordinates and the
    height, which ascends. One contiguous row for each coordinate, because every later stage works on ranges of them.
    """

    point_ids: Ints
    alignment: Floats
    coordinates_m: Floats
    level_from_scan: Floats
    up: Up


@dataclass(frozen=True, slots=True, eq=False)
class Horizontal:
    """The points whose normal is upright, sorted by height; fields as in :class:`HeightOrder`."""

    point_ids: Ints
    coordinates_m: Floats
    level_from_scan: Floats
    up: Up
    n_scan: int


@dataclass(frozen=True, slots=True, eq=False)
class Levels:
    """Height clusters: cluster j holds the horizontal points ``start[j]:stop[j]`` of the height order.

    ``labels`` (n_scan,) is 0 for the lowest cluster (the floor), 1, 2, ... upwards, -1 elsewhere.
    """

    start: Ints
    stop: Ints
    labels: Labels


@dataclass(frozen=True, slots=True, eq=False)
class Surfaces:
    """The fitted plane of every level, the floor first: local coordinates, normals upwards.

    ``plan_scatter`` holds for each level the (2, 2) sums of squares and products of the centred plan coordinates, m2.
    """

    planes: tuple[PlaneFit, ...]
    plan_scatter: tuple[Floats, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Axes:
    """Horizontal unit vectors in scan axes: ``depth`` points to the front (the nosings), ``width = up x climb``."""

    width: Floats
    depth: Floats
    rule: Literal["global", "per_step", "rise", "given"]
    notes: tuple[Note, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Extents:
    """Depth and width coordinates of every level's points, each sorted ascending, local metres along the axes."""

    depth_m: tuple[Floats, ...]
    width_m: tuple[Floats, ...]


@dataclass(frozen=True, slots=True)
class Edges:
    """Edge coordinates of every step along the axes, metres, local: front > back, high_w > low_w.

    The width axis points to the left of someone who climbs, so ``high_w`` is the left edge.
    """

    front: tuple[float, ...]
    back: tuple[float, ...]
    high_w: tuple[float, ...]
    low_w: tuple[float, ...]


@dataclass(frozen=True, slots=True, eq=False)
class NearestPoints:
    """Ids into the scan of the points nearest to each step's centroid, nearest first."""

    ids: tuple[Ints, ...]


@dataclass(frozen=True, slots=True)
class Measured:
    """A value with its expanded uncertainty ``u`` (k = 2), both in the unit that the field's name ends in."""

    value: float
    u: float


@dataclass(frozen=True, slots=True)
class PaperValues:
    """The paper's quantities of one step; None where the definition needs a step above and there is none."""

    h_m: float | None
    d_fb_m: float
    d_ff_m: float | None
    w_m: float
    theta_deg: float | None
    f_m: float
    b_m: float


@dataclass(frozen=True, slots=True, eq=False)
class Step:
    """One step: its plane, the paper's values, and what is drawn of it.

    ``corners`` (4, 3): front left, front right, back right, back left, left and right as seen when climbing;
    ``nearest_ids`` the K points nearest to the centroid. Local coordinates. The fields from ``rise_m`` on belong to
    the survey measurement and are None where it has not been made.
    """

    step_id: int
    plane: PlaneFit
    corners: Floats
    nearest_ids: Ints
    paper: PaperValues
    kind: Literal["tread", "landing"] = "tread"
    flight: int | None = None
    rise_m: Measured | None = None
    going_m: Measured | None = None
    tread_depth_m: Measured | None = None
    width_m: Measured | None = None
    nosing_overhang_m: Measured | None = None
    pitch_deg: Measured | None = None
    fall_deg: Measured | None = None
    cross_fall_deg: Measured | None = None
    coverage: float | None = None


@dataclass(frozen=True, slots=True)
class Level:
    """One height cluster and what it was taken for.

    ``height_m`` is its mean height, ``low_m`` and ``high_m`` the heights of its lowest and highest point, all in the
    scan frame.
    """

    level_id: int
    height_m: float
    low_m: float
    high_m: float
    n_points: int
    kind: Literal["floor", "tread", "landing", "rejected"]
    reason: str | None = None


@dataclass(frozen=True, slots=True, eq=False)
class HeightProfile:
    """How many upright points lie at which height: ``counts`` (b,) in bins of ``bin_m`` from ``low_m``, scan frame."""

    low_m: float
    bin_m: float
    counts: Ints


@dataclass(frozen=True, slots=True)
class ScanSummary:
    """What an inspection remembers of its scan."""

    name: str
    sha256: str
    n_points: int
    n_used: int
    unit: str
    origin_m: tuple[float, float, float]


@dataclass(frozen=True, slots=True, eq=False)
class Inspection:
    """The result, with the settings that made it.

    ``labels`` (n_used,): 0 floor, k step k, -1 no level. ``floor`` is the floor's plane (local), ``floor_h_m`` the
    paper's h from the floor to the first step. ``axes`` is None where there is no step.
    """

    scan: ScanSummary
    params: Params
    up: Up
    axes: Axes | None
    levels: tuple[Level, ...]
    steps: tuple[Step, ...]
    floor: PlaneFit | None
    floor_h_m: float | None
    profile: HeightProfile
    labels: Labels
    notes: tuple[Note, ...] = ()
    timings_s: dict[str, float] = field(default_factory=dict)
