"""Points by height: normals, up, the order by height, the level points and their height clusters."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from stair_inspector.geometry.arrays import Floats, Ints, Labels
from stair_inspector.model.notes import Note, Observation

NormalsBy = Literal["open3d", "numpy", "file"]
"""Who made the normals: Open3D, numpy and SciPy where it cannot be loaded, or whoever wrote the file."""
FLOOR_LABEL = 0
"""Label of a point of the floor; steps are 1, 2, ... from bottom to top."""


NON_STAIR_LABEL = -1
"""Label of a point that belongs to no level."""


@dataclass(frozen=True, slots=True, eq=False)
class Normals:
    """Unit normals ``vectors`` (n, 3) of a scan's points, scan axes; sign free, but where stations are known.

    ``by`` says who made them, ``notes`` what is to be known of that.
    """

    vectors: Floats
    by: NormalsBy = "file"
    notes: tuple[Note, ...] = ()


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
    ``plan_corner_m`` (2,) are the least plan coordinates of all level points, in the region or not. ``whole`` is the
    same of all points where a region leaves some out.
    """

    point_ids: Ints
    alignment: Floats
    coordinates_m: Floats
    level_from_scan: Floats
    up: Up
    n_scan: int
    plan_corner_m: Floats | None = None
    whole: "HeightOrder | None" = None

    def between(self, low_m: float, high_m: float) -> slice:
        """Return the rows of the points from one height up to another, metres."""
        start, stop = np.searchsorted(self.coordinates_m[2], [low_m, high_m])
        return slice(int(start), int(stop))


@dataclass(frozen=True, slots=True, eq=False)
class Horizontal:
    """The points whose normal is upright, sorted by height; fields as in :class:`HeightOrder`."""

    point_ids: Ints
    coordinates_m: Floats
    level_from_scan: Floats
    up: Up
    n_scan: int
    plan_corner_m: Floats | None = None
    whole: "Horizontal | None" = None


@dataclass(frozen=True, slots=True, eq=False)
class Levels:
    """Height clusters: cluster j holds the horizontal points ``start[j]:stop[j]`` of the height order.

    ``labels`` (n_scan,) is 0 for the lowest cluster (the floor), 1, 2, ... upwards, -1 elsewhere.
    """

    start: Ints
    stop: Ints
    labels: Labels


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
