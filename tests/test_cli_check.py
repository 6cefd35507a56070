"""``check`` and ``rules`` on the command line: exit codes, what is printed, what is written, one line for an error."""

import dataclasses
import json

import pytest

from stair_inspector import pipeline
from stair_inspector.codes import check
from stair_inspector.content.check_records import check_record
from stair_inspector.files import scans
from stair_inspector.files.paths import sample_scans, static_configs
from stair_inspector.files.ply import ply_bytes
from stair_inspector.files.rule_sets import find_rule_set, list_rule_sets
from stair_inspector.files.scans import read_scan
from stair_inspector.model import Observation
from stair_inspector.params import Params
from stair_inspector.pipeline import inspect
from stair_inspector.writers.text import check_text
from tests.synthetic import Stair
from tests.test_cli import UP_Z, refusal, run, stair_file  # noqa: F401 - fixtures
from tests.test_samples import load_sample
from tests.writers.samples import scanned

STRAIGHT, DEFECTIVE = (sample_scans() / f"{name}.ply" for name in ("straight", "defective_step"))
QUESTION = Observation("unit_unsure", "question", "inches or centimetres", None, "--unit in")
DOUBT = Observation("sparse", "doubt", "a tread has 40 points", None, "--levels.eps-m 0.03")


@pytest.fixture
def kept_samples(monkeypatch):
    """Let a command go on with the samples as other tests have read them, and as far as these have measured them."""
    kept = {path: load_sample(path.stem) for path in (STRAIGHT, DEFECTIVE)}

    def read(path, *reading):
        assert reading[0] == "auto"
        return kept[path][0]

    def measure(scan, params, memo):
        return inspect(scan, params, load_sample(scan.name.removesuffix(".ply"))[1])

    monkeypatch.setattr(scans, "read_scan", read)
    monkeypatch.setattr(pipeline, "inspect", measure)


@pytest.fixture
def floor_file(tmp_path):
    points, *_ = Stair(n_steps=1, noise=0.002).sample()
    path = tmp_path / "floor.ply"
    path.write_bytes(ply_bytes(points[points[:, 2] < 0.05]))
    return path


# --- rules ---------------------------------------------------------------------------------------------------------


def test_rules_lists_every_set_with_edition_grades_and_hash(run):  # noqa: F811
    code, out, err = run("rules")
    assert (code, err) == (0, "")
    lines = out.splitlines()
    for rule_set in list_rule_sets():
        row = next(number for number, line in enumerate(lines) if line.split("  ")[0] == rule_set.set_id)
        assert rule_set.grades in lines[row].split()
        assert rule_set.edition in lines[row]
        assert rule_set.name in lines[row]
        assert lines[row + 1].split() == ["SHA-256", rule_set.sha256]
    assert "grade P: official text, or a word-for-word copy of it, was read" in lines


@pytest.mark.parametrize("set_id", [rule_set.set_id for rule_set in list_rule_sets()])
def test_every_record_of_a_set_is_shown(run, set_id):  # noqa: F811
    code, out, _ = run("rules", "--show", set_id)
    assert code == 0
    for rule in find_rule_set(set_id).rules:
        assert f"  {rule.rule_id}: {rule.term}, {rule.limit_text} ({rule.clause})" in out
        assert rule.note in out


@pytest.mark.slow
def test_a_set_can_be_copied_and_changed(run, tmp_path):  # noqa: F811
    code, out, _ = run("rules", "--toml", "us-irc-2024")
    assert code == 0
    assert out == (static_configs() / "codes" / "us-irc-2024.toml").read_text(encoding="utf-8")
    mine = tmp_path / "mine.toml"
    mine.write_text(out.replace('"7 3/4 in"', '"9 in"'), encoding="utf-8")
    assert refusal(run, "check", STRAIGHT, "--rules", mine).endswith(
        "the id 'us-irc-2024' is that of a set that comes with the program; give the file another id"
    )
    mine.write_text(out.replace('"us-irc-2024"', '"my-town"').replace('"7 3/4 in"', '"6 1/2 in"'), encoding="utf-8")
    code, out, _ = run("check", STRAIGHT, "--rules", mine)
    assert code == 1
    assert "at most 6 1/2 in (165.1 mm)" in out
    assert "my-town" in out
    assert "edited by the user: user's own file, not a set that comes with the program" in out


