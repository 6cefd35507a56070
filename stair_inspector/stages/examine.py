"""What is this scan like, before anything is measured in it?"""

import math
from dataclasses import replace

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.arrays import Floats
from stair_inspector.geometry.solids import is_front
from stair_inspector.model import Examination, Observation, Scan
from stair_inspector.stages.camera_frames import is_view
from stair_inspector.stages.coordinate_steps import CoordinateSteps, find_steps
from stair_inspector.stages.copies import find_mirrored_copy, find_shifted_copy
from stair_inspector.stages.density import find_spacing
from stair_inspector.stages.layers import LEAST_STEPS, SAME_WAY, DoubledWay, find_ways, is_stated
from stair_inspector.stated_uncertainty import UncertaintyParams
from stair_inspector.units import METRES_PER_UNIT

_LEAST_SAID_M = 0.0004
"""A smaller step adds less than 0.3 mm (k = 2) to a height and lies below the noise of every scanner of buildings."""
_FEWEST = 500
"""Of fewer points nothing more can be said."""
_MOST_FOR_VIEW = 30_000
_FINE = 0.2
POINTS_PER_TREAD = 100
"""So many are enough to measure a tread."""
TREAD_M2 = priors.USUAL_GOING_M * priors.USUAL_WIDTH_M
"""A usual tread, by which the density of a scan is judged."""
CURES = {
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
    "surfaces_doubled": (
        "register the stations once more, cloud to cloud against floor and walls, or measure each station by itself; "
        "with a handheld or mobile scanner, close the loop and let its program adjust the path again"
    ),
    "cloud_copied": "take the copy out of the project, so that each station is exported once",
    "cloud_mirrored": "take the mirrored copy out of the project; check that the axes were exported right-handed",
    "mesh_scanned": "export the points of the scan, or a mesh in the finest resolution that its program offers",
    "points_sparse": "scan the stairs from nearer or with a finer resolution, or export without thinning",
}

_TORN_M = 0.015
"""Surfaces that are double by so much are two height clusters, and steps would be counted twice."""
_HIDES_LAYERS_M = 0.003
"""On a coarser step stations may lie farther apart than matters, and nothing shows it."""
_NEAR_COPY_M = 0.4
"""A copy that lies farther off is another stair; a nearer one doubles every surface, as stations do."""
_FILLED = 1.5
"""Spacing of points that fill a lattice, in its steps."""


