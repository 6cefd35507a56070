"""Tuning never harms: what a region around the stair, or a slider on its plateau, does to what is measured."""

import dataclasses
import functools

import numpy as np
import pytest

from stair_inspector.memo import Memo
from stair_inspector.pipeline import inspect
from stair_inspector.quantities import SURVEY_VALUES
from tests.synthetic import Stair, exact_params

STAIR = Stair(n_steps=5, risers=True, noise=0.0015, floor_depth=1.6, spacing=0.008, seed=5)
SWEPT = {
    "horizontal.theta_deg": (8.0, 11.0, 20.0, 25.0),
    "levels.eps_m": (0.004, 0.006, 0.01, 0.03, 0.04),
    "levels.min_points": (20, 100, 200, 400),
}
"""Each with the others at their defaults."""
COVERED = 0.95
NOTHING = 0.02
"""Share of u: the edge on the floor is looked for where the floor was seen, which moves the rest by less."""


@functools.cache
def scan_with_surroundings():
    """A stair with a floor beside it that is no part of it, at the height of a tread too."""
    scan = STAIR.scan()
    rng = np.random.default_rng(3)
    beside = [
        np.column_stack([rng.uniform(-1.0, 3.0, 60000), rng.uniform(2.0, 3.5, 60000), np.full(60000, z)])
        for z in (0, 0.34)
    ]
    points = np.concatenate([scan.points + scan.origin_m, *beside])
    normals = np.concatenate([scan.normals, np.tile([0.0, 0.0, 1.0], (120000, 1))])
    return dataclasses.replace(scan, points=points, origin_m=np.zeros(3), normals=normals, n_points=len(points))


@functools.cache
def measured(region="", **settings):
    params = exact_params(up="z", **settings)
    return inspect(scan_with_surroundings(), params.replaced("overrules.region", region))


@pytest.mark.parametrize("before_m", [pytest.param(1.4, marks=pytest.mark.slow), 0.6, 0.3])
def test_a_region_around_the_stair_changes_nothing_inside_it(before_m):
    plain = measured()
    cut = measured(f"{-before_m},-0.4,-0.3,1.9,1.4,1.3")
    assert len(plain.steps) == len(cut.steps) == STAIR.n_steps
    for one, other in zip(plain.steps, cut.steps, strict=True):
        for name in SURVEY_VALUES:
            a, b = getattr(one, name), getattr(other, name)
            assert (a is None) == (b is None), (one.step_id, name)
            # What of the floor is left out is measured no longer: of the first rise alone.
            if a is not None and (one.step_id, name) != (1, "rise_m"):
                assert b.value == pytest.approx(a.value, abs=NOTHING * a.u), (one.step_id, name)
                assert b.u == pytest.approx(a.u, rel=NOTHING), (one.step_id, name)
    assert abs(cut.steps[0].rise_m.value - plain.steps[0].rise_m.value) <= plain.steps[0].rise_m.u
    assert not [note for note in cut.notes if note.code.startswith("region_cuts")]


def test_what_a_region_leaves_of_the_floor_before_the_first_riser_is_no_tread():
    cut = measured("-0.3,-0.4,-0.3,1.9,1.4,1.3")
    assert [round(step.rise_m.value, 2) for step in cut.steps] == [STAIR.rise] * STAIR.n_steps
    assert [patch.kind for patch in cut.patches if patch.height_m < STAIR.rise / 2] == ["floor"]


def compare(one, other):
    """Return how many of the values two inspections have in common agree within their u, and how many there are."""
    n_agree = n_all = 0
    for step in other.steps:
        near = min(one.steps, key=lambda each: np.linalg.norm(each.plane.centroid - step.plane.centroid))
        for name in SURVEY_VALUES:
            a, b = getattr(near, name), getattr(step, name)
            if a is not None and b is not None:
                n_all += 1
                n_agree += abs(a.value - b.value) <= max(a.u, b.u)
    return n_agree, n_all


@pytest.mark.parametrize(
    "name", [each if each == "levels.eps_m" else pytest.param(each, marks=pytest.mark.slow) for each in SWEPT]
)
def test_a_slider_on_its_plateau_changes_no_step_and_no_value_beyond_its_u(name):
    scan, params = scan_with_surroundings(), exact_params(up="z")
    memo = Memo()
    plain = inspect(scan, params, memo)
    for value in SWEPT[name]:
        found = inspect(scan, params.replaced(name, value), memo)
        assert len(found.steps) == len(plain.steps), (name, value)
        for step in found.steps:
            for length in (step.rise_m, step.going_m, step.tread_depth_m, step.width_m):
                assert length is None or length.value > 0.0
        n_agree, n_all = compare(plain, found)
        assert n_agree >= COVERED * n_all, (name, value)
