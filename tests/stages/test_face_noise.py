"""The noise that faces show by themselves, and whose they are, where stations are known."""

from dataclasses import replace

import numpy as np
import pytest

from stair_inspector.geometry.sight import Sight
from stair_inspector.stages.face_noise import with_face_noise
from stair_inspector.stages.parts import Doubts
from tests.stages.stated_shapes import DEPTH, RISE, WIDTH, common, edge, plane, shape

PLACE = np.array([-6.0, 0.0, 1.8])
NOISE_M = 0.005


def sight_of(points, of_point):
    """Stations at one place that saw points."""
    ways = [points[of_point == k] - PLACE for k in range(2)]
    ranges = [np.linalg.norm(way, axis=1) for way in ways]
    rays = [way / far[:, None] for way, far in zip(ways, ranges, strict=True)]
    return Sight(("A", "B"), np.array([PLACE, PLACE]), tuple(rays), tuple(ranges))


def faces(rng):
    """Points with noise along x of a nosing's face, which the second station saw, and of a riser's, by the first."""
    w = rng.uniform(-WIDTH / 2.0, WIDTH / 2.0, 4000)
    s = np.where(np.arange(4000) < 2000, 0.0, DEPTH) + rng.normal(0.0, NOISE_M, 4000)
    z = RISE + np.where(np.arange(4000) < 2000, -1.0, 1.0) * rng.uniform(0.005, 0.03, 4000)
    return np.column_stack([s, w, z]), np.repeat([1, 0], 2000)


def test_a_face_shows_the_noise_along_the_ray_that_its_tread_does_not():
    points, of_point = faces(np.random.default_rng(2))
    tread = shape(0, plane=plane(RISE, sigma_m=0.001))
    (told,) = with_face_noise([tread], sight_of(points, of_point))
    assert told.front.sigma_m == pytest.approx(NOISE_M, rel=0.1)
    assert told.back.sigma_m == pytest.approx(NOISE_M, rel=0.1)
    assert (told.front.seen_by, told.back.seen_by) == (1, 0)
    before, after = (Doubts(common(), (each,)).place(each.front, each) for each in (tread, told))
    assert after > 4.0 * before
    # The end of a tread without a face, and a face of few points, stay as they are.
    ends = replace(tread, front=replace(edge(0.0), source="tread"), back=None)
    assert with_face_noise([ends], sight_of(points, of_point))[0].front == ends.front
    few = np.r_[0:20, 2000:2020]
    assert with_face_noise([tread], sight_of(points[few], of_point[few]))[0].front == tread.front


@pytest.mark.parametrize(
    ("by", "sources", "share"),
    [((0, 0), "ff", 0.0), ((0, 1), "ff", 1.0), ((-1, -1), "ff", 0.0), ((0, 0), "ft", 0.5), ((-1, -1), "tt", 0.5**0.5)],
)
def test_u_of_a_going_holds_a_shift_along_the_climb_that_no_surface_shows(by, sources, share):
    names = {"f": "face", "t": "tread"}
    edges = [replace(edge(0.0), seen_by=k, source=names[name]) for k, name in zip(by, sources, strict=True)]
    shapes = tuple(shape(k, front=each) for k, each in enumerate(edges))
    doubts = Doubts(common(aside_m=np.array([[0.011, 0.0, 0.0]])), shapes)
    told = doubts.across((edges[0], shapes[0]), (edges[1], shapes[1]))["layers"]
    assert told == pytest.approx(share * 0.011)
    across = Doubts(common(aside_m=np.array([[0.0, 0.011, 0.0]])), shapes)
    assert across.across((edges[0], shapes[0]), (edges[1], shapes[1]))["layers"] == 0.0
