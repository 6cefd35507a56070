"""A setting swept over its range: the numbers are those of plain runs, and the drawing shows them."""

import dataclasses
import re
from functools import cache

import pytest

from stair_inspector.errors import ConfigError
from stair_inspector.memo import Memo
from stair_inspector.params import SETTINGS, Params
from stair_inspector.pipeline import inspect
from stair_inspector.viewer.compute.sensitivity import (
    SWEPT_QUANTITIES,
    Sweep,
    SweepPoint,
    plateau,
    sweep,
    swept_values,
)
from stair_inspector.viewer.parts.tune.sensitivity_html import sweep_html
from tests.synthetic import Stair, exact_params

SCAN = Stair(n_steps=4, noise=0.001, risers=True).scan()
PARAMS = exact_params()


def always():
    return True


def swept(name, params=PARAMS, is_wanted=always, on_point=lambda _: None):
    return sweep(SCAN, params, name, Memo(), is_wanted, on_point)


@cache
def eps_sweep():
    """One sweep and what was told on its way."""
    told = []
    return swept("levels.eps_m", on_point=told.append), told


def made(values, present=0.02, name="levels.eps_m", quantity="n_steps", n_wanted=None):
    """A sweep of given values: None for one that could not be measured."""
    points = tuple(
        SweepPoint(v, error="no staircase found") if q is None else SweepPoint(v, {quantity: q})
        for v, q in values.items()
    )
    return Sweep(name, PARAMS, present, points, n_wanted or len(points))


@pytest.mark.parametrize("name", SETTINGS.swept())
def test_every_swept_setting_spans_its_range_and_holds_the_present_value(name):
    knob, present = SETTINGS.knob(name), Params().value(name)
    values = swept_values(knob, present)
    assert values == sorted(set(values))
    assert (values[0], values[-1]) == (knob.low, knob.high)
    assert present in values
    assert len(values) >= 15
    if SETTINGS[name].kind is int:
        assert all(value == int(value) for value in values)


def test_the_numbers_are_those_of_plain_runs():
    found, _ = eps_sweep()
    assert found.is_complete
    assert [point.value for point in found.points] == swept_values(SETTINGS.knob("levels.eps_m"), 0.02)
    for point in found.points[::5]:
        plain = inspect(SCAN, PARAMS.replaced("levels.eps_m", point.value))
        rises = [step.rise_m.value for step in plain.steps if step.rise_m is not None]
        assert point.quantities["n_steps"] == len(plain.steps)
        assert point.quantities["n_levels"] == len(plain.levels)
        assert point.quantities["mean_rise_m"] == (pytest.approx(sum(rises) / len(rises)) if rises else None)
        assert set(point.quantities) == set(SWEPT_QUANTITIES)


def test_too_long_a_reach_leaves_the_plateau_of_the_steps():
    """Levels 170 mm apart: eps_z up to the 100 mm of its range keeps them apart; m beyond a tread's points does not."""
    found = swept("levels.min_points")
    low, high = plateau(found, "n_steps")
    per_tread = Stair(n_steps=4, noise=0.001).points_per_tread
    assert low <= 50 <= high <= per_tread
    beyond = [point for point in found.points if point.value > 2 * per_tread]
    assert beyond
    assert all(point.quantities.get("n_steps") != 4 for point in beyond)


def test_the_papers_quantities_are_taken_with_the_papers_method():
    found = swept("edges.front_percentile", PARAMS.replaced("method", "paper"))
    by_value = {point.value: point.quantities for point in found.points}
    paper = inspect(SCAN, PARAMS.replaced("method", "paper"))
    depths = [step.paper.d_fb_m for step in paper.steps]
    assert by_value[95.0]["mean_tread_depth_m"] == pytest.approx(sum(depths) / len(depths))
    assert by_value[95.0]["mean_u_rise_m"] is None
    assert (
        by_value[51.0]["mean_tread_depth_m"]
        < by_value[95.0]["mean_tread_depth_m"]
        < by_value[100.0]["mean_tread_depth_m"]
    )


def test_the_values_beside_the_present_one_come_first_and_each_is_told():
    found, told = eps_sweep()
    values = swept_values(SETTINGS.knob("levels.eps_m"), 0.02)
    here = values.index(0.02)
    assert [point.value for point in told[0].points] == [0.02]
    assert {point.value for point in told[2].points} == set(values[here - 1 : here + 2])
    assert [len(each.points) for each in told] == list(range(1, len(values) + 1))
    assert not told[-2].is_complete
    assert told[-1] == found


def test_a_sweep_that_is_no_longer_wanted_stops_with_what_it_has():
    asked = iter([True, True, True, False])
    found = swept("levels.eps_m", is_wanted=lambda: next(asked))
    assert (len(found.points), found.is_complete) == (3, False)
    assert 'data-complete="false"' in sweep_html(found, "n_steps")
    assert f"3 of {found.n_wanted} values measured." in sweep_html(found, "n_steps")


