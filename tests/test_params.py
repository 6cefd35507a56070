"""Every setting checks itself, and says of itself what is true."""

import math
import re

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from stair_inspector.errors import ConfigError
from stair_inspector.overrules import NAMED_UP, parse_up
from stair_inspector.params import SETTINGS, FlightsParams, Params
from tests.synthetic import CHANGES

NAMES = list(SETTINGS)
NUMBERS = [name for name, declared in SETTINGS.items() if declared.knob is not None]


def value_of(params, name):
    for part in name.split("."):
        params = getattr(params, part)
    return params


@pytest.mark.parametrize("name", NUMBERS)
def test_the_help_states_the_range_that_is_enforced(name):
    low, high = re.search(r"\((\S+) to (\S+)\)", SETTINGS.setting(name).documentation).groups()
    assert (float(low), float(high)) == (SETTINGS.knob(name).low, SETTINGS.knob(name).high)


@pytest.mark.parametrize("name", NAMES)
def test_every_setting_has_a_sentence_of_help(name):
    assert re.fullmatch(r"\S.{15,}\.", SETTINGS.setting(name).documentation)


@pytest.mark.parametrize("name", NUMBERS)
def test_limits_are_inclusive_and_the_default_lies_between(name):
    knob = SETTINGS.knob(name)
    assert knob.low <= value_of(Params(), name) <= knob.high
    kind = SETTINGS[name].kind
    for limit in (knob.low, knob.high):
        assert value_of(Params().replaced(name, kind(limit)), name) == limit
    beyond = (
        (knob.low - 1, knob.high + 1) if kind is int else np.nextafter([knob.low, knob.high], [-math.inf, math.inf])
    )
    for value in beyond:
        with pytest.raises(ConfigError) as error:
            Params().replaced(name, kind(value))
        assert str(error.value) == f"{name}: got {kind(value)!r}; give a value from {knob.low:g} to {knob.high:g}"


@pytest.mark.parametrize("name", NUMBERS)
@pytest.mark.parametrize(
    "value", ["20", None, True, math.nan, math.inf, [1.0], 10**400], ids=lambda value: str(value)[:9]
)
def test_what_is_no_finite_number_is_refused(name, value):
    with pytest.raises(ConfigError, match=rf"^{re.escape(name)}: got "):
        Params().replaced(name, value)


def test_a_whole_number_is_wanted_where_things_are_counted():
    with pytest.raises(ConfigError) as error:
        Params().replaced("levels.min_points", 50.0)
    assert str(error.value) == "levels.min_points: got 50.0; give a whole number"


@pytest.mark.parametrize(
    ("name", "value", "text"),
    [
        ("method", "magic", "method: got 'magic'; give one of survey, paper"),
        ("unit", "parsec", "unit: got 'parsec'; give one of auto, m, cm, mm, in, ft"),
        ("axes.rule", 3, "axes.rule: got 3; give one of auto, global, per_step"),
        ("normals.source", None, "normals.source: got None; give one of estimate, given"),
        ("up", 3, "up: got 3; give a text"),
        ("levels", {}, "levels: unknown setting"),
        ("levels.eps", 0.1, "levels.eps: unknown setting"),
        ("level.eps_m", 0.1, "level.eps_m: unknown setting"),
        ("a.b.c", 0.1, "a.b.c: unknown setting"),
        ("", 1, ": unknown setting"),
    ],
)
def test_the_sentence_for_a_wrong_setting(name, value, text):
    with pytest.raises(ConfigError) as error:
        Params().replaced(name, value)
    assert str(error.value) == text


@pytest.mark.parametrize("name", CHANGES)
def test_replacing_a_setting_changes_that_one_alone(name):
    before, after = Params(), Params().replaced(name, CHANGES[name])
    assert [n for n in NAMES if value_of(before, n) != value_of(after, n)] == [name]
    assert after.replaced(name, value_of(before, name)) == before


def test_settings_are_values():
    assert Params() == Params()
    assert hash(Params()) == hash(Params())
    with pytest.raises(AttributeError):
        Params().levels.eps_m = 1.0


@pytest.mark.parametrize("name", NUMBERS)
def test_what_a_slider_shows_comes_back(name):
    knob = SETTINGS.knob(name)
    for share in np.linspace(0.0, 1.0, 23):
        value = round(knob.low + share * (knob.high - knob.low), 6)
        assert knob.stored(knob.shown(value)) == value
    assert knob.stored(knob.shown(value_of(Params(), name))) == value_of(Params(), name)


def test_the_knob_of_a_setting_without_numbers_says_so():
    for name in ("method", "axes.rule", "levels.nothing", "nothing.eps_m", "levels"):
        with pytest.raises(ConfigError, match="not a numeric setting"):
            SETTINGS.knob(name)


# --- up ------------------------------------------------------------------------------------------------------------


def test_named_directions():
    assert parse_up("auto") is None
    assert {name: parse_up(name) for name in NAMED_UP} == NAMED_UP
    assert parse_up("-y") == (0.0, -1.0, 0.0)


@pytest.mark.parametrize(
    ("text", "expected"), [("0,0,7", (0, 0, 1)), (" 3, 0 ,4", (0.6, 0, 0.8)), ("-1e-3,0,0", (-1, 0, 0))]
)
def test_three_numbers_are_scaled_to_unit_length(text, expected):
    assert parse_up(text) == pytest.approx(expected, rel=1e-15)


@given(st.tuples(*[st.floats(allow_nan=True, allow_infinity=True)] * 3))
@example((5e-324, 5e-324, 0.0))
def test_three_numbers_give_a_unit_vector_or_an_error(numbers):
    try:
        vector = parse_up(",".join(map(repr, numbers)))
    except ConfigError:
        assert not 1e-100 < math.hypot(*numbers) < math.inf
        return
    assert math.hypot(*vector) == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize(
    "text", ["", "Z", "z ", "0,0,0", "1,2", "1,2,3,4", "1;2;3", "nan,0,1", "inf,0,0", "a,b,c", ",,"]
)
def test_what_is_no_direction_is_refused(text):
    with pytest.raises(ConfigError) as error:
        Params(up=text)
    assert str(error.value) == (f'up: got {text!r}; give auto, x, y, z, -x, -y, -z, or three numbers such as "0.1,0,1"')


def test_limits_that_move_nothing_when_they_are_narrowed_are_the_widest_of_the_user_s_and_the_usual_ones():
    narrow = FlightsParams(min_rise_m=0.15, max_rise_m=0.2, max_gap_m=0.05, turn_deg=10.0, min_risers=5)
    assert narrow.at_least_usual == FlightsParams()
    wide = FlightsParams(min_rise_m=0.04, max_rise_m=0.5, max_gap_m=0.4, turn_deg=60.0)
    assert wide.at_least_usual == wide
