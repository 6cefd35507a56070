"""Where surfaces end by their own points: random ones, grids, thinned ones, with holes and shadows.

Each surface ends at ``out`` 0 unless a test says otherwise.
"""

import numpy as np
import pytest

from tests.geometry.test_edges import assert_same_line, doubt, extent, face, grid, surface


@pytest.mark.parametrize("sigma", [0.0, 0.002, 0.005, 0.01])
@pytest.mark.parametrize("guess", [-0.04, 0.0, 0.04])
def test_an_extent_is_unbiased_whatever_the_noise_and_the_first_guess(sigma, guess):
    edges = [extent(surface(seed, sigma), guess, sigma) for seed in range(12)]
    middles = np.array([edge.at(0.5) for edge in edges])
    noise = np.sqrt(np.mean([edge.noise_m**2 for edge in edges]))
    assert abs(middles.mean()) <= 3.0 * noise / np.sqrt(12) + doubt(sigma=sigma)
    # Fewer than one in a thousand of chi-squared with 12 degrees of freedom.
    assert np.sum(middles**2) / noise**2 < 33.0
    assert {edge.support for edge in edges} == {1.0}


def test_an_extent_is_unbiased_in_a_sparse_random_surface():
    edges = [extent(surface(seed, n_m2=10_000), spacing=0.01) for seed in range(40)]
    middles = np.array([edge.at(0.5) for edge in edges])
    assert abs(middles.mean()) <= 3.0 * middles.std() / np.sqrt(40) + 0.25 * doubt(0.01)


def thinned(points, spacing, seed, turn=0.47):
    """One point of each cell of a grid that is turned against the edge, as merging programs leave them."""
    rng = np.random.default_rng(seed)
    points = points[:, rng.permutation(points.shape[1])]
    turned = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]) @ points[:2]
    _, first = np.unique(np.floor(turned / spacing).astype(int), axis=1, return_index=True)
    return points[:, first]


@pytest.mark.parametrize("spacing", [0.007, 0.014])
def test_an_extent_is_not_too_large_where_a_scan_was_thinned_to_a_grid(spacing):
    # Five points to a cell are left before: the cells that the edge cuts are nearly as full as the others.
    dense = [surface(seed, n_m2=round(5.0 / spacing**2)) for seed in range(20)]
    span = (0.35, 0.65)
    edges = [
        extent(thinned(points, spacing, seed), spacing=spacing, span=span, is_square=True)
        for seed, points in enumerate(dense)
    ]
    middles = np.array([edge.middle_m for edge in edges])
    assert abs(middles.mean()) < 0.08 * spacing
    assert np.percentile(np.abs(middles), 90.0) < 0.25 * spacing
    doubts = [np.hypot(edge.noise_m, 0.05 * spacing) for edge in edges]
    assert np.mean(np.abs(middles) <= 2.0 * np.array(doubts)) >= 0.9
    assert all(edge.is_counted for edge in edges)


@pytest.mark.parametrize("spacing", [0.004, 0.01])
@pytest.mark.parametrize("phase", [0.0, 0.3, 0.5, 0.8])
def test_the_edge_of_an_even_grid_is_known_to_half_its_spacing(spacing, phase):
    points = grid(spacing, phase, 0.0)
    # Of a grid that runs along the edge nobody knows where between two rows the surface ends.
    last = points[0].max()
    edge = extent(points, 0.003, spacing=spacing)
    assert abs(edge.at(0.5) - last - spacing / 2.0) <= spacing / 2.0 + 1e-9
    assert edge.slope == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("spacing", [0.004, 0.01])
def test_the_edge_of_a_turned_grid_is_exact(spacing):
    middles = [extent(grid(spacing, phase, 27.0), 0.003, spacing=spacing).at(0.5) for phase in (0.0, 0.3, 0.5, 0.8)]
    assert np.abs(middles).max() <= 2.0 * doubt(spacing)


def rows(phase, apart, seed, drift=0.0):
    """Rows of points along the edge, 24 mm from point to point, the last one a share ``phase`` of ``apart`` before it.

    ``drift`` is how far the rows slant over a metre of the edge, in rows; the points scatter by 0.3 mm.
    """
    out, along = np.meshgrid(-(np.arange(-3, 30) + phase) * apart, np.arange(0.0, 1.0, 0.024))
    out, along = out.ravel() + drift * apart * (along.ravel() - 0.5), along.ravel()
    inside = out <= 0.0
    out = out + np.random.default_rng(seed).normal(0.0, 0.0003, len(out))
    return np.stack([out[inside], along[inside], np.zeros(np.count_nonzero(inside))])


