"""A table of numbers whose columns have no names: what is told by their place and by what the numbers are like."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from stair_inspector.errors import ReadError
from stair_inspector.files.raw_cloud import NORMAL_XYZ, READ_STAGE, RED_GREEN_BLUE, RawCloud, cloud_from_columns
from stair_inspector.geometry.arrays import Floats
from stair_inspector.model import Note

_UNIT_TOLERANCE = 0.02
"""Normals are often written with two decimals."""
_RUNNING_ROWS = 10
_MANY_ROWS = 1000
"""So many points of a scan in whole millimetres share some of their x."""
_UNCLEAR = ", so it is not clear which columns are x, y and z"


def cloud_without_names(values: Floats, notes: Sequence[Note], unclear: Callable[[str, int], ReadError]) -> RawCloud:
    """Return the cloud of a table (n, 3 or more) without names: x y z, and behind them what the columns look like.

    ``unclear`` makes the error of a table of which it is not certain which columns are x, y and z, from what is seen
    and the place at which they may begin.
    """
    rest = values[:, 3:]
    n_rest = rest.shape[1]
    check_first_columns(values, unclear)
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
    if n_rest == 1 or used == 4:
        columns["intensity"] = rest[:, 0]
    # A fourth column is an intensity by custom; of anything else the user should know that it was not understood.
    if n_rest > max(used, 1):
        message = (
            f"{n_rest} columns after x, y, z were ignored: they are neither colours (whole numbers 0 to 255) nor unit "
            "normals; a first line that names the columns settles it"
        )
        notes = [*notes, Note("columns_ignored", READ_STAGE, message)]
    return cloud_from_columns(columns, notes)


def check_first_columns(values: Floats, unclear: Callable[[str, int], ReadError]) -> None:
    """Raise what ``unclear`` makes where the first three columns of a table may not be x, y and z."""
    doubt = _doubt(values)
    if doubt is not None:
        raise unclear(*doubt)


def _doubt(values: Floats) -> tuple[str, int] | None:
    """Return why the first three columns may not be x, y and z, and where those may begin; None where they are."""
    values = values[np.isfinite(values[:, :4]).all(axis=1)]
    if len(values) < _RUNNING_ROWS:
        return None
    is_whole = [bool((column == np.floor(column)).all()) for column in values.T]
    first, n_rest = values[:, 0], values.shape[1] - 3
    is_numbered = is_whole[0] and _numbers_rows(first)
    if not n_rest:
        if is_numbered and (not all(is_whole) or len(values) >= _MANY_ROWS):
            return f"its first column numbers the lines{_UNCLEAR}", 0
        return None
    n_whole = is_whole.index(False) if False in is_whole else len(is_whole)
    rest = values[:, 3:]
    is_known = n_rest in (3, 6) and (_are_normals(rest[:, :3]) or _are_colors(rest[:, :3]))
    is_alike = len(set(is_whole[1:4])) == 1
    # A time may stay while some points are taken; among x y z r g b it would leave two coordinates.
    is_rising = not is_known and is_alike and _rises(first)
    if is_numbered or is_rising or (n_whole == 1 and not any(is_whole[1:3])):
        return f"its first column numbers the lines or is a time{_UNCLEAR}", 1
    if n_whole in (1, 2):
        return f"only {n_whole} of its first three columns are whole numbers{_UNCLEAR}", n_whole
    are_last_normals = n_rest == 4 and _are_normals(rest[:, 1:])
    if n_rest >= 3 and n_whole >= 3 and not is_known and not are_last_normals:
        is_behind = n_whole <= n_rest and not any(is_whole[n_whole : n_whole + 3])
        if is_behind or (n_rest == 3 and _are_colors(values[:, :3])):
            return (
                f"its first columns are whole numbers such as colours or places in a grid{_UNCLEAR}",
                n_whole if is_behind else 3,
            )
    constant = next((k for k in range(3) if (values[:, k] == values[0, k]).all()), None)
    if constant is not None:
        return f"its column {constant + 1} is the same in all lines{_UNCLEAR}", constant + 1
    # A fourth column that is not whole may then be z as well as an intensity.
    if not is_known and not is_whole[3] and bool(((first >= 0.0) & (first <= 1.0)).all()):
        return f"its first column is between 0 and 1, as an intensity is{_UNCLEAR}", 1
    return None


def _numbers_rows(column: Floats) -> bool:
    """Return whether whole numbers are those of lines, in any order: each comes once, and they lie close."""
    return len(np.unique(column)) == len(column) and bool(np.ptp(column) < 2 * len(column))


def _rises(column: Floats) -> bool:
    """Return whether numbers never fall, but rise."""
    return bool((np.diff(column) >= 0.0).all()) and bool(column[-1] > column[0])


def _are_colors(values: Floats) -> bool:
    return bool(((values >= 0.0) & (values <= 255.0) & (values == np.floor(values))).all())


def _are_normals(values: Floats) -> bool:
    """Return whether rows are unit vectors, those aside that are zero or not finite: no normal at that point."""
    given = values[np.isfinite(values).all(axis=1) & values.any(axis=1)]
    # Larger components are no normals, and their squares might overflow.
    if not len(given) or np.abs(given).max() > 2.0:
        return False
    return bool((np.abs(np.sqrt((given * given).sum(axis=1)) - 1.0) <= _UNIT_TOLERANCE).all())
