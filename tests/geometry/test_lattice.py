"""The rhythm of treads and riser faces."""

from dataclasses import replace

import numpy as np
import pytest

from stair_inspector.geometry.lattice import find_lattices
from tests.synthetic import Stair, motion, rotation

RISES_M = (0.06, 0.5)
LEANING = motion(rotation("x", 50.0) @ rotation("z", 33.0), (3.0, -2.0, 1.0))
STAIR = Stair(n_steps=6, rise=0.17, going=0.29, risers=True, spacing=0.025, noise=0.002, motion=LEANING)


def n_risers_of(lattice):
    """How many risers the rhythm has from the first face seen to the last."""
    numbers = (*lattice.treads, *lattice.risers)
    return max(numbers) - min(numbers) + 1


def lattice_of(stair):
    found = find_lattices(*stair.sample(), RISES_M)
    return found[0] if found else None


def as_upright(lattice, stair):
    """The reading in which the stair stands as it was built."""
    readings = [lattice, lattice.flipped(), lattice.turned(), lattice.turned().flipped()]
    return max(readings, key=lambda reading: float(reading.up @ stair.motion[:3, 2]))


def test_a_stair_has_one_rhythm_with_its_rise_and_going_and_place():
    lattice = as_upright(lattice_of(STAIR), STAIR)
    turn, shift = LEANING[:3, :3], LEANING[:3, 3]
    assert lattice.up @ turn[:, 2] > np.cos(np.radians(1.0))
    assert lattice.ahead @ turn[:, 0] > np.cos(np.radians(1.0))
    # The profile has cells of 20 mm; a step is known to a part of that from many steps.
    assert lattice.rise_m == pytest.approx(0.17, abs=0.005)
    assert lattice.going_m == pytest.approx(0.29, abs=0.005)
    assert lattice.width_m == pytest.approx(1.0, abs=0.1)
    assert (len(lattice.treads), len(lattice.risers)) == (6, 6)
    assert n_risers_of(lattice) == 6
    # The nosing of the first tread, tread 1 of the stair, in the middle of its width.
    first = lattice.origin + min(lattice.treads) * (lattice.going_m * lattice.ahead + lattice.rise_m * lattice.up)
    np.testing.assert_allclose((first - shift) @ turn, [0.0, 0.5, 0.17], atol=0.04)


def test_turned_and_flipped_twice_is_the_lattice_itself():
    lattice = lattice_of(STAIR)
    for again in (lattice.turned().turned(), lattice.flipped().flipped()):
        np.testing.assert_allclose(again.up, lattice.up, atol=1e-15)
        np.testing.assert_allclose(again.origin, lattice.origin, atol=1e-12)
        assert (again.treads, again.risers, again.levels) == (lattice.treads, lattice.risers, lattice.levels)
    assert lattice.turned().rise_m == lattice.going_m


def middles(lattice):
    """The middles of the treads and of the risers of a reading, as sets of places to 1 nm."""
    step = lattice.going_m * lattice.ahead + lattice.rise_m * lattice.up
    treads = [lattice.origin + k * step + lattice.going_m / 2.0 * lattice.ahead for k in lattice.treads]
    risers = [lattice.origin + k * step - lattice.rise_m / 2.0 * lattice.up for k in lattice.risers]
    return tuple({tuple(np.round(place, 9) + 0.0) for place in places} for places in (treads, risers))


def test_every_reading_has_its_faces_where_they_are():
    lattice = lattice_of(STAIR)
    treads, risers = middles(lattice)
    assert (len(treads), len(risers)) == (6, 6)
    assert middles(lattice.flipped()) == (treads, risers)
    # On its back the treads are risers.
    assert middles(lattice.turned()) == (risers, treads)
    assert middles(lattice.turned().flipped()) == (risers, treads)
    for reading in (lattice.flipped(), lattice.turned()):
        assert reading.score == lattice.score == 12 + lattice.joints


def test_what_the_rhythm_expects_and_nobody_saw_is_counted():
    points, normals = STAIR.sample()
    local = (points - LEANING[:3, 3]) @ LEANING[:3, :3]
    is_gone = (local[:, 2] > 3 * 0.17 - 0.16) & (local[:, 2] < 3 * 0.17 + 0.01) & (local[:, 0] > 0.5)
    found = find_lattices(points[~is_gone], normals[~is_gone], RISES_M)[0]
    lattice = as_upright(found, STAIR)
    assert n_risers_of(lattice) == 6
    assert (len(lattice.treads), len(lattice.risers)) == (5, 5)


@pytest.mark.parametrize(
    "stair",
    [
        replace(STAIR, risers=False),
        replace(STAIR, n_steps=1),
        # A bookcase: board above board.
        replace(STAIR, going=0.001, n_steps=8),
    ],
    ids=["treads alone", "one riser", "boards"],
)
def test_what_has_no_rhythm_of_two_families_has_no_lattice(stair):
    if stair.going < 0.01:
        points, normals = replace(stair, going=0.3, n_steps=1).sample()
        shift = LEANING[:3, 2] * 0.17
        points = np.concatenate([points + k * shift for k in range(8)])
        normals = np.tile(normals, (8, 1))
    else:
        points, normals = stair.sample()
    assert find_lattices(points, normals, RISES_M) == []


def test_a_scan_that_is_shallower_than_the_longest_step_has_no_lattice():
    # A board of 60 mm before a wall.
    rng = np.random.default_rng(5)
    board = rng.uniform(0.0, 1.0, (1000, 3)) * [0.06, 0.5, 0.0]
    wall = rng.uniform(0.0, 1.0, (4000, 3)) * [0.0, 0.5, 1.0]
    normals = np.repeat([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]], (1000, 4000), axis=0)
    assert find_lattices(np.concatenate([board, wall]), normals, RISES_M) == []
