"""Reading text as people export it: XYZ, PTS, CSV and lists of surveyors, with or without names of the columns."""

import itertools
import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stair_inspector.errors import ReadError
from stair_inspector.files.number_lines import NumberLines
from stair_inspector.files.raw_cloud import (
    TRUNCATED_HINT,
    RawCloud,
    as_whole,
    cloud_from_columns,
    cut_note,
    excerpt,
)
from stair_inspector.files.text_columns import AXES
from stair_inspector.files.text_dialect import REMARKS, has_two_readings
from stair_inspector.files.text_head import read_head, unclear_columns
from stair_inspector.files.text_table import TextTable, find_table
from stair_inspector.files.text_thousands import may_part_thousands, thousands_in
from stair_inspector.files.unnamed_columns import cloud_without_names
from stair_inspector.geometry.arrays import Floats

_BOM = b"\xef\xbb\xbf"
_UTF16 = (b"\xff\xfe", b"\xfe\xff")
_SNIFFED_BYTES = 65_536
_CONTROL = re.compile(rb"[\x00-\x08\x0e-\x1f\x7f]")
_LOOKED_AT_ROWS = 1000
_ENDS = b"\x1a"
"""Old editors end a file with it."""


def is_text(data: bytes) -> bool:
    """Return whether the beginning of a file has no control characters."""
    return _CONTROL.search(data, 0, _SNIFFED_BYTES) is None


def read_text(data: bytes, columns: Sequence[str] = ()) -> RawCloud:
    """Read a text file of points, one a line.

    Parameters
    ----------
    data : bytes
        The whole file. UTF-8, with or without a byte order mark, or any other encoding that contains ASCII.
    columns : sequence of str
        What each column is, see :func:`stair_inspector.columns.parse_columns`; columns behind these are not read.
        Without any the file says it.

    Returns
    -------
    RawCloud
        Columns go by the header's names. Without names: x y z, then nothing, an intensity, three colours (whole
        numbers 0 to 255), three normals (unit length), an intensity and three colours, or colours and normals;
        anything else after x y z is ignored with a note, and so is what is no number before x or at the end. The unit
        is that of the header or of a remark. Notes: ``title_skipped``, ``unit_in_header``, ``columns_ignored``,
        ``last_line_unfinished``.

    Raises
    ------
    ColumnsUnclear
        It is not certain which columns are x, y and z.
    ReadError
        Binary data, a line with another number of columns or something that is not a number, commas that may part
        numbers or decimals, marks that part thousands, another number of lines than the first line states, fewer than
        three columns.
    """
    if data.startswith(_UTF16):
        raise ReadError("is UTF-16 text; save it as UTF-8")
    if data.endswith(_ENDS):
        data = data.rstrip(_ENDS)
    if not is_text(data):
        raise ReadError("is binary data, not a list of points in text; export the scan as PLY, PCD or XYZ")
    if b"\n" not in data:
        data = data.replace(b"\r", b"\n")
    table = find_table(data, len(_BOM) if data.startswith(_BOM) else 0)
    head = read_head(table, columns)
    if has_two_readings(table.dialect, [row.text for row in table.rows]) and not (head.names or columns):
        raise ReadError(
            f"seems to have decimal commas between commas ('{excerpt(table.rows[0].text)}'); write numbers with a "
            "decimal point, or give --columns x,y,z,... if each comma ends a number"
        )
    names = head.names or _numbers_alone(table)
    ignored = frozenset(k for k, name in enumerate(names) if not name)
    dialect = table.dialect
    separator = None if dialect.separator is None else dialect.separator.decode("ascii")
    has_remarks = any(data.find(mark, table.start) >= 0 for mark in (*REMARKS, b"\n;"))
    clean = None if dialect.is_plain and not has_remarks else dialect.clean
    lines = NumberLines(data, table.start, len(names), separator=separator, ignored=ignored, clean=clean)
    values, _, is_cut = lines.parse()
    _check_thousands(lines, table, names, values)
    if head.count is not None and head.count != len(values):
        hint = TRUNCATED_HINT if len(values) < head.count else "correct the count or export the scan again"
        raise ReadError(f"its first line states {head.count} points but {len(values)} follow; {hint}")
    notes = (*head.notes, *(cut_note() if is_cut else ()))
    if head.names:
        named = {name: as_whole(values[:, k]) for k, name in enumerate(names) if name}
        cloud = cloud_from_columns(named, notes)
    else:
        numbers = [k for k in range(len(names)) if k not in ignored]
        cloud = cloud_without_names(
            values[:, numbers],
            notes,
            lambda message, place: unclear_columns(message, table, at=numbers[min(place, len(numbers) - 1)]),
        )
    return replace(cloud, unit=head.unit)


def _check_thousands(lines: NumberLines, table: TextTable, names: Sequence[str], values: Floats) -> None:
    """Raise ReadError where marks that part thousands in coordinates were read as decimals."""
    numbers = [k for k, name in enumerate(names) if name]
    places = [names.index(axis) for axis in AXES] if set(AXES) <= set(names) else numbers[:3]
    coordinates = [values[:, k] for k in places]
    if not may_part_thousands(coordinates):
        return
    # Cells without a mark are whole numbers; other rows only tell how many digits stand behind a mark, as the first do.
    is_looked_at = np.any([each == np.rint(each) for each in coordinates], axis=0)
    is_looked_at[:_LOOKED_AT_ROWS] = True
    rows = (row.split(table.dialect.separator) for row in itertools.compress(lines.rows(), is_looked_at))
    found = thousands_in([row[k].strip() for k in places] for row in rows)
    if found is not None:
        shown = found.replace(b".", b",") if table.dialect.has_decimal_commas else found
        raise ReadError(
            f"seems to part the thousands of its coordinates ('{excerpt(shown)}' beside whole numbers without a mark); "
            "export the scan without marks between thousands"
        )


def _numbers_alone(table: TextTable) -> tuple[str, ...]:
    """Return a mark for each column of numbers in a table without names, nothing for names before and behind them.

    Raises
    ------
    ColumnsUnclear
        Text stands between the numbers, or the columns before them hold both.
    """
    kinds = list(zip(table.is_number, table.is_text, strict=True))
    first = table.is_number.index(True)
    last = table.n_columns - 1 - table.is_number[::-1].index(True)
    is_other = (not number and not text for number, text in kinds[:first])
    if any(is_other) or any(text for _, text in kinds[first:last]):
        raise unclear_columns("not all of its columns are numbers, and no line names them", table)
    # What is neither numbers nor names has a damaged row, which is found as it is read.
    return tuple("" if text else "number" for _, text in kinds)
