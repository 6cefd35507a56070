"""Every immutable value that passes between the rooms; no algorithm.

Arrays are float64, contiguous and read-only unless a line says otherwise. "Local" coordinates are metres in the
scan's own axes with ``Scan.origin_m`` subtracted; the scan frame has it added again.
"""

import math
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from stair_inspector.errors import DegenerateGeometry
from stair_inspector.geometry.arrays import Colors, Floats, Ints, Labels, own
from stair_inspector.geometry.edges import EdgeLine
from stair_inspector.geometry.fits import PlaneFit
from stair_inspector.params import Params

_FARTHEST_M = 10_000.0
"""How far from zero points may lie: normals come from squares of coordinates, in which float64 keeps 1e-8 m² there."""
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


IMPOSSIBLE, BLURRED = "step_impossible", "step_blurred"
NO_NOSING = (IMPOSSIBLE, BLURRED)
"""Codes of the notes on a step whose nosing gives no values: neither its own, nor the going up to it, nor the rise over
it. The first says that no staircase has what was found, the second that a camera saw it too badly."""


@dataclass(frozen=True, slots=True)
class Observation:
    """Something that was found about a scan before it was believed.

    ``level``: ``info`` changes nothing; ``doubt`` is in every ``u`` or concerns what may be wrong; a ``question`` has
    two answers that both fit, and the numbers hang on it, so no value and no verdict is given until it is answered.
    ``size_m`` is how large it is, metres, where that has a meaning. ``cure`` says what to do about it: a flag, as
    ``--unit in``, or a sentence.
    """

    code: str
    level: Literal["info", "doubt", "question"]
    message: str
    size_m: float | None = None
    cure: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Scan:
    """A point cloud in metres near zero.

    ``points`` (n, 3) local; ``origin_m`` (3,) what was subtracted, metres in the scan frame; ``colors`` (n, 3) uint8
    or None; ``normals`` (n, 3) unit vectors given by the file, or None; ``n_points`` how many the file held, before
    non-finite points and exact duplicates were dropped. Points of which most lie farther than 10 km from zero are
    refused (DegenerateGeometry): squares of their coordinates leave nothing of a surface. ``observations`` are what
    reading it already shows; ``repeats`` (n,) how often the file holds each point, None where every point is distinct.
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
    observations: tuple[Observation, ...] = ()
    repeats: Ints | None = None

    def __post_init__(self) -> None:
        n = len(self.points)
        object.__setattr__(self, "points", own(self.points, (None, 3), "points"))
        object.__setattr__(self, "origin_m", own(self.origin_m, (3,), "origin_m"))
        _check_nearness(self.points)
        if self.colors is not None:
            object.__setattr__(self, "colors", own(self.colors, (n, 3), "colors", np.uint8))
        if self.normals is not None:
            object.__setattr__(self, "normals", own(self.normals, (n, 3), "normals"))
        if self.repeats is not None:
            object.__setattr__(self, "repeats", own(self.repeats, (n,), "repeats", np.int64))


def _check_nearness(points: Floats) -> None:
    """Refuse points of which most lie far from zero; a thousandth of them shows it, strays do not count."""
    if not len(points):
        return
    places = np.median(points[:: max(1, len(points) // 1000)], axis=0)
    farthest = float(np.abs(places).max())
    if farthest > _FARTHEST_M:
        raise DegenerateGeometry(
            f"points: they lie about {farthest:,.0f} m from zero; subtract an origin and give it as origin_m"
        )


@dataclass(frozen=True, slots=True, eq=False)
class Examination:
    """What a scan is like before anything is measured in it.

    ``steps_m`` (3,) is the step of the coordinates on each axis of the scan, metres: as decimals, the scale of an
    integer format, a voxel lattice or float32 far from zero leave it; 0 where none shows. ``layers_m`` (k, 3) are the
    shifts of doubled surfaces against each other, scan axes, each along what faces one way. ``is_thinned`` says that
    the points fill a lattice of these steps, one in each cell; ``is_view`` that the scan was taken from its origin in
    one direction, as a camera's frame is.
    """

    observations: tuple[Observation, ...]
    steps_m: Floats
    layers_m: Floats = field(default_factory=lambda: np.zeros((0, 3)))
    is_thinned: bool = False
    is_view: bool = False


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
    observations: tuple[Observation, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class HeightOrder:
    """The points of a scan that lie in the region of interest, sorted by height; ``n_scan`` counts all of the scan.

    ``point_ids`` (n,) into the scan; ``alignment`` (n,) |normal . up|; ``coordinates_m`` (3, n) local coordinates
    along the rows of ``level_from_scan`` (3, 3), a rotation whose third row is up: two plan coordinates and the
    height, which ascends. One contiguous row for each coordinate, because every later stage works on ranges of them.
    ``plan_corner_m`` (2,) are the least plan coordinates of all level points, in the region or not.
    """

    point_ids: Ints
    alignment: Floats
    coordinates_m: Floats
    level_from_scan: Floats
    up: Up
    n_scan: int
    plan_corner_m: Floats | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Horizontal:
    """The points whose normal is upright, sorted by height; fields as in :class:`HeightOrder`."""

    point_ids: Ints
    coordinates_m: Floats
    level_from_scan: Floats
    up: Up
    n_scan: int
    plan_corner_m: Floats | None = None


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
class Surface:
    """A patch before it has a name: ``rows`` of :class:`Horizontal`, in the level frame.

    ``cells_m`` (2, c) mean plan coordinates of the points in each plan cell; ``centre_m`` (3,) and ``slope`` (2,) its
    robust plane, dz/dx and dz/dy; ``sigma_m`` the scatter of the cells' means about it; ``plane`` (step 8 of the paper
    for these points) in local scan axes; ``is_barred`` says that it is put together from bars with gaps; ``part_of`` is
    the number of the surface that holds these points too, where this one is a piece of a tread. ``bounds_m`` are the
    places across the climb, ``(-climb[1], climb[0]) @ plan``, beyond which another flight lies beside,
    and ``covered_m`` those between which a runner of carpet hides it, ``cover_m`` thick.
    """

    level_id: int
    rows: Ints
    cells_m: Floats
    area_m2: float
    height_m: float
    centre_m: Floats
    slope: Floats
    sigma_m: float
    plane: PlaneFit
    is_barred: bool = False
    part_of: int | None = None
    bounds_m: tuple[float, float] = (-math.inf, math.inf)
    covered_m: tuple[float, float] | None = None
    cover_m: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Patches:
    """All surfaces of a scan, by height cluster and height, and the side of the plan cells they were found with."""

    surfaces: tuple[Surface, ...]
    cell_m: float


@dataclass(frozen=True, slots=True, eq=False)
class Chain:
    """Surfaces that follow each other as one flight, by their numbers, bottom to top; level frame.

    ``base`` is the floor or landing it begins at, None where none was seen. For each of the ``steps``:
    ``climbs`` (s, 2) the direction of climb over its front edge, ``middles`` (s, 2) and ``lengths_m`` that edge as the
    patches show it, ``n_missing`` how many treads are missing below it.
    """

    base: int | None
    steps: tuple[int, ...]
    climbs: Floats
    middles: Floats
    lengths_m: tuple[float, ...]
    n_missing: tuple[int, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Chains:
    """All flights of a scan, from bottom to top, and notes on what else would have been possible.

    ``longest_risers`` counts the risers of the longest run of surfaces, whether or not it is a flight.
    """

    chains: tuple[Chain, ...]
    notes: tuple[Note, ...] = ()
    longest_risers: int = 0


NO_CHAINS = Chains(())
"""No flight at all."""


@dataclass(frozen=True, slots=True, eq=False)
class LocalPlane:
    """Height over a step's frame, ``z0_m + slope[0] * s + slope[1] * w``, with the covariance of the three numbers.

    ``covariance`` (3, 3) comes from the scatter of the means of blocks, so that noise which is the same over a whole
    block counts as it must; ``sigma_m`` is the noise of single points, ``spacing_m`` their distance, ``misfit_m`` how
    far the surface itself departs from the plane, beyond what noise explains; ``layers_m`` how far apart two layers of
    points lie that cover the same places, 0 where there is one.
    """

    z0_m: float
    slope: tuple[float, float]
    covariance: Floats
    sigma_m: float
    spacing_m: float
    misfit_m: float
    n_points: int
    layers_m: float = 0.0

    def at(self, s_m: float, w_m: float) -> float:
        """Return the height at a place of the step's frame, metres."""
        return self.z0_m + self.slope[0] * s_m + self.slope[1] * w_m

    def noise_at(self, s_m: float, w_m: float) -> float:
        """Return the standard uncertainty of :meth:`at`, metres."""
        place = np.array([1.0, s_m, w_m])
        return float(np.sqrt(max(0.0, place @ self.covariance @ place)))


