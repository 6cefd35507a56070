"""The controls show the settings, give them back, and let nothing else through, whatever a page sends."""

import math
import re
from types import SimpleNamespace
from typing import get_args

import pytest
import viser

from stair_inspector.declarations import Place
from stair_inspector.errors import ConfigError
from stair_inspector.overrules import parse_force, with_decision
from stair_inspector.params import SETTINGS, Params
from stair_inspector.viewer.bridge.controls import (
    SettingControls,
    words_of_change,
)
from tests.synthetic import CHANGES

PLACES = tuple(place for place in get_args(Place) if place != "scene")
NUMBERS = tuple(name for name, declared in SETTINGS.items() if declared.knob is not None)
WHOLE = tuple(name for name in NUMBERS if SETTINGS[name].kind is int)
TEXTS = SETTINGS.at("overrules")


@pytest.fixture(scope="module")
def server():
    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    yield server
    server.stop()


@pytest.fixture
def panel(server):
    called = []
    controls = SettingControls(server.gui, Params(), lambda: called.append("settings"))
    for place in PLACES:
        controls.add_place(place)
    controls.called = called
    yield controls
    server.gui.reset()


def hold(panel, name, value):
    """Let a control hold a value as if a page had sent it; viser does not check."""
    panel._controls[name] = SimpleNamespace(value=value)


def test_untouched_controls_give_the_settings_they_were_made_with(panel):
    assert panel.read() == Params()


def test_every_setting_that_has_a_control_goes_there_and_back(panel):
    wanted = Params()
    for name, value in CHANGES.items():
        if name in panel._controls:
            wanted = wanted.replaced(name, value)
    assert wanted != Params()
    panel.load(wanted)
    assert panel.read() == wanted
    panel.load(Params())
    assert panel.read() == Params()


def test_all_settings_at_once_go_there_and_back_whether_they_have_a_control_or_not(panel):
    wanted = Params()
    for name, value in CHANGES.items():
        wanted = wanted.replaced(name, value)
    panel.load(wanted)
    assert panel.read() == wanted


@pytest.mark.parametrize("name", [name for name in SETTINGS if SETTINGS.setting(name).place != "scene"])
def test_there_is_a_control_for(panel, name):
    wanted = Params().replaced(name, CHANGES[name])
    panel.load(wanted)
    held = panel._controls[name].value
    assert panel.read() == wanted
    panel.load(Params())
    assert panel._controls[name].value != held
    assert panel.read() == Params()


def test_numbers_that_are_dragged_have_sliders_and_others_are_written(panel):
    kinds = {name: type(panel._controls[name]).__name__ for name in NUMBERS}
    dragged = {name for name in NUMBERS if SETTINGS.setting(name).place in ("tune", "survey")}
    assert {name for name, kind in kinds.items() if kind == "GuiSliderHandle"} == dragged
    assert {name for name, kind in kinds.items() if kind == "GuiNumberHandle"} == set(NUMBERS) - dragged
    assert len(set(NUMBERS) - dragged) == 10


def test_what_a_control_says_is_in_its_own_unit(panel):
    hint = panel._controls["levels.eps_m"].hint
    assert hint.startswith("eps_z: vertical reach of DBSCAN, mm (1 to 100).")
    assert hint.endswith("(levels.eps_m)")
    assert panel._controls["flights.min_rise_m"].hint.startswith("Smallest rise between two steps, mm (30 to 200).")


def test_settings_of_a_folder_stand_under_what_their_stage_is_about(server):
    said = []
    gui = SimpleNamespace(
        add_html=lambda content: said.append(re.sub("<.*?>", "", content)),
        add_number=lambda label, *_, **__: said.append(label) or SimpleNamespace(on_update=lambda _: None),
    )
    SettingControls(gui, Params(), list).add_by_stage("more")
    flights = said.index("How surfaces chain into flights (survey).")
    assert said[flights + 1 : flights + 4] == ["smallest rise [mm]", "largest rise [mm]", "fewest risers"]
    assert "\n".join(said).count(".") == 5


def test_two_controls_never_have_the_same_label(panel, server):
    labels = [control.label for control in panel._controls.values()]
    assert len(set(labels)) == len(labels)


def test_settings_without_a_control_are_kept(server):
    bare = SettingControls(server.gui, Params(), list)
    bare.add_place("tune")
    wanted = Params().replaced("floor.distance_m", 0.03).replaced("display.nearest_k", 7)
    bare.load(wanted)
    assert bare.read() == wanted
    server.gui.reset()


def test_an_up_vector_of_ones_own_goes_there_and_back(panel):
    panel.load(Params(up="0.1,0.0,1.0"))
    assert panel._controls["up"].value == "vector"
    assert panel.read().up == "0.1,0.0,1.0"
    panel.load(Params(up="-y"))
    assert panel.read().up == "-y"


def test_what_the_server_sets_starts_no_run(panel):
    panel.load(Params().replaced("levels.eps_m", 0.05).replaced("method", "paper"))
    panel.overrule((1.0, 2.0, 3.0), "tread")
    assert panel.called == []


