"""Edges and ends of a flight beyond which stations looked through, and those that lie in shadow."""

from dataclasses import replace
from functools import cache

import pytest

from stair_inspector.params import Params
from stair_inspector.pipeline import inspect
from tests.ray_scenes import RayStair, Rect, box, scan_of

PLACES = ((-1.4, 0.4, 1.6), (0.8, -0.8, 1.75))
WIDTH, SHORT_M = 1.1, 0.12
WALL = Rect(0, 3.2, (-1.5, 0.0), (2.5, 3.0))
"""Behind the flight: rays over its last tread end there."""
PARAMS = Params(unit="m", up="z")


def stair(*around):
    return RayStair(n_steps=5, width=WIDTH, left={3: SHORT_M}, around=around)


@cache
def measured(case, with_places=True):
    """The inspection of a flight whose third tread is shorter on the left."""
    beside = WIDTH - SHORT_M
    around = {
        "free": (WALL,),
        # It stands on the third tread's end, and hides what is beyond.
        "box": (WALL, *box((0.6, beside - 0.04, 0.53), (0.83, beside + 0.01, 0.9))),
        "nothing behind": (),
        "hidden behind": (WALL, *box((1.42, -0.1, 0.87), (1.5, 1.2, 2.4))),
    }[case]
    scan = scan_of(stair(*around).rects(), PLACES, step_deg=0.35)
    return inspect(scan if with_places else replace(scan, stations=None), PARAMS)


def codes(inspection):
    return {(note.code, note.step) for note in inspection.notes}


@pytest.mark.slow
def test_a_side_beyond_which_a_station_looked_is_the_treads_own_and_u_no_longer_holds_a_shadow():
    proved, before = measured("free"), measured("free", with_places=False)
    assert ("side_unobserved", 3) in codes(before)
    assert ("side_unobserved", 3) not in codes(proved)
    old, new = before.steps[2].width_m, proved.steps[2].width_m
    assert old.u > 0.1
    assert new.u < 0.02
    assert abs(new.value - (WIDTH - SHORT_M)) < new.u
    for k in (0, 1, 3, 4):
        assert proved.steps[k].width_m == before.steps[k].width_m


@pytest.mark.slow
def test_a_side_in_the_shadow_of_a_thing_keeps_its_u_and_the_note_names_the_station():
    (note,) = [note for note in measured("box").notes if (note.code, note.step) == ("side_unobserved", 3)]
    assert "; beyond the rim it lies in the shadow of something " in note.message
    assert "seen from station 'Top'" in note.message
    assert measured("box").steps[2].width_m.u > 0.1


@pytest.mark.parametrize(("case", "is_said"), [("free", False), ("nothing behind", True)])
def test_a_flight_ends_where_a_station_looked_through_the_place_of_the_next_riser(case, is_said):
    assert (("scan_ends", 5) in codes(measured(case))) == is_said


def test_an_end_in_shadow_is_said_to_be():
    (told,) = [note.message for note in measured("hidden behind").notes if note.code == "end_unseen"]
    assert "there may be more risers above step 5, in the shadow of something " in told
    assert "seen from station 'Foot'" in told
