"""Which way two surfaces face each other, and what a direction given by the inspector says where they do not tell."""

import numpy as np
import pytest

from stair_inspector.geometry.plan import angle_deg
from stair_inspector.params import FlightsParams
from stair_inspector.stages.flights import find_chains
from stair_inspector.stages.links import find_links
from stair_inspector.stages.rejects import Forced
from tests.stages.rectangles import GOING, RISE, WIDTH, flight, floor, moved, patches_of, rectangle, surface_of

EAST, NORTH = np.array([1.0, 0.0]), np.array([0.0, 1.0])


def links_of(surfaces, given=None):
    return find_links(patches_of(surfaces), FlightsParams(), [True] * len(surfaces), given)


def plinth(n=4):
    """Square plates on top of each other, each seen as a frame around the next: one can climb it from four sides."""
    surfaces = []
    for k in range(n):
        half = 1.0 + (n - 1 - k) * GOING
        plate = rectangle((-half, half), (-half, half), k * RISE)
        inner = half - GOING
        x, y = np.abs(plate.cells_m)
        surfaces.append(surface_of(plate.cells_m[:, (x > inner) | (y > inner)], k * RISE) if k < n - 1 else plate)
    return surfaces


@pytest.mark.parametrize("way", [EAST, -EAST, NORTH, -NORTH, np.array([0.94, 0.34])])
def test_a_plinth_is_climbed_from_the_side_that_is_given(way):
    (chain,) = find_chains(patches_of(plinth(5)), FlightsParams(), 0.03, Forced({}, way)).chains
    # The direction of measurement is that of the plinth's own edges.
    own = np.round(way)
    np.testing.assert_allclose(chain.climbs, np.tile(own, (len(chain.climbs), 1)), atol=0.02)
    # Its front edges lie on the side from which one comes.
    assert (chain.middles @ own < -0.9).all()
    assert chain.n_missing == (0,) * len(chain.steps)


def test_an_edge_without_a_direction_gets_the_one_that_is_given():
    # A block on a floor that is seen below it, as through a grating: nothing says from where one climbs it.
    surfaces = [floor((-2.0, 2.0), (-2.0, 2.0)), rectangle((-0.5, 0.5), (-0.4, 0.4), RISE)]
    (unclear,) = links_of(surfaces)
    assert unclear.climb is None
    for way in (EAST, -EAST, NORTH):
        (link,) = links_of(surfaces, way)
        np.testing.assert_allclose(link.climb, way, atol=1e-9)
        half = 0.5 if way is not NORTH else 0.4
        assert link.middle @ way == pytest.approx(-half, abs=0.03)
        # But for the outermost cells.
        assert link.length_m == pytest.approx(2.0 * (0.9 - half), abs=0.07)


@pytest.mark.parametrize(("degrees", "is_taken"), [(0.0, True), (44.0, True), (-44.0, True), (46.0, False)])
def test_a_flight_within_45_degrees_keeps_its_own_direction(degrees, is_taken):
    way = np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])
    chains = find_chains(patches_of([floor(), *flight(5)]), FlightsParams(), 0.03, Forced({}, way)).chains
    assert len(chains) == is_taken
    if is_taken:
        assert (chains[0].base, chains[0].steps) == (0, (1, 2, 3, 4, 5))
        assert max(angle_deg(climb, EAST) for climb in chains[0].climbs) < 2.0


def test_a_direction_that_fits_changes_no_edge():
    surfaces = moved([floor(), *flight(6)], 30.0)
    way = np.array([np.cos(np.radians(30.0)), np.sin(np.radians(30.0))])
    for before, after in zip(links_of(surfaces), links_of(surfaces, way), strict=True):
        assert (before.lower, before.upper) == (after.lower, after.upper)
        assert angle_deg(before.climb, after.climb) < 2.0
        np.testing.assert_allclose(after.middle, before.middle, atol=0.02)
        assert after.length_m == pytest.approx(before.length_m, abs=0.05)


def test_a_short_edge_makes_a_link_that_is_known_as_short():
    (link,) = links_of([rectangle((0.0, GOING), (0.0, WIDTH), 0.0), rectangle((GOING, 2 * GOING), (0.84, 1.9), RISE)])
    assert 0.1 <= link.length_m < 0.2


@pytest.mark.parametrize("way", [NORTH, -NORTH])
def test_a_climb_square_to_a_flight_finds_nothing_in_it(way):
    # Each tread is wider than the one below: its ends lie ahead of that one, but of no cell there is the nearest ahead.
    treads = [
        rectangle((k * GOING, (k + 1) * GOING), (-0.08 * k, WIDTH + 0.08 * k), (k + 1) * RISE, k) for k in range(6)
    ]
    for surfaces in ([floor(), *flight(6)], [floor(), *treads]):
        assert find_chains(patches_of(surfaces), FlightsParams(), 0.03, Forced({}, way)).chains == ()


@pytest.mark.parametrize("way", [EAST, -EAST, NORTH, -NORTH])
def test_of_a_stair_that_comes_back_the_flight_along_the_climb_is_found(way):
    landing = rectangle((5 * GOING, 5 * GOING + 1.0), (0.0, 2.1), 6 * RISE)
    upper = moved(flight(5), 180.0, (5 * GOING, 2.1, 6 * RISE))
    surfaces = [floor(), *flight(5), landing, *upper]
    chains = find_chains(patches_of(surfaces), FlightsParams(), 0.03, Forced({}, way)).chains
    expected = [(1, 2, 3, 4, 5, 6)] if way is EAST else [(7, 8, 9, 10, 11)] if np.array_equal(way, -EAST) else []
    assert [chain.steps for chain in chains] == expected
