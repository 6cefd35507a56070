"""What the steps of a sparse flight say together, on shapes whose planes are stated and points drawn from them."""

import dataclasses
import math

import numpy as np
import pytest

from stair_inspector.model import HeightOrder, Up
from stair_inspector.stages.pooled import pool_steps
from stair_inspector.stages.sparse import SPARSE_M
from tests.stages.stated_shapes import GOING, RISE, edge, plane, shape


def ordered(points):
    """These points (n, 3) in their order of height, in a frame that is level."""
    points = points[np.argsort(points[:, 2])]
    up = Up(np.array([0.0, 0.0, 1.0]), "given")
    return HeightOrder(np.arange(len(points)), np.ones(len(points)), points.T.copy(), np.eye(3), up, len(points))


# --- falls ---------------------------------------------------------------------------------------------------------

NO_POINTS = ordered(np.array([[50.0, 50.0, 9.0], [51.0, 50.0, 9.1]]))
KNOWN_AT_M = 0.14
"""Where along the climb the height of a tread is known best: in the middle of its points."""


def sparse_plane(k, fall, fall_noise, spacing_m=0.03):
    """A tread known to 0.4 mm in its middle, falling by ``fall``."""
    covariance = np.diag([0.0004**2 + (KNOWN_AT_M * fall_noise) ** 2, fall_noise**2, 0.001**2])
    covariance[0, 1] = covariance[1, 0] = -KNOWN_AT_M * fall_noise**2
    height_m = (k + 1) * RISE - fall * KNOWN_AT_M
    sampled = plane(height_m, (fall, 0.0), sigma_m=0.001, spacing_m=spacing_m, misfit_m=0.0006)
    return dataclasses.replace(sampled, covariance=covariance)


def pooled(*planes):
    shapes = [shape(k, plane=each, nosing_offsets=(0.002, 0.003, 0.004)) for k, each in enumerate(planes)]
    return pool_steps(NO_POINTS, shapes, 0.0)


def test_treads_that_differ_by_chance_get_the_fall_of_all_about_the_middle_of_their_points():
    first, second = pooled(sparse_plane(0, 0.010, 0.001), sparse_plane(1, 0.016, 0.002))
    # Weights 1 and 1/4 of the square of 0.001.
    common, of_mean = (0.010 + 0.25 * 0.016) / 1.25, 0.001 / math.sqrt(1.25)
    for k, step in enumerate((first, second)):
        assert step.plane.slope == pytest.approx((common, 0.0))
        # In the middle of its points each is as high as it was seen, and as surely.
        assert step.plane.at(KNOWN_AT_M, 0.0) == pytest.approx((k + 1) * RISE)
        assert step.plane.noise_at(KNOWN_AT_M, 0.0) == pytest.approx(0.0004)
        # Treads are built to fall alike to half a thousandth.
        of_fall = math.hypot(of_mean, 0.0005)
        at_nosing = math.hypot(0.0004, KNOWN_AT_M * of_fall)
        assert step.plane.noise_at(0.0, 0.0) == pytest.approx(at_nosing)
        # So few points lie near a nosing that its height is the plane's, which is no plane by 0.6 mm.
        assert step.nosing_offsets == (0.0, 0.0, 0.0)
        assert step.nosing_noise == pytest.approx((math.hypot(at_nosing, 0.0003),) * 3)


def test_a_tread_that_falls_otherwise_than_by_chance_keeps_its_own_fall_and_turns_no_other():
    falls = (0.010, 0.011, 0.040)
    steps = pooled(*(sparse_plane(k, fall, 0.001) for k, fall in enumerate(falls)))
    assert steps[2].plane.slope[0] == 0.040
    assert [step.plane.slope[0] for step in steps[:2]] == pytest.approx([0.0105, 0.0105])


