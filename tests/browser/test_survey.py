"""The survey on the page: its columns, the chosen step's dimensions, rejected surfaces, and the inspector's word."""

import re

import pytest

from tests.browser.inspector_page import click_at_once, rows_of
from tests.browser.test_workspace import button, open_folder

LABELS = "/stair/segments/dimension_labels/"


def open_overrules(page):
    """Open the folder of overrules if it is closed."""
    open_folder(page, "Steps", "Overrules", button(page, "Clear overrules"))


def overrules_text(page):
    """The text field of the surfaces that are overruled."""
    label = page.page.get_by_text("Surfaces", exact=True).and_(page.page.locator("label")).first
    return label.locator("xpath=ancestor::*[.//input][1]").locator("input").first


def mark(page, kind):
    open_overrules(page)
    click_at_once(page.page.get_by_role("button", name=kind, exact=True))
    page.page.wait_for_function(
        "(kind) => document.querySelector('[data-testid=used]').innerText.includes('=' + kind)", arg=kind
    )
    page.await_result()


def clear(page):
    click_at_once(page.page.get_by_role("button", name="Clear overrules"))
    page.page.wait_for_function("() => !document.querySelector('[data-testid=used]').innerText.includes('overruled')")
    page.await_result()


def test_the_survey_tells_value_uncertainty_and_coverage_flight_by_flight(page, measured):
    inspection = measured()
    assert page.by_id("steps").get_attribute("data-columns") == "survey"
    headline = page.by_id("flight-row").first.inner_text()
    assert re.match(r"▾ ?Flight 1 · 5 risers · pitch [\d.]+ ± [\d.]+° · rise [\d.]+–[\d.]+", headline)
    rows = page.page.locator("[data-testid=step-row]")
    assert rows.count() == len(inspection.steps)
    shown = [mark.get_attribute("data-coverage") for mark in page.by_id("steps").locator("svg").all()]
    assert shown == [f"{step.coverage:.3f}" for step in inspection.steps if step.coverage is not None]
    hint = rows.first.locator("td").nth(1).get_attribute("title")
    assert re.fullmatch(r"[\d.]+ ± [\d.]+ mm \(k = 2\): (\w+ [\d.]+, )*\w+ [\d.]+ mm", hint)
    page.choose_columns("paper")
    assert page.table() == rows_of(inspection)
    assert page.by_id("flight-row").count() == 0


@pytest.mark.slow
def test_the_papers_method_has_the_papers_columns_only(page):
    page.tab("Scan")
    page.choose("Method", "paper")
    page.await_result("used: paper")
    page.tab("Steps")
    page.await_columns("paper")
    assert page.page.get_by_role("button", name="Survey", exact=True).count() == 0
    assert page.page.get_by_label("Show rejected surfaces").count() == 0
    page.tab("Scan")
    page.choose("Method", "survey")
    page.await_result("used: survey")
    page.tab("Steps")
    page.await_columns("survey")


@pytest.mark.slow
def test_a_chosen_step_has_its_dimensions_in_the_scene_and_all_its_values_on_a_card(page, measured):
    step = measured().steps[1]
    assert page.text("card") == ""
    assert not [name for name in page.scene() if name.startswith(LABELS)]
    assert "/stair/segments/nosings" in page.scene()
    page.click_row(2)
    page.await_selection(2)
    page.await_node(f"{LABELS}rise")
    wanted = {"rise": step.rise_m, "going": step.going_m, "tread": step.tread_depth_m, "width": step.width_m}
    shown = {name.removeprefix(LABELS) for name in page.scene() if name.startswith(LABELS)}
    assert shown == {name for name, value in wanted.items() if value is not None}
    assert {"/stair/segments/measuring", "/stair/segments/dimensions"} <= page.scene()
    card = page.text("card")
    assert "Step 2 · tread · flight 1" in card
    assert f"{1000.0 * step.rise_m.value:.1f} ± " in card
    assert [word for word in ("left", "overhang", "fall", "cross-fall", "coverage", "RMS") if word not in card] == []
    page.click_row(2)
    page.await_selection()
    page.await_node(f"{LABELS}rise", there=False)
    page.await_node("/stair/segments/measuring", there=False)
    assert page.text("card") == ""


@pytest.mark.slow
def test_marking_a_step_rejected_changes_the_table_and_marking_its_surface_a_tread_brings_it_back(page):
    before = page.survey_table()
    page.click_row(5)
    page.await_selection(5)
    mark(page, "rejected")
    page.await_selection()
    assert len(page.survey_table()) == 4
    assert overrules_text(page).input_value().startswith("at:")
    page.page.get_by_label("Show rejected surfaces").click()
    row = page.by_id("surface-row").first
    row.wait_for()
    number = row.get_attribute("data-surface")
    cells = [cell.strip() for cell in row.locator("td").all_inner_texts()]
    assert cells[0] == number
    assert float(cells[1]) > 0.5
    assert float(cells[2]) > 0.1
    assert len(cells[3]) > 10
    page.await_node(f"/stair/segments/rejected/surface {number}")
    click_at_once(row)
    page.page.locator("[data-testid=surface-row][aria-selected=true]").wait_for()
    assert page.page.get_by_label("Selected step").first.input_value() == f"surface {number}"
    mark(page, "tread")
    assert [row[0] for row in page.survey_table()] == [row[0] for row in before]
    # One decision about one place: the second has replaced the first.
    assert overrules_text(page).input_value().count("at:") == 1
    clear(page)
    assert page.survey_table() == before
    assert overrules_text(page).input_value() == ""


@pytest.mark.slow
def test_an_overrule_that_is_written_counts_from_enter_and_a_wrong_one_is_a_sentence(page):
    open_overrules(page)
    field = overrules_text(page)
    field.fill("level:5=reject")
    page.page.wait_for_timeout(150)
    assert page.by_id("error").count() == 0
    field.press("Enter")
    assert page.await_error().startswith("overrules.force: got 'level:5=reject'; give entries such as ")
    field.fill("level:5=rejected")
    page.page.wait_for_timeout(150)
    field.press("Enter")
    page.await_result("overruled level:5=rejected")
    assert len(page.survey_table()) == 4
    clear(page)


@pytest.mark.slow
def test_marking_nothing_is_a_sentence(page):
    open_overrules(page)
    click_at_once(page.page.get_by_role("button", name="landing", exact=True))
    assert "choose a step or a rejected surface first" in page.await_notification("Not done")
