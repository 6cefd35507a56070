"""Edges of sampled surfaces: where they end, where a face meets them, and how sure that is.

Each surface ends at ``out`` 0 unless a test says otherwise. ``doubt`` is what the survey states about an edge beyond
the scatter along it: a bias below it is covered by the uncertainty that is shown.
"""

import dataclasses
import math

import numpy as np
import pytest

from stair_inspector.geometry.edges import EdgeLine, Sampling, find_face_edge, fit_line_robust
from stair_inspector.geometry.extents import find_extent_edge
from tests.synthetic import rotation

SPAN = (0.03, 0.97)
N_M2 = 40_000
SPACING = N_M2**-0.5
DOWN = (-0.003, -0.032)
FACE_REACH = 0.012


def doubt(spacing=SPACING, sigma=0.0):
    return 0.12 * spacing + 0.1 * sigma


def surface(seed, sigma=0.0, stop=0.0, n_m2=N_M2):
    """Random points on 0.3 m of a surface, 1 m long, with noise in every direction: out, along, offset."""
    rng = np.random.default_rng(seed)
    n = round(n_m2 * (stop + 0.3))
    flat = np.stack([rng.uniform(-0.3, stop, n), rng.uniform(0.0, 1.0, n), np.zeros(n)])
    return flat + rng.normal(0.0, 1.0, (3, n)) * np.array([[sigma], [0.0], [sigma]])


def face(seed, sigma=0.0, at=0.0, heights=(-0.17, 0.0), n_m2=N_M2, slope=0.0):
    """Random points on an upright face at ``out`` = at + slope * (along - 0.5)."""
    rng = np.random.default_rng(seed + 5000)
    n = round(n_m2 * (heights[1] - heights[0]))
    along = rng.uniform(0.0, 1.0, n)
    points = np.stack([at + slope * (along - 0.5), along, rng.uniform(*heights, n)])
    return points + rng.normal(0.0, 1.0, (3, n)) * np.array([[sigma], [0.0], [sigma]])


def grid(spacing, phase, turn_deg):
    """A square grid of points, turned against the edge; ``phase`` shifts it by a share of the spacing."""
    axis = (np.arange(-160, 161) + phase) * spacing
    plan = np.stack(np.meshgrid(axis, axis, indexing="ij")).reshape(2, -1)
    out, along = rotation("z", turn_deg)[:2, :2] @ plan
    inside = (out > -0.3) & (out <= 0.0) & (along > -0.5) & (along < 0.5)
    return np.stack([out[inside], along[inside] + 0.5, np.zeros(np.count_nonzero(inside))])


def extent(points, guess=0.0, sigma=0.0, spacing=SPACING, half="all", span=SPAN, is_square=False):
    return find_extent_edge(*points, span, guess, Sampling(max(sigma, 1e-4), spacing), half, is_square)


def face_edge(points, guess=(0.0, 0.0), sigma=0.0, reach=FACE_REACH, heights=DOWN, span=SPAN, is_square=False):
    # The nearest points are those that noise cannot have carried from the surface, as the survey asks for them.
    near = max(abs(heights[0]), 2.2 * sigma) * np.sign(heights[0])
    far = max(abs(heights[1]), abs(near) + 0.012) * np.sign(heights[1])
    return find_face_edge(*points, span, guess, reach, (near, far), Sampling(max(sigma, 1e-4), SPACING), is_square)


def assert_same_line(line, other, atol=1e-9):
    numbers, others = (
        [value for value in dataclasses.astuple(each) if not isinstance(value, str)] for each in (line, other)
    )
    np.testing.assert_allclose(numbers, others, rtol=1e-6, atol=atol)


# fit_line_robust


