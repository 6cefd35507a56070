"""Reading PCD: ascii, binary and binary_compressed; colours packed in ``rgb`` or ``rgba`` of any type.

numpy reads the body, not Open3D: Open3D returns zeros for coordinates of type F 8, I 8 and U 8 in a binary PCD, and
uninitialised memory for the missing lines of an ascii one.
"""

import struct
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stair_inspector.errors import ReadError
from stair_inspector.files.lzf import lzf_decompress
from stair_inspector.files.number_lines import NumberLines
from stair_inspector.files.raw_cloud import (
    READ_STAGE,
    RED_GREEN_BLUE,
    TRUNCATED_HINT,
    RawCloud,
    ScanFormat,
    as_declared,
    check_rest_is_padding,
    cloud_from_columns,
    cut_note,
    excerpt,
    parse_count,
    strided_column,
)
from stair_inspector.model import Note

_KEYWORDS = ("VERSION", "FIELDS", "SIZE", "TYPE", "COUNT", "WIDTH", "HEIGHT", "VIEWPOINT", "POINTS", "DATA")
_NEEDED = ("FIELDS", "SIZE", "TYPE", "WIDTH", "HEIGHT", "DATA")
_STORAGES = ("ascii", "binary", "binary_compressed")
_SIZES = {"I": ("1", "2", "4", "8"), "U": ("1", "2", "4", "8"), "F": ("4", "8")}
_PACKED_COLORS = ("rgb", "rgba")
_PADDING = "_"
_HEADER_LINES = 200
_LINE_BYTES = 65_536
_HINT = "export the scan again"


@dataclass(frozen=True, slots=True)
class PcdField:
    """A field: lower-case name, numpy type code, values per point, bytes before it in a point's record."""

    name: str
    type: str
    count: int
    offset: int

    @property
    def size(self) -> int:
        """Bytes of the field in one point."""
        return np.dtype(self.type).itemsize * self.count


@dataclass(frozen=True, slots=True)
class PcdHeader:
    """A checked header: fields, number of points, storage, byte offset of the body."""

    fields: tuple[PcdField, ...]
    n_points: int
    storage: str
    body: int

    @property
    def stride(self) -> int:
        """Bytes of one point."""
        return sum(item.size for item in self.fields)


def is_pcd(data: bytes) -> bool:
    """Return whether a file begins as PCD does."""
    at = 0
    for _ in range(_HEADER_LINES):
        line = data[at : at + 64].lstrip()
        if line.startswith((b"# .PCD", b"VERSION ", b"FIELDS ", b"COLUMNS ")):
            return True
        end = data.find(b"\n", at, at + _LINE_BYTES)
        if end < 0 or not (line.startswith(b"#") or not data[at:end].strip()):
            return False
        at = end + 1
    return False


def parse_pcd_header(data: bytes) -> PcdHeader:
    """Parse and check the header of a PCD file.

    Raises
    ------
    ReadError
        Cut off, a line missing, repeated or unknown, lists of different lengths, unknown types, POINTS that is not
        WIDTH times HEIGHT.
    """
    entries: dict[str, list[str]] = {}
    at = 0
    for _ in range(_HEADER_LINES):
        end = data.find(b"\n", at, at + _LINE_BYTES)
        if end < 0:
            break
        line = data[at:end].strip()
        at = end + 1
        words = line.decode("latin-1").split()
        if not words or words[0].startswith("#"):
            continue
        keyword = "FIELDS" if words[0] == "COLUMNS" else words[0]
        if keyword not in _KEYWORDS or keyword in entries:
            problem = "twice" if keyword in entries else "which means nothing there"
            raise ReadError(f"its PCD header has the line '{excerpt(line)}', {problem}; {_HINT}")
        entries[keyword] = words[1:]
        if keyword == "DATA":
            return _checked_header(entries, at)
    raise ReadError(f"its PCD header does not end with a 'DATA' line; {TRUNCATED_HINT}")


def _checked_header(entries: Mapping[str, list[str]], body: int) -> PcdHeader:
    missing = [keyword for keyword in _NEEDED if keyword not in entries]
    if missing:
        raise ReadError(f"its PCD header has no {', '.join(missing)}; {_HINT}")
    width, height = (_single(entries, keyword) for keyword in ("WIDTH", "HEIGHT"))
    n_points = width * height
    stated = _single(entries, "POINTS") if "POINTS" in entries else n_points
    if stated != n_points:
        raise ReadError(f"its PCD header states {stated} POINTS but WIDTH x HEIGHT is {width} x {height}; {_HINT}")
    storage = " ".join(entries["DATA"])
    if storage not in _STORAGES:
        raise ReadError(f"its PCD data is '{excerpt(storage)}', known are {', '.join(_STORAGES)}; {_HINT}")
    names = [name.lower() for name in entries["FIELDS"]]
    counts = entries.get("COUNT", ["1"] * len(names))
    lengths = (len(names), len(entries["SIZE"]), len(entries["TYPE"]), len(counts))
    if len(set(lengths)) != 1 or not names:
        raise ReadError(f"its PCD FIELDS, SIZE, TYPE and COUNT have {lengths} entries instead of the same; {_HINT}")
    twice = [name for name in names if name != _PADDING and names.count(name) > 1]
    if twice:
        raise ReadError(f"its PCD header has the field '{excerpt(twice[0])}' twice; {_HINT}")
    fields: list[PcdField] = []
    offset = 0
    for name, size, kind, count in zip(names, entries["SIZE"], entries["TYPE"], counts, strict=True):
        if kind not in _SIZES or size not in _SIZES[kind]:
            raise ReadError(
                f"its PCD field '{excerpt(name)}' has the unknown type '{excerpt(f'{kind} {size}')}'; {_HINT}"
            )
        number = parse_count(count, f"the COUNT of PCD field '{excerpt(name)}'")
        if name in _PACKED_COLORS and (size, number) != ("4", 1):
            raise ReadError(f"its PCD field '{excerpt(name)}' has {size} x {number} bytes instead of 4; {_HINT}")
        if number != 1 and name in ("x", "y", "z"):
            raise ReadError(f"its PCD field '{excerpt(name)}' has COUNT {number} instead of 1; {_HINT}")
        fields.append(PcdField(name, f"<{kind.lower()}{size}", number, offset))
        offset += fields[-1].size
    return PcdHeader(tuple(fields), n_points, storage, body)


