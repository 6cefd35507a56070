"""Slots that part a surface from its front to its back, among gaps that do not."""

import numpy as np
import pytest

from stair_inspector.geometry.slots import find_slots

SPACING = 0.007


def across(*ranges, n_per_m=3000, seed=1):
    rng = np.random.default_rng(seed)
    return np.concatenate([rng.uniform(low, high, round(n_per_m * (high - low))) for low, high in ranges])


def bars(low, high, bar, gap):
    return [(start, start + bar) for start in np.arange(low, high - bar + 1e-9, bar + gap)]


@pytest.mark.parametrize("slot", [0.05, 0.1, 0.15])
def test_a_slot_between_two_surfaces_is_found_where_it_is(slot):
    found = find_slots(across((0.0, 1.0), (1.0 + slot, 2.0 + slot)), SPACING)
    ((start, stop),) = found.slots
    assert abs(start - 1.0) < 0.005
    assert abs(stop - 1.0 - slot) < 0.005
    assert found.low == pytest.approx(0.0, abs=0.02)
    assert found.high == pytest.approx(2.0 + slot, abs=0.02)
    assert not found.reaches_over(0.9, 1.2)
    assert found.reaches_over(0.2, 0.9)
    assert not found.reaches_over(0.9, 2.5)


def test_stray_points_do_not_fill_a_slot_and_small_gaps_are_none():
    assert len(find_slots(np.append(across((0.0, 1.0), (1.1, 2.0)), [1.03, 1.06]), SPACING).slots) == 1
    assert not find_slots(across((0.0, 1.0), (1.02, 2.0)), SPACING).slots
    # Where the points are as far apart as that, a range without any is chance.
    assert not find_slots(across((0.0, 1.0), (1.05, 2.0)), 0.02).slots


@pytest.mark.parametrize(("bar", "gap"), [(0.03, 0.04), (0.06, 0.06), (0.02, 0.012)])
def test_the_gaps_between_bars_are_no_slots_but_a_wider_one_is(bar, gap):
    first = bars(0.0, 1.1, bar, gap)
    assert not find_slots(across(*first), SPACING, is_barred=True).slots
    second = [(low + first[-1][1] + 0.1, high + first[-1][1] + 0.1) for low, high in first]
    ((start, stop),) = find_slots(across(*first, *second), SPACING, is_barred=True).slots
    assert stop - start == pytest.approx(0.1, abs=0.006)


def test_few_points_tell_no_slot():
    assert find_slots(np.array([0.0, 0.5]), SPACING).slots == ()
