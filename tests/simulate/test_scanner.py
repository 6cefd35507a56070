"""The simulated scanner: exact without errors, and wrong by as much as it is told."""

import dataclasses
import math

import numpy as np
import pytest

from stair_inspector.simulate.scanner import _Caster, scan
from stair_inspector.simulate.specs import PROFILES, Scanner, Stair
from stair_inspector.simulate.staircase import build

EXACT = Scanner(
    stations=3,
    azimuth_step_deg=0.6,
    elevation_step_deg=0.6,
    spacing_m=0.0,
    noise_m=0.0,
    mixed_share=0.0,
    dropout_share=0.0,
)
"""A coarse grid and no errors: what remains is the rounding to 0.01 mm."""


def exact(**changes):
    return dataclasses.replace(EXACT, **changes)


def parts_of(simulated):
    names = np.array([surface.part for surface in simulated.building.surfaces])
    return names[simulated.surface_ids]


def ranges_of(simulated):
    """Range of every point from the true position of its station, metres; for scans in the stair frame."""
    positions = np.array([station.position for station in simulated.stations])[simulated.station_ids]
    return np.linalg.norm(simulated.points - positions, axis=1)


def true_ranges_of(simulated):
    """Range to the nearest triangle along each point's direction: brute force over all triangles, float64."""
    mesh = simulated.building.mesh
    origins = np.array([station.position for station in simulated.stations])[simulated.station_ids]
    rays = simulated.points - origins
    rays /= np.linalg.norm(rays, axis=1)[:, None]
    nearest = np.full(len(rays), np.inf)
    for a, b, c in np.asarray(mesh.triangles):
        e1, e2 = b - a, c - a
        p = np.cross(rays, e2)
        det = p @ e1
        with np.errstate(divide="ignore", invalid="ignore"):
            u = np.einsum("ij,ij->i", origins - a, p) / det
            q = np.cross(origins - a, e1)
            v = np.einsum("ij,ij->i", rays, q) / det
            t = (q @ e2) / det
        hit = (np.abs(det) > 1e-12) & (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (t > 0.0)
        nearest[hit] = np.minimum(nearest[hit], t[hit])
    return nearest


@pytest.fixture(scope="module")
def plain():
    return scan(build(Stair(n_risers=6)), EXACT)


def test_noise_free_points_lie_on_their_treads(plain):
    for step in plain.building.steps:
        top = plain.points[plain.labels == step.step_id]
        assert len(top) > 50
        # Half a unit of the rounding, and a hair.
        assert np.abs(top[:, 2] - step.height_m).max() <= 0.51e-5
        assert top[:, 0].min() >= step.nosing[0][0] - 1e-5
        assert top[:, 0].max() <= step.nosing[0][0] + step.tread_depth_m + 1e-5
        assert np.abs(top[:, 1]).max() <= step.width_m / 2 + 1e-5
    floor = plain.points[plain.labels == 0]
    assert np.abs(floor[:, 2]).max() <= 0.51e-5


def test_noise_free_risers_and_nosings_lie_on_their_faces(plain):
    parts = parts_of(plain)
    for part, overhang in (("riser", 0.025), ("nosing", 0.0)):
        x = plain.points[parts == part][:, 0]
        faces = np.array([step.nosing[0][0] + overhang for step in plain.building.steps])
        distance = np.abs(x[:, None] - faces[None, :]).min(axis=1)
        # A nosing's underside lies between its faces.
        upright = distance < 1e-4
        assert upright.mean() > 0.9
        assert distance[upright].max() <= 0.51e-5


def test_first_surface_along_the_ray_is_the_one_seen():
    simulated = scan(build(Stair(n_risers=4, clutter=True, open_risers=True, wall="left")), exact(stations=2))
    # Rounding moves a ray sideways by 0.007 mm, which matters only beside edges.
    off = np.abs(ranges_of(simulated) - true_ranges_of(simulated))
    assert (off < 1e-4).mean() > 0.998


def test_open_risers_let_rays_through_and_closed_ones_do_not():
    stair = Stair(n_risers=6, open_risers=True)
    opened = scan(build(stair), EXACT)
    closed = scan(build(dataclasses.replace(stair, open_risers=False)), EXACT)
    assert "riser" not in parts_of(opened)
    behind = (opened.labels == 0) & (opened.points[:, 0] > 0.3)
    assert behind.sum() > 100
    assert (closed.points[closed.labels == 0][:, 0] <= 1e-5).all()


def test_every_part_of_a_furnished_site_is_seen():
    stair = Stair(n_risers=6, landing_after=3, wall="both", ceiling=True, clutter=True)
    simulated = scan(build(stair), EXACT)
    seen = set(parts_of(simulated))
    assert {"floor", "tread", "landing", "riser", "nosing", "wall", "ceiling", "clutter"} <= seen
    assert (simulated.labels[np.isin(parts_of(simulated), ["wall", "ceiling", "clutter", "riser"])] == -1).all()
    assert set(simulated.labels) == {-1, 0, 1, 2, 3, 4, 5, 6}


def test_range_noise_has_the_stated_sigma():
    sigma = 0.004
    clean = scan(build(Stair(n_risers=5)), EXACT)
    noisy = scan(build(Stair(n_risers=5)), exact(noise_m=sigma, incidence_gain=0.0))
    error = ranges_of(noisy) - ranges_of(clean)
    n = len(error)
    assert n > 10_000
    # Four standard errors of a mean and of a standard deviation of n normal values.
    assert abs(error.mean()) < 4.0 * sigma / math.sqrt(n)
    assert abs(error.std() - sigma) < 4.0 * sigma / math.sqrt(2 * n)
    # Along the ray only.
    origins = np.array([station.position for station in clean.stations])[clean.station_ids]
    sideways = np.cross(noisy.points - origins, clean.points - origins) / ranges_of(clean)[:, None]
    assert np.abs(sideways).max() < 2.5e-5


def test_noise_grows_at_grazing_incidence():
    clean = scan(build(Stair(n_risers=5)), EXACT)
    noisy = scan(build(Stair(n_risers=5)), exact(noise_m=0.001, incidence_gain=1.0))
    error = ranges_of(noisy) - ranges_of(clean)
    origins = np.array([station.position for station in clean.stations])[clean.station_ids]
    is_floor = clean.labels == 0
    cosine = (origins[:, 2] - clean.points[:, 2])[is_floor] / ranges_of(clean)[is_floor]
    # With a gain of 1 sigma is noise / cosine: scaled back it is the noise again.
    scaled = error[is_floor] * np.maximum(cosine, 0.1)
    assert abs(scaled.std() - 0.001) < 4.0 * 0.001 / math.sqrt(2 * is_floor.sum())


def test_correlated_noise_keeps_its_sigma_and_joins_neighbours():
    building = build(Stair(n_risers=2))
    clean = scan(building, exact(stations=1))
    rough = scan(building, exact(stations=1, noise_m=0.004, incidence_gain=0.0, noise_patch_rays=5))
    error = ranges_of(rough) - ranges_of(clean)
    # About 25 rays share a patch: so much fewer independent values.
    assert abs(error.std() - 0.004) < 4.0 * 0.004 / math.sqrt(2 * len(error) / 25)
    neighbours = np.corrcoef(error[:-1], error[1:])[0, 1]
    assert neighbours > 0.6


def test_dropouts_have_the_stated_share():
    building = build(Stair(n_risers=5))
    n = len(scan(building, EXACT).points)
    left = len(scan(building, exact(dropout_share=0.2)).points)
    assert abs(left - 0.8 * n) < 4.0 * math.sqrt(n * 0.2 * 0.8)


def test_mixed_pixels_lie_between_two_surfaces_and_only_beside_jumps():
    building = build(Stair(n_risers=6, clutter=True))
    clean = scan(building, EXACT)
    mixed = scan(building, exact(mixed_share=1.0, beam_m=0.2))
    assert mixed.is_mixed.sum() > 100
    assert not clean.is_mixed.any()
    assert (mixed.labels[mixed.is_mixed] == -1).all()
    # All else stays as it is.
    assert np.array_equal(mixed.points[~mixed.is_mixed], clean.points[~mixed.is_mixed])
    # A neighbour in the grid is at most 0.6 degrees away; across it lies the other surface, and the point between.
    origins = np.array([station.position for station in clean.stations])
    for index, origin in enumerate(origins):
        here = clean.station_ids == index
        rays = clean.points[here] - origin
        ranges = np.linalg.norm(rays, axis=1)
        rays /= ranges[:, None]
        for ray, measured in zip(
            (clean.points[here & mixed.is_mixed] - origin),
            np.linalg.norm(mixed.points[here & mixed.is_mixed] - origin, axis=1),
            strict=True,
        ):
            own = np.linalg.norm(ray)
            # Chord of the step, with room for the rounding.
            near = np.linalg.norm(rays - ray / own, axis=1) < 2.0 * math.sin(math.radians(0.6 / 2.0)) + 1e-4
            # The surface across is met on this ray, not on the neighbour's: at most 15 % farther or nearer.
            low, high = ranges[near].min(), ranges[near].max()
            assert high - low > 0.005
            assert low / 1.15 <= measured <= high * 1.15


def test_plain_inner_corners_and_grazing_floors_make_no_mixed_pixels():
    # From in front and below the first nosing's edge there is no jump at all: floor, riser, and no overhang.
    stair = Stair(n_risers=1, overhang_m=0.0, floor_width_m=1.2)
    low = exact(stations=1, sensor_height_m=0.1, mixed_share=1.0, beam_m=0.2, elevation_high_deg=2.0)
    simulated = scan(build(stair), low)
    assert len(simulated.points) > 1000
    assert not simulated.is_mixed.any()


def test_spacing_thins_to_one_point_in_a_square():
    building = build(Stair(n_risers=3))
    fine = exact(azimuth_step_deg=0.2, elevation_step_deg=0.2, spacing_m=0.05)
    simulated = scan(building, fine)
    for surface in np.unique(simulated.surface_ids):
        points = simulated.points[simulated.surface_ids == surface]
        flat = points[:, np.ptp(points, axis=0) > 1e-4]
        if flat.shape[1] != 2:
            continue
        squares = np.floor(flat / 0.05)
        # Rounding can carry a point over the border of its square.
        assert len(np.unique(squares, axis=0)) >= 0.99 * len(squares)
    # Thinning takes a subset; what is left covers the floor: 1.8 m by 2 m, but for the blind spot under the tripod.
    everything = scan(building, dataclasses.replace(fine, spacing_m=0.0))
    floor = simulated.points[simulated.labels == 0]
    assert len(everything.points) > 5 * len(simulated.points)
    assert 0.9 < len(floor) * 0.05**2 / (1.8 * 2.0) <= 1.05


def test_no_more_points_than_asked_for():
    building = build(Stair(n_risers=3))
    everything, some = scan(building, EXACT), scan(building, exact(max_points=500))
    assert len(some.points) == 500
    rows = {tuple(row) for row in everything.points.tolist()}
    assert all(tuple(row) in rows for row in some.points.tolist())


def test_registration_shifts_whole_stations_but_the_first():
    building = build(Stair(n_risers=4))
    clean, shifted = scan(building, EXACT), scan(building, exact(registration_m=0.005))
    for index, station in enumerate(shifted.stations):
        here = shifted.station_ids == index
        moved = (shifted.points - clean.points)[here]
        assert np.abs(moved - np.array(station.shift_m)).max() < 1.1e-5
    assert shifted.stations[0].shift_m == (0.0, 0.0, 0.0)
    assert all(0.0 < math.hypot(*station.shift_m) < 0.03 for station in shifted.stations[1:])


def test_tilt_turns_about_the_station():
    building = build(Stair(n_risers=4))
    clean, tilted = scan(building, EXACT), scan(building, exact(tilt_deg=0.5))
    assert ranges_of(tilted) == pytest.approx(ranges_of(clean), abs=2e-5)
    for index, station in enumerate(tilted.stations):
        here = tilted.station_ids == index
        floor = tilted.points[here & (clean.labels == 0)]
        _, _, axes = np.linalg.svd(floor - floor.mean(axis=0), full_matrices=False)
        assert math.acos(min(1.0, abs(axes[2, 2]))) == pytest.approx(abs(station.tilt_rad), abs=2e-5)


def test_drift_grows_with_the_way_and_scale_with_the_distance():
    building = build(Stair(n_risers=4))
    drifting = scan(building, exact(stations=4, drift_m_per_m=0.01))
    positions = np.array([station.position for station in drifting.stations])
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(positions, axis=0), axis=1))])
    shifts = np.array([math.hypot(*station.shift_m) for station in drifting.stations])
    assert shifts == pytest.approx(0.01 * way, abs=1e-12)
    scaled = scan(building, exact(scale_percent=1.0))
    assert scaled.points == pytest.approx(scan(building, EXACT).points * 1.01, abs=1.1e-5)


