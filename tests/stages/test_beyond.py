"""What is seen of a flight beyond its measured steps: rows of risers at its rhythm, and nothing where it has ended."""

from dataclasses import replace

import numpy as np
import pytest

from stair_inspector.pipeline import inspect
from tests.curves import Curve
from tests.synthetic import Stair, exact_params, make_scan

PARAMS = exact_params()
STAIR = Stair(n_steps=10, spacing=0.012, risers=True, noise=0.001)


def seen_from_the_foot(stair, n_treads, n_risers=None):
    """The stair without the treads above the first few, and without the risers above some."""
    points, normals = stair.sample()
    parts = [len(points) for points, _ in stair.parts()]
    kind = np.repeat(np.arange(len(parts)), parts)
    # Part 0 is the floor, then the treads, then the risers.
    n = stair.n_steps
    is_seen = (kind <= n_treads) | ((kind > n) & (kind <= n + (n if n_risers is None else n_risers)))
    return points[is_seen], normals[is_seen]


def found(points, normals, params=PARAMS):
    inspection = inspect(make_scan(points, normals), params)
    (flight,) = inspection.flights
    return flight, [note.message for note in inspection.notes if note.code == "goes_on"], inspection


@pytest.mark.parametrize("n_risers", [10, 6])
def test_risers_whose_treads_are_hidden_are_counted(n_risers):
    flight, notes, _ = found(*seen_from_the_foot(STAIR, 4, n_risers))
    assert flight.n_risers == 4
    wanted = f"4 risers measured; about {n_risers - 4} more are seen above: their treads are hidden from the scanner"
    assert flight.goes_on == wanted
    assert notes == [f"flight 1 goes on: {wanted}"]


def test_a_rhythm_that_is_a_little_off_leads_all_the_way_up():
    # The goings above are 3 mm longer: over ten of them the faces drift by a tenth of a going.
    points, normals = seen_from_the_foot(replace(STAIR, n_steps=14), 4)
    points[:, 0] += np.maximum(0.0, points[:, 0] - 4 * STAIR.going) * 0.003 / STAIR.going
    assert "about 10 more" in found(points, normals)[0].goes_on


def test_rows_of_which_one_is_hidden_are_counted_to_the_last():
    points, normals = seen_from_the_foot(STAIR, 4)
    is_sixth = np.abs(points[:, 0] - 6 * STAIR.going) < 0.02
    assert "about 6 more" in found(points[~is_sixth], normals[~is_sixth])[0].goes_on


def test_a_single_riser_is_no_claim():
    assert found(*seen_from_the_foot(STAIR, 4, 5))[0].goes_on is None


def test_a_wall_behind_the_last_tread_is_no_row():
    points, normals = seen_from_the_foot(STAIR, 4, 4)
    rng = np.random.default_rng(3)
    wall = np.column_stack([np.full(9000, 4 * STAIR.going), rng.uniform(0, 1, 9000), rng.uniform(0.68, 3.0, 9000)])
    flight, notes, _ = found(
        np.concatenate([points, wall]), np.concatenate([normals, np.tile([-1.0, 0, 0], (9000, 1))])
    )
    assert (flight.goes_on, notes) == (None, [])


def test_a_sound_flight_has_ended():
    for stair in (STAIR, replace(STAIR, n_steps=4, going=0.25)):
        flight, notes, _ = found(*stair.sample())
        assert (flight.n_risers, flight.goes_on, notes) == (stair.n_steps, None, [])


def test_treads_that_are_seen_too_little_are_told_from_hidden_ones():
    points, normals = STAIR.sample()
    # Of every tread above the fourth a thin part is left: fewer points than make a level.
    is_high = (points[:, 2] > 4.5 * STAIR.rise) & (normals[:, 2] > 0.5)
    is_left = ~is_high | (np.random.default_rng(2).uniform(size=len(points)) < 0.015)
    flight, _, _ = found(points[is_left], normals[is_left])
    assert flight.goes_on == "4 risers measured; about 6 more are seen above: too little of their treads is seen"


def test_a_curved_flight_goes_on_along_its_arc():
    curve = Curve(radius=5.0, n_risers=10, noise=0.001)
    scan = curve.scan()
    is_hidden = (scan.normals[:, 2] > 0.5) & (scan.points[:, 2] > 5.5 * curve.rise)
    flight, _, _ = found(scan.points[~is_hidden], scan.normals[~is_hidden])
    assert (flight.shape, flight.n_risers) == ("curved", 5)
    assert "about 5 more are seen above" in flight.goes_on


