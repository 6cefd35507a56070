"""How a value is written: millimetres, or inches with the fractions of a tape. Display only; nothing stored changes.

Wired by handing the chosen :data:`Unit` to whatever writes lengths: the table, the card, the dimensions in the scene,
the measurements. An angle is written with the unit ``"°"`` whatever the choice.
"""

import math
from typing import Literal, NamedTuple

from stair_inspector.errors import ConfigError
from stair_inspector.model import Measured
from stair_inspector.params import METRES_PER_UNIT

Unit = Literal["mm", "in"]
Shown = Literal["mm", "in", "°"]

UNITS: tuple[Unit, ...] = ("mm", "in")
NOT_KNOWN = "–"
M_PER_INCH = METRES_PER_UNIT["in"]
_SIXTEENTHS = 16
_TIE = 1e-9
"""In sixteenths: a thirty-second that lost its last bit on the way through metres is rounded up as all others."""


class Display(NamedTuple):
    """How a quantity is shown: the factor from SI, the unit's sign, the decimals."""

    scale: float
    unit: str
    digits: int


_LENGTH = Display(1000.0, "mm", 2)
_ANGLE = Display(1.0, "°", 2)
_SLOPE = Display(100.0, "%", 2)
_COUNT = Display(1.0, "", 0)
_DISPLAYS = {"pitch": _ANGLE, "tread_slope": _SLOPE, "landing_slope": _SLOPE, "n_risers": _COUNT}


def display_of(quantity: str) -> Display:
    """Return how values of a quantity, a key of :data:`rules.QUANTITIES`, are shown."""
    return _DISPLAYS.get(quantity, _LENGTH)


def u_text(u: float) -> str:
    """Return an uncertainty, in its display unit, with the digits that mean something; never a zero that is none."""
    if u == 0.0 or u >= 9.95:
        return f"{u:.0f}"
    return f"{u:.1f}" if u >= 0.095 else f"{max(u, 0.01):.2f}"


def shown(quantity: str, value: float) -> str:
    """Return a value with its unit: ``170.08 mm``, ``32.40°``, ``2.08 %``, ``9``."""
    scale, unit, digits = display_of(quantity)
    gap = " " if unit not in ("", "°") else ""
    return f"{scale * value:.{digits}f}{gap}{unit}"


def read_unit(value: object) -> Unit:
    """Return the unit that a control names.

    Raises
    ------
    ConfigError
        It is none of :data:`UNITS`.
    """
    known = next((unit for unit in UNITS if unit == value), None)
    if known is None:
        raise ConfigError(f"unit: got {str(value)[:40]!r}; give one of {', '.join(UNITS)}")
    return known


def fraction_text(value_m: float) -> str:
    """Return a length in inches to the nearest sixteenth, reduced: ``6 11/16``, ``-1/2``, ``0``."""
    sixteenths = math.floor(abs(value_m) / M_PER_INCH * _SIXTEENTHS + 0.5 + _TIE)
    whole, rest = divmod(sixteenths, _SIXTEENTHS)
    common = math.gcd(rest, _SIXTEENTHS)
    fraction = f"{rest // common}/{_SIXTEENTHS // common}" if rest else ""
    words = " ".join(part for part in (str(whole) if whole or not rest else "", fraction) if part)
    return f"-{words}" if value_m < 0.0 and sixteenths else words


def number_text(value: float | None, unit: Shown, digits: int = 1) -> str:
    """Return a length in metres or an angle in degrees without its unit; a dash for what is not known."""
    if value is None:
        return NOT_KNOWN
    if unit == "in":
        return fraction_text(value)
    return f"{tidy(_scaled(value, unit), digits):.{digits}f}"


def length_text(value: float | None, unit: Shown, digits: int = 1) -> str:
    """Return a value with its unit: ``170.1 mm``, ``6 11/16 in``, ``31.2°``."""
    return NOT_KNOWN if value is None else number_text(value, unit, digits) + _suffix(unit)


def signed_text(value: float, unit: Shown | None) -> str:
    """Return a difference in metres or degrees, or of a count, with its sign and without its unit.

    Inches are written as a decimal: most differences are finer than any fraction.
    """
    places = {None: 0, "in": 3, "mm": 1, "°": 2}[unit]
    scaled = value if unit is None else value / M_PER_INCH if unit == "in" else _scaled(value, unit)
    rounded = tidy(scaled, places)
    return f"{'+' if rounded > 0.0 else '−' if rounded < 0.0 else '±'}{abs(rounded):.{places}f}"


def uncertainty_text(u: float, unit: Shown) -> str:
    """Return an uncertainty in metres or degrees without its unit; inches as a decimal, finer than any fraction."""
    if unit != "in":
        return u_text(_scaled(u, unit))
    inches = u / M_PER_INCH
    if inches == 0.0:
        return "0"
    return f"{inches:.2f}" if inches >= 0.0995 else f"{max(inches, 0.001):.3f}"


def measured_text(measured: Measured, unit: Shown, digits: int = 1) -> str:
    """Return a value with its uncertainty: ``170.1 ± 0.4 mm``, ``31.2 ± 0.3°``, ``6 11/16 in (6.697 ± 0.016)``.

    A sixteenth of an inch is coarser than most uncertainties, which is why the decimal value stands beside it.
    """
    u = uncertainty_text(measured.u, unit)
    if unit == "in":
        places = len(u.partition(".")[2])
        decimal = tidy(measured.value / M_PER_INCH, places)
        return f"{fraction_text(measured.value)} in ({decimal:.{places}f} ± {u})"
    return f"{number_text(measured.value, unit, digits)} ± {u}{_suffix(unit)}"


def parts_text(measured: Measured, unit: Shown) -> str:
    """Return what an uncertainty is made of: ``noise 0.2, edge 0.3, up 0.1 mm``."""
    parts = ", ".join(f"{name} {uncertainty_text(u, unit)}" for name, u in measured.parts)
    return f"{parts}{_suffix(unit)}" if parts else "parts not stated"


def _scaled(value: float, unit: Shown) -> float:
    return value * 1000.0 if unit == "mm" else value


def _suffix(unit: Shown) -> str:
    return unit if unit == "°" else f" {unit}"


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
