"""The inspector's camera while pictures are taken with it: what is done meanwhile starts from where it stood."""

import contextlib

import numpy as np
import pytest

from stair_inspector.pictures.cameras import ORTHO_FOV_RAD, Pose
from stair_inspector.viewer.scene.framing import place_camera
from tests.viewer.parts_of import part_of

AWAY = Pose(np.array([16.0, -25.6, 16.4]), np.array([0.0, 0.5, 0.5]), np.array([0.0, 0.0, 1.0]))
"""Where a picture is taken."""


def stands(session):
    """Where the page's camera stands, what it looks at, and its angle of view."""
    camera = session.desk.client.camera
    return np.array([*camera.position, *camera.look_at, camera.fov])


def turn_by_hand(session):
    """Stand in front of the stair, a little aside."""
    session.look.set_view("Front")
    camera = session.desk.client.camera
    camera.position = np.array(camera.position) + np.array([0.3, 0.2, 0.1])
    return stands(session)


@contextlib.contextmanager
def pictured(session):
    """Take a picture with the camera of a page and put it back, as the studio does."""
    client = session.desk.client
    before, fov_rad = session.look.camera()
    with session.look.lent():
        place_camera(client, AWAY, ORTHO_FOV_RAD)
        try:
            yield
        finally:
            place_camera(client, before, fov_rad)


def switch_ortho(session):
    session.look.set_ortho(True)


def stand_side_by_side(session):
    session.look.set_mode("Side by side")


def go_in_two_ways(session):
    switch_ortho(session)
    stand_side_by_side(session)


def look_along_a_measurement(session):
    part_of(session, "look").measure._look_at(np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 1.0]]))


@pytest.mark.parametrize("act", [switch_ortho, go_in_two_ways, look_along_a_measurement])
def test_what_is_done_while_a_picture_is_taken_ends_where_it_would_without(session, act):
    by_hand = turn_by_hand(session)
    act(session)
    wanted = stands(session)
    session.look.set_mode("Segmented")
    session.look.set_ortho(False)
    np.testing.assert_allclose(turn_by_hand(session), by_hand, atol=1e-6)
    with pictured(session):
        act(session)
    np.testing.assert_allclose(stands(session), wanted, atol=1e-6)
    assert np.abs(wanted - by_hand).max() > 0.1


def test_a_view_that_is_kept_while_a_picture_is_taken_is_the_inspectors(session):
    turn_by_hand(session)
    part_of(session, "look").views.keep()
    with pictured(session):
        part_of(session, "look").views.keep()
    first, second = session.editor.work.views
    for name in ("position_m", "look_at_m", "up", "fov_deg"):
        assert getattr(second, name) == pytest.approx(getattr(first, name), abs=1e-9)


def test_a_view_that_was_turned_by_hand_is_still_that_after_a_picture(session):
    by_hand = turn_by_hand(session)
    with pictured(session):
        pass
    np.testing.assert_allclose(stands(session), by_hand, atol=1e-9)


def test_a_standard_view_that_was_chosen_meanwhile_stays_one(session):
    looking = session.look
    turn_by_hand(session)
    with pictured(session):
        looking.set_view("Top")
    looking.set_mode("Side by side")
    framed = stands(session)
    looking.set_view("Top")
    np.testing.assert_allclose(framed, stands(session), atol=1e-6)


def test_a_standard_view_stays_one_in_a_mode_that_is_chosen_meanwhile(session):
    looking = session.look
    looking.set_view("Front")
    stand_side_by_side(session)
    wanted = stands(session)
    looking.set_mode("Segmented")
    looking.set_view("Front")
    with pictured(session):
        stand_side_by_side(session)
    np.testing.assert_allclose(stands(session), wanted, atol=1e-6)


def test_after_a_picture_the_camera_is_the_pages_again(session):
    turn_by_hand(session)
    with pictured(session):
        pass
    camera = session.desk.client.camera
    camera.position = np.array(camera.position) + 0.25
    np.testing.assert_allclose(session.look.pose().position, camera.position)
