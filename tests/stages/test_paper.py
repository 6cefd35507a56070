"""The equations of step 9, each against numbers worked out by hand on two steps and one above them."""

import numpy as np
import pytest

from stair_inspector.geometry.fits import PlaneFit
from stair_inspector.model import Axes, Edges, NearestPoints, Surfaces, Up
from stair_inspector.stages.paper import measure_h, measure_steps, measure_theta, place_corners, review_steps
from tests.synthetic import make_scan

UP = Up(np.array([0.0, 0.0, 1.0]), "given")
AXES = Axes(width=np.array([0.0, 1.0, 0.0]), depth=np.array([-1.0, 0.0, 0.0]), rule="per_step")


def plane(centroid, normal=(0.0, 0.0, 1.0), rms_m=0.001, n_points=100):
    normal = None if normal is None else np.array(normal, dtype=float)
    return PlaneFit(np.array(centroid, dtype=float), normal, None if normal is None else rms_m, n_points)


FLOOR = plane((-1.0, 0.5, 0.0))
FIRST = plane((0.0, 0.5, 0.3))
SECOND = plane((0.4, 0.5, 0.6))
"""From the first 0.4 m on and 0.3 m up: 0.5 m of distance."""
THIRD = plane((0.8, 0.5, 0.95))
EDGES = Edges(front=(0.125, -0.25, -0.625), back=(-0.125, -0.5, -1.0), high_w=(1.0, 0.9, 1.0), low_w=(0.25, 0.1, 0.0))


def measured(planes=(FLOOR, FIRST, SECOND, THIRD), edges=EDGES, origin_m=(0.0, 0.0, 0.0)):
    surfaces = Surfaces(tuple(planes), tuple(np.eye(2) for _ in planes))
    nearest = NearestPoints(tuple(np.zeros(0, dtype=np.int64) for _ in planes[1:]))
    return measure_steps(make_scan(np.zeros((1, 3)), origin_m=origin_m), UP, surfaces, AXES, edges, nearest)


def test_eq9_h_is_the_rise_of_the_centroids_along_up():
    assert [step.paper.h_m for step in measured()] == [pytest.approx(0.3), pytest.approx(0.35), None]


def test_eq9_h_along_a_tilted_up():
    tilted = Up(np.array([0.0, 0.6, 0.8]), "given")
    # (0.1, 0.2, 0.3) . (0, 0.6, 0.8) = 0.12 + 0.24
    assert measure_h(plane((0, 0, 0)), plane((0.1, 0.2, 0.3)), tilted) == pytest.approx(0.36)


def test_eq9_d_fb_is_front_minus_back_of_the_same_step():
    assert [step.paper.d_fb_m for step in measured()] == [0.25, 0.25, 0.375]


def test_eq9_d_ff_is_the_distance_of_a_front_to_the_next():
    assert [step.paper.d_ff_m for step in measured()] == [0.375, 0.375, None]


def test_eq9_d_ff_has_no_sign():
    backwards = Edges((-0.25, 0.125, 1.0), (-0.5, -0.125, 0.0), (1, 1, 1), (0, 0, 0))
    assert [step.paper.d_ff_m for step in measured(edges=backwards)] == [0.375, 0.875, None]


def test_eq9_w_is_the_distance_of_the_side_percentiles():
    assert [step.paper.w_m for step in measured()] == [0.75, pytest.approx(0.8), 1.0]


def test_eq9_theta_is_the_angle_of_the_line_of_centroids_to_the_tread():
    # arcsin(0.3 / 0.5) and arcsin(0.35 / sqrt(0.4**2 + 0.35**2)) = arctan(0.875).
    assert [step.paper.theta_deg for step in measured()] == [
        pytest.approx(36.86989764584402, abs=1e-12),
        pytest.approx(41.185925165709648, abs=1e-12),
        None,
    ]


def test_eq9_theta_is_measured_to_the_tilted_plane_and_has_no_sign():
    # n = (-0.6, 0, 0.8), c = (0.5, 0, 0): |n . c| / |c| = 0.6; and the same with the normal turned over.
    for normal in ((-0.6, 0.0, 0.8), (0.6, 0.0, -0.8)):
        theta = measure_theta(plane((0, 0, 0), normal), plane((0.5, 0, 0)))
        assert theta == pytest.approx(36.86989764584402, abs=1e-12)


