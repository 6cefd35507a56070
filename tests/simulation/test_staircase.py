"""The mesh is the staircase that was asked for, and the truth says what the mesh is."""

import dataclasses
import math

import numpy as np
import pytest

from stair_inspector.simulation.layout import lay_out
from stair_inspector.simulation.specs import SLAB_M, Stair
from stair_inspector.simulation.staircase import build, output_from_stair


def vertices_of(building, part, level=None):
    """All corners of the surfaces of one part (and level), (n, 3)."""
    wanted = [
        index
        for index, surface in enumerate(building.surfaces)
        if surface.part == part and level in (None, surface.level)
    ]
    faces = building.mesh.faces[np.isin(building.surface_of, wanted)]
    return np.asarray(building.mesh.vertices)[np.unique(faces)]


def top_of(building, step):
    return vertices_of(building, step.kind, step.step_id)


def test_truth_repeats_the_spec():
    steps = lay_out(Stair(n_risers=7, rise_m=0.18, going_m=0.27, width_m=1.1, overhang_m=0.03))
    assert [step.step_id for step in steps] == list(range(1, 8))
    assert [step.kind for step in steps] == ["tread"] * 6 + ["landing"]
    assert {step.rise_m for step in steps} == {0.18}
    assert {step.going_m for step in steps[:-1]} == {0.27}
    assert steps[-1].going_m is None
    assert [step.tread_depth_m for step in steps[:-1]] == pytest.approx([0.30] * 6, abs=1e-12)
    assert steps[-1].tread_depth_m == 1.2
    assert [step.height_m for step in steps] == pytest.approx([0.18 * k for k in range(1, 8)], abs=1e-12)


@pytest.mark.parametrize("open_risers", [False, True])
def test_mesh_has_the_rise_going_width_and_overhang_of_the_truth(open_risers):
    building = build(Stair(n_risers=6, landing_after=3, overhang_m=0.02, open_risers=open_risers))
    fronts = []
    for step in building.steps:
        top = top_of(building, step)
        assert top[:, 2] == pytest.approx(step.height_m, abs=1e-12)
        assert np.ptp(top[:, 0]) == pytest.approx(step.tread_depth_m, abs=1e-12)
        assert np.ptp(top[:, 1]) == pytest.approx(step.width_m, abs=1e-12)
        fronts.append(top[:, 0].min())
        nosing = vertices_of(building, "nosing", step.step_id)
        assert np.ptp(nosing[:, 2]) == pytest.approx(SLAB_M, abs=1e-12)
        if open_risers:
            assert len(vertices_of(building, "riser", step.step_id)) == 0
        else:
            riser = vertices_of(building, "riser", step.step_id)
            assert riser[:, 0] == pytest.approx(fronts[-1] + step.nosing_overhang_m, abs=1e-12)
            assert riser[:, 2].min() == pytest.approx(step.height_m - step.rise_m, abs=1e-12)
    assert np.diff(fronts) == pytest.approx([step.going_m for step in building.steps[:-1]], abs=1e-12)
    assert building.steps[2].going_m == 1.2


def test_nosing_line_is_the_front_edge_of_the_top():
    building = build(Stair(n_risers=4, cross_fall_errors_deg="2:2", fall_errors_deg="3:3"))
    for step in building.steps:
        top = top_of(building, step)
        front = top[np.isclose(top[:, 0], top[:, 0].min(), atol=1e-12)]
        left, right = front[np.argmax(front[:, 1])], front[np.argmin(front[:, 1])]
        assert step.nosing[0] == pytest.approx(tuple(left), abs=1e-12)
        assert step.nosing[1] == pytest.approx(tuple(right), abs=1e-12)


