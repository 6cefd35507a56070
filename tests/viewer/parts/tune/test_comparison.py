"""Two results side by side: the same steps in one row, whatever their numbers, and the differences between them."""

import dataclasses
import re
from functools import cache

import numpy as np
import pytest

from stair_inspector.errors import ConfigError
from stair_inspector.memo import Memo
from stair_inspector.model import Measured
from stair_inspector.params import Params
from stair_inspector.pipeline import inspect
from stair_inspector.viewer.parts.tune.comparison import Difference, compare, comparison_html
from tests.synthetic import Stair, exact_params

STAIR = Stair(n_steps=6, noise=0.001, risers=True)


@cache
def scan_and_memo():
    return STAIR.scan(), Memo()


@cache
def result(**changes):
    params = exact_params()
    for name, value in changes.items():
        params = params.replaced(name.replace("__", "."), value)
    scan, memo = scan_and_memo()
    return inspect(scan, params, memo)


def pairs(comparison):
    return [(row.step_a, row.step_b) for row in comparison.steps]


def cells_of(html, row):
    """The texts of a step's cells, line by line."""
    found = re.findall(r'<tr data-testid="comparison-row".*?</tr>', html)[row]
    cells = re.findall(r"<td.*?</td>", found)
    return [[re.sub("<[^>]*>", "", part) for part in re.split(r"</div>", cell) if part != "</td>"] for cell in cells]


def test_a_result_compared_with_itself_has_no_difference():
    comparison = compare(result(), result())
    assert pairs(comparison) == [(k, k) for k in range(1, 7)]
    assert comparison.settings == ()
    differences = [each.difference for row in comparison.steps for each in row.values]
    assert {d for d in differences if d is not None} == {0.0}
    assert not any(each.is_beyond_u for row in comparison.steps for each in row.values)
    html = comparison_html(comparison, "A", "B")
    assert "The settings are the same." in html
    assert {cell[2] for cell in cells_of(html, 0)[1:]} <= {"", "–"}
    assert "±" not in html


def test_steps_are_matched_by_their_points_when_their_numbers_change():
    """The lowest tread is taken away: every other step is one number lower."""
    b = result(overrules__force="level:1=rejected", flights__max_rise_m=0.4)
    assert len(b.steps) == 5
    comparison = compare(result(), b)
    assert pairs(comparison) == [(1, None), *((k, k - 1) for k in range(2, 7))]
    rise = {each.name: each for each in comparison.steps[2].values}["rise_m"]
    assert rise.a == result().steps[2].rise_m.value
    assert rise.b == b.steps[1].rise_m.value
    assert abs(rise.difference) < 0.002
    assert all(each.a is not None and each.b is None for each in comparison.steps[0].values[:1])


def test_a_step_that_only_b_has_stands_at_its_height():
    a = result(overrules__force="level:6=rejected")
    assert len(a.steps) == 5
    assert pairs(compare(a, result())) == [*((k, k) for k in range(1, 6)), (None, 6)]
    middle = compare(result(overrules__force="level:1=rejected", flights__max_rise_m=0.4), result())
    assert pairs(middle) == [(None, 1), *((k - 1, k) for k in range(2, 7))]


def test_the_other_way_round_is_the_same_with_the_opposite_sign():
    b = result(survey__edge_source="tread")
    there, back = compare(result(), b), compare(b, result())
    assert [row.step_b for row in there.steps] == [row.step_a for row in back.steps]
    for row, turned in zip(there.steps, back.steps, strict=True):
        for one, other in zip(row.values, turned.values, strict=True):
            assert (one.difference is None) == (other.difference is None)
            assert one.difference is None or one.difference == -other.difference


def test_the_settings_that_differ_are_listed_with_their_units():
    comparison = compare(result(), result(levels__eps_m=0.03, survey__edge_source="tread"))
    assert comparison.settings == (("levels.eps_m", 0.02, 0.03), ("survey.edge_source", "auto", "tread"))
    html = comparison_html(comparison, "A", "B")
    assert '<li data-setting="levels.eps_m">ε_z: 20 mm → 30 mm</li>' in html
    assert '<li data-setting="survey.edge_source">Edges from: auto → tread</li>' in html


