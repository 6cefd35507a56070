"""The nosing line is the least squares line of known nosings, and a raised nosing lies off it by as much."""

import dataclasses

import numpy as np
import pytest

from stair_inspector.model import Measured
from stair_inspector.pictures.nosing_line import is_joined, line_over_nosings, nosing_line
from tests.content.staircases import UP, U, staircase
from tests.synthetic import rotation


def exact(count, bumps=None):
    """A flight of equal rises and goings, but that nosing k stands ``bumps[k]`` metres higher."""
    inspection = staircase((count,))
    bumps = bumps or {}
    steps = []
    for step in inspection.steps:
        k = step.step_id
        rise = 0.17 + bumps.get(k, 0.0) - bumps.get(k - 1, 0.0)
        going = None if step.going_m is None else Measured(0.28, U, step.going_m.parts)
        steps.append(dataclasses.replace(step, rise_m=Measured(rise, U, step.rise_m.parts), going_m=going))
    return dataclasses.replace(inspection, steps=tuple(steps))


def test_an_even_flight_lies_on_its_line():
    inspection = exact(9)
    line = nosing_line(inspection, inspection.flights[0])
    np.testing.assert_allclose(line.deviations_m, 0.0, atol=1e-12)
    assert line.pitch_deg == pytest.approx(np.degrees(np.arctan2(0.17, 0.28)), abs=1e-9)


def test_a_raised_nosing_stands_out_by_as_much_square_to_the_line():
    bump = 0.004
    inspection = exact(41, {21: bump})
    line = nosing_line(inspection, inspection.flights[0])
    square = bump * np.cos(np.arctan2(0.17, 0.28))
    # The line itself takes a share of 1/n, and none of its slope: the raised nosing is the middle one.
    assert line.deviations_m[20] == pytest.approx(square * (1.0 - 1.0 / 41.0), rel=1e-6)
    np.testing.assert_allclose(np.delete(line.deviations_m, 20), -square / 41.0, rtol=1e-6)


def test_it_is_the_least_squares_line_of_the_nosings():
    inspection = staircase((12,))
    line = nosing_line(inspection, inspection.flights[0])
    goings = [step.going_m.value for step in inspection.steps[:-1]]
    rises = [step.rise_m.value for step in inspection.steps[1:]]
    run, height = np.append(0.0, np.cumsum(goings)), np.append(0.0, np.cumsum(rises))
    slope, start = np.polyfit(run, height, 1)
    np.testing.assert_allclose(line.deviations_m, (height - slope * run - start) * np.cos(np.arctan(slope)), atol=1e-12)
    assert line.pitch_deg == pytest.approx(np.degrees(np.arctan(slope)))


def test_a_nosing_is_as_uncertain_as_noise_and_edge_make_one_end_of_rise_and_going():
    inspection = exact(5)
    line = nosing_line(inspection, inspection.flights[0])
    pitch = np.arctan2(0.17, 0.28)
    noise, edge = 0.0003, 0.0002
    expected = np.hypot(noise * np.cos(pitch), np.hypot(noise, edge) * np.sin(pitch)) / np.sqrt(2.0)
    np.testing.assert_allclose(line.u_m[:-1], expected, rtol=1e-9)


@pytest.mark.parametrize("turn", [np.eye(3), rotation("x", 75.0) @ rotation("y", -40.0)])
def test_where_a_value_is_missing_the_nosings_own_places_tell_the_way(turn):
    full = staircase((6,), rotation=turn)
    holed = staircase((6,), rotation=turn, missing_rise=(4,), missing_going=(3,))
    line = line_over_nosings(holed.steps, holed.up.vector)
    wanted = line_over_nosings(full.steps, full.up.vector)
    np.testing.assert_allclose(line.runs_m, wanted.runs_m, atol=1e-9)
    np.testing.assert_allclose(line.heights_m, wanted.heights_m, atol=1e-9)
    assert line.has_going == (False, True, True, False, True, True)
    assert line.has_rise == (False, True, True, False, True, True)


def test_a_step_without_a_nosing_leaves_no_line():
    inspection = staircase((5,))
    steps = [dataclasses.replace(inspection.steps[2], line_points=None)]
    blind = dataclasses.replace(inspection, steps=(*inspection.steps[:2], *steps, *inspection.steps[3:]))
    assert nosing_line(blind, blind.flights[0]) is None
    assert nosing_line(staircase((2,)), staircase((2,)).flights[0]) is None


def test_flights_are_joined_by_a_landing_at_the_foot_of_the_next():
    inspection = staircase((5, 5), (0.0, 90.0))
    landing, above = inspection.steps[4], inspection.steps[5]
    assert is_joined(landing, above, UP)
    assert is_joined(inspection.steps[0], inspection.steps[1], UP)
    higher = dataclasses.replace(above, line_points=above.line_points + 0.5 * UP)
    assert not is_joined(landing, higher, UP)
    assert not is_joined(dataclasses.replace(landing, kind="tread"), above, UP)
    assert not is_joined(landing, dataclasses.replace(above, rise_m=None), UP)
