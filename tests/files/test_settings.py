"""Settings as TOML and plain values, and the presets."""

import json
import tomllib

import hypothesis.strategies as st
import jsonschema
import pytest
from hypothesis import given

from stair_inspector.declarations import fields_of
from stair_inspector.errors import ConfigError
from stair_inspector.files.settings import (
    Preset,
    find_preset,
    list_presets,
    params_from_dict,
    params_to_dict,
    parse_preset,
    preset_bytes,
    read_preset,
    settings_schema,
)
from stair_inspector.overrules import Force, OverrulesParams, Region, parse_force, parse_region, with_decision
from stair_inspector.params import GROUPS, SETTINGS, Params, UncertaintyParams
from tests.synthetic import CHANGES
from tests.write_schema import HOW, SCHEMA

PLACE = "mine.toml"


def error_of(values):
    with pytest.raises(ConfigError) as error:
        params_from_dict(values, PLACE)
    return str(error.value)


def test_settings_survive_plain_values_and_json():
    changed = Params()
    for name, value in CHANGES.items():
        changed = changed.replaced(name, value)
    for params in (Params(), changed):
        assert params_from_dict(params_to_dict(params), PLACE) == params
        assert params_from_dict(json.loads(json.dumps(params_to_dict(params))), PLACE) == params


def test_every_setting_is_among_the_plain_values():
    values = params_to_dict(Params())
    assert list(values) == list(fields_of(Params))
    assert {name: list(values[name]) for name in GROUPS} == {name: list(fields_of(GROUPS[name])) for name in GROUPS}


def test_the_schema_names_the_settings_as_they_are_declared():
    schema = json.loads(SCHEMA.read_text(encoding="utf-8"))
    assert schema["properties"]["settings"] == settings_schema(), HOW


def test_the_schema_takes_every_setting_and_no_other_type():
    validator = jsonschema.Draft202012Validator(settings_schema())
    changed = Params()
    for name, value in CHANGES.items():
        changed = changed.replaced(name, value)
    for params in (Params(), changed):
        validator.validate(params_to_dict(params))
    for name in SETTINGS:
        group, _, field = name.rpartition(".")
        values = params_to_dict(Params())
        (values[group] if group else values)[field] = None
        assert not validator.is_valid(values), name


def test_what_is_not_named_keeps_its_default():
    params = params_from_dict({"levels": {"eps_m": 0.03}}, PLACE)
    assert params == Params().replaced("levels.eps_m", 0.03)


@pytest.mark.parametrize(
    ("values", "text"),
    [
        ({"level": {}}, "mine.toml: unknown key 'level'; did you mean 'levels'?"),
        (
            {"levels": {"epsm": 0.02}},
            "mine.toml: [levels]: unknown key 'epsm'; did you mean 'eps_m'?",
        ),
        ({"levels": {"zzz": 1}}, "mine.toml: [levels]: unknown key 'zzz'; known are eps_m, min_points"),
        ({"levels": 3}, "mine.toml: levels: got 3; give a table [levels]"),
        ({"levels": {"eps_m": "2 cm"}}, "mine.toml: levels.eps_m: got '2 cm'; give a number"),
        ({"levels": {"min_points": 50.5}}, "mine.toml: levels.min_points: got 50.5; give a whole number"),
        ({"levels": {"eps_m": True}}, "mine.toml: levels.eps_m: got True; give a number"),
        ({"levels": {"eps_m": float("nan")}}, "mine.toml: levels.eps_m: got nan; give a number"),
        ({"normals": {"k": 4}}, "mine.toml: normals.k: got 4; give a value from 5 to 300"),
        ({"method": "Paper"}, "mine.toml: method: got 'Paper'; give one of survey, paper"),
        ({"method": {"a": 1}}, "mine.toml: method: got {'a': 1}; give one of survey, paper"),
        ({"axes": {"rule": ["auto"]}}, "mine.toml: axes.rule: got ['auto']; give one of auto, global, per_step"),
        ({"up": 5}, "mine.toml: up: got 5; give a text"),
        ({"overrules": {"forse": ""}}, "mine.toml: [overrules]: unknown key 'forse'; did you mean 'force'?"),
        (
            {"overrules": {"force": ["level:3=rejected"]}},
            "mine.toml: overrules.force: got ['level:3=rejected']; give a text",
        ),
        (
            {"overrules": {"force": "level:3=rejected; level:4=table"}},
            "mine.toml: overrules.force: got 'level:4=table'; give entries such as level:3=rejected, patch:12=tread or "
            "at:0.5,1.2,0.34=landing, separated by semicolons",
        ),
        (
            {"overrules": {"climb": "up"}},
            "mine.toml: overrules.climb: got 'up'; give auto, x, y, z, -x, -y, -z, or three numbers such as "
            '"0.1,0,1"',
        ),
        (
            {"overrules": {"region": "0,0,0,1,1,-1"}},
            "mine.toml: overrules.region: got '0,0,0,1,1,-1'; give xmin,ymin,zmin,xmax,ymax,zmax in metres, each "
            "minimum below its maximum, or nothing",
        ),
        ({"uncertainty": {"up_deg": 6}}, "mine.toml: uncertainty.up_deg: got 6; give a value from 0 to 5"),
    ],
)
def test_the_sentence_for_a_wrong_table(values, text):
    assert error_of(values) == text


