"""Flights that curve: truth over radii, boundary to straight flights, invariance of left and right."""

import itertools
import math

import numpy as np
import pytest

from stair_inspector.pipeline import inspect
from tests.curves import Curve
from tests.synthetic import exact_params

PARAMS = exact_params()
NOISE = 0.002


def flight_of(curve):
    inspection = inspect(curve.scan(), PARAMS)
    (flight,) = inspection.flights
    return flight, inspection.steps, inspection


def goings_of(steps):
    return np.array([step.going_lcr_m for step in steps[:-1]])


@pytest.mark.parametrize("radius", [2.0, 4.0, pytest.param(7.0, marks=pytest.mark.slow), 10.0])
def test_a_curved_flight_is_measured_on_its_own_arc(radius):
    curve = Curve(radius=radius, noise=NOISE)
    flight, steps, _ = flight_of(curve)
    assert (flight.shape, flight.n_risers) == ("curved", 8)
    assert abs(flight.radius_m.value - radius) <= 1.5 * flight.radius_m.u
    assert flight.radius_m.u < 0.03 * radius
    assert {name for name, part in flight.radius_m.parts if part > 0.0} >= {"noise", "edge"}
    # Radii of the three lines: 35 % of the width inside the middle line, on it and outside.
    wanted = curve.going * (radius + np.array([-0.35, 0.0, 0.35]) * curve.width) / radius
    goings = goings_of(steps)
    assert np.abs(goings[:, 1] - wanted[1]).max() < 0.001
    assert np.abs(goings - wanted).max() < 0.0015
    for step in steps[:-1]:
        assert abs(step.going_m.value - curve.going) <= 1.5 * step.going_m.u
        assert step.going_m.u < 0.002
        assert abs(step.width_m.value - curve.width) < curve.spacing / 2.0
    assert [step.rise_m.value for step in steps] == pytest.approx([curve.rise] * 8, abs=0.0006)
    # No unevenness where there is none.
    assert flight.going.max_adjacent < 0.0015


def test_nosings_that_stand_over_their_risers_pass_the_centre_at_a_distance():
    flight, steps, _ = flight_of(Curve(radius=10.0, n_risers=6, noise=0.001, overhang=0.025))
    assert abs(flight.radius_m.value - 10.0) <= 1.5 * flight.radius_m.u
    assert flight.radius_m.u < 0.15
    assert goings_of(steps)[:, 1] == pytest.approx(np.full(5, 0.28), abs=0.001)


def test_the_climb_follows_the_arc():
    _, steps, _ = flight_of(Curve(radius=3.0, noise=NOISE))
    angles = np.degrees([math.atan2(step.climb[1], step.climb[0]) for step in steps])
    assert angles == pytest.approx(np.degrees(0.28 / 3.0) * np.arange(8), abs=0.4)


def test_a_turn_to_the_right_is_the_mirror_image_of_one_to_the_left():
    left, right = (flight_of(Curve(radius=4.0, noise=NOISE, is_left=is_left)) for is_left in (True, False))
    assert (left[0].shape, right[0].shape) == ("curved", "curved")
    assert right[0].radius_m.value == pytest.approx(left[0].radius_m.value, abs=left[0].radius_m.u)
    assert goings_of(right[1])[:, ::-1] == pytest.approx(goings_of(left[1]), abs=6e-4)
    for a, b in zip(left[1], right[1], strict=True):
        assert b.rise_m.value == pytest.approx(a.rise_m.value, abs=1e-4)
        assert b.climb * (1.0, -1.0, 1.0) == pytest.approx(a.climb, abs=1e-3)


def test_a_note_says_on_which_line_a_curved_flight_is_measured():
    _, _, inspection = flight_of(Curve(radius=4.0))
    (note,) = [note for note in inspection.notes if note.code == "curved"]
    assert "along the arc through the middles of its nosings" in note.message
    assert not [note for note in inspection.notes if note.code == "winding"]


def test_a_defect_of_a_curved_flight_stays_as_large_as_it_is():
    # A nosing turned by two degrees: its own goings differ from left to right, those on the middle line hardly.
    plain, turned = (flight_of(Curve(radius=4.0, noise=NOISE, skews_deg=skews)) for skews in ((), ((4, 2.0),)))
    assert turned[0].shape == "curved"
    change = goings_of(turned[1]) - goings_of(plain[1])
    tilt = 0.35 * math.tan(math.radians(2.0))
    assert change[2] == pytest.approx([-tilt, 0.0, tilt], abs=0.0015)
    assert change[3] == pytest.approx([tilt, 0.0, -tilt], abs=0.0015)
    assert np.abs(np.delete(change, (2, 3), axis=0)).max() < 0.0012


@pytest.mark.parametrize(
    "skews",
    [
        ((4, 2.0),),
        pytest.param(((1, -2.0),), marks=pytest.mark.slow),
        ((8, 1.5),),
        pytest.param(((2, 2.0), (6, -2.0)), marks=pytest.mark.slow),
        pytest.param(((2, 2.0), (3, 2.0)), marks=pytest.mark.slow),
    ],
)
def test_a_straight_flight_with_a_turned_nosing_stays_straight(skews):
    flight, steps, _ = flight_of(Curve(radius=1e6, noise=NOISE, skews_deg=skews))
    assert (flight.shape, flight.radius_m) == ("straight", None)
    assert goings_of(steps)[:, 1] == pytest.approx(np.full(7, 0.28), abs=0.001)


@pytest.mark.parametrize(
    "seed", [2, 3, pytest.param(4, marks=pytest.mark.slow), pytest.param(5, marks=pytest.mark.slow)]
)
def test_noise_alone_curves_no_flight(seed):
    curve = Curve(radius=1e6, n_risers=5 + seed % 2, noise=0.008, spacing=0.016, seed=seed)
    assert flight_of(curve)[0].shape == "straight"


def test_a_slight_curve_needs_five_nosings_and_a_strong_one_four():
    shapes = [flight_of(Curve(radius=radius, n_risers=n))[0].shape for radius, n in ((10, 4), (10, 5), (3, 3), (3, 4))]
    assert shapes == ["straight", "curved", "straight", "curved"]


def test_a_flight_about_a_near_centre_is_no_curve():
    flight, _, _ = flight_of(Curve(radius=1.2, width=0.9, n_risers=7))
    assert flight.shape in ("winder", "spiral")


def test_arcs_add_up_to_the_way_along_the_middle_line():
    _, steps, _ = flight_of(Curve(radius=4.0))
    places = [step.line_points[1][:2] for step in steps]
    chords = [math.dist(a, b) for a, b in itertools.pairwise(places)]
    goings = [step.going_m.value for step in steps[:-1]]
    # An arc is longer than its chord, by 0.06 mm here.
    assert np.array(goings) - chords == pytest.approx(np.full(7, 0.28**3 / 24.0 / 16.0), abs=5e-5)
