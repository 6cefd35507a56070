"""Project files: they read back equal, and what is wrong with one is a sentence."""

import json
import math
import os
import sys
import time

import hypothesis.strategies as st
import jsonschema
import pytest
from hypothesis import given

from stair_inspector.codes import Limit, RuleEdit
from stair_inspector.errors import ConfigError, WriteError
from stair_inspector.files import atomic
from stair_inspector.files.chosen_rules import ChosenRules, RuleFile
from stair_inspector.files.paths import static_configs
from stair_inspector.files.project_files import LARGEST_BYTES, parse_project, project_bytes, read_project, save_project
from stair_inspector.files.projects import KeptRun, Measurement, Project, SavedView, SecondScan, autosave_path
from stair_inspector.params import Params
from tests.synthetic import CHANGES

SHA = "0123456789abcdef" * 4
CHANGED = Params()
for _name, _value in CHANGES.items():
    CHANGED = CHANGED.replaced(_name, _value)
OWN_RULES = (static_configs() / "codes" / "us-irc-2024.toml").read_text("utf-8").replace("us-irc-2024", "my-rules", 1)
FULL = Project(
    scan_file="Halle ß.ply",
    scan_sha256=SHA,
    params=CHANGED,
    title="Hall, north stair",
    measurements=(
        Measurement("landing corner", ((0.1, -2.5, 3.0),)),
        Measurement("headroom", ((0.1, 0.2, 0.3), (0.1, 0.2, 2.5))),
    ),
    views=(SavedView("from the door", (1.0, 2.0, 3.0), (0.0, 0.0, 0.5), (0.0, 0.0, 1.0), 45.0),),
    runs=(KeptRun("A", Params()), KeptRun("B", CHANGED)),
    rules=ChosenRules(
        set_id="us-ibc-2021",
        overlay_ids=("us-nfpa-101-uniformity",),
        decision="simple",
        edits=(RuleEdit("riser", "maximum", Limit.of("7", "in"), Limit.of("180", "mm"), "agreed with the client"),),
        files=(RuleFile("mine.toml", OWN_RULES),),
    ),
    report={
        "fields": {"client": "Halle ß GmbH", "purpose": "two\nlines"},
        "checklist": {"lighting": "two lamps out"},
        "readings": [{"quantity": "rise", "value": 0.171, "step": 2, "line": "centre", "u": 0.0005}],
    },
    second=SecondScan("/scans/Halle ß 2024.ply", SHA[::-1], is_earlier=True),
)
NAMES = st.text(st.characters(exclude_categories=["Cc", "Cs", "Zl", "Zp"]), min_size=1, max_size=50).filter(
    lambda text: text.strip()
)
POINTS = st.tuples(*[st.floats(-1e8, 1e8)] * 3)


def document(**changes):
    values = json.loads(project_bytes(FULL))
    for name, value in changes.items():
        *path, last = (int(key) if key.isdigit() else key for key in name.split("__"))
        place = values
        for key in path:
            place = place[key]
        if value is ...:
            del place[last]
        else:
            place[last] = value
    return json.dumps(values).encode()


def error_of(data):
    with pytest.raises(ConfigError) as error:
        parse_project(data, "hall.stair.json")
    text = str(error.value)
    assert text.startswith("hall.stair.json: ")
    assert len(text) < 400
    assert "\n" not in text
    return text.removeprefix("hall.stair.json: ")


@pytest.mark.parametrize("project", [FULL, Project("a.ply", SHA)], ids=["full", "empty"])
def test_a_project_reads_back_equal(tmp_path, project):
    path = tmp_path / "hall.stair.json"
    save_project(path, project)
    assert read_project(path) == project
    assert [file.name for file in tmp_path.iterdir()] == ["hall.stair.json"]


