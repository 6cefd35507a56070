"""Earlier results and sweeps without a page: what is listed, what is measured for it, and what a Cancel leaves."""

import contextlib
import dataclasses
import threading
import time
from types import SimpleNamespace

import pytest

from stair_inspector.params import FileReading, Params
from stair_inspector.pipeline import inspect
from stair_inspector.viewer.compute.heavy_process import Cancelled
from stair_inspector.viewer.parts.desk import Shown
from stair_inspector.viewer.parts.tune.runs import AS_SHOWN, NO_RUN, RunComparison
from stair_inspector.viewer.parts.tune.sweeping import SweepTool
from tests.synthetic import Stair, exact_params

LONG_S = 20.0
# Normals that are estimated are a heavy stage.
PARAMS = exact_params(up="z").replaced("normals.source", "estimate")


class Widgets:
    """In the place of a page's: what is made holds its value and has no page to show it on."""

    def folder(self, title, **_):
        return contextlib.nullcontext()

    def html(self, content=""):
        return SimpleNamespace(content=content)

    def text(self, label, value="", **_):
        return SimpleNamespace(value=value)

    def dropdown(self, label, options, is_visible=True, **_):
        return SimpleNamespace(value=options[0], options=options, visible=is_visible)

    def buttons(self, label, options, on_press, is_visible=True, **_):
        return SimpleNamespace(visible=is_visible)

    def button(self, label, action, is_visible=True, **_):
        return SimpleNamespace(visible=is_visible)


class Desk:
    def __init__(self, shown):
        self.shown, self.unit, self.is_closed, self.lock = shown, "mm", False, threading.RLock()
        self.client, self.told = SimpleNamespace(client_id=1), []
        self.notices = SimpleNamespace(tell=lambda *words, **_: self.told.append(words), log=self.told.append)

    def result(self, what):
        return self.shown


class Workshop:
    """Computes heavy stages when let go; ``asked`` are the units in which the file was read."""

    def __init__(self, scans):
        self.scans, self.asked, self.n_heavy = scans, [], 0
        self.gate = threading.Event()
        self.gate.set()

    def read(self, path, reading, is_wanted):
        self.asked.append((path, reading))
        return self.scans[reading.unit]

    def heavy(self, function, *inputs, is_wanted):
        self.n_heavy += 1
        while not self.gate.wait(0.005):
            if not is_wanted():
                raise Cancelled
        return function(*inputs)


class Editor:
    def __init__(self):
        self.work, self.applied, self.comparing = SimpleNamespace(runs=()), [], None

    def edit(self, words, change):
        self.work.runs = change(self.work)["runs"]
        self.comparing.show()

    def adjust(self, change, words):
        self.applied.append((change(PARAMS.replaced("levels.min_points", 7)), words))


@pytest.fixture(scope="module")
def measured():
    scan = Stair(noise=0.001, risers=True).scan()
    return scan, inspect(scan, PARAMS)


@pytest.fixture
def page(measured):
    scan, inspection = measured
    desk, editor = Desk(Shown("stair.ply", scan, None, inspection)), Editor()
    workshop = Workshop({"mm": scan})
    keeper = SimpleNamespace(scan="folder/stair.ply")
    context = SimpleNamespace(desk=desk, editor=editor, keeper=keeper, workshop=workshop, widgets=Widgets())
    comparing, sweeps = RunComparison(context), SweepTool(context)
    sweeps.setting.value, sweeps.quantity.value = "m", "Mean rise"
    editor.comparing = comparing
    comparing.show()
    yield SimpleNamespace(desk=desk, editor=editor, workshop=workshop, comparing=comparing, sweeps=sweeps, scan=scan)
    desk.is_closed = True
    workshop.gate.set()
    comparing.close()
    sweeps.close()


def await_true(condition):
    ends = time.monotonic() + LONG_S
    while not condition():
        assert time.monotonic() < ends
        time.sleep(0.005)


def titles_of(page):
    return page.comparing.menu_a.options[1:]


def show_result(page, **changes):
    """Show another result, as a run does."""
    shown = page.desk.shown
    inspection = dataclasses.replace(shown.inspection, **changes)
    page.desk.shown = dataclasses.replace(shown, inspection=inspection, scan=changes.get("scan", shown.scan))
    page.comparing.show()
    page.sweeps.show()


def with_m(value):
    return PARAMS.replaced("levels.min_points", value)


def test_every_result_is_in_the_history_and_two_earlier_ones_are_compared(page):
    for value in (100, 400):
        show_result(page, params=with_m(value))
        # The next change comes long after, so that it is no drag.
        page.comparing._history._clock = lambda value=value: 1e6 + value
    assert [title.split(" ")[:2] for title in titles_of(page)] == [["#3", "m"], ["#2", "m"], ["#1", "first"]]
    page.comparing.compare_with("#1 first result, 5 steps")
    await_true(lambda: "comparison-table" in page.comparing.comparison.content)
    assert "<b>A:</b> #1 first result, 5 steps · <b>B:</b> what is shown" in page.comparing.comparison.content
    second = next(title for title in titles_of(page) if title.startswith("#2"))
    page.comparing.compare_to(second)
    await_true(lambda: f"<b>B:</b> {second}" in page.comparing.comparison.content)
    assert (page.comparing.menu_a.value, page.comparing.menu_b.value) == ("#1 first result, 5 steps", second)
    page.comparing.take_settings()
    assert page.editor.applied == [(PARAMS, "settings of #1 first result, 5 steps")]
    page.comparing.forget()
    assert "#1 first result, 5 steps" not in titles_of(page)
    assert page.comparing.comparison.content == ""


