"""Stations that lie apart along the treads, which only the sides of these show."""

from dataclasses import replace

import pytest

from stair_inspector.params import Params
from stair_inspector.pipeline import inspect
from tests.ray_scenes import RayStair, box, scan_of

PLACES = ((-1.5, -0.3, 1.6), (0.8, 1.5, 1.9))
WIDTH = 1.1
PARAMS = Params(unit="m", up="z")


def measured(shift_m, around=(), places=PLACES):
    """The inspection of a flight whose second station lies so far aside with all that it saw, and its notes of that."""
    scan = scan_of(RayStair(n_steps=4, width=WIDTH, around=around).rects(), places, step_deg=0.6)
    is_second = scan.stations.of_point == 1
    points, places_m = scan.points.copy(), scan.stations.places_m.copy()
    points[is_second, 1] += shift_m
    places_m[1, 1] += shift_m
    found = inspect(replace(scan, points=points, stations=replace(scan.stations, places_m=places_m)), PARAMS)
    return found, [note.message for note in found.notes if note.code == "stations_aside"]


@pytest.mark.parametrize("shift_m", [0.06, -0.03])
def test_u_of_the_widths_holds_a_shift_along_the_treads_and_a_note_names_the_stations(shift_m):
    found, (said,) = measured(shift_m)
    assert {"'Foot'", "'Top'"} <= set(said.split())
    apart_mm = float(said.partition("treads ")[2].split()[0])
    assert apart_mm == pytest.approx(abs(shift_m) * 1000.0, abs=12.0)
    widths = [step.width_m for step in found.steps]
    assert all(width.u > max(abs(width.value - WIDTH), 0.8 * abs(shift_m)) for width in widths)


def test_stations_that_lie_where_the_file_has_them_leave_u_of_the_widths_as_it_is():
    found, said = measured(0.0)
    assert not said
    assert all(not dict(step.width_m.parts).get("layers") for step in found.steps)


def test_what_two_boards_hide_each_from_the_station_on_its_side_is_no_shift():
    boards = [
        face
        for k in range(4)
        for y in (-0.021, WIDTH + 0.001)
        for face in box((0.28 * k - 0.02, y, 0.0), (0.28 * k + 0.26, y + 0.02, 0.17 * k + 0.47))
    ]
    found, said = measured(0.0, tuple(boards), ((-1.5, -0.3, 1.6), (-1.5, 1.4, 1.6)))
    assert len(found.steps) == 4
    assert not said
