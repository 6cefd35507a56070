"""How a text of points is written: what separates its columns, decimal points or commas, quotes, remarks, exponents."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

from stair_inspector.files.number_lines import is_number

MOST_COLUMNS = 1000
REMARKS = (b"#", b"//", b"!", b"%")
"""What a line of remarks begins with; also a semicolon, where that does not separate columns."""
_SEPARATORS = (b"\t", b";", b"|", b",", None)
"""None is white space. Earlier ones are believed first: a name may hold blanks, and a decimal comma is no separator."""
_CLEANED = re.compile(rb"[+-]?(?:\d+(?:\.\d+)?|\.\d+)(?:[eE][+-]?\d+)?|[+-]?(?:nan|inf)", re.IGNORECASE)
"""A number among decimal commas, those made points: "1," is none."""
_FORTRAN = re.compile(rb"[+-]?(?:\d+[.,]?\d*|[.,]\d+)[dD][+-]?\d+")
_WHOLE = re.compile(rb"[+-]?\d+")
_DECIMALS = re.compile(rb"\d+(?:[eE][+-]?\d+)?")
_INLINE = re.compile(rb"[ \t](?:#|//|!)")
_TO_E = bytes.maketrans(b"dD", b"ee")
_TO_POINT = bytes.maketrans(b",.", b".'")
"""A point among decimal commas would part thousands: no number then."""
_WITHIN_QUOTES = {
    separator: bytes(ord("_") if byte in b" \t#!%/" or bytes([byte]) == separator else byte for byte in range(256))
    for separator in _SEPARATORS
}


Kinds = tuple[bool, ...]
"""What holds of each column."""


@dataclass(frozen=True, slots=True)
class Dialect:
    """A way to write rows of numbers.

    ``separator`` of the columns, None for white space; ``is_quoted`` where cells may stand in quotes, ``is_fortran``
    where exponents may be a D, ``is_remarked`` where remarks may stand behind a row.
    """

    separator: bytes | None = None
    has_decimal_commas: bool = False
    is_quoted: bool = False
    is_fortran: bool = False
    is_remarked: bool = False

    def clean(self, line: bytes) -> bytes:
        """Return a line as numpy's reader takes it: without remarks and quotes; nothing of a remark alone."""
        # A cell at the end may be empty.
        line = line.strip(b" \r\n") if self.separator == b"\t" else line.strip()
        if is_remark(line) and not (self.separator == b";" and line.startswith(b";")):
            return b""
        if self.is_quoted and b'"' in line:
            parts = line.split(b'"')
            parts[1::2] = [self._unquoted(part) for part in parts[1::2]]
            line = b"".join(parts)
        if self.is_remarked:
            found = _INLINE.search(line)
            line = line[: found.start()].rstrip() if found else line
        if self.is_fortran:
            line = line.translate(_TO_E)
        # Commas between cells in quotes are no decimal ones.
        return line.translate(_TO_POINT) if self.has_decimal_commas and self.separator != b"," else line

    def _unquoted(self, part: bytes) -> bytes:
        """Return what stands in quotes as a cell without separators and blanks."""
        part = part.strip().translate(_TO_POINT) if self.has_decimal_commas else part.strip()
        return part.translate(_WITHIN_QUOTES[self.separator])

    @property
    def is_plain(self) -> bool:
        """Whether numpy's reader takes lines as they are, but for remarks."""
        return not (self.has_decimal_commas or self.is_quoted or self.is_fortran or self.is_remarked)

    def split(self, line: bytes) -> list[bytes]:
        """Return the cells of a line."""
        return [cell.strip() for cell in self.clean(line).split(self.separator)]

    def numbers(self, line: bytes) -> Kinds:
        """Return which cells of a line are numbers."""
        if self.has_decimal_commas:
            return tuple(_CLEANED.fullmatch(cell) is not None for cell in self.split(line))
        return tuple(is_number(cell) for cell in self.split(line))


def is_remark(line: bytes) -> bool:
    """Return whether a line is a remark, by what it begins with."""
    return line.startswith((*REMARKS, b";"))


def dialects_of(line: bytes, *, is_quoted: bool, is_remarked: bool) -> list[Dialect]:
    """Return the dialects in which a line has three numbers or more, those first that are believed first."""
    found = []
    for separator in _SEPARATORS:
        if separator is not None and separator not in line:
            continue
        for has_commas in (False, True):
            if has_commas and (b"," not in line or (separator == b"," and not is_quoted)):
                continue
            cells = Dialect(separator, is_quoted=is_quoted).split(line)
            if not 3 <= len(cells) <= MOST_COLUMNS:
                continue
            is_fortran = any(map(_FORTRAN.fullmatch, cells))
            each = Dialect(separator, has_commas, is_quoted, is_fortran, is_remarked)
            if sum(each.numbers(line)) >= 3:
                found.append(each)
    return found


def best_dialect(dialects: Sequence[Dialect], rows: Sequence[bytes]) -> tuple[Dialect, Kinds, Kinds]:
    """Return the dialect that suits the first rows of a table, which columns are numbers there, and which are none.

    A column that is neither is mixed. Where no dialect suits all rows it is one that suits the first.

    Parameters
    ----------
    dialects : sequence of Dialect
        Those of the first row, at least one.
    rows : sequence of bytes
        At least one.
    """
    best: tuple[Dialect, Kinds, Kinds] | None = None
    for each in dialects:
        kinds = [each.numbers(row) for row in rows]
        if any(len(kind) != len(kinds[0]) for kind in kinds):
            continue
        is_number = tuple(map(all, zip(*kinds, strict=True)))
        is_text = tuple(not any(kind) for kind in zip(*kinds, strict=True))
        if sum(is_number) < 3:
            continue
        if sum(is_number) + sum(is_text) == len(is_number):
            return each, is_number, is_text
        best = best or (each, is_number, is_text)
    if best is not None:
        return best
    first = max(dialects, key=lambda each: all(each.numbers(rows[0])))
    kind = first.numbers(rows[0])
    return first, kind, tuple(not is_number for is_number in kind)


def has_two_readings(dialect: Dialect, rows: Sequence[bytes]) -> bool:
    """Return whether commas may part numbers or their decimals: "1,5,2,25,3,75" is six numbers, or three.

    Of more columns it is so where pairs of them look like the parts of a number in every row: the second has no sign,
    and exponents, zeros in front or as many digits everywhere.
    """
    if dialect.separator != b"," or dialect.is_quoted:
        return False
    cells = [dialect.split(row) for row in rows]
    n_columns = min(map(len, cells))
    if n_columns >= 6 and n_columns % 2 == 0 and all(_WHOLE.fullmatch(cell) for row in cells for cell in row):
        return True
    columns = list(zip(*cells, strict=False))
    return any(
        all(
            _are_parts(whole, decimals)
            for whole, decimals in zip(columns[k : k + 5 : 2], columns[k + 1 : k + 6 : 2], strict=True)
        )
        for k in range(n_columns - 5)
    )


def _are_parts(whole: Sequence[bytes], decimals: Sequence[bytes]) -> bool:
    """Return whether two columns may be what stands before and behind decimal commas."""
    if not (all(map(_WHOLE.fullmatch, whole)) and all(map(_DECIMALS.fullmatch, decimals))):
        return False
    has_marks = any(cell.startswith(b"0") or not cell.isdigit() for cell in decimals if len(cell) > 1)
    return has_marks or (len(set(map(len, decimals))) == 1 and len(decimals[0]) > 1)
