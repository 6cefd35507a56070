"""A strip that lies on a surface: where it is, how thick, and what is none."""

import numpy as np
import pytest

from stair_inspector.geometry.strips import find_strip


def surface(low=0.0, high=1.1, seed=1, n=6000, noise=0.001, slopes=(0.01, -0.004)):
    rng = np.random.default_rng(seed)
    along, across = rng.uniform(0.0, 0.28, n), rng.uniform(low, high, n)
    return along, across, slopes[0] * along + slopes[1] * across + rng.normal(0.0, noise, n)


@pytest.mark.parametrize("thick", [0.005, 0.009, 0.014])
@pytest.mark.parametrize(("first", "last"), [(0.2, 0.9), (0.1, 0.5), (0.5, 1.1)])
def test_a_strip_is_found_where_it_lies(first, last, thick):
    along, across, height = surface()
    strip = find_strip(along, across, height + thick * ((across > first) & (across < last)))
    assert strip.low == pytest.approx(first, abs=0.012)
    assert strip.high == pytest.approx(last, abs=0.012)
    assert strip.thick_m == pytest.approx(thick, abs=0.0005)
    assert strip.bare_m == pytest.approx((first, 1.1 - last), abs=0.015)


def test_where_more_of_the_strip_is_seen_at_the_front_its_slope_is_no_step():
    along, across, height = surface(slopes=(0.05, 0.0))
    strip = find_strip(along, across, height + 0.008 * ((across > 0.3) & (across < 0.7)))
    seen = (along < 0.14) | (across < 0.3) | (across > 0.7)
    in_part = find_strip(along[seen], across[seen], (height + 0.008 * ((across > 0.3) & (across < 0.7)))[seen])
    assert in_part.thick_m == pytest.approx(strip.thick_m, abs=0.0005)


@pytest.mark.parametrize(
    "shape",
    [
        pytest.param(lambda w: 0.0 * w, id="plane"),
        pytest.param(lambda w: -0.008 * np.exp(-(((w - 0.55) / 0.2) ** 2)), id="worn in the middle"),
        pytest.param(lambda w: 0.008 * np.sin(np.pi * w / 1.1), id="arched"),
        pytest.param(lambda w: -0.008 * ((w > 0.3) & (w < 0.8)), id="a channel"),
        pytest.param(lambda w: 0.04 * (w > 0.5), id="another tread"),
        pytest.param(lambda w: 0.002 * ((w > 0.3) & (w < 0.8)), id="thinner than carpet"),
    ],
)
def test_what_is_no_strip(shape):
    along, across, height = surface()
    assert find_strip(along, across, height + shape(across)) is None


def test_few_points_and_narrow_surfaces_tell_nothing():
    assert find_strip(np.zeros(0), np.zeros(0), np.zeros(0)) is None
    assert find_strip(*surface(0.0, 0.1)) is None
    assert find_strip(*surface(n=100)) is None
