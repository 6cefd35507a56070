"""Can any settings find a staircase in this scan? Too few points, too coarse coordinates, the wrong size."""

import functools
import math
from collections.abc import Callable, Sequence
from typing import Any, TypeVar, cast

import numpy as np

from stair_inspector import priors
from stair_inspector.errors import CannotMeasure
from stair_inspector.geometry.arrays import Floats
from stair_inspector.model import Observation, Scan
from stair_inspector.params import KNOWN_UNITS, FlightsParams, KnownUnit, Params
from stair_inspector.stages.density import find_spacing
from stair_inspector.stages.examine import POINTS_PER_TREAD, TREAD_M2, examine, size_text
from stair_inspector.stages.floor_planes import LEAST_POINTS
from stair_inspector.units import METRES_PER_UNIT, UNIT_NAMES

_Measure = TypeVar("_Measure", bound=Callable[..., Any])
_COARSE = 0.5
"""A step of the coordinates of half the smallest rise leaves nothing of a staircase."""
_FEW_POINTS = 500
_SAMPLE = 5_000


def is_too_coarse(examination: Sequence[Observation], flights: FlightsParams) -> bool:
    """Return whether the coordinates lie on so coarse a step that nothing of a staircase is left in them."""
    return _too_coarse(examination, flights) is not None


def with_cause(measure: _Measure) -> _Measure:
    """Let a function of a scan and settings tell the true cause where it fails and an examination knows one.

    Parameters
    ----------
    measure : callable
        Takes a scan and settings first; what else it takes passes through.
    """

    @functools.wraps(measure)
    def measured(scan: Scan, params: Params, *args: Any, **kwargs: Any) -> Any:
        try:
            return measure(scan, params, *args, **kwargs)
        except CannotMeasure as error:
            # Too few points to examine: the error says it already.
            is_known = len(scan.points) >= LEAST_POINTS
            hopeless = why_hopeless(scan, examine(scan).observations, params.flights) if is_known else None
            if hopeless is None:
                raise
            raise CannotMeasure(f"{scan.name}: {hopeless}") from error

    return cast(_Measure, measured)


def why_hopeless(scan: Scan, examination: Sequence[Observation], flights: FlightsParams) -> str | None:
    """Return why no settings can find a staircase in a scan, None where they may."""
    coarse = _too_coarse(examination, flights)
    if coarse is not None:
        return f"{coarse.message}, as coarse as a step of a staircase; {coarse.cure}"
    size_m = _size_of(scan.points)
    if not priors.SMALLEST_SCAN_M <= size_m <= priors.LARGEST_SCAN_M:
        in_file = size_m / METRES_PER_UNIT[scan.unit]
        proposal = "cut out the staircase"
        for unit in fitting_units(in_file)[:1]:
            size = size_text(in_file * METRES_PER_UNIT[unit])
            proposal = f"in {UNIT_NAMES[unit]} it is {size}: if so, give --unit {unit}"
        return f"the whole scan is {size_text(size_m)} across, read in {UNIT_NAMES[scan.unit]}; {proposal}"
    if len(scan.points) < _FEW_POINTS:
        spacing_m = find_spacing(scan.points)
        if spacing_m**2 * POINTS_PER_TREAD > TREAD_M2:
            return (
                f"only {len(scan.points):,} points, some {size_text(spacing_m)} apart: the corners of a mesh, as of a "
                "CAD model, or a scan that was thinned too far; of a mesh, export its faces too, of a scan, export all "
                "points"
            )
    return None


def fitting_units(size: float, first: KnownUnit | None = None) -> list[KnownUnit]:
    """Return the units in which the size of a scan, file unit, may be a staircase's: the first, then the most usual."""
    sizes = {unit: size * METRES_PER_UNIT[unit] for unit in KNOWN_UNITS}
    fitting = [unit for unit in KNOWN_UNITS if priors.SMALLEST_SCAN_M <= sizes[unit] <= priors.LARGEST_SCAN_M]
    return sorted(fitting, key=lambda unit: (unit != first, abs(math.log(sizes[unit] / priors.USUAL_SCAN_M))))


def _too_coarse(examination: Sequence[Observation], flights: FlightsParams) -> Observation | None:
    """Return what says that the coordinates lie on a step as coarse as half a riser, None where nothing does."""
    for found in examination:
        is_step = found.code in ("float32_far_from_zero", "coordinates_rounded", "points_on_lattice")
        if is_step and (found.size_m or 0.0) >= _COARSE * flights.min_rise_m:
            return found
    return None


def _size_of(points: Floats) -> float:
    """Return the length of the diagonal of a scan without its stray points, metres."""
    low, high = np.quantile(points[:: -(-len(points) // _SAMPLE)], [0.02, 0.98], axis=0)
    return float(np.linalg.norm(high - low))
