"""Where the edges of steps are found, on stairs whose points are drawn from their surfaces."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from stair_inspector.geometry.edges import Sampling
from stair_inspector.model import Chain, Chains, Normals
from stair_inspector.params import FlightsParams, LevelsParams, PatchesParams, SurveyParams
from stair_inspector.stages.climbs import flight_after, straight_climb
from stair_inspector.stages.edge_finder import EdgeFinder
from stair_inspector.stages.flights import find_chains
from stair_inspector.stages.levels import find_height_reach, find_levels, select_horizontal
from stair_inspector.stages.near_points import NearPoints
from stair_inspector.stages.nosings import find_shapes
from stair_inspector.stages.orient import find_up, order_by_height
from stair_inspector.stages.patches import split_levels
from stair_inspector.stages.pooled import pool_steps
from stair_inspector.stages.rejects import Forced
from tests.synthetic import Stair, exact_params, make_scan

CLOSED = Stair(n_steps=5, spacing=0.008, risers=True, noise=0.001, floor_depth=1.6, seed=5)
OPEN = replace(CLOSED, risers=False)


def shapes_of(points, normals, params=None):
    """The steps of the first flight of a scan, in the level frame, which is the scan's own with plan axes (x, y)."""
    scan = make_scan(points, normals)
    settings = exact_params()
    found = Normals(scan.normals)
    heights = order_by_height(scan, found, find_up(scan, found, "z", settings.floor, "survey"))
    horizontal = select_horizontal(heights, settings.horizontal)
    levels = find_levels(horizontal, find_height_reach(horizontal, LevelsParams().eps_m), LevelsParams())
    patches = split_levels(horizontal, levels, PatchesParams(), LevelsParams())
    chains = find_chains(patches, FlightsParams(), PatchesParams().min_area_m2, Forced({}))
    return find_shapes(heights, horizontal, patches, chains, params or SurveyParams())[0], chains, heights


@cache
def closed(edge_source="auto"):
    return shapes_of(*CLOSED.sample(), SurveyParams(edge_source=edge_source))


def in_scan(shape, heights, s, w):
    """Plan coordinates of the scan of a place in a step's frame."""
    return (heights.level_from_scan.T[:2, :2] @ shape.to_plan(s, w)).round(9)


# --- edges ---------------------------------------------------------------------------------------------------------


def test_nosings_backs_and_sides_lie_where_the_stair_has_them():
    shapes, _, heights = closed()
    assert len(shapes) == CLOSED.n_steps
    for k, shape in enumerate(shapes):
        w = shape.front.along_m
        x, y = in_scan(shape, heights, shape.front.at(w), w)
        # A face of 1 mm of noise and hundreds of points gives its place to some hundredths of a millimetre.
        assert x == pytest.approx(k * CLOSED.going, abs=0.0005)
        assert (shape.front.source, shape.front.support) == ("face", 1.0)
        if k + 1 < CLOSED.n_steps:
            x, _ = in_scan(shape, heights, shape.back.at(w), w)
            assert x == pytest.approx((k + 1) * CLOSED.going, abs=0.0005)
            assert shape.back.source == "face"
        s = shape.left.along_m
        _, y = in_scan(shape, heights, s, shape.left.at(s))
        assert y == pytest.approx(CLOSED.width, abs=0.01)
        _, y = in_scan(shape, heights, s, shape.right.at(s))
        assert y == pytest.approx(0.0, abs=0.01)
        np.testing.assert_allclose(shape.climb @ shape.climb, 1.0, atol=1e-12)
    assert shapes[-1].back is None
    assert shapes[-1].back_limits is None


def test_edges_are_within_four_of_their_own_standard_uncertainties():
    shapes, _, heights = closed()
    for k, shape in enumerate(shapes):
        for w in np.linspace(-0.4, 0.4, 5):
            x, _ = in_scan(shape, heights, shape.front.at(w), w)
            assert abs(x - k * CLOSED.going) < 4.0 * shape.front.noise_at(w) + 0.0002


def test_planes_are_those_of_the_treads():
    shapes, _, _ = closed()
    for k, shape in enumerate(shapes, 1):
        n = shape.plane.n_points
        assert n == pytest.approx(CLOSED.points_per_tread, rel=0.1)
        assert shape.plane.z0_m == pytest.approx(k * CLOSED.rise, abs=0.0002)
        assert shape.plane.sigma_m == pytest.approx(CLOSED.noise, rel=0.1)
        assert shape.plane.spacing_m == pytest.approx(CLOSED.spacing, rel=0.2)
        assert np.abs(shape.plane.slope).max() < 5.0 * math.sqrt(shape.plane.covariance.diagonal().max()) + 0.0005
        assert shape.coverage > 0.95


def test_the_foot_is_the_floor_in_front_of_the_lowest_step_alone():
    shapes, _, _ = closed()
    assert shapes[0].foot.at(0.0, 0.0) == pytest.approx(0.0, abs=0.0003)
    assert [shape.foot for shape in shapes[1:]] == [None] * 4


