"""A part of a surface that lies higher than the rest is told from what is worn, rounded, bent or merely noisy."""

import numpy as np
import pytest

from stair_inspector.geometry import raised
from stair_inspector.geometry.raised import find_raised

DEPTH, WIDTH = 0.28, 1.1


def surface(seed=1, sigma_m=0.001, n=8000):
    rng = np.random.default_rng(seed)
    plan = rng.uniform([[0.0], [0.0]], [[DEPTH], [WIDTH]], (2, n))
    return plan, 0.02 * plan[0] - 0.01 * plan[1] + sigma_m * rng.standard_normal(n), rng


def is_on(plan, x=(0.0, DEPTH), y=(0.6, 1.0)):
    return (plan[0] >= x[0]) & (plan[0] <= x[1]) & (plan[1] >= y[0]) & (plan[1] <= y[1])


@pytest.mark.parametrize(("high_m", "sigma_m"), [(0.003, 0.001), (0.006, 0.001), (0.01, 0.001), (0.01, 0.003)])
@pytest.mark.parametrize("place", [{}, {"x": (0.1, 0.25), "y": (0.1, 0.8)}, {"y": (0.0, 0.4)}, {"y": (0.25, 0.85)}])
def test_what_lies_on_a_part_is_found_with_its_height_and_its_place(high_m, sigma_m, place):
    plan, z, _ = surface(sigma_m=sigma_m)
    covered = is_on(plan, **place)
    found = find_raised(plan, z + high_m * covered)
    assert found.high_m == pytest.approx(high_m, abs=0.0004)
    assert found.share == pytest.approx(covered.mean(), abs=0.06)
    high, mixed = found.of(plan)
    assert np.mean(high[~mixed] == covered[~mixed]) > 0.995


def uneven(kind, plan, rng):
    x, y = plan[0] / DEPTH, plan[1] / WIDTH
    lumps = rng.standard_normal((8, 24))
    return {
        "flat": 0.0 * x,
        "worn in the middle": -0.02 * x * (1.0 - x) * (1.0 - (2.0 * y - 1.0) ** 2),
        "worn along the nosing": -0.006 * np.exp(-(((x - 0.15) / 0.2) ** 2)) * np.exp(-(((y - 0.5) / 0.25) ** 2)),
        "rounded at the nosing": -0.01 * np.clip(1.0 - plan[0] / 0.03, 0.0, 1.0) ** 2,
        "bent": 0.006 * np.abs(y - 0.5),
        "bowed": 0.01 * (y - 0.5) ** 2,
        "noise in patches": 0.001 * lumps[(x * 3.5).astype(int), (y * 13.7).astype(int)],
        "stray points": np.where(rng.uniform(size=len(x)) < 0.05, rng.uniform(-0.03, 0.03, len(x)), 0.0),
    }[kind]


@pytest.mark.parametrize("sigma_m", [0.0003, 0.001, 0.004])
@pytest.mark.parametrize(
    "kind",
    [
        "flat",
        "worn in the middle",
        "worn along the nosing",
        "rounded at the nosing",
        "bent",
        "bowed",
        "noise in patches",
        "stray points",
    ],
)
def test_what_is_worn_bent_or_noisy_is_no_two_levels(kind, sigma_m):
    plan, z, rng = surface(2, sigma_m)
    assert find_raised(plan, z + uneven(kind, plan, rng)) is None


def test_a_surface_of_one_level_is_told_in_one_round(monkeypatch):
    plan, z, _ = surface(sigma_m=0.0003)
    rounds = []
    monkeypatch.setattr(raised, "_otsu", lambda values: rounds.append(1) or float(np.median(values)))
    assert find_raised(plan, z) is None
    assert len(rounds) == 1


def test_few_points_say_nothing():
    plan, z, _ = surface(3, n=60)
    assert find_raised(plan, z + 0.01 * is_on(plan)) is None
