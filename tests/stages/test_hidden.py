"""What the steps of a flight tell about an edge that one of them hides."""

import math
from dataclasses import replace

import pytest

from stair_inspector.stages.hidden import UNSEEN_M, with_common_sides, with_doubtful_fronts
from tests.stages.test_survey import ALONG_X, DEPTH, GOING, WIDTH, chain_of, even, line

OVERHANG = DEPTH - GOING


def fronts(*sources, moved_m=0.0, has_risers=True, chain=None, climb=ALONG_X, **changes):
    """The nosings of a flight; those of treads lie ``moved_m`` too far in and are changed as asked."""
    shapes = even(len(sources))
    for k, source in enumerate(sources):
        front = line(0.0, noise_m=0.0002)
        if source == "tread":
            front = replace(line(moved_m, noise_m=0.001, source="tread"), **changes)
        back = line(DEPTH, noise_m=0.0002) if has_risers else None
        shapes[k] = replace(shapes[k], front=front, back=back)
    return [shape.front for shape in with_doubtful_fronts(shapes, chain or chain_of(shapes), climb)]


# --- nosings -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("has_risers", [True, False])
def test_a_nosing_that_only_its_tread_shows_is_believed_where_it_has_to_be(has_risers):
    found = fronts("face", "face", "face", "face", "tread", "face", moved_m=0.001, has_risers=has_risers)[4]
    assert (found.middle_m, found.support) == (0.001, 1.0)
    # Half of what it differs by may be true.
    assert 0.001 < found.noise_m < 0.0013


def test_a_nosing_in_shadow_lies_before_its_riser_as_the_others_do():
    found = fronts("face", "face", "face", "face", "tread", "face", moved_m=0.04)[4]
    assert found.middle_m == pytest.approx(0.0, abs=1e-12)
    assert 0.001 < found.noise_m < 0.003
    # The note stays that it was not seen.
    assert found.support == 0.0


@pytest.mark.parametrize("moved_m", [0.04, 0.1])
def test_a_nosing_in_shadow_without_a_riser_stays_where_it_seems_to_be_and_may_lie_where_the_rhythm_has_it(moved_m):
    found = fronts("face", "face", "face", "face", "tread", "face", moved_m=moved_m, has_risers=False)[4]
    assert (found.middle_m, found.support) == (moved_m, 0.0)
    assert found.noise_m == pytest.approx(math.hypot(0.001, UNSEEN_M, moved_m / 2.0))


def test_a_nosing_in_shadow_of_which_nothing_tells_stays_where_it_seems_to_be_and_is_doubted():
    for found in (
        # Two others tell nothing of a rhythm.
        fronts("face", "tread", "face", moved_m=0.001, has_risers=False)[1],
        # Nor do those of a flight that winds.
        fronts("face", "face", "face", "face", "tread", "face", moved_m=0.001, has_risers=False, climb=None)[4],
    ):
        assert found.noise_m == pytest.approx(math.hypot(0.001, UNSEEN_M))
        assert (found.support, found.middle_m > 0.0) == (0.0, True)


def test_the_rhythm_counts_missing_treads():
    sources = ("face", "face", "face", "tread", "face", "face")
    shapes = even(6)
    gap = chain_of(shapes, n_missing=(0, 0, 0, 1, 0, 0))
    assert fronts(*sources, has_risers=False)[3].support == 1.0
    # With a tread missing below it, the same place is a going out of the rhythm.
    assert fronts(*sources, has_risers=False, chain=gap)[3].support == 0.0


def test_an_obstacle_is_no_doubt_where_the_nosing_is_in_its_place():
    obstructed = {"noise_m": math.hypot(0.001, 0.015), "support": 0.0, "obstructed_m": 0.015}
    found = fronts("face", "face", "face", "face", "tread", "face", moved_m=0.001, **obstructed)[4]
    assert found.noise_m < 0.0013
    assert (found.support, found.obstructed_m) == (1.0, 0.0)


def test_where_few_nosings_show_faces_the_others_are_as_good_as_their_treads():
    found = fronts("face", "tread", "tread", "face", "tread", moved_m=0.04)
    assert [front.noise_m for front in found] == [0.0002, 0.001, 0.001, 0.0002, 0.001]
    assert all(front.support == 1.0 for front in found)


# --- sides ---------------------------------------------------------------------------------------------------------


def sides(inside_m, **changes):
    """The left side of the third of six steps, which lies inside the others', and what was made of it."""
    shapes = [replace(s, left=line(WIDTH / 2, noise_m=0.0005, source="tread", along_m=DEPTH / 2)) for s in even(6)]
    edge = replace(shapes[2].left, middle_m=WIDTH / 2 - inside_m, **changes)
    shapes[2] = replace(shapes[2], left=edge)
    found = with_common_sides(shapes, ALONG_X)
    assert [s.left for k, s in enumerate(found) if k != 2] == [s.left for k, s in enumerate(shapes) if k != 2]
    assert [s.right for s in found] == [s.right for s in shapes]
    return edge, found[2].left


