"""What an inspector sees: the scene, its three modes, its cameras, the chosen step, light and dark."""

import numpy as np
import pytest

from stair_inspector.files.palettes import read_palette
from stair_inspector.pictures.segmentation import ground_of
from tests.browser.inspector_page import VIEW_PANEL, share_changed, share_of

PALETTE = read_palette("page")


def test_the_steps_are_drawn_in_the_palettes_colours(page):
    picture = page.still_picture()
    shares = [share_of(color, picture) for color in PALETTE.steps[:5]]
    assert min(shares) > 0.001
    assert share_of(PALETTE.floor, picture) > 0.02
    # A line's own colour is mixed with what lies under its rims.
    assert share_of(PALETTE.front_edge, picture, within=30) > 0.0005


@pytest.mark.slow
def test_raw_segmented_and_side_by_side_are_three_pictures(page):
    segmented = page.still_picture()
    page.show("Raw")
    raw = page.still_picture(unlike=segmented)
    page.show("Side by side")
    both = page.still_picture(unlike=raw)
    assert share_changed(segmented, raw) > 0.02
    assert share_changed(raw, both) > 0.02
    assert share_changed(segmented, both) > 0.02
    # Only the segmentation has the steps' colours; side by side it is smaller.
    shares = [share_of(PALETTE.steps[0], picture) for picture in (raw, both, segmented)]
    assert shares[0] < 0.0005 < shares[1] < shares[2]


def lies_inside(picture):
    """Whether something is drawn, and nothing at the border; the background is that of the lower left corner."""
    drawn = np.abs(picture - picture[-1, 0]).max(axis=2) > 24
    drawn[: VIEW_PANEL[0], : VIEW_PANEL[1]] = False
    border = np.concatenate([drawn[:3].ravel(), drawn[-3:].ravel(), drawn[:, :3].ravel(), drawn[:, -3:].ravel()])
    return bool(drawn.any() and not border.any())


@pytest.mark.slow
def test_the_camera_buttons_are_four_views_with_the_whole_staircase_inside(page):
    first = page.still_picture()
    assert lies_inside(first)
    pictures = {}
    for view, before in (("Top", None), ("Home", "Top"), ("Front", "Home"), ("Side", "Front")):
        page.show(view)
        pictures[view] = page.still_picture(unlike=first if before is None else pictures[before])
        assert before is None or share_changed(pictures[before], pictures[view]) > 0.02, view
        assert lies_inside(pictures[view]), view
    # The page begins with the view that Home shows, and Home is the same from wherever one comes.
    page.show("Home")
    page.await_camera(page.home)
    # Between two frames of a busy machine a picture may seem still before it is.
    assert any(share_changed(pictures["Home"], page.still_picture()) < 0.002 for _ in range(5))


@pytest.mark.slow
def test_a_window_of_another_shape_shows_the_whole_staircase_all_the_same(page):
    try:
        page.page.set_viewport_size({"width": 800, "height": 720})
        page.page.wait_for_function(
            "(home) => Math.abs(window.__viserMutable.camera.position.z - home) > 0.05", arg=page.home[2]
        )
        # The window tells its shape more than once on its way to the new one.
        assert any(lies_inside(page.still_picture()) for _ in range(5))
    finally:
        page.page.set_viewport_size({"width": 1280, "height": 720})
    page.await_camera(page.home)


@pytest.mark.slow
def test_a_click_on_a_row_selects_the_step_and_a_second_click_puts_it_away(page):
    plain = page.still_picture()
    page.click_row(2)
    page.await_selection(2)
    page.await_node("/stair/segments/selected")
    assert page.page.get_by_label("Selected step").first.input_value() == "2"
    picture = page.still_picture(unlike=plain)
    assert share_of(ground_of(PALETTE), picture) > 0.002
    # The outline: no other bright colour has so little red, and the browser makes a line's colour paler.
    red, green, blue = np.moveaxis(picture, 2, 0)
    assert ((np.minimum(green, blue) > 195) & (green - red > 80)).mean() > 0.001
    page.click_row(4)
    page.await_selection(4)
    page.click_row(4)
    page.await_selection()
    page.await_node("/stair/segments/selected", there=False)
    assert page.page.get_by_label("Selected step").first.input_value() == "none"


@pytest.mark.slow
def test_the_menu_selects_a_row(page):
    page.tab("Steps")
    page.choose("Selected step", "3")
    page.await_selection(3)
    page.await_node("/stair/segments/outline")
    page.choose("Selected step", "none")
    page.await_selection()


def test_a_click_on_a_tread_selects_its_row(page):
    home = page.still_picture()
    page.show("Top")
    picture = page.still_picture(unlike=home)
    # The middle of what is drawn in the colour of step 2, away from its black centre points.
    rows, columns = np.nonzero(np.abs(picture - np.array(PALETTE.of_step(2))).max(axis=2) <= 6)
    middle = np.argmin(np.hypot(rows - np.median(rows), columns - np.quantile(columns, 0.25)))
    page.canvas.click(position={"x": float(columns[middle]), "y": float(rows[middle])})
    page.await_selection(2)


@pytest.mark.slow
def test_the_selection_survives_a_slider_and_goes_when_its_step_goes(page):
    page.click_row(5)
    page.await_selection(5)
    page.press("paper's α_f [%]", "ArrowLeft")
    page.await_result("α 94.5/5 %")
    page.await_selection(5)
    page.press("m", "End")
    page.await_result("m 5000")
    page.await_selection()
    page.await_node("/stair/segments/selected", there=False)


@pytest.mark.slow
def test_the_dark_theme_is_dark(page):
    def background():
        # Looked for at once: the table takes its place anew with every change.
        return page.page.evaluate(
            "() => { for (let e = document.querySelector('[data-testid=steps]'); e; e = e.parentElement) {"
            " const color = getComputedStyle(e).backgroundColor;"
            " if (color !== 'rgba(0, 0, 0, 0)') return Math.max(...color.match(/\\d+/g).slice(0, 3).map(Number)); }"
            " return 255; }"
        )

    assert background() > 220
    light = page.still_picture()
    page.set_dark(True)
    assert background() < 80
    dark = page.still_picture(unlike=light)
    assert light[-5, 5].min() > 220
    assert dark[-5, 5].max() < 80


@pytest.mark.parametrize("size", [None, pytest.param((2560, 1440), marks=pytest.mark.slow)])
def test_nothing_overflows(page, open_page, size):
    if size is not None:
        page = open_page(width=size[0], height=size[1])
    page.tab("Steps")
    for name in ("steps", "details", "legend", "status", "scan"):
        wide, room = page.by_id(name).evaluate("(element) => [element.scrollWidth, element.clientWidth]")
        assert wide <= room, name
    width = page.page.viewport_size["width"]
    box = page.by_id("steps").bounding_box()
    assert box["x"] >= 0
    assert box["x"] + box["width"] <= width
    assert page.page.evaluate("() => document.documentElement.scrollWidth") <= width


@pytest.mark.slow
def test_the_view_panel_covers_no_control(page):
    boxes = [page.page.get_by_role("button", name=name, exact=True).bounding_box() for name in ("Raw", "Top")]
    panel = page.by_id("scan").bounding_box()
    assert all(box["x"] + box["width"] < panel["x"] for box in boxes)
