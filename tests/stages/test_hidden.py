"""What the steps of a flight tell about an edge that one of them hides."""

import math
from dataclasses import replace

import pytest

from stair_inspector.stages.hidden import UNSEEN_M, with_doubtful_fronts
from tests.stages.test_survey import even, line


def fronts(*sources):
    shapes = [
        replace(s, front=line(0.0, noise_m=0.001, source=source)) for s, source in zip(even(5), sources, strict=True)
    ]
    return [shape.front for shape in with_doubtful_fronts(shapes)]


def test_a_nosing_without_its_face_is_doubted_where_most_show_theirs():
    found = fronts("face", "face", "tread", "face", "tread")
    for front, source in zip(found, ("face", "face", "tread", "face", "tread"), strict=True):
        if source == "face":
            assert (front.noise_m, front.support) == (0.001, 1.0)
        else:
            assert front.noise_m == pytest.approx(math.hypot(0.001, UNSEEN_M))
            assert front.support == 0.0


def test_where_few_nosings_show_faces_the_others_are_as_good_as_their_treads():
    for front in fronts("face", "tread", "tread", "face", "tread"):
        assert (front.noise_m, front.support) == (0.001, 1.0)
