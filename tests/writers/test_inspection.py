"""JSON, CSV and debug PLY of one inspection say the same, in the promised form."""

import csv
import dataclasses
import functools
import io
import itertools
import json

import jsonschema
import numpy as np
import pytest
import trimesh

from stair_inspector import __version__
from stair_inspector.files.palettes import read_palette
from stair_inspector.files.paths import static_configs
from stair_inspector.model import Flight, Inspection, Measured, Patch, Statistics
from stair_inspector.overrules import OverrulesParams
from stair_inspector.pipeline import inspect
from stair_inspector.writers.csv import CSV_COLUMNS, csv_bytes
from stair_inspector.writers.debug_ply import debug_ply_bytes
from stair_inspector.writers.inspection import inspection_files
from stair_inspector.writers.json import json_bytes
from tests.oracles import open3d_or_skip
from tests.synthetic import Stair, exact_params, make_scan

NOISY = Stair(noise=0.002, seed=31)
FAR = (3_500_000.0, 5_800_000.0, 120.0)
SURVEY = [
    "rise_m",
    "going_m",
    "tread_depth_m",
    "width_m",
    "nosing_overhang_m",
    "pitch_deg",
    "fall_deg",
    "cross_fall_deg",
]
SURVEY_OTHER = ["coverage", "rise_lcr_m", "going_lcr_m", "nosing_m", "line_points_m", "climb"]
OVERRULES = OverrulesParams(
    force="level:3=rejected; patch:12=tread;at: 3500000.125, -1,0.34 = landing",
    climb="0,3,4",
    region="-1,-2,-3,4,5,3500000.5",
)
REASON = "it is as high as a table and nothing leads up to it"


def upright(points):
    return make_scan(points, np.tile([0.0, 0.0, 1.0], (len(points), 1)))


def flat(heights, n=300):
    rng = np.random.default_rng(1)
    return np.concatenate([np.column_stack([rng.uniform(0, 1, (n, 2)), np.full(n, z)]) for z in heights])


def line_above_a_stair():
    points, normals = NOISY.sample()
    line = np.column_stack([np.full(80, 1.5), np.linspace(0, 1, 80), np.full(80, 1.02)])
    return make_scan(np.concatenate([points, line]), np.concatenate([normals, np.tile([0.0, 0.0, 1.0], (80, 1))]))


CASES = {
    "stair": lambda: NOISY.scan(),
    "far": lambda: NOISY.scan(origin_m=FAR),
    "one_step": lambda: Stair(n_steps=1).scan(),
    "no_staircase": lambda: upright(flat([0.0, 0.74, 2.4])),
    "floor_only": lambda: upright(flat([0.0])),
    "no_levels": lambda: make_scan(flat([0.0]), np.tile([1.0, 0.0, 0.0], (300, 1))),
    "step_without_a_plane": line_above_a_stair,
    "named_strangely": lambda: make_scan(*NOISY.sample(), name='a"b\\c \u00e4\u6f22 \udcff.ply'),
}


@functools.cache
def case(name, method="survey"):
    scan = CASES[name]()
    return scan, inspect(scan, exact_params(method=method))


@functools.cache
def surveyed(origin_m=(0.0, 0.0, 0.0)) -> tuple[object, Inspection]:
    """A scan and its inspection with every value of the survey, set by hand from the stair's exact geometry.

    Two flights, the upper one of a single riser; the first going of step 3 was not observed, nor was any of the last
    step's; the last patch is rejected.
    """
    scan = NOISY.scan(origin_m=origin_m)
    paper = inspect(scan, exact_params(method="paper"))
    steps = tuple(surveyed_step(step) for step in paper.steps)
    patches = tuple(
        Patch(k, k, k * NOISY.rise + origin_m[2], 0.28, plane, "tread" if k else "floor", k or None)
        for k, plane in enumerate([paper.floor, *(step.plane for step in paper.steps)])
    )
    rejected = dataclasses.replace(patches[5], patch_id=6, kind="rejected", step_id=None, reason=REASON)
    climb = np.array([1.0, 0.0, 0.0])
    lower = Flight(
        flight_id=1,
        step_ids=(1, 2, 3, 4),
        n_risers=4,
        shape="straight",
        climb=climb,
        pitch_deg=Measured(31.26, 0.3, (("noise", 0.1), ("up", 0.28))),
        width_m=Measured(1.0, 0.004, (("edge", 0.004),)),
        rise=Statistics(4, 0.17, 0.168, 0.1712, 0.0032, 0.0031, (3, 4)),
        going=Statistics(3, 0.28, 0.279, 0.281, 0.002, 0.0015, (1, 2)),
    )
    alone = Statistics(1, 0.17, 0.17, 0.17, 0.0, None, None)
    upper = Flight(flight_id=2, step_ids=(5,), n_risers=1, shape="winder", climb=climb, rise=alone)
    return scan, dataclasses.replace(
        paper,
        params=exact_params(overrules=OVERRULES),
        steps=steps,
        flights=(lower, upper),
        patches=(*patches, rejected),
        patch_ids=paper.labels.astype(np.int64),
    )


