"""The bundled samples through the whole program: what is found against the truth beside them."""

import json
import math
from functools import cache
from typing import Any

import numpy as np
import pytest

from stair_inspector.files.paths import sample_scans
from stair_inspector.files.scans import read_scan
from stair_inspector.model import Inspection
from stair_inspector.params import Params
from stair_inspector.pipeline import inspect

EVEN = ["straight", "long_landing", "handheld_noisy", "defective_step"]


@cache
def inspect_sample(name: str) -> Inspection:
    return inspect(read_scan(sample_scans() / f"{name}.ply"), Params())


def truth_of(name: str) -> dict[str, Any]:
    truth: dict[str, Any] = json.loads((sample_scans() / f"{name}.truth.json").read_text())
    return truth


def height_tolerance_m(truth: dict[str, Any]) -> float:
    """Three sigma of the height of one level against the next.

    Each station is shifted by its registration error and tilted; neighbouring levels may be seen by different stations,
    which differ by sqrt(2) sigma, and a tilt moves what is 3 m away by 3 m * tilt. The up vector is fitted to the floor
    alone, to about the noise over its length of 1.8 m, and a level's centre lies 0.3 m from the next. The point noise
    itself averages out over thousands of points.
    """
    scanner = truth["scanner"]
    station = math.sqrt(2.0) * scanner["registration_m"]
    tilt = 3.0 * math.radians(scanner["tilt_deg"])
    drift = 0.5 * scanner["drift_m_per_m"]
    up = 0.3 * scanner["noise_m"] / 1.8
    return 3.0 * math.sqrt(station**2 + tilt**2 + drift**2 + up**2)


@pytest.mark.parametrize("name", EVEN)
def test_every_step_is_found_at_its_height(name: str) -> None:
    truth, inspection = truth_of(name), inspect_sample(name)
    assert len(inspection.steps) == len(truth["steps"])
    for step, true in zip(inspection.steps, truth["steps"], strict=True):
        # The middle of the tread: a tread that falls is lower at its nosing than at its centre.
        # The samples' own z is up.
        height = float(step.plane.centroid[2])
        fall = math.tan(math.radians(true.get("fall_deg") or 0.0)) * true["tread_depth_m"]
        assert true["height_m"] - height_tolerance_m(truth) <= height
        assert height <= true["height_m"] + fall + height_tolerance_m(truth)


def test_the_defective_riser_stands_out() -> None:
    truth, inspection = truth_of("defective_step"), inspect_sample("defective_step")
    rises = [inspection.floor_h_m, *(step.paper.h_m for step in inspection.steps[:-1])]
    true = [step["rise_m"] for step in truth["steps"]]
    # Tread 3 falls by 6 %, which moves its centre and so both heights beside it; elsewhere the two agree.
    for k in (0, 1, 4, 5, 6, 7, 8):
        assert rises[k] == pytest.approx(true[k], abs=2.0 * height_tolerance_m(truth))
    assert int(np.argmax(rises)) == int(np.argmax(true)) == 4


def test_the_long_sample_exchanges_the_global_axes_and_auto_does_not() -> None:
    scan = read_scan(sample_scans() / "long_landing.ply")
    by_paper = inspect(scan, Params(method="paper"))
    assert by_paper.axes is not None
    assert abs(by_paper.axes.depth[0]) < 0.05
    assert "axes_disagree" in {note.code for note in by_paper.notes}
    automatic = inspect_sample("long_landing")
    assert automatic.axes is not None
    assert automatic.axes.depth[0] < -0.99


def test_the_wall_of_the_cluttered_sample_is_not_taken_for_the_floor() -> None:
    inspection = inspect_sample("ceiling_clutter")
    assert inspection.up.vector[2] > math.cos(math.radians(0.2))
    assert "floor_not_largest" in {note.code for note in inspection.notes}
