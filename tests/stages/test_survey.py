"""The numbers of the survey from steps whose planes and edges are given exactly."""

import math
from dataclasses import replace

import numpy as np
import pytest

from stair_inspector import priors
from stair_inspector.geometry.edges import EdgeLine
from stair_inspector.geometry.fits import PlaneFit
from stair_inspector.model import (
    Chain,
    Chains,
    Examination,
    Horizontal,
    LocalPlane,
    PaperValues,
    Patches,
    Step,
    StepShape,
    Surface,
    Up,
)
from stair_inspector.params import DisplayParams, SurveyParams
from stair_inspector.stages.climbs import find_climbs
from stair_inspector.stages.doubt import edge_doubt, slope_doubt
from stair_inspector.stages.rejects import Forced
from stair_inspector.stages.survey import measure_survey, with_paper_values
from stair_inspector.stated_uncertainty import UncertaintyParams

RISE, GOING, WIDTH, DEPTH = 0.17, 0.28, 1.0, 0.3
ALONG_X = np.array([1.0, 0.0])
STATED = UncertaintyParams(registration_m=1e-9)
"""Something is stated, so that no note asks for it, and too little to be seen."""
PLANE = PlaneFit(np.zeros(3), np.array([0.0, 0.0, 1.0]), 0.0, 4)


def line(middle_m, slope=0.0, noise_m=0.0, source="face", support=1.0, along_m=0.0):
    return EdgeLine(middle_m, slope, along_m, noise_m, 0.0, support, source)


def level_plane(z0_m=0.0, slope=(0.0, 0.0), sigma_m=0.0, variance=0.0):
    return LocalPlane(z0_m, slope, np.diag([variance, 0.0, 0.0]), sigma_m, 0.0, 0.0, 100)


def shape(number, middle, z_m, climb=ALONG_X, foot=None, **changes):
    """A step whose nosing's middle lies at a place of the plan, at a height."""
    values = {
        "surface": number,
        "origin_m": np.asarray(middle, dtype=float),
        "climb": climb,
        "plane": level_plane(z_m),
        "extent": (0.0, DEPTH, -WIDTH / 2, WIDTH / 2),
        "front": line(0.0),
        "back": line(DEPTH),
        "left": line(WIDTH / 2, along_m=DEPTH / 2),
        "right": line(-WIDTH / 2, along_m=DEPTH / 2),
        "foot": foot,
        "back_limits": None,
        "coverage": 0.9,
        "line_range": (-WIDTH / 2, WIDTH / 2),
        "nosing_offsets": (0.0, 0.0, 0.0),
        "nosing_noise": (0.0, 0.0, 0.0),
    }
    return StepShape(**(values | changes))


def even(n=4):
    return [shape(k, ((k - 1) * GOING, 0.0), k * RISE, foot=level_plane() if k == 1 else None) for k in range(1, n + 1)]


def chain_of(shapes, base=0, n_missing=None, **changes):
    n = len(shapes)
    return Chain(
        base=base,
        steps=tuple(s.surface for s in shapes),
        climbs=np.array([s.climb for s in shapes]),
        middles=np.array([s.origin_m for s in shapes]),
        lengths_m=(WIDTH,) * n,
        n_missing=n_missing or (0,) * n,
        **changes,
    )


def scan_of(shapes):
    """Patches of four points each, in the level frame, which is the scan's own."""
    corners = np.array([[0.05, 0.05, 0.25, 0.25], [-0.4, 0.4, -0.4, 0.4]])
    count = max(s.surface for s in shapes) + 1
    by_number = {s.surface: s for s in shapes}
    surfaces, rows = [], []
    for number in range(count):
        own = by_number.get(number)
        origin = np.array([-0.8, 0.0]) if own is None else own.origin_m
        z = 0.0 if own is None else own.plane.z0_m
        cells = origin[:, None] + corners
        rows.append(np.vstack([cells, np.full(4, z)]))
        ids = np.arange(4 * number, 4 * number + 4)
        surfaces.append(
            Surface(
                level_id=number,
                rows=ids,
                cells_m=cells,
                area_m2=0.28,
                height_m=z,
                centre_m=np.array([*cells.mean(axis=1), z]),
                slope=np.zeros(2),
                sigma_m=0.0,
                plane=PLANE,
            )
        )
    coordinates = np.concatenate(rows, axis=1)
    n = coordinates.shape[1]
    up = Up(np.array([0.0, 0.0, 1.0]), "given")
    return Horizontal(np.arange(n), coordinates, np.eye(3), up, n), Patches(tuple(surfaces), 0.02)


def survey_of(*flights, up=None, doubts=STATED, params=None, forced=None, examined=None):
    """Measure flights, each a list of shapes or a chain and its shapes."""
    pairs = [flight if isinstance(flight, tuple) else (chain_of(flight), flight) for flight in flights]
    horizontal, patches = scan_of([s for _, shapes in pairs for s in shapes])
    paper = tuple(
        Step(k, PLANE, np.zeros((4, 3)), np.zeros(0, dtype=np.int64), PaperValues(h_m=float(k)))
        for k in range(1, len(patches.surfaces))
    )
    survey = measure_survey(
        horizontal,
        patches,
        Chains(tuple(chain for chain, _ in pairs)),
        tuple(tuple(shapes) for _, shapes in pairs),
        up or horizontal.up,
        forced or Forced({}),
        params or SurveyParams(),
        doubts,
        DisplayParams(nearest_k=2),
        examined,
    )
    return with_paper_values(survey, patches, paper)


