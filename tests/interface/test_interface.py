"""The Python interface: its examples, that it gives what the command line gives, and what it refuses."""

import dataclasses
import doctest
import html
import importlib
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas
import pytest

import stair_inspector as si
from stair_inspector.cli import main
from stair_inspector.files.ply import ply_bytes
from stair_inspector.files.settings import preset_bytes
from stair_inspector.interface import functions, plain_table, results
from stair_inspector.model import Observation
from stair_inspector.params import SETTINGS
from stair_inspector.writers.csv import CSV_COLUMNS
from tests.synthetic import Stair

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with a small scan."""
    path = tmp_path_factory.mktemp("interface")
    (path / "stair.ply").write_bytes(ply_bytes(Stair(n_steps=4, noise=0.002).sample()[0]))
    return path


@pytest.fixture(scope="module")
def found(folder):
    return si.measure(folder / "stair.ply", preset="tls")


def examples():
    finder = doctest.DocTestFinder(exclude_empty=True)
    for module in (functions, results, plain_table):
        for example in finder.find(module):
            if example.examples:
                yield pytest.param(example, id=example.name)


@pytest.mark.parametrize("example", list(examples()))
def test_examples_of_the_docstrings_run(example, folder, monkeypatch):
    monkeypatch.chdir(folder)
    done = doctest.DocTestRunner().run(example)
    assert done.attempted > 0
    assert done.failed == 0


def test_every_function_has_an_example():
    documented = {example.values[0].name.rpartition(".")[2] for example in examples()}
    assert {"measure", "inspect", "check", "simulate", "StairInspection", "table"} <= documented


def test_the_import_is_quick_and_every_name_is_there():
    script = (
        "import sys\nimport stair_inspector as si\n"
        "print(sorted({'numpy', 'open3d', 'viser', 'scipy', 'pandas', 'tyro'} & set(sys.modules)))\n"
        "print([name for name in si.__all__ if getattr(si, name) is None], set(si.__all__) <= set(dir(si)))\n"
        "print(sorted({'open3d', 'viser', 'scipy', 'sklearn', 'pandas', 'tyro'} & set(sys.modules)))\n"
    )
    done = subprocess.run([sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.splitlines() == ["[]", "[] True", "[]"]


def test_names_are_those_that_the_type_checker_sees():
    text = (ROOT / "stair_inspector" / "__init__.py").read_text(encoding="utf-8")
    seen = {line.rpartition(" as ")[2] for line in text.splitlines() if line.startswith("    from stair_inspector.")}
    assert seen == set(si.__all__)
    assert si.Params is importlib.import_module("stair_inspector.params").Params
    with pytest.raises(AttributeError, match="no attribute 'mesure'"):
        si.mesure  # noqa: B018


def test_json_and_files_are_those_of_the_command_line(found, folder, tmp_path, capsys):
    path = str(folder / "stair.ply")
    assert main(["measure", path, "-o", str(tmp_path / "by_command"), "--preset", "tls", "--rules", "us-irc-2024"]) == 0
    capsys.readouterr()
    by_command = {each.name: each for each in (tmp_path / "by_command").iterdir()}
    checked = si.check(found, "us-irc-2024")
    expected = json.loads(by_command["stair.json"].read_text(encoding="utf-8"))
    own = json.loads(checked.to_json())
    assert own.pop("timings_s").keys() == expected.pop("timings_s").keys()
    assert own == expected
    assert json.loads(found.to_json())["check"] is None
    written = {path.name: path.read_bytes() for path in found.write(tmp_path / "by_python")}
    assert written.keys() == by_command.keys()
    for name in ("stair.csv", "stair_debug.ply"):
        assert written[name] == by_command[name].read_bytes()


def test_a_table_is_a_data_frame_where_pandas_is_there(found, monkeypatch):
    frame = found.table()
    assert isinstance(frame, pandas.DataFrame)
    assert list(frame.columns[:5]) == ["step", "flight", "kind", "rise_mm", "rise_u_mm"]
    # As in the CSV, to a nanometre.
    assert frame["rise_mm"].tolist() == pytest.approx([1000.0 * step.rise_m.value for step in found.steps], abs=1e-6)
    assert frame["going_mm"].isna().tolist() == [False, False, False, True]
    assert list(found.table(every=True).columns) == CSV_COLUMNS
    monkeypatch.setitem(sys.modules, "pandas", None)
    plain = found.table()
    assert isinstance(plain, si.PlainTable)
    assert list(plain.columns) == list(frame.columns)
    assert plain["rise_mm"] == tuple(frame["rise_mm"])
    assert plain["going_mm"][3] is None
    assert len(plain) == 4
    lines = repr(plain).splitlines()
    assert [len(line) for line in lines] == [len(lines[0])] * 5
    assert lines[0].split() == list(plain.columns)
    assert lines[4].split()[:3] == ["4", "1", "tread"]
    assert "<th>rise_mm</th>" in plain._repr_html_()
    with pytest.raises(KeyError):
        plain["rise"]


def test_the_papers_method_has_its_own_table(folder):
    found = si.inspect(si.read_scan(folder / "stair.ply"), method="paper")
    assert repr(found) == "<StairInspection of stair.ply: 4 steps, by the paper's method>"
    assert found.flights == ()
    assert found.table()["paper_h_mm"].notna().tolist() == [True, True, True, False]
    assert "Quantities of the paper" in found._repr_html_()


def test_a_notebook_shows_steps_and_notes(found):
    shown = found._repr_html_()
    assert repr(found) == "<StairInspection of stair.ply: 4 steps in 1 flight, by survey>"
    assert shown.count("<tr") == 1 + 1 + 1 + 4
    assert shown.startswith('<div class="stair-inspector"><style>')
    assert len(found.notes) > 0
    assert [note.code for note in found.notes if html.escape(note.message) not in shown] == []


def test_a_scan_without_a_staircase_says_so(tmp_path):
    floor = Stair(n_steps=0, noise=0.002).sample()[0]
    (tmp_path / "<b>floor.ply").write_bytes(ply_bytes(floor))
    found = si.measure(tmp_path / "<b>floor.ply", up="z", unit="m")
    assert found.steps == ()
    assert "no staircase found" in repr(found)
    assert len(found.table()) == 0
    assert "&lt;b&gt;floor.ply" in found._repr_html_()
    assert "<b>floor" not in found._repr_html_()


def test_a_question_stands_in_place_of_values(found):
    asked = Observation("unit_unclear", "question", "its size fits cm and in", cure="--unit in")
    withheld = dataclasses.replace(found.inspection, examination=(asked,), steps=(), flights=())
    shown = si.StairInspection(found.scan, withheld)
    assert repr(shown) == "<StairInspection of stair.ply: no values before this is answered: its size fits cm and in>"
    assert shown.questions == (asked,)
    assert "answer it with --unit in" in shown._repr_html_()


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"levels_eps": 0.02}, "settings: unknown setting 'levels_eps'; did you mean 'levels_eps_m'?"),
        ({"levels_eps_m": "0.02"}, "eps_m: got '0.02'; give a number"),
        ({"levels_eps_m": 5}, "eps_m: got 5; give a value from 0.001 to 0.1"),
        ({"method": "papers"}, "method: got 'papers'; give one of survey, paper"),
        ({"up": "up"}, "up: "),
        ({"unit": "feet"}, "unit: got 'feet'; give one of auto, m, cm, mm, in, ft"),
        ({"preset": "tsl"}, "--preset: unknown preset 'tsl'; did you mean 'tls'?"),
        ({"params": si.Params(), "preset": "tls"}, "got params and preset, which both state every setting"),
        ({"preset": 5}, "got 5; give the path of a preset, or its name"),
        ({"crop": None}, "crop: got None; give a text"),
        ({"columns": None}, "columns: got None; give a text"),
        ({"levels_eps_m": np.bool_(True)}, "eps_m: got np.True_; give a number"),
        ({"params": {"method": "paper"}}, "params: got {'method': 'paper'}; give Params, or settings as keywords"),
    ],
)
def test_a_wrong_setting_is_refused_with_one_sentence(folder, settings, said):
    with pytest.raises(si.ConfigError) as refused:
        si.measure(folder / "stair.ply", **settings)
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)


def test_what_is_no_scan_and_no_inspection_is_refused(found, folder):
    with pytest.raises(si.ReadError, match="there is no such file"):
        si.measure("nowhere.ply")
    with pytest.raises(si.ConfigError, match=r"inspect: got 'stair\.ply'; give a scan"):
        si.inspect("stair.ply")
    with pytest.raises(si.ConfigError, match="unit: is taken when the file is read"):
        si.inspect(found.scan, unit="mm")
    with pytest.raises(si.ConfigError, match="give an inspection as measure or inspect returns it"):
        si.check(found.scan, "us-irc-2024")
    with pytest.raises(si.ConfigError, match="decision: got 'kind'; give one of guarded, simple"):
        si.check(found, "us-irc-2024", decision="kind")
    with pytest.raises(si.ConfigError, match=r"simulate: unknown setting 'rise'; did you mean 'rise_m'\?"):
        si.simulate(folder / "known.ply", rise=0.17)
    with pytest.raises(si.ConfigError, match="profile: got 'lidar'; give one of"):
        si.simulate(folder / "known.ply", profile="lidar")
    with pytest.raises(si.ConfigError, match=r"give a name that ends in \.ply"):
        si.simulate(folder / "known.las")


@pytest.mark.parametrize("value", [None, 5, b"stair.ply", np.zeros((9, 3))], ids=str)
def test_what_is_no_path_is_refused_with_one_sentence(found, value):
    calls = (
        si.measure,
        si.read_scan,
        si.simulate,
        lambda it: si.check(found, it),
        lambda it: si.check(found, "us-irc-2024", overlays=[it]),
    )
    for call in calls:
        with pytest.raises(si.ConfigError, match=r"^got .*; give the path of (a|the) ") as refused:
            call(value)
        assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("keywords", "said"),
    [
        ({"columns": None}, "columns: got None; give a text"),
        ({"crop": None}, "crop: got None; give a text"),
        ({"detail_m": -1}, "detail_m: got -1; give a distance, or 0 for every point"),
        ({"detail_m": "a"}, "detail_m: got 'a'; give a number"),
        ({"detail_m": True}, "detail_m: got True; give a number"),
    ],
)
def test_a_scan_is_not_read_with_values_of_another_type(folder, keywords, said):
    with pytest.raises(si.ConfigError) as refused:
        si.read_scan(folder / "stair.ply", **keywords)
    assert str(refused.value) == said


def test_numbers_of_numpy_are_numbers_and_a_preset_may_be_a_path(folder):
    path = folder / "mine.toml"
    path.write_bytes(preset_bytes(si.Params(), "mine"))
    keywords = {"levels_eps_m": np.float32(0.01), "levels_min_points": np.int64(12), "crop": "-9,-9,-9,9,9,9"}
    params = si.measure(folder / "stair.ply", preset=path, **keywords).params
    assert repr((params.levels.eps_m, params.levels.min_points)) == "(0.01, 12)"


def test_a_keyword_means_one_setting():
    assert len(functions.KEYWORDS) == len(SETTINGS)
    assert set(functions.KEYWORDS.values()) == set(SETTINGS)


def test_overlays_and_a_rule_set_of_ones_own(found):
    plain = si.check(found, "us-irc-2024")
    more = si.check(found, plain.check.rule_set, overlays=["us-nfpa-101-uniformity"], decision="simple")
    assert len(more.check.rule_set.rules) > len(plain.check.rule_set.rules)
    assert more.check.decision == "simple"
    assert (
        si.check(found, plain.check.rule_set, overlays="us-nfpa-101-uniformity").check.rule_set == more.check.rule_set
    )
    with pytest.raises(si.ConfigError, match="overlays: got None; give rule sets"):
        si.check(found, "us-irc-2024", overlays=None)
    assert repr(plain).startswith("<StairCheck of stair.ply: Nothing that was measured is outside a limit of")
    assert len(plain.table()) == plain._repr_html_().count("<tr") - 1
    assert set(plain.table()["Result"]) <= {"within", "not measured", "reported"}