def test_a_flight_behind_whose_last_tread_nothing_was_scanned_is_cut_by_the_scans_end():
    points, normals = STAIR.sample()
    is_left = points[:, 0] < 6 * STAIR.going - 0.01
    flight, notes, inspection = found(points[is_left], normals[is_left])
    assert (flight.n_risers, flight.goes_on, notes) == (6, None, [])
    (told,) = [note for note in inspection.notes if note.code == "scan_ends"]
    assert told.step == inspection.steps[-1].step_id
    assert "flight 1 is cut by the scan's end: nothing was scanned behind step 6" in told.message


def test_what_a_region_leaves_out_was_scanned():
    scan = make_scan(*STAIR.sample())
    high = 6 * STAIR.going - 0.01
    inspection = inspect(scan, PARAMS.replaced("overrules.region", f"-9,-9,-9,{high},9,9"))
    (told,) = [note.message for note in inspection.notes if note.code == "scan_ends"]
    assert "is cut by the region of interest: the region holds nothing behind step 6" in told


@pytest.mark.parametrize(("lower_m", "is_other"), [(0.0, False), (0.002, False), (0.01, True)])
def test_a_level_surface_behind_is_another_one_only_where_its_height_is(lower_m, is_other):
    points, normals = seen_from_the_foot(STAIR, 4, 4)
    # So few points behind the last tread that they are no part of its surface.
    is_last = (np.abs(points[:, 2] - 4 * STAIR.rise) < 0.01) & (normals[:, 2] > 0.9)
    behind = points[is_last][::50] + np.array([STAIR.going + 0.1, 0.0, -lower_m])
    more = np.tile([0.0, 0.0, 1.0], (len(behind), 1))
    *_, inspection = found(np.concatenate([points, behind]), np.concatenate([normals, more]))
    codes = {note.code for note in inspection.notes}
    assert ("two_levels" in codes) == is_other
    assert ("end_unseen" in codes) != is_other


@pytest.mark.parametrize("n_risers", [4, 5])
def test_a_wall_or_a_riser_behind_the_last_tread_is_no_end_of_the_scan(n_risers):
    points, normals = seen_from_the_foot(STAIR, 4, 5)
    if n_risers == 4:
        is_fifth = (np.abs(normals[:, 0]) > 0.5) & (points[:, 2] > 4 * STAIR.rise)
        points = np.where(is_fifth[:, None] & np.array([False, False, True]), 2.5 * points - 6 * STAIR.rise, points)
    *_, inspection = found(points, normals)
    assert len(inspection.steps) == 4
    assert "scan_ends" not in {note.code for note in inspection.notes}


def ends_of(points, normals):
    return [note.message for note in found(points, normals)[2].notes if note.code == "end_unseen"]


def test_a_flight_without_a_landing_may_go_on():
    said = "flight 1 may go on: its upper end was not seen: there may be more risers above step 4"
    assert ends_of(*seen_from_the_foot(STAIR, 4, 5)) == [f"{said}, behind which a riser's face is seen"]
    # What is counted beyond, and the end of the scan, need no more words.
    assert ends_of(*seen_from_the_foot(STAIR, 4, 8)) == ends_of(*seen_from_the_foot(STAIR, 4, 4)) == []


def test_a_flight_between_floor_and_landing_has_both_ends():
    points, normals = replace(STAIR, n_steps=4).sample()
    # The highest tread once more, three goings deeper.
    is_top = (normals[:, 2] > 0.5) & (points[:, 2] > 3.5 * STAIR.rise)
    deeper = [points[is_top] + [k * STAIR.going, 0.0, 0.0] for k in (1, 2, 3)]
    points = np.concatenate([points, *deeper])
    assert ends_of(points, np.concatenate([normals, *[normals[is_top]] * 3])) == []


def test_a_flight_of_which_the_foot_is_cut_off_may_go_on_below():
    points, normals = replace(STAIR, n_steps=5).sample()
    is_high = points[:, 2] > 0.4 * STAIR.rise
    (note,) = ends_of(points[is_high], normals[is_high])
    assert note == "flight 1 may go on: its lower end was not seen: there may be more risers below step 1"
