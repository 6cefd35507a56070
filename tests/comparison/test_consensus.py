"""The group of parts that moved as one is found among others."""

import numpy as np
import pytest

from stair_inspector.comparison.consensus import PartMotion, find_consensus


def heights(places, values, sigma=0.1, weight=1.0):
    """Parts that each tell the height a + b x + c y at a place of the plan."""
    return [
        PartMotion(np.array([[1.0, *place]]), np.array([value]), np.array([[sigma**2]]), weight)
        for place, value in zip(places, values, strict=True)
    ]


PLACES = [(x, y) for x in (0.0, 1.0, 2.0, 3.0) for y in (0.0, 1.0)]
SEEDS = [(k, m, n) for k in range(8) for m in range(k) for n in range(m)]


def test_what_moved_does_not_pull_the_motion():
    true = np.array([5.0, -2.0, 1.0])
    values = [true @ [1.0, *place] for place in PLACES]
    values[5] -= 40.0
    values[6] += 3.0
    found = find_consensus(heights(PLACES, values), SEEDS)
    assert found.motion == pytest.approx(true, abs=1e-9)
    assert found.is_steady.tolist() == [k not in (5, 6) for k in range(8)]


def test_the_covariance_is_that_of_least_squares_of_the_group():
    found = find_consensus(heights(PLACES, [0.0] * 8), SEEDS)
    rows = np.array([[1.0, *place] for place in PLACES])
    assert found.covariance == pytest.approx(0.01 * np.linalg.inv(rows.T @ rows), rel=1e-9)


def test_of_two_groups_the_heavier_one_stays():
    values = [0.0] * 4 + [9.0] * 4
    parts = heights(PLACES[:4], values[:4]) + heights(PLACES[4:], values[4:], weight=1.5)
    seeds = [(0, 1, 2), (4, 5, 6)]
    assert find_consensus(parts, seeds).is_steady.tolist() == [False] * 4 + [True] * 4
    # Nor is a motion half way between two groups one of either.
    assert find_consensus(parts, seeds).motion[0] == pytest.approx(9.0, abs=1e-6)


def test_parts_that_determine_nothing_give_none():
    assert find_consensus(heights([(0.0, 0.0), (1.0, 0.0)], [0.0, 0.0]), [(0, 1)]) is None
    assert find_consensus([], []) is None
