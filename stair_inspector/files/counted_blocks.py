"""Text in which lines of points follow a line that counts them: the blocks of PTX and PTS, one for each station."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stair_inspector.errors import ReadError
from stair_inspector.files.number_lines import NumberLines
from stair_inspector.files.raw_cloud import RED_GREEN_BLUE, as_whole, excerpt
from stair_inspector.files.raw_stations import MOST_STATIONS
from stair_inspector.geometry.arrays import Floats

_BOM = b"\xef\xbb\xbf"
_LONGEST_COUNT = 18
_MOST_NUMBERS = 4 * MOST_STATIONS
_FIRST_BYTES = 65_536
_REMARK = (b"#", b"//")
_CONTROL = re.compile(rb"[\x00-\x08\x0e-\x1f\x7f]")


@dataclass(frozen=True, slots=True)
class LoneNumber:
    """A line that holds one whole number and nothing else; its first byte, the first byte after it, lines before it."""

    value: int
    start: int
    end: int
    n_before: int


def with_newlines(data: bytes) -> bytes:
    """Return a text whose lines end with a newline, whichever of the usual ends they have."""
    return data if b"\n" in data else data.replace(b"\r", b"\n")


def begins_with_number(data: bytes) -> bool:
    """Return whether text begins, after remarks, with a line that holds one whole number."""
    first = data[len(_BOM) if data.startswith(_BOM) else 0 : _FIRST_BYTES]
    if _CONTROL.search(first):
        return False
    lines = (line.strip() for line in with_newlines(first).split(b"\n"))
    return next((line.isdigit() for line in lines if line and not line.startswith(_REMARK)), False)


def lone_numbers(data: bytes) -> list[LoneNumber]:
    """Return the lines that hold one whole number and nothing else; of very many only the first.

    Only lines too short for a point and its neighbours are looked at one by one.
    """
    ends = np.append(np.flatnonzero(np.frombuffer(data, dtype=np.uint8) == ord("\n")) + 1, len(data))
    starts = np.concatenate([[len(_BOM) if data.startswith(_BOM) else 0], ends[:-1]])
    found = []
    for k in np.flatnonzero((ends - starts > 1) & (ends - starts <= _LONGEST_COUNT)).tolist():
        line = data[starts[k] : ends[k]].strip()
        if line.isdigit():
            found.append(LoneNumber(int(line), int(starts[k]), int(ends[k]), k))
            if len(found) > _MOST_NUMBERS:
                break
    return found


def parse_block(body: bytes, count: int, n_before: int, what: str) -> tuple[Floats, bool]:
    """Return the rows (n, columns) of a block, and whether its last number may have been cut.

    Parameters
    ----------
    body : bytes
        From the first line of its points to the next block.
    count : int
        How many points are stated.
    n_before : int
        Lines of the file before it, for messages.
    what : str
        Which block it is, as ``station 2``.

    Raises
    ------
    ReadError
        Another number of lines than stated, a line that is not numbers, or fewer than three columns.
    """
    first = next((line for line in body[:_FIRST_BYTES].split(b"\n") if line.strip()), b"")
    n_columns = len(first.split())
    if not first or not count:
        if first or count:
            raise _miscounted(what, count, sum(1 for line in body.split(b"\n") if line.strip()))
        return np.zeros((0, 3)), False
    if not 3 <= n_columns <= 100:
        raise ReadError(
            f"line {n_before + 1} ('{excerpt(first.strip())}') has {n_columns} columns, a point needs x, y and z; "
            "export the scan again"
        )
    rows, _, is_cut = NumberLines(body, 0, n_columns, n_before=n_before).parse()
    if len(rows) != count:
        raise _miscounted(what, count, len(rows))
    return rows, is_cut


def _miscounted(what: str, count: int, n_found: int) -> ReadError:
    return ReadError(
        f"{what} states {count} points but {n_found} follow; the file is damaged or truncated, export the scan again"
    )


def named_columns(blocks: Sequence[Floats], roles: Sequence[str] = ()) -> tuple[dict[str, NDArray[Any]], int]:
    """Return the points of blocks as named columns, and how many further columns say nothing that is known.

    ``roles`` are what the first columns are, nothing for one that is not read. Without them, after x, y and z stand an
    intensity, colours of 0 to 255, or an intensity and colours.

    Raises
    ------
    ReadError
        The blocks have different columns, or fewer than roles.
    """
    widths = sorted({rows.shape[1] for rows in blocks if len(rows)})
    if len(widths) > 1:
        raise ReadError(
            f"its stations have {' and '.join(map(str, widths))} columns; export all of them with the same columns"
        )
    rows = np.concatenate([each for each in blocks if len(each)])
    if len(roles) > rows.shape[1]:
        raise ReadError(
            f"its lines have {rows.shape[1]} columns but --columns names {len(roles)}; name as many or fewer"
        )
    if roles:
        return {role: as_whole(column) for role, column in zip(roles, rows.T, strict=False) if role}, 0
    columns: dict[str, NDArray[Any]] = dict(zip("xyz", rows[:, :3].T, strict=True))
    n_rest = rows.shape[1] - 3
    if n_rest in (1, 4):
        columns["intensity"] = rows[:, 3]
    if n_rest in (3, 4):
        colors = [as_whole(column) for column in rows[:, -3:].T]
        if all(column.dtype.kind == "i" and column.min() >= 0 and column.max() <= 255 for column in colors):
            columns |= {name: column.astype(np.uint8) for name, column in zip(RED_GREEN_BLUE, colors, strict=True)}
            return columns, 0
    return columns, n_rest if n_rest > 1 else 0
