"""Each colour tells what its legend says: read back from the colours themselves, point by point."""

import numpy as np
import pytest

from stair_inspector.content.segmented_points import residuals_at
from stair_inspector.errors import ConfigError
from stair_inspector.pictures.coloring import (
    COLOR_MODES,
    color_points,
    crease_of,
    residual_legend,
    shade,
)
from stair_inspector.pictures.display import choose_display, display_of
from stair_inspector.pictures.ramps import DIVERGING, NOT_COLORED, VIRIDIS, color_signed, signed_limit
from stair_inspector.pictures.segmentation import draw, view_from_local
from tests.synthetic import rotation
from tests.viewer.surveyed import PALETTE, RISE, STAIR, surveyed

TURN = rotation("x", 75.0) @ rotation("y", -40.0)


@pytest.fixture(scope="module")
def measured():
    return surveyed()


def exact_normals():
    return STAIR.sample()[1]


def test_by_step_the_colours_are_those_that_are_drawn(measured):
    scan, inspection, display = measured
    for with_rejected in (False, True):
        drawing = draw(inspection, display, scan.points, PALETTE, with_rejected=with_rejected)
        coloring = color_points("Step", inspection, display, PALETTE, with_rejected=with_rejected)
        np.testing.assert_array_equal(coloring.colors, drawing.colors)
    meant = dict(coloring.legend.entries)
    assert meant[PALETTE.floor] == "floor"
    assert meant[PALETTE.rejected].startswith("rejected")
    assert set(PALETTE.steps) <= set(meant)


def test_by_height_equal_heights_have_equal_colours_and_the_ends_are_those_of_the_scale(measured):
    _, inspection, display = measured
    coloring = color_points("Height", inspection, display, PALETTE)
    heights = display.points[:, 2]
    assert (coloring.colors[heights <= np.percentile(heights, 0.4)] == VIRIDIS[0]).all()
    assert (coloring.colors[heights >= np.percentile(heights, 99.6)] == VIRIDIS[-1]).all()
    # The scan frame's heights: the origin is 300 m up.
    low, high = (float(words) for _, words in (coloring.legend.ramp.ticks[0], coloring.legend.ramp.ticks[-1]))
    assert low == pytest.approx(300.0, abs=0.01)
    assert high == pytest.approx(300.0 + 5 * RISE, abs=0.01)
    assert "[m]" in coloring.legend.title


def test_heights_are_along_up_also_in_a_turned_scan():
    _, inspection, display = surveyed(TURN)
    coloring = color_points("Height", inspection, display, PALETTE)
    heights = display.points @ TURN[:, 2]
    for share, wanted in ((0.0, VIRIDIS[0]), (1.0, VIRIDIS[-1])):
        at = np.abs(heights - np.quantile(heights, share)) < 1e-9
        np.testing.assert_array_equal(np.unique(coloring.colors[at], axis=0), [wanted])


def test_by_normal_treads_are_blue_and_risers_green_whichever_way_a_normal_points():
    _, inspection, display = surveyed(TURN)
    normals = exact_normals() @ TURN.T
    axes = view_from_local(inspection)
    is_tread = exact_normals()[display.point_ids, 2] > 0.5
    for sign in (1.0, -1.0):
        colors = color_points("Normal", inspection, display, PALETTE, normals=sign * normals, axes=axes).colors
        assert np.abs(colors[is_tread].astype(int) - (0, 0, 255)).max() <= 1
        assert np.abs(colors[~is_tread].astype(int) - (0, 255, 0)).max() <= 1


def test_by_normal_without_normals_is_a_sentence(measured):
    _, inspection, display = measured
    with pytest.raises(ConfigError, match="normals are not there yet"):
        color_points("Normal", inspection, display, PALETTE)


def test_the_residual_is_the_signed_distance_from_the_points_own_plane(measured):
    _, inspection, display = measured
    residuals = residuals_at(inspection, display.points, display.point_ids)
    labels = inspection.labels[display.point_ids]
    assert np.isnan(residuals[labels < 0]).all()
    assert np.isfinite(residuals[labels >= 0]).all()
    for step in inspection.steps:
        own = residuals[labels == step.step_id]
        # The plane is that of these points: they lie to both sides, as far as its RMS says.
        assert own.mean() == pytest.approx(0.0, abs=1e-9)
        assert np.sqrt(np.mean(own**2)) == pytest.approx(step.plane.rms_m, rel=1e-6)
    row = int(np.nonzero(labels == 3)[0][0])
    lifted = display.points.copy()
    lifted[row] += 0.004 * inspection.steps[2].plane.normal
    moved = residuals_at(inspection, lifted, display.point_ids)
    assert moved[row] - residuals[row] == pytest.approx(0.004)


