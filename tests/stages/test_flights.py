"""Which surfaces become flights: staircases, landings, turns and what only looks like one, built from plan cells."""

import itertools

import numpy as np
import pytest

from stair_inspector.geometry.plan import angle_deg
from stair_inspector.params import FlightsParams, PatchesParams
from stair_inspector.simulation.scenes import stacked_boxes
from stair_inspector.stages.flights import find_chains
from stair_inspector.stages.links import depth_along
from stair_inspector.stages.rejects import Forced
from tests.stages.rectangles import CELL, GOING, RISE, WIDTH, flight, floor, moved, patches_of, rectangle, surface_of

LEAST_AREA_M2 = PatchesParams.min_area_m2
LANDING = (5 * GOING, 5 * GOING + 1.0)
"""Where the landing after five treads and a sixth riser lies."""


def chains_of(surfaces, forced=None, climb=None, **params):
    forced = Forced(forced or {}, None if climb is None else np.array(climb))
    return find_chains(patches_of(surfaces), FlightsParams(**params), LEAST_AREA_M2, forced)


def flights_of(surfaces, **how):
    """Base and steps of every chain."""
    return [(chain.base, chain.steps) for chain in chains_of(surfaces, **how).chains]


def with_landing(n_above=5):
    """A floor (0), five treads (1 to 5), a landing 1 m deep (6) and treads above it."""
    landing = rectangle(LANDING, (0.0, WIDTH), 6 * RISE)
    return [floor(), *flight(5), landing, *flight(n_above, x=LANDING[1], z=6 * RISE)]


def l_turn():
    """As :func:`with_landing`, but the upper flight leaves the landing to the left."""
    upper = moved(flight(5), 90.0, (LANDING[1], WIDTH, 6 * RISE))
    return [*with_landing(0), *upper]


def u_turn():
    """As :func:`with_landing`, with a landing over both flights: the upper one comes back to the left of the lower."""
    landing = rectangle(LANDING, (0.0, 2.0 * WIDTH + 0.1), 6 * RISE)
    upper = moved(flight(5), 180.0, (LANDING[0], 2.0 * WIDTH + 0.1, 6 * RISE))
    return [floor(), *flight(5), landing, *upper]


def twins(gap, n=5):
    """Two flights of the same heights side by side on one floor (0)."""
    second = (WIDTH + gap, 2.0 * WIDTH + gap)
    pairs = zip(flight(n), flight(n, y=second), strict=True)
    return [floor(y=(0.0, second[1])), *(tread for pair in pairs for tread in pair)]


def assert_sound(chains, surfaces):
    """What holds of all chains: each is as long as its lists, ascends, and no surface is a step twice."""
    for chain in chains.chains:
        n = len(chain.steps)
        assert chain.climbs.shape == chain.middles.shape == (n, 2)
        assert len(chain.lengths_m) == len(chain.n_missing) == n
        np.testing.assert_allclose(np.hypot(*chain.climbs.T), 1.0)
        members = chain.steps if chain.base is None else (chain.base, *chain.steps)
        heights = [surfaces[k].height_m for k in members]
        assert heights == sorted(heights)
    steps = [k for chain in chains.chains for k in chain.steps]
    assert len(steps) == len(set(steps))


# straight flights


@pytest.mark.parametrize("n", [2, 3, 4, 10, 60])
def test_a_straight_flight_is_one_chain_from_the_floor_up(n):
    surfaces = [floor(), *flight(n)]
    found = chains_of(surfaces)
    assert_sound(found, surfaces)
    (chain,) = found.chains
    assert (chain.base, chain.steps) == (0, tuple(range(1, n + 1)))
    assert found.longest_risers == n
    assert found.notes == ()
    np.testing.assert_allclose(chain.climbs, np.tile([1.0, 0.0], (n, 1)), atol=1e-9)
    # Every front edge lies where two treads meet; it is as long as the treads are wide, but for the outermost cells.
    np.testing.assert_allclose(chain.middles, [[k * GOING, WIDTH / 2.0] for k in range(n)], atol=CELL)
    np.testing.assert_allclose(chain.lengths_m, WIDTH, atol=3.0 * CELL)
    assert chain.n_missing == (0,) * n


