"""A narrow gap through treads and risers parts two flights; one through treads alone may, which the widths hold."""

import numpy as np
import pytest

from stair_inspector.params import Params
from stair_inspector.pipeline import inspect
from tests.synthetic import Stair, make_scan, rotation

WIDE = Stair(n_steps=4, width=2.2, risers=True, spacing=0.011, noise=0.001, floor_depth=0.8, seed=4)
LOW, HIGH = 1.0, 1.02
POINTS = WIDE.sample()[0]
PARAMS = Params(up="z", unit="m")


def found(is_open):
    points = POINTS[~is_open]
    return inspect(make_scan(points @ rotation("z", 20.0).T), PARAMS)


def in_gap(low=LOW, high=HIGH):
    return (POINTS[:, 1] > low) & (POINTS[:, 1] < high)


def on_treads():
    x, _, z = POINTS.T
    return (np.abs(z - np.rint(z / WIDE.rise) * WIDE.rise) < 0.006) & (x > -0.004) & (z > 0.1)


def codes(inspection):
    return {note.code for note in inspection.notes}


def widths(inspection):
    return [step.width_m for step in inspection.steps if step.kind == "tread"]


@pytest.mark.parametrize("gap_m", [0.018, 0.028])
def test_two_flights_with_a_narrow_gap_are_two(gap_m):
    inspection = found(in_gap(HIGH - gap_m, HIGH))
    assert [flight.n_risers for flight in inspection.flights] == [4, 4]
    assert codes(inspection).isdisjoint({"flights_may_be_two", "flights_may_be_one", "strip_unseen"})
    found_m = sorted((flight.width_m.value, flight.width_m.u) for flight in inspection.flights)
    for (width_m, u_m), truth_m in zip(found_m, (HIGH - gap_m, WIDE.width - HIGH), strict=True):
        assert abs(width_m - truth_m) <= u_m < 0.005


def test_a_joint_in_the_treads_alone_is_said_and_the_widths_hold_either_part():
    inspection = found(in_gap() & on_treads())
    assert "flights_may_be_two" in codes(inspection)
    assert len(inspection.flights) == 1
    for width in widths(inspection):
        assert abs(width.value - WIDE.width) < 0.01
        assert all(abs(width.value - part) <= width.u for part in (LOW, WIDE.width - HIGH))


def test_a_runner_beside_such_a_joint_leaves_the_widths_as_uncertain():
    points, on, carpet_m = POINTS.copy(), in_gap(1.3, 1.9), 0.01
    points[on & on_treads(), 2] += carpet_m
    points[on & ~on_treads() & (POINTS[:, 0] > -0.02) & (POINTS[:, 2] > 0.01), 0] -= carpet_m
    inspection = inspect(make_scan(points[~(in_gap() & on_treads())] @ rotation("z", 20.0).T), PARAMS)
    assert {"flights_may_be_two", "runner"} <= codes(inspection)
    assert widths(inspection)
    for width in widths(inspection):
        assert all(abs(width.value - part) <= width.u for part in (LOW, WIDE.width - HIGH))


def test_a_joint_that_one_tread_lacks_is_no_gap_between_flights():
    inspection = found(in_gap() & ~((np.abs(POINTS[:, 2] - 2 * WIDE.rise) < 0.02) & on_treads()))
    assert "flights_may_be_two" not in codes(inspection)
    (flight,) = inspection.flights
    assert abs(flight.width_m.value - WIDE.width) <= flight.width_m.u < 0.005


def test_joints_between_several_planks_are_none_either():
    planks = in_gap() | in_gap(0.5, 0.52) | in_gap(1.6, 1.62)
    inspection = found(planks & on_treads())
    assert "flights_may_be_two" not in codes(inspection)
    assert len(inspection.flights) == 1


def test_a_narrow_strip_of_flight_and_floor_that_was_not_seen_belongs_to_the_flight():
    floor = np.random.default_rng(2).uniform([-0.8, -0.6], [0.0, 2.8], (20000, 2))
    floor = floor[(floor[:, 1] < 0.0) | (floor[:, 1] > WIDE.width)]
    points = np.vstack([POINTS[~in_gap()], np.column_stack([floor, np.zeros(len(floor))])])
    inspection = inspect(make_scan(points @ rotation("z", 20.0).T), PARAMS)
    assert "strip_unseen" in codes(inspection)
    (flight,) = inspection.flights
    assert abs(flight.width_m.value - WIDE.width) <= flight.width_m.u < 0.005