def test_stations_stand_on_what_is_under_them():
    simulated = scan(build(Stair(n_risers=10)), exact(stations=5, sensor_height_m=1.5))
    heights = np.array([station.position[2] - 1.5 for station in simulated.stations])
    assert heights[0] == 0.0
    assert heights[-1] == pytest.approx(1.7, abs=1e-12)
    treads = {0.0} | {round(step.height_m, 9) for step in simulated.building.steps}
    assert {round(float(height), 9) for height in heights} <= treads
    assert (np.diff(heights) >= 0.0).all()


def test_same_seed_same_bytes_other_seed_other_points():
    building = build(Stair(n_risers=3))
    noisy = dataclasses.replace(PROFILES["handheld"], stations=3)
    first, second = scan(building, noisy), scan(building, noisy)
    assert first.points.tobytes() == second.points.tobytes()
    assert first.colors.tobytes() == second.colors.tobytes()
    other = scan(building, dataclasses.replace(noisy, seed=99))
    assert first.points.tobytes() != other.points.tobytes()


def test_rays_past_an_edge_do_not_depend_on_single_precision():
    building = build(Stair(n_risers=3))
    caster = _Caster(building)
    nosing_x, nosing_z = -0.025, 0.17
    origin = (-1.5, 0.0, 1.0)
    # Two rays 0.1 micrometres above and below the first nosing's front edge: tread and nosing face.
    rays = []
    for offset in (-1e-7, 1e-7):
        ray = np.array([nosing_x - origin[0], 0.013, nosing_z + offset - origin[2]])
        rays.append(ray / np.linalg.norm(ray))
    hits = caster.cast(origin, np.array(rays)[:, None, :])[:, 0]
    parts = [building.surfaces[caster.surface_of[hit]].part for hit in hits]
    assert parts == ["nosing", "tread"]


@pytest.mark.parametrize("name", sorted(PROFILES))
def test_every_profile_sees_a_stair(name):
    coarse = dataclasses.replace(
        PROFILES[name],
        azimuth_step_deg=max(0.5, PROFILES[name].azimuth_step_deg),
        elevation_step_deg=max(0.5, PROFILES[name].elevation_step_deg),
    )
    simulated = scan(build(Stair(n_risers=5)), coarse)
    counts = np.bincount(simulated.labels + 1, minlength=7)
    # Five steps and the floor; a walking sensor that looks ahead never sees much of the uppermost.
    assert (counts[1:6] > 100).all()
    assert counts[6] > 20
    assert np.isfinite(simulated.points).all()


def test_a_scan_of_nothing_is_empty_not_an_error():
    simulated = scan(build(Stair(n_risers=2)), exact(stations=1, elevation_low_deg=60.0))
    assert simulated.points.shape == (0, 3)
