"""The controls show the settings, give them back, and let nothing else through, whatever a page sends."""

import math
from types import SimpleNamespace

import pytest
import viser

from stair_inspector.errors import ConfigError
from stair_inspector.params import Params, knob_of
from stair_inspector.viewer.panel import SLIDERS, Actions, Panel, label_of
from tests.synthetic import CHANGES


@pytest.fixture(scope="module")
def server():
    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    yield server
    server.stop()


@pytest.fixture
def panel(server):
    names = ("settings", "reset", "scan", "mode", "view", "theme", "point_size", "select", "pick", "download")
    called = []
    actions = Actions(**{f"on_{name}": lambda *values, name=name: called.append((name, *values)) for name in names})
    panel = Panel(server, ("a.ply", "b.ply"), Params(), actions)
    panel.called = called
    yield panel
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


def test_settings_without_a_control_are_kept(panel):
    wanted = Params().replaced("floor.distance_m", 0.03).replaced("display.nearest_k", 7)
    panel.load(wanted)
    assert panel.read() == wanted


def test_an_up_vector_of_ones_own_goes_there_and_back(panel):
    panel.load(Params(up="0.1,0.0,1.0"))
    assert panel._controls["up"].value == "vector"
    assert panel.read().up == "0.1,0.0,1.0"
    panel.load(Params(up="-y"))
    assert panel.read().up == "-y"


def test_what_the_server_sets_starts_no_run(panel):
    panel.load(Params().replaced("levels.eps_m", 0.05).replaced("method", "paper"))
    panel.show_scan_name("b.ply")
    panel.show_point_size(0.012)
    panel.offer_steps(4, 2)
    assert panel.called == []
    assert panel._point_size.value == 12.0
    assert (panel.selected.options, panel.selected.value) == (("none", "1", "2", "3", "4"), "2")


@pytest.mark.parametrize("size_m", [0.0, 1.0])
def test_a_point_size_beyond_the_slider_is_shown_at_its_end(panel, size_m):
    panel.show_point_size(size_m)
    assert panel._point_size.value in (panel._point_size.min, panel._point_size.max)


@pytest.mark.parametrize("name", SLIDERS)
@pytest.mark.parametrize("value", [-1e9, 1e9, math.nan, math.inf, -math.inf, "12", True, None, [1], 10**400])
def test_a_slider_lets_nothing_through_but_numbers_in_its_range(panel, name, value):
    hold(panel, name, value)
    with pytest.raises(ConfigError) as error:
        panel.read()
    assert str(error.value).startswith(label_of(knob_of(name)))
    assert len(str(error.value)) < 200


@pytest.mark.parametrize("name", SLIDERS)
def test_the_ends_of_a_slider_are_allowed_and_a_step_beyond_is_not(panel, name):
    knob = knob_of(name)
    for end, step in ((knob.shown(knob.low), -knob.shown(knob.step)), (knob.shown(knob.high), knob.shown(knob.step))):
        whole = name in ("levels.min_points", "normals.k")
        hold(panel, name, int(end) if whole else end)
        panel.read()
        hold(panel, name, int(end + step) if whole else end + step)
        with pytest.raises(ConfigError, match="give a value from"):
            panel.read()


@pytest.mark.parametrize("name", ["levels.min_points", "normals.k"])
def test_a_count_is_a_whole_number(panel, name):
    hold(panel, name, 30.5)
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
