"""An inspection and a check as a notebook shows them."""

import os
from collections.abc import Iterable
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING

from stair_inspector.codes import Check
from stair_inspector.content.comparisons import changes_table
from stair_inspector.content.document import Block, Bullets, Cell, Number, Paragraph, Status
from stair_inspector.content.examination import examination_lines
from stair_inspector.content.rule_tables import results_table
from stair_inspector.content.tables import flights_table, paper_table, steps_table
from stair_inspector.content.verdicts import verdict_sentence
from stair_inspector.interface.plain_table import PlainTable, TableCell, as_pandas
from stair_inspector.model import Flight, Inspection, Note, Observation, Scan, ScanComparison, Step
from stair_inspector.params import Params
from stair_inspector.quantities import IN_TABLE, SHOWN_OF_PAPER
from stair_inspector.writers.comparison import comparison_files, comparison_json_bytes
from stair_inspector.writers.csv import CSV_COLUMNS, csv_column, csv_rows
from stair_inspector.writers.html import notebook_html
from stair_inspector.writers.json import json_bytes
from stair_inspector.writers.record import hashes_of, write_files, write_record

if TYPE_CHECKING:
    import pandas

_OF_EVERY_STEP = ("step", "flight", "kind")


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class StairInspection:
    """What was measured of a scan; a notebook shows it as tables, with what was noted.

    ``inspection`` holds every value as the rooms of the program pass it on: lengths in metres, angles in degrees, each
    with its expanded uncertainty ``u`` (k = 2).

    Examples
    --------
    >>> import stair_inspector as si
    >>> found = si.measure("stair.ply", preset="tls")
    >>> found
    <StairInspection of stair.ply: 4 steps in 1 flight, by survey>
    >>> rise = found.steps[1].rise_m
    >>> abs(rise.value - 0.17) < rise.u
    True
    """

    scan: Scan
    inspection: Inspection

    @property
    def params(self) -> Params:
        """The settings with which it was measured."""
        return self.inspection.params

    @property
    def steps(self) -> tuple[Step, ...]:
        """The steps from bottom to top; none where no staircase was found."""
        return self.inspection.steps

    @property
    def flights(self) -> tuple[Flight, ...]:
        """The flights; the paper's method knows none."""
        return self.inspection.flights

    @property
    def notes(self) -> tuple[Note, ...]:
        """What should be known about the values, each a sentence."""
        return self.inspection.notes

    @property
    def questions(self) -> tuple[Observation, ...]:
        """What a setting has to answer before a value is given; ``cure`` says which."""
        return self.inspection.questions

    def table(self, *, every: bool = False) -> "pandas.DataFrame | PlainTable":
        """Return one row per step: lengths in millimetres, angles in degrees, the unit in each column's name.

        Parameters
        ----------
        every : bool
            All columns of the CSV that the command line writes, instead of the main quantities.

        Returns
        -------
        pandas.DataFrame or PlainTable
            A DataFrame where pandas is installed. The column ``rise_u_mm`` is the expanded uncertainty (k = 2) of
            ``rise_mm``, and so on. What was not measured is NaN; in a PlainTable it is None.

        Examples
        --------
        >>> import stair_inspector as si
        >>> table = si.measure("stair.ply", preset="tls").table()
        >>> list(table["kind"])
        ['tread', 'tread', 'tread', 'tread']
        >>> max(abs(rise - 170.0) for rise in table["rise_mm"]) < 2.0
        True
        """
        names = CSV_COLUMNS if every else [*_OF_EVERY_STEP, *self._main_columns()]
        places = [CSV_COLUMNS.index(name) for name in names]
        rows = tuple(tuple(row[place] for place in places) for row in csv_rows(self.inspection))
        return as_pandas(PlainTable(tuple(names), rows))

    def to_json(self) -> str:
        """Return what ``stair-inspector measure`` writes as ``STEM.json``: lengths in metres, schema inspection-1."""
        return json_bytes(self.inspection).decode("utf-8")

    def write(self, folder: str | os.PathLike[str]) -> list[Path]:
        """Write JSON, CSV, coloured PLY and their manifest, named as the scan, into a folder, and return their paths.

        Raises
        ------
        WriteError
            The folder cannot be made or written; files that existed are untouched.
        """
        return write_record(self.scan, self.inspection, Path(folder), Path(self.scan.name).stem, _now())

    def _main_columns(self) -> Iterable[str]:
        if self.params.method == "paper":
            return [csv_column(f"paper_{quantity.column}") for quantity in SHOWN_OF_PAPER]
        return [csv_column(name) for each in IN_TABLE for name in (each.column, f"{each.name}_u_{each.unit}")]

    def _headline(self) -> str:
        found = self.inspection
        if found.is_withheld:
            return f"{found.scan.name}: no values before this is answered: {found.questions[0].message}"
        if not found.steps:
            told = [note.message for note in found.notes if note.code == "no_staircase"]
            return f"{found.scan.name}: {told[0] if told else 'no step found'}"
        in_flights = f" in {_counted(len(found.flights), 'flight')}" if found.flights else ""
        method = "by survey" if found.params.method == "survey" else "by the paper's method"
        return f"{found.scan.name}: {_counted(len(found.steps), 'step')}{in_flights}, {method}"

    def __repr__(self) -> str:
        return f"<StairInspection of {self._headline()}>"

    def _repr_html_(self) -> str:
        found = self.inspection
        blocks: list[Block] = [Paragraph(self._headline())]
        if found.steps:
            blocks += [flights_table(found), steps_table(found, None)] if found.flights else [paper_table(found)]
        blocks.append(Bullets((*examination_lines(found), *(note.message for note in found.notes))))
        return notebook_html(blocks)


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class StairCheck:
    """An inspection held against a rule set; a notebook shows what was found rule by rule.

    ``check`` holds every finding. No words here say that a staircase meets a code; see :attr:`sentence`.
    """

    found: StairInspection
    check: Check

    @property
    def is_outside(self) -> bool:
        """Whether a measured value lies outside a limit; advisory rules do not count."""
        return self.check.is_outside

    @property
    def is_judged(self) -> bool:
        """Whether at least one value was held against a limit."""
        return self.check.is_judged

    @property
    def sentence(self) -> str:
        """What the check comes to; it claims no more than was measured."""
        return verdict_sentence(self.check)

    def table(self) -> "pandas.DataFrame | PlainTable":
        """Return one row per rule and flight: the value nearest to its limit or furthest beyond it.

        ``Measured``, its uncertainty ``U`` (k = 2) and the ``Margin`` to the limit are in the ``Unit`` of the row. A
        DataFrame where pandas is installed.
        """
        table = results_table(self.check)
        rows = tuple(tuple(map(_plain_cell, row)) for row in table.rows)
        return as_pandas(PlainTable(tuple(column.title for column in table.columns), rows))

    def to_json(self) -> str:
        """Return what ``stair-inspector measure --rules`` writes: the inspection, with its field ``check`` filled."""
        return json_bytes(self.found.inspection, self.check).decode("utf-8")

    def __repr__(self) -> str:
        return f"<StairCheck of {self.found.inspection.scan.name}: {self.sentence}>"

    def _repr_html_(self) -> str:
        return notebook_html([Paragraph(self.sentence), results_table(self.check)])


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class StairComparison:
    """What changed between two scans of one stair; a notebook shows it as the table of changes, with what was noted.

    ``comparison`` holds every change in metres and degrees, and the map of each tread.
    """

    comparison: ScanComparison

    @property
    def changed(self) -> tuple[int, ...]:
        """The steps, by their numbers in the earlier scan, of which anything changed."""
        return tuple(step.before_id for step in self.comparison.steps if step.is_changed)

    @property
    def sentences(self) -> tuple[str, ...]:
        """What changed, in words."""
        return tuple(note.message for note in self.comparison.notes)

    def table(self) -> "pandas.DataFrame | PlainTable":
        """Return one row per step, the changes as texts with their U; a DataFrame where pandas is installed."""
        table = changes_table(self.comparison)
        rows = tuple(tuple(map(_plain_cell, row)) for row in table.rows)
        return as_pandas(PlainTable(tuple(column.title for column in table.columns), rows))

    def to_json(self) -> str:
        """Return what ``stair-inspector compare -o`` writes: lengths in metres, schema comparison-1."""
        return comparison_json_bytes(self.comparison).decode("utf-8")

    def write(self, folder: str | os.PathLike[str]) -> list[Path]:
        """Write JSON, CSV and their manifest, named as the two scans, into a folder, and return their paths.

        Raises
        ------
        WriteError
            The folder cannot be made or written; files that existed are untouched.
        """
        both = self.comparison.before, self.comparison.after
        stem = "_".join(Path(scan.name).stem for scan in both)
        files = comparison_files(self.comparison)
        return write_files(Path(folder), stem, files, hashes_of(both), None, _now())

    def __repr__(self) -> str:
        found = self.comparison
        return f"<StairComparison of {found.before.name} and {found.after.name}: {'; '.join(self.sentences)}>"

    def _repr_html_(self) -> str:
        return notebook_html([Bullets(self.sentences), changes_table(self.comparison)])


def _plain_cell(cell: Cell) -> TableCell:
    return cell.value if isinstance(cell, Number) else cell.words if isinstance(cell, Status) else cell


def _now() -> datetime:
    return datetime.now().astimezone()


def _counted(count: int, what: str) -> str:
    return f"{count} {what}{'' if count == 1 else 's'}"
