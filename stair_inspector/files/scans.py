"""The door for scans: which files to read, and one file into one :class:`Scan`.

Files are hostile until checked: what a header states is compared with what the file holds before it is believed, and
everything that is wrong with a file becomes one sentence.
"""

import hashlib
import importlib
import os
import stat
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from stair_inspector.columns import parse_columns
from stair_inspector.declarations import check_value, parse_box
from stair_inspector.errors import ColumnsUnclear, DegenerateGeometry, ReadError
from stair_inspector.files.archives import ARCHIVE_SUFFIXES, is_archive, unpack_scan
from stair_inspector.files.cleaning import check_range, count_repeats, first_occurrences, to_local_metres, unit_normals
from stair_inspector.files.cropping import cut_out, part_of_file, scan_part
from stair_inspector.files.file_part import FilePart
from stair_inspector.files.paths import as_path
from stair_inspector.files.raw_cloud import READ_STAGE, RawCloud, RawMesh, ScanFormat, excerpt
from stair_inspector.files.raw_mesh import cloud_of_mesh
from stair_inspector.files.text_scan import is_text, read_text
from stair_inspector.geometry.arrays import Colors, Floats, Ints
from stair_inspector.model import Note, Scan
from stair_inspector.params import ScanUnit
from stair_inspector.stages.units import DecidedUnit, decide_unit
from stair_inspector.units import METRES_PER_UNIT

_READERS = (
    "ply_scan",
    "pcd_scan",
    "las_scan",
    "e57_scan",
    "ptx_scan",
    "pts_scan",
    "npy_scan",
    "gltf_scan",
    "stl_scan",
    "off_scan",
    "obj_scan",
)
"""Files of this room that each hold a ``FORMAT``: a new format is one such file and one line here.

They are asked in this order whether a file begins as theirs; what none of them knows is text.
"""
FORMATS: tuple[ScanFormat, ...] = tuple(
    importlib.import_module(f"stair_inspector.files.{reader}").FORMAT for reader in _READERS
)
_TEXT_SUFFIXES = (".xyz", ".csv")
FOLDER_SUFFIXES = (*(suffix for each in FORMATS for suffix in each.suffixes), *_TEXT_SUFFIXES)
"""Suffixes taken from a folder: a text file in a folder is more often a remark than a scan."""
_SCAN_SUFFIXES = (*FOLDER_SUFFIXES, ".txt", ".asc")
SUFFIXES = (*_SCAN_SUFFIXES, *ARCHIVE_SUFFIXES)
"""Suffixes of scans, lower case; what a file holds decides how it is read."""

_IN_FOLDERS = (*FOLDER_SUFFIXES, *(f"{suffix}.gz" for suffix in FOLDER_SUFFIXES))
_LARGEST_BYTES = 4 * 2**30
_PATH_CHARACTERS = 300
_OTHER_FORMATS = {
    b"%PDF": "PDF",
    b"\x89PNG": "an image",
    b"\xff\xd8\xff": "an image",
}
_FOR_SCANS = (*(suffix for each in FORMATS if not each.is_for_meshes for suffix in each.suffixes), *_TEXT_SUFFIXES)
_HINT = (
    f"export the scan as {', '.join(suffix[1:].upper() for suffix in _FOR_SCANS[:-1])} or {_FOR_SCANS[-1][1:].upper()}"
)

_COLUMNS_IGNORED = Note("columns_not_asked", READ_STAGE, "columns changes nothing: this format names its own")
_RESULT_ENDINGS = (".csv", "_debug.ply", "_segmented.ply", "_segmented.laz")
_RESULT_MARK = b'"stair-inspector/inspection-1"'
"""Stands near the beginning of every JSON that ``measure`` writes."""


