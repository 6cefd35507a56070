"""The whole job in few clicks, on the smallest window that the page is made for."""

import io

import pypdf
import pytest

from stair_inspector.params import Params
from stair_inspector.viewer.app import App
from tests.browser.job import CLIENT, INSPECTOR, do_job
from tests.browser.test_checks import SHARED, label_of

MOST_CLICKS = 12


@pytest.mark.slow
def test_from_an_upload_to_the_report_with_a_name_under_it_in_twelve_clicks(scans, open_page):
    app = App([scans[0]], Params(), port=0, saves_projects=False)
    try:
        page = open_page(address=app.address)
        # Where a page opens.
        page.tab("Scan")
        done = do_job(page, "hall b.ply", scans[1].read_bytes(), label_of(SHARED))
        assert 0 < done.n_clicks <= MOST_CLICKS
        pages = [" ".join(each.extract_text().split()) for each in pypdf.PdfReader(io.BytesIO(done.pdf)).pages]
        said = " ".join(pages)
        for words in ("hall b.ply", CLIENT, INSPECTOR, "Sign-off"):
            assert words in said
        assert len(pages) <= 4
    finally:
        app.stop()
