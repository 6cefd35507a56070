"""The files of an inspection: JSON, CSV, a coloured debug PLY, and the segmented scan where it is wanted."""

from collections.abc import Sequence
from pathlib import Path

from stair_inspector.codes import Check
from stair_inspector.content.pins import PinnedFindings
from stair_inspector.model import ComparedScan, Inspection, Scan
from stair_inspector.writers.csv import csv_bytes
from stair_inspector.writers.debug_ply import debug_ply_bytes
from stair_inspector.writers.json import json_bytes
from stair_inspector.writers.segmented import SegmentedFormat, segmented_bytes


def inspection_files(
    scan: Scan,
    inspection: Inspection,
    check: Check | None = None,
    segmented: Sequence[SegmentedFormat] = (),
    pinned: PinnedFindings | None = None,
    compared: ComparedScan | None = None,
) -> dict[str, bytes]:
    """Return ``.json``, ``.csv`` and ``_debug.ply`` by what is added to the scan's stem.

    A check against a rule set, the findings with what is ``pinned``, and what changed against a second scan go into
    the JSON. The segmented scan is there in each of these formats, as ``_segmented.laz`` or ``.ply``.

    Raises
    ------
    WriteError
        LAZ is wanted and its package missing.
    """
    contents = [
        json_bytes(inspection, check, pinned, compared),
        csv_bytes(inspection),
        debug_ply_bytes(scan, inspection),
    ]
    contents += [segmented_bytes(scan, inspection, form) for form in dict.fromkeys(segmented)]
    return dict(zip(_suffixes(segmented), contents, strict=True))


def result_paths(folder: Path, stem: str, segmented: Sequence[SegmentedFormat] = ()) -> list[Path]:
    """Return where the JSON, the CSV, the debug PLY and the segmented scans of a scan with this stem go."""
    return [folder / f"{stem}{suffix}" for suffix in _suffixes(segmented)]


def _suffixes(segmented: Sequence[SegmentedFormat]) -> tuple[str, ...]:
    return (".json", ".csv", "_debug.ply", *(f"_segmented.{form}" for form in dict.fromkeys(segmented)))
