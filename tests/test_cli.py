"""The command line: exit codes, one pinned line for every error, results on stdout and nothing else there."""

import csv
import hashlib
import importlib
import json
import subprocess
import sys
from inspect import getsource
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import stair_inspector
from stair_inspector import cli, stability
from stair_inspector.errors import ConfigError, MissingLibrary
from stair_inspector.files.ply import ply_bytes
from stair_inspector.files.project_files import save_project
from stair_inspector.files.projects import KeptRun, Measurement, Project
from stair_inspector.files.scans import FOLDER_SUFFIXES, read_scan
from stair_inspector.files.settings import list_presets, params_to_dict
from stair_inspector.params import SETTINGS, Params
from stair_inspector.pipeline import inspect
from stair_inspector.quantities import PAPER_QUANTITIES, QUANTITIES
from stair_inspector.writers.inspection import inspection_files
from tests.synthetic import Stair

ROOT = Path(__file__).parent.parent
COMMANDS = ("view", "measure", "check", "compare", "verify", "rules", "simulate", "presets", "quantities", "completion")
UP_Z = ("--up", "z", "--unit", "m")


@pytest.fixture(scope="module")
def stair_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("scans") / "stair.ply"
    path.write_bytes(ply_bytes(Stair(noise=0.002).sample()[0]))
    return path


@pytest.fixture
def run(capsys):
    def call(*args):
        """Exit code, stdout and stderr of a command."""
        try:
            code = cli.main([str(arg) for arg in args])
        except SystemExit as leaving:
            code = leaving.code
        out, err = capsys.readouterr()
        return code, out, err

    return call


def refusal(run, *args):
    """The one line of a command that must not even begin, without the program's name."""
    code, out, err = run(*args)
    assert code == 2
    assert out == ""
    assert err.startswith("stair-inspector: ")
    assert err.count("\n") == 1
    return err.removeprefix("stair-inspector: ").rstrip("\n")


# --- help ----------------------------------------------------------------------------------------------------------


def test_options_are_known_without_parsing_the_source_for_each(run, monkeypatch):
    refusal(run, "measure", "--qqq")
    parsed = []
    monkeypatch.setattr("inspect.getsource", lambda what: parsed.append(what) or getsource(what))
    refusal(run, "measure", "--qqq")
    # The settings as a whole are looked up once, whatever is set.
    assert set(parsed) <= {Params}


def test_help_is_on_stdout_and_imports_nothing_slow():
    # One process asks for all: what one of them imports stays imported.
    script = (
        "import sys\n"
        "from stair_inspector.cli import main\n"
        "for args in sys.argv[1:]:\n"
        "    try:\n        code = main(args.split())\n"
        "    except SystemExit as leaving:\n        code = leaving.code\n"
        "    slow = {'open3d', 'viser', 'sklearn', 'trimesh', 'scipy', 'pandas', 'matplotlib'} & set(sys.modules)\n"
        "    print(args, code, sorted(slow), file=sys.stderr)\n"
        "    print('that was', args)\n"
    )
    asked = ["--help", "-h", *(f"{command} --help" for command in COMMANDS)]
    run = subprocess.run([sys.executable, "-c", script, *asked], cwd=ROOT, capture_output=True, text=True, check=False)
    assert run.returncode == 0
    assert run.stderr.splitlines() == [f"{args} 0 []" for args in asked]
    rest = run.stdout
    for args in asked:
        said, _, rest = rest.partition(f"that was {args}\n")
        assert said.startswith("usage: stair-inspector"), args
    assert rest == ""


def test_the_help_names_every_command_and_exit_code(run):
    code, out, _ = run("--help")
    assert code == 0
    for command in COMMANDS:
        assert f"\n  {command} " in out
    assert (
        "exit codes: 0 done; 1 check found a value outside a limit, or verify files that do not belong together;" in out
    )
    assert "2 wrong usage or settings" in out
    assert "3 a scan could not be read or measured" in out


@pytest.mark.parametrize("command", ["measure", "view"])
def test_every_setting_has_a_flag_with_its_help(run, command):
    code, out, _ = run(command, "--help")
    assert code == 0
    words = " ".join(out.replace("│", " ").split())
    for name in SETTINGS:
        flag = f"--{name}".replace("_", "-")
        assert f"{flag} " in words, flag
        assert SETTINGS.setting(name).documentation.split(".")[0][:30] in words, flag


def test_every_command_is_a_file_that_is_imported_when_it_is_called():
    assert cli.COMMANDS == COMMANDS
    script = "import sys, stair_inspector.cli; print(*(name for name in sys.modules if name.startswith('tyro')))"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == ""
    for command in COMMANDS:
        assert callable(importlib.import_module(f"stair_inspector.cli.{command}").run)


def test_the_version(run):
    assert run("--version") == (0, f"stair-inspector {stair_inspector.__version__}\n", "")


def test_quantities_are_listed_with_their_definitions(run):
    code, out, err = run("quantities")
    assert (code, err) == (0, "")
    for quantity in (*QUANTITIES, *PAPER_QUANTITIES):
        assert any(
            line.split()[:1] == [quantity.name] and line.endswith(quantity.definition) for line in out.splitlines()
        )


