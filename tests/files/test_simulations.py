"""Simulated scans on disk: the samples are what the program makes, and the truth is complete."""

import json
import math

import numpy as np
import pytest

from stair_inspector.errors import ConfigError, WriteError
from stair_inspector.files.paths import sample_scans
from stair_inspector.files.simulations import simulate_to_file, truth_of, write_samples, write_simulation
from stair_inspector.simulation.samples import SAMPLES
from stair_inspector.simulation.scanner import scan
from stair_inspector.simulation.scanner_specs import Scanner
from stair_inspector.simulation.scenes import SCENES
from stair_inspector.simulation.specs import Stair
from stair_inspector.simulation.staircase import build
from tests.oracles import needs_open3d

COARSE = Scanner(azimuth_step_deg=1.0, elevation_step_deg=1.0)
QUICK_SAMPLE = "handheld_noisy"
"""Its grid is the coarsest: half a second."""


def read_ply(path):
    """Points (n, 3) and colours (n, 3) of a PLY file as this program writes it."""
    header, _, body = path.read_bytes().partition(b"end_header\n")
    kind = "<f8" if b"property double x" in header else "<f4"
    rows = np.frombuffer(body, dtype=[("xyz", kind, 3), ("rgb", "u1", 3)])
    return rows["xyz"].astype(np.float64), rows["rgb"]


@needs_open3d
def test_a_sample_is_recreated_bit_for_bit(tmp_path):
    written = write_simulation(
        tmp_path / f"{QUICK_SAMPLE}.ply", scan(build(SAMPLES[QUICK_SAMPLE][0]), SAMPLES[QUICK_SAMPLE][1])
    )
    assert [path.name for path in written] == [f"{QUICK_SAMPLE}.ply", f"{QUICK_SAMPLE}.truth.json"]
    for path in written:
        assert path.read_bytes() == (sample_scans() / path.name).read_bytes()


@pytest.mark.slow
@needs_open3d
def test_all_samples_are_recreated_bit_for_bit(tmp_path):
    written = write_samples(tmp_path)
    assert {path.name for path in written} == {path.name for path in sample_scans().iterdir()}
    for path in written:
        assert path.read_bytes() == (sample_scans() / path.name).read_bytes(), path.name


@pytest.mark.parametrize("name", sorted(SAMPLES))
def test_a_sample_is_small_and_fits_its_truth(name):
    path = sample_scans() / f"{name}.ply"
    assert path.stat().st_size < 3_000_000
    truth = json.loads((sample_scans() / f"{name}.truth.json").read_text("ascii"))
    points, colors = read_ply(path)
    assert len(points) == len(colors) == truth["scan"]["n_points"]
    assert truth["stair"]["n_risers"] == len(truth["steps"])
    for step in truth["steps"]:
        left, right = np.array(step["nosing_m"])
        middle = (left + right) / 2.0
        # Points over the middle of the tread, well inside: their median is the tread, but for noise and tilt.
        inside = (np.abs(points[:, 0] - middle[0] - 0.12) < 0.05) & (np.abs(points[:, 1] - middle[1]) < 0.3)
        inside &= np.abs(points[:, 2] - middle[2]) < 0.06
        expected = middle[2] + 0.12 * math.tan(math.radians(step["fall_deg"]))
        assert inside.sum() > 20
        assert abs(np.median(points[inside, 2]) - expected) < 0.008
        assert step["n_points"] > 500


def test_truth_is_in_the_output_frame(tmp_path):
    stair = Stair(n_risers=3, yaw_deg=90.0, offset_m="691000,5335000,520", rise_errors_m="2:0.01")
    ply, truth_path = simulate_to_file(tmp_path / "far.ply", stair, COARSE)
    text = truth_path.read_text("ascii")
    truth = json.loads(text)
    assert text == json.dumps(truth, indent=2, sort_keys=True) + "\n"
    assert truth["schema"] == "stair-inspector/truth-1"
    assert truth["frame"] == {
        "up": [0.0, 0.0, 1.0],
        "climb": [0.0, 1.0, 0.0],
        "foot_m": [691000.0, 5335000.0, 520.0],
    }
    first, second, last = truth["steps"]
    # Climbing along +y, left is -x.
    assert first["nosing_m"] == [[690999.4, 5334999.975, 520.17], [691000.6, 5334999.975, 520.17]]
    assert [step["rise_m"] for step in truth["steps"]] == [0.17, 0.18, 0.17]
    assert [step["going_m"] for step in truth["steps"]] == [0.28, 0.28, None]
    assert (first["kind"], second["kind"], last["kind"]) == ("tread", "tread", "landing")
    assert last["height_m"] == 0.52
    assert truth["stair"]["rise_errors_m"] == "2:0.01"
    assert truth["scanner"]["seed"] == COARSE.seed
    # Far from the origin single precision would lose half a metre.
    assert b"property double x" in ply.read_bytes()[:300]
    points, _ = read_ply(ply)
    floor = points[np.abs(points[:, 2] - 520.0) < 0.005]
    assert len(floor) > 100
    assert floor[:, 1].max() < 5335000.01


