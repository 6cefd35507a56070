"""Do the job from upload to report and make the README's pictures of the page: ``python -m tests.browser.pictures``."""

import sys
from pathlib import Path

from playwright.sync_api import sync_playwright

from stair_inspector.files.paths import sample_scans
from stair_inspector.files.settings import find_preset
from stair_inspector.viewer.app import App
from tests.browser.inspector_page import ARGUMENTS, InspectorPage, find_browser
from tests.browser.job import do_job
from tests.browser.test_checks import label_of

IMAGES = Path(__file__).parents[2] / ".github" / "images"
RULES = "us-ibc-2024"
_AT_REST_MS = 5000
"""Labels are drawn last, and software rendering takes its time."""


def steps(page):
    """Both clouds side by side, one step chosen with its card."""
    page.show("Side by side")
    page.click_row(4)
    page.await_selection(4)
    page.tab("Steps")


def tune(page):
    """The sliders, the histogram and the table below, the dark theme."""
    page.set_dark(True)
    page.show("Segmented")
    page.tab("Tune")


def section(page):
    """A section along the stair with its profile."""
    page.set_dark(False)
    page.tab("Look")
    page.page.get_by_label("Section", exact=True).click()
    page.await_node("/stair/section/cloud")


def main() -> None:
    """Do the job on an uploaded sample, say in how many clicks, and photograph the page."""
    scan = sample_scans() / "straight.ply"
    app = App([sample_scans() / "defective_step.ply"], find_preset("tls").params, port=0, saves_projects=False)
    try:
        with sync_playwright() as playwright:
            browser = playwright.chromium.launch(executable_path=find_browser(), args=list(ARGUMENTS))
            page = InspectorPage(browser, app.address, width=1500, height=980, sharpness=1.0).open()
            # Where a page opens.
            page.tab("Scan")
            done = do_job(page, scan.name, scan.read_bytes(), label_of(RULES))
            print(f"from upload to report: {done.n_clicks} clicks")
            for name, prepare in (("page", steps), ("page_tune", tune), ("page_section", section)):
                prepare(page)
                page.close_notifications()
                page.page.mouse.move(500, 700)
                page.page.wait_for_timeout(_AT_REST_MS)
                page.page.screenshot(path=IMAGES / f"{name}.png")
            page.close()
            browser.close()
    finally:
        app.stop()


if __name__ == "__main__":
    sys.exit(main())
