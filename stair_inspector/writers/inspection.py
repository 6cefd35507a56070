"""The files of an inspection: JSON, CSV, a coloured debug PLY, and the segmented scan where it is wanted."""

from collections.abc import Sequence
from pathlib import Path

from stair_inspector.codes import Check
from stair_inspector.content.pins import PinnedFindings
from stair_inspector.files.atomic import write_all_atomically
from stair_inspector.model import ComparedScan, Inspection, Scan
from stair_inspector.writers.csv import csv_bytes
from stair_inspector.writers.debug_ply import debug_ply_bytes
from stair_inspector.writers.json import json_bytes
from stair_inspector.writers.segmented import SegmentedFormat, segmented_bytes


def write_inspection(
    scan: Scan,
    inspection: Inspection,
    folder: Path,
    stem: str,
    check: Check | None = None,
    segmented: Sequence[SegmentedFormat] = (),
    pinned: PinnedFindings | None = None,
    compared: ComparedScan | None = None,
) -> list[Path]:
    """Write ``STEM.json``, ``STEM.csv`` and ``STEM_debug.ply`` into a folder, each completely or not at all.

    A check against a rule set, the findings with what is ``pinned``, and what changed against a second scan go into the
    JSON. The segmented scan is
    written in each of these formats, as ``STEM_segmented.laz`` or ``.ply``.

    Raises
    ------
    WriteError
        The folder cannot be written, or LAZ is wanted and its package missing; files that existed are untouched.
    """
    paths = result_paths(folder, stem, segmented)
    contents = [
        json_bytes(inspection, check, pinned, compared),
        csv_bytes(inspection),
        debug_ply_bytes(scan, inspection),
    ]
    contents += [segmented_bytes(scan, inspection, form) for form in dict.fromkeys(segmented)]
    write_all_atomically(dict(zip(paths, contents, strict=True)))
    return paths


def result_paths(folder: Path, stem: str, segmented: Sequence[SegmentedFormat] = ()) -> list[Path]:
    """Return where the JSON, the CSV, the debug PLY and the segmented scans of a scan with this stem go."""
    endings = (".json", ".csv", "_debug.ply", *(f"_segmented.{form}" for form in dict.fromkeys(segmented)))
    return [folder / f"{stem}{ending}" for ending in endings]