@given(
    NAMES,
    st.lists(POINTS, min_size=1, max_size=2),
    st.floats(0.001, 0.1),
    st.floats(0.0, 180.0, exclude_min=True, exclude_max=True),
)
def test_any_names_places_and_numbers_read_back_equal(name, points, eps_m, fov_deg):
    project = Project(
        "a.ply",
        SHA,
        Params().replaced("levels.eps_m", eps_m),
        title=name,
        measurements=(Measurement(name, tuple(points)),),
        views=(SavedView(name, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0), fov_deg),),
        runs=(KeptRun(name, Params()),),
    )
    assert parse_project(project_bytes(project), "a") == project


def test_a_file_name_that_is_no_text_reads_back_equal():
    project = Project("a\udcff.ply", SHA)
    assert parse_project(project_bytes(project), "a") == project


@pytest.mark.parametrize("project", [FULL, Project("a.ply", SHA)], ids=["full", "empty"])
def test_the_file_follows_its_schema(project):
    schema = json.loads((static_configs() / "schemas" / "project-1.schema.json").read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(schema)
    validator = jsonschema.Draft202012Validator(schema)
    values = json.loads(project_bytes(project))
    validator.validate(values)
    for key in schema["required"]:
        assert not validator.is_valid({name: value for name, value in values.items() if name != key})
    assert not validator.is_valid(values | {"scan": {"file": "a.ply", "sha256": "7"}})


def test_the_file_says_what_it_is_and_which_program_wrote_it():
    values = json.loads(project_bytes(FULL))
    assert values["schema"] == "stair-inspector/project-1"
    assert values["software"]["name"] == "stair_inspector"
    assert values["scan"] == {"file": "Halle ß.ply", "sha256": SHA}


def test_a_setting_that_an_older_file_does_not_name_has_its_default():
    assert parse_project(document(settings__levels__eps_m=...), "a").params == CHANGED.replaced(
        "levels.eps_m", Params().levels.eps_m
    )


def test_a_file_from_before_there_were_rules_and_reports_can_still_be_read():
    old = parse_project(document(rules=..., report=...), "a")
    assert (old.rules, old.report) == (ChosenRules(), {})
    assert (old.params, old.runs) == (FULL.params, FULL.runs)


def test_whole_numbers_are_numbers():
    assert Measurement("m", ((1, 2, 3),)).points_m == ((1.0, 2.0, 3.0),)
    assert parse_project(document(views__0__fov_deg=45), "a") == FULL


def test_the_autosave_lies_beside_the_scan_or_where_it_is_told(tmp_path):
    scan = tmp_path / "hall.north.ply"
    assert autosave_path(scan) == tmp_path / "hall.north.stair.json"
    assert autosave_path(scan, tmp_path / "projects") == tmp_path / "projects" / "hall.north.stair.json"


def test_saving_that_fails_leaves_the_old_project(tmp_path, monkeypatch):
    path = tmp_path / "hall.stair.json"
    save_project(path, FULL)

    def full_disk(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(atomic.os, "fsync", full_disk)
    with pytest.raises(WriteError, match="No space left on device"):
        save_project(path, Project("a.ply", SHA))
    assert read_project(path) == FULL


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"titel": "x"}, "the project: unknown key 'titel'; did you mean 'title'?"),
        ({"title": ...}, "the project: the key 'title' is missing; give it, or another file"),
        ({"title": 3}, "title: got '3'; give a text"),
        ({"title": "a" * 201}, "title: has 201 characters; give at most 200"),
        ({"title": "a\nb"}, "title: 'a\\nb' holds a control character, such as a line break; give one line"),
        ({"title": "a\u2028b"}, "title: 'a\\u2028b' holds a control character, such as a line break; give one line"),
        ({"runs__0__name": "a\ud800"}, "runs, entry 1: a run's name: 'a\\ud800' holds a control character, such as a "),
        ({"scan__file": "a\nb"}, "scan.file: 'a\\nb' holds a control character, such as a line break; give one line"),
        ({"settings__up": "z" * 100_000}, "settings: up: got 'zzzz"),
        ({"settings__up": ["z"] * 100_000}, "settings: up: got ['z', "),
        ({"settings__levels": "z" * 100_000}, "settings: levels: got 'zzzz"),
        ({"settings__levels__eps_m": "9" * 100_000}, "settings: levels.eps_m: got '9999"),
        ({"settings__levels__min_points": 10**4000}, "settings: levels.min_points: got 1000"),
        ({"settings__method": "z" * 100_000}, "settings: method: got 'zzzz"),
        (
            {"schema": "stair-inspector/project-9"},
            "is no project file: the schema is 'stair-inspector/project-9', not ",
        ),
        ({"schema": ...}, "is no project file: the schema is None, not 'stair-inspector/project-1'; give another file"),
        ({"scan": "hall.ply"}, "scan: got 'hall.ply'; give a table with file, sha256"),
        ({"scan__sha": "x"}, "scan: unknown key 'sha'; did you mean 'sha256'?"),
        ({"scan__sha256": "x" * 64}, "scan.sha256: got 'xxxx"),
        ({"scan__sha256": 7}, "scan.sha256: got '7'; give 64 digits 0-9, a-f"),
        ({"scan__file": "../a.ply"}, "scan.file: got '../a.ply'; give the scan's file name without a folder"),
        ({"scan__file": ".."}, "scan.file: got '..'; give the scan's file name without a folder"),
        ({"scan__file": "  "}, "scan.file: is empty; give a name"),
        ({"settings": []}, "settings: got '[]'; give a table of settings"),
        ({"settings__levels__epsm": 1}, "settings: [levels]: unknown key 'epsm'; did you mean 'eps_m'?"),
        ({"settings__levels__eps_m": 5}, "settings: levels.eps_m: got 5; give a value from 0.001 to 0.1"),
        ({"settings__overrules__force": "x"}, "settings: overrules.force: got 'x'; give entries such as"),
        ({"second_scan": "a.ply"}, "second_scan: got 'a.ply'; give a table with file, sha256, is_earlier"),
        ({"second_scan__file": ""}, "second_scan.file: is empty; give a name"),
        ({"second_scan__sha256": "7"}, "second_scan.sha256: got '7'; give 64 digits 0-9, a-f"),
        ({"second_scan__is_earlier": "yes"}, "second_scan.is_earlier: got 'yes'; give true or false"),
        ({"measurements": {}}, "measurements: got '{}'; give a list"),
        ({"measurements__1": 3}, "measurements, entry 2: got 3; give a table with name, points_m"),
        ({"measurements__0__nam": 3}, "measurements, entry 1: unknown key 'nam'; did you mean 'name'?"),
        ({"measurements__0__points_m": []}, "measurements, entry 1: measurement 'landing corner': points_m: give one "),
        ({"measurements__0__points_m": [[1, 2]]}, "measurements, entry 1: measurement 'landing corner': points_m: got"),
        ({"measurements__0__points_m": [[1, 2, True]]}, "measurements, entry 1: measurement 'landing corner': points"),
        ({"measurements__0__points_m": [[1, 2, 10**400]]}, "measurements, entry 1: measurement 'landing corner': poi"),
        ({"measurements": [{}] * 501}, "measurements: got 501; keep at most 500, delete some"),
        ({"views__0__fov_deg": 180}, "views, entry 1: view 'from the door': fov_deg: got 180; give an angle between"),
        ({"views__0__fov_deg": "wide"}, "views, entry 1: view 'from the door': fov_deg: got 'wide'; give a number"),
        (
            {"views__0__up": [0, 0, 0]},
            "views, entry 1: view 'from the door': up: got [0.0, 0.0, 0.0]; give a direction",
        ),
        ({"views__0__look_at_m": [1, 2, 3]}, "views, entry 1: view 'from the door': look_at_m: is the camera's own"),
        ({"runs__1__settings__up": "upp"}, "runs, entry 2: settings: up: got 'upp'; give auto, x, y, z, -x, -y, -z, "),
        ({"runs__0__name": ""}, "runs, entry 1: a run's name: is empty; give a name"),
        ({"runs__0__name": "none"}, "runs: 'none' is a word of the menu and cannot be a name; choose another"),
        (
            {"measurements__1__name": "landing corner"},
            "measurements: the name 'landing corner' is taken; choose another",
        ),
        ({"rules": []}, "rules: got []; give a table with set, overlays, decision, edits, files"),
        ({"rules__overlay": []}, "rules: unknown key 'overlay'; did you mean 'overlays'?"),
        ({"rules__set": ...}, "rules: the key 'set' is missing; give it, or another file"),
        ({"rules__set": 7}, "rules: set 7: give up to 80 small letters"),
        ({"rules__set": "../x"}, "rules: set '../x': give up to 80 small letters"),
        ({"rules__overlays": "us-nfpa-101-uniformity"}, "rules: overlays: got 'us-nfpa-101-uniformity'; give a list"),
        ({"rules__overlays": ["a"] * 21}, "rules: 21 overlays; keep at most 20"),
        ({"rules__overlays": [[]]}, "rules: overlay []: give up to 80 small letters"),
        ({"rules__decision": "strict"}, "rules: decision: got 'strict'; give one of guarded, simple"),
        ({"rules__edits": [{}] * 501}, "rules: 501 edits; keep at most 500"),
        ({"rules__edits__0__sid": "x"}, "rules: edit 1: unknown key 'sid'; did you mean 'side'?"),
        ({"rules__edits__0__side": "top"}, "rules: edit 1: side: got 'top'; give minimum or maximum"),
        ({"rules__edits__0__reason": ""}, "rules: edit 1: reason: got ''; give one line of text"),
        ({"rules__edits__0__reason": "a\nb"}, "rules: edit 1: reason: got 'a\\nb'; give one line of text"),
        ({"rules__edits__0__after": 7}, "rules: edit 1: after: got 7; give a table with written, unit"),
        ({"rules__edits__0__after__written": 7}, "rules: edit 1: after: got {'written': 7, 'unit': 'mm'}; give two te"),
        ({"rules__edits__0__after__unit": "yd"}, "rules: edit 1: after: unit 'yd' is not known; give one of m, cm, mm"),
        ({"rules__files__0__text": 7}, "rules: file 1: mine.toml: got 7; give the text of a rule file"),
        ({"rules__files__0__text": "x"}, "rules: file 1: mine.toml: is not valid TOML ("),
        ({"rules__files__0__text": OWN_RULES.replace("riser", "x\n", 1)}, "rules: file 1: mine.toml: "),
        ({"rules__files__0__name": "a\nb"}, "rules: file 1: rule file: got the name 'a\\nb'; give one line of letters"),
        ({"rules__files": [{"name": "a.toml", "text": OWN_RULES}] * 2}, "rules: two own files have the id 'my-rules'"),
        ({"report": []}, "report: got '[]'; give a table"),
    ],
)
def test_the_sentence_for_a_wrong_project(changes, text):
    assert error_of(document(**changes)).startswith(text)