def test_presets_are_listed_with_their_descriptions(run):
    code, out, err = run("presets")
    assert (code, err) == (0, "")
    lines = out.splitlines()
    presets = list_presets()
    assert [line.split()[0] for line in lines] == [preset.name for preset in presets]
    assert all(line.endswith(preset.description) for line, preset in zip(lines, presets, strict=True))


# --- measure -------------------------------------------------------------------------------------------------------


def test_measure_prints_the_papers_table_and_writes_its_files(run, stair_file, tmp_path):
    code, out, err = run("measure", stair_file, "-o", tmp_path / "out", *UP_Z, "--method", "paper")
    assert (code, err) == (0, "")
    assert sorted(file.name for file in (tmp_path / "out").iterdir()) == [
        "stair.csv",
        "stair.json",
        "stair.manifest.json",
        "stair_debug.ply",
    ]
    lines = out.splitlines()
    n_points = len(Stair().sample()[0])
    assert lines[0].partition(", normals by")[0] == f"stair.ply: {n_points:,} of {n_points:,} points, 5 steps"
    assert lines[0].endswith(("normals by Open3D", "normals by numpy and SciPy"))
    assert lines[1].split() == ["step", "points", "h_mm", "d_FB_mm", "d_FF_mm", "W_mm", "theta_deg", "RMS_mm"]
    document = json.loads((tmp_path / "out" / "stair.json").read_text())
    for line, step in zip(lines[2:7], document["steps"], strict=True):
        paper = step["paper"]
        values = [paper["h_m"], paper["d_fb_m"], paper["d_ff_m"], paper["w_m"]]
        expected = [str(step["id"]), str(step["n_points"])]
        expected += ["-" if value is None else f"{value * 1000:.1f}" for value in values]
        expected += ["-" if paper["theta_deg"] is None else f"{paper['theta_deg']:.1f}", f"{step['rms_m'] * 1000:.2f}"]
        assert line.split() == expected
    assert lines[6].split()[2] == "-", "the last step has no h"
    for note in document["notes"]:
        assert f"  {note['message']}" in lines
    for suffix in (".json", ".csv", "_debug.ply"):
        assert str(tmp_path / "out" / f"stair{suffix}") in out


def test_measure_prints_the_surveys_values_with_their_uncertainties(run, stair_file, tmp_path):
    code, out, err = run("measure", stair_file, "-o", tmp_path / "out", *UP_Z)
    assert (code, err) == (0, "")
    lines = out.splitlines()
    assert lines[1].split() == ["step", "rise_mm", "going_mm", "depth_mm", "width_mm", "pitch_deg", "coverage"]
    document = json.loads((tmp_path / "out" / "stair.json").read_text())
    (flight,) = document["flights"]
    assert lines[2] == f"  flight 1: straight, {flight['n_risers']} risers"

    def shown(measured, scale):
        if measured is None:
            return ["-"]
        # Never a zero: u has one digit that means something, two below a tenth; the value as many decimals.
        u = max(scale * measured["u"], 0.01)
        digits = 0 if u >= 9.95 else 1 if u >= 0.095 else 2
        return [f"{scale * measured['value']:.{digits}f}", "±", f"{u:.{digits}f}"]

    for line, step in zip(lines[3:8], document["steps"], strict=True):
        expected = ["landing"] if step["kind"] == "landing" else []
        expected.append(str(step["id"]))
        for name in ("rise_m", "going_m", "tread_depth_m", "width_m"):
            expected += shown(step[name], 1000.0)
        expected += [*shown(step["pitch_deg"], 1.0), f"{100.0 * step['coverage']:.0f}", "%"]
        assert line.split() == expected


def test_flags_reach_the_settings_of_the_result(run, stair_file, tmp_path):
    args = (
        "--levels.eps-m",
        "0.03",
        "--edges.front-percentile=90",
        "--method",
        "paper",
        "--horizontal.theta-deg",
        "12",
    )
    assert run("measure", stair_file, "-o", tmp_path, *UP_Z, *args)[0] == 0
    settings = json.loads((tmp_path / "stair.json").read_text())["settings"]
    assert settings["levels"] == {"eps_m": 0.03, "min_points": 50}
    assert settings["edges"]["front_percentile"] == 90.0
    assert (settings["method"], settings["horizontal"]["theta_deg"], settings["up"]) == ("paper", 12.0, "z")


def test_flags_change_the_values_of_a_preset(run, stair_file, tmp_path):
    preset = tmp_path / "mine.toml"
    preset.write_text("[levels]\neps_m = 0.03\nmin_points = 20\n")
    args = ("--preset", preset, "--levels.min-points", "30")
    assert run("measure", stair_file, "-o", tmp_path, *UP_Z, *args)[0] == 0
    assert json.loads((tmp_path / "stair.json").read_text())["settings"]["levels"] == {"eps_m": 0.03, "min_points": 30}


