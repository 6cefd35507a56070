"""What a page sends for one of several options is read in one way, whatever it is."""

import pytest

from stair_inspector.errors import ConfigError, one_of
from stair_inspector.pictures.coloring import COLOR_MODES
from stair_inspector.pictures.picture import BACKGROUNDS
from stair_inspector.viewer.scene.sections import DIRECTIONS


@pytest.mark.parametrize("options", [BACKGROUNDS, COLOR_MODES, DIRECTIONS])
def test_an_option_is_read_as_itself(options):
    assert [one_of(option, options, "menu") for option in options] == list(options)


@pytest.mark.parametrize("value", ["", "white", None, 3, "Colour", "x" * 1000])
def test_what_is_none_of_the_options_is_refused_with_all_of_them(value):
    with pytest.raises(ConfigError, match=r"^background: got '.{0,40}'; give one of White, Transparent$"):
        one_of(value, BACKGROUNDS, "background")