@pytest.mark.parametrize("degrees", range(0, 360, 37))
def test_a_flight_may_climb_in_any_direction(degrees):
    surfaces = moved([floor(), *flight(4)], degrees, (-20.0, 300.0, 1.5))
    (chain,) = chains_of(surfaces).chains
    assert (chain.base, chain.steps) == (0, (1, 2, 3, 4))
    way = np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])
    assert max(angle_deg(climb, way) for climb in chain.climbs) < 1.0


def test_a_flight_of_which_no_floor_was_seen_has_no_base():
    surfaces = flight(5)
    found = chains_of(surfaces)
    assert_sound(found, surfaces)
    (chain,) = found.chains
    assert (chain.base, chain.steps) == (None, (0, 1, 2, 3, 4))
    np.testing.assert_array_equal(chain.climbs[0], chain.climbs[1])


@pytest.mark.parametrize(("rise", "going", "is_flight"), [(0.1, 0.4, True), (0.29, 0.14, True), (0.31, 0.28, False)])
def test_steep_and_flat_flights(rise, going, is_flight):
    found = flights_of([floor(), *flight(6, rise=rise, going=going)])
    assert found == ([(0, (1, 2, 3, 4, 5, 6))] if is_flight else [])


def test_a_shadow_between_the_treads_does_not_part_a_flight():
    # Looked at from above, each nosing hides the back of the tread below it.
    treads = [rectangle((k * GOING, k * GOING + 0.16), (0.0, WIDTH), (k + 1) * RISE) for k in range(5)]
    surfaces = [floor(), *treads]
    assert flights_of(surfaces) == [(0, (1, 2, 3, 4, 5))]
    assert flights_of(surfaces, max_gap_m=0.05) == []


def test_a_wide_lowest_step_and_a_narrow_flight_are_one_flight():
    # A block step that stands out on both sides.
    surfaces = [floor((-0.8, 0.0), (-0.4, 1.4)), rectangle((0.0, GOING), (-0.2, 1.2), RISE), *flight(5)[1:]]
    assert flights_of(surfaces) == [(0, (1, 2, 3, 4, 5))]


def test_open_risers_over_a_visible_floor_begin_on_that_floor():
    # The floor goes on under all of the treads.
    surfaces = [floor((-0.8, 2.0)), *flight(6)]
    (chain,) = chains_of(surfaces).chains
    assert (chain.base, chain.steps) == (0, (1, 2, 3, 4, 5, 6))
    np.testing.assert_allclose(chain.climbs, np.tile([1.0, 0.0], (6, 1)), atol=1e-9)


def test_a_floor_all_around_a_solid_flight_is_its_base():
    surround = floor((-0.8, 3.0), (-0.8, 1.8))
    x, y = surround.cells_m
    under = (x > 0.0) & (x < 5 * GOING) & (y > 0.0) & (y < WIDTH)
    surfaces = [surface_of(surround.cells_m[:, ~under], 0.0), *flight(5)]
    (chain,) = chains_of(surfaces).chains
    assert (chain.base, chain.steps) == (0, (1, 2, 3, 4, 5))
    assert max(angle_deg(climb, np.array([1.0, 0.0])) for climb in chain.climbs[1:]) < 1.0


@pytest.mark.parametrize("slope", [-0.03, 0.03])
def test_the_rise_from_a_floor_that_leans_counts_at_its_edge(slope):
    # 5 m of garden path: its mean height is 75 mm above or below the foot of the stairs.
    path = rectangle((-5.0, 0.0), (0.0, WIDTH), -2.5 * slope, slope=(slope, 0.0))
    (chain,) = chains_of([path, *flight(5)]).chains
    assert (chain.base, chain.steps) == (0, (1, 2, 3, 4, 5))


# missing treads


