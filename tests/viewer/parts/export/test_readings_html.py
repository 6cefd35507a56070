"""Readings by hand as the page lists them: beside the scan's value, with their difference, and never as markup."""

import pytest

from stair_inspector.content.fields import ReportBasis
from stair_inspector.content.readings import TapeReading
from stair_inspector.viewer.bridge.markup import list_key, pick_script
from stair_inspector.viewer.parts.export.readings_html import readings_html
from tests.codes.flights import even, inspection_of
from tests.viewer.parts.test_html import Page

INSPECTION = inspection_of(even(4, 0.0004))
HOSTILE = "<img src=x onerror=1>"


def test_without_a_reading_it_says_what_readings_are_for():
    for inspection in (INSPECTION, None):
        assert "No reading yet" in Page(readings_html(inspection, ReportBasis(), "abc")).words


def test_readings_without_a_result_are_said_to_be_kept():
    one = TapeReading("rise", 0.17, 1)
    for readings, words in (((one,), "1 reading is kept"), ((one, one, one), "3 readings are kept")):
        page = Page(readings_html(None, ReportBasis(readings=readings), "abc"))
        assert words in page.words
        assert "No reading" not in page.words


BASIS = ReportBasis(
    readings=(
        TapeReading("rise", 0.1665, step=2, u=0.001, note=HOSTILE),
        TapeReading("going", 0.30, step=1),
        TapeReading("fall", -0.3, step=2, u=1.0),
        TapeReading("rise", 0.1665, step=99),
    )
)


def rows_of(page):
    return [[" ".join(cell.split()) for cell in row] for row in page.rows if row]


@pytest.mark.parametrize(
    ("unit", "rows"),
    [
        (
            "mm",
            [
                ["step 2 rise", "166.5 mm ± 1.0", "165.0 mm ± 0.4", "+1.5 mm"],
                ["step 1 going", "300.0 mm U not stated", "290.0 mm ± 0.4", "+10.0 mm"],
                ["step 2 fall to the nosing", "-0.30° ± 1.0", "0.00° ± 0.01", "−0.30°"],
                ["step 99 rise", "166.5 mm U not stated", "–", "–"],
            ],
        ),
        (
            "in",
            [
                ["step 2 rise", "6 9/16 in ± 0.039", "6 1/2 in ± 0.016", "+0.059 in"],
                ["step 1 going", "11 13/16 in U not stated", "11 7/16 in ± 0.016", "+0.394 in"],
                ["step 2 fall to the nosing", "-0.30° ± 1.0", "0.00° ± 0.01", "−0.30°"],
                ["step 99 rise", "6 9/16 in U not stated", "–", "–"],
            ],
        ),
    ],
)
def test_each_reading_stands_beside_the_scans_value_in_the_pages_unit(unit, rows):
    page = Page(readings_html(INSPECTION, BASIS, "the-control", unit))
    assert page.of("img") == []
    found = rows_of(page)
    assert [row[:4] for row in found[::2]] == rows
    assert [row[0].split(" <")[0] for row in found[1::2]] == [
        "✗ differs by more than U",
        "– U of the reading not stated",
        "✓ agrees",
        "– not in the scan",
    ]
    assert HOSTILE in found[1][0]


def test_each_button_deletes_its_row_of_the_list_that_is_shown():
    scripts = [button["onclick"] for button in Page(readings_html(INSPECTION, BASIS, "the-control")).of("button")]
    key = list_key(BASIS.readings)
    assert scripts == [pick_script("the-control", number, f"delete {key}") for number in (1, 2, 3, 4)]


def test_a_list_from_which_one_of_two_equal_readings_is_gone_is_another_list():
    one, other = TapeReading("rise", 0.17, 1), TapeReading("rise", 0.171, 1)
    keys = {list_key(readings) for readings in ((one,), (one, one), (one, other), (other, one), (other,), ())}
    assert len(keys) == 6
