"""What is chosen: a step or a surface, never both, wherever the wish came from."""

import contextlib
import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest

from stair_inspector.errors import ConfigError
from stair_inspector.viewer.parts.desk import Desk, Shown
from stair_inspector.viewer.parts.steps.results import Results, _read_choice
from tests.viewer.surveyed import PALETTE, surveyed


@pytest.mark.parametrize(
    ("words", "chosen"),
    [("none", (None, None)), ("3", (3, None)), ("surface 12", (None, 12)), ("surface 0", (None, 0))],
)
def test_a_choice_is_a_step_a_surface_or_nothing(words, chosen):
    assert _read_choice(words) == chosen


@pytest.mark.parametrize("words", ["", "surface", "x", "<b>", None, [1], "surface x", "1.5"])
def test_what_names_neither_is_a_sentence(words):
    with pytest.raises(ConfigError, match=r"^step: got .*; give a number"):
        _read_choice(words)


def choosing(selected, patch, **changes):
    """Results that have a choice, and show nothing."""
    scan, inspection, display = surveyed()
    params = inspection.params.replaced("method", changes.get("method", "survey"))
    client = SimpleNamespace(atomic=contextlib.nullcontext)
    desk = Desk(client, None, (PALETTE, PALETTE), None)
    desk.shown = Shown("a", scan, display, dataclasses.replace(inspection, params=params))
    desk.selected, desk.selected_patch = selected, patch
    results = Results(desk, None)
    results.show_selection = lambda **_: None
    return results, desk, inspection


@pytest.mark.parametrize(("selected", "patch", "owner"), [(2, None, 2), (5, None, 5), (None, 7, 7), (None, 6, 6)])
def test_a_decision_is_about_the_centroid_of_what_is_chosen_in_the_scans_frame(selected, patch, owner):
    results, _, inspection = choosing(selected, patch)
    wanted = inspection.patches[owner].plane.centroid + np.array([100.0, 200.0, 300.0])
    assert results.chosen_place() == pytest.approx(tuple(wanted))


def test_a_step_without_a_surface_of_its_own_is_found_by_its_plane():
    results, desk, inspection = choosing(2, None)
    desk.shown = Shown("a", desk.shown.scan, desk.shown.display, dataclasses.replace(inspection, patches=()))
    wanted = inspection.steps[1].plane.centroid + np.array([100.0, 200.0, 300.0])
    assert results.chosen_place() == pytest.approx(tuple(wanted))


def test_a_decision_about_nothing_or_about_the_papers_steps_is_a_sentence():
    with pytest.raises(ConfigError, match="choose a step or a rejected surface first"):
        choosing(None, None)[0].chosen_place()
    with pytest.raises(ConfigError, match="paper's method takes no decisions"):
        choosing(2, None, method="paper")[0].chosen_place()
    with pytest.raises(ConfigError, match="no longer there"):
        choosing(None, 99)[0].chosen_place()


def test_arrow_keys_walk_over_the_steps_and_stop_at_the_ends():
    results, desk, inspection = choosing(None, None)
    last = len(inspection.steps)
    results.move(1)
    assert desk.selected == 1
    results.move(-1)
    assert desk.selected == 1
    desk.selected = None
    results.move(-1)
    assert desk.selected == last
    results.move(1)
    assert desk.selected == last


def test_a_second_click_on_a_row_puts_the_selection_away():
    results, desk, _ = choosing(None, None)
    results.pick("3:123")
    assert (desk.selected, desk.selected_patch) == (3, None)
    results.pick("surface 7:124")
    assert (desk.selected, desk.selected_patch) == (None, 7)
    results.pick("surface 7:125")
    assert (desk.selected, desk.selected_patch) == (None, None)


@pytest.mark.parametrize("message", ["99:1", "surface 1:2", "flight x:3"])
def test_a_row_that_does_not_exist_is_a_sentence(message):
    with pytest.raises(ConfigError):
        choosing(None, None)[0].pick(message)
