"""Reading text: XYZ, PTS and CSV, with or without a header line, separated by white space, commas or semicolons."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stair_inspector.errors import ReadError
from stair_inspector.files.raw_cloud import (
    NORMAL_XYZ,
    READ_STAGE,
    RED_GREEN_BLUE,
    TRUNCATED_HINT,
    NumberLines,
    RawCloud,
    as_whole,
    cloud_from_columns,
    cut_note,
    excerpt,
    is_number,
    parse_count,
)
from stair_inspector.geometry.arrays import Floats
from stair_inspector.model import Note

_BOM = b"\xef\xbb\xbf"
_UTF16 = (b"\xff\xfe", b"\xfe\xff")
_LINE_BYTES = 65_536
_SNIFFED_BYTES = 65_536
_MAX_COLUMNS = 1000
_CONTROL = re.compile(rb"[\x00-\x08\x0e-\x1f\x7f]")
_DECIMAL_COMMA = re.compile(rb"[+-]?\d+,\d+")
_LEADING_ZERO = re.compile(rb"(?:^|,)\s*0\d+\s*(?:,|$)", re.MULTILINE)
_ANY_SEPARATOR = re.compile(r"[,;\s]+")
_UNIT_TOLERANCE = 0.02
"""Normals are often written with two decimals."""
_RUNNING_ROWS = 10
_COMMA_HINT = "write numbers with a decimal point"


@dataclass(frozen=True, slots=True)
class _Preamble:
    """What stands before the numbers: header line (empty if none), stated count, offset and text of the first row."""

    header: bytes
    is_comment: bool
    count: int | None
    start: int
    row: bytes


def is_text(data: bytes) -> bool:
    """Return whether the beginning of a file has no control characters."""
    return _CONTROL.search(data, 0, _SNIFFED_BYTES) is None


def read_text(data: bytes) -> RawCloud:
    """Read a text file of points, one a line.

    Parameters
    ----------
    data : bytes
        The whole file. UTF-8, with or without a byte order mark, or any other encoding that contains ASCII.

    Returns
    -------
    RawCloud
        Columns go by the header's names. Without names: x y z, then nothing, an intensity, three colours (whole
        numbers 0 to 255), three normals (unit length), an intensity and three colours, or colours and normals;
        anything else after x y z is ignored with a note.

    Raises
    ------
    ReadError
        Binary data, decimal commas, a line with another number of columns or something that is not a number, another
        number of lines than the first line states, fewer than three columns.
    """
    if data.startswith(_UTF16):
        raise ReadError("is UTF-16 text; save it as UTF-8")
    if not is_text(data):
        raise ReadError("is binary data, not a list of points in text; export the scan as PLY, PCD or XYZ")
    if b"\n" not in data:
        data = data.replace(b"\r", b"\n")
    preamble = _read_preamble(data)
    separator = _find_separator(preamble.row, data[preamble.start : preamble.start + _SNIFFED_BYTES])
    n_columns = len(preamble.row.split(None if separator is None else separator.encode("ascii")))
    if not 3 <= n_columns <= _MAX_COLUMNS:
        raise ReadError(
            f"its lines have {n_columns} columns ('{excerpt(preamble.row)}'), a point needs x, y and z; "
            "export the scan again"
        )
    values, _, is_cut = NumberLines(data, preamble.start, n_columns, separator=separator).parse()
    if preamble.count is not None and preamble.count != len(values):
        hint = TRUNCATED_HINT if len(values) < preamble.count else "correct the count or export the scan again"
        raise ReadError(f"its first line states {preamble.count} points but {len(values)} follow; {hint}")
    notes = cut_note() if is_cut else ()
    names = _fitting_names(preamble, separator, n_columns)
    if names:
        columns = {name: as_whole(values[:, i]) for i, name in enumerate(names)}
        return cloud_from_columns(columns, notes)
    return _cloud_without_names(values, notes)


def _read_preamble(data: bytes) -> _Preamble:
    header = b""
    is_comment = True
    count = None
    at = len(_BOM) if data.startswith(_BOM) else 0
    number = 0
    while at < len(data):
        number += 1
        end = data.find(b"\n", at, at + _LINE_BYTES)
        if end < 0 and len(data) - at > _LINE_BYTES:
            raise ReadError(
                f"line {number} is longer than {_LINE_BYTES} characters; export the scan with a point a line"
            )
        line = data[at : len(data) if end < 0 else end].strip()
        start = at
        at = len(data) if end < 0 else end + 1
        if not line:
            continue
        if line.startswith((b"#", b"//")):
            remark = line.lstrip(b"#/")
            header = remark if _names_xyz(remark) else header
            continue
        tokens = [token for token in re.split(rb"[,;\s]+", line) if token]
        if len(tokens) == 1 and tokens[0].isdigit() and count is None:
            count = parse_count(tokens[0].decode("ascii"), "the number of points in its first line")
            continue
        if any(is_number(token) for token in tokens):
            return _Preamble(header, is_comment, count, start, line)
        if not is_comment or count is not None or not _names_xyz(line):
            raise ReadError(
                f"line {number} ('{excerpt(line)}') is neither numbers nor a header that names x, y and z; "
                "export the scan as PLY, PCD or XYZ"
            )
        header, is_comment = line, False
    raise ReadError("holds no points; export the scan again")


def _names(header: bytes, separator: str | None = None) -> tuple[str, ...]:
    """Return the names in a header line; None separates at white space, commas and semicolons alike."""
    text = header.decode("latin-1").lower()
    parts = _ANY_SEPARATOR.split(text) if separator is None else text.split(separator)
    names = [part.strip().strip('"').strip() for part in parts]
    return tuple(names if separator is not None else filter(None, names))


def _names_xyz(line: bytes) -> bool:
    return {"x", "y", "z"} <= set(_names(line))


def _find_separator(row: bytes, sample: bytes) -> str | None:
    """Return the separator that numpy's reader needs, None for white space; refuse decimal commas."""
    words = row.split()
    has_decimal_commas = (b";" in row and b"," in row) or (
        len(words) >= 3 and all(_DECIMAL_COMMA.fullmatch(word) for word in words)
    )
    if has_decimal_commas:
        raise ReadError(f"has decimal commas ('{excerpt(row)}'); {_COMMA_HINT}")
    if b";" in row:
        return ";"
    if b"," not in row:
        return None
    # "1,05,2,10,3,00" is three numbers with decimal commas, or six: a whole number never begins with a zero.
    if _LEADING_ZERO.search(sample) and b"." not in row:
        raise ReadError(f"seems to have decimal commas between commas ('{excerpt(row)}'); {_COMMA_HINT}")
    return ","


