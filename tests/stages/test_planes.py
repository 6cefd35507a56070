"""Whether a surface is one layer of points or two, how it was sampled, and how sure its plane is."""

import numpy as np
import pytest

from stair_inspector.stages.planes import find_layers, plane_of

N = 4000


def tread(seed=3):
    rng = np.random.default_rng(seed)
    return rng, rng.uniform(0.0, 0.28, N), rng.uniform(-0.5, 0.5, N)


@pytest.mark.parametrize(
    ("apart_m", "share", "sigma_m"), [(0.012, 0.5, 0.002), (0.006, 0.5, 0.001), (0.01, 0.2, 0.001)]
)
def test_two_layers_over_the_same_places_are_told_and_measured(apart_m, share, sigma_m):
    rng, s, w = tread()
    z = sigma_m * rng.standard_normal(N) + apart_m * (rng.uniform(size=N) < share)
    assert find_layers(s, w, z - np.median(z)) == pytest.approx(apart_m, rel=0.1)
    assert plane_of(s, w, z, (float(z.mean()), 0.0, 0.0)).layers_m == pytest.approx(apart_m, rel=0.1)


def noise_of(kind, rng, s):
    normal = 0.002 * rng.standard_normal(N)
    stray = np.where(rng.uniform(size=N) < 0.05, rng.uniform(-0.03, 0.03, N), 0.0)
    return {
        "normal": normal,
        "even": rng.uniform(-0.005, 0.005, N),
        "rounded and spread": np.rint((normal + 0.0025) / 0.005) * 0.005 + rng.uniform(-0.0025, 0.0025, N),
        "stray points": 0.2 * normal + stray,
        "a strip that stands proud": 0.2 * normal + 0.004 * (s < 0.05),
        "front and back apart": 0.2 * normal + 0.01 * (s < 0.14),
        "a hollow": 0.2 * normal - 0.008 * np.sin(s / 0.28 * np.pi),
        "passes of different height": normal + 0.003 * (rng.uniform(size=N) < 0.5),
    }[kind]


@pytest.mark.parametrize("seed", [3, 4])
@pytest.mark.parametrize(
    "kind",
    [
        "normal",
        "even",
        "rounded and spread",
        "stray points",
        "a strip that stands proud",
        "front and back apart",
        "a hollow",
        "passes of different height",
    ],
)
def test_one_layer_is_no_two(kind, seed):
    rng, s, w = tread(seed)
    z = noise_of(kind, rng, s)
    assert find_layers(s, w, z - np.median(z)) == 0.0


def test_few_points_say_nothing():
    _, s, w = tread()
    z = 0.012 * (np.arange(N) % 2.0)
    assert find_layers(s, w, z - 0.006) > 0.0
    assert find_layers(s[:40], w[:40], z[:40] - 0.006) == 0.0


# --- how a surface was sampled, and how sure its plane is ------------------------------------------------------------


def lattice(apart_m, s_m=0.32, w_m=0.96):
    """Points (s, w) of a square lattice; none lies on the border of a block."""
    s, w = np.meshgrid(np.arange(apart_m / 2.0, s_m, apart_m), np.arange(apart_m / 2.0, w_m, apart_m))
    return s.ravel(), w.ravel()


@pytest.mark.parametrize("apart_m", [0.005, 0.010, 0.020, 0.040])
def test_the_spacing_is_the_distance_of_neighbouring_points(apart_m):
    s, w = lattice(apart_m)
    found = plane_of(s, w, 0.0 * s, (0.0, 0.0, 0.0))
    assert found.spacing_m == pytest.approx(apart_m)
    assert found.n_points == len(s)
    # Every fourth of points that lie half as far apart.
    fourth = plane_of(s, w, 0.0 * s, (0.0, 0.0, 0.0), stride=4)
    assert fourth.spacing_m == pytest.approx(apart_m / 2.0)
    assert fourth.n_points == 4 * len(s)


def test_a_plane_is_as_sure_as_least_squares_make_it_from_noise_of_single_points():
    rng, s, w = tread(7)
    found = plane_of(s, w, 1.0 + 0.03 * s - 0.02 * w + 0.002 * rng.standard_normal(N), (1.0, 0.03, -0.02))
    assert found.sigma_m == pytest.approx(0.002, rel=0.05)
    assert found.noise_at(float(s.mean()), float(w.mean())) == pytest.approx(0.002 / np.sqrt(N), rel=0.25)
    for k, places in ((1, s), (2, w)):
        expected = 0.002 / np.sqrt(N) / float(places.std())
        assert np.sqrt(found.covariance[k, k]) == pytest.approx(expected, rel=0.3)
    # What noise explains is no misfit.
    assert found.misfit_m < 0.0002


def test_noise_that_blocks_have_in_common_is_not_averaged_out_by_more_points():
    rng = np.random.default_rng(8)
    s, w = lattice(0.005)
    blocks = 0.001 * rng.standard_normal((4, 12))
    z = blocks[(s / 0.08).astype(int), (w / 0.08).astype(int)]
    blocks -= blocks.mean()
    found = plane_of(s, w, z - z.mean(), (0.0, 0.0, 0.0))
    # 48 blocks with 1 mm each, however many points show them; all of it is misfit.
    scatter_m = float(blocks.std())
    assert found.noise_at(0.16, 0.48) == pytest.approx(scatter_m / np.sqrt(48), rel=0.15)
    assert found.misfit_m == pytest.approx(scatter_m, rel=0.02)


def test_a_surface_of_few_blocks_is_as_unsure_as_single_points_in_each():
    rng = np.random.default_rng(9)
    s, w = rng.uniform(0.001, 0.079, (2, 2000))
    found = plane_of(s, w, 0.002 * rng.standard_normal(2000), (0.0, 0.0, 0.0))
    assert found.noise_at(float(s.mean()), float(w.mean())) == pytest.approx(0.002, rel=0.1)


def test_the_height_of_a_worn_tread_departs_from_its_plane_by_the_wear():
    rng = np.random.default_rng(10)
    s, w = lattice(0.004)
    # Its left half lies 1 mm higher than the plane, its right half 1 mm lower.
    z = np.where(w > 0.48, 0.001, -0.001) + 0.002 * rng.standard_normal(len(s))
    assert plane_of(s, w, z, (0.0, 0.0, 0.0)).misfit_m == pytest.approx(0.001, rel=0.05)