def _single(entries: Mapping[str, list[str]], keyword: str) -> int:
    return parse_count(" ".join(entries[keyword]), f"PCD {keyword}")


def read_pcd(data: bytes) -> RawCloud:
    """Read a PCD file.

    Parameters
    ----------
    data : bytes
        The whole file.

    Returns
    -------
    RawCloud
        Ascii numbers as float64 whatever their declared floating type; binary ones as stored. An organised cloud row
        by row. The viewpoint is not applied: it says where the sensor was, not how to move the points.

    Raises
    ------
    ReadError
        The header is damaged or does not fit the body: bytes or lines missing or left over, text that is no number,
        a compressed stream of another size.
    """
    header = parse_pcd_header(data)
    if header.n_points == 0:
        raise ReadError("its PCD header states 0 points; export the scan again")
    if header.storage == "ascii":
        return _read_ascii(data, header)
    n = header.n_points
    needed = n * header.stride
    if header.storage == "binary":
        _check_size(len(data) - header.body, needed, n)
        check_rest_is_padding(data[header.body + needed :], n)
        bits = {
            item.name: strided_column(data, _bits_type(item), n, header.body + item.offset, header.stride)
            for item in _scalars(header)
        }
    else:
        packed = _decompressed(data, header, needed)
        # Compressed points are stored field by field.
        bits = {
            item.name: strided_column(packed, _bits_type(item), n, item.offset * n, item.size)
            for item in _scalars(header)
        }
    return _cloud(bits, ())


def _scalars(header: PcdHeader) -> tuple[PcdField, ...]:
    return tuple(item for item in header.fields if item.count == 1 and item.name != _PADDING)


def _is_packed(item: PcdField) -> bool:
    return item.name in _PACKED_COLORS


def _bits_type(item: PcdField) -> str:
    # Packed colours are bits, whatever the declared type.
    return "<u4" if _is_packed(item) else item.type


def _check_size(got: int, needed: int, n_points: int) -> None:
    if got < needed:
        raise ReadError(
            f"its header states {n_points} points, {needed} bytes, but {max(got, 0)} bytes follow; {TRUNCATED_HINT}"
        )


def _decompressed(data: bytes, header: PcdHeader, needed: int) -> bytes:
    begin = header.body + 8
    _check_size(len(data) - header.body, 8, header.n_points)
    n_packed, n_unpacked = struct.unpack_from("<II", data, header.body)
    if n_unpacked != needed:
        raise ReadError(
            f"its header states {header.n_points} points, {needed} bytes, but its compressed data states {n_unpacked}; "
            "the file is damaged, copy or export it again"
        )
    _check_size(len(data) - begin, n_packed, header.n_points)
    check_rest_is_padding(data[begin + n_packed :], header.n_points)
    return lzf_decompress(data[begin : begin + n_packed], needed)


def _read_ascii(data: bytes, header: PcdHeader) -> RawCloud:
    values, n_after, is_cut = NumberLines(
        data, header.body, sum(item.count for item in header.fields), header.n_points
    ).parse()
    if n_after:
        raise ReadError(
            f"its header states {header.n_points} points but {header.n_points + n_after} lines follow; {_HINT}"
        )
    columns: dict[str, NDArray[Any]] = {}
    notes = cut_note() if is_cut else ()
    at = 0
    for item in header.fields:
        at += item.count
        if item.count != 1 or item.name == _PADDING:
            continue
        column = values[:, at - 1]
        if not _is_packed(item):
            columns[item.name] = as_declared(column, np.dtype(item.type))
            continue
        packed = _packed_from_ascii(column, np.dtype(item.type))
        if packed is None:
            notes += (Note("colors_dropped", READ_STAGE, f"colours dropped: not every {item.name} is a packed colour"),)
        else:
            columns[item.name] = packed
    return _cloud(columns, notes)


def _packed_from_ascii(column: NDArray[np.float64], dtype: np.dtype[Any]) -> NDArray[Any] | None:
    """Return the bits of packed colours written as numbers, or None where a number has no such bits."""
    if dtype.kind == "f":
        # "nan" stands for 2**23 different bit patterns: the colour is lost.
        if not np.isfinite(column).all() or np.abs(column).max() > float(np.finfo(np.float32).max):
            return None
        return column.astype(np.float32).view(np.uint32)
    whole = as_declared(column, dtype)
    return whole.view(np.uint32) if whole.dtype.kind in "iu" else None


def _cloud(columns: Mapping[str, NDArray[Any]], notes: tuple[Note, ...]) -> RawCloud:
    """Unpack the colours and build the cloud."""
    unpacked = dict(columns)
    for name in _PACKED_COLORS:
        packed = unpacked.pop(name, None)
        if packed is not None:
            for channel, shift in zip(RED_GREEN_BLUE, (16, 8, 0), strict=True):
                unpacked[channel] = ((packed >> np.uint32(shift)) & np.uint32(255)).astype(np.uint8)
    return cloud_from_columns(unpacked, notes)


FORMAT = ScanFormat(".pcd", "a PCD header", is_pcd, read_pcd)
