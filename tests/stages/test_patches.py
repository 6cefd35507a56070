"""Height clusters fall into the surfaces that a person would name: what hangs together, and what only seems to."""

import numpy as np
import pytest

from stair_inspector.errors import CannotMeasure
from stair_inspector.geometry.trimmed import fit_trimmed
from stair_inspector.model import Horizontal, Up
from stair_inspector.params import LevelsParams, PatchesParams
from stair_inspector.stages import patches as stage
from stair_inspector.stages import plan_cells
from stair_inspector.stages.levels import find_height_reach, find_levels
from stair_inspector.stages.patches import split_levels

CELL = PatchesParams.cell_m
DENSITY = 20_000
"""Points per square metre: eight in each cell."""


def block(seed, x, y, z, noise=0.001, density=DENSITY):
    """Random points on a level rectangle, or, where z is a range, all through a box."""
    rng = np.random.default_rng(seed)
    n = round(density * (x[1] - x[0]) * (y[1] - y[0]))
    low, high = z if isinstance(z, tuple) else (z, z)
    heights = rng.uniform(low, high, n) + rng.normal(0.0, noise, n)
    return np.stack([rng.uniform(*x, n), rng.uniform(*y, n), heights])


def horizontal_of(points):
    order = np.argsort(points[2], kind="stable")
    return Horizontal(
        point_ids=order,
        coordinates_m=np.ascontiguousarray(points[:, order]),
        level_from_scan=np.eye(3),
        up=Up(np.array([0.0, 0.0, 1.0]), "given"),
        n_scan=points.shape[1],
    )


def split(*parts, cell_m=CELL, eps_m=0.02, min_points=50):
    """The height clusters and the patches of the points, and the patch of every point or -1."""
    horizontal = horizontal_of(np.concatenate(parts, axis=1))
    heights = LevelsParams(eps_m, min_points)
    levels = find_levels(horizontal, find_height_reach(horizontal, eps_m), heights)
    patches = split_levels(horizontal, levels, PatchesParams(cell_m), heights)
    patch_of = np.full(horizontal.n_scan, -1)
    for number, surface in enumerate(patches.surfaces):
        ids = horizontal.point_ids[surface.rows]
        assert (patch_of[ids] == -1).all(), "a point in two patches"
        patch_of[ids] = number
    return horizontal, levels, patches, patch_of


def surfaces_of(*parts, **how):
    return split(*parts, **how)[2].surfaces


def places(surfaces):
    """Height and middle of each surface, to the centimetre."""
    return [(*np.round(surface.centre_m[:2], 2).tolist(), round(surface.height_m, 3)) for surface in surfaces]


# what a surface is


def test_a_tread_is_one_surface_with_its_plane_area_and_cells():
    tread = block(1, (0.0, 0.28), (0.0, 1.0), 0.0)
    tread[2] += 0.02 * tread[0] - 0.01 * tread[1] + 0.17
    (surface,) = surfaces_of(tread)
    assert surface.level_id == 0
    assert len(surface.rows) == tread.shape[1]
    # Of cells that do not line up with the edges, the outermost count whole.
    assert surface.area_m2 == pytest.approx(0.28, abs=1.3 * CELL)
    assert surface.cells_m.shape[1] * CELL**2 == pytest.approx(surface.area_m2)
    # The noise of the mean of all points over the standard deviation of their places.
    noise = 3.0 * 0.001 / np.sqrt(tread.shape[1])
    assert surface.height_m == surface.centre_m[2]
    expected = 0.17 + 0.02 * surface.centre_m[0] - 0.01 * surface.centre_m[1]
    assert surface.height_m == pytest.approx(expected, abs=noise)
    np.testing.assert_allclose(surface.slope, [0.02, -0.01], atol=1.3 * noise * np.sqrt(12.0) / 0.28)
    # Each cell is the mean of eight points.
    assert surface.sigma_m == pytest.approx(0.001 / np.sqrt(8.0), rel=0.25)


def test_the_plane_of_a_surface_is_that_of_all_its_points():
    tread = block(2, (0.0, 0.28), (0.0, 1.0), 0.17)
    (surface,) = surfaces_of(tread)
    centred = tread - tread.mean(axis=1)[:, None]
    normal = np.linalg.svd(centred, full_matrices=False)[0][:, 2]
    np.testing.assert_allclose(surface.plane.centroid, tread.mean(axis=1), atol=1e-9)
    np.testing.assert_allclose(surface.plane.normal, normal * np.sign(normal[2]), atol=1e-6)
    assert surface.plane.n_points == tread.shape[1]


