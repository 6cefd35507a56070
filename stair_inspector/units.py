"""How a value is written: millimetres, or inches with the fractions of a tape. Display only; nothing stored changes.

Wired by handing the chosen :data:`Unit` to whatever writes lengths: the table, the card, the dimensions in the scene,
the measurements. An angle is written with the unit ``"°"`` whatever the choice.
"""

import math
from typing import Literal

from stair_inspector.errors import one_of
from stair_inspector.model import Measured
from stair_inspector.quantities import QUANTITIES
from stair_inspector.quantity_types import NOTATIONS, Notation, SiUnit

Unit = Literal["mm", "in"]
ShownUnit = Literal["mm", "in", "m", "°", "%", ""]
"""Of a length a unit, of another quantity its sign."""

METRES_PER_UNIT: dict[str, float] = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048}
"""Exact length of each unit, metres (international inch and foot)."""
UNIT_NAMES: dict[str, str] = {"m": "metres", "cm": "centimetres", "mm": "millimetres", "in": "inches", "ft": "feet"}

UNITS: tuple[Unit, ...] = ("mm", "in")
NOT_KNOWN = "–"
M_PER_INCH = METRES_PER_UNIT["in"]
_SIXTEENTHS = 16
_INCH_DIGITS = 3
"""Decimals of an inch where no uncertainty sets them: finer than a tenth of a millimetre."""
_DIFFERENCE_PLACES: dict[ShownUnit, int] = {"in": 3, "mm": 1, "m": 3, "°": 2, "%": 2, "": 0}
_TIE = 1e-9
"""In sixteenths: a thirty-second that lost its last bit on the way through metres is rounded up as all others."""


_BY_QUANTITY = {quantity.name: quantity.notation for quantity in QUANTITIES}


def notation_of(quantity: str) -> Notation:
    """Return how values of a quantity are shown, by its name; what no scan shows is written as a length."""
    return _BY_QUANTITY.get(quantity, NOTATIONS["m"])


def shown_in(unit: SiUnit, chosen: Unit) -> ShownUnit:
    """Return how values of an SI unit are written where lengths are written in the chosen one."""
    return {"m": chosen, "deg": "°", "tangent": "%", "count": ""}[unit]


def u_text(u: float) -> str:
    """Return an uncertainty, in its display unit, with the digits that mean something; never a zero that is none."""
    if u == 0.0 or u >= 9.95:
        return f"{u:.0f}"
    return f"{u:.1f}" if u >= 0.095 else f"{max(u, 0.01):.2f}"


def places_of(u: float | None, digits: int) -> int:
    """Return the decimals of a value: those with which its uncertainty is shown, ``digits`` where it has none."""
    return len(u_text(u).partition(".")[2]) if u else digits


def shown(quantity: str, value: float, u: float | None = None) -> str:
    """Return a value with its unit, rounded where its uncertainty is: ``170.08 mm``, ``170.1 ± 0.4 mm``, ``9``."""
    scale, unit, digits = notation_of(quantity)
    gap = " " if unit not in ("", "°") else ""
    if not u:
        return f"{scale * value:.{digits}f}{gap}{unit}"
    places = places_of(scale * u, digits)
    return f"{tidy(scale * value, places):.{places}f} ± {u_text(scale * u)}{gap}{unit}"


def read_unit(value: object) -> Unit:
    """Return the unit that a control names.

    Raises
    ------
    ConfigError
        It is none of :data:`UNITS`.
    """
    return one_of(value, UNITS, "unit")


def fraction_text(value_m: float) -> str:
    """Return a length in inches to the nearest sixteenth, reduced: ``6 11/16``, ``-1/2``, ``0``."""
    sixteenths = math.floor(abs(value_m) / M_PER_INCH * _SIXTEENTHS + 0.5 + _TIE)
    whole, rest = divmod(sixteenths, _SIXTEENTHS)
    common = math.gcd(rest, _SIXTEENTHS)
    fraction = f"{rest // common}/{_SIXTEENTHS // common}" if rest else ""
    words = " ".join(part for part in (str(whole) if whole or not rest else "", fraction) if part)
    return f"-{words}" if value_m < 0.0 and sixteenths else words


def number_text(value: float | None, unit: ShownUnit, digits: int = 1) -> str:
    """Return a length in metres or an angle in degrees without its unit; a dash for what is not known."""
    if value is None:
        return NOT_KNOWN
    if unit == "in":
        return fraction_text(value)
    return f"{tidy(_scaled(value, unit), digits):.{digits}f}"


