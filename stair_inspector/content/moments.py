"""Dates and times are free text in a report; one that looks like a date and is none is worth a remark."""

import datetime
import re

from stair_inspector.content.fields import TextKind

_YEAR_FIRST = re.compile(r"(?P<year>[0-9]{4})[-./](?P<a>[0-9]{1,2})[-./](?P<b>[0-9]{1,2})")
_YEAR_LAST = re.compile(r"(?P<a>[0-9]{1,2})[-./](?P<b>[0-9]{1,2})[-./](?P<year>[0-9]{4})")
_CLOCK = re.compile(r"(?P<hour>[0-9]{1,2}):(?P<minute>[0-9]{2})(?::(?P<second>[0-9]{2}))?")


def odd_moment(kind: TextKind, text: str) -> str:
    """Return a sentence where the text of a date's or time's field looks like one and is none, else nothing."""
    if kind == "date" and _is_impossible_date(text):
        return f"{text!r} is no day of the calendar; it stays as it is written."
    if kind == "time" and _is_impossible_time(text):
        return f"{text!r} is no time of a day; it stays as it is written."
    return ""


def _is_impossible_date(text: str) -> bool:
    first, last = _YEAR_FIRST.fullmatch(text), _YEAR_LAST.fullmatch(text)
    found = first or last
    if found is None:
        return False
    year, a, b = (int(found[part]) for part in ("year", "a", "b"))
    # With the year last, some write the day before the month and some after it.
    return not (_is_day(year, a, b) or (last is not None and _is_day(year, b, a)))


def _is_day(year: int, month: int, day: int) -> bool:
    try:
        datetime.date(year, month, day)
    except ValueError:
        return False
    return True


def _is_impossible_time(text: str) -> bool:
    found = _CLOCK.fullmatch(text)
    if found is None:
        return False
    return int(found["hour"]) > 23 or int(found["minute"]) > 59 or int(found["second"] or 0) > 59