@dataclass(frozen=True, slots=True, eq=False)
class Arc:
    """The middle line of a flight that curves: an arc about ``centre_m`` (2,), plan of the level frame, metres.

    ``sense`` is 1 where the flight turns to the left, -1 to the right. ``radius_noise_m`` is the standard uncertainty
    of the radius, ``middle_noise_m`` that of the place of the middle line between the sides.
    """

    centre_m: Floats
    radius_m: float
    sense: float
    radius_noise_m: float
    middle_noise_m: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class StepShape:
    """The plane and the edges of one step in its own frame, metres.

    The frame lies level at ``origin_m`` (2,) of the plan; ``s`` runs along ``climb`` (2,), ``w`` to its left. ``front``
    and ``back`` give s as a function of w, ``left`` and ``right`` w as a function of s. ``extent`` is (s_low, s_high,
    w_low, w_high) of what was seen of the surface. ``foot`` is the floor or landing in front of the lowest step.
    ``back_limits`` are the bounds of a back edge that is hidden. ``line_range`` is the range (w_right, w_left) at the
    nosing over which the measuring lines are laid: the step's own sides, or those of its flight where the step is a
    wide landing or a side of it is hidden. ``nosing_offsets`` and ``nosing_noise`` are the height of the surface at the
    nosing above its plane, and its standard uncertainty, on the left, centre and right line: a nosing strip stands
    proud, a worn tread is deepest in its middle. ``arc`` is
    that of the whole flight where it curves: then ``climb`` runs along it.
    """

    surface: int
    origin_m: Floats
    climb: Floats
    plane: LocalPlane
    extent: tuple[float, float, float, float]
    front: EdgeLine
    back: EdgeLine | None
    left: EdgeLine
    right: EdgeLine
    foot: LocalPlane | None
    back_limits: tuple[float, float] | None
    coverage: float
    line_range: tuple[float, float]
    nosing_offsets: tuple[float, float, float]
    nosing_noise: tuple[float, float, float]
    arc: Arc | None = None

    def to_plan(self, s_m: float, w_m: float) -> Floats:
        """Return a place of this frame in plan coordinates of the level frame, (2,)."""
        left = np.array([-self.climb[1], self.climb[0]])
        plan: Floats = self.origin_m + s_m * self.climb + w_m * left
        return plan

    def from_plan(self, plan: Floats) -> tuple[float, float]:
        """Return a place of the plan in this frame: s and w."""
        shift = plan - self.origin_m
        return float(shift @ self.climb), float(shift[1] * self.climb[0] - shift[0] * self.climb[1])


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
    """A value with its expanded uncertainty ``u`` (k = 2), both in the unit that the field's name ends in.

    ``parts`` names what the uncertainty is made of, each expanded (k = 2) as well; ``u`` is the root of the sum of
    their squares.
    """

    value: float
    u: float
    parts: tuple[tuple[str, float], ...] = ()


