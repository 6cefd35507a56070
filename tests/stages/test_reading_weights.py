"""What speaks for each reading of a rhythm that is stated: surroundings of our own, each added alone."""

import dataclasses
import itertools

import numpy as np
import pytest

from stair_inspector.geometry.lattice import Lattice
from stair_inspector.stages import readings
from stair_inspector.stages.readings import read_rhythm
from stair_inspector.stages.thinned import Thinned
from tests.synthetic import rotation

N, RISE, GOING, WIDTH = 6, 0.17, 0.28, 1.0
X, Y, Z = np.eye(3)
NOWHERE = np.zeros(3)
ASLANT = rotation("x", 50.0) @ rotation("z", 33.0) @ rotation("y", 25.0)
"""No axis of the stair lies along one of the file."""
SPACING_M = 0.04


def face(low, high, normal):
    """Points anywhere on a rectangle, with its normal."""
    extent = np.subtract(high, low)
    n = round(np.prod(extent[extent > 0.0]) / SPACING_M**2)
    return np.random.default_rng(n).uniform(low, high, (n, 3)), np.tile(normal, (n, 1))


def stair(rise=RISE, going=GOING, forward_m=0.0, back_m=0.0):
    """Treads and risers of a stair along x, the first riser over the origin; treads reach past them by so much."""
    faces = []
    for k in range(N):
        treads = (k * going - forward_m, 0.0, (k + 1) * rise), ((k + 1) * going + back_m, WIDTH, (k + 1) * rise)
        risers = (k * going, 0.0, k * rise), (k * going, WIDTH, (k + 1) * rise)
        faces += [face(*treads, Z), face(*risers, X)]
    return faces


def walls(low_m, high_m, aside_m=0.05, along=(0.0, N * GOING)):
    """Walls on both sides from one height to another."""
    places = (-aside_m, WIDTH + aside_m)
    return [face((along[0], y, low_m), (along[1], y, high_m), Y) for y in places]


def weights_of(faces, turn=ASLANT, rise=RISE, going=GOING, as_found=lambda lattice: lattice, place=NOWHERE, **asked):
    """Return the weights of the readings, upright, upside down, on its back and on its face; the origin at a place."""
    points, normals = (np.concatenate(each) for each in zip(*faces, strict=True))
    points, normals = (points - place) @ turn.T, normals @ turn.T
    middle = turn @ (np.array([0.0, WIDTH / 2.0, rise]) - place)
    numbers = tuple(range(N))
    lattice = Lattice(turn @ Z, turn @ X, rise, going, middle, WIDTH, numbers, numbers, (), (), 2 * N - 1, len(points))
    settings = {"max_rise_m": 0.3, "hint": NOWHERE, "is_camera": False, **asked}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(readings, "find_lattices", lambda *_: [as_found(lattice)])
        found = read_rhythm(Thinned(points, normals), **settings)
    assert [each.weight for each in found] == sorted((each.weight for each in found), reverse=True)
    ups = (Z, -Z, -X, X)
    return np.array([next(each.weight for each in found if each.up @ turn @ up > 0.999) for up in ups])


def lead_of(faces, **settings):
    """By how much the stair upright leads the stair upside down."""
    upright, upside_down, *_ = weights_of(faces, **settings)
    return upright - upside_down


def test_a_reading_weighs_the_same_whichever_of_the_four_was_found():
    landing = face((N * GOING, 0.0, N * RISE), (N * GOING + 0.6, WIDTH, N * RISE), Z)
    faces = [*stair(forward_m=0.024), *walls(0.3, 2.4), *walls(-1.0, 0.0, aside_m=0.4), landing]
    faces.append(face((-1.5, -0.5, 0.0), (0.0, 1.5, 0.0), Z))
    expected = weights_of(faces)
    assert np.ptp(expected) > 1.0
    for as_found in (Lattice.flipped, Lattice.turned, lambda lattice: lattice.flipped().turned()):
        np.testing.assert_allclose(weights_of(faces, as_found=as_found), expected, atol=1e-9)