def test_a_kept_run_is_measured_once_and_forgotten_for_good(page):
    page.comparing.keep("narrow  bands")
    assert titles_of(page)[0] == page.comparing.menu_a.value == "narrow bands"
    assert "The settings are the same." in page.comparing.comparison.content
    assert page.workshop.n_heavy == 0, "it has just been measured"
    page.comparing.forget()
    assert page.comparing.menu_a.value == NO_RUN
    assert page.comparing._made == []


def test_a_kept_run_that_fails_says_why_and_is_not_measured_at_every_result(page, monkeypatch):
    page.comparing.keep("one")
    calls = []

    def fail(scan, params, memo):
        calls.append(params)
        return inspect(scan, params.replaced("levels.min_points", 10**6), memo)

    monkeypatch.setattr("stair_inspector.viewer.parts.tune.runs.inspect", fail)
    monkeypatch.setattr(page.comparing, "_made", [])
    show_result(page, params=with_m(90))
    await_true(lambda: calls and "measuring" not in page.comparing.comparison.content)
    refused = page.comparing.comparison.content
    for value in (91, 92, 93):
        show_result(page, params=with_m(value))
    time.sleep(0.1)
    assert len(calls) == 1
    assert "one: " in refused


def test_a_cancel_ends_one_comparison_and_none_after_it(page):
    page.comparing.keep("one")
    page.comparing._made.clear()
    page.workshop.gate.clear()
    show_result(page, params=with_m(90))
    await_true(lambda: page.workshop.n_heavy == 1)
    page.comparing.cancel()
    await_true(lambda: "cancelled" in page.comparing.comparison.content)
    page.workshop.gate.set()
    page.comparing.compare_with(NO_RUN)
    page.comparing.compare_with("one")
    await_true(lambda: "comparison-table" in page.comparing.comparison.content)


def test_a_cancel_ends_a_comparison_that_further_results_have_asked_for_again(page):
    page.comparing.keep("one")
    page.comparing._made.clear()
    page.workshop.gate.clear()
    for value in (90, 91, 92):
        show_result(page, params=with_m(value))
        await_true(lambda: page.workshop.n_heavy == 1)
    page.comparing.cancel()
    await_true(lambda: "cancelled" in page.comparing.comparison.content)
    show_result(page, params=with_m(93))
    time.sleep(0.05)
    assert page.workshop.n_heavy == 1


def test_what_nobody_foresaw_is_said_once_and_in_the_log(page, monkeypatch):
    page.comparing.keep("one")
    page.comparing._made.clear()
    monkeypatch.setattr("stair_inspector.viewer.parts.tune.runs.inspect", lambda *_: 1 / 0)
    for value in (90, 91, 92):
        show_result(page, params=with_m(value))
        await_true(lambda: "one: an internal error" in page.comparing.comparison.content)
    await_true(lambda: len(page.desk.told) == 2)
    assert page.desk.told[0] == "a comparison or a sweep failed"


@pytest.mark.slow
def test_a_sweep_is_not_dropped_for_a_comparison_nor_held_up_by_one(page):
    page.comparing.keep("one")
    page.comparing._made.clear()
    page.workshop.gate.clear()
    page.sweeps.start()
    await_true(lambda: page.workshop.n_heavy == 1)
    show_result(page, params=with_m(90))
    page.sweeps.start()
    show_result(page, params=with_m(91))
    page.workshop.gate.set()
    await_true(lambda: "comparison-table" in page.comparing.comparison.content)
    await_true(lambda: 'data-complete="true"' in page.sweeps.swept.content)
    await_true(lambda: not page.sweeps.stop.visible)


def test_a_sweep_that_is_stopped_offers_the_next(page):
    page.workshop.gate.clear()
    page.sweeps.start()
    await_true(lambda: page.workshop.n_heavy == 1)
    assert page.sweeps.stop.visible
    page.sweeps.cancel()
    await_true(lambda: not page.sweeps.stop.visible)


@pytest.mark.slow
def test_the_sweep_is_in_the_present_unit_and_goes_with_its_scan(page):
    page.sweeps.start()
    await_true(lambda: 'data-complete="true"' in page.sweeps.swept.content)
    assert ">mm</text>" in page.sweeps.swept.content
    page.desk.unit = "in"
    page.sweeps.show()
    assert ">in</text>" in page.sweeps.swept.content
    scan = page.desk.shown.inspection.scan
    show_result(page, scan=dataclasses.replace(scan, sha256="f" * 64))
    assert page.sweeps.swept.content == ""
    assert titles_of(page) == ("#2 first result, 5 steps",), "the history is that of the scan"


def test_a_run_in_another_unit_is_measured_on_the_scan_read_in_that_unit(page):
    page.comparing.keep("metres")
    page.comparing._made.clear()
    kept = dataclasses.replace(page.editor.work.runs[0], params=PARAMS.replaced("unit", "mm"))
    page.editor.edit("", lambda work: {"runs": (kept,)})
    await_true(lambda: "comparison-table" in page.comparing.comparison.content)
    assert page.workshop.asked == [("folder/stair.ply", FileReading("mm"))]


@pytest.mark.parametrize("name", [NO_RUN, AS_SHOWN])
def test_no_two_options_of_a_menu_are_the_same(page, name):
    page.editor.work.runs = (SimpleNamespace(name=name, params=Params()),)
    page.editor.work.runs += (SimpleNamespace(name="#1 first result, 5 steps", params=Params()),)
    page.comparing.show()
    options = (NO_RUN, AS_SHOWN, *titles_of(page))
    assert len(set(options)) == len(options)
    assert "#1 first result, 5 steps (history)" in options
