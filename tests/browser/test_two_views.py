"""Raw cloud and segmentation seen together: in two halves that turn together, and on the two sides of a bar."""

import numpy as np
import pytest

from stair_inspector.files.palettes import read_palette
from tests.browser.inspector_page import VIEW_PANEL, share_changed, share_of

PALETTE = read_palette("page")
_LEGEND_PX = 80
"""Of the picture's height, at its foot, which has the steps' colours too."""


def halves(picture):
    middle = picture.shape[1] // 2
    return picture[:, :middle], picture[:, -middle:]


def drawn_in(picture):
    """Where something is drawn; the background is that of the lower left corner."""
    drawn = np.abs(picture - picture[-1, 0]).max(axis=2) > 24
    drawn[: VIEW_PANEL[0] + 40] = drawn[-_LEGEND_PX:] = False
    return drawn


def steps_in(picture):
    picture = picture[:-_LEGEND_PX]
    return sum(share_of(color, picture) for color in PALETTE.steps[:5])


@pytest.mark.slow
def test_each_half_holds_its_own_cloud_alone_framed_alike_and_both_turn_together(page):
    page.show("Side by side")
    for view in ("Home", "Top", "Front", "Side"):
        page.show(view)
        left, right = halves(page.still_picture())
        # From the front and from the side hardly anything is seen of the treads.
        assert steps_in(left) < 0.0005
        assert steps_in(right) > (0.01 if view in ("Home", "Top") else steps_in(left))
        # One cloud lies where the other does, half a picture further on; edges and numbers alone differ.
        same = drawn_in(left) == drawn_in(right)
        assert same.mean() > 0.97
        for half in (left, right):
            drawn = drawn_in(half)
            assert drawn.any()
            assert not np.concatenate([drawn[:, :2], drawn[:, -2:]]).any()
    # The numbers of the steps are no part of the raw cloud.
    labels = "(node) => node.children.length && node.children.every((each) => each.renderOrder > 10000)"
    hidden = [
        page.page.evaluate(f"() => window.__stairInspectorViews.hidden({part}).some({labels})") for part in (0, 1)
    ]
    assert hidden == [True, False]
    assert [name.inner_text() for name in page.by_id("view-name").all()] == ["Raw", "Segmented"]
    box = page.canvas.bounding_box()
    for name, start in zip(page.by_id("view-name").all(), (0.0, 0.5), strict=True):
        x = name.bounding_box()["x"] - box["x"]
        assert start * box["width"] <= x < (start + 0.25) * box["width"]


@pytest.mark.slow
def test_what_is_pressed_in_a_half_is_what_is_seen_there(page):
    page.show("Side by side")
    page.show("Top")
    picture = page.still_picture()
    box = page.canvas.bounding_box()
    scale = picture.shape[1] / box["width"]
    middle = picture.shape[1] // 2
    own = np.abs(picture - np.array(PALETTE.steps[2])).max(axis=2) < 10
    own[:, :middle] = False
    y, x = (int(np.median(values)) for values in np.nonzero(own))
    for moved in (0.0, box["width"] / 2.0):
        page.page.mouse.click(box["x"] + x / scale - moved, box["y"] + y / scale)
        page.await_selection(3)
        page.page.keyboard.press("Escape")
        page.await_selection()


@pytest.mark.slow
def test_a_bar_that_is_dragged_or_moved_by_keys_parts_raw_from_segmented(page):
    segmented = steps_in(page.still_picture())
    page.show("Swipe")
    bar = page.by_id("swipe")
    shares = []
    for key, times in (("ArrowRight", 30), ("ArrowLeft", 60)):
        bar.focus()
        for _ in range(times):
            page.page.keyboard.press(key)
        shares.append(steps_in(page.still_picture()))
    # At the right end the picture is raw, at the left end segmented.
    assert shares[0] < 0.0005
    assert shares[1] == pytest.approx(segmented, rel=0.1)
    box, canvas = bar.bounding_box(), page.canvas.bounding_box()
    before = page.still_picture()
    page.page.mouse.move(box["x"] + 8, canvas["y"] + 200)
    page.page.mouse.down()
    page.page.mouse.move(canvas["x"] + canvas["width"] / 2, canvas["y"] + 200, steps=5)
    page.page.mouse.up()
    assert 0.2 * segmented < steps_in(page.still_picture(unlike=before)) < 0.9 * segmented
    page.page.wait_for_function(
        "() => Math.abs(Number(document.querySelector('[data-testid=swipe]').ariaValueNow) - 50) <= 2"
    )
    page.show("Segmented")
    after = page.still_picture()
    assert page.by_id("swipe").count() == 0
    assert steps_in(after) == pytest.approx(segmented, rel=0.05)
    assert share_changed(before, after) < 0.05
