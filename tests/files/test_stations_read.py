"""Stations in their own frames, as E57, PTX and PTS deliver them, are measured as the plain cloud is."""

import math
from dataclasses import replace

import numpy as np
import pytest

from stair_inspector.files.ply import ply_bytes
from stair_inspector.files.scans import read_scan
from stair_inspector.simulation.scanner import scan as scan_building
from stair_inspector.simulation.scanner_specs import PROFILES
from stair_inspector.simulation.specs import Stair
from stair_inspector.simulation.staircase import build
from tests.files.station_files import ptx_bytes
from tests.files.test_las import sizes_of
from tests.oracles import HAS_NO_E57, needs_e57
from tests.synthetic import rotation

if not HAS_NO_E57:
    from tests.files.e57_files import XYZ, doubles, e57_bytes, station

STAIR = Stair(n_risers=6, rise_m=0.17, going_m=0.29, width_m=1.1, floor_front_m=2.0, upper_landing_m=1.4)
SCANNER = replace(
    PROFILES["tls_good"], azimuth_step_deg=0.3, elevation_step_deg=0.3, spacing_m=0.02, standoff_m=1.8, seed=4
)
QUATERNIONS = (
    (math.cos(0.35), 0.0, 0.0, math.sin(0.35)),
    (0.5, 0.5, -0.5, 0.5),
)
TURNS = (rotation("z", math.degrees(0.7)), np.array([[0.0, -1.0, 0.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]]))
"""The same as matrices."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("stations")


@pytest.fixture(scope="module")
def scanned():
    """The points of two stations in one frame, and where each stood."""
    made = scan_building(build(STAIR), SCANNER)
    return [made.points[made.station_ids == k] for k in (0, 1)], [np.array(each.position) for each in made.stations]


@pytest.fixture(scope="module")
def plain(folder, scanned):
    """The values of the plain PLY: of both stations, and of the second alone."""
    points, _ = scanned
    found = []
    for name, of in (("both.ply", np.concatenate(points)), ("second.ply", points[1])):
        (folder / name).write_bytes(ply_bytes(of))
        found.append(sizes_of(read_scan(folder / name, "m")))
    return found


def in_own_frames(scanned):
    """The points of each station as it saw them: the station at zero, turned."""
    points, places = scanned
    return [(own - place) @ turn for own, place, turn in zip(points, places, TURNS, strict=True)]


def written(folder, form, scanned):
    _, places = scanned
    own = in_own_frames(scanned)
    if form == "e57":
        stations = [station(doubles(XYZ, own[k]), f"Setup {k + 1}", QUATERNIONS[k], places[k]) for k in range(len(own))]
        e57_bytes(folder / "a.e57", *stations)
    else:
        (folder / "a.ptx").write_bytes(ptx_bytes(*zip(own, TURNS, places, strict=True)))
    return folder / f"a.{form}"


E57 = pytest.param("e57", marks=needs_e57)


@pytest.mark.parametrize("form", [E57, "ptx"])
def test_two_stations_are_the_points_of_the_plain_cloud(folder, scanned, form):
    path = written(folder, form, scanned)
    points, places = scanned
    both, second = read_scan(path, "m"), read_scan(path, "m", "2")
    assert np.abs(both.points - np.concatenate(points)).max() < 1e-7
    assert np.abs(both.stations.places_m - places).max() < 1e-9
    assert np.abs(second.points - points[1]).max() < 1e-7


@pytest.mark.parametrize("form", [E57])
def test_two_stations_are_measured_as_the_plain_cloud(folder, scanned, plain, form):
    path = written(folder, form, scanned)
    both, second = read_scan(path, "m"), read_scan(path, "m", "2")
    for scan, expected in ((both, plain[0]), (second, plain[1])):
        found = sizes_of(scan)
        assert expected.shape == (6, 3, 2)
        assert np.array_equal(np.isnan(found), np.isnan(expected))
        off = np.abs(found - expected)[..., 0] / expected[..., 1]
        assert np.nanmax(off) < 1.0 / 3.0
