"""Readings by hand as the page lists them: beside the scan's value, with their difference, and never as markup."""

import io

from PIL import Image

from stair_inspector.report.fields import ReportBasis, TapeReading, read_logo
from stair_inspector.viewer.markup import pick_script
from stair_inspector.viewer.readings_html import logo_html, readings_html
from tests.codes.flights import even, inspection_of
from tests.viewer.test_html import Page

INSPECTION = inspection_of(even(4, 0.0004))
HOSTILE = "<img src=x onerror=1>"


def test_without_a_reading_it_says_what_readings_are_for():
    assert "No reading yet" in Page(readings_html(INSPECTION, ReportBasis(), "abc")).words
    assert (
        "No reading yet" in Page(readings_html(None, ReportBasis(readings=(TapeReading("rise", 0.17, 1),)), "a")).words
    )


def test_each_reading_stands_beside_the_scans_value_with_its_difference_and_can_be_deleted():
    basis = ReportBasis(
        readings=(TapeReading("rise", 0.1665, step=2, u=0.001, note=HOSTILE), TapeReading("going", 0.30, step=1))
    )
    page = Page(readings_html(INSPECTION, basis, "the-control"))
    assert page.of("img") == []
    rows = [[cell.strip() for cell in row[:-1]] for row in page.rows if row]
    assert [row[:6] for row in rows] == [
        ["step 2", "rise", "mm", "166.5", "165.0", "1.5"],
        ["step 1", "going", "mm", "300.0", "290.0", "10.0"],
    ]
    assert all(row[6] for row in rows)
    scripts = [button["onclick"] for button in page.of("button")]
    assert scripts == [pick_script("the-control", number, "delete") for number in (1, 2)]
    assert Page(readings_html(INSPECTION, basis, None)).of("button") == []


def test_the_logo_is_shown_as_the_report_has_it():
    stream = io.BytesIO()
    Image.new("RGB", (30, 10), (1, 2, 3)).save(stream, "JPEG")
    (picture,) = Page(logo_html(read_logo(stream.getvalue()))).of("img")
    assert picture["src"].startswith("data:image/png;base64,")
    assert "No logo" in Page(logo_html(None)).words