def values(survey, name):
    return [None if getattr(step, name) is None else getattr(step, name).value for step in survey.steps]


# --- values --------------------------------------------------------------------------------------------------------


def test_an_exact_stair_has_its_exact_values():
    survey = survey_of(even())
    assert values(survey, "rise_m") == pytest.approx([RISE] * 4, abs=1e-12)
    assert values(survey, "going_m")[:3] == pytest.approx([GOING] * 3, abs=1e-12)
    assert values(survey, "tread_depth_m") == pytest.approx([DEPTH] * 4, abs=1e-12)
    assert values(survey, "nosing_overhang_m")[:3] == pytest.approx([DEPTH - GOING] * 3, abs=1e-12)
    assert values(survey, "width_m") == pytest.approx([WIDTH] * 4, abs=1e-12)
    pitch = math.degrees(math.atan2(RISE, GOING))
    assert values(survey, "pitch_deg")[:3] == pytest.approx([pitch] * 3, abs=1e-12)
    assert values(survey, "fall_deg") == pytest.approx([0.0] * 4, abs=1e-12)
    last = survey.steps[-1]
    assert (last.going_m, last.going_lcr_m, last.nosing_overhang_m, last.pitch_deg) == (None,) * 4
    assert survey.notes == ()
    assert [step.paper.h_m for step in survey.steps] == [1.0, 2.0, 3.0, 4.0]
    assert [len(step.nearest_ids) for step in survey.steps] == [2] * 4


def test_the_three_lines_lie_at_15_50_and_85_percent_from_the_left():
    first = survey_of(even()).steps[0]
    # Up is z and the climb is +x, so the left is +y.
    np.testing.assert_allclose(first.line_points, [[0, 0.35, RISE], [0, 0, RISE], [0, -0.35, RISE]], atol=1e-12)
    np.testing.assert_allclose(first.nosing, [[0, 0.5, RISE], [0, -0.5, RISE]], atol=1e-12)
    np.testing.assert_allclose(first.climb, [1.0, 0.0, 0.0], atol=1e-12)
    outer = survey_of(even(), params=SurveyParams(line_percent=5.0)).steps[0]
    np.testing.assert_allclose(outer.line_points[:, 1], [0.45, 0.0, -0.45], atol=1e-12)


def test_a_slanting_tread_is_measured_at_its_nosing():
    shapes = even()
    # Step 2 rises by 2 % away from its nosing: no rise may change.
    shapes[1] = replace(shapes[1], plane=level_plane(2 * RISE, (0.02, 0.0)))
    survey = survey_of(shapes)
    assert values(survey, "rise_m") == pytest.approx([RISE] * 4, abs=1e-12)
    assert values(survey, "fall_deg")[1] == pytest.approx(math.degrees(math.atan(0.02)), abs=1e-12)
    assert values(survey, "cross_fall_deg")[1] == pytest.approx(0.0, abs=1e-12)


def test_a_tread_that_is_higher_on_the_left_shows_in_left_and_right():
    shapes = even()
    shapes[1] = replace(shapes[1], plane=level_plane(2 * RISE, (0.0, 0.01)))
    survey = survey_of(shapes)
    low, high = RISE - 0.0035, RISE + 0.0035
    assert survey.steps[1].rise_lcr_m == pytest.approx((high, RISE, low), abs=1e-12)
    assert survey.steps[2].rise_lcr_m == pytest.approx((low, RISE, high), abs=1e-12)
    assert values(survey, "cross_fall_deg")[1] == pytest.approx(math.degrees(math.atan(0.01)), abs=1e-12)


def test_a_turned_nosing_shows_in_the_goings_beside_it():
    shapes = even(6)
    # The left end lies 5 mm farther back: the going to it is longer on the left by the slope over the lines' distance.
    shapes[2] = replace(shapes[2], front=line(0.0, slope=0.01))
    survey = survey_of(shapes)
    before, after = survey.steps[1].going_lcr_m, survey.steps[2].going_lcr_m
    climb = survey.steps[0].climb
    assert before[0] - before[2] == pytest.approx(0.007, abs=1e-4)
    assert after[2] - after[0] == pytest.approx(0.007, abs=1e-4)
    # One nosing of six hardly turns the common direction of climb.
    assert abs(climb[1]) < 0.01


def test_rises_at_one_line_sum_to_the_height_between_first_and_last():
    rng = np.random.default_rng(4)
    shapes = [replace(s, plane=level_plane(s.plane.z0_m + rng.normal(0, 0.01))) for s in even(7)]
    survey = survey_of(shapes)
    assert sum(values(survey, "rise_m")) == pytest.approx(shapes[-1].plane.z0_m, abs=1e-12)


def test_a_strip_that_stands_proud_counts_at_the_nosing():
    shapes = even()
    shapes[1] = replace(shapes[1], nosing_offsets=(0.003, 0.003, 0.003))
    assert values(survey_of(shapes), "rise_m") == pytest.approx([RISE, RISE + 0.003, RISE - 0.003, RISE], abs=1e-12)


