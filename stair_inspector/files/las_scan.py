"""Reading LAS 1.0 to 1.4, and LAZ and COPC, which are LAS packed by LASzip; every point format.

The header is read here and compared with the file before lazrs unpacks anything: lazrs believes it, and took 4 GB for a
kilobyte of which one size was damaged.
"""

import struct
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stair_inspector.errors import ReadError
from stair_inspector.files.copc import cells_of_part, is_copc
from stair_inspector.files.file_part import WHOLE_FILE, FilePart
from stair_inspector.files.laz import unpack_cells, unpack_points
from stair_inspector.files.raw_cloud import (
    READ_STAGE,
    RED_GREEN_BLUE,
    TRUNCATED_HINT,
    RawCloud,
    ScanFormat,
    check_rest_is_padding,
    cloud_from_columns,
    strided_column,
)
from stair_inspector.geometry.arrays import Bools
from stair_inspector.model import Note

_HINT = "export the scan again"
_HEADER_BYTES, _HEADER_14_BYTES, _VLR_BYTES = 227, 375, 54
_MOST_VLRS = 10_000
_LENGTHS = (20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67)
"""Bytes of a point of each format; more are extra bytes of whoever wrote it."""
_INTENSITY_AT = 12
_RED_AT = {2: 20, 3: 28, 5: 28, 7: 30, 8: 30, 10: 30}
_FIRST_OF_14 = 6
"""The formats from here on have whole bytes for class and flags."""
_NOISE = (7, 18)
"""The classes of low and high noise."""


@dataclass(frozen=True, slots=True)
class LasHeader:
    """What the header states, checked: ``n_points`` of ``length`` bytes from ``begin`` on, of point format ``format``.

    Whole numbers times ``scale`` plus ``offset`` are the coordinates. ``laszip`` describes how LAZ was packed, None
    where it is not; ``is_last`` where nothing may follow the points.
    """

    format: int
    length: int
    begin: int
    n_points: int
    scale: tuple[float, float, float]
    offset: tuple[float, float, float]
    laszip: bytes | None
    is_last: bool


def is_las(data: bytes) -> bool:
    """Return whether a file begins as LAS does."""
    return data.startswith(b"LASF")


def read_las(data: bytes, part: FilePart = WHOLE_FILE) -> RawCloud:
    """Read a LAS, LAZ or COPC file.

    Parameters
    ----------
    data : bytes
        The whole file.
    part : FilePart
        Of a COPC, and of its scale's unit, no cells are unpacked but those that it needs.

    Returns
    -------
    RawCloud
        Without the points that the file withholds or classes as noise. With the scale as the step of its coordinates.
        Notes: ``part_read``, ``noise_dropped``, ``withheld_dropped``, ``synthetic_points``.

    Raises
    ------
    ReadError
        The header is damaged or does not fit what follows, LAZ is damaged or lazrs is missing, or no point is left.
    """
    header = parse_las_header(data)
    is_octree = header.laszip is not None and is_copc(data)
    if is_octree and (part.box is not None or part.detail_m):
        return replace(_cloud_of(*_unpack_part(data, header, part)), has_levels=True)
    count, length = header.n_points, header.length
    begin = header.begin
    records: bytes | bytearray = data
    if header.laszip is not None:
        records, begin = unpack_points(data, header.begin, header.laszip, count, length), 0
    elif header.is_last:
        check_rest_is_padding(data[begin + count * length :], count)
    return _cloud_of(records, begin, header)


def _unpack_part(data: bytes, header: LasHeader, part: FilePart) -> tuple[bytearray, int, LasHeader, list[Note]]:
    """Return the points of the cells of a COPC that a part needs, and what is said of the others."""
    cells = cells_of_part(data, part)
    count = sum(cell.count for cell in cells)
    if count > header.n_points:
        raise ReadError(f"its COPC octree holds {count} points, its header states {header.n_points}; {TRUNCATED_HINT}")
    records = unpack_cells(data, header.laszip or b"", cells, header.length)
    message = f"{count:,} of {header.n_points:,} points read: those of {len(cells):,} cells of the COPC"
    note = Note("part_read", READ_STAGE, message)
    return records, 0, replace(header, n_points=count), [note]


def _cloud_of(records: bytes | bytearray, begin: int, header: LasHeader, said: Sequence[Note] = ()) -> RawCloud:
    """Return the cloud of points as LAS has them."""
    count, length = header.n_points, header.length
    columns = {
        axis: strided_column(records, "<i4", count, begin + 4 * k, length) * header.scale[k] + header.offset[k]
        for k, axis in enumerate("xyz")
    }
    red_at = _RED_AT.get(header.format)
    if red_at is not None:
        channels = [strided_column(records, "<u2", count, begin + red_at + 2 * k, length) for k in range(3)]
        # A file that has fields for colours need not have colours.
        if any(channel.any() for channel in channels):
            columns |= dict(zip(RED_GREEN_BLUE, channels, strict=True))
    kept, notes = _kept(records, begin, header)
    columns["intensity"] = strided_column(records, "<u2", count, begin + _INTENSITY_AT, length)
    cloud = cloud_from_columns({name: column[kept] for name, column in columns.items()}, notes)
    return replace(cloud, notes=(*said, *cloud.notes), step=np.array(header.scale))


