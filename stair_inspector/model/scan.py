"""A point cloud, and what is known of it before anything is measured."""

from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from stair_inspector.errors import DegenerateGeometry
from stair_inspector.geometry.arrays import Bools, Colors, Floats, Ints, Labels, freeze, own
from stair_inspector.geometry.sight import Sight
from stair_inspector.model.notes import Note, Observation

_FARTHEST_M = 10_000.0
"""How far from zero points may lie: normals come from squares of coordinates, in which float64 keeps 1e-8 m² there."""


@dataclass(frozen=True, slots=True, eq=False)
class ScanStations:
    """From where a scan was taken: ``names`` (k) of all stations of its file, in the file's order.

    ``of_point`` (n,) is the number of the station, from 0 on, that saw each point of the scan; ``places_m`` (k, 3)
    local where each stood, NaN where the file does not say.
    """

    names: tuple[str, ...]
    of_point: Labels
    places_m: Floats

    def __post_init__(self) -> None:
        k = len(self.names)
        of_point = own(self.of_point, (None,), "of_point", np.int16)
        if len(of_point) and not 0 <= int(of_point.min()) <= int(of_point.max()) < k:
            raise DegenerateGeometry(f"of_point: names stations beyond the {k} that there are")
        object.__setattr__(self, "of_point", of_point)
        places_m = np.array(self.places_m, dtype=np.float64)
        if places_m.shape != (k, 3):
            raise DegenerateGeometry(f"places_m: expected shape {(k, 3)}, got {places_m.shape}")
        object.__setattr__(self, "places_m", freeze(places_m))

    def of(self, rows: Ints | Bools) -> "ScanStations":
        """Return the same of some of the points."""
        return replace(self, of_point=self.of_point[rows])

    @property
    def seen(self) -> Ints:
        """The numbers of the stations that saw any of the points, in order."""
        return np.flatnonzero(np.bincount(self.of_point, minlength=len(self.names)))


@dataclass(frozen=True, slots=True, eq=False)
class ReadPart:
    """The part of a file that was read: ``box_m`` (2, 3), lowest and highest corner, metres in the scan frame.

    ``beyond_m`` (k, 3) local are the points of the file that lie just outside the box: what they go on with, it cuts.
    """

    box_m: Floats
    beyond_m: Floats

    def __post_init__(self) -> None:
        object.__setattr__(self, "box_m", own(self.box_m, (2, 3), "box_m"))
        object.__setattr__(self, "beyond_m", own(self.beyond_m, (None, 3), "beyond_m"))


