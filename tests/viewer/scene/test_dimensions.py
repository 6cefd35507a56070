"""The dimensions of a step: each arrow is as long as what it says, and lies where it was measured."""

import dataclasses

import numpy as np
import pytest

from stair_inspector.model import Measured
from stair_inspector.viewer.scene.dimensions import dimensions_of
from tests.synthetic import rotation
from tests.viewer.surveyed import DEPTH, GOING, RISE, WIDTH, surveyed

LIFT = 0.01
TURNS = [np.eye(3), rotation("z", 130.0), rotation("x", 75.0) @ rotation("y", -40.0)]


@pytest.fixture(scope="module")
def inspection():
    return surveyed()[1]


def arrows_along(dimensions, direction, length):
    """The lines of a direction and a length, whichever way they point."""
    moves = dimensions.arrows[:, 1] - dimensions.arrows[:, 0]
    is_long = np.abs(np.abs(moves @ direction) - length) < 1e-9
    return dimensions.arrows[is_long & (np.abs(np.linalg.norm(moves, axis=1) - length) < 1e-9)]


@pytest.mark.parametrize("turn", TURNS)
def test_every_dimension_is_an_arrow_of_its_own_length_above_or_before_the_nosing(turn):
    _, inspection, _ = surveyed(turn)
    climb, left, up = turn.T
    step = inspection.steps[1]
    centre = turn @ np.array([GOING, WIDTH / 2.0, 2 * RISE])
    dimensions = dimensions_of(inspection, step, LIFT)
    for direction, length, begins, aside in (
        (climb, GOING, 0.0, up),
        (climb, DEPTH, 0.0, up),
        (up, step.rise_m.value, -step.rise_m.value, -climb),
        (left, WIDTH, -WIDTH / 2.0, -climb),
    ):
        (arrow,) = arrows_along(dimensions, direction, length)
        along = np.sort((arrow - centre) @ direction)
        np.testing.assert_allclose(along, [begins, begins + length], atol=1e-6)
        # Clear of the surface, and not far from it.
        clear = (arrow - centre) @ aside
        assert clear.min() == pytest.approx(clear.max())
        assert LIFT < clear.min() < LIFT + 0.1


def test_the_labels_give_value_uncertainty_and_unit(inspection):
    dimensions = dimensions_of(inspection, inspection.steps[0], LIFT)
    assert [label.text for label in dimensions.labels] == [
        "going 280.0 ± 0.4 mm",
        "tread depth 300 ± 12 mm",
        "rise 170.1 ± 0.4 mm",
        "width 1000.00 ± 0.04 mm",
    ]


def test_the_labels_lie_at_their_arrows_and_run_away_from_each_other(inspection):
    step = inspection.steps[0]
    dimensions = dimensions_of(inspection, step, LIFT)
    places = {label.text.split(" ")[0]: label for label in dimensions.labels}
    assert {name: label.anchor for name, label in places.items()} == {
        "going": "bottom-right",
        "tread": "bottom-left",
        "rise": "top-left",
        "width": "top-right",
    }
    left = np.array([0.0, 1.0, 0.0])
    assert (places["going"].position - places["tread"].position) @ left > 0.05
    ends = dimensions.arrows.reshape(-1, 3)
    for name, label in places.items():
        middles = dimensions.arrows.mean(axis=1)
        near = np.vstack([ends, middles])
        assert np.linalg.norm(near - label.position, axis=1).min() < 0.021, name


@pytest.mark.parametrize("turn", TURNS)
def test_the_measuring_lines_go_along_the_climb_and_straight_down_from_their_points(turn):
    _, inspection, _ = surveyed(turn)
    climb, _, up = turn.T
    step = inspection.steps[0]
    lines = dimensions_of(inspection, step, LIFT).measuring
    # Left and centre have both, the right one has no going.
    moves = [GOING * climb, -(RISE - 0.001) * up, GOING * climb, -RISE * up, -(RISE + 0.001) * up]
    np.testing.assert_allclose(lines[:, 1] - lines[:, 0], moves, atol=1e-9)
    owners = step.line_points[[0, 0, 1, 1, 2]]
    lifts = [LIFT * up, -LIFT * climb, LIFT * up, -LIFT * climb, -LIFT * climb]
    np.testing.assert_allclose(lines[:, 0], owners + lifts, atol=1e-9)


