"""From a scan to an inspection: truth within the noise, invariance, boundaries, and the memo."""

import dataclasses
import functools
import hashlib
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from stair_inspector.content.records import inspection_to_dict
from stair_inspector.errors import CannotMeasure, DegenerateGeometry
from stair_inspector.memo import Memo
from stair_inspector.model import Normals
from stair_inspector.params import EdgesParams, HorizontalParams, LevelsParams, NormalsParams, Params
from stair_inspector.pipeline import inspect
from stair_inspector.stages import levels as find
from stair_inspector.stages import orient, paper, treads
from tests.synthetic import CHANGES, Stair, exact_params, make_scan, motion, numbers_of, rotation

ROOT = Path(__file__).parent.parent
NOISE = 0.002
CHANGES_OF_UP = {"normals.k", "normals.source", "floor.distance_m", "method", "up"}
WITHIN = 5.0
"""Standard deviations that a value may be off: by chance once in two million values."""
NOISY = Stair(noise=NOISE, seed=21)
FROM_HORIZONTAL = ["horizontal", "reach", "levels", "surfaces", "axes", "extents", "edges", "nearest", "paper"]
SURVEY = ["patches", "peaks", "bars", "overrules", "flights", "nosings", "survey"]
SPREAD = ["dither", *SURVEY]
BY_PAPER = ["examination", "stations", "normals", "up", "heights", *FROM_HORIZONTAL, "profile"]
# The order by height comes after the comparison of floor and treads, which is made only where up is not given. Of a
# dense scan nothing but its density is asked.
ALL_STAGES = ["examination", "stations", "normals", "up", "plumb", "heights", "sparse", *BY_PAPER[5:], *SPREAD]


def result_of(inspection):
    """Everything that is exported but the timings."""
    result = inspection_to_dict(inspection)
    del result["timings_s"]
    return result


@functools.cache
def kept_run():
    """A scan and the memo of its runs, which tests that begin with the default settings share."""
    return NOISY.scan(), Memo()


def inspect_kept(params):
    """The inspection of that scan; what does not hang on a changed setting is not made again."""
    scan, memo = kept_run()
    return inspect(scan, params, memo)


def column(inspection, name):
    return [getattr(step.paper, name) for step in inspection.steps]


# --- truth ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("source", ["given", "estimate"])
@pytest.mark.parametrize("rise", [0.15, 0.17, 0.2])
def test_truth_heights_are_within_sigma_over_root_n(rise, source):
    stair = dataclasses.replace(NOISY, rise=rise)
    inspection = inspect(stair.scan(), exact_params(normals=NormalsParams(source=source)))
    n = stair.points_per_tread
    assert len(inspection.steps) == stair.n_steps
    assert [step.plane.n_points for step in inspection.steps] == [n] * stair.n_steps
    h = column(inspection, "h_m")
    assert h[:-1] == pytest.approx([rise] * (stair.n_steps - 1), abs=WITHIN * NOISE * np.sqrt(2.0 / n))
    assert h[-1] is None
    n_floor = inspection.floor.n_points
    assert inspection.floor_h_m == pytest.approx(rise, abs=WITHIN * NOISE * np.sqrt(1.0 / n + 1.0 / n_floor))


def test_truth_rms_is_the_noise():
    stair = NOISY
    n = stair.points_per_tread
    # A plane takes three of n degrees of freedom; the scatter of a standard deviation is sigma / sqrt(2 n).
    expected = NOISE * np.sqrt((n - 3) / n)
    for step in inspect_kept(exact_params()).steps:
        assert step.plane.rms_m == pytest.approx(expected, abs=WITHIN * NOISE / np.sqrt(2 * n))


def test_truth_normals_are_up_within_noise_over_lever():
    stair = NOISY
    n = stair.points_per_tread
    for step in inspect_kept(exact_params()).steps:
        tolerance = WITHIN * NOISE * np.sqrt(12.0 / n) / np.array([stair.going, stair.width])
        assert (np.abs(step.plane.normal[:2]) < tolerance).all()


