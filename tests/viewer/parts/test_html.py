"""What the page says of an inspection, as text: every number, every sign of trouble, and no markup from outside."""

import dataclasses
import re
from html.parser import HTMLParser

import numpy as np
import pytest

from stair_inspector.files.palettes import read_palette
from stair_inspector.model import Note
from stair_inspector.pipeline import inspect
from stair_inspector.viewer.bridge.markup import pick_script
from stair_inspector.viewer.parts.details_html import details_html, notes_html
from stair_inspector.viewer.parts.status_html import header_html, state_html
from stair_inspector.viewer.parts.step_table_html import table_html
from stair_inspector.viewer.parts.tune import histogram
from stair_inspector.viewer.scene.legends import legend_html
from tests.synthetic import Stair, exact_params, make_scan

PALETTE = read_palette("page")
HOSTILE = '<img src=x onerror="alert(1)">&\'</td><script>alert(2)</script>'


class Page(HTMLParser):
    """The tags with their attributes, and the text of every table cell."""

    def __init__(self, source):
        super().__init__()
        self.tags, self.rows, self.words = [], [], ""
        self._in_cell = False
        self.feed(source)

    def handle_starttag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))
        if tag == "tr":
            self.rows.append([])
        self._in_cell |= tag == "td"
        if tag == "td":
            self.rows[-1].append("")

    def handle_endtag(self, tag):
        self._in_cell &= tag != "td"

    def handle_data(self, data):
        self.words += data
        if self._in_cell:
            self.rows[-1][-1] += data

    def of(self, tag):
        return [attributes for name, attributes in self.tags if name == tag]


@pytest.fixture(scope="module")
def inspection():
    return inspect(Stair(noise=0.001, risers=True).scan(), exact_params())


def cells(row):
    return [cell.strip() for cell in row]


def test_the_table_has_the_floor_and_a_row_for_each_step_with_its_numbers(inspection):
    rows = Page(table_html(inspection, PALETTE, None, "pick")).rows[1:]
    assert cells(rows[0])[0] == "floor"
    assert float(rows[0][1]) == pytest.approx(1000.0 * inspection.floor_h_m, abs=0.05)
    assert cells(rows[0])[2:6] == [""] * 4
    assert len(rows) == 1 + len(inspection.steps) == 6
    for step, row in zip(inspection.steps, rows[1:], strict=True):
        paper = step.paper
        truth = [paper.h_m, paper.d_fb_m, paper.d_ff_m, paper.w_m]
        for shown, value in zip(row[1:5], truth, strict=True):
            if value is None:
                assert shown == "–"
            else:
                assert float(shown) == pytest.approx(1000.0 * value, abs=0.0501)
        assert cells(row)[0] == str(step.step_id)
        assert int(row[6].replace(",", "")) == step.plane.n_points
        assert float(row[7]) == pytest.approx(1000.0 * step.plane.rms_m, abs=0.00501)


def test_what_is_not_known_is_a_dash_and_never_a_zero(inspection):
    last = inspection.steps[-1]
    assert (last.paper.h_m, last.paper.d_ff_m, last.paper.theta_deg) == (None, None, None)
    bare = dataclasses.replace(last, plane=dataclasses.replace(last.plane, rms_m=None))
    alone = dataclasses.replace(inspection, steps=(bare,), floor_h_m=None)
    floor, row = Page(table_html(alone, PALETTE, None, "pick")).rows[1:]
    assert floor[1] == "–"
    assert [row[i] for i in (1, 3, 5, 7)] == ["–"] * 4


def test_a_true_zero_is_a_zero(inspection):
    step = inspection.steps[0]
    level = dataclasses.replace(step, paper=dataclasses.replace(step.paper, h_m=0.0, theta_deg=0.0))
    row = Page(table_html(dataclasses.replace(inspection, steps=(level,)), PALETTE, None, "pick")).rows[2]
    assert (row[1], row[5]) == ("0.0", "0.00")


