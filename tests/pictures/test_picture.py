"""A picture for a report, checked by its pixels: the view untouched, a scale bar as long as it says, nothing lost."""

import io
import math
import re
import zipfile

import numpy as np
import pytest
from PIL import Image

from stair_inspector.errors import ConfigError
from stair_inspector.pictures.cameras import FOV_RAD, ORTHO_FOV_RAD, VIEWS, Pose, frame_view
from stair_inspector.pictures.coloring import residual_legend
from stair_inspector.pictures.legends import Legend
from stair_inspector.pictures.lettering import Lettering
from stair_inspector.pictures.picture import (
    Caption,
    Scale,
    bar_of,
    check_size,
    picture_png,
    pictures_zip,
    safe_name,
    scale_of,
    size_of,
)
from stair_inspector.pictures.ramps import VIRIDIS

BOX = np.array([[x, y, z] for x in (-0.6, 0.6) for y in (-1.5, 3.0) for z in (0.0, 1.8)])
CAPTION = Caption("Stair B", "scan.ply", "Front", "2026-11-22", "survey · ε_z 20 mm " * 12)
LEGEND = residual_legend(0.005)
WIDTH, HEIGHT = 900, 400
HAS_INK = (24, 26, 30)


def rendered():
    """A view with a red rectangle on a transparent ground."""
    pixels = np.zeros((HEIGHT, WIDTH, 4), dtype=np.uint8)
    pixels[100:300, 200:700] = (255, 0, 0, 255)
    return pixels


def opened(data):
    return np.asarray(Image.open(io.BytesIO(data)))


def place_of(picture):
    """The row at which the view begins: that of the red rectangle less its own."""
    red = (picture[..., 0] == 255) & (picture[..., 1] == 0) & (picture[..., 2] == 0)
    rows = np.nonzero(red.sum(axis=1) == 500)[0]
    assert len(rows) == 200
    return int(rows[0]) - 100


def strips(picture):
    """What lies above and below the view, without its opacity."""
    top = place_of(picture)
    return picture[:top, :, :3].astype(int), picture[top + HEIGHT :, :, :3].astype(int)


def test_the_view_is_as_it_was_rendered_and_nothing_is_written_over_it():
    picture = opened(picture_png(rendered(), CAPTION, LEGEND, Scale(100.0, "mm"), "White"))
    assert picture.shape[1:] == (WIDTH, 3)
    top = place_of(picture)
    view = picture[top : top + HEIGHT]
    assert (view[100:300, 200:700] == (255, 0, 0)).all()
    elsewhere = np.ones((HEIGHT, WIDTH), dtype=bool)
    elsewhere[100:300, 200:700] = False
    assert (view[elsewhere] == 255).all()


def test_a_transparent_picture_is_transparent_where_nothing_is_and_its_letters_are_not():
    picture = opened(picture_png(rendered(), CAPTION, LEGEND, None, "Transparent"))
    assert picture.shape[2] == 4
    top = place_of(picture)
    assert (picture[top + 10, :, 3] == 0).all()
    assert (picture[top + 150, 200:700, 3] == 255).all()
    assert 0.01 < (picture[:top, :, 3] == 255).mean() < 0.5


@pytest.mark.parametrize(("unit", "pixels_per_m"), [("mm", 37.0), ("mm", 412.5), ("mm", 9000.0), ("in", 120.0)])
def test_the_scale_bar_is_as_long_as_its_words_say(unit, pixels_per_m):
    scale = Scale(pixels_per_m, unit)
    length, words = bar_of(scale, 200.0)
    number, name = words.split(" ")
    metres = float(number) * {"mm": 0.001, "m": 1.0, "in": 0.0254, "ft": 0.3048}[name]
    assert length == pytest.approx(metres * pixels_per_m)
    assert 0.35 * 200.0 < length <= 200.0
    caption = Caption("", "a", "", "", "")
    _, below = strips(opened(picture_png(rendered(), caption, None, scale, "White")))
    # The upper outline of the bar: the longest dark run of any row.
    runs = [run_of(row) for row in np.abs(below - HAS_INK).sum(axis=2) < 60]
    assert max(runs) == pytest.approx(length, abs=2)


def run_of(row):
    edges = np.flatnonzero(np.diff(np.concatenate([[False], row, [False]]).astype(int)))
    return int((edges[1::2] - edges[::2]).max(initial=0))


