"""Sums, differences and spreads with their uncertainties, against simulated errors and known tables."""

import dataclasses
import math

import numpy as np
import pytest
from scipy.stats import studentized_range

from stair_inspector.measured import (
    combined,
    diagonal_of,
    difference,
    run_of_flight,
    spread,
    spread_quantile,
    steepest_slope_of,
    total,
)
from stair_inspector.model import Measured
from stair_inspector.quantities import step_value
from tests.codes.flights import flight_of, measured, step

SIGMA = 0.001
RUNS = 4000


def heights(n_levels, sigma=SIGMA, runs=RUNS, odd=None):
    """Heights of a flight with rises of 0.17, one of them larger, each with its own error: (runs, levels)."""
    rises = np.full(n_levels - 1, 0.17)
    if odd is not None:
        rises[odd[0]] += odd[1]
    true = np.concatenate([[0.0], np.cumsum(rises)])
    return true + np.random.default_rng(7).normal(0.0, sigma, (runs, n_levels))


def as_rises(row, sigma=SIGMA):
    """What the survey says of these heights: each rise with the noise of two surfaces, k = 2."""
    return [measured(value, 2.0 * math.sqrt(2.0) * sigma) for value in np.diff(row)]


# --- one step ------------------------------------------------------------------------------------------------------


def test_twice_the_rise_and_the_going():
    rise = Measured(0.17, 0.002, (("noise", 0.001), ("edge", 0.0008), ("up", 0.0012), ("scale", 0.0004)))
    going = Measured(0.28, 0.003, (("noise", 0.002), ("edge", 0.001), ("up", 0.0007), ("scale", 0.0006)))
    found = step_value(step(1, rise=rise, going=going), "two_r_plus_g")
    assert found.value == pytest.approx(0.62)
    parts = dict(found.parts)
    assert parts["noise"] == pytest.approx(math.hypot(0.002, 0.002))
    assert parts["edge"] == pytest.approx(math.hypot(0.0016, 0.001))
    # One tilt raises the rises and shortens the goings; one scale stretches both.
    assert parts["up"] == pytest.approx(2 * 0.0012 - 0.0007)
    assert parts["scale"] == pytest.approx(2 * 0.0004 + 0.0006)
    assert found.u == pytest.approx(math.sqrt(sum(part**2 for part in parts.values())))


@pytest.mark.parametrize("lost", ["rise", "going"])
def test_without_a_part_there_is_no_sum(lost):
    assert step_value(step(1, **{lost: None}), "two_r_plus_g") is None


@pytest.mark.parametrize(("fall", "cross"), [(3.0, 0.0), (0.0, -3.0), (-2.0, 1.5), (0.02, 0.01)])
def test_the_steepest_slope_of_a_tread(fall, cross):
    u_deg = 0.1
    found = step_value(step(1, fall=measured(fall, u_deg), cross_fall=measured(cross, u_deg)), "tread_slope")
    assert found.value == pytest.approx(math.hypot(math.tan(math.radians(fall)), math.tan(math.radians(cross))))
    errors = np.random.default_rng(3).normal(0.0, u_deg / 2.0, (2, 20_000))
    slopes = np.hypot(np.tan(np.radians(fall + errors[0])), np.tan(np.radians(cross + errors[1])))
    assert np.mean(np.abs(slopes - found.value) <= found.u) >= 0.95
    if math.hypot(fall, cross) > 1.0:
        assert found.u == pytest.approx(2.0 * slopes.std(), rel=0.02)


@pytest.mark.parametrize("lost", ["fall", "cross_fall"])
def test_a_slope_needs_both_directions(lost):
    assert step_value(step(1, **{lost: None}), "tread_slope") is None


# --- differences ---------------------------------------------------------------------------------------------------


def test_neighbouring_rises_share_a_nosing():
    rows = heights(3)
    found = difference(*as_rises(rows[0])[::-1], share_a_nosing=True)
    simulated = np.diff(rows, 2, axis=1)[:, 0]
    # Three heights have sqrt(6) times the noise of one; what is not known is how much of it the middle one has.
    assert found.u == pytest.approx(2.0 * math.sqrt(8.0) * SIGMA)
    assert 1.0 <= found.u / (2.0 * simulated.std()) <= 1.18


@pytest.mark.parametrize("sigmas", [(1, 1, 1), (0.1, 1, 0.1), (1, 0.1, 0.1), (0.3, 2, 1), (2, 0.5, 0.5)])
def test_the_uncertainty_of_a_difference_holds_whichever_nosing_is_the_bad_one(sigmas):
    low, shared, high = (SIGMA * each for each in sigmas)
    lower, upper = (measured(0.17, 2.0 * math.hypot(shared, other)) for other in (low, high))
    true = 2.0 * math.sqrt(low**2 + 4.0 * shared**2 + high**2)
    assert true <= difference(upper, lower, share_a_nosing=True).u <= 1.6 * true


