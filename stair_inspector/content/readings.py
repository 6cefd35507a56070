"""Readings by hand, of a tape or a level, to be compared with the scan."""

import math
from dataclasses import dataclass
from typing import Literal, get_args

from stair_inspector.codes.limits import LENGTH_UNITS, parse_written
from stair_inspector.content.texts import require_text
from stair_inspector.content.written import split_unit
from stair_inspector.errors import ConfigError, brief
from stair_inspector.files.toml import check_keys
from stair_inspector.quantities import OF_FLIGHT, OF_STEP, ON_LINES
from stair_inspector.quantity_types import SiUnit
from stair_inspector.units import METRES_PER_UNIT

Line = Literal["left", "centre", "right"]
STEP_READINGS: dict[str, SiUnit] = {quantity.name: quantity.unit for quantity in OF_STEP if quantity.is_read}
"""What can be read off one step by hand, and the unit that its value is kept in."""
FLIGHT_READINGS: dict[str, SiUnit] = {
    quantity.name: quantity.unit
    for quantity in sorted(OF_FLIGHT, key=lambda each: each.of_step is not None)
    if quantity.is_read
}
"""What can be read off a whole flight by hand, what only a flight has first."""
_MAY_BE_NEGATIVE = tuple(quantity.name for quantity in OF_STEP if quantity.may_be_negative)
"""Quantities with a direction; another one of zero or below is a slip of the pen."""
ON_A_LINE = tuple(quantity.name for quantity in ON_LINES)
"""Quantities that are measured on three lines."""
_LONGEST_READING = {"m": 100.0, "deg": 90.0}
_LARGEST_NUMBER = 1e9
"""Of any reading in any unit."""
_SIZES = {**METRES_PER_UNIT, "deg": 1.0, "%": 0.01}
"""Units of readings in metres, degrees or as a tangent."""


@dataclass(frozen=True, slots=True)
class TapeReading:
    """One reading by hand, to be compared with the scan.

    ``quantity`` is a name of :data:`STEP_READINGS` where ``step`` is given, else of :data:`FLIGHT_READINGS` with
    ``flight``; ``value`` is in metres or degrees, ``u`` its expanded uncertainty (k = 2) where known; ``line`` is the
    measuring line of a rise or going. ``at`` is the middle of the step's tread, scan frame, metres, where it is known:
    the number of a step may change with the settings, its place does not.

    Raises
    ------
    ConfigError
        Unknown quantity, neither or both of step and flight, a place of a flight or one that is none, or a value that
        no stair has.
    """

    quantity: str
    value: float
    step: int | None = None
    flight: int | None = None
    line: Line = "centre"
    u: float | None = None
    instrument: str = ""
    note: str = ""
    at: tuple[float, float, float] | None = None

    def __post_init__(self) -> None:
        place = f"reading of {brief(self.quantity)}"
        if (self.step is None) == (self.flight is None):
            raise ConfigError(f"{place}: give either step or flight, a number from 1")
        known = STEP_READINGS if self.flight is None else FLIGHT_READINGS
        check_keys("reading", [str(self.quantity)], known, "quantity")
        for name in ("step", "flight"):
            number = getattr(self, name)
            if number is not None and (type(number) is not int or not 1 <= number <= 10_000):
                raise ConfigError(f"{place}: {name}: got {brief(number)}; give a whole number from 1")
        if self.line not in get_args(Line):
            raise ConfigError(f"{place}: line: got {brief(self.line)}; give one of {', '.join(get_args(Line))}")
        if self.line != "centre" and self.quantity not in ON_A_LINE:
            raise ConfigError(
                f"{place}: line: only {' and '.join(ON_A_LINE)} are measured on three lines; leave it out"
            )
        unit = known[self.quantity]
        has_sign = self.quantity in _MAY_BE_NEGATIVE
        value = _check_number(self.value, f"{place}: value", unit, has_sign=has_sign)
        object.__setattr__(self, "value", value)
        if self.u is not None:
            object.__setattr__(self, "u", _check_number(self.u, f"{place}: u", unit))
        if self.at is not None:
            object.__setattr__(self, "at", _check_place(self.at, f"{place}: at", is_of_step=self.step is not None))
        for name in ("instrument", "note"):
            object.__setattr__(self, name, require_text(getattr(self, name), f"{place}: {name}"))

    @property
    def unit(self) -> str:
        """The unit of ``value``: ``m`` or ``deg``."""
        return (STEP_READINGS if self.flight is None else FLIGHT_READINGS)[self.quantity]


