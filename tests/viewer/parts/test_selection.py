"""What is chosen: a step or a surface, never both, wherever the wish came from."""

import dataclasses

import numpy as np
import pytest

from stair_inspector.errors import ConfigError
from stair_inspector.viewer.parts.desk import Desk, Shown
from stair_inspector.viewer.parts.steps.verdicts import place_of
from stair_inspector.viewer.parts.table import pick_row, read_choice
from tests.viewer.surveyed import PALETTE, surveyed


@pytest.mark.parametrize(
    ("words", "chosen"),
    [("none", (None, None)), ("3", (3, None)), ("surface 12", (None, 12)), ("surface 0", (None, 0))],
)
def test_a_choice_is_a_step_a_surface_or_nothing(words, chosen):
    assert read_choice(words) == chosen


@pytest.mark.parametrize("words", ["", "surface", "x", "<b>", None, [1], "surface x", "1.5"])
def test_what_names_neither_is_a_sentence(words):
    with pytest.raises(ConfigError, match=r"^step: got .*; give a number"):
        read_choice(words)


def choosing(selected, patch, **changes):
    """A desk on which a choice was made, of a page that shows nothing."""
    scan, inspection, display = surveyed()
    params = inspection.params.replaced("method", changes.get("method", "survey"))
    desk = Desk(None, None, (PALETTE, PALETTE), None)
    desk.shown = Shown("a", scan, display, dataclasses.replace(inspection, params=params))
    desk.selected, desk.selected_patch = selected, patch
    return desk


def chosen_place(desk):
    return place_of(desk.inspection, desk.selected, desk.selected_patch)


@pytest.mark.parametrize(("selected", "patch", "owner"), [(2, None, 2), (5, None, 5), (None, 7, 7), (None, 6, 6)])
def test_a_decision_is_about_the_centroid_of_what_is_chosen_in_the_scans_frame(selected, patch, owner):
    desk = choosing(selected, patch)
    wanted = desk.inspection.patches[owner].plane.centroid + np.array([100.0, 200.0, 300.0])
    assert chosen_place(desk) == pytest.approx(tuple(wanted))


def test_a_step_without_a_surface_of_its_own_is_found_by_its_plane():
    desk = choosing(2, None)
    inspection = desk.inspection
    desk.shown = Shown("a", desk.shown.scan, desk.shown.display, dataclasses.replace(inspection, patches=()))
    wanted = inspection.steps[1].plane.centroid + np.array([100.0, 200.0, 300.0])
    assert chosen_place(desk) == pytest.approx(tuple(wanted))


def test_a_decision_about_nothing_or_about_the_papers_steps_is_a_sentence():
    with pytest.raises(ConfigError, match="choose a step or a rejected surface first"):
        chosen_place(choosing(None, None))
    with pytest.raises(ConfigError, match="paper's method takes no decisions"):
        chosen_place(choosing(2, None, method="paper"))
    with pytest.raises(ConfigError, match="no longer there"):
        chosen_place(choosing(None, 99))


def test_arrow_keys_walk_over_the_steps_and_stop_at_the_ends():
    desk = choosing(None, None)
    last = len(desk.inspection.steps)
    desk.move(1)
    assert desk.selected == 1
    desk.move(-1)
    assert desk.selected == 1
    desk.selected = None
    desk.move(-1)
    assert desk.selected == last
    desk.move(1)
    assert desk.selected == last


def test_a_second_click_on_a_row_puts_the_selection_away():
    desk = choosing(None, None)
    pick_row(desk, "3:123")
    assert (desk.selected, desk.selected_patch) == (3, None)
    pick_row(desk, "surface 7:124")
    assert (desk.selected, desk.selected_patch) == (None, 7)
    pick_row(desk, "surface 7:125")
    assert (desk.selected, desk.selected_patch) == (None, None)


@pytest.mark.parametrize("message", ["99:1", "surface 1:2", "flight x:3"])
def test_a_row_that_does_not_exist_is_a_sentence(message):
    with pytest.raises(ConfigError):
        pick_row(choosing(None, None), message)