def _fitting_names(preamble: _Preamble, separator: str | None, n_columns: int) -> tuple[str, ...]:
    """Return one lower-case name for each column, or none; names may hold spaces where another separator is used."""
    names = _names(preamble.header, separator)
    names = names if len(names) == n_columns else _names(preamble.header)
    if names and len(names) != n_columns:
        if preamble.is_comment:
            # A remark such as "# x y z in metres" is no header.
            return ()
        raise ReadError(
            f"its header names {len(names)} columns but its lines have {n_columns}; "
            "correct the header or export the scan again"
        )
    twice = [name for name in names if names.count(name) > 1]
    if twice:
        raise ReadError(f"its header names the column '{excerpt(twice[0])}' twice; correct the header")
    return names


def _cloud_without_names(values: Floats, notes: Sequence[Note]) -> RawCloud:
    rest = values[:, 3:]
    n_rest = rest.shape[1]
    running = values[:, 0]
    if n_rest and len(values) >= _RUNNING_ROWS and (np.diff(running) == 1.0).all() and running[0] in (0.0, 1.0):
        raise ReadError(
            "its first column numbers the lines, so it is not clear which columns are x, y and z; "
            "add a first line that names the columns"
        )
    columns: dict[str, NDArray[np.float64] | NDArray[np.uint8]] = dict(zip("xyz", values.T, strict=False))
    used = 0
    if n_rest == 3 and _are_normals(rest):
        columns.update(zip(NORMAL_XYZ, rest.T, strict=True))
        used = 3
    elif n_rest in (3, 6) and _are_colors(rest[:, :3]) and (n_rest == 3 or _are_normals(rest[:, 3:])):
        columns.update(zip(RED_GREEN_BLUE, rest[:, :3].T.astype(np.uint8), strict=True))
        columns.update(zip(NORMAL_XYZ, rest[:, 3:].T, strict=n_rest == 6))
        used = n_rest
    elif n_rest == 4 and _are_colors(rest[:, 1:]):
        columns.update(zip(RED_GREEN_BLUE, rest[:, 1:].T.astype(np.uint8), strict=True))
        used = n_rest
    # A fourth column is an intensity by custom; of anything else the user should know that it was not understood.
    if n_rest > max(used, 1):
        message = (
            f"{n_rest} columns after x, y, z were ignored: they are neither colours (whole numbers 0 to 255) nor unit "
            "normals; a first line that names the columns settles it"
        )
        notes = [*notes, Note("columns_ignored", READ_STAGE, message)]
    return cloud_from_columns(columns, notes)


def _are_colors(values: Floats) -> bool:
    return bool(((values >= 0.0) & (values <= 255.0) & (values == np.floor(values))).all())


def _are_normals(values: Floats) -> bool:
    """Return whether rows are unit vectors, those aside that are zero or not finite: no normal at that point."""
    given = values[np.isfinite(values).all(axis=1) & values.any(axis=1)]
    # Larger components are no normals, and their squares might overflow.
    if not len(given) or np.abs(given).max() > 2.0:
        return False
    return bool((np.abs(np.sqrt((given * given).sum(axis=1)) - 1.0) <= _UNIT_TOLERANCE).all())