def length_text(value: float | None, unit: ShownUnit, digits: int = 1) -> str:
    """Return a value with its unit: ``170.1 mm``, ``6 11/16 in``, ``31.2°``."""
    return NOT_KNOWN if value is None else number_text(value, unit, digits) + _suffix(unit)


def difference_text(value: float, unit: ShownUnit) -> str:
    """Return the size of a difference with its unit: ``3.1 mm``, ``1/8 in (0.122)``; most are finer than a fraction."""
    decimal = f" ({abs(value) / M_PER_INCH:.3f})" if unit == "in" else ""
    return f"{length_text(value, unit)}{decimal}"


def signed_text(value: float, unit: ShownUnit | None) -> str:
    """Return a difference in metres or degrees, or of a count, with its sign and without its unit; nothing for zero.

    Inches are written as a decimal: most differences are finer than any fraction.
    """
    places = 0 if unit is None else _DIFFERENCE_PLACES[unit]
    scaled = value if unit is None else value / M_PER_INCH if unit == "in" else _scaled(value, unit)
    rounded = tidy(scaled, places)
    return f"{'+' if rounded > 0.0 else '−'}{abs(rounded):.{places}f}" if rounded else ""


def uncertainty_text(u: float, unit: ShownUnit) -> str:
    """Return an uncertainty in metres or degrees without its unit; inches as a decimal, finer than any fraction."""
    if unit != "in":
        return u_text(_scaled(u, unit))
    inches = u / M_PER_INCH
    if inches == 0.0:
        return "0"
    return f"{inches:.2f}" if inches >= 0.0995 else f"{max(inches, 0.001):.3f}"


def value_and_u(measured: Measured, unit: ShownUnit, digits: int = 1) -> tuple[str, str]:
    """Return a value and its uncertainty without their unit: the value rounded where its uncertainty is.

    Inches are decimals here. ``digits`` are those of a value whose uncertainty is zero.
    """
    u = uncertainty_text(measured.u, unit)
    if unit == "in":
        places = len(u.partition(".")[2]) if measured.u else _INCH_DIGITS
        return f"{tidy(measured.value / M_PER_INCH, places):.{places}f}", u
    return number_text(measured.value, unit, places_of(_scaled(measured.u, unit), digits)), u


def signed_number(number: str) -> str:
    """Return a number that is written out as a difference: with its sign, and nothing where it is zero as shown."""
    if not number.strip("-0."):
        return ""
    return number.replace("-", "−") if number.startswith("-") else f"+{number}"


def measured_text(measured: Measured, unit: ShownUnit, digits: int = 1) -> str:
    """Return a value with its uncertainty: ``170.1 ± 0.4 mm``, ``31.2 ± 0.3°``, ``6 11/16 in (6.697 ± 0.016)``.

    A sixteenth of an inch is coarser than most uncertainties, which is why the decimal value stands beside it.
    """
    value, u = value_and_u(measured, unit, digits)
    if unit == "in":
        return f"{fraction_text(measured.value)} in ({value} ± {u})"
    return f"{value} ± {u}{_suffix(unit)}"


def is_finer_than_a_fraction(u_m: float) -> bool:
    """Tell whether an uncertainty is smaller than a sixteenth of an inch, so that a fraction hides something."""
    return u_m < M_PER_INCH / _SIXTEENTHS


def parts_text(measured: Measured, unit: ShownUnit) -> str:
    """Return what an uncertainty is made of: ``noise 0.2, edge 0.3, up 0.1 mm``."""
    parts = ", ".join(f"{name} {uncertainty_text(u, unit)}" for name, u in measured.parts)
    return f"{parts}{_suffix(unit)}" if parts else "parts not stated"


def _scaled(value: float, unit: ShownUnit) -> float:
    return value * 1000.0 if unit == "mm" else value * 100.0 if unit == "%" else value


def _suffix(unit: ShownUnit) -> str:
    return unit if unit in ("", "°") else f" {unit}"


def tidy(value: float, digits: int) -> float:
    """Return the value rounded, and zero without a sign."""
    return round(float(value), digits) + 0.0


def round_ticks(low: float, span: float, n: float = 6.0) -> list[tuple[int, float]]:
    """Return about ``n`` round numbers within a range that has a length, each with its number of decimals."""
    wanted = span / n
    power = 10.0 ** math.floor(math.log10(wanted))
    step = next(factor * power for factor in (1.0, 2.0, 5.0, 10.0) if factor * power >= wanted)
    digits = max(0, -math.floor(math.log10(step)))
    first = math.ceil(low / step)
    last = math.ceil((low + span) / step)
    return [(digits, tidy(k * step, digits)) for k in range(first, last)]
