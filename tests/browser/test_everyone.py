"""The page for those who listen to it, who use it by keys, and who need dark and large enough letters."""

import pytest

from stair_inspector.files.palettes import read_palette
from stair_inspector.viewer.bridge.tour import STOPS
from tests.browser.inspector_page import THROTTLE_MS, share_of
from tests.browser.test_findings import lines_of
from tests.browser.test_layout import TABS

_GRAVE = ("serious", "critical")
_OPEN_FOLDERS = """() => document.querySelectorAll('.mantine-Paper-root[role=button][aria-expanded=false]')
    .forEach((head) => head.checkVisibility() && head.click())"""
_NAMED = """() => ![...document.querySelectorAll('[role=slider], input.mantine-NumberInput-input')]
    .some((each) => each.checkVisibility() && !each.ariaLabel && !each.labels?.length)"""
_SMALLEST_TEXT = """() => {
    const sizes = [];
    const walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    while (walk.nextNode()) {
        const of = walk.currentNode.parentElement;
        if (!walk.currentNode.textContent.trim() || of.closest('script, style') || !of.checkVisibility()) continue;
        const scale = of.ownerSVGElement ? of.getScreenCTM().a : 1;
        sizes.push([scale * parseFloat(getComputedStyle(of).fontSize), walk.currentNode.textContent.trim()]);
    }
    return sizes.sort((a, b) => a[0] - b[0])[0];
}"""

SAID_TWICE = """() => {
    const seen = new Map(), walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    while (walk.nextNode()) {
        const of = walk.currentNode.parentElement, words = walk.currentNode.textContent.trim();
        if (words.length < 40 || of.closest('script, style, [data-testid=notes]') || !of.checkVisibility()) continue;
        seen.set(words, (seen.get(words) ?? 0) + 1);
    }
    return [...seen].filter(([, count]) => count > 1).map(([words]) => words);
}"""
"""Sentences that are on the page more than once, but for the notes: their folder is open only for who asks for it."""


def faults(page):
    """What axe-core finds on the page that keeps somebody from using it."""
    from axe_playwright_python.sync_playwright import Axe

    page.page.wait_for_function(_NAMED)
    found = Axe().run(page.page, options={"resultTypes": ["violations"]}).response["violations"]
    return [
        (fault["id"], node["html"][:120], [each["message"] for each in node["any"]])
        for fault in found
        if fault["impact"] in _GRAVE
        for node in fault["nodes"]
    ]


def test_nothing_on_the_tune_tab_keeps_anybody_out(page):
    page.tab("Tune")
    assert faults(page) == []
    size, words = page.page.evaluate(_SMALLEST_TEXT)
    assert size >= 10.99, words
    slider = page.page.get_by_role("slider", name="ε_z [mm]", exact=True)
    assert slider.get_attribute("aria-valuenow") == "20"
    assert page.page.get_by_label("ε_z [mm], as a number", exact=True).input_value() == "20"


@pytest.mark.slow
@pytest.mark.parametrize("is_dark", [False, True])
def test_nothing_on_any_tab_keeps_anybody_out(open_page, is_dark):
    page = open_page()
    if is_dark:
        page.set_dark(True)
    # A finding to be listed, with its buttons.
    page.click_row(3)
    page.await_selection(3)
    page.tab("Findings")
    lines_of(page, "Words").fill("The nosing is loose.")
    page.page.wait_for_timeout(THROTTLE_MS)
    page.page.get_by_role("button", name="Set the pin", exact=True).and_(page.page.locator("button")).click()
    page.by_id("finding-row").first.wait_for()
    for tab in TABS:
        page.tab(tab)
        # Folders lie in folders.
        for _ in range(2):
            page.page.evaluate(_OPEN_FOLDERS)
            page.page.wait_for_timeout(500)
        assert faults(page) == [], tab
        size, words = page.page.evaluate(_SMALLEST_TEXT)
        assert size >= 10.99, (tab, words)
        assert page.page.evaluate(SAID_TWICE) == [], tab
    page.hotkey("h")
    page.by_id("help").wait_for()
    # The card comes in by and by: until then its letters are pale.
    page.page.wait_for_timeout(800)
    assert faults(page) == []


def test_a_folder_is_opened_by_key(page):
    page.tab("Tune")
    head = page.page.get_by_role("button", name="Survey", exact=True).and_(page.page.locator(".mantine-Paper-root"))
    before = head.get_attribute("aria-expanded")
    for wanted in ("true", "false") if before == "false" else ("false", "true"):
        head.focus()
        head.press("Enter")
        page.page.wait_for_function(
            "(wanted) => [...document.querySelectorAll('.mantine-Paper-root[role=button]')]"
            ".find((head) => head.textContent === 'Survey').ariaExpanded === wanted",
            arg=wanted,
        )


@pytest.mark.slow
def test_colours_that_every_eye_tells_apart_are_chosen_on_the_scan_tab(page):
    colors = read_palette("distinct").steps[:3]
    page.tab("Scan")
    page.choose("Colours of steps", "distinct")
    try:
        page.page.wait_for_function(
            "(color) => document.querySelector('[data-testid=legend]').innerHTML.includes(color)", arg=f"rgb{colors[0]}"
        )
        page.page.wait_for_function(
            "(color) => document.querySelector('[data-testid=steps]').innerHTML.includes(color)", arg=f"rgb{colors[0]}"
        )
        picture = page.still_picture()
        assert min(share_of(color, picture) for color in colors) > 0.001
    finally:
        page.choose("Colours of steps", "the page's")
    page.tab("Tune")


_COVERED = """() => {
    const card = document.querySelector('[data-testid=tour]').getBoundingClientRect();
    const of = [...document.querySelectorAll('*')].find((each) => each.style?.outline.startsWith('3px'));
    const box = of.getBoundingClientRect();
    const isBeside = card.right <= box.left || box.right <= card.left;
    const isApart = isBeside || card.bottom <= box.top || box.bottom <= card.top;
    const isIn = card.left >= 0 && card.top >= 0 && card.right <= innerWidth && card.bottom <= innerHeight;
    return !isApart || !isIn;
}"""
"""Whether the card of the tour covers what it speaks of, or reaches out of the window."""


@pytest.mark.slow
def test_the_tour_is_for_the_first_opening_goes_by_keys_and_covers_nothing_that_it_speaks_of(open_page):
    page = open_page(has_tour=True)
    card = page.by_id("tour")
    card.wait_for()
    assert faults(page) == []
    # Other tabs were opened meanwhile, as tests do first.
    card.get_by_role("button", name="Next").focus()
    for number in range(1, len(STOPS) + 1):
        assert f"{number} of {len(STOPS)}" in card.inner_text()
        assert not page.page.evaluate(_COVERED), number
        page.page.keyboard.press("Enter")
    card.wait_for(state="detached")
    page.page.reload()
    page.await_result()
    page.page.wait_for_function("() => window.__stairInspectorTour")
    page.hotkey("h")
    # By now it would have begun: the card of help stands over the page.
    page.by_id("tour-again").wait_for()
    assert card.count() == 0
    page.by_id("tour-again").click()
    card.wait_for()
    page.by_id("help").wait_for(state="detached")
    page.page.keyboard.press("Escape")
    card.wait_for(state="detached")
