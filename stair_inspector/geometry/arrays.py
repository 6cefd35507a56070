"""Array types, and the check at the door that makes an array safe to share."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from stair_inspector.errors import DegenerateGeometry

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Labels = NDArray[np.int16]
Colors = NDArray[np.uint8]
Bools = NDArray[np.bool_]
Point = tuple[float, float, float]
"""x, y, z."""


def own(array: Any, shape: tuple[int | None, ...], name: str, dtype: Any = np.float64) -> NDArray[Any]:
    """Return a contiguous read-only array of ``dtype``, checked for shape and finiteness; copied if it was writable.

    Parameters
    ----------
    array : array_like
        What was given.
    shape : tuple
        Expected lengths; None stands for any.
    name : str
        Field name for the message.
    dtype : numpy dtype
        Expected type of the elements.

    Raises
    ------
    DegenerateGeometry
        Wrong shape, or an element that is not finite.
    """
    taken = np.ascontiguousarray(array, dtype=dtype)
    if taken.ndim != len(shape) or any(
        want is not None and want != got for want, got in zip(shape, taken.shape, strict=True)
    ):
        raise DegenerateGeometry(f"{name}: expected shape {shape}, got {taken.shape}")
    if np.issubdtype(taken.dtype, np.floating) and not np.isfinite(taken).all():
        raise DegenerateGeometry(f"{name}: contains values that are not finite")
    base = taken.base
    is_lent = isinstance(base, np.ndarray) and base.flags.writeable
    # A read-only view is no protection when whoever holds what it looks at can still write there.
    if is_lent or (taken is array and taken.flags.writeable):
        taken = taken.copy()
    return freeze(taken)


def freeze(array: NDArray[Any]) -> NDArray[Any]:
    """Mark an array that its maker has just made, and nobody else holds, as read-only; return it."""
    array.flags.writeable = False
    return array


def project(rows: Floats, direction: Floats) -> Floats:
    """Return the dot product of every column of ``rows`` (d, n) with ``direction`` (d,).

    Summed row by row and not by a matrix product: BLAS splits that over threads, which makes the last bit depend on
    their number and the time on whatever else the machine does.
    """
    result: Floats = direction[0] * rows[0]
    for component, row in zip(direction[1:], rows[1:], strict=True):
        result += component * row
    return result


def scatter_of(rows: Floats) -> Floats:
    """Return the sums of squares and products (d, d) of centred rows (d, n); without BLAS, as :func:`project`."""
    scatter: Floats = np.einsum("in,jn->ij", rows, rows)
    return scatter