OBSTRUCTED = {"noise_m": math.hypot(0.0005, 0.015), "support": 0.0, "obstructed_m": 0.015}


def test_a_side_beside_which_something_stands_is_believed_in_line_with_the_others():
    _, found = sides(0.001, **OBSTRUCTED)
    assert (found.support, found.obstructed_m) == (1.0, 0.0)
    assert found.noise_m == pytest.approx(math.hypot(0.0005, 0.0005), rel=0.1)
    assert found.middle_m == WIDTH / 2 - 0.001


def test_a_side_beside_which_something_stands_is_doubted_inside_the_others():
    edge, found = sides(0.03, **OBSTRUCTED)
    assert (found.middle_m, found.support) == (edge.middle_m, 0.0)
    assert found.noise_m == pytest.approx(math.hypot(edge.noise_m, 0.015))


def test_a_side_that_was_not_seen_is_taken_to_be_in_line():
    _, found = sides(0.03, noise_m=UNSEEN_M, support=0.0)
    assert found.middle_m == pytest.approx(WIDTH / 2)
    assert 0.015 <= found.noise_m < 0.016
    assert found.support == 0.0


@pytest.mark.parametrize("inside_m", [0.02, 0.04, 0.2])
def test_a_side_inside_the_others_keeps_its_place_and_may_reach_them(inside_m):
    edge, found = sides(inside_m)
    assert (found.middle_m, found.support) == (edge.middle_m, 0.0)
    assert found.noise_m == pytest.approx(math.hypot(0.0005, inside_m / 2.0), rel=0.01)


@pytest.mark.parametrize("changes", [{}, {"source": "face"}])
def test_a_side_in_line_or_with_a_face_is_left_alone(changes):
    edge, found = sides(0.04 if changes else 0.003, **changes)
    assert found == edge


def test_sides_that_do_not_agree_tell_nothing():
    widths = (0.0, 0.02, 0.04, 0.06, 0.08)
    shapes = [
        replace(s, left=replace(line(WIDTH / 2 - inside_m, source="tread"), **OBSTRUCTED))
        for s, inside_m in zip(even(5), widths, strict=True)
    ]
    assert [s.left for s in with_common_sides(shapes, ALONG_X)] == [s.left for s in shapes]


@pytest.mark.parametrize("n", [2, 4])
def test_sides_that_noise_cuts_off_may_reach_as_far_as_any_of_their_flight(n):
    inside_m = (0.0, 0.1, 0.3, 0.5)[:n]
    edges = [line(WIDTH / 2 - each, noise_m=0.01, source="tread", along_m=DEPTH / 2) for each in inside_m]
    shapes = [replace(s, left=edge) for s, edge in zip(even(n), edges, strict=True)]
    found = with_common_sides(shapes, ALONG_X)
    assert [s.left.middle_m for s in found] == [edge.middle_m for edge in edges]
    wanted = [math.hypot(0.01, each / 2.0) for each in inside_m]
    assert [s.left.noise_m for s in found] == pytest.approx(wanted)
    # Where the sides are is not known: the lines stay on what was seen of each tread.
    assert [s.line_range for s in found] == [s.line_range for s in shapes]


def walls(*inside_m):
    """The left sides of a flight that end at walls, so far inside of the usual place, and what was made of them."""
    edges = [replace(line(WIDTH / 2 - each, noise_m=0.0005, along_m=DEPTH / 2), is_wall=True) for each in inside_m]
    shapes = [replace(s, left=edge) for s, edge in zip(even(len(inside_m)), edges, strict=True)]
    return edges, [s.left for s in with_common_sides(shapes, ALONG_X)]


def test_a_wall_that_narrows_one_step_alone_may_be_a_thing_that_stands_on_it():
    edges, found = walls(0.0, 0.0, 0.3, 0.0, 0.0)
    assert found[2].noise_m == pytest.approx(math.hypot(0.0005, 0.15))
    assert (found[2].middle_m, found[2].support) == (edges[2].middle_m, 0.0)
    assert [found[k] for k in (0, 1, 3, 4)] == [edges[k] for k in (0, 1, 3, 4)]


@pytest.mark.parametrize("inside_m", [(0.0, 0.1, 0.2, 0.3, 0.4), (0.0, 0.0, 0.0, 0.3, 0.3)])
def test_a_wall_that_narrows_a_flight_is_its_side(inside_m):
    edges, found = walls(*inside_m)
    assert found == edges
