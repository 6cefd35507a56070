"""The arc of a flight from nosings and sides that are stated: centre, radius, sides and their uncertainties."""

import dataclasses
import math

import numpy as np
import pytest

from stair_inspector.geometry.plan import left_of
from stair_inspector.model import Arc
from stair_inspector.stages.arcs import (
    SIDE_DIFFERS_M,
    across_arc,
    arc_length,
    climb_at_nosing,
    climb_on_arc,
    find_arc,
    side_of,
    span_beside,
    turning_climbs,
    with_arc_sides,
)
from tests.stages.stated_shapes import GOING, WIDTH, chain_of, edge, turned

CENTRE = np.array([3.0, -7.0])
HALF = WIDTH / 2.0


@dataclasses.dataclass(frozen=True)
class Ring:
    """Nosings on the radii of a circle about ``CENTRE``; ``sense`` 1 climbs to the left. ``own_turn_rad`` turns the
    frames of the steps against their nosings, ``aside_m`` moves them along these, ``overhang_m`` puts the nosings
    before their radii."""

    radius_m: float = 4.0
    sense: float = 1.0
    start_rad: float = 0.4
    own_turn_rad: float = 0.0
    aside_m: float = 0.0
    overhang_m: float = 0.0

    def step(self, k, at=None, skew_rad=0.0, noise=(0.0, 0.0), noise_m=0.001, slope_noise=0.001, side_noise_m=0.001):
        """The k-th step at so many goings along the arc; ``noise`` moves its nosing and turns it."""
        angle = self.start_rad + self.sense * (k if at is None else at) * GOING / self.radius_m
        climb = np.array([math.cos(angle), math.sin(angle)])
        middle = CENTRE - self.sense * self.radius_m * left_of(climb) + (noise[0] - self.overhang_m) * climb
        turn = skew_rad + noise[1] - self.own_turn_rad
        corners = [middle + side * HALF * left_of(climb) for side in (1.0, -1.0)]
        shape = turned(k, angle + self.own_turn_rad, middle + self.aside_m * left_of(climb))
        left, right = (shape.from_plan(corner) for corner in corners)
        return dataclasses.replace(
            shape,
            # To the left a nosing that is turned to the left lies back.
            front=edge(0.0, noise_m, -math.tan(turn), slope_noise=slope_noise),
            left=edge(left[1], side_noise_m, along_m=left[0]),
            right=edge(right[1], side_noise_m, along_m=right[0]),
        )

    def flight(self, n=8, **values):
        return [self.step(k, **values) for k in range(n)]


RINGS = [
    Ring(),
    Ring(sense=-1.0),
    Ring(radius_m=9.0, start_rad=-2.5),
    Ring(own_turn_rad=0.05, aside_m=-0.15),
    Ring(sense=-1.0, own_turn_rad=-0.05, start_rad=3.0),
]


def unseen(shape):
    return dataclasses.replace(shape, front=dataclasses.replace(shape.front, slope=0.3, support=0.0))


def check(arc, ring, within_m=1e-5):
    assert arc.sense == ring.sense
    radii = [math.hypot(ring.radius_m + side, ring.overhang_m) for side in (HALF, -HALF)]
    assert arc.radius_m == pytest.approx(sum(radii) / 2.0, abs=within_m)
    np.testing.assert_allclose(arc.centre_m, CENTRE, atol=within_m)


@pytest.mark.parametrize("ring", RINGS)
def test_nosings_on_radii_give_their_centre_and_radius(ring):
    arc = find_arc(ring.flight())
    check(arc, ring)
    assert arc.middle_noise_m < 1e-6
    # Goings that differ, missing treads, and a nosing that nobody saw.
    check(find_arc([ring.step(k, at) for k, at in enumerate((0.0, 1.0, 2.3, 5.0, 5.9, 7.0))]), ring)
    check(find_arc([*ring.flight(4), unseen(ring.step(4)), ring.step(5)]), ring)