@pytest.mark.parametrize(("gone", "n_missing"), [((4,), 1), ((4, 5), 2)])
def test_missing_treads_are_counted_and_not_bridged(gone, n_missing):
    surfaces = [floor(), *(tread for k, tread in enumerate(flight(8), start=1) if k not in gone)]
    found = chains_of(surfaces)
    assert_sound(found, surfaces)
    (chain,) = found.chains
    n = 8 - len(gone)
    assert (chain.base, chain.steps) == (0, tuple(range(1, n + 1)))
    # The fourth step that is there is the one above the gap.
    assert chain.n_missing == (0, 0, 0, n_missing, *(0,) * (n - 4))
    assert found.longest_risers == n


@pytest.mark.parametrize("tall", [0.29, 0.095])
def test_one_riser_amid_a_flight_that_is_far_too_tall_or_short_does_not_part_it(tall):
    surfaces = [floor(), *flight(4), *flight(6, x=4 * GOING, z=3 * RISE + tall)]
    (chain,) = chains_of(surfaces).chains
    assert (chain.base, chain.steps) == (0, tuple(range(1, 11)))


def test_a_low_rise_is_not_doubled_over_a_missing_tread():
    # 2 * 120 mm is still less than the largest rise, and the gap in plan is wider than the largest gap.
    surfaces = [floor(), *(tread for k, tread in enumerate(flight(8, rise=0.12), start=1) if k != 4)]
    (chain,) = chains_of(surfaces).chains
    assert chain.n_missing == (0, 0, 0, 1, 0, 0, 0)


def test_a_gap_that_is_no_whole_number_of_rises_is_not_bridged():
    surfaces = [floor(), *flight(4), *flight(4, x=5 * GOING, z=4.5 * RISE)]
    assert flights_of(surfaces) == [(0, (1, 2, 3, 4)), (None, (5, 6, 7, 8))]


# landings and turns


@pytest.mark.parametrize("n_above", [1, 2, 5])
def test_a_landing_ends_one_flight_and_begins_the_next(n_above):
    surfaces = with_landing(n_above)
    found = chains_of(surfaces)
    assert_sound(found, surfaces)
    assert [(chain.base, chain.steps) for chain in found.chains] == [
        (0, (1, 2, 3, 4, 5, 6)),
        (6, tuple(range(7, 7 + n_above))),
    ]


def test_a_deep_step_without_anything_above_it_stays_the_end_of_its_flight():
    assert flights_of(with_landing(0)) == [(0, (1, 2, 3, 4, 5, 6))]


def test_a_flight_that_turns_left_on_its_landing():
    surfaces = l_turn()
    found = chains_of(surfaces)
    assert_sound(found, surfaces)
    lower, upper = found.chains
    assert (lower.base, lower.steps) == (0, (1, 2, 3, 4, 5, 6))
    assert (upper.base, upper.steps) == (6, (7, 8, 9, 10, 11))
    np.testing.assert_allclose(lower.climbs[1:], np.tile([1.0, 0.0], (5, 1)), atol=0.02)
    np.testing.assert_allclose(upper.climbs[1:], np.tile([0.0, 1.0], (4, 1)), atol=0.02)


def test_a_flight_that_comes_back_beside_the_lower_one():
    surfaces = u_turn()
    found = chains_of(surfaces)
    assert_sound(found, surfaces)
    lower, upper = found.chains
    assert (lower.base, lower.steps) == (0, (1, 2, 3, 4, 5, 6))
    assert (upper.base, upper.steps) == (6, (7, 8, 9, 10, 11))
    np.testing.assert_allclose(upper.climbs[1:], np.tile([-1.0, 0.0], (4, 1)), atol=0.02)


@pytest.mark.parametrize("gap", [0.06, 0.12, 0.25])
def test_twins_side_by_side_are_two_flights(gap):
    surfaces = twins(gap)
    found = chains_of(surfaces)
    assert_sound(found, surfaces)
    assert {(chain.base, chain.steps) for chain in found.chains} == {(0, (1, 3, 5, 7, 9)), (0, (2, 4, 6, 8, 10))}


