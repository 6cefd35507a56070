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


def cloud_without_names(values: Floats, notes: Sequence[Note], unclear: Callable[[str], ReadError]) -> RawCloud:
    """Return the cloud of a table (n, 3 or more) without names: x y z, and behind them what the columns look like.

    ``unclear`` makes the error of a table of which it is not certain which columns are x, y and z.
    """
    rest = values[:, 3:]
    n_rest = rest.shape[1]
    check_first_column(values, unclear)
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


def check_first_column(values: Floats, unclear: Callable[[str], ReadError]) -> None:
    """Raise what ``unclear`` makes where the first of four or more columns numbers the lines or is a time."""
    first, others = values[:, 0], values[:, 1:3]
    if values.shape[1] > 3 and len(values) >= _RUNNING_ROWS:
        is_whole = bool((first == np.floor(first)).all()) and not (others == np.floor(others)).all(axis=0).any()
        if is_whole or bool((np.diff(first) > 0.0).all()):
            raise unclear(
                "its first column numbers the lines or is a time, so it is not clear which columns are x, y and z"
            )


def _are_colors(values: Floats) -> bool:
    return bool(((values >= 0.0) & (values <= 255.0) & (values == np.floor(values))).all())


def _are_normals(values: Floats) -> bool:
    """Return whether rows are unit vectors, those aside that are zero or not finite: no normal at that point."""
    given = values[np.isfinite(values).all(axis=1) & values.any(axis=1)]
    # Larger components are no normals, and their squares might overflow.
    if not len(given) or np.abs(given).max() > 2.0:
        return False
    return bool((np.abs(np.sqrt((given * given).sum(axis=1)) - 1.0) <= _UNIT_TOLERANCE).all())
