"""The tools of a page and how it is looked at, on a running server without a browser."""

from types import SimpleNamespace

import numpy as np
import pytest

from stair_inspector.errors import ConfigError
from stair_inspector.overrules import parse_region
from stair_inspector.viewer.bridge.markup import list_key
from stair_inspector.viewer.scene.stage import MODES
from tests.viewer.parts_of import part_of
from tests.viewer.wire_page import _CAMERA, OTHER, await_that

AROUND = np.array([[-0.01], [0.01]])
"""The box of the whole scan is so much larger, metres."""


def open_scan(page, label):
    part_of(page.session, "scan").choose(label)
    page.await_result(label)


def click(session, row):
    """Shift-click a displayed point from straight above."""
    stage, display = session.desk.stage, session.desk.shown.display
    x, y, z = stage.rotation @ display.points[row]
    event = SimpleNamespace(ray_origin=(x, y, z + 0.05), ray_direction=(0.0, 0.0, -1.0))
    part_of(session, "look").measure._on_click(event)


def order_of(entries, word, number):
    """What the button of a row writes, but for the time."""
    return f"{word} {list_key(entries)} {number}:"


def whole_scan(session):
    scan = session.desk.shown.scan
    points = scan.points + scan.origin_m
    return np.array([points.min(axis=0), points.max(axis=0)])


def numbers(session):
    tab = part_of(session, "scan")
    return np.array([tab.region.low.value, tab.region.high.value])


# Picking.


def test_a_distance_begun_on_one_scan_does_not_end_on_another(page, session):
    measure = part_of(session, "look").measure
    measure.set_mode("Distance")
    click(session, 10)
    assert measure._ruler.waiting is not None
    open_scan(page, OTHER)
    assert measure._ruler.waiting is None
    click(session, 20)
    assert session.editor.work.measurements == ()
    click(session, 400)
    (made,) = session.editor.work.measurements
    scan = session.desk.shown.scan
    for place in made.points_m:
        assert np.linalg.norm(scan.points + scan.origin_m - np.array(place), axis=1).min() < 1e-6


def test_floor_points_picked_on_one_scan_do_not_count_on_another(page, session):
    before = session.editor.work.params.up
    part_of(session, "scan").upright.start("Pick 3 floor points")
    click(session, 10)
    click(session, 400)
    assert "2 of 3" in part_of(session, "scan").upright.hint.content
    open_scan(page, OTHER)
    assert part_of(session, "scan").upright.hint.content == ""
    click(session, 20)
    assert session.editor.work.params.up == before


def test_taking_the_treads_ends_the_picking_of_points(page, session):
    part_of(session, "scan").upright.start("Pick 3 floor points")
    click(session, 10)
    part_of(session, "scan").upright.start("Take the treads")
    assert part_of(session, "scan").upright.hint.content == ""
    up = session.editor.work.params.up
    shown = page.await_result()
    for row in (400, 800, 1200):
        click(session, row)
    assert session.editor.work.params.up == up
    # The boxes and the line below them say what is in use.
    used = [f"{component:.4f}" for component in np.round(shown.inspection.up.vector, 4) + 0.0]
    await_that(
        lambda: f"({', '.join(used)})" in part_of(session, "scan").upright.used.content, "the up in use is not shown"
    )
    assert session.editor.controls._up_vector.value == pytest.approx(shown.inspection.up.vector, abs=1e-5)


# The region of interest.


def test_a_region_has_no_text_field_that_nothing_would_submit(session):
    assert "overrules.region" not in session.editor.controls._controls


def test_the_box_is_the_one_that_counts_after_undo_and_on_another_scan(page, session):
    part_of(session, "scan").region.use_tool("Around the stair")
    page.await_result()
    region = parse_region(session.editor.work.params.overrules.region)
    box = np.array([region.low, region.high])
    np.testing.assert_allclose(numbers(session), box)
    assert "what lies in the box" in part_of(session, "scan").region.told.content
    session.editor.undo()
    page.await_result()
    np.testing.assert_allclose(numbers(session), whole_scan(session) + AROUND, atol=6e-4)
    shown = part_of(session, "scan").region._box
    np.testing.assert_allclose([shown.low, shown.high], numbers(session))
    assert "the whole scan" in part_of(session, "scan").region.told.content
    session.editor.redo()
    page.await_result()
    np.testing.assert_allclose(numbers(session), box)
    open_scan(page, OTHER)
    np.testing.assert_allclose(numbers(session), whole_scan(session) + AROUND, atol=6e-4)


def test_impossible_numbers_of_the_box_are_a_sentence_and_stop_no_later_run(page, session):
    tab = part_of(session, "scan")
    tab.region.is_shown.value = True
    part_of(session, "scan").region.set_shown(True)
    good = part_of(session, "scan").region._box
    tab.region.low.value = (90.0, 90.0, 90.0)
    with pytest.raises(ConfigError, match="low corner must be below that of the high corner"):
        part_of(session, "scan").region.read_numbers()
    assert part_of(session, "scan").region._box == good
    session.editor.adjust(lambda params: params.replaced("up", "z"))
    assert page.await_result().inspection.up.source == "given"
    assert [words for words in page.told() if "internal error" in words] == []
    assert len(part_of(session, "scan").region._handles) == 2


