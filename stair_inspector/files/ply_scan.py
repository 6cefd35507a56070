"""Reading PLY: ascii and both binary byte orders, any scalar types; other elements and properties ignored.

numpy reads the body, not Open3D: Open3D returns uninitialised memory as points where a file is shorter than its header
states, and this module has to walk the elements anyway to find that out. Nor trimesh, which refuses binary files whose
faces differ in their number of corners.
"""

from io import BytesIO
from itertools import islice

import numpy as np

from stair_inspector.errors import ReadError
from stair_inspector.files.number_lines import NumberLines
from stair_inspector.files.ply_header import LINE_BYTES, PlyHeader, parse_ply_header
from stair_inspector.files.ply_lists import NO_LISTS, Lists, read_lines, read_rows
from stair_inspector.files.ply_vertices import vertex_columns, without_lists
from stair_inspector.files.raw_cloud import (
    READ_STAGE,
    TRUNCATED_HINT,
    RawCloud,
    RawMesh,
    ScanFormat,
    as_declared,
    check_rest_is_padding,
    cloud_from_columns,
    cut_note,
)
from stair_inspector.files.raw_mesh import mesh_of_polygons
from stair_inspector.model import Note

_MOST_COLUMNS = 1000


def is_ply(data: bytes) -> bool:
    """Return whether a file begins as PLY does."""
    return data[:4] in (b"ply", b"ply\n", b"ply\r", b"ply ", b"ply\t")


def read_ply(data: bytes) -> RawCloud | RawMesh:
    """Read the vertices of a PLY file, or its mesh where it has faces.

    Parameters
    ----------
    data : bytes
        The whole file.

    Returns
    -------
    RawCloud or RawMesh
        Ascii numbers as float64 whatever their declared floating type; binary ones as stored.

    Raises
    ------
    ReadError
        The header is damaged or does not fit the body: bytes or lines missing or left over, text that is no number,
        faces of vertices that are not there.
    """
    if b"\n" not in data[: LINE_BYTES * 16]:
        # Old Macintosh line ends; in a binary body nothing may be replaced, and its header is then refused.
        data = data.replace(b"\r", b"\n") if b"format ascii" in data[:LINE_BYTES] else data
    header = parse_ply_header(data)
    cloud, (corners, lengths) = _read_ascii(data, header) if header.format == "ascii" else _read_binary(data, header)
    return mesh_of_polygons(cloud, corners, lengths) if len(lengths) else cloud


def _read_ascii(data: bytes, header: PlyHeader) -> tuple[RawCloud, Lists]:
    vertex = header.vertex
    # One row of an element is one line; an element without properties has none.
    counts = [element.count if element.properties else 0 for element in header.elements]
    n_before = sum(counts[: header.elements.index(vertex)])
    n_expected_after = sum(counts) - n_before - vertex.count
    n_columns = len(vertex.scalars)
    n_written = n_columns if vertex.has_lists else max(n_columns, _words_of_row(data, header.body, n_before))
    lines = NumberLines(data, header.body, n_written, vertex.count, n_before, clean=without_lists(vertex))
    values, n_after, is_cut = lines.parse()
    if n_after != n_expected_after:
        hint = TRUNCATED_HINT if n_after < n_expected_after else "the header is wrong, export the scan again"
        raise ReadError(
            f"the lines after its {vertex.count} points should be {n_expected_after}, got {n_after}; {hint}"
        )
    columns = {
        item.name: as_declared(column, np.dtype(item.type))
        for item, column in zip(vertex.scalars, values.T[:n_columns], strict=True)
    }
    faces = NO_LISTS
    if header.face is not None:
        begin = sum(counts[: header.elements.index(header.face)])
        stream = BytesIO(data)
        stream.seek(header.body)
        faces = read_lines(list(islice(filter(bytes.strip, stream), begin, begin + header.face.count)), header.face)
        is_cut = not data.endswith((b"\n", b"\r"))
    notes = cut_note() if is_cut else ()
    if n_written > n_columns:
        which = f"column {n_written}" if n_written == n_columns + 1 else f"columns {n_columns + 1} to {n_written}"
        message = f"its header names {n_columns} columns but its lines have {n_written}: {which} ignored"
        notes += (Note("columns_ignored", READ_STAGE, message),)
    return cloud_from_columns(columns, notes), faces


def _words_of_row(data: bytes, body: int, n_before: int) -> int:
    """Return how many words the first row of the vertices has."""
    stream = BytesIO(data)
    stream.seek(body)
    row = next(islice(filter(bytes.strip, stream), n_before, None), b"")
    return len(row.split(None, _MOST_COLUMNS))


def _read_binary(data: bytes, header: PlyHeader) -> tuple[RawCloud, Lists]:
    at = begin = header.body
    faces = NO_LISTS
    for element in header.elements:
        begin = at if element is header.vertex else begin
        at, lists = read_rows(data, at, element)
        faces = lists if element is header.face else faces
    check_rest_is_padding(data[at:], header.vertex.count)
    return cloud_from_columns(vertex_columns(data, begin, header.vertex)), faces


FORMAT = ScanFormat(".ply", "'ply'", is_ply, read_ply)
