"""The simulated scanner: exact without errors, and wrong by as much as it is told."""

import dataclasses
import math

import numpy as np
import pytest

from stair_inspector.simulation.rays import RayCaster
from stair_inspector.simulation.scanner import scan
from stair_inspector.simulation.scanner_specs import PROFILES, Scanner
from stair_inspector.simulation.specs import Stair
from stair_inspector.simulation.staircase import build

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


@pytest.mark.slow
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


@pytest.mark.slow
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
        turn = math.radians(27.0)
        askew = flat @ np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
        squares = np.floor(askew / 0.05)
        # Rounding can carry a point over the border of its square.
        assert len(np.unique(squares, axis=0)) >= 0.99 * len(squares)
    # Thinning takes a subset; what is left covers the floor: 1.8 m by 2 m, but for the blind spot under the tripod.
    everything = scan(building, dataclasses.replace(fine, spacing_m=0.0))
    floor = simulated.points[simulated.labels == 0]
    assert len(everything.points) > 5 * len(simulated.points)
    # Squares that the floor's border cuts have a point each as well.
    border_m = 2.0 * (1.8 + 2.0)
    assert 0.9 < len(floor) * 0.05**2 / (1.8 * 2.0) <= 1.0 + border_m * 0.05 / (1.8 * 2.0)


def test_squares_are_turned_against_the_stair():
    # The tread is 15.25 squares deep: along its edges the last row would have the points of a whole one on 5 mm.
    building = build(Stair(n_risers=3, going_m=0.28))
    simulated = scan(building, exact(azimuth_step_deg=0.15, elevation_step_deg=0.15, spacing_m=0.02))
    x = simulated.points[simulated.labels == 2][:, 0] - building.steps[1].nosing[0][0]
    rows = np.bincount(np.floor(x / 0.005).astype(int), minlength=56)[1:55]
    # Four standard errors of counts of independent points; the seam behind the nosing strip does not show either.
    assert np.abs(rows - rows.mean()).max() < 4.0 * math.sqrt(rows.mean())


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


@pytest.mark.parametrize(("profile", "shape"), [("depth_camera", "spiral"), ("phone", "winder"), ("phone", "u_right")])
def test_same_seed_same_bytes_with_everything_on(profile, shape):
    rough = dataclasses.replace(PROFILES[profile], stations=3, azimuth_step_deg=0.6, elevation_step_deg=0.6)
    rough = dataclasses.replace(rough, hole_share=0.1, range_noise_m=0.002)
    first, second = scan(build(SHAPES[shape]), rough), scan(build(SHAPES[shape]), rough)
    assert len(first.points) > 1000
    assert first.points.tobytes() == second.points.tobytes()
    assert first.colors.tobytes() == second.colors.tobytes()
    other = scan(build(SHAPES[shape]), dataclasses.replace(rough, seed=99))
    assert first.points.tobytes() != other.points.tobytes()


def test_rays_past_an_edge_do_not_depend_on_single_precision():
    building = build(Stair(n_risers=3))
    caster = RayCaster(building)
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


@pytest.mark.parametrize(
    "name", ["tls_good", *(pytest.param(each, marks=pytest.mark.slow) for each in sorted(set(PROFILES) - {"tls_good"}))]
)
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


def test_noise_grows_with_the_square_of_the_range():
    sigma = 0.003
    clean = scan(build(Stair(n_risers=5)), EXACT)
    noisy = scan(build(Stair(n_risers=5)), exact(noise_m=0.002, range_noise_m=sigma, incidence_gain=0.0))
    error, range_m = ranges_of(noisy) - ranges_of(clean), ranges_of(clean)
    for low, high in ((1.0, 1.6), (1.6, 2.2), (2.2, 3.0)):
        here = (range_m > low) & (range_m < high)
        scaled = error[here] / np.hypot(0.002, sigma * range_m[here] ** 2)
        assert here.sum() > 2000
        assert abs(scaled.std() - 1.0) < 4.0 / math.sqrt(2 * here.sum())