def test_above_is_red_below_is_blue_none_is_grey_and_beyond_the_end_is_the_end():
    colors = color_signed(np.array([-0.01, -0.002, 0.0, 0.002, 0.01, np.nan]), 0.002)
    assert [tuple(color) for color in colors.tolist()] == [
        DIVERGING[0],
        DIVERGING[0],
        DIVERGING[4],
        DIVERGING[-1],
        DIVERGING[-1],
        NOT_COLORED,
    ]
    assert DIVERGING[0][2] > DIVERGING[0][0]
    assert DIVERGING[-1][0] > DIVERGING[-1][2]


def test_the_scale_of_residuals_is_the_same_to_both_sides_in_millimetres(measured):
    _, inspection, display = measured
    limit_m = signed_limit(residuals_at(inspection, display.points, display.point_ids))
    assert color_points("Residual", inspection, display, PALETTE).legend == residual_legend(limit_m)
    legend = residual_legend(0.005)
    assert [words for _, words in legend.ramp.ticks] == ["−5", "−2.5", "0", "+2.5", "+5"]
    assert "[mm]" in legend.title
    assert legend.entries == ((NOT_COLORED, "of no step"),)
    assert residual_legend(0.005, with_others=False).entries == ()


@pytest.mark.parametrize(
    ("worst_mm", "limit_mm"), [(0.0, 0.5), (0.3, 0.5), (0.7, 1.0), (1.0, 1.0), (1.01, 2.0), (4.9, 5.0), (60.0, 100.0)]
)
def test_the_limit_that_is_chosen_is_round_and_not_below_the_residuals(worst_mm, limit_mm):
    residuals = np.array([np.nan, -worst_mm, worst_mm, worst_mm, -worst_mm]) / 1000.0
    assert signed_limit(residuals) == pytest.approx(limit_mm / 1000.0)


def test_without_a_single_residual_there_is_a_scale_all_the_same(measured):
    scan, inspection, _ = measured
    assert signed_limit(np.array([np.nan])) == 0.0005
    nothing = display_of(scan, np.zeros(0, dtype=np.int64))
    for mode in COLOR_MODES:
        coloring = color_points(mode, inspection, nothing, PALETTE, normals=exact_normals(), axes=np.eye(3))
        assert coloring.colors.shape == (0, 3)


def test_original_is_the_scans_own(measured):
    _, inspection, display = measured
    assert color_points("Original", inspection, display, PALETTE).colors is display.colors


@pytest.mark.parametrize("mode", COLOR_MODES)
def test_every_mode_has_a_colour_for_every_drawn_point_and_a_legend(measured, mode):
    scan, inspection, _ = measured
    few = choose_display(scan, 500)
    coloring = color_points(mode, inspection, few, PALETTE, normals=exact_normals(), axes=np.eye(3))
    assert coloring.colors.shape == (500, 3)
    assert coloring.colors.dtype == np.uint8
    assert coloring.legend.title


def test_a_crease_is_where_tread_and_riser_meet_and_nowhere_else():
    points = np.concatenate([part for part, _ in STAIR.parts()])
    crease = crease_of(points, exact_normals(), 0.02)
    edges = [((k - 1) * STAIR.going, height * STAIR.rise) for k in STAIR.step_ids for height in (k - 1, k)]
    to_edge = np.min([np.hypot(points[:, 0] - x, points[:, 2] - z) for x, z in edges], axis=0)
    # The cells are three spacings wide: nothing farther than a cell's diagonal from an edge can be one.
    assert crease[to_edge > 0.02 * 3.0 * np.sqrt(2.0)].max() == 0.0
    # The point beside an edge shares at least one of its two cells with points of the other surface.
    assert crease[to_edge < 0.01].mean() > 0.5
    assert crease.max() <= 1.0


def test_shading_darkens_creases_and_what_turns_from_the_light_and_keeps_the_hue():
    normals = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    colors = np.tile(np.array([[200, 100, 50]], dtype=np.uint8), (4, 1))
    shaded = shade(colors, normals, np.eye(3), np.array([0.0, 0.0, 0.0, 1.0])).astype(int)
    top, bottom, side, crease = shaded
    assert (top == bottom).all()
    assert (side < top).all()
    assert (crease < side).all()
    assert (shaded <= colors).all()
    np.testing.assert_allclose(shaded / shaded[:, :1], np.tile([[1.0, 0.5, 0.25]], (4, 1)), atol=0.02)
