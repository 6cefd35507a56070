"""What was looked through and what lies in shadow, of stations whose rays are known."""

from functools import cache

import numpy as np
import pytest

from stair_inspector.geometry.sight import Sight
from tests.ray_scenes import Rect, box, seen
from tests.synthetic import rotation

WALL = Rect(0, 3.0, (-3.0, -2.0), (3.0, 2.0))
PLACES = np.array([[0.0, 0.0, 0.0], [0.0, 1.5, 0.0]])


@cache
def sight():
    """Two stations before a wall, and a box before it that takes the first one's view of some of it."""
    points, of_point = seen((WALL, *box((1.5, -0.3, -0.3), (1.8, 0.3, 0.3))), PLACES, step_deg=0.25)
    ways = [points[of_point == k] - PLACES[k] for k in range(2)]
    ranges = [np.linalg.norm(way, axis=1) for way in ways]
    rays = [way / far[:, None] for way, far in zip(ways, ranges, strict=True)]
    return Sight(("A", "B"), PLACES, tuple(rays), tuple(ranges))


def row(x, y):
    """Places along a row, square to the view of the first station."""
    return np.column_stack([np.full(9, x), np.full(9, y), np.linspace(-0.1, 0.1, 9)])


def test_a_place_before_a_surface_was_looked_through_and_one_on_it_or_behind_it_was_not():
    assert sight().look(row(2.5, 1.2)).is_free
    for x in (3.0, 2.98, 3.4):
        assert not sight().look(row(x, 1.2)).is_through.any()


def test_a_place_behind_a_box_is_in_its_shadow_unless_another_station_looked_through_it():
    both = sight().look(row(2.6, 0.0))
    assert both.is_free
    assert both.shadow_m[0] == pytest.approx(np.full(9, 1.1), abs=0.05)
    assert np.isnan(both.shadow_m[1]).all()
    first = Sight(("A",), PLACES[:1], sight().rays[:1], sight().ranges_m[:1])
    alone = first.look(row(2.6, 0.0))
    assert not alone.is_through.any()
    assert first.words(alone) == "in the shadow of something 1.1 m in front of it, seen from station 'A'"


def test_nothing_is_told_where_no_rays_came_back():
    looks = sight().look(np.array([[-2.0, 0.0, 0.0], [0.0, 0.0, 2.9]]))
    assert not looks.is_through.any()
    assert np.isnan(looks.shadow_m).all()
    assert sight().words(looks) == ""


def test_places_may_be_asked_in_another_frame():
    turn = rotation("z", 37.0)
    turned = sight().in_frame(turn).look(row(2.5, 1.2) @ turn.T)
    assert np.array_equal(turned.is_through, sight().look(row(2.5, 1.2)).is_through)
