"""Elements of a PLY whose rows hold lists, such as faces: where each ends, and the corners of the faces."""

from itertools import islice

import numpy as np

from stair_inspector.errors import ReadError
from stair_inspector.files.ply_header import ELEMENT_HINT, PlyElement, PlyProperty
from stair_inspector.files.raw_cloud import TRUNCATED_HINT, excerpt, strided_column
from stair_inspector.geometry.arrays import Ints

Lists = tuple[Ints, Ints]
"""Values of lists (m,), row after row, and the length of each list (n,)."""
_Found = list[tuple[PlyProperty, int, int]]
"""Each list of a row: which, offset of its length in the row, and that length."""
NO_LISTS: Lists = (np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64))


def read_rows(data: bytes, at: int, element: PlyElement) -> tuple[int, Lists]:
    """Walk a binary element.

    Parameters
    ----------
    data : bytes
        The whole file.
    at : int
        Where the element begins.
    element : PlyElement
        As the header describes it.

    Returns
    -------
    end : int
        Offset after the element.
    faces : Lists
        The corners of its faces; empty where it has none.

    Raises
    ------
    ReadError
        The file ends before, or a list has a negative length.
    """
    _check_fits(data, at, element, element.count * element.smallest_row)
    if not element.has_lists or element.count == 0:
        return at + element.count * element.smallest_row, NO_LISTS
    stride = uniform_stride(data, at, element)
    if stride is not None:
        _, lists = walk_row(data, at, element)
        return at + element.count * stride, _uniform_faces(data, at, stride, element, lists)
    values, lengths, end = [], [], at
    faces = element.faces
    for _ in range(element.count):
        begin = end
        end, lists = walk_row(data, begin, element)
        for item, offset, length in lists:
            if item is faces:
                values.append(np.frombuffer(data, item.type, length, begin + offset + _length_bytes(item)))
                lengths.append(length)
    return end, (np.concatenate(values).astype(np.int64), np.array(lengths)) if values else NO_LISTS


def uniform_stride(data: bytes, at: int, element: PlyElement) -> int | None:
    """Return the bytes of a row where lists are equally long in all rows, as in nearly all meshes; else None."""
    end, lists = walk_row(data, at, element)
    stride = end - at
    if at + element.count * stride <= len(data) and all(
        (strided_column(data, str(item.count_type), element.count, at + offset, stride) == length).all()
        for item, offset, length in lists
    ):
        return stride
    return None


def _uniform_faces(data: bytes, at: int, stride: int, element: PlyElement, lists: _Found) -> Lists:
    """Return the faces of an element all of whose rows are like the first."""
    for item, offset, length in lists:
        if item is element.faces:
            table = np.ndarray(
                shape=(element.count, length),
                dtype=item.type,
                buffer=data,
                offset=at + offset + _length_bytes(item),
                strides=(stride, item.size),
            )
            return table.astype(np.int64).ravel(), np.full(element.count, length)
    return NO_LISTS


def _length_bytes(item: PlyProperty) -> int:
    return np.dtype(item.count_type).itemsize


def walk_row(data: bytes, at: int, element: PlyElement) -> tuple[int, _Found]:
    """Return the offset after one row, and the lists in it."""
    begin = at
    lists: _Found = []
    for item in element.properties:
        if item.count_type is not None:
            count_type = np.dtype(item.count_type)
            raw = data[at : at + count_type.itemsize]
            is_big = item.count_type.startswith(">")
            length = int.from_bytes(raw, "big" if is_big else "little", signed=count_type.kind == "i")
            if length < 0:
                raise ReadError(f"its PLY '{excerpt(element.name)}' has a list of length {length}; {ELEMENT_HINT}")
            lists.append((item, at - begin, length))
            at += count_type.itemsize + length * item.size
        else:
            at += item.size
        _check_fits(data, at, element, 0)
    return at, lists


def _check_fits(data: bytes, at: int, element: PlyElement, needed: int) -> None:
    if at + needed > len(data):
        raise ReadError(
            f"its header states {element.count} PLY '{excerpt(element.name)}' but the data ends before "
            f"({max(len(data) - at, 0)} bytes left); {TRUNCATED_HINT}"
        )


def read_lines(lines: list[bytes], element: PlyElement) -> Lists:
    """Return the faces of an ascii element, of which each line is a row.

    Raises
    ------
    ReadError
        A line is no row of the element, by its number among the faces.
    """
    values: list[int] = []
    lengths: list[int] = []
    faces = element.faces
    for number, line in enumerate(lines, start=1):
        tokens = iter(line.split())
        try:
            for item in element.properties:
                length = 1 if item.count_type is None else int(next(tokens))
                taken = list(islice(tokens, max(length, 0)))
                if len(taken) != length:
                    raise ValueError
                if item is faces:
                    values.extend(map(int, taken))
                    lengths.append(length)
            if next(tokens, None) is not None:
                raise ValueError
        except (ValueError, StopIteration) as error:
            message = f"its face {number} is '{excerpt(line.strip())}', which is no list of corners; {ELEMENT_HINT}"
            raise ReadError(message) from error
    try:
        return np.array(values, dtype=np.int64), np.array(lengths, dtype=np.int64)
    except OverflowError as error:
        raise ReadError(f"a face names a vertex with more digits than there are vertices; {ELEMENT_HINT}") from error
