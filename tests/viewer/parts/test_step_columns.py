"""Which columns the table of steps has, and in which order its rows stand."""

import dataclasses

import pytest

from stair_inspector.errors import ConfigError
from stair_inspector.model import Measured
from stair_inspector.viewer.parts.step_columns import OFFERED, USUAL, USUAL_LOOK, VIEWS
from stair_inspector.viewer.parts.step_table_html import bar_html, table_html
from tests.viewer.parts.test_html import Page
from tests.viewer.surveyed import PALETTE, surveyed


@pytest.fixture(scope="module")
def inspection():
    return surveyed()[1]


def steps_in(source):
    """The numbers of the steps from the top of the table down."""
    return [int(row["data-step"]) for row in Page(source).of("tr") if "data-step" in row]


def heads(source):
    return [head["data-head"] for head in Page(source).of("th") if "data-head" in head]


def shown(inspection, view, look):
    return table_html(inspection, PALETTE, None, "pick", view, "mm", look)


@pytest.mark.parametrize("view", VIEWS)
def test_the_rms_residual_is_there_before_anything_is_chosen(inspection, view):
    source = shown(inspection, view, USUAL_LOOK)
    assert heads(source) == [column.name for column in OFFERED[view] if column.name in USUAL[view]]
    assert "rms" in heads(source)


@pytest.mark.parametrize("view", VIEWS)
def test_every_column_can_be_shown_and_hidden_alone(inspection, view):
    for column in OFFERED[view]:
        look = USUAL_LOOK.switched(view, column.name)
        source = shown(inspection, view, look)
        assert set(heads(source)) == set(USUAL[view]) ^ {column.name}
        rows = [row for row in Page(source).rows[1:] if len(row) > 1]
        assert {len(row) for row in rows} == {1 + len(look.columns(view))}
        bar = Page(bar_html(inspection, view, look, "pick"))
        boxes = [each["aria-checked"] for each in bar.of("button") if each.get("role") == "menuitemcheckbox"]
        assert boxes == ["true" if each in look.columns(view) else "false" for each in OFFERED[view]]
        assert look.switched(view, column.name) == USUAL_LOOK


def test_the_last_column_stays():
    look = USUAL_LOOK
    for name in sorted(USUAL["survey"] - {"rms"}):
        look = look.switched("survey", name)
    with pytest.raises(ConfigError, match="the last one stays"):
        look.switched("survey", "rms")


def test_a_column_of_the_other_view_is_none_of_this_one():
    with pytest.raises(ConfigError, match=r"^columns: got 'd_fb'; give one of"):
        USUAL_LOOK.switched("survey", "d_fb")
    with pytest.raises(ConfigError, match=r"^sort: got 'rise'; give one of"):
        USUAL_LOOK.resorted("paper", "rise")


@pytest.mark.parametrize(
    ("view", "name"), [("survey", "rms"), ("survey", "width"), ("paper", "points"), ("paper", "h")]
)
def test_rows_are_sorted_falling_then_rising_then_as_they_are_climbed(inspection, view, name):
    (column,) = [each for each in OFFERED[view] if each.name == name]
    above = {lower.step_id: upper for lower, upper in zip(inspection.steps, inspection.steps[1:], strict=False)}
    values = {step.step_id: column.value(step, above.get(step.step_id)) for step in inspection.steps}
    climbed = [step.step_id for step in inspection.steps]
    missing = [step_id for step_id in climbed if values[step_id] is None]
    look = USUAL_LOOK.resorted(view, name)
    for is_falling in (True, False):
        known = sorted(set(climbed) - set(missing), key=values.get, reverse=is_falling)
        numbers = steps_in(shown(inspection, view, look))
        assert sorted(numbers) == climbed
        assert [values[step_id] for step_id in numbers] == [values[step_id] for step_id in (*known, *missing)]
        assert numbers[len(known) :] == missing
        (head,) = [head for head in Page(shown(inspection, view, look)).of("th") if head.get("data-head") == name]
        assert head["aria-sort"] == ("descending" if is_falling else "ascending")
        look = look.resorted(view, name)
    assert look == USUAL_LOOK


def test_sorting_by_a_column_that_is_hidden_sorts_nothing(inspection):
    look = USUAL_LOOK.resorted("survey", "rms").switched("survey", "rms")
    assert steps_in(shown(inspection, "survey", look)) == [step.step_id for step in inspection.steps]
    assert steps_in(shown(inspection, "paper", USUAL_LOOK.resorted("survey", "width"))) == [1, 2, 3, 4, 5]


@pytest.mark.parametrize(("rise_m", "u_m", "is_underlined"), [(0.1731, 0.0004, True), (0.1731, 0.005, False)])
def test_what_is_even_within_its_uncertainty_is_not_underlined(inspection, rise_m, u_m, is_underlined):
    """The flight's neighbours that differ most are steps 4 and 5."""
    steps = [dataclasses.replace(step, rise_m=Measured(0.17, u_m)) for step in inspection.steps]
    steps[4] = dataclasses.replace(steps[4], rise_m=Measured(rise_m, u_m))
    source = shown(dataclasses.replace(inspection, steps=tuple(steps)), "survey", USUAL_LOOK)
    assert source.count('data-testid="worst-rise"') == 2 * is_underlined
