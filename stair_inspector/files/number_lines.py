"""Lines of numbers in a text, as a table: strict, correctly rounded, and the first bad line named."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from io import BytesIO
from itertools import chain, islice

import numpy as np

from stair_inspector.errors import ReadError
from stair_inspector.files.raw_cloud import TRUNCATED_HINT, excerpt
from stair_inspector.geometry.arrays import Floats


@dataclass(frozen=True, slots=True, eq=False)
class NumberLines:
    """Lines of numbers in a file: where they begin, and what they must look like.

    ``start`` is the byte offset of the first line; ``skip`` the lines that belong to something else; ``n_rows`` how
    many lines to read, None for all; ``separator`` None means white space; ``n_before`` the lines of the file before
    ``data``. Columns that are ``ignored`` need not be numbers and become zeros. ``clean`` makes a line what numpy's
    reader takes, and nothing of one to be left out.
    """

    data: bytes
    start: int
    n_columns: int
    n_rows: int | None = None
    skip: int = 0
    separator: str | None = None
    n_before: int = 0
    ignored: frozenset[int] = frozenset()
    clean: Callable[[bytes], bytes] | None = None

    def _stream(self) -> BytesIO:
        stream = BytesIO(self.data)
        stream.seek(self.start)
        return stream

    def _lines(self, stream: BytesIO) -> Iterator[bytes]:
        stop = None if self.n_rows is None else self.skip + self.n_rows
        lines = filter(bytes.strip, stream)
        return islice(lines if self.clean is None else filter(None, map(self.clean, lines)), self.skip, stop)

    def rows(self) -> Iterator[bytes]:
        """Go through the lines of the table as they are parsed."""
        return self._lines(self._stream())

    def parse(self) -> tuple[Floats, int, bool]:
        """Parse the table.

        Returns
        -------
        values : (n, n_columns)
        n_after : int
            Lines after the table that are not blank; 0 where ``n_rows`` is None.
        is_cut : bool
            Whether the last number is the end of the file, without a line end: it may have lost digits.

        Raises
        ------
        ReadError
            A line with another number of columns or something that is not a number, by line number; fewer lines than
            ``n_rows``.

        Notes
        -----
        numpy's C reader: strict, correctly rounded, a quarter of a second for a million points. Open3D leaves
        uninitialised memory where an ascii body is too short and zeros where it is not a number.
        """
        stream = self._stream()
        lines = self._lines(stream)
        first = next(lines, None)
        if first is None:
            values: Floats = np.zeros((0, self.n_columns))
        else:
            try:
                values = np.loadtxt(
                    chain([first], lines),
                    dtype=np.float64,
                    comments=None,
                    delimiter=self.separator,
                    converters=dict.fromkeys(self.ignored, _zero) or None,
                    ndmin=2,
                    encoding="latin1",
                )
            except ValueError as error:
                raise self._explained() from error
            if values.shape[1] != self.n_columns:
                raise self._explained()
        if self.n_rows is not None and len(values) < self.n_rows:
            raise ReadError(f"its header states {self.n_rows} points but {len(values)} follow; {TRUNCATED_HINT}")
        is_cut = first is not None and stream.tell() >= len(self.data) and self._is_cut()
        return values, sum(1 for line in stream if line.strip()), is_cut

    def _is_cut(self) -> bool:
        """Return whether the file ends in the middle of a line of numbers."""
        last = self.data[self.data.rfind(b"\n") + 1 :]
        return not last.endswith(b"\r") and bool(last.strip() if self.clean is None else self.clean(last))

    def _explained(self) -> ReadError:
        """Return the error that names the first bad line."""
        separator = None if self.separator is None else self.separator.encode("ascii")
        number = self.n_before + self.data.count(b"\n", 0, self.start)
        row = -self.skip
        for written in self._stream():
            number += 1
            line = written if self.clean is None else self.clean(written)
            row += bool(line.strip())
            if not line.strip() or row <= 0:
                continue
            if self.n_rows is not None and row > self.n_rows:
                break
            tokens = line.split(separator)
            if len(tokens) != self.n_columns:
                return ReadError(
                    f"line {number} should have {self.n_columns} columns, got {len(tokens)} "
                    f"('{excerpt(written.strip())}'); correct the line or export the scan again"
                )
            bad = next((k for k, token in enumerate(tokens) if k not in self.ignored and not is_number(token)), None)
            if bad is not None:
                shown = excerpt(tokens[bad].strip()) if line == written else excerpt(written.strip())
                return ReadError(
                    f"line {number} holds '{shown}' where a number is expected; "
                    "correct the line or export the scan again"
                )
        return ReadError("holds a line that is not numbers; export the scan again")


def _zero(_: str) -> float:
    return 0.0


def is_number(token: bytes) -> bool:
    """Return whether numpy's reader takes a token for a number."""
    try:
        float(token)
    except ValueError:
        return False
    return b"_" not in token
