"""After a change of scan the page says which settings came along, and offers the scan's own."""

import pytest

from stair_inspector.errors import ConfigError
from stair_inspector.files.chosen_rules import ChosenRules
from stair_inspector.params import Params
from stair_inspector.viewer.parts.came_along import came_along_html, came_along_words
from tests.viewer.parts.checks.test_check import choose as choose_rules
from tests.viewer.parts.test_html import HOSTILE, Page
from tests.viewer.parts_of import part_of
from tests.viewer.wire_page import OTHER, STAIR

MOVED = Params().replaced("levels.eps_m", 0.03)


def test_what_is_not_as_started_is_named_and_many_are_counted():
    assert came_along_words(Params(), Params(), ChosenRules()) == ()
    assert came_along_words(MOVED, MOVED, ChosenRules()) == ()
    words = came_along_words(Params(), MOVED, ChosenRules("us-irc-2024"))
    assert words[0] == "ε_z 30 mm"
    assert words[1].startswith("rule set International Residential Code")
    many = MOVED
    for name, value in (("levels.min_points", 40), ("normals.k", 20), ("edges.front_percentile", 90.0)):
        many = many.replaced(name, value)
    many = many.replaced("edges.side_percentile", 98.0).replaced("horizontal.theta_deg", 12.0)
    assert came_along_words(Params(), many, ChosenRules())[-1] == "2 more settings"


def test_a_scans_name_is_no_markup():
    assert came_along_html(HOSTILE, (), "id") == ""
    made = Page(came_along_html(HOSTILE, (HOSTILE,), "id"))
    assert (len(made.of("button")), made.of("img")) == (3, [])


def test_the_line_goes_when_other_settings_are_taken_or_the_present_ones_are_kept(page, session):
    line = part_of(session, "frame")._came_along
    choose = part_of(session, "scan").choose
    session.editor.adjust(lambda params: params.replaced("levels.eps_m", 0.03))
    choose(OTHER)
    assert f"Came along from {STAIR}" in line._html.content
    assert "ε_z 30 mm" in line._html.content
    page.await_result(OTHER)
    line.take("keep:1")
    assert line._html.content == ""
    session.opening.came_along = None
    choose(STAIR)
    page.await_result(STAIR)
    assert line._html.content == ""


def test_rules_that_are_chosen_afterwards_did_not_come_along(page, session):
    line = part_of(session, "frame")._came_along
    part_of(session, "scan").choose(OTHER)
    page.await_result(OTHER)
    choose_rules(session, "us-irc-2024")
    assert session.editor.work.rules.set_id == "us-irc-2024"
    assert line._html.content == ""


def test_the_scans_own_settings_are_one_press_away(page, session):
    line = part_of(session, "frame")._came_along
    session.editor.adjust(lambda params: params.replaced("levels.eps_m", 0.05).replaced("normals.k", 12))
    part_of(session, "scan").choose(OTHER)
    page.await_result(OTHER)
    line.take("suggested:1")
    suggested = session.editor.work.params
    assert suggested.levels.eps_m < 0.05
    assert suggested.normals.k == 12
    assert line._html.content == ""
    session.editor.undo()
    assert session.editor.work.params.levels.eps_m == 0.05
    line.take("started:2")
    assert session.editor.work.params == session.editor.started
    with pytest.raises(ConfigError, match="press one of the buttons"):
        line.take("else:3")
