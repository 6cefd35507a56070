"""Steps that a camera saw from too far and too flat are not measured; those it saw well are."""

from dataclasses import replace

import numpy as np
import pytest

from stair_inspector.model import Examination, LocalPlane
from stair_inspector.params import FlightsParams
from stair_inspector.stages.blurred import find_blurred
from stair_inspector.stages.impossible import take_out_impossible
from tests.stages.test_survey import GOING, RISE, even, line, shape, survey_of


def seen(distance_m, height_m, sigma_m=0.001, spacing_m=0.01, source="tread"):
    """One step as a camera at the origin sees it, so far before and so high above it."""
    plane = LocalPlane(-height_m, (0.0, 0.0), np.zeros((3, 3)), sigma_m, spacing_m, 0.0, 500)
    return shape(1, (distance_m, 0.0), -height_m, plane=plane, front=line(0.0, source=source))


@pytest.mark.parametrize(
    ("distance_m", "height_m", "sigma_m", "spacing_m", "source", "is_blurred"),
    [
        (1.5, 1.2, 0.002, 0.01, "tread", False),
        (3.5, 1.2, 0.003, 0.02, "tread", False),
        # The same noise seen under four degrees is 40 mm along the climb.
        (3.5, 0.25, 0.003, 0.02, "tread", True),
        # A nosing whose own face was seen lies where that is,
        (3.5, 0.25, 0.003, 0.005, "face", False),
        # but not if the tread has three rows of points.
        (3.5, 0.25, 0.001, 0.03, "face", True),
    ],
)
def test_noise_and_rows_along_the_climb_decide(distance_m, height_m, sigma_m, spacing_m, source, is_blurred):
    found = find_blurred([[seen(distance_m, height_m, sigma_m, spacing_m, source)]])
    assert list(found) == ([1] if is_blurred else [])


def test_what_is_said_names_the_view_and_the_cure():
    message = find_blurred([[seen(3.5, 0.25, 0.003, 0.02)]])[1]
    assert message.startswith("step 1 was seen from 3.7 m away, under 4° to its tread: along the climb its points")
    assert message.endswith("nothing is measured from its nosing; scan it from nearer or from higher up")


def blurred_second(n=4):
    """A flight far below a camera that sees its second step badly."""
    steps = even(n)
    steps = [replace(step, plane=replace(step.plane, z0_m=step.plane.z0_m - 2.0)) for step in steps]
    steps[0] = replace(steps[0], foot=replace(steps[0].foot, z0_m=-2.0))
    bad = replace(steps[1].plane, sigma_m=0.2)
    steps[1] = replace(steps[1], plane=bad, front=replace(steps[1].front, source="tread"))
    return steps


def test_a_blurred_step_gives_no_value_and_none_to_its_neighbours():
    steps = blurred_second()
    survey = survey_of(steps)
    view = Examination((), np.zeros(3), is_view=True)
    found = take_out_impossible(survey, FlightsParams(), [steps], view)
    assert [step.rise_m is None for step in found.steps] == [False, True, True, False]
    assert [step.going_m is None for step in found.steps] == [True, True, False, True]
    assert found.steps[0].rise_m.value == pytest.approx(RISE)
    assert found.steps[2].going_m.value == pytest.approx(GOING)
    assert [(note.code, note.step) for note in found.notes if note.code == "step_blurred"] == [("step_blurred", 2)]
    # No scanner on a tripod stands at the origin and sees all ways.
    assert take_out_impossible(survey, FlightsParams(), [steps], Examination((), np.zeros(3))) is survey