@pytest.mark.parametrize(("alpha_f", "alpha_b", "side"), [(95.0, 5.0, 99.0), (100.0, 0.0, 100.0), (80.0, 30.0, 60.0)])
def test_truth_edges_are_the_percentiles_of_an_evenly_covered_tread(alpha_f, alpha_b, side):
    # Noise-free and evenly covered: a percentile is that share of the tread, to within one cell of the grid.
    stair = Stair(spacing=0.01)
    edges = EdgesParams(alpha_f, alpha_b, side)
    inspection = inspect(stair.scan(), exact_params(edges=edges))
    n = stair.n_steps
    assert column(inspection, "d_fb_m") == pytest.approx([stair.going * (alpha_f - alpha_b) / 100] * n, abs=0.02)
    assert column(inspection, "w_m") == pytest.approx([stair.width * (2 * side - 100) / 100] * n, abs=0.02)
    assert column(inspection, "d_ff_m")[:-1] == pytest.approx([stair.going] * (n - 1), abs=0.01)
    # d = -x: the nosing of step k is at d = -(k - 1) going.
    fronts = [-(k + 1 - alpha_f / 100) * stair.going for k in range(n)]
    assert column(inspection, "f_m") == pytest.approx(fronts, abs=0.01)
    slope = np.degrees(np.arctan2(stair.rise, stair.going))
    assert column(inspection, "theta_deg")[:-1] == pytest.approx([slope] * (n - 1), abs=0.5)


def test_truth_with_risers_the_heights_between_equal_treads_stay_right():
    # Riser points whose estimated normal is bent at an edge shift the centroids of all treads between two risers
    # alike; the highest tread has no riser above it and is left out.
    stair = dataclasses.replace(NOISY, risers=True, spacing=0.015)
    inspection = inspect(stair.scan(), exact_params(normals=NormalsParams()))
    for step in inspection.steps[:-2]:
        tolerance = WITHIN * step.plane.rms_m * np.sqrt(2.0 / step.plane.n_points)
        assert step.paper.h_m == pytest.approx(stair.rise, abs=tolerance)


def test_truth_every_horizontal_point_is_labelled_with_its_tread():
    stair = NOISY
    inspection = inspect_kept(exact_params())
    expected = np.concatenate([np.full(len(part), k) for k, (part, _) in enumerate(stair.parts())])
    np.testing.assert_array_equal(inspection.labels, expected)


def test_truth_a_wider_limit_of_the_rise_finds_a_stair_that_is_steeper_than_any():
    stair = dataclasses.replace(NOISY, rise=0.33, risers=True)
    wide = exact_params(up="z").replaced("flights.max_rise_m", 0.5)
    rises = [step.rise_m.value for step in inspect(stair.scan(), wide).steps]
    assert rises == pytest.approx([0.33] * stair.n_steps, abs=0.001)
    assert not inspect(stair.scan(), exact_params(up="z")).steps


# --- invariance ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", ["survey", "paper"])
@pytest.mark.parametrize(
    ("turn", "shift"),
    [
        (rotation("z", 90.0), (0, 0, 0)),
        (rotation("z", 180.0), (0, 0, 0)),
        (rotation("z", -37.0), (4, -5, 6)),
        (rotation("x", 25.0) @ rotation("z", 110.0), (40, -50, 6)),
        (rotation("y", 90.0), (1, 1, 1)),
        (rotation("x", 180.0), (0, 0, 10)),
    ],
    ids=["yaw_90", "reversed_direction", "yaw_and_shift", "tilted", "lying", "upside_down"],
)
def test_a_rigid_motion_leaves_every_number(turn, shift, method):
    moved = dataclasses.replace(NOISY, motion=motion(turn, shift))
    still = inspect_kept(exact_params(method=method))
    after = inspect(moved.scan(), exact_params(method=method, up=moved.up))
    # Coordinates of up to 50 m carry 7e-15 m of rounding, sums of 700 of them 1e-12.
    np.testing.assert_allclose(numbers_of(after), numbers_of(still), rtol=0, atol=1e-9)
    np.testing.assert_allclose(after.axes.depth, turn @ still.axes.depth, atol=1e-9)
    np.testing.assert_allclose(after.axes.width, turn @ still.axes.width, atol=1e-9)
    np.testing.assert_array_equal(after.labels, still.labels)
    for moved_step, step in zip(after.steps, still.steps, strict=True):
        np.testing.assert_allclose(moved_step.plane.centroid, turn @ step.plane.centroid + shift, atol=1e-9)
        if method == "paper":
            # The survey's corners are its own edges: see the scans of tests/test_survey_scans.py.
            np.testing.assert_allclose(moved_step.corners, step.corners @ turn.T + shift, atol=1e-9)


