"""The colour sets that are shipped, and what is said about broken ones."""

import itertools

import numpy as np
import pytest

from stair_inspector.errors import ConfigError
from stair_inspector.files import palettes
from stair_inspector.files.palettes import read_palette
from stair_inspector.files.paths import static_configs
from tests.color_differences import SIGHTS, difference, seen

NAMES = sorted(path.stem for path in (static_configs() / "palettes").glob("*.toml"))
GOOD = """
title = "t"
floor = [1, 1, 1]
non_stair = [2, 2, 2]
steps = [[3, 3, 3]]
front_edge = [4, 4, 4]
back_edge = [5, 5, 5]
side_edge = [6, 6, 6]
centre = [7, 7, 7]
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    (tmp_path / "palettes").mkdir()
    monkeypatch.setattr(palettes, "static_configs", lambda: tmp_path)
    return tmp_path / "palettes"


@pytest.mark.parametrize("name", NAMES)
def test_every_shipped_palette_loads_and_tells_its_parts_apart(name):
    palette = read_palette(name)
    assert palette.title
    kinds = [palette.floor, palette.non_stair, *palette.steps]
    assert len(set(kinds)) == len(kinds)


def test_the_papers_colours():
    paper = read_palette("paper")
    assert paper.floor == paper.side_edge == (128, 128, 128)
    assert paper.non_stair == paper.back_edge == paper.centre == (0, 0, 0)
    assert paper.front_edge == (255, 105, 180)
    red, orange, yellow, green, blue, indigo, violet = paper.steps
    assert (red, blue, yellow) == ((255, 0, 0), (0, 0, 255), (255, 255, 0))
    assert orange[0] == 255
    assert 0 < orange[1] < 255
    assert max(green) == green[1]
    # Indigo and violet as the web has them.
    assert (indigo, violet) == ((75, 0, 130), (148, 0, 211))


def test_steps_cycle_through_the_colours():
    palette = read_palette("paper")
    assert palette.of_step(1) == palette.of_step(8) == palette.steps[0]
    assert palette.of_step(7) == palette.steps[6]


def test_colours_of_labels():
    palette = read_palette("paper")
    labels = np.array([-1, 0, 1, 2, 9], dtype=np.int16)
    expected = [palette.non_stair, palette.floor, palette.steps[0], palette.steps[1], palette.steps[1]]
    colors = palette.of_labels(labels)
    np.testing.assert_array_equal(colors, expected)
    assert colors.dtype == np.uint8


def test_colours_of_no_labels():
    assert read_palette("paper").of_labels(np.zeros(0, dtype=np.int16)).shape == (0, 3)
    np.testing.assert_array_equal(read_palette("paper").of_labels(np.array([-1], dtype=np.int16)), [[0, 0, 0]])


@pytest.mark.parametrize(
    ("old", "new", "text"),
    [
        ("centre = [7, 7, 7]", "", "centre is missing; add it"),
        ("centre = ", "center = ", "unknown key 'center'; did you mean 'centre'?"),
        ("[1, 1, 1]", "[1, 1]", "floor: got [1, 1]; give three whole numbers from 0 to 255"),
        ("[1, 1, 1]", "[1, 1, 256]", "floor: got [1, 1, 256]; give three whole numbers from 0 to 255"),
        ("[1, 1, 1]", "[1, 1, 1.0]", "floor: got [1, 1, 1.0]; give three whole numbers from 0 to 255"),
        ("[1, 1, 1]", "'red'", "floor: got 'red'; give three whole numbers from 0 to 255"),
        ("[[3, 3, 3]]", "[]", "steps: give a list of at least one colour"),
        ("[[3, 3, 3]]", "[[3, 3, -1]]", "steps: got [3, 3, -1]; give three whole numbers from 0 to 255"),
    ],
)
def test_the_sentence_for_a_broken_palette(folder, old, new, text):
    path = folder / "mine.toml"
    assert old in GOOD
    path.write_text(GOOD.replace(old, new))
    with pytest.raises(ConfigError) as error:
        read_palette("mine")
    assert str(error.value) == f"{path}: {text}"


def test_a_missing_palette_is_named(folder):
    with pytest.raises(ConfigError) as error:
        read_palette("none")
    assert str(error.value) == f"{folder / 'none.toml'}: cannot be read (No such file or directory); check the name"


@pytest.mark.parametrize(
    ("one", "other", "expected"),
    [
        # From the published test data of the formula.
        ((50.0, 2.6772, -79.7751), (50.0, 0.0, -82.7485), 2.0425),
        ((50.0, 2.49, -0.001), (50.0, -2.49, 0.0011), 7.2195),
        ((60.2574, -34.0099, 36.2677), (60.4626, -34.1751, 39.4387), 1.2644),
        ((2.0776, 0.0795, -1.135), (0.9033, -0.0636, -0.5514), 0.9082),
    ],
)
def test_the_measure_of_differences_is_the_published_one(one, other, expected):
    assert difference(one, other) == pytest.approx(expected, abs=5e-5)


@pytest.mark.parametrize(("name", "ground"), [("distinct", (255, 255, 255)), ("distinct_dark", (20, 20, 20))])
@pytest.mark.parametrize("sight", SIGHTS)
def test_all_that_has_a_meaning_differs_for_every_sight_in_the_distinct_colours(name, ground, sight):
    of = read_palette(name)
    # A step's centre is a dot in the colour of the lines of back edges.
    assert of.centre == of.back_edge
    lines = (of.front_edge, of.back_edge, of.side_edge, of.measure, of.paper_edge, of.outside, of.nearly)
    colors = (ground, of.floor, of.non_stair, of.rejected, *of.steps, *lines)
    pairs = itertools.combinations(zip(seen(colors, sight), colors, strict=True), 2)
    close = {(a, b): difference(one, other) for (one, a), (other, b) in pairs if difference(one, other) < 15.0}
    assert close == {}