@dataclass(frozen=True, slots=True)
class PaperValues:
    """The paper's quantities of one step; None where the definition needs a step above and there is none.

    All are None for a step of the survey that lies in the lowest height cluster, which is the floor to the paper.
    """

    h_m: float | None = None
    d_fb_m: float | None = None
    d_ff_m: float | None = None
    w_m: float | None = None
    theta_deg: float | None = None
    f_m: float | None = None
    b_m: float | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Step:
    """One step: its plane, the paper's values, and what is drawn of it.

    ``corners`` (4, 3): front left, front right, back right, back left, left and right as seen when climbing;
    ``nearest_ids`` the K points nearest to the centroid. Local coordinates. ``paper`` are the paper's values of the
    height cluster in which the step lies. The fields from ``kind`` on belong to the survey measurement and keep their
    defaults where it has not been made.

    ``nosing`` (2, 3) is the left and the right end of the nosing line, ``line_points`` (3, 3) the points of the nosing
    on the left, centre and right measuring line, ``climb`` (3,) the horizontal unit vector square to the nosing,
    towards the next step; local coordinates. ``rise_lcr_m`` and ``going_lcr_m`` are rise and going on the three lines.
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
    rise_lcr_m: tuple[float | None, ...] | None = None
    going_lcr_m: tuple[float | None, ...] | None = None
    nosing: Floats | None = None
    line_points: Floats | None = None
    climb: Floats | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Patch:
    """One surface: the upright points of a height cluster that hang together in plan, and what it was taken for.

    ``level_id`` is the height cluster; ``height_m`` the mean height in the scan frame; ``area_m2`` that of the plan
    cells it occupies; ``plane`` in local coordinates. ``step_id`` names the step it became, ``reason`` says why it is
    none.
    """

    patch_id: int
    level_id: int
    height_m: float
    area_m2: float
    plane: PlaneFit
    kind: Literal["floor", "tread", "landing", "rejected"]
    step_id: int | None = None
    reason: str | None = None


@dataclass(frozen=True, slots=True)
class Statistics:
    """Statistics of a quantity over a flight, metres.

    ``max_adjacent`` is the largest difference between neighbours, ``at`` the two steps; None with a single value.
    """

    n: int
    mean: float
    min: float
    max: float
    range: float
    max_adjacent: float | None
    at: tuple[int, int] | None


@dataclass(frozen=True, slots=True, eq=False)
class Flight:
    """A run of steps between two landings.

    ``step_ids`` from bottom to top, the landing at its upper end included; ``n_risers`` counts the risers that were
    measured and those of missing treads. ``climb`` (3,) is the horizontal direction of climb at its foot, scan axes.
    ``radius_m`` is that of the middle line of a ``curved`` flight. ``goes_on`` says what is seen of the flight beyond
    what was measured, None where nothing is.
    """

    flight_id: int
    step_ids: tuple[int, ...]
    n_risers: int
    shape: Literal["straight", "curved", "winder", "spiral"]
    climb: Floats
    pitch_deg: Measured | None = None
    width_m: Measured | None = None
    rise: Statistics | None = None
    going: Statistics | None = None
    radius_m: Measured | None = None
    goes_on: str | None = None


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

    ``labels`` (n_used,): 0 floor, k step k, -1 neither. ``floor`` is the floor's plane (local), ``floor_h_m`` the
    paper's h from the floor to the first step. ``axes`` are those of the paper's values, None where there is no step.
    ``flights``, ``patches`` and ``patch_ids`` (n_used,), the patch of every point or -1, are the survey's and empty
    with the paper's method. ``paper_corners`` holds the corners (4, 3) of every level above the floor, by its number
    less one, as the paper places them: local. ``examination`` is what was found about the scan before it was measured.
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
    flights: tuple[Flight, ...] = ()
    patches: tuple[Patch, ...] = ()
    patch_ids: Ints | None = None
    examination: tuple[Observation, ...] = ()
    paper_corners: tuple[Floats, ...] = ()

    @property
    def questions(self) -> tuple[Observation, ...]:
        """What has to be answered before a value is given."""
        return tuple(found for found in self.examination if found.level == "question")

    @property
    def is_withheld(self) -> bool:
        """Whether the survey gives no value before its questions are answered; the paper's method always does."""
        return self.params.method == "survey" and bool(self.questions)
