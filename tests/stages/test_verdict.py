"""Whether levels can be a staircase, at the limits of what counts as one."""

import math

import numpy as np
import pytest

from stair_inspector.geometry.fits import PlaneFit
from stair_inspector.model import Level, Surfaces, Up
from stair_inspector.stages.verdict import why_no_staircase

UP = Up(np.array([0.0, 0.0, 1.0]), "given")


def surfaces_of(*centres, lean_deg=0.0):
    normal = np.array([math.sin(math.radians(lean_deg)), 0.0, math.cos(math.radians(lean_deg))])
    planes = tuple(PlaneFit(np.array([x, 0.0, z]), normal, 0.001, 100) for x, z in centres)
    return Surfaces(planes, tuple(np.eye(2) for _ in planes))


def reason(*centres, lean_deg=0.0, thick=0.01):
    levels = tuple(Level(k, z, z - thick / 2, z + thick / 2, 100, "tread") for k, (_, z) in enumerate(centres))
    return why_no_staircase(surfaces_of(*centres, lean_deg=lean_deg), levels, UP)


def test_a_floor_and_two_steps_are_a_staircase():
    assert reason((0, 0), (0.7, 0.17), (0.98, 0.34)) is None


@pytest.mark.parametrize(
    ("count", "text"), [(0, "0 horizontal levels"), (1, "1 horizontal level,"), (2, "2 horizontal")]
)
def test_fewer_than_three_levels_are_none(count, text):
    assert reason(*[(0.28 * k, 0.17 * k) for k in range(count)]).startswith(text)


@pytest.mark.parametrize(
    ("rise", "going", "is_stair"),
    [
        (0.061, 0.28, True),
        (0.059, 0.28, False),
        (0.349, 0.28, True),
        (0.351, 0.28, False),
        (0.17, 0.151, True),
        (0.17, 0.149, False),
        (0.17, 0.899, True),
        (0.17, 0.901, False),
    ],
)
def test_limits_of_rise_and_going(rise, going, is_stair):
    assert (reason(*[(going * k, rise * k) for k in range(5)]) is None) == is_stair


@pytest.mark.parametrize(("lean_deg", "is_stair"), [(7.9, True), (8.1, False)])
def test_bands_of_a_ramp_lean(lean_deg, is_stair):
    assert (reason((0, 0), (0.28, 0.17), (0.56, 0.34), lean_deg=lean_deg) is None) == is_stair


def test_a_table_on_a_floor_under_a_ceiling_is_no_staircase():
    assert reason((0, 0), (1.5, 0.74), (1.0, 2.4)).startswith(
        "3 horizontal levels, but nowhere two similar rises in a row"
    )


def test_clutter_between_the_levels_does_not_hide_the_two_risers_that_follow_each_other():
    assert reason((0, 0), (3, 0.05), (1, 0.22), (1.28, 0.39), (5, 0.41), (2, 2.6)) is None


@pytest.mark.parametrize(("second", "is_stair"), [(0.17 * 1.69, True), (0.17 * 1.71, False)])
def test_rises_that_differ_too_much_are_shelves(second, is_stair):
    assert (reason((0, 0), (0.28, 0.17), (0.56, 0.17 + second)) is None) == is_stair


def test_levels_that_have_run_together_are_told_from_levels_that_are_missing():
    assert "one spans 900 mm, so several have run together: lower eps_z or raise m" in reason((0, 0.6), thick=0.9)
    assert "try a larger theta_th or a smaller m" in reason((0, 0.6), thick=0.05)


def test_the_reason_tells_rise_and_distance_in_millimetres():
    assert "(rise/distance in mm: 400/280, 400/280)" in reason((0, 0), (0.28, 0.4), (0.56, 0.8))
