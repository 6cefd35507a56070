"""Make the README's picture of the page: ``python -m tests.browser.pictures``."""

import sys
from pathlib import Path

from playwright.sync_api import sync_playwright

from stair_inspector.files.paths import sample_scans
from stair_inspector.files.settings import find_preset
from stair_inspector.viewer.app import App
from tests.browser.inspector_page import ARGUMENTS, find_browser

IMAGES = Path(__file__).parents[2] / ".github" / "images"


def main() -> None:
    """Photograph the page on the sample scan, both clouds side by side, one step chosen."""
    app = App([sample_scans() / "straight.ply"], find_preset("tls").params, port=0)
    try:
        with sync_playwright() as playwright:
            browser = playwright.chromium.launch(executable_path=find_browser(), args=list(ARGUMENTS))
            page = browser.new_page(viewport={"width": 1500, "height": 980})
            page.goto(f"http://127.0.0.1:{app.port}/?fixedDpr=1")
            page.wait_for_selector('[data-testid="step-row"]', timeout=90_000)
            # The notice about software rendering, which no inspector's machine shows.
            for close in page.locator(".mantine-Notification-root button").all():
                close.click()
            page.get_by_role("button", name="Side by side").click()
            page.locator('[data-testid="step-row"][data-step="4"]').click()
            page.wait_for_selector('[data-testid="step-row"][data-step="4"][aria-selected="true"]')
            page.mouse.move(500, 700)
            page.wait_for_timeout(8000)
            page.screenshot(path=IMAGES / "page.png")
            browser.close()
    finally:
        app.stop()


if __name__ == "__main__":
    sys.exit(main())
