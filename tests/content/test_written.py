"""A reading is taken apart into its number and its unit, however it is written."""

import pytest

from stair_inspector.content.written import split_unit
from stair_inspector.errors import ConfigError


@pytest.mark.parametrize(
    ("text", "number", "unit"),
    [
        ("170.5", "170.5", ""),
        (" 170.5  mm ", "170.5", "mm"),
        ("170.5MM", "170.5", "mm"),
        ('7 9/16"', "7 9/16", "in"),
        ("7 9/16 inches", "7 9/16", "in"),
        ("7 9 ⁄ 16″", "7 9/16", "in"),
        ("7¾″", "7 3/4", "in"),
        ("¾''", "3/4", "in"),
        ("7⁹⁄₁₆”", "7 9/16", "in"),
        ("-½ in", "- 1/2", "in"),
        ("3'", "3", "ft"),
        ("32.5°", "32.5", "deg"),
        ("2%", "2", "%"),
        ("2 furlongs", "2", "furlongs"),
        ("a lot", "a lot", ""),
        ("", "", ""),
        ("mm", "mm", ""),
    ],
)
def test_number_and_unit(text, number, unit):
    assert split_unit(text, "value") == (number, unit)


@pytest.mark.parametrize("text", ["170,5", "1,205 mm", "−0,5 in"])
def test_a_comma_is_not_guessed_at(text):
    with pytest.raises(ConfigError, match=r"value: got .*; write a point, not a comma, as in 170.5"):
        split_unit(text, "value")
