"""Whether levels can be a staircase, at the limits of what counts as one; what every surface of a survey is."""

import math

import numpy as np
import pytest

from stair_inspector.geometry.fits import PlaneFit
from stair_inspector.model import Level, Surfaces, Up
from stair_inspector.overrules import OverrulesParams
from stair_inspector.pipeline import inspect
from stair_inspector.stages.verdict import why_no_staircase
from tests.synthetic import Stair, exact_params, make_scan

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


# --- the survey ----------------------------------------------------------------------------------------------------

STAIR = Stair(n_steps=4, spacing=0.02, floor_depth=1.6, noise=0.0005)


def flat(x, y, z, seed=0):
    """Points of a level rectangle, one in each 2 cm square, and their normals."""
    rng = np.random.default_rng(seed)
    u, v = (np.arange(low + 0.01, high, 0.02) for low, high in (x, y))
    grid = np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1).reshape(-1, 2)
    grid += rng.uniform(-0.01, 0.01, grid.shape)
    points = np.column_stack([grid, z + rng.normal(0.0, 0.0005, len(grid))])
    return points, np.tile([0.0, 0.0, 1.0], (len(points), 1))


def survey_with(*others, stair=STAIR, **changes):
    parts = [stair.sample(), *others] if stair else list(others)
    points, normals = (np.concatenate(arrays) for arrays in zip(*parts, strict=True))
    return inspect(make_scan(points, normals), exact_params(**changes))


def test_every_point_of_a_part_of_the_stairs_is_labelled_and_every_other_is_not():
    ceiling = flat((-1.0, 1.5), (0.0, 1.0), 2.9)
    inspection = survey_with(ceiling)
    expected = np.concatenate([np.full(len(part), k) for k, (part, _) in enumerate(STAIR.parts())])
    np.testing.assert_array_equal(inspection.labels[: len(expected)], expected)
    assert set(inspection.labels[len(expected) :]) == {-1}
    # Unlike a label, a patch is known of what was rejected too.
    by_id = {patch.patch_id: patch for patch in inspection.patches}
    assert [by_id[k].kind for k in np.unique(inspection.patch_ids[len(expected) :])] == ["rejected"]
    for step in inspection.steps:
        (patch,) = [patch for patch in inspection.patches if patch.step_id == step.step_id]
        np.testing.assert_array_equal(inspection.patch_ids == patch.patch_id, inspection.labels == step.step_id)


def test_a_ceiling_a_table_and_the_floor_next_door_are_rejected_each_with_its_reason():
    inspection = survey_with(
        flat((-1.0, 1.5), (0.0, 1.0), 2.9, 1), flat((-1.5, -0.9), (0.1, 0.9), 0.75, 2), flat((-1, 1), (2, 3.0), 0.0, 3)
    )
    assert [step.step_id for step in inspection.steps] == [1, 2, 3, 4]
    reasons = sorted(patch.reason for patch in inspection.patches if patch.kind == "rejected")
    assert len(reasons) == 3
    assert reasons[0].endswith("above the floor: a ceiling or the storey above")
    assert reasons[1].startswith("at the height of the floor at which the stairs begin, but apart from it")
    assert reasons[2].endswith("above a step or the floor: a table, a seat or other furniture")
    (floor,) = [patch for patch in inspection.patches if patch.kind == "floor"]
    assert (floor.step_id, floor.reason) == (None, None)
    assert floor.height_m == pytest.approx(0.0, abs=0.001)


def test_a_level_is_what_its_most_telling_patch_is():
    # A bench at the height of step 2, and larger than it.
    inspection = survey_with(flat((-1.5, 1.0), (2.5, 3.5), 0.34))
    assert [level.kind for level in inspection.levels] == ["floor"] + ["tread"] * 4
    assert [patch.kind for patch in inspection.patches if patch.level_id == 2] in (
        ["tread", "rejected"],
        ["rejected", "tread"],
    )
    assert inspection.levels[2].reason is None
    assert all(patch.reason for patch in inspection.patches if patch.kind == "rejected")


