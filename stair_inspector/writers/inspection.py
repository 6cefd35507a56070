"""The files of an inspection: JSON, CSV and a coloured debug PLY."""

from pathlib import Path

from stair_inspector.codes import Check
from stair_inspector.files.atomic import write_all_atomically
from stair_inspector.model import Inspection, Scan
from stair_inspector.writers.csv import csv_bytes
from stair_inspector.writers.debug_ply import debug_ply_bytes
from stair_inspector.writers.json import json_bytes


def write_inspection(
    scan: Scan, inspection: Inspection, folder: Path, stem: str, check: Check | None = None
) -> list[Path]:
    """Write ``STEM.json``, ``STEM.csv`` and ``STEM_debug.ply`` into a folder, each completely or not at all.

    A check against a rule set goes into the JSON.

    Raises
    ------
    WriteError
        The folder cannot be written; files that existed are untouched.
    """
    paths = result_paths(folder, stem)
    contents = (json_bytes(inspection, check), csv_bytes(inspection), debug_ply_bytes(scan, inspection))
    write_all_atomically(dict(zip(paths, contents, strict=True)))
    return list(paths)


def result_paths(folder: Path, stem: str) -> tuple[Path, Path, Path]:
    """Return where the JSON, the CSV and the debug PLY of a scan with this stem go."""
    return folder / f"{stem}.json", folder / f"{stem}.csv", folder / f"{stem}_debug.ply"
