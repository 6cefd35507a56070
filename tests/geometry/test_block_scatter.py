"""Two layers in a part of a surface are told from noises of two sizes, steps, leans and few points."""

import numpy as np
import pytest

from stair_inspector.geometry.block_scatter import find_scatter

N = 9000


def scattered(kind, seed=3):
    """Places and heights of a tread, where a part of it is otherwise than the rest."""
    rng = np.random.default_rng(seed)
    s, w = rng.uniform(0.0, 0.24, N), rng.uniform(-0.5, 0.5, N)
    noise, is_part, is_second = rng.standard_normal(N), w > 0.1, rng.uniform(size=N) < 0.5
    z = {
        "two layers": 0.003 * noise + 0.012 * (is_part & is_second),
        "one": 0.003 * noise,
        "noise of two sizes": np.where(is_part & is_second, 0.009, 0.003) * noise,
        "a step": 0.001 * noise + 0.006 * (w > 0.1),
        "a lean": 0.001 * noise + 0.05 * np.where(is_part, w, 0.0),
    }[kind]
    return s, w, z


def test_two_layers_are_measured_where_noise_fills_the_gap():
    found = find_scatter(*scattered("two layers"))
    assert found.ratio > 2.0
    assert found.apart_m == pytest.approx(0.012, rel=0.2)
    assert found.share_of_two == pytest.approx(1.0, abs=0.35)


@pytest.mark.parametrize("kind", ["one", "a step", "a lean"])
def test_one_layer_scatters_alike_everywhere(kind):
    assert find_scatter(*scattered(kind)).ratio < 1.6


def test_noise_of_two_sizes_scatters_unlike_two_layers():
    found = find_scatter(*scattered("noise of two sizes"))
    assert found.ratio > 1.8
    assert found.share_of_two < 0.0


def test_few_points_or_none_tell_nothing():
    s, w, z = scattered("one")
    assert find_scatter(s[:0], w[:0], z[:0]) is None
    assert find_scatter(s[:400], w[:400], z[:400]) is None
    assert find_scatter(s, w, 0.0 * z) is None