def test_a_tread_that_is_densely_sampled_keeps_what_it_shows():
    dense, sparse = pooled(sparse_plane(0, 0.010, 0.001, SPARSE_M), sparse_plane(1, 0.012, 0.001))
    assert dense.plane.slope[0] == 0.010
    assert dense.nosing_offsets == (0.002, 0.003, 0.004)
    assert sparse.plane.slope[0] == pytest.approx(0.011)


def test_falls_and_faces_of_a_coarse_lattice_are_left_alone():
    shapes = [shape(k, plane=sparse_plane(k, 0.010 + 0.002 * k, 0.001)) for k in range(2)]
    assert [step.plane.slope[0] for step in pool_steps(NO_POINTS, shapes, 0.005)] == [0.010, 0.012]
    alone = pool_steps(NO_POINTS, shapes[:1], 0.0)
    assert alone[0].plane.slope[0] == 0.010


# --- sides ---------------------------------------------------------------------------------------------------------

N = 600


def flight_of(sides, rng, stray=0):
    """Shapes whose sides were guessed 30 mm too far in, and evenly spread points of treads between these sides."""
    points, shapes = [], []
    for k, (right, left) in enumerate(sides):
        s, w = rng.uniform(0.0, GOING, N), rng.uniform(right, left, N)
        points.append(np.column_stack([k * GOING + s, w, np.full(N, (k + 1) * RISE)]))
        guess = {"left": edge(left - 0.03), "right": edge(right + 0.03), "extent": (0.0, GOING, right, left)}
        shapes.append(shape(k, plane=plane((k + 1) * RISE, spacing_m=0.015), **guess))
        w = rng.uniform(left + 0.03, left + 0.1, stray)
        points.append(np.column_stack([np.full(stray, k * GOING + 0.1), w, np.full(stray, (k + 1) * RISE)]))
    return ordered(np.concatenate(points)), shapes


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("stray", [0, 2])
def test_all_treads_together_tell_where_their_sides_are(seed, stray):
    heights, shapes = flight_of([(-0.5, 0.7)] * 4, np.random.default_rng(seed), stray)
    gap_m = 1.2 / (4 * N)
    for step in pool_steps(heights, shapes, 0.0):
        # The outermost of evenly spread points lies an exponential's distance inside: five of it hold 99 %.
        assert step.left.at(0.1) == pytest.approx(0.7, abs=5.0 * gap_m)
        assert step.right.at(0.1) == pytest.approx(-0.5, abs=5.0 * gap_m)
        assert step.left.noise_m == pytest.approx(gap_m, rel=0.2)
        assert step.left.source == "tread"
        assert step.line_range == pytest.approx((step.right.at(0.0), step.left.at(0.0)))


def test_a_tread_that_ends_elsewhere_ends_there():
    sides = [(-0.5, 0.7), (-0.5, 0.7), (-0.5, 0.6), (-0.5, 0.7)]
    heights, shapes = flight_of(sides, np.random.default_rng(3))
    steps = pool_steps(heights, shapes, 0.0)
    own_gap_m = 1.1 / N
    assert steps[2].left.at(0.1) == pytest.approx(0.6, abs=5.0 * own_gap_m)
    assert steps[2].left.noise_m == pytest.approx(own_gap_m, rel=0.3)
    assert [steps[k].left.at(0.1) for k in (0, 1, 3)] == pytest.approx([0.7] * 3, abs=0.003)
    # On its other side it ends with the others.
    assert steps[2].right.at(0.1) == steps[1].right.at(0.1)


def test_a_wide_landing_neither_tells_nor_takes_the_sides_of_the_treads():
    rng = np.random.default_rng(4)
    heights, shapes = flight_of([(-0.5, 0.7)] * 3 + [(-0.9, 1.3)], rng)
    shapes[3] = dataclasses.replace(shapes[3], extent=(0.0, 1.4, -0.9, 1.3))
    steps = pool_steps(heights, shapes, 0.0)
    assert (steps[3].left, steps[3].right) == (shapes[3].left, shapes[3].right)
    assert [step.left.at(0.1) for step in steps[:3]] == pytest.approx([0.7] * 3, abs=0.003)