def random_level(seed):
    """Rectangles of similar size that touch, overlap or lie apart, and stray points between them; all at height 0."""
    rng = np.random.default_rng(seed)
    parts = []
    for k in range(9):
        x, y = rng.uniform(0.0, 2.5, 2)
        parts.append(block(100 * seed + k, (x, x + 0.35), (y, y + 0.35), 0.0))
    return np.concatenate([*parts, block(seed, (-0.5, 3.5), (-0.5, 3.5), 0.0, density=30)], axis=1)


@pytest.mark.parametrize("seed", range(4))
def test_the_split_in_plan_is_dbscan_on_the_cells_of_each_level(seed):
    from sklearn import cluster

    low, high = random_level(seed), random_level(seed + 50)
    high[2] += 0.3
    horizontal, levels, patches, patch_of = split(low, high, min_points=60)
    assert len(levels.start) == 2
    assert patches.cell_m == CELL
    plan = horizontal.coordinates_m[:2]
    cells = np.floor((plan - plan.min(axis=1)[:, None]) / CELL).astype(int)
    places_of, weights, cell_of = [], [], []
    for start, stop in zip(levels.start, levels.stop, strict=True):
        place, which, count = np.unique(cells[:, start:stop], axis=1, return_inverse=True, return_counts=True)
        places_of.append(place.T.astype(float))
        cell_of.append(which.ravel())
        weights.append(count)
    wanted = int(max(3.0, 0.1 * 9 * np.median(np.concatenate(weights))))
    for level_id, (start, stop) in enumerate(zip(levels.start, levels.stop, strict=True)):
        oracle = cluster.DBSCAN(eps=1.0, min_samples=wanted, metric="chebyshev", algorithm="brute")
        theirs = oracle.fit(places_of[level_id], sample_weight=weights[level_id]).labels_[cell_of[level_id]]
        ours = patch_of[horizontal.point_ids[start:stop]]
        pairs = set(zip(ours.tolist(), theirs.tolist(), strict=True))
        # What is smaller than a neighbourhood in height is no surface; crumbs would go with a larger one nearby.
        small = {k for k in set(theirs.tolist()) if np.count_nonzero(theirs == k) < 60}
        assert small <= {-1}, "the case is one without crumbs"
        assert len(pairs) == len({a for a, _ in pairs}) == len({b for _, b in pairs})
        assert all((a == -1) == (b == -1) for a, b in pairs)
        assert len(pairs) > 3


# what falls apart


@pytest.mark.parametrize("gap", [0.06, 0.25])
def test_two_treads_at_one_height_apart_in_plan_stay_two(gap):
    pair = block(3, (0.0, 0.28), (0.0, 1.0), 0.17), block(4, (0.0, 0.28), (1.0 + gap, 2.0 + gap), 0.17)
    surfaces = surfaces_of(*pair)
    assert sorted(places(surfaces)) == [(0.14, 0.5, 0.17), (0.14, round(1.5 + gap, 2), 0.17)]
    assert [surface.level_id for surface in surfaces] == [0, 0]


def test_two_treads_at_one_height_that_touch_are_one():
    assert len(surfaces_of(block(3, (0.0, 0.28), (0.0, 1.0), 0.17), block(4, (0.0, 0.28), (1.0, 2.0), 0.17))) == 1


def test_a_few_smeared_points_do_not_join_two_surfaces():
    pair = block(3, (0.0, 0.28), (0.0, 1.0), 0.17), block(4, (0.0, 0.28), (1.2, 2.2), 0.17)
    # One in each cell of a row between them: three in a neighbourhood that on a surface holds seventy.
    smear = np.stack([np.full(20, 0.13), np.linspace(0.99, 1.21, 20), np.full(20, 0.17)])
    assert len(surfaces_of(*pair, smear)) == 2


def on_the_treads(seed):
    """A stool between the risers: what a scanner sees of its legs and sides, at every height above the lower tread."""
    return block(seed, (0.1, 0.16), (0.4, 0.46), (0.17, 0.36), density=200_000)


