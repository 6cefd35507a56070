"""A section holds the points it says it does, and its outline is the stair's own, however the scan lies."""

import dataclasses

import numpy as np
import pytest

from stair_inspector.errors import ConfigError
from stair_inspector.pictures.frames import section_frame
from stair_inspector.viewer.scene.sections import (
    DIRECTIONS,
    MOST_POINTS,
    cut,
    is_in,
    places,
    profile_csv,
    profile_of,
    section_display,
)
from tests.synthetic import make_scan, rotation
from tests.viewer.surveyed import GOING, RISE, STAIR, WIDTH, surveyed

TURNS = [np.eye(3), rotation("z", 130.0), rotation("x", 75.0) @ rotation("y", -40.0)]


@pytest.fixture(scope="module", params=TURNS, ids=["straight", "turned", "tumbled"])
def measured(request):
    return (request.param, *surveyed(request.param))


def own_places(turn, points):
    """The points in the stair's frame: climb, left, up."""
    return points @ turn


@pytest.mark.parametrize("direction", DIRECTIONS)
@pytest.mark.parametrize("place_m", [-0.21, 0.0, 0.13])
def test_the_slab_holds_what_is_within_half_its_thickness_of_its_place(measured, direction, place_m):
    turn, scan, inspection, display = measured
    frame = section_frame(inspection, display.points)
    slab = cut(frame, direction, place_m, 0.06, display.points)
    own = own_places(turn, scan.points)
    # To the right of the middle, or along the climb from it.
    middle = own_places(turn, np.concatenate([step.corners for step in inspection.steps])).mean(axis=0)
    away = -(own[:, 1] - middle[1]) if direction == "along" else own[:, 0] - middle[0]
    np.testing.assert_array_equal(is_in(scan.points, slab), np.abs(away - place_m) <= 0.03)


def test_the_section_is_looked_at_from_the_right_and_from_below(measured):
    turn, _, inspection, display = measured
    frame = section_frame(inspection, display.points)
    climb, left, up = turn.T
    along, across = (cut(frame, direction, 0.0, 0.05, display.points) for direction in DIRECTIONS)
    for vector, expected in (
        (along.facing, -left),
        (along.across, climb),
        (across.facing, -climb),
        (across.across, -left),
        (along.up, up),
        (across.up, up),
    ):
        np.testing.assert_allclose(vector, expected, atol=1e-9)
    for slab in (along, across):
        # Right-handed for who looks: what is to the right in the drawing is to the right of the eye.
        np.testing.assert_allclose(np.cross(slab.up, slab.facing), slab.across, atol=1e-9)
        np.testing.assert_allclose((slab.corners - slab.centre) @ slab.facing, 0.0, atol=1e-9)


def test_the_range_of_places_is_that_of_the_points(measured):
    _, _, inspection, display = measured
    frame = section_frame(inspection, display.points)
    low, high = places(frame, display.points, "along")
    assert (low, high) == pytest.approx((-WIDTH / 2.0, WIDTH / 2.0), abs=0.03)
    low, high = places(frame, display.points, "across")
    assert high - low == pytest.approx(STAIR.floor_depth + 5 * GOING, abs=0.04)


def test_the_lines_of_a_section_along_the_stair_are_its_treads_with_their_nosings(measured):
    turn, scan, inspection, display = measured
    frame = section_frame(inspection, display.points)
    profile = profile_of(scan, inspection, cut(frame, "along", 0.1, 0.05, display.points))
    base = float(scan.origin_m @ turn[:, 2])
    assert [line.step.step_id for line in profile.lines] == [1, 2, 3, 4, 5]
    for first, second in zip(profile.lines, profile.lines[1:], strict=False):
        rise, going = (second.nosing - first.nosing)[::-1]
        assert (rise, going) == pytest.approx((RISE, GOING), abs=1e-9)
    for line in profile.lines:
        assert line.nosing[1] == pytest.approx(base + line.step.step_id * RISE, abs=1e-6)
        (x1, z1), (x2, z2) = line.ends
        assert x1 < x2
        assert x2 - x1 == pytest.approx(GOING, abs=0.03)
        assert (z1, z2) == pytest.approx((line.nosing[1],) * 2, abs=0.002)


def test_a_section_across_the_stair_cuts_one_tread_over_its_width(measured):
    _, scan, inspection, display = measured
    frame = section_frame(inspection, display.points, 3)
    profile = profile_of(scan, inspection, cut(frame, "across", 0.0, 0.05, display.points))
    (line,) = profile.lines
    assert line.step.step_id == 3
    # Across, the front edge is beside the section, not in it.
    assert line.nosing is None
    # From side to side of the step's plate, whose longer sides are those.
    sides = np.linalg.norm(line.step.corners - np.roll(line.step.corners, 1, axis=0), axis=1)
    assert line.ends[1, 0] - line.ends[0, 0] == pytest.approx(sides.max(), abs=1e-4)
    assert set(np.unique(profile.labels)) == {3}


