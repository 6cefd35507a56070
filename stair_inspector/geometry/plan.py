"""Directions and cells of a plan: what is to the left, how one turns, which cell a place lies in."""

import math

import numpy as np

from stair_inspector.geometry.arrays import Floats, Ints


def left_of(direction: Floats) -> Floats:
    """Return the direction of the plan, (2,), that is a quarter turn to the left of another one."""
    return np.array([-direction[1], direction[0]])


def unit_way(direction: Floats) -> Floats:
    """Return a direction of the plan, (2,), as a unit vector."""
    unit: Floats = direction / np.hypot(*direction)
    return unit


def angle_deg(a: Floats, b: Floats) -> float:
    """Return the angle between two directions of the plan, degrees, 0 to 180."""
    return abs(turn_deg(a, b))


def turn_deg(a: Floats, b: Floats) -> float:
    """Return the turn from one direction of the plan to another, degrees, positive to the left."""
    return math.degrees(math.atan2(float(a[0] * b[1] - a[1] * b[0]), float(a @ b)))


def place_in_frame(place: Floats, origin: Floats, ahead: Floats) -> tuple[float, float]:
    """Return how far along a direction (2,), and how far to its left, one place (2,) of a plan lies from an origin."""
    shift = place - origin
    return float(shift @ ahead), float(shift[1] * ahead[0] - shift[0] * ahead[1])


def in_frame(plan: Floats, origin: Floats, ahead: Floats) -> tuple[Floats, Floats]:
    """Return how far along a direction (2,), and how far to its left, places (2, n) of a plan lie from an origin."""
    x, y = plan[0] - origin[0], plan[1] - origin[1]
    return ahead[0] * x + ahead[1] * y, ahead[0] * y - ahead[1] * x


def cell_keys(places_m: Floats, side_m: float) -> Ints:
    """Return a number for the square cell of a plan in which each place (2, n) lies, the same for all that ask."""
    cells = np.floor(places_m / side_m).astype(np.int64)
    keys: Ints = cells[0] * 2**32 + cells[1]
    return keys
