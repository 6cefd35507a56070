"""One inspector's runs without a page: what is told, when it is cancelled, and what a failure leaves behind."""

import threading
import time
from types import SimpleNamespace

import pytest

from stair_inspector.errors import ReadError
from stair_inspector.viewer.compute.heavy_process import Cancelled
from stair_inspector.viewer.compute.runs import CANCELLED, Listener, Request, Runs
from tests.synthetic import Stair, exact_params

LONG_S = 20.0


class Waiting:
    """In the place of the workshop: reads at once, and computes heavy stages only when let go."""

    def __init__(self, scan):
        self.scan = scan
        self.gate = threading.Event()
        self.has_begun = threading.Event()

    def read(self, path, reading, is_wanted):
        if path == "broken":
            raise ReadError("broken.ply: is damaged; export it again")
        return self.scan

    def heavy(self, function, *inputs, is_wanted):
        self.has_begun.set()
        while not self.gate.wait(0.01):
            if not is_wanted():
                raise Cancelled
        return function(*inputs)


@pytest.fixture(scope="module")
def scan():
    return Stair(noise=0.001, risers=True).scan()


PARAMS = exact_params(up="z")


@pytest.fixture
def made(scan):
    """Runs whose heavy stages wait, the workshop that lets them go, and what was told."""
    runs, workshop, told = make_runs(scan)
    yield runs, workshop, told
    workshop.gate.set()
    runs.close()


def make_runs(scan):
    told = SimpleNamespace(done=[], failed=[], progress=[], logged=[])
    workshop = Waiting(scan)
    listener = Listener(
        find=lambda request, read: (request, read(request.params.reading)),
        done=lambda request, scan, inspection, prepared: told.done.append((request, inspection, prepared)),
        failed=told.failed.append,
        progress=told.progress.append,
    )
    runs = Runs(workshop, listener, SimpleNamespace(log=told.logged.append), "test")
    return runs, workshop, told


def await_true(condition):
    ends = time.monotonic() + LONG_S
    while not condition():
        assert time.monotonic() < ends
        time.sleep(0.005)


# Normals that are estimated are a heavy stage.
HEAVY = PARAMS.replaced("normals.source", "estimate")


def test_a_run_tells_its_result_with_what_it_prepared(made, scan):
    runs, workshop, told = made
    workshop.gate.set()
    runs.submit(Request("a", HEAVY), "path")
    await_true(lambda: told.done)
    request, inspection, prepared = told.done[0]
    assert request == Request("a", HEAVY)
    assert len(inspection.steps) > 2
    assert prepared.normals.shape == scan.points.shape
    assert len(prepared.heights.point_ids) == len(scan.points)
    assert told.failed == []


def test_a_run_that_takes_long_is_announced_by_stage_and_can_be_cancelled(made):
    runs, workshop, told = made
    runs.submit(Request("a", HEAVY), "path")
    assert workshop.has_begun.wait(LONG_S)
    # A slow machine announces a stage before this one too.
    await_true(lambda: told.progress and told.progress[-1].words.startswith("estimating normals of "))
    assert 0.0 < told.progress[-1].percent < 100.0
    runs.cancel()
    await_true(lambda: told.failed)
    assert told.failed == [CANCELLED]
    assert told.done == told.logged == []
    # The next wish is not cancelled with it.
    workshop.gate.set()
    runs.submit(Request("a", HEAVY), "path")
    await_true(lambda: told.done)


def test_a_short_run_is_not_announced(made):
    runs, workshop, told = made
    workshop.gate.set()
    runs.submit(Request("a", HEAVY), "path")
    await_true(lambda: told.done)
    n_told = len(told.progress)
    runs.submit(Request("a", HEAVY.replaced("edges.front_percentile", 90.0)), "path")
    await_true(lambda: len(told.done) == 2)
    assert len(told.progress) == n_told


def test_a_failure_is_its_sentence_and_the_next_run_works(made):
    runs, workshop, told = made
    workshop.gate.set()
    runs.submit(Request("broken", HEAVY), "broken")
    await_true(lambda: told.failed)
    assert told.failed == ["broken.ply: is damaged; export it again"]
    runs.submit(Request("a", HEAVY), "path")
    await_true(lambda: told.done)


def test_what_nobody_foresaw_is_a_sentence_and_in_the_log(made, monkeypatch):
    runs, _, told = made
    monkeypatch.setattr("stair_inspector.viewer.compute.runs.inspect", lambda *_: 1 / 0)
    runs.submit(Request("a", HEAVY), "path")
    await_true(lambda: told.failed)
    assert "internal error" in told.failed[0]
    assert told.logged


def test_closing_gives_up_what_was_being_computed_and_says_nothing(made):
    runs, workshop, told = made
    runs.submit(Request("a", HEAVY), "path")
    assert workshop.has_begun.wait(LONG_S)
    runs.close()
    await_true(lambda: not runs.is_busy() or told.failed)
    time.sleep(0.1)
    assert told.failed == told.done == []


def test_a_run_that_waits_is_cancelled_with_the_one_in_progress(made):
    runs, workshop, told = made
    runs.submit(Request("a", HEAVY), "path")
    assert workshop.has_begun.wait(LONG_S)
    runs.submit(Request("a", HEAVY.replaced("edges.front_percentile", 90.0)), "path")
    runs.cancel()
    workshop.gate.set()
    await_true(lambda: not runs.is_busy())
    assert set(told.failed) == {CANCELLED}
    assert told.done == []


def test_another_scan_waits_for_no_run_of_the_scan_that_was_left(made):
    runs, workshop, told = made
    runs.submit(Request("a", HEAVY), "path")
    assert workshop.has_begun.wait(LONG_S)
    workshop.has_begun.clear()
    # The first scan's normals are not there yet: only a run that is given up lets the next one begin.
    runs.submit(Request("b", HEAVY), "path")
    assert workshop.has_begun.wait(LONG_S)
    workshop.gate.set()
    await_true(lambda: told.done)
    assert [request.label for request, _, _ in told.done] == ["b"]
    assert told.failed == [], "nobody has cancelled anything"