def test_the_points_of_a_section_keep_their_heights_and_steps(measured):
    turn, scan, inspection, display = measured
    slab = cut(section_frame(inspection, display.points), "along", 0.0, 0.08, display.points)
    profile = profile_of(scan, inspection, slab)
    inside = is_in(scan.points, slab)
    heights = (scan.points[inside] + scan.origin_m) @ turn[:, 2]
    np.testing.assert_allclose(profile.places_m[:, 1], heights, atol=1e-9)
    np.testing.assert_array_equal(profile.labels, inspection.labels[inside])
    shown = section_display(scan, slab)
    np.testing.assert_array_equal(shown.point_ids, np.nonzero(inside)[0])
    np.testing.assert_array_equal(shown.points, scan.points[inside])


def test_a_section_through_one_step_takes_that_steps_own_climb():
    _, inspection, display = surveyed()
    own = rotation("z", 30.0) @ np.array([1.0, 0.0, 0.0])
    steps = [dataclasses.replace(step, climb=own) if step.step_id == 2 else step for step in inspection.steps]
    turning = dataclasses.replace(inspection, steps=tuple(steps))
    frame = section_frame(turning, display.points, 2)
    np.testing.assert_allclose(frame.climb, own, atol=1e-12)
    np.testing.assert_allclose(frame.origin, steps[1].corners.mean(axis=0))
    np.testing.assert_allclose(section_frame(turning, display.points).climb, [1.0, 0.0, 0.0], atol=1e-12)


def test_without_flights_the_papers_axes_are_taken_and_without_a_stair_any_upright_plane():
    _, inspection, display = surveyed()
    bare = [dataclasses.replace(step, climb=None, nosing=None, flight=None) for step in inspection.steps]
    paper = dataclasses.replace(inspection, flights=(), steps=tuple(bare))
    np.testing.assert_allclose(section_frame(paper, display.points).climb, -paper.axes.depth, atol=1e-12)
    nothing = dataclasses.replace(paper, steps=(), axes=None)
    frame = section_frame(nothing, display.points)
    np.testing.assert_allclose(frame.origin, display.points.mean(axis=0))
    np.testing.assert_allclose(
        np.array([frame.right, frame.climb, frame.up]) @ np.array([frame.right, frame.climb, frame.up]).T,
        np.eye(3),
        atol=1e-12,
    )


def test_of_a_very_large_section_an_even_share_is_drawn():
    rng = np.random.default_rng(3)
    scan = make_scan(rng.uniform(0.0, 1.0, (2 * MOST_POINTS, 3)))
    _, inspection, _ = surveyed()
    slab = cut(section_frame(inspection, scan.points), "along", 0.0, 2.0, scan.points)
    shown = section_display(scan, slab)
    assert len(shown.points) == MOST_POINTS
    assert (np.diff(shown.point_ids) > 0).all()


def test_a_section_beside_the_stair_is_empty_and_no_error():
    scan, inspection, display = surveyed()
    slab = cut(section_frame(inspection, display.points), "along", 5.0, 0.05, display.points)
    assert section_display(scan, slab).points.shape == (0, 3)
    profile = profile_of(scan, inspection, slab)
    assert (len(profile.places_m), profile.lines) == (0, ())
    assert profile_csv(profile) == b"along_mm,height_mm,step_number\n"


def test_the_csv_of_a_section_has_every_point(measured):
    _, scan, inspection, display = measured
    profile = profile_of(
        scan, inspection, cut(section_frame(inspection, display.points), "along", 0, 0.05, display.points)
    )
    head, *rows = profile_csv(profile).decode().splitlines()
    assert head == "along_mm,height_mm,step_number"
    read = np.array([[float(value or -1) for value in row.split(",")] for row in rows])
    np.testing.assert_allclose(read[:, :2], 1000.0 * profile.places_m, atol=0.006)
    np.testing.assert_array_equal(read[:, 2], profile.labels)
    assert [row for row in rows if row.endswith("-1")] == []


@pytest.mark.parametrize("thickness_m", [0.0, -0.01, 0.0019, 2.01, float("nan"), float("inf")])
def test_an_impossible_thickness_is_refused(thickness_m):
    _, inspection, display = surveyed()
    with pytest.raises(ConfigError, match=r"section: thickness: got .* mm; give 2 to 2000 mm"):
        cut(section_frame(inspection, display.points), "along", 0.0, thickness_m, display.points)


@pytest.mark.parametrize("place_m", [float("nan"), float("inf")])
def test_a_place_that_is_no_number_is_refused(place_m):
    _, inspection, display = surveyed()
    with pytest.raises(ConfigError, match="section: place: got"):
        cut(section_frame(inspection, display.points), "along", place_m, 0.05, display.points)
