"""Limits as codes write them, and their exact size: fractions of an inch, slopes, degrees, counts."""

import re
from dataclasses import dataclass
from fractions import Fraction

from stair_inspector.errors import ConfigError
from stair_inspector.quantities import LIMITED
from stair_inspector.quantity_types import SiUnit

UNITS: dict[str, Fraction] = {
    "m": Fraction(1),
    "cm": Fraction(1, 100),
    "mm": Fraction(1, 1000),
    "in": Fraction(254, 10_000),
    "ft": Fraction(3048, 10_000),
    "deg": Fraction(1),
    "slope": Fraction(1),
    "%": Fraction(1, 100),
    "count": Fraction(1),
}
"""Units of a limit and their exact size: lengths in metres, angles in degrees, slopes as tangents, counts."""
LENGTH_UNITS = ("m", "cm", "mm", "in", "ft")
SLOPE_UNITS = ("slope", "%")

_UNITS_OF: dict[SiUnit, tuple[str, ...]] = {
    "m": LENGTH_UNITS,
    "deg": ("deg",),
    "tangent": SLOPE_UNITS,
    "count": ("count",),
}
LIMIT_UNITS: dict[str, tuple[str, ...]] = {
    **{quantity.name: _UNITS_OF[quantity.unit] for quantity in LIMITED},
    "other": tuple(UNITS),
}
"""What can be limited, and the units of its limits. ``other`` is what no scan shows."""

_PLAIN = r"[0-9]{1,6}(?:\.[0-9]{1,9})?"
_NUMBER = re.compile(
    rf"(?:(?P<whole>[0-9]{{1,6}}) )?(?P<over>[0-9]{{1,6}})/(?P<under>[0-9]{{1,6}})|(?P<plain>{_PLAIN})"
)
_LONG = re.compile(r"[0-9]{7}|\.[0-9]{10}")
_SLOPE = re.compile(rf"1:(?P<run>{_PLAIN})")


def parse_written(written: str, unit: str) -> Fraction:
    """Return the exact size of a limit as it is written: metres, degrees, a tangent or a count.

    Parameters
    ----------
    written : str
        ``"7 3/4"``, ``"3/8"``, ``"44"``, ``"16.5"``, or for the unit ``"slope"`` ``"1:48"``.
    unit : str
        One of :data:`UNITS`.

    Raises
    ------
    ConfigError
        Unknown unit, or no number as a code writes it.
    """
    if unit not in UNITS:
        raise ConfigError(f"unit {unit[:20]!r} is not known; give one of {', '.join(UNITS)}")
    if unit == "slope":
        slope = _SLOPE.fullmatch(written)
        if slope is None or not Fraction(slope["run"]):
            raise ConfigError(f"{written[:40]!r} is no slope; write it as 1:48")
        return 1 / Fraction(slope["run"])
    number = _NUMBER.fullmatch(written)
    if number is None and _LONG.search(written) is not None:
        raise ConfigError(f"{written[:40]!r} has too many digits; give at most six, and nine after the point")
    if number is None or (number["under"] is not None and not int(number["under"])):
        raise ConfigError(f"{written[:40]!r} is no number; write it as 11, 16.5, 3/8 or 7 3/4")
    if number["plain"] is not None:
        size = Fraction(number["plain"])
    else:
        size = int(number["whole"] or 0) + Fraction(int(number["over"]), int(number["under"]))
    if unit == "count" and size.denominator != 1:
        raise ConfigError(f"{written!r} is no count; give a whole number")
    return size * UNITS[unit]


@dataclass(frozen=True, slots=True)
class Limit:
    """A limit as its code writes it, and its exact size.

    ``value`` is the float next to the exact size: metres, degrees, a tangent (of a slope) or a count.
    """

    written: str
    unit: str
    value: float

    def __post_init__(self) -> None:
        size = parse_written(self.written, self.unit)
        if self.value != float(size):
            raise ConfigError(
                f"limit {self.written} {self.unit} is {float(size)!r}, not {self.value!r}; use Limit.of to convert it"
            )

    @classmethod
    def of(cls, written: str, unit: str) -> "Limit":
        """Return the limit with these words, converted exactly.

        Raises
        ------
        ConfigError
            As :func:`parse_written`.
        """
        return cls(written, unit, float(parse_written(written, unit)))

    @property
    def exact(self) -> Fraction:
        """The exact size: metres, degrees, a tangent or a count."""
        return parse_written(self.written, self.unit)

    @property
    def as_written(self) -> str:
        """The limit as its code writes it: ``3/8 in``, ``1:48``, ``42°``, ``18``."""
        if self.unit in ("slope", "count"):
            return self.written
        return f"{self.written}°" if self.unit == "deg" else f"{self.written} {self.unit}"

    @property
    def text(self) -> str:
        """The limit for people, with its size in millimetres or per cent: ``3/8 in (9.525 mm)``."""
        if self.unit in LENGTH_UNITS and self.unit != "mm":
            return f"{self.as_written} ({_decimal(self.exact * 1000)} mm)"
        if self.unit == "slope":
            return f"{self.as_written} ({_decimal(self.exact * 100)} %)"
        return self.as_written


def _decimal(size: Fraction) -> str:
    """Return at most four decimals, rounded half to even, without trailing zeros."""
    text = f"{float(round(size, 4)):.4f}"
    return text.rstrip("0").rstrip(".")


def check_unit(place: str, quantity: str, limit: Limit) -> None:
    """Raise ConfigError unless a limit is in a unit of the quantity that it limits."""
    if limit.unit not in LIMIT_UNITS[quantity]:
        fitting = ", ".join(LIMIT_UNITS[quantity])
        if limit.unit == "count":
            raise ConfigError(f"{place}: {limit.written} has no unit; write one of {fitting} after it")
        raise ConfigError(f"{place}: {limit.as_written} is no limit of {quantity}; its units are {fitting}")
