"""A slab cut out of the scan, along or across the stair: which points lie in it, and its outline seen from the side."""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from stair_inspector.content.segmented_points import labels_at
from stair_inspector.errors import ConfigError
from stair_inspector.geometry.arrays import Bools, Floats, Ints, Labels
from stair_inspector.model import Inspection, Scan, Step
from stair_inspector.pictures.display import Display, display_of
from stair_inspector.pictures.frames import SectionFrame

Direction = Literal["along", "across"]

DIRECTIONS: tuple[Direction, ...] = ("along", "across")
THINNEST_M, THICKEST_M = 0.002, 2.0
MOST_POINTS = 200_000
"""Points of a section that are drawn; they come from the whole scan, not from its drawn subset."""
_OUTERMOST_PERCENT = 0.5
_ENOUGH = 30_000
_TRUE_LENGTH = math.cos(math.radians(5.0))
"""Cosine between a going and the drawing from which on its length in the drawing is its own, to 0.4 %."""


@dataclass(frozen=True, slots=True, eq=False)
class Slab:
    """All points within half of ``thickness_m`` of an upright plane, local metres.

    ``centre`` (3,) lies in the plane and ``facing`` (3,) points square out of it, to who looks at the section;
    ``across`` (3,) then runs to the right and ``up`` (3,) upwards. ``corners`` (4, 3) outline the stair in the plane.
    ``place_m`` is its place from the middle of the stair: to the right of who climbs, or along the climb.
    """

    direction: Direction
    centre: Floats
    facing: Floats
    across: Floats
    up: Floats
    place_m: float
    thickness_m: float
    corners: Floats


@dataclass(frozen=True, slots=True, eq=False)
class ProfileLine:
    """A step where the middle of the slab cuts it: the ``ends`` (2, 2) of its plane, and its ``nosing`` (2,) if cut.

    ``climbs_right`` says whether the step climbs to the right in the drawing, so that its going is seen in true length.
    """

    step: Step
    ends: Floats
    nosing: Floats | None
    climbs_right: bool


@dataclass(frozen=True, slots=True, eq=False)
class Profile:
    """A section as a drawing: ``places_m`` (n, 2) across and height in the scan frame, ``labels`` (n,), step lines.

    The place across is measured from the middle of the stair, or of the step that the frame belongs to.
    """

    direction: Direction
    places_m: Floats
    labels: Labels
    lines: tuple[ProfileLine, ...]
    place_m: float
    thickness_m: float


def places(frame: SectionFrame, points: Floats, direction: Direction) -> tuple[float, float]:
    """Return the range of places at which a slab of this direction meets the points (m, 3), metres."""
    return _range((_some(points) - frame.origin) @ _axis(frame, direction))


def cut(frame: SectionFrame, direction: Direction, place_m: float, thickness_m: float, points: Floats) -> Slab:
    """Return the slab at a place.

    Parameters
    ----------
    frame : SectionFrame
        From :func:`section_frame`.
    direction : {"along", "across"}
        Along the stair, seen from the right of who climbs; or across it, seen by who climbs.
    place_m, thickness_m : float
        From the middle of the stair to the right, or along the climb; how thick the slab is.
    points : (m, 3)
        Displayed points, local; they set how far the outline reaches.

    Raises
    ------
    ConfigError
        The place is no number, or the thickness is not between 2 mm and 2 m.
    """
    if not np.isfinite(place_m):
        raise ConfigError(f"section: place: got {place_m!r}; give a length in metres")
    if not THINNEST_M <= thickness_m <= THICKEST_M:
        raise ConfigError(f"section: thickness: got {thickness_m * 1000.0:g} mm; give 2 to 2000 mm")
    facing, across = (frame.right, frame.climb) if direction == "along" else (-frame.climb, frame.right)
    centre = frame.origin + place_m * _axis(frame, direction)
    (x_low, x_high), (z_low, z_high) = (_range((_some(points) - centre) @ axis) for axis in (across, frame.up))
    outline = ((x_low, z_low), (x_high, z_low), (x_high, z_high), (x_low, z_high))
    corners = np.array([centre + s * across + t * frame.up for s, t in outline])
    return Slab(direction, centre, facing, across, frame.up, place_m, thickness_m, corners)


