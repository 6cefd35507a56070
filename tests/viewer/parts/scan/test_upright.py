"""Up from three picked points, or from the treads."""

import dataclasses

import numpy as np
import pytest

from stair_inspector.errors import ConfigError
from stair_inspector.viewer.parts.scan.upright import up_of_points, up_of_treads
from tests.synthetic import rotation
from tests.viewer.surveyed import surveyed

FLOOR = np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.5, 1.5, 0.0]])


@pytest.mark.parametrize("order", [[0, 1, 2], [2, 1, 0], [1, 0, 2]])
def test_three_points_give_the_normal_of_their_plane_on_the_side_of_the_present_up(order):
    turn = rotation("x", 7.0) @ rotation("y", -3.0)
    points = 1e5 + FLOOR[order] @ turn.T
    up = up_of_points(points, np.array([0.1, 0.1, 1.0]))
    assert up == pytest.approx(turn @ [0.0, 0.0, 1.0], abs=1e-9)
    assert up_of_points(points, np.array([0.0, 0.0, -1.0])) == pytest.approx(-up)


@pytest.mark.parametrize(
    "points",
    [
        np.zeros((3, 3)),
        FLOOR[[0, 1, 1]],
        np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.01, 0.0]]),
        0.01 * FLOOR,
    ],
)
def test_points_that_say_nothing_are_a_sentence(points):
    with pytest.raises(ConfigError, match="too near to each other or to one line"):
        up_of_points(points, np.array([0.0, 0.0, 1.0]))


def test_the_treads_give_their_common_normal():
    turn = rotation("x", 4.0)
    _, inspection, _ = surveyed(turn)
    assert up_of_treads(inspection) == pytest.approx(turn @ [0.0, 0.0, 1.0], abs=2e-3)


def test_without_treads_there_is_a_sentence():
    _, inspection, _ = surveyed()
    with pytest.raises(ConfigError, match="no treads were found"):
        up_of_treads(dataclasses.replace(inspection, steps=()))