def test_rises_apart_share_nothing():
    rises = as_rises(heights(5)[0])
    assert difference(rises[3], rises[0], share_a_nosing=False).u == pytest.approx(4.0 * SIGMA)


def test_what_the_whole_scan_has_in_common_cancels():
    rise = Measured(0.17, 0.005, (("noise", 0.001), ("up", 0.0048), ("scale", 0.001)))
    assert difference(rise, rise, share_a_nosing=False).u == pytest.approx(math.sqrt(2.0) * 0.001)
    # The first rise stands on the floor, which is measured at its foot: a tilt does not move it.
    first = Measured(0.17, 0.001, (("noise", 0.001),))
    assert difference(rise, first, share_a_nosing=False).u == pytest.approx(
        math.sqrt(2 * 0.001**2 + 0.0048**2 + 0.001**2)
    )


def test_an_uncertainty_without_parts_is_taken_as_independent():
    assert difference(Measured(0.17, 0.003), Measured(0.16, 0.004), share_a_nosing=False).u == pytest.approx(0.005)


# --- spreads -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("n", "quantile"), [(2, 2.77), (3, 3.31), (4, 3.63), (5, 3.86), (10, 4.47), (20, 5.01)])
def test_the_spread_of_n_values_follows_the_printed_tables(n, quantile):
    assert spread_quantile(n) == pytest.approx(quantile, abs=0.005)


def test_the_spread_of_n_values_is_that_of_another_library():
    assert spread_quantile(16) == pytest.approx(studentized_range.ppf(0.95, 16, math.inf), abs=0.001)


@pytest.mark.parametrize("odd", [None, (5, 0.003), (5, 0.0095), (0, 0.02)])
def test_the_uncertainty_of_a_spread_holds_for_even_and_uneven_flights(odd):
    true = 0.0 if odd is None else odd[1]
    found = [spread(as_rises(row), are_chained=True) for row in heights(17, odd=odd)]
    values = np.array([measured.value for measured, _, _ in found])
    upwards = np.array([measured.u for measured, _, _ in found])
    downwards = np.array([u_down for _, u_down, _ in found])
    # One-sided, as a verdict uses them: too small by more than u, too large by more than u_down.
    assert np.mean(true - values > upwards) <= 0.025
    assert np.mean(values - true > downwards) <= 0.05


def test_a_flight_is_not_blamed_for_the_noise_of_its_scan():
    """A perfect flight of 16 risers, its heights known to 1 mm and to 2 mm, held against 3/8 in.

    Without U one in a thousand of the first and more than half of the second would be called outside.
    """
    for sigma, most in ((0.001, 0.001), (0.002, 0.05)):
        found = [spread(as_rises(row, sigma), are_chained=True) for row in heights(17, sigma)]
        outside = [measured.value - u_down > 0.009525 for measured, u_down, _ in found]
        assert np.mean(outside) <= most


def test_a_spread_names_where_it_is():
    values = [measured(value, 0.0005) for value in (0.17, 0.165, 0.171, 0.17)]
    found, u_down, (low, high) = spread(values, are_chained=False)
    assert (low, high) == (1, 2)
    assert found.value == pytest.approx(0.006)
    assert found.u == pytest.approx(math.sqrt(2.0) * 0.0005)
    assert u_down == pytest.approx(found.u * 3.633 / (2.0 * math.sqrt(2.0)), rel=1e-3)


def test_the_uncertainty_of_a_spread_holds_where_one_value_is_worse_than_the_others():
    """Against simulated errors: the true spread is larger than found by more than u in one of forty at most."""
    true = np.array([0.170, 0.172, 0.174, 0.176, 0.180])
    sigmas = np.array([0.0002, 0.0002, 0.005, 0.0002, 0.004])
    rows = true + np.random.default_rng(5).normal(0.0, 1.0, (RUNS, 5)) * sigmas
    found = [
        spread([measured(value, 2.0 * sigma) for value, sigma in zip(row, sigmas, strict=True)], are_chained=False)[0]
        for row in rows
    ]
    assert np.mean([each.value + each.u < np.ptp(true) for each in found]) <= 0.025


# --- sums ----------------------------------------------------------------------------------------------------------


def test_the_sum_of_the_rises_has_the_noise_of_its_ends():
    rows = heights(11)
    found = total(as_rises(rows[0]))
    assert found.value == pytest.approx(rows[0][-1] - rows[0][0])
    assert found.u == pytest.approx(2.0 * (rows[:, -1] - rows[:, 0]).std(), rel=0.03)


