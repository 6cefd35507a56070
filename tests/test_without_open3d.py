"""Where Open3D cannot be loaded, everything is measured all the same, and a note says so."""

import json
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

from stair_inspector.cli import main
from stair_inspector.files.ply import ply_bytes
from stair_inspector.geometry import open3d
from stair_inspector.quantities import IN_FILES, PAPER_QUANTITIES
from tests.oracles import needs_open3d
from tests.synthetic import Stair

ROOT = Path(__file__).parent.parent
BLOCKED = """\
import sys


class Blocked:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in ("open3d", "libusb_package"):
            raise ImportError(f"{name} is blocked")


sys.meta_path.insert(0, Blocked())
from stair_inspector.cli import main

from stair_inspector.files.scans import read_scan

for method in ("survey", "paper"):
    assert main(["measure", "stair.ply", "-o", method, "--method", method]) == 0
print(read_scan("boxes.obj", "m").notes[-1].message)
step = "0.5"
angles = ["--scanner.azimuth-step-deg", step, "--scanner.elevation-step-deg", step]
assert main(["simulate", "known.ply", "--stair.n-risers", "3", *angles]) == 0
assert "open3d" not in sys.modules
"""
BOXES = "\n".join(
    [f"v {x} {y} {z}" for low in (0.0, 0.05) for x in (low, low + 0.1) for y in (0.0, 0.1) for z in (low, low + 0.1)]
    + [
        "f " + " ".join(str(corner + first) for corner in face)
        for first in (0, 8)
        for face in ((1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4))
    ]
    + [""]
)
"""Two boxes that overlap: what lies inside one of them is left out."""


@pytest.fixture(scope="module")
def without(tmp_path_factory):
    """A folder with what was measured where Open3D is blocked, and what was printed."""
    folder = tmp_path_factory.mktemp("without")
    points, _ = Stair(n_steps=4, risers=True, noise=0.002, spacing=0.015).sample()
    (folder / "stair.ply").write_bytes(ply_bytes(points))
    (folder / "boxes.obj").write_text(BOXES)
    done = subprocess.run(
        [sys.executable, "-c", BLOCKED],
        cwd=folder,
        env={"PYTHONPATH": str(ROOT), "PATH": ""},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return folder, done.stdout


def measured(folder, method):
    return json.loads((folder / method / "stair.json").read_text(encoding="utf-8"))


@needs_open3d
@pytest.mark.slow
@pytest.mark.parametrize("method", ["survey", "paper"])
def test_values_are_those_of_open3d_within_a_third_of_u(without, method, tmp_path, capsys):
    folder, _ = without
    assert main(["measure", str(folder / "stair.ply"), "-o", str(tmp_path / method), "--method", method]) == 0
    assert ", normals by Open3D" in capsys.readouterr().out or method == "survey"
    with_it, without_it = measured(tmp_path, method), measured(folder, method)
    assert with_it["normals"] == {"by": "open3d"}
    assert [note for note in with_it["notes"] if note["code"] == "without_open3d"] == []
    assert len(with_it["steps"]) == len(without_it["steps"]) == 4
    compared = 0
    for step, other in zip(with_it["steps"], without_it["steps"], strict=True):
        # The horizontal set is the same: every point stays with its tread.
        assert other["n_points"] == step["n_points"]
        for quantity in PAPER_QUANTITIES:
            assert other["paper"][quantity.column] == pytest.approx(step["paper"][quantity.column], abs=1e-5)
        for quantity in IN_FILES:
            value, own = step[quantity.column], other[quantity.column]
            assert (value is None) == (own is None)
            if value is not None:
                assert abs(own["value"] - value["value"]) <= value["u"] / 3.0
                compared += 1
    assert compared >= 20 or method == "paper"


@pytest.mark.slow
@pytest.mark.parametrize("method", ["survey", "paper"])
def test_a_note_says_who_made_the_normals(without, method):
    folder, said = without
    found = measured(folder, method)
    notes = [note["message"] for note in found["notes"] if note["code"] == "without_open3d"]
    assert found["normals"] == {"by": "numpy"}
    assert len(notes) == 1
    assert notes[0].startswith("normals and floor are made by numpy and SciPy, not by Open3D: it is not installed")
    assert said.count(notes[0]) == 2
    assert "4 steps, normals by numpy and SciPy\n" in said


def test_meshes_and_simulated_scans_need_no_open3d(without):
    folder, said = without
    assert "800 of these points left out: they lie inside solids that overlap" in said
    assert len(json.loads((folder / "known.truth.json").read_text())["steps"]) == 3


def test_missing_libraries_of_the_system_are_named_with_their_packages(monkeypatch):
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setattr(open3d.importlib.util, "find_spec", lambda name: object())
    monkeypatch.setattr(open3d, "_can_load", lambda name: name not in ("libGL.so.1", "libX11.so.6"))
    assert open3d.why_not_loadable() == (
        "this system lacks libGL.so.1, libX11.so.6 (on Debian and Ubuntu: apt-get install libgl1 libx11-6)"
    )
    monkeypatch.setattr(open3d.importlib.util, "find_spec", lambda name: None)
    assert open3d.why_not_loadable() == "it is not installed"


def _fails(name):
    raise RuntimeError(f"no {name} here")


@pytest.mark.parametrize(
    ("contents", "said"),
    [({}, "its import fails (module 'open3d' has no attribute"), ({"__getattr__": _fails}, "its import fails (no ")],
    ids=["a folder of that name", "one that fails"],
)
def test_another_module_of_that_name_cannot_be_loaded(monkeypatch, contents, said):
    other = ModuleType("open3d")
    vars(other).update(contents)
    monkeypatch.setitem(sys.modules, "open3d", other)
    monkeypatch.setattr(open3d, "why_not_loadable", lambda: "")
    found, reason = open3d._find.__wrapped__()
    assert found is None
    assert reason.startswith(said)