@pytest.mark.parametrize("source", ["given", "estimate"])
def test_the_order_of_the_points_changes_nothing(source):
    points, normals = NOISY.sample()
    order = np.random.default_rng(2).permutation(len(points))
    params = exact_params(normals=NormalsParams(source=source))
    first = inspect(make_scan(points, normals), params)
    second = inspect(make_scan(points[order], normals[order]), params)
    # Everything is summed in the order of the heights, so not even the last bit moves.
    np.testing.assert_array_equal(numbers_of(second), numbers_of(first))
    np.testing.assert_array_equal(second.labels, first.labels[order])


def test_the_order_of_the_points_moves_an_up_from_the_floor_by_less_than_its_noise():
    # RANSAC draws other points, so the inliers at the tolerance may differ.
    stair = dataclasses.replace(NOISY, floor_depth=1.6)
    points, normals = stair.sample()
    order = np.random.default_rng(3).permutation(len(points))
    ups = [
        inspect(make_scan(p, q), exact_params(up="auto")).up
        for p, q in ((points, normals), (points[order], normals[order]))
    ]
    slope = NOISE * np.sqrt(12.0 / (80 * 50))
    assert np.linalg.norm(ups[0].vector - ups[1].vector) < slope


def test_a_mirrored_stair_has_the_same_numbers():
    points, normals = NOISY.sample()
    mirror = np.array([1.0, -1.0, 1.0])
    first = inspect(make_scan(points, normals), exact_params())
    second = inspect(make_scan(points * mirror, normals * mirror), exact_params())
    # Side percentiles 99 and 1 change places, which rounds differently.
    np.testing.assert_allclose(numbers_of(second), numbers_of(first), rtol=0, atol=1e-12)
    np.testing.assert_allclose(second.axes.depth, first.axes.depth * mirror, atol=1e-12)


@pytest.mark.parametrize("origin", [(3_500_000.0, 5_800_000.0, 120.0), (-1000.0, 0.0, -40.0)])
def test_a_scan_far_from_the_origin_loses_nothing(origin):
    near, far = inspect_kept(exact_params()), inspect(NOISY.scan(origin_m=origin), exact_params())
    np.testing.assert_array_equal(numbers_of(far), numbers_of(near))
    shift = float(np.array(origin) @ near.axes.depth)
    for far_step, step in zip(far.steps, near.steps, strict=True):
        assert far_step.paper.f_m == step.paper.f_m + shift
        assert far_step.paper.b_m == step.paper.b_m + shift
        np.testing.assert_array_equal(far_step.plane.centroid, step.plane.centroid)
    for far_level, level in zip(far.levels, near.levels, strict=True):
        assert far_level.height_m == level.height_m + origin[2]
        assert (far_level.low_m, far_level.high_m) == (level.low_m + origin[2], level.high_m + origin[2])
    assert far.profile.low_m == near.profile.low_m + origin[2]


def test_a_level_knows_its_lowest_and_highest_point():
    scan = NOISY.scan()
    inspection = inspect(scan, exact_params())
    for level in inspection.levels:
        heights = scan.points[inspection.labels == level.level_id, 2]
        assert (level.low_m, level.high_m) == (heights.min(), heights.max())
        assert level.n_points == len(heights)
    assert inspection.profile.low_m == scan.points[:, 2].min()
    assert inspection.profile.counts.sum() == len(scan.points)