def test_numbers_that_are_being_written_stay_until_they_are_applied(page, session):
    tab = part_of(session, "scan")
    low, high = numbers(session)
    tab.region.low.value = tuple(low - 1.0)
    part_of(session, "scan").region.read_numbers()
    session.editor.change("something else", title="Hall")
    np.testing.assert_allclose(numbers(session)[0], low - 1.0)
    part_of(session, "scan").region.apply()
    page.await_result()
    region = parse_region(session.editor.work.params.overrules.region)
    np.testing.assert_allclose([region.low, region.high], [low - 1.0, high])


@pytest.mark.parametrize("place", [np.nan, np.inf, 1e200])
def test_a_handle_that_is_moved_to_nowhere_leaves_the_box(page, session, place):
    region = part_of(session, "scan").region
    region.is_shown.value = True
    region.set_shown(True)
    box = region._box
    region._handles[0].position = (place, 0.0, 0.0)
    with pytest.raises(ConfigError, match="a corner cannot be moved beyond"):
        region._on_drag(SimpleNamespace(phase="end"))
    assert region._box == box
    assert numbers(session).tolist() == [list(box.low), list(box.high)]
    assert np.isfinite([handle.position for handle in region._handles]).all()


# Views.


def test_a_kept_view_gets_a_name_of_its_own_and_can_be_gone_to_again_and_again(session):
    views, camera = part_of(session, "look").views, session.desk.client.camera
    views.keep()
    first = np.array(camera.position)
    session.look.set_view("Top")
    views.keep()
    views.obey(order_of(session.editor.work.views, "delete", 1))
    views.keep()
    assert [view.name for view in session.editor.work.views] == ["View 2", "View 1"]
    views._name.value = "View 2"
    with pytest.raises(ConfigError, match="the name 'View 2' is taken"):
        views.keep()
    assert len(session.editor.work.views) == 2
    for time in range(2):
        session.look.set_view("Home")
        views.obey(f"{order_of(session.editor.work.views, 'show', 1)}{time}")
        assert np.linalg.norm(camera.position - first) > 0.5
        assert camera.look_at[2] < camera.position[2]
    with pytest.raises(ConfigError, match="kept views: the list has changed since"):
        views.obey(order_of(session.editor.work.views, "show", 3))


def test_a_second_click_on_a_cross_deletes_no_other_view(session):
    views = part_of(session, "look").views
    for _ in range(3):
        views.keep()
    first, twice = (
        order_of(session.editor.work.views, "delete", 1),
        order_of(session.editor.work.views, "delete", 1) + "7",
    )
    assert first in views._list.content
    views.obey(first)
    with pytest.raises(ConfigError, match="kept views: the list has changed since; choose the row once more"):
        views.obey(twice)
    assert [view.name for view in session.editor.work.views] == ["View 2", "View 3"]
    views.obey(order_of(session.editor.work.views, "delete", 2))
    assert [view.name for view in session.editor.work.views] == ["View 2"]


def test_a_second_click_on_a_cross_deletes_no_other_measurement(session):
    measure = part_of(session, "look").measure
    measure.set_mode("Point")
    for row in (10, 400, 800):
        click(session, row)
    order = order_of(session.editor.work.measurements, "delete", 1)
    assert order in measure._list.content
    measure.obey(order)
    for late in (order, order.replace("delete", "show")):
        with pytest.raises(ConfigError, match="measurements: the list has changed since; choose the row once more"):
            measure.obey(f"{late}7")
    assert [entry.name for entry in session.editor.work.measurements] == ["Point 2", "Point 3"]


def test_a_name_of_a_view_is_used_once(session):
    views = part_of(session, "look").views
    views._name.value = " hand  rail "
    views.keep()
    views.keep()
    assert [view.name for view in session.editor.work.views] == ["hand rail", "View 1"]
    assert "hand rail" in views._list.content


def test_raw_and_steps_are_seen_from_the_same_spot(session):
    looking, camera = session.look, session.desk.client.camera

    def place():
        return np.array([camera.position, camera.look_at])

    camera.position = np.array(camera.position) + np.array((0.3, 0.2, 0.1))
    camera.look_at = np.array([0.1, 0.4, 0.3])
    before = place()
    for mode in MODES:
        looking.set_mode(mode)
        np.testing.assert_allclose(place(), before)


