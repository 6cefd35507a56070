"""What is measured by hand: exact lengths in the scan's own frame, drawn where it was picked, kept until deleted."""

import itertools
import re

import numpy as np
import pytest

from stair_inspector.errors import ConfigError
from stair_inspector.files.projects import Measurement
from stair_inspector.units import length_text
from stair_inspector.viewer.bridge.markup import read_order
from stair_inspector.viewer.scene.measurements import (
    ORDERS,
    RULER_MODES,
    Ruler,
    drawing_of,
    measurements_html,
    parts_of,
    renamed,
    without,
    words_of,
)
from tests.synthetic import rotation
from tests.viewer.parts.test_html import HOSTILE, Page

UP = np.array([0.0, 0.0, 1.0])
FAR = np.array([455123.25, 5412345.5, 310.125])
"""A map grid: five metres there cost no digit of a tenth of a millimetre."""
TURN = rotation("x", 75.0) @ rotation("y", -40.0)


def distance(first, second, name="Distance 1"):
    return Measurement(name, (tuple(map(float, first)), tuple(map(float, second))))


@pytest.mark.parametrize("turn", [np.eye(3), TURN])
@pytest.mark.parametrize("move", [(0.3, 0.4, 1.2), (0.0, 0.0, -0.17), (0.28, 0.0, 0.0), (0.0, 0.0, 0.0)])
def test_the_parts_of_a_distance_are_those_of_the_move(turn, move):
    up = turn[:, 2]
    parts = parts_of(distance(FAR, FAR + turn @ np.array(move)), up)
    assert parts.distance_m == pytest.approx(np.linalg.norm(move), abs=1e-8)
    assert parts.horizontal_m == pytest.approx(np.hypot(*move[:2]), abs=1e-8)
    assert parts.vertical_m == pytest.approx(move[2], abs=1e-8)
    assert parts.horizontal_m**2 + parts.vertical_m**2 == pytest.approx(parts.distance_m**2, abs=1e-8)


def test_a_point_has_no_parts_and_says_its_coordinates():
    point = Measurement("Point 1", (tuple(FAR),))
    assert parts_of(point, UP) is None
    assert words_of(point, UP, "mm") == "455123.250, 5412345.500, 310.125 m"
    assert words_of(Measurement("p", ((-0.0001, 0.0, -1.0),)), UP, "in") == "0.000, 0.000, -1.000 m"


def test_a_distance_says_its_length_and_both_parts_in_the_unit():
    entry = distance((0, 0, 0), (0.3, 0.4, -1.2))
    assert words_of(entry, UP, "mm") == "1300.0 mm (horizontal 500.0 mm, vertical -1200.0 mm)"
    assert words_of(entry, UP, "in") == "51 3/16 in (horizontal 19 11/16 in, vertical -47 1/4 in)"


def test_two_clicks_are_a_distance_and_one_is_a_point():
    ruler = Ruler()
    assert ruler.click((0.0, 0.0, 0.0), ()) is None
    ruler.set_mode("Point")
    point = ruler.click((1.0, 2.0, 3.0), ())
    assert point == Measurement("Point 1", ((1.0, 2.0, 3.0),))
    ruler.set_mode("Distance")
    assert ruler.click((1.0, 2.0, 3.0), (point,)) is None
    assert ruler.waiting == (1.0, 2.0, 3.0)
    # The same pixel twice is no distance.
    assert ruler.click((1.0, 2.0, 3.0), (point,)) is None
    assert ruler.click((1.0, 2.0, 3.5), (point,)) == distance((1, 2, 3), (1, 2, 3.5))
    assert ruler.waiting is None


def test_a_step_back_forgets_the_first_point_and_so_does_another_mode():
    ruler = Ruler("Distance")
    ruler.click((0.0, 0.0, 0.0), ())
    assert ruler.step_back()
    assert not ruler.step_back()
    ruler.click((0.0, 0.0, 0.0), ())
    ruler.set_mode("Distance")
    assert ruler.waiting is None


def test_no_two_have_the_same_name_also_after_a_deletion():
    ruler, known = Ruler("Point"), ()
    for _ in range(3):
        known += (ruler.click((0.0, 0.0, 0.0), known),)
    known = without(known, 0)
    known += (ruler.click((0.0, 0.0, 0.0), known),)
    assert sorted(entry.name for entry in known) == ["Point 1", "Point 2", "Point 3"]


def test_one_is_renamed_or_deleted_and_the_others_stay():
    entries = tuple(Measurement(f"Point {k}", ((float(k), 0.0, 0.0),)) for k in (1, 2, 3))
    assert [entry.name for entry in renamed(entries, 1, "sill")] == ["Point 1", "sill", "Point 3"]
    assert renamed(entries, 1, "sill")[1].points_m == entries[1].points_m
    assert without(entries, 1) == (entries[0], entries[2])
    assert renamed(entries, 1, "Point 2") == entries
    with pytest.raises(ConfigError, match="the name 'Point 3' is taken"):
        renamed(entries, 1, "Point 3")
    for index in (-1, 3):
        with pytest.raises(ConfigError, match="choose a row of the list"):
            without(entries, index)
        with pytest.raises(ConfigError, match="choose a row of the list"):
            renamed(entries, index, "x")
    with pytest.raises(ConfigError):
        renamed(entries, 1, "")