def is_in(points: Floats, slab: Slab) -> Bools:
    """Return which points (n, 3), local, lie in the slab."""
    inside: Bools = np.abs(points @ slab.facing - slab.centre @ slab.facing) <= slab.thickness_m / 2.0
    return inside


def section_display(scan: Scan, slab: Slab) -> Display:
    """Return what is drawn of a section, out of the whole scan; it is coloured as any other display."""
    return display_of(scan, _rows_in(scan, slab))


def profile_of(scan: Scan, inspection: Inspection, slab: Slab) -> Profile:
    """Return the section as a drawing, from the points of the whole scan."""
    rows = _rows_in(scan, slab)
    origin_height = float(scan.origin_m @ slab.up)
    return Profile(
        direction=slab.direction,
        places_m=_places(inspection.places(scan.points[rows], rows), slab, origin_height),
        labels=labels_at(inspection, rows),
        lines=tuple(_lines(inspection, slab, origin_height)),
        place_m=slab.place_m,
        thickness_m=slab.thickness_m,
    )


def profile_csv(profile: Profile) -> bytes:
    """Return the points of a section as CSV, all that are drawn: millimetres, and the number of the step.

    The floor has the number 0; what is no step, such as a riser, has none.
    """
    head = f"{'along' if profile.direction == 'along' else 'right'}_mm,height_mm,step_number"
    places = (1000.0 * profile.places_m).tolist()
    rows = (
        f"{x:.2f},{z:.2f},{label if label >= 0 else ''}"
        for (x, z), label in zip(places, profile.labels.tolist(), strict=True)
    )
    return ("\n".join([head, *rows]) + "\n").encode("utf-8")


def _some(points: Floats) -> Floats:
    """Return some of the points, evenly: enough for a range that is drawn while a slider moves."""
    return points[:: max(1, len(points) // _ENOUGH)]


def _range(values: Floats) -> tuple[float, float]:
    low, high = np.percentile(values, [_OUTERMOST_PERCENT, 100.0 - _OUTERMOST_PERCENT])
    return float(low), float(high)


def _axis(frame: SectionFrame, direction: Direction) -> Floats:
    return frame.right if direction == "along" else frame.climb


def _rows_in(scan: Scan, slab: Slab) -> Ints:
    rows = np.nonzero(is_in(scan.points, slab))[0]
    if len(rows) > MOST_POINTS:
        rows = np.sort(np.random.default_rng(0).choice(rows, MOST_POINTS, replace=False))
    return rows.astype(np.int64)


def _places(points: Floats, slab: Slab, origin_height: float) -> Floats:
    # Across from the slab's own centre, which lies square to the frame's origin.
    return np.column_stack([(points - slab.centre) @ slab.across, points @ slab.up + origin_height])


def _lines(inspection: Inspection, slab: Slab, origin_height: float) -> list[ProfileLine]:
    lines = []
    for step in inspection.steps:
        ends = _crossing(step.corners, slab, is_closed=True)
        if len(ends) < 2:
            continue
        nosing = _crossing(step.nosing, slab, is_closed=False) if step.nosing is not None else []
        places_m = _places(np.array(ends[:2]), slab, origin_height)
        # From left to right, whichever way the plate goes round.
        places_m = places_m[np.argsort(places_m[:, 0])]
        nosing_m = _places(np.array(nosing), slab, origin_height)[0] if nosing else None
        climbs_right = step.climb is not None and float(step.climb @ slab.across) >= _TRUE_LENGTH
        lines.append(ProfileLine(step, places_m, nosing_m, climbs_right))
    return lines


def _crossing(corners: Floats, slab: Slab, *, is_closed: bool) -> list[Floats]:
    """Return the points where the slab's middle plane crosses a line through corners (k, 3)."""
    beyond = (corners - slab.centre) @ slab.facing
    pairs = list(zip(range(len(corners)), range(1, len(corners)), strict=False))
    pairs += [(len(corners) - 1, 0)] if is_closed else []
    return [
        corners[i] + beyond[i] / (beyond[i] - beyond[j]) * (corners[j] - corners[i])
        for i, j in pairs
        if (beyond[i] > 0.0) != (beyond[j] > 0.0)
    ]