# --- the paper's method --------------------------------------------------------------------------------------------


def test_paper_every_cluster_above_the_lowest_is_a_step():
    stair = NOISY.sample()
    rng = np.random.default_rng(5)
    ceiling = np.column_stack([rng.uniform(-1, 2, 300), rng.uniform(0, 1, 300), np.full(300, 2.6)])
    points = np.concatenate([stair[0], ceiling])
    scan = make_scan(points, np.concatenate([stair[1], np.tile([0, 0, 1.0], (300, 1))]))
    inspection = inspect(scan, exact_params(method="paper"))
    assert [step.step_id for step in inspection.steps] == [1, 2, 3, 4, 5, 6]
    assert [level.kind for level in inspection.levels] == ["floor"] + ["tread"] * 6
    assert inspection.steps[-1].plane.centroid[2] == pytest.approx(2.6)


def test_paper_the_last_step_has_no_value_that_needs_one_above():
    last = inspect_kept(exact_params(method="paper")).steps[-1].paper
    assert (last.h_m, last.d_ff_m, last.theta_deg) == (None, None, None)
    assert min(last.d_fb_m, last.w_m) > 0.0


def test_paper_auto_axes_are_the_global_ones():
    long_run = dataclasses.replace(NOISY, n_steps=8)
    auto = inspect(long_run.scan(), exact_params(method="paper"))
    by_name = inspect(long_run.scan(), exact_params(method="paper").replaced("axes.rule", "global"))
    np.testing.assert_array_equal(numbers_of(auto), numbers_of(by_name))
    assert auto.axes.rule == "global"
    # 8 * 0.28 m is longer than 1 m: the known swap.
    assert abs(auto.axes.width[0]) > 0.99
    assert abs(inspect(long_run.scan(), exact_params()).axes.width[1]) > 0.99


def test_paper_gives_the_numbers_of_its_stages_alone():
    stair = NOISY
    scan, params = stair.scan(), exact_params(method="paper")
    inspection = inspect(scan, params)
    up = orient.find_up(scan, Normals(scan.normals), "z", params.floor, "paper")
    heights = orient.order_by_height(scan, Normals(scan.normals), up)
    horizontal = find.select_horizontal(heights, params.horizontal)
    levels = find.find_levels(horizontal, find.find_height_reach(horizontal, params.levels.eps_m), params.levels)
    surfaces = treads.fit_surfaces(horizontal, levels)
    axes = treads.find_axes(horizontal, surfaces, "global", "paper")
    edges = treads.place_edges(treads.find_extents(horizontal, levels, axes), params.edges)
    nearest = treads.find_nearest(horizontal, levels, surfaces, params.display)
    steps = paper.measure_steps(scan, up, surfaces, axes, edges, nearest)
    assert [step.paper for step in inspection.steps] == [step.paper for step in steps]
    for step, alone in zip(inspection.steps, steps, strict=True):
        np.testing.assert_array_equal(step.corners, alone.corners)
        np.testing.assert_array_equal(step.plane.normal, alone.plane.normal)
        np.testing.assert_array_equal(step.nearest_ids, alone.nearest_ids)
    np.testing.assert_array_equal(inspection.labels, levels.labels)


def test_paper_leaves_every_field_of_the_survey_empty():
    inspection = inspect_kept(exact_params(method="paper"))
    assert (inspection.flights, inspection.patches, inspection.patch_ids) == ((), (), None)
    for step in inspection.steps:
        survey = {f.name: getattr(step, f.name) for f in dataclasses.fields(step)}
        given = ("step_id", "plane", "corners", "nearest_ids", "paper", "kind")
        assert {value for name, value in survey.items() if name not in given} == {None}


def test_the_surveys_steps_carry_the_papers_values_of_their_level():
    # Axes as the survey finds them: the paper's own differ by design.
    by_paper = inspect_kept(exact_params(method="paper").replaced("axes.rule", "per_step"))
    by_survey = inspect_kept(exact_params().replaced("axes.rule", "per_step"))
    assert [step.paper for step in by_survey.steps] == [step.paper for step in by_paper.steps]