def test_sides_lie_where_they_are_though_the_nosings_stand_before_their_radii():
    ring = Ring(radius_m=5.0, overhang_m=0.03)
    arc = find_arc(ring.flight())
    assert arc.radius_m == pytest.approx(5.0, abs=2e-4)
    np.testing.assert_allclose(arc.centre_m, CENTRE, atol=1e-4)


@pytest.mark.parametrize("skew_deg", [2.5, -2.5])
def test_one_nosing_that_a_defect_turns_moves_neither_centre_nor_radius(skew_deg):
    ring = Ring()
    check(find_arc([ring.step(k, skew_rad=math.radians(skew_deg) * (k == 3)) for k in range(9)]), ring, 2e-3)


@pytest.mark.parametrize(("radius_m", "n", "is_arc"), [(10, 4, False), (10, 5, True), (3, 3, False), (3, 4, True)])
def test_a_slight_turn_needs_more_nosings(radius_m, n, is_arc):
    assert (find_arc(Ring(radius_m=float(radius_m)).flight(n)) is not None) == is_arc
    # What nobody saw is no nosing.
    flight = Ring(radius_m=float(radius_m)).flight(n)
    assert (find_arc([*flight, unseen(flight[-1])]) is not None) == is_arc


def test_what_does_not_turn_or_turns_about_a_near_centre_or_like_a_fan_has_no_arc():
    straight = [turned(k, 0.3, k * GOING * np.array([math.cos(0.3), math.sin(0.3)])) for k in range(8)]
    fan = [turned(k, math.radians(5.0) * k, (k * GOING, 0.0)) for k in range(8)]
    assert find_arc(straight) is None
    assert find_arc(fan) is None
    assert find_arc(Ring(radius_m=0.5 * HALF).flight(6)) is None


def test_nosings_that_turn_by_less_than_they_are_known_to_are_those_of_a_straight_flight():
    assert find_arc(Ring(radius_m=20.0).flight(slope_noise=0.05)) is None
    assert find_arc(Ring(radius_m=20.0).flight(slope_noise=0.001)) is not None
    # Nor do two degrees in all make a curve.
    assert find_arc(Ring(radius_m=55.0).flight(slope_noise=1e-5)) is None


@pytest.mark.parametrize("skew_deg", [6.0, -6.0])
def test_where_many_nosings_lie_off_the_arc_there_is_none(skew_deg):
    ring = Ring()

    def flight(*odd):
        return [ring.step(k, skew_rad=math.radians(skew_deg) * (k in odd)) for k in range(9)]

    assert find_arc(flight(2, 5)) is not None
    assert find_arc(flight(1, 3, 5, 7)) is None


@pytest.mark.parametrize("ring", RINGS)
def test_the_climb_follows_the_nosing_and_on_the_arc_the_circle(ring):
    arc = Arc(CENTRE, ring.radius_m, ring.sense, 0.0)
    for k in range(4):
        angle = ring.start_rad + ring.sense * k * GOING / ring.radius_m
        along = [math.cos(angle), math.sin(angle)]
        np.testing.assert_allclose(climb_at_nosing(ring.step(k)), along, atol=1e-9)
        skewed = dataclasses.replace(ring, aside_m=0.0).step(k, skew_rad=0.03)
        turned_by = [math.cos(angle + 0.03), math.sin(angle + 0.03)]
        np.testing.assert_allclose(climb_at_nosing(skewed), turned_by, atol=1e-9)
        np.testing.assert_allclose(climb_on_arc(arc, skewed), along, atol=1e-9)


