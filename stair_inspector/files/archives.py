"""Unpacking a scan that lies in a gzip or a ZIP: one scan, and no more bytes than a scan could be packed into."""

import zipfile
import zlib
from collections.abc import Callable, Sequence
from gzip import GzipFile
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
_DAMAGED = (zipfile.BadZipFile, zlib.error, EOFError, OSError, RuntimeError, ValueError)
"""What Python's readers of gzip and ZIP raise of damaged bytes. OSError: no gzip, or a place before the file's begin;
RuntimeError: a feature or method there is none of; ValueError: names that are no text, negative places."""


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
    if data.startswith(_GZIP):
        inside = name.removesuffix(".gz")
        unpacked = _read(lambda: GzipFile(fileobj=BytesIO(data)), most_unpacked(len(data)))
    else:
        archive, files = open_zip(data)
        chosen = _chosen(files, suffixes)
        inside = PurePosixPath(chosen.filename).name
        unpacked = unpack_member(archive, chosen, most_unpacked(len(data)))
    if is_archive(unpacked):
        raise ReadError(f"holds another archive ('{excerpt(inside)}'); unpack it first")
    if not unpacked:
        raise ReadError(f"holds an empty file ('{excerpt(inside)}'); pack the scan again")
    return inside, unpacked


def most_unpacked(n_packed: int) -> int:
    """Return the bytes that a scan packed into ``n_packed`` may have."""
    return min(max(LARGEST_GROWTH * n_packed, _LEAST_ALLOWED), _LARGEST_BYTES)


def open_zip(data: bytes) -> tuple[zipfile.ZipFile, list[zipfile.ZipInfo]]:
    """Return a ZIP, and its members that are files, without those that an operating system keeps beside them.

    Raises
    ------
    ReadError
        Damaged.
    """
    try:
        archive = zipfile.ZipFile(BytesIO(data))
    except _DAMAGED as error:
        raise _damaged(error) from error
    files = [each for each in archive.infolist() if not each.is_dir() and not _is_of_the_system(each.filename)]
    return archive, files


def unpack_member(archive: zipfile.ZipFile, member: zipfile.ZipInfo, most: int) -> bytes:
    """Return the bytes of a member of a ZIP.

    Raises
    ------
    ReadError
        Encrypted, packed by another method than deflate, damaged, or more than ``most`` bytes.
    """
    if member.flag_bits & _ENCRYPTED:
        raise ReadError("is a ZIP archive with a password; unpack it and give the scan itself")
    if member.compress_type not in _METHODS:
        raise ReadError("is a ZIP archive packed by a method other than deflate; unpack it and give the scan itself")
    return _read(lambda: archive.open(member), most)


def _read(open_stream: Callable[[], IO[bytes] | GzipFile], most: int) -> bytes:
    """Return all of a stream of unpacked bytes, unless there are more than a packed scan of its size has."""
    try:
        with open_stream() as stream:
            unpacked = stream.read(most + 1)
    except _DAMAGED as error:
        raise _damaged(error) from error
    if len(unpacked) > most:
        raise ReadError(
            f"unpacks to more than {most:,} bytes, the most that are read of a packed scan of its size; "
            "unpack it and give the scan itself"
        )
    return unpacked


def _damaged(error: Exception) -> ReadError:
    return ReadError(f"is a damaged archive ({excerpt(str(error))}); {TRUNCATED_HINT}")


def _chosen(files: Sequence[zipfile.ZipInfo], suffixes: Sequence[tuple[str, ...]]) -> zipfile.ZipInfo:
    """Return the one scan among the files of a ZIP."""
    of_kinds = ([each for each in files if each.filename.lower().endswith(kind)] for kind in suffixes)
    scans = files if len(files) == 1 else next(filter(None, of_kinds), [])
    if len(scans) != 1:
        named = ", ".join(excerpt(each.filename) for each in (scans or files)[:_MOST_NAMED])
        more = f" and {len(scans or files) - _MOST_NAMED} more" if len(scans or files) > _MOST_NAMED else ""
        what = f"{len(scans)} scans ({named}{more})" if scans else f"no scan ({named or 'no file'}{more})"
        raise ReadError(f"is a ZIP archive that holds {what}; unpack it and give the scan to be measured")
    return scans[0]


def _is_of_the_system(name: str) -> bool:
    """Return whether a member is what an operating system keeps beside files."""
    return name.startswith("__MACOSX/") or PurePosixPath(name).name.startswith((".", "Thumbs.db"))