def test_every_shipped_preset_loads_and_says_when_to_take_it():
    presets = list_presets()
    assert presets[0].name == "default"
    assert len({preset.name for preset in presets}) == len(presets)
    for preset in presets:
        assert find_preset(preset.name) == preset
        assert preset.title != preset.name, "a preset has a title of its own"
        assert preset.description.endswith(".")


def test_the_default_preset_is_the_defaults():
    assert find_preset("default").params == Params()


@pytest.mark.parametrize(
    ("name", "registration_m", "edge_m", "side_m", "slope_deg", "up_deg", "scale_percent"),
    [
        ("tls", 0.0001, 0.0, 0.0, 0.0, 0.008, 0.0),
        ("handheld", 0.00075, 0.00037, 0.0012, 0.1, 0.1, 0.0),
        ("robot_lidar", 0.0015, 0.0014, 0.0025, 0.4, 0.13, 0.0),
        ("depth_camera", 0.003, 0.002, 0.012, 0.25, 0.17, 0.0),
        ("phone", 0.004, 0.005, 0.016, 0.45, 0.06, 0.5),
    ],
)
def test_a_scanners_preset_states_what_its_class_leaves_uncertain(
    name, registration_m, edge_m, side_m, slope_deg, up_deg, scale_percent
):
    stated = UncertaintyParams(registration_m, edge_m, side_m, slope_deg, up_deg, scale_percent)
    assert find_preset(name).params.uncertainty == stated


def test_every_scanners_preset_states_an_uncertainty_and_decides_nothing():
    for preset in list_presets():
        assert (preset.params.uncertainty == UncertaintyParams()) == (preset.name == "default")
        assert preset.params.overrules == OverrulesParams()


def test_overrules_in_a_preset_file(tmp_path):
    path = tmp_path / "hall.toml"
    path.write_text(
        '[overrules]\nforce = "level:3=rejected; at:0.5,1.2,0.34=landing"\nclimb = "-x"\nregion = "-1,-2,-3,4,5,6"\n'
    )
    overrules = find_preset(str(path)).params.overrules
    assert parse_force(overrules.force) == (
        Force("level", 3, (0.0, 0.0, 0.0), "rejected"),
        Force("at", -1, (0.5, 1.2, 0.34), "landing"),
    )
    assert overrules.climb == "-x"
    assert parse_region(overrules.region) == Region((-1.0, -2.0, -3.0), (4.0, 5.0, 6.0))


@pytest.mark.parametrize(
    "text",
    ["1,2,3,4,5,6,7,8", "0,0,0,1,1,1,north", "0,0,0,1,1,1,361", "0,0,0,1,1,1,nan", "1e300,0,0,1e308,1,1,30", "0,0,1,9"],
)
def test_a_region_that_cannot_be_is_a_sentence(text):
    with pytest.raises(ConfigError, match=r"overrules.region: got .*; give "):
        parse_region(text)
    assert parse_region("0,0,0,1,1,1,-360") == Region((0.0, 0.0, 0.0), (1.0, 1.0, 1.0), -360.0)


