"""Rounded coordinates are spread over their steps, for the survey alone, and the stair is found as if they were not."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from stair_inspector.model import Normals
from stair_inspector.params import LevelsParams
from stair_inspector.pipeline import inspect
from stair_inspector.stages.dither import spread_steps
from stair_inspector.stages.examine import examine
from stair_inspector.stages.levels import find_height_reach, find_levels, select_horizontal
from stair_inspector.stages.orient import find_up, order_by_height
from tests.synthetic import Stair, exact_params, make_scan, motion, numbers_of, rotation

ODD = Stair(
    n_steps=5, rise=0.1734, going=0.2837, width=1.1063, spacing=0.009, risers=True, noise=0.001, floor_depth=1.6, seed=7
)


def rounded(points, step_m):
    """As a file with few decimals holds the points and as it is read: the distinct ones, and how often each occurs."""
    distinct, repeats = np.unique(np.rint(points / step_m).astype(np.int64), axis=0, return_counts=True)
    return replace(make_scan(distinct * step_m), repeats=repeats)


def stages_of(scan, region=""):
    normals = Normals(np.tile([0.0, 0.0, 1.0], (len(scan.points), 1)))
    up = find_up(scan, normals, "z", exact_params().floor, "survey")
    heights = order_by_height(scan, normals, up, region)
    horizontal = select_horizontal(heights, exact_params().horizontal)
    levels = find_levels(horizontal, find_height_reach(horizontal, LevelsParams().eps_m), LevelsParams())
    return scan, examine(scan), heights, horizontal, levels


@cache
def survey(yaw_deg, step_mm):
    turned = replace(ODD, motion=motion(rotation("z", yaw_deg), (0.0123, 0.0231, 0.0037)))
    points, _ = turned.sample()
    scan = rounded(points, step_mm / 1000.0) if step_mm else make_scan(points)
    return inspect(scan, exact_params(normals=replace(exact_params().normals, source="estimate")))


def rises_and_goings(inspection):
    values = [(step.rise_m, step.going_m) for step in inspection.steps]
    return [value for pair in values for value in pair if value is not None]


# --- the points ----------------------------------------------------------------------------------------------------


def test_what_lies_on_no_step_is_given_back_itself():
    stages = stages_of(make_scan(ODD.sample()[0]))
    found = spread_steps(*stages)
    assert (found.heights, found.horizontal, found.levels) == stages[2:]


@pytest.mark.parametrize("step_m", [0.001, 0.01])
def test_every_point_stays_within_half_a_step_and_counts_as_often_as_the_file_holds_it(step_m):
    stages = stages_of(rounded(ODD.sample()[0], step_m))
    scan, _, heights, horizontal, levels = stages
    found = spread_steps(*stages)
    for was, now in ((heights, found.heights), (horizontal, found.horizontal)):
        in_scan = now.level_from_scan.T @ now.coordinates_m
        moved = in_scan.T - scan.points[now.point_ids]
        assert np.abs(moved).max() <= step_m / 2.0 + 1e-9
        # Evenly: the deviation of an even distribution, on each axis.
        assert moved.std(axis=0) == pytest.approx([step_m / np.sqrt(12.0)] * 3, rel=0.02)
        counts = np.bincount(now.point_ids, minlength=len(scan.points))
        kept = np.zeros(len(scan.points), dtype=bool)
        kept[was.point_ids] = True
        np.testing.assert_array_equal(counts, np.where(kept, scan.repeats, 0))
    assert (np.diff(found.heights.coordinates_m[2]) >= 0.0).all()
    for k, (start, stop) in enumerate(zip(found.levels.start, found.levels.stop, strict=True)):
        own = found.horizontal.point_ids[start:stop]
        assert set(own) == set(horizontal.point_ids[levels.start[k] : levels.stop[k]])
        assert (np.diff(found.horizontal.coordinates_m[2, start:stop]) >= 0.0).all()


def test_the_same_scan_is_spread_the_same_and_a_region_changes_nothing_inside_it():
    scan = rounded(ODD.sample()[0], 0.01)
    whole, again = spread_steps(*stages_of(scan)), spread_steps(*stages_of(scan))
    np.testing.assert_array_equal(whole.heights.coordinates_m, again.heights.coordinates_m)
    inner = spread_steps(*stages_of(scan, "-5,-5,0.1,5,5,0.6"))
    is_inside = np.isin(whole.heights.point_ids, inner.heights.point_ids)
    assert 0 < np.count_nonzero(is_inside) < len(is_inside)
    np.testing.assert_array_equal(whole.heights.coordinates_m[:, is_inside], inner.heights.coordinates_m)


def test_a_file_that_repeats_itself_as_a_whole_has_no_more_points():
    once = rounded(ODD.sample()[0], 0.01)
    twice = replace(once, repeats=2 * once.repeats)
    counted = [len(spread_steps(*stages_of(scan)).heights.point_ids) for scan in (once, twice)]
    assert counted[0] == counted[1] == once.repeats.sum()


def test_repeats_count_only_where_every_axis_is_on_a_step():
    scan = rounded(ODD.sample()[0], 0.01)
    stages = stages_of(scan)
    flat = replace(stages[1], steps_m=stages[1].steps_m * [1.0, 0.0, 1.0])
    assert len(spread_steps(scan, flat, *stages[2:]).heights.point_ids) == len(scan.points)


# --- the stair -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("yaw_deg", "step_mm"),
    [
        (0, 1),
        (45, 5),
        *(
            pytest.param(yaw_deg, step_mm, marks=pytest.mark.slow)
            for yaw_deg in (0, 37, 45)
            for step_mm in (0.1, 1, 2, 5)
            if (yaw_deg, step_mm) not in ((0, 1), (45, 5))
        ),
    ],
)
def test_rounding_loses_no_nosing_and_moves_no_rise_or_going_by_more_than_its_u(yaw_deg, step_mm):
    exact, found = survey(yaw_deg, 0), survey(yaw_deg, step_mm)
    assert [step.step_id for step in found.steps] == [step.step_id for step in exact.steps] == list(ODD.step_ids)
    unseen = [[note.step for note in one.notes if note.code == "nosing_unobserved"] for one in (exact, found)]
    assert unseen[1] == unseen[0]
    for was, now in zip(rises_and_goings(exact), rises_and_goings(found), strict=True):
        assert abs(now.value - was.value) <= now.u
        assert now.u <= was.u + 2.0 * step_mm / 1000.0
    for step in found.steps:
        assert abs(step.rise_m.value - ODD.rise) <= step.rise_m.u
        if step.going_m is not None:
            assert abs(step.going_m.value - ODD.going) <= step.going_m.u


def test_ten_millimetres_hold_the_rises_and_no_difference_is_certain():
    steps = survey(0, 10).steps
    assert len(steps) == ODD.n_steps
    for step in steps:
        assert abs(step.rise_m.value - ODD.rise) <= step.rise_m.u
        assert 0.004 <= dict(step.rise_m.parts)["resolution"] <= 0.0083


def test_the_papers_numbers_are_those_of_the_file():
    scan = rounded(ODD.sample()[0], 0.005)
    by_paper = inspect(scan, exact_params(method="paper", normals=replace(exact_params().normals, source="estimate")))
    plain = replace(scan, repeats=None)
    again = inspect(plain, exact_params(method="paper", normals=replace(exact_params().normals, source="estimate")))
    np.testing.assert_array_equal(numbers_of(by_paper), numbers_of(again))
    # Beside the survey the paper's rules for the axes differ, but not its heights.
    beside = inspect(scan, exact_params(normals=replace(exact_params().normals, source="estimate")))
    assert [step.paper.h_m for step in beside.steps] == [step.paper.h_m for step in by_paper.steps]
