"""What the paper's method makes on its way: axes, extents, edges, values."""

from dataclasses import dataclass
from typing import Literal

from stair_inspector.geometry.arrays import Floats, Ints
from stair_inspector.model.notes import Note


@dataclass(frozen=True, slots=True, eq=False)
class Axes:
    """Horizontal unit vectors in scan axes: ``depth`` points to the front (the nosings), ``width = up x climb``."""

    width: Floats
    depth: Floats
    rule: Literal["global", "per_step", "rise", "given"]
    notes: tuple[Note, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Extents:
    """Depth and width coordinates of every level's points, in their order, local metres along the axes."""

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
