"""A flat thing on a tread leans it not and moves no riser; where too much is covered, u holds both levels."""

import numpy as np
import pytest

from stair_inspector.params import Params
from stair_inspector.pipeline import inspect
from tests.synthetic import Stair, make_scan, rotation

STAIR = Stair(n_steps=5, width=1.1, risers=True, spacing=0.011, noise=0.0008, floor_depth=0.8, seed=4)
POINTS = STAIR.sample()[0]


def found(high_m, y_low, y_high, steps=(3,), x_low=0.0):
    points = POINTS.copy()
    for k in steps:
        front = (k - 1) * STAIR.going
        on = np.abs(points[:, 2] - k * STAIR.rise) < 0.006
        on &= (points[:, 0] > front + x_low) & (points[:, 0] < front + STAIR.going - 0.003)
        points[on & (points[:, 1] > y_low) & (points[:, 1] < y_high), 2] += high_m
    return inspect(make_scan(points @ rotation("z", 20.0).T), Params(up="z", unit="m"))


def codes(inspection):
    return [note.code for note in inspection.notes if note.code in ("thing_on_tread", "two_levels")]


@pytest.mark.parametrize(("high_m", "y_low", "y_high", "x_low"), [(0.005, 0.6, 1.0, 0.0), (0.01, 0.55, 1.1, 0.1)])
def test_a_thing_on_one_tread_is_taken_off_it(high_m, y_low, y_high, x_low):
    inspection = found(high_m, y_low, y_high, x_low=x_low)
    assert codes(inspection) == ["thing_on_tread"]
    assert len(inspection.steps) == STAIR.n_steps
    tread, above = inspection.steps[2:4]
    for slope in (tread.fall_deg, tread.cross_fall_deg):
        assert abs(slope.value) <= slope.u < 0.4
    for rise in (tread.rise_m, above.rise_m):
        assert abs(rise.value - STAIR.rise) <= max(rise.u, 0.0005)
        assert rise.u < 0.001
    # The thing is a piece of the tread it lies on.
    assert sum(patch.step_id == 3 for patch in inspection.patches) == 2


def test_where_more_of_a_tread_is_covered_its_uncertainties_hold_either_level():
    inspection = found(0.008, 0.2, 0.85)
    assert codes(inspection) == ["two_levels"]
    tread, above = inspection.steps[2:4]
    for rise, shift in ((tread.rise_m, 0.008), (above.rise_m, -0.008)):
        assert abs(rise.value - STAIR.rise) <= rise.u
        assert abs(rise.value - STAIR.rise - shift) <= rise.u
    assert abs(tread.cross_fall_deg.value) <= tread.cross_fall_deg.u
    assert inspection.steps[1].rise_m.u < 0.001


def test_what_lies_on_most_treads_is_no_single_thing():
    assert "thing_on_tread" not in codes(found(0.006, 0.6, 1.0, steps=(1, 2, 3, 4)))