@pytest.mark.parametrize("n", [3, 4, 12])
def test_an_exact_line_is_found_exactly(n):
    x = np.linspace(1.0, 3.0, n)
    line = fit_line_robust(x, 0.3 - 0.07 * x, np.full(n, 0.001))
    assert line.slope == pytest.approx(-0.07, abs=1e-12)
    assert line.middle == pytest.approx(0.3 - 0.07 * line.x_middle, abs=1e-12)
    # Without scatter the stated uncertainty of each value stands.
    assert line.middle_noise == pytest.approx(0.001 / np.sqrt(n), rel=1e-6)


def test_two_points_are_joined():
    line = fit_line_robust(np.array([0.0, 2.0]), np.array([0.1, 0.3]), np.array([0.002, 0.002]))
    assert (line.slope, line.middle, line.x_middle) == pytest.approx((0.1, 0.2, 1.0), abs=1e-12)
    assert line.middle_noise == pytest.approx(0.002 / np.sqrt(2.0))
    assert line.slope_noise == pytest.approx(0.002 * np.sqrt(2.0) / 2.0)


@pytest.mark.parametrize("x", [[], [1.0], [1.0, 1.0, 1.0]])
def test_nothing_is_fitted_to_a_single_place(x):
    assert fit_line_robust(np.array(x), np.zeros(len(x)), np.full(len(x), 0.01)) is None


@pytest.mark.parametrize("seed", range(5))
def test_three_outliers_in_ten_do_not_move_a_line(seed):
    rng = np.random.default_rng(seed)
    x = np.linspace(0.0, 1.0, 10)
    y = 0.02 + 0.05 * x
    y[rng.choice(10, 3, replace=False)] += rng.choice([-1.0, 1.0], 3) * rng.uniform(0.03, 0.3, 3)
    line = fit_line_robust(x, y, np.full(10, 0.0005))
    assert line.slope == pytest.approx(0.05, abs=1e-9)
    assert line.middle - line.slope * line.x_middle == pytest.approx(0.02, abs=1e-9)


def test_a_level_line_has_no_slope_and_ignores_outliers():
    x = np.linspace(0.0, 1.0, 9)
    y = np.where(np.arange(9) == 8, 0.4, 0.1)
    line = fit_line_robust(x, y, np.full(9, 0.001), is_level=True)
    assert (line.slope, line.slope_noise) == (0.0, 0.0)
    assert line.middle == pytest.approx(0.1, abs=1e-12)


def test_an_exact_piece_counts_more_than_a_vague_one():
    x = np.arange(4.0)
    y = np.array([0.0, 0.001, 0.0, 0.001])
    low = fit_line_robust(x, y, np.array([0.001, 0.002, 0.001, 0.002]), is_level=True)
    even = fit_line_robust(x, y, np.full(4, 0.001), is_level=True)
    assert low.middle < even.middle - 1e-4


def test_the_line_through_two_pieces_is_as_sure_as_they_are():
    line = fit_line_robust(np.array([0.0, 1.0]), np.array([0.002, 0.004]), np.array([0.001, 0.002]))
    # Weights 1 and 1/4: the middle at 0.2, known to sqrt(0.8^2 1^2 + 0.2^2 2^2) mm.
    assert (line.x_middle, line.middle) == pytest.approx((0.2, 0.0024))
    assert line.middle_noise == pytest.approx(0.001 * math.sqrt(0.8))
    # A difference of two heights, over 1 m.
    assert line.slope_noise == pytest.approx(0.001 * math.hypot(1.0, 2.0))


def test_a_piece_that_seems_far_more_exact_than_the_usual_one_counts_four_times_as_much():
    line = fit_line_robust(np.array([0.0, 1.0, 2.0]), np.zeros(3), np.array([0.0001, 0.001, 0.001]))
    # As if it were known to half of what is usual: weights 4, 1 and 1.
    assert line.x_middle == pytest.approx(3.0 / 6.0)
    assert line.middle_noise == pytest.approx(math.sqrt((4.0 * 0.0001) ** 2 + 2.0 * 0.001**2) / 6.0)


