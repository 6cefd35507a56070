"""What an inspector reads and tunes: the table, the settings, mistakes and their cure."""

import math

import pytest

from stair_inspector.content.remarks import on_page
from tests.browser.inspector_page import rows_of, survey_rows_of


def assert_survey_table(page, inspection):
    shown, wanted = page.survey_table(), survey_rows_of(inspection)
    assert [row[0] for row in shown] == [row[0] for row in wanted]
    for cells, values in zip(shown, wanted, strict=True):
        for cell, value in zip(cells[1:], values[1:], strict=True):
            assert (cell is None) == (value is None)
            if value is not None:
                # Rounded where its uncertainty is: to whole ones from 9.95 on.
                assert cell[0] == pytest.approx(value[0], abs=0.51 if value[1] >= 9.95 else 0.051)
                # Two digits or one decimal; never shown as nothing.
                assert cell[1] == pytest.approx(value[1], abs=max(0.0051, 0.06 * value[1], 0.051 * (value[1] > 0.09)))
                assert cell[1] > 0.0


def test_a_page_opens_with_the_measurement(page, measured):
    inspection = measured()
    assert len(inspection.steps) == len(page.survey_table()) == 5
    assert_survey_table(page, inspection)
    page.choose_columns("paper")
    assert page.table() == rows_of(inspection)
    page.choose_columns("survey")
    assert_survey_table(page, inspection)
    assert "up to date" in page.text("status")
    assert "5 steps" in page.text("n-steps")
    assert "stair.ply" in page.text("scan")
    legend = page.text("legend")
    assert [word for word in ("floor", "steps", "front edge", "back edge", "side edges") if word not in legend] == []
    assert page.by_id("histogram").locator("[data-level]").count() == len(inspection.levels)
    notes = page.by_id("notes").locator("li").all_inner_texts()
    # Once a result has stood, values that hang on the settings are told too.
    said = [words for words in notes if "hangs on the settings" not in words]
    assert said == [on_page(note.message) for note in inspection.notes]


@pytest.mark.parametrize(
    ("label", "key", "setting", "value", "used"),
    [
        pytest.param("θ_th [°]", "Home", "horizontal.theta_deg", 1.0, "θ_th 1°", marks=pytest.mark.slow),
        ("ε_z [mm]", "Home", "levels.eps_m", 0.001, "ε_z 1 mm"),
        pytest.param("m", "End", "levels.min_points", 5000, "m 5000", marks=pytest.mark.slow),
        pytest.param(
            "paper's α_f [%]", "ArrowLeft", "edges.front_percentile", 94.5, "α 94.5/5 %", marks=pytest.mark.slow
        ),
        pytest.param(
            "paper's α_b [%]", "ArrowRight", "edges.back_percentile", 5.5, "α 95/5.5 %", marks=pytest.mark.slow
        ),
        pytest.param(
            "paper's side [%]",
            "ArrowLeft",
            "edges.side_percentile",
            98.5,
            "sides 98.5 %",
            marks=pytest.mark.slow,
        ),
        pytest.param("k", "ArrowRight", "normals.k", 31, "k 31", marks=pytest.mark.slow),
    ],
)
def test_a_slider_moved_by_keyboard_changes_the_table(page, measured, label, key, setting, value, used):
    page.choose_columns("paper")
    before = page.table()
    page.press(label, key)
    page.await_result(used)
    assert page.table() == rows_of(measured({setting: value}))
    assert page.table() != before


@pytest.mark.slow
@pytest.mark.parametrize(
    ("tab", "label", "option", "setting", "used"),
    [
        ("Tune", "Axes rule", "global", "axes.rule", "axes global"),
        pytest.param("Scan", "Method", "paper", "method", "used: paper", marks=pytest.mark.slow),
        pytest.param("Scan", "Up", "-z", "up", "up (0.000, 0.000, -1.000) given", marks=pytest.mark.slow),
    ],
)
def test_a_menu_changes_the_table(page, measured, tab, label, option, setting, used):
    page.choose_columns("paper")
    before = page.table()
    page.tab(tab)
    page.choose(label, option)
    page.await_result(used)
    assert page.table() == rows_of(measured({setting: option}))
    assert page.table() != before