@pytest.mark.parametrize("length", [0.24, 0.97])
def test_rows_of_points_along_an_edge_leave_it_anywhere_up_to_the_next_row(length):
    apart, span = 0.008, (0.0, length)
    edges = [
        extent(rows(phase, apart, seed), sigma=0.0005, spacing=np.sqrt(apart * 0.024), span=span, is_square=True)
        for seed, phase in enumerate(np.arange(0.05, 1.0, 0.1))
    ]
    errors, noises = np.array([(edge.at(length / 2.0), edge.noise_m) for edge in edges]).T
    assert abs(errors.mean()) <= 0.0005
    assert np.all(np.abs(errors) <= 2.0 * noises)
    # An even distribution over the interval, and no more.
    assert np.all(noises <= apart / np.sqrt(12.0))


def test_rows_that_slant_across_an_edge_show_it_better():
    apart = 0.008
    edges = [
        extent(rows(phase, apart, seed, drift=3.0), sigma=0.0005, spacing=np.sqrt(apart * 0.024), is_square=True)
        for seed, phase in enumerate(np.arange(0.05, 1.0, 0.1))
    ]
    assert max(abs(edge.at(0.5)) for edge in edges) <= 0.15 * apart
    assert max(edge.noise_m for edge in edges) <= 0.15 * apart


@pytest.mark.parametrize(("low", "high"), [(-0.05, -0.02), (-0.09, -0.03), (-0.12, -0.1)])
def test_a_hole_or_the_shadow_of_a_rail_near_the_edge_is_not_the_edge(low, high):
    points = surface(2, 0.002)
    rail = points[:, (points[0] < low) | (points[0] > high)]
    edge = extent(rail, 0.01, 0.002)
    assert abs(edge.at(0.5)) <= 3.0 * edge.noise_m + doubt(sigma=0.002)


def test_what_hides_one_piece_of_the_edge_only_makes_it_less_supported():
    points = surface(3, 0.002)
    whole = extent(points, sigma=0.002)
    hidden = extent(points[:, (points[0] < -0.2) | (points[1] < 0.3) | (points[1] > 0.7)], sigma=0.002)
    assert 0.6 < hidden.support < 0.9
    assert abs(hidden.at(0.5) - whole.at(0.5)) <= 2.0 * np.hypot(hidden.noise_m, whole.noise_m)


def test_an_edge_that_slants_has_its_slope():
    points = surface(4, 0.001, stop=0.05)
    cut = points[:, points[0] < 0.03 * (points[1] - 0.5)]
    edge = extent(cut, sigma=0.001)
    assert edge.slope == pytest.approx(0.03, abs=3.0 * edge.slope_noise + doubt())
    assert edge.at(0.5) == pytest.approx(0.0, abs=3.0 * edge.noise_m + doubt())
    assert extent(cut, sigma=0.001, is_square=True).slope == 0.0


def test_a_surface_that_goes_on_has_no_edge():
    assert extent(surface(5, 0.002, stop=0.5)) is None


def test_no_points_have_no_edge():
    assert extent(np.zeros((3, 0))) is None
    # All of them farther inside than an edge is looked for.
    points = surface(6)
    assert extent(points[:, points[0] < -0.2]) is None


@pytest.mark.parametrize(("half", "heights"), [("above", (-0.05, 0.0)), ("below", (0.0, 0.05))])
def test_half_a_surface_ignores_the_face_that_meets_it(half, heights):
    points = surface(7, 0.003)
    upright = face(7, heights=heights)
    upright[0] += np.random.default_rng(7).normal(0.0, 0.003, upright.shape[1])
    together = np.concatenate([points, upright], axis=1)
    alone = extent(points, sigma=0.003, half=half)
    assert_same_line(extent(together, sigma=0.003, half=half), alone, 0.0)
    assert abs(alone.at(0.5)) <= 3.0 * alone.noise_m + doubt(sigma=0.003)
    # All of the points together put the edge outside: there are more of them than belong to the surface.
    assert extent(together, sigma=0.003).at(0.5) > alone.at(0.5) + 0.003


@pytest.mark.parametrize("apart", [0.015, 0.02])
def test_of_two_stations_that_lie_apart_the_edge_is_between_their_edges(apart):
    for seed in range(8):
        here, there = surface(seed, 0.0005, n_m2=10_000), surface(seed + 50, 0.0005, stop=apart, n_m2=10_000)
        edge = extent(
            np.concatenate([here, there], axis=1), sigma=0.0005, spacing=0.007, span=(0.3, 0.6), is_square=True
        )
        assert not edge.is_counted
        assert abs(edge.middle_m - apart / 2.0) <= 2.0 * edge.noise_m
        assert 0.0 < edge.middle_m < apart