@pytest.mark.parametrize(
    ("data", "text"),
    [
        (b"", "is no project file: not valid JSON ("),
        (b"ply\nformat ascii 1.0\n", "is no project file: not valid JSON ("),
        (b"[]", "is no project file: the schema is none, not"),
        (b"\xff\xfe\x00\x00\xff", "is no project file: not valid JSON ("),
        (b"[" * 200_000, "is no project file: not valid JSON ("),
        (b'{"schema": ' + b"9" * 5000 + b"}", "is no project file: not valid JSON ("),
        (b'{"schema": NaN}', "holds NaN, which is no number; mend that place"),
        (b'{"a": 1, "a": 2}', "the key 'a' stands twice in one table; keep one of them"),
        (b" " * (LARGEST_BYTES + 1), "is larger than 20 MB, which no project file is; give another"),
    ],
    ids=["empty", "scan", "list", "binary", "deep", "huge_number", "nan", "twice", "large"],
)
def test_the_sentence_for_a_file_that_is_no_project(tmp_path, data, text):
    assert error_of(data).startswith(text)
    path = tmp_path / "x.stair.json"
    path.write_bytes(data)
    with pytest.raises(ConfigError) as error:
        read_project(path)
    assert str(error.value).startswith(f"{path}: {text}")


def test_a_file_made_to_keep_the_reader_busy_is_refused_at_once():
    keys = ",".join(f'"{k}":1' for k in range(100_000))
    began = time.perf_counter()
    assert error_of(("{" + keys + ',"twice":1,"twice":2}').encode()) == (
        "the key 'twice' stands twice in one table; keep one of them"
    )
    assert "is too long" in error_of(document(settings__overrules__force=f"level:3=rejected ({'x' * 2_000_000})"))
    # Seconds, where a time that grows with the square of the length would be minutes.
    assert time.perf_counter() - began < 20.0


