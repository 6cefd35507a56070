"""A stage runs again where an input has changed, and what follows it only where its result has."""

from dataclasses import dataclass

import numpy as np
import pytest

from stair_inspector.memo import Memo


@dataclass(frozen=True, eq=False)
class Found:
    """Something that a stage may give."""

    places: np.ndarray
    notes: tuple[str, ...] = ()


def of_tenths(value):
    return Found(np.arange(3.0) + value // 10, ("as always",))


def test_a_stage_that_gives_the_same_values_again_gives_the_same_object():
    memo = Memo()
    first = memo.run("found", of_tenths, 11)
    assert memo.run("found", of_tenths, 12) is first
    assert "found" in memo.timings_s
    other = memo.run("found", of_tenths, 21)
    assert other is not first
    assert other.places[0] == 2.0


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (np.zeros(3), np.zeros(4)),
        (np.zeros(3), np.zeros(3, dtype=np.int64)),
        (np.array([1.0, np.nan]), np.array([1.0, np.nan])),
        ((1, 2), (1, 3)),
        ((1, 2), (1, 2, 3)),
        ([1], (1,)),
        ({"a": np.zeros(2)}, {"a": np.ones(2)}),
        ({"a": 1}, {"b": 1}),
        (1, 1.0),
        (Found(np.zeros(2)), Found(np.zeros(2), ("other",))),
        (None, Found(np.zeros(2))),
    ],
)
def test_what_differs_in_a_value_a_type_or_a_shape_is_another_result(one, other):
    memo = Memo()
    results = [one, other]
    assert memo.run("found", results.__getitem__, 0) is one
    assert memo.run("found", results.__getitem__, 1) is other


@pytest.mark.parametrize(
    "make", [lambda: (1, ["a"], {"b": (np.arange(4), 2.5)}), lambda: None, lambda: Found(np.ones((2, 3)))]
)
def test_what_differs_in_nothing_is_the_last_result(make):
    memo = Memo()
    first = memo.run("found", lambda _: make(), 0)
    assert memo.run("found", lambda _: make(), 1) is first
