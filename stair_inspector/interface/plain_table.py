"""A table for those who have no pandas, and the way to one for those who have."""

import math
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pandas

TableCell = str | int | float | None


@dataclass(frozen=True, slots=True, repr=False)
class PlainTable:
    """A table that prints well: ``columns`` are its names, each of ``rows`` has a cell for every column.

    The unit stands in a column's name: ``_mm``, ``_deg``. A cell is None where a value was not measured.
    """

    columns: tuple[str, ...]
    rows: tuple[tuple[TableCell, ...], ...]

    def __len__(self) -> int:
        return len(self.rows)

    def __getitem__(self, column: str) -> tuple[TableCell, ...]:
        """Return the cells of one column, from the first row to the last.

        Raises
        ------
        KeyError
            No column has this name.
        """
        if column not in self.columns:
            raise KeyError(column)
        number = self.columns.index(column)
        return tuple(row[number] for row in self.rows)

    def __repr__(self) -> str:
        lines = [self.columns, *(tuple(map(_shown, row)) for row in self.rows)]
        widths = [max(map(len, cells)) for cells in zip(*lines, strict=True)]
        return "\n".join(
            "  ".join(cell.rjust(width) for cell, width in zip(line, widths, strict=True)) for line in lines
        )

    def _repr_html_(self) -> str:
        head = "".join(f"<th>{escape(name)}</th>" for name in self.columns)
        rows = ("".join(f"<td>{escape(_shown(cell))}</td>" for cell in row) for row in self.rows)
        return (
            f"<table><thead><tr>{head}</tr></thead><tbody>{''.join(f'<tr>{row}</tr>' for row in rows)}</tbody></table>"
        )


def _shown(cell: TableCell) -> str:
    return "-" if cell is None else f"{cell:.2f}" if isinstance(cell, float) else str(cell)


def as_pandas(table: PlainTable) -> "pandas.DataFrame | PlainTable":
    """Return a table as a DataFrame, NaN where a number was not measured; as it is where pandas is not installed."""
    try:
        import pandas
    except ImportError:
        return table
    series = {}
    for name in table.columns:
        cells = table[name]
        is_text = any(isinstance(cell, str) for cell in cells)
        series[name] = [math.nan if cell is None and not is_text else cell for cell in cells]
    return pandas.DataFrame(series, columns=list(table.columns))