def test_offsets_that_differ_from_left_to_right_stay_on_their_side():
    shapes = even()
    # The right third of nosing 2 is worn by 4 mm, its left third not.
    shapes[1] = replace(shapes[1], nosing_offsets=(0.0, 0.0, -0.004))
    survey = survey_of(shapes)
    assert survey.steps[1].rise_lcr_m == pytest.approx((RISE, RISE, RISE - 0.004), abs=1e-12)
    assert survey.steps[2].rise_lcr_m == pytest.approx((RISE, RISE, RISE + 0.004), abs=1e-12)
    # The points that are drawn are those that were measured.
    np.testing.assert_allclose(survey.steps[1].line_points[:, 2], [2 * RISE, 2 * RISE, 2 * RISE - 0.004], atol=1e-12)


# --- null ----------------------------------------------------------------------------------------------------------


def codes(survey):
    return [(note.code, note.step) for note in survey.notes]


def test_without_a_floor_the_first_rise_is_null_with_a_note():
    shapes = even()
    shapes[0] = replace(shapes[0], foot=None)
    survey = survey_of((chain_of(shapes, base=None), shapes))
    assert (survey.steps[0].rise_m, survey.steps[0].rise_lcr_m) == (None, None)
    assert codes(survey) == [("rise_unobserved", 1)]
    (flight,) = survey.flights
    # Three risers join four steps.
    assert flight.n_risers == 3


def test_a_missing_tread_makes_the_values_over_the_gap_null():
    shapes = [s for s in even(6) if s.surface != 4]
    survey = survey_of((chain_of(shapes, n_missing=(0, 0, 0, 1, 0)), shapes))
    below, above = survey.steps[2], survey.steps[3]
    assert (below.going_m, below.going_lcr_m, below.pitch_deg, below.nosing_overhang_m) == (None,) * 4
    assert (above.rise_m, above.rise_lcr_m) == (None, None)
    assert codes(survey) == [("tread_missing", 4)]
    (flight,) = survey.flights
    assert (flight.n_risers, flight.pitch_deg, flight.rise.n, flight.going.n) == (6, None, 4, 3)
    # Steps 3 and 5 are no neighbours: the gap parts them.
    assert flight.rise.max_adjacent == pytest.approx(0.0, abs=1e-12)


def test_two_missing_treads_are_counted_and_named():
    shapes = [s for s in even(6) if s.surface not in (3, 4)]
    survey = survey_of((chain_of(shapes, n_missing=(0, 0, 2, 0)), shapes))
    assert survey.flights[0].n_risers == 6
    assert survey.notes[0].message.startswith("2 treads are missing or not seen between step 2 and step 3")


def test_a_hidden_back_is_the_middle_of_its_limits_and_as_uncertain_as_they_are_wide():
    shapes = even()
    shapes[0] = replace(shapes[0], back=None, back_limits=(0.24, 0.34))
    survey = survey_of(shapes)
    depth = survey.steps[0].tread_depth_m
    assert depth.value == pytest.approx(0.29, abs=1e-12)
    assert depth.u == pytest.approx(0.05, rel=0.01)
    assert survey.steps[0].nosing_overhang_m.u == pytest.approx(0.05, rel=0.01)
    assert codes(survey) == [("back_hidden", 1)]


def test_what_was_not_seen_is_noted():
    shapes = even()
    unseen = {"support": 0.0, "noise_m": 0.02, "source": "tread"}
    shapes[1] = replace(shapes[1], front=line(0.0, **unseen), back=None)
    shapes[2] = replace(shapes[2], left=line(WIDTH / 2, **unseen))
    survey = survey_of(shapes)
    assert set(codes(survey)) == {("nosing_unobserved", 2), ("back_unobserved", 2), ("side_unobserved", 3)}
    assert survey.steps[1].tread_depth_m is None
    assert survey.steps[1].going_m.u > 0.02
    assert survey.steps[2].width_m.u == pytest.approx(0.04, rel=0.01)


# --- uncertainty ---------------------------------------------------------------------------------------------------


def test_the_noise_of_a_rise_is_that_of_both_nosings():
    shapes = [replace(s, nosing_noise=(0.0, 0.0003, 0.0)) for s in even()]
    part = dict(survey_of(shapes).steps[1].rise_m.parts)["noise"]
    assert part == pytest.approx(2.0 * math.hypot(0.0003, 0.0003), rel=1e-9)


def test_the_noise_of_a_going_is_that_of_both_edges():
    shapes = [replace(s, front=line(0.0, noise_m=0.0005)) for s in even()]
    part = dict(survey_of(shapes).steps[1].going_m.parts)["noise"]
    assert part == pytest.approx(2.0 * math.hypot(0.0005, 0.0005), rel=1e-9)


def test_up_enters_with_half_of_its_expanded_uncertainty_and_what_the_user_states():
    up = Up(np.array([0.0, 0.0, 1.0]), "floor", u_deg=0.6)
    survey = survey_of(even(), up=up, doubts=UncertaintyParams(up_deg=0.4))
    up_rad = math.radians(0.5)
    for step in survey.steps[1:]:
        assert dict(step.rise_m.parts)["up"] == pytest.approx(2.0 * up_rad * GOING, rel=1e-9)
    # The first riser's two heights lie at one place.
    assert "up" not in dict(survey.steps[0].rise_m.parts)
    assert dict(survey.steps[0].going_m.parts)["up"] == pytest.approx(2.0 * up_rad * RISE, rel=1e-9)
    assert dict(survey.flights[0].pitch_deg.parts)["up"] == pytest.approx(1.0, rel=1e-9)


