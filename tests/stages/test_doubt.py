"""How uncertainties are put together, and that a doubt grows with what causes it."""

import math
from dataclasses import replace

import numpy as np
import pytest

from stair_inspector.geometry.edges import EdgeLine
from stair_inspector.model import COVERAGE_FACTOR, LocalPlane
from stair_inspector.stages.doubt import (
    edge_doubt,
    expanded,
    layers_doubt,
    noise_before_rounding,
    rounding_doubt,
    slope_doubt,
    surface_doubt,
    thinning_doubt,
    view_doubt,
)


def plane(sigma_m=0.001, spacing_m=0.005):
    return LocalPlane(0.0, (0.0, 0.0), np.zeros((3, 3)), sigma_m, spacing_m, 0.0, 1000)


def edge(source):
    return EdgeLine(0.0, 0.0, 0.0, 0.0, 0.0, 1.0, source)


def test_u_is_twice_the_root_of_the_sum_of_squares():
    measured = expanded(0.17, noise=0.003, edge=0.004)
    assert COVERAGE_FACTOR == 2.0
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


def test_an_edge_whose_last_points_were_counted_is_surer_the_sparser_they_lie():
    here = plane(0.001, 0.02)
    counted = replace(edge("tread"), is_counted=True)
    assert edge_doubt(edge("face"), here) < edge_doubt(counted, here) < 0.3 * edge_doubt(edge("tread"), here)


def test_a_joint_beside_a_wall_may_hide_half_a_millimetre():
    wall = edge_doubt(replace(edge("face"), is_wall=True), plane())
    assert wall == pytest.approx(math.hypot(0.0005, edge_doubt(edge("face"), plane())))


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


# --- rounding and layers -------------------------------------------------------------------------------------------

UPRIGHT, NO_REACH = np.array([0.0, 0.0, 1.0]), (np.zeros(3),)
STEPS = np.array([0.002, 0.003, 0.004])


def test_without_noise_rounding_is_an_even_error_over_one_step():
    assert rounding_doubt(UPRIGHT, NO_REACH, 0.0, STEPS) == pytest.approx(0.004 / math.sqrt(12.0), rel=0.01)
    slanting = np.array([0.6, 0.8, 0.0])
    expected = math.hypot(0.6 * 0.002, 0.8 * 0.003) / math.sqrt(12.0)
    assert rounding_doubt(slanting, NO_REACH, 0.0, STEPS) == pytest.approx(expected, rel=0.01)
    assert rounding_doubt(UPRIGHT, NO_REACH, 0.0, np.array([0.002, 0.003, 0.0])) == 0.0


@pytest.mark.parametrize("share", [0.1, 0.2, 0.3, 0.5])
def test_noise_averages_rounding_out_as_a_mean_of_rounded_values_shows(share):
    rng = np.random.default_rng(5)
    step_m, phases = 0.004, np.linspace(0.0, 0.004, 40, endpoint=False)
    noisy = phases[:, None] + share * step_m * rng.standard_normal((40, 20_000))
    errors = (np.rint(noisy / step_m) * step_m).mean(axis=1) - phases
    expected = math.sqrt(float(np.mean(errors**2)))
    # 20,000 values leave their own noise in each mean.
    left = step_m * math.hypot(share, 0.3) / math.sqrt(20_000)
    found = rounding_doubt(UPRIGHT, NO_REACH, share * step_m, np.array([0.0, 0.0, step_m]))
    assert found == pytest.approx(expected, abs=2.0 * left)


def test_a_surface_that_slants_through_many_steps_keeps_a_tenth():
    doubts = [rounding_doubt(UPRIGHT, (np.array([1.0, 0.0, drop]),), 0.0, STEPS) for drop in (0.0, 0.004, 0.02, 1.0)]
    assert doubts == sorted(doubts, reverse=True)
    assert doubts[-1] == pytest.approx(0.1 * doubts[0], rel=0.01)