@pytest.mark.parametrize("up", [["--up", "-x"], ["--up=-x"], ["--up", "-1,0,0"], ["--up", "-0.5,0.0,-0"]], ids=" ".join)
def test_an_up_that_begins_with_a_dash_is_no_flag(run, stair_file, tmp_path, up):
    code, _, err = run("measure", stair_file, "-o", tmp_path, *up)
    assert (code, err) == (0, "")
    vector = json.loads((tmp_path / "stair.json").read_text())["up"]["vector"]
    np.testing.assert_allclose(vector, [-1.0, 0.0, 0.0], atol=1e-15)


def test_a_scan_without_a_staircase_is_a_result_and_not_an_error(run, stair_file, tmp_path):
    code, out, err = run("measure", stair_file, "-o", tmp_path, "--up", "x")
    assert (code, err) == (0, "")
    assert "  no staircase found: " in out
    with (tmp_path / "stair.csv").open() as stream:
        assert list(csv.DictReader(stream)) == []


def test_a_folder_stands_for_its_scans(run, stair_file, tmp_path):
    for name in ("b.ply", "a.PLY", "notes.txt", ".hidden.ply"):
        (tmp_path / name).write_bytes(stair_file.read_bytes())
    code, out, _ = run("measure", tmp_path, "-o", tmp_path / "out", *UP_Z)
    assert code == 0
    assert [line.split(":")[0] for line in out.splitlines() if " points, " in line] == ["a.PLY", "b.ply"]


def test_with_several_scans_the_others_are_still_done(run, stair_file, tmp_path):
    (tmp_path / "bad.ply").write_bytes(b"ply\n")
    (tmp_path / "few.xyz").write_text("0 0 0\n1 0 0\n0 1 0\n")
    missing = tmp_path / "missing.ply"
    scans = (tmp_path / "bad.ply", missing, tmp_path / "few.xyz", stair_file)
    code, out, err = run("measure", *scans, "-o", tmp_path / "out", *UP_Z)
    assert code == 3
    errors = err.splitlines()
    assert len(errors) == 3
    assert [next(k for k, scan in enumerate(scans) if scan.name in line) for line in errors] == [1, 0, 2]
    assert "stair.ply: " in out
    names = ["stair.csv", "stair.json", "stair.manifest.json", "stair_debug.ply"]
    assert sorted(file.name for file in (tmp_path / "out").iterdir()) == names


def test_the_same_file_named_twice_is_measured_once(run, stair_file, tmp_path):
    code, out, _ = run("measure", stair_file, stair_file, "-o", tmp_path, *UP_Z)
    assert code == 0
    assert out.count(" points, ") == 1


@pytest.mark.slow
def test_the_program_runs_as_a_process_and_stays_quiet_on_stderr(stair_file, tmp_path):
    script = "import sys; from stair_inspector.cli import main; sys.exit(main())"
    args = [sys.executable, "-c", script, "measure", str(stair_file), "-o", str(tmp_path)]
    run = subprocess.run(args, cwd=ROOT, capture_output=True, text=True, check=False)
    assert (run.returncode, run.stderr) == (0, "")
    assert "5 steps" in run.stdout


@pytest.mark.slow
def test_a_stdout_that_lacks_a_character_does_not_end_the_program(tmp_path, stair_file):
    (tmp_path / "Stiege_ä.ply").write_bytes(stair_file.read_bytes())
    script = (
        "import sys; sys.stdout.reconfigure(encoding='ascii'); from stair_inspector.cli import main; sys.exit(main())"
    )
    args = [sys.executable, "-c", script, "measure", str(tmp_path / "Stiege_ä.ply"), "-o", str(tmp_path / "out"), *UP_Z]
    run = subprocess.run(args, cwd=ROOT, capture_output=True, text=True, check=False)
    assert (run.returncode, run.stderr) == (0, "")
    assert "Stiege_\\xe4.ply: " in run.stdout


# --- overrules -----------------------------------------------------------------------------------------------------


@pytest.fixture
def measured(run, stair_file, tmp_path):
    def call(*args):
        """The JSON of the stair, measured with these arguments."""
        code, _, err = run("measure", stair_file, "-o", tmp_path / "out", *UP_Z, *args)
        assert (code, err) == (0, "")
        return json.loads((tmp_path / "out" / "stair.json").read_text())

    return call


def test_overrules_are_saved_and_listed(measured):
    force = "level:3=rejected (a table; see photo (7)); at:0.1,0.5,0.17=tread"
    args = ("--overrules.force", force, "--overrules.region", "-9,-9,-9,9,9,9", "--overrules.climb", "x")
    document = measured(*args)
    assert document["settings"]["overrules"] == {"force": force, "climb": "x", "region": "-9,-9,-9,9,9,9"}
    assert document["overrules"] == [
        {"what": "level 3", "kind": "rejected", "reason": "a table; see photo (7)"},
        {"what": "at 0.1,0.5,0.17", "kind": "tread", "reason": None},
        {"what": "climb", "vector": [1.0, 0.0, 0.0]},
        {"what": "region", "low_m": [-9.0, -9.0, -9.0], "high_m": [9.0, 9.0, 9.0]},
    ]
    assert document["levels"][3]["reason"] == "rejected by the inspector: a table; see photo (7)"


def test_nothing_is_listed_when_nothing_was_decided(measured):
    document = measured()
    assert document["overrules"] == []
    assert document["settings"]["overrules"] == {"force": "", "climb": "auto", "region": ""}


