"""The survey on the page: every value with its uncertainty, what is missing with its reason, what is rejected too."""

import dataclasses

import pytest

from stair_inspector.model import NO_NOSING, Measured, Note
from stair_inspector.pictures.coloring import rejected_of
from stair_inspector.pictures.segmentation import MOST_REJECTED
from stair_inspector.viewer.bridge.markup import pick_script
from stair_inspector.viewer.parts.details_html import details_html
from stair_inspector.viewer.parts.missing import LAST_OF_FLIGHT, NOT_OBSERVED
from stair_inspector.viewer.parts.status_html import state_html
from stair_inspector.viewer.parts.step_columns import USUAL_LOOK, shown_values
from stair_inspector.viewer.parts.step_table_html import table_html
from stair_inspector.viewer.parts.steps.card_html import card_html
from stair_inspector.viewer.parts.steps.rejected_html import rejected_html
from stair_inspector.viewer.parts.survey_html import flight_text, range_text
from stair_inspector.viewer.parts.tune import histogram
from tests.viewer.parts.test_html import HOSTILE, Page
from tests.viewer.surveyed import PALETTE, surveyed


@pytest.fixture(scope="module")
def inspection():
    return surveyed()[1]


def survey_table(inspection, selected=None, pick_uuid="pick"):
    return table_html(inspection, PALETTE, selected, pick_uuid, "survey")


def rows_of(source):
    """The cells of the rows of steps, without those of the flights."""
    page = Page(source)
    ids = [row for row in page.of("tr") if row.get("data-testid") in ("step-row", "flight-row")]
    return [cells for cells, row in zip(page.rows[1:], ids, strict=True) if row["data-testid"] == "step-row"]


def titles_of(source, column):
    """The tooltips of a column of the steps' rows."""
    page = Page(source)
    cells = [cell for cell in page.of("td") if "colspan" not in cell]
    return [cell.get("title") for cell in cells[column::8]]


def tidy(cells):
    return [" ".join(cell.split()) for cell in cells]


def test_every_row_has_value_and_uncertainty_of_its_step(inspection):
    rows = rows_of(survey_table(inspection))
    assert len(rows) == 5
    assert tidy(rows[0])[:6] == ["1", "170.1 ±0.4", "280.0 ±0.4", "300 ±12", "1000.00 ±0.04", "31.3 ±0.1"]
    for step, row in zip(inspection.steps, rows, strict=True):
        assert tidy(row)[1] == f"{step.rise_m.value * 1000.0:.1f} ±0.4"


@pytest.mark.parametrize("unit", ["mm", "in"])
def test_every_row_has_the_rms_residual_of_its_step_in_millimetres(inspection, unit):
    source = table_html(inspection, PALETTE, None, "pick", "survey", unit)
    shown = USUAL_LOOK.columns("survey")
    column = 1 + [each.head for each in shown].index("RMS")
    assert shown[column - 1].unit_in(unit) == "mm"
    for step, row in zip(inspection.steps, rows_of(source), strict=True):
        assert row[column] == f"{1000.0 * step.plane.rms_m:.2f}"
    bare = dataclasses.replace(inspection.steps[0], plane=dataclasses.replace(inspection.steps[0].plane, rms_m=None))
    assert rows_of(survey_table(dataclasses.replace(inspection, steps=(bare,), flights=())))[0][column] == "–"


def test_what_is_missing_is_a_dash_with_the_reason(inspection):
    source = survey_table(inspection)
    rows = rows_of(source)
    assert [row[2].strip() for row in rows][2:] == ["–", "280.0 ±0.4", "–"]
    assert titles_of(source, 2)[2] == "the nosing of step 4 is hidden"
    assert titles_of(source, 2)[4] == LAST_OF_FLIGHT
    assert rows[4][5].strip() == "–"


