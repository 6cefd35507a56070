"""Stations of which one looked through what the other saw."""

from dataclasses import replace

import numpy as np
import pytest

from stair_inspector.model import Observation
from stair_inspector.params import UncertaintyParams
from stair_inspector.stages.examine import examine, with_questions
from stair_inspector.stages.looked_through import say_looked_through
from tests.stages.test_known_stations import known, places
from tests.stages.test_stations import apart, simulated
from tests.synthetic import rotation


def said(shift_m=(0.0, 0.0, 0.0), turn=None, stood=None):
    """What is said of the two stations, the second moved and turned with its place."""
    second = places()[1] if turn is None else turn @ places()[1]
    stood = np.array([places()[0], second + shift_m]) if stood is None else stood
    scan = known(apart(shift_m, turn), simulated()[1], stood)
    examined = replace(examine(scan), observations=())
    return say_looked_through(scan, examined).observations


@pytest.mark.parametrize(
    ("shift_m", "turn"),
    [
        ((0.05, -0.12, 0.0), None),
        ((0.045, -0.052, 0.0), None),
        ((0.0, 0.0, -0.14), None),
        ((0.0, 0.0, 0.12), None),
        ((0.0, 0.0, 0.0), rotation("y", -1.1)),
        ((0.0, 0.0, 0.0), rotation("y", -0.85)),
    ],
)
def test_stations_that_lie_too_far_apart_to_be_laid_are_named_and_it_asks(shift_m, turn):
    (found,) = said(shift_m, turn)
    assert found.code == "stations_disagree"
    assert found.message.startswith(("stations 'A' and 'B' do not agree: ", "stations 'B' and 'A' do not agree: "))
    assert "--station '#1'" in found.cure
    assert "--station '#2'" in found.cure
    (asked,) = with_questions((found,), UncertaintyParams())
    assert asked.level == "question"


@pytest.mark.parametrize("shift_m", [(0.0, 0.0, 0.0), (0.002, -0.002, 0.002)])
@pytest.mark.parametrize("lean_deg", [0.0, 0.05])
def test_of_sound_stations_nothing_is_said(shift_m, lean_deg):
    assert said(shift_m, rotation("x", lean_deg)) == ()


def test_nothing_is_said_where_it_is_not_known_where_stations_stood_or_surfaces_are_double():
    shift_m = (0.0, 0.0, -0.14)
    for stood in (np.full((2, 3), np.nan), np.zeros((2, 3))):
        assert said(shift_m, stood=stood) == ()
    scan = known(apart(shift_m), simulated()[1], places())
    doubled = (Observation("surfaces_doubled", "doubt", "twice", 0.14),)
    examined = replace(examine(scan), observations=doubled)
    assert say_looked_through(scan, examined) is examined
