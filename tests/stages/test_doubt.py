"""How uncertainties are put together, and that a doubt grows with what causes it."""

import math

import numpy as np
import pytest

from stair_inspector.geometry.edges import EdgeLine
from stair_inspector.model import LocalPlane
from stair_inspector.stages.doubt import K, edge_doubt, expanded, slope_doubt, surface_doubt


def plane(sigma_m=0.001, spacing_m=0.005):
    return LocalPlane(0.0, (0.0, 0.0), np.zeros((3, 3)), sigma_m, spacing_m, 0.0, 1000)


def edge(source):
    return EdgeLine(0.0, 0.0, 0.0, 0.0, 0.0, 1.0, source)


def test_u_is_twice_the_root_of_the_sum_of_squares():
    measured = expanded(0.17, noise=0.003, edge=0.004)
    assert K == 2.0
    assert measured.value == 0.17
    assert measured.u == pytest.approx(0.01, rel=1e-15)
    assert measured.parts == (("noise", 0.006), ("edge", 0.008))


def test_parts_without_weight_are_left_out():
    assert expanded(1.0, noise=0.0, up=0.5).parts == (("up", 1.0),)
    assert expanded(1.0).u == 0.0
    assert expanded(1.0, noise=0.0).parts == ()


@pytest.mark.parametrize("source", ["face", "tread"])
def test_the_doubt_of_an_edge_grows_with_noise_and_spacing_and_never_vanishes(source):
    doubts = [edge_doubt(edge(source), plane(sigma, 0.005)) for sigma in (0.0, 0.001, 0.003, 0.01)]
    assert doubts[0] > 0.0
    assert doubts == sorted(set(doubts))
    doubts = [edge_doubt(edge(source), plane(0.001, spacing)) for spacing in (0.0, 0.003, 0.01, 0.02)]
    assert doubts == sorted(set(doubts))
    assert edge_doubt(edge(source), plane(0.0, 0.0)) < 0.0002


@pytest.mark.parametrize(("sigma_m", "spacing_m"), [(0.0005, 0.003), (0.003, 0.005), (0.01, 0.008), (0.015, 0.02)])
def test_an_edge_that_only_a_tread_shows_is_doubted_more_than_one_that_a_face_shows(sigma_m, spacing_m):
    here = plane(sigma_m, spacing_m)
    assert edge_doubt(edge("tread"), here) > edge_doubt(edge("face"), here)


def test_a_surface_is_surer_than_its_points_by_far():
    assert 0.0 < surface_doubt(plane(0.01)) < 0.001
    assert surface_doubt(plane(0.0)) == 0.0


def test_the_doubt_of_a_slope_is_a_height_over_a_length():
    here = plane(0.001)
    assert slope_doubt(here, 0.3) == pytest.approx(2.0 * slope_doubt(here, 0.6), rel=1e-12)
    assert slope_doubt(here, 0.3) > slope_doubt(plane(0.0005), 0.3)
    # A length below the spacing has no slope, and none divides by zero.
    assert slope_doubt(here, 0.0) == slope_doubt(here, 0.005)


def test_the_doubt_of_a_slope_grows_less_than_a_large_noise():
    small, large = slope_doubt(plane(0.001), 0.28), slope_doubt(plane(0.01), 0.28)
    assert small < large < 10.0 * small
    assert math.degrees(large) < 2.0