def test_a_value_that_cannot_be_measured_says_why_and_the_others_go_on():
    params = dataclasses.replace(PARAMS).replaced("overrules.force", "level:4=tread")
    found = swept("levels.min_points", params)
    errors = [point for point in found.points if point.error]
    assert found.is_complete
    assert errors
    assert "there is no level 4 with these settings" in errors[-1].error
    assert not errors[-1].quantities
    html = sweep_html(found, "n_steps")
    assert html.count('data-part="failure"') == len(errors)
    assert "there is no level 4" in html


def test_only_numbers_can_be_swept():
    with pytest.raises(ConfigError, match="method: not a numeric setting"):
        swept("method")


@pytest.mark.parametrize(
    ("values", "quantity", "expected"),
    [
        ({0.01: 4, 0.02: 5, 0.03: 5, 0.04: 4}, "n_steps", (0.02, 0.03)),
        ({0.01: 5, 0.02: 5, 0.03: None, 0.04: 5}, "n_steps", (0.01, 0.02)),
        ({0.01: 4, 0.02: 5, 0.03: 4}, "n_steps", (0.02, 0.02)),
        ({0.01: 4, 0.02: None, 0.03: 4}, "n_steps", None),
        ({0.01: 4, 0.03: 4}, "n_steps", None),
        ({0.01: 0.17, 0.02: 0.1705, 0.03: 0.1714, 0.04: 0.1716}, "mean_rise_m", (0.01, 0.03)),
    ],
)
def test_the_plateau_is_around_the_present_value(values, quantity, expected):
    assert plateau(made(values, quantity=quantity), quantity) == expected


@pytest.mark.parametrize(
    ("values", "quantity", "unit", "sentence"),
    [
        ({0.01: 4, 0.02: 5, 0.03: 5}, "n_steps", "mm", "Stays at 5 from 20 mm to 30 mm; the present value is 20 mm."),
        (
            {0.01: 4, 0.02: 5, 0.03: 4},
            "n_steps",
            "mm",
            "5 at the present 20 mm, and different at the values beside ",
        ),
        (
            {0.02: None, 0.03: 4},
            "n_steps",
            "mm",
            "With the present value 20 mm there is no such number. 1 ",
        ),
        ({0.01: 0.17, 0.02: 0.1705}, "mean_rise_m", "mm", "Stays within 1 mm of 170.5 mm from 10 mm to 20 mm; "),
        ({0.01: 0.17, 0.02: 0.1705}, "mean_rise_m", "in", "Stays within 1 mm of 6 11/16 in from 10 mm to 20 mm; "),
    ],
)
def test_the_sentence_under_the_drawing(values, quantity, unit, sentence):
    html = sweep_html(made(values, quantity=quantity), quantity, unit)
    told = re.search(r'data-testid="plateau"[^>]*>([^<]*)<', html).group(1)
    assert told.startswith(sentence)


def test_before_the_first_value_nothing_is_said_about_the_number():
    html = sweep_html(swept("levels.eps_m", is_wanted=lambda: False), "n_steps")
    assert re.search(r'data-testid="plateau"[^>]*>([^<]*)<', html).group(1) == "0 of 16 values measured."


def test_the_drawing_has_a_dot_for_every_value_at_its_place():
    values = {0.001: 0.1, 0.01: 0.2, 0.1: 0.3}
    html = sweep_html(made(values, present=0.01, quantity="mean_rise_m"), "mean_rise_m")
    dots = re.findall(r'<circle data-value="([\d.]+)" data-quantity="([\d.]+)" cx="([\d.]+)" cy="([\d.]+)"', html)
    assert [(float(v), float(q)) for v, q, _, _ in dots] == list(values.items())
    x, y = ([float(dot[k]) for dot in dots] for k in (2, 3))
    # A range over two decades is drawn by equal ratios; upwards is more.
    assert x[1] - x[0] == pytest.approx(x[2] - x[1], abs=0.2)
    assert y[0] - y[1] == pytest.approx(y[1] - y[2], abs=0.2)
    assert y[0] > y[2]
    assert "<title>10 mm: 200.0 mm</title>" in html


def test_the_line_is_broken_where_nothing_was_measured():
    html = sweep_html(made({0.01: 4, 0.02: 4, 0.03: None, 0.04: 4, 0.05: 4}), "n_steps")
    curve = re.search(r'data-part="curve" d="([^"]*)"', html).group(1)
    assert (curve.count("M"), curve.count("L")) == (2, 2)


@pytest.mark.parametrize("quantity", SWEPT_QUANTITIES)
@pytest.mark.parametrize("unit", ["mm", "in"])
def test_every_quantity_is_drawn_inside_the_picture_without_scripts(quantity, unit):
    found, _ = eps_sweep()
    html = sweep_html(found, quantity, unit)
    assert "<script" not in html
    assert "on" + "click" not in html
    assert SWEPT_QUANTITIES[quantity] in html
    for x, y in re.findall(r'cx="([-\d.]+)" cy="([-\d.]+)"', html):
        assert 0.0 <= float(x) <= 420.0
        assert 0.0 <= float(y) <= 200.0


def test_the_reasons_from_a_file_are_escaped():
    found = dataclasses.replace(made({0.02: 5, 0.03: None}))
    points = (found.points[0], SweepPoint(0.03, error="<script>alert(1)</script>"))
    assert "<script>" not in sweep_html(dataclasses.replace(found, points=points), "n_steps")
