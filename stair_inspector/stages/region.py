"""Does the region of interest cut through a step? Then its sides there are the region's, not the stair's."""

import math
from collections.abc import Sequence

import numpy as np

from stair_inspector.geometry.arrays import Floats, Point
from stair_inspector.model import Horizontal, Note, Patches, Scan, Step, Up
from stair_inspector.overrules import parse_region

_AT_FACE_M, _AT_FACE_SPACINGS = 0.02, 3.0
"""What lies as near to a face of the region may have been cut off there; of sparse points more spacings are needed."""
_BEYOND_M = 0.05
_SAME_HEIGHT_M = 0.03
_LEAST_CUT_M, _LEAST_CUT_SHARE, _BEHIND_M = 0.1, 0.5, 0.2
"""A face cuts along an edge so long, or along so much of what is seen of the step as far behind the face."""
_FEWEST_POINTS = 5
_GOES_ON_SHARE = 0.3
"""A surface goes on beyond a face where it has at least this share of the points that it has on the near side."""
_UPRIGHT = math.cos(math.radians(45.0))


def note_region_cuts(
    scan: Scan, up: Up, region: str, steps: Sequence[Step], points: Sequence[Floats], spacings_m: Sequence[float]
) -> list[Note]:
    """Note every step that a face of the region of interest cuts through.

    Parameters
    ----------
    scan : Scan
        All of it, what lies outside of the region included.
    up : Up
        Up direction, scan axes.
    region : str
        As ``overrules.region`` gives it; empty for none.
    steps : sequence of Step
        As they were measured within the region.
    points : sequence of (n, 3)
        The points of each step's surface, local coordinates.
    spacings_m : sequence of float
        Mean distance of the points of each step's surface.

    Returns
    -------
    list of Note
        For each step that ends at an upright face of the region while the scan goes on behind it, what of it is the
        region's and not the stair's.
    """
    box = parse_region(region)
    if box is None:
        return []
    notes = []
    for step, own, spacing_m in zip(steps, points, spacings_m, strict=True):
        if step.climb is None:
            continue
        left = np.cross(up.vector, step.climb)
        cut = {_side_of(*face, step.climb, left) for face in _cut_faces(scan, up, box, own, spacing_m)}
        for names, what in ((("left", "right"), "width"), (("front", "back"), "depth")):
            sides = [name for name in names if name in cut]
            if sides:
                message = (
                    f"the region of interest cuts through step {step.step_id} on its {' and '.join(sides)}: its {what} "
                    "is that of the region, not of the stair; make the region larger to measure it"
                )
                notes.append(Note("region_cuts", "verdict", message, step.step_id))
    return notes


def find_cut_faces(scan: Scan, horizontal: Horizontal, patches: Patches, region: str) -> dict[int, tuple[Floats, ...]]:
    """Find the surfaces that end at the region of interest while the scan goes on behind its face.

    Parameters
    ----------
    scan : Scan
        All of it, what lies outside of the region included.
    horizontal, patches
        Of what lies within the region; level frame.
    region : str
        As ``overrules.region`` gives it; empty for none.

    Returns
    -------
    dict
        For each such surface, by its number, the directions of the plan, (2,), in which its cut faces look out.
    """
    box = parse_region(region)
    if box is None:
        return {}
    found: dict[int, tuple[Floats, ...]] = {}
    for number, surface in enumerate(patches.surfaces):
        own = scan.points[horizontal.point_ids[surface.rows]]
        spacing_m = surface.spacing_m
        cut = _cut_faces(scan, horizontal.up, box, own, spacing_m)
        if cut:
            found[number] = tuple(sign * horizontal.level_from_scan[:2, axis] for axis, sign in cut)
    return found


def _cut_faces(scan: Scan, up: Up, box: tuple[Point, Point], own: Floats, spacing_m: float) -> list[tuple[int, float]]:
    """Return the upright faces of the region that cut through a surface: axis, and sign of the side they look out."""
    bounds = np.array(box) - scan.origin_m
    return [
        (axis, sign)
        for axis in range(3)
        for bound, sign in zip(bounds[:, axis], (-1.0, 1.0), strict=True)
        if abs(up.vector[axis]) < _UPRIGHT and _is_cut(scan, up, own, spacing_m, axis, float(bound), sign)
    ]


def _side_of(axis: int, sign: float, climb: Floats, left: Floats) -> str:
    """Return on which side of a step a face of the region lies, as seen when climbing."""
    ahead, aside = sign * float(climb[axis]), sign * float(left[axis])
    if abs(ahead) > abs(aside):
        return "back" if ahead > 0.0 else "front"
    return "left" if aside > 0.0 else "right"


def _is_cut(scan: Scan, up: Up, own: Floats, spacing_m: float, axis: int, bound: float, sign: float) -> bool:
    """Return whether a surface reaches a face of the region along an edge, and the scan goes on behind it."""
    near_m = max(_AT_FACE_M, _AT_FACE_SPACINGS * spacing_m)
    at_face = own[np.abs(own[:, axis] - bound) <= near_m]
    if len(at_face) < _FEWEST_POINTS:
        return False
    face = np.zeros(3)
    face[axis] = 1.0
    along = np.cross(up.vector, face)
    along /= np.linalg.norm(along)
    low, high = np.percentile(at_face @ along, [1.0, 99.0])
    # Of a step seen in part only a strip reaches the face; what touches it with a corner widens behind.
    behind = own[np.abs(own[:, axis] - bound) <= _BEHIND_M] @ along
    seen_m = float(np.ptp(np.percentile(behind, [1.0, 99.0])))
    if high - low < min(_LEAST_CUT_M, _LEAST_CUT_SHARE * seen_m):
        return False
    beyond = sign * (scan.points[:, axis] - bound)
    candidates = scan.points[(beyond > 0.0) & (beyond <= max(_BEYOND_M, near_m))]
    height_m = float(np.median(at_face @ up.vector))
    place = candidates @ along
    is_near = (np.abs(candidates @ up.vector - height_m) <= _SAME_HEIGHT_M) & (place >= low) & (place <= high)
    return int(np.count_nonzero(is_near)) >= _GOES_ON_SHARE * len(at_face)
