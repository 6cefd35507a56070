"""One inspection with its scan, in level coordinates: what every file of this room takes."""

import math
from dataclasses import dataclass

import numpy as np

from stair_inspector.errors import CannotMeasure, ConfigError
from stair_inspector.geometry.arrays import Floats
from stair_inspector.measured import OWN_PARTS, part_of
from stair_inspector.model import COVERAGE_FACTOR, FLOOR_LABEL, Inspection, Measured, Scan, Step

_OVER_ALL = 3.0
"""How many times what registration adds to a rise it adds to a height against the whole stair: neighbours are seen from
the same stations, ends are not. With simulated tripods
whose stations are 0.5 mm off, U then holds 91 to 98 % of the changes of height."""


@dataclass(frozen=True, slots=True, eq=False)
class Tread:
    """A step's tread in level coordinates, metres: ``plane`` is the height at zero and the slopes along both axes.

    ``corners`` (4, 2) in plan: front left, front right, back right, back left; ``climb`` (2,); ``nosing`` (2, 3).
    ``rms_m`` is the scatter of its points about the plane, ``spacing_m`` their mean distance.
    """

    step: Step
    plane: Floats
    corners: Floats
    climb: Floats
    nosing: Floats
    rms_m: float
    spacing_m: float

    def height_at(self, x: Floats, y: Floats) -> Floats:
        """Return the height of its plane at places of the plan."""
        heights: Floats = self.plane[0] + self.plane[1] * x + self.plane[2] * y
        return heights


@dataclass(frozen=True, slots=True, eq=False)
class Epoch:
    """A scan that was measured: ``points`` (3, n) level coordinates, ascending in height; ``floor`` (3, f) the floor's.

    ``level_from_scan`` (3, 3) turns local scan axes into level ones.
    """

    inspection: Inspection
    level_from_scan: Floats
    points: Floats
    floor: Floats
    treads: tuple[Tread, ...]

    def between(self, low_m: float, high_m: float) -> Floats:
        """Return the points (3, m) between two heights."""
        start, stop = np.searchsorted(self.points[2], [low_m, high_m])
        return self.points[:, start:stop]


def epoch_of(scan: Scan, inspection: Inspection) -> Epoch:
    """Return an inspection ready to be compared.

    Raises
    ------
    ConfigError
        It was made by the paper's method, which states no uncertainty, or the scan is not the one it was made of.
    CannotMeasure
        It has a question open, or no steps.
    """
    name = scan.name
    if inspection.params.method != "survey":
        raise ConfigError(f"{name}: measured by the paper's method, whose values have no uncertainty; use survey")
    if inspection.scan.sha256 != scan.sha256 or len(inspection.labels) != len(scan.points):
        raise ConfigError(f"{name}: the inspection was made of another scan; measure this one")
    if inspection.is_withheld:
        asked = inspection.questions[0]
        cure = f" ({asked.cure})" if asked.cure else ""
        raise CannotMeasure(f"{name}: cannot be compared before this is answered: {asked.message}{cure}")
    steps = [step for step in inspection.steps if step.nosing is not None and step.plane.normal is not None]
    if not steps:
        raise CannotMeasure(f"{name}: has no staircase that could be compared; see what measuring it says")
    turn = _level_turn(inspection.up.vector)
    places = inspection.places(scan.points, np.arange(len(scan.points)))
    points = turn @ places.T
    order = np.argsort(points[2], kind="stable")
    floor = points[:, inspection.labels == FLOOR_LABEL]
    return Epoch(inspection, turn, points[:, order], floor, tuple(_tread_of(step, turn) for step in steps))


def surface_doubts(step: Step, others: tuple[Step, ...]) -> dict[str, float]:
    """Return the expanded parts of the uncertainty of a tread's height against its neighbours, metres.

    A rise hangs on two heights. The foot of a flight may have no rise: it takes the largest of the others.
    """
    rises = [step.rise_m] if step.rise_m is not None else [other.rise_m for other in others]
    known = [rise for rise in rises if rise is not None]
    return {name: max((part_of(rise, name) for rise in known), default=0.0) / math.sqrt(2.0) for name in OWN_PARTS}


def systematic(doubts: dict[str, float], of_registration: float = 1.0) -> float:
    """Return the standard uncertainty of a height beside noise, with registration counted so many times, metres."""
    parts = {**doubts, "registration": of_registration * doubts["registration"], "noise": 0.0}
    return math.hypot(*parts.values()) / COVERAGE_FACTOR


def height_doubt(step: Step, others: tuple[Step, ...]) -> float:
    """Return the standard uncertainty of a tread's height against the whole stair, beside noise, metres."""
    return systematic(surface_doubts(step, others), _OVER_ALL * math.sqrt(2.0))


def slope_doubt_of(slope_deg: Measured | None) -> float:
    """Return the standard uncertainty of a tread's slope, a tangent, without that of up."""
    if slope_deg is None:
        return math.radians(0.1)
    own = math.sqrt(sum(part_of(slope_deg, name) ** 2 for name in OWN_PARTS))
    return math.radians(own) / COVERAGE_FACTOR


def _level_turn(up: Floats) -> Floats:
    """Return the rotation (3, 3) whose third row is up, its first the scan's own x, or y where up lies along x."""
    along = np.eye(3)[0 if abs(up[0]) < 0.9 else 1]
    first = along - (along @ up) * up
    first /= np.linalg.norm(first)
    turn: Floats = np.stack([first, np.cross(up, first), up])
    return turn


def _tread_of(step: Step, turn: Floats) -> Tread:
    if step.plane.normal is None or step.nosing is None or step.climb is None:
        raise CannotMeasure(f"step {step.step_id}: has no surface that could be compared")
    normal, centroid = turn @ step.plane.normal, turn @ step.plane.centroid
    slopes = -normal[:2] / normal[2]
    plane = np.array([centroid[2] - slopes @ centroid[:2], *slopes])
    climb = (turn @ step.climb)[:2]
    corners = (turn @ step.corners.T)[:2].T
    nosing = (turn @ step.nosing.T).T
    ahead, aside = corners[2] - corners[0], corners[3] - corners[1]
    area_m2 = 0.5 * abs(float(ahead[0] * aside[1] - ahead[1] * aside[0])) * (step.coverage or 1.0)
    spacing_m = math.sqrt(area_m2 / max(1, step.plane.n_points))
    return Tread(step, plane, corners, climb / np.hypot(*climb), nosing, step.plane.rms_m or 0.0, spacing_m)