@pytest.mark.parametrize("fov_rad", [FOV_RAD, ORTHO_FOV_RAD])
def test_the_scale_is_that_of_the_camera_at_the_point_looked_at(fov_rad):
    pose = frame_view("Front", BOX, WIDTH / HEIGHT, np.eye(3), fov_rad)
    scale = scale_of(pose, fov_rad, HEIGHT, "mm")
    # A metre across the line of sight, projected as a camera does.
    depth = np.linalg.norm(pose.look_at - pose.position)
    projected = 1.0 / depth / math.tan(fov_rad / 2.0) * HEIGHT / 2.0
    assert scale.pixels_per_m == pytest.approx(projected)


def test_the_bar_says_where_it_holds_because_the_orthographic_look_is_a_perspective_too(monkeypatch):
    pose = frame_view("Front", BOX, WIDTH / HEIGHT, np.eye(3), ORTHO_FOV_RAD)
    to_nearest = np.min((BOX - pose.position) @ (pose.look_at - pose.position)) / np.linalg.norm(
        pose.look_at - pose.position
    )
    assert np.linalg.norm(pose.look_at - pose.position) / to_nearest > 1.05
    written = []
    write = Lettering.write

    def note(pen, x, y, words):
        written.append(words)
        write(pen, x, y, words)

    monkeypatch.setattr(Lettering, "write", note)
    picture_png(rendered(), CAPTION, None, scale_of(pose, ORTHO_FOV_RAD, HEIGHT, "mm"), "White")
    assert any(re.fullmatch(r"\d+ m?m at the point looked at", words) for words in written)


@pytest.mark.parametrize("unit", ["mm", "in"])
def test_the_bar_is_never_longer_than_its_room_however_near_the_camera(unit):
    for pixels_per_m in 10.0 ** np.arange(-3.0, 7.0, 0.37):
        length, words = bar_of(Scale(pixels_per_m, unit), 200.0)
        number, name = words.split(" ")
        metres = float(number) * {"mm": 0.001, "m": 1.0, "in": 0.0254, "ft": 0.3048}[name]
        assert length == pytest.approx(metres * pixels_per_m)
        assert length <= 200.0 * (1.0 + 1e-6)


def test_the_colours_of_the_legend_are_in_the_picture():
    legend = Legend("t", (((1, 200, 3), "one"), ((200, 1, 203), "two")), residual_legend(0.01).ramp)
    _, below = strips(opened(picture_png(rendered(), CAPTION, legend, None, "White")))
    for color in ((1, 200, 3), (200, 1, 203), legend.ramp.colors[0], legend.ramp.colors[-1]):
        assert (below == color).all(axis=2).sum() >= 5
    ramp = Legend("height", ramp=type(legend.ramp)(VIRIDIS, ()))
    _, below = strips(opened(picture_png(rendered(), CAPTION, ramp, None, "White")))
    # From left to right in the order of the scale.
    columns = [np.nonzero((below == color).all(axis=2))[1].mean() for color in (VIRIDIS[0], VIRIDIS[-1])]
    assert columns[0] < columns[1]


def test_a_title_a_date_and_the_settings_leave_ink_and_long_settings_take_more_lines():
    bare = Caption("", "s", "", "", "")
    heights = {}
    for name, caption in (
        ("bare", bare),
        ("settings", Caption("", "s", "", "", CAPTION.settings)),
        ("all", CAPTION),
    ):
        above, below = strips(opened(picture_png(rendered(), caption, None, None, "White")))
        heights[name] = (len(above), len(below), (above.sum(axis=2) < 380).sum())
    assert heights["settings"][1] > heights["bare"][1]
    assert heights["all"][0] > heights["bare"][0]
    assert heights["all"][2] > heights["bare"][2]


def test_a_legend_of_many_entries_is_not_cut_off():
    entries = tuple(((200, k, 77), f"a rather long name of surface {k}") for k in range(24))
    _, below = strips(opened(picture_png(rendered(), CAPTION, Legend("t", entries), Scale(100.0, "in"), "White")))
    assert [k for k in range(24) if not (below == (200, k, 77)).all(axis=2).any()] == []


@pytest.mark.parametrize("size", [(200, 200), (3840, 2160)])
def test_small_and_large_pictures_have_all_of_it(size):
    width, height = size
    pixels = np.full((height, width, 4), 255, dtype=np.uint8)
    picture = opened(picture_png(pixels, CAPTION, LEGEND, Scale(width / 5.0, "mm"), "White"))
    assert picture.shape[1] == width
    assert height < len(picture) < 2.6 * height