def test_defects_are_in_the_geometry_and_in_the_truth():
    stair = Stair(
        n_risers=8,
        rise_errors_m="5:+0.015,6:-0.015",
        going_errors_m="2:-0.02",
        fall_errors_deg="3:3.43",
        cross_fall_errors_deg="4:1.5",
        dish_errors_m="7:0.006",
    )
    building = build(stair)
    steps = building.steps
    rises = [step.rise_m for step in steps]
    assert rises == pytest.approx([0.17] * 4 + [0.185, 0.155] + [0.17] * 2, abs=1e-12)
    assert steps[1].going_m == pytest.approx(0.26, abs=1e-12)
    assert top_of(building, steps[4])[:, 2] == pytest.approx(5 * 0.17 + 0.015, abs=1e-12)
    assert top_of(building, steps[5])[:, 2] == pytest.approx(6 * 0.17, abs=1e-12)

    fallen = top_of(building, steps[2])
    slope = (fallen[:, 2] - steps[2].height_m) / np.maximum(fallen[:, 0] - fallen[:, 0].min(), 1e-9)
    behind = fallen[:, 0] > fallen[:, 0].min() + 0.01
    assert slope[behind] == pytest.approx(math.tan(math.radians(3.43)), abs=1e-9)
    assert steps[2].fall_deg == 3.43

    tilted = top_of(building, steps[3])
    assert tilted[:, 2] - steps[3].height_m == pytest.approx(tilted[:, 1] * math.tan(math.radians(1.5)), abs=1e-12)

    worn = top_of(building, steps[6])
    assert worn[:, 2].min() == pytest.approx(steps[6].height_m - 0.006, abs=1e-12)
    assert worn[np.isclose(worn[:, 0], worn[:, 0].min()), 2] == pytest.approx(steps[6].height_m, abs=1e-12)
    assert steps[6].dish_m == 0.006


def test_a_worn_nosing_is_a_strip_that_lies_lower_and_its_rises_say_so():
    building = build(Stair(n_risers=5, wear_errors_m="3:0.003"))
    steps = building.steps
    assert [step.rise_m for step in steps] == pytest.approx([0.17, 0.17, 0.167, 0.173, 0.17], abs=1e-12)
    assert [step.rise_lcr_m[0] for step in steps] == pytest.approx([0.17, 0.17, 0.167, 0.173, 0.17], abs=1e-12)
    assert [point[2] for point in steps[2].nosing] == pytest.approx([0.507, 0.507], abs=1e-12)
    worn = top_of(building, steps[2])
    front = worn[:, 0].min()
    assert worn[worn[:, 0] < front + 0.049, 2] == pytest.approx(0.507, abs=1e-12)
    assert worn[worn[:, 0] > front + 0.051, 2] == pytest.approx(0.51, abs=1e-12)
    assert steps[2].height_m == pytest.approx(0.51, abs=1e-12)


def test_flights_are_parted_by_the_landing():
    steps = lay_out(Stair(n_risers=9, landing_after=5, landing_depth_m=1.5))
    assert [step.flight for step in steps] == [1] * 5 + [2] * 4
    assert [step.step_id for step in steps if step.kind == "landing"] == [5, 9]
    assert steps[4].going_m == 1.5


@pytest.mark.parametrize("side", ["left", "right", "both"])
def test_walls_stand_beside_the_treads(side):
    building = build(Stair(wall=side, headroom_m=2.2))
    wall = vertices_of(building, "wall")
    assert wall[:, 2].max() == pytest.approx(1.7 + 2.2, abs=1e-12)
    assert (wall[:, 1].max() > 0.6) == (side in ("left", "both"))
    assert (wall[:, 1].min() < -0.6) == (side in ("right", "both"))
    assert np.abs(np.abs(wall[:, 1]) - 0.6).max() < 0.002


def test_ceiling_and_clutter_are_there_only_when_asked_for():
    plain, full = build(Stair()), build(Stair(ceiling=True, clutter=True))
    assert {surface.part for surface in plain.surfaces} == {"floor", "tread", "landing", "riser", "nosing", "side"}
    ceiling = vertices_of(full, "ceiling")
    assert ceiling[:, 2] == pytest.approx(1.7 + 2.3, abs=1e-12)
    table = vertices_of(full, "clutter")
    assert np.isclose(table[:, 2], 0.75).sum() >= 4
    # The handrail runs 0.9 m above the nosings, up to the landing.
    assert table[:, 2].max() == pytest.approx(1.7 + 0.9, abs=0.05)


