"""One record: all files of a run, whole or not at all, with the manifest that says what belongs together."""

from collections.abc import Iterable, Mapping, Sequence
from datetime import datetime
from pathlib import Path

from stair_inspector.codes.findings import Check
from stair_inspector.content.fields import ReportBasis
from stair_inspector.content.pins import PinnedFindings
from stair_inspector.content.short import ReportLength
from stair_inspector.files.atomic import write_all_atomically
from stair_inspector.files.manifests import SUFFIX, manifest_bytes, sha256_of
from stair_inspector.model import ComparedScan, Inspection, Scan, ScanSummary
from stair_inspector.params import Params
from stair_inspector.writers.inspection import inspection_files
from stair_inspector.writers.segmented import SegmentedFormat


def write_record(
    scan: Scan,
    inspection: Inspection,
    folder: Path,
    stem: str,
    made_at: datetime,
    check: Check | None = None,
    segmented: Sequence[SegmentedFormat] = (),
    pinned: PinnedFindings | None = None,
    basis: ReportBasis | None = None,
    length: ReportLength = "short",
    compared: ComparedScan | None = None,
) -> list[Path]:
    """Write what was measured of a scan, the report where there is a ``basis`` for one, and ``STEM.manifest.json``.

    Parameters as :func:`~stair_inspector.writers.inspection.inspection_files` and
    :func:`~stair_inspector.writers.report.report_files`. The report names the SHA-256 of the JSON.

    Raises
    ------
    MissingLibrary
        A library that typesets is not installed.
    WriteError
        The folder cannot be written; files that existed are untouched.
    """
    files = inspection_files(scan, inspection, check, segmented, pinned, compared)
    if basis is not None:
        from stair_inspector.writers.report import report_files

        results = results_words(f"{stem}.json", files[".json"])
        files |= report_files(
            scan,
            inspection,
            basis,
            made_at,
            check,
            pinned=pinned,
            length=length,
            compared=compared,
            results=results,
        )
    measured = [inspection.scan] if compared is None else [compared.found.before, compared.found.after]
    return write_files(folder, stem, files, hashes_of(measured), inspection.params, made_at, check)


def write_files(
    folder: Path,
    stem: str,
    files: Mapping[str, bytes],
    scans: Sequence[tuple[str, str]],
    settings: Params | None,
    made_at: datetime,
    check: Check | None = None,
) -> list[Path]:
    """Write files, by what is added to the stem, with their manifest; return where they are.

    Raises
    ------
    WriteError
        The folder cannot be written; files that existed are untouched.
    """
    named = with_manifest(stem, files, scans, settings, made_at, check)
    write_all_atomically({folder / name: data for name, data in named.items()})
    return [folder / name for name in named]


def with_manifest(
    stem: str,
    files: Mapping[str, bytes],
    scans: Sequence[tuple[str, str]],
    settings: Params | None,
    made_at: datetime,
    check: Check | None = None,
) -> dict[str, bytes]:
    """Return files by their names, the manifest last."""
    named = {f"{stem}{suffix}": data for suffix, data in files.items()}
    rule_set = None if check is None else (check.rule_set.set_id, check.rule_set.sha256)
    named[f"{stem}{SUFFIX}"] = manifest_bytes(named, scans, settings, made_at, rule_set)
    return named


def results_words(name: str, data: bytes) -> str:
    """Return how a report names the results that belong to it."""
    return f"{name}, SHA-256 {sha256_of(data)}"


def hashes_of(scans: Iterable[ScanSummary]) -> list[tuple[str, str]]:
    """Return name and SHA-256 of scans, as a manifest states them."""
    return [(scan.name, scan.sha256) for scan in scans]
