"""The shift after which treads and risers come again in a profile, and where they lie: drawn bin by bin."""

import numpy as np
import pytest

from stair_inspector.geometry.rhythms import BIN_M, Rhythm, fill_profile, find_periods, place_rhythm

RISES_M = (0.06, 0.5)
GOING, RISE, N_STEPS = 14, 9, 5
FIRST = (40, 22)
"""Bin of the lowest nosing."""
SIZE = (160, 90)


def stair(going=GOING, rise=RISE, n_steps=N_STEPS, first=FIRST, size=SIZE):
    """The level and the upright faces of a stair that climbs ahead by whole bins or parts of them."""
    level, upright = np.zeros(size), np.zeros(size)
    for k in range(n_steps):
        starts, ends = (round(first[0] + n * going) for n in (k, k + 1))
        bottom, top = (round(first[1] + n * rise) for n in (k - 1, k))
        level[starts:ends, top] = 1.0
        upright[starts, bottom:top] = 1.0
    return level, upright


def falling(profile):
    return profile[::-1].copy()


@pytest.mark.parametrize(
    ("going", "rise"), [(14, 9), (14, -9), (9, 14), (25, 3), (25, -3), (3, 25), (3, -25), (25, 25)]
)
def test_faces_come_again_after_a_going_and_a_rise_whichever_way_they_climb(going, rise):
    level, upright = stair(going, abs(rise), 9, (20, 30), (300, 300))
    if rise < 0:
        level, upright = falling(level), falling(upright)
    found = find_periods(level, upright, RISES_M)
    assert found[0] == pytest.approx((going, rise), abs=0.1)
    rounded = {tuple(np.rint(period)) for period in found}
    assert len(rounded) == len(found)


@pytest.mark.parametrize(("going", "rise"), [(14.3, 8.6), (13.71, 9.23)])
def test_a_part_of_a_bin_is_known_from_the_steps_farther_on(going, rise):
    found = find_periods(*stair(going, rise, 20, (10, 20), (310, 220)), RISES_M)
    # A bin over sixteen steps.
    assert found[0] == pytest.approx((going, rise), abs=1.0 / 16.0 / 2.0)


def test_steps_on_which_nobody_climbs_are_no_period():
    # 60 by 100 mm; twice as much is a period of them, too.
    found = find_periods(*stair(3, 5, 12, (20, 30), (120, 120)), RISES_M)
    assert found[0] == pytest.approx((6.0, 10.0), abs=0.2)
    assert all(max(ahead, abs(up)) * BIN_M > 0.14 for ahead, up in found)


def test_every_face_of_a_stair_is_found_in_its_place():
    rhythm = place_rhythm(*stair(), (GOING, RISE))
    np.testing.assert_array_equal(rhythm.corner, FIRST)
    assert (rhythm.going, rhythm.rise) == (GOING, RISE)
    assert rhythm.treads == rhythm.risers == tuple(range(N_STEPS))
    assert rhythm.levels == rhythm.walls == ()
    # Each riser ends at its own tread, and begins at the one below it.
    assert rhythm.joints == N_STEPS + N_STEPS - 1
    assert rhythm.score == 3 * N_STEPS + N_STEPS - 1


def test_a_stair_that_falls_ahead_is_the_mirror_image_of_one_that_climbs():
    level, upright = stair()
    climbs, falls = (
        place_rhythm(level, upright, (GOING, RISE)),
        place_rhythm(falling(level), falling(upright), (GOING, -RISE)),
    )
    np.testing.assert_array_equal(falls.corner, [SIZE[0] - 1 - climbs.corner[0], climbs.corner[1]])
    assert (falls.treads, falls.risers, falls.joints) == (climbs.treads, climbs.risers, climbs.joints)
    assert falls.rise == -RISE


def test_floors_landings_and_walls_that_run_on_are_none_of_its_treads_and_risers():
    level, upright = stair()
    top = FIRST[1] + (N_STEPS - 1) * RISE
    level[: FIRST[0], FIRST[1] - RISE] = 1.0
    level[FIRST[0] + (N_STEPS - 1) * GOING :, top] = 1.0
    rhythm = place_rhythm(level, upright, (GOING, RISE))
    assert rhythm.treads == tuple(range(N_STEPS - 1))
    assert rhythm.risers == tuple(range(N_STEPS))
    assert rhythm.levels == (-1, N_STEPS - 1)
    # Where the riser ends the edge is seen all the same.
    assert rhythm.joints == 2 * N_STEPS
    # A wall from the last tread to the ceiling.
    level, upright = stair()
    upright[FIRST[0] + N_STEPS * GOING, top:] = 1.0
    rhythm = place_rhythm(level, upright, (GOING, RISE))
    assert rhythm.walls == (N_STEPS,)
    assert rhythm.risers == tuple(range(N_STEPS))


def test_a_floor_before_a_wall_is_no_rhythm():
    level, upright = np.zeros(SIZE), np.zeros(SIZE)
    level[:80, 20], upright[80, 20:] = 1.0, 1.0
    assert place_rhythm(level, upright, (GOING, RISE)) is None


def test_halfway_between_two_faces_there_is_air():
    # Boards of two faces, half a rise apart, and then panels of two, half a going apart.
    level, upright = stair(rise=10)
    nothing = np.zeros(SIZE)
    assert place_rhythm(level, nothing, (GOING, 10)) is not None
    assert place_rhythm(level + np.roll(level, -5, 1), nothing, (GOING, 10)) is None
    assert place_rhythm(nothing, upright, (GOING, 10)) is not None
    assert place_rhythm(nothing, upright + np.roll(upright, 7, 0), (GOING, 10)) is None


def test_a_cell_is_as_full_as_it_has_points_and_never_more_than_full():
    cells = np.repeat([[1, 2, 0], [3, 0, 4]], (1, 2, 50), axis=1)
    filled = fill_profile(cells, np.array([3, 5]))
    assert filled.shape == (3, 5)
    assert filled[2, 0] == 2.0 * filled[1, 3] > 0.0
    assert filled[0, 4] == filled.max() == 1.0
    assert np.count_nonzero(filled) == 3


def test_faces_and_the_edges_between_them_speak_for_a_rhythm():
    assert Rhythm(14.0, 9.0, np.zeros(2), (0, 1), (0, 1, 2), (3,), (4, 5), 7).score == 12
