"""Where a flight is seen only in part: shadows, missing treads in it and at its ends, first risers that are tall."""

import numpy as np
import pytest

from stair_inspector.params import FlightsParams, PatchesParams
from stair_inspector.stages.flights import find_chains
from stair_inspector.stages.rejects import Forced
from tests.stages.rectangles import CELL, GOING, RISE, WIDTH, flight, floor, moved, patches_of, rectangle, surface_of

LANDING = (7 * GOING, 7 * GOING + 1.5)
"""Where the landing after seven treads lies."""


def chains_of(surfaces):
    return find_chains(patches_of(surfaces), FlightsParams(), PatchesParams.min_area_m2, Forced({}))


def flights_of(surfaces):
    """Base, steps and missing treads of every chain."""
    return [(chain.base, chain.steps, chain.n_missing) for chain in chains_of(surfaces).chains]


def codes(surfaces):
    return [note.code for note in chains_of(surfaces).notes]


def with_landing(gone=(), rise=RISE, **others):
    """A floor, seven treads and a landing, of which some are missing; the floor is the first surface."""
    treads = [tread for k, tread in enumerate(flight(7, rise=rise), start=1) if k not in gone]
    return [others.get("floor", floor()), *treads, rectangle(LANDING, (0.0, WIDTH), 8 * rise)]


def strip(k, depth, start=0.0):
    """The part of tread k that a scanner sees: so deep, from so far behind its nosing."""
    x = (k - 1) * GOING + start
    return rectangle((x, x + depth), (0.0, WIDTH), k * RISE, k)


# shadows


@pytest.mark.parametrize("depth", [0.04, 0.08, 0.12])
def test_treads_of_which_only_the_front_was_seen_belong_to_their_flight(depth):
    # Four in a row, as from a station on a landing above; between them more is hidden than the largest gap.
    treads = [strip(k, depth) if 5 <= k <= 8 else tread for k, tread in enumerate(flight(12), start=1)]
    assert flights_of([floor(), *treads]) == [(0, tuple(range(1, 13)), (0,) * 12)]


def test_a_ragged_shadow_does_not_part_a_flight():
    # At the left end of the step's back hardly 0.1 m touches the next step; the rest ends 80 mm before it.
    treads = flight(6)
    x, y = treads[2].cells_m
    treads[2] = surface_of(treads[2].cells_m[:, (y > 0.9) | (x < 3 * GOING - 0.08)], 3 * RISE)
    surfaces = [floor(), *treads]
    assert flights_of(surfaces) == [(0, (1, 2, 3, 4, 5, 6), (0,) * 6)]


def test_opposite_halves_of_two_edges_are_one_flight():
    treads = flight(8)
    treads[3] = rectangle((3 * GOING, 4 * GOING), (0.0, 0.4), 4 * RISE)
    treads[5] = rectangle((5 * GOING, 6 * GOING), (0.24, WIDTH), 6 * RISE)
    assert flights_of([floor(), *treads]) == [(0, tuple(range(1, 9)), (0,) * 8)]


def test_two_strips_alone_continue_nothing():
    # No flight is there that they could go on from.
    assert flights_of([floor(), strip(1, 0.06), strip(2, 0.06), strip(3, 0.06)]) == []


# missing treads


@pytest.mark.parametrize(("gone", "n_missing"), [((1,), 1), ((1, 2), 2)])
def test_missing_lowest_treads_are_counted_and_not_bridged(gone, n_missing):
    n = 8 - len(gone)
    assert flights_of(with_landing(gone)) == [(0, tuple(range(1, n + 1)), (n_missing, *(0,) * (n - 1)))]
    turned = moved(with_landing(gone), 217.0, (5.0, -3.0, 12.0))
    assert flights_of(turned) == flights_of(with_landing(gone))


@pytest.mark.parametrize(("gone", "n_missing"), [((7,), 1), ((6, 7), 2)])
def test_missing_highest_treads_are_counted_and_not_bridged(gone, n_missing):
    n = 8 - len(gone)
    assert flights_of(with_landing(gone)) == [(0, tuple(range(1, n + 1)), (*(0,) * (n - 1), n_missing))]


def test_missing_treads_on_both_sides_of_a_landing_leave_both_flights_at_it():
    upper = [tread for k, tread in enumerate(flight(5, x=LANDING[1], z=8 * RISE), start=1) if k != 1]
    assert flights_of([*with_landing((7,)), *upper]) == [
        (0, (1, 2, 3, 4, 5, 6, 7), (0, 0, 0, 0, 0, 0, 1)),
        (7, (8, 9, 10, 11), (1, 0, 0, 0)),
    ]


def test_a_floor_that_ends_too_far_off_or_lies_too_low_is_not_the_foot():
    for where in (floor((-3.0, -0.5)), floor(z=-0.5 * RISE), floor(y=(1.5, 3.0))):
        (chain,) = flights_of(with_landing((1,), floor=where))
        assert (chain[0], chain[2]) == (None, (0,) * 7)


