"""The manifest of a record: which files belong together, by their SHA-256, and what they were made of."""

import contextlib
import hashlib
import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Any

from stair_inspector import __version__
from stair_inspector.errors import ReadError
from stair_inspector.files.atomic import finish_writing, is_plain_name
from stair_inspector.files.raw_cloud import excerpt
from stair_inspector.files.settings import params_to_dict
from stair_inspector.params import Params

SCHEMA = "stair-inspector/manifest-1"
SUFFIX = ".manifest.json"
RECORD_SUFFIXES = (
    ".json",
    ".csv",
    "_debug.ply",
    "_segmented.laz",
    "_segmented.ply",
    "_report.pdf",
    "_report.html",
    "_report.xlsx",
    "_plan.dxf",
    "_section.dxf",
    "_comparison.json",
    "_comparison.csv",
)
"""What is added to a record's stem for each of its files."""
_MOST_BYTES = 1_000_000
_BLOCK = 1 << 20
_LONGEST_TEXT = 300


@dataclass(frozen=True, slots=True)
class Manifest:
    """What a manifest says: ``files`` are the SHA-256 by name, ``scans`` name and SHA-256 of what was measured."""

    stem: str
    version: str
    made_at: str
    scans: tuple[tuple[str, str], ...]
    files: Mapping[str, str]


@dataclass(frozen=True, slots=True)
class Verified:
    """Which files of a record are as its manifest says; ``strays`` would be of this record by name, and are not."""

    manifest: Manifest
    changed: tuple[str, ...]
    missing: tuple[str, ...]
    strays: tuple[str, ...]

    @property
    def belongs_together(self) -> bool:
        """Whether every file is there and unchanged, and none is of another run."""
        return not (self.changed or self.missing or self.strays)


def sha256_of(data: bytes) -> str:
    """Return the SHA-256 of some bytes in hexadecimal."""
    return hashlib.sha256(data).hexdigest()


def manifest_bytes(
    files: Mapping[str, bytes],
    scans: Sequence[tuple[str, str]],
    settings: Params | None,
    made_at: datetime,
    rule_set: tuple[str, str] | None = None,
) -> bytes:
    """Return the manifest of a record as JSON, schema ``stair-inspector/manifest-1``.

    Parameters
    ----------
    files : mapping of str to bytes
        The other files of the record by their names.
    scans : sequence of (str, str)
        Name and SHA-256 of what was measured: one scan, or the two of a comparison.
    settings : Params, optional
        Of the measurement, where all of it has the same.
    made_at : datetime
        When.
    rule_set : (str, str), optional
        Identity and SHA-256 of the rules that were applied.
    """
    found: dict[str, Any] = {
        "schema": SCHEMA,
        "software": {"name": "stair_inspector", "version": __version__},
        "made_at": made_at.isoformat(timespec="seconds"),
        "scans": [{"file": name, "sha256": sha256} for name, sha256 in scans],
        "rule_set": None if rule_set is None else dict(zip(("id", "sha256"), rule_set, strict=True)),
        "settings": None if settings is None else params_to_dict(settings),
        "files": [{"name": name, "bytes": len(data), "sha256": sha256_of(data)} for name, data in files.items()],
    }
    return (json.dumps(found, indent=1, ensure_ascii=False) + "\n").encode("utf-8", errors="backslashreplace")


def find_manifests(folder: Path) -> list[Path]:
    """Return the manifests in a folder, by name, once a write that was killed there is finished.

    Raises
    ------
    ReadError
        It cannot be read, holds none, or a write that was killed there cannot be finished.
    """
    try:
        if any(folder.iterdir()):
            _finish(folder)
        found = sorted(path for path in folder.iterdir() if path.name.endswith(SUFFIX) and path.is_file())
    except OSError as error:
        raise ReadError(f"{folder}: cannot be read ({error.strerror or error}); give a folder of results") from error
    if not found:
        raise ReadError(f"{folder}: holds no *{SUFFIX}; give a folder that measure, check or compare wrote")
    return found


def _finish(folder: Path) -> None:
    try:
        finish_writing(folder)
    except OSError as error:
        raise ReadError(
            f"{folder}: a write that was killed there cannot be finished ({error.strerror or error}); give a folder "
            "that can be written, such as a copy of it"
        ) from error