def beside_the_treads(seed):
    """A rounded cushion a hand's breadth beside the flight that shows every height from one tread to the next."""
    cushion = block(seed, (0.1, 0.45), (1.08, 1.28), 0.0)
    cushion[2] += 0.16 + 0.2 * (cushion[0] - 0.1) / 0.35
    return cushion


@pytest.mark.parametrize("chair", [on_the_treads, beside_the_treads])
def test_a_chair_that_bridges_two_treads_in_height_is_split_from_both(chair):
    treads = [block(k, (k * 0.28, (k + 1) * 0.28), (0.0, 1.0), (k + 1) * 0.17) for k in range(2)]
    _, levels, patches, patch_of = split(*treads, chair(9))
    assert len(levels.start) == 1
    n = treads[0].shape[1]
    large = [k for k, surface in enumerate(patches.surfaces) if surface.area_m2 > 0.2]
    assert len(large) == 2
    for k, number in enumerate(large):
        mine = patch_of[k * n : (k + 1) * n]
        # Cells that hold points of the chair as well may go with it.
        assert np.count_nonzero(mine == number) > 0.97 * n
        assert patches.surfaces[number].height_m == pytest.approx(0.17 * (k + 1), abs=0.0005)
        assert np.hypot(*patches.surfaces[number].slope) < 0.005


def test_a_box_40_mm_lower_than_the_next_tread_is_split_off():
    # With a reach of 45 mm box and tread are one height cluster, hang together in plan and are not thick.
    tread = block(10, (0.28, 0.56), (0.0, 1.0), 0.34)
    box = block(11, (0.08, 0.28), (0.1, 0.4), 0.30)
    _, levels, patches, patch_of = split(tread, box, eps_m=0.045)
    assert len(levels.start) == 1
    assert places(patches.surfaces) == [(0.18, 0.25, 0.3), (0.42, 0.5, 0.34)]
    n = tread.shape[1]
    # Cells that hold points of both may go either way.
    assert np.mean(patch_of[:n] == 1) > 0.98
    assert np.mean(patch_of[n:] == 0) > 0.93


def test_levels_of_a_stair_are_its_treads():
    treads = [block(k, (k * 0.28, (k + 1) * 0.28), (0.0, 1.0), (k + 1) * 0.17, noise=0.002) for k in range(5)]
    surfaces = surfaces_of(*treads)
    assert places(surfaces) == [(round(0.14 + 0.28 * k, 2), 0.5, round(0.17 * (k + 1), 3)) for k in range(5)]
    assert [surface.level_id for surface in surfaces] == list(range(5))


# what belongs together


@pytest.mark.parametrize(
    ("crumb", "n_surfaces"),
    [
        pytest.param(((0.0, 0.28), (1.1, 1.3), 0.17), 1, id="near and level"),
        pytest.param(((0.0, 0.28), (1.2, 1.4), 0.17), 1, id="behind the shadow of a post"),
        pytest.param(((0.1, 0.15), (1.16, 1.3), 0.17), 2, id="clutter beyond its end"),
        pytest.param(((0.0, 0.28), (1.36, 1.56), 0.17), 2, id="too far"),
        pytest.param(((0.0, 0.28), (1.1, 1.3), 0.182), 2, id="12 mm higher"),
        pytest.param(((0.0, 0.28), (1.1, 1.6), 0.17), 2, id="too large"),
    ],
)
def test_a_crumb_goes_with_the_surface_it_was_cut_from(crumb, n_surfaces):
    surfaces = surfaces_of(block(12, (0.0, 0.28), (0.0, 1.0), 0.17), block(13, *crumb))
    assert len(surfaces) == n_surfaces


def test_what_is_seen_in_the_middle_of_a_hole_goes_with_what_is_round_it():
    landing = block(14, (0.0, 1.2), (0.0, 1.2), 1.0)
    off = np.abs(landing[:2] - 0.6).max(axis=0)
    (surface,) = surfaces_of(landing[:, (off > 0.35) | (off < 0.1)])
    assert len(surface.rows) > 0.99 * np.count_nonzero((off > 0.35) | (off < 0.1))