def parse_reading(written: str | float, unit: str, quantity: str, place: str = "value", *, is_u: bool = False) -> float:
    """Return a reading as it was given, ``"6 11/16"`` inches or 170.5 mm, in metres or degrees.

    Parameters
    ----------
    written : str or float
        A number, or a text with a number or a fraction; a unit written behind it counts before ``unit``.
    unit : str
        A unit of length; for an angle ``deg``, or ``%`` for a slope as a level shows it.
    quantity : str
        A name of :data:`STEP_READINGS` or :data:`FLIGHT_READINGS`.
    is_u : bool
        Whether it is the uncertainty of a reading, which has no direction.

    Raises
    ------
    ConfigError
        Not a number, a unit that does not fit the quantity, or a size that no stair has.
    """
    kept_in = {**STEP_READINGS, **FLIGHT_READINGS}.get(quantity, "deg")
    number, own_unit = split_unit(written, place) if isinstance(written, str) else (written, "")
    unit = own_unit or unit
    units = LENGTH_UNITS if kept_in == "m" else ("deg", "%")
    if unit not in units:
        raise ConfigError(f"{place}: unit: got {brief(unit)}; give one of {', '.join(units)}")
    if isinstance(number, str):
        value = _size_of(number, unit, place)
    elif isinstance(number, bool) or not isinstance(number, (int, float)):
        raise ConfigError(f'{place}: got {brief(written)}; give a number, or a text such as "6 11/16"')
    else:
        # Out of any range, and too long for a float.
        value = number if abs(number) > _LARGEST_NUMBER else number * _SIZES[unit]
    said = f"{number if isinstance(number, str) else brief(number)} {unit}"
    if unit == "%" and -_LARGEST_NUMBER <= value <= _LARGEST_NUMBER:
        value = math.degrees(math.atan(value))
    return _check_number(value, place, kept_in, has_sign=quantity in _MAY_BE_NEGATIVE and not is_u, written=said)


def _size_of(number: str, unit: str, place: str) -> float:
    """Return what a text with a sign says, in metres, degrees or as a tangent."""
    sign, digits = (-1.0, number[1:].strip()) if number[:1] in ("-", "−") else (1.0, number)
    try:
        return sign * float(parse_written(digits, unit))
    except ConfigError as error:
        raise ConfigError(f"{place}: {error}") from error


def _check_number(value: object, place: str, unit: str, *, has_sign: bool = False, written: str = "") -> float:
    """Return a size in metres or degrees; ``written`` is what the message repeats of it."""
    most = _LONGEST_READING[unit]
    said = written or brief(value)
    # A comparison with something that is no number is False; a whole number may be too long for a float.
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not -most <= value <= most:
        raise ConfigError(f"{place}: got {said}; give a number of at most {most:g} {unit}")
    if value <= 0.0 and not has_sign:
        raise ConfigError(f"{place}: got {said}; give a number above 0")
    return float(value)


def _check_place(value: object, place: str, *, is_of_step: bool) -> tuple[float, float, float]:
    if not is_of_step:
        raise ConfigError(f"{place}: only a step has a place; leave it out")
    numbers = [number for number in value if type(number) in (int, float)] if isinstance(value, (list, tuple)) else []
    if len(numbers) != 3 or not isinstance(value, (list, tuple)) or len(value) != 3:
        raise ConfigError(f"{place}: got {brief(value)}; give x, y and z in metres")
    if not all(-_LARGEST_NUMBER <= number <= _LARGEST_NUMBER for number in numbers):
        raise ConfigError(f"{place}: got {brief(value)}; give x, y and z in metres")
    x, y, z = map(float, numbers)
    return x, y, z