@pytest.mark.parametrize(("times", "share"), [(1.0, 1.0), (4.0, 0.2)])
def test_the_uncertainties_of_the_radius_and_of_the_middle_line_are_as_large_as_their_errors(times, share):
    # Where the edges scatter by more than is stated of them, the scatter counts.
    ring, side_m, nosing_m, slope = Ring(radius_m=3.0), times * 0.008, times * 0.003, times * 0.0015
    rng = np.random.default_rng(4)
    arcs, middles_m = [], []
    for _ in range(80):
        flight = []
        for k in range(10):
            noise = rng.normal(0.0, (nosing_m, slope))
            step = ring.step(
                k, noise=noise, noise_m=share * nosing_m, slope_noise=share * slope, side_noise_m=share * side_m
            )
            moves = rng.normal(0.0, side_m, 2)
            sides = (
                dataclasses.replace(side, middle_m=side.middle_m + move)
                for side, move in zip((step.left, step.right), moves, strict=True)
            )
            flight.append(dataclasses.replace(step, **dict(zip(("left", "right"), sides, strict=True))))
        arcs.append(find_arc(flight))
        distances = [[math.dist(s.to_plan(e.along_m, e.middle_m), CENTRE) for e in (s.left, s.right)] for s in flight]
        middles_m.append(float(np.median(distances, axis=0).mean()) - 3.0)
    errors_m = np.array([arc.radius_m - 3.0 for arc in arcs])
    stated_m = math.sqrt(np.mean([arc.radius_noise_m**2 for arc in arcs]))
    # The scatter of 80 errors is known to 8 %; the floors below what is stated add some.
    assert 0.8 < stated_m / math.sqrt(np.mean(errors_m**2)) < 1.25
    stated_m = math.sqrt(np.mean([arc.middle_noise_m**2 for arc in arcs]))
    assert 0.8 < stated_m / math.sqrt(np.mean(np.square(middles_m))) < 1.25


# --- places beside an arc ---


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_places_lie_to_the_left_of_the_arc_by_what_their_distances_from_the_centre_differ(sense):
    arc = Arc(CENTRE, 4.0, sense, 0.0)
    step = Ring(sense=sense).step(2)
    places = np.random.default_rng(2).uniform(-1.0, 1.0, (2, 20))
    radii = [math.dist(step.to_plan(s, w), CENTRE) for s, w in places.T]
    across = across_arc(arc, step.origin_m, step.climb, *places)
    np.testing.assert_allclose(across, sense * (4.0 - np.array(radii)), atol=1e-12)
    # A side found there lies where it was found, and runs along the circle.
    side = side_of(arc, step.origin_m, step.climb, edge(0.6, along_m=0.2))
    along = np.array([0.2, 0.2 + 1e-5, 0.2 - 1e-5])
    w = np.array([side.at(s) for s in along])
    np.testing.assert_allclose(across_arc(arc, step.origin_m, step.climb, along, w), 0.6, atol=1e-9)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_tread_is_shorter_nearer_to_the_centre_and_no_longer_outside(sense):
    arc = Arc(CENTRE, 4.0, sense, 0.0)
    step = Ring(sense=sense).step(1)

    def spans(w_m):
        return span_beside(arc, step.origin_m, step.climb, (0.03, 0.13), w_m)

    assert spans(sense * 1.0) == pytest.approx((0.03, 0.03 + 0.1 * 3.0 / 4.0))
    assert spans(-sense * 1.0) == pytest.approx((0.03, 0.13))


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_the_way_along_an_arc_is_its_radius_times_its_angle_and_backwards_negative(sense):
    arc = Arc(CENTRE, 1.0, sense, 0.0)
    start, end, farther = (CENTRE + np.array(out) for out in ([2.0, 0.0], [0.0, 2.0 * sense], [0.0, 3.0 * sense]))
    assert arc_length(arc, start, end) == pytest.approx(math.pi)
    assert arc_length(arc, end, start) == pytest.approx(-math.pi)
    # Between two radii, on the circle in their middle.
    assert arc_length(arc, start, farther) == pytest.approx(2.5 * math.pi / 2.0)


# --- sides ---


