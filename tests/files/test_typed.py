"""Numbers as people type them: the same value whatever letters their fractions are made of."""

import pytest

from stair_inspector.files.typed import with_plain_fractions


@pytest.mark.parametrize(
    ("typed", "plain"),
    [("7¾ in", "7 3/4 in"), ("½", " 1/2"), ("7 3⁄4", "7 3/4"), ("180 mm", "180 mm"), ("7″", "7″"), ("", "")],
)
def test_fractions_are_written_in_plain_digits_and_all_else_stays(typed, plain):
    assert with_plain_fractions(typed) == plain