def find_scans(paths: Sequence[Path]) -> list[Path]:
    """Return the scans that a user named: files as they are, folders as the scans in them.

    Parameters
    ----------
    paths : sequence of Path
        Files and folders; a folder gives its own files ending in one of FOLDER_SUFFIXES, in any case, sorted by name;
        left out are hidden files, subfolders, and the results that ``measure`` may have written there.

    Raises
    ------
    ReadError
        A path is missing or cannot be looked at, or a folder has no scans.
    """
    found: list[Path] = []
    for path in map(Path, paths):
        if not stat.S_ISDIR(_mode(path)):
            found.append(path)
            continue
        try:
            inside = sorted(
                child
                for child in path.iterdir()
                if child.name.lower().endswith(_IN_FOLDERS)
                and not child.name.startswith(".")
                and child.is_file()
                and not _is_result(child)
            )
        except OSError as error:
            raise _cannot_open(path, error) from error
        if not inside:
            raise ReadError(f"{_name(path)}: this folder holds no scans ({', '.join(FOLDER_SUFFIXES)}); name a scan")
        found += inside
    return found


def _is_result(path: Path) -> bool:
    """Return whether a file is a table or a cloud of ours: our JSON lies beside it."""
    stem = next((path.name.removesuffix(end) for end in _RESULT_ENDINGS if path.name.endswith(end)), None)
    if stem is None:
        return False
    try:
        with path.with_name(f"{stem}.json").open("rb") as stream:
            return _RESULT_MARK in stream.read(200)
    except OSError:
        return False


def read_scan(
    path: str | os.PathLike[str],
    unit: ScanUnit = "auto",
    station: str = "",
    columns: str = "auto",
    crop: str = "",
    detail_m: float = 0.0,
) -> Scan:
    """Read a scan, whatever its format, into metres near zero.

    Parameters
    ----------
    path : Path
        A cloud or a mesh of any of FORMATS, or text, or one of them in a gzip or ZIP; the content decides, not the
        suffix. The file is only read.
    unit : str
        Unit of the file's coordinates; ``auto`` takes that of the format, or decides by the stair that comes out, see
        :func:`stair_inspector.stages.units.decide_unit`.
    station : str
        Name of the station to be read of several, or its number as ``#2``; '' takes all together.
    columns : str
        What the columns of a text are, as ``-,x,y,z``; see :func:`stair_inspector.columns.parse_columns`. Other formats
        name their own.
    crop : str
        Box of the file that is read, ``xmin,ymin,zmin,xmax,ymax,zmax`` in its own coordinates, of a glTF after it was
        turned z up; '' reads all. Of a COPC only the cells near it are unpacked, of a mesh its faces near it sampled.
    detail_m : float
        Of a COPC only the levels that points so far apart need; 0 reads all. Without ``unit`` as if in metres.

    Returns
    -------
    Scan
        Finite, distinct points in the order of the file, without the repeated points at exactly 0, 0, 0 by which some
        depth cameras mark a missing return; ``points + origin_m`` are the file's coordinates times the
        unit, to the rounding of float64. ``origin_m`` is zero where all coordinates are within 1000 m of zero, else
        whole metres near the middle of the cloud. Colours 0 to 255 and unit normals where the file has them. Notes
        (stage ``read``): ``unit_guessed``, ``non_finite_dropped``, ``no_return_dropped``, ``duplicates_dropped``,
        ``normals_dropped``, ``colors_dropped``, ``cropped``, ``detail_ignored``; of text see
        :func:`stair_inspector.files.text_scan.read_text`, of meshes
        :func:`stair_inspector.files.raw_mesh.cloud_of_mesh`, of LAS
        :func:`stair_inspector.files.las_scan.read_las`, of files of stations
        :func:`stair_inspector.files.e57_scan.read_e57`.

    Raises
    ------
    ReadError
        Missing, not a file, empty, larger than 4 GiB, unknown, damaged, not what its header states, without that
        station, or without any finite point: one sentence that begins with the path.
    ColumnsUnclear
        A text of which it is not certain which columns are x, y and z.
    ConfigError
        No path, unknown unit, or impossible columns, box or detail.
    """
    check_value("unit", unit, ScanUnit, None)
    for name, text in (("station", station), ("columns", columns), ("crop", crop)):
        check_value(name, text, str, None)
    named = parse_columns(columns)
    part = part_of_file(parse_box(crop, "crop", "the file's own coordinates"), detail_m, unit)
    path = as_path(path, "a scan")
    data = _read_bytes(path)
    try:
        read = _parse(path.name, data, station, named, part)
        return _to_scan(read, unit, part, excerpt(path.name, len(path.name)), hashlib.sha256(data).hexdigest())
    except ColumnsUnclear as error:
        raise ColumnsUnclear(f"{_name(path)}: {error}", error.lines, error.proposals) from error
    except ReadError as error:
        raise ReadError(f"{_name(path)}: {error}") from error
    except DegenerateGeometry as error:
        message = f"{_name(path)}: its points are spread over many kilometres; cut out the staircase, or give the unit"
        raise ReadError(message) from error
    except MemoryError as error:
        raise ReadError(f"{_name(path)}: does not fit into the memory; thin the scan out and try again") from error


