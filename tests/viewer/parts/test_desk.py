"""The colours that the desk draws in."""

import pytest

from stair_inspector.errors import ConfigError
from stair_inspector.files.palettes import read_palette
from stair_inspector.viewer.app import PALETTES
from stair_inspector.viewer.parts.desk import Desk
from stair_inspector.viewer.state.change import PageChange


def test_colours_are_chosen_by_name_and_follow_the_theme():
    told = []
    palettes = {name: (read_palette(light), read_palette(dark)) for name, (light, dark) in PALETTES.items()}
    desk = Desk(None, notices=None, palettes=palettes, stage=None, changed=lambda *what: told.append(set(what)))
    assert desk.palette == read_palette("page")
    desk.set_palette("distinct")
    assert desk.palette == read_palette("distinct")
    desk.set_theme(True)
    assert desk.palette == read_palette("distinct_dark")
    assert desk.paper_palette == read_palette("distinct")
    desk.set_palette("the paper's")
    assert desk.palette.steps == read_palette("paper").steps
    assert told[0] == told[2] == {PageChange.COLORS, PageChange.THEME}
    with pytest.raises(ConfigError, match="colours of steps: got 'pink'; "):
        desk.set_palette("pink")
