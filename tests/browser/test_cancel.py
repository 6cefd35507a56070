"""What takes long says so, and can be stopped: the page goes on with what it had."""

import pytest

from stair_inspector.files.simulations import simulate_to_file
from stair_inspector.params import Params
from stair_inspector.simulation.scanner_specs import Scanner
from stair_inspector.simulation.specs import Stair
from stair_inspector.viewer.app import App
from tests.browser.inspector_page import click_at_once

pytestmark = pytest.mark.slow


def test_a_long_run_is_cancelled_and_run_again(browser, tmp_path, scans, open_page):
    scanner = Scanner(max_points=400_000, azimuth_step_deg=0.06, elevation_step_deg=0.06, spacing_m=0.002)
    simulate_to_file(tmp_path / "large.ply", Stair(n_risers=10), scanner)
    app = App([scans[0], tmp_path / "large.ply"], Params(), port=0, saves_projects=False)
    try:
        page = open_page(address=app.address)
        page.hotkey("Control+z")
        page.await_notification("there is nothing to undo")
        page.tab("Scan")
        page.open_scan("large.ply")
        page.page.get_by_role("progressbar").wait_for()
        assert "…" in page.text("state")
        click_at_once(page.page.get_by_role("button", name="Cancel", exact=True))
        assert "cancelled before anything was measured" in page.await_error()
        # What is named is what is open, and nothing of it has been measured.
        assert page.text("scan").startswith("large.ply")
        assert page.survey_table() == []
        page.page.get_by_role("button", name="Run again").click()
        page.by_id("used").wait_for(state="attached", timeout=120_000)
        page.await_result()
        assert len(page.survey_table()) == 10
    finally:
        app.stop()