def test_nesting_of_any_depth_is_a_sentence():
    for depth in range(sys.getrecursionlimit() - 200, sys.getrecursionlimit()):
        data = document(settings__up="deep").replace(b'"deep"', b"[" * depth + b"]" * depth)
        sentences = ("settings: up: got [[[", "settings: up: got a list nested too deeply", "is no project file: n")
        assert error_of(data).startswith(sentences)


def test_infinity_written_as_a_number_is_refused():
    data = document(views__0__fov_deg=44.25).replace(b"44.25", b"1e999")
    assert math.isinf(json.loads(data)["views"][0]["fov_deg"])
    assert error_of(data).endswith("fov_deg: got inf; give a number from -1e+08 to 1e+08")


def test_a_missing_file_a_folder_and_an_impossible_name(tmp_path):
    for path, reason in ((tmp_path / "a", "No such file or directory"), (tmp_path, "not a file")):
        with pytest.raises(ConfigError) as error:
            read_project(path)
        assert str(error.value) == f"{path}: cannot be read ({reason}); check the name"
    with pytest.raises(ConfigError, match="not a valid path"):
        read_project(tmp_path / "a\0b")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes on this system")
def test_a_pipe_is_refused_and_not_waited_for(tmp_path):
    path = tmp_path / "pipe"
    os.mkfifo(path)
    with pytest.raises(ConfigError, match="pipe: cannot be read \\(not a file\\); check the name"):
        read_project(path)