def test_the_file_speaks_for_its_z_axis_the_more_the_closer_up_is_to_it():
    leads = [lead_of(stair(), turn=rotation("x", lean)) for lean in (0.0, 2.0, 10.0, 40.0)]
    assert all(first > second for first, second in itertools.pairwise(leads))
    assert leads[-1] == pytest.approx(lead_of(stair()))
    assert lead_of(stair(), turn=rotation("x", 182.0)) == pytest.approx(-leads[1])


def test_what_else_would_be_up_speaks_for_the_reading_that_has_the_same():
    plain = weights_of(stair())
    for number, up in enumerate((Z, -Z, -X, X)):
        near = ASLANT @ rotation("y", 12.0) @ up
        change = weights_of(stair(), hint=near) - plain
        assert change[number] > 0.1
        assert np.delete(change, number) == pytest.approx(np.zeros(3))
    np.testing.assert_array_equal(weights_of(stair(), hint=ASLANT @ rotation("y", 20.0) @ Z), plain)


def test_a_rise_and_a_going_as_they_are_built_speak_for_a_reading():
    upright, upside_down, back, front = weights_of(stair())
    assert upright == pytest.approx(upside_down)
    assert back == pytest.approx(front)
    assert upright > back + 1.0
    # A longer rise is as likely as a usual one where the user has said that it may be.
    tall = {"rise": 0.36, "going": 0.29}
    narrow, wide = (weights_of(stair(**tall), max_rise_m=limit, **tall)[0] for limit in (0.3, 0.45))
    assert wide > narrow + 0.5
    # On treads of 90 mm nobody climbs.
    short = {"rise": 0.2, "going": 0.09}
    assert weights_of(stair(**short), **short)[0] < upright - 10.0


def test_walls_are_seen_through_the_air_above_a_stair():
    bare = lead_of(stair())
    top = N * RISE
    above, below = lead_of(stair() + walls(top, top + 1.5)), lead_of(stair() + walls(-1.5, 0.0))
    assert above > bare + 2.0
    # From the lowest tread down as from the highest tread up.
    assert above - bare == pytest.approx(bare - below, abs=0.3)
    # Neither far aside nor beyond the stair are they its walls, but something above it all the same.
    aside, ahead = (
        lead_of(stair() + walls(top, top + 1.5, aside_m=0.4)),
        lead_of(stair() + walls(top, top + 1.5, along=(-2.0, -2.0 + N * GOING))),
    )
    assert bare < aside < above - 1.0
    assert bare < ahead < above - 1.0
    # What is no taller than a riser faces as walls do where a stair turns.
    stretches = enumerate(((0.0, 0.48), (0.62, 1.08), (1.22, 1.66)))
    pieces = [part for k, along in stretches for part in walls(top + 0.35 + 0.4 * k, top + 0.65 + 0.4 * k, along=along)]
    assert lead_of(stair() + pieces) < bare + 2.0


def test_walls_turn_a_levelled_scan_over_by_less_than_one_of_which_nothing_is_known():
    below = walls(-1.5, 0.0)
    levelled, aslant = (
        lead_of(stair(), turn=turn) - lead_of(stair() + below, turn=turn) for turn in (np.eye(3), ASLANT)
    )
    assert 0.0 < levelled < aslant - 1.0


def test_treads_reach_past_their_risers_ahead_of_them_and_not_behind():
    bare = lead_of(stair())
    forward, back = lead_of(stair(forward_m=0.05)), lead_of(stair(back_m=0.05))
    assert forward > bare + 1.0
    assert forward - bare == pytest.approx(bare - back, abs=0.5)
    # Past the risers as they stand, which may be a little off the rhythm.
    reaching = stair(forward_m=0.03)
    shifted = [(points + 0.02 * X, normals) for points, normals in reaching]
    assert lead_of(shifted) == pytest.approx(lead_of(reaching), abs=0.5)


