"""Pictures taken with the inspector's page: the camera is lent, and given back whatever happens."""

import contextlib
import math
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import viser

from stair_inspector.errors import ConfigError
from stair_inspector.pictures.cameras import FOV_RAD, VIEWS, Pose, frame_view
from stair_inspector.pictures.segmentation import view_from_local
from stair_inspector.viewer.parts.desk import Desk
from stair_inspector.viewer.parts.studio import camera_wxyz, studio
from stair_inspector.viewer.scene.stage import Stage
from tests.viewer.surveyed import surveyed

POSE = Pose(np.array([0.0, -5.0, 1.0]), np.array([0.0, 0.0, 1.0]), np.array([0.0, 0.0, 1.0]))
WIDTH, HEIGHT = 1600, 1000
BOX = np.array([[x, y, z] for x in (-0.6, 0.6) for y in (-1.5, 3.0) for z in (0.0, 1.8)])


class Camera:
    """A camera that, as viser's does, drags the point looked at along when it is moved."""

    def __init__(self):
        self._position, self.look_at = np.array([3.0, 3.0, 3.0]), np.array([0.0, 0.5, 0.0])
        self.up_direction, self.fov, self.image_height = np.array([0.0, 0.0, 1.0]), 1.2, 500

    @property
    def position(self):
        return self._position

    @position.setter
    def position(self, place):
        self.look_at = self.look_at + np.asarray(place) - self._position
        self._position = np.asarray(place)

    def state(self):
        return [*self.position, *self.look_at, *self.up_direction, self.fov]


class Page:
    """A page that renders a picture of one colour, and remembers how it stood when it was asked to."""

    def __init__(self, scene, failure=None):
        self.scene, self.camera, self.local_storage = scene, Camera(), self
        self.asked, self.fences, self._failure = [], 0, failure

    def atomic(self):
        return contextlib.nullcontext()

    def get_item(self, key, timeout):
        self.fences += 1

    def get_render(self, height, width, **how):
        if self._failure is not None:
            raise self._failure
        self.asked.append((self.camera.state(), self.fences, how))
        return np.full((height, width, 4), 9, dtype=np.uint8)


@pytest.fixture(scope="module")
def server():
    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    yield server
    server.stop()


@pytest.fixture
def stage(server):
    _, inspection, display = surveyed()
    stage = Stage(server)
    stage.show_scan(display, view_from_local(inspection), 0.01)
    yield stage
    stage.clear()


def desk_of(page, stage):
    return Desk(page, notices=None, palettes={}, stage=stage)


def test_the_camera_stands_where_the_picture_is_taken_and_goes_back(stage):
    page = Page(stage.client.scene)
    before = page.camera.state()
    with studio(desk_of(page, stage), WIDTH, HEIGHT) as render:
        assert render(POSE, FOV_RAD).shape == (HEIGHT, WIDTH, 4)
        # The window is half as tall: in the picture points need twice the pixels.
        assert stage._nodes["/stair/raw"].point_size == pytest.approx(0.02)
        assert stage.point_size_m == pytest.approx(0.01)
    state, fences, how = page.asked[0]
    assert state == pytest.approx([*POSE.position, *POSE.look_at, *POSE.up, FOV_RAD])
    assert fences >= 2
    assert how["wxyz"] == camera_wxyz(POSE)
    assert (how["fov"], how["transport_format"]) == (FOV_RAD, "png")
    assert math.isfinite(how["timeout"])
    assert page.camera.state() == pytest.approx(before)
    assert stage._nodes["/stair/raw"].point_size == pytest.approx(0.01)


def test_a_size_that_is_chosen_while_the_camera_is_lent_stays_chosen(stage):
    with studio(desk_of(Page(stage.client.scene), stage), WIDTH, HEIGHT):
        stage.set_point_size(0.03)
        assert stage._nodes["/stair/raw"].point_size == pytest.approx(0.06)
    assert stage._nodes["/stair/raw"].point_size == pytest.approx(0.03)


def test_points_are_sized_while_nobody_else_draws(stage, monkeypatch):
    desk, sized = desk_of(Page(stage.client.scene), stage), []

    def magnify(factor):
        sized.append((factor, is_held(desk.lock)))

    monkeypatch.setattr(stage, "magnify", magnify)
    with studio(desk, WIDTH, HEIGHT):
        assert not is_held(desk.lock)
    assert sized == [(2.0, True), (1.0, True)]


def is_held(lock):
    """Whether another thread would have to wait."""
    with ThreadPoolExecutor(1) as other:
        return not other.submit(lambda: lock.acquire(blocking=False) and (lock.release() or True)).result()


def test_the_camera_goes_back_also_where_the_points_have_gone(stage, monkeypatch):
    page = Page(stage.client.scene)
    before = page.camera.state()

    def magnify(factor):
        if factor == 1.0:
            raise RuntimeError("a removed handle")

    monkeypatch.setattr(stage, "magnify", magnify)
    with pytest.raises(RuntimeError, match="removed"), studio(desk_of(page, stage), WIDTH, HEIGHT) as render:
        render(POSE, FOV_RAD)
    assert page.camera.state() == pytest.approx(before)


@pytest.mark.parametrize("failure", [TimeoutError("late"), RuntimeError("gone")])
def test_a_page_that_does_not_deliver_is_a_sentence_and_gets_its_camera_back(stage, failure):
    page = Page(stage.client.scene, failure)
    before = page.camera.state()
    with (
        pytest.raises(ConfigError, match="bring it to the front"),
        studio(desk_of(page, stage), WIDTH, HEIGHT) as render,
    ):
        render(POSE, FOV_RAD)
    assert page.camera.state() == pytest.approx(before)
    assert stage._nodes["/stair/raw"].point_size == pytest.approx(0.01)


@pytest.mark.parametrize(
    "pose",
    [
        Pose(np.zeros(3), np.zeros(3), np.array([0.0, 0.0, 1.0])),
        Pose(np.zeros(3), np.array([0.0, 0.0, 2.0]), np.array([0.0, 0.0, 1.0])),
        Pose(np.zeros(3), np.array([0.0, 1.0, 0.0]), np.zeros(3)),
        Pose(np.full(3, np.nan), np.zeros(3), np.array([0.0, 0.0, 1.0])),
    ],
    ids=["nowhere", "along up", "no up", "no number"],
)
def test_a_camera_that_looks_nowhere_is_a_sentence(pose):
    with pytest.raises(ConfigError, match="picture: the camera looks nowhere, or straight along"):
        camera_wxyz(pose)


@pytest.mark.parametrize("view", VIEWS)
def test_the_camera_of_a_picture_is_turned_as_viser_wants_it(view):
    pose = frame_view(view, BOX, 1.5, np.eye(3))
    turn = viser.transforms.SO3(np.array(camera_wxyz(pose))).as_matrix()
    assert np.linalg.det(turn) == pytest.approx(1.0)
    right, down, forward = turn.T
    np.testing.assert_allclose(
        forward, (pose.look_at - pose.position) / np.linalg.norm(pose.look_at - pose.position), atol=1e-9
    )
    assert float(right @ pose.up) == pytest.approx(0.0, abs=1e-9)
    assert float(down @ pose.up) < 0.0