def test_smoothing_moves_every_point_to_the_mean_of_its_neighbours():
    building = build(Stair(n_risers=3))
    sharp, smooth = scan(building, exact(stations=2)), scan(building, exact(stations=2, smooth_m=0.03))
    assert np.array_equal(sharp.labels, smooth.labels)
    for index in range(2):
        here = np.flatnonzero(sharp.station_ids == index)
        for one in here[:: len(here) // 200]:
            near = np.linalg.norm(sharp.points[here] - sharp.points[one], axis=1)
            # A neighbour may lie just at the radius: the rounding decides, and there is nothing to compare.
            if np.abs(near - 0.03).min() > 2e-5:
                mean = sharp.points[here][near < 0.03].mean(axis=0)
                assert smooth.points[one] == pytest.approx(mean, abs=1.5e-5)


@pytest.mark.slow
def test_smoothing_rounds_edges_and_leaves_flats_alone():
    building = build(Stair(n_risers=4))
    fine = exact(azimuth_step_deg=0.2, elevation_step_deg=0.2, elevation_high_deg=0.0)
    sharp, smooth = (scan(building, dataclasses.replace(fine, smooth_m=radius)) for radius in (0.0, 0.012))
    x, z = building.steps[1].nosing[0][0], building.steps[1].height_m
    beside = (np.abs(sharp.points[:, 0] - x) < 0.002) & (np.abs(sharp.points[:, 2] - z) < 0.002)
    inside = (smooth.points[beside, 0] - x) + (z - smooth.points[beside, 2])
    assert beside.sum() > 50
    assert 0.001 < np.median(inside) / math.sqrt(2.0) < 0.006
    flat = (sharp.labels == 2) & (sharp.points[:, 0] > x + 0.03) & (sharp.points[:, 0] < x + 0.2)
    assert np.abs(smooth.points[flat, 2] - z).max() < 2e-5


def test_holes_are_patches_that_no_station_sees():
    building = build(Stair(n_risers=5))
    everything, holed = scan(building, EXACT), scan(building, exact(hole_share=0.3))
    # On 1.8 m by 2 m of floor and the stair there are over a thousand patches; stations see them unevenly.
    assert abs(len(holed.points) / len(everything.points) - 0.7) < 0.05
    left = {tuple(row) for row in holed.points.tolist()}
    gone = np.array([tuple(row) not in left for row in everything.points.tolist()])
    floor = everything.labels == 0
    turn = math.radians(27.0)
    askew = everything.points[floor, :2] @ np.array(
        [[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]]
    )
    patches = np.floor(askew / 0.05).astype(int)
    _, patch_of = np.unique(patches, axis=0, return_inverse=True)
    shares = np.bincount(patch_of, gone[floor]) / np.bincount(patch_of)
    # Rounding can carry a point over the border of its patch.
    assert ((shares < 0.2) | (shares > 0.8)).mean() > 0.99
    assert scan(building, exact(hole_share=0.3)).points.tobytes() == holed.points.tobytes()


SHAPES = {
    "left": Stair(n_risers=8, landing_after=4, turn="left"),
    "u_right": Stair(n_risers=9, landing_after=4, turn="u_right", well_m=0.2, landing_depth_m=1.3),
    "winder": Stair(n_risers=8, shape="winder", winder_after=2, width_m=1.0),
    "winder_right": Stair(n_risers=8, shape="winder", winder_after=2, turn="right", open_risers=True),
    "spiral": Stair(n_risers=8, shape="spiral", going_m=0.24, width_m=0.9),
    "spiral_right": Stair(n_risers=8, shape="spiral", going_m=0.24, width_m=0.9, turn="right", open_risers=True),
    "twin": Stair(n_risers=4, twin_gap_m=0.25),
    "missing": Stair(n_risers=6, open_risers=True, missing_treads="2,4"),
    "defects": Stair(n_risers=6, skew_errors_m="3:0.03,4:-0.02", strip_proud_m=0.003, round_nosing_m=0.01),
    "falls": Stair(n_risers=7, landing_after=3, turn="right", fall_errors_deg="3:2,5:3", cross_fall_errors_deg="6:2"),
}


def is_within(outline, points):
    """Whether points (n, 2) lie inside a polygon: even-odd rule; and their distance to its edges, metres."""
    inside, distance = np.zeros(len(points), dtype=bool), np.full(len(points), np.inf)
    for (x0, y0), (x1, y1) in zip(outline, (*outline[1:], outline[0]), strict=True):
        crosses = (y0 > points[:, 1]) != (y1 > points[:, 1])
        with np.errstate(divide="ignore", invalid="ignore"):
            inside ^= crosses & (points[:, 0] < x0 + (points[:, 1] - y0) * (x1 - x0) / (y1 - y0))
        edge = np.array([x1 - x0, y1 - y0])
        share = np.clip((points - [x0, y0]) @ edge / (edge @ edge), 0.0, 1.0)
        distance = np.minimum(distance, np.linalg.norm(points - [x0, y0] - share[:, None] * edge, axis=1))
    return inside, distance


@pytest.mark.parametrize("name", sorted(SHAPES))
def test_labelled_points_lie_on_their_steps(name):
    stair = SHAPES[name]
    simulated = scan(build(stair), exact(stations=6, azimuth_step_deg=1.0, elevation_step_deg=1.0))
    assert set(simulated.labels) <= {-1, 0, *range(1, len(simulated.building.steps) + 1)}
    for step in simulated.building.steps:
        top = simulated.points[simulated.labels == step.step_id]
        if step.is_missing:
            assert len(top) == 0
            continue
        assert len(top) > 30
        inside, distance = is_within(step.plan.outline, top[:, :2])
        assert (inside | (distance < 1e-5)).all()
        below = np.array([step.top(x, y) for x, y in top[:, :2].tolist()]) - top[:, 2]
        ahead = (top[:, :2] - step.plan.middle) @ np.array(step.climb)
        # A proud strip, 50 mm wide, carries the height; the tread behind lies lower. A skew moves it by 15 mm at most.
        wanted = np.where(ahead < 0.05, 0.0, stair.strip_proud_m)
        sure = np.abs(ahead - 0.05) > 0.016
        # Rounding: half a unit, and the slope's.
        assert np.abs(below - wanted)[sure].max() < 1.1e-5
    floor = simulated.points[simulated.labels == 0]
    assert len(floor) > 100
    assert np.abs(floor[:, 2]).max() <= 0.51e-5


@pytest.mark.parametrize("name", ["left", "winder", "spiral", "u_right"])
def test_first_surface_is_seen_in_stairs_that_turn(name):
    simulated = scan(build(SHAPES[name]), exact(stations=3, azimuth_step_deg=2.0, elevation_step_deg=2.0))
    off = np.abs(ranges_of(simulated) - true_ranges_of(simulated))
    assert (off < 1e-4).mean() > 0.995


@pytest.mark.parametrize("name", ["left", "u_right", "winder_right", "spiral"])
def test_stations_follow_the_way_up(name):
    building = build(SHAPES[name])
    simulated = scan(building, exact(stations=12, azimuth_step_deg=5.0, elevation_step_deg=5.0))
    built = {0.0} | {round(step.height_m, 9) for step in building.steps}
    heights = [round(station.position[2] - EXACT.sensor_height_m, 9) for station in simulated.stations]
    assert heights == sorted(heights)
    assert set(heights) <= built
    assert heights[-1] == round(building.steps[-1].height_m, 9)
    for station, height in zip(simulated.stations, heights, strict=True):
        if height:
            step = next(step for step in building.steps if round(step.height_m, 9) == height)
            inside, distance = is_within(step.plan.outline, np.array([station.position[:2]]))
            # Beside the middle by a tenth of the width, one may stand over the tread before or after.
            assert inside[0] or distance[0] < 0.15
            heading = np.array([math.cos(station.heading_rad), math.sin(station.heading_rad)])
            # On a landing that turns one looks anywhere between the two flights.
            assert heading @ np.array(step.climb) > (0.8 if step.kind == "tread" else -0.1)


def test_a_camera_looks_along_the_way():
    stair = Stair(n_risers=9, landing_after=4, turn="left", open_risers=True)
    camera = exact(stations=8, azimuth_width_deg=60.0, elevation_high_deg=0.0)
    simulated = scan(build(stair), camera)
    for index, station in enumerate(simulated.stations):
        seen = simulated.points[simulated.station_ids == index][:, :2] - np.array(station.position[:2])
        azimuth = np.arctan2(seen[:, 1], seen[:, 0]) - station.heading_rad
        azimuth = np.degrees((azimuth + math.pi) % (2.0 * math.pi) - math.pi)
        far = np.linalg.norm(seen, axis=1) > 0.3
        # The last one looks over the edge of the upper landing, past everything.
        assert len(seen) > 100 or index == 7
        assert (np.abs(azimuth[far]) < 30.01).all()


def test_nobody_stands_where_a_tread_is_missing():
    simulated = scan(build(SHAPES["missing"]), exact(stations=9))
    heights = {round(station.position[2] - EXACT.sensor_height_m, 9) for station in simulated.stations}
    assert not heights & {round(2 * 0.17, 9), round(4 * 0.17, 9)}


def test_a_scan_of_nothing_is_empty_not_an_error():
    simulated = scan(build(Stair(n_risers=2)), exact(stations=1, elevation_low_deg=60.0))
    assert simulated.points.shape == (0, 3)