def test_the_place_of_an_edge_matters_to_a_rise_only_where_the_tread_leans():
    doubts = UncertaintyParams(edge_m=0.002)
    shapes = even()
    assert dict(survey_of(shapes, doubts=doubts).steps[1].rise_m.parts).get("edge", 0.0) == 0.0
    shapes[1] = replace(shapes[1], plane=level_plane(2 * RISE, (0.05, 0.0)))
    part = dict(survey_of(shapes, doubts=doubts).steps[1].rise_m.parts)["edge"]
    assert part == pytest.approx(2.0 * 0.05 * 0.002, rel=0.01)


def test_the_edge_below_matters_to_a_rise_where_the_tread_below_leans():
    doubts = UncertaintyParams(edge_m=0.002)
    shapes = even()
    shapes[0] = replace(shapes[0], plane=level_plane(RISE, (0.05, 0.0)))
    part = dict(survey_of(shapes, doubts=doubts).steps[1].rise_m.parts)["edge"]
    assert part == pytest.approx(2.0 * 0.05 * 0.002, rel=0.01)
    # Above it nothing leans.
    assert dict(survey_of(shapes, doubts=doubts).steps[2].rise_m.parts).get("edge", 0.0) == 0.0


@pytest.mark.parametrize(
    ("noisy", "expected_m"),
    [((2,), 0.02 * 0.01), ((1,), 0.02 * 0.01), ((1, 2), 0.02 * math.hypot(0.01, 0.01)), ((), 0.0)],
)
def test_smooth_errors_of_both_surfaces_are_in_the_noise_of_a_rise(noisy, expected_m):
    shapes = [replace(s, plane=level_plane(s.plane.z0_m, sigma_m=0.01)) if s.surface in noisy else s for s in even()]
    part = dict(survey_of(shapes).steps[1].rise_m.parts).get("noise", 0.0)
    assert part == pytest.approx(2.0 * expected_m, rel=1e-9)


def test_the_floor_in_front_is_as_unsure_as_its_plane_and_its_surface():
    shapes = even()
    shapes[0] = replace(shapes[0], foot=level_plane(sigma_m=0.01, variance=0.0004**2))
    part = dict(survey_of(shapes).steps[0].rise_m.parts)["noise"]
    assert part == pytest.approx(2.0 * math.hypot(0.0004, 0.02 * 0.01), rel=1e-9)


def test_rounding_is_in_every_length_between_two_levels_or_two_edges():
    examined = Examination((), np.array([0.006, 0.0, 0.002]))
    first, *_ = survey_of(even(), examined=examined).steps
    one = 2.0 * 0.002 / math.sqrt(12.0)
    assert dict(first.rise_m.parts)["resolution"] == pytest.approx(math.sqrt(2.0) * one, rel=0.01)
    along = 2.0 * 0.006 / math.sqrt(12.0)
    for value in (first.going_m, first.tread_depth_m, first.nosing_overhang_m):
        assert dict(value.parts)["resolution"] == pytest.approx(math.sqrt(2.0) * along, rel=0.01)
    # The sides lie square to y, on which there is no step.
    assert "resolution" not in dict(first.width_m.parts)
    aside = survey_of(even(), examined=Examination((), np.array([0.0, 0.006, 0.0]))).steps[0]
    assert dict(aside.width_m.parts)["resolution"] == pytest.approx(math.sqrt(2.0) * along, rel=0.01)
    assert "resolution" not in dict(aside.going_m.parts)
    for angle, over_m in ((first.fall_deg, DEPTH), (first.cross_fall_deg, WIDTH)):
        expected = math.degrees(math.sqrt(2.0) * one / over_m)
        assert dict(angle.parts)["resolution"] == pytest.approx(expected, rel=0.01)
    pitch = math.hypot(GOING * math.sqrt(2.0) * one, RISE * math.sqrt(2.0) * along) / (GOING**2 + RISE**2)
    assert dict(first.pitch_deg.parts)["resolution"] == pytest.approx(math.degrees(pitch), rel=0.01)


def test_the_faces_of_a_scanned_mesh_are_in_every_length_and_most_in_the_width():
    examined = Examination((), np.zeros(3), facet_m=0.01)
    step = survey_of(even(), examined=examined).steps[1]
    for value, share in ((step.rise_m, 0.025), (step.going_m, 0.06), (step.width_m, 1.8)):
        # At both ends, k = 2.
        assert dict(value.parts)["resolution"] == pytest.approx(2.0 * math.sqrt(2.0) * share * 0.01, rel=1e-6)
    # Noise does not average out what no corner shows, and rounding comes on top of it.
    noisy = [replace(s, plane=level_plane(s.plane.z0_m, sigma_m=0.004)) for s in even()]
    assert dict(survey_of(noisy, examined=examined).steps[1].rise_m.parts)["resolution"] > 0.0007
    rounded = survey_of(even(), examined=replace(examined, steps_m=np.array([0.0, 0.0, 0.002]))).steps[1]
    alone = survey_of(even(), examined=Examination((), np.array([0.0, 0.0, 0.002]))).steps[1]
    both = [dict(each.rise_m.parts)["resolution"] for each in (step, alone)]
    assert dict(rounded.rise_m.parts)["resolution"] == pytest.approx(math.hypot(*both), rel=1e-6)