def test_truth_of_a_stair_that_turns(tmp_path):
    stair = Stair(n_risers=5, landing_after=2, turn="right", yaw_deg=90.0, offset_m="10,20,0", width_m=1.0)
    _, truth_path = simulate_to_file(tmp_path / "turned.ply", stair, COARSE)
    truth = json.loads(truth_path.read_text("ascii"))
    landing, first = truth["steps"][1:3]
    # Climbing along +y, then to the right along +x, with the left on +y.
    assert (landing["climb"], first["climb"]) == ([0.0, 1.0, 0.0], [1.0, 0.0, 0.0])
    assert (landing["going_m"], landing["going_lcr_m"], landing["pitch_deg"]) == (None, None, None)
    assert landing["tread_depth_m"] == 1.025
    assert first["nosing_m"] == [[10.475, 21.28, 0.51], [10.475, 20.28, 0.51]]
    assert first["rise_lcr_m"] == [0.17, 0.17, 0.17]
    assert first["going_lcr_m"] == [0.28, 0.28, 0.28]
    assert first["pitch_deg"] == pytest.approx(math.degrees(math.atan2(0.17, 0.28)), abs=1e-8)
    assert [flight["shape"] for flight in truth["flights"]] == ["straight", "straight"]
    assert {step["shape"] for step in truth["steps"]} == {"straight"}


@pytest.mark.parametrize(
    ("shape", "shapes"), [("winder", {"straight", "winder"}), ("spiral", {"spiral"}), ("curved", {"curved"})]
)
def test_truth_states_the_shape(shape, shapes):
    truth = truth_of(scan(build(Stair(n_risers=6, shape=shape, winder_after=1)), COARSE))
    assert [flight["shape"] for flight in truth["flights"]] == [shape]
    assert {step["shape"] for step in truth["steps"]} == shapes
    assert truth["stair"]["shape"] == shape
    assert ("curve_radius_m" in truth["stair"]) == (shape == "curved")
    assert ("along the arc" in truth["conventions"]["going_m"]) == (shape == "curved")
    json.dumps(truth, allow_nan=False)


def test_truth_lists_the_twin_and_what_is_missing():
    stair = Stair(n_risers=4, twin_gap_m=0.25, open_risers=True, missing_treads="2")
    truth = truth_of(scan(build(stair), COARSE))
    assert [step["id"] for step in truth["steps"]] == list(range(1, 9))
    assert [flight["steps"] for flight in truth["flights"]] == [[1, 2, 3, 4], [5, 6, 7, 8]]
    assert [step["id"] for step in truth["steps"] if step["is_missing"]] == [2, 6]
    assert {step["id"] for step in truth["steps"] if not step["n_points"]} == {2, 6}


def test_a_scene_is_written_with_an_empty_truth(tmp_path):
    _, truth_path = write_simulation(tmp_path / "kerb.ply", scan(SCENES["kerb"](), COARSE))
    truth = json.loads(truth_path.read_text("ascii"))
    assert (truth["steps"], truth["flights"], truth["stair"], truth["scene"]) == ([], [], None, "kerb")
    assert truth["scan"]["n_floor"] > 100


def test_points_survive_the_file(tmp_path):
    simulated = scan(build(Stair(n_risers=2)), COARSE)
    ply, _ = write_simulation(tmp_path / "a.ply", simulated)
    points, colors = read_ply(ply)
    # Half a unit in the last place of single precision at 4 m.
    assert np.abs(points - simulated.points).max() < 2.5e-7
    assert np.array_equal(colors, simulated.colors)
    counts = truth_of(simulated)
    assert counts["scan"]["n_points"] == len(points)
    assert sum(station["n_points"] for station in counts["stations"]) == len(points)


def test_what_cannot_be_written_is_said_in_a_sentence(tmp_path):
    with pytest.raises(ConfigError, match=r"a simulated scan is a PLY file; give a name that ends in \.ply"):
        simulate_to_file(tmp_path / "scan.pcd", Stair(), COARSE)
    blind = Scanner(stations=1, elevation_low_deg=70.0, azimuth_step_deg=5.0, elevation_step_deg=5.0)
    with pytest.raises(ConfigError, match="no ray returns a point"):
        simulate_to_file(tmp_path / "blind.ply", Stair(), blind)
    (tmp_path / "file").write_text("")
    with pytest.raises(WriteError):
        simulate_to_file(tmp_path / "file" / "scan.ply", Stair(n_risers=1), COARSE)
    assert [path.name for path in tmp_path.iterdir()] == ["file"]
