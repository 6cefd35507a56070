"""Keys, and what a control shows of itself: each key has one meaning wherever the focus is."""

import re

import numpy as np
import pytest

from tests.browser.inspector_page import THROTTLE_MS, click_at_once

_IS_DARK = "() => document.documentElement.dataset.mantineColorScheme === 'dark'"


def hold(page, key, ms=400):
    page.page.keyboard.down(key)
    page.page.wait_for_timeout(ms)
    page.page.keyboard.up(key)
    page.page.wait_for_timeout(THROTTLE_MS)


def look(page):
    """Where the camera stands and how it is turned."""
    return np.array(
        page.page.evaluate(
            "() => {const camera = window.__viserMutable.camera;"
            "return [...camera.position.toArray(), ...camera.quaternion.toArray()]}"
        )
    )


@pytest.mark.slow
def test_the_keys_of_commands_do_not_move_the_camera(page):
    before = look(page)
    page.page.evaluate("() => document.activeElement && document.activeElement.blur()")
    hold(page, "ArrowUp")
    page.await_selection(1)
    hold(page, "t")
    page.page.wait_for_function(_IS_DARK)
    np.testing.assert_allclose(look(page), before, atol=1e-6)
    hold(page, "t")
    page.page.wait_for_function(f"() => !({_IS_DARK})()")
    np.testing.assert_allclose(look(page), before, atol=1e-6)


@pytest.mark.slow
def test_arrows_on_a_slider_are_the_sliders_alone(page):
    before = look(page)
    slider = page.control("ε_z [mm]").get_by_role("slider")
    slider.focus()
    for _ in range(2):
        slider.press("ArrowUp", delay=150)
        page.page.wait_for_timeout(THROTTLE_MS)
    page.await_result("ε_z 22 mm")
    assert page.selected_rows() == []
    np.testing.assert_allclose(look(page), before, atol=1e-6)


@pytest.mark.slow
def test_the_help_is_one_card_that_fits_and_that_escape_closes(page):
    card = page.page.get_by_role("dialog")
    for n_cards in (1, 0, 1):
        page.hotkey("h")
        page.page.wait_for_function("(n) => document.querySelectorAll('[role=dialog]').length === n", arg=n_cards)
    card.wait_for()
    page.page.wait_for_timeout(300)
    box = card.bounding_box()
    assert box["y"] >= 0.0
    assert box["y"] + box["height"] <= page.page.viewport_size["height"]
    tall, room = card.evaluate("(e) => [e.scrollHeight, e.clientHeight]")
    assert tall <= room
    page.page.keyboard.press("Escape")
    card.wait_for(state="detached")


@pytest.mark.slow
def test_a_number_out_of_range_stays_as_it_was_written_until_it_is_mended(page):
    changes = page.text("changes")
    page.type_number("ε_z [mm]", -5)
    assert "give a value from 1 to 100" in page.await_error()
    box = page.control("ε_z [mm]").locator("xpath=ancestor::*[.//input[contains(@class,'NumberInput-input')]][1]")
    box = box.locator("input.mantine-NumberInput-input").first
    box.blur()
    page.page.wait_for_timeout(4 * THROTTLE_MS)
    assert box.input_value() == "-5"
    assert "got -5" in page.text("error")
    assert page.text("changes") == changes
    page.type_number("ε_z [mm]", 25)
    page.await_result("ε_z 25 mm")


@pytest.mark.slow
def test_a_group_of_buttons_shows_which_is_on(page):
    def color(name):
        # Not that of the toolbar.
        button = page.page.locator(".mantine-Button-root").filter(has_text=re.compile(f"^{name}$")).first
        return button.evaluate("(e) => getComputedStyle(e).backgroundColor")

    page.tab("Look")
    page.is_scene_touched = True
    on, off = color("Segmented"), color("Raw")
    assert on != off
    page.show("Raw")
    page.page.wait_for_function(
        "() => document.querySelector('[data-testid=toolbar] [aria-pressed=true]').innerText === 'Raw'"
    )
    assert (color("Segmented"), color("Raw")) == (off, on)
    # The groups beside it, which have no choice, stay as they are.
    assert {color(name) for name in ("Home", "Front", "Chosen step")} == {off}
    page.tab("Tune")


@pytest.mark.slow
def test_the_notes_are_one_press_away(page):
    link = page.by_id("notes-link")
    assert "note" in link.inner_text()
    click_at_once(link)
    page.page.wait_for_function(
        "() => {const r = document.querySelector('[data-testid=notes]').getBoundingClientRect();"
        "return r.top >= 0 && r.top < innerHeight}"
    )
    assert not [words for words in page.by_id("notes").locator("li").all_inner_texts() if "--" in words]
