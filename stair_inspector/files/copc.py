"""COPC: LAZ whose points lie in the cells of an octree, so that a part of them can be unpacked, in any detail.

Each cell of a level holds a share of its points, evenly; the next level, of eight cells in each, those between. Points
that are about so far apart are those of all levels down to one.
"""

import struct
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from stair_inspector.errors import ReadError
from stair_inspector.files.file_part import FilePart
from stair_inspector.files.raw_cloud import TRUNCATED_HINT
from stair_inspector.geometry.arrays import Floats

_INFO_AT, _INFO_BYTES = 429, 160
"""COPC has its own record first, behind the header of LAS 1.4 and the head of the record."""
_MARK_AT, _MARK = 377, b"copc\0"
_ENTRY_BYTES = 32
_DEEPEST = 40
"""Levels: beyond, a cell of a country is smaller than an atom."""
_POINTS_PER_BYTE = 8


@dataclass(frozen=True, slots=True)
class CopcCell:
    """A cell with points: ``level`` 0 for the whole; ``count`` points packed in ``size`` bytes from ``begin`` on."""

    level: int
    begin: int
    size: int
    count: int


@dataclass(frozen=True, slots=True)
class _Octree:
    """Where the octree lies, ``low`` (3,) to ``low + side``, and the distance of the points of its first level."""

    low: tuple[float, ...]
    side: float
    spacing: float

    def corners_of(self, level: int, place: tuple[int, int, int]) -> tuple[Floats, Floats]:
        """Return the lowest and highest corner of a cell, coordinates of the file."""
        side = self.side / 2.0**level
        low = np.array(self.low) + side * np.array(place)
        return low, low + side


def is_copc(data: bytes) -> bool:
    """Return whether a LAZ file is a COPC too."""
    return data[_MARK_AT : _MARK_AT + len(_MARK)] == _MARK and len(data) >= _INFO_AT + _INFO_BYTES


def cells_of_part(data: bytes, part: FilePart) -> list[CopcCell]:
    """Return the cells in which the points of a part lie, in the order of the file.

    Parameters
    ----------
    data : bytes
        The whole file.
    part : FilePart
        Its box may cut cells; with a margin, cells that lie as near to it are found too. Its detail is met by the first
        level that is as fine, and by the finest where none is.

    Raises
    ------
    ReadError
        The octree is damaged, or no cell with points touches the box.
    """
    x, y, z, half, spacing, begin, size = struct.unpack_from("<5d2Q", data, _INFO_AT)
    if not (np.isfinite([x, y, z, half, spacing]).all() and half > 0.0 and spacing > 0.0):
        raise ReadError(f"its COPC octree of {half} and points {spacing} apart cannot be; {TRUNCATED_HINT}")
    octree = _Octree((x - half, y - half, z - half), 2.0 * half, spacing)
    found = []
    for level, place, cell in _entries(data, begin, size):
        # Of the points of the level above, the next ones lie half as far apart.
        if part.detail_m and level and octree.spacing / 2.0 ** (level - 1) <= part.detail_m:
            continue
        if part.box is not None:
            low, high = octree.corners_of(level, place)
            if (low > np.add(part.box[1], part.margin)).any() or (high < np.subtract(part.box[0], part.margin)).any():
                continue
        if cell.count:
            found.append(cell)
    if not found:
        raise ReadError("has no points in the box of --crop, which is in the file's own coordinates; give another")
    return sorted(found, key=lambda cell: cell.begin)


def _entries(data: bytes, begin: int, size: int) -> Iterator[tuple[int, tuple[int, int, int], CopcCell]]:
    """Yield level, place and cell of each entry of the octree's pages, each page once."""
    pages, seen = [(begin, size)], {begin}
    while pages:
        at, length = pages.pop()
        if length % _ENTRY_BYTES or not 0 <= at <= at + length <= len(data):
            raise ReadError(f"its COPC page of {length} bytes at byte {at} of {len(data)} cannot be; {TRUNCATED_HINT}")
        for level, i, j, k, where, n_bytes, count in struct.iter_unpack("<4iQ2i", data[at : at + length]):
            is_cell = 0 <= level <= _DEEPEST and all(0 <= place < 2**level for place in (i, j, k))
            if not is_cell or n_bytes < 0 or count < -1 or where + n_bytes > len(data):
                raise ReadError(f"its COPC cell {level}-{i}-{j}-{k} cannot be; {TRUNCATED_HINT}")
            if count >= 0:
                if count > _POINTS_PER_BYTE * n_bytes:
                    raise ReadError(
                        f"its COPC cell {level}-{i}-{j}-{k} states {count} points in {n_bytes} bytes; {TRUNCATED_HINT}"
                    )
                yield level, (i, j, k), CopcCell(level, where, n_bytes, count)
            elif where in seen:
                raise ReadError(f"its COPC page at byte {where} is named twice; {TRUNCATED_HINT}")
            else:
                seen.add(where)
                pages.append((where, n_bytes))
