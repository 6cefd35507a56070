"""Charts say what was measured: bars as high as values on one scale, limits where they are, words as words."""

import dataclasses
import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from stair_inspector.codes.judge import check
from stair_inspector.codes.limits import Limit
from stair_inspector.codes.rule_sets import RuleSet, edited
from stair_inspector.codes.rules import Rule
from stair_inspector.model import Measured
from stair_inspector.pictures import svg
from stair_inspector.pictures.chart_axes import STEPS_PER_ROW
from stair_inspector.pictures.nosing_charts import nosing_charts
from stair_inspector.pictures.nosing_line import nosing_line
from stair_inspector.pictures.step_charts import ROWS_PER_PICTURE, step_charts
from tests.content.staircases import staircase

SVG = "{http://www.w3.org/2000/svg}"
HOSTILE = '<script>alert("1")</script>\x07&\n]]>'


def rules(maximum="7", minimum="4", adjacent="2", clause="1.1"):
    common = {"severity": "limit", "from_scan": "yes", "grade": "P"}
    return RuleSet(
        "test-1",
        "Test",
        "2026",
        "",
        "made for a test",
        (
            Rule("r", clause, "riser", "rise", "each", Limit.of(minimum, "in"), Limit.of(maximum, "in"), **common),
            Rule("a", "1.2", "risers", "rise", "adjacent_difference", None, Limit.of(adjacent, "mm"), **common),
        ),
    )


def read(drawn):
    return ET.fromstring(drawn)


def steps_in(drawn):
    return {int(group.get("data-step")): group for group in read(drawn).iter(f"{SVG}g") if group.get("data-step")}


def words_in(element):
    return [node.text for node in element.iter(f"{SVG}text") if not node.get("aria-hidden")]


def top_of(group):
    return float(next(group.iter(f"{SVG}rect")).get("y"))


def with_rises(inspection, rises):
    steps = [
        dataclasses.replace(step, rise_m=None if rise is None else Measured(rise, 0.0004))
        for step, rise in zip(inspection.steps, rises, strict=True)
    ]
    return dataclasses.replace(inspection, steps=tuple(steps))