def test_heads_lie_at_the_ends_inside_their_arrow_and_extension_lines_reach_the_step(inspection):
    step = dataclasses.replace(inspection.steps[0], going_m=None, tread_depth_m=None, width_m=None)
    dimensions = dimensions_of(inspection, step, LIFT)
    shaft, first, last, *barbs = dimensions.arrows
    low, high = sorted(shaft[:, 2])
    assert len(barbs) == 8
    for barb in barbs:
        assert barb[0, 2] in (low, high)
        assert low < barb[1, 2] < high
        assert 0.02 < np.linalg.norm(barb[1] - barb[0]) < 0.04
    centre = step.line_points[1]
    np.testing.assert_allclose(first[0], centre)
    np.testing.assert_allclose(last[0], centre - [0.0, 0.0, step.rise_m.value])
    # Beyond the arrow, on the straight line through its end.
    np.testing.assert_allclose(np.cross(first[1] - first[0], shaft[0] - first[0]), 0.0, atol=1e-12)
    assert np.linalg.norm(first[1] - first[0]) > np.linalg.norm(shaft[0] - first[0])


@pytest.mark.parametrize("missing", ["rise_m", "going_m", "tread_depth_m", "width_m"])
def test_what_was_not_measured_has_no_arrow_and_no_label(inspection, missing):
    step = inspection.steps[0]
    all_of_it = dimensions_of(inspection, step, LIFT)
    fewer = dimensions_of(inspection, dataclasses.replace(step, **{missing: None}), LIFT)
    word = missing.split("_")[0]
    kept = [label.text for label in all_of_it.labels if not label.text.startswith(word)]
    assert [label.text for label in fewer.labels] == kept
    assert len(kept) == 3
    assert len(fewer.arrows) == 3 * len(all_of_it.arrows) // 4


@pytest.mark.parametrize(
    ("changes", "n_measuring", "n_labels"),
    [
        ({"rise_lcr_m": None, "going_lcr_m": None}, 0, 4),
        ({"rise_lcr_m": None, "going_lcr_m": (None, GOING, None)}, 1, 4),
        ({"line_points": None}, 0, 4),
        ({"nosing": None}, 0, 0),
        ({"climb": None}, 0, 0),
        ({"rise_m": None, "going_m": None, "tread_depth_m": None, "width_m": None}, 5, 0),
    ],
)
def test_a_step_of_which_little_is_known_draws_what_there_is(inspection, changes, n_measuring, n_labels):
    dimensions = dimensions_of(inspection, dataclasses.replace(inspection.steps[0], **changes), LIFT)
    assert dimensions.measuring.shape == (n_measuring, 2, 3)
    assert len(dimensions.labels) == n_labels
    assert dimensions.arrows.shape[1:] == (2, 3)


def test_a_landing_at_the_top_has_no_going(inspection):
    dimensions = dimensions_of(inspection, inspection.steps[-1], LIFT)
    assert [label.text.split(" ")[0] for label in dimensions.labels] == ["tread", "rise", "width"]
    assert dimensions.measuring.shape == (3, 2, 3)


def test_the_steps_of_the_paper_have_no_dimensions(inspection):
    blank = {"nosing": None, "climb": None, "line_points": None, "rise_m": None, "going_m": None}
    dimensions = dimensions_of(inspection, dataclasses.replace(inspection.steps[0], **blank), LIFT)
    assert (len(dimensions.measuring), len(dimensions.arrows), dimensions.labels) == (0, 0, ())


def test_a_value_of_zero_is_drawn_without_a_head(inspection):
    step = dataclasses.replace(
        inspection.steps[0], rise_m=Measured(0.0, 0.001), going_m=None, tread_depth_m=None, width_m=None
    )
    dimensions = dimensions_of(inspection, step, LIFT)
    assert dimensions.arrows.shape == (3, 2, 3)
    assert np.isfinite(dimensions.arrows).all()
    assert dimensions.labels[0].text == "rise 0.0 ± 1.0 mm"
