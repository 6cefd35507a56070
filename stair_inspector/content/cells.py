"""Cells and columns that the tables of a report have in common, and words for what they hold."""

from collections.abc import Iterable

from stair_inspector.codes.findings import Finding, Verdict
from stair_inspector.content.document import Cell, Column, Number
from stair_inspector.model import Measured, Statistics
from stair_inspector.units import u_text

QUANTITY_WORDS: dict[str, str] = {
    "rise": "rise",
    "going": "going",
    "tread_depth": "tread depth",
    "width": "tread width",
    "nosing_overhang": "nosing overhang",
    "two_r_plus_g": "2R + G",
    "pitch": "pitch",
    "fall": "fall to the nosing",
    "cross_fall": "cross-fall",
    "tread_slope": "slope of treads",
    "landing_slope": "slope of landings",
    "flight_rise": "total rise",
    "flight_run": "total run",
    "n_risers": "number of risers",
    "other": "",
}
"""Our quantities, in words."""


def mm(value_m: float | None) -> float | None:
    """Return a length in millimetres, to the nanometre as in the CSV."""
    return None if value_m is None else round(value_m * 1000.0, 6)


def with_u(name: str, unit: str, digits: int) -> tuple[Column, Column]:
    """Return the columns of a value and of its expanded uncertainty."""
    return Column(name, unit, digits), Column(f"U {name[0].lower()}{name[1:]}", unit, digits, is_u=True)


def lengths(measured: Measured | None) -> tuple[float | None, float | None]:
    """Return a length and its uncertainty in millimetres."""
    return (None, None) if measured is None else (mm(measured.value), mm(measured.u))


def angles(measured: Measured | None) -> tuple[float | None, float | None]:
    """Return an angle and its uncertainty in degrees."""
    return (None, None) if measured is None else (measured.value, measured.u)


def places_of(u: float | None, digits: int) -> int:
    """Return the decimals of a value: those with which its uncertainty is shown, ``digits`` where it has none."""
    return len(u_text(u).partition(".")[2]) if u else digits


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
