"""A tread of which something hides the middle is one tread; what belongs to another staircase is another's."""

from dataclasses import replace

import numpy as np
import pytest

from stair_inspector.overrules import OverrulesParams
from stair_inspector.params import Params
from stair_inspector.pipeline import inspect
from stair_inspector.simulation.scanner import scan as scan_building
from tests.benchmarks import hostile_buildings as buildings
from tests.benchmarks.hostile_kinds import TLS
from tests.synthetic import Stair, make_scan, rotation

STAIR = Stair(n_steps=4, risers=True, spacing=0.014, noise=0.0005, floor_depth=0.8, seed=4)
PARAMS = Params(up="z", unit="m")


def without(points, k, y_low, y_high, x_low=0.0, x_high=1.0):
    """Points but for a part of tread k, given by its sides and by shares of its depth."""
    x, y, z = points.T
    on = np.abs(z - k * STAIR.rise) < 0.01
    on &= (x >= (k - 1 + x_low) * STAIR.going - 0.005) & (x <= (k - 1 + x_high) * STAIR.going - 0.005)
    return points[~(on & (y > y_low) & (y < y_high))]


def found(points, params=PARAMS):
    return inspect(make_scan(points @ rotation("z", 20.0).T), params)


def heights_of(inspection, kind):
    return [round(patch.height_m, 2) for patch in inspection.patches if patch.kind == kind]


def test_a_tread_parted_by_what_stands_on_it_is_one_of_the_whole_width():
    inspection = found(without(STAIR.sample()[0], 2, 0.35, 0.75))
    assert len(inspection.steps) == STAIR.n_steps
    width = inspection.steps[1].width_m
    assert abs(width.value - STAIR.width) <= width.u < 0.02
    assert abs(inspection.steps[1].going_m.value - STAIR.going) <= inspection.steps[1].going_m.u
    assert inspection.steps[1].coverage < 0.75
    # Both pieces are that step, neither a seat beside it.
    pieces = [patch for patch in inspection.patches if abs(patch.height_m - 2 * STAIR.rise) < 0.01]
    assert [patch.step_id for patch in pieces] == [2, 2]
    assert not heights_of(inspection, "rejected")
    assert not [note for note in inspection.notes if note.code == "chain_ambiguous"]


def test_a_piece_behind_a_thing_is_joined_too():
    # What stands in front hides all but two corners and a strip before the riser.
    points = without(without(STAIR.sample()[0], 2, 0.1, 0.9, 0.0, 0.6), 2, 0.0, 1.0, 0.6, 0.75)
    inspection = found(points)
    width = inspection.steps[1].width_m
    assert len(inspection.steps) == STAIR.n_steps
    assert abs(width.value - STAIR.width) <= width.u


def test_a_piece_that_the_inspector_decides_about_stays_apart():
    points = without(STAIR.sample()[0], 2, 0.35, 0.75)
    at = rotation("z", 20.0) @ np.array([1.5 * STAIR.going, 0.9, 2 * STAIR.rise])
    force = f"at:{at[0]:.3f},{at[1]:.3f},{at[2]:.3f}=rejected"
    inspection = found(points, Params(up="z", unit="m", overrules=OverrulesParams(force=force)))
    assert heights_of(inspection, "rejected") == [round(2 * STAIR.rise, 2)]


@pytest.mark.parametrize(
    ("shift", "size"),
    [
        pytest.param((0.0, 1.3, 0.0), 0.3, id="beside the sides of the other treads"),
        pytest.param((0.0, 0.7, 0.015), 0.3, id="not in the tread's plane"),
    ],
)
def test_what_lies_elsewhere_is_no_piece(shift, size):
    points = without(STAIR.sample()[0], 2, 0.35, 1.0)
    rng = np.random.default_rng(3)
    other = rng.uniform([STAIR.going, 0.0, 0.0], [2 * STAIR.going, size, 0.0005], (500, 3))
    inspection = found(np.concatenate([points, other + np.array(shift) + [0.0, 0.0, 2 * STAIR.rise]]))
    width = inspection.steps[1].width_m
    assert abs(width.value - 0.35) < 0.02
    assert round(2 * STAIR.rise + shift[2], 2) in heights_of(inspection, "rejected")


@pytest.mark.parametrize("apart", [0.06, 0.1, 0.15])
def test_two_flights_side_by_side_stay_two_where_treads_are_in_pieces(apart):
    first = STAIR.sample()[0]
    second = Stair(**{**vars(STAIR), "seed": 9}).sample()[0]
    # Half of one tread of either is hidden, the other half lies beside the other flight.
    first, second = without(first, 3, 0.0, 0.6), without(second, 2, 0.3, 1.0)
    inspection = found(np.concatenate([first, second + np.array([0.0, STAIR.width + apart, 0.0])]))
    assert [flight.n_risers for flight in inspection.flights] == [4, 4]
    widths = [step.width_m for step in inspection.steps]
    # Of either a tread is hidden in part, the others are as wide as they are beside each other.
    assert sorted(abs(width.value - STAIR.width) <= width.u < 0.015 for width in widths) == [False] * 2 + [True] * 6


