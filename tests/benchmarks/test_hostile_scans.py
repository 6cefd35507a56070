"""Nothing is confidently wrong or judged falsely on the kinds of scans that are mended, on a seed of their own."""

import pytest

from tests.benchmarks.hostile_scans import run

pytestmark = pytest.mark.slow

MENDED = (
    "other axes up",
    "other units",
    "depth camera, level view",
    "seen from the foot",
    "sparse",
    "stations apart",
    "float32 far away",
)
SEED = 1


@pytest.mark.parametrize("kind", MENDED)
def test_no_confident_wrong_number_and_no_false_verdict(kind):
    (tally,) = run(kind, [SEED], verbose=False).values()
    assert tally.n_scans == sum(tally.outcomes.values()) > 0
    assert (tally.outcomes["wrong"], tally.outcomes["false verdict"]) == (0, 0)
    assert tally.outcomes["right"] + tally.outcomes["honest"] > 0