def _kept(records: bytes | bytearray, begin: int, header: LasHeader) -> tuple[Bools, list[Note]]:
    """Return which points (n,) are measured surfaces, and what is said of the others."""

    def byte(offset: int) -> NDArray[Any]:
        return strided_column(records, "u1", header.n_points, begin + offset, header.length)

    if header.format >= _FIRST_OF_14:
        classes, flags = byte(16), byte(15)
        synthetic, withheld = flags & 1, flags & 4
    else:
        classes = byte(15) & 31
        synthetic, withheld = byte(15) & 32, byte(15) & 128
    is_noise = np.isin(classes, _NOISE)
    is_withheld = withheld.astype(np.bool_)
    kept: Bools = ~(is_noise | is_withheld)
    of = f"of {header.n_points:,} points"
    if not kept.any():
        raise ReadError(f"all its {header.n_points:,} points are classed as noise or withheld; export without classes")
    notes = []
    if is_noise.any():
        message = f"{int(is_noise.sum()):,} {of} dropped: the file classes them as noise (7 or 18)"
        notes.append(Note("noise_dropped", READ_STAGE, message))
    if (is_withheld & ~is_noise).any():
        message = f"{int((is_withheld & ~is_noise).sum()):,} {of} dropped: the file withholds them"
        notes.append(Note("withheld_dropped", READ_STAGE, message))
    if synthetic[kept].any():
        message = f"{np.count_nonzero(synthetic[kept]):,} {of} are marked as synthetic, not measured; they are kept"
        notes.append(Note("synthetic_points", READ_STAGE, message))
    return kept, notes


def parse_las_header(data: bytes) -> LasHeader:
    """Parse and check the header of a LAS or LAZ file.

    Raises
    ------
    ReadError
        Cut off, an unknown version or point format, a scale of zero, or points that do not fit into the file.
    """
    if len(data) < _HEADER_BYTES:
        raise ReadError(f"its LAS header ends after {len(data)} of {_HEADER_BYTES} bytes; {TRUNCATED_HINT}")
    major, minor = data[24], data[25]
    if major != 1 or minor > 4:
        raise ReadError(f"is LAS version {major}.{minor}, read are 1.0 to 1.4; {_HINT}")
    header_size, begin, n_vlrs, kind, length, n_points = struct.unpack_from("<HIIBHI", data, 94)
    if minor == 4 and len(data) >= _HEADER_14_BYTES <= header_size:
        n_points = int.from_bytes(data[247:255], "little") or n_points
    form = kind & 0x3F
    if form >= len(_LENGTHS) or length < _LENGTHS[form]:
        raise ReadError(f"has LAS points of format {form} with {length} bytes, which there are none of; {_HINT}")
    scale, offset = struct.unpack_from("<3d", data, 131), struct.unpack_from("<3d", data, 155)
    if not np.isfinite([*scale, *offset]).all() or not all(1e-12 < step < 1e6 for step in scale):
        raise ReadError(f"has LAS scales {scale} and offsets {offset}, which are no lengths; {_HINT}")
    if n_points == 0:
        raise ReadError(f"its LAS header states 0 points; {_HINT}")
    if not _HEADER_BYTES <= header_size <= begin <= len(data):
        raise ReadError(f"its LAS points begin at byte {begin} of {len(data)}; {TRUNCATED_HINT}")
    laszip = _laszip_record(data, header_size, begin, n_vlrs) if kind & 0xC0 else None
    if laszip is None and begin + n_points * length > len(data):
        raise ReadError(
            f"its LAS header states {n_points} points of {length} bytes but {len(data) - begin} bytes follow; "
            f"{TRUNCATED_HINT}"
        )
    return LasHeader(form, length, begin, n_points, scale, offset, laszip, minor < 3)


def _laszip_record(data: bytes, at: int, end: int, n_vlrs: int) -> bytes:
    """Return the variable length record that says how the points are packed."""
    for _ in range(min(n_vlrs, _MOST_VLRS)):
        if at + _VLR_BYTES > end:
            break
        user = data[at + 2 : at + 18].rstrip(b"\0")
        number, size = struct.unpack_from("<HH", data, at + 18)
        at += _VLR_BYTES
        if user == b"laszip encoded" and number == 22204 and at + size <= end:
            return data[at : at + size]
        at += size
    raise ReadError(f"is LAZ without the record that says how it is packed; {TRUNCATED_HINT}")


FORMAT = ScanFormat(".las", "'LASF'", is_las, read_las, (".laz",), takes=("part",))
