"""Pictures of the scene for a report, while the inspector goes on working: none holds what its caption does not say."""

import contextlib

import numpy as np
import pytest

from stair_inspector.pictures.cameras import FOV_RAD, Pose
from stair_inspector.pictures.report_views import is_residual_map
from stair_inspector.viewer.parts.export import scene_views
from stair_inspector.viewer.scene.framing import place_camera
from stair_inspector.viewer.scene.stage import MODES
from stair_inspector.viewer.scene.step_marks import StepMark
from tests.viewer.parts_of import part_of
from tests.viewer.wire_page import OTHER

_DRAWN = "drawn by the program"


def states(stage):
    """What can be told apart in a scene: what is seen, its colours and sizes, and the words in it."""
    nodes = stage._nodes
    if "/stair" not in nodes:
        return {}
    return {
        "seen": sorted(name for name in nodes if nodes[name].visible),
        "colors": nodes["/stair/segments/cloud"].colors.tobytes(),
        "size": nodes["/stair/raw"].point_size,
        "place": tuple(nodes["/stair/segments"].position),
        "words": [label.text for _, label in stage._per_step if label.visible],
        "rejected": [node.name for node in nodes.labels_in("/stair/segments/rejected")],
    }


@contextlib.contextmanager
def working(session, monkeypatch, act, at=(2,)):
    """While pictures are taken by nobody, act before the picture of a number is rendered; yields what was seen."""
    seen = []

    @contextlib.contextmanager
    def studio(desk, width, height, timeout_s):
        client, stage, camera = desk.client, desk.stage, desk.client.camera
        stood = Pose(np.array(camera.position), np.array(camera.look_at), np.array(camera.up_direction))
        stage.magnify(2.0)

        def render(pose, fov_rad):
            place_camera(client, pose, fov_rad)
            if len(seen) + 1 in at:
                act()
            seen.append(states(stage))
            return np.full((height, width, 4), 255, dtype=np.uint8)

        try:
            yield render
        finally:
            stage.magnify(1.0)
            place_camera(client, stood, FOV_RAD)

    with monkeypatch.context() as patch:
        patch.setattr(scene_views, "studio", studio)
        patch.setattr(scene_views, "residual_views", lambda *_, **__: ())
        yield seen


def taken(session):
    return part_of(session, "export").report.maker.views.take(
        session.desk.shown, "2026-11-22", "Hall", lambda number, n: None
    )


ACTIONS = {
    "a step is chosen": lambda session: session.desk.select(2),
    "other colours": lambda session: session.look.set_color("Height"),
    "dark": lambda session: session.desk.set_theme(True),
    "a section": lambda session: part_of(session, "look").section.set_on(True),
    "larger points": lambda session: session.look.set_point_size(20.0),
    "rejected surfaces": lambda session: part_of(session, "steps").set_rejected(True),
    "another mode": lambda session: session.look.choose_mode("Side by side"),
    "raw": lambda session: session.look.choose_mode("Raw"),
}


SHORTEST = ("a step is chosen", "another mode")


@pytest.mark.parametrize(
    "action", [each if each in SHORTEST else pytest.param(each, marks=pytest.mark.slow) for each in ACTIONS]
)
def test_a_picture_while_which_something_was_drawn_is_taken_again(session, monkeypatch, action):
    with working(session, monkeypatch, lambda: None) as undisturbed:
        at_rest = taken(session)
    with working(session, monkeypatch, lambda: ACTIONS[action](session)) as seen:
        views = taken(session)
    assert [view.key for view in views] == [view.key for view in at_rest]
    assert not any(_DRAWN in view.caption for view in views)
    # The second picture was taken twice: the first of the two was of a scene that changed.
    assert len(seen) == len(undisturbed) + 1
    del seen[1]
    for own, wanted in zip(seen, undisturbed, strict=True):
        own.pop("size")
        wanted.pop("size")
        assert own == wanted


def test_what_is_chosen_while_pictures_are_taken_stays_chosen(session, monkeypatch):
    desk = session.desk

    def act():
        session.desk.select(2)
        session.look.set_point_size(20.0)
        session.look.choose_mode("Raw")

    with working(session, monkeypatch, act):
        taken(session)
    assert (desk.selected, desk.stage.mode) == (2, "Raw")
    assert desk.stage.point_size_m == pytest.approx(0.02)
    assert desk.stage._nodes["/stair/raw"].point_size == pytest.approx(0.02)
    assert desk.stage._nodes["/stair/raw"].visible
    assert not desk.stage._nodes["/stair/segments"].visible
    assert "/stair/segments/selected" in desk.stage._nodes