def test_a_side_at_a_wall_does_not_end_early_in_a_mesh():
    examined = Examination((), np.zeros(3), facet_m=0.01)
    first, second, *others = even()
    walled = [first, replace(second, left=replace(second.left, is_wall=True)), *others]
    part = dict(survey_of(walled, examined=examined).steps[1].width_m.parts)["resolution"]
    assert part == pytest.approx(2.0 * 1.8 * 0.01, rel=1e-6)


def test_noise_averages_rounding_out_as_far_as_the_surest_surface_has_some():
    examined = Examination((), np.array([0.0, 0.0, 0.002]))
    noisy = [replace(s, plane=level_plane(s.plane.z0_m, sigma_m=0.004)) for s in even()]
    assert dict(survey_of(noisy, examined=examined).steps[1].rise_m.parts).get("resolution", 0.0) < 1e-5
    noisy[3] = even()[3]
    assert dict(survey_of(noisy, examined=examined).steps[1].rise_m.parts)["resolution"] > 0.0016


def test_noise_blurs_the_rounding_of_a_face_but_not_the_end_of_a_tread():
    examined = Examination((), np.array([0.002, 0.0, 0.0]))
    noisy = [replace(s, plane=level_plane(s.plane.z0_m, sigma_m=0.004)) for s in even()]
    assert dict(survey_of(noisy, examined=examined).steps[1].going_m.parts).get("resolution", 0.0) < 1e-5
    by_treads = [replace(s, front=line(0.0, source="tread")) for s in noisy]
    part = dict(survey_of(by_treads, examined=examined).steps[1].going_m.parts)["resolution"]
    assert part == pytest.approx(2.0 * math.sqrt(2.0) * 0.002 / math.sqrt(12.0), rel=0.01)


def test_layers_are_in_every_rise_and_slope():
    # One layer alone is either of the two; the mean of both lies anywhere between them.
    either, between = 2.0 * 0.012 / 2.0, 2.0 * 0.012 / math.sqrt(12.0)
    of_scan = survey_of(even(), examined=Examination((), np.zeros(3), np.array([[0.0, 0.0, 0.012]]))).steps
    doubled = survey_of([replace(s, plane=replace(s.plane, layers_m=0.012)) for s in even()]).steps
    for steps, one in ((of_scan, either), (doubled, between)):
        for step in steps[1:]:
            assert dict(step.rise_m.parts)["layers"] == pytest.approx(math.sqrt(2.0) * one, rel=1e-9)
            assert dict(step.fall_deg.parts)["layers"] == pytest.approx(
                math.degrees(math.sqrt(2.0) * one / DEPTH), rel=1e-9
            )
    # Of the floor nothing is known but what the whole scan shows.
    assert dict(of_scan[0].rise_m.parts)["layers"] == pytest.approx(math.sqrt(2.0) * either, rel=1e-9)


def test_a_strip_that_may_lie_on_half_of_a_tread_is_in_its_slope_across():
    plain = even()
    covered = [replace(s, plane=replace(s.plane, cover_m=0.01)) for s in plain]
    for angle in ("cross_fall_deg", "fall_deg"):
        parts = [
            dict(getattr(survey_of(shapes).steps[1], angle).parts).get("layers", 0.0) for shapes in (plain, covered)
        ]
        assert parts[0] == 0.0
        # The least squares plane of a step of t in the middle of a width w has the slope 3 t / (2 w).
        over_m = WIDTH if angle == "cross_fall_deg" else DEPTH
        assert parts[1] >= math.degrees(1.5 * 0.01 / over_m)
        assert parts[1] < 2.0 * math.degrees(1.5 * 0.01 / over_m)


@pytest.mark.parametrize(
    ("shift", "lengths"),
    [
        ([0.012, 0.0, 0.0], ("going_m", "tread_depth_m", "nosing_overhang_m")),
        ([0.0, 0.012, 0.0], ("width_m",)),
        ([0.0, 0.0, -0.004], ("rise_m",)),
    ],
)
def test_layers_are_in_what_is_measured_along_their_shift_and_in_nothing_else(shift, lengths):
    step = survey_of(even(), examined=Examination((), np.zeros(3), np.array([shift]))).steps[1]
    for quantity in LENGTHS:
        # At either end one layer may have been found or the other.
        expected = math.sqrt(2.0) * max(map(abs, shift)) if quantity in lengths else 0.0
        assert dict(getattr(step, quantity).parts).get("layers", 0.0) == pytest.approx(expected, rel=1e-9), quantity


def test_where_treads_are_torn_in_height_a_nosing_may_be_the_riser_behind_it():
    for apart_m, is_torn in ((0.006, False), (0.012, True)):
        shift = np.array([[0.0, 0.0, apart_m]])
        step = survey_of(even(), examined=Examination((), np.zeros(3), shift)).steps[1]
        expected = 2.0 * math.sqrt(2.0) * priors.DEEPEST_OVERHANG_M / math.sqrt(12.0) if is_torn else 0.0
        assert dict(step.going_m.parts).get("layers", 0.0) == pytest.approx(expected, rel=1e-9)