@pytest.mark.parametrize("ring", [*RINGS, Ring(overhang_m=0.2), Ring(sense=-1.0, overhang_m=0.2, own_turn_rad=0.04)])
def test_measuring_lines_reach_from_side_to_side_of_every_step(ring):
    flight = ring.flight(7)
    for step in with_arc_sides(flight, find_arc(flight)):
        right, left = (step.to_plan(step.front.at(w), w) for w in step.line_range)
        # The corners lie where the nosing's line meets the sides.
        for found, side in ((left, step.left), (right, step.right)):
            assert math.dist(found, step.to_plan(side.along_m, side.middle_m)) < 1e-3
        assert (step.left.noise_m, step.right.noise_m) == (0.001, 0.001)
        check(step.arc, ring)


@pytest.mark.parametrize("ring", RINGS[:2])
@pytest.mark.parametrize("name", ["left", "right"])
def test_a_side_inside_the_others_may_be_the_rim_of_a_shadow_unless_its_face_is_seen(ring, name):
    flight = ring.flight()
    inwards = -1.0 if name == "left" else 1.0

    def moved(by_m, source, noise_m=0.001):
        own = getattr(flight[3], name)
        other = dataclasses.replace(own, middle_m=own.middle_m + by_m, source=source, noise_m=noise_m)
        shapes = [*flight[:3], dataclasses.replace(flight[3], **{name: other}), *flight[4:]]
        found = with_arc_sides(shapes, find_arc(flight))
        right, left = found[3].line_range
        assert left - right == pytest.approx(WIDTH, abs=2e-3)
        return getattr(found[3], name)

    shadow = moved(inwards * 0.2, "tread")
    assert shadow.support == 0.0
    assert shadow.noise_m == pytest.approx(0.1, rel=0.02)
    assert moved(inwards * 0.2, "face").noise_m == 0.001
    assert moved(inwards * 0.2, "tread", 0.045).support == 1.0
    assert moved(inwards * 0.9 * SIDE_DIFFERS_M, "tread").support == 1.0
    assert moved(-inwards * 0.2, "tread").support == 1.0


# --- the edges of patches ---


def directions(angles_deg):
    return np.column_stack([np.cos(np.radians(angles_deg)), np.sin(np.radians(angles_deg))])


def climbs_of(angles_deg, base=None, n_missing=None):
    shapes = [turned(k, math.radians(angle), (k * GOING, 0.0)) for k, angle in enumerate(angles_deg)]
    return turning_climbs(chain_of(shapes, base, n_missing))


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_edges_of_patches_that_turn_evenly_give_the_climbs_of_all_steps(sense):
    angles = 170.0 + sense * 6.0 * np.arange(7)
    np.testing.assert_allclose(climbs_of(angles), directions(angles), atol=1e-9)
    # The edge on the floor may run any way; so may one that a defect turns.
    odd = angles.copy()
    odd[0], odd[4] = 90.0, odd[4] + 9.0
    np.testing.assert_allclose(climbs_of(odd, base=0), directions(angles), atol=1e-9)
    # Behind a missing tread the turn is twice as large.
    gap = angles + sense * 6.0 * np.array([0, 0, 0, 1, 1, 1, 1])
    np.testing.assert_allclose(climbs_of(gap, n_missing=(0, 0, 0, 1, 0, 0, 0)), directions(gap), atol=1e-9)


@pytest.mark.parametrize(
    "angles",
    [[0, 6], [0, 0, 0, 0, 0, 0], [0, 1.5, 3], [0, 16, 32, 48, 64], [0, 0, 0, 20, 20, 20, 60, 60]],
    ids=["few", "straight", "hardly turning", "winding", "uneven"],
)
def test_edges_of_patches_that_do_not_turn_evenly_give_none(angles):
    assert climbs_of(np.array(angles, dtype=np.float64)) is None


def test_three_edges_that_turn_are_enough_but_for_the_one_on_the_floor():
    angles = np.array([0.0, 6.0, 12.0])
    np.testing.assert_allclose(climbs_of(angles), directions(angles), atol=1e-9)
    assert climbs_of(angles, base=0) is None