def test_the_area_and_the_plane_of_a_patch_are_those_of_its_surface():
    inspection = survey_with()
    for patch in inspection.patches[1:]:
        # A cell counts as a whole where it is only touched: at most one row of 35 mm around.
        assert 0.97 * STAIR.going * STAIR.width < patch.area_m2 < (STAIR.going + 0.07) * (STAIR.width + 0.07)
        assert patch.plane.n_points == np.count_nonzero(inspection.patch_ids == patch.patch_id)
        assert patch.plane.normal[2] > 0.999
        assert patch.height_m == pytest.approx(patch.plane.centroid[2], abs=0.001)


def codes(inspection):
    return [note.code for note in inspection.notes]


def test_treads_that_all_fall_the_same_way_are_noted_and_level_ones_are_not():
    assert "treads_lean" not in codes(survey_with())
    # Up leans by a degree from what all treads say.
    lean = math.radians(1.0)
    leaning = survey_with(up=f"{math.sin(lean)},0,{math.cos(lean)}")
    (note,) = [note for note in leaning.notes if note.code == "treads_lean"]
    assert "the treads on the whole lean by 1.0" in note.message
    assert "would move each rise by 5 mm" in note.message


def test_one_tread_that_leans_is_its_own_business():
    points, normals = STAIR.sample()
    # Step 2 falls by 3 degrees.
    is_second = np.abs(points[:, 2] - 2 * STAIR.rise) < 0.01
    points[is_second, 2] += np.tan(np.radians(3.0)) * (points[is_second, 0] - STAIR.going)
    inspection = inspect(make_scan(points, normals), exact_params())
    assert len(inspection.steps) == 4
    assert "treads_lean" not in codes(inspection)
    assert inspection.steps[1].fall_deg.value == pytest.approx(3.0, abs=0.1)


def why(*parts, **changes):
    inspection = survey_with(*parts, stair=None, **changes)
    assert inspection.steps == ()
    assert inspection.axes is None
    (note,) = [note for note in inspection.notes if note.code == "no_staircase"]
    return note.message


def test_one_kerb_is_only_a_single_riser():
    message = why(flat((-1.0, 0.0), (0.0, 2.0), 0.0, 1), flat((0.0, 1.0), (0.0, 2.0), 0.15, 2))
    assert message.startswith("no staircase found: 2 horizontal surfaces, but only single risers, as of a kerb")


@pytest.mark.parametrize("climb", ["-x", "y"])
def test_a_climb_that_leaves_out_the_stair_is_named(climb):
    message = why(STAIR.sample(), overrules=OverrulesParams(climb=climb))
    assert f"overrules.climb ({climb}) leaves out 4 risers in a row, which climb another way" in message
    assert message.endswith("; correct overrules.climb, or set it to auto")


def test_a_climb_that_leaves_out_nothing_is_not_blamed():
    table = flat((0.2, 0.8), (0.2, 0.8), 0.9, 2)
    message = why(flat((-1.0, 1.0), (0.0, 2.0), 0.0, 1), table, overrules=OverrulesParams(climb="x"))
    assert "no two of them a riser apart in height and side by side in plan" in message
    assert "overrules.climb" not in message


def test_a_floor_under_a_shelf_has_nothing_side_by_side():
    message = why(flat((-1.0, 1.0), (0.0, 2.0), 0.0, 1), flat((0.2, 0.8), (0.2, 0.8), 0.9, 2))
    assert "2 horizontal surfaces, but no two of them a riser apart in height and side by side in plan" in message


def test_a_ramp_is_named_as_one():
    points, _ = flat((0.0, 3.0), (0.0, 1.2), 0.0)
    points[:, 2] += np.tan(np.radians(6.0)) * points[:, 0]
    lean = np.tile([-math.sin(math.radians(6.0)), 0.0, math.cos(math.radians(6.0))], (len(points), 1))
    message = why((points, lean))
    assert "leans by 6.0° as a ramp does" in message


def test_no_surface_at_all_says_so():
    rng = np.random.default_rng(3)
    # Upright normals on points too sparse to hang together.
    sparse = rng.uniform(0.0, 30.0, (200, 3)) * [1.0, 1.0, 0.0005]
    message = why((sparse, np.tile([0.0, 0.0, 1.0], (200, 1))))
    assert "only 200 points" in message