@pytest.mark.parametrize(
    "name", ["uncertainty.edge_m", "survey.line_percent", "survey.edge_source", "flights.max_gap_m", "patches.cell_m"]
)
def test_no_setting_of_the_survey_moves_the_papers_numbers(name):
    before = exact_params(method="paper")
    first = result_of(inspect(NOISY.scan(), before))
    second = result_of(inspect(NOISY.scan(), before.replaced(name, CHANGES[name])))
    assert first.pop("settings") != second.pop("settings")
    assert first == second


# --- boundaries ----------------------------------------------------------------------------------------------------


def flat(height, n=400, seed=0):
    rng = np.random.default_rng(seed)
    return np.column_stack([rng.uniform(0, 1, n), rng.uniform(0, 1, n), np.full(n, height)])


def with_normals(points, normal=(0.0, 0.0, 1.0)):
    return make_scan(points, np.tile(np.array(normal), (len(points), 1)))


@pytest.mark.parametrize("method", ["survey", "paper"])
def test_no_levels_is_an_answer(method):
    inspection = inspect(with_normals(flat(0.0), (1.0, 0.0, 0.0)), exact_params(method=method))
    assert inspection.levels == ()
    assert inspection.steps == ()
    assert inspection.floor is None
    assert inspection.floor_h_m is None
    assert inspection.axes is None
    assert set(inspection.labels) == {-1}
    assert [note.code for note in inspection.notes] == ["no_staircase"]


@pytest.mark.parametrize("method", ["survey", "paper"])
def test_a_floor_alone_is_no_staircase(method):
    inspection = inspect(with_normals(flat(0.0)), exact_params(method=method))
    assert [level.kind for level in inspection.levels] == ["floor"]
    assert inspection.steps == ()
    assert inspection.floor.n_points == 400
    assert inspection.floor_h_m is None
    assert inspection.axes is None
    assert [note.code for note in inspection.notes] == ["no_staircase"]


def test_one_step_is_kept_by_the_paper_and_rejected_by_the_survey():
    scan = Stair(n_steps=1).scan()
    paper, survey = (inspect(scan, exact_params(method=method)) for method in ("paper", "survey"))
    (step,) = paper.steps
    assert (step.paper.h_m, step.paper.d_ff_m, step.paper.theta_deg) == (None, None, None)
    assert paper.floor_h_m == pytest.approx(0.17, abs=1e-12)
    assert "no_staircase" in [note.code for note in paper.notes]
    assert survey.steps == ()
    assert [level.kind for level in survey.levels] == ["floor", "rejected"]


def test_levels_that_are_no_staircase_are_rejected_with_the_reason_by_the_survey_alone():
    scan = with_normals(np.concatenate([flat(z, seed=k) for k, z in enumerate((0.0, 0.74, 2.4))]))
    paper, survey = (inspect(scan, exact_params(method=method)) for method in ("paper", "survey"))
    assert [step.step_id for step in paper.steps] == [1, 2]
    assert [level.kind for level in paper.levels] == ["floor", "tread", "tread"]
    assert survey.steps == ()
    assert [level.kind for level in survey.levels] == ["floor", "rejected", "rejected"]
    (note,) = [note for note in survey.notes if note.code == "no_staircase"]
    assert note.message.startswith(
        "no staircase found: 3 horizontal surfaces, but no two of them a riser apart in height and side by side"
    )
    assert [level.reason for level in survey.levels] == [None, *[survey.patches[1].reason] * 2]
    assert survey.patches[1].reason.startswith("no second and third surface a riser apart")
    (by_paper,) = [note for note in paper.notes if note.code == "no_staircase"]
    assert by_paper.message.startswith("no staircase found: 3 horizontal levels, but nowhere two similar rises")


def test_steps_are_reviewed_where_they_are_kept_and_only_there():
    line = np.column_stack([np.full(80, 0.5), np.linspace(0, 1, 80), np.full(80, 0.74)])
    scan = with_normals(np.concatenate([flat(0.0), line, flat(2.4)]))
    paper, survey = (inspect(scan, exact_params(method=method)) for method in ("paper", "survey"))
    assert [note.step for note in paper.notes if note.code == "no_plane"] == [1]
    assert [note.step for note in survey.notes if note.code == "no_plane"] == []