def test_output_frame_has_yaw_and_offset():
    stair = Stair(yaw_deg=90.0, offset_m="691000,5335000,520")
    moved = output_from_stair(stair, np.array([[2.0, 0.5, 1.0]]))
    assert moved[0] == pytest.approx([691000.0 - 0.5, 5335000.0 + 2.0, 521.0], abs=1e-9)


@pytest.mark.parametrize("open_risers", [False, True])
def test_every_triangle_has_area_and_a_surface(open_risers):
    everything = Stair(n_risers=4, clutter=True, ceiling=True, wall="left", landing_after=2, dish_errors_m="1:0.004")
    building = build(dataclasses.replace(everything, open_risers=open_risers, overhang_m=0.0))
    assert building.surface_of.max() == len(building.surfaces) - 1
    assert np.asarray(building.mesh.area_faces).min() > 1e-6


TURNING = [
    Stair(n_risers=8, landing_after=4, turn="left", skew_errors_m="5:0.02"),
    Stair(n_risers=8, landing_after=3, turn="u_right", open_risers=True),
    Stair(n_risers=8, landing_after=3, turn="u_left", well_m=0.0, overhang_m=0.0, clutter=True, ceiling=True),
    Stair(n_risers=8, shape="winder", winder_after=0, turn="right"),
    Stair(n_risers=8, shape="winder", open_risers=True, round_nosing_m=0.02, strip_proud_m=0.003),
    Stair(n_risers=18, shape="spiral", overhang_m=0.05, strip_proud_m=0.002, clutter=True, ceiling=True),
    Stair(n_risers=5, shape="spiral", turn="right", open_risers=True, missing_treads="2", round_nosing_m=0.03),
    Stair(n_risers=5, twin_gap_m=0.3, dish_errors_m="2:0.005", strip_proud_m=0.003, skew_errors_m="3:0.04"),
    Stair(n_risers=5, dish_errors_m="2:0.005", round_nosing_m=0.01, wall="both", floor_all_round=True),
    Stair(n_risers=4, open_risers=True, missing_treads="1,2,3", clutter=True),
]


def outline_area(outline):
    x, y = np.array(outline).T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2.0


@pytest.mark.parametrize("stair", TURNING)
def test_tops_cover_the_outlines_of_the_steps(stair):
    building = build(stair)
    assert np.asarray(building.mesh.area_faces).min() > 1e-9
    vertices, faces = np.asarray(building.mesh.vertices), np.asarray(building.mesh.faces)
    labels = np.array([surface.label for surface in building.surfaces])[building.surface_of]
    for step in building.steps:
        tops = vertices[faces[labels == step.step_id]][:, :, :2]
        sides = tops[:, 1:] - tops[:, :1]
        area = np.abs(sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]).sum() / 2.0
        # A rounded edge is not part of the flat top.
        edge = math.dist(*step.plan.front) * stair.round_nosing_m
        wanted = 0.0 if step.is_missing else outline_area(step.plan.outline) - edge
        assert area == pytest.approx(wanted, rel=0.003 if stair.round_nosing_m else 1e-9)


