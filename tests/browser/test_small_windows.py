"""A tablet and a phone: stair, table and panel fit, and a finger does what a mouse does."""

import pytest

from tests.browser.inspector_page import InspectorPage, click_at_once
from tests.browser.test_docked import places

TABLET = (1024, 768)
PHONE = (390, 844)
_SHEET = '.mantine-Paper-root[style*="width: 20em"]'


def touched(browser, app, size):
    """A page of this size that is touched."""
    width, height = size
    context = browser.new_context(
        viewport={"width": width, "height": height}, has_touch=True, is_mobile=width < 500, device_scale_factor=1
    )
    page = InspectorPage(browser, app.address, context=context)
    page.await_result()
    page.close_notifications()
    return page


def drag(page, start, end):
    """Drag a finger from one place of the window to another."""
    devtools = page.context.new_cdp_session(page.page)

    def tell(kind, *points):
        devtools.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": [{"x": x, "y": y} for x, y in points]})

    tell("touchStart", start)
    for share in (0.25, 0.5, 0.75, 1.0):
        tell("touchMove", tuple(a + share * (b - a) for a, b in zip(start, end, strict=True)))
    tell("touchEnd")


def pull_up(page, by):
    """Pull the upper edge of the table up by so many pixels; return how much higher the table is then."""
    before = places(page)["dock"]
    # In one go: the table is another element after every change.
    x, y = page.page.evaluate(
        "() => { const box = document.querySelector('[data-testid=dock-edge]').getBoundingClientRect();"
        " return [box.left + box.width / 2, box.top + box.height / 2]; }"
    )
    drag(page, (x, y), (x, y - by))
    page.page.wait_for_function(
        "(top) => document.querySelector('[data-testid=dock]').getBoundingClientRect().top !== top", arg=before[1]
    )
    return before[1] - places(page)["dock"][1]


@pytest.mark.slow
def test_a_tablet_has_room_for_all_and_is_used_by_a_finger(browser, app):
    page = touched(browser, app, TABLET)
    try:
        found = places(page)
        assert found["dock"][3] == found["inner"][1] == TABLET[1]
        assert found["dock"][2] <= found["panel"][0]
        assert found["panel"][2] <= TABLET[0]
        wide, room = page.by_id("steps").evaluate("(element) => [element.scrollWidth, element.clientWidth]")
        assert wide <= room
        assert pull_up(page, -80) == pytest.approx(-80, abs=2)
        page.show("Swipe")
        bar = page.by_id("swipe")
        box = bar.bounding_box()
        x, y = box["x"] + box["width"] / 2.0, box["y"] + 200.0
        drag(page, (x, y), (x - 100.0, y))
        page.page.wait_for_function(
            "(x) => Math.abs(document.querySelector('[data-testid=swipe]').getBoundingClientRect().left - x) < 3",
            arg=box["x"] - 100.0,
        )
        assert page.problems == []
    finally:
        page.close()


@pytest.mark.slow
def test_a_drag_of_the_tables_edge_goes_on_while_the_table_is_another_one(browser, app):
    page = touched(browser, app, PHONE)
    try:
        before = places(page)["dock"][1]
        edge = page.by_id("dock-edge")
        box = edge.bounding_box()
        x, y = box["x"] + box["width"] / 2.0, box["y"] + box["height"] / 2.0
        devtools = page.context.new_cdp_session(page.page)

        def tell(kind, *points):
            devtools.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": [{"x": x, "y": y} for y in points]})

        old = edge.element_handle()
        tell("touchStart", y)
        tell("touchMove", y + 10.0)
        # As when a row was tapped just before.
        click_at_once(page.by_id("step-row").first)
        page.await_selection(1)
        page.page.wait_for_function("(edge) => !edge.isConnected", arg=old)
        tell("touchMove", y + 30.0)
        tell("touchMove", y + 60.0)
        tell("touchEnd")
        page.page.wait_for_function(
            "(top) => Math.abs(document.querySelector('[data-testid=dock]').getBoundingClientRect().top - top) < 3",
            arg=before + 60.0,
        )
    finally:
        page.close()


@pytest.mark.slow
def test_a_phone_shows_the_stair_and_the_table_one_above_the_other(browser, app):
    page = touched(browser, app, PHONE)
    try:
        sheet = page.page.locator(_SHEET)
        # A line at the foot, until it is opened.
        page.page.wait_for_function(f"() => document.querySelector('{_SHEET}').offsetHeight < 80")
        found = places(page)
        assert found["canvas"][:3] == pytest.approx([0.0, 0.0, PHONE[0]], abs=1.0)
        assert found["canvas"][3] > 0.5 * PHONE[1]
        assert page.page.evaluate("() => document.documentElement.scrollWidth") <= PHONE[0]
        sheet.get_by_text("stair_inspector", exact=True).tap()
        page.page.wait_for_function(f"() => document.querySelector('{_SHEET}').offsetHeight > 200")
        page.page.wait_for_function(
            "() => Math.abs(document.querySelector('[data-testid=dock]').getBoundingClientRect().bottom"
            f" - document.querySelector('{_SHEET}').getBoundingClientRect().top) < 2"
        )
        found = places(page)
        assert found["canvas"][3] > 0.2 * PHONE[1], "the stair is still in view"
        assert page.by_id("step-row").first.is_visible()
        assert page.page.get_by_role("tab", name="Tune", exact=True).is_visible()
        page.by_id("step-row").nth(1).tap()
        page.await_selection(2)
        assert page.problems == []
    finally:
        page.close()


def test_the_tables_edge_is_moved_by_keys(page):
    before = places(page)["dock"][1]
    edge = page.by_id("dock-edge")
    edge.focus()
    edge.press("ArrowDown")
    page.page.wait_for_function(
        "(top) => Math.abs(document.querySelector('[data-testid=dock]').getBoundingClientRect().top - top - 24) < 2",
        arg=before,
    )
    edge.press("ArrowUp")
    page.page.wait_for_function(
        "(top) => Math.abs(document.querySelector('[data-testid=dock]').getBoundingClientRect().top - top) < 2",
        arg=before,
    )
    assert int(edge.get_attribute("aria-valuenow")) > 10
    page.page.evaluate("() => document.documentElement.style.removeProperty('--si-dock-most')")
