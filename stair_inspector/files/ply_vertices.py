"""The vertices of a PLY as columns, also where their rows hold lists, as of the views that saw a point."""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stair_inspector.files.ply_header import PlyElement
from stair_inspector.files.ply_lists import uniform_stride, walk_row
from stair_inspector.files.raw_cloud import strided_column
from stair_inspector.geometry.arrays import Ints


def vertex_columns(data: bytes, begin: int, vertex: PlyElement) -> dict[str, NDArray[Any]]:
    """Return the scalar properties of a binary PLY's vertices, which have been found to lie in the file.

    Parameters
    ----------
    data : bytes
        The whole file.
    begin : int
        Where the vertices begin.
    vertex : PlyElement
        As the header describes them.
    """
    stride = uniform_stride(data, begin, vertex)
    if stride is not None:
        places = _places(data, begin, vertex)
        return {
            item.name: strided_column(data, item.type, vertex.count, begin + place, stride)
            for item, place in zip(vertex.scalars, places, strict=True)
        }
    offsets = np.zeros((vertex.count, len(vertex.scalars)), dtype=np.int64)
    at = begin
    for row in offsets:
        row[:] = _places(data, at, vertex)
        row += at
        at, _ = walk_row(data, at, vertex)
    raw = np.frombuffer(data, dtype=np.uint8)
    return {item.name: _gathered(raw, offsets[:, k], item.type) for k, item in enumerate(vertex.scalars)}


def _places(data: bytes, at: int, vertex: PlyElement) -> list[int]:
    """Return the offsets of the scalars in one row."""
    _, lists = walk_row(data, at, vertex)
    lengths = {item.name: length for item, _, length in lists}
    places, place = [], 0
    for item in vertex.properties:
        if item.count_type is None:
            places.append(place)
            place += item.size
        else:
            place += np.dtype(item.count_type).itemsize + lengths[item.name] * item.size
    return places


def _gathered(raw: NDArray[np.uint8], offsets: Ints, kind: str) -> NDArray[Any]:
    """Return the values of one type that lie at offsets."""
    size = np.dtype(kind).itemsize
    return np.ascontiguousarray(raw[offsets[:, None] + np.arange(size)]).view(kind).ravel()


def without_lists(vertex: PlyElement) -> Callable[[bytes], bytes] | None:
    """Return what leaves the lists out of a line of vertices; None where there are none."""
    return (
        partial(_scalars_of, [item.count_type is not None for item in vertex.properties]) if vertex.has_lists else None
    )


def _scalars_of(is_list: list[bool], line: bytes) -> bytes:
    """Return the single values of a row, parted by blanks; what is no such row comes back as a question mark."""
    words = line.split()
    kept, at = [], 0
    for holds_list in is_list:
        if at >= len(words):
            return b"?"
        if not holds_list:
            kept.append(words[at])
        elif words[at].isdigit() and len(words[at]) < 10:
            at += int(words[at])
        else:
            return b"?"
        at += 1
    return b" ".join(kept) if at == len(words) else b"?"
