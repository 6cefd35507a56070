"""Files, pictures and sections of a page, on a running server without a browser: the camera's part is played here."""

import contextlib
import io
import math
import threading
import zipfile

import numpy as np
import pytest
from PIL import Image

from stair_inspector.errors import ConfigError
from stair_inspector.pictures.cameras import VIEWS
from stair_inspector.viewer.compute.runs import Progress
from stair_inspector.writers.segmented import segmented_bytes
from tests.viewer.parts_of import part_of
from tests.viewer.wire_page import await_that


@pytest.fixture
def files(session, monkeypatch):
    """What the page downloads, by name."""
    files = {}
    monkeypatch.setattr(
        session.desk.client, "send_file_download", lambda name, data, save_immediately: files.update({name: data})
    )
    return files


@pytest.fixture
def camera(monkeypatch):
    """Takes gray pictures; ``sizes`` of them, and what happens meanwhile, each time, is ``meanwhile``."""

    class Camera:
        def __init__(self):
            self.sizes, self.meanwhile = [], lambda: None

        @contextlib.contextmanager
        def studio(self, desk, width, height):
            def render(pose, fov_rad):
                self.sizes.append((width, height))
                self.meanwhile()
                return np.full((height // 20, width // 20, 4), 90, dtype=np.uint8)

            yield render

    camera = Camera()
    monkeypatch.setattr("stair_inspector.viewer.parts.export.files.studio", camera.studio)
    return camera


def status(session):
    return part_of(session, "frame").state.content


# Pictures.


def test_a_picture_says_what_it_shows_and_all_views_are_in_the_zip(session, files, camera):
    part_of(session, "export").downloads.download("Screenshot PNG")
    part_of(session, "export").downloads.download("All views ZIP")
    assert list(files) == ["stair.png", "stair_views.zip"]
    assert Image.open(io.BytesIO(files["stair.png"])).width == camera.sizes[0][0] // 20
    names = zipfile.ZipFile(io.BytesIO(files["stair_views.zip"])).namelist()
    assert names == [f"stair_{view.lower()}.png" for view in VIEWS]


@pytest.mark.parametrize("kind", ["Screenshot PNG", "All views ZIP"])
@pytest.mark.parametrize("change", ["settings", "colours", "mode"])
def test_no_picture_gets_a_caption_of_something_else(page, session, files, camera, kind, change):
    def settings():
        session.editor.adjust(lambda params: params.replaced("levels.eps_m", 0.033), "eps")
        page.await_result()

    camera.meanwhile = {
        "settings": settings,
        "colours": lambda: session.look.set_color("Height"),
        "mode": lambda: session.look.choose_mode("Raw"),
    }[change]
    with pytest.raises(ConfigError, match="what is shown changed while the picture was made"):
        part_of(session, "export").downloads.download(kind)
    assert files == {}
    assert len(camera.sizes) == 1


def test_the_legend_of_a_picture_has_the_lines_over_the_points_and_raw_points_have_none(session):
    exporting, shown = part_of(session, "export").downloads, session.desk.shown
    words = [words for _, words in exporting._legend(exporting._sit(shown)).entries]
    assert [each for each in ("front edge, nosing", "back edge", "side edges", "centre") if each not in words] == []
    assert any("floor" in each for each in words)
    session.look.choose_mode("Raw")
    legend = exporting._legend(exporting._sit(shown))
    assert (legend.title, legend.entries) == ("colours of the scan; grey where it has none", ())


@pytest.mark.parametrize(("window", "wanted"), [((2090, 1440), (7680, 5291)), ((900, 700), (3600, 2800))])
def test_four_times_a_large_window_is_as_large_as_a_picture_can_be(session, files, camera, window, wanted):
    state = session.desk.client.camera._state
    state.image_width, state.image_height = window
    part_of(session, "export").downloads.size.value = "4 ×"
    part_of(session, "export").downloads.download("Screenshot PNG")
    assert camera.sizes == [wanted]


def test_a_second_picture_is_refused_at_once_and_the_first_can_be_cancelled(session, files, camera):
    gate, has_begun = threading.Event(), threading.Event()

    def wait():
        has_begun.set()
        gate.wait(20.0)

    camera.meanwhile = wait
    first = threading.Thread(
        target=session.desk.notices.guard(part_of(session, "export").downloads.download), args=("All views ZIP",)
    )
    first.start()
    assert has_begun.wait(20.0)
    assert "picture 1 of" in status(session)
    with pytest.raises(ConfigError, match=r"stair_views\.zip is still being made"):
        part_of(session, "export").downloads.download("Screenshot PNG")
    session.cancel()
    first.join(20.0)
    assert not first.is_alive()
    assert "picture 1 of" not in status(session)
    gate.set()
    await_that(lambda: not session.making._one_at_a_time.locked(), "the picture does not end")
    assert files == {}
    assert len(camera.sizes) == 1


def test_the_segmented_scan_is_sent_as_laz_and_as_ply(session, files):
    for kind in ("Segmented LAZ", "Segmented PLY"):
        part_of(session, "export").downloads.download(kind)
    shown = session.desk.shown
    assert files == {
        f"stair_segmented.{form}": segmented_bytes(shown.scan, shown.inspection, form) for form in ("laz", "ply")
    }


# Progress.


def test_the_making_of_a_file_and_a_run_share_the_line_and_neither_wipes_the_other(session, monkeypatch):
    monkeypatch.setattr(session.runs, "is_busy", lambda: True)
    session._progress(Progress("estimating normals …", 20.0))
    session.show_making("picture 1 of 5 …", 0.0)
    assert "picture 1 of 5" in status(session)
    session.show_making(None, 0.0)
    assert "estimating normals" in status(session)
    assert "Cancel" in status(session)
    session.show_making("picture 2 of 5 …", 20.0)
    session._failed("m: is too large")
    assert "picture 2 of 5" in status(session)
    session.show_making(None, 0.0)
    assert "m: is too large" in status(session)
    assert "estimating" not in status(session)


def test_a_suggestion_and_a_debug_ply_can_be_cancelled(session, files, monkeypatch):
    for name, ask in (
        ("stair_inspector.viewer.parts.scan_settings.suggest_settings", part_of(session, "tune").presets.suggest),
        (
            "stair_inspector.viewer.parts.export.files.debug_ply_bytes",
            lambda: part_of(session, "export").downloads.download("Debug PLY"),
        ),
    ):
        gate, has_begun = threading.Event(), threading.Event()

        def wait(*_, gate=gate, has_begun=has_begun):
            has_begun.set()
            gate.wait(20.0)

        monkeypatch.setattr(name, wait)
        asked = threading.Thread(target=session.desk.notices.guard(ask))
        asked.start()
        assert has_begun.wait(20.0)
        await_that(lambda: "making" in status(session), "it does not say what it does")
        session.cancel()
        asked.join(20.0)
        assert not asked.is_alive()
        gate.set()
        await_that(lambda: not session.making._one_at_a_time.locked(), "it does not end")
    assert files == {}
    assert "cancelled" in part_of(session, "tune").presets.suggestion.content


# Sections.


def test_the_section_goes_through_the_step_that_is_chosen(page, session):
    section = part_of(session, "look").section
    section.set_direction("Across")
    section.set_on(True)
    session.desk.select(2)
    await_that(lambda: "the middle of step 2" in section._plot.content, "the section stays where it was")
    session.desk.select(3)
    await_that(lambda: "the middle of step 3" in section._plot.content, "the section stays where it was")
    session.desk.select(None)
    await_that(lambda: "its middle" in section._plot.content, "the section stays where it was")


@pytest.mark.parametrize("slider", ["_place", "_thickness"])
@pytest.mark.parametrize("value", [math.nan, math.inf, 1e9])
def test_an_impossible_place_goes_back_and_stops_no_later_run(page, session, slider, value):
    section = part_of(session, "look").section
    section.set_on(True)
    before = getattr(section, slider).value
    getattr(section, slider)._impl.value = value
    with pytest.raises(ConfigError, match="section: "):
        section._move(0.0)
    assert getattr(section, slider).value == before
    session.editor.adjust(lambda params: params.replaced("levels.eps_m", 0.033), "eps")
    page.await_result()
    assert "section along the stair" in section._plot.content
    assert [words for words in page.told() if "internal error" in words] == []


def test_a_section_is_saved_under_the_name_of_the_scan_and_enlarged(session, files):
    section = part_of(session, "look").section
    section.set_on(True)
    section._do("Save CSV")
    (name,) = files
    assert name == "stair_section_along.csv"
    assert files[name].startswith(b"along_mm,height_mm,step_number\n")
    section._do("Enlarge")
    assert section.put_card_away()
    assert not section.put_card_away()