def examine(scan: Scan) -> Examination:
    """Examine a scan before it is measured.

    Parameters
    ----------
    scan : Scan
        In metres near zero.

    Returns
    -------
    Examination
        Observations, those of the reader first; the step of the coordinates on each axis; the distance of doubled
        surfaces; whether it is a camera's frame. Without observations where nothing is the matter.
    """
    steps = find_steps(scan)
    found = [*scan.observations, *_observe_steps(scan, steps)]
    if scan.facet_m is not None:
        found.append(_observe_facets(scan.facet_m))
    if len(scan.points) < _FEWEST:
        return Examination(tuple(found), steps.steps_m, facet_m=scan.facet_m)
    found_ways = _find_ways(scan, steps.steps_m)
    doubled = tuple(way for way in found_ways if way.is_sure)
    # Rounded coordinates and lattices repeat every difference.
    shift = None if steps.steps_m.any() else find_shifted_copy(scan.points)
    if shift is not None:
        found.append(_observe_copy(shift))
    elif doubled:
        found.append(_observe_doubled(doubled))
    spacing_m = find_spacing(scan.points)
    # On a coarse step, points that have nothing to do with each other are mirror images by chance.
    axis = find_mirrored_copy(scan) if steps.steps_m.max() < _FINE * spacing_m else None
    if axis is not None:
        message = f"the cloud also holds a mirror image of itself across {'xyz'[axis]} = 0"
        found.append(Observation("cloud_mirrored", "doubt", message, None, CURES["cloud_mirrored"]))
    if TREAD_M2 / spacing_m**2 < POINTS_PER_TREAD:
        found.append(_observe_sparse(spacing_m, round(TREAD_M2 / spacing_m**2)))
    # One point in each cell: no two are alike, and none is farther from the next than a cell or its diagonal.
    is_thinned = scan.repeats is None and bool(steps.steps_m.all()) and spacing_m < _FILLED * float(steps.steps_m.max())
    if shift is None:
        ways = [way.apart_m * way.normal for way in doubled]
    else:
        ways = [shift] if float(np.linalg.norm(shift)) <= _NEAR_COPY_M else []
    layers_m = np.array(ways).reshape(-1, 3)
    few = scan.points[:: -(-len(scan.points) // _MOST_FOR_VIEW)]
    # Where surfaces are surely double along one direction, what may be so along another says nothing new.
    hints_m = np.array([way.apart_m * way.normal for way in found_ways if shift is None and not doubled]).reshape(-1, 3)
    return Examination(
        tuple(found), steps.steps_m, layers_m, is_thinned, is_view(scan, few), hints_m=hints_m, facet_m=scan.facet_m
    )


def _find_ways(scan: Scan, steps_m: Floats) -> tuple[DoubledWay, ...]:
    """Return how surfaces are double; two faces of a board are not, where it is known how each faces or was seen."""
    if scan.is_outward is None or scan.normals is None:
        return find_ways(scan.points, steps_m, scan.stations)
    front = is_front(scan.normals)
    found: list[DoubledWay] = []
    for of_side in (front, ~front):
        ways = find_ways(scan.points[of_side], steps_m) if of_side.any() else ()
        found += [way for way in ways if all(abs(float(way.normal @ each.normal)) <= SAME_WAY for each in found)]
    return tuple(found)


def with_questions(observations: tuple[Observation, ...], stated: UncertaintyParams) -> tuple[Observation, ...]:
    """Ask where doubled surfaces lie so far apart that each tread is two: which of them is right, no scan tells.

    Parameters
    ----------
    observations : tuple of Observation
        Of a scan.
    stated : UncertaintyParams
        A registration that allows for half of what lies between the two answers the question: both may be wrong by it.
        What the order of the points alone shows is left to a registration of a sixth of it.
    """
    left = (each for each in observations if not (each.code == "doubled_by_order" and _is_stated(each, stated)))
    return tuple(
        replace(found, level="question", cure=f"{_answer_to(found.size_m)}, or: {found.cure}")
        if found.code in ("surfaces_doubled", "doubled_by_order", "cloud_copied", "stations_disagree")
        and found.size_m is not None
        and _TORN_M <= found.size_m <= _NEAR_COPY_M
        and stated.registration_m < _answering_m(found.size_m)
        else found
        for found in left
    )


def _is_stated(found: Observation, stated: UncertaintyParams) -> bool:
    return found.size_m is not None and is_stated(found.size_m, stated.registration_m)


def _answering_m(apart_m: float) -> float:
    """Return the standard uncertainty of registration that allows for surfaces so far apart, on whole 0.1 mm."""
    return math.ceil(5000.0 * apart_m) / 10000.0


def _answer_to(apart_m: float) -> str:
    return f"--uncertainty.registration-m {_answering_m(apart_m):g}"


def size_text(size_m: float) -> str:
    """Return a length as sentences name it.

    Examples
    --------
    >>> size_text(0.012), size_text(0.5), size_text(0.03125)
    ('12 mm', '0.5 m', '31.2 mm')
    """
    if size_m >= 1000.0:
        return f"{size_m:,.0f} m"
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
    if largest_m >= _HIDES_LAYERS_M:
        message += f"; stations less than {size_text(LEAST_STEPS * largest_m)} apart cannot be told in it"
    return [Observation(code, "doubt", message, largest_m, CURES[code])]


def _sizes(scan: Scan, steps_m: Floats) -> str:
    """Return the steps that are worth a word, once where they are the same on all axes."""
    said = steps_m[steps_m >= _LEAST_SAID_M]
    if len(said) == 3 and np.allclose(said, said[0], rtol=1e-3):
        in_unit = float(said[0]) / METRES_PER_UNIT[scan.unit]
        return size_text(float(said[0])) + ("" if scan.unit in ("m", "cm", "mm") else f" ({in_unit:.3g} {scan.unit})")
    named = zip("xyz", steps_m, strict=True)
    return ", ".join(f"{size_text(float(step_m))} in {axis}" for axis, step_m in named if step_m >= _LEAST_SAID_M)


def _observe_doubled(doubled: tuple[DoubledWay, ...]) -> Observation:
    """Say how far apart doubled surfaces lie."""
    largest = max(doubled, key=lambda way: way.apart_m)
    more = [way for way in doubled if way is not largest]
    others = f" ({' and '.join(size_text(way.apart_m) for way in more)} those that face another way)" if more else ""
    message = (
        f"surfaces are double, {size_text(largest.apart_m)} apart{others}, on {largest.share:.0%} of what faces "
        "that way: stations that do not lie over each other"
    )
    return Observation("surfaces_doubled", "doubt", message, largest.apart_m, CURES["surfaces_doubled"])


def _observe_copy(shift: Floats) -> Observation:
    size_m = float(np.linalg.norm(shift))
    message = f"the cloud holds itself twice, shifted by {size_text(size_m)}"
    return Observation("cloud_copied", "doubt", message, size_m, CURES["cloud_copied"])


def _observe_facets(facet_m: float) -> Observation:
    message = (
        f"a scanned mesh, its corners about {size_text(facet_m)} apart: it rounds what is finer, the sides of treads "
        "above all; u holds that, but nothing that its maker smoothed beyond it"
    )
    return Observation("mesh_scanned", "doubt", message, facet_m, CURES["mesh_scanned"])


def _observe_sparse(spacing_m: float, per_tread: int) -> Observation:
    message = (
        f"points lie about {size_text(spacing_m)} apart: some {per_tread} on a tread of "
        f"{priors.USUAL_GOING_M * 1000.0:.0f} x {priors.USUAL_WIDTH_M * 1000.0:.0f} mm, where {POINTS_PER_TREAD} are "
        "needed"
    )
    return Observation("points_sparse", "doubt", message, spacing_m, CURES["points_sparse"])