def test_rules_refuses_what_it_does_not_know(run):  # noqa: F811
    assert refusal(run, "rules", "--show", "us-irc-2025").startswith("rules: unknown rule set 'us-irc-2025'; did you")
    assert refusal(run, "rules", "--show", "us-irc-2024", "--toml", "us-irc-2024") == (
        "rules: got --show and --toml; give one of them"
    )


# --- check ---------------------------------------------------------------------------------------------------------


@pytest.mark.usefixtures("kept_samples")
def test_a_stair_with_nothing_outside_is_exit_0(run):  # noqa: F811
    code, out, err = run("check", STRAIGHT, "--rules", "us-irc-2024", "--preset", "tls")
    assert (code, err) == (0, "")
    assert out.startswith("straight.ply checked against us-irc-2024: International Residential Code, 2024\n")
    assert "Nothing that was measured is outside a limit of International Residential Code, 2024." in out


@pytest.mark.usefixtures("kept_samples")
def test_a_stair_with_a_defect_is_exit_1_and_says_where(run):  # noqa: F811
    command = ("check", DEFECTIVE, "--preset", "tls", "--rules", "us-irc-2024", "--overlay", "us-nfpa-101-uniformity")
    code, out, err = run(*command)
    assert (code, err) == (1, "")
    scan, inspection = scanned()
    from stair_inspector.codes import overlaid

    rule_set = overlaid(find_rule_set("us-irc-2024"), find_rule_set("us-nfpa-101-uniformity"))
    assert out == f"{scan.name} {check_text(check(inspection, rule_set))}\n\n"
    assert "slope of the walking surface of treads, step 3: " in out
    assert "with the overlay NFPA 101, dimensional uniformity" in out
    assert "Outside the limits listed in R318.7.5.1; R318.7.5.2; R318.7.7; NFPA 101, 7.2.2.3.6 (Int" in out


@pytest.mark.slow
def test_simple_acceptance_is_printed_with_its_rule(run):  # noqa: F811
    code, out, _ = run("check", DEFECTIVE, "--rules", "us-ibc-2024", "--decision", "simple")
    assert code == 1
    assert "Simple acceptance: a value is within a limit when the measured value is" in out
    assert "close" not in out


def test_no_staircase_is_no_pass_and_exit_3(run, floor_file):  # noqa: F811
    code, out, err = run("check", floor_file, "--rules", "us-ibc-2024", "--unit", "m", "--up", "z")
    assert code == 3
    assert "not measured" in out
    assert "which is no pass" in out
    assert err == f"stair-inspector: {floor_file}: nothing could be judged: no staircase was found\n"


@pytest.fixture
def asked_of(monkeypatch):
    """Let every scan that is read from now on raise a question."""

    def ask(*observations):
        monkeypatch.setattr(
            scans,
            "read_scan",
            lambda path, *reading: dataclasses.replace(read_scan(path, *reading), observations=observations),
        )

    return ask


@pytest.mark.parametrize("command", ["check", "measure"])
def test_what_was_found_about_the_scan_is_printed_first(run, tmp_path, asked_of, stair_file, command):  # noqa: F811
    plainly = run(command, stair_file, *UP_Z, "--rules", "us-ibc-2024", "-o", tmp_path)
    asked_of(DOUBT)
    code, out, err = run(command, stair_file, *UP_Z, "--rules", "us-ibc-2024", "-o", tmp_path)
    lines = out.splitlines(keepends=True)
    assert lines[:2] == [
        "stair.ply examined:\n",
        "  doubt: a tread has 40 points; measure again with --levels.eps-m 0.03\n",
    ]
    assert (code, "".join(lines[2:]), err) == plainly