def with_a_line_above():
    """A stair and a riser above it a level whose points lie on one line."""
    stair_points, stair_normals = NOISY.sample()
    line = np.column_stack([np.full(80, 1.5), np.linspace(0, 1, 80), np.full(80, 1.02)])
    return make_scan(
        np.concatenate([stair_points, line]), np.concatenate([stair_normals, np.tile([0.0, 0.0, 1.0], (80, 1))])
    )


def test_a_collinear_level_is_a_step_without_a_plane_to_the_paper():
    scan = with_a_line_above()
    # The line is longer than the treads are wide: pooled axes keep depth and width.
    inspection = inspect(scan, exact_params(method="paper").replaced("axes.rule", "per_step"))
    last = inspection.steps[-1]
    assert last.plane.normal is None
    assert last.plane.rms_m is None
    assert [(note.code, note.step) for note in inspection.notes if note.stage == "paper"] == [("no_plane", 6)]


def test_a_collinear_level_is_no_step_of_the_survey():
    inspection = inspect(with_a_line_above(), exact_params())
    assert [step.step_id for step in inspection.steps] == [1, 2, 3, 4, 5]
    assert inspection.levels[-1].kind == "rejected"


def test_more_than_500_levels_cannot_be_measured():
    heights = np.arange(501) * 0.05
    points = np.column_stack([np.cos(heights), np.sin(heights), heights])
    params = exact_params(levels=LevelsParams(eps_m=0.001, min_points=1))
    with pytest.raises(CannotMeasure, match=r"^levels: 501 height clusters, more than 500 can be steps; raise"):
        inspect(with_normals(points), params)


@pytest.mark.parametrize(
    "points", [np.zeros((3, 3)), np.full((60, 3), 0.3), np.outer(np.arange(60.0), [1, 1, 0])], ids=str
)
@pytest.mark.parametrize("up", ["z", "auto"])
def test_too_little_to_measure_is_one_sentence(points, up):
    with pytest.raises(CannotMeasure) as error:
        inspect(make_scan(points), Params(up=up))
    assert str(error.value).startswith("synthetic.ply: ")
    assert "\n" not in str(error.value)


# --- contract ------------------------------------------------------------------------------------------------------


def test_points_far_from_zero_are_refused_and_strays_are_not():
    points = np.random.default_rng(3).uniform(0.0, 5.0, (4000, 3))
    stray = np.vstack([points, [[5e6, 0.0, 0.0]]])
    assert len(make_scan(stray).points) == 4001
    with pytest.raises(DegenerateGeometry, match=r"5,335,00\d m from zero; subtract an origin and give it"):
        make_scan(points + np.array([691_000.0, 5_335_000.0, 520.0]))


def test_the_scan_is_left_as_it_was_and_everything_is_read_only():
    scan = NOISY.scan()
    before = scan.points.copy(), scan.normals.copy(), scan.origin_m.copy()
    inspection = inspect(scan, Params())
    for array, was in zip((scan.points, scan.normals, scan.origin_m), before, strict=True):
        np.testing.assert_array_equal(array, was)
        assert not array.flags.writeable
    arrays = [inspection.labels, inspection.up.vector, inspection.axes.width, inspection.axes.depth]
    arrays += [inspection.floor.centroid, inspection.floor.normal]
    for step in inspection.steps:
        arrays += [step.corners, step.nearest_ids, step.plane.centroid, step.plane.normal]
    assert all(not array.flags.writeable for array in arrays)


@pytest.mark.parametrize("method", ["survey", "paper"])
def test_the_same_input_gives_the_same_result(method):
    params = Params(method=method, unit="m")
    assert result_of(inspect(NOISY.scan(), params)) == result_of(inspect(NOISY.scan(), params))