@pytest.mark.parametrize(
    ("changes", "words", "key"),
    [
        ({}, "0 settings", ""),
        ({"levels.eps_m": 0.03}, "ε_z 20 mm to 30 mm", "levels.eps_m"),
        ({"method": "paper"}, "Method survey to paper", "method"),
        ({"up": "x"}, "Up auto to x", "up"),
        ({"overrules.force": "level:3=rejected"}, "Surfaces none to level:3=rejected", "overrules.force"),
        ({"levels.eps_m": 0.03, "up": "x"}, "2 settings", "up, levels.eps_m"),
    ],
)
def test_a_change_is_told_in_the_pages_words(changes, words, key):
    after = Params()
    for name, value in changes.items():
        after = after.replaced(name, value)
    assert words_of_change(Params(), after) == (words, key)


def test_every_setting_has_a_name_that_can_be_replaced():
    for name in SETTINGS:
        assert words_of_change(Params(), Params().replaced(name, CHANGES[name]))[1] == name


@pytest.mark.parametrize("name", NUMBERS)
@pytest.mark.parametrize("value", [-1e9, 1e9, math.nan, math.inf, -math.inf, "12", True, None, [1], 10**400])
def test_a_slider_lets_nothing_through_but_numbers_in_its_range(panel, name, value):
    hold(panel, name, value)
    with pytest.raises(ConfigError) as error:
        panel.read()
    assert str(error.value).startswith(SETTINGS.knob(name).label)
    assert len(str(error.value)) < 200


@pytest.mark.parametrize("name", NUMBERS)
def test_the_ends_of_a_slider_are_allowed_and_a_step_beyond_is_not(panel, name):
    knob = SETTINGS.knob(name)
    for end, step in ((knob.shown(knob.low), -knob.shown(knob.step)), (knob.shown(knob.high), knob.shown(knob.step))):
        whole = name in WHOLE
        hold(panel, name, int(end) if whole else end)
        panel.read()
        hold(panel, name, int(end + step) if whole else end + step)
        with pytest.raises(ConfigError, match="give a value from"):
            panel.read()


@pytest.mark.parametrize("name", WHOLE)
def test_a_count_is_a_whole_number(panel, name):
    hold(panel, name, SETTINGS.knob(name).low + 0.5)
    with pytest.raises(ConfigError, match="whole number"):
        panel.read()


@pytest.mark.parametrize("name", ["method", "axes.rule", "normals.source", "unit", "up"])
@pytest.mark.parametrize("value", ["<script>", "", 3, None, ["auto"], "AUTO"])
def test_a_menu_lets_nothing_through_but_its_options(panel, name, value):
    hold(panel, name, value)
    with pytest.raises(ConfigError, match=f"^{name.replace('.', '[.]')}: got"):
        panel.read()


@pytest.mark.parametrize("vector", [(0.0, 0.0, 0.0), (math.nan, 0.0, 1.0), (math.inf, 0.0, 1.0), (1.0, 2.0)])
def test_an_up_vector_that_is_none_is_a_sentence(panel, vector):
    hold(panel, "up", "vector")
    panel._up_vector = SimpleNamespace(value=vector)
    with pytest.raises(ConfigError, match=r"^up: got"):
        panel.read()


def test_a_text_counts_from_when_it_is_submitted(panel):
    hold(panel, "overrules.force", "level:2=rej")
    assert panel.read() == Params()
    panel.submit_texts()
    with pytest.raises(ConfigError, match=r"^overrules\.force: got 'level:2=rej'"):
        panel.read()
    hold(panel, "overrules.force", "level:2=rejected")
    panel.submit_texts()
    assert panel.read() == Params().replaced("overrules.force", "level:2=rejected")
    assert panel.called == []


@pytest.mark.parametrize("name", TEXTS)
@pytest.mark.parametrize("value", ["<script>", "1,2", 3, None, ["x"], "x" * 100_000, "nan,nan,nan"])
def test_a_text_lets_nothing_through_but_what_the_setting_takes(panel, name, value):
    hold(panel, name, value)
    panel.submit_texts()
    with pytest.raises(ConfigError) as error:
        panel.read()
    assert str(error.value).startswith(f"{name}: ")
    assert len(str(error.value)) < 300


def test_a_decision_about_a_place_is_added_to_what_is_submitted_and_shown(panel):
    panel.load(Params().replaced("overrules.force", "level:3=rejected"))
    # What is only half written is not submitted by the way.
    panel._controls["overrules.force"].value = "level:3=rej"
    panel.overrule((1.23456, -0.00001, 300.0), "landing")
    force = "level:3=rejected; at:1.235,0.000,300.000=landing"
    assert panel._controls["overrules.force"].value == force
    assert panel.read().overrules.force == force
    panel.overrule((1.23456, -0.00001, 300.0), "tread")
    assert panel.read().overrules.force == force.replace("landing", "tread")


@pytest.mark.parametrize("kind", ["tread", "landing", "rejected"])
@pytest.mark.parametrize("place", [(0.0, 0.0, 0.0), (-1.5, 2.25, 1e-9), (4.5e5, -5.4e6, 123.4567)])
def test_a_decision_is_read_back_as_it_was_made(kind, place):
    (force,) = parse_force(with_decision("", place, kind))
    assert (force.target, force.kind) == ("at", kind)
    assert force.point_m == pytest.approx(place, abs=0.0005001)


def test_clearing_empties_every_overrule_and_nothing_else(panel):
    wanted = Params().replaced("levels.eps_m", 0.05)
    full = wanted
    for name in TEXTS:
        full = full.replaced(name, CHANGES[name])
    panel.load(full)
    assert panel.read() == full
    panel.load(wanted)
    assert panel.read() == wanted
