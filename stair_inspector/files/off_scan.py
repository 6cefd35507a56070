"""Reading OFF in text: vertices, with colours (COFF) or normals (NOFF), and polygons."""

import re

import numpy as np

from stair_inspector.errors import ReadError
from stair_inspector.files.number_rows import number_table
from stair_inspector.files.raw_cloud import (
    NORMAL_XYZ,
    RED_GREEN_BLUE,
    TRUNCATED_HINT,
    RawCloud,
    RawMesh,
    ScanFormat,
    as_whole,
    cloud_from_columns,
    cut_note,
    excerpt,
    parse_count,
)
from stair_inspector.files.raw_mesh import mesh_of_polygons
from stair_inspector.geometry.arrays import Ints

_BEGINNING = re.compile(rb"(ST)?(C)?(N)?(4)?(n)?OFF\s")
_INDEX_DIGITS = 12
_HINT = "export the mesh again"


def is_off(data: bytes) -> bool:
    """Return whether a file begins as OFF does."""
    return _BEGINNING.match(data) is not None


def read_off(data: bytes) -> RawCloud | RawMesh:
    """Read an OFF file.

    Raises
    ------
    ReadError
        Binary or of other dimensions, other counts than its lines, lines that are not numbers.
    """
    if b"\n" not in data:
        data = data.replace(b"\r", b"\n")
    found = _BEGINNING.match(data)
    kind = b"" if found is None else found.group().strip()
    if kind not in (b"OFF", b"COFF", b"NOFF", b"CNOFF") or data[len(kind) :].lstrip().startswith(b"BINARY"):
        raise ReadError(f"is OFF of the kind '{excerpt(kind)}' or binary, which is not read; export it as plain OFF")
    lines = [line for line in (raw.split(b"#")[0].strip() for raw in data[len(kind) :].split(b"\n")) if line]
    counts = lines[0].split() if lines else []
    if len(counts) not in (2, 3):
        raise ReadError(f"its OFF counts are '{excerpt(lines[0] if lines else b'')}' instead of three numbers; {_HINT}")
    n_vertices, n_faces = (parse_count(count.decode("latin-1"), "an OFF count") for count in counts[:2])
    if n_vertices + n_faces != len(lines) - 1:
        hint = TRUNCATED_HINT if n_vertices + n_faces > len(lines) - 1 else _HINT
        raise ReadError(
            f"states {n_vertices} OFF vertices and {n_faces} faces but {len(lines) - 1} lines follow; {hint}"
        )
    names = [*"xyz", *(NORMAL_XYZ if b"N" in kind else ()), *(RED_GREEN_BLUE if b"C" in kind else ())]
    table = number_table([line.split() for line in lines[1 : n_vertices + 1]], len(names), "OFF vertex")
    columns = {name: as_whole(table[:, k]) for k, name in enumerate(names)}
    is_cut = not data.endswith((b"\n", b"\r"))
    cloud = cloud_from_columns(columns, cut_note() if is_cut else ())
    return mesh_of_polygons(cloud, *_faces(lines[n_vertices + 1 :]))


def _faces(lines: list[bytes]) -> tuple[Ints, Ints]:
    """Return the corners and lengths of faces: a count, so many corners, then colours, which are left alone."""
    corners: list[int] = []
    lengths: list[int] = []
    for number, line in enumerate(lines, start=1):
        tokens = line.split()
        try:
            length = int(tokens[0])
            face = [int(token) for token in tokens[1 : length + 1] if len(token) <= _INDEX_DIGITS]
        except ValueError as error:
            raise ReadError(f"its OFF face {number} is '{excerpt(line)}', which is not numbers; {_HINT}") from error
        if length < 0 or len(face) != length:
            raise ReadError(f"its OFF face {number} states {length} corners but has '{excerpt(line)}'; {_HINT}")
        corners += face
        lengths.append(length)
    return np.array(corners, dtype=np.int64), np.array(lengths, dtype=np.int64)


FORMAT = ScanFormat(".off", "'OFF'", is_off, read_off, is_for_meshes=True)