def over_a_common_step(floor_to):
    """Twins of four treads each that climb from one wide first step (1); the floor reaches as far as given."""
    pairs = zip(flight(5)[1:], flight(5, y=(1.4, 2.4))[1:], strict=True)
    wide = rectangle((0.0, GOING), (0.0, 2.4), RISE)
    return [floor((-0.8, floor_to), (0.0, 2.4)), wide, *(tread for pair in pairs for tread in pair)]


def test_twins_over_a_common_first_step_begin_there():
    surfaces = over_a_common_step(0.0)
    assert flights_of(surfaces) == [(0, (1, 2, 4, 6, 8)), (1, (3, 5, 7, 9))]


def test_twins_over_a_common_first_step_use_it_once_where_the_floor_goes_on_below():
    surfaces = over_a_common_step(2.0)
    found = chains_of(surfaces)
    assert_sound(found, surfaces)
    assert {k for chain in found.chains for k in chain.steps} == set(range(1, 10))


def test_a_landing_that_twins_climb_onto_belongs_to_one_of_them():
    surfaces = [*twins(0.12), rectangle(LANDING, (0.0, 2.0 * WIDTH + 0.12), 6 * RISE)]
    found = chains_of(surfaces)
    assert_sound(found, surfaces)
    assert [set(chain.steps) - {11} for chain in by_steps(found)] == [{1, 3, 5, 7, 9}, {2, 4, 6, 8, 10}]
    assert 11 in {chain.steps[-1] for chain in found.chains}


def wedge(k, n_turn=16, inner=0.15, outer=1.0):
    """A tread of a spiral: a sector of a ring, k-th of ``n_turn`` in a full turn."""
    low, high = 2.0 * np.pi * k / n_turn, 2.0 * np.pi * (k + 1) / n_turn
    axis = (np.arange(-60, 60) + 0.5) * CELL
    cells = np.stack(np.meshgrid(axis, axis, indexing="ij")).reshape(2, -1)
    angle, radius = np.arctan2(cells[1], cells[0]) % (2.0 * np.pi), np.hypot(*cells)
    inside = (angle >= low) & (angle < high) & (radius >= inner) & (radius <= outer)
    return surface_of(cells[:, inside], (k + 1) * RISE)


def test_a_spiral_is_one_flight_that_turns():
    surfaces = [floor((-2.0, 2.0), (-2.0, 2.0)), *(wedge(k) for k in range(12))]
    found = chains_of(surfaces)
    assert_sound(found, surfaces)
    (chain,) = found.chains
    assert (chain.base, chain.steps) == (0, tuple(range(1, 13)))
    turns = [angle_deg(a, b) for a, b in itertools.pairwise(chain.climbs[1:])]
    np.testing.assert_allclose(turns, 360.0 / 16.0, atol=6.0)


def touching_landing(y=(0.0, 0.16), rise=RISE):
    """A landing that touches the last of five treads along a short edge; the rest of that tread's back was not seen."""
    treads = flight(5)
    x, across = treads[-1].cells_m
    treads[-1] = surface_of(treads[-1].cells_m[:, (across < y[1]) | (x < 4.3 * GOING)], 5 * RISE)
    hidden = rectangle((5 * GOING, 5 * GOING + 1.5), (y[1] - 1.2, y[1]), 5 * RISE + rise)
    return [floor(), *treads, hidden]


def test_a_flight_ends_on_the_landing_that_it_touches_along_a_short_edge():
    surfaces = touching_landing()
    assert flights_of(surfaces) == [(0, (1, 2, 3, 4, 5, 6))]


@pytest.mark.parametrize("rise", [0.8 * RISE, 1.2 * RISE])
def test_what_a_flight_touches_along_a_short_edge_at_another_rise_is_no_part_of_it(rise):
    assert flights_of(touching_landing(rise=rise)) == [(0, (1, 2, 3, 4, 5))]


# what is no staircase


def test_one_kerb_is_no_flight_unless_one_riser_is_asked_for():
    surfaces = [floor((-2.0, 0.0), (0.0, 3.0)), rectangle((0.0, 0.3), (0.0, 3.0), 0.12)]
    found = chains_of(surfaces)
    assert (found.chains, found.longest_risers) == ((), 1)
    assert flights_of(surfaces, min_risers=1) == [(0, (1,))]