@pytest.mark.parametrize("code", NO_NOSING)
def test_what_a_nosing_that_is_none_takes_from_its_neighbours_has_its_reason(inspection, code):
    words = "step 3: what was found is not its nosing"
    steps = [dataclasses.replace(step, rise_m=None, going_m=None, tread_depth_m=None) for step in inspection.steps]
    notes = (Note(code, "impossible", words, 3),)
    source = survey_table(dataclasses.replace(inspection, notes=notes, steps=tuple(steps)))
    for column, near in ((1, {3, 4}), (2, {2, 3}), (3, {3})):
        assert {number for number, title in enumerate(titles_of(source, column), 1) if title == words} == near


def test_a_note_about_another_quantity_is_no_reason(inspection):
    notes = (
        Note("back_unobserved", "survey", "the back edge of step 5 was not seen", 5),
        Note("no_going", "survey", "it ends at a wall", 4),
    )
    steps = [dataclasses.replace(step, tread_depth_m=None, going_m=None, width_m=None) for step in inspection.steps]
    source = survey_table(dataclasses.replace(inspection, notes=notes, steps=tuple(steps)))
    assert titles_of(source, 2) == [NOT_OBSERVED] * 3 + ["it ends at a wall", LAST_OF_FLIGHT]
    assert titles_of(source, 3) == [NOT_OBSERVED] * 4 + ["the back edge of step 5 was not seen"]
    assert titles_of(source, 4) == [NOT_OBSERVED] * 5
    assert titles_of(source, 5)[4] == LAST_OF_FLIGHT


def test_a_missing_tread_is_the_reason_for_the_rise_above_and_the_going_below_it(inspection):
    told = "a tread is missing between step 2 and step 3: neither the rise nor the going is defined"
    notes = (Note("tread_missing", "survey", told, 3),)
    steps = [dataclasses.replace(step, rise_m=None, going_m=None, pitch_deg=None) for step in inspection.steps]
    source = survey_table(dataclasses.replace(inspection, notes=notes, steps=tuple(steps)))
    for column, owner in ((1, 3), (2, 2), (5, 2)):
        assert [k for k, title in enumerate(titles_of(source, column), start=1) if title == told] == [owner]


def test_a_value_of_the_table_says_what_its_uncertainty_is_made_of(inspection):
    source = survey_table(inspection)
    assert titles_of(source, 1)[0] == "170.1 ± 0.4 mm (k = 2): noise 0.2, edge 0.3, up 0.1 mm"
    assert titles_of(source, 5)[0] == "31.3 ± 0.1° (k = 2): noise 0.1, up 0.06°"
    assert titles_of(source, 4)[0] == "1000.00 ± 0.04 mm (k = 2): parts not stated"


@pytest.mark.parametrize(
    ("share", "has_wedge", "large_arc"), [(0.0, True, "0"), (0.25, True, "0"), (0.75, True, "1"), (1.0, False, None)]
)
def test_the_coverage_is_a_disc_filled_as_far_with_the_percentage_as_its_title(inspection, share, has_wedge, large_arc):
    step = dataclasses.replace(inspection.steps[0], coverage=share)
    page = Page(survey_table(dataclasses.replace(inspection, steps=(step,))))
    (disc,) = page.of("svg")
    assert disc["aria-label"] == f"{100 * share:.0f} % of the tread has points"
    assert disc["aria-label"] in page.words
    wedges = page.of("path")
    assert len(wedges) == int(has_wedge)
    if has_wedge:
        x, y = (float(part) for part in wedges[0]["d"].removesuffix("Z").split(" ")[-2:])
        places = {0.0: (7.0, 1.0), 0.25: (13.0, 7.0), 0.75: (1.0, 7.0)}
        assert (x, y) == pytest.approx(places[share], abs=0.01)
        assert f"A6 6 0 {large_arc} 1" in wedges[0]["d"]


def test_an_unknown_coverage_is_a_dash(inspection):
    step = dataclasses.replace(inspection.steps[0], coverage=None)
    source = survey_table(dataclasses.replace(inspection, steps=(step,), flights=()))
    assert rows_of(source)[0][7] == "–"
    assert Page(source).of("svg") == []