@pytest.mark.parametrize("tall", [0.25, 0.28, 0.295])
def test_a_tall_first_riser_belongs_to_its_flight_and_nothing_is_missing(tall):
    surfaces = [floor(z=RISE - tall), *flight(7)]
    assert flights_of(surfaces) == [(0, (1, 2, 3, 4, 5, 6, 7), (0,) * 7)]
    assert codes(surfaces) == []


@pytest.mark.parametrize("tall", [0.25, 0.28, 0.295])
def test_a_tall_last_riser_belongs_to_its_flight_and_nothing_is_missing(tall):
    surfaces = [floor(), *flight(7), rectangle(LANDING, (0.0, WIDTH), 7 * RISE + tall)]
    assert flights_of(surfaces) == [(0, tuple(range(1, 9)), (0,) * 8)]


def test_a_first_riser_taller_than_the_largest_rise_is_named_and_not_called_missing():
    surfaces = [floor(z=-RISE), *flight(7)]
    (chain,) = chains_of(surfaces).chains
    assert (chain.base, chain.n_missing) == (None, (0,) * 7)
    (note,) = chains_of(surfaces).notes
    assert note.code == "foot_tall"
    assert "lies 340 mm below that step, 2.0 usual rises: the first riser is that tall" in note.message
    assert "missing" not in note.message


def test_where_the_floor_goes_on_below_nothing_tells_a_missing_tread_from_a_tall_riser():
    surfaces = with_landing((1,), floor=floor((-0.8, 2.0)))
    (chain,) = chains_of(surfaces).chains
    assert (chain.base, chain.n_missing) == (None, (0,) * 7)
    (note,) = chains_of(surfaces).notes
    assert note.code == "foot_unclear"
    assert "a tread is missing there or the first riser is that tall" in note.message


def test_a_lowest_tread_seen_whole_over_treads_in_shadow_is_no_floor():
    treads = [strip(k, 0.12) if k > 1 else tread for k, tread in enumerate(flight(8), start=1)]
    (chain,) = chains_of(treads).chains
    assert (chain.base, chain.steps) == (None, tuple(range(8)))


def in_two(n_gone, **where):
    """A floor, two treads, a gap and four more treads, which may begin elsewhere than where the flight goes on."""
    where = {"x": (2 + n_gone) * GOING, "z": (2 + n_gone) * RISE} | where
    return [floor(), *flight(2), *flight(4, **where)]


@pytest.mark.parametrize("n_gone", [4, 5])
def test_more_treads_than_are_bridged_are_missing_between_two_flights(n_gone):
    surfaces = in_two(n_gone)
    assert flights_of(surfaces) == [(0, (1, 2), (0, 0)), (None, (3, 4, 5, 6), (0, 0, 0, 0))]
    (note,) = chains_of(surfaces).notes
    assert note.code == "treads_missing"
    assert note.message.startswith(f"{n_gone} treads are missing or not seen between flight 1 and flight 2, which may")


@pytest.mark.parametrize("where", [{"x": 9 * GOING}, {"y": (1.5, 2.5)}, {"z": 6.5 * RISE}])
def test_flights_that_do_not_go_on_in_each_other_have_nothing_missing_between_them(where):
    assert codes(in_two(4, **where)) == []


@pytest.mark.parametrize(("n_rises", "text"), [(3, "3.0"), (7, "7.0"), (2.6, "2.6")])
def test_no_first_riser_is_said_to_be_more_than_two_rises_tall(n_rises, text):
    # The floor goes on below the treads that are left.
    surfaces = [floor((-0.8, 3.0), z=(1.0 - n_rises) * RISE), *flight(7)]
    (note,) = chains_of(surfaces).notes
    assert note.code == "foot_unclear"
    assert f"{text} usual rises: treads are missing or not seen there or the first riser is that tall" in note.message


def test_a_landing_that_lies_beside_is_not_the_end_of_a_flight():
    surfaces = [floor(), *flight(6), rectangle(LANDING, (1.2, 3.0), 8 * RISE)]
    assert flights_of(surfaces) == [(0, (1, 2, 3, 4, 5, 6), (0,) * 6)]


def test_a_tread_that_is_there_is_not_missing():
    # Turned by a quarter and hanging on a corner: no step, but no gap either.
    odd = rectangle((3.35 * GOING, 3.65 * GOING), (0.4, 0.6), 4 * RISE)
    treads = [tread for k, tread in enumerate(flight(8), start=1) if k != 4]
    surfaces = [floor(), *treads, odd]
    assert odd.area_m2 < PatchesParams.min_area_m2
    (chain,) = chains_of(surfaces).chains
    assert chain.n_missing == (0, 0, 0, 1, 0, 0, 0)
    larger = rectangle((3.2 * GOING, 3.8 * GOING), (0.4, 0.65), 4 * RISE)
    assert all(sum(chain.n_missing) == 0 for chain in chains_of([floor(), *treads, larger]).chains)


def test_what_is_found_moves_no_step():
    found = chains_of(with_landing((1, 7)))
    (chain,) = found.chains
    assert chain.n_missing == (1, 0, 0, 0, 0, 1)
    fronts = [1, 2, 3, 4, 5, 7]
    np.testing.assert_allclose(chain.middles[:, 0], [k * GOING for k in fronts], atol=CELL)
