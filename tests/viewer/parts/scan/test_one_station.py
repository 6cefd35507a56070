"""The menu of stations: there where a scan has several, re-opens it with one, goes into the project."""

import numpy as np
import pytest

from stair_inspector.errors import ConfigError
from stair_inspector.files.project_files import read_project
from stair_inspector.files.scans import read_scan
from stair_inspector.params import Params
from stair_inspector.viewer.app import App
from stair_inspector.viewer.parts.scan.one_station import ALL
from tests.files.station_files import ptx_bytes
from tests.synthetic import Stair, rotation
from tests.viewer.parts_of import part_of
from tests.viewer.wire_page import WirePage, await_that

PLACES = np.array([[-1.0, 0.3, 1.6], [1.2, 0.7, 2.4]])


@pytest.fixture
def folder(tmp_path, two_stairs):
    points, _ = Stair(risers=True, noise=0.001, spacing=0.03).sample()
    more, _ = Stair(risers=True, noise=0.001, spacing=0.03, seed=5).sample()
    turns = [rotation("z", 40.0), rotation("x", 170.0)]
    own = [(of - place) @ turn for of, place, turn in zip((points, more), PLACES, turns, strict=True)]
    (tmp_path / "two.ptx").write_bytes(ptx_bytes(*zip(own, turns, PLACES, strict=True)))
    (tmp_path / "one.ply").write_bytes((two_stairs / "stair.ply").read_bytes())
    return tmp_path


def test_a_page_opens_two_stations_and_measures_one(folder):
    app = App([folder / "two.ptx", folder / "one.ply"], Params(), port=0)
    try:
        page = WirePage(app)
        both = page.await_result("two.ptx")
        menu = part_of(page.session, "scan").station.menu
        assert menu.visible
        assert (menu.value, menu.options) == (ALL, (ALL, "1: scan 1", "2: scan 2"))
        part_of(page.session, "scan").station.choose("2: scan 2")
        alone = page.await_result("two.ptx")
        expected = read_scan(folder / "two.ptx", station="2")
        assert np.array_equal(alone.scan.points, expected.points)
        assert len(alone.scan.points) < len(both.scan.points)
        assert alone.inspection.params.station == "scan 2"
        assert len(alone.inspection.steps) == len(both.inspection.steps) == 5
        await_that(lambda: menu.value == "2: scan 2", "the menu does not show what is chosen")
        assert menu.options == (ALL, "1: scan 1", "2: scan 2")
        # Another scan begins with all it has, and shows no menu of stations where it has none.
        part_of(page.session, "scan").choose("one.ply")
        assert page.await_result("one.ply").inspection.params.station == ""
        assert not menu.visible
        part_of(page.session, "scan").choose("two.ptx")
        assert page.await_result("two.ptx").inspection.params.station == "scan 2"
        part_of(page.session, "scan").station.choose(ALL)
        assert len(page.await_result("two.ptx").scan.points) == len(both.scan.points)
        page.session.editor.undo()
        page.await_result("two.ptx")
        project = folder / "two.stair.json"
        await_that(lambda: project.exists() and read_project(project).params.station == "scan 2", "it is not saved")
    finally:
        app.stop()


@pytest.mark.parametrize("asked", ["1", "Roof"])
def test_a_number_that_was_given_is_the_menus_choice_and_one_that_is_not_there_is_a_sentence(folder, asked):
    app = App([folder / "two.ptx"], Params(station=asked), port=0, saves_projects=False)
    try:
        page = WirePage(app)
        station, status = part_of(page.session, "scan").station, page.session.desk.status
        if asked == "1":
            assert set(page.await_result("two.ptx").scan.stations.of_point) == {0}
            assert station.menu.value == "1: scan 1"
        else:
            await_that(lambda: "has no station 'Roof'" in (status.error or ""), "nothing is said")
            assert station.menu.value == "Roof"
            station.choose(ALL)
            page.await_result("two.ptx")
            assert station.menu.options == (ALL, "1: scan 1", "2: scan 2")
        with pytest.raises(ConfigError, match="station: got 'Cellar'"):
            station.choose("Cellar")
    finally:
        app.stop()