@pytest.mark.slow
def test_two_processes_give_the_same_bytes_with_up_from_the_floor():
    script = (
        "import hashlib, json; from tests.test_pipeline import NOISY, Params, inspect, result_of;"
        "text = json.dumps(result_of(inspect(NOISY.scan(), Params())));"
        "print(hashlib.sha256(text.encode()).hexdigest())"
    )
    digests = set()
    for threads in ("1", "4"):
        # Neither the number of threads nor the hash seed may reach a number.
        environment = os.environ | {"OMP_NUM_THREADS": threads, "PYTHONHASHSEED": threads, "PYTHONPATH": str(ROOT)}
        run = subprocess.run(
            [sys.executable, "-c", script], cwd=ROOT, env=environment, capture_output=True, text=True, check=True
        )
        digests.add(run.stdout.strip())
    here = json.dumps(result_of(inspect(NOISY.scan(), Params())))
    assert digests == {hashlib.sha256(here.encode()).hexdigest()}


def test_the_result_carries_its_settings_and_timings():
    params = exact_params(horizontal=HorizontalParams(theta_deg=12.0))
    inspection = inspect(NOISY.scan(), params)
    assert inspection.params is params
    # Up is given: there is nothing to compare it with.
    assert list(inspection.timings_s) == [stage for stage in ALL_STAGES if stage != "plumb"]
    assert all(seconds >= 0.0 for seconds in inspection.timings_s.values())


# --- memo ----------------------------------------------------------------------------------------------------------


def test_there_is_a_change_for_every_setting():
    settings = inspection_to_dict(inspect(NOISY.scan(), exact_params()))["settings"]
    names = [
        f"{group}.{name}" if isinstance(values, dict) else group
        for group, values in settings.items()
        for name in (values if isinstance(values, dict) else [""])
    ]
    assert sorted(CHANGES) == sorted(names)


@functools.cache
def plain_result(up):
    return result_of(inspect(NOISY.scan(), Params(up=up)))


@pytest.mark.slow
@pytest.mark.parametrize("name", CHANGES)
def test_memo_gives_what_a_plain_run_gives(name):
    # To find the floor and compare it with the treads takes longest: only where the setting matters for it.
    before = Params() if name in CHANGES_OF_UP else Params(up="z")
    scan, memo = NOISY.scan(), Memo()
    after = before.replaced(name, CHANGES[name])
    first = result_of(inspect(scan, before, memo))
    assert result_of(inspect(scan, after, memo)) == result_of(inspect(scan, after))
    assert result_of(inspect(scan, before, memo)) == first == plain_result(before.up)


@pytest.mark.parametrize("n_moves", [8, pytest.param(60, marks=pytest.mark.slow)])
def test_memo_gives_what_a_plain_run_gives_through_a_drag_over_all_sliders(n_moves):
    scan, memo, params = NOISY.scan(), Memo(), exact_params()
    rng = np.random.default_rng(6)
    names = [name for name in CHANGES if name not in ("up", "normals.source")]
    for name in rng.permutation(names * 2)[:n_moves]:
        base = exact_params()
        default = (
            getattr(base, name) if "." not in name else getattr(getattr(base, name.split(".")[0]), name.split(".")[1])
        )
        current = (
            getattr(params, name)
            if "." not in name
            else getattr(getattr(params, name.split(".")[0]), name.split(".")[1])
        )
        params = params.replaced(str(name), CHANGES[name] if current == default else default)
        assert result_of(inspect(scan, params, memo)) == result_of(inspect(scan, params))


