"""A stair goes on beyond the part that its rhythm shows: by steps beside each other, to a floor or a landing."""

import numpy as np
import pytest

from stair_inspector.geometry.lattice import Lattice
from stair_inspector.stages.reach import reach_of

RISE, GOING, WIDTH = 0.171, 0.28, 1.0
LEAN = 0.009
SPACING = 0.025


def level(x, y, height):
    """Points of a level rectangle, x and y from (low, high), metres."""
    places = np.meshgrid(*(np.arange(low + SPACING / 2.0, high, SPACING) for low, high in (x, y)))
    return np.column_stack([*(each.ravel() for each in places), np.full(places[0].size, height)])


def straight_treads(numbers=range(3)):
    """The part that is in the rhythm: along x."""
    return [level((k * GOING, (k + 1) * GOING), (-WIDTH / 2.0, WIDTH / 2.0), k * RISE) for k in numbers]


def steps_aside(n):
    """Steps that go on down from tread 0, square to the rhythm's line: along -y, step -1 first."""
    sides = [-WIDTH / 2.0 - k * GOING for k in range(n + 1)]
    return [level((-0.6, GOING), (sides[k + 1], sides[k]), -(k + 1) * RISE) for k in range(n)]


def reached(surfaces, rise=RISE, treads=(0, 1, 2)):
    """Lowest and highest reach of the stair of which ``treads`` are in a rhythm with ``rise``."""
    lattice = Lattice(
        up=np.array([0.0, 0.0, 1.0]),
        ahead=np.array([1.0, 0.0, 0.0]),
        rise_m=rise,
        going_m=GOING,
        origin=np.zeros(3),
        width_m=WIDTH,
        treads=treads,
        risers=treads,
        levels=(),
        walls=(),
        joints=2 * len(treads),
        n_points=1000,
    )
    points = np.concatenate(surfaces)
    return reach_of(points, np.ones(len(points), dtype=np.bool_), lattice)


def test_where_nothing_goes_on_the_outermost_treads_are_the_reach():
    assert reached(straight_treads()) == pytest.approx((0.0, 2.0 * RISE))


@pytest.mark.parametrize("rise", [RISE, RISE + LEAN], ids=["on the rhythm", "off the rhythm"])
def test_steps_that_turn_away_from_the_rhythms_line_are_reached_down_to_the_floor(rise):
    floor = level((-2.0, GOING), (-4.0, -WIDTH / 2.0 - 4.0 * GOING), -5.0 * RISE)
    cellar = level((-2.0, GOING), (-4.0, -2.5), -6.0 * RISE)
    low, high = reached([*straight_treads(), *steps_aside(4), floor, cellar], rise)
    assert (low, high) == pytest.approx((-5.0 * RISE, 2.0 * RISE))


def test_the_flight_behind_a_landing_is_not_reached():
    landing = level((3 * GOING, 3 * GOING + 1.2), (-WIDTH / 2.0, WIDTH / 2.0), 3.0 * RISE)
    above = [level((2.04 + k * GOING, 2.04 + (k + 1) * GOING), (-0.5, 0.5), (4 + k) * RISE) for k in range(3)]
    assert reached([*straight_treads(), landing, *above])[1] == pytest.approx(3.0 * RISE)


def test_a_surface_that_is_not_beside_the_last_step_is_not_reached():
    apart = level((0.0, GOING), (-WIDTH / 2.0 - 1.5, -WIDTH / 2.0 - 1.0), -RISE)
    assert reached([*straight_treads(), apart])[0] == pytest.approx(0.0)


def test_a_surface_two_rises_below_is_no_step():
    assert reached([*straight_treads(), *steps_aside(2)[1:]])[0] == pytest.approx(0.0)
