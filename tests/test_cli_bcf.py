"""``measure --bcf``: the findings and the pins of a project in one file, or one line that says why not."""

import hashlib
import zipfile
from xml.etree import ElementTree

import pytest

from stair_inspector.content.pin_values import pinned_to_dict
from stair_inspector.content.pins import Pin, PinnedFindings
from stair_inspector.files.project_files import save_project
from stair_inspector.files.projects import Project
from tests.content.test_pins import GUID
from tests.test_cli import refusal, run, stair_file  # noqa: F401 - fixtures


@pytest.fixture
def project_file(stair_file):  # noqa: F811
    findings = pinned_to_dict(PinnedFindings((Pin(GUID, "loose nosing", "major", (0.0, 0.0, 0.0)),)))
    sha256 = hashlib.sha256(stair_file.read_bytes()).hexdigest()
    path = stair_file.with_name("pinned.stair.json")
    save_project(path, Project(stair_file.name, sha256, findings=findings))
    return path


def test_the_pins_of_a_project_are_topics_and_rows_of_the_json(run, tmp_path, project_file):  # noqa: F811
    target = tmp_path / "findings.bcf"
    code, out, err = run("measure", "--project", project_file, "-o", tmp_path, "--bcf", target)
    assert (code, err) == (0, "")
    assert str(target) in out
    with zipfile.ZipFile(target) as read:
        topic = ElementTree.fromstring(read.read(f"{GUID}/markup.bcf")).find("Topic")
    assert topic.find("Description").text == "loose nosing"
    assert GUID in (tmp_path / "stair.json").read_text(encoding="utf-8")


def test_a_file_that_cannot_be_written_is_said_before_the_work(run, tmp_path, stair_file, project_file):  # noqa: F811
    folder = tmp_path / "folder.bcf"
    folder.mkdir()
    result = tmp_path / "out" / f"{stair_file.stem}.json"
    ending = "does not end in .bcf or .bcfzip"
    for target, reason in ((folder, "is a folder"), (stair_file, ending), (project_file, ending), (result, ending)):
        code, out, err = run("measure", "--project", project_file, stair_file, "-o", tmp_path / "out", "--bcf", target)
        assert (code, out) == (2, "")
        assert err.endswith(f"{reason}; give another file with --bcf\n")
        assert err.count("\n") == 1
