"""The result."""

from dataclasses import dataclass, field

from stair_inspector.geometry.arrays import Floats, Ints, Labels
from stair_inspector.geometry.fits import PlaneFit
from stair_inspector.model.heights import HeightProfile, Level, NormalsBy, Up
from stair_inspector.model.notes import Note, Observation
from stair_inspector.model.paper import Axes
from stair_inspector.model.scan import Moved
from stair_inspector.model.steps import Flight, Step
from stair_inspector.model.surfaces import Patch
from stair_inspector.params import Params


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
    less one, as the paper places them: local. ``examination`` is what was found about the scan before it was measured;
    ``moved`` says which points were laid onto the others before that. ``normals_by`` says who made the normals.
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
    moved: Moved | None = None
    normals_by: NormalsBy = "open3d"

    def places(self, points: Floats, rows: Ints) -> Floats:
        """Return where points (m, 3), which stand in these rows of the scan, lay when they were measured: local."""
        return points if self.moved is None else self.moved.places(points, rows)

    @property
    def questions(self) -> tuple[Observation, ...]:
        """What has to be answered before a value is given."""
        return tuple(found for found in self.examination if found.level == "question")

    @property
    def is_withheld(self) -> bool:
        """Whether the survey gives no value before its questions are answered; the paper's method always does."""
        return self.params.method == "survey" and bool(self.questions)