def test_a_landing_seen_between_the_legs_of_a_tripod_is_one_surface():
    landing = block(14, (0.0, 1.2), (0.0, 1.2), 1.0)
    # Shadows of 60 mm cut off two corners and a strip.
    x, y = landing[:2]
    is_shadow = (np.abs(x + y - 0.4) < 0.05) | (np.abs(x - y - 0.8) < 0.05) | (np.abs(x - 1.0) < 0.03)
    (surface,) = surfaces_of(landing[:, ~is_shadow])
    assert len(surface.rows) > 0.99 * np.count_nonzero(~is_shadow)


def test_a_scan_of_one_point_every_20_mm_gets_larger_cells():
    axis_x, axis_y = np.arange(0.01, 0.28, 0.02), np.arange(0.01, 1.0, 0.02)
    plan = np.stack(np.meshgrid(axis_x, axis_y, indexing="ij")).reshape(2, -1)
    treads = [np.vstack([plan[0] + 0.28 * k, plan[1], np.full(plan.shape[1], 0.17 * (k + 1))]) for k in range(4)]
    patches = split(*treads)[2]
    # At least the four points that a cell should hold.
    assert 0.035 <= patches.cell_m <= 0.06
    assert len(patches.surfaces) == 4
    assert [len(surface.rows) for surface in patches.surfaces] == [plan.shape[1]] * 4
    # Cells count whole on whichever side they are touched.
    margin = 2.0 * patches.cell_m
    assert all(0.26 * 0.98 < surface.area_m2 < (0.26 + margin) * (0.98 + margin) for surface in patches.surfaces)


def test_a_wished_cell_is_kept_in_a_dense_scan():
    tread = block(15, (0.0, 0.28), (0.0, 1.0), 0.17)
    assert split(tread, cell_m=0.03)[2].cell_m == 0.03
    assert split(tread, cell_m=0.1)[2].cell_m == 0.1


# invariance and contract


def mixed_scan():
    treads = [block(k, (k * 0.28, (k + 1) * 0.28), (0.0, 1.0), (k + 1) * 0.17) for k in range(3)]
    return np.concatenate([*treads, block(20, (0.0, 0.3), (1.3, 1.6), 0.34), random_level(7)], axis=1)


def test_the_order_of_the_points_in_the_scan_does_not_matter():
    points = mixed_scan()
    order = np.random.default_rng(5).permutation(points.shape[1])
    *_, patches, patch_of = split(points)
    *_, shuffled, shuffled_of = split(points[:, order])
    np.testing.assert_array_equal(shuffled_of, patch_of[order])
    for before, after in zip(patches.surfaces, shuffled.surfaces, strict=True):
        np.testing.assert_allclose(after.centre_m, before.centre_m, atol=1e-9)
        np.testing.assert_allclose(after.slope, before.slope, atol=1e-9)


def test_a_shift_moves_the_surfaces_and_nothing_else():
    points = mixed_scan()
    *_, patches, patch_of = split(points)
    # A whole number of cells, and binary: rounding leaves each point in its cell.
    *_, moved, moved_of = split(points + np.array([[64.0], [-32.0], [0.0]]))
    np.testing.assert_array_equal(moved_of, patch_of)
    for before, after in zip(patches.surfaces, moved.surfaces, strict=True):
        np.testing.assert_allclose(after.centre_m - before.centre_m, [64.0, -32.0, 0.0], atol=1e-9)
        np.testing.assert_allclose(after.slope, before.slope, atol=1e-9)


def test_a_grid_too_wide_for_a_table_gives_the_same_patches(monkeypatch):
    *_, patches, patch_of = split(mixed_scan())
    monkeypatch.setattr(plan_cells, "_LARGEST_TABLE", 0)
    *_, sorted_ones, sorted_of = split(mixed_scan())
    np.testing.assert_array_equal(sorted_of, patch_of)
    for before, after in zip(patches.surfaces, sorted_ones.surfaces, strict=True):
        np.testing.assert_array_equal(after.cells_m, before.cells_m)


def test_surfaces_come_by_height_cluster_and_height_and_cannot_be_written_to():
    *_, patches, _ = split(mixed_scan())
    keys = [(surface.level_id, surface.height_m) for surface in patches.surfaces]
    assert keys == sorted(keys)
    heights = [surface.height_m for surface in patches.surfaces]
    assert heights == sorted(heights)
    for surface in patches.surfaces:
        for array in (surface.rows, surface.cells_m, surface.centre_m, surface.slope):
            assert not array.flags.writeable


