"""The region that follows a stair: its box lies along it, and what is measured in it is what is measured without."""

import numpy as np
import pytest

from stair_inspector.geometry.boxes import turned_box
from stair_inspector.overrules import Region, parse_region, region_text
from stair_inspector.params import Params
from stair_inspector.pictures.coloring import dimmed
from stair_inspector.pipeline import inspect
from stair_inspector.quantities import IN_TABLE, with_above
from stair_inspector.stages.orient import region_box
from stair_inspector.viewer.parts.scan.region import _rounded, region_around
from tests.synthetic import Stair, motion, rotation
from tests.test_samples import inspect_sample, load_sample
from tests.viewer.parts_of import part_of


def values_of(inspection):
    """Every value of the table, by step and quantity."""
    return {
        (step.step_id, each.name): each.of(step, above)
        for step, above in with_above(inspection.steps)
        for each in IN_TABLE
    }


@pytest.mark.parametrize(
    "name",
    [
        "ceiling_clutter",
        *(
            pytest.param(name, marks=pytest.mark.slow)
            for name in ("defective_step", "handheld_noisy", "long_landing", "straight")
        ),
    ],
)
def test_the_values_within_the_box_around_a_stair_are_those_without_it(name):
    scan, memo = load_sample(name)
    whole = inspect_sample(name)
    region = region_around(whole)
    within = inspect(scan, Params().replaced("overrules.region", region_text(region)), memo)
    box = region_box(region_text(region), whole.up, scan)
    assert 0.1 < box.holds(scan.points).mean() < 0.999, "something is left out"
    without, found = values_of(whole), values_of(within)
    assert found.keys() == without.keys()
    for place, value in found.items():
        other = without[place]
        assert (value is None) == (other is None)
        if place == (1, "rise") and value is not None:
            # It rests on the floor, of which the box cuts some off.
            assert abs(value.value - other.value) <= other.u / 3.0
        else:
            assert (value and value.value) == (other and other.value), place
    assert [note for note in within.notes if note.code.startswith("region_cuts")] == []


@pytest.mark.parametrize("degrees", [30.0, -60.0, 120.0])
def test_the_box_follows_the_stair_and_not_the_axes_of_the_file(degrees):
    turn = rotation("z", degrees)
    stair = Stair(n_steps=4, noise=0.001, risers=True, motion=motion(turn, (3.0, -2.0, 0.5)))
    inspection = inspect(stair.scan(), Params(up="z", unit="m"))
    region = region_around(inspection)
    assert region.bearing_deg == pytest.approx((degrees + 45.0) % 90.0 - 45.0, abs=0.5)
    assert parse_region(region_text(region)) == region
    box = region_box(region_text(region), inspection.up, stair.scan())
    ahead = turn[:, 0]
    sizes = np.ptp(box.coordinates(box.corners()), axis=0)
    # Along the stair and across it, not along x and y: the step corners with a metre on each side.
    corners = np.concatenate([step.corners for step in inspection.steps]) @ np.array([ahead, turn[:, 1]]).T
    np.testing.assert_allclose(sorted(sizes[:2]), sorted(np.ptp(corners, axis=0) + 2.0), atol=0.02)


def test_what_is_outside_is_drawn_towards_the_ground():
    colors = np.array([[200, 100, 0], [200, 100, 0]], dtype=np.uint8)
    pale = dimmed(colors, np.array([False, True]), (255, 255, 255))
    assert pale.tolist() == [[200, 100, 0], [241, 216, 191]]
    assert colors.tolist()[1] == [200, 100, 0]


def test_the_scene_dims_what_the_box_leaves_out_and_the_bearing_turns_it(page, session):
    tool = part_of(session, "scan").region
    display = session.desk.shown.display
    before = session.look.colors(session.desk.shown, display)
    tool.use_tool("Around the stair")
    shown = page.await_result()
    text = session.editor.work.params.overrules.region
    outside = ~region_box(text, shown.inspection.up, shown.scan).holds(display.points)
    tool.bearing.value = 20.0
    tool.read_numbers()
    assert "another box" in tool.told.content
    tool.apply()
    turned = page.await_result()
    region = parse_region(session.editor.work.params.overrules.region)
    assert region.bearing_deg == 20.0
    outside = ~region_box(region_text(region), turned.inspection.up, turned.scan).holds(display.points)
    assert outside.any()
    now = session.look.colors(turned, display)
    is_same_step = turned.inspection.labels[display.point_ids] == shown.inspection.labels[display.point_ids]
    assert (now[outside & is_same_step].astype(int).sum(axis=1) >= before[outside & is_same_step].sum(axis=1)).all()
    assert (session.look.raw_colors(turned)[~outside] == display.colors[~outside]).all()
    assert (session.look.raw_colors(turned)[outside] != display.colors[outside]).any()
    session.editor.undo()
    page.await_result()
    assert tool.bearing.value == (parse_region(text).bearing_deg or 0.0)


@pytest.mark.parametrize(
    ("given", "shown"), [(300.0, -60.0), (-120.0, 60.0), (90.0, 90.0), (360.0, None), (-0.0, None)]
)
def test_a_bearing_beyond_the_slider_is_that_of_the_same_box(given, shown):
    region = Region((0.0, 0.0, 0.0), (1.0, 2.0, 3.0), given)
    assert _rounded(region).bearing_deg == shown
    corners = [
        turned_box(np.array(each.low), np.array(each.high), np.array([0.0, 0.0, 1.0]), each.bearing_deg).corners()
        for each in (region, _rounded(region))
    ]
    one, two = (each[np.lexsort(each.round(9).T)] for each in corners)
    np.testing.assert_allclose(one, two, atol=1e-12)
