"""The table of steps below the scene: in view whatever is done, and what can be done in it."""

import pytest

from tests.browser.inspector_page import click_at_once

_PLACES = """() => {
    const box = (e) => { const r = e.getBoundingClientRect(); return [r.left, r.top, r.right, r.bottom]; };
    const of = (name) => document.querySelector(`[data-testid=${name}]`);
    return {canvas: box(document.querySelector('canvas[data-engine]')), dock: box(of('dock')),
            legend: box(of('overlay')), panel: box(of('scan')), inner: [innerWidth, innerHeight]};
}"""
_SIZES = """() => {
    const tall = (name) => document.querySelector(`[data-testid=steps-table] ${name}`).offsetHeight;
    const room = parseFloat(getComputedStyle(document.querySelector('[data-testid=dock-body]')).maxHeight);
    return [room, tall('thead'), tall('[data-testid=flight-row]'), tall('[data-testid=step-row]')];
}"""


_WRITE_DOWN = """() => {
    const seen = new Set();
    const look = () => document.querySelectorAll('td[data-since]').forEach((e) => {
        if (Number(e.dataset.since) > 0) seen.add(`${e.parentElement.dataset.step} ${e.cellIndex}`);
    });
    const watch = new MutationObserver(look);
    watch.observe(document.body, {childList: true});
    window.__marks = {seen, stop: () => watch.disconnect()};
}"""


def places(page):
    """Where the scene, the table, the legend and the panel are, once the scene ends where the table begins."""
    page.page.wait_for_function(
        "() => Math.abs(document.querySelector('canvas[data-engine]').getBoundingClientRect().bottom"
        " - document.querySelector('[data-testid=dock]').getBoundingClientRect().top) < 2"
    )
    return page.page.evaluate(_PLACES)


def column_names(page):
    return page.page.evaluate("() => [...document.querySelectorAll('th[data-head]')].map((e) => e.dataset.head)")


def test_the_table_stands_below_the_scene_on_every_tab_with_room_for_eight_rows(page):
    for tab in ("Scan", "Tune", "Steps", "Checks", "Findings", "Look", "Compare", "Export"):
        page.tab(tab)
        assert page.by_id("steps-table").is_visible()
    found = places(page)
    left, _, right, bottom = found["dock"]
    assert [left, right] == pytest.approx([found["canvas"][0], found["canvas"][2]], abs=1.0)
    assert bottom == found["inner"][1]
    assert right <= found["panel"][0]
    assert found["legend"][3] <= found["dock"][1]
    # The smallest window that the page is made for.
    assert found["inner"] == [1280, 720]
    room, head, flight, row = page.page.evaluate(_SIZES)
    assert room >= head + flight + 8 * row
    assert {"rise", "going", "rms"} <= set(column_names(page))
    page.tab("Tune")


def test_what_a_slider_changes_is_marked_and_nothing_else(page):
    page.choose_columns("paper")
    before = page.table()
    # Marks last for a moment; each is written down as it appears.
    page.page.evaluate(_WRITE_DOWN)
    page.press("paper's α_f [%]", "ArrowLeft")
    page.await_result("α 94.5/5 %")
    marked = sorted(page.page.evaluate("() => { window.__marks.stop(); return [...window.__marks.seen]; }"))
    after = page.table()
    changed = sorted(
        f"{row[0]} {k}" for was, row in zip(before, after, strict=True) for k in range(1, 8) if row[k] != was[k]
    )
    assert marked == changed
    # d_FB and d_FF hang on the front edge; h, W, points and RMS do not.
    assert {mark.split()[1] for mark in marked} <= {"2", "3", "5"}
    assert "1 2" in marked
    page.choose_columns("survey")


def test_columns_are_chosen_and_rows_sorted_with_the_menu_open_meanwhile(page):
    usual = column_names(page)
    page.by_id("columns").locator("summary").click()
    for name in ("fall", "RMS"):
        page.by_id("columns").get_by_role("menuitemcheckbox", name=name).first.click()
    page.page.wait_for_function(
        "() => !document.querySelector('th[data-head=rms]') && document.querySelector('th[data-head=fall]')"
    )
    assert column_names(page) == [*usual[: usual.index("pitch") + 1], "fall", "coverage"]
    assert page.by_id("columns").get_attribute("open") is not None
    for name in ("fall", "RMS"):
        page.by_id("columns").get_by_role("menuitemcheckbox", name=name).first.click()
    page.page.wait_for_function(
        "() => document.querySelector('th[data-head=rms]') && !document.querySelector('th[data-head=fall]')"
    )
    assert column_names(page) == usual
    page.by_id("columns").locator("summary").click()
    head = page.page.locator("th[data-head=rms]")
    for order in ("descending", "ascending", "none"):
        head.get_by_role("button").click()
        page.page.locator(f"th[data-head=rms][aria-sort={order}]").wait_for()
        shown = [float(cells[6]) for cells in page.table() if len(cells) == 8]
        if order != "none":
            assert shown == sorted(shown, reverse=order == "descending")
    assert [cells[0].split()[0] for cells in page.table() if len(cells) == 8] == ["1", "2", "3", "4", "5"]


@pytest.mark.slow
def test_the_keyboard_stays_on_its_row_and_the_edge_and_the_fold_give_the_scene_room(page):
    row = page.page.locator("[data-testid=step-row][data-step='2']")
    row.focus()
    page.page.keyboard.press("Enter")
    page.await_selection(2)
    assert page.page.evaluate("() => document.activeElement.dataset.step") == "2"
    page.page.keyboard.press("Enter")
    page.await_selection()
    before = places(page)
    edge = page.by_id("dock-edge").bounding_box()
    x, y = edge["x"] + 300, edge["y"] + edge["height"] / 2
    page.page.mouse.move(x, y)
    page.page.mouse.down()
    page.page.mouse.move(x, y + 60, steps=4)
    page.page.mouse.up()
    page.page.wait_for_function(
        "(was) => document.querySelector('canvas[data-engine]').getBoundingClientRect().bottom > was + 30",
        arg=before["canvas"][3],
    )
    lower = places(page)
    assert lower["dock"][1] > before["dock"][1] + 30
    fold = page.by_id("dock-fold")
    click_at_once(fold)
    page.by_id("dock-body").wait_for(state="hidden")
    assert places(page)["canvas"][3] > lower["canvas"][3] + 50
    assert page.by_id("dock-fold").get_attribute("aria-expanded") == "false"
    click_at_once(fold)
    page.by_id("dock-body").wait_for()
    page.page.evaluate("() => document.documentElement.style.removeProperty('--si-dock-most')")
    page.is_scene_touched = True