def test_a_floor_that_slopes_is_taken_at_the_foot_of_the_riser():
    points, normals = CLOSED.sample()
    is_floor = points[:, 0] < 0.0
    points[is_floor, 2] += 0.02 * points[is_floor, 0]
    shapes, _, _ = shapes_of(points, normals)
    # 1.6 m away it lies 32 mm lower, at the riser where it is.
    assert shapes[0].foot.at(0.0, 0.0) == pytest.approx(0.0, abs=0.0005)


# --- evidence ------------------------------------------------------------------------------------------------------


def test_with_the_tread_alone_the_edges_are_less_sure_and_still_right():
    shapes, _, heights = closed("tread")
    by_face, _, _ = closed()
    for k, (shape, face) in enumerate(zip(shapes, by_face, strict=True)):
        assert shape.front.source == "tread"
        x, _ = in_scan(shape, heights, shape.front.middle_m, shape.front.along_m)
        assert x == pytest.approx(k * CLOSED.going, abs=0.004)
        assert shape.front.noise_m > face.front.noise_m


def test_with_faces_alone_they_are_what_auto_takes_where_they_are_seen():
    by_face, _, _ = closed("face")
    auto, _, _ = closed()
    for shape, other in zip(by_face, auto, strict=True):
        assert shape.front == other.front


def test_open_risers_end_where_their_treads_do():
    shapes, _, heights = shapes_of(*OPEN.sample())
    assert len(shapes) == OPEN.n_steps
    for k, shape in enumerate(shapes):
        assert shape.front.source == "tread"
        w = shape.front.along_m
        assert in_scan(shape, heights, shape.front.at(w), w)[0] == pytest.approx(k * OPEN.going, abs=0.004)


def cut_tread(points, normals, k, keep):
    """Leave out what ``keep`` does not want of the tread k."""
    own = (np.abs(points[:, 2] - k * CLOSED.rise) < 0.01) & (normals[:, 2] > 0.9)
    kept = ~own | keep(points)
    return points[kept], normals[kept]


def test_a_back_in_the_shadow_of_the_nosing_above_is_hidden_and_not_too_short():
    points, normals = OPEN.sample()
    # The last 80 mm of tread 2 were never seen, nor is there a riser.
    points, normals = cut_tread(points, normals, 2, lambda p: p[:, 0] < 2 * OPEN.going - 0.08)
    shapes, _, heights = shapes_of(points, normals)
    hidden = shapes[1]
    assert hidden.back is None
    low, high = hidden.back_limits
    front = in_scan(hidden, heights, 0.0, 0.0)[0]
    true = 2 * OPEN.going
    assert front + low <= true <= front + high
    assert high - low > 0.05


def test_an_overhanging_nosing_leaves_the_riser_behind_it():
    overhang = 0.03
    points, normals = CLOSED.sample()
    is_riser = normals[:, 0] < -0.9
    # The upper 40 mm of a riser are the nosing's own front, the rest stands back; the tread goes on under the nosing.
    height = points[:, 2] % CLOSED.rise
    stands_back = is_riser & (height < CLOSED.rise - 0.04)
    points[stands_back, 0] += overhang
    rng = np.random.default_rng(9)
    n = 400
    under = [
        np.column_stack(
            [
                k * CLOSED.going + rng.uniform(0.0, overhang, n),
                rng.uniform(0.0, 1.0, n),
                k * CLOSED.rise + rng.normal(0, 0.001, n),
            ]
        )
        for k in range(1, 5)
    ]
    points = np.concatenate([points, *under])
    normals = np.concatenate([normals, np.tile([0.0, 0.0, 1.0], (4 * n, 1))])
    shapes, _, heights = shapes_of(points, normals)
    for k, shape in enumerate(shapes[:-1]):
        x, _ = in_scan(shape, heights, shape.front.at(0.0), 0.0)
        assert x == pytest.approx(k * CLOSED.going, abs=0.0008)
        x, _ = in_scan(shape, heights, shape.back.at(0.0), 0.0)
        assert x == pytest.approx((k + 1) * CLOSED.going + overhang, abs=0.0008)


def test_a_side_in_a_shadow_grows_uncertain_but_keeps_its_value():
    points, normals = CLOSED.sample()
    points, normals = cut_tread(points, normals, 3, lambda p: p[:, 1] < 0.8)
    shapes, _, heights = shapes_of(points, normals)
    short = shapes[2]
    s = short.left.along_m
    sides = sorted(in_scan(short, heights, s, edge.at(s))[1] for edge in (short.left, short.right))
    assert sides == pytest.approx([0.0, 0.8], abs=0.015)
    cut = short.left if in_scan(short, heights, s, short.left.at(s))[1] > 0.5 else short.right
    assert cut.noise_m > 0.08
    assert cut.support == 0.0
    # The measuring lines lie where the flight's do.
    low, high = short.line_range
    assert high - low == pytest.approx(1.0, abs=0.02)


