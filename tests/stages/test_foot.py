"""Where a flight begins: behind a strip of floor that the scan cuts off, and on a tread that shows its own front."""

from dataclasses import replace

import numpy as np
import pytest

from stair_inspector.overrules import OverrulesParams
from stair_inspector.pipeline import inspect
from tests.synthetic import Stair, exact_params, make_scan

PARAMS = exact_params()
STAIR = Stair(n_steps=5, risers=True, floor_depth=0.24, noise=0.0005)
"""Of the floor as much is left as a tread is deep."""


def measured(stair=STAIR, keep=lambda points: np.ones(len(points), dtype=bool), **changes):
    points, normals = stair.sample()
    kept = keep(points)
    inspection = inspect(make_scan(points[kept], normals[kept]), replace(PARAMS, **changes))
    (flight,) = inspection.flights
    return inspection, flight, [note.message for note in inspection.notes if note.code == "foot_unclear"]


@pytest.mark.parametrize("depth", [0.12, 0.24, 0.4])
def test_a_strip_of_floor_is_what_the_first_riser_stands_on(depth):
    inspection, flight, notes = measured(replace(STAIR, floor_depth=depth))
    assert (len(inspection.steps), flight.n_risers) == (5, 5)
    first = inspection.steps[0].rise_m
    assert abs(first.value - STAIR.rise) <= first.u
    assert all(abs(step.going_m.value - STAIR.going) <= step.going_m.u for step in inspection.steps[:-1])
    (note,) = notes
    assert "flight 1, at 0.000 m, has nothing under its front" in note
    assert "if it is a tread, the flight goes on below" in note


def test_a_strip_that_slants_in_front_is_one_too():
    slanting = lambda points: (points[:, 2] > 0.08) | (points[:, 0] > -0.2 + 0.15 * points[:, 1])  # noqa: E731
    inspection, _, notes = measured(keep=slanting)
    assert (len(inspection.steps), len(notes)) == (5, 1)


def test_a_tread_with_its_riser_under_it_stays_one():
    # Without the floor, and of the first riser only the upper half.
    inspection, flight, notes = measured(keep=lambda points: points[:, 2] > STAIR.rise / 2.0)
    assert (len(inspection.steps), flight.n_risers, notes) == (5, 4, [])
    assert inspection.steps[0].rise_m is None


def test_where_no_riser_is_seen_none_is_missed():
    inspection, _, notes = measured(replace(STAIR, risers=False), lambda points: points[:, 0] > 0.0)
    assert (len(inspection.steps), notes) == (5, [])


def test_what_the_user_calls_a_tread_is_one():
    forced = OverrulesParams(force="at:-0.1,0.5,0=tread")
    inspection, _, notes = measured(overrules=forced)
    assert (len(inspection.steps), notes) == (6, [])


def test_a_floor_that_is_seen_is_no_matter():
    inspection, _, notes = measured(replace(STAIR, floor_depth=1.2))
    assert (len(inspection.steps), notes) == (5, [])