def test_layers_of_one_tread_are_its_own_and_of_most_are_all_treads():
    one = 2.0 * 0.012 / math.sqrt(12.0)
    shapes = even()
    shapes[1] = replace(shapes[1], plane=replace(shapes[1].plane, layers_m=0.012))
    parts = [dict(step.rise_m.parts).get("layers", 0.0) for step in survey_of(shapes).steps]
    assert parts == pytest.approx([0.0, one, one, 0.0], rel=1e-9)
    for k in (2, 3):
        shapes[k] = replace(shapes[k], plane=replace(shapes[k].plane, layers_m=0.012))
    # The first tread and the floor show one layer, of which nobody knows which.
    either = 2.0 * 0.012 / 2.0
    assert dict(survey_of(shapes).steps[0].rise_m.parts)["layers"] == pytest.approx(math.sqrt(2.0) * either, rel=1e-9)


# What each quantity of the second of four steps hangs on: which shape, 1 for its own and 2 for the next one, and what
# of it.
EDGES_OF = {
    "going_m": [(1, "front"), (2, "front")],
    "tread_depth_m": [(1, "front"), (1, "back")],
    "nosing_overhang_m": [(1, "back"), (2, "front")],
    "width_m": [(1, "left"), (1, "right")],
}
LENGTHS = ("rise_m", *EDGES_OF)
PLAIN = level_plane()


def parts_with(k, name, **changes):
    """The parts of the second step's values when one edge of the shapes differs."""
    shapes = even()
    shapes[k] = replace(shapes[k], **{name: replace(getattr(shapes[k], name), **changes)})
    step = survey_of(shapes).steps[1]
    return {quantity: dict(getattr(step, quantity).parts) for quantity in LENGTHS}


@pytest.mark.parametrize("edge", sorted({edge for edges in EDGES_OF.values() for edge in edges}))
def test_the_noise_and_the_doubt_of_every_edge_are_in_what_hangs_on_it_and_in_nothing_else(edge):
    plain = parts_with(*edge)
    noisy = parts_with(*edge, noise_m=0.003)
    # That only the tread shows the edge.
    doubted = parts_with(*edge, source="tread")
    more = math.sqrt(edge_doubt(line(0.0, source="tread"), PLAIN) ** 2 - edge_doubt(line(0.0), PLAIN) ** 2)
    assert more > 0.00005
    for quantity, edges in EDGES_OF.items():
        hangs = edge in edges
        assert noisy[quantity].get("noise", 0.0) == pytest.approx(2.0 * 0.003 if hangs else 0.0, rel=1e-9)
        added = math.sqrt(doubted[quantity]["edge"] ** 2 - plain[quantity]["edge"] ** 2)
        assert added == (pytest.approx(2.0 * more, rel=1e-6) if hangs else 0.0)


def test_every_edge_of_a_length_has_the_doubt_of_its_definition():
    plain = parts_with(1, "front")
    for quantity in EDGES_OF:
        assert plain[quantity]["edge"] == pytest.approx(2.0 * math.sqrt(2.0) * edge_doubt(line(0.0), PLAIN))


def test_what_is_stated_is_in_every_length():
    step = survey_of(even(), doubts=UncertaintyParams(registration_m=0.004, scale_percent=0.4)).steps[1]
    for quantity, length_m in zip(LENGTHS[:3] + LENGTHS[4:], (RISE, GOING, DEPTH, WIDTH), strict=True):
        parts = dict(getattr(step, quantity).parts)
        assert parts["registration"] == pytest.approx(2.0 * 0.004, rel=1e-9), quantity
        assert parts["scale"] == pytest.approx(2.0 * 0.004 * length_m, rel=1e-9), quantity
    # Between two edges at one place registration adds less.
    assert dict(step.nosing_overhang_m.parts)["registration"] == pytest.approx(0.004, rel=1e-9)


def test_a_side_that_is_stated_to_be_unsure_is_so_on_both_sides():
    step = survey_of(even(), doubts=UncertaintyParams(side_m=0.01)).steps[1]
    assert dict(step.width_m.parts)["edge"] == pytest.approx(2.0 * math.sqrt(2.0) * 0.01, rel=0.01)


def test_up_is_in_every_length_between_two_heights_or_two_places_and_in_every_angle():
    up = Up(np.array([0.0, 0.0, 1.0]), "floor", u_deg=1.0)
    step = survey_of(even(), up=up).steps[1]
    for quantity, apart_m in (("rise_m", GOING), ("going_m", RISE), ("nosing_overhang_m", RISE)):
        expected = math.radians(1.0) * apart_m
        assert dict(getattr(step, quantity).parts)["up"] == pytest.approx(expected, rel=1e-6), quantity
    for quantity in ("pitch_deg", "fall_deg", "cross_fall_deg"):
        assert dict(getattr(step, quantity).parts)["up"] == pytest.approx(1.0, rel=1e-6), quantity


