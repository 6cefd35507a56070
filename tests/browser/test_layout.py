"""Nothing overlaps and nothing overflows, on any tab, in a small window and in a large one, light and dark."""

import pytest

TABS = ("Scan", "Tune", "Steps", "Checks", "Findings", "Look", "Compare", "Export")
_FAULTS = """() => {
    const panel = document.querySelector('[data-testid=scan]').getBoundingClientRect();
    const limit = document.documentElement.clientWidth;
    const faults = [];
    const visible = (e) => e.offsetParent !== null && e.getClientRects().length > 0;
    // What of it is seen in a list that is scrolled.
    const seen = (e) => {
        const box = e.getBoundingClientRect();
        const list = e.closest('[data-testid=scan-list] ul')?.getBoundingClientRect();
        if (!list) return box;
        const top = Math.max(box.top, list.top), bottom = Math.max(top, Math.min(box.bottom, list.bottom));
        return new DOMRect(box.left, top, box.width, bottom - top);
    };
    // What a person presses or reads: each inside the window and inside the panel.
    for (const e of document.querySelectorAll('label, input, button, table, svg, [data-testid]')) {
        if (!visible(e) && !(e instanceof SVGElement)) continue;
        const box = e.getBoundingClientRect();
        if (box.width === 0 || box.height === 0 || box.left < panel.left - 60) continue;
        if (box.right > limit + 1) faults.push(['beyond the window', e.outerHTML.slice(0, 120), box.right]);
    }
    const controls = [...document.querySelectorAll('input, button')].filter((e) => visible(e) && e.type !== 'file')
        .map((e) => [e, seen(e)])
        .filter(([e, box]) => box.left >= panel.left - 10 && box.width > 0 && box.height > 0);
    for (let i = 0; i < controls.length; i++) {
        for (let j = i + 1; j < controls.length; j++) {
            const [a, p] = controls[i], [b, q] = controls[j];
            if (a.contains(b) || b.contains(a)) continue;
            const wide = Math.min(p.right, q.right) - Math.max(p.left, q.left);
            const tall = Math.min(p.bottom, q.bottom) - Math.max(p.top, q.top);
            if (wide > 2 && tall > 2 && !a.closest('.mantine-NumberInput-wrapper')
                && !a.parentElement.contains(b) && !b.parentElement.contains(a))
                faults.push(['overlap', a.outerHTML.slice(0, 90), b.outerHTML.slice(0, 90)]);
        }
    }
    for (const bar of document.querySelectorAll('.mantine-ScrollArea-scrollbar[data-orientation=vertical]')) {
        const q = bar.getBoundingClientRect();
        for (const [a, p] of controls) {
            if (q.width > 0 && p.right > q.left && p.left < q.left && p.bottom > q.top && p.top < q.bottom)
                faults.push(['under the scrollbar', a.outerHTML.slice(0, 90), p.right, q.left]);
        }
    }
    return faults;
}"""

_ONE_OF_EACH = """() => ['toolbar', 'legend'].every(
    (name) => document.querySelectorAll(`[data-testid=${name}]`).length === 1
)"""


def check(page):
    assert page.page.evaluate("() => document.documentElement.scrollWidth") <= page.page.viewport_size["width"]
    for tab in TABS:
        page.tab(tab)
        page.page.wait_for_timeout(60)
        assert page.page.evaluate(_FAULTS) == [], tab
    toolbar, panel = page.by_id("toolbar").bounding_box(), page.by_id("scan").bounding_box()
    legend = page.by_id("overlay").bounding_box()
    assert toolbar["x"] + toolbar["width"] < panel["x"]
    assert legend["x"] + legend["width"] < panel["x"]
    assert toolbar["y"] + toolbar["height"] < legend["y"]
    for name in ("steps", "details", "legend", "status", "scan"):
        wide, room = page.by_id(name).evaluate("(element) => [element.scrollWidth, element.clientWidth]")
        assert wide <= room, name
    page.tab("Tune")


@pytest.mark.slow
def test_nothing_overlaps_in_a_small_window(page):
    page.click_row(3)
    page.await_selection(3)
    check(page)
    page.set_dark(True)
    check(page)


@pytest.mark.slow
def test_nothing_overlaps_in_a_large_window(open_page):
    page = open_page(width=2560, height=1440)
    page.click_row(3)
    page.await_selection(3)
    check(page)


@pytest.mark.slow
def test_inches_fit_as_well(page):
    page.tab("Steps")
    page.show("in")
    page.page.wait_for_function("() => document.querySelector('[data-testid=steps-table]').innerText.includes('/16')")
    try:
        wide, room = page.by_id("steps").evaluate("(element) => [element.scrollWidth, element.clientWidth]")
        assert wide <= room
    finally:
        page.show("mm")


@pytest.mark.slow
def test_the_toolbar_and_the_legend_stay_with_the_scene_when_the_panel_is_folded_away_or_moved(open_page):
    page = open_page()
    collapse = page.page.get_by_label("Collapse panel area")
    collapse.click()
    page.by_id("scan").wait_for(state="detached")
    page.show("Side")
    page.page.wait_for_function(
        "(home) => Math.hypot(...window.__viserMutable.camera.position.toArray().map((v, k) => v - home[k])) > 0.5",
        arg=page.home,
    )
    page.page.wait_for_function(_ONE_OF_EACH)
    page.show("Home")
    page.page.get_by_label("Expand").first.click()
    page.by_id("scan").wait_for()
    page.page.wait_for_function(_ONE_OF_EACH)
    # The panel must have its place again before its handle, in the middle of its upper edge, can be taken.
    page.page.wait_for_function(
        "() => document.querySelector('canvas[data-engine]').getBoundingClientRect().width < innerWidth - 300"
    )
    handle = (page.canvas.bounding_box()["width"] + page.page.viewport_size["width"]) / 2
    page.page.mouse.move(handle, 8)
    page.page.mouse.down()
    page.page.mouse.move(700, 200, steps=8)
    page.page.mouse.move(4, 360, steps=12)
    page.page.wait_for_timeout(300)
    page.page.mouse.up()
    page.page.wait_for_function("() => document.querySelector('canvas[data-engine]').getBoundingClientRect().x > 300")
    page.page.wait_for_function("() => document.querySelector('[data-testid=toolbar]').getBoundingClientRect().x > 300")


def test_notices_leave_the_toolbar_free(page):
    page.tab("Scan")
    page.page.get_by_role("button", name="Look for new scans").click()
    page.page.locator(".mantine-Notification-root").first.wait_for()
    toolbar = page.by_id("toolbar").bounding_box()
    notice = page.page.locator(".mantine-Notification-root").first.bounding_box()
    assert notice["y"] >= toolbar["y"] + toolbar["height"]
