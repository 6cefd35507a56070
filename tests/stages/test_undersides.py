"""An open tread above the scanner shows its underside, which is no step."""

import numpy as np
import pytest

from stair_inspector.params import Params
from stair_inspector.pipeline import inspect
from tests.synthetic import make_scan

RISE, GOING, WIDTH, N_STEPS, THICK = 0.17, 0.28, 1.0, 5, 0.04
PARAMS = Params(up="z", unit="m")
DENSITY = 8000


def rectangle(rng, low, high):
    """Points spread evenly over an axis-parallel rectangle of space, one of whose sides is none."""
    sides = np.sort(np.array(high) - np.array(low))[1:]
    return rng.uniform(low, high, (round(float(np.prod(sides)) * DENSITY), 3))


def open_stair(from_below, riser_low=None):
    """Open treads 40 mm thick; of those named only the underside and the edge; or a low solid step in their place."""
    rng = np.random.default_rng(3)
    parts = [rectangle(rng, (-1.0, -0.2, 0.0), (0.2, WIDTH + 0.2, 0.0))]
    for k in range(1, N_STEPS + 1):
        front, back, top = (k - 1) * GOING, k * GOING + (0.8 if k == N_STEPS else 0.01), k * RISE
        is_below = k in from_below
        z = top - THICK if is_below else top
        parts.append(rectangle(rng, (front, 0.0, z), (back, WIDTH, z)))
        if is_below and riser_low is not None:
            parts.append(rectangle(rng, (front, 0.0, z - riser_low), (front, WIDTH, z)))
        else:
            parts.append(rectangle(rng, (front, 0.0, top - THICK), (front, WIDTH, top)))
    points = np.concatenate(parts)
    return points + rng.normal(0.0, 0.0005, points.shape)


@pytest.mark.parametrize("step", [3, 4])
def test_a_tread_of_which_only_the_underside_was_seen_is_missing_and_said(step):
    inspection = inspect(make_scan(open_stair({step})), PARAMS)
    (note,) = [note for note in inspection.notes if note.code == "underside"]
    assert f"{step * RISE - THICK:.2f}" in note.message
    assert len(inspection.steps) == N_STEPS - 1
    for each in inspection.steps:
        assert each.rise_m is None or abs(each.rise_m.value - RISE) < 0.001
        assert each.going_m is None or abs(each.going_m.value - GOING) <= max(each.going_m.u, 0.002)
    (patch,) = [patch for patch in inspection.patches if abs(patch.height_m - (step * RISE - THICK)) < 0.005]
    assert patch.kind == "rejected"


def test_a_step_that_is_too_low_is_measured():
    # Its edge hangs below it, as that of the others does.
    inspection = inspect(make_scan(open_stair({3}, riser_low=THICK)), PARAMS)
    assert "underside" not in {note.code for note in inspection.notes}
    rises = [step.rise_m.value for step in inspection.steps]
    assert rises == pytest.approx([RISE, RISE, RISE - THICK, RISE + THICK, RISE], abs=0.001)