def test_the_uncertainty_of_a_line_is_that_of_many_lines():
    x = np.linspace(0.0, 1.0, 12)
    rng = np.random.default_rng(3)
    lines = [fit_line_robust(x, rng.normal(0.0, 0.002, 12), np.full(12, 0.002)) for _ in range(200)]
    at_middle = [line.middle + line.slope * (0.5 - line.x_middle) for line in lines]
    # 200 lines tell a standard deviation to 5 percent; a robust fit is 5 percent wider than least squares.
    assert np.mean([line.middle_noise for line in lines]) == pytest.approx(np.std(at_middle), rel=0.2)
    assert np.mean([line.slope_noise for line in lines]) == pytest.approx(
        np.std([line.slope for line in lines]), rel=0.2
    )


@pytest.mark.parametrize("seed", range(4))
def test_agrees_with_huber_regression_within_the_noise(seed):
    from sklearn import linear_model

    rng = np.random.default_rng(seed)
    sigma = 0.002
    x = np.sort(rng.uniform(0.0, 1.0, 40))
    y = -0.01 + 0.03 * x + rng.normal(0.0, sigma, 40)
    # Few enough that Huber's estimate, which only limits an outlier's pull, is hardly pulled.
    y[rng.choice(40, 3, replace=False)] += 0.02
    # In units of the noise, since the oracle's solver has absolute tolerances.
    oracle = linear_model.HuberRegressor(alpha=0.0, max_iter=1000, tol=1e-8).fit(x[:, None], y / sigma)
    line = fit_line_robust(x, y, np.full(40, sigma))
    expected = sigma * oracle.predict(np.array([[0.0], [line.x_middle], [1.0]]))
    ours = line.middle + line.slope * (np.array([0.0, line.x_middle, 1.0]) - line.x_middle)
    limit = 2.0 * np.hypot(line.middle_noise, line.slope_noise * 0.6)
    np.testing.assert_allclose(ours, expected, rtol=0.0, atol=limit)


@pytest.mark.parametrize("is_level", [False, True])
def test_a_line_does_not_depend_on_the_order_or_the_place_of_its_points(is_level):
    rng = np.random.default_rng(8)
    x, y, sigma = np.linspace(0.0, 1.0, 11), rng.normal(0.0, 0.002, 11), rng.uniform(0.001, 0.003, 11)
    line = fit_line_robust(x, y, sigma, is_level)
    order = rng.permutation(11)
    moved = fit_line_robust(x[order] + 7.0, y[order] - 3.0, sigma[order], is_level)
    assert_same_line(dataclasses.replace(moved, middle=moved.middle + 3.0, x_middle=moved.x_middle - 7.0), line, 1e-8)


# find_face_edge


@pytest.mark.parametrize(("heights", "of_face"), [(DOWN, (-0.17, 0.0)), ((0.003, 0.032), (0.0, 0.17))])
def test_an_exact_face_is_found_exactly(heights, of_face):
    points = np.concatenate([surface(1), face(1, at=0.004, heights=of_face)], axis=1)
    edge = face_edge(points, heights=heights)
    assert edge.at(0.5) == pytest.approx(0.004, abs=1e-9)
    assert edge.slope == pytest.approx(0.0, abs=1e-9)
    assert (edge.support, edge.purity, edge.source) == (1.0, pytest.approx(1.0), "face")
    # It is looked for on one side of the plane only.
    assert face_edge(points, heights=(-heights[0], -heights[1])) is None


@pytest.mark.parametrize("sigma", [0.001, 0.003, 0.006])
def test_a_face_is_unbiased_among_the_noisy_points_of_its_surface(sigma):
    reach = max(FACE_REACH, 3.0 * sigma)
    edges = [
        face_edge(np.concatenate([surface(seed, sigma), face(seed, sigma)], axis=1), (0.003, 0.0), sigma, reach)
        for seed in range(12)
    ]
    middles = np.array([edge.at(0.5) for edge in edges])
    noise = np.sqrt(np.mean([edge.noise_m**2 for edge in edges]))
    # What the survey states about a face beyond its scatter.
    assert abs(middles.mean()) <= 3.0 * noise / np.sqrt(12) + 0.05 * sigma
    assert np.sum(middles**2) / noise**2 < 33.0