@pytest.mark.parametrize(
    ("args", "text"),
    [
        (["--overrules.climb", "-x"], "-x"),
        (["--overrules.climb=-x"], "-x"),
        (["--overrules.climb", "-1,0.2,0"], "-1,0.2,0"),
        (["--overrules.region", "-9,-9,-9,9,9,9"], "-9,-9,-9,9,9,9"),
        (["--overrules.region=-9,-9,-9,9,9,9"], "-9,-9,-9,9,9,9"),
        (["--overrules.region", "-9, -9, -9, 9, 9, 9"], "-9, -9, -9, 9, 9, 9"),
        (["--overrules.region", "-.9e1,-9,-9,9,9,9"], "-.9e1,-9,-9,9,9,9"),
    ],
    ids=" ".join,
)
def test_an_overrule_that_begins_with_a_dash_is_no_flag(measured, args, text):
    name = args[0].removeprefix("--overrules.").partition("=")[0]
    assert measured(*args)["settings"]["overrules"][name] == text


def test_overrules_of_a_preset_file_and_flags_over_them(measured, tmp_path):
    preset = tmp_path / "mine.toml"
    preset.write_text('[overrules]\nforce = "level:3=rejected"\nclimb = "x"\nregion = "-9,-9,-9,9,9,9"\n')
    document = measured("--preset", preset)
    assert document["settings"]["overrules"] == {"force": "level:3=rejected", "climb": "x", "region": "-9,-9,-9,9,9,9"}
    assert [entry["what"] for entry in document["overrules"]] == ["level 3", "climb", "region"]
    document = measured("--preset", preset, "--overrules.force", "level:2=landing", "--overrules.region", "")
    assert document["settings"]["overrules"] == {"force": "level:2=landing", "climb": "x", "region": ""}
    assert [entry["what"] for entry in document["overrules"]] == ["level 2", "climb"]


# --- projects ------------------------------------------------------------------------------------------------------

DECIDED = (
    Params(up="z", unit="m").replaced("levels.eps_m", 0.0123456789).replaced("overrules.force", "level:5=rejected (x)")
)


@pytest.fixture
def project_file(tmp_path, stair_file):
    """A project beside a copy of the stair, with a space and a letter beyond ASCII in its name."""
    scan = tmp_path / "work" / "Stair ß.ply"
    scan.parent.mkdir()
    scan.write_bytes(stair_file.read_bytes())
    project = Project(
        scan.name,
        hashlib.sha256(scan.read_bytes()).hexdigest(),
        DECIDED,
        "Hall",
        (Measurement("m", ((0.0, 0.0, 0.0),)),),
        runs=(KeptRun("other", Params()),),
    )
    path = scan.with_suffix(".stair.json")
    save_project(path, project)
    return path


def without_times(path):
    document = json.loads(path.read_bytes())
    assert document.pop("timings_s")
    return document


@pytest.mark.parametrize("is_named", [True, False], ids=["scan_named", "scan_beside"])
def test_a_project_gives_the_very_numbers_of_its_settings(run, tmp_path, project_file, is_named):
    scan = project_file.with_name("Stair ß.ply")
    named = [scan] if is_named else []
    code, _, err = run("measure", *named, "--project", project_file, "-o", tmp_path / "out")
    assert (code, err) == (0, "")
    inspection = inspect(read_scan(scan, "m"), DECIDED)
    expected = inspection_files(read_scan(scan, "m"), inspection)
    assert len(inspection.steps) == 4, "the fifth level was rejected"
    for suffix in (".csv", "_debug.ply"):
        assert (tmp_path / "out" / f"Stair ß{suffix}").read_bytes() == expected[suffix]
    document = without_times(tmp_path / "out" / "Stair ß.json")
    wanted = json.loads(expected[".json"])
    assert wanted.pop("timings_s")
    assert document == wanted
    assert document["settings"]["levels"]["eps_m"] == 0.0123456789


def test_a_projects_values_are_checked(run, tmp_path, project_file):
    code, out, err = run("check", "--project", project_file, "--rules", "us-osha-1910-25", "-o", tmp_path)
    assert (code, err) == (0, "")
    document = json.loads((tmp_path / "Stair ß.json").read_text(encoding="utf-8"))
    assert document["settings"] == params_to_dict(DECIDED)
    assert document["check"]["rule_set"]["id"] == "us-osha-1910-25"
    assert "Stair ß.ply checked against us-osha-1910-25" in out
    (tmp_path / "work" / "Stair ß.ply").unlink()
    code, _, err = run("check", "--project", project_file, "--rules", "us-osha-1910-25")
    assert code == 3
    assert "name it: check SCAN --project" in err


def test_another_scan_than_the_projects_is_refused_and_the_right_one_is_still_measured(run, tmp_path, project_file):
    scan = project_file.with_name("Stair ß.ply")
    other = tmp_path / "other.ply"
    other.write_bytes(ply_bytes(Stair(seed=7).sample()[0]))
    code, out, err = run("measure", other, scan, "--project", project_file, "-o", tmp_path / "out")
    shas = [hashlib.sha256(path.read_bytes()).hexdigest()[:12] for path in (scan, other)]
    assert code == 3
    assert err == (
        f"stair-inspector: {other}: is not the scan of the project {project_file}, which was made on Stair ß.ply with "
        f"SHA-256 {shas[0]}..., while this file has {shas[1]}...; give that scan, or another project\n"
    )
    assert "4 steps" in out
    assert not (tmp_path / "out" / "other.json").exists()


