"""What is this scan like, before anything is measured in it?"""

import numpy as np

from stair_inspector.geometry.arrays import Floats
from stair_inspector.model import Examination, Observation, Scan
from stair_inspector.params import METRES_PER_UNIT
from stair_inspector.stages.coordinate_steps import CoordinateSteps, find_steps

_LEAST_SAID_M = 0.0004
"""A smaller step adds less than 0.3 mm (k = 2) to a height and lies below the noise of every scanner of buildings."""
_CURES = {
    "coordinates_rounded": (
        "export once more with full precision: LAS or LAZ with a scale of 0.0001 m, E57 or PLY in double precision, "
        "text with five decimals of a metre"
    ),
    "points_on_lattice": (
        "export the cloud as it was before it was thinned to voxels or laid on a grid; if it must be thinned, choose a "
        "way that keeps measured points or the mean of each voxel"
    ),
    "float32_far_from_zero": (
        "export in double precision, or with a shift that brings the coordinates near zero, as the global shift of "
        "CloudCompare or a project point of the scanner's program"
    ),
}


def examine(scan: Scan) -> Examination:
    """Examine a scan before it is measured.

    Parameters
    ----------
    scan : Scan
        In metres near zero.

    Returns
    -------
    Examination
        Observations, those of the reader first; the step of the coordinates on each axis. Without observations where
        nothing is the matter.
    """
    steps = find_steps(scan)
    return Examination((*scan.observations, *_observe_steps(scan, steps)), steps.steps_m)


def size_text(size_m: float) -> str:
    """Return a length as sentences name it.

    Examples
    --------
    >>> size_text(0.012), size_text(0.5), size_text(0.03125)
    ('12 mm', '0.5 m', '31.2 mm')
    """
    return f"{size_m:.3g} m" if size_m >= 0.1 else f"{size_m * 1000.0:.3g} mm"


def _observe_steps(scan: Scan, steps: CoordinateSteps) -> list[Observation]:
    """Say on which step the coordinates lie, where that matters."""
    largest = int(np.argmax(steps.steps_m))
    largest_m = float(steps.steps_m[largest])
    if largest_m < _LEAST_SAID_M:
        return []
    size = _sizes(scan, steps.steps_m)
    share = float(steps.shares[largest])
    whose = "the coordinates" if share > 0.9 else f"the coordinates of {share:.0%} of the points"
    if steps.kinds[largest] == "float32":
        code = "float32_far_from_zero"
        message = f"{whose} resolve only {size}: they are float32 numbers, too far from zero for more"
    elif steps.kinds[largest] == "rounded":
        code, message = "coordinates_rounded", f"{whose} are rounded to {size}"
    else:
        code = "points_on_lattice"
        turned = ", turned against the axes" if steps.is_turned else ""
        message = f"{whose} lie on a lattice of {size}{turned}, as of voxels or a grid"
    return [Observation(code, "doubt", message, largest_m, _CURES[code])]


def _sizes(scan: Scan, steps_m: Floats) -> str:
    """Return the steps that are worth a word, once where they are the same on all axes."""
    said = steps_m[steps_m >= _LEAST_SAID_M]
    if len(said) == 3 and np.allclose(said, said[0], rtol=1e-3):
        in_unit = float(said[0]) / METRES_PER_UNIT[scan.unit]
        return size_text(float(said[0])) + ("" if scan.unit in ("m", "cm", "mm") else f" ({in_unit:.3g} {scan.unit})")
    named = zip("xyz", steps_m, strict=True)
    return ", ".join(f"{size_text(float(step_m))} in {axis}" for axis, step_m in named if step_m >= _LEAST_SAID_M)