def test_the_zip_has_a_picture_for_every_view_each_of_its_own_camera():
    asked = []

    def render(pose, fov_rad):
        asked.append((pose, fov_rad))
        return np.full((4, 4, 4), len(asked), dtype=np.uint8)

    views = [(view, frame_view(view, BOX, 1.5, np.eye(3)), ORTHO_FOV_RAD) for view in VIEWS]
    data = pictures_zip(
        "../stair <1>.ply", views, render, lambda name, pixels, pose, fov: f"{name} {pixels[0, 0, 0]}".encode()
    )
    archive = zipfile.ZipFile(io.BytesIO(data))
    assert archive.namelist() == [f"stair_1_.ply_{view.lower()}.png" for view in VIEWS]
    assert [archive.read(name).decode() for name in archive.namelist()] == [f"{v} {k}" for k, v in enumerate(VIEWS, 1)]
    assert asked == [(pose, fov_rad) for _, pose, fov_rad in views]


def test_a_zip_that_is_stopped_is_none():
    views = [(view, frame_view(view, BOX, 1.5, np.eye(3)), FOV_RAD) for view in VIEWS]
    made = []

    def stop(name):
        if len(made) == 2:
            raise ConfigError("stopped")

    with pytest.raises(ConfigError, match="stopped"):
        pictures_zip("s", views, lambda pose, fov: made.append(pose), lambda *_: b"", stop)
    assert len(made) == 2


@pytest.mark.parametrize(
    ("words", "name"), [("", "stair"), ("../..", "stair"), ("a/b\\c:d", "a_b_c_d"), ("계단", "계단")]
)
def test_names_of_files_have_nothing_that_a_file_system_takes_otherwise(words, name):
    assert safe_name(words) == name


@pytest.mark.parametrize("side", [0, 199, 7681, float("nan"), float("inf"), -5])
def test_an_impossible_size_is_refused(side):
    with pytest.raises(ConfigError, match="picture: height: got"):
        check_size(800, side)
    with pytest.raises(ConfigError, match="picture: width: got"):
        check_size(side, 800)
    assert check_size(800.0, 600.4) == (800, 600)


def test_views_of_one_name_are_all_in_the_zip():
    pose = Pose(np.array([0.0, -5.0, 1.0]), np.zeros(3), np.array([0.0, 0.0, 1.0]))
    views = [(name, pose, 0.8) for name in ("My view", "my view", "My/view", "my_view_2", "Top")]
    finished = iter([b"a", b"b", b"c", b"d", b"e"])
    data = pictures_zip("s", views, lambda pose, fov: None, lambda *_: next(finished))
    archive = zipfile.ZipFile(io.BytesIO(data))
    assert [archive.read(name) for name in archive.namelist()] == [b"a", b"b", b"c", b"d", b"e"]
    assert len(set(archive.namelist())) == 5


@pytest.mark.parametrize(
    ("window", "factor", "wanted"),
    [
        ((800, 600), 2, (1600, 1200)),
        ((2560, 1440), 4, (7680, 4320)),
        ((1000, 3000), 4, (2560, 7680)),
        ((1919.4, 1080.0), 4, (7678, 4320)),
    ],
)
def test_a_picture_is_so_many_times_the_window_or_as_large_as_can_be(window, factor, wanted):
    assert size_of(*window, factor) == wanted


@pytest.mark.parametrize("width", [float("nan"), 0.0, -3.0])
def test_a_window_without_a_size_is_refused(width):
    with pytest.raises(ConfigError, match="picture: width"):
        size_of(width, 600.0, 2)


def test_letters_can_be_larger_for_a_picture_that_is_printed_small():
    heads = []
    for text_scale in (1.0, 2.0):
        above, _ = strips(opened(picture_png(rendered(), CAPTION, None, None, "White", text_scale)))
        heads.append(len(above))
    assert heads[1] == pytest.approx(2 * heads[0], rel=0.05)


def test_a_scale_that_holds_everywhere_is_not_bound_to_a_point(monkeypatch):
    written = []
    write = Lettering.write
    monkeypatch.setattr(Lettering, "write", lambda self, x, y, words: (written.append(words), write(self, x, y, words)))
    picture_png(rendered(), CAPTION, None, Scale(200.0, "mm", is_everywhere=True), "White")
    assert "500 mm" in written
    assert not [words for words in written if "looked at" in words]
