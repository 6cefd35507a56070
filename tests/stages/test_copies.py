"""A cloud that holds itself twice, and two clouds that are no copies."""

import time

import numpy as np
import pytest

from stair_inspector.stages.copies import find_mirrored_copy, find_shifted_copy
from stair_inspector.stages.density import find_spacing
from tests.stages.test_coordinate_steps import POINTS, UTM, as_float32
from tests.synthetic import Stair, make_scan

SHIFT = np.array([0.004, -0.001, 0.012])


@pytest.mark.parametrize("kept", [lambda points: points, as_float32], ids=["double", "float32"])
def test_a_copy_is_found_with_its_shift(kept):
    found = find_shifted_copy(kept(np.concatenate([POINTS, kept(POINTS) + SHIFT])))
    np.testing.assert_allclose(found * np.sign(found[2]), SHIFT, atol=2e-6)


def test_a_copy_of_most_of_a_cloud_is_found():
    part = POINTS[POINTS[:, 0] > -0.4]
    found = find_shifted_copy(np.concatenate([POINTS, part + SHIFT]))
    np.testing.assert_allclose(found * np.sign(found[2]), SHIFT, atol=1e-6)


def test_two_scans_of_one_stair_are_no_copies():
    other = Stair(n_steps=5, spacing=0.012, noise=0.002, risers=True, floor_depth=1.2, seed=9).sample()[0]
    assert find_shifted_copy(POINTS) is None
    assert find_shifted_copy(np.concatenate([POINTS, other + SHIFT])) is None
    assert find_shifted_copy(Stair(n_steps=5, risers=True).sample()[0]) is None
    assert find_shifted_copy(POINTS[:20]) is None


@pytest.mark.parametrize("way", [[0.0, 0.0, 1.7], [0.9, -0.5, 1.2]])
def test_a_line_of_points_narrower_than_the_tolerance_is_no_copy_and_takes_no_time(way):
    rng = np.random.default_rng(4)
    line = [48.0, 9.0, 0.0] + rng.uniform(0.0, 1.0, (20_000, 1)) * way + rng.uniform(0.0, 3e-5, (20_000, 3))
    began = time.process_time()
    assert find_shifted_copy(line) is None
    assert time.process_time() - began < 3.0


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("part", [slice(None), slice(None, None, 3)])
def test_a_mirrored_copy_is_found(axis, part):
    mirrored = POINTS[part].copy()
    mirrored[:, axis] *= -1.0
    assert find_mirrored_copy(make_scan(np.concatenate([POINTS, mirrored]))) == axis


def test_nothing_else_is_mirrored():
    assert find_mirrored_copy(make_scan(POINTS)) is None
    # Turned by half a circle about z, not mirrored.
    assert find_mirrored_copy(make_scan(np.concatenate([POINTS, POINTS * [-1.0, -1.0, 1.0]]))) is None
    assert find_mirrored_copy(make_scan(np.concatenate([POINTS, POINTS * [-1.0, 1.0, 1.0]]), origin_m=UTM)) is None
    other = Stair(n_steps=5, spacing=0.012, noise=0.002, risers=True, seed=9).sample()[0] * [-1.0, 1.0, 1.0]
    assert find_mirrored_copy(make_scan(np.concatenate([POINTS, other]))) is None


@pytest.mark.parametrize("spacing", [0.006, 0.02, 0.06])
def test_the_spacing_is_that_of_the_surfaces(spacing):
    points = Stair(n_steps=6, spacing=spacing, floor_depth=2.0, width=2.0, risers=True).sample()[0]
    assert find_spacing(points) == pytest.approx(spacing, rel=0.15)
    # Which of the points come first is of no matter.
    mixed = points[np.random.default_rng(2).permutation(len(points))]
    assert find_spacing(mixed) == pytest.approx(spacing, rel=0.15)