def test_an_open_question_is_exit_3_and_no_verdict(run, tmp_path, asked_of, stair_file):  # noqa: F811
    asked_of(DOUBT, QUESTION)
    code, out, err = run("check", stair_file, *UP_Z, "--rules", "us-ibc-2024", "-o", tmp_path)
    assert code == 3
    assert err == (
        f"stair-inspector: {stair_file}: nothing could be judged: a question about the scan has to be answered first: "
        "inches or centimetres\n"
    )
    assert out.startswith("stair.ply examined:\n  question: inches or centimetres; answer it with --unit in\n  doubt:")
    document = json.loads((tmp_path / "stair.json").read_text())
    assert {found["verdict"] for found in document["check"]["findings"]} == {"not_judged", "not_assessed"}
    assert [found["level"] for found in document["examination"]] == ["doubt", "question"]
    assert {step["rise_m"] for step in document["steps"]} == {None}


def test_the_papers_method_is_not_judged(run, stair_file):  # noqa: F811
    code, out, err = run("check", stair_file, *UP_Z, "--rules", "us-ibc-2024", "--method", "paper")
    assert code == 3
    assert "measure with the method survey" in err
    assert "outside" not in out.split("not measured or not judged")[1]


@pytest.mark.slow
def test_several_scans_are_all_checked(run, floor_file):  # noqa: F811
    code, out, err = run("check", STRAIGHT, DEFECTIVE, floor_file, "--rules", "us-irc-2024")
    assert code == 3
    assert [line.split()[0] for line in out.splitlines() if " checked against " in line] == [
        "straight.ply",
        "defective_step.ply",
        "floor.ply",
    ]
    assert err.count("\n") == 1


@pytest.mark.slow
@pytest.mark.parametrize("command", ["check", "measure"])
def test_the_check_is_in_the_json(run, tmp_path, command):  # noqa: F811
    code, out, _ = run(command, DEFECTIVE, "--rules", "us-irc-2024", "-o", tmp_path)
    assert code == (1 if command == "check" else 0)
    assert "defective_step.json" in out
    document = json.loads((tmp_path / "defective_step.json").read_text(encoding="utf-8"))
    expected = check_record(check(inspect(read_scan(DEFECTIVE), Params()), find_rule_set("us-irc-2024")))
    assert document["check"] == json.loads(json.dumps(expected))


@pytest.mark.slow
def test_without_a_folder_nothing_is_written(run, tmp_path, monkeypatch):  # noqa: F811
    monkeypatch.chdir(tmp_path)
    assert run("check", STRAIGHT, "--rules", "us-irc-2024")[0] == 0
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("args", "line"),
    [
        (
            ["check", STRAIGHT],
            "check: no rule set given; name one with --rules (see: stair-inspector rules)",
        ),
        (["check", "--rules", "us-irc-2024"], "check: no scan given; name at least one file or folder"),
        (["check", STRAIGHT, "--rules", "us-irc-2023"], "rules: unknown rule set 'us-irc-2023'; did you mean"),
        (["check", STRAIGHT, "--rules", "none.toml"], "none.toml: cannot be read (No such file or directory)"),
        (
            ["check", STRAIGHT, "--rules", "us-irc-2024", "--overlay", "us-ibc-2024"],
            "rule set us-ibc-2024 is a full set, no overlay; check against it by itself",
        ),
        (
            ["check", STRAIGHT, "--rules", "us-irc-2024", "--decision", "kind"],
            "check: --decision: got 'kind'; give one of guarded, simple",
        ),
        (
            ["measure", STRAIGHT, "-o", "out", "--overlay", "us-nfpa-101-uniformity"],
            "measure: got --overlay without a rule set; name one with --rules",
        ),
        (
            ["measure", STRAIGHT, "-o", "out", "--decision", "simple"],
            "measure: got --decision without a rule set; name one with --rules",
        ),
    ],
    ids=str,
)
def test_wrong_usage_is_one_line_and_exit_2(run, args, line):  # noqa: F811
    assert refusal(run, *args).startswith(line)


@pytest.mark.slow
def test_a_missing_scan_is_exit_3_and_the_others_are_checked(run, tmp_path):  # noqa: F811
    code, out, err = run("check", tmp_path / "none.ply", STRAIGHT, "--rules", "us-irc-2024")
    assert code == 3
    assert "straight.ply checked against" in out
    assert "none.ply" in err
