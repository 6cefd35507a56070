"""Settings as TOML and plain values, and the presets."""

import json

import pytest

from stair_inspector.errors import ConfigError
from stair_inspector.files.settings import find_preset, list_presets, params_from_dict, params_to_dict, read_preset
from stair_inspector.params import (
    GROUPS,
    Force,
    OverrulesParams,
    Params,
    UncertaintyParams,
    fields_of,
    parse_force,
    parse_region,
)
from tests.synthetic import CHANGES

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
        ("tls", 7e-05, 0.0, 0.0, 0.0, 0.008, 0.0),
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
    assert parse_region(overrules.region) == ((-1.0, -2.0, -3.0), (4.0, 5.0, 6.0))


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
