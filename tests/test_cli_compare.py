"""``compare`` on the command line: exit codes, what is printed and written, one line for an error."""

import hashlib
import json
import shutil
from dataclasses import replace

import pytest

from stair_inspector.files.ply import ply_bytes
from stair_inspector.files.project_files import parse_project, save_project
from stair_inspector.files.projects import Project, SecondScan
from stair_inspector.params import Params
from tests.synthetic import Stair
from tests.test_cli import refusal, run  # noqa: F401 - fixtures

GIVEN = ("--up", "z", "--unit", "m")


@pytest.fixture(scope="module")
def scans(tmp_path_factory):
    folder = tmp_path_factory.mktemp("epochs")
    for name, stair in {
        "earlier": Stair(noise=0.001, seed=1),
        "later": Stair(noise=0.001, seed=2),
        "other": Stair(noise=0.001, rise=0.2, going=0.24),
    }.items():
        (folder / f"{name}.ply").write_bytes(ply_bytes(stair.sample()[0]))
    return folder


def test_two_scans_are_compared_and_written(run, scans, tmp_path):  # noqa: F811
    code, out, err = run("compare", scans / "earlier.ply", scans / "later.ply", *GIVEN, "-o", tmp_path / "made")
    assert (code, err) == (0, "")
    lines = out.splitlines()
    assert lines[0].startswith("earlier.ply -> later.ply: 5 steps in both; laid onto each other with U of a height of ")
    assert "  no value changed by more than its uncertainty and chance explain" in lines
    made = tmp_path / "made" / "earlier_later_comparison.json"
    manifest = made.parent / "earlier_later.manifest.json"
    assert lines[-1] == f"  wrote {made}, {made.with_suffix('.csv')}, {manifest}"
    assert [each["file"] for each in json.loads(manifest.read_text())["scans"]] == ["earlier.ply", "later.ply"]
    assert json.loads(made.read_text())["schema"] == "stair-inspector/comparison-1"


def test_another_stair_is_one_sentence_and_exit_code_3(run, scans):  # noqa: F811
    code, out, err = run("compare", scans / "earlier.ply", scans / "other.ply", *GIVEN)
    assert (code, out) == (3, "")
    assert err.startswith("stair-inspector: earlier.ply and other.ply: not the same stair, or too little in common: ")
    assert err.count("\n") == 1


def test_a_missing_scan_is_exit_code_3_and_wrong_usage_2(run, scans, tmp_path):  # noqa: F811
    code, _, err = run("compare", scans / "earlier.ply", tmp_path / "none.ply", *GIVEN)
    assert code == 3
    assert "none.ply" in err
    assert "--method paper" in refusal(run, "compare", scans / "earlier.ply", scans / "later.ply", "--method", "paper")
    assert refusal(run, "compare", scans / "earlier.ply")
    (tmp_path / "file").write_text("")
    given = ("compare", scans / "earlier.ply", scans / "later.ply", "-o", tmp_path / "file")
    assert "is a file, not a folder" in refusal(run, *given)


def test_a_report_has_a_page_on_what_changed(run, scans, tmp_path, monkeypatch):  # noqa: F811
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    (tmp_path / "fields.toml").write_text('[fields]\nclient = "The Client"\n')
    code, out, err = run(
        "compare", scans / "earlier.ply", scans / "later.ply", *GIVEN, "-o", tmp_path, "--report",
        "--fields", tmp_path / "fields.toml",
    )  # fmt: skip
    assert (code, err) == (0, "")
    made = [tmp_path / f"earlier_later_report{suffix}" for suffix in (".pdf", ".html", ".xlsx")]
    assert all(str(path) in out.splitlines()[-1] and path.exists() for path in made)
    page = made[1].read_text()
    assert "Changes between two scans" in page
    assert "The Client" in page
    assert 'id="change_1"' in page
    assert "2023-11-14" in page


def test_a_report_needs_a_folder(run, scans):  # noqa: F811
    given = ("compare", scans / "earlier.ply", scans / "later.ply", "--full-report")
    assert "compare: got --full-report without a folder; name one with -o" in refusal(run, *given)


