"""Numbers as people type them: the same value whatever letters their fractions and units are made of."""

import pytest

from stair_inspector.files.typed import split_typed


@pytest.mark.parametrize(
    ("typed", "number", "unit"),
    [
        ("7¾ in", "7 3/4", "in"),
        ("½", "1/2", ""),
        ("7 3⁄4", "7 3/4", ""),
        ("180 mm", "180", "mm"),
        ("7″", "7", "in"),
        ("6 11/16''", "6 11/16", "in"),
        ("6 11/16’’", "6 11/16", "in"),
        ("7 INCHES", "7", "in"),
        ("７ ｉｎ", "7", "in"),
        ("1:48", "1:48", ""),
        ("", "", ""),
    ],
)
def test_a_number_is_written_in_plain_digits_and_its_unit_by_its_name(typed, number, unit):
    assert split_typed(typed) == (number, unit)