def test_flags_change_a_projects_values(run, tmp_path, project_file):
    code, _, err = run(
        "measure", "--project", project_file, "-o", tmp_path, "--overrules.force", "", "--method", "paper"
    )
    assert (code, err) == (0, "")
    settings = json.loads((tmp_path / "Stair ß.json").read_text(encoding="utf-8"))["settings"]
    assert (settings["method"], settings["overrules"]["force"]) == ("paper", "")
    assert settings["levels"]["eps_m"] == 0.0123456789


def test_a_project_and_a_preset_are_one_too_many(run, tmp_path, project_file):
    text = refusal(run, "measure", "--project", project_file, "--preset", "tls", "-o", tmp_path)
    assert text == "measure: got --project and --preset, which both state every setting; give one of them"


def test_a_project_whose_scan_is_not_beside_it_asks_for_the_scan(run, tmp_path, project_file):
    scan = project_file.with_name("Stair ß.ply")
    scan.unlink()
    code, _, err = run("measure", "--project", project_file, "-o", tmp_path)
    assert code == 3
    assert err == (
        f"stair-inspector: {scan}: this scan of the project is not beside it; name it: measure SCAN --project "
        f"{project_file}\n"
    )


@pytest.mark.parametrize("name", ["x" * 3000, "-o.ply", "--help"])
def test_a_project_of_a_scan_with_an_odd_name_asks_for_the_scan(run, tmp_path, name):
    path = tmp_path / "odd.stair.json"
    save_project(path, Project(name, "0" * 64))
    code, _, err = run("measure", "--project", path, "-o", tmp_path)
    assert code == 3
    assert "this scan of the project is not beside it; name it: measure SCAN --project" in err
    assert err.count("\n") == 1


def test_a_file_that_is_no_project_is_one_sentence(run, tmp_path, stair_file):
    text = refusal(run, "measure", stair_file, "--project", stair_file, "-o", tmp_path)
    assert text.startswith(f"{stair_file}: is no project file: ")
    text = refusal(run, "measure", stair_file, "--project", tmp_path / "no.stair.json", "-o", tmp_path)
    assert text == f"{tmp_path / 'no.stair.json'}: cannot be read (No such file or directory); check the name"


def test_wrong_overrules_of_a_preset_file_name_the_file(run, stair_file, tmp_path):
    preset = tmp_path / "mine.toml"
    preset.write_text('[overrules]\nforce = "level:3"\n')
    assert refusal(run, "measure", stair_file, "-o", tmp_path / "out", "--preset", preset) == (
        f"{preset}: overrules.force: got 'level:3'; give entries such as level:3=rejected, patch:12=tread or "
        "at:0.5,1.2,0.34=landing, separated by semicolons"
    )
    assert not (tmp_path / "out").exists()


def test_the_papers_method_knows_no_kinds_and_no_given_climb(measured, tmp_path):
    overrules = ("--overrules.force", "level:3=rejected", "--overrules.climb", "y")
    files = [tmp_path / "out" / "stair.csv", tmp_path / "out" / "stair_debug.ply"]
    assert measured("--method", "paper", *overrules)["overrules"] == []
    overruled = [file.read_bytes() for file in files]
    assert len(measured("--method", "paper")["steps"]) == 5
    assert [file.read_bytes() for file in files] == overruled


def test_a_region_chooses_the_points_of_the_papers_method_too(measured):
    document = measured("--method", "paper", "--overrules.region", "-9,-9,-9,9,9,0.6")
    assert len(document["steps"]) == 3
    assert document["overrules"] == [{"what": "region", "low_m": [-9.0, -9.0, -9.0], "high_m": [9.0, 9.0, 0.6]}]


@pytest.mark.parametrize("kind", ["rejected", "landing"])
def test_a_level_that_the_inspector_decides_is_what_was_decided(measured, kind):
    before = [patch["kind"] for patch in measured()["patches"] if patch["level"] == 3]
    assert before == ["tread"]
    document = measured("--overrules.force", f"level:3={kind}")
    (patch,) = [patch for patch in document["patches"] if patch["level"] == 3]
    assert patch["kind"] == kind
    # No surface becomes two steps: the top of one flight is not the first step of the next one again.
    assert sorted(patch["step"] for patch in document["patches"] if patch["step"] is not None) == [
        step["id"] for step in document["steps"]
    ]
    assert (patch["step"] is None) == (kind == "rejected")
    if kind == "rejected":
        assert patch["reason"]
    else:
        assert [step["kind"] for step in document["steps"] if step["id"] == patch["step"]] == ["landing"]


