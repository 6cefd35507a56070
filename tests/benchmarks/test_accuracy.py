"""A small part of the accuracy benchmark: u covers the truth, and would no longer do so without its parts."""

import math

import pytest

from stair_inspector.files.cleaning import to_local_metres
from stair_inspector.pipeline import inspect
from tests.benchmarks.accuracy import CASES, CLASSES, match, settings_for, simulate, tilted
from tests.synthetic import make_scan

pytestmark = pytest.mark.slow

QUANTITIES = {"rise": "rise_m", "going": "going_m", "depth": "tread_depth_m", "pitch": "pitch_deg"}
PARTS = {
    "tls_good": (("registration", "rise"),),
    "handheld": (("noise", "rise"), ("noise", "depth"), ("edge", "going"), ("registration", "rise"), ("up", "rise")),
}
"""Of each class: parts of u of which the loss shows, and in which quantity."""
SCANS = {"tls_good": ("even", "first riser -15 mm", "going shrinks"), "handheld": ("even", "one riser +8 mm", "U turn")}
SEED = 900
_LEAST = 0.85
"""About thirty values of three scans, whose errors go together: fewer than 95 % may lie within u by chance."""


def values_of(key):
    """(quantity, |error|, the measured value) of every step of a class's scans; landings have a rise alone."""
    for index, name in enumerate(SCANS[key]):
        simulated, building = simulate(CASES[name], CLASSES[key].scanner, SEED + index)
        points, origin_m = to_local_metres(tilted(simulated.points, CLASSES[key].levelled_deg, SEED + index), "m")
        scan = make_scan(points, origin_m=origin_m)
        inspection = inspect(scan, settings_for(CLASSES[key]))
        pairs, n_false, n_missed = match(inspection, building, scan.origin_m)
        assert (n_false, n_missed) == (0, 0)
        for step in inspection.steps:
            truth = pairs[step.step_id]
            for quantity, attribute in QUANTITIES.items():
                measured, true = getattr(step, attribute), getattr(truth, attribute)
                if measured is None or true is None or (truth.kind == "landing" and quantity != "rise"):
                    continue
                yield quantity, abs(measured.value - true), measured


def share_within(errors_and_us):
    return sum(error <= u for error, u in errors_and_us) / len(errors_and_us)


def without(measured, part):
    """u of a value if one of its parts were forgotten."""
    return math.sqrt(max(0.0, measured.u**2 - dict(measured.parts).get(part, 0.0) ** 2))


@pytest.fixture(scope="module", params=list(SCANS))
def values(request):
    return request.param, list(values_of(request.param))


def test_u_covers_the_truth(values):
    _, found = values
    for name in QUANTITIES:
        pairs = [(error, measured.u) for quantity, error, measured in found if quantity == name]
        assert len(pairs) >= 15
        assert share_within(pairs) >= _LEAST, name


def test_a_lost_part_of_u_would_show(values):
    key, found = values
    for part, name in PARTS[key]:
        pairs = [(error, without(measured, part)) for quantity, error, measured in found if quantity == name]
        assert share_within(pairs) < _LEAST, (part, name)