def test_three_risers_may_be_asked_for():
    assert flights_of([floor(), *flight(2)]) == [(0, (1, 2))]
    assert flights_of([floor(), *flight(2)], min_risers=3) == []
    assert flights_of([floor(), *flight(3)], min_risers=3) == [(0, (1, 2, 3))]


@pytest.mark.parametrize(("second", "is_flight"), [(1.3 * RISE, True), (1.4 * RISE, False)])
def test_two_risers_alone_must_be_alike(second, is_flight):
    treads = [rectangle((0.0, GOING), (0.0, WIDTH), RISE), rectangle((GOING, 2.0 * GOING), (0.0, WIDTH), RISE + second)]
    assert flights_of([floor(), *treads]) == ([(0, (1, 2))] if is_flight else [])


def test_a_steep_ladder_is_a_flight():
    assert flights_of([floor(), *flight(6, going=0.12)]) == [(0, (1, 2, 3, 4, 5, 6))]


@pytest.mark.parametrize("going", [0.06, 0.08])
def test_boards_that_hardly_stand_back_from_each_other_are_no_flight(going):
    assert flights_of([floor(), *flight(6, going=going)]) == []


@pytest.mark.parametrize(("drift", "is_flight"), [(0.1, True), (0.6, False)])
def test_surfaces_that_drift_sideways_are_no_flight(drift, is_flight):
    treads = [rectangle((k * GOING, (k + 1) * GOING), (k * drift, k * drift + WIDTH), (k + 1) * RISE) for k in range(5)]
    assert flights_of([floor(y=(0.0, 4.0)), *treads]) == ([(0, (1, 2, 3, 4, 5))] if is_flight else [])


def test_shelves_straight_above_each_other_are_no_flight():
    shelves = [rectangle((0.0, 0.3), (0.0, 1.2), RISE * k) for k in range(1, 11)]
    assert flights_of([floor((-2.5, 0.3), (-0.2, 1.4)), *shelves]) == []


@pytest.mark.parametrize("n", [2, 5])
def test_terraces_are_too_high_for_steps(n):
    assert flights_of([floor(), *flight(n, rise=0.45, going=2.0)]) == []


def seen_from_above(building):
    """What is seen straight from above of a building of upright boxes: each top in the cells that nothing covers."""
    tops = building.mesh.triangles[building.mesh.face_normals[:, 2] > 0.99].reshape(-1, 6, 3)
    lows, highs = tops.min(axis=1), tops.max(axis=1)
    axes = [
        np.arange(low + CELL / 2.0, high, CELL) for low, high in zip(lows.min(0)[:2], highs.max(0)[:2], strict=True)
    ]
    cells = np.stack(np.meshgrid(*axes, indexing="ij")).reshape(2, -1)
    height, owner = np.full(cells.shape[1], -np.inf), np.zeros(cells.shape[1], dtype=np.int64)
    for number, (low, high) in enumerate(zip(lows, highs, strict=True)):
        inside = (np.abs(2.0 * cells.T - (low + high)[:2]) < (high - low)[:2]).all(axis=1) & (high[2] > height)
        height[inside], owner[inside] = high[2], number
    return [surface_of(cells[:, owner == k], lows[k, 2]) for k in np.argsort(lows[:, 2]) if (owner == k).any()]


def test_a_heap_of_boxes_is_no_flight():
    surfaces = seen_from_above(stacked_boxes())
    assert len(surfaces) == 10
    assert flights_of(surfaces) == []


def test_an_edge_over_a_gap_is_no_longer_than_the_narrower_surface():
    found = chains_of([floor((-0.92, -0.12), (-1.0, 2.0)), *flight(4)])
    assert found.chains[0].lengths_m[0] <= WIDTH + CELL


# choices


