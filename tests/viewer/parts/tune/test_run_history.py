"""The last results by their settings: one entry for a drag, none twice, each scan's own."""

import dataclasses

import pytest

from stair_inspector.viewer.parts.tune.run_history import MOST_RUNS, RunHistory
from tests.viewer.surveyed import surveyed


@pytest.fixture(scope="module")
def inspection():
    return surveyed()[1]


class Clock:
    def __init__(self):
        self.now = 100.0

    def __call__(self):
        return self.now


@pytest.fixture
def told(inspection):
    """A history, and what tells it a result with one setting changed, some seconds after the last."""
    clock = Clock()
    history = RunHistory(clock)

    def tell(value_mm=20, after_s=10.0, name="levels.eps_m", scan=inspection.scan):
        clock.now += after_s
        params = inspection.params.replaced(name, value_mm / 1000.0)
        history.record(dataclasses.replace(inspection, params=params, scan=scan))

    return history, tell


def titles(history, inspection):
    return [run.title for run in history.of(inspection.scan.sha256)]


def test_every_result_is_remembered_by_what_was_changed_for_it(told, inspection):
    history, tell = told
    for value_mm in (20, 21, 30):
        tell(value_mm)
    assert titles(history, inspection) == [
        "#3 ε_z 21 mm to 30 mm, 5 steps",
        "#2 ε_z 20 mm to 21 mm, 5 steps",
        "#1 first result, 5 steps",
    ]
    assert [run.params.levels.eps_m for run in history.of(inspection.scan.sha256)] == [0.030, 0.021, 0.020]


def test_a_drag_of_a_slider_is_one_entry(told, inspection):
    history, tell = told
    tell(20)
    for value_mm in (21, 25, 33):
        tell(value_mm, after_s=0.3)
    assert titles(history, inspection) == ["#2 ε_z 20 mm to 33 mm, 5 steps", "#1 first result, 5 steps"]
    # The same setting later is another change.
    tell(34)
    assert len(titles(history, inspection)) == 3


def test_settings_that_come_back_are_not_listed_twice(told, inspection):
    history, tell = told
    for value_mm in (20, 21, 20, 22):
        tell(value_mm)
    assert titles(history, inspection) == [
        "#3 ε_z 20 mm to 22 mm, 5 steps",
        "#2 ε_z 20 mm to 21 mm, 5 steps",
        "#1 first result, 5 steps",
    ]


def test_the_history_is_short_and_each_scan_has_its_own(told, inspection):
    history, tell = told
    other = dataclasses.replace(inspection.scan, sha256="f" * 64)
    tell(77, scan=other)
    for value_mm in range(20, 20 + MOST_RUNS + 3):
        tell(value_mm)
    own = history.of(inspection.scan.sha256)
    assert len(own) == MOST_RUNS
    assert own[0].params.levels.eps_m == pytest.approx(0.019 + (MOST_RUNS + 3) / 1000.0)
    assert [run.params.levels.eps_m for run in history.of(other.sha256)] == [0.077]
    history.forget(own[0].number)
    assert history.of(inspection.scan.sha256) == own[1:]
