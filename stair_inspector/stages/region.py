"""Does the region of interest, or the box that was read of the file, cut through a step? That is no side of it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stair_inspector.geometry.arrays import Floats
from stair_inspector.geometry.boxes import TurnedBox, turned_box
from stair_inspector.model import CUT_BACK, CUT_FRONT, CUT_SIDES, Horizontal, Note, Patches, Scan, Step, Up
from stair_inspector.stages.orient import region_box

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
_TOWARDS = math.sin(math.radians(20.0))
_WHAT_IS_LOST = (
    (CUT_FRONT, ("front",), "that is no nosing, and nothing is measured from it"),
    (CUT_BACK, ("back",), "its depth is not that of the stair and has no value"),
    (CUT_SIDES, ("left", "right"), "its width is not that of the stair and has no value"),
)


def note_region_cuts(
    scan: Scan, up: Up, region: str, steps: Sequence[Step], points: Sequence[Floats], spacings_m: Sequence[float]
) -> list[Note]:
    """Note every step that a face of the region of interest, or of the box that was read, cuts through.

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
        For each step that ends at an upright face while the scan, or the file, goes on behind it, what of it is not the
        stair's: of the codes ``CUT_SIDES``, ``CUT_BACK`` and ``CUT_FRONT``.
    """
    notes: list[Note] = []
    for limit in _limits_of(scan, up, region):
        notes += _note_cuts(limit, up, steps, points, spacings_m)
    return notes


def _note_cuts(
    limit: "_Limit", up: Up, steps: Sequence[Step], points: Sequence[Floats], spacings_m: Sequence[float]
) -> list[Note]:
    notes = []
    for step, own, spacing_m in zip(steps, points, spacings_m, strict=True):
        if step.climb is None:
            continue
        left = np.cross(up.vector, step.climb)
        cut = {side for way in _cut_faces(limit, up, own, spacing_m) for side in _sides_of(way, step.climb, left)}
        for code, names, lost in _WHAT_IS_LOST:
            sides = [name for name in names if name in cut]
            if sides:
                message = (
                    f"{limit.name} cuts through step {step.step_id} on its {' and '.join(sides)}: {lost}; make the "
                    f"{limit.short_name} larger to measure it"
                )
                notes.append(Note(code, "verdict", message, step.step_id))
    return notes


def find_cut_faces(scan: Scan, horizontal: Horizontal, patches: Patches, region: str) -> dict[int, tuple[Floats, ...]]:
    """Find the surfaces that end at the region of interest, or the box that was read, and go on behind its face.

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
    limits = _limits_of(scan, horizontal.up, region)
    if not limits:
        return {}
    found: dict[int, tuple[Floats, ...]] = {}
    for number, surface in enumerate(patches.surfaces):
        own = scan.points[horizontal.point_ids[surface.rows]]
        cut = [way for limit in limits for way in _cut_faces(limit, horizontal.up, own, surface.spacing_m)]
        if cut:
            found[number] = tuple(horizontal.level_from_scan[:2] @ way for way in cut)
    return found


@dataclass(frozen=True, slots=True, eq=False)
class _Limit:
    """A ``box`` outside of which nothing is measured; the known ``points`` (n, 3) along its axes; local."""

    name: str
    short_name: str
    box: TurnedBox
    points: Floats


def _limits_of(scan: Scan, up: Up, region: str) -> list[_Limit]:
    """Return the region of interest and the box that was read of the file, those that there are."""
    limits = []
    box = region_box(region, up, scan)
    if box is not None:
        limits.append(_Limit("the region of interest", "region", box, box.coordinates(scan.points)))
    if scan.part is not None:
        low, high = scan.part.box_m - scan.origin_m
        read = turned_box(low, high, up.vector, None)
        limits.append(_Limit("the box of the file that was read", "box", read, scan.part.beyond_m))
    return limits


def _cut_faces(limit: _Limit, up: Up, own: Floats, spacing_m: float) -> list[Floats]:
    """Return in which directions (3,), scan axes, the upright faces of a box look out that cut through a surface."""
    box = limit.box
    along_up, mine = box.coordinates(up.vector), box.coordinates(own)
    return [
        sign * box.axes[axis]
        for axis in range(3)
        for bound, sign in zip(box.bounds[:, axis], (-1.0, 1.0), strict=True)
        if abs(along_up[axis]) < _UPRIGHT and _is_cut(limit.points, along_up, mine, spacing_m, axis, float(bound), sign)
    ]


def _sides_of(way: Floats, climb: Floats, left: Floats) -> list[str]:
    """Return on which sides of a step a face lies that looks out that way, as seen when climbing: two where aslant."""
    ahead, aside = float(way @ climb), float(way @ left)
    sides = (("back", ahead), ("front", -ahead), ("left", aside), ("right", -aside))
    return [name for name, towards in sides if towards > _TOWARDS]


def _is_cut(points: Floats, up: Floats, own: Floats, spacing_m: float, axis: int, bound: float, sign: float) -> bool:
    """Return whether a surface reaches a face of a box along an edge, and points (n, 3) go on behind it.

    All along the axes of the box, ``up`` (3,) too.
    """
    near_m = max(_AT_FACE_M, _AT_FACE_SPACINGS * spacing_m)
    at_face = own[np.abs(own[:, axis] - bound) <= near_m]
    if len(at_face) < _FEWEST_POINTS:
        return False
    face = np.zeros(3)
    face[axis] = 1.0
    along = np.cross(up, face)
    along /= np.linalg.norm(along)
    low, high = np.percentile(at_face @ along, [1.0, 99.0])
    # Of a step seen in part only a strip reaches the face; what touches it with a corner widens behind.
    behind = own[np.abs(own[:, axis] - bound) <= _BEHIND_M] @ along
    seen_m = float(np.ptp(np.percentile(behind, [1.0, 99.0])))
    if high - low < min(_LEAST_CUT_M, _LEAST_CUT_SHARE * seen_m):
        return False
    beyond = sign * (points[:, axis] - bound)
    candidates = points[(beyond > 0.0) & (beyond <= max(_BEYOND_M, near_m))]
    height_m = float(np.median(at_face @ up))
    place = candidates @ along
    is_near = (np.abs(candidates @ up - height_m) <= _SAME_HEIGHT_M) & (place >= low) & (place <= high)
    return int(np.count_nonzero(is_near)) >= _GOES_ON_SHARE * len(at_face)