def test_another_surface_that_would_continue_the_flight_as_well_is_noted():
    # From the third step on there is a second possibility beside the first, hardly narrower.
    surfaces = [floor(y=(0.0, 2.0)), *flight(3, y=(0.0, 2.0))]
    surfaces += [rectangle((3 * GOING, 4 * GOING), y, 4 * RISE) for y in ((0.0, 1.06), (1.12, 2.0))]
    surfaces += [rectangle((4 * GOING, 5 * GOING), (0.0, 1.06), 5 * RISE)]
    found = chains_of(surfaces)
    assert_sound(found, surfaces)
    assert [chain.steps for chain in found.chains] == [(1, 2, 3, 4, 6)]
    (note,) = found.notes
    assert (note.code, note.stage) == ("chain_ambiguous", "flights")
    assert "(patch 4, rise 170 mm" in note.message
    assert "patch 5 would also have been possible" in note.message


def test_a_given_climb_leaves_out_what_climbs_another_way():
    # Up to a platform and down on its other side.
    other = moved(flight(5), 180.0, (2.0 * LANDING[1] - LANDING[0] - 1.0 + 5 * GOING, WIDTH, 0.0))
    far = rectangle((LANDING[1] + 5 * GOING, LANDING[1] + 5 * GOING + 0.8), (0.0, WIDTH), 0.0)
    surfaces = [*with_landing(0), far, *other]
    both = {steps for _, steps in flights_of(surfaces)}
    assert (1, 2, 3, 4, 5, 6) in both
    assert len(both) == 2
    along = chains_of(surfaces, climb=(0.9, np.sqrt(0.19)))
    (chain,) = along.chains
    assert chain.steps == (1, 2, 3, 4, 5, 6)
    # The steps' own edges say which way exactly.
    np.testing.assert_allclose(chain.climbs, np.tile([1.0, 0.0], (6, 1)), atol=0.02)
    assert chains_of(surfaces, climb=(-1.0, 0.0)).chains[0].steps[0] == 8
    assert flights_of(surfaces, climb=(0.0, 1.0)) == []


@pytest.mark.parametrize("chosen", [2, 3, 4])
def test_a_forced_landing_cuts_a_flight_once(chosen):
    surfaces = [floor(), *flight(6)]
    found = chains_of(surfaces, forced={chosen: "landing"})
    assert_sound(found, surfaces)
    assert [(chain.base, chain.steps) for chain in found.chains] == [
        (0, tuple(range(1, chosen + 1))),
        (chosen, tuple(range(chosen + 1, 7))),
    ]


def test_a_forced_landing_that_is_one_anyway_changes_nothing():
    assert flights_of(with_landing(), forced={6: "landing"}) == flights_of(with_landing())


def test_a_rejected_tread_is_missing_and_a_forced_one_is_taken_whatever_its_slope():
    steep = [floor(), *flight(6)]
    steep[3] = rectangle((2 * GOING, 3 * GOING), (0.0, WIDTH), 3 * RISE, slope=(0.3, 0.0))
    (without,) = chains_of(steep).chains
    assert without.steps == (1, 2, 4, 5, 6)
    (taken,) = chains_of(steep, forced={3: "tread"}).chains
    assert taken.steps == (1, 2, 3, 4, 5, 6)
    (rejected,) = chains_of([floor(), *flight(6)], forced={3: "rejected"}).chains
    assert (rejected.steps, rejected.n_missing) == ((1, 2, 4, 5, 6), (0, 0, 1, 0, 0))


# invariance

EVERY = {
    "straight": [floor(), *flight(7)],
    "landing": with_landing(),
    "l_turn": l_turn(),
    "u_turn": u_turn(),
    "twins": twins(0.12),
    "missing": [floor(), *(tread for k, tread in enumerate(flight(8), start=1) if k != 4)],
}


@pytest.mark.parametrize("name", EVERY)
@pytest.mark.parametrize(
    "motion",
    [{"degrees": 143.0}, {"shift": (700.0, -35.0, 520.0)}, {"mirror": True}, {"degrees": -31.0, "mirror": True}],
)
def test_flights_turn_and_move_and_are_mirrored_with_the_building(name, motion):
    before, after = chains_of(EVERY[name]), chains_of(moved(EVERY[name], **motion))
    assert_same_flights(before, after, motion.get("degrees", 0.0), motion.get("shift"), motion.get("mirror", False))