@pytest.mark.parametrize(
    ("name", "stages"),
    [
        ("normals.k", ALL_STAGES[2:]),
        # A given up is not compared with the treads.
        ("up", ["up", *ALL_STAGES[5:]]),
        ("floor.distance_m", ALL_STAGES[3:]),
        ("overrules.region", ALL_STAGES[5:]),
        ("horizontal.theta_deg", [*FROM_HORIZONTAL, "profile", *SPREAD]),
        ("levels.eps_m", [*FROM_HORIZONTAL[1:], *SPREAD]),
        ("levels.min_points", [*FROM_HORIZONTAL[2:], *SPREAD]),
        # A step of the survey carries the paper's values too, but they are no part of its measuring.
        ("axes.rule", ["axes", "extents", "edges", "paper"]),
        # The survey looks for the floor among several planes.
        ("method", ["stations", *BY_PAPER[3:]]),
        ("edges.front_percentile", ["edges", "paper"]),
        ("edges.back_percentile", ["edges", "paper"]),
        ("edges.side_percentile", ["edges", "paper"]),
        ("display.nearest_k", ["nearest", "paper", "survey"]),
        ("patches.cell_m", SURVEY),
        ("patches.min_area_m2", SURVEY),
        ("overrules.force", SURVEY[3:]),
        ("overrules.climb", SURVEY[3:]),
        ("flights.max_gap_m", SURVEY[4:]),
        ("flights.min_risers", SURVEY[4:]),
        ("survey.line_percent", SURVEY[6:]),
        ("survey.edge_source", SURVEY[5:]),
        ("uncertainty.edge_m", SURVEY[6:]),
        ("uncertainty.registration_m", SURVEY[6:]),
        # A sound scan stays the same object.
        ("stations", ["stations"]),
        ("unit", []),
    ],
)
def test_memo_runs_only_what_depends_on_the_setting(name, stages):
    scan, memo = kept_run()
    # Undoes what the test before has changed, and measures all only in the first.
    inspect(scan, Params(), memo)
    ran = list(inspect(scan, Params().replaced(name, CHANGES[name]), memo).timings_s)
    # What follows a stage that gives what it gave before need not run.
    assert ran == [stage for stage in stages if stage in ran]
    assert ran[:1] == stages[:1]


def test_memo_ends_a_run_where_what_a_setting_changes_comes_out_the_same():
    scan, memo = kept_run()
    inspect(scan, Params(), memo)
    settings = Params().replaced("levels.min_points", 51)
    again = inspect(scan, settings, memo)
    assert list(again.timings_s) == ["levels", "patches"]
    assert again.params == settings
    assert result_of(again) == result_of(inspect(scan, settings))


@pytest.mark.parametrize(
    ("name", "stages"), [("method", ["stations", "axes", "extents", "edges", "paper"]), ("floor.distance_m", [])]
)
def test_with_a_given_up_the_floor_is_of_no_concern(name, stages):
    scan, memo = NOISY.scan(), Memo()
    inspect(scan, Params(up="z"), memo)
    assert list(inspect(scan, Params(up="z").replaced(name, CHANGES[name]), memo).timings_s) == stages


def test_memo_runs_nothing_for_equal_settings_and_everything_for_another_scan():
    scan, memo = NOISY.scan(), Memo()
    inspect(scan, exact_params(), memo)
    assert inspect(scan, exact_params(), memo).timings_s == {}
    other = dataclasses.replace(NOISY, seed=22).scan()
    assert list(inspect(other, exact_params(), memo).timings_s) == [
        "examination",
        "stations",
        "normals",
        "up",
        *ALL_STAGES[5:],
    ]


def test_memo_survives_a_setting_that_cannot_be_measured():
    scan, memo, params = NOISY.scan(), Memo(), exact_params()
    first = result_of(inspect(scan, params, memo))
    spread = with_normals(np.column_stack([np.zeros(501), np.arange(501) % 2, np.arange(501) * 0.05]))
    with pytest.raises(CannotMeasure):
        inspect(spread, params.replaced("levels.min_points", 1), memo)
    assert result_of(inspect(scan, params, memo)) == first


def test_memo_hands_the_slow_stages_over_and_announces_every_stage():
    heavy, stages = [], []

    def run(function, *inputs):
        heavy.append(function.__name__)
        return function(*inputs)

    inspect(NOISY.scan(), Params(), Memo(heavy=run, on_stage=stages.append))
    assert heavy == ["find_normals", "find_up"]
    assert stages == ALL_STAGES
    heavy.clear()
    inspect(NOISY.scan(), Params(up="z"), Memo(heavy=run))
    assert heavy == ["find_normals"]
