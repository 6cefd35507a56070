"""Reading STL: binary and ascii. Its triangles share no vertices, and it states neither unit nor colours."""

import re

import numpy as np
from numpy.typing import NDArray

from stair_inspector.errors import ReadError
from stair_inspector.files.number_rows import number_table
from stair_inspector.files.raw_cloud import TRUNCATED_HINT, RawMesh, ScanFormat
from stair_inspector.geometry.arrays import Floats

_HEADER_BYTES, _RECORD_BYTES = 84, 50
_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_SNIFFED_BYTES = 2000
_VERTEX = re.compile(rb"^[^\S\n]*vertex\s(.*)$", re.MULTILINE | re.IGNORECASE)


def is_stl(data: bytes) -> bool:
    """Return whether a file is STL: as long as its number of triangles says, or ``solid`` and a facet in text."""
    return _is_binary(data) or (data.startswith(b"solid") and b"facet" in data[:_SNIFFED_BYTES].lower())


def _is_binary(data: bytes) -> bool:
    # The first 80 bytes are free: some programs begin them with "solid" too.
    count = int.from_bytes(data[_HEADER_BYTES - 4 : _HEADER_BYTES], "little")
    end = _HEADER_BYTES + _RECORD_BYTES * count
    return count > 0 and end <= len(data) and not data[end:].strip(b"\0 \t\r\n")


def read_stl(data: bytes) -> RawMesh:
    """Read an STL file.

    Raises
    ------
    ReadError
        Text that ends before its last triangle does, or in which a vertex is not three numbers.
    """
    if _is_binary(data):
        count = int.from_bytes(data[_HEADER_BYTES - 4 : _HEADER_BYTES], "little")
        records = np.frombuffer(data, _RECORD, count, _HEADER_BYTES)
        return RawMesh(_as_doubles(records["corners"]))
    if b"\n" not in data:
        data = data.replace(b"\r", b"\n")
    rows = [found.group(1).split() for found in _VERTEX.finditer(data)]
    if not rows or len(rows) % 3 or b"endsolid" not in data[data.lower().rfind(b"vertex") :].lower():
        raise ReadError(f"ends after {len(rows)} STL vertices, before 'endsolid'; {TRUNCATED_HINT}")
    return RawMesh(number_table(rows, 3, "STL vertex").reshape(-1, 3, 3))


def _as_doubles(corners: NDArray[np.float32]) -> Floats:
    # A signalling NaN must not raise numpy's warning.
    with np.errstate(invalid="ignore"):
        return corners.astype(np.float64)


FORMAT = ScanFormat(
    ".stl",
    "'solid' and a facet, nor is it as long as its number of triangles says",
    is_stl,
    read_stl,
    is_for_meshes=True,
)
