"""What was found about a scan, on the page: gravest first, a button where a setting is the cure, else nothing."""

import contextlib
import dataclasses
from types import SimpleNamespace

import pytest

from stair_inspector.errors import ConfigError
from stair_inspector.model import Observation
from stair_inspector.params import Params
from stair_inspector.viewer.bridge.markup import list_key, pick_script
from stair_inspector.viewer.parts.cures import Cures
from stair_inspector.viewer.parts.desk import Desk
from stair_inspector.viewer.parts.examination_html import CURE, examination_html, headline_html, offered_cures
from stair_inspector.viewer.parts.step_columns import USUAL_LOOK
from stair_inspector.viewer.parts.step_table_html import bar_html, table_html
from tests.viewer.parts.test_html import HOSTILE, Page
from tests.viewer.surveyed import PALETTE, surveyed

ASKED = Observation("up_unsure", "question", "two ways to read it", None, "--up=z or --up=-y")
DOUBT = Observation("rounded", "doubt", "a step of 1 mm", 0.001, "export with more decimals")
SPARSE = Observation("sparse", "doubt", "60 points a tread", None, "--levels.min-points 20")
INFO = Observation("lattice", "info", "a lattice of 5 mm")


def of(*found):
    return dataclasses.replace(surveyed()[1], examination=found)


def rows(source):
    return [(row["data-level"], row["data-code"]) for row in Page(source).of("div") if "data-level" in row]


@pytest.mark.parametrize("show", [headline_html, examination_html])
def test_nothing_is_shown_of_a_sound_scan_or_of_none(show):
    assert show(None, "id") == ""
    assert show(of(), "id") == ""


def test_what_was_found_is_told_by_sign_and_word_the_question_first():
    source = headline_html(of(DOUBT, ASKED), "id")
    assert rows(source) == [("question", "up_unsure"), ("doubt", "rounded")]
    words = Page(source).words
    assert words.index("? question") < words.index("two ways") < words.index("▲ doubt") < words.index("a step of 1 mm")
    assert "No value is given and nothing is judged before this is answered" in words


def test_the_headline_has_the_gravest_on_lines_that_open_and_the_tab_the_others():
    inspection = of(INFO, DOUBT, SPARSE, dataclasses.replace(INFO, code="second"))
    assert rows(examination_html(inspection, "id")) == [("info", "second")]
    assert "Export with more decimals" in Page(headline_html(inspection, "id")).words
    assert len(Page(headline_html(inspection, "id")).of("details")) == 3
    assert examination_html(of(INFO, DOUBT), "id") == ""
    assert rows(headline_html(inspection, "id")) == [("doubt", "rounded"), ("doubt", "sparse"), ("info", "lattice")]
    assert "and 1 more on the Scan tab" in Page(headline_html(inspection, "id")).words


def test_a_cure_that_is_a_setting_is_a_button_that_names_it():
    inspection = of(SPARSE, ASKED)
    offered = offered_cures(inspection)
    assert [cure.words for cure in offered] == ["up is z", "up is -y", "set m (points in reach) to 20"]
    source = headline_html(inspection, "the-control")
    buttons = [each for each in Page(source).of("button") if each["data-testid"] == "cure"]
    key = list_key(offered)
    assert [each["onclick"] for each in buttons] == [
        pick_script("the-control", number, f"{CURE} {key}") for number in (1, 2, 3)
    ]
    words = Page(source).words
    assert words.index("Up is z") < words.index("Up is -y") < words.index("Set m (points in reach) to 20")
    assert "--" not in words


def test_a_press_takes_the_settings_and_a_late_one_is_refused():
    taken = []
    desk = Desk(SimpleNamespace(atomic=contextlib.nullcontext), None, (PALETTE, PALETTE), None)
    desk.shown = SimpleNamespace(inspection=of(ASKED))
    editor = SimpleNamespace(adjust=lambda change, words: taken.append((change(Params()).up, words)))
    widgets = SimpleNamespace(orders=lambda label, on_order: "id")
    cures = Cures(SimpleNamespace(desk=desk, editor=editor, widgets=widgets))
    key = list_key(offered_cures(of(ASKED)))
    cures.take(f"{CURE} {key} 2:1700")
    assert taken == [("-y", "up is -y")]
    desk.shown = SimpleNamespace(inspection=of(SPARSE))
    for late in (f"{CURE} {key} 2:1700", f"{CURE} {key} 9:1", f"{CURE} x:1"):
        with pytest.raises(ConfigError):
            cures.take(late)
    assert len(taken) == 1


@pytest.mark.parametrize("show", [headline_html, examination_html])
@pytest.mark.parametrize("level", ["question", "doubt", "info"])
def test_texts_of_a_scan_are_never_markup(show, level):
    hostile = Observation(HOSTILE, level, HOSTILE, None, HOSTILE)
    source = show(of(*(4 * [hostile])), "id")
    assert ("observation" in source, Page(source).of("img")) == (show is headline_html or level != "question", [])


def test_a_withheld_table_and_its_note_say_what_is_missing_without_flags():
    held = of(ASKED)
    assert held.is_withheld
    bar = bar_html(held, "survey", USUAL_LOOK, "pick")
    assert "No value is given before the question about the scan is answered." in Page(bar).words
    titles = {
        cell.get("title")
        for cell in Page(
            table_html(
                dataclasses.replace(held, steps=tuple(dataclasses.replace(step, rise_m=None) for step in held.steps)),
                PALETTE,
                None,
                None,
                "survey",
            )
        ).of("td")
    }
    assert "withheld until the question about the scan is answered" in titles