def test_the_points_of_a_dense_surface_do_not_draw_a_thin_face_inwards():
    # Of the points in the band of the face two in five are the surface's, all of them on one side of the edge.
    points = [
        np.concatenate([surface(seed, 0.005, n_m2=400_000), face(seed, 0.005, n_m2=10_000)], axis=1)
        for seed in range(12)
    ]
    edges = [face_edge(each, sigma=0.005, reach=0.015) for each in points]
    middles = np.array([edge.at(0.5) for edge in edges])
    noise = np.sqrt(np.mean([edge.noise_m**2 for edge in edges]))
    assert abs(middles.mean()) <= 3.0 * noise / np.sqrt(12) + 0.05 * 0.005


@pytest.mark.parametrize("recess", [-0.009, 0.009])
def test_of_two_faces_the_one_with_more_points_is_taken(recess):
    # A slab's front of 30 mm, and a part of it that stands back or proud.
    points = [surface(9, 0.0005), face(9, 0.0005), face(10, 0.0005, at=recess, n_m2=N_M2 // 4)]
    edge = face_edge(np.concatenate(points, axis=1), sigma=0.0005)
    assert edge.at(0.5) == pytest.approx(0.0, abs=3.0 * edge.noise_m + 0.0001)


def test_a_riser_behind_the_nosing_is_out_of_reach():
    recessed = face(11, 0.001, at=-0.03, heights=(-0.17, -0.03))
    alone = face_edge(np.concatenate([surface(11, 0.001), face(11, 0.001)], axis=1), sigma=0.001)
    both = face_edge(np.concatenate([surface(11, 0.001), face(11, 0.001), recessed], axis=1), sigma=0.001)
    assert_same_line(both, alone, 0.0)


def test_noise_of_the_surface_alone_is_no_face():
    # Its points are carried to both sides of the plane alike: what is looked for is looked for on one.
    found = [face_edge(surface(seed, 0.005), sigma=0.005, reach=0.015) for seed in range(12)]
    assert [edge for edge in found if edge is not None and edge.support >= 0.55] == []


@pytest.mark.parametrize("n", [0, 11])
def test_a_few_points_are_no_face(n):
    upright = face(12, heights=(-0.03, -0.005))[:, :n]
    assert face_edge(np.concatenate([surface(12), upright], axis=1)) is None


def test_purity_is_the_share_of_the_points_that_lie_on_the_face():
    rng = np.random.default_rng(13)
    upright = face(13, heights=(-0.032, -0.003))
    n = upright.shape[1] // 2
    scattered = np.stack([rng.uniform(-0.055, 0.055, n), rng.uniform(0.0, 1.0, n), rng.uniform(-0.032, -0.003, n)])
    edge = face_edge(np.concatenate([upright, scattered], axis=1), reach=0.055)
    # Two in three are the face's; of the others those within the 4 mm of the window count as well.
    assert edge.purity == pytest.approx((2.0 + 0.004 / 0.055) / 3.0, abs=0.02)
    assert edge.at(0.5) == pytest.approx(0.0, abs=3.0 * edge.noise_m)


@pytest.mark.parametrize(("slope", "guess"), [(0.02, 0.0), (0.3, 0.3), (0.31, 0.3), (-0.02, 0.0)])
def test_a_face_that_slants_has_its_slope(slope, guess):
    edge = face_edge(face(14, 0.0005, at=0.002, slope=slope), (0.0, guess), sigma=0.0005)
    assert edge.slope == pytest.approx(slope, abs=3.0 * edge.slope_noise + 1e-4)
    assert edge.at(0.5) == pytest.approx(0.002, abs=3.0 * edge.noise_m + 1e-4)
    assert face_edge(face(14, 0.0005), is_square=True).slope == 0.0


# both


def found_by(kind, points, guess, span):
    if kind == "extent":
        return extent(points, guess, 0.001, span=span)
    return face_edge(points, (guess, 0.0), 0.001, span=span)


@pytest.mark.parametrize("kind", ["extent", "face"])
def test_an_edge_moves_with_its_points(kind):
    points = np.concatenate([surface(15, 0.001), face(15, 0.001, at=0.001)], axis=1)
    points = points[:, np.abs(points[2]) < 0.04] if kind == "face" else points[:, np.abs(points[2]) < 0.004]
    edge = found_by(kind, points, 0.002, SPAN)
    moved = found_by(kind, points + np.array([[0.7], [-3.1], [0.0]]), 0.702, (SPAN[0] - 3.1, SPAN[1] - 3.1))
    back = dataclasses.replace(moved, middle_m=moved.middle_m - 0.7, along_m=moved.along_m + 3.1)
    # A point on the border of two bins may change sides by rounding, and then weighs as one of some thousand.
    assert_same_line(back, edge, 2e-5)


@pytest.mark.parametrize("kind", ["extent", "face"])
def test_an_edge_seen_from_its_other_end_has_the_opposite_slope(kind):
    points = np.concatenate([surface(16, 0.001), face(16, 0.001, slope=0.004)], axis=1)
    points = points[:, np.abs(points[2]) < (0.04 if kind == "face" else 0.004)]
    edge = found_by(kind, points, 0.0, SPAN)
    mirrored = found_by(kind, points * np.array([[1.0], [-1.0], [1.0]]), 0.0, (-SPAN[1], -SPAN[0]))
    back = dataclasses.replace(mirrored, slope=-mirrored.slope, along_m=-mirrored.along_m)
    assert_same_line(back, edge, 2e-5)


@pytest.mark.parametrize("kind", ["extent", "face"])
def test_an_edge_does_not_depend_on_the_order_of_its_points(kind):
    points = np.concatenate([surface(17, 0.001), face(17, 0.001)], axis=1)
    order = np.random.default_rng(17).permutation(points.shape[1])
    assert_same_line(found_by(kind, points[:, order], 0.0, SPAN), found_by(kind, points, 0.0, SPAN))


def test_an_edge_counted_the_other_way_is_the_same_line():
    edge = EdgeLine(0.2, 0.01, 0.5, 0.001, 0.002, 1.0, "tread")
    assert edge.flipped().at(0.9) == -edge.at(0.9)
    assert edge.flipped().flipped() == edge
    assert edge.noise_at(0.5) == 0.001
    assert edge.noise_at(1.5) == pytest.approx(np.hypot(0.001, 0.002))


# --- what was seen of an edge --------------------------------------------------------------------------------------


def test_a_stretch_that_was_left_out_is_neither_seen_nor_missed():
    whole = Sampling(0.001, 0.005)
    assert whole.seen_share(5, 10, (2.0, 3.0)) == 0.5
    # The pieces from 2.2 to 2.5 m, three of ten.
    left = Sampling(0.001, 0.005, left_out=(2.15, 2.55))
    assert left.seen_share(7, 10, (2.0, 3.0)) == 1.0
    assert left.seen_share(5, 10, (2.0, 3.0)) == pytest.approx(5.0 / 7.0)
    # More may be seen than is counted, where a stretch begins within a piece; and all may be left out.
    assert left.seen_share(9, 10, (2.0, 3.0)) == 1.0
    assert Sampling(0.001, 0.005, left_out=(0.0, 9.0)).seen_share(0, 10, (2.0, 3.0)) == 0.0


def test_what_an_obstacle_adds_to_the_noise_can_be_taken_off():
    blocked = EdgeLine(0.0, 0.0, 0.0, 0.005, 0.0, 1.0, "tread", obstructed_m=0.003)
    assert blocked.free_noise_m == pytest.approx(0.004)
    assert dataclasses.replace(blocked, obstructed_m=0.0051).free_noise_m == 0.0
