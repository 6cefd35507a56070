"""Reading OBJ: vertices, with colours where they have any, and polygons; materials and textures are left alone."""

import re

import numpy as np

from stair_inspector.errors import ReadError
from stair_inspector.files.number_rows import number_table
from stair_inspector.files.raw_cloud import (
    RED_GREEN_BLUE,
    RawCloud,
    RawMesh,
    ScanFormat,
    as_whole,
    cloud_from_columns,
    cut_note,
    excerpt,
)
from stair_inspector.files.raw_mesh import mesh_of_polygons

_SNIFFED_BYTES = 65_536
_KEYWORDS = rb"v|vt|vn|vp|f|l|p|o|g|s|mg|mtllib|usemtl"
_BEGINNING = re.compile(rb"\A(?:\xef\xbb\xbf)?(?:[^\S\n]*(?:#[^\n]*)?\n)*[^\S\n]*(?:" + _KEYWORDS + rb")[ \t]")
"""Blanks do not match line ends too: a file of blank lines could be parted in very many ways."""
_VERTEX = re.compile(rb"(?:\A|\n)[ \t]*v[ \t]")
_INDEX_DIGITS = 12
_HINT = "export the mesh again"


def is_obj(data: bytes) -> bool:
    """Return whether a file begins as OBJ does: with one of its keywords, and a vertex before long."""
    head = data[:_SNIFFED_BYTES]
    return _BEGINNING.match(head) is not None and (_VERTEX.search(head) is not None or head.startswith(b"mtllib"))


def read_obj(data: bytes) -> RawCloud | RawMesh:
    """Read an OBJ file.

    Raises
    ------
    ReadError
        A vertex or a face that is not numbers, by line, or a face of vertices that are not there.
    """
    if b"\n" not in data:
        data = data.replace(b"\r", b"\n")
    # A backslash joins lines.
    data = data.replace(b"\\\r\n", b" ").replace(b"\\\n", b" ")
    rows: list[list[bytes]] = []
    corners: list[int] = []
    lengths: list[int] = []
    for number, line in enumerate(data.split(b"\n"), start=1):
        word, _, rest = line.strip().partition(b" ")
        if word == b"v":
            rows.append(rest.split())
        elif word == b"f":
            try:
                face = [_index(token, len(rows)) for token in rest.split()]
            except ValueError as error:
                raise ReadError(f"line {number} is '{excerpt(line.strip())}', which is no face; {_HINT}") from error
            corners += face
            lengths.append(len(face))
    cloud = _cloud(rows, not data.endswith((b"\n", b"\r")))
    return mesh_of_polygons(cloud, np.array(corners, dtype=np.int64), np.array(lengths, dtype=np.int64))


def _index(token: bytes, n_vertices: int) -> int:
    """Return the number from 0 of a corner: OBJ counts from 1, or backwards from the last vertex so far."""
    number = token.split(b"/", 1)[0]
    if len(number) > _INDEX_DIGITS:
        raise ValueError
    index = int(number)
    return index - 1 if index > 0 else n_vertices + index if index < 0 else -1


def _cloud(rows: list[list[bytes]], is_cut: bool) -> RawCloud:
    if not rows:
        raise ReadError(f"holds no vertices; {_HINT}")
    # A fourth number is a weight; six and seven are coordinates and a colour.
    width = 6 if all(len(row) >= 6 for row in rows) else 3
    table = number_table(rows, width, "vertex")
    columns = dict(zip((*"xyz", *RED_GREEN_BLUE), map(as_whole, table.T), strict=False))
    return cloud_from_columns(columns, cut_note() if is_cut else ())


FORMAT = ScanFormat(".obj", "a keyword of OBJ and its vertices ('v')", is_obj, read_obj, is_for_meshes=True)