def test_a_surface_is_decided_by_its_number_or_by_a_point_on_it_alike(measured):
    (patch,) = [patch for patch in measured()["patches"] if patch["level"] == 5]
    place = ",".join(f"{value:.3f}" for value in patch["centroid_m"])
    kinds = []
    for where in (f"patch:{patch['id']}", f"at:{place}"):
        document = measured("--overrules.force", f"{where}=rejected")
        kinds.append([(found["level"], found["kind"]) for found in document["patches"]])
        assert len(document["steps"]) == 4
    assert kinds[0] == kinds[1]
    assert dict(kinds[0])[5] == "rejected"


def test_only_what_lies_in_the_region_is_measured(measured):
    # Treads lie every 0.17 m: three of them below 0.6 m.
    document = measured("--overrules.region", "-9,-9,-9,9,9,0.6")
    heights = [step["centroid_m"][2] for step in document["steps"]]
    np.testing.assert_allclose(heights, [0.17, 0.34, 0.51], atol=0.002)


@pytest.mark.parametrize(("climb", "n_flights"), [("x", 1), ("1,0.1,0", 1), ("-x", 0), ("y", 0)])
def test_only_flights_that_climb_the_given_way_are_measured(measured, climb, n_flights):
    flights = measured("--overrules.climb", climb)["flights"]
    assert len(flights) == n_flights
    for flight in flights:
        # The nosings say which way exactly.
        np.testing.assert_allclose(flight["climb"], [1.0, 0.0, 0.0], atol=0.01)


# --- errors --------------------------------------------------------------------------------------------------------


def test_unknown_command(run):
    commands = "view, measure, check, compare, verify, rules, simulate, presets, quantities, completion"
    expected = f"'mesure' is no command; give one of {commands} (see --help)"
    assert refusal(run, "mesure", "a.ply") == expected


def test_missing_scan(run, tmp_path):
    assert refusal(run, "measure", "-o", tmp_path) == "measure: no scan given; name at least one file or folder"


def test_missing_out(run, stair_file):
    assert refusal(run, "measure", stair_file) == "measure: -o DIR is missing; see --help"


