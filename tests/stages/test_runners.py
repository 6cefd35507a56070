"""A runner of carpet: the stair under it is measured, where it is bare."""

import functools

import numpy as np
import pytest

from stair_inspector.codes import check
from stair_inspector.files.rule_sets import find_rule_set
from stair_inspector.params import Params
from stair_inspector.pipeline import inspect
from tests.synthetic import make_scan, rotation

RISE, GOING, WIDTH, N_STEPS = 0.17, 0.28, 1.1, 4
PARAMS = Params(up="z", unit="m")
DENSITY = 9000


def patch(rng, low, high):
    """Points spread evenly over an axis-parallel rectangle of space, one of whose sides is none."""
    sides = np.sort(np.array(high) - np.array(low))[1:]
    return rng.uniform(low, high, (round(float(np.prod(sides)) * DENSITY), 3))


def stair_with_runner(low, high, thick, seed, landing=0.3, last=N_STEPS):
    """Points of a stair along x with a runner between two places across, up to a step; on a landing for so far."""
    rng = np.random.default_rng(seed)
    parts = [patch(rng, (-0.9, -0.3, 0.0), (0.0, WIDTH + 0.3, 0.0))]
    strips = [(0.0, low, 0.0), (low, high, thick), (high, WIDTH, 0.0)]
    for k in range(1, N_STEPS + 1):
        front, back = (k - 1) * GOING, k * GOING if k < N_STEPS else k * GOING + 0.8
        for start, stop, carpet in strips:
            if stop <= start:
                continue
            above = carpet if k <= last else 0.0
            end = front + landing if k == N_STEPS and above else back
            # Its riser's face stands before the bare one, and begins on the carpet of the tread below.
            bottom = (k - 1) * RISE + (carpet if 1 < k <= last + 1 else 0.0)
            parts.append(patch(rng, (front - above, start, bottom), (front - above, stop, k * RISE + above)))
            parts.append(patch(rng, (front - above, start, k * RISE + above), (end - above, stop, k * RISE + above)))
            if end < back:
                parts.append(patch(rng, (end, start, k * RISE), (back, stop, k * RISE)))
    points = np.concatenate(parts)
    return points + rng.normal(0.0, 0.0007, points.shape)


@functools.lru_cache(maxsize=8)
def found(low, high, thick, seed=1):
    points = stair_with_runner(low, high, thick, seed)
    return inspect(make_scan(points @ rotation("z", 20.0).T), PARAMS)


def codes(inspection):
    return {note.code for note in inspection.notes}


RUNNERS = [
    pytest.param(0.2, 0.9, 0.009, id="9 mm, in the middle"),
    pytest.param(0.2, 0.9, 0.006, id="6 mm, in the middle"),
    pytest.param(0.1, 1.0, 0.012, id="12 mm, 100 mm bare"),
    pytest.param(0.2, 0.9, 0.018, id="18 mm, surfaces of their own"),
    pytest.param(0.3, 0.9, 0.025, id="25 mm, surfaces of their own"),
]


@pytest.mark.parametrize(("low", "high", "thick"), RUNNERS)
def test_rises_goings_and_widths_are_those_of_the_stair_under_the_runner(low, high, thick):
    inspection = found(low, high, thick)
    assert len(inspection.steps) == N_STEPS
    assert "runner" in codes(inspection)
    for step in inspection.steps:
        assert abs(step.rise_m.value - RISE) < 0.0007
        assert step.rise_m.u < 0.002
    for step in inspection.steps[:-1]:
        assert abs(step.going_m.value - GOING) < 0.0015
        assert step.going_m.u < 0.005
        assert abs(step.width_m.value - WIDTH) <= step.width_m.u < 0.015


def test_what_lies_on_the_runner_belongs_to_its_step_and_covers_it():
    inspection = found(0.2, 0.9, 0.009)
    assert [sum(patch.step_id == k for patch in inspection.patches) for k in range(1, N_STEPS + 1)] == [2] * N_STEPS
    assert all(step.coverage > 0.9 for step in inspection.steps)
    assert "nosing_unobserved" not in codes(inspection)