@dataclass(frozen=True, slots=True, eq=False)
class Scan:
    """A point cloud in metres near zero.

    ``points`` (n, 3) local; ``origin_m`` (3,) what was subtracted, metres in the scan frame; ``colors`` (n, 3) uint8
    or None; ``normals`` (n, 3) unit vectors given by the file, or None; ``n_points`` how many the file held, before
    non-finite points and exact duplicates were dropped. Points of which most lie farther than 10 km from zero are
    refused (DegenerateGeometry): squares of their coordinates leave nothing of a surface. ``observations`` are what
    reading it already shows; ``repeats`` (n,) how often the file holds each point, None where every point is distinct;
    ``is_outward`` (n,) where a normal is known to point out of a solid, as on the closed parts of a mesh: with it, any
    two opposite faces of one thing have opposite normals. None of a scan. ``stated_steps_m`` (3,) on which the
    coordinates lie by the word of the file, as of LAS its scale; None where it says nothing. ``facet_m`` is the
    length of the edges of a mesh whose faces are measured ones, as a phone's; None of a scan and of a drawn model.
    ``stations`` tell which saw each point, where the file does. ``part`` is what was read of the file, None for all.
    ``intensities`` (n,) are how strongly each point reflected, as the file has it, NaN where it has none, or None.
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
    is_outward: Bools | None = None
    stated_steps_m: Floats | None = None
    facet_m: float | None = None
    stations: ScanStations | None = None
    part: ReadPart | None = None
    intensities: Floats | None = None

    def __post_init__(self) -> None:
        n = len(self.points)
        object.__setattr__(self, "points", own(self.points, (None, 3), "points"))
        object.__setattr__(self, "origin_m", own(self.origin_m, (3,), "origin_m"))
        _check_nearness(self.points)
        if self.colors is not None:
            object.__setattr__(self, "colors", own(self.colors, (n, 3), "colors", np.uint8))
        if self.normals is not None:
            object.__setattr__(self, "normals", own(self.normals, (n, 3), "normals"))
        if self.intensities is not None:
            intensities = np.array(self.intensities, dtype=np.float64)
            if intensities.shape != (n,):
                raise DegenerateGeometry(f"intensities: expected shape {(n,)}, got {intensities.shape}")
            object.__setattr__(self, "intensities", freeze(intensities))
        if self.stated_steps_m is not None:
            object.__setattr__(self, "stated_steps_m", own(self.stated_steps_m, (3,), "stated_steps_m"))
        if self.is_outward is not None:
            object.__setattr__(self, "is_outward", own(self.is_outward, (n,), "is_outward", np.bool_))
        if self.repeats is not None:
            object.__setattr__(self, "repeats", own(self.repeats, (n,), "repeats", np.int64))
        if self.stations is not None and len(self.stations.of_point) != n:
            raise DegenerateGeometry(f"stations: of {len(self.stations.of_point)} points, the scan has {n}")


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
class Moved:
    """Points that were laid onto the others before they were measured.

    ``of_point`` (n,) is the number of the motion that each of the scan's points made, 0 of those that stayed; ``turns``
    (m, 3, 3) and ``shifts_m`` (m, 3) local: such a point came to lie at ``turn @ point + shift``. ``unheld_m`` (k, 3)
    are shifts that may be left, along directions in which no surface shows them.
    """

    of_point: Labels
    turns: Floats
    shifts_m: Floats
    unheld_m: Floats

    @property
    def is_moved(self) -> Bools:
        """Whether each point (n,) was moved."""
        moved: Bools = self.of_point > 0
        return moved

    def places(self, points: Floats, rows: Ints) -> Floats:
        """Return where points (m, 3), which stand in these rows of the scan, were measured."""
        places = np.array(points, dtype=np.float64)
        numbers = self.of_point[rows]
        for number in range(1, len(self.shifts_m)):
            own = numbers == number
            places[own] = places[own] @ self.turns[number].T + self.shifts_m[number]
        return places


@dataclass(frozen=True, slots=True, eq=False)
class Examination:
    """What a scan is like before anything is measured in it.

    ``steps_m`` (3,) is the step of the coordinates on each axis of the scan, metres: as decimals, the scale of an
    integer format, a voxel lattice or float32 far from zero leave it; 0 where none shows. ``layers_m`` (k, 3) are the
    shifts of doubled surfaces against each other, scan axes, each along what faces one way. ``is_thinned`` says that
    the points fill a lattice of these steps, one in each cell; ``is_view`` that the scan was taken from its origin in
    one direction, as a camera's frame is; ``hints_m`` (h, 3) are such shifts of which surfaces
    alone tell too little; ``moved`` says which points were laid onto the others; ``facet_m`` is the scan's;
    ``is_by_order`` says that no two layers show, but that means change in the order of the points; ``sight`` is what
    stations saw, scan axes, None where they are not known.
    """

    observations: tuple[Observation, ...]
    steps_m: Floats
    layers_m: Floats = field(default_factory=lambda: np.zeros((0, 3)))
    is_thinned: bool = False
    is_view: bool = False
    hints_m: Floats = field(default_factory=lambda: np.zeros((0, 3)))
    moved: Moved | None = None
    facet_m: float | None = None
    is_by_order: bool = False
    sight: Sight | None = None