@pytest.mark.parametrize("quantity", ["rise", "going"])
@pytest.mark.parametrize("count", [3, 5, 23, 60, 100])
def test_every_step_has_a_bar_with_its_value_and_higher_bars_are_larger_values(quantity, count):
    inspection = staircase((count,))
    expected = {
        step.step_id: getattr(step, f"{quantity}_m").value * 1000.0
        for step in inspection.steps
        if quantity == "rise" or step.kind == "tread"
    }
    drawn = step_charts(inspection, quantity)
    assert len(drawn) == -(-count // (STEPS_PER_ROW * ROWS_PER_PICTURE))
    found = {}
    for picture in drawn:
        found |= steps_in(picture)
    assert sorted(found) == sorted(expected)
    for step_id, group in found.items():
        assert f"{expected[step_id]:.1f}" in words_in(group)
        assert str(step_id) in words_in(group)


def test_bars_are_drawn_to_scale_with_whiskers_of_the_uncertainty():
    inspection = with_rises(staircase((4,)), [0.170, 0.172, 0.176, 0.170])
    groups = steps_in(step_charts(inspection, "rise")[0])
    tops = [top_of(groups[k]) for k in (1, 2, 3, 4)]
    assert tops[0] == tops[3]
    per_mm = (tops[0] - tops[1]) / 2.0
    assert per_mm > 3.0
    # Points are written with two decimals.
    assert (tops[0] - tops[2]) / 6.0 == pytest.approx(per_mm, abs=0.01)
    upright = [line for line in groups[1].iter(f"{SVG}line") if line.get("x1") == line.get("x2")]
    lengths = [abs(float(line.get("y2")) - float(line.get("y1"))) for line in upright]
    assert lengths == [pytest.approx(2.0 * 0.4 * per_mm, abs=0.03)]


def test_what_was_not_measured_is_said_and_has_no_bar():
    inspection = with_rises(staircase((4,)), [None, 0.17, 0.171, 0.17])
    groups = steps_in(step_charts(inspection, "rise")[0])
    assert "not measured" in words_in(groups[1])
    assert list(groups[1].iter(f"{SVG}rect")) == []
    assert "0.0" not in words_in(groups[1])
    assert step_charts(with_rises(inspection, [None] * 4), "rise") == ()


def test_limits_stand_where_they_are_or_are_named():
    inspection = with_rises(staircase((4,)), [0.170, 0.175, 0.170, 0.170])
    picture = step_charts(inspection, "rise", check(inspection, rules()))[0]
    groups = steps_in(picture)
    per_mm = (top_of(groups[1]) - top_of(groups[2])) / 5.0
    dashed = [line for line in read(picture).iter(f"{SVG}line") if line.get("stroke-dasharray") == "5 2"]
    limit_y = float(dashed[0].get("y1"))
    assert len(dashed) == 1
    assert top_of(groups[1]) - limit_y == pytest.approx(7.8 * per_mm, abs=0.1)
    words = " | ".join(words_in(read(picture)))
    assert "maximum 7 in (177.8 mm): 1.1, riser" in words
    assert "minimum 4 in (101.6 mm): 1.1, riser, lies beyond the scale" in words


def test_what_lies_outside_is_marked_without_colours_too():
    inspection = with_rises(staircase((5,)), [0.170, 0.1779, 0.1777, 0.185, 0.170])
    picture = step_charts(inspection, "rise", check(inspection, rules()))[0]
    groups = steps_in(picture)

    def signs(step_id):
        group = groups[step_id]
        hatched = any(rect.get("fill", "").startswith("url(#") for rect in group.iter(f"{SVG}rect"))
        crosses = [line for line in group.iter(f"{SVG}line") if line.get("stroke-width") == "1.3"]
        return hatched, len(crosses), len(list(group.iter(f"{SVG}circle")))

    assert [signs(k) for k in (1, 2, 3, 4)] == [(False, 0, 0), (True, 2, 1), (False, 0, 1), (True, 2, 0)]
    words = words_in(read(picture))
    assert {"outside", "outside, close", "within, close"} <= set(words)
    assert "Δ 15.0 !" in words
    assert "Δ 7.9 !" in words


def test_the_worst_pair_of_a_flight_is_shown_without_a_check():
    inspection = staircase((6,))
    found = inspection.flights[0].rise
    assert f"Δ {found.max_adjacent * 1000.0:.1f}" in words_in(read(step_charts(inspection, "rise")[0]))


def test_flights_stand_beside_each_other_with_their_own_means():
    inspection = staircase((5, 4), (0.0, 90.0))
    words = " | ".join(words_in(read(step_charts(inspection, "rise")[0])))
    for flight in inspection.flights:
        mean, spread = flight.rise.mean * 1000.0, flight.rise.range * 1000.0
        assert f"flight {flight.flight_id} · mean {mean:.1f} · range {spread:.1f} mm" in words


@pytest.mark.parametrize("count", [2, 3, 10, 60])
def test_the_line_of_the_nosings_has_a_point_for_each(count):
    inspection = staircase((count,))
    drawn = nosing_charts(inspection)
    if count < 3:
        assert drawn == ()
        return
    line = nosing_line(inspection, inspection.flights[0])
    ((flight, picture),) = drawn
    groups = steps_in(picture)
    assert flight is inspection.flights[0]
    assert sorted(groups) == list(range(1, count + 1))
    y = np.array([float(next(groups[k].iter(f"{SVG}circle")).get("cy")) for k in sorted(groups)])
    if count <= STEPS_PER_ROW:
        slope, offset = np.polyfit(line.deviations_m, y, 1)
        np.testing.assert_allclose(y, slope * line.deviations_m + offset, atol=0.02)
        assert slope < 0.0
        shown = {word.replace("−", "-") for group in groups.values() for word in words_in(group)}
        assert {f"{value * 1000.0:+.1f}" for value in line.deviations_m if abs(value) > 0.00006} <= shown


def test_without_a_staircase_there_is_no_chart():
    bare = dataclasses.replace(staircase(), steps=(), flights=())
    assert step_charts(bare, "rise") == step_charts(bare, "going") == nosing_charts(bare) == ()


@pytest.mark.parametrize("maximum", ["170", "171", "172", "173", "175", "178"])
def test_no_line_runs_through_the_words_of_a_bar(maximum):
    """Bars that end just below a limit are the usual case, and the mean lies among them."""
    limit = edited(rules(), "r", "maximum", Limit.of(maximum, "mm"), "as a test has it")
    inspection = staircase((14,))
    picture = read(step_charts(inspection, "rise", check(inspection, limit))[0])
    groups = [group for group in picture.iter(f"{SVG}g") if group.get("data-step")]
    inside = {id(line) for group in groups for line in group.iter(f"{SVG}line")}
    lines = [
        float(line.get("y1"))
        for line in picture.iter(f"{SVG}line")
        if line.get("stroke-dasharray") and id(line) not in inside
    ]
    assert len(lines) == 2, "a limit and the mean; the other limit is far away"
    words = [next(node for node in group.iter(f"{SVG}text") if "." in node.text) for group in groups]
    assert len(words) == 14
    for word in words:
        base, size = float(word.get("y")), float(word.get("font-size"))
        top = base - 0.72 * size
        assert all(not top - 0.3 < line < base + 0.5 for line in lines)
        assert base < top_of(next(group for group in groups if word in list(group.iter())))


def test_a_limit_that_the_user_has_set_is_told_in_the_key():
    inspection = staircase((14,))
    own = edited(rules(), "r", "maximum", Limit.of("180", "mm"), "as a test has it")
    words = words_in(read(step_charts(inspection, "rise", check(inspection, own))[0]))
    assert "maximum 180 mm (set by the user; the code: 7 in (177.8 mm)): 1.1, riser" in words
    assert "Limits: Test, 2026, but for those set by the user." in words
    untouched = words_in(read(step_charts(inspection, "rise", check(inspection, rules()))[0]))
    assert not any("the user" in word for word in untouched)


def test_words_of_a_rule_file_are_words():
    with_words = rules(clause='<b onload="x">&1</b>')
    inspection = staircase((4,))
    picture = step_charts(inspection, "rise", check(inspection, with_words))[0]
    assert any('<b onload="x">&1</b>' in word for word in words_in(read(picture)))


@pytest.mark.parametrize("drawn", [step_charts(staircase((5,)), "rise")[0], nosing_charts(staircase((5,)))[0][1]])
def test_a_picture_needs_nothing_from_outside(drawn):
    assert re.findall(r"<script|href|url\((?!#)|<style|onload", drawn) == []
    assert read(drawn).get("viewBox").startswith(f"0 0 {svg.PAGE:g} ")


def test_hostile_words_are_escaped_and_nothing_of_them_is_lost():
    element = ET.fromstring(svg.picture(10.0, 10.0, HOSTILE, svg.text_element(0.0, 0.0, HOSTILE)))
    assert [node.text for node in element.iter(f"{SVG}text")] == ['<script>alert("1")</script>\\u0007& ]]>']
    assert not list(element.iter(f"{SVG}script"))