def test_the_papers_values_are_compared_where_one_result_is_the_papers():
    comparison = compare(result(), result(method="paper"))
    assert not comparison.is_survey
    assert [each.name for each in comparison.steps[0].values] == ["h_m", "d_fb_m", "d_ff_m", "w_m", "theta_deg"]
    assert comparison.steps[0].values[0].a == pytest.approx(0.17, abs=0.002)
    assert comparison.steps[-1].values[0].a is None, "the last step has no h"
    assert "mean_h_m" in {each.name for each in comparison.summary}


def test_the_summary_counts_and_averages():
    b = result(overrules__force="level:6=rejected")
    summary = {each.name: each for each in compare(result(), b).summary}
    assert (summary["steps"].a, summary["steps"].b, summary["steps"].difference) == (6, 5, -1)
    assert (summary["flights"].a, summary["flights"].b) == (1, 1)
    rises = [step.rise_m.value for step in result().steps]
    assert summary["mean_rise_m"].a == pytest.approx(np.mean(rises))
    assert summary["max_adjacent_rise_m"].a == pytest.approx(np.abs(np.diff(rises)).max())


def test_a_difference_beyond_both_uncertainties_is_marked_and_one_within_is_not():
    a = result()
    steps = [
        dataclasses.replace(step, rise_m=Measured(0.17, 0.0003), going_m=Measured(0.28, 0.001)) for step in a.steps
    ]
    moved = [
        dataclasses.replace(step, rise_m=Measured(0.1706, 0.0004), going_m=Measured(0.2806, 0.001)) for step in steps
    ]
    comparison = compare(dataclasses.replace(a, steps=tuple(steps)), dataclasses.replace(a, steps=tuple(moved)))
    rise, going = comparison.steps[0].values[:2]
    assert (rise.is_beyond_u, going.is_beyond_u) == (True, False)
    html = comparison_html(comparison, "kept", "now")
    step, rise, going = cells_of(html, 0)[:3]
    assert step == ["1"]
    assert rise == ["170.0", "170.6", "! +0.6"]
    assert going == ["280.0", "280.6", "+0.6"]
    assert "B − A +0.6 mm, the two uncertainties together 0.5 mm" in html


def test_inches_are_fractions_and_their_difference_a_decimal():
    a = result()
    steps = [dataclasses.replace(step, rise_m=Measured(0.17, 0.0003)) for step in a.steps]
    moved = [dataclasses.replace(step, rise_m=Measured(0.1674, 0.0004)) for step in steps]
    comparison = compare(dataclasses.replace(a, steps=tuple(steps)), dataclasses.replace(a, steps=tuple(moved)))
    assert cells_of(comparison_html(comparison, "A", "B", "in"), 0)[1] == ["6 11/16", "6 9/16", "! −0.102"]


def test_what_is_not_known_is_a_dash_and_never_a_zero():
    b = result(overrules__force="level:6=rejected")
    html = comparison_html(compare(result(), b), "A", "B")
    last = cells_of(html, 5)
    assert last[0] == ["6 → –"]
    assert [cell[2] for cell in last[1:]] == ["–"] * 5
    assert Difference("rise_m", 0.1, None).difference is None


def test_names_are_escaped():
    html = comparison_html(compare(result(), result()), "<b>x</b>", '"><script>')
    assert "<script>" not in html
    assert "&lt;b&gt;x&lt;/b&gt;" in html


def test_results_of_two_scans_are_refused():
    other = inspect(Stair(n_steps=6, seed=2).scan(), exact_params())
    with pytest.raises(ConfigError, match="are different scans; choose a run of this scan"):
        compare(result(), other)


def test_nothing_to_compare_is_two_empty_sides():
    none = result(overrules__climb="-x")
    assert none.steps == ()
    comparison = compare(none, none)
    assert comparison.steps == ()
    assert {each.name: (each.a, each.b) for each in comparison.summary}["steps"] == (0, 0)
    assert pairs(compare(none, result())) == [(None, k) for k in range(1, 7)]


def test_a_setting_is_looked_up_by_its_name():
    assert Params().value("levels.eps_m") == Params().levels.eps_m
    assert Params().value("unit") == "auto"