def test_a_preset_file_of_ones_own(tmp_path):
    path = tmp_path / "hall.toml"
    path.write_text('title = "Hall"\nmethod = "paper"\n[levels]\neps_m = 0.03\n')
    preset = find_preset(str(path))
    assert (preset.name, preset.title, preset.description) == ("hall", "Hall", "")
    assert preset.params == Params(method="paper").replaced("levels.eps_m", 0.03)


@pytest.mark.parametrize(
    ("content", "text"),
    [
        (b"[levels]\neps_m = 0.3\n", "levels.eps_m: got 0.3; give a value from 0.001 to 0.1"),
        (
            b"[overrules]\nclimb = 'x,y'\n",
            "overrules.climb: got 'x,y'; give auto, x, y, z, -x, -y, -z, or three numbers such as \"0.1,0,1\"",
        ),
        (b"titel = 'x'\n", "unknown key 'titel'; did you mean 'title'?"),
        (b"title = 3\n", "title: got 3; give a text in quotes"),
        (b"levels = \n", "is not valid TOML (Invalid value (at line 1, column 10)); mend that place"),
        (b"eps = 1\neps = 2\n", "is not valid TOML (Cannot overwrite a value (at line 2, column 8)); mend that place"),
        (b"\xff\xfe", "is not a text file; give a TOML file"),
        (b"# \x00", None),
        (b"#" * 1_000_001, "larger than 1 MB, which no settings file is"),
        (b"[levels]\nmin_points = " + b"9" * 5000, None),
        (b"a = " + b"[" * 5000, None),
    ],
    ids=[
        "range",
        "overrule",
        "misspelt",
        "title",
        "toml",
        "twice",
        "binary",
        "zero_byte",
        "large",
        "huge_number",
        "deep",
    ],
)
def test_a_preset_file_that_is_wrong_is_one_sentence_with_its_name(tmp_path, content, text):
    path = tmp_path / "mine.toml"
    path.write_bytes(content)
    with pytest.raises(ConfigError) as error:
        read_preset(path)
    assert str(error.value).startswith(f"{path}: ")
    assert len(str(error.value)) < 400
    if text is not None:
        assert str(error.value) == f"{path}: {text}"


ALL_CHANGED = Params()
for _name, _value in CHANGES.items():
    ALL_CHANGED = ALL_CHANGED.replaced(_name, _value)


@pytest.mark.parametrize("params", [Params(), ALL_CHANGED], ids=["defaults", "all_changed"])
def test_a_written_preset_reads_back_equal(tmp_path, params):
    data = preset_bytes(params, "Hall", "For the hall.")
    path = tmp_path / "hall.toml"
    path.write_bytes(data)
    assert read_preset(path) == parse_preset(data, "hall.toml") == Preset("hall", "Hall", "For the hall.", params)


def test_a_written_preset_names_every_setting():
    values = tomllib.loads(preset_bytes(Params(), "").decode())
    assert values == params_to_dict(Params())


@given(
    st.floats(0.001, 0.1),
    st.text(st.characters(exclude_categories=["Cs"])),
    st.text(st.characters(exclude_categories=["Cs", "Cc", "Zl", "Zp"]), max_size=100),
)
def test_any_number_title_and_reason_read_back_equal(eps_m, title, reason):
    params = Params().replaced("levels.eps_m", eps_m).replaced("overrules.force", with_decision("", X, "tread", reason))
    preset = parse_preset(preset_bytes(params, title, title), "p.toml")
    assert preset == Preset("p", title or "p", title, params)


def test_a_title_that_is_no_text_is_refused():
    with pytest.raises(ConfigError, match="cannot be written as text; change the title or the reason"):
        preset_bytes(Params(), "a\udcff")


def test_an_uploaded_preset_that_is_wrong_is_one_sentence_with_its_name():
    with pytest.raises(ConfigError) as error:
        parse_preset(b"[levels]\neps_m = 0.3\n", "mine.toml")
    assert str(error.value) == "mine.toml: levels.eps_m: got 0.3; give a value from 0.001 to 0.1"