def _name(path: Path) -> str:
    return excerpt(str(path), _PATH_CHARACTERS)


def _cannot_open(path: Path, error: OSError | ValueError) -> ReadError:
    if isinstance(error, FileNotFoundError):
        return ReadError(f"{_name(path)}: there is no such file; check the path")
    # A ValueError comes from a path with a zero byte.
    reason = error.strerror if isinstance(error, OSError) and error.strerror else "not a valid path"
    return ReadError(f"{_name(path)}: cannot be opened ({excerpt(reason)}); check the path and your rights to it")


def _mode(path: Path) -> int:
    try:
        return path.stat().st_mode
    except (OSError, ValueError) as error:
        raise _cannot_open(path, error) from error


def _read_bytes(path: Path) -> bytes:
    """Return the content of a regular file: not mapped, since a file cut while it is mapped ends the process."""
    mode = _mode(path)
    if stat.S_ISDIR(mode):
        raise ReadError(f"{_name(path)}: is a folder, not a scan; name a file in it")
    if not stat.S_ISREG(mode):
        # Opening a pipe would wait for ever.
        raise ReadError(f"{_name(path)}: is a device or a pipe, not a file; save the scan to a file first")
    try:
        n_bytes = path.stat().st_size
        if n_bytes > _LARGEST_BYTES:
            raise ReadError(
                f"{_name(path)}: has {n_bytes / 2**30:.1f} GiB, more than the {_LARGEST_BYTES // 2**30} GiB that are "
                "read; thin the scan out or cut out the staircase"
            )
        data = path.read_bytes()
    except OSError as error:
        raise _cannot_open(path, error) from error
    except MemoryError as error:
        raise ReadError(f"{_name(path)}: does not fit into the memory; thin the scan out and try again") from error
    if not data:
        raise ReadError(f"{_name(path)}: is empty; {_HINT}")
    return data


def _parse(name: str, data: bytes, station: str, columns: Sequence[str], part: FilePart) -> RawCloud | RawMesh:
    """Read by content; the suffix only decides which sentence explains a failure."""
    known = next((each for each in FORMATS if each.fits(data)), None)
    if known is None and is_archive(data):
        name, data = unpack_scan(data, name, (FOLDER_SUFFIXES, _SCAN_SUFFIXES))
        known = next((each for each in FORMATS if each.fits(data)), None)
    takes = () if known is None else known.takes
    if station and "station" not in takes:
        raise ReadError("is of a format that has no stations; measure it without --station")
    if known is not None:
        asked = {"station": station, "columns": columns, "part": part}
        read = known.read(data, **{name: asked[name] for name in takes})
        is_ignored = bool(columns) and "columns" not in takes
        return replace(read, notes=(*read.notes, _COLUMNS_IGNORED)) if is_ignored else read
    other = next((name for magic, name in _OTHER_FORMATS.items() if data.startswith(magic)), None)
    if other is not None:
        raise ReadError(f"is {other}, which is not read; {_HINT}")
    suffix = Path(name).suffix.lower()
    stated = next((each for each in FORMATS if suffix in each.suffixes and not each.is_text), None)
    if stated is not None:
        try:
            return read_text(data, columns)
        except ColumnsUnclear:
            raise
        except ReadError as error:
            raise ReadError(f"does not begin with {stated.beginning} (got '{excerpt(data, 20)}'); {_HINT}") from error
    if not is_text(data) and suffix not in SUFFIXES:
        raise ReadError(f"is of an unknown format (it begins with '{excerpt(data, 20)}'); {_HINT}")
    return read_text(data, columns)