def bars_along(y_low, bar, gap, n_bars, seed, landing=0.0):
    """Points of three treads of bars along x, 30 mm high, beside each other from one place on, and of a landing."""
    rng = np.random.default_rng(seed)
    width = n_bars * (bar + gap) - gap
    parts = []
    for k in range(1, 4):
        x = (k - 1) * STAIR.going
        for low in y_low + np.arange(n_bars) * (bar + gap):
            top, side = (round(STAIR.going * wide * 15_000) for wide in (bar, 0.03))
            parts.append(rng.uniform([x, low, k * 0.17], [x + STAIR.going, low + bar, k * 0.17], (top, 3)))
            for y in (low, low + bar):
                parts.append(rng.uniform([x, y, k * 0.17 - 0.03], [x + STAIR.going, y, k * 0.17], (side, 3)))
    if landing:
        x = 3 * STAIR.going
        parts.append(
            rng.uniform([x, y_low, 0.68], [x + landing, y_low + width, 0.68], (round(landing * width * 9e3), 3))
        )
    points = np.concatenate(parts)
    return points + rng.normal(0.0, 0.0005, points.shape), width


def twins_of_bars(apart, bar=0.03, gap=0.041, n_bars=10, landing=0.0):
    first, width = bars_along(0.0, bar, gap, n_bars, 1, landing)
    second, _ = bars_along(width + apart, bar, gap, n_bars, 2, landing)
    floor = np.random.default_rng(3).uniform([-0.9, -0.4, 0.0], [0.4, 2.0 * width + 0.5, 1e-6], (20_000, 3))
    return np.concatenate([first, second, floor]), width


@pytest.mark.parametrize(("apart", "landing"), [(0.052, 0.0), (0.041, 0.9)])
def test_flights_of_bars_hardly_farther_apart_than_their_bars_are_two(apart, landing):
    # As far apart as the bars, only their whole landings tell.
    points, width = twins_of_bars(apart, landing=landing)
    inspection = found(points)
    n_risers = 4 if landing else 3
    assert [flight.n_risers for flight in inspection.flights] == [n_risers, n_risers]
    treads = [step for step in inspection.steps if step.step_id % n_risers or not landing]
    assert all(abs(step.width_m.value - width) <= step.width_m.u < 0.02 for step in treads)
    assert not [note for note in inspection.notes if note.code == "flights_may_be_two"]


def test_where_nothing_tells_two_flights_of_bars_from_a_wide_one_it_is_said():
    points, width = twins_of_bars(0.041)
    inspection = found(points)
    assert [flight.n_risers for flight in inspection.flights] == [3]
    (note,) = [note for note in inspection.notes if note.code == "flights_may_be_two"]
    assert f"{2.0 * width + 0.03:.2f} m wide" in note.message


def test_of_a_flight_of_bars_too_narrow_for_two_nothing_is_said():
    points, width = bars_along(0.0, 0.03, 0.041, 14, 4)
    floor = np.random.default_rng(3).uniform([-0.9, -0.4, 0.0], [0.4, 1.4, 1e-6], (16_000, 3))
    inspection = found(np.concatenate([points, floor]))
    assert width < 1.1
    assert [flight.n_risers for flight in inspection.flights] == [3]
    assert not [note for note in inspection.notes if note.code == "flights_may_be_two"]


@pytest.mark.parametrize("radius", [0.3, 0.5])
def test_a_tripods_hole_in_a_landing_moves_nothing(radius):
    end, height = STAIR.n_steps * STAIR.going, STAIR.n_steps * STAIR.rise
    n_landing = round(1.1 * STAIR.width / STAIR.spacing**2)
    landing = np.random.default_rng(7).uniform([end, 0.0, height], [end + 1.1, STAIR.width, height], (n_landing, 3))
    points = np.concatenate([STAIR.sample()[0], landing])
    middle = np.array([end + 0.3, 0.5])
    is_hole = (np.abs(points[:, 2] - height) < 0.02) & (np.hypot(*(points[:, :2] - middle).T) < radius)
    whole, holed = found(points), found(points[~is_hole])
    assert np.count_nonzero(is_hole) > 500
    assert [step.kind for step in holed.steps] == ["tread"] * 3 + ["landing"]
    for step, other in zip(whole.steps, holed.steps, strict=True):
        assert abs(step.rise_m.value - other.rise_m.value) < 0.0003
        assert abs(step.width_m.value - other.width_m.value) <= other.width_m.u < 0.02
    assert holed.steps[3].coverage < whole.steps[3].coverage - 0.1


@pytest.mark.slow
@pytest.mark.parametrize("apart", [0.05, 0.1])
@pytest.mark.parametrize(("bar", "gap", "is_along"), [(0.03, 0.03, False), (0.06, 0.012, True), (0.03, 0.041, True)])
def test_two_flights_of_bars_side_by_side_stay_two(apart, bar, gap, is_along):
    stair = buildings.Plain(n_risers=4)
    built = buildings.of_bars(stair, bar, gap, is_along).building
    points = [scan_building(built, replace(TLS, seed=seed)).points for seed in (1, 2)]
    shift = np.array([0.0, stair.width_m + apart, 0.0])
    middle = shift[1] / 2.0
    both = np.concatenate(
        [points[0][points[0][:, 1] < middle], (points[1] + shift)[points[1][:, 1] >= middle - shift[1]]]
    )
    inspection = found(both)
    assert [flight.n_risers for flight in inspection.flights] == [4, 4]
    assert all(abs(step.width_m.value - stair.width_m) <= step.width_m.u < 0.02 for step in inspection.steps)
