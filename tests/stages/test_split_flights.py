"""A strip of a whole flight that was not seen parts it in no two; two flights side by side stay two."""

import numpy as np
import pytest

from stair_inspector.params import Params
from stair_inspector.pipeline import inspect
from tests.synthetic import Stair, make_scan, rotation

STAIR = Stair(n_steps=4, risers=True, spacing=0.012, noise=0.0005, floor_depth=0.8, seed=4)
PARAMS = Params(up="z", unit="m")
LOW, HIGH = 0.5, 0.62
"""The strip, between the sides of a flight from 0 to 1.1 m."""


def sides(*places):
    """Points of the sides of a solid flight, at places across."""
    rng = np.random.default_rng(1)
    parts = []
    for k in range(1, STAIR.n_steps):
        x = rng.uniform((k - 1) * STAIR.going, k * STAIR.going, 1500)
        z = rng.uniform(k * STAIR.rise - 0.15, k * STAIR.rise, 1500)
        parts.append(np.column_stack([x, rng.choice(places, 1500), z]))
    return np.vstack(parts)


def wider_floor():
    """Points of the floor beyond both sides of the flight."""
    y = np.random.default_rng(2).choice([-0.6, STAIR.width], 9000) + np.random.default_rng(3).uniform(0.0, 0.6, 9000)
    return np.column_stack([np.random.default_rng(4).uniform(-0.8, 0.0, 9000), y, np.zeros(9000)])


POINTS = np.vstack([STAIR.sample()[0], wider_floor()])


def found(points):
    return inspect(make_scan(points @ rotation("z", 20.0).T), PARAMS)


def without_strip(points, is_floor_too):
    is_in = (points[:, 1] > LOW) & (points[:, 1] < HIGH)
    return points[~(is_in if is_floor_too else is_in & (points[:, 0] > -0.02))]


def codes(inspection):
    return {note.code for note in inspection.notes}


def test_a_strip_of_which_nothing_was_seen_belongs_to_the_flight():
    inspection = found(without_strip(POINTS, is_floor_too=True))
    assert "strip_unseen" in codes(inspection)
    assert len(inspection.flights) == 1
    assert len(inspection.steps) == STAIR.n_steps
    for step in inspection.steps:
        assert abs(step.rise_m.value - STAIR.rise) <= max(step.rise_m.u, 0.0005)
    for step in inspection.steps[:-1]:
        assert abs(step.width_m.value - STAIR.width) <= step.width_m.u < 0.02
        assert abs(step.going_m.value - STAIR.going) <= step.going_m.u < 0.01
    # What was left is of one step, not of a step and a seat beside it.
    assert [sum(patch.step_id == k for patch in inspection.patches) for k in range(1, 5)] == [2] * 4


def test_where_the_floor_goes_on_before_it_two_flights_are_told_whose_widths_may_be_that_of_one():
    inspection = found(without_strip(POINTS, is_floor_too=False))
    assert "flights_may_be_one" in codes(inspection)
    assert len(inspection.flights) == 2
    for step in inspection.steps:
        if step.width_m is not None and step.kind == "tread":
            assert abs(step.width_m.value - STAIR.width) <= step.width_m.u


@pytest.mark.parametrize("what", ["sides in the gap", "a floor of its own for each", "one a bit higher"])
def test_two_flights_side_by_side_stay_two(what):
    points = without_strip(POINTS, is_floor_too=what != "sides in the gap")
    if what == "one a bit higher":
        points[(points[:, 1] > HIGH) & (points[:, 2] > 0.05), 2] += 0.02
    elif what == "sides in the gap":
        points = np.vstack([points, sides(LOW, HIGH)])
    else:
        points = without_strip(STAIR.sample()[0], is_floor_too=True)
    inspection = found(points)
    assert len(inspection.flights) == 2
    assert codes(inspection).isdisjoint({"strip_unseen", "flights_may_be_one"})
    for step in inspection.steps:
        if step.width_m is not None and step.kind == "tread":
            assert step.width_m.u < 0.05
