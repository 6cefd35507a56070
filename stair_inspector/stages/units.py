"""Which unit is a file in? The one in which the stair that comes out is one; where none comes out, what its size says.

Treads and risers that come again have one shape in every unit, but a size that staircases have in one of them alone.
"""

import math
from dataclasses import dataclass

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.arrays import Floats
from stair_inspector.geometry.lattice import Lattice, find_lattices
from stair_inspector.geometry.normals import estimate_normals_at, morton_order
from stair_inspector.model import Note, Observation, Scan, Step
from stair_inspector.params import KNOWN_UNITS, KnownUnit
from stair_inspector.stages.density import find_spacing
from stair_inspector.stages.hopeless import fitting_units
from stair_inspector.stages.readings import LONGEST_PERIOD_M, SURE
from stair_inspector.stages.thinned import pick_thinned
from stair_inspector.units import METRES_PER_UNIT, UNIT_NAMES

READ_STAGE = "read"
GUESSED = "unit_guessed"
"""Code of the note that says that nobody stated the unit."""
UNSURE = "unit_unsure"
_SIZE_PERCENTILES = (2.0, 98.0)
_LARGEST_IN_METRES = 150.0
"""A larger number cannot be the size of a scanned staircase in metres."""
_LARGEST_IN_CENTIMETRES = 1500.0
_SMALLEST_PLAUSIBLE_M = 0.3
_FEWEST_POINTS = 500
_MOST_POINTS = 100_000
_NEIGHBOURS = 12
_SPARSEST_M = 0.1
"""Points that lie farther apart show neither treads nor risers."""
_FEWEST_FACES, _FEWEST_JOINTS = 2 * priors.SURE_RISERS, 5
"""A rhythm of so many treads and risers, with so many edges between them, is no furniture seen in a wrong size."""

# Weights are natural logarithms of odds.
_LEAST = -4.5
"""What weighs less is no staircase in this unit."""


@dataclass(frozen=True, slots=True)
class DecidedUnit:
    """The unit of a file, with the note that says how it came about where it was guessed, and what is asked or said."""

    unit: KnownUnit
    note: Note | None = None
    observations: tuple[Observation, ...] = ()


