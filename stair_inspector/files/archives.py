"""Unpacking a scan that lies in a gzip or a ZIP: one scan, and no more bytes than a scan could be packed into."""

import zipfile
import zlib
from collections.abc import Sequence
from gzip import BadGzipFile, GzipFile
from io import BytesIO
from pathlib import PurePosixPath
from typing import IO

from stair_inspector.errors import ReadError
from stair_inspector.files.raw_cloud import TRUNCATED_HINT, excerpt

ARCHIVE_SUFFIXES = (".gz", ".zip")
LARGEST_GROWTH = 200
"""Times its packed size that a scan may have; deflation could make 1,032 times as much of nothing."""
_LEAST_ALLOWED = 1_000_000
_LARGEST_BYTES = 4 * 2**30
_GZIP, _ZIP = b"\x1f\x8b", b"PK\x03\x04"
_EMPTY_ZIP = b"PK\x05\x06"
_METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
_ENCRYPTED = 1
_MOST_NAMED = 5


def is_archive(data: bytes) -> bool:
    """Return whether a file is packed by gzip or as ZIP."""
    return data.startswith((_GZIP, _ZIP, _EMPTY_ZIP))


def unpack_scan(data: bytes, name: str, suffixes: Sequence[tuple[str, ...]]) -> tuple[str, bytes]:
    """Return the name and the bytes of the scan in an archive.

    Parameters
    ----------
    data : bytes
        The whole archive.
    name : str
        Of the archive.
    suffixes : sequence of tuples of str
        Of scans, in lower case, the surest first: by these a scan is told from what lies beside it in a ZIP.

    Raises
    ------
    ReadError
        Damaged, encrypted, packed by another method, no scan or several, another archive in it, or more bytes than
        LARGEST_GROWTH times those of the archive.
    """
    try:
        if data.startswith(_GZIP):
            inside = name.removesuffix(".gz")
            with GzipFile(fileobj=BytesIO(data)) as stream:
                unpacked = _limited(stream, len(data))
        else:
            with zipfile.ZipFile(BytesIO(data)) as archive:
                chosen = _chosen(archive.infolist(), suffixes)
                inside = PurePosixPath(chosen.filename).name
                with archive.open(chosen) as member:
                    unpacked = _limited(member, len(data))
    except (zipfile.BadZipFile, BadGzipFile, EOFError, zlib.error, OSError, NotImplementedError, ValueError) as error:
        raise ReadError(f"is a damaged archive ({excerpt(str(error))}); {TRUNCATED_HINT}") from error
    if is_archive(unpacked):
        raise ReadError(f"holds another archive ('{excerpt(inside)}'); unpack it first")
    if not unpacked:
        raise ReadError(f"holds an empty file ('{excerpt(inside)}'); pack the scan again")
    return inside, unpacked


def most_unpacked(n_packed: int) -> int:
    """Return the bytes that a scan packed into ``n_packed`` may have."""
    return min(max(LARGEST_GROWTH * n_packed, _LEAST_ALLOWED), _LARGEST_BYTES)


def _limited(stream: IO[bytes] | GzipFile, n_packed: int) -> bytes:
    """Return all of a stream, unless it is larger than a scan packed into so many bytes could be."""
    limit = most_unpacked(n_packed)
    unpacked = stream.read(limit + 1)
    if len(unpacked) > limit:
        raise ReadError(
            f"unpacks to more than {limit:,} bytes, the most that are read of a packed scan of its size; "
            "unpack it and give the scan itself"
        )
    return unpacked


def _chosen(members: Sequence[zipfile.ZipInfo], suffixes: Sequence[tuple[str, ...]]) -> zipfile.ZipInfo:
    """Return the one scan among the members of a ZIP."""
    files = files_in(members)
    of_kinds = ([each for each in files if each.filename.lower().endswith(kind)] for kind in suffixes)
    scans = files if len(files) == 1 else next(filter(None, of_kinds), [])
    if len(scans) != 1:
        named = ", ".join(excerpt(each.filename) for each in (scans or files)[:_MOST_NAMED])
        more = f" and {len(scans or files) - _MOST_NAMED} more" if len(scans or files) > _MOST_NAMED else ""
        what = f"{len(scans)} scans ({named}{more})" if scans else f"no scan ({named or 'no file'}{more})"
        raise ReadError(f"is a ZIP archive that holds {what}; unpack it and give the scan to be measured")
    chosen = scans[0]
    if chosen.flag_bits & _ENCRYPTED:
        raise ReadError("is a ZIP archive with a password; unpack it and give the scan itself")
    if chosen.compress_type not in _METHODS:
        raise ReadError("is a ZIP archive packed by a method other than deflate; unpack it and give the scan itself")
    return chosen


def files_in(members: Sequence[zipfile.ZipInfo]) -> list[zipfile.ZipInfo]:
    """Return the members of a ZIP that are files, without those that an operating system keeps beside them."""
    return [each for each in members if not each.is_dir() and not _is_of_the_system(each.filename)]


def _is_of_the_system(name: str) -> bool:
    """Return whether a member is what an operating system keeps beside files."""
    return name.startswith("__MACOSX/") or PurePosixPath(name).name.startswith((".", "Thumbs.db"))
