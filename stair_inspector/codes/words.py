"""Values as people read them: one unit and one number of decimals for each quantity."""

from typing import NamedTuple


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
