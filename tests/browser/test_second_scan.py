"""Two simulated scans of one stair on the page: what was changed is shown as changed, and nothing else."""

from dataclasses import replace

import numpy as np
import pytest

from stair_inspector.files.simulations import simulate_to_file
from stair_inspector.params import Params
from stair_inspector.pictures.ramps import color_signed
from stair_inspector.simulation.specs import Stair
from stair_inspector.viewer.app import App
from tests.benchmarks.epochs import FIRST, SCANNERS, SECOND
from tests.browser.inspector_page import share_of
from tests.browser.test_everyone import SAID_TWICE, faults
from tests.browser.test_workspace import button

WORN, TURNED, SETTLED, LAST = 2, 7, 5, 7
BUILT = Stair(n_risers=9, landing_after=4, floor_front_m=1.2, floor_width_m=1.4, upper_landing_m=0.6)
CHANGED = replace(
    BUILT, wear_errors_m=f"{WORN}:0.003", cross_fall_errors_deg=f"{TURNED}:1", rise_errors_m=f"{SETTLED}:-0.004"
)
FOUND = {
    ("rise", WORN),
    ("rise", WORN + 1),
    ("rise", SETTLED),
    ("cross_fall", TURNED),
    *(("height", step) for step in range(SETTLED, LAST + 1)),
    # The line from one nosing to the next, where one of the two has moved.
    ("pitch", WORN - 1),
    ("pitch", WORN),
}
_CHANGED_CELLS = """() => [...document.querySelectorAll('[data-testid=changes-table] td[data-changed=true]')]
    .map((cell) => [cell.dataset.quantity, Number(cell.closest('tr').dataset.step)])"""


@pytest.fixture(scope="module")
def epochs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("epochs")
    scanner = replace(SCANNERS["noise of 1 mm"], max_points=40_000)
    for name, stair, seed, stands in (("after.ply", CHANGED, 2, SECOND), ("before.ply", BUILT, 1, FIRST)):
        turned = replace(stair, yaw_deg=30.0 * seed)
        simulate_to_file(folder / name, turned, replace(scanner, seed=seed, **stands))
    return [folder / "after.ply", folder / "before.ply"]


@pytest.mark.slow
def test_what_changed_between_two_scans_is_shown_and_nothing_else(epochs, open_page):
    app = App(epochs, Params(), port=0, saves_projects=False)
    try:
        page = open_page(address=app.address)
        page.tab("Compare")
        page.choose("Second scan", "before.ply")
        page.by_id("changes-table").wait_for()
        found = {(quantity, step) for quantity, step in page.page.evaluate(_CHANGED_CELLS)}
        assert found == FOUND
        notes = page.text("change-notes")
        assert f"steps {SETTLED} to {LAST} lie 4.0 ± " in notes
        assert f"step {TURNED}: cross fall changed by 1.00 ± " in notes
        assert f"step {WORN}: along its nosing " in notes
        assert "Laid onto each other on the floor and steps 1 to 4; U of a height by that ≤ " in page.text("alignment")
        legend = page.by_id("overlay").locator("[data-testid=color-legend]").inner_text()
        assert "later surface against the earlier one [mm]" in legend
        assert "−5" in legend
        # A row chooses its step, whose map is shown.
        page.page.locator(f"[data-testid=change-row][data-step='{WORN}']").click()
        page.await_selection(WORN)
        words = page.by_id("change-map").inner_text()
        assert words.startswith(f"step {WORN}: ")
        assert "the outlined place lies −2.9 ± " in words
        assert faults(page) == []
        assert page.page.evaluate(SAID_TWICE) == []
        button(page, "All steps").click()
        page.page.wait_for_function(
            "(count) => document.querySelectorAll('[data-testid=change-map] img').length === count", arg=LAST
        )
        # The upper flight is blue in the scene, by as much as its legend says.
        page.is_scene_touched = True
        lower = color_signed(np.array([-0.004]), 0.005)[0]
        page.show("Top")
        picture = page.still_picture()
        assert share_of(lower, picture, 16) > 0.002
        button(page, "End the comparison").click()
        page.by_id("changes-table").wait_for(state="detached")
        assert share_of(lower, page.still_picture(unlike=picture), 16) < 0.0005
    finally:
        app.stop()