def test_the_floor_is_larger_than_the_landing():
    bare = lead_of(stair())
    floor = face((-2.0, 0.0, 0.0), (0.0, WIDTH, 0.0), Z)
    landing = face((N * GOING, 0.0, N * RISE), (N * GOING + 2.0, WIDTH, N * RISE), Z)
    assert lead_of([*stair(), floor]) > bare + 0.3
    assert lead_of([*stair(), landing]) < bare - 0.3
    assert lead_of([*stair(), floor, landing]) == pytest.approx(bare, abs=0.1)


def test_treads_of_a_flight_that_goes_on_below_tell_no_side():
    bare = lead_of(stair())

    def treads(shift_m):
        heights = -RISE * np.arange(2, 5) - shift_m
        return [face((-1.2, 0.0, height), (-0.3, WIDTH, height), Z) for height in heights]

    on, off = treads(0.0), treads(RISE / 2.0)
    assert lead_of(stair() + on) == pytest.approx(bare, abs=0.05)
    assert lead_of(stair() + off) < bare - 0.3
    assert lead_of(stair() + on + off) < bare - 0.3


def test_level_surfaces_beyond_a_stair_speak_for_the_readings_in_which_they_are_level():
    plain = weights_of(stair())
    far = face((-2.0, 2.0, 0.5), (1.0, 4.0, 0.5), Z)
    change = weights_of([*stair(), far]) - plain
    assert change[:2].mean() > change[2:].mean() + 0.5
    upright = face((-1.0, 2.0, -1.0), (-1.0, 4.0, 1.0), X)
    change = weights_of([*stair(), upright]) - plain
    assert change[:2].mean() < change[2:].mean() - 0.5


MIDDLE = np.array([N * GOING, WIDTH, (N + 1) * RISE]) / 2.0


@pytest.mark.parametrize("out", [(-2.3, 0.0, 1.0), (-1.6, -0.2, 1.4)])
def test_a_camera_stands_before_the_risers_and_above_the_treads(out):
    upright, *others = weights_of(stair(), place=MIDDLE + out, is_camera=True)
    assert upright > max(others) + 2.0
    # A ceiling over the camera is no tread that is seen from below.
    ceiling = face((-2.5, -0.5, 3.2), (0.5, 1.5, 3.2), Z)
    assert lead_of([*stair(), ceiling], place=MIDDLE + out, is_camera=True) > upright - others[0] - 0.5
    # From below and behind the same faces are the stair upside down.
    other, upside_down, *others = weights_of(stair(), place=MIDDLE - out, is_camera=True)
    assert upside_down > max(other, *others) + 2.0


def test_a_camera_does_not_look_straight_down():
    before, above = (
        weights_of(stair(), place=MIDDLE + out, is_camera=True)[0] for out in ((-2.5, 0.0, 1.4), (-1.0, 0.0, 4.0))
    )
    assert before > above + 1.0


def test_rhythms_of_longer_steps_than_stairs_have_are_none(monkeypatch):
    points, normals = (np.concatenate(each) for each in zip(*stair(), strict=True))
    numbers = tuple(range(N))
    usual = Lattice(
        Z, X, RISE, GOING, np.array([0.0, 0.5, RISE]), WIDTH, numbers, numbers, (), (), 2 * N - 1, len(points)
    )
    for rise_m, limit_m, is_one in ((0.35, 0.3, False), (0.35, 0.4, True), (0.29, 0.2, True)):
        long = dataclasses.replace(usual, rise_m=rise_m, going_m=rise_m + 0.01)
        monkeypatch.setattr(readings, "find_lattices", lambda *_, found=long: [found])
        assert bool(read_rhythm(Thinned(points, normals), limit_m, NOWHERE, is_camera=False)) == is_one