@pytest.mark.parametrize(
    ("args", "text"),
    [
        (["--levels.eps", "0.03"], "measure: unknown option --levels.eps; did you mean --levels.eps-m?"),
        (
            ["--horizontal.tehta-deg", "9"],
            "measure: unknown option --horizontal.tehta-deg; did you mean --horizontal.theta-deg?",
        ),
        (["--qqq"], "measure: unknown option --qqq; see --help"),
        (["--levels.eps-m"], "measure: --levels.eps-m needs a value; see --help"),
        (["-o"], "measure: -o/--out needs a value; see --help"),
        (["--levels.eps-m", "0.3"], "measure: levels.eps_m: got 0.3; give a value from 0.001 to 0.1; see --help"),
        (["--levels.eps-m", "-1"], "measure: levels.eps_m: got -1.0; give a value from 0.001 to 0.1; see --help"),
        (["--levels.eps-m", "nan"], "measure: levels.eps_m: got nan; give a number; see --help"),
        (["--levels.eps-m", "inf"], "measure: levels.eps_m: got inf; give a number; see --help"),
        (["--levels.eps-m", "2cm"], "measure: --levels.eps-m: got '2cm'; give a number; see --help"),
        (["--levels.min-points", "3.5"], "measure: --levels.min-points: got '3.5'; give a whole number; see --help"),
        (["--normals.k", "4"], "measure: normals.k: got 4; give a value from 5 to 300; see --help"),
        (["--method", "magic"], "measure: --method: got 'magic'; give one of survey, paper; see --help"),
        (["--unit", "km"], "measure: --unit: got 'km'; give one of auto, m, cm, mm, in, ft; see --help"),
        (["--up", "up"], "up: got 'up'; give auto, x, y, z, -x, -y, -z, or three numbers such as \"0.1,0,1\""),
        (["--up", "0,0,0"], "up: got '0,0,0'; give auto, x, y, z, -x, -y, -z, or three numbers such as \"0.1,0,1\""),
        (["--up", "-q"], "measure: --up needs a value; see --help"),
        (
            ["--overrules.force", "level:3"],
            "measure: overrules.force: got 'level:3'; give entries such as level:3=rejected, patch:12=tread or "
            "at:0.5,1.2,0.34=landing, separated by semicolons; see --help",
        ),
        (
            ["--overrules.force", "at:0.5,1.2,0.34=floor"],
            "measure: overrules.force: got 'at:0.5,1.2,0.34=floor'; give entries such as level:3=rejected, "
            "patch:12=tread or at:0.5,1.2,0.34=landing, separated by semicolons; see --help",
        ),
        (
            ["--overrules.climb", "up"],
            "measure: overrules.climb: got 'up'; give auto, x, y, z, -x, -y, -z, or three numbers such as "
            '"0.1,0,1"; see --help',
        ),
        (
            ["--overrules.region", "-1000000.25,-1000000.25,-1000000.25,1000000.25,1000000.25,-1000000.25"],
            "measure: overrules.region: got '-1000000.25,-1000000.25,-1000000.25,1000000.25,1000000.25,-1000000.25'; "
            "give xmin,ymin,zmin,xmax,ymax,zmax in metres, each minimum below its maximum, or nothing; see --help",
        ),
        (["--overrules.climb", "-q"], "measure: --overrules.climb needs a value; see --help"),
        (
            ["--overrules.climp", "x"],
            "measure: unknown option --overrules.climp; did you mean --overrules.climb?",
        ),
        (["--preset", "defalt"], "--preset: unknown preset 'defalt'; did you mean 'default'?"),
        (["--preset"], "measure: --preset needs a value; see --help"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
@pytest.mark.parametrize("columns", ["80", "200"])
def test_the_line_for_a_wrong_setting(run, stair_file, tmp_path, monkeypatch, args, text, columns):
    monkeypatch.setenv("COLUMNS", columns)
    assert refusal(run, "measure", stair_file, "-o", tmp_path / "out", *args) == text
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("encoding", ["utf-8", "ascii"])
def test_the_line_does_not_depend_on_the_terminal(tmp_path, encoding):
    script = (
        f"import sys; sys.stdout.reconfigure(encoding='{encoding}');"
        "from stair_inspector.cli import main; sys.exit(main(['measure', '--unit', 'km', 'a.ply', '-o', 'x']))"
    )
    run = subprocess.run([sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=False)
    assert (run.returncode, run.stdout) == (2, "")
    assert run.stderr == (
        "stair-inspector: measure: --unit: got 'km'; give one of auto, m, cm, mm, in, ft; see --help\n"
    )


def test_unknown_preset_lists_the_known(run, stair_file, tmp_path):
    known = ", ".join(sorted(preset.name for preset in list_presets()))
    text = refusal(run, "measure", stair_file, "-o", tmp_path, "--preset", "zzz")
    assert text == f"--preset: unknown preset 'zzz'; known are {known}"


def test_presets_takes_no_options(run):
    assert refusal(run, "presets", "all") == "presets: got 'all'; this command has no options"


def test_an_output_folder_that_is_a_file(run, stair_file, tmp_path):
    out = tmp_path / "out"
    out.write_text("mine")
    assert (
        refusal(run, "measure", stair_file, "-o", out) == f"{out}: is a file, not a folder; give another folder with -o"
    )
    text = refusal(run, "measure", stair_file, "-o", out / "below")
    assert text == f"{out}: is a file, not a folder; give another folder with -o"
    assert out.read_text() == "mine"


def test_an_output_folder_that_may_not_be_written(run, stair_file, tmp_path, monkeypatch):
    monkeypatch.setattr("os.access", lambda *_: False)
    text = refusal(run, "measure", stair_file, "-o", tmp_path / "out")
    assert text == f"{tmp_path}: cannot be written (permission denied); give another folder with -o"


def test_an_output_folder_with_a_name_that_is_too_long(run, stair_file, tmp_path):
    folder = tmp_path / ("x" * 300)
    text = refusal(run, "measure", stair_file, "-o", folder)
    assert text == f"{folder}: cannot be written (File name too long); give another folder with -o"


def test_an_output_that_fails_while_writing_is_exit_2(run, stair_file, tmp_path):
    (tmp_path / "stair.csv").mkdir()
    code, _, err = run("measure", stair_file, "-o", tmp_path, *UP_Z)
    assert code == 2
    assert err == (
        f"stair-inspector: {tmp_path / 'stair.csv'}: cannot be written (it is a folder); choose another folder\n"
    )


def test_two_scans_with_the_same_stem(run, stair_file, tmp_path):
    other = tmp_path / "stair.xyz"
    other.write_text("0 0 0\n")
    text = refusal(run, "measure", stair_file, other, "-o", tmp_path / "out")
    assert text == f"{other} and {stair_file} would both be written as stair.json; measure them apart"
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("command", [["measure", "-o", "unused"], ["view", "--no-browser"]], ids=["measure", "view"])
def test_a_missing_file(run, tmp_path, monkeypatch, command):
    monkeypatch.chdir(tmp_path)
    code, out, err = run(*command, "missing.ply")
    assert (code, out) == (3, "")
    assert err == "stair-inspector: missing.ply: there is no such file; check the path\n"
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("[fields]\nfirma = 'A'", "[fields]: unknown key 'firma'; did you mean 'firm'?"),
        ("[[readings]]\nquantity = 'rise'\nstep = 1\nvalue = 170\nunit = 'mm'", "belongs to one stair: readings;"),
        ("[[photos]]\nfile = 'a.png'", "belongs to one stair: photos;"),
        ("[fields]\nstair = 'B'\nfirm = 'F'\ntitle = 'T'", "belongs to one stair: title, stair;"),
        ("[checklist]\nhandrails = 'seen, good'", "belongs to one stair: handrails;"),
    ],
)
def test_what_the_reports_of_a_page_begin_with_is_checked_before_it_opens(run, stair_file, tmp_path, text, sentence):
    path = tmp_path / "firm.toml"
    path.write_text(text, encoding="utf-8")
    Image.new("RGB", (20, 20)).save(tmp_path / "a.png")
    line = refusal(run, "view", stair_file, "--no-browser", "--fields", path)
    assert str(path) in line
    assert sentence in line


def test_a_folder_without_scans(run, tmp_path):
    (tmp_path / "notes.txt").write_text("nothing")
    code, out, err = run("measure", tmp_path, "-o", tmp_path / "out")
    assert (code, out) == (3, "")
    assert err == (
        f"stair-inspector: {tmp_path}: this folder holds no scans ({', '.join(FOLDER_SUFFIXES)}); name a scan\n"
    )


def test_debug_shows_the_traceback_and_still_the_line(run, tmp_path):
    _, _, plain = run("measure", tmp_path / "a.ply", "-o", tmp_path)
    code, _, err = run("measure", tmp_path / "a.ply", "-o", tmp_path, "--debug", "--levels.eps-m", "9")
    assert code == 2
    assert err.startswith("Traceback (most recent call last):")
    assert err.splitlines()[-1].startswith("stair-inspector: measure: levels.eps_m: got 9.0;")
    assert "Traceback" not in plain


def test_debug_shows_the_traceback_of_a_scan_that_cannot_be_read(run, tmp_path):
    (tmp_path / "a.ply").write_bytes(b"")
    code, _, err = run("measure", tmp_path / "a.ply", "-o", tmp_path, "--debug")
    assert code == 3
    assert err.startswith("Traceback (most recent call last):")
    assert err.splitlines()[-1].startswith("stair-inspector: ")


def test_an_error_of_many_lines_becomes_one(run, monkeypatch):
    def fail(_):
        raise MissingLibrary("first\n  second\tthird")

    monkeypatch.setattr("stair_inspector.cli.presets.run", fail)
    assert run("presets") == (3, "", "stair-inspector: first second third\n")


def test_a_wrong_setting_found_by_a_stage_is_exit_2(run, stair_file, tmp_path):
    code, _, err = run("measure", stair_file, "-o", tmp_path / "out", "--normals.source", "given", *UP_Z)
    assert code == 2
    assert err == "stair-inspector: normals.source: stair.ply holds no normals; use 'estimate'\n"
    assert not (tmp_path / "out").exists()


def test_an_interrupt_leaves_with_130(monkeypatch):
    def interrupt(_):
        raise KeyboardInterrupt

    monkeypatch.setattr("stair_inspector.cli.presets.run", interrupt)
    assert cli.main(["presets"]) == 130


def test_a_defect_of_the_program_is_one_line_that_says_so(monkeypatch, capsys):
    def defect(_):
        raise ZeroDivisionError("none")

    monkeypatch.setattr("stair_inspector.cli.presets.run", defect)
    assert cli.main(["presets"]) == 3
    assert capsys.readouterr().err == (
        "stair-inspector: internal error (ZeroDivisionError: none); run again with --debug and report what it prints\n"
    )
    assert cli.main(["presets", "--debug"]) == 3
    assert "Traceback" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["scan.csv", "scan_debug.ply"])
def test_a_result_never_takes_the_place_of_a_scan(run, stair_file, tmp_path, name):
    folder = tmp_path / "site"
    folder.mkdir()
    scan = folder / "scan.ply"
    scan.write_bytes(stair_file.read_bytes())
    victim = folder / name
    victim.write_bytes(b"0 0 0\n1 1 1\n")
    code, _, err = run("measure", scan, victim, "-o", folder, *UP_Z)
    assert code == 2
    assert "scan" in err
    assert victim.read_bytes() == b"0 0 0\n1 1 1\n"
    assert sorted(path.name for path in folder.iterdir()) == sorted(["scan.ply", name])


def test_the_text_scan_that_would_become_its_own_table_is_refused(run, tmp_path):
    scan = tmp_path / "scan.csv"
    scan.write_text("x,y,z\n" + "".join(f"{k % 10},{k // 10},0\n" for k in range(100)))
    code, _, err = run("measure", scan, "-o", tmp_path)
    assert code == 2
    assert err == f"stair-inspector: {scan}: this result would overwrite a scan; give another folder with -o\n"


@pytest.mark.slow
def test_a_reader_that_has_seen_enough_does_not_stop_the_work(stair_file, tmp_path):
    copies = [tmp_path / f"s{k}.ply" for k in range(3)]
    for copy in copies:
        copy.write_bytes(stair_file.read_bytes())
    program = "import sys; from stair_inspector.cli import main; sys.exit(main())"
    command = [sys.executable, "-c", program, "measure", *map(str, copies), "-o", str(tmp_path / "out"), "--up", "z"]
    done = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    done.stdout.close()
    with done.stderr:
        assert done.stderr.read() == b""
    assert done.wait(timeout=120) == 0
    assert len(list((tmp_path / "out").glob("*.manifest.json"))) == 3


def test_config_errors_are_value_errors_so_that_tyro_reports_them():
    assert issubclass(ConfigError, ValueError)


def test_stability_measures_again_to_each_side_of_the_settings(run, stair_file, tmp_path, monkeypatch):
    seen = []
    monkeypatch.setattr(stability, "inspect", lambda *asked: seen.append(asked) or inspect(*asked))
    assert run("measure", stair_file, "-o", tmp_path, *UP_Z)[0] == 0
    assert not seen
    assert run("measure", stair_file, "-o", tmp_path, *UP_Z, "--stability")[0] == 0
    assert len(seen) == 6
