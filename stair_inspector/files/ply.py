"""Binary PLY files of coloured points, byte for byte the same for the same input."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from stair_inspector.geometry.arrays import Colors, Floats

_KINDS = {"<f8": "double", "<f4": "float", "<i2": "short", "|u1": "uchar"}
"""PLY's words for the types of numpy that are written."""


def ply_bytes(
    points: Floats,
    colors: Colors | None = None,
    *,
    double: bool = True,
    fields: Mapping[str, NDArray[np.generic]] | None = None,
    comments: Sequence[str] = (),
) -> bytes:
    """Return a little-endian binary PLY file.

    Parameters
    ----------
    points : (n, 3)
        Coordinates, written in their own unit.
    colors : (n, 3) uint8, optional
        Red, green, blue.
    double : bool
        Write coordinates as float64; otherwise float32.
    fields : mapping of name to (n,)
        Further properties of each point, int16, uint8, float32 or float64; the name is PLY's.
    comments : sequence of str
        Lines of ascii for the header.
    """
    columns: dict[str, NDArray[np.generic]] = dict(zip("xyz", points.T.astype("<f8" if double else "<f4"), strict=True))
    if colors is not None:
        columns |= dict(zip(("red", "green", "blue"), colors.T, strict=True))
    columns |= fields or {}
    rows = np.zeros(len(points), dtype=[(name, column.dtype) for name, column in columns.items()])
    for name, column in columns.items():
        rows[name] = column
    header = ["ply", "format binary_little_endian 1.0", *(f"comment {text}" for text in comments)]
    header.append(f"element vertex {len(points)}")
    header += [f"property {_KINDS[column.dtype.str]} {name}" for name, column in columns.items()]
    return ("\n".join([*header, "end_header"]) + "\n").encode("ascii") + rows.tobytes()
