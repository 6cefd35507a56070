"""The Findings tab in a browser: a pin is set, marked as done, and seen in the list and in the scene."""

from tests.browser.inspector_page import THROTTLE_MS
from tests.browser.test_workspace import button


def lines_of(page, label):
    """The field for several lines of a text control."""
    name = page.page.get_by_text(label, exact=True).and_(page.page.locator("label")).first
    return name.locator("xpath=ancestor::*[.//textarea][1]").locator("textarea").first


def row(page, words):
    return page.by_id("finding-row").filter(has_text=words)


def test_a_pin_is_set_marked_as_done_and_seen_in_the_list(page):
    page.click_row(3)
    page.await_selection(3)
    page.tab("Findings")
    page.by_id("finding-chosen").filter(has_text="step 3").wait_for()
    lines_of(page, "Words").fill("loose <b>nosing</b>")
    page.page.wait_for_timeout(THROTTLE_MS)
    button(page, "Set the pin").click()
    pin = row(page, "loose <b>nosing</b>")
    pin.wait_for()
    assert (pin.get_attribute("data-kind"), pin.get_attribute("data-state")) == ("pin", "open")
    page.await_node("/stair/findings/points")
    pin.get_by_role("button", name="mark as done finding 1").click()
    pin.wait_for(state="detached")
    button(page, "All").click()
    pin.wait_for()
    assert pin.get_attribute("data-state") == "done"
    pin.get_by_role("button", name="delete finding 1").click()
    pin.wait_for(state="detached")
    button(page, "Open").click()