def test_the_headline_of_a_flight_stands_before_its_steps(inspection):
    page = Page(survey_table(inspection))
    kinds = [row["data-testid"] for row in page.of("tr") if "data-testid" in row]
    assert kinds == ["flight-row", *["step-row"] * 5]
    assert " ".join(page.rows[1][0].split()) == (
        "▾Flight 1 · 5 risers · pitch 31.2 ± 0.3° · rise 168.0–171.2, largest step to step 3.1 mm (4→5)"
    )
    hint = next(cell["title"] for cell in page.of("td") if "colspan" in cell)
    assert "going 279.5–281.0, largest step to step 1.2 mm (1→2)" in hint
    assert "mean rise of 5: 170.0 mm" in hint


def test_the_landing_is_named(inspection):
    rows = rows_of(survey_table(inspection))
    assert [tidy(row)[0] for row in rows] == ["1", "2", "3", "4", "5 landing"]


def test_two_flights_have_their_own_steps_and_what_is_in_none_comes_last(inspection):
    (flight,) = inspection.flights
    flights = (
        dataclasses.replace(flight, step_ids=(4, 5)),
        dataclasses.replace(flight, flight_id=2, step_ids=(1, 2), shape="spiral"),
    )
    page = Page(survey_table(dataclasses.replace(inspection, flights=flights)))
    order = [row.get("data-step") or f"flight {row['data-flight']}" for row in page.of("tr") if "data-testid" in row]
    assert order == ["flight 1", "4", "5", "flight 2", "1", "2", "flight ", "3"]
    assert "In no flight" in page.words
    assert "Flight 2 · spiral · 5 risers" in page.words


def test_a_flight_of_which_little_is_known_has_a_headline_all_the_same(inspection):
    (flight,) = inspection.flights
    bare = dataclasses.replace(flight, pitch_deg=None, width_m=None, rise=None, going=None, n_risers=1)
    assert flight_text(bare) == "Flight 1 · 1 riser"
    assert range_text("rise", None) == ""
    alone = dataclasses.replace(flight.rise, max_adjacent=None, at=None)
    assert range_text("rise", alone) == "rise 168.0–171.2 mm"
    assert "Flight 1 · 1 riser" in Page(survey_table(dataclasses.replace(inspection, flights=(bare,)))).words


def test_a_headline_names_the_radius_of_a_curve_and_what_is_seen_beyond(inspection):
    (flight,) = inspection.flights
    curved = dataclasses.replace(flight, pitch_deg=None, shape="curved", radius_m=Measured(4.003, 0.02))
    going_on = dataclasses.replace(flight, pitch_deg=None, goes_on="5 risers measured; about 3 more are seen above: x")
    assert flight_text(going_on).endswith("5 risers · goes on: 5 risers measured; about 3 more are seen above: x")
    assert flight_text(curved) == "Flight 1 · curved · radius 4.00 ± 0.02 m · 5 risers"


def test_rows_of_the_survey_are_chosen_like_those_of_the_paper(inspection):
    rows = [row for row in Page(survey_table(inspection, 2, "id")).of("tr") if "data-step" in row]
    assert [row["aria-selected"] for row in rows] == ["false", "true", "false", "false", "false"]
    assert [row["onclick"] for row in rows] == [pick_script("id", k) for k in range(1, 6)]


def test_the_columns_are_the_surveys_where_it_was_made_unless_the_papers_are_wanted(inspection):
    paper = dataclasses.replace(inspection, params=inspection.params.replaced("method", "paper"))
    without = dataclasses.replace(inspection, flights=())
    assert [shown_values(result, None) for result in (inspection, paper, without, None)] == [
        "survey",
        "paper",
        "paper",
        "survey",
    ]
    assert shown_values(inspection, "paper") == "paper"
    assert shown_values(paper, "survey") == "paper"


def test_a_survey_without_steps_says_why(inspection):
    why = Note("no_staircase", "verdict", "no staircase found: <b>3 horizontal surfaces</b>, too few")
    empty = dataclasses.replace(inspection, steps=(), flights=(), notes=(why,))
    assert Page(survey_table(empty)).rows[-1] == ["No staircase found: <b>3 horizontal surfaces</b>, too few."]
    assert Page(survey_table(dataclasses.replace(empty, notes=()))).rows[-1] == ["No steps."]


