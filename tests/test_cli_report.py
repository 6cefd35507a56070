"""``--report`` on the command line: which files, whose fields and rules, one line for an error."""

import hashlib
import json

import pytest
from pypdf import PdfReader

from stair_inspector.codes import RuleEdit
from stair_inspector.codes.limits import Limit
from stair_inspector.content.basis_files import basis_to_dict
from stair_inspector.content.fields import ReportBasis, ReportFields
from stair_inspector.content.readings import TapeReading
from stair_inspector.files.chosen_rules import ChosenRules
from stair_inspector.files.project_files import save_project
from stair_inspector.files.projects import Project
from stair_inspector.params import Params
from tests.test_cli import refusal, run, stair_file  # noqa: F401 - fixtures

NAMES = ("_report.pdf", "_report.html", "_report.xlsx", "_plan.dxf", "_section.dxf")


def pdf_text(path):
    return "\n".join(page.extract_text() for page in PdfReader(path).pages)


@pytest.fixture
def project_file(tmp_path, stair_file):  # noqa: F811
    """A project with rules of which one limit was changed, and with fields and a reading for the report."""
    riser = Limit.of("7 3/4", "in")
    basis = ReportBasis(
        fields=ReportFields(client="Client Ltd", report_number="R-17"),
        readings=(TapeReading("rise", 0.171, step=2, instrument="steel tape"),),
    )
    project = Project(
        scan_file=stair_file.name,
        scan_sha256=hashlib.sha256(stair_file.read_bytes()).hexdigest(),
        params=Params().replaced("levels.eps_m", 0.021),
        title="North stair",
        rules=ChosenRules(
            "us-irc-2024",
            decision="simple",
            edits=(RuleEdit("riser", "maximum", riser, Limit.of("6", "in"), "an older text"),),
        ),
        report=basis_to_dict(basis),
    )
    path = stair_file.with_name("kept.stair.json")
    save_project(path, project)
    return path


@pytest.mark.slow
def test_a_report_is_written_beside_the_files_of_measure_and_said(run, tmp_path, stair_file):  # noqa: F811
    code, out, err = run("measure", stair_file, "-o", tmp_path, "--report", "--rules", "us-irc-2024")
    assert (code, err) == (0, "")
    for name in NAMES:
        path = tmp_path / f"{stair_file.stem}{name}"
        assert str(path) in out
        assert path.stat().st_size > 1000
    text = pdf_text(tmp_path / f"{stair_file.stem}_report.pdf")
    assert "R318.7.5.1" in text
    assert hashlib.sha256(stair_file.read_bytes()).hexdigest() in text.replace("\n", "")


@pytest.mark.slow
def test_a_report_holds_what_the_file_of_fields_says(run, tmp_path, stair_file):  # noqa: F811
    fields = tmp_path / "fields.toml"
    fields.write_text('[fields]\nclient = "#set page() <b>&amp;"\nfirm = "Own Engineers"\n', encoding="utf-8")
    assert run("measure", stair_file, "-o", tmp_path, "--report", "--fields", fields)[0] == 0
    text = pdf_text(tmp_path / f"{stair_file.stem}_report.pdf")
    assert "#set page() <b>&amp;" in text
    assert "Own Engineers" in text
    # Nothing was held against a rule set, and nothing is said of one.
    assert "R318" not in text


@pytest.mark.slow
def test_a_project_brings_its_rules_its_fields_and_its_title(run, tmp_path, project_file):  # noqa: F811
    out = tmp_path / "out"
    assert run("measure", "--project", project_file, "-o", out, "--full-report")[0] == 0
    (path,) = out.glob("*_report.pdf")
    text = pdf_text(path)
    for words in ("Client Ltd", "R-17", "North stair", "6 in (152.4 mm)", "an older text", "steel tape"):
        assert words in text
    (record,) = (path for path in out.glob("*.json") if not path.name.endswith(".manifest.json"))
    found = json.loads(record.read_text(encoding="utf-8"))["check"]
    assert found["decision"]["rule"] == "simple"
    # What is said on the command line counts before what the project holds.
    assert run("check", "--project", project_file, "--rules", "us-osha-1910-25", "-o", out, "--full-report")[0] in (
        0,
        1,
    )
    text = pdf_text(path)
    assert "1910.25" in text
    assert "an older text" not in text


def test_a_projects_rules_are_checked_without_naming_them(run, project_file):  # noqa: F811
    code, out, _ = run("check", "--project", project_file)
    assert code == 1
    assert "6 in (152.4 mm)" in out
    assert "an older text" in out


@pytest.mark.slow
def test_the_same_project_at_the_same_time_gives_the_same_files(run, tmp_path, project_file, monkeypatch):  # noqa: F811
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1795000000")
    made = []
    for name in ("a", "b"):
        assert run("measure", "--project", project_file, "-o", tmp_path / name, "--report")[0] == 0
        made.append({path.name: path for path in (tmp_path / name).iterdir() if path.suffix != ".json"})
    assert len(made[0]) == 7
    assert made[0].keys() == made[1].keys()
    assert [name for name in made[0] if made[0][name].read_bytes() != made[1][name].read_bytes()] == []
    report = next(path for path in made[0].values() if path.suffix == ".html").read_text()
    assert "2026-11-18" in report


def test_a_time_that_is_none_is_refused(run, tmp_path, stair_file, monkeypatch):  # noqa: F811
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "noon")
    sentence = refusal(run, "measure", stair_file, "-o", tmp_path, "--report")
    assert "SOURCE_DATE_EPOCH: got 'noon'; give whole seconds since 1970" in sentence
    assert list(tmp_path.glob("*_report.*")) == []


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("measure", "-o", ".", "--fields", "a.toml"), "got --fields without --report; give both"),
        (("check", "--rules", "us-ada-2010", "--report"), "got --report without a folder; name one with -o"),
        (("measure", "-o", ".", "--report", "--fields", "nowhere.toml"), "nowhere.toml"),
        (("measure", "-o", ".", "--overlay", "us-nfpa-101-uniformity"), "got --overlay without a rule set"),
    ],
)
def test_a_wrong_wish_is_one_sentence(run, stair_file, words, sentence):  # noqa: F811
    command, *options = words
    assert sentence in refusal(run, command, stair_file, *options)