def test_only_the_chosen_row_is_emphasised(inspection):
    rows = [row for row in Page(table_html(inspection, PALETTE, 3, "id")).of("tr") if "data-step" in row]
    assert [row["aria-selected"] for row in rows] == ["false", "false", "true", "false", "false"]
    assert ["font-weight:600" in row["style"] for row in rows] == [False, False, True, False, False]


def test_rows_can_be_clicked_only_when_there_is_something_to_write_to(inspection):
    rows = [row for row in Page(table_html(inspection, PALETTE, None, "some-id")).of("tr") if "data-step" in row]
    for row in rows:
        assert row["onclick"] == pick_script("some-id", int(row["data-step"]))


def test_the_script_of_a_row_keeps_a_hostile_identity_inside_its_string():
    script = pick_script("\"});alert(1);({a:'", 2)
    assert '"\\"});alert(1);({a:\'"' in script
    assert "updates:{value:'2:'+Date.now()}" in script


def test_no_result_and_no_steps_are_told_apart(inspection):
    assert Page(table_html(None, PALETTE, None, "pick")).rows[1:] == []
    empty = dataclasses.replace(inspection, steps=())
    assert Page(table_html(empty, PALETTE, None, "pick")).rows[-1] == ["No steps."]


def test_the_histogram_has_a_grey_band_for_each_level_in_its_place_and_the_steps_below_in_their_colours(inspection):
    page = Page(histogram.histogram_html(inspection, PALETTE, "pick"))
    assert [int(group["data-level"]) for group in page.of("g")] == [level.level_id for level in inspection.levels]
    bands = [rect for rect in page.of("rect") if rect["y"] == "14"]
    colors = [PALETTE.floor, *(PALETTE.of_step(k) for k in range(1, 6))]
    assert {rect["fill"] for rect in bands} == {"currentColor"}
    chips = [rect for rect in page.of("rect") if rect["y"] == "80"]
    assert [rect["fill"] for rect in chips] == [f"rgb{color}" for color in colors]
    middles = [float(rect["x"]) + float(rect["width"]) / 2.0 for rect in bands]
    heights = [(level.low_m + level.high_m) / 2.0 for level in inspection.levels]
    # One straight line from heights to places: the bands stand where the axis says.
    slope, start = np.polyfit(heights, middles, 1)
    np.testing.assert_allclose(np.polyval([slope, start], heights), middles, atol=0.2)
    ticks = [(float(t["x"]), t) for t in page.of("text") if t.get("text-anchor") == "middle"]
    names = [
        float(name)
        for name in re.findall(
            r'opacity="0.75">(-?[\d.]+)</text>', histogram.histogram_html(inspection, PALETTE, "pick")
        )
    ]
    assert 3 <= len(names) == len(ticks) <= 10
    np.testing.assert_allclose(np.polyval([slope, start], names), [x for x, _ in ticks], atol=0.5)


def test_the_histogram_has_bars_within_its_frame_and_the_reach_to_scale(inspection):
    page = Page(histogram.histogram_html(inspection, PALETTE, "pick"))
    (outline,) = page.of("path")
    tops = [float(y) for y in re.findall(r"V([\d.]+)H", outline["d"])]
    assert len(tops) > 50
    assert min(tops) >= 14.0
    assert max(tops) <= 108.0
    assert min(tops) < 30.0
    # The other line is drawn while somebody drags.
    reach, drag = page.of("line")
    assert drag["opacity"] == "0"
    profile = inspection.profile
    scale = 384.0 / (profile.bin_m * len(profile.counts))
    assert float(reach["x2"]) - float(reach["x1"]) == pytest.approx(inspection.params.levels.eps_m * scale, abs=0.06)
    assert "ε_z 20 mm" in page.words


def test_the_histogram_of_nothing_keeps_its_height():
    assert f"height:{histogram._HEIGHT}px" in histogram.histogram_html(None, PALETTE, "pick")