def test_eq9_theta_of_a_vertical_line_is_90_and_not_an_error_of_rounding():
    third = 1.0 / np.sqrt(3.0)
    normal = np.array([third, third, third])
    assert measure_theta(plane((0, 0, 0), normal), plane(normal * 0.3)) == pytest.approx(90.0, abs=1e-5)


def test_eq9_theta_is_null_without_a_normal_or_a_distance():
    assert measure_theta(plane((0, 0, 0), None), SECOND) is None
    assert measure_theta(FIRST, FIRST) is None


def test_eq9_f_and_b_are_coordinates_along_depth_in_the_scan_frame():
    near, far = measured(), measured(origin_m=(4096.0, 77.0, 5.0))
    assert [step.paper.f_m for step in near] == list(EDGES.front)
    assert [step.paper.b_m for step in near] == list(EDGES.back)
    # d = -x: an origin of 4096 m moves them by -4096 m, exactly.
    assert [step.paper.f_m + 4096.0 for step in far] == list(EDGES.front)
    assert [step.paper.d_fb_m for step in far] == [step.paper.d_fb_m for step in near]


def test_step_ids_count_from_one_upwards():
    assert [step.step_id for step in measured()] == [1, 2, 3]


def test_survey_fields_are_null_in_this_version():
    names = ["rise_m", "going_m", "tread_depth_m", "width_m", "nosing_overhang_m"]
    names += ["pitch_deg", "fall_deg", "cross_fall_deg", "coverage"]
    assert all(getattr(step, name) is None for step in measured() for name in names)


def test_corners_lie_in_the_plane_in_the_promised_order():
    # z = 0.3 - 0.75 (x - 0), front left is high w at the front, where x = -d.
    tilted = plane((0.0, 0.5, 0.3), (0.6, 0.0, 0.8))
    corners = place_corners(tilted, UP, AXES, EDGES, 0)
    expected = [
        [-0.125, 1.0, 0.3 + 0.09375],
        [-0.125, 0.25, 0.3 + 0.09375],
        [0.125, 0.25, 0.3 - 0.09375],
        [0.125, 1.0, 0.3 - 0.09375],
    ]
    np.testing.assert_allclose(corners, expected, atol=1e-15)
    np.testing.assert_allclose((corners - tilted.centroid) @ tilted.normal, 0.0, atol=1e-15)


@pytest.mark.parametrize("normal", [None, (1.0, 0.0, 0.0)], ids=["no_plane", "upright"])
def test_corners_of_a_step_without_a_usable_plane_stay_at_its_height(normal):
    np.testing.assert_allclose(place_corners(plane((0, 0.5, 0.3), normal), UP, AXES, EDGES, 0)[:, 2], 0.3)


def test_eq6_fronts_that_do_not_progress_are_noted_with_the_step():
    edges = Edges((0.125, 0.135, -0.625), (-0.1, -0.5, -1.0), (1, 1, 1), (0, 0, 0))
    (note,) = review_steps(measured(edges=edges))
    assert (note.code, note.step) == ("front_not_monotonic", 2)
    assert note.message == (
        "the front edge of step 2 lies 10 mm in front of that of step 1: the fronts do not progress with the climb"
    )


def test_eq6_fronts_straight_above_each_other_do_not_progress():
    edges = Edges((0.125, 0.125, -0.625), (-0.1, -0.5, -1.0), (1, 1, 1), (0, 0, 0))
    assert [(note.code, note.step) for note in review_steps(measured(edges=edges))] == [("front_not_monotonic", 2)]


def test_fronts_that_progress_are_not_noted():
    assert review_steps(measured()) == ()


def test_a_step_on_a_line_is_noted_and_has_no_slope():
    steps = measured((FLOOR, plane((0.0, 0.5, 0.3), None, n_points=60), SECOND, THIRD))
    assert steps[0].paper.theta_deg is None
    assert steps[0].paper.h_m == pytest.approx(0.3)
    (note,) = review_steps(steps)
    assert (note.code, note.step) == ("no_plane", 1)
    assert note.message == "the 60 points of step 1 lie on one line: no plane, no slope"
