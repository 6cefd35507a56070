"""Cells and columns that the tables of a report have in common, and words for what they hold."""

from collections.abc import Iterable

from stair_inspector.codes.findings import Finding, Verdict
from stair_inspector.content.document import Cell, Column, Number
from stair_inspector.model import Measured, Statistics
from stair_inspector.quantities import QUANTITIES
from stair_inspector.quantity_types import Quantity, SiUnit
from stair_inspector.units import places_of

QUANTITY_WORDS: dict[str, str] = {**{quantity.name: quantity.words for quantity in QUANTITIES}, "other": ""}
"""Our quantities, in words."""


def millimetres(value_m: float | None) -> float | None:
    """Return a length in millimetres."""
    # Nanometres are enough, and keep 0.1 m from becoming 100.00000000000001 mm.
    return None if value_m is None else round(value_m * 1000.0, 6)


_COLUMNS: dict[SiUnit, tuple[str, int]] = {"m": ("mm", 1), "deg": ("°", 2), "tangent": ("%", 2), "count": ("", 0)}
"""The unit of a report's column of each kind, and the decimals of values without an uncertainty."""


def unit_in_report(unit: SiUnit) -> tuple[str, int]:
    """Return the unit in which a report has values, and the decimals of those without an uncertainty."""
    return _COLUMNS[unit]


def with_u(name: str, unit: str, digits: int) -> tuple[Column, Column]:
    """Return the columns of a value and of its expanded uncertainty."""
    return Column(name, unit, digits), Column(f"U {name[0].lower()}{name[1:]}", unit, digits, is_u=True)


def columns_for(quantity: Quantity) -> tuple[Column, Column]:
    """Return the columns of a quantity and of its expanded uncertainty."""
    return with_u(quantity.title, *unit_in_report(quantity.unit))


def cells_of(quantity: Quantity, measured: Measured | None) -> tuple[Cell, Cell]:
    """Return the cells under :func:`columns_for`: the value to be rounded where its uncertainty is, and that."""
    scale, digits = quantity.notation.scale, unit_in_report(quantity.unit)[1]
    if measured is None:
        return None, None
    if scale == 1.0:
        return rounded((measured.value, measured.u), digits)
    return rounded((round(measured.value * scale, 6), round(measured.u * scale, 6)), digits)


def lengths(measured: Measured | None) -> tuple[float | None, float | None]:
    """Return a length and its uncertainty in millimetres."""
    return (None, None) if measured is None else (millimetres(measured.value), millimetres(measured.u))


def angles(measured: Measured | None) -> tuple[float | None, float | None]:
    """Return an angle and its uncertainty in degrees."""
    return (None, None) if measured is None else (measured.value, measured.u)


def rounded(pair: tuple[float | None, float | None], digits: int) -> tuple[Cell, Cell]:
    """Return the cells of a value and its uncertainty, the value to be rounded where its uncertainty is."""
    value, u = pair
    return (None if value is None else Number(value, places_of(u, digits))), u


def outside_counts(findings: Iterable[Finding]) -> str:
    """Return how many findings are outside their limit, and by how much: ``2 outside, 6 outside by less than U``."""
    verdicts = [found.verdict for found in findings]
    words = ((Verdict.OUTSIDE, "outside"), (Verdict.OUTSIDE_CLOSE, "outside by less than U"))
    return ", ".join(f"{n} {said}" for verdict, said in words if (n := verdicts.count(verdict)))


def pair(found: Statistics | None) -> str | None:
    """Return the two steps between which a statistic found the largest difference."""
    return None if found is None or found.at is None else f"{found.at[0]} and {found.at[1]}"


def numbers_of(steps: Iterable[int]) -> str:
    """Return step numbers as people list them: ``3``, ``3 and 4``, ``1-4, 7``."""
    found = sorted(steps)
    if len(found) == 2:
        return f"{found[0]} and {found[1]}"
    runs: list[list[int]] = []
    for number in found:
        if runs and number == runs[-1][-1] + 1:
            runs[-1].append(number)
        else:
            runs.append([number])
    return ", ".join(f"{run[0]}–{run[-1]}" if len(run) > 1 else str(run[0]) for run in runs)