def surveyed_step(step):
    k = step.step_id
    at = np.array([(k - 1) * NOISY.going, 0.0, k * NOISY.rise])
    left = np.array([0.0, NOISY.width, 0.0])
    goings = {3: (None, 0.28, 0.281), 5: (None, None, None)}.get(k, (0.279, 0.28, 0.281))
    u = {"noise": 0.0002, "edge": 0.0003, "up": 0.0001, "registration": 0.001}
    measured = Measured(0.17, float(np.hypot.reduce(list(u.values()))), tuple(u.items()))
    return dataclasses.replace(
        step,
        kind="landing" if k == 4 else "tread",
        flight=1 if k < 5 else 2,
        **dict.fromkeys(SURVEY, measured) | ({"going_m": None, "pitch_deg": None} if k == 5 else {}),
        coverage=0.9,
        rise_lcr_m=(0.169, 0.17, 0.171),
        going_lcr_m=goings,
        nosing=at + left * [[1.0], [0.0]],
        line_points=at + left * [[0.85], [0.5], [0.15]],
        climb=np.array([1.0, 0.0, 0.0]),
    )


def document_of(inspection):
    return json.loads(json_bytes(inspection))


@pytest.fixture(scope="module")
def validator():
    schema = json.loads((static_configs() / "schemas" / "inspection-1.schema.json").read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


# --- JSON ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", ["survey", "paper"])
@pytest.mark.parametrize("name", CASES)
def test_json_follows_the_schema(validator, name, method):
    _, inspection = case(name, method)
    validator.validate(json.loads(json_bytes(inspection)))


@pytest.mark.parametrize("origin_m", [(0.0, 0.0, 0.0), FAR])
def test_json_of_a_survey_follows_the_schema(validator, origin_m):
    document = document_of(surveyed(origin_m)[1])
    validator.validate(document)
    assert all(document[name] for name in ("flights", "patches", "steps", "overrules"))


def put(*path, value):
    """A change of a JSON document: the value at a path of keys and positions is another."""

    def change(document):
        for key in path[:-1]:
            document = document[key]
        document[path[-1]] = value

    return change


def drop(*path):
    def change(document):
        for key in path[:-1]:
            document = document[key]
        del document[path[-1]]

    return change


@pytest.mark.parametrize(
    "change",
    [
        drop("steps", 0, "rise_m"),
        put("steps", 0, "id", value=0),
        put("steps", 0, "paper", "w_m", value="1.0"),
        put("scan", "origin_m", value=None),
        drop("steps", 0, "rise_m", "parts"),
        put("steps", 0, "rise_m", "parts", "edge", value=-0.001),
        put("steps", 0, "rise_m", "parts", "edge", value=None),
        put("steps", 0, "rise_lcr_m", value=[0.17, 0.17]),
        put("steps", 0, "rise_lcr_m", 1, value="0.17"),
        put("steps", 0, "nosing_m", value=[[0.0, 0.0, 0.0]]),
        put("steps", 0, "line_points_m", value=[[0.0, 0.0, 0.0]] * 2),
        drop("steps", 0, "climb"),
        drop("flights"),
        drop("flights", 0, "climb"),
        put("flights", 0, "shape", value="round"),
        put("flights", 0, "rise", "n", value=0),
        put("flights", 0, "rise", "at", value=[3]),
        drop("patches"),
        put("patches", 6, "kind", value="table"),
        put("patches", 6, "area_m2", value=-1.0),
        put("patches", 6, "colour", value="red"),
        drop("patches", 6, "centroid_m"),
        drop("overrules"),
        put("overrules", 0, "kind", value="floor"),
        put("overrules", 0, "what", value="the third level"),
        put("overrules", 3, "kind", value="tread"),
        drop("overrules", 4, "low_m"),
        drop("settings", "overrules", "force"),
        put("settings", "survey", "edge_source", value="guess"),
        put("settings", "flights", "min_risers", value=2.5),
    ],
)
def test_the_schema_refuses_what_it_should(validator, change):
    document = document_of(surveyed()[1])
    change(document)
    assert not validator.is_valid(document)


def undescribed(value, schema, root, place=""):
    """Yield the place of every field of a JSON document that the schema does not name."""
    schema = root["$defs"][schema["$ref"].rsplit("/", 1)[1]] if "$ref" in schema else schema
    schema = schema["anyOf"][0] if "anyOf" in schema else schema
    if "oneOf" in schema:
        branches = [list(undescribed(value, branch, root, place)) for branch in schema["oneOf"]]
        yield from min(branches, key=len)
    elif isinstance(value, dict):
        named = schema.get("properties", {})
        for key, inner in value.items():
            if key in named:
                yield from undescribed(inner, named[key], root, f"{place}.{key}")
            elif "additionalProperties" not in schema:
                yield f"{place}.{key}"
    elif isinstance(value, list):
        for item in value:
            yield from undescribed(item, schema["items"], root, f"{place}[]")


@pytest.mark.parametrize("name", ["step_without_a_plane", "surveyed"])
def test_every_field_of_the_json_is_described_by_the_schema(validator, name):
    inspection = surveyed()[1] if name == "surveyed" else case(name, "paper")[1]
    assert list(undescribed(document_of(inspection), validator.schema, validator.schema)) == []
    assert list(undescribed({"steps": [{"new": 1}]}, validator.schema, validator.schema)) == [".steps[].new"]


@pytest.mark.parametrize("name", ["step", "flights", "patches"])
def test_the_schema_asks_for_every_field_it_describes(validator, name):
    schema = validator.schema["$defs"]["step"] if name == "step" else validator.schema["properties"][name]["items"]
    assert sorted(schema["required"]) == sorted(schema["properties"])
    assert sorted(validator.schema["required"]) == sorted(validator.schema["properties"])


def test_json_repeats_the_inspection_to_the_last_bit():
    scan, inspection = case("far")
    document = json.loads(json_bytes(inspection))
    assert document["schema"] == "stair-inspector/inspection-1"
    assert document["software"] == {"name": "stair_inspector", "version": __version__}
    assert document["scan"] == {
        "file": scan.name,
        "sha256": scan.sha256,
        "n_points": len(scan.points),
        "n_used": len(scan.points),
        "unit": "m",
        "origin_m": list(FAR),
    }
    assert [step["id"] for step in document["steps"]] == [1, 2, 3, 4, 5]
    for written, step in zip(document["steps"], inspection.steps, strict=True):
        assert written["paper"] == {name: getattr(step.paper, name) for name in written["paper"]}
        assert written["rms_m"] == step.plane.rms_m
        np.testing.assert_array_equal(written["centroid_m"], step.plane.centroid + FAR)
        np.testing.assert_array_equal(written["normal"], step.plane.normal)
    assert document["floor"]["h_m"] == inspection.floor_h_m
    assert [level["height_m"] for level in document["levels"]] == [level.height_m for level in inspection.levels]


def test_json_positions_are_in_the_scan_frame():
    near, far = (json.loads(json_bytes(case(name)[1])) for name in ("stair", "far"))
    for here, there in zip(near["steps"], far["steps"], strict=True):
        np.testing.assert_allclose(there["centroid_m"], np.array(here["centroid_m"]) + FAR, rtol=0, atol=1e-9)
    assert far["axes"] == near["axes"]


def test_the_survey_fields_of_the_papers_method_are_present_and_null():
    document = document_of(case("stair", "paper")[1])
    assert (document["flights"], document["patches"], document["overrules"]) == ([], [], [])
    for step in document["steps"]:
        assert {name: step[name] for name in [*SURVEY, *SURVEY_OTHER]} == dict.fromkeys([*SURVEY, *SURVEY_OTHER])
        assert step["flight"] is None


def test_the_last_step_has_null_and_never_zero():
    last = json.loads(json_bytes(case("stair", "paper")[1]))["steps"][-1]["paper"]
    assert [name for name, value in last.items() if value is None] == ["h_m", "d_ff_m", "theta_deg"]


def test_json_lists_what_every_uncertainty_is_made_of():
    _, inspection = surveyed()
    steps = document_of(inspection)["steps"]
    for written, step in zip(steps, inspection.steps, strict=True):
        for name in SURVEY:
            measured = getattr(step, name)
            if measured is None:
                assert written[name] is None
                continue
            assert written[name] == {"value": measured.value, "u": measured.u, "parts": dict(measured.parts)}
            together = np.hypot.reduce(list(written[name]["parts"].values()))
            assert together == pytest.approx(written[name]["u"], rel=1e-12)
    assert (steps[4]["going_m"], steps[4]["pitch_deg"]) == (None, None)
    assert list(steps[0]["rise_m"]["parts"]) == ["noise", "edge", "up", "registration"]


def test_json_of_an_uncertainty_without_parts():
    _, inspection = surveyed()
    step = dataclasses.replace(inspection.steps[0], rise_m=Measured(0.17, 0.002))
    written = document_of(dataclasses.replace(inspection, steps=(step,)))["steps"][0]["rise_m"]
    assert written == {"value": 0.17, "u": 0.002, "parts": {}}


def test_json_of_a_steps_three_lines():
    steps = document_of(surveyed()[1])["steps"]
    assert steps[0]["rise_lcr_m"] == [0.169, 0.17, 0.171]
    assert [step["going_lcr_m"] for step in steps] == [
        [0.279, 0.28, 0.281],
        [0.279, 0.28, 0.281],
        [None, 0.28, 0.281],
        [0.279, 0.28, 0.281],
        None,
    ]
    assert [(step["flight"], step["kind"]) for step in steps[2:]] == [(1, "tread"), (1, "landing"), (2, "tread")]


def test_json_of_nosings_and_lines_is_in_the_scan_frame():
    _, inspection = surveyed(FAR)
    for written, step in zip(document_of(inspection)["steps"], inspection.steps, strict=True):
        np.testing.assert_array_equal(written["nosing_m"], step.nosing + FAR)
        np.testing.assert_array_equal(written["line_points_m"], step.line_points + FAR)
        np.testing.assert_array_equal(written["climb"], [1.0, 0.0, 0.0])
        assert written["nosing_m"][0][1] > written["nosing_m"][1][1], "left of the climber is +y"


def test_json_of_the_flights():
    lower, upper = document_of(surveyed()[1])["flights"]
    assert lower == {
        "id": 1,
        "steps": [1, 2, 3, 4],
        "n_risers": 4,
        "pitch_deg": {"value": 31.26, "u": 0.3, "parts": {"noise": 0.1, "up": 0.28}},
        "width_m": {"value": 1.0, "u": 0.004, "parts": {"edge": 0.004}},
        "shape": "straight",
        "radius_m": None,
        "goes_on": None,
        "climb": [1.0, 0.0, 0.0],
        "rise": {
            "n": 4,
            "mean": 0.17,
            "min": 0.168,
            "max": 0.1712,
            "range": 0.0032,
            "max_adjacent": 0.0031,
            "at": [3, 4],
        },
        "going": {
            "n": 3,
            "mean": 0.28,
            "min": 0.279,
            "max": 0.281,
            "range": 0.002,
            "max_adjacent": 0.0015,
            "at": [1, 2],
        },
    }
    assert (upper["steps"], upper["shape"]) == ([5], "winder")
    assert (upper["pitch_deg"], upper["width_m"], upper["going"]) == (None, None, None)
    assert (upper["rise"]["n"], upper["rise"]["max_adjacent"], upper["rise"]["at"]) == (1, None, None)


def test_json_of_the_patches():
    _, inspection = surveyed(FAR)
    patches = document_of(inspection)["patches"]
    assert [patch["kind"] for patch in patches] == ["floor", *["tread"] * 5, "rejected"]
    assert [patch["step"] for patch in patches] == [None, 1, 2, 3, 4, 5, None]
    assert patches[6] == {
        "id": 6,
        "level": 5,
        "kind": "rejected",
        "step": None,
        "reason": REASON,
        "height_m": 5 * 0.17 + FAR[2],
        "n_points": inspection.steps[4].plane.n_points,
        "area_m2": 0.28,
        "centroid_m": (inspection.steps[4].plane.centroid + FAR).tolist(),
    }


def test_json_lists_what_the_inspector_decided_and_keeps_the_text():
    document = document_of(surveyed()[1])
    assert document["overrules"] == [
        {"what": "level 3", "kind": "rejected", "reason": None},
        {"what": "patch 12", "kind": "tread", "reason": None},
        {"what": "at 3500000.125,-1.0,0.34", "kind": "landing", "reason": None},
        {"what": "climb", "vector": [0.0, 0.6, 0.8]},
        {"what": "region", "low_m": [-1.0, -2.0, -3.0], "high_m": [4.0, 5.0, 3500000.5]},
    ]
    assert document["settings"]["overrules"] == dataclasses.asdict(OVERRULES)


def test_json_has_the_bearing_of_a_region_that_is_turned(validator):
    turned = dataclasses.replace(OVERRULES, region="-1,-2,-3,4,5,6,30.5")
    inspection = surveyed()[1]
    params = dataclasses.replace(inspection.params, overrules=turned)
    document = document_of(dataclasses.replace(inspection, params=params))
    assert document["overrules"][-1]["bearing_deg"] == 30.5
    assert validator.is_valid(document)


@pytest.mark.parametrize(
    ("overrules", "listed"),
    [
        (OverrulesParams(), []),
        (OverrulesParams(climb="auto", region=" ", force=" "), []),
        (OverrulesParams(climb="-x"), [{"what": "climb", "vector": [-1.0, 0.0, 0.0]}]),
        (OverrulesParams(force="level:2=landing"), [{"what": "level 2", "kind": "landing", "reason": None}]),
    ],
)
def test_only_what_was_decided_is_listed(validator, overrules, listed):
    document = document_of(dataclasses.replace(surveyed()[1], params=exact_params(overrules=overrules)))
    assert document["overrules"] == listed
    validator.validate(document)


def test_the_papers_method_lists_the_region_alone_because_it_heeds_nothing_else():
    document = document_of(dataclasses.replace(surveyed()[1], params=exact_params(method="paper", overrules=OVERRULES)))
    assert [entry["what"] for entry in document["overrules"]] == ["region"]
    assert document["settings"]["overrules"]["climb"] == "0,3,4"


def test_json_of_a_scan_without_anything():
    document = json.loads(json_bytes(case("no_levels")[1]))
    assert (document["axes"], document["floor"], document["levels"], document["steps"]) == (None, None, [], [])
    assert [note["code"] for note in document["notes"]] == ["no_staircase"]


def test_same_input_same_bytes_but_for_the_timings():
    documents = [json.loads(json_bytes(case("stair")[1])) for _ in range(2)]
    for document in documents:
        assert document.pop("timings_s")
    first, second = (json.dumps(document).encode() for document in documents)
    assert first == second
    assert csv_bytes(case("stair")[1]) == csv_bytes(case("stair")[1])
    assert debug_ply_bytes(*case("stair")) == debug_ply_bytes(*case("stair"))


# --- CSV -----------------------------------------------------------------------------------------------------------


def read_csv(data):
    return list(csv.DictReader(io.StringIO(data.decode("utf-8"))))


def test_csv_columns_are_these():
    expected = "step,flight,kind,n_points,rms_mm,paper_h_mm,paper_d_fb_mm,paper_d_ff_mm,paper_w_mm,paper_theta_deg,"
    expected += "paper_f_mm,paper_b_mm,rise_mm,rise_u_mm,going_mm,going_u_mm,tread_depth_mm,tread_depth_u_mm,width_mm,"
    expected += "width_u_mm,nosing_overhang_mm,nosing_overhang_u_mm,pitch_deg,pitch_u_deg,fall_deg,fall_u_deg,"
    expected += "cross_fall_deg,cross_fall_u_deg,coverage,"
    expected += "rise_left_mm,rise_centre_mm,rise_right_mm,going_left_mm,going_centre_mm,going_right_mm"
    assert expected.split(",") == CSV_COLUMNS
    assert csv_bytes(case("stair")[1]).decode().split("\n")[0] == expected


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("method", ["survey", "paper"])
def test_csv_parsed_back_is_the_json_in_millimetres(name, method):
    assert_csv_is_the_json(case(name, method)[1])


@pytest.mark.parametrize("origin_m", [(0.0, 0.0, 0.0), FAR])
def test_csv_of_a_survey_parsed_back_is_the_json_in_millimetres(origin_m):
    assert_csv_is_the_json(surveyed(origin_m)[1])


def assert_csv_is_the_json(inspection):
    steps = document_of(inspection)["steps"]
    rows = read_csv(csv_bytes(inspection))
    assert len(rows) == len(steps)
    for row, step in zip(rows, steps, strict=True):
        assert int(row["step"]) == step["id"]
        assert int(row["n_points"]) == step["n_points"]
        assert row["kind"] == step["kind"]
        assert row["flight"] == ("" if step["flight"] is None else str(step["flight"]))
        for name, value in quantities_of(step).items():
            stem, unit = name.rsplit("_", 1)
            cell = row[f"{stem}_{'mm' if unit == 'm' else unit}"]
            if value is None:
                assert cell == ""
            elif unit == "m":
                # Written to the nanometre, or to the last bit of a large coordinate.
                assert float(cell) == pytest.approx(value * 1000.0, abs=0.51e-6, rel=3e-16)
            else:
                assert float(cell) == value


def quantities_of(step):
    """The quantities of a step of the JSON by the names of the CSV, in metres and degrees."""
    values = {f"paper_{name}": value for name, value in step["paper"].items()} | {"rms_m": step["rms_m"]}
    for name in SURVEY:
        stem, unit = name.rsplit("_", 1)
        values[name] = None if step[name] is None else step[name]["value"]
        values[f"{stem}_u_{unit}"] = None if step[name] is None else step[name]["u"]
    for quantity in ("rise", "going"):
        for line, value in zip(("left", "centre", "right"), step[f"{quantity}_lcr_m"] or [None] * 3, strict=True):
            values[f"{quantity}_{line}_m"] = value
    return values


def test_csv_of_no_steps_is_its_head():
    assert csv_bytes(case("no_levels")[1]) == (",".join(CSV_COLUMNS) + "\n").encode()


def test_csv_holds_measured_values_with_their_uncertainty_and_unit():
    _, inspection = case("stair")
    step = dataclasses.replace(
        inspection.steps[0], rise_m=Measured(0.17, 0.002), pitch_deg=Measured(31.5, 0.25), coverage=0.5
    )
    row = read_csv(csv_bytes(dataclasses.replace(inspection, steps=(step,))))[0]
    assert [row[name] for name in ("rise_mm", "rise_u_mm", "pitch_deg", "pitch_u_deg", "coverage")] == [
        "170.0",
        "2.0",
        "31.5",
        "0.25",
        "0.5",
    ]


def test_csv_holds_rise_and_going_on_the_three_lines():
    rows = read_csv(csv_bytes(surveyed()[1]))
    names = [f"{quantity}_{line}_mm" for quantity in ("rise", "going") for line in ("left", "centre", "right")]
    assert [rows[2][name] for name in names] == ["169.0", "170.0", "171.0", "", "280.0", "281.0"]
    assert [rows[4][name] for name in names[3:]] == ["", "", ""]
    assert list(rows[0])[-7:] == ["coverage", *names]


# --- debug PLY -----------------------------------------------------------------------------------------------------


def read_with_trimesh(path):
    cloud = trimesh.load(path, process=False)
    return np.asarray(cloud.vertices), np.asarray(cloud.colors)[:, :3]


def read_with_open3d(path):
    cloud = open3d_or_skip().io.read_point_cloud(str(path))
    return np.asarray(cloud.points), np.rint(np.asarray(cloud.colors) * 255).astype(np.uint8)


READERS = pytest.mark.parametrize("read", [read_with_trimesh, read_with_open3d])


@READERS
@pytest.mark.parametrize("name", ["stair", "far", "one_step", "no_staircase", "no_levels"])
def test_debug_ply_holds_the_scan_to_the_last_bit(tmp_path, read, name):
    scan, inspection = case(name, "paper")
    path = tmp_path / "debug.ply"
    path.write_bytes(debug_ply_bytes(scan, inspection))
    points, _ = read(path)
    np.testing.assert_array_equal(points[: len(scan.points)], scan.points + scan.origin_m)


@READERS
def test_debug_ply_has_exactly_the_papers_colours(tmp_path, read):
    # Eight steps, so that the colours begin again; a cross of upright points is no part of the stair.
    stair = Stair(n_steps=8, noise=0.002)
    points, normals = stair.sample()
    wall = np.column_stack([np.linspace(0, 2, 50), np.full(50, -0.01), np.linspace(0, 1, 50)])
    scan = make_scan(np.concatenate([points, wall]), np.concatenate([normals, np.tile([0.0, 1.0, 0.0], (50, 1))]))
    inspection = inspect(scan, exact_params(method="paper"))
    path = tmp_path / "debug.ply"
    path.write_bytes(debug_ply_bytes(scan, inspection))
    _, colors = read(path)

    paper = read_palette("paper")
    expected = np.zeros((len(scan.points), 3), dtype=np.uint8)
    truth = np.concatenate([np.full(len(part), k) for k, (part, _) in enumerate(stair.parts())] + [np.full(50, -1)])
    expected[truth == -1] = (0, 0, 0)
    expected[truth == 0] = (128, 128, 128)
    for k in range(1, 9):
        expected[truth == k] = paper.steps[(k - 1) % 7]
    for step in inspection.steps:
        assert len(step.nearest_ids) == 50
        assert (truth[step.nearest_ids] == step.step_id).all()
        expected[step.nearest_ids] = (0, 0, 0)
    np.testing.assert_array_equal(colors[: len(scan.points)], expected)


@READERS
@pytest.mark.parametrize("origin", [(0.0, 0.0, 0.0), FAR])
def test_debug_ply_draws_the_edges_of_every_step(tmp_path, read, origin):
    scan = NOISY.scan(origin_m=origin)
    inspection = inspect(scan, exact_params(method="paper"))
    path = tmp_path / "debug.ply"
    path.write_bytes(debug_ply_bytes(scan, inspection))
    points, colors = read(path)
    drawn, drawn_colors = points[len(scan.points) :] - origin, colors[len(scan.points) :]
    pink, gray, black = (255, 105, 180), (128, 128, 128), (0, 0, 0)
    at = 0
    for step in inspection.steps:
        front_left, front_right, back_right, back_left = step.corners
        for start, stop, color in (
            (front_left, front_right, pink),
            (back_left, back_right, black),
            (front_left, back_left, gray),
            (front_right, back_right, gray),
        ):
            length = np.linalg.norm(stop - start)
            count = int(np.ceil(length / 0.002)) + 1
            row = drawn[at : at + count]
            np.testing.assert_allclose(row[[0, -1]], [start, stop], rtol=0, atol=2e-9)
            assert np.linalg.norm(np.diff(row, axis=0), axis=1).max() <= 0.002 + 1e-8
            assert (drawn_colors[at : at + count] == color).all()
            at += count
        # Front and back lie at f and b along the depth axis, in the scan frame.
        along = (step.corners + origin) @ inspection.axes.depth
        np.testing.assert_allclose(
            along, np.array([1, 1, 0, 0]) * step.paper.d_fb_m + step.paper.b_m, rtol=0, atol=5e-9
        )
    assert at == len(drawn)


def test_debug_ply_of_rejected_levels_is_floor_and_no_stair():
    scan, inspection = case("no_staircase")
    _, colors = read_body(debug_ply_bytes(scan, inspection))
    assert len(colors) == len(scan.points)
    np.testing.assert_array_equal(np.unique(colors, axis=0), [[0, 0, 0], [128, 128, 128]])


def read_body(data):
    body = data.partition(b"end_header\n")[2]
    rows = np.frombuffer(body, dtype=[("xyz", "<f8", 3), ("rgb", "u1", 3)])
    return rows["xyz"], rows["rgb"]


def is_color(colors, color):
    return (colors == color).all(axis=1)


def rows_of(points):
    """Split drawn points into rows, each a start and a stop: within a row the points are close together."""
    breaks = np.flatnonzero(np.linalg.norm(np.diff(points, axis=0), axis=1) > 0.003) + 1
    return [(row[0], row[-1]) for row in np.split(points, breaks)]


def test_debug_ply_draws_the_measuring_lines_of_a_survey():
    scan, inspection = surveyed(FAR)
    points, colors = read_body(debug_ply_bytes(scan, inspection))
    drawn = points[len(scan.points) :][is_color(colors[len(scan.points) :], read_palette("paper").measure)] - FAR
    expected = []
    for step in inspection.steps:
        for point, going, rise in zip(step.line_points, step.going_lcr_m, step.rise_lcr_m, strict=True):
            # The going runs along the climb, the rise down from the same point of the nosing.
            expected += [] if going is None else [(point, point + going * np.array([1.0, 0.0, 0.0]))]
            expected += [(point, point - rise * np.array([0.0, 0.0, 1.0]))]
    assert len(expected) == 5 * 3 + 4 * 3 - 1, "what was not measured is not drawn"
    for start, stop in expected:
        between = start + np.linspace(0.0, 1.0, 50)[:, None] * (stop - start)
        gaps = np.linalg.norm(drawn[:, None] - between[None], axis=2).min(axis=0)
        assert gaps.max() <= 0.00101, "no gap in the row"
    distances = np.min([distance_to(drawn, *line) for line in expected], axis=0)
    assert distances.max() < 2e-9, "nothing else is drawn in this colour"
    ends = np.array([stop for _, stop in expected])
    assert np.linalg.norm(drawn[:, None] - ends[None], axis=2).min(axis=0).max() < 2e-9


def distance_to(points, start, stop):
    """Distance of points (n, 3) from a line segment, metres."""
    along = np.clip((points - start) @ (stop - start) / np.sum((stop - start) ** 2), 0.0, 1.0)
    return np.linalg.norm(points - start - along[:, None] * (stop - start), axis=1)


def test_measuring_lines_meet_the_steps_below_and_above():
    scan, inspection = surveyed()
    exact = tuple(
        dataclasses.replace(step, rise_lcr_m=(0.17,) * 3, going_lcr_m=(0.28,) * 3) for step in inspection.steps
    )
    points, colors = read_body(debug_ply_bytes(scan, dataclasses.replace(inspection, steps=exact)))
    drawn = points[is_color(colors, read_palette("paper").measure)]
    for below, step in itertools.pairwise(exact):
        for lower, upper in zip(below.line_points, step.line_points, strict=True):
            # Below the nosing, at the height of the one below: the corner of rise and going, where both end.
            corner = np.array([upper[0], upper[1], lower[2]])
            assert np.count_nonzero(np.linalg.norm(drawn - corner, axis=1) < 1e-9) == 2


def test_debug_ply_draws_the_nosing_lines_of_a_survey():
    scan, inspection = surveyed(FAR)
    # Away from the front edge, so that it is no part of it.
    lift = np.array([0.0, 0.0, 0.05])
    steps = tuple(dataclasses.replace(step, nosing=step.nosing + lift) for step in inspection.steps)
    points, colors = read_body(debug_ply_bytes(scan, dataclasses.replace(inspection, steps=steps)))
    pink = points[is_color(colors, (255, 105, 180))] - FAR
    lines = rows_of(pink)
    assert len(lines) == 10
    for step, (edge, nosing) in zip(steps, zip(lines[::2], lines[1::2], strict=True), strict=True):
        np.testing.assert_allclose(edge, step.corners[:2], rtol=0, atol=2e-9)
        np.testing.assert_allclose(nosing, step.nosing, rtol=0, atol=2e-9)


def test_debug_ply_of_a_survey_differs_from_the_papers_by_its_lines_only():
    scan, inspection = surveyed()
    points, colors = read_body(debug_ply_bytes(scan, inspection))
    plain_points, plain_colors = read_body(debug_ply_bytes(*case("stair", "paper")))
    np.testing.assert_array_equal(points[: len(scan.points)], plain_points[: len(scan.points)])
    np.testing.assert_array_equal(colors[: len(scan.points)], plain_colors[: len(scan.points)])
    measure = read_palette("paper").measure
    assert is_color(colors, measure).any()
    assert not is_color(plain_colors, measure).any()
    other = ~is_color(colors, measure) & ~is_color(colors, (255, 105, 180))
    np.testing.assert_array_equal(points[other], plain_points[~is_color(plain_colors, (255, 105, 180))])


def test_debug_ply_keeps_rejected_surfaces_black():
    scan, inspection = surveyed()
    # The third tread is rejected, and a level above the last step that became none.
    labels = np.where(inspection.labels == 3, -1, np.where(inspection.labels == 5, 9, inspection.labels))
    inspection = dataclasses.replace(
        inspection, labels=labels.astype(np.int16), steps=tuple(s for s in inspection.steps if s.step_id not in (3, 5))
    )
    _, colors = read_body(debug_ply_bytes(scan, inspection))
    assert is_color(colors[: len(scan.points)][np.isin(labels, (-1, 9))], (0, 0, 0)).all()
    fourth = colors[: len(scan.points)][labels == 4]
    assert np.count_nonzero(is_color(fourth, (0, 200, 0))) == len(fourth) - 50, "green, but for the K points"


@pytest.mark.parametrize("missing", ["line_points", "climb", "nosing", "rise_lcr_m", "going_lcr_m"])
def test_debug_ply_without_some_of_the_survey_draws_the_rest(missing):
    scan, inspection = surveyed()
    steps = tuple(dataclasses.replace(step, **{missing: None}) for step in inspection.steps)
    _, colors = read_body(debug_ply_bytes(scan, dataclasses.replace(inspection, steps=steps)))
    _, all_colors = read_body(debug_ply_bytes(scan, inspection))
    fewer = np.count_nonzero(is_color(all_colors, read_palette("paper").measure))
    fewer -= np.count_nonzero(is_color(colors, read_palette("paper").measure))
    if missing == "line_points":
        assert not is_color(colors, read_palette("paper").measure).any()
    elif missing == "nosing":
        assert fewer == 0
        assert len(all_colors) - len(colors) == 5 * 501
    else:
        assert 0 < fewer == len(all_colors) - len(colors)


@pytest.mark.parametrize("name", ["paper", "page", "page_dark"])
def test_measuring_lines_have_a_colour_of_their_own(name):
    palette = read_palette(name)
    other = [palette.floor, palette.non_stair, *palette.steps, palette.front_edge, palette.back_edge]
    assert palette.measure not in [*other, palette.side_edge, palette.centre]
    assert "\nmeasure = " in (static_configs() / "palettes" / f"{name}.toml").read_text(encoding="utf-8")


# --- files ---------------------------------------------------------------------------------------------------------


def test_three_files_are_made():
    scan, inspection = case("stair")
    assert inspection_files(scan, inspection) == {
        ".json": json_bytes(inspection),
        ".csv": csv_bytes(inspection),
        "_debug.ply": debug_ply_bytes(scan, inspection),
    }
