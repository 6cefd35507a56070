"""What changed is seen in colour where it is: at the points of either scan, and on the sheets of maps."""

import dataclasses
import io

import numpy as np
import pytest
from PIL import Image

from stair_inspector.files.palettes import read_palette
from stair_inspector.model import ComparedScan
from stair_inspector.pictures.change_sheets import change_sheets, map_pixels, map_width_m
from stair_inspector.pictures.changes import change_legend, change_limit, deviations_at
from stair_inspector.pictures.coloring import color_points
from stair_inspector.pictures.display import choose_display
from stair_inspector.pictures.ramps import DIVERGING, NOT_COLORED, color_signed
from stair_inspector.pictures.tread_sheets import INK, layout_of
from tests.comparison.epochs import LAST, SETTLED, TURNED, WORN, compared, epoch


@pytest.mark.parametrize("is_earlier", [True, False])
def test_points_of_either_scan_have_the_deviation_of_their_tread(is_earlier):
    scan, inspection = epoch(1, is_moved=False) if is_earlier else epoch(51, True)
    rows = np.arange(len(scan.points))
    found = deviations_at(ComparedScan(compared(True), is_earlier), inspection, scan.points, rows)
    for k in range(1, LAST + 1):
        of_it = found[inspection.labels == k]
        assert np.isfinite(of_it).mean() > 0.8
        if k != TURNED:
            expected = -0.004 if k >= SETTLED else 0.0
            assert np.nanmedian(of_it) == pytest.approx(expected, abs=0.0003)
    assert np.isnan(found[inspection.labels < 1]).all()
    turned = found[inspection.labels == TURNED]
    # Half of the width times the tangent of 1 degree, to both sides.
    assert np.nanpercentile(turned, [2, 98]) == pytest.approx([-0.0083, 0.0083], abs=0.0008)


def test_points_are_coloured_by_the_change_and_grey_without_a_second_scan():
    scan, inspection = epoch(1, is_moved=False)
    display, palette = choose_display(scan), read_palette("page")
    seen = color_points("Change", inspection, display, palette, compared=ComparedScan(compared(True), True))
    assert seen.legend == change_legend(change_limit(compared(True)), "no tread that both scans saw")
    settled = seen.colors[inspection.labels[display.point_ids] == LAST]
    lower = color_signed(np.array([-0.004]), change_limit(compared(True)))[0]
    assert np.abs(np.median(settled, axis=0) - lower).max() <= 6
    none = color_points("Change", inspection, display, palette)
    assert (none.colors == NOT_COLORED).all()
    assert none.legend.title == "no second scan is compared yet"


def test_the_legend_has_millimetres_to_both_sides():
    legend = change_legend(0.005, "not seen")
    assert [words for _, words in legend.ramp.ticks] == ["−5", "−2.5", "0", "+2.5", "+5"]
    assert "[mm]" in legend.title
    assert legend.entries == ((NOT_COLORED, "not seen"),)


def test_the_map_of_a_worn_tread_has_its_nosing_below_and_a_line_around_the_strip():
    step = next(step for step in compared(True).steps if step.before_id == WORN)
    found = step.deviations
    layout = layout_of(1, map_width_m(found), 400)
    pixels = map_pixels(found, 0.005, layout).astype(int)
    cell = round(found.cell_m * layout.pixels_per_m)
    rows, columns = np.nonzero((pixels == INK).all(axis=2))
    assert rows.min() >= len(pixels) - 2 * cell - 1
    assert rows.max() == len(pixels) - 1
    assert columns.min() <= 2 * cell
    assert columns.max() >= pixels.shape[1] - 2 * cell
    middle = pixels[len(pixels) - cell // 2, pixels.shape[1] // 2]
    assert middle[2] - middle[0] > 60
    back = pixels[: 2 * cell].reshape(-1, 3)
    assert np.abs(back - DIVERGING[4]).max() < 60


def test_left_of_the_map_is_left_of_who_climbs():
    step = next(step for step in compared(True).steps if step.before_id == TURNED)
    pixels = map_pixels(step.deviations, 0.01, layout_of(1, map_width_m(step.deviations), 400)).astype(int)
    # Its left, where the stair frame's y is large, was raised.
    left, right = pixels[:, 2].mean(axis=0), pixels[:, -3].mean(axis=0)
    assert left[0] > left[2]
    assert right[2] > right[0]


def test_a_sheet_shows_all_treads_and_nothing_is_drawn_without_any():
    (sheet,) = change_sheets(ComparedScan(compared(True), True), "2026-01-01", width=800)
    picture = np.asarray(Image.open(io.BytesIO(sheet)).convert("RGB")).astype(int)
    assert picture.shape[1] == 800
    # The ends of the turned tread.
    reddest, bluest = (np.abs(picture - DIVERGING[end]).sum(axis=2) < 100 for end in (-1, 0))
    assert reddest.sum() > 300
    assert bluest.sum() > 300
    found = compared(True)
    unseen = tuple(dataclasses.replace(step, deviations=None) for step in found.steps)
    assert change_sheets(ComparedScan(dataclasses.replace(found, steps=unseen), True), "2026-01-01") == ()
