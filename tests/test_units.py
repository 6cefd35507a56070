"""Lengths as an inspector reads them: millimetres, or the fractions of a tape; the stored value never changes."""

import math
from fractions import Fraction

import pytest

from stair_inspector.errors import ConfigError
from stair_inspector.model import Measured
from stair_inspector.params import KNOWN_UNITS
from stair_inspector.units import (
    METRES_PER_UNIT,
    UNIT_NAMES,
    fraction_text,
    length_text,
    measured_text,
    number_text,
    parts_text,
    read_unit,
    signed_text,
    u_text,
    uncertainty_text,
)
from stair_inspector.viewer.scene.dimensions import dimensions_of
from tests.viewer.surveyed import surveyed

INCH = 0.0254


def inches_of(words):
    """The number that a tape's fraction stands for: the reverse of what is tested."""
    sign = -1 if words.startswith("-") else 1
    return sign * sum((Fraction(part) for part in words.lstrip("-").split(" ")), Fraction(0))


@pytest.mark.parametrize(
    ("u", "shown"), [(0.0, "0"), (0.004, "0.01"), (0.04, "0.04"), (0.0951, "0.1"), (0.44, "0.4"), (9.94, "9.9")]
)
def test_an_uncertainty_has_the_digits_that_mean_something(u, shown):
    assert u_text(u) == shown


@pytest.mark.parametrize(("u", "shown"), [(9.95, "10"), (12.34, "12"), (250.6, "251")])
def test_a_large_uncertainty_has_no_decimals(u, shown):
    assert u_text(u) == shown


def test_lengths_are_millimetres_and_angles_degrees():
    assert measured_text(Measured(0.1701, 0.0004), "mm") == "170.1 ± 0.4 mm"
    assert measured_text(Measured(31.24, 0.3), "°") == "31.2 ± 0.3°"
    assert measured_text(Measured(-0.0004, 0.012), "°", 2) == "0.00 ± 0.01°"
    assert parts_text(Measured(31.24, 0.3, (("noise", 0.3),)), "°") == "noise 0.3°"


@pytest.mark.parametrize(
    ("inches", "shown"),
    [
        (0.0, "0"),
        (7.0, "7"),
        (7.75, "7 3/4"),
        (6.6929, "6 11/16"),
        (0.5, "1/2"),
        (1 / 32 - 1e-9, "0"),
        (1 / 32, "1/16"),
        (11.99, "12"),
        (15.99 / 16, "1"),
        (11 + 31 / 32, "12"),
        (-11 - 31 / 32, "-12"),
        (-6.6929, "-6 11/16"),
        (-0.125, "-1/8"),
        (-0.01, "0"),
    ],
)
def test_inches_are_reduced_fractions_to_a_sixteenth(inches, shown):
    assert fraction_text(inches * INCH) == shown


def test_a_fraction_is_the_nearest_sixteenth_of_the_length():
    for value_m in (0.0013 * k - 0.4 for k in range(700)):
        read = inches_of(fraction_text(value_m))
        assert (read * 16).denominator == 1
        assert abs(float(read) * INCH - value_m) <= INCH / 32 + 1e-12


def test_every_thirty_second_is_rounded_up_whatever_its_last_bit():
    for k in range(-2000, 2000):
        assert inches_of(fraction_text(k / 32 * INCH)) == math.copysign(1, k) * Fraction((abs(k) + 1) // 2, 16)


def test_a_number_has_no_unit_and_a_length_has():
    assert number_text(0.1701, "mm") == "170.1"
    assert number_text(31.24, "°", 2) == "31.24"
    assert length_text(0.1701, "mm") == "170.1 mm"
    assert length_text(0.17, "in") == "6 11/16 in"
    assert length_text(-0.00001, "mm") == "0.0 mm"
    assert number_text(None, "mm") == length_text(None, "in") == "–"


@pytest.mark.parametrize(("u_m", "shown"), [(0.0, "0"), (0.000001, "0.001"), (0.0004, "0.016"), (0.012, "0.47")])
def test_an_uncertainty_in_inches_is_a_decimal_and_never_a_zero_that_is_none(u_m, shown):
    assert uncertainty_text(u_m, "in") == shown


def test_a_value_in_inches_gives_the_fraction_and_the_decimal_with_its_uncertainty():
    assert measured_text(Measured(0.1701, 0.0004), "in") == "6 11/16 in (6.697 ± 0.016)"
    assert measured_text(Measured(0.3, 0.012), "in") == "11 13/16 in (11.81 ± 0.47)"
    assert measured_text(Measured(0.0, 0.0), "in") == "0 in (0.000 ± 0)"
    assert parts_text(Measured(0.17, 0.0004, (("noise", 0.0004),)), "in") == "noise 0.016 in"


def test_the_decimal_value_in_inches_is_the_length_itself():
    words = measured_text(Measured(0.123456, 0.0004), "in")
    assert math.isclose(float(words.partition("(")[2].split(" ")[0]) * INCH, 0.123456, abs_tol=0.0005 * INCH)


@pytest.mark.parametrize(
    ("value", "unit", "shown"),
    [
        (0.0, "mm", ""),
        (-0.00004, "mm", ""),
        (0.00004, "in", "+0.002"),
        (-0.00006, "mm", "−0.1"),
        (0.004, "°", ""),
        (-1, None, "−1"),
        (0, None, ""),
    ],
)
def test_a_difference_has_a_sign_and_is_blank_where_it_is_zero_as_shown(value, unit, shown):
    assert signed_text(value, unit) == shown


@pytest.mark.parametrize("value", ["ft", "", None, 3, "<b>mm</b>", "MM"])
def test_an_unknown_unit_is_refused_with_a_sentence(value):
    with pytest.raises(ConfigError, match=r"unit: got .*; give one of mm, in"):
        read_unit(value)
    assert [read_unit("mm"), read_unit("in")] == ["mm", "in"]


def test_the_dimensions_in_the_scene_are_written_in_the_unit_and_stay_where_they_are():
    inspection = surveyed()[1]
    metric, imperial = (dimensions_of(inspection, inspection.steps[0], 0.01, unit) for unit in ("mm", "in"))
    assert [label.text for label in imperial.labels] == [
        "going 11 in (11.024 ± 0.016)",
        "tread depth 11 13/16 in (11.81 ± 0.48)",
        "rise 6 11/16 in (6.697 ± 0.016)",
        "width 39 3/8 in (39.370 ± 0.002)",
    ]
    assert (metric.arrows == imperial.arrows).all()


def test_without_uncertainty_a_value_in_inches_keeps_its_decimals():
    assert measured_text(Measured(0.1694, 0.0), "in") == "6 11/16 in (6.669 ± 0)"


def test_units_are_exact():
    assert METRES_PER_UNIT == {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048}
    assert METRES_PER_UNIT["ft"] == pytest.approx(12 * METRES_PER_UNIT["in"], rel=1e-15)


def test_a_file_in_each_unit_is_read_and_named_in_it():
    assert METRES_PER_UNIT.keys() == UNIT_NAMES.keys() == set(KNOWN_UNITS)
