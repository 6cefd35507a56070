"""The columns that the table of steps offers, the survey's and the paper's, and which of them an inspector looks at."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Literal, NamedTuple

from stair_inspector.errors import ConfigError, one_of
from stair_inspector.model import Inspection, Step
from stair_inspector.quantities import IN_TABLE, OF_STEP, SHOWN_OF_PAPER
from stair_inspector.quantity_types import PaperQuantity, Quantity
from stair_inspector.units import Unit
from stair_inspector.viewer.bridge.markup import hint_of

TableView = Literal["survey", "paper"]
"""Whose values the table shows."""
VIEWS: tuple[TableView, ...] = ("survey", "paper")


class StepColumn(NamedTuple):
    """A column: ``name`` in orders of the page, ``head`` and ``unit`` over it, what it is, and what it is sorted by.

    ``value`` takes a step and the one above it, None where there is none; ``of`` is the quantity whose values stand in
    it, None for what is no quantity.
    """

    name: str
    head: str
    unit: str
    hint: str
    value: Callable[[Step, Step | None], float | None]
    of: Quantity | PaperQuantity | None = None

    def unit_in(self, unit: Unit) -> str:
        """Return the unit over it where lengths are in a unit; residuals are told in millimetres at all times."""
        return unit if isinstance(self.of, Quantity) and self.of.unit == "m" else self.unit


def _of_survey(quantity: Quantity) -> StepColumn:
    def value(step: Step, above: Step | None) -> float | None:
        measured = quantity.of(step, above)
        return None if measured is None else measured.value

    head = quantity.head or quantity.label
    return StepColumn(quantity.name, head, quantity.notation.unit, hint_of(quantity), value, quantity)


def _of_paper(quantity: PaperQuantity) -> StepColumn:
    unit = quantity.notation.unit
    return StepColumn(
        quantity.name, quantity.symbol, unit, hint_of(quantity), lambda step, _: quantity.of_paper(step.paper), quantity
    )


_TOLD = tuple(quantity for quantity in OF_STEP if quantity.place is not None)
"""Those that reports tell step by step; the others are made for rule sets."""
RMS = StepColumn(
    "rms",
    "RMS",
    "mm",
    "Root mean square distance of the points from their plane, in mm; it is not the accuracy",
    lambda step, _: step.plane.rms_m,
)
COVERAGE = StepColumn(
    "coverage", "cov.", "", "Coverage: share of the tread that has points", lambda step, _: step.coverage
)
POINTS = StepColumn("points", "points", "", "Points of the tread's plane", lambda step, _: float(step.plane.n_points))

OFFERED: Mapping[TableView, tuple[StepColumn, ...]] = {
    "survey": (*map(_of_survey, _TOLD), RMS, COVERAGE, POINTS),
    "paper": (*map(_of_paper, SHOWN_OF_PAPER), POINTS, RMS),
}
"""All columns of a view, from the left; the steps' numbers stand before them at all times."""
USUAL: Mapping[TableView, frozenset[str]] = {
    "survey": frozenset({*(quantity.name for quantity in IN_TABLE), RMS.name, COVERAGE.name}),
    "paper": frozenset(column.name for column in OFFERED["paper"]),
}
"""The columns that are shown where an inspector has chosen none."""


@dataclass(frozen=True, slots=True)
class TableLook:
    """How the table of steps is looked at.

    ``view`` None shows the survey's values where there are any; ``folded`` flights list no steps; ``shown`` are the
    names of the chosen columns of a view; ``sorting`` is a column by which the steps are sorted, and whether the
    largest comes first. Sorted steps stand in one list, without the flights' headlines.
    """

    view: TableView | None = None
    folded: frozenset[int] = frozenset()
    shown: Mapping[TableView, frozenset[str]] = field(default_factory=lambda: dict(USUAL))
    sorting: tuple[str, bool] | None = None

    def columns(self, view: TableView) -> tuple[StepColumn, ...]:
        """Return the columns of a view that are shown, from the left."""
        return tuple(column for column in OFFERED[view] if column.name in self.shown[view])

    def sorted_by(self, view: TableView) -> tuple[StepColumn, bool] | None:
        """Return by which column the rows are sorted, and whether the largest comes first; None as they are climbed."""
        found = [column for column in self.columns(view) if self.sorting and column.name == self.sorting[0]]
        return (found[0], self.sorting[1]) if found and self.sorting else None

    def switched(self, view: TableView, name: str) -> "TableLook":
        """Return the look with a column of a view shown, or hidden where it is shown.

        Raises
        ------
        ConfigError
            There is no such column, or it is the last one.
        """
        one_of(name, (column.name for column in OFFERED[view]), "columns")
        shown = self.shown[view] ^ {name}
        if not shown:
            raise ConfigError("columns: the last one stays; show another one first")
        return replace(self, shown={**self.shown, view: shown})

    def resorted(self, view: TableView, name: str) -> "TableLook":
        """Return the look sorted by a column: the largest first, at the second time the smallest, then as climbed.

        Raises
        ------
        ConfigError
            There is no such column.
        """
        one_of(name, (column.name for column in OFFERED[view]), "sort")
        if self.sorting is None or self.sorting[0] != name:
            return replace(self, sorting=(name, True))
        return replace(self, sorting=(name, False) if self.sorting[1] else None)


USUAL_LOOK = TableLook()
"""That of a page which has just been opened."""


def shown_values(inspection: Inspection | None, wanted: TableView | None) -> TableView:
    """Return whose values the table shows: those wanted if the result has them, else the survey's where it was made."""
    if inspection is None or inspection.params.method == "paper":
        return "paper" if inspection is not None else wanted or "survey"
    return wanted or ("survey" if inspection.flights else "paper")
