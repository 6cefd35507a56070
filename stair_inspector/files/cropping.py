"""The box of a file that is read: which points lie in it, and with what the file goes on just outside."""

from dataclasses import replace

import numpy as np

from stair_inspector.declarations import Box
from stair_inspector.errors import ReadError
from stair_inspector.files.file_part import FilePart
from stair_inspector.files.raw_cloud import READ_STAGE
from stair_inspector.geometry.arrays import Bools, Floats, Ints
from stair_inspector.model import Note, ReadPart
from stair_inspector.params import ScanUnit
from stair_inspector.units import METRES_PER_UNIT

BEYOND_M = 0.15
"""How far outside the box the points are kept that tell what it cuts; of points 50 mm apart three are needed."""
_MARGIN_M = 0.05
"""So much of it is looked for in further cells of a COPC."""


def part_of_file(box: Box | None, detail_m: float, unit: ScanUnit) -> FilePart:
    """Return what is read of a file; where its unit is not stated, detail and margin are taken as if it were metres."""
    metres = 1.0 if unit == "auto" else METRES_PER_UNIT[unit]
    part = FilePart(box, detail_m)
    return replace(part, detail_m=part.detail_m / metres, margin=_MARGIN_M / metres)


def cut_out(points: Floats, kept: Ints, part: FilePart) -> tuple[Ints, Ints, Note]:
    """Part the points of a file at its box.

    Parameters
    ----------
    points : (n, 3)
        In the file's own coordinates.
    kept : (m,)
        Rows of those that are points at all.
    part : FilePart
        With a box.

    Returns
    -------
    inside, outside : (k,), (m - k,)
        Rows of those in the box, its faces included, and of the others.
    note : Note
        How many they are.

    Raises
    ------
    ReadError
        No point lies in the box.
    """
    is_inside = part.holds(points[kept])
    inside = kept[is_inside]
    if not len(inside):
        raise ReadError("has no points in the box of --crop, which is in the file's own coordinates; give another")
    message = f"{len(inside):,} of {len(kept):,} points read lie in the box of --crop; the others were left out"
    return inside, kept[~is_inside], Note("cropped", READ_STAGE, message)


def scan_part(box: Box, outside: Floats, metres: float, origin_m: Floats) -> ReadPart:
    """Return the box in metres, with those of the points outside of it (n, 3), file's unit, that lie near to it."""
    box_m = np.array(box) * metres
    outside_m = outside * metres
    is_near = np.all((outside_m >= box_m[0] - BEYOND_M) & (outside_m <= box_m[1] + BEYOND_M), axis=1)
    return ReadPart(box_m, outside_m[is_near] - origin_m)


def find_near(faces: Floats, box: Box | None, metres: float) -> Bools:
    """Tell of each triangle (n, 3, 3), file's unit, whether it may reach the box or what is looked at beside it."""
    if box is None:
        return np.ones(len(faces), dtype=np.bool_)
    low, high = np.array(box) + np.array([[-1.0], [1.0]]) * (BEYOND_M / metres)
    near: Bools = np.all((faces.max(axis=1) >= low) & (faces.min(axis=1) <= high), axis=1)
    return near
