"""Binary PLY files of coloured points, byte for byte the same for the same input."""

import numpy as np

from stair_inspector.geometry.arrays import Colors, Floats


def ply_bytes(points: Floats, colors: Colors | None = None, *, double: bool = True) -> bytes:
    """Return a little-endian binary PLY file.

    Parameters
    ----------
    points : (n, 3)
        Coordinates, written in their own unit.
    colors : (n, 3) uint8, optional
        Red, green, blue.
    double : bool
        Write coordinates as float64; otherwise float32.
    """
    fields = [(axis, "<f8" if double else "<f4") for axis in "xyz"]
    if colors is not None:
        fields += [(channel, "u1") for channel in ("red", "green", "blue")]
    rows = np.zeros(len(points), dtype=fields)
    for axis, column in zip("xyz", points.T, strict=True):
        rows[axis] = column
    if colors is not None:
        for channel, column in zip(("red", "green", "blue"), colors.T, strict=True):
            rows[channel] = column
    kinds = {"<f8": "double", "<f4": "float", "u1": "uchar"}
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(points)}"]
    header += [f"property {kinds[kind]} {name}" for name, kind in fields]
    return ("\n".join([*header, "end_header"]) + "\n").encode("ascii") + rows.tobytes()