def test_a_project_that_grew_too_large_is_refused_before_it_is_written(tmp_path):
    path = tmp_path / "hall.stair.json"
    save_project(path, FULL)
    force = "; ".join(["level:3=rejected (" + "x" * 290 + ")"] * 1000)
    large = Params().replaced("overrules.force", force)
    with pytest.raises(ConfigError, match=r"the project has [\d,]+ bytes, more than the 20,000,000"):
        save_project(path, Project("a.ply", SHA, runs=tuple(KeptRun(str(k), large) for k in range(80))))
    assert read_project(path) == FULL


@pytest.mark.parametrize(
    ("make", "text"),
    [
        (lambda: Project("a.ply", SHA, measurements=(FULL.views[0],)), "measurements: give values of Measurement only"),
        (lambda: Measurement("", ((0.0, 0.0, 0.0),)), "a measurement's name: is empty; give a name"),
        (lambda: Measurement("m", ((math.nan, 0.0, 0.0),)), "measurement 'm': points_m: got nan; give a number from"),
        (lambda: Project("a.ply", SHA, runs=FULL.runs * 251), "runs: got 502; keep at most 500, delete some"),
    ],
)
def test_a_value_checks_itself_when_it_is_made(make, text):
    with pytest.raises(ConfigError) as error:
        make()
    assert str(error.value).startswith(text)