def read_manifest(path: Path) -> Manifest:
    """Read a manifest.

    Raises
    ------
    ReadError
        It cannot be read, or is none that this program wrote.
    """
    try:
        with path.open("rb") as stream:
            data = stream.read(_MOST_BYTES + 1)
        if len(data) > _MOST_BYTES:
            raise ValueError("it is too long")
        found = json.loads(data)
        if not isinstance(found, dict) or found.get("schema") != SCHEMA:
            raise ValueError(f"its schema is not {SCHEMA}")
        manifest = Manifest(
            excerpt(path.name.removesuffix(SUFFIX), len(path.name)),
            _text(found, "software", "version"),
            _text(found, "made_at"),
            tuple((_text(each, "file"), _text(each, "sha256")) for each in _list(found["scans"])),
            {_name(each): _text(each, "sha256") for each in _list(found["files"])},
        )
    except OSError as error:
        raise ReadError(f"{path}: cannot be read ({error.strerror or error}); give another folder") from error
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        raise ReadError(f"{path}: is no manifest of this program ({_words(error)}); write the results anew") from error
    return manifest


def verify(path: Path) -> Verified:
    """Hold the files beside a manifest against it; what another manifest beside it names is no stray of this one.

    Raises
    ------
    ReadError
        The manifest cannot be read, or a file beside it.
    """
    manifest = read_manifest(path)
    changed: list[str] = []
    missing: list[str] = []
    for name, wanted in manifest.files.items():
        found = hash_file(path.parent / name)
        if found is None:
            missing.append(name)
        elif found != wanted:
            changed.append(name)
    beside = (f"{manifest.stem}{suffix}" for suffix in RECORD_SUFFIXES)
    strays = [name for name in beside if name not in manifest.files and (path.parent / name).exists()]
    if strays:
        # As the results of a scan called stair_comparison beside those of one called stair.
        others = _named_by_others(path)
        strays = [name for name in strays if name not in others]
    return Verified(manifest, tuple(changed), tuple(missing), tuple(strays))


def _named_by_others(path: Path) -> set[str]:
    """Return what the other manifests beside one name, as far as they can be read."""
    named: set[str] = set()
    for other in path.parent.glob(f"*{SUFFIX}"):
        if other != path:
            with contextlib.suppress(ReadError):
                named |= read_manifest(other).files.keys()
    return named


def hash_file(path: Path) -> str | None:
    """Return the SHA-256 of a file; None where there is none.

    Raises
    ------
    ReadError
        It is there and cannot be read.
    """
    digest = hashlib.sha256()
    try:
        # Unlike the path's own question this one answers no to a name that no file can have.
        if not os.path.exists(path):
            return None
        # Of a pipe or a device there would be no end.
        if not path.is_file():
            raise ReadError(f"{path}: is no file; give a folder of results, or a scan")
        with path.open("rb") as stream:
            while block := stream.read(_BLOCK):
                digest.update(block)
    except OSError as error:
        raise ReadError(f"{path}: cannot be read ({error.strerror or error}); give another folder") from error
    return digest.hexdigest()


def hash_scan(path: Path) -> str:
    """Return the SHA-256 of a scan.

    Raises
    ------
    ReadError
        It is not there, or cannot be read.
    """
    found = hash_file(path)
    if found is None:
        raise ReadError(f"{path}: there is no such file; give the scan that was measured")
    return found


def _text(found: object, *keys: str) -> str:
    """Return the text under some keys."""
    for key in keys:
        if not isinstance(found, dict):
            raise TypeError(f"what should hold {key!r} is no object")
        found = found[key]
    if not isinstance(found, str):
        raise TypeError(f"{keys[-1]!r} is no text")
    return excerpt(found, _LONGEST_TEXT)


def _list(found: object) -> list[object]:
    if not isinstance(found, list):
        raise TypeError("its scans or files are no list")
    return found


def _name(found: object) -> str:
    """Return the name of a file: what a manifest names lies beside it."""
    name = found.get("name") if isinstance(found, dict) else None
    if not isinstance(name, str):
        raise TypeError("the name of a file is no text")
    if not is_plain_name(name):
        raise ValueError("it names a file of another folder")
    return name


def _words(error: Exception) -> str:
    if isinstance(error, RecursionError):
        return "nested too deeply"
    return f"{error} is missing" if isinstance(error, KeyError) else str(error)[:100]
