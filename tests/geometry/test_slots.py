"""Slots that part a surface from its front to its back, among gaps that do not."""

import numpy as np
import pytest

from stair_inspector.geometry.slots import find_slots, with_common_slots

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


def twins(bar, gap, apart, n_treads=5, n_bars=10):
    """The sides of some treads, each of two rows of bars so far apart."""
    first = bars(0.0, n_bars * (bar + gap) - gap, bar, gap)
    end = first[-1][1] + apart
    second = [(low + end, high + end) for low, high in first]
    treads = [across(*first, *second, seed=seed) for seed in range(n_treads)]
    return [find_slots(tread, SPACING, is_barred=True) for tread in treads], end - apart / 2.0


@pytest.mark.parametrize(("bar", "gap", "apart"), [(0.03, 0.041, 0.05), (0.06, 0.03, 0.04), (0.02, 0.055, 0.065)])
def test_a_gap_that_is_a_little_wider_on_all_treads_is_a_slot(bar, gap, apart):
    sides, middle = twins(bar, gap, apart)
    assert not any(each.slots for each in sides)
    for each in with_common_slots(sides):
        ((start, stop),) = each.slots
        assert (start + stop) / 2.0 == pytest.approx(middle, abs=0.004)


def test_a_gap_like_the_others_is_a_slot_only_where_a_whole_surface_has_one():
    sides, middle = twins(0.03, 0.041, 0.041)
    assert not any(each.slots for each in with_common_slots(sides))
    for each in with_common_slots(sides, [(middle - 0.02, middle + 0.02)]):
        assert len(each.slots) == 1
    assert with_common_slots(sides, [(0.0, 0.01)]) == list(sides)


def test_a_wider_gap_on_one_tread_is_a_bar_that_lies_aside():
    sides = twins(0.03, 0.041, 0.05, n_treads=1)[0] + twins(0.03, 0.041, 0.041, n_treads=4)[0]
    assert not any(each.slots for each in with_common_slots(sides))