def _to_scan(read: RawCloud | RawMesh, unit: ScanUnit, part: FilePart, name: str, sha256: str) -> Scan:
    raw = read
    stated = unit if unit != "auto" else read.unit
    decided = None if stated is None else DecidedUnit(stated)
    if isinstance(raw, RawMesh):
        raw, decided = cloud_of_mesh(raw, decided, part)
    notes = list(raw.notes)
    n_points = len(raw.points)
    kept = np.flatnonzero(np.isfinite(raw.points).all(axis=1))
    if not len(kept):
        raise ReadError(f"none of its {n_points} points is finite (all are NaN or infinite); {_HINT}")
    if len(kept) < n_points:
        notes.append(_dropped("non_finite_dropped", n_points - len(kept), n_points, "not finite (NaN or infinite)"))
    is_no_return = ~raw.points[kept].any(axis=1)
    if 1 < np.count_nonzero(is_no_return) < len(kept):
        notes.append(_dropped("no_return_dropped", int(is_no_return.sum()), n_points, "all at 0, 0, 0: no return"))
        kept = kept[~is_no_return]
    outside = kept[:0]
    if part.box is not None:
        kept, outside, note = cut_out(raw.points, kept, part)
        notes.append(note)
    if part.detail_m and not raw.has_levels:
        message = "detail_m changes nothing: this scan has no levels of detail, as COPC has; every point was read"
        notes.append(Note("detail_ignored", READ_STAGE, message))
    finite = raw.points[kept]
    check_range(finite)
    decided = decided or decide_unit(finite)
    if decided.note is not None:
        notes.append(decided.note)
    local, origin_m = to_local_metres(finite, decided.unit)
    is_first = first_occurrences(local)
    repeats: Ints | None = None
    if not is_first.all():
        repeats = count_repeats(local, is_first)
        n_repeats = len(local) - int(is_first.sum())
        notes.append(_dropped("duplicates_dropped", n_repeats, n_points, "exact duplicates of another"))
        local, kept = local[is_first], kept[is_first]
    normals: Floats | None = None
    if raw.normals is not None:
        normals = unit_normals(raw.normals[kept])
        if normals is None:
            message = "the normals in the file were dropped: some are zero or not finite"
            notes.append(Note("normals_dropped", READ_STAGE, message))
    colors: Colors | None = None if raw.colors is None else raw.colors[kept]
    metres = METRES_PER_UNIT[decided.unit]
    return Scan(
        points=local,
        origin_m=origin_m,
        name=name,
        sha256=sha256,
        unit=decided.unit,
        n_points=n_points,
        colors=colors,
        normals=normals,
        notes=tuple(notes),
        observations=decided.observations,
        repeats=repeats,
        stated_steps_m=None if raw.step is None else raw.step * metres,
        facet_m=None if raw.facet is None else raw.facet * metres,
        is_outward=None if raw.is_outward is None else raw.is_outward[kept],
        stations=None if raw.stations is None else raw.stations.placed(kept, metres, origin_m),
        intensities=None if raw.intensities is None else raw.intensities[kept],
        part=None if part.box is None else scan_part(part.box, raw.points[outside], metres, origin_m),
    )


def _dropped(code: str, count: int, of: int, why: str) -> Note:
    return Note(code, READ_STAGE, f"{count:,} of {of:,} points dropped: {why}")
