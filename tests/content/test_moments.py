"""A text that looks like a date or a time and is none is remarked on; whatever else is free text."""

import pytest

from stair_inspector.content.fields import ReportFields
from stair_inspector.content.moments import odd_moment


@pytest.mark.parametrize(
    "text", ["2026-13-40", "2026-02-30", "0000-01-01", "32.13.2026", "31.02.2026", "13/13/2026", "2026/00/10"]
)
def test_a_date_that_is_no_day_is_remarked_on(text):
    assert odd_moment("date", text) == f"'{text}' is no day of the calendar; it stays as it is written."


@pytest.mark.parametrize(
    "text",
    ["", "2026-11-22", "2024-02-29", "22.11.2026", "11/22/2026", "22 November 2026", "about 1987", "2026-13", "1.2.26"],
)
def test_a_date_or_free_text_is_not(text):
    assert not odd_moment("date", text)


def test_a_time_is_one_of_a_day():
    assert odd_moment("time", "25:99") == "'25:99' is no time of a day; it stays as it is written."
    assert odd_moment("time", "09:30:75")
    for text in ("23:59", "9:30", "09:30:00", "9 to 11 a.m.", ""):
        assert not odd_moment("time", text)


def test_only_dates_and_times_are_looked_at():
    assert [
        name for name in ReportFields.__dataclass_fields__ if odd_moment(ReportFields.kind_of(name), "2026-13-40")
    ] == [
        "survey_date",
        "build_date",
        "calibration_date",
        "interim_check_date",
        "signed_on",
        "reviewed_on",
    ]
