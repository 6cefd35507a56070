"""Rows of words from a text file as a table of numbers, or the sentence that says which row is none."""

from collections.abc import Sequence

import numpy as np

from stair_inspector.errors import ReadError
from stair_inspector.files.number_lines import is_number
from stair_inspector.files.raw_cloud import excerpt
from stair_inspector.geometry.arrays import Floats


def number_table(rows: Sequence[Sequence[bytes]], width: int, what: str, kind: str = "mesh") -> Floats:
    """Return the first ``width`` words of each row as numbers (n, width).

    Parameters
    ----------
    rows : sequence of rows of words
        From a file.
    width : int
        Words that are needed.
    what : str
        What a row is, for the message.
    kind : str
        What is to be exported again.

    Raises
    ------
    ReadError
        A row with fewer words, or a word that is no number; by the number of the row.
    """
    if any(len(row) < width for row in rows):
        number, row = next((number, row) for number, row in enumerate(rows, start=1) if len(row) < width)
        raise ReadError(f"its {what} {number} has {len(row)} numbers instead of {width}; export the {kind} again")
    try:
        table = np.array([[float(word) for word in row[:width]] for row in rows], dtype=np.float64)
    except ValueError as error:
        number, bad = next(
            (number, word) for number, row in enumerate(rows, start=1) for word in row[:width] if not is_number(word)
        )
        raise ReadError(
            f"its {what} {number} holds '{excerpt(bad)}' instead of a number; export the {kind} again"
        ) from error
    return table.reshape(len(rows), width)
