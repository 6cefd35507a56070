"""Directions of a plan: what is to their left, and how one turns from one to another."""

import math

import numpy as np

from stair_inspector.geometry.arrays import Floats


def left_of(direction: Floats) -> Floats:
    """Return the direction of the plan, (2,), that is a quarter turn to the left of another one."""
    return np.array([-direction[1], direction[0]])


def angle_deg(a: Floats, b: Floats) -> float:
    """Return the angle between two directions of the plan, degrees, 0 to 180."""
    return abs(turn_deg(a, b))


def turn_deg(a: Floats, b: Floats) -> float:
    """Return the turn from one direction of the plan to another, degrees, positive to the left."""
    return math.degrees(math.atan2(float(a[0] * b[1] - a[1] * b[0]), float(a @ b)))
