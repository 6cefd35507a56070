"""Where the table of points in a text begins: below remarks, titles, a header and a number of points."""

import operator
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice

from stair_inspector.errors import ReadError
from stair_inspector.files.number_lines import is_number
from stair_inspector.files.raw_cloud import excerpt
from stair_inspector.files.text_columns import names_points
from stair_inspector.files.text_dialect import Dialect, Kinds, best_dialect, dialects_of, is_remark

_LINE_BYTES = 65_536
_SAMPLE_ROWS = 200
"""Rows by which a dialect is told; what differs further down is refused by its line."""
_MOST_ABOVE, _MOST_BETWEEN = 1000, 50
"""Lines above a table, and remarks between its first rows."""
_ANY_SEPARATOR = re.compile(rb"[,;\s]+")


@dataclass(frozen=True, slots=True)
class TextLine:
    """A line of a file, without blanks around: its number, counted from 1, and its offset."""

    number: int
    start: int
    text: bytes


@dataclass(frozen=True, slots=True)
class TextTable:
    """The table in a text: where it begins, how it is written, the lines ``above`` it and the first of its ``rows``.

    ``is_number`` and ``is_text`` tell of each column whether all, or none, of its cells in these rows are numbers.
    """

    start: int
    dialect: Dialect
    above: tuple[TextLine, ...]
    rows: tuple[TextLine, ...]
    is_number: Kinds
    is_text: Kinds

    @property
    def n_columns(self) -> int:
        """Cells of each row."""
        return len(self.is_number)

    @property
    def ends_empty(self) -> bool:
        """Whether rows end with a separator, behind which nothing stands."""
        return not any(self.dialect.split(row.text)[-1] for row in self.rows)


def lines_of(data: bytes, at: int, number: int = 0) -> Iterator[TextLine]:
    """Go through the lines of a text that are not blank, from an offset on that has so many lines before it.

    Raises
    ------
    ReadError
        A line is longer than a point could be.
    """
    while at < len(data):
        number += 1
        end = data.find(b"\n", at, at + _LINE_BYTES)
        if end < 0 and len(data) - at > _LINE_BYTES:
            raise ReadError(
                f"line {number} is longer than {_LINE_BYTES} characters; export the scan with a point a line"
            )
        start, at = at, len(data) if end < 0 else end + 1
        text = data[start:at].strip(b" \r\n")
        if text.strip():
            yield TextLine(number, start, text)


def find_table(data: bytes, at: int) -> TextTable:
    """Find the table of points in a text.

    Parameters
    ----------
    data : bytes
        The whole file.
    at : int
        Where its text begins.

    Raises
    ------
    ReadError
        No line has three numbers, or too many lines stand above the first that has.
    """
    is_quoted = b'"' in data
    is_remarked = any(blank + mark in data for blank in (b" ", b"\t") for mark in (b"#", b"//", b"!"))
    above: list[TextLine] = []
    for line in islice(lines_of(data, at), _MOST_ABOVE):
        dialects = dialects_of(line.text, is_quoted=is_quoted, is_remarked=is_remarked)
        if not dialects and is_remarked and any(mark in line.text for mark in b",;|\t"):
            # A mark within a cell, as in "Point #1,", begins no remark.
            dialects = dialects_of(line.text, is_quoted=is_quoted, is_remarked=False)
        if dialects and _begins(dialects, _rows(data, line, 2)):
            rows = _rows(data, line, _SAMPLE_ROWS)
            dialect, are_numbers, is_text = best_dialect(dialects, [row.text for row in rows])
            return TextTable(line.start, dialect, tuple(above), rows, are_numbers, is_text)
        above.append(line)
    raise _without_table(above)


def _rows(data: bytes, first: TextLine, most: int) -> tuple[TextLine, ...]:
    """Return the first rows of a table, remarks between them left out."""
    lines = islice(lines_of(data, first.start, first.number - 1), _MOST_BETWEEN + most)
    others = (line for line in lines if line.start != first.start and not is_remark(line.text.lstrip()))
    return (first, *islice(others, most - 1))


def _begins(dialects: Sequence[Dialect], rows: Sequence[TextLine]) -> bool:
    """Return whether the first of two lines is a row: nothing but numbers, or like the next."""
    if len(rows) == 1 or any(all(each.numbers(rows[0].text)) for each in dialects):
        return True
    for each in dialects:
        first, second = (each.numbers(row.text) for row in rows)
        if len(first) == len(second) and sum(map(operator.and_, first, second)) >= 3:
            return True
    return False


def _without_table(above: Sequence[TextLine]) -> ReadError:
    """Return the error of a text in which no table begins."""
    for line in above:
        words = [word for word in _ANY_SEPARATOR.split(line.text) if word]
        is_count = len(words) == 1 and words[0].isdigit()
        if is_remark(line.text.lstrip()) or is_count or names_points(line.text):
            continue
        if any(map(is_number, words)):
            return ReadError(
                f"its lines have {len(words)} columns ('{excerpt(line.text)}'), a point needs x, y and z; "
                "export the scan again"
            )
        return ReadError(
            f"line {line.number} ('{excerpt(line.text)}') is neither numbers nor a header that names x, y and z; "
            "export the scan as PLY, PCD or XYZ"
        )
    return ReadError("holds no points; export the scan again")
