"""Every failure has a cause of its own: what is said where there is no staircase, and to whom it is not said."""

from dataclasses import replace

import numpy as np
import pytest

from stair_inspector.errors import CannotMeasure
from stair_inspector.model import Note, Observation
from stair_inspector.params import FlightsParams, HorizontalParams, LevelsParams, NormalsParams, Params, PatchesParams
from stair_inspector.pipeline import inspect
from stair_inspector.stages.hopeless import is_too_coarse
from tests.stages.test_coordinate_steps import UTM, as_float32, scan_of
from tests.synthetic import Stair, make_scan

GIVEN = NormalsParams(source="given")


def stair(**changes):
    return Stair(**{"n_steps": 5, "spacing": 0.02, "noise": 0.001, "risers": True, "floor_depth": 1.2, **changes})


def params(**changes):
    return Params(**{"up": "z", "unit": "m", "normals": GIVEN, **changes})


def why(scan, **changes):
    """The sentence after "no staircase found: "."""
    inspection = inspect(scan, params(**changes))
    assert inspection.steps == ()
    (note,) = [note for note in inspection.notes if note.code == "no_staircase"]
    return note.message.removeprefix("no staircase found: ")


def read(scan, unit, is_guessed=True):
    """The scan as if its numbers, which are metres, had been read in another unit."""
    factor = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254}[unit]
    notes = (Note("unit_guessed", "read", "the unit was guessed"),) if is_guessed else ()
    return replace(scan, points=scan.points * factor, unit=unit, notes=notes)


def level(x, y, z, n=4000, seed=0):
    rng = np.random.default_rng(seed)
    points = np.column_stack([rng.uniform(*x, n), rng.uniform(*y, n), rng.normal(z, 0.001, n)])
    return points, np.tile([0.0, 0.0, 1.0], (n, 1))


def scan_with(*parts):
    points, normals = (np.concatenate(arrays) for arrays in zip(*parts, strict=True))
    return make_scan(points, normals)


def test_a_stair_has_no_cause():
    inspection = inspect(stair().scan(), params())
    assert len(inspection.steps) == 5
    assert "no_staircase" not in {note.code for note in inspection.notes}


def test_float32_far_from_zero():
    # The climb goes along y, which resolves half a metre.
    scan = scan_of(as_float32(stair(spacing=0.01).sample()[0][:, [1, 0, 2]] + UTM))
    message = why(scan, normals=NormalsParams())
    assert "resolve only 31.2 mm in x, 0.5 m in y" in message
    assert "export in double precision, or with a shift" in message


def tower(apart, low=0.0):
    """More levels than a staircase has treads, 30 points on each."""
    rng = np.random.default_rng(1)
    z = low + apart * np.repeat(np.arange(600), 30)
    points = np.column_stack([rng.uniform(0.0, 3.0, (len(z), 2)), z])
    return replace(scan_of(points), normals=np.tile([0.0, 0.0, 1.0], (len(z), 1)))


TINY = LevelsParams(eps_m=0.001, min_points=20)


def test_an_error_tells_the_true_cause_too():
    scan = tower(0.5, low=5.8e6)
    in_float32 = replace(scan, points=as_float32(scan.points + scan.origin_m) - scan.origin_m)
    with pytest.raises(CannotMeasure, match=r"^a.ply: the coordinates resolve only .*; export in double precision"):
        inspect(in_float32, params(levels=TINY))


def test_an_error_without_a_deeper_cause_stays_what_it_is():
    with pytest.raises(CannotMeasure, match="600 height clusters, more than 500 can be steps"):
        inspect(tower(0.005, low=0.1234567), params(levels=TINY))


def test_the_corners_of_a_mesh():
    corners = [(0.28 * k + dx, y, 0.175 * k) for k in range(8) for dx in (0.0, 0.28) for y in (0.0, 0.4, 0.7, 1.0)]
    scan = make_scan(np.array(corners), np.tile([0.0, 0.0, 1.0], (len(corners), 1)))
    assert "only 64 points" in why(scan)
    assert "the corners of a mesh" in why(scan)


@pytest.mark.parametrize(("unit", "flag"), [("mm", "--unit m"), ("cm", "--unit m")])
def test_a_scan_far_too_small_is_of_another_unit(unit, flag):
    message = why(read(stair().scan(), unit), unit="m")
    assert message.startswith("the whole scan is ")
    assert f"read in {'millimetres' if unit == 'mm' else 'centimetres'}" in message
    assert message.endswith(f"if so, give {flag}")


@pytest.mark.slow
def test_a_scan_far_too_large_is_of_another_unit():
    scan = stair().scan()
    message = why(replace(scan, points=scan.points * 1000.0))
    assert "in millimetres it is" in message
    assert message.endswith("--unit mm")


def test_rises_that_are_usual_in_another_unit_name_it():
    # Inches taken for metres: 170 mm are 6.69 "m".
    scan = stair().scan()
    message = why(replace(scan, points=scan.points / 0.0254))
    assert "the levels follow each other 6.69 m apart, read in metres; in inches these are rises of 0.17 m" in message
    assert message.endswith("if so, give --unit in")
    # Feet taken for centimetres were guessed; metres that were given are not doubted for the foot's sake.
    assert "--unit" not in why(stair(rise=0.45, going=0.5).scan())