def test_a_runner_that_ends_at_the_landings_nosing_leaves_the_landing_as_it_is():
    points = stair_with_runner(0.2, 0.9, 0.009, 4, landing=0.0)
    inspection = inspect(make_scan(points), PARAMS)
    assert "runner" in codes(inspection)
    assert len(inspection.steps) == N_STEPS
    for step in inspection.steps:
        assert abs(step.rise_m.value - RISE) < 0.0007
    for step in inspection.steps[:-1]:
        assert abs(step.going_m.value - GOING) < 0.0015


UNCLEAR = [
    pytest.param({"low": 0.1, "high": WIDTH, "thick": 0.009}, 1, id="100 mm bare on one side"),
    pytest.param({"low": 0.5, "high": WIDTH, "thick": 0.009}, 1, id="half of it bare on one side"),
    pytest.param({"low": 0.03, "high": 1.07, "thick": 0.009}, 1, id="hardly anything bare"),
    pytest.param({"low": 0.2, "high": 0.9, "thick": 0.009, "last": 2}, 1, id="on the lower treads alone"),
    pytest.param({"low": 0.2, "high": 0.9, "thick": 0.009}, 4, id="few points"),
    pytest.param({"low": 0.06, "high": 1.04, "thick": 0.018}, 1, id="18 mm, 60 mm bare"),
]


@pytest.mark.parametrize(("runner", "thinned"), UNCLEAR)
def test_where_some_edges_may_be_the_carpets_u_holds_its_thickness(runner, thinned):
    inspection = inspect(make_scan(stair_with_runner(seed=5, **runner)[::thinned]), PARAMS)
    assert "runner" not in codes(inspection)
    assert "two_levels" in codes(inspection)
    assert len(inspection.steps) == N_STEPS
    for step in inspection.steps:
        assert abs(step.rise_m.value - RISE) <= step.rise_m.u
        assert dict(step.rise_m.parts)["layers"] >= 0.009
    for step in inspection.steps[:-1]:
        assert abs(step.going_m.value - GOING) <= step.going_m.u
        assert dict(step.going_m.parts)["layers"] >= 0.009
        assert abs(step.width_m.value - WIDTH) <= step.width_m.u


def test_carpet_from_side_to_side_is_the_tread_and_hardly_narrower_is_told():
    inspection = found(0.03, 1.07, 0.009)
    assert len(inspection.steps) == N_STEPS
    assert "two_levels" in codes(inspection)
    assert {"runner", "two_levels"}.isdisjoint(codes(found(0.0, WIDTH, 0.009)))


@pytest.mark.parametrize("low", [0.2, 0.03])
def test_a_check_says_that_a_runner_lies_on_the_stair(low):
    checked = check(found(low, WIDTH - low, 0.009), find_rule_set("us-irc-2024"))
    assert any("as a runner of carpet, lies along the flight" in words for words in checked.notes)


def test_a_mat_on_one_tread_is_no_runner():
    points = stair_with_runner(0.0, 0.0, 0.0, 2)
    x, y, z = points.T
    is_on = (np.abs(z - 2 * RISE) < 0.005) & (x > GOING) & (x < 2 * GOING) & (y > 0.3) & (y < 0.8)
    inspection = inspect(make_scan(points + np.outer(is_on, [0.0, 0.0, 0.009])), PARAMS)
    assert len(inspection.steps) == N_STEPS
    assert {"runner", "two_levels"}.isdisjoint(codes(inspection))


def test_where_thick_carpet_is_the_treads_the_landing_behind_it_is_said_and_the_scan_does_not_end():
    inspection = found(0.0, WIDTH, 0.02)
    assert "scan_ends" not in codes(inspection)
    (note,) = [note for note in inspection.notes if note.code == "two_levels"]
    assert "behind which a level surface goes on 20 mm lower" in note.message
    assert note.step == N_STEPS
