"""Readings by hand: exactly what was written, or a sentence that repeats it."""

import contextlib
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stair_inspector.content.readings import STEP_READINGS, TapeReading, parse_reading
from stair_inspector.errors import ConfigError


@pytest.mark.parametrize("quantity", sorted(STEP_READINGS))
def test_only_what_has_a_direction_may_be_negative(quantity):
    if quantity in ("fall", "cross_fall", "nosing_overhang"):
        assert TapeReading(quantity, -0.01, step=1).value == -0.01
    else:
        for value, said in ((-0.01, r"-0\.01"), (0.0, r"0\.0")):
            with pytest.raises(ConfigError, match=rf"value: got {said}; give a number above 0"):
                TapeReading(quantity, value, step=1)


@pytest.mark.parametrize(
    ("written", "unit", "quantity", "value"),
    [
        (170.5, "mm", "rise", 0.1705),
        (17, "cm", "rise", 0.17),
        ("6 11/16", "in", "rise", 0.1698625),
        ("-1/2", "in", "nosing_overhang", -0.0127),
        (2.0, "%", "fall", math.degrees(math.atan(0.02))),
        ("2", "%", "cross_fall", math.degrees(math.atan(0.02))),
        ("32.5", "deg", "pitch", 32.5),
        (1.5, "ft", "flight_run", 0.4572),
        ("170.5 mm", "in", "rise", 0.1705),
        ("170.5mm", "in", "rise", 0.1705),
        ("17.05 CM", "mm", "rise", 0.1705),
        ('7 9/16"', "mm", "rise", 0.1920875),
        ("7⁹⁄₁₆ in", "mm", "rise", 0.1920875),
        ("7¾ in", "mm", "rise", 0.19685),
        ("7 ¾″", "mm", "rise", 0.19685),
        ("½", "in", "nosing_overhang", 0.0127),
        ("−½ inch", "mm", "nosing_overhang", -0.0127),
        ("3'", "mm", "width", 0.9144),
        ("32.5°", "%", "pitch", 32.5),
        ("2 %", "deg", "fall", math.degrees(math.atan(0.02))),
    ],
)
def test_a_reading_keeps_its_exact_size(written, unit, quantity, value):
    assert parse_reading(written, unit, quantity) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize(
    ("written", "unit", "quantity", "message"),
    [
        ("-170", "mm", "rise", "value: got -170 mm; give a number above 0"),
        ("-6 11/16", "in", "going", "value: got -6 11/16 in; give a number above 0"),
        ("0", "mm", "rise", "value: got 0 mm; give a number above 0"),
        ("0°", "mm", "pitch", "value: got 0 deg; give a number above 0"),
        ("200000", "mm", "rise", "value: got 200000 mm; give a number of at most 100 m"),
        ("170,5", "mm", "rise", "value: got '170,5'; write a point, not a comma, as in 170.5"),
        ("1,205 mm", "mm", "rise", "value: got '1,205 mm'; write a point, not a comma"),
        ("170 kg", "mm", "rise", "value: unit: got 'kg'; give one of m, cm, mm, in, ft"),
        ("170°", "mm", "rise", "value: unit: got 'deg'; give one of m, cm, mm, in, ft"),
        ("5' 7\"", "mm", "rise", 'value: "5\' 7" is no number; write it as 11, 16.5, 3/8 or 7 3/4'),
        ("", "mm", "rise", "value: '' is no number"),
        ("mm", "mm", "rise", "value: 'mm' is no number"),
        ("a lot", "mm", "rise", "value: 'a lot' is no number"),
    ],
)
def test_a_reading_that_cannot_be_is_refused_as_it_was_written(written, unit, quantity, message):
    with pytest.raises(ConfigError) as caught:
        parse_reading(written, unit, quantity)
    assert str(caught.value).startswith(message)


@given(st.text(max_size=60), st.sampled_from(["m", "in", "deg", "%", "kg"]), st.sampled_from(sorted(STEP_READINGS)))
def test_any_text_is_a_reading_or_a_sentence(written, unit, quantity):
    with contextlib.suppress(ConfigError):
        assert math.isfinite(parse_reading(written, unit, quantity))