def test_a_proud_strip_carries_the_height():
    building = build(Stair(n_risers=3, strip_proud_m=0.003))
    for step in building.steps:
        top = top_of(building, step)
        front = step.nosing[0][0]
        on_strip = top[:, 0] < front + 0.05 - 1e-9
        assert top[on_strip, 2] == pytest.approx(step.height_m, abs=1e-12)
        assert top[top[:, 0] > front + 0.05 + 1e-9, 2] == pytest.approx(step.height_m - 0.003, abs=1e-12)
        at_the_edge = top[np.abs(top[:, 0] - front - 0.05) < 1e-9, 2]
        assert set(np.round(step.height_m - at_the_edge, 9)) == {0.0, 0.003}
    assert [step.rise_m for step in building.steps] == [0.17] * 3
    # A riser stands on the tread, not on a strip.
    riser = vertices_of(building, "riser", 2)
    assert riser[:, 2].min() == pytest.approx(0.17 - 0.003, abs=1e-12)


def test_a_round_nosing_is_a_quarter_of_a_circle():
    building = build(Stair(n_risers=3, round_nosing_m=0.015))
    for step in building.steps:
        front, height = step.nosing[0][0], step.height_m
        edge = vertices_of(building, "nosing", step.step_id)
        arc = edge[edge[:, 2] > height - 0.015 + 1e-9]
        radius = np.hypot(arc[:, 0] - front - 0.015, arc[:, 2] - height + 0.015)
        assert radius == pytest.approx(0.015, abs=1e-12)
        # Six facets, seven corners; the lowest ends the upright.
        assert len(np.unique(np.round(arc[:, 0], 9))) == 6
        assert edge[:, 0].min() == pytest.approx(front, abs=1e-12)
        assert top_of(building, step)[:, 0].min() == pytest.approx(front + 0.015, abs=1e-12)
        assert step.height_m == pytest.approx(0.17 * step.step_id, abs=1e-12)


def test_floor_lies_all_round_where_asked_for_or_needed():
    plain = vertices_of(build(Stair(n_risers=5, floor_width_m=3.0)), "floor")
    assert (plain[:, 0].max(), plain[:, 1].min(), plain[:, 1].max()) == (0.0, -1.5, 1.5)
    around = vertices_of(build(Stair(n_risers=5, floor_width_m=3.0, floor_all_round=True)), "floor")
    end = 4 * 0.28 - 0.025 + 1.2
    assert around[:, 0].max() == pytest.approx(end + 0.9, abs=1e-12)
    assert (around[:, 1].min(), around[:, 1].max()) == (-1.5, 1.5)
    for stair in TURNING[:7]:
        floor = vertices_of(build(stair), "floor")
        outlines = np.array([corner for step in lay_out(stair) for corner in step.plan.outline])
        beside = (stair.floor_width_m - stair.width_m) / 2.0
        assert (floor[:, :2].min(axis=0) <= outlines.min(axis=0) - beside + 1e-9).all()
        assert (floor[:, :2].max(axis=0) >= outlines.max(axis=0) + beside - 1e-9).all()


def test_a_skew_riser_stands_under_its_nosing():
    building = build(Stair(n_risers=4, skew_errors_m="1:0.02,3:0.03", width_m=1.0))
    for step in building.steps:
        riser = vertices_of(building, "riser", step.step_id)
        for y, (x, _, _) in zip((0.5, -0.5), step.nosing, strict=True):
            assert riser[np.isclose(riser[:, 1], y), 0] == pytest.approx(x + 0.025, abs=1e-12)
    # No gap between the floor and the first riser.
    assert vertices_of(building, "floor")[:, 0].max() == pytest.approx(0.01, abs=1e-12)


def test_a_post_stands_where_wedges_meet():
    spiral = build(Stair(n_risers=6, shape="spiral", spiral_radius_m=0.1, width_m=0.9))
    post = vertices_of(spiral, "post")
    assert post[:, :2].mean(axis=0) == pytest.approx((0.0, 0.55), abs=1e-9)
    assert (post[:, 2].min(), post[:, 2].max()) == pytest.approx((0.0, 6 * 0.17 + 0.9), abs=1e-9)
    winder = vertices_of(build(Stair(n_risers=8, shape="winder", turn="right", width_m=1.0)), "post")
    assert winder[:, :2].mean(axis=0) == pytest.approx((3 * 0.28, -0.5), abs=1e-9)