@pytest.mark.parametrize("n", [0, 30])
def test_no_level_has_no_patches(n):
    assert surfaces_of(block(1, (0.0, 1.0), (0.0, 1.0), 0.0)[:, :n]) == ()


def test_more_surfaces_than_a_building_has_are_refused(monkeypatch):
    monkeypatch.setattr(stage, "MAX_PATCHES", 3)
    four = [block(k, (k * 0.5, k * 0.5 + 0.3), (0.0, 0.3), 0.0) for k in range(4)]
    assert len(surfaces_of(*four[:3])) == 3
    with pytest.raises(
        CannotMeasure, match=r"^patches: 4 separate surfaces, more than 3 are no building; raise levels"
    ):
        split(*four)


# fit_trimmed


@pytest.mark.parametrize("side", [1.0, -1.0, 0.0])
@pytest.mark.parametrize("seed", range(3))
def test_a_plane_is_exact_with_35_percent_of_something_else(side, seed):
    rng = np.random.default_rng(seed)
    n = 400
    plan = rng.uniform(0.0, [[0.3], [1.0]], (2, n))
    slope = np.array([0.03, -0.02])
    z = 0.7 + slope @ plan
    # All above, as what lies on a tread; all below; or on both sides.
    wrong = rng.uniform(0.02, 0.2, 140) * (side or rng.choice([-1.0, 1.0], 140))
    z[rng.choice(n, 140, replace=False)] += wrong
    found, centre, sigma_m = fit_trimmed(np.vstack([plan, z]))
    np.testing.assert_allclose(found, slope, atol=1e-9)
    assert centre[2] - found @ centre[:2] == pytest.approx(0.7, abs=1e-9)
    assert sigma_m < 1e-9


def test_a_trimmed_plane_without_outliers_is_nearly_that_of_least_squares():
    rng = np.random.default_rng(4)
    plan, noise = rng.uniform(0.0, [[0.3], [1.0]], (2, 2000)), rng.normal(0.0, 0.002, 2000)
    slope, centre, sigma_m = fit_trimmed(np.vstack([plan, 0.01 * plan[0] + noise]))
    design = np.vstack([plan, np.ones(2000)])
    oracle = np.linalg.lstsq(design.T, 0.01 * plan[0] + noise, rcond=None)[0]
    # One in 370 is trimmed, which matters little beside what the noise does.
    noise = 0.002 * np.sqrt(12.0 / 2000) / np.array([0.3, 1.0])
    assert (np.abs(slope - oracle[:2]) <= 0.3 * noise).all()
    assert centre[2] - slope @ centre[:2] == pytest.approx(oracle[2], abs=0.00003)
    assert sigma_m == pytest.approx(0.002, rel=0.1)


@pytest.mark.parametrize("plan", [[[0.1] * 5, [0.2] * 5], [np.arange(5.0), np.arange(5.0)]], ids=["place", "line"])
def test_places_that_span_no_plane_have_no_slope(plan):
    points = np.vstack([np.array(plan), np.full(len(plan[0]), 0.4)])
    slope, centre, _ = fit_trimmed(points)
    np.testing.assert_array_equal(slope, [0.0, 0.0])
    assert centre[2] == pytest.approx(0.4)


@pytest.mark.parametrize("n", [1, 2])
def test_one_or_two_places_have_no_slope(n):
    slope, centre, sigma_m = fit_trimmed(np.array([[0.1, 0.3], [0.2, 0.2], [0.4, 0.4]])[:, :n])
    np.testing.assert_array_equal(slope, [0.0, 0.0])
    assert (centre[2], sigma_m) == pytest.approx((0.4, 0.0))


@pytest.mark.parametrize("size", [0.008, 0.03], ids=["one cell", "two cells"])
def test_something_as_small_as_a_bolt_head_is_a_small_surface(size):
    bolt = block(21, (0.002, 0.002 + size), (0.002, 0.01), 0.34, density=200 / (0.008 * size))
    _, small = surfaces_of(block(22, (0.0, 1.0), (0.0, 1.0), 0.0), bolt)
    assert small.height_m == pytest.approx(0.34, abs=0.001)
    assert small.area_m2 < 0.002
