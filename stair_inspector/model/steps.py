"""What is measured: values with their uncertainty, steps, flights."""

from dataclasses import dataclass
from typing import Literal

from stair_inspector.geometry.arrays import Floats, Ints
from stair_inspector.geometry.fits import PlaneFit
from stair_inspector.model.paper import PaperValues

COVERAGE_FACTOR = 2.0
"""k, by which a standard uncertainty is expanded: about 95 % for a value whose error is nearly normal."""


@dataclass(frozen=True, slots=True)
class Measured:
    """A value with its expanded uncertainty ``u`` (k = 2), both in the unit that the field's name ends in.

    ``parts`` names what the uncertainty is made of, each expanded (k = 2) as well; ``u`` is the root of the sum of
    their squares.
    """

    value: float
    u: float
    parts: tuple[tuple[str, float], ...] = ()


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
