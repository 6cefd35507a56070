"""The files of a run are one set with a manifest, and what does not belong to it is told."""

import json

import pypdf
import pytest

from stair_inspector.errors import ReadError, WriteError
from stair_inspector.files import atomic
from stair_inspector.files.manifests import RECORD_SUFFIXES, find_manifests, read_manifest, sha256_of, verify
from stair_inspector.files.settings import params_from_dict
from stair_inspector.writers import inspection as files_of_inspection
from stair_inspector.writers.record import write_record
from tests.writers.samples import BASIS, MADE_AT, checked, scanned

FILES = ("stair.json", "stair.csv", "stair_debug.ply")
MANIFEST = "stair.manifest.json"


@pytest.fixture
def folder(tmp_path):
    scan, inspection = scanned()
    written = write_record(scan, inspection, tmp_path, "stair", MADE_AT, checked())
    assert [path.name for path in written] == [*FILES, MANIFEST]
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(path.name for path in written)
    return tmp_path


def test_the_manifest_states_files_scan_rules_settings_and_date(folder):
    _, inspection = scanned()
    said = json.loads((folder / MANIFEST).read_bytes())
    assert [each["name"] for each in said["files"]] == list(FILES)
    for each in said["files"]:
        data = (folder / each["name"]).read_bytes()
        assert (each["bytes"], each["sha256"]) == (len(data), sha256_of(data))
    assert said["scans"] == [{"file": inspection.scan.name, "sha256": inspection.scan.sha256}]
    rules = checked().rule_set
    assert said["rule_set"] == {"id": rules.set_id, "sha256": rules.sha256}
    assert params_from_dict(said["settings"], "manifest") == inspection.params
    assert said["made_at"] == MADE_AT.isoformat(timespec="seconds")
    assert verify(folder / MANIFEST).belongs_together


def test_what_was_changed_or_lost_or_is_of_another_run_is_told(folder):
    (folder / "stair.csv").write_bytes((folder / "stair.csv").read_bytes() + b" ")
    (folder / "stair_debug.ply").unlink()
    (folder / "stair_report.pdf").write_bytes(b"of yesterday")
    (folder / "other.csv").write_bytes(b"of another scan")
    found = verify(folder / MANIFEST)
    assert (found.changed, found.missing, found.strays) == (("stair.csv",), ("stair_debug.ply",), ("stair_report.pdf",))
    assert not found.belongs_together


def test_what_another_run_names_is_no_stray(folder):
    scan, inspection = scanned()
    write_record(scan, inspection, folder, "stair_comparison", MADE_AT)
    assert verify(folder / MANIFEST).belongs_together
    (folder / "stair_comparison.manifest.json").unlink()
    assert verify(folder / MANIFEST).strays == ("stair_comparison.json", "stair_comparison.csv")


def test_nothing_is_written_when_a_result_cannot_be_made(tmp_path, monkeypatch):
    def fail(*_):
        raise MemoryError

    monkeypatch.setattr(files_of_inspection, "debug_ply_bytes", fail)
    with pytest.raises(MemoryError):
        write_record(*scanned(), tmp_path, "stair", MADE_AT)
    assert list(tmp_path.iterdir()) == []


def test_a_file_as_folder_is_a_write_error(tmp_path):
    (tmp_path / "file").write_bytes(b"")
    with pytest.raises(WriteError, match="cannot be written"):
        write_record(*scanned(), tmp_path / "file", "stair", MADE_AT)


@pytest.mark.slow
def test_every_file_of_a_run_is_in_the_set_and_the_report_states_the_hash_of_the_json(tmp_path):
    scan, inspection = scanned()
    write_record(scan, inspection, tmp_path, "stair", MADE_AT, checked(), ("laz", "ply"), basis=BASIS)
    found = verify(tmp_path / MANIFEST)
    assert found.belongs_together
    # Only a comparison has two more.
    assert set(found.manifest.files) == {
        f"stair{suffix}" for suffix in RECORD_SUFFIXES if not suffix.startswith("_comparison")
    }
    text = "".join(page.extract_text() for page in pypdf.PdfReader(tmp_path / "stair_report.pdf").pages)
    said = "".join(text.replace("\u200b", "").split())
    assert f"stair.json,SHA-256{sha256_of((tmp_path / 'stair.json').read_bytes())}" in said


@pytest.mark.parametrize(
    ("said", "why"),
    [
        ("[", "Expecting value"),
        ("[]", "its schema is not stair-inspector/manifest-1"),
        ('{"schema": "stair-inspector/manifest-1"}', "'software' is missing"),
        ("[" * 100_000, "nested|recursion"),
        (" " * 1_000_001, "it is too long"),
    ],
)
def test_what_is_no_manifest_is_one_sentence(tmp_path, said, why):
    (tmp_path / MANIFEST).write_text(said)
    with pytest.raises(ReadError, match=why):
        read_manifest(tmp_path / MANIFEST)


@pytest.mark.parametrize("name", ["../stair.csv", "", "..", "a\0"])
def test_a_manifest_that_names_what_lies_elsewhere_is_refused(folder, name):
    said = json.loads((folder / MANIFEST).read_bytes())
    said["files"][0]["name"] = name
    (folder / MANIFEST).write_text(json.dumps(said))
    with pytest.raises(ReadError, match="names a file of another folder"):
        verify(folder / MANIFEST)


def test_a_folder_without_results_is_a_sentence(tmp_path):
    for place in (tmp_path, tmp_path / "nowhere"):
        with pytest.raises(ReadError, match=f"{place}: .*; give a folder"):
            find_manifests(place)


@pytest.mark.parametrize(
    ("files", "words"),
    [
        (5, "its scans or files are no list"),
        ([3], "the name of a file is no text"),
        ([{"name": "../stair.csv", "sha256": ""}], "it names a file of another folder"),
        ([{"name": "stair.csv", "sha256": None}], "'sha256' is no text"),
    ],
)
def test_a_manifest_with_nonsense_in_it_is_a_sentence(folder, files, words):
    said = json.loads((folder / MANIFEST).read_bytes()) | {"files": files}
    (folder / MANIFEST).write_text(json.dumps(said))
    with pytest.raises(ReadError, match=f"is no manifest of this program \\({words}\\)"):
        read_manifest(folder / MANIFEST)


def test_what_cannot_be_a_file_of_the_record_is_told_and_not_waited_for(folder):
    said = json.loads((folder / MANIFEST).read_bytes())
    said["files"].append({"name": "x" * 5000, "sha256": ""})
    (folder / MANIFEST).write_text(json.dumps(said))
    assert verify(folder / MANIFEST).missing == ("x" * 5000,)
    (folder / "stair.csv").unlink()
    (folder / "stair.csv").symlink_to("/dev/zero")
    with pytest.raises(ReadError, match=r"stair\.csv: is no file; give a folder of results, or a scan"):
        verify(folder / MANIFEST)


def test_a_folder_that_cannot_be_written_is_verified_unless_a_write_is_to_be_finished(folder, monkeypatch):
    def refused(*_, **__):
        raise PermissionError(13, "Permission denied")

    (folder / ".si-a").write_bytes(b"left")
    now = atomic.time.time()
    monkeypatch.setattr(atomic.time, "time", lambda: now + 3700.0)
    for name in ("replace", "unlink"):
        monkeypatch.setattr(atomic.os, name, refused)
    assert find_manifests(folder) == [folder / MANIFEST]
    (folder / ".si-list-b").write_text('[[".si-a", "stair.csv"]]')
    with pytest.raises(
        ReadError, match=r"a write that was killed there cannot be finished \(Permission denied\); give"
    ):
        find_manifests(folder)
