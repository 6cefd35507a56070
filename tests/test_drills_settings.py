"""A setting is one declaration: one that is added to a copy of the package in one place stands everywhere at once."""

import json
import subprocess
import sys
import textwrap

import pytest

from tests.package_copy import copy_package, environment_of

BEFORE = "    min_points: Annotated[\n"
DECLARED = """\
    wobble_m: Annotated[
        float,
        Knob("largest wobble", 0.002, 0.25, 0.002, MM, swept=9).says(
            "How far a level may wobble, {range}; 10 mm is usual."
        ),
    ] = 0.01
"""
WHAT_IS_SEEN = """\
    import contextlib, io, json
    from types import SimpleNamespace
    from stair_inspector.cli import main
    from stair_inspector.errors import ConfigError
    from stair_inspector.files.settings import params_to_dict, parse_preset, preset_bytes, settings_schema
    from stair_inspector.params import SETTINGS, Params
    from stair_inspector.viewer.bridge.controls import SettingControls, words_of_change
    from stair_inspector.viewer.compute.sensitivity import swept_values
    from stair_inspector.viewer.parts.tune.sweeping import sweep_titles

    controls = {}

    def control(label, value, **said):
        controls[label] = SimpleNamespace(value=value, said=said, on_update=lambda _: None)
        return controls[label]

    page = SettingControls(SimpleNamespace(add_html=lambda _: None, add_number=control), Params(), list)
    page.add_by_stage("more")
    shown = controls["largest wobble [mm]"]
    value = shown.value
    shown.value = 30.0
    read = page.read()
    page.load(Params())
    loaded = shown.value
    with contextlib.redirect_stdout(io.StringIO()) as out, contextlib.suppress(SystemExit):
        main(["measure", "--help"])
    try:
        parse_preset(b"[levels]\\nwobble_m = 0.5", "mine.toml")
    except ConfigError as error:
        refused = str(error)
    print(json.dumps({
        "help": " ".join(out.getvalue().replace("│", " ").replace("|", " ").split()),
        "control": {"value": value, **shown.said},
        "read": read.levels.wobble_m,
        "loaded": loaded,
        "change": words_of_change(Params(), read)[0],
        "toml": preset_bytes(read, "mine").decode(),
        "read_back": parse_preset(preset_bytes(read, "mine"), "mine.toml").params == read,
        "refused": refused,
        "json": params_to_dict(read)["levels"],
        "schema": settings_schema()["properties"]["levels"],
        "sweep": sweep_titles(),
        "swept": swept_values(SETTINGS.knob("levels.wobble_m"), 0.01),
    }))
"""


@pytest.fixture(scope="module")
def seen(tmp_path_factory):
    """What a copy of the package shows of one setting more, which was added in one place."""
    copy = tmp_path_factory.mktemp("copy")
    declared = copy_package(copy) / "params.py"
    source = declared.read_text(encoding="utf-8")
    assert source.count(BEFORE) == 1
    declared.write_text(source.replace(BEFORE, DECLARED + BEFORE), encoding="utf-8")
    made = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(WHAT_IS_SEEN)],
        env={**environment_of(copy), "COLUMNS": "80", "PYTHONIOENCODING": "utf-8"},
        cwd=copy,
        capture_output=True,
        encoding="utf-8",
        check=False,
    )
    assert made.returncode == 0, made.stderr
    return json.loads(made.stdout)


def test_a_setting_that_is_declared_has_a_flag_with_its_range(seen):
    assert "--levels.wobble-m FLOAT" in seen["help"]
    assert "How far a level may wobble, metres (0.002 to 0.25); 10 mm is usual. (default: 0.01)" in seen["help"]


def test_it_has_a_control_in_the_unit_that_people_see(seen):
    assert seen["control"] == {
        "value": 10.0,
        "min": 2.0,
        "max": 250.0,
        "step": 2.0,
        "hint": "How far a level may wobble, mm (2 to 250); 10 mm is usual. (levels.wobble_m)",
    }
    assert (seen["read"], seen["loaded"]) == (0.03, 10.0)
    assert seen["change"] == "largest wobble 10 mm to 30 mm"


def test_it_is_a_key_of_a_preset_and_its_range_is_checked(seen):
    assert "\nwobble_m = 0.03\n" in seen["toml"]
    assert seen["read_back"]
    assert seen["refused"] == "mine.toml: levels.wobble_m: got 0.5; give a value from 0.002 to 0.25"


def test_it_is_in_the_json_and_its_schema(seen):
    assert seen["json"]["wobble_m"] == 0.03
    assert seen["schema"]["properties"]["wobble_m"] == {
        "type": "number",
        "description": "How far a level may wobble, metres (0.002 to 0.25); 10 mm is usual.",
    }
    assert "wobble_m" in seen["schema"]["required"]


def test_it_can_be_swept(seen):
    assert list(seen["sweep"].items())[-1] == ("levels.wobble_m", "largest wobble")
    assert (seen["swept"][0], seen["swept"][-1]) == (0.002, 0.25)