def test_the_card_has_every_value_of_the_chosen_step(inspection):
    page = Page(card_html(inspection, 1, PALETTE))
    words = " ".join(page.words.split())
    assert "Step 1 · tread · flight 1" in words
    assert page.rows[1:] == [
        ["rise", "169.0", "170.1 ± 0.4 mm", "171.0"],
        ["going", "280.0", "280.0 ± 0.4 mm", "–"],
    ]
    step = inspection.steps[0]
    facts = [
        "tread depth300 ± 12 mm",
        "overhang20.0 ± 0.4 mm",
        "width1000.00 ± 0.04 mm",
        "pitch31.3 ± 0.1°",
        "cross-fall-0.25 ± 0.05°",
        "fall0.00 ± 0.05°",
        "coverage87 %",
        f"points{step.plane.n_points:,}",
        f"RMS{step.plane.rms_m * 1000.0:.2f} mm",
    ]
    assert [fact for fact in facts if fact not in words] == []


def test_the_card_of_a_step_has_its_own_notes_and_dashes_with_the_reason(inspection):
    page = Page(card_html(inspection, 3, PALETTE))
    assert "the nosing of step 4 is hidden" in page.words
    assert "all seen" not in page.words
    assert page.rows[2] == ["going", "–", "–", "–"]
    titles = [cell.get("title") for cell in page.of("td") if cell.get("title")]
    assert titles.count("the nosing of step 4 is hidden") == 3


@pytest.mark.parametrize("selected", [None, 99])
def test_no_step_has_no_card(inspection, selected):
    assert Page(card_html(inspection, selected, PALETTE)).words == ""


def test_a_result_of_the_paper_has_no_card(inspection):
    assert Page(card_html(dataclasses.replace(inspection, flights=()), 1, PALETTE)).words == ""
    assert Page(card_html(None, None, PALETTE)).words == ""


def test_rejected_surfaces_are_listed_by_size_with_height_area_and_reason(inspection):
    page = Page(rejected_html(inspection, PALETTE.rejected, 6, "id", is_shown=True))
    assert [[cell.strip() for cell in row] for row in page.rows[1:]] == [
        ["7", "0.240", "0.45", "a table <b>in the way</b>"],
        ["6", "0.341", "0.12", "no step leads to it"],
    ]
    rows = [row for row in page.of("tr") if "data-surface" in row]
    assert [row["aria-selected"] for row in rows] == ["false", "true"]
    assert rows[0]["onclick"] == pick_script("id", 7, "surface")
    assert page.of("b") == []


def test_rejected_surfaces_are_listed_only_when_they_are_shown(inspection):
    assert Page(rejected_html(inspection, PALETTE.rejected, None, "pick", is_shown=False)).words == ""
    assert Page(rejected_html(None, PALETTE.rejected, None, "pick", is_shown=True)).words == ""


def test_nothing_rejected_and_nothing_to_reject_are_told_apart(inspection):
    kept = tuple(patch for patch in inspection.patches if patch.kind != "rejected")
    none = dataclasses.replace(inspection, patches=kept)
    assert "No surface was rejected." in rejected_html(none, PALETTE.rejected, None, "pick", is_shown=True)
    bare = dataclasses.replace(inspection, patches=())
    assert "no surfaces to reject" in rejected_html(bare, PALETTE.rejected, None, "pick", is_shown=True)


def test_of_very_many_rejected_surfaces_the_largest_are_listed(inspection):
    one = rejected_of(inspection)[0]
    many = tuple(dataclasses.replace(one, patch_id=k, area_m2=0.01 * k, reason=None) for k in range(50))
    page = Page(rejected_html(dataclasses.replace(inspection, patches=many), (1, 2, 3), None, "pick", is_shown=True))
    assert [int(row[0]) for row in page.rows[1:]] == list(range(49, 49 - MOST_REJECTED, -1))
    assert f"and {50 - MOST_REJECTED} smaller ones" in page.words
    assert "no reason given" in page.words