@pytest.mark.parametrize("turn_deg", [0.0, 45.0, 37.0])
def test_of_a_lattice_with_one_point_a_cell_a_face_is_off_as_thinning_says(turn_deg):
    rng = np.random.default_rng(8)
    step_m, width_m = 0.02, 1.0
    angle = math.radians(turn_deg)
    normal, along = (
        np.array([math.cos(angle), math.sin(angle), 0.0]),
        np.array([-math.sin(angle), math.cos(angle), 0.0]),
    )
    errors = []
    for place_m in np.linspace(0.0, step_m, 40, endpoint=False):
        w, z = rng.uniform(0.0, [[width_m], [0.17]], (2, 10_000))
        face = (place_m + 0.001 * rng.standard_normal(10_000))[:, None] * normal + w[:, None] * along
        face[:, 2] = z
        cells = np.unique(np.rint(face / step_m), axis=0) * step_m
        errors.append((cells @ normal).mean() - place_m)
    steps_m = np.full(3, step_m)
    found = max(
        thinning_doubt(normal, width_m * along, steps_m), rounding_doubt(normal, (width_m * along,), 0.0, steps_m)
    )
    off_m = math.sqrt(float(np.mean(np.square(errors))))
    assert off_m <= 1.2 * found
    # Not so large that it says nothing, where the face lies along the lattice or its diagonal.
    assert turn_deg == 37.0 or found <= 2.0 * off_m


def test_rounding_and_spreading_add_the_variance_of_two_even_distributions():
    rng = np.random.default_rng(6)
    true = 0.003 * rng.standard_normal(100_000)
    spread = np.rint(true / 0.004) * 0.004 + rng.uniform(-0.002, 0.002, true.shape)
    found = noise_before_rounding(float(spread.std()), UPRIGHT, np.array([0.0, 0.0, 0.004]))
    assert found == pytest.approx(0.003, rel=0.01)
    assert noise_before_rounding(0.001, UPRIGHT, STEPS) == 0.0


def test_a_level_lies_anywhere_between_its_layers():
    assert layers_doubt(0.012) == pytest.approx(0.012 / math.sqrt(12.0))
    assert layers_doubt(0.0) == 0.0


def ray(grazing):
    """Unit vector of a camera that looks along the climb, down at this sine."""
    return np.array([math.sqrt(1.0 - grazing**2), 0.0, -grazing])


ALONG, ACROSS = np.array([1.0, 0.0]), np.array([0.0, 1.0])


def test_an_edge_that_a_camera_sees_at_a_grazing_angle_holds_the_noise_along_the_ray():
    noisy = LocalPlane(0.0, (0.0, 0.0), np.zeros((3, 3)), 0.002, 0.0, 0.003, 1000)
    # 3 mm in height are 3 / 0.2 mm along the ray; an edge of 0.72 m has nine patches of 80 mm.
    expected = 0.003 / 0.2 * math.sqrt(1.0 - 0.04) / 3.0
    assert view_doubt(edge("face"), noisy, ray(0.2), ALONG, 0.72) == pytest.approx(expected)
    assert view_doubt(edge("face"), noisy, ray(0.2), ACROSS, 0.72) == 0.0
    assert view_doubt(edge("face"), noisy, ray(0.4), ALONG, 0.72) < expected
    # However flat the ray, the doubt stays finite.
    assert view_doubt(edge("face"), noisy, ray(0.0), ALONG, 0.72) == pytest.approx(0.003 / 0.05 / 3.0)


def test_an_end_that_a_camera_sees_in_rows_may_lie_before_the_last_of_them():
    sparse = plane(spacing_m=0.02)
    rows = 0.02 / math.sqrt(0.16)
    found = view_doubt(edge("tread"), sparse, ray(0.16), ALONG, 1.0)
    assert found == pytest.approx(0.25 * rows * math.sqrt(1.0 - 0.16**2))
    assert view_doubt(edge("face"), sparse, ray(0.16), ALONG, 1.0) == 0.0