def test_the_buttons_of_a_row_send_orders_that_are_understood():
    entries = (Measurement("a", ((0.0, 0.0, 0.0),)), distance((0, 0, 0), (0, 0, 1), "b"))
    page = Page(measurements_html(entries, UP, "mm", "the-uuid"))
    buttons = page.of("button")
    for button, (index, word) in zip(buttons, itertools.product((0, 1), ("show", "delete")), strict=True):
        sent = re.search(r"value:'([^']*)'", button["onclick"]).group(1)
        order = read_order(sent + "1763800000000", ORDERS)
        assert (order.word, order.index_in(entries, "list")) == (word, index)
        assert button["data-order"] == word
    assert set(ORDERS) == {"show", "delete"}


def test_the_list_has_a_row_for_each_with_its_values():
    entries = (Measurement("a", ((1.0, 2.0, 3.0),)), distance((0, 0, 0), (0.3, 0.4, 1.2), "b"))
    rows = Page(measurements_html(entries, UP, "mm", "orders")).rows[1:]
    assert rows == [["a", "1.000, 2.000, 3.000 m", "◎✕"], ["b", "1300.0 mm", "500.0 mm", "1200.0 mm", "◎✕"]]
    rows = Page(measurements_html(entries, None, "mm", "orders")).rows[1:]
    assert rows[1] == ["b", "–", "–", "–", "◎✕"]
    assert "Nothing measured yet" in measurements_html((), UP, "mm", "orders")


def test_a_name_from_a_file_stays_a_name():
    entries = (Measurement(HOSTILE, ((0.0, 0.0, 0.0),)),)
    page = Page(measurements_html(entries, UP, "mm", "id"))
    assert page.of("img") == page.of("script") == []
    assert page.rows[1][0] == HOSTILE
    assert page.of("button")[0]["title"] == f"look at {HOSTILE}"


@pytest.mark.parametrize("turn", [np.eye(3), TURN])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_distance_is_drawn_between_its_points_with_its_legs_at_a_right_angle(turn, sign):
    up, move = turn[:, 2], sign * turn @ np.array([0.3, 0.4, 1.2])
    first = np.array([0.5, -0.25, 1.0])
    drawing = drawing_of((distance(FAR + first, FAR + first + move),), None, tuple(FAR), up, "mm")
    (line,) = drawing.lines
    ends = {tuple(np.round(end, 6)) for end in line}
    assert ends == {tuple(np.round(end, 6)) for end in (first, first + move)}
    upright, level = drawing.legs
    np.testing.assert_allclose(upright[1] - upright[0], 1.2 * up, atol=1e-7)
    assert float((level[1] - level[0]) @ up) == pytest.approx(0.0, abs=1e-7)
    assert np.linalg.norm(level[1] - level[0]) == pytest.approx(0.5, abs=1e-7)
    np.testing.assert_allclose(upright[1], level[0])
    np.testing.assert_allclose(np.sort([line[0], line[1]], axis=0), np.sort([upright[0], level[1]], axis=0), atol=1e-7)
    signed = length_text(sign * 1.2, "mm")
    assert [words for _, words, *_ in drawing.labels] == [f"↕ {signed}", "↔ 500.0 mm", "Distance 1: 1300.0 mm"]
    np.testing.assert_allclose(drawing.labels[2][2], line.mean(axis=0))


def test_a_distance_along_one_direction_has_no_legs_that_would_cover_it():
    for move in ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0)):
        drawing = drawing_of((distance((0, 0, 0), move),), None, (0.0, 0.0, 0.0), UP, "in")
        assert drawing.legs.shape == (0, 2, 3)
        assert [words for _, words, *_ in drawing.labels] == ["Distance 1: 39 3/8 in"]


def test_points_and_the_one_that_waits_are_marked_where_they_were_picked():
    sill, first = FAR + np.array([1.0, 2.0, 3.0]), FAR + np.array([0.5, 0.0, 0.0])
    entries = (Measurement("sill", (tuple(sill),)), distance(FAR, FAR + UP))
    drawing = drawing_of(entries, tuple(first), tuple(FAR), UP, "mm")
    np.testing.assert_allclose(drawing.points, [[1, 2, 3], [0, 0, 0], [0, 0, 1], [0.5, 0, 0]], atol=1e-8)
    names = [name for name, *_ in drawing.labels]
    assert len(set(names)) == len(names)
    # Only one measurement has all its values in the scene; the list has those of all.
    assert drawing.labels[0][1] == "sill"
    detailed = drawing_of(entries, tuple(first), tuple(FAR), UP, "mm", detailed=0)
    assert detailed.labels[0][1] == "sill: 455124.250, 5412347.500, 313.125 m"
    assert drawing.labels[-1][1] == "first point"
    empty = drawing_of((), None, (0.0, 0.0, 0.0), UP, "mm")
    assert (empty.lines.shape, empty.legs.shape, empty.points.shape, empty.labels) == ((0, 2, 3), (0, 2, 3), (0, 3), ())


@pytest.mark.parametrize("value", ["", "distance", None, 2])
def test_an_unknown_ruler_is_refused(value):
    with pytest.raises(ConfigError, match="measure: got"):
        Ruler().set_mode(value)
    assert RULER_MODES[0] == "Off"