REASONS = ["", "a table", "see (7)", "a) b; c", "((", "C:\\plans", "x\\)y", "at:1,2,3=tread; level:1=rejected", ":-)"]
X = (1.0, 2.0, 3.0)


@pytest.mark.parametrize("reason", REASONS)
def test_a_reason_is_kept_as_it_was_given(reason):
    force = with_decision("level:3=rejected (q; (7)); patch:1=tread", X, "landing", reason)
    first, second, decided = parse_force(force)
    assert (first.reason, second.reason) == ("q; (7)", "")
    assert decided == Force("at", -1, X, "landing", reason)
    again = with_decision(force, X, "tread", "other")
    assert [(entry.kind, entry.reason) for entry in parse_force(again)][2:] == [("tread", "other")]
    assert with_decision(again, X, None) == "level:3=rejected (q; (7)); patch:1=tread"


@given(st.text(st.characters(exclude_categories=["Cc", "Cs", "Zl", "Zp"]), max_size=100))
def test_any_reason_of_one_line_is_read_back(reason):
    (decided,) = parse_force(with_decision("", X, "tread", reason))
    assert decided.reason == reason.strip()


@pytest.mark.parametrize(
    "written", ["at:1,2,3=tread", " at : 1.0, 2.0004 ,3e0 = landing (a (b))", "at:1.000,2.000,3.000=tread"]
)
def test_a_decision_about_the_same_place_is_replaced_however_it_was_written(written):
    others = "level:3=rejected; at:1.001,2.000,3.000=tread"
    assert with_decision(f"{others};{written}", X, "rejected") == f"{others}; at:1.000,2.000,3.000=rejected"
    assert with_decision(f"{written};{others}", X, None) == others


def test_a_place_on_a_map_grid_is_kept_to_the_millimetre():
    force = with_decision("", (691000.1234, 5333000.9996, -0.0004), "tread", "far")
    assert force == "at:691000.123,5333001.000,0.000=tread (far)"
    assert parse_force(force)[0].point_m == (691000.123, 5333001.0, 0.0)


@pytest.mark.parametrize(
    ("force", "text"),
    [
        (
            "level:3=rejected (a table",
            "overrules.force: the parenthesis in 'level:3=rejected (a table' is not closed; ",
        ),
        ("level:3=rejected (a) b", "overrules.force: got 'level:3=rejected (a) b'; give entries such as"),
        ("level:3=rejected (a\nb)", "overrules.force: the reason 'a\\nb' is too long or has a line break or "),
        ("level:3=rejected (a\u2028b)", "overrules.force: the reason 'a\\u2028b' is too long or has a line break or "),
        ("level:3=rejected (a\x85b)", "overrules.force: the reason 'a\\x85b' is too long or has a line break or "),
        ("level:3=rejected (a\udcff)", "overrules.force: the reason 'a\\udcff' is too long or has a line break or "),
        ("level:3=rejected (" + 301 * "a" + ")", "overrules.force: the reason 'aaaa"),
        ("level:3=rejected) (a)", "overrules.force: got 'level:3=rejected) (a)'; give entries such as"),
    ],
)
def test_a_reason_that_is_wrong_is_one_sentence(force, text):
    with pytest.raises(ConfigError) as error:
        OverrulesParams(force=force)
    assert str(error.value).startswith(text)
    assert len(str(error.value)) < 250


def test_a_missing_preset_file_is_named(tmp_path):
    path = tmp_path / "mine.toml"
    with pytest.raises(ConfigError) as error:
        find_preset(str(path))
    assert str(error.value) == f"{path}: cannot be read (No such file or directory); check the name"


def test_a_folder_as_preset_file_is_named(tmp_path):
    path = tmp_path / "folder.toml"
    path.mkdir()
    with pytest.raises(ConfigError, match=r"folder.toml: cannot be read \(Is a directory\)"):
        find_preset(str(path))


def test_an_unknown_preset_gets_the_nearest_name():
    with pytest.raises(ConfigError) as error:
        find_preset("defalt")
    assert str(error.value) == "--preset: unknown preset 'defalt'; did you mean 'default'?"