def test_rejected_levels_are_not_shown_as_steps():
    rng = np.random.default_rng(2)
    flats = [np.column_stack([rng.uniform(0, 2, (3000, 2)), np.full(3000, z)]) for z in (0.0, 0.9, 1.9)]
    points = np.concatenate(flats)
    scan = make_scan(points, np.tile([0.0, 0.0, 1.0], (len(points), 1)))
    rejected = inspect(scan, exact_params())
    assert [level.kind for level in rejected.levels[1:]] == ["rejected", "rejected"]
    drawn = Page(histogram.histogram_html(rejected, PALETTE, "pick")).of("rect")
    assert len([rect for rect in drawn if rect["y"] == "14"]) == 3
    assert [rect["fill"] for rect in drawn if rect["y"] == "80"] == [f"rgb{PALETTE.floor}"]


def test_the_state_says_up_to_date_busy_or_error(inspection):
    ready = state_html(inspection, busy=None, error=None, is_stale=False, cancel_uuid="stop")
    busy = state_html(inspection, busy="estimating normals …", error=None, is_stale=True, cancel_uuid="stop")
    failed = state_html(inspection, busy=None, error="no floor was found", is_stale=True, cancel_uuid="stop")
    states = [Page(source).of("div")[1]["data-state"] for source in (ready, busy, failed)]
    assert states == ["ready", "busy", "error"]
    assert "up to date" in ready
    assert "5 steps" in ready
    assert "estimating normals …" in busy
    alerts = [div for div in Page(failed).of("div") if div.get("role") == "alert"]
    assert len(alerts) == 1
    assert "no floor was found" in Page(failed).words
    assert [".si-results{filter" in source for source in (ready, busy, failed)] == [False, True, True]


def test_an_error_without_any_result_dims_nothing():
    assert "opacity" not in state_html(None, busy=None, error="x", is_stale=True, cancel_uuid="stop")


def test_the_legend_has_a_chip_in_every_colour_of_the_palette():
    source = legend_html(PALETTE)
    colors = [PALETTE.floor, *PALETTE.steps, PALETTE.non_stair, PALETTE.front_edge, PALETTE.back_edge]
    colors += [PALETTE.side_edge, PALETTE.centre]
    assert [color for color in colors if f"background:rgb{color}" not in source] == []


def test_the_details_name_the_settings_that_were_used_and_every_note(inspection):
    noted = dataclasses.replace(
        inspection, notes=(Note("a", "read", "first"), Note("b", "levels", "second")), timings_s={"levels": 0.0123}
    )
    page = Page(details_html(noted) + notes_html(noted))
    used = ["survey", "θ_th 15°", "ε_z 20 mm", "m 50", "α 95/5 %", "sides 99 %", "normals given", "given", "unit m"]
    assert [part for part in used if part not in page.words] == []
    assert [item["title"] for item in page.of("li")] == ["a", "b"]
    assert "levels 12.3" in page.words


def test_nothing_that_comes_from_a_file_becomes_markup(inspection):
    hostile = dataclasses.replace(inspection, notes=(Note(HOSTILE, "read", HOSTILE),), timings_s={HOSTILE: 0.001})
    quiet = dataclasses.replace(inspection, notes=())
    sources = [
        header_html(HOSTILE, 10, 5),
        details_html(hostile),
        notes_html(hostile),
        state_html(quiet, busy=None, error=HOSTILE, is_stale=False, cancel_uuid="stop"),
        state_html(quiet, busy=HOSTILE, error=None, is_stale=False, cancel_uuid="stop"),
    ]
    for source in sources:
        page = Page(source)
        assert [tag for tag, _ in page.tags if tag in ("img", "script", "td")] == []
        assert [name for _, attributes in page.tags for name in attributes if name.startswith("on")] == []
        assert HOSTILE in page.words


def test_the_header_says_how_many_points_are_drawn():
    assert "1,234,567 points, 600,000 drawn" in header_html("a.ply", 1_234_567, 600_000)
    assert "drawn" not in header_html("a.ply", 1000, 1000)
