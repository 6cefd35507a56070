"""Points become pixels: each at its place, as large as it should be, the nearest in front, whatever their order."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stair_inspector.pictures.splat import Dots, draw_dots

RED, GREEN, BLUE = (200, 0, 0), (0, 200, 0), (0, 0, 200)


def dots(*rows):
    """Each row: x, y, depth, colour, radius."""
    return Dots(
        np.array([row[:2] for row in rows], dtype=float).reshape(-1, 2),
        np.array([row[2] for row in rows], dtype=float),
        np.array([row[3] for row in rows], dtype=np.uint8).reshape(-1, 3),
        np.array([row[4] for row in rows], dtype=float),
    )


def is_color(picture, color):
    return (picture == np.array(color)).all(axis=2)


def test_a_dot_lies_where_it_was_put_and_has_its_size():
    picture = draw_dots(dots((20.0, 10.0, 1.0, RED, 4.0)), 60, 40)
    assert picture.shape == (40, 60, 3)
    rows, columns = np.nonzero((picture != 255).any(axis=2))
    assert (rows.mean() + 0.5, columns.mean() + 0.5) == (pytest.approx(10.0, abs=0.51), pytest.approx(20.0, abs=0.51))
    assert np.ptp(rows) == pytest.approx(8.0, abs=1.0)
    assert is_color(picture, RED).sum() == pytest.approx(np.pi * 16.0, rel=0.2)
    assert (picture[0, 0] == 255).all()


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 1, 0), (1, 0, 2), (2, 0, 1)])
def test_the_nearest_is_in_front_whatever_the_order(order):
    rows = [(10.0, 10.0, 3.0, RED, 6.0), (10.0, 10.0, 2.0, GREEN, 4.0), (10.0, 10.0, 1.0, BLUE, 1.5)]
    picture = draw_dots(dots(*(rows[k] for k in order)), 20, 20)
    assert tuple(picture[10, 10]) == BLUE
    assert tuple(picture[10, 13]) == GREEN
    assert tuple(picture[10, 15]) == RED


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 60))
def test_every_pixel_has_the_colour_of_the_nearest_disc_over_it(seed, n):
    rng = np.random.default_rng(seed)
    places, depths, radii = rng.uniform(-5.0, 25.0, (n, 2)), rng.permutation(n) + 1.0, rng.uniform(0.3, 6.0, n)
    # Whole pixels of the drawing, so that the oracle below meets the same discs.
    colors = rng.integers(0, 255, (n, 3), dtype=np.uint8)
    picture = draw_dots(Dots(places, depths, colors, radii), 20, 16)
    expected = np.full((32, 40, 3), 255.0)
    nearest = np.full((32, 40), np.inf)
    for place, depth, color, radius in zip(places, depths, colors, radii, strict=True):
        column, row = np.floor(place * 2.0)
        y, x = np.mgrid[0:32, 0:40]
        is_covered = (x - column) ** 2 + (y - row) ** 2 <= max(2.0 * radius, 0.5) ** 2
        is_covered &= depth < nearest
        expected[is_covered], nearest[is_covered] = color, depth
    expected = np.rint(expected.reshape(16, 2, 20, 2, 3).mean(axis=(1, 3)))
    assert np.abs(picture - expected).max() <= 1.0


def test_what_is_no_number_or_outside_is_left_out():
    nowhere = dots(
        (np.nan, 5.0, 1.0, RED, 2.0),
        (5.0, np.inf, 1.0, RED, 2.0),
        (5.0, 5.0, np.nan, RED, 2.0),
        (500.0, 5.0, 1.0, RED, 2.0),
        (5.0, -90.0, 1.0, RED, 2.0),
    )
    assert (draw_dots(nowhere, 10, 10) == 255).all()
    assert (draw_dots(dots(), 10, 10) == 255).all()


def test_shading_darkens_the_far_side_of_an_edge_and_nothing_else():
    x, y = np.meshgrid(np.arange(0.0, 40.0, 0.5), np.arange(0.0, 20.0, 0.5))
    depth = np.where(x < 20.0, 1.0, 2.0).ravel()
    gray = np.full((x.size, 3), 180, dtype=np.uint8)
    surface = Dots(np.column_stack([x.ravel(), y.ravel()]), depth, gray, np.full(x.size, 0.8))
    flat = draw_dots(surface, 40, 20)
    shaded = draw_dots(surface, 40, 20, shade_m=0.1)
    assert (flat == 180).all()
    assert shaded[10, 20, 0] < 0.9 * 180.0
    assert (shaded[:, :18] == 180).all()
    assert (shaded[:, 26:] == 180).all()


def test_the_same_dots_give_the_same_pixels():
    rng = np.random.default_rng(4)
    many = Dots(
        rng.uniform(0.0, 100.0, (5000, 2)),
        rng.uniform(1.0, 5.0, 5000),
        rng.integers(0, 255, (5000, 3), dtype=np.uint8),
        rng.uniform(0.5, 3.0, 5000),
    )
    first, again = (draw_dots(many, 100, 100, shade_m=0.2) for _ in range(2))
    np.testing.assert_array_equal(first, again)
