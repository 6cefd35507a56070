"""The percentile look-up is numpy's, to the last bit."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stair_inspector.geometry.percentiles import mad_sigma, median, percentile_of_sorted, percentiles

coordinates = st.lists(st.floats(-1e6, 1e6), min_size=1, max_size=200)


@given(coordinates, st.floats(0.0, 100.0))
def test_equals_numpy_to_the_last_bit(values, percent):
    ordered = np.sort(np.array(values))
    assert percentile_of_sorted(ordered, percent) == float(np.percentile(ordered, percent))


@given(coordinates, st.integers(0, 200).map(lambda half: half / 2.0))
def test_equals_numpy_at_every_position_of_a_slider(values, percent):
    ordered = np.sort(np.array(values))
    assert percentile_of_sorted(ordered, percent) == float(np.percentile(ordered, percent))


@given(coordinates, st.floats(0.0, 100.0))
def test_medians_and_percentiles_of_values_in_any_order_are_numpys_to_the_last_bit(values, percent):
    values = np.array(values)
    assert median(values) == float(np.median(values))
    assert percentiles(values, percent, 99.5) == list(np.percentile(values, [percent, 99.5]))


def test_the_median_of_none_is_not_a_number():
    assert np.isnan(median(np.zeros(0)))


@pytest.mark.parametrize("n", [1, 2, 3, 20, 21, 101, 997, 100_003])
def test_equals_numpy_at_every_length(n):
    ordered = np.sort(np.random.default_rng(n).normal(size=n))
    for percent in (0.0, 1.0, 5.0, 33.3, 50.0, 95.0, 99.0, 100.0):
        assert percentile_of_sorted(ordered, percent) == float(np.percentile(ordered, percent))


@pytest.mark.parametrize(("percent", "expected"), [(0, 10.0), (25, 20.0), (50, 30.0), (60, 34.0), (100, 50.0)])
def test_hand_computed(percent, expected):
    assert percentile_of_sorted(np.array([10.0, 20.0, 30.0, 40.0, 50.0]), percent) == expected


def test_the_scatter_by_medians_is_that_of_normal_values_and_heeds_no_stray():
    values = np.random.default_rng(3).normal(5.0, 0.2, 20_000)
    assert mad_sigma(values) == pytest.approx(0.2, rel=0.03)
    assert mad_sigma(np.append(values, np.full(500, 1e6))) == pytest.approx(0.2, rel=0.07)