@pytest.mark.parametrize(("rise", "limit", "flag"), [(0.33, "max", "0.35"), (0.05, "min", "0.045")])
def test_rises_beyond_a_limit_name_the_limit_and_the_flag_finds_them(rise, limit, flag):
    scan = stair(rise=rise).scan()
    message = why(scan)
    assert f"rises of about {rise * 1000.0:.0f} mm" in message
    assert f"flights.{limit}_rise_m" in message
    assert message.endswith(f"--flights.{limit}-rise-m {flag}")
    found = inspect(scan, params(flights=FlightsParams(**{f"{limit}_rise_m": float(flag)})))
    assert len(found.steps) == 5


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"flights": FlightsParams(min_risers=9)}, "--flights.min-risers 5"),
        ({"patches": PatchesParams(min_area_m2=0.6)}, "lower --patches.min-area-m2"),
    ],
)
def test_other_settings_that_leave_a_flight_out_are_named(changes, words):
    assert why(stair().scan(), **changes).endswith(words)


def test_a_gap_that_is_too_small_is_named():
    points, normals = stair(risers=False, floor_depth=1.2).sample()
    # Of each tread only the front is seen.
    place = np.mod(points[:, 0], 0.28)
    keep = (points[:, 0] < 0.0) | (place < 0.15)
    message = why(make_scan(points[keep], normals[keep]), flights=FlightsParams(max_gap_m=0.02))
    assert "flights.max_gap_m (0.02) leaves out" in message
    assert message.endswith("raise --flights.max-gap-m")


def test_too_sparse():
    message = why(
        stair(n_steps=9, spacing=0.08, floor_depth=2.4, risers=False).scan(), patches=PatchesParams(cell_m=0.01)
    )
    assert "too sparse: points lie about" in message
    assert "on a tread" in message


def test_nothing_faces_up():
    assert why(stair().scan(), up="y").startswith("no level surface: 0.0% of the points face up (given up direction")


def test_too_many_points_are_asked_for():
    message = why(stair().scan(), levels=LevelsParams(min_points=5000))
    assert message.startswith("no level surface: ")
    assert "nowhere 5000 of them (m) within 20 mm of one height (eps_z)" in message


def test_up_that_points_down():
    # A flight cut down to its floor and what hangs on walls below: seen with z down, all lies under the largest.
    floor = level((0.0, 3.0), (0.0, 3.0), 0.0, 20_000)
    below = np.random.default_rng(1).uniform([0.0, 0.0, -2.0], [3.0, 0.02, -0.2], (20_000, 3))
    upright = np.tile([0.0, 1.0, 0.0], (len(below), 1))
    message = why(scan_with(floor, (below, upright)))
    assert "20,000 points lie below" in message
    assert message.endswith("give --up=-z if it does")
    assert "may point down" not in why(
        scan_with(floor, (below * [1.0, 1.0, -1.0], np.tile([0.0, 1.0, 0.0], (len(below), 1))))
    )


def test_a_wall_of_shelves():
    floor = level((0.0, 3.0), (0.0, 3.0), 0.0, 20_000)
    boards = [level((1.0, 2.0), (2.6, 2.95), 0.35 * k, 2000, k) for k in range(1, 6)]
    message = why(scan_with(floor, *boards))
    assert "5 of them lie over each other, about 0.35 m apart, as shelves do" in message
    # Two alone are a table with a board.
    assert "shelves" not in why(scan_with(floor, *boards[:2]))


def test_tiers_of_seats():
    message = why(stair(rise=0.4, going=0.9, n_steps=4).scan())
    assert "deeper than treads: tiers of seats or terraces" in message


def test_one_surface_is_the_only_one():
    message = why(scan_with(level((0.0, 3.0), (0.0, 3.0), 0.0, 20_000)))
    assert message.startswith("1 horizontal surface, but it is the only one; ")


def test_normals_that_scatter_too_much_for_theta_are_no_level_surface():
    tilted = stair().sample()
    lean = np.tile([np.sin(0.4), 0.0, np.cos(0.4)], (len(tilted[0]), 1))
    message = why(make_scan(tilted[0], lean), horizontal=HorizontalParams(theta_deg=10.0))
    assert message.startswith("no level surface: ")


@pytest.mark.parametrize(("step_m", "is_coarse"), [(0.02, False), (0.0299, False), (0.03, True), (0.5, True)])
def test_coordinates_as_coarse_as_half_the_smallest_riser_are_hopeless(step_m, is_coarse):
    found = (Observation("coordinates_rounded", "doubt", "rounded", step_m, "export again"),)
    assert is_too_coarse(found, FlightsParams()) is is_coarse
    assert not is_too_coarse((Observation("cloud_copied", "doubt", "twice", step_m),), FlightsParams())


def test_nothing_is_measured_in_coordinates_that_are_too_coarse():
    points = stair(noise=0.002, spacing=0.01).sample()[0]
    reason = why(make_scan(np.round(points / 0.05) * 0.05), normals=NormalsParams())
    assert "50 mm" in reason
    assert "as coarse as a step of a staircase" in reason


def test_where_treads_may_be_missing_the_limit_is_not_the_first_advice():
    # Twice a usual rise: of a flight of 175 mm every second tread was found.
    message = why(stair(rise=0.35, going=0.56).scan())
    assert "rises of about 350 mm, above flights.max_rise_m" in message
    assert (
        "as where treads between them were not found: check theta_th, eps_z and m; if they are steps, give" in message
    )


def test_a_limit_is_named_before_another_unit():
    message = why(read(stair(rise=0.33, n_steps=8).scan(), "m"))
    assert message.index("--flights.max-rise-m 0.35") < message.index("--unit ft")