def decide_unit(points: Floats) -> DecidedUnit:
    """Decide in which unit coordinates are.

    Parameters
    ----------
    points : (n, 3), file unit
        Finite, at least one; up and place are of no matter.

    Returns
    -------
    DecidedUnit
        Metres, centimetres, millimetres, inches or feet by the rhythm of treads and risers; where none is found in any
        unit that the size allows, metres, centimetres or millimetres by the size. With a question where two units fit
        the rhythm about equally well, and with an info where it says another unit than the size.

    Notes
    -----
    The size is the diagonal of the box between the 2nd and 98th percentiles of each axis, so that stray points do not
    decide.
    """
    size = _size_of(points)
    by_size = _unit_of_size(size)
    if len(points) >= _FEWEST_POINTS:
        few = points[:: -(-len(points) // _MOST_POINTS)]
        few = few - np.median(few, axis=0)
        spacing = find_spacing(few) * math.sqrt(len(few) / len(points))
        for unit in fitting_units(size, by_size):
            if spacing * METRES_PER_UNIT[unit] <= _SPARSEST_M:
                found = _decide_by_rhythm(few, unit, size, by_size)
                if found is not None:
                    return found
    return DecidedUnit(by_size, _note_of_size(size, by_size))


def ask_unit(scan: Scan, steps: tuple[Step, ...]) -> tuple[Observation, ...]:
    """Return the question for the unit, where it was guessed and what was measured fits another one as well or better.

    Parameters
    ----------
    scan : Scan
        With the notes of reading it.
    steps : tuple of Step
        As they were measured in it.
    """
    is_asked = any(found.code == UNSURE for found in scan.observations)
    sizes = [(step.rise_m.value, step.going_m.value) for step in steps if step.rise_m and step.going_m]
    if is_asked or not sizes or all(note.code != GUESSED for note in scan.notes):
        return ()
    per = METRES_PER_UNIT[scan.unit]
    rise, going = (float(each) / per for each in np.median(sizes, axis=0))
    weights = {unit: _weigh(rise, going, unit) for unit in KNOWN_UNITS}
    least = max(_LEAST, weights[scan.unit] - SURE)
    if all(weight < least for unit, weight in weights.items() if unit != scan.unit):
        # However large the scan is, which takes long to tell.
        return ()
    units = fitting_units(_size_of(scan.points) / per, scan.unit)
    others = [unit for unit in units if unit != scan.unit]
    other = max(others, key=weights.__getitem__, default=scan.unit)
    if other == scan.unit or weights[other] < least:
        return ()
    first, second = sorted((scan.unit, other), key=lambda unit: -weights[unit])
    return (_question(rise, going, first, second),)


def _size_of(points: Floats) -> float:
    low, high = np.percentile(points, _SIZE_PERCENTILES, axis=0)
    return float(np.linalg.norm(high - low))


def _unit_of_size(size: float) -> KnownUnit:
    """Return the unit in which the size of a scan, in the file's unit, is that of a building: a metric one."""
    if size <= _LARGEST_IN_METRES:
        return "m"
    return "cm" if size < _LARGEST_IN_CENTIMETRES else "mm"


def _decide_by_rhythm(points: Floats, unit: KnownUnit, size: float, by_size: KnownUnit) -> DecidedUnit | None:
    """Return the unit by the rhythm that shows in points (n, 3) of the file if one unit is taken; None without one."""
    per = METRES_PER_UNIT[unit]
    lattice = _find_rhythm(points * per)
    if lattice is None:
        return None
    # Which of them are treads is not known yet, and does not change the size of both together.
    rise, going = sorted((lattice.rise_m / per, lattice.going_m / per))
    weights = {each: _weigh(rise, going, each) for each in fitting_units(size, by_size)}
    ranked = sorted(weights, key=lambda each: -weights[each])
    best = ranked[0]
    width = lattice.width_m / per
    if weights[best] < _LEAST or width * METRES_PER_UNIT[best] < priors.NARROWEST_OF_TWO_M:
        return None
    rivals = [each for each in ranked[1:] if weights[each] >= max(_LEAST, weights[best] - SURE)]
    if best != by_size and _are_tiers(rise, going, width, by_size):
        rivals = [by_size]
    if rivals:
        return DecidedUnit(best, _note_of_rhythm(best, rise, going), (_question(rise, going, best, rivals[0]),))
    if best == by_size:
        return DecidedUnit(best, _note_of_size(size, best))
    message = (
        f"the file is read in {UNIT_NAMES[best]}, in which its treads and risers come again after "
        f"{_lengths(rise, going, best)}; its size alone would say {UNIT_NAMES[by_size]}"
    )
    said = Observation("unit_by_stair", "info", message, cure=f"--unit {by_size}")
    return DecidedUnit(best, _note_of_rhythm(best, rise, going), (said,))


def _find_rhythm(points: Floats) -> Lattice | None:
    """Return the rhythm of treads and risers in points (n, 3), metres, where it is certain that it is one."""
    # Neighbours in space that are neighbours in memory are found in half the time.
    points = points[morton_order(points)]
    ids = pick_thinned(points)
    normals = estimate_normals_at(points, ids, _NEIGHBOURS)
    for lattice in find_lattices(points[ids], normals, (priors.LEAST_RISE_M, LONGEST_PERIOD_M)):
        n_faces = len(lattice.treads) + len(lattice.risers)
        if n_faces >= _FEWEST_FACES and lattice.joints >= _FEWEST_JOINTS:
            return lattice
    return None


def _weigh(rise: float, going: float, unit: KnownUnit) -> float:
    """Weigh a rise and a going, file unit, in one unit: what the stride on staircases is."""
    stride_m = (2.0 * rise + going) * METRES_PER_UNIT[unit]
    return -((math.log(stride_m / priors.USUAL_STRIDE_M) / priors.STRIDE_SPREAD) ** 2) / 2.0


def _are_tiers(rise: float, going: float, width: float, unit: KnownUnit) -> bool:
    """Return whether a rhythm, file unit, would be one of seats in a unit: stairs in feet are like them in metres."""
    rise_m, going_m, width_m = (length * METRES_PER_UNIT[unit] for length in (rise, going, width))
    is_deep = priors.LONGEST_TREAD_M <= going_m <= priors.DEEPEST_TIER_M
    return is_deep and rise_m <= priors.TALLEST_TIER_M and width_m >= priors.NARROWEST_TIERS_M


def _question(rise: float, going: float, first: KnownUnit, second: KnownUnit) -> Observation:
    sizes = [f"{UNIT_NAMES[unit]}, treads and risers of {_lengths(rise, going, unit)}" for unit in (first, second)]
    return Observation(
        UNSURE,
        "question",
        f"the file does not state its unit, and what comes again in it fits two: in {sizes[0]}; in {sizes[1]}",
        cure=f"--unit {first} or --unit {second}",
    )


def _lengths(rise: float, going: float, unit: KnownUnit) -> str:
    first, second = (1000.0 * METRES_PER_UNIT[unit] * length for length in (rise, going))
    return f"{first:.0f} and {second:.0f} mm"


def _note_of_size(size: float, unit: KnownUnit) -> Note:
    size_m = size * METRES_PER_UNIT[unit]
    message = f"unit guessed: {UNIT_NAMES[unit]}, which makes the scan {size_m:.3g} m in size"
    if size_m < _SMALLEST_PLAUSIBLE_M:
        message += ", too small for a staircase"
    elif size_m > _LARGEST_IN_METRES:
        message += ", too large for a staircase"
    return _note(message)


def _note_of_rhythm(unit: KnownUnit, rise: float, going: float) -> Note:
    lengths = _lengths(rise, going, unit)
    return _note(f"unit guessed: {UNIT_NAMES[unit]}, in which treads and risers come again after {lengths}")


def _note(message: str) -> Note:
    return Note(GUESSED, READ_STAGE, f"{message}; if that is wrong, state the unit with --unit")