def test_a_strip_proud_of_the_tread_raises_the_nosing():
    points, normals = CLOSED.sample()
    is_strip = (normals[:, 2] > 0.9) & (points[:, 0] > -0.001) & (points[:, 0] % CLOSED.going < 0.05)
    points[is_strip, 2] += 0.003
    shapes, _, _ = shapes_of(points, normals)
    for k, shape in enumerate(shapes, 1):
        at_nosing = shape.plane.at(shape.front.middle_m, 0.0) + shape.nosing_offsets[1]
        assert at_nosing == pytest.approx(k * CLOSED.rise + 0.003, abs=0.001)


def test_the_height_of_a_nosing_that_its_riser_moves_is_not_that_of_the_strip_behind_its_first_place():
    """As where the first row of rays on the riser, 7 mm down, was taken for the tread's."""
    shapes, _, heights = closed()
    astray = replace(shapes[2].front, middle_m=shapes[2].front.middle_m - 0.03, source="tread", noise_m=0.01)
    steps = list(shapes)
    steps[2] = replace(shapes[2], front=astray, nosing_offsets=(0.0, -0.007, 0.0))
    pooled = pool_steps(heights, steps, 0.0)
    assert pooled[2].front.at(0.0) == pytest.approx(shapes[2].front.at(0.0), abs=0.003)
    assert pooled[2].nosing_offsets == (0.0, 0.0, 0.0)
    # The others' strips lie where they lay.
    assert pooled[1].nosing_offsets == shapes[1].nosing_offsets != (0.0, 0.0, 0.0)


# --- chains --------------------------------------------------------------------------------------------------------


def chain(angles_deg, base=0, first=1):
    angles = np.radians(angles_deg)
    n = len(angles)
    return Chain(
        base=base,
        steps=tuple(range(first, first + n)),
        climbs=np.column_stack([np.cos(angles), np.sin(angles)]),
        middles=np.zeros((n, 2)),
        lengths_m=(1.0,) * n,
        n_missing=(0,) * n,
    )


@pytest.mark.parametrize(
    ("angles", "is_straight"),
    [
        ([0, 0, 0, 0], True),
        ([1, -1, 2, -2, 0], True),
        # The edge on the floor may run all around the lowest tread.
        ([70, 0, 1, 0], True),
        # One edge that is seen badly.
        ([0, 0, 20, 0, 0], True),
        ([0, 0, 30, 60, 90, 90], False),
        ([0, 25, 50, 75, 100], False),
    ],
)
def test_a_flight_is_straight_unless_it_turns_on_and_on(angles, is_straight):
    found = straight_climb(chain(angles))
    assert (found is not None) == is_straight
    if found is not None:
        assert math.degrees(math.atan2(found[1], found[0])) == pytest.approx(0.0, abs=1.5)
        assert np.hypot(*found) == pytest.approx(1.0)


def test_the_flight_after_a_landing_begins_at_it_and_goes_straight_on():
    first = chain([0, 0, 0])
    straight_on, turned = chain([0, 0, 0], base=3, first=4), chain([90, 90, 90], base=3, first=4)
    assert flight_after(Chains((first, straight_on)), 0) == 1
    assert flight_after(Chains((first, turned)), 0) is None
    assert flight_after(Chains((first, straight_on)), 1) is None
    assert flight_after(Chains((first, chain([0, 0, 0], base=9, first=4))), 0) is None


def test_without_a_flight_there_are_no_shapes():
    points, normals = replace(CLOSED, n_steps=0).sample()
    scan = make_scan(points, normals)
    found = Normals(scan.normals)
    settings = exact_params()
    heights = order_by_height(scan, found, find_up(scan, found, "z", settings.floor, "survey"))
    horizontal = select_horizontal(heights, settings.horizontal)
    levels = find_levels(horizontal, find_height_reach(horizontal, LevelsParams().eps_m), LevelsParams())
    patches = split_levels(horizontal, levels, PatchesParams(), LevelsParams())
    chains = find_chains(patches, FlightsParams(), PatchesParams().min_area_m2, Forced({}))
    assert find_shapes(heights, horizontal, patches, chains, SurveyParams()) == ()


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_the_points_of_a_face_that_noise_hides_do_not_push_an_edge_out(seed):
    rng = np.random.default_rng(seed)
    n, n_front, sigma_m = 1500, 500, 0.008
    # A tread that ends at 0, and a face of a front that slants out below it, within the tread's noise.
    tread = np.stack([rng.uniform(-0.3, 0.0, n), rng.uniform(0.0, 1.0, n), rng.normal(0.0, sigma_m, n)])
    front = np.stack(
        [rng.uniform(0.0, 0.04, n_front), rng.uniform(0.0, 1.0, n_front), rng.uniform(-0.011, -0.002, n_front)]
    )
    near = NearPoints(*np.concatenate([tread, front], axis=1))
    finder = EdgeFinder(near, Sampling(sigma_m, 0.014), 3.0 * sigma_m, SurveyParams())
    edge = finder.edge(near.s, near.w, (0.03, 0.97), 0.0, is_foot=False)
    assert (edge.source, edge.support) == ("tread", 1.0)
    assert 0.002 < edge.noise_m < 0.06
    assert abs(edge.at(0.5)) <= 2.0 * edge.noise_m
