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
    "treads of bars",
    "things on the treads",
)
SEED = 1


@pytest.mark.parametrize("kind", MENDED)
def test_no_confident_wrong_number_and_no_false_verdict(kind):
    (tally,) = run(kind, [SEED], verbose=False).values()
    assert tally.n_scans == sum(tally.outcomes.values()) > 0
    assert (tally.outcomes["wrong"], tally.outcomes["false verdict"]) == (0, 0)
    assert tally.outcomes["right"] + tally.outcomes["honest"] > 0


def test_a_cameras_frames_near_and_far_are_measured_or_doubted():
    """Thirty frames: heights of 0.3 to 1.7 m, distances of 1 to 4 m, pitches of 0 to 40 degrees, clean and noisy."""
    (tally,) = run("depth camera, own frame", [1, 2, 3], verbose=False).values()
    assert tally.n_scans == 30
    assert (tally.outcomes["wrong"], tally.outcomes["false verdict"]) == (0, 0)
    assert tally.outcomes["right"] + tally.outcomes["honest"] >= 0.6 * tally.n_scans
    for ratios in tally.ratios.values():
        assert len(ratios) > 20
        assert sum(ratio <= 1.0 for ratio in ratios) >= 0.93 * len(ratios)
