"""How does a quantity depend on a setting? Measured over the setting's range, to find a plateau.

One sweep serves every quantity.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from stair_inspector.declarations import Knob
from stair_inspector.errors import StairError
from stair_inspector.memo import Memo
from stair_inspector.model import Inspection, Scan
from stair_inspector.params import SETTINGS, Params
from stair_inspector.pipeline import inspect
from stair_inspector.quantities import IN_TABLE, RISE, paper_value, with_above

_SWEPT = tuple(quantity for quantity in IN_TABLE if quantity.unit == "m")
SWEPT_QUANTITIES = {
    "n_steps": "Number of steps",
    "n_levels": "Number of levels",
    **{f"mean_{quantity.column}": f"Mean {quantity.label}" for quantity in _SWEPT},
    "max_adjacent_rise_m": "Largest step to step, rise",
    "mean_u_rise_m": "Mean uncertainty of a rise (k = 2)",
}
"""What can be drawn, with its title. With the paper's method rise, going, depth and width are h, d_FF, d_FB and W."""
PLATEAU_M = 0.001
"""A length is on a plateau while it stays this near to its present value; a count while it stays the same."""

_VALUES = 17
_LOG_RATIO = 20.0
"""A range that spans this factor is swept by equal ratios, as eps_z from 1 to 100 mm."""


@dataclass(frozen=True, slots=True)
class SweepPoint:
    """What one value gives: ``quantities`` by name, None where not known, or the sentence why nothing."""

    value: float
    quantities: Mapping[str, float | None] = field(default_factory=dict)
    error: str = ""


@dataclass(frozen=True, slots=True)
class Sweep:
    """A setting swept over its range, as far as it has come: ``points`` ascend by value, ``n_wanted`` is their number.

    ``present`` is the setting's value in ``params``.
    """

    name: str
    params: Params
    present: float
    points: tuple[SweepPoint, ...]
    n_wanted: int

    @property
    def is_complete(self) -> bool:
        """Whether every value has been measured."""
        return len(self.points) == self.n_wanted


def sweep(
    scan: Scan,
    params: Params,
    name: str,
    memo: Memo,
    is_wanted: Callable[[], bool],
    on_point: Callable[[Sweep], None],
) -> Sweep:
    """Measure a scan at values over the whole range of a setting, those nearest to the present one first.

    Parameters
    ----------
    scan : Scan
        What is measured.
    params : Params
        The other settings.
    name : str
        Dotted name of a numeric setting.
    memo : Memo
        Not one that another thread uses; what the setting does not touch is computed once.
    is_wanted : callable
        Asked before each value; False ends the sweep.
    on_point : callable
        Called with the sweep so far after each value.

    Returns
    -------
    Sweep
        Not complete when it was no longer wanted. Where a value cannot be measured its point says why.

    Raises
    ------
    ConfigError
        There is no such numeric setting.
    """
    values = swept_values(SETTINGS.knob(name), params.value(name))
    present = float(params.value(name))
    here = values.index(present)
    kind = SETTINGS[name].kind
    result = Sweep(name, params, present, (), len(values))
    for value in sorted(values, key=lambda each: abs(values.index(each) - here)):
        if not is_wanted():
            return result
        point = _measure(scan, params.replaced(name, kind(value)), value, memo)
        points = tuple(sorted((*result.points, point), key=lambda each: each.value))
        result = replace(result, points=points)
        on_point(result)
    return result


def swept_values(knob: Knob, present: float) -> list[float]:
    """Return ascending values over a knob's range, on its steps, the present one among them.

    Examples
    --------
    >>> swept_values(Knob("n", 0.0, 4.0, 1.0), 2.5)
    [0.0, 1.0, 2.0, 2.5, 3.0, 4.0]
    """
    space = np.geomspace if is_log(knob) else np.linspace
    spread = space(knob.low, knob.high, _VALUES)
    on_steps = {round(round(float(value) / knob.step) * knob.step, 9) for value in spread}
    inside = {min(knob.high, max(knob.low, value)) for value in on_steps}
    return sorted(inside | {float(present)})


def plateau(found: Sweep, quantity: str) -> tuple[float, float] | None:
    """Return the range of values around the present one over which a quantity stays the same.

    The same is within :data:`PLATEAU_M` for a length and equal for a count. None where the present value gives nothing.
    """
    here = next((k for k, point in enumerate(found.points) if point.value == found.present), None)
    target = None if here is None else found.points[here].quantities.get(quantity)
    if here is None or target is None:
        return None
    tolerance = PLATEAU_M if quantity.endswith("_m") else 0.0

    def holds(k: int) -> bool:
        value = found.points[k].quantities.get(quantity)
        return value is not None and abs(value - target) <= tolerance

    low = high = here
    while low > 0 and holds(low - 1):
        low -= 1
    while high + 1 < len(found.points) and holds(high + 1):
        high += 1
    return found.points[low].value, found.points[high].value


def _measure(scan: Scan, params: Params, value: float, memo: Memo) -> SweepPoint:
    try:
        return SweepPoint(value, _quantities(inspect(scan, params, memo)))
    except StairError as error:
        return SweepPoint(value, error=str(error))


def _quantities(inspection: Inspection) -> dict[str, float | None]:
    is_paper = inspection.params.method == "paper"
    found: dict[str, float | None] = {"n_steps": len(inspection.steps), "n_levels": len(inspection.levels)}
    uncertainties = []
    for quantity in _SWEPT:
        values: list[float | None] = []
        for step, above in with_above(inspection.steps):
            measured = None if is_paper else quantity.of(step, above)
            values.append(paper_value(step, quantity) if is_paper else None if measured is None else measured.value)
            if quantity is RISE and measured is not None:
                uncertainties.append(measured.u)
        known = [value for value in values if value is not None]
        found[f"mean_{quantity.column}"] = float(np.mean(known)) if known else None
    adjacent = [each.rise.max_adjacent for each in inspection.flights if each.rise is not None]
    found["max_adjacent_rise_m"] = max((value for value in adjacent if value is not None), default=None)
    found["mean_u_rise_m"] = float(np.mean(uncertainties)) if uncertainties else None
    return found


def is_log(knob: Knob) -> bool:
    """Return whether a knob's range is swept, and drawn, by equal ratios."""
    return knob.low > 0.0 and knob.high / knob.low >= _LOG_RATIO