def test_a_standard_view_shows_all_of_the_stair_in_each_half(session):
    looking = session.look
    looking.set_view("Front")
    whole = np.linalg.norm(looking.pose().position - looking.pose().look_at)
    looking.set_mode("Side by side")
    assert np.linalg.norm(looking.pose().position - looking.pose().look_at) > 1.2 * whole
    assert all(is_seen(session, corner, share=0.5) for corner in session.desk.stage.extent)
    looking.set_mode("Swipe")
    assert all(is_seen(session, corner) for corner in session.desk.stage.extent)
    np.testing.assert_allclose(np.linalg.norm(looking.pose().position - looking.pose().look_at), whole)
    looking.set_mode("Segmented")
    looking.set_view("Home")


def is_seen(session, place, share=1.0):
    """Whether a place of the view lies in the picture, or in the middle share of its width."""
    camera = session.desk.client.camera
    away = np.array(camera.position) - camera.look_at
    away /= np.linalg.norm(away)
    right = np.cross(camera.up_direction, away)
    right /= np.linalg.norm(right)
    offset = np.array(place) - camera.position
    depth, tan = -offset @ away, np.tan(camera.fov / 2.0)
    wide, tall = abs(offset @ right), abs(offset @ np.cross(away, right))
    return depth > 0.0 and wide <= share * depth * tan * camera.aspect and tall <= depth * tan


def test_the_orthographic_look_keeps_the_size_after_another_angle_of_view(session):
    looking, camera = session.look, session.desk.client.camera
    looking.set_view("Side")
    seen = np.linalg.norm(np.array(camera.position) - camera.look_at) * np.tan(camera.fov / 2.0)
    pose = looking.pose()
    away = pose.position - pose.look_at
    # As a section does: nearly parallel, from far away.
    narrow = 0.1
    pose.position[:] = pose.look_at + away * np.tan(camera.fov / 2.0) / np.tan(narrow / 2.0)
    looking.go_to(pose, narrow)
    looking.set_ortho(True)
    now = np.linalg.norm(np.array(camera.position) - camera.look_at) * np.tan(camera.fov / 2.0)
    assert now == pytest.approx(seen, rel=1e-6)
    looking.set_ortho(False)


def test_standard_views_frame_the_stair_and_not_all_of_a_large_scan(session):
    looking, stage = session.look, session.desk.stage
    stage.extent = stage.extent * 20.0

    def distance():
        pose = looking.pose()
        return np.linalg.norm(pose.position - pose.look_at)

    part_of(session, "look").views.look_at("Whole scan")
    far = distance()
    part_of(session, "look").views.look_at("Whole stair")
    assert distance() < 0.3 * far
    steps = np.concatenate([step.corners for step in session.desk.inspection.steps])
    assert all(is_seen(session, place) for place in steps @ stage.rotation.T)
    with pytest.raises(ConfigError, match="look at: got 'moon'"):
        part_of(session, "look").views.look_at("moon")


def test_a_scene_without_a_height_stops_nothing(page, session):
    page._send(_CAMERA | {"image_height": 0})
    await_that(lambda: session.desk.client.camera.image_height == 0, "the camera has not come")
    for view in ("Home", "Front", 1):
        session.look.look(view)
    session.editor.adjust(lambda params: params.replaced("up", "z"))
    page.await_result()
    assert [words for words in page.told() if "internal error" in words] == []


# What shows which is on.


def test_buttons_show_which_of_them_is_on(page, session):
    measure, frame = part_of(session, "look").measure, part_of(session, "frame")
    docked = part_of(session, "docked")

    def filled(choice):
        return int(choice._mark.content.partition("nth-child(")[2].partition(")")[0]) - 1

    def pressed(html=frame.toolbar):
        parts = html.content.split("<button")[1:]
        return [part.partition("</button>")[0].rpartition(">")[2] for part in parts if 'aria-pressed="true"' in part]

    assert [filled(measure._mode), pressed(docked.html)] == [0, ["Survey"]]
    assert pressed() == ["Segmented", "mm"]
    measure.next_mode()
    session.look.choose_mode("Raw")
    session.desk.set_unit("in")
    docked.set_view("Paper")
    part_of(session, "look").section.set_direction("Across")
    assert [filled(measure._mode), pressed(docked.html)] == [1, ["Paper"]]
    assert [filled(part_of(session, "look").views._mode), filled(part_of(session, "look").section._cut)] == [0, 1]
    assert pressed() == ["Raw", "in"]
    assert frame.toolbar.content.count('aria-pressed="false"') == 4


def test_there_is_one_help_card_and_escape_closes_it(session):
    gui = session.desk.client.gui
    commands = {command.label: command.action for command in session.commands()}
    before = len(gui._modal_handle_from_uuid)
    session.desk.select(1)
    commands["This help"]()
    assert len(gui._modal_handle_from_uuid) == before + 1
    commands["Put the selection or tool away"]()
    assert len(gui._modal_handle_from_uuid) == before
    assert session.desk.selected == 1
    for _ in range(3):
        commands["This help"]()
    assert len(gui._modal_handle_from_uuid) == before + 1