def test_the_bands_say_what_a_level_is_and_what_is_no_step_has_no_colour_below_it(inspection):
    levels = list(inspection.levels)
    # Level 2 is two surfaces of which one is a step; level 3 has none, with the reason.
    levels[3] = dataclasses.replace(levels[3], kind="rejected", reason="a shelf <i>")
    patches = tuple(patch for patch in inspection.patches if patch.step_id != 3)
    odd = dataclasses.replace(inspection, levels=tuple(levels), patches=patches)
    page = Page(histogram.histogram_html(odd, PALETTE, "pick"))
    fills = [rect["fill"] for rect in page.of("rect") if rect["y"] == "80"]
    colors = [PALETTE.floor, PALETTE.of_step(1), PALETTE.of_step(2), PALETTE.of_step(4)]
    assert fills[:4] == [f"rgb{color}" for color in colors]
    assert "; tread, step 2" in page.words
    assert "; rejected: a shelf <i>" in page.words
    assert page.of("i") == []


def test_two_steps_of_the_same_height_are_both_named(inspection):
    patches = tuple(dataclasses.replace(patch, level_id=min(patch.level_id, 1)) for patch in inspection.patches)
    source = histogram.histogram_html(dataclasses.replace(inspection, patches=patches), PALETTE, "pick")
    assert "step 1, 2, 3, 4, 5" in source
    at = [rect for rect in Page(source).of("rect") if rect["y"] == "80"]
    assert [rect["fill"] for rect in at[1:6]] == [f"rgb{PALETTE.of_step(k)}" for k in range(1, 6)]


def test_the_details_say_what_was_stated_and_overruled(inspection):
    params = inspection.params
    for name, value in {
        "overrules.force": "level:2=rejected",
        "overrules.climb": "x",
        "overrules.region": "-9,-9,-9,9,9,9",
        "uncertainty.up_deg": 0.1,
        "survey.band_m": 0.006,
    }.items():
        params = params.replaced(name, value)
    words = Page(details_html(dataclasses.replace(inspection, params=params))).words
    used = ["cell 20 mm", "gap 150 mm", "turn 45°", "edges auto", "lines 15 %", "band 6 mm"]
    used += ["±0 mm, ±0.1°, ±0 %", "overruled level:2=rejected", "climb x", "region -9,-9,-9,9,9,9"]
    assert [part for part in used if part not in words] == []
    plain = Page(details_html(inspection)).words
    assert "band auto" in plain
    assert [part for part in ("stated", "overruled", "climb", "region") if part in plain] == []


def test_the_state_counts_flights(inspection):
    assert "5 steps in 1 flight" in state_html(inspection, busy=None, error=None, is_stale=False, cancel_uuid="stop")


def test_nothing_that_is_told_of_a_surface_becomes_markup(inspection):
    notes = (Note("going", "survey", HOSTILE, 3), Note("going", "survey", HOSTILE, 5))
    patches = tuple(dataclasses.replace(patch, reason=HOSTILE) for patch in inspection.patches)
    parts = Measured(0.17, 0.001, ((HOSTILE, 0.001),))
    steps = tuple(dataclasses.replace(step, rise_m=parts) for step in inspection.steps)
    levels = tuple(dataclasses.replace(level, reason=HOSTILE) for level in inspection.levels)
    hostile = dataclasses.replace(inspection, notes=notes, patches=patches, steps=steps, levels=levels)
    for source in (
        survey_table(hostile),
        card_html(hostile, 3, PALETTE),
        rejected_html(hostile, PALETTE.rejected, None, "pick", is_shown=True),
        histogram.histogram_html(hostile, PALETTE, "pick"),
    ):
        page = Page(source)
        assert [tag for tag, _ in page.tags if tag in ("img", "script")] == []
        scripts = [text for _, named in page.tags for name, text in named.items() if name.startswith("on")]
        assert [script for script in scripts if "alert" in script] == []
        hints = [attributes.get("title") or "" for _, attributes in page.tags]
        assert any(HOSTILE in words for words in (page.words, *hints))
