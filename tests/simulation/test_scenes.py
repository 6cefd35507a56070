"""Scenes without a staircase: what stands in them, and that they can be scanned like one."""

import dataclasses

import numpy as np
import pytest

from stair_inspector.simulation.scanner import scan
from stair_inspector.simulation.scanner_specs import PROFILES, Scanner
from stair_inspector.simulation.scenes import SCENES

COARSE = Scanner(
    stations=3,
    azimuth_step_deg=1.0,
    elevation_step_deg=1.0,
    spacing_m=0.0,
    noise_m=0.0,
    mixed_share=0.0,
    dropout_share=0.0,
)
EACH_SCENE = pytest.mark.parametrize("name", sorted(SCENES))


def levels_of(building):
    """Area of level surfaces by height, square metres; heights in mm."""
    mesh = building.mesh
    areas = {}
    for normal, area, corners in zip(mesh.face_normals, mesh.area_faces, mesh.triangles, strict=True):
        if normal[2] ** 2 > 0.999999:
            height = round(float(corners[0][2]) * 1000)
            areas[height] = areas.get(height, 0.0) + float(area)
    return areas


@EACH_SCENE
def test_a_scene_has_no_steps_and_is_seen(name):
    building = SCENES[name]()
    assert (building.steps, building.stair, building.scene) == ((), None, name)
    simulated = scan(building, COARSE)
    assert set(simulated.labels) == {-1, 0}
    floor = simulated.points[simulated.labels == 0]
    assert len(floor) > 1000
    assert np.abs(floor[:, 2]).max() <= 0.51e-5
    assert (simulated.labels == -1).sum() > 200
    low, high = building.mesh.bounds
    assert (simulated.points >= low - 1e-5).all()
    assert (simulated.points <= high + 1e-5).all()
    assert len(simulated.stations) == 3


@EACH_SCENE
def test_a_scene_is_the_same_every_time(name):
    noisy = dataclasses.replace(PROFILES["handheld"], stations=2, azimuth_step_deg=2.0, elevation_step_deg=2.0)
    first, second = scan(SCENES[name](), noisy), scan(SCENES[name](), noisy)
    assert first.points.tobytes() == second.points.tobytes()
    assert first.colors.tobytes() == second.colors.tobytes()


@EACH_SCENE
def test_stations_stand_in_the_open_over_the_ground(name):
    building = SCENES[name]()
    stations = scan(building, COARSE).stations
    low, high = building.mesh.bounds
    for station in stations:
        assert (np.array(station.position[:2]) > low[:2]).all()
        assert (np.array(station.position[:2]) < high[:2]).all()
    assert stations[0].position[2] == COARSE.sensor_height_m
    nearest = scan(building, COARSE).points[:, None, :] - np.array([s.position for s in stations])[None, :, :]
    assert np.linalg.norm(nearest, axis=2).min() > 0.3


def test_furniture_has_the_heights_that_were_asked_for():
    room = levels_of(SCENES["room"]())
    for height in (300, 600, 900, 1200, 450, 740, 890):
        assert room[height] > 0.1, height
    assert levels_of(SCENES["kerb"]())[120] == pytest.approx(0.9)
    assert levels_of(SCENES["deep_kerb"]())[120] == pytest.approx(9.0)
    terrace = levels_of(SCENES["slope_terrace"]())
    # The first terrace's box goes on to the second's front only.
    assert (terrace[450], terrace[900]) == pytest.approx((8.0, 8.0))
    shelves = levels_of(SCENES["shelves"]())
    assert all(shelves[170 * k] == pytest.approx(0.36, abs=0.02) for k in range(1, 11))


def test_a_ramp_climbs_at_six_degrees():
    mesh = SCENES["ramp"]().mesh
    tilts = np.degrees(np.arccos(np.abs(mesh.face_normals[:, 2])))
    sloping = (tilts > 1.0) & (tilts < 89.0)
    assert tilts[sloping] == pytest.approx(6.0, abs=1e-9)
    assert np.asarray(mesh.area_faces)[sloping].sum() == pytest.approx(1.5 * 4.0 / np.cos(np.radians(6.0)))


def test_blocks_are_of_the_sizes_that_were_asked_for():
    building = SCENES["blocks"]()
    heights = [height / 1000 for height in levels_of(building) if height]
    assert len(heights) == 15
    assert 0.1 <= min(heights) <= max(heights) <= 0.5