@pytest.mark.parametrize("mode", MODES)
def test_without_work_meanwhile_the_scene_is_as_before(session, monkeypatch, mode):
    session.look.choose_mode(mode)
    session.desk.select(1)
    before = states(session.desk.stage)
    with working(session, monkeypatch, lambda: None) as seen:
        taken(session)
    assert states(session.desk.stage) == before
    # The raw cloud, then four times the segmentation alone.
    assert ["/stair/raw" in each["seen"] for each in seen] == [True, False, False, False, False]
    assert not any("region" in each["seen"] for each in seen)


def test_the_camera_follows_into_the_mode_that_was_chosen_meanwhile(session, monkeypatch):
    camera = session.desk.client.camera
    session.look.go_to(Pose(np.array([0.0, -5.0, 1.0]), np.array([0.0, 0.5, 0.5]), np.array([0.0, 0.0, 1.0])), FOV_RAD)
    session.look.choose_mode("Side by side")
    followed = np.array(camera.position)
    session.look.choose_mode("Segmented")
    with working(session, monkeypatch, lambda: session.look.choose_mode("Side by side")):
        taken(session)
    assert np.allclose(camera.position, followed, atol=1e-6)


def test_a_view_that_was_chosen_meanwhile_stays(session, monkeypatch):
    camera = session.desk.client.camera
    session.look.set_view("Top")
    wanted = np.array(camera.position)
    session.look.set_view("Home")
    with working(session, monkeypatch, lambda: session.look.set_view("Top")) as seen:
        taken(session)
    # What it showed was drawn for another camera.
    assert len(seen) == 6
    assert np.allclose(camera.position, wanted, atol=1e-6)


def test_without_work_meanwhile_the_camera_goes_back(session, monkeypatch):
    camera = session.desk.client.camera
    session.look.set_view("Top")
    wanted = np.array(camera.position)
    with working(session, monkeypatch, lambda: None):
        taken(session)
    assert np.allclose(camera.position, wanted, atol=1e-6)


@pytest.mark.slow
def test_a_scene_that_keeps_changing_is_drawn_by_the_program_and_said_so_once(session, monkeypatch):
    sizes = iter(range(3, 90))
    with working(session, monkeypatch, lambda: session.look.set_point_size(next(sizes)), at=range(100)):
        views = taken(session)
    drawn = [view.caption for view in views if not is_residual_map(view)]
    assert drawn[0].endswith(f"({_DRAWN}, not taken of the scene: it changed while its pictures were taken)")
    assert all(caption.endswith(f"({_DRAWN})") for caption in drawn[1:])
    assert len(drawn) == 5
    assert not any(_DRAWN in view.caption for view in views if is_residual_map(view))


@pytest.mark.slow
def test_pictures_with_other_marks_than_the_reports_check_are_not_taken(session, monkeypatch):
    def judge_again():
        session.desk.marks = {1: StepMark("bad", "rise outside")}

    with working(session, monkeypatch, judge_again, at=(4,)):
        views = taken(session)
    assert "it changed while its pictures were taken" in views[0].caption


def test_the_same_marks_judged_again_change_nothing(session, monkeypatch):
    session.desk.marks = {1: StepMark("bad", "rise outside")}

    def judge_again():
        session.desk.marks = dict(session.desk.marks)

    with working(session, monkeypatch, judge_again):
        views = taken(session)
    assert not any(_DRAWN in view.caption for view in views)


@pytest.mark.slow
def test_another_scan_ends_the_pictures_of_the_one_before(page, session, monkeypatch):
    camera = session.desk.client.camera

    def act():
        part_of(session, "scan").choose(OTHER)
        page.await_result(OTHER)

    with working(session, monkeypatch, act):
        views = taken(session)
    assert "it changed while its pictures were taken" in views[0].caption
    session.look.go_to(*session.look.gone_to)
    stands = np.array(camera.position)
    session.look.look("Home")
    assert np.allclose(camera.position, stands, atol=1e-6)