def test_limits_of_a_hidden_back_are_in_depth_and_overhang():
    shapes = even()
    shapes[1] = replace(shapes[1], back=None, back_limits=(0.28, 0.36))
    step = survey_of(shapes).steps[1]
    for quantity in ("tread_depth_m", "nosing_overhang_m"):
        assert dict(getattr(step, quantity).parts)["edge"] == pytest.approx(0.04, rel=0.001)
    # The nosing in front is as unsure as ever.
    step = survey_of(shapes, doubts=UncertaintyParams(edge_m=0.02)).steps[1]
    assert dict(step.tread_depth_m.parts)["edge"] == pytest.approx(math.hypot(0.04, 0.04), rel=0.001)


def test_the_fall_of_a_tread_is_as_unsure_as_its_plane_and_its_surface():
    def noise_of(plane):
        shapes = [replace(s, plane=replace(plane, z0_m=s.plane.z0_m)) for s in even()]
        step = survey_of(shapes).steps[1]
        return dict(step.fall_deg.parts).get("noise", 0.0), dict(step.cross_fall_deg.parts).get("noise", 0.0)

    by_points = replace(level_plane(), covariance=np.diag([0.0, 0.002**2, 0.003**2]))
    assert noise_of(by_points) == pytest.approx([2.0 * math.degrees(0.002), 2.0 * math.degrees(0.003)], rel=1e-6)
    # What of smooth errors a fit does not see tips a tread along the climb.
    smooth = level_plane(sigma_m=0.001)
    expected = 2.0 * math.degrees(slope_doubt(smooth, DEPTH))
    assert noise_of(smooth) == pytest.approx([expected, 0.0], rel=1e-6)
    both = replace(smooth, covariance=by_points.covariance)
    assert noise_of(both)[0] == pytest.approx(math.hypot(2.0 * math.degrees(0.002), expected), rel=1e-6)


def test_the_pitch_has_what_its_going_and_its_rise_have():
    shapes = even()
    shapes[2] = replace(shapes[2], front=line(0.0, noise_m=0.003), nosing_noise=(0.0, 0.002, 0.0))
    step = survey_of(shapes).steps[1]
    rise, going = (dict(value.parts) for value in (survey_of(shapes).steps[2].rise_m, step.going_m))
    assert (rise["noise"], going["noise"]) == (pytest.approx(0.004), pytest.approx(0.006))
    expected = math.hypot(GOING * 0.004, RISE * 0.006) / (GOING**2 + RISE**2)
    assert dict(step.pitch_deg.parts)["noise"] == pytest.approx(math.degrees(expected), rel=1e-9)


def test_a_mean_width_is_surer_about_noise_alone():
    shapes = [replace(s, left=line(WIDTH / 2, noise_m=0.004, along_m=DEPTH / 2)) for s in even(4)]
    survey = survey_of(shapes, doubts=UncertaintyParams(registration_m=0.001))
    one, mean = dict(survey.steps[0].width_m.parts), dict(survey.flights[0].width_m.parts)
    assert mean["noise"] == pytest.approx(one["noise"] / 2.0, rel=1e-9)
    assert mean["registration"] == pytest.approx(one["registration"], rel=1e-9)


def test_a_scan_of_which_nothing_is_stated_says_that_u_is_not_all():
    assert codes(survey_of(even(), doubts=UncertaintyParams())) == [("uncertainty_unstated", None)]
    # What says nothing about registration, levelling or rounding leaves that to be stated.
    assert codes(survey_of(even(), doubts=UncertaintyParams(side_m=0.05, slope_deg=5.0, scale_percent=1.0))) == [
        ("uncertainty_unstated", None)
    ]
    assert codes(survey_of(even(), doubts=UncertaintyParams(up_deg=0.01))) == []


# --- flights -------------------------------------------------------------------------------------------------------


def test_statistics_of_a_flight():
    heights = np.cumsum([0.17, 0.17, 0.178, 0.162, 0.17])
    shapes = [replace(s, plane=level_plane(z)) for s, z in zip(even(5), heights, strict=True)]
    rise = survey_of(shapes).flights[0].rise
    assert (rise.n, rise.at) == (5, (3, 4))
    assert (rise.mean, rise.min, rise.max) == pytest.approx((0.17, 0.162, 0.178), abs=1e-12)
    assert (rise.range, rise.max_adjacent) == pytest.approx((0.016, 0.016), abs=1e-12)


def test_one_value_has_no_neighbour():
    going = survey_of(even(2)).flights[0].going
    assert (going.n, going.max_adjacent, going.at, going.range) == (1, None, None, 0.0)


def test_the_pitch_of_a_flight_fits_all_nosings():
    heights = [RISE * k + (0.01 if k == 3 else 0.0) for k in range(1, 7)]
    shapes = [replace(s, plane=level_plane(z)) for s, z in zip(even(6), heights, strict=True)]
    run = GOING * np.arange(6)
    slope = np.polyfit(run, heights, 1)[0]
    assert survey_of(shapes).flights[0].pitch_deg.value == pytest.approx(math.degrees(math.atan(slope)), abs=1e-9)