@pytest.mark.slow
def test_an_up_vector_of_ones_own(page, measured):
    page.choose_columns("paper")
    page.tab("Scan")
    page.choose("Up", "vector")
    page.await_result("up (0.000, 0.000, 1.000) given")
    # The label of a vector belongs to the first of its three fields.
    page.page.get_by_label("Up vector").first.fill("0.1")
    page.await_result("up (0.100, 0.000, 0.995) given")
    assert page.table() == rows_of(measured({"up": "0.1,0,1"}))


@pytest.mark.slow
def test_an_up_that_leaves_no_staircase_says_so(page):
    page.tab("Scan")
    page.choose("Up", "y")
    page.await_result("up (0.000, 1.000, 0.000) given")
    (why,) = page.table()[-1]
    assert why.startswith("No staircase found: ")


def test_a_number_out_of_range_is_a_sentence_and_the_good_table_stays_dimmed(page, measured):
    page.choose_columns("paper")
    good = page.table()
    page.type_number("paper's α_f [%]", 500)
    sentence = page.await_error()
    assert sentence == "paper's α_f [%]: got 500; give a value from 51 to 100"
    assert page.table() == good
    assert page.is_stale()
    assert page.by_id("state").get_attribute("data-state") == "error"
    page.type_number("paper's α_f [%]", 90)
    page.await_result("α 90/5 %")
    assert page.by_id("error").count() == 0
    assert not page.is_stale()
    assert page.table() == rows_of(measured({"edges.front_percentile": 90.0}))


@pytest.mark.slow
def test_a_hostile_value_of_a_slider_is_a_sentence(page):
    slider = page.uuid("θ_th [°]")
    for theta, value in enumerate([999, -1, math.nan, -math.inf], start=20):
        page.send(slider, value)
        assert page.await_error().startswith("θ_th [°]: got ")
        page.send(slider, theta)
        page.await_result(f"θ_th {theta}°")


@pytest.mark.slow
def test_a_value_of_the_wrong_kind_is_survived(page):
    slider = page.uuid("θ_th [°]")
    for theta, value in enumerate(["abc", "nan", "1e400", None, [1, 2], {"a": 1}], start=20):
        page.send(slider, value)
        page.send(slider, theta)
        page.await_result(f"θ_th {theta}°")


@pytest.mark.slow
def test_an_option_that_does_not_exist_is_a_sentence(page):
    page.send(page.uuid("Axes rule"), "<b>mine</b>")
    assert page.await_error() == "axes.rule: got '<b>mine</b>'; give one of auto, global, per_step"
    page.send(page.uuid("Axes rule"), "global")
    page.await_result("axes global")


@pytest.mark.slow
def test_a_hostile_step_and_view_are_sentences(page):
    page.send(page.uuid("Selected step"), "77")
    assert "step 77 does not exist" in page.await_notification("Not done")
    page.close_notifications()
    page.tab("Look")
    page.send(page.uuid("Camera"), "Below")
    assert "give one of Home, Front, Side, Top" in page.await_notification("Not done")


@pytest.mark.slow
def test_reset_brings_back_the_preset(page, measured):
    page.choose_columns("paper")
    good = page.table()
    page.press("paper's α_f [%]", "End")
    page.await_result("α 100/5 %")
    page.tab("Scan")
    page.choose("Method", "paper")
    page.await_result("used: paper", "α 100/5 %")
    page.hotkey("Shift+R")
    page.await_result("survey", "α 95/5 %")
    assert page.slider_value("paper's α_f [%]") == 95.0
    page.tab("Scan")
    assert page.page.get_by_label("Method").first.input_value() == "survey"
    page.tab("Tune")
    assert page.table() == good == rows_of(measured())
