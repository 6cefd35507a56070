"""Whether a surface is one layer of points or two."""

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
