"""JSON, CSV and debug PLY of one inspection say the same, in the promised form."""

import csv
import dataclasses
import io
import json
from pathlib import Path

import jsonschema
import numpy as np
import pytest

from stair_inspector import __version__
from stair_inspector.errors import WriteError
from stair_inspector.files import exports
from stair_inspector.files.exports import CSV_COLUMNS, csv_bytes, debug_ply_bytes, json_bytes, write_inspection
from stair_inspector.files.palettes import read_palette
from stair_inspector.files.paths import static_configs
from stair_inspector.geometry.open3d import load_open3d
from stair_inspector.model import Measured
from stair_inspector.pipeline import inspect
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
SURVEY_OTHER = ["coverage", "rise_lcr_m", "going_lcr_m", "nosing_m"]


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


def case(name, method="survey"):
    scan = CASES[name]()
    return scan, inspect(scan, exact_params(method=method))


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


@pytest.mark.parametrize("breakage", ["without_rise", "zero_id", "text_as_length", "null_origin"])
def test_the_schema_refuses_what_it_should(validator, breakage):
    document = json.loads(json_bytes(case("stair")[1]))
    if breakage == "without_rise":
        del document["steps"][0]["rise_m"]
    elif breakage == "zero_id":
        document["steps"][0]["id"] = 0
    elif breakage == "text_as_length":
        document["steps"][0]["paper"]["w_m"] = "1.0"
    else:
        document["scan"]["origin_m"] = None
    assert not validator.is_valid(document)


def test_every_field_of_the_json_is_described_by_the_schema(validator):
    def undescribed(value, schema, place):
        schema = validator.schema["$defs"][schema["$ref"].rsplit("/", 1)[1]] if "$ref" in schema else schema
        schema = schema["anyOf"][0] if "anyOf" in schema else schema
        if isinstance(value, dict) and "properties" in schema:
            for key, inner in value.items():
                if key not in schema["properties"]:
                    yield f"{place}.{key}"
                else:
                    yield from undescribed(inner, schema["properties"][key], f"{place}.{key}")
        elif isinstance(value, list) and value and isinstance(value[0], dict):
            yield from undescribed(value[0], schema["items"], f"{place}[]")

    document = json.loads(json_bytes(case("step_without_a_plane")[1]))
    assert list(undescribed(document, validator.schema, "")) == []


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


@pytest.mark.parametrize("method", ["survey", "paper"])
def test_survey_fields_are_present_and_null(method):
    document = json.loads(json_bytes(case("stair", method)[1]))
    assert document["flights"] == []
    for step in document["steps"]:
        assert {name: step[name] for name in [*SURVEY, *SURVEY_OTHER]} == dict.fromkeys([*SURVEY, *SURVEY_OTHER])
        assert step["flight"] is None


def test_the_last_step_has_null_and_never_zero():
    last = json.loads(json_bytes(case("stair", "paper")[1]))["steps"][-1]["paper"]
    assert [name for name, value in last.items() if value is None] == ["h_m", "d_ff_m", "theta_deg"]


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
    expected += "cross_fall_deg,cross_fall_u_deg,coverage"
    assert expected.split(",") == CSV_COLUMNS
    assert csv_bytes(case("stair")[1]).decode().split("\n")[0] == expected


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("method", ["survey", "paper"])
def test_csv_parsed_back_is_the_json_in_millimetres(name, method):
    _, inspection = case(name, method)
    steps = json.loads(json_bytes(inspection))["steps"]
    rows = read_csv(csv_bytes(inspection))
    assert len(rows) == len(steps)
    for row, step in zip(rows, steps, strict=True):
        assert int(row["step"]) == step["id"]
        assert int(row["n_points"]) == step["n_points"]
        assert row["kind"] == step["kind"]
        values = {f"paper_{name}": value for name, value in step["paper"].items()} | {"rms_m": step["rms_m"]}
        values |= {name: step[name] for name in SURVEY}
        for json_name, value in values.items():
            stem, unit = json_name.rsplit("_", 1)
            cell = row[f"{stem}_{'mm' if unit == 'm' else unit}"]
            if value is None:
                assert cell == ""
            elif unit == "m":
                # Written to the nanometre, or to the last bit of a large coordinate.
                assert float(cell) == pytest.approx(value * 1000.0, abs=0.51e-6, rel=3e-16)
            else:
                assert float(cell) == value


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


# --- debug PLY -----------------------------------------------------------------------------------------------------


def read_with_trimesh(path):
    cloud = pytest.importorskip("trimesh").load(path, process=False)
    return np.asarray(cloud.vertices), np.asarray(cloud.colors)[:, :3]


def read_with_open3d(path):
    cloud = load_open3d().io.read_point_cloud(str(path))
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
    inspection = inspect(scan, exact_params())
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
    inspection = inspect(scan, exact_params())
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
    body = debug_ply_bytes(scan, inspection).partition(b"end_header\n")[2]
    colors = np.frombuffer(body, dtype=[("xyz", "<f8", 3), ("rgb", "u1", 3)])["rgb"]
    assert len(colors) == len(scan.points)
    np.testing.assert_array_equal(np.unique(colors, axis=0), [[0, 0, 0], [128, 128, 128]])


# --- files ---------------------------------------------------------------------------------------------------------


def test_three_files_are_written_under_the_stem(tmp_path):
    scan, inspection = case("stair")
    written = write_inspection(scan, inspection, tmp_path / "new" / "folder", "scan.v2")
    folder = tmp_path / "new" / "folder"
    assert written == [folder / "scan.v2.json", folder / "scan.v2.csv", folder / "scan.v2_debug.ply"]
    assert sorted(folder.iterdir()) == sorted(written)
    assert written[0].read_bytes() == json_bytes(inspection)
    assert written[1].read_bytes() == csv_bytes(inspection)
    assert written[2].read_bytes() == debug_ply_bytes(scan, inspection)


def test_nothing_is_written_when_a_result_cannot_be_made(tmp_path, monkeypatch):
    def fail(*_):
        raise MemoryError

    monkeypatch.setattr(exports, "debug_ply_bytes", fail)
    with pytest.raises(MemoryError):
        write_inspection(*case("stair"), tmp_path, "scan")
    assert list(tmp_path.iterdir()) == []


def test_a_file_as_folder_is_a_write_error(tmp_path):
    (tmp_path / "file").write_bytes(b"")
    with pytest.raises(WriteError, match="cannot be written"):
        write_inspection(*case("stair"), Path(tmp_path / "file"), "scan")