def assert_same_flights(before, after, degrees=0.0, shift=None, mirror=False):
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    turn = np.array([[c, -s], [s, c]]) @ np.diag([1.0, -1.0 if mirror else 1.0])
    assert before.longest_risers == after.longest_risers
    for a, b in zip(by_steps(before), by_steps(after), strict=True):
        assert (a.base, a.steps, a.n_missing) == (b.base, b.steps, b.n_missing)
        np.testing.assert_allclose(b.climbs, a.climbs @ turn.T, atol=1e-6)
        np.testing.assert_allclose(b.middles, a.middles @ turn.T + np.array((shift or (0.0, 0.0, 0.0))[:2]), atol=1e-6)
        np.testing.assert_allclose(a.lengths_m, b.lengths_m, atol=1e-6)


def by_steps(chains):
    # Flights from one floor have no order among them.
    return sorted(chains.chains, key=lambda chain: chain.steps)


def reordered(surfaces, order):
    """The flights of the surfaces in another order, by their old numbers."""
    shuffled = chains_of([surfaces[k] for k in order])
    return {(int(order[chain.base]), tuple(order[list(chain.steps)].tolist())) for chain in shuffled.chains}


@pytest.mark.parametrize("name", EVERY)
@pytest.mark.parametrize("seed", range(3))
def test_flights_do_not_depend_on_the_order_of_surfaces_of_one_height(name, seed):
    surfaces = EVERY[name]
    heights = [surface.height_m for surface in surfaces]
    order = np.lexsort((np.random.default_rng(seed).uniform(size=len(surfaces)), heights))
    assert reordered(surfaces, order) == set(flights_of(surfaces))


def test_flights_do_not_depend_on_the_order_of_the_surfaces():
    for surfaces in EVERY.values():
        order = np.random.default_rng(0).permutation(len(surfaces))
        assert reordered(surfaces, order) == set(flights_of(surfaces))


def random_boxes(seed):
    """Level rectangles of all sizes in a small yard, at heights that are often a riser apart."""
    rng = np.random.default_rng(seed)
    surfaces = [floor((-0.3, 2.1), (-0.3, 2.1))]
    for _ in range(18):
        x, y = rng.uniform(0.0, 1.4, 2)
        size = rng.uniform(0.2, 0.7, 2)
        surfaces.append(rectangle((x, x + size[0]), (y, y + size[1]), rng.integers(1, 9) * 0.16 + rng.uniform(0, 0.03)))
    return sorted(surfaces, key=lambda surface: surface.height_m)


@pytest.mark.parametrize("seed", range(6))
def test_whatever_is_found_in_a_heap_no_step_is_used_twice(seed):
    surfaces = random_boxes(seed)
    found = chains_of(surfaces)
    assert_sound(found, surfaces)
    members = {k for chain in found.chains for k in chain.steps}
    forced = dict.fromkeys(np.random.default_rng(seed).permutation(len(surfaces))[:6].tolist(), "landing")
    assert_sound(chains_of(surfaces, forced=forced), surfaces)
    rejected = chains_of(surfaces, forced=dict.fromkeys(members, "rejected"))
    assert not members & {k for chain in rejected.chains for k in chain.steps}


# small questions


def test_no_surfaces_have_no_flights():
    found = chains_of([])
    assert (found.chains, found.notes, found.longest_risers) == ((), (), 0)


def test_depth_is_measured_along_a_direction():
    tread = rectangle((0.0, 0.28), (0.0, 1.0), 0.0)
    assert depth_along(tread, np.array([1.0, 0.0])) == pytest.approx(0.26, abs=1e-9)
    assert depth_along(tread, np.array([0.0, -1.0])) == pytest.approx(0.96, abs=0.021)


@pytest.mark.parametrize("degrees", [0.0, 30.0, 90.0, 179.0])
def test_an_angle_has_no_sign(degrees):
    a, b = np.array([1.0, 0.0]), np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])
    assert angle_deg(a, b) == pytest.approx(degrees)
    assert angle_deg(b, a) == pytest.approx(degrees)
