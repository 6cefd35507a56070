"""The unpacking of LAZ by lazrs, in blocks, after everything that lazrs would believe was checked."""

import struct
from collections.abc import Sequence
from io import BytesIO
from typing import Any

from stair_inspector.errors import ReadError
from stair_inspector.files.copc import CopcCell
from stair_inspector.files.raw_cloud import TRUNCATED_HINT, excerpt

_BLOCK = 500_000
_POINTS_PER_BYTE = 8
"""No scanner's points are packed tighter: a file that states more would fill the memory with copies of a point."""
_ITEM_BYTES = {6: 20, 7: 8, 8: 6, 9: 29, 10: 30, 11: 6, 12: 8, 13: 29}
_LAYERS = {10: 9, 11: 1, 12: 2, 13: 1}
"""Layers of the items of LAS 1.4; each extra byte has one too."""
_LAYERED_EXTRA = 14
_EXTRA_BYTES = (0, _LAYERED_EXTRA)
_VARIABLE = 0xFFFFFFFF
"""The chunk size of a file whose chunks differ, as those of COPC."""
_POINT_WISE, _CHUNKED, _LAYERED = 1, 2, 3
_HINT = "export the scan again, or as LAS"


def unpack_points(data: bytes, begin: int, record: bytes, n_points: int, length: int) -> bytearray:
    """Return the points of a LAZ file as LAS has them.

    Parameters
    ----------
    data : bytes
        The whole file.
    begin : int
        Where its points begin.
    record : bytes
        The LASzip record.
    n_points, length : int
        How many points of how many bytes are stated.

    Raises
    ------
    ReadError
        lazrs is missing, or the record or the packed points are damaged.
    """
    if n_points > _POINTS_PER_BYTE * len(data):
        raise ReadError(f"states {n_points} LAZ points in {len(data)} bytes, which cannot be; {TRUNCATED_HINT}")
    _check_record(record, length)
    _check_chunks(data, begin, record, n_points)
    lazrs = _lazrs()
    points = bytearray()
    try:
        stream = BytesIO(data)
        stream.seek(begin)
        unpacker = lazrs.LasZipDecompressor(stream, record)
        for first in range(0, n_points, _BLOCK):
            block = bytearray(min(_BLOCK, n_points - first) * length)
            unpacker.decompress_many(block)
            points += block
    except (lazrs.LazrsError, OSError, RuntimeError, ValueError, OverflowError) as error:
        raise _damaged(error) from error
    return points


def unpack_cells(data: bytes, record: bytes, cells: Sequence[CopcCell], length: int) -> bytearray:
    """Return the points of some cells of a COPC as LAS has them.

    Parameters
    ----------
    data : bytes
        The whole file.
    record : bytes
        The LASzip record.
    cells : sequence of CopcCell
        Each is a chunk of its own.
    length : int
        Bytes of a point.

    Raises
    ------
    ReadError
        As :func:`unpack_points`.
    """
    _check_record(record, length)
    lazrs = _lazrs()
    points = bytearray()
    for cell in cells:
        packed = data[cell.begin : cell.begin + cell.size]
        _check_layers(packed, 0, _items(record), 1)
        block = bytearray(cell.count * length)
        try:
            lazrs.decompress_points_with_chunk_table(packed, record, block, [(cell.count, cell.size)])
        except (lazrs.LazrsError, OSError, RuntimeError, ValueError, OverflowError) as error:
            raise _damaged(error) from error
        points += block
    return points


def _lazrs() -> Any:
    try:
        import lazrs
    except ImportError as error:
        raise ReadError(
            f"is LAZ, which needs the package lazrs ({excerpt(str(error))}); pip install lazrs, or export it as LAS"
        ) from error
    return lazrs


def _damaged(error: Exception) -> ReadError:
    return ReadError(f"its LAZ points are damaged ({excerpt(str(error))}); {TRUNCATED_HINT}")


def _check_record(record: bytes, length: int) -> None:
    """Check that the items of a point are known and as long as the point."""
    n_items = struct.unpack_from("<H", record, 32)[0] if len(record) >= 34 else 0
    if not n_items or len(record) < 34 + 6 * n_items:
        raise ReadError(f"its LAZ record is cut; {_HINT}")
    compressor = struct.unpack_from("<H", record)[0]
    items = _items(record)
    is_known = all(kind in _EXTRA_BYTES or _ITEM_BYTES.get(kind) == size for kind, size in items)
    # Points of 1.4 are packed in layers, and no others.
    is_layered = [kind in _LAYERS or kind == _LAYERED_EXTRA for kind, _ in items]
    is_known = is_known and all(each == (compressor == _LAYERED) for each in is_layered)
    if compressor not in (_POINT_WISE, _CHUNKED, _LAYERED) or not is_known or sum(size for _, size in items) != length:
        raise ReadError(f"its LAZ record packs points in a way that is not known; {_HINT}")


def _check_chunks(data: bytes, begin: int, record: bytes, n_points: int) -> None:
    """Check the table that says where the packed chunks begin."""
    if struct.unpack_from("<H", record)[0] == _POINT_WISE:
        return
    chunk_size = struct.unpack_from("<I", record, 12)[0]
    table = int.from_bytes(data[begin : begin + 8], "little", signed=True)
    if table == -1 and len(data) >= 8:
        # Whoever could not go back wrote it at the end.
        table = int.from_bytes(data[-8:], "little", signed=True)
    if not begin + 8 <= table <= len(data) - 8:
        raise ReadError(f"its LAZ chunk table lies at byte {table} of {len(data)}; {TRUNCATED_HINT}")
    n_chunks = struct.unpack_from("<I", data, table + 4)[0]
    expected = None if chunk_size == _VARIABLE else -(-n_points // max(chunk_size, 1))
    if chunk_size == 0 or n_chunks > len(data) or (expected is not None and n_chunks != expected):
        raise ReadError(f"its LAZ has {n_chunks} chunks of {chunk_size} for {n_points} points; {TRUNCATED_HINT}")
    if struct.unpack_from("<H", record)[0] == _LAYERED:
        _check_layers(data[:table], begin + 8, _items(record), n_chunks)


def _check_layers(packed: bytes, at: int, items: list[tuple[int, int]], n_chunks: int) -> None:
    """Check the sizes of the layers of each chunk: lazrs takes memory for what they state.

    A chunk is a point as it is, a count, the size of each layer, and the layers; the next one follows at once.
    """
    n_layers = sum(size if kind == _LAYERED_EXTRA else _LAYERS.get(kind, 0) for kind, size in items)
    head = sum(size for _, size in items) + 4
    for number in range(1, n_chunks + 1):
        begin = at + head + 4 * n_layers
        end = begin
        if begin <= len(packed):
            end += sum(struct.unpack_from(f"<{n_layers}I", packed, at + head))
        if end > len(packed):
            raise ReadError(f"its LAZ chunk {number} of {n_chunks} ends beyond the points; {TRUNCATED_HINT}")
        at = end


def _items(record: bytes) -> list[tuple[int, int]]:
    """Return kind and bytes of each item of a point."""
    n_items = struct.unpack_from("<H", record, 32)[0]
    return [struct.unpack_from("<HH", record, 34 + 6 * k) for k in range(n_items)]
