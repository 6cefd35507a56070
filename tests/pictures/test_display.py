"""Which points are drawn, and how large."""

import numpy as np
import pytest

from stair_inspector.model import Scan
from stair_inspector.pictures.display import choose_display, display_of, estimate_spacing
from tests.synthetic import Stair


def with_colors(scan, colors):
    return Scan(scan.points, scan.origin_m, scan.name, scan.sha256, "m", scan.n_points, colors=colors)


def test_a_small_scan_is_drawn_whole():
    scan = Stair().scan()
    display = choose_display(scan)
    np.testing.assert_array_equal(display.point_ids, np.arange(len(scan.points)))
    np.testing.assert_array_equal(display.points, scan.points)


def test_a_large_scan_is_thinned_to_the_very_number_evenly_and_the_same_each_time():
    scan = Stair(spacing=0.01).scan()
    most = len(scan.points) // 4
    display = choose_display(scan, most)
    assert len(display.point_ids) == len(display.points) == len(display.colors) == most
    assert (np.diff(display.point_ids) > 0).all()
    np.testing.assert_array_equal(display.points, scan.points[display.point_ids])
    np.testing.assert_array_equal(display.point_ids, choose_display(scan, most).point_ids)
    # The share of any half of the scan is a quarter of it, to five standard deviations.
    lower = (display.point_ids < len(scan.points) // 2).sum()
    assert abs(lower - most / 2.0) < 5.0 * np.sqrt(most) / 2.0


@pytest.mark.parametrize("spacing", [0.003, 0.005, 0.01])
def test_the_spacing_is_that_of_the_points_within_a_quarter(spacing):
    # A cell at the border of a surface is counted whole, hence the tolerance on surfaces of 0.3 m.
    points, _ = Stair(spacing=spacing, risers=True, jitter=True).sample()
    assert estimate_spacing(points) == pytest.approx(spacing, rel=0.25)


def test_the_spacing_of_points_farther_apart_than_a_cell_is_at_most_the_cell():
    points, _ = Stair(spacing=0.05).sample()
    assert estimate_spacing(points) == pytest.approx(0.02, rel=0.01)


def test_the_scans_own_colours_are_drawn_unless_they_are_all_one():
    scan = Stair().scan()
    n = len(scan.points)
    own = np.random.default_rng(1).integers(0, 256, (n, 3)).astype(np.uint8)
    np.testing.assert_array_equal(choose_display(with_colors(scan, own)).colors, own)
    black = choose_display(with_colors(scan, np.zeros((n, 3), np.uint8))).colors
    np.testing.assert_array_equal(black, choose_display(scan).colors)
    assert black.min() > 100


def test_some_points_of_a_scan_are_drawn_as_the_whole_is():
    scan = Stair().scan()
    ids = np.arange(10, 200, 3)
    display = display_of(scan, ids)
    np.testing.assert_array_equal(display.point_ids, ids)
    np.testing.assert_array_equal(display.points, scan.points[ids])
    np.testing.assert_array_equal(display.colors, choose_display(scan).colors[ids])
    nothing = display_of(scan, ids[:0])
    assert (nothing.points.shape, nothing.colors.shape, nothing.spacing_m) == ((0, 3), (0, 3), 0.0)