def test_a_tilt_and_a_scale_add_up_over_a_flight():
    rise = Measured(0.17, 0.0, (("up", 0.001), ("scale", 0.0002), ("registration", 0.0005)))
    parts = dict(total([rise] * 9).parts)
    assert parts == pytest.approx({"up": 0.009, "scale": 0.0018, "registration": 0.0015})


@pytest.mark.parametrize("name", ["resolution", "layers"])
def test_what_one_level_has_for_itself_is_no_error_of_the_whole_scan(name):
    one = Measured(0.17, 0.002, ((name, 0.002),))
    other = Measured(0.18, 0.002, ((name, 0.002),))
    assert dict(difference(other, one, share_a_nosing=False).parts)[name] == pytest.approx(0.002 * math.sqrt(2.0))
    # Of the level between them each has the same error, with the other sign.
    assert dict(difference(other, one, share_a_nosing=True).parts)[name] == pytest.approx(0.004)
    assert dict(total([one] * 9).parts) == pytest.approx({name: 0.002})


# --- worked out by hand --------------------------------------------------------------------------------------------


def made(value, **parts):
    return combined(value, parts)


def test_the_spread_of_three_rises_may_lie_between_neighbours():
    """1 mm between the first and the last, each known to 1 mm; 0.5 mm between neighbours, which share a nosing."""
    rises = [made(value, noise=0.001) for value in (0.170, 0.1705, 0.171)]
    found, u_down, places = spread(rises, are_chained=True)
    assert (found.value, places) == (pytest.approx(0.001), (0, 2))
    # 1 + sqrt(2) mm at the ends; 0.5 + 2 mm between neighbours is more.
    assert found.value + found.u == pytest.approx(0.0025)
    # Tables of the studentized range have 3.314 for three values.
    assert u_down == pytest.approx(0.001 * math.sqrt(2.0) * 3.314 / (2.0 * math.sqrt(2.0)), rel=1e-3)
    apart, _, _ = spread(rises, are_chained=False)
    assert apart.u == pytest.approx(0.001 * math.sqrt(2.0))


def test_the_spread_of_two_neighbours_is_their_difference():
    found, u_down, _ = spread([made(0.170, noise=0.001), made(0.172, noise=0.001, up=0.003)], are_chained=True)
    # A shared nosing that is wrong by 1 mm counts twice; the tilt is in one of them alone.
    assert found.u == pytest.approx(math.hypot(0.002, 0.003))
    # For two values the table has 2.77, less than 2 sqrt(2): nothing is widened.
    assert u_down == pytest.approx(math.hypot(0.002, 0.003))


def test_the_way_from_nosing_to_nosing_does_not_feel_a_tilt():
    lower = step(1, going=made(0.28, noise=0.002, scale=0.0028, up=0.21 * 0.01))
    upper = step(2, rise=made(0.21, noise=0.001, scale=0.0021, up=0.28 * 0.01))
    found = diagonal_of(lower, upper)
    # Sides 3, 4 and 5 times 70 mm: shares 0.8 of the going, 0.6 of the rise.
    assert found.value == pytest.approx(0.35)
    parts = dict(found.parts)
    assert parts["noise"] == pytest.approx(math.hypot(0.8 * 0.002, 0.6 * 0.001))
    assert parts["scale"] == pytest.approx(0.0035)
    assert parts.get("up", 0.0) == pytest.approx(0.0, abs=1e-12)
    assert diagonal_of(lower, None) is None
    assert diagonal_of(lower, dataclasses.replace(upper, flight=2)) is None
    assert diagonal_of(dataclasses.replace(lower, going_m=None), upper) is None
    assert diagonal_of(lower, dataclasses.replace(upper, rise_m=None)) is None


def test_the_run_of_a_flight_ends_at_its_last_nosing():
    steps = [step(1, going=0.28), step(2, going=0.30), step(3, going=1.2)]
    flight = flight_of(steps)
    assert run_of_flight(flight, steps).value == pytest.approx(0.58)
    assert run_of_flight(flight, [steps[0], step(2, going=None), steps[2]]) is None
    assert run_of_flight(flight, steps[:1]) is None


@pytest.mark.parametrize("angles_deg", [(0.1, 0.2), (0.2, 0.1)])
def test_a_level_tread_may_slope_any_way_within_a_circle(angles_deg):
    fall, cross_fall = (made(0.0, noise=angle) for angle in angles_deg)
    found = steepest_slope_of(step(1, fall=fall, cross_fall=cross_fall), None)
    # Of two normal errors of one deviation 95 % lie within 2.4477 of it; u is two of it.
    assert found.u == pytest.approx(math.radians(0.2) * 2.4477 / 2.0, rel=1e-4)
