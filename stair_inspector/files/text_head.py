"""What the lines above a table of points say: names and units of its columns, how many points, titles."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace

from stair_inspector.errors import ColumnsUnclear, ReadError
from stair_inspector.files.number_lines import is_number
from stair_inspector.files.raw_cloud import POINT_NAMES, READ_STAGE, excerpt, parse_count
from stair_inspector.files.text_columns import (
    AXES,
    Header,
    header_cells,
    header_of,
    names_degrees,
    unit_of_remark,
    unit_of_word,
    without_label,
)
from stair_inspector.files.text_dialect import is_remark
from stair_inspector.files.text_table import TextLine, TextTable
from stair_inspector.model import Note
from stair_inspector.params import KnownUnit
from stair_inspector.units import UNIT_NAMES

_SHOWN_LINES, _SHOWN_CHARACTERS = 6, 100
_REMARK_MARKS = b"#/;!% \t"


@dataclass(frozen=True, slots=True)
class TextHead:
    """What is known of a table: ``names`` of its columns, nothing for one that is not read, none where none are given.

    ``unit`` and ``count`` of the points where they are stated.
    """

    names: tuple[str, ...] = ()
    unit: KnownUnit | None = None
    count: int | None = None
    notes: tuple[Note, ...] = ()


def read_head(table: TextTable, columns: Sequence[str]) -> TextHead:
    """Return what the lines above a table say of it; ``columns`` are what the user says, and count more.

    Raises
    ------
    ColumnsUnclear
        A line names the columns, but not so that x, y and z are certain.
    ReadError
        A line above the table looks like a damaged row, the units differ, or the user names too many columns.
    """
    if len(columns) > table.n_columns:
        raise ReadError(
            f"its lines have {table.n_columns} columns ('{excerpt(table.rows[0].text)}') but --columns names "
            f"{len(columns)}; name as many or fewer"
        )
    header: Header | None = None
    count: int | None = None
    units: tuple[str, ...] = ()
    unnamed: TextLine | None = None
    titles: list[TextLine] = []
    # A header that is no remark goes before remarks, which may stand between it and the table.
    named = next((each for each in reversed(table.above) if not _is_remark(each, table) and _names(each, table)), None)
    for line in reversed(table.above):
        is_said = _is_remark(line, table)
        text = line.text.lstrip(_REMARK_MARKS) if is_said else line.text
        if header is None and named in (None, line):
            header = _header(text, table, is_certain=not (is_said or columns))
            if header is not None:
                continue
        if is_said:
            continue
        if count is None and not titles and text.isdigit():
            count = parse_count(text.decode("ascii"), "the number of points in its first line")
            continue
        if not titles and header is None:
            cells = header_cells(text, table.dialect.separator)
            if len(cells) == table.n_columns and not any(
                cell and unit_of_word(cell.strip("[]()")) is None for cell in cells
            ):
                units = tuple(cell.strip("[]()") for cell in cells)
                continue
            unnamed = _checked_title(line, table)
        titles.append(line)
    if header is None and unnamed is not None and not columns:
        if names_degrees(header_cells(unnamed.text, table.dialect.separator)):
            raise ReadError(
                f"line {unnamed.number} ('{excerpt(unnamed.text)}') names a latitude or longitude: degrees are not "
                "read; export the scan in metres"
            )
        raise unclear_columns(
            f"line {unnamed.number} ('{excerpt(unnamed.text)}') names the columns, but not x, y and z", table
        )
    names, unit = _names_and_unit(table, header, tuple(columns), units)
    notes = []
    if unit is not None:
        notes.append(Note("unit_in_header", READ_STAGE, f"the file says that its unit is {UNIT_NAMES[unit]}"))
    if titles:
        words = f"the line '{excerpt(titles[-1].text)}'" if len(titles) == 1 else f"{len(titles)} lines"
        notes.append(Note("title_skipped", READ_STAGE, f"{words} above the points not read: a title"))
    return TextHead(names, unit, count, tuple(notes))


def unclear_columns(message: str, table: TextTable, roles: Sequence[str] = (), at: int = 0) -> ColumnsUnclear:
    """Return the error that asks which columns are x, y and z, with the first lines and what the answer may be.

    ``roles`` are what a header makes of the columns, which may name an axis more than once; ``at`` is where x may be.
    """
    proposals = _proposals(table, roles, at)
    shown = [*table.above[-1:], *table.rows][:_SHOWN_LINES]
    return ColumnsUnclear(
        f"{message}; give --columns {' or --columns '.join(proposals)}, or add a first line that names the columns",
        tuple(excerpt(line.text, _SHOWN_CHARACTERS) for line in shown),
        proposals,
    )


def _proposals(table: TextTable, roles: Sequence[str], at: int) -> tuple[str, ...]:
    """Return what ``--columns`` may be given, at most two: columns that are named so, or that follow each other."""
    numbers = [k for k, is_number in enumerate(table.is_number) if is_number]
    named = itertools.product(*([k for k in numbers if roles[k : k + 1] == (axis,)] for axis in AXES))
    following = [(k, k + 1, k + 2) for k in numbers if {k + 1, k + 2} <= set(numbers)]
    likely = [each for each in following if each[0] == at]
    ordered = dict.fromkeys(itertools.chain(named, following[:1], likely, following[1:]))
    found = [*itertools.islice(ordered, 2)] or [tuple(numbers[:3])]
    return tuple(
        ",".join(AXES[places.index(k)] if k in places else "-" for k in range(max(places) + 1)) for places in found
    )


def _is_remark(line: TextLine, table: TextTable) -> bool:
    is_cell = line.text.startswith(b";") and table.dialect.separator == b";"
    return not is_cell and is_remark(line.text.lstrip())


def _header(text: bytes, table: TextTable, *, is_certain: bool) -> Header | None:
    """Return what a line names where it names the columns of the table; it does where ``is_certain``, or is refused."""
    text = without_label(text)
    cells = header_cells(text, table.dialect.separator)
    while len(cells) > table.n_columns and not cells[-1]:
        cells.pop()
    if len(cells) != table.n_columns:
        cells = header_cells(text, None)
    header = header_of(cells)
    # Numbers are no names: "E: 500000 N: 5000000 H: 100" is where the scan lies. One may be: pandas numbers them.
    n_numbers = sum(is_number(cell.encode()) for cell in cells)
    if not header.has_points or n_numbers > is_certain:
        return None
    if len(cells) == table.n_columns - 1:
        cells = [*cells, ""] if table.ends_empty else ["", *cells] if _has_row_names(table) else cells
        header = header_of(cells)
    if len(cells) == table.n_columns:
        return header
    if not is_certain:
        # A remark such as "# x y z in metres" is no header.
        return None
    raise unclear_columns(f"its header names {len(cells)} columns but its lines have {table.n_columns}", table)


def _names(line: TextLine, table: TextTable) -> bool:
    """Return whether a line names the columns of the table, as many as there are."""
    return _header(line.text, table, is_certain=False) is not None


def _has_row_names(table: TextTable) -> bool:
    """Return whether the first column names or numbers the rows: programs of statistics give it no name."""
    first = [cells[0] for cells in (table.dialect.split(row.text) for row in table.rows)]
    if table.is_text[0]:
        return True
    numbers = [float(cell) for cell in first if is_number(cell)]
    return len(numbers) == len(first) > 1 and all(b - a == 1.0 for a, b in itertools.pairwise(numbers))


def _checked_title(line: TextLine, table: TextTable) -> TextLine | None:
    """Return a line right above the table where it may name its columns; None of a title.

    Raises
    ------
    ReadError
        It looks like a row in which something is damaged.
    """
    kinds = table.dialect.numbers(line.text)
    if len(kinds) != table.n_columns:
        return None
    if sum(kinds) >= 2:
        bad = table.dialect.split(line.text)[kinds.index(False)]
        raise ReadError(
            f"line {line.number} holds '{excerpt(bad)}' where a number is expected; "
            "correct the line or export the scan again"
        )
    return line if not any(kinds) else None


def _names_and_unit(
    table: TextTable, header: Header | None, columns: tuple[str, ...], units: tuple[str, ...]
) -> tuple[tuple[str, ...], KnownUnit | None]:
    """Return the names of the columns, nothing for those that are not read, and the unit."""
    n = table.n_columns
    if header is None or len(header.roles) != n:
        header = Header(("",) * n, ("",) * n)
    if columns:
        header = replace(header, roles=(*columns, *[""] * (n - len(columns))))
    if units and not any(header.units):
        header = replace(header, units=units)
    twice = next((role for role in header.roles if role and header.roles.count(role) > 1), None)
    if twice in AXES:
        raise unclear_columns(
            f"its header names the column '{twice}' twice, or two that may be it", table, header.roles
        )
    if twice is not None:
        raise ReadError(f"its header names the column '{excerpt(twice)}' twice; correct the header")
    unit = header.unit() if header.has_points else unit_of_row(units)
    for line in table.above if unit is None else ():
        unit = unit or unit_of_remark(line.text)
    names = tuple(role if role in POINT_NAMES else "" for role in header.roles)
    return names if header.has_points else (), unit


def unit_of_row(units: Sequence[str]) -> KnownUnit | None:
    """Return the unit that a row of units above a table without names gives for all its columns; else None."""
    found = {unit_of_word(word) for word in units if word}
    return found.pop() if len(found) == 1 else None