@pytest.fixture
def project(scans, tmp_path):
    """The project of the later scan, which is compared with the earlier one as it lies beside it."""
    for name in ("earlier", "later"):
        shutil.copy(scans / f"{name}.ply", tmp_path)
    sha256 = {path.stem: hashlib.sha256(path.read_bytes()).hexdigest() for path in tmp_path.glob("*.ply")}
    second = SecondScan("/elsewhere/earlier.ply", sha256["earlier"], is_earlier=True)
    path = tmp_path / "later.stair.json"
    save_project(path, Project("later.ply", sha256["later"], Params(up="z", unit="m"), second=second))
    return path


def test_measure_with_a_project_compares_with_its_second_scan(run, project, tmp_path):  # noqa: F811
    code, _, err = run("measure", "--project", project, "-o", tmp_path / "made", "--report")
    assert (code, err) == (0, "")
    document = json.loads((tmp_path / "made" / "later.json").read_text())
    assert document["comparison"]["before"]["file"] == "earlier.ply"
    assert "Changes between two scans" in (tmp_path / "made" / "later_report.html").read_text()
    # The paper's values have no uncertainty and are not compared.
    assert run("measure", "--project", project, "-o", tmp_path / "paper", "--method", "paper")[0] == 0
    assert json.loads((tmp_path / "paper" / "later.json").read_text())["comparison"] is None


def test_a_second_scan_is_read_in_the_unit_of_its_own_project(run, project, scans, tmp_path):  # noqa: F811
    # In feet, which no stair tells from others by itself here: its own project states it.
    path = tmp_path / "earlier.ply"
    path.write_bytes(ply_bytes(Stair(noise=0.001, seed=1).sample()[0] / 0.3048))
    sha256 = hashlib.sha256(path.read_bytes()).hexdigest()
    save_project(tmp_path / "earlier.stair.json", Project("earlier.ply", sha256, Params(up="z", unit="ft")))
    later = parse_project(project.read_bytes(), project.name)
    save_project(project, replace(later, second=replace(later.second, sha256=sha256)))
    code, _, err = run("measure", "--project", project, "-o", tmp_path / "made")
    assert (code, err) == (0, "")
    assert json.loads((tmp_path / "made" / "later.json").read_text())["comparison"]["before"]["unit"] == "ft"
    # A project of another scan says nothing of it.
    save_project(tmp_path / "earlier.stair.json", Project("earlier.ply", "0" * 64, Params(up="z", unit="in")))
    assert run("measure", "--project", project, "-o", tmp_path / "again")[0] in (0, 3)
    found = json.loads((tmp_path / "again" / "later.json").read_text())["comparison"]
    assert found is None or found["before"]["unit"] != "in"


@pytest.mark.parametrize("is_gone", [True, False])
def test_a_second_scan_that_is_gone_or_changed_is_a_sentence_beside_the_results(
    run,  # noqa: F811
    project,
    tmp_path,
    is_gone,
):
    if is_gone:
        (tmp_path / "earlier.ply").unlink()
    else:
        shutil.copy(tmp_path / "later.ply", tmp_path / "earlier.ply")
    code, _, err = run("measure", "--project", project, "-o", tmp_path / "made")
    assert code == 3
    assert err.count("\n") == 1
    words = "is neither there nor beside the project" if is_gone else "has changed since the project"
    assert words in err
    assert json.loads((tmp_path / "made" / "later.json").read_text())["comparison"] is None


def test_a_scan_is_not_compared_with_itself(run, scans):  # noqa: F811
    given = ("compare", scans / "earlier.ply", scans / "earlier.ply", *GIVEN)
    assert "are one scan, byte for byte; give two scans of the stair" in refusal(run, *given)


def test_the_scan_of_a_project_is_not_taken_for_a_second_one_of_its_name(run, project, tmp_path):  # noqa: F811
    found = parse_project(project.read_bytes(), "project")
    save_project(project, replace(found, second=replace(found.second, file="/elsewhere/later.ply")))
    code, _, err = run("measure", "--project", project, "-o", tmp_path / "made")
    assert code == 3
    assert "/elsewhere/later.ply: this second scan of the project" in err
    assert "is neither there nor beside the project" in err