def test_the_pitch_of_a_flight_of_two_nosings_is_as_unsure_as_that_from_one_to_the_other():
    shapes = even(2)
    shapes[1] = replace(shapes[1], front=line(0.0, noise_m=0.003), nosing_noise=(0.0, 0.002, 0.0))
    up = Up(np.array([0.0, 0.0, 1.0]), "floor", u_deg=1.0)
    survey = survey_of(shapes, up=up, doubts=UncertaintyParams(registration_m=0.004, edge_m=0.001))
    flight, step = (dict(pitch.parts) for pitch in (survey.flights[0].pitch_deg, survey.steps[0].pitch_deg))
    assert flight["noise"] == pytest.approx(step["noise"], rel=1e-6)
    assert flight["up"] == pytest.approx(1.0, rel=1e-9)
    per_metre = math.degrees(1.0) / (1.0 + (RISE / GOING) ** 2)
    assert flight["registration"] == pytest.approx(2.0 * 0.004 / GOING * per_metre, rel=1e-6)
    going = dict(survey.steps[0].going_m.parts)["edge"]
    assert flight["edge"] == pytest.approx(RISE / GOING * going / GOING * per_metre, rel=1e-6)


def test_steps_are_counted_through_the_flights():
    lower = even(3)
    upper = [
        shape(k, ((k - 1) * GOING + 1.0, 0.0), k * RISE, foot=level_plane(3 * RISE) if k == 4 else None)
        for k in range(4, 7)
    ]
    survey = survey_of(lower, (chain_of(upper, base=3), upper))
    assert [step.step_id for step in survey.steps] == [1, 2, 3, 4, 5, 6]
    assert [step.flight for step in survey.steps] == [1, 1, 1, 2, 2, 2]
    assert [flight.step_ids for flight in survey.flights] == [(1, 2, 3), (4, 5, 6)]
    # The step at which another flight begins is a landing, however deep.
    assert [step.kind for step in survey.steps] == ["tread", "tread", "landing", "tread", "tread", "tread"]
    assert survey.surfaces == (1, 2, 3, 4, 5, 6)
    # The landing goes on straight to the next flight's first nosing.
    assert survey.steps[2].going_m.value == pytest.approx(GOING + 1.0, abs=1e-12)
    assert values(survey, "rise_m") == pytest.approx([RISE] * 6, abs=1e-12)


def test_a_deep_last_step_is_a_landing_and_a_forced_one_too():
    shapes = even(4)
    shapes[3] = replace(shapes[3], extent=(0.0, 1.2, -0.5, 0.5))
    assert [step.kind for step in survey_of(shapes).steps] == ["tread"] * 3 + ["landing"]
    forced = Forced({2: "landing"})
    assert [step.kind for step in survey_of(even(4), forced=forced).steps][1] == "landing"


def winding(n, turn_deg, radius_m=0.6):
    """Steps about a column, to the left."""
    shapes = []
    for k in range(1, n + 1):
        angle = math.radians(turn_deg) * (k - 1)
        climb = np.array([math.cos(angle), math.sin(angle)])
        middle = radius_m * np.array([math.sin(angle), -math.cos(angle)])
        shapes.append(shape(k, middle, k * RISE, climb=climb, foot=level_plane() if k == 1 else None))
    return shapes


@pytest.mark.parametrize(("n", "turn_deg", "name"), [(4, 25.0, "winder"), (10, 25.0, "spiral"), (8, 0.2, "straight")])
def test_the_shape_of_a_flight(n, turn_deg, name):
    survey = survey_of(winding(n, turn_deg, 60.0 if turn_deg < 1.0 else 0.6))
    assert survey.flights[0].shape == name


def test_a_winding_flight_is_measured_about_each_steps_own_axis():
    shapes = winding(8, 25.0)
    survey = survey_of(shapes)
    for step, own in zip(survey.steps, shapes, strict=True):
        np.testing.assert_allclose(step.climb[:2], own.climb, atol=1e-12)
    # From one nosing's middle square to it, to the next nosing: r tan(25 degrees).
    goings = [step.going_m.value for step in survey.steps[:-1]]
    assert goings == pytest.approx([0.6 * math.tan(math.radians(25.0))] * 7, abs=1e-9)
    assert values(survey, "rise_m") == pytest.approx([RISE] * 8, abs=1e-12)


def test_one_odd_nosing_does_not_turn_the_common_climb():
    shapes = even(6)
    shapes[3] = replace(shapes[3], front=line(0.0, slope=0.2))
    for climb in find_climbs(chain_of(shapes), tuple(shapes)):
        np.testing.assert_allclose(climb, ALONG_X, atol=1e-12)


@pytest.mark.parametrize("sides", [("left",), ("right",), ("left", "right")])
def test_not_knowing_the_sides_of_a_wedge_is_not_knowing_where_its_going_is_measured(sides):
    shapes = winding(8, 25.0)
    plain = survey_of(shapes).steps[3].going_m
    shapes[3] = replace(shapes[3], **{side: replace(getattr(shapes[3], side), noise_m=0.01) for side in sides})
    unsure = survey_of(shapes).steps[3].going_m
    added = math.sqrt(dict(unsure.parts)["edge"] ** 2 - dict(plain.parts)["edge"] ** 2)
    # The middle moves by half of what a side does, and the going grows by the turn's tangent with every metre outwards.
    moved_m = math.sqrt(len(sides)) * 0.01 / 2.0
    assert added == pytest.approx(2.0 * moved_m * math.tan(math.radians(25.0)), rel=1e-6)
