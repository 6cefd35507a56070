"""Where does a surface return nothing? In patches that are drawn at random."""

import math

import numpy as np

from stair_inspector.geometry.arrays import Bools, Floats, Ints
from stair_inspector.simulation.rays import RayCaster
from stair_inspector.simulation.scanner_specs import Scanner

_SQUARES_TURN_DEG = 27.0  # Merging programs know nothing of the stair: no row of squares may follow one of its edges.
_HOLE_M = 0.05  # Side of the patches in which a surface returns nothing.


def place_on_surface(caster: "RayCaster", ids: Ints, hit: Floats) -> Floats:
    """Return where on its surface each ray hits, (n, 2) metres, along two axes askew to the edges of the stair."""
    a, b = np.take_along_axis(hit, caster.flat_axes[ids], axis=1).T
    cos, sin = math.cos(math.radians(_SQUARES_TURN_DEG)), math.sin(math.radians(_SQUARES_TURN_DEG))
    return np.stack([cos * a + sin * b, cos * b - sin * a], axis=1)


def lies_in_hole(joint_ids: Ints, on_surface: Floats, scanner: Scanner) -> Bools:
    """Say which rays hit a patch of a surface that returns nothing, from whichever station it is looked at."""
    if not scanner.hole_share:
        return np.zeros(len(joint_ids), dtype=np.bool_)
    patches = np.floor(on_surface / _HOLE_M).astype(np.int64)
    mixed = np.full(len(joint_ids), scanner.seed, dtype=np.uint64)
    for key in (joint_ids, patches[:, 0], patches[:, 1]):
        # The finalizer of SplitMix64 (Steele, Lea, Flood, 2014): a number for each patch, in whatever order it is hit.
        mixed = (mixed ^ key.astype(np.uint64)) + np.uint64(0x9E3779B97F4A7C15)
        mixed = (mixed ^ (mixed >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        mixed = (mixed ^ (mixed >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        mixed ^= mixed >> np.uint64(31)
    chance = (mixed >> np.uint64(11)).astype(np.float64) / 2.0**53
    is_hole: Bools = chance < scanner.hole_share
    return is_hole
