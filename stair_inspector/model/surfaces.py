"""Surfaces, and the flights that they form."""

import math
from dataclasses import dataclass
from typing import Literal

from stair_inspector.geometry.arrays import Floats, Ints
from stair_inspector.geometry.fits import PlaneFit
from stair_inspector.model.notes import Note


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
    and ``covered_m`` those between which a runner of carpet hides it. ``cover_m`` is by how much the surface and its
    edges may be those of a strip that lies on it, and ``aside_m`` how much wider it may be than what is seen.
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
    aside_m: float = 0.0

    @property
    def spacing_m(self) -> float:
        """The mean distance of its points, metres."""
        return math.sqrt(self.area_m2 / len(self.rows))

    def height_at(self, plan: Floats) -> float:
        """Return the height of its plane at a place of the plan, (2,), metres."""
        return float(self.centre_m[2] + self.slope @ (plan - self.centre_m[:2]))


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
